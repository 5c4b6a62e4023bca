//! Performance indicators: a campaign under way, its percentiles, its Stanford diagrams.

use crate::error::input_error;
use crate::fields::fields;
use navbound_assess::evaluation::INTERVAL_RISK;
use navbound_assess::kpi::{
    Axis, Bucket, Campaign, Cause, Columns, Continuity, Demand, Event, Grid, Histogram, LevelTally, Moments, Refused, Regions, Selector,
    Settings, State, Totals, poisson_limits, wilson_limits,
};
use navbound_core::quantity::Metres;
use navbound_core::spec::SERVICE_LEVELS;
use numpy::PyReadonlyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

fn refused((index, e): Refused) -> PyErr {
    input_error(e, index)
}

/// The table of levels.
#[pyfunction]
fn service_levels(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    let row = |level: &navbound_core::spec::ServiceLevel| {
        let d = PyDict::new(py);
        fields!(d, level: id, title);
        d.set_item("hal_m", level.hal.m())?;
        d.set_item("val_m", level.val.map(Metres::m))?;
        d.set_item("accuracy_h_m", level.accuracy_h.m())?;
        d.set_item("accuracy_v_m", level.accuracy_v.map(Metres::m))?;
        d.set_item("tta_s", level.time_to_alert_s)?;
        d.set_item("integrity_risk", level.integrity.0.q())?;
        d.set_item("integrity_per", level.integrity.1.words())?;
        d.set_item("continuity_risk", level.continuity.0.q())?;
        d.set_item("continuity_per", level.continuity.1.words())?;
        d.set_item("limits_source", level.limits_source)?;
        d.set_item("limits", level.limits.word())?;
        d.set_item("rest_source", level.rest_source)?;
        d.set_item("rest", level.rest.word())?;
        Ok(d)
    };
    SERVICE_LEVELS.iter().map(row).collect()
}

/// Columns as they come from Python.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct Table<'py> {
    time_ns: PyReadonlyArray1<'py, i64>,
    nse_e_m: PyReadonlyArray1<'py, f64>,
    nse_n_m: PyReadonlyArray1<'py, f64>,
    nse_u_m: PyReadonlyArray1<'py, f64>,
    hpl_m: PyReadonlyArray1<'py, f64>,
    vpl_m: PyReadonlyArray1<'py, f64>,
    n_sv: PyReadonlyArray1<'py, i32>,
    mode: PyReadonlyArray1<'py, u32>,
    reason: PyReadonlyArray1<'py, u32>,
}

impl Table<'_> {
    fn columns(&self) -> PyResult<Columns<'_>> {
        Ok(Columns {
            time_ns: self.time_ns.as_slice()?,
            nse_m: [self.nse_e_m.as_slice()?, self.nse_n_m.as_slice()?, self.nse_u_m.as_slice()?],
            hpl_m: self.hpl_m.as_slice()?,
            vpl_m: self.vpl_m.as_slice()?,
            n_sv: self.n_sv.as_slice()?,
            mode: self.mode.as_slice()?,
            reason: self.reason.as_slice()?,
        })
    }
}

/// Settings as they come from Python.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct Options {
    origin_ns: i64,
    period_ns: i64,
    demands: Vec<(f64, Option<f64>, f64)>,
    window: u64,
    bin_m: f64,
    n_bins: u32,
    exclude_missing: bool,
}

/// Tables one after the other.
#[pyclass(module = "navbound._core")]
struct KpiCampaign(Campaign);

#[pymethods]
impl KpiCampaign {
    #[new]
    fn new(options: Options) -> PyResult<Self> {
        let demand = |(hal_m, val_m, tta_s)| Demand { hal_m, val_m, tta_s };
        let settings = Settings {
            grid: Grid { origin_ns: options.origin_ns, period_ns: options.period_ns },
            demands: options.demands.into_iter().map(demand).collect(),
            window: options.window,
            bin_m: options.bin_m,
            n_bins: options.n_bins,
            exclude_missing: options.exclude_missing,
        };
        Campaign::new(settings).map(Self).map_err(|e| input_error(e, None))
    }

