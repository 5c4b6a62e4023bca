//! Observations and navigation messages to positions, epoch by epoch on all cores.

use crate::receivers::ranges::{Records, Source, Tally, Unused, plans};
use crate::receivers::signals::Plan;
pub use crate::receivers::signals::Signals;
use crate::smoothing::{self, Form, Smoothed};
use navbound_core::bound::araim::ranging::Beyond;
use navbound_core::frame::{Covariance, ecef_from_geodetic};
use navbound_core::quantity::{GpsTime, Unavailable};
use navbound_core::signal::smoothing::Smoothing;
use navbound_core::signal::{Constellation, SatelliteId};
use navbound_core::solution::Surroundings;
use navbound_core::solution::point::{self, Fix, Range, Settings, Used};
use navbound_formats::precise::Precise;
use navbound_formats::rinex::{Navigation, Observations};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Epochs in one task of the pool: about 0.5 ms of work. The first of them begins from nothing, each other from the position before it,
/// so results depend on this number (by less than 2 mm) and not on the number of threads.
const EPOCHS_PER_TASK: usize = 32;
const SYSTEMS: usize = Constellation::ALL.len();

/// What to solve.
#[derive(Debug, Clone)]
pub struct Job {
    /// Constellations to use; GPS, Galileo and BeiDou can be.
    pub systems: Vec<Constellation>,
    /// Which pseudoranges.
    pub signals: Signals,
    /// Carrier smoothing of the pseudoranges, or none: its form and time constant.
    pub smoothing: Option<(Form, Smoothing)>,
    /// How.
    pub settings: Settings,
    /// Whether the ranges of each position are kept.
    pub keep_ranges: bool,
}

/// What came of a day, or an hour.
#[derive(Debug, Clone, Default)]
pub struct Positions {
    /// One outcome an epoch. Where surroundings contradict the weights the covariance is widened by what that says.
    pub fixes: Vec<Result<Fix, Unavailable>>,
    /// Whether they do, by epoch.
    pub contradicted: Vec<bool>,
    /// The ranges of each position, where they are kept; weights and shared errors widened as the covariance is.
    pub ranges: Vec<Vec<(SatelliteId, Used)>>,
    /// Satellite-epochs of the wanted constellations that were used, and that were not.
    pub tally: Tally,
    /// Signals of each constellation.
    pub signals: BTreeMap<char, &'static str>,
    /// Pseudoranges that were used, by constellation: codes in order of preference that the file has.
    pub codes: BTreeMap<char, Vec<String>>,
    /// Share of the pseudoranges that the carrier smoothed, those at the beginning of an arc left out; `None` without smoothing.
    pub smoothed_share: Option<f64>,
}

/// Positions of every epoch, with broadcast orbits and clocks or `precise` ones; health and group delays are always those broadcast.
pub fn positions(observations: &Observations, navigation: &Navigation, precise: Option<&Precise>, job: &Job) -> Positions {
    let records = Records::new(navigation, precise);
    let plans = plans(observations, &records, &job.systems, job.signals);
    let smoothed = smoothed(observations, &plans, job);
    let source = Source { observations, smoothed: smoothed.as_ref(), records: &records, plans: &plans };
    let epochs: Vec<usize> = (0..observations.n_epochs()).collect();
    let task = |epochs: &[usize]| {
        let (mut ranges, mut beyond, mut last, mut tally) = (Vec::new(), Vec::new(), None, Tally::default());
        let (mut fixes, mut kept) = (Vec::with_capacity(epochs.len()), Vec::new());
        for epoch in epochs {
            source.collect(*epoch, &mut ranges, &mut beyond, &mut tally);
            let time = observations.time[*epoch];
            let fix = if job.keep_ranges {
                let mut used = Vec::with_capacity(ranges.len());
                let tell = |u: Used| used.push((ranges[u.index].satellite, u));
                let fix = point::solve_telling(&ranges, time, &job.settings, last.as_ref(), tell);
                kept.push(used);
                fix
            } else {
                point::solve_near(&ranges, time, &job.settings, last.as_ref())
            };
            let n_low = fix.as_ref().map_or(0, |f| ranges.len().saturating_sub(f.n_used + f.n_excluded));
            tally.leave(Unused::BelowMask, n_low);
            last = fix.as_ref().ok().map(|f: &Fix| ecef_from_geodetic(&f.position)).or(last);
            fixes.push(fix);
        }
        (fixes, kept, tally)
    };
    let outcomes: Vec<_> = epochs.par_chunks(EPOCHS_PER_TASK).map(task).collect();
    let smoothed_share = smoothed.as_ref().map(Smoothed::share);
    let mut found = Positions { codes: codes(&plans, observations), signals: names(&plans), smoothed_share, ..Positions::default() };
    for (fixes, kept, tally) in outcomes {
        found.fixes.extend(fixes);
        found.ranges.extend(kept);
        found.tally.add(&tally);
    }
    // The ranges are widened by all that their position was: by its own residuals, and by its surroundings.
    let own: Vec<f64> = found.fixes.iter().map(|f| f.as_ref().map_or(1.0, |f| f.inflation)).collect();
    found.contradicted = widen(&observations.time, &mut found.fixes);
    for ((used, fix), own) in found.ranges.iter_mut().zip(&found.fixes).zip(own) {
        let whole = fix.as_ref().map_or(1.0, |f| f.inflation);
        for (_, u) in used {
            u.weight /= whole;
            u.shared_m *= (whole / own).sqrt();
        }
    }
    found
}

