//! A receiver's positions with a service's corrections.

use crate::error::{input_error, risk};
use crate::receiver_files::Observations;
use crate::sbas::{Service, ignored, mode_code};
use crate::status;
use navbound_assess::sbas::positions::{self, Corrected, Fix, Used};
use navbound_core::bound::sbas::NoLevel;
use navbound_core::quantity::{OutOfDomain, Reason};
use navbound_core::signal::smoothing::Smoothing;
use numpy::IntoPyArray;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// One number of a solution.
type Number = fn(&Fix) -> f64;
/// One number of a satellite in a solution.
type SatelliteNumber = fn(&Used) -> f64;

/// Columns of the epoch table; `satellites` with columns of their own; `unused`, `ignored`, `smoothed_share`.
#[pyfunction]
fn sbas_positions<'py>(
    py: Python<'py>,
    service: Service<'py>,
    observations: &Observations,
    smoothing_s: Option<f64>,
    false_alarm: f64,
) -> PyResult<Bound<'py, PyDict>> {
    let within = |argument, value, unit, domain, good| {
        if good { Ok(()) } else { Err(input_error(OutOfDomain { argument, value, unit, domain }, None)) }
    };
    if let Some(window) = smoothing_s {
        within("smoothing_s", window, "s", "(0, 86400]", window > 0.0 && window <= 86_400.0)?;
    }
    risk("false_alarm", false_alarm)?;
    let (feed, settings) = service.heard()?;
    let mask = settings.mask.rad();
    within("mask_rad", mask, "rad", "[0, pi/2]", (0.0..=core::f64::consts::FRAC_PI_2).contains(&mask))?;
    let records = &service.navigation.get().records;
    let how = smoothing_s.map(Smoothing::over);
    let corrected = py.detach(|| positions::positions(&feed, records, &observations.0, &settings, how.as_ref()));
    let d = epochs(py, &corrected, false_alarm)?;
    d.set_item("satellites", satellites(py, &corrected)?)?;
    d.set_item("unused", corrected.unused.clone())?;
    d.set_item("smoothed_share", corrected.smoothed_share)?;
    d.set_item("ignored", ignored(py, &feed, &settings))?;
    Ok(d)
}

fn epochs<'py>(py: Python<'py>, corrected: &Corrected, false_alarm: f64) -> PyResult<Bound<'py, PyDict>> {
    let d = PyDict::new(py);
    let columns: [(&str, Number); 14] = [
        ("est_lat_rad", |f| f.solution.position.point.lat().rad()),
        ("est_lon_rad", |f| f.solution.position.point.lon().rad()),
        ("est_h_m", |f| f.solution.position.height.m()),
        ("cov_ee_m2", |f| f.solution.covariance.matrix()[(0, 0)]),
        ("cov_en_m2", |f| f.solution.covariance.matrix()[(0, 1)]),
        ("cov_nn_m2", |f| f.solution.covariance.matrix()[(1, 1)]),
        ("cov_eu_m2", |f| f.solution.covariance.matrix()[(0, 2)]),
        ("cov_nu_m2", |f| f.solution.covariance.matrix()[(1, 2)]),
        ("cov_uu_m2", |f| f.solution.covariance.matrix()[(2, 2)]),
        ("hpl_m", |f| f.solution.levels.hpl.m()),
        ("vpl_m", |f| f.solution.levels.vpl_m()),
        ("hdop", |f| f.solution.dilution.horizontal),
        ("vdop", |f| f.solution.dilution.vertical),
        ("p_residual", |f| f.solution.residual_risk),
    ];
    for (name, value) in columns {
        let values: Vec<f64> = corrected.fixes.iter().map(|f| f.as_ref().map_or(f64::NAN, value)).collect();
        d.set_item(name, values.into_pyarray(py))?;
    }
    let count = |value: fn(&Fix) -> usize| corrected.fixes.iter().map(|f| f.as_ref().map_or(0, |f| value(f) as i64)).collect::<Vec<_>>();
    d.set_item("n_sv", count(|f| f.satellites.len()).into_pyarray(py))?;
    d.set_item("n_redundant", count(|f| f.solution.redundancy).into_pyarray(py))?;
    let mode = corrected.fixes.iter().map(|f| mode_code(f.as_ref().ok().map(|f| f.used_for))).collect::<Vec<_>>();
    d.set_item("mode", mode.into_pyarray(py))?;
    let reasons: Vec<_> = corrected.fixes.iter().map(|f| positions::reason(f, false_alarm)).collect();
    let words = |(f, r): (&Result<Fix, NoLevel>, &Option<Reason>)| match f {
        Ok(_) => r.map_or_else(String::new, |r| r.words().to_owned()),
        Err(why) => why.to_string(),
    };
    d.set_item("status", reasons.iter().map(|r| status::of(*r)).collect::<Vec<_>>())?;
    d.set_item("reason_id", reasons.iter().map(|r| status::id(*r)).collect::<Vec<_>>())?;
    d.set_item("reason", corrected.fixes.iter().zip(&reasons).map(words).collect::<Vec<_>>())?;
    Ok(d)
}

/// One row a satellite and epoch.
fn satellites<'py>(py: Python<'py>, corrected: &Corrected) -> PyResult<Bound<'py, PyDict>> {
    let fixes = corrected.fixes.iter().enumerate().filter_map(|(i, f)| Some((i as i64, f.as_ref().ok()?)));
    let rows: Vec<(i64, &Used)> = fixes.flat_map(|(i, f)| f.satellites.iter().map(move |s| (i, s))).collect();
    let d = PyDict::new(py);
    d.set_item("epoch", rows.iter().map(|(i, _)| *i).collect::<Vec<_>>().into_pyarray(py))?;
    d.set_item("prn", rows.iter().map(|(_, s)| i64::from(s.prn)).collect::<Vec<_>>().into_pyarray(py))?;
    let columns: [(&str, SatelliteNumber); 4] =
        [("az_rad", |s| s.az_rad), ("el_rad", |s| s.el_rad), ("residual_m", |s| s.residual_m), ("sigma_m", |s| s.sigma_m)];
    for (name, value) in columns {
        d.set_item(name, rows.iter().map(|(_, s)| value(s)).collect::<Vec<_>>().into_pyarray(py))?;
    }
    d.set_item("from_grid", rows.iter().map(|(_, s)| s.from_grid).collect::<Vec<_>>().into_pyarray(py))?;
    Ok(d)
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(sbas_positions, m)?)
}
