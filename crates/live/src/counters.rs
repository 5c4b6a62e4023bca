//! What a lane counted.

use crate::codec::{Damaged, Reader, Writer};
use navbound_core::quantity::{Reason, Status};

/// Why something that arrived is no record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Refused {
    /// Not a JSON object with the fields of a position.
    NotAPosition,
    /// Another version of the contract.
    Version,
    /// A name that no track may have.
    TrackName,
    /// A damaged frame or a line that is too long.
    DamagedFrame,
    /// A message shorter than its definition.
    ShortMessage,
    /// A position without a date or a time.
    Undated,
    /// A line of an aircraft without a position.
    NoPosition,
    /// An accuracy of no position.
    AccuracyAlone,
    /// Later than its arrival by more than two seconds.
    FromTheFuture,
    /// Earlier than its arrival by more than the retention.
    TooOld,
    /// A new track beyond the most that are watched.
    FleetFull,
    /// Half of a position, with which no other makes a position that is known to be true.
    HalfAPosition,
    /// A position that the one before contradicts.
    Contradicted,
    /// A position that a later one of its aircraft arrived with.
    Superseded,
    /// A position that others computed or repeat.
    OfOthers,
}

impl Refused {
    /// All, in the order of their codes.
    pub const ALL: [Self; 15] = [
        Self::NotAPosition,
        Self::Version,
        Self::TrackName,
        Self::DamagedFrame,
        Self::ShortMessage,
        Self::Undated,
        Self::NoPosition,
        Self::AccuracyAlone,
        Self::FromTheFuture,
        Self::TooOld,
        Self::FleetFull,
        Self::HalfAPosition,
        Self::Contradicted,
        Self::Superseded,
        Self::OfOthers,
    ];

    /// Whether nothing of it could be read.
    pub(crate) const fn unread(self) -> bool {
        matches!(self, Self::DamagedFrame | Self::NotAPosition)
    }

    /// The id of tables.
    pub const fn id(self) -> &'static str {
        match self {
            Self::NotAPosition => "not_a_position",
            Self::Version => "version",
            Self::TrackName => "track_name",
            Self::DamagedFrame => "damaged_frame",
            Self::ShortMessage => "short_message",
            Self::Undated => "undated",
            Self::NoPosition => "no_position",
            Self::AccuracyAlone => "accuracy_without_position",
            Self::FromTheFuture => "from_the_future",
            Self::TooOld => "too_old",
            Self::FleetFull => "fleet_full",
            Self::HalfAPosition => "half_a_position",
            Self::Contradicted => "contradicted",
            Self::Superseded => "superseded",
            Self::OfOthers => "of_others",
        }
    }
}

/// Counts of a lane, beside those of its monitors.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Counters {
    /// Bytes of the source.
    pub n_bytes: u64,
    /// Frames or lines that were whole.
    pub n_frames: u64,
    /// Records accepted from the source.
    pub n_records: u64,
    /// Records dropped as the repeat of one that waits.
    pub n_duplicate: u64,
    /// Records that came after a later one of their track and were put before it.
    pub n_reordered: u64,
    /// Records that were judged as unusable since they were older than monitoring may be silent when they were released.
    pub n_stale: u64,
    /// Tracks that were forgotten after a long silence.
    pub n_expired: u64,
    /// Faults of ours in one record.
    pub n_internal: u64,
    /// Records that were judged and that rest on less than they should.
    pub n_degraded: u64,
    /// What was refused, by [`Refused`].
    pub refused: [u64; Refused::ALL.len()],
    /// Records whose position was not used, by [`Reason`].
    pub unusable: [u64; Reason::ALL.len()],
    /// The same without a reason.
    pub n_unusable_otherwise: u64,
}

impl Default for Counters {
    fn default() -> Self {
        Self {
            n_bytes: 0,
            n_frames: 0,
            n_records: 0,
            n_duplicate: 0,
            n_reordered: 0,
            n_stale: 0,
            n_expired: 0,
            n_internal: 0,
            n_degraded: 0,
            refused: [0; Refused::ALL.len()],
            unusable: [0; Reason::ALL.len()],
            n_unusable_otherwise: 0,
        }
    }
}

impl Counters {
    pub(crate) const fn refuse(&mut self, reason: Refused) {
        self.refused[reason as usize] += 1;
    }

    /// A record was judged, and its position was used or not.
    pub(crate) fn judged(&mut self, status: Status, reason: Option<Reason>) {
        self.n_degraded += u64::from(status == Status::Degraded);
        if !status.usable() {
            let place = reason.and_then(|reason| self.unusable.get_mut(reason as usize));
            *place.unwrap_or(&mut self.n_unusable_otherwise) += 1;
        }
    }

    /// Frames and lines, whole or damaged, and how many of them could not be read.
    pub(crate) fn read_and_not(&self) -> (u64, u64) {
        let n = |reason: Refused| self.refused[reason as usize];
        let unread = Refused::ALL.into_iter().filter(|reason| reason.unread()).map(n).sum();
        (self.n_frames + n(Refused::DamagedFrame), unread)
    }

    /// Names and counts.
    pub fn named(&self) -> Vec<(String, u64)> {
        let own = [
            ("n_bytes", self.n_bytes),
            ("n_frames", self.n_frames),
            ("n_records", self.n_records),
            ("n_waiting_duplicate", self.n_duplicate),
            ("n_reordered", self.n_reordered),
            ("n_stale", self.n_stale),
            ("n_expired", self.n_expired),
            ("n_internal", self.n_internal),
            ("n_degraded", self.n_degraded),
        ];
        let refused = Refused::ALL.into_iter().zip(self.refused).map(|(reason, n)| (format!("refused_{}", reason.id()), n));
        // Most reasons are none of a stream: a count of nothing is left out.
        let unusable = Reason::ALL.iter().zip(self.unusable).map(|(reason, n)| (format!("unusable_{}", reason.id()), n));
        let unusable = unusable.chain([("unusable_otherwise".to_owned(), self.n_unusable_otherwise)]).filter(|(_, n)| *n > 0);
        own.into_iter().map(|(name, n)| (name.to_owned(), n)).chain(refused).chain(unusable).collect()
    }

    pub(crate) fn write(&self, to: &mut Writer) {
        let own = [self.n_bytes, self.n_frames, self.n_records, self.n_duplicate, self.n_reordered, self.n_stale, self.n_expired];
        let last = self.unusable.into_iter().chain([self.n_unusable_otherwise]);
        own.into_iter().chain([self.n_internal, self.n_degraded]).chain(self.refused).chain(last).for_each(|n| to.u64(n));
    }

    pub(crate) fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        let mut counters = Self {
            n_bytes: from.u64()?,
            n_frames: from.u64()?,
            n_records: from.u64()?,
            n_duplicate: from.u64()?,
            n_reordered: from.u64()?,
            n_stale: from.u64()?,
            n_expired: from.u64()?,
            n_internal: from.u64()?,
            n_degraded: from.u64()?,
            ..Self::default()
        };
        let Self { refused, unusable, n_unusable_otherwise, .. } = &mut counters;
        for count in refused.iter_mut().chain(unusable).chain([n_unusable_otherwise]) {
            *count = from.u64()?;
        }
        Ok(counters)
    }
}
