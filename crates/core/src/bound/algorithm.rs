//! What every algorithm of protection levels is, and the one list of them.

use super::{Levels, NoLevels, Protection, Sight};

/// Protection levels of one epoch from its satellites alone. A map, a prediction and the contract tests are generic over it, so an
/// algorithm is one implementation and one line of [`super::ALGORITHMS`].
pub trait Algorithm: Sized + Send {
    /// What a person must know of its levels.
    const PROTECTION: Protection;
    /// Whose error model the variances of its satellites are.
    const RANGES: Ranges;
    /// Names of the numbers of a detail; the ending of each is its unit.
    const COLUMNS: &'static [&'static str];
    /// What the levels are requested under.
    type Settings: Sync;
    /// What it says beside its levels.
    type Detail: Copy + Send;

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

/// Whose error model the variances of an algorithm's satellites are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ranges {
    /// The receiver's own: orbits are enough for a map or a prediction.
    Receiver,
    /// What a service corrects, and says of its corrections.
    Service,
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
    /// Whose ranges its satellites have; none where there are no columns.
    pub ranges: Option<Ranges>,
}

impl Entry {
    /// An algorithm of the satellites of one epoch.
    pub(crate) const fn of<A: Algorithm>() -> Self {
        Self { protection: A::PROTECTION, columns: Some(A::COLUMNS), ranges: Some(A::RANGES) }
    }

    /// One whose levels need more than the satellites of one epoch.
    pub(crate) const fn other(protection: Protection) -> Self {
        Self { protection, columns: None, ranges: None }
    }
}

/// The list, and the way from a name to the algorithm. Every line is static: no heap, no table of pointers, no cost in the loop.
macro_rules! algorithms {
    (sights: $($algorithm:ty),+; others: $($other:expr),+ $(,)?) => {
        /// Every algorithm of protection levels, in the order in which an aircraft meets them: en route, on approach, on the ground,
        /// experimental. The first lines are [`Algorithm`]s; the others need two instants, or messages and residuals, and have functions of
        /// their own.
        pub const ALGORITHMS: &[Entry] = &[
            $(Entry::of::<$algorithm>(),)+
            $(Entry::other($other),)+
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
