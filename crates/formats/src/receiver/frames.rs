//! The frames of a log: the search of [`crate::stream`] over all its bytes. Sentences are passed over.

use crate::stream::{self, Look, look};
use memchr::memchr2_iter;

/// One frame, its checksum verified.
#[derive(Debug, Clone, Copy)]
pub(super) enum Frame<'a> {
    /// UBX: class and identifier.
    Ubx { kind: [u8; 2], payload: &'a [u8] },
    /// SBF: block number without its revision; the body begins with the time of week.
    Sbf { block: u16, body: &'a [u8] },
}

impl<'a> Frame<'a> {
    fn of(frame: stream::Frame<'a>) -> Option<Self> {
        match frame {
            stream::Frame::Ubx { kind, payload } => Some(Self::Ubx { kind, payload }),
            stream::Frame::Sbf { block, body } => Some(Self::Sbf { block, body }),
            stream::Frame::Nmea(_) | stream::Frame::Line(_) => None,
        }
    }

    /// One of those that hold raw data.
    pub(super) fn is_raw(&self) -> bool {
        match self {
            Self::Ubx { kind, .. } => super::ubx::RAW.contains(kind),
            Self::Sbf { block, .. } => super::sbf::RAW.contains(block),
        }
    }
}

/// A frame, or what began as one.
pub(super) struct Found<'a> {
    /// Byte at which it begins.
    pub(super) at: usize,
    /// Its number, from 1.
    pub(super) number: usize,
    /// Its bytes, where it is whole.
    pub(super) length: usize,
    pub(super) frame: Result<Frame<'a>, &'static str>,
}

/// The frames of a log.
pub(super) struct Frames<'a> {
    bytes: &'a [u8],
    at: usize,
    number: usize,
}

impl<'a> Frames<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0, number: 0 }
    }

    /// Frame at a place and its length; `None` where none begins.
    fn look(&self, at: usize) -> Option<(usize, Result<Frame<'a>, &'static str>)> {
        match look(self.bytes.get(at..)?, false, true) {
            Look::Nothing | Look::NeedMore => None,
            Look::Frame { length, frame } => Some((length, Ok(Frame::of(frame)?))),
            Look::Damaged { reason, length } => Some((length, Err(reason))),
        }
    }
}

impl<'a> Iterator for Frames<'a> {
    type Item = Found<'a>;

    fn next(&mut self) -> Option<Found<'a>> {
        let from = self.at;
        for place in memchr2_iter(0xb5, b'$', self.bytes.get(from..)?) {
            let at = from + place;
            let Some((length, frame)) = self.look(at) else { continue };
            self.number += 1;
            // Behind a damaged frame the next one may begin anywhere.
            self.at = at + if frame.is_ok() { length } else { 2 };
            return Some(Found { at, number: self.number, length: if frame.is_ok() { length } else { 0 }, frame });
        }
        self.at = self.bytes.len();
        None
    }
}

/// Whether what stands at a place calls itself a frame of measurements, be it whole or not.
pub(super) fn measures(bytes: &[u8], at: usize) -> bool {
    match bytes.get(at..at + 6) {
        Some([0xb5, 0x62, class, id, ..]) => super::ubx::MEASUREMENTS.contains(&[*class, *id]),
        Some([b'$', b'@', _, _, low, high]) => super::sbf::MEASUREMENTS.contains(&(u16::from_le_bytes([*low, *high]) & 0x1fff)),
        _ => false,
    }
}
