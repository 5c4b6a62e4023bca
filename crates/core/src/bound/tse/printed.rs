//! The paper's own frame, and what it prints where that differs from what holds.

use super::ellipse::{Horizontal, farthest};
use super::lateral::Deviation;
use crate::frame::{Displacement, Enu};
use crate::quantity::{Metres, OutOfDomain, Radians, Risk};
use crate::special::float::{cos, hypot, sin};
use crate::special::two_sided_factor;

/// The frame of Fu 2014: axes along the error ellipse, the path a line of slope k through the origin, the estimate at (x0, y0).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RotatedFrame {
    x0: f64,
    y0: f64,
    sigma_a: f64,
    sigma_b: f64,
    deviation: Deviation,
}

impl RotatedFrame {
    /// From the slope (plus or minus infinity for a path along the second axis), the estimate, and the deviations along the axes.
    ///
    /// ```text
    /// fte = (y0 - k x0) / sqrt(1 + k^2),  sigma^2 = (k^2 sigma_a^2 + sigma_b^2) / (1 + k^2)
    /// ```
    ///
    /// # Errors
    /// [`OutOfDomain`] for a NaN slope, an estimate that is not finite, or a negative deviation.
    pub fn new(k: f64, x0: Metres, y0: Metres, sigma_a: Metres, sigma_b: Metres) -> Result<Self, OutOfDomain> {
        if k.is_nan() {
            return Err(OutOfDomain { argument: "k", value: k, unit: "1", domain: "[-inf, inf]" });
        }
        for (argument, value) in [("x0_m", x0.m()), ("y0_m", y0.m())] {
            if !value.is_finite() {
                return Err(OutOfDomain { argument, value, unit: "m", domain: "(-inf, inf)" });
            }
        }
        for (argument, value) in [("sigma_a_m", sigma_a.m()), ("sigma_b_m", sigma_b.m())] {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(OutOfDomain { argument, value, unit: "m", domain: "[0, inf)" });
            }
        }
        let (x0, y0, sigma_a, sigma_b) = (x0.m(), y0.m(), sigma_a.m(), sigma_b.m());
        // Direction cosines of the normal; at an infinite slope they are (-+1, 0).
        let (cosine, sine) = if k.is_infinite() { (0.0, k.signum()) } else { (1.0 / hypot(1.0, k), k / hypot(1.0, k)) };
        let fte = cosine * y0 - sine * x0;
        let sigma = hypot(sine * sigma_a, cosine * sigma_b);
        Ok(Self { x0, y0, sigma_a, sigma_b, deviation: Deviation::new(Metres::new(fte), Metres::new(sigma))? })
    }
    /// The error across the path.
    pub const fn deviation(&self) -> Deviation {
        self.deviation
    }
    /// SQSM in this frame.
    pub fn sqsm(&self, risk: Risk) -> Metres {
        Metres::new(self.deviation.fte().m().abs() + two_sided_factor(risk.q()) * self.sigma_a.max(self.sigma_b))
    }
    /// CTEM in this frame.
    pub fn ctem(&self, risk: Risk) -> Metres {
        let k = two_sided_factor(risk.q());
        farthest(Metres::new(self.x0), Metres::new(self.y0), Metres::new(k * self.sigma_a), Metres::new(k * self.sigma_b))
    }
}

/// Slope of the path in the rotated frame: cot(phi + chi). Infinite where the path runs along the second axis.
pub fn slope(horizontal: &Horizontal, course: Radians) -> f64 {
    let direction = horizontal.angle().rad() + course.rad();
    cos(direction) / sin(direction)
}

/// The slope as printed, cot(phi): right for a path due north and for no other (erratum E3).
pub fn slope_as_printed(horizontal: &Horizontal) -> f64 {
    slope(horizontal, Radians::new(0.0))
}

/// The factors as printed: 1.96 at a risk of 0.05 and 4.41 at 1e-5. The second is too small: its risk is 1.0337e-5 (erratum E2).
///
/// # Errors
/// [`OutOfDomain`] at any other risk: the paper prints no other factor.
pub fn factor_as_printed(risk: Risk) -> Result<f64, OutOfDomain> {
    if risk == Risk::ACCURACY {
        Ok(1.96)
    } else if risk == Risk::INTEGRITY {
        Ok(4.41)
    } else {
        Err(OutOfDomain { argument: "risk", value: risk.q(), unit: "1", domain: "{0.05, 1e-5}, the two the paper prints" })
    }
}

/// LTEM as printed, eq. 39 with the printed slope and factors \[m\]:
///
/// ```text
/// k x0 / sqrt(1 + k^2) - y0 / sqrt(1 + k^2) + sqrt((k^2 a^2 + b^2) / (1 + k^2)),   a = K sigma_a, b = K sigma_b, k = cot(phi)
/// ```
///
/// # Deviation from the source
/// None; that is the point. The distance from the path is signed here, so an estimate on the one side of the path is bounded too low
/// (E13: -5.49 for 8.65), the slope forgets the course (E3), and 4.41 is short (E2). [`super::ltem`] is the method.
///
/// # Errors
/// [`OutOfDomain`] for an offset that is not finite, or as [`factor_as_printed`].
pub fn ltem_as_printed(offset: &Displacement<Enu>, horizontal: &Horizontal, risk: Risk) -> Result<Metres, OutOfDomain> {
    let (x0, y0) = horizontal.in_axes(offset.vector().x, offset.vector().y);
    let frame = RotatedFrame::new(slope_as_printed(horizontal), Metres::new(x0), Metres::new(y0), horizontal.major(), horizontal.minor())?;
    let half_width = factor_as_printed(risk)? * frame.deviation.sigma().m();
    Ok(Metres::new(half_width - frame.deviation.fte().m()))
}
