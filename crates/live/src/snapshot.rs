//! A lane as bytes.
//!
//! ```text
//! version, digest of the settings, position in the journal in, bytes of the journal out, state of the decoder, the source and the tracks, CRC-32C of all before
//! ```

use crate::codec::{Damaged, Reader, Writer};
use crate::counters::Counters;
use crate::decode::Decoder;
use crate::feed::Feed;
use crate::lane::Lane;
use crate::position::TrackId;
use crate::settings::Settings;
use crate::track::Track;
use core::fmt;
use navbound_core::monitor::rnp;
use navbound_core::quantity::GpsTime;
use navbound_core::quantity::encoding::crc32c;

/// Version of the layout.
const VERSION: u8 = 26;

/// Why a snapshot is not taken up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SnapshotRefused {
    /// Its checksum does not fit, or it is too short to have one.
    Checksum,
    /// Of a version that this program does not read.
    Version(u8),
    /// Of other settings.
    Settings,
    /// A field that the state cannot have.
    Content(&'static str),
}

impl fmt::Display for SnapshotRefused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Checksum => f.write_str("the snapshot is damaged: its checksum does not fit"),
            Self::Version(version) => write!(f, "version {version} of a snapshot is not one that is read here"),
            Self::Settings => f.write_str("the snapshot belongs to other settings"),
            Self::Content(what) => write!(f, "the snapshot is damaged: {what}"),
        }
    }
}

impl core::error::Error for SnapshotRefused {}

impl From<Damaged> for SnapshotRefused {
    fn from(Damaged(what): Damaged) -> Self {
        Self::Content(what)
    }
}

fn time(to: &mut Writer, time: Option<GpsTime>) {
    to.option(time, |to, time| to.i64(time.nanoseconds()));
}

fn read_time(from: &mut Reader<'_>) -> Result<Option<GpsTime>, Damaged> {
    from.option(|from| from.i64().map(GpsTime::from_nanoseconds))
}

impl Lane {
    /// The whole state beside the settings, behind the input at `position` of the journal in, when `written` bytes of the journal out were
    /// there: without them its outputs would be missing, and the state must not be taken up.
    pub fn snapshot(&self, position: u64, written: u64) -> Vec<u8> {
        let mut to = Writer::default();
        to.u8(VERSION);
        to.0.extend(self.settings.digest);
        to.u64(position);
        to.u64(written);
        self.decoder.write(&mut to);
        self.feed.write(&mut to);
        time(&mut to, self.event_time);
        time(&mut to, self.last_chunk);
        self.counters.write(&mut to);
        self.past.words().into_iter().for_each(|word| to.u64(word));
        to.u32(self.forgotten.len() as u32);
        for (id, (incarnation, last)) in &self.forgotten {
            id.write(&mut to);
            to.u32(*incarnation);
            to.i64(last.nanoseconds());
        }
        to.u32(self.deadlines.len() as u32);
        for (deadline, id) in &self.deadlines {
            to.i64(deadline.nanoseconds());
            id.write(&mut to);
        }
        to.u32(self.tracks.len() as u32);
        for (id, track) in &self.tracks {
            id.write(&mut to);
            track.write(&mut to);
        }
        to.u32(crc32c(&to.0));
        to.0
    }

    /// The lane of a snapshot, the position of the journal in that it stands behind, and the bytes of the journal out that belong to it.
    ///
    /// # Errors
    /// [`SnapshotRefused`] for damage, another version and other settings.
    pub fn restore(settings: Settings, bytes: &[u8]) -> Result<(Self, u64, u64), SnapshotRefused> {
        let (content, crc) = bytes.split_last_chunk::<4>().ok_or(SnapshotRefused::Checksum)?;
        if crc32c(content) != u32::from_le_bytes(*crc) {
            return Err(SnapshotRefused::Checksum);
        }
        let mut from = Reader(content);
        let version = from.u8()?;
        if version != VERSION {
            return Err(SnapshotRefused::Version(version));
        }
        let (digest, rest) = from.0.split_first_chunk::<32>().ok_or(SnapshotRefused::Content("it ends within a field"))?;
        if *digest != settings.digest {
            return Err(SnapshotRefused::Settings);
        }
        from = Reader(rest);
        let (position, written) = (from.u64()?, from.u64()?);
        let statements = settings.statements.clone();
        let decoder = Decoder::read(settings.format, settings.claims, settings.track, statements, &mut from)?;
        let mut lane = Self::new(settings).map_err(|_| SnapshotRefused::Settings)?;
        lane.decoder = decoder;
        lane.feed = Feed::read(&mut from)?;
        (lane.event_time, lane.last_chunk) = (read_time(&mut from)?, read_time(&mut from)?);
        lane.counters = Counters::read(&mut from)?;
        let mut past = [0; rnp::Counters::WORDS];
        for word in &mut past {
            *word = from.u64()?;
        }
        lane.past = rnp::Counters::from_words(past).map_err(|_| SnapshotRefused::Content("a time under watch that is none"))?;
        lane.read_tracks(&mut from)?;
        from.finish()?;
        Ok((lane, position, written))
    }

    fn read_tracks(&mut self, from: &mut Reader<'_>) -> Result<(), SnapshotRefused> {
        for _ in 0..from.u32()? {
            let (id, incarnation) = (TrackId::read(from)?, from.u32()?);
            self.forgotten.insert(id, (incarnation, GpsTime::from_nanoseconds(from.i64()?)));
        }
        for _ in 0..from.u32()? {
            self.deadlines.insert((GpsTime::from_nanoseconds(from.i64()?), TrackId::read(from)?));
        }
        for _ in 0..from.u32()? {
            let id = TrackId::read(from)?;
            let track = Track::read(&self.settings.judge, from)?;
            track.waiting.first().map(|first| self.waiting.insert((first, id)));
            self.tracks.insert(id, track);
        }
        if self.tracks.len() > self.settings.max_tracks {
            return Err(SnapshotRefused::Content("more tracks than are watched"));
        }
        Ok(())
    }
}
