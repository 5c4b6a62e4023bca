//! Where we think we are: weighted least squares, and the record of one instant.

pub mod dme;
mod epoch;
pub mod wls;

pub use epoch::Epoch;
