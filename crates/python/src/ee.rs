//! Error Extraction: series, gains, multipliers, worst biases. Every bound is experimental, not integrity.

use crate::batch::{rejected, table};
use crate::error::input_error;
use crate::status;
use navbound_assess::ee::{self, Row, Series};
use navbound_assess::sky::Sights;
use navbound_core::bound::ee::noise::{self, Form, HorizontalBeta, Shape};
use navbound_core::bound::ee::{ASSUMES, LABEL, PROMISES, PROVENANCE, SOURCE, bias};
use navbound_core::quantity::{Metres, OutOfDomain, Risk, Unavailable};
use navbound_core::solution::extraction::{self, Reset, gain};
use numpy::{IntoPyArray, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// What stands beside every number of Error Extraction.
#[pyfunction]
fn ee_declaration(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let d = PyDict::new(py);
    d.set_item("label", LABEL)?;
    d.set_item("source", SOURCE)?;
    d.set_item("provenance", PROVENANCE.word())?;
    d.set_item("assumes", ASSUMES)?;
    d.set_item("may_alert", PROMISES.may_alert)?;
    d.set_item("mu_most_m", bias::MU_MOST_M)?;
    d.set_item("alpha", bias::ALPHA)?;
    d.set_item("gap_periods", extraction::GAP_PERIODS)?;
    Ok(d)
}

fn named(argument: &'static str) -> impl Fn(OutOfDomain) -> PyErr {
    move |e| input_error(OutOfDomain { argument, ..e }, None)
}

fn shape(window: i64, weight: f64) -> PyResult<Shape> {
    // A negative number is no length either: 0 is refused the same way, with the number found.
    let samples = usize::try_from(window).unwrap_or(0);
    Shape::new(samples, weight)
        .map_err(|e| input_error(if e.argument == "window" { OutOfDomain { value: window as f64, ..e } } else { e }, None))
}

/// Series and settings as they come from Python.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct Job<'py> {
    epochs: usize,
    time_ns: PyReadonlyArray1<'py, i64>,
    position: PyReadonlyArray2<'py, f64>,
    velocity: PyReadonlyArray2<'py, f64>,
    satellites: Option<PyReadonlyArray1<'py, u64>>,
    bias: PyReadonlyArray2<'py, f64>,
    rho: f64,
    period_s: f64,
    gap_most_s: f64,
    reset_on_new_satellites: bool,
    window: i64,
    weight: f64,
    beta: f64,
    horizontal_printed: bool,
    noise_printed: bool,
    risk_h: f64,
    risk_v: f64,
}

impl Job<'_> {
    fn settings(&self) -> PyResult<ee::Settings> {
        let filter = extraction::Settings::new(self.rho, self.period_s, self.gap_most_s, self.reset_on_new_satellites)
            .map_err(|e| input_error(e, None))?;
        let horizontal_beta = if self.horizontal_printed { HorizontalBeta::Printed } else { HorizontalBeta::Outside };
        let form = if self.noise_printed { Form::AsPrinted } else { Form::CfarSum };
        let risks = (Risk::new(self.risk_h).map_err(named("risk_h"))?, Risk::new(self.risk_v).map_err(named("risk_v"))?);
        let shape = shape(self.window, self.weight)?;
        let noise = noise::Settings::new(shape, self.beta, (horizontal_beta, form), risks).map_err(|e| input_error(e, None))?;
        Ok(ee::Settings { filter, noise })
    }
}

