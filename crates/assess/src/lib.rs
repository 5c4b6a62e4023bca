//! Many epochs: batch loops on all cores, evaluation of bounds against truth.
//!
//! A loop over epochs contains a call, not mathematics: the mathematics is in `navbound-core`.

pub mod anp;
pub mod araim;
mod araim_modes;
pub mod araim_watch;
pub mod batch;
pub mod bounds;
pub mod consistency;
pub mod dme;
pub mod dop_map;
pub mod ee;
pub mod error;
pub mod evaluation;
pub mod flights;
pub mod fused;
pub mod fusion;
pub mod gbas;
pub mod judge;
pub mod judged;
pub mod kpi;
pub mod monitor;
pub mod outlook;
mod parallel;
pub mod plausible;
pub mod positions;
pub mod raim;
pub mod receivers;
pub mod rraim;
pub mod sbas;
pub mod sensed;
pub mod sky;
pub mod smoothing;
pub mod states;
mod stations;
pub mod surface;
pub mod tse;
