//! Source: the binary output of the Mode-S Beast and what readsb adds to it, as readsb's documents describe it; standard.

use super::frame::{Beast, Damage, Family, Frame};

const ESCAPE: u8 = 0x1a;
/// Counter and strength of the signal.
const HEAD: usize = 7;
/// Bytes of the longest frame, without what is doubled: head and message.
const LONGEST: usize = HEAD + 14;

/// Bytes of a kind of frame behind it: head and message; the identity of a receiver has no head. `None`: no kind that is known.
const fn length_of(kind: u8) -> Option<usize> {
    match kind {
        b'1' => Some(HEAD + 2),
        b'2' => Some(HEAD + 7),
        b'3' | b'4' => Some(HEAD + 14),
        0xe3 => Some(8),
        _ => None,
    }
}

/// Cuts frames out of bytes; how many bytes are used up.
pub(super) fn cut(bytes: &[u8], ended: bool, out: &mut impl FnMut(Result<Frame<'_>, Damage>)) -> usize {
    let mut at = 0;
    loop {
        let rest = bytes.get(at..).unwrap_or_default();
        let Some(place) = memchr::memchr(ESCAPE, rest) else { return bytes.len() };
        let begun = rest.get(place..).unwrap_or_default();
        at += place;
        match look(begun, ended) {
            Look::NeedMore => return at,
            Look::Frame { length, frame } => {
                out(Ok(frame));
                at += length;
            }
            Look::Nothing { length } => at += length,
            Look::Damaged { length, reason } => {
                out(Err(Damage { family: Family::Beast, reason, length }));
                at += length;
            }
        }
    }
}

enum Look {
    NeedMore,
    Frame { length: usize, frame: Frame<'static> },
    Nothing { length: usize },
    Damaged { length: usize, reason: &'static str },
}

/// What begins with an escape.
fn look(begun: &[u8], ended: bool) -> Look {
    let cut = |length| if ended { Look::Damaged { length, reason: "the stream ends within a Beast frame" } } else { Look::NeedMore };
    let Some(&kind) = begun.get(1) else { return cut(begun.len()) };
    // A doubled escape is a byte of a frame whose begin was missed.
    let Some(n) = length_of(kind) else {
        return if kind == ESCAPE { Look::Nothing { length: 2 } } else { Look::Damaged { length: 1, reason: "no kind of Beast frame" } };
    };
    let (mut body, mut at) = ([0; LONGEST], 2);
    for byte in body.iter_mut().take(n) {
        let Some(&value) = begun.get(at) else { return cut(begun.len()) };
        if value == ESCAPE {
            match begun.get(at + 1) {
                None => return cut(begun.len()),
                Some(&ESCAPE) => at += 1,
                // The next frame began before this one was whole.
                Some(_) => return Look::Damaged { length: at, reason: "a Beast frame is cut short" },
            }
        }
        *byte = value;
        at += 1;
    }
    let (head, message) = body.split_at(HEAD);
    match (kind, head.first_chunk(), message.first_chunk()) {
        (b'1'..=b'3', Some(counter), Some(message)) => {
            Look::Frame { length: at, frame: Frame::Beast(Beast { counter: *counter, message: *message, length: n - HEAD }) }
        }
        _ => Look::Nothing { length: at },
    }
}

/// What is damaged wherever it stands: an escape and no kind of frame.
pub const DAMAGED: [u8; 2] = [ESCAPE, 0];

/// A message as a frame, without a strength of the signal.
pub fn frame(message: &Beast) -> Vec<u8> {
    let kind = match message.length {
        2 => b'1',
        7 => b'2',
        _ => b'3',
    };
    let mut bytes = vec![ESCAPE, kind];
    for byte in message.counter.iter().chain(&[0]).chain(message.message()) {
        bytes.push(*byte);
        if *byte == ESCAPE {
            bytes.push(ESCAPE);
        }
    }
    bytes
}
