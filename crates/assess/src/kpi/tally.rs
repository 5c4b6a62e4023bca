//! What a stretch of the grid adds up to; two that follow each other merge.

use super::continuity::Continuity;
use super::epoch::{Cause, Demand, Epoch, HPE, HPL, Settings, State, VPE, VPL};
use super::runs::{Runs, Stretch};
use super::series::Series;
use super::spread::Axis;
use super::stanford::{Histogram, Regions};
use std::collections::BTreeMap;

const DAY_NS: i64 = 86_400_000_000_000;

/// Counts of one GPS day.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Day {
    /// Expected epochs.
    pub n_expected: u64,
    /// Epochs with a solution.
    pub n_solution: u64,
    /// Available epochs, a level each.
    pub n_available: Vec<u64>,
}

/// What one level adds up to.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LevelTally {
    /// Available epochs.
    pub n_available: u64,
    /// Available epochs with an error beyond its limit.
    pub n_hazard: u64,
    /// Available epochs with an error beyond its level.
    pub n_mi: u64,
    /// The Stanford regions, horizontal and vertical.
    pub regions: [Regions; 2],
    /// Errors and levels over available epochs, horizontal and vertical.
    pub axes: [Axis; 2],
    /// Runs of availability.
    pub continuity: Continuity,
    /// Runs of epochs that are not available, hazardous, misleading.
    pub runs: [Runs; 3],
}

impl LevelTally {
    fn add(&mut self, epoch: &Epoch, demand: &Demand, lack: Option<Cause>, before: Option<State>, window: u64) {
        let [hpe, vpe, hpl, vpl] = epoch.size_m;
        let available = lack.is_none();
        self.regions[0].add(hpe, hpl, demand.hal_m);
        if let Some(val) = demand.val_m {
            self.regions[1].add(vpe, vpl, val);
        }
        if available {
            self.n_available += 1;
            self.axes[0].add(hpe, hpl, epoch.slot);
            self.axes[1].add(vpe, vpl, epoch.slot);
        }
        self.continuity.push(available, 1, window);
        let hazard = available && epoch.beyond_limit(demand);
        let misleading = available && epoch.beyond_level(Some(demand));
        self.n_hazard += u64::from(hazard);
        self.n_mi += u64::from(misleading);
        for (runs, condition) in self.runs.iter_mut().zip([!available, hazard, misleading]) {
            if condition { runs.push(Stretch::of(epoch, lack, before)) } else { runs.pause(1) }
        }
    }

    fn add_absent(&mut self, first_slot: i64, n: u64, before: Option<State>, settings: &Settings) {
        let [lost, hazards, misleading] = &mut self.runs;
        hazards.pause(n);
        misleading.pause(n);
        if !settings.exclude_missing {
            self.continuity.push(false, n, settings.window);
            lost.push(Stretch::absent(first_slot, n, before));
        }
    }

    fn append(&mut self, next: Self, before: Option<State>, window: u64) {
        self.n_available += next.n_available;
        self.n_hazard += next.n_hazard;
        self.n_mi += next.n_mi;
        for axis in 0..2 {
            self.regions[axis] = self.regions[axis].merged(&next.regions[axis]);
            self.axes[axis] = self.axes[axis].merged(&next.axes[axis]);
        }
        self.continuity = self.continuity.merged(&next.continuity, window);
        for (runs, more) in self.runs.iter_mut().zip(next.runs) {
            runs.append(more, before);
        }
    }
}

/// Everything a stretch of the grid adds up to.
#[derive(Debug, Clone, PartialEq)]
pub struct Tally {
    /// First and last slot with an epoch.
    pub span: Option<(i64, i64)>,
    last: Option<State>,
    /// Epochs expected and absent.
    pub n_missing: u64,
    /// Epochs without a solution.
    pub n_no_solution: u64,
    /// Epochs with one.
    pub n_solution: u64,
    /// Epochs with an error beyond its level in either axis.
    pub n_mi: u64,
    /// Errors and levels over epochs with a solution, horizontal and vertical.
    pub axes: [Axis; 2],
    /// Stanford histograms, horizontal and vertical.
    pub stanford: [Histogram; 2],
    /// The levels.
    pub levels: Vec<LevelTally>,
    /// Against time.
    pub series: Series,
    /// By GPS day.
    pub days: BTreeMap<i64, Day>,
}

impl Tally {
    /// Nothing yet.
    pub fn new(settings: &Settings) -> Self {
        let n_levels = settings.demands.len();
        Self {
            span: None,
            last: None,
            n_missing: 0,
            n_no_solution: 0,
            n_solution: 0,
            n_mi: 0,
            axes: Default::default(),
            stanford: Default::default(),
            levels: vec![LevelTally::default(); n_levels],
            series: Series::new(n_levels),
            days: BTreeMap::new(),
        }
    }

