//! Frames of a journal on a disk or a line.
//!
//! ```text
//! u32   bytes of the payload
//! u32   CRC-32C of the payload
//! ...   payload; its first byte is the version of what follows
//! ```
//!
//! Little-endian. A frame whose end is missing is the torn end of a journal whose writer was stopped; a frame whose checksum is wrong is damage.

use crate::codec::{Damaged, Reader, Writer};
use navbound_core::quantity::GpsTime;
use navbound_core::quantity::encoding::crc32c;

/// Version of the payloads of a journal in.
pub(crate) const VERSION: u8 = 1;
/// Version of the payloads of a journal out.
const VERSION_OUT: u8 = 3;
/// Length and checksum before a payload \[B\].
pub const HEAD: usize = 8;
/// Longest payload that is believed \[B\]: no memory is taken for a damaged length.
pub const LONGEST_PAYLOAD: usize = 8 << 20;

/// A payload in its frame.
pub fn frame(payload: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(HEAD + payload.len());
    bytes.extend((payload.len() as u32).to_le_bytes());
    bytes.extend(crc32c(payload).to_le_bytes());
    bytes.extend(payload);
    bytes
}

/// What stands at the begin of bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Next<'a> {
    /// A payload, and the bytes of its frame.
    Payload(&'a [u8], usize),
    /// Fewer bytes than the frame has.
    Torn,
    /// Not a frame.
    Damaged,
}

/// The first frame of some bytes.
pub fn next(bytes: &[u8]) -> Next<'_> {
    let Some((head, rest)) = bytes.split_first_chunk::<HEAD>() else { return Next::Torn };
    let [l0, l1, l2, l3, c0, c1, c2, c3] = *head;
    let (length, crc) = (u32::from_le_bytes([l0, l1, l2, l3]) as usize, u32::from_le_bytes([c0, c1, c2, c3]));
    if length > LONGEST_PAYLOAD {
        return Next::Damaged;
    }
    match rest.get(..length) {
        None => Next::Torn,
        Some(payload) if crc32c(payload) == crc => Next::Payload(payload, HEAD + length),
        Some(_) => Next::Damaged,
    }
}

/// Outputs of one input as they stand in the journal out: the position of the journal in behind that input, when they were written, and they.
pub fn outputs(position: u64, emitted: GpsTime, outputs: &[u8]) -> Vec<u8> {
    let mut to = Writer::default();
    to.u8(VERSION_OUT);
    to.u64(position);
    to.i64(emitted.nanoseconds());
    to.0.extend(outputs);
    to.0
}

/// Parts of what [`outputs`] made.
///
/// # Errors
/// [`Damaged`] for another version and for bytes that end early.
pub fn outputs_of(payload: &[u8]) -> Result<(u64, GpsTime, &[u8]), Damaged> {
    let mut from = Reader(payload);
    if from.u8()? != VERSION_OUT {
        return Err(Damaged("another version of the journal"));
    }
    Ok((from.u64()?, GpsTime::from_nanoseconds(from.i64()?), from.0))
}
