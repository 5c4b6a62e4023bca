//! After a hole in the inertial samples that is too long to be bridged: after the gap, then aligning, then as before.
//!
//! What turned in the hole is not known, so nothing can be integrated. The filter stays on the last velocity, as uncertain as the declared
//! acceleration makes it over the hole, and speaks again with the first measurement after it: satellites, or stations and their time.
//! When the velocity is known again and the vehicle does not turn, weight and course give an attitude; from there it integrates, and its
//! gyroscopes and accelerometers keep the biases that were known of them.

use super::align::{COURSE_FROM_MPS, coarse};
use super::covariance::{Fade, StepNoise};
use super::dynamics::{LINE, MOTION, NAV, PHI, R, V};
use super::filter::{Advance, Filter};
use super::settings::positive;
use super::state::{check_latitude, quaternion, wrapped};
use super::strapdown::Local;
use crate::quantity::{GpsTime, OutOfDomain, Radians};
use crate::signal::ImuIncrement;
use crate::special::float::{hypot, sqrt};
use nalgebra::Vector3;

/// How a filter comes back.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resumption {
    /// Standard deviation of the acceleration while nothing is integrated \[m/s²\].
    pub acceleration_mps2: f64,
    /// Largest turning of a vehicle that is levelled by its weight \[rad/s\].
    pub turning_most_radps: f64,
    /// Standard deviation of the velocity as a share of it, from which on its direction is a heading.
    pub course_share: f64,
    /// Standard deviations of an attitude by weight and course: tilt (acceleration along the path) and heading (drift angle; the
    /// velocity's own comes to it).
    pub tilt: Radians,
    /// See [`Resumption::tilt`].
    pub heading: Radians,
    /// Standard deviation of the tilt at which the aligning ends; an accelerometer's bias over gravity comes to it.
    pub settled: Radians,
}

impl Resumption {
    /// 3 m/s² (a bank of 17 degrees), 0.3 degrees a second, 20 %, 3 and 9 degrees, 1 mrad. Ours.
    pub const USUAL: Self = Self {
        acceleration_mps2: 3.0,
        turning_most_radps: 0.005,
        course_share: 0.2,
        tilt: Radians::new(0.05),
        heading: Radians::new(0.15),
        settled: Radians::new(1e-3),
    };

    /// With all deviations larger by a factor.
    pub(super) fn wider(&self, factor: f64) -> Self {
        let wider = |angle: Radians| Radians::new(angle.rad() * factor);
        let acceleration_mps2 = self.acceleration_mps2 * factor;
        Self { acceleration_mps2, tilt: wider(self.tilt), heading: wider(self.heading), ..*self }
    }

    pub(super) fn check(&self) -> Result<(), OutOfDomain> {
        positive("resumption_acceleration_mps2", self.acceleration_mps2, "m/s²")?;
        positive("resumption_turning_most_radps", self.turning_most_radps, "rad/s")?;
        positive("resumption_course_share", self.course_share, "1")?;
        positive("resumption_tilt_rad", self.tilt.rad(), "rad")?;
        positive("resumption_heading_rad", self.heading.rad(), "rad")?;
        positive("resumption_settled_rad", self.settled.rad(), "rad")
    }
}

/// Time over which weight and turning are averaged \[s\].
const LISTEN_S: f64 = 1.0;
/// Time for which a changing acceleration stays the same \[s\], and most pieces that a hole is cut into (ours).
const CHANGE_S: f64 = 1.0;
const PIECES_MOST: f64 = 600.0;
/// Variance of an angle of which nothing is known: even over a turn.
const ANY_ANGLE_RAD2: f64 = core::f64::consts::PI * core::f64::consts::PI / 3.0;
/// \[m/s²\], for the share of an accelerometer's bias in the tilt only.
const GRAVITY: f64 = 9.8;

/// What is heard of the samples meanwhile.
#[derive(Debug, Clone, Copy)]
pub(super) struct AfterGap {
    /// The last sample.
    pub(super) heard: GpsTime,
    listened_s: f64,
    force: Vector3<f64>,
    rate: Vector3<f64>,
}

impl Filter {
    /// Whether the state is that of the last sample: not after a gap, before a measurement.
    pub fn is_current(&self) -> bool {
        self.stopped.is_none() && self.after_gap.is_none_or(|a| a.heard <= self.time())
    }

    /// Of when the last sample is, integrated or not.
    pub(super) fn heard(&self) -> GpsTime {
        self.after_gap.map_or(self.time(), |a| a.heard)
    }

    /// Whether the attitude is unknown, or not yet as good as it will be.
    pub(super) const fn is_aligning(&self) -> bool {
        self.after_gap.is_some() || self.aligning
    }

    /// The hole before this sample is too long.
    pub(super) fn lose(&mut self, sample: &ImuIncrement) -> Advance {
        self.settle();
        self.strapdown.forget();
        self.delay.forget_motion();
        self.begin_after_gap();
        self.listen(sample)
    }

    /// A new filter without an attitude: it listens from the first sample on, and has its position already.
    pub(super) fn begin_after_gap(&mut self) {
        self.aligning = true;
        for k in 0..3 {
            self.joint.reset(PHI + k, ANY_ANGLE_RAD2);
        }
        let zero = Vector3::zeros();
        self.after_gap = Some(AfterGap { heard: self.time(), listened_s: 0.0, force: zero, rate: zero });
    }

