//! Whether an altimeter's setting fits the geometric height: the difference at the ground, with its power.
//!
//! The difference geometric less indicated height grows with the height above the aerodrome by the temperature of the air; what it is at the
//! ground is a wrong setting, or a wrong geometric height. Provenance: re-derived.

use crate::quantity::{Metres, OutOfDomain, Risk};
use crate::special::float::sqrt;
use crate::special::normal::{density, tail, two_sided_factor};

/// The line through differences of height.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SettingLine {
    /// Points of it.
    pub n: usize,
    /// Difference at the ground.
    pub intercept: Metres,
    /// Its growth with height: the deviation of the temperature by the temperature \[1\].
    pub slope: f64,
    /// Standard deviation of what is left, of n - 2 degrees of freedom.
    pub residual_sigma: Metres,
}

/// The line of least squares through `(height above the aerodrome, geometric less indicated height)` \[m\].
///
/// # Errors
/// [`OutOfDomain`] for a number that is not finite, fewer than three points, or heights that all are the same.
pub fn setting_line(points: impl Iterator<Item = (f64, f64)> + Clone) -> Result<SettingLine, OutOfDomain> {
    let (mut n, mut mean) = (0_usize, [0.0; 2]);
    for (x, y) in points.clone() {
        for (argument, value) in [("height_m", x), ("difference_m", y)] {
            if !value.is_finite() {
                return Err(OutOfDomain { argument, value, unit: "m", domain: "(-inf, inf)" });
            }
        }
        n += 1;
        mean[0] += (x - mean[0]) / n as f64;
        mean[1] += (y - mean[1]) / n as f64;
    }
    if n < 3 {
        return Err(OutOfDomain { argument: "height_m", value: n as f64, unit: "1", domain: "three points or more" });
    }
    let (mut xx, mut xy) = (0.0, 0.0);
    for (x, y) in points.clone() {
        xx += (x - mean[0]) * (x - mean[0]);
        xy += (x - mean[0]) * (y - mean[1]);
    }
    if !(xx > 0.0) {
        return Err(OutOfDomain { argument: "height_m", value: mean[0], unit: "m", domain: "two different heights or more" });
    }
    let slope = xy / xx;
    let intercept = mean[1] - slope * mean[0];
    let square: f64 = points.map(|(x, y)| (y - intercept - slope * x) * (y - intercept - slope * x)).sum();
    Ok(SettingLine { n, intercept: Metres::new(intercept), slope, residual_sigma: Metres::new(sqrt(square / (n - 2) as f64)) })
}

/// The test of a difference at the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SettingTest {
    sigma: Metres,
    factor: f64,
}

impl SettingTest {
    /// By the standard deviation of the difference where nothing is wrong, and the risk of a false alarm.
    ///
    /// # Errors
    /// [`OutOfDomain`] for a deviation outside (0, inf).
    pub fn new(sigma: Metres, false_alarm: Risk) -> Result<Self, OutOfDomain> {
        if !(sigma.m() > 0.0 && sigma.m().is_finite()) {
            return Err(OutOfDomain { argument: "sigma_m", value: sigma.m(), unit: "m", domain: "(0, inf)" });
        }
        Ok(Self { sigma, factor: two_sided_factor(false_alarm.q()) })
    }

    /// A larger difference is an alarm: K sigma.
    pub fn threshold(&self) -> Metres {
        Metres::new(self.factor * self.sigma.m())
    }

    /// Probability that an error of the setting of this size is an alarm: Q(K - d / sigma) + Q(K + d / sigma).
    pub fn power(&self, error: Metres) -> f64 {
        let d = error.m() / self.sigma.m();
        tail(self.factor - d) + tail(self.factor + d)
    }

    /// The smallest error that is an alarm with this probability.
    ///
    /// # Errors
    /// [`OutOfDomain`] for a probability outside \[0.5, 1).
    pub fn detectable(&self, power: f64) -> Result<Metres, OutOfDomain> {
        if !(0.5..1.0).contains(&power) {
            return Err(OutOfDomain { argument: "power", value: power, unit: "1", domain: "[0.5, 1)" });
        }
        // Without the far tail, then Newton's method with it: the missed part falls, so no step goes too far by more than the far tail.
        let mut d = self.factor + crate::special::normal::one_sided_factor(1.0 - power);
        for _ in 0..8 {
            let missed = tail(d - self.factor) - tail(d + self.factor);
            d += (missed - (1.0 - power)) / (density(d - self.factor) - density(d + self.factor));
        }
        Ok(Metres::new(d * self.sigma.m()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_without_noise_is_itself() {
        let points = [0.0, 300.0, 900.0, 1400.0].map(|x| (x, 12.0 - 0.03 * x));
        let line = setting_line(points.into_iter()).unwrap();
        assert!((line.intercept.m() - 12.0).abs() < 1e-12 && (line.slope + 0.03).abs() < 1e-15 && line.residual_sigma.m() < 1e-12);
        assert_eq!(line.n, 4);
        // By hand: (0, 1), (1, 0), (2, 2): slope 1/2, intercept 1/2, residuals 1/2, -1, 1/2.
        let line = setting_line([(0.0, 1.0), (1.0, 0.0), (2.0, 2.0)].into_iter()).unwrap();
        assert!((line.slope - 0.5).abs() < 1e-15 && (line.intercept.m() - 0.5).abs() < 1e-15);
        assert!((line.residual_sigma.m() - 1.5_f64.sqrt()).abs() < 1e-15);
    }

    #[test]
    fn what_makes_no_line_is_refused() {
        assert_eq!(setting_line([(1.0, f64::NAN)].into_iter()).unwrap_err().argument, "difference_m");
        assert_eq!(setting_line([(f64::INFINITY, 1.0)].into_iter()).unwrap_err().argument, "height_m");
        assert_eq!(setting_line([(5.0, 1.0), (5.0, 2.0), (5.0, 3.0)].into_iter()).unwrap_err().argument, "height_m");
        assert_eq!(setting_line([(5.0, 1.0), (6.0, 2.0)].into_iter()).unwrap_err().unit, "1");
        assert_eq!(setting_line(core::iter::empty()).unwrap_err().argument, "height_m");
    }

    #[test]
    fn the_power_is_the_risk_without_an_error_and_one_half_at_the_threshold() {
        let test = SettingTest::new(Metres::new(10.0), Risk::new(1e-3).unwrap()).unwrap();
        assert!((test.power(Metres::new(0.0)) - 1e-3).abs() < 1e-15);
        assert!((test.power(test.threshold()) - 0.5).abs() < 1e-10);
        assert_eq!(test.power(Metres::new(-50.0)), test.power(Metres::new(50.0)));
        for power in [0.5, 0.9, 0.999] {
            let d = test.detectable(power).unwrap();
            assert!((test.power(d) - power).abs() < 1e-12, "{power}");
        }
        // With a wide risk the far tail counts.
        let wide = SettingTest::new(Metres::new(10.0), Risk::new(0.4).unwrap()).unwrap();
        let d = wide.detectable(0.6).unwrap();
        assert!((wide.power(d) - 0.6).abs() < 1e-12);
        assert_eq!(test.detectable(1.0).unwrap_err().argument, "power");
        assert_eq!(SettingTest::new(Metres::new(0.0), Risk::ACCURACY).unwrap_err().argument, "sigma_m");
    }
}
