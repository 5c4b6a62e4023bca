//! Errors and levels against time in a bounded number of buckets, whatever the length of the campaign.

use super::epoch::{Cause, Epoch, HPL, VPL};
use super::spread::Moments;
use crate::evaluation::effective_size;
use std::collections::BTreeMap;

/// Most buckets; when there are more, two neighbours become one.
const MOST: usize = 2048;

/// What one stretch of time adds up to.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Bucket {
    /// Expected epochs.
    pub n_expected: u64,
    /// Epochs with a solution.
    pub n_solution: u64,
    /// Smallest horizontal and vertical level; NaN where there is none \[m\].
    pub least_m: Option<[f64; 2]>,
    /// Horizontal error, vertical error, horizontal level, vertical level.
    pub size: [Moments; 4],
    /// Available epochs, a level each.
    pub n_available: Vec<u64>,
    /// Epochs that are not, by cause, a level each.
    pub n_lacking: Vec<[u64; Cause::ALL.len()]>,
}

impl Bucket {
    fn new(n_levels: usize) -> Self {
        Self { n_available: vec![0; n_levels], n_lacking: vec![[0; Cause::ALL.len()]; n_levels], ..Self::default() }
    }

    fn lack(&mut self, level: usize, cause: Option<Cause>, n: u64) {
        match cause {
            None => self.n_available[level] += n,
            Some(cause) => self.n_lacking[level][cause as usize] += n,
        }
    }

    fn absorb(&mut self, next: &Self) {
        self.n_expected += next.n_expected;
        self.n_solution += next.n_solution;
        self.least_m = smaller(self.least_m, next.least_m);
        for (sum, other) in self.size.iter_mut().zip(&next.size) {
            *sum = sum.merged(other);
        }
        for (sum, other) in self.n_available.iter_mut().zip(&next.n_available) {
            *sum += other;
        }
        for (sum, other) in self.n_lacking.iter_mut().flatten().zip(next.n_lacking.iter().flatten()) {
            *sum += other;
        }
    }

    /// The most frequent cause of a level's epochs that are not available; the first of equals.
    pub fn main_cause(&self, level: usize) -> Option<Cause> {
        let counts = &self.n_lacking[level];
        let most = counts.iter().copied().max().filter(|n| *n > 0)?;
        Cause::ALL.into_iter().find(|c| counts[*c as usize] == most)
    }
}

fn smaller(a: Option<[f64; 2]>, b: Option<[f64; 2]>) -> Option<[f64; 2]> {
    match (a, b) {
        // The minimum of a number and a NaN is the number.
        (Some(a), Some(b)) => Some([a[0].min(b[0]), a[1].min(b[1])]),
        (one, other) => one.or(other),
    }
}

/// Buckets of 2^k slots each, aligned with slot 0, so that those of two series nest.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    shift: u32,
    n_levels: usize,
    buckets: BTreeMap<i64, Bucket>,
}

impl Series {
    /// Nothing yet.
    pub fn new(n_levels: usize) -> Self {
        Self { shift: 0, n_levels, buckets: BTreeMap::new() }
    }

    fn bucket(&mut self, index: i64) -> &mut Bucket {
        let n_levels = self.n_levels;
        self.buckets.entry(index).or_insert_with(|| Bucket::new(n_levels))
    }

    /// One more epoch; what each level lacks at it.
    pub fn add(&mut self, epoch: &Epoch, lacks: &[Option<Cause>]) {
        let bucket = self.bucket(epoch.slot >> self.shift);
        bucket.n_expected += 1;
        if epoch.has_solution() {
            bucket.n_solution += 1;
            bucket.least_m = smaller(bucket.least_m, Some([epoch.size_m[HPL], epoch.size_m[VPL]]));
            for (sum, value) in bucket.size.iter_mut().zip(epoch.size_m) {
                sum.add(value, epoch.slot);
            }
        }
        for (level, lack) in lacks.iter().enumerate() {
            bucket.lack(level, *lack, 1);
        }
        self.bound();
    }

    /// Absent epochs.
    pub fn add_absent(&mut self, first_slot: i64, n: u64) {
        while n >> self.shift > MOST as u64 {
            self.coarsen();
        }
        let end = first_slot.saturating_add_unsigned(n);
        let mut slot = first_slot;
        while slot < end {
            let index = slot >> self.shift;
            let next = (index + 1).saturating_mul(1 << self.shift).min(end);
            let here = next.abs_diff(slot);
            let n_levels = self.n_levels;
            let bucket = self.bucket(index);
            bucket.n_expected += here;
            (0..n_levels).for_each(|level| bucket.lack(level, Some(Cause::Missing), here));
            slot = next;
        }
        self.bound();
    }

    fn bound(&mut self) {
        while self.buckets.len() > MOST {
            self.coarsen();
        }
    }

    fn coarsen(&mut self) {
        self.shift += 1;
        for (index, bucket) in std::mem::take(&mut self.buckets) {
            self.bucket(index >> 1).absorb(&bucket);
        }
    }

    /// A later stretch of the same campaign.
    pub fn absorb(&mut self, mut next: Self) {
        while next.shift < self.shift {
            next.coarsen();
        }
        while self.shift < next.shift {
            self.coarsen();
        }
        for (index, bucket) in next.buckets {
            self.bucket(index).absorb(&bucket);
        }
        self.bound();
    }

    /// Slots in a bucket.
    pub fn width(&self) -> i64 {
        1 << self.shift
    }

    /// First slot and contents of each bucket, in order.
    pub fn buckets(&self) -> impl Iterator<Item = (i64, &Bucket)> {
        self.buckets.iter().map(|(index, bucket)| (index << self.shift, bucket))
    }

    /// Independent epochs that the availability of a level is worth.
    ///
    /// ```text
    /// n_effective = v / (v_b / n_b)       v variance of an epoch, v_b variance of the bucket means, n_b buckets they are worth
    /// ```
    ///
    /// `n_b` follows from the autocorrelation of the bucket means. The smallest of the sizes of the errors, of the protection levels, and of
    /// the indicator "available" where it is both 0 and 1. An indicator that hardly changes says nothing about its own correlation; that of
    /// what it is made of is never too small (Gebelein, as for the coverage of a bound: [`effective_size`]).
    pub fn n_effective(&self, level: usize, share: f64) -> f64 {
        let means = |f: &dyn Fn(&Bucket) -> f64| self.buckets.values().map(f).filter(|v| !v.is_nan()).collect::<Vec<_>>();
        let n: u64 = self.buckets.values().map(|b| b.n_expected).sum();
        let size = |place: usize| {
            let all = self.buckets.values().fold(Moments::default(), |sum, b| sum.merged(&b.size[place]));
            if all.n == 0 { f64::INFINITY } else { worth(all.variance(), means(&|b| b.size[place].mean()), all.n) }
        };
        let mut least = (0..4).map(size).fold(f64::INFINITY, f64::min);
        if share * (1.0 - share) > 0.0 {
            let available = means(&|b| b.n_available[level] as f64 / b.n_expected as f64);
            least = least.min(worth(share * (1.0 - share), available, n));
        }
        if least.is_finite() { least } else { 1.0 }
    }
}

fn worth(variance: f64, means: Vec<f64>, n: u64) -> f64 {
    let count = means.len() as f64;
    let mean = means.iter().sum::<f64>() / count;
    let of_means = means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / count;
    if !(variance > 0.0) {
        return 1.0;
    }
    (variance * effective_size(&[means]) / of_means).clamp(1.0, n as f64)
}
