//! The inertial unit: exact increments of the true motion, and what its errors make of them.
//!
//! ```text
//! integral over (t, t + s) of f = s/24 (-f(t - s) + 13 f(t) + 13 f(t + s) - f(t + 2 s))        fourth order
//! measured = (1 + scale + misalignment) true + (turn-on + in-run + jump) s + N sqrt(s) n
//! ```
//!
//! The in-run bias is a first-order Gauss-Markov process that takes one step a second and is held in between: with correlation times of an
//! hour a step is a sixtieth of its deviation.

use super::faults::SensorFault;
use super::markov::Markov;
use super::settings::Imu;
use crate::philox::{Sensor, Stream};
use crate::trajectory::{Cursor, Motion, Trajectory};
use nalgebra::{Matrix3, Vector3};
use navbound_core::quantity::{GpsTime, OutOfDomain};
use navbound_core::signal::ImuIncrement;

/// True increments, sample by sample.
pub(crate) struct TrueIncrements<'a> {
    cursor: Cursor<'a>,
    interval_s: f64,
    /// Motions one sample before the begin of the next interval, at its begin, at its end, one sample after.
    around: [Motion; 4],
    /// Index of the sample at the end of the next interval.
    next: u64,
}

impl<'a> TrueIncrements<'a> {
    pub(crate) fn new(trajectory: &'a Trajectory, rate_hz: u32) -> Result<Self, OutOfDomain> {
        let mut cursor = trajectory.cursor();
        let interval_s = 1.0 / f64::from(rate_hz);
        let around = [cursor.at(-interval_s)?, cursor.at(0.0)?, cursor.at(interval_s)?, cursor.at(2.0 * interval_s)?];
        Ok(Self { cursor, interval_s, around, next: 1 })
    }

    /// The motion at the begin of the next interval.
    pub(crate) fn now(&self) -> &Motion {
        &self.around[1]
    }

    /// Angle and velocity increments up to the next sample, and the motion there.
    pub(crate) fn step(&mut self) -> Result<(Vector3<f64>, Vector3<f64>, Motion), OutOfDomain> {
        let [a, b, c, d] = &self.around;
        let sum =
            |p: &Vector3<f64>, q: &Vector3<f64>, r: &Vector3<f64>, s: &Vector3<f64>| (13.0 * (q + r) - (p + s)) * (self.interval_s / 24.0);
        let angle = sum(&a.rate_radps, &b.rate_radps, &c.rate_radps, &d.rate_radps);
        let velocity = sum(&a.force_mps2, &b.force_mps2, &c.force_mps2, &d.force_mps2);
        let end = *c;
        self.next += 1;
        self.around = [*b, *c, *d, self.cursor.at((self.next + 1) as f64 * self.interval_s)?];
        Ok((angle, velocity, end))
    }
}

/// Three gyroscopes or three accelerometers.
struct Triad {
    /// Scale and misalignment, without the one.
    distortion: Matrix3<f64>,
    turn_on: Vector3<f64>,
    in_run: [Markov; 3],
    in_run_sigma: f64,
    /// Turn-on, in-run and declared jumps together.
    bias: Vector3<f64>,
    noise: Stream,
    noise_density: f64,
    /// The second number of a pair.
    spare: Option<f64>,
}

struct TriadErrors {
    bias: f64,
    in_run: f64,
    noise_density: f64,
    scale: f64,
    misalignment: f64,
    in_run_time_s: f64,
}

impl Triad {
    fn new(errors: &TriadErrors, seed: u64, flight: u64, constants: Sensor, run: Sensor) -> Self {
        let mut draw = Stream::new(seed, flight, constants);
        let turn_on = errors.bias * Vector3::from_fn(|_, _| draw.normal());
        let distortion = Matrix3::from_fn(|i, j| draw.normal() * if i == j { errors.scale } else { errors.misalignment });
        let in_run = [1, 2, 3].map(|axis| Markov::new(Stream::of_unit(seed, flight, run, axis), 1.0, errors.in_run_time_s));
        let noise = Stream::new(seed, flight, run);
        let (in_run_sigma, noise_density) = (errors.in_run, errors.noise_density);
        Self { distortion, turn_on, in_run, in_run_sigma, bias: Vector3::zeros(), noise, noise_density, spare: None }
    }

