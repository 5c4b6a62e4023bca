//! Every limit of the monitors at exactly its value and beside it, and sums against what they are sums of.
#![allow(clippy::unwrap_used)] // A test may stop at the first surprise, in its helpers too.

use navbound_core::monitor::exposure::HourlyExposure;
use navbound_core::monitor::motion::{Between, Finding, Limits, Motion, Report, repeated, within};
use navbound_core::monitor::neighbours::{Apart, Neighbours, Place, one_place};
use navbound_core::monitor::rnp::{Chain, Counters, Settings};
use navbound_core::monitor::standing::Gone;
use navbound_core::monitor::state::{StateTable, is_ordered, nse_boundary};
use navbound_core::quantity::{GpsTime, Metres, Risk};
use navbound_core::special::tail;

const LIMITS: Limits = Limits {
    max_speed_mps: 400.0,
    speed_factor: 1.25,
    speed_margin_mps: 25.0,
    latency_s: 10.0,
    fix_latency_s: 1.0,
    noise_m: 80.0,
    moving_mps: 15.0,
    stale_after_s: 2.0,
    settle_s: 30.0,
    period_s: 0.0,
};
const EARTH_M: f64 = 6_371_000.0;

fn at(second: f64) -> GpsTime {
    GpsTime::default().plus_seconds(second)
}

fn report(second: f64, speed_mps: f64) -> Report {
    Report { time: at(second), fixed: None, lat_rad: 0.8, lon_rad: 0.1, speed_mps, variance_m2: 4.0, height: None }
}

fn place(second: f64, north_m: f64, variance_m2: f64) -> Place {
    Place { time: at(second), lat_rad: north_m / EARTH_M, lon_rad: 0.0, variance_m2 }
}

#[test]
fn two_metres_a_second_stand_and_more_moves() {
    for (speed_mps, way_m, stood_s) in [(2.0, 0.0, 4.0), (2.5, 10.0, 0.0), (f64::NAN, 0.0, 0.0), (0.0, 0.0, 4.0)] {
        let mut gone = Gone::default();
        gone.step(&report(0.0, speed_mps), false, &LIMITS);
        assert_eq!((gone.way_m, gone.stood_s), (0.0, 0.0), "the first report leads nowhere");
        gone.step(&report(4.0, speed_mps), true, &LIMITS);
        assert_eq!((gone.way_m, gone.stood_s), (way_m, stood_s), "{speed_mps}");
        // Of a gap no more than the latency of ten seconds counts.
        gone.step(&report(104.0, speed_mps), true, &LIMITS);
        assert_eq!((gone.way_m, gone.stood_s), (3.5 * way_m, 3.5 * stood_s), "{speed_mps}");
        // A time that runs backwards adds nothing, a new position begins anew.
        gone.step(&report(50.0, speed_mps), true, &LIMITS);
        assert_eq!((gone.way_m, gone.stood_s), (3.5 * way_m, 3.5 * stood_s), "{speed_mps}");
        gone.step(&report(60.0, speed_mps), false, &LIMITS);
        assert_eq!((gone.way_m, gone.stood_s, gone.seen), (0.0, 0.0, Some(at(60.0))), "{speed_mps}");
    }
}

/// Braking takes 10 m/s of a second; from 50 m/s to 30 m/s it takes (50^2 - 30^2) / 20 = 80 m.
#[test]
fn a_speed_that_falls_just_as_fast_as_braking_has_not_fallen() {
    let fell = |from_mps: f64, to_mps: f64, after_s: f64, unchanged: bool| {
        let mut gone = Gone::default();
        gone.step(&report(0.0, from_mps), false, &LIMITS);
        gone.step(&report(after_s, to_mps), unchanged, &LIMITS);
        // What braking leaves is what the next report is compared with, where the speed is below it.
        assert_eq!(gone.braked_mps, to_mps.max(from_mps - 10.0 * after_s));
        gone.fell.is_some()
    };
    // 70 m/s less ten and the two of the noise.
    assert!(!fell(70.0, 58.0, 1.0, false) && fell(70.0, 57.75, 1.0, false) && !fell(70.0, 48.0, 2.0, false));
    // Ten seconds later the speed may be any, but the position that stays leaves 80 m to brake on.
    assert!(!fell(50.0, 30.0, 10.0, true) && fell(50.0, 29.75, 10.0, true) && !fell(50.0, 29.75, 10.0, false));
    // What has fallen stays so until the position has left by five metres; of a vehicle that need not have moved, until it changes.
    let after = |from_mps: f64, north_m: f64| {
        let mut gone = Gone::default();
        gone.step(&report(0.0, from_mps), false, &LIMITS);
        for (second, north_m, unchanged) in [(1.0, 0.0, true), (50.0, 0.0, true), (51.0, north_m, false), (52.0, north_m, true)] {
            let lat_rad = 0.8 + north_m / EARTH_M;
            gone.step(&Report { lat_rad, ..report(second, 0.0) }, unchanged, &LIMITS);
            assert!(second > 50.0 || gone.fell.is_some(), "{second}");
        }
        gone.fell.is_some()
    };
    // The radius of the meridian there is within one per cent of the sphere's.
    assert!(after(70.0, 4.9) && !after(70.0, 5.1) && after(15.5, 4.9));
    assert!(!after(15.0, 0.1));
}

