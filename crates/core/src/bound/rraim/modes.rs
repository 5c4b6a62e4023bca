//! The faults that may begin while coasting: those of [`crate::bound::faults`], the front end of equation 17, for at most two events.

use super::coast::Coast;
use crate::bound::faults::{FaultModes, First, MOST_SATELLITES, NoModes, Prior, Watch};
use crate::quantity::OutOfDomain;
use crate::signal::Constellation;

const CLOCKS: usize = Constellation::ALL.len();
/// Modes inside a constellation that are this much rarer than its own are counted with it.
const CONSOLIDATED: f64 = 0.01;
/// Events at a time that are monitored; more count as not monitored.
const MOST_AT_ONCE: usize = 2;

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

    /// Sum of the priors of the satellites followed.
    pub fn of_satellites(&self, coast: &Coast) -> f64 {
        coast.constellations().map(|c| self.satellite[c]).sum()
    }

    /// What may be faulty together, and which of that must be monitored for the rest to be rarer than the threshold.
    ///
    /// # Errors
    /// [`NoModes`].
    pub fn modes(&self, coast: &Coast) -> Result<FaultModes, NoModes> {
        let mut priors: [Prior; MOST_SATELLITES] = [(Constellation::Gps, 0.0); MOST_SATELLITES];
        for (slot, c) in priors.iter_mut().zip(coast.constellations()) {
            *slot = (Constellation::ALL[c], self.satellite[c]);
        }
        // A constellation alone cannot be checked against another.
        let several = (0..CLOCKS).filter(|c| coast.members(*c) != 0).count() > 1;
        let constellation = if several { self.constellation } else { [0.0; CLOCKS] };
        // A mode likelier than what may be left cannot be left out.
        let (always, unmonitored) = (self.threshold, self.threshold);
        let watch = Watch { always, unmonitored, consolidation: CONSOLIDATED, most_at_once: MOST_AT_ONCE, first: First::Likeliest };
        FaultModes::of(&priors[..coast.len()], &constellation, &watch)
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

    fn sets(modes: &FaultModes) -> Vec<(u64, f64)> {
        modes.iter().map(|m| (m.satellites, m.p)).collect()
    }

    /// Exactly k of n with the same prior.
    fn exactly(k: i32, n: i32, p: f64) -> f64 {
        let ways: f64 = (0..k).map(|i| f64::from(n - i) / f64::from(k - i)).product();
        ways * p.powi(k) * (1.0 - p).powi(n - k)
    }

    #[test]
    fn rare_pairs_are_left_out_and_counted() {
        let modes = priors(1e-6, 1e-4, 1e-10).modes(&coast(8, 0)).unwrap();
        assert_eq!(modes.len(), 1 + 8);
        let expected = exactly(2, 8, 1e-6) + exactly(3, 8, 1e-6);
        // Four of eight are 7e-23, and some ten additions of numbers near one leave a few units of the last place of what is summed.
        assert!((modes.left() / expected - 1.0).abs() < 1e-10, "{}", modes.left());
        assert!((sets(&modes)[1].1 / (exactly(1, 8, 1e-6) / 8.0) - 1.0).abs() < 1e-14);
    }

    #[test]
    fn likely_pairs_are_monitored_until_the_rest_is_rare() {
        let all = priors(1e-4, 0.0, 1e-9).modes(&coast(8, 0)).unwrap();
        assert_eq!(all.len(), 1 + 8 + 28);
        let some = priors(1e-4, 0.0, 1e-7).modes(&coast(8, 0)).unwrap();
        assert!(some.len() > 1 + 8 && some.len() < 1 + 36);
        assert!(some.left() <= 1e-7 * (1.0 + 1e-12));
        // Never three at a time, whatever the threshold.
        let none = priors(1e-4, 0.0, 0.0).modes(&coast(8, 0)).unwrap();
        assert_eq!(none.len(), 1 + 8 + 28);
        assert!((none.left() / (exactly(3, 8, 1e-4) + exactly(4, 8, 1e-4)) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_constellation_counts_beside_another_only() {
        let one = priors(1e-7, 1e-4, 1e-9).modes(&coast(8, 0)).unwrap();
        let two = priors(1e-7, 1e-4, 1e-9).modes(&coast(5, 6)).unwrap();
        assert!(one.iter().all(|m| m.satellites.count_ones() < 8));
        let wide: Vec<_> = sets(&two).into_iter().filter(|m| m.0.count_ones() > 1).map(|m| m.0).collect();
        assert!(wide.contains(&0b11111) && wide.contains(&0b111_1110_0000));
    }

    /// Whatever is monitored, consolidated or not, nothing is lost.
    #[test]
    fn probabilities_add_up_whatever_is_monitored() {
        for threshold in [0.0, 1e-12, 1e-9, 1e-6, 1e-2] {
            for (p_sat, p_const) in [(1e-5, 1e-4), (1e-4, 1e-8), (3e-6, 1e-6)] {
                let modes = priors(p_sat, p_const, threshold).modes(&coast(7, 9)).unwrap();
                let sum = modes.iter().map(|m| m.p).sum::<f64>() + modes.left();
                // Some hundred additions near one.
                assert!((sum - 1.0).abs() <= 1e-13, "{threshold} {p_sat}: {sum}");
            }
        }
    }

    #[test]
    fn a_prior_of_zero_is_no_event() {
        let modes = Priors { satellite: [0.0, 1e-6, 1e-6, 1e-6, 1e-6], ..priors(1e-6, 0.0, 1e-10) }.modes(&coast(4, 6)).unwrap();
        assert!(modes.iter().all(|m| m.satellites & 0b1111 == 0));
        assert_eq!(modes.len(), 1 + 6);
    }

    #[test]
    fn what_is_no_prior_is_refused() {
        for (p_sat, p_const, argument) in [(1.0, 0.0, "p_sat"), (f64::NAN, 0.0, "p_sat"), (0.1, -1.0, "p_const")] {
            let bad = Priors { satellite: [p_sat; CLOCKS], constellation: [p_const; CLOCKS], threshold: 0.0 };
            assert_eq!(bad.check().unwrap_err().argument, argument);
        }
    }

    #[test]
    fn the_priors_of_the_satellites_followed_are_added() {
        let mut priors = priors(0.0, 1e-4, 1e-10);
        (priors.satellite[Constellation::Gps.index()], priors.satellite[Constellation::Galileo.index()]) = (1e-5, 3e-5);
        let sum = priors.of_satellites(&coast(5, 3));
        assert!((sum - 14e-5).abs() < 1e-18, "{sum}");
    }
}
