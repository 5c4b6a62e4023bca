//! The state machine: inputs in the order of arrival to epochs and alerts.

use crate::counters::{Counters, Refused};
use crate::decode::{Decoded, Decoder};
use crate::feed::Feed;
use crate::guard;
use crate::input::Input;
use crate::judging::{self, Cause};
use crate::order::{Arrived, Put};
use crate::output::{Kind, Output, Turn};
use crate::position::{Position, TrackId};
use crate::settings::Settings;
use crate::track::Track;
use navbound_core::judge::Judge;
use navbound_core::monitor::rnp;
use navbound_core::quantity::{GpsTime, OutOfDomain, Reason};
use std::collections::{BTreeMap, BTreeSet};

/// Silence of a source after which an unfinished frame or epoch is all there is \[ns\]: by arrivals, never by a timer.
const IDLE_NS: i64 = 1_000_000_000;

/// The unit of order and of state: one source.
#[derive(Debug, Clone)]
pub struct Lane {
    pub(crate) settings: Settings,
    pub(crate) fresh: Judge,
    pub(crate) decoder: Decoder,
    pub(crate) feed: Feed,
    pub(crate) tracks: BTreeMap<TrackId, Track>,
    /// Incarnation of tracks that were forgotten, and their last time.
    pub(crate) forgotten: BTreeMap<TrackId, (u32, GpsTime)>,
    /// Tracks by the time of their earliest record that waits.
    pub(crate) waiting: BTreeSet<(GpsTime, TrackId)>,
    /// Tracks by a time no later than that at which their silence is due.
    pub(crate) deadlines: BTreeSet<(GpsTime, TrackId)>,
    /// Largest time of an admitted record or heartbeat.
    pub(crate) event_time: Option<GpsTime>,
    pub(crate) last_chunk: Option<GpsTime>,
    pub(crate) counters: Counters,
    /// Monitors of tracks that were forgotten.
    pub(crate) past: rnp::Counters,
    #[cfg(test)]
    pub(crate) fault: Option<TrackId>,
}

impl Lane {
    /// A lane that has seen nothing yet.
    ///
    /// # Errors
    /// [`OutOfDomain`] of the monitor's settings.
    pub fn new(settings: Settings) -> Result<Self, OutOfDomain> {
        let fresh = Judge::new(settings.judge)?;
        Ok(Self {
            decoder: Decoder::new(settings.format, settings.claims, settings.track, settings.statements.clone()),
            settings,
            fresh,
            feed: Feed::default(),
            tracks: BTreeMap::new(),
            forgotten: BTreeMap::new(),
            waiting: BTreeSet::new(),
            deadlines: BTreeSet::new(),
            event_time: None,
            last_chunk: None,
            counters: Counters::default(),
            past: rnp::Counters::default(),
            #[cfg(test)]
            fault: None,
        })
    }

    /// One input; what it changes is put behind `out`.
    pub fn step(&mut self, input: &Input<'_>, out: &mut Vec<Output>) {
        match *input {
            Input::Chunk { arrival, bytes } => {
                if let Some(now) = arrival {
                    self.idle(now, out);
                    self.last_chunk = Some(now);
                }
                self.counters.n_bytes += bytes.len() as u64;
                let mut decoded = Vec::new();
                let n = self.decoder.push(bytes, arrival, &mut decoded);
                self.take(&decoded, arrival, n, out);
            }
            Input::Heartbeat { arrival } => {
                self.idle(arrival, out);
                self.feed.heartbeat(arrival, (self.fresh.monitor().settings().stale_after_s * 1e9) as i64, out);
                // The clock of the host stands for that of the source, once the source has shown that they agree.
                if self.event_time.is_some() {
                    self.advance(arrival, Some(arrival), out);
                }
            }
            Input::Link { arrival, up } => {
                if up {
                    self.feed.clear(Kind::SourceLost, arrival, out);
                } else {
                    self.feed.raise(Kind::SourceLost, arrival, arrival, out);
                }
            }
            Input::End { arrival } => {
                let mut decoded = Vec::new();
                self.decoder.flush(arrival, &mut decoded);
                self.take(&decoded, arrival, 0, out);
                self.release_until(GpsTime::from_nanoseconds(i64::MAX), false, arrival, out);
                if let (None, Some(now)) = (arrival, self.event_time) {
                    self.feed.ended(self.counters.read_and_not(), now, out);
                }
            }
        }
    }

    /// A source that was silent until `now` has no more to say of what it began.
    fn idle(&mut self, now: GpsTime, out: &mut Vec<Output>) {
        let silent = self.last_chunk.is_some_and(|last| now.nanoseconds().saturating_sub(last.nanoseconds()) > IDLE_NS);
        if silent {
            let (mut decoded, arrival) = (Vec::new(), self.last_chunk.take());
            self.decoder.flush(arrival, &mut decoded);
            self.take(&decoded, arrival, 0, out);
        }
    }

