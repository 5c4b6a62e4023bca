use super::*;

/// As tables and live have them.
pub(in crate::monitor) const LIMITS: Limits = Limits {
    max_speed_mps: 400.0,
    speed_factor: 1.25,
    speed_margin_mps: 25.0,
    latency_s: 10.0,
    fix_latency_s: 1.0,
    noise_m: 100.0,
    moving_mps: 15.0,
    stale_after_s: 2.0,
    settle_s: 30.0,
    period_s: 0.0,
};

fn report(seconds: i64, north_m: f64, speed_mps: f64) -> Report {
    let time = GpsTime::from_nanoseconds(seconds * 1_000_000_000);
    Report { time, fixed: None, lat_rad: 0.8 + north_m / 6.37e6, lon_rad: 0.1, speed_mps, variance_m2: 4.0, height: None }
}

fn findings(reports: &[Report], limits: &Limits) -> Vec<Finding> {
    let mut motion = Motion::default();
    reports.iter().map(|each| motion.see(each, limits).unwrap()).collect()
}

/// A latency of such times of 1 s, stale after 2 s.
#[test]
fn an_old_position_is_as_one_that_repeats_as_long() {
    use Finding::{Late, Plausible, Repeated, Stale, Unsettled};
    let of = |age_s: f64| {
        let plain = report(100, 0.0, 0.0);
        Report { fixed: Some(plain.time.plus_seconds(-age_s)), ..plain }
    };
    let aged = |age_s: f64| of(age_s).with_age(Plausible, &LIMITS);
    assert_eq!([-5.0, 0.0, 1.0, 1.5, 2.0, 2.5].map(aged), [Plausible, Plausible, Plausible, Repeated, Repeated, Stale]);
    for graver in [Stale, Finding::Jump, Unsettled, Late] {
        assert_eq!(of(60.0).with_age(graver, &LIMITS), graver);
    }
    assert_eq!(of(1.5).with_age(Repeated, &LIMITS), Repeated);
    assert_eq!(Report { fixed: None, ..of(60.0) }.with_age(Plausible, &LIMITS), Plausible);
    assert_eq!(Motion::default().see(&of(60.0), &LIMITS), Ok(Stale));
}

#[test]
fn a_position_that_stays_while_the_aircraft_moves_is_repeated_and_then_stale() {
    use Finding::{Plausible, Repeated, Stale};
    let repeats = |speed| findings(&[0, 1, 2, 3, 4].map(|k| report(k, 0.0, speed)), &LIMITS);
    assert_eq!(repeats(100.0), [Plausible, Repeated, Repeated, Stale, Stale]);
    assert_eq!(repeats(0.0), [Plausible; 5]);
    // Nobody vouches that it stands.
    assert_eq!(repeats(f64::NAN), [Plausible, Plausible, Plausible, Stale, Stale]);
    let at_rest = Limits { moving_mps: f64::INFINITY, ..LIMITS };
    assert_eq!(findings(&[0, 1, 2, 3, 4].map(|k| report(k, 0.0, f64::NAN)), &at_rest), [Plausible; 5]);
}

#[test]
fn a_slow_aircraft_s_position_that_stays_is_stale_once_its_speed_led_elsewhere() {
    let begins = |speed: f64, every: i64| {
        let reports: Vec<Report> = (0..600).map(|k| report(every * k, 0.0, speed)).collect();
        findings(&reports, &LIMITS).iter().position(|each| *each == Finding::Stale).map(|k| every * k as i64)
    };
    // 14.9 m/s: further than 100 m and ten seconds of it after 17 s; 3 m/s: 130 m after 44 s.
    assert_eq!([14.9, 3.0, 2.0, 0.0].map(|speed| begins(speed, 1)), [Some(17), Some(44), None, None]);
    assert_eq!(begins(14.9, 10), Some(20));
    // It may have stood during a gap.
    assert_eq!(findings(&[report(0, 0.0, 0.0), report(900, 0.0, 14.0), report(901, 14.0, 14.0)], &LIMITS)[1], Finding::Plausible);
    let at_rest = Limits { moving_mps: f64::INFINITY, ..LIMITS };
    assert_eq!(findings(&(0..100).map(|k| report(k, 0.0, 5.0)).collect::<Vec<_>>(), &at_rest), [Finding::Plausible; 100]);
}

