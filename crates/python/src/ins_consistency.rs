//! The filter judged on simulated flights.

use crate::error::input_error;
use crate::ins_fuse::Told;
use crate::simulate::{read, refused};
use navbound_assess::consistency::{Score, Trial, flights};
use navbound_simulate::Sensing;
use numpy::{IntoPyArray, PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::prelude::*;

/// Numbers of a flight: results, mean NEES, shares in circle and sphere, errors and deviations (RMS, east, north, up), shares of the modes
/// (coasting, VOR/DME, DME/DME, satellites), the ranges' mean square, lag one, used, gated, and results after a stop.
const WIDTH: usize = 19;

fn row(s: &Score) -> [f64; WIDTH] {
    let n = s.n as f64;
    let share = |count: u64| count as f64 / n;
    let mut row = [0.0; WIDTH];
    row[..4].copy_from_slice(&[n, s.sum_nees / n, share(s.n_circle), share(s.n_sphere)]);
    for k in 0..3 {
        row[4 + k] = (s.sum_square_m2[k] / n).sqrt();
        row[7 + k] = (s.sum_variance_m2[k] / n).sqrt();
    }
    for k in 0..4 {
        row[10 + k] = share(s.n_mode[k]);
        row[14 + k] = s.ranges[k];
    }
    row[18] = s.n_stopped as f64;
    row
}

/// One row a flight.
#[pyfunction]
fn ins_consistency<'py>(
    py: Python<'py>,
    scenario: &str,
    seed: u64,
    first: u64,
    normals: PyReadonlyArray2<'py, f64>,
    told: Told,
    skip_s: f64,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let trial = Trial { settings: told.settings()?, sigma: told.sigma(), plan: told.plan(), skip_s };
    let scenario = read(scenario)?;
    let starts: &[[f64; 9]] = normals.as_slice()?.as_chunks().0;
    let sensing = py.detach(|| Sensing::new(scenario, None)).map_err(refused)?;
    let scores = py.detach(|| flights(&sensing, seed, first, starts, &trial)).map_err(|e| input_error(e, None))?;
    scores.iter().flat_map(row).collect::<Vec<_>>().into_pyarray(py).reshape([scores.len(), WIDTH])
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(ins_consistency, m)?)
}
