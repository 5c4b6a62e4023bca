//! A user's own position: pseudoranges corrected by the service, and the levels of that very solution.
//!
//! Weights, satellites and covariance are those of the levels, so that an error of this position is what the levels bound. No range is
//! excluded for its residual: the service answers for the corrected ranges, and a level without a satellite would be another one.

use super::model::Airborne;
use super::service::{Ranging, Service};
use super::{Levels, NoLevel, Sights, Sky, Unseen, User, levels};
use crate::frame::{Covariance, EcefPosition, Enu, Geodetic, geodetic_from_ecef};
use crate::geometry::atmosphere::mapping_of;
use crate::geometry::seasonal::seasonal_zenith_delay;
use crate::quantity::{Metres, OutOfDomain, Radians, Unavailable};
use crate::signal::Constellation;
use crate::signal::sbas::MASK_MOST;
use crate::solution::point::{start_from, way};
use crate::solution::wls::{Dilution, Normal, Row};
use crate::special::float::sqrt;
use crate::special::gamma::chi_square_tail;
use nalgebra::Vector3;

/// Rounds from nothing to a position that stands still; from the position before two or three do.
const ROUNDS: usize = 12;
/// A step below this is the last \[m\]: what it changes in delays and directions moves the position by less than a thousandth of it.
const STILL: f64 = 0.01;
/// A position of these heights above the ellipsoid is one of an aircraft \[m\].
const HEIGHTS: core::ops::Range<f64> = -50_000.0..1e8;

/// The pseudorange of one satellite that the service corrects.
#[derive(Debug, Clone, Copy)]
pub struct Measurement<'a> {
    /// Its correction in force.
    pub ranging: &'a Ranging,
    /// Pseudorange plus c times the satellite's clock, both corrected by the service; group delay taken out.
    pub corrected: Metres,
    /// Satellite at transmission, axes of transmission, long-term correction included.
    pub position: EcefPosition,
}

/// Who asks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Receiver {
    /// Lowest elevation.
    pub mask: Radians,
    /// Its noise and multipath.
    pub airborne: Airborne,
    /// Where it may be, such as where it was last; none begins from nothing. The result does not depend on it.
    pub near: Option<EcefPosition>,
}

/// A position and its levels; the satellites are in the sky that was handed in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solution {
    /// Where.
    pub position: Geodetic,
    /// Covariance by the service's error model, an upper bound and no estimate.
    pub covariance: Covariance<Enu>,
    /// Protection levels of this solution.
    pub levels: Levels,
    /// Dilution of precision of the satellites used.
    pub dilution: Dilution,
    /// Residuals of the satellites in the sky, in their order \[m\].
    pub residual_m: [f64; MASK_MOST],
    /// Risk of residuals as large if the errors are as the weights say; NaN without redundancy.
    pub residual_risk: f64,
    /// Ranges beyond the unknowns.
    pub redundancy: usize,
    /// Corrected satellites above the mask whose ionosphere nothing describes.
    pub without_ionosphere: usize,
}

