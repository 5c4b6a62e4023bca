//! Evaluation of bounds and covariances against truth.

use crate::error::input_error;
use crate::fields::fields;
use navbound_assess::evaluation::pieces::{Bounds, Series, Sizes, Squares};
use navbound_assess::evaluation::{self, Consistency, Errors, Magnitude, Pit};
use navbound_core::quantity::{OutOfDomain, Risk};
use numpy::PyReadonlyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

fn refused((index, e): (Option<usize>, OutOfDomain)) -> PyErr {
    input_error(e, index)
}

/// How a bound at a risk did.
#[pyfunction]
fn evaluate_bound<'py>(
    py: Python<'py>,
    error_m: PyReadonlyArray1<'py, f64>,
    bound_m: PyReadonlyArray1<'py, f64>,
    risk: f64,
    track: PyReadonlyArray1<'py, u32>,
) -> PyResult<Bound<'py, PyDict>> {
    let risk = Risk::new(risk).map_err(|e| input_error(e, None))?;
    let (error_m, bound_m, track) = (error_m.as_slice()?, bound_m.as_slice()?, track.as_slice()?);
    let score = py.detach(|| evaluation::bound(error_m, bound_m, risk, track)).map_err(refused)?;
    let d = PyDict::new(py);
    fields!(
        d, score:
        n, n_without_bound, n_outside, n_effective, coverage, coverage_low, coverage_high, mean_m, median_m, max_m, winkler_m, pinball_m
    );
    Ok(d)
}

/// Mean normalised square against its limits.
#[pyfunction]
fn evaluate_nees<'py>(
    py: Python<'py>,
    dimension: usize,
    error_m: PyReadonlyArray1<'py, f64>,
    covariance_m2: PyReadonlyArray1<'py, f64>,
    track: PyReadonlyArray1<'py, u32>,
) -> PyResult<Bound<'py, PyDict>> {
    let (error_m, covariance_m2, track) = (error_m.as_slice()?, covariance_m2.as_slice()?, track.as_slice()?);
    let errors = Errors { dimension, error_m, covariance_m2, track };
    let consistency = py.detach(|| evaluation::nees(&errors)).map_err(refused)?;
    consistency_dict(py, &consistency)
}

fn consistency_dict<'py>(py: Python<'py>, consistency: &Consistency) -> PyResult<Bound<'py, PyDict>> {
    let d = PyDict::new(py);
    fields!(d, consistency: n, n_unusable, n_effective, dimension, nees_mean, nees_low, nees_high);
    Ok(d)
}

/// Histogram of the probability integral transform.
#[pyfunction]
fn evaluate_pit<'py>(
    py: Python<'py>,
    dimension: usize,
    error_m: PyReadonlyArray1<'py, f64>,
    covariance_m2: PyReadonlyArray1<'py, f64>,
    track: PyReadonlyArray1<'py, u32>,
    n_bins: usize,
) -> PyResult<Bound<'py, PyDict>> {
    let (error_m, covariance_m2, track) = (error_m.as_slice()?, covariance_m2.as_slice()?, track.as_slice()?);
    let errors = Errors { dimension, error_m, covariance_m2, track };
    let pit = py.detach(|| evaluation::pit(&errors, n_bins)).map_err(refused)?;
    pit_dict(py, pit)
}

fn pit_dict(py: Python<'_>, pit: Pit) -> PyResult<Bound<'_, PyDict>> {
    let d = PyDict::new(py);
    fields!(d, pit: n, n_effective, counts, low, high);
    Ok(d)
}

/// Cluster bootstrap interval of the coverage.
#[pyfunction]
fn bootstrap_coverage<'py>(
    py: Python<'py>,
    error_m: PyReadonlyArray1<'py, f64>,
    bound_m: PyReadonlyArray1<'py, f64>,
    track: PyReadonlyArray1<'py, u32>,
    n_replicates: usize,
    seed: u64,
) -> PyResult<(f64, f64)> {
    let (error_m, bound_m, track) = (error_m.as_slice()?, bound_m.as_slice()?, track.as_slice()?);
    py.detach(|| evaluation::coverage_interval(error_m, bound_m, track, n_replicates, seed)).map_err(refused)
}

/// Epochs a correlated series is worth.
#[pyfunction]
fn effective_size<'py>(
    py: Python<'py>,
    values: PyReadonlyArray1<'py, f64>,
    track: PyReadonlyArray1<'py, u32>,
    about_zero: bool,
) -> PyResult<f64> {
    let (values, track) = (values.as_slice()?, track.as_slice()?);
    py.detach(|| evaluation::effective_size_of(values, track, about_zero)).map_err(refused)
}

/// Horizontal error in units of its covariance.
#[pyfunction]
fn evaluate_magnitude<'py>(
    py: Python<'py>,
    error_m: PyReadonlyArray1<'py, f64>,
    covariance_m2: PyReadonlyArray1<'py, f64>,
    track: PyReadonlyArray1<'py, u32>,
) -> PyResult<Bound<'py, PyDict>> {
    let (error_m, covariance_m2, track) = (error_m.as_slice()?, covariance_m2.as_slice()?, track.as_slice()?);
    let errors = Errors { dimension: 2, error_m, covariance_m2, track };
    let magnitude = py.detach(|| evaluation::magnitude(&errors)).map_err(refused)?;
    magnitude_dict(py, &magnitude)
}

fn magnitude_dict<'py>(py: Python<'py>, magnitude: &Magnitude) -> PyResult<Bound<'py, PyDict>> {
    let d = PyDict::new(py);
    fields!(d, magnitude: n, n_effective, square_mean, p_value);
    Ok(d)
}

