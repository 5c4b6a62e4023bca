//! ARAIM on recorded observations: every epoch's ranges tested, wrong satellites excluded, levels of what is left.

use crate::araim::{Desk, Promise};
use crate::positions::{Job, each_epoch};
use navbound_core::bound::araim::exclusion::{Monitored, NoLevels};
use navbound_core::bound::araim::modes::MOST_SATELLITES;
use navbound_core::bound::araim::service::Service;
use navbound_core::frame::{Displacement, Geodetic};
use navbound_core::quantity::{GpsTime, Unavailable};
use navbound_core::signal::SatelliteId;
use navbound_core::solution::point::{self, MOST_RANGES, Range, sighted};
use navbound_formats::rinex::{Navigation, Observations};

/// One epoch.
#[derive(Debug, Clone)]
pub struct Watched {
    /// The position with the satellites that are left, weighted for integrity.
    pub position: Geodetic,
    /// Satellites before exclusion.
    pub n_sv: usize,
    /// Who was excluded.
    pub excluded: Vec<SatelliteId>,
    /// Decision and levels.
    pub monitored: Monitored,
}

/// Every epoch of a receiver's file: position by least squares without any exclusion of its own, then residuals there, tests, exclusion,
/// levels. The position of the result is that of the integrity weights.
pub fn watch(
    observations: &Observations,
    navigation: &Navigation,
    job: &Job,
    promise: &Promise,
    service: &Service,
) -> Vec<Result<Watched, NoLevels>> {
    each_epoch(
        observations,
        navigation,
        job,
        || Desk::new(promise.support.map(|s| s.p_const), true),
        |desk, time, ranges| epoch(desk, time, ranges, job, promise, service),
    )
}

fn epoch(desk: &mut Desk, time: GpsTime, ranges: &[Range], job: &Job, promise: &Promise, service: &Service) -> Result<Watched, NoLevels> {
    let fix = point::solve(ranges, time, &job.settings)?;
    desk.sights.clear();
    let (mut residuals, mut names) = ([0.0; MOST_RANGES], Vec::new());
    for (slot, seen) in residuals.iter_mut().zip(sighted(ranges, time, &job.settings, &fix.position)) {
        let satellite = ranges[seen.index].satellite;
        *slot = seen.residual.m();
        names.push(satellite);
        desk.sights.push(promise.sight(seen.unit, satellite.constellation));
    }
    let monitored = desk.monitored(&residuals[..names.len()], service)?;
    let [east, north, up] = monitored.step;
    let position = fix.position.moved(&Displacement::new(east, north, up)).map_err(Unavailable::from)?;
    let out = |i: usize| i < MOST_SATELLITES && monitored.excluded >> i & 1 == 1;
    let excluded = names.iter().enumerate().filter(|(i, _)| out(*i)).map(|(_, s)| *s).collect();
    Ok(Watched { position, n_sv: names.len(), excluded, monitored })
}
