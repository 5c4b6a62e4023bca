//! A refusal that says which item of an array was meant.

use navbound_core::quantity::OutOfDomain;

/// One item of an array argument is outside its domain.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("item {index}: {error}")]
pub struct AtIndex {
    /// Position in the array, from 0.
    pub index: usize,
    /// What is wrong with it.
    pub error: OutOfDomain,
}

/// Attaches an index to a refusal.
pub(crate) trait At<T> {
    fn at(self, index: usize) -> Result<T, AtIndex>;
}

impl<T> At<T> for Result<T, OutOfDomain> {
    fn at(self, index: usize) -> Result<T, AtIndex> {
        self.map_err(|error| AtIndex { index, error })
    }
}
