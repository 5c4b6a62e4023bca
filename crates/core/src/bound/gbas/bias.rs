//! The worst horizontal effect of nominal biases, each anywhere within one limit: equation 6 in three orderings.

use super::MOST_SATELLITES;
use crate::special::float::{hypot, sqrt};

/// How the bound of the effect is ordered; each is at least as large as the one before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ordering {
    /// The largest effect there is.
    Exact,
    /// Root sum of squares of the sums east and north.
    Rss,
    /// Sum of the lengths.
    Sum,
}

impl Ordering {
    /// Metres of position for a metre of bias in every range.
    pub fn gain(self, east_north: impl Iterator<Item = [f64; 2]>) -> f64 {
        match self {
            Self::Exact => exact(east_north),
            Self::Rss => {
                let [e, n] = east_north.fold([0.0, 0.0], |[e, n], v| [e + v[0].abs(), n + v[1].abs()]);
                hypot(e, n)
            }
            Self::Sum => east_north.map(|[e, n]| sqrt(e * e + n * n)).sum(),
        }
    }
}

/// The farthest vertex of the zonotope `sum of [-v_i, v_i]`: with every v turned into one half-plane and sorted by direction, its edges
/// are 2 v_1, 2 v_2, ... from the vertex -(v_1 + v_2 + ...); the other half mirrors them. O(N log N).
///
/// Vectors beyond [`MOST_SATELLITES`] would be ignored; no solution has more.
fn exact(east_north: impl Iterator<Item = [f64; 2]>) -> f64 {
    let mut edges = [(0.0, 0.0, 0.0); MOST_SATELLITES];
    let mut count = 0;
    let mut corner = [0.0, 0.0];
    for (slot, v) in edges.iter_mut().zip(east_north) {
        let [e, n] = if v[1] < 0.0 || (v[1] == 0.0 && v[0] < 0.0) { [-v[0], -v[1]] } else { v };
        corner = [corner[0] - e, corner[1] - n];
        let length = e.abs() + n;
        // Falls from 1 to -1 as the direction turns from east to west: an angle without a transcendental function.
        let key = if length > 0.0 { -e / length } else { 1.0 };
        *slot = (key, e, n);
        count += 1;
    }
    let edges = &mut edges[..count];
    edges.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let mut farthest = corner[0] * corner[0] + corner[1] * corner[1];
    for (_, e, n) in edges.iter() {
        corner = [corner[0] + 2.0 * e, corner[1] + 2.0 * n];
        farthest = farthest.max(corner[0] * corner[0] + corner[1] * corner[1]);
    }
    sqrt(farthest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Every combination of signs.
    fn brute_force(vectors: &[[f64; 2]]) -> f64 {
        (0..1_u32 << vectors.len())
            .map(|signs| {
                let sum = vectors.iter().enumerate().fold([0.0, 0.0], |s, (i, v)| {
                    let sign = if signs >> i & 1 == 1 { 1.0 } else { -1.0 };
                    [s[0] + sign * v[0], s[1] + sign * v[1]]
                });
                f64::hypot(sum[0], sum[1])
            })
            .fold(0.0, f64::max)
    }

    proptest! {
        #[test]
        fn the_exact_gain_is_the_largest_over_all_signs(vectors in proptest::collection::vec(proptest::array::uniform2(-1.0..1.0f64), 1..=12)) {
            let gain = Ordering::Exact.gain(vectors.iter().copied());
            // Twelve additions of numbers below 12.
            prop_assert!((gain - brute_force(&vectors)).abs() < 1e-13 * 12.0);
        }

        #[test]
        fn the_orderings_are_ordered(vectors in proptest::collection::vec(proptest::array::uniform2(-1.0..1.0f64), 1..=20)) {
            let [exact, rss, sum] = [Ordering::Exact, Ordering::Rss, Ordering::Sum].map(|o| o.gain(vectors.iter().copied()));
            prop_assert!(exact <= rss * (1.0 + 1e-14) && rss <= sum * (1.0 + 1e-14));
        }
    }

    #[test]
    fn vectors_on_the_axes_and_zeros_are_no_special_case() {
        for vectors in [vec![[0.0, 0.0]], vec![[1.0, 0.0], [-2.0, 0.0]], vec![[0.0, -1.0], [3.0, 0.0], [0.0, 0.0], [-1.0, 1.0]]] {
            assert!((Ordering::Exact.gain(vectors.iter().copied()) - brute_force(&vectors)).abs() < 1e-14);
        }
    }
}
