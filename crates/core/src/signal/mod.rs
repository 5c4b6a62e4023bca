//! Which satellite, from which constellation, on which carrier, and what it says of itself.

mod carrier;
mod ephemeris;
mod satellite;
pub mod sbas;
pub mod smoothing;

pub use carrier::{Carrier, SPEED_OF_LIGHT_MPS};
pub use ephemeris::{Ephemeris, GeoEphemeris, Health, Klobuchar, Message, nearest};
pub use satellite::{Constellation, SatelliteId};
