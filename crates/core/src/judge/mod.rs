//! The last stage: what is said of an epoch. Today the errors along the axes of the path; bounds, risks and states come from the stages before.

mod errors;

pub use errors::{Errors, Known};
