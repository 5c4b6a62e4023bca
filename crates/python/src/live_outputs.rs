//! What a journal out holds, as rows and columns.

use navbound_core::monitor::rnp::Acceptance;
use navbound_core::quantity::{GpsTime, Reason};
use navbound_live::journal::{self, Next};
use navbound_live::{NUMBERS, Output, Transition};
use numpy::IntoPyArray;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// key, track, incarnation, kind, transition; times annunciation, onset, clear, event, arrival, emitted \[ns\]; peak, limit, least margin
/// \[m\]; position of the journal in.
pub(crate) type TransitionRow =
    ((String, Option<String>, u32, &'static str, &'static str), (i64, i64, Option<i64>, i64, Option<i64>, i64), (f64, f64, f64), u64);

pub(crate) fn transition_row(t: &Transition, position: u64, emitted_ns: i64) -> TransitionRow {
    let ns = GpsTime::nanoseconds;
    (
        (t.key(), t.track.map(|track| track.name().to_owned()), t.incarnation, t.kind.word(), t.turn.word()),
        (ns(t.annunciation), ns(t.onset), t.clear.map(ns), ns(t.event), t.arrival.map(ns), emitted_ns),
        (t.peak_m, t.limit_m, t.min_margin_m),
        position,
    )
}

fn damaged(what: impl ToString) -> PyErr {
    PyValueError::new_err(what.to_string())
}

/// Outputs of the frames of a journal out, with the position of the journal in behind their input and the time of writing.
fn read(frames: &[u8]) -> PyResult<Vec<(u64, i64, Vec<Output>)>> {
    let (mut at, mut read) = (0, Vec::new());
    while let Next::Payload(payload, length) = journal::next(frames.get(at..).unwrap_or_default()) {
        at += length;
        let (position, emitted, outputs) = journal::outputs_of(payload).map_err(damaged)?;
        read.push((position, emitted.nanoseconds(), Output::all(outputs).map_err(damaged)?));
    }
    if at == frames.len() { Ok(read) } else { Err(damaged("the journal is torn or damaged")) }
}

/// Position of the journal in behind the input of the last whole frame.
#[pyfunction]
fn live_last_position(frame: &[u8]) -> PyResult<u64> {
    match journal::next(frame) {
        Next::Payload(payload, _) => Ok(journal::outputs_of(payload).map_err(damaged)?.0),
        Next::Torn | Next::Damaged => Err(damaged("not a whole frame")),
    }
}

/// Transitions of some frames, in order.
#[pyfunction]
fn live_transitions(frames: &[u8]) -> PyResult<Vec<TransitionRow>> {
    let mut rows = Vec::new();
    for (position, emitted_ns, outputs) in read(frames)? {
        rows.extend(outputs.iter().filter_map(|output| match output {
            Output::Transition(t) => Some(transition_row(t, position, emitted_ns)),
            Output::Epoch(_) => None,
        }));
    }
    Ok(rows)
}

/// Frames without their time of writing and without the cut into frames: what two runs of one journal have in common.
#[pyfunction]
fn live_comparable<'py>(py: Python<'py>, frames: &[u8]) -> PyResult<Vec<(u64, Bound<'py, pyo3::types::PyBytes>)>> {
    let mut all = Vec::new();
    for (position, _, outputs) in read(frames)? {
        for output in outputs {
            let mut bytes = Vec::new();
            output.append(&mut bytes);
            all.push((position, pyo3::types::PyBytes::new(py, &bytes)));
        }
    }
    Ok(all)
}

/// Columns of the epochs of some frames.
#[pyfunction]
fn live_epochs<'py>(py: Python<'py>, frames: &[u8]) -> PyResult<Bound<'py, PyDict>> {
    let read = read(frames)?;
    let epochs: Vec<_> = read
        .iter()
        .flat_map(|(_, _, outputs)| outputs)
        .filter_map(|output| if let Output::Epoch(e) = output { Some(e) } else { None })
        .collect();
    let d = PyDict::new(py);
    d.set_item("track", epochs.iter().map(|e| e.track.name().to_owned()).collect::<Vec<_>>())?;
    d.set_item("time_ns", epochs.iter().map(|e| e.time.nanoseconds()).collect::<Vec<_>>().into_pyarray(py))?;
    d.set_item("arrival_ns", epochs.iter().map(|e| e.arrival.map(GpsTime::nanoseconds)).collect::<Vec<_>>())?;
    d.set_item("status", epochs.iter().map(|e| e.status.id()).collect::<Vec<_>>())?;
    d.set_item("reason_id", epochs.iter().map(|e| e.reason.map(Reason::id)).collect::<Vec<_>>())?;
    d.set_item("accepted", epochs.iter().map(|e| e.acceptance == Acceptance::Accepted).collect::<Vec<_>>())?;
    d.set_item("alert", epochs.iter().map(|e| e.alert.word()).collect::<Vec<_>>())?;
    d.set_item("nav_mode", epochs.iter().map(|e| e.nav_mode.map(|mode| mode.name().to_owned())).collect::<Vec<_>>())?;
    for (k, name) in NUMBERS.into_iter().enumerate() {
        d.set_item(name, epochs.iter().map(|e| e.numbers[k]).collect::<Vec<_>>().into_pyarray(py))?;
    }
    Ok(d)
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(live_last_position, m)?)?;
    m.add_function(wrap_pyfunction!(live_transitions, m)?)?;
    m.add_function(wrap_pyfunction!(live_comparable, m)?)?;
    m.add_function(wrap_pyfunction!(live_epochs, m)?)
}
