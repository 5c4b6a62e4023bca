//! The formats of files, and the positions that logs of receivers report.

use crate::error::input_error;
use crate::fields::fields;
use navbound_core::quantity::{GpsTime, OutOfDomain};
use navbound_formats::receiver::position::{Kind, Position, log};
use navbound_formats::registry::{FORMATS, File, recognise};
use numpy::{IntoPyArray, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Positions of a log of `kind` as columns, NaN where a message does not state a number; `left_out` as (reason id, damaged, count, first
/// message, example); `few`: what a position counts of satellites that make it none; `fields` from quantity to message; `notes` as (id, two numbers); `undated`: the first of positions that nothing dates.
#[pyfunction]
fn read_positions<'py>(py: Python<'py>, content: &[u8], kind: &str) -> PyResult<Bound<'py, PyDict>> {
    let unknown = OutOfDomain { argument: "kind", value: f64::NAN, unit: "id", domain: "ubx, sbf, novatel, nmea" };
    let kind = Kind::of(kind).ok_or_else(|| input_error(unknown, None))?;
    let log = py.detach(|| log::read(content, kind));
    let d = PyDict::new(py);
    let (rows, n) = (&log.positions, log.positions.len());
    let column = |of: fn(&Position) -> Option<f64>| rows.iter().map(|p| of(p).unwrap_or(f64::NAN)).collect::<Vec<_>>().into_pyarray(py);
    d.set_item("record", rows.iter().map(|p| p.record).collect::<Vec<_>>().into_pyarray(py))?;
    d.set_item("time_ns", rows.iter().map(|p| p.time.map_or(0, GpsTime::nanoseconds)).collect::<Vec<_>>().into_pyarray(py))?;
    for (name, of) in COLUMNS {
        d.set_item(name, column(of))?;
    }
    d.set_item("few", rows.iter().map(|p| p.absent.as_ref().map(|absent| absent.stated.as_str())).collect::<Vec<_>>())?;
    d.set_item("n_sv", rows.iter().map(|p| p.n_sv).collect::<Vec<_>>())?;
    let covariance: Vec<f64> = rows.iter().flat_map(|p| p.covariance_m2.unwrap_or([f64::NAN; 6])).collect();
    d.set_item("cov_m2", covariance.into_pyarray(py).reshape([n, 6])?)?;
    d.set_item("n_rows", log.n_rows)?;
    d.set_item("absent_ns", log.absent.iter().map(|time| time.map(GpsTime::nanoseconds)).collect::<Vec<_>>())?;
    fields!(d, log: n_outside, undated, fields);
    d.set_item("notes", log.notes.iter().map(|note| note.id()).collect::<Vec<_>>())?;
    let left_out: Vec<_> = log.left_out.into_iter().map(|l| (l.reason, l.damaged, l.count, l.first, l.example)).collect();
    d.set_item("left_out", left_out)?;
    Ok(d)
}

/// A number of a position.
type Number = fn(&Position) -> Option<f64>;

/// Columns of plain numbers, by docs/notation.md.
const COLUMNS: [(&str, Number); 11] = [
    ("est_lat_rad", |p| p.lat_rad),
    ("est_lon_rad", |p| p.lon_rad),
    ("est_h_m", |p| p.h_m),
    ("ground_speed_mps", |p| p.ground_speed_mps),
    ("ground_track_rad", |p| p.ground_track_rad),
    ("vertical_rate_mps", |p| p.vertical_rate_mps),
    ("hdop", |p| p.hdop),
    ("vdop", |p| p.vdop),
    ("hpl_m", |p| p.hpl_m),
    ("vpl_m", |p| p.vpl_m),
    ("unread_accuracy_m", |p| p.unread_accuracy_m),
];

/// Ids of the kinds of logs and the messages that hold their positions, covariances first.
#[pyfunction]
fn position_logs() -> Vec<(&'static str, &'static str)> {
    Kind::ALL.into_iter().map(|kind| (kind.id(), kind.positions())).collect()
}

/// Id, title, what it holds, how it is recognised, and what to do instead where it is not read.
type Entry = (&'static str, &'static str, Vec<&'static str>, &'static str, Option<&'static str>);

/// Every format, in the order in which they are tried.
#[pyfunction]
fn formats() -> Vec<Entry> {
    FORMATS.iter().map(|f| (f.id, f.title, f.holds.iter().map(|holds| holds.id()).collect(), f.sign, f.instead)).collect()
}

/// Id of the format of a file: its content, unpacked, and its name in small letters without the ending of its packing.
#[pyfunction]
fn format_of(content: &[u8], name: &str) -> &'static str {
    recognise(FORMATS, &File { content, name }).map_or("csv", |format| format.id)
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(read_positions, m)?)?;
    m.add_function(wrap_pyfunction!(position_logs, m)?)?;
    m.add_function(wrap_pyfunction!(formats, m)?)?;
    m.add_function(wrap_pyfunction!(format_of, m)?)
}
