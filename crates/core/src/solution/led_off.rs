//! Whether the codes of all satellites moved together while their carrier phases stood still.
//!
//! ```text
//! d_i = (C - lambda Phi)_t - (C - lambda Phi)_t0 = -u_i' S + b + noise      S: where the codes lead the position; b: the clock
//! led off: S' P^-1 S beyond the chi-square of three at 1e-9, |S| beyond 15 m, and residuals that fit (1e-3)
//! ```
//!
//! A phase that begins between two references is put where S and b of its first epoch put it, and inherits their noise: `P + I`, I grows by
//! P m / n with m of n satellites that join.
//!
//! Position and motion of the receiver are in code and phase alike, and d has none of them. A receiver that moves its code by milliseconds
//! moves b alone. Provenance: ours, of standard parts; the limits are inferred.

use super::point::MOST_RANGES;
use super::wls::{Normal, Row};
use crate::geometry::ionosphere::obliquity_squared;
use crate::quantity::GpsTime;
use crate::signal::{Constellation, SatelliteId};
use crate::special::gamma::chi_square_tail;
use nalgebra::{Matrix3, Vector3};

/// References are renewed after this \[s\].
pub const RENEWED_S: f64 = 600.0;
/// A longer silence of a satellite ends its arc of phase \[s\], as that of smoothing.
const LONGEST_GAP_S: f64 = 60.0;
/// Epochs further apart are not compared \[s\]: two of them are a renewal apart.
pub const LONGEST_INTERVAL_S: f64 = 300.0;
/// Longest silence in intervals of the recording: a flag of lost lock is about the time since the last epoch. Derived.
const GAP_INTERVALS: f64 = 1.5;
/// Least shift that is said \[m\].
pub const LEAST_M: f64 = 15.0;
/// Risk that noise alone is beyond its deviation.
const RISK: f64 = 1e-9;
/// Risk of residuals that are not noise.
const MISFIT: f64 = 1e-3;
/// What the ionosphere moves code and phase of one satellite overhead apart by, one deviation \[m/s\]: twice 0.6 TECU a minute on L1; lower down
/// by the square of the obliquity, for the path is longer and its pierce point farther and faster. Provenance: ours.
const DIVERGENCE_MPS: f64 = 0.003;
/// Satellites with an unbroken phase below which nothing stands any longer: as many as unknowns, and one.
const COMMON: usize = 5;
/// Those that say whether the shift fits.
const CHECKED: usize = 6;
/// Fewest that may be left out at most; of many satellites it is half of those that the fit has to spare.
const LEFT_OUT: usize = 2;
const SLOTS: usize = 100 * Constellation::ALL.len();
const ONE: usize = 0;
const UNKNOWNS: usize = 4;

/// A satellite of a solution, as it is compared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Compared {
    /// Which.
    pub satellite: SatelliteId,
    /// Unit vector from the receiver to it, east-north-up.
    pub unit: Vector3<f64>,
    /// 1 / sigma² of its code \[1/m²\].
    pub weight: f64,
}

/// Code and phase of a satellite at an epoch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Heard {
    /// Which.
    pub satellite: SatelliteId,
    /// Code less phase \[m\].
    pub less_phase_m: f64,
    /// Whether the ionosphere moves the two apart: where a second phase is there it need not.
    pub diverges: bool,
    /// Of which measurements.
    pub track: u32,
    /// Whether the receiver flags a loss of lock.
    pub lost: bool,
}

/// Code less phase of one satellite, as long as its phase is unbroken.
#[derive(Debug, Clone, Copy)]
struct Arc {
    seen: Option<GpsTime>,
    /// Of which measurements.
    track: u32,
    diverges: bool,
    less_phase_m: f64,
    /// The same at the time of the references, where codes that nothing leads off had put it; NaN without one.
    reference_m: f64,
}

const NOTHING: Arc = Arc { seen: None, track: 0, diverges: true, less_phase_m: f64::NAN, reference_m: f64::NAN };

/// What was made of a recording's epochs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Comparisons {
    /// Epochs that were compared: enough satellites with an unbroken phase, and residuals that fit.
    pub n_compared: usize,
    /// How often hardly any phase went on while a shift stood. It stands until codes are compared again, and from then on only what has changed
    /// since is seen.
    pub n_dropped: usize,
}

