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
        let mut reported = sample;
        for fault in &self.faults {
            let Some(since_s) = fault.since(time_s) else { continue };
            felt(fault, since_s, &mut reported, &mut self.noise, &self.densities);
        }
        let trouble = self.faults.iter().find_map(|f| f.trouble(time_s));
        let mut delivered = trouble.map_or(Some(reported), |what| troubled(what, index, reported, self.last));
        if let Some(delivered) = &mut delivered {
            delivered.time = delivered.time.plus_seconds(self.faults.iter().map(|f| clock_s(f, time_s)).sum());
        }
        self.last = delivered.or(self.last);
        delivered
    }
}

fn felt(fault: &SensorFault, since_s: f64, reported: &mut ImuIncrement, noise: &mut [Stream; 2], densities: &[f64; 2]) {
    let dt = reported.interval_s;
    let mut add = |gyro: [f64; 3], accelerometer: [f64; 3], share: f64| {
        reported.angle_rad += Vector3::from(gyro) * (share * dt);
        reported.velocity_mps += Vector3::from(accelerometer) * (share * dt);
    };
    match fault {
        SensorFault::ImuPulse { gyro_radps, accelerometer_mps2, .. } => add(*gyro_radps, *accelerometer_mps2, 1.0),
        SensorFault::ImuRamp { gyro_radps2, accelerometer_mps3, .. } => add(*gyro_radps2, *accelerometer_mps3, since_s),
        SensorFault::ImuScale { gyro, accelerometer, .. } => {
            reported.angle_rad *= 1.0 + gyro;
            reported.velocity_mps *= 1.0 + accelerometer;
        }
        SensorFault::ImuNoise { factor, .. } => {
            let more = (factor * factor - 1.0).max(0.0).sqrt() * dt.sqrt();
            let mut white = |k: usize| Vector3::from_fn(|_, _| noise[k].normal()) * (densities[k] * more);
            reported.angle_rad += white(0);
            reported.velocity_mps += white(1);
        }
        SensorFault::ImuClip { gyro_radps, accelerometer_mps2, .. } => {
            reported.angle_rad.apply(|x| *x = x.clamp(-gyro_radps * dt, gyro_radps * dt));
            reported.velocity_mps.apply(|x| *x = x.clamp(-accelerometer_mps2 * dt, accelerometer_mps2 * dt));
        }
        _ => {}
    }
}

fn troubled(what: Trouble, index: u64, reported: ImuIncrement, last: Option<ImuIncrement>) -> Option<ImuIncrement> {
    let before = last.unwrap_or(reported);
    let second = index % 2 == 1;
    let mut delivered = reported;
    match what {
        Trouble::Silent => return None,
        Trouble::Lost if second => return None,
        Trouble::Repeated if second => return Some(before),
        Trouble::Lost | Trouble::Repeated => {}
        Trouble::NotANumber => delivered.angle_rad.x = f64::NAN,
        Trouble::Late => delivered.time = reported.time.plus_seconds(-1.0),
        Trouble::Zeros => (delivered.angle_rad, delivered.velocity_mps) = (Vector3::zeros(), Vector3::zeros()),
        Trouble::FrozenAccelerometers => delivered.velocity_mps = before.velocity_mps,
        Trouble::FrozenGyroscopes => delivered.angle_rad = before.angle_rad,
        Trouble::Frozen => (delivered.angle_rad, delivered.velocity_mps) = (before.angle_rad, before.velocity_mps),
        Trouble::SwappedAxes => {
            delivered.angle_rad.swap_rows(0, 1);
            delivered.velocity_mps.swap_rows(0, 1);
        }
        Trouble::Reversed => delivered.time = reported.time.plus_seconds(if second { -reported.interval_s } else { reported.interval_s }),
    }
    Some(delivered)
}

fn clock_s(fault: &SensorFault, time_s: f64) -> f64 {
    match (fault, fault.since(time_s)) {
        (SensorFault::ImuClock { offset_s, drift, .. }, Some(since_s)) => offset_s + drift * since_s,
        _ => 0.0,
    }
}
