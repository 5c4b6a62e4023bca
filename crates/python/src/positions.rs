//! Positions solved from receivers' files.

use crate::error::{input_error, risk};
use crate::orbits::PreciseOrbits;
use crate::receiver_files::{Navigation, Observations};
use crate::status;
use navbound_assess::positions::{Job, Model, Positions, Signals, azimuth_rad, elevation_rad, ground_speed_mps, positions, sigma_m};
use navbound_assess::receivers::heard::{Fate, Heard};
use navbound_assess::receivers::ranges::{Tally, Unused};
use navbound_assess::smoothing::Form;
use navbound_core::frame::{self, EcefPosition, Geodetic, LatLon};
use navbound_core::geometry::ionosphere::{Ionosphere, MEAN_ACTIVITY_SFU};
use navbound_core::geometry::{Direction, ntcm};
use navbound_core::quantity::{GpsTime, Metres, OutOfDomain, Radians, Unavailable};
use navbound_core::signal::Constellation;
use navbound_core::signal::smoothing::Smoothing;
use navbound_core::solution::RangeError;
use navbound_core::solution::point::{Fix, Settings, Used};
use numpy::{IntoPyArray, PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::exceptions::{PyLookupError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::collections::BTreeMap;

/// Positions of every epoch as columns of the epoch table, with counts of what was not used.
#[pyfunction]
#[pyo3(signature = (observations, navigation, systems, *, dual, ionosphere, mask_rad, false_alarm, most_excluded, range_factor, shared_factor, precise, smoothing_s, divergence_free, keep_ranges))]
#[expect(clippy::too_many_arguments, reason = "one setting each, named by the caller")]
fn solve_positions<'py>(
    py: Python<'py>,
    observations: &Observations,
    navigation: &Navigation,
    systems: &str,
    dual: bool,
    ionosphere: &str,
    mask_rad: f64,
    false_alarm: f64,
    most_excluded: usize,
    range_factor: f64,
    shared_factor: f64,
    precise: Option<&PreciseOrbits>,
    smoothing_s: Option<f64>,
    divergence_free: bool,
    keep_ranges: bool,
) -> PyResult<Bound<'py, PyDict>> {
    if let Some(window) = smoothing_s {
        within("smoothing_s", window, "s", "(0, 86400]", window > 0.0 && window <= 86_400.0)?;
    }
    within("mask_rad", mask_rad, "rad", "[0, pi/2)", (0.0..core::f64::consts::FRAC_PI_2).contains(&mask_rad))?;
    risk("false_alarm", false_alarm)?;
    within("range_factor", range_factor, "1", "(0, inf)", range_factor > 0.0 && range_factor.is_finite())?;
    within("shared_factor", shared_factor, "1", "[0, inf)", shared_factor >= 0.0 && shared_factor.is_finite())?;
    let errors = weights(precise).scaled(range_factor, shared_factor);
    let model = ionosphere_model(ionosphere, observations, navigation)?;
    let settings = Settings { mask: Radians::new(mask_rad), ionosphere: model, errors, false_alarm, most_excluded };
    let job = Job {
        systems: systems.bytes().filter_map(Constellation::from_letter).collect(),
        signals: if dual { Signals::Dual } else { Signals::Single },
        smoothing: smoothing_s.map(|window| (if divergence_free { Form::DivergenceFree } else { Form::Single }, Smoothing::over(window))),
        settings,
        keep_ranges,
    };
    let solved = py.detach(|| positions(&observations.0, &navigation.records, precise.map(PreciseOrbits::tables), &job));
    let d = table(py, &solved, errors.name)?;
    d.set_item("smoothed_share", solved.smoothed_share)?;
    d.set_item("compared", (solved.comparisons.n_compared, solved.comparisons.n_dropped))?;
    d.set_item("ionosphere", model_name(&model))?;
    d.set_item("ranges", if keep_ranges { Some(kept_ranges(py, &solved)?) } else { None })?;
    d.set_item("heard", if keep_ranges { Some(heard(py, &solved.heard, |h| h)?) } else { None })?;
    Ok(d)
}

