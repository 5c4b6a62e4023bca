//! Source: NovAtel OEM7 commands and logs reference manual, message formats; standard.

use super::LONGEST_FRAME;
use super::check::crc32;
use super::frame::{Family, Frame};
use super::search::Look;

const SYNC: [u8; 3] = [0xaa, 0x44, 0x12];
/// Bytes of the header, as it is documented; a receiver may write a longer one and says so.
const SHORTEST_HEAD: usize = 28;
/// Bytes up to the length of the body.
const BEGIN: usize = 10;
const CRC: usize = 4;
/// Longest ASCII log that is believed \[B\]. Provenance: ours.
const LONGEST_TEXT: usize = 4096;

/// A binary log at the begin of `rest`.
pub(super) fn binary(rest: &[u8], ended: bool) -> Look<'_> {
    if !SYNC.starts_with(rest.get(..rest.len().min(SYNC.len())).unwrap_or_default()) {
        return Look::Nothing;
    }
    let Some(&[_, _, _, head, _, _, _, _, low, high]) = rest.first_chunk::<BEGIN>() else { return Look::unknown(ended) };
    let head = usize::from(head);
    let end = head + usize::from(u16::from_le_bytes([low, high]));
    if head < SHORTEST_HEAD || end + CRC > LONGEST_FRAME {
        return Look::Nothing;
    }
    let whole = rest.get(..end).zip(rest.get(end..).and_then(|sum| sum.first_chunk::<CRC>()));
    let Some((checked, sum)) = whole else {
        return Look::cut(ended, Family::Novatel, "the log ends within a NovAtel message", rest.len());
    };
    let (head, body) = checked.split_at(head);
    if crc32(checked) != u32::from_le_bytes(*sum) {
        return Look::damaged(Family::Novatel, "the CRC of a NovAtel message is wrong", end + CRC);
    }
    Look::Frame { length: end + CRC, frame: Frame::NovatelBinary { head, body } }
}

/// An ASCII log at the begin of `rest`, which begins with `#`: a name in capitals that ends with A, its fields, and the CRC.
pub(super) fn text(rest: &[u8], ended: bool) -> Look<'_> {
    let known = rest.get(1..rest.len().min(LONGEST_TEXT)).unwrap_or_default();
    let whole_name = match known.iter().position(|byte| !matches!(byte, b'A'..=b'Z' | b'0'..=b'9' | b'_')) {
        None if rest.len() < LONGEST_TEXT => return Look::unknown(ended),
        Some(at) => known.get(at) == Some(&b',') && at > 1 && known.get(at - 1) == Some(&b'A'),
        None => false,
    };
    if !whole_name {
        return Look::Nothing;
    }
    let broken = |length| Look::damaged(Family::Novatel, "a NovAtel log without its CRC", length);
    let Some(place) = known.iter().position(|byte| matches!(byte, b'*' | b'#' | b'\r' | b'\n')) else {
        let cut = Look::cut(ended, Family::Novatel, "the log ends within a NovAtel log", rest.len());
        return if rest.len() < LONGEST_TEXT { cut } else { broken(LONGEST_TEXT) };
    };
    let (Some(body), Some(b'*')) = (known.get(..place), known.get(place)) else { return broken(place + 1) };
    let Some(digits) = rest.get(place + 2..).and_then(|digits| digits.first_chunk::<8>()) else {
        return Look::cut(ended, Family::Novatel, "the log ends within a NovAtel log", rest.len());
    };
    let stated = digits.iter().try_fold(0_u32, |sum, digit| Some(sum << 4 | char::from(*digit).to_digit(16)?));
    let length = place + 2 + digits.len();
    if stated != Some(crc32(body)) {
        return Look::damaged(Family::Novatel, "the CRC of a NovAtel log is wrong", length);
    }
    Look::Frame { length, frame: Frame::NovatelText(body) }
}
