//! Formats that are known and not read: recognised, so that nobody looks for a table in them.
//!
//! Frames as their interface documents and public decoders describe them. Provenance: standard (from knowledge of the formats).

use super::File;
use crate::mode_s;
use crate::receiver::position::sign;
use crate::stream::{Framer, Protocol};
use navbound_core::signal::sbas::crc24q;

const LOOK_AT: usize = 1 << 16;
/// Places at which a stream may begin that are tried.
const MOST_TRIES: usize = 64;
/// Frames one behind the other that make a stream of a kind: a single one may stand in other data by chance.
const FRAMES: usize = 3;
/// More than the longest frame \[B\].
const LONGEST: usize = 1100;
/// The longest frame of Beast, all its bytes doubled \[B\].
const LONGEST_BEAST: usize = 44;

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
    packets(file, |packet| packet.len() > 1)
}

/// Garmin's packets have the frame of TSIP, and a size and a sum within it.
pub(super) fn garmin(file: &File<'_>) -> bool {
    let sound = |packet: &[u8]| {
        let sum = packet.iter().fold(0_u8, |sum, byte| sum.wrapping_add(*byte));
        matches!(packet, [_, size, ..] if usize::from(*size) + 3 == packet.len()) && sum == 0
    };
    packets(file, sound)
}

pub(super) fn casic(file: &File<'_>) -> bool {
    stream(file, b"\xba\xce", casic_frame)
}

pub(super) fn skytraq(file: &File<'_>) -> bool {
    stream(file, b"\xa0\xa1", skytraq_frame)
}

pub(super) fn hemisphere(file: &File<'_>) -> bool {
    stream(file, b"$BIN", hemisphere_frame)
}

pub(super) fn javad(file: &File<'_>) -> bool {
    [b"JP".as_slice(), b"~~"].into_iter().any(|first| stream(file, first, javad_message))
}

/// The text log of Android's measurements: by the comments that describe it, or by its first line.
pub(super) fn gnss_logger(file: &File<'_>) -> bool {
    const LINES: usize = 64;
    let begin = file.content.get(..file.content.len().min(1 << 14)).unwrap_or_default();
    let described = begin.split(|byte| *byte == b'\n').take(LINES).filter_map(|line| line.strip_prefix(b"#")).any(|comment| {
        let of_lines = [b"Raw,utcTimeMillis,".as_slice(), b"Raw,ElapsedRealtimeMillis,", b"Fix,Provider,Latitude"];
        of_lines.iter().any(|words| comment.trim_ascii_start().starts_with(words))
    });
    let providers = [b"GPS".as_slice(), b"gps", b"FLP", b"fused", b"NLP", b"network"];
    let first = begin.trim_ascii_start();
    let fix = first
        .strip_prefix(b"Fix,")
        .is_some_and(|rest| providers.iter().any(|name| rest.strip_prefix(*name).is_some_and(|rest| rest.starts_with(b","))));
    described || fix || matches!(first, [b'R', b'a', b'w', b',', b'0'..=b'9', ..])
}

/// The record of a glider's flight: its maker first, its date in the head.
pub(super) fn igc(file: &File<'_>) -> bool {
    let begin = file.content.get(..file.content.len().min(1 << 13)).unwrap_or_default();
    let maker = matches!(begin, [b'A', rest @ ..] if rest.iter().take(3).filter(|byte| byte.is_ascii_alphanumeric()).count() == 3);
    maker && begin.split(|byte| *byte == b'\n').any(|line| line.starts_with(b"HFDTE"))
}

/// Sentences of ships, behind the block that some receivers write before each. Where sentences state positions of the receiver, those count.
pub(super) fn ais(file: &File<'_>) -> bool {
    let begin = file.content.get(..file.content.len().min(1 << 13)).unwrap_or_default();
    let sentence = |line: &[u8]| {
        memchr::memchr(b'!', line).and_then(|at| line.get(at..at + 6)).is_some_and(|six| six == b"!AIVDM" || six == b"!AIVDO")
    };
    let lines: Vec<&[u8]> =
        begin.split(|byte| *byte == b'\n').map(<[u8]>::trim_ascii).filter(|line| !line.is_empty()).take(FRAMES).collect();
    let of_ships = !lines.is_empty() && lines.into_iter().all(|line| (line.starts_with(b"!") || line.starts_with(b"\\")) && sentence(line));
    of_ships && !sign::states_positions(file.content)
}

pub(super) fn gpx(file: &File<'_>) -> bool {
    element(file, b"<gpx")
}

pub(super) fn kml(file: &File<'_>) -> bool {
    element(file, b"<kml")
}

/// Whether a text begins with a mark-up and has this element near its begin.
fn element(file: &File<'_>, name: &[u8]) -> bool {
    let begin = file.content.get(..file.content.len().min(1 << 12)).unwrap_or_default();
    let text = begin.strip_prefix(b"\xef\xbb\xbf").unwrap_or(begin).trim_ascii_start();
    text.starts_with(b"<") && memchr::memmem::find(text, name).is_some()
}

