//! The test of an epoch's residuals, and the exclusion of the satellite that explains them best.

use super::{ESSENTIAL, Levels, Monitor};
use crate::bound::araim::exclusion::Decision;
use crate::quantity::{Metres, Unavailable};
use crate::solution::wls::WeightedSight;
use crate::special::float::sqrt;
use nalgebra::Vector3;

/// An epoch after detection and exclusion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Monitored {
    /// What was decided.
    pub decision: Decision,
    /// Levels of detection with the satellites that are left.
    pub levels: Levels,
    /// Their solution from the place where the residuals were taken, east, north, up.
    pub step: [Metres; 3],
    /// The satellite excluded.
    pub excluded: Option<usize>,
    /// Root of the weighted sum of squared residuals before exclusion against its threshold; 0 without redundancy.
    pub ratio: f64,
}

impl Monitor {
    /// Detection and exclusion on residuals: measured less computed ranges at one place, clocks of any value in them \[m\].
    ///
    /// ```text
    /// sum w v^2 > T^2                                      fault
    /// i = argmax (w_i v_i)^2 / Pi_ii,                      by which the sum falls without satellite i
    /// sum w v^2 - (w_i v_i)^2 / Pi_ii <= T^2(one less)     excluded; otherwise the position is not to be used
    /// ```
    ///
    /// With one redundant range a fault is seen and not found. Provenance *standard* (least-squares residuals, data snooping).
    ///
    /// # Errors
    /// As [`Monitor::levels`]; a residual that is no number.
    pub fn monitored(&mut self, sights: &[impl Copy + Into<WeightedSight>], residuals_m: &[f64]) -> Result<Monitored, Unavailable> {
        if residuals_m.len() != sights.len() {
            let (value, domain) = (residuals_m.len() as f64, "one a satellite");
            return Err(Unavailable::Invalid { field: "residual_m", value, unit: "1", domain });
        }
        if let Some(bad) = residuals_m.iter().find(|r| !r.is_finite()) {
            return Err(Unavailable::Invalid { field: "residual_m", value: *bad, unit: "m", domain: "finite" });
        }
        let levels = self.levels_of(sights, residuals_m)?;
        let (square, fall, suspect) = self.residuals();
        let redundancy = levels.detail.redundancy;
        let ratio = if redundancy > 0 { sqrt(square) / self.factors(redundancy).threshold } else { 0.0 };
        let step = self.step();
        let all = Monitored { decision: Decision::Nothing, levels, step, excluded: None, ratio };
        if ratio <= 1.0 {
            return Ok(all);
        }
        let failed = Monitored { decision: Decision::NotExcluded, ..all };
        if redundancy < 2 {
            return Ok(failed);
        }
        let threshold = self.factors(redundancy - 1).threshold;
        if square - fall > threshold * threshold {
            return Ok(failed);
        }
        let mut rest = [sights[0]; super::MOST_SATELLITES];
        let mut rest_m = [0.0; super::MOST_SATELLITES];
        for (k, i) in (0..sights.len()).filter(|i| *i != suspect).enumerate() {
            (rest[k], rest_m[k]) = (sights[i], residuals_m[i]);
        }
        let left = sights.len() - 1;
        let Ok(levels) = self.levels_of(&rest[..left], &rest_m[..left]) else { return Ok(failed) };
        Ok(Monitored { decision: Decision::Excluded, levels, step: self.step(), excluded: Some(suspect), ratio })
    }

    /// Weighted sum of squared residuals, the largest fall of it by leaving out one satellite, and which.
    fn residuals(&self) -> (f64, f64, usize) {
        let (epoch, step) = (&self.epoch, self.movement());
        let (mut square, mut most, mut suspect) = (0.0, 0.0, 0);
        for (i, row) in epoch.rows[..epoch.count].iter().enumerate() {
            let residual = row.residual + row.unit.dot(&step) - epoch.normal.clock(row.clock, &step);
            let weighted = row.weight * residual;
            square += weighted * residual;
            // A range that nothing else checks leaves no residual to judge it by.
            let fall = if epoch.left[i] > ESSENTIAL * row.weight { weighted * weighted / epoch.left[i] } else { 0.0 };
            if fall > most {
                (most, suspect) = (fall, i);
            }
        }
        (square, most, suspect)
    }

    fn movement(&self) -> Vector3<f64> {
        // The geometry was refused unless it determines the position.
        self.epoch.normal.step().unwrap_or_default()
    }

    fn step(&self) -> [Metres; 3] {
        let step = self.movement();
        [step.x, step.y, step.z].map(Metres::new)
    }
}
