//! What a guard is set with, what it says of ranges, and what it counts.

use super::{DIFFERENCE_FLOOR, DIFFERENCE_INFLATION, Envelope, Tests};
use crate::bound::araim::single::Requirement;
use crate::frame::{Covariance, Enu};
use crate::monitor::judgement::RangesAgree;
use crate::signal::SatelliteId;
use crate::solution::ins::Difference;
use crate::solution::snapshot::{Snapshot, SnapshotVelocity};

/// How a guard is set.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Of the inertial unit and the vehicle.
    pub envelope: Envelope,
    /// Of the snapshot's test and level.
    pub requirement: Requirement,
    /// Standard deviation of the age of the satellite data \[s\]: its share of the level is three of them times the speed.
    pub age_sigma_s: f64,
    /// Hole in the inertial samples from which the unit is missing \[s\].
    pub gap_most_s: f64,
    /// Oldest measurement that is used \[s\].
    pub age_most_s: f64,
    /// Time for which the unit must be plausible and the contradiction last before the filter is started anew \[s\].
    pub restart_after_s: f64,
}

/// The ranges of an instant, judged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Admitted {
    /// Whether the filter may use them.
    pub usable: bool,
    /// Those that it may not use.
    pub excluded: [Option<SatelliteId>; EXCLUDED_MOST],
}

/// Satellites that are left out of an instant at most.
pub const EXCLUDED_MOST: usize = 4;

impl Admitted {
    /// Whether a satellite is left out.
    pub fn excludes(&self, satellite: SatelliteId) -> bool {
        self.excluded.contains(&Some(satellite))
    }
}

/// A snapshot with what its own test says.
#[derive(Debug, Clone)]
pub struct Looked {
    /// The position.
    pub snapshot: Snapshot,
    /// The velocity, where the rates determine one and agree.
    pub velocity: Option<SnapshotVelocity>,
    /// Whether the ranges agree.
    pub ranges_agree: RangesAgree,
    /// Levels, horizontal and vertical \[m\].
    pub level_m: [f64; 2],
}

/// What filter and snapshot may differ by.
#[derive(Debug, Clone, Copy)]
pub(super) struct Widths {
    /// Covariance of the difference of positions,
    pub(super) position: Covariance<Enu>,
    /// and of the velocities, where there are two.
    pub(super) velocity: Option<Covariance<Enu>>,
}

impl Widths {
    pub(super) fn of(d: &Difference, looked: &Looked, velocity: Option<&SnapshotVelocity>) -> Self {
        let own = looked.snapshot.covariance.matrix() * DIFFERENCE_FLOOR;
        Self {
            position: Covariance::claim_symmetric(d.covariance.matrix() * DIFFERENCE_INFLATION + own),
            velocity: velocity.map(|v| Covariance::claim_symmetric(v.covariance + d.velocity_m2ps2)),
        }
    }
}

/// Sums over the tests of a flight.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Tally {
    /// Instants.
    pub n: u64,
    /// Sum and largest of each square, in the order of [`Tests::square`].
    pub sum: [f64; 4],
    /// See [`Tally::sum`].
    pub most: [f64; 4],
    /// Times that a contradiction was raised.
    pub n_raised: u64,
}

impl Tally {
    pub(super) fn add(&mut self, tests: &Tests) {
        self.n += 1;
        for k in 0..4 {
            self.sum[k] += tests.square[k];
            self.most[k] = self.most[k].max(tests.square[k]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tally_has_the_sum_and_the_largest_of_each_square() {
        let mut tally = Tally::default();
        for square in [[1.0, 2.0, 3.0, 4.0], [5.0, 1.0, 0.5, 4.5]] {
            tally.add(&Tests { square, exceeds: [false; 4] });
        }
        assert_eq!((tally.n, tally.sum, tally.most), (2, [6.0, 3.0, 3.5, 8.5], [5.0, 2.0, 3.0, 4.5]));
    }
}
