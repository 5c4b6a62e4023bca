//! RRAIM protection levels of many coasting phases.

use crate::gbas::{Skies, covariance, size_of_bias};
use crate::parallel;
use navbound_core::bound::Sight;
use navbound_core::bound::faults::NoModes;
use navbound_core::bound::gbas::snapshot::{Form, Snapshot};
use navbound_core::bound::level_equation::LevelEquation;
use navbound_core::bound::rraim::coast::{Coast, Followed};
use navbound_core::bound::rraim::modes::Priors;
use navbound_core::bound::rraim::multiple::{Budget, MultipleFaults, NoLevel};
use navbound_core::bound::rraim::single::{Fix, Levels, Multipliers, Settings, SingleFault, Without};
use navbound_core::frame::{Covariance, Enu};
use navbound_core::geometry::Direction;
use navbound_core::quantity::{Metres, Radians, Unavailable};
use navbound_path::AtIndex;

/// Skies in one task of the pool: each takes a tenth of a millisecond and more.
const SKIES_PER_TASK: usize = 4;

/// Skies at the fix, and the same satellites now: both angles NaN for one that was lost.
#[derive(Debug, Clone, Copy)]
pub struct Coasting<'a> {
    /// At the fix.
    pub fix: Skies<'a>,
    /// Azimuth now \[rad\].
    pub az_rad: &'a [f64],
    /// Elevation now \[rad\].
    pub el_rad: &'a [f64],
    /// Standard deviation of each phase differenced over the coasting time \[m\].
    pub sigma_td_m: &'a [f64],
}

/// What levels are requested; each array has one item a sky.
#[derive(Debug, Clone, Copy)]
pub struct Request<'a> {
    /// Largest nominal bias of a range \[m\].
    pub bias_m: &'a [f64],
    /// Covariance of the fix with an inertial system, nine numbers \[m²\].
    pub aided_m2: Option<&'a [f64]>,
    /// Single-fault settings.
    pub single: Settings,
    /// Multi-fault risks.
    pub budget: Budget,
    /// Priors of faults while coasting.
    pub priors: Priors,
}

/// One answer.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// Satellites followed.
    pub n_sv: usize,
    /// Covariance now.
    pub covariance: Covariance<Enu>,
    /// Its larger axis.
    pub major: Metres,
    /// Metres for a metre of bias.
    pub gain: f64,
    /// Accuracy, 95 %.
    pub accuracy: Metres,
    /// Single-fault levels.
    pub single: Levels,
    /// Multi-fault levels east, north and horizontal.
    pub multiple: Result<[Metres; 3], NoLevel>,
    /// Modes monitored.
    pub n_modes: usize,
    /// Probability of faults that are not.
    pub not_monitored: f64,
    /// Each followed satellite away: its column, what follows, and the separation above which it is held to be faulty.
    pub without: Vec<(usize, Without, Metres)>,
}

/// What is large and made once for a thread.
#[derive(Debug, Default)]
pub struct Room {
    multiple: MultipleFaults,
    equation: LevelEquation,
    /// Why the faults of the phase at hand could not be listed.
    refused: Option<NoModes>,
}

impl Room {
    /// Work out every fault mode of a phase.
    ///
    /// # Errors
    /// [`Unavailable`] as [`MultipleFaults::fill`].
    pub fn fill(&mut self, fix: &Fix<'_>, coast: &Coast, priors: &Priors) -> Result<(), Unavailable> {
        match priors.modes(coast) {
            Ok(modes) => {
                self.refused = None;
                self.multiple.fill(fix, coast, &modes)
            }
            Err(why) => {
                self.refused = Some(why);
                Ok(())
            }
        }
    }

    /// Levels east, north and horizontal of that phase.
    ///
    /// # Errors
    /// [`NoLevel`].
    pub fn levels(&mut self, bias: Metres, budget: &Budget) -> Result<[Metres; 3], NoLevel> {
        self.refused.map_or(Ok(()), Err)?;
        self.multiple.levels(bias, budget, &mut self.equation)
    }

