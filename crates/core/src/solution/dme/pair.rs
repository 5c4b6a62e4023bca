//! What two ranges determine.

use super::{Admission, RangeModel, Sight};
use crate::frame::{Displacement, Enu};
use crate::quantity::{Metres, OutOfDomain, Radians};
use crate::special::float::{atan2, cos, hypot, sin, sqrt};
use nalgebra::{Matrix2, Vector2, Vector3};

/// Below this |sin| of the inclusion angle a pair lies in one line and determines nothing.
pub(super) const SINE_LEAST: f64 = 1e-3;

/// What two ranges determine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair {
    /// Angle at the aircraft between the horizontal directions to both stations.
    pub inclusion: Radians,
    /// Slant ranges.
    pub slant: [Metres; 2],
    /// Standard deviations of the ranges.
    pub sigma: [Metres; 2],
    /// Elevations of the aircraft seen from the stations.
    pub elevation: [Radians; 2],
    /// East-north covariance of the position \[m²\]; `None` when the stations and the aircraft lie in one line.
    pub covariance: Option<Matrix2<f64>>,
    /// Whether the pair may be used.
    pub admissible: bool,
}

impl Pair {
    /// A pair of stations seen from an aircraft with an altitude error of `sigma_altitude` (zero: exact).
    ///
    /// ```text
    /// row_i = horizontal part of the unit vector from station to aircraft
    /// C     = H^-1 R H^-T      R = diag(sigma_i^2) + sigma_h^2 w w',  w_i = (h - h_i) / rho_i
    /// ```
    ///
    /// # Errors
    /// [`OutOfDomain`] unless the altitude error is a length and the slant ranges have a standard deviation.
    pub fn of(sights: [&Sight; 2], range: &RangeModel, admission: &Admission, sigma_altitude: Metres) -> Result<Self, OutOfDomain> {
        let sigma_h = sigma_altitude.m();
        if !(sigma_h >= 0.0 && sigma_h.is_finite()) {
            return Err(OutOfDomain { argument: "sigma_altitude_m", value: sigma_h, unit: "m", domain: "[0, inf)" });
        }
        let [a, b] = sights.map(|s| s.unit);
        let inclusion = atan2((a.x * b.y - a.y * b.x).abs(), a.x * b.x + a.y * b.y);
        let sigma = [range.sigma(sights[0].slant)?, range.sigma(sights[1].slant)?];
        let least = admission.inclusion_least.rad();
        let covariance = (sin(inclusion) >= SINE_LEAST).then(|| covariance([&a, &b], sigma, sigma_h)).flatten();
        let admissible = covariance.is_some()
            && inclusion >= least
            && inclusion <= core::f64::consts::PI - least
            && sights.iter().all(|s| admission.admits(s));
        Ok(Self {
            inclusion: Radians::new(inclusion),
            slant: sights.map(|s| s.slant),
            sigma,
            elevation: sights.map(|s| s.elevation),
            covariance,
            admissible,
        })
    }

    /// The same of stations in flat coordinates.
    ///
    /// # Errors
    /// As [`Pair::of`] and [`Sight::flat`].
    pub fn seen(
        aircraft: &Displacement<Enu>,
        stations: [&Displacement<Enu>; 2],
        range: &RangeModel,
        admission: &Admission,
        sigma_altitude: Metres,
    ) -> Result<Self, OutOfDomain> {
        let [a, b] = [Sight::flat(aircraft, stations[0])?, Sight::flat(aircraft, stations[1])?];
        Self::of([&a, &b], range, admission, sigma_altitude)
    }

    /// Root of the trace of the covariance: the distance root mean square.
    pub fn drms(&self) -> Option<Metres> {
        self.covariance.map(|c| Metres::new(sqrt(c.trace())))
    }

    /// 2 sqrt(sigma_1^2 + sigma_2^2) / sin(inclusion): printed as a 95 % figure, but it is two drms of level ranges, which cover
    /// between 95.4 % and 98.2 %.
    pub fn icao_two_sigma(&self) -> Option<Metres> {
        self.covariance.and_then(|_| icao_two_sigma(self.sigma, self.inclusion).ok())
    }

    /// Standard deviation across a course: what the total system error needs.
    pub fn lateral_sigma(&self, course: Radians) -> Option<Metres> {
        let across = Vector2::new(cos(course.rad()), -sin(course.rad()));
        self.covariance.map(|c| Metres::new(sqrt(across.dot(&(c * across)))))
    }
}

/// 2 sqrt(sigma_1^2 + sigma_2^2) / sin(inclusion) \[m\].
///
/// # Errors
/// [`OutOfDomain`] unless the sine of the inclusion angle is at least 0.001: the stations and the aircraft lie in one line otherwise.
pub fn icao_two_sigma(sigma: [Metres; 2], inclusion: Radians) -> Result<Metres, OutOfDomain> {
    if !(sin(inclusion.rad()) >= SINE_LEAST) {
        let domain = "angles whose sine is at least 0.001";
        return Err(OutOfDomain { argument: "inclusion_rad", value: inclusion.rad(), unit: "rad", domain });
    }
    Ok(Metres::new(2.0 * hypot(sigma[0].m(), sigma[1].m()) / sin(inclusion.rad())))
}

fn covariance([a, b]: [&Vector3<f64>; 2], sigma: [Metres; 2], sigma_h: f64) -> Option<Matrix2<f64>> {
    let h = Matrix2::new(a.x, a.y, b.x, b.y);
    let w = Vector2::new(a.z, b.z) * sigma_h;
    let [s1, s2] = sigma.map(Metres::m);
    let r = Matrix2::new(s1 * s1, 0.0, 0.0, s2 * s2) + w * w.transpose();
    let inverse = h.try_inverse()?;
    Some(inverse * r * inverse.transpose())
}
