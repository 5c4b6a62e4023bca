//! Protection levels of many users at many instants, from orbits, by any algorithm.

use crate::parallel;
use nalgebra::{Matrix3, Vector3};
use navbound_core::bound::araim::modes::NoModes;
use navbound_core::bound::araim::ranging::{Airborne, Beyond};
use navbound_core::bound::araim::service::Support;
use navbound_core::bound::{Algorithm, Levels, NoLevels, Sight, Task, with_algorithm};
use navbound_core::frame::{Geodetic, ecef_from_geodetic, enu_from_ecef};
use navbound_core::geometry::{Elements, Orbit};
use navbound_core::quantity::{Metres, OutOfDomain, Radians, Reason, Unavailable};
use navbound_core::signal::Constellation;
use navbound_path::AtIndex;
use pulp::Arch;

/// Epochs in one task of the pool.
const EPOCHS_PER_TASK: usize = 256;

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

    /// Of levels: whether each is finite.
    pub fn of<D>(levels: &Levels<D>) -> Self {
        if levels.finite() { Self::Ok } else { Self::NotMonitored }
    }
}

/// One epoch's result; `D` is what the algorithm says beside its levels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row<D> {
    /// Satellites used.
    pub n_sv: usize,
    /// Why there are no finite levels.
    pub outcome: Outcome,
    /// The levels, where the geometry gives any; they may be infinite.
    pub levels: Option<Levels<D>>,
}

impl<D> Row<D> {
    /// Of the requested levels.
    ///
    /// # Errors
    /// [`OutOfDomain`]: the caller's mistake.
    #[inline(always)]
    pub(crate) fn of(n_sv: usize, levels: Result<Levels<D>, NoLevels>) -> Result<Self, OutOfDomain> {
        match levels {
            Ok(levels) => Ok(Self { n_sv, outcome: Outcome::of(&levels), levels: Some(levels) }),
            Err(e) => refusal(e).map_or_else(|outcome| Ok(Self { n_sv, outcome, levels: None }), Err),
        }
    }
}

