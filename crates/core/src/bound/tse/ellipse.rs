//! Bounds made from the horizontal error ellipse: SQSM and CTEM.

use super::lateral::axes;
use crate::frame::{Covariance, Displacement, Enu};
use crate::quantity::{Metres, OutOfDomain, Radians, Risk};
use crate::special::float::{atan2, hypot, sin_cos, sqrt};
use crate::special::folded::FoldedQuantile;

/// A covariance may be indefinite by this share of its largest variance: rounding, taken as zero.
const ROUNDING: f64 = 1e-9;
/// Newton steps on the secular equation; ten were the most seen over twelve decades.
const MOST_STEPS: usize = 60;

/// The east-north part of a covariance, checked, with its axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Horizontal {
    major: f64,
    minor: f64,
    angle: f64,
}

impl Horizontal {
    /// Axes of the horizontal error ellipse.
    ///
    /// # Errors
    /// [`OutOfDomain`] unless the horizontal covariance is finite and positive semidefinite; a smallest variance of at least -1e-9 times
    /// the largest is rounding and becomes zero.
    pub fn new(covariance: &Covariance<Enu>) -> Result<Self, OutOfDomain> {
        let m = covariance.horizontal();
        let (ee, en, nn) = (m.m11, m.m12, m.m22);
        let (mean, half) = (0.5 * (ee + nn), hypot(0.5 * (ee - nn), en));
        let (largest, smallest) = (mean + half, mean - half);
        if !(largest.is_finite() && smallest >= -ROUNDING * largest) {
            return Err(OutOfDomain {
                argument: "covariance",
                value: smallest,
                unit: "m²",
                domain: "finite, smallest variance in [0, inf)",
            });
        }
        Ok(Self { major: sqrt(largest), minor: sqrt(smallest.max(0.0)), angle: 0.5 * atan2(2.0 * en, ee - nn) })
    }
    /// Largest standard deviation in any horizontal direction.
    pub const fn major(&self) -> Metres {
        Metres::new(self.major)
    }
    /// Smallest standard deviation in any horizontal direction.
    pub const fn minor(&self) -> Metres {
        Metres::new(self.minor)
    }
    /// Direction of the major axis, from east towards north.
    pub const fn angle(&self) -> Radians {
        Radians::new(self.angle)
    }
    /// An east-north vector along the major and the minor axis.
    pub(super) fn in_axes(&self, e: f64, n: f64) -> (f64, f64) {
        let (s, c) = sin_cos(self.angle);
        (c * e + s * n, c * n - s * e)
    }
}

/// Scalar sum: fte + K(q) times the largest horizontal deviation \[m\].
///
/// # Errors
/// [`OutOfDomain`] for a flight technical error that is not finite.
pub fn sqsm(fte: Metres, horizontal: &Horizontal, risk: Risk) -> Result<Metres, OutOfDomain> {
    sqsm_at(fte, horizontal, &FoldedQuantile::new(risk))
}

/// The same with the factors of the risk worked out before, for many epochs at one risk \[m\].
///
/// # Errors
/// As [`sqsm`].
pub fn sqsm_at(fte: Metres, horizontal: &Horizontal, factors: &FoldedQuantile) -> Result<Metres, OutOfDomain> {
    if !fte.m().is_finite() {
        return Err(OutOfDomain { argument: "fte_m", value: fte.m(), unit: "m", domain: "(-inf, inf)" });
    }
    Ok(Metres::new(fte.m().abs() + factors.two_sided() * horizontal.major))
}

/// Circle tangent to the ellipse: the distance from the expected point to the farthest point of the ellipse with factor K(q) \[m\].
/// The offset counts whole, along the track too, as published.
///
/// # Errors
/// [`OutOfDomain`] for an offset that is not finite.
pub fn ctem(offset: &Displacement<Enu>, horizontal: &Horizontal, risk: Risk) -> Result<Metres, OutOfDomain> {
    ctem_at(offset, horizontal, &FoldedQuantile::new(risk))
}