/// The model by its name, at the middle of the observations.
fn ionosphere_model(name: &str, observations: &Observations, navigation: &Navigation) -> PyResult<Ionosphere> {
    let model = match name {
        "auto" => Model::Auto,
        "broadcast" => Model::Broadcast,
        "galileo" => Model::Galileo,
        "climatology" => Model::Climatology,
        "none" => Model::Uncorrected,
        _ => return Err(PyValueError::new_err(format!("ionosphere: {name}"))),
    };
    let middle = observations.0.time.get(observations.0.n_epochs() / 2).copied().unwrap_or_default();
    let none = || PyLookupError::new_err(format!("no message of the ionosphere: {name}"));
    model.of(&navigation.records, middle).ok_or_else(none)
}

/// Name of a model, and the solar activity that it counts on \[sfu\].
fn model_name(model: &Ionosphere) -> (&'static str, f64) {
    match model {
        Ionosphere::Broadcast { .. } => ("broadcast", f64::NAN),
        Ionosphere::Ntcm { level_sfu } => ("galileo", *level_sfu),
        Ionosphere::Climatology => ("climatology", MEAN_ACTIVITY_SFU),
        Ionosphere::Uncorrected => ("none", MEAN_ACTIVITY_SFU),
    }
}

/// The ranges of every position, one row each: index of the epoch, and what the range was.
fn kept_ranges<'py>(py: Python<'py>, solved: &Positions) -> PyResult<Bound<'py, PyDict>> {
    let rows: Vec<_> = solved.ranges.iter().enumerate().flat_map(|(i, used)| used.iter().map(move |u| (i as i64, u))).collect();
    let d = PyDict::new(py);
    d.set_item("epoch", rows.iter().map(|(i, _)| *i).collect::<Vec<_>>().into_pyarray(py))?;
    d.set_item("sv", rows.iter().map(|(_, (satellite, _))| satellite.to_string()).collect::<Vec<_>>())?;
    let column = |f: fn(&Used) -> f64| rows.iter().map(|(_, (_, used))| f(used)).collect::<Vec<_>>().into_pyarray(py);
    d.set_item("az_rad", column(azimuth_rad))?;
    d.set_item("el_rad", column(elevation_rad))?;
    d.set_item("sigma_m", column(sigma_m))?;
    d.set_item("residual_m", column(|u| u.residual.m()))?;
    d.set_item("shared_1_m", column(|u| u.shared_m.x))?;
    d.set_item("shared_2_m", column(|u| u.shared_m.y))?;
    d.set_item("shared_3_m", column(|u| u.shared_m.z))?;
    d.set_item("shared_4_m", column(|u| u.shared_m.w))?;
    Ok(d)
}

/// Every satellite that was heard, one row an epoch: index of the epoch, direction, strength, what became of it.
pub(crate) fn heard<'py, H>(py: Python<'py>, epochs: &[Vec<H>], of: impl Fn(&H) -> &Heard) -> PyResult<Bound<'py, PyDict>> {
    let rows: Vec<_> = epochs.iter().enumerate().flat_map(|(i, each)| each.iter().map(move |h| (i as i64, h))).collect();
    let rows: Vec<_> = rows.into_iter().map(|(i, h)| (i, of(h))).collect();
    let d = PyDict::new(py);
    d.set_item("epoch", rows.iter().map(|(i, _)| *i).collect::<Vec<_>>().into_pyarray(py))?;
    d.set_item("sv", rows.iter().map(|(_, h)| h.satellite.to_string()).collect::<Vec<_>>())?;
    let column = |f: fn(&Heard) -> f64| rows.iter().map(|(_, h)| f(h)).collect::<Vec<_>>().into_pyarray(py);
    d.set_item("az_rad", column(|h| h.direction.map_or(f64::NAN, |d| d.azimuth().rad())))?;
    d.set_item("el_rad", column(|h| h.direction.map_or(f64::NAN, |d| d.elevation().rad())))?;
    d.set_item("cn0_dbhz", column(|h| h.cn0_dbhz))?;
    d.set_item("fate", rows.iter().map(|(_, h)| h.fate.id()).collect::<Vec<_>>())?;
    Ok(d)
}

