//! Advanced receiver autonomous integrity monitoring: protection levels by solution separation over fault modes.
//!
//! In the order of the flow: [`service`] (what is allowed and what satellites promise), [`modes`] (what may be wrong together), the
//! solutions without each mode's satellites, and here thresholds and levels.

mod ceiling;
pub mod exclusion;
pub mod listed;
pub mod modes;
pub mod ranging;
mod separation;
pub mod service;
pub mod single;
mod subset;

use super::level_equation::LevelEquation;
use super::{Protection, Provenance, Sight};
use crate::quantity::{Metres, Risk, Unavailable};
use crate::special::float::{hypot, sqrt};
use crate::special::one_sided_factor;
use ceiling::Ceiling;
use modes::{FaultMode, FaultModes, MOST_MODES, MOST_SATELLITES};
use separation::Separation;
use service::Service;
use subset::Sums;

/// Document of every formula here; provenance *standard*.
pub const SOURCE: &str = "Blanch et al. 2015, baseline advanced RAIM user algorithm; Working Group C, ARAIM airborne algorithm description v3.0 (standard; levels checked against MAAST for ARAIM 2)";

/// What the levels are.
pub const PROTECTION: Protection = Protection {
    id: "araim",
    title: "ARAIM: solution separation over satellite and constellation faults",
    function: "navbound.araim.protection_levels",
    source: SOURCE,
    provenance: Provenance::Standard,
    covers: "every fault mode likelier than the budget for unmonitored ones: satellites, constellations, several together",
    assumes: "the priors, ranging errors and nominal biases of the integrity support are bounds; none is broadcast today, so ours are inferred",
    integrity: true,
};

/// Protection levels of one epoch; infinite where the budget is spent on modes that cannot be monitored. The horizontal one is the root of
/// the sum of the squares of both axes.
pub type Levels = super::Levels<Detail>;

/// What solution separation says beside its levels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Detail {
    /// East and north.
    pub axes: [Metres; 2],
    /// Effective monitor threshold: the largest vertical threshold of a mode that the service counts.
    pub emt: Metres,
    /// Standard deviation of the position for accuracy, east, north, up.
    pub sigma_accuracy: [Metres; 3],
    /// Fault modes, the fault-free one among them, and those of them that the geometry can monitor.
    pub n_modes: usize,
    /// See above.
    pub n_monitored: usize,
    /// Probability of all that is not monitored.
    pub p_unmonitored: f64,
}

impl Levels {
    /// The larger of these levels and those of another decision, infinite where that has none.
    fn widen(&mut self, other: Option<&Self>) {
        let infinite = Metres::new(f64::INFINITY);
        let larger = |a: Metres, b: Metres| if b > a { b } else { a };
        self.hpl = larger(self.hpl, other.map_or(infinite, |o| o.hpl));
        self.vpl = self.vpl.map(|vpl| larger(vpl, other.and_then(|o| o.vpl).unwrap_or(infinite)));
        self.detail.axes = [0, 1].map(|a| larger(self.detail.axes[a], other.map_or(infinite, |o| o.detail.axes[a])));
    }

    /// Levels east, north and up that leave these unchanged when they are widened to them.
    #[inline(always)]
    fn limits(&self) -> [f64; 3] {
        // The axes may be those of different decisions: both together must stay within the horizontal level.
        let [east, north] = self.detail.axes.map(Metres::m);
        let both = hypot(east, north);
        let part = if both > self.hpl.m() { self.hpl.m() / both } else { 1.0 };
        [part * east, part * north, self.vpl_m()]
    }
}

/// One mode as the levels saw it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModeReport {
    /// The mode.
    pub mode: FaultMode,
    /// Whether the satellites left determine the position.
    pub monitored: bool,
    /// Standard deviation of the position without them, for integrity: east, north, up.
    pub sigma: [Metres; 3],
    /// Standard deviation of its separation from the position with all.
    pub sigma_separation: [Metres; 3],
    /// Largest effect of the nominal biases.
    pub bias: [Metres; 3],
    /// Detection threshold.
    pub threshold: [Metres; 3],
}

/// Detection and levels, epoch after epoch. No heap; made once and used again, since it is large.
#[derive(Debug, Clone, Default)]
pub struct Monitor {
    /// With every satellite of the epoch.
    every: Separation,
    /// After an exclusion, and what its levels cannot exceed.
    rest: Separation,
    ceiling: Ceiling,
    solver: Solver,
}

/// What the levels of a decision may take, and against what.
#[derive(Debug, Clone, Copy)]
struct Terms<'a> {
    modes: &'a FaultModes,
    service: &'a Service,
    /// Of the integrity risk.
    share: f64,
}

