//! Alerts of the source itself: silent, wrong clock, damaged, disconnected, too many tracks. They never say anything of one track.

use crate::codec::{Damaged, Reader, Writer};
use crate::output::{Kind, Output, Transition, Turn};
use navbound_core::quantity::GpsTime;

/// Time over which refusals are counted \[ns\].
const WINDOW_NS: i64 = 10_000_000_000;
/// Share of refused frames from which the source is garbled: a tenth.
const GARBLED_ONE_IN: u64 = 10;
/// The kinds, in the order of their state.
const KINDS: [Kind; 5] = [Kind::Quiet, Kind::Clock, Kind::Garbled, Kind::FleetFull, Kind::SourceLost];

/// What is known of the source. All times are arrivals; where arrivals are not known, there are no such alerts but that of too
/// many tracks and, at the end, that of a damaged source.
#[derive(Debug, Clone, Default)]
pub(crate) struct Feed {
    open: [Option<GpsTime>; KINDS.len()],
    /// Last arrival of a record with a possible time, or of a message of a source that sends many without a position.
    good: Option<GpsTime>,
    /// First record with an impossible time since then.
    bad_since: Option<GpsTime>,
    /// Begin of the window, frames in it, and refused ones.
    window: Option<(GpsTime, u64, u64)>,
}

impl Feed {
    fn place(kind: Kind) -> usize {
        KINDS.iter().position(|each| *each == kind).unwrap_or(0)
    }

    pub(crate) fn raise(&mut self, kind: Kind, onset: GpsTime, now: GpsTime, out: &mut Vec<Output>) {
        let open = &mut self.open[Self::place(kind)];
        if open.is_none() {
            *open = Some(now);
            out.push(transition(kind, Turn::Raised, now, onset, now));
        }
    }

    pub(crate) fn clear(&mut self, kind: Kind, now: GpsTime, out: &mut Vec<Output>) {
        if let Some(annunciation) = self.open[Self::place(kind)].take() {
            out.push(transition(kind, Turn::Cleared, annunciation, annunciation, now));
        }
    }

    /// A record with a possible time.
    pub(crate) fn good(&mut self, arrival: Option<GpsTime>, out: &mut Vec<Output>) {
        let Some(arrival) = arrival else { return };
        (self.good, self.bad_since) = (Some(arrival), None);
        self.clear(Kind::Quiet, arrival, out);
        self.clear(Kind::Clock, arrival, out);
    }

    /// Whole messages, of which few hold a position: the source is not silent.
    pub(crate) fn heard(&mut self, arrival: GpsTime, out: &mut Vec<Output>) {
        self.good = Some(arrival);
        self.clear(Kind::Quiet, arrival, out);
    }

    /// A record with an impossible time.
    pub(crate) fn impossible(&mut self, arrival: GpsTime, out: &mut Vec<Output>) {
        let since = *self.bad_since.get_or_insert(arrival);
        if arrival.nanoseconds().saturating_sub(since.nanoseconds()) > WINDOW_NS {
            self.raise(Kind::Clock, since, arrival, out);
        }
    }

    /// Frames of a chunk, and how many were refused.
    pub(crate) fn frames(&mut self, arrival: Option<GpsTime>, n: u64, n_refused: u64, out: &mut Vec<Output>) {
        let Some(arrival) = arrival else { return };
        let (begin, mut all, mut refused) = self.window.unwrap_or((arrival, 0, 0));
        (all, refused) = (all + n + n_refused, refused + n_refused);
        if arrival.nanoseconds().saturating_sub(begin.nanoseconds()) < WINDOW_NS {
            self.window = Some((begin, all, refused));
            return;
        }
        if refused * GARBLED_ONE_IN >= all && refused > 0 {
            self.raise(Kind::Garbled, begin, arrival, out);
        } else {
            self.clear(Kind::Garbled, arrival, out);
        }
        self.window = Some((arrival, 0, 0));
    }

    /// A source whose arrivals are not known has ended: frames and those that could not be read, by `now`, a time of its own.
    pub(crate) fn ended(&self, (n, n_unread): (u64, u64), now: GpsTime, out: &mut Vec<Output>) {
        if n_unread * GARBLED_ONE_IN >= n && n_unread > 0 {
            out.push(Output::Transition(Transition { arrival: None, ..of_source(Kind::Garbled, Turn::Raised, now, now, now) }));
        }
    }

    /// The reader is alive at `now`.
    pub(crate) fn heartbeat(&mut self, now: GpsTime, quiet_after_ns: i64, out: &mut Vec<Output>) {
        let since = *self.good.get_or_insert(now);
        if now.nanoseconds().saturating_sub(since.nanoseconds()) > quiet_after_ns {
            self.raise(Kind::Quiet, since, now, out);
        }
    }

    pub(crate) fn write(&self, to: &mut Writer) {
        let time = |to: &mut Writer, time: Option<GpsTime>| to.option(time, |to, time| to.i64(time.nanoseconds()));
        self.open.into_iter().chain([self.good, self.bad_since]).for_each(|each| time(to, each));
        to.option(self.window, |to, (begin, all, refused)| {
            to.i64(begin.nanoseconds());
            to.u64(all);
            to.u64(refused);
        });
    }

    pub(crate) fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        let time = |from: &mut Reader<'_>| from.option(|from| from.i64().map(GpsTime::from_nanoseconds));
        let mut open = [None; KINDS.len()];
        for each in &mut open {
            *each = time(from)?;
        }
        let (good, bad_since) = (time(from)?, time(from)?);
        let window = from.option(|from| Ok((GpsTime::from_nanoseconds(from.i64()?), from.u64()?, from.u64()?)))?;
        Ok(Self { open, good, bad_since, window })
    }
}

fn transition(kind: Kind, turn: Turn, annunciation: GpsTime, onset: GpsTime, now: GpsTime) -> Output {
    Output::Transition(of_source(kind, turn, annunciation, onset, now))
}

fn of_source(kind: Kind, turn: Turn, annunciation: GpsTime, onset: GpsTime, now: GpsTime) -> Transition {
    Transition {
        track: None,
        incarnation: 0,
        kind,
        turn,
        annunciation,
        onset,
        clear: (turn == Turn::Cleared).then_some(now),
        peak_m: f64::NAN,
        limit_m: f64::NAN,
        min_margin_m: f64::NAN,
        event: now,
        arrival: Some(now),
    }
}
