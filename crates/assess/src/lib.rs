//! Many epochs: batch loops on all cores, evaluation of bounds against truth.

pub mod error;
pub mod plausible;
