//! The RNP monitor as a state machine: tables of what it must do, and properties for any sequence.
#![allow(clippy::unwrap_used, reason = "a helper of tests may stop at the first surprise, too")]

use navbound_core::bound::{AlertBound, Alerting};
use navbound_core::monitor::rnp::{Acceptance, Alert, Chain, Event, Kind, Monitor, Observation, Settings, Step};
use navbound_core::quantity::{GpsTime, Metres};
use proptest::prelude::*;

const RNP_M: f64 = 500.0;
const INSIDE: f64 = 400.0;
/// Between 0.95 and 1 of the limit: within, but not yet calm.
const NEAR: f64 = 490.0;
const OUTSIDE: f64 = 600.0;

fn settings() -> Settings {
    Settings {
        chain: Chain {
            sample_period_s: 1.0,
            sensor_latency_s: 0.0,
            filter_s: 0.0,
            computing_s: 0.0,
            display_s: 0.0,
            time_to_alert_s: 10.0,
        },
        raise_delay_s: 3.0,
        clear_delay_s: 10.0,
        clear_ratio: 0.95,
        stale_after_s: 2.0,
    }
}

fn exact(bound_m: f64) -> AlertBound {
    Alerting::of("tse-exact").unwrap().claim_evaluated(Metres::new(bound_m))
}

fn at(second: i64, accuracy_m: f64, integrity_m: f64) -> Observation {
    Observation {
        time: GpsTime::from_nanoseconds(second * 1_000_000_000),
        accuracy: exact(accuracy_m),
        integrity: exact(integrity_m),
        rnp: Metres::new(RNP_M),
        usable: true,
    }
}

/// Alerts of a sequence of accuracy bounds, one a second, the integrity bound well inside.
fn alerts(bounds: &[f64]) -> Vec<Alert> {
    let mut monitor = Monitor::new(settings()).unwrap();
    (0..).zip(bounds).map(|(second, b)| monitor.step(&at(second, *b, 0.0)).alert).collect()
}

/// Time that is left until the caution, by hand: three seconds outside are needed, of which the first epoch outside is the begin.
#[test]
fn the_time_that_is_left_falls_by_the_time_outside_and_is_none_inside_or_after_the_alert() {
    let mut monitor = Monitor::new(settings()).unwrap();
    let bounds = [INSIDE, OUTSIDE, OUTSIDE, OUTSIDE, OUTSIDE, OUTSIDE];
    let left = (0..).zip(bounds).map(|(second, b)| {
        monitor.step(&at(second, b, 0.0));
        monitor.caution_in_s()
    });
    assert_eq!(left.collect::<Vec<_>>(), [None, Some(3.0), Some(2.0), Some(1.0), None, None]);
}

fn seconds(time: GpsTime) -> i64 {
    time.nanoseconds() / 1_000_000_000
}

fn ended(step: &Step) -> Vec<Event> {
    step.ended.iter().flatten().copied().collect()
}

fn began(step: &Step) -> Vec<Kind> {
    step.began.iter().flatten().map(|event| event.kind).collect()
}

#[test]
fn a_caution_waits_three_seconds_and_a_shorter_exceedance_is_withdrawn() {
    use Alert::{Caution, Normal};
    let mut outside = [OUTSIDE; 6];
    outside[0] = INSIDE;
    assert_eq!(alerts(&outside), [Normal, Normal, Normal, Normal, Caution, Caution]);
    let mut monitor = Monitor::new(settings()).unwrap();
    // Outside from second 1 to 3 fills 3 s less what is seen at 3; ten seconds inside empty it.
    for second in 0..14 {
        let bound = if (1..3).contains(&second) { OUTSIDE } else { INSIDE };
        assert_eq!(monitor.step(&at(second, bound, 0.0)).alert, Normal, "second {second}");
    }
    assert_eq!(monitor.counters().n_withdrawn, 1);
    assert_eq!(monitor.open_events().count(), 0);
}

