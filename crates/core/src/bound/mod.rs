//! How wrong the position may be. One file a method family; one list, [`METHODS`], that everything else reads.

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
pub mod tse;
pub mod vertical;

pub use crate::quantity::Provenance;
pub use bound::{AlertBound, Alerting, Bound, MayNotAlert};
pub use integrity::IntegrityComparison;
pub use method::{Bounded, Method, Promises};
pub use protection::Protection;

/// Every method, family by family. Command-line choices, report legends, the documentation page, `navbound methods` and the contract
/// tests read this list; a method is one entry in its family's file.
pub const METHODS: &[&[Method]] = &[tse::METHODS, anp::METHODS];

/// Every algorithm of protection levels, in the order in which an aircraft meets them: en route, on approach, on the ground, experimental.
pub const PROTECTION: &[Protection] = &[
    raim::PROTECTION,
    araim::single::PROTECTION,
    araim::PROTECTION,
    sbas::PROTECTION,
    gbas::PROTECTION,
    rraim::single::PROTECTION,
    rraim::multiple::PROTECTION,
    ee::PROTECTION,
];

/// Every method in one sequence.
pub fn methods() -> impl Iterator<Item = &'static Method> {
    METHODS.iter().flat_map(|family| family.iter())
}

/// The method with this id.
pub fn method(id: &str) -> Option<&'static Method> {
    methods().find(|m| m.id == id)
}
