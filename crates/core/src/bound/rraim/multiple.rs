//! Levels over all faults together: equation 17.

use super::coast::{Coast, Travel};
use super::single::Fix;
use crate::bound::faults::{FaultModes, MOST_MODES, NoModes};
use crate::bound::level_equation::LevelEquation;
use crate::bound::{Protection, Provenance};
use crate::quantity::{Metres, Reason, Risk, Unavailable};
use crate::special::float::{hypot, sqrt};
use crate::special::one_sided_factor;

/// What the levels are.
pub const PROTECTION: Protection = Protection {
    id: "rraim-multiple",
    title: "RRAIM, all faults together",
    function: "navbound.rraim.protection_levels",
    source: super::SOURCE,
    provenance: Provenance::ReDerived,
    covers: "satellite and constellation faults that begin while coasting, several together",
    assumes: "as rraim-single; a fault of a whole constellation is as likely as its rate times the coasting time",
    integrity: true,
};

/// Why there is no level: data, counted.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum NoLevel {
    /// The geometry does not serve.
    #[error(transparent)]
    Geometry(#[from] Unavailable),
    /// The faults cannot be listed.
    #[error(transparent)]
    Modes(#[from] NoModes),
    /// Faults that cannot be monitored are likelier than all that is allotted.
    #[error("faults of risk {not_monitored:e} cannot be monitored, {allotted:e} is allotted")]
    Budget {
        /// Probability of faults without a mode.
        not_monitored: f64,
        /// The risk allotted.
        allotted: f64,
    },
    /// The equation has no root: a number of it is not finite.
    #[error("the level equation was given a number that is not finite")]
    Equation,
}

impl NoLevel {
    /// Its entry in the list of reasons.
    pub const fn reason(&self) -> Reason {
        match self {
            Self::Geometry(why) => why.reason(),
            Self::Modes(why) => why.reason(),
            Self::Budget { .. } => Reason::RiskBudgetSpent,
            Self::Equation => Reason::NoRoot,
        }
    }
}

/// Risks of equation 17.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Budget {
    /// Integrity risk of faults that begin while coasting; half of it for each axis.
    pub allotted: Risk,
    /// Continuity risk: thresholds at Q^-1(CR / 4 modes).
    pub continuity: Risk,
}

/// One mode and one axis.
#[derive(Debug, Clone, Copy, Default)]
struct Term {
    p: f64,
    sigma: f64,
    separation: f64,
    gain: f64,
    separation_gain: f64,
}

/// Everything that does not depend on the size of the bias. Large, so made once and filled again.
#[derive(Debug, Clone)]
pub struct MultipleFaults {
    terms: [[Term; 2]; MOST_MODES],
    all: [Term; 2],
    count: usize,
    not_monitored: f64,
}

impl Default for MultipleFaults {
    fn default() -> Self {
        Self { terms: [[Term::default(); 2]; MOST_MODES], all: [Term::default(); 2], count: 0, not_monitored: 0.0 }
    }
}

impl MultipleFaults {
    /// Work out every mode; `self` is overwritten.
    ///
    /// # Errors
    /// [`Unavailable`] where the geometry does not determine the position with all satellites. Modes whose rest does not determine it count
    /// as not monitored.
    pub fn fill(&mut self, fix: &Fix<'_>, coast: &Coast, modes: &FaultModes) -> Result<(), Unavailable> {
        let all = coast.all()?;
        (self.count, self.not_monitored) = (0, modes.left());
        self.all = axes(fix, &all, &all, 2.0);
        for mode in modes.iter().skip(1) {
            match coast.without(mode.satellites) {
                Ok(less) => {
                    self.terms[self.count] = axes(fix, &less, &all, mode.p);
                    self.count += 1;
                }
                Err(_) => self.not_monitored += mode.p,
            }
        }
        Ok(())
    }

