//! Total system error.

use crate::batch::{at_risks, numbers, rejected, table};
use crate::error::input_error;
use nalgebra::{Matrix3, Vector3};
use navbound_core::bound::tse::{self, Component, Deviation, Horizontal, PathDeviations, RandomFte, RotatedFrame};
use navbound_core::frame::{Covariance, Displacement, Enu};
use navbound_core::quantity::{Metres, OutOfDomain, Radians, Risk};
use navbound_core::special::chi::chi_factor;
use navbound_core::special::{self, PreparedQuantile};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArray3};
use pyo3::prelude::*;

type Numbers<'py> = PyReadonlyArray1<'py, f64>;
type Vectors<'py> = PyReadonlyArray2<'py, f64>;
type Matrices<'py> = PyReadonlyArray3<'py, f64>;
type Column<'py> = PyResult<Bound<'py, PyArray1<f64>>>;
type Table<'py> = PyResult<Bound<'py, PyArray2<f64>>>;

fn m(value: f64) -> Metres {
    Metres::new(value)
}

/// A horizontal or spatial offset: the last `width` numbers of an item.
fn offset(values: &[f64], width: usize, i: usize) -> Displacement<Enu> {
    let p = &values[width * i..width * (i + 1)];
    Displacement::from_vector(Vector3::new(p[0], p[1], if width == 3 { p[2] } else { 0.0 }))
}

fn covariance_en(values: &[f64], i: usize) -> Result<Covariance<Enu>, OutOfDomain> {
    let c = &values[4 * i..4 * (i + 1)];
    Covariance::new(Matrix3::new(c[0], c[1], 0.0, c[2], c[3], 0.0, 0.0, 0.0, 0.0)).map_err(|e| named(e, "covariance_en_m2"))
}

fn covariance_enu(values: &[f64], i: usize) -> Result<Covariance<Enu>, OutOfDomain> {
    Covariance::new(Matrix3::from_row_slice(&values[9 * i..9 * (i + 1)])).map_err(|e| named(e, "covariance_enu_m2"))
}

/// The core calls every covariance that; here it has the argument's name.
fn named(e: OutOfDomain, argument: &'static str) -> OutOfDomain {
    if e.argument == "covariance" { OutOfDomain { argument, ..e } } else { e }
}

#[pyfunction]
fn tse_factors<'py>(py: Python<'py>, risk: Numbers<'py>) -> Table<'py> {
    let q = risk.as_slice()?;
    table(py, q.len(), |i| {
        let risk = Risk::new(q[i])?.q();
        let chi = |dimension| chi_factor(dimension, risk);
        Ok([chi(1)?, special::one_sided_factor(risk), chi(2)?, chi(3)?])
    })
}

#[pyfunction]
fn tse_project<'py>(py: Python<'py>, offset_en: Vectors<'py>, covariance: Matrices<'py>, course: Numbers<'py>) -> Table<'py> {
    let (p, c, chi) = (offset_en.as_slice()?, covariance.as_slice()?, course.as_slice()?);
    table(py, chi.len(), |i| {
        let lateral =
            tse::project(&offset(p, 2, i), &covariance_en(c, i)?, Radians::new(chi[i])).map_err(|e| named(e, "covariance_en_m2"))?;
        Ok([lateral.deviation.fte().m(), lateral.along.m(), lateral.deviation.sigma().m()])
    })
}

/// Unit vectors along a course and to its right, east and north.
#[pyfunction]
fn tse_course_axes<'py>(py: Python<'py>, course: Numbers<'py>) -> Table<'py> {
    let chi = course.as_slice()?;
    table(py, chi.len(), |i| {
        let (t, n) = tse::axes(Radians::new(chi[i]))?;
        Ok([t.x, t.y, n.x, n.y])
    })
}

#[pyfunction]
fn tse_exact<'py>(py: Python<'py>, fte: Numbers<'py>, sigma: Numbers<'py>, risk: Numbers<'py>) -> Column<'py> {
    let (f, s, q) = (fte.as_slice()?, sigma.as_slice()?, risk.as_slice()?);
    at_risks(py, q.len(), |i, factors| Ok(tse::exact_at(Deviation::new(m(f[i]), m(s[i]))?, &factors.of(q[i])?).m()))
}

