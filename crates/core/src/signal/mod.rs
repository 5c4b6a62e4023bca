//! What was received: satellites, carriers and what satellites say of themselves; inertial increments; measurements that aid a filter.

mod aiding;
mod carrier;
mod ephemeris;
mod inertial;
mod satellite;
pub mod sbas;
pub mod smoothing;

pub use aiding::{Aiding, BaroHeight, DmeRange, PhaseRange, PositionFix, SatelliteRange, TimedAiding, VorBearing};
pub use carrier::{Carrier, SPEED_OF_LIGHT_MPS};
pub use ephemeris::{Ephemeris, GeoEphemeris, Health, Klobuchar, Message, nearest};
pub use inertial::ImuIncrement;
pub use satellite::{Constellation, SatelliteId};
