//! Bounds and covariances against truth: does the bound bound, how sharp is it, may the covariance be believed?
//!
//! Coverage here is a share of epochs. What repeats from epoch to epoch (the error given the estimate, or the estimate given the truth)
//! is the caller's knowledge; docs/methods/coverage.md says why the two shares differ.

mod bootstrap;
mod consistency;
mod correlation;
pub mod pieces;
mod refutation;

pub use bootstrap::{coverage_interval, coverage_interval_of_counts};
pub use consistency::{Consistency, Errors, Pit, nees, pit};
pub use correlation::{effective_size, effective_size_about_zero};
pub use refutation::{Containment, Magnitude, containment, magnitude};

use navbound_core::quantity::{OutOfDomain, Risk};
use navbound_core::special::beta::share_limits;

/// Risk of every interval this module reports: 95 %.
pub const INTERVAL_RISK: f64 = 0.05;

/// How one bound did.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoundScore {
    /// Epochs with a bound and an error.
    pub n: usize,
    /// Epochs with an error but no bound.
    pub n_without_bound: usize,
    /// Epochs whose error is not within the bound.
    pub n_outside: usize,
    /// Epochs the coverage is worth, see [`effective_size`].
    pub n_effective: f64,
    /// Share of epochs within.
    pub coverage: f64,
    /// Its exact binomial limits for the effective sample size.
    pub coverage_low: f64,
    /// The upper one.
    pub coverage_high: f64,
    /// Mean bound: sharpness \[m\].
    pub mean_m: f64,
    /// Median bound \[m\].
    pub median_m: f64,
    /// Largest bound \[m\].
    pub max_m: f64,
    /// Mean interval score of `[-bound, bound]` \[m\]; smaller is better, and no other bound than the true quantile has a smaller mean.
    pub winkler_m: f64,
    /// Mean pinball loss of the bound as the quantile 1 - risk of |error| \[m\].
    pub pinball_m: f64,
}

/// Sums of a bound's epochs that may be formed in parts and merged in any order.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BoundSums {
    n: usize,
    n_without_bound: usize,
    n_outside: usize,
    sum_m: f64,
    max_m: f64,
    excess_m: f64,
    room_m: f64,
}

impl BoundSums {
    /// One more epoch; an error that is NaN is no epoch.
    pub fn add(&mut self, error_m: f64, bound_m: f64) {
        if error_m.is_nan() {
            return;
        }
        if bound_m.is_nan() {
            self.n_without_bound += 1;
            return;
        }
        let excess = error_m.abs() - bound_m;
        self.n += 1;
        self.n_outside += usize::from(excess > 0.0);
        self.sum_m += bound_m;
        self.max_m = self.max_m.max(bound_m);
        self.excess_m += excess.max(0.0);
        self.room_m += (-excess).max(0.0);
    }

    /// Both together.
    pub fn merged(&self, other: &Self) -> Self {
        Self {
            n: self.n + other.n,
            n_without_bound: self.n_without_bound + other.n_without_bound,
            n_outside: self.n_outside + other.n_outside,
            sum_m: self.sum_m + other.sum_m,
            max_m: self.max_m.max(other.max_m),
            excess_m: self.excess_m + other.excess_m,
            room_m: self.room_m + other.room_m,
        }
    }

    /// Epochs counted.
    pub fn n(&self) -> usize {
        self.n
    }

    /// The scores, with the effective sample size and the median from elsewhere. NaN where nothing was counted.
    ///
    /// ```text
    /// winkler = 2 B + 2/q (|e| - B)+                      Winkler 1972, interval [-B, B] of risk q
    /// pinball = (1 - q) (|e| - B)+ + q (B - |e|)+         quantile 1 - q of |e|
    /// ```
    pub fn score(&self, risk: Risk, n_effective: f64, median_m: f64) -> BoundScore {
        let (n, q) = (self.n as f64, risk.q());
        let outside = self.n_outside as f64 / n;
        let (low, high) = share_limits(outside * n_effective, n_effective, INTERVAL_RISK);
        BoundScore {
            n: self.n,
            n_without_bound: self.n_without_bound,
            n_outside: self.n_outside,
            n_effective,
            coverage: 1.0 - outside,
            coverage_low: 1.0 - high,
            coverage_high: 1.0 - low,
            mean_m: self.sum_m / n,
            median_m,
            max_m: if self.n == 0 { f64::NAN } else { self.max_m },
            winkler_m: (2.0 * self.sum_m + 2.0 / q * self.excess_m) / n,
            pinball_m: ((1.0 - q) * self.excess_m + q * self.room_m) / n,
        }
    }
}

/// How a bound at a risk did against the error, epoch by epoch. `track` says which epochs follow each other; empty means all do.
///
/// # Errors
/// [`OutOfDomain`] for columns of unequal length, and for a bound below zero or not finite.
pub fn bound(error_m: &[f64], bound_m: &[f64], risk: Risk, track: &[u32]) -> Result<BoundScore, (Option<usize>, OutOfDomain)> {
    same_length("bound_m", bound_m.len(), error_m.len())?;
    track_length(track, error_m.len())?;
    require_bounds(bound_m)?;
    let mut sums = BoundSums::default();
    error_m.iter().zip(bound_m).for_each(|(e, b)| sums.add(*e, *b));
    let judged = |row: usize| !error_m[row].is_nan() && !bound_m[row].is_nan();
    let series = correlation::by_track(track, error_m.len(), judged, |row| error_m[row]);
    let mut bounds: Vec<f64> = (0..error_m.len()).filter(|row| judged(*row)).map(|row| bound_m[row]).collect();
    Ok(sums.score(risk, effective_size(&series), median(&mut bounds)))
}

/// Effective sample size of a column, NaN left out, see [`effective_size`] and [`effective_size_about_zero`].
///
/// # Errors
/// [`OutOfDomain`] for a track column of another length.
pub fn effective_size_of(values: &[f64], track: &[u32], about_zero: bool) -> Result<f64, (Option<usize>, OutOfDomain)> {
    track_length(track, values.len())?;
    let series = correlation::by_track(track, values.len(), |row| !values[row].is_nan(), |row| values[row]);
    Ok(if about_zero { effective_size_about_zero(series) } else { effective_size(&series) })
}

fn require_bounds(bound_m: &[f64]) -> Result<(), (Option<usize>, OutOfDomain)> {
    match bound_m.iter().position(|b| *b < 0.0 || b.is_infinite()) {
        Some(row) => {
            Err((Some(row), OutOfDomain { argument: "bound_m", value: bound_m[row], unit: "m", domain: "[0, inf), NaN for none" }))
        }
        None => Ok(()),
    }
}

/// The middle value, or the mean of the two; NaN of none.
fn median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return f64::NAN;
    }
    let half = values.len() / 2;
    let even = values.len().is_multiple_of(2);
    let (below, middle, _) = values.select_nth_unstable_by(half, f64::total_cmp);
    let middle = *middle;
    if even { 0.5 * (middle + below.iter().copied().fold(f64::NEG_INFINITY, f64::max)) } else { middle }
}

fn same_length(argument: &'static str, actual: usize, expected: usize) -> Result<(), (Option<usize>, OutOfDomain)> {
    if actual == expected {
        return Ok(());
    }
    Err((None, OutOfDomain { argument, value: actual as f64, unit: "rows", domain: "the number of errors" }))
}

fn track_length(track: &[u32], expected: usize) -> Result<(), (Option<usize>, OutOfDomain)> {
    if track.is_empty() { Ok(()) } else { same_length("track", track.len(), expected) }
}
