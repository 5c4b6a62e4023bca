use super::*;

const RADIUS_M: f64 = 6.371e6;

/// A flight second by second: courses of the aircraft, and what its positions and reports are made of.
#[derive(Clone, Copy)]
struct Flight<'a> {
    seconds: u32,
    every_s: u32,
    speed_mps: f64,
    /// Rate of turn \[rad/s\] at a second.
    rate_radps: &'a dyn Fn(f64) -> f64,
    /// Reported track of the true one \[rad\].
    reported: &'a dyn Fn(f64, u32) -> f64,
    /// East and north that the positions are away at a second \[m\].
    away_m: &'a dyn Fn(u32) -> [f64; 2],
    /// How late the positions are \[s\].
    lag_s: u32,
    sigma_m: f64,
    /// Whether there is a row.
    row: &'a dyn Fn(u32) -> bool,
}

const STRAIGHT_ON: Flight<'static> = Flight {
    seconds: 1800,
    every_s: 1,
    speed_mps: 70.0,
    rate_radps: &|_| 0.0,
    reported: &|track_rad, _| track_rad,
    away_m: &|_| [0.0; 2],
    lag_s: 0,
    sigma_m: 0.0,
    row: &|_| true,
};

impl Flight<'_> {
    /// The drift when it shows, and in which second.
    fn drifted(&self, course_rad: f64) -> Option<(Drifted, u32)> {
        const PARTS: u32 = 20;
        let (mut drift, mut track_rad, mut at) = (Drift::default(), course_rad, [0.5, 0.1]);
        let mut places = std::vec::Vec::new();
        for k in 0..self.seconds {
            places.push(at);
            let [lat_rad, lon_rad]: [f64; 2] = places[k.saturating_sub(self.lag_s) as usize];
            let away_m = (self.away_m)(k);
            let (lat_rad, lon_rad) = (lat_rad + away_m[1] / RADIUS_M, lon_rad + away_m[0] / RADIUS_M / lat_rad.cos());
            if k % self.every_s == 0 && (self.row)(k) {
                let (speed_mps, track_rad) = (self.speed_mps, (self.reported)(track_rad, k));
                drift.see(Led {
                    at: At { time_ns: i64::from(k) * 1_000_000_000, lat_rad, lon_rad, speed_mps },
                    track_rad,
                    sigma_m: self.sigma_m,
                });
                if let Some(drifted) = drift.drifted() {
                    return Some((drifted, k));
                }
            }
            for part in 0..PARTS {
                let step_rad = self.speed_mps / f64::from(PARTS) / RADIUS_M;
                at = [at[0] + step_rad * track_rad.cos(), at[1] + step_rad * track_rad.sin() / at[0].cos()];
                track_rad += (self.rate_radps)(f64::from(k) + f64::from(part) / f64::from(PARTS)) / f64::from(PARTS);
            }
        }
        None
    }
}

/// Noise of a fixed seed, of one standard deviation.
fn noise(k: u32) -> [f64; 2] {
    let mut state = 0x9e37_79b9_u64.wrapping_mul(u64::from(k) + 1);
    let mut uniform = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state % 1_000_003) as f64 / 1_000_003.0
    };
    [(); 2].map(|()| (0..12).map(|_| uniform()).sum::<f64>() - 6.0)
}

#[test]
fn positions_that_go_another_way_show_after_a_minute_or_two() {
    for off_deg in [30.0, 60.0, 90.0, 150.0, 180.0, -90.0] {
        let turned = Flight { reported: &|track_rad, _| track_rad + f64::to_radians(off_deg), ..STRAIGHT_ON };
        let (_, at_s) = turned.drifted(0.5 * PI).unwrap();
        assert!(at_s <= 120, "{off_deg}: {at_s}");
    }
    // Slow ones take as long as two kilometres.
    for off_deg in [90.0, 180.0] {
        let car = Flight { speed_mps: 10.0, reported: &|track_rad, _| track_rad + f64::to_radians(off_deg), ..STRAIGHT_ON };
        assert!(car.drifted(1.0).unwrap().1 <= 300, "{off_deg}");
    }
}

#[test]
fn a_slow_drift_shows_after_minutes_however_long_the_flight_was_right() {
    for begins_s in [0, 1200] {
        let led_off = Flight { seconds: 3600, away_m: &|k| [5.0 * f64::from(k.saturating_sub(begins_s)), 0.0], ..STRAIGHT_ON };
        let (drifted, at_s) = led_off.drifted(0.0).unwrap();
        assert!((600..=1000).contains(&(at_s - begins_s)), "{at_s}");
        assert!((drifted.aside_m / f64::from(drifted.n) - 300.0).abs() < 5.0);
        assert!(drifted.over_m > 0.0 && drifted.way_m > 40_000.0);
    }
    // Within the share, as a track that is a degree off leaves it.
    let within = Flight { seconds: 7200, away_m: &|k| [1.6 * f64::from(k), 0.0], ..STRAIGHT_ON };
    assert_eq!(within.drifted(0.0), None);
}

