//! The RNP monitor: bounds against RNP and twice RNP, epoch by epoch, as a state machine. No clock and no heap: time comes in.
//!
//! ```text
//! caution      NOT (T_accuracy  <= RNP)      for raise_delay_s      Fu 2014, section 2.7 of the specification
//! warning      NOT (T_integrity <= 2 RNP)    at once
//! end of both  T <= clear_ratio * limit      held for clear_delay_s
//! unavailable  no usable epoch, or none for stale_after_s
//! ```
//!
//! NaN is not within any limit, so it raises; a bound equal to its limit does not. What was not seen never helps an alert to end: an
//! unusable epoch or a gap restarts the wait to clear and lets the wait to raise run on.

use super::latch::{Change, Latch};
pub use super::latch::{Event, Kind};
pub use super::settings::{Chain, Settings, default_stale_after_s};
use crate::quantity::{GpsTime, Metres, OutOfDomain};

/// What the crew sees, least severe first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Alert {
    /// Inside both limits.
    Normal,
    /// The accuracy bound is not within RNP.
    Caution,
    /// The integrity bound is not within twice RNP.
    Warning,
    /// Monitoring is lost.
    Unavailable,
}

impl Alert {
    /// The word of the epoch table.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Normal => "normal",
            Self::Caution => Kind::Caution.word(),
            Self::Warning => Kind::Warning.word(),
            Self::Unavailable => Kind::Unavailable.word(),
        }
    }
}

/// One epoch as the monitor sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Observation {
    /// Time of applicability.
    pub time: GpsTime,
    /// Bound at the accuracy risk.
    pub accuracy: Metres,
    /// Bound at the integrity risk.
    pub integrity: Metres,
    /// RNP value in force; it may change from epoch to epoch.
    pub rnp: Metres,
    /// False when the epoch's status says there is no bound: the sky's "no", or refused input.
    pub usable: bool,
}

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

/// What a step found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// The alert in force after it.
    pub alert: Alert,
    /// Whether the epoch was judged.
    pub acceptance: Acceptance,
    /// Events that ended here.
    pub ended: [Option<Event>; 3],
}

/// What happened so far.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Counters {
    /// Epochs judged.
    pub n_accepted: u64,
    /// Epochs dropped with the time of the one before.
    pub n_duplicate: u64,
    /// Epochs dropped as earlier than the one before.
    pub n_late: u64,
    /// Times the clock was found to be set back.
    pub n_clock_set_back: u64,
    /// Silences longer than the permitted one.
    pub n_gaps: u64,
    /// Judged epochs without a usable bound.
    pub n_unusable: u64,
    /// Usable epochs with a bound or RNP value that is not a number.
    pub n_nan: u64,
    /// Exceedances that ended before the crew was told.
    pub n_withdrawn: u64,
    /// Cautions raised.
    pub n_cautions: u64,
    /// Warnings raised.
    pub n_warnings: u64,
    /// Losses of monitoring.
    pub n_unavailable: u64,
    /// Time under watch, gaps left out \[s\].
    pub watched_s: f64,
}

impl Counters {
    /// Cautions and warnings per hour under watch: under nominal conditions the rate of false alerts, the other side of integrity.
    /// NaN when nothing was watched.
    pub fn alerts_per_hour(&self) -> f64 {
        (self.n_cautions + self.n_warnings) as f64 / self.watched_s * 3600.0
    }

    /// Both together, e.g. of two tracks.
    pub fn merged(&self, other: &Self) -> Self {
        Self {
            n_accepted: self.n_accepted + other.n_accepted,
            n_duplicate: self.n_duplicate + other.n_duplicate,
            n_late: self.n_late + other.n_late,
            n_clock_set_back: self.n_clock_set_back + other.n_clock_set_back,
            n_gaps: self.n_gaps + other.n_gaps,
            n_unusable: self.n_unusable + other.n_unusable,
            n_nan: self.n_nan + other.n_nan,
            n_withdrawn: self.n_withdrawn + other.n_withdrawn,
            n_cautions: self.n_cautions + other.n_cautions,
            n_warnings: self.n_warnings + other.n_warnings,
            n_unavailable: self.n_unavailable + other.n_unavailable,
            watched_s: self.watched_s + other.watched_s,
        }
    }
}

/// The monitor of one aircraft.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Monitor {
    settings: Settings,
    caution: Latch,
    warning: Latch,
    loss: Option<Event>,
    last: Option<GpsTime>,
    /// First of an unbroken run of late epochs.
    late_since: Option<GpsTime>,
    counters: Counters,
}

