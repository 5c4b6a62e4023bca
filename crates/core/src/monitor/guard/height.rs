//! The altimeter as a witness of the snapshot's height: against what both differ by now, and against what they differed by before.
//!
//! ```text
//! d = altimeter - snapshot                 Var d = white^2 + bias^2 + S_uu
//! d(t) - d(s)                              Var <= |b_t^2 - b_s^2| + 2 b_t b_s (1 - exp(-(t - s) / tau)) + white_t^2 + white_s^2 + S_t + S_s
//! ```
//!
//! b is the standard deviation of the altimeter's slow error. The bound holds for a slow error that grows with its deviation (temperature times
//! height) and for one whose growth is independent of what it was; the slow error of the snapshot is as if it were new at each instant. A height
//! that is led off slowly leaves the change long before it leaves the bias. Provenance: re-derived; times and number of references inferred.

use super::stations::testimony;
use crate::monitor::judgement::Testimony;
use crate::quantity::GpsTime;
use crate::signal::BaroHeight;
use crate::solution::snapshot::Snapshot;
use crate::special::float::exp;
use crate::special::gamma::chi_square_tail;

/// Differences that are remembered, and the least time between two of them \[s\]: an hour and a half.
const REFERENCES: usize = 54;
const APART_S: f64 = 100.0;

/// A difference at an instant.
#[derive(Debug, Clone, Copy)]
struct Reference {
    time: GpsTime,
    apart_m: f64,
    bias_m: f64,
    /// White part and snapshot.
    variance_m2: f64,
}

/// What the altimeter has reported of the snapshot's height.
#[derive(Debug, Clone, Copy)]
pub(super) struct Height {
    references: [Option<Reference>; REFERENCES],
    next: usize,
}

impl Default for Height {
    fn default() -> Self {
        Self { references: [None; REFERENCES], next: 0 }
    }
}

impl Height {
    /// A height of the altimeter at the instant of a snapshot.
    pub(super) fn hear(&mut self, m: &BaroHeight, snapshot: &Snapshot) -> Testimony {
        let white_m = m.sigma_white.m();
        let now = Reference {
            time: snapshot.time,
            apart_m: m.height.m() - snapshot.position.height.m(),
            bias_m: m.sigma_bias.m(),
            variance_m2: white_m * white_m + snapshot.covariance.matrix()[(2, 2)],
        };
        let whole = chi_square_tail(1.0, now.apart_m * now.apart_m / (now.bias_m * now.bias_m + now.variance_m2));
        let known = || self.references.iter().flatten();
        let n = known().count();
        // Of several chances the smallest counts, times their number.
        let changed = known().map(|before| chance(before, &now, m.correlation_time_s) * n as f64).fold(f64::INFINITY, worse);
        let reported = testimony(worse(whole, changed));
        // A difference that is in doubt is no reference for later ones.
        let last = self.references[(self.next + REFERENCES - 1) % REFERENCES];
        if reported == Testimony::Agrees && last.is_none_or(|l| now.time.seconds_since(l.time) >= APART_S) {
            self.references[self.next] = Some(now);
            self.next = (self.next + 1) % REFERENCES;
        }
        reported
    }
}

/// The smaller chance; one that is no number is the worst.
fn worse(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.min(b) }
}