/// The position and its levels.
///
/// ```text
/// corrected range = P + c (clock_sv + long-term clock) + fast correction
///                 = way + F_pp vertical ionosphere + zenith troposphere m(E) + receiver clock
/// weights 1 / sigma^2 of the error model, least squares
/// ```
///
/// # Errors
/// [`NoLevel`]: the service does not serve, the geometry does not, or ranges are no ranges of a receiver near the Earth.
pub fn solve(service: &Service, measured: &[Measurement<'_>], receiver: &Receiver, sky: &mut Sky) -> Result<Solution, NoLevel> {
    service.serves()?;
    converge(service, measured, receiver, sky).map_err(|why| service.without(why))
}

fn converge(service: &Service, measured: &[Measurement<'_>], receiver: &Receiver, sky: &mut Sky) -> Result<Solution, NoLevel> {
    let mut at = match receiver.near {
        Some(near) => *near.vector(),
        None => start_from(measured.iter().map(|m| (&m.position, m.corrected, Constellation::Gps.index())))?,
    };
    for _ in 0..ROUNDS {
        let mut round = Round::new(service, measured, receiver, &at, sky)?;
        let step = round.normal.step().ok_or(SINGULAR)?;
        at += round.user.enu.transpose() * step;
        if step.norm() < STILL {
            return round.finish(service, &at, &step, sky);
        }
    }
    Err(NoLevel::Geometry(SINGULAR))
}

const SINGULAR: Unavailable = Unavailable::Singular { condition: f64::INFINITY, limit: crate::solution::wls::CONDITION_LIMIT };

/// The ranges against one position.
struct Round {
    user: User,
    normal: Normal,
    /// Measured less modelled, the receiver's clock included \[m\].
    residual_m: [f64; MASK_MOST],
    without_ionosphere: usize,
}

impl Round {
    fn new(
        service: &Service,
        measured: &[Measurement<'_>],
        receiver: &Receiver,
        at: &Vector3<f64>,
        sky: &mut Sky,
    ) -> Result<Self, NoLevel> {
        let wrong = |e: OutOfDomain| NoLevel::Geometry(e.into());
        let place = geodetic_from_ecef(&EcefPosition::from_vector(*at)).map_err(wrong)?;
        let user = User::new(&place, receiver.mask, receiver.airborne).map_err(wrong)?;
        let zenith = seasonal_zenith_delay(&place, service.now);
        let factor = service.region_factor(user.lat_deg, user.lon_deg);
        let (mut residual_m, mut without_ionosphere) = ([0.0; MASK_MOST], 0);
        sky.count = 0;
        for m in measured {
            let (way, unit) = way(&m.position, at);
            match Sights::new(&user, [[unit.x], [unit.y], [unit.z]]).seen(0, m.ranging, service, &user, factor) {
                Err(why) => without_ionosphere += usize::from(why == Unseen::NoIonosphere),
                Ok(seen) => {
                    let Some(residual) = residual_m.get_mut(sky.count) else { break };
                    *residual = m.corrected.m() - way - seen.slant_ionosphere_m() - zenith * mapping_of(seen.unit_enu.z);
                    sky.push(seen);
                }
            }
        }
        let rows = rows(sky, &residual_m);
        let normal = Normal::new(rows)?;
        Ok(Self { user, normal, residual_m, without_ionosphere })
    }

    /// After the last step.
    fn finish(&mut self, service: &Service, at: &Vector3<f64>, step: &Vector3<f64>, sky: &Sky) -> Result<Solution, NoLevel> {
        let covariance = self.normal.covariance()?;
        let position = geodetic_from_ecef(&EcefPosition::from_vector(*at)).map_err(|e| NoLevel::Geometry(e.into()))?;
        let height = position.height.m();
        if !HEIGHTS.contains(&height) {
            let (unit, domain) = ("m", "(-5e4, 1e8)");
            return Err(NoLevel::Geometry(Unavailable::Invalid { field: "est_h_m", value: height, unit, domain }));
        }
        let clock = self.normal.clock(Constellation::Gps.index(), step);
        let mut statistic = 0.0;
        for (row, residual) in sky.rows.iter().take(sky.count).zip(&mut self.residual_m) {
            // The way shortens by the step towards the satellite.
            *residual += row.unit.dot(step) - clock;
            statistic += row.weight * *residual * *residual;
        }
        let redundancy = sky.count.saturating_sub(4);
        let unweighted = Normal::new(rows(sky, &self.residual_m).map(|r| Row { weight: 1.0, ..r }))?;
        Ok(Solution {
            position,
            covariance,
            levels: levels(&covariance, service.used_for),
            dilution: Dilution::of(&unweighted.covariance()?),
            residual_m: self.residual_m,
            residual_risk: if redundancy > 0 { chi_square_tail(redundancy as f64, statistic) } else { f64::NAN },
            redundancy,
            without_ionosphere: self.without_ionosphere,
        })
    }
}

fn rows<'a>(sky: &'a Sky, residual_m: &'a [f64; MASK_MOST]) -> impl Iterator<Item = Row> + Clone + 'a {
    let clock = Constellation::Gps.index();
    let row = move |(s, residual): (&super::WeightedSight, &f64)| Row { unit: s.unit, weight: s.weight, clock, residual: *residual };
    sky.rows.iter().take(sky.count).zip(residual_m).map(row)
}

impl super::Seen {
    /// Ionospheric delay on the way \[m\], on L1.
    pub fn slant_ionosphere_m(&self) -> f64 {
        let cos_squared = 1.0 - self.unit_enu.z * self.unit_enu.z;
        sqrt(super::obliquity_squared(cos_squared)) * self.vertical.delay_m
    }
}
