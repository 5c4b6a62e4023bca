//! Where an aircraft should be, second by second, from the threshold to its stand.

use super::{RouteMotion, Taxi};
use crate::plan::Refused;
use navbound_core::frame::LatLon;
use navbound_core::quantity::{Metres, OutOfDomain, Radians};
use navbound_core::spec::surface::SUB_PHASES;
use navbound_path::{AtIndex, Place, Route};

/// Between points at which speeds are worked out \[m\].
const STEP_M: f64 = 1.0;
/// Over which the metres of a radian are taken: some 60 m.
const NEAR_RAD: f64 = 1e-5;
/// The landing roll, which is limited by the speed of touching down alone.
const RUNWAY: &str = "RWY";

/// The route at whole seconds, driven as fast as sub-phases, turns and brakes allow.
#[derive(Debug, Clone, PartialEq)]
pub struct Driven {
    /// Distance from the first point \[m\].
    pub along_m: Vec<f64>,
    /// Speed \[m/s\].
    pub speed_mps: Vec<f64>,
    /// The path there.
    pub places: Vec<Place>,
    /// Point at which the sub-phase there begins.
    pub phase: Vec<usize>,
    /// Distance of the transition point from the first \[m\].
    pub transition_m: f64,
    /// Metres east and north for a radian of longitude and latitude.
    pub per_radian_m: [f64; 2],
}

impl Driven {
    /// Drives the route of a scenario.
    ///
    /// # Errors
    /// [`Refused`] for points that are no route, turns that overlap, brakes too weak for it, a sub-phase or a transition point that is not
    /// there.
    pub fn new(taxi: &Taxi) -> Result<Self, Refused> {
        let (route, points) = route_of(taxi)?;
        let begins = Begins::new(taxi, &route)?;
        let transition = taxi.points.iter().position(|p| p.name == taxi.navigation.transition);
        let transition = transition.ok_or(OutOfDomain {
            argument: "navigation.transition",
            value: taxi.points.len() as f64,
            unit: "1",
            domain: "names of points of the route",
        })?;
        let grid = grid(route.length().m());
        let speed = speeds(&taxi.motion, &route, &grid, &begins)?;
        let elapsed = elapsed(&grid, &speed);
        let last = elapsed[elapsed.len() - 1].floor() as usize;
        let along: Vec<f64> = (0..=last).map(|second| between(second as f64, &elapsed, &grid)).collect();
        let places: Result<Vec<Place>, OutOfDomain> = along.iter().map(|&s| route.at(Metres::new(s))).collect();
        Ok(Self {
            speed_mps: along.iter().map(|&s| between(s, &grid, &speed)).collect(),
            places: places?,
            phase: along.iter().map(|&s| begins.at(s).point).collect(),
            transition_m: route.waypoints_along()[transition].m(),
            per_radian_m: per_radian(&points)?,
            along_m: along,
        })
    }
}

fn route_of(taxi: &Taxi) -> Result<(Route, Vec<LatLon>), Refused> {
    let at = |(index, p): (usize, &super::RoutePoint)| {
        LatLon::new(Radians::new(p.lat_rad), Radians::new(p.lon_rad)).map_err(|error| AtIndex { index, error })
    };
    let points: Vec<LatLon> = taxi.points.iter().enumerate().map(at).collect::<Result<_, _>>()?;
    let radii: Vec<Metres> = taxi.points.iter().map(|p| Metres::new(p.radius_m)).collect();
    Ok((Route::new(&points, &radii)?, points))
}

/// Where a sub-phase begins.
#[derive(Debug, Clone, Copy)]
struct Begin {
    along_m: f64,
    point: usize,
    /// Largest speed \[m/s\].
    speed_mps: f64,
}

/// Where sub-phases begin, in the order of the route.
struct Begins(Vec<Begin>);

impl Begins {
    fn new(taxi: &Taxi, route: &Route) -> Result<Self, Refused> {
        let mut begins = Vec::new();
        for (point, (mark, p)) in route.waypoints_along().iter().zip(&taxi.points).enumerate() {
            let Some(id) = p.phase.as_deref() else { continue };
            let pace = if id == RUNWAY { Some(taxi.motion.touchdown_speed_mps) } else { sub_phase_speed(id) };
            let unknown = OutOfDomain { argument: "phase", value: point as f64, unit: "1", domain: "sub-phases of surface movement" };
            let speed_mps = pace.ok_or(AtIndex { index: point, error: unknown })?;
            begins.push(Begin { along_m: mark.m(), point, speed_mps });
        }
        let none = OutOfDomain { argument: "points", value: 0.0, unit: "1", domain: "points at which a sub-phase begins" };
        if begins.is_empty() { Err(none.into()) } else { Ok(Self(begins)) }
    }

