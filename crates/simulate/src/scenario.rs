//! A scenario: what is flown, how, and how well the aircraft knows where it is. All numbers in SI units; the Python layer turns the
//! units of a scenario file into these and explains every value it refuses.

use crate::navigator::Navigator;
use crate::sensors::Sensors;
use navbound_core::geometry::{BEIDOU, GALILEO, GPS, GPS_EXPANDED, Slot};
use navbound_core::quantity::OutOfDomain;
use navbound_core::signal::Constellation;
use serde::Deserialize;

/// One simulated flight, or many of them.
#[derive(Debug, Clone, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Scenario {
    /// GPS time of the first epoch \[ns\].
    pub start_ns: i64,
    /// How long the flight lasts \[s\]; the cruise speed is solved for it.
    pub duration_s: f64,
    /// From take-off to landing.
    pub waypoints: Vec<Waypoint>,
    /// How turns are flown.
    pub turns: Turns,
    /// Heights and speeds.
    pub profile: ProfileSettings,
    /// How the aircraft is steered.
    pub guidance: Guidance,
    /// What disturbs it.
    pub gusts: Gusts,
    /// How it knows where it is.
    pub navigation: Navigation,
    /// Phases of flight in order; the last lasts to the end.
    pub phases: Vec<Phase>,
    /// What goes wrong.
    pub faults: Vec<Fault>,
    /// Sensors on board, for flights whose position is to be worked out rather than drawn.
    #[serde(default)]
    pub sensors: Option<Sensors>,
    /// The filter that works it out; without one the position errors are drawn from the covariance of the geometry.
    #[serde(default)]
    pub filter: Option<Navigator>,
}

/// A point of the route.
#[derive(Debug, Clone, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Waypoint {
    /// Its name.
    pub name: String,
    /// Latitude, WGS-84 \[rad\].
    pub lat_rad: f64,
    /// Longitude, WGS-84 \[rad\].
    pub lon_rad: f64,
    /// Radius of the turn at it \[m\], 0 for a corner; without one the bank decides.
    #[serde(default)]
    pub radius_m: Option<f64>,
}

/// Bank of a fly-by turn: half the track change, between these limits, and no faster than the rate.
#[derive(Debug, Clone, Copy, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Turns {
    /// Smallest bank \[rad\].
    pub bank_min_rad: f64,
    /// Largest bank \[rad\].
    pub bank_max_rad: f64,
    /// Largest rate of turn \[rad/s\].
    pub rate_max_radps: f64,
}

/// Heights and speeds over the ground.
#[derive(Debug, Clone, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct ProfileSettings {
    /// Height at the begin \[m\].
    pub departure_height_m: f64,
    /// Height at the end \[m\].
    pub arrival_height_m: f64,
    /// Height of the cruise \[m\].
    pub cruise_height_m: f64,
    /// Acceleration of the take-off roll \[m/s²\].
    pub roll_acceleration_mps2: f64,
    /// Speed at lift-off \[m/s\].
    pub rotation_speed_mps: f64,
    /// Speed of the initial climb \[m/s\], reached at `initial_climb_height_m`.
    pub initial_climb_speed_mps: f64,
    /// Where the initial climb speed is reached \[m\].
    pub initial_climb_height_m: f64,
    /// Where the cruise speed is reached \[m\].
    pub acceleration_height_m: f64,
    /// Heights where the rate of climb changes, rising \[m\].
    pub climb_step_heights_m: Vec<f64>,
    /// Rates of climb below the first step, between steps, above the last \[m/s\].
    pub climb_rates_mps: Vec<f64>,
    /// Path angle of the descent, positive \[rad\].
    pub descent_angle_rad: f64,
    /// Speed at the end \[m/s\].
    pub landing_speed_mps: f64,
}

/// Guidance law and response of the aircraft.
#[derive(Debug, Clone, Copy, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Guidance {
    /// Natural frequency of the lateral loop \[rad/s\].
    pub lateral_frequency_radps: f64,
    /// Its damping ratio.
    pub lateral_damping: f64,
    /// Time constant of the bank response \[s\].
    pub bank_lag_s: f64,
    /// Largest commanded bank \[rad\].
    pub bank_limit_rad: f64,
    /// Gain from height error to vertical speed \[1/s\].
    pub vertical_gain_per_s: f64,
    /// Time constant of the path-angle response \[s\].
    pub path_angle_lag_s: f64,
    /// Largest vertical acceleration \[m/s²\].
    pub vertical_acceleration_mps2: f64,
    /// How far ahead the vertical guidance looks \[s\].
    pub vertical_lead_s: f64,
}