#[test]
fn a_repeat_is_reported_at_each_of_its_limits() {
    use Finding::{Plausible, Repeated, Stale};
    let find = |speed_mps: f64, age_s: f64, gone: Gone| repeated(&report(age_s, speed_mps), at(0.0), &gone, &LIMITS);
    let none = Gone::default();
    // 15 m/s is the least that counts as moving, and two seconds the longest that is not stale.
    assert_eq!([find(15.0, 1.0, none), find(15.5, 1.0, none)], [Plausible, Repeated]);
    assert_eq!([find(15.0, 9.0, none), find(15.5, 2.0, none), find(15.5, 2.0 + 1e-9, none)], [Plausible, Repeated, Stale]);
    // Silent ones are doubted once they last.
    let mut fell = none;
    fell.step(&report(-1.0, 70.0), false, &LIMITS);
    fell.step(&report(0.0, 0.0), true, &LIMITS);
    fell = Gone { fell: fell.fell, ..none };
    assert!(fell.fell.is_some());
    assert_eq!([find(f64::NAN, 2.0, none), find(f64::NAN, 2.5, none)], [Plausible, Stale]);
    assert_eq!([find(0.0, 2.0, fell), find(0.0, 2.5, fell), find(0.0, 2.5, none)], [Plausible, Stale, Plausible]);
    // Its own way is further than 80 m and ten seconds of its speed.
    let way = |way_m: f64| Gone { way_m, ..none };
    assert_eq!([find(4.0, 1.0, way(120.0)), find(4.0, 1.0, way(120.5)), find(f64::NAN, 1.0, way(80.5))], [Plausible, Stale, Stale]);
    let at_rest = Limits { moving_mps: f64::INFINITY, ..LIMITS };
    assert_eq!(repeated(&report(9.0, f64::NAN), at(0.0), &Gone { way_m: 1e6, ..fell }, &at_rest), Plausible);
}

#[test]
fn a_time_that_is_just_reached_is_within() {
    let ns = GpsTime::from_nanoseconds;
    assert!(within(ns(30_000_000_000), ns(0), 30.0) && !within(ns(30_000_000_001), ns(0), 30.0));
    assert!(within(ns(0), ns(5), 0.0) && within(ns(i64::MAX), ns(0), f64::INFINITY) && !within(ns(1), ns(0), 0.0));
}

#[test]
fn the_reach_is_the_speed_times_the_time_and_the_noise() {
    let of = |from: Report, to: Report, stood_s: f64| Between::new(&from, &to, stood_s, &LIMITS);
    // 1.25 x 80 + 25 of the faster of both, at most 400.
    let between = of(report(0.0, 40.0), report(8.0, 80.0), 3.0);
    assert_eq!((between.speed_mps, between.elapsed_s, between.stood_s, between.latency_s, between.dated), (125.0, 8.0, 3.0, 10.0, false));
    assert_eq!(between.reach_m(10.0, &LIMITS), 125.0 * 15.0 + 80.0);
    assert_eq!(of(report(0.0, f64::NAN), report(1.0, 80.0), 0.0).speed_mps, 125.0);
    assert_eq!(of(report(0.0, 300.0), report(1.0, 301.0), 0.0).speed_mps, 400.0);
    assert_eq!(of(report(0.0, f64::NAN), report(1.0, f64::NAN), 0.0).speed_mps, 400.0);
    // Positions that are dated are as old as they say, in either order; nothing is taken off for standing.
    let dated = |second: f64, fixed: f64| Report { fixed: Some(at(fixed)), ..report(second, 80.0) };
    for (a, b) in [(1.0, 4.5), (4.5, 1.0)] {
        let between = of(dated(0.0, a), dated(8.0, b), 3.0);
        assert_eq!((between.elapsed_s, between.stood_s, between.latency_s, between.dated), (3.5, 0.0, 1.0, true));
    }
}

