//! One epoch, one step: what is decided of an epoch, against numbers that are known without it.
#![allow(clippy::unwrap_used, reason = "a helper of tests may stop at the first surprise, too")]

use crate::common;
use navbound_core::bound::Alerting;
use navbound_core::frame::Covariance;
use navbound_core::judge::{Judge, Sample, Settings};
use navbound_core::monitor::rnp::Alert;
use navbound_core::quantity::{GpsTime, Metres, Radians, Reason, Risk, Status};

/// Normal deviates of two-sided 5 % and 1e-5 (tables of the normal law).
const K95: f64 = 1.959_963_984_540_054;
const K5: f64 = 4.417_173_413_469_023;

fn settings() -> Settings {
    common::settings("tse-exact", &[0.3, 1.0, 2.0, 5.0], 0.0, false)
}

/// On course north, ten metres of deviation to the east, the path under it.
fn sample(second: i64) -> Sample {
    Sample {
        time: GpsTime::from_nanoseconds(second * 1_000_000_000),
        status: Status::Ok,
        course: Some(Radians::new(0.0)),
        path_angle: None,
        fte_m: Some(0.0),
        fte_v_m: None,
        covariance: Some(Covariance::from_upper([100.0, 0.0, 2500.0, f64::NAN, f64::NAN, f64::NAN])),
        nse_en_m: Some([3.0, 4.0]),
        nse_u_m: None,
        rnp: Some(Metres::new(10.0 * K95)),
        hpl: None,
    }
}

fn near(value: f64, expected: f64) -> bool {
    // The quantile is found to a few units in its last place.
    (value / expected - 1.0).abs() < 1e-13
}

#[test]
fn an_epoch_says_what_the_normal_law_says() {
    let mut judge = Judge::new(settings()).unwrap();
    let judged = judge.step(&sample(0));
    let e = &judged.evaluated;
    assert_eq!((e.errors.cross_m, e.errors.along_m, e.errors.horizontal_m), (Some(3.0), Some(4.0), Some(5.0)));
    assert_eq!((e.errors.tse_m, e.errors.sigma_cross_m), (Some(3.0), Some(10.0)));
    assert!(near(e.accuracy.unwrap().unwrap().length().m(), 10.0 * K95));
    assert!(near(e.integrity.unwrap().unwrap().length().m(), 10.0 * K5));
    let [once, twice] = e.exceedance.unwrap();
    // erfc(2 K95 / sqrt 2) by another library.
    assert!(near(once, 0.05) && near(twice, 8.857_543_832_140_405e-5), "{once} {twice}");
    // Nearly all of it is within the tightest level.
    assert_eq!(e.tightest_level, Some(0));
    assert!((e.state_probability.unwrap()[..5].iter().sum::<f64>() - 1.0).abs() < 1e-15);
    // 44 m against 39 m: the risk of a fault-free 1e-5 is beyond twice RNP.
    assert_eq!(judged.step.alert, Alert::Warning);
    assert_eq!(judged.integrity_compared, e.integrity.unwrap().unwrap().length());
}

#[test]
fn what_the_status_forbids_is_not_judged_and_what_is_missing_says_so() {
    let mut judge = Judge::new(settings()).unwrap();
    let none = judge.step(&Sample { status: Status::NotAvailable, ..sample(0) });
    assert!(none.evaluated.accuracy.is_none() && none.evaluated.exceedance.is_none() && none.evaluated.state_probability.is_none());
    assert!(none.evaluated.errors.cross_m.is_some(), "an error that is known is known");
    assert_eq!(none.step.alert, Alert::Unavailable);
    let without_path = judge.step(&Sample { course: None, ..sample(1) });
    assert!(matches!(without_path.evaluated.accuracy, Some(Err(_))));
    assert!(without_path.integrity_compared.m().is_nan());
    assert_eq!((without_path.evaluated.status, without_path.evaluated.reason()), (Status::NotAvailable, Some(Reason::MissingField)));
    assert_eq!(without_path.step.alert, Alert::Unavailable, "an epoch that cannot be judged is a loss of monitoring");
    let without_rnp = judge.step(&Sample { rnp: None, ..sample(2) });
    assert!(without_rnp.evaluated.exceedance.is_none() && without_rnp.evaluated.state_probability.is_some());
    assert_eq!(without_rnp.step.alert, Alert::Warning);
}

