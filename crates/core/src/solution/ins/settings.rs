//! What is declared to the filter: noise of the sensors, first uncertainty, gates, patience.

use super::after_gap::Resumption;
use super::state::finite;
use crate::quantity::{Metres, OutOfDomain, Radians, Risk};
use nalgebra::Vector3;

/// White noise and a first-order Gauss-Markov bias, of each axis alike.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SensorNoise {
    /// Root of the power density of the white part: rad/sqrt(s) of a gyroscope (angle random walk), m/s/sqrt(s) of an accelerometer.
    pub white: f64,
    /// Standard deviation of the bias \[rad/s or m/s²\].
    pub bias: f64,
    /// Its correlation time \[s\].
    pub bias_time_s: f64,
}

/// The inertial unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImuModel {
    /// Gyroscopes.
    pub gyroscope: SensorNoise,
    /// Accelerometers.
    pub accelerometer: SensorNoise,
}

impl ImuModel {
    /// The unit of Dai 2022 as far as it is printed (0.01 deg/h, 1e-4 g), the rest ours: 0.002 deg/sqrt(h), 10 ug/sqrt(Hz), 3600 s.
    /// Provenance: biases printed; white noise and correlation time ours.
    pub const NAVIGATION: Self = Self {
        gyroscope: SensorNoise { white: 0.002 / 60.0 * RAD_PER_DEG, bias: 0.01 / 3600.0 * RAD_PER_DEG, bias_time_s: 3600.0 },
        accelerometer: SensorNoise { white: 10e-6 * STANDARD_GRAVITY, bias: 1e-4 * STANDARD_GRAVITY, bias_time_s: 3600.0 },
    };
}

const RAD_PER_DEG: f64 = core::f64::consts::PI / 180.0;
/// Conventional standard gravity \[m/s²\].
const STANDARD_GRAVITY: f64 = 9.806_65;

/// Standard deviations at the start; the biases start with those of [`ImuModel`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StartSigma {
    /// Position north, east, down.
    pub position: [Metres; 3],
    /// Velocity of each axis \[m/s\].
    pub velocity_mps: f64,
    /// Misalignment about north, east, down.
    pub attitude: [Radians; 3],
}

impl Default for StartSigma {
    /// 10, 10, 15 m; 0.2 m/s; 5e-5, 5e-5, 5e-4 rad (ours, of the platform's specification).
    fn default() -> Self {
        Self {
            position: [Metres::new(10.0), Metres::new(10.0), Metres::new(15.0)],
            velocity_mps: 0.2,
            attitude: [Radians::new(5e-5), Radians::new(5e-5), Radians::new(5e-4)],
        }
    }
}

/// Receiver clock and the biases between constellations, as lengths.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClockModel {
    /// Standard deviation of the bias after the first range has set it \[m\]: so wide that it forgets where the first range put it.
    pub bias_m: f64,
    /// Standard deviation of the drift at the start \[m/s\].
    pub drift_mps: f64,
    /// Power density of white frequency noise \[m²/s\] and of its random walk \[m²/s³\].
    pub frequency_m2ps: f64,
    /// See [`ClockModel::frequency_m2ps`].
    pub walk_m2ps3: f64,
    /// Standard deviation of an inter-system bias \[m\], constant over the flight.
    pub inter_system_m: f64,
}

impl Default for ClockModel {
    /// A temperature-compensated crystal, h0 = 2e-19 s, h-2 = 2e-20 /s (inferred: Brown and Hwang's class):
    /// c² h0/2 and 2 pi² c² h-2.
    fn default() -> Self {
        Self { bias_m: 1e4, drift_mps: 100.0, frequency_m2ps: 0.009, walk_m2ps3: 0.0355, inter_system_m: 100.0 }
    }
}

/// Which error model the filter believes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ErrorModel {
    /// What stays has a state of its own: a bias for each satellite, station and the barometer.
    Correlated,
    /// Everything is taken for new at each measurement. Shipped to show that it fails: its covariance is far too small.
    White,
}

/// How measurements and inertial unit come together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// One filter with every range, and a state for what stays in each.
    Tight,
    /// The ranges of an instant are solved to a position and a velocity first, and these aid the filter.
    Loose,
    /// A filter for the satellites and one for the stations and the altimeter, and a master that joins what they say.
    Federated,
}

impl Form {
    /// Every form, in the order in which they are named.
    pub const ALL: [Self; 3] = [Self::Tight, Self::Loose, Self::Federated];
}

/// How long a kind of aiding must be there, or be missed, before the mode follows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Patience {
    /// Time without it before the mode falls back \[s\].
    pub lose_s: f64,
    /// Time with it, unbroken, before the mode goes up \[s\].
    pub gain_s: f64,
}

