//! The biases of the unit that the filter has estimated, against those that the unit has as it is declared.
//!
//! Positions that are led off look to a filter like an acceleration that its unit does not measure, and the only place for that is a bias. The
//! estimate is that of all positions together, so it shows a lead-off that no instant shows: for one of constant speed its square reaches nine
//! tenths of what the likelihood ratio of all innovations does.
//!
//! ```text
//! b^2 / (1.6 (s^2 - P) + 0.05 s^2)        chi-square of one degree or less; s^2 - P: variance of an estimate (`solution::ins::BiasEstimate`)
//! ```
//!
//! Provenance: ours.

use super::{DIFFERENCE_FLOOR, DIFFERENCE_INFLATION, Guard};
use crate::quantity::GpsTime;
use crate::solution::ins::{BiasEstimate, Fusion, Mode};

/// Risk of a false contradiction of one bias: 1e-5 an hour over six biases and sixty values, for an estimate that rests on a minute and more.
pub(super) const RISK: f64 = 1e-5 / 6.0 / 60.0;

impl Guard {
    /// The filter as it is before the positions of an instant. After a hole, while weight and course give the attitude, a tilt may stand for a
    /// bias.
    pub(super) fn hear_biases(&mut self, filter: &mut Fusion, now: GpsTime) {
        if !matches!(filter.mode_now(), Mode::Aligning) && filter.bias_estimates().iter().any(|b| !(square(b) <= self.bias_limit)) {
            self.contradiction.leave_biases(now);
        }
    }
}

/// Of an estimate over its variance. A share that rounding makes negative is none.
fn square(b: &BiasEstimate) -> f64 {
    b.of_declared * b.of_declared / (DIFFERENCE_INFLATION * b.explained.max(0.0) + DIFFERENCE_FLOOR)
}

#[cfg(test)]
mod tests {
    use super::super::tests::{SETTINGS, World, fix};
    use super::*;

    fn estimate(of_declared: f64, explained: f64) -> BiasEstimate {
        BiasEstimate { of_declared, explained }
    }

    #[test]
    fn a_bias_counts_by_what_its_estimate_may_be() {
        // The same estimate where nothing, half and all of the declared variance is explained: 9 / 0.05, 9 / 0.85, 9 / 1.65.
        for (explained, expected) in [(-1e-12, 180.0), (0.0, 180.0), (0.5, 9.0 / 0.85), (1.0, 9.0 / 1.65)] {
            assert!((square(&estimate(-3.0, explained)) - expected).abs() < 1e-9, "{explained}");
        }
        assert!(!(square(&estimate(f64::NAN, 1.0)) <= 1e9));
    }

    /// 5.55 deviations: two tails of 2.8e-8 by the normal law's own tables (1 - erf).
    #[test]
    fn the_limit_is_that_of_the_normal_law_at_the_risk() {
        let guard = Guard::new(SETTINGS).unwrap();
        assert!((guard.bias_limit.sqrt() - crate::special::two_sided_factor(1e-5 / 360.0)).abs() < 1e-6);
        assert!((5.5..5.6).contains(&guard.bias_limit.sqrt()), "{}", guard.bias_limit.sqrt());
    }

    /// A filter whose unit has biases of a tenth of m/s² is led off east by 0.9 m/s², by little and by nothing.
    #[test]
    fn positions_that_accelerate_as_the_unit_does_not_are_heard() {
        for (acceleration_mps2, biased) in [(0.0, false), (0.02, false), (0.9, true)] {
            let mut world = World::new(9);
            let (mut filter, mut guard) = (world.filter_with(0.1), Guard::new(SETTINGS).unwrap());
            for second in 1..=20 {
                filter.advance(&world.sample());
                let off_m = 0.5 * acceleration_mps2 * f64::from(second * second);
                let timed = fix(&world, off_m, 9.0);
                // The filter uses whatever comes: what is tried is the bias alone.
                guard.hear_biases(&mut filter, world.time());
                filter.aid(core::slice::from_ref(&timed));
            }
            assert_eq!(guard.contradiction.is_biased(), biased, "{acceleration_mps2}: {:?}", filter.bias_estimates());
        }
    }
}
