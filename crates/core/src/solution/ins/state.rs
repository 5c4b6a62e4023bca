//! What an inertial navigator knows of itself: where, how fast, and which way up.

use crate::frame::{Geodetic, LatLon};
use crate::quantity::{GpsTime, Metres, OutOfDomain, Radians};
use crate::special::float::{asin, atan2, sin_cos, sqrt};
use core::f64::consts::{PI, TAU};
use nalgebra::{Matrix3, Quaternion, Vector3};

/// Latitude up to which north and east axes serve \[rad\], 89.9 degrees: the turn of the axes, v tan(lat)/R, and the metres of a
/// longitude lose their meaning at a pole. 11 km from it at 250 m/s the axes turn by 1.3 degrees a second, which a 200 Hz step still follows.
pub const LATITUDE_MOST_RAD: f64 = 89.9 * PI / 180.0;

/// Roll, pitch and heading: the turns right wing down, nose up, clockwise from true north.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Attitude {
    /// About the forward axis.
    pub roll: Radians,
    /// About the right axis.
    pub pitch: Radians,
    /// About the down axis.
    pub heading: Radians,
}

/// Position, velocity and attitude at an instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NavState {
    /// When.
    pub time: GpsTime,
    pub(super) lat: f64,
    pub(super) lon: f64,
    pub(super) h: f64,
    pub(super) v: Vector3<f64>,
    /// Turns body axes into local axes.
    pub(super) q: Quaternion<f64>,
}

impl NavState {
    /// From a position, a velocity north, east, down \[m/s\] and an attitude.
    ///
    /// # Errors
    /// [`OutOfDomain`] within 0.1 degree of a pole ([`LATITUDE_MOST_RAD`]), or for a number that is not finite.
    pub fn new(time: GpsTime, position: &Geodetic, velocity_ned_mps: Vector3<f64>, attitude: &Attitude) -> Result<Self, OutOfDomain> {
        let (lat, h) = (position.point.lat().rad(), position.height.m());
        check_latitude(lat)?;
        finite("h_m", h, "m")?;
        for component in velocity_ned_mps.iter() {
            finite("velocity_ned_mps", *component, "m/s")?;
        }
        for angle in [attitude.roll, attitude.pitch, attitude.heading] {
            finite("attitude_rad", angle.rad(), "rad")?;
        }
        let q = quaternion(attitude);
        Ok(Self { time, lat, lon: wrapped(position.point.lon().rad()), h, v: velocity_ned_mps, q })
    }

    /// Where.
    ///
    /// # Errors
    /// [`OutOfDomain`] for a state that is no place on the Earth, which no accepted sample leaves behind.
    pub fn position(&self) -> Result<Geodetic, OutOfDomain> {
        Ok(Geodetic { point: LatLon::new(Radians::new(self.lat), Radians::new(self.lon))?, height: Metres::new(self.h) })
    }

    /// Velocity over the Earth, north, east, down \[m/s\].
    pub const fn velocity_ned_mps(&self) -> &Vector3<f64> {
        &self.v
    }

    /// Roll, pitch, heading; the heading in (-pi, pi]. Straight up or down roll and heading are not apart, and only their sum means something.
    pub fn attitude(&self) -> Attitude {
        let c = self.ned_from_body();
        let pitch = asin((-c[(2, 0)]).clamp(-1.0, 1.0));
        Attitude {
            roll: Radians::new(atan2(c[(2, 1)], c[(2, 2)])),
            pitch: Radians::new(pitch),
            heading: Radians::new(atan2(c[(1, 0)], c[(0, 0)])),
        }
    }

    /// The turn from body axes (forward, right, down) into north, east, down.
    pub fn ned_from_body(&self) -> Matrix3<f64> {
        matrix(&self.q)
    }

    /// The length of the quaternion goes back to one.
    pub(super) fn renormalize(&mut self) {
        // One Newton step for 1/sqrt: the length is off by rounding only, so the square of that is nothing.
        self.q *= 1.5 - 0.5 * self.q.norm_squared();
    }
}

pub(super) fn check_latitude(lat: f64) -> Result<(), OutOfDomain> {
    if !(lat.abs() <= LATITUDE_MOST_RAD) {
        return Err(OutOfDomain { argument: "lat_rad", value: lat, unit: "rad", domain: "[-1.569051, 1.569051], 0.1 degree from a pole" });
    }
    Ok(())
}

pub(super) fn finite(argument: &'static str, value: f64, unit: &'static str) -> Result<(), OutOfDomain> {
    if !value.is_finite() {
        return Err(OutOfDomain { argument, value, unit, domain: "finite numbers" });
    }
    Ok(())
}

/// A longitude in (-pi, pi] from one that has run over by less than a turn.
pub(super) fn wrapped(lon: f64) -> f64 {
    if lon > PI {
        lon - TAU
    } else if lon <= -PI {
        lon + TAU
    } else {
        lon
    }
}

