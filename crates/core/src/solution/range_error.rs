//! How wrong a corrected pseudorange may be: the weights of a position, and so its covariance.

use super::common::CommonErrors;
use crate::signal::Constellation;
use crate::special::float::exp;

/// Standard deviation of a single-frequency pseudorange corrected by broadcast data.
///
/// ```text
/// sigma^2 = ure_c^2 + (share * iono)^2 + (uneven * k F)^2 + (zenith_tropo * m(E))^2 + f^2 noise_c^2 (1/2 + 1/(2 sin^2 E)) * c(C/N0)
/// c       = 10^((reference - C/N0) / 10) where the signal is weaker than the reference, 1 elsewhere
/// ```
///
/// Errors of the atmosphere that all ranges have in common do not enter here but the position's covariance and the residual test, see
/// [`CommonErrors`]; `uneven` is what they leave to single satellites, `k F` the ionosphere's carrier factor and obliquity.
///
/// `f` is the noise of the combination against that of one pseudorange (1, or that of the ionosphere-free pair). The form is ours, of
/// the terms that DO-229 appendix J and the usual engines add; how the numbers were found stands in `docs/methods/gnss-positions.md`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RangeError {
    /// Name for run records.
    pub name: &'static str,
    /// Orbit and clock, by constellation \[m\].
    pub ure_m: [f64; Constellation::ALL.len()],
    /// Orbit and clock of an ionosphere-free pair \[m\]: what group delays and inter-signal biases leave is magnified in it. Inferred.
    pub pair_ure_m: [f64; Constellation::ALL.len()],
    /// Receiver noise and multipath overhead, by constellation \[m\].
    pub noise_m: [f64; Constellation::ALL.len()],
    /// Share of the ionospheric delay that the model leaves, from satellite to satellite.
    pub ionosphere_share: f64,
    /// Least error of the ionospheric model overhead \[m\].
    pub ionosphere_floor_m: f64,
    /// Error of the zenith tropospheric delay \[m\].
    pub zenith_troposphere_m: f64,
    /// Factor on the standard deviation of an ionosphere-free pair, by constellation: the second frequency of GPS is tracked without its
    /// code by most receivers, those of 1999 to 2006 above all. Inferred.
    pub pair_factor: [f64; Constellation::ALL.len()],
    /// Errors that all ranges have in common.
    pub common: CommonErrors,
    /// Carrier-to-noise density from which noise no longer falls \[dB-Hz\].
    pub reference_cn0_dbhz: f64,
}

/// What the error of one range depends on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct RangeConditions {
    pub(super) constellation: usize,
    pub(super) sin_elevation: f64,
    /// Modelled ionospheric delay, and its mapping from overhead; both on this range's carrier \[m\] and zero for an ionosphere-free pair.
    pub(super) ionosphere_m: f64,
    pub(super) ionosphere_mapping: f64,
    /// What the ionosphere's common errors leave to this satellite, overhead and on L1 \[m\].
    pub(super) uneven_m: f64,
    pub(super) troposphere_mapping: f64,
    /// NaN where the receiver gives none: no allowance is made.
    pub(super) cn0_dbhz: f64,
    pub(super) noise_factor: f64,
    /// Multiplies the orbit and clock error: a satellite that states a worse accuracy than nominal.
    pub(super) ure_factor: f64,
}

impl RangeError {
    /// The default: calibrated, see `docs/methods/gnss-positions.md`.
    pub const CALIBRATED: Self = Self {
        name: "calibrated-2020",
        ure_m: [0.9, 3.0, 0.2, 0.6, 5.0],
        pair_ure_m: [0.9, 3.0, 0.2, 1.5, 5.0],
        noise_m: [0.13, 0.8, 0.13, 0.13, 0.8],
        ionosphere_share: 0.06,
        ionosphere_floor_m: 0.05,
        zenith_troposphere_m: 0.04,
        pair_factor: [1.6, 1.3, 1.3, 1.3, 1.3],
        common: CommonErrors::CALIBRATED,
        reference_cn0_dbhz: 40.0,
    };

    /// With tabulated orbits and clocks of satellites' mass centres. Offsets of their antennas, which are not applied, differ by a metre
    /// from one GPS satellite to the next and by decimetres among Galileo's; tracking codes differ from those of the clocks by
    /// decimetres. Ours, looked at on ESBC 2020-177 only.
    pub const PRECISE: Self = Self {
        name: "mass centres, looked at on ESBC 2020",
        ure_m: [1.0, 3.0, 0.2, 1.0, 5.0],
        pair_ure_m: [1.0, 3.0, 0.2, 1.0, 5.0],
        ..Self::CALIBRATED
    };

    /// The same form with every standard deviation of single ranges times one factor, and that of the errors they share times another:
    /// what a calibration on other data finds.
    #[must_use]
    pub fn scaled(&self, range: f64, shared: f64) -> Self {
        let name = if range == 1.0 && shared == 1.0 { self.name } else { "scaled" };
        Self {
            name,
            ure_m: self.ure_m.map(|s| s * range),
            pair_ure_m: self.pair_ure_m.map(|s| s * range),
            noise_m: self.noise_m.map(|s| s * range),
            ionosphere_share: self.ionosphere_share * range,
            ionosphere_floor_m: self.ionosphere_floor_m * range,
            zenith_troposphere_m: self.zenith_troposphere_m * range,
            pair_factor: self.pair_factor,
            common: CommonErrors {
                factor: self.common.factor * shared,
                unevenness: self.common.unevenness * range,
                curvature: self.common.curvature * range,
                ..self.common
            },
            reference_cn0_dbhz: self.reference_cn0_dbhz,
        }
    }

    /// Variance of a range \[m²\].
    pub(super) fn variance(&self, at: &RangeConditions) -> f64 {
        let single = at.ionosphere_mapping > 0.0;
        let ure = if single { &self.ure_m } else { &self.pair_ure_m }[at.constellation] * at.ure_factor;
        let share = self.ionosphere_share * at.ionosphere_m;
        let floor = self.ionosphere_floor_m * at.ionosphere_mapping;
        let troposphere = self.zenith_troposphere_m * at.troposphere_mapping;
        let noise = self.noise_m[at.constellation] * at.noise_factor;
        let elevation = 0.5 + 0.5 / (at.sin_elevation * at.sin_elevation);
        let weakness = self.reference_cn0_dbhz - at.cn0_dbhz;
        let weak = if weakness > 0.0 { exp(weakness * (core::f64::consts::LN_10 / 10.0)) } else { 1.0 };
        let uneven = at.uneven_m * at.ionosphere_mapping;
        let pair = if single { 1.0 } else { self.pair_factor[at.constellation] };
        let atmosphere = share * share + floor * floor + uneven * uneven + troposphere * troposphere;
        pair * pair * (ure * ure + atmosphere + noise * noise * elevation * weak)
    }
}
