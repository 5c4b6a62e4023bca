//! The list of methods, and any of them over an epoch table.

use crate::error::input_error;
use crate::fields::fields;
use navbound_assess::bounds::{self, Columns};
use navbound_assess::judge;
use navbound_core::bound;
use navbound_core::judge::Errors;
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
            fields!(d, m: id, title, source);
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

/// Bound, reason code and list of (id of the reason, words).
type Column<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<u32>>, Vec<(&'static str, String)>);

/// A risk inside its domain, as it came; for settings that are checked before they are used.
#[pyfunction]
fn checked_risk(q: f64) -> PyResult<f64> {
    Risk::new(q).map(Risk::q).map_err(|e| input_error(e, None))
}

/// One method over columns of the epoch table, all of length `n_epochs`; an absent column is left out of the dictionary.
#[pyfunction]
fn bounds_of<'py>(py: Python<'py>, method: &str, risk: f64, n_epochs: usize, columns: &Bound<'py, PyDict>) -> PyResult<Column<'py>> {
    let method = bound::method(method).ok_or_else(|| PyKeyError::new_err(method.to_owned()))?;
    let risk = Risk::new(risk).map_err(|e| input_error(e, None))?;
    let stored = Table::of(n_epochs, columns)?;
    let (table, ..) = stored.parts()?;
    let column = py.detach(|| bounds::bounds(&table, method, risk));
    let reasons = column.reasons.into_iter().map(|r| (r.reason.id(), r.words)).collect();
    Ok((column.bound_m.into_pyarray(py), column.reason.into_pyarray(py), reasons))
}

/// Columns of an epoch table, kept from the collector while they are read.
pub(crate) struct Table<'py> {
    len: usize,
    stored: Vec<Option<PyReadonlyArray1<'py, f64>>>,
}

/// Columns that methods read, then those of the navigation error, then the protection level.
pub(crate) const COLUMNS: [&str; 15] = [
    "course_rad",
    "path_angle_rad",
    "fte_m",
    "fte_v_m",
    "rnp_m",
    "cov_ee_m2",
    "cov_en_m2",
    "cov_nn_m2",
    "cov_eu_m2",
    "cov_nu_m2",
    "cov_uu_m2",
    "nse_e_m",
    "nse_n_m",
    "nse_u_m",
    "hpl_m",
];

/// Columns of methods, those of the navigation error, and the protection level.
pub(crate) type Parts<'a> = (Columns<'a>, judge::Errs<'a>, Option<&'a [f64]>);

/// All columns in the order of [`COLUMNS`] as the parts of a table.
pub(crate) fn parts(len: usize, slices: [Option<&[f64]>; COLUMNS.len()]) -> Parts<'_> {
    let [course_rad, path_angle_rad, fte_m, fte_v_m, rnp_m, ee, en, nn, eu, nu, uu, east, north, up, hpl_m] = slices;
    let covariance_m2 = [ee, en, nn, eu, nu, uu];
    (Columns { len, course_rad, path_angle_rad, fte_m, fte_v_m, rnp_m, covariance_m2 }, [east, north, up], hpl_m)
}

impl<'py> Table<'py> {
    pub(crate) fn of(len: usize, columns: &Bound<'py, PyDict>) -> PyResult<Self> {
        let stored = COLUMNS.iter().map(|name| {
            let Some(value) = columns.get_item(name)? else { return Ok(None) };
            let array: PyReadonlyArray1<'py, f64> = value.extract()?;
            if array.as_array().len() != len {
                return Err(PyValueError::new_err(format!("{name} has {} rows, the table {len}", array.as_array().len())));
            }
            Ok(Some(array))
        });
        Ok(Self { len, stored: stored.collect::<PyResult<_>>()? })
    }

    pub(crate) fn parts(&self) -> PyResult<Parts<'_>> {
        let mut slices = [None; COLUMNS.len()];
        for (slot, column) in slices.iter_mut().zip(&self.stored) {
            *slot = column.as_ref().map(|a| a.as_slice()).transpose()?;
        }
        Ok(parts(self.len, slices))
    }
}

/// Errors of every epoch along the axes of its path: a column each, NaN where a part is unknown.
#[pyfunction]
fn errors_of<'py>(py: Python<'py>, n_epochs: usize, columns: &Bound<'py, PyDict>) -> PyResult<Bound<'py, PyDict>> {
    let stored = Table::of(n_epochs, columns)?;
    let (table, nse_m, _) = stored.parts()?;
    let errors = py.detach(|| judge::errors(&table, nse_m));
    let d = PyDict::new(py);
    for (name, of) in ERRORS {
        d.set_item(name, errors.iter().map(|e| of(e).unwrap_or(f64::NAN)).collect::<Vec<_>>().into_pyarray(py))?;
    }
    Ok(d)
}

/// One column of errors.
type Error = (&'static str, fn(&Errors) -> Option<f64>);
const ERRORS: [Error; 7] = [
    ("nse_h_m", |e| e.horizontal_m),
    ("nse_3d_m", |e| e.spatial_m),
    ("nse_along_m", |e| e.along_m),
    ("nse_cross_m", |e| e.cross_m),
    ("tse_m", |e| e.tse_m),
    ("tse_v_m", |e| e.tse_v_m),
    ("sigma_cross_m", |e| e.sigma_cross_m),
];

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(methods, m)?)?;
    m.add_function(wrap_pyfunction!(checked_risk, m)?)?;
    m.add_function(wrap_pyfunction!(errors_of, m)?)?;
    m.add_function(wrap_pyfunction!(bounds_of, m)?)
}
