//! Whether the way that speeds say is travelled at last: what holds, slow lags and spells without a speed take away from it is within every
//! limit of its own.
//!
//! Over the minutes in which a track moves, its positions may lack five kilometres and a fiftieth of the way by its speeds. Where
//! reports state no speed the way goes on from the last that did to the next, however far apart they are: no spell without a speed hides what
//! is lost in it.

use super::neighbours::east_north_m;
use super::way::chord_share;
use crate::special::float::hypot;

/// Slower aircraft turn more tightly than the legs of a way follow: their way is that of their steps, less what a turn takes of each.
/// Provenance: ours \[m/s\].
const FAST_MPS: f64 = 80.0;
/// What is slower may stand: noise is a way of its own. Provenance: ours \[m/s\].
pub(super) const MOVING_MPS: f64 = 5.0;
/// Share of a way that lies between its ends where it is straight: elsewhere legs would cut the turns. Provenance: ours \[1\].
const STRAIGHT: f64 = 0.98;
/// What the way of the positions of a track may lack in all. Provenance: ours \[m\].
const LACK_M: f64 = 5000.0;
/// The share of the way by its speeds that it may lack more: a turn of three degrees a second shortens legs by one in a hundred. Provenance:
/// ours \[1\].
const LACK_SHARE: f64 = 0.02;
/// Shortest window \[ns\].
pub(super) const WINDOW_NS: i64 = 60_000_000_000;
/// Between two statements, and two places, up to this far apart the speed changes evenly and the way is straight \[ns\]. Provenance: ours.
pub(super) const EVEN_NS: i64 = 10_000_000_000;
/// Legs of the way that positions travel: the noise of each step would add up to a way of its own \[ns\]. Provenance: ours.
const LEG_NS: i64 = 10_000_000_000;
/// What an aircraft changes its speed by at the most between two statements that are further apart \[m/s2\]. Provenance: ours.
const CHANGE_MPS2: f64 = 1.0;
/// After a longer silence of its positions an aircraft may have come back \[ns\]. Provenance: ours.
const SILENCE_NS: i64 = 60_000_000_000;

/// A place of a track that is believed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct At {
    /// When, in nanoseconds of any origin.
    pub time_ns: i64,
    /// Latitude \[rad\].
    pub lat_rad: f64,
    /// Longitude \[rad\].
    pub lon_rad: f64,
    /// Reported speed over the ground, NaN where none is \[m/s\].
    pub speed_mps: f64,
}

impl At {
    fn apart_m(&self, other: &Self) -> f64 {
        let [east, north] = east_north_m([self.lat_rad, self.lon_rad], [other.lat_rad, other.lon_rad]);
        hypot(east, north)
    }
}

/// The part of a way since the last window that was closed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// Where it began, with a speed.
    pub begin: At,
    /// The last report with a speed.
    pub spoken: At,
    /// Where the last leg began.
    pub leg: At,
    /// The last place.
    pub last: At,
    /// The longest time between two places since the last speed \[ns\].
    pub longest_ns: i64,
    /// By the steps between places, and by legs, without the one that is open \[m\].
    pub moved_m: [f64; 2],
    /// By the speeds: where they change evenly between statements, and the least that they may have been \[m\].
    pub reported_m: [f64; 2],
}

impl Window {
    const fn begin(at: At) -> Self {
        Self { begin: at, spoken: at, leg: at, last: at, longest_ns: 0, moved_m: [0.0; 2], reported_m: [0.0; 2] }
    }

    fn step(&mut self, at: At) {
        self.longest_ns = self.longest_ns.max(at.time_ns.saturating_sub(self.last.time_ns));
        self.moved_m[0] += self.last.apart_m(&at);
        if at.time_ns.saturating_sub(self.leg.time_ns) >= LEG_NS {
            self.moved_m[1] += self.leg.apart_m(&at);
            self.leg = at;
        }
        self.last = at;
    }

