//! The navigation filter on board: the `[filter]` part of a scenario, and what is declared to it of the sensors.
//!
//! Declared is what a maker would declare, the standard deviations and correlation times of the `[sensors]` part, and never what was drawn.

use crate::philox::{Sensor, Stream};
use crate::plan::GRAVITY;
use crate::scenario::{Rule, positive, within};
use crate::sensors::{Imu, Sensors, correlated_error};
use navbound_core::bound::araim::single::Requirement;
use navbound_core::monitor::guard;
use navbound_core::quantity::{Metres, OutOfDomain, Radians, Risk};
use navbound_core::solution::ins::{ClockModel, ErrorModel, Form, ImuModel, SensorNoise, Settings, StartSigma};
use serde::Deserialize;

/// Standard deviation of the age of the ranges \[s\]: simulated receivers have a pulse of the second. Provenance: inferred.
const AGE_SIGMA_S: f64 = 1e-3;

/// A filter that joins the sensors.
#[derive(Debug, Clone, Copy, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Navigator {
    /// What it believes of errors that stay.
    pub mode: BelievedErrors,
    /// How ranges and inertial unit come together.
    pub form: Coupling,
    /// Whether a filter without satellites runs beside the main one; the federated form has one always.
    pub reversion: bool,
    /// Risk, at an instant, of saying that both disagree when both are right.
    pub separation_risk: f64,
    /// Risk of throwing away a good measurement.
    pub gate_risk: f64,
    /// Inertial samples that share a step of the covariance.
    pub samples_per_step: u32,
    /// Time for which satellites that agree among each other must contradict the filter, and the inertial unit be plausible, before it is
    /// started anew \[s\].
    pub restart_after_s: f64,
    /// How many times as far as declared the start is off: position, tilt, heading.
    #[serde(default = "as_declared")]
    pub start_factor: [f64; 3],
    /// Deviations of the inertial unit as declared to the filter over those of the `[sensors]` part.
    #[serde(default = "one")]
    pub unit_factor: f64,
    /// Standard deviations of the start: position north, east, down \[m\],
    pub position_sigma_m: [f64; 3],
    /// velocity of each axis \[m/s\],
    pub velocity_sigma_mps: f64,
    /// and misalignment about north, east, down \[rad\].
    pub attitude_sigma_rad: [f64; 3],
}

fn one() -> f64 {
    1.0
}

fn as_declared() -> [f64; 3] {
    [1.0; 3]
}

/// What a filter believes of errors that stay.
#[derive(Debug, Clone, Copy, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum BelievedErrors {
    /// They stay: each has a state.
    Correlated,
    /// All is new at each measurement. Shipped to show that it fails.
    White,
}

/// How ranges and inertial unit come together.
#[derive(Debug, Clone, Copy, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum Coupling {
    /// Every range into one filter.
    Tight,
    /// Positions solved from the ranges of an instant.
    Loose,
    /// A filter for the satellites, one for the rest, and a master.
    Federated,
}

impl Navigator {
    pub(crate) fn rules(&self, sensors: bool, faults: usize) -> Vec<Rule> {
        let mut rules = vec![
            Rule("filter", 0.0, "tables", sensors, "a scenario with a [sensors] part"),
            Rule("faults", faults as f64, "items", faults == 0, "none with a [filter]: sensors fail, [[sensors.faults]]"),
            within("separation_risk", self.separation_risk, "1", 1e-15, 0.1, "[1e-15, 0.1]"),
            within("gate_risk", self.gate_risk, "1", 1e-12, 0.1, "[1e-12, 0.1]"),
            within("samples_per_step", f64::from(self.samples_per_step), "samples", 1.0, 200.0, "[1, 200]"),
            within("unit_factor", self.unit_factor, "1", 1e-3, 1e3, "[0.001, 1000]"),
            positive("restart_after_s", self.restart_after_s, "s"),
            positive("velocity_sigma_mps", self.velocity_sigma_mps, "m/s"),
        ];
        rules.extend(self.start_factor.map(|f| within("start_factor", f, "1", 0.0, 100.0, "[0, 100]")));
        rules.extend(self.position_sigma_m.map(|s| positive("position_sigma_m", s, "m")));
        rules.extend(self.attitude_sigma_rad.map(|s| within("attitude_sigma_rad", s, "rad", 1e-9, 0.2, "[1e-9, 0.2]")));
        rules
    }

