//! Unix compress (`.Z`): codes of growing width that stand for strings seen before (T. Welch 1984; layout of ncompress, provenance: standard).
//!
//! The format has no length and no checksum: a file cut between two codes cannot be distinguished from a whole one.

/// Codes of single bytes.
const BYTES: usize = 256;
/// The code that empties the table, in block mode.
const CLEAR: usize = 256;
const FEWEST_BITS: usize = 9;
const MOST_BITS: usize = 16;

/// Why a stream cannot be unpacked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub(super) enum Damaged {
    /// The third byte.
    #[error("its header asks for codes of {0} bits, not 9 to 16")]
    Width(usize),
    /// A code that no earlier one explains.
    #[error("code {0} was never defined")]
    Code(usize),
    /// Nothing after the header.
    #[error("the stream is empty")]
    Empty,
    /// More than is unpacked.
    #[error("it unpacks to more than {0} bytes")]
    Large(u64),
}

/// Where codes are read: groups of eight, so that a change of width begins with a whole byte.
struct Codes<'a> {
    bytes: &'a [u8],
    at: usize,
    group: usize,
    width: usize,
}

impl Codes<'_> {
    fn next(&mut self) -> Option<usize> {
        let byte = self.at / 8;
        if self.at + self.width > 8 * self.bytes.len() {
            return None;
        }
        let three = (0..3).map(|k| u32::from(self.bytes.get(byte + k).copied().unwrap_or(0)) << (8 * k)).sum::<u32>();
        let code = (three >> (self.at % 8)) as usize & ((1 << self.width) - 1);
        self.at += self.width;
        Some(code)
    }
    /// Skip to the end of the group, then read codes of another width.
    fn change(&mut self, width: usize) {
        self.group += (self.at - self.group).next_multiple_of(8 * self.width);
        self.at = self.group;
        self.width = width;
    }
}

/// The plain bytes behind the magic number, at most `largest`.
pub(super) fn unpack(stream: &[u8], largest: u64) -> Result<Vec<u8>, Damaged> {
    let (flags, bytes) = stream.split_first().ok_or(Damaged::Empty)?;
    let (most, block) = (usize::from(flags & 0x1f), flags & 0x80 != 0);
    if !(FEWEST_BITS..=MOST_BITS).contains(&most) {
        return Err(Damaged::Width(most));
    }
    let first_free = if block { CLEAR + 1 } else { BYTES };
    let mut codes = Codes { bytes, at: 0, group: 0, width: FEWEST_BITS };
    // Each string is another one and a last byte.
    let (mut prefix, mut suffix) = (vec![0_u16; 1 << most], vec![0_u8; 1 << most]);
    let mut free = first_free;
    let mut plain = Vec::new();
    let first = codes.next().ok_or(Damaged::Empty)?;
    let mut last = u8::try_from(first).map_err(|_| Damaged::Code(first))?;
    let mut before = first;
    plain.push(last);
    loop {
        if codes.width < most && free > (1 << codes.width) - 1 {
            codes.change(codes.width + 1);
        }
        let Some(code) = codes.next() else { return Ok(plain) };
        if block && code == CLEAR {
            // The entry that the next code completes has the number of the code that clears.
            free = CLEAR;
            codes.change(FEWEST_BITS);
            continue;
        }
        let from = plain.len();
        let mut rest = code;
        if code >= free {
            // The string that this very code completes: the one before and its own first byte.
            if code > free {
                return Err(Damaged::Code(code));
            }
            plain.push(last);
            rest = before;
        }
        while rest >= BYTES {
            plain.push(suffix[rest]);
            rest = usize::from(prefix[rest]);
        }
        last = rest as u8;
        plain.push(last);
        plain[from..].reverse();
        if plain.len() as u64 > largest {
            return Err(Damaged::Large(largest));
        }
        if free < 1 << most {
            (prefix[free], suffix[free]) = (before as u16, last);
            free += 1;
        }
        before = code;
    }
}
