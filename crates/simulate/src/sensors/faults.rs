//! What goes wrong with a sensor, and when.

use super::settings::Station;
use crate::scenario::{Rule, not_negative, positive, within};
use navbound_core::signal::{Constellation, SatelliteId};
use serde::Deserialize;

/// Something that goes wrong with a sensor.
#[derive(Debug, Clone, Deserialize, PartialEq)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum SensorFault {
    /// A satellite's ranges jump.
    SatelliteStep {
        /// Time after the begin of the flight \[s\].
        start_s: f64,
        /// How long \[s\].
        duration_s: f64,
        /// Which, as RINEX names it: G05.
        satellite: String,
        /// How far \[m\].
        step_m: f64,
    },
    /// A satellite's ranges drift away.
    SatelliteRamp {
        /// Time after the begin of the flight \[s\].
        start_s: f64,
        /// How long \[s\].
        duration_s: f64,
        /// Which, as RINEX names it: G05.
        satellite: String,
        /// How fast \[m/s\].
        rate_mps: f64,
    },
    /// No satellite can be received.
    Interference {
        /// Time after the begin of the flight \[s\].
        start_s: f64,
        /// How long \[s\].
        duration_s: f64,
    },
    /// All satellites' signals are replaced by those of a place that moves away from the aircraft.
    Spoofing {
        /// Time after the begin of the flight \[s\].
        start_s: f64,
        /// How long \[s\].
        duration_s: f64,
        /// How fast the false place moves to the right of the track \[m/s\],
        right_mps: f64,
        /// and upwards \[m/s\].
        up_mps: f64,
        /// Whether the range rates are those of the false place too, or still those of the aircraft.
        #[serde(default = "yes")]
        rates: bool,
    },
    /// Ranges of several satellites jump by the same.
    SatellitesStep {
        /// Time after the begin of the flight \[s\].
        start_s: f64,
        /// How long \[s\].
        duration_s: f64,
        /// Which: names as G05, or the letter of a constellation for all of it.
        satellites: Vec<String>,
        /// How far \[m\].
        step_m: f64,
    },
    /// Ranges of several satellites drift away at the same rate.
    SatellitesRamp {
        /// Time after the begin of the flight \[s\].
        start_s: f64,
        /// How long \[s\].
        duration_s: f64,
        /// As in [`SensorFault::SatellitesStep`].
        satellites: Vec<String>,
        /// How fast \[m/s\].
        rate_mps: f64,
    },
    /// The satellite receiver delivers what cannot be used as it is.
    ReceiverTrouble {
        /// Time after the begin of the flight \[s\].
        start_s: f64,
        /// How long \[s\].
        duration_s: f64,
        /// What is wrong with it.
        what: ReceiverFault,
    },
    /// The receiver's measurements are of an earlier time than their tags say.
    ReceiverDelay {
        /// Time after the begin of the flight \[s\].
        start_s: f64,
        /// How long \[s\].
        duration_s: f64,
        /// How much earlier \[s\].
        delay_s: f64,
    },
    /// The deviations that are declared with the ranges are not theirs.
    ReceiverSigma {
        /// Time after the begin of the flight \[s\].
        start_s: f64,
        /// How long \[s\].
        duration_s: f64,
        /// Declared over true deviation.
        factor: f64,
    },
    /// A station's ranges are wrong by a constant.
    DmeBias {
        /// Time after the begin of the flight \[s\].
        start_s: f64,
        /// How long \[s\].
        duration_s: f64,
        /// Name of the station.
        station: String,
        /// How far \[m\].
        bias_m: f64,
    },
    /// The bias of every station is a multiple of itself.
    DmeBiases {
        /// Time after the begin of the flight \[s\].
        start_s: f64,
        /// How long \[s\].
        duration_s: f64,
        /// Multiple.
        factor: f64,
    },
    /// Biases of the inertial unit jump, and jump back.
    ImuPulse {
        /// Time after the begin of the flight \[s\].
        start_s: f64,
        /// How long \[s\].
        duration_s: f64,
        /// Of the gyroscopes forward, right, down \[rad/s\].
        gyro_radps: [f64; 3],
        /// Of the accelerometers \[m/s²\].
        accelerometer_mps2: [f64; 3],
    },
    /// Biases of the inertial unit grow.
    ImuRamp {
        /// Time after the begin of the flight \[s\].
        start_s: f64,
        /// How long \[s\].
        duration_s: f64,
        /// Of the gyroscopes forward, right, down \[rad/s²\].
        gyro_radps2: [f64; 3],
        /// Of the accelerometers \[m/s³\].
        accelerometer_mps3: [f64; 3],
    },
    /// Scale factors of the inertial unit change.
    ImuScale {
        /// Time after the begin of the flight \[s\].
        start_s: f64,
        /// How long \[s\].
        duration_s: f64,
        /// Share that is added to every rate.
        gyro: f64,
        /// Share that is added to every force.
        accelerometer: f64,
    },
    /// The white noise of the inertial unit grows.
    ImuNoise {
        /// Time after the begin of the flight \[s\].
        start_s: f64,
        /// How long \[s\].
        duration_s: f64,
        /// Multiple of its own.
        factor: f64,
    },
    /// The inertial unit says no more than its range.
    ImuClip {
        /// Time after the begin of the flight \[s\].
        start_s: f64,
        /// How long \[s\].
        duration_s: f64,
        /// Largest rate of an axis \[rad/s\].
        gyro_radps: f64,
        /// Largest force of an axis \[m/s²\].
        accelerometer_mps2: f64,
    },
    /// The clock of the inertial unit jumps, or runs fast or slow.
    ImuClock {
        /// Time after the begin of the flight \[s\].
        start_s: f64,
        /// How long \[s\].
        duration_s: f64,
        /// Added to the times \[s\].
        offset_s: f64,
        /// Added to them for each second of the fault \[s/s\].
        drift: f64,
    },
    /// Biases of the inertial unit jump, and stay.
    ImuBiasJump {
        /// Time after the begin of the flight \[s\].
        start_s: f64,
        /// Of the gyroscopes forward, right, down \[rad/s\].
        gyro_radps: [f64; 3],
        /// Of the accelerometers \[m/s²\].
        accelerometer_mps2: [f64; 3],
    },
    /// The inertial unit's samples cannot be used.
    ImuTrouble {
        /// Time after the begin of the flight \[s\].
        start_s: f64,
        /// How long \[s\].
        duration_s: f64,
        /// What is wrong with them.
        what: Trouble,
    },
    /// The static port is blocked: the altimeter stays where it was.
    BaroBlockage {
        /// Time after the begin of the flight \[s\].
        start_s: f64,
        /// How long \[s\].
        duration_s: f64,
    },
    /// Satellites are out of service, as a notice announces it.
    SatelliteOutage {
        /// Time after the begin of the flight \[s\].
        start_s: f64,
        /// How long \[s\].
        duration_s: f64,
        /// As in [`SensorFault::SatellitesStep`].
        satellites: Vec<String>,
    },
    /// Stations are out of service, ranges and bearings.
    StationOutage {
        /// Time after the begin of the flight \[s\].
        start_s: f64,
        /// How long \[s\].
        duration_s: f64,
        /// Their names.
        stations: Vec<String>,
    },
    /// The altimeter repeats its last word.
    BaroFrozen {
        /// Time after the begin of the flight \[s\].
        start_s: f64,
        /// How long \[s\].
        duration_s: f64,
    },
}

