//! ARAIM levels of many epochs: geometry given, or users and orbits.

use crate::araim_modes::Known;
use crate::batch::CHUNK;
use nalgebra::{Matrix3, Vector3};
use navbound_core::bound::araim::exclusion::{self, Monitored, NoLevels};
use navbound_core::bound::araim::modes::{MOST_SATELLITES, NoModes};
use navbound_core::bound::araim::ranging::{Airborne, Beyond};
use navbound_core::bound::araim::service::{Service, Support};
use navbound_core::bound::araim::single::Requirement;
use navbound_core::bound::araim::{Levels, Monitor, Sight};
use navbound_core::frame::{Geodetic, ecef_from_geodetic, enu_from_ecef};
use navbound_core::geometry::{Elements, Orbit};
use navbound_core::quantity::{Metres, OutOfDomain, Radians, Reason, Unavailable};
use navbound_core::signal::Constellation;
use navbound_path::AtIndex;
use pulp::Arch;
use rayon::prelude::*;

/// Why an epoch has no finite levels; the order is that of [`Outcome::WORDS`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// It has.
    Ok,
    /// Fewer satellites than unknowns.
    TooFewSatellites,
    /// The satellites do not determine the position.
    Singular,
    /// The integrity risk is spent on fault modes that cannot be monitored: the levels are infinite.
    NotMonitored,
    /// More satellites, or more fault modes to monitor, than there is room for.
    TooMany,
}

impl Outcome {
    /// Its entry in the list of reasons.
    pub const fn reason(self) -> Option<Reason> {
        match self {
            Self::Ok => None,
            Self::TooFewSatellites => Some(Reason::TooFewSatellites),
            Self::Singular => Some(Reason::Singular),
            Self::NotMonitored => Some(Reason::NotMonitored),
            Self::TooMany => Some(Reason::TooMany),
        }
    }

    /// The words of tables.
    pub const WORDS: [&'static str; 5] = ["ok", "too_few_satellites", "singular", "not_monitored", "too_many"];

    /// Of levels: whether both are finite.
    pub fn of(levels: &Levels) -> Self {
        if levels.hpl.m().is_finite() && levels.vpl.m().is_finite() { Self::Ok } else { Self::NotMonitored }
    }
}

/// Satellites in many solutions: rows are epochs, columns satellites; one whose line of sight is NaN is not used.
#[derive(Debug, Clone, Copy)]
pub struct Sights<'a> {
    /// East, north, up of each unit vector, three numbers a satellite.
    pub unit_enu: &'a [f64],
    /// Standard deviation of each range for integrity \[m\].
    pub sigma_int_m: &'a [f64],
    /// For accuracy and continuity \[m\].
    pub sigma_acc_m: &'a [f64],
    /// Nominal bias for integrity \[m\].
    pub bias_m: &'a [f64],
    /// For continuity \[m\].
    pub bias_continuity_m: &'a [f64],
    /// Prior of each satellite.
    pub p_sat: &'a [f64],
    /// Constellation of each column.
    pub constellation: &'a [Constellation],
    /// Prior of each constellation.
    pub p_const: [f64; Constellation::ALL.len()],
}

impl Sights<'_> {
    /// Epochs.
    pub fn len(&self) -> usize {
        self.sigma_int_m.len().checked_div(self.constellation.len()).unwrap_or(0)
    }
    /// None.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// One epoch's result: satellites used, why there are no finite levels, the levels (infinite or absent then).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// Satellites used.
    pub n_sv: usize,
    /// Whether there are levels.
    pub outcome: Outcome,
    /// The levels, where the geometry gives any.
    pub levels: Option<Levels>,
}

/// Which monitoring the levels are those of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Rule {
    /// Fault modes with priors, satellites and constellations.
    Araim(Service),
    /// One satellite at a time, no priors.
    Raim(Requirement),
}

/// What a thread keeps from epoch to epoch.
pub(crate) struct Desk {
    monitor: Box<Monitor>,
    known: Known,
    /// The satellites of the epoch at hand.
    pub(crate) sights: Vec<Sight>,
}

impl Desk {
    pub(crate) fn new(p_const: [f64; Constellation::ALL.len()], uniform: bool) -> Self {
        Self { monitor: Box::default(), known: Known::new(p_const, uniform), sights: Vec::new() }
    }

    /// Detection and exclusion on the desk's satellites.
    pub(crate) fn monitored(&mut self, residuals_m: &[f64], service: &Service) -> Result<Monitored, NoLevels> {
        exclusion::monitored(&mut self.monitor, &mut self.known, &self.sights, residuals_m, service)
    }

