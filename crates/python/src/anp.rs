//! Actual navigation performance.

use crate::error::input_error;
use navbound_assess::anp::{Refused, each, laws, radii_m, triangle};
use navbound_core::bound::anp;
use navbound_core::frame::{Covariance, Displacement, Enu};
use navbound_core::quantity::{Metres, OutOfDomain, Risk};
use navbound_core::special::chi;
use numpy::ndarray::{Array2, ArrayBase, Dimension, OwnedRepr};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyReadonlyArray, PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArray3};
use pyo3::prelude::*;

type Numbers<'py> = Bound<'py, PyArray1<f64>>;
type Rows<'py> = Bound<'py, PyArray2<f64>>;

/// Names of covariance and mean, as the Python function calls them.
const HORIZONTAL: [&str; 2] = ["covariance_en_m2", "mean_en_m"];
const SPATIAL: [&str; 2] = ["covariance_enu_m2", "mean_enu_m"];
const TUNNEL: [&str; 2] = ["covariance_cu_m2", "mean_cu_m"];

/// A refusal under the name that the caller used.
fn refused(r: Refused, [covariance, mean]: [&'static str; 2]) -> PyErr {
    let argument = match r.refusal.argument {
        name if name.starts_with("covariance") => covariance,
        name if name.starts_with("mean") => mean,
        other => other,
    };
    input_error(OutOfDomain { argument, ..r.refusal }, Some(r.index))
}

fn flat<'a, D: Dimension>(array: &'a PyReadonlyArray<'_, f64, D>) -> PyResult<&'a [f64]> {
    Ok(array.as_slice()?)
}

fn optional<'a, D: Dimension>(array: Option<&'a PyReadonlyArray<'_, f64, D>>) -> PyResult<Option<&'a [f64]>> {
    array.map(flat).transpose()
}

fn rows<const K: usize>(py: Python<'_>, values: Vec<[f64; K]>) -> Rows<'_> {
    let n = values.len();
    let flat: Vec<f64> = values.into_iter().flatten().collect();
    let table: ArrayBase<OwnedRepr<f64>, _> = Array2::from_shape_vec((n, K), flat).unwrap_or_default();
    table.into_pyarray(py)
}

fn covariance(flat: &[f64], i: usize) -> Result<Covariance<Enu>, OutOfDomain> {
    triangle::<3>(flat, i).map(Covariance::from_upper)
}

fn horizontal(flat: &[f64], i: usize) -> Result<Covariance<Enu>, OutOfDomain> {
    triangle::<2>(flat, i).map(Covariance::from_upper)
}

fn vector(flat: &[f64], i: usize) -> [f64; 3] {
    [flat[3 * i], flat[3 * i + 1], flat[3 * i + 2]]
}

fn displacement(flat: Option<&[f64]>, i: usize) -> Option<Displacement<Enu>> {
    flat.map(|m| Displacement::from_vector(vector(m, i).into()))
}

/// Radii of circles.
#[pyfunction]
fn anp_circle<'py>(
    py: Python<'py>,
    covariance_en_m2: PyReadonlyArray3<'py, f64>,
    mean_en_m: Option<PyReadonlyArray2<'py, f64>>,
    risk: PyReadonlyArray1<'py, f64>,
) -> PyResult<Numbers<'py>> {
    let (v, m, q) = (flat(&covariance_en_m2)?, optional(mean_en_m.as_ref())?, flat(&risk)?);
    let radii = py.detach(|| radii_m::<2>(v, m, q)).map_err(|r| refused(r, HORIZONTAL))?;
    Ok(radii.into_pyarray(py))
}

/// Radii of spheres.
#[pyfunction]
fn anp_sphere<'py>(
    py: Python<'py>,
    covariance_enu_m2: PyReadonlyArray3<'py, f64>,
    mean_enu_m: Option<PyReadonlyArray2<'py, f64>>,
    risk: PyReadonlyArray1<'py, f64>,
) -> PyResult<Numbers<'py>> {
    let (v, m, q) = (flat(&covariance_enu_m2)?, optional(mean_enu_m.as_ref())?, flat(&risk)?);
    let radii = py.detach(|| radii_m::<3>(v, m, q)).map_err(|r| refused(r, SPATIAL))?;
    Ok(radii.into_pyarray(py))
}

