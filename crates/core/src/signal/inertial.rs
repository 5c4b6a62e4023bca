//! What an inertial measurement unit delivers.

use crate::quantity::GpsTime;
use nalgebra::Vector3;

/// Increments over one sampling interval, body axes (forward, right, down).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImuIncrement {
    /// End of the interval.
    pub time: GpsTime,
    /// Length of the interval \[s\].
    pub interval_s: f64,
    /// Integral of the angular rate against inertial space \[rad\].
    pub angle_rad: Vector3<f64>,
    /// Integral of the specific force \[m/s\].
    pub velocity_mps: Vector3<f64>,
}
