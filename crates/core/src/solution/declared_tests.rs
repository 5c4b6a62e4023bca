use super::*;
use crate::quantity::Metres;
use crate::signal::{Constellation, SatelliteId};
use crate::solution::mixture::{COMMON, Observed};
use crate::solution::surroundings::tests::fix;
use nalgebra::Vector3;

fn at(seconds: i64) -> GpsTime {
    GpsTime::from_nanoseconds(seconds * 1_000_000_000)
}

/// Readings of `n` ranges of 1 m round the horizon and overhead, one of which is wrong by `fault`.
fn readings(n: usize, fault: f64) -> Mixture {
    let one = |k: usize| {
        let (azimuth, elevation) = (2.4 * k as f64, 0.3 + 0.25 * (k % 5) as f64);
        let unit = Vector3::new(elevation.cos() * azimuth.sin(), elevation.cos() * azimuth.cos(), elevation.sin());
        Observed { unit, clock: 0, sigma_m: 1.0, residual_m: if k == 2 { fault } else { 0.0 }, common_m: [0.0; COMMON] }
    };
    Mixture::new(&(0..n).map(one).collect::<Vec<_>>()).unwrap()
}

fn declared(mut fix: Fix, mixture: Option<&Mixture>) -> (Option<Doubt>, Fix) {
    let doubt = Declarations::default().declare(at(0), &mut fix, mixture, None);
    (doubt, fix)
}

#[test]
fn a_position_that_nothing_contradicts_and_three_ranges_check_is_ok_and_unchanged() {
    let before = fix(1.0, &[]);
    assert_eq!(declared(before, None), (None, before));
}

#[test]
fn an_exclusion_that_five_ranges_cannot_confirm_is_degraded_and_wider() {
    let gps = SatelliteId { constellation: Constellation::Gps, number: 5 };
    let before = Fix { redundancy: 1, spare: 1, n_used: 5, ..fix(100.0, &[gps]) };
    let (doubt, after) = declared(before, Some(&readings(6, 40.0)));
    assert_eq!(doubt, Some(Doubt::ExclusionUnconfirmed));
    assert!(after.covariance.matrix().trace() > 2.0 * before.covariance.matrix().trace());
}

/// The 95 % circle of a round covariance is sqrt(-2 ln 0.05) = 2.4477 standard deviations.
#[test]
fn a_circle_of_more_than_a_tenth_of_a_mile_is_degraded_and_declared_as_it_is() {
    for (sigma, expected) in [(75.6, None), (75.7, Some(Doubt::WideCircle)), (f64::NAN, Some(Doubt::WideCircle))] {
        let v = sigma * sigma;
        let before =
            Fix { covariance: Covariance::claim_symmetric(nalgebra::Matrix3::from_diagonal(&Vector3::new(v, v, 1.0))), ..fix(1.0, &[]) };
        let (doubt, after) = declared(before, None);
        assert_eq!(doubt, expected, "{sigma}");
        assert!(sigma.is_nan() || after.covariance == before.covariance, "{sigma}");
    }
}

#[test]
fn a_doubt_has_an_order() {
    let alone = |f: Fix| declared(f, None).0;
    let fix = fix(1.0, &[]);
    assert_eq!(alone(Fix { consistent: false, ..fix }), Some(Doubt::ResidualsContradict));
    assert_eq!(alone(Fix { consistent: false, redundancy: 0, spare: 0, ..fix }), Some(Doubt::NoRedundancy));
    assert_eq!(alone(Fix { redundancy: 2, spare: 0, ..fix }), Some(Doubt::ClockUnchecked));
    // Without its readings a position with two ranges to spare is not confirmed.
    assert_eq!(alone(Fix { redundancy: 2, spare: 2, ..fix }), Some(Doubt::ReadingUnconfirmed));
}

#[test]
fn a_jump_is_refused_and_its_refusal_has_a_number_and_a_sentence() {
    let mut d = Declarations::default();
    let mut here = fix(1.0, &[]);
    assert_eq!(d.declare(at(0), &mut here, None, None), None);
    let mut there = fix(1.0, &[]);
    there.position.height = Metres::new(90_000.0);
    let doubt = d.declare(at(1), &mut there, None, None).unwrap();
    assert_eq!(doubt, Doubt::ImplausibleJump);
    assert!(doubt.refuses() && doubt.refusal(&there).is_some());
}

#[test]
fn every_doubt_has_an_id_of_its_own_and_only_refusals_refuse() {
    let fix = fix(1.0, &[]);
    for (k, doubt) in Doubt::ALL.iter().enumerate() {
        assert!(Doubt::ALL[..k].iter().all(|d| d.reason() != doubt.reason()), "{doubt:?}");
        assert_eq!(doubt.refusal(&fix).is_some(), doubt.refuses(), "{doubt:?}");
        if let Some(why) = doubt.refusal(&fix) {
            assert_eq!(Doubt::of(&why), Some(*doubt));
        }
    }
}

#[test]
fn codes_that_are_led_off_outweigh_what_is_unconfirmed_and_not_what_contradicts() {
    let way = Vector3::new(30.0, 0.0, 40.0);
    for doubt in Doubt::ALL.into_iter().map(Some).chain([None]) {
        let mut fix = fix(1.0, &[]);
        let reported = fix.led_off(&way, doubt);
        let stays = doubt.is_some_and(|d| d.refuses() || d.reason().id().contains("contradict"));
        let wider = fix.covariance.matrix()[(0, 0)] - 1.0;
        assert_eq!((reported, wider), if stays { (doubt, 0.0) } else { (Some(Doubt::CodesLedOff), 900.0) }, "{doubt:?}");
    }
}
