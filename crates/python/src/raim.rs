//! RAIM by the slope method.

use crate::algorithms::levels;
use crate::araim::{beside, promise, refused, requirement, systems, unmonitored, users, word};
use crate::error::input_error;
use crate::gnss::orbit;
use crate::receiver_files::{Navigation, Observations};
use crate::status;
use navbound_assess::outlook::{Outcome, Outlook};
use navbound_assess::raim::{self, Row, Sights, Tested, Watched};
use navbound_core::bound::Levels;
use navbound_core::bound::raim::exclusion::Monitored;
use navbound_core::bound::raim::{Detail, Factors, MOST_SATELLITES, NOISE_SOURCE, SOURCE};
use navbound_core::geometry::Elements;
use navbound_core::quantity::{OutOfDomain, Radians, Unavailable};
use numpy::{IntoPyArray, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Documents of the method: the published form, and what is added to it.
#[pyfunction]
fn raim_sources() -> (&'static str, &'static str) {
    (SOURCE, NOISE_SOURCE)
}

/// Threshold of the root of the weighted sum of squares, and the bias that stays below it with the risk of a missed detection.
#[pyfunction]
fn raim_factors(n_redundant: Vec<i64>, numbers: [f64; 3]) -> PyResult<Vec<(f64, f64)>> {
    let requirement = requirement(numbers)?;
    let factors = |(index, n): (usize, &i64)| {
        let domain = "[1, 60]: ranges beyond the unknowns";
        let wrong = || input_error(OutOfDomain { argument: "n_redundant", value: *n as f64, unit: "1", domain }, Some(index));
        let redundancy = usize::try_from(*n).ok().filter(|n| (1..=MOST_SATELLITES - 4).contains(n)).ok_or_else(wrong)?;
        let computed = Factors::new(&requirement, redundancy);
        Ok((computed.threshold, computed.missed_bias))
    };
    n_redundant.iter().enumerate().map(factors).collect()
}

/// Levels of many epochs from lines of sight.
#[pyfunction]
fn raim_levels<'py>(
    py: Python<'py>,
    unit_enu: PyReadonlyArray1<'_, f64>,
    sigma_m: PyReadonlyArray1<'_, f64>,
    constellation: Vec<usize>,
    numbers: [f64; 3],
) -> PyResult<Bound<'py, PyDict>> {
    let (requirement, systems) = (requirement(numbers)?, systems(&constellation)?);
    let sights = Sights { unit_enu: unit_enu.as_slice()?, sigma_m: sigma_m.as_slice()?, constellation: &systems };
    let rows = py.detach(|| raim::levels(&sights, &requirement)).map_err(refused)?;
    columns(py, &rows)
}

/// Detection and exclusion at many epochs: levels of what is left, the decision, its ratio, the step and the excluded columns.
#[pyfunction]
fn raim_monitor<'py>(
    py: Python<'py>,
    unit_enu: PyReadonlyArray1<'_, f64>,
    residual_m: PyReadonlyArray1<'_, f64>,
    sigma_m: PyReadonlyArray1<'_, f64>,
    constellation: Vec<usize>,
    numbers: [f64; 3],
) -> PyResult<Bound<'py, PyDict>> {
    let (requirement, systems) = (requirement(numbers)?, systems(&constellation)?);
    let sights = Sights { unit_enu: unit_enu.as_slice()?, sigma_m: sigma_m.as_slice()?, constellation: &systems };
    let residual_m = residual_m.as_slice()?;
    let tested = py.detach(|| raim::monitored(&sights, residual_m, &requirement)).map_err(refused)?;
    let mut excluded = vec![false; sights.sigma_m.len()];
    for (row, test) in tested.iter().enumerate() {
        if let Some(column) = test.excluded {
            excluded[row * systems.len() + column] = true;
        }
    }
    let d = decisions(py, &tested.iter().map(Some).collect::<Vec<_>>())?;
    d.set_item("excluded", excluded.into_pyarray(py))?;
    Ok(d)
}

/// Levels of every user at every instant, instants first; orbits are rows of seven elements.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "one for each array of the Python function")]
fn raim_predict<'py>(
    py: Python<'py>,
    elements: PyReadonlyArray2<'_, f64>,
    constellation: Vec<usize>,
    time_s: PyReadonlyArray1<'_, f64>,
    lat_rad: PyReadonlyArray1<'_, f64>,
    lon_rad: PyReadonlyArray1<'_, f64>,
    h_m: PyReadonlyArray1<'_, f64>,
    mask_rad: f64,
    support: [[f64; 6]; 5],
    airborne: [f64; 4],
    numbers: [f64; 3],
) -> PyResult<Bound<'py, PyDict>> {
    let orbits: Vec<Elements> = elements.as_slice()?.as_chunks().0.iter().map(orbit).collect();
    let users = users(lat_rad.as_slice()?, lon_rad.as_slice()?, h_m.as_slice()?)?;
    let (requirement, systems, promise) = (requirement(numbers)?, systems(&constellation)?, promise(&support, airborne)?);
    let mask = Radians::new(mask_rad);
    let outlook = Outlook { orbits: &orbits, constellation: &systems, time_s: time_s.as_slice()?, users: &users, mask, promise };
    let rows = py.detach(|| raim::predict(&outlook, &requirement)).map_err(refused)?;
    columns(py, &rows)
}

