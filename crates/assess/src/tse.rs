//! Lateral bounds of many epochs at one risk, as fast as the memory allows.

use crate::batch::{Rejected, chunks};
use navbound_core::bound::tse::Deviation;
use navbound_core::quantity::{Metres, Risk};
use navbound_core::special::{PreparedQuantile, two_sided_factor};
use pulp::Arch;
use std::array::from_fn;

/// Epochs worked out side by side.
const WIDTH: usize = 8;
type Block = [f64; WIDTH];
/// Bits of the smallest number that is not finite.
const INFINITE: i64 = f64::INFINITY.to_bits() as i64;

/// Exact bounds from a prepared table \[m\]: `fte_m` and `sigma_m` of equal length.
///
/// # Errors
/// The first epoch whose flight technical error is not finite or whose sigma is outside [0, inf).
pub fn exact(prepared: &PreparedQuantile, fte_m: &[f64], sigma_m: &[f64]) -> Result<Vec<f64>, Rejected> {
    lateral(
        fte_m,
        sigma_m,
        #[inline(always)]
        |fte, sigma| {
            let excess: Block = prepared.excesses(from_fn(|i| fte[i] / sigma[i]));
            from_fn(|i| fte[i] + excess[i] * sigma[i])
        },
    )
}

/// LTEM of many epochs at one risk \[m\].
///
/// # Errors
/// As [`exact`].
pub fn ltem(risk: Risk, fte_m: &[f64], sigma_m: &[f64]) -> Result<Vec<f64>, Rejected> {
    let factor = two_sided_factor(risk.q());
    lateral(
        fte_m,
        sigma_m,
        #[inline(always)]
        |fte, sigma| from_fn(|i| fte[i] + factor * sigma[i]),
    )
}

/// A formula of |fte| and sigma over many epochs, in the widest instructions the processor has. No multiplication is joined with an
/// addition, so the results are the same bits on every processor.
fn lateral(fte_m: &[f64], sigma_m: &[f64], formula: impl Fn(Block, Block) -> Block + Sync) -> Result<Vec<f64>, Rejected> {
    let arch = Arch::new();
    let n = fte_m.len().min(sigma_m.len());
    chunks::<1>(n, |first, out| {
        let (fte, sigma) = (&fte_m[first..first + out.len()], &sigma_m[first..first + out.len()]);
        let good = arch.dispatch(Chunk { fte, sigma, out, formula: &formula });
        if good { Ok(()) } else { Err(first_refused(first, fte, sigma)) }
    })
}

/// One chunk as a job for [`Arch::dispatch`], which compiles it once for each width of instructions.
struct Chunk<'a, F> {
    fte: &'a [f64],
    sigma: &'a [f64],
    out: &'a mut [f64],
    formula: &'a F,
}

impl<F: Fn(Block, Block) -> Block> pulp::NullaryFnOnce for Chunk<'_, F> {
    type Output = bool;

    /// Results, and whether all inputs were in their domain.
    #[inline(always)]
    fn call(self) -> bool {
        fill(self.fte, self.sigma, self.out, self.formula)
    }
}

#[inline(always)]
fn fill(fte_m: &[f64], sigma_m: &[f64], out: &mut [f64], formula: &impl Fn(Block, Block) -> Block) -> bool {
    let ((fte, fte_rest), (sigma, sigma_rest), (results, rest)) = (fte_m.as_chunks(), sigma_m.as_chunks(), out.as_chunks_mut());
    let mut bad = [0; WIDTH];
    for ((fte, sigma), results) in fte.iter().zip(sigma).zip(results) {
        *results = block(*fte, *sigma, &mut bad, formula);
    }
    // The last few in a block of their own, filled up with a harmless epoch.
    let (mut fte, mut sigma) = ([0.0; WIDTH], [1.0; WIDTH]);
    fte[..rest.len()].copy_from_slice(fte_rest);
    sigma[..rest.len()].copy_from_slice(sigma_rest);
    rest.copy_from_slice(&block(fte, sigma, &mut bad, formula)[..rest.len()]);
    bad.iter().all(|b| *b >= 0)
}

