//! The positions of a whole log, and a count of what did not become one.

use super::dating::Dated;
use super::decoder::{Decoder, Item};
use super::epoch::{Ends, State};
use super::nmea::Heard;
use super::{Absent, Kind, Note, Position, Reason, sign};
use crate::stream::{Among, Frame, Frames, Place};
use navbound_core::quantity::GpsTime;
use std::collections::BTreeMap;

/// The ids of damaged messages among the reasons: of one that holds a position, and of any other.
const DAMAGED: &str = "damaged_message";
const DAMAGED_OTHER: &str = "damaged_other_message";

/// The id of an accuracy beside which no position stands.
const UNPAIRED: &str = "accuracy_without_position";

/// How far behind the last epoch, in usual steps and in seconds, a sentence says that the receiver went on, and the longest that its clock is
/// believed. Provenance: ours \[1, s\].
const USUAL_STEPS: f64 = 3.0;
const SILENT_S: f64 = 2.0;
const LONGEST_S: f64 = 86_400.0;

/// Doubts that are kept. Provenance: ours.
const MOST_NOTES: usize = 8;

/// Positions or messages that are not used, of one reason.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LeftOut {
    /// The id of the reason.
    pub reason: &'static str,
    /// Whether a sound receiver never writes it.
    pub damaged: bool,
    /// How many.
    pub count: usize,
    /// Number of the first message, from 1.
    pub first: u64,
    /// What stands in it.
    pub example: String,
}

/// What a log holds.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Log {
    /// Positions that are used, in the order of the log.
    pub positions: Vec<Position>,
    /// Positions of the log, used or not.
    pub n_rows: usize,
    /// Times of the epochs without a usable position, in the order of the log; `None` where it is not known.
    pub absent: Vec<Option<GpsTime>>,
    /// What is not used.
    pub left_out: Vec<LeftOut>,
    /// Quantity to the message field that it was read from.
    pub fields: BTreeMap<&'static str, &'static str>,
    /// Doubts, each once.
    pub notes: Vec<Note>,
    /// Bytes of no message of this receiver.
    pub n_outside: usize,
    /// Message of the first position, where no message of the log dates any.
    pub undated: Option<u64>,
}

/// Read a log, plain (see [`crate::packed::unpack`]).
pub fn read(bytes: &[u8], kind: Kind) -> Log {
    // One GGA anywhere, and RMC states no positions.
    let gga = sign::position(bytes, Kind::Nmea);
    let mut decoder = Decoder::with_state(kind, Ends::WithNext, State::default(), Heard { gga, ..Heard::default() });
    let (mut log, mut items) = (Log::default(), Vec::new());
    let (mut record, mut inside, mut sentences) = (0, 0, Sentences::default());
    for Place { at, end, frame } in Frames::new(bytes, Among::Receivers) {
        let family = frame.as_ref().map_or_else(|damage| damage.family, Frame::family);
        if family != kind.family() {
            continue;
        }
        record += 1;
        match frame {
            Ok(frame) => {
                inside += with_line(bytes, at, end, &frame);
                decoder.take(&frame, record, &mut items);
            }
            Err(damage) => {
                log.damaged(record, format!("byte {at}: {}", damage.reason), kind.stands_at(bytes.get(at..).unwrap_or_default(), gga))
            }
        }
        items.drain(..).for_each(|item| log.take(item, record, &mut sentences));
    }
    decoder.finish(&mut items);
    items.drain(..).for_each(|item| log.take(item, record, &mut sentences));
    log.n_outside = bytes.len().saturating_sub(inside);
    log.date(sentences);
    log
}

/// Positions of sentences, which wait for a date, and the dates with the number of their message.
#[derive(Default)]
struct Sentences {
    waiting: Vec<Position>,
    dates: Vec<(u64, Dated)>,
    /// Whether a datum was stated.
    datum: bool,
}

impl Sentences {
    /// The first datum that a file states is that of the positions before it, too: nothing else was stated of them.
    fn datum(&mut self, against: Option<String>) {
        if let Some(stated) = against.filter(|_| !self.datum) {
            for position in &mut self.waiting {
                let kept = position.absent.take_if(|absent| absent.takes_away());
                position.absent = kept.or_else(|| Some(Absent { reason: Reason::Contradicted, stated: stated.clone() }));
            }
        }
        self.datum = true;
    }
}

impl Log {
    fn take(&mut self, item: Item, record: u64, sentences: &mut Sentences) {
        match item {
            Item::Malformed(malformed) => self.leave_out(DAMAGED, true, malformed.record, malformed.reason.to_owned()),
            Item::Unpaired(record) => self.leave_out(UNPAIRED, false, record, "no position of its time".to_owned()),
            Item::Dated(dated) => sentences.dates.push((record, dated)),
            Item::Datum(against) => sentences.datum(against),
            Item::Position(position) if position.awaits_date() => sentences.waiting.push(*position),
            Item::Position(position) => self.position(*position),
        }
    }

