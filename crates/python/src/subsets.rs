//! Every subset of an epoch's satellites: the Stanford-ESA diagram.

use crate::error::input_error;
use crate::fields::fields;
use crate::kpi::{histogram, regions};
use navbound_assess::kpi::subsets::{Epoch, Job, Tally, subsets};
use navbound_core::geometry::Direction;
use navbound_core::quantity::{GpsTime, Metres, OutOfDomain, Radians, Unavailable};
use navbound_core::signal::sbas::timeout::Use;
use navbound_core::solution::subsets::RangeInError;
use numpy::{IntoPyArray, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Ranges of all epochs, one after the other; `first` holds the first row of each epoch, and last the number of rows.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct Ranges<'py> {
    time_ns: Vec<i64>,
    first: Vec<usize>,
    az_rad: PyReadonlyArray1<'py, f64>,
    el_rad: PyReadonlyArray1<'py, f64>,
    sigma_m: PyReadonlyArray1<'py, f64>,
    range_error_m: PyReadonlyArray1<'py, f64>,
    shared_m: PyReadonlyArray2<'py, f64>,
}

/// What is required of the subsets, as it comes from Python.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct Options {
    approach: bool,
    least: usize,
    most_satellites: u32,
    limits_m: Vec<(f64, Option<f64>)>,
    bin_m: f64,
    n_bins: u32,
    listed_from: f64,
    most_listed: usize,
}

impl Ranges<'_> {
    fn rows(&self) -> PyResult<Vec<RangeInError>> {
        let (az, el) = (self.az_rad.as_slice()?, self.el_rad.as_slice()?);
        let (sigma, error) = (self.sigma_m.as_slice()?, self.range_error_m.as_slice()?);
        let shared = self.shared_m.as_slice()?.as_chunks::<4>().0;
        if [el.len(), sigma.len(), error.len(), shared.len()].iter().any(|n| *n != az.len()) {
            return Err(PyValueError::new_err("columns of different lengths"));
        }
        (0..az.len()).map(|i| range(i, [az[i], el[i]], sigma[i], error[i], shared[i])).collect()
    }
}

/// Row `i`, its angles azimuth and elevation.
fn range(i: usize, [az, el]: [f64; 2], sigma: f64, error: f64, shared: [f64; 4]) -> PyResult<RangeInError> {
    let wrong = |argument, value, domain| Err(input_error(OutOfDomain { argument, value, unit: "m", domain }, Some(i)));
    let direction = Direction::new(Radians::new(az), Radians::new(el)).map_err(|e| input_error(e, Some(i)))?;
    if !(sigma > 0.0 && sigma.is_finite()) {
        return wrong("sigma_m", sigma, "(0, inf)");
    }
    if !error.is_finite() {
        return wrong("range_error_m", error, "finite errors");
    }
    if let Some(value) = shared.iter().find(|s| !s.is_finite()) {
        return wrong("shared_m", *value, "finite errors");
    }
    Ok(RangeInError { unit: direction.unit(), weight: 1.0 / (sigma * sigma), error: Metres::new(error), shared_m: shared.into() })
}

/// Tables of ranges one after the other.
#[pyclass(module = "navbound._core")]
struct KpiSubsets {
    job: Job,
    tally: Tally,
}

#[pymethods]
impl KpiSubsets {
    #[new]
    fn new(settings: Options) -> Self {
        let job = Job {
            used_for: if settings.approach { Use::PrecisionApproach } else { Use::EnRoute },
            least: settings.least,
            most_satellites: settings.most_satellites,
            limits_m: settings.limits_m,
            bin_m: settings.bin_m,
            n_bins: settings.n_bins,
            listed_from: settings.listed_from,
            most_listed: settings.most_listed,
        };
        Self { tally: Tally::none(&job), job }
    }

    /// The next table.
    fn add(&mut self, py: Python<'_>, ranges: Ranges<'_>) -> PyResult<()> {
        let rows = ranges.rows()?;
        let spans = ranges.first.windows(2).map(|w| rows.get(w[0]..w[1]));
        let times = ranges.time_ns.iter().map(|t| GpsTime::from_nanoseconds(*t));
        let epochs: Option<Vec<Epoch<'_>>> = times.zip(spans).map(|(time, span)| Some((time, span?))).collect();
        let epochs = epochs.ok_or_else(|| PyValueError::new_err("epochs beyond the rows"))?;
        let tally = py.detach(|| subsets(&epochs, &self.job)).map_err(refused)?;
        self.tally = core::mem::take(&mut self.tally).merged(tally, &self.job);
        Ok(())
    }

    /// Counts, histograms and the gravest subsets.
    fn outcome<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        columns(py, &self.tally)
    }
}

fn refused((epoch, why): (usize, Unavailable)) -> PyErr {
    match why {
        Unavailable::Invalid { field, value, unit, domain } => {
            input_error(OutOfDomain { argument: field, value, unit, domain }, Some(epoch))
        }
        other => PyValueError::new_err(other.to_string()),
    }
}

fn columns<'py>(py: Python<'py>, tally: &Tally) -> PyResult<Bound<'py, PyDict>> {
    let d = PyDict::new(py);
    fields!(d, tally: n_epochs, n_unsolved, n_cut, n_subsets, n_singular);
    d.set_item("n_mi", tally.n_misleading)?;
    fields!(d, tally: largest_index, n_listed);
    d.set_item("bins", tally.histograms.iter().map(|h| histogram(py, h)).collect::<PyResult<Vec<_>>>()?)?;
    let both = |r: &[navbound_assess::kpi::Regions; 2]| r.iter().map(|one| regions(py, one)).collect::<PyResult<Vec<_>>>();
    d.set_item("regions", tally.regions.iter().map(both).collect::<PyResult<Vec<_>>>()?)?;
    let listed = PyDict::new(py);
    listed.set_item("time_ns", tally.listed.iter().map(|l| l.time.nanoseconds()).collect::<Vec<_>>().into_pyarray(py))?;
    listed.set_item("used", tally.listed.iter().map(|l| l.used).collect::<Vec<_>>().into_pyarray(py))?;
    for (axis, names) in [["hpe_m", "hpl_m"], ["vpe_m", "vpl_m"]].into_iter().enumerate() {
        listed.set_item(names[0], tally.listed.iter().map(|l| l.error_m[axis]).collect::<Vec<_>>().into_pyarray(py))?;
        listed.set_item(names[1], tally.listed.iter().map(|l| l.level_m[axis]).collect::<Vec<_>>().into_pyarray(py))?;
    }
    d.set_item("listed", listed)?;
    Ok(d)
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_class::<KpiSubsets>()
}
