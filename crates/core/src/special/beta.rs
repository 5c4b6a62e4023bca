//! The beta law, and with it exact limits for a share: Clopper and Pearson.

use super::float::{exp, ln, ln_1p, ln_gamma};
use super::root::bisected;

/// Terms of the continued fraction; it needs a few times the square root of the larger parameter.
const MOST_TERMS: usize = 100_000;
const CLOSE: f64 = 2e-16;
/// A denominator this small stands for zero in Lentz's method.
const TINY: f64 = 1e-300;

/// Probability that a beta variable is at most `x`: the regularised incomplete beta function I_x(a, b). NaN unless `a, b > 0` and
/// `0 <= x <= 1`. The logarithm of the complete function costs digits where a + b is large: about 1e-10 relative at a million.
pub fn beta_head(a: f64, b: f64, x: f64) -> f64 {
    if !(a > 0.0 && b > 0.0 && a.is_finite() && b.is_finite() && (0.0..=1.0).contains(&x)) {
        return f64::NAN;
    }
    if x == 0.0 || x == 1.0 {
        return x;
    }
    let ln_front = a * ln(x) + b * ln_1p(-x) + ln_gamma(a + b) - ln_gamma(a) - ln_gamma(b);
    if x <= (a + 1.0) / (a + b + 2.0) { exp(ln_front) * fraction(a, b, x) / a } else { 1.0 - exp(ln_front) * fraction(b, a, 1.0 - x) / b }
}

/// The value a beta variable does not exceed with probability `p`. NaN unless `a, b > 0` and `0 < p < 1`.
pub fn beta_quantile(a: f64, b: f64, p: f64) -> f64 {
    if !(p > 0.0 && p < 1.0 && a > 0.0 && b > 0.0) {
        return f64::NAN;
    }
    bisected(0.0, 1.0, |x| beta_head(a, b, x) < p)
}

/// Exact two-sided limits of a probability after `hits` in `trials`, each side missed with at most `risk / 2`.
///
/// ```text
/// low  = beta quantile(risk/2;     hits,     trials - hits + 1)      Clopper and Pearson 1934
/// high = beta quantile(1 - risk/2; hits + 1, trials - hits)
/// ```
///
/// Fractional counts, as an effective sample size makes them, are the same formula. NaN unless `0 <= hits <= trials`, `trials > 0`
/// and `0 < risk < 1`.
pub fn share_limits(hits: f64, trials: f64, risk: f64) -> (f64, f64) {
    if !(hits >= 0.0 && hits <= trials && trials > 0.0 && risk > 0.0 && risk < 1.0) {
        return (f64::NAN, f64::NAN);
    }
    let low = if hits > 0.0 { beta_quantile(hits, trials - hits + 1.0, 0.5 * risk) } else { 0.0 };
    let high = if hits < trials { beta_quantile(hits + 1.0, trials - hits, 1.0 - 0.5 * risk) } else { 1.0 };
    (low, high)
}

/// Continued fraction of the incomplete beta function, Lentz's method: what stands behind x^a (1-x)^b / (a B(a, b)) in I_x(a, b).
pub(crate) fn fraction(a: f64, b: f64, x: f64) -> f64 {
    let not_zero = |v: f64| if v.abs() < TINY { TINY } else { v };
    let mut c = 1.0;
    let mut d = 1.0 / not_zero(1.0 - (a + b) * x / (a + 1.0));
    let mut product = d;
    for m in 1..MOST_TERMS {
        let m = m as f64;
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        let mut step = 1.0;
        for term in [even, odd] {
            d = 1.0 / not_zero(1.0 + term * d);
            c = not_zero(1.0 + term / c);
            step *= c * d;
        }
        product *= step;
        if (step - 1.0).abs() <= CLOSE {
            break;
        }
    }
    product
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_parameters_are_sums_of_binomials() {
        // I_x(2, 3) = 6x^2(1-x)^2 + 4x^3(1-x) + x^4
        for x in [1e-6, 0.2, 0.5, 0.9] {
            let expected = 6.0 * x * x * (1.0 - x) * (1.0 - x) + 4.0 * x * x * x * (1.0 - x) + x * x * x * x;
            assert!((beta_head(2.0, 3.0, x) / expected - 1.0).abs() <= 1e-13, "{x}");
        }
    }

    #[test]
    fn no_hit_and_only_hits_have_closed_limits() {
        // 1 - high is the n-th root of risk/2: (1-p)^n = risk/2.
        let n = 50.0;
        let expected = 1.0 - exp(ln(0.025) / n);
        let (low, high) = share_limits(0.0, n, 0.05);
        assert!(low == 0.0 && (high - expected).abs() <= 1e-14, "{high} for {expected}");
        let (low, high) = share_limits(n, n, 0.05);
        assert!(high == 1.0 && (low - (1.0 - expected)).abs() <= 1e-14, "{low}");
    }

    #[test]
    fn impossible_counts_have_no_limits() {
        for (hits, trials, risk) in [(-1.0, 5.0, 0.05), (6.0, 5.0, 0.05), (f64::NAN, 5.0, 0.05), (0.0, 0.0, 0.05), (1.0, 5.0, 0.0)] {
            assert!(share_limits(hits, trials, risk).0.is_nan());
        }
    }
}