    /// The next table; the events that are over with it, as columns.
    fn add<'py>(&mut self, py: Python<'py>, table: Table<'py>) -> PyResult<Bound<'py, PyDict>> {
        let columns = table.columns()?;
        let events = py.detach(|| self.0.add(&columns)).map_err(refused)?;
        event_columns(py, &events, &self.0.settings().grid)
    }

    /// A selection of the percentiles of everything added so far.
    fn selector(&self) -> KpiSelector {
        KpiSelector(self.0.selector())
    }

    /// Everything but percentiles, and the events that are left.
    fn outcome<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (tally, settings) = (self.0.tally(), self.0.settings());
        let outcome = self.0.outcome();
        let d = PyDict::new(py);
        d.set_item("events", event_columns(py, &outcome.events, &settings.grid)?)?;
        d.set_item("span_ns", tally.span.map(|(first, last)| (settings.grid.time_ns(first), settings.grid.time_ns(last))))?;
        d.set_item("n_expected", tally.n_expected())?;
        fields!(d, tally: n_missing, n_no_solution, n_solution);
        d.set_item("n_repeated", self.0.n_repeated())?;
        d.set_item("n_mi_epochs", tally.n_mi)?;
        d.set_item("axes", axes(py, &tally.axes, &settings.grid)?)?;
        d.set_item("stanford", tally.stanford.iter().map(|h| histogram(py, h)).collect::<PyResult<Vec<_>>>()?)?;
        let level = |(index, level)| self.level(py, index, level, &outcome.totals[index]);
        d.set_item("levels", tally.levels.iter().enumerate().map(level).collect::<PyResult<Vec<_>>>()?)?;
        d.set_item("series", self.series(py)?)?;
        let days = tally.days.iter().map(|(day, c)| (*day, c.n_expected, c.n_solution, c.n_available.clone()));
        d.set_item("days", days.collect::<Vec<_>>())?;
        Ok(d)
    }
}

impl KpiCampaign {
    fn level<'py>(&self, py: Python<'py>, index: usize, level: &LevelTally, totals: &[Totals; 3]) -> PyResult<Bound<'py, PyDict>> {
        let (tally, window) = (self.0.tally(), self.0.settings().window);
        let share = level.n_available as f64 / tally.n_expected() as f64;
        let n_effective = tally.series.n_effective(index, share);
        let events = level.continuity.events();
        let d = PyDict::new(py);
        d.set_item("n_available", level.n_available)?;
        d.set_item("availability_expected", share)?;
        d.set_item("availability_limits", wilson_limits(share, n_effective, INTERVAL_RISK))?;
        d.set_item("n_effective", n_effective)?;
        d.set_item("n_continuity_events", events)?;
        d.set_item("continuity_event_limits", poisson_limits(events, INTERVAL_RISK))?;
        d.set_item("n_at_risk", level.continuity.at_risk(window))?;
        d.set_item("n_hazard_epochs", level.n_hazard)?;
        d.set_item("n_mi_epochs", level.n_mi)?;
        let grid = &self.0.settings().grid;
        d.set_item("runs", totals.map(|t| (t.n, t.n_over_tta, grid.seconds(t.longest))))?;
        d.set_item("regions", level.regions.iter().map(|r| regions(py, r)).collect::<PyResult<Vec<_>>>()?)?;
        d.set_item("available", axes(py, &level.axes, grid)?)?;
        Ok(d)
    }

    fn series<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (series, grid) = (&self.0.tally().series, &self.0.settings().grid);
        let buckets: Vec<_> = series.buckets().collect();
        let d = PyDict::new(py);
        d.set_item("width_ns", series.width().saturating_mul(grid.period_ns))?;
        d.set_item("start_ns", buckets.iter().map(|(slot, _)| grid.time_ns(*slot)).collect::<Vec<_>>())?;
        d.set_item("n_expected", buckets.iter().map(|(_, b)| b.n_expected).collect::<Vec<_>>())?;
        d.set_item("n_solution", buckets.iter().map(|(_, b)| b.n_solution).collect::<Vec<_>>())?;
        let column = |f: &dyn Fn(&Bucket) -> Option<f64>| buckets.iter().map(|(_, b)| f(b)).collect::<Vec<_>>();
        let most = |place: usize| column(&|b| (b.size[place].n > 0).then_some(b.size[place].max));
        let least = |axis: usize| column(&|b| b.least_m.map(|l| l[axis]).filter(|v| !v.is_nan()));
        d.set_item("hpe_max_m", most(0))?;
        d.set_item("vpe_max_m", most(1))?;
        d.set_item("hpl_min_m", least(0))?;
        d.set_item("hpl_max_m", most(2))?;
        d.set_item("vpl_min_m", least(1))?;
        d.set_item("vpl_max_m", most(3))?;
        let levels = 0..self.0.settings().demands.len();
        let available = |level: usize| buckets.iter().map(|(_, b)| b.n_available[level]).collect::<Vec<_>>();
        d.set_item("n_available", levels.clone().map(available).collect::<Vec<_>>())?;
        let cause = |level: usize| buckets.iter().map(|(_, b)| b.main_cause(level).map_or("", Cause::words)).collect::<Vec<_>>();
        d.set_item("cause", levels.map(cause).collect::<Vec<_>>())?;
        Ok(d)
    }
}

