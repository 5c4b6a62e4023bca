//! The one loop on all cores, results in order.
//!
//! Work is handed to the pool behind one type: a pool's own adapters are compiled anew for each closure, which was a third of this crate.

use core::ops::Range;
use rayon::prelude::*;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Tasks `0 .. n`, each once, on all cores, in any order.
fn tasks(n: usize, work: &(dyn Fn(usize) + Sync)) {
    (0..n).into_par_iter().with_max_len(1).for_each(work);
}

/// A place is one task's alone: nobody waits for it, and a panic ends the whole loop.
fn own<T>(place: &Mutex<T>) -> MutexGuard<'_, T> {
    place.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What `of` makes of each part of `0 .. n`, `size` numbers long, in their order.
pub(crate) fn parts<T: Send>(n: usize, size: usize, of: impl Fn(Range<usize>) -> T + Sync) -> Vec<T> {
    let size = size.max(1);
    let of = |task: usize| of(task * size..n.min((task + 1) * size));
    if n <= size {
        return (0..n.div_ceil(size)).map(of).collect();
    }
    let done: Vec<Mutex<Option<T>>> = (0..n.div_ceil(size)).map(|_| Mutex::new(None)).collect();
    tasks(done.len(), &|task| *own(&done[task]) = Some(of(task)));
    done.into_iter().filter_map(|place| place.into_inner().unwrap_or_else(PoisonError::into_inner)).collect()
}

/// What `of` makes of each number below `n`; a task takes `size` of them.
pub(crate) fn map<T: Send>(n: usize, size: usize, of: impl Fn(usize) -> T + Sync) -> Vec<T> {
    map_with(n, size, || (), |(), index| of(index))
}

/// The same with a desk, of which each task has one.
pub(crate) fn map_with<D, T: Send>(n: usize, size: usize, desk: impl Fn() -> D + Sync, of: impl Fn(&mut D, usize) -> T + Sync) -> Vec<T> {
    let part = |span: Range<usize>| {
        let mut desk = desk();
        let mut some = Vec::with_capacity(span.len());
        for index in span {
            some.push(of(&mut desk, index));
        }
        some
    };
    let mut all = Vec::new();
    for mut some in parts(n, size, part) {
        // Of one task, its own memory.
        if all.is_empty() {
            all = some;
            all.reserve_exact(n - all.len());
        } else {
            all.append(&mut some);
        }
    }
    all
}

/// The same where an item may be refused: the refusal of the first refused one.
///
/// # Errors
/// As `of`.
pub(crate) fn try_map<T: Send, E: Send>(n: usize, size: usize, of: impl Fn(usize) -> Result<T, E> + Sync) -> Result<Vec<T>, E> {
    map(n, size, of).into_iter().collect()
}

/// `work` on each part of `out`, `size` places long, with the index of its first place; what it says of each.
pub(crate) fn fill<T: Send, R: Send>(out: &mut [T], size: usize, work: impl Fn(usize, &mut [T]) -> R + Sync) -> Vec<R> {
    let size = size.max(1);
    let places: Vec<Mutex<&mut [T]>> = out.chunks_mut(size).map(Mutex::new).collect();
    parts(places.len(), 1, |task| work(task.start * size, &mut own(&places[task.start])))
}

/// Threads of the pool: where a task is dear to begin, each gets one.
pub(crate) fn threads() -> usize {
    rayon::current_num_threads().max(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_are_in_order_whatever_the_size_of_a_task() {
        for n in [0, 1, 2, 7, 64, 1000] {
            let expected: Vec<usize> = (0..n).map(|k| k * k).collect();
            for size in [0, 1, 3, 64, 5000] {
                assert_eq!(map(n, size, |k| k * k), expected);
                let mut out = vec![0; n];
                fill(&mut out, size, |first, part| part.iter_mut().zip(first..).for_each(|(place, k)| *place = k * k));
                assert_eq!(out, expected);
            }
        }
    }

    #[test]
    fn a_desk_is_one_tasks_alone() {
        let count = |seen: &mut usize, _| {
            *seen += 1;
            *seen
        };
        assert_eq!(map_with(7, 3, || 0, count), [1, 2, 3, 1, 2, 3, 1]);
    }

    #[test]
    fn the_first_refusal_is_the_one_named() {
        let of = |k: usize| if k % 100 == 50 { Err(k) } else { Ok(k) };
        assert_eq!(try_map(1000, 7, of), Err(50));
        assert_eq!(try_map(50, 7, of), Ok((0..50).collect()));
    }

    #[test]
    fn a_loop_within_a_loop_ends() {
        let sums = map(40, 1, |k| map(500, 10, |j| j * k).into_iter().sum::<usize>());
        assert!(sums.iter().enumerate().all(|(k, sum)| *sum == k * 499 * 250));
    }
}
