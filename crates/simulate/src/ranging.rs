//! How good a range is: standard deviation by elevation.
//!
//! ```text
//! sigma^2 = ranging^2 + (F ionosphere)^2 + (m troposphere)^2 + noise^2 + (share * multipath)^2
//! F = 1 / sqrt(1 - (Re cos el / (Re + 350 km))^2)       obliquity of the ionosphere
//! m = 1.001 / sqrt(0.002001 + sin^2 el)                 mapping of the troposphere
//! multipath = 0.13 + 0.53 exp(-el / 10 deg) \[m\]         airborne model
//! ```
//!
//! F, m and the multipath model are those of the DO-229 family (inferred: the text was not read; check before operational use). The zenith values
//! come from the scenario.

use crate::scenario::Navigation;
use navbound_core::quantity::{Metres, Radians};

const EARTH_RADIUS_M: f64 = 6_378_136.3;
const SHELL_HEIGHT_M: f64 = 350_000.0;

/// What the ionosphere leaves at an elevation, from the same at the zenith \[m\].
pub(crate) fn ionosphere_m(zenith_m: f64, elevation: Radians) -> f64 {
    let shell = EARTH_RADIUS_M * elevation.rad().cos() / (EARTH_RADIUS_M + SHELL_HEIGHT_M);
    zenith_m / (1.0 - shell * shell).sqrt()
}

/// What the troposphere leaves, likewise \[m\].
pub(crate) fn troposphere_m(zenith_m: f64, elevation: Radians) -> f64 {
    let sin = elevation.rad().sin();
    zenith_m * 1.001 / (0.002_001 + sin * sin).sqrt()
}

/// Airborne multipath model \[m\].
pub(crate) fn multipath_m(elevation: Radians) -> f64 {
    0.13 + 0.53 * (-elevation.rad() / 10.0_f64.to_radians()).exp()
}

/// Standard deviation of a range at an elevation.
pub(crate) fn sigma(n: &Navigation, elevation: Radians) -> Metres {
    let ionosphere = ionosphere_m(n.ionosphere_sigma_m, elevation);
    let troposphere = troposphere_m(n.troposphere_sigma_m, elevation);
    let multipath = n.multipath_share * multipath_m(elevation);
    let parts = [n.ranging_sigma_m, ionosphere, troposphere, n.noise_sigma_m, multipath];
    Metres::new(parts.iter().map(|s| s * s).sum::<f64>().sqrt())
}