#[pyfunction]
fn tse_ltem<'py>(py: Python<'py>, fte: Numbers<'py>, sigma: Numbers<'py>, risk: Numbers<'py>) -> Column<'py> {
    let (f, s, q) = (fte.as_slice()?, sigma.as_slice()?, risk.as_slice()?);
    at_risks(py, q.len(), |i, factors| Ok(tse::ltem_at(Deviation::new(m(f[i]), m(s[i]))?, &factors.of(q[i])?).m()))
}

#[pyfunction]
fn tse_ltem_at<'py>(py: Python<'py>, fte: Numbers<'py>, sigma: Numbers<'py>, risk: f64) -> Column<'py> {
    let (f, s) = (fte.as_slice()?, sigma.as_slice()?);
    let risk = Risk::new(risk).map_err(|e| input_error(e, None))?;
    Ok(py.detach(|| navbound_assess::tse::ltem(risk, f, s)).map_err(rejected)?.into_pyarray(py))
}

/// Exact bounds at one risk, from a table.
#[pyclass(frozen, module = "navbound._core")]
struct TsePrepared {
    quantile: PreparedQuantile,
}

#[pymethods]
impl TsePrepared {
    #[new]
    fn new(risk: f64) -> PyResult<Self> {
        let risk = Risk::new(risk).map_err(|e| input_error(e, None))?;
        Ok(Self { quantile: PreparedQuantile::new(risk) })
    }
    fn exact<'py>(&self, py: Python<'py>, fte: Numbers<'py>, sigma: Numbers<'py>) -> Column<'py> {
        let (f, s) = (fte.as_slice()?, sigma.as_slice()?);
        Ok(py.detach(|| navbound_assess::tse::exact(&self.quantile, f, s)).map_err(rejected)?.into_pyarray(py))
    }
}

#[pyfunction]
fn tse_sqsm<'py>(py: Python<'py>, fte: Numbers<'py>, covariance: Matrices<'py>, risk: Numbers<'py>) -> Column<'py> {
    let (f, c, q) = (fte.as_slice()?, covariance.as_slice()?, risk.as_slice()?);
    at_risks(py, q.len(), |i, factors| {
        let ellipse = Horizontal::new(&covariance_en(c, i)?).map_err(|e| named(e, "covariance_en_m2"))?;
        Ok(tse::sqsm_at(m(f[i]), &ellipse, &factors.of(q[i])?)?.m())
    })
}

#[pyfunction]
fn tse_ctem<'py>(py: Python<'py>, offset_en: Vectors<'py>, covariance: Matrices<'py>, risk: Numbers<'py>) -> Column<'py> {
    let (p, c, q) = (offset_en.as_slice()?, covariance.as_slice()?, risk.as_slice()?);
    at_risks(py, q.len(), |i, factors| {
        let ellipse = Horizontal::new(&covariance_en(c, i)?).map_err(|e| named(e, "covariance_en_m2"))?;
        Ok(tse::ctem_at(&offset(p, 2, i), &ellipse, &factors.of(q[i])?)?.m())
    })
}

#[pyfunction]
fn tse_ctem_foot<'py>(
    py: Python<'py>,
    fte: Numbers<'py>,
    course: Numbers<'py>,
    covariance: Matrices<'py>,
    risk: Numbers<'py>,
) -> Column<'py> {
    let (f, chi, c, q) = (fte.as_slice()?, course.as_slice()?, covariance.as_slice()?, risk.as_slice()?);
    at_risks(py, q.len(), |i, factors| {
        let ellipse = Horizontal::new(&covariance_en(c, i)?).map_err(|e| named(e, "covariance_en_m2"))?;
        Ok(tse::ctem_foot_at(m(f[i]), Radians::new(chi[i]), &ellipse, &factors.of(q[i])?)?.m())
    })
}

/// Largest and smallest deviation of the horizontal ellipse.
#[pyfunction]
fn tse_axes<'py>(py: Python<'py>, covariance: Matrices<'py>) -> Table<'py> {
    let c = covariance.as_slice()?;
    table(py, c.len() / 4, |i| {
        let ellipse = Horizontal::new(&covariance_en(c, i)?).map_err(|e| named(e, "covariance_en_m2"))?;
        Ok([ellipse.major().m(), ellipse.minor().m()])
    })
}

