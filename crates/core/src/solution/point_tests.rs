use super::*;
use crate::frame::{Geodetic, LatLon, ecef_from_geodetic};
use crate::geometry::atmosphere::saastamoinen;
use crate::geometry::ionosphere::Ionosphere;
use crate::geometry::{GPS, Observer, Orbit};
use crate::quantity::Radians;
use crate::solution::range_error::RangeError;
use nalgebra::Vector4;

const EARTH_RATE: f64 = 7.292_115_146_7e-5;
const CLOCK: f64 = 123_456.789;

fn here() -> Geodetic {
    Geodetic { point: LatLon::new(Radians::degrees(55.0), Radians::degrees(8.0)).unwrap(), height: Metres::new(120.0) }
}

fn settings() -> Settings {
    Settings {
        mask: Radians::degrees(10.0),
        ionosphere: Ionosphere::Uncorrected,
        errors: RangeError::CALIBRATED,
        false_alarm: 1e-4,
        most_excluded: 3,
    }
}

/// Exact ranges to the nominal constellation at an instant: geometry in axes that do not turn, air, clock.
fn sky(hours: f64) -> Vec<Range> {
    let receiver = *ecef_from_geodetic(&here()).vector();
    let seen = GPS.iter().filter_map(|slot| {
        let position = Orbit::new(slot.elements).unwrap().position(3600.0 * hours);
        // At reception the receiver has turned on with the Earth for as long as the signal was on its way.
        let mut way = 0.07 * SPEED_OF_LIGHT_MPS;
        for _ in 0..6 {
            let (s, c) = (EARTH_RATE * way / SPEED_OF_LIGHT_MPS).sin_cos();
            let turned = Vector3::new(c * receiver.x - s * receiver.y, s * receiver.x + c * receiver.y, receiver.z);
            way = (position.vector() - turned).norm();
        }
        let seen = EcefPosition::from_vector(in_axes_of_reception(position.vector(), way / SPEED_OF_LIGHT_MPS));
        let towards = Observer::new(&here()).direction(&seen).unwrap();
        let above = towards.elevation().rad() > 0.18;
        let air = if above { saastamoinen(&here(), &towards).m() } else { 0.0 };
        let line = ecef_from_geodetic(&here()).vector() - position.vector();
        above.then(|| Range {
            satellite: slot.satellite,
            corrected: Metres::new(way + air + CLOCK),
            position,
            velocity_mps: Vector3::new(1000.0, -2000.0, 500.0),
            // A receiver at rest whose clock gains 3 m/s.
            rate_mps: -(line / line.norm()).dot(&Vector3::new(1000.0, -2000.0, 500.0)) + 3.0,
            cn0_dbhz: f64::NAN,
            ionosphere_factor: 1.0,
            noise_factor: 1.0,
            ure_factor: 1.0,
        })
    });
    seen.collect()
}

/// The hour of the day with most satellites, eight or more.
fn full_sky() -> Vec<Range> {
    let best = (0..24).map(|h| sky(f64::from(h))).max_by_key(Vec::len).unwrap();
    assert!(best.len() >= 8, "{}", best.len());
    best
}

fn error(fix: &Fix) -> Vector3<f64> {
    *ecef_from_geodetic(&fix.position).minus(&ecef_from_geodetic(&here())).to_enu(&here().point).vector()
}

fn at(ranges: &[Range]) -> Fix {
    solve(ranges, GpsTime::default(), &settings()).unwrap()
}

#[test]
fn exact_ranges_give_the_exact_position_and_clock() {
    for ranges in [sky(0.0), sky(12.0), full_sky()] {
        let fix = at(&ranges);
        // Delays are those of a place up to 50 m away: 15 mm.
        assert!(error(&fix).norm() < 0.015, "{:?}", error(&fix));
        assert!((fix.clock_m[0] - CLOCK).abs() < 0.015 && fix.clock_m[2].is_nan());
        assert!(fix.consistent && fix.n_excluded == 0 && fix.residual_risk > 0.999);
        // Velocity: the turn of the axes during the signal's way is left out of this sky, 5e-6 of 2.3 km/s.
        assert!(fix.velocity.unwrap().0.norm() < 0.03, "{:?}", fix.velocity);
    }
}

