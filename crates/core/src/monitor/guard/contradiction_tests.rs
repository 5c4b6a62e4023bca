//! Contradictions against what is said by all that happened, and each of their times.

use super::*;

fn at(second: f64) -> GpsTime {
    GpsTime::default().plus_seconds(second)
}
fn position(square: f64, velocity: f64) -> Tests {
    Tests { square: [square, velocity, 0.0, 0.0], exceeds: [!(square <= 42.2), !(velocity <= 42.2), false, false] }
}

#[test]
fn after_three_starts_there_is_no_further_one_and_only_the_stations_convict() {
    let mut c = Contradiction::default();
    c.rule_out_the_unit();
    assert!(!c.convicts_the_unit(), "nothing is contradicted");
    for second in 0..4 {
        c.judge(at(f64::from(second)), &position(0.0, 100.0), true, true);
    }
    assert!(c.is_raised() && !c.convicts_the_unit() && !c.start_is_due(at(4.0), 5.0) && c.start_is_due(at(5.0), 5.0));
    for start in [5.0, 20.0, 40.0] {
        assert!(c.start_is_due(at(start), 5.0));
        c.started(at(start));
        assert!(!c.start_is_due(at(start + 8.0), 5.0), "it has not contradicted yet");
        c.judge(at(start + 8.0), &position(0.0, 50.0), true, true);
        assert!(!c.convicts_the_unit());
    }
    c.rule_out_the_unit();
    // Out for the flight, however long it then agrees.
    for second in 50..2000 {
        c.judge(at(f64::from(second)), &position(0.0, 0.0), true, true);
    }
    assert!(c.convicts_the_unit() && !c.start_is_due(at(2000.0), 5.0));
}

#[test]
fn a_contradiction_without_a_cause_stays_open_and_no_later_fault_of_the_unit_explains_it() {
    let mut c = Contradiction::default();
    c.judge(at(0.0), &position(100.0, 100.0), true, true);
    c.started(at(5.0));
    (6..35).for_each(|s| c.judge(at(f64::from(s)), &position(1.0, 1.0), true, true));
    assert!(c.is_raised());
    c.judge(at(35.0), &position(1.0, 1.0), false, true);
    assert!(c.is_raised(), "the attitude is not settled");
    c.judge(at(36.0), &position(1.0, 1.0), true, true);
    assert!(!c.is_raised() && c.is_open() && !c.convicts_the_unit());
    (37..4000).for_each(|s| c.judge(at(f64::from(s)), &position(1.0, 1.0), true, true));
    assert!(c.is_open(), "time explains nothing");
    assert!(!c.was_before_the_unit());
    c.convict(at(4000.0));
    assert!(c.was_before_the_unit() && c.is_open());
    // Raised for ten seconds by the tests alone: a fault of the unit comes too late to be the cause.
    let mut c = Contradiction::default();
    (0..=10).for_each(|s| c.judge(at(f64::from(s)), &position(100.0, 100.0), true, true));
    c.convict(at(10.0));
    assert!(c.was_before_the_unit());
}

/// One position of many is wrong: the filter has not used it, and its unit leads it on to the next ones.
#[test]
fn positions_that_are_wrong_for_a_moment_leave_nothing_open() {
    let (wrong, right) = (position(500.0, 0.0), position(1.0, 1.0));
    let after = |failing: &[i32], until: i32| {
        let mut c = Contradiction::default();
        (0..until).for_each(|s| c.judge(at(f64::from(s)), if failing.contains(&s) { &wrong } else { &right }, true, true));
        c
    };
    assert!(after(&[10], 15).is_raised());
    let c = after(&[10], 16);
    assert!(!c.is_raised() && !c.is_open());
    let c = after(&[10, 11, 13, 14], 20);
    assert!(!c.is_raised() && !c.is_open());
    // The filter agrees because it has become less certain.
    let mut c = after(&[10], 11);
    (11..60).for_each(|s| c.judge(at(f64::from(s)), &right, true, s > 11));
    assert!(!c.is_raised() && c.is_open());
    // Five seconds and more: by then nobody knows.
    let c = after(&[10, 15], 100);
    assert!(!c.is_raised() && c.is_open());
    // Positions that left their own way are part of the riddle while it lasts, and open where nothing contradicts them.
    let mut c = after(&[10], 11);
    c.leave_course();
    (11..16).for_each(|s| c.judge(at(f64::from(s)), &right, true, true));
    assert!(!c.is_raised() && !c.is_open());
    c.leave_course();
    assert!(c.is_open());
    // A unit that fails meanwhile, or a filter that was started anew there, may be the cause.
    let mut c = after(&[10], 11);
    c.leave_course();
    c.convict(at(12.0));
    assert!(c.was_before_the_unit());
    (13..50).for_each(|s| c.judge(at(f64::from(s)), &right, true, true));
    assert!(!c.is_raised() && c.is_open());
    let mut c = after(&[10], 11);
    c.started(at(11.0));
    (12..50).for_each(|s| c.judge(at(f64::from(s)), &right, true, true));
    assert!(!c.is_raised() && c.is_open());
}

