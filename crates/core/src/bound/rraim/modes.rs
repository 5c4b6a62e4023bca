//! Which satellites may be faulty together, and how likely: the front end of equation 17.
//!
//! After the baseline advanced RAIM user algorithm (Blanch et al. 2015; standard), for at most two events: the probability of three or
//! more counts as not monitored.

use super::coast::{Coast, Set};
use crate::quantity::OutOfDomain;
use crate::signal::Constellation;

const CLOCKS: usize = Constellation::ALL.len();
/// Most modes: pairs of 30 satellites and more; what does not fit counts as not monitored.
pub const MOST_MODES: usize = 500;
/// Modes inside a constellation that are this much rarer than its own are counted with it.
const CONSOLIDATED: f64 = 0.01;

/// Priors of faults during the coasting time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Priors {
    /// Of a satellite, by constellation index.
    pub satellite: [f64; CLOCKS],
    /// Of a whole constellation; counts only where another is beside it.
    pub constellation: [f64; CLOCKS],
    /// Faults rarer than this together need no monitoring.
    pub threshold: f64,
}

impl Priors {
    /// Checked.
    ///
    /// # Errors
    /// [`OutOfDomain`] for a prior outside \[0, 1).
    pub fn check(self) -> Result<Self, OutOfDomain> {
        let named = [("p_sat", &self.satellite[..]), ("p_const", &self.constellation[..]), ("p_threshold", &[self.threshold])];
        for (argument, values) in named {
            if let Some(&value) = values.iter().find(|p| !(**p >= 0.0 && **p < 1.0)) {
                return Err(OutOfDomain { argument, value, unit: "1", domain: "[0, 1)" });
            }
        }
        Ok(self)
    }
}

/// Sets of satellites that may be faulty together, with their probabilities.
#[derive(Debug, Clone)]
pub struct Modes {
    list: [(Set, f64); MOST_MODES],
    count: usize,
    /// Probability of everything that is not in the list.
    pub not_monitored: f64,
    /// Sum of the satellites' probabilities.
    pub satellites: f64,
}

impl Default for Modes {
    fn default() -> Self {
        Self { list: [(0, 0.0); MOST_MODES], count: 0, not_monitored: 0.0, satellites: 0.0 }
    }
}

impl Modes {
    /// Each set and its probability.
    pub fn list(&self) -> &[(Set, f64)] {
        &self.list[..self.count]
    }

    /// Work out the modes of the satellites followed; `self` is overwritten, since it is large.
    ///
    /// Single satellites and whole constellations always; pairs as far as their sum exceeds the threshold, the likeliest kind first.
    pub fn fill(&mut self, coast: &Coast, priors: &Priors) {
        (self.count, self.not_monitored, self.satellites) = (0, 0.0, 0.0);
        let mut clock_of = [0; u64::BITS as usize];
        let mut wide = [(0, 0.0); CLOCKS];
        for (slot, clock) in clock_of.iter_mut().zip(coast.constellations()) {
            *slot = clock;
            self.satellites += priors.satellite[clock];
            wide[clock].0 = coast.members(clock);
        }
        // A constellation alone cannot be checked against another.
        if wide.iter().filter(|w| w.0 != 0).count() > 1 {
            for (w, p) in wide.iter_mut().zip(priors.constellation).filter(|(w, _)| w.0 != 0) {
                w.1 = p;
            }
        }
        let n = coast.len();
        let single = |i: usize| priors.satellite[clock_of[i]];
        for i in 0..n {
            self.keep(1 << i, single(i));
        }
        // Three events or more, and two constellations: nothing is left to check against.
        let constellations = wide.iter().map(|w| w.1).sum::<f64>();
        let both = constellations * constellations - wide.iter().map(|w| w.1 * w.1).sum::<f64>();
        let events = self.satellites + constellations;
        self.not_monitored += events * events * events / 6.0 + both / 2.0;
        let mut left = self.pairs(n, &clock_of, &mut wide, &single);
        for w in wide.iter().filter(|w| w.1 > 0.0) {
            self.keep(w.0, w.1);
        }
        if left + self.not_monitored <= priors.threshold {
            self.not_monitored += left;
            return;
        }
        self.keep_pairs(n, &clock_of, &wide, priors, &mut left);
        self.not_monitored += left.max(0.0);
    }

    /// Sum of the probabilities of pairs that are modes of their own; those inside a constellation that are rare are counted with it.
    fn pairs(&self, n: usize, clock_of: &[usize], wide: &mut [(Set, f64); CLOCKS], single: &impl Fn(usize) -> f64) -> f64 {
        let mut sum = 0.0;
        let before = *wide;
        for i in 0..n {
            for j in i + 1..n {
                let (p, clock) = (single(i) * single(j), clock_of[i]);
                if clock == clock_of[j] && p < CONSOLIDATED * before[clock].1 {
                    wide[clock].1 += p;
                } else {
                    sum += p;
                }
            }
            for (clock, w) in before.iter().enumerate().filter(|(_, w)| w.1 > 0.0) {
                let p = w.1 * single(i);
                if clock == clock_of[i] {
                    wide[clock].1 += p;
                } else {
                    sum += p;
                }
            }
        }
        sum
    }

