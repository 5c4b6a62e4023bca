//! Where the signals came from: nominal orbits, lines of sight, dilution of precision.

pub mod atmosphere;
pub mod barometric;
pub mod broadcast;
pub mod ionosphere;
mod nominal;
pub mod ntcm;
mod orbit;
pub mod precise;
pub(crate) mod seasonal;
mod sight;

pub use nominal::{BEIDOU, GALILEO, GPS, GPS_EXPANDED, Slot};
pub use orbit::{Elements, Orbit};
pub use sight::{Direction, LineOfSight, Observer};
