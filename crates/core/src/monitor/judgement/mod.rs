//! One judge for every position that comes from a filter: the status follows from facts, and from nothing else.
//!
//! Others measure and report; [`decide`] alone gives a status. `ok` is granted where every fact is present and good. It is never what is left
//! over when nothing bad was noticed: a fact that is missing counts as bad. Provenance: ours.

mod facts;
mod reason;
#[cfg(test)]
mod tests;

pub use facts::{
    Agreement, Biases, CarriedFacts, Facts, FilterFacts, Gating, Inertial, RangesAgree, SnapshotFacts, Testimony, Tuning, Witnesses,
};
pub use reason::{Reason, Reasons};

use crate::quantity::GpsTime;
use crate::solution::ins::{Mode, STATE_AGE_MOST_S};

/// What may be done with a position, the worst first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Status {
    /// There is no position to be relied on.
    NotAvailable,
    /// A position, with less behind it than should be.
    Degraded,
    /// A position with a level that holds for the risk of the snapshot's test.
    Ok,
}

impl Status {
    /// The word of tables.
    pub const fn word(self) -> &'static str {
        match self {
            Self::NotAvailable => "not_available",
            Self::Degraded => "degraded",
            Self::Ok => "ok",
        }
    }
}

/// Where the position that is given comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// From nowhere.
    None,
    /// From the filter.
    Filter,
    /// From the ranges of the instant alone.
    Snapshot,
}

impl Source {
    /// The word of tables.
    pub const fn word(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Filter => "filter",
            Self::Snapshot => "snapshot",
        }
    }
}

/// What becomes of an epoch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Decision {
    /// What may be done with the position.
    pub status: Status,
    /// Why it is no better.
    pub reasons: Reasons,
    /// Which position is given.
    pub source: Source,
    /// Horizontal protection level of that position; `None` where there is none.
    pub hpl_m: Option<f64>,
    /// Vertical, likewise.
    pub vpl_m: Option<f64>,
    /// Whether filter and satellites contradict each other, now or earlier, and nobody knows which of them was wrong: the covariance of either
    /// is then not that of its error.
    pub disputed: bool,
}

impl Decision {
    /// The reason to name first: the one that weighs most, causes before their consequences.
    pub fn leading(&self) -> Option<Reason> {
        const ORDER: [Reason; 23] = [
            Reason::ImuFault,
            Reason::ImuImplausible,
            Reason::FilterContradicted,
            Reason::ImuBias,
            Reason::FiltersDisagree,
            Reason::StationsContradict,
            Reason::AltimeterContradicts,
            Reason::ImuRefused,
            Reason::ImuMissing,
            Reason::ImuClock,
            Reason::GnssTime,
            Reason::SatellitesInconsistent,
            Reason::GatingExcess,
            Reason::TuningForeign,
            Reason::ContradictionOpen,
            Reason::Aligning,
            Reason::StateStale,
            Reason::DmeDme,
            Reason::VorDme,
            Reason::Coasting,
            Reason::SnapshotMissing,
            Reason::LevelMissing,
            Reason::FactMissing,
        ];
        ORDER.into_iter().find(|r| self.reasons.has(*r))
    }
}

/// Time for which `ok` and a level may rest on an earlier snapshot \[s\]: one and a half periods of a receiver of 1 Hz, so that one that is
/// missing shows. Provenance: inferred.
pub const CARRIED_MOST_S: f64 = 1.5;
/// Time after which a unit that delivers nothing is out, and the snapshot alone is the navigation \[s\]. Provenance: inferred.
pub const ABSENT_MOST_S: f64 = 10.0;
/// Time for which a filter may reject most measurements before its position is not available \[s\]. Provenance: inferred.
pub const EXCESS_MOST_S: f64 = 10.0;