    /// Levels of the satellites on the desk; with exclusion the worst of what may be left after one.
    #[inline(always)]
    fn levels(&mut self, rule: &Rule, exclusion: bool) -> Result<Row, OutOfDomain> {
        let n_sv = self.sights.len();
        let row = |outcome, levels| Row { n_sv, outcome, levels };
        let (monitor, known, sights) = (&mut self.monitor, &mut self.known, &self.sights[..]);
        let levels = match (rule, exclusion) {
            (Rule::Araim(service), false) => exclusion::detected(monitor, known, sights, service),
            (Rule::Araim(service), true) => exclusion::predicted(monitor, known, sights, service),
            (Rule::Raim(requirement), false) => monitor.single_levels(sights, requirement),
            (Rule::Raim(requirement), true) => monitor.single_levels_after_exclusion(sights, requirement),
        };
        match levels {
            Ok(levels) => Ok(row(Outcome::of(&levels), Some(levels))),
            Err(e) => refusal(e).map_or_else(|outcome| Ok(row(outcome, None)), Err),
        }
    }

    /// Take up a row's satellites; `each` receives the column of every one.
    #[inline(always)]
    fn take(&mut self, sights: &Sights<'_>, row: usize, mut each: impl FnMut(usize)) {
        self.sights.clear();
        for (column, constellation) in sights.constellation.iter().enumerate() {
            let i = row * sights.constellation.len() + column;
            let unit = Vector3::new(sights.unit_enu[3 * i], sights.unit_enu[3 * i + 1], sights.unit_enu[3 * i + 2]);
            if unit.iter().all(|x| x.is_nan()) {
                continue;
            }
            each(column);
            self.sights.push(Sight {
                unit,
                constellation: *constellation,
                integrity_m2: squared(sights.sigma_int_m[i]),
                accuracy_m2: squared(sights.sigma_acc_m[i]),
                bias: Metres::new(sights.bias_m[i]),
                bias_continuity: Metres::new(sights.bias_continuity_m[i]),
                p_sat: sights.p_sat[i],
            });
        }
    }
}

/// Levels of every epoch, in the widest instructions the processor has; the bits do not depend on them.
///
/// # Errors
/// [`AtIndex`]: the first epoch with a number outside its domain.
pub fn levels(sights: &Sights<'_>, rule: &Rule, exclusion: bool) -> Result<Vec<Row>, AtIndex> {
    let uniform = uniform(sights);
    rows(
        sights.len(),
        || Desk::new(sights.p_const, uniform),
        #[inline(always)]
        |desk, row| {
            desk.take(sights, row, |_| ());
            desk.levels(rule, exclusion)
        },
    )
}

/// Detection and exclusion at every epoch: `residual_m` holds measured less computed ranges, one a satellite.
///
/// # Errors
/// As [`levels`], and for a residual of a satellite in use that is no number.
pub fn monitored(sights: &Sights<'_>, residual_m: &[f64], service: &Service) -> Result<Vec<Tested>, AtIndex> {
    let uniform = uniform(sights);
    let each = |desk: &mut (Desk, Vec<f64>, Vec<usize>), row: usize| {
        let (desk, residuals, columns) = desk;
        residuals.clear();
        columns.clear();
        desk.take(sights, row, |column| {
            residuals.push(residual_m[row * sights.constellation.len() + column]);
            columns.push(column);
        });
        let monitored = match desk.monitored(residuals, service) {
            Ok(monitored) => monitored,
            Err(e) => return refusal(e).map_or_else(|outcome| Ok(Tested { outcome, monitored: None, excluded: Vec::new() }), Err),
        };
        let out = |i: usize| i < MOST_SATELLITES && monitored.excluded >> i & 1 == 1;
        let excluded = columns.iter().enumerate().filter(|(i, _)| out(*i)).map(|(_, c)| *c).collect();
        Ok(Tested { outcome: Outcome::of(&monitored.levels), monitored: Some(monitored), excluded })
    };
    (0..sights.len())
        .into_par_iter()
        .map_init(
            || (Desk::new(sights.p_const, uniform), Vec::new(), Vec::new()),
            |desk, index| each(desk, index).map_err(|error| AtIndex { index, error }),
        )
        .collect()
}

/// One epoch after detection and exclusion.
#[derive(Debug, Clone, PartialEq)]
pub struct Tested {
    /// Whether there are levels.
    pub outcome: Outcome,
    /// Decision and levels, where the geometry gives any.
    pub monitored: Option<Monitored>,
    /// Columns of the excluded satellites.
    pub excluded: Vec<usize>,
}