/// Columns inside, outside, density of the horizontal error's length.
#[pyfunction]
fn anp_circle_law<'py>(
    py: Python<'py>,
    covariance_en_m2: PyReadonlyArray3<'py, f64>,
    mean_en_m: Option<PyReadonlyArray2<'py, f64>>,
    radius_m: PyReadonlyArray1<'py, f64>,
) -> PyResult<Rows<'py>> {
    let (v, m, r) = (flat(&covariance_en_m2)?, optional(mean_en_m.as_ref())?, flat(&radius_m)?);
    Ok(rows(py, py.detach(|| laws::<2>(v, m, r)).map_err(|r| refused(r, HORIZONTAL))?))
}

/// Columns inside, outside, density of the error's length.
#[pyfunction]
fn anp_sphere_law<'py>(
    py: Python<'py>,
    covariance_enu_m2: PyReadonlyArray3<'py, f64>,
    mean_enu_m: Option<PyReadonlyArray2<'py, f64>>,
    radius_m: PyReadonlyArray1<'py, f64>,
) -> PyResult<Rows<'py>> {
    let (v, m, r) = (flat(&covariance_enu_m2)?, optional(mean_enu_m.as_ref())?, flat(&radius_m)?);
    Ok(rows(py, py.detach(|| laws::<3>(v, m, r)).map_err(|r| refused(r, SPATIAL))?))
}

/// Columns bias, sigma, half width along directions.
#[pyfunction]
fn anp_directional<'py>(
    py: Python<'py>,
    covariance_enu_m2: PyReadonlyArray3<'py, f64>,
    direction: PyReadonlyArray2<'py, f64>,
    mean_enu_m: Option<PyReadonlyArray2<'py, f64>>,
    risk: PyReadonlyArray1<'py, f64>,
) -> PyResult<Rows<'py>> {
    let (v, u, q) = (flat(&covariance_enu_m2)?, flat(&direction)?, flat(&risk)?);
    let m = optional(mean_enu_m.as_ref())?;
    let radii = py.detach(|| {
        each(q.len(), |i| {
            let d = anp::directional(&covariance(v, i)?, &vector(u, i).into(), displacement(m, i).as_ref(), Risk::new(q[i])?)?;
            Ok([d.bias.m(), d.sigma.m(), d.half_width.m()])
        })
    });
    Ok(rows(py, radii.map_err(|r| refused(r, SPATIAL))?))
}

/// Columns support, intercept (NaN where singular) along directions.
#[pyfunction]
fn anp_extents<'py>(
    py: Python<'py>,
    covariance_enu_m2: PyReadonlyArray3<'py, f64>,
    direction: PyReadonlyArray2<'py, f64>,
    risk: PyReadonlyArray1<'py, f64>,
) -> PyResult<Rows<'py>> {
    let (v, u, q) = (flat(&covariance_enu_m2)?, flat(&direction)?, flat(&risk)?);
    let radii = py.detach(|| {
        each(q.len(), |i| {
            let (v, u, q) = (covariance(v, i)?, vector(u, i).into(), Risk::new(q[i])?);
            Ok([anp::support(&v, &u, q)?.m(), anp::intercept(&v, &u, q)?.map_or(f64::NAN, Metres::m)])
        })
    });
    Ok(rows(py, radii.map_err(|r| refused(r, SPATIAL))?))
}

