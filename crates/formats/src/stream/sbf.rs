//! Source: Septentrio SBF reference guide, block header; standard.

use super::LONGEST_FRAME;
use super::check::crc16;
use super::frame::{Family, Frame};
use super::search::Look;

/// Sync, checksum, block number, length.
const HEAD: usize = 8;

/// A block at the begin of `rest`, which begins with the sync.
pub(super) fn look(rest: &[u8], ended: bool) -> Look<'_> {
    let Some(&[_, _, s0, s1, b0, b1, l0, l1]) = rest.first_chunk::<HEAD>() else { return Look::unknown(ended) };
    let length = usize::from(u16::from_le_bytes([l0, l1]));
    // A prompt or an answer to a command begins with the same two bytes.
    if length < HEAD || length % 4 != 0 || length > LONGEST_FRAME {
        return Look::Nothing;
    }
    let Some((checked, body)) = rest.get(4..length).zip(rest.get(HEAD..length)) else {
        return Look::cut(ended, Family::Sbf, "the log ends within an SBF block", rest.len());
    };
    if crc16(checked) != u16::from_le_bytes([s0, s1]) {
        return Look::damaged(Family::Sbf, "the CRC of an SBF block is wrong", length);
    }
    Look::Frame { length, frame: Frame::Sbf { block: u16::from_le_bytes([b0, b1]) & 0x1fff, body } }
}
