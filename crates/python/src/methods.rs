//! The list of methods, and any of them over an epoch table.

use crate::error::input_error;
use navbound_assess::bounds::{self, Columns};
use navbound_core::bound;
use navbound_core::quantity::Risk;
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::exceptions::{PyKeyError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Every method: id, title, source, provenance, error column, assumptions, promises.
#[pyfunction]
fn methods(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    bound::methods()
        .map(|m| {
            let d = PyDict::new(py);
            d.set_item("id", m.id)?;
            d.set_item("title", m.title)?;
            d.set_item("source", m.source)?;
            d.set_item("provenance", m.provenance.word())?;
            d.set_item("error_column", m.bounds.error_column())?;
            d.set_item("assumes", m.assumes)?;
            d.set_item("scales_with_length", m.promises.scales_with_length)?;
            d.set_item("ignores_north", m.promises.ignores_north)?;
            d.set_item("monotone_in_risk", m.promises.monotone_in_risk)?;
            d.set_item("conservative", m.promises.conservative)?;
            d.set_item("may_alert", m.promises.may_alert)?;
            Ok(d)
        })
        .collect()
}

/// Every algorithm of protection levels: id, title, function, source, provenance, what it covers and assumes, whether integrity may rest on it.
#[pyfunction]
fn protection_methods(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    bound::PROTECTION
        .iter()
        .map(|p| {
            let d = PyDict::new(py);
            d.set_item("id", p.id)?;
            d.set_item("title", p.title)?;
            d.set_item("function", p.function)?;
            d.set_item("source", p.source)?;
            d.set_item("provenance", p.provenance.word())?;
            d.set_item("covers", p.covers)?;
            d.set_item("assumes", p.assumes)?;
            d.set_item("integrity", p.integrity)?;
            Ok(d)
        })
        .collect()
}

/// Bound, reason code and list of (invalid, words).
type Column<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<u32>>, Vec<(bool, String)>);

/// One method over columns of the epoch table, all of length `n_epochs`; an absent column is left out of the dictionary.
#[pyfunction]
fn bounds_of<'py>(py: Python<'py>, method: &str, risk: f64, n_epochs: usize, columns: &Bound<'py, PyDict>) -> PyResult<Column<'py>> {
    let method = bound::method(method).ok_or_else(|| PyKeyError::new_err(method.to_owned()))?;
    let risk = Risk::new(risk).map_err(|e| input_error(e, None))?;
    let get = |name: &str| -> PyResult<Option<PyReadonlyArray1<'py, f64>>> {
        let Some(value) = columns.get_item(name)? else { return Ok(None) };
        let array: PyReadonlyArray1<'py, f64> = value.extract()?;
        if array.as_array().len() != n_epochs {
            return Err(PyValueError::new_err(format!("{name} has {} rows, the table {n_epochs}", array.as_array().len())));
        }
        Ok(Some(array))
    };
    let course = get("course_rad")?;
    let path_angle = get("path_angle_rad")?;
    let fte = get("fte_m")?;
    let fte_v = get("fte_v_m")?;
    let rnp = get("rnp_m")?;
    let mut covariance = Vec::with_capacity(6);
    for name in ["cov_ee_m2", "cov_en_m2", "cov_nn_m2", "cov_eu_m2", "cov_nu_m2", "cov_uu_m2"] {
        covariance.push(get(name)?);
    }
    let mut covariance_m2 = [None; 6];
    for (slot, column) in covariance_m2.iter_mut().zip(&covariance) {
        *slot = slice(column)?;
    }
    let table = Columns {
        len: n_epochs,
        course_rad: slice(&course)?,
        path_angle_rad: slice(&path_angle)?,
        fte_m: slice(&fte)?,
        fte_v_m: slice(&fte_v)?,
        rnp_m: slice(&rnp)?,
        covariance_m2,
    };
    let column = py.detach(|| bounds::bounds(&table, method, risk));
    let reasons = column.reasons.into_iter().map(|r| (r.invalid, r.words)).collect();
    Ok((column.bound_m.into_pyarray(py), column.reason.into_pyarray(py), reasons))
}

fn slice<'a>(array: &'a Option<PyReadonlyArray1<'_, f64>>) -> PyResult<Option<&'a [f64]>> {
    array.as_ref().map(|a| a.as_slice().map_err(Into::into)).transpose()
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(methods, m)?)?;
    m.add_function(wrap_pyfunction!(protection_methods, m)?)?;
    m.add_function(wrap_pyfunction!(bounds_of, m)?)
}
