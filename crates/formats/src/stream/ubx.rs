//! Source: u-blox interface description, UBX frame structure; standard.

use super::frame::{Family, Frame};
use super::search::Look;

/// Largest payload that is believed: RXM-RAWX with all its 255 measurements has 8176 bytes.
const LARGEST_PAYLOAD: usize = 8192;
/// Sync, class and identifier, length.
const HEAD: usize = 6;

/// A frame at the begin of `rest`, which begins with the sync.
pub(super) fn look(rest: &[u8], ended: bool) -> Look<'_> {
    let Some(&[_, _, class, id, low, high]) = rest.first_chunk::<HEAD>() else { return Look::unknown(ended) };
    let length = usize::from(u16::from_le_bytes([low, high]));
    if length > LARGEST_PAYLOAD {
        return Look::Nothing;
    }
    let end = HEAD + length;
    let whole = rest.get(HEAD..end).zip(rest.get(end..end + 2)).zip(rest.get(2..end));
    let Some(((payload, sum), summed)) = whole else {
        return Look::cut(ended, Family::Ubx, "the log ends within a UBX frame", rest.len());
    };
    if sum_of(summed) != *sum {
        return Look::damaged(Family::Ubx, "the checksum of a UBX frame is wrong", end + 2);
    }
    Look::Frame { length: end + 2, frame: Frame::Ubx { kind: [class, id], payload } }
}

/// The checksum over class, identifier, length and payload: Fletcher's of eight bits.
fn sum_of(summed: &[u8]) -> [u8; 2] {
    let (a, b) = summed.iter().fold((0_u8, 0_u8), |(a, b), byte| {
        let a = a.wrapping_add(*byte);
        (a, b.wrapping_add(a))
    });
    [a, b]
}

/// A frame of a class and identifier around a payload.
pub(crate) fn frame(kind: [u8; 2], payload: &[u8]) -> Vec<u8> {
    let length = u16::try_from(payload.len()).unwrap_or(u16::MAX).to_le_bytes();
    let mut whole = vec![0xb5, 0x62];
    whole.extend(kind);
    whole.extend(length);
    whole.extend(payload);
    let sum = sum_of(&whole[2..]);
    whole.extend(sum);
    whole
}
