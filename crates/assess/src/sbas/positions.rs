//! A receiver's own positions with a service's corrections, each with the levels of that very solution, epoch by epoch on all cores.

use super::{Feed, Listener, Orbits, Settings};
use crate::parallel;
use crate::positions::earlier;
use crate::smoothing::{self, Form, Smoothed};
use core::ops::Range;
use navbound_core::bound::sbas::position::{Measurement, Receiver, Solution, solve};
use navbound_core::bound::sbas::service::{Service, ranging};
use navbound_core::bound::sbas::{NoLevel, Sky};
use navbound_core::frame::{EcefPosition, ecef_from_geodetic};
use navbound_core::geometry::broadcast::clock_polynomial;
use navbound_core::quantity::{GpsTime, Metres, Reason};
use navbound_core::signal::sbas::Store;
use navbound_core::signal::sbas::timeout::Use;
use navbound_core::signal::smoothing::Smoothing;
use navbound_core::signal::{Carrier, Constellation, SPEED_OF_LIGHT_MPS};
use navbound_formats::rinex::{Navigation, Observations};
use std::collections::BTreeMap;

/// Fewest epochs of a task: below, replaying the messages costs more than the second core saves.
const LEAST_TASK: usize = 512;
/// The signal that services correct: C/A on L1.
const CODE: &[u8; 3] = b"C1C";
/// This URA index of message 9 forbids ranging (standard).
const URA_DO_NOT_USE: u8 = 15;

/// One satellite of a solution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Used {
    /// PRN code number.
    pub prn: u8,
    /// Azimuth, clockwise from true north \[rad\].
    pub az_rad: f64,
    /// Elevation \[rad\].
    pub el_rad: f64,
    /// Measured less modelled range \[m\].
    pub residual_m: f64,
    /// By the error model \[m\].
    pub sigma_m: f64,
    /// Its ionosphere is the service's, not the broadcast model's.
    pub from_grid: bool,
}

/// An epoch's solution and what it rests on.
#[derive(Debug, Clone, PartialEq)]
pub struct Fix {
    /// Position, covariance, levels.
    pub solution: Solution,
    /// What the levels are good for.
    pub used_for: Use,
    /// Satellites used.
    pub satellites: Vec<Used>,
}

/// Why an epoch's position is not simply there; the residuals are tested at a risk of a false alarm.
pub fn reason(fix: &Result<Fix, NoLevel>, false_alarm: f64) -> Option<Reason> {
    match fix {
        Ok(fix) if fix.solution.residual_risk < false_alarm => Some(Reason::ServiceResidualsContradict),
        Ok(_) => None,
        Err(why) => Some(why.reason()),
    }
}

/// What came of a recording.
#[derive(Debug, Clone, Default)]
pub struct Corrected {
    /// One outcome an epoch.
    pub fixes: Vec<Result<Fix, NoLevel>>,
    /// Satellite-epochs of GPS and of the geostationary satellites that were not used, by reason, those below the mask left out.
    pub unused: BTreeMap<String, usize>,
    /// Share of the pseudoranges that the carrier smoothed, those that begin an arc left out; `None` without smoothing.
    pub smoothed_share: Option<f64>,
}

/// Positions of every epoch; `smoothing` by each code's own carrier, as the standard's receiver does.
pub fn positions(
    feed: &Feed,
    navigation: &Navigation,
    observations: &Observations,
    settings: &Settings,
    smoothing: Option<&Smoothing>,
) -> Corrected {
    let code = observations.column(Constellation::Gps, CODE);
    let smoothed = smoothing.map(|how| {
        let mut codes: [Vec<usize>; Constellation::ALL.len()] = Default::default();
        codes[Constellation::Gps.index()].extend(code);
        smoothing::smooth(observations, &codes, Form::Single, how)
    });
    let orbits = Orbits::new(navigation);
    let n = observations.n_epochs();
    let size = n.div_ceil(parallel::threads()).max(LEAST_TASK);
    let work = |part: Range<usize>| {
        let listener = Listener::new(feed, settings.obedience, orbits.klobuchar);
        let table = Table { observations, smoothed: smoothed.as_ref(), code };
        let mut task = Task { listener, orbits: &orbits, settings, table, last: None, sky: Sky::default(), unused: BTreeMap::new() };
        let fixes: Vec<_> = part.map(|epoch| task.epoch(epoch)).collect();
        (fixes, task.unused)
    };
    let parts = parallel::parts(n, size, work);
    let mut corrected = Corrected { smoothed_share: smoothed.as_ref().map(Smoothed::share), ..Corrected::default() };
    for (fixes, unused) in parts {
        corrected.fixes.extend(fixes);
        for (why, n) in unused {
            *corrected.unused.entry(why).or_default() += n;
        }
    }
    corrected
}

/// What the receiver recorded.
struct Table<'a> {
    observations: &'a Observations,
    smoothed: Option<&'a Smoothed>,
    code: Option<usize>,
}