#[test]
fn monitoring_begins_unavailable_and_with_the_alert_that_the_first_epoch_deserves() {
    let mut monitor = Monitor::new(settings()).unwrap();
    assert_eq!(monitor.alert(), Alert::Unavailable);
    assert_eq!(monitor.tick(GpsTime::from_nanoseconds(0)).alert, Alert::Unavailable);
    let step = monitor.step(&at(0, OUTSIDE, 0.0));
    assert_eq!((step.alert, began(&step)), (Alert::Caution, vec![Kind::Caution]));
    assert_eq!(monitor.counters().n_unavailable, 0, "nothing was lost");
}

/// The times of docs/methods/rnp-monitor.md, worked out there by hand from the two lines of the wait.
#[test]
fn an_exceedance_that_comes_and_goes_alerts_by_its_share() {
    let first_caution = |outside: usize, of: usize| {
        let bounds: Vec<f64> = (0..600).map(|k| if k > 0 && (k - 1) % of < outside { OUTSIDE } else { INSIDE }).collect();
        alerts(&bounds).iter().position(|a| *a == Alert::Caution).map(|k| k - 1)
    };
    assert_eq!(first_caution(4, 4), Some(3));
    assert_eq!(first_caution(3, 4), Some(4));
    assert_eq!(first_caution(2, 3), Some(6));
    assert_eq!(first_caution(1, 2), Some(8));
    assert_eq!(first_caution(1, 3), Some(18));
    assert_eq!(first_caution(1, 4), Some(84));
    assert_eq!(first_caution(1, 5), None, "a fifth is below 3 / 13");
}

#[test]
fn a_caution_that_comes_and_goes_begins_at_its_first_epoch_outside() {
    let mut monitor = Monitor::new(settings()).unwrap();
    for (second, bound) in (0..).zip([INSIDE, OUTSIDE, OUTSIDE, OUTSIDE, INSIDE]) {
        assert_eq!(monitor.step(&at(second, bound, 0.0)).alert, Alert::Normal);
    }
    let step = monitor.step(&at(5, 700.0, 0.0));
    let event = step.began[0].unwrap();
    assert_eq!((seconds(event.onset), seconds(event.annunciation), event.peak.m()), (1, 5, 700.0));
    assert_eq!(monitor.counters().n_withdrawn, 0, "it was raised, not withdrawn");
}

#[test]
fn loss_of_monitoring_ends_in_normal_only_inside() {
    for (bound, deserved) in [(INSIDE, Alert::Normal), (NEAR, Alert::Normal), (OUTSIDE, Alert::Caution), (f64::NAN, Alert::Caution)] {
        for unusable in [1, 10] {
            let mut monitor = Monitor::new(settings()).unwrap();
            monitor.step(&at(0, INSIDE, 0.0));
            for second in 1..=unusable {
                monitor.step(&Observation { usable: false, ..at(second, f64::NAN, f64::NAN) });
            }
            let step = monitor.step(&at(unusable + 1, bound, 0.0));
            assert_eq!(step.alert, deserved, "{bound} after {unusable}");
            let onset = step.began[0].map(|event| seconds(event.onset));
            assert_eq!(onset, (deserved == Alert::Caution).then_some(1), "nothing was known to be inside since");
        }
    }
    let mut monitor = Monitor::new(settings()).unwrap();
    monitor.step(&at(0, INSIDE, 0.0));
    let step = monitor.step(&at(60, OUTSIDE, 0.0));
    assert_eq!((step.alert, began(&step)), (Alert::Caution, vec![Kind::Caution, Kind::Unavailable]), "after a silence, too");
}

#[test]
fn a_warning_ends_in_caution_while_the_accuracy_bound_is_outside() {
    let mut monitor = Monitor::new(settings()).unwrap();
    monitor.step(&at(0, INSIDE, 0.0));
    monitor.step(&at(1, INSIDE, 1300.0));
    let states: Vec<_> = (2..14).map(|second| monitor.step(&at(second, if second < 12 { INSIDE } else { OUTSIDE }, 900.0)).alert).collect();
    assert!(states[..10].iter().all(|a| *a == Alert::Warning) && states[10..].iter().all(|a| *a == Alert::Caution), "{states:?}");
}

