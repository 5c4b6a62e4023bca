//! The exact bound at one risk from a table of polynomials: worked out once, then a few operations an epoch.

use super::folded::FoldedQuantile;
use crate::quantity::Risk;
use core::f64::consts::FRAC_1_SQRT_2;

/// Polynomials in the table; a power of two, so that an index can be masked instead of checked.
const PIECES: usize = 512;
/// Bits of the mantissa of a place that say where in a piece; those above are the number of the piece.
const WITHIN: u32 = 52 - PIECES.trailing_zeros();
/// Coefficients of a polynomial.
const TERMS: usize = 5;
/// Numbers in a row.
const ROW: usize = TERMS - 1;
/// Where in a piece the polynomial meets the quantile: Chebyshev points with both ends, so that neighbours meet each other.
const NODES: [f64; TERMS] = [0.0, 0.5 - 0.5 * FRAC_1_SQRT_2, 0.5, 0.5 + 0.5 * FRAC_1_SQRT_2, 1.0];

/// One polynomial in the size of one vector load. The lower half of the last number is the upper half of the highest coefficient:
/// it disturbs the cubic coefficient by less than a millionth, and the terms from there on are below a hundred-millionth of the sum.
pub type Row = [f64; ROW];

/// Prepared quantiles of the folded normal law at one risk.
///
/// The excess u(m) of [`FoldedQuantile::excess`] is smooth, changes most near m = 0 and not at all beyond a few deviations. The table
/// therefore has equal pieces of
///
/// ```text
/// w = sigma / (sigma + c |fte|) = 1 / (1 + c m)
/// ```
///
/// which runs from 0 to 1 without an end to look after. [`Self::bound`] is one epoch; its three steps are public for loops over many,
/// where each of them is taken side by side.
#[derive(Debug, Clone, PartialEq)]
pub struct PreparedQuantile {
    /// c of the formula.
    steepness: f64,
    /// The rows one after the other. Not aligned beyond a double: an owner in another language may not keep more.
    table: [f64; ROW * PIECES],
}

impl PreparedQuantile {
    /// Work out the table of one risk.
    pub fn new(risk: Risk) -> Self {
        let law = FoldedQuantile::new(risk);
        // Near the best for every risk from 1e-9 to 1/2 (measured): the quantile changes within a deviation over K of the path.
        let steepness = 0.5 + 0.4 * law.two_sided();
        let mut table = [0.0; ROW * PIECES];
        let mut last = [law.one_sided(), 0.0, 0.0, 0.0, 0.0];
        for (index, row) in table.chunks_exact_mut(ROW).enumerate() {
            last = through(NODES.map(|x| {
                let ratio = (PIECES as f64 / (index as f64 + x) - 1.0) / steepness;
                // The polynomial before goes on to this piece with all but its last digits; one step restores those.
                law.halley(value(last, 1.0 + x), ratio)
            }));
            row.copy_from_slice(&packed(last));
        }
        Self { steepness, table }
    }

    /// The bound |fte| + u sigma of one epoch, for finite `fte` and `sigma` >= 0.
    #[inline]
    pub fn bound(&self, fte: f64, sigma: f64) -> f64 {
        let place = self.place(fte, sigma);
        self.finish(fte, sigma, place, self.row(place))
    }

    /// First step: 1 + w. All doubles from 1 to 2 have one exponent, so the mantissa is w itself.
    #[inline(always)]
    pub fn place(&self, fte: f64, sigma: f64) -> f64 {
        const BELOW_ONE: f64 = 1.0 - f64::EPSILON;
        let w = sigma / (sigma + self.steepness * fte.abs());
        // Written so that NaN, from zero over zero, is not below one, and so that it becomes one instruction.
        1.0 + if w < BELOW_ONE { w } else { BELOW_ONE }
    }

    /// Second step: the polynomial there.
    #[inline(always)]
    pub fn row(&self, place: f64) -> Row {
        let first = ((place.to_bits() >> WITHIN) as usize * ROW) & (ROW * (PIECES - 1));
        // The mask leaves room for a whole row: the compiler sees it and checks nothing.
        self.table[first..].first_chunk().copied().unwrap_or_default()
    }

    /// Third step: the bound.
    #[inline(always)]
    pub fn finish(&self, fte: f64, sigma: f64, place: f64, row: Row) -> f64 {
        let x = place - f64::from_bits((place.to_bits() >> WITHIN) << WITHIN);
        let [c0, c1, c2, c3] = row;
        let c4 = f64::from_bits(c3.to_bits() << 32);
        let excess = c0 + x * (c1 + x * (c2 + x * (c3 + x * c4)));
        fte.abs() + excess * sigma
    }
}

