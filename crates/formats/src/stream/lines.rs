//! Lines of text, such as one JSON object each.

use super::frame::{Damage, Family, Frame};

/// Longest line that is read \[B\]. Provenance: ours.
pub(super) const LONGEST: usize = 16 * 1024;

/// Cuts lines out of `bytes`; how many bytes are used up. `skipping`: inside a line that is too long.
pub(super) fn cut(bytes: &[u8], skipping: &mut bool, ended: bool, out: &mut impl FnMut(Result<Frame<'_>, Damage>)) -> usize {
    let mut at = 0;
    while let Some(rest) = bytes.get(at..).filter(|rest| !rest.is_empty()) {
        let end = memchr::memchr(b'\n', rest);
        let line = rest.get(..end.unwrap_or(rest.len())).unwrap_or_default();
        if end.is_none() && !ended && line.len() <= LONGEST {
            return at;
        }
        if !*skipping {
            if line.len() > LONGEST {
                out(Err(Damage { family: Family::Lines, reason: "a line longer than 16384 bytes", length: LONGEST }));
            } else {
                take(line, out);
            }
        }
        *skipping = end.is_none() && !ended;
        at += line.len() + usize::from(end.is_some());
    }
    at
}

fn take(line: &[u8], out: &mut impl FnMut(Result<Frame<'_>, Damage>)) {
    let line = line.strip_suffix(b"\r").unwrap_or(line);
    if !line.trim_ascii().is_empty() {
        out(Ok(Frame::Line(line)));
    }
}