/// Gusts: first-order Gauss-Markov along the flown way.
#[derive(Debug, Clone, Copy, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Gusts {
    /// Standard deviation across the path \[m/s\].
    pub lateral_sigma_mps: f64,
    /// Standard deviation upwards \[m/s\].
    pub vertical_sigma_mps: f64,
    /// Length scale \[m\].
    pub length_m: f64,
}

/// A shipped constellation.
#[derive(Debug, Clone, Copy, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum System {
    /// GPS, 24 nominal slots.
    Gps,
    /// GPS, 27 slots, the expandable ones split.
    #[serde(rename = "gps-expanded")]
    GpsExpanded,
    /// Galileo, 24 nominal satellites.
    Galileo,
    /// BeiDou-3, 30 nominal satellites.
    Beidou,
}

impl System {
    pub(crate) fn slots(self) -> &'static [Slot] {
        match self {
            Self::Gps => &GPS[..],
            Self::GpsExpanded => &GPS_EXPANDED[..],
            Self::Galileo => &GALILEO[..],
            Self::Beidou => &BEIDOU[..],
        }
    }

    pub(crate) fn constellation(self) -> Constellation {
        match self {
            Self::Gps | Self::GpsExpanded => Constellation::Gps,
            Self::Galileo => Constellation::Galileo,
            Self::Beidou => Constellation::BeiDou,
        }
    }
}

/// How the aircraft knows where it is.
#[derive(Debug, Clone, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Navigation {
    /// Constellations in use.
    pub constellations: Vec<System>,
    /// Lowest elevation in use \[rad\].
    pub mask_rad: f64,
    /// Standard deviation of satellite clock and orbit errors \[m\].
    pub ranging_sigma_m: f64,
    /// Of the ionosphere's delay that is left, at the zenith \[m\].
    pub ionosphere_sigma_m: f64,
    /// Of the troposphere's, at the zenith \[m\].
    pub troposphere_sigma_m: f64,
    /// Of receiver noise \[m\].
    pub noise_sigma_m: f64,
    /// Share of the airborne multipath model that is applied.
    pub multipath_share: f64,
    /// Correlation time of the position error \[s\].
    pub correlation_time_s: f64,
    /// Claimed standard deviation over the true one; 1 is consistent.
    pub claimed_sigma_scale: f64,
}

/// A phase of flight and the RNP value in force.
#[derive(Debug, Clone, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Phase {
    /// Its name.
    pub name: String,
    /// RNP value \[m\].
    pub rnp_m: f64,
    /// It ends at this waypoint,
    #[serde(default)]
    pub until_waypoint: Option<String>,
    /// or this far before the end \[m\]; the last phase has neither.
    #[serde(default)]
    pub until_before_end_m: Option<f64>,
}

/// Something that goes wrong for a while.
#[derive(Debug, Clone, Copy, Deserialize, PartialEq)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Fault {
    /// The navigation error grows across the path, and the claimed covariance knows nothing of it.
    LateralRamp {
        /// Time after the begin of the flight \[s\].
        start_s: f64,
        /// How long \[s\].
        duration_s: f64,
        /// Growth, positive right \[m/s\].
        rate_mps: f64,
    },
    /// Ranging gets worse: the error and the claimed covariance grow together.
    DegradedRanging {
        /// Time after the begin of the flight \[s\].
        start_s: f64,
        /// How long \[s\].
        duration_s: f64,
        /// Standard deviations become this many times as large.
        sigma_factor: f64,
    },
}

const POSITIVE: &str = "(0, inf)";
const NOT_NEGATIVE: &str = "[0, inf)";
const QUARTER: f64 = core::f64::consts::FRAC_PI_2;

