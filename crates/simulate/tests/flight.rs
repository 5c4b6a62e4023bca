//! A flight is what its scenario says, and its errors are what its covariance says.
#![allow(clippy::unwrap_used)] // A test may stop at the first surprise, its helpers too.

use navbound_core::frame::LatLon;
use navbound_core::quantity::{Metres, Radians};
use navbound_path::{Line, Route};
use navbound_simulate::{Fault, FlownEpoch, Outlook, Plan, Scenario, fly};

fn scenario() -> Scenario {
    serde_json::from_str(include_str!("scenario.json")).unwrap()
}

fn flight(scenario: Scenario, number: u64) -> Vec<FlownEpoch> {
    fly(&Outlook::new(scenario).unwrap(), 7, number).unwrap()
}

fn points() -> Vec<LatLon> {
    scenario().waypoints.iter().map(|w| LatLon::new(Radians::new(w.lat_rad), Radians::new(w.lon_rad)).unwrap()).collect()
}

fn cross_of(e: &FlownEpoch) -> f64 {
    e.nse_enu_m[0] * e.course_rad.cos() - e.nse_enu_m[1] * e.course_rad.sin()
}

#[test]
fn the_flight_lasts_as_long_as_it_should() {
    let epochs = flight(scenario(), 0);
    assert_eq!(epochs.len(), 900);
    assert_eq!(epochs[899].time_ns - epochs[0].time_ns, 899_000_000_000);
    // One second before the end, at 70 m/s and slowing from about 71: 70 to 71 m are left of the planned path. The estimate's foot is
    // off by the navigation error along the path, some metres.
    let plan = Plan::new(&scenario()).unwrap();
    let left = plan.length().m() - epochs[899].along_m;
    assert!((60.0..81.0).contains(&left), "{left} m left");
    assert!(epochs[899].ground_speed_mps > 70.0 && epochs[899].ground_speed_mps < 71.0);
}

#[test]
fn distance_flown_is_the_integral_of_speed() {
    // The trapezoid over a second is exact where acceleration is constant; a change inside a second costs at most a/8 = 0.3 m.
    let mut quiet = scenario();
    (quiet.navigation.ranging_sigma_m, quiet.navigation.ionosphere_sigma_m) = (1e-6, 0.0);
    (quiet.navigation.troposphere_sigma_m, quiet.navigation.noise_sigma_m, quiet.navigation.multipath_share) = (0.0, 0.0, 0.0);
    for pair in flight(quiet, 0).windows(2) {
        let mean = 0.5 * (pair[0].ground_speed_mps + pair[1].ground_speed_mps);
        assert!((pair[1].along_m - pair[0].along_m - mean).abs() < 0.3);
    }
}

#[test]
fn technical_error_and_navigation_error_add_up_to_the_true_deviation() {
    // Truth is found on the legs' own lines, not by the route's projection that made the technical error. Straight legs only; 1 mm, since
    // both are short vectors on a plane touching the ellipsoid: 100 m * 100 m / 6e6 m.
    let points = points();
    let lines: Vec<Line> = points.windows(2).map(|p| Line::through(p[0], p[1]).unwrap()).collect();
    let mut checked = 0;
    for e in flight(scenario(), 3) {
        let line = &lines[e.leg as usize];
        let truth = LatLon::new(Radians::new(e.truth[0]), Radians::new(e.truth[1])).unwrap();
        let foot = line.project(&truth).unwrap();
        let from_ends = foot.along.m().min(line.length().m() - foot.along.m());
        if from_ends > 6_000.0 {
            checked += 1;
            assert!((foot.cross.m() - e.fte_m[0] - cross_of(&e)).abs() < 5e-3, "{} {}", foot.cross.m(), e.fte_m[0] + cross_of(&e));
            assert!((e.truth[2] - e.estimate[2] - e.nse_enu_m[2]).abs() < 1e-9);
        }
    }
    assert!(checked > 300, "{checked}");
}