/// 70 m/s north, then the position of second 100 with the speeds that `stated` gives for the seconds after it.
fn stops(stated: impl Fn(i64) -> f64, every: i64) -> Vec<Report> {
    let speed = |k: i64| if k < 100 { 70.0 } else { stated(k - 100) };
    (0..=400).step_by(every as usize).map(|k| report(k, 70.0 * k.min(100) as f64, speed(k))).collect()
}

#[test]
fn a_speed_that_falls_faster_than_an_aircraft_brakes_is_no_evidence_that_it_stands() {
    // The speed is 0 with the last new position, one report later, after three reports without one, and at one report in ten seconds.
    let ends = [(0, 0.0, 1), (1, 70.0, 1), (4, f64::NAN, 1), (10, 70.0, 10)];
    for (at, before_mps, every) in ends {
        let verdicts = findings(&stops(|k| if k < at { before_mps } else { 0.0 }, every), &LIMITS);
        let (flown, repeats) = verdicts.split_at(100 / every as usize + 1);
        assert!(flown.iter().all(|each| *each == Finding::Plausible), "{at} {every}");
        assert!(repeats.iter().skip(2).all(|each| *each == Finding::Stale), "{at} {every}: {repeats:?}");
    }
    let at_rest = Limits { moving_mps: f64::INFINITY, ..LIMITS };
    assert!(findings(&stops(|_| 0.0, 1), &at_rest).iter().all(|each| *each == Finding::Plausible));
}

/// The position of the fall with noise of decimetres, which is no repeat of bits.
#[test]
fn noise_on_a_position_that_stands_is_no_evidence_that_it_stands_either() {
    let noisy = |amplitude_m: f64| {
        let of = |(k, each): (usize, Report)| Report { lat_rad: each.lat_rad + amplitude_m * libm::sin(12.9 * k as f64) / 6.37e6, ..each };
        stops(|_| 0.0, 1).into_iter().enumerate().map(of).collect::<Vec<_>>()
    };
    for amplitude_m in [0.1, 0.5, 2.0] {
        let verdicts = findings(&noisy(amplitude_m), &LIMITS);
        assert!(verdicts[..102].iter().all(|each| *each == Finding::Plausible), "{amplitude_m}");
        assert!(verdicts[103..].iter().all(|each| *each == Finding::Stale), "{amplitude_m}: {verdicts:?}");
    }
    // From a speed at which it need not move, and where it goes on after a way to brake on.
    let slow = |k: i64| report(k, 0.3 * libm::sin(12.9 * k as f64), if k < 10 { 14.9 } else { 0.0 });
    assert!(findings(&(0..60).map(slow).collect::<Vec<_>>(), &LIMITS).iter().all(|each| *each == Finding::Plausible));
    let taxies = |k: i64| report(k, if k < 10 { 70.0 * k as f64 } else { 875.0 + 3.0 * (k - 9) as f64 }, if k < 10 { 70.0 } else { 3.0 });
    let verdicts = findings(&(0..60).map(taxies).collect::<Vec<_>>(), &LIMITS);
    assert!(verdicts.iter().all(|each| *each == Finding::Plausible), "{verdicts:?}");
}

