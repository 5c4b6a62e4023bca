//! Where we think we are: weighted least squares, and the record of one instant.

pub mod common;
pub mod consistency;
pub mod constellations;
pub mod declared;
pub mod dme;
mod epoch;
pub mod extraction;
pub mod ins;
pub mod led_off;
pub mod mixture;
pub mod plausible;
pub mod point;
mod range_error;
pub mod rivals;
pub mod snapshot;
pub mod subsets;
mod surroundings;
pub mod wls;

pub use epoch::Epoch;
pub use range_error::RangeError;
pub use surroundings::Surroundings;
