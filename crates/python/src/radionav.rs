//! DME/DME and VOR/DME over many epochs.

use crate::batch::rejected;
use crate::error::input_error;
use crate::status;
use navbound_assess::dme::{self, Bearings, Models, Offer, Places, Ranges};
use navbound_core::frame::{Covariance, Enu};
use navbound_core::quantity::{Metres, OutOfDomain, Radians, Reason, Risk};
use navbound_core::solution::dme::{Best, Checked, Fix, NoFix, Station, Switching, Verdict};
use numpy::{IntoPyArray, PyArray3, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

type Numbers<'py> = PyReadonlyArray1<'py, f64>;
type Table<'py> = PyReadonlyArray2<'py, f64>;

/// Latitudes, longitudes and heights of one length.
#[derive(FromPyObject)]
struct Points<'py>(Numbers<'py>, Numbers<'py>, Numbers<'py>);

impl Points<'_> {
    fn places(&self, lat: &'static str) -> PyResult<Places<'_>> {
        let (latitudes, lon, h) = (self.0.as_slice()?, self.1.as_slice()?, self.2.as_slice()?);
        alike(lat, latitudes.len(), &[lon.len(), h.len()])?;
        Ok(Places { lat: latitudes, lon, h })
    }
}

fn alike(argument: &'static str, n: usize, others: &[usize]) -> PyResult<()> {
    match others.iter().find(|k| **k != n) {
        Some(k) => Err(refused(OutOfDomain { argument, value: *k as f64, unit: "1", domain: "arrays of one length" })),
        None => Ok(()),
    }
}

fn refused(e: OutOfDomain) -> PyErr {
    input_error(e, None)
}

fn stations(points: &Points, service_m: &Numbers, bearing: &[bool]) -> PyResult<Vec<Station>> {
    let service = service_m.as_slice()?;
    let places = points.places("stations")?.all().map_err(rejected)?;
    alike("stations", places.len(), &[service.len(), bearing.len()])?;
    let range = |(i, service): (usize, &f64)| {
        let refusal = OutOfDomain { argument: "service_m", value: *service, unit: "m", domain: "[0, inf)" };
        if *service >= 0.0 { Ok(Metres::new(*service)) } else { Err(input_error(refusal, Some(i))) }
    };
    let services = service.iter().enumerate().map(range).collect::<PyResult<Vec<_>>>()?;
    let each = places.into_iter().zip(services).zip(bearing);
    Ok(each.map(|((place, service), bearing)| Station { place, service, bearing: *bearing }).collect())
}

fn rows(covariance: &Covariance<Enu>) -> [f64; 9] {
    let m = covariance.matrix();
    [m.m11, m.m12, m.m13, m.m21, m.m22, m.m23, m.m31, m.m32, m.m33]
}

fn positions<'py>(py: Python<'py>, solutions: &[Result<Fix, NoFix>]) -> PyResult<Bound<'py, PyDict>> {
    let d = PyDict::new(py);
    let number = |f: fn(&Fix) -> f64| -> Vec<f64> { solutions.iter().map(|r| r.as_ref().map_or(f64::NAN, f)).collect() };
    d.set_item("lat_rad", number(|f| f.position.point.lat().rad()).into_pyarray(py))?;
    d.set_item("lon_rad", number(|f| f.position.point.lon().rad()).into_pyarray(py))?;
    d.set_item("drms_m", number(|f| f.drms().m()).into_pyarray(py))?;
    d.set_item("p_residual", number(|f| f.p_residual.unwrap_or(f64::NAN)).into_pyarray(py))?;
    let covariances: Vec<f64> = solutions.iter().flat_map(|r| r.as_ref().map_or([f64::NAN; 9], |f| rows(&f.covariance))).collect();
    d.set_item("covariance_enu_m2", covariances.into_pyarray(py).reshape([solutions.len(), 3, 3])?)?;
    let used: Vec<i64> = solutions.iter().map(|r| r.as_ref().map_or(0, |f| f.used as i64)).collect();
    d.set_item("n_ranges", used.into_pyarray(py))?;
    d.set_item("reason_id", solutions.iter().map(|r| status::id(r.as_ref().err().map(NoFix::reason))).collect::<Vec<_>>())?;
    Ok(d)
}

/// The column of the station whose range is left out, -1 for none.
fn excluded(checked: &Checked) -> i64 {
    match checked.verdict {
        Verdict::Excluded(column) => column as i64,
        Verdict::Consistent | Verdict::TooFew | Verdict::Undecided => -1,
    }
}

/// Why there is no position, or what its residuals say.
fn reason(checked: &Result<Checked, NoFix>) -> Option<Reason> {
    checked.as_ref().map_or_else(|e| Some(e.reason()), |c| c.verdict.reason())
}

