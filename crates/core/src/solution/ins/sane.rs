//! Whether a measurement is made of numbers that mean something.

use super::settings::positive;
use super::state::finite;
use crate::frame::Geodetic;
use crate::quantity::OutOfDomain;
use crate::signal::{Aiding, PositionFix, SatelliteRange};

/// # Errors
/// [`OutOfDomain`] naming the first number that is not finite, or the first deviation that is not positive.
pub(super) fn check(aiding: &Aiding) -> Result<(), OutOfDomain> {
    match aiding {
        Aiding::Satellite(m) => satellite(m),
        Aiding::Dme(m) => {
            m.position.vector().iter().try_for_each(|x| finite("position_ecef_m", *x, "m"))?;
            positive("slant_m", m.slant.m(), "m")?;
            deviations(m.sigma_white.m(), m.sigma_bias.m(), "m")
        }
        Aiding::Vor(m) => {
            finite("bearing_rad", m.bearing.rad(), "rad")?;
            finite("h_m", m.position.height.m(), "m")?;
            deviations(m.sigma_white.rad(), m.sigma_bias.rad(), "rad")
        }
        Aiding::Baro(m) => {
            finite("height_m", m.height.m(), "m")?;
            positive("correlation_time_s", m.correlation_time_s, "s")?;
            deviations(m.sigma_white.m(), m.sigma_bias.m(), "m")
        }
        Aiding::Fix(m) => fix(m),
    }
}

fn satellite(m: &SatelliteRange) -> Result<(), OutOfDomain> {
    m.position.vector().iter().try_for_each(|x| finite("position_ecef_m", *x, "m"))?;
    if let Some(range) = m.range {
        finite("range_m", range.m(), "m")?;
        positive("correlation_time_s", m.correlation_time_s, "s")?;
        deviations(m.sigma_white.m(), m.sigma_correlated.m(), "m")?;
        deviations(m.sigma_white.m(), m.sigma_first.m(), "m")?;
    } else if m.rate_mps.is_none() {
        return Err(OutOfDomain { argument: "range_m", value: f64::NAN, unit: "m", domain: "a range, or its rate" });
    }
    let Some((rate, sigma)) = m.rate_mps else { return Ok(()) };
    m.velocity_mps.iter().try_for_each(|x| finite("velocity_ecef_mps", *x, "m/s"))?;
    finite("rate_mps", rate, "m/s")?;
    positive("sigma_rate_mps", sigma, "m/s")
}

fn fix(m: &PositionFix) -> Result<(), OutOfDomain> {
    let Geodetic { height, .. } = m.position;
    finite("h_m", height.m(), "m")?;
    (0..3).try_for_each(|k| positive("covariance_enu_m2", m.covariance.matrix()[(k, k)], "m²"))?;
    let Some((velocity, r)) = &m.velocity_ned_mps else { return Ok(()) };
    velocity.iter().try_for_each(|x| finite("velocity_ned_mps", *x, "m/s"))?;
    (0..3).try_for_each(|k| positive("velocity_covariance_m2ps2", r[(k, k)], "m²/s²"))
}

fn deviations(white: f64, slow: f64, unit: &'static str) -> Result<(), OutOfDomain> {
    positive("sigma_white", white, unit)?;
    if !(slow >= 0.0 && slow.is_finite()) {
        return Err(OutOfDomain { argument: "sigma_slow", value: slow, unit, domain: "[0, inf)" });
    }
    Ok(())
}
