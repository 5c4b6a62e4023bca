//! Lateral bounds of many epochs at one risk, as fast as the memory allows.

use crate::batch::{Rejected, chunks};
use navbound_core::bound::tse::Deviation;
use navbound_core::quantity::{Metres, Risk};
use navbound_core::special::prepared::{PreparedQuantile, Row};
use navbound_core::special::two_sided_factor;
use pulp::Arch;

/// Epochs in one block of the exact bound: as many as the widest instruction takes.
const WIDTH: usize = 8;
type Block = [f64; WIDTH];
/// One in the exponent: adding it to a number that is not finite carries into the sign.
const EXPONENT: u64 = 1 << (f64::MANTISSA_DIGITS - 1);

/// Exact bounds from a prepared table \[m\]: `fte_m` and `sigma_m` of equal length.
///
/// # Errors
/// The first epoch whose flight technical error is not finite or whose sigma is outside [0, inf).
pub fn exact(prepared: &PreparedQuantile, fte_m: &[f64], sigma_m: &[f64]) -> Result<Vec<f64>, Rejected> {
    lateral(
        fte_m,
        sigma_m,
        #[inline(always)]
        |fte, sigma, out| fill_exact(prepared, fte, sigma, out),
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
        |fte, sigma, out| fill_ltem(factor, fte, sigma, out),
    )
}

/// Bounds, and a word whose sign is set if a number may be outside its domain.
#[inline(always)]
fn fill_ltem(factor: f64, fte_m: &[f64], sigma_m: &[f64], out: &mut [f64]) -> u64 {
    let mut doubts = 0;
    for ((fte, sigma), out) in fte_m.iter().zip(sigma_m).zip(out) {
        doubts |= doubt(*fte, *sigma);
        *out = fte.abs() + factor * sigma;
    }
    doubts
}

/// The same for the exact bound. The last few epochs stand in a block of their own, filled up with harmless ones.
#[inline(always)]
fn fill_exact(prepared: &PreparedQuantile, fte_m: &[f64], sigma_m: &[f64], out: &mut [f64]) -> u64 {
    let ((fte, fte_rest), (sigma, sigma_rest), (out, out_rest)) = (fte_m.as_chunks(), sigma_m.as_chunks(), out.as_chunks_mut());
    let (mut flow, mut doubts, mut late) = (Flow::new(prepared), 0, out.iter_mut());
    for (k, (fte, sigma)) in fte.iter().zip(sigma).enumerate() {
        let (bounds, doubt) = flow.step(prepared, fte, sigma);
        doubts |= doubt;
        // The first step has nothing to finish.
        if k > 0
            && let Some(out) = late.next()
        {
            *out = bounds;
        }
    }
    let (mut fte, mut sigma) = ([0.0; WIDTH], [1.0; WIDTH]);
    fte[..fte_rest.len()].copy_from_slice(fte_rest);
    sigma[..sigma_rest.len()].copy_from_slice(sigma_rest);
    let (bounds, doubt) = flow.step(prepared, &fte, &sigma);
    if let Some(out) = late.next() {
        *out = bounds;
    }
    if !out_rest.is_empty() {
        out_rest.copy_from_slice(&flow.step(prepared, &fte, &sigma).0[..out_rest.len()]);
    }
    doubts | doubt
}

/// A block on its way. The arithmetic of two blocks is joined, the last step of one and the first, with its slow division, of the next:
/// in this form, measured among many, the compiler turns the copies of rows into vector loads and transposes them in registers.
struct Flow {
    rows: [Row; WIDTH],
    places: Block,
    fte: Block,
    sigma: Block,
}

impl Flow {
    #[inline(always)]
    fn new(prepared: &PreparedQuantile) -> Self {
        Self { rows: [Row::default(); WIDTH], places: [prepared.place(0.0, 1.0); WIDTH], fte: [0.0; WIDTH], sigma: [1.0; WIDTH] }
    }

