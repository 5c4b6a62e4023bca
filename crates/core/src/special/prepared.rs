//! The folded normal's quantile at one risk as a table of polynomials: worked out once, then a few operations an epoch.

use super::float::exp;
use super::folded::FoldedQuantile;
use super::normal::{density, one_sided_factor};
use crate::quantity::Risk;
use core::array::from_fn;

/// Polynomials in the table; a power of two, so that an index can be masked instead of checked.
const PIECES: usize = 512;
/// Coefficients of one polynomial.
const TERMS: usize = 5;
/// Terms of the Taylor series a polynomial is economised from.
const SERIES: usize = 9;
/// 2^52: adding it rounds a small number to an integer that then stands in the lowest bits.
const ROUND: f64 = 4_503_599_627_370_496.0;
/// What is left of the far tail at the end of the table, as a share of the excess.
const LEFT_OVER: f64 = 1e-17;

/// Prepared quantiles of the folded normal law at one risk.
///
/// The excess u(m) of [`FoldedQuantile::excess`] is smooth: u' = -2 r / (1 + r) with r = exp(-2 m (u + m)), so its nearest
/// singularities are where 2 m (u + m) is i pi, and beyond a few deviations it is constant. The table covers that range with
/// polynomials around equally spaced ratios, each economised from the Taylor series that the differential equation gives.
#[derive(Debug, Clone, PartialEq)]
pub struct PreparedQuantile {
    pieces_per_ratio: f64,
    pieces: [[f64; TERMS]; PIECES],
}

impl PreparedQuantile {
    /// Work out the table of one risk.
    pub fn new(risk: Risk) -> Self {
        let law = FoldedQuantile::new(risk);
        let z = law.one_sided();
        let reach = 0.5 * (one_sided_factor((LEFT_OVER * density(z)).max(1e-300)) - z);
        let width = reach / (PIECES - 1) as f64;
        let mut pieces = [[0.0; TERMS]; PIECES];
        let mut centre = law.two_sided();
        for (index, piece) in pieces.iter_mut().enumerate() {
            let series = taylor(centre, index as f64 * width, width);
            *piece = economised(series);
            // The series reaches the next centre with all but its last digits; one step restores those.
            centre = law.halley(series.iter().rev().fold(0.0, |sum, c| sum + c), (index + 1) as f64 * width);
        }
        Self { pieces_per_ratio: 1.0 / width, pieces }
    }

    /// The excess u at `ratio` m >= 0. A ratio of infinity, or NaN from zero over zero, reads the end of the table.
    #[inline]
    pub fn excess(&self, ratio: f64) -> f64 {
        self.excesses([ratio])[0]
    }

    /// The excesses of several ratios, step by step side by side, so that the compiler can take them together.
    #[inline(always)]
    pub fn excesses<const N: usize>(&self, ratios: [f64; N]) -> [f64; N] {
        const LAST: f64 = (PIECES - 1) as f64;
        // Written so that NaN is not below the end, and so that it becomes one instruction.
        let places = ratios.map(|m| if m * self.pieces_per_ratio < LAST { m * self.pieces_per_ratio } else { LAST });
        let rounded = places.map(|place| place + ROUND);
        let pieces = rounded.map(|r| &self.pieces[r.to_bits() as usize & (PIECES - 1)]);
        let x: [f64; N] = from_fn(|i| places[i] - (rounded[i] - ROUND));
        let mut sum = pieces.map(|c| c[TERMS - 1]);
        for term in (0..TERMS - 1).rev() {
            let coefficients = pieces.map(|c| c[term]);
            sum = from_fn(|i| coefficients[i] + x[i] * sum[i]);
        }
        sum
    }
}

/// Taylor coefficients of u((index + x) width) in x, from (1 + r) u' = -2 r, r = exp(-2 m (u + m)).
fn taylor(centre: f64, ratio: f64, width: f64) -> [f64; SERIES] {
    let (mut u, mut sum, mut g, mut r, mut slope) = ([0.0; SERIES], [0.0; SERIES], [0.0; SERIES], [0.0; SERIES], [0.0; SERIES]);
    u[0] = centre;
    for n in 0..SERIES {
        sum[n] = u[n] + if n == 0 { ratio } else { 0.0 } + if n == 1 { width } else { 0.0 };
        g[n] = -2.0 * (ratio * sum[n] + if n > 0 { width * sum[n - 1] } else { 0.0 });
        r[n] = if n == 0 { exp(g[0]) } else { (1..=n).map(|j| j as f64 * g[j] * r[n - j]).sum::<f64>() / n as f64 };
        let carried: f64 = (1..=n).map(|j| r[j] * slope[n - j]).sum();
        slope[n] = (-2.0 * width * r[n] - carried) / (1.0 + r[0]);
        if n + 1 < SERIES {
            u[n + 1] = slope[n] / (n + 1) as f64;
        }
    }
    u
}

/// The series on |x| <= 1/2 with its highest powers traded for lower ones by Chebyshev polynomials: the same function to
/// a 2^(n-1)-th part of each power dropped.
fn economised(mut series: [f64; SERIES]) -> [f64; TERMS] {
    for n in (TERMS..SERIES).rev() {
        let chebyshev = chebyshev_half(n);
        let share = series[n] / chebyshev[n];
        for j in 0..=n {
            series[j] -= share * chebyshev[j];
        }
    }
    let mut kept = [0.0; TERMS];
    kept.copy_from_slice(&series[..TERMS]);
    kept
}

/// Coefficients of the Chebyshev polynomial T_n(2 x).
fn chebyshev_half(n: usize) -> [f64; SERIES] {
    let (mut before, mut last) = ([0.0; SERIES], [0.0; SERIES]);
    before[0] = 1.0;
    last[1] = 2.0;
    for _ in 1..n {
        let mut next = [0.0; SERIES];
        for j in 0..SERIES {
            next[j] = if j > 0 { 4.0 * last[j - 1] } else { 0.0 } - before[j];
        }
        (before, last) = (last, next);
    }
    last
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Worst relative error of the bound m + u against the iterative solver.
    fn worst(q: f64, ratios: impl Iterator<Item = f64>) -> f64 {
        let risk = Risk::new(q).unwrap();
        let (prepared, law) = (PreparedQuantile::new(risk), FoldedQuantile::new(risk));
        ratios.map(|m| ((prepared.excess(m) - law.excess(m)) / (m + law.excess(m))).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn the_table_meets_the_iterative_solver_at_every_risk_and_ratio() {
        for step in 0..=60 {
            let q = 0.5 * crate::special::float::exp(-0.34 * f64::from(step));
            let dense = (0..20_000).map(|i| 0.000_25 * f64::from(i));
            let far = (0..200).map(|i| crate::special::float::exp(0.1 * f64::from(i) - 6.0));
            let error = worst(q, dense.chain(far));
            assert!(error <= 1e-13, "q = {q:e}: {error:e}");
        }
    }

    #[test]
    fn the_ends_of_the_table_are_the_two_factors() {
        for q in [1e-15, 1e-9, 1e-5, 0.05, 0.5] {
            let (table, law) = (PreparedQuantile::new(Risk::new(q).unwrap()), FoldedQuantile::new(Risk::new(q).unwrap()));
            assert!((table.excess(0.0) - law.two_sided()).abs() <= 1e-15 * law.two_sided(), "{q}");
            for far in [1e3, 1e6, f64::INFINITY, f64::NAN] {
                assert!((table.excess(far) - law.one_sided()).abs() <= 1e-15 * law.two_sided(), "{q}");
            }
        }
    }
}
