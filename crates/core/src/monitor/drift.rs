//! Whether positions drift aside of the way that the reported track leads: what is within the limits of each minute adds up.
//!
//! A track and a speed lead somewhere in a minute. What the positions travelled aside of that, beyond what rounding and noise explain, is added up
//! to either side; the sum begins anew where nothing is left, so that a drift shows however long the flight before it was right. In turns a
//! lag of the positions is aside: only straight minutes count.
//!
//! Recorded tables add up their own minutes, between statements that are further apart as well ([`Sums`]); [`Drift`] makes the minutes of a
//! track whose reports arrive.

use super::balance::{At, EVEN_NS, MOVING_MPS, WINDOW_NS};
use super::neighbours::east_north_m;
use super::way::TURNING_MPS2;
use crate::special::float::{atan2, cos, hypot, sin, sqrt};
use core::f64::consts::PI;

/// What the positions of a track may drift aside of its reported track beyond the shares below, over any minutes on end: 0.7 km at most in
/// 949 shared tracks that are right. Provenance: ours \[m\].
pub const DRIFT_M: f64 = 2000.0;
/// Share of the way that they may drift aside: a track that is a degree off, and the sphere that ways lie on. Provenance: ours \[1\].
const SHARE: f64 = 0.02;
/// The same beside what the track is rounded to. Provenance: ours \[1\].
const ROUNDED: f64 = 0.01;
/// Drift of a track that is computed of velocities in whole knots. Provenance: ours \[m/s\].
const DRIFT_MPS: f64 = 0.3;
/// What tracks are rounded to, or cut: nothing, whole degrees, a byte, and seven bits of it \[deg\].
const GRIDS_DEG: [f64; 4] = [0.0, 1.0, 360.0 / 256.0, 360.0 / 128.0];
/// Multiples of these have decimals of their own. Provenance: ours \[deg\].
const ON_GRID_DEG: f64 = 0.06;
/// Share of the way of a minute by its speeds that lies between its ends where it is compared. Provenance: ours \[1\].
pub const STRAIGHT: f64 = 0.99;
/// Noise of two positions, in standard deviations. Provenance: ours \[1\].
pub const DEVIATIONS: f64 = 6.0;
/// A source that repeats a speed and a track for this long may have no others \[ns\]. Provenance: ours.
const REPEATED_NS: i64 = 10_000_000_000;
/// So many minutes are not compared for that where positions leave a way that they were on: a recording of Paris has three. Provenance: ours.
const REPEATED: u32 = 3;

/// Of minutes on end, to one side.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Side {
    /// By how much positions drifted beyond what they may \[m\].
    pub beyond_m: f64,
    /// How far in all \[m\].
    pub aside_m: f64,
    /// On which way \[m\].
    pub way_m: f64,
    /// The largest noise of a minute \[m\].
    pub noise_m: f64,
    /// Minutes.
    pub n: u32,
}

impl Side {
    /// The next minute; what went the other way ends it.
    fn see(&mut self, aside_m: f64, allowed_m: f64, way_m: f64, noise_m: f64) {
        let beyond_m = self.beyond_m + aside_m - allowed_m;
        *self = if beyond_m > 0.0 {
            let (aside_m, way_m, noise_m) = (self.aside_m + aside_m, self.way_m + way_m, self.noise_m.max(noise_m));
            Self { beyond_m, aside_m, way_m, noise_m, n: self.n.saturating_add(1) }
        } else {
            Self::default()
        };
    }

    /// By how much more than positions that are right drift.
    fn over_m(&self) -> f64 {
        self.beyond_m - DRIFT_M - self.noise_m * (0.5 * sqrt(f64::from(self.n))).max(1.0)
    }
}

/// A drift that positions which are right do not have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drifted {
    /// Beyond what they may \[m\].
    pub over_m: f64,
    /// Aside in all \[m\].
    pub aside_m: f64,
    /// On which way \[m\].
    pub way_m: f64,
    /// In so many minutes.
    pub n: u32,
}

const NOTHING: Drifted = Drifted { over_m: 0.0, aside_m: 0.0, way_m: 0.0, n: 0 };

/// The drifts of a track to either side by each grid that its courses may have, and the worst of each so far.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sums {
    /// By grid: to the right, and to the left.
    pub sides: [[Side; 2]; 4],
    /// By grid.
    pub worst: [Drifted; 4],
    /// Whether all courses so far are on the grid.
    pub on_grid: [bool; 4],
}

impl Default for Sums {
    fn default() -> Self {
        Self { sides: [[Side::default(); 2]; 4], worst: [NOTHING; 4], on_grid: [true; 4] }
    }
}

