//! One condition with delayed raising, hysteresis and a latched event.

use super::wait::Wait;
use crate::quantity::encoding::{BadBytes, Decoder, Encoder};
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
    /// When the alert was raised.
    pub annunciation: GpsTime,
    /// When it ended; `None` while it lasts.
    pub clear: Option<GpsTime>,
    /// Largest bound meanwhile; NaN when no bound was a number.
    pub peak: Metres,
    /// The limit where the margin was least; NaN where no limit was a length.
    pub limit: Metres,
    /// Least limit minus bound; NaN when no bound or no limit was a number.
    pub min_margin: Metres,
}

impl Event {
    pub(super) fn begin(kind: Kind, onset: GpsTime, annunciation: GpsTime) -> Self {
        let nothing = Metres::new(f64::NAN);
        Self { kind, onset, annunciation, clear: None, peak: nothing, limit: nothing, min_margin: nothing }
    }

    /// The event as it ended; an alert does not end before it was raised.
    pub(super) fn ended(self, clear: GpsTime) -> Self {
        Self { clear: Some(clear.max(self.annunciation)), ..self }
    }

    /// Bytes of an event that lasts, or of none.
    pub(super) const BYTES: usize = 1 + 2 * 8 + 3 * 8;

    /// An event that lasts, or none; its kind is that of who has it.
    pub(super) fn write<const N: usize>(event: Option<&Self>, to: &mut Encoder<N>) {
        to.flag(event.is_some());
        let none = Self::begin(Kind::Unavailable, GpsTime::default(), GpsTime::default());
        let event = event.unwrap_or(&none);
        to.time(event.onset);
        to.time(event.annunciation);
        [event.peak, event.limit, event.min_margin].into_iter().for_each(|length| to.metres(length));
    }

    pub(super) fn read(from: &mut Decoder<'_>, kind: Kind) -> Result<Option<Self>, BadBytes> {
        let present = from.flag("event")?;
        let (onset, annunciation) = (from.time()?, from.time()?);
        let event =
            Self { kind, onset, annunciation, clear: None, peak: from.metres()?, limit: from.metres()?, min_margin: from.metres()? };
        if event.onset > event.annunciation || !(event.limit.m().is_nan() || is_limit(event.limit)) {
            return Err(BadBytes::Value("event"));
        }
        Ok(present.then_some(event))
    }

    /// The clock was set back to `since`: in the time that counts now, what began later has begun there.
    pub(super) fn set_back(&mut self, since: GpsTime) {
        self.onset = self.onset.min(since);
        self.annunciation = self.annunciation.min(since);
    }

    /// `f64::max` and `min` pass over a NaN, so one lost bound does not hide the others.
    fn record(&mut self, bound: Metres, limit: Metres) {
        self.peak = Metres::new(self.peak.m().max(bound.m()));
        if !is_limit(limit) {
            return;
        }
        let margin_m = limit.m() - bound.m();
        if margin_m < self.min_margin.m() || self.min_margin.m().is_nan() {
            self.limit = limit;
        }
        self.min_margin = Metres::new(self.min_margin.m().min(margin_m));
    }
}

/// A limit is a positive length. Infinity would hold any bound, so it limits nothing.
pub(super) fn is_limit(limit: Metres) -> bool {
    limit.m() > 0.0 && limit.m().is_finite()
}

/// A bound against a limit, true only when both are lengths: NaN is outside.
pub(super) fn within(bound: Metres, limit: Metres) -> bool {
    is_limit(limit) && bound.m() >= 0.0 && bound.m() <= limit.m()
}

/// The time of an epoch, and what came before it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Moment {
    pub(super) now: GpsTime,
    /// Since when nothing was known to be inside, where monitoring was lost until now.
    pub(super) lost_since: Option<GpsTime>,
    /// Nothing is waited for.
    pub(super) at_once: bool,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Latch {
    kind: Kind,
    wait: Wait,
    clear_delay_s: f64,
    clear_ratio: f64,
    /// Whether the last epoch was inside.
    inside: bool,
    /// Present from the first epoch outside until the wait is empty again or the alert has ended.
    event: Option<Event>,
    annunciated: bool,
    calm_since: Option<GpsTime>,
}

/// What a step did to a latch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Change {
    Nothing,
    Raised(Event),
    /// Outside, but inside for long enough before the alert was raised.
    Withdrawn,
    Cleared(Event),
}

impl Latch {
    pub(super) fn new(kind: Kind, raise_delay_s: f64, clear_delay_s: f64, clear_ratio: f64) -> Self {
        let wait = Wait::new(raise_delay_s, clear_delay_s);
        Self { kind, wait, clear_delay_s, clear_ratio, inside: false, event: None, annunciated: false, calm_since: None }
    }