/// fte, sigma, exact, LTEM, SQSM, CTEM in the rotated frame.
#[pyfunction]
fn tse_rotated<'py>(py: Python<'py>, k: Numbers<'py>, centre: Vectors<'py>, sigmas: Vectors<'py>, risk: Numbers<'py>) -> Table<'py> {
    let (k, p, s, q) = (k.as_slice()?, centre.as_slice()?, sigmas.as_slice()?, risk.as_slice()?);
    table(py, q.len(), |i| {
        let frame = RotatedFrame::new(k[i], m(p[2 * i]), m(p[2 * i + 1]), m(s[2 * i]), m(s[2 * i + 1]))?;
        let (deviation, risk) = (frame.deviation(), Risk::new(q[i])?);
        let exact = tse::exact(deviation, risk);
        Ok([deviation.fte(), deviation.sigma(), exact, tse::ltem(deviation, risk), frame.sqsm(risk), frame.ctem(risk)].map(Metres::m))
    })
}

#[pyfunction]
fn tse_ltem_as_printed<'py>(py: Python<'py>, offset_en: Vectors<'py>, covariance: Matrices<'py>, risk: Numbers<'py>) -> Column<'py> {
    let (p, c, q) = (offset_en.as_slice()?, covariance.as_slice()?, risk.as_slice()?);
    numbers(py, q.len(), |i| {
        let ellipse = Horizontal::new(&covariance_en(c, i)?).map_err(|e| named(e, "covariance_en_m2"))?;
        Ok(tse::ltem_as_printed(&offset(p, 2, i), &ellipse, Risk::new(q[i])?)?.m())
    })
}

/// Risk beyond a limit and its logarithm.
#[pyfunction]
fn tse_exceedance<'py>(py: Python<'py>, fte: Numbers<'py>, sigma: Numbers<'py>, limit: Numbers<'py>) -> Table<'py> {
    let (f, s, l) = (fte.as_slice()?, sigma.as_slice()?, limit.as_slice()?);
    table(py, l.len(), |i| {
        let deviation = Deviation::new(m(f[i]), m(s[i]))?;
        Ok([tse::exceedance_risk(deviation, m(l[i]))?, tse::ln_exceedance_risk(deviation, m(l[i]))?])
    })
}

#[pyfunction]
fn tse_gradient<'py>(py: Python<'py>, fte: Numbers<'py>, sigma: Numbers<'py>, risk: Numbers<'py>) -> Table<'py> {
    let (f, s, q) = (fte.as_slice()?, sigma.as_slice()?, risk.as_slice()?);
    table(py, q.len(), |i| {
        let g = tse::gradient(Deviation::new(m(f[i]), m(s[i]))?, Risk::new(q[i])?);
        Ok([g.by_fte, g.by_sigma])
    })
}

#[pyfunction]
fn tse_fte_budget<'py>(py: Python<'py>, limit: Numbers<'py>, sigma: Numbers<'py>, risk: Numbers<'py>) -> Column<'py> {
    let (l, s, q) = (limit.as_slice()?, sigma.as_slice()?, risk.as_slice()?);
    numbers(py, q.len(), |i| Ok(tse::fte_budget(m(l[i]), m(s[i]), Risk::new(q[i])?)?.map_or(f64::NAN, Metres::m)))
}

#[pyfunction]
fn tse_sigma_budget<'py>(py: Python<'py>, limit: Numbers<'py>, fte: Numbers<'py>, risk: Numbers<'py>) -> Column<'py> {
    let (l, f, q) = (limit.as_slice()?, fte.as_slice()?, risk.as_slice()?);
    numbers(py, q.len(), |i| Ok(tse::sigma_budget(m(l[i]), m(f[i]), Risk::new(q[i])?)?.map_or(f64::NAN, Metres::m)))
}

fn random_fte(parts: &[f64], i: usize) -> RandomFte {
    let p = &parts[5 * i..5 * (i + 1)];
    RandomFte { mean_fte: m(p[0]), sigma_fte: m(p[1]), sigma_nse: m(p[2]), sigma_pde: m(p[3]), correlation: p[4] }
}

