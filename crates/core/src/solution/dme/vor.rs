//! VOR/DME: how good a bearing and a range are, and where they put the aircraft.

use super::{Altitude, Fix, NoFix, Place, Sight};
use crate::frame::{Covariance, EcefPosition, Enu, Geodetic, geodetic_from_ecef};
use crate::quantity::{Metres, OutOfDomain, Radians};
use crate::special::float::{acos, asin, exp_m1, hypot, sin_cos};
use nalgebra::{Matrix3, Vector3};

/// Standard deviations of a VOR/DME position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VorDme {
    /// Along the radial.
    pub radial: Metres,
    /// Across the radial.
    pub cross: Metres,
    /// Root of the sum of their squares.
    pub drms: Metres,
}

/// Nearer than this the cone above a VOR gives no bearing.
const VOR_GROUND_LEAST: Metres = Metres::nautical_miles(3.0);
/// Nor above this elevation.
const VOR_ELEVATION_MOST: Radians = Radians::degrees(40.0);

/// VOR/DME at a ground and a slant distance; `None` overhead (below 3 NM or above 40 degrees).
///
/// ```text
/// radial = sigma_dme * slant / ground      cross = ground * sigma_vor
/// ```
///
/// # Errors
/// [`OutOfDomain`] unless `0 < ground <= slant` and both standard deviations are finite and not negative.
pub fn vor_dme(ground: Metres, slant: Metres, sigma_vor: Radians, sigma_dme: Metres) -> Result<Option<VorDme>, OutOfDomain> {
    let (g, s) = (ground.m(), slant.m());
    if !(g > 0.0 && g.is_finite()) {
        return Err(OutOfDomain { argument: "ground_m", value: g, unit: "m", domain: "(0, inf)" });
    }
    if !(s >= g && s.is_finite()) {
        return Err(OutOfDomain { argument: "slant_m", value: s, unit: "m", domain: "[ground_m, inf)" });
    }
    for (argument, value, unit) in [("sigma_vor_rad", sigma_vor.rad(), "rad"), ("sigma_dme_m", sigma_dme.m(), "m")] {
        if !(value >= 0.0 && value.is_finite()) {
            return Err(OutOfDomain { argument, value, unit, domain: "[0, inf)" });
        }
    }
    if !(g >= VOR_GROUND_LEAST.m() && acos(g / s) <= VOR_ELEVATION_MOST.rad()) {
        return Ok(None);
    }
    let (radial, cross) = (sigma_dme.m() * s / g, g * sigma_vor.rad());
    Ok(Some(VorDme { radial: Metres::new(radial), cross: Metres::new(cross), drms: Metres::new(hypot(radial, cross)) }))
}

/// A bearing and a slant range of one station.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VorRange {
    /// Measured slant range.
    pub slant: Metres,
    /// Its standard deviation.
    pub sigma: Metres,
    /// Bearing of the aircraft from the station, clockwise from true north.
    pub bearing: Radians,
    /// Its standard deviation.
    pub sigma_bearing: Radians,
}

