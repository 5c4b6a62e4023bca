//! Whether a constellation fits itself and the others: offsets of its clock followed in time, and how many of its satellites are excluded.
//!
//! The size of an offset says nothing: receivers' hardware delays make it anything up to kilometres. Its change does.
//!
//! ```text
//! prior of an offset = mean of the past, memory 600 s;   variance 0.3^2 m^2 + 0.2^2 m^2 t / 600 s,   t since it was last measured
//! ```
//!
//! There is none before 600 s of measurements, after a gap above an hour, or after a reset of the receiver's clock. Provenance: inferred from the offsets
//! of two geodetic receivers (standard deviation 0.13 to 0.22 m over 600 s).

use super::point::{Fix, Offset, Offsets};
use crate::quantity::GpsTime;
use crate::signal::{Constellation, SatelliteId};
use crate::special::float::{exp, sqrt};

const CLOCKS: usize = Constellation::ALL.len();
const SLOTS: usize = 100 * CLOCKS;
/// The constellation whose clock the others are measured against.
const REFERENCE: usize = 0;
/// Memory of an offset \[s\], and the time it must have been measured for before it predicts.
const MEMORY_S: f64 = 600.0;
/// A gap after which an offset is not predicted \[s\].
const GAP_S: f64 = 3600.0;
/// Standard deviation of a prediction, and its growth within the memory \[m\].
const SIGMA_M: f64 = 0.3;
const GROWTH_M: f64 = 0.2;
/// A change of an offset by this many standard deviations is no drift.
const JUMP: f64 = 5.0;
/// Exclusions count for this long \[s\].
const RECENT_S: f64 = 60.0;
/// A receiver's clock that leaves its own drift by more than this was set \[m\], 0.03 ms: receivers set theirs by a millisecond or more.
const CLOCK_SET_M: f64 = 1e4;
/// Spare ranges from which on a position says where the clocks are.
const ENOUGH: usize = 3;

/// What to do with an epoch's constellations.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Treatment {
    /// Constellations to leave out whole.
    pub without: [bool; CLOCKS],
    /// Offsets that the past predicts.
    pub offsets: Offsets,
}

impl Treatment {
    /// Whether any constellation is to be left out.
    pub fn leaves_out(&self) -> bool {
        self.without.contains(&true)
    }
}

/// An offset's past.
#[derive(Debug, Clone, Copy, Default)]
struct Past {
    /// Sum of fading weights, and of weighted offsets.
    weight: f64,
    sum: f64,
    since: Option<GpsTime>,
    last: Option<GpsTime>,
}

impl Past {
    fn predicted(&self, time: GpsTime) -> Option<Offset> {
        let (since, last) = (self.since?, self.last?);
        let age = time.seconds_since(last);
        if !(last.seconds_since(since) >= MEMORY_S && (0.0..=GAP_S).contains(&age)) {
            return None;
        }
        Some(Offset { offset_m: self.sum / self.weight, sigma_m: sqrt(SIGMA_M * SIGMA_M + GROWTH_M * GROWTH_M * age / MEMORY_S) })
    }

    fn take(&mut self, time: GpsTime, offset_m: f64) {
        let age = self.last.map_or(0.0, |last| time.seconds_since(last));
        if !(0.0..=GAP_S).contains(&age) {
            *self = Self::default();
        }
        let fading = exp(-age.max(0.0) / MEMORY_S);
        self.weight = self.weight * fading + 1.0;
        self.sum = self.sum * fading + offset_m;
        self.since = self.since.or(Some(time));
        self.last = Some(time);
    }
}

/// The memory of a receiver's constellations. No heap.
#[derive(Debug, Clone)]
pub struct Constellations {
    used: [Option<GpsTime>; SLOTS],
    excluded: [Option<GpsTime>; SLOTS],
    latest_exclusion: Option<GpsTime>,
    offsets: [Past; CLOCKS],
    /// Time, the reference clock, and its drift since the epoch before.
    clock: Option<(GpsTime, f64, Option<f64>)>,
}

impl Default for Constellations {
    fn default() -> Self {
        Self { used: [None; SLOTS], excluded: [None; SLOTS], latest_exclusion: None, offsets: [Past::default(); CLOCKS], clock: None }
    }
}

