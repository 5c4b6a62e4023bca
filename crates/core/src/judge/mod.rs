//! The last stage: everything that is decided about an epoch. [`Judge::step`] is the one step of tables and of streams.

mod errors;
mod snapshot;
mod step;

pub use errors::{Errors, Known};
pub use step::{Evaluated, Judge, Judged, Sample, Settings};
