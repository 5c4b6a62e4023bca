//! The plan of a flight: its route with turns, and heights and speeds that make it last exactly as long as the scenario says.

use crate::profile::Profile;
use crate::scenario::{Phase, Scenario, Turns};
use navbound_core::frame::LatLon;
use navbound_core::quantity::{Metres, OutOfDomain, Radians};
use navbound_path::{AtIndex, Route};

/// Standard acceleration of free fall \[m/s²\] (standard).
pub(crate) const GRAVITY: f64 = 9.806_65;
/// Cruise speeds that are tried \[m/s\].
const SPEEDS: (f64, f64) = (60.0, 400.0);

/// Why a scenario cannot be flown.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Refused {
    /// A number is outside its domain.
    #[error(transparent)]
    Value(#[from] OutOfDomain),
    /// An item of a list is.
    #[error(transparent)]
    Item(#[from] AtIndex),
}

/// A phase of flight by distance along the route.
#[derive(Debug, Clone, PartialEq)]
pub struct PhaseRange {
    /// Its name.
    pub name: String,
    /// RNP value in force.
    pub rnp: Metres,
    /// Where it ends along the route.
    pub end: Metres,
}

/// Where the flight should be, and when.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    pub(crate) route: Route,
    pub(crate) profile: Profile,
    phases: Vec<PhaseRange>,
}

impl Plan {
    /// The plan of a scenario; the cruise speed is solved by bisection.
    ///
    /// # Errors
    /// [`Refused`] for a number outside its domain, turns that do not fit, a phase that ends at no waypoint, or a duration that no cruise
    /// speed from 60 to 400 m/s meets.
    pub fn new(scenario: &Scenario) -> Result<Self, Refused> {
        scenario.check()?;
        let (mut slow, mut fast) = SPEEDS;
        let late = |(_, profile): (Route, Profile)| profile.duration_s() > scenario.duration_s;
        // A speed whose turns do not fit is too fast; what cannot be flown at the slowest cannot be flown.
        let too_slow = |speed: f64| flown(scenario, speed).is_ok_and(late);
        if !late(flown(scenario, slow)?) || too_slow(fast) {
            return Err(cannot_last(scenario).into());
        }
        // From 340 m/s down to the last bit.
        for _ in 0..60 {
            let middle = 0.5 * (slow + fast);
            if too_slow(middle) { slow = middle } else { fast = middle }
        }
        // The search ends at the speed where turns cease to fit, if the flight should be faster still.
        let (route, profile) = flown(scenario, fast).map_err(|_| cannot_last(scenario))?;
        let phases = phase_ranges(scenario, &route)?;
        Ok(Self { route, profile, phases })
    }

    /// Length of the route with its turns.
    pub fn length(&self) -> Metres {
        self.route.length()
    }
    /// Where each waypoint lies along the route.
    pub fn waypoints_along(&self) -> &[Metres] {
        self.route.waypoints_along()
    }
    /// Speed of the cruise over the ground \[m/s\].
    pub fn cruise_speed_mps(&self) -> f64 {
        self.profile.cruise_speed_mps
    }
    /// When the climb ends, and when the descent begins \[s\].
    pub fn cruise_from_to_s(&self) -> (f64, f64) {
        (self.profile.top_of_climb_s, self.profile.top_of_descent_s)
    }
    /// Phases in order.
    pub fn phases(&self) -> &[PhaseRange] {
        &self.phases
    }
    pub(crate) fn phase_at(&self, along_m: f64) -> usize {
        let index = self.phases.partition_point(|p| p.end.m() <= along_m);
        index.min(self.phases.len().saturating_sub(1))
    }
}

fn cannot_last(scenario: &Scenario) -> OutOfDomain {
    let domain = "durations met by a cruise speed from 60 to 400 m/s that leaves room for the turns";
    OutOfDomain { argument: "duration_s", value: scenario.duration_s, unit: "s", domain }
}

