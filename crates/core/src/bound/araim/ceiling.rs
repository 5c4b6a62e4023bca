//! What the levels after an exclusion cannot exceed, without working them out.
//!
//! The levels that are promised beforehand are the largest of many decisions, and most decisions are far from being the largest. From the
//! solution with every satellite the variance without any two is one quotient, and what else a level needs is bounded by variances:
//!
//! ```text
//! var_(ij)  = var_(i) + S_(i)j^2 / (Pi_jj - Pi_ij^2 / Pi_ii)                                                exact
//! sigma_ss^2 <= max(v_acc / v_int) (var_(ij) - var_(i))        the separation is that of two least-squares solutions
//! sum |s_k| b_k <= sqrt(var_(ij) sum b_k^2 / v_k)              Cauchy and Schwarz; the nominal biases of the separation likewise
//! ```
//!
//! With these the sum of the level equation is too large everywhere; where it is within the risk nevertheless, the level lies below.
//! Provenance *ours*: no level depends on it but by rounding, only whether it is worked out.

use super::modes::{FaultMode, FaultModes, MOST_SATELLITES};
use super::separation::Separation;
use super::subset::{GROUPS, Group, LANES, Removed, Satellites, Solution};
use super::{Solver, Terms};
use crate::bound::level_equation::{LevelEquation, NoLevel};
use crate::quantity::Metres;
use crate::signal::Constellation;
use crate::solution::wls::CONDITION_LIMIT;
use crate::special::float::sqrt;

const CLOCKS: usize = Constellation::ALL.len();
/// A geometry this much better than one that counts as singular is not singular after rounding either.
const CERTAINLY_SOLVED: f64 = 1e-3;
/// Likewise the share of its weight that a satellite's residual must show.
const CERTAINLY_REDUNDANT: f64 = 1e-6;
/// The sum must stay this much below the risk: more than rounding, which is below 1e-12.
const CERTAINLY_BELOW: f64 = 1.0 - 1e-6;

/// Eight modes abreast.
#[derive(Debug, Clone, Copy)]
struct Lanes {
    p: [f64; LANES],
    variance: [[f64; LANES]; 3],
    /// What the variance has more than that of the decision's own solution.
    more: [[f64; LANES]; 3],
    /// Of the sum of b^2 / v over the satellites that are left.
    root_load: [f64; LANES],
    certain: [bool; LANES],
}

const EMPTY: Lanes =
    Lanes { p: [0.0; LANES], variance: [[1.0; LANES]; 3], more: [[0.0; LANES]; 3], root_load: [0.0; LANES], certain: [false; LANES] };

/// Made once and filled again for every epoch.
#[derive(Debug, Clone)]
pub(super) struct Ceiling {
    /// Pi_jj of every satellite.
    own: [[f64; LANES]; GROUPS],
    /// Largest variance of the position without each satellite, of the solutions with all and without one constellation.
    damage: [[f64; LANES]; GROUPS],
    /// Trace of the information.
    trace: f64,
    /// Sums of b^2 / v: for integrity, of each constellation's satellites, for continuity.
    load: f64,
    load_of: [f64; CLOCKS],
    load_continuity: f64,
    /// Largest ratio of the variances for accuracy and for integrity.
    accuracy: f64,
    /// Modes of one satellite in its place, then one group with the fault-free one and whole constellations.
    lanes: [Lanes; GROUPS + 1],
    groups: usize,
}

impl Default for Ceiling {
    fn default() -> Self {
        let (own, damage) = ([[0.0; LANES]; GROUPS], [[0.0; LANES]; GROUPS]);
        let [trace, load, load_continuity, accuracy] = [0.0; 4];
        Self { own, damage, trace, load, load_of: [0.0; CLOCKS], load_continuity, accuracy, lanes: [EMPTY; GROUPS + 1], groups: 0 }
    }
}

/// What is known of a decision beside its modes' variances.
struct Known {
    /// Monitored modes without the fault-free one.
    faults: usize,
    p_unmonitored: f64,
    load_continuity: f64,
}

impl Ceiling {
    /// Take up the satellites of an epoch.
    #[inline(always)]
    pub(super) fn fill(&mut self, every: &Separation) {
        let satellites = &every.satellites;
        let filled = satellites.filled();
        (self.groups, self.trace) = (filled.len(), satellites.information(0).trace());
        (self.load, self.load_of, self.load_continuity, self.accuracy) = (0.0, [0.0; CLOCKS], 0.0, 0.0);
        for group in filled {
            for l in (0..LANES).filter(|l| group.weight[*l] > 0.0) {
                let (load, load_continuity) = loads(group, l);
                (self.load, self.load_continuity) = (self.load + load, self.load_continuity + load_continuity);
                self.load_of[group.clock[l] as usize] += load;
                self.accuracy = self.accuracy.max(group.accuracy[l] * group.weight[l]);
            }
        }
        for (g, (group, gains)) in filled.iter().zip(&every.all.gains).enumerate() {
            self.own[g] = own(satellites, group, gains);
            self.damage[g] = damage(&every.all, &self.own[g], gains);
        }
        for base in every.without_one() {
            for (g, (group, gains)) in filled.iter().zip(&base.gains).enumerate() {
                let more = damage(base, &own(satellites, group, gains), gains);
                for l in 0..LANES {
                    self.damage[g][l] = self.damage[g][l].max(more[l]);
                }
            }
        }
    }

