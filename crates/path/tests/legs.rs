//! Legs of a procedure lie where their definitions say, and a flight along them is on the right one.

#![allow(clippy::unwrap_used)] // A test may stop at the first surprise, in its helpers too.

use geographiclib_rs::{DirectGeodesic, Geodesic, InverseGeodesic};
use navbound_core::frame::LatLon;
use navbound_core::quantity::{Metres, Radians};
use navbound_path::legs::{Definition, End, Follow, Limits, ProcedurePath, State, Tracked};
use proptest::prelude::*;

fn at(lat_deg: f64, lon_deg: f64) -> LatLon {
    LatLon::new(Radians::degrees(lat_deg), Radians::degrees(lon_deg)).unwrap()
}

fn from(place: &LatLon, azimuth_deg: f64, distance_m: f64) -> LatLon {
    let (lat, lon): (f64, f64) =
        Geodesic::wgs84().direct(place.lat().rad().to_degrees(), place.lon().rad().to_degrees(), azimuth_deg, distance_m);
    at(lat, lon)
}

fn distance_m(a: &LatLon, b: &LatLon) -> f64 {
    Geodesic::wgs84().inverse(
        a.lat().rad().to_degrees(),
        a.lon().rad().to_degrees(),
        b.lat().rad().to_degrees(),
        b.lon().rad().to_degrees(),
    )
}

fn course_deg(degrees: f64) -> Radians {
    Radians::degrees(degrees)
}

fn path(definitions: &[Definition]) -> ProcedurePath {
    ProcedurePath::new(definitions).unwrap()
}

proptest! {
    #[test]
    fn an_arc_passes_through_both_fixes_and_turns_its_own_way(
        lat in -75.0_f64..75.0, lon in -180.0_f64..180.0, radius in 2000.0_f64..12_000.0,
        first in 0.0_f64..360.0, turned in 5.0_f64..350.0, right: bool, error_m in 0.0_f64..40.0, towards in 0.0_f64..360.0,
    ) {
        let centre = at(lat, lon);
        let sense = if right { 1.0 } else { -1.0 };
        let (start, end) = (from(&centre, first, radius), from(&centre, first + sense * turned, radius));
        let published = from(&centre, towards, error_m);
        let built = path(&[Definition::Point(start), Definition::Circle { to: end, centre: published, right }]);
        let leg = &built.legs()[1];
        prop_assert_eq!(leg.state, State::Full);
        let (begin, finish) = (leg.at(Metres::new(0.0)).unwrap(), leg.at(leg.length).unwrap());
        prop_assert!(distance_m(&begin.point, &start) < 1e-6);
        // The mean radius of the sphere makes the length, and with it the place of the end, good to a millimetre.
        prop_assert!(distance_m(&finish.point, &end) < 2e-3);
        prop_assert_eq!(leg.turn().rad() > 0.0, right);
        // The published centre may be moved by no more than its own error: the true one is equally far from both.
        prop_assert!(leg.residuals.unwrap().centre_moved.m() <= error_m + 1e-3);
    }

    #[test]
    fn a_position_beside_an_arc_is_that_far_beside_it(along in 0.0_f64..1.0, right_m in -900.0_f64..900.0, right: bool) {
        let centre = at(39.5, -106.9);
        let (start, end) = (from(&centre, 10.0, 5000.0), from(&centre, if right { 190.0 } else { 200.0 }, 5000.0));
        let built = path(&[Definition::Point(start), Definition::Circle { to: end, centre, right }]);
        let leg = &built.legs()[1];
        let place = leg.at(Metres::new(along * leg.length.m())).unwrap();
        let beside = from(&place.point, place.course.rad().to_degrees() + 90.0, right_m);
        let foot = leg.project(&beside).unwrap();
        prop_assert!((foot.foot.cross.m() - right_m).abs() < 1e-4);
        prop_assert!((foot.foot.along.m() - along * leg.length.m()).abs() < 1e-3);
    }
}

