//! Does the position get no further than the reported speed leads?

use super::motion::{Limits, Report};
use crate::frame::EcefPosition;
use crate::quantity::GpsTime;

/// Share of the way by the reported speed by which a place may be further on. Provenance: ours: what the positions of aircraft and their
/// speeds agree within over a minute, as `SLACK_MPS` is.
const SHARE: f64 = 0.05;
/// The same of a slow aircraft: rounding, a slow filter \[m/s\]. Provenance: ours.
const SLACK_MPS: f64 = 3.0;
/// Shortest time over which it is judged, in latencies. Provenance: ours: one of the two may be lost to a position that is late.
const LATENCIES: f64 = 2.0;
/// Least time between two places that are remembered \[s\]. Provenance: ours: two minutes in all.
const PLACE_S: f64 = 8.0;
/// After a longer gap the aircraft may have flown at any speed in it \[s\]. Provenance: ours.
const GAP_S: f64 = 60.0;
/// Places that are remembered.
pub const PLACES: usize = 16;

/// A place, and the way by the speeds reported up to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reached {
    /// When.
    pub time: GpsTime,
    /// Where, at sea level.
    pub place: EcefPosition,
    /// By the larger of the two speeds of every step \[m\].
    pub reported_m: f64,
    /// Largest speed reported since \[m/s\]: at which a late position may be late.
    pub fastest_mps: f64,
}

/// The places of the last two minutes. From each of them the aircraft gets no further than
///
/// ```text
/// 1.05 way + 3 m/s t + v latency + noise        way = sum of speed dt
/// ```
///
/// with the reported speed, and v the largest. A step is judged by itself elsewhere, with the latency that each may have; here many small ones have it once.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Ahead {
    /// The last report and its speed \[m/s\].
    pub last: Option<(GpsTime, f64)>,
    /// Way by the reported speeds \[m\].
    pub reported_m: f64,
    /// The earliest first.
    pub places: [Option<Reached>; PLACES],
    /// What was found last.
    pub ahead: bool,
}

impl Ahead {
    /// Whether the position of this report, at `here`, is further on than the speeds lead; an unchanged one is as old as the change. A report
    /// without a speed is as the one before it, and nothing is forgotten by it.
    pub fn is_ahead(&mut self, report: &Report, here: &EcefPosition, unchanged: bool, limits: &Limits) -> bool {
        let since_s = self.last.map(|(time, _)| report.time.seconds_since(time));
        if report.speed_mps.is_nan() && since_s.is_some_and(|since_s| (0.0..=GAP_S).contains(&since_s)) {
            return self.ahead;
        }
        self.ahead = self.with_speed(report, here, unchanged, limits);
        self.ahead
    }

    fn with_speed(&mut self, report: &Report, here: &EcefPosition, unchanged: bool, limits: &Limits) -> bool {
        let Some(step_m) = self.step_m(report) else {
            *self = Self::default();
            self.last = Some((report.time, report.speed_mps)).filter(|(_, speed_mps)| speed_mps.is_finite());
            if self.last.is_some() && !unchanged {
                self.remember(report, here);
            }
            return false;
        };
        self.reported_m += step_m;
        for place in self.places.iter_mut().flatten() {
            place.fastest_mps = place.fastest_mps.max(report.speed_mps);
        }
        self.last = Some((report.time, report.speed_mps));
        if unchanged || report.age_s() > limits.stale_after_s {
            return false;
        }
        let ahead = self.places.iter().flatten().any(|from| self.exceeds(from, report, here, limits));
        if self.places.iter().flatten().last().is_none_or(|last| report.time.seconds_since(last.time) >= PLACE_S) {
            self.remember(report, here);
        }
        ahead
    }

    /// Way by the reported speeds since the last report \[m\]; None where one of the two states none, and after a gap in which it may have been any.
    fn step_m(&self, report: &Report) -> Option<f64> {
        let (time, speed_mps) = self.last?;
        let elapsed_s = report.time.seconds_since(time);
        let known = (0.0..=GAP_S).contains(&elapsed_s) && report.speed_mps.is_finite();
        known.then(|| elapsed_s * speed_mps.max(report.speed_mps))
    }

