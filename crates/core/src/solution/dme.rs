//! DME ranges: how good one is, what a pair determines, which pair is best, and VOR/DME. Closed forms for one epoch.
//!
//! Flat east-north-up coordinates about a point near the aircraft; altitude known.

use crate::frame::{Displacement, Enu};
use crate::quantity::{Metres, OutOfDomain, Radians};
use crate::special::float::{acos, atan2, cos, hypot, sin, sqrt};
use nalgebra::{Matrix2, Vector2};

/// Standard deviation of a DME range: the larger of a constant and a share of the distance in the air, and the signal in space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RangeModel {
    /// Least standard deviation of the airborne part.
    pub air_least: Metres,
    /// Its share of the distance.
    pub air_share: f64,
    /// Standard deviation of the signal in space.
    pub signal: Metres,
}

impl RangeModel {
    /// 0.085 NM or 0.125 % of the distance, and 0.05 NM: half of 0.17 NM or 0.25 % at 95 %. Standard, from general knowledge
    /// (seen in public excerpts), clause to be cited.
    pub const STANDARD: Self = Self { air_least: Metres::nautical_miles(0.085), air_share: 0.00125, signal: Metres::nautical_miles(0.05) };

    /// sqrt(max(air_least, air_share * slant)^2 + signal^2) \[m\].
    ///
    /// # Errors
    /// [`OutOfDomain`] unless the slant range is in \[0, inf).
    pub fn sigma(&self, slant: Metres) -> Result<Metres, OutOfDomain> {
        if !(slant.m() >= 0.0 && slant.m().is_finite()) {
            return Err(OutOfDomain { argument: "slant_m", value: slant.m(), unit: "m", domain: "[0, inf)" });
        }
        Ok(Metres::new(hypot(self.air_least.m().max(self.air_share * slant.m()), self.signal.m())))
    }
}

/// Which pairs may be used. Standard, from general knowledge (seen in public excerpts), clause to be cited.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Admission {
    /// Least angle at the aircraft between the horizontal directions to both stations; its supplement is the largest.
    pub inclusion_least: Radians,
    /// Least slant range.
    pub slant_least: Metres,
    /// Largest slant range.
    pub slant_most: Metres,
    /// Largest elevation of the aircraft seen from a station.
    pub elevation_most: Radians,
}

impl Admission {
    /// 30 to 150 degrees, 3 to 160 NM, at most 40 degrees.
    pub const STANDARD: Self = Self {
        inclusion_least: Radians::degrees(30.0),
        slant_least: Metres::nautical_miles(3.0),
        slant_most: Metres::nautical_miles(160.0),
        elevation_most: Radians::degrees(40.0),
    };

    fn admits_station(&self, slant: f64, elevation: f64) -> bool {
        slant >= self.slant_least.m() && slant <= self.slant_most.m() && elevation <= self.elevation_most.rad()
    }
}

/// Below this |sin| of the inclusion angle a pair lies in one line and determines nothing.
const SINE_LEAST: f64 = 1e-3;

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
    /// [`OutOfDomain`] unless all coordinates are finite, both stations are apart from the aircraft and the altitude error is a length.
    pub fn seen(
        aircraft: &Displacement<Enu>,
        stations: [&Displacement<Enu>; 2],
        range: &RangeModel,
        admission: &Admission,
        sigma_altitude: Metres,
    ) -> Result<Self, OutOfDomain> {
        let sigma_h = sigma_altitude.m();
        if !(sigma_h >= 0.0 && sigma_h.is_finite()) {
            return Err(OutOfDomain { argument: "sigma_altitude_m", value: sigma_h, unit: "m", domain: "[0, inf)" });
        }
        let [a, b] = [line(aircraft, stations[0])?, line(aircraft, stations[1])?];
        let inclusion = atan2((a.east * b.north - a.north * b.east).abs(), a.east * b.east + a.north * b.north);
        let sigma = [range.sigma(Metres::new(a.slant))?, range.sigma(Metres::new(b.slant))?];
        let least = admission.inclusion_least.rad();
        let covariance = (sin(inclusion) >= SINE_LEAST).then(|| covariance(&a, &b, sigma, sigma_h)).flatten();
        let admissible = covariance.is_some()
            && inclusion >= least
            && inclusion <= core::f64::consts::PI - least
            && [a, b].iter().all(|l| admission.admits_station(l.slant, l.elevation));
        Ok(Self {
            inclusion: Radians::new(inclusion),
            slant: [Metres::new(a.slant), Metres::new(b.slant)],
            sigma,
            elevation: [Radians::new(a.elevation), Radians::new(b.elevation)],
            covariance,
            admissible,
        })
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

#[derive(Clone, Copy)]
struct Line {
    slant: f64,
    east: f64,
    north: f64,
    up: f64,
    elevation: f64,
}

fn line(aircraft: &Displacement<Enu>, station: &Displacement<Enu>) -> Result<Line, OutOfDomain> {
    let d = aircraft.vector() - station.vector();
    let ground = hypot(d.x, d.y);
    let slant = hypot(ground, d.z);
    if !(slant.is_finite() && ground > 0.0) {
        return Err(OutOfDomain { argument: "stations_enu_m", value: ground, unit: "m from the aircraft", domain: "(0, inf)" });
    }
    Ok(Line { slant, east: d.x, north: d.y, up: d.z, elevation: atan2(d.z, ground) })
}

fn covariance(a: &Line, b: &Line, sigma: [Metres; 2], sigma_h: f64) -> Option<Matrix2<f64>> {
    let h = Matrix2::new(a.east / a.slant, a.north / a.slant, b.east / b.slant, b.north / b.slant);
    let w = Vector2::new(a.up / a.slant, b.up / b.slant) * sigma_h;
    let [s1, s2] = sigma.map(Metres::m);
    let r = Matrix2::new(s1 * s1, 0.0, 0.0, s2 * s2) + w * w.transpose();
    let inverse = h.try_inverse()?;
    Some(inverse * r * inverse.transpose())
}

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