#[test]
fn a_course_leg_arrives_with_its_course_from_the_foot_of_the_leg_before() {
    let (fix, aside) = (at(47.0, 8.0), from(&from(&at(47.0, 8.0), 250.0, 20_000.0), 160.0, 3000.0));
    let built = path(&[Definition::Point(aside), Definition::CourseTo(fix, course_deg(70.0), None)]);
    let leg = &built.legs()[1];
    assert_eq!(leg.state, State::InferredStart);
    assert!(distance_m(&leg.at(leg.length).unwrap().point, &fix) < 1e-6);
    assert!((leg.at(leg.length).unwrap().course.rad() - 70.0_f64.to_radians()).abs() < 1e-9);
    // 3 km aside of a line 20 km long: the foot is nearly 20 km before the fix.
    assert!((leg.length.m() - 20_000.0).abs() < 20.0);
}

#[test]
fn a_course_leg_behind_an_open_end_is_as_long_as_coded_or_has_no_path() {
    let runway = at(47.0, 8.0);
    let climb = Definition::Course { from: None, course: course_deg(90.0), end: End::Open };
    let to = from(&runway, 80.0, 30_000.0);
    let built = path(&[
        Definition::Point(runway),
        climb,
        Definition::CourseTo(to, course_deg(100.0), Some(Metres::new(9260.0))),
        Definition::Track(runway),
    ]);
    let states: Vec<_> = built.legs().iter().map(|l| l.state).collect();
    assert_eq!(states, [State::Point, State::OpenEnd, State::InferredStart, State::Full]);
    assert!((built.legs()[2].length.m() - 9260.0).abs() < 1e-6);
    assert!(built.legs()[2].begin.m().is_nan());
    let without = path(&[Definition::Point(runway), climb, Definition::CourseTo(to, course_deg(100.0), None), Definition::Direct(runway)]);
    assert_eq!(without.legs()[2].state, State::NoStart);
}

#[test]
fn a_leg_to_a_distance_from_a_dme_ends_there_and_one_to_a_radial_on_it() {
    let (start, dme) = (at(47.0, 8.0), from(&at(47.0, 8.0), 45.0, 12_000.0));
    let end = End::AtDistance(dme, Metres::new(15_000.0));
    let built =
        path(&[Definition::Point(start), Definition::Course { from: None, course: course_deg(200.0), end }, Definition::Direct(dme)]);
    let leg = &built.legs()[1];
    let finish = leg.at(leg.length).unwrap().point;
    assert_eq!((leg.state, built.legs()[2].state), (State::Full, State::Full));
    assert!((distance_m(&finish, &dme) - 15_000.0).abs() < 1e-3);
    let radial = End::OnRadial(dme, course_deg(270.0));
    let built = path(&[Definition::Point(start), Definition::Course { from: None, course: course_deg(350.0), end: radial }]);
    let finish = built.legs()[1].at(built.legs()[1].length).unwrap().point;
    let (_, azimuth, _, _): (f64, f64, f64, f64) = Geodesic::wgs84().inverse(
        dme.lat().rad().to_degrees(),
        dme.lon().rad().to_degrees(),
        finish.lat().rad().to_degrees(),
        finish.lon().rad().to_degrees(),
    );
    assert!((azimuth.rem_euclid(360.0) - 270.0).abs() < 1e-6);
}

#[test]
fn an_arc_about_a_navaid_begins_on_its_boundary_radial() {
    let navaid = at(60.0, -161.0);
    let to = from(&navaid, 20.0, 22_224.0);
    let definition = Definition::DmeArc { to, navaid, radius: Metres::new(22_224.0), begin: course_deg(290.0), right: true };
    let built = path(&[definition]);
    let leg = &built.legs()[0];
    assert!(distance_m(&leg.at(Metres::new(0.0)).unwrap().point, &from(&navaid, 290.0, 22_224.0)) < 1e-6);
    assert!((leg.turn().rad() - 90.0_f64.to_radians()).abs() < 1e-9);
    let wrong_way = Definition::DmeArc { to, navaid, radius: Metres::new(22_224.0), begin: course_deg(20.5), right: true };
    assert_eq!(path(&[wrong_way]).legs()[0].state, State::Impossible);
}

