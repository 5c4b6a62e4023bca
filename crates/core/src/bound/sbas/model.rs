//! How wrong one corrected range may be: the terms of the error model, each as the standard has it.

pub(super) use crate::geometry::ionosphere::{EARTH_M, SHELL_M, obliquity_squared};
use crate::quantity::OutOfDomain;
use crate::signal::sbas::Degradation;
use crate::special::abreast::exp_of_negative;
use crate::special::angles::atan2;
use crate::special::float::sqrt;

/// Variances of the UDRE by indicator 0 to 13 \[m²\] (standard).
const UDRE_M2: [f64; 14] =
    [0.0520, 0.0924, 0.1444, 0.2830, 0.4678, 0.8315, 1.2992, 1.8709, 2.5465, 3.3260, 5.1968, 20.7870, 230.9661, 2078.695];
/// Variances of the GIVE by indicator 0 to 14 \[m²\] (standard).
const GIVE_M2: [f64; 15] =
    [0.0084, 0.0333, 0.0749, 0.1331, 0.2079, 0.2994, 0.4075, 0.5322, 0.6735, 0.8315, 1.1974, 1.8709, 3.3260, 20.787, 187.0826];
/// Added to the UDRE en route when the degradation is unknown \[m\] (standard).
const UNKNOWN_DEGRADATION_M: f64 = 8.0;
/// Vertical error of the tropospheric model \[m\] (standard).
const TROPOSPHERE_M: f64 = 0.12;

/// Variance of the UDRE \[m²\]; none for an indicator that forbids use.
pub fn udre_variance_m2(udrei: u8) -> Option<f64> {
    UDRE_M2.get(usize::from(udrei)).copied()
}

/// Variance of the GIVE \[m²\]; none for a point that is not monitored.
pub fn give_variance_m2(givei: u8) -> Option<f64> {
    GIVE_M2.get(usize::from(givei)).copied()
}

/// Fast correction grown old \[m\].
///
/// ```text
/// e_fc = a (t - t_u + t_lat)^2 / 2
/// ```
pub fn fast_degradation_m(factor_mps2: f64, age_s: f64, latency_s: f64) -> f64 {
    let since = age_s + latency_s;
    0.5 * factor_mps2 * since * since
}

/// What is left after fast and long-term correction, with its growth since (`flt`).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Corrected {
    /// Standard deviation of the UDRE \[m\].
    pub udre_m: f64,
    /// Degradations e_fc, e_rrc, e_ltc, e_er \[m\]; none when the degradation is unknown (en route only).
    pub degradation_m: Option<[f64; 4]>,
    /// Added as squares.
    pub rss: bool,
}

impl Corrected {
    /// Variance for a factor of the UDRE \[m²\].
    ///
    /// ```text
    /// flt^2 = (sigma_UDRE dUDRE + e_fc + e_rrc + e_ltc + e_er)^2            RSS_UDRE = 0
    ///       = (sigma_UDRE dUDRE)^2 + e_fc^2 + e_rrc^2 + e_ltc^2 + e_er^2    RSS_UDRE = 1
    ///       = (sigma_UDRE dUDRE + 8 m)^2                                    degradation unknown
    /// ```
    pub fn variance_m2(&self, delta_udre: f64) -> f64 {
        let udre = self.udre_m * delta_udre;
        match self.degradation_m {
            None => square(udre + UNKNOWN_DEGRADATION_M),
            Some(terms) if self.rss => udre * udre + terms.iter().map(|e| e * e).sum::<f64>(),
            Some(terms) => square(udre + terms.iter().sum::<f64>()),
        }
    }
}

/// Grid value grown old \[m\].
///
/// ```text
/// e_iono = C_step floor((t - t_iono) / I) + C_ramp (t - t_iono)
/// ```
///
/// # Deviation from the source
/// An interval of zero is sent by nobody and would divide by zero: it is read as one second, the fastest growth (ours).
pub fn grid_degradation_m(step_m: f64, interval_s: f64, ramp_mps: f64, age_s: f64) -> f64 {
    step_m * steps(age_s, interval_s) + ramp_mps * age_s
}

/// Whole intervals in a positive age.
pub(super) fn steps(age_s: f64, interval_s: f64) -> f64 {
    let interval = if interval_s > 0.0 { interval_s } else { 1.0 };
    // Ages are below a day: the whole part fits an integer, and needs no function of the platform.
    ((age_s / interval) as i64) as f64
}

/// Variance at a grid point \[m²\].
///
/// ```text
/// (sigma_GIVE + e_iono)^2  RSS_iono = 0        sigma_GIVE^2 + e_iono^2  RSS_iono = 1
/// ```
pub fn grid_variance_m2(give_m2: f64, degradation_m: f64, rss: bool) -> f64 {
    if rss { give_m2 + degradation_m * degradation_m } else { square(sqrt(give_m2) + degradation_m) }
}