fn yes() -> bool {
    true
}

/// What is wrong with what a satellite receiver delivers.
#[derive(Debug, Clone, Copy, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum ReceiverFault {
    /// The last measurement again and again, with new times.
    Frozen,
    /// Every row twenty times.
    Repeated,
    /// All satellites under the name of the first.
    OneName,
    /// Range rates with the wrong sign.
    RatesReversed,
}

/// What is wrong with samples that cannot be used.
#[derive(Debug, Clone, Copy, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum Trouble {
    /// None come.
    Silent,
    /// An angle is not a number.
    NotANumber,
    /// Their times lie a second back.
    Late,
    /// Every number is zero.
    Zeros,
    /// The accelerometers repeat what they said last.
    FrozenAccelerometers,
    /// The gyroscopes do.
    FrozenGyroscopes,
    /// Both do.
    Frozen,
    /// Forward and right axes are exchanged.
    SwappedAxes,
    /// Every second sample is the one before it again, its time included.
    Repeated,
    /// Every second sample is missing.
    Lost,
    /// The times of every two samples are exchanged.
    Reversed,
}

impl SensorFault {
    /// What is wrong with the inertial unit's samples at a time.
    pub(crate) fn trouble(&self, time_s: f64) -> Option<Trouble> {
        match self {
            Self::ImuTrouble { what, .. } => self.since(time_s).map(|_| *what),
            _ => None,
        }
    }

