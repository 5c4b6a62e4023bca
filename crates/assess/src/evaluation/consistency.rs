//! May the covariance be believed? Errors in units of their covariance, epoch by epoch.

use super::correlation::{by_track, effective_size_of_series};
use super::{INTERVAL_RISK, track_length};
use crate::parallel;
use navbound_core::frame::{Covariance, Displacement, Enu};
use navbound_core::monitor::consistency::{integral_transform, normalised_square, normalised_square_horizontal};
use navbound_core::quantity::{Metres, OutOfDomain};
use navbound_core::special::beta::beta_quantile;
use navbound_core::special::gamma::chi_square_factor;

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

    pub(super) fn check_horizontal(&self) -> Result<(), Refused> {
        self.check()?;
        if self.dimension != 2 {
            return Err((None, OutOfDomain { argument: "dimension", value: self.dimension as f64, unit: "1", domain: "{2}" }));
        }
        Ok(())
    }

    /// The error of one axis in units of its standard deviation, of two components an epoch.
    pub(super) fn component(&self, row: usize, axis: usize) -> f64 {
        self.error_m[2 * row + axis] / self.covariance_m2[4 * row + 3 * axis].sqrt()
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
        parallel::map(self.len(), EPOCHS_PER_TASK, |row| self.square(row).unwrap_or(f64::NAN))
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
    let n_unusable = squares.len() - series.iter().map(Vec::len).sum::<usize>();
    drop(squares);
    Ok(nees_of(series, n_unusable, errors.dimension))
}

/// The mean of squares, track by track, with its limits.
pub(super) fn nees_of(squares: Vec<Vec<f64>>, n_unusable: usize, dimension: usize) -> Consistency {
    let n: usize = squares.iter().map(Vec::len).sum();
    let nees_mean = squares.iter().flatten().sum::<f64>() / n as f64;
    let n_effective = effective_size_of_series(squares);
    let dof = n_effective * dimension as f64;
    Consistency {
        n,
        n_unusable,
        n_effective,
        dimension,
        nees_mean,
        nees_low: chi_square_factor(dof, 1.0 - 0.5 * INTERVAL_RISK) / n_effective,
        nees_high: chi_square_factor(dof, 0.5 * INTERVAL_RISK) / n_effective,
    }
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
    let squares = errors.squares();
    let series = by_track(errors.track, squares.len(), |row| !squares[row].is_nan(), |row| squares[row]);
    drop(squares);
    pit_of(series, errors.dimension, n_bins)
}

/// The histogram of squares, track by track, with its band.
pub(super) fn pit_of(mut squares: Vec<Vec<f64>>, dimension: usize, n_bins: usize) -> Result<Pit, Refused> {
    if !(2..=1000).contains(&n_bins) {
        return Err((None, OutOfDomain { argument: "n_bins", value: n_bins as f64, unit: "1", domain: "[2, 1000]" }));
    }
    let transform = |_, some: &mut [f64]| some.iter_mut().for_each(|s| *s = integral_transform(*s, dimension));
    parallel::fill(&mut squares, 1, |_, tracks| {
        tracks.iter_mut().for_each(|track| drop(parallel::fill(track, EPOCHS_PER_TASK, transform)))
    });
    // A transform that does not exist is no epoch.
    squares.iter_mut().for_each(|track| track.retain(|u| !u.is_nan()));
    squares.retain(|track| !track.is_empty());
    let mut counts = vec![0_u64; n_bins];
    for u in squares.iter().flatten() {
        counts[((u * n_bins as f64) as usize).min(n_bins - 1)] += 1;
    }
    let n: usize = squares.iter().map(Vec::len).sum();
    let n_effective = effective_size_of_series(squares);
    let (share, weight) = (1.0 / n_bins as f64, (n_effective - 1.0).max(f64::MIN_POSITIVE));
    let limit = |p: f64| n as f64 * beta_quantile(weight * share, weight * (1.0 - share), p);
    Ok(Pit { n, n_effective, counts, low: limit(0.5 * INTERVAL_RISK), high: limit(1.0 - 0.5 * INTERVAL_RISK) })
}