    /// Epochs the grid expects.
    pub fn n_expected(&self) -> u64 {
        self.n_missing + self.n_no_solution + self.n_solution
    }

    /// One more epoch, later than all before; absent ones between are accounted for.
    pub fn add(&mut self, epoch: &Epoch, settings: &Settings) {
        self.reach(epoch.slot, settings);
        let lacks: Vec<_> = settings.demands.iter().map(|demand| epoch.lacks(demand)).collect();
        for ((level, demand), lack) in self.levels.iter_mut().zip(&settings.demands).zip(&lacks) {
            level.add(epoch, demand, *lack, self.last, settings.window);
        }
        self.series.add(epoch, &lacks);
        let n_levels = lacks.len();
        let day = self.day(settings.grid.time_ns(epoch.slot).div_euclid(DAY_NS), n_levels);
        day.n_expected += 1;
        day.n_solution += u64::from(epoch.has_solution());
        for (sum, lack) in day.n_available.iter_mut().zip(&lacks) {
            *sum += u64::from(lack.is_none());
        }
        self.add_sizes(epoch, settings);
        self.last = Some(epoch.state);
        self.span = Some((self.span.map_or(epoch.slot, |(first, _)| first), epoch.slot));
    }

    fn add_sizes(&mut self, epoch: &Epoch, settings: &Settings) {
        if !epoch.has_solution() {
            self.n_no_solution += 1;
            return;
        }
        self.n_solution += 1;
        self.n_mi += u64::from(epoch.beyond_level(None));
        for (axis, (error, level)) in [(HPE, HPL), (VPE, VPL)].into_iter().enumerate() {
            let (error, level) = (epoch.size_m[error], epoch.size_m[level]);
            self.axes[axis].add(error, level, epoch.slot);
            self.stanford[axis].add(error, level, settings.bin_m, settings.n_bins);
        }
    }

    fn day(&mut self, day: i64, n_levels: usize) -> &mut Day {
        self.days.entry(day).or_insert_with(|| Day { n_available: vec![0; n_levels], ..Day::default() })
    }

    /// Account for the absent epochs before `slot`.
    fn reach(&mut self, slot: i64, settings: &Settings) {
        let Some((_, last)) = self.span else { return };
        let (first_absent, n) = (last + 1, slot.abs_diff(last) - 1);
        if n == 0 {
            return;
        }
        let before = self.last.take();
        for level in &mut self.levels {
            level.add_absent(first_absent, n, before, settings);
        }
        if settings.exclude_missing {
            return;
        }
        self.n_missing += n;
        self.series.add_absent(first_absent, n);
        self.absent_days(first_absent, slot, settings);
    }

    fn absent_days(&mut self, mut slot: i64, end: i64, settings: &Settings) {
        let grid = &settings.grid;
        while slot < end {
            let day = grid.time_ns(slot).div_euclid(DAY_NS);
            // The first slot at or after the next midnight: the nearest slot of an instant half a period less one later.
            let midnight = (day + 1).saturating_mul(DAY_NS);
            let next = grid.slot(midnight.saturating_add((grid.period_ns - 1) / 2)).max(slot + 1).min(end);
            self.day(day, settings.demands.len()).n_expected += next.abs_diff(slot);
            slot = next;
        }
    }

    /// The next stretch, all of it later; absent epochs between are accounted for.
    pub fn append(&mut self, next: Self, settings: &Settings) {
        let Some((first, last)) = next.span else { return };
        self.reach(first, settings);
        let before = self.last;
        for (level, more) in self.levels.iter_mut().zip(next.levels) {
            level.append(more, before, settings.window);
        }
        self.n_missing += next.n_missing;
        self.n_no_solution += next.n_no_solution;
        self.n_solution += next.n_solution;
        self.n_mi += next.n_mi;
        for axis in 0..2 {
            self.axes[axis] = self.axes[axis].merged(&next.axes[axis]);
        }
        for (histogram, more) in self.stanford.iter_mut().zip(next.stanford) {
            histogram.absorb(more);
        }
        self.series.absorb(next.series);
        for (day, more) in next.days {
            let sum = self.day(day, settings.demands.len());
            sum.n_expected += more.n_expected;
            sum.n_solution += more.n_solution;
            for (available, other) in sum.n_available.iter_mut().zip(&more.n_available) {
                *available += other;
            }
        }
        self.last = next.last;
        self.span = Some((self.span.map_or(first, |(begin, _)| begin), last));
    }
}
