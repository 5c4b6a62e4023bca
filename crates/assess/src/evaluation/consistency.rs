//! May the covariance be believed? Errors in units of their covariance, epoch by epoch.

use super::correlation::{by_track, effective_size};
use super::{INTERVAL_RISK, track_length};
use navbound_core::frame::{Covariance, Displacement, Enu};
use navbound_core::monitor::consistency::{integral_transform, normalised_square, normalised_square_horizontal};
use navbound_core::quantity::{Metres, OutOfDomain};
use navbound_core::special::beta::beta_quantile;
use navbound_core::special::gamma::chi_square_factor;
use rayon::prelude::*;

/// Epochs in one task of the pool.
const EPOCHS_PER_TASK: usize = 4096;

/// Mean normalised square, and what a consistent covariance would give.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Consistency {
    /// Epochs used.
    pub n: usize,
    /// Epochs without an error, or with a covariance that is singular or not a number.
    pub n_unusable: usize,
    /// Epochs the mean is worth.
    pub n_effective: f64,
    /// 2 or 3: what the mean is for a consistent covariance.
    pub dimension: usize,
    /// Mean of e' V^-1 e.
    pub nees_mean: f64,
    /// Chi-square limits (95 %) of the mean for the effective sample size.
    pub nees_low: f64,
    /// The upper one.
    pub nees_high: f64,
}

/// Histogram of the probability integral transform.
#[derive(Debug, Clone, PartialEq)]
pub struct Pit {
    /// Epochs used.
    pub n: usize,
    /// Epochs it is worth.
    pub n_effective: f64,
    /// Epochs in each of equal bins.
    pub counts: Vec<u64>,
    /// Band (95 %) of one bin for a consistent covariance, in epochs.
    pub low: f64,
    /// The upper one.
    pub high: f64,
}

/// Errors and covariances of epochs, row after row.
#[derive(Debug, Clone, Copy)]
pub struct Errors<'a> {
    /// Components an epoch, 2 (east, north) or 3 (and up).
    pub dimension: usize,
    /// `dimension` numbers an epoch.
    pub error_m: &'a [f64],
    /// `dimension` squared numbers an epoch.
    pub covariance_m2: &'a [f64],
    /// Track of each epoch; empty when all follow each other.
    pub track: &'a [u32],
}

pub(super) type Refused = (Option<usize>, OutOfDomain);

impl Errors<'_> {
    pub(super) fn len(&self) -> usize {
        self.error_m.len() / self.dimension
    }

    pub(super) fn check(&self) -> Result<(), Refused> {
        if !(2..=3).contains(&self.dimension) {
            return Err((None, OutOfDomain { argument: "dimension", value: self.dimension as f64, unit: "1", domain: "{2, 3}" }));
        }
        super::same_length("covariance", self.covariance_m2.len(), self.error_m.len() * self.dimension)?;
        track_length(self.track, self.len())
    }

    fn square(&self, row: usize) -> Option<f64> {
        let d = self.dimension;
        let e = &self.error_m[row * d..][..d];
        let v = &self.covariance_m2[row * d * d..][..d * d];
        let up = if d == 3 { e[2] } else { 0.0 };
        let error = Displacement::<Enu>::new(Metres::new(e[0]), Metres::new(e[1]), Metres::new(up));
        if d == 3 {
            let rows = [v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7], v[8]];
            return normalised_square(&error, &Covariance::from_rows(rows).ok()?);
        }
        let rows = [v[0], v[1], 0.0, v[2], v[3], 0.0, 0.0, 0.0, 0.0];
        normalised_square_horizontal(&error, &Covariance::from_rows(rows).ok()?)
    }

    /// Normalised squares, NaN where there is none.
    pub(super) fn squares(&self) -> Vec<f64> {
        let rows = (0..self.len()).into_par_iter().with_min_len(EPOCHS_PER_TASK);
        rows.map(|row| self.square(row).unwrap_or(f64::NAN)).collect()
    }
}

/// Mean of e' V^-1 e against its chi-square limits.
///
/// # Errors
/// [`OutOfDomain`] for a dimension other than 2 or 3 and columns of unequal length.
pub fn nees(errors: &Errors<'_>) -> Result<Consistency, Refused> {
    errors.check()?;
    let squares = errors.squares();
    let series = by_track(errors.track, squares.len(), |row| !squares[row].is_nan(), |row| squares[row]);
    let n: usize = series.iter().map(Vec::len).sum();
    let n_effective = effective_size(&series);
    let dof = n_effective * errors.dimension as f64;
    Ok(Consistency {
        n,
        n_unusable: squares.len() - n,
        n_effective,
        dimension: errors.dimension,
        nees_mean: series.iter().flatten().sum::<f64>() / n as f64,
        nees_low: chi_square_factor(dof, 1.0 - 0.5 * INTERVAL_RISK) / n_effective,
        nees_high: chi_square_factor(dof, 0.5 * INTERVAL_RISK) / n_effective,
    })
}

/// Histogram of the probability integral transform of e' V^-1 e in `n_bins` equal bins.
///
/// The band of a bin is that of a beta law with the mean and variance of a share of `n_effective` draws, which unlike the binomial
/// exists for any effective size.
///
/// # Errors
/// As [`nees`], and [`OutOfDomain`] unless there are 2 to 1000 bins.
pub fn pit(errors: &Errors<'_>, n_bins: usize) -> Result<Pit, Refused> {
    errors.check()?;
    if !(2..=1000).contains(&n_bins) {
        return Err((None, OutOfDomain { argument: "n_bins", value: n_bins as f64, unit: "1", domain: "[2, 1000]" }));
    }
    let dimension = errors.dimension;
    let transform: Vec<f64> = errors.squares().par_iter().map(|s| integral_transform(*s, dimension)).collect();
    let mut counts = vec![0_u64; n_bins];
    for u in transform.iter().filter(|u| !u.is_nan()) {
        counts[((u * n_bins as f64) as usize).min(n_bins - 1)] += 1;
    }
    let series = by_track(errors.track, transform.len(), |row| !transform[row].is_nan(), |row| transform[row]);
    let n: usize = series.iter().map(Vec::len).sum();
    let n_effective = effective_size(&series);
    let (share, weight) = (1.0 / n_bins as f64, (n_effective - 1.0).max(f64::MIN_POSITIVE));
    let limit = |p: f64| n as f64 * beta_quantile(weight * share, weight * (1.0 - share), p);
    Ok(Pit { n, n_effective, counts, low: limit(0.5 * INTERVAL_RISK), high: limit(1.0 - 0.5 * INTERVAL_RISK) })
}
