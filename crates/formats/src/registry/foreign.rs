//! Formats that are known and not read: recognised, so that nobody looks for a table in them.
//!
//! Frames as their interface documents and public decoders describe them. Provenance: standard (from knowledge of the formats).

use super::File;
use navbound_core::signal::sbas::crc24q;

const LOOK_AT: usize = 1 << 16;
/// Places at which a stream may begin that are tried.
const MOST_TRIES: usize = 64;
/// Frames one behind the other that make a stream of a kind: a single one may stand in other data by chance.
const FRAMES: usize = 3;
/// More than the longest frame \[B\].
const LONGEST: usize = 1100;

pub(super) fn ulog(file: &File<'_>) -> bool {
    file.content.starts_with(b"ULog\x01\x12\x35")
}

pub(super) fn rtcm3(file: &File<'_>) -> bool {
    stream(file, b"\xd3", rtcm3_frame)
}

pub(super) fn sirf(file: &File<'_>) -> bool {
    stream(file, b"\xa0\xa2", sirf_frame)
}

pub(super) fn tsip(file: &File<'_>) -> bool {
    let start = file.content.get(..file.content.len().min(LONGEST * FRAMES)).unwrap_or_default();
    memchr::memchr_iter(0x10, start)
        .filter_map(|at| start.get(at..))
        .any(|begun| (0..FRAMES).try_fold(begun, |rest, _| rest.get(tsip_packet(rest)?..)).is_some())
}

/// Whether whole frames stand one behind the other from the first on; a stream may begin in the middle of one.
fn stream(file: &File<'_>, sync: &[u8], frame: fn(&[u8]) -> Option<usize>) -> bool {
    let start = file.content.get(..file.content.len().min(LOOK_AT)).unwrap_or_default();
    let places = memchr::memmem::find_iter(start, sync).take(MOST_TRIES).take_while(|at| *at <= LONGEST);
    places.filter_map(|at| start.get(at..)).any(|mut rest| {
        let mut n = 0;
        while let Some(tail) = frame(rest).and_then(|length| rest.get(length..)).filter(|_| n < FRAMES) {
            (n, rest) = (n + 1, tail);
        }
        // A short file may hold fewer, and nothing else.
        n == FRAMES || n > 0 && rest.is_empty()
    })
}

/// Bytes of a frame: D3, six zero bits, ten of length, the message, CRC-24Q.
fn rtcm3_frame(rest: &[u8]) -> Option<usize> {
    let &[0xd3, high, low, ..] = rest else { return None };
    let end = 3 + (usize::from(high & 3) << 8 | usize::from(low));
    let (message, sum) = (rest.get(..end)?, rest.get(end..)?.first_chunk::<3>()?);
    let stated = sum.iter().fold(0_u32, |sum, byte| sum << 8 | u32::from(*byte));
    (high & 0xfc == 0 && crc24q(message, 8 * message.len()) == stated).then_some(end + sum.len())
}

/// Bytes of a frame: A0 A2, length, the message, its sum of fifteen bits, B0 B3.
fn sirf_frame(rest: &[u8]) -> Option<usize> {
    let &[0xa0, 0xa2, high, low, ..] = rest else { return None };
    let end = 4 + (usize::from(high & 0x7f) << 8 | usize::from(low));
    let sum = rest.get(4..end)?.iter().fold(0_u32, |sum, byte| sum + u32::from(*byte)) & 0x7fff;
    let &[a, b, 0xb0, 0xb3] = rest.get(end..)?.first_chunk::<4>()? else { return None };
    (sum == u32::from(a) << 8 | u32::from(b)).then_some(end + 4)
}

/// Bytes of a packet: 10, an identifier, at most 300 bytes in which 10 stands twice, 10 03.
fn tsip_packet(rest: &[u8]) -> Option<usize> {
    const MOST: usize = 300;
    let &[0x10, id, ..] = rest else { return None };
    let mut at = 2;
    for n in 0..=MOST {
        match rest.get(at..)? {
            [0x10, 0x03, ..] => return (n > 0 && !matches!(id, 0x03 | 0x10)).then_some(at + 2),
            [0x10, 0x10, ..] => at += 2,
            [0x10, ..] | [] => return None,
            _ => at += 1,
        }
    }
    None
}
