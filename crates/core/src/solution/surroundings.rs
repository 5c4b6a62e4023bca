//! Whether a receiver's surroundings are those that its weights describe.
//!
//! One range that must be excluded is a fault of one signal. Ranges of several satellites within a minute, or residuals that contradict the
//! weights whatever is excluded, are no faults but surroundings: reflections and obstruction, which bias what is kept as well and leave
//! residuals that agree by chance. Then no position is better than its past minute: its covariance takes the variance factor of the
//! residuals *before* exclusion. Provenance: ours.

use super::point::Fix;
use crate::quantity::GpsTime;
use crate::signal::{Constellation, SatelliteId};
use crate::special::float::exp;

/// What was seen counts for this long \[s\], about the time a car needs through a street.
const MEMORY_S: f64 = 60.0;
/// Satellites excluded within the memory from which on it is not one signal's fault.
const SEVERAL: usize = 2;
const SLOTS: usize = 100 * Constellation::ALL.len();

/// The memory. No heap.
#[derive(Debug, Clone)]
pub struct Surroundings {
    /// When each satellite was last excluded.
    excluded: [Option<GpsTime>; SLOTS],
    /// When residuals last failed the test in spite of exclusion.
    failed: Option<GpsTime>,
    /// Sums over the past, fading: squared residuals before exclusion in units of their weights, and how many were redundant.
    statistic: f64,
    redundancy: f64,
    last: Option<GpsTime>,
}

impl Default for Surroundings {
    fn default() -> Self {
        Self { excluded: [None; SLOTS], failed: None, statistic: 0.0, redundancy: 0.0, last: None }
    }
}

impl Surroundings {
    /// Take the next position in time. Where surroundings contradict the weights: the factor that its variance needs, 1 or more.
    pub fn judge(&mut self, time: GpsTime, fix: &Fix) -> Option<f64> {
        let passed = self.last.map_or(0.0, |last| time.seconds_since(last));
        // A clock that was set back begins anew.
        if !(passed >= 0.0) {
            *self = Self::default();
        }
        self.last = Some(time);
        let fading = exp(-passed.max(0.0) / MEMORY_S);
        self.statistic = self.statistic * fading + fix.before_exclusion.0;
        self.redundancy = self.redundancy * fading + fix.before_exclusion.1 as f64;
        if fix.redundancy > 0 && !fix.consistent {
            self.failed = Some(time);
        }
        for satellite in fix.excluded.iter().flatten() {
            if let Some(slot) = self.excluded.get_mut(slot(*satellite)) {
                *slot = Some(time);
            }
        }
        let recent = |then: &GpsTime| time.seconds_since(*then) <= MEMORY_S;
        let several = self.excluded.iter().flatten().filter(|t| recent(t)).count() >= SEVERAL;
        let contradict = several || self.failed.as_ref().is_some_and(recent);
        contradict.then(|| (self.statistic / self.redundancy).max(1.0))
    }
}

fn slot(satellite: SatelliteId) -> usize {
    satellite.constellation.index() * 100 + usize::from(satellite.number)
}

#[cfg(test)]
#[path = "surroundings_tests.rs"]
pub(super) mod tests;
