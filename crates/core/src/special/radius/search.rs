//! The radius of a risk, from a law that can only be evaluated.

use super::AtRadius;
use crate::special::float::ln;

/// The law at a radius, with the derivative of its density where the rule gives it.
pub(super) struct Point {
    pub(super) at: AtRadius,
    pub(super) slope: Option<f64>,
}

/// Halley's step leaves the cube of the last relative step, Newton's half its square: below these, less than rounding.
const HALLEY_DONE: f64 = 1e-6;
const NEWTON_DONE: f64 = 1e-8;

/// Solves outside(r) = q, by Halley or Newton on the logarithm of the smaller side, which is nearly linear where the side itself is
/// not; a step that leaves the bracket (0, longest) is replaced by halving it.
pub(super) fn radius(q: f64, start: f64, longest: f64, law: impl Fn(f64) -> Point) -> f64 {
    let (mut lo, mut hi) = (0.0, longest);
    let mut r = if start > lo && start < hi { start } else { 0.5 * hi };
    // Halving alone would need 60 steps to exhaust a double.
    for _ in 0..100 {
        let Point { at, slope } = law(r);
        // Decreasing in r, zero at the radius; its first two derivatives.
        let (g, first, second) = if q <= 0.5 {
            let h = at.density / at.outside;
            (ln(at.outside / q), -h, slope.map(|s| -s / at.outside - h * h))
        } else {
            let h = at.density / at.inside;
            (-ln(at.inside / (1.0 - q)), -h, slope.map(|s| -s / at.inside + h * h))
        };
        if g == 0.0 {
            return r;
        }
        if g > 0.0 || at.inside <= 0.0 {
            lo = r;
        } else {
            hi = r;
        }
        let (step, done) = match second {
            Some(second) => (-2.0 * g * first / (2.0 * first * first - g * second), HALLEY_DONE),
            None => (-g / first, NEWTON_DONE),
        };
        let next = r + step;
        if step.abs() <= done * r {
            return next;
        }
        r = if next > lo && next < hi { next } else { 0.5 * (lo + hi) };
        if !(hi - lo > f64::EPSILON * hi) {
            return r;
        }
    }
    r
}