    /// The event of the alert in force.
    pub(super) fn raised(&self) -> Option<&Event> {
        self.event.as_ref().filter(|_| self.annunciated)
    }

    /// Time outside that is left until the alert, where the last epoch was outside and no alert is in force yet \[s\].
    pub(super) fn raises_in_s(&self) -> Option<f64> {
        (self.event.is_some() && !self.annunciated && !self.inside).then(|| self.wait.left_s())
    }

    /// Time passed since the last epoch; `lost` where nothing was known of the bound meanwhile. Time outside is that of arrival, which is
    /// never less than that of the stamps; time inside is that of the stamps.
    pub(super) fn pass(&mut self, stamped_ns: f64, arrived_ns: f64, lost: bool) {
        let known_inside = self.inside && !lost;
        self.wait.pass(if known_inside { stamped_ns } else { arrived_ns }, known_inside);
    }

    /// A second record of the same time: outside it counts, inside it proves nothing.
    pub(super) fn contradict(&mut self, moment: &Moment, bound: Metres, limit: Metres) -> Change {
        if within(bound, limit) { Change::Nothing } else { self.step(moment, bound, limit) }
    }

    pub(super) fn step(&mut self, moment: &Moment, bound: Metres, limit: Metres) -> Change {
        self.inside = within(bound, limit);
        if !self.inside {
            self.calm_since = None;
            return self.outside(moment, bound, limit);
        }
        match self.event {
            Some(event) if self.annunciated => self.calming(moment.now, bound, limit, event),
            Some(_) if self.wait.is_empty() => {
                self.event = None;
                Change::Withdrawn
            }
            _ => Change::Nothing,
        }
    }

    /// Nobody knows where the bound was: waiting to clear begins again, waiting to raise goes on.
    pub(super) fn forget_calm(&mut self) {
        self.calm_since = None;
    }

    pub(super) fn set_back(&mut self, since: GpsTime) {
        self.calm_since = None;
        if let Some(event) = self.event.as_mut() {
            event.set_back(since);
        }
    }

    /// Bytes of a latch.
    pub(super) const BYTES: usize = 9 + 1 + Event::BYTES + 1 + 9;

    pub(super) fn write<const N: usize>(&self, to: &mut Encoder<N>) {
        self.wait.write(to);
        to.flag(self.inside);
        Event::write(self.event.as_ref(), to);
        to.flag(self.annunciated);
        to.time_or_none(self.calm_since);
    }

    /// Into a latch as new, which has the settings.
    pub(super) fn read(self, from: &mut Decoder<'_>) -> Result<Self, BadBytes> {
        let latch = Self {
            wait: self.wait.read(from)?,
            inside: from.flag("inside")?,
            event: Event::read(from, self.kind)?,
            annunciated: from.flag("annunciated")?,
            calm_since: from.time_or_none("calm_since")?,
            ..self
        };
        // An alert has its event, and only an alert waits for calm, inside.
        if (latch.annunciated && latch.event.is_none()) || (latch.calm_since.is_some() && !(latch.annunciated && latch.inside)) {
            return Err(BadBytes::Value("latch"));
        }
        Ok(latch)
    }

    fn outside(&mut self, moment: &Moment, bound: Metres, limit: Metres) -> Change {
        let onset = moment.lost_since.unwrap_or(moment.now);
        let event = self.event.get_or_insert(Event::begin(self.kind, onset, moment.now));
        event.record(bound, limit);
        if self.annunciated || !(moment.at_once || self.wait.is_over()) {
            return Change::Nothing;
        }
        event.annunciation = moment.now;
        self.annunciated = true;
        Change::Raised(*event)
    }

    fn calming(&mut self, now: GpsTime, bound: Metres, limit: Metres, mut event: Event) -> Change {
        event.record(bound, limit);
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
        self.wait.restart();
        Change::Cleared(event.ended(now))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_event_keeps_its_peak_and_the_limit_of_its_least_margin() {
        let mut event = Event::begin(Kind::Caution, GpsTime::default(), GpsTime::default());
        let m = Metres::new;
        for (bound, limit) in [(700.0, 555.6), (2000.0, 1852.0), (1900.0, 1852.0), (f64::NAN, 555.6), (900.0, f64::NAN)] {
            event.record(m(bound), m(limit));
        }
        // Margins -144.4, -148 and -48 m: the second is the least, and its limit is the one that stands.
        assert_eq!((event.peak.m(), event.limit.m(), event.min_margin.m()), (2000.0, 1852.0, -148.0));
        event.record(m(800.0), m(555.6));
        assert_eq!((event.peak.m(), event.limit.m()), (2000.0, 555.6));
        assert!((event.min_margin.m() + 244.4).abs() < 1e-9);
    }
}
