//! Satellites that stand alone against their own rates: where the velocities since the last trusted position lead, there the next one is.
//!
//! ```text
//! p(t) = p(t0) + sum of (v_k + v_k-1) / 2 dt        Cov = S(t0) + S(t) + sum of (Sv_k + Sv_k-1) dt^2 / 4 + (j dt^3 / 12)^2
//! ```
//!
//! The level of a position that stands alone takes in its distance from there. The slow errors of both positions are counted twice, so that the test is on the wide side. Positions without a velocity of their own lead as
//! far as the change before them. It says nothing of satellites whose rates agree with the motion that they pretend. Provenance: ours.

use super::Looked;
use super::motion::{ACCELERATION_MPS2, STEP_MOST_S};
use crate::frame::{Covariance, Displacement, EcefPosition, Enu, enu_from_ecef};
use crate::monitor::consistency::normalised_square_horizontal;
use crate::quantity::GpsTime;
use crate::special::float::hypot;
use nalgebra::{Matrix3, Vector3};

/// Standard deviation of the change of acceleration within a step \[m/s³\]. Provenance: inferred.
const JERK_MPS3: f64 = 3.0;

/// The way since the last position that a unit or a filter has agreed with.
#[derive(Debug, Clone, Copy)]
pub(super) struct Course {
    from: EcefPosition,
    variance: Matrix3<f64>,
    moved_ecef_m: Vector3<f64>,
    moved_m2: f64,
    at: GpsTime,
}

impl Course {
    /// Begins at a position.
    pub(super) fn at(looked: &Looked) -> Self {
        let s = &looked.snapshot;
        Self { from: s.ecef, variance: *s.covariance.matrix(), moved_ecef_m: Vector3::zeros(), moved_m2: 0.0, at: s.time }
    }

    /// The next position; `None` where the step is too long or there is no velocity to lead there. `measured`: the velocities are measured.
    pub(super) fn led(&self, before: &Looked, now: &Looked, measured: bool) -> Option<Self> {
        let dt = now.snapshot.time.seconds_since(before.snapshot.time);
        if !(dt > 0.0 && dt <= STEP_MOST_S && before.snapshot.time == self.at) {
            return None;
        }
        let first = before.velocity?;
        let ecef = enu_from_ecef(&now.snapshot.position.point).transpose();
        let (enu_mps, variance) = if measured {
            let second = now.velocity?;
            let turned = JERK_MPS3 * dt * dt * dt / 12.0;
            let both = (first.covariance + second.covariance).trace() / 3.0;
            ((first.enu_mps + second.enu_mps) * 0.5, 0.25 * both * dt * dt + turned * turned)
        } else {
            let turned = ACCELERATION_MPS2 * dt * dt;
            (first.enu_mps, first.covariance.trace() / 3.0 * dt * dt + turned * turned)
        };
        let moved_ecef_m = self.moved_ecef_m + ecef * enu_mps * dt;
        Some(Self { moved_ecef_m, moved_m2: self.moved_m2 + variance, at: now.snapshot.time, ..*self })
    }

