//! Held and jumping positions.

#![allow(clippy::unwrap_used)] // A test may stop at the first surprise, its helpers too.

use navbound_assess::plausible::{Finding, Limits, Report, judge};
use navbound_core::quantity::GpsTime;

const LIMITS: Limits = Limits {
    max_speed_mps: 400.0,
    speed_factor: 1.25,
    speed_margin_mps: 25.0,
    latency_s: 2.0,
    fix_latency_s: 1.0,
    noise_m: 100.0,
    moving_mps: 15.0,
    stale_after_s: 2.0,
    settle_s: 30.0,
    period_s: 0.0,
};

/// Radians of latitude in a metre at the equator, where the meridian's radius is 6335439 m.
const RAD_PER_M: f64 = 1.0 / 6_335_439.0;

/// Northwards along a meridian from the equator: positions \[m\] at whole seconds.
fn track(positions_m: &[f64], speed_mps: f64) -> Vec<Report> {
    let report = |(i, m): (usize, &f64)| Report {
        time: GpsTime::from_nanoseconds(1_000_000_000 * i as i64),
        fixed: None,
        lat_rad: m * RAD_PER_M,
        lon_rad: 0.3,
        speed_mps,
        variance_m2: f64::NAN,
        height: None,
    };
    positions_m.iter().enumerate().map(report).collect()
}

fn findings(reports: &[Report]) -> Vec<Finding> {
    judge(reports, &LIMITS).unwrap().iter().map(|j| j.finding).collect()
}

#[test]
fn steady_flight_is_plausible() {
    let positions: Vec<f64> = (0..100).map(|i| 100.0 * f64::from(i)).collect();
    assert!(findings(&track(&positions, 100.0)).iter().all(|f| *f == Finding::Plausible));
}

#[test]
fn a_repeated_position_is_degraded_and_then_stale_and_ends_with_the_next() {
    use Finding::{Plausible, Repeated, Stale};
    let judged = judge(&track(&[0.0, 100.0, 100.0, 100.0, 100.0, 100.0, 600.0], 100.0), &LIMITS).unwrap();
    let findings: Vec<Finding> = judged.iter().map(|j| j.finding).collect();
    assert_eq!(findings, [Plausible, Plausible, Repeated, Repeated, Stale, Stale, Plausible]);
    assert_eq!(judged[5].age_s, 4.0);
    // 500 m along the meridian; the chord is shorter by 1e-7 of it.
    assert!((judged[6].step_m - 500.0).abs() < 1e-3, "{}", judged[6].step_m);
}

#[test]
fn a_flight_in_hardly_any_time_is_a_jump_however_small_its_steps() {
    // 70 m each millisecond: each step is within the latency of one position, all of them within that of one hundred.
    let crawl = |k: i64| Report {
        time: GpsTime::from_nanoseconds(1_000_000 * k),
        fixed: None,
        lat_rad: 70.0 * k as f64 * RAD_PER_M,
        lon_rad: 0.3,
        speed_mps: f64::NAN,
        variance_m2: f64::NAN,
        height: None,
    };
    let verdicts = findings(&(0..1200).map(crawl).collect::<Vec<_>>());
    // 400 m/s for two seconds of latency and 0.1 km of noise are 0.9 km: thirteen steps.
    assert_eq!(verdicts.iter().position(|f| *f == Finding::Jump), Some(13));
    assert!(verdicts[13..].iter().all(|f| matches!(f, Finding::Jump | Finding::Unsettled)));
}

#[test]
fn an_aircraft_that_gathers_speed_flies_as_far_as_it_reported() {
    // 100 to 250 m/s within a minute and back: the ends of a window alone would allow less than was flown.
    let mut flown_m = 0.0;
    let reports: Vec<Report> = (0..240)
        .map(|k| {
            let speed_mps = 100.0 + 150.0 * (1.0 - f64::from((k % 120 - 60i32).abs()) / 60.0);
            flown_m += speed_mps;
            Report { speed_mps, ..track(&[flown_m; 240], 0.0)[k as usize] }
        })
        .collect();
    assert!(findings(&reports).iter().all(|f| *f == Finding::Plausible));
}

