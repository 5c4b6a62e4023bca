//! Bytes of a source to position reports, one at a time.

mod json;
mod readsb;
mod receiver;
mod statements;

pub(crate) use statements::PassedOver;
pub use statements::{StatementRow, Statements};

use crate::claims::Claims;
use crate::codec::{Damaged, Reader, Writer};
use crate::counters::Refused;
use crate::position::{Position, TrackId};
use navbound_formats::receiver::position::{self, Ends, Kind};
use navbound_formats::stream::{Damage, Frame, Framer, Protocol};
use std::sync::Arc;

/// What a source sends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// One JSON object a line: docs/methods/live.md has the fields.
    Json,
    /// ADS-B states as readsb writes them, one JSON object a position.
    Readsb,
    /// Messages of a receiver.
    Receiver(Kind),
}

impl Format {
    /// The format of an id.
    pub fn of(id: &str) -> Option<Self> {
        match id {
            "json" => Some(Self::Json),
            "readsb" => Some(Self::Readsb),
            _ => Kind::of(id).map(Self::Receiver),
        }
    }

    const fn protocol(self) -> Protocol {
        match self {
            Self::Json | Self::Readsb => Protocol::Lines,
            Self::Receiver(_) => Protocol::Receiver,
        }
    }

    fn epochs(self) -> Option<position::Decoder> {
        match self {
            Self::Json | Self::Readsb => None,
            Self::Receiver(kind) => Some(position::Decoder::new(kind, Ends::WithLast)),
        }
    }
}

/// Whose a line is; `None` where it names no track, or the format has no lines.
pub(crate) fn track_of(format: Format, line: &[u8]) -> Option<TrackId> {
    let line = text(line);
    match format {
        Format::Json => json::track(line),
        Format::Readsb => readsb::track(line),
        Format::Receiver(_) => None,
    }
}

/// A line without the mark by which some programs begin a text in UTF-8.
fn text(line: &[u8]) -> &[u8] {
    line.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(line)
}

/// A report, or why there is none.
pub(crate) type Decoded = Result<Position, Refused>;

/// Decoder of one source. Between two pieces it keeps an unfinished frame and an unfinished epoch.
#[derive(Debug, Clone)]
pub(crate) struct Decoder {
    framer: Framer,
    format: Format,
    /// What the categories of ADS-B stand for.
    claims: Claims,
    /// The epoch that a receiver's messages build; lines are epochs of their own.
    epochs: Option<position::Decoder>,
    /// Whose positions a receiver's are.
    track: TrackId,
    /// What a line says of its position under other keys than those of the contract.
    statements: Arc<Statements>,
    /// The keys of lines that were passed over.
    pub(crate) passed_over: PassedOver,
}

impl Decoder {
    pub(crate) fn new(format: Format, claims: Claims, track: TrackId, statements: Arc<Statements>) -> Self {
        let framer = Framer::new(format.protocol());
        Self { framer, format, claims, epochs: format.epochs(), track, statements, passed_over: PassedOver::default() }
    }

    /// The next bytes; how many frames or lines were whole.
    pub(crate) fn push(&mut self, bytes: &[u8], out: &mut Vec<Decoded>) -> u64 {
        let mut n_frames = 0;
        let Self { framer, format, claims, epochs, track, statements, passed_over } = self;
        let mut of = Of { lines: (*format, claims), epochs: epochs.as_mut(), track: *track, heard: (statements, passed_over) };
        framer.push(bytes, &mut |frame| n_frames += u64::from(of.take(&frame, out)));
        n_frames
    }

    /// No bytes came for a while, or none will: what waits is all there is.
    pub(crate) fn flush(&mut self, out: &mut Vec<Decoded>) {
        let Self { framer, format, claims, epochs, track, statements, passed_over } = self;
        let track = *track;
        let mut of = Of { lines: (*format, claims), epochs: epochs.as_mut(), track, heard: (statements, passed_over) };
        framer.flush(&mut |frame| {
            of.take(&frame, out);
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
        self.passed_over.write(to);
        if let Some(epochs) = &self.epochs {
            receiver::write(epochs, to);
        }
    }

    pub(crate) fn read(
        format: Format,
        claims: Claims,
        track: TrackId,
        statements: Arc<Statements>,
        from: &mut Reader<'_>,
    ) -> Result<Self, Damaged> {
        let (rest, skipping) = (from.bytes()?, from.flag()?);
        let framer = Framer::with_rest(format.protocol(), rest, skipping).map_err(|_| Damaged("more bytes wait than a frame has"))?;
        let passed_over = PassedOver::read(from)?;
        let epochs = match format {
            Format::Json | Format::Readsb => None,
            Format::Receiver(kind) => Some(receiver::read(kind, from)?),
        };
        Ok(Self { framer, format, claims, epochs, track, statements, passed_over })
    }
}

/// What frames are taken by.
struct Of<'a> {
    lines: (Format, &'a Claims),
    epochs: Option<&'a mut position::Decoder>,
    track: TrackId,
    heard: (&'a Statements, &'a mut PassedOver),
}

impl Of<'_> {
    /// One frame; whether it was whole.
    fn take(&mut self, result: &Result<Frame<'_>, Damage>, out: &mut Vec<Decoded>) -> bool {
        match (result, &mut self.epochs, self.lines) {
            (Err(_), ..) => out.push(Err(Refused::DamagedFrame)),
            (Ok(Frame::Line(line)), None, (Format::Readsb, claims)) => out.push(readsb::position(text(line), claims)),
            (Ok(Frame::Line(line)), None, _) => out.push(json::position(text(line), self.heard.0, self.heard.1)),
            (Ok(_), None, _) => {}
            // Frames of other protocols between them are passed over.
            (Ok(frame), Some(epochs), _) => {
                let mut items = Vec::new();
                epochs.take(frame, 0, &mut items);
                out.extend(items.into_iter().filter_map(|item| receiver::decoded(item, self.track)));
            }
        }
        result.is_ok()
    }
}
