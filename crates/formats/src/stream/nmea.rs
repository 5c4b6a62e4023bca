//! Source: NMEA 0183 version 4 as receivers' manuals give it; standard. Makers exceed its 82 characters.

use super::frame::{Family, Frame};
use super::search::Look;

/// Longest sentence that is believed \[B\]. Provenance: ours.
const LONGEST: usize = 1024;

/// Bytes of an address: talker and sentence.
const ADDRESS: usize = 5;

/// A sentence at the begin of `rest`, which begins with `$`.
pub(super) fn look(rest: &[u8], ended: bool) -> Look<'_> {
    let known = rest.get(1..rest.len().min(LONGEST)).unwrap_or_default();
    let addressed = known.iter().take(ADDRESS).all(u8::is_ascii_uppercase) && known.get(ADDRESS).is_none_or(|byte| *byte == b',');
    // Text of a sentence may hold any letter; two capitals stand anywhere by chance. A dollar sign begins the next one: eight bits of a
    // checksum are right for two sentences together once in 256.
    let ends = |byte: &u8| matches!(byte, b'*' | b'\r' | b'\n' | b'$') || !(addressed || matches!(byte, 0x20..=0x7e));
    if known.first().is_some_and(|byte| !byte.is_ascii_uppercase()) {
        return Look::Nothing;
    }
    let Some(place) = known.iter().position(ends) else {
        return if rest.len() < LONGEST { Look::unknown(ended) } else { broken(known) };
    };
    let (Some(body), Some(star)) = (known.get(..place), known.get(place)) else { return Look::Nothing };
    if *star != b'*' {
        return broken(body);
    }
    let Some(&[high, low]) = rest.get(place + 2..).and_then(|digits| digits.first_chunk::<2>()) else {
        return Look::cut(ended, Family::Nmea, "the log ends within a sentence", rest.len());
    };
    let digit = |byte: u8| char::from(byte).to_digit(16);
    let stated = digit(high).zip(digit(low)).map(|(high, low)| 16 * high + low);
    let sum = body.iter().fold(0_u8, |sum, byte| sum ^ byte);
    let length = place + 4;
    if stated != Some(u32::from(sum)) {
        return Look::damaged(Family::Nmea, "the checksum of a sentence is wrong", length);
    }
    // Zeros leave a checksum as it is: what they stand in has lost a part.
    if body.iter().any(u8::is_ascii_control) {
        return Look::damaged(Family::Nmea, "a sentence holds bytes that are no text", length);
    }
    Look::Frame { length, frame: Frame::Nmea(body) }
}

/// What has no checksum: a damaged sentence where it has the address of one, by chance two capitals stand anywhere.
fn broken(body: &[u8]) -> Look<'_> {
    let addressed = body.get(..ADDRESS).is_some_and(|name| name.iter().all(u8::is_ascii_uppercase)) && body.get(ADDRESS) == Some(&b',');
    if addressed { Look::damaged(Family::Nmea, "a sentence breaks off before its checksum", body.len() + 1) } else { Look::Nothing }
}
