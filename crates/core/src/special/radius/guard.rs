//! Which rule evaluates a radius law. The limits are measured: beyond them a contour fails without warning.
//!
//! Largest absolute error of the probability by the squared length of the mean in standard deviations, over random covariances and
//! radii (the worst lie inside the mean's length, not at a quantile beyond it):
//!
//! ```text
//! sum delta^2           12.5    25      37.5    50      62.5    75      100
//! parabola, 20 nodes    2e-15   2e-14   3e-13   9e-12   1e-10   8e-10   2e-8
//! parabola, 24 nodes    3e-15   4e-15   3e-15   9e-15   1e-13   1e-12   4e-11
//! ```

use super::nodes::{Node, PARABOLA_20, PARABOLA_24, TALBOT_14};

/// How a radius law is evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rule {
    /// Zero mean: Talbot's contour, 14 half nodes.
    Talbot14,
    /// Squared mean over variance, summed over the axes, up to 20: parabola, 20 half nodes.
    Parabola20,
    /// Up to 50: parabola, 24 half nodes.
    Parabola24,
    /// Beyond, and where one side is small: a contour through the saddle point.
    Saddle,
}

impl Rule {
    /// The rule for the sum of squared mean over variance of the live axes.
    pub(super) fn of(delta_squared: f64) -> Self {
        if delta_squared == 0.0 {
            Self::Talbot14
        } else if delta_squared <= 20.0 {
            Self::Parabola20
        } else if delta_squared <= 50.0 {
            Self::Parabola24
        } else {
            Self::Saddle
        }
    }

    /// The nodes of a fixed contour; that through the saddle point depends on the radius.
    pub(super) fn nodes(self) -> Option<&'static [Node]> {
        match self {
            Self::Talbot14 => Some(&TALBOT_14),
            Self::Parabola20 => Some(&PARABOLA_20),
            Self::Parabola24 => Some(&PARABOLA_24),
            Self::Saddle => None,
        }
    }
}
