//! RAIM of many epochs by the slope method: geometry given, users and orbits, or a receiver's file.

use crate::araim::squared;
use crate::araim_watch::{Rules, Taken, taken};
use crate::outlook::{self, Outcome, Outlook, Promise, refusal, rows};
use crate::positions::{Job, Watch, each_epoch};
use crate::receivers::heard::{Judged, Residuals};
use crate::receivers::ranges::Tally;
use nalgebra::Vector3;
use navbound_core::bound::araim::exclusion::Decision;
use navbound_core::bound::araim::ranging::Beyond;
use navbound_core::bound::raim::exclusion::Monitored;
use navbound_core::bound::raim::{Detail, Monitor, Requirement};
use navbound_core::bound::{Algorithm, Levels, Sight};
use navbound_core::frame::{Displacement, Geodetic};
use navbound_core::quantity::{GpsTime, Metres, OutOfDomain, Reason, Unavailable};
use navbound_core::signal::{Constellation, SatelliteId};
use navbound_core::solution::point::Range;
use navbound_formats::rinex::{Navigation, Observations};
use navbound_path::AtIndex;

/// Satellites in many solutions: rows are epochs, columns satellites; one whose line of sight is NaN is not used.
#[derive(Debug, Clone, Copy)]
pub struct Sights<'a> {
    /// East, north, up of each unit vector, three numbers a satellite.
    pub unit_enu: &'a [f64],
    /// Standard deviation of each range \[m\].
    pub sigma_m: &'a [f64],
    /// Constellation of each column.
    pub constellation: &'a [Constellation],
}

impl Sights<'_> {
    /// Epochs.
    pub fn len(&self) -> usize {
        self.sigma_m.len().checked_div(self.constellation.len()).unwrap_or(0)
    }
    /// None.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// One epoch's result: levels of detection, and beside them those after exclusion.
pub type Row = outlook::Row<(Detail, Levels)>;

/// One epoch after detection and exclusion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tested {
    /// Geometry before exclusion.
    pub before: Row,
    /// Whether there are levels of what is left.
    pub outcome: Outcome,
    /// Decision and levels.
    pub monitored: Option<Monitored>,
    /// Column of the excluded satellite.
    pub excluded: Option<usize>,
}

/// What a thread keeps from epoch to epoch.
struct Desk {
    monitor: Box<Monitor>,
    sights: Vec<Sight>,
    columns: Vec<usize>,
    residuals: Vec<f64>,
}

impl Desk {
    fn new(requirement: &Requirement) -> Self {
        Self { monitor: Box::new(Monitor::new(requirement)), sights: Vec::new(), columns: Vec::new(), residuals: Vec::new() }
    }

    /// Take up a row's satellites, and their residuals where there are any.
    fn take(&mut self, sights: &Sights<'_>, row: usize, residual_m: &[f64]) {
        self.sights.clear();
        self.columns.clear();
        self.residuals.clear();
        for (column, constellation) in sights.constellation.iter().enumerate() {
            let i = row * sights.constellation.len() + column;
            let unit = Vector3::new(sights.unit_enu[3 * i], sights.unit_enu[3 * i + 1], sights.unit_enu[3 * i + 2]);
            if unit.iter().all(|x| x.is_nan()) {
                continue;
            }
            self.sights.push(Sight::plain(unit, *constellation, squared(sights.sigma_m[i])));
            self.columns.push(column);
            self.residuals.extend(residual_m.get(i));
        }
    }

    fn levels(&mut self) -> Result<Row, OutOfDomain> {
        Row::of(self.sights.len(), Algorithm::levels(&mut *self.monitor, &self.sights))
    }

    fn tested(&mut self) -> Result<Tested, OutOfDomain> {
        let before = self.levels()?;
        match self.monitor.monitored(&self.sights, &self.residuals) {
            Ok(monitored) => {
                let excluded = monitored.excluded.and_then(|i| self.columns.get(i).copied());
                Ok(Tested { before, outcome: Outcome::of(&monitored.levels), monitored: Some(monitored), excluded })
            }
            Err(e) => refusal(e.into()).map_or_else(|outcome| Ok(Tested { before, outcome, monitored: None, excluded: None }), Err),
        }
    }
}

