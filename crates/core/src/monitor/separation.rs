//! Do two solutions agree? The filter with satellites against the one without, horizontally.
//!
//! A gate looks at one measurement at a time and against a filter that has followed the false ones; a slow deception passes it. Two
//! filters that share no satellite do not follow together. Provenance: solution separation is standard (Brown and McBurney 1988, from
//! memory), with the covariance of the difference in place of a bound; thresholds ours.

use super::consistency::normalised_square_horizontal;
use crate::frame::{Covariance, Displacement, Enu};
use crate::quantity::{GpsTime, Metres, OutOfDomain, Risk};
use crate::solution::wls::horizontal_axes;
use crate::special::chi::chi_factor;
use crate::special::float::hypot;
use crate::special::normal::one_sided_factor;

/// A direction in which the difference varies by less than this share of the worse solution's variance says nothing: both know nearly the
/// same, and what is left is how they were computed. Provenance: ours.
const LEAST_SHARE: f64 = 0.01;

/// Agreement without a break that withdraws the verdict \[s\]. Provenance: ours.
pub const CLEAR_S: f64 = 30.0;

/// How far two solutions are apart, and how far they may be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Separation {
    /// Horizontal distance.
    pub distance: Metres,
    /// The distance in this direction that solutions which are right exceed with the risk of a false alert.
    pub limit: Metres,
    /// d' V^-1 d: chi-square of two degrees of freedom where both are right.
    pub square: f64,
}

impl Separation {
    /// Of a difference with its covariance, against the risk of a false alert at one instant.
    ///
    /// ```text
    /// limit = |d| sqrt(T / (d' V^-1 d)),   T = -2 ln(risk)
    /// ```
    ///
    /// `None` where there is nothing to judge by: the covariance is not positive, or one solution knows hardly more than the other
    /// (`worse` is the covariance of the one that knows less).
    ///
    /// # Errors
    /// [`OutOfDomain`] as [`chi_factor`].
    pub fn of(
        difference: &Displacement<Enu>,
        covariance: &Covariance<Enu>,
        worse: &Covariance<Enu>,
        risk: Risk,
    ) -> Result<Option<Self>, OutOfDomain> {
        let threshold = chi_factor(2, risk.q())?;
        let (least, most) = (horizontal_axes(covariance).1.m(), horizontal_axes(worse).0.m());
        let telling = least * least >= LEAST_SHARE * most * most;
        let square = normalised_square_horizontal(difference, covariance).filter(|s| telling && *s > 0.0);
        Ok(square.map(|square| {
            let d = difference.vector();
            let distance = hypot(d.x, d.y);
            let limit = distance * threshold / crate::special::float::sqrt(square);
            Self { distance: Metres::new(distance), limit: Metres::new(limit), square }
        }))
    }

    /// Whether it is more than solutions that are right would show.
    pub fn exceeds(&self) -> bool {
        !(self.distance.m() <= self.limit.m())
    }
}

/// The least error along the worst horizontal direction that the test finds but for the risk `missed`, at an instant.
///
/// ```text
/// (sqrt(T) + K(missed)) sigma_major
/// ```
///
/// An upper bound: d' V^-1 d is at least the square of its part along the major axis over the variance there, and other directions vary less.
///
/// # Errors
/// [`OutOfDomain`] as [`chi_factor`].
pub fn detectable(covariance: &Covariance<Enu>, risk: Risk, missed: Risk) -> Result<Metres, OutOfDomain> {
    let factor = chi_factor(2, risk.q())? + one_sided_factor(missed.q());
    Ok(Metres::new(factor * horizontal_axes(covariance).0.m()))
}

/// The verdict over time: raised by one instant, withdrawn after agreement for [`CLEAR_S`] without a break.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Verdict {
    risk: Risk,
    raised: bool,
    agreed_since: Option<GpsTime>,
}

impl Verdict {
    /// Nothing seen yet.
    pub const fn new(risk: Risk) -> Self {
        Self { risk, raised: false, agreed_since: None }
    }

    /// Judge an instant; `None` where there is no difference to judge, which neither raises nor withdraws.
    ///
    /// # Errors
    /// As [`Separation::of`].
    pub fn judge(
        &mut self,
        time: GpsTime,
        difference: &Displacement<Enu>,
        covariance: &Covariance<Enu>,
        worse: &Covariance<Enu>,
    ) -> Result<Option<Separation>, OutOfDomain> {
        let apart = Separation::of(difference, covariance, worse, self.risk)?;
        match &apart {
            Some(separation) if separation.exceeds() => (self.raised, self.agreed_since) = (true, None),
            Some(_) => {
                let since = *self.agreed_since.get_or_insert(time);
                self.raised &= time.seconds_since(since) < CLEAR_S;
            }
            None => self.agreed_since = None,
        }
        Ok(apart)
    }