    /// What is declared to the filter.
    ///
    /// # Errors
    /// [`OutOfDomain`] for a gate that is no risk.
    pub fn settings(&self, sensors: &Sensors) -> Result<Settings, OutOfDomain> {
        let mut settings = Settings::of(times(imu_model(&sensors.imu), self.unit_factor));
        settings.gate = Risk::new(self.gate_risk)?;
        settings.samples_per_step = self.samples_per_step;
        settings.form = match self.form {
            Coupling::Tight => Form::Tight,
            Coupling::Loose => Form::Loose,
            Coupling::Federated => Form::Federated,
        };
        settings.reversion = self.reversion;
        settings.separation = Risk::new(self.separation_risk)?;
        settings.errors = match self.mode {
            BelievedErrors::Correlated => ErrorModel::Correlated,
            BelievedErrors::White => ErrorModel::White,
        };
        if let Some(g) = &sensors.gnss {
            settings.clock = ClockModel {
                drift_mps: g.drift_sigma_mps,
                frequency_m2ps: g.clock_density_m2ps,
                walk_m2ps3: g.drift_density_m2ps3,
                inter_system_m: g.system_bias_sigma_m,
                ..ClockModel::default()
            };
        }
        Ok(settings)
    }

    /// How wrong the start may be, as it is declared to the filter.
    pub fn start_sigma(&self) -> StartSigma {
        StartSigma {
            position: self.position_sigma_m.map(Metres::new),
            velocity_mps: self.velocity_sigma_mps,
            attitude: self.attitude_sigma_rad.map(Radians::new),
        }
    }

    /// What stands beside the filter: a snapshot with RAIM of en route to non-precision approach, and what is declared of the unit.
    pub fn guard(&self, sensors: &Sensors, filter: &Settings) -> guard::Settings {
        let envelope = sensors.envelope.map_or(guard::Envelope::NONE, |e| guard::Envelope {
            range: [e.force_range_mps2, e.rate_range_radps],
            most: [e.force_most_mps2, e.rate_most_radps],
            change_mps3: e.force_change_mps3,
            // Noise above the resolution, in both triads.
            never_repeats: sensors.imu.gyro_noise_radprts > 0.0 && sensors.imu.accelerometer_noise_mpsprts > 0.0,
        });
        guard::Settings {
            envelope,
            requirement: Requirement::RAIM,
            age_sigma_s: AGE_SIGMA_S,
            gap_most_s: filter.gap_most_s,
            age_most_s: filter.age_most_s,
            restart_after_s: self.restart_after_s,
        }
    }

    /// How wrong it is on a flight, in those standard deviations: position, velocity, misalignment.
    pub fn start_normals(&self, seed: u64, number: u64) -> [f64; 9] {
        let mut stream = Stream::new(seed, number, Sensor::FilterStart);
        let [position, tilt, heading] = self.start_factor;
        let factors = [position, position, position, 1.0, 1.0, 1.0, tilt, tilt, heading];
        factors.map(|factor| factor * stream.normal())
    }
}

/// One Gauss-Markov bias an axis stands for everything that stays: turn-on and in-run bias, and what scale factor and misalignment make of
/// the weight, which is most of the specific force of an aeroplane.
fn imu_model(imu: &Imu) -> ImuModel {
    let weight = GRAVITY * imu.accelerometer_scale.max(imu.accelerometer_misalignment_rad);
    let [gyro, accelerometer] = [imu.gyro_bias_radps, imu.accelerometer_bias_mps2.hypot(weight)];
    ImuModel {
        gyroscope: noise(imu.gyro_noise_radprts, gyro, imu.gyro_in_run_radps, imu.in_run_time_s),
        accelerometer: noise(imu.accelerometer_noise_mpsprts, accelerometer, imu.accelerometer_in_run_mps2, imu.in_run_time_s),
    }
}

/// With all deviations multiplied.
fn times(model: ImuModel, factor: f64) -> ImuModel {
    let by = |n: SensorNoise| SensorNoise { white: n.white * factor, bias: n.bias * factor, ..n };
    ImuModel { gyroscope: by(model.gyroscope), accelerometer: by(model.accelerometer) }
}

fn noise(white: f64, constant: f64, process: f64, time_s: f64) -> SensorNoise {
    let (bias, bias_time_s) = correlated_error(constant, process, time_s);
    SensorNoise { white, bias, bias_time_s }
}