impl Monitor {
    /// A monitor that has seen nothing yet.
    ///
    /// # Errors
    /// [`OutOfDomain`] from [`Settings::checked`].
    pub fn new(settings: Settings) -> Result<Self, OutOfDomain> {
        let settings = settings.checked()?;
        let latch = |kind, raise_delay_s| Latch::new(kind, raise_delay_s, settings.clear_delay_s, settings.clear_ratio);
        Ok(Self {
            settings,
            caution: latch(Kind::Caution, settings.raise_delay_s),
            warning: latch(Kind::Warning, 0.0),
            loss: None,
            last: None,
            late_since: None,
            counters: Counters::default(),
        })
    }

    /// The alert in force.
    pub fn alert(&self) -> Alert {
        if self.loss.is_some() {
            Alert::Unavailable
        } else if self.warning.raised().is_some() {
            Alert::Warning
        } else if self.caution.raised().is_some() {
            Alert::Caution
        } else {
            Alert::Normal
        }
    }

    /// What happened so far.
    pub fn counters(&self) -> &Counters {
        &self.counters
    }

    /// Events that have not ended.
    pub fn open_events(&self) -> impl Iterator<Item = &Event> {
        [self.caution.raised(), self.warning.raised(), self.loss.as_ref()].into_iter().flatten()
    }

    /// Time passes without an epoch: says when monitoring is lost to silence.
    pub fn tick(&mut self, now: GpsTime) -> Alert {
        if let Some(last) = self.last
            && now.seconds_since(last) > self.settings.stale_after_s
            && self.loss.is_none()
        {
            let noticed = last.plus_seconds(self.settings.stale_after_s);
            self.counters.n_gaps += 1;
            self.lose(last, noticed);
        }
        self.alert()
    }

    /// Judge one epoch.
    pub fn step(&mut self, seen: &Observation) -> Step {
        let mut ended = [None; 3];
        let acceptance = self.accept(seen.time);
        if acceptance == Acceptance::Accepted {
            self.counters.n_accepted += 1;
            if seen.usable {
                ended = self.judge(seen);
            } else {
                self.counters.n_unusable += 1;
                self.lose(seen.time, seen.time);
            }
        }
        Step { alert: self.alert(), acceptance, ended }
    }

    fn accept(&mut self, now: GpsTime) -> Acceptance {
        if let Some(last) = self.last {
            if now == last {
                self.counters.n_duplicate += 1;
                return Acceptance::Duplicate;
            }
            if now < last {
                return self.accept_late(now);
            }
            let silence = now.seconds_since(last);
            self.tick(now);
            if silence <= self.settings.stale_after_s {
                self.counters.watched_s += silence;
            }
        }
        self.late_since = None;
        self.last = Some(now);
        Acceptance::Accepted
    }

    fn accept_late(&mut self, now: GpsTime) -> Acceptance {
        let since = *self.late_since.get_or_insert(now);
        if !(now.seconds_since(since) > self.settings.stale_after_s) {
            self.counters.n_late += 1;
            return Acceptance::Late;
        }
        self.counters.n_clock_set_back += 1;
        self.late_since = None;
        self.last = Some(now);
        self.lose(since, now);
        self.caution.rebase(now);
        self.warning.rebase(now);
        Acceptance::ClockSetBack
    }

    fn lose(&mut self, onset: GpsTime, annunciation: GpsTime) {
        self.caution.forget_calm();
        self.warning.forget_calm();
        if self.loss.is_some() {
            return;
        }
        self.counters.n_unavailable += 1;
        let nothing = Metres::new(f64::NAN);
        let event = Event { kind: Kind::Unavailable, onset, annunciation, clear: None, peak: nothing, limit: nothing, min_margin: nothing };
        self.loss = Some(event);
    }

    fn judge(&mut self, seen: &Observation) -> [Option<Event>; 3] {
        let regained = self.loss.take().map(|event| Event { clear: Some(seen.time), ..event });
        if [seen.accuracy, seen.integrity, seen.rnp].iter().any(|x| x.m().is_nan()) {
            self.counters.n_nan += 1;
        }
        let caution = self.caution.step(seen.time, seen.accuracy, seen.rnp);
        let warning = self.warning.step(seen.time, seen.integrity, Metres::new(2.0 * seen.rnp.m()));
        self.counters.n_cautions += u64::from(caution == Change::Raised);
        self.counters.n_warnings += u64::from(warning == Change::Raised);
        self.counters.n_withdrawn += u64::from(caution == Change::Withdrawn);
        [cleared(caution), cleared(warning), regained]
    }
}

fn cleared(change: Change) -> Option<Event> {
    if let Change::Cleared(event) = change { Some(event) } else { None }
}