#[test]
fn what_is_no_limit_never_gives_normal() {
    for rnp in [f64::INFINITY, 0.0, -500.0, f64::NAN, f64::MAX] {
        for bound in [0.0, INSIDE, f64::INFINITY] {
            let mut monitor = Monitor::new(settings()).unwrap();
            monitor.step(&at(0, INSIDE, INSIDE));
            let step = monitor.step(&Observation { rnp: Metres::new(rnp), ..at(1, bound, bound) });
            assert_eq!(step.alert, Alert::Warning, "RNP {rnp}, bound {bound}");
        }
    }
}

#[test]
fn a_bound_equal_to_its_limit_is_no_alert_and_the_next_number_is() {
    let mut monitor = Monitor::new(settings()).unwrap();
    assert_eq!(monitor.step(&at(0, RNP_M, 2.0 * RNP_M)).alert, Alert::Normal);
    assert_eq!(monitor.step(&at(1, RNP_M, (2.0 * RNP_M).next_up())).alert, Alert::Warning);
}

#[test]
fn a_warning_is_raised_at_once_and_ends_after_ten_calm_seconds() {
    let mut monitor = Monitor::new(settings()).unwrap();
    let mut outcome = Vec::new();
    let mut events = Vec::new();
    for second in 0..14 {
        let integrity = if second == 0 { 1300.0 } else { 900.0 };
        let step = monitor.step(&at(second, INSIDE, integrity));
        outcome.push(step.alert);
        events.extend(ended(&step));
    }
    assert!(outcome[..11].iter().all(|a| *a == Alert::Warning) && outcome[11..].iter().all(|a| *a == Alert::Normal), "{outcome:?}");
    assert_eq!(events.len(), 1);
    let event = events[0];
    assert_eq!((seconds(event.onset), seconds(event.annunciation), event.clear.map(seconds)), (0, 0, Some(11)));
    assert_eq!((event.kind, event.peak.m(), event.limit.m(), event.min_margin.m()), (Kind::Warning, 1300.0, 1000.0, -300.0));
}

#[test]
fn within_the_limit_but_not_calm_restarts_the_wait() {
    // A caution at once: nothing was inside before.
    let mut bounds = vec![OUTSIDE; 4];
    bounds.extend([INSIDE; 9]);
    bounds.push(NEAR);
    bounds.extend([INSIDE; 10]);
    let raised = alerts(&bounds);
    // Calm again from second 14; ten seconds of it end at 24, beyond the sequence.
    assert!(raised.iter().all(|a| *a == Alert::Caution), "{raised:?}");
    bounds.push(INSIDE);
    assert_eq!(alerts(&bounds)[24], Alert::Normal);
}

#[test]
fn what_is_no_length_within_the_limit_alerts_wherever_it_stands() {
    let nan = f64::NAN;
    let mut monitor = Monitor::new(settings()).unwrap();
    assert_eq!(monitor.step(&at(0, INSIDE, nan)).alert, Alert::Warning);
    let mut monitor = Monitor::new(settings()).unwrap();
    assert_eq!(monitor.step(&Observation { rnp: Metres::new(nan), ..at(0, INSIDE, INSIDE) }).alert, Alert::Warning);
    assert_eq!(monitor.counters().n_nan, 1);
    for bound in [nan, -1.0, f64::INFINITY] {
        assert_eq!(alerts(&[bound; 4])[3], Alert::Caution, "{bound}");
    }
}

#[test]
fn an_event_keeps_its_peak_beside_a_nan_and_stays_open_until_it_ends() {
    let mut monitor = Monitor::new(settings()).unwrap();
    for (second, integrity) in (0..).zip([1200.0, f64::NAN, 1500.0, 1100.0]) {
        assert!(ended(&monitor.step(&at(second, 0.0, integrity))).is_empty());
    }
    let open: Vec<_> = monitor.open_events().collect();
    assert_eq!(open.len(), 1);
    assert_eq!((open[0].peak.m(), open[0].min_margin.m(), open[0].clear), (1500.0, -500.0, None));
}

