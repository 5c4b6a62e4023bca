//! Every subset of an epoch's satellites as a solution of its own: its error and its covariance.
//!
//! A good geometry hides a range that is wrong; among the subsets it does not. Each subset is made from the one with a satellite more by
//! a rank-one step (Sherman and Morrison 1950), so that it costs a few dozen multiplications and no inverse. Provenance: ours, of standard parts.

use super::common::COMMON;
use super::wls::CONDITION_LIMIT;
use crate::frame::{Covariance, Displacement, Enu};
use crate::quantity::{Metres, Unavailable};
use nalgebra::{Matrix4, SMatrix, Vector3, Vector4};

/// Most ranges of one epoch: a subset is a word of bits.
pub const MOST_RANGES: usize = 64;
/// Unknowns: position and one clock.
const UNKNOWNS: usize = 4;
/// What is left of the determinant of the last normal matrix inverted from scratch, below which it is inverted again. What is left after a
/// step is 1 - w h' P h, where large variances cancel: the steps since then have lost some 1e-16 / 1e-4 of the result, times the largest
/// variance and the largest weight.
const WORN: f64 = 1e-4;

/// A range whose true value is known, of one receiver clock.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RangeInError {
    /// Unit vector from the receiver to the satellite, east-north-up.
    pub unit: Vector3<f64>,
    /// 1 / sigma² \[1/m²\].
    pub weight: f64,
    /// Measured less true range; what is common to all ranges is the clock's.
    pub error: Metres,
    /// Standard deviations of the errors that all ranges share, each with its own sign and size here \[m\]; zero without such.
    pub shared_m: Vector4<f64>,
}

/// A subset's solution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Subset {
    /// Bit i: range i is used.
    pub used: u64,
    /// True less estimated position.
    pub nse: Displacement<Enu>,
    /// By the weights and the shared errors.
    pub covariance: Covariance<Enu>,
}

/// How many subsets were requested, and how many determine no position.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Walked {
    /// All.
    pub n: u64,
    /// Those whose normal matrix has a condition number above [`CONDITION_LIMIT`], or that hold such a set.
    pub n_singular: u64,
}

/// Subsets of n ranges that leave out at most so many; saturates.
pub fn count(n: usize, most_left_out: usize) -> u64 {
    let (mut sum, mut binomial) = (0_u64, 1_u128);
    for k in 0..=most_left_out.min(n) {
        sum = sum.saturating_add(u64::try_from(binomial).unwrap_or(u64::MAX));
        binomial = binomial * (n - k) as u128 / (k as u128 + 1);
    }
    sum
}

/// Visit the whole set and every subset of at least `least` ranges that leaves out at most `most_left_out`.
///
/// ```text
/// error_i = u_i . nse + clock                             weighted least squares, P = (H' W H)^-1, x = P H' W error, h = (u, 1)
/// without i:  s = 1 - w h' P h,  k = P h w / s,  P' = P + k (P h)',  x' = x - k (error_i - h' x)
/// covariance = P + sum over shared errors of x x'         x: what the shared error does to the position
/// ```
///
/// # Errors
/// [`Unavailable::TooFewSatellites`] with less than `least` or four ranges, [`Unavailable::Invalid`] with more than [`MOST_RANGES`] or a
/// weight that is not positive, [`Unavailable::Singular`] where the whole set determines no position.
pub fn walk(ranges: &[RangeInError], least: usize, most_left_out: usize, visit: &mut impl FnMut(&Subset)) -> Result<Walked, Unavailable> {
    let (have, need) = (ranges.len(), least.max(UNKNOWNS));
    if have < need {
        return Err(Unavailable::TooFewSatellites { need, have });
    }
    if have > MOST_RANGES {
        return Err(Unavailable::Invalid { field: "ranges", value: have as f64, unit: "1", domain: "[0, 64]" });
    }
    for range in ranges {
        if !(range.weight > 0.0 && range.weight.is_finite()) {
            return Err(Unavailable::Invalid { field: "weight", value: range.weight, unit: "1/m^2", domain: "(0, inf)" });
        }
        if !(range.error.m().is_finite() && range.unit.iter().chain(range.shared_m.iter()).all(|v| v.is_finite())) {
            return Err(Unavailable::Invalid { field: "range_error_m", value: range.error.m(), unit: "m", domain: "finite errors" });
        }
    }
    let all = if have == MOST_RANGES { u64::MAX } else { (1 << have) - 1 };
    let whole = fresh(ranges, all).ok_or(Unavailable::Singular { condition: f64::INFINITY, limit: CONDITION_LIMIT })?;
    let mut walker = Walker { ranges, visit, walked: Walked::default() };
    walker.descend(&whole, 0, most_left_out.min(have - need));
    Ok(walker.walked)
}