/// A number that must be inside an interval.
pub(crate) struct Rule(pub(crate) &'static str, pub(crate) f64, pub(crate) &'static str, pub(crate) bool, pub(crate) &'static str);

impl Scenario {
    /// That every number is inside its domain. Names and the shape of the route are checked where they are used.
    ///
    /// # Errors
    /// [`OutOfDomain`] for the first that is not.
    pub fn check(&self) -> Result<(), OutOfDomain> {
        let mut rules = vec![within("duration_s", self.duration_s, "s", 60.0, 200_000.0, "[60, 200000]")];
        rules.extend(self.turns.rules());
        rules.extend(self.profile.rules());
        rules.extend(self.guidance.rules());
        rules.extend(self.gusts.rules());
        rules.extend(self.navigation.rules());
        rules.extend(self.waypoints.iter().filter_map(|w| w.radius_m).map(|r| within("radius_m", r, "m", 0.0, 1e6, "[0, 1e6]")));
        // As of specifications: RNP values in (0, 20] NM.
        let rnp = |p: &Phase| Rule("rnp_m", p.rnp_m, "m", p.rnp_m > 0.0 && p.rnp_m <= 37_040.0, "(0, 37040], 20 NM");
        rules.extend(self.phases.iter().map(rnp));
        rules.extend(self.faults.iter().flat_map(Fault::rules));
        rules.extend(self.sensors.iter().flat_map(Sensors::rules));
        rules.extend(self.filter.iter().flat_map(|f| f.rules(self.sensors.is_some(), self.faults.len())));
        // A filter claims what it works out: the scale would be ignored, and the report would name it.
        let scale = self.navigation.claimed_sigma_scale;
        rules.extend(self.filter.iter().map(|_| Rule("claimed_sigma_scale", scale, "1", scale == 1.0, "{1} with a [filter]")));
        kept(rules)
    }
}

/// # Errors
/// [`OutOfDomain`] for the first rule that is broken.
pub(crate) fn kept(rules: Vec<Rule>) -> Result<(), OutOfDomain> {
    match rules.into_iter().find(|rule| !rule.3) {
        Some(Rule(argument, value, unit, _, domain)) => Err(OutOfDomain { argument, value, unit, domain }),
        None => Ok(()),
    }
}

pub(crate) fn within(argument: &'static str, value: f64, unit: &'static str, least: f64, most: f64, domain: &'static str) -> Rule {
    Rule(argument, value, unit, least <= value && value <= most, domain)
}

pub(crate) fn positive(argument: &'static str, value: f64, unit: &'static str) -> Rule {
    Rule(argument, value, unit, value > 0.0 && value.is_finite(), POSITIVE)
}

pub(crate) fn not_negative(argument: &'static str, value: f64, unit: &'static str) -> Rule {
    Rule(argument, value, unit, value >= 0.0 && value.is_finite(), NOT_NEGATIVE)
}

impl Turns {
    fn rules(&self) -> Vec<Rule> {
        vec![
            within("bank_min_rad", self.bank_min_rad, "rad", 0.001, self.bank_max_rad, "[0.001, bank_max_rad]"),
            within("bank_max_rad", self.bank_max_rad, "rad", 0.001, 1.0, "[0.001, 1]"),
            positive("rate_max_radps", self.rate_max_radps, "rad/s"),
        ]
    }
}

impl ProfileSettings {
    fn rules(&self) -> Vec<Rule> {
        let (low, high) = (self.departure_height_m, self.cruise_height_m);
        let heights = within("departure_height_m", low, "m", -500.0, 5000.0, "[-500, 5000]");
        let n = self.climb_rates_mps.len();
        let mut rules = vec![
            heights,
            within("arrival_height_m", self.arrival_height_m, "m", -500.0, high - 1.0, "[-500, cruise_height_m - 1]"),
            within("cruise_height_m", high, "m", low + 1.0, 20_000.0, "[departure_height_m + 1, 20000]"),
            positive("roll_acceleration_mps2", self.roll_acceleration_mps2, "m/s²"),
            within("rotation_speed_mps", self.rotation_speed_mps, "m/s", 20.0, 150.0, "[20, 150]"),
            within("initial_climb_speed_mps", self.initial_climb_speed_mps, "m/s", 20.0, 300.0, "[20, 300]"),
            within("initial_climb_height_m", self.initial_climb_height_m, "m", low, high, "[departure_height_m, cruise_height_m]"),
            within(
                "acceleration_height_m",
                self.acceleration_height_m,
                "m",
                self.initial_climb_height_m,
                high,
                "[initial_climb_height_m, cruise_height_m]",
            ),
            within("descent_angle_rad", self.descent_angle_rad, "rad", 0.005, 0.2, "[0.005, 0.2]"),
            within("landing_speed_mps", self.landing_speed_mps, "m/s", 20.0, 150.0, "[20, 150]"),
            Rule("climb_rates_mps", n as f64, "items", n == self.climb_step_heights_m.len() + 1, "one more than climb_step_heights_m"),
        ];
        rules.extend(self.climb_rates_mps.iter().map(|&w| within("climb_rates_mps", w, "m/s", 0.1, 50.0, "[0.1, 50]")));
        let rising = self.climb_step_heights_m.windows(2).map(|h| Rule("climb_step_heights_m", h[1], "m", h[1] > h[0], "rising heights"));
        rules.extend(rising);
        rules.extend(
            self.climb_step_heights_m.iter().map(|&h| within("climb_step_heights_m", h, "m", low, 20_000.0, "[departure_height_m, 20000]")),
        );
        rules
    }
}

impl Guidance {
    fn rules(&self) -> Vec<Rule> {
        vec![
            within("lateral_frequency_radps", self.lateral_frequency_radps, "rad/s", 0.005, 0.5, "[0.005, 0.5]"),
            within("lateral_damping", self.lateral_damping, "1", 0.2, 5.0, "[0.2, 5]"),
            within("bank_lag_s", self.bank_lag_s, "s", 0.2, 10.0, "[0.2, 10]"),
            within("bank_limit_rad", self.bank_limit_rad, "rad", 0.01, 1.0, "[0.01, 1]"),
            within("vertical_gain_per_s", self.vertical_gain_per_s, "1/s", 0.005, 1.0, "[0.005, 1]"),
            within("path_angle_lag_s", self.path_angle_lag_s, "s", 0.2, 10.0, "[0.2, 10]"),
            positive("vertical_acceleration_mps2", self.vertical_acceleration_mps2, "m/s²"),
            within("vertical_lead_s", self.vertical_lead_s, "s", 0.0, 60.0, "[0, 60]"),
        ]
    }
}

impl Gusts {
    fn rules(&self) -> Vec<Rule> {
        vec![
            not_negative("lateral_sigma_mps", self.lateral_sigma_mps, "m/s"),
            not_negative("vertical_sigma_mps", self.vertical_sigma_mps, "m/s"),
            positive("length_m", self.length_m, "m"),
        ]
    }
}

impl Navigation {
    fn rules(&self) -> Vec<Rule> {
        let n = self.constellations.len();
        vec![
            Rule("constellations", n as f64, "items", n > 0, "one or more"),
            within("mask_rad", self.mask_rad, "rad", 0.0, QUARTER, "[0, pi/2]"),
            positive("ranging_sigma_m", self.ranging_sigma_m, "m"),
            not_negative("ionosphere_sigma_m", self.ionosphere_sigma_m, "m"),
            not_negative("troposphere_sigma_m", self.troposphere_sigma_m, "m"),
            not_negative("noise_sigma_m", self.noise_sigma_m, "m"),
            not_negative("multipath_share", self.multipath_share, "1"),
            positive("correlation_time_s", self.correlation_time_s, "s"),
            positive("claimed_sigma_scale", self.claimed_sigma_scale, "1"),
        ]
    }
}

impl Fault {
    fn rules(&self) -> Vec<Rule> {
        let (start, duration, own) = match *self {
            Self::LateralRamp { start_s, duration_s, rate_mps } => {
                (start_s, duration_s, within("rate_mps", rate_mps, "m/s", -100.0, 100.0, "[-100, 100]"))
            }
            Self::DegradedRanging { start_s, duration_s, sigma_factor } => {
                (start_s, duration_s, positive("sigma_factor", sigma_factor, "1"))
            }
        };
        vec![not_negative("start_s", start, "s"), positive("duration_s", duration, "s"), own]
    }
}
