//! The lane of live data: journal frames in, journal frames out.

use crate::error::input_error;
use crate::live_outputs::{TransitionRow, transition_row};
use crate::path::{Path, Shape};
use crate::read::limits_of;
use navbound_core::bound::Alerting;
use navbound_core::judge;
use navbound_core::monitor::motion::Limits;
use navbound_core::monitor::rnp::{self, Chain};
use navbound_core::quantity::{GpsTime, Metres, OutOfDomain, Risk};
use navbound_live::journal::{self, Next};
use navbound_live::{
    Assigned, Assumed, CATEGORIES, Claims, Course, EpochOut, Format, Input, Lane, Output, PlaceWords, Settings, Splitter, StatementRow,
    Statements, Table, TrackId, Zone,
};
use pyo3::exceptions::{PyKeyError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use std::collections::BTreeMap;
use std::sync::Arc;

fn refused(e: OutOfDomain) -> PyErr {
    input_error(e, None)
}

/// RNP \[m\] and corners \[rad\] of an area.
type ZoneRow = (f64, Vec<(f64, f64)>);
/// Name of a track, its path and its RNP \[m\].
type TrackRow<'py> = (String, Option<PyRef<'py, Path>>, Option<f64>);

fn course(path: &Path) -> Course {
    match &path.0 {
        Shape::Line(line) => Course::Line(line.clone()),
        Shape::Route(route) => Course::Route(Box::new(route.clone())),
    }
}

/// How a lane is set, as the package checks it.
#[pyclass(frozen, module = "navbound._core")]
struct LiveSettings(Settings);

#[pymethods]
impl LiveSettings {
    /// `judging`: format, name of a receiver's track, method, method of a track that states a flight technical error. `risks`: accuracy, integrity. `monitor`: six times of the chain, raise delay,
    /// clear delay, clear ratio, stale time. `table`: areas, and what is assigned to tracks. `claims`: standard deviation by NACp, radius of
    /// containment by NIC, least SIL; standard deviation that the user states for positions without one. `statements`: kinds of statements of lines, words of a mode that is none, and parts of names of other places with how far these may be away. `times_ns`: lateness, ahead, retention.
    #[new]
    #[allow(clippy::too_many_arguments)]
    fn new(
        judging: (String, String, String, Option<String>),
        risks: (f64, f64),
        monitor: ([f64; 6], f64, f64, f64, f64),
        rnp_m: f64,
        motion: &Bound<'_, PyDict>,
        path: Option<PyRef<'_, Path>>,
        table: (Vec<ZoneRow>, Vec<TrackRow<'_>>),
        claims: ([f64; CATEGORIES], [f64; CATEGORIES], u8, Option<f64>),
        statements: (Vec<StatementRow>, Vec<String>, PlaceWords),
        times_ns: (i64, i64, i64),
        expiry_ns: Option<i64>,
        max_tracks: usize,
        digest: [u8; 32],
    ) -> PyResult<Self> {
        let (format, track, method, of_stated_fte) = judging;
        let alerting = |id: String| Alerting::of(&id).map_err(|_| PyKeyError::new_err(id));
        let ([sample_period_s, sensor_latency_s, filter_s, computing_s, display_s, time_to_alert_s], raise, clear, ratio, stale) = monitor;
        let settings = rnp::Settings {
            chain: Chain { sample_period_s, sensor_latency_s, filter_s, computing_s, display_s, time_to_alert_s },
            raise_delay_s: raise,
            clear_delay_s: clear,
            clear_ratio: ratio,
            stale_after_s: stale,
        };
        let judge = judge::Settings {
            method: alerting(method)?,
            accuracy: Risk::new(risks.0).map_err(refused)?,
            integrity: Risk::new(risks.1).map_err(refused)?,
            states: None,
            monitor: settings.checked().map_err(refused)?,
            with_levels: false,
        };
        let (zones, tracks) = table;
        let zone = |(rnp_m, corners_rad)| Zone { rnp: Metres::new(rnp_m), corners_rad };
        let mut of_tracks = BTreeMap::new();
        for (name, path, rnp_m) in tracks {
            let id = TrackId::new(&name).ok_or_else(|| PyKeyError::new_err(name))?;
            of_tracks.insert(id, Assigned { path: path.map(|path| course(&path)), rnp: rnp_m.map(Metres::new) });
        }
        let (sigma_m, containment_m, least_sil, assumed_m) = claims;
        Ok(Self(Settings {
            format: Format::of(&format).ok_or_else(|| PyKeyError::new_err(format))?,
            track: TrackId::new(&track).ok_or_else(|| PyKeyError::new_err(track))?,
            judge,
            motion: Limits { period_s: sample_period_s, ..limits_of(motion)? },
            of_stated_fte: of_stated_fte.map(alerting).transpose()?,
            assumed: assumed_m.map(|sigma_m| Assumed(Metres::new(sigma_m))),
            rnp: Metres::new(rnp_m),
            path: path.map(|path| course(&path)),
            table: Table { zones: zones.into_iter().map(zone).collect(), tracks: of_tracks },
            claims: Claims { sigma_m, containment_m, least_sil },
            statements: Arc::new(Statements::new(statements.0, statements.1, statements.2)),
            lateness_ns: times_ns.0,
            ahead_ns: times_ns.1,
            retention_ns: times_ns.2,
            expiry_ns,
            max_tracks,
            digest,
        }))
    }
}

/// One lane.
#[pyclass(module = "navbound._core")]
struct LiveLane {
    lane: Lane,
    /// The newest epoch of each track since `states` was read, where epochs are not written out.
    newest: BTreeMap<TrackId, EpochOut>,
}

impl LiveLane {
    const fn of(lane: Lane) -> Self {
        Self { lane, newest: BTreeMap::new() }
    }
}

/// Bytes taken, frames for the journal out, transitions, number of epochs, what stands behind the bytes taken.
type Pushed<'py> = (usize, Bound<'py, PyBytes>, Vec<TransitionRow>, usize, &'static str);

#[pymethods]
impl LiveLane {
    #[new]
    fn new(settings: PyRef<'_, LiveSettings>) -> PyResult<Self> {
        Lane::new(settings.0.clone()).map(Self::of).map_err(refused)
    }

