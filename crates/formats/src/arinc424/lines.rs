//! Lines of a file that is read piece by piece; of a line that is too long only the beginning is kept.

use std::io::{self, BufRead};

/// Characters kept of a line: more than a record has, so that a longer one is recognised as such \[1\].
const KEPT: usize = 160;

/// One line without its end.
pub(super) struct Line<'a> {
    /// Number from 1.
    pub(super) number: usize,
    /// The line, or its beginning.
    pub(super) text: &'a [u8],
    /// Characters in the whole line \[1\].
    pub(super) length: usize,
}

/// Lines of a source, none of which takes more memory than [`KEPT`].
pub(super) struct Lines<R> {
    source: R,
    kept: Vec<u8>,
    number: usize,
}

impl<R: BufRead> Lines<R> {
    pub(super) fn new(source: R) -> Self {
        Self { source, kept: Vec::with_capacity(KEPT), number: 0 }
    }

    /// The next line; None at the end of the source.
    pub(super) fn next(&mut self) -> io::Result<Option<Line<'_>>> {
        self.kept.clear();
        let (mut length, mut ended) = (0, false);
        while !ended {
            let piece = self.source.fill_buf()?;
            if piece.is_empty() {
                break;
            }
            let end = memchr::memchr(b'\n', piece);
            let content = &piece[..end.unwrap_or(piece.len())];
            self.kept.extend_from_slice(&content[..content.len().min(KEPT - self.kept.len())]);
            length += content.len();
            ended = end.is_some();
            let used = content.len() + usize::from(ended);
            self.source.consume(used);
        }
        if length == 0 && !ended {
            return Ok(None);
        }
        self.number += 1;
        if self.kept.len() == length && self.kept.last() == Some(&b'\r') {
            self.kept.pop();
            length -= 1;
        }
        Ok(Some(Line { number: self.number, text: &self.kept, length }))
    }
}
