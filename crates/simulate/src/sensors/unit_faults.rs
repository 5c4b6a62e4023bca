//! What declared faults make of the samples of the inertial unit.

use super::faults::{SensorFault, Trouble};
use super::settings::Imu;
use crate::philox::{Sensor, Stream};
use nalgebra::Vector3;
use navbound_core::signal::ImuIncrement;

/// Unit of the streams of added noise: no axis has it.
const ADDED: u64 = 17;

/// The faults of a unit under way.
pub(crate) struct UnitFaults {
    faults: Vec<SensorFault>,
    noise: [Stream; 2],
    densities: [f64; 2],
    /// The last sample that was delivered.
    last: Option<ImuIncrement>,
}

impl UnitFaults {
    pub(crate) fn new(imu: &Imu, faults: &[SensorFault], seed: u64, flight: u64) -> Self {
        let own = |f: &&SensorFault| {
            use SensorFault::{ImuClip, ImuClock, ImuNoise, ImuPulse, ImuRamp, ImuScale, ImuTrouble};
            matches!(
                f,
                ImuTrouble { .. } | ImuClip { .. } | ImuClock { .. } | ImuNoise { .. } | ImuPulse { .. } | ImuRamp { .. } | ImuScale { .. }
            )
        };
        let stream = |sensor| Stream::of_unit(seed, flight, sensor, ADDED);
        Self {
            faults: faults.iter().filter(own).cloned().collect(),
            noise: [stream(Sensor::Gyro), stream(Sensor::Accelerometer)],
            densities: [imu.gyro_noise_radprts, imu.accelerometer_noise_mpsprts],
            last: None,
        }
    }

    /// What is delivered of a sample, if anything. Analogue faults come first, then those of the digital part, then the clock.
    pub(crate) fn delivered(&mut self, index: u64, time_s: f64, sample: ImuIncrement) -> Option<ImuIncrement> {
        if self.faults.is_empty() {
            return Some(sample);
        }
        let mut said = sample;
        for fault in &self.faults {
            let Some(since_s) = fault.since(time_s) else { continue };
            felt(fault, since_s, &mut said, &mut self.noise, &self.densities);
        }
        let trouble = self.faults.iter().find_map(|f| f.trouble(time_s));
        let mut given = trouble.map_or(Some(said), |what| troubled(what, index, said, self.last));
        if let Some(given) = &mut given {
            given.time = given.time.plus_seconds(self.faults.iter().map(|f| clock_s(f, time_s)).sum());
        }
        self.last = given.or(self.last);
        given
    }
}

fn felt(fault: &SensorFault, since_s: f64, said: &mut ImuIncrement, noise: &mut [Stream; 2], densities: &[f64; 2]) {
    let dt = said.interval_s;
    let mut add = |gyro: [f64; 3], accelerometer: [f64; 3], share: f64| {
        said.angle_rad += Vector3::from(gyro) * (share * dt);
        said.velocity_mps += Vector3::from(accelerometer) * (share * dt);
    };
    match fault {
        SensorFault::ImuPulse { gyro_radps, accelerometer_mps2, .. } => add(*gyro_radps, *accelerometer_mps2, 1.0),
        SensorFault::ImuRamp { gyro_radps2, accelerometer_mps3, .. } => add(*gyro_radps2, *accelerometer_mps3, since_s),
        SensorFault::ImuScale { gyro, accelerometer, .. } => {
            said.angle_rad *= 1.0 + gyro;
            said.velocity_mps *= 1.0 + accelerometer;
        }
        SensorFault::ImuNoise { factor, .. } => {
            let more = (factor * factor - 1.0).max(0.0).sqrt() * dt.sqrt();
            let mut white = |k: usize| Vector3::from_fn(|_, _| noise[k].normal()) * (densities[k] * more);
            said.angle_rad += white(0);
            said.velocity_mps += white(1);
        }
        SensorFault::ImuClip { gyro_radps, accelerometer_mps2, .. } => {
            said.angle_rad.apply(|x| *x = x.clamp(-gyro_radps * dt, gyro_radps * dt));
            said.velocity_mps.apply(|x| *x = x.clamp(-accelerometer_mps2 * dt, accelerometer_mps2 * dt));
        }
        _ => {}
    }
}

fn troubled(what: Trouble, index: u64, said: ImuIncrement, last: Option<ImuIncrement>) -> Option<ImuIncrement> {
    let before = last.unwrap_or(said);
    let second = index % 2 == 1;
    let mut given = said;
    match what {
        Trouble::Silent => return None,
        Trouble::Lost if second => return None,
        Trouble::Repeated if second => return Some(before),
        Trouble::Lost | Trouble::Repeated => {}
        Trouble::NotANumber => given.angle_rad.x = f64::NAN,
        Trouble::Late => given.time = said.time.plus_seconds(-1.0),
        Trouble::Zeros => (given.angle_rad, given.velocity_mps) = (Vector3::zeros(), Vector3::zeros()),
        Trouble::FrozenAccelerometers => given.velocity_mps = before.velocity_mps,
        Trouble::FrozenGyroscopes => given.angle_rad = before.angle_rad,
        Trouble::Frozen => (given.angle_rad, given.velocity_mps) = (before.angle_rad, before.velocity_mps),
        Trouble::SwappedAxes => {
            given.angle_rad.swap_rows(0, 1);
            given.velocity_mps.swap_rows(0, 1);
        }
        Trouble::Reversed => given.time = said.time.plus_seconds(if second { -said.interval_s } else { said.interval_s }),
    }
    Some(given)
}

fn clock_s(fault: &SensorFault, time_s: f64) -> f64 {
    match (fault, fault.since(time_s)) {
        (SensorFault::ImuClock { offset_s, drift, .. }, Some(since_s)) => offset_s + drift * since_s,
        _ => 0.0,
    }
}
