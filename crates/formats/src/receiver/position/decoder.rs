//! Frames of a receiver to positions, one after the other.

use super::dating::Dated;
use super::epoch::{Ends, Epoch, Message, State, TALKERS, WITNESSES, all_of_kind};
use super::nmea::Heard;
use super::sentence::Sentence;
use super::witnesses::Near;
use super::{Kind, Position, Reason, nmea, novatel, sbf, ubx, witnesses};
use crate::stream::Frame;

/// A message that is shorter than its definition, or has a field that is none.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Malformed {
    /// Number of the message.
    pub record: u64,
    /// Which message, and what is wrong.
    pub reason: &'static str,
}

/// What frames give.
#[derive(Debug, Clone, PartialEq)]
pub enum Item {
    /// An epoch.
    Position(Box<Position>),
    /// A date of sentences, which dates those around it.
    Dated(Dated),
    /// What a sentence said against the datum of the positions around it, or nothing where that is WGS-84.
    Datum(Option<String>),
    /// A message that is none.
    Malformed(Malformed),
    /// Number of a message with an accuracy beside which no position stands.
    Unpaired(u64),
}

/// Decoder of one receiver's stream. Between two frames it keeps the messages of an unfinished epoch.
#[derive(Debug, Clone)]
pub struct Decoder {
    kind: Kind,
    epoch: Epoch,
    heard: Heard,
}

