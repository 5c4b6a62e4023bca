//! Is a claimed bound known to be false? Two tests with different strengths against errors that stay.
//!
//! Counting epochs outside needs to know how many of them are independent. Where an error stays for a whole recording that number is
//! one, and counting says nothing. The size of the error in units of its covariance still does: the mean over time of equally
//! distributed values, however they depend on each other, is in the convex order no larger than one of them, so that it exceeds their
//! expected shortfall at a risk p with at most that risk.

use super::INTERVAL_RISK;
use super::consistency::{Errors, Refused};
use super::correlation::{by_track, effective_size_about_zero};
use navbound_core::quantity::{OutOfDomain, Risk};
use navbound_core::special::beta::{beta_head, share_limits};

/// Largest normalised square of an epoch that counts: what a consistent covariance exceeds once in 100 000, 2 ln 1e5. A single epoch whose
/// truth is wrong by kilometres then weighs no more than another.
pub(super) const MOST_SQUARE: f64 = 23.025_850_929_940_457;

/// How large the horizontal error is in units of its covariance, and how many independent epochs it is worth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Magnitude {
    /// Epochs used.
    pub n: usize,
    /// Epochs that the components are worth about zero; the smaller of both axes.
    pub n_effective: f64,
    /// Mean of e' V^-1 e, each at most [`MOST_SQUARE`]; 2 for a consistent covariance.
    pub square_mean: f64,
    /// Largest probability of a mean as large for a consistent covariance, over every dependence of the epochs.
    pub p_value: f64,
}

/// How often a bound contained the error, and how probable as few are for a bound that keeps its risk.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Containment {
    /// Share within.
    pub coverage: f64,
    /// Exact binomial 95 % limits for the effective size.
    pub coverage_low: f64,
    /// The upper one.
    pub coverage_high: f64,
    /// Probability of as many outside under a binomial law of the effective size.
    pub p_value: f64,
    /// The same over every dependence of the epochs: risk / share outside (Markov).
    pub p_value_any: f64,
}

/// Size of the horizontal error against its covariance.
///
/// ```text
/// p = min(1, e^(1 - m/2))      m: time mean of e' V^-1 e; the expected shortfall of chi-square, 2 degrees, at p is 2 - 2 ln p
/// ```
///
/// # Errors
/// [`OutOfDomain`] for another dimension than 2 and columns of unequal length.
pub fn magnitude(errors: &Errors<'_>) -> Result<Magnitude, Refused> {
    errors.check_horizontal()?;
    let squares = errors.squares();
    let known = |row: usize| !squares[row].is_nan();
    let axis = |k: usize| effective_size_about_zero(by_track(errors.track, errors.len(), known, |row| errors.component(row, k)));
    let counted: Vec<f64> = squares.iter().filter(|s| !s.is_nan()).map(|s| s.min(MOST_SQUARE)).collect();
    Ok(magnitude_of(counted.len(), counted.iter().sum(), axis(0).min(axis(1))))
}

pub(super) fn magnitude_of(n: usize, sum: f64, n_effective: f64) -> Magnitude {
    let square_mean = sum / n as f64;
    Magnitude { n, n_effective, square_mean, p_value: (1.0 - 0.5 * square_mean).exp().min(1.0) }
}

/// How often a bound contained the error, `n_outside` of `n` epochs that are worth `n_effective`.
///
/// # Errors
/// [`OutOfDomain`] unless `0 <= n_outside <= n`, `n > 0` and `0 < n_effective <= n`.
pub fn containment(n_outside: usize, n: usize, n_effective: f64, risk: Risk) -> Result<Containment, Refused> {
    if n == 0 || n_outside > n {
        return Err((None, OutOfDomain { argument: "n_outside", value: n_outside as f64, unit: "epochs", domain: "[0, n], n > 0" }));
    }
    if !(n_effective > 0.0 && n_effective <= n as f64) {
        return Err((None, OutOfDomain { argument: "n_effective", value: n_effective, unit: "epochs", domain: "(0, n]" }));
    }
    let (share, q) = (n_outside as f64 / n as f64, risk.q());
    let hits = share * n_effective;
    let (low, high) = share_limits(hits, n_effective, INTERVAL_RISK);
    let (p_value, p_value_any) =
        if n_outside == 0 { (1.0, 1.0) } else { (beta_head(hits, n_effective - hits + 1.0, q), (q / share).min(1.0)) };
    Ok(Containment { coverage: 1.0 - share, coverage_low: 1.0 - high, coverage_high: 1.0 - low, p_value, p_value_any })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A constant error of k sigma in one axis is one draw: its square is k^2, and the bound of the probability e^(1 - k^2/2).
    #[test]
    fn a_constant_error_is_one_draw() {
        let n = 400;
        let error_m: Vec<f64> = (0..n).flat_map(|_| [4.0, 0.0]).collect();
        let covariance_m2: Vec<f64> = (0..n).flat_map(|_| [1.0, 0.0, 0.0, 1.0]).collect();
        let refutation = magnitude(&Errors { dimension: 2, error_m: &error_m, covariance_m2: &covariance_m2, track: &[] }).unwrap();
        assert_eq!((refutation.n, refutation.square_mean), (n, 16.0));
        // One epoch from the axis with the error; the other, which is zero throughout, is worth its one track.
        assert!(refutation.n_effective >= 1.0 && refutation.n_effective < 1.05, "{}", refutation.n_effective);
        assert!((refutation.p_value - (-7.0_f64).exp()).abs() <= 1e-15);
    }

    /// All outside of one effective epoch: the risk itself, by either count.
    #[test]
    fn one_epoch_outside_has_the_risk_of_its_bound() {
        let risk = Risk::new(0.05).unwrap();
        let refutation = containment(500, 500, 1.0, risk).unwrap();
        assert!((refutation.p_value - 0.05).abs() <= 1e-12 && (refutation.p_value_any - 0.05).abs() <= 1e-15);
        // 0.05^4 for four, from the binomial law.
        let refutation = containment(500, 500, 4.0, risk).unwrap();
        assert!((refutation.p_value / 6.25e-6 - 1.0).abs() <= 1e-9);
        let none = containment(0, 500, 4.0, risk).unwrap();
        assert_eq!((none.coverage, none.p_value, none.p_value_any), (1.0, 1.0, 1.0));
    }

    #[test]
    fn counts_that_cannot_be_are_refused() {
        let risk = Risk::new(0.05).unwrap();
        assert!(containment(1, 0, 1.0, risk).is_err());
        assert!(containment(3, 2, 1.0, risk).is_err());
        assert!(containment(1, 2, f64::NAN, risk).is_err());
        assert!(containment(1, 2, 3.0, risk).is_err());
    }
}
