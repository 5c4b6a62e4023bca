//! The list of algorithms of protection levels, and any of them by its id.

use crate::araim::{promise, refused, systems, users};
use crate::fields::fields;
use crate::gnss::orbit;
use navbound_assess::outlook::{Outcome, Outlook, Row, predict_by_id};
use navbound_core::bound::{ALGORITHMS, Levels, Ranges};
use navbound_core::geometry::Elements;
use navbound_core::quantity::Radians;
use numpy::{IntoPyArray, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Every algorithm of protection levels.
#[pyfunction]
fn protection_methods(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    ALGORITHMS
        .iter()
        .map(|entry| {
            let p = &entry.protection;
            let d = PyDict::new(py);
            fields!(d, p: id, title, function, source);
            d.set_item("provenance", p.provenance.word())?;
            fields!(d, p: covers, assumes, integrity);
            d.set_item("of_orbits", entry.ranges == Some(Ranges::Receiver))?;
            Ok(d)
        })
        .collect()
}

/// Levels of every user at every instant by the algorithm of an id with its usual settings, instants first; orbits are rows of seven
/// elements.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "one for each array of the Python function")]
fn algorithm_predict<'py>(
    py: Python<'py>,
    algorithm: &str,
    elements: PyReadonlyArray2<'_, f64>,
    constellation: Vec<usize>,
    time_s: PyReadonlyArray1<'_, f64>,
    lat_rad: PyReadonlyArray1<'_, f64>,
    lon_rad: PyReadonlyArray1<'_, f64>,
    h_m: PyReadonlyArray1<'_, f64>,
    mask_rad: f64,
    support: [[f64; 6]; 5],
    airborne: [f64; 4],
) -> PyResult<Bound<'py, PyDict>> {
    let orbits: Vec<Elements> = elements.as_slice()?.as_chunks().0.iter().map(orbit).collect();
    let users = users(lat_rad.as_slice()?, lon_rad.as_slice()?, h_m.as_slice()?)?;
    let (systems, promise) = (systems(&constellation)?, promise(&support, airborne)?);
    let mask = Radians::new(mask_rad);
    let outlook = Outlook { orbits: &orbits, constellation: &systems, time_s: time_s.as_slice()?, users: &users, mask, promise };
    let listed =
        py.detach(|| predict_by_id(algorithm, &outlook)).ok_or_else(|| PyKeyError::new_err(algorithm.to_owned()))?.map_err(refused)?;
    let d = levels(py, &listed.rows)?;
    for (name, values) in listed.numbers {
        d.set_item(name, values.into_pyarray(py))?;
    }
    Ok(d)
}

/// Levels, satellites used and outcomes as columns; NaN where an epoch has no position.
pub(crate) fn levels<'py, D>(py: Python<'py>, rows: &[Row<D>]) -> PyResult<Bound<'py, PyDict>> {
    let level = |f: fn(&Levels<D>) -> f64| rows.iter().map(|r| r.levels.as_ref().map_or(f64::NAN, f)).collect::<Vec<_>>().into_pyarray(py);
    let d = PyDict::new(py);
    d.set_item("hpl_m", level(|l| l.hpl.m()))?;
    d.set_item("vpl_m", level(Levels::vpl_m))?;
    d.set_item("n_sv", rows.iter().map(|r| r.n_sv as i64).collect::<Vec<_>>().into_pyarray(py))?;
    d.set_item("outcome", rows.iter().map(|r| r.outcome as u8).collect::<Vec<_>>().into_pyarray(py))?;
    d.set_item("words", Outcome::WORDS.to_vec())?;
    Ok(d)
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(protection_methods, m)?)?;
    m.add_function(wrap_pyfunction!(algorithm_predict, m)?)
}
