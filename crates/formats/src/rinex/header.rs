//! Header lines: label in columns 61 to 80, content before it.

use super::number::{columns, decimal, text};
use crate::refusal::Unreadable;

/// Lines of a file without their ends, with their number from 1. One carriage return before the line feed belongs to the end.
pub(crate) struct Lines<'a> {
    rest: &'a [u8],
    /// Number of the line last given.
    pub(crate) number: usize,
}

impl<'a> Lines<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes, number: 0 }
    }
    /// Bytes not yet given.
    pub(crate) fn rest(&self) -> &'a [u8] {
        self.rest
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = &'a [u8];
    #[inline]
    fn next(&mut self) -> Option<&'a [u8]> {
        if self.rest.is_empty() {
            return None;
        }
        self.number += 1;
        let (line, rest) = match memchr::memchr(b'\n', self.rest) {
            Some(end) => (&self.rest[..end], &self.rest[end + 1..]),
            None => (self.rest, &[][..]),
        };
        self.rest = rest;
        Some(line.strip_suffix(b"\r").unwrap_or(line))
    }
}

/// The label of a header line.
pub(crate) fn label(line: &[u8]) -> &[u8] {
    columns(line, 60, 80).trim_ascii()
}

/// Version and the letter of the file's type, from the first line.
pub(crate) fn version(line: &[u8]) -> Result<(f64, u8, u8), Unreadable> {
    if label(line) != b"RINEX VERSION / TYPE" {
        let first: String = text(line, 0, 80).chars().take(60).collect();
        return Err(Unreadable::at(1, format!("not a RINEX file: the first line does not end in 'RINEX VERSION / TYPE' but is '{first}'")));
    }
    let version = decimal(columns(line, 0, 9)).or_zero().unwrap_or(f64::NAN);
    if !(2.0..5.0).contains(&version) {
        let reason = format!("RINEX version '{}' is not one of 2.xx, 3.xx, 4.xx", text(line, 0, 9));
        return Err(Unreadable { line: Some(1), field: Some("RINEX VERSION / TYPE".to_owned()), reason });
    }
    Ok((version, columns(line, 20, 21).first().copied().unwrap_or(b' '), columns(line, 40, 41).first().copied().unwrap_or(b' ')))
}
