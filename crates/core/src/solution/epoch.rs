//! The one record per instant that later stages read.

use crate::frame::{Covariance, Displacement, Enu};
use crate::quantity::{GpsTime, Metres, Radians, Unavailable};

/// One instant: what is known of position, path and error. Absent parts are `None`; who needs them says so.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Epoch {
    /// Time of applicability.
    pub time: Option<GpsTime>,
    /// Course of the defined path, clockwise from true north.
    pub course: Option<Radians>,
    /// Path angle of the defined path, positive climbing.
    pub path_angle: Option<Radians>,
    /// Estimated position minus expected position on the path; lateral and vertical parts are the flight technical error.
    pub offset: Option<Displacement<Enu>>,
    /// Covariance of the navigation system error (true minus estimated position).
    pub covariance: Option<Covariance<Enu>>,
    /// Known mean of the navigation system error; absent means zero.
    pub mean: Option<Displacement<Enu>>,
    /// RNP value in force (the 95 % lateral accuracy).
    pub rnp: Option<Metres>,
}

impl Epoch {
    /// The covariance, or that `method` lacks it.
    ///
    /// # Errors
    /// [`Unavailable::Missing`].
    pub fn covariance_for(&self, method: &'static str) -> Result<&Covariance<Enu>, Unavailable> {
        self.covariance.as_ref().ok_or(Unavailable::Missing { method, field: "covariance" })
    }
    /// The offset from the path, or that `method` lacks it.
    ///
    /// # Errors
    /// [`Unavailable::Missing`].
    pub fn offset_for(&self, method: &'static str) -> Result<&Displacement<Enu>, Unavailable> {
        self.offset.as_ref().ok_or(Unavailable::Missing { method, field: "offset" })
    }
    /// The course, or that `method` lacks it.
    ///
    /// # Errors
    /// [`Unavailable::Missing`]; [`Unavailable::Invalid`] as [`Radians::course`].
    pub fn course_for(&self, method: &'static str) -> Result<Radians, Unavailable> {
        Ok(self.course.ok_or(Unavailable::Missing { method, field: "course" })?.course()?)
    }
}
