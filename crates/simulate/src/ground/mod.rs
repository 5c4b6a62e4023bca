//! A landing and the taxi-in: the route driven second by second, and the errors that are drawn on the way.

mod errors;
mod motion;

use serde::Deserialize;

pub use errors::GroundFlight;
pub use motion::Driven;

/// Instants a second at which carrier phase is followed: over a fifth of one the speed in a turn changes by millimetres a second.
pub(crate) const STEPS: usize = 5;

/// A landing, a taxi route to a stand, and how the aircraft knows where it is on the way. SI units, as [`crate::Scenario`].
#[derive(Debug, Clone, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Taxi {
    /// How fast.
    pub motion: RouteMotion,
    /// What its ranges are like.
    pub navigation: TaxiNavigation,
    /// From the threshold to the stand.
    pub points: Vec<RoutePoint>,
    /// What goes wrong.
    pub faults: Vec<RangeFault>,
}

/// How fast, besides the largest speeds of the sub-phases.
#[derive(Debug, Clone, Copy, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct RouteMotion {
    /// Distance from the threshold to where the wheels touch \[m\].
    pub touchdown_along_m: f64,
    /// Speed there \[m/s\].
    pub touchdown_speed_mps: f64,
    /// Largest deceleration \[m/s²\].
    pub braking_mps2: f64,
    /// Largest acceleration \[m/s²\].
    pub acceleration_mps2: f64,
    /// Largest acceleration across, in turns \[m/s²\].
    pub lateral_acceleration_mps2: f64,
    /// Correlation time of the flight technical error \[s\].
    pub steering_time_s: f64,
}

/// The statistics of ranges.
#[derive(Debug, Clone, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct TaxiNavigation {
    /// Point of the route from which no code is used.
    pub transition: String,
    /// Largest nominal bias of a range \[m\].
    pub bias_m: f64,
    /// Correlation time of smoothed code \[s\].
    pub code_time_s: f64,
    /// Correlation time of the noise of carrier phase \[s\].
    pub phase_time_s: f64,
}

/// A point of the route, with the radius flown around it and the sub-phase that begins there.
#[derive(Debug, Clone, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct RoutePoint {
    /// Its name.
    pub name: String,
    /// Latitude, WGS-84 \[rad\].
    pub lat_rad: f64,
    /// Longitude, WGS-84 \[rad\].
    pub lon_rad: f64,
    /// Radius of the turn \[m\].
    pub radius_m: f64,
    /// Sub-phase: one of `navbound_core::spec::surface::SUB_PHASES`, or `RWY`, the landing roll.
    pub phase: Option<String>,
}

/// A differential range error of one satellite.
#[derive(Debug, Clone, Deserialize, PartialEq)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum RangeFault {
    /// It is there at once.
    RangeStep {
        /// Begin, since the threshold \[s\].
        start_s: f64,
        /// How long \[s\].
        duration_s: f64,
        /// Its size \[m\].
        size_m: f64,
    },
    /// It grows.
    RangeRamp {
        /// Begin, since the threshold \[s\].
        start_s: f64,
        /// How long \[s\].
        duration_s: f64,
        /// How fast \[m/s\].
        rate_mps: f64,
    },
}

impl RangeFault {
    /// The error at a time since the threshold \[m\].
    pub fn error_m(&self, time_s: f64) -> f64 {
        let acts = |start: f64, duration: f64| time_s >= start && time_s < start + duration;
        match *self {
            Self::RangeStep { start_s, duration_s, size_m } if acts(start_s, duration_s) => size_m,
            Self::RangeRamp { start_s, duration_s, rate_mps } if acts(start_s, duration_s) => rate_mps * (time_s - start_s),
            Self::RangeStep { .. } | Self::RangeRamp { .. } => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fault_acts_from_its_begin_to_its_end() {
        let step = RangeFault::RangeStep { start_s: 10.0, duration_s: 5.0, size_m: -3.0 };
        assert_eq!([9.9, 10.0, 14.9, 15.0].map(|t| step.error_m(t)), [0.0, -3.0, -3.0, 0.0]);
        let ramp = RangeFault::RangeRamp { start_s: 10.0, duration_s: 5.0, rate_mps: 0.5 };
        assert_eq!([9.0, 10.0, 12.0, 14.0, 15.0].map(|t| ramp.error_m(t)), [0.0, 0.0, 1.0, 2.0, 0.0]);
    }
}