    /// The lane of a snapshot, its position, and how much was written out then; `ValueError` says why it is not taken up.
    #[staticmethod]
    fn restore(settings: PyRef<'_, LiveSettings>, snapshot: &[u8]) -> PyResult<(Self, u64, u64)> {
        let restored = Lane::restore(settings.0.clone(), snapshot).map_err(|why| PyValueError::new_err(why.to_string()))?;
        Ok((Self::of(restored.0), restored.1, restored.2))
    }

    fn snapshot<'py>(&self, py: Python<'py>, position: u64, written: u64) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.lane.snapshot(position, written))
    }

    /// Journal frames that begin at `position` of the journal in. Without `epochs`, transitions alone are written out, and the newest epoch
    /// of each track is kept for `states`.
    #[pyo3(signature = (frames, position, emitted_ns, *, epochs = true))]
    fn push<'py>(&mut self, py: Python<'py>, frames: &[u8], position: u64, emitted_ns: i64, epochs: bool) -> PyResult<Pushed<'py>> {
        let (lane, newest) = (&mut self.lane, (!epochs).then_some(&mut self.newest));
        let (taken, written, transitions, n_epochs, behind) = py.detach(|| run(lane, newest, frames, (position, emitted_ns)));
        Ok((taken, PyBytes::new(py, &written), transitions, n_epochs, behind))
    }

    /// The newest epoch of each track of which one was judged since the last call, as frames of a journal out, so many epochs in each.
    fn states<'py>(&mut self, py: Python<'py>, emitted_ns: i64, most: usize) -> Vec<Bound<'py, PyBytes>> {
        let epochs: Vec<_> = std::mem::take(&mut self.newest).into_values().collect();
        let frame = |part: &[EpochOut]| {
            let mut bytes = Vec::new();
            part.iter().for_each(|epoch| Output::Epoch(*epoch).append(&mut bytes));
            PyBytes::new(py, &journal::frame(&journal::outputs(0, GpsTime::from_nanoseconds(emitted_ns), &bytes)))
        };
        epochs.chunks(most.max(1)).map(frame).collect()
    }

    #[getter]
    fn event_time_ns(&self) -> Option<i64> {
        self.lane.event_time().map(GpsTime::nanoseconds)
    }

    #[getter]
    fn n_tracks(&self) -> usize {
        self.lane.n_tracks()
    }

    /// Keys of lines that were passed over, by name.
    fn passed_over(&self) -> BTreeMap<String, u64> {
        self.lane.passed_over().clone()
    }

    /// Keys of lines, and words of messages, that took positions away, by name.
    fn against(&self) -> BTreeMap<String, u64> {
        self.lane.against().clone()
    }

    fn counters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let counts = crate::rnp::counters_dict(py, &self.lane.monitor_counters())?;
        for (name, n) in self.lane.counters().named() {
            counts.set_item(name, n)?;
        }
        Ok(counts)
    }
}

