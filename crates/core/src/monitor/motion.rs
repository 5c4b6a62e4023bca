//! Can a position have been flown to? What is judged of one report from the last one alone; of a whole recording more can be said.
//!
//! A position report does not show whether it is true: a decoder or a receiver repeats the last position when none arrives, and a falsified
//! receiver jumps. Both leave a track that no bound of the navigation error covers.

use super::ahead::Ahead;
use super::neighbours::{Height, Place, one_height, one_place};
use super::standing::Gone;
use super::way::Way;
use crate::frame::{EcefPosition, Geodetic, LatLon, ecef_from_geodetic};
use crate::quantity::{GpsTime, Metres, OutOfDomain, Radians, Reason};

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
#[path = "motion_tests.rs"]
pub(super) mod tests;
