use super::*;
use crate::frame::{Covariance, Geodetic, LatLon};
use crate::quantity::{Metres, Radians};
use crate::solution::point::EXCLUDED_NAMED;
use crate::solution::wls::Dilution;

fn gps(number: u8) -> SatelliteId {
    SatelliteId { constellation: Constellation::Gps, number }
}

/// A position whose residuals, before exclusion, were `factor` times what the weights say.
pub(in crate::solution) fn fix(factor: f64, excluded: &[SatelliteId]) -> Fix {
    let mut named = [None; EXCLUDED_NAMED];
    for (slot, satellite) in named.iter_mut().zip(excluded) {
        *slot = Some(*satellite);
    }
    let point = LatLon::new(Radians::new(0.4), Radians::new(2.0)).unwrap();
    Fix {
        position: Geodetic { point, height: Metres::new(10.0) },
        covariance: Covariance::from_upper([1.0, 0.0, 1.0, 0.0, 0.0, 1.0]),
        dilution: Dilution { east: 1.0, north: 1.0, horizontal: 1.0, vertical: 1.0, position: 1.0 },
        clock_m: [0.0; Constellation::ALL.len()],
        offset_variance_m2: [0.0; Constellation::ALL.len()],
        used: [0; Constellation::ALL.len()],
        spare: 4,
        velocity: None,
        n_used: 8,
        n_excluded: excluded.len(),
        excluded: named,
        before_exclusion: (4.0 * factor, 4),
        inflation: 1.0,
        residual_risk: 0.5,
        redundancy: 4,
        consistent: true,
    }
}

fn at(seconds: i64) -> GpsTime {
    GpsTime::from_nanoseconds(seconds * 1_000_000_000)
}

#[test]
fn one_faulty_satellite_is_a_fault_however_long() {
    let mut s = Surroundings::default();
    for t in 0..300 {
        assert_eq!(s.judge(at(t), &fix(1e6, &[gps(5)])), None, "{t}");
    }
}

#[test]
fn two_satellites_within_a_minute_are_surroundings_until_a_minute_later() {
    let mut s = Surroundings::default();
    assert_eq!(s.judge(at(0), &fix(100.0, &[gps(5)])), None);
    assert_eq!(s.judge(at(59), &fix(1.0, &[])), None);
    let there = s.judge(at(60), &fix(100.0, &[gps(7)]));
    // The two bad epochs weigh e^-1 and 1, the good one e^(-1/60): a mean of 58 to 59.
    assert!(there.is_some_and(|f| (58.0..59.0).contains(&f)), "{there:?}");
    // One minute after the first its exclusion is forgotten.
    assert_eq!(s.judge(at(61), &fix(1.0, &[])), None);
}

#[test]
fn residuals_that_fail_in_spite_of_exclusion_are_surroundings() {
    let mut s = Surroundings::default();
    let failing = Fix { consistent: false, ..fix(9.0, &[]) };
    assert_eq!(s.judge(at(0), &failing), Some(9.0));
    assert!(s.judge(at(60), &fix(1.0, &[])).is_some());
    assert_eq!(s.judge(at(61), &fix(1.0, &[])), None);
    // Without redundancy nothing failed: nothing was tested.
    let untested = Fix { redundancy: 0, ..failing };
    assert_eq!(Surroundings::default().judge(at(0), &untested), None);
}

#[test]
fn residuals_smaller_than_the_weights_never_narrow_the_covariance() {
    let mut s = Surroundings::default();
    assert_eq!(s.judge(at(0), &fix(0.1, &[gps(1), gps(2)])), Some(1.0));
}

#[test]
fn a_clock_set_back_begins_anew() {
    let mut s = Surroundings::default();
    assert!(s.judge(at(100), &fix(50.0, &[gps(1), gps(2)])).is_some());
    assert_eq!(s.judge(at(10), &fix(1.0, &[])), None);
}