fn run(
    lane: &mut Lane,
    mut newest: Option<&mut BTreeMap<TrackId, EpochOut>>,
    frames: &[u8],
    (position, emitted_ns): (u64, i64),
) -> (usize, Vec<u8>, Vec<TransitionRow>, usize, &'static str) {
    let (mut at, mut written, mut transitions, mut n_epochs) = (0, Vec::new(), Vec::new(), 0);
    let (mut outputs, mut bytes) = (Vec::new(), Vec::new());
    let emitted = GpsTime::from_nanoseconds(emitted_ns);
    loop {
        let rest = frames.get(at..).unwrap_or_default();
        let (payload, length) = match journal::next(rest) {
            Next::Payload(payload, length) => (payload, length),
            Next::Torn if rest.is_empty() => return (at, written, transitions, n_epochs, "end"),
            Next::Torn => return (at, written, transitions, n_epochs, "torn"),
            Next::Damaged => return (at, written, transitions, n_epochs, "damaged"),
        };
        let Ok(input) = Input::from_bytes(payload) else { return (at, written, transitions, n_epochs, "damaged") };
        at += length;
        outputs.clear();
        lane.step(&input, &mut outputs);
        bytes.clear();
        for output in &outputs {
            match (output, &mut newest) {
                (Output::Epoch(epoch), Some(newest)) => {
                    newest.insert(epoch.track, *epoch);
                }
                _ => output.append(&mut bytes),
            }
            match output {
                Output::Epoch(_) => n_epochs += 1,
                Output::Transition(transition) => transitions.push(transition_row(transition, position + at as u64, emitted_ns)),
            }
        }
        if bytes.is_empty() {
            continue;
        }
        written.extend(journal::frame(&journal::outputs(position + at as u64, emitted, &bytes)));
    }
}

/// Lines of many aircraft, parted by lane.
#[pyclass(module = "navbound._core")]
struct LiveSplitter(Splitter);

#[pymethods]
impl LiveSplitter {
    #[new]
    fn new(format: String, n_lanes: usize) -> PyResult<Self> {
        let format = Format::of(&format).ok_or_else(|| PyKeyError::new_err(format))?;
        Ok(Self(Splitter::new(format, n_lanes)))
    }

    /// Whole lines of the next bytes, by lane.
    fn push<'py>(&mut self, py: Python<'py>, data: &[u8]) -> Vec<Bound<'py, PyBytes>> {
        let lanes = py.detach(|| self.0.push(data));
        lanes.iter().map(|lines| PyBytes::new(py, lines)).collect()
    }
}

/// A journal frame of an input: `chunk`, `heartbeat`, `up`, `down`, `end`. All but `chunk` and `end` need an arrival.
#[pyfunction]
fn live_input<'py>(py: Python<'py>, kind: &str, arrival_ns: Option<i64>, data: &[u8]) -> PyResult<Bound<'py, PyBytes>> {
    let arrival = arrival_ns.map(GpsTime::from_nanoseconds);
    let needed = || arrival.ok_or_else(|| PyValueError::new_err("an arrival is needed"));
    let input = match kind {
        "chunk" => Input::Chunk { arrival, bytes: data },
        "heartbeat" => Input::Heartbeat { arrival: needed()? },
        "up" | "down" => Input::Link { arrival: needed()?, up: kind == "up" },
        "end" => Input::End { arrival },
        _ => return Err(PyKeyError::new_err(kind.to_owned())),
    };
    Ok(PyBytes::new(py, &journal::frame(&input.to_bytes())))
}

/// Kind, arrival and bytes of an input.
type InputRow<'py> = (&'static str, Option<i64>, Bound<'py, PyBytes>);

/// Kind, arrival and bytes of the inputs in some frames.
#[pyfunction]
fn live_inputs<'py>(py: Python<'py>, frames: &[u8]) -> PyResult<Vec<InputRow<'py>>> {
    let (mut at, mut inputs) = (0, Vec::new());
    let ns = |arrival: Option<GpsTime>| arrival.map(GpsTime::nanoseconds);
    while let Next::Payload(payload, length) = journal::next(frames.get(at..).unwrap_or_default()) {
        at += length;
        let input = Input::from_bytes(payload).map_err(|why| PyValueError::new_err(why.to_string()))?;
        let (kind, arrival, bytes) = match input {
            Input::Chunk { arrival, bytes } => ("chunk", ns(arrival), bytes),
            Input::Heartbeat { arrival } => ("heartbeat", ns(Some(arrival)), [].as_slice()),
            Input::Link { arrival, up } => (if up { "up" } else { "down" }, ns(Some(arrival)), [].as_slice()),
            Input::End { arrival } => ("end", ns(arrival), [].as_slice()),
        };
        inputs.push((kind, arrival, PyBytes::new(py, bytes)));
    }
    Ok(inputs)
}

/// Ends of the whole frames of a journal, and what stands behind the last: `end`, `torn` or `damaged`.
#[pyfunction]
fn live_frames(frames: &[u8]) -> (Vec<usize>, &'static str) {
    let (mut at, mut ends) = (0, Vec::new());
    loop {
        let rest = frames.get(at..).unwrap_or_default();
        match journal::next(rest) {
            Next::Payload(_, length) => {
                at += length;
                ends.push(at);
            }
            Next::Torn => return (ends, if rest.is_empty() { "end" } else { "torn" }),
            Next::Damaged => return (ends, "damaged"),
        }
    }
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(live_input, m)?)?;
    m.add_function(wrap_pyfunction!(live_inputs, m)?)?;
    m.add_function(wrap_pyfunction!(live_frames, m)?)?;
    m.add_class::<LiveSettings>()?;
    m.add_class::<LiveSplitter>()?;
    m.add_class::<LiveLane>()
}
