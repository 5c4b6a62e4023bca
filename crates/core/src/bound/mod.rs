//! How wrong the position may be. One file a method family; two lists, [`METHODS`] of bounds of one epoch and [`ALGORITHMS`] of protection
//! levels, that everything else reads.

mod algorithm;
pub mod anp;
pub mod araim;
#[expect(clippy::module_inception, reason = "the stage and its result have one name")]
mod bound;
pub mod ee;
pub mod faults;
pub mod gbas;
mod integrity;
pub mod level_equation;
mod method;
mod protection;
pub mod raim;
pub mod rraim;
pub mod sbas;
mod sight;
pub mod tse;
pub mod vertical;

pub use crate::quantity::Provenance;
pub use algorithm::{Algorithm, Entry, Ranges, Task};
pub use bound::{AlertBound, Alerting, Bound, MayNotAlert};
pub use integrity::IntegrityComparison;
pub use method::{Bounded, Method, Promises};
pub use protection::Protection;
pub use sight::{Levels, NoLevels, Sight};

/// Every method, family by family. Command-line choices, report legends, the documentation page, `navbound methods` and the contract
/// tests read this list; a method is one entry in its family's file.
pub const METHODS: &[&[Method]] = &[tse::METHODS, anp::METHODS];

algorithm::algorithms! {
    sights:
        raim::Monitor,
        araim::listed::Separation,
        araim::listed::Araim,
        sbas::Sbas,
        gbas::levels::Gbas;
    others:
        rraim::single::PROTECTION,
        rraim::multiple::PROTECTION,
        ee::PROTECTION,
}

/// Every method in one sequence.
pub fn methods() -> impl Iterator<Item = &'static Method> {
    METHODS.iter().flat_map(|family| family.iter())
}

/// The method with this id.
pub fn method(id: &str) -> Option<&'static Method> {
    methods().find(|m| m.id == id)
}