/// Position error and clock, and beside it what each of the shared errors does.
type Columns = SMatrix<f64, UNKNOWNS, { 1 + COMMON }>;
type ColumnsOfRow = SMatrix<f64, 1, { 1 + COMMON }>;

/// A subset's solution under way.
struct Node {
    used: u64,
    inverse: Matrix4<f64>,
    solved: Columns,
    /// Determinant against that of the last matrix inverted from scratch.
    left: f64,
}

struct Walker<'a, F> {
    ranges: &'a [RangeInError],
    visit: &'a mut F,
    walked: Walked,
}

impl<F: FnMut(&Subset)> Walker<'_, F> {
    /// The node, and every subset of it that leaves out ranges from `from` on: each subset is met once.
    fn descend(&mut self, node: &Node, from: usize, depth: usize) {
        self.walked.n += 1;
        (self.visit)(&node.subset());
        if depth == 0 {
            return;
        }
        for i in from..self.ranges.len() {
            match node.without(self.ranges, i) {
                Some(smaller) => self.descend(&smaller, i + 1, depth - 1),
                None => {
                    // What a set does not determine no part of it does.
                    let below = count(self.ranges.len() - i - 1, depth - 1);
                    self.walked.n += below;
                    self.walked.n_singular += below;
                }
            }
        }
    }
}

impl Node {
    fn without(&self, ranges: &[RangeInError], i: usize) -> Option<Self> {
        let range = &ranges[i];
        let used = self.used & !(1 << i);
        let (h, y) = row(range);
        let moved = self.inverse * h;
        let rest = 1.0 - range.weight * h.dot(&moved);
        let left = self.left * rest;
        if !(left > WORN) {
            return fresh(ranges, used);
        }
        let gain = moved * (range.weight / rest);
        let inverse = self.inverse + gain * moved.transpose();
        let solved = self.solved - gain * (y - h.transpose() * self.solved);
        Some(Self { used, inverse, solved, left })
    }

    fn subset(&self) -> Subset {
        let shared = self.solved.fixed_view::<3, COMMON>(0, 1);
        let covariance = self.inverse.fixed_view::<3, 3>(0, 0) + shared * shared.transpose();
        Subset {
            used: self.used,
            nse: Displacement::from_vector(self.solved.fixed_view::<3, 1>(0, 0).into()),
            covariance: Covariance::claim_symmetric(covariance),
        }
    }
}

fn row(range: &RangeInError) -> (Vector4<f64>, ColumnsOfRow) {
    let (u, s) = (&range.unit, &range.shared_m);
    (Vector4::new(u.x, u.y, u.z, 1.0), ColumnsOfRow::new(range.error.m(), s.x, s.y, s.z, s.w))
}

