//! Navigation specifications, monitor, state classifier.

use crate::error::input_error;
use crate::fields::fields;
use navbound_assess::monitor::{self as batch, Columns, Levels};
use navbound_core::bound::{Alerting, IntegrityComparison};
use navbound_core::monitor::exposure::HourlyExposure;
use navbound_core::monitor::rnp::{self, Acceptance, Chain, Counters, Event, Observation, Settings};
use navbound_core::quantity::{GpsTime, Metres, OutOfDomain, Risk};
use navbound_core::spec::{SPECIFICATIONS, Specification};
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

fn refused(e: OutOfDomain) -> PyErr {
    input_error(e, None)
}

/// Every cell of the table of navigation specifications.
#[pyfunction]
fn specifications(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    SPECIFICATIONS
        .iter()
        .map(|s| {
            let tta = s.phase.time_to_alert();
            let d = PyDict::new(py);
            d.set_item("name", s.name)?;
            d.set_item("phase", s.phase.word())?;
            d.set_item("accuracy_least_m", s.accuracy_least.m())?;
            d.set_item("accuracy_most_m", s.accuracy_most.m())?;
            d.set_item("containment_least_m", s.containment(s.accuracy_least).map(Metres::m))?;
            d.set_item("containment_most_m", s.containment(s.accuracy_most).map(Metres::m))?;
            d.set_item("accuracy_risk", Specification::ACCURACY_RISK.q())?;
            d.set_item("containment_risk", s.monitored.then(|| Specification::CONTAINMENT_RISK.q()))?;
            d.set_item("source", s.source)?;
            d.set_item("provenance", s.provenance.word())?;
            d.set_item("time_to_alert_s", tta.seconds)?;
            d.set_item("time_to_alert_source", tta.source)?;
            d.set_item("time_to_alert_provenance", tta.provenance.word())?;
            Ok(d)
        })
        .collect()
}

/// Risk per epoch whose hour carries a risk.
#[pyfunction]
fn per_epoch_risk(risk_per_hour: f64, tau_s: f64, sample_period_s: f64) -> PyResult<f64> {
    let risk = Risk::new(risk_per_hour).map_err(|e| refused(OutOfDomain { argument: "risk_per_hour", ..e }))?;
    let exposure = HourlyExposure::new(tau_s, sample_period_s).map_err(refused)?;
    exposure.per_epoch(risk).map(Risk::q).map_err(refused)
}

/// Risk of an hour whose epochs carry a risk.
#[pyfunction]
fn per_hour_risk(risk_per_epoch: f64, tau_s: f64, sample_period_s: f64) -> PyResult<f64> {
    let risk = Risk::new(risk_per_epoch).map_err(|e| refused(OutOfDomain { argument: "risk_per_epoch", ..e }))?;
    Ok(HourlyExposure::new(tau_s, sample_period_s).map_err(refused)?.per_hour(risk))
}

/// Settings and state of one monitor.
#[pyclass(module = "navbound._core")]
pub(crate) struct RnpMonitor {
    pub(crate) monitor: rnp::Monitor,
    comparison: IntegrityComparison,
}

/// The method with this id, where it may feed an alert; `KeyError` with the id otherwise.
pub(crate) fn alerting(id: &str) -> PyResult<Alerting> {
    Alerting::of(id).map_err(|_| PyKeyError::new_err(id.to_owned()))
}

/// Ids of the methods that may feed an alert.
#[pyfunction]
fn alerting_methods() -> Vec<&'static str> {
    Alerting::all().map(|m| m.method().id).collect()
}

