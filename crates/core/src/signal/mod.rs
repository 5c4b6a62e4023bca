//! What was received, and from whom.

mod satellite;

pub use satellite::{Constellation, SatelliteId};