/// Columns factor, 3 semi-axes, 9 axes row by row, 3 supports, 3 intercepts (NaN where singular), volume.
#[pyfunction]
fn anp_ellipsoid<'py>(
    py: Python<'py>,
    covariance_enu_m2: PyReadonlyArray3<'py, f64>,
    risk: PyReadonlyArray1<'py, f64>,
) -> PyResult<Rows<'py>> {
    let (v, q) = (flat(&covariance_enu_m2)?, flat(&risk)?);
    let radii = py.detach(|| {
        each(q.len(), |i| {
            let e = anp::ellipsoid(&covariance(v, i)?, Risk::new(q[i])?)?;
            let mut row = [0.0; 20];
            row[0] = e.factor;
            row[1..4].copy_from_slice(&e.semi_axes);
            row[4..13].copy_from_slice(e.axes.as_flattened());
            row[13..16].copy_from_slice(&e.support);
            row[16..19].copy_from_slice(&e.intercept.unwrap_or([f64::NAN; 3]));
            row[19] = e.volume;
            Ok(row)
        })
    });
    Ok(rows(py, radii.map_err(|r| refused(r, SPATIAL))?))
}

/// Standard deviations along the principal axes, largest first.
#[pyfunction]
fn anp_principal_sigmas<'py>(py: Python<'py>, covariance_enu_m2: PyReadonlyArray3<'py, f64>) -> PyResult<Rows<'py>> {
    let v = flat(&covariance_enu_m2)?;
    let radii = py.detach(|| each(v.len() / 9, |i| anp::principal_sigmas(&covariance(v, i)?).map(|s| s.map(Metres::m))));
    Ok(rows(py, radii.map_err(|r| refused(r, SPATIAL))?))
}

/// Factors of the length of a standard normal vector.
#[pyfunction]
fn chi_factor<'py>(py: Python<'py>, dimension: usize, risk: PyReadonlyArray1<'py, f64>) -> PyResult<Numbers<'py>> {
    let q = flat(&risk)?;
    let radii =
        each(q.len(), |i| Risk::new(q[i]).and_then(|risk| chi::chi_factor(dimension, risk.q()))).map_err(|r| refused(r, SPATIAL))?;
    Ok(radii.into_pyarray(py))
}

/// What the length of a standard normal vector exceeds with a probability, anywhere in (0, 1).
#[pyfunction]
fn chi_quantile<'py>(py: Python<'py>, dimension: usize, risk: PyReadonlyArray1<'py, f64>) -> PyResult<Numbers<'py>> {
    let q = flat(&risk)?;
    let radii = each(q.len(), |i| chi::chi_factor(dimension, q[i])).map_err(|r| refused(r, SPATIAL))?;
    Ok(radii.into_pyarray(py))
}

/// A horizontal closed form.
type HorizontalFit = fn(&Covariance<Enu>, Risk) -> Result<Metres, OutOfDomain>;

fn horizontal_fit<'py>(
    py: Python<'py>,
    fit: HorizontalFit,
    covariance_en_m2: &PyReadonlyArray3<'py, f64>,
    risk: &PyReadonlyArray1<'py, f64>,
) -> PyResult<Numbers<'py>> {
    let (v, q) = (flat(covariance_en_m2)?, flat(risk)?);
    let radii = py.detach(|| each(q.len(), |i| fit(&horizontal(v, i)?, Risk::new(q[i])?).map(Metres::m)));
    Ok(radii.map_err(|r| refused(r, HORIZONTAL))?.into_pyarray(py))
}

/// The published cubic, corrected.
#[pyfunction]
fn anp_circle_fit<'py>(
    py: Python<'py>,
    covariance_en_m2: PyReadonlyArray3<'py, f64>,
    risk: PyReadonlyArray1<'py, f64>,
) -> PyResult<Numbers<'py>> {
    horizontal_fit(py, anp::circle_fit, &covariance_en_m2, &risk)
}

/// Geodesy's cubic.
#[pyfunction]
fn anp_circle_geodesy<'py>(
    py: Python<'py>,
    covariance_en_m2: PyReadonlyArray3<'py, f64>,
    risk: PyReadonlyArray1<'py, f64>,
) -> PyResult<Numbers<'py>> {
    horizontal_fit(py, anp::circle_geodesy, &covariance_en_m2, &risk)
}

/// The published cubic as printed.
#[pyfunction]
fn anp_circle_fit_as_printed<'py>(
    py: Python<'py>,
    covariance_en_m2: PyReadonlyArray3<'py, f64>,
    risk: PyReadonlyArray1<'py, f64>,
) -> PyResult<Numbers<'py>> {
    horizontal_fit(py, anp::circle_fit_as_printed, &covariance_en_m2, &risk)
}

