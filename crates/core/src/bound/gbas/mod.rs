//! GBAS: from error models to protection levels and to what ground monitors must detect.
//!
//! In the order of the flow: [`range`] (errors of one range), [`snapshot`] (weighted solution), [`bias`] (worst effect of nominal
//! biases), [`levels`] (no fault, one faulty reference receiver), [`detection`] (missed-detection limit), [`noise`] (smoothed multipath of
//! unknown time constant), [`aided`] (the covariance with an inertial system), [`offset`] (whether a model of that noise bounds).

pub mod aided;
pub mod bias;
pub mod detection;
pub mod levels;
pub mod noise;
pub mod offset;
pub mod range;
pub mod snapshot;

use super::{Protection, Provenance};

/// Document of the system; our copy has no equations, tables or figures.
pub const SOURCE: &str = "Song, Milner and No 2024, NAVIGATION 71(4), navi.673, rebuilt: equations 2 to 10 after RTCA DO-245A and DO-253";

/// What the levels are.
pub const PROTECTION: Protection = Protection {
    id: "gbas",
    title: "GBAS with faults of one reference receiver",
    function: "navbound.gbas.protection_levels",
    source: SOURCE,
    provenance: Provenance::ReDerived,
    covers: "no fault (H0), one faulty reference receiver (H1); satellite faults are the ground monitors' part",
    assumes: "errors are within the models of the service; nominal biases are within the bound given; parameters that the paper does not give are inferred",
    integrity: true,
};

/// Most satellites in one solution.
pub const MOST_SATELLITES: usize = 48;