/// Route and profile at a cruise speed. Turns are as wide as the speed where their waypoint is passed asks for, or as their waypoint says.
fn flown(scenario: &Scenario, cruise_speed_mps: f64) -> Result<(Route, Profile), Refused> {
    let points = points(scenario)?;
    let corners = Route::new(&points, &vec![Metres::new(0.0); points.len()])?;
    let rough = Profile::new(&scenario.profile, corners.length().m(), cruise_speed_mps)?;
    let mut radii = vec![Metres::new(0.0); points.len()];
    for (i, change) in Route::track_changes(&points)?.into_iter().enumerate() {
        let speed = rough.speed_at_along(corners.waypoints_along()[i + 1].m());
        let stated = scenario.waypoints[i + 1].radius_m.map(Metres::new);
        radii[i + 1] = stated.unwrap_or_else(|| turn_radius(&scenario.turns, speed, change));
    }
    let route = Route::new(&points, &radii)?;
    let profile = Profile::new(&scenario.profile, route.length().m(), cruise_speed_mps)?;
    Ok((route, profile))
}

fn points(scenario: &Scenario) -> Result<Vec<LatLon>, AtIndex> {
    let point = |(index, w): (usize, &crate::scenario::Waypoint)| {
        LatLon::new(Radians::new(w.lat_rad), Radians::new(w.lon_rad)).map_err(|error| AtIndex { index, error })
    };
    scenario.waypoints.iter().enumerate().map(point).collect()
}

/// Radius of a fly-by turn.
///
/// ```text
/// bank = half the track change, within its limits, and V * rate / g = tan(bank) at most      R = V^2 / (g tan(bank))
/// ```
fn turn_radius(turns: &Turns, speed_mps: f64, change: Radians) -> Metres {
    let by_rate = (speed_mps * turns.rate_max_radps / GRAVITY).atan();
    let bank = (0.5 * change.rad().abs()).clamp(turns.bank_min_rad, turns.bank_max_rad).min(by_rate);
    Metres::new(speed_mps * speed_mps / (GRAVITY * bank.tan()))
}

fn phase_ranges(scenario: &Scenario, route: &Route) -> Result<Vec<PhaseRange>, AtIndex> {
    let mut begin = 0.0;
    let mut ranges = Vec::new();
    for (index, phase) in scenario.phases.iter().enumerate() {
        let end = phase_end(phase, scenario, route).map_err(|error| AtIndex { index, error })?;
        if !(end > begin) {
            let error =
                OutOfDomain { argument: "phases.until", value: end, unit: "m", domain: "later than the phase before, inside the route" };
            return Err(AtIndex { index, error });
        }
        begin = end;
        ranges.push(PhaseRange { name: phase.name.clone(), rnp: Metres::new(phase.rnp_m), end: Metres::new(end) });
    }
    match ranges.last() {
        Some(last) if last.end.m() == f64::INFINITY => Ok(ranges),
        _ => {
            let error =
                OutOfDomain { argument: "phases", value: ranges.len() as f64, unit: "items", domain: "a last phase without an end" };
            Err(AtIndex { index: ranges.len(), error })
        }
    }
}

fn phase_end(phase: &Phase, scenario: &Scenario, route: &Route) -> Result<f64, OutOfDomain> {
    match (&phase.until_waypoint, phase.until_before_end_m) {
        (None, None) => Ok(f64::INFINITY),
        (None, Some(distance)) => Ok(route.length().m() - distance),
        (Some(name), None) => match scenario.waypoints.iter().position(|w| &w.name == name) {
            Some(i) => Ok(route.waypoints_along()[i].m()),
            None => Err(OutOfDomain { argument: "phases.until_waypoint", value: f64::NAN, unit: "", domain: "names of waypoints" }),
        },
        (Some(_), Some(distance)) => {
            let domain = "either a waypoint or a distance, not both";
            Err(OutOfDomain { argument: "phases.until_before_end_m", value: distance, unit: "m", domain })
        }
    }
}