/// Levels of every epoch.
///
/// # Errors
/// [`AtIndex`]: the first epoch with a number outside its domain.
pub fn levels(sights: &Sights<'_>, requirement: &Requirement) -> Result<Vec<Row>, AtIndex> {
    rows(
        sights.len(),
        || Desk::new(requirement),
        |desk, row| {
            desk.take(sights, row, &[]);
            desk.levels()
        },
    )
}

/// Detection and exclusion at every epoch: `residual_m` holds measured less computed ranges, one a satellite.
///
/// # Errors
/// As [`levels`], and for a residual of a satellite in use that is no number.
pub fn monitored(sights: &Sights<'_>, residual_m: &[f64], requirement: &Requirement) -> Result<Vec<Tested>, AtIndex> {
    rows(
        sights.len(),
        || Desk::new(requirement),
        |desk, row| {
            desk.take(sights, row, residual_m);
            desk.tested()
        },
    )
}

/// Levels of every user at every instant: user after user, instant after instant.
///
/// # Errors
/// [`AtIndex`]: the first orbit, instant, user or promise outside its domain.
pub fn predict(outlook: &Outlook<'_>, requirement: &Requirement) -> Result<Vec<Row>, AtIndex> {
    outlook::predict::<Monitor>(outlook, requirement)
}

/// One epoch of a receiver's file.
#[derive(Debug, Clone)]
pub struct Watched {
    /// The position with the satellites that are left.
    pub position: Geodetic,
    /// The satellite excluded.
    pub excluded: Option<SatelliteId>,
    /// Decision and levels.
    pub tested: Tested,
    /// Residuals of all satellites.
    pub residuals: Residuals,
}

impl Watched {
    fn judged(&self) -> Judged<'_> {
        Judged {
            position: &self.position,
            residuals: &self.residuals,
            step_m: self.tested.monitored.map_or([0.0; 3], |m| m.step.map(Metres::m)),
            excluded: self.excluded.as_slice(),
        }
    }
}

/// Why an epoch's position, or its level, is not simply there.
pub fn reason(watched: &Result<Watched, Unavailable>) -> Option<Reason> {
    let tested = match watched {
        Err(why) => return Some(why.reason_of_solution()),
        Ok(watched) => &watched.tested,
    };
    match tested.monitored.as_ref().map(|m| m.decision) {
        Some(Decision::NotExcluded) => Some(Reason::FaultNotExcluded),
        Some(Decision::Excluded) => Some(Reason::FaultExcluded),
        Some(Decision::Nothing) if tested.outcome == Outcome::NotMonitored => Some(Reason::FaultNotDetectable),
        Some(Decision::Nothing) | None => tested.outcome.reason(),
    }
}

/// Every epoch of a receiver's file: position by least squares without any exclusion of its own, then residuals there, test, exclusion,
/// levels. The position of the result is that of RAIM's weights.
pub fn watch(
    observations: &Observations,
    navigation: &Navigation,
    job: &Job,
    promise: &Promise,
    requirement: &Requirement,
) -> Watch<Result<Watched, Unavailable>> {
    let desk = || Desk::new(requirement);
    let rules = Rules { job, promise };
    let each = |desk: &mut Desk, time, ranges: (&[Range], &[Beyond]), tally: &mut Tally| epoch(desk, time, ranges, tally, &rules);
    each_epoch(observations, navigation, job, desk, each, |watched| watched.as_ref().ok().map(Watched::judged))
}

fn epoch(
    desk: &mut Desk,
    time: GpsTime,
    ranges: (&[Range], &[Beyond]),
    tally: &mut Tally,
    rules: &Rules<'_>,
) -> Result<Watched, Unavailable> {
    let Taken { fix, residuals } = taken(ranges, time, rules, &mut desk.sights, tally)?;
    desk.columns = (0..desk.sights.len()).collect();
    desk.residuals.clone_from(&residuals.residuals_m);
    let tested = desk.tested().map_err(Unavailable::from)?;
    let position = match tested.monitored {
        Some(Monitored { step: [east, north, up], .. }) => fix.position.moved(&Displacement::new(east, north, up))?,
        None => fix.position,
    };
    let excluded = tested.excluded.and_then(|i| residuals.compared.get(i).map(|c| c.satellite));
    Ok(Watched { position, excluded, tested, residuals })
}