/// What a monitor made of a receiver's epochs.
#[derive(Debug, Clone)]
pub struct Watch<T> {
    /// One an epoch.
    pub epochs: Vec<T>,
    /// Satellite-epochs that were used, and that were not.
    pub tally: Tally,
    /// Signals of each constellation.
    pub signals: BTreeMap<char, &'static str>,
    /// Share of the pseudoranges that the carrier smoothed; `None` without smoothing.
    pub smoothed_share: Option<f64>,
}

/// What `each` makes of every epoch's ranges, with what each range has beyond a smoothed one; it counts what it leaves. `desk` makes what a
/// task keeps from one epoch to the next; results must not depend on it.
pub fn each_epoch<D, T: Send>(
    observations: &Observations,
    navigation: &Navigation,
    job: &Job,
    desk: impl Fn() -> D + Sync + Send,
    each: impl Fn(&mut D, GpsTime, (&[Range], &[Beyond]), &mut Tally) -> T + Sync + Send,
) -> Watch<T> {
    let records = Records::new(navigation, None);
    let plans = plans(observations, &records, &job.systems, job.signals);
    let smoothed = smoothed(observations, &plans, job);
    let source = Source { observations, smoothed: smoothed.as_ref(), records: &records, plans: &plans };
    let task = |epochs: &[usize]| {
        let (mut desk, mut ranges, mut beyond, mut tally) = (desk(), Vec::new(), Vec::new(), Tally::default());
        let one = |epoch: &usize| {
            source.collect(*epoch, &mut ranges, &mut beyond, &mut tally);
            each(&mut desk, observations.time[*epoch], (&ranges, &beyond), &mut tally)
        };
        let results: Vec<T> = epochs.iter().map(one).collect();
        (results, tally)
    };
    let epochs: Vec<usize> = (0..observations.n_epochs()).collect();
    let outcomes: Vec<_> = epochs.par_chunks(EPOCHS_PER_TASK).map(task).collect();
    let smoothed_share = smoothed.as_ref().map(Smoothed::share);
    let mut watch = Watch { epochs: Vec::with_capacity(epochs.len()), tally: Tally::default(), signals: names(&plans), smoothed_share };
    for (results, tally) in outcomes {
        watch.epochs.extend(results);
        watch.tally.add(&tally);
    }
    watch
}

/// The pseudoranges that the plans use, smoothed as the job says.
fn smoothed(observations: &Observations, plans: &[Option<Plan>; SYSTEMS], job: &Job) -> Option<Smoothed> {
    let (form, how) = job.smoothing?;
    let codes = plans.each_ref().map(|plan| plan.iter().flat_map(Plan::codes).collect());
    Some(smoothing::smooth(observations, &codes, form, &how))
}

/// Signals of each constellation.
fn names(plans: &[Option<Plan>; SYSTEMS]) -> BTreeMap<char, &'static str> {
    Constellation::ALL.into_iter().filter_map(|c| Some((c.letter(), plans[c.index()].as_ref()?.choice.name))).collect()
}

/// Covariances by the surroundings of each epoch's past minute, which are followed through the file in its order.
fn widen(times: &[GpsTime], fixes: &mut [Result<Fix, Unavailable>]) -> Vec<bool> {
    let mut surroundings = Surroundings::default();
    let follow = |(time, fix): (&GpsTime, &mut Result<Fix, Unavailable>)| {
        let Ok(fix) = fix else { return false };
        let Some(factor) = surroundings.judge(*time, fix) else { return false };
        if factor > fix.inflation {
            fix.covariance = Covariance::claim_symmetric(fix.covariance.matrix() * (factor / fix.inflation));
            fix.inflation = factor;
        }
        true
    };
    times.iter().zip(fixes).map(follow).collect()
}

pub(crate) fn earlier(time: GpsTime, seconds: f64) -> GpsTime {
    GpsTime::from_nanoseconds(time.nanoseconds().saturating_sub((seconds * 1e9) as i64))
}

fn codes(plans: &[Option<Plan>; SYSTEMS], observations: &Observations) -> BTreeMap<char, Vec<String>> {
    let name = |c: Constellation, k: usize| String::from_utf8_lossy(&observations.codes[c.index()][k]).into_owned();
    let all = Constellation::ALL.into_iter().filter_map(|c| Some((c, plans[c.index()].as_ref()?)));
    all.map(|(c, plan)| (c.letter(), plan.codes().map(|k| name(c, k)).collect())).collect()
}