/// The same of judged epochs and those within, track by track.
#[pyfunction]
fn bootstrap_coverage_of_counts(
    py: Python<'_>,
    n: PyReadonlyArray1<'_, u64>,
    n_within: PyReadonlyArray1<'_, u64>,
    n_replicates: usize,
    seed: u64,
) -> PyResult<(f64, f64)> {
    let tracks = n.as_slice()?.iter().copied().zip(n_within.as_slice()?.iter().copied()).collect();
    py.detach(|| evaluation::coverage_interval_of_counts(tracks, n_replicates, seed)).map_err(refused)
}

/// A bound against the error, of epochs in pieces.
#[pyclass(module = "navbound._core")]
#[derive(Default)]
struct BoundPieces(Bounds);

#[pymethods]
impl BoundPieces {
    #[new]
    fn new() -> Self {
        Self::default()
    }

    fn see(
        &mut self,
        error_m: PyReadonlyArray1<'_, f64>,
        bound_m: PyReadonlyArray1<'_, f64>,
        track: PyReadonlyArray1<'_, u32>,
    ) -> PyResult<()> {
        self.0.see(error_m.as_slice()?, bound_m.as_slice()?, track.as_slice()?).map_err(refused)
    }

    fn score<'py>(&mut self, py: Python<'py>, risk: f64) -> PyResult<Bound<'py, PyDict>> {
        let risk = Risk::new(risk).map_err(|e| input_error(e, None))?;
        let score = self.0.score(risk);
        let d = PyDict::new(py);
        fields!(d, score: n, n_without_bound, n_outside, n_effective, coverage, coverage_low, coverage_high, mean_m, max_m, winkler_m, pinball_m);
        Ok(d)
    }
}

/// Normalised squares of epochs in pieces.
#[pyclass(module = "navbound._core")]
struct SquarePieces(Squares, usize);

#[pymethods]
impl SquarePieces {
    #[new]
    fn new(dimension: usize) -> Self {
        Self(Squares::default(), dimension)
    }

    fn see(
        &mut self,
        py: Python<'_>,
        error_m: PyReadonlyArray1<'_, f64>,
        covariance_m2: PyReadonlyArray1<'_, f64>,
        track: PyReadonlyArray1<'_, u32>,
    ) -> PyResult<()> {
        let (error_m, covariance_m2, track) = (error_m.as_slice()?, covariance_m2.as_slice()?, track.as_slice()?);
        let errors = Errors { dimension: self.1, error_m, covariance_m2, track };
        py.detach(|| self.0.see(&errors)).map_err(refused)
    }

    fn nees<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        consistency_dict(py, &self.0.nees())
    }

    fn pit<'py>(&mut self, py: Python<'py>, n_bins: usize) -> PyResult<Bound<'py, PyDict>> {
        let pit = self.0.pit(n_bins).map_err(refused)?;
        pit_dict(py, pit)
    }
}

/// The horizontal error in units of its covariance, of epochs in pieces; the effective size is that of one axis.
#[pyclass(module = "navbound._core")]
struct SizePieces(Sizes);

#[pymethods]
impl SizePieces {
    #[new]
    fn new(axis: usize) -> PyResult<Self> {
        Sizes::new(axis).map(Self).map_err(refused)
    }

    fn see(
        &mut self,
        py: Python<'_>,
        error_m: PyReadonlyArray1<'_, f64>,
        covariance_m2: PyReadonlyArray1<'_, f64>,
        track: PyReadonlyArray1<'_, u32>,
    ) -> PyResult<()> {
        let (error_m, covariance_m2, track) = (error_m.as_slice()?, covariance_m2.as_slice()?, track.as_slice()?);
        py.detach(|| self.0.see(&Errors { dimension: 2, error_m, covariance_m2, track })).map_err(refused)
    }

    fn magnitude<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        magnitude_dict(py, &self.0.magnitude())
    }
}

/// A correlated series in pieces.
#[pyclass(module = "navbound._core")]
#[derive(Default)]
struct SeriesPieces(Series);

#[pymethods]
impl SeriesPieces {
    #[new]
    fn new() -> Self {
        Self::default()
    }

    fn see(&mut self, values: PyReadonlyArray1<'_, f64>, track: PyReadonlyArray1<'_, u32>) -> PyResult<()> {
        self.0.see(values.as_slice()?, track.as_slice()?).map_err(refused)
    }

    fn effective_size(&mut self, about_zero: bool) -> f64 {
        self.0.effective_size(about_zero)
    }
}

/// How often a bound contained the error.
#[pyfunction]
fn evaluate_containment(py: Python<'_>, n_outside: usize, n: usize, n_effective: f64, risk: f64) -> PyResult<Bound<'_, PyDict>> {
    let risk = Risk::new(risk).map_err(|e| input_error(e, None))?;
    let containment = evaluation::containment(n_outside, n, n_effective, risk).map_err(refused)?;
    let d = PyDict::new(py);
    fields!(d, containment: coverage, coverage_low, coverage_high, p_value, p_value_any);
    Ok(d)
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(evaluate_bound, m)?)?;
    m.add_function(wrap_pyfunction!(evaluate_nees, m)?)?;
    m.add_function(wrap_pyfunction!(evaluate_pit, m)?)?;
    m.add_function(wrap_pyfunction!(bootstrap_coverage, m)?)?;
    m.add_function(wrap_pyfunction!(evaluate_magnitude, m)?)?;
    m.add_function(wrap_pyfunction!(evaluate_containment, m)?)?;
    m.add_function(wrap_pyfunction!(bootstrap_coverage_of_counts, m)?)?;
    m.add_class::<BoundPieces>()?;
    m.add_class::<SquarePieces>()?;
    m.add_class::<SizePieces>()?;
    m.add_class::<SeriesPieces>()?;
    m.add_function(wrap_pyfunction!(effective_size, m)?)
}
