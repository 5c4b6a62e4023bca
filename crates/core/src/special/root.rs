//! The root of a falling function, by Newton steps that a bracket guards.

/// More than enough: a bisection of doubles ends after about sixty.
const MOST_STEPS: usize = 200;

/// The root of a falling function between `low` (where it is positive) and `high` (where it is negative); `f` gives value and slope.
/// A step that is not finite or leaves the bracket is replaced by the middle. Exact to the last digits that `f` has.
pub(crate) fn falling_root(mut low: f64, mut high: f64, start: f64, f: impl Fn(f64) -> (f64, f64)) -> f64 {
    let mut x = start.clamp(low, high);
    for _ in 0..MOST_STEPS {
        let (value, slope) = f(x);
        if value > 0.0 {
            low = x;
        } else {
            high = x;
        }
        let newton = x - value / slope;
        let next = if newton >= low && newton <= high { newton } else { 0.5 * (low + high) };
        let settled = (next - x).abs() <= f64::EPSILON * next.abs();
        x = next;
        if settled {
            break;
        }
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn newton_and_bisection_find_the_same_root() {
        let smooth = falling_root(0.0, 10.0, 9.0, |x| (2.0 - x * x, -2.0 * x));
        assert!((smooth - core::f64::consts::SQRT_2).abs() <= 4e-16);
        // No slope at all: only the bracket leads there.
        let step = falling_root(0.0, 10.0, 9.0, |x| (if x < 3.25 { 1.0 } else { -1.0 }, 0.0));
        assert!((step - 3.25).abs() <= 1e-14);
    }
}
