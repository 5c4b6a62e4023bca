//! What sensors the aircraft carries and how well they work: the `[sensors]` part of a scenario, SI units.
//!
//! Nothing here has a default: every number stands in a scenario file, with where it comes from beside it.

use super::faults::SensorFault;
use crate::scenario::{Rule, System, not_negative, positive, within};
use serde::Deserialize;

/// The sensors of a flight.
#[derive(Debug, Clone, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Sensors {
    /// Which path they ride along.
    pub path: PathFlown,
    /// Samples a second of the inertial unit; a divisor of 10^9, so that times are whole nanoseconds.
    pub rate_hz: u32,
    /// Inertial unit.
    pub imu: Imu,
    /// What unit and vehicle are declared to be capable of.
    #[serde(default)]
    pub envelope: Option<Envelope>,
    /// Satellite receiver.
    #[serde(default)]
    pub gnss: Option<Gnss>,
    /// Interrogator of distance measuring equipment.
    #[serde(default)]
    pub dme: Option<Dme>,
    /// Receiver of VHF omnidirectional ranges.
    #[serde(default)]
    pub vor: Option<Vor>,
    /// Barometric altimeter.
    #[serde(default)]
    pub baro: Option<Baro>,
    /// Stations on the ground.
    #[serde(default)]
    pub stations: Vec<Station>,
    /// What goes wrong.
    #[serde(default)]
    pub faults: Vec<SensorFault>,
}

/// Which path the sensors ride along.
#[derive(Debug, Clone, Copy, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum PathFlown {
    /// The plan: no technical error.
    Planned,
    /// What the guidance made of it, with technical error and gusts, another for every flight.
    Flown,
}

/// Errors of an inertial unit; each axis draws its own.
#[derive(Debug, Clone, Copy, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Imu {
    /// Gyroscopes \[rad/s\].
    pub gyro_bias_radps: f64,
    /// Their in-run bias, first-order Gauss-Markov \[rad/s\].
    pub gyro_in_run_radps: f64,
    /// Angular random walk \[rad/√s\].
    pub gyro_noise_radprts: f64,
    /// Scale factor error.
    pub gyro_scale: f64,
    /// Misalignment of each axis towards the two others \[rad\].
    pub gyro_misalignment_rad: f64,
    /// Accelerometers \[m/s²\].
    pub accelerometer_bias_mps2: f64,
    /// Their in-run bias \[m/s²\].
    pub accelerometer_in_run_mps2: f64,
    /// Velocity random walk \[m/s/√s\].
    pub accelerometer_noise_mpsprts: f64,
    /// Scale factor error.
    pub accelerometer_scale: f64,
    /// Misalignment \[rad\].
    pub accelerometer_misalignment_rad: f64,
    /// Correlation time of the in-run biases \[s\].
    pub in_run_time_s: f64,
}

/// What the inertial unit can measure and the vehicle can do; beyond it the unit is not believed.
#[derive(Debug, Clone, Copy, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Envelope {
    /// Measuring range of an accelerometer \[m/s²\].
    pub force_range_mps2: f64,
    /// Of a gyroscope \[rad/s\].
    pub rate_range_radps: f64,
    /// Largest specific force of the vehicle along an axis \[m/s²\].
    pub force_most_mps2: f64,
    /// Largest rate \[rad/s\].
    pub rate_most_radps: f64,
    /// Largest change of the specific force over a tenth of a second \[m/s³\].
    pub force_change_mps3: f64,
}