    /// How large levels are to be expected without some satellites: more for several than for any one.
    #[inline(always)]
    pub(super) fn damage(&self, out: u64) -> f64 {
        let i = out.trailing_zeros() as usize;
        if out.count_ones() == 1 { self.damage[i / LANES][i % LANES] } else { f64::INFINITY }
    }

    /// Whether the levels east, north and up without the satellites `out` are `limits` or less for certain. `false` says nothing.
    #[inline(always)]
    pub(super) fn holds(&mut self, every: &mut Separation, solver: &mut Solver, out: u64, terms: &Terms<'_>, limits: &[f64; 3]) -> bool {
        if out.count_ones() != 1 {
            return false;
        }
        let Some(known) = self.look(every, out.trailing_zeros() as usize, terms.modes) else {
            return false;
        };
        let factors = solver.factors.of(terms.service, known.faults);
        let (budgets, accuracy, continuity) = (terms.budgets(known.p_unmonitored), sqrt(self.accuracy), sqrt(known.load_continuity));
        for a in 0..3 {
            let equated = self.equate(&mut solver.equation, a, factors[a] * accuracy + continuity).is_ok();
            let below = equated && budgets[a] > 0.0 && solver.equation.risk_beyond(Metres::new(limits[a])) <= CERTAINLY_BELOW * budgets[a];
            if !below {
                return false;
            }
        }
        true
    }

    /// Variances of every mode after satellite `out` left; `None` where something is not certain or is no simple mode.
    #[inline(always)]
    fn look(&mut self, every: &mut Separation, out: usize, modes: &FaultModes) -> Option<Known> {
        let variance = self.pairs(every, out)?;
        let (out_load, out_continuity) = loads(every.satellites.groups.get(out / LANES)?, out % LANES);
        let load = self.load - out_load;
        let mut known = Known { faults: 0, p_unmonitored: modes.left(), load_continuity: self.load_continuity - out_continuity };
        let last = self.groups;
        self.lanes[last] = EMPTY;
        self.put(last, 0, 2.0, &variance, &variance, load);
        let bit = 1_u64 << out;
        let emptied = (0..CLOCKS).filter(|c| every.satellites.members[*c] == bit).fold(0, |e, c| e | 1 << c);
        let left = every.satellites.count - 1;
        let mut wholes = 0;
        for mode in modes.iter().skip(1) {
            let (need, _) = every.satellites.need_and_have(mode.constellations | emptied);
            if left - (mode.satellites.count_ones() as usize).min(left) < need {
                known.p_unmonitored += mode.p;
                continue;
            }
            known.faults += 1;
            // The decision's modes number the satellites that are left.
            let below = mode.satellites & (bit - 1);
            let set = below | (mode.satellites & !(bit - 1)) << 1;
            if mode.constellations == 0 {
                let j = set.trailing_zeros() as usize;
                let lanes = self.lanes.get_mut(j / LANES).filter(|lanes| set.count_ones() == 1 && lanes.certain[j % LANES])?;
                lanes.p[j % LANES] = mode.p;
            } else {
                wholes += 1;
                let (wide, load) = self.whole(every, &FaultMode { satellites: set, ..*mode }, out, load)?;
                self.put(last, wholes, mode.p, &wide, &variance, load);
            }
        }
        Some(known)
    }

    /// The variance without `out`, and that without each satellite more.
    #[inline(always)]
    fn pairs(&mut self, every: &Separation, out: usize) -> Option<[f64; 3]> {
        let removed = Removed::new(&every.satellites, &every.all, [out], CERTAINLY_REDUNDANT)?;
        let variance = self.solved(&every.all, &removed)?;
        let (own, w_out) = (self.own[out / LANES][out % LANES], every.satellites.groups[out / LANES].weight[out % LANES]);
        let (out_load, _) = loads(&every.satellites.groups[out / LANES], out % LANES);
        let square = w_out * w_out / own;
        for (g, (group, gains)) in every.satellites.filled().iter().zip(&every.all.gains).enumerate() {
            let (q, lanes) = (removed.shares(0, group, gains), &mut self.lanes[g]);
            let mut inverse = [0.0; LANES];
            for l in 0..LANES {
                let pivot = self.own[g][l] - square * q[l] * q[l];
                lanes.certain[l] = pivot >= CERTAINLY_REDUNDANT * group.weight[l];
                inverse[l] = 1.0 / pivot;
                lanes.root_load[l] = sqrt((self.load - out_load - loads(group, l).0).max(0.0));
                lanes.p[l] = 0.0;
            }
            for a in 0..3 {
                for l in 0..LANES {
                    let gain = gains[a][l] + removed.factor[0][a] * q[l];
                    lanes.more[a][l] = gain * gain * inverse[l];
                    lanes.variance[a][l] = variance[a] + lanes.more[a][l];
                }
            }
        }
        Some(variance)
    }

