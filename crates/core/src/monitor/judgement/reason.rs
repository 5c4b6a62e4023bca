//! Why a position is not `ok`: ids, and sets of them.

use crate::quantity::Reason as Entry;

/// Why a position is not `ok`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Reason {
    /// The filter's state was not moved to the time of the epoch, or it has stopped, or a number of it is none.
    StateStale,
    /// The inertial unit delivers nothing.
    ImuMissing,
    /// The inertial unit delivers samples that are refused.
    ImuRefused,
    /// The inertial unit delivers what its range, the vehicle's envelope or its own repeats rule out.
    ImuImplausible,
    /// The times of the inertial samples contradict their intervals.
    ImuClock,
    /// The inertial unit is declared faulty.
    ImuFault,
    /// The times of the satellite measurements lie outside the declared latency.
    GnssTime,
    /// No snapshot position with a test of its own.
    SnapshotMissing,
    /// The position has a covariance and no level.
    LevelMissing,
    /// The ranges contradict each other and no exclusion resolves it.
    SatellitesInconsistent,
    /// Filter and snapshot contradict each other.
    FilterContradicted,
    /// They did earlier, and nothing has shown since which of them was wrong.
    ContradictionOpen,
    /// The filters with and without satellites disagree.
    FiltersDisagree,
    /// Several stations contradict the filter, or the snapshot where it stands alone.
    StationsContradict,
    /// The filter rejects too large a share of the measurements.
    GatingExcess,
    /// The innovations are larger than the declared errors allow, and no single sensor explains it.
    TuningForeign,
    /// Without satellites: two ranges to DME keep the position.
    DmeDme,
    /// Without satellites: a VOR and a DME keep the position.
    VorDme,
    /// Without satellites and stations.
    Coasting,
    /// The attitude settles after a hole or a new start.
    Aligning,
    /// A fact that the decision needs was not reported.
    FactMissing,
    /// The altimeter contradicts the height of the snapshot.
    AltimeterContradicts,
    /// The filter has estimated biases of its unit that the unit as declared does not have.
    ImuBias,
}

impl Reason {
    /// Every reason, in the order of its number.
    pub const ALL: [Self; 23] = [
        Self::StateStale,
        Self::ImuMissing,
        Self::ImuRefused,
        Self::ImuImplausible,
        Self::ImuClock,
        Self::ImuFault,
        Self::GnssTime,
        Self::SnapshotMissing,
        Self::LevelMissing,
        Self::SatellitesInconsistent,
        Self::FilterContradicted,
        Self::ContradictionOpen,
        Self::FiltersDisagree,
        Self::StationsContradict,
        Self::GatingExcess,
        Self::TuningForeign,
        Self::DmeDme,
        Self::VorDme,
        Self::Coasting,
        Self::Aligning,
        Self::FactMissing,
        Self::AltimeterContradicts,
        Self::ImuBias,
    ];

    /// Its entry in the list of reasons. The status of that entry is the one that it gives alone and for long; [`super::decide`] decides.
    pub const fn entry(self) -> Entry {
        match self {
            Self::StateStale => Entry::StateStale,
            Self::ImuMissing => Entry::ImuMissing,
            Self::ImuRefused => Entry::ImuRefused,
            Self::ImuImplausible => Entry::ImuImplausible,
            Self::ImuClock => Entry::ImuClock,
            Self::ImuFault => Entry::ImuFault,
            Self::GnssTime => Entry::GnssTime,
            Self::SnapshotMissing => Entry::SnapshotMissing,
            Self::LevelMissing => Entry::LevelMissing,
            Self::SatellitesInconsistent => Entry::SatellitesInconsistent,
            Self::FilterContradicted => Entry::FilterContradicted,
            Self::ContradictionOpen => Entry::ContradictionOpen,
            Self::FiltersDisagree => Entry::FiltersDisagree,
            Self::StationsContradict => Entry::StationsContradict,
            Self::GatingExcess => Entry::GatingExcess,
            Self::TuningForeign => Entry::TuningForeign,
            Self::DmeDme => Entry::KeptByDme,
            Self::VorDme => Entry::KeptByVor,
            Self::Coasting => Entry::Coasting,
            Self::Aligning => Entry::Aligning,
            Self::FactMissing => Entry::FactMissing,
            Self::AltimeterContradicts => Entry::AltimeterContradicts,
            Self::ImuBias => Entry::ImuBias,
        }
    }

    /// The id of tables.
    pub const fn id(self) -> &'static str {
        self.entry().id()
    }
}

/// A set of reasons.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Reasons(u32);

impl Reasons {
    /// No reason.
    pub const NONE: Self = Self(0);

    /// With one more.
    #[must_use]
    pub const fn with(self, reason: Reason) -> Self {
        Self(self.0 | 1 << reason as u8)
    }

    pub(super) fn with_if(self, yes: bool, reason: Reason) -> Self {
        if yes { self.with(reason) } else { self }
    }

    /// Whether a reason is in it.
    pub const fn has(self, reason: Reason) -> bool {
        self.0 & 1 << reason as u8 != 0
    }

    /// Whether there is none.
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// The set as bits: bit k is reason k of [`Reason::ALL`].
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// The reasons in it, in the order of [`Reason::ALL`].
    pub fn iter(self) -> impl Iterator<Item = Reason> {
        Reason::ALL.into_iter().filter(move |r| self.has(*r))
    }

    pub(super) fn any(self, of: &[Reason]) -> bool {
        of.iter().any(|r| self.has(*r))
    }
}