    /// How far a position is from where the way led, and the squares of that; horizontal and vertical \[m\].
    pub(super) fn apart(&self, now: &Looked) -> ([f64; 2], [f64; 2]) {
        let enu = enu_from_ecef(&now.snapshot.position.point);
        let apart = enu * (now.snapshot.ecef.vector() - self.from.vector() - self.moved_ecef_m);
        let wide = self.variance + now.snapshot.covariance.matrix() + Matrix3::identity() * self.moved_m2;
        let horizontal = normalised_square_horizontal(&Displacement::<Enu>::from_vector(apart), &Covariance::<Enu>::claim_symmetric(wide));
        let squares = [horizontal.unwrap_or(f64::NAN), apart.z * apart.z / wide[(2, 2)]];
        ([hypot(apart.x, apart.y), apart.z.abs()], squares)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::{Geodetic, LatLon};
    use crate::monitor::judgement::RangesAgree;
    use crate::quantity::{Metres, Radians};
    use crate::solution::snapshot::{Snapshot, SnapshotVelocity};

    const SPEED_MPS: f64 = 100.0;

    /// A second of a straight flight east, moved by an error; deviations 2 m and 0.02 m/s.
    fn looked(second: u32, error_m: f64) -> Looked {
        let point = LatLon::new(Radians::new(0.5), Radians::new(1.0)).unwrap();
        let start = Geodetic { point, height: Metres::new(1000.0) };
        let t = f64::from(second);
        let east = Displacement::<Enu>::from_vector(Vector3::new(SPEED_MPS * t + error_m, 0.0, 0.0));
        let position = start.moved(&east).unwrap();
        let covariance = Covariance::<Enu>::claim_symmetric(Matrix3::identity() * 4.0);
        let velocity = SnapshotVelocity { enu_mps: Vector3::new(SPEED_MPS, 0.0, 0.0), covariance: Matrix3::identity() * 4e-4 };
        let snapshot = Snapshot::solved(GpsTime::default().plus_seconds(t), position, covariance);
        Looked { snapshot, velocity: Some(velocity), ranges_agree: RangesAgree::Yes, level_m: [10.0; 2] }
    }

    fn flown(errors_m: &[f64], measured: bool) -> ([f64; 2], [f64; 2]) {
        let mut before = looked(0, errors_m[0]);
        let mut course = Course::at(&before);
        for (second, error_m) in (1..).zip(&errors_m[1..]) {
            let now = looked(second, *error_m);
            course = course.led(&before, &now, measured).unwrap();
            before = now;
        }
        course.apart(&before)
    }

    #[test]
    fn a_way_that_the_velocities_lead_is_no_difference() {
        let ([h, v], [square, _]) = flown(&[0.0; 30], true);
        // The axes turn with the place and the tangent does not: p^2 / 2 r of three kilometres.
        let turned = 2900.0 * 2900.0 / 1.2e7;
        assert!(h < turned && v < turned, "{h} {v}");
        assert!(square < turned * turned / 8.0);
    }

    #[test]
    fn a_drift_that_the_velocities_do_not_know_adds_up() {
        let drift: Vec<f64> = (0..30).map(f64::from).collect();
        let ([h, _], [square, _]) = flown(&drift, true);
        assert!((h - 29.0).abs() < 0.1);
        // Both positions 4 m2; 29 steps of 2e-4 m2 of the velocities and (3 / 12)^2 m2 of the acceleration's change.
        let expected = 29.0 * 29.0 / (8.0 + 29.0 * (2e-4 + 0.0625));
        assert!((square / expected - 1.0).abs() < 1e-2, "{square} {expected}");
    }

    #[test]
    fn without_measured_velocities_a_jump_shows_against_the_velocity_before() {
        let (_, [near, _]) = flown(&[0.0, 3.0], false);
        let (_, [far, _]) = flown(&[0.0, 60.0], false);
        let variance = 8.0 + 4e-4 + 9.0;
        assert!((near * variance / 9.0 - 1.0).abs() < 1e-3 && (far * variance / 3600.0 - 1.0).abs() < 1e-3);
        assert!(near < 42.2 && far > 42.2);
    }

    #[test]
    fn a_step_too_long_and_one_from_elsewhere_lead_nowhere() {
        let (first, second) = (looked(0, 0.0), looked(3, 0.0));
        let course = Course::at(&first);
        assert!(course.led(&first, &second, true).is_none());
        assert!(course.led(&second, &first, true).is_none());
        let mut blind = first.clone();
        blind.velocity = None;
        assert!(course.led(&blind, &looked(1, 0.0), true).is_none());
    }

    /// Velocities of unlike variances: a quarter of the mean of both traces a step, or the whole of the first where none is measured.
    #[test]
    fn the_variance_of_a_way_is_that_of_its_velocities() {
        let with = |second: u32, trace: [f64; 3]| {
            let mut looked = looked(second, 0.0);
            looked.velocity.as_mut().unwrap().covariance = Matrix3::from_diagonal(&Vector3::from(trace));
            looked
        };
        let (first, second) = (with(0, [3.0, 12.0, 30.0]), with(2, [6.0, 0.3, 2.7]));
        let course = Course::at(&first);
        // 45 / 3 and 9 / 3 m2/s2 over two seconds; a change of acceleration of 3 m/s3 moves by 3 x 8 / 12 m.
        let led = course.led(&first, &second, true).unwrap();
        assert!((led.moved_m2 - (0.25 * 18.0 * 4.0 + 4.0)).abs() < 1e-12, "{}", led.moved_m2);
        // An acceleration of 3 m/s2 moves by at most 3 x 4 m.
        let led = course.led(&first, &second, false).unwrap();
        assert!((led.moved_m2 - (15.0 * 4.0 + 144.0)).abs() < 1e-12, "{}", led.moved_m2);
    }

    #[test]
    fn the_longest_step_leads_and_one_of_no_time_does_not() {
        let first = looked(0, 0.0);
        let later = |seconds: f64| {
            let mut looked = looked(0, 0.0);
            looked.snapshot.time = first.snapshot.time.plus_seconds(seconds);
            looked
        };
        for (seconds, leads) in [(STEP_MOST_S, true), (STEP_MOST_S + 1e-3, false), (1e-3, true), (0.0, false), (-1.0, false)] {
            assert_eq!(Course::at(&first).led(&first, &later(seconds), true).is_some(), leads, "{seconds}");
        }
    }
}
