//! What a method declares about itself.

use crate::quantity::{Metres, Provenance, Risk, Unavailable};
use crate::solution::Epoch;

/// A method: how to bound one error at one risk, where it comes from, and what it promises.
#[derive(Debug)]
pub struct Method {
    /// Command-line choice, column prefix and page name, e.g. `tse-exact`; its column is `tse_exact_m`.
    pub id: &'static str,
    /// Legend text.
    pub title: &'static str,
    /// Document and equation; printed by every report.
    pub source: &'static str,
    /// How we hold the formula.
    pub provenance: Provenance,
    /// Which error the number bounds, and so what it may be compared with.
    pub bounds: Bounded,
    /// What must be true for the stated risk to be true, in words.
    pub assumes: &'static str,
    /// What the contract test checks.
    pub promises: Promises,
    /// The bound of one epoch.
    pub bound: fn(&Epoch, Risk) -> Result<Metres, Unavailable>,
}

/// The error a bound bounds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Bounded {
    /// |FTE + NSE| across the path: total system error.
    LateralTse,
    /// The same in the vertical.
    VerticalTse,
    /// Length of the horizontal navigation error.
    HorizontalNse,
    /// Length of the three-dimensional navigation error.
    SpatialNse,
    /// |navigation error| along the course.
    AlongNse,
    /// |navigation error| across the course.
    CrossNse,
    /// |navigation error| upwards.
    VerticalNse,
    /// |navigation error| eastwards.
    EastNse,
    /// |navigation error| northwards.
    NorthNse,
}

impl Bounded {
    /// The column of the epoch table that holds this error when truth is known; magnitudes are compared.
    pub const fn error_column(self) -> &'static str {
        match self {
            Self::LateralTse => "tse_m",
            Self::VerticalTse => "tse_v_m",
            Self::HorizontalNse => "nse_h_m",
            Self::SpatialNse => "nse_3d_m",
            Self::AlongNse => "nse_along_m",
            Self::CrossNse => "nse_cross_m",
            Self::VerticalNse => "nse_u_m",
            Self::EastNse => "nse_e_m",
            Self::NorthNse => "nse_n_m",
        }
    }
}

/// Promises that `tests/contract.rs` holds every method to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Promises {
    /// Doubling every length doubles the bound.
    pub scales_with_length: bool,
    /// Turning north (offset, covariance and course together) changes nothing.
    pub ignores_north: bool,
    /// A smaller risk never gives a smaller bound.
    pub monotone_in_risk: bool,
    /// The true risk at the bound never exceeds the stated one under the method's assumptions.
    pub conservative: bool,
    /// May feed an alert. Experimental bounds and `*_as_printed` exhibits may not.
    pub may_alert: bool,
}