/// Grubbs' sphere, corrected.
#[pyfunction]
fn anp_sphere_grubbs<'py>(
    py: Python<'py>,
    covariance_enu_m2: PyReadonlyArray3<'py, f64>,
    mean_enu_m: Option<PyReadonlyArray2<'py, f64>>,
    risk: PyReadonlyArray1<'py, f64>,
) -> PyResult<Numbers<'py>> {
    let (v, m, q) = (flat(&covariance_enu_m2)?, optional(mean_enu_m.as_ref())?, flat(&risk)?);
    let radii = py
        .detach(|| each(q.len(), |i| anp::sphere_grubbs(&covariance(v, i)?, displacement(m, i).as_ref(), Risk::new(q[i])?).map(Metres::m)));
    Ok(radii.map_err(|r| refused(r, SPATIAL))?.into_pyarray(py))
}

/// Grubbs' sphere as printed.
#[pyfunction]
fn anp_sphere_grubbs_as_printed<'py>(
    py: Python<'py>,
    covariance_enu_m2: PyReadonlyArray3<'py, f64>,
    risk: PyReadonlyArray1<'py, f64>,
) -> PyResult<Numbers<'py>> {
    let (v, q) = (flat(&covariance_enu_m2)?, flat(&risk)?);
    let radii = py.detach(|| each(q.len(), |i| anp::sphere_grubbs_as_printed(&covariance(v, i)?, Risk::new(q[i])?).map(Metres::m)));
    Ok(radii.map_err(|r| refused(r, SPATIAL))?.into_pyarray(py))
}

fn pair(flat: &[f64], i: usize) -> [f64; 2] {
    [flat[2 * i], flat[2 * i + 1]]
}

fn triple(flat: &[f64], i: usize) -> Result<[f64; 3], OutOfDomain> {
    let [cc, cv, vv, ..] = triangle::<2>(flat, i)?;
    Ok([cc, cv, vv])
}

/// Columns inside, outside of rectangles.
#[pyfunction]
fn anp_rectangle<'py>(
    py: Python<'py>,
    covariance_cu_m2: PyReadonlyArray3<'py, f64>,
    mean_cu_m: PyReadonlyArray2<'py, f64>,
    half_cross_m: PyReadonlyArray1<'py, f64>,
    half_up_m: PyReadonlyArray1<'py, f64>,
) -> PyResult<Rows<'py>> {
    let (v, m, a, b) = (flat(&covariance_cu_m2)?, flat(&mean_cu_m)?, flat(&half_cross_m)?, flat(&half_up_m)?);
    let radii = py.detach(|| each(a.len(), |i| anp::rectangle(triple(v, i)?, pair(m, i), [a[i], b[i]]).map(|s| [s.inside, s.outside])));
    Ok(rows(py, radii.map_err(|r| refused(r, TUNNEL))?))
}

/// Stretch of rectangles that meets a risk.
#[pyfunction]
fn anp_rectangle_scale<'py>(
    py: Python<'py>,
    covariance_cu_m2: PyReadonlyArray3<'py, f64>,
    mean_cu_m: PyReadonlyArray2<'py, f64>,
    half_cross_m: PyReadonlyArray1<'py, f64>,
    half_up_m: PyReadonlyArray1<'py, f64>,
    risk: PyReadonlyArray1<'py, f64>,
) -> PyResult<Numbers<'py>> {
    let (v, m, a, b, q) = (flat(&covariance_cu_m2)?, flat(&mean_cu_m)?, flat(&half_cross_m)?, flat(&half_up_m)?, flat(&risk)?);
    let radii = py.detach(|| each(q.len(), |i| anp::rectangle_scale(triple(v, i)?, pair(m, i), [a[i], b[i]], Risk::new(q[i])?)));
    Ok(radii.map_err(|r| refused(r, TUNNEL))?.into_pyarray(py))
}

