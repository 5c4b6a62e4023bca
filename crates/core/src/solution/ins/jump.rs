//! A receiver whose clock jumps: all its ranges are off by one length, and no gate would ever let one of them pass again.

use crate::quantity::GpsTime;
use crate::special::float::sqrt;

/// Ranges that must be gated at one instant, and how many times as many as are used (ours).
const GATED_LEAST: u32 = 4;
const GATED_SHARE: u32 = 4;
/// Deviations of its law by which the spread of what is gated may exceed its mean (ours).
const SPREAD_DEVIATIONS: f64 = 5.0;

/// The ranges of an instant.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Instant {
    time: Option<GpsTime>,
    n_used: u32,
    n_gated: u32,
    sum: f64,
    sum_square: f64,
    /// The largest variance that a gated one was expected to have.
    variance: f64,
}

impl Instant {
    /// A range of a time is about to be judged: what the instant before it says of the clock, as a length by which it has jumped.
    pub(super) fn at(&mut self, time: GpsTime) -> Option<f64> {
        if self.time == Some(time) {
            return None;
        }
        let jump = self.jump();
        *self = Self { time: Some(time), ..Self::default() };
        jump
    }

    pub(super) fn used(&mut self) {
        self.n_used += 1;
    }

    pub(super) fn gated(&mut self, innovation: f64, variance: f64) {
        self.n_gated += 1;
        self.sum += innovation;
        self.sum_square += innovation * innovation;
        self.variance = self.variance.max(variance);
    }

    /// The mean, where nearly all are gated and agree: their spread about the mean is chi-square with one degree less than they are.
    fn jump(&self) -> Option<f64> {
        if self.n_gated < GATED_LEAST || self.n_used * GATED_SHARE > self.n_gated {
            return None;
        }
        let n = f64::from(self.n_gated);
        let mean = self.sum / n;
        let spread = self.sum_square - n * mean * mean;
        let most = self.variance * (n - 1.0 + SPREAD_DEVIATIONS * sqrt(2.0 * (n - 1.0)));
        (spread <= most).then_some(mean)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn size_of(gated: &[f64], used: usize) -> Option<f64> {
        let (mut instant, begin) = (Instant::default(), GpsTime::default());
        assert_eq!(instant.at(begin), None);
        (0..used).for_each(|_| instant.used());
        gated.iter().for_each(|z| instant.gated(*z, 25.0));
        assert_eq!(instant.at(begin), None, "the instant is not over");
        let jump = instant.at(begin.plus_seconds(1.0));
        assert_eq!(instant.at(begin.plus_seconds(2.0)), None, "nothing is said twice");
        jump
    }

    #[test]
    fn ranges_that_are_off_alike_are_a_jump_and_others_are_not() {
        assert_eq!(size_of(&[100.0, 104.0, 96.0, 100.0], 0), Some(100.0));
        assert_eq!(size_of(&[100.0, 104.0, 96.0, 100.0], 1), Some(100.0));
        assert_eq!(size_of(&[100.0, 104.0, 96.0, 100.0], 2), None, "a third of them agrees with the filter");
        assert_eq!(size_of(&[100.0, 104.0, 96.0], 0), None, "three do not determine");
        // A position that is wrong shows in every range by another length.
        assert_eq!(size_of(&[100.0, 40.0, -96.0, -30.0], 0), None);
        assert_eq!(size_of(&[f64::NAN, 1.0, 1.0, 1.0], 0), None);
    }
}
