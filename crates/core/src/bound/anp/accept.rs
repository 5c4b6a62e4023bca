//! What counts as a covariance: one rule for every function of the family.

use crate::frame::{Covariance, Displacement, Enu};
use crate::quantity::{Metres, OutOfDomain};
use crate::special::float::sqrt;
use crate::special::radius::{RadiusLaw, principal_axes};
use nalgebra::Vector3;

/// Rounding may push an eigenvalue this share of the largest below zero; further down the matrix is no covariance.
const INDEFINITE: f64 = 1e-10;
/// The trace must leave room for its square and cube: variances of (1e-140 m)^2 are as meaningless as of (1e140 m)^2.
const TRACES: core::ops::Range<f64> = 1e-280..1e280;

/// The upper triangle \[ee, en, nn, eu, nu, uu\] of a covariance \[m²\], accepted as such; `argument` is the name to blame.
///
/// A slightly negative eigenvalue is set to zero; the covariance then comes back along its principal axes, which no radius notices.
///
/// # Errors
/// [`OutOfDomain`] unless finite, no eigenvalue below -1e-10 of the largest, and trace zero or in \[1e-280, 1e280).
#[inline]
pub fn accept(upper: [f64; 6], argument: &'static str) -> Result<[f64; 6], OutOfDomain> {
    let [a, b, c, d, e, f] = upper;
    let trace = a + c + f;
    // The smallest principal minors of a definite matrix, in units of the trace; rounding reaches 1e-15 of them.
    let scale = 1.0 / trace;
    let minors = ((a * scale) * (c * scale) - (b * scale) * (b * scale))
        + ((a * scale) * (f * scale) - (d * scale) * (d * scale))
        + ((c * scale) * (f * scale) - (e * scale) * (e * scale));
    let determinant = (scale * a) * ((scale * c) * (scale * f) - (scale * e) * (scale * e))
        - (scale * b) * ((scale * b) * (scale * f) - (scale * e) * (scale * d))
        + (scale * d) * ((scale * b) * (scale * e) - (scale * c) * (scale * d));
    let flat = d == 0.0 && e == 0.0 && f == 0.0;
    if TRACES.contains(&trace) && minors > 1e-6 && (determinant > 1e-9 || flat) {
        return Ok(upper);
    }
    accept_singular(upper, argument)
}

/// The same from the eigenvalues, for matrices that are nearly singular or wrong.
#[cold]
fn accept_singular(upper: [f64; 6], argument: &'static str) -> Result<[f64; 6], OutOfDomain> {
    let refuse = |value, domain| Err(OutOfDomain { argument, value, unit: "m²", domain });
    if let Some(bad) = upper.iter().find(|v| !v.is_finite()) {
        return refuse(*bad, "(-inf, inf): every element finite");
    }
    if upper == [0.0; 6] {
        return Ok(upper);
    }
    let ([l1, l2, l3], _) = axes(&upper);
    if !(l3 >= -INDEFINITE * l1) {
        return refuse(l3, "[-1e-10, 1] of the largest eigenvalue (its smallest eigenvalue is shown)");
    }
    let trace = upper[0] + upper[2] + upper[5];
    if !TRACES.contains(&trace) {
        return refuse(trace, "0 or [1e-280, 1e280) for the sum of the variances");
    }
    if l3 < 0.0 {
        return Ok([l1, 0.0, l2.max(0.0), 0.0, 0.0, 0.0]);
    }
    Ok(upper)
}

/// Eigenvalues, largest first, and axes of an upper triangle.
pub(super) fn axes(&[a, b, c, d, e, f]: &[f64; 6]) -> ([f64; 3], [[f64; 3]; 3]) {
    principal_axes(&[[a, b, d], [b, c, e], [d, e, f]])
}

/// Eigenvalues, none below zero, and axes of a covariance.
///
/// # Errors
/// As [`accept`].
pub(super) fn accepted_axes(upper: [f64; 6], argument: &'static str) -> Result<([f64; 3], [[f64; 3]; 3]), OutOfDomain> {
    accept(upper, argument)?;
    let (values, columns) = axes(&upper);
    Ok((values.map(|l| l.max(0.0)), columns))
}

/// The law of the length of an error with this covariance \[m²\] and mean \[m\].
///
/// # Errors
/// As [`accept`]; or the mean is not finite.
pub fn radius_law(upper: [f64; 6], mean: [f64; 3], names: [&'static str; 2]) -> Result<RadiusLaw, OutOfDomain> {
    let (values, columns) = accepted_axes(upper, names[0])?;
    if let Some(bad) = mean.iter().find(|m| !(m.abs() < 1e140)) {
        return Err(OutOfDomain { argument: names[1], value: *bad, unit: "m", domain: "(-1e140, 1e140)" });
    }
    let along = |j: usize| (0..3).map(|i| columns[i][j] * mean[i]).sum();
    Ok(RadiusLaw::new(values, [along(0), along(1), along(2)]))
}

/// Standard deviations along the principal axes, largest first.
///
/// # Errors
/// As [`accept`].
pub fn principal_sigmas(covariance: &Covariance<Enu>) -> Result<[Metres; 3], OutOfDomain> {
    let (values, _) = accepted_axes(upper(covariance.matrix()), "covariance")?;
    Ok(values.map(|l| Metres::new(sqrt(l))))
}

/// The upper triangle of a symmetric matrix.
pub(super) fn upper(v: &nalgebra::Matrix3<f64>) -> [f64; 6] {
    [v[(0, 0)], v[(0, 1)], v[(1, 1)], v[(0, 2)], v[(1, 2)], v[(2, 2)]]
}

/// The components of an optional mean; absent means zero.
pub(super) fn components(mean: Option<&Displacement<Enu>>) -> [f64; 3] {
    mean.map_or([0.0; 3], |m| {
        let v: &Vector3<f64> = m.vector();
        [v[0], v[1], v[2]]
    })
}
