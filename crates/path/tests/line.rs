//! A line's foot is where geodesy says it is.

#![allow(clippy::unwrap_used)] // A test may stop at the first surprise, its helpers too.

use geographiclib_rs::{DirectGeodesic, Geodesic, InverseGeodesic};
use navbound_core::frame::LatLon;
use navbound_core::quantity::{Metres, Radians};
use navbound_path::Line;
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

fn beside(place: &navbound_path::Place, right_m: f64) -> LatLon {
    let azimuth = place.course.rad().to_degrees() + 90.0;
    let (lat, lon): (f64, f64) =
        Geodesic::wgs84().direct(place.point.lat().rad().to_degrees(), place.point.lon().rad().to_degrees(), azimuth, right_m);
    at(lat, lon)
}

#[test]
fn east_of_a_northbound_line_is_right() {
    let line = Line::through(at(40.0, 10.0), at(41.0, 10.0)).unwrap();
    let foot = line.project(&at(40.5, 10.01)).unwrap();
    assert!(foot.cross.m() > 0.0);
    let back = Line::through(at(41.0, 10.0), at(40.0, 10.0)).unwrap();
    let other = back.project(&at(40.5, 10.01)).unwrap();
    assert!((other.cross.m() + foot.cross.m()).abs() < 1e-6);
    assert!((other.along.m() + foot.along.m() - line.length().m()).abs() < 1e-6);
}

#[test]
fn the_foot_is_the_nearest_point_of_the_line() {
    // A search that knows no geodesy: golden section on the distance. Its minimum is flat, so the foot is good to about
    // sqrt(1e-16) of the distance and only the distance itself is compared sharply.
    let line = Line::through(at(49.0, 2.5), at(49.1, 3.9)).unwrap();
    for (lat, lon) in [(49.2, 2.6), (48.5, 3.3), (50.6, 3.0), (47.5, 1.0)] {
        let p = at(lat, lon);
        let to = |s: f64| distance_m(&line.at(Metres::new(s)).unwrap().point, &p);
        let (mut a, mut b) = (-4.0e5, 4.0e5);
        let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
        while b - a > 1e-3 {
            let (c, d) = (b - golden * (b - a), a + golden * (b - a));
            if to(c) < to(d) { b = d } else { a = c }
        }
        let foot = line.project(&p).unwrap();
        assert!((foot.along.m() - 0.5 * (a + b)).abs() < 0.05, "along {} against {}", foot.along.m(), 0.5 * (a + b));
        assert!((foot.cross.m().abs() - to(0.5 * (a + b))).abs() < 1e-6);
    }
}

#[test]
fn what_gives_no_direction_is_refused() {
    assert!(Line::through(at(40.0, 10.0), at(40.0, 10.0)).is_err());
    assert!(Line::from_azimuth(at(40.0, 10.0), Radians::new(f64::NAN)).is_err());
    let line = Line::through(at(40.0, 10.0), at(41.0, 10.0)).unwrap();
    assert!(line.at(Metres::new(f64::NAN)).is_err());
    assert!(line.project(&at(-40.0, -170.0)).is_err());
}

proptest! {
    // Constructed by the direct problem, found by the inverse one. Degrees resolve some 3 nm, a dozen conversions 0.1 um; along the line
    // the same angle error acts over a distance of up to 300 km, an order more.
    #[test]
    fn a_position_built_beside_the_line_projects_onto_itself(
        lat in -70.0..70.0f64, lon in -180.0..180.0f64, course in 0.0..360.0f64, along in -1.0e6..1.0e6f64, cross in -3.0e5..3.0e5f64,
    ) {
        let line = Line::from_azimuth(at(lat, lon), Radians::degrees(course)).unwrap();
        let place = line.at(Metres::new(along)).unwrap();
        let foot = line.project(&beside(&place, cross)).unwrap();
        prop_assert!((foot.along.m() - along).abs() < 1e-5, "along {} for {along}", foot.along.m());
        prop_assert!((foot.cross.m() - cross).abs() < 1e-7, "cross {} for {cross}", foot.cross.m());
        prop_assert!(distance_m(&foot.point, &place.point) < 1e-5);
    }

    #[test]
    fn a_line_passes_through_both_its_points(lat in -60.0..60.0f64, dlat in 0.01..1.0f64, dlon in -1.0..1.0f64) {
        let (a, b) = (at(lat, 20.0), at(lat + dlat, 20.0 + dlon));
        let line = Line::through(a, b).unwrap();
        for (point, along) in [(a, 0.0), (b, line.length().m())] {
            let foot = line.project(&point).unwrap();
            prop_assert!(foot.cross.m().abs() < 1e-7);
            prop_assert!((foot.along.m() - along).abs() < 1e-7);
        }
    }
}