    /// Modes monitored, and the probability of faults that are not.
    pub fn monitored(&self) -> (usize, f64) {
        if self.refused.is_some() { (0, 1.0) } else { (self.multiple.len(), self.multiple.not_monitored()) }
    }
}

/// Levels of every coasting phase.
///
/// # Errors
/// [`AtIndex`] for the first number outside its domain.
pub fn protection_levels(coasting: &Coasting<'_>, request: &Request<'_>) -> Result<Vec<Result<Answer, Unavailable>>, AtIndex> {
    parallel::map_with(coasting.fix.len(), SKIES_PER_TASK, Room::default, |room, sky| one(coasting, request, sky, room))
        .into_iter()
        .collect()
}

/// Satellites of a sky that were followed until now, by their columns.
///
/// # Errors
/// [`AtIndex`] with the place in the arrays.
pub fn followed(coasting: &Coasting<'_>, sky: usize, ranges: &[(usize, Sight)]) -> Result<Vec<(usize, Followed)>, AtIndex> {
    let width = coasting.fix.constellation.len();
    let mut kept = Vec::with_capacity(ranges.len());
    for (column, range) in ranges {
        let index = sky * width + column;
        let (az, el) = (coasting.az_rad[index], coasting.el_rad[index]);
        if az.is_nan() && el.is_nan() {
            continue;
        }
        let now = Direction::new(Radians::new(az), Radians::new(el)).map_err(|error| AtIndex { index, error })?.unit();
        let sigma = Metres::new(coasting.sigma_td_m[index]);
        kept.push((*column, Followed { before: range.unit, now, constellation: range.constellation, sigma }));
    }
    Ok(kept)
}

fn one(coasting: &Coasting<'_>, request: &Request<'_>, sky: usize, room: &mut Room) -> Result<Result<Answer, Unavailable>, AtIndex> {
    let at = |error| AtIndex { index: sky, error };
    let ranges = coasting.fix.ranges(sky)?;
    let kept = followed(coasting, sky, &ranges)?;
    let plain: Vec<Followed> = kept.iter().map(|k| k.1).collect();
    let coast = Coast::new(&plain).map_err(at)?;
    let bias = size_of_bias(request.bias_m[sky]).map_err(at)?;
    let aided = request.aided_m2.map(|all| covariance(all, sky)).transpose().map_err(at)?;
    let snapshot = match Snapshot::new(&ranges.iter().map(|r| r.1).collect::<Vec<_>>()) {
        Ok(snapshot) => snapshot,
        Err(why) => return Ok(Err(why)),
    };
    let form: Form = request.single.form;
    let fix = aided.map_or_else(|| Fix::of(&snapshot), |p| Fix::aided(&snapshot, p, form));
    let single = match SingleFault::new(&fix, &coast, form, request.single.ordering) {
        Ok(single) => single,
        Err(why) => return Ok(Err(why)),
    };
    if let Err(why) = room.fill(&fix, &coast, &request.priors) {
        return Ok(Err(why));
    }
    let biased = request.single.biased_threshold;
    let multipliers = Multipliers::new(&request.single, coast.len(), request.priors.of_satellites(&coast)).map_err(at)?;
    let (n_modes, not_monitored) = room.monitored();
    Ok(Ok(Answer {
        n_sv: coast.len(),
        covariance: *single.covariance(),
        major: single.major(),
        gain: single.gain(),
        accuracy: single.accuracy(bias),
        single: single.levels(bias, Metres::new(0.0), &multipliers, biased),
        multiple: room.levels(bias, &request.budget),
        n_modes,
        not_monitored,
        without: kept.iter().zip(single.without()).map(|(k, w)| (k.0, *w, multipliers.threshold(w, bias, biased))).collect(),
    }))
}