#[test]
fn evidence_in_the_unit_convicts_at_once_and_a_position_without_motion_never_does() {
    let mut c = Contradiction::default();
    c.convict(at(0.0));
    assert!(c.convicts_the_unit() && c.implausible_lately(at(1.0)) && !c.start_is_due(at(4.9), 5.0) && c.start_is_due(at(5.0), 5.0));
    let mut c = Contradiction::default();
    (0..60).for_each(|s| c.judge(at(f64::from(s)), &position(100.0, 5.0), true, true));
    assert!(c.is_raised() && !c.convicts_the_unit() && !c.start_is_due(at(60.0), 5.0));
    // A square that is no number is a failure.
    let mut c = Contradiction::default();
    c.judge(at(0.0), &position(f64::NAN, 0.0), true, true);
    assert!(c.is_raised());
}

#[test]
fn motion_is_a_velocity_beyond_its_limit_or_a_square_that_is_large_or_no_number() {
    let tests = |square: [f64; 4], exceeds: [bool; 4]| Tests { square, exceeds };
    let (small, none) = ([0.0; 4], [false; 4]);
    assert!(!tests(small, none).moved());
    // A position alone is no motion; a velocity level or upwards is.
    for (k, moved) in [false, true, false, true].into_iter().enumerate() {
        let exceeds = core::array::from_fn(|j| j == k);
        assert_eq!(tests(small, exceeds).moved(), moved, "{k}");
        for large in [MOVED.0 + 0.1, f64::NAN] {
            assert_eq!(tests(core::array::from_fn(|j| if j == k { large } else { 0.0 }), none).moved(), moved, "{k} {large}");
        }
        assert!(!tests(core::array::from_fn(|j| if j == k { MOVED.0 } else { 0.0 }), none).moved(), "{k}");
    }
}

#[test]
fn a_contradiction_lasts_from_its_begin_or_from_the_last_start_after_which_it_failed_again() {
    let mut c = Contradiction::default();
    assert!(!c.lasts(at(100.0), 5.0), "nothing is contradicted");
    (0..=3).for_each(|s| c.judge(at(f64::from(s)), &position(100.0, 0.0), true, true));
    assert!(!c.lasts(at(4.9), 5.0) && c.lasts(at(5.0), 5.0));
    c.started(at(6.0));
    assert!(!c.lasts(at(20.0), 5.0), "it has not contradicted since the start");
    c.judge(at(8.0), &position(100.0, 0.0), true, true);
    assert!(!c.lasts(at(10.9), 5.0) && c.lasts(at(11.0), 5.0));
}

/// What happened at a second: the tests failed or not, the velocity moved or not, and a filter started anew after it or not.
type Past = [(i32, bool, bool, bool)];

/// Whether it is raised at the end, open, still, and out: said by all that has happened, without a state.
fn by_all_that_happened(past: &Past) -> (Option<(i32, i32)>, bool, bool, bool) {
    let (mut episode, mut open, mut still, mut out): (Option<(i32, i32)>, _, _, _) = (None, false, false, false);
    for (k, &(t, fails, ..)) in past.iter().enumerate() {
        let starts: Vec<i32> = past[..k].iter().filter(|p| p.3).map(|p| p.0).collect();
        if fails {
            let began = episode.map_or(t, |(b, _)| b);
            // At no failure since the begin had a velocity moved within ten seconds.
            let moved_before = |f: i32| past[..=k].iter().any(|p| p.2 && p.0 <= f && f - p.0 <= 10);
            still = past[..=k].iter().filter(|p| p.1 && p.0 >= began).all(|p| !moved_before(p.0));
            out |= starts.len() >= 3 && starts[starts.len() - 3..].iter().all(|s| t - s <= 600);
            episode = Some((began, t));
        } else if let Some((began, failed)) = episode {
            let brief = failed - began < 5 && starts.iter().all(|s| *s < began);
            let since = starts.last().map_or(failed, |s| failed.max(*s));
            if !out && t - since >= if brief { 5 } else { 30 } {
                open |= !brief;
                episode = None;
            }
        }
    }
    (episode, open, still, out)
}

