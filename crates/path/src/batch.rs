//! Many positions at once, as structures of arrays: numbers in, numbers out. A position that does not exist (both angles NaN) has no
//! foot, and its row is NaN.

use crate::refusal::{At, AtIndex};
use crate::{Foot, Line, Place, Route};
use navbound_core::frame::LatLon;
use navbound_core::quantity::{Metres, OutOfDomain, Radians};

/// Feet of many positions; a missing one is NaN, its leg `u32::MAX`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Feet {
    /// Distance along the path \[m\].
    pub along_m: Vec<f64>,
    /// Distance from the path, positive right \[m\].
    pub cross_m: Vec<f64>,
    /// Course of the path at the foot \[rad\].
    pub course_rad: Vec<f64>,
    /// Latitude of the foot \[rad\].
    pub lat_rad: Vec<f64>,
    /// Longitude of the foot \[rad\].
    pub lon_rad: Vec<f64>,
    /// Index of the leg.
    pub leg: Vec<u32>,
}

/// The path at many distances along it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Points {
    /// Latitude \[rad\].
    pub lat_rad: Vec<f64>,
    /// Longitude \[rad\].
    pub lon_rad: Vec<f64>,
    /// Course \[rad\].
    pub course_rad: Vec<f64>,
    /// Curvature, positive right \[1/m\].
    pub curvature_per_m: Vec<f64>,
    /// Index of the leg.
    pub leg: Vec<u32>,
}

/// Points from arrays of angles.
///
/// # Errors
/// [`AtIndex`] for the first that is not on the Earth.
pub(crate) fn points(lat_rad: &[f64], lon_rad: &[f64]) -> Result<Vec<LatLon>, AtIndex> {
    lat_rad.iter().zip(lon_rad).enumerate().map(|(i, (&lat, &lon))| LatLon::new(Radians::new(lat), Radians::new(lon)).at(i)).collect()
}

impl Route {
    /// A route from arrays, see [`Route::new`].
    ///
    /// # Errors
    /// As there, and for a waypoint that is not on the Earth.
    pub fn from_arrays(lat_rad: &[f64], lon_rad: &[f64], radius_m: &[f64]) -> Result<Self, AtIndex> {
        let radii: Vec<Metres> = radius_m.iter().map(|&r| Metres::new(r)).collect();
        Self::new(&points(lat_rad, lon_rad)?, &radii)
    }

    /// The feet of positions in the order flown: each is sought from the foot before it, the first from `near` or anywhere.
    ///
    /// # Errors
    /// [`AtIndex`] for the first position that is not on the Earth or too far from the route.
    pub fn project_all(&self, lat_rad: &[f64], lon_rad: &[f64], near: Option<Metres>) -> Result<Feet, AtIndex> {
        let mut near = near;
        Feet::collect(lat_rad, lon_rad, |position| {
            let foot = self.project(position, near)?;
            near = Some(foot.along);
            Ok(foot)
        })
    }

    /// The path at many distances.
    ///
    /// # Errors
    /// [`AtIndex`] for the first distance that is not finite.
    pub fn at_all(&self, along_m: &[f64]) -> Result<Points, AtIndex> {
        Points::collect(along_m, |along| self.at(along))
    }
}

impl Line {
    /// The feet of positions.
    ///
    /// # Errors
    /// [`AtIndex`] for the first position that is not on the Earth or too far away.
    pub fn project_all(&self, lat_rad: &[f64], lon_rad: &[f64]) -> Result<Feet, AtIndex> {
        Feet::collect(lat_rad, lon_rad, |position| self.project(position))
    }

    /// The line at many distances.
    ///
    /// # Errors
    /// [`AtIndex`] for the first distance that is not finite.
    pub fn at_all(&self, along_m: &[f64]) -> Result<Points, AtIndex> {
        Points::collect(along_m, |along| self.at(along))
    }
}

impl Feet {
    fn collect(lat_rad: &[f64], lon_rad: &[f64], mut project: impl FnMut(&LatLon) -> Result<Foot, OutOfDomain>) -> Result<Self, AtIndex> {
        let mut feet = Self::default();
        for (i, (&lat, &lon)) in lat_rad.iter().zip(lon_rad).enumerate() {
            if lat.is_nan() && lon.is_nan() {
                feet.push_missing();
                continue;
            }
            let position = LatLon::new(Radians::new(lat), Radians::new(lon)).at(i)?;
            feet.push(&project(&position).at(i)?);
        }
        Ok(feet)
    }

    fn push(&mut self, foot: &Foot) {
        self.along_m.push(foot.along.m());
        self.cross_m.push(foot.cross.m());
        self.course_rad.push(foot.course.rad());
        self.lat_rad.push(foot.point.lat().rad());
        self.lon_rad.push(foot.point.lon().rad());
        self.leg.push(foot.leg as u32);
    }

    fn push_missing(&mut self) {
        for column in [&mut self.along_m, &mut self.cross_m, &mut self.course_rad, &mut self.lat_rad, &mut self.lon_rad] {
            column.push(f64::NAN);
        }
        self.leg.push(u32::MAX);
    }
}

impl Points {
    fn collect(along_m: &[f64], at: impl Fn(Metres) -> Result<Place, OutOfDomain>) -> Result<Self, AtIndex> {
        let mut points = Self::default();
        for (i, &along) in along_m.iter().enumerate() {
            let place = at(Metres::new(along)).at(i)?;
            points.lat_rad.push(place.point.lat().rad());
            points.lon_rad.push(place.point.lon().rad());
            points.course_rad.push(place.course.rad());
            points.curvature_per_m.push(place.curvature_per_m);
            points.leg.push(place.leg as u32);
        }
        Ok(points)
    }
}
