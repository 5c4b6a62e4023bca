//! The RNP monitor: bounds against RNP and twice RNP, epoch by epoch, as a state machine. No clock and no heap: time comes in.
//!
//! ```text
//! caution      NOT (T_accuracy  <= RNP)      after the wait of `Wait`      Fu 2014, section 2.7 of the specification
//! warning      NOT (T_integrity <= 2 RNP)    at once
//! end of both  T <= clear_ratio * limit      for clear_delay_s
//! unavailable  no usable epoch, or none for stale_after_s
//! normal       only from an epoch inside both limits; out of any other state an epoch outside alerts at once
//! ```
//!
//! NaN is not within any limit, so it raises; a bound equal to its limit does not. What was not seen never helps an alert to end: an
//! unusable epoch or a gap restarts the wait to clear and lets the wait to raise run on. Until the first epoch, monitoring is not
//! available either. A second record of one time, or a late one no older than the stale time, counts where it is outside, and a second one that is not usable
//! loses monitoring. Where time stamps crawl, time outside is counted in records.

pub use super::clock::Acceptance;
use super::clock::{Arrival, Clock};
pub use super::counters::Counters;
use super::latch::{Change, Latch, Moment, is_limit};
pub use super::latch::{Event, Kind};
pub use super::settings::{Chain, Settings, default_stale_after_s};
use crate::bound::AlertBound;
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
    /// Monitoring is lost, or has not begun.
    Unavailable,
}

impl Alert {
    /// All, in the order of their codes.
    pub const ALL: [Self; 4] = [Self::Normal, Self::Caution, Self::Warning, Self::Unavailable];

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
#[derive(Debug, Clone, Copy)]
pub struct Observation {
    /// Time of applicability.
    pub time: GpsTime,
    /// Bound at the accuracy risk.
    pub accuracy: AlertBound,
    /// Bound at the integrity risk: [`crate::bound::IntegrityComparison`].
    pub integrity: AlertBound,
    /// RNP value in force; it may change from epoch to epoch. A value outside (0, inf) is no limit, and nothing is within it.
    pub rnp: Metres,
    /// False when the epoch's status says there is no bound: the sky's "no", or refused input.
    pub usable: bool,
}

/// What a step changed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// The alert in force after it.
    pub alert: Alert,
    /// Whether the epoch was judged.
    pub acceptance: Acceptance,
    /// Events whose alert was raised here, also where they ended here.
    pub began: [Option<Event>; 3],
    /// Events that ended here.
    pub ended: [Option<Event>; 3],
}

/// What the passing of time changed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tick {
    /// The alert in force after it.
    pub alert: Alert,
    /// The loss of monitoring that was raised here.
    pub began: Option<Event>,
}