#[test]
fn nothing_is_believed_for_thirty_seconds_after_a_dispute() {
    let seen = |second: f64| {
        let mut motion = Motion::default();
        motion.see(&report(0.0, 0.0), &LIMITS).unwrap();
        motion.dispute(at(0.0));
        motion.see(&report(second, 0.0), &LIMITS).unwrap()
    };
    assert_eq!([seen(30.0), seen(30.0 + 1e-9)], [Finding::Unsettled, Finding::Plausible]);
}

/// North at a step of which the middle is late: half of 10 m/s2 and 2 m are free. At half a second a late position may be two seconds late at the
/// mean speed; below, one step at the slower speed.
#[test]
fn half_a_second_is_not_fast() {
    for (step_s, late_m) in [(0.5, 200.0), (0.49, 20.0)] {
        let apart = Apart::of([&place(0.0, 0.0, 1.0), &place(step_s, 20.0, 1.0), &place(2.0 * step_s, 100.0, 1.0)], 2.0).unwrap();
        let expected = f64::max(30.0 - (5.0 * step_s * step_s + 2.0) - late_m, 0.0);
        assert!((apart.away_m - 30.0).abs() < 1e-6 && (apart.unexplained_m - expected).abs() < 1e-6, "{step_s} {apart:?}");
    }
    // Unlike steps: a share of 0.1 of 0.4 s; variances 4, 9 and 16 m2 with their shares.
    let apart = Apart::of([&place(0.0, 0.0, 4.0), &place(0.1, 90.0, 9.0), &place(0.4, 120.0, 16.0)], 2.0).unwrap();
    let variance: f64 = 9.0 + 0.75 * 0.75 * 4.0 + 0.25 * 0.25 * 16.0;
    // 60 m along: free 5 x 0.1 x 0.3 + 2 m, late 0.3 s at the slower 100 m/s.
    assert!((apart.sigma_m - variance.sqrt()).abs() < 1e-9 && (apart.unexplained_m - (60.0 - 2.15 - 30.0)).abs() < 1e-6, "{apart:?}");
    assert_eq!(Apart::of([&place(0.0, 0.0, 1.0), &place(0.0, 9.0, 1.0), &place(1.0, 9.0, 1.0)], 2.0), None);
}

#[test]
fn what_nothing_explains_has_no_chance_and_what_all_explains_has_every() {
    let of = |unexplained_m: f64, sigma_m: f64| Apart { away_m: 9.0, unexplained_m, sigma_m }.risk();
    assert_eq!([of(0.0, 0.0), of(0.0, 1.0), of(1.0, 0.0)], [1.0, 1.0, 0.0]);
    assert!((of(3.0, 1.5) - f64::exp(-2.0)).abs() < 1e-15);
    // Two metres of rounding are one place without any variance; more is not.
    let one = |north_m: f64, variance_m2: f64| one_place(&place(0.0, 0.0, variance_m2), &place(0.0, north_m, 0.0));
    assert!(one(1.999, 0.0) && !one(2.001, 0.0) && one(2.0 + 6.43 * 3.0, 9.0) && !one(2.0 + 6.45 * 3.0, 9.0));
    let mut neighbours = Neighbours::default();
    assert!(!neighbours.contradict(place(0.0, 0.0, 1.0), 2.0) && !neighbours.contradict(place(1.0, 70.0, 1.0), 2.0));
    // A second record of the last time says nothing and changes nothing.
    assert!(!neighbours.contradict(place(1.0, 9e5, 1.0), 2.0) && !neighbours.contradict(place(2.0, 140.0, 1.0), 2.0));
}

/// At twenty samples of a correlation time the shifted crossings count, where they are fewer: 1 - (1 - 2 Q(u)) exp(-3600 rate(u')).
#[test]
fn twenty_samples_are_enough_for_crossings() {
    let u: f64 = 4.0;
    let hourly = |samples: f64| HourlyExposure::new(samples, 1.0).unwrap().per_hour(Risk::new(2.0 * tail(u)).unwrap());
    let crossings = |tau: f64| {
        let shifted = u + 0.582_597_157_939_010_6 * (2.0 / tau).sqrt();
        let rate = 2.0 * shifted * (-0.5 * shifted * shifted).exp() / (2.0 * core::f64::consts::PI).sqrt() / tau;
        1.0 - (1.0 - 2.0 * tail(u)) * (-3600.0 * rate).exp()
    };
    let independent = 1.0 - (1.0 - 2.0 * tail(u)).powi(3600);
    // The level comes back from its own tail to 1e-15, and u^2 of 16 multiplies it; the power of 3600 loses 1e-12.
    assert!((hourly(20.0) / crossings(20.0) - 1.0).abs() < 1e-9 && crossings(20.0) < 0.9 * independent);
    assert!((hourly(19.9) / independent - 1.0).abs() < 1e-9, "{} {independent}", hourly(19.9));
    assert!(
        HourlyExposure::new(1.0, 3600.0).is_ok() && HourlyExposure::new(1.0, 3600.1).is_err() && HourlyExposure::new(0.0, 1.0).is_err()
    );
    // One sigma is the last level: its hour is as likely as it gets.
    let most = HourlyExposure::new(1e6, 0.0).unwrap();
    assert!(most.per_epoch(Risk::new(0.5).unwrap()).is_err());
}