    /// The way by the speeds since the last report of one.
    ///
    /// ```text
    /// even  = (v0 + v1) t / 2
    /// least = chord (even - a (t^2 - ((v1 - v0) / a)^2) / 4)        slower by a to halfway, and faster again
    /// ```
    fn speak(&mut self, at: At) {
        let elapsed_ns = at.time_ns.saturating_sub(self.spoken.time_ns);
        let (elapsed_s, longest_s) = (elapsed_ns as f64 * 1e-9, self.longest_ns as f64 * 1e-9);
        let [v0, v1] = [self.spoken.speed_mps, at.speed_mps];
        let even_m = 0.5 * (v0 + v1) * elapsed_s;
        let spread_s = (v1 - v0) / CHANGE_MPS2;
        let slower_m =
            if elapsed_ns > EVEN_NS { (0.25 * CHANGE_MPS2 * (elapsed_s * elapsed_s - spread_s * spread_s)).max(0.0) } else { 0.0 };
        let turns = self.longest_ns > EVEN_NS || v0.min(v1) < FAST_MPS;
        let chord = if turns { chord_share(v0.min(v1).max(MOVING_MPS), longest_s) } else { 1.0 };
        let least_m = (chord * (even_m - slower_m)).max(0.0);
        self.reported_m = [self.reported_m[0] + even_m, self.reported_m[1] + least_m];
        (self.spoken, self.longest_ns) = (at, 0);
    }

    /// Ways of the positions and by the speeds, where the window is one to judge: of what moves \[m\].
    fn ways_m(&self) -> Option<[f64; 2]> {
        let [steps_m, legs_m] = self.moved_m;
        let [even_m, least_m] = self.reported_m;
        let length_s = self.last.time_ns.saturating_sub(self.begin.time_ns) as f64 * 1e-9;
        let fast = even_m >= FAST_MPS * length_s;
        let by_legs_m = steps_m.min(legs_m + self.leg.apart_m(&self.last));
        let straight = self.begin.apart_m(&self.last) >= STRAIGHT * by_legs_m;
        let way_m = if fast && straight { by_legs_m } else { steps_m };
        // What the aircraft may have flown is no lack, and makes none good.
        let by_speed_m = if way_m < even_m { way_m.max(least_m) } else { even_m };
        let judged = by_speed_m >= MOVING_MPS * length_s;
        judged.then_some([way_m, by_speed_m])
    }
}

/// The ways of one track. No heap.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Balance {
    /// The window that is open.
    pub window: Option<Window>,
    /// Of all windows that count: by the positions, and by the speeds \[m\].
    pub ways_m: [f64; 2],
}

impl Balance {
    /// The next place, in the order of time.
    pub fn see(&mut self, at: At) {
        let speaks = at.speed_mps.is_finite();
        let Some(window) = self.window.as_mut().filter(|window| at.time_ns.saturating_sub(window.last.time_ns) <= SILENCE_NS) else {
            self.window = speaks.then(|| Window::begin(at));
            return;
        };
        if at.time_ns <= window.last.time_ns {
            return;
        }
        window.step(at);
        if !speaks {
            return;
        }
        window.speak(at);
        if at.time_ns.saturating_sub(window.begin.time_ns) >= WINDOW_NS {
            let [way_m, by_speed_m] = window.ways_m().unwrap_or_default();
            self.ways_m = [self.ways_m[0] + way_m, self.ways_m[1] + by_speed_m];
            self.window = Some(Window::begin(at));
        }
    }

