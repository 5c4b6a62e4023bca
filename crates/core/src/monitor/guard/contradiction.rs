//! Filter against snapshot over time: when they contradict each other, which of them is believed, and when a new start is due.
//!
//! The velocity test speaks first where the inertial unit is wrong: an error of acceleration is an error of velocity before it is one of
//! position. A position that moves without motion is no inertial fault. Where both speak and the unit itself shows nothing, nobody knows
//! before the ground stations rule out one of both. A filter that starts anew and contradicts again proves nothing: stations that contradict
//! a spoofer drag it off as well.

use crate::quantity::GpsTime;

/// Agreement without a break after which filter and snapshot are one again \[s\]. Provenance: inferred.
pub const AGREED_S: f64 = 30.0;
/// Failed tests within this time that no new start followed are those of wrong positions: the filter has used none of them, and its unit has led
/// it on to where the next ones are \[s\]. Provenance: inferred.
const BRIEF_S: f64 = 5.0;
/// Agreement without a break after which that is so \[s\]. Provenance: inferred.
const AGREED_AFTER_BRIEF_S: f64 = 5.0;
/// Time that the unit must be plausible before a filter is started anew \[s\]. Provenance: inferred.
const CLEAN_S: f64 = 5.0;
/// Time from which a contradiction was there before the unit showed a fault, so that the fault does not explain it \[s\]. Provenance: inferred.
const BEFORE_S: f64 = 10.0;
/// Time within which new starts are counted \[s\]. Provenance: inferred.
const STARTS_S: f64 = 600.0;
/// New starts within [`STARTS_S`] after which no further one follows on this flight. Provenance: inferred.
const STARTS_MOST: usize = 3;
/// The velocity's square from which it has moved too, and the time before the position's for which that counts \[s\]. Provenance: inferred.
const MOVED: (f64, f64) = (20.0, 10.0);

/// The tests of an instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tests {
    /// Squares: position horizontal, velocity horizontal, position upwards, velocity upwards. Chi-square of 2, 2, 1, 1 degrees of freedom.
    pub square: [f64; 4],
    /// Which of them exceed their limits; a square that is no number does.
    pub exceeds: [bool; 4],
}

impl Tests {
    /// Whether any does.
    pub fn fail(&self) -> bool {
        self.exceeds.iter().any(|e| *e)
    }
    fn moved(&self) -> bool {
        self.exceeds[1] || self.exceeds[3] || !(self.square[1] <= MOVED.0 && self.square[3] <= MOVED.0)
    }
}

/// The state over time.
#[derive(Debug, Clone, Copy, Default)]
pub struct Contradiction {
    raised: Option<GpsTime>,
    failed: Option<GpsTime>,
    moved: Option<GpsTime>,
    implausible: Option<GpsTime>,
    /// The unit is the cause.
    unit: bool,
    /// The position moved without motion: the satellites, or the filter's slow states.
    still: bool,
    /// An earlier one has no cause. Time explains nothing: it stays for the flight.
    open: bool,
    /// It was there before the unit showed a fault.
    before: bool,
    /// While it was there the positions left the way that their own rates lead.
    jumped: bool,
    /// Where the tests did not fail since, they were usual with the covariances from before it.
    returned: bool,
    starts: [Option<GpsTime>; STARTS_MOST],
    started: Option<GpsTime>,
    out: bool,
    /// The filter has estimated biases that its unit does not have: since when, until the unit is found to be the cause and that is over.
    biased: Option<GpsTime>,
    /// A contradiction of which the unit was the cause has been cleared, and nobody has read it since.
    cleared: bool,
}

impl Contradiction {
    /// The tests of an instant, of a filter whose attitude is settled or not; `back` where their squares are usual (a chance above 1e-3) with the
    /// covariances from before the contradiction. A filter that is led on by its unit alone gets less certain, until it agrees with everything;
    /// positions that are led off slowly stay near the limit on both sides of it.
    pub fn judge(&mut self, now: GpsTime, tests: &Tests, settled: bool, back: bool) {
        if tests.moved() {
            self.moved = Some(now);
        }
        if tests.fail() {
            self.still = self.moved.is_none_or(|t| now.seconds_since(t) > MOVED.1) && (self.raised.is_none() || self.still);
            self.fail(now, false);
            return;
        }
        let Some(failed) = self.failed.max(self.started) else { return };
        self.returned &= back;
        let brief = self.is_brief();
        let agreed = now.seconds_since(failed) >= if brief { AGREED_AFTER_BRIEF_S } else { AGREED_S };
        if self.raised.is_some() && agreed && settled && !self.out {
            self.cleared = self.unit;
            if self.unit && !self.before {
                self.biased = None;
            }
            // A cause that has gone leaves nothing open.
            self.open |= !brief && (!self.unit || self.before);
            (self.raised, self.unit, self.still, self.jumped) = (None, false, false, false);
        }
    }

