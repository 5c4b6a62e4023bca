//! What a single-point position is made of, and what it is.

use super::EXCLUDED_NAMED;
use crate::frame::{Covariance, EcefPosition, Enu, Geodetic};
use crate::geometry::ionosphere::Ionosphere;
use crate::quantity::{Metres, Radians};
use crate::signal::{Constellation, SatelliteId};
use crate::solution::range_error::RangeError;
use crate::solution::wls::Dilution;
use nalgebra::{Matrix3, Vector3, Vector4};

/// A pseudorange of one satellite, ready but for what depends on the receiver's position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Which satellite.
    pub satellite: SatelliteId,
    /// Pseudorange plus satellite clock (group delay taken out) times c.
    pub corrected: Metres,
    /// Satellite at transmission, axes of transmission.
    pub position: EcefPosition,
    /// Its velocity \[m/s\].
    pub velocity_mps: Vector3<f64>,
    /// Range rate from Doppler plus satellite clock drift times c \[m/s\]; NaN where there is none.
    pub rate_mps: f64,
    /// Carrier-to-noise density \[dB-Hz\]; NaN where there is none.
    pub cn0_dbhz: f64,
    /// Ionospheric delay against that on L1; 0 for an ionosphere-free combination.
    pub ionosphere_factor: f64,
    /// Noise against that of one pseudorange.
    pub noise_factor: f64,
    /// Stated accuracy against the nominal one of its system, at least 1.
    pub ure_factor: f64,
}

/// How a position is made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Lowest elevation.
    pub mask: Radians,
    /// What corrects the ionosphere of single frequencies.
    pub ionosphere: Ionosphere,
    /// Weights.
    pub errors: RangeError,
    /// Risk of a false alarm of the residual test.
    pub false_alarm: f64,
    /// Most satellites that may be excluded.
    pub most_excluded: usize,
}

/// A position and what it rests on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fix {
    /// Where.
    pub position: Geodetic,
    /// Covariance of the position, by the weights; inflated by the residuals where the test fails.
    pub covariance: Covariance<Enu>,
    /// Dilution of precision of the satellites used.
    pub dilution: Dilution,
    /// Receiver clock against each constellation's time \[m\], NaN where none of its satellites is used.
    pub clock_m: [f64; Constellation::ALL.len()],
    /// Velocity, east, north, up \[m/s\], and its covariance \[m²/s²\], where Doppler allows.
    pub velocity: Option<(Vector3<f64>, Matrix3<f64>)>,
    /// Satellites used.
    pub n_used: usize,
    /// Satellites above the mask that were excluded.
    pub n_excluded: usize,
    /// The first of them.
    pub excluded: [Option<SatelliteId>; EXCLUDED_NAMED],
    /// Sum of the weighted squared residuals, and ranges beyond the unknowns, with every range above the mask.
    pub before_exclusion: (f64, usize),
    /// Factor by which the residuals widened the covariance of the weights.
    pub inflation: f64,
    /// Risk that residuals as large as these, or larger, come from errors as the weights say; NaN without redundancy.
    pub residual_risk: f64,
    /// Ranges beyond the unknowns.
    pub redundancy: usize,
    /// The residuals agree with the weights, after exclusion where there was any; without redundancy nothing can be said.
    pub consistent: bool,
}

/// A range of a solution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Used {
    /// Its place among the epoch's ranges.
    pub index: usize,
    /// Unit vector from the receiver to the satellite, east-north-up.
    pub unit: Vector3<f64>,
    /// 1 / sigma² by the error model \[1/m²\].
    pub weight: f64,
    /// Measured less computed range at the position found; what the receiver's clock makes of it is in it.
    pub residual: Metres,
    /// Standard deviations here of the errors that all ranges have in common: the vertical ionosphere, its gradient east and north, the
    /// zenith troposphere \[m\].
    pub shared_m: Vector4<f64>,
}