/// Filter and bound of every epoch; `age` is -1 without a solution, `reset` 0 none, 1 start, 2 gap, 3 satellites.
#[pyfunction]
fn ee_extract<'py>(py: Python<'py>, job: Job<'py>) -> PyResult<Bound<'py, PyDict>> {
    let settings = job.settings()?;
    let series = Series {
        epochs: job.epochs,
        time_ns: job.time_ns.as_slice()?,
        position_xyz: job.position.as_slice()?.as_chunks().0,
        velocity_xyz: job.velocity.as_slice()?.as_chunks().0,
        satellites: job.satellites.as_ref().map_or(Ok(&[][..]), |s| s.as_slice())?,
        bias: job.bias.as_slice()?.as_chunks().0,
    };
    let rows = py.detach(|| ee::extract(&series, &settings)).map_err(rejected)?;
    let column = |f: fn(&Row) -> f64| rows.iter().map(f).collect::<Vec<_>>().into_pyarray(py);
    let d = PyDict::new(py);
    d.set_item("error", rows.iter().flat_map(|r| r.error).collect::<Vec<_>>().into_pyarray(py).reshape([rows.len(), 3])?)?;
    d.set_item("size_h", column(|r| r.size[0]))?;
    d.set_item("size_v", column(|r| r.size[1]))?;
    d.set_item("sum_h", column(|r| r.sum[0]))?;
    d.set_item("sum_v", column(|r| r.sum[1]))?;
    d.set_item("noise_h", column(|r| r.noise[0]))?;
    d.set_item("noise_v", column(|r| r.noise[1]))?;
    d.set_item("bound_h", column(|r| r.bound[0]))?;
    d.set_item("bound_v", column(|r| r.bound[1]))?;
    d.set_item("age", rows.iter().map(|r| r.age.map_or(-1, i64::from)).collect::<Vec<_>>().into_pyarray(py))?;
    let code = |r: &Row| match r.reset {
        None => 0_u8,
        Some(Reset::Start) => 1,
        Some(Reset::Gap) => 2,
        Some(Reset::Satellites) => 3,
    };
    d.set_item("reset", rows.iter().map(code).collect::<Vec<_>>().into_pyarray(py))?;
    d.set_item("new_satellites", rows.iter().map(|r| r.new_satellites).collect::<Vec<_>>().into_pyarray(py))?;
    Ok(d)
}

/// White gain of variance, gain at half the sampling rate, sd(u) for 1 m/s, white residual gain, and settling counts for 5 % and 1 %.
#[pyfunction]
fn ee_gains<'py>(
    py: Python<'py>,
    rho: PyReadonlyArray1<'py, f64>,
    period_s: PyReadonlyArray1<'py, f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let (rho, period) = (rho.as_slice()?, period_s.as_slice()?);
    table(py, rho.len(), |i| {
        let settle = |share| gain::settling_samples(rho[i], share).map(f64::from);
        Ok([
            gain::white(rho[i])?,
            gain::nyquist(rho[i])?,
            gain::velocity_s(rho[i], period[i])?,
            gain::corrected_white(rho[i])?,
            settle(0.05)?,
            settle(0.01)?,
        ])
    })
}

/// beta and sd(corrected)/sd(raw) for a Gauss-Markov error.
#[pyfunction]
fn ee_beta<'py>(
    py: Python<'py>,
    rho: PyReadonlyArray1<'py, f64>,
    period_s: PyReadonlyArray1<'py, f64>,
    tau_s: PyReadonlyArray1<'py, f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let (rho, period, tau) = (rho.as_slice()?, period_s.as_slice()?, tau_s.as_slice()?);
    table(py, rho.len(), |i| ee::gauss_markov_gains(rho[i], period[i], tau[i]))
}

/// beta from an autocorrelation at lags 0, T, 2T, ...
#[pyfunction]
fn ee_beta_autocorrelation(rho: f64, autocorrelation_m2: PyReadonlyArray1<'_, f64>) -> PyResult<f64> {
    let series = gain::from_autocorrelation(rho, autocorrelation_m2.as_slice()?);
    series.map(gain::beta).map_err(|e| input_error(e, None))
}

/// beta from a spectral density.
#[pyfunction]
fn ee_beta_spectrum(
    rho: f64,
    period_s: f64,
    frequency_hz: PyReadonlyArray1<'_, f64>,
    density_m2_per_hz: PyReadonlyArray1<'_, f64>,
) -> PyResult<f64> {
    let points = frequency_hz.as_slice()?.iter().zip(density_m2_per_hz.as_slice()?).map(|(f, s)| [*f, *s]);
    gain::from_spectrum(rho, period_s, points).map(gain::beta).map_err(|e| input_error(e, None))
}