    /// By how much the positions are behind, by all that was seen, where that is more than they may be \[m\].
    #[must_use]
    pub fn behind_m(&self) -> Option<f64> {
        let [way_m, by_speed_m] = self.ways_m;
        Some(by_speed_m - way_m).filter(|lack_m| *lack_m > LACK_M + LACK_SHARE * by_speed_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a straight flight to the north lacks in the end: places and speeds by the second, where there is a row \[m\].
    fn lack_m(seconds: u32, north_m: impl Fn(u32) -> f64, speed_mps: impl Fn(u32) -> Option<f64>) -> f64 {
        let mut balance = Balance::default();
        for k in 0..seconds {
            let Some(speed_mps) = speed_mps(k) else { continue };
            balance.see(At { time_ns: i64::from(k) * 1_000_000_000, lat_rad: 0.8 + north_m(k) / 6.368e6, lon_rad: 0.1, speed_mps });
        }
        balance.ways_m[1] - balance.ways_m[0]
    }

    /// The first so many seconds of each two minutes, up to nine times.
    fn in_spell(k: u32, length: u32) -> bool {
        k % 120 < length && k / 120 < 9
    }

    /// The way at 240 m/s, and at half of it in spells \[m\].
    fn half_in_spells(length: u32) -> impl Fn(u32) -> f64 {
        move |k| (0..k).map(|each| if in_spell(each, length) { 120.0 } else { 240.0 }).sum()
    }

    #[test]
    fn what_is_lost_in_spells_without_a_speed_is_lacking() {
        for length in [5, 10, 49, 61, 90] {
            let speed = |k: u32| Some(if in_spell(k, length) && k > 0 { f64::NAN } else { 240.0 });
            let (lack, length_s) = (lack_m(1300, half_in_spells(length), speed), f64::from(length));
            // Of each spell half, less what an aircraft is slower by at 1 m/s2 to halfway and back.
            let least = 8.0 * (120.0 * length_s - 0.25 * (length_s + 1.0) * (length_s + 1.0) - 240.0);
            assert!(lack >= least && lack <= 9.0 * 120.0 * length_s + 300.0, "{length}: {lack} {least}");
        }
    }

    /// The rows of the spells are missing: of 49 s an aircraft at 60 degrees of bank leaves 0.57 of its way.
    #[test]
    fn what_is_lost_in_silences_is_lacking_where_no_turn_explains_it() {
        let speed = |length: u32| move |k: u32| (!in_spell(k, length) || k.is_multiple_of(120)).then_some(240.0);
        assert!(lack_m(1300, half_in_spells(20), speed(20)) > 8.0 * 1500.0);
        assert!(lack_m(1300, half_in_spells(49), speed(49)) < 5000.0);
    }

    #[test]
    fn a_flight_that_slows_in_spells_without_a_speed_lacks_nothing() {
        let flown = |length: u32| {
            move |k: u32| -> f64 {
                let slower = |each: u32| if in_spell(each, length) { f64::from((each % 120).min(length - each % 120)) } else { 0.0 };
                (0..k).map(|each| 240.0 - slower(each)).sum()
            }
        };
        for length in [5, 10, 20, 49, 61, 90] {
            let speed = |k: u32| Some(if in_spell(k, length) { f64::NAN } else { 240.0 });
            let lack = lack_m(1300, flown(length), speed);
            assert!(lack.abs() < 9.0 * 60.0, "{length}: {lack}");
        }
    }

    /// The same of slow aircraft: at half of the speed in nine spells of 49 s.
    #[test]
    fn slow_aircraft_are_judged_as_well() {
        for speed_mps in [40.0, 60.0, 79.0] {
            let share = speed_mps / 240.0;
            let half = half_in_spells(49);
            let speed = |k: u32| Some(if in_spell(k, 49) && k > 0 { f64::NAN } else { speed_mps });
            let lack = lack_m(1300, |k| share * half(k), speed);
            // Of each spell half, less 600 m by slowing, and 1 % by a turn in each second.
            assert!(lack > 8.0 * (0.5 * speed_mps * 49.0 - 625.0 - 0.03 * speed_mps * 49.0), "{speed_mps}: {lack}");
            assert!(lack_m(1300, |k| speed_mps * f64::from(k), speed).abs() < 50.0, "{speed_mps}");
        }
    }

    /// A glider that circles, and one that turns about each ten seconds: a shortened way is no lack.
    #[test]
    fn tight_turns_of_slow_aircraft_lack_nothing() {
        for (speed_mps, rate_radps, step_s) in [(28.0, 0.26, 1), (28.0, 0.1, 5), (60.0, 0.05, 10), (45.0, 0.35, 1)] {
            let mut balance = Balance::default();
            for k in 0..720 {
                let (time_s, half_s) = (f64::from(k * step_s), 10.0);
                // Arcs to either side in turn.
                let (n, within_s) = ((time_s / half_s).floor(), time_s % half_s);
                let (chord_m, turned) = (2.0 * speed_mps / rate_radps * (0.5 * rate_radps * half_s).sin(), rate_radps * within_s);
                let (radius_m, begin) = (speed_mps / rate_radps, 0.5 * rate_radps * half_s);
                let north_m = n * chord_m + radius_m * (begin.sin() - (begin - turned).sin());
                let east_m = radius_m * ((begin - turned).cos() - begin.cos()) * if n as i64 % 2 == 0 { 1.0 } else { -1.0 };
                let (lat_rad, lon_rad) = (0.8 + north_m / 6.368e6, 0.1 + east_m / (6.368e6 * 0.8_f64.cos()));
                balance.see(At { time_ns: i64::from(k * step_s) * 1_000_000_000, lat_rad, lon_rad, speed_mps });
            }
            let [way_m, by_speed_m] = balance.ways_m;
            // Steps that turn by less than `WHOLE_RAD` to either side are taken for straight.
            assert!(by_speed_m - way_m < 0.01 * by_speed_m + 1.0, "{speed_mps} {step_s}: {way_m} {by_speed_m}");
        }
    }

    /// At 0.7 of the reported speed, in turns of 1 degree a second to either side, a minute each, and in circles at 60 degrees of bank.
    #[test]
    fn turns_hide_no_lack_and_make_none() {
        for (share, speed_mps, rate_radps, seconds) in [(0.7, 100.0, 0.0175, 60), (1.0, 100.0, 0.17, 3600), (1.0, 80.0, 0.21, 3600)] {
            let (mut balance, [mut east_m, mut north_m, mut course_rad]) = (Balance::default(), [0.0_f64; 3]);
            for k in 0..3600 {
                let (lat_rad, lon_rad) = (0.8 + north_m / 6.368e6, 0.1 + east_m / (6.368e6 * 0.8_f64.cos()));
                balance.see(At { time_ns: i64::from(k) * 1_000_000_000, lat_rad, lon_rad, speed_mps });
                // A tenth of a second at a time: an arc.
                for _ in 0..10 {
                    course_rad += 0.1 * rate_radps * if (k / seconds) % 2 == 0 { 1.0 } else { -1.0 };
                    (east_m, north_m) =
                        (east_m + 0.1 * share * speed_mps * course_rad.sin(), north_m + 0.1 * share * speed_mps * course_rad.cos());
                }
            }
            let [way_m, by_speed_m] = balance.ways_m;
            let lack = (by_speed_m - way_m) / by_speed_m;
            assert!((lack - (1.0 - share)).abs() < 0.005, "{share} {speed_mps}: {lack}");
            assert_eq!(balance.behind_m().is_some(), share < 1.0);
        }
    }

    /// A way that an aircraft may have flown faster than the least makes nothing good.
    #[test]
    fn a_long_spell_makes_no_lack_good() {
        let half = |k: u32| if k < 300 { 120.0 * f64::from(k) } else { 240.0 * f64::from(k) - 36_000.0 };
        let speed = |k: u32| Some(if (301..1000).contains(&k) { f64::NAN } else { 240.0 });
        assert!((lack_m(1100, half, speed) - 36_000.0).abs() < 500.0);
    }

    /// 3 m of noise on a way of 80 m a second, five times a second, adds a tenth to the steps, and nothing to legs.
    #[test]
    fn noise_makes_no_way() {
        let mut balance = Balance::default();
        for k in 0..3000_i64 {
            let noise_m = [3.0, -3.0, 0.0, -3.0, 3.0][(k % 5) as usize];
            let (north_m, east_m) = (12.0 * k as f64, noise_m);
            let (lat_rad, lon_rad) = (0.8 + north_m / 6.368e6, 0.1 + east_m / (6.368e6 * 0.8_f64.cos()));
            balance.see(At { time_ns: k * 200_000_000, lat_rad, lon_rad, speed_mps: 100.0 });
        }
        let lack_m = balance.ways_m[1] - balance.ways_m[0];
        assert!((lack_m - 540.0 * 40.0).abs() < 0.01 * 60_000.0, "{lack_m}");
    }
}