/// A subset from nothing but its ranges; `None` where it determines no position.
fn fresh(ranges: &[RangeInError], used: u64) -> Option<Node> {
    let (mut normal, mut side) = (Matrix4::zeros(), Columns::zeros());
    for (_, range) in ranges.iter().enumerate().filter(|(i, _)| used >> i & 1 == 1) {
        let (h, y) = row(range);
        normal += range.weight * h * h.transpose();
        side += range.weight * h * y;
    }
    let factor = normal.cholesky()?;
    let inverse = factor.inverse();
    // The product of the traces is never below the condition number, and at most sixteen times it.
    (normal.trace() * inverse.trace() <= CONDITION_LIMIT).then(|| Node { used, inverse, solved: factor.solve(&side), left: 1.0 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    extern crate std;
    use std::vec::Vec;

    fn towards(az_deg: f64, el_deg: f64) -> Vector3<f64> {
        let (az, el) = (az_deg.to_radians(), el_deg.to_radians());
        Vector3::new(az.sin() * el.cos(), az.cos() * el.cos(), el.sin())
    }

    fn sky(angles: &[(f64, f64, f64, f64)]) -> Vec<RangeInError> {
        let range = |&(az, el, sigma, error): &(f64, f64, f64, f64)| RangeInError {
            unit: towards(az, el),
            weight: 1.0 / (sigma * sigma),
            error: Metres::new(error),
            shared_m: Vector4::new(0.3 / el.to_radians().sin(), 0.2 * az.to_radians().sin(), 0.1, 0.04),
        };
        angles.iter().map(range).collect()
    }

    fn subsets(ranges: &[RangeInError], least: usize, most_left_out: usize) -> (Vec<Subset>, Walked) {
        let mut met = Vec::new();
        let walked = walk(ranges, least, most_left_out, &mut |s| met.push(*s)).unwrap();
        (met, walked)
    }

    const SEVEN: [(f64, f64, f64, f64); 7] = [
        (10.0, 75.0, 1.0, 0.4),
        (70.0, 20.0, 2.0, -1.0),
        (150.0, 35.0, 1.5, 0.9),
        (200.0, 12.0, 3.0, 2.0),
        (250.0, 50.0, 1.2, -0.3),
        (300.0, 28.0, 1.8, 1.1),
        (340.0, 60.0, 1.1, 0.2),
    ];

    #[test]
    fn every_subset_of_four_or_more_is_met_once() {
        let (met, walked) = subsets(&sky(&SEVEN), 4, 7);
        // 35 + 21 + 7 + 1 subsets of 4, 5, 6 and 7 of seven.
        assert_eq!(walked, Walked { n: 64, n_singular: 0 });
        let mut masks: Vec<u64> = met.iter().map(|s| s.used).collect();
        masks.sort_unstable();
        masks.dedup();
        assert_eq!(masks.len(), 64);
        assert!(masks.iter().all(|m| m.count_ones() >= 4 && *m < 128));
        assert_eq!(subsets(&sky(&SEVEN), 5, 7).1.n, 29);
        assert_eq!(subsets(&sky(&SEVEN), 4, 1).1.n, 8);
        assert_eq!(count(7, 3), 64);
    }

    #[test]
    fn an_error_of_the_position_alone_is_that_of_every_subset() {
        let nse = Vector3::new(3.0, -4.0, 7.0);
        let mut ranges = sky(&SEVEN);
        for range in &mut ranges {
            range.error = Metres::new(range.unit.dot(&nse) + 12.0);
        }
        for subset in subsets(&ranges, 4, 7).0 {
            // Conditions of these 64 are below 1e4: sixteen digits less four.
            assert!((subset.nse.vector() - nse).amax() < 1e-10, "{subset:?}");
        }
    }

    #[test]
    fn what_cannot_be_solved_is_reported() {
        let cone: Vec<_> = (0..6).map(|k| (60.0 * f64::from(k), 30.0, 1.0, 0.0)).collect();
        let none = &mut |_: &Subset| {};
        assert!(matches!(walk(&sky(&cone), 4, 2, none), Err(Unavailable::Singular { .. })));
        assert_eq!(walk(&sky(&SEVEN[..3]), 4, 2, none), Err(Unavailable::TooFewSatellites { need: 4, have: 3 }));
        let mut negative = sky(&SEVEN);
        negative[2].weight = f64::NAN;
        assert!(matches!(walk(&negative, 4, 2, none), Err(Unavailable::Invalid { field: "weight", .. })));
        // Five on a cone and one overhead: without that one, and only without it, nothing is determined.
        let mut crown = cone;
        crown[5] = (0.0, 90.0, 1.0, 0.0);
        let (met, walked) = subsets(&sky(&crown), 4, 6);
        assert_eq!((walked.n, walked.n_singular), (22, 6));
        assert_eq!(met.len(), 16);
        assert!(met.iter().all(|s| s.used >> 5 == 1));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(60))]
        // Against a solution of each subset's own rows by the eliminated normal equation of `wls`, another form of the same algebra.
        #[test]
        fn each_is_the_solution_of_its_own_ranges(
            angles in proptest::collection::vec((0.0..360.0f64, 5.0..90.0f64, 0.3..20.0f64, -30.0..30.0f64), 6..10),
        ) {
            use super::super::wls::{Normal, Row};
            let mut ranges = sky(&angles);
            ranges.iter_mut().for_each(|r| r.shared_m = Vector4::zeros());
            let mut met = Vec::new();
            let Ok(_) = walk(&ranges, 4, 9, &mut |s: &Subset| met.push(*s)) else { return Ok(()) };
            for subset in met {
                let rows = ranges.iter().enumerate().filter(|(i, _)| subset.used >> i & 1 == 1);
                let rows = rows.map(|(_, r)| Row { unit: r.unit, weight: r.weight, clock: 0, residual: r.error.m() });
                let normal = Normal::new(rows).unwrap();
                let (Ok(covariance), Some(step)) = (normal.covariance(), normal.step()) else { continue };
                // Subsets that leave a sigma above 100 m are left out: their condition costs either form its digits.
                let scale = covariance.matrix().amax();
                if scale > 1e4 {
                    continue;
                }
                // Steps lose 1e-16 / WORN = 1e-12 of the result, times the largest variance and weight (1 / 0.3²); four times that here,
                // for a clock's variance is not seen. At most 5e-7, and 5e-11 where a sigma is a metre.
                let lost = 4e-12 * (1.0 + scale / (0.3 * 0.3));
                let worst = (covariance.matrix() - subset.covariance.matrix()).amax();
                prop_assert!(worst < lost * scale, "{} of {}", worst, scale);
                let moved = (step + subset.nse.vector()).amax();
                prop_assert!(moved < lost * (30.0 + scale.sqrt() * 100.0), "{} of {}", moved, step);
            }
        }
    }
}
