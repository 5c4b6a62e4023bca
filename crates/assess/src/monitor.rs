//! The RNP monitor over an epoch table of many tracks.

use navbound_core::monitor::rnp::{Alert, Counters, Event, Monitor, Observation, Settings};
use navbound_core::quantity::{GpsTime, Metres, OutOfDomain};

/// Columns of the epoch table that the monitor reads, all of one length.
#[derive(Debug, Clone, Copy)]
pub struct Columns<'a> {
    /// `time_ns`.
    pub time_ns: &'a [i64],
    /// Bound at the accuracy risk.
    pub accuracy_m: &'a [f64],
    /// Bound at the integrity risk.
    pub integrity_m: &'a [f64],
    /// `rnp_m`.
    pub rnp_m: &'a [f64],
    /// Whether the status permits judging.
    pub usable: &'a [bool],
    /// Track of each row, as an index.
    pub track: &'a [u32],
}

/// What the monitors of all tracks found.
#[derive(Debug, Clone)]
pub struct MonitorRun {
    /// The alert in force after each row.
    pub alert: Vec<Alert>,
    /// Events and their tracks, by track and then by annunciation.
    pub events: Vec<(u32, Event)>,
    /// Counters of each track.
    pub counters: Vec<Counters>,
}

/// Run one monitor per track over the rows, in their order.
///
/// # Errors
/// [`OutOfDomain`] for settings that cannot be, columns of unequal length and a track index outside `n_tracks`.
pub fn run(settings: Settings, columns: &Columns<'_>, n_tracks: usize) -> Result<MonitorRun, OutOfDomain> {
    let n = columns.time_ns.len();
    let c = columns;
    for (argument, len) in [
        ("accuracy_m", c.accuracy_m.len()),
        ("integrity_m", c.integrity_m.len()),
        ("rnp_m", c.rnp_m.len()),
        ("status", c.usable.len()),
        ("track", c.track.len()),
    ] {
        if len != n {
            return Err(OutOfDomain { argument, value: len as f64, unit: "rows", domain: "the number of times" });
        }
    }
    let mut monitors = vec![Monitor::new(settings)?; n_tracks];
    let mut events: Vec<(u32, Event)> = Vec::new();
    let mut alert = Vec::with_capacity(n);
    for row in 0..n {
        let track = c.track[row];
        let Some(monitor) = monitors.get_mut(track as usize) else {
            return Err(OutOfDomain { argument: "track", value: f64::from(track), unit: "1", domain: "[0, n_tracks)" });
        };
        let step = monitor.step(&Observation {
            time: GpsTime::from_nanoseconds(c.time_ns[row]),
            accuracy: Metres::new(c.accuracy_m[row]),
            integrity: Metres::new(c.integrity_m[row]),
            rnp: Metres::new(c.rnp_m[row]),
            usable: c.usable[row],
        });
        events.extend(step.ended.iter().flatten().map(|event| (track, *event)));
        alert.push(step.alert);
    }
    for (track, monitor) in (0..).zip(&monitors) {
        events.extend(monitor.open_events().map(|event| (track, *event)));
    }
    events.sort_by_key(|(track, event)| (*track, event.annunciation, event.onset));
    Ok(MonitorRun { alert, events, counters: monitors.iter().map(|m| *m.counters()).collect() })
}