    /// The sub-phase in force; before the first begins, the first.
    fn at(&self, along_m: f64) -> Begin {
        self.0[self.0.partition_point(|b| b.along_m <= along_m).saturating_sub(1)]
    }
}

fn sub_phase_speed(id: &str) -> Option<f64> {
    SUB_PHASES.iter().find(|p| p.id == id).map(|p| p.speed_mps)
}

/// Every metre, and the end.
fn grid(length_m: f64) -> Vec<f64> {
    let whole = (length_m / STEP_M).ceil() as usize;
    (0..whole).map(|k| k as f64 * STEP_M).chain([length_m]).collect()
}

/// Largest speeds at the points of the grid: limits, turns, then what acceleration and brakes make of them.
fn speeds(motion: &RouteMotion, route: &Route, grid: &[f64], begins: &Begins) -> Result<Vec<f64>, OutOfDomain> {
    let last = grid.len() - 1;
    let turning = turning(motion, route, grid)?;
    // The bound applies at both ends of a step that turns.
    let most = |k: usize| begins.at(grid[k]).speed_mps.min(turning[k]).min(turning[if k == 0 { last } else { k - 1 }]);
    let mut speed: Vec<f64> = (0..=last).map(most).collect();
    speed[last] = 0.0;
    for k in (0..last).rev() {
        let braked = (speed[k + 1] * speed[k + 1] + 2.0 * motion.braking_mps2 * (grid[k + 1] - grid[k])).sqrt();
        if grid[k] >= motion.touchdown_along_m {
            speed[k] = speed[k].min(braked);
        } else if braked < speed[k] {
            return Err(OutOfDomain {
                argument: "motion.braking_mps2",
                value: motion.braking_mps2,
                unit: "m/s²",
                domain: "brakes that slow the aircraft down in time after touching down",
            });
        }
    }
    for k in 1..last {
        speed[k] = speed[k].min((speed[k - 1] * speed[k - 1] + 2.0 * motion.acceleration_mps2 * (grid[k] - grid[k - 1])).sqrt());
    }
    Ok(speed)
}

/// Speed that the largest acceleration across allows from each point of the grid to the next: v² = a s / turn.
fn turning(motion: &RouteMotion, route: &Route, grid: &[f64]) -> Result<Vec<f64>, OutOfDomain> {
    let course: Result<Vec<f64>, OutOfDomain> = grid.iter().map(|&s| Ok(route.at(Metres::new(s))?.course.rad())).collect();
    let course = course?;
    let of = |k: usize| {
        let (turn, spacing) = if k + 1 < grid.len() { (course[k + 1] - course[k], grid[k + 1] - grid[k]) } else { (0.0, STEP_M) };
        let turn = turn.sin().atan2(turn.cos()).abs();
        (motion.lateral_acceleration_mps2 * spacing / turn.max(1e-9)).sqrt()
    };
    Ok((0..grid.len()).map(of).collect())
}

/// When each point of the grid is reached. Between two the acceleration is constant, so the mean speed is the mean of both.
fn elapsed(grid: &[f64], speed: &[f64]) -> Vec<f64> {
    let mut now = 0.0;
    let mut elapsed = vec![now];
    for k in 1..grid.len() {
        now += (grid[k] - grid[k - 1]) / ((speed[k] + speed[k - 1]) / 2.0);
        elapsed.push(now);
    }
    elapsed
}

/// Straight between the points (x, y), x rising; at an end, and beyond it, the value there.
fn between(at: f64, x: &[f64], y: &[f64]) -> f64 {
    let k = x.partition_point(|&v| v <= at);
    if k == 0 {
        return y[0];
    }
    if k == x.len() {
        return y[k - 1];
    }
    (y[k] - y[k - 1]) / (x[k] - x[k - 1]) * (at - x[k - 1]) + y[k - 1]
}

