//! The truth is the planned path, blended; that position, velocity, attitude, force and rate are of one motion is shown by strapdown.rs.

use super::common::{BEGIN_NS, Rig, all, rig};
use navbound_core::frame::{LatLon, ecef_from_geodetic};
use navbound_core::quantity::{GpsTime, Radians};
use navbound_path::Line;
use navbound_simulate::{PathFlown, fly};

#[test]
fn the_blended_path_keeps_to_the_plan() {
    let rig = rig(|s| (s.gnss, s.dme, s.vor, s.baro) = (None, None, None, None));
    let mut cursor = rig.trajectory.cursor();
    let mut worst = [0.0_f64; 2];
    for epoch in fly(rig.sensing.outlook(), 7, 0).unwrap() {
        // The point of the plan that belongs to the estimate, some metres along from that of the instant, and the course there.
        let point = LatLon::new(Radians::new(epoch.path[0]), Radians::new(epoch.path[1])).unwrap();
        let tangent = Line::from_azimuth(point, Radians::new(epoch.course_rad)).unwrap();
        let truth = cursor.at(GpsTime::from_nanoseconds(epoch.time_ns).seconds_since(GpsTime::from_nanoseconds(BEGIN_NS))).unwrap();
        worst[0] = worst[0].max(tangent.project(&truth.position.point).unwrap().cross.m().abs());
        worst[1] = worst[1].max((truth.position.height.m() - epoch.path[2]).abs());
    }
    // In the plane a steady turn keeps its radius; where it begins and ends the blend cuts by some metres. A vertical speed of 12 m/s that
    // begins at once is met within 12 * 0.4 * sqrt(0.5) * 4 s = 13.6 m; the estimate's point lies up to ten metres along, a slope of 0.16.
    assert!(worst[0] < 10.0 && worst[0] > 0.01, "{worst:?}");
    assert!(worst[1] < 16.0 && worst[1] > 1.0, "{worst:?}");
}

#[test]
fn a_flown_path_has_its_technical_error() {
    let at = |path| -> Rig { rig(|s| (s.path, s.gnss, s.dme, s.vor, s.baro) = (path, None, None, None, None)) };
    let (planned, flown) = (all(&at(PathFlown::Planned), 1, 600), all(&at(PathFlown::Flown), 1, 600));
    let apart = |k: usize| {
        let (a, b) = (ecef_from_geodetic(&planned[k].step.truth.position), ecef_from_geodetic(&flown[k].step.truth.position));
        a.minus(&b).vector().norm()
    };
    // On the runway the centreline is held; in the air gusts and the navigation error move the aircraft by metres to some hundred.
    assert!(apart(200) < 0.1, "{}", apart(200));
    let largest = (3000..6000).map(apart).fold(0.0, f64::max);
    assert!((2.0..300.0).contains(&largest), "{largest}");
    // The truth of the epochs is smoothed by the knots, by metres at the gusts' pace.
    let rig = at(PathFlown::Flown);
    let epochs = fly(rig.sensing.outlook(), 7, 1).unwrap();
    for epoch in epochs.iter().skip(100).step_by(50).take(9) {
        let k = ((epoch.time_ns - epochs[0].time_ns) / 100_000_000) as usize - 1;
        assert!((flown[k].step.truth.position.height.m() - epoch.truth[2]).abs() < 15.0);
    }
}