/// A satellite receiver.
#[derive(Debug, Clone, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Gnss {
    /// Constellations in use.
    pub constellations: Vec<System>,
    /// Lowest elevation in use \[rad\].
    pub mask_rad: f64,
    /// Time between measurements \[s\].
    pub interval_s: f64,
    /// Which errors a code range has.
    pub mode: RangeMode,
    /// Standard deviation of a range in seed mode \[m\].
    pub seed_sigma_m: f64,
    /// Errors in real mode.
    pub parts: RangeParts,
    /// Standard deviation of a range rate \[m/s\].
    pub rate_sigma_mps: f64,
    /// Standard deviation of an accumulated carrier phase, its part of the multipath included \[m\].
    pub phase_sigma_m: f64,
    /// Receiver clock at the begin: standard deviation of its offset \[m\],
    pub clock_sigma_m: f64,
    /// and of its drift \[m/s\].
    pub drift_sigma_mps: f64,
    /// Spectral density of its white frequency noise \[m²/s\].
    pub clock_density_m2ps: f64,
    /// And of its frequency's random walk \[m²/s³\].
    pub drift_density_m2ps3: f64,
    /// Standard deviation of the bias of every constellation but the first \[m\].
    pub system_bias_sigma_m: f64,
}

/// Which errors a code range has.
#[derive(Debug, Clone, Copy, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum RangeMode {
    /// As the published example: white, the same for all.
    Seed,
    /// White noise, and parts that stay.
    Real,
}

/// Parts of a range error. All but the noise are first-order Gauss-Markov.
#[derive(Debug, Clone, Copy, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct RangeParts {
    /// White noise \[m\].
    pub noise_sigma_m: f64,
    /// Satellite clock and orbit \[m\],
    pub ranging_sigma_m: f64,
    /// and its correlation time \[s\].
    pub ranging_time_s: f64,
    /// Ionosphere's delay that is left, at the zenith \[m\]; each satellite its own.
    pub ionosphere_sigma_m: f64,
    /// Its correlation time \[s\].
    pub ionosphere_time_s: f64,
    /// Troposphere's delay that is left, at the zenith \[m\]; one for all satellites.
    pub troposphere_sigma_m: f64,
    /// Its correlation time \[s\].
    pub troposphere_time_s: f64,
    /// Share of the airborne multipath model that is applied.
    pub multipath_share: f64,
    /// Its correlation time \[s\].
    pub multipath_time_s: f64,
}

/// Ranges to DME stations.
#[derive(Debug, Clone, Copy, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Dme {
    /// Time between measurements \[s\].
    pub interval_s: f64,
    /// Standard deviation of a station's bias, constant over the flight: the signal in space \[m\].
    pub bias_sigma_m: f64,
    /// Least standard deviation of the white part: the airborne equipment \[m\].
    pub noise_least_m: f64,
    /// Its share of the range.
    pub noise_share: f64,
    /// Where a station may be used.
    pub coverage: Coverage,
}

/// Bearings from VOR stations.
#[derive(Debug, Clone, Copy, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Vor {
    /// Time between measurements \[s\].
    pub interval_s: f64,
    /// Standard deviation of a station's bias \[rad\].
    pub bias_sigma_rad: f64,
    /// Of the white part \[rad\].
    pub noise_sigma_rad: f64,
    /// Where a station may be used.
    pub coverage: Coverage,
}

/// Where a station may be used, besides within the radio horizon.
#[derive(Debug, Clone, Copy, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Coverage {
    /// Least slant range \[m\].
    pub range_least_m: f64,
    /// Largest \[m\].
    pub range_most_m: f64,
    /// Largest elevation of the aircraft seen from the station \[rad\].
    pub elevation_most_rad: f64,
}

/// A barometric altimeter that says heights above the ellipsoid.
#[derive(Debug, Clone, Copy, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Baro {
    /// Time between measurements \[s\].
    pub interval_s: f64,
    /// Standard deviation of the slow bias \[m\],
    pub bias_sigma_m: f64,
    /// and its correlation time \[s\].
    pub bias_time_s: f64,
    /// Standard deviation of the air's temperature against the standard atmosphere \[K\]; one number a flight.
    pub temperature_sigma_k: f64,
    /// Share of the height above the departure that one kelvin is worth \[1/K\].
    pub temperature_share: f64,
    /// White noise \[m\].
    pub noise_sigma_m: f64,
    /// Time constant of its lag \[s\].
    pub lag_s: f64,
}

