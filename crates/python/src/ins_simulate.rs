//! Simulated sensors.

use crate::error::input_error;
use crate::orbits::named;
use crate::receiver_files::Navigation;
use crate::simulate::{epochs, read, refused, unreadable};
use navbound_assess::fused::{Fused, MODES, Verdict};
use navbound_assess::sensed::{BARO, CLOCK, DME, IMU, SATELLITES, Sensed, TRUTH, Table, VOR};
use navbound_core::monitor::judgement::{Reason, Source, Status};
use navbound_core::quantity::GpsTime;
use navbound_core::solution::ins::Kind;
use navbound_simulate::{Imu, Sensing};
use numpy::{IntoPyArray, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The sensors of a scenario, ready for any flight.
#[pyclass(frozen, module = "navbound._core")]
struct Sensors(Sensing);

fn columns<'py, const N: usize>(py: Python<'py>, names: &[&str; N], table: Table<N>) -> PyResult<Bound<'py, PyDict>> {
    let d = PyDict::new(py);
    d.set_item("time_ns", table.time_ns.into_pyarray(py))?;
    for (name, column) in names.iter().zip(table.columns) {
        d.set_item(name, column.into_pyarray(py))?;
    }
    Ok(d)
}

#[pymethods]
impl Sensors {
    /// From a scenario in SI units, as JSON; satellites nominal, or from navigation files.
    #[new]
    fn new(py: Python<'_>, scenario: &str, navigation: Option<&Navigation>) -> PyResult<Self> {
        let scenario = read(scenario)?;
        let records = navigation.map(|n| n.ephemerides());
        py.detach(|| Sensing::new(scenario, records)).map(Self).map_err(refused)
    }

    /// From a scenario and satellites by name with seven elements each; the flight begins so long after the elements' instant.
    #[staticmethod]
    fn of_orbits(py: Python<'_>, scenario: &str, names: Vec<String>, elements: PyReadonlyArray2<'_, f64>, since_s: f64) -> PyResult<Self> {
        let scenario = read(scenario)?;
        let orbits = named(&names, elements.as_slice()?.as_chunks().0, since_s)?;
        py.detach(|| Sensing::with_orbits(scenario, &orbits)).map(Self).map_err(refused)
    }

    /// The flight without errors on the scenario's filter: the covariances to expect.
    fn error_free<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let flown = py.detach(|| Fused::error_free(&self.0)).map_err(|e| input_error(e, None))?;
        epochs(py, &flown.flights)
    }

    /// One flight as tables of columns.
    fn fly<'py>(&self, py: Python<'py>, seed: u64, number: u64, truth_every: u64) -> PyResult<Bound<'py, PyDict>> {
        let flown = py.detach(|| Sensed::fly(&self.0, seed, number, truth_every));
        let s = flown.map_err(|e| input_error(e, None))?;
        let d = PyDict::new(py);
        d.set_item("truth", columns(py, &TRUTH, s.truth)?)?;
        d.set_item("imu", columns(py, &IMU, s.imu)?)?;
        let satellites = columns(py, &SATELLITES, s.satellites)?;
        satellites.set_item("satellite", s.satellite.iter().map(ToString::to_string).collect::<Vec<_>>())?;
        d.set_item("satellites", satellites)?;
        let dme = columns(py, &DME, s.dme)?;
        dme.set_item("station", s.dme_station.into_pyarray(py))?;
        d.set_item("dme", dme)?;
        let vor = columns(py, &VOR, s.vor)?;
        vor.set_item("station", s.vor_station.into_pyarray(py))?;
        d.set_item("vor", vor)?;
        d.set_item("baro", columns(py, &BARO, s.baro)?)?;
        d.set_item("clock", columns(py, &CLOCK, s.clock)?)?;
        Ok(d)
    }

    /// Flights `first .. first + count` on the scenario's filter: columns of epochs, and what each filter says of itself.
    fn navigate<'py>(&self, py: Python<'py>, seed: u64, first: u64, count: u64) -> PyResult<(Bound<'py, PyDict>, Vec<Bound<'py, PyDict>>)> {
        let flown = py.detach(|| Fused::fly(&self.0, seed, first, count)).map_err(|e| input_error(e, None))?;
        let verdicts = flown.verdicts.iter().map(|v| verdict(py, v)).collect::<PyResult<_>>()?;
        Ok((epochs(py, &flown.flights)?, verdicts))
    }

    /// Words of the codes of the column `nav_mode`.
    #[staticmethod]
    fn modes() -> Vec<&'static str> {
        MODES.iter().map(|mode| mode.word()).collect()
    }

    /// Words of the codes of the columns `decided` and `source`, and ids of the bits of `reasons`.
    #[staticmethod]
    fn judgement() -> [Vec<&'static str>; 3] {
        let status = [Status::NotAvailable, Status::Degraded, Status::Ok].map(Status::word);
        let source = [Source::None, Source::Filter, Source::Snapshot].map(Source::word);
        [status.to_vec(), source.to_vec(), Reason::ALL.map(Reason::id).to_vec()]
    }
}

/// An inertial unit on wheels along positions at whole seconds: tables `truth` and `imu`. The unit's errors come as JSON; `rates` are its
/// samples a second and the samples between rows of the truth.
#[pyfunction]
fn ins_roll<'py>(
    py: Python<'py>,
    start_ns: i64,
    position: PyReadonlyArray2<'py, f64>,
    imu: &str,
    rates: (u32, u64),
    draw: (u64, u64),
) -> PyResult<Bound<'py, PyDict>> {
    let unit: Imu = serde_json::from_str(imu).map_err(|e| unreadable("imu", &e))?;
    let positions = position.as_slice()?.as_chunks().0;
    let begin = GpsTime::from_nanoseconds(start_ns);
    let rolled = py.detach(|| Sensed::roll(begin, positions, (&unit, rates.0), draw, rates.1)).map_err(|e| input_error(e, None))?;
    let d = PyDict::new(py);
    d.set_item("truth", columns(py, &TRUTH, rolled.truth)?)?;
    d.set_item("imu", columns(py, &IMU, rolled.imu)?)?;
    Ok(d)
}

/// Of each kind of measurement: used, gated, refused, mean square, lag-one correlation, pairs behind it; and the inertial samples.
fn verdict<'py>(py: Python<'py>, verdict: &Verdict) -> PyResult<Bound<'py, PyDict>> {
    let d = PyDict::new(py);
    for (kind, i) in Kind::ALL.iter().zip(&verdict.innovations) {
        d.set_item(kind.word(), (i.n_used, i.n_gated, i.n_refused, i.mean_square(), i.lag_one(), i.n_pairs()))?;
    }
    let s = &verdict.samples;
    d.set_item("samples", [s.n_done, s.n_bridged, s.n_after_gap, s.n_late, s.n_refused, s.n_stopped])?;
    d.set_item("clock_jumps", verdict.clock_jumps)?;
    let t = &verdict.tally;
    d.set_item("snapshot_tests", (t.n, t.n_raised, t.sum, t.most))?;
    Ok(d)
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(ins_roll, m)?)?;
    m.add_class::<Sensors>()
}
