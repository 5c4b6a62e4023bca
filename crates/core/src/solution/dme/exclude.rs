//! One range that contradicts all others: found by leaving each out in turn, or said not to be found.

use super::fix::{Altitude, Fix, NoFix, Prior, Range, solve};
use crate::quantity::{Reason, Risk};
use crate::special::float::ln;

/// A position and what its residuals say.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Checked {
    /// The position, of all ranges or of all but one.
    pub fix: Fix,
    /// What the residuals say.
    pub verdict: Verdict,
}

/// What the residuals say of the ranges.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// They do not contradict the weights, or there are none.
    Consistent,
    /// Without this range, by its place in the list, they no longer do.
    Excluded(usize),
    /// They do; three ranges do not tell which is wrong.
    TooFew,
    /// They do; leaving out one does not help, or leaving out another helps as much.
    Undecided,
}

impl Verdict {
    /// Its entry in the list of reasons; none where nothing contradicts.
    pub const fn reason(&self) -> Option<Reason> {
        match self {
            Self::Consistent => None,
            Self::Excluded(_) => Some(Reason::RangeExcluded),
            Self::TooFew => Some(Reason::RangesContradict),
            Self::Undecided => Some(Reason::RangesContradictStill),
        }
    }
}

/// The range left out must be this much likelier the wrong one than any other, all being as likely beforehand. Ours.
const EXCLUSION_ODDS: f64 = 1e3;
/// Ranges from which on what is left after an exclusion can be tested.
const RANGES_LEAST: usize = 4;

/// Position by [`solve`], its residuals tested at a risk; from four ranges on one that contradicts the others is left out.
///
/// Each is left out in turn. The one whose absence leaves the smallest sum of squares is excluded where that sum passes the test and every
/// other is larger by `2 ln(1000)`. The list comes back in the order that it had.
///
/// # Errors
/// As [`solve`] for all ranges together.
pub fn solve_checked(ranges: &mut [Range], altitude: &Altitude, prior: Option<&Prior>, risk: Risk) -> Result<Checked, NoFix> {
    let fix = solve(ranges, altitude, prior)?;
    let passes = |fix: &Fix| fix.p_residual.is_none_or(|p| p >= risk.q());
    if passes(&fix) {
        return Ok(Checked { fix, verdict: Verdict::Consistent });
    }
    if ranges.len() < RANGES_LEAST {
        return Ok(Checked { fix, verdict: Verdict::TooFew });
    }
    let mut best: Option<(usize, Fix)> = None;
    let mut second = f64::INFINITY;
    for k in 0..ranges.len() {
        let Ok(rest) = without(ranges, k, altitude, prior) else { continue };
        match &best {
            Some((_, known)) if known.chi_square <= rest.chi_square => second = second.min(rest.chi_square),
            known => {
                second = known.map_or(f64::INFINITY, |(_, known)| known.chi_square);
                best = Some((k, rest));
            }
        }
    }
    match best {
        Some((k, rest)) if passes(&rest) && second - rest.chi_square >= 2.0 * ln(EXCLUSION_ODDS) => {
            Ok(Checked { fix: rest, verdict: Verdict::Excluded(k) })
        }
        _ => Ok(Checked { fix, verdict: Verdict::Undecided }),
    }
}

/// The position of all but one: it stands last while the others are solved.
fn without(ranges: &mut [Range], k: usize, altitude: &Altitude, prior: Option<&Prior>) -> Result<Fix, NoFix> {
    let last = ranges.len() - 1;
    ranges.swap(k, last);
    let solution = solve(&ranges[..last], altitude, prior);
    ranges.swap(k, last);
    solution
}
