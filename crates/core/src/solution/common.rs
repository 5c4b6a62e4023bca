//! Errors that all ranges of an epoch have in common: columns of what each does to a range, and what they do to a solution.
//!
//! A common error is no fault of a range and does not average out with more of them. It is declared in the covariance and in the residual
//! test; the position is not weighted with it. Provenance: derived (least squares, Woodbury); sizes inferred, see [`CommonErrors`].

use super::wls::{Normal, Row};
use crate::geometry::ionosphere::{Kind, MEAN_ACTIVITY_SFU, Overhead, SPREAD_ACTIVITY_SFU};
use crate::geometry::ntcm;
use crate::signal::Constellation;
use crate::special::float::{hypot, sqrt};
use nalgebra::{Matrix3, Matrix4, SMatrix, Vector3, Vector4};

/// Vertical ionosphere, its gradient east and north, zenith troposphere.
pub const COMMON: usize = 4;
const CLOCKS: usize = Constellation::ALL.len();
/// Earth and shell of the ionosphere \[Mm\]: DO-229 A.4.4.10.4 (standard).
const EARTH_MM: f64 = 6.378_136_3;
const SHELL_MM: f64 = EARTH_MM + 0.35;

/// How large the common errors are, as shares of what the model of the ionosphere states.
///
/// ```text
/// s_v^2 = (vertical_share I)^2 + (activity_share A)^2 (+ ntcm_floor^2 for NTCM-G)
/// s_E^2 = (gradient_share I)^2 + (gradient_activity_share A)^2      per Mm of distance to the pierce point
/// s_N   = s_E, times anomaly_share / gradient_share near the magnetic equator
/// s_T   = zenith_troposphere
/// ```
///
/// I is the model's vertical delay at the receiver, A the activity that the message states. Without a message I and A are those of a sun
/// one standard deviation more active than the mean, and the change of I that this makes is added to `s_v`; where nothing is corrected, the
/// whole of the mean I.
///
/// Every number is inferred from common errors at true positions, see `docs/methods/gnss-positions.md`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CommonErrors {
    /// Factor on every standard deviation, for a calibration on other data.
    pub factor: f64,
    /// Share of the vertical delay.
    pub vertical_share: f64,
    /// Share of the stated activity, at any hour.
    pub activity_share: f64,
    /// Gradient as a share of the vertical delay \[1/Mm\].
    pub gradient_share: f64,
    /// Gradient as a share of the stated activity \[1/Mm\].
    pub gradient_activity_share: f64,
    /// North-south gradient as a share of the vertical delay, below [`Self::anomaly_rad`] of magnetic latitude \[1/Mm\].
    pub anomaly_share: f64,
    /// Magnetic latitude below which the crests of the equatorial anomaly are near \[rad\].
    pub anomaly_rad: f64,
    /// Least error of NTCM-G overhead \[m\].
    pub ntcm_floor_m: f64,
    /// Error of the zenith tropospheric delay \[m\].
    pub zenith_troposphere_m: f64,
    /// What a plane does not describe, from satellite to satellite: share of `s_v`.
    pub unevenness: f64,
    /// What a plane does not describe far out: share of the larger gradient, by the square of the distance to the pierce point \[1/Mm\].
    pub curvature: f64,
}

/// Standard deviations of the common errors over a receiver at an instant.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Sizes {
    /// Vertical delay \[m\], gradient east and north \[m/Mm\], zenith troposphere \[m\].
    pub(crate) sigma: Vector4<f64>,
    /// What the common errors leave to single satellites, overhead \[m\].
    pub(crate) uneven_m: f64,
    /// The same of a pierce point far out, by the square of its distance \[m/Mm²\].
    pub(crate) curved_m: f64,
}

impl CommonErrors {
    /// The default. Inferred.
    pub const CALIBRATED: Self = Self {
        factor: 1.0,
        vertical_share: 0.25,
        activity_share: 0.10,
        gradient_share: 0.20,
        gradient_activity_share: 0.08,
        anomaly_share: 0.35,
        anomaly_rad: 35.0 * core::f64::consts::PI / 180.0,
        ntcm_floor_m: 0.5,
        zenith_troposphere_m: 0.10,
        unevenness: 0.3,
        curvature: 0.25,
    };