/// Total sigma and exact bound; a row of `parts` is mean and sigma of the fte, sigma of nse and pde, correlation.
#[pyfunction]
fn tse_random_fte<'py>(py: Python<'py>, parts: Vectors<'py>, risk: Numbers<'py>) -> Table<'py> {
    let (p, q) = (parts.as_slice()?, risk.as_slice()?);
    table(py, q.len(), |i| {
        let total =
            random_fte(p, i).total().map_err(|e| if e.argument == "fte_m" { OutOfDomain { argument: "mean_fte_m", ..e } } else { e })?;
        Ok([total.sigma().m(), tse::exact(total, Risk::new(q[i])?).m()])
    })
}

/// A row of `parts` as in [`tse_random_fte`].
#[pyfunction]
fn tse_rssm<'py>(py: Python<'py>, parts: Vectors<'py>, risk: Numbers<'py>) -> Column<'py> {
    let (p, q) = (parts.as_slice()?, risk.as_slice()?);
    numbers(py, q.len(), |i| Ok(tse::rssm(&random_fte(p, i), Risk::new(q[i])?)?.m()))
}

#[pyfunction]
fn tse_student_t<'py>(py: Python<'py>, fte: Numbers<'py>, scale: Numbers<'py>, nu: Numbers<'py>, risk: Numbers<'py>) -> Column<'py> {
    let (f, s, nu, q) = (fte.as_slice()?, scale.as_slice()?, nu.as_slice()?, risk.as_slice()?);
    numbers(py, q.len(), |i| {
        let law = Deviation::new(m(f[i]), m(s[i]))
            .map_err(|e| if e.argument == "sigma_m" { OutOfDomain { argument: "scale_m", ..e } } else { e })?;
        Ok(tse::student_t(law, nu[i], Risk::new(q[i])?)?.m())
    })
}

/// Each of `weight`, `fte`, `sigma` has a row an item and a column a component.
#[pyfunction]
fn tse_mixture<'py>(py: Python<'py>, weight: Vectors<'py>, fte: Vectors<'py>, sigma: Vectors<'py>, risk: Numbers<'py>) -> Column<'py> {
    let (w, f, s, q) = (weight.as_slice()?, fte.as_slice()?, sigma.as_slice()?, risk.as_slice()?);
    let count = w.len().checked_div(q.len()).unwrap_or(0);
    numbers(py, q.len(), |i| {
        let items = i * count..(i + 1) * count;
        let components: Result<Vec<_>, _> =
            items.map(|j| Ok(Component { weight: w[j], deviation: Deviation::new(m(f[j]), m(s[j]))? })).collect();
        Ok(tse::mixture(&components?, Risk::new(q[i])?)?.m())
    })
}

#[pyfunction]
fn tse_paired_overbound<'py>(
    py: Python<'py>,
    fte: Numbers<'py>,
    sigma: Numbers<'py>,
    bias: Numbers<'py>,
    risk: Numbers<'py>,
) -> Column<'py> {
    let (f, s, b, q) = (fte.as_slice()?, sigma.as_slice()?, bias.as_slice()?, risk.as_slice()?);
    numbers(py, q.len(), |i| Ok(tse::paired_overbound(Deviation::new(m(f[i]), m(s[i]))?, m(b[i]), Risk::new(q[i])?)?.m()))
}

#[pyfunction]
fn tse_rf_fte<'py>(
    py: Python<'py>,
    fte: Numbers<'py>,
    along: Numbers<'py>,
    sigma_along: Numbers<'py>,
    radius: Numbers<'py>,
) -> Column<'py> {
    let (f, a, s, r) = (fte.as_slice()?, along.as_slice()?, sigma_along.as_slice()?, radius.as_slice()?);
    numbers(py, r.len(), |i| {
        let bias = tse::rf_fte(m(f[i]), m(a[i]), m(s[i]), m(r[i]));
        Ok(bias.map_err(|e| if e.argument == "sigma_m" { OutOfDomain { argument: "sigma_along_m", ..e } } else { e })?.m())
    })
}