#[test]
fn a_smaller_rnp_judges_the_same_bound_anew() {
    let mut monitor = Monitor::new(settings()).unwrap();
    assert_eq!(monitor.step(&at(0, INSIDE, 900.0)).alert, Alert::Normal);
    let step = monitor.step(&Observation { rnp: Metres::new(300.0), ..at(1, INSIDE, 900.0) });
    assert_eq!(step.alert, Alert::Warning);
    let event = *monitor.open_events().next().unwrap();
    assert_eq!((event.limit.m(), event.min_margin.m()), (600.0, -300.0));
}

#[test]
fn unusable_epochs_and_silence_lose_monitoring_until_the_next_usable_epoch() {
    let mut monitor = Monitor::new(settings()).unwrap();
    monitor.step(&at(0, INSIDE, INSIDE));
    let lost = Observation { usable: false, ..at(1, f64::NAN, f64::NAN) };
    assert_eq!(monitor.step(&lost).alert, Alert::Unavailable);
    assert_eq!(monitor.counters().n_nan, 0, "an unusable epoch has no bound to be NaN");
    let step = monitor.step(&at(2, INSIDE, INSIDE));
    assert_eq!((step.alert, ended(&step)[0].kind), (Alert::Normal, Kind::Unavailable));

    assert_eq!(monitor.tick(GpsTime::from_nanoseconds(4_000_000_000)).alert, Alert::Normal, "two seconds are allowed");
    let tick = monitor.tick(GpsTime::from_nanoseconds(4_000_000_001));
    assert_eq!((tick.alert, tick.began.map(|event| event.kind)), (Alert::Unavailable, Some(Kind::Unavailable)));
    let event = ended(&monitor.step(&at(9, INSIDE, INSIDE)))[0];
    assert_eq!((seconds(event.onset), seconds(event.annunciation), event.clear.map(seconds)), (2, 4, Some(9)));
    assert_eq!((monitor.counters().n_gaps, monitor.counters().n_unavailable), (1, 2));
    assert_eq!(monitor.counters().watched_s, 2.0, "the gap is not under watch");
}

#[test]
fn an_alert_does_not_end_before_it_was_raised() {
    let mut monitor = Monitor::new(settings()).unwrap();
    monitor.step(&at(0, INSIDE, INSIDE));
    assert_eq!(monitor.tick(GpsTime::from_nanoseconds(3_000_000_000)).alert, Alert::Unavailable);
    // The epoch of second 1 arrives after the silence was noticed, in second 2.
    let event = ended(&monitor.step(&at(1, INSIDE, INSIDE)))[0];
    assert_eq!((seconds(event.onset), seconds(event.annunciation), event.clear.map(seconds)), (0, 2, Some(2)));
}

#[test]
fn a_gap_never_helps_an_alert_to_end_and_never_delays_one() {
    let mut monitor = Monitor::new(settings()).unwrap();
    monitor.step(&at(0, INSIDE, 1300.0));
    monitor.step(&at(1, INSIDE, 900.0));
    for second in 60..70 {
        assert_eq!(monitor.step(&at(second, INSIDE, 900.0)).alert, Alert::Warning, "second {second}");
    }
    assert_eq!(monitor.step(&at(70, INSIDE, 900.0)).alert, Alert::Normal);

    let mut monitor = Monitor::new(settings()).unwrap();
    monitor.step(&at(0, OUTSIDE, 0.0));
    assert_eq!(monitor.step(&at(60, OUTSIDE, 0.0)).alert, Alert::Caution);
}

#[test]
fn duplicate_and_late_epochs_are_dropped_and_counted() {
    let mut monitor = Monitor::new(settings()).unwrap();
    monitor.step(&at(10, INSIDE, INSIDE));
    let step = monitor.step(&at(10, INSIDE, INSIDE));
    assert_eq!((step.acceptance, step.alert), (Acceptance::Duplicate, Alert::Normal));
    let step = monitor.step(&at(9, INSIDE, INSIDE));
    assert_eq!((step.acceptance, step.alert), (Acceptance::Late, Alert::Normal));
    let counters = monitor.counters();
    assert_eq!((counters.n_accepted, counters.n_duplicate, counters.n_late), (1, 1, 1));
}

