//! Bytes of a source to position reports, one at a time.

mod json;
mod keys;
mod places;
mod readsb;
mod receiver;
mod squitters;
mod statements;

pub use places::PlaceWords;
pub use statements::{StatementRow, Statements};

use crate::claims::Claims;
use crate::codec::{Damaged, Reader, Writer};
use crate::counters::Refused;
use crate::position::{Position, TrackId};
use keys::Keys;
use navbound_core::quantity::GpsTime;
use navbound_formats::mode_s;
use navbound_formats::receiver::position::{self, Ends, Kind};
use navbound_formats::stream::{Damage, Frame, Framer, Protocol};
use squitters::Sky;
use std::sync::Arc;

/// What a source sends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// One JSON object a line: docs/methods/live.md has the fields.
    Json,
    /// ADS-B states as readsb writes them, one JSON object a position.
    Readsb,
    /// Messages of Mode S, in frames of Beast.
    Beast,
    /// Messages of Mode S, in hexadecimal digits, one a line.
    Avr,
    /// Messages of a receiver.
    Receiver(Kind),
}

impl Format {
    /// The format of an id.
    pub fn of(id: &str) -> Option<Self> {
        match id {
            "json" => Some(Self::Json),
            "readsb" => Some(Self::Readsb),
            "beast" => Some(Self::Beast),
            "avr" => Some(Self::Avr),
            _ => Kind::of(id).map(Self::Receiver),
        }
    }

    pub(crate) const fn protocol(self) -> Protocol {
        match self {
            Self::Json | Self::Readsb | Self::Avr => Protocol::Lines,
            Self::Beast => Protocol::Beast,
            Self::Receiver(_) => Protocol::Receiver,
        }
    }

    /// Whether positions are made of several messages, most of which hold none.
    pub(crate) const fn is_of_messages(self) -> bool {
        matches!(self, Self::Beast | Self::Avr)
    }

    fn unfinished(self) -> Unfinished {
        match self {
            Self::Json | Self::Readsb => Unfinished::Nothing,
            Self::Beast | Self::Avr => Unfinished::Sky(Sky::default()),
            Self::Receiver(kind) => Unfinished::Epoch(Box::new(position::Decoder::new(kind, Ends::WithLast))),
        }
    }
}

/// Whose a frame is; `None` where it names no track.
pub(crate) fn track_of(format: Format, frame: &Frame<'_>) -> Option<TrackId> {
    match (format, frame) {
        (Format::Json, Frame::Line(line)) => json::track(text(line)),
        (Format::Readsb, Frame::Line(line)) => readsb::track(text(line)),
        (Format::Avr, Frame::Line(line)) => {
            let (message, n) = mode_s::of_line(line)?;
            squitters::track(&mode_s::squitter(message.get(..n)?).ok()??)
        }
        (Format::Beast, Frame::Beast(beast)) => squitters::track(&mode_s::squitter(beast.message()).ok()??),
        _ => None,
    }
}

/// A line without the mark by which some programs begin a text in UTF-8.
fn text(line: &[u8]) -> &[u8] {
    line.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(line)
}

/// A report, or why there is none.
pub(crate) type Decoded = Result<Position, Refused>;

/// What is kept between two frames.
#[derive(Debug, Clone)]
enum Unfinished {
    /// Lines are epochs of their own.
    Nothing,
    /// The epoch that a receiver's messages build.
    Epoch(Box<position::Decoder>),
    /// What aircraft said of themselves in other messages.
    Sky(Sky),
}

/// Decoder of one source. Between two pieces it keeps an unfinished frame and an unfinished epoch.
#[derive(Debug, Clone)]
pub(crate) struct Decoder {
    framer: Framer,
    format: Format,
    /// What the categories of ADS-B stand for.
    claims: Claims,
    unfinished: Unfinished,
    /// Whose positions a receiver's are.
    track: TrackId,
    /// What a line says of its position under other keys than those of the contract.
    statements: Arc<Statements>,
    /// What was heard beside positions, and what was passed over.
    pub(crate) keys: Keys,
}

impl Decoder {
    pub(crate) fn new(format: Format, claims: Claims, track: TrackId, statements: Arc<Statements>) -> Self {
        let (framer, unfinished) = (Framer::new(format.protocol()), format.unfinished());
        Self { framer, format, claims, unfinished, track, statements, keys: Keys::default() }
    }

