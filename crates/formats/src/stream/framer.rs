//! Bytes in pieces to frames.

use super::LONGEST_FRAME;
use super::frame::{Damage, Frame};
use super::search::{Among, Look, SYNC, look, next};
use super::{beast, lines};

/// What a stream consists of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Protocol {
    /// UBX, SBF, NovAtel and NMEA sentences, mixed, with anything between them.
    Receiver,
    /// Messages of Mode S, as the receivers called Beast frame them.
    Beast,
    /// Lines of text.
    Lines,
}

/// Kept bytes that no framer can have: more than the longest frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BadRest;

/// Cuts a stream into frames. Between two pieces it keeps at most the bytes of one frame.
#[derive(Debug, Clone)]
pub struct Framer {
    protocol: Protocol,
    kept: Vec<u8>,
    /// Inside a line that is too long.
    skipping: bool,
}

impl Framer {
    /// A framer that has seen nothing yet.
    pub const fn new(protocol: Protocol) -> Self {
        Self { protocol, kept: Vec::new(), skipping: false }
    }

    /// The framer that kept these bytes: see [`Self::rest`].
    ///
    /// # Errors
    /// [`BadRest`] for more bytes than a framer keeps.
    pub fn with_rest(protocol: Protocol, rest: &[u8], skipping: bool) -> Result<Self, BadRest> {
        if rest.len() > LONGEST_FRAME {
            return Err(BadRest);
        }
        Ok(Self { protocol, kept: rest.to_vec(), skipping })
    }

    /// Bytes that wait for more, and whether the line that they belong to is already refused as too long.
    pub fn rest(&self) -> (&[u8], bool) {
        (&self.kept, self.skipping)
    }

    /// The next bytes.
    pub fn push(&mut self, bytes: &[u8], out: &mut impl FnMut(Result<Frame<'_>, Damage>)) {
        // Pieces keep what is searched twice short, whatever arrives at once.
        for piece in bytes.chunks(LONGEST_FRAME) {
            self.kept.extend_from_slice(piece);
            self.take(false, out);
        }
    }

    /// No more bytes follow, or none came for so long that what waits is no frame.
    pub fn flush(&mut self, out: &mut impl FnMut(Result<Frame<'_>, Damage>)) {
        self.take(true, out);
        self.skipping = false;
    }

    fn take(&mut self, ended: bool, out: &mut impl FnMut(Result<Frame<'_>, Damage>)) {
        let used = match self.protocol {
            Protocol::Receiver => receiver(&self.kept, ended, out),
            Protocol::Beast => beast::cut(&self.kept, ended, out),
            Protocol::Lines => lines::cut(&self.kept, &mut self.skipping, ended, out),
        };
        self.kept.drain(..used);
    }
}

/// Cuts frames out of bytes; how many bytes are used up.
fn receiver(bytes: &[u8], ended: bool, out: &mut impl FnMut(Result<Frame<'_>, Damage>)) -> usize {
    let mut at = 0;
    while let Some(rest) = bytes.get(at..).filter(|rest| !rest.is_empty()) {
        let Some(place) = next(rest, Among::Receivers) else { return bytes.len() };
        let begun = rest.get(place..).unwrap_or_default();
        at += place;
        match look(begun, Among::Receivers, ended) {
            Look::Nothing => at += 1,
            Look::NeedMore => return at,
            Look::Frame { length, frame } => {
                out(Ok(frame));
                at += length;
            }
            Look::Damaged(damage) => {
                out(Err(damage));
                at += SYNC;
            }
        }
    }
    bytes.len()
}
