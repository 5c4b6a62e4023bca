//! The folded normal law: |X| for X normal with a known mean. Both of its tails matter.

use super::float::{exp, ln, ln_1p, within};
use super::normal::{density, ln_tail, one_sided_factor, tail, two_sided_factor};
use crate::quantity::Risk;
use core::f64::consts::LN_2;

/// Halley steps on the logarithm of the risk. Three reach 4e-16 for risks up to 1/2 (measured against 50 digits).
const STEPS: usize = 3;
/// Above 1/2 the lower limit of the root depends on the ratio and the start is worse.
const STEPS_ABOVE_HALF: usize = 8;

/// Risk that |X| > `limit` when X is normal with mean `mean` and unit deviation: both tails, full relative accuracy.
#[inline]
pub fn two_tails(limit: f64, mean: f64) -> f64 {
    tail(limit - mean) + tail(limit + mean)
}

/// Its logarithm, finite where the risk itself underflows.
pub fn ln_two_tails(limit: f64, mean: f64) -> f64 {
    let near = ln_tail(limit - mean.abs());
    near + ln_1p(exp(ln_tail(limit + mean.abs()) - near))
}

/// Quantiles of the folded normal law at one risk.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FoldedQuantile {
    risk: f64,
    one_sided: f64,
    two_sided: f64,
}

impl FoldedQuantile {
    /// The factors of one risk, worked out once.
    pub fn new(risk: Risk) -> Self {
        let q = risk.q();
        Self { risk: q, one_sided: one_sided_factor(q), two_sided: two_sided_factor(q) }
    }
    /// The risk q.
    pub const fn risk(&self) -> f64 {
        self.risk
    }
    /// z(q): the smallest distance from mean to bound, reached by a mean of many deviations.
    pub const fn one_sided(&self) -> f64 {
        self.one_sided
    }
    /// K(q): the largest, reached by a mean of zero.
    pub const fn two_sided(&self) -> f64 {
        self.two_sided
    }

    /// Distance u from mean to bound in deviations, for `ratio` m = |mean| / deviation: the root of
    ///
    /// ```text
    /// Q(u) + Q(u + 2 m) = q,    z(q) < u <= K(q), equal to K iff m = 0
    /// ```
    ///
    /// Halley steps on ln(risk / q), clamped to the bracket. Bisection must not be added: near m = 0 the root lies on the end of the
    /// bracket, rounding pushes an iterate one ulp outside, and bisecting then destroys nine digits.
    pub fn excess(&self, ratio: f64) -> f64 {
        let low = self.one_sided.max(-ratio);
        let missing = tail(self.two_sided + 2.0 * ratio) / self.risk;
        let start = self.one_sided + (self.two_sided - self.one_sided) * (-ln_1p(-missing) / LN_2);
        let mut u = within(start, low, self.two_sided);
        for _ in 0..if self.risk > 0.5 { STEPS_ABOVE_HALF } else { STEPS } {
            u = within(self.halley(u, ratio), low, self.two_sided);
        }
        u
    }

    /// One Halley step towards the root.
    pub(super) fn halley(&self, u: f64, ratio: f64) -> f64 {
        let far = u + 2.0 * ratio;
        let risk = tail(u) + tail(far);
        let (near_density, far_density) = (density(u), density(far));
        let f = ln(risk / self.risk);
        let h = (near_density + far_density) / risk;
        // Infinity times zero at an infinite ratio: the far tail has no slope there.
        let far_moment = if far_density > 0.0 { far * far_density } else { 0.0 };
        let second = (u * near_density + far_moment) / risk - h * h;
        u + 2.0 * f * h / (2.0 * h * h - f * second)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_logarithm_agrees_where_both_exist_and_goes_on_where_the_risk_underflows() {
        for (limit, mean) in [(0.0, 0.0), (1.0, 0.3), (5.0, -2.0), (1.0, 4.0), (30.0, 1.0)] {
            let direct = ln(two_tails(limit, mean));
            assert!((ln_two_tails(limit, mean) - direct).abs() <= 1e-13 * direct.abs().max(1.0), "{limit} {mean}");
        }
        assert!(two_tails(60.0, 1.0) == 0.0 && ln_two_tails(60.0, 1.0) < -1700.0);
    }

    #[test]
    fn the_risk_at_the_root_is_the_risk_requested() {
        for q in [1e-12, 1e-9, 1e-5, 0.05, 0.3, 0.5] {
            let law = FoldedQuantile::new(Risk::new(q).unwrap());
            for step in 0..400 {
                let m = 0.02 * f64::from(step);
                let u = law.excess(m);
                // An ulp of u moves the risk by u times the hazard, about u^2 + 1 ulps; T >= 0 costs an ulp of m more.
                let allowed = 1e-15 * (2.0 + u * u + m * law.two_sided());
                assert!((two_tails(u + m, m) / q - 1.0).abs() <= allowed, "q {q} m {m}: {:e}", two_tails(u + m, m) / q - 1.0);
            }
        }
    }

    #[test]
    fn an_infinite_ratio_leaves_one_tail() {
        let law = FoldedQuantile::new(Risk::ACCURACY);
        assert!((law.excess(f64::INFINITY) - law.one_sided()).abs() <= 3e-16 * law.one_sided());
        assert!((law.excess(0.0) - law.two_sided()).abs() <= 3e-16 * law.two_sided());
    }
}