    /// Each by the nearest dated sentence before or after it.
    fn date(&mut self, Sentences { waiting, dates, .. }: Sentences) {
        let mut place = 0;
        let Some(first) = waiting.first() else { return };
        if dates.is_empty() && !waiting.iter().any(Position::stands) {
            waiting.into_iter().for_each(|position| self.position(position));
            return;
        }
        if dates.is_empty() {
            (self.undated, self.n_rows) = (Some(first.record), self.n_rows + waiting.len());
            return;
        }
        for mut position in waiting {
            let apart = |place: usize| dates.get(place).map_or(u64::MAX, |(record, _)| record.abs_diff(position.record));
            while place + 1 < dates.len() && apart(place + 1) <= apart(place) {
                place += 1;
            }
            if let Some((record, dated)) = dates.get(place) {
                position.date(*dated);
                position.forget_time_before(*record, *dated);
            }
            self.position(position.checked());
        }
        for of_end in [dates.first(), dates.last()].into_iter().flatten() {
            self.beyond(*of_end);
        }
    }

    /// A sentence of a time well before or behind all epochs: the receiver went on without a position.
    fn beyond(&mut self, (record, dated): (u64, Dated)) {
        let mut moment = Position { of_day: Some(dated.of_day), ..Position::default() };
        moment.date(dated);
        let times = || self.positions.iter().filter_map(|each| each.time).chain(self.absent.iter().copied().flatten());
        let (Some(time), Some(first), Some(last)) = (moment.time, times().min(), times().max()) else { return };
        let usual_s = last.seconds_since(first) / (times().count().max(2) - 1) as f64;
        let beyond_s = time.seconds_since(last).max(first.seconds_since(time));
        if beyond_s > (USUAL_STEPS * usual_s).max(SILENT_S) && beyond_s < LONGEST_S {
            self.n_rows += 1;
            self.absent.push(Some(time));
            self.leave_out(Reason::NoFix.id(), false, record, "RMC or ZDA, and no position of its time".to_owned());
        }
    }

    fn position(&mut self, mut position: Position) {
        self.n_rows += 1;
        if let Some(absent) = position.absent.take_if(|absent| absent.takes_away()) {
            self.absent.push(position.time);
            self.leave_out(absent.reason.id(), absent.reason.damaged(), position.record, absent.stated);
            return;
        }
        let notes: Vec<Note> = position.notes.into_iter().flatten().collect();
        self.fields.extend(position.fields.iter().chain(position.levels_from).copied());
        if let Some(from) = position.covariance_from {
            let named = self.fields.entry("covariance").or_insert(from);
            if !notes.iter().any(|note| note.of_substitute()) {
                *named = from;
            }
        }
        for note in notes {
            if self.notes.len() < MOST_NOTES && !self.notes.contains(&note) {
                self.notes.push(note);
            }
        }
        self.positions.push(position);
    }

    /// A frame that cannot be read. One of a position was an epoch; any other takes no position away.
    fn damaged(&mut self, record: u64, example: String, of_position: bool) {
        if of_position {
            self.n_rows += 1;
            self.absent.push(None);
        }
        self.leave_out(if of_position { DAMAGED } else { DAMAGED_OTHER }, of_position, record, example);
    }

    fn leave_out(&mut self, reason: &'static str, damaged: bool, first: u64, example: String) {
        match self.left_out.iter_mut().find(|each| each.reason == reason) {
            Some(each) => each.count += 1,
            None => self.left_out.push(LeftOut { reason, damaged, count: 1, first, example }),
        }
    }
}

/// Bytes of a frame; of one that is text with the end of its line, and with the word before it and the time of arrival behind it that the
/// loggers of telephones write.
fn with_line(bytes: &[u8], at: usize, end: usize, frame: &Frame<'_>) -> usize {
    if !matches!(frame, Frame::Nmea(_) | Frame::NovatelText(_)) {
        return end - at;
    }
    let (before, behind) = (bytes.get(..at).unwrap_or_default(), bytes.get(end..).unwrap_or_default());
    let arrival = behind.strip_prefix(b",").map_or(0, |digits| 1 + digits.iter().take_while(|byte| byte.is_ascii_digit()).count());
    let line_end =
        |from: usize| behind.get(from..).unwrap_or_default().iter().take(2).take_while(|byte| matches!(byte, b'\r' | b'\n')).count();
    let word = if before.ends_with(b"NMEA,") { 5 } else { 0 };
    match (arrival, line_end(arrival)) {
        (arrival, 1..) if arrival > 1 => end - at + arrival + line_end(arrival) + word,
        _ => end - at + line_end(0),
    }
}