    /// Finish the block before and begin the next: the bounds of the one, and the doubts about the other.
    #[inline(always)]
    fn step(&mut self, prepared: &PreparedQuantile, fte: &Block, sigma: &Block) -> (Block, u64) {
        for i in 0..WIDTH {
            self.rows[i] = prepared.row(self.places[i]);
        }
        let (mut bounds, mut doubts) = ([0.0; WIDTH], 0);
        for i in 0..WIDTH {
            bounds[i] = prepared.finish(self.fte[i], self.sigma[i], self.places[i], self.rows[i]);
            doubts |= doubt(fte[i], sigma[i]);
            (self.fte[i], self.sigma[i], self.places[i]) = (fte[i], sigma[i], prepared.place(fte[i], sigma[i]));
        }
        (bounds, doubts)
    }
}

/// The sign bit of the result is set if a number is outside its domain, and by a negative zero, which is not.
#[inline(always)]
fn doubt(fte: f64, sigma: f64) -> u64 {
    fte.abs().to_bits().wrapping_add(EXPONENT) | sigma.to_bits() | sigma.to_bits().wrapping_add(EXPONENT)
}

/// A formula of |fte| and sigma over many epochs, in the widest instructions the processor has. No multiplication is joined with an
/// addition, so the results are the same bits on every processor.
fn lateral(fte_m: &[f64], sigma_m: &[f64], formula: impl Fn(&[f64], &[f64], &mut [f64]) -> u64 + Sync) -> Result<Vec<f64>, Rejected> {
    let arch = Arch::new();
    let n = fte_m.len().min(sigma_m.len());
    chunks::<1>(n, |first, out| {
        let (fte, sigma) = (&fte_m[first..first + out.len()], &sigma_m[first..first + out.len()]);
        let doubts = arch.dispatch(Chunk { fte, sigma, out, formula: &formula });
        if (doubts as i64) < 0 { careful(first, fte, sigma) } else { Ok(()) }
    })
}

/// One chunk as a job for [`Arch::dispatch`], which compiles it once for each width of instructions.
struct Chunk<'a, F> {
    fte: &'a [f64],
    sigma: &'a [f64],
    out: &'a mut [f64],
    formula: &'a F,
}

impl<F: Fn(&[f64], &[f64], &mut [f64]) -> u64> pulp::NullaryFnOnce for Chunk<'_, F> {
    type Output = u64;

    /// Results, and the doubts about the inputs.
    #[inline(always)]
    fn call(self) -> u64 {
        (self.formula)(self.fte, self.sigma, self.out)
    }
}

/// The first refusal of a chunk in doubt.
#[cold]
fn careful(first: usize, fte_m: &[f64], sigma_m: &[f64]) -> Result<(), Rejected> {
    for (offset, (fte, sigma)) in fte_m.iter().zip(sigma_m).enumerate() {
        Deviation::new(Metres::new(*fte), Metres::new(*sigma)).map_err(|reason| Rejected { index: first + offset, reason })?;
    }
    Ok(())
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
    fn batches_of_any_length_end_where_they_should() {
        let table = PreparedQuantile::new(Risk::ACCURACY);
        for n in 0..=3 * WIDTH {
            let (fte, sigma) = epochs(n);
            let bounds = exact(&table, &fte, &sigma).unwrap();
            assert_eq!(bounds.len(), n);
            assert!(bounds.iter().zip(fte.iter().zip(&sigma)).all(|(b, (f, s))| *b == table.bound(*f, *s)), "{n}");
        }
    }

    #[test]
    fn a_negative_zero_is_a_zero() {
        let table = PreparedQuantile::new(Risk::ACCURACY);
        assert_eq!(exact(&table, &[-3.0, -0.0], &[-0.0, -0.0]).unwrap(), [3.0, 0.0]);
        assert_eq!(ltem(Risk::ACCURACY, &[-3.0, -0.0], &[-0.0, -0.0]).unwrap(), [3.0, 0.0]);
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
