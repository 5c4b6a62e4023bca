//! ARAIM protection levels.

use crate::algorithms::levels;
use crate::error::input_error;
use crate::fields::fields;
use crate::gnss::orbit;
use crate::positions::heard;
use crate::positions::satellites;
use crate::receiver_files::{Navigation, Observations};
use crate::status;
use navbound_assess::araim::{self, Row, Rule, Sights};
use navbound_assess::araim_watch::{Watched, reason, watch};
use navbound_assess::outlook::{Outcome, Outlook, Promise, refusal};
use navbound_assess::positions::{Job, Signals, Watch};
use navbound_assess::receivers::heard::Tested;
use navbound_assess::smoothing::Form;
use navbound_core::bound::NoLevels;
use navbound_core::bound::araim::Levels;
use navbound_core::bound::araim::exclusion::{Decision, Monitored};
use navbound_core::bound::araim::ranging::Airborne;
use navbound_core::bound::araim::service::{Service, Support, SupportMessage};
use navbound_core::bound::araim::single::Requirement;
use navbound_core::frame::{Geodetic, LatLon};
use navbound_core::geometry::Elements;
use navbound_core::geometry::ionosphere::Ionosphere;
use navbound_core::quantity::{Metres, OutOfDomain, Radians, Risk};
use navbound_core::signal::Constellation;
use navbound_core::signal::smoothing::Smoothing;
use navbound_core::solution::RangeError;
use navbound_core::solution::consistency::Consistency;
use navbound_core::solution::point::Settings;
use navbound_path::AtIndex;
use numpy::{IntoPyArray, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

pub(crate) fn refused(e: AtIndex) -> PyErr {
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
    fields!(d, m: id, source);
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

pub(crate) fn systems(indices: &[usize]) -> PyResult<Vec<Constellation>> {
    let unknown = |c: usize| OutOfDomain { argument: "constellation", value: c as f64, unit: "1", domain: "indices of CONSTELLATIONS" };
    indices.iter().map(|&c| Constellation::from_index(c).ok_or_else(|| input_error(unknown(c), None))).collect()
}

/// A rule from its numbers: seven of a service, or three of receivers without priors.
fn rule(numbers: &[f64]) -> PyResult<Rule> {
    match numbers {
        [false_alarm, missed_detection, fault_free] => Ok(Rule::Raim(requirement([*false_alarm, *missed_detection, *fault_free])?)),
        _ => {
            let seven = numbers.try_into().map_err(|_| {
                let domain = "seven numbers of a service, or three of RAIM";
                input_error(OutOfDomain { argument: "service", value: numbers.len() as f64, unit: "1", domain }, None)
            })?;
            Ok(Rule::Araim(service(seven)?))
        }
    }
}

/// What receivers without priors must meet: risks of a false alarm, of a missed detection, and without a fault.
pub(crate) fn requirement([false_alarm, missed_detection, fault_free]: [f64; 3]) -> PyResult<Requirement> {
    let risk = |argument, q| Risk::new(q).map_err(|e| input_error(OutOfDomain { argument, ..e }, None));
    Ok(Requirement {
        id: "",
        false_alarm: risk("false_alarm", false_alarm)?,
        missed_detection: risk("missed_detection", missed_detection)?,
        fault_free: risk("fault_free", fault_free)?,
        ..Requirement::RAIM
    })
}

/// The shipped requirement of receivers without priors.
#[pyfunction]
fn raim_requirement(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let r = Requirement::RAIM;
    let d = PyDict::new(py);
    d.set_item("source", r.source)?;
    d.set_item("provenance", r.provenance.word())?;
    d.set_item("false_alarm", r.false_alarm.q())?;
    d.set_item("missed_detection", r.missed_detection.q())?;
    d.set_item("fault_free", r.fault_free.q())?;
    Ok(d)
}

/// Promises by constellation (sigma_ura, sigma_ure, bias, bias for continuity, p_sat, p_const), and the airborne model's three noise
/// terms and vertical ionosphere.
pub(crate) fn promise(support: &[[f64; 6]; 5], airborne: [f64; 4]) -> PyResult<Promise> {
    let each = |&[ura, ure, bias, continuity, p_sat, p_const]: &[f64; 6]| Support {
        sigma_ura: Metres::new(ura),
        sigma_ure: Metres::new(ure),
        bias: Metres::new(bias),
        bias_continuity: Metres::new(continuity),
        p_sat,
        p_const,
    };
    for (index, row) in support.iter().enumerate() {
        each(row).checked().map_err(|e| input_error(e, Some(index)))?;
    }
    let [a, b, scale, vertical] = airborne;
    let airborne = Airborne { noise: [a, b, scale], vertical_ionosphere: Metres::new(vertical), ..Airborne::DUAL_FREQUENCY };
    Ok(Promise { support: support.each_ref().map(each), airborne })
}

/// Users from their coordinates.
pub(crate) fn users(lat_rad: &[f64], lon_rad: &[f64], h_m: &[f64]) -> PyResult<Vec<Geodetic>> {
    let user = |(index, ((lat, lon), h)): (usize, ((&f64, &f64), &f64))| {
        let point = LatLon::new(Radians::new(*lat), Radians::new(*lon)).map_err(|e| input_error(e, Some(index)))?;
        Ok(Geodetic { point, height: Metres::new(*h) })
    };
    lat_rad.iter().zip(lon_rad).zip(h_m).enumerate().map(user).collect()
}

/// Levels of every user at every instant, instants first; orbits are rows of seven elements.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "one for each array of the Python function")]
fn araim_predict<'py>(
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
    numbers: Vec<f64>,
    exclusion: bool,
) -> PyResult<Bound<'py, PyDict>> {
    let orbits: Vec<Elements> = elements.as_slice()?.as_chunks().0.iter().map(orbit).collect();
    let users = users(lat_rad.as_slice()?, lon_rad.as_slice()?, h_m.as_slice()?)?;
    let (rule, systems, promise) = (rule(&numbers)?, systems(&constellation)?, promise(&support, airborne)?);
    let mask = Radians::new(mask_rad);
    let outlook = Outlook { orbits: &orbits, constellation: &systems, time_s: time_s.as_slice()?, users: &users, mask, promise };
    let rows = py.detach(|| araim::predict(&outlook, &rule, exclusion)).map_err(refused)?;
    columns(py, &rows)
}

