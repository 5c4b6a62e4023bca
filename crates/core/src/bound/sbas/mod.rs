//! SBAS protection levels: from what a service broadcasts to HPL and VPL at a place.
//!
//! In the order of the flow: [`service`] (what is offered now, the same for everyone), [`ionosphere`] (the grid where a signal pierces the
//! shell), [`model`] (the terms of one range's error), here the levels at a user's place, and [`position`] (a user's own ranges corrected,
//! with the levels of that solution).

pub mod ionosphere;
pub mod model;
pub mod position;
pub mod service;
pub mod terms;

use super::{Algorithm, NoLevels, Protection, Provenance, Ranges, Sight};
use crate::frame::{Covariance, EcefPosition, Enu, Geodetic, ecef_from_geodetic, enu_from_ecef};
use crate::geometry::atmosphere::klobuchar_and_latitude;
use crate::quantity::{Metres, OutOfDomain, Radians, Reason, Unavailable};
use crate::signal::Constellation;
use crate::signal::sbas::MASK_MOST;
use crate::signal::sbas::timeout::Use;
use crate::solution::wls::{self, WeightedSight};
use crate::special::float::sqrt;
use ionosphere::{Pierce, Vertical};
use model::{Airborne, Elevation, RangeError, broadcast_ionosphere_m2, obliquity_squared};
use nalgebra::{Matrix3, Vector3};
use service::{Ranging, Service};

/// Document of every formula here; provenance *standard*.
pub const SOURCE: &str =
    "RTCA DO-229D, appendices A.4.4, A.4.5, J.2 (standard; protection levels checked against gLAB 6.0.0 on recorded MSAS messages)";

/// What the levels are.
pub const PROTECTION: Protection = Protection {
    id: "sbas",
    title: "SBAS precision approach and en route",
    function: "navbound.sbas.protection_levels",
    source: SOURCE,
    provenance: Provenance::Standard,
    covers: "what the service monitors and alarms within the time to alarm",
    assumes: "messages are those that the service sent and are heard in time; airborne errors are within the model of the equipment class",
    integrity: true,
};

/// Multiplier of the horizontal level in precision approach: 2Q(6.0) = 2.0e-9 (standard).
pub const K_H_PA: f64 = 6.0;
/// Multiplier en route to non-precision approach: exp(-6.18²/2) = 5.1e-9 (standard).
pub const K_H_NPA: f64 = 6.18;
/// Multiplier of the vertical level: 2Q(5.33) = 9.8e-8 (standard).
pub const K_V: f64 = 5.33;

/// Protection levels; the vertical one in precision approach only.
pub type Levels = super::Levels;

/// Protection levels of a covariance of the SBAS error model.
///
/// ```text
/// d_major = sqrt((dE² + dN²)/2 + sqrt(((dE² - dN²)/2)² + dEN²))
/// HPL = 6.0 d_major, VPL = 5.33 d_U    precision approach
/// HPL = 6.18 d_major                   en route to non-precision approach
/// ```
pub fn levels(covariance: &Covariance<Enu>, used_for: Use) -> Levels {
    let (d_major, _) = wls::horizontal_axes(covariance);
    match used_for {
        Use::PrecisionApproach => {
            let d_u = sqrt(covariance.matrix()[(2, 2)]);
            Levels::of(Metres::new(K_H_PA * d_major.m()), Metres::new(K_V * d_u), ())
        }
        Use::EnRoute => Levels::horizontal(Metres::new(K_H_NPA * d_major.m()), ()),
    }
}

/// SBAS over satellites whose variances are those of the service's error model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sbas {
    used_for: Use,
}

