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
            | Self::BaroBlockage { start_s, duration_s } => start_s..start_s + duration_s,
            Self::ImuBiasJump { start_s, .. } => start_s..f64::INFINITY,
        }
    }

    /// Time since it began, while it acts \[s\].
    pub(crate) fn since(&self, time_s: f64) -> Option<f64> {
        let window = self.window();
        window.contains(&time_s).then_some(time_s - window.start)
    }

    /// The satellite it concerns.
    pub(crate) fn satellite(&self) -> Option<SatelliteId> {
        match self {
            Self::SatelliteStep { satellite: name, .. } | Self::SatelliteRamp { satellite: name, .. } => satellite(name),
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
            Self::Interference { .. } | Self::ImuTrouble { .. } | Self::BaroBlockage { .. } => {}
        }
        rules
    }
}

fn satellite_rule(name: &str) -> Rule {
    Rule("satellite", f64::NAN, "", satellite(name).is_some(), "names of satellites as RINEX has them: G05, E11, C23")
}

/// The satellite of a name.
fn satellite(name: &str) -> Option<SatelliteId> {
    let (letter, number) = name.split_at_checked(1)?;
    let number: u8 = number.parse().ok().filter(|n| *n > 0)?;
    Some(SatelliteId { constellation: Constellation::from_letter(letter.as_bytes()[0])?, number })
}
