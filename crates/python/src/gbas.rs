//! GBAS: error models, protection levels, missed-detection limits; the tables with their marks.

use crate::batch::{numbers, rejected, table};
use crate::error::input_error;
use crate::status;
use navbound_assess::batch::rows;
use navbound_assess::gbas::{self, Request, Skies};
use navbound_core::bound::gbas::aided::Aided;
use navbound_core::bound::gbas::bias::Ordering;
use navbound_core::bound::gbas::detection::{self, Hazard};
use navbound_core::bound::gbas::levels::{self, FactorRule, Factors, Settings};
use navbound_core::bound::gbas::noise::{Coloured, Form as NoiseForm};
use navbound_core::bound::gbas::offset::Offset;
use navbound_core::bound::gbas::range::{self, RangeError};
use navbound_core::bound::gbas::snapshot::Form;
use navbound_core::geometry::Direction;
use navbound_core::quantity::{Metres, OutOfDomain, Radians, Risk, Unavailable};
use navbound_core::signal::Constellation;
use navbound_core::spec::gbas::{CarrierModel, ERROR_MODELS, ErrorModel, INERTIAL, MONITOR_CURVES, MonitorCurve};
use navbound_core::spec::surface::ErrorBudget;
use navbound_path::AtIndex;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

pub fn refused(e: AtIndex) -> PyErr {
    input_error(e.error, Some(e.index))
}

pub fn refusal(e: OutOfDomain) -> PyErr {
    input_error(e, None)
}

/// Indices of constellations.
pub fn constellations(indices: &[usize]) -> PyResult<Vec<Constellation>> {
    let unknown =
        |value: usize| OutOfDomain { argument: "constellation", value: value as f64, unit: "1", domain: "indices of constellations" };
    indices.iter().map(|i| Constellation::from_index(*i).ok_or_else(|| refusal(unknown(*i)))).collect()
}

pub fn ordering(name: &str) -> PyResult<Ordering> {
    match name {
        "exact" => Ok(Ordering::Exact),
        "rss" => Ok(Ordering::Rss),
        "sum" => Ok(Ordering::Sum),
        other => Err(PyValueError::new_err(other.to_owned())),
    }
}

pub fn form(name: &str) -> PyResult<Form> {
    match name {
        "major" => Ok(Form::Major),
        "norm" => Ok(Form::Norm),
        other => Err(PyValueError::new_err(other.to_owned())),
    }
}

fn noise_form(name: &str) -> PyResult<NoiseForm> {
    match name {
        "paper" => Ok(NoiseForm::Paper),
        "bound" => Ok(NoiseForm::Bound),
        other => Err(PyValueError::new_err(other.to_owned())),
    }
}

fn model(service: &str) -> PyResult<&'static ErrorModel> {
    ERROR_MODELS.iter().find(|m| m.id == service).ok_or_else(|| PyValueError::new_err(service.to_owned()))
}

/// A monitor curve by its name, with another stretch.
fn curve(service: &str, stretch: f64) -> PyResult<MonitorCurve> {
    let entry = MONITOR_CURVES.iter().find(|m| m.id == service).ok_or_else(|| PyValueError::new_err(service.to_owned()))?;
    if !(stretch > 0.0 && stretch.is_finite()) {
        return Err(refusal(OutOfDomain { argument: "stretch", value: stretch, unit: "1", domain: "(0, inf)" }));
    }
    Ok(MonitorCurve { stretch, ..*entry })
}

/// Noise, troposphere, clock, ionosphere (NaN for none), as Python holds them.
pub fn carrier(numbers: [f64; 4]) -> CarrierModel {
    let [noise, troposphere_gradient, clock_mps, ionosphere] = numbers;
    CarrierModel {
        noise: Metres::new(noise),
        troposphere_gradient,
        clock_mps,
        ionosphere_gradient: (!ionosphere.is_nan()).then_some(ionosphere),
        marks: &[],
    }
}

