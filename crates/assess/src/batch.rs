//! One loop for all batches: items of equal cost, results in order, the first refusal named by its index.

use crate::parallel;
use navbound_core::quantity::{OutOfDomain, Risk};
use navbound_core::special::folded::FoldedQuantile;

/// Items below which one thread is quicker than waking the others.
pub const PARALLEL_FROM: usize = 65_536;
/// Items a thread takes at a time: inputs and results of a chunk stay in the fastest memory.
pub const CHUNK: usize = 2_048;

/// An item that was refused.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("item {index}: {reason}")]
pub struct Rejected {
    /// Its place in the batch, the first of all refused.
    pub index: usize,
    /// Why.
    pub reason: OutOfDomain,
}

/// Work out `n` items of `M` numbers each, row after row.
///
/// # Errors
/// The refusal of the first refused item.
pub fn rows<const M: usize>(n: usize, item: impl Fn(usize) -> Result<[f64; M], OutOfDomain> + Sync) -> Result<Vec<f64>, Rejected> {
    chunks::<M>(n, |first, out| {
        for (offset, row) in out.chunks_exact_mut(M).enumerate() {
            let index = first + offset;
            row.copy_from_slice(&item(index).map_err(|reason| Rejected { index, reason })?);
        }
        Ok(())
    })
}

/// The factors of the risk that was requested last: items of one batch mostly share theirs.
#[derive(Debug, Default)]
pub struct Factors(Option<FoldedQuantile>);

impl Factors {
    /// The factors of a risk.
    ///
    /// # Errors
    /// A risk outside its domain.
    #[inline]
    pub fn of(&mut self, q: f64) -> Result<FoldedQuantile, OutOfDomain> {
        match self.0 {
            Some(known) if known.risk() == q => Ok(known),
            _ => Ok(*self.0.insert(FoldedQuantile::new(Risk::new(q)?))),
        }
    }
}

/// One number an item, each at its own risk: what depends on the risk alone is worked out once as long as the risk stays the same.
///
/// # Errors
/// As [`rows`].
pub fn at_risks(n: usize, item: impl Fn(usize, &mut Factors) -> Result<f64, OutOfDomain> + Sync) -> Result<Vec<f64>, Rejected> {
    chunks::<1>(n, |first, out| {
        let mut factors = Factors::default();
        for (offset, row) in out.iter_mut().enumerate() {
            let index = first + offset;
            *row = item(index, &mut factors).map_err(|reason| Rejected { index, reason })?;
        }
        Ok(())
    })
}

/// The same by chunks: `fill` is given the index of its first item and the place of its results.
///
/// # Errors
/// The refusal of the first refused item.
pub fn chunks<const M: usize>(n: usize, fill: impl Fn(usize, &mut [f64]) -> Result<(), Rejected> + Sync) -> Result<Vec<f64>, Rejected> {
    let mut out = vec![0.0; n * M];
    let refused = if n < PARALLEL_FROM {
        out.chunks_mut(CHUNK * M).enumerate().find_map(|(k, chunk)| fill(k * CHUNK, chunk).err())
    } else {
        parallel::fill(&mut out, CHUNK * M, |first, chunk| fill(first / M, chunk)).into_iter().find_map(Result::err)
    };
    refused.map_or(Ok(out), Err)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refuse_above(limit: usize) -> impl Fn(usize) -> Result<[f64; 2], OutOfDomain> + Sync {
        move |i| {
            let refusal = OutOfDomain { argument: "x", value: i as f64, unit: "1", domain: "below" };
            if i < limit { Ok([i as f64, -(i as f64)]) } else { Err(refusal) }
        }
    }

    #[test]
    fn results_keep_their_order_on_any_number_of_threads() {
        for n in [0, 1, CHUNK, CHUNK + 1, PARALLEL_FROM + 3] {
            let out = rows(n, refuse_above(n)).unwrap();
            assert_eq!(out.len(), 2 * n);
            assert!(out.chunks(2).enumerate().all(|(i, row)| row[0] == i as f64 && row[1] == -(i as f64)));
        }
    }

    #[test]
    fn every_item_has_the_factors_of_its_own_risk() {
        let q = [0.05, 0.05, 1e-5, 0.05, 1e-5, 1e-5];
        let together = at_risks(q.len(), |i, factors| Ok(factors.of(q[i])?.two_sided())).unwrap();
        let alone: Vec<f64> = q.iter().map(|q| FoldedQuantile::new(Risk::new(*q).unwrap()).two_sided()).collect();
        assert_eq!(together, alone);
        let wrong = [0.05, 0.05, f64::NAN, 2.0];
        let refused = at_risks(wrong.len(), |i, factors| Ok(factors.of(wrong[i])?.risk())).unwrap_err();
        assert_eq!((refused.index, refused.reason.argument), (2, "risk"));
    }

    #[test]
    fn the_first_refused_item_is_named() {
        for n in [100, PARALLEL_FROM * 2] {
            assert_eq!(rows(n, refuse_above(n / 3)).unwrap_err().index, n / 3);
        }
    }
}