    /// Over a receiver.
    pub(crate) fn sizes(&self, over: &Overhead) -> Sizes {
        let unknown = matches!(over.kind, Kind::Climatology | Kind::Uncorrected);
        let spread = if unknown { SPREAD_ACTIVITY_SFU * ntcm::sensitivity(MEAN_ACTIVITY_SFU) * over.vertical_m } else { 0.0 };
        let whole = if over.kind == Kind::Uncorrected { over.vertical_m } else { 0.0 };
        let delay = over.vertical_m + spread;
        let activity = over.activity_m * if unknown { 1.0 + SPREAD_ACTIVITY_SFU / MEAN_ACTIVITY_SFU } else { 1.0 };
        let floor = if over.kind == Kind::Broadcast { 0.0 } else { self.ntcm_floor_m };
        let vertical = root_sum([self.vertical_share * delay, self.activity_share * activity, floor, spread, whole]);
        // The crests stay when the modelled delay has gone down for the night: the larger share counts for the stated activity, too.
        let steeper = if over.magnetic_lat.abs() < self.anomaly_rad { self.anomaly_share / self.gradient_share } else { 1.0 };
        let east = root_sum([self.gradient_share * delay, self.gradient_activity_share * activity]);
        let north = steeper * east;
        Sizes {
            sigma: self.factor * Vector4::new(vertical, east, north, self.zenith_troposphere_m),
            uneven_m: self.unevenness * vertical,
            curved_m: self.curvature * east.max(north),
        }
    }
}

fn root_sum<const N: usize>(parts: [f64; N]) -> f64 {
    sqrt(parts.iter().map(|p| p * p).sum())
}

impl Sizes {
    /// What the common errors leave to a satellite with that pierce point, overhead \[m\]: uneven everywhere, and curved far out.
    pub(crate) fn left_m(&self, [east, north]: [f64; 2]) -> f64 {
        hypot(self.uneven_m, self.curved_m * (east * east + north * north))
    }

    /// What each common error of one standard deviation does to a range \[m\]: `sqrt(M) [kF, kF d sin a, kF d cos a, m(E)]`, from the slant
    /// factor `kF` (`k` the ionosphere of its carrier against L1, 0 for a pair), the pierce point and the mapping of the troposphere.
    pub(crate) fn column(&self, slant: f64, [east, north]: [f64; 2], troposphere_mapping: f64) -> Vector4<f64> {
        self.sigma.component_mul(&Vector4::new(slant, slant * east, slant * north, troposphere_mapping))
    }
}

/// Obliquity of the ionosphere as a shell 350 km up, and the distance of the pierce point east and north \[Mm\].
///
/// ```text
/// F   = 1 / sqrt(1 - (R cos E / (R + h))^2)                     DO-229 A.4.4.10.4, standard
/// psi = pi/2 - E - asin(R cos E / (R + h)),   d = (R + h) psi    derived
/// ```
///
/// sin psi is taken as cos E (1/F - R / (R + h) sin E), which loses no digits overhead.
pub(crate) fn pierce(unit: &Vector3<f64>) -> (f64, [f64; 2]) {
    const RATIO: f64 = EARTH_MM / SHELL_MM;
    let level_squared = 1.0 - unit.z * unit.z;
    let root = sqrt(1.0 - RATIO * RATIO * level_squared);
    let over = root - RATIO * unit.z;
    let sin_psi = over * sqrt(level_squared.max(0.0));
    let arc = arc_over_sine(sin_psi * sin_psi);
    let reach = SHELL_MM * arc * over;
    (1.0 / root, [reach * unit.x, reach * unit.y])
}

/// asin(s) / s by its series in s^2. Above the horizon s is below 0.32, and the next term below 1e-12.
fn arc_over_sine(q: f64) -> f64 {
    // (2n)! / (4^n n!^2 (2n + 1)), n from 10 to 1.
    const TERMS: [f64; 10] = [
        46_189.0 / 5_505_024.0,
        12_155.0 / 1_245_184.0,
        6_435.0 / 557_056.0,
        143.0 / 10_240.0,
        231.0 / 13_312.0,
        63.0 / 2_816.0,
        35.0 / 1_152.0,
        5.0 / 112.0,
        3.0 / 40.0,
        1.0 / 6.0,
    ];
    TERMS.iter().fold(0.0, |sum, term| q * (term + sum)) + 1.0
}