/// The status of an epoch, from facts alone.
///
/// ```text
/// filter given:     HPL = |filter - snapshot| + HPL of the snapshot        |e_f| <= |d| + |e_s|
/// snapshot given:   HPL of the snapshot
/// while a contradiction is open the level of the snapshot is at least the bound of both readings
/// ```
///
/// The filter is given where its state is of the epoch, its unit is plausible and the snapshot does not contradict it; else the snapshot, where
/// its ranges agree; else the filter with what is known of it. A filter's own covariance never makes `ok`.
pub fn decide(facts: &Facts) -> Decision {
    let filter = facts.filter.filter(|f| f.is_sound(facts.epoch));
    let snapshot = facts.snapshot.filter(|s| is_of(s, facts.epoch));
    let mut reasons = common(facts).with_if(filter.is_none(), Reason::StateStale);
    let unit_out = reasons.any(&UNIT_OUT);
    let contradicted = reasons.has(Reason::FilterContradicted);
    let standing_in = snapshot.filter(|s| s.ranges_agree != RangesAgree::No);
    let alone = unit_out || contradicted || filter.is_none();
    // Stations and altimeter are heard against the satellites where these stand alone, or where a contradiction is open.
    let questioned = alone || is_disputed(facts);
    if questioned && let Some(w) = &facts.witnesses {
        reasons = reasons.with_if(!w.stations.lets_stand(), Reason::StationsContradict);
        reasons = reasons.with_if(!w.altimeter.lets_stand(), Reason::AltimeterContradicts);
    }
    let source = match (filter, standing_in) {
        (Some(_), _) if !alone => Source::Filter,
        (_, Some(_)) => Source::Snapshot,
        (Some(_), None) if !reasons.any(&[Reason::ImuImplausible, Reason::ImuFault]) => Source::Filter,
        _ => Source::None,
    };
    if source == Source::Filter
        && let Some(filter) = &filter
    {
        reasons = of_the_filter(reasons, facts, filter);
    }
    let (level, missing) = level(facts, source, snapshot.as_ref());
    if let Some(missing) = missing {
        reasons = reasons.with(missing);
    }
    // No level of a position that a witness contradicts.
    let witnessed = !questioned || lets_the_snapshot_stand(facts);
    let level = level.filter(|_| source != Source::None && witnessed);
    // The positions that led a filter to biases that its unit does not have are those whose level this is.
    let level = level.filter(|_| !led_astray(facts, source));
    let vertical = level.filter(|_| !reasons.has(Reason::AltimeterContradicts));
    let bounded = if is_disputed(facts) { vertical } else { level };
    let status = status(facts, source, reasons, bounded.is_some());
    // What is not to be relied on has no level.
    let [hpl_m, vpl_m] = [level.map(|l| l[0]), vertical.map(|l| l[1])].map(|l| l.filter(|_| status != Status::NotAvailable));
    Decision { status, reasons, source, hpl_m, vpl_m, disputed: is_disputed(facts) }
}

fn is_of(snapshot: &SnapshotFacts, epoch: GpsTime) -> bool {
    snapshot.time.seconds_since(epoch).abs() <= STATE_AGE_MOST_S
}

/// The inertial unit delivers nothing that may carry a position.
const UNIT_OUT: [Reason; 4] = [Reason::ImuMissing, Reason::ImuRefused, Reason::ImuImplausible, Reason::ImuFault];

/// Reasons that do not depend on which position is given.
fn common(facts: &Facts) -> Reasons {
    let mut reasons = Reasons::NONE;
    reasons = match facts.inertial {
        None => reasons.with(Reason::FactMissing),
        Some(Inertial::Plausible) => reasons,
        Some(Inertial::Missing { .. }) => reasons.with(Reason::ImuMissing),
        Some(Inertial::Refused { .. }) => reasons.with(Reason::ImuRefused),
        Some(Inertial::Clock) => reasons.with(Reason::ImuClock),
        Some(Inertial::Implausible) => reasons.with(Reason::ImuImplausible),
        Some(Inertial::Fault) => reasons.with(Reason::ImuFault),
    };
    reasons = match facts.agreement {
        None => reasons.with(Reason::FactMissing),
        Some(Agreement::Agrees | Agreement::NotCompared) => reasons,
        Some(Agreement::Open { .. }) => reasons.with(Reason::ContradictionOpen),
        Some(Agreement::Contradicted { .. } | Agreement::Unexplained { .. }) => reasons.with(Reason::FilterContradicted),
    };
    let inconsistent = facts.snapshot.is_some_and(|s| s.ranges_agree == RangesAgree::No && is_of(&s, facts.epoch));
    reasons = reasons.with_if(inconsistent, Reason::SatellitesInconsistent);
    reasons = match facts.satellite_times_hold {
        None => reasons.with(Reason::FactMissing),
        Some(hold) => reasons.with_if(!hold, Reason::GnssTime),
    };
    reasons = reasons.with_if(facts.biases == Some(Biases::Beyond), Reason::ImuBias);
    match facts.witnesses {
        None => reasons.with(Reason::FactMissing),
        Some(w) => reasons
            .with_if(w.filters_disagree == Some(true), Reason::FiltersDisagree)
            .with_if(w.stations_contradict == Some(true), Reason::StationsContradict)
            .with_if(w.altimeter == Testimony::Contradicts, Reason::AltimeterContradicts),
    }
}