/// Stale after 2 s: one nanosecond and two seconds late contradict, a nanosecond more is history.
#[test]
fn a_late_epoch_outside_contradicts_the_last_one() {
    for (late_ns, alert) in [(1, Alert::Warning), (2_000_000_000, Alert::Warning), (2_000_000_001, Alert::Normal)] {
        let mut monitor = Monitor::new(settings()).unwrap();
        monitor.step(&at(10, INSIDE, INSIDE));
        let seen = Observation { time: GpsTime::from_nanoseconds(10_000_000_000 - late_ns), ..at(10, INSIDE, 9000.0) };
        let step = monitor.step(&seen);
        assert_eq!((step.acceptance, step.alert), (Acceptance::Late, alert), "{late_ns} ns late");
        let onsets: Vec<_> = monitor.open_events().map(|e| seconds(e.onset)).collect();
        assert_eq!(onsets, if alert == Alert::Warning { vec![10] } else { vec![] }, "{late_ns} ns late");
    }
}

#[test]
fn a_repeat_outside_contradicts_and_one_inside_takes_nothing_back() {
    let mut monitor = Monitor::new(settings()).unwrap();
    monitor.step(&at(10, INSIDE, INSIDE));
    let step = monitor.step(&at(10, INSIDE, 5000.0));
    assert_eq!((step.acceptance, step.alert, began(&step)), (Acceptance::Duplicate, Alert::Warning, vec![Kind::Warning]));
    assert_eq!(monitor.step(&at(10, INSIDE, INSIDE)).alert, Alert::Warning);

    // Every second inside and, at the same time, outside: the caution comes after the three seconds of an exceedance in one piece.
    let mut monitor = Monitor::new(settings()).unwrap();
    let pairs: Vec<Alert> = (0..5).map(|s| [monitor.step(&at(s, INSIDE, 0.0)), monitor.step(&at(s, 900.0, 0.0))][1].alert).collect();
    assert_eq!(pairs, [Alert::Normal, Alert::Normal, Alert::Normal, Alert::Caution, Alert::Caution]);
}

#[test]
fn a_repeat_that_is_not_usable_loses_monitoring_at_its_time_and_a_late_one_does_not() {
    let unusable = |second| Observation { usable: false, ..at(second, INSIDE, INSIDE) };
    let mut monitor = Monitor::new(settings()).unwrap();
    monitor.step(&at(10, INSIDE, INSIDE));
    assert_eq!(monitor.step(&unusable(9)).alert, Alert::Normal);
    let step = monitor.step(&unusable(10));
    assert_eq!((step.acceptance, step.alert, began(&step)), (Acceptance::Duplicate, Alert::Unavailable, vec![Kind::Unavailable]));
    assert_eq!(monitor.step(&at(10, INSIDE, INSIDE)).alert, Alert::Unavailable);
    assert_eq!(monitor.step(&at(11, INSIDE, INSIDE)).alert, Alert::Normal);
}

#[test]
fn an_exceedance_alerts_within_its_delay_of_records_however_slowly_the_stamps_advance() {
    for step_ns in [1, 1_000_000, 499_999_999] {
        let mut monitor = Monitor::new(settings()).unwrap();
        let alerts: Vec<Alert> = (0..6)
            .map(|k: i64| {
                let bound_m = if k == 0 { INSIDE } else { 900.0 };
                let seen = Observation { time: GpsTime::from_nanoseconds(k * step_ns), ..at(0, bound_m, 0.0) };
                monitor.step(&seen).alert
            })
            .collect();
        // Outside from the second record on; three periods of a second later the wait is over.
        let normal = Alert::Normal;
        assert_eq!(alerts, [normal, normal, normal, normal, Alert::Caution, Alert::Caution], "{step_ns} ns");
    }
}

#[test]
fn stamps_that_crawl_never_bring_the_end_of_an_alert_nearer() {
    let mut monitor = Monitor::new(settings()).unwrap();
    monitor.step(&at(0, INSIDE, 5000.0));
    let calm = |k: i64| Observation { time: GpsTime::from_nanoseconds(k * 1_000_000), ..at(0, INSIDE, INSIDE) };
    assert!((1..1000).all(|k| monitor.step(&calm(k)).alert == Alert::Warning));
}

