//! Exact percentiles in memory that does not grow with the campaign: the digits of the ranked value, most significant first.
//!
//! The bits of a double that is not negative order as the double does. One pass over all epochs counts the next eleven bits of those
//! values whose leading bits are already those of the ranked value; six passes give all 64. Nothing is sorted and nothing is kept.

use super::epoch::{Columns, Epoch, HPE, HPL, Refused, Settings, VPE, VPL};
use super::spread::Axis;
use super::tally::Tally;
use crate::parallel;
use navbound_core::quantity::OutOfDomain;

/// Percentiles, in thousandths.
pub const PERMILLE: [u64; 4] = [500, 950, 990, 999];
/// Quantities of a scope: horizontal error, level and index, then the vertical ones.
pub const QUANTITIES: usize = 6;

const DIGIT_BITS: u32 = 11;
const SHIFTS: [u32; 6] = [55, 44, 33, 22, 11, 0];

/// A value that is looked for by its rank.
#[derive(Debug, Clone)]
struct Target {
    /// Rank among the values that share the prefix, from 0.
    rank: u64,
    prefix: u64,
    counts: Vec<u64>,
}

/// One quantity over the epochs with a solution, or over those where a level is available.
#[derive(Debug, Clone)]
struct Column {
    level: Option<usize>,
    quantity: usize,
    targets: Vec<Target>,
}

/// A selection under way.
#[derive(Debug, Clone)]
pub struct Selector {
    settings: Settings,
    columns: Vec<Column>,
    pass: usize,
    last: Option<i64>,
}

impl Selector {
    /// Percentiles by nearest rank of everything in `tally`, the value at place ceil(q n), from 1.
    pub fn new(tally: &Tally, settings: &Settings) -> Self {
        let scopes = std::iter::once((None, &tally.axes)).chain(tally.levels.iter().enumerate().map(|(i, l)| (Some(i), &l.axes)));
        let columns = scopes.flat_map(|(level, axes)| (0..QUANTITIES).map(move |q| Column::new(level, q, count(axes, q)))).collect();
        Self { settings: settings.clone(), columns, pass: 0, last: None }
    }

    /// Passes over all epochs that are needed.
    pub const fn passes() -> usize {
        SHIFTS.len()
    }

    /// The next rows of this pass, as [`super::Campaign::add`] was given them.
    ///
    /// # Errors
    /// As there.
    pub fn scan(&mut self, columns: &Columns<'_>) -> Result<(), Refused> {
        let (epochs, _) = columns.epochs(&self.settings.grid, self.last)?;
        self.last = epochs.last().map(|e| e.slot).or(self.last);
        let (shift, settings) = (SHIFTS[self.pass.min(SHIFTS.len() - 1)], &self.settings);
        parallel::fill(&mut self.columns, 1, |_, columns| columns.iter_mut().for_each(|column| column.count(&epochs, shift, settings)));
        Ok(())
    }

    /// End of a pass.
    ///
    /// # Errors
    /// [`OutOfDomain`] when this pass was given other epochs than were tallied.
    pub fn narrow(&mut self) -> Result<(), OutOfDomain> {
        let other =
            OutOfDomain { argument: "pass", value: self.pass as f64, unit: "1", domain: "passes over the epochs that were tallied" };
        if self.pass >= SHIFTS.len() {
            return Err(other);
        }
        for target in self.columns.iter_mut().flat_map(|c| &mut c.targets) {
            target.narrow().ok_or(other)?;
        }
        self.pass += 1;
        self.last = None;
        Ok(())
    }

    /// The percentiles, a row of [`PERMILLE`] for each of [`QUANTITIES`] for each scope; NaN of nothing. Meaningful after all passes.
    pub fn values(&self) -> Vec<f64> {
        let of =
            |c: &Column| (0..PERMILLE.len()).map(|k| c.targets.get(k).map_or(f64::NAN, |t| f64::from_bits(t.prefix))).collect::<Vec<_>>();
        self.columns.iter().flat_map(of).collect()
    }
}

fn count(axes: &[Axis; 2], quantity: usize) -> u64 {
    let axis = &axes[quantity / 3];
    [axis.error.n, axis.level.n, axis.index.n][quantity % 3]
}

impl Column {
    fn new(level: Option<usize>, quantity: usize, n: u64) -> Self {
        let target = |permille: u64| Target { rank: (n * permille).div_ceil(1000).max(1) - 1, prefix: 0, counts: vec![0; 1 << DIGIT_BITS] };
        Self { level, quantity, targets: if n == 0 { Vec::new() } else { PERMILLE.into_iter().map(target).collect() } }
    }

    fn value(&self, epoch: &Epoch, settings: &Settings) -> f64 {
        let counts = epoch.has_solution() && self.level.is_none_or(|l| epoch.lacks(&settings.demands[l]).is_none());
        if !counts {
            return f64::NAN;
        }
        let (error, level) =
            if self.quantity < 3 { (epoch.size_m[HPE], epoch.size_m[HPL]) } else { (epoch.size_m[VPE], epoch.size_m[VPL]) };
        [error, level, error / level][self.quantity % 3]
    }

    fn count(&mut self, epochs: &[Epoch], shift: u32, settings: &Settings) {
        if self.targets.is_empty() {
            return;
        }
        for epoch in epochs {
            let value = self.value(epoch, settings);
            if value.is_nan() {
                continue;
            }
            let bits = value.to_bits() >> shift;
            for target in &mut self.targets {
                if bits >> DIGIT_BITS == target.prefix {
                    target.counts[(bits & ((1 << DIGIT_BITS) - 1)) as usize] += 1;
                }
            }
        }
    }
}

impl Target {
    fn narrow(&mut self) -> Option<()> {
        let mut below = 0;
        let digit = self.counts.iter().position(|n| {
            below += n;
            below > self.rank
        })?;
        self.rank -= below - self.counts[digit];
        self.prefix = self.prefix << DIGIT_BITS | digit as u64;
        self.counts.fill(0);
        Some(())
    }
}
