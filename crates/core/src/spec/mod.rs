//! Navigation specifications and the time a warning may take, as data. Later editions are more rows, not more code.

pub mod gbas;
mod level;
mod navigation;
mod phase;
pub mod surface;

pub use level::{Per, SERVICE_LEVELS, ServiceLevel};
pub use navigation::{SPECIFICATIONS, Specification, specification};
pub use phase::{PHASES, Phase, TimeToAlert};