    fn take(&mut self, decoded: &[Decoded], arrival: Option<GpsTime>, n_frames: u64, out: &mut Vec<Output>) {
        let n_refused = decoded.iter().filter(|each| each.as_ref().is_err_and(|reason| reason.unread())).count() as u64;
        self.counters.n_frames += n_frames;
        self.feed.frames(arrival, n_frames, n_refused, out);
        if let Some(now) = arrival.filter(|_| n_frames > 0 && self.settings.format.is_of_messages()) {
            self.feed.heard(now, out);
        }
        for each in decoded {
            match each {
                Ok(position) => self.accept(position, arrival, out),
                Err(reason) => {
                    self.counters.refuse(*reason);
                    self.lose(*reason);
                }
            }
        }
    }

    /// What a receiver states of its accuracy beside no position is not passed over by what the user assumes.
    fn lose(&mut self, reason: Refused) {
        if let Some(track) = self.tracks.get_mut(&self.settings.track).filter(|_| reason == Refused::AccuracyAlone) {
            track.stated.lost = true;
        }
    }

    fn accept(&mut self, position: &Position, arrival: Option<GpsTime>, out: &mut Vec<Output>) {
        if let Err(reason) = guard::admit(&self.settings, position.time, arrival) {
            self.counters.refuse(reason);
            if let Some(arrival) = arrival {
                self.feed.impossible(arrival, out);
            }
            return;
        }
        self.feed.good(arrival, out);
        let (id, full) = (position.track, self.tracks.len() >= self.settings.max_tracks);
        if full && !self.tracks.contains_key(&id) {
            self.counters.refuse(Refused::FleetFull);
            let now = arrival.unwrap_or(position.time);
            self.feed.raise(Kind::FleetFull, now, now, out);
            return;
        }
        self.counters.n_records += 1;
        let (fresh, forgotten) = (self.fresh, &mut self.forgotten);
        let track = self.tracks.entry(id).or_insert_with(|| {
            let incarnation = forgotten.remove(&id).map_or(0, |(incarnation, _)| incarnation.saturating_add(1));
            Track::new(fresh, incarnation)
        });
        let arrived = Arrived { position: *position, arrival };
        // No order can be restored any more: the monitor knows what to make of a repeat and of a late record.
        if track.last.is_some_and(|last| position.time <= last) {
            self.judge(&arrived, out);
        } else {
            let before = track.waiting.first();
            match track.waiting.put(arrived) {
                Put::Repeated => self.counters.n_duplicate += 1,
                Put::Before => self.counters.n_reordered += 1,
                Put::Last => {}
            }
            let first = track.waiting.first();
            self.wait_anew(id, before, first);
            self.release_next(id, out);
        }
        self.advance(position.time, arrival, out);
    }

    /// The event time is at least `time`.
    fn advance(&mut self, time: GpsTime, arrival: Option<GpsTime>, out: &mut Vec<Output>) {
        if self.event_time.is_none_or(|before| time > before) {
            self.event_time = Some(time);
            self.release_until(self.watermark(), true, arrival, out);
        }
    }

    /// Event time less the allowed lateness.
    pub fn watermark(&self) -> GpsTime {
        let event_ns = self.event_time.map_or(i64::MIN, GpsTime::nanoseconds);
        GpsTime::from_nanoseconds(event_ns.saturating_sub(self.settings.lateness_ns))
    }

    fn wait_anew(&mut self, id: TrackId, before: Option<GpsTime>, first: Option<GpsTime>) {
        if before != first {
            before.map(|time| self.waiting.remove(&(time, id)));
            first.map(|time| self.waiting.insert((time, id)));
        }
    }

    /// Records of a track whose turn has come by their own order.
    fn release_next(&mut self, id: TrackId, out: &mut Vec<Output>) {
        let watermark = self.watermark();
        self.release_track(id, watermark, out);
    }

    fn release_track(&mut self, id: TrackId, watermark: GpsTime, out: &mut Vec<Output>) {
        let period_s = self.settings.judge.monitor.chain.sample_period_s;
        loop {
            let Some(track) = self.tracks.get_mut(&id) else { return };
            let before = track.waiting.first();
            let Some(arrived) = track.waiting.due(watermark, track.next(period_s)) else { return };
            let first = track.waiting.first();
            self.wait_anew(id, before, first);
            self.judge(&arrived, out);
        }
    }

    /// Everything that is due until the watermark, in the order of time and then of names: records first, then silences.
    fn release_until(&mut self, watermark: GpsTime, with_silences: bool, arrival: Option<GpsTime>, out: &mut Vec<Output>) {
        loop {
            let record = self.waiting.first().copied().filter(|(time, _)| *time <= watermark);
            let silence = self.deadlines.first().copied().filter(|(time, _)| with_silences && *time < watermark);
            match (record, silence) {
                (Some((time, id)), due) if due.is_none_or(|(deadline, _)| time <= deadline) => self.release_track(id, time, out),
                (_, Some((deadline, id))) => {
                    self.deadlines.remove(&(deadline, id));
                    self.silence(id, watermark, arrival, out);
                }
                _ => return,
            }
        }
    }

