//! The list of methods, as Python sees it.

use navbound_core::bound;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Every method: id, title, source, provenance, bounds (error column), assumes, promises.
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

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(methods, m)?)
}