/// Why there are no levels: the caller's mistake, or a status.
///
/// # Errors
/// The status.
pub fn refusal(e: NoLevels) -> Result<OutOfDomain, Outcome> {
    match e {
        NoLevels::Modes(NoModes::OutOfDomain(e)) => Ok(e),
        NoLevels::Modes(_) => Err(Outcome::TooMany),
        NoLevels::Geometry(Unavailable::Invalid { field, value, unit, domain }) => Ok(OutOfDomain { argument: field, value, unit, domain }),
        NoLevels::Geometry(Unavailable::TooFewSatellites { .. }) => Err(Outcome::TooFewSatellites),
        NoLevels::Geometry(_) => Err(Outcome::Singular),
    }
}

/// What is promised of satellites, and how the user receives them.
#[derive(Debug, Clone, Copy)]
pub struct Promise {
    /// By constellation.
    pub support: [Support; Constellation::ALL.len()],
    /// Receiver, multipath, atmosphere.
    pub airborne: Airborne,
}

impl Promise {
    /// A satellite with the error of a smoothed range.
    #[inline(always)]
    pub(crate) fn sight(&self, unit: Vector3<f64>, constellation: Constellation) -> Sight {
        self.sight_beyond(unit, constellation, &Beyond::NOTHING)
    }

    /// A satellite with the error of a range that has something beyond a smoothed one.
    #[inline(always)]
    pub(crate) fn sight_beyond(&self, unit: Vector3<f64>, constellation: Constellation, beyond: &Beyond) -> Sight {
        let support = &self.support[constellation.index()];
        let local = self.airborne.variance_m2(unit.z.clamp(-1.0, 1.0).asin(), unit.z) + beyond.variance_m2(unit.z);
        let square = |m: Metres| m.m() * m.m();
        Sight {
            unit,
            constellation,
            integrity_m2: square(support.sigma_ura) + local,
            accuracy_m2: square(support.sigma_ure) + local,
            bias: support.bias,
            bias_continuity: support.bias_continuity,
            p_sat: support.p_sat,
        }
    }
}

/// Users and instants whose levels are worked out from orbits: every user at every instant.
#[derive(Debug, Clone, Copy)]
pub struct Outlook<'a> {
    /// Orbits.
    pub orbits: &'a [Elements],
    /// Constellation of each.
    pub constellation: &'a [Constellation],
    /// Instants since the orbits' reference instant \[s\].
    pub time_s: &'a [f64],
    /// Users.
    pub users: &'a [Geodetic],
    /// Lowest elevation.
    pub mask: Radians,
    /// What is promised of the satellites.
    pub promise: Promise,
}

/// A user's place and axes.
struct Place {
    position_m: Vector3<f64>,
    enu: Matrix3<f64>,
}

/// Satellites over users at instants, worked out once for all of them.
pub(crate) struct Overhead<'a> {
    outlook: &'a Outlook<'a>,
    positions: Vec<Vector3<f64>>,
    places: Vec<Place>,
    sin_mask: f64,
}

impl<'a> Overhead<'a> {
    /// # Errors
    /// [`AtIndex`]: the first orbit, instant, user or promise outside its domain.
    pub(crate) fn new(outlook: &'a Outlook<'a>) -> Result<Self, AtIndex> {
        let at = |index| move |error| AtIndex { index, error };
        for (index, support) in outlook.promise.support.iter().enumerate() {
            support.checked().map_err(at(index))?;
        }
        if let Some(index) = outlook.time_s.iter().position(|t| !t.is_finite()) {
            return Err(at(index)(OutOfDomain { argument: "time_s", value: outlook.time_s[index], unit: "s", domain: "finite times" }));
        }
        if let Some(index) = outlook.users.iter().position(|u| !u.height.m().is_finite()) {
            let value = outlook.users[index].height.m();
            return Err(at(index)(OutOfDomain { argument: "h_m", value, unit: "m", domain: "finite heights" }));
        }
        let orbits = outlook.orbits.iter().enumerate().map(|(k, e)| Orbit::new(*e).map_err(at(k))).collect::<Result<Vec<_>, _>>()?;
        let sky = |t: &f64| orbits.iter().map(|orbit| *orbit.position(*t).vector()).collect::<Vec<_>>();
        let place = |u: &Geodetic| Place { position_m: *ecef_from_geodetic(u).vector(), enu: enu_from_ecef(&u.point) };
        Ok(Self {
            outlook,
            positions: outlook.time_s.par_iter().flat_map_iter(sky).collect(),
            places: outlook.users.iter().map(place).collect(),
            sin_mask: outlook.mask.rad().sin(),
        })
    }

