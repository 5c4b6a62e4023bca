//! Frames: where a vector's axes point. A vector or covariance of one frame cannot be passed where another is wanted.

mod vector;

pub use vector::{Covariance, Displacement, Ecef, Enu, Frame, Track};