#[test]
fn a_reason_against_judging_is_the_status_of_everything_after_it() {
    let mut judge = Judge::new(settings()).unwrap();
    let wide = Sample { rnp: Some(Metres::new(100.0)), ..sample(0) };
    assert_eq!(judge.step(&wide).evaluated.status, Status::Ok);
    let negative = Covariance::from_upper([-1.0, 0.0, 4.0, f64::NAN, f64::NAN, f64::NAN]);
    let refused = judge.step(&Sample { time: sample(1).time, covariance: Some(negative), ..wide });
    assert_eq!((refused.evaluated.status, refused.evaluated.reason()), (Status::InvalidInput, Some(Reason::InvalidNumber)));
    assert!(refused.evaluated.exceedance.is_none() && refused.evaluated.state_probability.is_none());
    assert_eq!(refused.step.alert, Alert::Unavailable);
    let began = refused.step.began[2].unwrap();
    assert_eq!((began.onset, began.annunciation, began.clear), (sample(1).time, sample(1).time, None), "what began is said at once");
    let other = judge.settings().beside(Alerting::of("anp-circle").unwrap().method(), &Sample { covariance: Some(negative), ..wide });
    assert!(other.unwrap().iter().all(Result::is_err), "the bound of another method says why it is none");
}

#[test]
fn a_level_is_compared_with_the_deviation_and_its_loss_makes_nothing_better() {
    let mut judge = Judge::new(Settings { with_levels: true, ..settings() }).unwrap();
    let wide = Sample { rnp: Some(Metres::new(100.0)), fte_m: Some(-20.0), ..sample(0) };
    let with_level = judge.step(&Sample { hpl: Some(Metres::new(150.0)), ..wide });
    assert_eq!((with_level.integrity_compared.m(), with_level.step.alert), (170.0, Alert::Normal));
    let lost = judge.step(&Sample { time: sample(1).time, ..wide });
    assert!(lost.integrity_compared.m().is_nan());
    assert_eq!(lost.step.alert, Alert::Warning);
    // A degraded epoch owes none: its bound is that of its covariance.
    let degraded = judge.step(&Sample { time: sample(2).time, status: Status::Degraded, ..wide });
    assert_eq!(degraded.integrity_compared, degraded.evaluated.integrity.unwrap().unwrap().length());
}

#[test]
fn a_bound_of_another_covariance_is_the_same_whoever_evaluates_it_first() {
    let settings = settings();
    let rows: Vec<Sample> = (0..50).map(|k| Sample { fte_m: Some(k as f64 - 25.0), rnp: Some(Metres::new(60.0)), ..sample(k) }).collect();
    let mut one = Judge::new(settings).unwrap();
    let by_step: Vec<String> = rows.iter().map(|row| format!("{:?}", one.step(row))).collect();
    let evaluated: Vec<_> = rows.iter().rev().map(|row| settings.evaluate(row)).collect();
    let mut other = Judge::new(settings).unwrap();
    let by_parts: Vec<String> = rows.iter().zip(evaluated.iter().rev()).map(|(row, e)| format!("{:?}", other.follow(row, *e))).collect();
    assert_eq!(by_step, by_parts);
}

#[test]
fn the_tightest_level_is_the_first_that_the_risk_allows() {
    let states = settings().states.unwrap();
    let mut probability = [0.0; 13];
    probability[..5].copy_from_slice(&[0.90, 0.06, 0.03, 0.005, 0.005]);
    let at = |q: f64| states.tightest(&probability, Risk::new(q).unwrap());
    // Beyond the levels: 0.1, 0.04, 0.01, 0.005.
    assert_eq!([at(0.2), at(0.05), at(0.02), at(0.006), at(0.001)], [0, 1, 2, 3, 4]);
}