/// The codes of one receiver against their phases, epoch after epoch in time. No heap.
#[derive(Debug, Clone)]
pub struct CodesAgainstPhases {
    arcs: [Arc; SLOTS],
    /// Time of the references.
    since: Option<GpsTime>,
    /// Where the codes lead the position, as long as they do.
    standing: Option<Vector3<f64>>,
    /// Since that was seen hardly any phase went on: the references may have the lead, or none.
    unknown: bool,
    /// What the references have of the noise of shifts before \[m²\].
    inherited: Matrix3<f64>,
    longest_gap_s: f64,
    comparisons: Comparisons,
}

impl CodesAgainstPhases {
    /// Of a recording with an epoch every `interval_s`.
    #[must_use]
    pub fn new(interval_s: f64) -> Self {
        let of_epochs_s = if interval_s <= LONGEST_INTERVAL_S { GAP_INTERVALS * interval_s } else { 0.0 };
        let longest_gap_s = LONGEST_GAP_S.max(of_epochs_s);
        Self {
            arcs: [NOTHING; SLOTS],
            since: None,
            standing: None,
            unknown: false,
            inherited: Matrix3::zeros(),
            longest_gap_s,
            comparisons: Comparisons { n_compared: 0, n_dropped: 0 },
        }
    }

    /// What was made of the epochs.
    #[must_use]
    pub const fn comparisons(&self) -> Comparisons {
        self.comparisons
    }

    /// A satellite that has code and phase at an epoch. All of an epoch before it is judged.
    pub fn hear(&mut self, time: GpsTime, heard: &Heard) {
        let Some(arc) = self.arcs.get(slot(heard.satellite)).copied() else { return };
        let same = heard.track == arc.track && heard.diverges == arc.diverges;
        let unbroken = !heard.lost && same && arc.seen.is_some_and(|seen| self.unbroken(time, seen));
        let reference_m = if unbroken { arc.reference_m } else { f64::NAN };
        let Heard { less_phase_m, track, diverges, .. } = *heard;
        let seen = less_phase_m.is_finite().then_some(time);
        self.arcs[slot(heard.satellite)] = Arc { seen, track, diverges, less_phase_m, reference_m };
    }

    /// Judge an epoch by the satellites of its solution: where the codes lead the position \[m, east, north, up\], `None` where nothing says
    /// that they do.
    pub fn judge(&mut self, time: GpsTime, used: impl Iterator<Item = Compared>) -> Option<Vector3<f64>> {
        let age_s = self.since.map_or(f64::INFINITY, |since| time.seconds_since(since));
        let kept = self.arcs.iter().filter(|a| a.reference_m.is_finite() && a.seen.is_some_and(|seen| self.unbroken(time, seen)));
        if kept.count() < COMMON || !(age_s >= 0.0) {
            // A lead goes on until phases show that it does not.
            self.comparisons.n_dropped += usize::from(self.standing.is_some() && !self.unknown);
            self.unknown = self.standing.is_some();
            self.renew(time);
            return self.standing;
        }
        let mut rows = [Row::default(); MOST_RANGES];
        let mut seen = [None; MOST_RANGES];
        let mut n = 0;
        for (c, (row, place)) in used.zip(rows.iter_mut().zip(&mut seen)) {
            let arc = self.arcs.get(slot(c.satellite)).filter(|a| a.seen == Some(time)).copied().unwrap_or(NOTHING);
            // Two codes have the noise of one twice.
            let wander = if arc.diverges { age_s * divergence_mps(c.unit.z) } else { 0.0 };
            let weight = if arc.reference_m.is_finite() { 1.0 / (2.0 / c.weight + wander * wander) } else { 0.0 };
            *row = Row { unit: c.unit, weight, clock: ONE, residual: if weight > 0.0 { arc.less_phase_m - arc.reference_m } else { 0.0 } };
            *place = Some(c);
            n += 1;
        }
        if let Some(fit) = fitting(&mut rows[..n]) {
            self.comparisons.n_compared += 1;
            // What stands goes on until the codes have moved back, and not because references become less certain.
            let inherited = if self.standing.is_some() { Matrix3::zeros() } else { self.inherited };
            self.standing = beyond(&fit.shift, &(fit.covariance + inherited)).then_some(fit.shift);
            self.unknown = false;
            self.join(time, &fit, seen.iter().take(n).flatten());
        }
        if age_s >= RENEWED_S {
            // Of references of unknown codes nothing says where they were without a lead.
            let (led, inherited) = (self.standing.filter(|_| !self.unknown).unwrap_or_default(), self.inherited);
            self.renew(time);
            self.correct(&led, seen.iter().take(n).flatten());
            if self.standing.is_some() {
                self.inherited = inherited;
            }
        }
        self.standing
    }