/// Why there are no levels: the caller's mistake, or a status.
///
/// # Errors
/// The status.
pub fn refusal(e: NoLevels) -> Result<OutOfDomain, Outcome> {
    match e {
        NoLevels::Modes(NoModes::OutOfDomain(e)) => Ok(e),
        NoLevels::Modes(_) | NoLevels::Geometry(Unavailable::Invalid { field: "n_sv", .. }) => Err(Outcome::TooMany),
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
    fn sight(&self, unit: Vector3<f64>, constellation: Constellation) -> Sight {
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
            receiver_faulty_m2: square(support.sigma_ura) + local,
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
struct Overhead<'a> {
    outlook: &'a Outlook<'a>,
    positions: Vec<Vector3<f64>>,
    places: Vec<Place>,
    sin_mask: f64,
}

impl<'a> Overhead<'a> {
    /// # Errors
    /// [`AtIndex`]: the first orbit, instant, user or promise outside its domain.
    fn new(outlook: &'a Outlook<'a>) -> Result<Self, AtIndex> {
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
        let sky = |t: f64| orbits.iter().map(|orbit| *orbit.position(t).vector()).collect::<Vec<_>>();
        let place = |u: &Geodetic| Place { position_m: *ecef_from_geodetic(u).vector(), enu: enu_from_ecef(&u.point) };
        Ok(Self {
            outlook,
            positions: parallel::map(outlook.time_s.len(), EPOCHS_PER_TASK, |k| sky(outlook.time_s[k])).concat(),
            places: outlook.users.iter().map(place).collect(),
            sin_mask: outlook.mask.rad().sin(),
        })
    }

    /// Every user at every instant.
    fn len(&self) -> usize {
        self.outlook.time_s.len() * self.places.len()
    }

    /// Satellites of one user and instant, instants first, with the widest instructions that the processor has.
    fn put(&self, index: usize, sights: &mut Vec<Sight>) {
        let (instant, user) = (index / self.places.len(), index % self.places.len());
        let n = self.outlook.orbits.len();
        let positions = &self.positions[instant * n..(instant + 1) * n];
        sights.clear();
        Arch::new().dispatch(
            #[inline(always)]
            || {
                // A plain loop: an iterator's closure would be compiled for the least processor.
                for (position, constellation) in positions.iter().zip(self.outlook.constellation) {
                    if let Some(sight) = seen(position, *constellation, &self.places[user], self.sin_mask, self.outlook) {
                        sights.push(sight);
                    }
                }
            },
        );
    }
}

/// Levels of every user at every instant by an algorithm of the list: user after user, instant after instant.
///
/// # Errors
/// [`AtIndex`]: the first orbit, instant, user or promise outside its domain.
pub fn predict<A: Algorithm + Send>(outlook: &Outlook<'_>, settings: &A::Settings) -> Result<Vec<Row<A::Detail>>, AtIndex>
where
    A::Settings: Sync,
    A::Detail: Send,
{
    predicted(outlook, || Box::new(A::new(settings)), |algorithm, sights| algorithm.levels(sights))
}

/// Levels by an algorithm of the list, and the numbers beside them in the order in which it names them; NaN where there are no levels.
#[derive(Debug, Clone)]
pub struct Listed {
    /// One a user and instant.
    pub rows: Vec<Row<()>>,
    /// One a number that the algorithm names, each as long as the rows.
    pub numbers: Vec<(&'static str, Vec<f64>)>,
}

/// The same as [`predict`] by the id of an algorithm, with its usual settings; `None` where no algorithm of satellites has the id.
///
/// # Errors
/// As [`predict`].
pub fn predict_by_id(id: &str, outlook: &Outlook<'_>) -> Option<Result<Listed, AtIndex>> {
    with_algorithm(id, Predict(outlook))
}

struct Predict<'a>(&'a Outlook<'a>);

impl Task for Predict<'_> {
    type Output = Result<Listed, AtIndex>;

    fn with<A: Algorithm>(self) -> Self::Output {
        let rows = predict::<A>(self.0, &A::usual())?;
        let number = |k| rows.iter().map(|row| row.levels.as_ref().map_or(f64::NAN, |l| A::number(&l.detail, k))).collect();
        let numbers = A::COLUMNS.iter().enumerate().map(|(k, name)| (*name, number(k))).collect();
        let plain = |l: Levels<A::Detail>| Levels { hpl: l.hpl, vpl: l.vpl, detail: () };
        let rows = rows.into_iter().map(|row| Row { n_sv: row.n_sv, outcome: row.outcome, levels: row.levels.map(plain) });
        Ok(Listed { rows: rows.collect(), numbers })
    }
}

/// The same by anything that makes levels of satellites.
pub(crate) fn predicted<M: Send, D: Send>(
    outlook: &Outlook<'_>,
    make: impl Fn() -> M + Sync + Send,
    levels: impl Fn(&mut M, &[Sight]) -> Result<Levels<D>, NoLevels> + Sync,
) -> Result<Vec<Row<D>>, AtIndex> {
    let overhead = Overhead::new(outlook)?;
    rows(
        overhead.len(),
        || (make(), Vec::new()),
        |(made, sights), index| {
            overhead.put(index, sights);
            Row::of(sights.len(), levels(made, sights))
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

/// Every epoch by chunks on all cores.
pub(crate) fn rows<D: Send, T: Send>(
    n: usize,
    desk: impl Fn() -> D + Sync + Send,
    epoch: impl Fn(&mut D, usize) -> Result<T, OutOfDomain> + Sync,
) -> Result<Vec<T>, AtIndex> {
    let done: Result<Vec<Vec<T>>, AtIndex> =
        parallel::parts(n, EPOCHS_PER_TASK, |span| worked(&mut desk(), span, &epoch)).into_iter().collect();
    Ok(done?.into_iter().flatten().collect())
}

/// A few epochs in this thread, without waking another, at a desk that the caller keeps.
pub(crate) fn at_desk<D, T>(desk: &mut D, n: usize, epoch: impl Fn(&mut D, usize) -> Result<T, OutOfDomain>) -> Result<Vec<T>, AtIndex> {
    worked(desk, 0..n, &epoch)
}

fn worked<D, T>(
    desk: &mut D,
    span: core::ops::Range<usize>,
    epoch: impl Fn(&mut D, usize) -> Result<T, OutOfDomain>,
) -> Result<Vec<T>, AtIndex> {
    span.map(|index| epoch(desk, index).map_err(|error| AtIndex { index, error })).collect()
}