/// Sigma, sigma with a receiver faulty, ground, air, troposphere, ionosphere: six numbers an elevation.
#[pyfunction]
fn gbas_range_sigma<'py>(py: Python<'py>, service: &str, el_rad: PyReadonlyArray1<'_, f64>) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let (model, el) = (model(service)?, el_rad.as_slice()?);
    table(py, el.len(), |i| {
        let e = RangeError::new(model, Radians::new(el[i]))?;
        let parts = [e.sigma(), e.sigma_one_receiver_faulty(), e.ground, e.airborne, e.troposphere, e.ionosphere];
        Ok(parts.map(Metres::m))
    })
}

/// Sigma of phase differenced in time.
#[pyfunction]
fn gbas_carrier_sigma<'py>(
    py: Python<'py>,
    model: [f64; 4],
    el_rad: PyReadonlyArray1<'_, f64>,
    speed_mps: PyReadonlyArray1<'_, f64>,
    coasting_s: PyReadonlyArray1<'_, f64>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let (el, speed, time) = (el_rad.as_slice()?, speed_mps.as_slice()?, coasting_s.as_slice()?);
    let model = carrier(model);
    numbers(py, el.len(), |i| Ok(range::carrier_sigma(&model, Radians::new(el[i]), speed[i], time[i])?.m()))
}

/// K_ffmd and K_md.
#[pyfunction]
fn gbas_factors(risk: f64, share: f64, axes: u8, receivers: u8, receiver_fault: f64) -> PyResult<(f64, f64)> {
    let rule = FactorRule { share, axes, receivers, receiver_fault };
    let risk = Risk::new(risk).map_err(|e| OutOfDomain { argument: "integrity_risk", ..e });
    let factors = risk.and_then(|risk| Factors::new(risk, &rule)).map_err(refusal)?;
    Ok((factors.fault_free, factors.missed))
}

/// Accuracy (95 %) left by a containment.
#[pyfunction]
fn gbas_accuracy_limit(containment_m: f64, risk: f64, sigma_fte_m: f64, sigma_pde_m: f64) -> PyResult<f64> {
    let containment_risk = Risk::new(risk).map_err(refusal)?;
    let budget = ErrorBudget { containment_risk, sigma_fte: Metres::new(sigma_fte_m), sigma_pde: Metres::new(sigma_pde_m), marks: &[] };
    Ok(levels::accuracy_limit(Metres::new(containment_m), &budget).map_err(refusal)?.m())
}

/// Metres of position for a metre of bias in every row of (e, n).
#[pyfunction]
fn gbas_bias_gain(east_north: PyReadonlyArray2<'_, f64>, order: &str) -> PyResult<f64> {
    let vectors = east_north.as_slice()?.as_chunks::<2>().0;
    Ok(ordering(order)?.gain(vectors.iter().copied()))
}

/// What protection levels are worked out from.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct Job<'py> {
    az_rad: PyReadonlyArray1<'py, f64>,
    el_rad: PyReadonlyArray1<'py, f64>,
    sigma_m: PyReadonlyArray1<'py, f64>,
    sigma_h1_m: PyReadonlyArray1<'py, f64>,
    constellation: Vec<usize>,
    bias_m: PyReadonlyArray1<'py, f64>,
    aided_m2: Option<PyReadonlyArray1<'py, f64>>,
    b_values_m: Option<PyReadonlyArray1<'py, f64>>,
    k_ffmd: f64,
    k_md: f64,
    ordering: String,
    form: String,
}