    /// The next bytes, which arrived at `arrival`; how many frames or lines were whole.
    pub(crate) fn push(&mut self, bytes: &[u8], arrival: Option<GpsTime>, out: &mut Vec<Decoded>) -> u64 {
        let (mut n_frames, n_before) = (0, out.len());
        let Self { framer, format, claims, unfinished, track, statements, keys } = self;
        let mut of = Of { format: *format, claims, arrival, unfinished, track: *track, heard: (statements, keys) };
        framer.push(bytes, &mut |frame| n_frames += u64::from(of.take(&frame, out)));
        if let (Unfinished::Sky(_), Some(new)) = (unfinished, out.get_mut(n_before..)) {
            squitters::keep_the_last(new);
        }
        n_frames
    }

    /// No bytes came for a while, or none will: what waits is all there is.
    pub(crate) fn flush(&mut self, arrival: Option<GpsTime>, out: &mut Vec<Decoded>) {
        let Self { framer, format, claims, unfinished, track, statements, keys } = self;
        let track = *track;
        let mut of = Of { format: *format, claims, arrival, unfinished, track, heard: (statements, keys) };
        framer.flush(&mut |frame| {
            of.take(&frame, out);
        });
        if let Unfinished::Epoch(epochs) = unfinished {
            let mut items = Vec::new();
            epochs.finish(&mut items);
            out.extend(items.into_iter().filter_map(|item| receiver::decoded(item, track, &mut keys.against)));
        }
    }

    pub(crate) fn write(&self, to: &mut Writer) {
        let (rest, skipping) = self.framer.rest();
        to.bytes(rest);
        to.flag(skipping);
        self.keys.write(to);
        match &self.unfinished {
            Unfinished::Nothing => {}
            Unfinished::Epoch(epochs) => receiver::write(epochs, to),
            Unfinished::Sky(sky) => sky.write(to),
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
        let keys = Keys::read(from)?;
        let unfinished = match format {
            Format::Json | Format::Readsb => Unfinished::Nothing,
            Format::Beast | Format::Avr => Unfinished::Sky(Sky::read(from)?),
            Format::Receiver(kind) => Unfinished::Epoch(Box::new(receiver::read(kind, from)?)),
        };
        Ok(Self { framer, format, claims, unfinished, track, statements, keys })
    }
}

/// What frames are taken by.
struct Of<'a> {
    format: Format,
    claims: &'a Claims,
    arrival: Option<GpsTime>,
    unfinished: &'a mut Unfinished,
    track: TrackId,
    heard: (&'a Statements, &'a mut Keys),
}

impl Of<'_> {
    /// One frame; whether it was whole.
    fn take(&mut self, result: &Result<Frame<'_>, Damage>, out: &mut Vec<Decoded>) -> bool {
        let Ok(frame) = result else {
            out.push(Err(Refused::DamagedFrame));
            return false;
        };
        match (frame, &mut *self.unfinished, self.format) {
            (Frame::Line(line), Unfinished::Nothing, Format::Readsb) => {
                out.push(readsb::position(text(line), self.claims, self.heard.0, self.heard.1))
            }
            (Frame::Line(line), Unfinished::Nothing, _) => out.push(json::position(text(line), self.heard.0, self.heard.1)),
            (Frame::Line(line), Unfinished::Sky(sky), _) => match mode_s::of_line(line) {
                Some((message, n)) => out.extend(squitters::heard(sky, message.get(..n), self.arrival, self.claims)),
                None => out.push(Err(Refused::NotAPosition)),
            },
            (Frame::Beast(beast), Unfinished::Sky(sky), _) if !squitters::computed(beast.counter) => {
                out.extend(squitters::heard(sky, Some(beast.message()), self.arrival, self.claims));
            }
            (Frame::Beast(_), Unfinished::Sky(_), _) => out.push(Err(Refused::OfOthers)),
            // Frames of other protocols between them are passed over.
            (frame, Unfinished::Epoch(epochs), _) => {
                let mut items = Vec::new();
                epochs.take(frame, 0, &mut items);
                out.extend(items.into_iter().filter_map(|item| receiver::decoded(item, self.track, &mut self.heard.1.against)));
            }
            _ => {}
        }
        true
    }
}
