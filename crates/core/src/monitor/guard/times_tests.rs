//! Each time of a guard at its limit and just beyond.

use super::tests::{SETTINGS, World, fix};
use super::*;
use nalgebra::Vector3;

/// Times of the limits themselves: an age of two seconds and a time half a second ahead are in time, beyond them nothing is; one that is
/// in time takes back those that were not.
#[test]
fn an_age_that_is_just_reached_is_in_time() {
    for (age_s, late) in [(2.0, 0), (2.0 + 1e-6, 1), (-0.5, 0), (-0.5 - 1e-6, 1), (0.0, 0)] {
        let mut world = World::new(5);
        let (mut filter, mut guard) = (world.filter(), Guard::new(SETTINGS).unwrap());
        filter.advance(&world.sample());
        let ranges = world.ranges();
        guard.admit(&mut filter, world.time().plus_seconds(age_s), &ranges);
        assert_eq!(guard.late, late, "{age_s}");
        guard.admit(&mut filter, world.time().plus_seconds(9.0), &ranges);
        assert_eq!(guard.late, late + 1);
        guard.admit_fix(&mut filter, world.time().plus_seconds(age_s), &fix(&world, 0.0, 9.0), 0.0);
        assert_eq!(guard.late, late * (late + 2), "{age_s}");
        let holds = |n: u32| {
            let mut guard = Guard::new(SETTINGS).unwrap();
            guard.late = n;
            guard.facts(&mut filter.clone(), world.time(), None, Witnesses::NONE).satellite_times_hold
        };
        assert_eq!([holds(2), holds(3)], [Some(true), Some(false)]);
    }
}

/// A sample is off the clock where its time is more than half an interval from when it was due; two on end make the clock wrong, which it is
/// until sixty seconds have passed without, and out of use after ten.
#[test]
fn a_clock_is_wrong_from_the_second_sample_until_a_minute_without() {
    let world = World::new(1);
    let due = |k: f64| world.time().plus_seconds(k);
    let hear = |guard: &mut Guard, k: f64, off_s: f64| {
        let sample = ImuIncrement {
            time: due(k).plus_seconds(off_s),
            interval_s: 1.0,
            angle_rad: Vector3::new(1e-4, k * 1e-7, 0.0),
            velocity_mps: Vector3::new(0.0, k * 1e-7, -9.8),
        };
        guard.sample(due(k), Some((&sample, &Advance::Done)));
    };
    let mut guard = Guard::new(SETTINGS).unwrap();
    for (k, off_s) in [(0.0, 0.6), (1.0, 0.5), (2.0, -0.6), (3.0, -0.5), (4.0, 0.6)] {
        hear(&mut guard, k, off_s);
        assert_eq!(guard.inertial(due(k)), Inertial::Plausible, "{k}");
    }
    (5..=13).for_each(|k| hear(&mut guard, f64::from(k), 0.6));
    assert_eq!(guard.inertial(due(13.0)), Inertial::Clock);
    // First wrong at five: ten seconds later the unit is out, as long as that lasts.
    hear(&mut guard, 14.0, 0.6);
    assert_eq!(guard.inertial(due(14.9)), Inertial::Clock);
    hear(&mut guard, 15.0, 0.6);
    assert_eq!(
        (guard.inertial(due(15.0)), guard.inertial(due(15.9)), guard.inertial(due(16.0))),
        (Inertial::Fault, Inertial::Fault, Inertial::Clock)
    );
    (16..75).for_each(|k| hear(&mut guard, f64::from(k), 0.0));
    assert_eq!(guard.inertial(due(74.0)), Inertial::Clock);
    hear(&mut guard, 75.0, 0.0);
    assert_eq!(guard.inertial(due(75.0)), Inertial::Plausible);
}

/// Half a second without samples is no hole, more is one; refused where samples came and were refused since.
#[test]
fn a_unit_is_missing_or_refused_after_its_longest_hole() {
    let world = World::new(1);
    let sample = ImuIncrement { time: world.time(), interval_s: 1.0, angle_rad: Vector3::zeros(), velocity_mps: Vector3::zeros() };
    let later = |s: f64| world.time().plus_seconds(s);
    let mut guard = Guard::new(SETTINGS).unwrap();
    assert_eq!(guard.inertial(later(100.0)), Inertial::Plausible, "nothing was due yet");
    guard.sample(world.time(), None);
    assert_eq!((guard.inertial(later(0.5)), guard.inertial(later(1.0))), (Inertial::Plausible, Inertial::Missing { for_s: 1.0 }));
    guard.sample(world.time(), Some((&sample, &Advance::Late)));
    assert_eq!((guard.inertial(later(0.5)), guard.inertial(later(1.0))), (Inertial::Plausible, Inertial::Refused { for_s: 1.0 }));
    guard.sample(world.time(), Some((&sample, &Advance::Done)));
    assert_eq!((guard.inertial(later(0.5)), guard.inertial(later(0.75))), (Inertial::Plausible, Inertial::Missing { for_s: 0.75 }));
}
