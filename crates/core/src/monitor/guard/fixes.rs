//! Solved positions as what stands beside a filter where no ranges come: each is its own snapshot.
//!
//! Nothing tests a solved position: its covariance bounds no fault. It serves to contradict the filter; a level it has only where its receiver
//! brings one. That a filter falls out with solved positions convicts nobody, neither the unit nor the receiver. Provenance: ours.

use super::motion::{ACCELERATION_MPS2, STEP_MOST_S};
use super::{Guard, Looked};
use crate::frame::ecef_from_geodetic;
use crate::monitor::judgement::RangesAgree;
use crate::quantity::{GpsTime, OutOfDomain};
use crate::signal::{Aiding, PositionFix, TimedAiding};
use crate::solution::ins::{Block, Difference, Fusion, Mode, is_sane};
use crate::solution::snapshot::{Snapshot, SnapshotVelocity};
use crate::solution::wls::horizontal_axes;
use crate::special::float::{hypot, sqrt};
use nalgebra::{Matrix3, Vector3};

/// Components of a position.
const COMPONENTS: usize = 3;
/// Time for which filter and positions must contradict each other before the filter starts anew, and between two starts \[s\]. Provenance:
/// inferred.
const START_AFTER_S: f64 = 10.0;

impl Guard {
    /// A solved position, before the filter has it: may the filter use it? `age_sigma_s` is the deviation of its age.
    pub fn admit_fix(&mut self, filter: &mut Fusion, now: GpsTime, timed: &TimedAiding, age_sigma_s: f64) -> bool {
        let Aiding::Fix(m) = &timed.aiding else { return true };
        let age_s = now.seconds_since(timed.time);
        let in_time = age_s <= self.settings.age_most_s && age_s >= -0.5;
        self.late = if in_time { 0 } else { self.late + 1 };
        // What the filter refuses for its numbers is no witness.
        if !is_sane(&timed.aiding) {
            return true;
        }
        self.hear_biases(filter, timed.time);
        let before = self.looked.take();
        let mut looked = seen(timed.time, m, before.as_ref(), age_sigma_s);
        let mut usable = true;
        if let Some(d) = filter.against(&looked.snapshot) {
            let settled = !matches!(filter.mode_now(), Mode::Aligning);
            // A difference of positions is no velocity of its own.
            let velocity = looked.velocity.as_ref().filter(|_| m.velocity_ned_mps.is_some());
            let tests = self.compare(&d, &looked, velocity, settled);
            self.tests = Some((timed.time, tests));
            if let Some(square) = square(&d) {
                self.shares.innovations(timed.time, &Block { square, freedom: COMPONENTS });
            }
            usable = !tests.fail();
        }
        self.follow(before.as_ref(), &mut looked, m.velocity_ned_mps.is_some());
        self.looked = Some(looked);
        usable
    }

    /// The filter has used the measurements of the last snapshot: the levels of its position from now on.
    pub fn note_level(&mut self, filter: &mut Fusion, now: GpsTime) {
        let Some(looked) = self.looked.as_ref().filter(|l| l.ranges_agree == RangesAgree::Yes) else { return };
        let Some((d, output)) = filter.against(&looked.snapshot).zip(filter.solution(now)) else { return };
        let apart = d.position.vector();
        let level = [hypot(apart.x, apart.y) + looked.level_m[0], apart.z.abs() + looked.level_m[1]];
        let sigma = [horizontal_axes(&output.covariance).0.m(), sqrt(output.covariance.matrix()[(2, 2)])];
        if level.iter().chain(&sigma).all(|x| x.is_finite()) {
            self.level = Some((now, level, sigma));
        }
    }

    /// Starts the filter anew at a solved position of now that it has contradicted for long enough, or after it has stopped; whether it did.
    ///
    /// # Errors
    /// As [`Fusion::restart_at`].
    pub fn restart_at_fix(&mut self, filter: &mut Fusion, now: GpsTime) -> Result<bool, OutOfDomain> {
        let due = self.contradiction.lasts(now, START_AFTER_S);
        let Some(looked) = self.looked.as_ref().filter(|l| l.snapshot.time == now && (due || filter.stopped().is_some())) else {
            return Ok(false);
        };
        let Some(velocity) = &looked.velocity else { return Ok(false) };
        filter.restart_at(&looked.snapshot, velocity)?;
        self.contradiction.started(now);
        self.shares = super::Shares::new();
        Ok(true)
    }
}

/// A solved position as a snapshot. Its level holds for the age that is declared.
fn seen(time: GpsTime, m: &PositionFix, before: Option<&Looked>, age_sigma_s: f64) -> Looked {
    let snapshot = Snapshot::solved(time, m.position, m.covariance);
    let velocity = match &m.velocity_ned_mps {
        Some((v, r)) => Some(SnapshotVelocity { enu_mps: Vector3::new(v.y, v.x, -v.z), covariance: enu(r) }),
        None => before.and_then(|b| between(&b.snapshot, &snapshot)),
    };
    let speed = velocity.map_or(0.0, |v| hypot(v.enu_mps.x, v.enu_mps.y));
    let (ranges_agree, [h, v]) = match m.level_m {
        Some(level) => (RangesAgree::Yes, level),
        None => (RangesAgree::Untestable, [f64::NAN; 2]),
    };
    Looked { snapshot, velocity, ranges_agree, level_m: [h + 3.0 * age_sigma_s * speed, v] }
}