    /// When it acts \[s\].
    pub(crate) fn window(&self) -> core::ops::Range<f64> {
        match *self {
            Self::SatelliteStep { start_s, duration_s, .. }
            | Self::SatelliteRamp { start_s, duration_s, .. }
            | Self::Interference { start_s, duration_s }
            | Self::Spoofing { start_s, duration_s, .. }
            | Self::DmeBias { start_s, duration_s, .. }
            | Self::ImuTrouble { start_s, duration_s, .. }
            | Self::SatellitesStep { start_s, duration_s, .. }
            | Self::SatellitesRamp { start_s, duration_s, .. }
            | Self::ReceiverTrouble { start_s, duration_s, .. }
            | Self::ReceiverDelay { start_s, duration_s, .. }
            | Self::ReceiverSigma { start_s, duration_s, .. }
            | Self::DmeBiases { start_s, duration_s, .. }
            | Self::ImuPulse { start_s, duration_s, .. }
            | Self::ImuRamp { start_s, duration_s, .. }
            | Self::ImuScale { start_s, duration_s, .. }
            | Self::ImuNoise { start_s, duration_s, .. }
            | Self::ImuClip { start_s, duration_s, .. }
            | Self::ImuClock { start_s, duration_s, .. }
            | Self::SatelliteOutage { start_s, duration_s, .. }
            | Self::StationOutage { start_s, duration_s, .. }
            | Self::BaroFrozen { start_s, duration_s }
            | Self::BaroBlockage { start_s, duration_s } => start_s..start_s + duration_s,
            Self::ImuBiasJump { start_s, .. } => start_s..f64::INFINITY,
        }
    }

    /// Time since it began, while it acts \[s\].
    pub(crate) fn since(&self, time_s: f64) -> Option<f64> {
        let window = self.window();
        window.contains(&time_s).then_some(time_s - window.start)
    }

    /// Whether it silences a satellite at a time.
    pub(crate) fn silences(&self, id: SatelliteId, time_s: f64) -> bool {
        match self {
            Self::SatelliteOutage { satellites, .. } => self.since(time_s).is_some() && satellites.iter().any(|name| is_of(name, id)),
            _ => false,
        }
    }

    /// Whether it silences a station at a time.
    pub(crate) fn silences_station(&self, station: &str, time_s: f64) -> bool {
        match self {
            Self::StationOutage { stations, .. } => self.since(time_s).is_some() && stations.iter().any(|name| name == station),
            _ => false,
        }
    }

    /// The satellite it concerns.
    pub(crate) fn satellite(&self) -> Option<SatelliteId> {
        match self {
            Self::SatelliteStep { satellite: name, .. } | Self::SatelliteRamp { satellite: name, .. } => satellite(name),
            _ => None,
        }
    }

    /// What is wrong with what the receiver delivers.
    pub(crate) fn receiver(&self, time_s: f64) -> Option<ReceiverFault> {
        match self {
            Self::ReceiverTrouble { what, .. } => self.since(time_s).map(|_| *what),
            _ => None,
        }
    }

    /// How much earlier than their tags the receiver's measurements are \[s\].
    pub(crate) fn delay_s(&self, time_s: f64) -> Option<f64> {
        match self {
            Self::ReceiverDelay { delay_s, .. } => self.since(time_s).map(|_| *delay_s),
            _ => None,
        }
    }

