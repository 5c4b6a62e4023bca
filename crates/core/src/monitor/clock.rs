//! Which epochs count, by their time, and for how long none has.

use super::settings::Settings;
use crate::quantity::GpsTime;
use crate::quantity::encoding::{BadBytes, Decoder, Encoder};

/// Whether an epoch was judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Acceptance {
    /// Judged.
    Accepted,
    /// Dropped: the time of the epoch before it.
    Duplicate,
    /// Dropped: earlier than the epoch before it.
    Late,
    /// Not judged: late epochs have come for longer than the permitted silence, so the clock was set back and starts anew here.
    ClockSetBack,
}

/// The time of the records, and the silence beside it.
///
/// Silence is the largest of three times since the last accepted record, each of which is short of the true one or equal to it: by the
/// times of the records themselves, by ticks of the arrival clock, and by dropped records, each of which took one sample period to
/// arrive. So a time stamp that is wild, stuck or runs backwards cannot hide that nothing is judged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Clock {
    stale_after_s: f64,
    sample_period_s: f64,
    last: Option<GpsTime>,
    n_dropped: u32,
    /// Earliest of the late records since the last accepted one.
    late_since: Option<GpsTime>,
    newest_tick: Option<GpsTime>,
    ticked_s: f64,
}

/// What became of the time of one record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Arrival {
    First,
    /// Later than the record before, which was at `since`.
    Next {
        since: GpsTime,
        silent: bool,
    },
    Duplicate,
    Late,
    /// The clock that counts from here on began at `since`.
    SetBack {
        since: GpsTime,
    },
}

/// Share of the sample period below which the step of a time stamp is not the time that passed. Jitter of the sampling stays above it.
/// Provenance: ours.
const CRAWL_SHARE: f64 = 0.5;

/// How long two records took to arrive, at least, that are `stamped` apart by their times and come once a `period`; both in one unit.
pub(super) fn arrival(stamped: f64, period: f64) -> f64 {
    if stamped < CRAWL_SHARE * period { period } else { stamped }
}

impl Clock {
    pub(super) fn new(settings: &Settings) -> Self {
        Self {
            stale_after_s: settings.stale_after_s,
            sample_period_s: settings.chain.sample_period_s,
            last: None,
            n_dropped: 0,
            late_since: None,
            newest_tick: None,
            ticked_s: 0.0,
        }
    }

    /// Time of the last record that counted.
    pub(super) fn last(&self) -> Option<GpsTime> {
        self.last
    }

    pub(super) fn arrive(&mut self, now: GpsTime) -> Arrival {
        let Some(last) = self.last else {
            self.count(now);
            return Arrival::First;
        };
        if now > last {
            self.count(now);
            return Arrival::Next { silent: now.seconds_since(last) > self.stale_after_s, since: last };
        }
        self.n_dropped = self.n_dropped.saturating_add(1);
        if now == last {
            return Arrival::Duplicate;
        }
        self.arrive_late(now)
    }

    /// The arrival clock shows `now`.
    pub(super) fn tick(&mut self, now: GpsTime) {
        if let Some(before) = self.newest_tick {
            // An arrival clock that is set back has not undone the time that passed.
            self.ticked_s += now.seconds_since(before).max(0.0);
        }
        self.newest_tick = Some(now);
    }

    /// How long two records took to arrive \[ns\], at least, that are `stamped_ns` apart by their times. Where those crawl, it is a period.
    pub(super) fn arrival_ns(&self, stamped_ns: f64) -> f64 {
        arrival(stamped_ns, 1e9 * self.sample_period_s)
    }

    /// Whether nothing was accepted for longer than is permitted.
    pub(super) fn is_silent(&self) -> bool {
        let Some(last) = self.last else { return false };
        let by_records = f64::from(self.n_dropped) * self.sample_period_s;
        let by_stamp = self.newest_tick.map_or(0.0, |now| now.seconds_since(last));
        by_records.max(self.ticked_s).max(by_stamp) > self.stale_after_s
    }

    /// Whether a late record is no older, against the last that counted, than monitoring may be silent.
    pub(super) fn is_recent(&self, late: GpsTime) -> bool {
        self.last.is_some_and(|last| last.seconds_since(late) <= self.stale_after_s)
    }

