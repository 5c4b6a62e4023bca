//! Against whole inversions, against the law of errors, and at the edges of a geometry.

use super::*;
use crate::bound::araim::exclusion::Decision;
use crate::signal::Constellation::{Galileo, Gps};
use nalgebra::{SMatrix, SVector};

#[path = "../../../tests/common/sky.rs"]
mod nine;
use nine::SKY;

fn sight(&(az, el, sigma): &(f64, f64, f64), constellation: crate::signal::Constellation) -> Sight {
    let (az, el) = (f64::to_radians(az), f64::to_radians(el));
    let unit = Vector3::new(el.cos() * az.sin(), el.cos() * az.cos(), el.sin());
    Sight::plain(unit, constellation, sigma * sigma)
}

fn sky(n: usize) -> Vec<Sight> {
    SKY[..n].iter().map(|s| sight(s, Gps)).collect()
}

/// Slopes, horizontal and vertical, and sigmas by the whole normal equation with its clocks.
fn whole(sights: &[Sight]) -> (f64, f64, [f64; 3]) {
    let row = |s: &Sight| {
        let clock = f64::from(u8::from(s.constellation == Gps));
        SVector::<f64, 5>::new(-s.unit.x, -s.unit.y, -s.unit.z, clock, 1.0 - clock)
    };
    let mut normal = sights.iter().fold(SMatrix::<f64, 5, 5>::zeros(), |sum, s| sum + row(s) / s.integrity_m2 * row(s).transpose());
    // A clock that no satellite has is held.
    for clock in [3, 4] {
        normal[(clock, clock)] += f64::from(u8::from(normal[(clock, clock)] == 0.0));
    }
    let p = normal.try_inverse().unwrap();
    let slope = |s: &Sight| {
        let weight = 1.0 / s.integrity_m2;
        let gain = p * row(s) * weight;
        let root = (weight - weight * row(s).dot(&gain)).sqrt();
        (gain[0].hypot(gain[1]) / root, gain[2].abs() / root)
    };
    let most = sights.iter().map(slope).fold((0.0_f64, 0.0_f64), |m, x| (m.0.max(x.0), m.1.max(x.1)));
    (most.0, most.1, [0, 1, 2].map(|a| p[(a, a)].sqrt()))
}

/// Inversions of condition below 1e4 lose twelve digits at most of sixteen, twice.
const INVERTED: f64 = 1e-10;

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= INVERTED * b.abs()
}

#[test]
fn slopes_and_levels_are_those_of_whole_inversions_with_one_clock_and_two() {
    let mut monitor = Monitor::new(&Requirement::RAIM);
    let mut two = sky(8);
    two[2].constellation = Galileo;
    two[5].constellation = Galileo;
    two[7].constellation = Galileo;
    for sights in [sky(8), sky(5), two] {
        let (h, v, sigma) = whole(&sights);
        let levels = monitor.levels(&sights).unwrap();
        let missed = Factors::new(&Requirement::RAIM, levels.detail.redundancy).missed_bias;
        assert!(close(levels.detail.hpl_slope.m(), h * missed) && close(levels.detail.vpl_slope.m(), v * missed));
        let k = two_sided_factor(1e-3);
        assert!(close(levels.hpl.m(), h * missed + k * sigma[0].hypot(sigma[1])) && close(levels.vpl_m(), v * missed + k * sigma[2]));
    }
}

#[test]
fn levels_after_exclusion_are_the_worst_of_every_geometry_without_one() {
    let mut monitor = Monitor::new(&Requirement::RAIM);
    let mut two = sky(8);
    two[2].constellation = Galileo;
    two[5].constellation = Galileo;
    for sights in [sky(8), sky(6), two] {
        let detection = monitor.levels(&sights).unwrap();
        let after = monitor.after_exclusion(&detection);
        let (mut hel, mut vel) = (detection.hpl.m(), detection.vpl_m());
        for out in 0..sights.len() {
            let mut rest = sights.clone();
            rest.remove(out);
            let levels = monitor.levels(&rest).unwrap();
            (hel, vel) = (hel.max(levels.hpl.m()), vel.max(levels.vpl_m()));
        }
        assert!(close(after.hpl.m(), hel) && close(after.vpl_m(), vel), "{after:?}, {hel}, {vel}");
    }
}

#[test]
fn five_satellites_detect_six_exclude_and_four_do_neither() {
    let mut monitor = Monitor::new(&Requirement::RAIM);
    assert_eq!(monitor.levels(&sky(3)).unwrap_err(), Unavailable::TooFewSatellites { need: 4, have: 3 });
    let four = monitor.levels(&sky(4)).unwrap();
    assert!(four.hpl.m() == f64::INFINITY && four.detail.hpl_slope.m() == f64::INFINITY && four.detail.sigma[0].m().is_finite());
    let five = monitor.levels(&sky(5)).unwrap();
    assert!(five.hpl.m().is_finite() && monitor.after_exclusion(&five).hpl.m() == f64::INFINITY);
    let six = monitor.levels(&sky(6)).unwrap();
    assert!(monitor.after_exclusion(&six).hpl.m().is_finite());
}