#[test]
fn errors_have_the_covariance_that_is_claimed() {
    // e' V^-1 e is chi-square with 3 degrees of freedom, variance 6. Epochs 100 s apart are 5 correlation times apart. Four standard
    // errors of 120 * 9 samples: 4 sqrt(6/1080) = 0.30. Few satellites, so that the components are correlated and a factor the wrong
    // way round shows.
    let mut few = scenario();
    (few.navigation.constellations, few.navigation.mask_rad) = (vec![navbound_simulate::System::Gps], 0.25);
    let outlook = Outlook::new(few).unwrap();
    let mut sum = 0.0;
    let mut n = 0.0;
    for number in 0..120 {
        for e in fly(&outlook, 11, number).unwrap().iter().step_by(100) {
            let [ee, en, nn, eu, nu, uu] = e.covariance_m2;
            let v = nalgebra::Matrix3::new(ee, en, eu, en, nn, nu, eu, nu, uu);
            let x = nalgebra::Vector3::from(e.nse_enu_m);
            sum += x.dot(&(v.try_inverse().unwrap() * x));
            n += 1.0;
        }
    }
    assert!((sum / n - 3.0).abs() < 0.30, "{}", sum / n);
}

#[test]
fn errors_are_correlated_over_the_stated_time() {
    // Correlation of the up error at 20 s lag is 1/e; standard error over 50 flights of about 900/20 independent stretches: 0.02.
    let outlook = Outlook::new(scenario()).unwrap();
    let (mut product, mut square) = (0.0, 0.0);
    for number in 0..50 {
        let up: Vec<f64> = fly(&outlook, 5, number).unwrap().iter().map(|e| e.nse_enu_m[2] / e.covariance_m2[5].sqrt()).collect();
        product += up.windows(21).map(|w| w[0] * w[20]).sum::<f64>();
        square += up.windows(21).map(|w| w[0] * w[0]).sum::<f64>();
    }
    assert!((product / square - (-1.0_f64).exp()).abs() < 0.08, "{}", product / square);
}

#[test]
fn a_mismodelled_claim_changes_the_covariance_and_nothing_else() {
    let mut boast = scenario();
    boast.navigation.claimed_sigma_scale = 0.5;
    for (consistent, boasting) in flight(scenario(), 0).iter().zip(flight(boast, 0)) {
        for i in 0..6 {
            // A quarter is exact in binary.
            assert_eq!(boasting.covariance_m2[i], 0.25 * consistent.covariance_m2[i]);
        }
        assert_eq!(FlownEpoch { covariance_m2: consistent.covariance_m2, ..boasting }, *consistent);
    }
}

#[test]
fn a_ramp_grows_to_the_right_and_the_covariance_does_not_know() {
    let mut led = scenario();
    led.faults = vec![Fault::LateralRamp { start_s: 300.0, duration_s: 100.0, rate_mps: 4.0 }];
    let (plain, led) = (flight(scenario(), 0), flight(led, 0));
    for (i, (a, b)) in plain.iter().zip(&led).enumerate() {
        assert_eq!(a.covariance_m2, b.covariance_m2);
        let expected = if (300..400).contains(&i) { 4.0 * (i as f64 - 300.0) } else { 0.0 };
        let added = nalgebra::Vector3::from(b.nse_enu_m) - nalgebra::Vector3::from(a.nse_enu_m);
        // The ramp is across the planned course; in a turn the estimate's foot has another.
        assert!((added.norm() - expected).abs() < 1e-9);
        if expected > 0.0 {
            assert!(cross_of(b) - cross_of(a) > 0.9 * expected);
        }
    }
}

#[test]
fn degraded_ranging_is_felt_and_admitted() {
    let mut poor = scenario();
    poor.faults = vec![Fault::DegradedRanging { start_s: 300.0, duration_s: 100.0, sigma_factor: 4.0 }];
    for (i, (a, b)) in flight(scenario(), 0).iter().zip(flight(poor, 0)).enumerate() {
        let factor = if (300..400).contains(&i) { 4.0 } else { 1.0 };
        assert_eq!(b.covariance_m2[0], factor * factor * a.covariance_m2[0]);
        assert!((b.nse_enu_m[2] - factor * a.nse_enu_m[2]).abs() < 1e-9);
    }
}

#[test]
fn without_satellites_there_is_no_estimate_and_the_flight_goes_on() {
    let mut blind = scenario();
    blind.navigation.mask_rad = 1.5;
    let epochs = flight(blind, 0);
    assert_eq!(epochs.len(), 900);
    for e in &epochs {
        assert!(
            e.reason.is_some() && e.estimate[0].is_nan() && e.covariance_m2[0].is_nan() && e.fte_m[0].is_nan() && e.nse_enu_m[0].is_nan()
        );
        assert!(e.truth.iter().chain(&e.path).all(|x| x.is_finite()));
    }
}

