//! What the ranges of a solved epoch say besides its position: their other readings, and how many of them check the others.

use super::{CLOCKS, Fix, Seen, Solver};
use crate::solution::mixture::{COMMON, Mixture, Observed};
use crate::special::float::sqrt;
use nalgebra::{Matrix3, Vector3};

/// With this many spare ranges a test of residuals that passes is evidence of itself; with fewer only other readings can confirm it.
pub(in crate::solution) const CONFIRMED: usize = 3;
/// With fewer spare ranges than the first number, residuals whose risk is at most the second leave room for a fault that the test does not
/// see, and the ranges are read in every way: two faults of some standard deviations agree by chance the more often the fewer ranges check
/// them. Ours, with the faults of `docs/methods/gnss-exclusion.md`.
const READ_AGAIN: [(usize, f64); 3] = [(5, 1.0), (7, 0.3), (10, 0.05)];
/// A clock that rests on fewer spare ranges than this checks nothing but itself.
const OWN_SPARE: usize = 2;

impl Solver<'_> {
    /// Covariance over all readings of the ranges, where the position's own cannot stand alone: the test failed, whether or not an
    /// exclusion mended that, or so few ranges are to spare that it could have passed in spite of a fault.
    pub(super) fn mixture(&self, fix: &Fix) -> Option<Mixture> {
        let (risk, spare) = (fix.residual_risk, fix.spare);
        // Without redundancy the risk is NaN: nothing was tested.
        let seen = risk >= self.settings.false_alarm && self.before.is_none();
        if seen && !READ_AGAIN.iter().any(|(few, least)| spare < *few && risk <= *least) {
            return None;
        }
        let mut observed =
            [Observed { unit: Vector3::zeros(), clock: 0, sigma_m: 1.0, residual_m: 0.0, common_m: [0.0; COMMON] }; super::MOST_RANGES];
        let mut n = 0;
        for (range, seen) in self.ranges.iter().zip(self.seen.iter()).filter(|(_, s)| s.weighs()) {
            let clock = range.satellite.constellation.index();
            let mut common_m = [0.0; COMMON];
            for (to, from) in common_m.iter_mut().zip(seen.modelled.common.iter()) {
                *to = *from;
            }
            common_m[COMMON - CLOCKS + clock] = self.clock_of[clock].sigma_m;
            observed[n] = Observed {
                unit: seen.row.unit,
                clock: seen.row.clock,
                sigma_m: 1.0 / sqrt(seen.modelled.weight),
                residual_m: seen.row.residual,
                common_m,
            };
            n += 1;
        }
        Mixture::new(&observed[..n])
    }

    /// Ranges beyond the unknowns, but for those of constellations whose clock rests on fewer than two spare ranges of its own.
    pub(super) fn spare(&self) -> usize {
        let mut counts = [0_usize; CLOCKS];
        for (range, _) in self.used_ranges() {
            counts[range.satellite.constellation.index()] += 1;
        }
        let own = |c: usize| usize::from(self.clock_of[c].own(c));
        let checked = (0..CLOCKS).map(|c| counts[c].saturating_sub(own(c))).filter(|n| *n >= OWN_SPARE).sum::<usize>();
        checked.saturating_sub(3)
    }

    /// Satellites used, a bit for each number, by constellation.
    pub(super) fn satellites(&self) -> [u128; CLOCKS] {
        let mut satellites = [0_u128; CLOCKS];
        for (range, _) in self.used_ranges() {
            satellites[range.satellite.constellation.index()] |= 1_u128.checked_shl(range.satellite.number.into()).unwrap_or(0);
        }
        satellites
    }

    /// Variance of each clock against the first that is used, by the covariance of the weights.
    pub(super) fn offset_variances(&self, covariance: &Matrix3<f64>) -> [f64; CLOCKS] {
        let first = self.used_ranges().map(|(_, s)| s.row.clock).min().unwrap_or(0);
        core::array::from_fn(|c| self.normal.clock_difference_variance(c, first, covariance))
    }

    /// What known offsets of clocks leave in common to the ranges of their constellations, as covariance of the position.
    pub(super) fn offset_covariance(&self, inverse: &Matrix3<f64>) -> Matrix3<f64> {
        let mut covariance = Matrix3::zeros();
        for c in (0..CLOCKS).filter(|c| self.clock_of[*c].sigma_m > 0.0) {
            let rows = self.used_ranges().filter(|(r, _)| r.satellite.constellation.index() == c);
            let moved: Vector3<f64> = rows.map(|(_, s)| self.normal.response(inverse, &s.row) * self.clock_of[c].sigma_m).sum();
            covariance += moved * moved.transpose();
        }
        covariance
    }

    pub(super) fn used_ranges(&self) -> impl Iterator<Item = (&super::Range, &Seen)> + '_ {
        self.ranges.iter().zip(self.seen.iter()).filter(|(_, s)| s.counts())
    }
}
