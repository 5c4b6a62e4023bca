//! The RNP-state classifier.

use crate::error::input_error;
use navbound_assess::states;
use navbound_core::monitor::state::{self, PerState, StateTable, is_ordered};
use navbound_core::quantity::{Metres, OutOfDomain};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, ToPyArray};
use pyo3::prelude::*;

type Rows<'py> = PyResult<Bound<'py, PyArray2<f64>>>;

fn refused(e: OutOfDomain) -> PyErr {
    input_error(e, None)
}

/// Navigation error left of a total system error after the flight technical error, element by element.
#[pyfunction]
fn nse_boundary<'py>(
    py: Python<'py>,
    tse_m: PyReadonlyArray1<'py, f64>,
    fte_m: PyReadonlyArray1<'py, f64>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let pairs = tse_m.as_slice()?.iter().zip(fte_m.as_slice()?).enumerate();
    let left = pairs
        .map(|(i, (t, f))| state::nse_boundary(Metres::new(*t), Metres::new(*f)).map(Metres::m).map_err(|e| input_error(e, Some(i))))
        .collect::<PyResult<Vec<f64>>>()?;
    Ok(PyArray1::from_vec(py, left))
}

/// Boundaries, means and deviations of the states, and their posteriors.
#[pyclass(frozen, module = "navbound._core")]
pub(crate) struct RnpStates {
    pub(crate) table: StateTable,
    #[pyo3(get)]
    ordered: bool,
}

impl RnpStates {
    fn prior(&self, prior: Option<Vec<f64>>) -> PyResult<PerState> {
        prior.map_or(Ok(self.table.uniform()), |p| self.table.prior(&p).map_err(refused))
    }

    fn rows<'py>(&self, py: Python<'py>, n: usize, formula: impl Fn(usize) -> PerState + Sync + Send) -> Rows<'py> {
        let flat = py.detach(|| states::rows(n, &self.table, formula));
        self.shaped(py, flat)
    }

    fn shaped<'py>(&self, py: Python<'py>, flat: Vec<f64>) -> Rows<'py> {
        let n_states = self.table.n_states();
        let n = flat.len() / n_states;
        PyArray1::from_vec(py, flat).reshape([n, n_states])
    }
}

#[pymethods]
impl RnpStates {
    #[new]
    fn new(boundaries_m: Vec<f64>) -> PyResult<Self> {
        let boundaries: Vec<Metres> = boundaries_m.into_iter().map(Metres::new).collect();
        let table = StateTable::new(&boundaries).map_err(refused)?;
        Ok(Self { table, ordered: is_ordered(&table) })
    }