    /// Probability of faults without a mode.
    pub const fn not_monitored(&self) -> f64 {
        self.not_monitored
    }
    /// Modes monitored.
    pub const fn len(&self) -> usize {
        self.count
    }
    /// None.
    pub const fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Levels east and north, and the horizontal one, for a size of the bias.
    ///
    /// ```text
    /// 2 Qm((PL - b_0)/s_0) + sum_k p_k Qm((PL - T_k - b_k)/s_k) = (PHMI/2)(1 - P_nm/PHMI)        HPL = |(PL_e, PL_n)|
    /// T_k = Q^-1(CR / 4 modes) s_ss,k + bias of the separation
    /// ```
    ///
    /// # Errors
    /// [`NoLevel::Budget`] where faults that cannot be monitored take all of the risk.
    pub fn levels(&self, bias: Metres, budget: &Budget, equation: &mut LevelEquation) -> Result<[Metres; 3], NoLevel> {
        let (allotted, not_monitored) = (budget.allotted.q(), self.not_monitored);
        let risk = Risk::new((allotted - not_monitored) / 2.0).map_err(|_| NoLevel::Budget { not_monitored, allotted })?;
        let alarm = one_sided_factor(budget.continuity.q() / (4.0 * self.count.max(1) as f64));
        let [e, n] = [self.axis(0, bias.m(), alarm, risk, equation)?, self.axis(1, bias.m(), alarm, risk, equation)?];
        Ok([e, n, Metres::new(hypot(e.m(), n.m()))])
    }

    fn axis(&self, axis: usize, bias: f64, alarm: f64, risk: Risk, equation: &mut LevelEquation) -> Result<Metres, NoLevel> {
        equation.clear();
        let mut push =
            |p: f64, shift: f64, sigma: f64| equation.push(p, Metres::new(shift), Metres::new(sigma)).map_err(|_| NoLevel::Equation);
        let all = &self.all[axis];
        push(all.p, all.gain * bias, all.sigma)?;
        for term in self.terms[..self.count].iter().map(|t| &t[axis]) {
            let threshold = alarm * term.separation + term.separation_gain * bias;
            push(term.p, threshold + term.gain * bias, term.sigma)?;
        }
        Ok(equation.level(risk))
    }
}

/// A travel's terms east and north.
fn axes(fix: &Fix<'_>, less: &Travel, all: &Travel, p: f64) -> [Term; 2] {
    let now = less.covariance(&fix.covariance);
    let apart = less.separation(all, &fix.covariance);
    let moved = less.carried - all.carried;
    let mut terms = [Term { p, ..Term::default() }; 2];
    for (axis, term) in terms.iter_mut().enumerate() {
        term.sigma = sqrt(now.matrix()[(axis, axis)]);
        // A difference that is zero but for rounding, for the solution with all.
        term.separation = sqrt(apart.matrix()[(axis, axis)].max(0.0));
        let (row, moved_row) = (less.carried.row(axis), moved.row(axis));
        for s in fix.snapshot.responses() {
            term.gain += (row * s).x.abs();
            term.separation_gain += (moved_row * s).x.abs();
        }
    }
    terms
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::special::normal::tail;

    #[test]
    fn a_level_is_the_root_of_equation_17_with_its_threshold() {
        let all = Term { p: 2.0, sigma: 1.0, gain: 0.5, ..Term::default() };
        let less = Term { p: 1e-4, sigma: 2.0, separation: 1.5, gain: 0.8, separation_gain: 0.3 };
        let filled = MultipleFaults { terms: [[less; 2]; MOST_MODES], all: [all; 2], count: 1, not_monitored: 1e-9 };
        let budget = Budget { allotted: Risk::new(1e-7).unwrap(), continuity: Risk::new(8e-6).unwrap() };
        let [east, north, horizontal] = filled.levels(Metres::new(4.0), &budget, &mut LevelEquation::default()).unwrap();
        // Four metres of bias: 2 m in the position of all, 3.2 m in that of the rest, 1.2 m between them.
        let threshold = 1.5 * one_sided_factor(2e-6) + 1.2;
        let risk = 2.0 * tail((east.m() - 2.0) / 1.0) + 1e-4 * tail((east.m() - threshold - 3.2) / 2.0);
        // The last step of third order begins within 1e-4 of the root, in the logarithm of the risk.
        assert!((risk / 4.95e-8 - 1.0).abs() < 1e-6, "{risk}");
        assert_eq!(east, north);
        assert!((horizontal.m() / east.m() - 2.0_f64.sqrt()).abs() < 1e-15);
    }
}
