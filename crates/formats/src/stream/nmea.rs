//! Source: NMEA 0183 version 4 as receivers' manuals give it; standard. Makers exceed its 82 characters.

use super::frame::Frame;
use super::search::Look;

/// Longest sentence that is believed \[B\]. Provenance: ours.
const LONGEST: usize = 1024;

/// A sentence at the begin of `rest`, which begins with `$`.
pub(super) fn look(rest: &[u8], ended: bool) -> Look<'_> {
    let known = rest.get(1..rest.len().min(LONGEST)).unwrap_or_default();
    if known.first().is_some_and(|byte| !byte.is_ascii_uppercase()) {
        return Look::Nothing;
    }
    let Some(place) = known.iter().position(|byte| *byte == b'*' || !matches!(byte, 0x20..=0x7e)) else {
        return if rest.len() < LONGEST { Look::unknown(ended) } else { Look::Nothing };
    };
    let (Some(body), Some(star)) = (known.get(..place), known.get(place)) else { return Look::Nothing };
    if *star != b'*' {
        return Look::Nothing;
    }
    let Some(&[high, low]) = rest.get(place + 2..).and_then(|digits| digits.first_chunk::<2>()) else {
        return Look::cut(ended, "the log ends within a sentence", rest.len());
    };
    let digit = |byte: u8| char::from(byte).to_digit(16);
    let stated = digit(high).zip(digit(low)).map(|(high, low)| 16 * high + low);
    let sum = body.iter().fold(0_u8, |sum, byte| sum ^ byte);
    let length = place + 4;
    if stated != Some(u32::from(sum)) {
        return Look::damaged("the checksum of a sentence is wrong", length);
    }
    Look::Frame { length, frame: Frame::Nmea(body) }
}