impl Constellations {
    /// Take the next epoch in time, solved with a clock for each constellation, or that it could not be.
    pub fn follow(&mut self, time: GpsTime, fix: Option<&Fix>) -> Treatment {
        let Some(fix) = fix else { return Treatment { offsets: self.predicted(time), ..Treatment::default() } };
        self.note(time, fix);
        self.reset_with_the_clock(time, fix.clock_m[REFERENCE]);
        let offsets = self.predicted(time);
        let mut without = [false; CLOCKS];
        for (c, out) in without.iter_mut().enumerate() {
            *out = self.contradicts_itself(c, time) || self.jumped(c, fix, &offsets);
        }
        let enough = fix.consistent && fix.spare >= ENOUGH;
        for c in (0..CLOCKS).filter(|c| *c != REFERENCE && !without[*c] && enough) {
            let offset = fix.clock_m[c] - fix.clock_m[REFERENCE];
            if offset.is_finite() {
                self.offsets[c].take(time, offset);
            }
        }
        // Where all contradict, it is not a constellation that is wrong.
        let all = (0..CLOCKS).all(|c| without[c] || fix.clock_m[c].is_nan());
        Treatment { without: if all { [false; CLOCKS] } else { without }, offsets }
    }

    fn note(&mut self, time: GpsTime, fix: &Fix) {
        for (c, numbers) in fix.used.iter().enumerate() {
            let mut rest = *numbers & ((1 << 100) - 1);
            while rest != 0 {
                self.used[100 * c + rest.trailing_zeros() as usize] = Some(time);
                rest &= rest - 1;
            }
        }
        for satellite in fix.excluded.iter().flatten() {
            if let Some(slot) = self.excluded.get_mut(slot(*satellite)) {
                *slot = Some(time);
                self.latest_exclusion = Some(time);
            }
        }
    }

    /// Most of its satellites, and more than one, were excluded within the last minute.
    fn contradicts_itself(&self, constellation: usize, time: GpsTime) -> bool {
        let recent = |then: &Option<GpsTime>| then.is_some_and(|then| (0.0..=RECENT_S).contains(&time.seconds_since(then)));
        if !recent(&self.latest_exclusion) {
            return false;
        }
        let of = 100 * constellation..100 * (constellation + 1);
        let (used, excluded) = (&self.used[of.clone()], &self.excluded[of]);
        let out = excluded.iter().filter(|t| recent(t)).count();
        let all = used.iter().zip(excluded).filter(|(u, e)| recent(u) || recent(e)).count();
        out > 1 && 2 * out > all
    }

    fn jumped(&self, constellation: usize, fix: &Fix, predicted: &Offsets) -> bool {
        let Some(prior) = predicted.of[constellation].filter(|_| constellation != REFERENCE) else { return false };
        let change = fix.clock_m[constellation] - fix.clock_m[REFERENCE] - prior.offset_m;
        change.abs() > JUMP * sqrt(prior.sigma_m * prior.sigma_m + fix.offset_variance_m2[constellation])
    }

    fn predicted(&self, time: GpsTime) -> Offsets {
        let mut offsets = Offsets { of: self.offsets.map(|past| past.predicted(time)) };
        offsets.of[REFERENCE] = Some(Offset { offset_m: 0.0, sigma_m: 0.0 });
        offsets
    }

    /// Offsets are forgotten where the reference clock leaves the drift it had.
    fn reset_with_the_clock(&mut self, time: GpsTime, clock_m: f64) {
        if clock_m.is_nan() {
            return;
        }
        let step = self.clock.map(|(then, before, drift)| (time.seconds_since(then), clock_m - before, drift));
        let drift = step.and_then(|(passed, change, _)| (passed > 0.0).then_some(change / passed));
        let set = match step {
            Some((passed, ..)) if !(passed >= 0.0) => true,
            Some((passed, change, Some(drift))) => (change - drift * passed).abs() > CLOCK_SET_M,
            _ => false,
        };
        if set {
            self.offsets = [Past::default(); CLOCKS];
        }
        self.clock = Some((time, clock_m, drift.filter(|_| !set)));
    }
}

fn slot(satellite: SatelliteId) -> usize {
    satellite.constellation.index() * 100 + usize::from(satellite.number)
}

#[cfg(test)]
#[path = "constellations_tests.rs"]
mod tests;
