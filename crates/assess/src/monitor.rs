//! The RNP monitor over an epoch table of many tracks.

use navbound_core::bound::{Alerting, IntegrityComparison};
use navbound_core::monitor::rnp::{Alert, Counters, Event, Monitor, Observation, Settings};
use navbound_core::quantity::{GpsTime, Metres, OutOfDomain};

/// Columns of the epoch table that the monitor reads, all of one length.
#[derive(Debug, Clone, Copy)]
pub struct Columns<'a> {
    /// `time_ns`.
    pub time_ns: &'a [i64],
    /// Bound at the accuracy risk, and the method that made it.
    pub accuracy_m: (Alerting, &'a [f64]),
    /// Bound at the integrity risk, and the method that made it.
    pub integrity_m: (Alerting, &'a [f64]),
    /// `fte_m` and `hpl_m`, NaN where they are not known; absent where the table has no protection level.
    pub level_m: Option<Levels<'a>>,
    /// `rnp_m`.
    pub rnp_m: &'a [f64],
    /// Whether the status permits judging.
    pub usable: &'a [bool],
    /// Track of each row, as an index.
    pub track: &'a [u32],
}

/// Flight technical error and horizontal protection level of each row.
#[derive(Debug, Clone, Copy)]
pub struct Levels<'a> {
    /// `fte_m`; absent where there is no path.
    pub fte_m: Option<&'a [f64]>,
    /// `hpl_m`.
    pub hpl_m: &'a [f64],
    /// Whether the row should have one: its status is `ok`.
    pub due: &'a [bool],
}

/// What the monitors of all tracks decided.
#[derive(Debug, Clone)]
pub struct MonitorRun {
    /// What was compared with twice RNP in each row: [`IntegrityComparison`].
    pub integrity_compared_m: Vec<f64>,
    /// The alert in force after each row.
    pub alert: Vec<Alert>,
    /// Events and their tracks, by track and then by annunciation.
    pub events: Vec<(u32, Event)>,
    /// Counters of each track.
    pub counters: Vec<Counters>,
}

impl Columns<'_> {
    /// # Errors
    /// [`OutOfDomain`] unless all columns have the length of the times.
    fn checked(&self) -> Result<(), OutOfDomain> {
        let n = self.time_ns.len();
        let level = |name, column: Option<&[f64]>| (name, column.map_or(n, <[f64]>::len));
        for (argument, len) in [
            ("accuracy_m", self.accuracy_m.1.len()),
            ("integrity_m", self.integrity_m.1.len()),
            ("rnp_m", self.rnp_m.len()),
            ("status", self.usable.len()),
            ("track", self.track.len()),
            level("fte_m", self.level_m.and_then(|l| l.fte_m)),
            level("hpl_m", self.level_m.map(|l| l.hpl_m)),
            ("status", self.level_m.map_or(n, |l| l.due.len())),
        ] {
            if len != n {
                return Err(OutOfDomain { argument, value: len as f64, unit: "rows", domain: "the number of times" });
            }
        }
        Ok(())
    }

    /// One comparison per track. A track with a level anywhere has a source of levels, so every epoch of it whose status is `ok` should have one.
    fn comparisons(&self, n_tracks: usize) -> Vec<IntegrityComparison> {
        let mut comparisons = vec![IntegrityComparison::default(); n_tracks];
        for (row, hpl_m) in self.level_m.iter().flat_map(|l| l.hpl_m).enumerate() {
            if let Some(comparison) = comparisons.get_mut(self.track[row] as usize).filter(|_| !hpl_m.is_nan()) {
                *comparison = IntegrityComparison::with_levels();
            }
        }
        comparisons
    }

    fn observation(&self, row: usize, comparison: &mut IntegrityComparison) -> Observation {
        let at = |column: Option<&[f64]>| Metres::new(column.and_then(|c| c.get(row)).copied().unwrap_or(f64::NAN));
        let (fte, level) = (at(self.level_m.and_then(|l| l.fte_m)), at(self.level_m.map(|l| l.hpl_m)));
        let bound = |(method, column): (Alerting, &[f64])| method.claim_evaluated(Metres::new(column[row]));
        Observation {
            time: GpsTime::from_nanoseconds(self.time_ns[row]),
            accuracy: bound(self.accuracy_m),
            integrity: comparison.bound(bound(self.integrity_m), fte, level, self.level_m.is_some_and(|l| l.due[row])),
            rnp: Metres::new(self.rnp_m[row]),
            usable: self.usable[row],
        }
    }
}

/// Run one monitor per track over the rows, in their order. The rows are the arrival clock: one that is dropped for its time counts as one
/// sample period of silence.
///
/// # Errors
/// [`OutOfDomain`] for settings that cannot be, columns of unequal length and a track index outside `n_tracks`.
pub fn run(settings: Settings, columns: &Columns<'_>, n_tracks: usize) -> Result<MonitorRun, OutOfDomain> {
    columns.checked()?;
    let n = columns.time_ns.len();
    let mut monitors = vec![Monitor::new(settings)?; n_tracks];
    let mut comparisons = columns.comparisons(n_tracks);
    let mut events: Vec<(u32, Event)> = Vec::new();
    let mut alert = Vec::with_capacity(n);
    let mut integrity_compared_m = Vec::with_capacity(n);
    for row in 0..n {
        let track = columns.track[row];
        let (Some(monitor), Some(comparison)) = (monitors.get_mut(track as usize), comparisons.get_mut(track as usize)) else {
            return Err(OutOfDomain { argument: "track", value: f64::from(track), unit: "1", domain: "[0, n_tracks)" });
        };
        let seen = columns.observation(row, comparison);
        let step = monitor.step(&seen);
        integrity_compared_m.push(seen.integrity.length().m());
        events.extend(step.ended.iter().flatten().map(|event| (track, *event)));
        alert.push(step.alert);
    }
    for (track, monitor) in (0..).zip(&monitors) {
        events.extend(monitor.open_events().map(|event| (track, *event)));
    }
    events.sort_by_key(|(track, event)| (*track, event.annunciation, event.onset));
    Ok(MonitorRun { integrity_compared_m, alert, events, counters: monitors.iter().map(|m| *m.counters()).collect() })
}
