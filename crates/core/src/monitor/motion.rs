//! Can a position have been flown to? What is judged of one report from the last one alone; of a whole recording more can be said.
//!
//! A position report does not show whether it is true: a decoder or a receiver repeats the last position when none arrives, and a falsified
//! receiver jumps. Both leave a track that no bound of the navigation error covers.

use super::ahead::Ahead;
use super::clock::arrival;
use super::neighbours::{Height, Place, east_north_m, one_height, one_place};
use super::way::Way;
use crate::frame::{EcefPosition, Geodetic, LatLon, ecef_from_geodetic};
use crate::quantity::{GpsTime, Metres, OutOfDomain, Radians, Reason};
use crate::special::float::hypot;

/// What an aircraft can do. Provenance: ours; every figure is a setting.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Fastest speed over the ground where none is reported \[m/s\].
    pub max_speed_mps: f64,
    /// Factor on the reported speed.
    pub speed_factor: f64,
    /// Added to it \[m/s\]: rounding, acceleration since the report.
    pub speed_margin_mps: f64,
    /// How much older than its time stamp a position may be \[s\].
    pub latency_s: f64,
    /// The same where the recording says when a position was valid \[s\]: what such times are wrong by.
    pub fix_latency_s: f64,
    /// Distance that is never called a jump \[m\]: the noise of a position.
    pub noise_m: f64,
    /// Reported speed from which an unchanged position counts as held \[m/s\]; infinite for a receiver that is known to stand.
    pub moving_mps: f64,
    /// Age from which a held position is no longer a position \[s\].
    pub stale_after_s: f64,
    /// How long after a jump positions are not believed \[s\].
    pub settle_s: f64,
    /// Time between two reports as it is declared \[s\]; 0 where nobody declares it.
    pub period_s: f64,
}

/// One recorded position: `speed` is the reported speed over the ground, NaN where none is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Report {
    /// When.
    pub time: GpsTime,
    /// When the position was valid, where the recording says so.
    pub fixed: Option<GpsTime>,
    /// Latitude \[rad\].
    pub lat_rad: f64,
    /// Longitude \[rad\].
    pub lon_rad: f64,
    /// Reported speed over the ground \[m/s\].
    pub speed_mps: f64,
    /// The larger horizontal variance that is stated, NaN where none is \[m²\].
    pub variance_m2: f64,
    /// The height, where one is stated.
    pub height: Option<Height>,
}

impl Report {
    /// The age that the recording states of the position \[s\]; 0 where it states none.
    pub fn age_s(&self) -> f64 {
        self.fixed.map_or(0.0, |fixed| self.time.seconds_since(fixed))
    }

    /// A finding, with what the stated age adds: a position that is said to be old is as one that is held as long.
    pub fn with_age(&self, finding: Finding, limits: &Limits) -> Finding {
        let age_s = self.age_s();
        match finding {
            Finding::Plausible | Finding::Repeated if age_s > limits.stale_after_s => Finding::Stale,
            Finding::Plausible if age_s > limits.fix_latency_s => Finding::Repeated,
            other => other,
        }
    }
}

/// What was found about one position.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Finding {
    /// Nothing against it.
    Plausible,
    /// The position of an earlier report, repeated, not yet stale.
    Repeated,
    /// The same, too old.
    Stale,
    /// Reachable only from a position that was older than a stale one.
    Late,
    /// Not reachable from the position before.
    Jump,
    /// Within the settling time after a jump.
    Unsettled,
    /// Further on than the reported speeds lead.
    Ahead,
}

impl Finding {
    /// A finding, with whether the position stands falsely, or is ahead, by the speeds reported on the way to it.
    #[must_use]
    pub const fn with_way(self, stands: bool, ahead: bool) -> Self {
        match self {
            Self::Jump => self,
            _ if stands => Self::Stale,
            _ if ahead => Self::Ahead,
            _ => self,
        }
    }

    /// A finding, where a jump may not have settled.
    #[must_use]
    pub const fn settling(self, settling: bool) -> Self {
        match self {
            Self::Plausible | Self::Repeated | Self::Late if settling => Self::Unsettled,
            _ => self,
        }
    }

    /// Why the position is not to be believed; `None` where nothing is against it.
    pub const fn reason(self) -> Option<Reason> {
        match self {
            Self::Plausible => None,
            Self::Repeated => Some(Reason::PositionHeld),
            Self::Stale => Some(Reason::PositionStale),
            Self::Late => Some(Reason::PositionLate),
            Self::Jump => Some(Reason::PositionJump),
            Self::Unsettled => Some(Reason::PositionNotSettled),
            Self::Ahead => Some(Reason::PositionAhead),
        }
    }
}

/// Speed up to which an aircraft may stand: noise of a reported speed. \[m/s\] Provenance: ours.
const STANDS_MPS: f64 = 2.0;

/// Fastest braking of an aircraft, on a runway or in the air \[m/s2\]. Provenance: ours.
const BRAKING_MPS2: f64 = 10.0;

/// How far a position that stands may be from where it began to: noise of decimetres, and rounding \[m\]. An aircraft whose speed counts as
/// moving needs 11 m to brake. Provenance: ours.
const ABOUT_THE_FALL_M: f64 = 5.0;

/// Share of the declared period below which the stamps of a track that has moved crawl: 10 ms of 1 s. Provenance: ours.
const FROZEN_SHARE: f64 = 0.01;

/// Where and when a reported speed fell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fall {
    /// When.
    pub time: GpsTime,
    /// Latitude \[rad\].
    pub lat_rad: f64,
    /// Longitude \[rad\].
    pub lon_rad: f64,
    /// The speed before it is one at which an aircraft moves for certain.
    pub from_moving: bool,
}