    /// The variance without the satellites of a mode that is one whole constellation, and without `out`; and what is left of the load.
    #[inline(always)]
    fn whole(&self, every: &mut Separation, mode: &FaultMode, out: usize, load: f64) -> Option<([f64; 3], f64)> {
        let (c, bit) = (mode.constellations.trailing_zeros() as usize, 1_u64 << out);
        let members = *every.satellites.members.get(c)?;
        if mode.constellations.count_ones() != 1 || mode.satellites != members & !bit || !every.solve_without(c) {
            return None;
        }
        let base = &every.without[c];
        if members & bit != 0 {
            let (out_load, _) = loads(&every.satellites.groups[out / LANES], out % LANES);
            return Some((base.variance, load + out_load - self.load_of[c]));
        }
        let removed = Removed::new(&every.satellites, base, [out], CERTAINLY_REDUNDANT)?;
        Some((self.solved(base, &removed)?, load - self.load_of[c]))
    }

    /// The variance after a removal, where the geometry is certainly good enough.
    #[inline(always)]
    fn solved(&self, base: &Solution, removed: &Removed<1>) -> Option<[f64; 3]> {
        let variance = [0, 1, 2].map(|a| base.variance[a] + removed.added[a]);
        let condition = self.trace * (variance[0] + variance[1] + variance[2]);
        if condition <= CERTAINLY_SOLVED * CONDITION_LIMIT { Some(variance) } else { None }
    }

    #[inline(always)]
    fn put(&mut self, g: usize, l: usize, p: f64, variance: &[f64; 3], least: &[f64; 3], load: f64) {
        let lanes = &mut self.lanes[g];
        (lanes.p[l], lanes.root_load[l]) = (p, sqrt(load.max(0.0)));
        for a in 0..3 {
            (lanes.variance[a][l], lanes.more[a][l]) = (variance[a], (variance[a] - least[a]).max(0.0));
        }
    }

    /// The equation of one axis with every number as large as it can be.
    #[inline(always)]
    fn equate(&self, equation: &mut LevelEquation, a: usize, factor: f64) -> Result<(), NoLevel> {
        equation.clear();
        for lanes in &self.lanes[..=self.groups] {
            let (mut shift, mut sigma) = ([0.0; LANES], [1.0; LANES]);
            for l in 0..LANES {
                let (s, by) = (sqrt(lanes.variance[a][l]), sqrt(lanes.more[a][l]));
                let some = lanes.p[l] > 0.0;
                sigma[l] = if some { s } else { 1.0 };
                shift[l] = if some { factor * by + lanes.root_load[l] * s } else { 0.0 };
            }
            equation.push_abreast(&lanes.p, &shift, &sigma)?;
        }
        Ok(())
    }
}

/// Pi_jj of eight satellites in a solution.
#[inline(always)]
fn own(satellites: &Satellites, group: &Group, gains: &[[f64; LANES]; 3]) -> [f64; LANES] {
    let mut own = [0.0; LANES];
    for l in 0..LANES {
        let share = satellites.weight.get(group.clock[l] as usize).map_or(0.0, |all| group.weight[l] / all);
        let across = gains[0][l] * group.centred[0][l] + gains[1][l] * group.centred[1][l] + gains[2][l] * group.centred[2][l];
        own[l] = group.weight[l] * (1.0 - share + across);
    }
    own
}

/// Sum of the position's variances without each of eight satellites.
#[inline(always)]
fn damage(base: &Solution, own: &[f64; LANES], gains: &[[f64; LANES]; 3]) -> [f64; LANES] {
    let mut sums = [base.variance[0] + base.variance[1] + base.variance[2]; LANES];
    for l in 0..LANES {
        sums[l] += (gains[0][l] * gains[0][l] + gains[1][l] * gains[1][l] + gains[2][l] * gains[2][l]) / own[l];
    }
    sums
}

/// b^2 / v of a satellite, for integrity and for continuity.
#[inline(always)]
fn loads(group: &Group, l: usize) -> (f64, f64) {
    (group.bias[l] * group.bias[l] * group.weight[l], group.bias_continuity[l] * group.bias_continuity[l] * group.weight[l])
}

const _: () = assert!(CLOCKS < LANES && MOST_SATELLITES <= 64);