    /// A good sample while after_gap.
    pub(super) fn listen(&mut self, sample: &ImuIncrement) -> Advance {
        let Some(mut after_gap) = self.after_gap else { return Advance::Late };
        let since_s = sample.time.seconds_since(after_gap.heard);
        if !(since_s > 0.0) {
            return Advance::Late;
        }
        let aided = after_gap.heard == self.time();
        let whole = since_s - sample.interval_s <= 0.5 * sample.interval_s;
        if whole && aided && self.align(&after_gap) {
            return self.taken(sample, Advance::Done);
        }
        if !whole {
            after_gap.listened_s = 0.0;
        }
        let dt = sample.interval_s;
        let share = if after_gap.listened_s > 0.0 { (dt / LISTEN_S).min(1.0) } else { 1.0 };
        after_gap.force += share * (sample.velocity_mps / dt - self.biases[1] - after_gap.force);
        after_gap.rate += share * (sample.angle_rad / dt - self.biases[0] - after_gap.rate);
        after_gap.listened_s += dt;
        after_gap.heard = sample.time;
        self.after_gap = Some(after_gap);
        Advance::AfterGap { since_s: sample.time.seconds_since(self.time()) }
    }

    /// Attitude by weight and course, where both say something.
    fn align(&mut self, after_gap: &AfterGap) -> bool {
        let how = self.settings.resumption;
        let v = *self.state().velocity_ned_mps();
        let speed = hypot(v.x, v.y);
        let sigma = sqrt(self.joint.get(V, V) + self.joint.get(V + 1, V + 1));
        let known = speed >= COURSE_FROM_MPS && sigma <= how.course_share * speed;
        let turning = how.turning_most_radps + 3.0 * self.settings.imu.gyroscope.bias;
        if !(known && after_gap.listened_s >= LISTEN_S && after_gap.rate.norm() <= turning) {
            return false;
        }
        let Ok(attitude) = coarse(&after_gap.force, &v) else { return false };
        self.strapdown.state_mut().q = quaternion(&attitude);
        let (tilt, heading) = (how.tilt.rad(), hypot(how.heading.rad(), sigma / speed));
        for (k, sigma) in [tilt, tilt, heading].iter().enumerate() {
            self.joint.reset(PHI + k, sigma * sigma);
        }
        self.after_gap = None;
        true
    }

    /// Aligning ends when the tilt is as well known as the accelerometers allow.
    pub(super) fn watch_alignment(&mut self) {
        if self.aligning && self.after_gap.is_none() {
            let most = self.settings.resumption.settled.rad() + 3.0 * self.settings.imu.accelerometer.bias / GRAVITY;
            self.aligning = !(0..2).all(|k| self.joint.get(PHI + k, PHI + k) <= most * most);
        }
    }

    /// AfterGap, the last velocity carries the position to the last sample.
    pub(super) fn drift(&mut self) -> Result<(), OutOfDomain> {
        let Some(after_gap) = self.after_gap else { return Ok(()) };
        let dt = after_gap.heard.seconds_since(self.time());
        if !(dt > 0.0) {
            return Ok(());
        }
        let s = *self.state();
        let local = Local::at(s.lat, s.h, &s.v);
        let lat = s.lat + dt * s.v.x / local.north;
        check_latitude(lat)?;
        let state = self.strapdown.state_mut();
        (state.lat, state.lon, state.h) = (lat, wrapped(s.lon + dt * s.v.y / (local.east * local.cos)), s.h - dt * s.v.z);
        state.time = after_gap.heard;
        self.spread(dt);
        self.modes.tick(after_gap.heard);
        Ok(())
    }

    /// What the acceleration may have made of position and velocity: one that lasted all the time, tying both, and one that was another
    /// every second, after which the position does not tell the velocity.
    fn spread(&mut self, dt: f64) {
        let n = 1 + (dt / CHANGE_S - 0.5).clamp(0.0, PIECES_MOST) as u32;
        let piece = dt / f64::from(n);
        let (g, a) = (self.settings.imu.gyroscope, self.settings.imu.accelerometer);
        let half = StepNoise {
            velocity: 0.0,
            angle: 0.0,
            gyroscope: Fade::gauss_markov(g.bias, g.bias_time_s, 0.5 * piece),
            accelerometer: Fade::gauss_markov(a.bias, a.bias_time_s, 0.5 * piece),
        };
        let mut straight = [[0.0; LINE]; NAV];
        for k in 0..MOTION {
            straight[k][k] = 1.0;
        }
        for k in 0..3 {
            straight[V + k][R + k] = 0.5 * piece;
        }
        let acceleration = self.settings.resumption.acceleration_mps2;
        for k in 0..n {
            self.joint.propagate(&straight, &half);
            let lasting = if k == n / 2 { acceleration * dt } else { 0.0 };
            let changing = acceleration * acceleration * piece * piece.min(CHANGE_S);
            for axis in 0..3 {
                self.joint.add_variance(V + axis, lasting * lasting + changing);
            }
            self.joint.propagate(&straight, &half);
            for (bias, fade) in self.biases.iter_mut().zip([half.gyroscope, half.accelerometer]) {
                *bias *= fade.factor * fade.factor;
            }
        }
    }
}