    /// A track whose deadline may have passed.
    fn silence(&mut self, id: TrackId, watermark: GpsTime, arrival: Option<GpsTime>, out: &mut Vec<Output>) {
        let expiry_ns = self.settings.expiry_ns;
        let Some(track) = self.tracks.get_mut(&id) else { return };
        let Some(last) = track.last else { return };
        let stale_ns = (track.judge.monitor().settings().stale_after_s * 1e9) as i64;
        let after = |ns: i64| GpsTime::from_nanoseconds(last.nanoseconds().saturating_add(ns));
        let cause = Cause { event: watermark, arrival };
        if after(stale_ns) >= watermark {
            self.deadlines.insert((after(stale_ns), id));
            return;
        }
        if !track.silent {
            track.silent = true;
            let began = track.judge.tick(watermark).began;
            judging::begin(id, track, began, cause, out);
        }
        match expiry_ns.map(after) {
            Some(expiry) if expiry < watermark => self.forget(id, last, cause, out),
            Some(expiry) => {
                self.deadlines.insert((expiry, id));
            }
            None => {}
        }
    }

    fn forget(&mut self, id: TrackId, last: GpsTime, cause: Cause, out: &mut Vec<Output>) {
        let Some(mut track) = self.tracks.remove(&id) else { return };
        let events: Vec<_> = track.judge.monitor().open_events().copied().collect();
        for event in events {
            judging::end(id, &mut track, Some(&event), Turn::Expired, cause, out);
        }
        track.waiting.first().map(|time| self.waiting.remove(&(time, id)));
        self.past = self.past.merged(track.judge.monitor().counters());
        self.counters.n_expired += 1;
        self.forgotten.insert(id, (track.incarnation, last));
        if self.forgotten.len() > 4 * self.settings.max_tracks {
            let oldest = self.forgotten.iter().min_by_key(|(id, (_, last))| (*last, **id)).map(|(id, _)| *id);
            oldest.map(|id| self.forgotten.remove(&id));
        }
        if self.tracks.len() < self.settings.max_tracks {
            self.feed.clear(Kind::FleetFull, cause.arrival.unwrap_or(cause.event), out);
        }
    }

    fn judge(&mut self, arrived: &Arrived, out: &mut Vec<Output>) {
        let id = arrived.position.track;
        let (watermark, alone) = (self.watermark(), self.tracks.len() == 1);
        let Some(track) = self.tracks.get_mut(&id) else { return };
        let stale_s = track.judge.monitor().settings().stale_after_s;
        let mut arrived = *arrived;
        // What is older than monitoring may be silent is no news, by the time of the others and by that of its own arrival.
        let lateness_ns = self.settings.lateness_ns;
        let heard = arrived.arrival.map(|at| GpsTime::from_nanoseconds(at.nanoseconds().saturating_sub(lateness_ns)));
        let now = heard.map_or(watermark, |heard| heard.max(watermark));
        if now.seconds_since(arrived.position.time) > stale_s && arrived.position.status.usable() {
            self.counters.n_stale += 1;
            arrived.position = arrived.position.without(Reason::RecordOld);
        }
        let (before, incarnation, silent) = (track.last, track.incarnation, track.silent);
        #[cfg(test)]
        let fault = self.fault == Some(id);
        #[cfg(not(test))]
        let fault = false;
        let n_before = out.len();
        self.counters.n_internal += u64::from(judging::judge(&self.settings, id, track, &arrived, out, fault));
        for output in out.iter().skip(n_before) {
            if let Output::Epoch(epoch) = output {
                self.counters.judged(epoch.status, epoch.reason);
            }
        }
        if track.incarnation != incarnation && alone {
            // A receiver that was started again: its clock is the only one there is.
            self.event_time = track.last;
        }
        if before.is_none() || silent || track.incarnation != incarnation {
            track.last.map(|last| self.deadlines.insert((last.plus_seconds(stale_s), id)));
        }
    }

    /// What the lane counted.
    pub fn counters(&self) -> &Counters {
        &self.counters
    }

    /// Keys of lines that were passed over, by name.
    pub fn passed_over(&self) -> &BTreeMap<String, u64> {
        &self.decoder.keys.passed_over.0
    }

    /// Keys of lines, and words of a receiver's messages, that took positions away, by name.
    pub fn against(&self) -> &BTreeMap<String, u64> {
        &self.decoder.keys.against.0
    }

    /// Counters of all monitors together.
    pub fn monitor_counters(&self) -> rnp::Counters {
        self.tracks.values().fold(self.past, |sum, track| sum.merged(track.judge.monitor().counters()))
    }

    /// Tracks that are watched.
    pub fn n_tracks(&self) -> usize {
        self.tracks.len()
    }

    /// Largest time of an admitted record or heartbeat.
    pub fn event_time(&self) -> Option<GpsTime> {
        self.event_time
    }
}
