//! SBAS message logs to 250-bit blocks: EMS text, RTKLIB `.sbs`, RINEX-B, raw logs of receivers; plain or packed by gzip.
//!
//! Logs differ in the instant they write beside a message. A reader is told ([`Tag`]), says what it assumed ([`Log::tag`]), and hands on one
//! thing only: when the message ended.

mod line;

use crate::packed::unpack;
use crate::receiver;
use crate::refusal::{Refusal, Unreadable};
use navbound_core::quantity::GpsTime;
use navbound_core::signal::sbas::Block;

/// The instant that a log writes beside a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tag {
    /// The second in which the message ends.
    End,
    /// The second in which it begins, one earlier.
    Start,
}

/// How a log is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// `PRN YY MM DD hh mm ss type hex64`, GPS time.
    Ems,
    /// RTKLIB: `week tow PRN type : hex58`, without parity.
    Rtklib,
    /// RINEX-type broadcast data of geostationary satellites. The layout is inferred from a converter, no file of it was at hand.
    RinexB,
    /// Frames of a receiver (see [`crate::receiver`]), dated by the measurements beside them.
    Receiver,
}

impl Format {
    /// The name people use.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ems => "EMS",
            Self::Rtklib => "RTKLIB sbs",
            Self::RinexB => "RINEX-B",
            Self::Receiver => "receiver log",
        }
    }
}

/// One message as received.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Received {
    /// When it ended, to the second.
    pub end: GpsTime,
    /// PRN of the satellite that sent it.
    pub prn: u8,
    /// Its 250 bits; preamble and parity are right.
    pub block: Block,
}

/// A log.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Log {
    /// How it is written.
    pub format: Format,
    /// What its times mean, as the caller stated or the format's convention is.
    pub tag: Tag,
    /// In the order of the file.
    pub messages: Vec<Received>,
    /// Lines that are no good message, each with its reason.
    pub refused: Vec<Refusal>,
}

/// Read a log, its format recognised by its first line with content.
///
/// `tag` None takes the format's convention: the second in which the message ends (EMS and RTKLIB, as recorded beside other receivers).
///
/// # Errors
/// [`Unreadable`] for a damaged or unknown packing, a file that is none of the formats, and RINEX-B without a stated tag, whose convention
/// we do not know.
pub fn read(bytes: &[u8], tag: Option<Tag>) -> Result<Log, Unreadable> {
    let plain = unpack(bytes)?;
    let text = String::from_utf8_lossy(&plain);
    let format = if receiver::is_raw(&plain) { Format::Receiver } else { recognise(&text)? };
    let tag = match (format, tag) {
        (Format::Receiver, Some(Tag::Start)) => {
            return Err(Unreadable::whole("messages in a receiver's log are dated by their end, not their start"));
        }
        (_, Some(tag)) => tag,
        (Format::Ems | Format::Rtklib | Format::Receiver, None) => Tag::End,
        (Format::RinexB, None) => {
            return Err(Unreadable::whole("state whether the times of this RINEX-B file are the start or the end of a message"));
        }
    };
    let mut log = Log { format, tag, messages: Vec::new(), refused: Vec::new() };
    match format {
        Format::Ems => lines(&text, &mut log, line::ems),
        Format::Rtklib => lines(&text, &mut log, line::rtklib),
        Format::RinexB => records(&text, &mut log),
        Format::Receiver => frames(&plain, &mut log)?,
    }
    Ok(log)
}

/// The messages of a raw log; their ends follow from the measurements beside them.
fn frames(plain: &[u8], log: &mut Log) -> Result<(), Unreadable> {
    let found = receiver::read(plain)?;
    if found.messages.is_empty() {
        return Err(Unreadable::whole("a receiver's log without one SBAS L1 message that is dated"));
    }
    (log.messages, log.refused) = (found.messages, found.observations.refused);
    Ok(())
}

fn recognise(text: &str) -> Result<Format, Unreadable> {
    let first = content(text).next().ok_or_else(|| Unreadable::whole("the file is empty"))?.1;
    // Column 21 of a RINEX header's first line is the kind of file.
    if first.contains("RINEX VERSION / TYPE") && first.contains("B: GEO") {
        return Ok(Format::RinexB);
    }
    // Any of the first lines decides, so that one damaged line does not hide what the file is.
    for (_, line) in content(text).take(50) {
        if line::ems(line).is_ok() {
            return Ok(Format::Ems);
        }
        if line::rtklib(line).is_ok() {
            return Ok(Format::Rtklib);
        }
    }
    Err(Unreadable::whole(format!("neither EMS nor RTKLIB sbs nor RINEX-B: {:?}", first.chars().take(60).collect::<String>())))
}

/// Lines with content, numbered from 1.
fn content(text: &str) -> impl Iterator<Item = (usize, &str)> {
    text.lines().enumerate().map(|(i, l)| (i + 1, l.trim())).filter(|(_, l)| !l.is_empty() && !l.starts_with(['#', '*', '%']))
}

fn lines(text: &str, log: &mut Log, parse: fn(&str) -> Result<Received, line::Fault>) {
    for (number, line) in content(text) {
        log.take(number, line, parse(line));
    }
}

/// RINEX-B: a header, then records of a line with epoch and type and lines of hexadecimal digits.
fn records(text: &str, log: &mut Log) {
    let mut rows = content(text).skip_while(|(_, l)| !l.contains("END OF HEADER")).skip(1).peekable();
    while let Some((number, head)) = rows.next() {
        let mut digits = String::new();
        while let Some((_, row)) =
            rows.next_if(|(_, row)| row.chars().all(|c| c.is_ascii_hexdigit() || c == ' ') && line::is_digits_only(row))
        {
            digits.extend(row.chars().filter(|c| *c != ' '));
            if digits.len() >= 2 * navbound_core::signal::sbas::BLOCK_BYTES {
                break;
            }
        }
        log.take(number, head, line::rinex_b(head, &digits));
    }
}

impl Log {
    fn take(&mut self, number: usize, text: &str, parsed: Result<Received, line::Fault>) {
        match parsed {
            Ok(mut message) => {
                if self.tag == Tag::Start {
                    message.end = GpsTime::from_nanoseconds(message.end.nanoseconds() + 1_000_000_000);
                }
                self.messages.push(message);
            }
            Err(fault) => self.refused.push(Refusal {
                line: number,
                field: fault.field.to_owned(),
                reason: fault.reason,
                text: text.chars().take(80).collect(),
            }),
        }
    }
}

#[cfg(test)]
mod tests;
