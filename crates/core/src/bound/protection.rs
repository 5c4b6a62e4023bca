//! What an algorithm of protection levels declares about itself.

use crate::quantity::Provenance;

/// An algorithm of protection levels. It needs satellites, messages or a filter where a [`super::Method`] needs one epoch, so it has a
/// function of its own; here stands what a person must know of its levels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Protection {
    /// Name of its page and of its columns' source.
    pub id: &'static str,
    /// Words for a heading.
    pub title: &'static str,
    /// Function of the Python package.
    pub function: &'static str,
    /// Document and equations.
    pub source: &'static str,
    /// How we hold the formulas; numbers that they are given have a provenance of their own.
    pub provenance: Provenance,
    /// Which faults the levels cover.
    pub covers: &'static str,
    /// What must be true for the stated risk to be true.
    pub assumes: &'static str,
    /// Whether integrity may rest on it: false for experimental levels.
    pub integrity: bool,
}