/// A range as the least-squares solution leaves it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Left {
    pub(crate) row: Row,
    /// Its column of common errors, [`Sizes::column`].
    pub(crate) common: Vector4<f64>,
    /// Residual after the fit, its clock taken out \[m\].
    pub(crate) residual: f64,
}

/// The common errors in one solution.
#[derive(Debug, Clone, Copy)]
pub(crate) struct InSolution {
    inverse: Matrix3<f64>,
    /// What each does to the position, as columns \[m\].
    moved: SMatrix<f64, 3, COMMON>,
    /// Weighted mean of the columns of each clock's ranges, which the clock absorbs.
    mean: [Vector4<f64>; CLOCKS],
    /// (I + K)^-1, K the information on the common errors that the residuals hold.
    unseen: Matrix4<f64>,
    /// The common errors as the residuals estimate them, in standard deviations.
    estimate: Vector4<f64>,
    /// q = r' R^-1 r.
    pub(crate) statistic: f64,
}

impl InSolution {
    /// From the ranges of a solution.
    ///
    /// ```text
    /// b~ = b - what the least-squares solution takes of it,   K = sum w b~ b~',   g = sum w b~ v
    /// R  = W^-1 + B B'  projected on the residuals;   q = sum w v^2 - g' (I + K)^-1 g       Woodbury; derived
    /// ```
    ///
    /// I + K is never singular, and K is a sum of squares: no digits are lost by differences. `None` where the geometry is singular.
    pub(crate) fn new(normal: &Normal, ranges: impl Iterator<Item = Left> + Clone) -> Option<Self> {
        let inverse = normal.inverse()?;
        let moved = inverse * normal.sides(ranges.clone().map(|r| (r.row, r.common)));
        let mut mean = [Vector4::zeros(); CLOCKS];
        for r in ranges.clone() {
            mean[r.row.clock] += r.row.weight * r.common;
        }
        for (clock, mean) in mean.iter_mut().enumerate() {
            *mean *= normal.share(clock);
        }
        let mut solution = Self { inverse, moved, mean, unseen: Matrix4::zeros(), estimate: Vector4::zeros(), statistic: 0.0 };
        let (mut information, mut side, mut plain) = (Matrix4::identity(), Vector4::zeros(), 0.0);
        for r in ranges {
            let left = solution.left(normal, &r);
            information += (r.row.weight * left) * left.transpose();
            side += (r.row.weight * r.residual) * left;
            plain += r.row.weight * r.residual * r.residual;
        }
        solution.unseen = information.cholesky()?.inverse();
        solution.estimate = solution.unseen * side;
        solution.statistic = (plain - side.dot(&solution.estimate)).max(0.0);
        Some(solution)
    }

    /// Covariance of the position that comes of the common errors \[m²\].
    pub(crate) fn covariance(&self) -> Matrix3<f64> {
        self.moved * self.moved.transpose()
    }

    /// By how much the statistic falls without a range: (A r)_i^2 / A_ii, A = R^-1 projected, exactly.
    pub(crate) fn fall(&self, normal: &Normal, range: &Left) -> f64 {
        let left = self.left(normal, range);
        let weight = range.row.weight;
        let rest = 1.0 - normal.leverage(&self.inverse, &range.row) - weight * left.dot(&(self.unseen * left));
        let pull = range.residual - left.dot(&self.estimate);
        // A range that nothing else checks leaves no residual to judge it by.
        if rest > 1e-6 { weight * pull * pull / rest } else { 0.0 }
    }

    /// What the solution leaves of the common errors in a range's residual \[m\].
    fn left(&self, normal: &Normal, range: &Left) -> Vector4<f64> {
        range.common - self.mean[range.row.clock] + self.moved.transpose() * normal.centred(&range.row)
    }
}

#[cfg(test)]
#[path = "common_tests.rs"]
mod tests;
