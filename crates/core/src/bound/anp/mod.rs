//! Actual navigation performance: circle, sphere, ellipsoid, directions, shaped regions.
//!
//! Everything is a question about one Gaussian error e = N(mean, V), east-north-up in metres.

mod accept;
mod ellipsoid;
mod fits;
mod listed;
mod radial;
mod shaped;

pub use accept::{accept, principal_sigmas, radius_law};
pub use ellipsoid::{Ellipsoid, ellipsoid, intercept, support};
pub use fits::{circle_fit, circle_fit_as_printed, circle_geodesy, sphere_grubbs, sphere_grubbs_as_printed};
pub use listed::METHODS;
pub use radial::{Directional, circle, directional, flat, radius_m, sphere};
pub use shaped::{Sides, box_factor, cylinder, cylinder_scale, rectangle, rectangle_scale};