    #[getter]
    fn boundary_m<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.table.boundary_m().to_pyarray(py)
    }

    #[getter]
    fn mean_m<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.table.mean_m().to_pyarray(py)
    }

    #[getter]
    fn sigma_m<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.table.sigma_m().to_pyarray(py)
    }

    #[getter]
    fn density_at_boundary(&self) -> Vec<f64> {
        (0..self.table.n_levels()).map(|k| self.table.density_at_boundary(k)).collect()
    }

    #[pyo3(signature = (nse_m, prior))]
    fn ln_posterior<'py>(&self, py: Python<'py>, nse_m: PyReadonlyArray1<'py, f64>, prior: Option<Vec<f64>>) -> Rows<'py> {
        let (x, p) = (nse_m.as_slice()?, self.prior(prior)?);
        self.rows(py, x.len(), |i| self.table.ln_posterior(Metres::new(x[i]), &p))
    }

    #[pyo3(signature = (nse_m, prior))]
    fn ln_posterior_as_printed<'py>(&self, py: Python<'py>, nse_m: PyReadonlyArray1<'py, f64>, prior: Option<Vec<f64>>) -> Rows<'py> {
        let (x, p) = (nse_m.as_slice()?, self.prior(prior)?);
        self.rows(py, x.len(), |i| self.table.ln_posterior_as_printed(Metres::new(x[i]), &p))
    }

    #[pyo3(signature = (lateral_m, longitudinal_m, prior))]
    fn joint<'py>(
        &self,
        py: Python<'py>,
        lateral_m: PyReadonlyArray1<'py, f64>,
        longitudinal_m: PyReadonlyArray1<'py, f64>,
        prior: Option<Vec<f64>>,
    ) -> Rows<'py> {
        let (x, y, p) = (lateral_m.as_slice()?, longitudinal_m.as_slice()?, self.prior(prior)?);
        self.rows(py, x.len().min(y.len()), |i| self.table.joint(Metres::new(x[i]), Metres::new(y[i]), &p))
    }

    #[pyo3(signature = (lateral_m, longitudinal_m, prior))]
    fn ln_paper_bivariate<'py>(
        &self,
        py: Python<'py>,
        lateral_m: PyReadonlyArray1<'py, f64>,
        longitudinal_m: PyReadonlyArray1<'py, f64>,
        prior: Option<Vec<f64>>,
    ) -> Rows<'py> {
        let (x, y, p) = (lateral_m.as_slice()?, longitudinal_m.as_slice()?, self.prior(prior)?);
        self.rows(py, x.len().min(y.len()), |i| self.table.ln_paper_bivariate(Metres::new(x[i]), Metres::new(y[i]), &p))
    }

    #[pyo3(signature = (nse_m, stay, prior))]
    fn remembered<'py>(&self, py: Python<'py>, nse_m: PyReadonlyArray1<'py, f64>, stay: f64, prior: Option<Vec<f64>>) -> Rows<'py> {
        let p = self.prior(prior)?;
        let flat = states::remembered(&self.table, nse_m.as_slice()?, stay, &p).map_err(refused)?;
        self.shaped(py, flat)
    }

    fn of_error<'py>(&self, py: Python<'py>, offset_m: PyReadonlyArray1<'py, f64>, sigma_m: PyReadonlyArray1<'py, f64>) -> Rows<'py> {
        let (eta, s) = (offset_m.as_slice()?, sigma_m.as_slice()?);
        let n = eta.len().min(s.len());
        let flat = states::try_rows(n, &self.table, |i| self.table.of_error(Metres::new(eta[i]), Metres::new(s[i])));
        self.shaped(py, flat.map_err(|(i, e)| input_error(e, Some(i)))?)
    }

    fn of_residuals<'py>(
        &self,
        py: Python<'py>,
        sum_of_squares_m2: PyReadonlyArray1<'py, f64>,
        n: PyReadonlyArray1<'py, f64>,
    ) -> Rows<'py> {
        let (s, n) = (sum_of_squares_m2.as_slice()?, n.as_slice()?);
        let flat = states::try_rows(s.len().min(n.len()), &self.table, |i| self.table.of_residuals(s[i], n[i]));
        self.shaped(py, flat.map_err(|(i, e)| input_error(e, Some(i)))?)
    }

    #[pyo3(signature = (nse_m, prior))]
    fn classes<'py>(
        &self,
        py: Python<'py>,
        nse_m: PyReadonlyArray1<'py, f64>,
        prior: Option<Vec<f64>>,
    ) -> PyResult<Bound<'py, PyArray1<i64>>> {
        let (x, p) = (nse_m.as_slice()?, self.prior(prior)?);
        let classes = py.detach(|| states::classes(&self.table, self.ordered, x, &p));
        Ok(PyArray1::from_vec(py, classes))
    }

    fn threshold_classes<'py>(&self, py: Python<'py>, nse_m: PyReadonlyArray1<'py, f64>) -> PyResult<Bound<'py, PyArray1<i64>>> {
        let class = |x: &f64| self.table.threshold_class(Metres::new(*x)) as i64;
        Ok(PyArray1::from_vec(py, nse_m.as_slice()?.iter().map(class).collect()))
    }
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(nse_boundary, m)?)?;
    m.add_class::<RnpStates>()
}
