//! Strapdown mechanization in north, east, down: increments of angle and velocity become position, velocity and attitude.

use super::state::{NavState, check_latitude, turn, wrapped};
use crate::frame::{ECCENTRICITY_SQUARED, SEMI_MAJOR, earth_rate_ned, gravity_of};
use crate::quantity::{OutOfDomain, Provenance};
use crate::signal::ImuIncrement;
use crate::special::float::{sin_cos, sqrt};
use nalgebra::{Matrix3, Vector3};

/// Where the equations stand.
pub const SOURCE: &str = "two-sample coning and sculling as in Savage 1998, Strapdown inertial navigation, parts 1 and 2; \
                          local-level mechanization of the textbooks";
/// Re-derived for intervals of unequal length.
pub const PROVENANCE: Provenance = Provenance::ReDerived;

/// Mechanization: the state and what the next sample needs of the last.
#[derive(Debug, Clone, Copy)]
pub struct Strapdown {
    state: NavState,
    last: Option<ImuIncrement>,
    /// Acceleration over the Earth of the last step, for the middle of the next \[m/s²\].
    acceleration: Vector3<f64>,
}

/// What a step leaves for the error dynamics.
#[derive(Debug, Clone, Copy)]
pub(super) struct Step {
    pub(super) dt: f64,
    /// Velocity that the specific force gave, local axes \[m/s\].
    pub(super) force_dt: Vector3<f64>,
    /// Body to local axes in the middle of the step (mean of both ends).
    pub(super) c: Matrix3<f64>,
    pub(super) earth: Local,
}

/// The Earth where the navigator is.
#[derive(Debug, Clone, Copy)]
pub(super) struct Local {
    pub(super) sin: f64,
    pub(super) cos: f64,
    /// R_M + h and R_N + h \[m\].
    pub(super) north: f64,
    pub(super) east: f64,
    /// Rates of the Earth and of the local axes over it \[rad/s\].
    pub(super) earth: Vector3<f64>,
    pub(super) transport: Vector3<f64>,
    pub(super) gravity: f64,
    pub(super) v: Vector3<f64>,
}

impl Local {
    /// Radii, rates and gravity at a latitude, a height and a velocity.
    ///
    /// ```text
    /// w_en = (v_E/(R_N+h), -v_N/(R_M+h), -v_E tan lat/(R_N+h))
    /// ```
    pub(super) fn at(lat: f64, h: f64, v: &Vector3<f64>) -> Self {
        let (sin, cos) = sin_cos(lat);
        let w2 = 1.0 - ECCENTRICITY_SQUARED * sin * sin;
        let prime = SEMI_MAJOR.m() / sqrt(w2);
        let (north, east) = (prime * (1.0 - ECCENTRICITY_SQUARED) / w2 + h, prime + h);
        let turn = v.y / east;
        Self {
            sin,
            cos,
            north,
            east,
            earth: earth_rate_ned(sin, cos),
            transport: Vector3::new(turn, -v.x / north, -turn * sin / cos),
            gravity: gravity_of(sin * sin, h),
            v: *v,
        }
    }
}

impl Strapdown {
    /// Begin from a known state.
    pub fn new(state: NavState) -> Self {
        Self { state, last: None, acceleration: Vector3::zeros() }
    }

    /// Where it is now.
    pub const fn state(&self) -> &NavState {
        &self.state
    }

    pub(super) fn state_mut(&mut self) -> &mut NavState {
        &mut self.state
    }

    /// The next sample stands alone: what came before it is not of the same motion (a gap).
    pub(super) fn forget(&mut self) {
        self.last = None;
    }

    /// One sample further.
    ///
    /// ```text
    /// k   = T1^2 / (6 T0 (T0 + T1)),  1/12 for equal intervals: angular rate and force linear over both
    /// phi = da1 + k da0 x da1
    /// u   = dv1 + da1 x dv1 / 2 + da1 x (da1 x dv1) / 6 + k (da0 x dv1 + dv0 x da1)
    /// v1  = v0 + (1 - [zeta/2 x]) C0 u + (g - (2 w_ie + w_en) x v_mid) T1,    zeta = (w_ie + w_en) T1
    /// q1  = q(-zeta) q0 q(phi);   position by the mean of both velocities and the radii at the middle
    /// ```
    ///
    /// Provenance: [`PROVENANCE`], from [`SOURCE`].
    ///
    /// # Valid
    /// Away from the poles ([`super::LATITUDE_MOST_RAD`]); the local axes point north there, so no wander angle is carried. Without a source
    /// of height the vertical channel runs away, e-fold in 570 s: that is physics, and the filter's task.
    ///
    /// # Errors
    /// [`OutOfDomain`] for a sample that is not finite or has an interval outside (0, 10\] s, and for a step that ends near a pole; the state
    /// stays as it was.
    pub fn advance(&mut self, sample: &ImuIncrement) -> Result<(), OutOfDomain> {
        self.step(sample).map(|_| ())
    }

