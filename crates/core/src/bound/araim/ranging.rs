//! How wrong one range may be for a user of two frequencies, or of one.

use crate::quantity::{Metres, Provenance};
use crate::special::float::{exp, sqrt};

/// Airborne receiver, multipath and what the atmosphere leaves, against the elevation.
///
/// ```text
/// sigma_air   = a + b exp(-E / e_0)
/// sigma_tropo = 0.12 m * 1.001 / sqrt(0.002001 + sin^2 E)
/// sigma_iono  = v F(E)                    F(E) = [1 - (R cos E / (R + h))^2]^-1/2,  R = 6378.1363 km, h = 350 km
/// sigma^2     = sigma_signal^2 + sigma_tropo^2 + sigma_air^2 + sigma_iono^2
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Airborne {
    /// Name, as users choose it.
    pub id: &'static str,
    /// Where the numbers come from.
    pub source: &'static str,
    /// How we hold them.
    pub provenance: Provenance,
    /// a \[m\], b \[m\], e_0 \[rad\].
    pub noise: [f64; 3],
    /// Standard deviation of the vertical ionospheric delay that is left.
    pub vertical_ionosphere: Metres,
}

/// Troposphere overhead, and the terms of its mapping: DO-229 A.4.2.4 (standard).
const ZENITH_TROPOSPHERE_M: f64 = 0.12;
/// Earth radius against the shell of the ionosphere: DO-229 A.4.4.10.4 (standard).
const SHELL: f64 = 6378.1363 / (6378.1363 + 350.0);

/// Code noise overhead of one pseudorange that nothing has smoothed \[m\]; provenance *inferred*: that of the weights of positions,
/// docs/methods/gnss-positions.md.
const CODE_NOISE_M: f64 = 0.13;

/// What a range has beyond the smoothed range of the model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beyond {
    /// Standard deviation of the code noise without memory that smoothing has left, against one pseudorange as measured: of a pair
    /// that nothing smoothed the root of the sum of the squares of its factors, 0 for a smoothed range.
    pub noise_factor: f64,
    /// Standard deviation of a constant of satellite and receiver that the broadcast clock does not cover.
    pub code_bias: Metres,
}

impl Beyond {
    /// Nothing: a smoothed range of the clock's own signals.
    pub const NOTHING: Self = Self { noise_factor: 0.0, code_bias: Metres::new(0.0) };

    /// Its variance \[m²\].
    ///
    /// ```text
    /// sigma^2 = (0.13 m noise_factor)^2 (1/2 + 1/(2 sin^2 E)) + code_bias^2
    /// ```
    #[inline(always)]
    pub fn variance_m2(&self, sin_elevation: f64) -> f64 {
        let (noise, bias) = (CODE_NOISE_M * self.noise_factor, self.code_bias.m());
        noise * noise * (0.5 + 0.5 / (sin_elevation * sin_elevation)) + bias * bias
    }
}

impl Airborne {
    /// Ionosphere-free pair of L1 and L5, E1 and E5a.
    pub const DUAL_FREQUENCY: Self = Self {
        id: "dual-frequency",
        source: "ED-259A airborne model of the ionosphere-free pair, 0.34 + 0.40 exp(-E/14 deg) m; troposphere DO-229 A.4.2.4",
        provenance: Provenance::Standard,
        noise: [0.34, 0.40, 14.0_f64.to_radians()],
        vertical_ionosphere: Metres::new(0.0),
    };

    /// L1 and E1 alone, broadcast ionosphere corrected. The vertical residual is a figure of ours for a quiet mid-latitude day: DO-229 J.2.3
    /// allows up to 9 m near the geomagnetic equator.
    pub const SINGLE_FREQUENCY: Self = Self {
        id: "single-frequency",
        source: "ED-259A airborne model of L1 and E1, 0.13 + 0.17 exp(-E/13 deg) m (standard); 1.5 m of vertical ionosphere left",
        provenance: Provenance::Inferred,
        noise: [0.13, 0.17, 13.0_f64.to_radians()],
        vertical_ionosphere: Metres::new(1.5),
    };

    /// The shipped ones.
    pub const ALL: [Self; 2] = [Self::DUAL_FREQUENCY, Self::SINGLE_FREQUENCY];

    /// Variance of everything but orbit and clock, at an elevation and its sine \[m²\].
    #[inline(always)]
    pub fn variance_m2(&self, elevation_rad: f64, sin_elevation: f64) -> f64 {
        let [a, b, scale] = self.noise;
        let air = a + b * exp(-elevation_rad / scale);
        let sin2 = sin_elevation * sin_elevation;
        let troposphere = ZENITH_TROPOSPHERE_M * 1.001 / sqrt(0.002_001 + sin2);
        let vertical = self.vertical_ionosphere.m();
        let ionosphere2 = vertical * vertical / (1.0 - SHELL * SHELL * (1.0 - sin2));
        air * air + troposphere * troposphere + ionosphere2
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: at the zenith the exponentials are exp(-90/14) = 0.001615 and exp(-90/13) = 0.000985, the mapping of both layers one.
    #[test]
    fn overhead_the_terms_are_those_of_the_table() {
        let zenith = core::f64::consts::FRAC_PI_2;
        let dual = 0.340_646_f64.powi(2) + 0.12_f64.powi(2);
        assert!((Airborne::DUAL_FREQUENCY.variance_m2(zenith, 1.0) - dual).abs() < 2e-5);
        let single = 0.130_167_f64.powi(2) + 0.12_f64.powi(2) + 1.5 * 1.5;
        assert!((Airborne::SINGLE_FREQUENCY.variance_m2(zenith, 1.0) - single).abs() < 2e-5);
    }

    /// By hand: at 30 deg the mapping is 1/2 + 1/(2 * 0.25) = 2.5.
    #[test]
    fn what_is_beyond_the_model_adds_to_it() {
        let beyond = Beyond { noise_factor: 2.0, code_bias: Metres::new(1.0) };
        assert!((beyond.variance_m2(0.5) - (0.26 * 0.26 * 2.5 + 1.0)).abs() < 1e-12);
        assert_eq!(Beyond::NOTHING.variance_m2(0.5), 0.0);
    }

    #[test]
    fn low_satellites_are_worse() {
        for model in Airborne::ALL {
            let at = |deg: f64| model.variance_m2(deg.to_radians(), deg.to_radians().sin());
            assert!(at(5.0) > at(15.0) && at(15.0) > at(60.0) && at(5.0).is_finite());
        }
    }
}
