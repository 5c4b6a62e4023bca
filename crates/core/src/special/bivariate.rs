//! Two normal errors at once: the risk that both exceed, or that either does.

use super::float::{acos, cos, exp, sin, within};
use super::folded::two_tails;
use super::normal::tail;
use super::quadrature::integrate;
use core::f64::consts::{FRAC_PI_2, PI};

/// Halvings towards full correlation; what is left beyond is narrower than rounding.
const MOST_PANELS: usize = 56;

/// Risk that X > h and Y > k for unit normals of correlation `rho`, to rounding of the larger of the two tails.
///
/// ```text
/// L(h, k, rho) = Q(h) Q(k) + 1/(2 pi) integral_0^asin(rho) exp(-(h^2 + k^2 - 2 h k sin a) / (2 cos^2 a)) da
/// ```
///
/// (Plackett 1954.) With t = pi/2 - |a| the exponent is -(h -+ k)^2 / (2 sin^2 t) -+ h k / (2 cos^2(t/2)), which cancels nowhere; panels
/// halve towards t = 0, where the integrand turns on over a range as narrow as |h - k|.
pub(crate) fn both_exceed(h: f64, k: f64, rho: f64) -> f64 {
    let independent = tail(h) * tail(k);
    let (k, sign) = if rho < 0.0 { (-k, -1.0) } else { (k, 1.0) };
    let end = acos(rho.abs());
    let integrand = |t: f64| {
        let (s, c) = (sin(t), cos(0.5 * t));
        exp(-(h - k) * (h - k) / (2.0 * s * s) - h * k / (2.0 * c * c))
    };
    let (mut upper, mut sum) = (FRAC_PI_2, 0.0);
    for _ in 0..MOST_PANELS {
        let lower = (0.5 * upper).max(end);
        sum += integrate(lower, upper, 1, |t| [integrand(t)])[0];
        upper = lower;
        if upper <= end {
            break;
        }
    }
    (independent + sign * sum / (2.0 * PI)).max(0.0)
}

/// Risk that |X| > `limit_x` or |Y| > `limit_y`, X and Y normal with unit deviation, these means and this correlation.
pub(crate) fn either_exceeds(limit_x: f64, mean_x: f64, limit_y: f64, mean_y: f64, rho: f64) -> f64 {
    let (x, y) = (two_tails(limit_x, mean_x), two_tails(limit_y, mean_y));
    let (right, left) = (limit_x - mean_x, limit_x + mean_x);
    let (above, below) = (limit_y - mean_y, limit_y + mean_y);
    let both =
        both_exceed(right, above, rho) + both_exceed(left, below, rho) + both_exceed(right, below, -rho) + both_exceed(left, above, -rho);
    within(x + y - both, x.max(y), (x + y).min(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_quadrant_has_its_closed_form() {
        for rho in [-1.0, -0.99, -0.5, 0.0, 0.3, 0.9, 0.999_999, 1.0] {
            let closed = 0.25 + libm::asin(rho) / (2.0 * PI);
            assert!((both_exceed(0.0, 0.0, rho) - closed).abs() <= 1e-15, "rho {rho}");
        }
    }

    #[test]
    fn full_correlation_leaves_the_farther_tail() {
        for (h, k) in [(1.0, 2.0), (4.0, 4.0), (-1.0, 3.0), (2.0, 2.000_001)] {
            assert!((both_exceed(h, k, 1.0) - tail(h.max(k))).abs() <= 1e-14 * tail(h.min(k)), "{h} {k}");
            assert!((both_exceed(h, k, -1.0) - (tail(h) - tail(-k)).max(0.0)).abs() <= 1e-14 * tail(h.min(k)), "{h} {k}");
        }
    }

    #[test]
    fn the_two_quadrants_on_one_side_make_one_tail() {
        for (h, k, rho) in [(1.0, 0.5, 0.3), (4.5, 3.0, -0.8), (5.0, 5.1, 0.97), (0.2, -2.0, -0.4)] {
            let sum = both_exceed(h, k, rho) + both_exceed(h, -k, -rho);
            assert!((sum / tail(h) - 1.0).abs() <= 1e-12, "{h} {k} {rho}: {sum:e}");
        }
    }
}