/// The same with the factors of the risk worked out before, for many epochs at one risk \[m\].
///
/// # Errors
/// As [`ctem`].
pub fn ctem_at(offset: &Displacement<Enu>, horizontal: &Horizontal, factors: &FoldedQuantile) -> Result<Metres, OutOfDomain> {
    let p = offset.vector();
    if !(p.x.is_finite() && p.y.is_finite()) {
        let value = if p.x.is_finite() { p.y } else { p.x };
        return Err(OutOfDomain { argument: "offset_en_m", value, unit: "m", domain: "(-inf, inf)" });
    }
    let (x, y) = horizontal.in_axes(p.x, p.y);
    let k = factors.two_sided();
    Ok(farthest(Metres::new(x), Metres::new(y), Metres::new(k * horizontal.major), Metres::new(k * horizontal.minor)))
}

/// The same with the expected point replaced by the foot of the perpendicular, which makes it a property of the lateral situation \[m\].
///
/// # Errors
/// [`OutOfDomain`] for a flight technical error or course that is not finite.
pub fn ctem_foot(fte: Metres, course: Radians, horizontal: &Horizontal, risk: Risk) -> Result<Metres, OutOfDomain> {
    ctem_foot_at(fte, course, horizontal, &FoldedQuantile::new(risk))
}

/// The same with the factors of the risk worked out before, for many epochs at one risk \[m\].
///
/// # Errors
/// As [`ctem_foot`].
pub fn ctem_foot_at(fte: Metres, course: Radians, horizontal: &Horizontal, factors: &FoldedQuantile) -> Result<Metres, OutOfDomain> {
    if !fte.m().is_finite() {
        return Err(OutOfDomain { argument: "fte_m", value: fte.m(), unit: "m", domain: "(-inf, inf)" });
    }
    let (_, n) = axes(course)?;
    ctem_at(&Displacement::from_vector(n * fte.m()), horizontal, factors)
}

/// Distance from the origin to the farthest point of an ellipse centred at (`x`, `y`) with these half axes \[m\].
pub fn farthest(x: Metres, y: Metres, half_x: Metres, half_y: Metres) -> Metres {
    let (c, d) = (x.m().abs(), y.m().abs());
    Metres::new(if half_x.m() >= half_y.m() {
        farthest_ordered(c, d, half_x.m(), half_y.m())
    } else {
        farthest_ordered(d, c, half_y.m(), half_x.m())
    })
}

/// Largest |c + v| over the ellipse, a >= b, both c >= 0, by the secular equation in mu = lambda - a^2:
///
/// ```text
/// (c1 a / mu)^2 + (c2 b / (mu + gap))^2 = 1,   gap = a^2 - b^2
/// ```
///
/// The shift is essential: without it all digits are lost where the expected point lies almost on an axis. Newton starts left of the
/// root and only moves right.
fn farthest_ordered(c1: f64, c2: f64, a: f64, b: f64) -> f64 {
    let gap = (a - b) * (a + b);
    if a == 0.0 {
        return hypot(c1, c2);
    }
    if c1 == 0.0 && gap == 0.0 {
        return c2 + a;
    }
    if c1 == 0.0 && c2 * b <= gap {
        let w = c2 * b / gap;
        return hypot(c2 + w * b, a * sqrt((1.0 - w) * (1.0 + w)));
    }
    let mut mu = (c1 * a).max(c2 * b - gap);
    for _ in 0..MOST_STEPS {
        let (first, second) = (c1 * a / mu, c2 * b / (mu + gap));
        let f = first * first + second * second;
        let g = first * first / mu + second * second / (mu + gap);
        let step = (sqrt(f) - 1.0) * f / g;
        mu += step;
        if !(step.abs() > 1e-15 * mu) {
            break;
        }
    }
    let lambda = a * a + mu;
    hypot(if c1 == 0.0 { 0.0 } else { c1 * lambda / mu }, c2 * lambda / (mu + gap))
}
