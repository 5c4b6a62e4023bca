//! ARAIM protection levels.

use crate::error::input_error;
use navbound_assess::araim::{self, Outcome, Row, Sights};
use navbound_core::bound::araim::Levels;
use navbound_core::bound::araim::ranging::Airborne;
use navbound_core::bound::araim::service::{Service, SupportMessage};
use navbound_core::quantity::{Metres, OutOfDomain, Risk};
use navbound_core::signal::Constellation;
use navbound_path::AtIndex;
use numpy::{IntoPyArray, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;

fn refused(e: AtIndex) -> PyErr {
    input_error(e.error, Some(e.index))
}

/// The shipped services by name, each with its numbers and where they come from.
#[pyfunction]
fn araim_services(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let all = PyDict::new(py);
    for s in Service::ALL {
        let d = PyDict::new(py);
        d.set_item("source", s.source)?;
        d.set_item("provenance", s.provenance.word())?;
        for (name, value) in [
            ("integrity_v", s.integrity_v),
            ("integrity_h", s.integrity_h),
            ("false_alarm_v", s.false_alarm_v),
            ("false_alarm_h", s.false_alarm_h),
            ("unmonitored", s.unmonitored),
            ("effective_monitor", s.effective_monitor),
        ] {
            d.set_item(name, value.q())?;
        }
        d.set_item("consolidation", s.consolidation)?;
        d.set_item("emt_limit_m", s.effective_monitor_limit.map_or(f64::NAN, Metres::m))?;
        all.set_item(s.id, d)?;
    }
    Ok(all)
}

/// The shipped support message: source, provenance, and by constellation sigma_ura, sigma_ure, bias, bias for continuity, p_sat, p_const.
#[pyfunction]
fn araim_support(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let m = SupportMessage::STUDY;
    let d = PyDict::new(py);
    d.set_item("id", m.id)?;
    d.set_item("source", m.source)?;
    d.set_item("provenance", m.provenance.word())?;
    let rows = m.support.map(|s| [s.sigma_ura.m(), s.sigma_ure.m(), s.bias.m(), s.bias_continuity.m(), s.p_sat, s.p_const]);
    d.set_item("support", rows)?;
    Ok(d)
}

/// The shipped airborne error models by name: source, provenance, noise terms, vertical ionosphere.
#[pyfunction]
fn araim_error_models(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let all = PyDict::new(py);
    for m in Airborne::ALL {
        let d = PyDict::new(py);
        d.set_item("source", m.source)?;
        d.set_item("provenance", m.provenance.word())?;
        d.set_item("noise", m.noise)?;
        d.set_item("vertical_ionosphere_m", m.vertical_ionosphere.m())?;
        all.set_item(m.id, d)?;
    }
    Ok(all)
}

/// A service from its seven numbers: both integrity risks, both false-alarm risks, unmonitored, effective monitor, consolidation.
fn service(
    &[integrity_v, integrity_h, false_alarm_v, false_alarm_h, unmonitored, effective_monitor, consolidation]: &[f64; 7],
) -> PyResult<Service> {
    let risk = |argument, q| Risk::new(q).map_err(|e| input_error(OutOfDomain { argument, ..e }, None));
    let service = Service {
        id: "",
        integrity_v: risk("integrity_v", integrity_v)?,
        integrity_h: risk("integrity_h", integrity_h)?,
        false_alarm_v: risk("false_alarm_v", false_alarm_v)?,
        false_alarm_h: risk("false_alarm_h", false_alarm_h)?,
        unmonitored: risk("unmonitored", unmonitored)?,
        effective_monitor: risk("effective_monitor", effective_monitor)?,
        consolidation,
        ..Service::LPV_200
    };
    service.checked().map_err(|e| input_error(e, None))
}

fn systems(indices: &[usize]) -> PyResult<Vec<Constellation>> {
    let unknown = |c: usize| OutOfDomain { argument: "constellation", value: c as f64, unit: "1", domain: "indices of CONSTELLATIONS" };
    indices.iter().map(|&c| Constellation::from_index(c).ok_or_else(|| input_error(unknown(c), None))).collect()
}

/// Levels of many epochs from lines of sight. `numbers` are the service's.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "one for each array of the Python function")]
fn araim_levels<'py>(
    py: Python<'py>,
    unit_enu: PyReadonlyArray1<'_, f64>,
    sigma_int_m: PyReadonlyArray1<'_, f64>,
    sigma_acc_m: PyReadonlyArray1<'_, f64>,
    bias_m: PyReadonlyArray1<'_, f64>,
    bias_continuity_m: PyReadonlyArray1<'_, f64>,
    p_sat: PyReadonlyArray1<'_, f64>,
    constellation: Vec<usize>,
    p_const: [f64; 5],
    numbers: [f64; 7],
) -> PyResult<Bound<'py, PyDict>> {
    let (service, systems) = (service(&numbers)?, systems(&constellation)?);
    let sights = Sights {
        unit_enu: unit_enu.as_slice()?,
        sigma_int_m: sigma_int_m.as_slice()?,
        sigma_acc_m: sigma_acc_m.as_slice()?,
        bias_m: bias_m.as_slice()?,
        bias_continuity_m: bias_continuity_m.as_slice()?,
        p_sat: p_sat.as_slice()?,
        constellation: &systems,
        p_const,
    };
    let rows = py.detach(|| araim::levels(&sights, &service)).map_err(refused)?;
    columns(py, &rows)
}

/// A dictionary of columns; NaN where an epoch has no levels.
fn columns<'py>(py: Python<'py>, rows: &[Row]) -> PyResult<Bound<'py, PyDict>> {
    let number = |f: fn(&Levels) -> f64| rows.iter().map(|r| r.levels.as_ref().map_or(f64::NAN, f)).collect::<Vec<_>>().into_pyarray(py);
    let count = |f: fn(&Levels) -> usize| rows.iter().map(|r| r.levels.as_ref().map_or(0, f) as i64).collect::<Vec<_>>().into_pyarray(py);
    let d = PyDict::new(py);
    d.set_item("hpl_m", number(|l| l.hpl.m()))?;
    d.set_item("vpl_m", number(|l| l.vpl.m()))?;
    d.set_item("hpl_e_m", number(|l| l.axes[0].m()))?;
    d.set_item("hpl_n_m", number(|l| l.axes[1].m()))?;
    d.set_item("emt_m", number(|l| l.emt.m()))?;
    d.set_item("sigma_acc_e_m", number(|l| l.sigma_accuracy[0].m()))?;
    d.set_item("sigma_acc_n_m", number(|l| l.sigma_accuracy[1].m()))?;
    d.set_item("sigma_acc_u_m", number(|l| l.sigma_accuracy[2].m()))?;
    d.set_item("p_unmonitored", number(|l| l.p_unmonitored))?;
    d.set_item("n_modes", count(|l| l.n_modes))?;
    d.set_item("n_monitored", count(|l| l.n_monitored))?;
    d.set_item("n_sv", rows.iter().map(|r| r.n_sv as i64).collect::<Vec<_>>().into_pyarray(py))?;
    d.set_item("outcome", rows.iter().map(|r| r.outcome as u8).collect::<Vec<_>>().into_pyarray(py))?;
    d.set_item("words", Outcome::WORDS.to_vec())?;
    Ok(d)
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(araim_services, m)?)?;
    m.add_function(wrap_pyfunction!(araim_support, m)?)?;
    m.add_function(wrap_pyfunction!(araim_error_models, m)?)?;
    m.add_function(wrap_pyfunction!(araim_levels, m)?)
}
