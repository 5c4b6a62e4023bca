//! The frames of a raw log: the search of [`crate::stream`] over all its bytes. Sentences are passed over.

use crate::stream::{self, Among, Damage, Place};

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
            _ => None,
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
pub(super) struct Framed<'a> {
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
    places: stream::Frames<'a>,
    number: usize,
}

impl<'a> Frames<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { places: stream::Frames::new(bytes, Among::Raw), number: 0 }
    }
}

impl<'a> Iterator for Frames<'a> {
    type Item = Framed<'a>;

    fn next(&mut self) -> Option<Framed<'a>> {
        let (Place { at, end, .. }, frame) = self.places.by_ref().find_map(|place| match place.frame {
            Ok(frame) => Frame::of(frame).map(|frame| (place, Ok(frame))),
            Err(Damage { reason, .. }) => Some((place, Err(reason))),
        })?;
        self.number += 1;
        Some(Framed { at, number: self.number, length: if frame.is_ok() { end - at } else { 0 }, frame })
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
