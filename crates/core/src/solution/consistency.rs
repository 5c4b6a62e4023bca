//! Residuals of one epoch against the standard deviations that a model states for them.
//!
//! Source: chi-square of a least-squares adjustment and its redundancy numbers (Baarda 1968); provenance: standard.

use super::wls::{Normal, WeightedSight, weighted_row};
use crate::quantity::Unavailable;
use crate::signal::Constellation;

/// Sums of one epoch, by constellation in the order of [`Constellation::ALL`].
///
/// ```text
/// statistic  = sum w_i e_i^2           e: residuals of the least-squares solution with the weights w
/// redundancy = sum (1 - h_i)           h: leverage of the range; over all constellations: ranges less unknowns
/// ```
///
/// Where the weights are 1 / variance the expectation of the statistic is the redundancy, in each constellation too.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Consistency {
    /// Weighted squared residuals \[1\].
    pub statistic: [f64; Constellation::ALL.len()],
    /// Redundancy \[1\].
    pub redundancy: [f64; Constellation::ALL.len()],
}

impl Consistency {
    /// Of ranges with their residuals: measured less computed ranges at one place near the solution \[m\], receiver clocks in them.
    ///
    /// # Errors
    /// [`Unavailable`]: fewer ranges than unknowns, or a geometry that does not determine them.
    pub fn of(ranges: impl Iterator<Item = (WeightedSight, f64)> + Clone) -> Result<Self, Unavailable> {
        let rows = ranges.map(|(sight, residual)| super::wls::Row { residual, ..weighted_row(sight) });
        let normal = Normal::new(rows.clone())?;
        let singular = Unavailable::Singular { condition: f64::INFINITY, limit: super::wls::CONDITION_LIMIT };
        let (step, inverse) = normal.step().zip(normal.inverse()).ok_or(singular)?;
        let mut sums = Self::default();
        for row in rows {
            let residual = row.residual + row.unit.dot(&step) - normal.clock(row.clock, &step);
            sums.statistic[row.clock] += row.weight * residual * residual;
            sums.redundancy[row.clock] += 1.0 - normal.leverage(&inverse, &row);
        }
        Ok(sums)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    fn ranges(residual: impl Fn(usize) -> f64) -> Vec<(WeightedSight, f64)> {
        let sight = |k: usize| {
            let (azimuth, elevation) = (2.4 * k as f64, 0.2 + 0.13 * (k * 5 % 9) as f64);
            let unit = Vector3::new(elevation.cos() * azimuth.sin(), elevation.cos() * azimuth.cos(), elevation.sin());
            let constellation = if k.is_multiple_of(2) { Constellation::Gps } else { Constellation::Galileo };
            (WeightedSight { unit, weight: 0.25, constellation }, residual(k))
        };
        (0..13).map(sight).collect()
    }

    #[test]
    fn redundancies_add_to_ranges_less_unknowns() {
        let sums = Consistency::of(ranges(|_| 0.0).into_iter()).unwrap();
        assert!((sums.redundancy.iter().sum::<f64>() - (13.0 - 5.0)).abs() < 1e-9);
        assert_eq!(sums.redundancy[Constellation::BeiDou.index()], 0.0);
        assert!(sums.redundancy[0] > 0.0 && sums.redundancy[2] > 0.0);
    }

    #[test]
    fn what_position_and_clocks_explain_leaves_no_statistic() {
        let moved = |k: usize| {
            let clock = if k.is_multiple_of(2) { 40.0 } else { -70.0 };
            clock - ranges(|_| 0.0)[k].0.unit.dot(&Vector3::new(3.0, -2.0, 5.0))
        };
        let sums = Consistency::of(ranges(moved).into_iter()).unwrap();
        // Residuals of 100 m cancel to rounding.
        assert!(sums.statistic.iter().sum::<f64>() < 1e-20);
        // One metre on one range leaves its own redundancy times its weight.
        let one = Consistency::of(ranges(|k| f64::from(u8::from(k == 4))).into_iter()).unwrap();
        let total = one.statistic.iter().sum::<f64>();
        assert!(total > 0.0 && total < 0.25);
    }
}