impl Algorithm for Sbas {
    const PROTECTION: Protection = PROTECTION;
    const RANGES: Ranges = Ranges::Service;
    const COLUMNS: &'static [&'static str] = &[];
    type Settings = Use;
    type Detail = ();

    fn usual() -> Use {
        Use::PrecisionApproach
    }

    fn new(used_for: &Use) -> Self {
        Self { used_for: *used_for }
    }

    #[inline(always)]
    fn levels(&mut self, sights: &[Sight]) -> Result<Levels, NoLevels> {
        Ok(levels(&wls::covariance_of_weighted(sights.iter().map(Sight::weighted))?, self.used_for))
    }

    fn number((): &(), _column: usize) -> f64 {
        f64::NAN
    }
}

/// Where a user is, with what is computed once for it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct User {
    place: Geodetic,
    position_m: Vector3<f64>,
    enu: Matrix3<f64>,
    lat_deg: f64,
    lon_deg: f64,
    sin_mask: f64,
    airborne: Airborne,
}

impl User {
    /// A user at a place, who takes satellites from a mask angle on.
    ///
    /// # Errors
    /// [`OutOfDomain`] for a mask outside \[0, pi/2\] or a height that is not finite.
    pub fn new(place: &Geodetic, mask: Radians, airborne: Airborne) -> Result<Self, OutOfDomain> {
        if !(mask.rad() >= 0.0 && mask.rad() <= core::f64::consts::FRAC_PI_2) {
            return Err(OutOfDomain { argument: "mask_rad", value: mask.rad(), unit: "rad", domain: "[0, pi/2]" });
        }
        if !place.height.m().is_finite() {
            return Err(OutOfDomain { argument: "h_m", value: place.height.m(), unit: "m", domain: "finite heights" });
        }
        let position: EcefPosition = ecef_from_geodetic(place);
        Ok(Self {
            place: *place,
            position_m: *position.vector(),
            enu: enu_from_ecef(&place.point),
            lat_deg: place.point.lat().rad().to_degrees(),
            lon_deg: place.point.lon().rad().to_degrees(),
            sin_mask: crate::special::float::sin(mask.rad()),
            airborne,
        })
    }

    /// Where.
    pub const fn place(&self) -> &Geodetic {
        &self.place
    }

    fn up(&self) -> Vector3<f64> {
        self.enu.row(2).transpose()
    }
}

/// One satellite as the user sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seen {
    /// PRN code number.
    pub prn: u8,
    /// Issue of the navigation data.
    pub iode: u8,
    /// Unit vector from the user, east-north-up.
    pub unit_enu: Vector3<f64>,
    /// Elevation.
    pub elevation: Radians,
    /// Factor of the UDRE here (messages 27, 28).
    pub delta_udre: f64,
    /// Fast correction \[m\], long-term correction of the clock \[s\].
    pub fast_m: f64,
    /// To add to the broadcast clock offset \[s\].
    pub clock_s: f64,
    /// Vertical ionosphere at the pierce point.
    pub vertical: Vertical,
    /// It is the service's, not the broadcast model's that serves en route instead.
    pub from_grid: bool,
    /// Variances.
    pub error: RangeError,
}

impl Seen {
    /// Azimuth, clockwise from true north, \[-pi, pi\].
    pub fn azimuth(&self) -> Radians {
        Radians::new(crate::special::float::atan2(self.unit_enu.x, self.unit_enu.y))
    }
}

/// The satellites of one solution. No heap; made once and looked at again for every user, since it is large.
#[derive(Debug, Clone)]
pub struct Sky {
    count: usize,
    seen: [Option<Seen>; MASK_MOST],
    /// What the solution needs of each.
    rows: [WeightedSight; MASK_MOST],
}

impl Default for Sky {
    fn default() -> Self {
        let none = WeightedSight { unit: Vector3::zeros(), weight: 0.0, constellation: Constellation::Gps };
        Self { count: 0, seen: [None; MASK_MOST], rows: [none; MASK_MOST] }
    }
}