/// Positions from slant ranges (n, m) of m stations, NaN where none was received.
#[pyfunction]
#[allow(clippy::too_many_arguments)] // One an array of the Python call.
fn dme_solve<'py>(
    py: Python<'py>,
    slant_m: Table<'py>,
    sigma_m: Option<Table<'py>>,
    stations: Points<'py>,
    h_m: Numbers<'py>,
    sigma_altitude_m: f64,
    prior_rad: Option<(Numbers<'py>, Numbers<'py>)>,
    prior_within_m: f64,
    residual_risk: f64,
) -> PyResult<Bound<'py, PyDict>> {
    if !(prior_within_m > 0.0) {
        return Err(refused(OutOfDomain { argument: "prior_within_m", value: prior_within_m, unit: "m", domain: "(0, inf)" }));
    }
    let places = stations.places("stations")?.all().map_err(rejected)?;
    let (slant, h) = (slant_m.as_slice()?, h_m.as_slice()?);
    alike("slant_m", h.len() * places.len(), &[slant.len()])?;
    let sigma = sigma_m.as_ref().map(|s| s.as_slice()).transpose()?;
    alike("sigma_m", slant.len(), &sigma.iter().map(|s| s.len()).collect::<Vec<_>>())?;
    let prior = match &prior_rad {
        Some((lat, lon)) => Some((lat.as_slice()?, lon.as_slice()?, Metres::new(prior_within_m))),
        None => None,
    };
    alike("prior_lat_rad", h.len(), &prior.iter().flat_map(|(lat, lon, _)| [lat.len(), lon.len()]).collect::<Vec<_>>())?;
    let sigma_altitude = Metres::new(sigma_altitude_m);
    let residual_risk = Risk::new(residual_risk).map_err(|e| refused(OutOfDomain { argument: "residual_risk", ..e }))?;
    let job = Ranges { stations: &places, slant, sigma, h, sigma_altitude, prior, residual_risk };
    let solutions = py.detach(|| dme::fixes(&job)).map_err(rejected)?;
    let fixes: Vec<_> = solutions.iter().map(|r| r.as_ref().map(|checked| checked.fix).map_err(|e| *e)).collect();
    let d = positions(py, &fixes)?;
    d.set_item("excluded", solutions.iter().map(|r| r.as_ref().map_or(-1, excluded)).collect::<Vec<i64>>().into_pyarray(py))?;
    d.set_item("reason_id", solutions.iter().map(|r| status::id(reason(r))).collect::<Vec<_>>())?;
    Ok(d)
}

/// Positions from a bearing and a slant range, one station an epoch.
#[pyfunction]
fn dme_solve_vor<'py>(
    py: Python<'py>,
    slant_m: Numbers<'py>,
    bearing_rad: Numbers<'py>,
    stations: Points<'py>,
    h_m: Numbers<'py>,
    sigma_bearing_rad: f64,
    sigma_altitude_m: f64,
) -> PyResult<Bound<'py, PyDict>> {
    let (slant, bearing, h) = (slant_m.as_slice()?, bearing_rad.as_slice()?, h_m.as_slice()?);
    let stations = stations.places("station_lat_rad")?;
    alike("slant_m", slant.len(), &[bearing.len(), h.len(), stations.len()])?;
    let models = Models::standard(Radians::new(sigma_bearing_rad), Metres::new(sigma_altitude_m));
    let job = Bearings { stations, slant, bearing, h };
    let solutions = py.detach(|| dme::vor_fixes(&job, &models)).map_err(rejected)?;
    positions(py, &solutions)
}

fn en(c: Option<[f64; 3]>) -> [f64; 4] {
    c.map_or([f64::NAN; 4], |[ee, en, nn]| [ee, en, en, nn])
}

fn of_pair(best: Option<&Best>) -> Option<[f64; 3]> {
    best.and_then(|b| b.pair.covariance).map(|c| [c.m11, c.m12, c.m22])
}

fn of_space(covariance: Option<Covariance<Enu>>) -> Option<[f64; 3]> {
    covariance.map(|c| c.horizontal()).map(|c| [c.m11, c.m12, c.m22])
}

/// Columns of offers: pairs as places of their stations (-1: none), covariances (n, 2, 2), counts.
fn offers<'py>(py: Python<'py>, d: &Bound<'py, PyDict>, offers: &[&Offer]) -> PyResult<()> {
    let n = offers.len();
    let place = |best: Option<&Best>| best.map_or([-1, -1], |b| b.stations.map(|k| k as i64));
    let matrices = |f: &dyn Fn(&Offer) -> Option<[f64; 3]>| -> Vec<f64> { offers.iter().flat_map(|o| en(f(o))).collect() };
    d.set_item("n_stations", offers.iter().map(|o| o.n_stations as i64).collect::<Vec<_>>().into_pyarray(py))?;
    d.set_item("best", offers.iter().flat_map(|o| place(o.best.as_ref())).collect::<Vec<i64>>().into_pyarray(py).reshape([n, 2])?)?;
    d.set_item("best_en_m2", matrices(&|o| of_pair(o.best.as_ref())).into_pyarray(py).reshape([n, 2, 2])?)?;
    d.set_item("all_en_m2", matrices(&|o| of_space(o.all)).into_pyarray(py).reshape([n, 2, 2])?)?;
    d.set_item("vor", offers.iter().map(|o| o.vor.map_or(-1, |(k, _)| k as i64)).collect::<Vec<_>>().into_pyarray(py))?;
    d.set_item("vor_en_m2", matrices(&|o| of_space(o.vor.map(|v| v.1))).into_pyarray(py).reshape([n, 2, 2])?)
}