/// Quaternion of the turn about z, then y, then x by heading, pitch, roll.
pub(super) fn quaternion(attitude: &Attitude) -> Quaternion<f64> {
    let (sr, cr) = sin_cos(0.5 * attitude.roll.rad());
    let (sp, cp) = sin_cos(0.5 * attitude.pitch.rad());
    let (sh, ch) = sin_cos(0.5 * attitude.heading.rad());
    Quaternion::new(cr * cp * ch + sr * sp * sh, sr * cp * ch - cr * sp * sh, cr * sp * ch + sr * cp * sh, cr * cp * sh - sr * sp * ch)
}

/// Quaternion of a turn by a rotation vector.
///
/// ```text
/// q = (cos(a/2), sin(a/2)/a * vector),   a = |vector|
/// ```
///
/// Up to a tenth of a radian by four terms of the series, whose next one is below 2e-16.
pub(super) fn turn(vector: &Vector3<f64>) -> Quaternion<f64> {
    let a2 = vector.norm_squared();
    if a2 < 0.01 {
        let x = 0.25 * a2;
        let c = 1.0 - x * (0.5 - x * (1.0 / 24.0 - x * (1.0 / 720.0 - x / 40_320.0)));
        let s = 0.5 * (1.0 - x * (1.0 / 6.0 - x * (1.0 / 120.0 - x * (1.0 / 5040.0 - x / 362_880.0))));
        return Quaternion::new(c, s * vector.x, s * vector.y, s * vector.z);
    }
    let a = sqrt(a2);
    let (s, c) = sin_cos(0.5 * a);
    let s = s / a;
    Quaternion::new(c, s * vector.x, s * vector.y, s * vector.z)
}

/// The rotation matrix of a unit quaternion.
pub(super) fn matrix(q: &Quaternion<f64>) -> Matrix3<f64> {
    let (w, x, y, z) = (q.w, q.i, q.j, q.k);
    Matrix3::new(
        1.0 - 2.0 * (y * y + z * z),
        2.0 * (x * y - w * z),
        2.0 * (x * z + w * y),
        2.0 * (x * y + w * z),
        1.0 - 2.0 * (x * x + z * z),
        2.0 * (y * z - w * x),
        2.0 * (x * z - w * y),
        2.0 * (y * z + w * x),
        1.0 - 2.0 * (x * x + y * y),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn attitude(roll: f64, pitch: f64, heading: f64) -> Attitude {
        Attitude { roll: Radians::new(roll), pitch: Radians::new(pitch), heading: Radians::new(heading) }
    }

    fn at(lat: f64, attitude: &Attitude) -> Result<NavState, OutOfDomain> {
        let point = LatLon::new(Radians::new(lat), Radians::new(0.3)).unwrap();
        NavState::new(GpsTime::default(), &Geodetic { point, height: Metres::new(0.0) }, Vector3::zeros(), attitude)
    }

    /// The three elementary turns, one after the other, as every flight mechanics book draws them.
    #[test]
    fn the_nose_goes_where_heading_and_pitch_say() {
        let c = at(0.8, &attitude(0.3, 0.2, 1.1)).unwrap().ned_from_body();
        let nose = Vector3::new(0.2f64.cos() * 1.1f64.cos(), 0.2f64.cos() * 1.1f64.sin(), -(0.2f64.sin()));
        assert!((c.column(0) - nose).norm() < 4e-16);
        // Right wing down for a positive roll.
        assert!((c[(2, 1)] - 0.3f64.sin() * 0.2f64.cos()).abs() < 4e-16);
    }

    #[test]
    fn a_pole_and_what_is_no_number_are_refused() {
        assert!(at(1.5691, &attitude(0.0, 0.0, 0.0)).is_err());
        assert_eq!(at(0.5, &attitude(0.0, f64::NAN, 0.0)).unwrap_err().argument, "attitude_rad");
    }

    proptest! {
        // Degrees lost near the vertical: asin loses half the digits at a pitch of 90 degrees, 1e-8, so the nose stays 6 degrees off it.
        #[test]
        fn an_attitude_comes_back(roll in -3.1..3.1f64, pitch in -1.46..1.46f64, heading in -3.1..3.1f64) {
            let back = at(0.5, &attitude(roll, pitch, heading)).unwrap().attitude();
            prop_assert!((back.roll.rad() - roll).abs() < 1e-13);
            prop_assert!((back.pitch.rad() - pitch).abs() < 1e-13);
            prop_assert!((back.heading.rad() - heading).abs() < 1e-13);
        }

        // Rodrigues' formula, both sides of the change from series to functions.
        #[test]
        fn a_turn_is_rodrigues(x in -0.3..0.3f64, y in -0.3..0.3f64, z in -0.3..0.3f64) {
            let v = Vector3::new(x, y, z);
            let (a, k) = (v.norm(), v.cross_matrix());
            prop_assume!(a > 1e-3);
            let expected = Matrix3::identity() + k * (a.sin() / a) + k * k * ((1.0 - a.cos()) / (a * a));
            prop_assert!((matrix(&turn(&v)) - expected).amax() < 2e-15);
        }
    }
}