/// fte, sigma, fte_v, sigma_v, correlation, lateral and vertical bound.
#[pyfunction]
fn tse_vertical<'py>(
    py: Python<'py>,
    offset_enu: Vectors<'py>,
    covariance: Matrices<'py>,
    course: Numbers<'py>,
    path_angle: Numbers<'py>,
    risk: Numbers<'py>,
) -> Table<'py> {
    let (p, c, chi) = (offset_enu.as_slice()?, covariance.as_slice()?, course.as_slice()?);
    let (gamma, q) = (path_angle.as_slice()?, risk.as_slice()?);
    table(py, q.len(), |i| {
        let covariance = covariance_enu(c, i)?;
        let d = tse::deviations(&offset(p, 3, i), &covariance, Radians::new(chi[i]), Radians::new(gamma[i]))
            .map_err(|e| named(e, "covariance_enu_m2"))?;
        let risk = Risk::new(q[i])?;
        let bounds = [tse::exact(d.lateral, risk).m(), tse::exact(d.vertical, risk).m()];
        let [lateral, vertical] = [d.lateral, d.vertical].map(|x| [x.fte().m(), x.sigma().m()]);
        Ok([lateral[0], lateral[1], vertical[0], vertical[1], d.correlation, bounds[0], bounds[1]])
    })
}

/// A row of `errors`: fte, sigma, fte_v, sigma_v, correlation.
fn path_deviations(errors: &[f64], i: usize) -> Result<PathDeviations, OutOfDomain> {
    let e = &errors[5 * i..5 * (i + 1)];
    let vertical = Deviation::new(m(e[2]), m(e[3]))
        .map_err(|e| OutOfDomain { argument: if e.argument == "fte_m" { "fte_v_m" } else { "sigma_v_m" }, ..e })?;
    Ok(PathDeviations { lateral: Deviation::new(m(e[0]), m(e[1]))?, vertical, correlation: e[4] })
}

fn box_row(b: tse::Box) -> [f64; 5] {
    [b.limit.m(), b.limit_v.m(), b.risk, b.risk_lateral, b.risk_vertical]
}

#[pyfunction]
fn tse_box_risk<'py>(py: Python<'py>, errors: Vectors<'py>, limits: Vectors<'py>) -> Table<'py> {
    let (e, l) = (errors.as_slice()?, limits.as_slice()?);
    table(py, l.len() / 2, |i| Ok(box_row(tse::box_risk(&path_deviations(e, i)?, m(l[2 * i]), m(l[2 * i + 1]))?)))
}

#[pyfunction]
fn tse_box<'py>(py: Python<'py>, errors: Vectors<'py>, risk: Numbers<'py>, share: Numbers<'py>) -> Table<'py> {
    let (e, q, share) = (errors.as_slice()?, risk.as_slice()?, share.as_slice()?);
    table(py, q.len(), |i| Ok(box_row(tse::box_limits(&path_deviations(e, i)?, Risk::new(q[i])?, share[i])?)))
}

pub fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<TsePrepared>()?;
    for function in [
        wrap_pyfunction!(tse_factors, module)?,
        wrap_pyfunction!(tse_project, module)?,
        wrap_pyfunction!(tse_course_axes, module)?,
        wrap_pyfunction!(tse_exact, module)?,
        wrap_pyfunction!(tse_ltem, module)?,
        wrap_pyfunction!(tse_ltem_at, module)?,
        wrap_pyfunction!(tse_sqsm, module)?,
        wrap_pyfunction!(tse_ctem, module)?,
        wrap_pyfunction!(tse_ctem_foot, module)?,
        wrap_pyfunction!(tse_axes, module)?,
        wrap_pyfunction!(tse_rotated, module)?,
        wrap_pyfunction!(tse_ltem_as_printed, module)?,
        wrap_pyfunction!(tse_exceedance, module)?,
        wrap_pyfunction!(tse_gradient, module)?,
        wrap_pyfunction!(tse_fte_budget, module)?,
        wrap_pyfunction!(tse_sigma_budget, module)?,
        wrap_pyfunction!(tse_random_fte, module)?,
        wrap_pyfunction!(tse_rssm, module)?,
        wrap_pyfunction!(tse_student_t, module)?,
        wrap_pyfunction!(tse_mixture, module)?,
        wrap_pyfunction!(tse_paired_overbound, module)?,
        wrap_pyfunction!(tse_rf_fte, module)?,
        wrap_pyfunction!(tse_vertical, module)?,
        wrap_pyfunction!(tse_box_risk, module)?,
        wrap_pyfunction!(tse_box, module)?,
    ] {
        module.add_function(function)?;
    }
    Ok(())
}