/// kind, onset_ns, annunciation_ns, clear_ns, peak_m, limit_m, min_margin_m.
pub(crate) type EventRow = (&'static str, i64, i64, Option<i64>, f64, f64, f64);

pub(crate) fn event_row(e: &Event) -> EventRow {
    (
        e.kind.word(),
        e.onset.nanoseconds(),
        e.annunciation.nanoseconds(),
        e.clear.map(GpsTime::nanoseconds),
        e.peak.m(),
        e.limit.m(),
        e.min_margin.m(),
    )
}

pub(crate) fn counters_dict<'py>(py: Python<'py>, c: &Counters) -> PyResult<Bound<'py, PyDict>> {
    let d = PyDict::new(py);
    fields!(
        d, c:
        n_accepted, n_duplicate, n_late, n_clock_set_back, n_gaps, n_unusable, n_nan, n_withdrawn, n_cautions, n_warnings, n_unavailable,
        watched_s
    );
    d.set_item("alerts_per_hour", c.alerts_per_hour())?;
    Ok(d)
}

pub(crate) const fn acceptance_word(acceptance: Acceptance) -> &'static str {
    match acceptance {
        Acceptance::Accepted => "accepted",
        Acceptance::Duplicate => "duplicate",
        Acceptance::Late => "late",
        Acceptance::ClockSetBack => "clock_set_back",
    }
}

#[pymethods]
impl RnpMonitor {
    #[new]
    #[pyo3(signature = (chain_s, raise_delay_s, clear_delay_s, clear_ratio, stale_after_s))]
    fn new(chain_s: [f64; 6], raise_delay_s: f64, clear_delay_s: f64, clear_ratio: f64, stale_after_s: Option<f64>) -> PyResult<Self> {
        let [sample_period_s, sensor_latency_s, filter_s, computing_s, display_s, time_to_alert_s] = chain_s;
        let settings = Settings {
            chain: Chain { sample_period_s, sensor_latency_s, filter_s, computing_s, display_s, time_to_alert_s },
            raise_delay_s,
            clear_delay_s,
            clear_ratio,
            stale_after_s: stale_after_s.unwrap_or_else(|| rnp::default_stale_after_s(sample_period_s)),
        };
        let monitor = rnp::Monitor::new(settings).map_err(refused)?;
        Ok(Self { monitor, comparison: IntegrityComparison::default() })
    }

    /// Time from an exceedance to the crew.
    #[getter]
    fn time_to_crew_s(&self) -> f64 {
        let settings = self.monitor.settings();
        settings.chain.total_s(settings.raise_delay_s)
    }

    #[getter]
    fn stale_after_s(&self) -> f64 {
        self.monitor.settings().stale_after_s
    }

    /// Judge one epoch: alert, acceptance, ended events, begun events. Bounds come with the id of the method that made them.
    #[allow(clippy::too_many_arguments, clippy::type_complexity)]
    fn step(
        &mut self,
        time_ns: i64,
        accuracy: (&str, f64),
        integrity: (&str, f64),
        fte_m: f64,
        hpl_m: Option<f64>,
        rnp_m: f64,
        judged: (bool, bool),
    ) -> PyResult<(&'static str, &'static str, Vec<EventRow>, Vec<EventRow>)> {
        let claimed = |(id, bound_m): (&str, f64)| alerting(id).map(|method| method.claim_evaluated(Metres::new(bound_m)));
        let (accuracy, integrity) = (claimed(accuracy)?, claimed(integrity)?);
        // A record with the key says that its source has levels, whatever stands there.
        if hpl_m.is_some() {
            self.comparison.expect_levels();
        }
        let hpl_m = hpl_m.unwrap_or(f64::NAN);
        let step = self.monitor.step(&Observation {
            time: GpsTime::from_nanoseconds(time_ns),
            accuracy,
            integrity: self.comparison.bound(integrity, Metres::new(fte_m), Metres::new(hpl_m), judged.1),
            rnp: Metres::new(rnp_m),
            usable: judged.0,
        });
        let rows = |events: &[Option<Event>]| events.iter().flatten().map(event_row).collect();
        Ok((step.alert.word(), acceptance_word(step.acceptance), rows(&step.ended), rows(&step.began)))
    }