/// The position of second 100 with noise of decimetres, after which the speed falls as an aircraft brakes, rows are lost, or it creeps.
#[test]
fn a_stop_without_the_way_to_brake_on_is_none() {
    let noisy = |k: i64, north_m: f64, speed_mps: f64| report(k, north_m + 0.3 * libm::sin(12.9 * k as f64), speed_mps);
    let flown = |k: i64| noisy(k, 70.0 * k as f64, 70.0);
    let ramp = |mps2: f64| move |k: i64| noisy(k, 7000.0, (70.0 - mps2 * (k - 100) as f64).max(0.0));
    let creeps = |k: i64| noisy(k, 7000.0 + 0.5 * (k - 100) as f64, 0.0);
    let creeps_after = |k: i64| noisy(k, 7000.0 + 0.5 * (k - 100) as f64, (70.0 - 3.5 * (k - 100) as f64).max(0.0));
    // 145 m beyond the noise of 100 m: as soon as the speed that is left needs no more than that, and 2 s.
    let seen_from = |next: &dyn Fn(i64) -> Report, from: i64| {
        let reports: Vec<Report> = (0..=100).map(flown).chain((from..200).map(next)).collect();
        let verdicts = findings(&reports, &LIMITS);
        assert!(verdicts[..=100].iter().all(|each| *each == Finding::Plausible));
        let first = verdicts.iter().position(|each| *each == Finding::Stale).unwrap();
        assert!(verdicts[first..].iter().all(|each| *each == Finding::Stale), "{verdicts:?}");
        reports[first].time.seconds_since(reports[100].time)
    };
    // v^2 / 20 is below 145 m at 53.8 m/s: after 2 s of 9 m/s2 and 5 s of 3.5 m/s2; a creep has gone 2.5 m until then.
    assert_eq!(seen_from(&ramp(9.0), 101), 5.0);
    assert_eq!(seen_from(&ramp(3.5), 101), 8.0);
    assert_eq!(seen_from(&creeps, 101), 4.0);
    assert_eq!(seen_from(&creeps_after, 101), 8.0);
    assert_eq!(seen_from(&|k| noisy(k, 7000.0, 0.0), 113), 16.0);
    assert_eq!(seen_from(&|k| noisy(k, 7000.0, 0.0), 111), 14.0);
}

/// Braking as hard as any does, turning, and a gap in which it may have come back.
#[test]
fn an_aircraft_that_flies_the_way_to_brake_on_owes_nothing() {
    for braking_mps2 in [2.0, 4.0, 8.0] {
        let speed = |k: i64| (70.0 - braking_mps2 * (k - 50).max(0) as f64).max(0.0);
        let north = |k: i64| (0..k).map(|j| 0.5 * (speed(j) + speed(j + 1))).sum::<f64>();
        let verdicts = findings(&(0..300).map(|k| report(k, north(k), speed(k))).collect::<Vec<_>>(), &LIMITS);
        assert!(verdicts.iter().all(|each| *each == Finding::Plausible), "{braking_mps2}");
    }
    // A circle of 50 s at 70 m/s, then a stop with 4 m/s2.
    let speed = |k: i64| if k < 50 { 70.0 } else { (70.0 - 4.0 * (k - 50) as f64).max(0.0) };
    let way = |k: i64| (0..k).map(|j| 0.5 * (speed(j) + speed(j + 1))).sum::<f64>();
    let turn = |k: i64| report(k, 557.0 * libm::sin(way(k) / 557.0), speed(k));
    assert!(findings(&(0..120).map(turn).collect::<Vec<_>>(), &LIMITS).iter().all(|each| *each == Finding::Plausible));
    let back = |k: i64| if k < 100 { report(k, 70.0 * k as f64, 70.0) } else { report(k + 3000, 6930.5, 0.0) };
    assert!(findings(&(0..200).map(back).collect::<Vec<_>>(), &LIMITS).iter().all(|each| *each == Finding::Plausible));
}

/// 70 m/s to nothing in 20 s, 25 m/s in 3 s, and minutes of the same bits.
#[test]
fn an_aircraft_that_braked_may_repeat_its_position() {
    for (from_mps, braking_mps2) in [(70.0, 3.5), (25.0, 9.0)] {
        let (mut north_m, mut speed_mps): (f64, f64) = (0.0, from_mps);
        let reports = (0..300).map(|k| {
            let next_mps = if k < 100 { from_mps } else { (speed_mps - braking_mps2).max(0.0) };
            north_m += 0.5 * (speed_mps + next_mps);
            speed_mps = next_mps;
            report(k, north_m, speed_mps)
        });
        assert!(findings(&reports.collect::<Vec<_>>(), &LIMITS).iter().all(|each| *each == Finding::Plausible), "{from_mps}");
    }
    // One speed that drops out while the position goes on says nothing of a stand later.
    let drop = |k: i64| report(k, 70.0 * k as f64, if k == 50 { 0.0 } else { 70.0 });
    assert!(findings(&(0..100).map(drop).collect::<Vec<_>>(), &LIMITS).iter().all(|each| *each == Finding::Plausible));
}

