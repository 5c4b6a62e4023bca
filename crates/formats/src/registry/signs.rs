//! Signs of formats that are read.

use super::File;
use crate::receiver::position::{Kind, sign};

/// Bytes at the begin of a text in which its sign stands \[B\].
const BEGIN: usize = 4096;
/// Bytes of the first line of a RINEX file, and of one with a byte order mark or longer \[B\].
const FIRST_LINE: usize = 200;

pub(super) fn zip(file: &File<'_>) -> bool {
    file.content.starts_with(b"PK\x03\x04") || file.content.starts_with(b"PK\x05\x06")
}

/// The begin of a text without its byte order mark and blanks.
fn text(content: &[u8]) -> &[u8] {
    let begin = content.get(..content.len().min(BEGIN)).unwrap_or_default();
    begin.strip_prefix(b"\xef\xbb\xbf").unwrap_or(begin).trim_ascii_start()
}

pub(super) fn json(file: &File<'_>) -> bool {
    matches!(text(file.content), [b'{' | b'[', ..])
}

pub(super) fn rtklib(file: &File<'_>) -> bool {
    text(file.content).starts_with(b"%")
}

/// The heading of a satellite in a YUMA almanac: `******** Week 377 almanac for PRN-01 ********`.
pub(super) fn yuma(file: &File<'_>) -> bool {
    let first = text(file.content).split(|byte| *byte == b'\n').next().unwrap_or_default();
    first.starts_with(b"****") && memchr::memmem::find(&first.to_ascii_lowercase(), b"almanac").is_some()
}

/// The type of a RINEX file and the twenty columns in which it stands; a compact file holds observations.
fn rinex<'a>(file: &File<'a>) -> Option<(u8, &'a [u8])> {
    let begin = file.content.get(..file.content.len().min(FIRST_LINE)).unwrap_or_default();
    let first = begin.split(|byte| *byte == b'\n').next().unwrap_or_default();
    if memchr::memmem::find(first, b"CRINEX VERS").is_some() {
        return Some((b'O', &[]));
    }
    memchr::memmem::find(first, b"RINEX VERSION / TYPE")?;
    let field = first.get(20..first.len().min(40)).unwrap_or_default();
    Some((field.first().copied().unwrap_or(b' '), field))
}

pub(super) fn observations(file: &File<'_>) -> bool {
    rinex(file).is_some_and(|(kind, _)| kind == b'O')
}

pub(super) fn messages(file: &File<'_>) -> bool {
    rinex(file).is_some_and(|(kind, field)| matches!(kind, b'B' | b'H') && memchr::memmem::find(field, b"NAV").is_none())
}

pub(super) fn clocks(file: &File<'_>) -> bool {
    rinex(file).is_some_and(|(kind, _)| kind == b'C')
}

pub(super) fn navigation(file: &File<'_>) -> bool {
    rinex(file).is_some()
}

/// The receiver of a log, perhaps behind lines of JSON, which a program writes that passes a log on. Comments of a solution file are none.
fn receiver(file: &File<'_>, kind: Kind) -> bool {
    let log = if json(file) { behind_banner(file.content) } else { file.content };
    !rtklib(file) && sign::of(log) == Some(kind)
}

pub(super) fn ubx(file: &File<'_>) -> bool {
    receiver(file, Kind::Ubx)
}

pub(super) fn sbf(file: &File<'_>) -> bool {
    receiver(file, Kind::Sbf)
}

pub(super) fn novatel(file: &File<'_>) -> bool {
    receiver(file, Kind::Novatel)
}

pub(super) fn nmea(file: &File<'_>) -> bool {
    receiver(file, Kind::Nmea)
}

/// What follows the lines of JSON at the begin; nothing where they are no banner.
fn behind_banner(content: &[u8]) -> &[u8] {
    let mut rest = content;
    loop {
        let line = rest.get(..rest.len().min(BEGIN)).unwrap_or_default().trim_ascii_start();
        if !line.starts_with(b"{") {
            return if matches!(line, [b'[' | b']' | b'}' | b'"', ..]) { &[] } else { rest };
        }
        let end = rest.get(1..).and_then(|tail| memchr::memchr(b'\n', tail)).map(|at| at + 1);
        // An object over several lines is no banner.
        let object = end.and_then(|end| rest.split_at_checked(end)).filter(|(object, _)| object.trim_ascii_end().ends_with(b"}"));
        let Some((_, [_, tail @ ..])) = object else { return &[] };
        rest = tail;
    }
}

pub(super) fn sp3(file: &File<'_>) -> bool {
    matches!(file.content, [b'#', b'a'..=b'd', b'P' | b'V', year @ ..] if year.first_chunk::<4>().is_some_and(|year| year.iter().all(u8::is_ascii_digit)))
}

/// Whether the name ends so.
pub(super) fn named(file: &File<'_>, endings: &[&str]) -> bool {
    endings.iter().any(|ending| file.name.ends_with(ending))
}
