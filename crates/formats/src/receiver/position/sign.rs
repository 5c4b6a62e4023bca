//! Which receiver wrote a log, recognised by the beginnings of its messages.

use super::Kind;
use crate::stream::{Among, Look, look};
use memchr::{memchr_iter, memmem};

/// Bytes in which a message of a log must begin \[B\]. Provenance: ours.
const LOOK_AT: usize = 1 << 17;

/// Longest sentence with its line end and the time of its arrival \[B\]. Provenance: ours.
const LONGEST_SENTENCE: usize = 1100;

/// Places at which a frame may begin that are tried. Provenance: ours.
const MOST_TRIES: usize = 4096;

/// The receiver whose positions are read: of a mixed log the first of [`Kind::ALL`] with a message that holds a position, else the first
/// with any message. Damaged messages count: a damaged log is a log.
pub fn of(content: &[u8]) -> Option<Kind> {
    let start = content.get(..content.len().min(LOOK_AT)).unwrap_or_default();
    let any = Kind::ALL.into_iter().find(|kind| message(start, *kind))?;
    Some(Kind::ALL.into_iter().find(|kind| position(content, *kind)).unwrap_or(any))
}

/// Whether a message with a position begins anywhere.
pub(super) fn position(bytes: &[u8], kind: Kind) -> bool {
    match kind {
        Kind::Ubx => memmem::find(bytes, b"\xb5\x62\x01\x07").is_some(),
        // Blocks 4006 and 4007, the revision in the upper three bits.
        Kind::Sbf => behind(bytes, b"$@").any(|rest| matches!(rest, [_, _, 0xa6 | 0xa7, high, ..] if high & 0x1f == 0x0f)),
        Kind::Novatel => [b"\xaa\x44\x12\x1c\x2a\x00".as_slice(), b"#BESTPOSA,"].iter().any(|sign| memmem::find(bytes, sign).is_some()),
        Kind::Nmea => sentence(bytes, b"GGA,"),
    }
}

/// Whether a sentence of NMEA that may state a position begins anywhere.
pub fn states_positions(bytes: &[u8]) -> bool {
    sentence(bytes, b"GGA,") || sentence(bytes, b"RMC,")
}

/// Whether a sentence of this name begins anywhere, of whatever talker.
fn sentence(bytes: &[u8], name: &[u8]) -> bool {
    let of_talker = |rest: &[u8]| rest.first_chunk::<2>().is_some_and(|talker| talker.iter().all(u8::is_ascii_uppercase));
    behind(bytes, b"$").any(|rest| of_talker(rest) && rest[2..].starts_with(name))
}

/// Whether any message begins.
fn message(bytes: &[u8], kind: Kind) -> bool {
    match kind {
        Kind::Ubx => begins_a_chain(bytes, b"\xb5\x62", |rest| match rest {
            [0x01..=0x29, 0x00..=0x92, low, high, ..] => Some(8 + usize::from(u16::from_le_bytes([*low, *high]))),
            _ => None,
        }),
        Kind::Sbf => begins_a_chain(bytes, b"$@", |rest| match rest {
            [_, _, _, 0x0f..=0xff, low, high @ 0x00..=0x1f, ..] => Some(usize::from(u16::from_le_bytes([*low, *high]))),
            _ => None,
        }),
        Kind::Novatel => memmem::find(bytes, b"\xaa\x44\x12\x1c").is_some() || behind(bytes, b"#").any(named_log),
        Kind::Nmea => behind(bytes, b"$").any(whole_sentence),
    }
}

/// Whether a frame of the sign begins the bytes, or is whole, or has another behind it: two bytes alone stand in any binary file. `length` is
/// that of a frame by what follows its sign.
fn begins_a_chain(bytes: &[u8], sign: &[u8], length: impl Fn(&[u8]) -> Option<usize>) -> bool {
    let whole = |at: usize| bytes.get(at..).is_some_and(|rest| matches!(look(rest, Among::Raw, true), Look::Frame { .. }));
    memmem::find_iter(bytes, sign).take(MOST_TRIES).any(|at| {
        let stated = bytes.get(at + sign.len()..).and_then(&length).filter(|length| *length >= sign.len());
        stated.is_some_and(|length| at == 0 || bytes.get(at + length..).is_some_and(|rest| rest.starts_with(sign)) || whole(at))
    })
}

/// What follows each place of a sign.
fn behind<'a>(bytes: &'a [u8], sign: &'a [u8]) -> impl Iterator<Item = &'a [u8]> {
    memmem::find_iter(bytes, sign).filter_map(move |at| bytes.get(at + sign.len()..))
}

/// A NovAtel log in ASCII: a name in capitals that ends with A, and a port.
fn named_log(rest: &[u8]) -> bool {
    let n = rest.iter().take_while(|byte| byte.is_ascii_uppercase()).count();
    let (name, rest) = rest.split_at(n);
    let port =
        rest.strip_prefix(b",").is_some_and(|rest| ["COM", "USB", "FILE", "ICOM"].iter().any(|port| rest.starts_with(port.as_bytes())));
    n > 1 && name.ends_with(b"A") && port
}

/// A sentence of talker and name in five capitals, with a checksum and the end of its line, and perhaps the time of its arrival.
fn whole_sentence(rest: &[u8]) -> bool {
    let addressed = rest.get(..5).is_some_and(|name| name.iter().all(u8::is_ascii_uppercase)) && rest.get(5) == Some(&b',');
    // No search of all that follows for each sentence that has no end.
    let begun = rest.get(..rest.len().min(LONGEST_SENTENCE)).unwrap_or_default();
    let Some(line) = memchr::memchr(b'\n', begun).filter(|_| addressed).and_then(|end| begun.get(..end)) else { return false };
    let line = line.strip_suffix(b"\r").unwrap_or(line);
    !line.contains(&b'\r') && memchr_iter(b'*', line).filter_map(|at| line.get(at + 1..)).any(checksum_and_arrival)
}

fn checksum_and_arrival(tail: &[u8]) -> bool {
    let sum = tail.first_chunk::<2>().is_some_and(|sum| sum.iter().all(|byte| matches!(byte, b'0'..=b'9' | b'A'..=b'F')));
    let arrival = tail.get(2..).unwrap_or_default();
    sum && (arrival.is_empty()
        || matches!(arrival, [b',', first, digits @ ..] if first.is_ascii_digit() && digits.iter().all(u8::is_ascii_digit)))
}