#[test]
fn the_reach_over_a_hold_counts_no_time_in_which_the_aircraft_stood_by_its_reports() {
    // At 70 m/s again from where the flight is by then: (1.25 x 70 + 25) m/s in 1 + 10 s, and 100 m, are 1337.5 m.
    let back = |hold_s: i64, speed_mps: f64| {
        let repeats = (0..hold_s).map(|k| report(k, 0.0, speed_mps));
        let on = [report(hold_s, 70.0 * hold_s as f64, 70.0)];
        findings(&repeats.chain(on).collect::<Vec<_>>(), &LIMITS).pop().unwrap()
    };
    assert_eq!([19, 20, 200].map(|hold_s| back(hold_s, 0.0)), [Finding::Late, Finding::Jump, Finding::Jump]);
    assert_eq!([19, 20, 200].map(|hold_s| back(hold_s, 70.0)), [Finding::Plausible; 3]);
}

#[test]
fn a_step_beyond_the_reach_is_a_jump_and_nothing_is_believed_until_it_has_settled() {
    use Finding::{Jump, Late, Plausible, Unsettled};
    // (1.25 x 100 + 25) m/s in 1 + 10 s, and 100 m: 1750 m; with 2 s: 550 m.
    let step = |north_m, speed| findings(&[report(0, 0.0, speed), report(1, north_m, speed)], &LIMITS)[1];
    assert_eq!([540.0, 560.0, 1740.0, 1760.0].map(|m| step(m, 100.0)), [Plausible, Late, Late, Jump]);
    // Without a speed 400 m/s in 1 + 2 s, and 100 m.
    assert_eq!([1290.0, 1310.0].map(|m| step(m, f64::NAN)), [Plausible, Jump]);
    let after = |k| if k == 1 { report(k, 9e3, 100.0) } else { report(k, 9e3 + 100.0 * (k - 1) as f64, 100.0) };
    let all = findings(&[report(0, 0.0, 100.0), after(1), after(2), after(31), after(32)], &LIMITS);
    assert_eq!(all, [Plausible, Jump, Unsettled, Unsettled, Plausible]);
}

#[test]
fn two_places_of_one_time_are_a_jump_where_their_covariances_do_not_explain_them() {
    use Finding::{Jump, Plausible, Unsettled};
    // 2 m of rounding, and 6.4379 of the standard deviations of 4 + 4 m2: 20.2 m.
    let again = |north_m| findings(&[report(0, 0.0, 70.0), report(1, 70.0, 70.0), report(1, 70.0 + north_m, 70.0)], &LIMITS)[2];
    assert_eq!([0.0, 20.0, 20.5, 300.0, 5e5].map(again), [Plausible, Plausible, Jump, Jump, Jump]);
    // The next ones are not believed, whichever place they go on from.
    let after = [report(0, 0.0, 70.0), report(0, 300.0, 70.0), report(1, 70.0, 70.0), report(31, 2170.0, 70.0)];
    assert_eq!(findings(&after, &LIMITS), [Plausible, Jump, Unsettled, Plausible]);
}

#[test]
fn two_heights_of_one_time_are_a_jump_where_their_variances_do_not_explain_them() {
    use Finding::{Jump, Plausible};
    let at = |k, h_m, variance_m2| Report { height: Some(Height { h_m, variance_m2 }), ..report(k, 70.0 * k as f64, 70.0) };
    let again = |up_m, variance| findings(&[at(0, 900.0, 4.0), at(1, 1000.0, variance), at(1, 1000.0 + up_m, variance)], &LIMITS)[2];
    // As two places: 20.2 m by 4 + 4 m2, 2 m without any; and what is never a jump where no variance is stated.
    assert_eq!([0.0, 20.0, 20.5, -3e3].map(|up_m| again(up_m, 4.0)), [Plausible, Plausible, Jump, Jump]);
    assert_eq!([2.0, 2.1].map(|up_m| again(up_m, 0.0)), [Plausible, Jump]);
    assert_eq!([100.0, -100.0, 101.0, 4e3].map(|up_m| again(up_m, f64::NAN)), [Plausible, Plausible, Jump, Jump]);
    // Of different times, of a position that stands, and beside no height.
    let stands = |k, h_m| Report { height: Some(Height { h_m, variance_m2: 1.0 }), ..report(k, 0.0, 0.0) };
    assert_eq!(findings(&[stands(0, 0.0), stands(1, 500.0), stands(2, 1000.0), stands(2, 1001.0)], &LIMITS), [Plausible; 4]);
    assert_eq!(findings(&[stands(0, 0.0), stands(1, 500.0), stands(1, 0.0)], &LIMITS)[2], Jump);
    assert_eq!(findings(&[stands(0, 0.0), report(0, 0.0, 0.0), stands(1, 3e3), report(1, 0.0, 0.0)], &LIMITS), [Plausible; 4]);
}

