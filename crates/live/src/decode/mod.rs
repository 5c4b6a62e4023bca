//! Bytes of a source to position reports, one at a time.

mod json;
mod nmea;
mod ubx;

use crate::codec::{Damaged, Reader, Writer};
use crate::counters::Refused;
use crate::position::{Position, TrackId};
use navbound_formats::stream::{Damage, Frame, Framer, Protocol};

/// What a source sends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// One JSON object a line: docs/methods/live.md has the fields.
    Json,
    /// u-blox: NAV-PVT with NAV-COV and NAV-TIMEGPS of the same epoch.
    Ubx,
    /// NMEA 0183: GGA with GST of the same time of day, dated by RMC or ZDA.
    Nmea,
}

impl Format {
    /// The format of an id.
    pub fn of(id: &str) -> Option<Self> {
        match id {
            "json" => Some(Self::Json),
            "ubx" => Some(Self::Ubx),
            "nmea" => Some(Self::Nmea),
            _ => None,
        }
    }

    const fn protocol(self) -> Protocol {
        match self {
            Self::Json => Protocol::Lines,
            Self::Ubx | Self::Nmea => Protocol::Receiver,
        }
    }
}

/// A report, or why there is none.
pub(crate) type Decoded = Result<Position, Refused>;

/// Decoder of one source. Between two pieces it keeps an unfinished frame and an unfinished epoch.
#[derive(Debug, Clone)]
pub(crate) struct Decoder {
    framer: Framer,
    epochs: Epochs,
    /// Whose positions a receiver's are.
    track: TrackId,
}

/// The epoch that a receiver's messages build.
#[derive(Debug, Clone)]
enum Epochs {
    Json,
    Ubx(Box<ubx::Epochs>),
    Nmea(Box<nmea::Epochs>),
}

impl Decoder {
    pub(crate) fn new(format: Format, track: TrackId) -> Self {
        let epochs = match format {
            Format::Json => Epochs::Json,
            Format::Ubx => Epochs::Ubx(Box::default()),
            Format::Nmea => Epochs::Nmea(Box::default()),
        };
        Self { framer: Framer::new(format.protocol()), epochs, track }
    }

    /// The next bytes; how many frames or lines were whole.
    pub(crate) fn push(&mut self, bytes: &[u8], out: &mut Vec<Decoded>) -> u64 {
        let (epochs, track, mut n_frames) = (&mut self.epochs, self.track, 0);
        self.framer.push(bytes, &mut |found| n_frames += u64::from(take(epochs, track, &found, out)));
        n_frames
    }

    /// No bytes came for a while, or none will: what waits is all there is.
    pub(crate) fn flush(&mut self, out: &mut Vec<Decoded>) {
        let (epochs, track) = (&mut self.epochs, self.track);
        self.framer.flush(&mut |found| {
            take(epochs, track, &found, out);
        });
        match epochs {
            Epochs::Json => {}
            Epochs::Ubx(epochs) => out.extend(epochs.finish(track)),
            Epochs::Nmea(epochs) => out.extend(epochs.finish(track)),
        }
    }

    pub(crate) fn write(&self, to: &mut Writer) {
        let (rest, skipping) = self.framer.rest();
        to.bytes(rest);
        to.flag(skipping);
        match &self.epochs {
            Epochs::Json => {}
            Epochs::Ubx(epochs) => epochs.write(to),
            Epochs::Nmea(epochs) => epochs.write(to),
        }
    }

    pub(crate) fn read(format: Format, track: TrackId, from: &mut Reader<'_>) -> Result<Self, Damaged> {
        let (rest, skipping) = (from.bytes()?, from.flag()?);
        let framer = Framer::with_rest(format.protocol(), rest, skipping).map_err(|_| Damaged("more bytes wait than a frame has"))?;
        let epochs = match format {
            Format::Json => Epochs::Json,
            Format::Ubx => Epochs::Ubx(Box::new(ubx::Epochs::read(from)?)),
            Format::Nmea => Epochs::Nmea(Box::new(nmea::Epochs::read(from)?)),
        };
        Ok(Self { framer, epochs, track })
    }
}

/// One frame; whether it was whole.
fn take(epochs: &mut Epochs, track: TrackId, found: &Result<Frame<'_>, Damage>, out: &mut Vec<Decoded>) -> bool {
    match (found, epochs) {
        (Err(_), _) => out.push(Err(Refused::DamagedFrame)),
        (Ok(Frame::Line(line)), Epochs::Json) => out.push(json::position(line)),
        (Ok(Frame::Ubx { kind, payload }), Epochs::Ubx(epochs)) => epochs.take(*kind, payload, track, out),
        (Ok(Frame::Nmea(body)), Epochs::Nmea(epochs)) => epochs.take(body, track, out),
        // Frames of other protocols between them are passed over.
        (Ok(_), _) => {}
    }
    found.is_ok()
}