impl Sky {
    /// Corrected satellites above the user's mask, each with its error model complete.
    #[inline(always)]
    pub fn look(&mut self, service: &Service, user: &User) {
        let factor = service.region_factor(user.lat_deg, user.lon_deg);
        let orbits = service.orbits();
        let (satellites, n) = orbits.above(&user.position_m, &user.up());
        self.count = 0;
        for group in satellites[..n].chunks(ABREAST) {
            // The last group is filled up with its first satellite.
            let which: [usize; ABREAST] = core::array::from_fn(|l| group.get(l).copied().unwrap_or(group[0]));
            let sights = Sights::new(user, orbits.towards(&which, &user.position_m));
            for (l, index) in group.iter().enumerate() {
                let Some(ranging) = service.indexed(*index) else { continue };
                if let Ok(seen) = sights.seen(l, ranging, service, user, factor) {
                    self.push(seen);
                }
            }
        }
    }
    #[inline(always)]
    fn push(&mut self, seen: Seen) {
        if let (Some(slot), Some(row)) = (self.seen.get_mut(self.count), self.rows.get_mut(self.count)) {
            *row = WeightedSight { unit: seen.unit_enu, weight: 1.0 / seen.error.variance_m2(), constellation: Constellation::Gps };
            *slot = Some(seen);
            self.count += 1;
        }
    }
    /// How many.
    pub const fn len(&self) -> usize {
        self.count
    }
    /// None.
    pub const fn is_empty(&self) -> bool {
        self.count == 0
    }
    /// Each.
    pub fn satellites(&self) -> impl Iterator<Item = &Seen> + Clone {
        self.seen.iter().take(self.count).flatten()
    }
    /// Covariance of the position.
    ///
    /// # Errors
    /// As [`wls::covariance`].
    pub fn covariance(&self) -> Result<Covariance<Enu>, Unavailable> {
        wls::covariance_of_weighted(self.rows.iter().take(self.count).copied())
    }
}

/// Why a corrected satellite is not in a solution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Unseen {
    BelowMask,
    /// Neither grid nor broadcast model says what the ionosphere does.
    NoIonosphere,
}

/// Satellites looked at at once: two vector registers of two numbers, or one of four.
const ABREAST: usize = 4;

/// Directions to several satellites with what follows from them alone.
struct Sights<const L: usize> {
    unit_ecef: [[f64; L]; 3],
    unit_enu: [[f64; L]; 3],
    elevation: [Elevation; L],
    pierce: [Pierce; L],
}

impl<const L: usize> Sights<L> {
    /// From unit vectors from the user, ECEF.
    #[inline(always)]
    fn new(user: &User, unit_ecef: [[f64; L]; 3]) -> Self {
        let [x, y, z] = &unit_ecef;
        let (mut unit_enu, mut cos_el) = ([[0.0; L]; 3], [0.0; L]);
        for l in 0..L {
            for (k, axis) in unit_enu.iter_mut().enumerate() {
                axis[l] = user.enu[(k, 0)] * x[l] + user.enu[(k, 1)] * y[l] + user.enu[(k, 2)] * z[l];
            }
            cos_el[l] = sqrt(unit_enu[0][l] * unit_enu[0][l] + unit_enu[1][l] * unit_enu[1][l]);
        }
        let sin_el = &unit_enu[2];
        let (elevation, pierce) = (Elevation::abreast(sin_el, &cos_el), Pierce::abreast(&user.up(), &unit_ecef, sin_el, &cos_el));
        Self { unit_ecef, unit_enu, elevation, pierce }
    }