#[test]
fn a_parked_aircraft_may_repeat_its_position() {
    for speed in [0.0, 2.0] {
        assert!(findings(&track(&[5.0; 1200], speed)).iter().all(|f| *f == Finding::Plausible), "{speed} m/s");
    }
    // Further than 100 m and two seconds of 14 m/s it would be elsewhere: after 9.1 s.
    let slow = findings(&track(&[5.0; 60], 14.0));
    assert_eq!(slow.iter().position(|f| *f == Finding::Stale), Some(10));
}

/// Twenty minutes of the last fix, from the begin and in flight; up to the stale time a slow one's position may round to the same.
#[test]
fn without_a_speed_a_position_that_repeats_its_bits_is_stale_in_time() {
    let verdicts = findings(&track(&[5.0; 1200], f64::NAN));
    assert!(verdicts[..=2].iter().all(|f| *f == Finding::Plausible), "{:?}", &verdicts[..4]);
    assert!(verdicts[3..].iter().all(|f| *f == Finding::Stale));
    let positions: Vec<f64> = (0..1300).map(|k| 70.0 * f64::from(k.min(100))).collect();
    let verdicts = findings(&track(&positions, f64::NAN));
    assert!(verdicts[..=102].iter().all(|f| *f == Finding::Plausible));
    assert!(verdicts[103..].iter().all(|f| *f == Finding::Stale));
}

#[test]
fn a_receiver_that_is_known_to_stand_may_repeat_its_position() {
    let standing = Limits { moving_mps: f64::INFINITY, ..LIMITS };
    let judged = judge(&track(&[5.0; 1200], f64::NAN), &standing).unwrap();
    assert!(judged.iter().all(|j| j.finding == Finding::Plausible));
}

/// A centimetre of noise, at once a second and at ten times a second.
#[test]
fn a_position_that_stands_with_noise_while_the_aircraft_says_it_moves_is_stale() {
    for (per_s, speed_mps) in [(1, 70.0), (10, 70.0), (1, 20.0)] {
        let flown: Vec<f64> = (0..600 * per_s)
            .map(|k| {
                let stood = k.min(100 * per_s);
                speed_mps * f64::from(stood) / f64::from(per_s) + if k > stood { 0.01 * f64::from(k % 7 - 3) } else { 0.0 }
            })
            .collect();
        let mut reports = track(&flown, speed_mps);
        reports.iter_mut().enumerate().for_each(|(k, r)| r.time = GpsTime::from_nanoseconds(1_000_000_000 / i64::from(per_s) * k as i64));
        let verdicts = findings(&reports);
        let before = (100 * per_s) as usize;
        assert!(verdicts[..=before].iter().all(|f| *f == Finding::Plausible));
        // 400 m by the reported speed, and one second more between two places.
        let seen = before + ((400.0 / speed_mps).ceil() as usize + 1) * per_s as usize;
        assert!(
            verdicts[seen..].iter().all(|f| *f == Finding::Stale),
            "{per_s} a second, {speed_mps} m/s: {:?}",
            &verdicts[before..seen + 3]
        );
    }
}

/// 70 m/s reported and 10 m/s flown: after 6 s 60 m of the 420 m, of which half less the noise are 110 m.
#[test]
fn a_position_that_goes_less_than_half_the_reported_way_is_stale() {
    for per_s in [10.0, -10.0] {
        let flown: Vec<f64> = (0..100).map(|k| per_s * f64::from(k)).collect();
        assert!(findings(&track(&flown, 70.0))[6..].iter().all(|f| *f == Finding::Stale), "{per_s} m/s");
    }
}

/// 25 m/s around a circle of 80 m: once around in 20 s, and never further than 160 m from where it was.
#[test]
fn a_circle_goes_as_far_as_a_straight_flight() {
    let mut reports = track(&[0.0; 300], 25.0);
    for (k, report) in reports.iter_mut().enumerate() {
        let (sin, cos) = (25.0 / 80.0 * k as f64).sin_cos();
        report.lat_rad = 80.0 * sin * RAD_PER_M;
        report.lon_rad = 0.3 + 80.0 * cos / 6_378_137.0;
    }
    assert!(findings(&reports).iter().all(|f| *f == Finding::Plausible));
}

