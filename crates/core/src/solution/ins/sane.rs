//! Whether a measurement is made of numbers that a sensor can deliver.
//!
//! The limits are wide: they are not there to judge a measurement, but so that no number of a single one can ruin the arithmetic of the
//! filter (a deviation of 1e300 m squares to infinity, a variance of 1e-30 m² leaves states without any). Provenance: inferred.

use super::settings::positive;
use super::state::finite;
use crate::frame::Geodetic;
use crate::quantity::OutOfDomain;
use crate::signal::{Aiding, PositionFix, SatelliteRange};
use nalgebra::Matrix3;

/// # Errors
/// [`OutOfDomain`] naming the first number that is not finite, or outside what a sensor can deliver.
pub(super) fn check(aiding: &Aiding) -> Result<(), OutOfDomain> {
    match aiding {
        Aiding::Satellite(m) => satellite(m),
        Aiding::Dme(m) => {
            m.position.vector().iter().try_for_each(|x| finite("position_ecef_m", *x, "m"))?;
            inside("slant_m", m.slant.m(), "m", 1e-3, 1e6, "[0.001, 1e6]")?;
            lengths(m.sigma_white.m(), m.sigma_bias.m())
        }
        Aiding::Vor(m) => {
            finite("bearing_rad", m.bearing.rad(), "rad")?;
            inside("h_m", m.position.height.m(), "m", -1e4, 1e5, "[-1e4, 1e5]")?;
            inside("sigma_white_rad", m.sigma_white.rad(), "rad", 1e-6, 3.2, "[1e-6, 3.2]")?;
            inside("sigma_bias_rad", m.sigma_bias.rad(), "rad", 0.0, 3.2, "[0, 3.2]")
        }
        Aiding::Baro(m) => {
            inside("height_m", m.height.m(), "m", -1e4, 1e5, "[-1e4, 1e5]")?;
            positive("correlation_time_s", m.correlation_time_s, "s")?;
            lengths(m.sigma_white.m(), m.sigma_bias.m())
        }
        Aiding::Fix(m) => fix(m),
    }
}

fn satellite(m: &SatelliteRange) -> Result<(), OutOfDomain> {
    m.position.vector().iter().try_for_each(|x| finite("position_ecef_m", *x, "m"))?;
    if let Some(range) = m.range {
        // From low orbits to geostationary ones, and a receiver's clock of a tenth of a second.
        inside("range_m", range.m(), "m", -5e7, 1e8, "[-5e7, 1e8]")?;
        positive("correlation_time_s", m.correlation_time_s, "s")?;
        lengths(m.sigma_white.m(), m.sigma_correlated.m())?;
        lengths(m.sigma_white.m(), m.sigma_first.m())?;
    } else if m.rate_mps.is_none() {
        return Err(OutOfDomain { argument: "range_m", value: f64::NAN, unit: "m", domain: "a range, or its rate" });
    }
    let Some((rate, sigma)) = m.rate_mps else { return Ok(()) };
    m.velocity_mps.iter().try_for_each(|x| inside("velocity_ecef_mps", *x, "m/s", -1e5, 1e5, "[-1e5, 1e5]"))?;
    // The clock of a receiver may run fast by some millionths: 300 m/s each.
    inside("rate_mps", rate, "m/s", -1e5, 1e5, "[-1e5, 1e5]")?;
    inside("sigma_rate_mps", sigma, "m/s", 1e-5, 1e4, "[1e-5, 1e4]")
}

fn fix(m: &PositionFix) -> Result<(), OutOfDomain> {
    let Geodetic { height, .. } = m.position;
    inside("h_m", height.m(), "m", -1e4, 1e6, "[-1e4, 1e6]")?;
    variances("covariance_enu_m2", m.covariance.matrix(), "m²", [1e-8, 1e10], "variances [1e-8, 1e10] along every axis")?;
    let Some((velocity, r)) = &m.velocity_ned_mps else { return Ok(()) };
    velocity.iter().try_for_each(|x| inside("velocity_ned_mps", *x, "m/s", -1e5, 1e5, "[-1e5, 1e5]"))?;
    variances("velocity_covariance_m2ps2", r, "m²/s²", [1e-10, 1e8], "variances [1e-10, 1e8] along every axis")
}

/// Along the axes in which the components are independent: no smaller than what the arithmetic resolves beside the largest.
fn variances(
    argument: &'static str,
    r: &Matrix3<f64>,
    unit: &'static str,
    [low, high]: [f64; 2],
    domain: &'static str,
) -> Result<(), OutOfDomain> {
    r.iter().try_for_each(|x| inside(argument, *x, unit, -high, high, domain))?;
    let eigen = r.symmetric_eigenvalues();
    inside(argument, eigen.min(), unit, low.max(CONDITION * eigen.max()), high, domain)
}

/// Smallest share of the largest variance that another may be.
const CONDITION: f64 = 1e-10;

fn lengths(white: f64, slow: f64) -> Result<(), OutOfDomain> {
    inside("sigma_white_m", white, "m", 1e-4, 1e5, "[1e-4, 1e5]")?;
    inside("sigma_slow_m", slow, "m", 0.0, 1e6, "[0, 1e6]")
}

fn inside(argument: &'static str, value: f64, unit: &'static str, low: f64, high: f64, domain: &'static str) -> Result<(), OutOfDomain> {
    if !(value >= low && value <= high) {
        return Err(OutOfDomain { argument, value, unit, domain });
    }
    Ok(())
}
