//! The RNP of a leg, from places that may disagree: its own field, the lines of minima, and what the caller selects.
//!
//! On the final approach the line that the caller selected counts (ours). Without one, the field counts where it is one of the published
//! lines; where they contradict each other, or the field is blank, the leg has no RNP and is not judged. Elsewhere the field counts.
//! A field above 5 NM is no RNP of a departure, arrival or approach (INFERRED) and is contradicted.
//! Where a field is blank, the default of the specification counts only if the caller allows it (1.0 NM; 0.3 NM on the final approach;
//! standard: ICAO Doc 9613).

use super::field::NAUTICAL_MILE_M;
use super::geometry::{Part, ProcedureLeg};
use super::record::LevelOfService;

/// Two RNP within this share of each other are one, written with other digits \[1\].
const ROUNDING: f64 = 0.01;

/// RNP of a terminal leg at most: that of RNAV 5, the widest specification of an arrival (INFERRED) \[m\].
pub(super) const TERMINAL_MOST_M: f64 = 5.0 * NAUTICAL_MILE_M;

/// Where the RNP of a leg comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Origin {
    /// The leg's field.
    Coded,
    /// The line of minima that the caller selected.
    Selected,
    /// The default of the specification, which the caller allowed.
    Default,
    /// None: the field is blank.
    NotCoded,
    /// None: the field is no published line of minima, or too large for any.
    Contradicted,
}

impl Origin {
    /// Stable id.
    pub const fn id(self) -> &'static str {
        match self {
            Self::Coded => "coded",
            Self::Selected => "selected",
            Self::Default => "default",
            Self::NotCoded => "not_coded",
            Self::Contradicted => "contradicted",
        }
    }
}

/// The RNP that a leg is judged by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LegRequirement {
    /// RNP \[m\]; NaN where it is unknown.
    pub rnp_m: f64,
    /// Where it comes from.
    pub origin: Origin,
    /// Whether the field and the line that counts differ by more than rounding.
    pub differs: bool,
}

impl LegRequirement {
    /// The requirement of a leg of a procedure with these lines of minima.
    pub fn of(leg: &ProcedureLeg, levels: &[LevelOfService], selected_m: Option<f64>, defaults: bool) -> Self {
        let coded = leg.leg.rnp_m;
        let is_final = leg.part == Part::Final;
        let (rnp_m, origin) = match (coded, selected_m) {
            (_, Some(line)) if is_final => (line, Origin::Selected),
            (Some(rnp), _) if too_large(rnp) => (f64::NAN, Origin::Contradicted),
            (Some(rnp), _) if !is_final || levels.is_empty() || published(rnp, levels) => (rnp, Origin::Coded),
            (Some(_), _) => (f64::NAN, Origin::Contradicted),
            (None, _) if defaults => (if is_final { 0.3 } else { 1.0 } * NAUTICAL_MILE_M, Origin::Default),
            (None, _) => (f64::NAN, Origin::NotCoded),
        };
        let unlike_line = coded.is_some_and(|c| rnp_m.is_finite() && !same(c, rnp_m));
        Self { rnp_m, origin, differs: unlike_line || origin == Origin::Contradicted }
    }
}

/// Whether an RNP is none of a departure, arrival or approach.
pub(super) fn too_large(rnp_m: f64) -> bool {
    !(rnp_m <= TERMINAL_MOST_M * (1.0 + ROUNDING))
}

/// Whether an RNP is one of the lines of minima.
pub(super) fn published(rnp_m: f64, levels: &[LevelOfService]) -> bool {
    levels.iter().any(|level| same(level.rnp_m, rnp_m))
}

fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= ROUNDING * a.max(b)
}
