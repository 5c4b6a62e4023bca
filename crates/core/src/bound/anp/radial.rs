//! Exact radii: the circle, the sphere, and the half-width along a direction.

use super::accept::{accept, components, radius_law, upper};
use crate::frame::{Covariance, Displacement, Enu};
use crate::quantity::{Metres, OutOfDomain, Risk};
use crate::special::radius::{CentredRadius, RadiusLaw};
use nalgebra::Vector3;

/// Radius of the circle around the estimated position that the horizontal error leaves with this risk \[m\].
///
/// ```text
/// P(|e| > R) = risk,   e = N(mean, V) east-north
/// ```
///
/// # Valid
/// Any covariance, singular ones included; any mean. Relative error below 1e-12 for risks above 1e-3, 1e-9 everywhere.
///
/// # Errors
/// [`OutOfDomain`]: a covariance that is none, a mean that is not finite.
pub fn circle(covariance: &Covariance<Enu>, mean: Option<&Displacement<Enu>>, risk: Risk) -> Result<Metres, OutOfDomain> {
    let [east, north, _] = components(mean);
    radius_m(flat(upper(covariance.matrix())), [east, north, 0.0], risk.q(), ["covariance", "mean"]).map(Metres::new)
}

/// Radius of the sphere around the estimated position that the error leaves with this risk \[m\]; otherwise as [`circle`].
///
/// # Errors
/// As [`circle`].
pub fn sphere(covariance: &Covariance<Enu>, mean: Option<&Displacement<Enu>>, risk: Risk) -> Result<Metres, OutOfDomain> {
    radius_m(upper(covariance.matrix()), components(mean), risk.q(), ["covariance", "mean"]).map(Metres::new)
}

/// The bare form of [`circle`] and [`sphere`], which batch loops call: `upper` \[m²\] is the upper triangle (a circle has zeros
/// upwards), `risk` is inside (0, 1), `names` are the arguments to blame.
///
/// # Errors
/// As [`circle`].
pub fn radius_m(upper: [f64; 6], mean: [f64; 3], risk: f64, names: [&'static str; 2]) -> Result<f64, OutOfDomain> {
    if mean == [0.0; 3]
        && let Some(prepared) = CentredRadius::new(risk)
    {
        let [radius] = prepared.radii(&accept(upper, names[0])?.map(|v| [v]));
        return Ok(radius);
    }
    Ok(radius_law(upper, mean, names)?.radius(risk))
}

/// The horizontal part of an upper triangle, as an error without a vertical.
pub fn flat([ee, en, nn, ..]: [f64; 6]) -> [f64; 6] {
    [ee, en, nn, 0.0, 0.0, 0.0]
}

/// An error along one direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Directional {
    /// Mean along the direction.
    pub bias: Metres,
    /// Standard deviation along it.
    pub sigma: Metres,
    /// What |error| exceeds with the requested risk.
    pub half_width: Metres,
}

/// The error along a direction: mean b = u'mean, deviation s = sqrt(u'Vu), and R with P(|u'e| > R) = risk.
///
/// ```text
/// [erfc((R - b)/(s sqrt 2)) + erfc((R + b)/(s sqrt 2))]/2 = risk;   R = K(risk) s without a mean;   R = |b| where s = 0
/// ```
///
/// # Errors
/// [`OutOfDomain`]: a covariance that is none, a mean that is not finite, a direction whose length is not one to 1e-9.
pub fn directional(
    covariance: &Covariance<Enu>,
    direction: &Vector3<f64>,
    mean: Option<&Displacement<Enu>>,
    risk: Risk,
) -> Result<Directional, OutOfDomain> {
    accept(upper(covariance.matrix()), "covariance")?;
    let variance = variance_along(covariance, direction)?;
    let bias = mean.map_or(0.0, |m| direction.dot(m.vector()));
    if !(bias.abs() < 1e140) {
        return Err(OutOfDomain { argument: "mean", value: bias, unit: "m", domain: "(-1e140, 1e140)" });
    }
    let half_width = RadiusLaw::new([variance, 0.0, 0.0], [bias, 0.0, 0.0]).radius(risk.q());
    let sigma = crate::special::float::sqrt(variance);
    Ok(Directional { bias: Metres::new(bias), sigma: Metres::new(sigma), half_width: Metres::new(half_width) })
}

/// u'Vu of a unit vector, where rounding may not fall below zero.
pub(super) fn variance_along(covariance: &Covariance<Enu>, direction: &Vector3<f64>) -> Result<f64, OutOfDomain> {
    let length = direction.norm();
    if !((length - 1.0).abs() <= 1e-9) {
        return Err(OutOfDomain { argument: "direction", value: length, unit: "1", domain: "[1 - 1e-9, 1 + 1e-9] for its length" });
    }
    Ok(covariance.variance_along(direction).max(0.0))
}
