//! Heights and speeds along the flight: a chain of segments of constant acceleration, each at constant rate of climb or path angle.
//!
//! Ours (our specification 6.1): take-off roll, stepped climb with a speed ramp to cruise, level cruise, straight descent with constant
//! deceleration. Everything is closed form, so the duration is exact once the cruise speed is solved for it.

use crate::scenario::ProfileSettings;
use navbound_core::quantity::OutOfDomain;

/// What the profile asks for at an instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Demand {
    pub(crate) along_m: f64,
    pub(crate) speed_mps: f64,
    pub(crate) height_m: f64,
    pub(crate) climb_mps: f64,
    /// Tangent of the path angle.
    pub(crate) slope: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Segment {
    start_s: f64,
    along_m: f64,
    speed_mps: f64,
    acceleration_mps2: f64,
    height_m: f64,
    vertical: Vertical,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Vertical {
    /// Constant rate of climb \[m/s\].
    Rate(f64),
    /// Constant tangent of the path angle.
    Slope(f64),
}

/// Heights and speeds from begin to end.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Profile {
    segments: Vec<Segment>,
    duration_s: f64,
    pub(crate) airborne_s: f64,
    pub(crate) cruise_speed_mps: f64,
    pub(crate) top_of_climb_s: f64,
    pub(crate) top_of_descent_s: f64,
}

impl Profile {
    /// The profile over a route of this length at this cruise speed.
    pub(crate) fn new(settings: &ProfileSettings, length_m: f64, cruise_speed_mps: f64) -> Result<Self, OutOfDomain> {
        let mut chain = Chain::default();
        let (v, p) = (cruise_speed_mps, settings);
        chain.height_m = p.departure_height_m;
        chain.push(p.roll_acceleration_mps2, Vertical::Rate(0.0), p.rotation_speed_mps / p.roll_acceleration_mps2);
        let airborne_s = chain.time_s;
        for (height, rate) in climb_steps(p) {
            let speed = climb_speed(p, v, height);
            let time = (height - chain.height_m) / rate;
            chain.push((speed - chain.speed_mps) / time, Vertical::Rate(rate), time);
        }
        let top_of_climb_s = chain.time_s;
        let slope = p.descent_angle_rad.tan();
        let descent_m = (p.cruise_height_m - p.arrival_height_m) / slope;
        let cruise_m = length_m - chain.along_m - descent_m;
        if !(cruise_m >= 0.0) {
            return Err(OutOfDomain {
                argument: "cruise_height_m",
                value: p.cruise_height_m,
                unit: "m",
                domain: "heights the route leaves room for",
            });
        }
        chain.push(0.0, Vertical::Rate(0.0), cruise_m / v);
        let top_of_descent_s = chain.time_s;
        let landing = p.landing_speed_mps;
        chain.push((landing * landing - v * v) / (2.0 * descent_m), Vertical::Slope(-slope), 2.0 * descent_m / (v + landing));
        Ok(Self { segments: chain.segments, duration_s: chain.time_s, airborne_s, cruise_speed_mps: v, top_of_climb_s, top_of_descent_s })
    }

    pub(crate) fn duration_s(&self) -> f64 {
        self.duration_s
    }

    /// What is requested at an instant; outside the flight, at its begin or end.
    pub(crate) fn at(&self, time_s: f64) -> Demand {
        let time_s = time_s.clamp(0.0, self.duration_s);
        let index = self.segments.partition_point(|s| s.start_s <= time_s).saturating_sub(1);
        self.segments[index].at(time_s)
    }

    /// Speed where a distance along the route is passed.
    pub(crate) fn speed_at_along(&self, along_m: f64) -> f64 {
        let index = self.segments.partition_point(|s| s.along_m <= along_m).saturating_sub(1);
        let s = &self.segments[index];
        (s.speed_mps * s.speed_mps + 2.0 * s.acceleration_mps2 * (along_m - s.along_m)).max(0.0).sqrt()
    }
}

impl Segment {
    fn at(&self, time_s: f64) -> Demand {
        let t = time_s - self.start_s;
        let moved = self.speed_mps * t + 0.5 * self.acceleration_mps2 * t * t;
        let speed = self.speed_mps + self.acceleration_mps2 * t;
        let (rise, climb, slope) = match self.vertical {
            Vertical::Rate(w) => (w * t, w, if speed > 0.0 { w / speed } else { 0.0 }),
            Vertical::Slope(g) => (g * moved, g * speed, g),
        };
        Demand { along_m: self.along_m + moved, speed_mps: speed, height_m: self.height_m + rise, climb_mps: climb, slope }
    }
}

/// The chain while it is being built: where it has come to.
#[derive(Debug, Default)]
struct Chain {
    segments: Vec<Segment>,
    time_s: f64,
    along_m: f64,
    speed_mps: f64,
    height_m: f64,
}

impl Chain {
    fn push(&mut self, acceleration_mps2: f64, vertical: Vertical, duration_s: f64) {
        if !(duration_s > 0.0) {
            return;
        }
        let segment = Segment {
            start_s: self.time_s,
            along_m: self.along_m,
            speed_mps: self.speed_mps,
            acceleration_mps2,
            height_m: self.height_m,
            vertical,
        };
        let end = segment.at(self.time_s + duration_s);
        self.segments.push(segment);
        self.time_s += duration_s;
        (self.along_m, self.speed_mps, self.height_m) = (end.along_m, end.speed_mps, end.height_m);
    }
}

/// Heights where the climb changes its rate or its acceleration, each with the rate that leads there.
fn climb_steps(p: &ProfileSettings) -> Vec<(f64, f64)> {
    let mut heights: Vec<f64> = p.climb_step_heights_m.clone();
    heights.extend([p.initial_climb_height_m, p.acceleration_height_m, p.cruise_height_m]);
    heights.retain(|&h| h > p.departure_height_m && h <= p.cruise_height_m);
    heights.sort_by(f64::total_cmp);
    heights.dedup();
    let rate = |h: f64| p.climb_rates_mps[p.climb_step_heights_m.partition_point(|&step| step < h)];
    heights.into_iter().map(|h| (h, rate(h))).collect()
}

/// Speed at a height of the climb: from rotation to the initial climb speed, then a ramp to the cruise speed.
fn climb_speed(p: &ProfileSettings, cruise: f64, height: f64) -> f64 {
    let ramp = |h0: f64, v0: f64, h1: f64, v1: f64| v0 + (v1 - v0) * (height - h0) / (h1 - h0);
    if height >= p.acceleration_height_m {
        cruise
    } else if height >= p.initial_climb_height_m {
        ramp(p.initial_climb_height_m, p.initial_climb_speed_mps, p.acceleration_height_m, cruise)
    } else {
        ramp(p.departure_height_m, p.rotation_speed_mps, p.initial_climb_height_m, p.initial_climb_speed_mps)
    }
}