    /// Whether the solutions disagree.
    pub const fn disagree(&self) -> bool {
        self.raised
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn enu(e: f64, n: f64) -> Displacement<Enu> {
        Displacement::new(Metres::new(e), Metres::new(n), Metres::new(0.0))
    }
    fn covariance(ee: f64, en: f64, nn: f64) -> Covariance<Enu> {
        Covariance::from_upper([ee, en, nn, 0.0, 0.0, 1.0])
    }
    fn risk(q: f64) -> Risk {
        Risk::new(q).unwrap()
    }

    /// Along an axis the limit is the factor times the deviation: sqrt(2 ln 1e7) = 5.677692, of 2 m.
    #[test]
    fn the_limit_is_the_factor_times_the_deviation_along_the_difference() {
        let v = covariance(4.0, 0.0, 1.0);
        let separation = Separation::of(&enu(3.0, 0.0), &v, &v, Risk::SEPARATION).unwrap().unwrap();
        assert!((separation.square - 2.25).abs() < 1e-14 && (separation.distance.m() - 3.0).abs() < 1e-15);
        assert!((separation.limit.m() - 11.355_385).abs() < 1e-6, "{}", separation.limit.m());
        assert!(!separation.exceeds());
        let north = Separation::of(&enu(0.0, -5.7), &v, &v, Risk::SEPARATION).unwrap().unwrap();
        assert!(north.exceeds() && (north.limit.m() - 5.677_692).abs() < 1e-6);
        // Missed with 1e-3: 3.090232 deviations more, along the major axis.
        let least = detectable(&v, Risk::SEPARATION, risk(1e-3)).unwrap();
        assert!((least.m() - 2.0 * (5.677_692 + 3.090_232)).abs() < 1e-5, "{}", least.m());
    }

    /// Two independent normal numbers have a squared length of -2 ln u with u uniform: the limit must be passed just where u is below the
    /// risk, whatever their direction.
    #[test]
    fn the_risk_is_that_of_a_false_alert() {
        let v = covariance(9.0, 2.0, 4.0);
        for turn in (0..100).map(f64::from) {
            for (u, beyond) in [(1e-3 * (1.0 - 1e-9), true), (1e-3 * (1.0 + 1e-9), false), (0.5, false), (1e-9, true)] {
                let length = (-2.0 * f64::ln(u)).sqrt();
                let (a, b) = (length * turn.cos(), length * turn.sin());
                // Cholesky's factor of the covariance: 3; 2/3, sqrt(4 - 4/9).
                let d = enu(3.0 * a, 2.0 / 3.0 * a + (4.0f64 - 4.0 / 9.0).sqrt() * b);
                let separation = Separation::of(&d, &v, &v, risk(1e-3)).unwrap().unwrap();
                assert_eq!(separation.exceeds(), beyond, "{u} {turn} {separation:?}");
            }
        }
    }

    #[test]
    fn filters_that_know_the_same_are_not_compared() {
        let (little, worse) = (covariance(0.9, 0.0, 40.0), covariance(100.0, 0.0, 100.0));
        assert_eq!(Separation::of(&enu(50.0, 0.0), &little, &worse, Risk::SEPARATION).unwrap(), None);
        // After rounding a difference of covariances may not be one.
        assert_eq!(Separation::of(&enu(50.0, 0.0), &covariance(-1.0, 0.0, 4.0), &worse, Risk::SEPARATION).unwrap(), None);
        assert_eq!(Separation::of(&enu(f64::NAN, 0.0), &worse, &worse, Risk::SEPARATION).unwrap(), None);
    }

    #[test]
    fn the_verdict_is_raised_at_once_and_withdrawn_after_unbroken_agreement() {
        let v = covariance(1.0, 0.0, 1.0);
        let nothing = covariance(0.0, 0.0, 0.0);
        let mut verdict = Verdict::new(Risk::SEPARATION);
        let mut at = |second: f64, apart: f64, with: &Covariance<Enu>| {
            verdict.judge(GpsTime::default().plus_seconds(second), &enu(apart, 0.0), with, &v).unwrap();
            verdict.disagree()
        };
        assert!(!at(0.0, 1.0, &v) && at(1.0, 6.0, &v) && at(2.0, 1.0, &v) && at(31.0, 1.0, &v));
        // A second in which nothing can be said breaks the agreement.
        assert!(at(31.5, 1.0, &nothing) && at(33.0, 1.0, &v) && at(62.0, 1.0, &v) && !at(63.0, 1.0, &v));
    }
}