/// k, its exact form for the weights, and the risks of k on the sum outside and inside the window, and of k / M outside.
#[pyfunction]
fn ee_factor(risk: f64, window: i64, weight: f64) -> PyResult<(f64, f64, f64, f64, f64)> {
    let shape = shape(window, weight)?;
    let risk = Risk::new(risk).map_err(|e| input_error(e, None))?;
    let k = shape.factor(risk);
    let printed = k / shape.samples() as f64;
    Ok((k, shape.weighted_factor(risk), shape.risk_outside(k), shape.risk_inside(k), shape.risk_outside(printed)))
}

/// Worst bias from dilutions: horizontal and vertical.
#[pyfunction]
fn ee_bias_dop<'py>(
    py: Python<'py>,
    hdop: PyReadonlyArray1<'py, f64>,
    vdop: PyReadonlyArray1<'py, f64>,
    n_sv: PyReadonlyArray1<'py, i64>,
    mu_most_m: f64,
    alpha: f64,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let (hdop, vdop, n_sv) = (hdop.as_slice()?, vdop.as_slice()?, n_sv.as_slice()?);
    table(py, hdop.len(), |i| {
        let satellites = usize::try_from(n_sv[i]).unwrap_or(0);
        bias::dop(hdop[i], vdop[i], satellites, Metres::new(mu_most_m), alpha).map(|b| [b.horizontal.m(), b.vertical.m()])
    })
}

/// Both readings of the worst bias from satellites: `from_dop` and `exact`, shape (n, 2), `n_sv`, `reason`.
#[pyfunction]
fn ee_bias_sights<'py>(
    py: Python<'py>,
    sights: (PyReadonlyArray1<'py, f64>, PyReadonlyArray1<'py, f64>, PyReadonlyArray1<'py, f64>),
    constellation: Vec<usize>,
    mu_most_m: f64,
    alpha: f64,
) -> PyResult<Bound<'py, PyDict>> {
    let (az, el, sigma) = &sights;
    let sights = Sights { az_rad: az.as_slice()?, el_rad: el.as_slice()?, sigma_m: sigma.as_slice()?, constellation: &constellation };
    let solved = py.detach(|| ee::biases(&sights, Metres::new(mu_most_m), alpha)).map_err(|e| input_error(e.error, Some(e.index)))?;
    let (mut from_dop, mut exact, mut n_sv, mut reason, mut ids) = (vec![], vec![], vec![], vec![], vec![]);
    for (n, solution) in solved {
        let bias = solution.as_ref().ok();
        from_dop.extend(bias.map_or([f64::NAN; 2], |b| b.from_dop));
        exact.extend(bias.map_or([f64::NAN; 2], |b| b.exact));
        n_sv.push(n as i64);
        ids.push(status::id(solution.as_ref().err().map(Unavailable::reason)));
        reason.push(solution.err().map_or(String::new(), |e| e.to_string()));
    }
    let n = n_sv.len();
    let d = PyDict::new(py);
    d.set_item("from_dop", from_dop.into_pyarray(py).reshape([n, 2])?)?;
    d.set_item("exact", exact.into_pyarray(py).reshape([n, 2])?)?;
    d.set_item("n_sv", n_sv.into_pyarray(py))?;
    d.set_item("reason", reason)?;
    d.set_item("reason_id", ids)?;
    Ok(d)
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(ee_declaration, m)?)?;
    m.add_function(wrap_pyfunction!(ee_extract, m)?)?;
    m.add_function(wrap_pyfunction!(ee_gains, m)?)?;
    m.add_function(wrap_pyfunction!(ee_beta, m)?)?;
    m.add_function(wrap_pyfunction!(ee_beta_autocorrelation, m)?)?;
    m.add_function(wrap_pyfunction!(ee_beta_spectrum, m)?)?;
    m.add_function(wrap_pyfunction!(ee_factor, m)?)?;
    m.add_function(wrap_pyfunction!(ee_bias_dop, m)?)?;
    m.add_function(wrap_pyfunction!(ee_bias_sights, m)?)?;
    Ok(())
}
