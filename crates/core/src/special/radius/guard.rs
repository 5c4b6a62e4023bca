//! Which rule evaluates a radius law. The limits are measured: beyond them a contour fails without warning.

use super::nodes::{Node, PARABOLA_20, PARABOLA_24, TALBOT_14};

/// How a radius law is evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rule {
    /// Zero mean: Talbot's contour, 14 half nodes.
    Talbot14,
    /// Largest squared mean over variance up to 50: parabola, 20 half nodes.
    Parabola20,
    /// Up to 100: parabola, 24 half nodes.
    Parabola24,
    /// Beyond, and where one side is small: slices, positive terms only.
    Strip,
}

impl Rule {
    /// The rule for the largest squared mean over variance of the live axes.
    pub(super) fn of(largest_delta_squared: f64) -> Self {
        if largest_delta_squared == 0.0 {
            Self::Talbot14
        } else if largest_delta_squared <= 50.0 {
            Self::Parabola20
        } else if largest_delta_squared <= 100.0 {
            Self::Parabola24
        } else {
            Self::Strip
        }
    }

    /// The contour's nodes; the strip has none.
    pub(super) fn nodes(self) -> Option<&'static [Node]> {
        match self {
            Self::Talbot14 => Some(&TALBOT_14),
            Self::Parabola20 => Some(&PARABOLA_20),
            Self::Parabola24 => Some(&PARABOLA_24),
            Self::Strip => None,
        }
    }

    /// The word results carry.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Talbot14 => "talbot14",
            Self::Parabola20 => "parabola20",
            Self::Parabola24 => "parabola24",
            Self::Strip => "strip",
        }
    }
}
