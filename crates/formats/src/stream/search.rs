//! The search for the next frame in bytes, the one of files and of streams.

use super::frame::{Damage, Family, Frame};
use super::{nmea, novatel, sbf, ubx};

/// What begins at a byte.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Look<'a> {
    /// No frame.
    Nothing,
    /// It depends on bytes that have not arrived.
    NeedMore,
    /// A frame and its length.
    Frame {
        /// Bytes from the sync to behind the checksum.
        length: usize,
        /// The frame.
        frame: Frame<'a>,
    },
    /// What began as a frame. The search goes on behind its sync.
    Damaged(Damage),
}

impl<'a> Look<'a> {
    pub(super) const fn damaged(family: Family, reason: &'static str, length: usize) -> Self {
        Self::Damaged(Damage { family, reason, length })
    }

    /// Too few bytes to say what begins: at the end of all bytes nothing does.
    pub(super) const fn unknown(ended: bool) -> Self {
        if ended { Self::Nothing } else { Self::NeedMore }
    }

    /// A frame began and its end is not there: at the end of all bytes it is damaged.
    pub(super) const fn cut(ended: bool, family: Family, reason: &'static str, length: usize) -> Self {
        if ended { Self::damaged(family, reason, length) } else { Self::NeedMore }
    }
}

/// Which frames are searched for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Among {
    /// UBX and SBF, whose messages hold raw data.
    Raw,
    /// Every receiver's.
    Receivers,
}

/// The first byte of a frame.
const fn begins(byte: u8, among: Among) -> bool {
    matches!(byte, 0xb5 | b'$') || matches!(among, Among::Receivers) && matches!(byte, 0xaa | b'#')
}

/// The next byte at which a frame may begin.
pub(super) fn next(bytes: &[u8], among: Among) -> Option<usize> {
    bytes.iter().position(|byte| begins(*byte, among))
}

/// What begins with the first byte of `rest`. `ended`: no bytes follow.
pub(crate) fn look(rest: &[u8], among: Among, ended: bool) -> Look<'_> {
    match (rest, among) {
        ([0xb5, 0x62, ..], _) => ubx::look(rest, ended),
        ([b'$', b'@', ..], _) => sbf::look(rest, ended),
        ([b'$', _, ..], Among::Receivers) => nmea::look(rest, ended),
        ([0xaa, ..], Among::Receivers) => novatel::binary(rest, ended),
        ([b'#', ..], Among::Receivers) => novatel::text(rest, ended),
        ([0xb5 | b'$'], _) => Look::unknown(ended),
        _ => Look::Nothing,
    }
}

/// A frame of bytes that are all there, or what began as one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Place<'a> {
    /// Byte at which it begins.
    pub at: usize,
    /// Byte behind it; behind the sync of a damaged one.
    pub end: usize,
    /// The frame.
    pub frame: Result<Frame<'a>, Damage>,
}

/// The frames of bytes that are all there.
#[derive(Debug, Clone)]
pub struct Frames<'a> {
    bytes: &'a [u8],
    among: Among,
    at: usize,
}

impl<'a> Frames<'a> {
    /// Those of a file.
    pub const fn new(bytes: &'a [u8], among: Among) -> Self {
        Self { bytes, among, at: 0 }
    }
}

impl<'a> Iterator for Frames<'a> {
    type Item = Place<'a>;

    fn next(&mut self) -> Option<Place<'a>> {
        while let Some(place) = next(self.bytes.get(self.at..)?, self.among) {
            let at = self.at + place;
            let (length, frame) = match look(self.bytes.get(at..)?, self.among, true) {
                Look::Nothing | Look::NeedMore => (1, None),
                Look::Frame { length, frame } => (length, Some(Ok(frame))),
                // Behind a damaged frame the next one may begin anywhere.
                Look::Damaged(damage) => (SYNC, Some(Err(damage))),
            };
            self.at = at + length;
            if let Some(frame) = frame {
                return Some(Place { at, end: self.at, frame });
            }
        }
        self.at = self.bytes.len();
        None
    }
}

/// Bytes of the shortest sync.
pub(super) const SYNC: usize = 2;
