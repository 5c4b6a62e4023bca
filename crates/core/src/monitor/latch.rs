//! One condition with delayed raising, hysteresis and a latched event.

use crate::quantity::{GpsTime, Metres};

/// What an event is about; also the alert while it lasts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// The accuracy bound is not within RNP.
    Caution,
    /// The integrity bound is not within twice RNP.
    Warning,
    /// There is nothing to judge by: monitoring is lost.
    Unavailable,
}

impl Kind {
    /// The word of the event table.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Caution => "caution",
            Self::Warning => "warning",
            Self::Unavailable => "unavailable",
        }
    }
}

/// An alert from onset to clear.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Event {
    /// What it is about.
    pub kind: Kind,
    /// When the condition began.
    pub onset: GpsTime,
    /// When the crew was told.
    pub annunciation: GpsTime,
    /// When it ended; `None` while it lasts.
    pub clear: Option<GpsTime>,
    /// Largest bound meanwhile; NaN when no bound was a number.
    pub peak: Metres,
    /// The limit where the margin was least.
    pub limit: Metres,
    /// Least limit minus bound; NaN when no bound was a number.
    pub min_margin: Metres,
}

/// A bound against a limit, true only when it is a length within it: NaN is outside.
pub(super) fn within(bound: Metres, limit: Metres) -> bool {
    bound.m() >= 0.0 && bound.m() <= limit.m()
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Latch {
    kind: Kind,
    raise_delay_s: f64,
    clear_delay_s: f64,
    clear_ratio: f64,
    /// Present from the first epoch outside.
    event: Option<Event>,
    annunciated: bool,
    calm_since: Option<GpsTime>,
}

/// What a step did to a latch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Change {
    Nothing,
    Raised,
    /// Outside, but back within before the crew was told.
    Withdrawn,
    Cleared(Event),
}

impl Latch {
    pub(super) fn new(kind: Kind, raise_delay_s: f64, clear_delay_s: f64, clear_ratio: f64) -> Self {
        Self { kind, raise_delay_s, clear_delay_s, clear_ratio, event: None, annunciated: false, calm_since: None }
    }

    /// The event the crew has been told of.
    pub(super) fn raised(&self) -> Option<&Event> {
        self.event.as_ref().filter(|_| self.annunciated)
    }

    pub(super) fn step(&mut self, now: GpsTime, bound: Metres, limit: Metres) -> Change {
        if !within(bound, limit) {
            self.calm_since = None;
            return self.outside(now, bound, limit);
        }
        match self.event {
            None => Change::Nothing,
            Some(_) if !self.annunciated => {
                self.event = None;
                Change::Withdrawn
            }
            Some(event) => self.calming(now, bound, limit, event),
        }
    }

    /// Nobody knows where the bound was: waiting to clear begins again, waiting to raise goes on.
    pub(super) fn forget_calm(&mut self) {
        self.calm_since = None;
    }

    /// The clock was set back to `now`: an exceedance still waiting to be told waits anew.
    pub(super) fn rebase(&mut self, now: GpsTime) {
        self.calm_since = None;
        if let Some(event) = self.event.as_mut().filter(|_| !self.annunciated) {
            event.onset = now;
        }
    }

    fn outside(&mut self, now: GpsTime, bound: Metres, limit: Metres) -> Change {
        let event = self.event.get_or_insert(Event {
            kind: self.kind,
            onset: now,
            annunciation: now,
            clear: None,
            peak: Metres::new(f64::NAN),
            limit,
            min_margin: Metres::new(f64::NAN),
        });
        record(event, bound, limit);
        if self.annunciated || !(now.seconds_since(event.onset) >= self.raise_delay_s) {
            return Change::Nothing;
        }
        event.annunciation = now;
        self.annunciated = true;
        Change::Raised
    }

    fn calming(&mut self, now: GpsTime, bound: Metres, limit: Metres, mut event: Event) -> Change {
        record(&mut event, bound, limit);
        self.event = Some(event);
        if !within(bound, Metres::new(self.clear_ratio * limit.m())) {
            self.calm_since = None;
            return Change::Nothing;
        }
        let since = *self.calm_since.get_or_insert(now);
        if !(now.seconds_since(since) >= self.clear_delay_s) {
            return Change::Nothing;
        }
        self.event = None;
        self.annunciated = false;
        self.calm_since = None;
        Change::Cleared(Event { clear: Some(now), ..event })
    }
}

/// `f64::max` and `min` pass over a NaN, so one lost bound does not hide the others.
fn record(event: &mut Event, bound: Metres, limit: Metres) {
    event.peak = Metres::new(event.peak.m().max(bound.m()));
    let margin = limit.m() - bound.m();
    if margin < event.min_margin.m() || event.min_margin.m().is_nan() {
        event.limit = limit;
    }
    event.min_margin = Metres::new(event.min_margin.m().min(margin));
}
