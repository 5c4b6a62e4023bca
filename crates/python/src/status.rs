//! The lists of statuses and of reasons.

use navbound_core::quantity::{Reason, Status};
use pyo3::prelude::*;

/// Every status: id, whether the position may be used, words.
#[pyfunction]
fn statuses() -> Vec<(&'static str, bool, &'static str)> {
    Status::ALL.iter().map(|s| (s.id(), s.usable(), s.words())).collect()
}

/// Every reason: id, status that it gives an epoch, words.
#[pyfunction]
fn reasons() -> Vec<(&'static str, &'static str, &'static str)> {
    Reason::ALL.iter().map(|r| (r.id(), r.status().id(), r.words())).collect()
}

/// The id of the status that a reason gives an epoch.
pub fn of(reason: Option<Reason>) -> &'static str {
    reason.map_or(Status::Ok, Reason::status).id()
}

/// The id of a reason, empty for none.
pub fn id(reason: Option<Reason>) -> &'static str {
    reason.map_or("", Reason::id)
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(statuses, m)?)?;
    m.add_function(wrap_pyfunction!(reasons, m)?)
}
