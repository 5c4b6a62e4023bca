use super::*;
use crate::geometry::{Elements, Orbit};
use crate::quantity::{Metres, Radians};
extern crate std;
use std::vec::Vec;

/// A Kepler orbit as a table: the truth between the nodes is the orbit itself.
fn orbit() -> Orbit {
    let circle = Elements::circular(Metres::new(26_559_800.0), Radians::degrees(55.0), Radians::degrees(20.0), Radians::degrees(35.0));
    Orbit::new(Elements { eccentricity: 0.02, ..circle }).unwrap()
}

fn table(step_s: f64, n: usize) -> Vec<OrbitNode> {
    let node = |k: usize| {
        let seconds = step_s * k as f64;
        OrbitNode { time: GpsTime::default().plus_seconds(seconds), position: orbit().position(seconds) }
    };
    (0..n).map(node).collect()
}

fn clocks(n: usize) -> Vec<ClockNode> {
    (0..n).map(|k| ClockNode { time: GpsTime::default().plus_seconds(30.0 * k as f64), bias_s: 1e-4 + 3e-9 * k as f64 }).collect()
}

fn at(seconds: f64) -> Result<SatelliteState, Unavailable> {
    state(&table(900.0, 30), &clocks(1000), 45.0, GpsTime::default().plus_seconds(seconds))
}

#[test]
fn positions_between_the_nodes_are_those_of_the_orbit() {
    // Order 10 at 15 min on a Kepler orbit: the remainder, eleventh derivative over 11! times the product of distances, is some
    // millimetres in the middle of a table and some centimetres in its outermost interval.
    for (seconds, tolerance) in [(13_333.0, 2e-3), (13_050.0, 2e-3), (450.0, 0.2), (100.0, 0.2), (9_000.0, 1e-7)] {
        let miss = at(seconds).unwrap().position.minus(&orbit().position(seconds)).vector().norm();
        assert!(miss < tolerance, "{miss} m at {seconds} s");
    }
}

#[test]
fn the_velocity_is_the_rate_of_the_position() {
    let (before, after) = (orbit().position(13_332.5), orbit().position(13_333.5));
    let rate = after.minus(&before);
    // A difference over 1 s is wrong by a third derivative over 24: below 1e-5 m/s here.
    assert!((rate.vector() - at(13_333.0).unwrap().velocity_mps).norm() < 1e-4);
}

#[test]
fn clocks_run_straight_between_records_and_carry_relativity() {
    let state = at(13_335.0).unwrap();
    let inertial = state.velocity_mps + EARTH_RATE * Vector3::new(-state.position.vector().y, state.position.vector().x, 0.0);
    let relativity = -2.0 * state.position.vector().dot(&inertial) / (SPEED_OF_LIGHT_MPS * SPEED_OF_LIGHT_MPS);
    // 444.5 records of 3 ns each.
    assert!((state.clock_s - relativity - (1e-4 + 3e-9 * 444.5)).abs() < 1e-15);
    // IS-GPS-200: F e sqrt(A) sin E with F = -4.442807633e-10 reaches 4.58e-8 s for e = 0.02; somewhere on the table it does.
    let largest = (0..290).map(|k| at(90.0 * f64::from(k)).unwrap());
    let largest = largest.map(|s| (s.clock_s - 1e-4).abs()).fold(0.0, f64::max);
    assert!(largest > 4.4e-8);
}

#[test]
fn nothing_is_extrapolated_and_holes_are_not_bridged() {
    assert!(at(-1.0).is_err() && at(26_100.1).is_err() && at(26_100.0).is_ok() && at(0.0).is_ok());
    let mut holed = table(900.0, 30);
    holed.remove(14);
    let time = GpsTime::default().plus_seconds(12_600.0);
    assert!(state(&holed, &clocks(1000), 45.0, time).is_err());
    let mut gap = clocks(1000);
    gap.remove(420);
    assert!(state(&table(900.0, 30), &gap, 45.0, time).is_err());
    assert!(state(&table(900.0, 30), &gap, 60.0, time).is_ok());
    assert!(state(&table(900.0, 10), &clocks(1000), 45.0, time).is_err());
    assert!(state(&[], &[], 45.0, time).is_err());
}
