//! The ellipsoid of constant density, and what it says along a direction.

use super::accept::{accepted_axes, upper};
use super::radial::variance_along;
use crate::frame::{Covariance, Enu};
use crate::quantity::{Metres, OutOfDomain, Risk};
use crate::special::chi::chi_factor;
use crate::special::float::sqrt;
use core::f64::consts::PI;
use nalgebra::{Matrix3, Vector3};

/// A conditional variance below this share of the variance itself is rounding, and the matrix singular.
const SINGULAR: f64 = 1e-14;

/// The region e' V^-1 e <= k^2 that the error leaves with the requested risk.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ellipsoid {
    /// k, the factor of the three-dimensional length.
    pub factor: f64,
    /// Semi-axes, longest first \[m\].
    pub semi_axes: [f64; 3],
    /// Their directions as columns: `axes[component east, north, up][axis]`.
    pub axes: [[f64; 3]; 3],
    /// Half-size of the bounding box along east, north, up: k sqrt(u'Vu) \[m\].
    pub support: [f64; 3],
    /// Where the east, north and up axes pierce the surface: k / sqrt(u'V^-1 u) \[m\]; `None` for a singular covariance.
    pub intercept: Option<[f64; 3]>,
    /// Volume: (4/3) pi k^3 sqrt(det V) \[m³\].
    pub volume: f64,
}

/// The ellipsoid of one risk. Its support is a joint number: one axis alone is left by the error with a smaller risk, 0.518 % for a
/// 95 % ellipsoid.
///
/// # Errors
/// [`OutOfDomain`]: a covariance that is none.
pub fn ellipsoid(covariance: &Covariance<Enu>, risk: Risk) -> Result<Ellipsoid, OutOfDomain> {
    let (values, axes) = accepted_axes(upper(covariance.matrix()), "covariance")?;
    let factor = chi_factor(3, risk.q())?;
    let v = covariance.matrix();
    let root = cholesky(v);
    let intercepts = || {
        let e = pierced(v, &Vector3::x())?;
        let n = pierced(v, &Vector3::y())?;
        Some([factor * e, factor * n, factor * pierced(v, &Vector3::z())?])
    };
    let root_determinant = root.map_or(0.0, |l| l[(0, 0)] * l[(1, 1)] * l[(2, 2)]);
    Ok(Ellipsoid {
        factor,
        semi_axes: values.map(|l| factor * sqrt(l)),
        axes,
        support: [0, 1, 2].map(|i| factor * sqrt(v[(i, i)].max(0.0))),
        intercept: intercepts(),
        volume: 4.0 / 3.0 * PI * factor * factor * factor * root_determinant,
    })
}

/// Half-size of the ellipsoid's bounding box along a unit vector: k sqrt(u'Vu) \[m\].
///
/// # Errors
/// [`OutOfDomain`]: a covariance that is none, a direction whose length is not one.
pub fn support(covariance: &Covariance<Enu>, direction: &Vector3<f64>, risk: Risk) -> Result<Metres, OutOfDomain> {
    accepted_axes(upper(covariance.matrix()), "covariance")?;
    Ok(Metres::new(chi_factor(3, risk.q())? * sqrt(variance_along(covariance, direction)?)))
}

/// Where a unit vector pierces the ellipsoid: k / sqrt(u'V^-1 u) \[m\]; `None` for a singular covariance.
///
/// # Errors
/// As [`support`].
pub fn intercept(covariance: &Covariance<Enu>, direction: &Vector3<f64>, risk: Risk) -> Result<Option<Metres>, OutOfDomain> {
    accepted_axes(upper(covariance.matrix()), "covariance")?;
    variance_along(covariance, direction)?;
    let factor = chi_factor(3, risk.q())?;
    Ok(pierced(covariance.matrix(), direction).map(|length| Metres::new(factor * length)))
}

/// 1 / sqrt(u'V^-1 u) by forward substitution.
fn pierced(v: &Matrix3<f64>, u: &Vector3<f64>) -> Option<f64> {
    let l = cholesky(v)?;
    let x = u[0] / l[(0, 0)];
    let y = (u[1] - l[(1, 0)] * x) / l[(1, 1)];
    let z = (u[2] - l[(2, 0)] * x - l[(2, 1)] * y) / l[(2, 2)];
    Some(1.0 / sqrt(x * x + y * y + z * z))
}

/// V = L L', or `None` where a pivot is only rounding.
fn cholesky(v: &Matrix3<f64>) -> Option<Matrix3<f64>> {
    let mut l = Matrix3::zeros();
    for j in 0..3 {
        let pivot = v[(j, j)] - (0..j).map(|k| l[(j, k)] * l[(j, k)]).sum::<f64>();
        if !(pivot > SINGULAR * v[(j, j)]) {
            return None;
        }
        l[(j, j)] = sqrt(pivot);
        for i in j + 1..3 {
            l[(i, j)] = (v[(i, j)] - (0..j).map(|k| l[(i, k)] * l[(j, k)]).sum::<f64>()) / l[(j, j)];
        }
    }
    Some(l)
}