/// Detection and exclusion at many epochs: columns of the levels, and the decision, its largest ratio, the step and the excluded columns.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "one for each array of the Python function")]
fn araim_monitor<'py>(
    py: Python<'py>,
    unit_enu: PyReadonlyArray1<'_, f64>,
    residual_m: PyReadonlyArray1<'_, f64>,
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
    let residual_m = residual_m.as_slice()?;
    let tested = py.detach(|| araim::monitored(&sights, residual_m, &service)).map_err(refused)?;
    let mut excluded = vec![false; sights.sigma_int_m.len()];
    for (row, test) in tested.iter().enumerate() {
        for column in &test.excluded {
            excluded[row * systems.len() + column] = true;
        }
    }
    let monitored: Vec<_> = tested.iter().map(|t| (t.outcome, t.monitored)).collect();
    let d = decisions(py, &monitored)?;
    d.set_item("excluded", excluded.into_pyarray(py))?;
    Ok(d)
}

/// Positions that a monitor tests afterwards: nothing is excluded.
pub(crate) fn unmonitored(
    navigation: &Navigation,
    (systems, dual): (&str, bool),
    mask_rad: f64,
    smoothing_s: Option<f64>,
    keep_ranges: bool,
) -> Job {
    let settings = Settings {
        mask: Radians::new(mask_rad),
        ionosphere: navigation.records.klobuchar_gps.and_then(Ionosphere::broadcast).unwrap_or(Ionosphere::Climatology),
        errors: RangeError::CALIBRATED,
        false_alarm: Risk::ACCURACY.q(),
        most_excluded: 0,
    };
    Job {
        systems: systems.bytes().filter_map(Constellation::from_letter).collect(),
        signals: if dual { Signals::Dual } else { Signals::Single },
        smoothing: smoothing_s.map(|window| (Form::DivergenceFree, Smoothing::over(window))),
        settings,
        keep_ranges,
    }
}