impl Sums {
    /// A course of the track; NaN is none.
    pub fn course(&mut self, track_rad: f64) {
        let deg = track_rad.to_degrees();
        if !deg.is_finite() {
            return;
        }
        for (on_grid, grid_deg) in self.on_grid.iter_mut().zip(GRIDS_DEG).skip(1) {
            let times = deg / grid_deg;
            let nearest = (times + 0.5_f64.copysign(times)) as i64 as f64;
            *on_grid &= (deg - grid_deg * nearest).abs() <= ON_GRID_DEG;
        }
    }

    /// The next minute: how far the positions went to the right, the way by the speeds, its length, and the noise of its ends.
    pub fn minute(&mut self, aside_m: f64, way_m: f64, length_s: f64, noise_m: f64) {
        self.straight([aside_m, -aside_m], way_m, length_s, noise_m);
    }

    fn straight(&mut self, aside_m: [f64; 2], way_m: f64, length_s: f64, noise_m: f64) {
        for ((sides, worst), grid_deg) in self.sides.iter_mut().zip(&mut self.worst).zip(GRIDS_DEG) {
            let allowed_m = allowed_m(grid_deg, way_m, length_s);
            for (side, aside_m) in sides.iter_mut().zip(aside_m) {
                side.see(aside_m, allowed_m, way_m, noise_m);
                let over_m = side.over_m();
                if over_m > worst.over_m {
                    *worst = Drifted { over_m, aside_m: side.aside_m, way_m: side.way_m, n: side.n };
                }
            }
        }
    }

    /// The worst drift by the coarsest grid that all courses of the track are on; none where it is one that positions may have.
    #[must_use]
    pub fn drifted(&self) -> Option<Drifted> {
        // One course, or a few round ones, are on every grid.
        let [.., degrees, byte, seven_bits] = self.on_grid;
        let coarsest = if degrees {
            1
        } else if seven_bits {
            3
        } else if byte {
            2
        } else {
            0
        };
        Some(self.worst[coarsest]).filter(|worst| worst.over_m > 0.0)
    }
}

/// A place of a track that is believed, and where the source says that it leads.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Led {
    /// The place and the speed.
    pub at: At,
    /// Reported track over the ground from true north, NaN where none is \[rad\].
    pub track_rad: f64,
    /// Root of both horizontal variances, 0 where none is stated \[m\].
    pub sigma_m: f64,
}

impl Led {
    /// The way to another, the same back, in the directions of the middle.
    fn way_to(&self, other: &Self) -> [f64; 2] {
        let ends = [[self.at.lat_rad, self.at.lon_rad], [other.at.lat_rad, other.at.lon_rad]];
        let ([east, north], [west, south]) = (east_north_m(ends[0], ends[1]), east_north_m(ends[1], ends[0]));
        [0.5 * (east - west), 0.5 * (north - south)]
    }
}

/// The minute that is open.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// Where it began.
    pub begin: Led,
    /// The last report.
    pub last: Led,
    /// Since when speed and track are what they are \[ns\].
    pub since_ns: i64,
    /// The longest time for which they were repeated \[ns\].
    pub repeated_ns: i64,
    /// By the speeds \[m\].
    pub way_m: f64,
    /// East and north, where speed and track lead \[m\].
    pub lead_m: [f64; 2],
    /// East and north, where the positions went \[m\].
    pub moved_m: [f64; 2],
}

impl Window {
    const fn begin(led: Led) -> Self {
        Self { begin: led, last: led, since_ns: led.at.time_ns, repeated_ns: 0, way_m: 0.0, lead_m: [0.0; 2], moved_m: [0.0; 2] }
    }

    /// A step of a steady turn is a chord in the mean direction of its ends.
    fn step(&mut self, led: Led) {
        let elapsed_s = led.at.time_ns.saturating_sub(self.last.at.time_ns) as f64 * 1e-9;
        let even_m = 0.5 * (self.last.at.speed_mps + led.at.speed_mps) * elapsed_s;
        let half_rad = 0.5 * turn_rad(self.last.track_rad, led.track_rad);
        let chord_m = even_m * if half_rad.abs() > 1e-6 { sin(half_rad) / half_rad } else { 1.0 };
        let towards = self.last.track_rad + half_rad;
        self.lead_m = [self.lead_m[0] + chord_m * sin(towards), self.lead_m[1] + chord_m * cos(towards)];
        let [east, north] = self.last.way_to(&led);
        self.moved_m = [self.moved_m[0] + east, self.moved_m[1] + north];
        self.way_m += even_m;
        if led.at.speed_mps != self.last.at.speed_mps || led.track_rad != self.last.track_rad {
            self.since_ns = led.at.time_ns;
        }
        self.repeated_ns = self.repeated_ns.max(led.at.time_ns.saturating_sub(self.since_ns));
        self.last = led;
    }