    /// Time passes without an epoch.
    fn tick(&mut self, time_ns: i64) -> &'static str {
        self.monitor.tick(GpsTime::from_nanoseconds(time_ns)).alert.word()
    }

    fn open_events(&self) -> Vec<EventRow> {
        self.monitor.open_events().map(event_row).collect()
    }

    fn counters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        counters_dict(py, self.monitor.counters())
    }

    /// Monitors of these settings, one for each entry, which says whether its track has a protection level anywhere.
    fn tracks(&self, with_levels: Vec<bool>) -> PyResult<RnpMonitors> {
        Ok(RnpMonitors { monitors: batch::Monitors::new(*self.monitor.settings(), &with_levels).map_err(refused)? })
    }
}

/// One monitor per track, which take their rows in pieces of any length.
#[pyclass(module = "navbound._core")]
struct RnpMonitors {
    monitors: batch::Monitors,
}

#[pymethods]
impl RnpMonitors {
    /// Judge the next rows; bounds are ids with columns, the bools of a row are: usable, should have a level.
    #[allow(clippy::too_many_arguments)]
    fn judge<'py>(
        &mut self,
        py: Python<'py>,
        time_ns: PyReadonlyArray1<'py, i64>,
        accuracy: (String, PyReadonlyArray1<'py, f64>),
        integrity: (String, PyReadonlyArray1<'py, f64>),
        fte_m: Option<PyReadonlyArray1<'py, f64>>,
        hpl_m: Option<PyReadonlyArray1<'py, f64>>,
        rnp_m: PyReadonlyArray1<'py, f64>,
        judged: (PyReadonlyArray1<'py, bool>, PyReadonlyArray1<'py, bool>),
        track: PyReadonlyArray1<'py, u32>,
    ) -> PyResult<(Vec<&'static str>, Bound<'py, PyArray1<f64>>)> {
        let fte_m = fte_m.as_ref().map(|a| a.as_slice()).transpose()?;
        let hpl_m = hpl_m.as_ref().map(|a| a.as_slice()).transpose()?;
        let (usable, due) = (judged.0.as_slice()?, judged.1.as_slice()?);
        let columns = Columns {
            time_ns: time_ns.as_slice()?,
            accuracy_m: (alerting(&accuracy.0)?, accuracy.1.as_slice()?),
            integrity_m: (alerting(&integrity.0)?, integrity.1.as_slice()?),
            level_m: hpl_m.map(|hpl_m| Levels { fte_m, hpl_m, due }),
            rnp_m: rnp_m.as_slice()?,
            usable,
            track: track.as_slice()?,
        };
        let piece = py.detach(|| self.monitors.judge(&columns)).map_err(refused)?;
        Ok((piece.alert.iter().map(|a| a.word()).collect(), piece.integrity_compared_m.into_pyarray(py)))
    }

    /// Events with the index of their track, counters of each track, and of all together.
    fn decided<'py>(&self, py: Python<'py>) -> PyResult<Decided<'py>> {
        decided(py, &self.monitors.events(), &self.monitors.counters())
    }
}

pub(crate) fn decided<'py>(py: Python<'py>, events: &[(u32, Event)], counters: &[Counters]) -> PyResult<Decided<'py>> {
    let events = events.iter().map(|(track, event)| (*track, event_row(event))).collect();
    let each = counters.iter().map(|c| counters_dict(py, c)).collect::<PyResult<_>>()?;
    let all = counters.iter().fold(Counters::default(), |sum, c| sum.merged(c));
    Ok((events, each, counters_dict(py, &all)?))
}

pub(crate) type Decided<'py> = (Vec<(u32, EventRow)>, Vec<Bound<'py, PyDict>>, Bound<'py, PyDict>);

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(specifications, m)?)?;
    m.add_function(wrap_pyfunction!(per_epoch_risk, m)?)?;
    m.add_function(wrap_pyfunction!(per_hour_risk, m)?)?;
    m.add_function(wrap_pyfunction!(alerting_methods, m)?)?;
    m.add_class::<RnpMonitor>()?;
    m.add_class::<RnpMonitors>()
}