/// Levels: one array a column, NaN where there are none; `cov_enu_m2`; `n_sv`; `reason`.
#[pyfunction]
fn gbas_levels<'py>(py: Python<'py>, job: Job<'py>) -> PyResult<Bound<'py, PyDict>> {
    let constellation = constellations(&job.constellation)?;
    let skies = Skies {
        az_rad: job.az_rad.as_slice()?,
        el_rad: job.el_rad.as_slice()?,
        sigma_m: job.sigma_m.as_slice()?,
        sigma_h1_m: job.sigma_h1_m.as_slice()?,
        constellation: &constellation,
    };
    let factors = Factors { fault_free: job.k_ffmd, missed: job.k_md };
    let settings = Settings { factors, form: form(&job.form)?, ordering: ordering(&job.ordering)?, bias: Metres::new(0.0) };
    let request = Request {
        bias_m: job.bias_m.as_slice()?,
        aided_m2: job.aided_m2.as_ref().map(|a| a.as_slice()).transpose()?,
        b_values_m: job.b_values_m.as_ref().map(|a| a.as_slice()).transpose()?,
        settings,
    };
    let levels = py.detach(|| gbas::protection_levels(&skies, &request)).map_err(refused)?;
    let mut columns = vec![Vec::with_capacity(levels.len()); LEVEL_COLUMNS.len()];
    let (mut matrices, mut n_sv, mut reasons, mut ids) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (n, answer) in &levels {
        n_sv.push(*n as i64);
        ids.push(status::id(answer.as_ref().err().map(Unavailable::reason)));
        reasons.push(answer.as_ref().err().map(ToString::to_string).unwrap_or_default());
        let row = answer.as_ref().map_or([f64::NAN; LEVEL_COLUMNS.len()], level_row);
        columns.iter_mut().zip(row).for_each(|(column, value)| column.push(value));
        matrices.extend(answer.as_ref().map_or([f64::NAN; 9], |a| {
            let mut m = [0.0; 9];
            m.copy_from_slice(a.covariance.matrix().as_slice());
            m
        }));
    }
    let d = PyDict::new(py);
    for (name, column) in LEVEL_COLUMNS.into_iter().zip(columns) {
        d.set_item(name, column.into_pyarray(py))?;
    }
    d.set_item("cov_enu_m2", matrices.into_pyarray(py))?;
    d.set_item("n_sv", n_sv.into_pyarray(py))?;
    d.set_item("reason", reasons)?;
    d.set_item("reason_id", ids)?;
    Ok(d)
}

const LEVEL_COLUMNS: [&str; 13] = [
    "hpl_h0_m",
    "hpl_h1_m",
    "hpl_m",
    "accuracy_m",
    "sigma_m",
    "bias_hor_m",
    "sigma_major_m",
    "sigma_norm_m",
    "sigma_major_h1_m",
    "bias_gain_exact",
    "bias_gain_rss",
    "bias_gain_sum",
    "worst_projection",
];

fn level_row(a: &gbas::Answer) -> [f64; LEVEL_COLUMNS.len()] {
    let l = &a.levels;
    let [major, norm, faulty] = a.deviations;
    let [exact, rss, sum] = a.gains;
    let d = &l.detail;
    let m = [d.fault_free, d.receiver_faulty, l.hpl, a.accuracy, d.deviation, d.bias, major, norm, faulty].map(Metres::m);
    [m[0], m[1], m[2], m[3], m[4], m[5], m[6], m[7], m[8], exact, rss, sum, a.worst_projection]
}

/// Probability of an undetected satellite fault, from pairs of satellites and rate per hour.
#[pyfunction]
fn gbas_fault_probability(groups: Vec<(f64, f64)>, tau_s: f64) -> PyResult<f64> {
    detection::fault_probability(groups, tau_s).map_err(refusal)
}

/// Missed detection of range errors by a ground monitor.
#[pyfunction]
fn gbas_missed_by_monitor<'py>(
    py: Python<'py>,
    service: &str,
    stretch: f64,
    error_m: PyReadonlyArray1<'_, f64>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let (curve, error) = (curve(service, stretch)?, error_m.as_slice()?);
    numbers(py, error.len(), |i| Ok(detection::missed_by_monitor(&curve, Metres::new(error[i]))))
}

/// A hazard's six numbers: containment, sigma, bias, projection, risk allotted, fault probability.
fn hazard(n: &[f64]) -> Result<Hazard, OutOfDomain> {
    Hazard::new(
        Metres::new(n[0]),
        Metres::new(n[1]),
        Metres::new(n[2]),
        n[3],
        Risk::new(n[4]).map_err(|e| OutOfDomain { argument: "allotted_risk", ..e })?,
        n[5],
    )
}

/// Missed-detection limits; hazards in rows of six.
#[pyfunction]
fn gbas_missed_detection_limit<'py>(
    py: Python<'py>,
    error_m: PyReadonlyArray1<'_, f64>,
    hazards: PyReadonlyArray2<'_, f64>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let (error, hazards) = (error_m.as_slice()?, hazards.as_slice()?);
    numbers(py, error.len(), |i| Ok(hazard(&hazards[6 * i..6 * i + 6])?.limit(Metres::new(error[i]))))
}

