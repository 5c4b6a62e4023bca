//! RRAIM: protection levels of coasting phases, and the grid of the surface-movement study.

use crate::gbas::{carrier, constellations, form, ordering, refusal, refused};
use crate::status;
use navbound_assess::gbas::Skies;
use navbound_assess::rraim::{self, Answer, Coasting, Request};
use navbound_assess::surface::{self, Demand, Grid};
use navbound_core::bound::gbas::levels::Factors;
use navbound_core::bound::rraim::modes::Priors;
use navbound_core::bound::rraim::multiple::{Budget, NoLevel};
use navbound_core::bound::rraim::single::Settings;
use navbound_core::quantity::{Metres, OutOfDomain, Risk, Unavailable};
use numpy::{IntoPyArray, PyArray2, PyArrayMethods, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Skies at the fix, as they come from Python.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct FixJob<'py> {
    az_rad: PyReadonlyArray1<'py, f64>,
    el_rad: PyReadonlyArray1<'py, f64>,
    sigma_m: PyReadonlyArray1<'py, f64>,
    sigma_h1_m: PyReadonlyArray1<'py, f64>,
    constellation: Vec<usize>,
    aided_m2: Option<PyReadonlyArray1<'py, f64>>,
}

/// Multipliers and risks.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct Rule {
    k_ff: f64,
    k_md: f64,
    continuity_risk: f64,
    allotted_risk: f64,
    form: String,
    ordering: String,
    biased_threshold: bool,
}

impl Rule {
    fn read(&self) -> PyResult<(Settings, Budget)> {
        let named = |argument, q| Risk::new(q).map_err(|e| refusal(OutOfDomain { argument, ..e }));
        let continuity = named("continuity_risk", self.continuity_risk)?;
        let allotted = named("allotted_risk", self.allotted_risk)?;
        let factors = Factors { fault_free: self.k_ff, missed: self.k_md };
        let (form, ordering) = (form(&self.form)?, ordering(&self.ordering)?);
        Ok((
            Settings { factors, continuity, allotted, form, ordering, biased_threshold: self.biased_threshold },
            Budget { allotted, continuity },
        ))
    }
}

/// The satellites now, and what is required.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct Job<'py> {
    fix: FixJob<'py>,
    az_now_rad: PyReadonlyArray1<'py, f64>,
    el_now_rad: PyReadonlyArray1<'py, f64>,
    sigma_td_m: PyReadonlyArray1<'py, f64>,
    bias_m: PyReadonlyArray1<'py, f64>,
    rule: Rule,
    p_sat: [f64; 5],
    p_const: [f64; 5],
    p_threshold: f64,
}

/// Levels of coasting phases: one array a column, NaN where there is none; `subsets` (n, satellites, 4); reasons of both kinds.
#[pyfunction]
fn rraim_levels<'py>(py: Python<'py>, job: Job<'py>) -> PyResult<Bound<'py, PyDict>> {
    let constellation = constellations(&job.fix.constellation)?;
    let fix = Skies {
        az_rad: job.fix.az_rad.as_slice()?,
        el_rad: job.fix.el_rad.as_slice()?,
        sigma_m: job.fix.sigma_m.as_slice()?,
        sigma_h1_m: job.fix.sigma_h1_m.as_slice()?,
        constellation: &constellation,
    };
    let coasting =
        Coasting { fix, az_rad: job.az_now_rad.as_slice()?, el_rad: job.el_now_rad.as_slice()?, sigma_td_m: job.sigma_td_m.as_slice()? };
    let (single, budget) = job.rule.read()?;
    let priors = Priors { satellite: job.p_sat, constellation: job.p_const, threshold: job.p_threshold }.check().map_err(refusal)?;
    let request = Request {
        bias_m: job.bias_m.as_slice()?,
        aided_m2: job.fix.aided_m2.as_ref().map(|a| a.as_slice()).transpose()?,
        single,
        budget,
        priors,
    };
    let levels = py.detach(|| rraim::protection_levels(&coasting, &request)).map_err(refused)?;
    let width = constellation.len();
    let mut columns = vec![Vec::with_capacity(levels.len()); COLUMNS.len()];
    let (mut matrices, mut subsets) = (Vec::new(), Vec::new());
    let (mut reasons, mut multi_reasons, mut ids, mut multi_ids) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for answer in &levels {
        let row = answer.as_ref().map_or([f64::NAN; COLUMNS.len()], level_row);
        columns.iter_mut().zip(row).for_each(|(column, value)| column.push(value));
        let matrix = answer.as_ref().map_or([f64::NAN; 9], |a| std::array::from_fn(|i| a.covariance.matrix()[(i / 3, i % 3)]));
        matrices.extend(matrix);
        let mut block = vec![f64::NAN; 4 * width];
        for (column, w, threshold) in answer.iter().flat_map(|a| &a.without) {
            let row = [w.deviation.m(), w.separation.m(), w.gain, threshold.m()];
            block[4 * column..4 * column + 4].copy_from_slice(&row);
        }
        subsets.extend(block);
        ids.push(status::id(answer.as_ref().err().map(Unavailable::reason)));
        reasons.push(answer.as_ref().err().map(ToString::to_string).unwrap_or_default());
        let multi = answer.as_ref().ok().and_then(|a| a.multiple.err());
        multi_ids.push(status::id(multi.as_ref().map(NoLevel::reason)));
        multi_reasons.push(multi.as_ref().map(NoLevel::to_string).unwrap_or_default());
    }
    let d = PyDict::new(py);
    for (name, column) in COLUMNS.into_iter().zip(columns) {
        d.set_item(name, column.into_pyarray(py))?;
    }
    d.set_item("cov_enu_m2", matrices.into_pyarray(py))?;
    d.set_item("subsets", subsets.into_pyarray(py).reshape([levels.len(), width, 4])?)?;
    d.set_item("reason", reasons)?;
    d.set_item("reason_id", ids)?;
    d.set_item("multi_reason_id", multi_ids)?;
    d.set_item("multi_reason", multi_reasons)?;
    Ok(d)
}