/// A station on the ground.
#[derive(Debug, Clone, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Station {
    /// Its name.
    pub name: String,
    /// What it offers.
    pub kind: StationKind,
    /// Latitude, WGS-84 \[rad\].
    pub lat_rad: f64,
    /// Longitude, WGS-84 \[rad\].
    pub lon_rad: f64,
    /// Height of the antenna above the ellipsoid \[m\].
    pub height_m: f64,
}

/// What a station offers.
#[derive(Debug, Clone, Copy, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum StationKind {
    /// Distance.
    Dme,
    /// Bearing.
    Vor,
    /// Both.
    VorDme,
}

impl StationKind {
    pub(crate) fn ranges(self) -> bool {
        self != Self::Vor
    }
    pub(crate) fn bears(self) -> bool {
        self != Self::Dme
    }
}

impl Sensors {
    pub(crate) fn rules(&self) -> Vec<Rule> {
        let rate = f64::from(self.rate_hz);
        let mut rules = self.imu.rules(self.rate_hz);
        rules.extend(self.envelope.iter().flat_map(Envelope::rules));
        rules.extend(self.gnss.iter().flat_map(|g| g.rules(rate)));
        rules.extend(self.dme.iter().flat_map(|d| d.rules(rate)));
        rules.extend(self.vor.iter().flat_map(|v| v.rules(rate)));
        rules.extend(self.baro.iter().flat_map(|b| b.rules(rate)));
        rules.extend(self.stations.iter().map(|s| within("height_m", s.height_m, "m", -500.0, 9000.0, "[-500, 9000]")));
        let n = self.stations.len();
        rules.push(Rule("stations", n as f64, "items", n <= 1000, "at most 1000"));
        rules.extend(self.faults.iter().flat_map(|f| f.rules(&self.stations)));
        rules
    }
}

/// Measurements come with a sample of the inertial unit.
fn interval(interval_s: f64, rate: f64) -> Rule {
    let samples = interval_s * rate;
    // A product of two written numbers is a whole number to some 1e-12.
    let whole = (0.5..=1e9).contains(&samples) && (samples - samples.round()).abs() < 1e-6;
    Rule("interval_s", interval_s, "s", whole, "whole multiples of the inertial unit's interval")
}

impl Imu {
    /// Of the unit at so many samples a second.
    pub(super) fn rules(&self, rate_hz: u32) -> Vec<Rule> {
        let divides = (10..=200).contains(&rate_hz) && 1_000_000_000_u32.is_multiple_of(rate_hz);
        vec![
            Rule("rate_hz", f64::from(rate_hz), "1/s", divides, "divisors of 10^9 from 10 to 200"),
            not_negative("gyro_bias_radps", self.gyro_bias_radps, "rad/s"),
            not_negative("gyro_in_run_radps", self.gyro_in_run_radps, "rad/s"),
            not_negative("gyro_noise_radprts", self.gyro_noise_radprts, "rad/√s"),
            within("gyro_scale", self.gyro_scale, "1", 0.0, 0.1, "[0, 0.1]"),
            within("gyro_misalignment_rad", self.gyro_misalignment_rad, "rad", 0.0, 0.1, "[0, 0.1]"),
            not_negative("accelerometer_bias_mps2", self.accelerometer_bias_mps2, "m/s²"),
            not_negative("accelerometer_in_run_mps2", self.accelerometer_in_run_mps2, "m/s²"),
            not_negative("accelerometer_noise_mpsprts", self.accelerometer_noise_mpsprts, "m/s/√s"),
            within("accelerometer_scale", self.accelerometer_scale, "1", 0.0, 0.1, "[0, 0.1]"),
            within("accelerometer_misalignment_rad", self.accelerometer_misalignment_rad, "rad", 0.0, 0.1, "[0, 0.1]"),
            positive("in_run_time_s", self.in_run_time_s, "s"),
        ]
    }
}

impl Envelope {
    fn rules(&self) -> [Rule; 5] {
        [
            positive("force_range_mps2", self.force_range_mps2, "m/s²"),
            positive("rate_range_radps", self.rate_range_radps, "rad/s"),
            positive("force_most_mps2", self.force_most_mps2, "m/s²"),
            positive("rate_most_radps", self.rate_most_radps, "rad/s"),
            positive("force_change_mps3", self.force_change_mps3, "m/s³"),
        ]
    }
}