    fn set_bias(&mut self, jump: &Vector3<f64>) {
        self.bias = self.turn_on + jump + Vector3::from_fn(|i, _| self.in_run_sigma * self.in_run[i].now());
    }

    fn next_second(&mut self) {
        self.in_run.iter_mut().for_each(Markov::step);
    }

    fn white(&mut self) -> Vector3<f64> {
        let [a, b] = self.noise.normal_pair();
        if let Some(spare) = self.spare.take() {
            return Vector3::new(a, b, spare);
        }
        let [c, spare] = self.noise.normal_pair();
        self.spare = Some(spare);
        Vector3::new(a, b, c)
    }

    fn measured(&mut self, increment: &Vector3<f64>, interval_s: f64) -> Vector3<f64> {
        let white = self.white();
        increment + self.distortion * increment + self.bias * interval_s + white * (self.noise_density * interval_s.sqrt())
    }
}

/// An inertial unit with its errors.
pub(crate) struct InertialUnit {
    gyros: Triad,
    accelerometers: Triad,
    /// Samples a second.
    rate: u64,
    interval_s: f64,
    jumps: Vec<SensorFault>,
}

impl InertialUnit {
    pub(crate) fn new(imu: &Imu, rate_hz: u32, faults: &[SensorFault], seed: u64, flight: u64) -> Self {
        let gyro = TriadErrors {
            bias: imu.gyro_bias_radps,
            in_run: imu.gyro_in_run_radps,
            noise_density: imu.gyro_noise_radprts,
            scale: imu.gyro_scale,
            misalignment: imu.gyro_misalignment_rad,
            in_run_time_s: imu.in_run_time_s,
        };
        let accelerometer = TriadErrors {
            bias: imu.accelerometer_bias_mps2,
            in_run: imu.accelerometer_in_run_mps2,
            noise_density: imu.accelerometer_noise_mpsprts,
            scale: imu.accelerometer_scale,
            misalignment: imu.accelerometer_misalignment_rad,
            in_run_time_s: imu.in_run_time_s,
        };
        Self {
            gyros: Triad::new(&gyro, seed, flight, Sensor::GyroConstants, Sensor::Gyro),
            accelerometers: Triad::new(&accelerometer, seed, flight, Sensor::AccelerometerConstants, Sensor::Accelerometer),
            rate: u64::from(rate_hz),
            interval_s: 1.0 / f64::from(rate_hz),
            jumps: faults.iter().filter(|f| matches!(f, SensorFault::ImuBiasJump { .. })).cloned().collect(),
        }
    }

    /// What it delivers for the interval that ends with a sample.
    pub(crate) fn sample(&mut self, index: u64, time: GpsTime, angle: &Vector3<f64>, velocity: &Vector3<f64>) -> ImuIncrement {
        let second_begins = (index - 1).is_multiple_of(self.rate);
        if second_begins && index > 1 {
            self.gyros.next_second();
            self.accelerometers.next_second();
        }
        if second_begins || !self.jumps.is_empty() {
            self.set_biases((index - 1) as f64 * self.interval_s);
        }
        ImuIncrement {
            time,
            interval_s: self.interval_s,
            angle_rad: self.gyros.measured(angle, self.interval_s),
            velocity_mps: self.accelerometers.measured(velocity, self.interval_s),
        }
    }

    fn set_biases(&mut self, time_s: f64) {
        let (mut gyro, mut accelerometer) = (Vector3::zeros(), Vector3::zeros());
        for jump in &self.jumps {
            if let SensorFault::ImuBiasJump { gyro_radps, accelerometer_mps2, .. } = jump
                && jump.since(time_s).is_some()
            {
                gyro += Vector3::from(*gyro_radps);
                accelerometer += Vector3::from(*accelerometer_mps2);
            }
        }
        self.gyros.set_bias(&gyro);
        self.accelerometers.set_bias(&accelerometer);
    }
}
