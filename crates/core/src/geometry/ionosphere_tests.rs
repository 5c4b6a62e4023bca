use super::*;
use crate::frame::LatLon;
use crate::quantity::{Metres, Radians};
use crate::signal::SPEED_OF_LIGHT_MPS;

fn here() -> Geodetic {
    Geodetic { point: LatLon::new(Radians::degrees(45.0), Radians::degrees(7.0)).unwrap(), height: Metres::new(0.0) }
}

/// 2 pm local time on a day of spring.
fn afternoon() -> GpsTime {
    GpsTime::from_nanoseconds(15_075 * 86_400_000_000_000).plus_seconds(13.5 * 3600.0)
}

const MESSAGE: Klobuchar = Klobuchar { alpha: [1e-8, 0.0, 0.0, 0.0], beta: [9e4, 0.0, 0.0, 0.0] };

#[test]
fn the_activity_is_the_largest_amplitude_of_the_message() {
    let Some(Ionosphere::Broadcast { activity_m, .. }) = Ionosphere::broadcast(MESSAGE) else { panic!() };
    assert!((activity_m - 2.997_924_58).abs() < 1e-12);
    // A parabola whose top is inside: 1e-8 + 4e-8 x - 2e-7 x^2 has 1.2e-8 at 0.1.
    let bent = Klobuchar { alpha: [1e-8, 4e-8, -2e-7, 0.0], ..MESSAGE };
    let Some(Ionosphere::Broadcast { activity_m, .. }) = Ionosphere::broadcast(bent) else { panic!() };
    assert!((activity_m - 1.2e-8 * SPEED_OF_LIGHT_MPS).abs() < 1e-12);
}

#[test]
fn messages_without_content_are_no_model() {
    assert_eq!(Ionosphere::broadcast(Klobuchar { alpha: [0.0; 4], ..MESSAGE }), None);
    assert_eq!(Ionosphere::broadcast(Klobuchar { alpha: [f64::NAN; 4], ..MESSAGE }), None);
    assert_eq!(Ionosphere::galileo([0.0; 3]), None);
}

#[test]
fn messages_that_no_satellite_sends_are_no_model() {
    for alpha in [[1e-12; 4], [1e3, 0.0, 0.0, 0.0], [1.2e-7, 0.0, 0.0, 0.0], [-1e-8, 0.0, 0.0, 0.0], [1.6e-9, 0.0, 0.0, 0.0]] {
        assert_eq!(Ionosphere::broadcast(Klobuchar { alpha, ..MESSAGE }), None, "{alpha:?}");
    }
    for beta in [[1e12, 0.0, 0.0, 0.0], [f64::NAN, 0.0, 0.0, 0.0], [9e4, f64::INFINITY, 0.0, 0.0]] {
        assert_eq!(Ionosphere::broadcast(Klobuchar { beta, ..MESSAGE }), None, "{beta:?}");
    }
    // The least and the largest that were seen: 1.6 m of a quiet sun, 7.7 m of an active one.
    for alpha_s in [5.4e-9, 2.57e-8] {
        assert!(Ionosphere::broadcast(Klobuchar { alpha: [alpha_s, 0.0, 0.0, 0.0], ..MESSAGE }).is_some());
    }
}

#[test]
fn overhead_the_message_is_its_cosine_and_its_night() {
    let over = Ionosphere::broadcast(MESSAGE).unwrap().over(&here(), afternoon());
    // 5 ns and nearly the whole amplitude, near its maximum at 14 h; the slant factor overhead is 1.0004.
    assert!((over.vertical_m - 15e-9 * SPEED_OF_LIGHT_MPS).abs() < 0.01, "{}", over.vertical_m);
    assert_eq!(over.delay(&Vector3::z()), over.vertical_m);
    assert!(over.delay(&Vector3::new(0.0, 0.9, 0.19f64.sqrt())) > 1.5 * over.vertical_m);
}

#[test]
fn what_is_not_corrected_still_has_its_size() {
    let (climate, nothing) = (Ionosphere::Climatology.over(&here(), afternoon()), Ionosphere::Uncorrected.over(&here(), afternoon()));
    assert_eq!(nothing.delay(&Vector3::z()), 0.0);
    assert_eq!(nothing.vertical_m, climate.vertical_m);
    assert!((climate.delay(&Vector3::z()) - climate.vertical_m).abs() < 1e-12);
    let modelled = Ionosphere::galileo([MEAN_ACTIVITY_SFU, 0.0, 0.0]).unwrap().over(&here(), afternoon());
    assert!((modelled.vertical_m - climate.vertical_m).abs() < 1e-12);
    assert!(!Ionosphere::Climatology.is_described() && Ionosphere::broadcast(MESSAGE).unwrap().is_described());
}