impl VorDme {
    /// Second moments of the navigation error at a line of sight, with an altitude error that the slant range turns into one along the
    /// radial.
    ///
    /// An error b of the bearing moves the position along an arc, not along a straight line: seen from the position, the aircraft is
    /// `ground (1 - cos b)` nearer to the station and `ground sin b` beside the radial. With `a = exp(-cross^2 / 2 ground^2)`:
    ///
    /// ```text
    /// along^2  = radial^2 + ground^2 ((1 - a)^2 + (1 - a^2)^2 / 2)      E (1 - cos b)^2, b normal: exact, and its mean is in it
    /// across^2 = ground^2 (1 - a^4) / 2                                 E sin^2 b
    /// ```
    ///
    /// The first order, `radial^2` and `cross^2`, is the printed one. Provenance: ours.
    pub fn covariance(&self, sight: &Sight, sigma_altitude: Metres) -> Covariance<Enu> {
        let g = sight.level();
        let along = Vector3::new(sight.unit.x, sight.unit.y, 0.0) / g;
        let across = Vector3::new(along.y, -along.x, 0.0);
        let (radial, sigma_h, ground) = (self.radial.m(), sigma_altitude.m(), sight.slant.m() * g);
        let half = 0.5 * (self.cross.m() / ground) * (self.cross.m() / ground);
        // 1 - a, 1 - a^2 and 1 - a^4 of a small angle are small themselves.
        let [once, twice, fourth] = [1.0, 2.0, 4.0].map(|power| -exp_m1(-power * half));
        let bend = ground * ground * (once * once + 0.5 * twice * twice);
        // Higher than thought means nearer on the ground: slant^2 = ground^2 + up^2.
        let leaning = Vector3::z() - along * (sight.unit.z / g);
        let m: Matrix3<f64> = (radial * radial + bend) * along * along.transpose()
            + 0.5 * ground * ground * fourth * across * across.transpose()
            + sigma_h * sigma_h * leaning * leaning.transpose();
        Covariance::claim_symmetric(m)
    }
}

const STEPS_MOST: usize = 20;

/// Position from one VOR/DME at a known altitude: along the bearing's vertical plane to the slant range, the elevation by Newton's method.
///
/// # Errors
/// [`NoFix`]: overhead, a slant range that does not reach the altitude, or a number that is not one of its kind.
pub fn vor_fix(station: &Place, measured: &VorRange, altitude: &Altitude) -> Result<Fix, NoFix> {
    let (slant, h) = (measured.slant.m(), altitude.height.m());
    let sigma_h = altitude.sigma.m();
    if !(slant > 0.0 && slant.is_finite()) {
        return Err(OutOfDomain { argument: "slant_m", value: slant, unit: "m", domain: "(0, inf)" }.into());
    }
    if !measured.bearing.rad().is_finite() {
        return Err(OutOfDomain { argument: "bearing_rad", value: measured.bearing.rad(), unit: "rad", domain: "(-inf, inf)" }.into());
    }
    if !(sigma_h >= 0.0 && sigma_h.is_finite()) {
        return Err(OutOfDomain { argument: "sigma_altitude_m", value: sigma_h, unit: "m", domain: "[0, inf)" }.into());
    }
    let rise = (h - station.geodetic.height.m()) / slant;
    if !(rise.abs() < 1.0) {
        return Err(NoFix::Apart);
    }
    let (sb, cb) = sin_cos(measured.bearing.rad());
    let mut elevation = asin(rise);
    for _ in 0..STEPS_MOST {
        let (se, ce) = sin_cos(elevation);
        let seen = Vector3::new(ce * sb, ce * cb, se) * slant;
        let there = geodetic_from_ecef(&EcefPosition::from_vector(station.ecef.vector() + station.axes.transpose() * seen))?;
        let missing = h - there.height.m();
        if missing.abs() <= 1e-6 {
            return placed(station, measured, &Geodetic { height: altitude.height, ..there }, altitude.sigma);
        }
        elevation += missing / (slant * ce);
        if !(elevation.abs() < core::f64::consts::FRAC_PI_2) {
            return Err(NoFix::Apart);
        }
    }
    Err(NoFix::NotSettled)
}

fn placed(station: &Place, measured: &VorRange, position: &Geodetic, sigma_altitude: Metres) -> Result<Fix, NoFix> {
    let sight = Sight::between(&Place::new(*position)?, station).ok_or(NoFix::Overhead)?;
    let ground = Metres::new(sight.slant.m() * sight.level());
    let resolved = vor_dme(ground, sight.slant, measured.sigma_bearing, measured.sigma)?.ok_or(NoFix::Overhead)?;
    let covariance = resolved.covariance(&sight, sigma_altitude);
    Ok(Fix { position: *position, covariance, used: 2, chi_square: 0.0, p_residual: None })
}