/// Neither stations nor altimeter speak against the snapshot.
fn lets_the_snapshot_stand(facts: &Facts) -> bool {
    facts.witnesses.is_some_and(|w| w.stations.lets_stand() && w.altimeter.lets_stand())
}

/// Reasons of a filter whose position is given.
fn of_the_filter(reasons: Reasons, facts: &Facts, filter: &FilterFacts) -> Reasons {
    let mut reasons = match filter.mode {
        Mode::Gnss => reasons,
        Mode::DmeDme => reasons.with(Reason::DmeDme),
        Mode::VorDme => reasons.with(Reason::VorDme),
        Mode::Coasting => reasons.with(Reason::Coasting),
        Mode::Aligning => reasons.with(Reason::Aligning),
    };
    reasons = match facts.gating {
        None => reasons.with(Reason::FactMissing),
        Some(Gating::Usual) => reasons,
        Some(Gating::Excess { .. }) => reasons.with(Reason::GatingExcess),
    };
    reasons = reasons.with_if(facts.biases.is_none(), Reason::FactMissing);
    match facts.tuning {
        None => reasons.with(Reason::FactMissing),
        Some(Tuning::AsDeclared) => reasons,
        Some(Tuning::Foreign) => reasons.with(Reason::TuningForeign),
    }
}

/// The levels of the position that is given, or why there are none.
fn level(facts: &Facts, source: Source, snapshot: Option<&SnapshotFacts>) -> (Option<[f64; 2]>, Option<Reason>) {
    let tested = snapshot.filter(|s| s.ranges_agree == RangesAgree::Yes);
    let bounded = match (tested, source) {
        (_, Source::None) => return (None, Some(Reason::SnapshotMissing)),
        (Some(s), Source::Snapshot) => s.level_m.map(|l| disputed(facts, l)),
        (Some(s), Source::Filter) => {
            // The bound of both readings is about the snapshot, the distance leads from there to the filter.
            s.level_m.zip(s.distance_m).map(|(l, [dh, dv])| (disputed(facts, l), [dh, dv])).map(|([h, v], [dh, dv])| [dh + h, dv + v])
        }
        (None, Source::Filter) => {
            let carried = facts.carried.filter(|c| c.age_s >= 0.0 && c.level_m.iter().all(is_level));
            // Nothing of this instant checks the filter: beyond the time that the growth covers there is no level.
            let carried = carried.filter(|c| c.age_s <= CARRIED_MOST_S);
            return (carried.map(|c| c.level_m), carried.is_none().then_some(Reason::SnapshotMissing));
        }
        (None, Source::Snapshot) => return (None, Some(Reason::SnapshotMissing)),
    };
    match bounded.filter(|l| l.iter().all(is_level)) {
        Some(level) => (Some(level), None),
        None => (None, Some(Reason::LevelMissing)),
    }
}

fn is_level(level_m: &f64) -> bool {
    level_m.is_finite() && *level_m >= 0.0
}