    /// What it is, where it is one to judge.
    fn minute(&self) -> Option<Minute> {
        let (way_m, length_s) = (self.way_m, self.last.at.time_ns.saturating_sub(self.begin.at.time_ns) as f64 * 1e-9);
        let [[lead_east, lead_north], [east, north]] = [self.lead_m, self.moved_m];
        let (lead_m, moved_m) = (hypot(lead_east, lead_north), hypot(east, north));
        let noise_m = DEVIATIONS * hypot(self.begin.sigma_m, self.last.sigma_m);
        if !(way_m >= MOVING_MPS * length_s && lead_m >= STRAIGHT * way_m && moved_m.is_finite()) {
            return None;
        }
        let aside_m = (east * lead_north - north * lead_east) / lead_m;
        let backwards = east * lead_east + north * lead_north < 0.0;
        // What goes backwards is on neither side.
        let sides_m = if backwards { [moved_m; 2] } else { [aside_m, -aside_m] };
        Some(Minute { sides_m, way_m, length_s, noise_m })
    }
}

/// A straight minute.
struct Minute {
    /// How far the positions went to the right and to the left of where speed and track lead.
    sides_m: [f64; 2],
    way_m: f64,
    length_s: f64,
    noise_m: f64,
}

impl Minute {
    /// Whether the positions are on the way that speed and track lead, as far as the coarsest course says.
    fn fits(&self) -> bool {
        let [.., coarsest_deg] = GRIDS_DEG;
        let allowed_m = allowed_m(coarsest_deg, self.way_m, self.length_s) + self.noise_m;
        self.sides_m.into_iter().all(|aside_m| aside_m <= allowed_m)
    }
}

/// What positions may go aside in a minute, beside noise.
fn allowed_m(grid_deg: f64, way_m: f64, length_s: f64) -> f64 {
    SHARE.max(ROUNDED + grid_deg.to_radians()) * way_m + DRIFT_MPS * length_s
}

/// The drifts of one track whose reports arrive. No heap.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Drift {
    /// The minute that is open.
    pub window: Option<Window>,
    /// Whether the positions were on the way that the track leads.
    pub fitted: bool,
    /// Minutes in which they were not any more, of a source that repeats itself.
    pub repeats: u32,
    /// Of the minutes before.
    pub sums: Sums,
}

impl Drift {
    /// The next place, in the order of time. One without a speed and a track is passed over.
    pub fn see(&mut self, led: Led) {
        self.sums.course(led.track_rad);
        if !(led.at.speed_mps.is_finite() && led.track_rad.is_finite()) {
            return;
        }
        let Some(window) = self.window.as_mut() else {
            self.window = Some(Window::begin(led));
            return;
        };
        let elapsed_ns = led.at.time_ns.saturating_sub(window.last.at.time_ns);
        if elapsed_ns <= 0 {
            return;
        }
        // An aircraft may turn by half a turn meanwhile, at 60 degrees of bank.
        let known_s = PI * 0.5 * (window.last.at.speed_mps + led.at.speed_mps) / TURNING_MPS2;
        if elapsed_ns > EVEN_NS || !(elapsed_ns as f64 * 1e-9 <= known_s) {
            self.window = Some(Window::begin(led));
            return;
        }
        window.step(led);
        if led.at.time_ns.saturating_sub(window.begin.at.time_ns) >= WINDOW_NS {
            let (minute, repeated) = (window.minute(), window.repeated_ns >= REPEATED_NS);
            if !repeated {
                self.repeats = 0;
            }
            if let Some(minute) = minute {
                self.judge(&minute, repeated);
            }
            self.window = Some(Window::begin(led));
        }
    }

    /// Positions that leave the way of a source which repeats itself may be right: it may have no other speed and track for a while.
    fn judge(&mut self, minute: &Minute, repeated: bool) {
        let fits = minute.fits();
        if repeated && self.fitted && !fits && self.repeats < REPEATED {
            self.repeats += 1;
            return;
        }
        self.fitted = fits;
        self.sums.straight(minute.sides_m, minute.way_m, minute.length_s, minute.noise_m);
    }

    /// The drift of the track, by all that was seen, where it is more than it may be.
    #[must_use]
    pub fn drifted(&self) -> Option<Drifted> {
        self.sums.drifted()
    }
}

/// From one direction to another, within half a turn.
fn turn_rad(from_rad: f64, to_rad: f64) -> f64 {
    let turned = to_rad - from_rad;
    atan2(sin(turned), cos(turned))
}

#[cfg(test)]
#[path = "drift_tests.rs"]
mod tests;