    /// One of them as the user sees it.
    #[inline(always)]
    fn seen(&self, l: usize, s: &Ranging, service: &Service, user: &User, region_factor: f64) -> Result<Seen, Unseen> {
        let at = |axes: &[[f64; L]; 3]| Vector3::new(axes[0][l], axes[1][l], axes[2][l]);
        let elevation = self.elevation[l];
        if !(elevation.sin >= user.sin_mask) {
            return Err(Unseen::BelowMask);
        }
        let unit_enu = at(&self.unit_enu);
        let grid = service.grid.vertical(self.pierce[l]);
        let from_grid = grid.is_some();
        let vertical = grid.or_else(|| broadcast_vertical(service, user, &unit_enu, elevation.rad)).ok_or(Unseen::NoIonosphere)?;
        let delta_udre = s.covariance.as_ref().map_or(region_factor, |(c, e_c)| c.along(&at(&self.unit_ecef)) + e_c);
        let error = RangeError::new(s.corrected.variance_m2(delta_udre), vertical.variance_m2, &elevation, &user.airborne);
        let (prn, iode, fast_m, clock_s, elevation) = (s.prn, s.iode, s.fast_m, s.clock_s, Radians::new(elevation.rad));
        Ok(Seen { prn, iode, unit_enu, elevation, delta_udre, fast_m, clock_s, vertical, from_grid, error })
    }
}

/// En route, where the grid does not serve a satellite: the broadcast model, its slant delay and error as those overhead.
fn broadcast_vertical(service: &Service, user: &User, unit_enu: &Vector3<f64>, el_rad: f64) -> Option<Vertical> {
    let klobuchar = service.broadcast_ionosphere.filter(|_| service.used_for == Use::EnRoute)?;
    let level = sqrt(unit_enu.x * unit_enu.x + unit_enu.y * unit_enu.y);
    // Overhead every azimuth is as good.
    let azimuth = if level > 0.0 { (unit_enu.x / level, unit_enu.y / level) } else { (0.0, 1.0) };
    let (slant, magnetic_rad) = klobuchar_and_latitude(&klobuchar, &user.place, el_rad, azimuth, service.now);
    let squared = obliquity_squared(level * level);
    let variance_m2 = broadcast_ionosphere_m2(slant.m(), squared, magnetic_rad) / squared;
    Some(Vertical { delay_m: slant.m() / sqrt(squared), variance_m2 })
}

/// Why there is no level: data, counted.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum NoLevel {
    /// Message 0 is in force.
    #[error("{}", Reason::ServiceDoNotUse.words())]
    DoNotUse,
    /// No PRN mask is in force.
    #[error("{}", Reason::NoPrnMask.words())]
    NoMask,
    /// The satellites do not serve after four seconds without a message.
    #[error("{}", Reason::MessageLoss.words())]
    MessageLoss,
    /// The geometry does not serve.
    #[error(transparent)]
    Geometry(#[from] Unavailable),
}

impl NoLevel {
    /// Its entry in the list of reasons.
    pub const fn reason(&self) -> Reason {
        match self {
            Self::DoNotUse => Reason::ServiceDoNotUse,
            Self::NoMask => Reason::NoPrnMask,
            Self::MessageLoss => Reason::MessageLoss,
            Self::Geometry(why) => why.reason_of_solution(),
        }
    }
}

impl Service {
    /// Whether it serves at all now.
    ///
    /// # Errors
    /// [`NoLevel::DoNotUse`], [`NoLevel::NoMask`].
    pub const fn serves(&self) -> Result<(), NoLevel> {
        if self.stopped {
            return Err(NoLevel::DoNotUse);
        }
        if self.masked { Ok(()) } else { Err(NoLevel::NoMask) }
    }

    /// Why satellites do not serve: the silence that took some, before the geometry of those that are left.
    fn without(&self, why: NoLevel) -> NoLevel {
        let few = matches!(why, NoLevel::Geometry(Unavailable::TooFewSatellites { .. } | Unavailable::Singular { .. }));
        if self.lost && few { NoLevel::MessageLoss } else { why }
    }
}

/// Levels at a place; `sky` holds the satellites used afterwards.
///
/// # Errors
/// [`NoLevel`].
#[inline(always)]
pub fn at(service: &Service, user: &User, sky: &mut Sky) -> Result<Levels, NoLevel> {
    service.serves()?;
    sky.look(service, user);
    let covariance = sky.covariance().map_err(|why| service.without(why.into()))?;
    Ok(levels(&covariance, service.used_for))
}

#[cfg(test)]
mod tests;
