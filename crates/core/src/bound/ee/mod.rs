//! The bound of Error Extraction: **experimental, not integrity**.
//!
//! In the order of the flow: [`noise`] (a window of extracted errors and its multiplier), [`bias`] (what a bias of every range can do), and
//! here their sum. The bound does not see UDRE, GIVE or any alarm of the service, recovers during a slow fault, and holds its risk only
//! under a law that position errors do not follow; `docs/methods/error-extraction.md` shows by how much. It exists to repeat a published
//! comparison and to show where it fails. Its lengths are [`NotIntegrity`], which nothing that alerts takes:
//!
//! ```compile_fail,E0308
//! use navbound_core::{bound::ee::NotIntegrity, quantity::Metres};
//! fn alert_above(bound: Metres) -> bool { !(bound.m() <= 40.0) }
//! alert_above(NotIntegrity::default());
//! ```

pub mod bias;
pub mod noise;

use super::{Promises, Protection, Provenance};

/// Where the bound comes from.
pub const SOURCE: &str = "Vassilev and Vassileva 2012, equations 5 to 7, with the corrections of docs/methods/error-extraction.md";
/// How we hold it: equation 5 is defective as printed.
pub const PROVENANCE: Provenance = Provenance::ReDerived;
/// What stands beside every number of it.
pub const LABEL: &str = "experimental, not integrity";
/// What must be true for the stated risk to be true.
pub const ASSUMES: &str =
    "extracted errors independent and exponential with one mean, and slow errors within the bias bound: real errors are neither";
/// What it promises: next to nothing.
pub const PROMISES: Promises =
    Promises { scales_with_length: false, ignores_north: true, monotone_in_risk: true, conservative: false, may_alert: false };

/// What the levels are.
pub const PROTECTION: Protection = Protection {
    id: "error-extraction",
    title: "Error Extraction, experimental",
    function: "navbound.sbas.error_extraction",
    source: SOURCE,
    provenance: PROVENANCE,
    covers: "nothing: it does not see alarms of the service and recovers during a slow fault",
    assumes: ASSUMES,
    integrity: PROMISES.may_alert,
};

/// A length \[m\] that bounds nothing with a known risk. It is not [`crate::quantity::Metres`], so no monitor can take it.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd, Default)]
pub struct NotIntegrity(f64);

impl NotIntegrity {
    const fn new(m: f64) -> Self {
        Self(m)
    }
    /// The number of metres, for columns that carry the label.
    pub const fn m(self) -> f64 {
        self.0
    }
}

/// A number of each kind, horizontal and vertical.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Both {
    /// Horizontal.
    pub horizontal: NotIntegrity,
    /// Vertical.
    pub vertical: NotIntegrity,
}

impl Both {
    pub(super) const fn new(horizontal_m: f64, vertical_m: f64) -> Self {
        Self { horizontal: NotIntegrity::new(horizontal_m), vertical: NotIntegrity::new(vertical_m) }
    }
    /// The bound: noise part plus bias part (section after equation 7).
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        Self::new(self.horizontal.m() + other.horizontal.m(), self.vertical.m() + other.vertical.m())
    }
}