#[test]
fn every_flight_has_its_own_errors_and_always_the_same() {
    let outlook = Outlook::new(scenario()).unwrap();
    assert_eq!(fly(&outlook, 7, 1).unwrap(), fly(&outlook, 7, 1).unwrap());
    let differ = |a: Vec<FlownEpoch>, b: Vec<FlownEpoch>| (a[500].nse_enu_m[0] - b[500].nse_enu_m[0]).abs() > 1e-6;
    assert!(differ(fly(&outlook, 7, 1).unwrap(), fly(&outlook, 7, 2).unwrap()));
    assert!(differ(fly(&outlook, 7, 1).unwrap(), fly(&outlook, 8, 1).unwrap()));
}

#[test]
fn a_tighter_loop_leaves_less_technical_error() {
    let spread = |frequency: f64| {
        let mut s = scenario();
        s.guidance.lateral_frequency_radps = frequency;
        let flown = flight(s, 0);
        flown.iter().map(|e| e.fte_m[0] * e.fte_m[0]).sum::<f64>()
    };
    assert!(spread(0.12) < 0.5 * spread(0.04));
}

#[test]
fn phases_follow_the_route() {
    let plan = Plan::new(&scenario()).unwrap();
    for e in flight(scenario(), 0) {
        let expected = if e.along_m < plan.waypoints_along()[1].m() {
            0
        } else if e.along_m < plan.length().m() - 15_000.0 {
            1
        } else {
            2
        };
        // The phase is the plan's, the foot the estimate's: within some metres of a boundary they may differ.
        let near = plan.phases().iter().any(|p| (p.end.m() - e.along_m).abs() < 30.0);
        assert!(e.phase == expected || near);
        assert_eq!(e.rnp_m, [1852.0, 1852.0, 555.6][e.phase as usize]);
    }
}

#[test]
fn turns_shorten_the_route_as_their_bank_says() {
    // Both turns are flown at half the track change of bank: R (2 tan(d/2) - d) each, at the speed of the second nearest the waypoint. In
    // the descent that speed changes by some 0.3 m/s in a second, 0.6 % of the radius; 1 % in all.
    let corners = Route::new(&points(), &[Metres::new(0.0); 4]).unwrap().length().m();
    let plan = Plan::new(&scenario()).unwrap();
    let epochs = flight(scenario(), 0);
    let mut expected = 0.0;
    for (change, passed) in Route::track_changes(&points()).unwrap().iter().zip(&plan.waypoints_along()[1..]) {
        let v = epochs.iter().find(|e| e.along_m >= passed.m()).unwrap().ground_speed_mps;
        let d = change.rad().abs();
        expected += v * v / (9.806_65 * (0.5 * d).tan()) * (2.0 * (0.5 * d).tan() - d);
    }
    let shortened = corners - plan.length().m();
    assert!((shortened / expected - 1.0).abs() < 0.01, "{shortened} for {expected}");
}

type Change = fn(&mut Scenario);

#[test]
fn what_cannot_be_flown_is_refused_by_name() {
    let changes: [(&str, Change); 14] = [
        ("duration_s", |s| s.duration_s = f64::NAN),
        ("duration_s", |s| s.duration_s = 100.0),
        ("duration_s", |s| s.duration_s = 50_000.0),
        ("mask_rad", |s| s.navigation.mask_rad = -0.1),
        ("ranging_sigma_m", |s| s.navigation.ranging_sigma_m = 0.0),
        ("correlation_time_s", |s| s.navigation.correlation_time_s = 0.0),
        ("climb_rates_mps", |s| s.profile.climb_rates_mps = vec![]),
        ("cruise_height_m", |s| s.profile.cruise_height_m = 19_000.0),
        ("bank_min_rad", |s| s.turns.bank_min_rad = 2.0),
        ("phases.until_waypoint", |s| s.phases[0].until_waypoint = Some("Z".into())),
        ("phases.until", |s| s.phases[1].until_before_end_m = Some(1e9)),
        ("phases", |s| drop(s.phases.pop())),
        ("lat_rad", |s| s.waypoints[1].lat_rad = 2.0),
        ("rate_mps", |s| s.faults = vec![Fault::LateralRamp { start_s: 0.0, duration_s: 1.0, rate_mps: f64::NAN }]),
    ];
    for (argument, change) in changes {
        let mut s = scenario();
        change(&mut s);
        let refusal = match Plan::new(&s) {
            Err(navbound_simulate::Refused::Value(e)) => e.argument,
            Err(navbound_simulate::Refused::Item(at)) => at.error.argument,
            Ok(_) => "accepted",
        };
        assert_eq!(refusal, argument);
    }
}