impl Gnss {
    fn rules(&self, rate: f64) -> Vec<Rule> {
        let n = self.constellations.len();
        let mut rules = vec![
            Rule("constellations", n as f64, "items", n > 0, "one or more"),
            within("mask_rad", self.mask_rad, "rad", 0.0, 1.6, "[0, pi/2]"),
            interval(self.interval_s, rate),
            positive("seed_sigma_m", self.seed_sigma_m, "m"),
            positive("rate_sigma_mps", self.rate_sigma_mps, "m/s"),
            positive("phase_sigma_m", self.phase_sigma_m, "m"),
            not_negative("clock_sigma_m", self.clock_sigma_m, "m"),
            not_negative("drift_sigma_mps", self.drift_sigma_mps, "m/s"),
            not_negative("clock_density_m2ps", self.clock_density_m2ps, "m²/s"),
            not_negative("drift_density_m2ps3", self.drift_density_m2ps3, "m²/s³"),
            not_negative("system_bias_sigma_m", self.system_bias_sigma_m, "m"),
        ];
        rules.extend(self.parts.rules());
        rules
    }
}

impl RangeParts {
    fn rules(&self) -> Vec<Rule> {
        vec![
            positive("noise_sigma_m", self.noise_sigma_m, "m"),
            not_negative("ranging_sigma_m", self.ranging_sigma_m, "m"),
            positive("ranging_time_s", self.ranging_time_s, "s"),
            not_negative("ionosphere_sigma_m", self.ionosphere_sigma_m, "m"),
            positive("ionosphere_time_s", self.ionosphere_time_s, "s"),
            not_negative("troposphere_sigma_m", self.troposphere_sigma_m, "m"),
            positive("troposphere_time_s", self.troposphere_time_s, "s"),
            not_negative("multipath_share", self.multipath_share, "1"),
            positive("multipath_time_s", self.multipath_time_s, "s"),
        ]
    }
}

impl Coverage {
    fn rules(&self) -> Vec<Rule> {
        vec![
            within("range_least_m", self.range_least_m, "m", 0.0, self.range_most_m, "[0, range_most_m]"),
            within("range_most_m", self.range_most_m, "m", 1.0, 1e6, "[1, 1e6]"),
            within("elevation_most_rad", self.elevation_most_rad, "rad", 0.0, 1.6, "[0, pi/2]"),
        ]
    }
}

impl Dme {
    fn rules(&self, rate: f64) -> Vec<Rule> {
        let mut rules = vec![
            interval(self.interval_s, rate),
            not_negative("bias_sigma_m", self.bias_sigma_m, "m"),
            positive("noise_least_m", self.noise_least_m, "m"),
            within("noise_share", self.noise_share, "1", 0.0, 0.1, "[0, 0.1]"),
        ];
        rules.extend(self.coverage.rules());
        rules
    }
}

impl Vor {
    fn rules(&self, rate: f64) -> Vec<Rule> {
        let mut rules = vec![
            interval(self.interval_s, rate),
            not_negative("bias_sigma_rad", self.bias_sigma_rad, "rad"),
            positive("noise_sigma_rad", self.noise_sigma_rad, "rad"),
        ];
        rules.extend(self.coverage.rules());
        rules
    }
}

impl Baro {
    fn rules(&self, rate: f64) -> Vec<Rule> {
        vec![
            interval(self.interval_s, rate),
            not_negative("bias_sigma_m", self.bias_sigma_m, "m"),
            positive("bias_time_s", self.bias_time_s, "s"),
            not_negative("temperature_sigma_k", self.temperature_sigma_k, "K"),
            within("temperature_share", self.temperature_share, "1/K", 0.0, 0.1, "[0, 0.1]"),
            positive("noise_sigma_m", self.noise_sigma_m, "m"),
            within("lag_s", self.lag_s, "s", 0.0, 60.0, "[0, 60]"),
        ]
    }
}