/// Least decades between limit and monitor over all range errors; hazards in rows of six.
#[pyfunction]
fn gbas_monitor_margin<'py>(
    py: Python<'py>,
    service: &str,
    stretch: f64,
    hazards: PyReadonlyArray2<'_, f64>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let (curve, hazards) = (curve(service, stretch)?, hazards.as_slice()?);
    numbers(py, hazards.len() / 6, |i| Ok(hazard(&hazards[6 * i..6 * i + 6])?.margin_decades(&curve)))
}

/// What the filter is worked out from: one sky a row.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct FilterJob<'py> {
    service: String,
    form: String,
    lat_rad: f64,
    seconds: f64,
    az_rad: PyReadonlyArray1<'py, f64>,
    el_rad: PyReadonlyArray1<'py, f64>,
    constellation: Vec<usize>,
}

/// Covariance of position with an inertial system, nine numbers a sky.
#[pyfunction]
fn gbas_aided_covariance<'py>(py: Python<'py>, job: FilterJob<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let (model, form, constellation) = (model(&job.service)?, noise_form(&job.form)?, constellations(&job.constellation)?);
    let (az, el, width) = (job.az_rad.as_slice()?, job.el_rad.as_slice()?, constellation.len());
    let (latitude, seconds) = (Radians::new(job.lat_rad), job.seconds);
    let one = |sky: usize| {
        let mut tracked = Vec::with_capacity(width);
        for (column, constellation) in constellation.iter().enumerate() {
            let at = sky * width + column;
            if az[at].is_nan() && el[at].is_nan() {
                continue;
            }
            let direction = Direction::new(Radians::new(az[at]), Radians::new(el[at]))?;
            tracked.push(gbas::tracked(model, form, &direction, *constellation)?);
        }
        let mut filter = Aided::new(&tracked, latitude, &INERTIAL, 1.0)?;
        filter.run(seconds);
        let mut out = [0.0; 9];
        out.copy_from_slice(filter.position().matrix().as_slice());
        Ok(out)
    };
    let n = az.len().checked_div(width).unwrap_or(0);
    let out = py.detach(|| rows(n, one)).map_err(rejected)?;
    out.into_pyarray(py).reshape([n, 9])
}

/// Variance of a constant offset as a filter has it and as it is, after each of `n` seconds.
#[pyfunction]
fn gbas_offset_variances<'py>(
    py: Python<'py>,
    form: &str,
    ends_s: [f64; 2],
    true_constant_s: f64,
    n: usize,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let one = Metres::new(1.0);
    let noise = Coloured::new(one, ends_s, noise_form(form)?).map_err(refusal)?;
    if !(true_constant_s > 0.0) {
        return Err(refusal(OutOfDomain { argument: "true_constant_s", value: true_constant_s, unit: "s", domain: "(0, inf)" }));
    }
    let mut offset = Offset::new(noise, one, true_constant_s, Metres::new(0.0), Metres::new(1e4), 1.0);
    let mut out = Vec::with_capacity(2 * n);
    for _ in 0..n {
        offset.measure();
        let (filter, truth) = offset.variances_m2();
        out.extend([filter, truth]);
        offset.wait();
    }
    out.into_pyarray(py).reshape([n, 2])
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(gbas_range_sigma, m)?)?;
    m.add_function(wrap_pyfunction!(gbas_carrier_sigma, m)?)?;
    m.add_function(wrap_pyfunction!(gbas_factors, m)?)?;
    m.add_function(wrap_pyfunction!(gbas_accuracy_limit, m)?)?;
    m.add_function(wrap_pyfunction!(gbas_bias_gain, m)?)?;
    m.add_function(wrap_pyfunction!(gbas_levels, m)?)?;
    m.add_function(wrap_pyfunction!(gbas_fault_probability, m)?)?;
    m.add_function(wrap_pyfunction!(gbas_missed_by_monitor, m)?)?;
    m.add_function(wrap_pyfunction!(gbas_missed_detection_limit, m)?)?;
    m.add_function(wrap_pyfunction!(gbas_monitor_margin, m)?)?;
    m.add_function(wrap_pyfunction!(gbas_aided_covariance, m)?)?;
    m.add_function(wrap_pyfunction!(gbas_offset_variances, m)?)
}
