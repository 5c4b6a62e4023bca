//! The search for the next frame in bytes, the one of files and of streams.

use super::frame::Frame;
use super::{nmea, sbf, ubx};

/// What begins at a byte.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Look<'a> {
    /// No frame.
    Nothing,
    /// It depends on bytes that have not arrived.
    NeedMore,
    /// A frame and its length.
    Frame {
        /// Bytes from the sync to behind the checksum.
        length: usize,
        /// The frame.
        frame: Frame<'a>,
    },
    /// What began as a frame: its reason and length. The search goes on behind its sync.
    Damaged {
        /// Why.
        reason: &'static str,
        /// Bytes of it that are known.
        length: usize,
    },
}

impl<'a> Look<'a> {
    pub(super) const fn damaged(reason: &'static str, length: usize) -> Self {
        Self::Damaged { reason, length }
    }

    /// Too few bytes to say what begins: at the end of all bytes nothing does.
    pub(super) const fn unknown(ended: bool) -> Self {
        if ended { Self::Nothing } else { Self::NeedMore }
    }

    /// A frame began and its end is not there: at the end of all bytes it is damaged.
    pub(super) const fn cut(ended: bool, reason: &'static str, length: usize) -> Self {
        if ended { Self::damaged(reason, length) } else { Self::NeedMore }
    }
}

/// What begins with the first byte of `rest`. `text`: sentences are frames too; otherwise they are passed over. `ended`: no bytes follow.
pub(crate) fn look(rest: &[u8], text: bool, ended: bool) -> Look<'_> {
    match rest {
        [0xb5, 0x62, ..] => ubx::look(rest, ended),
        [b'$', b'@', ..] => sbf::look(rest, ended),
        [b'$', _, ..] if text => nmea::look(rest, ended),
        [0xb5 | b'$'] => Look::unknown(ended),
        _ => Look::Nothing,
    }
}