impl Fall {
    const fn at(report: &Report, from_moving: bool) -> Self {
        Self { time: report.time, lat_rad: report.lat_rad, lon_rad: report.lon_rad, from_moving }
    }

    /// Whether a report is still where it was.
    fn holds(&self, report: &Report, unchanged: bool) -> bool {
        let [east, north] = east_north_m([self.lat_rad, self.lon_rad], [report.lat_rad, report.lon_rad]);
        unchanged || (self.from_moving && hypot(east, north) <= ABOUT_THE_FALL_M)
    }
}

/// After a gap longer than this an aircraft may have flown on and come back \[s\]. Provenance: ours.
const RETURNS_S: f64 = 60.0;

/// The way on which an aircraft can lose its speed, from the last report where all of it had been flown. Speed is lost only over a way:
///
/// ```text
/// debt = v_0^2 / 2a - |place - place_0| - v^2 / 2a
/// ```
///
/// A position that owes more than its noise for longer than a stale one may last did not stop there, however slowly its speed fell and wherever
/// it creeps since.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Owed {
    /// Latitude of that report \[rad\].
    pub lat_rad: f64,
    /// Longitude \[rad\].
    pub lon_rad: f64,
    /// Way to brake on from its speed \[m\].
    pub way_m: f64,
    /// Since when more than the noise is owed.
    pub since: Option<GpsTime>,
}

impl Owed {
    const fn from(report: &Report, way_m: f64) -> Self {
        Self { lat_rad: report.lat_rad, lon_rad: report.lon_rad, way_m, since: None }
    }

    /// After the next report of a speed; `None` of the debt before begins with it.
    fn after(before: Option<Self>, report: &Report, noise_m: f64) -> Self {
        let way_m = report.speed_mps * report.speed_mps / (2.0 * BRAKING_MPS2);
        let Some(before) = before else { return Self::from(report, way_m) };
        let [east, north] = east_north_m([before.lat_rad, before.lon_rad], [report.lat_rad, report.lon_rad]);
        let debt_m = before.way_m - hypot(east, north) - way_m;
        if debt_m <= 0.0 {
            return Self::from(report, way_m);
        }
        Self { since: (debt_m > noise_m).then(|| before.since.unwrap_or(report.time)), ..before }
    }
}

/// What an aircraft says of its own speed, above all while its position stays the same.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gone {
    /// The last report.
    pub seen: Option<GpsTime>,
    /// The way by the speeds reported since the position changed \[m\].
    pub way_m: f64,
    /// How long the reports since the position changed say that the aircraft stood \[s\].
    pub stood_s: f64,
    /// The least speed that braking leaves of those reported before \[m/s\]; NaN before the first.
    pub braked_mps: f64,
    /// Where the reported speed fell faster than an aircraft brakes, until the position has left: it is no evidence that the aircraft stands.
    pub fell: Option<Fall>,
    /// Way to brake on that was not flown.
    pub owed: Option<Owed>,
    /// The position has changed.
    pub moved: bool,
    /// How much longer than by their times the reports of a position took to arrive, at least \[s\].
    pub crawled_s: f64,
}

impl Default for Gone {
    fn default() -> Self {
        Self { seen: None, way_m: 0.0, stood_s: 0.0, braked_mps: f64::NAN, fell: None, owed: None, moved: false, crawled_s: 0.0 }
    }
}

impl Gone {
    /// See the next report. Of a gap longer than the latency nobody knows how long the aircraft moved, or stood.
    pub fn step(&mut self, report: &Report, unchanged: bool, limits: &Limits) {
        let elapsed_s = self.seen.map_or(0.0, |seen| report.time.seconds_since(seen)).max(0.0);
        let passed_s = elapsed_s.min(limits.latency_s);
        let speed_mps = report.speed_mps;
        self.moved |= self.seen.is_some() && !unchanged;
        // Once it has moved, a position may be newer once in many reports: only what no source samples so fast crawls.
        let crawls = !self.moved || elapsed_s < FROZEN_SHARE * limits.period_s;
        let waited_s = if crawls { arrival(elapsed_s, limits.period_s) - elapsed_s } else { 0.0 };
        self.crawled_s = if self.seen.is_some() && unchanged { self.crawled_s + waited_s } else { 0.0 };
        let (way_m, stood_s) = if unchanged { (self.way_m, self.stood_s) } else { (0.0, 0.0) };
        self.way_m = way_m + if unchanged && speed_mps > STANDS_MPS { speed_mps * passed_s } else { 0.0 };
        self.stood_s = stood_s + if unchanged && speed_mps <= STANDS_MPS { passed_s } else { 0.0 };
        let left_mps = self.braked_mps - BRAKING_MPS2 * elapsed_s;
        // A position that does not change leaves no way to brake on, however long that took.
        let braking_m = (self.braked_mps * self.braked_mps - speed_mps * speed_mps) / (2.0 * BRAKING_MPS2);
        let falls = speed_mps + STANDS_MPS < left_mps || (unchanged && braking_m > limits.noise_m);
        let unmoved = self.fell.filter(|fall| fall.holds(report, unchanged));
        self.fell = unmoved.or_else(|| falls.then(|| Fall::at(report, self.braked_mps > limits.moving_mps)));
        // f64::max prefers a number to a NaN.
        self.braked_mps = speed_mps.max(left_mps);
        self.owed = self.owed.filter(|_| elapsed_s <= RETURNS_S);
        // A report without a speed decides nothing.
        if !speed_mps.is_nan() {
            self.owed = Some(Owed::after(self.owed, report, limits.noise_m));
        }
        self.seen = Some(report.time);
    }