/// One wild time stamp far ahead would otherwise make every later epoch late, and the monitor silent for ever.
#[test]
fn late_epochs_longer_than_the_permitted_silence_are_a_clock_set_back() {
    let mut monitor = Monitor::new(settings()).unwrap();
    monitor.step(&at(1_000_000, INSIDE, INSIDE));
    let steps: Vec<_> = (0..5).map(|second| monitor.step(&at(second, INSIDE, INSIDE))).collect();
    use Acceptance::{Accepted, ClockSetBack, Late};
    use Alert::{Normal, Unavailable};
    let steps_taken: Vec<_> = steps.iter().map(|s| (s.acceptance, s.alert)).collect();
    // The third dropped epoch is the third second of silence; two are permitted.
    assert_eq!(steps_taken, [(Late, Normal), (Late, Normal), (Late, Unavailable), (ClockSetBack, Unavailable), (Accepted, Normal)]);
    assert_eq!(monitor.counters().n_clock_set_back, 1);
    assert_eq!(began(&steps[2]), [Kind::Unavailable]);
    let event = ended(&steps[4])[0];
    assert_eq!((seconds(event.onset), event.clear.map(seconds)), (0, Some(4)), "in the time of the clock that counts");
}

/// Alerts of epochs far outside at these times, after an epoch inside at `first`.
fn outside_at(first: i64, times: impl Iterator<Item = i64>) -> (Vec<Alert>, Monitor) {
    let mut monitor = Monitor::new(settings()).unwrap();
    monitor.step(&at(first, INSIDE, INSIDE));
    (times.map(|second| monitor.step(&at(second, 5000.0, 5000.0)).alert).collect(), monitor)
}

#[test]
fn time_that_stands_or_runs_backwards_is_silence() {
    let cases: [(&str, Vec<i64>); 4] = [
        ("stuck", vec![5000; 3600]),
        ("backwards", (0..1000).map(|k| 4999 - k).collect()),
        ("set back and stuck", vec![10; 1000]),
        ("to and fro", (0..1000).map(|k| 10 + k % 2).collect()),
    ];
    for (what, times) in cases {
        let (raised, monitor) = outside_at(5000, times.into_iter());
        // Two dropped epochs are the permitted two seconds.
        assert!(raised[2..].iter().all(|a| *a == Alert::Unavailable), "{what}: {:?}", &raised[..8]);
        let open: Vec<_> = monitor.open_events().map(|e| (e.kind, seconds(e.onset), seconds(e.annunciation))).collect();
        // Repeats of the first time, and those shortly before it, are outside and contradict it.
        let contradicted = ["stuck", "backwards"].contains(&what).then_some((Kind::Warning, 5000, 5000));
        assert_eq!(open, contradicted.into_iter().chain([(Kind::Unavailable, 5000, 5000)]).collect::<Vec<_>>(), "{what}");
    }
}

#[test]
fn a_stamp_far_ahead_does_not_hide_a_silence_from_the_arrival_clock() {
    let tick = |monitor: &mut Monitor, second: i64| monitor.tick(GpsTime::from_nanoseconds(second * 1_000_000_000)).alert;
    let mut monitor = Monitor::new(settings()).unwrap();
    monitor.step(&at(1000, INSIDE, INSIDE));
    let states: Vec<_> = (1..=1100).map(|second| tick(&mut monitor, second)).collect();
    // The first tick may be the moment of arrival; two more seconds are permitted.
    assert!(states[..3].iter().all(|a| *a == Alert::Normal) && states[3..].iter().all(|a| *a == Alert::Unavailable));
    // An arrival clock that is itself set back has not undone the time that passed.
    let mut monitor = Monitor::new(settings()).unwrap();
    monitor.step(&at(1000, INSIDE, INSIDE));
    let states: Vec<_> = [1, 2, 3, 1, 2].map(|second| tick(&mut monitor, second)).into();
    assert_eq!(states[4], Alert::Unavailable);
    // Healthy epochs between ticks are never a silence, however rare the ticks are.
    let mut monitor = Monitor::new(settings()).unwrap();
    for second in 0..100 {
        monitor.step(&at(second, INSIDE, INSIDE));
        assert!(second % 30 > 0 || tick(&mut monitor, second) == Alert::Normal);
    }
}

