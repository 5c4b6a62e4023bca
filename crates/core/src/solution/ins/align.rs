//! Which way up at the start: levelling at rest, heading from the course over the ground.

use super::state::Attitude;
use crate::quantity::{OutOfDomain, Radians};
use crate::special::float::{atan2, hypot};
use nalgebra::Vector3;

/// Speed below which a course says nothing \[m/s\] (ours).
pub const COURSE_FROM_MPS: f64 = 1.0;
/// Share of gravity by which the mean specific force of a body at rest may be off (ours; a hundredth is a bias of 10 mg).
const AT_REST: f64 = 0.1;
/// \[m/s²\], for the comparison above only.
const GRAVITY: f64 = 9.8;

/// Roll and pitch of a body at rest from its mean specific force, heading from its course afterwards.
///
/// ```text
/// roll = atan2(-f_y, -f_z),  pitch = atan2(f_x, hypot(f_y, f_z)),  heading = atan2(v_E, v_N)
/// ```
///
/// # Valid
/// The heading is the body's only where the body moves where its nose points: a car, an aircraft without wind drift. A bias of the
/// accelerometers tilts by bias / g, 0.06 degrees for 1 mg.
///
/// # Errors
/// [`OutOfDomain`] for a force that is not gravity within a tenth, or a horizontal speed below [`COURSE_FROM_MPS`].
pub fn coarse(force_mps2: &Vector3<f64>, velocity_ned_mps: &Vector3<f64>) -> Result<Attitude, OutOfDomain> {
    let size = force_mps2.norm();
    if !((size - GRAVITY).abs() <= AT_REST * GRAVITY) {
        return Err(OutOfDomain { argument: "force_mps2", value: size, unit: "m/s²", domain: "[8.82, 10.78], a body at rest" });
    }
    let speed = hypot(velocity_ned_mps.x, velocity_ned_mps.y);
    if !(speed >= COURSE_FROM_MPS && speed.is_finite()) {
        return Err(OutOfDomain { argument: "velocity_ned_mps", value: speed, unit: "m/s", domain: "[1, inf) horizontally" });
    }
    Ok(Attitude {
        roll: Radians::new(atan2(-force_mps2.y, -force_mps2.z)),
        pitch: Radians::new(atan2(force_mps2.x, hypot(force_mps2.y, force_mps2.z))),
        heading: Radians::new(atan2(velocity_ned_mps.y, velocity_ned_mps.x)),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At rest the specific force is the opposite of gravity, seen from the body: nose up 0.1, right wing down 0.2.
    #[test]
    fn gravity_and_course_give_the_attitude() {
        let (sp, cp, sr, cr) = (0.1f64.sin(), 0.1f64.cos(), 0.2f64.sin(), 0.2f64.cos());
        let force = 9.81 * Vector3::new(sp, -cp * sr, -cp * cr);
        let attitude = coarse(&force, &Vector3::new(0.0, -3.0, 0.0)).unwrap();
        assert!((attitude.pitch.rad() - 0.1).abs() < 1e-15 && (attitude.roll.rad() - 0.2).abs() < 1e-15);
        assert_eq!(attitude.heading.rad(), -core::f64::consts::FRAC_PI_2);
    }

    #[test]
    fn a_moving_body_is_not_levelled_and_a_standing_one_has_no_course() {
        assert_eq!(coarse(&Vector3::new(0.0, 0.0, -12.0), &Vector3::new(5.0, 0.0, 0.0)).unwrap_err().argument, "force_mps2");
        assert_eq!(coarse(&Vector3::new(0.0, 0.0, -9.8), &Vector3::new(0.5, 0.0, 0.0)).unwrap_err().argument, "velocity_ned_mps");
        assert!(coarse(&Vector3::new(0.0, 0.0, -9.8), &Vector3::new(f64::NAN, 0.0, 0.0)).is_err());
    }
}