/// Detection and exclusion at every epoch of an observation file.
#[pyfunction]
#[pyo3(signature = (observations, navigation, systems, dual, mask_rad, support, airborne, numbers, smoothing_s, keep_ranges))]
#[expect(clippy::too_many_arguments, reason = "one for each argument of the Python function")]
fn raim_watch<'py>(
    py: Python<'py>,
    observations: &Observations,
    navigation: &Navigation,
    systems: &str,
    dual: bool,
    mask_rad: f64,
    support: [[f64; 6]; 5],
    airborne: [f64; 4],
    numbers: [f64; 3],
    smoothing_s: Option<f64>,
    keep_ranges: bool,
) -> PyResult<Bound<'py, PyDict>> {
    let (requirement, promise) = (requirement(numbers)?, promise(&support, airborne)?);
    let job = unmonitored(navigation, (systems, dual), mask_rad, smoothing_s, keep_ranges);
    let watch = py.detach(|| raim::watch(&observations.0, &navigation.records, &job, &promise, &requirement));
    let watched = &watch.epochs;
    let d = decisions(py, &watched.iter().map(|w| w.as_ref().ok().map(|w| &w.tested)).collect::<Vec<_>>())?;
    let number = |f: fn(&Watched) -> f64| watched.iter().map(|w| w.as_ref().map_or(f64::NAN, f)).collect::<Vec<_>>().into_pyarray(py);
    d.set_item("est_lat_rad", number(|w| w.position.point.lat().rad()))?;
    d.set_item("est_lon_rad", number(|w| w.position.point.lon().rad()))?;
    d.set_item("est_h_m", number(|w| w.position.height.m()))?;
    let name = |w: &Result<Watched, Unavailable>| w.as_ref().ok().and_then(|w| w.excluded).map(|s| s.to_string()).unwrap_or_default();
    d.set_item("excluded", watched.iter().map(name).collect::<Vec<String>>())?;
    let reasons = watch.reasons(raim::reason);
    d.set_item("status", reasons.iter().map(|r| status::of(*r)).collect::<Vec<_>>())?;
    d.set_item("reason_id", reasons.iter().map(|r| status::id(*r)).collect::<Vec<_>>())?;
    d.set_item("refusal", watched.iter().map(|w| w.as_ref().err().map(ToString::to_string).unwrap_or_default()).collect::<Vec<_>>())?;
    beside(&d, &watch, |w| w.as_ref().ok()?.residuals.consistency)?;
    Ok(d)
}

/// Columns of levels and decisions; the levels are those of what is left, those after exclusion that of the geometry before it.
fn decisions<'py>(py: Python<'py>, tests: &[Option<&Tested>]) -> PyResult<Bound<'py, PyDict>> {
    let none = Row { n_sv: 0, outcome: Outcome::Singular, levels: None };
    let row = |t: &Option<&Tested>| {
        t.map_or(none, |t| {
            let left = t.monitored.zip(t.before.levels).map(|(m, before)| {
                let Levels { hpl, vpl, detail } = m.levels;
                Levels { hpl, vpl, detail: (detail, before.detail.1) }
            });
            Row { n_sv: t.before.n_sv, outcome: t.outcome, levels: left }
        })
    };
    let d = columns(py, &tests.iter().map(row).collect::<Vec<_>>())?;
    let of = |f: fn(&Monitored) -> f64| {
        let each = |t: &Option<&Tested>| t.and_then(|t| t.monitored.as_ref()).map_or(f64::NAN, f);
        tests.iter().map(each).collect::<Vec<_>>().into_pyarray(py)
    };
    d.set_item("ratio", of(|m| m.ratio))?;
    d.set_item("step_e_m", of(|m| m.step[0].m()))?;
    d.set_item("step_n_m", of(|m| m.step[1].m()))?;
    d.set_item("step_u_m", of(|m| m.step[2].m()))?;
    let decision = |t: &Option<&Tested>| t.and_then(|t| t.monitored).map_or("", |m| word(m.decision));
    d.set_item("decision", tests.iter().map(decision).collect::<Vec<_>>())?;
    Ok(d)
}

/// A dictionary of columns; NaN where an epoch has no position.
fn columns<'py>(py: Python<'py>, rows: &[Row]) -> PyResult<Bound<'py, PyDict>> {
    let number = |f: fn(&Levels<(Detail, Levels)>) -> f64| {
        rows.iter().map(|r| r.levels.as_ref().map_or(f64::NAN, f)).collect::<Vec<_>>().into_pyarray(py)
    };
    let d = levels(py, rows)?;
    d.set_item("hel_m", number(|l| l.detail.1.hpl.m()))?;
    d.set_item("vel_m", number(|l| l.detail.1.vpl_m()))?;
    d.set_item("hpl_slope_m", number(|l| l.detail.0.hpl_slope.m()))?;
    d.set_item("vpl_slope_m", number(|l| l.detail.0.vpl_slope.m()))?;
    d.set_item("sigma_e_m", number(|l| l.detail.0.sigma[0].m()))?;
    d.set_item("sigma_n_m", number(|l| l.detail.0.sigma[1].m()))?;
    d.set_item("sigma_u_m", number(|l| l.detail.0.sigma[2].m()))?;
    let redundant = |r: &Row| r.levels.as_ref().map_or(0, |l| l.detail.0.redundancy) as i64;
    d.set_item("n_redundant", rows.iter().map(redundant).collect::<Vec<_>>().into_pyarray(py))?;
    Ok(d)
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(raim_sources, m)?)?;
    m.add_function(wrap_pyfunction!(raim_factors, m)?)?;
    m.add_function(wrap_pyfunction!(raim_levels, m)?)?;
    m.add_function(wrap_pyfunction!(raim_monitor, m)?)?;
    m.add_function(wrap_pyfunction!(raim_predict, m)?)?;
    m.add_function(wrap_pyfunction!(raim_watch, m)?)
}