/// Metres of a radian of longitude and of latitude in the middle of some points: lengths of two short geodesics.
fn per_radian(points: &[LatLon]) -> Result<[f64; 2], Refused> {
    let mean = |of: fn(&LatLon) -> f64| points.iter().map(of).sum::<f64>() / points.len() as f64;
    let (lat, lon) = (mean(|p| p.lat().rad()), mean(|p| p.lon().rad()));
    let length = |lat_half: f64, lon_half: f64| -> Result<f64, Refused> {
        let end = |sign: f64| LatLon::new(Radians::new(lat + sign * lat_half), Radians::new(lon + sign * lon_half));
        Ok(Route::new(&[end(-1.0)?, end(1.0)?], &[Metres::new(0.0); 2])?.length().m() / NEAR_RAD)
    };
    Ok([length(0.0, NEAR_RAD / 2.0)?, length(NEAR_RAD / 2.0, 0.0)?])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn taxi(braking_mps2: f64) -> Taxi {
        // A runway due north from the equator, of 3 km, and a taxiway that goes on for 1 km.
        let text = format!(
            r#"{{"motion": {{"touchdown_along_m": 300.0, "touchdown_speed_mps": 60.0, "braking_mps2": {braking_mps2},
                "acceleration_mps2": 0.5, "lateral_acceleration_mps2": 1.0, "steering_time_s": 8.0}},
                "navigation": {{"transition": "B", "bias_m": 0.1, "code_time_s": 100.0, "phase_time_s": 30.0}},
                "faults": [],
                "points": [{{"name": "A", "lat_rad": 0.0, "lon_rad": 0.0, "radius_m": 0.0, "phase": "RWY"}},
                           {{"name": "B", "lat_rad": 0.00047, "lon_rad": 0.0, "radius_m": 0.0, "phase": "NTW"}},
                           {{"name": "C", "lat_rad": 0.00063, "lon_rad": 0.0, "radius_m": 0.0, "phase": null}}]}}"#
        );
        serde_json::from_str(&text).expect("a scenario")
    }

    #[test]
    fn a_straight_route_is_driven_as_brakes_and_limits_say() {
        let driven = Driven::new(&taxi(2.0)).unwrap();
        // On the equator a radian of latitude is a (1 - e²) = 6 335 439.3 m, of longitude a = 6 378 137 m; over 60 m both to a part in 1e9.
        let [east, north] = driven.per_radian_m;
        assert!((east / 6_378_137.0 - 1.0).abs() < 1e-6 && (north / 6_335_439.327 - 1.0).abs() < 1e-6, "{east} {north}");
        let begin = driven.transition_m;
        assert!((begin - 0.00047 * 6_335_439.327).abs() < 0.01, "{begin}");
        for (k, (&along, &speed)) in driven.along_m.iter().zip(&driven.speed_mps).enumerate() {
            // v² = 10² + 2 a s back from the taxiway, whose limit is 10 m/s; speeds are worked out every metre, and straight between.
            let braked = if along < begin { (100.0 + 4.0 * (begin - along)).sqrt().min(60.0) } else { 10.0 };
            assert!(speed <= braked + 0.1, "{k} {along} {speed} {braked}");
            if along < begin - 10.0 {
                assert!(speed > braked - 0.1, "{k} {along} {speed} {braked}");
            }
            assert_eq!(driven.phase[k], usize::from(along >= begin));
        }
        // Down to rest at the end: the last whole second is less than 2 m/s² s from it.
        assert!(*driven.speed_mps.last().unwrap() < 2.1);
    }

    #[test]
    fn brakes_that_are_too_weak_are_refused() {
        // From 60 to 10 m/s over 2677 m behind the touchdown: (3600 - 100) / 2 / 2677 = 0.654 m/s².
        assert!(Driven::new(&taxi(0.66)).is_ok());
        let refused = Driven::new(&taxi(0.65)).unwrap_err();
        assert!(matches!(refused, Refused::Value(e) if e.argument == "motion.braking_mps2"));
    }

    #[test]
    fn between_points_is_straight_and_beyond_them_constant() {
        let (x, y) = ([0.0, 1.0, 3.0], [5.0, 7.0, 1.0]);
        assert_eq!([-1.0, 0.0, 0.5, 1.0, 2.0, 3.0, 9.0].map(|v| between(v, &x, &y)), [5.0, 5.0, 6.0, 7.0, 4.0, 1.0, 1.0]);
    }
}