    pub(super) fn step(&mut self, sample: &ImuIncrement) -> Result<Step, OutOfDomain> {
        check(sample)?;
        let (dt, s) = (sample.interval_s, &self.state);
        let v_mid = s.v + self.acceleration * (0.5 * dt);
        let lat_mid = s.lat + 0.5 * dt * self.rate_of_latitude();
        let local = Local::at(lat_mid, s.h - 0.5 * dt * v_mid.z, &v_mid);
        let (angle, velocity) = self.compensated(sample);
        let zeta = (local.earth + local.transport) * dt;
        let c0 = s.ned_from_body();
        let felt = c0 * velocity;
        let force_dt = felt - 0.5 * zeta.cross(&felt);
        let coriolis = (2.0 * local.earth + local.transport).cross(&v_mid);
        let change = force_dt + (Vector3::new(0.0, 0.0, local.gravity) - coriolis) * dt;
        let mean = s.v + 0.5 * change;
        let lat = s.lat + dt * mean.x / local.north;
        check_latitude(lat)?;
        let next = NavState {
            time: sample.time,
            lat,
            lon: wrapped(s.lon + dt * mean.y / (local.east * local.cos)),
            h: s.h - dt * mean.z,
            v: s.v + change,
            q: turn(&-zeta) * s.q * turn(&angle),
        };
        self.acceleration = change / dt;
        self.last = Some(*sample);
        self.state = next;
        self.state.renormalize();
        let c = 0.5 * (c0 + self.state.ned_from_body());
        Ok(Step { dt, force_dt, c, earth: local })
    }

    fn rate_of_latitude(&self) -> f64 {
        // The mean radius serves to find the middle of a step: half a millimetre of it changes nothing.
        self.state.v.x / (SEMI_MAJOR.m() + self.state.h)
    }

    /// Rotation vector and velocity increment of a sample, coning and sculling included.
    fn compensated(&self, sample: &ImuIncrement) -> (Vector3<f64>, Vector3<f64>) {
        let (a1, v1) = (sample.angle_rad, sample.velocity_mps);
        let once = a1.cross(&v1);
        let turned = v1 + 0.5 * once + a1.cross(&once) / 6.0;
        let Some(last) = &self.last else { return (a1, turned) };
        let (t0, t1) = (last.interval_s, sample.interval_s);
        let k = t1 * t1 / (6.0 * t0 * (t0 + t1));
        let coning = last.angle_rad.cross(&a1);
        let sculling = last.angle_rad.cross(&v1) + last.velocity_mps.cross(&a1);
        (a1 + k * coning, turned + k * sculling)
    }
}

/// # Errors
/// [`OutOfDomain`] for what no inertial unit delivers.
pub(super) fn check(sample: &ImuIncrement) -> Result<(), OutOfDomain> {
    let dt = sample.interval_s;
    if !(dt > 0.0 && dt <= INTERVAL_MOST_S) {
        return Err(OutOfDomain { argument: "interval_s", value: dt, unit: "s", domain: "(0, 10]" });
    }
    for x in sample.angle_rad.iter() {
        if !(x.abs() <= ANGLE_MOST_RAD) {
            return Err(OutOfDomain { argument: "angle_rad", value: *x, unit: "rad", domain: "[-pi, pi]" });
        }
    }
    for x in sample.velocity_mps.iter() {
        if !(x.abs() <= VELOCITY_MOST_MPS) {
            return Err(OutOfDomain { argument: "velocity_mps", value: *x, unit: "m/s", domain: "[-1e4, 1e4]" });
        }
    }
    Ok(())
}

const INTERVAL_MOST_S: f64 = 10.0;
/// More than half a turn in a sample cannot be distinguished from a turn the other way.
const ANGLE_MOST_RAD: f64 = core::f64::consts::PI;
/// A thousand g for a second: no vehicle of ours.
const VELOCITY_MOST_MPS: f64 = 1.0e4;
