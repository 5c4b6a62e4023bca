//! Frames: where a vector's axes point. A vector or covariance of one frame cannot be passed where another is wanted.

mod geodetic;
mod vector;

pub use geodetic::{
    ECCENTRICITY_SQUARED, EcefPosition, Geodetic, LatLon, Radii, SEMI_MAJOR, ecef_from_geodetic, enu_from_ecef, geodetic_from_ecef, radii,
};
pub use vector::{Covariance, Displacement, Ecef, Enu, Frame, Track};
