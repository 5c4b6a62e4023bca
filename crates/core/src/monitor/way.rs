//! Does the position go the way that the reported speed says?

use super::motion::{Limits, Report, sea_level};
use crate::frame::EcefPosition;
use crate::quantity::{GpsTime, OutOfDomain};
use crate::special::float::sin;
use core::f64::consts::PI;

/// Share of the way by the reported speed that a position must make good, over [`WAY_LATENCIES`]: one of the two latencies may be lost to a
/// position that is late. Provenance: ours.
const WAY_SHARE: f64 = 0.5;
/// Shortest time over which the way is judged, in latencies. Provenance: ours.
const WAY_LATENCIES: f64 = 2.0;
/// Shortest reported way that is judged, in noises. Provenance: ours: half of it less one noise is one noise, so that a stand is seen.
const WAY_NOISES: f64 = 4.0;
/// Shortest time between two places of the way \[s\], so that noise at a high rate does not add up to a flight.
const PLACE_S: f64 = 1.0;
/// Half a turn below which the ends are as far apart as the way is long, to 1 % \[rad\]. Derived: 1 - w^2 / 6.
const WHOLE_RAD: f64 = 0.25;
/// Turning of an aircraft at 60 degrees of bank, g tan 60 \[m/s2\]. Provenance: ours.
pub const TURNING_MPS2: f64 = 17.0;
/// The straight line over a longer silence is not the way \[s\].
const SILENCE_S: f64 = 60.0;
/// Places that are remembered: the slowest aircraft that moves (15 m/s) needs 27 s for the shortest way (400 m). With larger limits the
/// earliest are forgotten, and a stand is seen later. Derived.
pub const MARKS: usize = 32;

/// How far apart the ends of a step are at least, however the aircraft turned in it \[m\]: it turns at no more than [`TURNING_MPS2`], and
/// where it may have gone round nothing is known.
///
/// ```text
/// s sin(w/2) / (w/2)        s = v t, w = a t / v, below one turn
/// ```
fn least_chord_m(speed_mps: f64, elapsed_s: f64) -> f64 {
    speed_mps * elapsed_s * chord_share(speed_mps, elapsed_s)
}

/// The same as a share of the way.
pub(super) fn chord_share(speed_mps: f64, elapsed_s: f64) -> f64 {
    let half = 0.5 * TURNING_MPS2 * elapsed_s / speed_mps;
    if half < WHOLE_RAD { 1.0 } else { sin(half.min(PI)) / half }
}

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

/// The places of reports without a speed, since the last with one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Through {
    /// The last of them.
    pub place: Report,
    /// Sum of the distances up to it \[m\].
    pub moved_m: f64,
    /// The longest time between two of them \[s\].
    pub longest_s: f64,
}

/// The way since the aircraft says that it moves. Lengths, not displacements: a turn goes as far as a straight flight. No heap.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Way {
    /// The last place.
    pub last: Option<(Report, Mark)>,
    /// The places since it that state no speed.
    pub through: Option<Through>,
    /// The places before it, the earliest first.
    pub marks: [Option<Mark>; MARKS],
    /// Since when the last position that was judged is behind.
    pub behind: Option<GpsTime>,
}

impl Way {
    /// For how long the positions up to this one have fallen behind the reported speed \[s\]. A report without a speed is as the one before it;
    /// its place is one of the way all the same.
    ///
    /// # Errors
    /// [`OutOfDomain`] for a position that is no place on the Earth.
    pub fn is_behind(&mut self, report: &Report, limits: &Limits) -> Result<Option<f64>, OutOfDomain> {
        let here = sea_level(report)?;
        let spoken = self.last.filter(|(last, _)| (0.0..=SILENCE_S).contains(&report.time.seconds_since(last.time)));
        if let Some((last, _)) = spoken.filter(|_| report.speed_mps.is_nan()) {
            self.pass(&last, report, &here)?;
            return Ok(self.behind.map(|since| report.time.seconds_since(since)));
        }
        let behind_s = self.with_speed(report, &here, limits)?;
        self.behind = behind_s.map(|behind_s| report.time.plus_seconds(-behind_s));
        Ok(behind_s)
    }

    fn pass(&mut self, last: &Report, report: &Report, here: &EcefPosition) -> Result<(), OutOfDomain> {
        let before = self.through.unwrap_or(Through { place: *last, moved_m: 0.0, longest_s: 0.0 });
        let step_s = report.time.seconds_since(before.place.time);
        if step_s >= PLACE_S {
            let moved_m = before.moved_m + here.minus(&sea_level(&before.place)?).vector().norm();
            self.through = Some(Through { place: *report, moved_m, longest_s: before.longest_s.max(step_s) });
        }
        Ok(())
    }