impl Terms<'_> {
    /// What is left for the levels east, north and up after the modes that are not monitored: half of the horizontal risk for each axis.
    #[inline(always)]
    fn budgets(&self, p_unmonitored: f64) -> [f64; 3] {
        let left = self.share * (1.0 - p_unmonitored / self.service.integrity());
        let half = 0.5 * self.service.integrity_h.q();
        [half * left, half * left, self.service.integrity_v.q() * left]
    }
}

/// From separations to levels.
#[derive(Debug, Clone, Default)]
struct Solver {
    equation: LevelEquation,
    factors: Factors,
}

/// Multipliers of the thresholds, worked out once for each number of modes.
#[derive(Debug, Clone)]
struct Factors {
    false_alarm: [f64; 2],
    known: [Option<[f64; 3]>; MOST_MODES],
}

impl Default for Factors {
    fn default() -> Self {
        Self { false_alarm: [0.0; 2], known: [None; MOST_MODES] }
    }
}

impl Factors {
    /// Q^-1(P_FA / (4 N)) in the horizontal (two axes, two sides), Q^-1(P_FA / (2 N)) in the vertical.
    #[inline(always)]
    fn of(&mut self, service: &Service, faults: usize) -> [f64; 3] {
        let false_alarm = [service.false_alarm_h.q(), service.false_alarm_v.q()];
        if self.false_alarm != false_alarm {
            *self = Self { false_alarm, known: [None; MOST_MODES] };
        }
        if faults == 0 {
            return [0.0; 3];
        }
        let work_out = || {
            let n = faults as f64;
            let h = one_sided_factor(0.25 * false_alarm[0] / n);
            [h, h, one_sided_factor(0.5 * false_alarm[1] / n)]
        };
        match self.known.get_mut(faults) {
            Some(known) => *known.get_or_insert_with(work_out),
            None => work_out(),
        }
    }
}

impl Monitor {
    /// Protection levels by detection alone: what bounds the error as long as no separation exceeds its threshold.
    ///
    /// ```text
    /// T_k = K_fa sigma_ss,k + sum |s_k - s_0| b_cont
    /// 2 Qm((PL - b_0)/s_0) + sum_k p_k Qm((PL - T_k - b_k)/s_k) = P_HMI,axis (1 - P_nm / P_HMI)        each axis
    /// HPL = sqrt(PL_e^2 + PL_n^2)
    /// ```
    ///
    /// # Errors
    /// [`Unavailable`]: too few satellites, a geometry that does not determine the position, a number that is none.
    #[inline(always)]
    pub fn levels(&mut self, sights: &[Sight], modes: &FaultModes, service: &Service) -> Result<Levels, Unavailable> {
        self.solver.levels(&mut self.every, sights, &[], &Terms { modes, service, share: 1.0 })
    }

    /// The modes of the last epoch as its levels saw them; `modes` and `service` are those of that call.
    pub fn report<'a>(&'a mut self, modes: &'a FaultModes, service: &Service) -> impl Iterator<Item = ModeReport> + 'a {
        let factors = self.solver.factors.of(service, self.every.faults(modes));
        modes.iter().zip(&self.every.outcome).map(move |(mode, outcome)| {
            let sums = outcome.unwrap_or_default();
            let root = |x: [f64; 3]| x.map(|v| Metres::new(sqrt(v)));
            ModeReport {
                mode: *mode,
                monitored: outcome.is_some(),
                sigma: root(sums.variance),
                sigma_separation: root(sums.separation),
                bias: sums.bias.map(Metres::new),
                threshold: [0, 1, 2].map(|a| Metres::new(threshold(&sums, &factors, a))),
            }
        })
    }
}

impl Solver {
    /// Levels of some satellites, with residuals for [`Solver::ratios`] where there are any.
    #[inline(always)]
    fn levels(&mut self, of: &mut Separation, sights: &[Sight], residuals_m: &[f64], terms: &Terms<'_>) -> Result<Levels, Unavailable> {
        checked(sights)?;
        let (monitored, p_unmonitored) = of.separate(sights, residuals_m, terms.modes)?;
        let factors = self.factors.of(terms.service, monitored.saturating_sub(1));
        let emt = effective_monitor_threshold(of, terms, &factors);
        let [east, north, up] = self.axis_levels(of, terms, &factors, terms.budgets(p_unmonitored));
        let detail = Detail {
            axes: [Metres::new(east), Metres::new(north)],
            emt,
            sigma_accuracy: of.sigma_accuracy(),
            n_modes: terms.modes.len(),
            n_monitored: monitored,
            p_unmonitored,
        };
        Ok(Levels::of(Metres::new(hypot(east, north)), Metres::new(up), detail))
    }