const COLUMNS: [&str; 13] = [
    "n_sv",
    "sigma_major_m",
    "bias_gain",
    "accuracy_m",
    "hpl_h0_m",
    "hpl_h1_m",
    "hpl_h2c_m",
    "hpl_m",
    "hpl_multi_e_m",
    "hpl_multi_n_m",
    "hpl_multi_m",
    "n_modes",
    "p_not_monitored",
];

fn level_row(a: &Answer) -> [f64; COLUMNS.len()] {
    let nan = Metres::new(f64::NAN);
    let [e, n, h] = a.multiple.unwrap_or([nan; 3]).map(Metres::m);
    let s = &a.single;
    [
        a.n_sv as f64,
        a.major.m(),
        a.gain,
        a.accuracy.m(),
        s.detail.fault_free.m(),
        s.detail.receiver_faulty.m(),
        s.detail.satellite_faulty.m(),
        s.hpl.m(),
        e,
        n,
        h,
        a.n_modes as f64,
        a.not_monitored,
    ]
}

/// The grid of the study.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct GridJob<'py> {
    fix: FixJob<'py>,
    az_now_rad: PyReadonlyArray1<'py, f64>,
    el_now_rad: PyReadonlyArray1<'py, f64>,
    coasting_s: Vec<f64>,
    demands: Vec<(f64, Rule)>,
    unmonitored: f64,
    bias_m: Vec<f64>,
    carrier: [f64; 4],
    rate_per_hour: [f64; 5],
    wide_per_hour: [f64; 5],
    fault_lasts_s: Option<f64>,
}

/// Accuracy, single-fault and multi-fault level: three numbers a cell, skies by coasting times by sub-phases by biases.
#[pyfunction]
fn surface_cells<'py>(py: Python<'py>, job: GridJob<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let constellation = constellations(&job.fix.constellation)?;
    let mut demands = Vec::with_capacity(job.demands.len());
    for (speed_mps, rule) in &job.demands {
        let (single, budget) = rule.read()?;
        demands.push(Demand { speed_mps: *speed_mps, single, budget, unmonitored: job.unmonitored });
    }
    let grid = Grid {
        fix: Skies {
            az_rad: job.fix.az_rad.as_slice()?,
            el_rad: job.fix.el_rad.as_slice()?,
            sigma_m: job.fix.sigma_m.as_slice()?,
            sigma_h1_m: job.fix.sigma_h1_m.as_slice()?,
            constellation: &constellation,
        },
        aided_m2: job.fix.aided_m2.as_ref().map(|a| a.as_slice()).transpose()?,
        az_rad: job.az_now_rad.as_slice()?,
        el_rad: job.el_now_rad.as_slice()?,
        coasting_s: &job.coasting_s,
        demands: &demands,
        bias_m: &job.bias_m,
        carrier: carrier(job.carrier),
        rates: (job.rate_per_hour, job.wide_per_hour),
        fault_lasts_s: job.fault_lasts_s,
    };
    let cells = py.detach(|| surface::cells(&grid)).map_err(refused)?;
    let n = cells.len();
    cells.into_flattened().into_pyarray(py).reshape([n, 3])
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(rraim_levels, m)?)?;
    m.add_function(wrap_pyfunction!(surface_cells, m)?)
}