    /// Give satellites whose phase began since, and has a direction, the reference that the shift of now puts theirs at. They inherit its noise:
    /// each is one of `n` that carry it.
    fn join<'a>(&mut self, time: GpsTime, fit: &Fit, used: impl Iterator<Item = &'a Compared>) {
        let mut joined = 0;
        for c in used {
            if let Some(arc) = self.arcs.get_mut(slot(c.satellite)).filter(|a| a.seen == Some(time) && a.reference_m.is_nan()) {
                arc.reference_m = arc.less_phase_m - fit.clock + c.unit.dot(&fit.shift);
                joined += 1;
            }
        }
        self.inherited += fit.covariance * (f64::from(joined) / (f64::from(joined) + (fit.spare + UNKNOWNS) as f64));
    }

    fn unbroken(&self, time: GpsTime, seen: GpsTime) -> bool {
        (0.0..=self.longest_gap_s).contains(&time.seconds_since(seen))
    }

    /// References of all that is heard now.
    fn renew(&mut self, time: GpsTime) {
        self.since = Some(time);
        self.inherited = Matrix3::zeros();
        for arc in &mut self.arcs {
            arc.reference_m = if arc.seen == Some(time) { arc.less_phase_m } else { f64::NAN };
        }
    }

    /// Put the references where codes that nothing leads off had been: a satellite without a direction has none.
    fn correct<'a>(&mut self, led: &Vector3<f64>, used: impl Iterator<Item = &'a Compared>) {
        if *led == Vector3::zeros() {
            return;
        }
        let mut references = [f64::NAN; SLOTS];
        for c in used {
            if let (Some(reference), Some(arc)) = (references.get_mut(slot(c.satellite)), self.arcs.get(slot(c.satellite))) {
                *reference = arc.reference_m + c.unit.dot(led);
            }
        }
        for (arc, reference) in self.arcs.iter_mut().zip(references) {
            arc.reference_m = reference;
        }
    }
}

fn slot(satellite: SatelliteId) -> usize {
    satellite.constellation.index() * 100 + usize::from(satellite.number)
}

/// What the ionosphere moves code and phase apart by, one deviation \[m/s\].
fn divergence_mps(sin_elevation: f64) -> f64 {
    DIVERGENCE_MPS * obliquity_squared((1.0 - sin_elevation * sin_elevation).max(0.0))
}

fn beyond(shift: &Vector3<f64>, covariance: &Matrix3<f64>) -> bool {
    let deviation = covariance.try_inverse().map_or(f64::NAN, |inverse| shift.dot(&(inverse * shift)));
    shift.norm() > LEAST_M && chi_square_tail(3.0, deviation) < RISK
}

/// The shift that fits: those that do not fit are left out, the one first without which the others fit best.
fn fitting(rows: &mut [Row]) -> Option<Fit> {
    let compared = rows.iter().filter(|row| row.weight > 0.0).count();
    for _ in 0..LEFT_OUT.max(compared.saturating_sub(COMMON) / 2) {
        let whole = Fit::of(rows)?;
        if whole.fits() {
            return Some(whole);
        }
        let mut best: Option<(usize, f64)> = None;
        for k in 0..rows.len() {
            let weight = core::mem::replace(&mut rows[k].weight, 0.0);
            if let Some(fit) = Fit::of(rows).filter(|f| weight > 0.0 && best.is_none_or(|(_, least)| f.squares < least)) {
                best = Some((k, fit.squares));
            }
            rows[k].weight = weight;
        }
        rows[best?.0].weight = 0.0;
    }
    Fit::of(rows).filter(Fit::fits)
}

struct Fit {
    shift: Vector3<f64>,
    covariance: Matrix3<f64>,
    clock: f64,
    squares: f64,
    spare: usize,
}

impl Fit {
    /// Of the rows that have a weight, where these are enough to be checked.
    fn of(rows: &[Row]) -> Option<Self> {
        let rows = || rows.iter().filter(|r| r.weight > 0.0).copied();
        let n = rows().count();
        if n < CHECKED {
            return None;
        }
        let normal = Normal::new(rows()).ok()?;
        let (shift, covariance) = (normal.step()?, normal.inverse()?);
        let clock = normal.clock(ONE, &shift);
        let left = |r: Row| r.residual - clock + r.unit.dot(&shift);
        let squares = rows().map(|r| r.weight * left(r) * left(r)).sum();
        Some(Self { shift, covariance, clock, squares, spare: n - UNKNOWNS })
    }

    fn fits(&self) -> bool {
        chi_square_tail(self.spare as f64, self.squares) >= MISFIT
    }
}

#[cfg(test)]
#[path = "led_off_tests.rs"]
mod tests;
