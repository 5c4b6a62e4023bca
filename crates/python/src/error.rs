//! Rust refusals to Python errors, in one place.

use navbound_core::quantity::OutOfDomain;
use navbound_formats::Unreadable;
use pyo3::prelude::*;

/// `navbound.InputError`, with `.argument`, `.value`, `.unit`, `.domain` and, for arrays, `.index`.
pub fn input_error(e: OutOfDomain, index: Option<usize>) -> PyErr {
    Python::attach(|py| {
        match py
            .import("navbound.errors")
            .and_then(|m| m.getattr("InputError"))
            .and_then(|class| class.call1((e.argument, e.value, e.unit, e.domain, index)))
        {
            Ok(value) => PyErr::from_value(value),
            Err(failure) => failure,
        }
    })
}

/// `navbound.FormatError`, with `.path`, `.line` and `.field`.
pub fn format_error(path: &str, e: &Unreadable) -> PyErr {
    Python::attach(|py| {
        match py
            .import("navbound.errors")
            .and_then(|m| m.getattr("FormatError"))
            .and_then(|class| class.call1((path, e.reason.as_str(), e.line, e.field.as_deref())))
        {
            Ok(value) => PyErr::from_value(value),
            Err(failure) => failure,
        }
    })
}
