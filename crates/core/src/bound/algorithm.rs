//! What every algorithm of protection levels is, and the one list of them.

use super::{Levels, NoLevels, Protection, Sight};

/// Protection levels of one epoch from its satellites alone. A map, a prediction and the contract tests are generic over it, so an
/// algorithm is one implementation and one line of [`super::ALGORITHMS`].
pub trait Algorithm: Sized {
    /// What a person must know of its levels.
    const PROTECTION: Protection;
    /// Names of the numbers of a detail; the ending of each is its unit.
    const COLUMNS: &'static [&'static str];
    /// What the levels are requested under.
    type Settings;
    /// What it says beside its levels.
    type Detail: Copy;

    /// The settings of a caller who has none of his own.
    fn usual() -> Self::Settings;

    /// With settings. It may be large: made once, called epoch after epoch.
    fn new(settings: &Self::Settings) -> Self;

    /// Levels of one epoch.
    ///
    /// # Errors
    /// [`NoLevels`].
    fn levels(&mut self, sights: &[Sight]) -> Result<Levels<Self::Detail>, NoLevels>;

    /// The number of a detail that this one of [`Self::COLUMNS`] names; NaN beyond them.
    fn number(detail: &Self::Detail, column: usize) -> f64;
}

/// Something that is done with any algorithm: generic code behind a name.
pub trait Task {
    /// What it gives.
    type Output;
    /// With this algorithm.
    fn with<A: Algorithm>(self) -> Self::Output;
}

/// One algorithm of the list.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Entry {
    /// What a person must know of its levels.
    pub protection: Protection,
    /// The numbers beside the levels; none where the levels need more than the satellites of one epoch.
    pub columns: Option<&'static [&'static str]>,
}

/// The list, and the way from a name to the algorithm. Every line is static: no heap, no table of pointers, no cost in the loop.
macro_rules! algorithms {
    (sights: $($algorithm:ty),+; others: $($other:expr),+ $(,)?) => {
        /// Every algorithm of protection levels, in the order in which an aircraft meets them: en route, on approach, on the ground,
        /// experimental. The first lines are [`Algorithm`]s; the others need two instants, or messages and residuals, and have functions of
        /// their own.
        pub const ALGORITHMS: &[Entry] = &[
            $(Entry { protection: <$algorithm as Algorithm>::PROTECTION, columns: Some(<$algorithm as Algorithm>::COLUMNS) },)+
            $(Entry { protection: $other, columns: None },)+
        ];

        /// Do something with the algorithm of this id; `None` where no algorithm of the satellites of one epoch has it.
        pub fn with_algorithm<T: Task>(id: &str, task: T) -> Option<T::Output> {
            $(if id == <$algorithm as Algorithm>::PROTECTION.id {
                return Some(task.with::<$algorithm>());
            })+
            None
        }
    };
}
pub(crate) use algorithms;
