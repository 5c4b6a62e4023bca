//! What an aircraft says of its own speed while its position stands: whether it can have stopped there.

use super::clock::arrival;
use super::motion::{Limits, Report, within};
use super::neighbours::east_north_m;
use super::way::chord_share;
use crate::quantity::GpsTime;
use crate::special::float::hypot;

/// Speed up to which an aircraft may stand: noise of a reported speed. \[m/s\] Provenance: ours.
const STANDS_MPS: f64 = 2.0;

/// Fastest braking of an aircraft, on a runway or in the air \[m/s2\]. Provenance: ours.
const BRAKING_MPS2: f64 = 10.0;

/// How far a position that stands may be from where it began to: noise of decimetres, and rounding \[m\]. An aircraft whose speed counts as
/// moving needs 11 m to brake. Provenance: ours.
const ABOUT_THE_FALL_M: f64 = 5.0;

/// Share of the declared period below which the stamps of a track that has moved crawl: 10 ms of 1 s. Provenance: ours.
const FROZEN_SHARE: f64 = 0.01;

/// Where and when a reported speed fell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fall {
    /// When.
    pub time: GpsTime,
    /// Latitude \[rad\].
    pub lat_rad: f64,
    /// Longitude \[rad\].
    pub lon_rad: f64,
    /// The speed before it is one at which an aircraft moves for certain.
    pub from_moving: bool,
}

impl Fall {
    const fn at(report: &Report, from_moving: bool) -> Self {
        Self { time: report.time, lat_rad: report.lat_rad, lon_rad: report.lon_rad, from_moving }
    }

    /// Whether a report is still where it was.
    fn holds(&self, report: &Report, unchanged: bool) -> bool {
        let [east, north] = east_north_m([self.lat_rad, self.lon_rad], [report.lat_rad, report.lon_rad]);
        unchanged || (self.from_moving && hypot(east, north) <= ABOUT_THE_FALL_M)
    }
}

/// After a gap longer than this an aircraft may have flown on and come back \[s\]. Provenance: ours.
const RETURNS_S: f64 = 60.0;

/// The way on which an aircraft can lose its speed, from the last report where all of it had been flown. Speed is lost only over a way:
///
/// ```text
/// debt = v_0^2 / 2a - |place - place_0| - v^2 / 2a
/// ```
///
/// A position that owes more than its noise for longer than a stale one may last did not stop there, however slowly its speed fell and wherever
/// it creeps since.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Owed {
    /// Latitude of that report \[rad\].
    pub lat_rad: f64,
    /// Longitude \[rad\].
    pub lon_rad: f64,
    /// Way to brake on from its speed \[m\].
    pub way_m: f64,
    /// Since when more than the noise is owed.
    pub since: Option<GpsTime>,
}

impl Owed {
    const fn from(report: &Report, way_m: f64) -> Self {
        Self { lat_rad: report.lat_rad, lon_rad: report.lon_rad, way_m, since: None }
    }

    /// After the next report of a speed; `None` of the debt before begins with it.
    fn after(before: Option<Self>, report: &Report, noise_m: f64) -> Self {
        let way_m = report.speed_mps * report.speed_mps / (2.0 * BRAKING_MPS2);
        let Some(before) = before else { return Self::from(report, way_m) };
        let [east, north] = east_north_m([before.lat_rad, before.lon_rad], [report.lat_rad, report.lon_rad]);
        let debt_m = before.way_m - hypot(east, north) - way_m;
        if debt_m <= 0.0 {
            return Self::from(report, way_m);
        }
        Self { since: (debt_m > noise_m).then(|| before.since.unwrap_or(report.time)), ..before }
    }
}

/// Share of the way by the reported speeds that the first positions after a hold must be beyond, turns apart: speeds are repeated, too.
/// Provenance: ours.
const CAUGHT_UP: f64 = 0.95;

/// A position that stood, and the way by the reported speeds since. One that a stale hold is followed by is as late as the way that it lacks,
/// until it has caught up: between a held position and a true one a source may interpolate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stood {
    /// When it was new.
    pub time: GpsTime,
    /// Latitude \[rad\].
    pub lat_rad: f64,
    /// Longitude \[rad\].
    pub lon_rad: f64,
    /// The way since \[m\].
    pub way_m: f64,
    /// How much further than by the reported speeds the steps up to it led: under stamps that clump a position is early, stands, and the next is no
    /// late one \[m\].
    pub early_m: f64,
    /// It stood until it was stale.
    pub stale: bool,
}

impl Stood {
    const fn at(report: &Report, early_m: f64) -> Self {
        Self { time: report.time, lat_rad: report.lat_rad, lon_rad: report.lon_rad, way_m: 0.0, early_m, stale: false }
    }

