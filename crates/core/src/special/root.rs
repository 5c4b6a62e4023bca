//! The root of a falling function, by Newton steps that a bracket guards.

use super::float::within;

/// More than enough: a bisection of doubles ends after about sixty.
const MOST_STEPS: usize = 200;

/// The root of a falling function between `low` (where it is positive) and `high` (where it is negative); `f` gives value and slope.
/// A step that is not finite or leaves the bracket is replaced by the middle. Exact to the last digits that `f` has.
pub(crate) fn falling_root(mut low: f64, mut high: f64, start: f64, f: impl Fn(f64) -> (f64, f64)) -> f64 {
    let mut x = within(start, low, high);
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

/// As many as there are exponents of a double.
const MOST_SCALINGS: usize = 2100;

/// The first of `start`, `factor start`, `factor^2 start`, ... for which `goes_on` is false.
pub(crate) fn scaled_while(start: f64, factor: f64, goes_on: impl Fn(f64) -> bool) -> f64 {
    let mut x = start;
    for _ in 0..MOST_SCALINGS {
        if !goes_on(x) {
            break;
        }
        x *= factor;
    }
    x
}

/// The upper one of two neighbouring doubles between which `is_below` changes from true to false, inside `low` and `high`.
pub(crate) fn bisected(mut low: f64, mut high: f64, is_below: impl Fn(f64) -> bool) -> f64 {
    // Every exponent once, and then the digits.
    for _ in 0..MOST_SCALINGS + 64 {
        let middle = 0.5 * (low + high);
        if !(low < middle && middle < high) {
            break;
        }
        if is_below(middle) { low = middle } else { high = middle }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_that_cross_or_are_no_numbers_give_none() {
        assert_eq!([within(2.0, 0.0, 1.0), within(-2.0, 0.0, 1.0), within(0.5, 0.0, 1.0), within(7.0, 3.0, 3.0)], [1.0, 0.0, 0.5, 3.0]);
        let none = [within(0.5, 1.0, 0.0), within(0.5, f64::NAN, 1.0), within(0.5, 0.0, f64::NAN), within(f64::NAN, 0.0, 1.0)];
        assert!(none.iter().all(|x| x.is_nan()), "{none:?}");
    }

    #[test]
    fn a_search_ends_where_nothing_stops_it() {
        assert_eq!(scaled_while(1.0, 2.0, |_| true), f64::INFINITY);
        assert_eq!(scaled_while(1.0, 0.5, |_| true), 0.0);
        assert_eq!(scaled_while(1.0, 2.0, |x| x < 1e300).log2().fract(), 0.0);
        // Neighbours, down to the smallest double.
        assert_eq!(bisected(0.0, 1.0, |x| x < 0.3), 0.3);
        assert_eq!(bisected(0.0, f64::MAX, |_| false), f64::from_bits(1));
        assert_eq!(bisected(0.0, 1.0, |_| true), 1.0);
    }

    #[test]
    fn newton_and_bisection_find_the_same_root() {
        let smooth = falling_root(0.0, 10.0, 9.0, |x| (2.0 - x * x, -2.0 * x));
        assert!((smooth - core::f64::consts::SQRT_2).abs() <= 4e-16);
        // No slope at all: only the bracket leads there.
        let step = falling_root(0.0, 10.0, 9.0, |x| (if x < 3.25 { 1.0 } else { -1.0 }, 0.0));
        assert!((step - 3.25).abs() <= 1e-14);
    }
}