#[test]
fn an_error_at_a_boundary_is_within_it() {
    let m = Metres::new;
    let table = StateTable::new(&[m(100.0), m(300.0), m(900.0)]).unwrap();
    for (nse, class) in [(100.0, 0), (-100.0, 0), (100.1, 1), (300.0, 1), (900.0, 2), (-900.5, 3), (f64::NAN, 3), (0.0, 0)] {
        assert_eq!(table.threshold_class(m(nse)), class, "{nse}");
    }
    assert_eq!(table.n_states(), 4);
    // A quarter is beyond the second level: at a risk of a quarter that level serves, at less the third.
    let mut probability = [0.0; 13];
    probability[..4].copy_from_slice(&[0.5, 0.25, 0.125, 0.125]);
    for (risk, level) in [(0.25, 1), (0.249, 2), (0.125, 2), (0.124, 3), (0.5, 0)] {
        assert_eq!(table.tightest(&probability, Risk::new(risk).unwrap()), level, "{risk}");
    }
    assert_eq!(nse_boundary(m(500.0), m(500.0)), Ok(m(0.0)));
    assert_eq!(nse_boundary(m(500.0), m(300.0)), Ok(m(400.0)));
    assert_eq!(nse_boundary(m(0.0), m(0.0)), Ok(m(0.0)));
    for (tse, fte) in [(500.0, 500.1), (500.0, -0.1), (-1.0, 0.0), (f64::INFINITY, 1.0), (f64::NAN, 0.0)] {
        assert!(nse_boundary(m(tse), m(fte)).is_err(), "{tse} {fte}");
    }
    // Staying for certain changes nothing before the update, leaving for certain shares what was left among the others.
    let before = table.prior(&[0.7, 0.2, 0.1, 0.0]).unwrap();
    for stay in [0.0, 0.25, 1.0] {
        let mut predicted = [0.0; 13];
        (0..4).for_each(|k| predicted[k] = stay * before[k] + (1.0 - stay) * (1.0 - before[k]) / 3.0);
        let expected = table.ln_posterior(m(120.0), &predicted);
        let after = table.remember(&before, stay, m(120.0)).unwrap();
        (0..4).for_each(|k| assert!((after[k] - expected[k].exp()).abs() < 1e-14, "{stay} {k}"));
    }
    assert!(table.remember(&before, 1.000_001, m(120.0)).is_err() && table.remember(&before, -1e-9, m(120.0)).is_err());
    // A sum of 1 within 1e-9, one number a state, none negative.
    assert!(table.prior(&[0.7, 0.2, 0.1, 0.9e-9]).is_ok() && table.prior(&[0.7, 0.2, 0.1, 1.1e-9]).is_err());
    assert!(table.prior(&[0.7, 0.3]).is_err() && table.prior(&[1.1, -0.1, 0.0, 0.0]).is_err());
    assert!(table.of_residuals(1.0, 1.0).is_ok() && table.of_residuals(1.0, 0.9).is_err() && table.of_residuals(-1e-9, 2.0).is_err());
}

