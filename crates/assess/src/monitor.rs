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

    /// Tracks with a level anywhere: they have a source of levels, so every epoch of them whose status is `ok` should have one.
    fn with_levels(&self, n_tracks: usize) -> Vec<bool> {
        let mut with_levels = vec![false; n_tracks];
        for (row, hpl_m) in self.level_m.iter().flat_map(|l| l.hpl_m).enumerate() {
            if let Some(has) = with_levels.get_mut(self.track[row] as usize) {
                *has |= !hpl_m.is_nan();
            }
        }
        with_levels
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

/// What the monitors decided in some rows.
#[derive(Debug, Clone)]
pub struct Piece {
    /// What was compared with twice RNP in each row: [`IntegrityComparison`].
    pub integrity_compared_m: Vec<f64>,
    /// The alert in force after each row.
    pub alert: Vec<Alert>,
}

/// One monitor per track, which take their rows in pieces of any length. The rows are the arrival clock: one that is dropped for its time
/// counts as one sample period of silence.
#[derive(Debug, Clone)]
pub struct Monitors {
    tracks: Vec<(Monitor, IntegrityComparison)>,
    events: Vec<(u32, Event)>,
}

impl Monitors {
    /// One monitor for each entry, which says whether its track has a protection level anywhere.
    ///
    /// # Errors
    /// [`OutOfDomain`] for settings that cannot be.
    pub fn new(settings: Settings, with_levels: &[bool]) -> Result<Self, OutOfDomain> {
        let monitor = Monitor::new(settings)?;
        let comparison = |has: &bool| if *has { IntegrityComparison::with_levels() } else { IntegrityComparison::default() };
        Ok(Self { tracks: with_levels.iter().map(|has| (monitor, comparison(has))).collect(), events: Vec::new() })
    }

    /// Judge the next rows.
    ///
    /// # Errors
    /// [`OutOfDomain`] for columns of unequal length and the index of a track that is none.
    pub fn judge(&mut self, columns: &Columns<'_>) -> Result<Piece, OutOfDomain> {
        columns.checked()?;
        let n = columns.time_ns.len();
        let mut piece = Piece { integrity_compared_m: Vec::with_capacity(n), alert: Vec::with_capacity(n) };
        for row in 0..n {
            let track = columns.track[row];
            let Some((monitor, comparison)) = self.tracks.get_mut(track as usize) else {
                return Err(OutOfDomain { argument: "track", value: f64::from(track), unit: "1", domain: "[0, n_tracks)" });
            };
            let seen = columns.observation(row, comparison);
            let step = monitor.step(&seen);
            piece.integrity_compared_m.push(seen.integrity.length().m());
            self.events.extend(step.ended.iter().flatten().map(|event| (track, *event)));
            piece.alert.push(step.alert);
        }
        Ok(piece)
    }

    /// Events so far and those that last, and their tracks, by track and then by annunciation.
    #[must_use]
    pub fn events(&self) -> Vec<(u32, Event)> {
        let mut events = self.events.clone();
        for (track, (monitor, _)) in (0..).zip(&self.tracks) {
            events.extend(monitor.open_events().map(|event| (track, *event)));
        }
        events.sort_by_key(|(track, event)| (*track, event.annunciation, event.onset));
        events
    }

    /// Counters of each track.
    #[must_use]
    pub fn counters(&self) -> Vec<Counters> {
        self.tracks.iter().map(|(monitor, _)| *monitor.counters()).collect()
    }
}

/// Run one monitor per track over all rows, in their order: [`Monitors`] in one piece.
///
/// # Errors
/// [`OutOfDomain`] for settings that cannot be, columns of unequal length and a track index outside `n_tracks`.
pub fn run(settings: Settings, columns: &Columns<'_>, n_tracks: usize) -> Result<MonitorRun, OutOfDomain> {
    columns.checked()?;
    let mut monitors = Monitors::new(settings, &columns.with_levels(n_tracks))?;
    let Piece { integrity_compared_m, alert } = monitors.judge(columns)?;
    Ok(MonitorRun { integrity_compared_m, alert, events: monitors.events(), counters: monitors.counters() })
}