/// What a monitor says of a file beside its epochs: satellites, smoothing, residuals against the error model (a row an epoch, a column a
/// constellation; NaN where there are not enough).
pub(crate) fn beside<T>(d: &Bound<'_, PyDict>, watch: &Watch<T>, consistency: impl Fn(&T) -> Option<Consistency>) -> PyResult<()> {
    satellites(d, &watch.tally, &watch.signals)?;
    if !watch.heard.is_empty() {
        let heard = heard(d.py(), &watch.heard, |tested| &tested.heard)?;
        let column = |f: fn(&Tested) -> f64| watch.heard.iter().flatten().map(f).collect::<Vec<_>>().into_pyarray(d.py());
        heard.set_item("residual_m", column(|tested| tested.residual_m))?;
        heard.set_item("sigma_m", column(|tested| tested.sigma_m))?;
        d.set_item("heard", heard)?;
    }
    d.set_item("smoothed_share", watch.smoothed_share)?;
    d.set_item("compared", (watch.comparisons.n_compared, watch.comparisons.n_dropped))?;
    let rows: Vec<_> = watch.epochs.iter().map(consistency).collect();
    for (name, of) in [("statistic", (|c| c.statistic) as fn(&Consistency) -> [f64; 5]), ("redundancy", |c| c.redundancy)] {
        let flat: Vec<f64> = rows.iter().flat_map(|c| c.as_ref().map_or([f64::NAN; 5], of)).collect();
        d.set_item(name, flat.into_pyarray(d.py()).reshape([rows.len(), 5])?)?;
    }
    Ok(())
}

/// Detection and exclusion at every epoch of an observation file.
#[pyfunction]
#[pyo3(signature = (observations, navigation, systems, dual, mask_rad, support, airborne, numbers, smoothing_s, keep_ranges))]
#[expect(clippy::too_many_arguments, reason = "one for each argument of the Python function")]
fn araim_watch<'py>(
    py: Python<'py>,
    observations: &Observations,
    navigation: &Navigation,
    systems: &str,
    dual: bool,
    mask_rad: f64,
    support: [[f64; 6]; 5],
    airborne: [f64; 4],
    numbers: [f64; 7],
    smoothing_s: Option<f64>,
    keep_ranges: bool,
) -> PyResult<Bound<'py, PyDict>> {
    let (service, promise) = (service(&numbers)?, promise(&support, airborne)?);
    let job = unmonitored(navigation, (systems, dual), mask_rad, smoothing_s, keep_ranges);
    let watch = py.detach(|| watch(&observations.0, &navigation.records, &job, &promise, &service));
    let watched = &watch.epochs;
    let outcome = |w: &Result<Watched, NoLevels>| match w {
        Ok(w) => (Outcome::of(&w.monitored.levels), Some(w.monitored)),
        Err(e) => (refusal(*e).err().unwrap_or(Outcome::Singular), None),
    };
    let d = decisions(py, &watched.iter().map(outcome).collect::<Vec<_>>())?;
    let number = |f: fn(&Watched) -> f64| watched.iter().map(|w| w.as_ref().map_or(f64::NAN, f)).collect::<Vec<_>>().into_pyarray(py);
    d.set_item("est_lat_rad", number(|w| w.position.point.lat().rad()))?;
    d.set_item("est_lon_rad", number(|w| w.position.point.lon().rad()))?;
    d.set_item("est_h_m", number(|w| w.position.height.m()))?;
    let count = |f: fn(&Watched) -> usize| watched.iter().map(|w| w.as_ref().map_or(0, f) as i64).collect::<Vec<_>>().into_pyarray(py);
    d.set_item("n_sv", count(|w| w.residuals.compared.len()))?;
    d.set_item("n_excluded", count(|w| w.excluded.len()))?;
    let names =
        |w: &Result<Watched, NoLevels>| w.as_ref().map_or_else(|_| Vec::new(), |w| w.excluded.iter().map(ToString::to_string).collect());
    d.set_item("excluded", watched.iter().map(names).collect::<Vec<Vec<String>>>())?;
    let reasons = watch.reasons(reason);
    d.set_item("status", reasons.iter().map(|r| status::of(*r)).collect::<Vec<_>>())?;
    d.set_item("reason_id", reasons.iter().map(|r| status::id(*r)).collect::<Vec<_>>())?;
    d.set_item("refusal", watched.iter().map(|w| w.as_ref().err().map(ToString::to_string).unwrap_or_default()).collect::<Vec<_>>())?;
    beside(&d, &watch, |w| w.as_ref().ok()?.residuals.consistency)?;
    Ok(d)
}

