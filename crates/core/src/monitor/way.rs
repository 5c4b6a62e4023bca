//! Does the position go the way that the reported speed says?

use super::motion::{Limits, Report, sea_level};
use crate::quantity::{GpsTime, OutOfDomain};

/// Share of the way by the reported speed that a position must make good, over [`WAY_LATENCIES`]: one of the two latencies may be lost to a
/// position that is late. Provenance: ours.
const WAY_SHARE: f64 = 0.5;
/// Shortest time over which the way is judged, in latencies. Provenance: ours.
const WAY_LATENCIES: f64 = 2.0;
/// Shortest reported way that is judged, in noises. Provenance: ours: half of it less one noise is one noise, so that a stand is seen.
const WAY_NOISES: f64 = 4.0;
/// Shortest time between two places of the way \[s\], so that noise at a high rate does not add up to a flight.
const PLACE_S: f64 = 1.0;
/// The straight line over a longer silence is not the way \[s\].
const SILENCE_S: f64 = 60.0;
/// Places that are remembered: the slowest aircraft that moves (15 m/s) needs 27 s for the shortest way (400 m). With larger limits the
/// earliest are forgotten, and a stand is seen later. Derived.
pub const MARKS: usize = 32;

/// What was flown up to a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mark {
    /// Of the place.
    pub time: GpsTime,
    /// Sum of the distances between the places \[m\].
    pub moved_m: f64,
    /// The same by the reported speeds \[m\].
    pub reported_m: f64,
}

/// The way since the aircraft says that it moves. Lengths, not displacements: a turn goes as far as a straight flight. No heap.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Way {
    /// The last place.
    pub last: Option<(Report, Mark)>,
    /// The places before it, the earliest first.
    pub marks: [Option<Mark>; MARKS],
}

impl Way {
    /// For how long the positions up to this one have fallen behind the reported speed \[s\].
    ///
    /// # Errors
    /// [`OutOfDomain`] for a position that is no place on the Earth.
    pub fn is_behind(&mut self, report: &Report, limits: &Limits) -> Result<Option<f64>, OutOfDomain> {
        let here = sea_level(report)?;
        if !(report.speed_mps > limits.moving_mps) {
            *self = Self::default();
            return Ok(None);
        }
        let Some((last, so_far)) = self.last else {
            self.begin(report);
            return Ok(None);
        };
        let elapsed_s = report.time.seconds_since(last.time);
        if !(0.0..=SILENCE_S).contains(&elapsed_s) {
            *self = Self::default();
            self.begin(report);
            return Ok(None);
        }
        let now = Mark {
            time: report.time,
            moved_m: so_far.moved_m + here.minus(&sea_level(&last)?).vector().norm(),
            reported_m: so_far.reported_m + elapsed_s * last.speed_mps.min(report.speed_mps),
        };
        if elapsed_s >= PLACE_S {
            self.last = Some((*report, now));
            self.mark(now);
        }
        Ok(self.judge(&now, limits))
    }

    fn begin(&mut self, report: &Report) {
        let mark = Mark { time: report.time, moved_m: 0.0, reported_m: 0.0 };
        self.last = Some((*report, mark));
        self.mark(mark);
    }

    /// The next mark; the earliest makes room for it.
    fn mark(&mut self, mark: Mark) {
        if self.marks.iter().all(Option::is_some) {
            self.forget();
        }
        if let Some(room) = self.marks.iter_mut().find(|room| room.is_none()) {
            *room = Some(mark);
        }
    }

    /// Without the earliest mark.
    fn forget(&mut self) {
        self.marks.rotate_left(1);
        self.marks[MARKS - 1] = None;
    }

    /// From the latest mark that lies far enough back; those before it are no longer needed.
    fn judge(&mut self, now: &Mark, limits: &Limits) -> Option<f64> {
        let far = |from: &Mark| {
            let elapsed_s = now.time.seconds_since(from.time);
            now.reported_m - from.reported_m >= WAY_NOISES * limits.noise_m && elapsed_s >= WAY_LATENCIES * limits.latency_s
        };
        while self.marks[1].as_ref().is_some_and(far) {
            self.forget();
        }
        let from = self.marks[0].filter(far)?;
        let behind = now.moved_m - from.moved_m < WAY_SHARE * (now.reported_m - from.reported_m) - limits.noise_m;
        behind.then(|| now.time.seconds_since(from.time))
    }
}