/// Coefficients of the polynomial that has these values at [`NODES`]: Newton's divided differences, multiplied out.
fn through(mut values: [f64; TERMS]) -> [f64; TERMS] {
    for order in 1..TERMS {
        for i in (order..TERMS).rev() {
            values[i] = (values[i] - values[i - 1]) / (NODES[i] - NODES[i - order]);
        }
    }
    let mut c = [0.0; TERMS];
    for i in (0..TERMS).rev() {
        for j in (0..TERMS).rev() {
            c[j] = if j > 0 { c[j - 1] } else { values[i] } - c[j] * NODES[i];
        }
    }
    c
}

/// The polynomial at `x`.
fn value(coefficients: [f64; TERMS], x: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| c + x * sum)
}

/// A polynomial over one piece as a row, in which a piece is as long as its share of w.
fn packed(coefficients: [f64; TERMS]) -> Row {
    const HALF: u64 = 1 << 31;
    const SIGN: u64 = 1 << 63;
    let mut scale = 1.0;
    let [c0, c1, c2, c3, c4] = coefficients.map(|c| {
        let scaled = c * scale;
        scale *= PIECES as f64;
        scaled
    });
    let low = c4.to_bits().wrapping_add(HALF) >> 32;
    // The upper half that brings the whole number nearest to the coefficient.
    let high = (((c3.to_bits() & !SIGN) + HALF).saturating_sub(low) >> 32) << 32;
    [c0, c1, c2, f64::from_bits((c3.to_bits() & SIGN) | high | low)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Worst relative error of the bound against the iterative solver.
    fn worst(q: f64, ratios: impl Iterator<Item = f64>) -> f64 {
        let risk = Risk::new(q).unwrap();
        let (prepared, law) = (PreparedQuantile::new(risk), FoldedQuantile::new(risk));
        ratios.map(|m| (prepared.bound(m, 1.0) / (m + law.excess(m)) - 1.0).abs()).fold(0.0, f64::max)
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
    fn risks_beyond_the_contract_keep_it() {
        for q in [1e-300, 1e-15, 1e-12] {
            let error = worst(q, (0..20_000).map(|i| 0.000_25 * f64::from(i)));
            assert!(error <= 1e-12, "q = {q:e}: {error:e}");
        }
    }

    #[test]
    fn the_ends_of_the_table_are_the_two_factors() {
        for q in [1e-15, 1e-9, 1e-5, 0.05, 0.5] {
            let (table, law) = (PreparedQuantile::new(Risk::new(q).unwrap()), FoldedQuantile::new(Risk::new(q).unwrap()));
            // The last place is an ulp short of the end, where the excess falls by half an ulp (K near 6) to one and a half (K = 0.67);
            // the polynomial and the bound are rounded besides.
            assert!((table.bound(0.0, 3.0) / (3.0 * law.two_sided()) - 1.0).abs() <= 2e-15, "{q}");
            for far in [20.0, 1e3, 1e6, 1e300, f64::MAX] {
                let expected = far + law.one_sided();
                assert!((table.bound(far, 1.0) - expected).abs() <= 3e-16 * expected, "{q} {far}");
            }
            assert_eq!((table.bound(-7.0, 0.0), table.bound(0.0, 0.0)), (7.0, 0.0), "{q}");
        }
    }

    #[test]
    fn a_row_keeps_what_its_polynomial_needs() {
        for polynomial in
            [[5.0, -1e-2, 1e-4, 3e-7, -2e-9], [5.0, 0.0, 0.0, -3e-7, 2e-9], [1.0, 0.0, 0.0, 0.0, -1e-300], [1.0, 0.0, 0.0, -0.0, -1.0]]
        {
            let [c0, c1, c2, c3] = packed(polynomial);
            let unscaled =
                [c0, c1 / 512.0, c2 / 512.0_f64.powi(2), c3 / 512.0_f64.powi(3), f64::from_bits(c3.to_bits() << 32) / 512.0_f64.powi(4)];
            // Twenty bits of a mantissa.
            let allowed = [0.0, 0.0, 0.0, 1e-6, 1e-6];
            for i in 0..TERMS {
                assert!((unscaled[i] - polynomial[i]).abs() <= allowed[i] * polynomial[i].abs() + 1e-300, "{polynomial:?} {unscaled:?}");
            }
        }
    }
}
