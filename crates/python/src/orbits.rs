//! Orbits and clocks of analysis centres, and almanacs.

use crate::error::{format_error, input_error};
use crate::gnss::orbit;
use navbound_core::geometry::Elements;
use navbound_core::quantity::{GpsTime, OutOfDomain};
use navbound_core::signal::{Constellation, SatelliteId};
use navbound_formats::packed::unpack;
use navbound_formats::precise::Precise;
use navbound_formats::{Refusal, almanac, rinex, sp3};
use numpy::{IntoPyArray, PyArrayMethods, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::collections::{BTreeMap, BTreeSet};

/// Orbit and clock files, read and merged.
#[pyclass(frozen, module = "navbound._core")]
pub struct PreciseOrbits {
    tables: Precise,
    /// Refused lines with their file.
    refused: Vec<(String, Refusal)>,
}

impl PreciseOrbits {
    pub fn tables(&self) -> &Precise {
        &self.tables
    }
}

#[pymethods]
impl PreciseOrbits {
    /// Read from the bytes of files, plain or gzip, each with its path for messages; SP3 is recognised by its first character.
    #[new]
    fn new(py: Python<'_>, files: Vec<(Vec<u8>, String)>) -> PyResult<Self> {
        let (mut tables, mut refused) = (Precise::default(), Vec::new());
        for (content, path) in files {
            let read = || {
                let plain = unpack(&content)?;
                if plain.first() == Some(&b'#') { sp3::read(&plain) } else { rinex::read_clocks(&plain) }
            };
            let mut file = py.detach(read).map_err(|e| format_error(&path, &e))?;
            refused.extend(file.refused.drain(..).map(|r| (path.clone(), r)));
            tables.merge(file);
        }
        Ok(Self { tables, refused })
    }
    #[getter]
    fn satellites(&self) -> Vec<String> {
        self.tables.orbits.keys().map(ToString::to_string).collect()
    }
    #[getter]
    fn n_positions(&self) -> usize {
        self.tables.orbits.values().map(Vec::len).sum()
    }
    #[getter]
    fn n_clocks(&self) -> usize {
        self.tables.clock_tables().values().map(Vec::len).sum()
    }
    #[getter]
    fn dense_clocks(&self) -> bool {
        !self.tables.clocks.is_empty()
    }
    #[getter]
    fn clock_step_s(&self) -> Option<f64> {
        self.tables.clock_step_s()
    }
    #[getter]
    fn frames(&self) -> BTreeSet<String> {
        self.tables.frames.clone()
    }
    #[getter]
    fn agencies(&self) -> BTreeSet<String> {
        self.tables.agencies.clone()
    }
    #[getter]
    fn skipped(&self) -> BTreeMap<String, usize> {
        self.tables.skipped.clone()
    }
    #[getter]
    fn refused(&self) -> Vec<(String, usize, String, String, String)> {
        let row = |(path, r): &(String, Refusal)| (path.clone(), r.line, r.field.clone(), r.reason.clone(), r.text.clone());
        self.refused.iter().map(row).collect()
    }
    /// Mass centre (n, 3), velocity (n, 3) and clock (n) of a satellite; NaN where the tables do not reach.
    fn states<'py>(&self, py: Python<'py>, satellite: &str, time_ns: PyReadonlyArray1<'py, i64>) -> PyResult<Option<Bound<'py, PyDict>>> {
        let Some(id) = satellite_id(satellite).filter(|id| self.tables.orbits.contains_key(id)) else { return Ok(None) };
        let tables = self.tables.tables();
        let (mut place, mut velocity, mut clock) = (Vec::new(), Vec::new(), Vec::new());
        for time in time_ns.as_slice()? {
            let state = tables.state(id, GpsTime::from_nanoseconds(*time)).ok();
            place.extend(state.map_or([f64::NAN; 3], |s| (*s.position.vector()).into()));
            velocity.extend(state.map_or([f64::NAN; 3], |s| s.velocity_mps.into()));
            clock.push(state.map_or(f64::NAN, |s| s.clock_s));
        }
        let d = PyDict::new(py);
        let n = clock.len();
        d.set_item("ecef_m", place.into_pyarray(py).reshape([n, 3])?)?;
        d.set_item("velocity_mps", velocity.into_pyarray(py).reshape([n, 3])?)?;
        d.set_item("clock_s", clock.into_pyarray(py))?;
        Ok(Some(d))
    }
}

/// `G01`.
pub fn satellite_id(name: &str) -> Option<SatelliteId> {
    let constellation = Constellation::from_letter(*name.as_bytes().first()?)?;
    Some(SatelliteId { constellation, number: name.get(1..)?.parse().ok()? })
}

/// Satellites by name with elements that are moved by some time.
pub fn named(names: &[String], elements: &[[f64; 7]], since_s: f64) -> PyResult<Vec<(SatelliteId, Elements)>> {
    let one = |(index, (name, row)): (usize, (&String, &[f64; 7]))| {
        let id = satellite_id(name).ok_or_else(|| PyValueError::new_err(format!("{name}: no satellite")))?;
        let moved = orbit(row).moved(since_s).map_err(|e: OutOfDomain| input_error(e, Some(index)))?;
        Ok((id, moved))
    };
    names.iter().zip(elements).enumerate().map(one).collect()
}

/// An almanac: satellites, health, constellation indices, elements at one instant, and that instant where the week is known.
#[pyfunction]
#[pyo3(signature = (content, path, near_ns))]
fn read_almanac<'py>(py: Python<'py>, content: &[u8], path: &str, near_ns: Option<i64>) -> PyResult<Bound<'py, PyDict>> {
    let read = || almanac::read(&unpack(content)?);
    let (entries, other_time) = almanac::of_one_time(py.detach(read).map_err(|e| format_error(path, &e))?);
    let near = near_ns.map(GpsTime::from_nanoseconds);
    // Times among satellites count from the first.
    let first = entries.first().map_or((0, 0.0), |e| (e.week, e.time_of_week_s));
    let mut elements = Vec::with_capacity(entries.len());
    for (index, e) in entries.iter().enumerate() {
        let later = entries.first().map_or(0.0, |first| almanac::later_s(e, first));
        elements.push(e.elements.moved(-later).map_err(|e: OutOfDomain| input_error(e, Some(index)))?);
    }
    let column = |f: fn(&Elements) -> f64| elements.iter().map(f).collect::<Vec<_>>().into_pyarray(py);
    let d = PyDict::new(py);
    d.set_item("satellite", entries.iter().map(|e| e.satellite.to_string()).collect::<Vec<_>>())?;
    d.set_item("constellation", entries.iter().map(|e| e.satellite.constellation.index()).collect::<Vec<_>>())?;
    d.set_item("semi_major_m", column(|e| e.semi_major.m()))?;
    d.set_item("eccentricity", column(|e| e.eccentricity))?;
    d.set_item("inclination_rad", column(|e| e.inclination.rad()))?;
    d.set_item("node_rad", column(|e| e.node.rad()))?;
    d.set_item("node_rate_radps", column(|e| e.node_rate_radps))?;
    d.set_item("perigee_rad", column(|e| e.perigee.rad()))?;
    d.set_item("mean_anomaly_rad", column(|e| e.mean_anomaly.rad()))?;
    d.set_item("health", entries.iter().map(|e| e.health).collect::<Vec<_>>())?;
    d.set_item("of_other_time", other_time.iter().map(|e| e.satellite.to_string()).collect::<Vec<_>>())?;
    d.set_item("reference_ns", almanac::reference(first.0, first.1, near).map(GpsTime::nanoseconds))?;
    Ok(d)
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_class::<PreciseOrbits>()?;
    m.add_function(wrap_pyfunction!(read_almanac, m)?)
}