    /// For how long a position stands where no aircraft with its speeds could have stopped \[s\]: since a speed fell that none loses so fast, though
    /// the position changes, or since it owes the way to brake on. None where it may be one, or where a receiver is known to stand.
    pub fn stands_falsely(&self, report: &Report, limits: &Limits) -> Option<f64> {
        let fell = self.fell.filter(|fall| fall.from_moving).map(|fall| fall.time);
        let owes = self.owed.filter(|_| limits.moving_mps.is_finite()).and_then(|owed| owed.since);
        let lasting = |since: &GpsTime| !within(report.time, *since, limits.stale_after_s);
        let since = [fell, owes].into_iter().flatten().filter(lasting).min()?;
        Some(report.time.seconds_since(since))
    }
}

/// An unchanged position is held where the aircraft says it moves; a parked one repeats itself rightly. A slow one's rounded position may
/// repeat, until the aircraft would be elsewhere by its own speeds. Where no speed is reported, or one that fell faster than an aircraft
/// brakes, a repeat may be such a one, until it lasts. A position may stand under time stamps that crawl: it lasts as long as its reports took
/// to arrive.
pub fn repeated(report: &Report, since: GpsTime, gone: &Gone, limits: &Limits) -> Finding {
    let silent = report.speed_mps.is_nan() || gone.fell.is_some();
    let may_move = if silent { limits.moving_mps.is_finite() } else { report.speed_mps > limits.moving_mps };
    if limits.moving_mps.is_finite() && gone.way_m > limits.noise_m + limits.latency_s * report.speed_mps.max(0.0) {
        return Finding::Stale;
    }
    match (may_move, within(report.time.plus_seconds(gone.crawled_s), since, limits.stale_after_s)) {
        (true, false) => Finding::Stale,
        (true, true) if !silent => Finding::Repeated,
        _ => Finding::Plausible,
    }
}

/// Whether no more than `limit_s` has passed; in whole nanoseconds, since 30 s as 3e10 * 1e-9 is more than 30.
pub fn within(now: GpsTime, earlier: GpsTime, limit_s: f64) -> bool {
    // The cast saturates, so an endless limit is one.
    now.nanoseconds() - earlier.nanoseconds() <= (limit_s * 1e9) as i64
}

/// What lies between two reports.
#[derive(Debug, Clone, Copy)]
pub struct Between {
    /// Time between the positions \[s\].
    pub elapsed_s: f64,
    /// How much of it the reports between them say that the aircraft stood \[s\].
    pub stood_s: f64,
    /// How much longer the aircraft may have flown \[s\].
    pub latency_s: f64,
    /// The recording says when both positions were valid.
    pub dated: bool,
    /// The fastest that counts \[m/s\].
    pub speed_mps: f64,
}

impl Between {
    /// Of two reports of one track, with `stood_s` by those between them; a position that is dated is as old as its date says.
    pub fn new(from: &Report, to: &Report, stood_s: f64, limits: &Limits) -> Self {
        // f64::max prefers a number to a NaN.
        let reported = from.speed_mps.max(to.speed_mps);
        let speed_mps = if reported.is_nan() {
            limits.max_speed_mps
        } else {
            (limits.speed_factor * reported + limits.speed_margin_mps).min(limits.max_speed_mps)
        };
        match from.fixed.zip(to.fixed) {
            // An older position may arrive after a newer one.
            Some((a, b)) => {
                Self { elapsed_s: b.seconds_since(a).abs(), stood_s: 0.0, latency_s: limits.fix_latency_s, dated: true, speed_mps }
            }
            None => Self { elapsed_s: to.time.seconds_since(from.time), stood_s, latency_s: limits.latency_s, dated: false, speed_mps },
        }
    }

    /// How far an aircraft may be from its last position \[m\]: while it said that it stood it went nowhere.
    pub fn reach_m(&self, latency_s: f64, limits: &Limits) -> f64 {
        self.speed_mps * (self.elapsed_s - self.stood_s + latency_s) + limits.noise_m
    }
}

/// The place of a report, at sea level.
///
/// # Errors
/// [`OutOfDomain`] for a position that is no place on the Earth.
pub fn sea_level(report: &Report) -> Result<EcefPosition, OutOfDomain> {
    let point = LatLon::new(Radians::new(report.lat_rad), Radians::new(report.lon_rad))?;
    Ok(ecef_from_geodetic(&Geodetic { point, height: Metres::new(0.0) }))
}

/// The last speed that was reported. It stands in for the latency where reports state none: a field that is empty now and then must not
/// turn off what is judged by speeds.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LastSpeed {
    /// When it was reported, and the speed \[m/s\].
    pub reported: Option<(GpsTime, f64)>,
}

impl LastSpeed {
    /// The next report, with the speed that counts for it.
    pub fn standing_in(&mut self, report: &Report, limits: &Limits) -> Report {
        if !report.speed_mps.is_nan() {
            self.reported = Some((report.time, report.speed_mps));
            return *report;
        }
        let last = self.reported.filter(|(time, _)| within(report.time, *time, limits.latency_s));
        Report { speed_mps: last.map_or(f64::NAN, |(_, speed_mps)| speed_mps), ..*report }
    }
}