/// Everything declared to the filter at the start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// The inertial unit.
    pub imu: ImuModel,
    /// The receiver's clock.
    pub clock: ClockModel,
    /// What is believed of the errors.
    pub errors: ErrorModel,
    /// How measurements and inertial unit come together.
    pub form: Form,
    /// Whether a filter without satellites runs beside the main one. The federated form has one always.
    pub reversion: bool,
    /// Risk, at an instant, of saying that both disagree when both are right.
    pub separation: Risk,
    /// From the inertial unit to the antenna, body axes \[m\].
    pub lever_arm_m: Vector3<f64>,
    /// Risk of throwing away a good measurement, per measurement.
    pub gate: Risk,
    /// Samples that share one step of the covariance; 1 is a step at every sample.
    pub samples_per_step: u32,
    /// Longest hole between samples that is bridged \[s\].
    pub gap_most_s: f64,
    /// Standard deviation of the acceleration and of the rate that a hole hides \[m/s², rad/s\].
    pub gap_acceleration_mps2: f64,
    /// See [`Settings::gap_acceleration_mps2`].
    pub gap_rate_radps: f64,
    /// Oldest measurement that is still used, against the last sample \[s\].
    pub age_most_s: f64,
    /// Time after which an unseen satellite counts as set and its bias is forgotten \[s\].
    pub set_after_s: f64,
    /// Of the mode.
    pub patience: Patience,
    /// After a hole that is not bridged.
    pub resumption: Resumption,
}

impl Settings {
    /// For an inertial unit, everything else as a transport aircraft has it (ours).
    pub fn of(imu: ImuModel) -> Self {
        Self {
            imu,
            clock: ClockModel::default(),
            errors: ErrorModel::Correlated,
            form: Form::Tight,
            reversion: false,
            separation: Risk::SEPARATION,
            lever_arm_m: Vector3::zeros(),
            gate: GATE,
            samples_per_step: 1,
            gap_most_s: 1.0,
            gap_acceleration_mps2: 1.0,
            gap_rate_radps: 0.1,
            age_most_s: 0.2,
            set_after_s: 60.0,
            patience: Patience { lose_s: 5.0, gain_s: 10.0 },
            resumption: Resumption::USUAL,
        }
    }

    /// # Errors
    /// [`OutOfDomain`] naming the first setting that is none.
    pub fn check(&self) -> Result<(), OutOfDomain> {
        for (name, unit, value) in [
            ("gyroscope_white", "rad/sqrt(s)", self.imu.gyroscope.white),
            ("gyroscope_bias", "rad/s", self.imu.gyroscope.bias),
            ("gyroscope_bias_time_s", "s", self.imu.gyroscope.bias_time_s),
            ("accelerometer_white", "m/s/sqrt(s)", self.imu.accelerometer.white),
            ("accelerometer_bias", "m/s²", self.imu.accelerometer.bias),
            ("accelerometer_bias_time_s", "s", self.imu.accelerometer.bias_time_s),
            ("clock_bias_m", "m", self.clock.bias_m),
            ("clock_drift_mps", "m/s", self.clock.drift_mps),
            ("clock_frequency_m2ps", "m²/s", self.clock.frequency_m2ps),
            ("clock_walk_m2ps3", "m²/s³", self.clock.walk_m2ps3),
            ("inter_system_m", "m", self.clock.inter_system_m),
            ("gap_most_s", "s", self.gap_most_s),
            ("gap_acceleration_mps2", "m/s²", self.gap_acceleration_mps2),
            ("gap_rate_radps", "rad/s", self.gap_rate_radps),
            ("age_most_s", "s", self.age_most_s),
            ("set_after_s", "s", self.set_after_s),
            ("lose_s", "s", self.patience.lose_s),
            ("gain_s", "s", self.patience.gain_s),
        ] {
            positive(name, value, unit)?;
        }
        if self.samples_per_step == 0 {
            return Err(OutOfDomain { argument: "samples_per_step", value: 0.0, unit: "1", domain: "[1, inf)" });
        }
        self.resumption.check()?;
        self.lever_arm_m.iter().try_for_each(|x| finite("lever_arm_m", *x, "m"))
    }
}

pub(super) fn positive(argument: &'static str, value: f64, unit: &'static str) -> Result<(), OutOfDomain> {
    if !(value > 0.0 && value.is_finite()) {
        return Err(OutOfDomain { argument, value, unit, domain: "(0, inf)" });
    }
    Ok(())
}

/// One good measurement in ten thousand is lost. Provenance: ours, of the platform's specification.
pub const GATE: Risk = Risk::FILTER_GATE;