    fn exceeds(&self, from: &Reached, report: &Report, here: &EcefPosition, limits: &Limits) -> bool {
        let elapsed_s = report.time.seconds_since(from.time);
        // A dated position may be as old as one that is not yet stale, and its date wrong by the latency of dates.
        let late_s = report.fixed.map_or(limits.latency_s, |_| limits.stale_after_s + limits.fix_latency_s);
        let most_m =
            (1.0 + SHARE) * (self.reported_m - from.reported_m) + SLACK_MPS * elapsed_s + late_s * from.fastest_mps + limits.noise_m;
        elapsed_s >= LATENCIES * limits.latency_s && here.minus(&from.place).vector().norm() > most_m
    }

    fn remember(&mut self, report: &Report, here: &EcefPosition) {
        let reached = Reached { time: report.time, place: *here, reported_m: self.reported_m, fastest_mps: report.speed_mps };
        if self.places.iter().all(Option::is_some) {
            self.places.rotate_left(1);
            self.places[PLACES - 1] = None;
        }
        if let Some(room) = self.places.iter_mut().find(|room| room.is_none()) {
            *room = Some(reached);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::motion::sea_level;
    use super::super::motion::tests::LIMITS;
    use super::*;

    fn report(time_s: f64, north_m: f64, speed_mps: f64, dated: bool) -> Report {
        let time = GpsTime::from_nanoseconds((time_s * 1e9) as i64);
        let (lat_rad, lon_rad) = (0.8 + north_m / 6.368e6, 0.1);
        Report { time, fixed: dated.then_some(time), lat_rad, lon_rad, speed_mps, variance_m2: 4.0, height: None }
    }

    /// The seconds at which a track is ahead, whose place is a function of time, as its speed is.
    fn ahead(seconds: u32, dated: bool, place_m: impl Fn(f64) -> f64, speed_mps: impl Fn(f64) -> f64) -> Vec<u32> {
        let (mut track, mut before) = (Ahead::default(), None);
        (0..seconds)
            .filter(|k| {
                let each = report(f64::from(*k), place_m(f64::from(*k)), speed_mps(f64::from(*k)), dated);
                let unchanged = before == Some(each.lat_rad);
                before = Some(each.lat_rad);
                track.is_ahead(&each, &sea_level(&each).unwrap(), unchanged, &LIMITS)
            })
            .collect()
    }

    #[test]
    fn a_flight_by_its_speeds_is_never_ahead() {
        for speed_mps in [0.0, 5.0, 60.0, 250.0] {
            for dated in [false, true] {
                assert_eq!(ahead(600, dated, |t| speed_mps * t, |_| speed_mps), []);
                // Its speed is 5 % low, or 3 m/s.
                assert_eq!(ahead(600, dated, |t| (1.05 * speed_mps + 3.0) * t, |_| speed_mps), []);
            }
        }
        // It takes off at 3 m/s2; its speed is that of a second ago.
        assert_eq!(ahead(60, false, |t| 1.5 * t * t, |t| 3.0 * (t - 1.0).max(0.0)), []);
    }

    /// Led by 80 m/s from 100 s on at 124 m/s: from the place of 96 s, 80 (t - 100) > (6.2 + 3) (t - 96) + 124 late + 100 first at 120 s undated
    /// and at 108 s dated, where that of 88 s is judged and 80 * 8 < 9.2 * 20 + 472 < 80 * 9.
    #[test]
    fn a_position_that_is_led_ahead_is_so_until_two_minutes_after_it() {
        for (dated, first) in [(false, 120), (true, 109)] {
            let led = ahead(600, dated, |t| 124.0 * t + 80.0 * (t - 100.0).clamp(0.0, 60.0), |_| 124.0);
            assert_eq!(led[0], first);
            let last = *led.last().unwrap();
            assert_eq!(led, (first..=last).collect::<Vec<_>>());
            // A place of 120 s is remembered for 120 s at least: 3.2 km of lead are left, more than 9.2 * 120 + 1340 m. None is for 129 s.
            assert!((240..=160 + 128).contains(&last), "{last}");
        }
    }

    /// Rows half a minute apart, led by 80 m/s at 124 m/s from the first on: 80 t > 9.2 t + 1340 m after 18.9 s, judged from 20 s on.
    #[test]
    fn sparse_reports_are_judged_as_well() {
        let mut track = Ahead::default();
        let ahead = (0..20).map(|k| {
            let each = report(f64::from(30 * k), 204.0 * f64::from(30 * k), 124.0, false);
            track.is_ahead(&each, &sea_level(&each).unwrap(), false, &LIMITS)
        });
        assert_eq!(ahead.collect::<Vec<_>>(), [[false].as_slice(), &[true; 19]].concat());
    }

    #[test]
    fn a_stand_at_walking_pace_is_no_flight() {
        assert!(!ahead(200, false, |t| 14.0 * t, |_| 0.0).is_empty());
        assert_eq!(ahead(200, false, |t| 3.0 * t, |_| 0.0), []);
    }

    /// A minute's hold, and on from where it would have been; ten seconds late; a gap; speeds that are not stated.
    #[test]
    fn what_is_late_or_unknown_is_not_ahead() {
        let hold = |t: f64| if (100.0..160.0).contains(&t) { 12_400.0 } else { 124.0 * t };
        assert_eq!(ahead(400, false, hold, |_| 124.0), []);
        assert_eq!(ahead(400, false, |t| 124.0 * (t - 10.0 * f64::from(u8::from(t < 200.0))), |_| 124.0), []);
        let unknown = |t: f64| if (140.0..201.0).contains(&t) { f64::NAN } else { 124.0 };
        assert_eq!(ahead(300, false, |t| 124.0 * t + if t >= 150.0 { 9_000.0 } else { 0.0 }, unknown), []);
        let mut track = Ahead::default();
        for (time_s, north_m) in [(0.0, 0.0), (60.0, 7440.0), (120.5, 90_000.0), (150.0, 93_500.0)] {
            let each = report(time_s, north_m, 124.0, false);
            assert!(!track.is_ahead(&each, &sea_level(&each).unwrap(), false, &LIMITS));
        }
    }

    /// A speed in one of sixty rows is one, and what it found stands until the next.
    #[test]
    fn speeds_that_are_rarely_stated_are_judged_as_well() {
        let rarely = |each: u32| move |t: f64| if (t as u32).is_multiple_of(each) { 124.0 } else { f64::NAN };
        for each in [5, 12, 30, 60] {
            let led = ahead(600, false, |t| 204.0 * t, rarely(each));
            let first = led[0];
            assert!((20..20 + each).contains(&first), "{each} {first}");
            assert_eq!(led, (first..600).collect::<Vec<_>>(), "{each}");
            assert_eq!(ahead(600, false, |t| 124.0 * t, rarely(each)), []);
        }
        assert_eq!(ahead(600, false, |t| 204.0 * t, rarely(61)), []);
    }

    #[test]
    fn a_stale_position_is_no_place_to_go_on_from() {
        let mut track = Ahead::default();
        for k in 0..200 {
            // Every fourth position is 30 s old and says so; its place is that of then.
            let age_s = if k % 4 == 3 { 30.0 } else { 0.0 };
            let time_s = f64::from(k);
            let fresh = report(time_s, 250.0 * (time_s - age_s), 250.0, true);
            let each = Report { fixed: Some(fresh.time.plus_seconds(-age_s)), ..fresh };
            assert!(!track.is_ahead(&each, &sea_level(&each).unwrap(), false, &LIMITS), "{k}");
        }
    }
}
