//! The chi-square law of any, also fractional, degrees of freedom: both tails and the quantile.

use super::float::{exp, ln, ln_1p, ln_gamma, sqrt};
use super::root::{bisected, scaled_while};
use core::f64::consts::PI;

/// Terms of the series and of the continued fraction; both need a few times the square root of the degrees of freedom.
const MOST_TERMS: usize = 1_000_000;
const CLOSE: f64 = 1e-16;
/// From here on Stirling's series with three terms has all digits, and the exponent is formed without cancellation.
const STIRLING_FROM: f64 = 30.0;

/// Risk that a chi-square variable exceeds `x`. NaN unless `dof > 0` and `x >= 0`.
pub fn chi_square_tail(dof: f64, x: f64) -> f64 {
    sides(0.5 * dof, 0.5 * x).1
}

/// Probability that a chi-square variable is at most `x`, with full relative accuracy where it is small.
pub fn chi_square_head(dof: f64, x: f64) -> f64 {
    sides(0.5 * dof, 0.5 * x).0
}

/// The value a chi-square variable exceeds with risk `q`. NaN unless `dof > 0` and `0 < q < 1`.
pub fn chi_square_factor(dof: f64, q: f64) -> f64 {
    if !(q > 0.0 && q < 1.0 && dof > 0.0 && dof.is_finite()) {
        return f64::NAN;
    }
    let is_below = |x: f64| chi_square_tail(dof, x) > q;
    bisected(0.0, scaled_while(dof + 1.0, 2.0, is_below), is_below)
}

/// Regularised incomplete gamma functions P(a, x) and Q(a, x).
fn sides(a: f64, x: f64) -> (f64, f64) {
    if !(a > 0.0 && a.is_finite() && x >= 0.0) {
        return (f64::NAN, f64::NAN);
    }
    if x == 0.0 {
        return (0.0, 1.0);
    }
    if x == f64::INFINITY {
        return (1.0, 0.0);
    }
    if x < a + 1.0 {
        let head = power(a, x) * series(a, x);
        (head, 1.0 - head)
    } else {
        let tail = power(a, x) * fraction(a, x);
        (1.0 - tail, tail)
    }
}

/// x^a e^-x / Gamma(a + 1).
fn power(a: f64, x: f64) -> f64 {
    if a < STIRLING_FROM {
        return exp(a * ln(x) - x - ln_gamma(a + 1.0));
    }
    let excess = (x - a) / a;
    let y = 1.0 / (a * a);
    let stirling = (1.0 / 12.0 - y * (1.0 / 360.0 - y * (1.0 / 1260.0 - y / 1680.0))) / a;
    exp(-a * (excess - ln_1p(excess)) - stirling) / sqrt(2.0 * PI * a)
}

/// 1 + x/(a+1) + x²/((a+1)(a+2)) + ...
fn series(a: f64, x: f64) -> f64 {
    let (mut term, mut sum) = (1.0, 1.0);
    for n in 1..MOST_TERMS {
        term *= x / (a + n as f64);
        sum += term;
        if term <= CLOSE * sum {
            break;
        }
    }
    sum
}

/// a / (x+1-a - 1(1-a)/(x+3-a - 2(2-a)/(x+5-a - ...))), by Lentz's method. The terms are positive for x > a + 1.
fn fraction(a: f64, x: f64) -> f64 {
    let mut b = x + 1.0 - a;
    let mut c = f64::INFINITY;
    let mut d = 1.0 / b;
    let mut product = d;
    for n in 1..MOST_TERMS {
        let n = n as f64;
        let numerator = -n * (n - a);
        b += 2.0;
        d = 1.0 / (b + numerator * d);
        c = b + numerator / c;
        let step = c * d;
        product *= step;
        if (step - 1.0).abs() <= 2.0 * CLOSE {
            break;
        }
    }
    a * product
}

#[cfg(test)]
mod tests {
    use super::*;

    /// mpmath, 40 digits.
    const TAILS: [(f64, f64, f64); 9] = [
        (1.0, 3.84, 0.050043521248705106),
        (3.0, 0.01, 0.9997348349413444),
        (3.0, 25.0, 1.5440498291101365e-05),
        (0.5, 2.5, 0.04724670114390936),
        (37.25, 60.0, 0.010484080411469004),
        (300.0, 350.0, 0.02473079726438742),
        (1200000.0, 1204000.0, 0.004946373751247654),
        (5.0, 200.0, 2.8406228986415315e-41),
        (10000.0, 9700.0, 0.9837492048222901),
    ];

    #[test]
    fn tails_meet_forty_digit_values() {
        for (dof, x, tail) in TAILS {
            let computed = chi_square_tail(dof, x);
            assert!((computed / tail - 1.0).abs() <= 1e-12, "dof {dof}, x {x}: {computed} for {tail}");
        }
    }

    #[test]
    fn two_degrees_are_an_exponential() {
        for x in [1e-8, 0.3, 2.0, 40.0, 600.0] {
            let tail = chi_square_tail(2.0, x);
            assert!((tail / exp(-0.5 * x) - 1.0).abs() <= 1e-13, "{x}: {tail}");
        }
    }

    #[test]
    fn the_factor_gives_its_risk_back() {
        for dof in [0.7, 3.0, 12.5, 300.0, 1.2e6] {
            for q in [1e-9, 0.025, 0.5, 0.975] {
                let back = chi_square_tail(dof, chi_square_factor(dof, q));
                // One ulp of the factor moves the tail by about sqrt(dof) times the hazard in ulps.
                assert!((back / q - 1.0).abs() <= 1e-15 * (100.0 + 10.0 * sqrt(dof) * -ln(q)), "dof {dof}, q {q}: {back}");
            }
        }
    }

    #[test]
    fn outside_the_domain_there_is_no_number() {
        for (dof, x) in [(0.0, 1.0), (-1.0, 1.0), (f64::NAN, 1.0), (2.0, -1.0), (2.0, f64::NAN)] {
            assert!(chi_square_tail(dof, x).is_nan() && chi_square_head(dof, x).is_nan());
        }
        assert!(chi_square_factor(3.0, 0.0).is_nan());
    }
}
