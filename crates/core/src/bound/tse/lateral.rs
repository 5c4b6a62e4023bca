//! The error across the path as one normal variable: exact bound, LTEM, risk beyond a limit, budgets, gradients.

use super::Horizontal;
use crate::frame::{Covariance, Displacement, Enu};
use crate::quantity::{Metres, OutOfDomain, Radians, Risk};
use crate::special::float::{exp, ln, sin_cos, sqrt};
use crate::special::folded::{FoldedQuantile, ln_two_tails, two_tails};
use crate::special::normal::density;
use crate::special::prepared::PreparedQuantile;
use crate::special::root::falling_root;
use nalgebra::Vector3;

/// A normal error with a known mean: the flight technical error, and the deviation of the navigation system error along the same line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Deviation {
    fte: f64,
    sigma: f64,
}

impl Deviation {
    /// Mean of either sign, and standard deviation.
    ///
    /// # Errors
    /// [`OutOfDomain`] unless both are finite and `sigma >= 0`.
    #[inline]
    pub fn new(fte: Metres, sigma: Metres) -> Result<Self, OutOfDomain> {
        if !fte.m().is_finite() {
            return Err(OutOfDomain { argument: "fte_m", value: fte.m(), unit: "m", domain: "(-inf, inf)" });
        }
        if !(sigma.m() >= 0.0 && sigma.m().is_finite()) {
            return Err(OutOfDomain { argument: "sigma_m", value: sigma.m(), unit: "m", domain: "[0, inf)" });
        }
        // A zero with a sign would make a quotient of the wrong one.
        Ok(Self { fte: fte.m(), sigma: sigma.m().abs() })
    }
    /// The mean, signed: positive right of the path, or above it.
    pub const fn fte(&self) -> Metres {
        Metres::new(self.fte)
    }
    /// The standard deviation.
    pub const fn sigma(&self) -> Metres {
        Metres::new(self.sigma)
    }
    /// A limit and the mean in units of the deviation; `None` where there is no deviation, or one so small that a ratio overflows: the
    /// error then is its mean.
    pub(super) fn in_deviations(&self, limit: f64) -> Option<(f64, f64)> {
        let (limit, mean) = (limit / self.sigma, self.fte / self.sigma);
        (self.sigma > 0.0 && limit.is_finite() && mean.is_finite()).then_some((limit, mean))
    }
}

/// The lateral situation: across the path, and how far the estimate is along it from the expected point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lateral {
    /// Across the path, positive right.
    pub deviation: Deviation,
    /// Along the path, positive ahead.
    pub along: Metres,
}

/// Project onto the line across the path.
///
/// ```text
/// n = (cos chi, -sin chi),  t = (sin chi, cos chi)
/// fte = n . p,  along = t . p,  sigma^2 = n' Sigma n
/// ```
///
/// No eigenvectors, no slope and no special case for an axis parallel to the path.
///
/// # Errors
/// [`OutOfDomain`] where a number is not finite or the covariance is indefinite.
pub fn project(offset: &Displacement<Enu>, covariance: &Covariance<Enu>, course: Radians) -> Result<Lateral, OutOfDomain> {
    Horizontal::new(covariance)?;
    let (t, n) = axes(course)?;
    let p = offset.vector();
    let horizontal = Vector3::new(p.x, p.y, 0.0);
    if !(p.x.is_finite() && p.y.is_finite()) {
        let value = if p.x.is_finite() { p.y } else { p.x };
        return Err(OutOfDomain { argument: "offset_en_m", value, unit: "m", domain: "(-inf, inf)" });
    }
    // The horizontal block alone: what is not known of the vertical error does not matter here.
    let variance = n.xy().dot(&(covariance.horizontal() * n.xy()));
    let deviation = Deviation::new(Metres::new(n.dot(&horizontal)), root_of_variance(variance))?;
    Ok(Lateral { deviation, along: Metres::new(t.dot(&horizontal)) })
}

/// The deviation of a variance that rounding may have left slightly negative. NaN stays NaN, to be refused.
pub(super) fn root_of_variance(variance: f64) -> Metres {
    Metres::new(if variance < 0.0 { 0.0 } else { sqrt(variance) })
}

/// Unit vectors along the course and across it to the right.
///
/// # Errors
/// As [`Radians::course`].
pub fn axes(course: Radians) -> Result<(Vector3<f64>, Vector3<f64>), OutOfDomain> {
    let (s, c) = sin_cos(course.course()?.rad());
    Ok((Vector3::new(s, c, 0.0), Vector3::new(c, -s, 0.0)))
}

/// Exact bound: the root T of Q((T - fte) / sigma) + Q((T + fte) / sigma) = q \[m\].
///
/// The published double integrals (Fu 2014, eq. 13 to 18) reduce to this: the error across the path is a linear form of a normal
/// vector, so it is normal, and the strip between the two lines is an interval of it.
pub fn exact(deviation: Deviation, risk: Risk) -> Metres {
    exact_at(deviation, &FoldedQuantile::new(risk))
}

/// The same with the factors of the risk worked out before, for many epochs at one risk \[m\].
pub fn exact_at(deviation: Deviation, factors: &FoldedQuantile) -> Metres {
    let Deviation { fte, sigma } = deviation;
    Metres::new(if sigma == 0.0 { fte.abs() } else { fte.abs() + factors.excess(fte.abs() / sigma) * sigma })
}

/// The exact bound from a prepared table: the same to a few 1e-15, in a few operations \[m\].
#[inline(always)]
pub fn exact_prepared(deviation: Deviation, prepared: &PreparedQuantile) -> Metres {
    let Deviation { fte, sigma } = deviation;
    Metres::new(prepared.bound(fte, sigma))
}

