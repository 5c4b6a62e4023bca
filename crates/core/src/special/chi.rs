//! The length of a standard normal vector: tail and factor in one, two and three dimensions.

use super::float::{exp, ln, sqrt};
use super::normal;
use crate::quantity::OutOfDomain;

/// sqrt(2 / pi).
const SQRT_TWO_OVER_PI: f64 = 2.0 * normal::FRAC_1_SQRT_2PI;

/// Tail of the three-dimensional length.
///
/// ```text
/// T3(k) = erfc(k / sqrt 2) + sqrt(2/pi) k exp(-k^2/2)
/// ```
pub(crate) fn tail_3(k: f64) -> f64 {
    2.0 * normal::tail(k) + SQRT_TWO_OVER_PI * k * exp(-0.5 * k * k)
}

/// Factor k(q): the length of a standard normal vector of this dimension exceeds it with risk q. 2.795483482915108 at 0.05 in space.
///
/// # Errors
/// [`OutOfDomain`] unless the dimension is 1, 2 or 3 and `0 < q < 1`: a quantile, which has two sides. A bound takes a `Risk`.
pub fn chi_factor(dimension: usize, q: f64) -> Result<f64, OutOfDomain> {
    if !(q > 0.0 && q < 1.0) {
        return Err(OutOfDomain { argument: "risk", value: q, unit: "1", domain: "(0, 1)" });
    }
    match dimension {
        1 => Ok(normal::two_sided_factor(q)),
        2 => Ok(factor_2(q)),
        3 => Ok(factor_3(q)),
        _ => Err(OutOfDomain { argument: "dimension", value: dimension as f64, unit: "1", domain: "{1, 2, 3}" }),
    }
}

/// sqrt(-2 ln q), with the logarithm of a risk near one taken from its complement.
fn factor_2(q: f64) -> f64 {
    let ln_q = if q > 0.5 { super::float::ln_1p(q - 1.0) } else { ln(q) };
    sqrt(-2.0 * ln_q)
}

/// Newton on the logarithm of the smaller side; both are monotone and concave, so the start only decides the number of steps.
fn factor_3(q: f64) -> f64 {
    if q > 0.9 {
        return factor_3_near_zero(1.0 - q);
    }
    let mut k = factor_2(q) + 0.3;
    for _ in 0..12 {
        let tail = tail_3(k);
        let step = ln(tail / q) * tail / (SQRT_TWO_OVER_PI * k * k * exp(-0.5 * k * k));
        k += step;
        if step.abs() <= 1e-9 * k {
            break;
        }
    }
    k
}

/// The factor whose inside probability is small: P = sqrt(2/pi) k^3 (1/3 - k^2/10 + k^4/56 - ...), Newton in ln k.
fn factor_3_near_zero(p: f64) -> f64 {
    let mut k = libm::cbrt(3.0 * p / SQRT_TWO_OVER_PI);
    for _ in 0..12 {
        let inside = inside_3(k);
        let slope = SQRT_TWO_OVER_PI * k * k * k * exp(-0.5 * k * k) / inside;
        let step = ln(p / inside) / slope;
        k *= exp(step);
        if step.abs() <= 1e-9 {
            break;
        }
    }
    k
}

/// Inside probability for k up to about one: the series of the integral of k^2 exp(-k^2/2), every term of which is
/// smaller than the last; 16 terms leave less than 1e-17 there.
fn inside_3(k: f64) -> f64 {
    let half_square = 0.5 * k * k;
    let mut term = 1.0;
    let mut sum = 1.0 / 3.0;
    for n in 1..16 {
        term *= -half_square / f64::from(n);
        sum += term / f64::from(2 * n + 3);
    }
    SQRT_TWO_OVER_PI * k * k * k * sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tail_of_a_factor_is_its_risk() {
        for k in 1..400 {
            let q = exp(-0.05 * f64::from(k));
            let factor = factor_3(q);
            // An ulp of the factor moves the tail by about k^2 ulps.
            assert!((tail_3(factor) / q - 1.0).abs() <= 4e-16 * (2.0 + factor * factor), "q = {q}");
        }
    }

    #[test]
    fn both_sides_meet_at_the_seam() {
        let (below, above) = (factor_3(0.9), factor_3_near_zero(1.0 - 0.9));
        assert!((below / above - 1.0).abs() < 1e-14, "{below} {above}");
    }

    #[test]
    fn other_dimensions_and_risks_are_refused() {
        assert_eq!(chi_factor(4, 0.05).unwrap_err().argument, "dimension");
        assert_eq!(chi_factor(0, 0.05).unwrap_err().argument, "dimension");
        for q in [0.0, 1.0, -1.0, f64::NAN] {
            assert_eq!(chi_factor(3, q).unwrap_err().argument, "risk");
        }
    }
}
