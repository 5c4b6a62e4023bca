//! Frames with a right checksum in a stream of anything.
//!
//! Source: u-blox interface description, UBX frame structure; Septentrio SBF reference guide, block header; standard.

use super::bits::{array, u16_at};
use memchr::memchr2_iter;

/// Largest payload of a UBX frame that is believed: RXM-RAWX with all its 255 measurements has 8176 bytes.
const LARGEST_UBX: usize = 8192;
/// Sync, class and identifier, length before a payload; two bytes of checksum behind it.
const UBX_HEAD: usize = 6;
/// Sync, check sum, block number, length.
const SBF_HEAD: usize = 8;

/// One frame, its checksum verified.
#[derive(Debug, Clone, Copy)]
pub(super) enum Frame<'a> {
    /// UBX: class and identifier.
    Ubx { kind: [u8; 2], payload: &'a [u8] },
    /// SBF: block number without its revision; the body begins with the time of week.
    Sbf { block: u16, body: &'a [u8] },
}

impl Frame<'_> {
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
        let rest = self.bytes.get(at..)?;
        match array(rest, 0)? {
            [0xb5, 0x62] => ubx(rest),
            [b'$', b'@'] => sbf(rest),
            _ => None,
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

fn ubx(rest: &[u8]) -> Option<(usize, Result<Frame<'_>, &'static str>)> {
    let kind = array(rest, 2)?;
    let length = usize::from(u16_at(rest, 4)?);
    if length > LARGEST_UBX {
        return None;
    }
    let end = UBX_HEAD + length;
    let (Some(payload), Some(sum)) = (rest.get(UBX_HEAD..end), array(rest, end)) else {
        return Some((end, Err("the log ends within a UBX frame")));
    };
    let (mut a, mut b) = (0_u8, 0_u8);
    for byte in rest.get(2..end)? {
        a = a.wrapping_add(*byte);
        b = b.wrapping_add(a);
    }
    let frame = if [a, b] == sum { Ok(Frame::Ubx { kind, payload }) } else { Err("the checksum of a UBX frame is wrong") };
    Some((end + 2, frame))
}

fn sbf(rest: &[u8]) -> Option<(usize, Result<Frame<'_>, &'static str>)> {
    let (sum, block, length) = (u16_at(rest, 2)?, u16_at(rest, 4)?, usize::from(u16_at(rest, 6)?));
    // A prompt or an answer to a command begins with the same two bytes.
    if length < SBF_HEAD || length % 4 != 0 {
        return None;
    }
    let Some(whole) = rest.get(..length) else {
        return Some((length, Err("the log ends within an SBF block")));
    };
    let checked = whole.get(4..)?;
    let body = whole.get(SBF_HEAD..)?;
    let frame =
        if crc16(checked) == sum { Ok(Frame::Sbf { block: block & 0x1fff, body }) } else { Err("the CRC of an SBF block is wrong") };
    Some((length, frame))
}

/// CRC-16 of the CCITT, polynomial 0x1021, beginning with zero.
pub(super) fn crc16(bytes: &[u8]) -> u16 {
    bytes.iter().fold(0, |crc, byte| crc << 8 ^ TABLE[usize::from((crc >> 8) as u8 ^ byte)])
}

const TABLE: [u16; 256] = {
    let mut table = [0; 256];
    let mut k = 0;
    while k < 256 {
        let (mut crc, mut bit) = ((k as u16) << 8, 0);
        while bit < 8 {
            crc = if crc & 0x8000 == 0 { crc << 1 } else { crc << 1 ^ 0x1021 };
            bit += 1;
        }
        table[k] = crc;
        k += 1;
    }
    table
};
