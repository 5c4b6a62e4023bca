//! A receiver's observations and broadcast messages to ranges: one rule for positions and for the monitors on board.

pub mod heard;
pub(crate) mod phases;
pub mod ranges;
pub mod signals;
