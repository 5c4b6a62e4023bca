//! Bytes of a source to position reports, one at a time.

mod json;
mod receiver;

use crate::codec::{Damaged, Reader, Writer};
use crate::counters::Refused;
use crate::position::{Position, TrackId};
use navbound_formats::receiver::position::{self, Ends, Kind};
use navbound_formats::stream::{Damage, Frame, Framer, Protocol};

/// What a source sends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// One JSON object a line: docs/methods/live.md has the fields.
    Json,
    /// Messages of a receiver.
    Receiver(Kind),
}

impl Format {
    /// The format of an id.
    pub fn of(id: &str) -> Option<Self> {
        match id {
            "json" => Some(Self::Json),
            _ => Kind::of(id).map(Self::Receiver),
        }
    }

    const fn protocol(self) -> Protocol {
        match self {
            Self::Json => Protocol::Lines,
            Self::Receiver(_) => Protocol::Receiver,
        }
    }

    fn epochs(self) -> Option<position::Decoder> {
        match self {
            Self::Json => None,
            Self::Receiver(kind) => Some(position::Decoder::new(kind, Ends::WithLast)),
        }
    }
}

/// A report, or why there is none.
pub(crate) type Decoded = Result<Position, Refused>;

/// Decoder of one source. Between two pieces it keeps an unfinished frame and an unfinished epoch.
#[derive(Debug, Clone)]
pub(crate) struct Decoder {
    framer: Framer,
    /// The epoch that a receiver's messages build; lines are epochs of their own.
    epochs: Option<position::Decoder>,
    /// Whose positions a receiver's are.
    track: TrackId,
}

impl Decoder {
    pub(crate) fn new(format: Format, track: TrackId) -> Self {
        Self { framer: Framer::new(format.protocol()), epochs: format.epochs(), track }
    }

    /// The next bytes; how many frames or lines were whole.
    pub(crate) fn push(&mut self, bytes: &[u8], out: &mut Vec<Decoded>) -> u64 {
        let (epochs, track, mut n_frames) = (&mut self.epochs, self.track, 0);
        self.framer.push(bytes, &mut |frame| n_frames += u64::from(take(epochs.as_mut(), track, &frame, out)));
        n_frames
    }

    /// No bytes came for a while, or none will: what waits is all there is.
    pub(crate) fn flush(&mut self, out: &mut Vec<Decoded>) {
        let (epochs, track) = (&mut self.epochs, self.track);
        self.framer.flush(&mut |frame| {
            take(epochs.as_mut(), track, &frame, out);
        });
        if let Some(epochs) = epochs {
            let mut items = Vec::new();
            epochs.finish(&mut items);
            out.extend(items.into_iter().filter_map(|item| receiver::decoded(item, track)));
        }
    }

    pub(crate) fn write(&self, to: &mut Writer) {
        let (rest, skipping) = self.framer.rest();
        to.bytes(rest);
        to.flag(skipping);
        if let Some(epochs) = &self.epochs {
            receiver::write(epochs, to);
        }
    }

    pub(crate) fn read(format: Format, track: TrackId, from: &mut Reader<'_>) -> Result<Self, Damaged> {
        let (rest, skipping) = (from.bytes()?, from.flag()?);
        let framer = Framer::with_rest(format.protocol(), rest, skipping).map_err(|_| Damaged("more bytes wait than a frame has"))?;
        let epochs = match format {
            Format::Json => None,
            Format::Receiver(kind) => Some(receiver::read(kind, from)?),
        };
        Ok(Self { framer, epochs, track })
    }
}

/// One frame; whether it was whole.
fn take(epochs: Option<&mut position::Decoder>, track: TrackId, result: &Result<Frame<'_>, Damage>, out: &mut Vec<Decoded>) -> bool {
    match (result, epochs) {
        (Err(_), _) => out.push(Err(Refused::DamagedFrame)),
        (Ok(Frame::Line(line)), None) => out.push(json::position(line)),
        (Ok(_), None) => {}
        // Frames of other protocols between them are passed over.
        (Ok(frame), Some(epochs)) => {
            let mut items = Vec::new();
            epochs.take(frame, 0, &mut items);
            out.extend(items.into_iter().filter_map(|item| receiver::decoded(item, track)));
        }
    }
    result.is_ok()
}
