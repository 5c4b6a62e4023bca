//! The Stanford-ESA diagram: every subset of an epoch's satellites is a point with an error and a protection level of its own.

use super::{Histogram, Regions};
use crate::parallel;
use core::ops::Range;
use navbound_core::bound::sbas;
use navbound_core::quantity::{GpsTime, Unavailable};
use navbound_core::signal::sbas::timeout::Use;
use navbound_core::solution::subsets::{RangeInError, Subset, count, walk};
use std::cmp::Ordering;

/// Fewest epochs in one task of the pool: a few milliseconds of work with ten satellites.
const EPOCHS_PER_TASK: usize = 64;

/// What is required of the subsets.
#[derive(Debug, Clone, PartialEq)]
pub struct Job {
    /// Which multipliers make a level of a covariance.
    pub used_for: Use,
    /// Fewest satellites of a subset.
    pub least: usize,
    /// An epoch may have as many subsets as this many satellites have; with more satellites fewer are left out.
    pub most_satellites: u32,
    /// Horizontal and vertical alert limits \[m\] of each level of service.
    pub limits_m: Vec<(f64, Option<f64>)>,
    /// Width of a bin of the histograms \[m\].
    pub bin_m: f64,
    /// Bins of an axis, without the one beyond.
    pub n_bins: u32,
    /// Subsets whose safety index reaches this in either axis are listed.
    pub listed_from: f64,
    /// At most so many, the gravest.
    pub most_listed: usize,
}

/// A subset that is listed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Listed {
    /// Its epoch.
    pub time: GpsTime,
    /// Bit i: range i of the epoch is used.
    pub used: u64,
    /// HPE, VPE \[m\].
    pub error_m: [f64; 2],
    /// HPL, VPL \[m\]; NaN where the use has no vertical level.
    pub level_m: [f64; 2],
}

impl Listed {
    /// Error over level, the larger of both axes.
    pub fn index(&self) -> f64 {
        let [h, v] = [0, 1].map(|axis| self.error_m[axis] / self.level_m[axis]);
        h.max(v)
    }
    /// The gravest first; then by time and satellites, so that the order is always the same.
    fn order(&self, other: &Self) -> Ordering {
        other.index().total_cmp(&self.index()).then(self.time.cmp(&other.time)).then(self.used.cmp(&other.used))
    }
}

/// What the subsets of some epochs add up to.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Tally {
    /// Epochs whose whole set gives a position.
    pub n_epochs: u64,
    /// Epochs whose whole set does not.
    pub n_unsolved: u64,
    /// Epochs with so many satellites that not every subset was looked at.
    pub n_cut: u64,
    /// Subsets that were looked at.
    pub n_subsets: u64,
    /// Those of them that determine no position.
    pub n_singular: u64,
    /// Points of both axes.
    pub histograms: [Histogram; 2],
    /// Of each level of service, both axes.
    pub regions: Vec<[Regions; 2]>,
    /// Largest safety index of both axes; 0 before the first.
    pub largest_index: [f64; 2],
    /// Subsets whose safety index is above 1 in either axis.
    pub n_misleading: u64,
    /// Subsets that reach the index from which they are listed.
    pub n_listed: u64,
    /// The gravest of them.
    pub listed: Vec<Listed>,
}

/// One epoch: when, and its ranges.
pub type Epoch<'a> = (GpsTime, &'a [RangeInError]);