/// The chance of a change as large as this where nothing but the altimeter's slow error changes.
fn chance(before: &Reference, now: &Reference, correlation_time_s: f64) -> f64 {
    let left = exp(-now.time.seconds_since(before.time).max(0.0) / correlation_time_s);
    let grown = now.bias_m * now.bias_m - before.bias_m * before.bias_m;
    let slow = grown.abs() + 2.0 * now.bias_m * before.bias_m * (1.0 - left);
    let change = now.apart_m - before.apart_m;
    chi_square_tail(1.0, change * change / (slow + now.variance_m2 + before.variance_m2))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::{Covariance, Geodetic, LatLon};
    use crate::quantity::{Metres, Radians};
    use crate::special::normal::tail;
    use nalgebra::Matrix3;

    fn at(second: f64, height_m: f64) -> Snapshot {
        let point = LatLon::new(Radians::new(0.7), Radians::new(2.0)).unwrap();
        let covariance = Covariance::claim_symmetric(Matrix3::identity() * 9.0);
        Snapshot::solved(GpsTime::default().plus_seconds(second), Geodetic { point, height: Metres::new(height_m) }, covariance)
    }
    fn baro(height_m: f64, bias_m: f64) -> BaroHeight {
        let [height, sigma_white, sigma_bias] = [height_m, 5.0, bias_m].map(Metres::new);
        BaroHeight { height, sigma_white, sigma_bias, correlation_time_s: 1e5 }
    }

    /// In level flight with an altimeter that is 180 m off the height is led off by 0.1 m/s. In 1600 s the slow error changes by 32 m (one
    /// deviation); alone it would take 5.3 times 180 m.
    #[test]
    fn a_height_that_is_led_off_leaves_the_change_long_before_it_leaves_the_bias() {
        let mut height = Height::default();
        (0..1000).for_each(|s| assert_eq!(height.hear(&baro(9180.0, 180.0), &at(f64::from(s), 9000.0)), Testimony::Agrees));
        let contradicts = |s: &f64| height.hear(&baro(9180.0, 180.0), &at(1000.0 + s, 9000.0 + 0.1 * s)) == Testimony::Contradicts;
        let seen_s = (0..9000).map(f64::from).find(contradicts).unwrap();
        assert!((1200.0..2600.0).contains(&seen_s), "{seen_s}");
        // What was in doubt is no reference: back where it was it agrees, and only there.
        let near = height.hear(&baro(9180.0, 180.0), &at(1000.0 + seen_s + 1.0, 9001.0));
        assert_eq!(near, Testimony::Agrees);
    }

    /// One reference: both tails of the normal law of the change, in level flight and where the deviation has grown from 30 m to 180 m.
    #[test]
    fn the_chance_is_that_of_the_change_in_its_deviations() {
        for (bias_m, slow) in
            [(180.0, 2.0 * 180.0 * 180.0 * (1.0 - f64::exp(-0.01))), (30.0, 180.0 * 180.0 - 900.0 + 2.0 * 5400.0 * (1.0 - f64::exp(-0.01)))]
        {
            let of = |second: f64, apart_m: f64, bias_m: f64| Reference {
                time: GpsTime::default().plus_seconds(second),
                apart_m,
                bias_m,
                variance_m2: 34.0,
            };
            let got = chance(&of(0.0, 10.0, bias_m), &of(1000.0, 75.0, 180.0), 1e5);
            let expected = 2.0 * tail(65.0 / f64::sqrt(slow + 68.0));
            assert!((got / expected - 1.0).abs() < 1e-9, "{got} {expected}");
        }
    }

    /// The variance of the first difference is 5^2 of the altimeter and 9 of the snapshot: 20 m beside sqrt(34) m are 3.43 deviations, whose
    /// chance of 6e-4 is a doubt; beside any smaller variance, such as the difference of the two, 5 deviations are none.
    #[test]
    fn the_variances_of_altimeter_and_snapshot_add_up() {
        assert_eq!(Height::default().hear(&baro(120.0, 0.0), &at(0.0, 100.0)), Testimony::Doubts);
        assert_eq!(Height::default().hear(&baro(119.0, 0.0), &at(0.0, 100.0)), Testimony::Agrees);
        assert_eq!(Height::default().hear(&baro(132.0, 0.0), &at(0.0, 100.0)), Testimony::Contradicts);
    }

    #[test]
    fn numbers_that_are_none_agree_with_nothing() {
        let mut height = Height::default();
        assert_eq!(height.hear(&baro(100.0, 30.0), &at(0.0, 100.0)), Testimony::Agrees);
        assert_eq!(height.hear(&baro(f64::NAN, 30.0), &at(1.0, 100.0)), Testimony::Contradicts);
        assert_eq!(height.hear(&BaroHeight { correlation_time_s: f64::NAN, ..baro(100.0, 30.0) }, &at(1.0, 100.0)), Testimony::Contradicts);
    }

    #[test]
    fn a_difference_is_remembered_every_hundred_seconds_and_the_oldest_is_forgotten() {
        let mut height = Height::default();
        (0..20_000).for_each(|s| assert!(height.hear(&baro(130.0, 30.0), &at(f64::from(s), 100.0)).lets_stand()));
        let oldest = height.references.iter().flatten().map(|r| r.time).min().unwrap();
        assert_eq!(height.references.iter().flatten().count(), REFERENCES);
        assert_eq!(oldest.seconds_since(GpsTime::default()), 19_900.0 - 53.0 * APART_S);
    }

    /// Every difference that agreed, kept and tested one by one: the word is that of the smallest chance, times their number.
    #[test]
    fn a_height_is_tested_against_every_difference_that_is_remembered() {
        let mut state = 11_u64;
        let mut draw = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let (mut height, mut kept) = (Height::default(), Vec::<(f64, f64, f64)>::new());
        let (mut second, mut reported) = (0.0, [0; 3]);
        for _ in 0..600 {
            second += [10.0, 50.0, 100.0][(3.0 * draw()) as usize];
            let bias_m = 60.0 + 40.0 * draw();
            let apart_m = 24.0 * (draw() - 0.5) + if draw() < 0.3 { 700.0 * (draw() - 0.5) } else { 0.0 };
            // 5 m of noise and 3 m of the snapshot.
            let both = |variance: f64, apart: f64| 2.0 * tail(apart.abs() / variance.sqrt());
            let mut least = both(bias_m * bias_m + 34.0, apart_m);
            for (s, apart, bias) in &kept {
                let left = (-(second - s) / 1e5).exp();
                let variance = (bias_m * bias_m - bias * bias).abs() + 2.0 * bias_m * bias * (1.0 - left) + 68.0;
                least = least.min(kept.len() as f64 * both(variance, apart_m - apart));
            }
            let expected = if least >= 1e-3 {
                Testimony::Agrees
            } else if least >= 1e-7 {
                Testimony::Doubts
            } else {
                Testimony::Contradicts
            };
            assert_eq!(height.hear(&baro(1000.0 + apart_m, bias_m), &at(second, 1000.0)), expected, "{second}: {least}");
            reported[match expected {
                Testimony::Agrees => 0,
                Testimony::Doubts => 1,
                _ => 2,
            }] += 1;
            if expected == Testimony::Agrees && kept.last().is_none_or(|(s, ..)| second - s >= 100.0) {
                kept.push((second, apart_m, bias_m));
                if kept.len() > 54 {
                    kept.remove(0);
                }
            }
        }
        assert!(reported.iter().all(|n| *n > 10) && kept.len() == 54, "{reported:?} {}", kept.len());
    }
}