#[test]
fn a_chain_slower_than_the_time_to_alert_is_refused() {
    let outcome = |change: fn(&mut Settings)| {
        let mut s = settings();
        change(&mut s);
        s.checked().map_or_else(|e| e.argument, |_| "accepted")
    };
    assert_eq!(outcome(|s| s.chain.sensor_latency_s = 6.0), "accepted");
    assert_eq!(outcome(|s| s.chain.sensor_latency_s = 6.1), "time to the crew of an exceedance");
    assert_eq!(outcome(|s| s.stale_after_s = 11.0), "time to the crew of a silence");
    assert_eq!(outcome(|s| s.chain.display_s = f64::NAN), "display_s");
    assert_eq!(outcome(|s| s.chain.time_to_alert_s = f64::NAN), "time_to_alert_s");
    assert_eq!(outcome(|s| s.clear_ratio = 1.1), "clear_ratio");
    assert_eq!(outcome(|s| s.raise_delay_s = -1.0), "raise_delay_s");
    assert_eq!(outcome(|s| s.stale_after_s = 0.5), "stale_after_s");
    let unhurried = |s: &mut Settings| {
        s.chain.sample_period_s = 60.0;
        s.stale_after_s = 120.0;
        s.chain.time_to_alert_s = f64::INFINITY;
    };
    assert_eq!(outcome(unhurried), "accepted", "nobody is to be alerted");
}

fn sequences() -> impl Strategy<Value = Vec<(f64, f64, bool)>> {
    let level = prop_oneof![3 => 0.0..475.0_f64, 1 => 475.0..500.0_f64, 2 => 500.1..900.0_f64, 1 => Just(f64::NAN)];
    prop::collection::vec((level.clone(), level.prop_map(|b| 2.0 * b), prop::bool::weighted(0.95)), 1..200)
}

proptest! {
    /// Whatever came before: an integrity bound outside is a warning in the same epoch, an accuracy bound outside for four epochs is a
    /// caution or worse, and an unusable epoch is never silent.
    #[test]
    fn raising_is_never_later_than_the_delay(sequence in sequences()) {
        let mut monitor = Monitor::new(settings()).unwrap();
        let mut outside_for = 0;
        for (second, (accuracy, integrity, usable)) in (0..).zip(sequence) {
            let step = monitor.step(&Observation { usable, ..at(second, accuracy, integrity) });
            let alert = step.alert;
            prop_assert!(usable || alert == Alert::Unavailable);
            if !usable {
                outside_for = 0;
                continue;
            }
            outside_for = if accuracy <= RNP_M { 0 } else { outside_for + 1 };
            prop_assert!(integrity <= 2.0 * RNP_M || alert >= Alert::Warning);
            prop_assert!(outside_for < 4 || alert >= Alert::Caution);
            for event in ended(&step) {
                let clear = event.clear.unwrap();
                prop_assert!(event.onset <= event.annunciation && event.annunciation <= clear && clear <= at(second, 0.0, 0.0).time);
            }
        }
    }

    /// An alert ends only after eleven calm usable epochs (ten seconds) in a row.
    #[test]
    fn clearing_is_never_sooner_than_the_delay(calm in prop::collection::vec(prop::bool::weighted(0.93), 50..300)) {
        let mut monitor = Monitor::new(settings()).unwrap();
        let mut calm_for = 0;
        for (second, calm) in (0..).zip(calm) {
            let step = monitor.step(&at(second, if calm { INSIDE } else { OUTSIDE }, if calm { 2.0 * INSIDE } else { f64::NAN }));
            calm_for = if calm { calm_for + 1 } else { 0 };
            for event in ended(&step) {
                prop_assert!(calm_for >= 11);
                prop_assert!(event.onset <= event.annunciation && event.clear.is_some_and(|c| c > event.annunciation));
            }
        }
    }
}
