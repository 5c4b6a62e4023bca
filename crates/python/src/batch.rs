//! Flat arrays to batch loops and back.

use crate::error::input_error;
use navbound_assess::batch::{self, Factors, Rejected, rows};
use navbound_core::quantity::OutOfDomain;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;

/// A refused item as a Python error.
pub fn rejected(e: Rejected) -> PyErr {
    input_error(e.reason, Some(e.index))
}

/// One number an item, worked out without the interpreter's lock.
pub fn numbers<'py>(
    py: Python<'py>,
    n: usize,
    item: impl Fn(usize) -> Result<f64, OutOfDomain> + Sync + Send,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let out = py.detach(|| rows(n, |i| Ok([item(i)?]))).map_err(rejected)?;
    Ok(out.into_pyarray(py))
}

/// The same, each item at its own risk.
pub fn at_risks<'py>(
    py: Python<'py>,
    n: usize,
    item: impl Fn(usize, &mut Factors) -> Result<f64, OutOfDomain> + Sync + Send,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let out = py.detach(|| batch::at_risks(n, item)).map_err(rejected)?;
    Ok(out.into_pyarray(py))
}

/// `M` numbers an item, shape (n, M).
pub fn table<'py, const M: usize>(
    py: Python<'py>,
    n: usize,
    item: impl Fn(usize) -> Result<[f64; M], OutOfDomain> + Sync + Send,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let out = py.detach(|| rows(n, item)).map_err(rejected)?;
    out.into_pyarray(py).reshape([n, M])
}