/// What a message does to an epoch.
pub(super) enum Step {
    /// Nothing that is read.
    Passed,
    /// It belongs to the epoch `key`.
    Part { key: i64, kind: u32 },
    /// The same, and several talkers write it.
    PartOfTalkers { key: i64, kind: u32 },
    /// The same, and each of several talkers writes it once; a second one of the same talker is another epoch.
    PartOfEach { key: i64, kind: u32 },
    /// It ends the epoch `key`.
    End { key: i64, kind: u32 },
    /// It is of the epoch `key` and holds a date, or none; whether it holds more.
    Date { key: i64, kind: u32, dated: Option<Dated>, kept: bool },
    /// It has no time of its own and belongs to the unfinished epoch; of several the one with the largest number counts.
    Beside { kind: u32, number: fn(&[u8]) -> f64 },
    /// It states a datum that holds until the next one, and what that says against positions.
    Datum(Option<String>),
    /// It states a place from this field on, and no time.
    Untimed { name: &'static str, at: usize },
    /// It is an epoch of its own.
    Whole(Box<Position>),
    /// It is none.
    Malformed(&'static str),
}

impl Decoder {
    /// A decoder that has seen nothing yet.
    pub fn new(kind: Kind, ends: Ends) -> Self {
        Self { kind, epoch: Epoch { state: State::default(), ends }, heard: Heard::default() }
    }

    /// The decoder that had this state: see [`Self::state`].
    pub fn with_state(kind: Kind, ends: Ends, state: State, heard: Heard) -> Self {
        Self { kind, epoch: Epoch { state, ends }, heard }
    }

    /// What it keeps between two frames: the unfinished epoch, and what sentences said that holds beyond theirs.
    pub fn state(&self) -> (&State, &Heard) {
        (&self.epoch.state, &self.heard)
    }

    /// The next frame, with its number in the stream, or 0 where nobody counts. Those of other receivers are passed over.
    pub fn take(&mut self, frame: &Frame<'_>, record: u64, out: &mut Vec<Item>) {
        if let (Kind::Nmea, Frame::Nmea(body)) = (self.kind, frame) {
            self.heard.gga |= nmea::is_gga(body);
        }
        let (step, body) = match (self.kind, frame) {
            (Kind::Ubx, Frame::Ubx { kind, payload }) => (ubx::step(*kind, payload), *payload),
            (Kind::Sbf, Frame::Sbf { block, body }) => (sbf::step(*block, body), *body),
            (Kind::Nmea, Frame::Nmea(body)) => (nmea::step(body, record, self.heard.gga), *body),
            (Kind::Novatel, Frame::NovatelBinary { head, body }) => (novatel::binary(head, body, record), *body),
            (Kind::Novatel, Frame::NovatelText(body)) => (novatel::text(body, record), *body),
            _ => return,
        };
        match step {
            Step::Passed => {}
            Step::Malformed(reason) => out.push(Item::Malformed(Malformed { record, reason })),
            Step::Untimed { name, at } => {
                let against = self.heard.near.and_then(|near| witnesses::untimed(name, &Sentence(body), at, &near));
                self.heard.against = against.or_else(|| self.heard.against.take());
            }
            Step::Whole(position) => {
                self.finish(out);
                out.push(Item::Position(Box::new(position.checked())));
            }
            Step::Part { key, kind } => {
                let complete = self.epoch.put(key, Message { kind, record, body: body.to_vec() });
                self.emit(&complete, out);
                self.end_at_last(out);
            }
            Step::PartOfTalkers { key, kind } => {
                let complete = self.epoch.put_again(key, Message { kind, record, body: body.to_vec() }, TALKERS);
                self.emit(&complete, out);
                self.end_at_last(out);
            }
            Step::PartOfEach { key, kind } => {
                let talker = |body: &[u8]| body.get(..2).map(<[u8]>::to_vec);
                let again = all_of_kind(&self.epoch.state.messages, kind).any(|each| talker(&each.body) == talker(body));
                let most = if again { 1 } else { TALKERS };
                let complete = self.epoch.put_again(key, Message { kind, record, body: body.to_vec() }, most);
                self.emit(&complete, out);
                self.end_at_last(out);
            }
            Step::Beside { kind, number } => {
                let message = Message { kind, record, body: body.to_vec() };
                self.epoch.put_beside(message, |new, kept| number(&new.body) > number(&kept.body));
            }
            Step::Datum(against) => {
                let talker = body.get(..2).and_then(|talker| talker.try_into().ok()).unwrap_or_default();
                self.heard.datum.hear(talker, against.clone());
                out.push(Item::Datum(against));
            }
            Step::End { key, kind } => {
                self.begin(key, kind, out);
                if self.epoch.ends == Ends::WithLast {
                    self.finish(out);
                }
            }
            Step::Date { key, kind, dated, kept } => {
                let known = self.epoch.state.key == Some(key);
                let before = || all_of_kind(&self.epoch.state.messages, kind).filter(|_| known);
                let (n_before, places) = (before().count(), nmea::places(kind, self.heard.gga));
                // Of several talkers each is heard; what states no epoch of its own begins none, however often it comes.
                let most = if places { TALKERS } else { WITNESSES };
                if kept && (n_before < most || places) {
                    let message = Message { kind, record, body: body.to_vec() };
                    let complete = if n_before > 0 { self.epoch.put_again(key, message, most) } else { self.epoch.put(key, message) };
                    self.emit(&complete, out);
                } else if kept {
                    // Two letters are the talker.
                    let repeats = before().any(|each| each.body.get(2..) == body.get(2..));
                    let reason = "more different sentences of one kind than an epoch has";
                    out.extend((!repeats).then_some(Item::Malformed(Malformed { record, reason })));
                    self.epoch.pass_again(key, kind);
                } else if known {
                    self.epoch.pass(key, kind);
                }
                // A date of another time ends no epoch: some receivers write it between a position and its accuracy, a moment later.
                self.heard.dated = dated.or(self.heard.dated);
                out.extend(dated.map(Item::Dated));
                self.end_at_last(out);
            }
        }
    }

    /// No frame follows, or none came for a while: the epoch as it is.
    pub fn finish(&mut self, out: &mut Vec<Item>) {
        let complete = self.epoch.take();
        self.emit(&complete, out);
    }

    fn begin(&mut self, key: i64, kind: u32, out: &mut Vec<Item>) {
        if self.epoch.state.key != Some(key) {
            self.finish(out);
        }
        self.epoch.pass(key, kind);
    }

    fn end_at_last(&mut self, out: &mut Vec<Item>) {
        if self.epoch.at_last() {
            self.finish(out);
        }
    }

    fn emit(&mut self, messages: &[Message], out: &mut Vec<Item>) {
        if messages.is_empty() {
            return;
        }
        let position = match self.kind {
            Kind::Ubx => ubx::position(messages),
            Kind::Sbf => sbf::position(messages),
            Kind::Nmea => nmea::position(messages, &self.heard),
            Kind::Novatel => None,
        };
        self.heard.datum.next_epoch();
        let Some(mut position) = position else {
            if self.kind == Kind::Nmea {
                out.extend(nmea::accuracy_alone(messages).map(Item::Unpaired));
                let heard = &mut self.heard;
                heard.loose_m = heard.loose_m.into_iter().chain(witnesses::loose_m(messages)).reduce(f64::max);
                heard.against = heard.near.and_then(|near| witnesses::against(messages, &near)).or_else(|| heard.against.take());
            }
            return;
        };
        // What was contradicted is compared again, so that each of its epochs is.
        let compared = position.absent.as_ref().is_none_or(|absent| absent.reason == Reason::Contradicted);
        let place = position.lat_rad.zip(position.lon_rad).zip(position.of_day).filter(|_| compared);
        let near = place.map(|(place, of_day)| Near { place, of_day });
        self.heard = Heard { near, against: None, loose_m: None, ..core::mem::take(&mut self.heard) };
        // The reader of a whole file knows the dates behind a sentence too.
        if let (Ends::WithLast, Some(dated)) = (self.epoch.ends, self.heard.dated) {
            position.date(dated);
        }
        out.push(Item::Position(Box::new(position.checked())));
    }
}