    fn keep_pairs(&mut self, n: usize, clock_of: &[usize], wide: &[(Set, f64); CLOCKS], priors: &Priors, left: &mut f64) {
        let single = |i: usize| priors.satellite[clock_of[i]];
        let enough = |modes: &Self, left: f64| left + modes.not_monitored <= priors.threshold;
        for i in 0..n {
            for (clock, w) in wide.iter().enumerate().filter(|(_, w)| w.1 > 0.0) {
                let p = priors.constellation[clock] * single(i);
                if clock != clock_of[i] && !enough(self, *left) {
                    self.keep(w.0 | 1 << i, p);
                    *left -= p;
                }
            }
        }
        for i in 0..n {
            for j in i + 1..n {
                let (p, clock) = (single(i) * single(j), clock_of[i]);
                let consolidated = clock == clock_of[j] && wide[clock].1 > 0.0 && p < CONSOLIDATED * priors.constellation[clock];
                if !consolidated && !enough(self, *left) {
                    self.keep(1 << i | 1 << j, p);
                    *left -= p;
                }
            }
        }
    }

    fn keep(&mut self, set: Set, p: f64) {
        match self.list.get_mut(self.count) {
            Some(slot) => {
                *slot = (set, p);
                self.count += 1;
            }
            None => self.not_monitored += p,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bound::rraim::coast::Followed;
    use crate::geometry::Direction;
    use crate::quantity::{Metres, Radians};

    fn coast(gps: usize, galileo: usize) -> Coast {
        let one = |i: usize, constellation| {
            let unit = Direction::new(Radians::degrees(47.0 * i as f64), Radians::degrees(15.0 + (i * 29 % 60) as f64)).unwrap().unit();
            Followed { before: unit, now: unit, constellation, sigma: Metres::new(0.1) }
        };
        let all: Vec<_> =
            (0..gps).map(|i| one(i, Constellation::Gps)).chain((gps..gps + galileo).map(|i| one(i, Constellation::Galileo))).collect();
        Coast::new(&all).unwrap()
    }

    fn priors(p_sat: f64, p_const: f64, threshold: f64) -> Priors {
        Priors { satellite: [p_sat; CLOCKS], constellation: [p_const; CLOCKS], threshold }.check().unwrap()
    }

    fn filled(coast: &Coast, priors: &Priors) -> Modes {
        let mut modes = Modes::default();
        modes.fill(coast, priors);
        modes
    }

    #[test]
    fn rare_pairs_are_left_out_and_counted() {
        let modes = filled(&coast(8, 0), &priors(1e-6, 1e-4, 1e-10));
        assert_eq!(modes.list().len(), 8);
        // 28 pairs, and (8e-6)^3 / 6 for all triples.
        let expected = 28e-12 + 512e-18 / 6.0;
        assert!((modes.not_monitored / expected - 1.0).abs() < 1e-12, "{}", modes.not_monitored);
    }

    #[test]
    fn likely_pairs_are_monitored_until_the_rest_is_rare() {
        let all = filled(&coast(8, 0), &priors(1e-4, 0.0, 1e-9));
        assert_eq!(all.list().len(), 8 + 28);
        let some = filled(&coast(8, 0), &priors(1e-4, 0.0, 1e-7));
        assert!(some.list().len() > 8 && some.list().len() < 36);
        assert!(some.not_monitored <= 1e-7 * (1.0 + 1e-12));
    }

    #[test]
    fn a_constellation_counts_beside_another_only() {
        let (one, two) = (filled(&coast(8, 0), &priors(1e-7, 1e-4, 1e-9)), filled(&coast(5, 6), &priors(1e-7, 1e-4, 1e-9)));
        assert!(one.list().iter().all(|(set, _)| set.count_ones() < 8));
        let wide: Vec<_> = two.list().iter().filter(|(set, _)| set.count_ones() > 1).collect();
        assert!(wide.iter().any(|m| m.0 == 0b11111) && wide.iter().any(|m| m.0 == 0b111_1110_0000));
    }

    /// Every pair is a mode, consolidated or not monitored, so nothing is lost.
    #[test]
    fn probabilities_add_up_whatever_is_monitored() {
        for threshold in [0.0, 1e-12, 1e-9, 1e-6, 1e-2] {
            for (p_sat, p_const) in [(1e-5, 1e-4), (1e-4, 1e-8), (3e-6, 1e-6)] {
                let modes = filled(&coast(7, 9), &priors(p_sat, p_const, threshold));
                let sum = modes.list().iter().map(|m| m.1).sum::<f64>() + modes.not_monitored;
                let events = 16.0 * p_sat + 2.0 * p_const;
                let pairs = (events * events - 16.0 * p_sat * p_sat - 2.0 * p_const * p_const) / 2.0;
                let expected = events + pairs;
                let triples = events * events * events / 6.0;
                // Some hundred additions.
                assert!((sum - expected - triples).abs() <= 1e-13 * expected, "{threshold} {p_sat}: {sum} {expected}");
            }
        }
    }

    #[test]
    fn what_is_no_prior_is_refused() {
        for (p_sat, p_const, argument) in [(1.0, 0.0, "p_sat"), (f64::NAN, 0.0, "p_sat"), (0.1, -1.0, "p_const")] {
            let bad = Priors { satellite: [p_sat; CLOCKS], constellation: [p_const; CLOCKS], threshold: 0.0 };
            assert_eq!(bad.check().unwrap_err().argument, argument);
        }
    }
}
