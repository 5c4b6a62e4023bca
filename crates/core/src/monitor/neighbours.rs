//! Positions that stand further from the line between their neighbours than their covariances and any manoeuvre explain.
//!
//! Of three successive positions a, b, c of one track, at times s before and t after the middle one:
//!
//! ```text
//! d = b - (t a + s c) / (s + t)                       across the way a to c, and along it
//! |d across| <= 1/2 A s t + rounding                  + what the covariances allow
//! |d along|  <= 1/2 A s t + rounding + v latency      + what the covariances allow
//! ```
//!
//! The rest is compared with ``sqrt(-2 ln risk)`` standard deviations of d, the larger variance of both axes taken. A position may be as late as one
//! that is not yet stale, at the mean speed from a to c. Where positions come fast (both steps below half a second) and all three differ, a late one
//! is late by a step at most and at the slower speed of both steps: a jump is no speed. Provenance: ours.

use crate::quantity::GpsTime;
use crate::special::float::{cos, exp, hypot, sin, sqrt};
use core::f64::consts::TAU;

/// Probability of one such triple under the stated covariances at which it contradicts them. Provenance: ours \[1\].
pub const RISK: f64 = 1e-9;
/// Largest acceleration of an ordinary manoeuvre, between 1 g of a braking car and of a steep turn. Provenance: ours \[m/s²\].
const ACCELERATION_MPS2: f64 = 10.0;
/// What five decimals of a degree move three positions by. Derived \[m\].
const ROUNDING_M: f64 = 2.0;
/// Steps below this are of a receiver that computes as fast as it is recorded. Provenance: ours \[s\].
const FAST_S: f64 = 0.5;
/// Mean radius of the Earth: good to a percent over some kilometres \[m\].
const EARTH_RADIUS_M: f64 = 6_371_000.0;

/// A position and its covariance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// When.
    pub time: GpsTime,
    /// Latitude \[rad\].
    pub lat_rad: f64,
    /// Longitude \[rad\].
    pub lon_rad: f64,
    /// The larger horizontal variance \[m²\].
    pub variance_m2: f64,
}

impl Place {
    const fn at(&self) -> [f64; 2] {
        [self.lat_rad, self.lon_rad]
    }
}

/// A height and its variance, NaN where none is stated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Height {
    /// Above the ellipsoid \[m\].
    pub h_m: f64,
    /// Its variance \[m²\].
    pub variance_m2: f64,
}

/// How far a position stands from the line between its neighbours.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Apart {
    /// The distance \[m\].
    pub away_m: f64,
    /// What of it no manoeuvre, rounding or latency explains \[m\].
    pub unexplained_m: f64,
    /// Standard deviation of the distance by the covariances \[m\].
    pub sigma_m: f64,
}

impl Apart {
    /// Of the middle one of three positions; none where time does not go on, or a position is none.
    pub fn of([a, b, c]: [&Place; 3], stale_after_s: f64) -> Option<Self> {
        let (before_s, after_s) = (b.time.seconds_since(a.time), c.time.seconds_since(b.time));
        if !(before_s > 0.0 && after_s > 0.0) {
            return None;
        }
        let (way, step) = (east_north_m(a.at(), c.at()), east_north_m(a.at(), b.at()));
        let whole_s = before_s + after_s;
        let share = before_s / whole_s;
        let away = [step[0] - share * way[0], step[1] - share * way[1]];
        let length_m = hypot(way[0], way[1]);
        // Of neighbours at one place nothing is along.
        let (along_m, across_m) = if length_m > 0.0 {
            let unit = [way[0] / length_m, way[1] / length_m];
            ((away[0] * unit[0] + away[1] * unit[1]).abs(), (away[0] * unit[1] - away[1] * unit[0]).abs())
        } else {
            (0.0, hypot(away[0], away[1]))
        };
        let free_m = 0.5 * ACCELERATION_MPS2 * before_s * after_s + ROUNDING_M;
        let step_speeds = [hypot(step[0], step[1]) / before_s, hypot(way[0] - step[0], way[1] - step[1]) / after_s];
        let longest_s = before_s.max(after_s);
        // One that repeats the last place, as slower receivers do in a faster table, is held, and its next step makes up for it.
        let fast = longest_s < FAST_S && step_speeds.iter().all(|speed| *speed > 0.0);
        let late_m =
            if fast { longest_s.min(stale_after_s) * step_speeds[0].min(step_speeds[1]) } else { stale_after_s * length_m / whole_s };
        let (rest_across, rest_along) = ((across_m - free_m).max(0.0), (along_m - free_m - late_m).max(0.0));
        let other = 1.0 - share;
        let variance = b.variance_m2 + other * other * a.variance_m2 + share * share * c.variance_m2;
        let apart = Self { away_m: hypot(away[0], away[1]), unexplained_m: hypot(rest_across, rest_along), sigma_m: sqrt(variance) };
        (apart.away_m.is_finite() && apart.sigma_m >= 0.0).then_some(apart)
    }

