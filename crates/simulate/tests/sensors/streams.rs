//! Every sensor, satellite and station draws from a stream of its own.

use super::common::{Sample, fly, rig};
use navbound_core::signal::{Aiding, Constellation};
use navbound_simulate::System;

fn where_true(flown: &[Sample], keep: impl Fn(&Aiding) -> bool) -> Vec<(i64, Aiding)> {
    flown.iter().flat_map(|s| s.aiding.iter().map(|a| (a.time.nanoseconds(), a.aiding))).filter(|(_, a)| keep(a)).collect()
}

fn is_gps(aiding: &Aiding) -> bool {
    matches!(aiding, Aiding::Satellite(s) if s.satellite.constellation == Constellation::Gps)
}

#[test]
fn leaving_a_sensor_out_changes_no_other() {
    let full = fly(&rig(|_| ()), 3, 60);
    let without_dme = fly(&rig(|s| s.dme = None), 3, 60);
    assert_eq!(where_true(&full, |a| !matches!(a, Aiding::Dme(_))), where_true(&without_dme, |_| true));
    assert_eq!(full[9].step, without_dme[9].step);
    let only_gps = fly(&rig(|s| s.gnss.as_mut().unwrap().constellations = vec![System::Gps]), 3, 60);
    let gps = where_true(&full, is_gps);
    assert!(gps.len() > 200);
    assert_eq!(gps, where_true(&only_gps, is_gps));
    let one_station = fly(&rig(|s| s.stations.truncate(1)), 3, 60);
    let first = |a: &Aiding| matches!(a, Aiding::Dme(d) if d.station == 0);
    assert_eq!(where_true(&full, first), where_true(&one_station, first));
}

#[test]
fn a_flight_is_the_same_whatever_was_flown_before_and_another_is_another() {
    let rig = rig(|_| ());
    let alone = fly(&rig, 5, 30);
    let before = fly(&rig, 4, 30);
    assert_eq!(fly(&rig, 5, 30), alone);
    for (a, b) in before[20].aiding.iter().zip(&alone[20].aiding) {
        assert_ne!(a.aiding, b.aiding);
    }
    assert_ne!(before[20].step.imu.angle_rad, alone[20].step.imu.angle_rad);
}