    /// Separation of every monitored mode against its threshold, the largest of the axes, with the mode's satellites.
    fn ratios(&mut self, of: &Separation, modes: &FaultModes, service: &Service, mut each: impl FnMut(u64, f64)) {
        let factors = self.factors.of(service, of.faults(modes));
        for (mode, outcome) in modes.iter().zip(&of.outcome).skip(1) {
            let Some(sums) = outcome else { continue };
            let ratio = |a: usize| {
                let moved = sums.moved[a].abs();
                // Satellites that do not count move nothing and have no threshold; below a micrometre is rounding.
                if moved > 1e-6 { moved / threshold(sums, &factors, a) } else { 0.0 }
            };
            each(mode.satellites, ratio(0).max(ratio(1)).max(ratio(2)));
        }
    }

    #[inline(always)]
    fn axis_levels(&mut self, of: &Separation, terms: &Terms<'_>, factors: &[f64; 3], budgets: [f64; 3]) -> [f64; 3] {
        let mut levels = [f64::INFINITY; 3];
        for a in 0..3 {
            if let Ok(risk) = Risk::new(budgets[a]) {
                levels[a] = self.axis_level(of, terms.modes, risk, factors, a);
            }
        }
        levels
    }

    #[inline(always)]
    fn axis_level(&mut self, of: &Separation, modes: &FaultModes, risk: Risk, factors: &[f64; 3], a: usize) -> f64 {
        self.equation.clear();
        for (k, (mode, outcome)) in modes.iter().zip(&of.outcome).enumerate() {
            let Some(sums) = outcome else { continue };
            // The fault-free error has two tails.
            let (weight, threshold) = if k == 0 { (2.0, 0.0) } else { (mode.p, threshold(sums, factors, a)) };
            let pushed = self.equation.push(weight, Metres::new(threshold + sums.bias[a]), Metres::new(sqrt(sums.variance[a])));
            // There are as many places as modes; a sigma that is no number leaves no level.
            if pushed.is_err() {
                return f64::INFINITY;
            }
        }
        self.equation.level(risk).m()
    }
}

#[inline(always)]
fn effective_monitor_threshold(of: &Separation, terms: &Terms<'_>, factors: &[f64; 3]) -> Metres {
    let counted = terms.modes.iter().zip(&of.outcome).skip(1).filter(|(m, _)| m.p >= terms.service.effective_monitor.q());
    Metres::new(counted.filter_map(|(_, o)| o.as_ref()).map(|s| threshold(s, factors, 2)).fold(0.0, f64::max))
}

#[inline(always)]
fn threshold(sums: &Sums, factors: &[f64; 3], axis: usize) -> f64 {
    factors[axis] * sqrt(sums.separation[axis]) + sums.bias_continuity[axis]
}

#[inline(always)]
fn checked(sights: &[Sight]) -> Result<(), Unavailable> {
    if sights.len() > MOST_SATELLITES {
        let (value, domain) = (sights.len() as f64, "at most 64 satellites");
        return Err(Unavailable::Invalid { field: "n_sv", value, unit: "1", domain });
    }
    for s in sights {
        let finite = |x: f64, least: f64| x >= least && x < f64::INFINITY;
        let good = (s.unit.norm_squared() - 1.0).abs() < 1e-3
            && finite(s.integrity_m2, f64::MIN_POSITIVE)
            && finite(s.accuracy_m2, f64::MIN_POSITIVE)
            && finite(s.bias.m(), 0.0)
            && finite(s.bias_continuity.m(), 0.0);
        if !good {
            return Err(invalid(s));
        }
    }
    Ok(())
}

#[cold]
fn invalid(s: &Sight) -> Unavailable {
    let positive = [("sigma_int_m", s.integrity_m2), ("sigma_acc_m", s.accuracy_m2)];
    for (field, m2) in positive {
        if !(f64::MIN_POSITIVE..f64::INFINITY).contains(&m2) {
            // The sign is the caller's: a negative sigma comes as a negative square.
            let value = if m2 < 0.0 { -sqrt(-m2) } else { sqrt(m2) };
            return Unavailable::Invalid { field, value, unit: "m", domain: "(0, inf)" };
        }
    }
    for (field, b) in [("bias_m", s.bias.m()), ("bias_continuity_m", s.bias_continuity.m())] {
        if !(0.0..f64::INFINITY).contains(&b) {
            return Unavailable::Invalid { field, value: b, unit: "m", domain: "[0, inf)" };
        }
    }
    Unavailable::Invalid { field: "unit", value: s.unit.norm(), unit: "1", domain: "unit vectors" }
}

#[cfg(test)]
mod tests;