#[test]
fn a_flight_that_goes_on_after_a_stand_is_believed_again() {
    let flown: Vec<f64> =
        (0..100).map(|k| 70.0 * f64::from(if k < 20 { k } else { (k - 20).max(20) }) + 0.001 * f64::from(k % 3)).collect();
    let verdicts = findings(&track(&flown, 70.0));
    assert_eq!(verdicts[30], Finding::Stale);
    assert!(verdicts[47..].iter().all(|f| *f == Finding::Plausible), "{verdicts:?}");
}

#[test]
fn without_a_speed_positions_that_take_turns_are_stale_in_time() {
    let turns: Vec<f64> = (0..100).map(|k| f64::from(k % 2)).collect();
    let verdicts = findings(&track(&turns, f64::NAN));
    assert!(verdicts[..=3].iter().all(|f| *f == Finding::Plausible), "{:?}", &verdicts[..4]);
    assert!(verdicts[4..].iter().all(|f| *f == Finding::Stale));
}

/// Frozen with a centimetre of noise for 5 s, and on from where the flight is by then: 350 m in a second; 212.5 m need no latency.
#[test]
fn without_a_speed_the_step_after_a_stand_is_a_jump() {
    let flown: Vec<f64> =
        (0..200).map(|k| if (50..55).contains(&k) { 3500.0 + 0.01 * f64::from(k % 3) } else { 70.0 * f64::from(k) }).collect();
    let verdicts = findings(&track(&flown, f64::NAN));
    assert_eq!(verdicts[55], Finding::Jump);
    assert!(verdicts[56..=85].iter().all(|f| *f == Finding::Unsettled));
    assert_eq!(verdicts[86], Finding::Plausible);
}

#[test]
fn where_the_speed_ends_with_the_fix_a_repeat_is_stale_too() {
    let mut reports = track(&[0.0, 70.0, 140.0, 140.0, 140.0, 140.0, 140.0], 70.0);
    reports[3..].iter_mut().for_each(|r| r.speed_mps = f64::NAN);
    assert_eq!(findings(&reports)[5..], [Finding::Stale, Finding::Stale]);
}

/// A receiver that lost its fix at 70 m/s, in a recording: the last position with a speed of 0 for 5 to 200 s, then on where the flight is by then.
#[test]
fn a_hold_that_states_a_speed_of_nothing_is_stale_and_its_end_a_jump() {
    let wide = Limits { latency_s: 10.0, ..LIMITS };
    for hold_s in [5_usize, 60, 200] {
        let flown: Vec<f64> = (0..400).map(|k| 70.0 * if (100..100 + hold_s).contains(&k) { 100.0 } else { k as f64 }).collect();
        let mut reports = track(&flown, 70.0);
        reports[100..100 + hold_s].iter_mut().for_each(|r| r.speed_mps = 0.0);
        let verdicts: Vec<Finding> = judge(&reports, &wide).unwrap().iter().map(|j| j.finding).collect();
        assert!(verdicts[..=102].iter().all(|f| *f == Finding::Plausible), "{hold_s} s");
        assert!(verdicts[103..100 + hold_s].iter().all(|f| *f == Finding::Stale), "{hold_s} s");
        // The step of 5 s is within what the latency explains: (1.25 x 70 + 25) m/s in 1 + 10 s, and 100 m, are 1337.5 m.
        assert_eq!(verdicts[100 + hold_s] == Finding::Jump, hold_s > 5, "{hold_s} s");
    }
}

/// 70 m/s, and one step of 500 m: (1.25 * 70 + 25) m/s * (1 + 2) s + 100 m = 437.5 m. With the 200 m/s of one epoch it would be 925 m.
#[test]
fn one_wild_speed_lets_no_step_pass() {
    let flown: Vec<f64> = (0..100).map(|k| 70.0 * f64::from(k) + if k < 50 { 0.0 } else { 430.0 }).collect();
    for wild in [0, 1, 4] {
        let mut reports = track(&flown, 70.0);
        reports[50..50 + wild].iter_mut().for_each(|r| r.speed_mps = 200.0);
        let judged = judge(&reports, &LIMITS).unwrap();
        assert_eq!(judged[50].finding, Finding::Jump, "{wild} wild");
        assert_eq!(judged.iter().filter(|j| j.speed_doubted).count(), wild);
    }
}

