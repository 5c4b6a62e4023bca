//! What others report to the judge.

use crate::quantity::GpsTime;
use crate::solution::ins::{Mode, STATE_AGE_MOST_S};

/// What the filter reports.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FilterFacts {
    /// Time of its state.
    pub time: GpsTime,
    /// Latitude, longitude \[rad\], height \[m\].
    pub position: [f64; 3],
    /// Variances of the position error east, north, up \[m²\].
    pub variance_m2: [f64; 3],
    /// What keeps its position.
    pub mode: Mode,
}

impl FilterFacts {
    /// Of the time of the epoch, and made of numbers that can be right.
    pub(super) fn is_sound(&self, epoch: GpsTime) -> bool {
        let now = epoch.seconds_since(self.time).abs() <= STATE_AGE_MOST_S;
        let numbers = self.position.iter().all(|x| x.is_finite());
        now && numbers && self.variance_m2.iter().all(|v| *v > 0.0 && v.is_finite())
    }
}

/// What the test of the ranges of one instant among each other says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RangesAgree {
    /// They agree, all or after the exclusion of one.
    Yes,
    /// They contradict each other, and no exclusion resolves it.
    No,
    /// There is none to spare: nothing can be tested.
    Untestable,
}

/// A position from the measurements of one instant alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SnapshotFacts {
    /// Of when.
    pub time: GpsTime,
    /// The test of its ranges.
    pub ranges_agree: RangesAgree,
    /// Its own levels, horizontal and vertical \[m\]; `None` for a solved position that brings no level.
    pub level_m: Option<[f64; 2]>,
    /// Distance from it to the filter's position of the same instant after all measurements, horizontal and vertical \[m\].
    pub distance_m: Option<[f64; 2]>,
}

/// Levels of an earlier instant, carried on to the epoch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CarriedFacts {
    /// Age of the snapshot that they rest on \[s\].
    pub age_s: f64,
    /// Horizontal and vertical, with all that may have grown since \[m\].
    pub level_m: [f64; 2],
}

/// The state of the contradiction between filter and snapshot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Agreement {
    /// They agree now, and no earlier contradiction is open.
    Agrees,
    /// Nothing to compare at this epoch; no contradiction is open.
    NotCompared,
    /// They agree now; an earlier contradiction has no cause yet. Horizontal and vertical bound of the snapshot whichever was right \[m\].
    Open {
        /// Infinite where there is none.
        bound_m: [f64; 2],
    },
    /// They contradict each other, or have not agreed for long enough since. The bound as in [`Agreement::Open`].
    Contradicted {
        /// Infinite where there is none.
        bound_m: [f64; 2],
    },
    /// As [`Agreement::Contradicted`], and it was there before the inertial unit failed: that the unit is wrong does not explain it.
    Unexplained {
        /// Infinite where there is none.
        bound_m: [f64; 2],
    },
}

/// What a witness that shares no satellite says of the snapshot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Testimony {
    /// Nothing: it is not heard, or does not exist on board.
    Silent,
    /// Its residual is within what is stated of it.
    Agrees,
    /// Its residual is rarer than one in a thousand.
    Doubts,
    /// Its residual is beyond its stated bound.
    Contradicts,
}

impl Testimony {
    /// What stands after a new statement: only agreement takes back a contradiction, neither silence nor a smaller doubt.
    #[must_use]
    pub fn then(self, next: Self) -> Self {
        match (self, next) {
            (before, Self::Silent) => before,
            (Self::Contradicts, Self::Doubts) => Self::Contradicts,
            _ => next,
        }
    }

    /// Whether the snapshot may stand alone beside this witness. A doubt of one in a thousand is usual in a flight of many instants.
    pub const fn lets_stand(self) -> bool {
        !matches!(self, Self::Contradicts)
    }
}

/// The state of the inertial unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Inertial {
    /// Samples come and are plausible.
    Plausible,
    /// None has come for this time \[s\].
    Missing {
        /// Since the last accepted one \[s\].
        for_s: f64,
    },
    /// Those that come are refused.
    Refused {
        /// Since the last accepted one \[s\].
        for_s: f64,
    },
    /// Their times contradict their intervals.
    Clock,
    /// They are outside range or envelope, or frozen.
    Implausible,
    /// The unit was declared faulty and has not been cleared.
    Fault,
}

/// The share of measurements that the filter rejects.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Gating {
    /// As expected of chance.
    Usual,
    /// Too large, for this time \[s\].
    Excess {
        /// Without a break \[s\].
        for_s: f64,
    },
}

/// The size of all innovations, rejected ones included.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tuning {
    /// As declared.
    AsDeclared,
    /// Too large for the declared errors without any single culprit.
    Foreign,
}

/// The biases of the inertial unit that the filter has estimated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Biases {
    /// As the declared unit has them.
    AsDeclared,
    /// They have been beyond those of the declared unit: it is another unit, or the positions have led the filter. Time does not tell which.
    Beyond,
}

/// Witnesses that share no satellite with the filter. `None` inside: that witness does not exist on board.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Witnesses {
    /// The filter without satellites disagrees with the one with them.
    pub filters_disagree: Option<bool>,
    /// Several stations are left out for a while.
    pub stations_contradict: Option<bool>,
    /// Stations against the snapshot alone.
    pub stations: Testimony,
    /// Altimeter against the height of the snapshot.
    pub altimeter: Testimony,
}

impl Witnesses {
    /// None is on board.
    pub const NONE: Self =
        Self { filters_disagree: None, stations_contradict: None, stations: Testimony::Silent, altimeter: Testimony::Silent };
}

/// Everything that is known at an epoch. `None` means that nobody reported it, which is bad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Facts {
    /// The time for which a position is requested.
    pub epoch: GpsTime,
    /// The filter's state, whatever its time.
    pub filter: Option<FilterFacts>,
    /// The last snapshot, whatever its time.
    pub snapshot: Option<SnapshotFacts>,
    /// Levels carried on from an earlier snapshot, where the epoch has none.
    pub carried: Option<CarriedFacts>,
    /// Filter against snapshot.
    pub agreement: Option<Agreement>,
    /// The inertial unit.
    pub inertial: Option<Inertial>,
    /// Whether the times of the satellite measurements lie within the declared latency.
    pub satellite_times_hold: Option<bool>,
    /// The filter's gates.
    pub gating: Option<Gating>,
    /// The filter's innovations.
    pub tuning: Option<Tuning>,
    /// The estimated biases of the unit.
    pub biases: Option<Biases>,
    /// The others on board.
    pub witnesses: Option<Witnesses>,
}

impl Facts {
    /// Nothing is known: [`decide`] makes `not_available` of it.
    pub const fn none(epoch: GpsTime) -> Self {
        Self {
            epoch,
            filter: None,
            snapshot: None,
            carried: None,
            agreement: None,
            inertial: None,
            satellite_times_hold: None,
            gating: None,
            tuning: None,
            biases: None,
            witnesses: None,
        }
    }
}
