//! Satellite geometry.

use crate::error::input_error;
use crate::status;
use navbound_assess::dop_map::{Users, dops};
use navbound_assess::sky::{self, Receivers, Sights, Solved};
use navbound_core::geometry::{BEIDOU, Elements, GALILEO, GPS, GPS_EXPANDED, Slot};
use navbound_core::quantity::{Metres, Radians, Unavailable};
use navbound_core::solution::wls;
use navbound_path::AtIndex;
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

fn refused(e: AtIndex) -> PyErr {
    input_error(e.error, Some(e.index))
}

/// The shipped constellations by name: satellites, constellation indices and elements.
#[pyfunction]
fn nominal_constellations(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let d = PyDict::new(py);
    d.set_item("gps", slots(py, &GPS)?)?;
    d.set_item("gps-expanded", slots(py, &GPS_EXPANDED)?)?;
    d.set_item("galileo", slots(py, &GALILEO)?)?;
    d.set_item("beidou", slots(py, &BEIDOU)?)?;
    Ok(d)
}

fn slots<'py>(py: Python<'py>, slots: &[Slot]) -> PyResult<Bound<'py, PyDict>> {
    let column = |f: fn(&Elements) -> f64| slots.iter().map(|s| f(&s.elements)).collect::<Vec<_>>().into_pyarray(py);
    let d = PyDict::new(py);
    d.set_item("satellite", slots.iter().map(|s| s.satellite.to_string()).collect::<Vec<_>>())?;
    d.set_item("constellation", slots.iter().map(|s| s.satellite.constellation.index()).collect::<Vec<_>>())?;
    d.set_item("semi_major_m", column(|e| e.semi_major.m()))?;
    d.set_item("eccentricity", column(|e| e.eccentricity))?;
    d.set_item("inclination_rad", column(|e| e.inclination.rad()))?;
    d.set_item("node_rad", column(|e| e.node.rad()))?;
    d.set_item("perigee_rad", column(|e| e.perigee.rad()))?;
    d.set_item("mean_anomaly_rad", column(|e| e.mean_anomaly.rad()))?;
    Ok(d)
}

/// Azimuths and elevations, one row an epoch and one column an orbit; orbits are rows of seven elements.
#[pyfunction]
fn satellite_directions<'py>(
    py: Python<'py>,
    elements: PyReadonlyArray2<'_, f64>,
    lat_rad: PyReadonlyArray1<'_, f64>,
    lon_rad: PyReadonlyArray1<'_, f64>,
    h_m: PyReadonlyArray1<'_, f64>,
    time_s: PyReadonlyArray1<'_, f64>,
) -> PyResult<Bound<'py, PyDict>> {
    let orbits: Vec<Elements> = elements.as_slice()?.as_chunks().0.iter().map(orbit).collect();
    let at = Receivers { lat_rad: lat_rad.as_slice()?, lon_rad: lon_rad.as_slice()?, h_m: h_m.as_slice()?, time_s: time_s.as_slice()? };
    let sky = py.detach(|| sky::directions(&orbits, &at)).map_err(refused)?;
    let d = PyDict::new(py);
    d.set_item("az_rad", sky.az_rad.into_pyarray(py))?;
    d.set_item("el_rad", sky.el_rad.into_pyarray(py))?;
    Ok(d)
}

pub fn orbit(&[a, e, i, node, perigee, anomaly, node_rate_radps]: &[f64; 7]) -> Elements {
    let [inclination, node, perigee, mean_anomaly] = [i, node, perigee, anomaly].map(Radians::new);
    Elements { semi_major: Metres::new(a), eccentricity: e, inclination, node, node_rate_radps, perigee, mean_anomaly }
}