impl Table<'_> {
    /// PRN code numbers of an epoch's GPS satellites, with their pseudorange \[m\] where they have one.
    fn ranges(&self, epoch: usize) -> impl Iterator<Item = (u8, Option<f64>)> + '_ {
        let o = self.observations;
        let gps = o.satellites(epoch).filter(|k| o.satellite[*k].constellation == Constellation::Gps);
        gps.map(move |k| {
            let values = self.smoothed.map_or_else(|| o.values(k), |s| s.values(o, k));
            let range = self.code.and_then(|c| values.get(c)).copied().filter(|p| *p > 0.0);
            (o.satellite[k].number, range)
        })
    }

    fn geostationary(&self, epoch: usize) -> usize {
        let o = self.observations;
        o.satellites(epoch).filter(|k| o.satellite[*k].constellation == Constellation::Sbas).count()
    }
}

/// One core's share of the epochs, in the order of time.
struct Task<'a> {
    listener: Listener<'a>,
    orbits: &'a Orbits,
    settings: &'a Settings,
    table: Table<'a>,
    last: Option<EcefPosition>,
    sky: Sky,
    unused: BTreeMap<String, usize>,
}

impl Task<'_> {
    fn epoch(&mut self, epoch: usize) -> Result<Fix, NoLevel> {
        let now = self.table.observations.time[epoch];
        self.listener.listen(now);
        let (first, second) = self.settings.mode.uses();
        let mut outcome = self.attempt(first, epoch, now);
        let mut used_for = first;
        if let Some(second) = second.filter(|_| outcome.is_err()) {
            outcome = self.attempt(second, epoch, now);
            used_for = second;
        }
        self.count_unused(used_for, epoch, now, outcome.as_ref().ok());
        if let Ok(fix) = &outcome {
            self.last = Some(ecef_from_geodetic(&fix.solution.position));
        }
        outcome
    }

    fn attempt(&mut self, used_for: Use, epoch: usize, now: GpsTime) -> Result<Fix, NoLevel> {
        let service = self.listener.service(used_for, now, self.orbits);
        let ranges = self.table.ranges(epoch);
        let measured: Vec<Measurement<'_>> =
            ranges.filter_map(|(prn, range)| measurement(service, self.orbits, prn, range?, now)).collect();
        let (mask, airborne) = (self.settings.mask, self.settings.airborne);
        let near = Receiver { mask, airborne, near: self.last };
        // A receiver that was moved while it was off is not near its last position.
        let solution = solve(service, &measured, &near, &mut self.sky)
            .or_else(|_| solve(service, &measured, &Receiver { near: None, ..near }, &mut self.sky))?;
        let used = self.sky.satellites().zip(&solution.residual_m).map(|(seen, residual)| Used {
            prn: seen.prn,
            az_rad: seen.azimuth().rad(),
            el_rad: seen.elevation.rad(),
            residual_m: *residual,
            sigma_m: seen.error.variance_m2().sqrt(),
            from_grid: seen.from_grid,
        });
        Ok(Fix { solution, used_for, satellites: used.collect() })
    }

    fn count_unused(&mut self, used_for: Use, epoch: usize, now: GpsTime, fix: Option<&Fix>) {
        let (store, orbits) = (&self.listener.store, self.orbits);
        let service = self.listener.last(used_for);
        let mut count = |why: String, n: usize| {
            if n > 0 {
                *self.unused.entry(why).or_default() += n;
            }
        };
        for (prn, range) in self.table.ranges(epoch) {
            if range.is_none() {
                count("no C/A pseudorange on L1".to_owned(), 1);
            } else if service.satellite(prn).is_none() {
                // Only who is not served is examined for the reason.
                let why = ranging(store, prn, used_for, now, |prn, iode| orbits.at(prn, iode, now)).err();
                count(why.map_or_else(|| service.serves().err().map_or_else(String::new, |e| e.to_string()), |w| w.to_string()), 1);
            }
        }
        count("nothing says what the ionosphere does at its pierce point".to_owned(), fix.map_or(0, |f| f.solution.without_ionosphere));
        count(geostationary_words(store, used_for, now).to_owned(), self.table.geostationary(epoch));
    }
}

/// Why ranges of geostationary satellites are not used.
fn geostationary_words(store: &Store, used_for: Use, now: GpsTime) -> &'static str {
    match store.geo_navigation(used_for, now).map(|g| g.ura_index) {
        None => "geostationary: no message 9 in force",
        Some(URA_DO_NOT_USE) => "geostationary: the service forbids ranging (message 9, URA index 15)",
        Some(_) => "geostationary: the service offers a range, which is not used here",
    }
}

/// A pseudorange with the clock, orbit and fast correction of its satellite; none where the service does not correct it.
fn measurement<'a>(service: &'a Service, orbits: &Orbits, prn: u8, range_m: f64, now: GpsTime) -> Option<Measurement<'a>> {
    let ranging = service.satellite(prn)?;
    let broadcast = orbits.record(prn, ranging.iode, now)?;
    let record = broadcast.record();
    let sent = earlier(now, range_m / SPEED_OF_LIGHT_MPS);
    let state = broadcast.state(earlier(sent, clock_polynomial(record, sent)));
    let clock_s = state.clock_s - record.group_delay(Carrier::L1)? + ranging.clock_s;
    Some(Measurement {
        ranging,
        corrected: Metres::new(range_m + ranging.fast_m + SPEED_OF_LIGHT_MPS * clock_s),
        position: EcefPosition::from_vector(state.position.vector() + ranging.moved_ecef_m),
    })
}
