//! A route is smooth where it turns, and knows where on it a position belongs.

#![allow(clippy::unwrap_used)] // A test may stop at the first surprise, its helpers too.

use geographiclib_rs::{DirectGeodesic, Geodesic, InverseGeodesic};
use navbound_core::frame::LatLon;
use navbound_core::quantity::{Metres, Radians};
use navbound_path::{Place, Route};
use proptest::prelude::*;

fn at(lat_deg: f64, lon_deg: f64) -> LatLon {
    LatLon::new(Radians::degrees(lat_deg), Radians::degrees(lon_deg)).unwrap()
}

fn distance_m(a: &LatLon, b: &LatLon) -> f64 {
    Geodesic::wgs84().inverse(
        a.lat().rad().to_degrees(),
        a.lon().rad().to_degrees(),
        b.lat().rad().to_degrees(),
        b.lon().rad().to_degrees(),
    )
}

fn beside(place: &Place, right_m: f64) -> LatLon {
    let azimuth = place.course.rad().to_degrees() + 90.0;
    let (lat, lon): (f64, f64) =
        Geodesic::wgs84().direct(place.point.lat().rad().to_degrees(), place.point.lon().rad().to_degrees(), azimuth, right_m);
    at(lat, lon)
}

fn wrap(a: f64) -> f64 {
    (a + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI
}

/// A right turn, a left turn and a sharp right turn.
fn zigzag(radius: f64) -> Route {
    let points = [at(40.0, 116.0), at(39.0, 116.2), at(38.4, 115.2), at(37.5, 115.5), at(37.6, 114.4)];
    Route::new(&points, &[Metres::new(radius); 5]).unwrap()
}

#[test]
fn position_and_course_are_continuous_through_every_turn() {
    let route = zigzag(8_500.0);
    // 1 m steps turn the course by 1/8500 rad at most; twice that would be a jump.
    let n = route.length().m() as usize;
    let mut before = route.at(Metres::new(0.0)).unwrap();
    for s in 1..=n {
        let here = route.at(Metres::new(s as f64)).unwrap();
        let step = distance_m(&before.point, &here.point);
        assert!((step - 1.0).abs() < 1e-5, "a step of {step} m at {s} m");
        assert!(wrap(here.course.rad() - before.course.rad()).abs() < 1.5 / 8_500.0, "course jumps at {s} m");
        assert!(here.leg == before.leg || here.leg == before.leg + 1);
        before = here;
    }
    assert_eq!(before.leg, 3);
}

#[test]
fn a_turn_shortens_the_route_by_twice_the_anticipation_less_the_arc() {
    let points = [at(40.0, 116.0), at(39.5, 116.0), at(39.2, 116.6)];
    let corner = Route::new(&points, &[Metres::new(0.0); 3]).unwrap();
    let turn = Route::new(&points, &[Metres::new(8_500.0); 3]).unwrap();
    let change = Route::track_changes(&points).unwrap()[0].rad();
    let plane = 8_500.0 * (2.0 * (0.5 * change.abs()).tan() - change.abs());
    // The ellipsoid changes lengths by (R/a)^2/6 = 3e-7 of the turn, some millimetres.
    assert!((corner.length().m() - turn.length().m() - plane).abs() < 0.02);
}

#[test]
fn curvature_is_positive_to_the_right() {
    let route = zigzag(8_500.0);
    let middle = |i: usize| route.at(route.waypoints_along()[i]).unwrap().curvature_per_m * 8_500.0;
    assert!((middle(1) - 1.0).abs() < 1e-12);
    assert!((middle(2) + 1.0).abs() < 1e-12);
    assert!((middle(3) - 1.0).abs() < 1e-12);
}

#[test]
fn turns_that_do_not_fit_are_refused_with_their_waypoint() {
    let points = [at(40.0, 116.0), at(39.9, 116.0), at(39.9, 116.1), at(40.0, 116.1)];
    let e = Route::new(&points, &[Metres::new(8_000.0); 4]).unwrap_err();
    assert_eq!((e.index, e.error.argument), (2, "radius_m"));
    assert!(Route::new(&points, &[Metres::new(3_000.0); 4]).is_ok());
    assert_eq!(Route::new(&points, &[Metres::new(-1.0); 4]).unwrap_err().index, 1);
    assert_eq!(Route::new(&points[..1], &[Metres::new(0.0)]).unwrap_err().error.argument, "waypoints");
    assert_eq!(Route::new(&[points[0], points[0]], &[Metres::new(0.0); 2]).unwrap_err().index, 1);
}

#[test]
fn outside_a_corner_the_foot_stays_at_the_waypoint() {
    let points = [at(0.0, 0.0), at(0.0, 1.0), at(1.0, 1.0)];
    let route = Route::new(&points, &[Metres::new(0.0); 3]).unwrap();
    let corner = route.waypoints_along()[1];
    // South-east of a left turn from east to north: beyond the first leg and before the second.
    for near in [corner.m() - 5.0e3, corner.m() + 5.0e3] {
        let foot = route.project(&at(-0.01, 1.02), Some(Metres::new(near))).unwrap();
        assert!((foot.along.m() - corner.m()).abs() < 1e-6);
        assert!(foot.cross.m() > 0.0);
    }
}

#[test]
fn after_a_long_gap_the_route_is_matched_again() {
    // The last turn is sharper than a right angle: from the leg before it a position late on the last leg has a foot, 30 km away.
    let route = zigzag(8_500.0);
    let along = 0.8356 * route.length().m();
    let position = beside(&route.at(Metres::new(along)).unwrap(), 1_800.0);
    let foot = route.project(&position, Some(Metres::new(along - 37_000.0))).unwrap();
    assert!((foot.along.m() - along).abs() < 1e-4, "{}", foot.along.m() - along);
}

proptest! {
    // Without a hint, with a hint 5 km off (twenty seconds of flight), in turns and on legs. Beside an arc the distance comes from its centre, which is placed to
    // a few micrometres; 2 km inside a turn an error across is an along error 8.5/6.5 times as large.
    #[test]
    fn a_position_built_beside_the_route_projects_onto_itself(share in 0.001..0.999f64, cross in -2.0e3..2.0e3f64, off in -5.0e3..5.0e3f64) {
        let route = zigzag(8_500.0);
        let along = share * route.length().m();
        let position = beside(&route.at(Metres::new(along)).unwrap(), cross);
        for near in [None, Some(Metres::new(along + off))] {
            let foot = route.project(&position, near).unwrap();
            prop_assert!((foot.along.m() - along).abs() < 1e-4, "along {} for {along}", foot.along.m());
            prop_assert!((foot.cross.m() - cross).abs() < 1e-5, "cross {} for {cross}", foot.cross.m());
        }
    }
}