    /// After the next report, and by how much its position is late after a hold \[s\]; 0 where it is not.
    fn after(before: Option<Self>, report: &Report, unchanged: bool, passed_s: f64, limits: &Limits) -> (Self, f64) {
        let Some(before) = before.filter(|stood| within(report.time, stood.time, RETURNS_S)) else { return (Self::at(report, 0.0), 0.0) };
        let way_m = before.way_m + if report.speed_mps > STANDS_MPS { report.speed_mps * passed_s } else { 0.0 };
        let stale = before.stale || (unchanged && !within(report.time, before.time, limits.stale_after_s));
        let stood = Self { way_m, stale, ..before };
        if unchanged {
            return (stood, 0.0);
        }
        let [east, north] = east_north_m([before.lat_rad, before.lon_rad], [report.lat_rad, report.lon_rad]);
        let (elapsed_s, made_good_m) = (report.time.seconds_since(before.time), hypot(east, north));
        let due_m = CAUGHT_UP * chord_share(report.speed_mps, elapsed_s) * way_m - before.early_m;
        let late_s = (due_m - made_good_m - limits.noise_m) / report.speed_mps;
        if stale && report.speed_mps > limits.moving_mps && late_s > limits.stale_after_s {
            return (stood, late_s);
        }
        // Speeds that are too small do not add up to an early position. f64::max prefers a number to a NaN.
        (Self::at(report, (before.early_m + made_good_m - (2.0 - CAUGHT_UP) * way_m).max(0.0)), 0.0)
    }
}

/// Speed from which an aircraft is not again where it was, to the length of a step, minutes after: one that goes on from where it stood is as
/// late as it stood. \[m/s\] Provenance: ours.
const RESUMES_MPS: f64 = 80.0;

/// A hold from which that is known: shorter ones begin with a position that was early where rows are made of others each ten seconds. \[s\]
/// Provenance: ours.
const RESUMES_AFTER_S: f64 = 20.0;

/// The last report's place, and how far behind its way by the reported speeds the position is since it went on from where it had stood.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resumed {
    /// Latitude \[rad\].
    pub lat_rad: f64,
    /// Longitude \[rad\].
    pub lon_rad: f64,
    /// \[m\].
    pub behind_m: f64,
}

impl Resumed {
    /// After the next report, whose position is new. `stood_m` is the way by the speeds reported while the one before stood until it was stale.
    fn after(before: Self, report: &Report, stood_m: Option<f64>, elapsed_s: f64) -> Self {
        let at = Self { lat_rad: report.lat_rad, lon_rad: report.lon_rad, behind_m: 0.0 };
        if elapsed_s > RETURNS_S {
            return at;
        }
        let [east, north] = east_north_m([before.lat_rad, before.lon_rad], [report.lat_rad, report.lon_rad]);
        let (step_m, reported_m) = (hypot(east, north), report.speed_mps * elapsed_s);
        match stood_m {
            // Nearer to where a step from there leads than to where the aircraft would be.
            Some(stood_m)
                if report.speed_mps >= RESUMES_MPS
                    && stood_m >= report.speed_mps * RESUMES_AFTER_S
                    && step_m < reported_m + 0.5 * stood_m =>
            {
                Self { behind_m: (before.behind_m + stood_m + reported_m - step_m).max(0.0), ..at }
            }
            // The rows of a hold are missing: a feed may leave out what repeats. Half of what the tightest turn would leave is no turn.
            None if report.speed_mps >= RESUMES_MPS
                && elapsed_s >= RESUMES_AFTER_S
                && step_m < 0.5 * chord_share(report.speed_mps, elapsed_s) * reported_m =>
            {
                Self { behind_m: before.behind_m + reported_m - step_m, ..at }
            }
            _ if before.behind_m > 0.0 && !report.speed_mps.is_nan() => {
                Self { behind_m: (before.behind_m + reported_m - step_m).max(0.0), ..at }
            }
            _ => Self { behind_m: before.behind_m, ..at },
        }
    }

    /// By how much the position is late \[s\].
    fn late_s(&self, report: &Report, limits: &Limits) -> Option<f64> {
        let speed_mps = report.speed_mps.max(limits.moving_mps);
        let late_s = (self.behind_m - limits.noise_m) / speed_mps;
        (late_s > limits.stale_after_s).then_some(late_s)
    }
}

/// What an aircraft says of its own speed, above all while its position stays the same.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gone {
    /// The last report.
    pub seen: Option<GpsTime>,
    /// The way by the speeds reported since the position changed \[m\].
    pub way_m: f64,
    /// How long the reports since the position changed say that the aircraft stood \[s\].
    pub stood_s: f64,
    /// The least speed that braking leaves of those reported before \[m/s\]; NaN before the first.
    pub braked_mps: f64,
    /// Where the reported speed fell faster than an aircraft brakes, until the position has left: it is no evidence that the aircraft stands.
    pub fell: Option<Fall>,
    /// Way to brake on that was not flown.
    pub owed: Option<Owed>,
    /// The last position that was new, or that stood and is not caught up with.
    pub stood: Option<Stood>,
    /// By how much the position is late after a hold \[s\].
    pub late_s: f64,
    /// Where the last report was, and how late since it went on from where it had stood.
    pub resumed: Option<Resumed>,
    /// The position has changed.
    pub moved: bool,
    /// How much longer than by their times the reports of a position took to arrive, at least \[s\].
    pub crawled_s: f64,
}

