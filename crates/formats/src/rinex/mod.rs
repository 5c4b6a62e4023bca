//! RINEX: observations (versions 2.10 to 4.0x, plain and compact) and navigation messages.
//!
//! Source: RINEX 2.10, 2.11, 3.05 and 4.00 (IGS/RTCM), compact RINEX 1.0 and 3.0 (Hatanaka 2008); provenance: standard.

pub mod clock;
mod compact;
pub(crate) mod header;
mod heading;
mod layout;
pub mod navigation;
pub(crate) mod number;
pub mod observation;
mod plain;
mod value;
mod write;

pub use clock::read_clocks;
pub use navigation::{Dated, Navigation, read_navigation};
pub use observation::{Code, Observations, read_observations};
pub use write::{navigation_file, observation_file};
