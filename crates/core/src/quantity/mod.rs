//! Quantities: a number whose unit is its type, and the refusals that carry them.

pub mod encoding;
mod provenance;
mod refusal;
mod status;
mod time;
mod unit;

pub use provenance::Provenance;
pub use refusal::{Confidence, OutOfDomain, Unavailable};
pub use status::{Reason, Status};
pub use time::GpsTime;
pub use unit::{KNOT_MPS, Metres, Radians, Risk};
