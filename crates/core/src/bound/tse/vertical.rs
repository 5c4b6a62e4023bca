//! Above the path, and across and above it at once.

use super::Horizontal;
use super::lateral::{Deviation, axes, exact, root_of_variance};
use crate::frame::{Covariance, Displacement, Enu};
use crate::quantity::{Metres, OutOfDomain, Radians, Risk};
use crate::special::bivariate::either_exceeds;
use crate::special::float::tan;
use crate::special::folded::two_tails;
use core::f64::consts::FRAC_PI_2;
use nalgebra::Vector3;

/// A covariance may be indefinite by this share of its largest variance: rounding, taken as zero.
const ROUNDING: f64 = 1e-9;

/// Errors across and above the path, and how they go together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathDeviations {
    /// Across the path, positive right.
    pub lateral: Deviation,
    /// Above the path, positive up.
    pub vertical: Deviation,
    /// Correlation of the two; zero where either deviation is.
    pub correlation: f64,
}

/// Project onto the lines across and above a path that climbs at `path_angle`.
///
/// ```text
/// c = (-tan g sin chi, -tan g cos chi, 1),  fte_v = c . d,  sigma_v^2 = c' Sigma c,  rho = c' Sigma n / (sigma_v sigma)
/// ```
///
/// The horizontal navigation error acts on the vertical one through the path angle; the full covariance carries that.
///
/// # Errors
/// [`OutOfDomain`] where a number is not finite, the path is vertical or the covariance is indefinite.
pub fn deviations(
    offset: &Displacement<Enu>,
    covariance: &Covariance<Enu>,
    course: Radians,
    path_angle: Radians,
) -> Result<PathDeviations, OutOfDomain> {
    if !(path_angle.rad().abs() < FRAC_PI_2) {
        return Err(OutOfDomain { argument: "path_angle_rad", value: path_angle.rad(), unit: "rad", domain: "(-pi/2, pi/2)" });
    }
    positive_semidefinite(covariance)?;
    let (t, n) = axes(course)?;
    let c = Vector3::new(0.0, 0.0, 1.0) - t * tan(path_angle.rad());
    let d = offset.vector();
    if let Some(value) = d.iter().find(|v| !v.is_finite()) {
        return Err(OutOfDomain { argument: "offset_enu_m", value: *value, unit: "m", domain: "(-inf, inf)" });
    }
    let (sigma_l, sigma_v) = (root_of_variance(covariance.variance_along(&n)), root_of_variance(covariance.variance_along(&c)));
    let product = sigma_l.m() * sigma_v.m();
    let correlation = if product > 0.0 { (c.dot(&(covariance.matrix() * n)) / product).clamp(-1.0, 1.0) } else { 0.0 };
    Ok(PathDeviations {
        lateral: Deviation::new(Metres::new(n.x * d.x + n.y * d.y), sigma_l)?,
        vertical: Deviation::new(Metres::new(c.dot(d)), sigma_v)?,
        correlation,
    })
}

/// All three by three: finite, and no principal minor below rounding.
fn positive_semidefinite(covariance: &Covariance<Enu>) -> Result<(), OutOfDomain> {
    Horizontal::new(covariance)?;
    let m = covariance.matrix();
    let scale = m.amax();
    let refuse =
        |value: f64| Err(OutOfDomain { argument: "covariance", value, unit: "m²", domain: "finite, smallest variance in [0, inf)" });
    // Element by element: the largest of them need not notice a NaN.
    if let Some(value) = m.iter().find(|v| !v.is_finite()) {
        return refuse(*value);
    }
    if scale == 0.0 {
        return Ok(());
    }
    let scaled = m / scale;
    let minor = |i: usize, j: usize| scaled[(i, i)] * scaled[(j, j)] - scaled[(i, j)] * scaled[(i, j)];
    let least = scaled.diagonal().min().min(minor(0, 2)).min(minor(1, 2)).min(scaled.determinant());
    if !(least >= -ROUNDING) {
        return refuse(least * scale);
    }
    Ok(())
}

/// Risk of leaving a box around the path, jointly and by each pair of its walls.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Box {
    /// Half width.
    pub limit: Metres,
    /// Half height.
    pub limit_v: Metres,
    /// Risk of being outside, at least the larger and at most the sum of the two below.
    pub risk: f64,
    /// Risk beyond the side walls.
    pub risk_lateral: f64,
    /// Risk beyond floor and ceiling.
    pub risk_vertical: f64,
}

/// Risk of being outside a box of these half sizes, by the bivariate normal law.
///
/// # Errors
/// [`OutOfDomain`] for a limit outside [0, inf) or a correlation outside [-1, 1].
pub fn box_risk(errors: &PathDeviations, limit: Metres, limit_v: Metres) -> Result<Box, OutOfDomain> {
    for (argument, value) in [("limit_m", limit.m()), ("limit_v_m", limit_v.m())] {
        if !(value >= 0.0 && value.is_finite()) {
            return Err(OutOfDomain { argument, value, unit: "m", domain: "[0, inf)" });
        }
    }
    let rho = errors.correlation;
    if !(rho.abs() <= 1.0) {
        return Err(OutOfDomain { argument: "correlation", value: rho, unit: "1", domain: "[-1, 1]" });
    }
    let (l, v) = (Scaled::new(&errors.lateral, limit), Scaled::new(&errors.vertical, limit_v));
    let (risk_lateral, risk_vertical) = (two_tails(l.limit, l.mean), two_tails(v.limit, v.mean));
    let risk = either_exceeds(l.limit, l.mean, v.limit, v.mean, rho);
    Ok(Box { limit, limit_v, risk, risk_lateral, risk_vertical })
}

/// Limit and mean in deviations. Without a deviation the limit is infinite on the side where the error lies: inside for certain, or not.
struct Scaled {
    limit: f64,
    mean: f64,
}

impl Scaled {
    fn new(error: &Deviation, limit: Metres) -> Self {
        if let Some((limit, mean)) = error.in_deviations(limit.m()) {
            return Self { limit, mean };
        }
        // 50 deviations: a tail of zero, or of one, in every double.
        if error.fte().m().abs() <= limit.m() { Self { limit: 50.0, mean: 0.0 } } else { Self { limit: 0.0, mean: 50.0 } }
    }
}

/// Half sizes of a box from one joint risk: `share` of it goes to the side walls, the rest to floor and ceiling, each by the exact
/// bound. The joint risk at these limits stands beside them and is never more than requested.
///
/// # Errors
/// [`OutOfDomain`] for a share outside (0, 1) or as [`box_risk`].
pub fn box_limits(errors: &PathDeviations, risk: Risk, share: f64) -> Result<Box, OutOfDomain> {
    if !(share > 0.0 && share < 1.0) {
        return Err(OutOfDomain { argument: "share", value: share, unit: "1", domain: "(0, 1)" });
    }
    let limit = exact(errors.lateral, Risk::new(risk.q() * share)?);
    let limit_v = exact(errors.vertical, Risk::new(risk.q() * (1.0 - share))?);
    box_risk(errors, limit, limit_v)
}
