//! Whether to tell the crew: the RNP monitor, what its risk means over an hour, and the RNP-state classifier.

pub mod ahead;
pub mod altimeter;
pub mod balance;
mod clock;
pub mod consistency;
mod counters;
pub mod drift;
pub mod exposure;
pub mod guard;
pub mod judgement;
mod latch;
pub mod motion;
pub mod neighbours;
pub mod no_speed;
pub mod rnp;
pub mod separation;
mod settings;
mod snapshot;
pub mod standing;
pub mod state;
mod state_order;
mod wait;
pub mod way;