impl Default for Gone {
    fn default() -> Self {
        let (way_m, stood_s, crawled_s, late_s) = (0.0, 0.0, 0.0, 0.0);
        let (fell, owed, stood, resumed) = (None, None, None, None);
        Self { seen: None, way_m, stood_s, braked_mps: f64::NAN, fell, owed, stood, late_s, resumed, moved: false, crawled_s }
    }
}

impl Gone {
    /// See the next report. Of a gap longer than the latency nobody knows how long the aircraft moved, or stood.
    pub fn step(&mut self, report: &Report, unchanged: bool, limits: &Limits) {
        let elapsed_s = self.seen.map_or(0.0, |seen| report.time.seconds_since(seen)).max(0.0);
        let passed_s = elapsed_s.min(limits.latency_s);
        let speed_mps = report.speed_mps;
        self.moved |= self.seen.is_some() && !unchanged;
        // Once it has moved, a position may be newer once in many reports: only what no source samples so fast crawls.
        let crawls = !self.moved || elapsed_s < FROZEN_SHARE * limits.period_s;
        let waited_s = if crawls { arrival(elapsed_s, limits.period_s) - elapsed_s } else { 0.0 };
        self.crawled_s = if self.seen.is_some() && unchanged { self.crawled_s + waited_s } else { 0.0 };
        if !unchanged {
            let stood_m = self.stood.filter(|stood| stood.stale).map(|stood| (self.way_m - stood.early_m).max(0.0));
            let before = self.resumed.unwrap_or(Resumed { lat_rad: report.lat_rad, lon_rad: report.lon_rad, behind_m: 0.0 });
            self.resumed = Some(Resumed::after(before, report, stood_m.filter(|_| self.way_m > 0.0), elapsed_s));
        }
        let (way_m, stood_s) = if unchanged { (self.way_m, self.stood_s) } else { (0.0, 0.0) };
        self.way_m = way_m + if unchanged && speed_mps > STANDS_MPS { speed_mps * passed_s } else { 0.0 };
        self.stood_s = stood_s + if unchanged && speed_mps <= STANDS_MPS { passed_s } else { 0.0 };
        let (stood, late_s) = Stood::after(self.stood, report, unchanged && self.seen.is_some(), passed_s, limits);
        (self.stood, self.late_s) = (Some(stood), late_s);
        let left_mps = self.braked_mps - BRAKING_MPS2 * elapsed_s;
        // A position that does not change leaves no way to brake on, however long that took.
        let braking_m = (self.braked_mps * self.braked_mps - speed_mps * speed_mps) / (2.0 * BRAKING_MPS2);
        let falls = speed_mps + STANDS_MPS < left_mps || (unchanged && braking_m > limits.noise_m);
        let unmoved = self.fell.filter(|fall| fall.holds(report, unchanged));
        self.fell = unmoved.or_else(|| falls.then(|| Fall::at(report, self.braked_mps > limits.moving_mps)));
        // f64::max prefers a number to a NaN.
        self.braked_mps = speed_mps.max(left_mps);
        self.owed = self.owed.filter(|_| elapsed_s <= RETURNS_S);
        // A report without a speed decides nothing.
        if !speed_mps.is_nan() {
            self.owed = Some(Owed::after(self.owed, report, limits.noise_m));
        }
        self.seen = Some(report.time);
    }

    /// For how long a position stands where no aircraft with its speeds could have stopped \[s\]: since a speed fell that none loses so fast, though
    /// the position changes, since it owes the way to brake on, or as late as it is after a hold, or since it went on from one. None where it may be one, or where a receiver is known to stand.
    pub fn stands_falsely(&self, report: &Report, limits: &Limits) -> Option<f64> {
        let fell = self.fell.filter(|fall| fall.from_moving).map(|fall| fall.time);
        let owes = self.owed.filter(|_| limits.moving_mps.is_finite()).and_then(|owed| owed.since);
        let lasting = |since: &GpsTime| !within(report.time, *since, limits.stale_after_s);
        let late = (self.late_s > 0.0).then(|| report.time.plus_seconds(-self.late_s));
        let resumed = self.resumed.filter(|_| limits.moving_mps.is_finite()).and_then(|resumed| resumed.late_s(report, limits));
        let behind = resumed.map(|late_s| report.time.plus_seconds(-late_s));
        let since = [fell, owes, late, behind].into_iter().flatten().filter(lasting).min()?;
        Some(report.time.seconds_since(since))
    }
}