/// A walk outwards from ten metres in steps of four thousandths, with the densities of the table as they are: the likeliest state only gets worse, or not.
#[test]
fn states_are_ordered_where_a_walk_outwards_never_turns_back() {
    let mut state = 17_u64;
    let mut draw = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    // Ordered; turned back before the last boundary; turned back far outside.
    let mut seen = [0; 3];
    for n in (2..=5).cycle().take(400) {
        let mut boundaries = vec![Metres::new(100.0)];
        for _ in 1..n {
            let step = [0.05, 0.2, 1.0, 3.0, 10.0, 30.0][(6.0 * draw()) as usize] * (0.5 + draw());
            boundaries.push(Metres::new(boundaries[boundaries.len() - 1].m() * (1.0 + step)));
        }
        let Ok(table) = StateTable::new(&boundaries) else { continue };
        let last = boundaries[boundaries.len() - 1].m();
        let likeliest = |x: f64| {
            let ln_density = |k: usize| -0.5 * ((x - table.mean_m()[k]) / table.sigma_m()[k]).powi(2) - table.sigma_m()[k].ln();
            (0..table.n_states()).fold(0, |best, k| if ln_density(k) > ln_density(best) { k } else { best })
        };
        let mut worst = 0;
        let turn = (0..=4500).map(|s| 10.0 * 1.004_f64.powi(s)).find(|x| {
            let here = likeliest(*x);
            worst = worst.max(here);
            here < worst
        });
        // No turn of these tables is shorter than four thousandths of its distance.
        assert_eq!(is_ordered(&table), turn.is_none(), "{boundaries:?} {turn:?}");
        seen[turn.map_or(0, |x| if x < last { 1 } else { 2 })] += 1;
    }
    assert!(seen.iter().all(|n| *n > 15), "{seen:?}");
}

#[test]
fn settings_at_their_limits_are_taken_and_beyond_them_refused_by_name() {
    let chain =
        Chain { sample_period_s: 1.0, sensor_latency_s: 0.5, filter_s: 0.25, computing_s: 0.125, display_s: 2.0, time_to_alert_s: 10.0 };
    let good = Settings { chain, raise_delay_s: 3.0, clear_delay_s: 10.0, clear_ratio: 0.95, stale_after_s: 2.0 };
    let refused = |settings: Settings| settings.checked().err().map(|e| e.argument);
    assert_eq!(refused(good), None);
    // 1 + 0.5 + 0.25 + 0.125 + 3 + 2 s, and 2 + 0.125 + 2 s.
    let by = |time_to_alert_s: f64| Settings { chain: Chain { time_to_alert_s, ..chain }, ..good };
    assert_eq!((refused(by(6.875)), refused(by(6.874))), (None, Some("time to the crew of an exceedance")));
    let silent = |stale_after_s: f64| Settings { stale_after_s, ..by(6.875) };
    assert_eq!((refused(silent(4.75)), refused(silent(4.751))), (None, Some("time to the crew of a silence")));
    assert_eq!((refused(silent(1.0)), refused(silent(0.999))), (None, Some("stale_after_s")));
    for (clear_ratio, is_good) in [(1.0, true), (1.001, false), (1e-9, true), (0.0, false), (f64::NAN, false)] {
        assert_eq!(refused(Settings { clear_ratio, ..good }).is_none(), is_good, "{clear_ratio}");
    }
    for zero in [0.0, -1e-9, f64::INFINITY, f64::NAN] {
        let is_bad = zero != 0.0;
        for (settings, argument, may_be_zero) in [
            (Settings { chain: Chain { sample_period_s: zero, ..chain }, ..good }, "sample_period_s", false),
            (Settings { chain: Chain { sensor_latency_s: zero, ..chain }, ..good }, "sensor_latency_s", true),
            (Settings { chain: Chain { filter_s: zero, ..chain }, ..good }, "filter_s", true),
            (Settings { chain: Chain { computing_s: zero, ..chain }, ..good }, "computing_s", true),
            (Settings { chain: Chain { display_s: zero, ..chain }, ..good }, "display_s", true),
            (Settings { raise_delay_s: zero, ..good }, "raise_delay_s", true),
            (Settings { clear_delay_s: zero, ..good }, "clear_delay_s", true),
        ] {
            assert_eq!(refused(settings), (is_bad || !may_be_zero).then_some(argument), "{zero}");
        }
    }
}

/// Twelve numbers that are all different: two tracks together have the sum of each, and every number comes back from its words.
#[test]
fn counters_of_two_tracks_add_up_and_come_back_from_their_words() {
    let one = |by: u64| Counters {
        n_accepted: by,
        n_duplicate: 2 * by,
        n_late: 3 * by,
        n_clock_set_back: 5 * by,
        n_gaps: 7 * by,
        n_unusable: 11 * by,
        n_nan: 13 * by,
        n_withdrawn: 17 * by,
        n_cautions: 19 * by,
        n_warnings: 23 * by,
        n_unavailable: 29 * by,
        watched_s: 31.5 * by as f64,
    };
    assert_eq!(one(3).merged(&one(10)), one(13));
    assert_eq!(Counters::from_words(one(7).words()), Ok(one(7)));
    assert_eq!(one(7).words()[..11], [7, 14, 21, 35, 49, 77, 91, 119, 133, 161, 203]);
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(Counters::from_words(Counters { watched_s: bad, ..one(1) }.words()).is_err());
    }
    assert!(Counters::from_words(Counters::default().words()).is_ok());
}