    /// Probability that as much or more is left by errors as the covariances say.
    pub fn risk(&self) -> f64 {
        if self.unexplained_m <= 0.0 {
            return 1.0;
        }
        let deviations = self.unexplained_m / self.sigma_m;
        exp(-0.5 * deviations * deviations)
    }
}

/// Whether two positions of one time are one, by their covariances and their digits.
pub fn one_place(a: &Place, b: &Place) -> bool {
    let [east, north] = east_north_m(a.at(), b.at());
    // A position without a variance explains nothing more.
    explained(hypot(east, north), a.variance_m2 + b.variance_m2)
}

/// Whether two heights of one time are one, in the same way; without a variance those are that differ by no more than `noise_m`.
pub fn one_height(a: &Height, b: &Height, noise_m: f64) -> bool {
    let (apart_m, variance_m2) = ((a.h_m - b.h_m).abs(), a.variance_m2 + b.variance_m2);
    if variance_m2.is_nan() { apart_m <= noise_m } else { explained(apart_m, variance_m2) }
}

fn explained(apart_m: f64, variance_m2: f64) -> bool {
    let (unexplained_m, sigma_m) = ((apart_m - ROUNDING_M).max(0.0), sqrt(variance_m2));
    unexplained_m <= 0.0 || exp(-0.5 * (unexplained_m / sigma_m) * (unexplained_m / sigma_m)) >= RISK
}

/// The way from one place to another on a sphere \[m\], of latitudes and longitudes \[rad\], good to a percent over some kilometres; a meridian
/// and the same one a turn further are one.
pub fn east_north_m([from_lat, from_lon]: [f64; 2], [lat, lon]: [f64; 2]) -> [f64; 2] {
    let turned = lon - from_lon;
    let turns = (turned / TAU + 0.5_f64.copysign(turned)) as i64 as f64;
    let east = 2.0 * EARTH_RADIUS_M * cos(from_lat) * sin(0.5 * (turned - TAU * turns));
    [east, EARTH_RADIUS_M * (lat - from_lat)]
}

/// The last two positions of a track whose reports arrive.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Neighbours {
    /// The one before the last, and the last.
    pub last: [Option<Place>; 2],
}