/// Places at a distance along lines of sight, Earth-centred, one row a receiver and one place a satellite.
#[pyfunction]
fn places_along<'py>(
    py: Python<'py>,
    receiver: (PyReadonlyArray1<'_, f64>, PyReadonlyArray1<'_, f64>, PyReadonlyArray1<'_, f64>),
    az_rad: Vec<f64>,
    el_rad: Vec<f64>,
    distance_m: f64,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let (lat_rad, lon_rad, h_m) = (receiver.0.as_slice()?, receiver.1.as_slice()?, receiver.2.as_slice()?);
    let at = Receivers { lat_rad, lon_rad, h_m, time_s: &[] };
    let places = sky::along_sights(&at, &sky::Sky { az_rad, el_rad }, Metres::new(distance_m)).map_err(refused)?;
    Ok(places.into_flattened().into_pyarray(py))
}

/// Covariances of least-squares positions, nine numbers an epoch, NaN where there is none; `n_sv`; `reason`, empty where there is one.
#[pyfunction]
fn position_covariances<'py>(
    py: Python<'py>,
    az_rad: PyReadonlyArray1<'_, f64>,
    el_rad: PyReadonlyArray1<'_, f64>,
    sigma_m: PyReadonlyArray1<'_, f64>,
    constellation: Vec<usize>,
) -> PyResult<Bound<'py, PyDict>> {
    let sights =
        Sights { az_rad: az_rad.as_slice()?, el_rad: el_rad.as_slice()?, sigma_m: sigma_m.as_slice()?, constellation: &constellation };
    let solved = py.detach(|| sky::covariances(&sights)).map_err(refused)?;
    let (d, values) = shared(py, solved, 9, |v, out| {
        let (major, minor) = wls::horizontal_axes(v);
        out.extend(v.matrix().iter());
        (major.m(), minor.m())
    })?;
    let (matrices, axes): (Vec<f64>, Vec<(f64, f64)>) = values;
    d.set_item("enu_m2", matrices.into_pyarray(py))?;
    d.set_item("sigma_major_m", axes.iter().map(|a| a.0).collect::<Vec<_>>().into_pyarray(py))?;
    d.set_item("sigma_minor_m", axes.iter().map(|a| a.1).collect::<Vec<_>>().into_pyarray(py))?;
    Ok(d)
}

/// Metres of position for a metre in each range: three numbers a satellite, NaN for one that is not used; `n_sv`; `reason`.
#[pyfunction]
fn position_responses<'py>(
    py: Python<'py>,
    az_rad: PyReadonlyArray1<'_, f64>,
    el_rad: PyReadonlyArray1<'_, f64>,
    sigma_m: PyReadonlyArray1<'_, f64>,
    constellation: Vec<usize>,
) -> PyResult<Bound<'py, PyDict>> {
    let sights =
        Sights { az_rad: az_rad.as_slice()?, el_rad: el_rad.as_slice()?, sigma_m: sigma_m.as_slice()?, constellation: &constellation };
    let solved = py.detach(|| sky::responses(&sights)).map_err(refused)?;
    let (d, (rows, _)) = shared(py, solved, 3 * constellation.len(), |all, out| {
        out.extend(all.iter().flat_map(|s| [s.x, s.y, s.z]));
        (f64::NAN, f64::NAN)
    })?;
    d.set_item("response", rows.into_pyarray(py))?;
    Ok(d)
}

/// Dilutions of precision, NaN where there is none; `n_sv`; `reason`.
#[pyfunction]
fn dilutions<'py>(
    py: Python<'py>,
    az_rad: PyReadonlyArray1<'_, f64>,
    el_rad: PyReadonlyArray1<'_, f64>,
    constellation: Vec<usize>,
) -> PyResult<Bound<'py, PyDict>> {
    let (az, el) = (az_rad.as_slice()?, el_rad.as_slice()?);
    // Dilution knows no sigma: every range counts one metre.
    let ones = vec![1.0; az.len()];
    let sights = Sights { az_rad: az, el_rad: el, sigma_m: &ones, constellation: &constellation };
    let solved = py.detach(|| sky::dilutions(&sights)).map_err(refused)?;
    let (d, (rows, _)) = shared(py, solved, 5, |q, out| {
        out.extend([q.east, q.north, q.horizontal, q.vertical, q.position]);
        (f64::NAN, f64::NAN)
    })?;
    for (i, name) in ["edop", "ndop", "hdop", "vdop", "pdop"].into_iter().enumerate() {
        d.set_item(name, rows.iter().skip(i).step_by(5).copied().collect::<Vec<_>>().into_pyarray(py))?;
    }
    Ok(d)
}

