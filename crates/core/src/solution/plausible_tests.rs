use super::*;
use crate::frame::LatLon;
use crate::quantity::{Metres, Radians};

fn at(seconds: i64) -> GpsTime {
    GpsTime::from_nanoseconds(seconds * 1_000_000_000)
}

/// A place this far north of a point \[m\].
fn north(metres: f64) -> Geodetic {
    let point = LatLon::new(Radians::new(0.4 + metres / 6_350_000.0), Radians::new(2.0)).unwrap();
    Geodetic { point, height: Metres::new(10.0) }
}

fn one() -> Matrix3<f64> {
    Matrix3::identity()
}

#[test]
fn only_heights_from_the_dead_sea_to_the_edge_of_space_are_positions() {
    let place = |h: f64| Geodetic { height: Metres::new(h), ..north(0.0) };
    for good in [-1000.0, -430.0, 0.0, 100_000.0] {
        assert!(height(&place(good)).is_ok(), "{good}");
    }
    for bad in [-1000.1, 100_001.0, 9.87e6, f64::NAN, f64::INFINITY] {
        assert!(height(&place(bad)).is_err(), "{bad}");
    }
}

#[test]
fn a_dilution_above_thirty_or_none_at_all_is_refused() {
    let of = |position: f64| Dilution { east: 1.0, north: 1.0, horizontal: 1.0, vertical: 1.0, position };
    assert!(dilution(&of(30.0)).is_ok());
    for bad in [30.1, f64::NAN, f64::INFINITY] {
        assert!(dilution(&of(bad)).is_err(), "{bad}");
    }
}

#[test]
fn a_jump_is_refused_once_and_a_second_position_there_is_believed() {
    let mut movement = Movement::default();
    assert!(movement.possible(at(0), &north(0.0), None, &one()));
    assert!(!movement.possible(at(1), &north(50_000.0), None, &one()));
    // Back where it was: the jump was wrong.
    assert!(movement.possible(at(2), &north(1.0), None, &one()));
    assert!(!movement.possible(at(3), &north(50_000.0), None, &one()));
    assert!(movement.possible(at(4), &north(50_001.0), None, &one()));
}

#[test]
fn what_a_receiver_can_have_moved_is_no_jump() {
    let mut movement = Movement::default();
    assert!(movement.possible(at(0), &north(0.0), None, &one()));
    assert!(movement.possible(at(1), &north(500.0), None, &one()));
    // Deviations of both: 5 (1000 + sqrt 3) m besides.
    assert!(movement.possible(at(2), &north(5900.0), None, &(one() * (1e6 / 3.0))));
    // An hour reaches anywhere within 2160 km.
    assert!(movement.possible(at(3602), &north(2_000_000.0), None, &one()));
    // A clock that was set back begins anew.
    assert!(movement.possible(at(0), &north(-3_000_000.0), None, &one()));
}

#[test]
fn doppler_supports_a_faster_receiver_and_not_a_jump() {
    let orbit = Some(Vector3::new(0.0, 7500.0, 0.0));
    let mut movement = Movement::default();
    assert!(movement.possible(at(0), &north(0.0), orbit, &one()));
    assert!(movement.possible(at(1), &north(7480.0), orbit, &one()));
    assert!(!movement.possible(at(2), &north(7480.0 + 75_000.0), orbit, &one()));
}

#[test]
fn a_covariance_that_is_no_number_reaches_nowhere() {
    let mut movement = Movement::default();
    assert!(movement.possible(at(0), &north(0.0), None, &one()));
    assert!(!movement.possible(at(1), &north(0.0), None, &(one() * f64::NAN)));
}