#[test]
fn a_speed_that_grows_is_believed() {
    // 0 to 80 m/s in 40 s, seen each second and each ten seconds.
    for every in [1, 10] {
        let (mut flown_m, mut positions) = (0.0, Vec::new());
        let mut speeds = Vec::new();
        for k in 0..=80 {
            let speed: f64 = 2.0 * f64::from(k.min(40));
            flown_m += speed;
            if k % every == 0 {
                positions.push(flown_m);
                speeds.push(speed);
            }
        }
        let mut reports = track(&positions, 0.0);
        for (k, (report, speed)) in reports.iter_mut().zip(speeds).enumerate() {
            report.speed_mps = speed;
            report.time = GpsTime::from_nanoseconds(1_000_000_000 * i64::from(every) * k as i64);
        }
        let judged = judge(&reports, &LIMITS).unwrap();
        assert!(judged.iter().all(|j| j.finding == Finding::Plausible && !j.speed_doubted), "every {every} s");
    }
}

/// (1.25 * 100 + 25) m/s * (1 + 2) s + 100 m = 550 m.
#[test]
fn a_jump_is_what_lies_beyond_the_reach() {
    assert_eq!(findings(&track(&[0.0, 549.0], 100.0))[1], Finding::Plausible);
    assert_eq!(findings(&track(&[0.0, 551.0], 100.0))[1], Finding::Jump);
}

/// 400 m/s * (1 + 2) s + 100 m = 1300 m, whatever a falsified speed says. Without any speed, what needs latency (beyond 500 m) is a jump.
#[test]
fn without_a_speed_or_with_an_absurd_one_the_fastest_aircraft_is_the_measure() {
    for (speed, within) in [(f64::NAN, Finding::Jump), (5000.0, Finding::Plausible)] {
        assert_eq!(findings(&track(&[0.0, 499.0], speed))[1], Finding::Plausible);
        assert_eq!(findings(&track(&[0.0, 1299.0], speed))[1], within);
        assert_eq!(findings(&track(&[0.0, 1301.0], speed))[1], Finding::Jump);
    }
}

/// Own speed 50 m/s: (1.25 * 50 + 25) m/s * 1 s + 100 m = 187.5 m need no latency, and nothing vouches for more.
#[test]
fn a_track_that_reports_no_speed_is_judged_by_its_own() {
    let flown = |step_m: f64| {
        let mut positions: Vec<f64> = (0..100).map(|k| 50.0 * f64::from(k)).collect();
        positions.push(positions[99] + step_m);
        findings(&track(&positions, f64::NAN))[100]
    };
    assert_eq!([187.0, 188.0, 362.0, 363.0].map(flown), [Finding::Plausible, Finding::Jump, Finding::Jump, Finding::Jump]);
}

#[test]
fn after_a_jump_nothing_is_believed_until_it_has_settled() {
    let mut positions = vec![0.0];
    positions.extend((0..40).map(|i| 50_000.0 + 100.0 * f64::from(i)));
    let verdicts = findings(&track(&positions, 100.0));
    assert_eq!(verdicts[1], Finding::Jump);
    assert!(verdicts[2..=31].iter().all(|f| *f == Finding::Unsettled), "{verdicts:?}");
    assert!(verdicts[32..].iter().all(|f| *f == Finding::Plausible), "{verdicts:?}");
}

#[test]
fn a_position_that_comes_back_after_a_long_hold_is_no_jump() {
    let mut positions = vec![0.0; 88];
    positions.push(8_800.0);
    assert_eq!(findings(&track(&positions, 100.0))[88], Finding::Plausible);
    positions[88] = 20_000.0;
    assert_eq!(findings(&track(&positions, 100.0))[88], Finding::Jump);
}

#[test]
fn no_place_on_the_earth_is_refused_with_its_index() {
    let mut reports = track(&[0.0, 1.0, 2.0], 100.0);
    reports[2].lat_rad = f64::NAN;
    assert_eq!(judge(&reports, &LIMITS).unwrap_err().0, 2);
}