/// Dilutions of users at instants, the instants of a user together, NaN where there is none; `n_sv`.
#[pyfunction]
fn dop_map<'py>(
    py: Python<'py>,
    elements: PyReadonlyArray2<'_, f64>,
    constellation: Vec<usize>,
    users: (PyReadonlyArray1<'_, f64>, PyReadonlyArray1<'_, f64>, PyReadonlyArray1<'_, f64>),
    time_s: PyReadonlyArray1<'_, f64>,
    mask_rad: f64,
) -> PyResult<Bound<'py, PyDict>> {
    let elements = elements.as_slice()?.as_chunks().0.iter().map(orbit);
    let orbits: Vec<(Elements, usize)> = elements.zip(constellation).collect();
    let users = Users { lat_rad: users.0.as_slice()?, lon_rad: users.1.as_slice()?, h_m: users.2.as_slice()? };
    let time_s = time_s.as_slice()?;
    let dilutions = py.detach(|| dops(&orbits, &users, time_s, Radians::new(mask_rad))).map_err(refused)?;
    let d = PyDict::new(py);
    d.set_item("hdop", dilutions.hdop.into_pyarray(py))?;
    d.set_item("vdop", dilutions.vdop.into_pyarray(py))?;
    d.set_item("pdop", dilutions.pdop.into_pyarray(py))?;
    d.set_item("gdop", dilutions.gdop.into_pyarray(py))?;
    d.set_item("n_sv", dilutions.n_sv.into_pyarray(py))?;
    Ok(d)
}

type Columns = (Vec<f64>, Vec<(f64, f64)>);

/// `n_sv` and `reason` of every epoch, and its numbers: `width` of them, and a pair; NaN where there is no result.
fn shared<'py, T>(
    py: Python<'py>,
    solved: Solved<T>,
    width: usize,
    write: impl Fn(&T, &mut Vec<f64>) -> (f64, f64),
) -> PyResult<(Bound<'py, PyDict>, Columns)> {
    let (mut rows, mut pairs) = (Vec::new(), Vec::new());
    let (mut n_sv, mut reasons, mut ids) = (Vec::new(), Vec::new(), Vec::new());
    for (n, result) in &solved {
        n_sv.push(*n as i64);
        match result {
            Ok(value) => pairs.push(write(value, &mut rows)),
            Err(_) => {
                rows.resize(rows.len() + width, f64::NAN);
                pairs.push((f64::NAN, f64::NAN));
            }
        }
        ids.push(status::id(result.as_ref().err().map(Unavailable::reason)));
        reasons.push(result.as_ref().err().map(Unavailable::to_string).unwrap_or_default());
    }
    let d = PyDict::new(py);
    d.set_item("n_sv", n_sv.into_pyarray(py))?;
    d.set_item("reason", reasons)?;
    d.set_item("reason_id", ids)?;
    Ok((d, (rows, pairs)))
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(nominal_constellations, m)?)?;
    m.add_function(wrap_pyfunction!(satellite_directions, m)?)?;
    m.add_function(wrap_pyfunction!(position_covariances, m)?)?;
    m.add_function(wrap_pyfunction!(places_along, m)?)?;
    m.add_function(wrap_pyfunction!(position_responses, m)?)?;
    m.add_function(wrap_pyfunction!(dilutions, m)?)?;
    m.add_function(wrap_pyfunction!(dop_map, m)?)
}