/// Every station from every point (n, m, 4): slant range, elevation, bearing, 1 where it may be used.
#[pyfunction]
fn dme_sights<'py>(
    py: Python<'py>,
    points: Points<'py>,
    network: (Points<'py>, Numbers<'py>, Vec<bool>),
) -> PyResult<Bound<'py, PyArray3<f64>>> {
    let (stations, points) = (stations(&network.0, &network.1, &network.2)?, points.places("lat_rad")?);
    let models = models((0.0, 0.0))?;
    let views = py.detach(|| dme::sights(&points, &stations, &models)).map_err(rejected)?;
    views.concat().into_pyarray(py).reshape([points.len(), stations.len(), 4])
}

/// What a flight has, epoch by epoch.
#[pyfunction]
#[allow(clippy::too_many_arguments)] // One an array of the Python call.
fn dme_along<'py>(
    py: Python<'py>,
    track: Points<'py>,
    time_ns: PyReadonlyArray1<'py, i64>,
    course_rad: Numbers<'py>,
    network: (Points<'py>, Numbers<'py>, Vec<bool>),
    sigmas: (f64, f64),
    switching: (f64, f64),
) -> PyResult<Bound<'py, PyDict>> {
    let (stations, track) = (stations(&network.0, &network.1, &network.2)?, track.places("lat_rad")?);
    let (time, course) = (time_ns.as_slice()?, course_rad.as_slice()?);
    alike("lat_rad", track.len(), &[time.len(), course.len()])?;
    let models = models(sigmas)?;
    let switching = Switching { share: switching.0, hold_s: switching.1 };
    let series = py.detach(|| dme::along(&track, time, course, &stations, &models, switching)).map_err(rejected)?;
    let d = PyDict::new(py);
    offers(py, &d, &series.iter().collect::<Vec<_>>())?;
    let used = |o: &Offer| o.used.map_or([-1, -1], |b| b.stations.map(|k| k as i64));
    d.set_item("used", series.iter().flat_map(used).collect::<Vec<i64>>().into_pyarray(py).reshape([series.len(), 2])?)?;
    let covariances: Vec<f64> = series.iter().flat_map(|o| en(of_pair(o.used.as_ref()))).collect();
    d.set_item("used_en_m2", covariances.into_pyarray(py).reshape([series.len(), 2, 2])?)?;
    Ok(d)
}

/// What a network gives at the points of a map.
#[pyfunction]
fn dme_coverage<'py>(
    py: Python<'py>,
    points: Points<'py>,
    network: (Points<'py>, Numbers<'py>, Vec<bool>),
    sigmas: (f64, f64),
    risk: f64,
) -> PyResult<Bound<'py, PyDict>> {
    let (stations, points) = (stations(&network.0, &network.1, &network.2)?, points.places("lat_rad")?);
    let (models, risk) = (models(sigmas)?, Risk::new(risk).map_err(refused)?);
    let coverage = py.detach(|| dme::coverage(&points, &stations, &models, risk)).map_err(rejected)?;
    let d = PyDict::new(py);
    offers(py, &d, &coverage.iter().map(|c| &c.offer).collect::<Vec<_>>())?;
    for (k, name) in ["nse_best_m", "nse_all_m", "nse_vor_m"].iter().enumerate() {
        let nse: Vec<f64> = coverage.iter().map(|c| c.nse[k].map_or(f64::NAN, Metres::m)).collect();
        d.set_item(name, nse.into_pyarray(py))?;
    }
    Ok(d)
}

fn models((sigma_bearing_rad, sigma_altitude_m): (f64, f64)) -> PyResult<Models> {
    for (argument, value, unit) in [("sigma_bearing_rad", sigma_bearing_rad, "rad"), ("sigma_altitude_m", sigma_altitude_m, "m")] {
        if !(value >= 0.0 && value.is_finite()) {
            return Err(refused(OutOfDomain { argument, value, unit, domain: "[0, inf)" }));
        }
    }
    Ok(Models::standard(Radians::new(sigma_bearing_rad), Metres::new(sigma_altitude_m)))
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(dme_solve, m)?)?;
    m.add_function(wrap_pyfunction!(dme_solve_vor, m)?)?;
    m.add_function(wrap_pyfunction!(dme_sights, m)?)?;
    m.add_function(wrap_pyfunction!(dme_along, m)?)?;
    m.add_function(wrap_pyfunction!(dme_coverage, m)?)
}