    /// Every user at every instant.
    pub(crate) fn len(&self) -> usize {
        self.outlook.time_s.len() * self.places.len()
    }

    /// Satellites of one user and instant, instants first.
    #[inline(always)]
    pub(crate) fn each(&self, index: usize, mut each: impl FnMut(Sight)) {
        let (instant, user) = (index / self.places.len(), index % self.places.len());
        let n = self.outlook.orbits.len();
        for (position, constellation) in self.positions[instant * n..(instant + 1) * n].iter().zip(self.outlook.constellation) {
            if let Some(sight) = seen(position, *constellation, &self.places[user], self.sin_mask, self.outlook) {
                each(sight);
            }
        }
    }
}

/// Levels of every user at every instant: user after user, instant after instant.
///
/// # Errors
/// [`AtIndex`]: the first orbit, instant, user or promise outside its domain.
pub fn predict(outlook: &Outlook<'_>, rule: &Rule, exclusion: bool) -> Result<Vec<Row>, AtIndex> {
    let overhead = Overhead::new(outlook)?;
    rows(
        overhead.len(),
        || Desk::new(outlook.promise.support.map(|s| s.p_const), true),
        #[inline(always)]
        |desk, index| {
            desk.sights.clear();
            overhead.each(index, |sight| desk.sights.push(sight));
            desk.levels(rule, exclusion)
        },
    )
}

/// A satellite above the mask, with its range's error.
#[inline(always)]
fn seen(position: &Vector3<f64>, constellation: Constellation, place: &Place, sin_mask: f64, outlook: &Outlook<'_>) -> Option<Sight> {
    let apart = position - place.position_m;
    // Half of the satellites are below the horizon, and most masks are not.
    if sin_mask >= 0.0 && !(place.enu.row(2).tr_dot(&apart) >= 0.0) {
        return None;
    }
    let enu = place.enu * apart;
    let unit = enu / enu.norm();
    if !(unit.z >= sin_mask) {
        return None;
    }
    Some(outlook.promise.sight(unit, constellation))
}

/// A negative sigma stays negative, so that it is refused.
fn squared(sigma: f64) -> f64 {
    sigma * sigma.abs()
}

/// Whether satellites of one constellation share one prior everywhere.
fn uniform(sights: &Sights<'_>) -> bool {
    let mut first = [None; Constellation::ALL.len()];
    let same = |(p, c): (&f64, &Constellation)| *first[c.index()].get_or_insert(*p) == *p;
    sights.p_sat.iter().zip(sights.constellation.iter().cycle()).all(same)
}

/// Every epoch by chunks on all cores.
pub(crate) fn rows<D: Send, T: Send>(
    n: usize,
    desk: impl Fn() -> D + Sync + Send,
    epoch: impl Fn(&mut D, usize) -> Result<T, OutOfDomain> + Sync,
) -> Result<Vec<T>, AtIndex> {
    let arch = Arch::new();
    let chunk = CHUNK.min(256);
    let done: Result<Vec<Vec<T>>, AtIndex> = (0..n.div_ceil(chunk))
        .into_par_iter()
        .map_init(desk, |desk, k| {
            let span = k * chunk..n.min((k + 1) * chunk);
            arch.dispatch(Job { desk, span, epoch: &epoch })
        })
        .collect();
    Ok(done?.into_iter().flatten().collect())
}

/// One chunk as a job for [`Arch::dispatch`], which compiles it once for each width of instructions.
struct Job<'a, D, F> {
    desk: &'a mut D,
    span: std::ops::Range<usize>,
    epoch: &'a F,
}

impl<D, T, F: Fn(&mut D, usize) -> Result<T, OutOfDomain>> pulp::NullaryFnOnce for Job<'_, D, F> {
    type Output = Result<Vec<T>, AtIndex>;

    #[inline(always)]
    fn call(self) -> Self::Output {
        // A plain loop: an iterator's closure would be compiled for the least processor.
        let mut rows = Vec::with_capacity(self.span.len());
        for index in self.span {
            match (self.epoch)(self.desk, index) {
                Ok(row) => rows.push(row),
                Err(error) => return Err(AtIndex { index, error }),
            }
        }
        Ok(rows)
    }
}
