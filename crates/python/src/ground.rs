//! A landing and the taxi-in.

use crate::fields::fields;
use crate::simulate::{refused, unreadable};
use navbound_simulate::{Driven, GroundFlight, Taxi};
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

type Floats<'py> = Bound<'py, PyArray1<f64>>;

/// A taxi scenario with its route driven: what all its flights share. Tables have a column a satellite.
#[pyclass(frozen, module = "navbound._core")]
struct Ground {
    scenario: Taxi,
    driven: Driven,
}

impl Ground {
    fn flight(&self, (seed, number): (u64, u64)) -> GroundFlight<'_> {
        GroundFlight::new(&self.scenario, seed, number)
    }
}

#[pymethods]
impl Ground {
    /// From a scenario in SI units, as JSON.
    #[new]
    fn new(py: Python<'_>, scenario: &str) -> PyResult<Self> {
        let scenario: Taxi = serde_json::from_str(scenario).map_err(|e| unreadable("scenario", &e))?;
        let driven = py.detach(|| Driven::new(&scenario)).map_err(refused)?;
        Ok(Self { scenario, driven })
    }

    /// The route at whole seconds.
    fn movement<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let driven = &self.driven;
        let d = PyDict::new(py);
        let places = |of: fn(&navbound_path::Place) -> f64| driven.places.iter().map(of).collect::<Vec<_>>().into_pyarray(py);
        d.set_item("along_m", driven.along_m.clone().into_pyarray(py))?;
        d.set_item("speed_mps", driven.speed_mps.clone().into_pyarray(py))?;
        d.set_item("lat_rad", places(|p| p.point.lat().rad()))?;
        d.set_item("lon_rad", places(|p| p.point.lon().rad()))?;
        d.set_item("course_rad", places(|p| p.course.rad()))?;
        d.set_item("leg", driven.places.iter().map(|p| p.leg as u64).collect::<Vec<_>>().into_pyarray(py))?;
        d.set_item("phase", driven.phase.iter().map(|&p| p as u64).collect::<Vec<_>>().into_pyarray(py))?;
        fields!(d, driven: transition_m, per_radian_m);
        Ok(d)
    }

    /// Range error of a fault at seconds since the threshold.
    fn fault<'py>(&self, py: Python<'py>, fault: usize, n: usize) -> Floats<'py> {
        let fault = &self.scenario.faults[fault];
        (0..n).map(|second| fault.error_m(second as f64)).collect::<Vec<_>>().into_pyarray(py)
    }

    /// Flight technical error of unit variance.
    fn steering<'py>(&self, py: Python<'py>, draw: (u64, u64), n: usize) -> Floats<'py> {
        self.flight(draw).steering(n).into_pyarray(py)
    }

    /// Errors of ranges with these deviations, row by row; `faulty` is the column of each fault.
    fn range_errors<'py>(
        &self,
        py: Python<'py>,
        draw: (u64, u64),
        sigma_m: PyReadonlyArray2<'py, f64>,
        lead: usize,
        faulty: Vec<usize>,
    ) -> PyResult<Floats<'py>> {
        let (sigma, width) = (sigma_m.as_slice()?, sigma_m.as_array().ncols());
        Ok(py.detach(|| self.flight(draw).range_errors(sigma, width, lead, &faulty)).into_pyarray(py))
    }

    /// Errors of carrier phase since the fix, and deviations of the rates that they make, row by row.
    fn phase_errors<'py>(
        &self,
        py: Python<'py>,
        draw: (u64, u64),
        sigma_m: PyReadonlyArray2<'py, f64>,
        at_fix: Vec<bool>,
        noise_and_fix: (f64, usize),
        faulty: Vec<usize>,
    ) -> PyResult<(Floats<'py>, Floats<'py>)> {
        let (sigma, (noise_m, fix_s)) = (sigma_m.as_slice()?, noise_and_fix);
        let (errors, rates) = py.detach(|| self.flight(draw).phase_errors(sigma, &at_fix, noise_m, fix_s, &faulty));
        Ok((errors.into_pyarray(py), rates.into_pyarray(py)))
    }

    /// A uniform number a fault, for the monitors on the ground.
    fn monitor(&self, draw: (u64, u64)) -> Vec<f64> {
        self.flight(draw).monitor()
    }

    /// Standard normal numbers of range rates, row by row.
    fn doppler<'py>(&self, py: Python<'py>, draw: (u64, u64), n: usize, width: usize) -> Floats<'py> {
        self.flight(draw).doppler(n, width).into_pyarray(py)
    }

    /// Offset and drift of the receiver's clock at every instant, from the densities of both.
    fn clock<'py>(&self, py: Python<'py>, draw: (u64, u64), n: usize, densities: [f64; 2]) -> (Floats<'py>, Floats<'py>) {
        let (offset, drift): (Vec<f64>, Vec<f64>) = self.flight(draw).clock(n, densities).into_iter().map(|[o, d]| (o, d)).unzip();
        (offset.into_pyarray(py), drift.into_pyarray(py))
    }

    /// How wrong the filter starts, in its standard deviations.
    fn start(&self, draw: (u64, u64)) -> [f64; 9] {
        self.flight(draw).start()
    }
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_class::<Ground>()
}