/// Mean velocity between two positions, and what an acceleration meanwhile leaves of it.
fn between(a: &Snapshot, b: &Snapshot) -> Option<SnapshotVelocity> {
    let dt = b.time.seconds_since(a.time);
    if !(dt > 0.0 && dt <= STEP_MOST_S) {
        return None;
    }
    let enu_mps = b.ecef.minus(&ecef_from_geodetic(&a.position)).to_enu(&b.position.point).vector() / dt;
    let turned = 0.5 * ACCELERATION_MPS2 * dt;
    let covariance = (a.covariance.matrix() + b.covariance.matrix()) / (dt * dt) + Matrix3::identity() * (turned * turned);
    Some(SnapshotVelocity { enu_mps, covariance })
}

/// East, north, up of a matrix north, east, down.
fn enu(ned: &Matrix3<f64>) -> Matrix3<f64> {
    let turn = Matrix3::new(0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0);
    turn * ned * turn.transpose()
}

fn square(d: &Difference) -> Option<f64> {
    let x = d.position.vector();
    Some(x.dot(&d.covariance.matrix().cholesky()?.solve(x))).filter(|s| s.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::{Covariance, Displacement, Enu, Geodetic, LatLon};
    use crate::quantity::{Metres, Radians};

    fn snapshot(second: f64, east_m: f64, variance: f64) -> Snapshot {
        let point = LatLon::new(Radians::new(0.7), Radians::new(2.0)).unwrap();
        let start = Geodetic { point, height: Metres::new(1000.0) };
        let moved = start.moved(&Displacement::<Enu>::from_vector(Vector3::new(east_m, 0.0, 0.0))).unwrap();
        let covariance = Covariance::claim_symmetric(Matrix3::from_diagonal(&Vector3::new(variance, 2.0 * variance, 3.0 * variance)));
        Snapshot::solved(GpsTime::default().plus_seconds(second), moved, covariance)
    }

    #[test]
    fn the_velocity_between_two_positions_has_their_variances_and_the_acceleration() {
        for dt in [0.5, 1.0, 2.0] {
            let motion = between(&snapshot(0.0, 0.0, 4.0), &snapshot(dt, 120.0 * dt, 5.0)).unwrap();
            // The axes of the second place: 240 m turn them by 4e-5.
            assert!((motion.enu_mps - Vector3::new(120.0, 0.0, 0.0)).norm() < 0.02, "{}", motion.enu_mps);
            let turned = 0.5 * ACCELERATION_MPS2 * dt;
            for (k, times) in [1.0, 2.0, 3.0].into_iter().enumerate() {
                let expected = 9.0 * times / (dt * dt) + turned * turned;
                assert!((motion.covariance[(k, k)] - expected).abs() < 1e-12 * expected, "{dt} {k}: {}", motion.covariance[(k, k)]);
            }
        }
        let first = snapshot(0.0, 0.0, 4.0);
        assert!(
            between(&first, &snapshot(STEP_MOST_S, 0.0, 4.0)).is_some()
                && between(&first, &snapshot(STEP_MOST_S + 1e-3, 0.0, 4.0)).is_none()
        );
        assert!(between(&first, &first).is_none() && between(&snapshot(1.0, 0.0, 4.0), &first).is_none());
    }

    #[test]
    fn a_level_holds_for_the_age_that_is_declared() {
        let s = snapshot(0.0, 0.0, 4.0);
        let fix = |level_m: Option<[f64; 2]>| PositionFix {
            position: s.position,
            covariance: s.covariance,
            velocity_ned_mps: Some((Vector3::new(30.0, 40.0, 5.0), Matrix3::from_diagonal(&Vector3::new(1.0, 2.0, 3.0)))),
            level_m,
        };
        let looked = seen(s.time, &fix(Some([10.0, 20.0])), None, 0.1);
        // Three deviations of a tenth of a second at 50 m/s.
        assert_eq!(looked.level_m, [25.0, 20.0]);
        assert_eq!(looked.ranges_agree, RangesAgree::Yes);
        let v = looked.velocity.unwrap();
        assert_eq!(v.enu_mps, Vector3::new(40.0, 30.0, -5.0));
        assert_eq!(v.covariance, Matrix3::from_diagonal(&Vector3::new(2.0, 1.0, 3.0)));
        let without = seen(s.time, &fix(None), None, 0.1);
        assert!(without.ranges_agree == RangesAgree::Untestable && without.level_m.iter().all(|l| l.is_nan()));
    }
}