    /// Whether the tests have failed so briefly that the positions were the cause: nothing of them is in the filter. A unit that had led the
    /// filter off would not have led it back.
    fn is_brief(&self) -> bool {
        let Some((raised, failed)) = self.raised.zip(self.failed) else { return false };
        let kept = self.started.is_none_or(|s| s < raised);
        self.returned && !self.unit && !self.before && kept && failed.seconds_since(raised) < BRIEF_S
    }

    /// The unit delivers what cannot be: the evidence is in the unit.
    ///
    /// A contradiction that was there for a while, or is open from earlier, is not explained by it.
    pub fn convict(&mut self, now: GpsTime) {
        self.note_fault(now);
        self.implausible = Some(now);
        self.still = false;
        self.fail(now, true);
    }

    /// The unit has failed in whatever way: what was unexplained before stays so.
    pub fn note_fault(&mut self, now: GpsTime) {
        let unexplained = !self.unit && self.raised.is_some_and(|t| now.seconds_since(t) >= BEFORE_S);
        let biased = !self.unit && self.biased.is_some_and(|t| now.seconds_since(t) >= BEFORE_S);
        self.before |= self.open || unexplained || self.jumped || biased;
    }

    /// The positions have left the way that their own rates lead. Where nothing contradicts them that stays open; where something does it is the
    /// same riddle, which a unit that fails later does not explain.
    pub fn leave_course(&mut self) {
        if self.raised.is_some() && !self.unit {
            self.jumped = true;
        } else {
            self.leave_open();
        }
    }

    /// The biases that the filter has estimated are none that the declared unit has: either that unit is another, or the positions have led the
    /// filter where it had to take its unit for another. A bias that is usual again later takes back nothing: it fades, and what it has
    /// explained stays in the positions.
    pub fn leave_biases(&mut self, now: GpsTime) {
        self.biased.get_or_insert(now);
    }

    /// Whether they have been, and nothing has shown since that the unit was the cause.
    pub const fn is_biased(&self) -> bool {
        self.biased.is_some()
    }

    /// A witness has spoken against satellites that stood alone: a unit that comes back learns from them and explains nothing.
    pub fn leave_open(&mut self) {
        (self.open, self.before) = (true, true);
    }

    /// The ground stations rule out that the inertial unit is right.
    pub fn rule_out_the_unit(&mut self) {
        self.before |= self.jumped;
        self.unit |= self.raised.is_some() && !self.still;
    }

    fn fail(&mut self, now: GpsTime, unit: bool) {
        if self.raised.is_none() {
            (self.raised, self.returned) = (Some(now), true);
        }
        self.failed = Some(now);
        self.unit |= unit;
        if self.starts.iter().all(|s| s.is_some_and(|t| now.seconds_since(t) <= STARTS_S)) {
            self.out = true;
        }
    }

    /// Whether a filter should start anew at the snapshot: it has contradicted it since its last start, the unit has been plausible for a
    /// while, and the satellites are not the ones in doubt.
    pub fn start_is_due(&self, now: GpsTime, after_s: f64) -> bool {
        let Some((raised, failed)) = self.raised.zip(self.failed) else { return false };
        let since = self.started.map_or(raised, |s| s.max(raised));
        let again = self.started.is_none_or(|s| failed > s);
        let clean = self.implausible.is_none_or(|t| now.seconds_since(t) >= after_s);
        again && clean && !self.still && !self.out && now.seconds_since(since) >= after_s
    }

    /// Whether filter and positions have contradicted each other for this time since the last start.
    pub fn lasts(&self, now: GpsTime, after_s: f64) -> bool {
        let Some((raised, failed)) = self.raised.zip(self.failed) else { return false };
        let since = self.started.map_or(raised, |s| s.max(raised));
        self.started.is_none_or(|s| failed > s) && now.seconds_since(since) >= after_s
    }

    /// A filter was started anew.
    pub fn started(&mut self, now: GpsTime) {
        self.starts.rotate_left(1);
        self.starts[STARTS_MOST - 1] = Some(now);
        self.started = Some(now);
    }

    /// Whether a contradiction of which the unit was the cause has been cleared since this was last read.
    pub fn take_cleared(&mut self) -> bool {
        core::mem::take(&mut self.cleared)
    }

    /// Whether they contradict each other, or have not agreed for long enough since.
    pub const fn is_raised(&self) -> bool {
        self.raised.is_some()
    }
    /// Whether an earlier contradiction has no cause.
    pub const fn is_open(&self) -> bool {
        self.open
    }
    /// Whether a contradiction was there before the unit showed a fault.
    pub const fn was_before_the_unit(&self) -> bool {
        self.before
    }
    /// Whether the inertial unit is the cause.
    pub const fn convicts_the_unit(&self) -> bool {
        self.raised.is_some() && self.unit
    }
    /// Whether the unit delivered what cannot be within a while.
    pub fn implausible_lately(&self, now: GpsTime) -> bool {
        self.implausible.is_some_and(|t| now.seconds_since(t) < CLEAN_S)
    }
}

#[cfg(test)]
#[path = "contradiction_tests.rs"]
mod tests;
