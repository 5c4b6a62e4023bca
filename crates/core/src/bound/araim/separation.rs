//! The solutions of one epoch: with all satellites, and without those of every fault mode.

use super::modes::{FaultMode, FaultModes, MOST_MODES};
use super::subset::{MOST_TOGETHER, NO_SOLUTION, Satellites, Solution, Sums};
use crate::bound::Sight;
use crate::quantity::{Metres, Unavailable};
use crate::signal::Constellation;
use crate::special::float::sqrt;

const CLOCKS: usize = Constellation::ALL.len();

/// Filled again for every epoch, since it is large.
#[derive(Debug, Clone)]
pub(super) struct Separation {
    pub(super) satellites: Satellites,
    pub(super) all: Solution,
    /// Solutions without one constellation, and which of them are worked out; then one without several.
    pub(super) without: [Solution; CLOCKS],
    solved: [Option<bool>; CLOCKS],
    several: Solution,
    /// Of every mode; `None` where it cannot be monitored.
    pub(super) outcome: [Option<Sums>; MOST_MODES],
}

impl Default for Separation {
    fn default() -> Self {
        Self {
            satellites: Satellites::default(),
            all: NO_SOLUTION,
            without: [NO_SOLUTION; CLOCKS],
            solved: [None; CLOCKS],
            several: NO_SOLUTION,
            outcome: [None; MOST_MODES],
        }
    }
}

impl Separation {
    /// Every subset of an epoch, whose numbers the caller has checked: how many can be monitored, and the probability of all that is not.
    #[inline(always)]
    pub(super) fn separate(&mut self, sights: &[Sight], residuals_m: &[f64], modes: &FaultModes) -> Result<(usize, f64), Unavailable> {
        self.satellites.fill(sights);
        self.satellites.measured(residuals_m);
        self.satellites.solve(0, &mut self.all)?;
        self.solved = [None; CLOCKS];
        let (mut monitored, mut p_unmonitored) = (0_usize, modes.left());
        for (k, mode) in modes.iter().enumerate() {
            let sums = self.subset(mode, sights.len());
            if sums.is_some() {
                monitored += 1;
            } else {
                p_unmonitored += mode.p;
            }
            self.outcome[k] = sums;
        }
        Ok((monitored, p_unmonitored))
    }

    /// Monitored modes of the last epoch, without the fault-free one.
    pub(super) fn faults(&self, modes: &FaultModes) -> usize {
        self.outcome[..modes.len()].iter().flatten().count().saturating_sub(1)
    }

    /// Where the solution of the last epoch stands from the place of its residuals, east, north, up.
    pub(super) fn step(&self) -> [Metres; 3] {
        self.satellites.step(&self.all).map(Metres::new)
    }

    /// Of the position for accuracy, east, north, up.
    #[inline(always)]
    pub(super) fn sigma_accuracy(&self) -> [Metres; 3] {
        self.satellites.accuracy_m2(&self.all).map(|v| Metres::new(sqrt(v)))
    }

    /// Work out the solution without one constellation, once an epoch; whether there is one.
    #[inline(always)]
    pub(super) fn solve_without(&mut self, c: usize) -> bool {
        *self.solved[c].get_or_insert_with(|| self.satellites.solve(1 << c, &mut self.without[c]).is_ok())
    }

    /// The solutions without one constellation that have been worked out.
    pub(super) fn without_one(&self) -> impl Iterator<Item = &Solution> {
        self.without.iter().zip(&self.solved).filter(|(_, solved)| **solved == Some(true)).map(|(base, _)| base)
    }

    /// The solution without a mode's satellites.
    #[inline(always)]
    fn subset(&mut self, mode: &FaultMode, count: usize) -> Option<Sums> {
        let left = count - (mode.satellites.count_ones() as usize).min(count);
        if left < self.satellites.need_and_have(mode.constellations).0 {
            return None;
        }
        let base = match mode.constellations.count_ones() {
            0 => &self.all,
            1 => {
                let c = mode.constellations.trailing_zeros() as usize;
                if !self.solve_without(c) {
                    return None;
                }
                &self.without[c]
            }
            _ => {
                self.satellites.solve(mode.constellations, &mut self.several).ok()?;
                &self.several
            }
        };
        let single = mode.satellites & !self.satellites.of_constellations(mode.constellations);
        let mut out = [0; MOST_TOGETHER];
        let mut bits = single;
        let together = single.count_ones() as usize;
        for slot in out.iter_mut().take(together) {
            *slot = bits.trailing_zeros() as usize;
            bits &= bits - 1;
        }
        let (satellites, all) = (&self.satellites, &self.all);
        match together {
            0 => satellites.without(all, base, []),
            1 => satellites.without(all, base, [out[0]]),
            2 => satellites.without(all, base, [out[0], out[1]]),
            3 => satellites.without(all, base, [out[0], out[1], out[2]]),
            MOST_TOGETHER => satellites.without(all, base, out),
            // More at a time than is worked out counts as not monitored: its probability is in the budget.
            _ => None,
        }
    }
}