/// The motion of a track whose reports arrive: the last different position, an earlier one, and the last jump.
///
/// The same rules as for a recording, as far as one report and earlier ones decide them. What needs later reports, or the speeds of
/// the whole track, is not seen: a jump of a track that reports no speed is judged by the fastest speed of all.
///
/// Steps of which each alone is explained by latency are judged together: from a position up to `latency_s` before, no aircraft is further
/// away than a position that is not yet stale explains. So time stamps that crawl do not make every step a possible one.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Motion {
    /// The last different position.
    pub last: Option<Report>,
    /// An earlier position, with the fastest speed reported since.
    pub anchor: Option<Report>,
    /// When a position jumped last, or a time was disputed.
    pub jumped: Option<GpsTime>,
    /// What it said of its own speed since.
    pub gone: Gone,
    /// The height that the last report stated.
    pub height: Option<Height>,
    /// The way that it made good.
    pub way: Way,
    /// The way that it may have made good at most.
    pub ahead: Ahead,
    /// The last speed that it reported.
    pub speed: LastSpeed,
}

impl Motion {
    /// What is found about the next report; one of the past says nothing.
    ///
    /// # Errors
    /// [`OutOfDomain`] for a position that is no place on the Earth.
    pub fn see(&mut self, reported: &Report, limits: &Limits) -> Result<Finding, OutOfDomain> {
        let here = sea_level(reported)?;
        let report = &self.speed.standing_in(reported, limits);
        let Some((from, seen)) = self.last.zip(self.gone.seen) else {
            (self.last, self.anchor, self.height) = (Some(*report), Some(*report), report.height);
            self.way.is_behind(report, limits)?;
            self.ahead.is_ahead(report, &here, false, limits);
            self.gone.step(report, false, limits);
            return Ok(report.with_age(Finding::Plausible, limits));
        };
        if report.time < seen {
            return Ok(Finding::Plausible);
        }
        let finding = if report.time == seen {
            // No vehicle is in two places, and nobody knows which of them is right.
            let heights = self.height.as_ref().zip(report.height.as_ref());
            let one = one_place(&place(&from), &place(report)) && heights.is_none_or(|(a, b)| one_height(a, b, limits.noise_m));
            if one { Finding::Plausible } else { Finding::Jump }
        } else {
            self.height = report.height;
            let unchanged = report.lat_rad == from.lat_rad && report.lon_rad == from.lon_rad;
            let stood_s = self.gone.stood_s;
            self.gone.step(report, unchanged, limits);
            let step = if unchanged {
                repeated(report, from.time, &self.gone, limits)
            } else {
                self.stepped(&from, report, &here, stood_s, limits)?
            };
            let behind = self.way.is_behind(report, limits)?.is_some();
            let ahead = self.ahead.is_ahead(report, &here, unchanged, limits);
            let stands = behind || self.gone.stands_falsely(report, limits).is_some();
            report.with_age(step.with_way(stands, ahead), limits)
        };
        if finding == Finding::Jump {
            self.dispute(report.time);
            // What comes after a jump is judged from there.
            self.ahead = Ahead::default();
        }
        let settling = self.jumped.is_some_and(|jump| within(report.time, jump, limits.settle_s));
        Ok(finding.settling(settling))
    }

    /// What the source says of this time contradicts itself: nothing is believed until it has settled.
    pub const fn dispute(&mut self, time: GpsTime) {
        self.jumped = Some(time);
    }

    /// The step to another position, from the last one and from the anchor, after `stood_s` of standing by the reports between.
    fn stepped(
        &mut self,
        from: &Report,
        report: &Report,
        here: &EcefPosition,
        stood_s: f64,
        limits: &Limits,
    ) -> Result<Finding, OutOfDomain> {
        self.last = Some(*report);
        let step = reached(from, report, here, stood_s, limits)?;
        // f64::max prefers a number to a NaN.
        let anchor = self.anchor.map(|anchor| Report { speed_mps: anchor.speed_mps.max(report.speed_mps), ..anchor });
        let kept = anchor.filter(|anchor| step == Finding::Plausible && within(report.time, anchor.time, limits.latency_s));
        let whole = kept.map_or(Ok(step), |anchor| reached(&anchor, report, here, stood_s, limits))?;
        self.anchor = Some(kept.filter(|_| whole != Finding::Jump).unwrap_or(*report));
        Ok(whole)
    }
}

/// Whether a position can have been flown to from another one.
fn reached(from: &Report, to: &Report, here: &EcefPosition, stood_s: f64, limits: &Limits) -> Result<Finding, OutOfDomain> {
    let (between, way_m) = (Between::new(from, to, stood_s, limits), here.minus(&sea_level(from)?).vector().norm());
    // Nothing in a track without speeds tells an old position from a wrong one.
    let silent = from.speed_mps.is_nan() && to.speed_mps.is_nan();
    let latency_s = if silent { limits.stale_after_s } else { between.latency_s };
    Ok(if !(way_m <= between.reach_m(latency_s, limits)) {
        Finding::Jump
    } else if way_m <= between.reach_m(limits.stale_after_s, limits) {
        Finding::Plausible
    } else {
        Finding::Late
    })
}

