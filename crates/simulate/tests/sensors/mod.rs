//! What sensors deliver has the statistics that their settings declare, and faults come when they are declared.
#![allow(clippy::unwrap_used)] // A test may stop at the first surprise, its helpers too.

mod common;
mod ground;
mod inertial;
mod receiver;
mod refusal;
mod streams;
mod truth;