#[test]
fn a_lone_satellite_of_another_clock_changes_nothing() {
    let mut monitor = Monitor::new(&Requirement::RAIM);
    let six = monitor.levels(&sky(6)).unwrap();
    let excluding = monitor.after_exclusion(&six);
    let mut more = sky(6);
    more.push(sight(&SKY[7], Galileo));
    let with = monitor.levels(&more).unwrap();
    assert!(close(with.hpl.m(), six.hpl.m()) && with.detail.redundancy == six.detail.redundancy);
    assert!(close(monitor.after_exclusion(&with).hpl.m(), excluding.hpl.m()));
}

#[test]
fn a_satellite_that_nothing_checks_leaves_no_level() {
    // Seven on one cone cannot tell height from clock: only the eighth does.
    let mut sights: Vec<_> = (0..7).map(|k| sight(&(51.0 * f64::from(k), 30.0, 1.0), Gps)).collect();
    sights.push(sight(&(20.0, 80.0, 1.0), Gps));
    let mut monitor = Monitor::new(&Requirement::RAIM);
    let levels = monitor.levels(&sights).unwrap();
    assert_eq!(levels.vpl_m(), f64::INFINITY);
    assert_eq!(monitor.after_exclusion(&levels).vpl_m(), f64::INFINITY);
}

#[test]
fn a_wrong_satellite_is_identified_and_left_out_with_the_levels_of_the_rest() {
    let mut monitor = Monitor::new(&Requirement::RAIM);
    let sights = sky(8);
    for wrong in 0..8 {
        let mut residuals = [250.0; 8];
        residuals[wrong] += 300.0;
        let outcome = monitor.monitored(&sights, &residuals).unwrap();
        assert_eq!((outcome.decision, outcome.excluded), (Decision::Excluded, Some(wrong)));
        let mut rest = sights.clone();
        rest.remove(wrong);
        assert_eq!(outcome.levels, monitor.levels(&rest).unwrap());
        // Without the wrong one the ranges agree to rounding of 250 m.
        assert!(outcome.step.iter().all(|s| s.m().abs() < 1e-9) && outcome.ratio > 1.0);
    }
    let quiet = monitor.monitored(&sights, &[250.0; 8]).unwrap();
    assert_eq!((quiet.decision, quiet.excluded), (Decision::Nothing, None));
    // Five see it and cannot tell which it is; two at a time are not one.
    let five = monitor.monitored(&sights[..5], &[0.0, 500.0, 0.0, 0.0, 0.0]).unwrap();
    assert_eq!((five.decision, five.excluded), (Decision::NotExcluded, None));
    let two = monitor.monitored(&sights, &[0.0, 500.0, 0.0, 0.0, -700.0, 0.0, 0.0, 0.0]).unwrap();
    assert_eq!(two.decision, Decision::NotExcluded);
}

#[test]
fn numbers_that_are_none_are_named() {
    let mut monitor = Monitor::new(&Requirement::RAIM);
    let invalid = |r: Result<Levels, Unavailable>| match r {
        Err(Unavailable::Invalid { field, .. }) => field,
        other => panic!("{other:?}"),
    };
    let mut sights = sky(6);
    sights[3].integrity_m2 = f64::NAN;
    assert_eq!(invalid(monitor.levels(&sights)), "sigma_m");
    sights[3].integrity_m2 = -1.0;
    assert_eq!(invalid(monitor.levels(&sights)), "sigma_m");
    sights[3] = Sight { unit: Vector3::new(0.0, 0.0, 2.0), ..sky(1)[0] };
    assert_eq!(invalid(monitor.levels(&sights)), "unit_enu");
    assert_eq!(invalid(monitor.levels(&[sky(1)[0]; 65])), "n_sv");
    assert_eq!(invalid(monitor.monitored(&sky(6), &[f64::NAN; 6]).map(|m| m.levels)), "residual_m");
    assert_eq!(invalid(monitor.monitored(&sky(6), &[0.0; 5]).map(|m| m.levels)), "residual_m");
}

/// The deviation that an error names is the one that was given: the root of 1 / weight.
#[test]
fn a_weight_that_is_none_is_named_by_its_deviation() {
    let named = |weight: f64| match checked(&Row { unit: Vector3::z(), weight, clock: 0, residual: 0.0 }).unwrap_err() {
        Unavailable::Invalid { field, value, .. } => (field, value),
        other => panic!("{other:?}"),
    };
    assert_eq!(named(f64::INFINITY), ("sigma_m", 0.0));
    assert_eq!(named(0.0), ("sigma_m", f64::INFINITY));
    assert!(named(-4.0).1.is_nan());
    assert!(checked(&Row { unit: Vector3::z(), weight: 4.0, clock: 0, residual: 0.0 }).is_ok());
}