#[test]
fn a_range_that_is_wrong_is_identified_and_left_out() {
    let clean = full_sky();
    for (k, fault) in [(0, 1000.0), (1, -60.0), (3, 2e5)] {
        let mut ranges = clean.clone();
        ranges[k].corrected = Metres::new(ranges[k].corrected.m() + fault);
        let fix = at(&ranges);
        assert_eq!((fix.n_excluded, fix.n_used, fix.consistent), (1, clean.len() - 1, true), "{k} {fault}");
        // 15 mm of delay (see above) times a dilution below four.
        assert!(error(&fix).norm() < 0.06, "{k} {fault}: {:?}", error(&fix));
    }
}

#[test]
fn a_fault_that_cannot_be_identified_is_reported_and_widens_the_covariance() {
    // Five satellites: one redundant, which sees a fault and cannot say where.
    let mut ranges: Vec<Range> = full_sky().into_iter().take(5).collect();
    let before = at(&ranges);
    ranges[2].corrected = Metres::new(ranges[2].corrected.m() + 500.0);
    let fix = at(&ranges);
    assert!(!fix.consistent && fix.n_excluded == 0 && fix.redundancy == 1);
    assert!(fix.covariance.matrix().trace() > 100.0 * before.covariance.matrix().trace());
}

#[test]
fn four_satellites_give_a_position_that_cannot_be_tested_and_three_none() {
    let ranges = full_sky();
    let fix = at(&ranges[..4]);
    assert!(!fix.consistent && fix.redundancy == 0 && fix.residual_risk.is_nan());
    let three = solve(&ranges[..3], GpsTime::default(), &settings());
    assert_eq!(three, Err(Unavailable::TooFewSatellites { need: 4, have: 3 }));
    assert!(solve(&[], GpsTime::default(), &settings()).is_err());
    assert!(solve(&[ranges[0]; MOST_RANGES + 1], GpsTime::default(), &settings()).is_err());
    assert!(solve(&[ranges[0]; 6], GpsTime::default(), &settings()).is_err());
}

#[test]
fn ranges_that_are_no_numbers_give_no_position() {
    let mut ranges = full_sky();
    ranges[1].corrected = Metres::new(f64::NAN);
    assert!(solve(&ranges, GpsTime::default(), &settings()).is_err());
}

/// Errors drawn as the model says, those of single ranges and those that all have in common: the mean normalised squared error of 400
/// positions is 3 within four of its standard deviations, sqrt(6 / 400) = 0.12 each, and the residual test raises as many alarms at a
/// risk of 0.1 as that says, within four deviations of a binomial law.
#[test]
fn the_covariance_is_that_of_the_errors_it_assumes() {
    let clean = full_sky();
    let mut state = 20_201_777_u64;
    let mut uniform = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    // Twelve uniform numbers less six: a normal law to the third moment, all that a mean square needs.
    let mut normal = || (0..12).map(|_| uniform()).sum::<f64>() - 6.0;
    let here = here();
    let settings = Settings { most_excluded: 0, ..settings() };
    let place = Place::new(&here, GpsTime::default(), &settings);
    let model = |r: &Range| {
        let unit = enu_from_ecef(&here.point) * way(&r.position, ecef_from_geodetic(&here).vector()).1;
        settings.model(r, &unit, &place)
    };
    let modelled: Vec<Modelled> = clean.iter().map(model).collect();
    let (mut sum, mut alarms) = (0.0, 0);
    for _ in 0..400 {
        let mut ranges = clean.clone();
        let common = Vector4::from_fn(|_, _| normal());
        for (range, modelled) in ranges.iter_mut().zip(&modelled).filter(|(_, m)| m.weight > 0.0) {
            let error = normal() / modelled.weight.sqrt() + modelled.common.dot(&common);
            range.corrected = Metres::new(range.corrected.m() + error);
        }
        let fix = solve(&ranges, GpsTime::default(), &settings).unwrap();
        let e = error(&fix);
        sum += e.dot(&(fix.covariance.matrix().try_inverse().unwrap() * e));
        alarms += usize::from(fix.residual_risk < 0.1);
    }
    assert!((sum / 400.0 - 3.0).abs() < 0.49, "{}", sum / 400.0);
    assert!((16..=64).contains(&alarms), "{alarms}");
}

#[path = "point_readings_tests.rs"]
mod readings_tests;