/// Whether packets between 10 and 10 03 stand one behind the other, each of which is sound without its frame and its doubled bytes.
fn packets(file: &File<'_>, sound: impl Fn(&[u8]) -> bool) -> bool {
    let start = file.content.get(..file.content.len().min(LONGEST * FRAMES)).unwrap_or_default();
    memchr::memchr_iter(0x10, start).filter_map(|at| start.get(at..)).any(|begun| {
        let next = |rest: &'_ [u8]| tsip_packet(rest).filter(|(packet, _)| sound(packet)).map(|(_, length)| length);
        (0..FRAMES).try_fold(begun, |rest, _| rest.get(next(rest)?..)).is_some()
    })
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

/// Whether frames of Beast stand one behind the other; the first bytes may belong to one whose begin was missed.
pub(super) fn beast(file: &File<'_>) -> bool {
    let begin = file.content.get(..file.content.len().min(LONGEST)).unwrap_or_default();
    let (mut framer, mut whole, mut damaged) = (Framer::new(Protocol::Beast), 0, 0);
    framer.push(begin, &mut |frame| *if frame.is_ok() { &mut whole } else { &mut damaged } += 1);
    let first = begin.get(..LONGEST_BEAST).unwrap_or(begin);
    whole >= FRAMES && damaged <= 1 && memchr::memchr(0x1a, first).is_some()
}

/// Whether the first lines are messages of Mode S.
pub(super) fn avr(file: &File<'_>) -> bool {
    let lines = file.content.get(..file.content.len().min(LONGEST)).unwrap_or_default().split(|byte| *byte == b'\n');
    let mut lines = lines.filter(|line| !line.trim_ascii().is_empty()).take(FRAMES).peekable();
    lines.peek().is_some() && lines.all(|line| mode_s::of_line(line).is_some())
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

/// A packet, with what stands twice once, and its bytes in the file: 10, an identifier, at most 300 bytes in which 10 stands twice, 10 03.
fn tsip_packet(rest: &[u8]) -> Option<(Vec<u8>, usize)> {
    const MOST: usize = 300;
    let &[0x10, id, ..] = rest else { return None };
    let (mut packet, mut at) = (vec![id], 2);
    for _ in 0..=MOST {
        match rest.get(at..)? {
            [0x10, 0x03, ..] => return (packet.len() > 1 && !matches!(id, 0x03 | 0x10)).then_some((packet, at + 2)),
            [0x10, 0x10, ..] => at += 2,
            [0x10, ..] | [] => return None,
            _ => at += 1,
        }
        packet.push(*rest.get(at - 1)?);
    }
    None
}

/// Bytes of a frame: BA CE, length, class, identifier, the payload, the sum of its words with the head.
fn casic_frame(rest: &[u8]) -> Option<usize> {
    let &[0xba, 0xce, low, high, class, id] = rest.first_chunk::<6>()? else { return None };
    let length = usize::from(u16::from_le_bytes([low, high]));
    let (payload, stated) = (rest.get(6..6 + length)?, rest.get(6 + length..)?.first_chunk::<4>()?);
    let (words, odd) = payload.as_chunks::<4>();
    let head = u32::from(id) << 24 | u32::from(class) << 16;
    let sum = words.iter().fold(head.wrapping_add(length as u32), |sum, word| sum.wrapping_add(u32::from_le_bytes(*word)));
    (odd.is_empty() && sum == u32::from_le_bytes(*stated)).then_some(10 + length)
}

/// Bytes of a frame: A0 A1, length, the message, the exclusive or of its bytes, 0D 0A.
fn skytraq_frame(rest: &[u8]) -> Option<usize> {
    let &[0xa0, 0xa1, high, low] = rest.first_chunk::<4>()? else { return None };
    let end = 4 + usize::from(u16::from_be_bytes([high, low]));
    let (message, &[sum, b'\r', b'\n']) = (rest.get(4..end)?, rest.get(end..)?.first_chunk::<3>()?) else { return None };
    (message.iter().fold(0, |all, byte| all ^ byte) == sum).then_some(end + 3)
}

/// Bytes of a frame: $BIN, number of the block, length, the block, the sum of its bytes, 0D 0A.
fn hemisphere_frame(rest: &[u8]) -> Option<usize> {
    let &[b'$', b'B', b'I', b'N', _, _, low, high] = rest.first_chunk::<8>()? else { return None };
    let end = 8 + usize::from(u16::from_le_bytes([low, high]));
    let (block, &[s0, s1, b'\r', b'\n']) = (rest.get(8..end)?, rest.get(end..)?.first_chunk::<4>()?) else { return None };
    let sum = block.iter().fold(0_u16, |sum, byte| sum.wrapping_add(u16::from(*byte)));
    (sum == u16::from_le_bytes([s0, s1])).then_some(end + 4)
}

/// Bytes of a message: two characters, three hexadecimal digits of length, the body, and perhaps the end of a line.
fn javad_message(rest: &[u8]) -> Option<usize> {
    let (&[a, b], digits) = (rest.first_chunk::<2>()?, rest.get(2..5)?);
    let length = core::str::from_utf8(digits).ok().filter(|text| !text.starts_with('+'))?;
    let end = 5 + usize::from_str_radix(length, 16).ok()?;
    let upper = digits.iter().all(|digit| digit.is_ascii_digit() || (b'A'..=b'F').contains(digit));
    let line_end = rest.get(end..)?.iter().take(2).take_while(|byte| matches!(byte, b'\r' | b'\n')).count();
    (upper && end > 5 && (0x30..=0x7e).contains(&a) && (0x30..=0x7e).contains(&b)).then_some(end + line_end)
}