/// What may become of a satellite beside not being used: ids with their words.
#[pyfunction]
fn satellite_fates() -> Vec<(&'static str, &'static str)> {
    Fate::OWN.into_iter().map(|fate| (fate.id(), fate.words())).collect()
}

const fn weights(precise: Option<&PreciseOrbits>) -> RangeError {
    if precise.is_some() { RangeError::PRECISE } else { RangeError::CALIBRATED }
}

fn within(argument: &'static str, value: f64, unit: &'static str, domain: &'static str, good: bool) -> PyResult<()> {
    if good { Ok(()) } else { Err(input_error(OutOfDomain { argument, value, unit, domain }, None)) }
}

/// One number of a position.
type Number = fn(&Fix) -> f64;

fn table<'py>(py: Python<'py>, solved: &Positions, weights: &str) -> PyResult<Bound<'py, PyDict>> {
    let d = PyDict::new(py);
    let columns: [(&str, Number); 16] = [
        ("est_lat_rad", |f| f.position.point.lat().rad()),
        ("est_lon_rad", |f| f.position.point.lon().rad()),
        ("est_h_m", |f| f.position.height.m()),
        ("cov_ee_m2", |f| f.covariance.matrix()[(0, 0)]),
        ("cov_en_m2", |f| f.covariance.matrix()[(0, 1)]),
        ("cov_nn_m2", |f| f.covariance.matrix()[(1, 1)]),
        ("cov_eu_m2", |f| f.covariance.matrix()[(0, 2)]),
        ("cov_nu_m2", |f| f.covariance.matrix()[(1, 2)]),
        ("cov_uu_m2", |f| f.covariance.matrix()[(2, 2)]),
        ("hdop", |f| f.dilution.horizontal),
        ("vdop", |f| f.dilution.vertical),
        ("vel_e_mps", |f| velocity(f, 0)),
        ("vel_n_mps", |f| velocity(f, 1)),
        ("vel_u_mps", |f| velocity(f, 2)),
        ("ground_speed_mps", ground_speed_mps),
        ("p_residual", |f| f.residual_risk),
    ];
    for (name, value) in columns {
        let values: Vec<f64> = solved.fixes.iter().map(|f| f.as_ref().map_or(f64::NAN, value)).collect();
        d.set_item(name, values.into_pyarray(py))?;
    }
    let count = |value: fn(&Fix) -> usize| solved.fixes.iter().map(|f| f.as_ref().map_or(0, |f| value(f) as i64)).collect::<Vec<_>>();
    d.set_item("n_sv", count(|f| f.n_used).into_pyarray(py))?;
    d.set_item("n_excluded", count(|f| f.n_excluded).into_pyarray(py))?;
    d.set_item("n_redundant", count(|f| f.redundancy).into_pyarray(py))?;
    let words = |(i, f): (usize, &Result<Fix, Unavailable>)| match (f, solved.doubts.get(i)) {
        (Err(why), None | Some(None)) => why.to_string(),
        _ => solved.reason(i).map_or_else(String::new, |r| r.words().to_owned()),
    };
    let reasons: Vec<_> = (0..solved.fixes.len()).map(|i| solved.reason(i)).collect();
    d.set_item("status", reasons.iter().map(|r| status::of(*r)).collect::<Vec<_>>())?;
    d.set_item("reason_id", reasons.iter().map(|r| status::id(*r)).collect::<Vec<_>>())?;
    d.set_item("reason", solved.fixes.iter().enumerate().map(words).collect::<Vec<_>>())?;
    satellites(&d, &solved.tally, &solved.signals)?;
    d.set_item("codes", solved.codes.clone())?;
    d.set_item("weights", weights)?;
    Ok(d)
}

