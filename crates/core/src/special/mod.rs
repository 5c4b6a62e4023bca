//! Tails, quantiles and radii of Gaussian errors: what the bounds are made of.
//!
//! Everything takes the risk (the tail), never the probability, and keeps full relative accuracy where the tail is small.

pub mod beta;
pub(crate) mod float;
pub mod gamma;
pub mod normal;

pub use normal::{one_sided_factor, tail, two_sided_factor};
