//! ARAIM on recorded observations: every epoch's ranges tested, wrong satellites excluded, levels of what is left.

use crate::araim::Desk;
use crate::outlook::{Outcome, Promise};
use crate::positions::{Job, Watch, each_epoch};
use crate::receivers::heard::{Judged, Residuals};
use crate::receivers::ranges::{Tally, Unused};
use navbound_core::bound::araim::exclusion::{Decision, Monitored};
use navbound_core::bound::araim::modes::MOST_SATELLITES;
use navbound_core::bound::araim::ranging::Beyond;
use navbound_core::bound::araim::service::Service;
use navbound_core::bound::{NoLevels, Sight};
use navbound_core::frame::{Displacement, Geodetic};
use navbound_core::quantity::{GpsTime, Metres, Reason, Unavailable};
use navbound_core::signal::SatelliteId;
use navbound_core::solution::consistency::Consistency;
use navbound_core::solution::led_off::Compared;
use navbound_core::solution::point::{self, Fix, MOST_RANGES, Range, sighted};
use navbound_formats::rinex::{Navigation, Observations};

/// One epoch.
#[derive(Debug, Clone)]
pub struct Watched {
    /// The position with the satellites that are left, weighted for integrity.
    pub position: Geodetic,
    /// Who was excluded.
    pub excluded: Vec<SatelliteId>,
    /// Decision and levels.
    pub monitored: Monitored,
    /// Residuals of all satellites.
    pub residuals: Residuals,
}

impl Watched {
    fn judged(&self) -> Judged<'_> {
        Judged {
            position: &self.position,
            residuals: &self.residuals,
            step_m: self.monitored.step.map(Metres::m),
            excluded: &self.excluded,
        }
    }
}

/// Why an epoch's position, or its level, is not simply there.
pub fn reason(watched: &Result<Watched, NoLevels>) -> Option<Reason> {
    match watched {
        Err(why) => Some(why.reason()),
        Ok(watched) => match watched.monitored.decision {
            Decision::NotExcluded => Some(Reason::FaultNotExcluded),
            Decision::Excluded => Some(Reason::FaultExcluded),
            Decision::Nothing => Outcome::of(&watched.monitored.levels).reason(),
        },
    }
}

/// Every epoch of a receiver's file: position by least squares without any exclusion of its own, then residuals there, tests, exclusion,
/// levels. The position of the result is that of the integrity weights.
pub fn watch(
    observations: &Observations,
    navigation: &Navigation,
    job: &Job,
    promise: &Promise,
    service: &Service,
) -> Watch<Result<Watched, NoLevels>> {
    each_epoch(
        observations,
        navigation,
        job,
        || Desk::new(promise.support.map(|s| s.p_const), true),
        |desk, time, ranges, tally| epoch(desk, time, ranges, tally, &Rules { job, promise }, service),
        |watched| watched.as_ref().ok().map(Watched::judged),
    )
}

/// Ranges of an epoch as a monitor takes them.
pub(crate) struct Taken {
    /// Least squares of all ranges, nothing excluded.
    pub(crate) fix: Fix,
    /// Measured less computed ranges there, one a line of sight.
    pub(crate) residuals: Residuals,
}

/// What a monitor believes of ranges.
pub(crate) struct Rules<'a> {
    pub(crate) job: &'a Job,
    pub(crate) promise: &'a Promise,
}

/// The position of an epoch's ranges, its lines of sight into `sights`, and its residuals; ranges below the mask are counted.
///
/// # Errors
/// [`Unavailable`]: no position.
pub(crate) fn taken(
    (ranges, beyond): (&[Range], &[Beyond]),
    time: GpsTime,
    rules: &Rules<'_>,
    sights: &mut Vec<Sight>,
    tally: &mut Tally,
) -> Result<Taken, Unavailable> {
    let settings = &rules.job.settings;
    let fix = point::solve(ranges, time, settings)?;
    sights.clear();
    let (mut residuals_m, mut compared) = (Vec::new(), Vec::new());
    for seen in sighted(ranges, time, settings, &fix.position).take(MOST_RANGES) {
        let satellite = ranges[seen.index].satellite;
        residuals_m.push(seen.residual.m());
        let sight = rules.promise.sight_beyond(seen.unit, satellite.constellation, &beyond[seen.index]);
        compared.push(Compared { satellite, unit: sight.unit, weight: 1.0 / sight.accuracy_m2 });
        sights.push(sight);
    }
    tally.leave(Unused::BelowMask, ranges.len() - sights.len());
    let consistency = Consistency::of(sights.iter().map(Sight::weighted_for_accuracy).zip(residuals_m.iter().copied())).ok();
    Ok(Taken { fix, residuals: Residuals { compared, residuals_m, consistency } })
}

fn epoch(
    desk: &mut Desk,
    time: GpsTime,
    ranges: (&[Range], &[Beyond]),
    tally: &mut Tally,
    rules: &Rules<'_>,
    service: &Service,
) -> Result<Watched, NoLevels> {
    let Taken { fix, residuals } = taken(ranges, time, rules, &mut desk.sights, tally)?;
    let monitored = desk.monitored(&residuals.residuals_m, service)?;
    let [east, north, up] = monitored.step;
    let position = fix.position.moved(&Displacement::new(east, north, up)).map_err(Unavailable::from)?;
    let out = |i: usize| i < MOST_SATELLITES && monitored.excluded >> i & 1 == 1;
    let excluded = residuals.compared.iter().enumerate().filter(|(i, _)| out(*i)).map(|(_, c)| c.satellite).collect();
    Ok(Watched { position, excluded, monitored, residuals })
}
