//! Frames: where a vector's axes point. A vector or covariance of one frame cannot be passed where another is required.

mod geodetic;
mod gravity;
mod vector;

pub use geodetic::{
    ECCENTRICITY_SQUARED, EcefPosition, Geodetic, LatLon, Radii, SEMI_MAJOR, ecef_from_geodetic, enu_from_ecef, geodetic_from_ecef, radii,
};
pub use gravity::{EARTH_RATE_RADPS, earth_rate_ned, gravity_mps2, gravity_of};
pub use vector::{Covariance, Displacement, Ecef, Enu, Frame, LEAST_VARIANCE_M2, Track, counts_as_zero};
