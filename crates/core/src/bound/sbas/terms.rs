//! Levels from error-model terms given one by one, without messages: what a table of terms or a simulated service offers.

use super::ionosphere::four;
use super::model::{
    Airborne, Corrected, Elevation, RangeError, fast_degradation_m, give_variance_m2, grid_degradation_m, grid_variance_m2,
    obliquity_squared, udre_variance_m2,
};
use crate::geometry::Direction;
use crate::quantity::{OutOfDomain, Radians};
use crate::signal::Constellation;
use crate::solution::wls::WeightedSight;
use crate::special::float::{cos, sin, sqrt};

/// Every term of one range's error model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RangeTerms {
    /// Azimuth, clockwise from true north.
    pub azimuth: Radians,
    /// Elevation.
    pub elevation: Radians,
    /// UDRE indicator.
    pub udrei: u8,
    /// Factor of the UDRE.
    pub delta_udre: f64,
    /// a of the fast correction \[m/s²\], its age \[s\] and the system latency \[s\].
    pub fast: [f64; 3],
    /// e_rrc, e_ltc, e_er \[m\].
    pub degradation_m: [f64; 3],
    /// RSS_UDRE.
    pub rss_udre: bool,
    /// Place of the pierce point in its cell, from the south-west corner.
    pub cell: [f64; 2],
    /// GIVE indicators: north-east, north-west, south-west, south-east.
    pub givei: [u8; 4],
    /// C_iono_step \[m\], I_iono \[s\], C_iono_ramp \[m/s\], age \[s\].
    pub grid: [f64; 4],
    /// RSS_iono.
    pub rss_iono: bool,
    /// The receiver.
    pub airborne: Airborne,
}

/// What the terms of one range give.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RangeSigmas {
    /// e_fc \[m\].
    pub fast_degradation_m: f64,
    /// e_iono \[m\].
    pub grid_degradation_m: f64,
    /// Vertical ionosphere \[m\].
    pub vertical_m: f64,
    /// F_pp.
    pub obliquity: f64,
    /// The four parts.
    pub error: RangeError,
    /// For the normal equation.
    pub row: WeightedSight,
}

impl RangeTerms {
    /// The error of this range.
    ///
    /// # Errors
    /// [`OutOfDomain`] for an indicator that forbids use, a pierce point outside its cell, a factor below one, an elevation below the
    /// horizon, or a term that is negative or not finite.
    pub fn sigmas(&self) -> Result<RangeSigmas, OutOfDomain> {
        let direction = Direction::new(self.azimuth, self.elevation)?;
        let el = self.elevation.rad();
        within("el_rad", el, "rad", el >= 0.0, "[0, pi/2]")?;
        let udre_m2 = udre_variance_m2(self.udrei);
        let udre_m2 = udre_m2.ok_or_else(|| refusal("udrei", f64::from(self.udrei), "1", "0 to 13"))?;
        within("delta_udre", self.delta_udre, "1", self.delta_udre >= 1.0 && self.delta_udre.is_finite(), "[1, inf)")?;
        for (name, value, unit) in self.lengths() {
            within(name, value, unit, value >= 0.0 && value.is_finite(), "[0, inf)")?;
        }
        let [x, y] = self.cell;
        within("x_pp", x, "1", (0.0..=1.0).contains(&x), "[0, 1]")?;
        within("y_pp", y, "1", (0.0..=1.0).contains(&y), "[0, 1]")?;
        let [factor, age, latency] = self.fast;
        let [rrc, ltc, er] = self.degradation_m;
        let fc = fast_degradation_m(factor, age, latency);
        let corrected = Corrected { udre_m: sqrt(udre_m2), degradation_m: Some([fc, rrc, ltc, er]), rss: self.rss_udre };
        let [step, interval, ramp, grid_age] = self.grid;
        let aged = grid_degradation_m(step, interval, ramp, grid_age);
        let mut vertical_m2 = 0.0;
        for (givei, weight) in self.givei.iter().zip(four(x, y)) {
            let give_m2 = give_variance_m2(*givei).ok_or_else(|| refusal("givei", f64::from(*givei), "1", "0 to 14"))?;
            vertical_m2 += weight * grid_variance_m2(give_m2, aged, self.rss_iono);
        }
        let [elevation] = Elevation::abreast(&[sin(el)], &[cos(el)]);
        let error = RangeError::new(corrected.variance_m2(self.delta_udre), vertical_m2, &elevation, &self.airborne);
        Ok(RangeSigmas {
            fast_degradation_m: fc,
            grid_degradation_m: aged,
            vertical_m: sqrt(vertical_m2),
            obliquity: sqrt(obliquity_squared(cos(el) * cos(el))),
            error,
            row: WeightedSight { unit: direction.unit(), weight: 1.0 / error.variance_m2(), constellation: Constellation::Gps },
        })
    }

    fn lengths(&self) -> [(&'static str, f64, &'static str); 10] {
        let [factor, age, latency] = self.fast;
        let [rrc, ltc, er] = self.degradation_m;
        let [step, interval, ramp, grid_age] = self.grid;
        [
            ("fast_mps2", factor, "m/s²"),
            ("fast_age_s", age, "s"),
            ("latency_s", latency, "s"),
            ("e_rrc_m", rrc, "m"),
            ("e_ltc_m", ltc, "m"),
            ("e_er_m", er, "m"),
            ("iono_step_m", step, "m"),
            ("iono_interval_s", interval, "s"),
            ("iono_ramp_mps", ramp, "m/s"),
            ("iono_age_s", grid_age, "s"),
        ]
    }
}

fn refusal(argument: &'static str, value: f64, unit: &'static str, domain: &'static str) -> OutOfDomain {
    OutOfDomain { argument, value, unit, domain }
}

fn within(argument: &'static str, value: f64, unit: &'static str, good: bool, domain: &'static str) -> Result<(), OutOfDomain> {
    if good { Ok(()) } else { Err(refusal(argument, value, unit, domain)) }
}