/// The monitor of one aircraft.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Monitor {
    pub(super) settings: Settings,
    pub(super) clock: Clock,
    pub(super) caution: Latch,
    pub(super) warning: Latch,
    pub(super) loss: Option<Event>,
    /// Whether a usable epoch was judged yet.
    pub(super) begun: bool,
    pub(super) counters: Counters,
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
            clock: Clock::new(&settings),
            caution: latch(Kind::Caution, settings.raise_delay_s),
            warning: latch(Kind::Warning, 0.0),
            loss: None,
            begun: false,
            counters: Counters::default(),
        })
    }

    /// The settings it runs with.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The alert in force.
    pub fn alert(&self) -> Alert {
        if self.loss.is_some() || !self.begun {
            Alert::Unavailable
        } else if self.warning.raised().is_some() {
            Alert::Warning
        } else if self.caution.raised().is_some() {
            Alert::Caution
        } else {
            Alert::Normal
        }
    }

    /// Time outside that is left until the caution \[s\]: from the last epoch, which was outside. `None` where no caution is waited for.
    pub fn caution_in_s(&self) -> Option<f64> {
        self.caution.raises_in_s().filter(|_| self.loss.is_none())
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
    ///
    /// `now` is the arrival clock. Silence is measured against the time of the last epoch and, because that may be wrong, also from tick
    /// to tick.
    pub fn tick(&mut self, now: GpsTime) -> Tick {
        self.clock.tick(now);
        let began = self.notice_silence(now);
        Tick { alert: self.alert(), began }
    }

    /// Judge one epoch. One that is dropped for its time counts as one sample period of silence.
    pub fn step(&mut self, seen: &Observation) -> Step {
        match self.clock.arrive(seen.time) {
            Arrival::First => self.accepted(seen, None),
            Arrival::Next { since, silent } => {
                let lost = if silent { self.lose_to_silence(since, seen.time) } else { None };
                if !silent {
                    self.counters.watched_s += seen.time.seconds_since(since);
                }
                self.pass(since, seen.time);
                self.accepted(seen, lost)
            }
            Arrival::Duplicate => {
                self.counters.n_duplicate += 1;
                self.repeated(seen, Acceptance::Duplicate)
            }
            Arrival::Late => {
                self.counters.n_late += 1;
                if self.clock.is_recent(seen.time) {
                    self.repeated(seen, Acceptance::Late)
                } else {
                    self.dropped(Acceptance::Late, seen.time)
                }
            }
            Arrival::SetBack { since } => self.set_back(since, seen.time),
        }
    }

    fn accepted(&mut self, seen: &Observation, lost: Option<Event>) -> Step {
        self.counters.n_accepted += 1;
        let mut step = if seen.usable {
            self.judge(seen)
        } else {
            self.counters.n_unusable += 1;
            let began = self.lose(seen.time, seen.time);
            self.nothing(Acceptance::Accepted, began)
        };
        step.began[2] = step.began[2].or(lost);
        step
    }

    fn dropped(&mut self, acceptance: Acceptance, now: GpsTime) -> Step {
        let began = self.notice_silence(now);
        self.nothing(acceptance, began)
    }

    /// A repeat of the last time, or a record shortly before it. A bound outside contradicts one inside, and is judged; one inside takes nothing back.
    /// A repeat that is not usable contradicts one that is: monitoring is lost at that time.
    fn repeated(&mut self, seen: &Observation, acceptance: Acceptance) -> Step {
        let was_normal = self.alert() == Alert::Normal;
        let mut dropped = self.dropped(acceptance, seen.time);
        if !seen.usable && acceptance == Acceptance::Duplicate {
            let lost = self.lose(seen.time, seen.time);
            dropped = Step { alert: self.alert(), began: [None, None, dropped.began[2].or(lost)], ..dropped };
        }
        if !seen.usable || self.loss.is_some() {
            return dropped;
        }
        // What it contradicts is the last epoch, so an alert begins there and not before.
        let at_last = Observation { time: self.clock.last().unwrap_or(seen.time), ..*seen };
        let [raised_caution, raised_warning] = self.compare(&at_last, None, was_normal, Latch::contradict).map(raised);
        Step { alert: self.alert(), began: [raised_caution, raised_warning, None], ..dropped }
    }

    /// The clock that counts began at `since` and stands at `now`; all that time nothing was judged.
    fn set_back(&mut self, since: GpsTime, now: GpsTime) -> Step {
        self.counters.n_clock_set_back += 1;
        if let Some(loss) = self.loss.as_mut() {
            loss.set_back(since);
        }
        self.caution.set_back(since);
        self.warning.set_back(since);
        let began = self.lose(since, now);
        self.pass(since, now);
        self.nothing(Acceptance::ClockSetBack, began)
    }

    /// The waits to raise run on from `since` to `now`.
    fn pass(&mut self, since: GpsTime, now: GpsTime) {
        let elapsed_ns = now.nanoseconds().saturating_sub(since.nanoseconds()) as f64;
        let lost = self.loss.is_some();
        let arrived_ns = self.clock.arrival_ns(elapsed_ns);
        self.caution.pass(elapsed_ns, arrived_ns, lost);
        self.warning.pass(elapsed_ns, arrived_ns, lost);
    }

    /// A step in which nothing was judged.
    fn nothing(&self, acceptance: Acceptance, lost: Option<Event>) -> Step {
        Step { alert: self.alert(), acceptance, began: [None, None, lost], ended: [None; 3] }
    }

    fn notice_silence(&mut self, now: GpsTime) -> Option<Event> {
        let last = self.clock.last().filter(|_| self.clock.is_silent())?;
        self.lose_to_silence(last, now)
    }

    fn lose_to_silence(&mut self, last: GpsTime, now: GpsTime) -> Option<Event> {
        let lost = self.lose(last, self.clock.silence_noticed(last, now));
        self.counters.n_gaps += u64::from(lost.is_some());
        lost
    }

    /// Monitoring is lost, where it was not before.
    fn lose(&mut self, onset: GpsTime, annunciation: GpsTime) -> Option<Event> {
        self.caution.forget_calm();
        self.warning.forget_calm();
        if self.loss.is_some() {
            return None;
        }
        self.counters.n_unavailable += 1;
        self.loss = Some(Event::begin(Kind::Unavailable, onset, annunciation));
        self.loss
    }

    fn judge(&mut self, seen: &Observation) -> Step {
        let was_normal = self.alert() == Alert::Normal;
        let lost_since = self.loss.map(|event| event.onset);
        let regained = self.loss.take().map(|event| event.ended(seen.time));
        self.begun = true;
        let [caution, warning] = self.compare(seen, lost_since, was_normal, Latch::step);
        let [raised_caution, raised_warning] = [raised(caution), raised(warning)];
        self.counters.n_withdrawn += u64::from(caution == Change::Withdrawn);
        Step {
            alert: self.alert(),
            acceptance: Acceptance::Accepted,
            began: [raised_caution, raised_warning, None],
            ended: [cleared(caution), cleared(warning), regained],
        }
    }

    /// Both bounds against their limits: what became of the caution and of the warning.
    fn compare(&mut self, seen: &Observation, lost_since: Option<GpsTime>, was_normal: bool, latch: Compare) -> [Change; 2] {
        let (accuracy, integrity) = (seen.accuracy.length(), seen.integrity.length());
        self.counters.n_nan += u64::from(accuracy.m().is_nan() || integrity.m().is_nan() || !is_limit(seen.rnp));
        let moment = Moment { now: seen.time, lost_since, at_once: true };
        let warning = latch(&mut self.warning, &moment, integrity, Metres::new(2.0 * seen.rnp.m()));
        // The alert falls to normal only at an epoch inside: where nothing else is in force, an epoch outside is a caution at once.
        let at_once = !was_normal && self.warning.raised().is_none();
        let caution = latch(&mut self.caution, &Moment { at_once, ..moment }, accuracy, seen.rnp);
        self.counters.n_cautions += u64::from(raised(caution).is_some());
        self.counters.n_warnings += u64::from(raised(warning).is_some());
        [caution, warning]
    }
}

type Compare = fn(&mut Latch, &Moment, Metres, Metres) -> Change;

fn raised(change: Change) -> Option<Event> {
    if let Change::Raised(event) = change { Some(event) } else { None }
}

fn cleared(change: Change) -> Option<Event> {
    if let Change::Cleared(event) = change { Some(event) } else { None }
}
