//! One loop for all batches: items of equal cost, results in order, the first refusal named by its index.

use navbound_core::quantity::OutOfDomain;
use rayon::prelude::*;

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

/// The same by chunks: `fill` is given the index of its first item and the place of its results.
///
/// # Errors
/// The refusal of the first refused item.
pub fn chunks<const M: usize>(n: usize, fill: impl Fn(usize, &mut [f64]) -> Result<(), Rejected> + Sync) -> Result<Vec<f64>, Rejected> {
    let mut out = vec![0.0; n * M];
    let refused = if n < PARALLEL_FROM {
        out.chunks_mut(CHUNK * M).enumerate().find_map(|(k, chunk)| fill(k * CHUNK, chunk).err())
    } else {
        let each = out.par_chunks_mut(CHUNK * M).enumerate();
        each.filter_map(|(k, chunk)| fill(k * CHUNK, chunk).err()).min_by_key(|r| r.index)
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
    fn the_first_refused_item_is_named() {
        for n in [100, PARALLEL_FROM * 2] {
            assert_eq!(rows(n, refuse_above(n / 3)).unwrap_err().index, n / 3);
        }
    }
}