/// While nobody knows whether filter or satellites were wrong the bound holds for both readings.
fn disputed(facts: &Facts, level: [f64; 2]) -> [f64; 2] {
    match facts.agreement {
        Some(Agreement::Open { bound_m } | Agreement::Contradicted { bound_m } | Agreement::Unexplained { bound_m })
            if is_disputed(facts) =>
        {
            // A comparison that is false for NaN keeps NaN, and no level comes of it.
            core::array::from_fn(|k| if level[k] >= bound_m[k] { level[k] } else { bound_m[k] })
        }
        _ => level,
    }
}

/// Nobody knows whether the filter or the satellites were wrong.
fn is_disputed(facts: &Facts) -> bool {
    match facts.agreement {
        // A unit that fails now explains nothing of what was open before.
        Some(Agreement::Open { .. } | Agreement::Unexplained { .. }) => true,
        Some(Agreement::Contradicted { .. }) => !unit_is_the_cause(facts),
        _ => false,
    }
}

/// The evidence against the inertial unit is in the unit, so that a contradiction says nothing against the satellites.
fn unit_is_the_cause(facts: &Facts) -> bool {
    matches!(facts.inertial, Some(Inertial::Fault | Inertial::Implausible))
}

/// The filter has found biases that its unit does not have, and the position that is given is not one that a wrong unit explains.
fn led_astray(facts: &Facts, source: Source) -> bool {
    facts.biases == Some(Biases::Beyond) && !(source == Source::Snapshot && unit_is_the_cause(facts))
}

fn status(facts: &Facts, source: Source, reasons: Reasons, with_level: bool) -> Status {
    // A unit that is known to be wrong explains why filters and stations fall out: all of these rest on it.
    let explained = source == Source::Snapshot && unit_is_the_cause(facts);
    let doubted = reasons.any(&[Reason::FiltersDisagree, Reason::StationsContradict]) && !explained;
    // What is said against the snapshot itself no unit explains.
    let questioned = source == Source::Snapshot || is_disputed(facts);
    let doubted = doubted || (questioned && !lets_the_snapshot_stand(facts));
    // Two readings and no bound for both: nothing is known.
    let unbounded = is_disputed(facts) && !with_level;
    if source == Source::None || doubted || unbounded {
        return Status::NotAvailable;
    }
    if source == Source::Snapshot {
        return of_the_snapshot(facts, reasons, with_level);
    }
    let rejects = matches!(facts.gating, Some(Gating::Excess { for_s }) if !(for_s < EXCESS_MOST_S));
    let unchecked = reasons.has(Reason::SnapshotMissing);
    let foreign = reasons.any(&[Reason::TuningForeign, Reason::ImuBias]) && unchecked;
    if rejects || foreign || reasons.any(&[Reason::FilterContradicted, Reason::ImuMissing, Reason::ImuRefused]) {
        return Status::NotAvailable;
    }
    if reasons.is_empty() && with_level { Status::Ok } else { Status::Degraded }
}

/// Reasons that say something of the filter and nothing of the snapshot, once the unit is known to be out.
///
/// Filters and stations that fall out are among them: where the unit is not the cause the epoch is not available before this is examined.
const OF_THE_FILTER_ALONE: [Reason; 9] = [
    Reason::StateStale,
    Reason::ImuMissing,
    Reason::ImuRefused,
    Reason::ImuImplausible,
    Reason::ImuFault,
    Reason::FilterContradicted,
    Reason::FiltersDisagree,
    Reason::StationsContradict,
    Reason::ImuBias,
];

/// Without the inertial unit the snapshot is as good as its own test, once the unit is known to be the cause.
fn of_the_snapshot(facts: &Facts, reasons: Reasons, with_level: bool) -> Status {
    let absent = match facts.inertial {
        Some(Inertial::Missing { for_s } | Inertial::Refused { for_s }) => for_s >= ABSENT_MOST_S,
        _ => false,
    };
    let known = !is_disputed(facts) && (unit_is_the_cause(facts) || absent);
    // Biases are among them where the unit is the cause, which `known` asks for and an absent unit does not show.
    let led = led_astray(facts, Source::Snapshot);
    let others = led || reasons.iter().any(|r| !OF_THE_FILTER_ALONE.contains(&r));
    if known && !others && with_level { Status::Ok } else { Status::Degraded }
}
