//! Where the aircraft should be: geodesic legs, fly-by turns and centrelines on the WGS-84 ellipsoid.
//!
//! A [`Line`] is an infinite geodesic (a runway centreline, one leg); a [`Route`] joins legs with turn arcs. Both answer the two questions
//! of navigation performance: what is the path at a distance along it, and where on the path does a position belong.

mod batch;
mod earth;
pub mod legs;
mod line;
mod refusal;
mod route;
mod turn;

pub use batch::{Feet, Points};
pub use line::Line;
pub use refusal::AtIndex;
pub use route::Route;

use navbound_core::frame::LatLon;
use navbound_core::quantity::{Metres, Radians};

/// The point of a path that a position belongs to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Foot {
    /// Distance along the path from its first point.
    pub along: Metres,
    /// Distance of the position from the path, positive right.
    pub cross: Metres,
    /// Course of the path at the foot, in \[0, 2 pi).
    pub course: Radians,
    /// The foot.
    pub point: LatLon,
    /// Index of the leg.
    pub leg: usize,
}

/// The path at a distance along it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Where.
    pub point: LatLon,
    /// Course, in \[0, 2 pi).
    pub course: Radians,
    /// Curvature of the path, positive in a right turn \[1/m\].
    pub curvature_per_m: f64,
    /// Index of the leg.
    pub leg: usize,
}