/// Satellite-epochs that were not used, by the id of the reason; ranges that were, by satellite and message; signals by constellation.
pub(crate) fn satellites(d: &Bound<'_, PyDict>, tally: &Tally, signals: &BTreeMap<char, &'static str>) -> PyResult<()> {
    let unused = PyDict::new(d.py());
    for (why, n) in tally.unused() {
        unused.set_item(why.id(), n)?;
    }
    d.set_item("unused", unused)?;
    let name = |letter: char| signals.get(&letter).copied().unwrap_or_default();
    let rows =
        tally.used().map(|(satellite, message, n)| (satellite.to_string(), name(satellite.constellation.letter()), message.name(), n));
    d.set_item("used", rows.collect::<Vec<_>>())
}

/// Why a satellite may not be used: ids with their words.
#[pyfunction]
fn unused_reasons() -> Vec<(&'static str, &'static str)> {
    Unused::ALL.into_iter().map(|why| (why.id(), why.words())).collect()
}

fn velocity(fix: &Fix, axis: usize) -> f64 {
    fix.velocity.map_or(f64::NAN, |(v, _)| v[axis])
}

/// Geodetic positions (n, 3) of Earth-fixed ones: latitude, longitude [rad], height [m]; NaN stays NaN.
#[pyfunction]
fn geodetic_from_ecef<'py>(py: Python<'py>, ecef_m: PyReadonlyArray2<'py, f64>) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let convert = |(index, row): (usize, &[f64; 3])| {
        if row.iter().any(|v| v.is_nan()) {
            return Ok([f64::NAN; 3]);
        }
        let position = frame::geodetic_from_ecef(&EcefPosition::from_vector((*row).into())).map_err(|e| input_error(e, Some(index)))?;
        Ok([position.point.lat().rad(), position.point.lon().rad(), position.height.m()])
    };
    let rows: PyResult<Vec<[f64; 3]>> = ecef_m.as_slice()?.as_chunks::<3>().0.iter().enumerate().map(convert).collect();
    let rows = rows?;
    rows.as_flattened().to_vec().into_pyarray(py).reshape([rows.len(), 3])
}

/// Earth-fixed position \[m\] of latitude, longitude \[rad\] and height above the ellipsoid \[m\].
#[pyfunction]
fn ecef_from_geodetic(lat_rad: f64, lon_rad: f64, h_m: f64) -> PyResult<[f64; 3]> {
    let point = LatLon::new(Radians::new(lat_rad), Radians::new(lon_rad)).map_err(|e| input_error(e, None))?;
    Ok((*frame::ecef_from_geodetic(&Geodetic { point, height: Metres::new(h_m) }).vector()).into())
}

/// Delay on L1 by NTCM-G \[m\]: effective ionisation level \[sfu\], receiver \[rad, rad, m\], azimuth and elevation \[rad\], GPS time \[ns\].
#[pyfunction]
fn ntcm_delay(level_sfu: f64, place: (f64, f64, f64), sight: (f64, f64), time_ns: i64) -> PyResult<f64> {
    let refuse = |e| input_error(e, None);
    let point = LatLon::new(Radians::new(place.0), Radians::new(place.1)).map_err(refuse)?;
    let direction = Direction::new(Radians::new(sight.0), Radians::new(sight.1)).map_err(refuse)?;
    let receiver = Geodetic { point, height: Metres::new(place.2) };
    Ok(ntcm::delay(level_sfu, &receiver, &direction, GpsTime::from_nanoseconds(time_ns)).m())
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(geodetic_from_ecef, m)?)?;
    m.add_function(wrap_pyfunction!(ecef_from_geodetic, m)?)?;
    m.add_function(wrap_pyfunction!(unused_reasons, m)?)?;
    m.add_function(wrap_pyfunction!(satellite_fates, m)?)?;
    m.add_function(wrap_pyfunction!(ntcm_delay, m)?)?;
    m.add_function(wrap_pyfunction!(solve_positions, m)?)
}
