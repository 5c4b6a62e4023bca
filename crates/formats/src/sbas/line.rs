//! One message of a log.

use super::Received;
use crate::time::{Calendar, Scale, from_calendar, from_week};
use navbound_core::quantity::GpsTime;
use navbound_core::signal::sbas::{BLOCK_BYTES, Block, Malformed};

/// Hexadecimal digits of a block, and of its data without parity.
const WHOLE: usize = 2 * BLOCK_BYTES;
const WITHOUT_PARITY: usize = 58;

/// Why a line is no good message.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Fault {
    pub(super) field: &'static str,
    pub(super) reason: String,
}

fn fault(field: &'static str, reason: impl Into<String>) -> Fault {
    Fault { field, reason: reason.into() }
}

/// `PRN YY MM DD hh mm ss type hex64`
pub(super) fn ems(line: &str) -> Result<Received, Fault> {
    let mut words = line.split_ascii_whitespace();
    let prn = prn(words.next())?;
    let end = calendar(&mut words)?;
    let kind = number(words.next(), "type")?;
    let block = block(words.next().unwrap_or(""), WHOLE, kind, Block::new)?;
    finish(words.next())?;
    Ok(Received { end, prn, block })
}

/// `week tow PRN type : hex58`; RTKLIB keeps 29 bytes and drops the parity, which its receiver has checked.
pub(super) fn rtklib(line: &str) -> Result<Received, Fault> {
    let (head, digits) = line.split_once(':').ok_or_else(|| fault("message", "no colon before the message"))?;
    let mut words = head.split_ascii_whitespace();
    let week: i64 = number(words.next(), "week")?;
    let second: i64 = number(words.next(), "time of week")?;
    if !((0..=9999).contains(&week) && (0..604_800).contains(&second)) {
        return Err(fault("time of week", format!("week {week}, second {second} is no GPS time")));
    }
    let end = from_week(week, second * 1_000_000_000).ok_or_else(|| fault("week", "out of range"))?;
    let prn = prn(words.next())?;
    let kind = number(words.next(), "type")?;
    finish(words.next())?;
    Ok(Received { end, prn, block: block(digits.trim(), WITHOUT_PARITY, kind, Block::with_parity)? })
}

/// `PRN YY MM DD hh mm ss.s ... SBA type`, the digits on lines of their own.
pub(super) fn rinex_b(head: &str, digits: &str) -> Result<Received, Fault> {
    let mut words = head.split_ascii_whitespace();
    let prn = prn(words.next())?;
    let end = calendar(&mut words)?;
    if !words.by_ref().any(|w| w == "SBA") {
        return Err(fault("source", "no word SBA: not an SBAS message"));
    }
    let kind = number(words.next(), "type")?;
    Ok(Received { end, prn, block: block(digits, WHOLE, kind, Block::new)? })
}

/// Whether a line is hexadecimal digits and nothing a record's first line could be.
pub(super) fn is_digits_only(row: &str) -> bool {
    row.len() >= 16 && !row.contains("SBA")
}

fn prn(word: Option<&str>) -> Result<u8, Fault> {
    let prn: u8 = number(word, "PRN")?;
    if !(120..=158).contains(&prn) {
        return Err(fault("PRN", format!("{prn} is outside 120 to 158")));
    }
    Ok(prn)
}

fn calendar<'a>(words: &mut impl Iterator<Item = &'a str>) -> Result<GpsTime, Fault> {
    let year: i32 = number(words.next(), "year")?;
    // Two digits: 1980 to 2079.
    let year = if year < 80 {
        2000 + year
    } else if year < 100 {
        1900 + year
    } else {
        year
    };
    let date = Calendar {
        year,
        month: number(words.next(), "month")?,
        day: number(words.next(), "day")?,
        hour: number(words.next(), "hour")?,
        minute: number(words.next(), "minute")?,
        // The tenths that some receivers write are the signal's way; the second is what counts.
        nanoseconds: number::<i64>(words.next().map(|w| w.split_once('.').map_or(w, |(whole, _)| whole)), "second")?
            .saturating_mul(1_000_000_000),
    };
    from_calendar(date, Scale::Gps).ok_or_else(|| fault("date", "no such date"))
}

fn number<T: core::str::FromStr>(word: Option<&str>, field: &'static str) -> Result<T, Fault> {
    let word = word.ok_or_else(|| fault(field, "missing"))?;
    word.parse().map_err(|_| fault(field, format!("{word:?} is no number in range")))
}

fn finish(rest: Option<&str>) -> Result<(), Fault> {
    rest.map_or(Ok(()), |word| Err(fault("message", format!("{word:?} is too much"))))
}

fn block(digits: &str, count: usize, kind: u8, make: fn([u8; BLOCK_BYTES]) -> Result<Block, Malformed>) -> Result<Block, Fault> {
    let digits = digits.as_bytes();
    if digits.len() != count {
        return Err(fault("message", format!("{} digits, not {count}", digits.len())));
    }
    let mut bytes = [0_u8; BLOCK_BYTES];
    for (byte, pair) in bytes.iter_mut().zip(digits.chunks_exact(2)) {
        let nibble = |i: usize| pair.get(i).and_then(|d| char::from(*d).to_digit(16));
        let value = nibble(0).zip(nibble(1)).ok_or_else(|| fault("message", "not hexadecimal"))?;
        *byte = u8::try_from(value.0 << 4 | value.1).unwrap_or(0);
    }
    let block = make(bytes).map_err(|e| fault("message", e.to_string()))?;
    if block.message_type() != kind {
        return Err(fault("type", format!("the line says {kind}, the message {}", block.message_type())));
    }
    Ok(block)
}
