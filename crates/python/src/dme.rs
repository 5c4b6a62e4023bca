//! DME and VOR positioning, closed forms.

use crate::error::input_error;
use navbound_core::frame::{Displacement, Enu};
use navbound_core::quantity::{Metres, OutOfDomain, Radians};
use navbound_core::solution::dme::{self, Admission, Pair, RangeModel};
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;

fn refused(e: OutOfDomain) -> PyErr {
    input_error(e, None)
}

/// Standard deviation of DME ranges.
#[pyfunction]
fn dme_range_sigma<'py>(py: Python<'py>, slant_m: PyReadonlyArray1<'py, f64>) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let sigma = slant_m
        .as_slice()?
        .iter()
        .enumerate()
        .map(|(i, s)| RangeModel::STANDARD.sigma(Metres::new(*s)).map(Metres::m).map_err(|e| input_error(e, Some(i))))
        .collect::<PyResult<Vec<f64>>>()?;
    Ok(PyArray1::from_vec(py, sigma))
}

/// The figure of two ranges and their inclusion angle, element by element.
#[pyfunction]
fn dme_icao_two_sigma<'py>(
    py: Python<'py>,
    first_m: PyReadonlyArray1<'py, f64>,
    second_m: PyReadonlyArray1<'py, f64>,
    inclusion_rad: PyReadonlyArray1<'py, f64>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let (first, second, inclusion) = (first_m.as_slice()?, second_m.as_slice()?, inclusion_rad.as_slice()?);
    let figure = |i: usize| {
        let sigma = |slant: f64| RangeModel::STANDARD.sigma(Metres::new(slant));
        Ok(dme::icao_two_sigma([sigma(first[i])?, sigma(second[i])?], Radians::new(inclusion[i]))?.m())
    };
    let n = first.len().min(second.len()).min(inclusion.len());
    let all = (0..n).map(|i| figure(i).map_err(|e| input_error(e, Some(i)))).collect::<PyResult<Vec<f64>>>()?;
    Ok(PyArray1::from_vec(py, all))
}

/// Every pair of stations, in the order of their indices.
#[pyfunction]
fn dme_pairs<'py>(
    py: Python<'py>,
    aircraft_enu_m: [f64; 3],
    stations_enu_m: Vec<[f64; 3]>,
    sigma_altitude_m: f64,
    course_rad: Option<f64>,
) -> PyResult<Vec<Bound<'py, PyDict>>> {
    let place = |[e, n, u]: [f64; 3]| Displacement::<Enu>::new(Metres::new(e), Metres::new(n), Metres::new(u));
    let aircraft = place(aircraft_enu_m);
    let stations: Vec<_> = stations_enu_m.into_iter().map(place).collect();
    let mut pairs = Vec::new();
    for (i, a) in stations.iter().enumerate() {
        for (j, b) in stations.iter().enumerate().skip(i + 1) {
            let sigma_altitude = Metres::new(sigma_altitude_m);
            let pair = Pair::seen(&aircraft, [a, b], &RangeModel::STANDARD, &Admission::STANDARD, sigma_altitude).map_err(refused)?;
            pairs.push(pair_dict(py, (i, j), &pair, course_rad)?);
        }
    }
    Ok(pairs)
}

fn pair_dict<'py>(py: Python<'py>, stations: (usize, usize), pair: &Pair, course_rad: Option<f64>) -> PyResult<Bound<'py, PyDict>> {
    let d = PyDict::new(py);
    d.set_item("stations", stations)?;
    d.set_item("inclusion_rad", pair.inclusion.rad())?;
    d.set_item("slant_m", pair.slant.map(Metres::m))?;
    d.set_item("sigma_m", pair.sigma.map(Metres::m))?;
    d.set_item("elevation_rad", pair.elevation.map(Radians::rad))?;
    d.set_item("covariance_en_m2", pair.covariance.map(|c| [[c.m11, c.m12], [c.m21, c.m22]]))?;
    d.set_item("drms_m", pair.drms().map(Metres::m))?;
    d.set_item("icao_two_sigma_m", pair.icao_two_sigma().map(Metres::m))?;
    d.set_item("lateral_sigma_m", course_rad.and_then(|c| pair.lateral_sigma(Radians::new(c))).map(Metres::m))?;
    d.set_item("admissible", pair.admissible)?;
    Ok(d)
}

/// VOR/DME standard deviations: radial, cross, drms, element by element; NaN overhead.
#[pyfunction]
#[allow(clippy::type_complexity)]
fn vor_dme<'py>(
    py: Python<'py>,
    ground_m: PyReadonlyArray1<'py, f64>,
    slant_m: PyReadonlyArray1<'py, f64>,
    sigma_vor_rad: PyReadonlyArray1<'py, f64>,
    sigma_dme_m: PyReadonlyArray1<'py, f64>,
) -> PyResult<(Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>)> {
    let columns = [ground_m.as_slice()?, slant_m.as_slice()?, sigma_vor_rad.as_slice()?, sigma_dme_m.as_slice()?];
    let n = columns.iter().map(|c| c.len()).min().unwrap_or(0);
    let mut parts = [vec![f64::NAN; n], vec![f64::NAN; n], vec![f64::NAN; n]];
    for i in 0..n {
        let [ground, slant, vor, dme] = columns.map(|c| c[i]);
        let bound = dme::vor_dme(Metres::new(ground), Metres::new(slant), Radians::new(vor), Metres::new(dme));
        if let Some(s) = bound.map_err(|e| input_error(e, Some(i)))? {
            [parts[0][i], parts[1][i], parts[2][i]] = [s.radial.m(), s.cross.m(), s.drms.m()];
        }
    }
    let [radial, cross, drms] = parts.map(|p| PyArray1::from_vec(py, p));
    Ok((radial, cross, drms))
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(dme_range_sigma, m)?)?;
    m.add_function(wrap_pyfunction!(dme_icao_two_sigma, m)?)?;
    m.add_function(wrap_pyfunction!(dme_pairs, m)?)?;
    m.add_function(wrap_pyfunction!(vor_dme, m)?)
}
