//! The filter judged on simulated flights.

use crate::error::input_error;
use crate::ins_fuse::Declared;
use crate::simulate::{read, refused};
use navbound_assess::consistency::{Judged, Score, Trial, flights};
use navbound_simulate::Sensing;
use numpy::{IntoPyArray, PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::prelude::*;

/// Numbers of a flight: those of the solution; the ranges' mean square, lag one, used, gated, and their largest memory; both filters compared:
/// instants, mean and largest squared difference, times raised; those of the filter without satellites.
const WIDTH: usize = 2 * SCORE + 9;

fn row(j: &Judged) -> [f64; WIDTH] {
    let mut row = [0.0; WIDTH];
    let a = &j.agreement;
    row[..SCORE].copy_from_slice(&score(&j.main));
    row[SCORE..SCORE + 4].copy_from_slice(&j.ranges);
    let compared = [j.memory_most, a.n as f64, a.sum_square / a.n as f64, a.most, a.n_raised as f64];
    row[SCORE + 4..SCORE + 9].copy_from_slice(&compared);
    row[SCORE + 9..].copy_from_slice(&score(&j.beside));
    row
}

/// Of one filter: results, mean NEES, shares in circle and sphere, errors and deviations (RMS, east, north, up), shares of the modes
/// (coasting, VOR/DME, DME/DME, satellites, aligning), and results after a stop.
const SCORE: usize = 16;

fn score(s: &Score) -> [f64; SCORE] {
    let n = s.n as f64;
    let share = |count: u64| count as f64 / n;
    let mut row = [0.0; SCORE];
    row[..4].copy_from_slice(&[n, s.sum_nees / n, share(s.n_circle), share(s.n_sphere)]);
    let [error_m, deviation_m] = s.rms_m();
    row[4..7].copy_from_slice(&error_m);
    row[7..10].copy_from_slice(&deviation_m);
    for k in 0..5 {
        row[10 + k] = share(s.n_mode[k]);
    }
    row[15] = s.n_stopped as f64;
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
    declared: Declared,
    skip_s: f64,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let trial = Trial { settings: declared.settings()?, sigma: declared.sigma(), plan: declared.plan(), skip_s };
    let scenario = read(scenario)?;
    let starts: &[[f64; 9]] = normals.as_slice()?.as_chunks().0;
    let sensing = py.detach(|| Sensing::new(scenario, None)).map_err(refused)?;
    let judged = py.detach(|| flights(&sensing, seed, first, starts, &trial)).map_err(|e| input_error(e, None))?;
    judged.iter().flat_map(row).collect::<Vec<_>>().into_pyarray(py).reshape([judged.len(), WIDTH])
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(ins_consistency, m)?)
}