#[test]
fn a_hold_is_its_inbound_leg() {
    let fix = at(39.5, -104.0);
    let built = path(&[Definition::Hold { fix, course: course_deg(314.0), length: Some(Metres::new(12_964.0)) }]);
    let leg = &built.legs()[0];
    assert_eq!(leg.state, State::Holding);
    let arrive = leg.at(leg.length).unwrap();
    assert!(distance_m(&arrive.point, &fix) < 1e-6);
    assert!((arrive.course.rad().to_degrees() - 314.0).abs() < 1e-6);
}

#[test]
fn a_centre_between_its_fixes_on_one_line_makes_no_circle() {
    let start = at(39.5, -104.0);
    let (end, centre) = (from(&start, 90.0, 4000.0), from(&start, 90.0, -3000.0));
    let built = path(&[Definition::Point(start), Definition::Circle { to: end, centre, right: true }]);
    assert_eq!(built.legs()[1].state, State::Impossible);
}

/// Two parallel straight legs 4 km apart, joined by half a circle.
fn hairpin() -> ProcedurePath {
    let a = at(39.5, -104.0);
    let (b, turned) = (from(&a, 90.0, 20_000.0), from(&from(&a, 90.0, 20_000.0), 180.0, 4000.0));
    let centre = from(&b, 180.0, 2000.0);
    path(&[
        Definition::Point(a),
        Definition::Track(b),
        Definition::Circle { to: turned, centre, right: true },
        Definition::Track(from(&turned, 270.0, 20_000.0)),
    ])
}

#[test]
fn a_flight_stays_on_its_leg_where_the_path_comes_back_beside_it() {
    let path = hairpin();
    let (mut time, mut lat, mut lon, mut expected) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for leg in path.legs().iter().filter(|l| l.has_path()) {
        for k in 0..((leg.length.m() / 80.0) as usize) {
            // 1.5 km beside towards the other leg on the first: 2.5 km from that one, and within RNP 1.
            let place = leg.at(Metres::new(80.0 * k as f64)).unwrap();
            let aside = if leg.index == 1 && k > 100 { 1500.0 } else { 0.0 };
            let point = from(&place.point, place.course.rad().to_degrees() + 90.0, aside);
            time.push(time.len() as f64);
            lat.push(point.lat().rad());
            lon.push(point.lon().rad());
            expected.push(leg.index);
        }
    }
    let (rnp, over) = ([f64::NAN, 1852.0, 1852.0, 555.6], [true; 4]);
    let followed = Follow::new(&path, &rnp, &over, Limits::default()).unwrap().all(&time, &lat, &lon).unwrap();
    assert!(followed.iter().all(|f| f.status == Tracked::Ok));
    let wrong = followed.iter().zip(&expected).filter(|(f, leg)| f.foot.unwrap().foot.leg != **leg).count();
    // Beside the first leg the joint is met some steps early or late.
    assert!(wrong <= 25, "{wrong}");
}

#[test]
fn an_aircraft_that_crosses_the_path_is_never_established() {
    let path = hairpin();
    let middle = path.legs()[1].at(Metres::new(10_000.0)).unwrap().point;
    let (mut time, mut lat, mut lon) = (Vec::new(), Vec::new(), Vec::new());
    for k in 0..100 {
        let point = from(&middle, 0.0, 80.0 * (f64::from(k) - 50.0));
        time.push(f64::from(k));
        lat.push(point.lat().rad());
        lon.push(point.lon().rad());
    }
    let (rnp, over) = ([f64::NAN, 1852.0, 1852.0, 555.6], [true; 4]);
    let followed = Follow::new(&path, &rnp, &over, Limits::default()).unwrap().all(&time, &lat, &lon).unwrap();
    assert!(followed.iter().all(|f| matches!(f.status, Tracked::NotEstablished | Tracked::OffPath)));
}

#[test]
fn times_that_do_not_rise_are_refused() {
    let path = hairpin();
    let (rnp, over) = ([1852.0; 4], [true; 4]);
    let place = path.legs()[1].at(Metres::new(100.0)).unwrap().point;
    let (lat, lon) = ([place.lat().rad(); 2], [place.lon().rad(); 2]);
    let follow = || Follow::new(&path, &rnp, &over, Limits::default()).unwrap();
    assert_eq!(follow().all(&[1.0, 1.0], &lat, &lon).unwrap_err().index, 1);
    assert!(Follow::new(&path, &rnp[..3], &over, Limits::default()).is_err());
}
