//! SBAS message logs to 250-bit blocks: EMS text, RTKLIB `.sbs`, RINEX-B, raw logs of receivers; plain or packed by gzip.
//!
//! Logs differ in the instant they write beside a message. A reader takes it as input ([`Tag`]), says what it assumed ([`Log::tag`]), and hands on one
//! thing only: when the message ended.

mod line;

use crate::order::most_rising;
use crate::packed::unpack;
use crate::receiver;
use crate::refusal::{Refusal, Unreadable};
use navbound_core::quantity::GpsTime;
use navbound_core::signal::sbas::Block;
use std::collections::{BTreeMap, BTreeSet};

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
    /// Line of each message, while the log is read.
    line: Vec<usize>,
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
    let mut log = Log { format, tag, messages: Vec::new(), refused: Vec::new(), line: Vec::new() };
    match format {
        Format::Ems => lines(&text, &mut log, line::ems),
        Format::Rtklib => lines(&text, &mut log, line::rtklib),
        Format::RinexB => records(&text, &mut log),
        Format::Receiver => frames(&plain, &mut log)?,
    }
    log.drop_backward();
    Ok(log)
}

/// The messages of a raw log; their ends follow from the measurements beside them.
fn frames(plain: &[u8], log: &mut Log) -> Result<(), Unreadable> {
    let receiver_log = receiver::read(plain)?;
    if receiver_log.messages.is_empty() {
        return Err(Unreadable::whole("a receiver's log without one SBAS L1 message that is dated"));
    }
    (log.messages, log.refused) = (receiver_log.messages, receiver_log.observations.refused);
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
    /// Refuse messages that no receiver heard in this order: a wrong date would make an old correction a new one. A satellite sends one
    /// message a second: of two of one second nobody knows which is dated wrongly.
    fn drop_backward(&mut self) {
        let senders: BTreeSet<u8> = self.messages.iter().map(|m| m.prn).collect();
        let mut stands = vec![true; self.line.len()];
        for prn in senders {
            let own: Vec<usize> = (0..self.line.len()).filter(|k| self.messages[*k].prn == prn).collect();
            let ends: Vec<GpsTime> = own.iter().map(|k| self.messages[*k].end).collect();
            if !ends.is_sorted() {
                own.iter().for_each(|k| stands[*k] = false);
                most_rising(&ends, false).into_iter().for_each(|k| stands[own[k]] = true);
            }
        }
        let in_order = stands.clone();
        for k in self.doubted(&stands) {
            stands[k] = false;
        }
        for (k, (line, message)) in self.line.iter().zip(&self.messages).enumerate().filter(|(k, _)| !stands[*k]) {
            let text = format!("PRN {}, message type {}", message.prn, message.block.message_type());
            let reason = if in_order[k] {
                "another message of this satellite has the same time; neither is taken"
            } else {
                "the time runs backwards against the messages around it"
            };
            self.refused.push(Refusal { line: *line, field: "time".to_owned(), reason: reason.to_owned(), text });
        }
        if !self.line.is_empty() {
            let mut kept = stands.iter();
            self.messages.retain(|_| kept.next().is_none_or(|stands| *stands));
        }
        self.refused.sort_by_key(|r| r.line);
        self.line.clear();
    }

    /// Messages, of those that stand, that share sender and second with another one.
    fn doubted(&self, stands: &[bool]) -> Vec<usize> {
        let mut at: BTreeMap<(u8, GpsTime), Vec<usize>> = BTreeMap::new();
        if self.line.is_empty() {
            return Vec::new();
        }
        for (k, m) in self.messages.iter().enumerate().filter(|(k, _)| stands.get(*k) == Some(&true)) {
            at.entry((m.prn, m.end)).or_default().push(k);
        }
        let differ = |several: &Vec<usize>| several.iter().any(|k| self.messages[*k].block != self.messages[several[0]].block);
        at.into_values().filter(differ).flatten().collect()
    }

    fn take(&mut self, number: usize, text: &str, parsed: Result<Received, line::Fault>) {
        match parsed {
            Ok(mut message) => {
                if self.tag == Tag::Start {
                    message.end = GpsTime::from_nanoseconds(message.end.nanoseconds() + 1_000_000_000);
                }
                self.messages.push(message);
                self.line.push(number);
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

/// What the preambles say of the times of one satellite's messages.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Preambles {
    /// PRN of the sender.
    pub prn: u8,
    /// Messages by how late their time is by the preamble, modulo three seconds: right, one second late, one second early.
    pub count: [usize; 3],
}

/// Share of a satellite's messages that must agree before the preambles are believed, and their least number. Provenance: ours; in whole
/// logs all agree.
const AGREE: f64 = 0.9;
const LEAST: usize = 10;

impl Preambles {
    /// Of each sender. On L1 the first of the three preambles begins with a GPS second that six divides (standard), so that a message with
    /// the preamble p ends in a second s with (s - p) mod 3 = 1.
    pub fn of(messages: &[Received]) -> Vec<Self> {
        let mut all: Vec<Self> = Vec::new();
        for m in messages {
            let at = all.iter().position(|s| s.prn == m.prn).unwrap_or_else(|| {
                all.push(Self { prn: m.prn, count: [0; 3] });
                all.len() - 1
            });
            let phase = match m.block.bytes().first() {
                Some(0x9a) => 1,
                Some(0xc6) => 2,
                _ => 0,
            };
            let late = (m.end.nanoseconds().div_euclid(1_000_000_000) - phase - 1).rem_euclid(3);
            all[at].count[late as usize] += 1;
        }
        all
    }

    /// How late the times are \[s\]: 0, 1 or -1; none where too few messages agree.
    pub fn late_s(&self) -> Option<i64> {
        let total: usize = self.count.iter().sum();
        let (which, most) = self.count.iter().enumerate().max_by_key(|(_, n)| **n)?;
        (total >= LEAST && *most as f64 >= AGREE * total as f64).then_some([0, 1, -1][which])
    }
}

#[cfg(test)]
mod tests;