#[test]
fn a_position_that_stands_under_time_stamps_that_crawl_lasts_as_long_as_its_reports() {
    use Finding::{Plausible, Repeated, Stale};
    let crawls = |speed| move |k: i64| Report { time: GpsTime::from_nanoseconds(k * 1_000_000), ..report(0, 0.0, speed) };
    let declared = Limits { period_s: 1.0, ..LIMITS };
    let silent: Vec<Report> = (0..60).map(crawls(f64::NAN)).collect();
    assert_eq!(findings(&silent, &declared)[..4], [Plausible, Plausible, Plausible, Stale]);
    assert!(findings(&silent, &declared)[3..].iter().all(|each| *each == Stale));
    assert_eq!(findings(&(0..5).map(crawls(70.0)).collect::<Vec<_>>(), &declared), [Plausible, Repeated, Repeated, Stale, Stale]);
    assert_eq!(findings(&(0..60).map(crawls(0.0)).collect::<Vec<_>>(), &declared), [Plausible; 60]);
    // The same after a minute of flight: its last position under stamps that go on by a millisecond, and by four.
    let flies = |k: i64| report(k - 60, 70.0 * k as f64, f64::NAN);
    for step_ns in [1_000_000, 4_000_000] {
        let last = |k: i64| Report { time: GpsTime::from_nanoseconds(k * step_ns), ..flies(60) };
        let verdicts = findings(&(0..60).map(flies).chain((0..60).map(last)).collect::<Vec<_>>(), &declared);
        assert!(verdicts[..63].iter().all(|each| *each == Plausible), "{step_ns}");
        assert!(verdicts[63..].iter().all(|each| *each == Stale), "{step_ns}: {:?}", &verdicts[60..]);
    }
    // Where nobody declares how often reports come, a fast table repeats its position.
    assert_eq!(findings(&silent, &LIMITS), [Plausible; 60]);
    // Reports at half the period or more are no crawl; nor is a position that repeats between two others.
    let half = |k: i64| Report { time: GpsTime::from_nanoseconds(k * 500_000_000), ..report(0, 0.0, f64::NAN) };
    assert_eq!(findings(&(0..6).map(half).collect::<Vec<_>>(), &declared), [Plausible, Plausible, Plausible, Plausible, Plausible, Stale]);
    let fast =
        |k: i64| Report { time: GpsTime::from_nanoseconds(k * 100_000_000), ..report(0, 7.0 * (1 + k.max(0) / 10) as f64, f64::NAN) };
    let moves: Vec<Report> = core::iter::once(Report { time: GpsTime::from_nanoseconds(-1_000_000_000), ..report(0, 0.0, f64::NAN) })
        .chain((0..60).map(fast))
        .collect();
    assert_eq!(findings(&moves, &declared), [Plausible; 61]);
}