/// A decision as tables say it.
pub(crate) fn word(decision: Decision) -> &'static str {
    match decision {
        Decision::Nothing => "none",
        Decision::Excluded => "excluded",
        Decision::NotExcluded => "not_excluded",
    }
}

/// Columns of levels and decisions.
fn decisions<'py>(py: Python<'py>, rows: &[(Outcome, Option<Monitored>)]) -> PyResult<Bound<'py, PyDict>> {
    let levels: Vec<Row> = rows.iter().map(|(outcome, m)| Row { n_sv: 0, outcome: *outcome, levels: m.map(|m| m.levels) }).collect();
    let d = columns(py, &levels)?;
    d.del_item("n_sv")?;
    let number = |f: fn(&Monitored) -> f64| rows.iter().map(|r| r.1.as_ref().map_or(f64::NAN, f)).collect::<Vec<_>>().into_pyarray(py);
    d.set_item("worst_ratio", number(|m| m.worst_ratio))?;
    d.set_item("step_e_m", number(|m| m.step[0].m()))?;
    d.set_item("step_n_m", number(|m| m.step[1].m()))?;
    d.set_item("step_u_m", number(|m| m.step[2].m()))?;
    d.set_item("decision", rows.iter().map(|r| r.1.as_ref().map_or("", |m| word(m.decision))).collect::<Vec<_>>())?;
    Ok(d)
}

/// Levels of many epochs from lines of sight. `numbers` are the rule's.
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
    numbers: Vec<f64>,
    exclusion: bool,
) -> PyResult<Bound<'py, PyDict>> {
    let (rule, systems) = (rule(&numbers)?, systems(&constellation)?);
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
    let rows = py.detach(|| araim::levels(&sights, &rule, exclusion)).map_err(refused)?;
    columns(py, &rows)
}

/// A dictionary of columns; NaN where an epoch has no levels.
fn columns<'py>(py: Python<'py>, rows: &[Row]) -> PyResult<Bound<'py, PyDict>> {
    let number = |f: fn(&Levels) -> f64| rows.iter().map(|r| r.levels.as_ref().map_or(f64::NAN, f)).collect::<Vec<_>>().into_pyarray(py);
    let count = |f: fn(&Levels) -> usize| rows.iter().map(|r| r.levels.as_ref().map_or(0, f) as i64).collect::<Vec<_>>().into_pyarray(py);
    let d = levels(py, rows)?;
    d.set_item("hpl_e_m", number(|l| l.detail.axes[0].m()))?;
    d.set_item("hpl_n_m", number(|l| l.detail.axes[1].m()))?;
    d.set_item("emt_m", number(|l| l.detail.emt.m()))?;
    d.set_item("sigma_acc_e_m", number(|l| l.detail.sigma_accuracy[0].m()))?;
    d.set_item("sigma_acc_n_m", number(|l| l.detail.sigma_accuracy[1].m()))?;
    d.set_item("sigma_acc_u_m", number(|l| l.detail.sigma_accuracy[2].m()))?;
    d.set_item("p_unmonitored", number(|l| l.detail.p_unmonitored))?;
    d.set_item("n_modes", count(|l| l.detail.n_modes))?;
    d.set_item("n_monitored", count(|l| l.detail.n_monitored))?;
    Ok(d)
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(araim_services, m)?)?;
    m.add_function(wrap_pyfunction!(araim_support, m)?)?;
    m.add_function(wrap_pyfunction!(araim_error_models, m)?)?;
    m.add_function(wrap_pyfunction!(raim_requirement, m)?)?;
    m.add_function(wrap_pyfunction!(araim_levels, m)?)?;
    m.add_function(wrap_pyfunction!(araim_predict, m)?)?;
    m.add_function(wrap_pyfunction!(araim_monitor, m)?)?;
    m.add_function(wrap_pyfunction!(araim_watch, m)?)
}