fn place(report: &Report) -> Place {
    Place { time: report.time, lat_rad: report.lat_rad, lon_rad: report.lon_rad, variance_m2: report.variance_m2 }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// As tables and live have them.
    pub(in crate::monitor) const LIMITS: Limits = Limits {
        max_speed_mps: 400.0,
        speed_factor: 1.25,
        speed_margin_mps: 25.0,
        latency_s: 10.0,
        fix_latency_s: 1.0,
        noise_m: 100.0,
        moving_mps: 15.0,
        stale_after_s: 2.0,
        settle_s: 30.0,
        period_s: 0.0,
    };

    fn report(seconds: i64, north_m: f64, speed_mps: f64) -> Report {
        let time = GpsTime::from_nanoseconds(seconds * 1_000_000_000);
        Report { time, fixed: None, lat_rad: 0.8 + north_m / 6.37e6, lon_rad: 0.1, speed_mps, variance_m2: 4.0, height: None }
    }

    fn findings(reports: &[Report], limits: &Limits) -> Vec<Finding> {
        let mut motion = Motion::default();
        reports.iter().map(|each| motion.see(each, limits).unwrap()).collect()
    }

    /// A latency of such times of 1 s, stale after 2 s.
    #[test]
    fn an_old_position_is_as_one_that_repeats_as_long() {
        use Finding::{Late, Plausible, Repeated, Stale, Unsettled};
        let of = |age_s: f64| {
            let plain = report(100, 0.0, 0.0);
            Report { fixed: Some(plain.time.plus_seconds(-age_s)), ..plain }
        };
        let aged = |age_s: f64| of(age_s).with_age(Plausible, &LIMITS);
        assert_eq!([-5.0, 0.0, 1.0, 1.5, 2.0, 2.5].map(aged), [Plausible, Plausible, Plausible, Repeated, Repeated, Stale]);
        for graver in [Stale, Finding::Jump, Unsettled, Late] {
            assert_eq!(of(60.0).with_age(graver, &LIMITS), graver);
        }
        assert_eq!(of(1.5).with_age(Repeated, &LIMITS), Repeated);
        assert_eq!(Report { fixed: None, ..of(60.0) }.with_age(Plausible, &LIMITS), Plausible);
        assert_eq!(Motion::default().see(&of(60.0), &LIMITS), Ok(Stale));
    }

    #[test]
    fn a_position_that_stays_while_the_aircraft_moves_is_repeated_and_then_stale() {
        use Finding::{Plausible, Repeated, Stale};
        let repeats = |speed| findings(&[0, 1, 2, 3, 4].map(|k| report(k, 0.0, speed)), &LIMITS);
        assert_eq!(repeats(100.0), [Plausible, Repeated, Repeated, Stale, Stale]);
        assert_eq!(repeats(0.0), [Plausible; 5]);
        // Nobody vouches that it stands.
        assert_eq!(repeats(f64::NAN), [Plausible, Plausible, Plausible, Stale, Stale]);
        let at_rest = Limits { moving_mps: f64::INFINITY, ..LIMITS };
        assert_eq!(findings(&[0, 1, 2, 3, 4].map(|k| report(k, 0.0, f64::NAN)), &at_rest), [Plausible; 5]);
    }

    #[test]
    fn a_slow_aircraft_s_position_that_stays_is_stale_once_its_speed_led_elsewhere() {
        let begins = |speed: f64, every: i64| {
            let reports: Vec<Report> = (0..600).map(|k| report(every * k, 0.0, speed)).collect();
            findings(&reports, &LIMITS).iter().position(|each| *each == Finding::Stale).map(|k| every * k as i64)
        };
        // 14.9 m/s: further than 100 m and ten seconds of it after 17 s; 3 m/s: 130 m after 44 s.
        assert_eq!([14.9, 3.0, 2.0, 0.0].map(|speed| begins(speed, 1)), [Some(17), Some(44), None, None]);
        assert_eq!(begins(14.9, 10), Some(20));
        // It may have stood during a gap.
        assert_eq!(findings(&[report(0, 0.0, 0.0), report(900, 0.0, 14.0), report(901, 14.0, 14.0)], &LIMITS)[1], Finding::Plausible);
        let at_rest = Limits { moving_mps: f64::INFINITY, ..LIMITS };
        assert_eq!(findings(&(0..100).map(|k| report(k, 0.0, 5.0)).collect::<Vec<_>>(), &at_rest), [Finding::Plausible; 100]);
    }

    /// 70 m/s north, then the position of second 100 with the speeds that `stated` gives for the seconds after it.
    fn stops(stated: impl Fn(i64) -> f64, every: i64) -> Vec<Report> {
        let speed = |k: i64| if k < 100 { 70.0 } else { stated(k - 100) };
        (0..=400).step_by(every as usize).map(|k| report(k, 70.0 * k.min(100) as f64, speed(k))).collect()
    }

    #[test]
    fn a_speed_that_falls_faster_than_an_aircraft_brakes_is_no_evidence_that_it_stands() {
        // The speed is 0 with the last new position, one report later, after three reports without one, and at one report in ten seconds.
        let ends = [(0, 0.0, 1), (1, 70.0, 1), (4, f64::NAN, 1), (10, 70.0, 10)];
        for (at, before_mps, every) in ends {
            let verdicts = findings(&stops(|k| if k < at { before_mps } else { 0.0 }, every), &LIMITS);
            let (flown, repeats) = verdicts.split_at(100 / every as usize + 1);
            assert!(flown.iter().all(|each| *each == Finding::Plausible), "{at} {every}");
            assert!(repeats.iter().skip(2).all(|each| *each == Finding::Stale), "{at} {every}: {repeats:?}");
        }
        let at_rest = Limits { moving_mps: f64::INFINITY, ..LIMITS };
        assert!(findings(&stops(|_| 0.0, 1), &at_rest).iter().all(|each| *each == Finding::Plausible));
    }

    /// The position of the fall with noise of decimetres, which is no repeat of bits.
    #[test]
    fn noise_on_a_position_that_stands_is_no_evidence_that_it_stands_either() {
        let noisy = |amplitude_m: f64| {
            let of =
                |(k, each): (usize, Report)| Report { lat_rad: each.lat_rad + amplitude_m * libm::sin(12.9 * k as f64) / 6.37e6, ..each };
            stops(|_| 0.0, 1).into_iter().enumerate().map(of).collect::<Vec<_>>()
        };
        for amplitude_m in [0.1, 0.5, 2.0] {
            let verdicts = findings(&noisy(amplitude_m), &LIMITS);
            assert!(verdicts[..102].iter().all(|each| *each == Finding::Plausible), "{amplitude_m}");
            assert!(verdicts[103..].iter().all(|each| *each == Finding::Stale), "{amplitude_m}: {verdicts:?}");
        }
        // From a speed at which it need not move, and where it goes on after a way to brake on.
        let slow = |k: i64| report(k, 0.3 * libm::sin(12.9 * k as f64), if k < 10 { 14.9 } else { 0.0 });
        assert!(findings(&(0..60).map(slow).collect::<Vec<_>>(), &LIMITS).iter().all(|each| *each == Finding::Plausible));
        let taxies =
            |k: i64| report(k, if k < 10 { 70.0 * k as f64 } else { 875.0 + 3.0 * (k - 9) as f64 }, if k < 10 { 70.0 } else { 3.0 });
        let verdicts = findings(&(0..60).map(taxies).collect::<Vec<_>>(), &LIMITS);
        assert!(verdicts.iter().all(|each| *each == Finding::Plausible), "{verdicts:?}");
    }

    /// The position of second 100 with noise of decimetres, after which the speed falls as an aircraft brakes, rows are lost, or it creeps.
    #[test]
    fn a_stop_without_the_way_to_brake_on_is_none() {
        let noisy = |k: i64, north_m: f64, speed_mps: f64| report(k, north_m + 0.3 * libm::sin(12.9 * k as f64), speed_mps);
        let flown = |k: i64| noisy(k, 70.0 * k as f64, 70.0);
        let ramp = |mps2: f64| move |k: i64| noisy(k, 7000.0, (70.0 - mps2 * (k - 100) as f64).max(0.0));
        let creeps = |k: i64| noisy(k, 7000.0 + 0.5 * (k - 100) as f64, 0.0);
        let creeps_after = |k: i64| noisy(k, 7000.0 + 0.5 * (k - 100) as f64, (70.0 - 3.5 * (k - 100) as f64).max(0.0));
        // 145 m beyond the noise of 100 m: as soon as the speed that is left needs no more than that, and 2 s.
        let seen_from = |next: &dyn Fn(i64) -> Report, from: i64| {
            let reports: Vec<Report> = (0..=100).map(flown).chain((from..200).map(next)).collect();
            let verdicts = findings(&reports, &LIMITS);
            assert!(verdicts[..=100].iter().all(|each| *each == Finding::Plausible));
            let first = verdicts.iter().position(|each| *each == Finding::Stale).unwrap();
            assert!(verdicts[first..].iter().all(|each| *each == Finding::Stale), "{verdicts:?}");
            reports[first].time.seconds_since(reports[100].time)
        };
        // v^2 / 20 is below 145 m at 53.8 m/s: after 2 s of 9 m/s2 and 5 s of 3.5 m/s2; a creep has gone 2.5 m until then.
        assert_eq!(seen_from(&ramp(9.0), 101), 5.0);
        assert_eq!(seen_from(&ramp(3.5), 101), 8.0);
        assert_eq!(seen_from(&creeps, 101), 4.0);
        assert_eq!(seen_from(&creeps_after, 101), 8.0);
        assert_eq!(seen_from(&|k| noisy(k, 7000.0, 0.0), 113), 16.0);
        assert_eq!(seen_from(&|k| noisy(k, 7000.0, 0.0), 111), 14.0);
    }

    /// Braking as hard as any does, turning, and a gap in which it may have come back.
    #[test]
    fn an_aircraft_that_flies_the_way_to_brake_on_owes_nothing() {
        for braking_mps2 in [2.0, 4.0, 8.0] {
            let speed = |k: i64| (70.0 - braking_mps2 * (k - 50).max(0) as f64).max(0.0);
            let north = |k: i64| (0..k).map(|j| 0.5 * (speed(j) + speed(j + 1))).sum::<f64>();
            let verdicts = findings(&(0..300).map(|k| report(k, north(k), speed(k))).collect::<Vec<_>>(), &LIMITS);
            assert!(verdicts.iter().all(|each| *each == Finding::Plausible), "{braking_mps2}");
        }
        // A circle of 50 s at 70 m/s, then a stop with 4 m/s2.
        let speed = |k: i64| if k < 50 { 70.0 } else { (70.0 - 4.0 * (k - 50) as f64).max(0.0) };
        let way = |k: i64| (0..k).map(|j| 0.5 * (speed(j) + speed(j + 1))).sum::<f64>();
        let turn = |k: i64| report(k, 557.0 * libm::sin(way(k) / 557.0), speed(k));
        assert!(findings(&(0..120).map(turn).collect::<Vec<_>>(), &LIMITS).iter().all(|each| *each == Finding::Plausible));
        let back = |k: i64| if k < 100 { report(k, 70.0 * k as f64, 70.0) } else { report(k + 3000, 6930.5, 0.0) };
        assert!(findings(&(0..200).map(back).collect::<Vec<_>>(), &LIMITS).iter().all(|each| *each == Finding::Plausible));
    }

    /// 70 m/s to nothing in 20 s, 25 m/s in 3 s, and minutes of the same bits.
    #[test]
    fn an_aircraft_that_braked_may_repeat_its_position() {
        for (from_mps, braking_mps2) in [(70.0, 3.5), (25.0, 9.0)] {
            let (mut north_m, mut speed_mps): (f64, f64) = (0.0, from_mps);
            let reports = (0..300).map(|k| {
                let next_mps = if k < 100 { from_mps } else { (speed_mps - braking_mps2).max(0.0) };
                north_m += 0.5 * (speed_mps + next_mps);
                speed_mps = next_mps;
                report(k, north_m, speed_mps)
            });
            assert!(findings(&reports.collect::<Vec<_>>(), &LIMITS).iter().all(|each| *each == Finding::Plausible), "{from_mps}");
        }
        // One speed that drops out while the position goes on says nothing of a stand later.
        let drop = |k: i64| report(k, 70.0 * k as f64, if k == 50 { 0.0 } else { 70.0 });
        assert!(findings(&(0..100).map(drop).collect::<Vec<_>>(), &LIMITS).iter().all(|each| *each == Finding::Plausible));
    }

    #[test]
    fn the_reach_over_a_hold_counts_no_time_in_which_the_aircraft_stood_by_its_reports() {
        // At 70 m/s again from where the flight is by then: (1.25 x 70 + 25) m/s in 1 + 10 s, and 100 m, are 1337.5 m.
        let back = |hold_s: i64, speed_mps: f64| {
            let repeats = (0..hold_s).map(|k| report(k, 0.0, speed_mps));
            let on = [report(hold_s, 70.0 * hold_s as f64, 70.0)];
            findings(&repeats.chain(on).collect::<Vec<_>>(), &LIMITS).pop().unwrap()
        };
        assert_eq!([19, 20, 200].map(|hold_s| back(hold_s, 0.0)), [Finding::Late, Finding::Jump, Finding::Jump]);
        assert_eq!([19, 20, 200].map(|hold_s| back(hold_s, 70.0)), [Finding::Plausible; 3]);
    }

    #[test]
    fn a_step_beyond_the_reach_is_a_jump_and_nothing_is_believed_until_it_has_settled() {
        use Finding::{Jump, Late, Plausible, Unsettled};
        // (1.25 x 100 + 25) m/s in 1 + 10 s, and 100 m: 1750 m; with 2 s: 550 m.
        let step = |north_m, speed| findings(&[report(0, 0.0, speed), report(1, north_m, speed)], &LIMITS)[1];
        assert_eq!([540.0, 560.0, 1740.0, 1760.0].map(|m| step(m, 100.0)), [Plausible, Late, Late, Jump]);
        // Without a speed 400 m/s in 1 + 2 s, and 100 m.
        assert_eq!([1290.0, 1310.0].map(|m| step(m, f64::NAN)), [Plausible, Jump]);
        let after = |k| if k == 1 { report(k, 9e3, 100.0) } else { report(k, 9e3 + 100.0 * (k - 1) as f64, 100.0) };
        let all = findings(&[report(0, 0.0, 100.0), after(1), after(2), after(31), after(32)], &LIMITS);
        assert_eq!(all, [Plausible, Jump, Unsettled, Unsettled, Plausible]);
    }

    #[test]
    fn two_places_of_one_time_are_a_jump_where_their_covariances_do_not_explain_them() {
        use Finding::{Jump, Plausible, Unsettled};
        // 2 m of rounding, and 6.4379 of the standard deviations of 4 + 4 m2: 20.2 m.
        let again = |north_m| findings(&[report(0, 0.0, 70.0), report(1, 70.0, 70.0), report(1, 70.0 + north_m, 70.0)], &LIMITS)[2];
        assert_eq!([0.0, 20.0, 20.5, 300.0, 5e5].map(again), [Plausible, Plausible, Jump, Jump, Jump]);
        // The next ones are not believed, whichever place they go on from.
        let after = [report(0, 0.0, 70.0), report(0, 300.0, 70.0), report(1, 70.0, 70.0), report(31, 2170.0, 70.0)];
        assert_eq!(findings(&after, &LIMITS), [Plausible, Jump, Unsettled, Plausible]);
    }

    #[test]
    fn two_heights_of_one_time_are_a_jump_where_their_variances_do_not_explain_them() {
        use Finding::{Jump, Plausible};
        let at = |k, h_m, variance_m2| Report { height: Some(Height { h_m, variance_m2 }), ..report(k, 70.0 * k as f64, 70.0) };
        let again = |up_m, variance| findings(&[at(0, 900.0, 4.0), at(1, 1000.0, variance), at(1, 1000.0 + up_m, variance)], &LIMITS)[2];
        // As two places: 20.2 m by 4 + 4 m2, 2 m without any; and what is never a jump where no variance is stated.
        assert_eq!([0.0, 20.0, 20.5, -3e3].map(|up_m| again(up_m, 4.0)), [Plausible, Plausible, Jump, Jump]);
        assert_eq!([2.0, 2.1].map(|up_m| again(up_m, 0.0)), [Plausible, Jump]);
        assert_eq!([100.0, -100.0, 101.0, 4e3].map(|up_m| again(up_m, f64::NAN)), [Plausible, Plausible, Jump, Jump]);
        // Of different times, of a position that stands, and beside no height.
        let stands = |k, h_m| Report { height: Some(Height { h_m, variance_m2: 1.0 }), ..report(k, 0.0, 0.0) };
        assert_eq!(findings(&[stands(0, 0.0), stands(1, 500.0), stands(2, 1000.0), stands(2, 1001.0)], &LIMITS), [Plausible; 4]);
        assert_eq!(findings(&[stands(0, 0.0), stands(1, 500.0), stands(1, 0.0)], &LIMITS)[2], Jump);
        assert_eq!(findings(&[stands(0, 0.0), report(0, 0.0, 0.0), stands(1, 3e3), report(1, 0.0, 0.0)], &LIMITS), [Plausible; 4]);
    }

    #[test]
    fn a_position_that_stands_under_time_stamps_that_crawl_lasts_as_long_as_its_reports() {
        use Finding::{Plausible, Repeated, Stale};
        let crawls = |speed| move |k: i64| Report { time: GpsTime::from_nanoseconds(k * 1_000_000), ..report(0, 0.0, speed) };
        let declared = Limits { period_s: 1.0, ..LIMITS };
        let silent: Vec<Report> = (0..60).map(crawls(f64::NAN)).collect();
        assert_eq!(findings(&silent, &declared)[..4], [Plausible, Plausible, Plausible, Stale]);
        assert!(findings(&silent, &declared)[3..].iter().all(|each| *each == Stale));
        assert_eq!(findings(&(0..5).map(crawls(70.0)).collect::<Vec<_>>(), &declared), [Plausible, Repeated, Repeated, Stale, Stale]);
        assert_eq!(findings(&(0..60).map(crawls(0.0)).collect::<Vec<_>>(), &declared), [Plausible; 60]);
        // The same after a minute of flight: its last position under stamps that go on by a millisecond, and by four.
        let flies = |k: i64| report(k - 60, 70.0 * k as f64, f64::NAN);
        for step_ns in [1_000_000, 4_000_000] {
            let last = |k: i64| Report { time: GpsTime::from_nanoseconds(k * step_ns), ..flies(60) };
            let verdicts = findings(&(0..60).map(flies).chain((0..60).map(last)).collect::<Vec<_>>(), &declared);
            assert!(verdicts[..63].iter().all(|each| *each == Plausible), "{step_ns}");
            assert!(verdicts[63..].iter().all(|each| *each == Stale), "{step_ns}: {:?}", &verdicts[60..]);
        }
        // Where nobody declares how often reports come, a fast table repeats its position.
        assert_eq!(findings(&silent, &LIMITS), [Plausible; 60]);
        // Reports at half the period or more are no crawl; nor is a position that repeats between two others.
        let half = |k: i64| Report { time: GpsTime::from_nanoseconds(k * 500_000_000), ..report(0, 0.0, f64::NAN) };
        assert_eq!(
            findings(&(0..6).map(half).collect::<Vec<_>>(), &declared),
            [Plausible, Plausible, Plausible, Plausible, Plausible, Stale]
        );
        let fast =
            |k: i64| Report { time: GpsTime::from_nanoseconds(k * 100_000_000), ..report(0, 7.0 * (1 + k.max(0) / 10) as f64, f64::NAN) };
        let moves: Vec<Report> = core::iter::once(Report { time: GpsTime::from_nanoseconds(-1_000_000_000), ..report(0, 0.0, f64::NAN) })
            .chain((0..60).map(fast))
            .collect();
        assert_eq!(findings(&moves, &declared), [Plausible; 61]);
    }

    #[test]
    fn a_flight_by_time_stamps_that_crawl_is_a_jump_and_one_with_late_positions_is_none() {
        // 70 m/s whose stamps go on by a millisecond: (1.25 x 70 + 25) m/s x 10 s + 100 m are 1225 m, 18 steps.
        let crawls = |k: i64, speed| Report { time: GpsTime::from_nanoseconds(k * 1_000_000), ..report(0, 70.0 * k as f64, speed) };
        let first = |verdicts: Vec<Finding>, of| verdicts.iter().position(|each| *each == of);
        let all = findings(&(0..90).map(|k| crawls(k, 70.0)).collect::<Vec<_>>(), &LIMITS);
        assert_eq!((first(all.clone(), Finding::Late), first(all.clone(), Finding::Jump)), (Some(5), Some(18)));
        assert!(all[5..].iter().all(|each| *each != Finding::Plausible), "{all:?}");
        // Without speeds 400 m/s x 2 s + 100 m.
        let silent = findings(&(0..90).map(|k| crawls(k, f64::NAN)).collect::<Vec<_>>(), &LIMITS);
        assert!(first(silent.clone(), Finding::Jump) == Some(13) && silent[13..].iter().all(|each| *each != Finding::Plausible));
        // Positions by turns of now and up to 1.9 s old, of one that brakes at 5 m/s2 as well.
        let late = |k: i64| report(k, 70.0 * (k as f64 - if k % 3 == 1 { 1.9 } else { 0.0 }), 70.0);
        assert!(findings(&(0..90).map(late).collect::<Vec<_>>(), &LIMITS).iter().all(|each| *each == Finding::Plausible));
        let speed = |k: i64| (70.0 - 5.0 * k as f64).max(0.0);
        let brakes = |k: i64| report(k, (0..k).map(|j| 0.5 * (speed(j) + speed(j + 1))).sum(), speed(k));
        assert!(findings(&(0..40).map(brakes).collect::<Vec<_>>(), &LIMITS).iter().all(|each| *each == Finding::Plausible));
    }

    #[test]
    fn a_report_of_the_past_says_nothing_and_a_place_off_the_earth_is_none() {
        let mut motion = Motion::default();
        motion.see(&report(10, 0.0, 100.0), &LIMITS).unwrap();
        assert_eq!(motion.see(&report(5, 9e5, 100.0), &LIMITS), Ok(Finding::Plausible));
        assert!(motion.see(&Report { lat_rad: f64::NAN, ..report(11, 0.0, 100.0) }, &LIMITS).is_err());
    }
}