/// One block. The sign bit of `bad` is set by a number outside its domain.
#[inline(always)]
fn block(fte: Block, sigma: Block, bad: &mut [i64; WIDTH], formula: &impl Fn(Block, Block) -> Block) -> Block {
    // Adding zero makes a negative zero positive.
    let (fte, sigma) = (fte.map(f64::abs), sigma.map(|s| s + 0.0));
    for i in 0..WIDTH {
        let (fte, sigma) = (fte[i].to_bits() as i64, sigma[i].to_bits() as i64);
        bad[i] |= (INFINITE - 1).wrapping_sub(fte) | sigma | (INFINITE - 1).wrapping_sub(sigma);
    }
    formula(fte, sigma)
}

#[cold]
fn first_refused(first: usize, fte_m: &[f64], sigma_m: &[f64]) -> Rejected {
    let refusals = fte_m.iter().zip(sigma_m).enumerate();
    let found = refusals.filter_map(|(k, (f, s))| Some((k, Deviation::new(Metres::new(*f), Metres::new(*s)).err()?))).next();
    debug_assert!(found.is_some(), "the fast check and the careful one disagree");
    let whole = navbound_core::quantity::OutOfDomain { argument: "fte_m", value: f64::NAN, unit: "m", domain: "(-inf, inf)" };
    let (offset, reason) = found.unwrap_or((0, whole));
    Rejected { index: first + offset, reason }
}

#[cfg(test)]
mod tests {
    use super::*;
    use navbound_core::bound::tse;

    /// Ratios over twelve decades, zeros among them.
    fn epochs(n: usize) -> (Vec<f64>, Vec<f64>) {
        let fte = (0..n).map(|i| if i % 17 == 0 { 0.0 } else { (i as f64 * 0.37).sin() * 10f64.powi((i % 9) as i32 - 4) });
        let sigma = (0..n).map(|i| if i % 23 == 0 { 0.0 } else { 0.5 + (i as f64 * 0.11).cos().abs() * 10f64.powi((i % 5) as i32 - 2) });
        (fte.collect(), sigma.collect())
    }

    #[test]
    fn wide_instructions_give_the_bits_of_one_epoch_at_a_time() {
        let (fte, sigma) = epochs(70_001);
        for q in [1e-9, 1e-5, 0.05, 0.5] {
            let risk = Risk::new(q).unwrap();
            let table = PreparedQuantile::new(risk);
            let (batch, line) = (exact(&table, &fte, &sigma).unwrap(), ltem(risk, &fte, &sigma).unwrap());
            for i in 0..fte.len() {
                let epoch = Deviation::new(Metres::new(fte[i]), Metres::new(sigma[i])).unwrap();
                assert_eq!(batch[i].to_bits(), tse::exact_prepared(epoch, &table).m().to_bits(), "epoch {i}");
                assert_eq!(line[i].to_bits(), tse::ltem(epoch, risk).m().to_bits(), "epoch {i}");
            }
        }
    }

    #[test]
    fn the_first_bad_epoch_is_named() {
        let table = PreparedQuantile::new(Risk::ACCURACY);
        for (place, fte, sigma, argument) in [
            (5000, f64::NAN, 1.0, "fte_m"),
            (0, f64::INFINITY, 1.0, "fte_m"),
            (9_999, 1.0, -1e-300, "sigma_m"),
            (42, 0.0, f64::NAN, "sigma_m"),
        ] {
            let (mut f, mut s) = epochs(10_000);
            (f[place], s[place]) = (fte, sigma);
            let refused = exact(&table, &f, &s).unwrap_err();
            assert_eq!((refused.index, refused.reason.argument), (place, argument));
            assert_eq!(ltem(Risk::ACCURACY, &f, &s).unwrap_err().index, place);
        }
    }
}