/// Statements each ten seconds, of slow aircraft too far apart to know what lies between.
#[test]
fn rows_up_to_ten_seconds_apart_are_judged() {
    let off: &dyn Fn(f64, u32) -> f64 = &|track_rad, _| track_rad + 1.0;
    for (every_s, speed_mps, shows) in [(5, 70.0, true), (10, 70.0, true), (11, 70.0, false), (10, 40.0, false), (1, 4.0, false)] {
        let flight = Flight { seconds: 3600, every_s, speed_mps, reported: off, ..STRAIGHT_ON };
        assert_eq!(flight.drifted(0.3).is_some(), shows, "{every_s} {speed_mps}");
    }
}

/// A course that swings from row to row has turned between them, and the way is an arc.
#[test]
fn a_minute_that_swings_between_rows_is_not_straight() {
    for (swing_rad, shows) in [(1.0, false), (0.05, true)] {
        let swings = |_, k: u32| if (k / 5).is_multiple_of(2) { swing_rad } else { -swing_rad };
        let flight = Flight { every_s: 5, reported: &swings, ..STRAIGHT_ON };
        assert_eq!(flight.drifted(0.5 * PI).is_some(), shows, "{swing_rad}");
    }
}

/// Statements by the second, places five times as often: those without are passed over.
#[test]
fn places_without_a_statement_hide_nothing() {
    let off = Flight { reported: &|track_rad, k| if k.is_multiple_of(5) { track_rad + 1.0 } else { f64::NAN }, ..STRAIGHT_ON };
    assert!(off.drifted(0.3).unwrap().1 <= 130);
    let none = Flight { reported: &|_, _| f64::NAN, ..STRAIGHT_ON };
    assert_eq!(none.drifted(0.3), None);
}

/// Positions that are seconds late: turns to either side, and the same one again and again, as in a holding.
#[test]
fn a_lag_in_turns_is_no_drift() {
    for (speed_mps, rate_degps, lag_s) in
        [(70.0, 3.0, 5), (110.0, 3.0, 3), (110.0, 1.5, 8), (28.0, 15.0, 2), (50.0, 6.0, 3), (230.0, 1.0, 3)]
    {
        for straight_s in [40.0, 60.0, 75.0, 100.0, 240.0] {
            for alternates in [true, false] {
                let turn_s = 180.0 / rate_degps;
                let rate = |time_s: f64| {
                    let (n, within_s) = ((time_s / (straight_s + turn_s)).floor(), time_s % (straight_s + turn_s));
                    let side = if alternates && n % 2.0 > 0.5 { -1.0 } else { 1.0 };
                    if within_s > straight_s { side * f64::to_radians(rate_degps) } else { 0.0 }
                };
                let holding = Flight { seconds: 7200, speed_mps, rate_radps: &rate, lag_s, ..STRAIGHT_ON };
                assert_eq!(holding.drifted(0.3), None, "{speed_mps} {rate_degps} {straight_s} {alternates}");
            }
        }
    }
    // Turns all the time.
    for rate_degps in [0.3, 0.5, 1.0, 3.0, 20.0] {
        let circles = Flight { seconds: 3600, rate_radps: &|_| f64::to_radians(rate_degps), lag_s: 5, ..STRAIGHT_ON };
        assert_eq!(circles.drifted(0.3), None, "{rate_degps}");
    }
}

#[test]
fn courses_that_are_rounded_or_cut_are_right() {
    for course_deg in [0.49, 45.5, 89.99, 123.999, 271.4, 358.7] {
        for (grid_deg, cut) in [(1.0, false), (1.0, true), (360.0 / 256.0, false), (360.0 / 256.0, true), (360.0 / 128.0, true)] {
            let rounded = |track_rad: f64, _| {
                let times = track_rad.to_degrees() / grid_deg;
                (grid_deg * if cut { times.floor() } else { times.round() }).to_radians()
            };
            let flight = Flight { seconds: 7200, reported: &rounded, ..STRAIGHT_ON };
            assert_eq!(flight.drifted(f64::to_radians(course_deg)), None, "{course_deg} {grid_deg} {cut}");
        }
    }
    // A course with decimals that is as far off.
    let off = Flight { seconds: 7200, reported: &|track_rad, _| track_rad - f64::to_radians(2.7), ..STRAIGHT_ON };
    assert!(off.drifted(f64::to_radians(45.53)).is_some());
}

/// ADS-B states velocities in whole knots, rounded or cut.
#[test]
fn tracks_of_whole_knots_are_right() {
    for speed_mps in [30.0, 60.0, 110.0, 230.0] {
        for course_deg in [1.0, 17.3, 44.4, 89.2, 200.7, 315.5] {
            let knots = |track_rad: f64, _| {
                let part = |share: f64| (speed_mps * share * 3600.0 / 1852.0).round();
                part(track_rad.sin()).atan2(part(track_rad.cos()))
            };
            let flight = Flight { seconds: 7200, speed_mps, reported: &knots, ..STRAIGHT_ON };
            assert_eq!(flight.drifted(f64::to_radians(course_deg)), None, "{speed_mps} {course_deg}");
        }
    }
}