#[test]
fn a_step_is_judged_by_the_time_of_its_position_where_that_is_known() {
    // Rows of one second; the positions were valid 25 s apart, or one second apart.
    let at = |row: i64, fixed: Option<i64>, m: f64| Report {
        time: GpsTime::from_nanoseconds(1_000_000_000 * row),
        fixed: fixed.map(|s| GpsTime::from_nanoseconds(1_000_000_000 * s)),
        lat_rad: m * RAD_PER_M,
        lon_rad: 0.3,
        speed_mps: 200.0,
        variance_m2: f64::NAN,
        height: None,
    };
    let wide = Limits { latency_s: 10.0, ..LIMITS };
    let second = |a: Report, b: Report| judge(&[a, b], &wide).unwrap()[1];
    // 5 km in 25 s is flown, though the rows are a second apart and even ten seconds of latency do not reach it.
    assert_eq!(second(at(30, Some(5), 0.0), at(31, Some(30), 5000.0)).finding, Finding::Plausible);
    assert_eq!(second(at(30, None, 0.0), at(31, None, 5000.0)).finding, Finding::Jump);
    // 2.9 km in a second is not, where both positions are dated; undated it can be lateness, which is said.
    assert_eq!(second(at(30, Some(30), 0.0), at(31, Some(31), 2900.0)).finding, Finding::Jump);
    let undated = second(at(30, None, 0.0), at(31, None, 2900.0));
    assert_eq!(undated.finding, Finding::Late);
    // 100 m of noise off, in one second.
    assert!((undated.too_fast_mps - 2800.0).abs() < 1e-3, "{}", undated.too_fast_mps);
    // One position dated and one not: the rows' times count.
    assert_eq!(second(at(30, Some(5), 0.0), at(31, None, 5000.0)).finding, Finding::Jump);
    // An ordinary step says nothing.
    let ordinary = second(at(30, None, 0.0), at(31, None, 200.0));
    assert_eq!((ordinary.finding, ordinary.too_fast_mps), (Finding::Plausible, 0.0));
}

#[test]
fn noise_on_a_hold_that_states_no_speed_after_flight_is_stale_as_the_hold_is() {
    // 70 m/s for 100 s, then decimetres about the last place at a speed of 0.
    let positions: Vec<f64> =
        (0..400).map(|k| 70.0 * f64::from(k.min(100)) + if k > 100 { 0.5 * (12.9 * f64::from(k)).sin() } else { 0.0 }).collect();
    let speed = |k: usize| if k < 101 { 70.0 } else { 0.0 };
    let reports: Vec<Report> =
        track(&positions, 0.0).into_iter().enumerate().map(|(k, each)| Report { speed_mps: speed(k), ..each }).collect();
    let verdicts = findings(&reports);
    assert!(verdicts[..104].iter().all(|f| *f == Finding::Plausible));
    assert!(verdicts[104..].iter().all(|f| *f == Finding::Stale), "{:?}", &verdicts[100..110]);
    let standing = Limits { moving_mps: f64::INFINITY, ..LIMITS };
    assert!(judge(&reports, &standing).unwrap().iter().all(|j| j.finding == Finding::Plausible));
}

#[test]
fn a_track_that_never_leaves_its_first_place_while_its_reports_come_faster_than_a_receiver_s_is_stale() {
    let stands = |n: i64, step_ns: i64, speed_mps: f64| {
        let at = |k: i64| Report { time: GpsTime::from_nanoseconds(k * step_ns), ..track(&[0.0], speed_mps)[0] };
        findings(&(0..n).map(at).collect::<Vec<_>>())
    };
    assert!(stands(10, 1_000_000, f64::NAN).iter().all(|f| *f == Finding::Stale));
    assert!(stands(1900, 1_000_000, f64::NAN).iter().all(|f| *f == Finding::Stale));
    // Too few to say, as fast as a receiver, and one that says that it stands.
    for (n, step_ns, speed_mps) in [(9, 1_000_000, f64::NAN), (300, 6_000_000, f64::NAN), (1900, 1_000_000, 0.0)] {
        assert!(stands(n, step_ns, speed_mps).iter().all(|f| *f == Finding::Plausible), "{n} {step_ns}");
    }
    // One other place, and the table is of a fast unit.
    let at = |k: i64| Report { time: GpsTime::from_nanoseconds(k * 1_000_000), ..track(&[if k < 1000 { 0.0 } else { 5.0 }], f64::NAN)[0] };
    assert!(findings(&(0..1900).map(at).collect::<Vec<_>>()).iter().all(|f| *f == Finding::Plausible));
}