/// Columns inside, outside of cylinders.
#[pyfunction]
fn anp_cylinder<'py>(
    py: Python<'py>,
    covariance_enu_m2: PyReadonlyArray3<'py, f64>,
    mean_enu_m: PyReadonlyArray2<'py, f64>,
    radius_m: PyReadonlyArray1<'py, f64>,
    half_height_m: PyReadonlyArray1<'py, f64>,
) -> PyResult<Rows<'py>> {
    let (v, m, a, b) = (flat(&covariance_enu_m2)?, flat(&mean_enu_m)?, flat(&radius_m)?, flat(&half_height_m)?);
    let radii =
        py.detach(|| each(a.len(), |i| anp::cylinder(triangle::<3>(v, i)?, vector(m, i), a[i], b[i]).map(|s| [s.inside, s.outside])));
    Ok(rows(py, radii.map_err(|r| refused(r, SPATIAL))?))
}

/// Stretch of cylinders that meets a risk.
#[pyfunction]
fn anp_cylinder_scale<'py>(
    py: Python<'py>,
    covariance_enu_m2: PyReadonlyArray3<'py, f64>,
    mean_enu_m: PyReadonlyArray2<'py, f64>,
    radius_m: PyReadonlyArray1<'py, f64>,
    half_height_m: PyReadonlyArray1<'py, f64>,
    risk: PyReadonlyArray1<'py, f64>,
) -> PyResult<Numbers<'py>> {
    let (v, m, a, b, q) = (flat(&covariance_enu_m2)?, flat(&mean_enu_m)?, flat(&radius_m)?, flat(&half_height_m)?, flat(&risk)?);
    let radii = py.detach(|| each(q.len(), |i| anp::cylinder_scale(triangle::<3>(v, i)?, vector(m, i), a[i], b[i], Risk::new(q[i])?)));
    Ok(radii.map_err(|r| refused(r, SPATIAL))?.into_pyarray(py))
}

/// Factors of simultaneous boxes.
#[pyfunction]
fn anp_box_factor<'py>(
    py: Python<'py>,
    covariance_enu_m2: PyReadonlyArray3<'py, f64>,
    risk: PyReadonlyArray1<'py, f64>,
) -> PyResult<Numbers<'py>> {
    let (v, q) = (flat(&covariance_enu_m2)?, flat(&risk)?);
    let radii = py.detach(|| each(q.len(), |i| anp::box_factor(triangle::<3>(v, i)?, Risk::new(q[i])?)));
    Ok(radii.map_err(|r| refused(r, SPATIAL))?.into_pyarray(py))
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(anp_circle, m)?)?;
    m.add_function(wrap_pyfunction!(anp_sphere, m)?)?;
    m.add_function(wrap_pyfunction!(anp_circle_law, m)?)?;
    m.add_function(wrap_pyfunction!(anp_sphere_law, m)?)?;
    m.add_function(wrap_pyfunction!(anp_directional, m)?)?;
    m.add_function(wrap_pyfunction!(anp_extents, m)?)?;
    m.add_function(wrap_pyfunction!(anp_ellipsoid, m)?)?;
    m.add_function(wrap_pyfunction!(anp_principal_sigmas, m)?)?;
    m.add_function(wrap_pyfunction!(chi_factor, m)?)?;
    m.add_function(wrap_pyfunction!(chi_quantile, m)?)?;
    m.add_function(wrap_pyfunction!(anp_circle_fit, m)?)?;
    m.add_function(wrap_pyfunction!(anp_circle_geodesy, m)?)?;
    m.add_function(wrap_pyfunction!(anp_circle_fit_as_printed, m)?)?;
    m.add_function(wrap_pyfunction!(anp_sphere_grubbs, m)?)?;
    m.add_function(wrap_pyfunction!(anp_sphere_grubbs_as_printed, m)?)?;
    m.add_function(wrap_pyfunction!(anp_rectangle, m)?)?;
    m.add_function(wrap_pyfunction!(anp_rectangle_scale, m)?)?;
    m.add_function(wrap_pyfunction!(anp_cylinder, m)?)?;
    m.add_function(wrap_pyfunction!(anp_cylinder_scale, m)?)?;
    m.add_function(wrap_pyfunction!(anp_box_factor, m)?)
}