/// Percentiles, pass by pass.
#[pyclass(module = "navbound._core")]
struct KpiSelector(Selector);

#[pymethods]
impl KpiSelector {
    /// Passes over all epochs that are needed.
    #[staticmethod]
    fn passes() -> usize {
        Selector::passes()
    }

    fn scan(&mut self, py: Python<'_>, table: Table<'_>) -> PyResult<()> {
        let columns = table.columns()?;
        py.detach(|| self.0.scan(&columns)).map_err(refused)
    }

    fn narrow(&mut self) -> PyResult<()> {
        self.0.narrow().map_err(|e| input_error(e, None))
    }

    fn values(&self) -> Vec<f64> {
        self.0.values()
    }
}

/// Histogram and regions of one axis.
#[pyfunction]
fn kpi_stanford<'py>(
    py: Python<'py>,
    error_m: PyReadonlyArray1<'py, f64>,
    level_m: PyReadonlyArray1<'py, f64>,
    limit_m: f64,
    bin_m: f64,
    n_bins: u32,
) -> PyResult<Bound<'py, PyDict>> {
    let (mut counts, mut bins) = (Regions::default(), Histogram::default());
    for (error, level) in error_m.as_slice()?.iter().zip(level_m.as_slice()?) {
        counts.add(*error, *level, limit_m);
        bins.add(*error, *level, bin_m, n_bins);
    }
    let d = PyDict::new(py);
    d.set_item("regions", regions(py, &counts)?)?;
    d.set_item("bins", histogram(py, &bins)?)?;
    Ok(d)
}

/// Events and epochs at risk of a pattern.
#[pyfunction]
fn kpi_continuity(available: PyReadonlyArray1<'_, bool>, window: u64) -> PyResult<(u64, u64)> {
    let mut continuity = Continuity::default();
    available.as_slice()?.iter().for_each(|a| continuity.push(*a, 1, window));
    Ok((continuity.events(), continuity.at_risk(window)))
}

pub fn regions<'py>(py: Python<'py>, counts: &Regions) -> PyResult<Bound<'py, PyDict>> {
    let d = PyDict::new(py);
    d.set_item("n", counts.n())?;
    d.set_item("n_nominal", counts.nominal)?;
    d.set_item("n_mi", counts.misleading)?;
    d.set_item("n_hmi", counts.hazardous)?;
    d.set_item("n_unavailable", counts.unavailable)?;
    d.set_item("n_unavailable_mi", counts.unavailable_misleading)?;
    Ok(d)
}

pub fn histogram<'py>(py: Python<'py>, bins: &Histogram) -> PyResult<Bound<'py, PyDict>> {
    let rows = bins.rows();
    let d = PyDict::new(py);
    d.set_item("error_bin", rows.iter().map(|r| r.0).collect::<Vec<_>>())?;
    d.set_item("level_bin", rows.iter().map(|r| r.1).collect::<Vec<_>>())?;
    d.set_item("count", rows.iter().map(|r| r.2).collect::<Vec<_>>())?;
    Ok(d)
}

