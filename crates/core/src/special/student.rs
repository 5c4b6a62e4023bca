//! Student's t law, a symmetric law with heavier tails than the normal.

use super::beta::fraction as beta_fraction;
use super::float::{exp, ln, ln_1p, sqrt};
use super::root::{falling_root, scaled_while};
use core::f64::consts::PI;

/// Degrees of freedom from which the expansion of the gamma ratio has all digits.
const EXPANSION_FROM: f64 = 20.0;

/// Gamma(a + 1/2) / Gamma(a), by its expansion in 1/a, reached upwards by the recurrence where a is small.
fn gamma_ratio(a: f64) -> f64 {
    let (mut shifted, mut factor) = (a, 1.0);
    while shifted < EXPANSION_FROM {
        factor *= shifted / (shifted + 0.5);
        shifted += 1.0;
    }
    let (y, y2) = (1.0 / shifted, 1.0 / (shifted * shifted));
    let series = -y * (1.0 / 8.0 - y2 * (1.0 / 192.0 - y2 * (1.0 / 640.0 - y2 * (17.0 / 14_336.0 - y2 * 31.0 / 18_432.0))));
    factor * sqrt(shifted) * exp(series)
}

/// A Student law of unit scale; its standard deviation is sqrt(nu / (nu - 2)) for nu > 2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct StudentT {
    nu: f64,
    peak: f64,
}

impl StudentT {
    /// Degrees of freedom nu > 0 (checked by the caller).
    pub(crate) fn new(nu: f64) -> Self {
        Self { nu, peak: gamma_ratio(0.5 * nu) / sqrt(nu * PI) }
    }

    /// Density.
    pub(crate) fn density(&self, t: f64) -> f64 {
        self.peak * exp(-0.5 * (self.nu + 1.0) * ln_1p(t * t / self.nu))
    }

    /// Upper tail: half the incomplete beta function I_x(nu/2, 1/2) at x = nu / (nu + t^2), by its continued fraction on the
    /// side where that converges.
    pub(crate) fn tail(&self, t: f64) -> f64 {
        if t < 0.0 {
            return 1.0 - self.tail(-t);
        }
        if t.is_infinite() {
            return 0.0;
        }
        let (a, b) = (0.5 * self.nu, 0.5);
        let x = self.nu / (self.nu + t * t);
        let y = t * t / (self.nu + t * t);
        // x^a y^b / B(a, b), from the density: it keeps its digits for any nu.
        let front = self.density(t) * t;
        if x < (a + 1.0) / (a + b + 2.0) {
            0.5 * front / a * beta_fraction(a, b, x)
        } else {
            0.5 - 0.5 * front / b * beta_fraction(b, a, y)
        }
    }

    /// Risk beyond a ratio m of mean to scale and an excess u on either side: S(u) + S(u + 2 m).
    pub(crate) fn risk(&self, ratio: f64, excess: f64) -> f64 {
        self.tail(excess) + self.tail(excess + 2.0 * ratio)
    }

    /// The excess u with S(u) + S(u + 2 m) = q, for a ratio m of mean to scale; solved in the logarithm of the bound m + u, in which
    /// a heavy tail is straight.
    pub(crate) fn excess(&self, ratio: f64, q: f64) -> f64 {
        let risk = |bound: f64| self.tail(bound - ratio) + self.tail(bound + ratio);
        // The step is kept by itself: beside a ratio above 2^53 it is lost, and a bound that stays where it is has no end.
        let high = ratio + scaled_while(1.0, 2.0, |step| risk(ratio + step) > q);
        let low = scaled_while(1.0 + ratio, 0.5, |bound| risk(bound) <= q);
        let f = |y: f64| {
            let bound = exp(y);
            let now = risk(bound);
            (ln(now / q), -bound * (self.density(bound - ratio) + self.density(bound + ratio)) / now)
        };
        let coarse = exp(falling_root(ln(low), ln(high), ln(high), f));
        // The logarithm's own rounding costs |ln T| ulps of T; a plain Newton step takes them back.
        let now = risk(coarse);
        let slope = (self.density(coarse - ratio) + self.density(coarse + ratio)) / now;
        coarse + ln(now / q) / slope - ratio
    }
}

#[cfg(test)]
mod tests {
    use super::super::float::atan2;
    use super::*;

    /// Cauchy and nu = 2 have closed tails.
    #[test]
    fn closed_tails_are_met() {
        for t in [0.0, 0.1, 0.7, 1.0, 1.5, 4.0, 100.0, 1e6] {
            let cauchy = atan2(1.0, t) / PI;
            assert!((StudentT::new(1.0).tail(t) / cauchy - 1.0).abs() <= 2e-14, "nu 1, t {t}");
            let root = sqrt(2.0 + t * t);
            let two = 1.0 / (root * (root + t));
            assert!((StudentT::new(2.0).tail(t) / two - 1.0).abs() <= 2e-14, "nu 2, t {t}");
        }
    }

    #[test]
    fn a_root_beside_any_ratio_ends() {
        for ratio in [2f64.powi(52), 2f64.powi(53) + 2.0, 1e100, 1e300, f64::MAX, f64::INFINITY] {
            // Any number will do: what matters is that it comes, and the caller checks its risk.
            let _ = StudentT::new(6.0).excess(ratio, 1e-5);
        }
    }

    #[test]
    fn many_degrees_of_freedom_are_nearly_normal() {
        let normal = super::super::normal::tail(4.0);
        // First correction: Q + phi t (t^2 + 1) / (4 nu).
        let first = normal + super::super::normal::density(4.0) * 4.0 * 17.0 / (4.0 * 1e6);
        assert!((StudentT::new(1e6).tail(4.0) / first - 1.0).abs() <= 1e-8);
    }
}