#[test]
fn noise_as_large_as_stated_is_no_drift() {
    for (speed_mps, sigma_m) in [(5.5, 30.0), (10.0, 100.0), (70.0, 100.0), (70.0, 500.0), (70.0, 2000.0)] {
        for correlated_s in [1, 60, 300] {
            let away = |k: u32| noise(k / correlated_s).map(|each| 0.707 * sigma_m * each);
            let flight = Flight { seconds: 14_400, speed_mps, away_m: &away, sigma_m, ..STRAIGHT_ON };
            assert_eq!(flight.drifted(0.3), None, "{speed_mps} {sigma_m} {correlated_s}");
        }
    }
}

/// What was added up before a silence stays; the way over it is no minute.
#[test]
fn a_silence_ends_a_minute_and_not_the_sum() {
    // Half a minute in each three is silent, and so is a row of twelve seconds.
    for silent_s in [12, 30, 90] {
        let led_off = Flight { seconds: 3600, away_m: &|k| [5.0 * f64::from(k), 0.0], row: &|k| k % 200 >= silent_s, ..STRAIGHT_ON };
        assert!(led_off.drifted(0.0).is_some(), "{silent_s}");
    }
    // A jump over a silence, to the same side again and again, is judged by others.
    let jumps = Flight { seconds: 7200, away_m: &|k| [f64::from(k / 200) * 1500.0, 0.0], row: &|k| k % 200 >= 12, ..STRAIGHT_ON };
    assert_eq!(jumps.drifted(0.0), None);
    // Silences that leave no minute leave nothing to judge.
    let pieces = Flight { seconds: 7200, reported: &|track_rad, _| track_rad + 1.0, row: &|k| k % 60 >= 12, ..STRAIGHT_ON };
    assert_eq!(pieces.drifted(0.0), None);
}

/// A source that repeats speed and track for three minutes, beginning in any part of a turn, as a recording of Paris does; and one that has no
/// other at all.
#[test]
fn a_statement_that_is_repeated_contradicts_only_where_it_lasts() {
    for turn_deg in [10.0, 36.0, 90.0, 150.0] {
        let rate = |time_s: f64| if (300.0..330.0).contains(&time_s) { f64::to_radians(turn_deg / 30.0) } else { 0.0 };
        for begin_s in (240..=330).step_by(10) {
            for straight_deg in [0.0, 0.1] {
                // While it flies straight the track changes by its last digit, or does not.
                let repeats = |track_rad: f64, k: u32| {
                    if (begin_s..begin_s + 165).contains(&k) { 0.3 } else { track_rad + f64::to_radians(straight_deg) * f64::from(k % 2) }
                };
                let flight = Flight { rate_radps: &rate, reported: &repeats, speed_mps: 205.0, ..STRAIGHT_ON };
                assert_eq!(flight.drifted(0.3), None, "{turn_deg} {begin_s} {straight_deg}");
            }
        }
        let for_good = Flight { rate_radps: &rate, reported: &|_, _| 0.3, speed_mps: 205.0, ..STRAIGHT_ON };
        assert!(for_good.drifted(0.3).unwrap().1 <= 660, "{turn_deg}");
    }
    let circling = Flight { rate_radps: &|_| f64::to_radians(1.0), reported: &|_, _| 0.3, ..STRAIGHT_ON };
    assert!(circling.drifted(0.3).unwrap().1 <= 600);
    // To either side in turn, and on the way between: what is left out once is not again.
    let rate =
        |time_s: f64| if time_s % 240.0 < 20.0 { f64::to_radians([3.0, -3.0, -3.0, 3.0][(time_s / 240.0) as usize % 4]) } else { 0.0 };
    let wanders = Flight { seconds: 3600, rate_radps: &rate, reported: &|_, _| 0.3, ..STRAIGHT_ON };
    assert!(wanders.drifted(0.3).is_some());
}

#[test]
fn directions_at_high_latitudes_and_over_the_date_line_are_right() {
    for lat_deg in [60.0_f64, 80.0, 88.0] {
        let mut drift = Drift::default();
        // A line of constant course to the north-east, at 240 m/s.
        let (mut lat_rad, mut lon_rad) = (lat_deg.to_radians(), 3.1);
        for k in 0..600_i64 {
            let track_rad = 0.25 * PI;
            let east = if lon_rad > PI { lon_rad - 2.0 * PI } else { lon_rad };
            drift.see(Led { at: At { time_ns: k * 1_000_000_000, lat_rad, lon_rad: east, speed_mps: 240.0 }, track_rad, sigma_m: 0.0 });
            let part = 240.0 / RADIUS_M * 0.5_f64.sqrt();
            (lat_rad, lon_rad) = (lat_rad + part, lon_rad + part / (lat_rad + 0.5 * part).cos());
        }
        let beyond_m = drift.sums.sides[0].map(|side| side.beyond_m);
        assert!(beyond_m == [0.0; 2], "{lat_deg}: {beyond_m:?}");
    }
}