impl Neighbours {
    /// Whether the next position and the last two contradict each other; one that is no later than the last says nothing.
    pub fn contradict(&mut self, place: Place, stale_after_s: f64) -> bool {
        let [before, last] = self.last;
        if last.is_some_and(|last| place.time <= last.time) {
            return false;
        }
        self.last = [last, Some(place)];
        let apart = before.zip(last).and_then(|(a, b)| Apart::of([&a, &b, &place], stale_after_s));
        apart.is_some_and(|apart| apart.risk() < RISK)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At a second, so many metres north and east of a place on the equator, with a metre of standard deviation.
    fn place(second: f64, north_m: f64, east_m: f64) -> Place {
        let time = GpsTime::from_nanoseconds((second * 1e9) as i64);
        Place { time, lat_rad: north_m / EARTH_RADIUS_M, lon_rad: east_m / EARTH_RADIUS_M, variance_m2: 1.0 }
    }

    fn apart(places: [Place; 3]) -> Apart {
        Apart::of(places.each_ref(), 2.0).unwrap()
    }

    #[test]
    fn a_manoeuvre_a_rounding_and_a_late_position_explain_a_part() {
        // 70 m/s north, the middle one 20 m aside: half of 10 m/s2 x 1 s x 1 s and 2 m are explained.
        let aside = apart([place(0.0, 0.0, 0.0), place(1.0, 70.0, 20.0), place(2.0, 140.0, 0.0)]);
        assert!((aside.away_m - 20.0).abs() < 1e-6 && (aside.unexplained_m - 13.0).abs() < 1e-6, "{aside:?}");
        // 1 + 1/4 + 1/4 m2.
        assert!((aside.sigma_m - 1.5_f64.sqrt()).abs() < 1e-12);
        // Two seconds late at 70 m/s are 140 m along.
        let late = apart([place(0.0, 0.0, 0.0), place(1.0, 70.0 - 146.0, 0.0), place(2.0, 140.0, 0.0)]);
        assert!(late.unexplained_m < 1e-6, "{late:?}");
        let later = apart([place(0.0, 0.0, 0.0), place(1.0, 70.0 - 157.0, 0.0), place(2.0, 140.0, 0.0)]);
        assert!((later.unexplained_m - 10.0).abs() < 1e-6, "{later:?}");
        // Neighbours at one place have no along.
        let back = apart([place(0.0, 0.0, 0.0), place(1.0, 30.0, 0.0), place(2.0, 0.0, 0.0)]);
        assert!((back.unexplained_m - 23.0).abs() < 1e-6, "{back:?}");
    }

    #[test]
    fn a_step_along_the_way_is_no_speed_where_positions_come_fast() {
        // 20 m/s at 10 Hz, and a step of 95 m that stays: half of it beside the line, less 2 m, 0.05 m and a step of 2 m.
        let jump = apart([place(0.0, 0.0, 0.0), place(0.1, 2.0, 0.0), place(0.2, 97.0, 0.0)]);
        assert!((jump.away_m - 46.5).abs() < 1e-6 && (jump.unexplained_m - 42.45).abs() < 1e-6, "{jump:?}");
        // At 1 Hz a late position explains it; so does one that a slower receiver repeats.
        let slow = apart([place(0.0, 0.0, 0.0), place(1.0, 20.0, 0.0), place(2.0, 135.0, 0.0)]);
        assert!(slow.unexplained_m < 1e-6, "{slow:?}");
        let repeated = apart([place(0.0, 0.0, 0.0), place(0.1, 0.0, 0.0), place(0.2, 20.0, 0.0)]);
        assert!(repeated.unexplained_m < 1e-6, "{repeated:?}");
    }

    #[test]
    fn the_risk_is_that_of_two_axes() {
        let of = |unexplained_m| Apart { away_m: 0.0, unexplained_m, sigma_m: 1.0 }.risk();
        assert_eq!(of(0.0), 1.0);
        // sqrt(-2 ln 1e-9) = 6.4379.
        assert!(of(6.437) > RISK && of(6.439) < RISK);
    }

    /// 0.1 degrees to the east of 45 N: 6371 km * 0.1 degrees * cos 45 = 7862.6 m, whatever the writing of the meridians.
    #[test]
    fn a_way_across_a_turn_of_longitude_is_the_way_that_was_flown() {
        let degrees = |lat: f64, lon: f64| [lat.to_radians(), lon.to_radians()];
        for turn in [-360.0, 0.0, 360.0] {
            for (from, to) in [(179.95, -179.95), (359.95, 0.05), (-0.05, 0.05)] {
                let [east, north] = east_north_m(degrees(45.0, from), degrees(45.0, to + turn));
                assert!((east - EARTH_RADIUS_M * 0.1_f64.to_radians() * 0.5_f64.sqrt()).abs() < 1e-2, "{from} {to} {turn}: {east}");
                assert!(north.abs() < 1e-9);
                let [back, _] = east_north_m(degrees(45.0, to + turn), degrees(45.0, from));
                assert!((back + east).abs() < 1e-6, "{from} {to} {turn}: {back}");
            }
        }
    }

    #[test]
    fn positions_that_alternate_contradict_each_other_at_each_and_a_straight_flight_never() {
        let mut neighbours = Neighbours::default();
        let aside = |k: i32| if k % 2 == 0 { 0.0 } else { 420.0 };
        let contradicted: Vec<_> = (0..8).map(|k| neighbours.contradict(place(f64::from(k), 70.0 * f64::from(k), aside(k)), 2.0)).collect();
        assert_eq!(contradicted, [false, false, true, true, true, true, true, true]);
        let mut neighbours = Neighbours::default();
        assert!((0..100).all(|k| !neighbours.contradict(place(f64::from(k), 70.0 * f64::from(k), 0.0), 2.0)));
        // What is of the past says nothing, and is not remembered.
        assert!(!neighbours.contradict(place(50.0, 0.0, 9e5), 2.0));
        assert!(!neighbours.contradict(place(100.0, 7000.0, 0.0), 2.0));
    }

    #[test]
    fn time_that_stands_and_places_that_are_none_give_nothing() {
        let (a, b) = (place(0.0, 0.0, 0.0), place(1.0, 70.0, 0.0));
        assert_eq!(Apart::of([&a, &b, &b], 2.0), None);
        assert_eq!(Apart::of([&a, &b, &Place { lat_rad: f64::NAN, ..place(2.0, 0.0, 0.0) }], 2.0), None);
        assert_eq!(Apart::of([&a, &b, &Place { variance_m2: f64::NAN, ..place(2.0, 140.0, 0.0) }], 2.0), None);
    }
}
