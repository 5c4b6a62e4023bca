//! Tails, quantiles and radii of Gaussian errors: what the bounds are made of.
//!
//! Everything takes the risk (the tail), never the probability, and keeps full relative accuracy where the tail is small.

pub(crate) mod abreast;
pub(crate) mod angles;
pub mod beta;
pub(crate) mod bivariate;
pub mod chi;
pub(crate) mod float;
pub mod folded;
pub mod gamma;
pub mod noncentral;
pub mod normal;
pub mod prepared;
pub(crate) mod quadrature;
pub mod radius;
pub(crate) mod root;
pub(crate) mod student;
pub(crate) mod widest;

pub use folded::FoldedQuantile;
pub use normal::{one_sided_factor, tail, two_sided_factor};
pub use prepared::PreparedQuantile;
