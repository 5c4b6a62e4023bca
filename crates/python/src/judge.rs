//! One epoch, one step: the judge of one aircraft, and those of the tracks of a table.

use crate::error::input_error;
use crate::methods::{COLUMNS, Table, parts};
use crate::rnp::{Decided, EventRow, RnpMonitor, acceptance_word, alerting, counters_dict, decided, event_row};
use crate::states::RnpStates;
use navbound_assess::judge::{Columns, Judges, Piece, Plan};
use navbound_core::bound;
use navbound_core::judge::{Judge, Settings};
use navbound_core::monitor::rnp::{Alert, Event};
use navbound_core::quantity::{GpsTime, Metres, OutOfDomain, Risk, Status};
use numpy::{IntoPyArray, PyReadonlyArray1};
use pyo3::exceptions::{PyIndexError, PyKeyError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

fn refused(e: OutOfDomain) -> PyErr {
    input_error(e, None)
}

/// What stands for "none" in a column of states.
const NONE: u8 = u8::MAX;

fn status_of(code: u8) -> PyResult<Status> {
    Status::ALL.get(usize::from(code)).copied().ok_or_else(|| PyIndexError::new_err(code))
}

/// How epochs are judged.
#[pyclass(frozen, module = "navbound._core")]
struct JudgePlan {
    plan: Plan,
}

#[pymethods]
impl JudgePlan {
    /// Judging method, risks of accuracy and integrity, a monitor with its settings, states, and methods beside.
    #[new]
    fn new(
        method: &str,
        risks: [f64; 2],
        monitor: PyRef<'_, RnpMonitor>,
        states: Option<PyRef<'_, RnpStates>>,
        beside: Vec<String>,
    ) -> PyResult<Self> {
        let risk = |q| Risk::new(q).map_err(refused);
        let settings = Settings {
            method: alerting(method)?,
            accuracy: risk(risks[0])?,
            integrity: risk(risks[1])?,
            states: states.map(|states| states.table),
            monitor: *monitor.monitor.settings(),
            with_levels: false,
        };
        let beside = beside.iter().map(|id| bound::method(id).ok_or_else(|| PyKeyError::new_err(id.clone()))).collect::<PyResult<_>>()?;
        Ok(Self { plan: Plan { settings, beside } })
    }

    /// Names of the numbers of an epoch, in their order.
    fn names(&self) -> Vec<String> {
        let mut names = self.plan.names();
        names.extend(self.plan.beside_names());
        names
    }

    /// The judge of one aircraft.
    fn judge(&self, with_levels: bool) -> PyResult<EpochJudge> {
        let judge = Judge::new(Settings { with_levels, ..self.plan.settings }).map_err(refused)?;
        Ok(EpochJudge { judge, plan: self.plan.clone() })
    }

    /// The judge that was written to bytes; `ValueError` says why bytes are none.
    fn resumed(&self, state: &[u8]) -> PyResult<EpochJudge> {
        let judge = self.plan.resumed(state).map_err(|bad| PyValueError::new_err(bad.to_string()))?;
        Ok(EpochJudge { judge, plan: self.plan.clone() })
    }

    /// One judge for each entry, which says whether its track has a protection level anywhere.
    fn judges(&self, with_levels: Vec<bool>) -> PyResult<TrackJudges> {
        Ok(TrackJudges { judges: Judges::new(self.plan.clone(), &with_levels).map_err(refused)? })
    }
}

/// Numbers, code of the status, reason with its words, state, alert, acceptance, ended events, begun events.
type Step = (Vec<f64>, u8, Option<(&'static str, String)>, u8, u8, &'static str, Vec<EventRow>, Vec<EventRow>);

/// The judge of one aircraft.
#[pyclass(module = "navbound._core")]
struct EpochJudge {
    judge: Judge,
    plan: Plan,
}

#[pymethods]
impl EpochJudge {
    /// One epoch; its numbers stand in the order of `judge_columns`. `states_level`: the record has a level, be it no number.
    fn step(&mut self, time_ns: i64, status: u8, numbers: [f64; COLUMNS.len()], states_level: bool) -> PyResult<Step> {
        let (epochs, nse_m, hpl_m) = parts(1, numbers.each_ref().map(|number| Some(std::slice::from_ref(number))));
        let (times, statuses, tracks) = ([time_ns], [status_of(status)?], [0]);
        let columns = Columns { epochs, nse_m, hpl_m, time_ns: &times, status: &statuses, track: &tracks };
        let mut sample = columns.sample(0);
        if states_level {
            sample.hpl = sample.hpl.or(Some(Metres::new(f64::NAN)));
        }
        if let Some(course) = sample.course {
            course.course().map_err(refused)?;
        }
        let judged = self.judge.step(&sample);
        let rows = |events: &[Option<Event>]| events.iter().flatten().map(event_row).collect();
        let evaluated = &judged.evaluated;
        Ok((
            self.plan.row(&sample, &judged),
            evaluated.status as u8,
            evaluated.reason().map(|why| (why.id(), evaluated.unjudged().map_or_else(|| why.words().to_owned(), ToString::to_string))),
            evaluated.tightest_level.unwrap_or(NONE),
            judged.step.alert as u8,
            acceptance_word(judged.step.acceptance),
            rows(&judged.step.ended),
            rows(&judged.step.began),
        ))
    }

    /// Time passes without an epoch: the alert in force, and the loss of monitoring that was raised.
    fn tick(&mut self, time_ns: i64) -> (&'static str, Option<EventRow>) {
        let tick = self.judge.tick(GpsTime::from_nanoseconds(time_ns));
        (tick.alert.word(), tick.began.as_ref().map(event_row))
    }

    fn open_events(&self) -> Vec<EventRow> {
        self.judge.monitor().open_events().map(event_row).collect()
    }

    fn counters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        counters_dict(py, self.judge.monitor().counters())
    }

    fn to_bytes<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.judge.to_bytes())
    }
}