fn axes<'py>(py: Python<'py>, both: &[Axis; 2], grid: &Grid) -> PyResult<Vec<Bound<'py, PyDict>>> {
    let one = |axis: &Axis| {
        let d = PyDict::new(py);
        d.set_item("error_m", moments(py, &axis.error, grid)?)?;
        d.set_item("level_m", moments(py, &axis.level, grid)?)?;
        d.set_item("safety_index", moments(py, &axis.index, grid)?)?;
        d.set_item("n_potential_mi", axis.n_potential)?;
        d.set_item("n_mi", axis.n_mi)?;
        Ok(d)
    };
    both.iter().map(one).collect()
}

fn moments<'py>(py: Python<'py>, values: &Moments, grid: &Grid) -> PyResult<Option<Bound<'py, PyDict>>> {
    if values.n == 0 {
        return Ok(None);
    }
    let d = PyDict::new(py);
    d.set_item("n", values.n)?;
    d.set_item("mean", values.mean())?;
    d.set_item("rms", values.rms())?;
    d.set_item("max", values.max)?;
    d.set_item("max_time_ns", grid.time_ns(values.max_slot))?;
    Ok(Some(d))
}

fn event_columns<'py>(py: Python<'py>, events: &[Event], grid: &Grid) -> PyResult<Bound<'py, PyDict>> {
    let d = PyDict::new(py);
    d.set_item("level", events.iter().map(|e| e.level).collect::<Vec<_>>())?;
    d.set_item("kind", events.iter().map(|e| e.kind.word()).collect::<Vec<_>>())?;
    d.set_item("onset_ns", events.iter().map(|e| grid.time_ns(e.run.first_slot)).collect::<Vec<_>>())?;
    let clear = |e: &Event| (!e.open).then(|| grid.time_ns(e.run.last_slot.saturating_add(1)));
    d.set_item("clear_ns", events.iter().map(clear).collect::<Vec<_>>())?;
    d.set_item("n_epochs", events.iter().map(|e| e.run.n).collect::<Vec<_>>())?;
    d.set_item("duration_s", events.iter().map(|e| grid.seconds(e.run.n)).collect::<Vec<_>>())?;
    d.set_item("cause", events.iter().map(|e| e.run.cause.map_or("", Cause::words)).collect::<Vec<_>>())?;
    for (place, name) in ["hpe_max_m", "vpe_max_m", "hpl_max_m", "vpl_max_m"].into_iter().enumerate() {
        let peak = |e: &Event| Some(e.run.peak_m[place]).filter(|v| !v.is_nan());
        d.set_item(name, events.iter().map(peak).collect::<Vec<_>>())?;
    }
    states(&d, events, "before", |e| e.run.before)?;
    states(&d, events, "onset", |e| e.run.onset)?;
    Ok(d)
}

fn states(d: &Bound<'_, PyDict>, events: &[Event], name: &str, state: impl Fn(&Event) -> Option<State>) -> PyResult<()> {
    let states: Vec<_> = events.iter().map(state).collect();
    d.set_item(format!("n_sv_{name}"), states.iter().map(|s| s.map(|s| s.n_sv).filter(|n| *n >= 0)).collect::<Vec<_>>())?;
    d.set_item(format!("mode_{name}"), states.iter().map(|s| s.map_or(0, |s| s.mode)).collect::<Vec<_>>())?;
    d.set_item(format!("reason_{name}"), states.iter().map(|s| s.map_or(0, |s| s.reason)).collect::<Vec<_>>())
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_class::<KpiCampaign>()?;
    m.add_class::<KpiSelector>()?;
    m.add_function(wrap_pyfunction!(service_levels, m)?)?;
    m.add_function(wrap_pyfunction!(kpi_continuity, m)?)?;
    m.add_function(wrap_pyfunction!(kpi_stanford, m)?)
}