/// The subsets of every epoch.
///
/// # Errors
/// The epoch's place among those given, and [`Unavailable::Invalid`], where a range is no range.
pub fn subsets(epochs: &[Epoch<'_>], job: &Job) -> Result<Tally, (usize, Unavailable)> {
    // Sums of counts and an order without ties: how the epochs are cut changes nothing.
    let part = |span: Range<usize>| {
        let mut tally = Tally::none(job);
        for index in span {
            let (time, ranges) = epochs[index];
            tally.epoch(time, ranges, job).map_err(|e| (index, e))?;
        }
        Ok(tally)
    };
    parallel::parts(epochs.len(), EPOCHS_PER_TASK, part).into_iter().try_fold(Tally::none(job), |all, part| Ok(all.merged(part?, job)))
}

/// How many of `n` satellites may be left out so that the subsets are no more than those of `most_satellites`.
fn depth(n: usize, least: usize, most_satellites: u32) -> usize {
    let most = 1_u64.checked_shl(most_satellites).unwrap_or(u64::MAX);
    let whole = n.saturating_sub(least);
    (0..=whole).rev().find(|k| count(n, *k) <= most).unwrap_or(0)
}

impl Tally {
    /// Of no epoch.
    pub fn none(job: &Job) -> Self {
        Self { regions: vec![Default::default(); job.limits_m.len()], ..Self::default() }
    }

    fn epoch(&mut self, time: GpsTime, ranges: &[RangeInError], job: &Job) -> Result<(), Unavailable> {
        let depth = depth(ranges.len(), job.least, job.most_satellites);
        match walk(ranges, job.least, depth, &mut |subset| self.point(time, subset, job)) {
            Ok(walked) => {
                self.n_epochs += 1;
                self.n_cut += u64::from(depth < ranges.len().saturating_sub(job.least));
                self.n_subsets += walked.n;
                self.n_singular += walked.n_singular;
                Ok(())
            }
            Err(e @ Unavailable::Invalid { .. }) => Err(e),
            Err(_) => {
                self.n_unsolved += 1;
                Ok(())
            }
        }
    }

    fn point(&mut self, time: GpsTime, subset: &Subset, job: &Job) {
        let levels = sbas::levels(&subset.covariance, job.used_for);
        let nse = subset.nse.vector();
        let error_m = [nse.x.hypot(nse.y), nse.z.abs()];
        let level_m = [levels.hpl.m(), levels.vpl.map_or(f64::NAN, |v| v.m())];
        for axis in [0, 1] {
            self.histograms[axis].add(error_m[axis], level_m[axis], job.bin_m, job.n_bins);
            self.largest_index[axis] = self.largest_index[axis].max(error_m[axis] / level_m[axis]);
        }
        for (regions, (hal, val)) in self.regions.iter_mut().zip(&job.limits_m) {
            regions[0].add(error_m[0], level_m[0], *hal);
            if let Some(val) = val {
                regions[1].add(error_m[1], level_m[1], *val);
            }
        }
        let listed = Listed { time, used: subset.used, error_m, level_m };
        self.n_misleading += u64::from(listed.index() > 1.0);
        if listed.index() >= job.listed_from {
            self.n_listed += 1;
            self.listed.push(listed);
            if self.listed.len() >= 2 * job.most_listed.max(1) {
                self.shorten(job.most_listed);
            }
        }
    }

    fn shorten(&mut self, most: usize) {
        self.listed.sort_unstable_by(Listed::order);
        self.listed.truncate(most);
    }

    /// Both.
    pub fn merged(mut self, other: Self, job: &Job) -> Self {
        self.n_epochs += other.n_epochs;
        self.n_unsolved += other.n_unsolved;
        self.n_cut += other.n_cut;
        self.n_subsets += other.n_subsets;
        self.n_singular += other.n_singular;
        self.n_misleading += other.n_misleading;
        self.n_listed += other.n_listed;
        for (mine, theirs) in self.histograms.iter_mut().zip(other.histograms) {
            mine.absorb(theirs);
        }
        for (mine, theirs) in self.regions.iter_mut().zip(&other.regions) {
            *mine = [mine[0].merged(&theirs[0]), mine[1].merged(&theirs[1])];
        }
        self.largest_index = [0, 1].map(|axis| self.largest_index[axis].max(other.largest_index[axis]));
        self.listed.extend(other.listed);
        self.shorten(job.most_listed);
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use navbound_core::quantity::Metres;

    fn job() -> Job {
        Job {
            used_for: Use::PrecisionApproach,
            least: 4,
            most_satellites: 14,
            limits_m: vec![(40.0, Some(50.0)), (556.0, None)],
            bin_m: 0.1,
            n_bins: 500,
            listed_from: 0.7,
            most_listed: 20,
        }
    }

    /// Directions spread evenly over the upper half of the sky (spiral of the golden angle), errors that alternate.
    fn ranges(n: usize, error_m: f64) -> Vec<RangeInError> {
        let one = |i: usize| {
            let (up, turn) = (0.1 + 0.85 * i as f64 / n as f64, 2.399_963 * i as f64);
            let level = (1.0 - up * up).sqrt();
            RangeInError {
                unit: [level * turn.sin(), level * turn.cos(), up].into(),
                weight: 1.0,
                error: Metres::new(if i.is_multiple_of(2) { error_m } else { -error_m }),
                shared_m: [0.0; 4].into(),
            }
        };
        (0..n).map(one).collect()
    }

    fn at<'a>(sets: &[&'a [RangeInError]]) -> Vec<Epoch<'a>> {
        sets.iter().zip(0..).map(|(ranges, k)| (GpsTime::from_nanoseconds(k), *ranges)).collect()
    }

    #[test]
    fn depth_keeps_within_the_subsets_of_so_many_satellites() {
        assert_eq!(depth(9, 4, 14), 5);
        // Of 20: 1 + 20 + 190 + 1140 + 4845 = 6196 subsets, with five left out 21700; 2^14 is 16384.
        assert_eq!(depth(20, 4, 14), 4);
        assert_eq!(depth(20, 4, 15), 5);
        assert_eq!(depth(64, 4, 0), 0);
    }

    #[test]
    fn the_regions_count_every_subset_that_has_a_position() {
        let (nine, twenty) = (ranges(9, 1.0), ranges(20, 1.0));
        let tally = subsets(&at(&[&nine, &twenty, &nine[..3]]), &job()).unwrap();
        // 126 + 126 + 84 + 36 + 9 + 1 subsets of nine; of twenty those that leave out four at most.
        assert_eq!((tally.n_epochs, tally.n_unsolved, tally.n_cut, tally.n_subsets), (2, 1, 1, 382 + 6196));
        let points = tally.n_subsets - tally.n_singular;
        assert_eq!(tally.regions[0][0].n(), points);
        assert_eq!(tally.regions[0][1].n(), points);
        assert_eq!((tally.regions[1][0].n(), tally.regions[1][1].n()), (points, 0));
        assert_eq!(tally.histograms[0].rows().iter().map(|r| r.2).sum::<u64>(), points);
    }

    #[test]
    fn the_gravest_are_listed_and_the_cut_into_tasks_changes_nothing() {
        let sets: Vec<Vec<RangeInError>> = (0..200).map(|k| ranges(8, 0.05 * f64::from(k))).collect();
        let all: Vec<&[RangeInError]> = sets.iter().map(Vec::as_slice).collect();
        let tally = subsets(&at(&all), &job()).unwrap();
        assert!(tally.n_listed > 20 && tally.listed.len() == 20, "{}", tally.n_listed);
        // Errors grow with the epoch and levels do not, so the gravest subset is of the last.
        assert_eq!(tally.listed[0].time, GpsTime::from_nanoseconds(199));
        assert!(tally.listed.windows(2).all(|w| w[0].index() >= w[1].index()));
        assert!((tally.listed[0].index() - tally.largest_index[0].max(tally.largest_index[1])).abs() < 1e-15);
        let one_by_one = at(&all).into_iter().map(|e| subsets(&[e], &job()).unwrap());
        let sum = one_by_one.fold(Tally::none(&job()), |a, b| a.merged(b, &job()));
        assert_eq!((sum.n_subsets, sum.n_misleading, sum.n_listed), (tally.n_subsets, tally.n_misleading, tally.n_listed));
        assert_eq!(sum, tally);
    }

    #[test]
    fn a_range_that_is_none_is_named_by_its_epoch() {
        let good = ranges(6, 1.0);
        let mut bad = ranges(6, 1.0);
        bad[3].error = Metres::new(f64::NAN);
        let refused = subsets(&at(&[&good, &bad]), &job()).unwrap_err();
        assert!(matches!(refused, (1, Unavailable::Invalid { field: "range_error_m", .. })), "{refused:?}");
    }
}