    /// When the silence was noticed, in the time of the records. Where that stands still it is the time at which it does.
    pub(super) fn silence_noticed(&self, last: GpsTime, now: GpsTime) -> GpsTime {
        last.plus_seconds(self.stale_after_s).min(now.max(last))
    }

    pub(super) fn write<const N: usize>(&self, to: &mut Encoder<N>) {
        to.time_or_none(self.last);
        to.u32(self.n_dropped);
        to.time_or_none(self.late_since);
        to.time_or_none(self.newest_tick);
        to.f64(self.ticked_s);
    }

    pub(super) fn read(from: &mut Decoder<'_>, settings: &Settings) -> Result<Self, BadBytes> {
        let clock = Self {
            last: from.time_or_none("last")?,
            n_dropped: from.u32()?,
            late_since: from.time_or_none("late_since")?,
            newest_tick: from.time_or_none("newest_tick")?,
            ticked_s: from.f64()?,
            ..Self::new(settings)
        };
        // Records can be dropped only for the time of one before them; a late one is earlier than that.
        let dropped = clock.n_dropped == 0 || clock.last.is_some();
        let late = clock.late_since.is_none_or(|since| clock.n_dropped > 0 && clock.last.is_some_and(|last| since < last));
        if !(dropped && late && clock.ticked_s >= 0.0 && clock.ticked_s.is_finite()) {
            return Err(BadBytes::Value("clock"));
        }
        Ok(clock)
    }

    fn arrive_late(&mut self, now: GpsTime) -> Arrival {
        // Time that stands or runs backwards never gets away from its earliest record, so it is not followed.
        let since = self.late_since.map_or(now, |since| since.min(now));
        self.late_since = Some(since);
        if !(now.seconds_since(since) > self.stale_after_s) {
            return Arrival::Late;
        }
        self.count(now);
        Arrival::SetBack { since }
    }

    fn count(&mut self, now: GpsTime) {
        self.last = Some(now);
        self.n_dropped = 0;
        self.late_since = None;
        self.newest_tick = None;
        self.ticked_s = 0.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::monitor::rnp::Chain;

    fn settings() -> Settings {
        let chain = Chain {
            sample_period_s: 2.0,
            sensor_latency_s: 0.0,
            filter_s: 0.0,
            computing_s: 0.0,
            display_s: 0.0,
            time_to_alert_s: f64::INFINITY,
        };
        Settings { chain, raise_delay_s: 0.0, clear_delay_s: 10.0, clear_ratio: 0.95, stale_after_s: 5.0 }
    }

    fn at(second: f64) -> GpsTime {
        GpsTime::default().plus_seconds(second)
    }

    #[test]
    fn stamps_that_crawl_take_a_period_and_others_their_own_time() {
        let clock = Clock::new(&settings());
        // Half of two seconds is no crawl; less is.
        for (stamped_ns, arrived_ns) in [(1e9, 1e9), (0.999e9, 2e9), (1.0, 2e9), (3e9, 3e9)] {
            assert_eq!(clock.arrival_ns(stamped_ns), arrived_ns);
        }
    }

    #[test]
    fn only_what_a_clock_can_be_is_read() {
        let read = |last: Option<f64>, n_dropped: u32, late: Option<f64>, ticked_s: f64| {
            // A version, three times with flags, a count, a number and a checksum.
            let mut to = Encoder::<44>::new(1);
            to.time_or_none(last.map(at));
            to.u32(n_dropped);
            to.time_or_none(late.map(at));
            to.time_or_none(None);
            to.f64(ticked_s);
            Clock::read(&mut Decoder::new(&to.finish(), 44, 1).unwrap(), &settings()).is_ok()
        };
        assert!(read(None, 0, None, 0.0) && read(Some(10.0), 0, None, 1.0) && read(Some(10.0), 3, Some(4.0), 1.0));
        // Nothing is dropped or late before a first record; what is late was dropped, and is earlier than the last record.
        assert!(!read(None, 1, None, 0.0) && !read(None, 1, Some(4.0), 0.0) && !read(Some(10.0), 0, Some(4.0), 0.0));
        assert!(!read(Some(10.0), 3, Some(10.0), 0.0) && !read(Some(10.0), 3, Some(11.0), 0.0));
        for ticked_s in [-1.0, f64::NAN, f64::INFINITY] {
            assert!(!read(Some(10.0), 0, None, ticked_s));
        }
    }
}