#[test]
fn a_flight_by_time_stamps_that_crawl_is_a_jump_and_one_with_late_positions_is_none() {
    // 70 m/s whose stamps go on by a millisecond: (1.25 x 70 + 25) m/s x 10 s + 100 m are 1225 m, 18 steps.
    let crawls = |k: i64, speed| Report { time: GpsTime::from_nanoseconds(k * 1_000_000), ..report(0, 70.0 * k as f64, speed) };
    let first = |verdicts: Vec<Finding>, of| verdicts.iter().position(|each| *each == of);
    let all = findings(&(0..90).map(|k| crawls(k, 70.0)).collect::<Vec<_>>(), &LIMITS);
    assert_eq!((first(all.clone(), Finding::Late), first(all.clone(), Finding::Jump)), (Some(5), Some(18)));
    assert!(all[5..].iter().all(|each| *each != Finding::Plausible), "{all:?}");
    // Without speeds 400 m/s x 2 s + 100 m.
    let silent = findings(&(0..90).map(|k| crawls(k, f64::NAN)).collect::<Vec<_>>(), &LIMITS);
    assert!(first(silent.clone(), Finding::Jump) == Some(13) && silent[13..].iter().all(|each| *each != Finding::Plausible));
    // Positions by turns of now and up to 1.9 s old, of one that brakes at 5 m/s2 as well.
    let late = |k: i64| report(k, 70.0 * (k as f64 - if k % 3 == 1 { 1.9 } else { 0.0 }), 70.0);
    assert!(findings(&(0..90).map(late).collect::<Vec<_>>(), &LIMITS).iter().all(|each| *each == Finding::Plausible));
    let speed = |k: i64| (70.0 - 5.0 * k as f64).max(0.0);
    let brakes = |k: i64| report(k, (0..k).map(|j| 0.5 * (speed(j) + speed(j + 1))).sum(), speed(k));
    assert!(findings(&(0..40).map(brakes).collect::<Vec<_>>(), &LIMITS).iter().all(|each| *each == Finding::Plausible));
}

#[test]
fn a_report_of_the_past_says_nothing_and_a_place_off_the_earth_is_none() {
    let mut motion = Motion::default();
    motion.see(&report(10, 0.0, 100.0), &LIMITS).unwrap();
    assert_eq!(motion.see(&report(5, 9e5, 100.0), &LIMITS), Ok(Finding::Plausible));
    assert!(motion.see(&Report { lat_rad: f64::NAN, ..report(11, 0.0, 100.0) }, &LIMITS).is_err());
}

/// Held for ten seconds at 275 m/s, and then interpolated to where the aircraft is four seconds later.
#[test]
fn positions_that_catch_up_after_a_hold_are_as_late_as_they_are_behind() {
    use Finding::{Late, Plausible, Stale};
    let speed = 275.0;
    let north = |k: i64| match k {
        0..=5 => speed * k as f64,
        6..=14 => speed * 5.0,
        15..=18 => speed * 5.0 + speed * 13.0 / 4.0 * (k - 14) as f64,
        _ => speed * k as f64,
    };
    let caught_up: Vec<Report> = (0..30).map(|k| report(k, north(k), speed)).collect();
    let judged = findings(&caught_up, &LIMITS);
    // The 17th is 2.25 s behind, of which 2 s, the noise and a twentieth of the way are allowed.
    assert_eq!(judged[8..17], [Stale; 9]);
    assert!(judged[17..].iter().all(|each| matches!(each, Plausible | Late)), "{:?}", &judged[17..]);
    // Where the first position after the hold is a new one nothing is late.
    let fresh: Vec<Report> = (0..30).map(|k| report(k, if (6..15).contains(&k) { speed * 5.0 } else { speed * k as f64 }, speed)).collect();
    assert!(findings(&fresh, &LIMITS)[15..].iter().all(|each| matches!(each, Plausible | Late)));
    // Nor where the stamps clump: a position four seconds early stands until its time has come.
    let clumped = |k: i64| if (10..14).contains(&k) { 14 } else { k };
    let early: Vec<Report> = (0..30).map(|k| report(k, 150.0 * clumped(k) as f64, 150.0)).collect();
    assert!(findings(&early, &LIMITS)[15..].iter().all(|each| matches!(each, Plausible | Late)));
    // Nor after a turn of three degrees a second at 100 m/s.
    let turned = |k: i64| {
        let way_rad = 3_f64.to_radians() * (k - 5).max(0) as f64;
        let (radius_m, begun_m) = (100.0 / 3_f64.to_radians(), 500.0);
        let (north_m, east_m) =
            if k <= 5 { (100.0 * k as f64, 0.0) } else { (begun_m + radius_m * way_rad.sin(), radius_m * (1.0 - way_rad.cos())) };
        let at = if (6..25).contains(&k) { (begun_m, 0.0) } else { (north_m, east_m) };
        Report { lon_rad: 0.1 + at.1 / 6.37e6 / 0.8_f64.cos(), ..report(k, at.0, 100.0) }
    };
    let judged = findings(&(0..40).map(turned).collect::<Vec<_>>(), &LIMITS);
    assert!(judged[25..].iter().all(|each| matches!(each, Plausible | Late)), "{:?}", &judged[25..]);
}
