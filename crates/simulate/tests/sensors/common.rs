//! A short flight with every sensor.

use navbound_core::quantity::GpsTime;
use navbound_core::signal::{Aiding, PhaseRange, TimedAiding};
use navbound_simulate::{Imu, Scenario, Sensing, Step, Trajectory};

/// Begin of the flight.
pub(crate) const BEGIN_NS: i64 = 1_343_347_200_000_000_000;

/// Fifteen minutes from A to D, all errors as in `sensors.json`.
pub(crate) fn scenario() -> Scenario {
    let mut scenario: Scenario = serde_json::from_str(include_str!("../scenario.json")).unwrap();
    scenario.sensors = Some(serde_json::from_str(include_str!("../sensors.json")).unwrap());
    scenario
}

/// Sensors and the path they ride along.
pub(crate) struct Rig {
    pub(crate) sensing: Sensing,
    pub(crate) trajectory: Trajectory,
}

/// The same at ten samples a second, changed; along the path of flight 1, which is that of every flight unless it is flown.
pub(crate) fn rig(change: impl FnOnce(&mut navbound_simulate::Sensors)) -> Rig {
    let mut scenario = scenario();
    let sensors = scenario.sensors.as_mut().unwrap();
    sensors.rate_hz = 10;
    change(sensors);
    let sensing = Sensing::new(scenario, None).unwrap();
    let trajectory = sensing.trajectory(7, 1).unwrap();
    Rig { sensing, trajectory }
}

/// An inertial unit without errors.
pub(crate) fn perfect() -> Imu {
    Imu {
        gyro_bias_radps: 0.0,
        gyro_in_run_radps: 0.0,
        gyro_noise_radprts: 0.0,
        gyro_scale: 0.0,
        gyro_misalignment_rad: 0.0,
        accelerometer_bias_mps2: 0.0,
        accelerometer_in_run_mps2: 0.0,
        accelerometer_noise_mpsprts: 0.0,
        accelerometer_scale: 0.0,
        accelerometer_misalignment_rad: 0.0,
        in_run_time_s: 3600.0,
    }
}

/// Everything of a sample.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Sample {
    pub(crate) step: Step,
    pub(crate) aiding: Vec<TimedAiding>,
    pub(crate) phases: Vec<PhaseRange>,
    pub(crate) clock: Option<[f64; 2]>,
}

impl Sample {
    /// Time after the begin of the flight \[s\].
    pub(crate) fn since(&self) -> f64 {
        self.step.imu.time.seconds_since(GpsTime::from_nanoseconds(BEGIN_NS))
    }
    pub(crate) fn of<'a, T>(&'a self, pick: impl Fn(&'a Aiding) -> Option<T>) -> Vec<T> {
        self.aiding.iter().filter_map(|a| pick(&a.aiding)).collect()
    }
}

/// The first `seconds` of a flight; samples with measurements only.
pub(crate) fn fly(rig: &Rig, number: u64, seconds: u64) -> Vec<Sample> {
    all(rig, number, seconds).into_iter().filter(|s| !s.aiding.is_empty()).collect()
}

/// Every sample.
pub(crate) fn all(rig: &Rig, number: u64, seconds: u64) -> Vec<Sample> {
    let mut flight = rig.sensing.flight(&rig.trajectory, 7, number).unwrap();
    let samples = (seconds * u64::from(rig.sensing.sensors().rate_hz)).min(flight.samples());
    let next = |_| {
        let step = flight.advance().unwrap().unwrap();
        Sample { step, aiding: flight.aiding().to_vec(), phases: flight.phases().to_vec(), clock: flight.clock() }
    };
    (0..samples).map(next).collect()
}

/// That a sum of squares of `n` independent numbers of unit variance is what it should be: four standard errors of a chi-square.
pub(crate) fn assert_unit_variance(squares: impl IntoIterator<Item = f64>, what: &str) {
    let squares: Vec<f64> = squares.into_iter().collect();
    let n = squares.len() as f64;
    let mean = squares.iter().sum::<f64>() / n;
    assert!(n > 50.0 && (mean - 1.0).abs() < 4.0 * (2.0 / n).sqrt(), "{what}: {mean} of {n}");
}