/// One judge per track, which take their rows in pieces of any length.
#[pyclass(module = "navbound._core")]
struct TrackJudges {
    judges: Judges,
}

#[pymethods]
impl TrackJudges {
    /// Judge the next rows; an absent column is left out of the dictionary.
    fn judge<'py>(
        &mut self,
        py: Python<'py>,
        columns: &Bound<'py, PyDict>,
        time_ns: PyReadonlyArray1<'py, i64>,
        status: PyReadonlyArray1<'py, u8>,
        track: PyReadonlyArray1<'py, u32>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let time_ns = time_ns.as_slice()?;
        let table = Table::of(time_ns.len(), columns)?;
        let (epochs, nse_m, hpl_m) = table.parts()?;
        let status = status.as_slice()?.iter().map(|code| status_of(*code)).collect::<PyResult<Vec<_>>>()?;
        let columns = Columns { epochs, nse_m, hpl_m, time_ns, status: &status, track: track.as_slice()? };
        let piece = py.detach(|| self.judges.judge(&columns)).map_err(refused)?;
        self.columns(py, piece)
    }

    /// Events with the index of their track, counters of each track, and of all together.
    fn decided<'py>(&self, py: Python<'py>) -> PyResult<Decided<'py>> {
        decided(py, &self.judges.events(), &self.judges.counters())
    }
}

impl TrackJudges {
    fn columns<'py>(&self, py: Python<'py>, piece: Piece) -> PyResult<Bound<'py, PyDict>> {
        let (d, numbers) = (PyDict::new(py), PyDict::new(py));
        let plan = self.judges.plan();
        for (name, column) in plan.names().iter().chain(&plan.beside_names()).zip(piece.numbers) {
            numbers.set_item(name, column.into_pyarray(py))?;
        }
        d.set_item("numbers", numbers)?;
        d.set_item("status", piece.status.iter().map(|s| *s as u8).collect::<Vec<_>>().into_pyarray(py))?;
        d.set_item("reason", piece.reason.into_pyarray(py))?;
        d.set_item("reasons", piece.reasons.into_iter().map(|r| (r.reason.id(), r.words)).collect::<Vec<_>>())?;
        d.set_item("state", piece.state.iter().map(|s| s.unwrap_or(NONE)).collect::<Vec<_>>().into_pyarray(py))?;
        d.set_item("alert", piece.alert.iter().map(|a| *a as u8).collect::<Vec<_>>().into_pyarray(py))?;
        Ok(d)
    }
}

/// Names of the numbers of an epoch that the judge reads, in their order.
#[pyfunction]
fn judge_columns() -> Vec<&'static str> {
    COLUMNS.to_vec()
}

/// Words of the alerts, in the order of their codes.
#[pyfunction]
fn alerts() -> Vec<&'static str> {
    Alert::ALL.iter().map(|alert| alert.word()).collect()
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add("LEAST_VARIANCE_M2", navbound_core::frame::LEAST_VARIANCE_M2)?;
    m.add_function(wrap_pyfunction!(judge_columns, m)?)?;
    m.add_function(wrap_pyfunction!(alerts, m)?)?;
    m.add_class::<JudgePlan>()?;
    m.add_class::<EpochJudge>()?;
    m.add_class::<TrackJudges>()
}