    fn with_speed(&mut self, report: &Report, here: &EcefPosition, limits: &Limits) -> Result<Option<f64>, OutOfDomain> {
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
        let through = self.through.unwrap_or(Through { place: last, moved_m: 0.0, longest_s: 0.0 });
        let longest_s = through.longest_s.max(report.time.seconds_since(through.place.time));
        // Steps of one length, the longest: what a turn may take of them is then the most.
        let steps = if longest_s > 0.0 { elapsed_s / longest_s } else { 0.0 };
        let now = Mark {
            time: report.time,
            moved_m: so_far.moved_m + through.moved_m + here.minus(&sea_level(&through.place)?).vector().norm(),
            reported_m: so_far.reported_m + steps * least_chord_m(last.speed_mps.min(report.speed_mps), longest_s),
        };
        if elapsed_s >= PLACE_S {
            self.through = None;
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

#[cfg(test)]
mod tests {
    use super::super::motion::Report;
    use super::super::motion::tests::LIMITS;
    use super::*;

    /// How many of sixty rows of an aircraft that circles, or stands, are behind.
    fn behind(step_s: f64, speed_mps: f64, rate_radps: f64, stands: bool) -> usize {
        let (mut way, radius_m) = (Way::default(), speed_mps / rate_radps);
        (0..60)
            .filter(|k| {
                let time_s = step_s * f64::from(*k);
                let [east, north] = if stands { [0.0, 1e-3 * time_s] } else { [(rate_radps * time_s).sin(), (rate_radps * time_s).cos()] };
                let [east, north] = if stands { [east, north] } else { [radius_m * east, radius_m * north] };
                let (lat_rad, lon_rad) = (0.8 + north / 6.37e6, 0.1 + east / (6.37e6 * 0.8_f64.cos()));
                let time = GpsTime::from_nanoseconds((time_s * 1e9) as i64);
                let report = Report { time, fixed: None, lat_rad, lon_rad, speed_mps, variance_m2: 4.0, height: None };
                way.is_behind(&report, &LIMITS).unwrap().is_some()
            })
            .count()
    }

    /// A stand at 64 m/s that states its speed in one of so many seconds: what was found stands until the next speed.
    #[test]
    fn a_stand_is_seen_where_speeds_are_rarely_stated() {
        for each in [1, 2, 5, 10, 12, 20, 40, 60] {
            let mut way = Way::default();
            let behind: Vec<bool> = (0..120)
                .map(|k| {
                    let speed_mps = if k % each == 0 { 64.0 } else { f64::NAN };
                    let time = GpsTime::from_nanoseconds(k * 1_000_000_000);
                    let (lat_rad, lon_rad) = (0.8 + f64::from(k as i32) * 1e-10, 0.1);
                    let report = Report { time, fixed: None, lat_rad, lon_rad, speed_mps, variance_m2: 4.0, height: None };
                    way.is_behind(&report, &LIMITS).unwrap().is_some()
                })
                .collect();
            let first = behind.iter().position(|b| *b).unwrap();
            // Judged from 20 s on, by the first speed after them.
            assert!(first <= 20 + each as usize && behind[first..].iter().all(|b| *b), "{each} {first}");
        }
    }

    /// A glider at 28 m/s and 15 degrees a second, a jet at 120 m/s and three: whatever the rows, a circle is no stand.
    #[test]
    fn a_circle_in_sparse_rows_is_no_stand() {
        for step_s in [1.0, 5.0, 10.0, 12.0, 20.0, 24.0, 30.0, 59.0] {
            assert_eq!(behind(step_s, 28.0, 15_f64.to_radians(), false), 0, "{step_s}");
            assert_eq!(behind(step_s, 120.0, 3_f64.to_radians(), false), 0, "{step_s}");
        }
    }

    /// In a step of 10 s at 64 m/s an aircraft turns by 1.33 at either side: 0.73 of 640 m are left.
    #[test]
    fn a_stand_in_sparse_rows_is_seen_where_no_turn_explains_it() {
        for step_s in [1.0, 5.0, 10.0] {
            assert!(behind(step_s, 64.0, 0.1, true) > 60 - 25, "{step_s}");
        }
        assert_eq!(behind(20.0, 28.0, 0.1, true), 0);
        assert!((least_chord_m(64.0, 10.0) - 640.0 * 1.328_125_f64.sin() / 1.328_125).abs() < 1e-9);
        assert!(least_chord_m(28.0, 20.0).abs() < 1e-9);
    }
}