/// Line tangent to the ellipse: fte + K(q) sigma \[m\]. Never below the exact bound; equal to it where fte or sigma is zero.
#[inline]
pub fn ltem(deviation: Deviation, risk: Risk) -> Metres {
    ltem_at(deviation, &FoldedQuantile::new(risk))
}

/// The same with the factors of the risk worked out before, for many epochs at one risk \[m\].
#[inline]
pub fn ltem_at(deviation: Deviation, factors: &FoldedQuantile) -> Metres {
    Metres::new(deviation.fte.abs() + factors.two_sided() * deviation.sigma)
}

/// Risk that the total system error exceeds a limit: an alert needs no root.
///
/// # Errors
/// [`OutOfDomain`] unless `limit >= 0` and finite.
pub fn exceedance_risk(deviation: Deviation, limit: Metres) -> Result<f64, OutOfDomain> {
    let limit = checked_limit(limit)?;
    Ok(match deviation.in_deviations(limit) {
        Some((limit, mean)) => two_tails(limit, mean),
        None if deviation.fte.abs() <= limit => 0.0,
        None => 1.0,
    })
}

/// Natural logarithm of [`exceedance_risk`], finite where the risk underflows; minus infinity only where sigma is zero.
///
/// # Errors
/// As [`exceedance_risk`].
pub fn ln_exceedance_risk(deviation: Deviation, limit: Metres) -> Result<f64, OutOfDomain> {
    match deviation.in_deviations(checked_limit(limit)?) {
        Some((limit, mean)) => Ok(ln_two_tails(limit, mean)),
        None => exceedance_risk(deviation, limit).map(|r| if r > 0.0 { 0.0 } else { f64::NEG_INFINITY }),
    }
}

fn checked_limit(limit: Metres) -> Result<f64, OutOfDomain> {
    if !(limit.m() >= 0.0 && limit.m().is_finite()) {
        return Err(OutOfDomain { argument: "limit_m", value: limit.m(), unit: "m", domain: "[0, inf)" });
    }
    Ok(limit.m())
}

/// How the exact bound answers to its two inputs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gradient {
    /// dT / d fte, with the sign of the flight technical error.
    pub by_fte: f64,
    /// dT / d sigma.
    pub by_sigma: f64,
}

/// Gradient of the exact bound, from the implicit function:
///
/// ```text
/// dT/d|fte| = (phi(u) - phi(u+2m)) / (phi(u) + phi(u+2m)),   dT/dsigma = (u phi(u) + (u+2m) phi(u+2m)) / (phi(u) + phi(u+2m))
/// ```
///
/// # Valid
/// At sigma = 0 the derivative by sigma is the one from above; at fte = sigma = 0, where the bound has an edge, it is K.
pub fn gradient(deviation: Deviation, risk: Risk) -> Gradient {
    let Deviation { fte, sigma } = deviation;
    let ratio = if fte == 0.0 { 0.0 } else { fte.abs() / sigma };
    let u = FoldedQuantile::new(risk).excess(ratio);
    // phi(u + 2m) / phi(u), without a quotient of two underflowing densities.
    let far = exp(-2.0 * ratio * (u + ratio));
    let far_moment = if far > 0.0 { (u + 2.0 * ratio) * far } else { 0.0 };
    Gradient { by_fte: fte.signum() * ((1.0 - far) / (1.0 + far)), by_sigma: (u + far_moment) / (1.0 + far) }
}

/// Largest flight technical error whose exact bound is within `limit`; `None` where even zero is not \[m\].
///
/// # Errors
/// [`OutOfDomain`] for a limit or sigma outside [0, inf).
pub fn fte_budget(limit: Metres, sigma: Metres, risk: Risk) -> Result<Option<Metres>, OutOfDomain> {
    let limit = checked_limit(limit)?;
    let sigma = Deviation::new(Metres::new(0.0), sigma)?.sigma;
    if sigma == 0.0 {
        return Ok(Some(Metres::new(limit)));
    }
    let (law, bound) = (FoldedQuantile::new(risk), limit / sigma);
    if !(bound >= law.two_sided()) {
        return Ok(None);
    }
    // Falling in -m: more room, less risk. z < u <= K with u = bound - m is the bracket.
    let f = |x: f64| {
        let now = two_tails(bound, x);
        (ln(now / law.risk()), (density(bound - x) - density(bound + x)) / now)
    };
    let (most, least) = (law.one_sided() - bound, law.two_sided() - bound);
    let ratio = -falling_root(most, least, most, f);
    Ok(Some(Metres::new(ratio * sigma)))
}

/// Largest deviation whose exact bound is within `limit` at this flight technical error; `None` where no deviation is \[m\].
///
/// # Errors
/// [`OutOfDomain`] for a limit outside [0, inf) or a flight technical error that is not finite.
pub fn sigma_budget(limit: Metres, fte: Metres, risk: Risk) -> Result<Option<Metres>, OutOfDomain> {
    let limit = checked_limit(limit)?;
    let fte = Deviation::new(fte, Metres::new(0.0))?.fte.abs();
    if !(fte <= limit) {
        return Ok(None);
    }
    if fte == limit {
        return Ok(Some(Metres::new(0.0)));
    }
    let law = FoldedQuantile::new(risk);
    // In u = (limit - fte) / sigma the far tail stands at a fixed multiple of u.
    let multiple = (limit + fte) / (limit - fte);
    let f = |u: f64| {
        let now = two_tails(0.5 * u * (1.0 + multiple), 0.5 * u * (multiple - 1.0));
        (ln(now / law.risk()), -(density(u) + multiple * density(multiple * u)) / now)
    };
    let u = falling_root(law.one_sided().max(0.0), law.two_sided(), law.two_sided(), f);
    Ok(Some(Metres::new((limit - fte) / u)))
}