    pub(crate) fn rules(&self, stations: &[Station]) -> Vec<Rule> {
        let window = self.window();
        let mut rules = vec![not_negative("start_s", window.start, "s")];
        if window.end < f64::INFINITY || window.end.is_nan() {
            rules.push(positive("duration_s", window.end - window.start, "s"));
        }
        match self {
            Self::SatelliteStep { satellite, step_m, .. } => {
                rules.extend([satellite_rule(satellite), within("step_m", *step_m, "m", -1e7, 1e7, "[-1e7, 1e7]")]);
            }
            Self::SatelliteRamp { satellite, rate_mps, .. } => {
                rules.extend([satellite_rule(satellite), within("rate_mps", *rate_mps, "m/s", -1e4, 1e4, "[-1e4, 1e4]")]);
            }
            Self::Spoofing { right_mps, up_mps, .. } => {
                rules
                    .extend([("right_mps", *right_mps), ("up_mps", *up_mps)].map(|(n, v)| within(n, v, "m/s", -1e3, 1e3, "[-1000, 1000]")));
            }
            Self::DmeBias { station, bias_m, .. } => {
                let known = stations.iter().any(|s| &s.name == station && s.kind.ranges());
                rules.push(Rule("station", f64::NAN, "", known, "names of stations of the table that offer ranges"));
                rules.push(within("bias_m", *bias_m, "m", -1e6, 1e6, "[-1e6, 1e6]"));
            }
            Self::ImuBiasJump { gyro_radps, accelerometer_mps2, .. } => {
                rules.extend(gyro_radps.map(|w| within("gyro_radps", w, "rad/s", -1.0, 1.0, "[-1, 1]")));
                rules.extend(accelerometer_mps2.map(|f| within("accelerometer_mps2", f, "m/s²", -100.0, 100.0, "[-100, 100]")));
            }
            Self::SatellitesStep { satellites, step_m: size, .. } | Self::SatellitesRamp { satellites, rate_mps: size, .. } => {
                let known = !satellites.is_empty() && satellites.iter().all(|name| group(name).is_some());
                rules.push(Rule("satellites", f64::NAN, "", known, "names of satellites as G05, or letters of constellations"));
                rules.push(within("size", *size, "m or m/s", -1e7, 1e7, "[-1e7, 1e7]"));
            }
            Self::SatelliteOutage { satellites, .. } => {
                let known = !satellites.is_empty() && satellites.iter().all(|name| group(name).is_some());
                rules.push(Rule("satellites", f64::NAN, "", known, "names of satellites as G05, or letters of constellations"));
            }
            Self::StationOutage { stations: names, .. } => {
                let known = !names.is_empty() && names.iter().all(|name| stations.iter().any(|s| &s.name == name));
                rules.push(Rule("stations", f64::NAN, "", known, "names of stations of the table"));
            }
            Self::ReceiverDelay { delay_s, .. } => rules.push(within("delay_s", *delay_s, "s", 0.0, 10.0, "[0, 10]")),
            Self::ReceiverSigma { factor, .. } | Self::ImuNoise { factor, .. } | Self::DmeBiases { factor, .. } => {
                rules.push(within("factor", *factor, "1", 1e-3, 1e3, "[0.001, 1000]"));
            }
            Self::ImuPulse { gyro_radps, accelerometer_mps2, .. } => {
                rules.extend(gyro_radps.map(|w| within("gyro_radps", w, "rad/s", -100.0, 100.0, "[-100, 100]")));
                rules.extend(accelerometer_mps2.map(|f| within("accelerometer_mps2", f, "m/s²", -1e3, 1e3, "[-1000, 1000]")));
            }
            Self::ImuRamp { gyro_radps2, accelerometer_mps3, .. } => {
                rules.extend(gyro_radps2.map(|w| within("gyro_radps2", w, "rad/s²", -1.0, 1.0, "[-1, 1]")));
                rules.extend(accelerometer_mps3.map(|f| within("accelerometer_mps3", f, "m/s³", -100.0, 100.0, "[-100, 100]")));
            }
            Self::ImuScale { gyro, accelerometer, .. } => {
                rules.extend([("gyro", *gyro), ("accelerometer", *accelerometer)].map(|(n, v)| within(n, v, "1", -1.0, 1.0, "[-1, 1]")));
            }
            Self::ImuClip { gyro_radps, accelerometer_mps2, .. } => {
                rules.extend([positive("gyro_radps", *gyro_radps, "rad/s"), positive("accelerometer_mps2", *accelerometer_mps2, "m/s²")]);
            }
            Self::ImuClock { offset_s, drift, .. } => {
                rules.push(within("offset_s", *offset_s, "s", -1e4, 1e4, "[-1e4, 1e4]"));
                rules.push(within("drift", *drift, "s/s", -0.1, 0.1, "[-0.1, 0.1]"));
            }
            Self::Interference { .. }
            | Self::ImuTrouble { .. }
            | Self::BaroBlockage { .. }
            | Self::BaroFrozen { .. }
            | Self::ReceiverTrouble { .. } => {}
        }
        rules
    }
}

fn satellite_rule(name: &str) -> Rule {
    Rule("satellite", f64::NAN, "", satellite(name).is_some(), "names of satellites as RINEX has them: G05, E11, C23")
}

/// Whether a satellite is among those of a name: its own, or that of its constellation.
pub(crate) fn is_of(name: &str, id: SatelliteId) -> bool {
    group(name).is_some_and(|(constellation, number)| constellation == id.constellation && number.is_none_or(|n| n == id.number))
}

/// A constellation and, of a single satellite, its number.
fn group(name: &str) -> Option<(Constellation, Option<u8>)> {
    match satellite(name) {
        Some(id) => Some((id.constellation, Some(id.number))),
        None => Some((Constellation::from_letter(*name.as_bytes().first().filter(|_| name.len() == 1)?)?, None)),
    }
}

/// The satellite of a name.
fn satellite(name: &str) -> Option<SatelliteId> {
    let (letter, number) = name.split_at_checked(1)?;
    let number: u8 = number.parse().ok().filter(|n| *n > 0)?;
    Some(SatelliteId { constellation: Constellation::from_letter(letter.as_bytes()[0])?, number })
}