#[test]
fn a_contradiction_is_what_all_that_happened_says() {
    let mut state = 5_u64;
    let mut draw = |most: u64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) % most
    };
    let mut seen = [0; 5];
    for run in 0..400 {
        let (mut c, mut past, mut t) = (Contradiction::default(), Vec::new(), 0);
        let often = [2, 4, 8, 30][run % 4];
        for _ in 0..80 {
            t += [1, 1, 1, 2, 4, 5, 9, 30, 290][draw(if run % 8 < 6 { 7 } else { 9 }) as usize];
            let (fails, moved) = (draw(often) == 0, draw(often) == 0);
            // A velocity that moves is no failure of its own below its limit.
            c.judge(at(f64::from(t)), &position(if fails { 50.0 } else { 1.0 }, if moved { 20.1 } else { 20.0 }), true, true);
            let start = draw(12) == 0;
            past.push((t, fails, moved, false));
            let (episode, open, still, out) = by_all_that_happened(&past);
            let now = f64::from(t);
            assert_eq!((c.is_raised(), c.is_open(), c.out), (episode.is_some(), open, out), "{past:?}");
            assert!(!c.convicts_the_unit() && !c.was_before_the_unit());
            for after_s in [0.0, 5.0, 10.0] {
                let started = past.iter().rev().find(|p| p.3).map(|p| p.0);
                let lasts = episode
                    .is_some_and(|(b, f)| started.is_none_or(|s| f > s) && now - f64::from(started.map_or(b, |s| s.max(b))) >= after_s);
                assert_eq!(c.lasts(at(now), after_s), lasts, "{past:?}");
                assert_eq!(c.start_is_due(at(now), after_s), lasts && !still && !out, "{past:?}");
                seen[0] += usize::from(lasts);
                seen[1] += usize::from(lasts && !still && !out);
            }
            (seen[2], seen[3], seen[4]) = (seen[2] + usize::from(out), seen[3] + usize::from(open), seen[4] + usize::from(still));
            if start {
                c.started(at(now));
                past.last_mut().unwrap().3 = true;
            }
        }
    }
    assert!(seen.iter().all(|n| *n > 300), "{seen:?}");
}

/// Ten seconds of a contradiction make a later fault of the unit no explanation; five seconds without make the unit plausible again.
#[test]
fn a_fault_explains_what_began_less_than_ten_seconds_before_it() {
    for (after, before) in [(9.9, false), (10.0, true)] {
        let mut c = Contradiction::default();
        c.judge(at(0.0), &position(100.0, 100.0), true, true);
        c.convict(at(after));
        assert_eq!((c.was_before_the_unit(), c.convicts_the_unit()), (before, true), "{after}");
        assert!(c.implausible_lately(at(after + 4.9)) && !c.implausible_lately(at(after + 5.0)));
        // A second fault finds the unit to be the cause, and adds nothing.
        c.convict(at(after + 30.0));
        assert_eq!(c.was_before_the_unit(), before);
        // Agreed for thirty seconds: it is open only where the unit was not the cause.
        c.judge(at(after + 59.9), &position(1.0, 1.0), true, true);
        assert!(c.is_raised() && !c.take_cleared());
        c.judge(at(after + 60.0), &position(1.0, 1.0), true, true);
        assert_eq!((c.is_raised(), c.is_open(), c.take_cleared(), c.take_cleared()), (false, before, true, false));
    }
}

/// Where the stations rule out the unit, only one that is in a contradiction with motion is convicted.
#[test]
fn stations_convict_a_unit_in_a_contradiction_that_moved() {
    let after = |velocity: f64| {
        let mut c = Contradiction::default();
        c.judge(at(0.0), &position(100.0, velocity), true, true);
        c.rule_out_the_unit();
        c.convicts_the_unit()
    };
    assert!(after(100.0) && after(21.0) && !after(20.0));
}

/// A unit that fails within ten seconds explains them, and they end with its fault; one that fails later explains nothing.
#[test]
fn biases_stay_until_a_unit_that_failed_with_them_is_right_again() {
    for (failed_s, explained) in [(9.0, true), (10.0, false)] {
        let mut c = Contradiction::default();
        assert!(!c.is_biased());
        c.leave_biases(at(0.0));
        // The time is that of the first.
        c.leave_biases(at(8.0));
        c.convict(at(failed_s));
        assert!(c.is_biased() && c.was_before_the_unit() != explained, "{failed_s}");
        (11..60).for_each(|s| c.judge(at(f64::from(s)), &position(1.0, 1.0), true, true));
        assert!(!c.is_raised());
        assert_eq!((c.is_biased(), c.is_open()), (!explained, !explained), "{failed_s}");
    }
}
