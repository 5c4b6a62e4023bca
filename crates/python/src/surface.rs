//! Surface movement: the rebuilt tables with their marks.

use crate::fields::fields;
use navbound_core::quantity::Risk;
use navbound_core::spec::gbas::{CARRIER_DUAL, CARRIER_SINGLE, CarrierModel, ERROR_MODELS, INERTIAL, Inertial, MONITOR_CURVES, Mark};
use navbound_core::spec::surface::{ALLOCATION, ERROR_BUDGET, FAULT_RATES, SUB_PHASES};
use pyo3::prelude::*;
use pyo3::types::PyDict;

type Marks = Vec<(&'static str, &'static str, &'static str)>;

fn marks(marks: &'static [Mark]) -> Marks {
    marks.iter().map(|m| (m.name, m.provenance.word(), m.why)).collect()
}

fn carrier<'py>(py: Python<'py>, m: &CarrierModel) -> PyResult<Bound<'py, PyDict>> {
    let d = PyDict::new(py);
    d.set_item("noise_m", m.noise.m())?;
    fields!(d, m: troposphere_gradient, clock_mps, ionosphere_gradient);
    d.set_item("marks", marks(m.marks))?;
    Ok(d)
}

fn inertial<'py>(py: Python<'py>, i: &Inertial) -> PyResult<Bound<'py, PyDict>> {
    let d = PyDict::new(py);
    d.set_item("gyro_bias_radps", i.gyro_bias_radps)?;
    d.set_item("gyro_walk_radprts", i.gyro_walk_rad_per_root_s)?;
    d.set_item("accelerometer_bias_mps2", i.accelerometer_bias_mps2)?;
    d.set_item("accelerometer_walk_mpsprts", i.accelerometer_walk_mps_per_root_s)?;
    fields!(d, i: clock_h0_s, clock_h_minus_2_per_s, doppler_mps);
    d.set_item("receiver_noise_m", i.receiver_noise.m())?;
    d.set_item("marks", marks(i.marks))?;
    Ok(d)
}

/// Everything the study takes as given, with how it is held.
#[pyfunction]
fn surface_tables(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let mut phases = Vec::new();
    for p in SUB_PHASES {
        let d = PyDict::new(py);
        fields!(d, p: id, title);
        d.set_item("containment_m", p.containment.m())?;
        d.set_item("hal_m", p.hal.m())?;
        d.set_item("integrity_risk", p.integrity.q())?;
        d.set_item("continuity_risk", p.continuity.q())?;
        fields!(d, p: speed_mps, exposure_s);
        d.set_item("marks", marks(p.marks))?;
        phases.push(d);
    }
    let mut rates = Vec::new();
    for r in FAULT_RATES {
        let d = PyDict::new(py);
        fields!(d, r: id, gps_per_hour, galileo_per_hour, gps_wide_per_hour, galileo_wide_per_hour, decorrelation_s, satellites);
        d.set_item("marks", marks(r.marks))?;
        rates.push(d);
    }
    let mut curves = Vec::new();
    for c in MONITOR_CURVES {
        let d = PyDict::new(py);
        fields!(d, c: id, stretch, projection);
        d.set_item("start_m", c.start.m())?;
        d.set_item("end_m", c.end.m())?;
        d.set_item("marks", marks(c.marks))?;
        curves.push(d);
    }
    let models: Vec<(&str, &str, Marks)> = ERROR_MODELS.iter().map(|m| (m.id, m.title, marks(m.marks))).collect();
    let d = PyDict::new(py);
    d.set_item("sub_phases", phases)?;
    d.set_item("fault_rates", rates)?;
    d.set_item("monitor_curves", curves)?;
    d.set_item("error_models", models)?;
    d.set_item("carrier_single", carrier(py, &CARRIER_SINGLE)?)?;
    d.set_item("carrier_dual", carrier(py, &CARRIER_DUAL)?)?;
    d.set_item("inertial", inertial(py, &INERTIAL)?)?;
    let lasting: Vec<(&str, [f64; 2])> = ERROR_MODELS.iter().map(|m| (m.id, m.multipath_s)).collect();
    d.set_item("multipath_s", lasting)?;
    let a = PyDict::new(py);
    fields!(a, ALLOCATION: no_fault_and_receiver, ground, coasting_ground, coasting_fault, unmonitored, receiver_fault, axes);
    a.set_item("marks", marks(ALLOCATION.marks))?;
    d.set_item("allocation", a)?;
    let b = PyDict::new(py);
    b.set_item("containment_risk", Risk::q(ERROR_BUDGET.containment_risk))?;
    b.set_item("sigma_fte_m", ERROR_BUDGET.sigma_fte.m())?;
    b.set_item("sigma_pde_m", ERROR_BUDGET.sigma_pde.m())?;
    b.set_item("marks", marks(ERROR_BUDGET.marks))?;
    d.set_item("error_budget", b)?;
    Ok(d)
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(surface_tables, m)?)
}