/// The grid's part of message 10 for a point of a known age.
pub(super) fn aged_grid_m2(give_m2: f64, age_s: f64, degradation: Option<&Degradation>) -> f64 {
    degradation
        .map_or(give_m2, |d| grid_variance_m2(give_m2, grid_degradation_m(d.iono_step_m, d.iono_s, d.iono_ramp_mps, age_s), d.rss_iono))
}

/// Variance of the slant delay by the broadcast model, for en route users whom the grid does not serve \[m²\].
///
/// ```text
/// max((T_iono / 5)^2, (F_pp tau_vert)^2)     tau_vert = 9 m to 20, 4.5 m to 55, 6 m beyond 55 degrees of geomagnetic latitude
/// ```
///
/// RTCA DO-229D J.2.3 (inferred: the text was not read).
pub fn broadcast_ionosphere_m2(slant_m: f64, obliquity_squared: f64, magnetic_lat_rad: f64) -> f64 {
    let latitude = magnetic_lat_rad.abs().to_degrees();
    let vertical_m = if latitude <= 20.0 {
        9.0
    } else if latitude <= 55.0 {
        4.5
    } else {
        6.0
    };
    square(slant_m / 5.0).max(obliquity_squared * square(vertical_m))
}

/// Variance of the tropospheric model \[m²\].
///
/// ```text
/// sigma = 0.12 m,   m = 1.001 / sqrt(0.002001 + sin^2 E),   times 1 + 0.015 (4 - E)^2 below 4 degrees
/// ```
pub fn troposphere_m2(elevation: &Elevation) -> f64 {
    let vertical = TROPOSPHERE_M * 1.001;
    let slant = vertical * vertical / (0.002_001 + elevation.sin * elevation.sin);
    let below = 4.0 - elevation.rad.to_degrees();
    if below > 0.0 { slant * square(1.0 + 0.015 * below * below) } else { slant }
}

/// The receiver aboard.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Airborne {
    noise_m: f64,
    divergence_m: f64,
}

impl Airborne {
    /// Airborne accuracy designator A at minimum signal power: noise 0.36 m, the largest of the classes that smooth (standard).
    pub const ACCURACY_A: Self = Self { noise_m: 0.36, divergence_m: 0.0 };

    /// Noise and code-carrier divergence of a receiver \[m\].
    ///
    /// # Errors
    /// [`OutOfDomain`] unless both are finite and not negative.
    pub fn new(noise_m: f64, divergence_m: f64) -> Result<Self, OutOfDomain> {
        for (argument, value) in [("noise_m", noise_m), ("divergence_m", divergence_m)] {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(OutOfDomain { argument, value, unit: "m", domain: "[0, inf)" });
            }
        }
        Ok(Self { noise_m, divergence_m })
    }
    /// Variance with multipath \[m²\].
    ///
    /// ```text
    /// air^2 = noise^2 + divergence^2 + (0.13 + 0.53 exp(-E / 10 deg))^2
    /// ```
    pub fn variance_m2(&self, elevation: &Elevation) -> f64 {
        let multipath = 0.13 + 0.53 * elevation.decay;
        square(self.noise_m) + square(self.divergence_m) + square(multipath)
    }
}

/// An elevation as the model needs it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Elevation {
    /// \[rad\].
    pub rad: f64,
    /// Its sine.
    pub sin: f64,
    /// exp(-E / 10 degrees).
    pub decay: f64,
}

impl Elevation {
    /// Several from their sines and cosines \[rad\].
    #[inline(always)]
    pub fn abreast<const L: usize>(sin: &[f64; L], cos: &[f64; L]) -> [Self; L] {
        let rad = atan2(sin, cos);
        // Below the horizon, where no mask lets a satellite count, the argument is positive and as good.
        let decay = rad.map(|e| exp_of_negative(-e.to_degrees() / 10.0));
        core::array::from_fn(|l| Self { rad: rad[l], sin: sin[l], decay: decay[l] })
    }
}

/// Variances of one range, term by term: roots are taken by who shows them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RangeError {
    /// After fast and long-term correction \[m²\].
    pub corrected_m2: f64,
    /// Slant ionosphere \[m²\].
    pub ionosphere_m2: f64,
    /// Troposphere \[m²\].
    pub troposphere_m2: f64,
    /// Receiver and multipath \[m²\].
    pub airborne_m2: f64,
}

impl RangeError {
    /// The terms of a range.
    pub fn new(corrected_m2: f64, vertical_ionosphere_m2: f64, elevation: &Elevation, airborne: &Airborne) -> Self {
        Self {
            corrected_m2,
            ionosphere_m2: obliquity_squared(1.0 - elevation.sin * elevation.sin) * vertical_ionosphere_m2,
            troposphere_m2: troposphere_m2(elevation),
            airborne_m2: airborne.variance_m2(elevation),
        }
    }
    /// Their sum \[m²\].
    pub fn variance_m2(&self) -> f64 {
        self.corrected_m2 + self.ionosphere_m2 + self.troposphere_m2 + self.airborne_m2
    }
}

fn square(x: f64) -> f64 {
    x * x
}
