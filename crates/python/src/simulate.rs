//! Simulated flights.

use crate::error::input_error;
use navbound_assess::flights::{COLUMNS, Flights};
use navbound_core::quantity::OutOfDomain;
use navbound_simulate::{Outlook as Prepared, Plan, Refused, Scenario};
use numpy::IntoPyArray;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// A scenario with its route, heights, speeds and satellite geometry worked out: what all its flights share.
#[pyclass(frozen, module = "navbound._core")]
struct Outlook(Prepared);

/// A scenario in SI units, from JSON.
pub fn read(json: &str) -> PyResult<Scenario> {
    serde_json::from_str(json).map_err(|e| unreadable("scenario", &e))
}

/// JSON that is not what it should be.
pub fn unreadable(what: &str, e: &serde_json::Error) -> PyErr {
    PyValueError::new_err(format!("{what}: {e}"))
}

/// Why a scenario cannot be flown.
pub fn refused(e: Refused) -> PyErr {
    match e {
        Refused::Value(error) => input_error(error, None),
        Refused::Item(at) => input_error(at.error, Some(at.index)),
    }
}

#[pymethods]
impl Outlook {
    /// From a scenario in SI units, as JSON.
    #[new]
    fn new(py: Python<'_>, scenario: &str) -> PyResult<Self> {
        let scenario = read(scenario)?;
        py.detach(|| Prepared::new(scenario)).map(Self).map_err(refused)
    }

    /// Whether a scenario can be flown, without its satellites.
    #[staticmethod]
    fn check(py: Python<'_>, scenario: &str) -> PyResult<()> {
        let scenario = read(scenario)?;
        py.detach(|| Plan::new(&scenario)).map(drop).map_err(refused)
    }

    /// Length, waypoints and phases along the route, cruise speed, begin and end of the cruise.
    fn plan<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let plan = self.0.plan();
        let (from, to) = plan.cruise_from_to_s();
        let d = PyDict::new(py);
        d.set_item("length_m", plan.length().m())?;
        d.set_item("waypoints_along_m", plan.waypoints_along().iter().map(|s| s.m()).collect::<Vec<_>>())?;
        d.set_item("cruise_speed_mps", plan.cruise_speed_mps())?;
        d.set_item("top_of_climb_s", from)?;
        d.set_item("top_of_descent_s", to)?;
        d.set_item("phases", plan.phases().iter().map(|p| p.name.clone()).collect::<Vec<_>>())?;
        d.set_item("phase_end_m", plan.phases().iter().map(|p| p.end.m()).collect::<Vec<_>>())?;
        Ok(d)
    }

    /// Flights `first .. first + count` as columns.
    fn fly<'py>(&self, py: Python<'py>, seed: u64, first: u64, count: u64) -> PyResult<Bound<'py, PyDict>> {
        let flown: Result<Flights, OutOfDomain> = py.detach(|| Flights::fly(&self.0, seed, first, count));
        epochs(py, &flown.map_err(|e| input_error(e, None))?)
    }
}

/// Epochs of flights as columns.
pub fn epochs<'py>(py: Python<'py>, flights: &Flights) -> PyResult<Bound<'py, PyDict>> {
    let d = PyDict::new(py);
    for column in &COLUMNS {
        d.set_item(column.0, flights.column(column).into_pyarray(py))?;
    }
    d.set_item("time_ns", flights.time_ns().into_pyarray(py))?;
    d.set_item("flight", flights.number().into_pyarray(py))?;
    d.set_item("reason", flights.reasons())?;
    d.set_item("reason_id", flights.reason_ids())?;
    Ok(d)
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_class::<Outlook>()
}
