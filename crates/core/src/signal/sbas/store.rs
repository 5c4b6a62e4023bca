//! What one geostationary satellite has said that is still in force.

use super::grid::{GridPoint, place};
use super::history::{FastCorrection, History};
use super::iono::{BANDS, BLOCK_POINTS, BLOCKS, GridDelays, GridMask};
use super::long_term::LongTerm;
use super::mask::PrnMask;
use super::region::{ClockEphemerisCovariance, ServiceRegions};
use super::timeout::{self, Use, within};
use super::{Degradation, GeoAlmanacs, GeoNavigation, GridDelay, NetworkTime};
use crate::quantity::GpsTime;

/// A message lasts one second: its first bit leaves the satellite this long before it ends.
const DURATION_NS: i64 = 1_000_000_000;
/// Satellites with a slot of their own: GPS and GLONASS (1 to 61), SBAS (120 to 158).
const SLOTS: usize = 61 + 39;
/// Messages 27 of one issue.
pub(super) const REGION_MESSAGES: usize = 8;

/// Whether a message 0 is obeyed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Obedience {
    /// As the standard demands: everything is forgotten and the satellite is left alone for a minute.
    Obey,
    /// A signal under test is used all the same. Not for navigation; results must say so.
    UseTestSignal,
}

/// A value and when its message ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Received<T> {
    pub(super) value: T,
    pub(super) at: GpsTime,
}

impl<T> Received<T> {
    pub(super) fn applies(&self) -> GpsTime {
        GpsTime::from_nanoseconds(self.at.nanoseconds() - DURATION_NS)
    }
}

#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Slot {
    pub(super) history: History,
    /// Indicator, time of applicability, end of its message.
    pub(super) udre: Option<(u8, GpsTime, GpsTime)>,
    /// Degradation indicator and system latency of message 7.
    pub(super) ageing: Option<Received<(u8, u8)>>,
    /// Newest first; of different issues.
    pub(super) long_term: [Option<Received<LongTerm>>; 2],
    pub(super) covariance: Option<Received<ClockEphemerisCovariance>>,
}

/// A grid point's value in force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GridValue {
    /// Where.
    pub point: GridPoint,
    /// What is in force there, with the first bit of its message.
    pub in_force: Option<(GridDelay, GpsTime)>,
}

/// The parts of one satellite's correction in force, before any model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Satellite {
    /// PRN code number.
    pub prn: u8,
    /// UDRE indicator.
    pub udrei: u8,
    /// Its time of applicability.
    pub udre_applies: GpsTime,
    /// Newest fast correction, and the one its rate is taken from.
    pub fast: FastCorrection,
    /// Earlier correction for the range rate; none when the satellite needs no rate, or has none yet.
    pub earlier: Option<FastCorrection>,
    /// Degradation indicator and system latency \[s\] of message 7.
    pub ageing: Option<(u8, u8)>,
    /// Long-term corrections in force, newest first, with the first bit of their message.
    pub long_term: [Option<(LongTerm, GpsTime)>; 2],
    /// Clock-ephemeris covariance in force.
    pub covariance: Option<ClockEphemerisCovariance>,
    /// A correction in use is too old for precision approach (en route only).
    pub aged: bool,
}

/// Why a satellite has no correction in force.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Correction {
    /// Not in the mask in force.
    #[error("not in the PRN mask")]
    NotInMask,
    /// Its indicator is from before a silence of the whole signal.
    #[error("UDRE lost: four seconds without a message")]
    MessageLoss,
    /// No indicator in force.
    #[error("UDRE too old or never sent")]
    NoUdre,
    /// No fast correction in force.
    #[error("fast correction too old or never sent")]
    NoFast,
    /// No long-term correction in force.
    #[error("long-term correction too old or never sent")]
    NoLongTerm,
}

/// Everything in force from one geostationary satellite. About 200 kB, no heap.
#[derive(Debug, Clone)]
pub struct Store {
    pub(super) obedience: Obedience,
    pub(super) stopped: Option<GpsTime>,
    /// End of the last valid message of any type.
    pub(super) heard: Option<GpsTime>,
    /// End of the first message after the last silence: indicators from before it are lost to an approach.
    pub(super) resumed: Option<GpsTime>,
    /// Newest first.
    pub(super) masks: [Option<Received<PrnMask>>; 2],
    /// Issue of the mask that corrections use.
    pub(super) active: Option<u8>,
    pub(super) slots: [Slot; SLOTS],
    pub(super) degradation: Option<Received<Degradation>>,
    pub(super) regions: [Option<Received<ServiceRegions>>; REGION_MESSAGES],
    pub(super) covariance_heard: bool,
    pub(super) grid_masks: [[Option<Received<GridMask>>; 2]; BANDS],
    /// Kept as sent: delays may come before the mask that says where they are.
    pub(super) grid: [[Option<Received<GridDelays>>; BLOCKS]; BANDS],
    pub(super) geo: Option<Received<GeoNavigation>>,
    pub(super) almanacs: Option<Received<GeoAlmanacs>>,
    pub(super) network_time: Option<Received<NetworkTime>>,
}

impl Store {
    /// Nothing heard yet.
    pub fn new(obedience: Obedience) -> Self {
        Self {
            obedience,
            stopped: None,
            heard: None,
            resumed: None,
            masks: [None; 2],
            active: None,
            slots: [Slot::default(); SLOTS],
            degradation: None,
            regions: [None; REGION_MESSAGES],
            covariance_heard: false,
            grid_masks: [[None; 2]; BANDS],
            grid: [[None; BLOCKS]; BANDS],
            geo: None,
            almanacs: None,
            network_time: None,
        }
    }

    /// Whether message 0 forbids any use now.
    pub fn stopped(&self, now: GpsTime) -> bool {
        self.stopped.is_some_and(|since| within(since, now, timeout::DO_NOT_USE_S))
    }
    /// Whether no valid message was heard for so long that an approach has no indicator left.
    pub fn silent(&self, now: GpsTime) -> bool {
        let since = |end: GpsTime| now.nanoseconds().saturating_sub(end.nanoseconds());
        self.heard.is_some_and(|end| since(end) >= timeout::SILENCE_NS + timeout::WAY_NS)
    }
    /// Whether silence took an indicator that ended at `at` from this use.
    fn lost(&self, used_for: Use, at: GpsTime, now: GpsTime) -> bool {
        used_for == Use::PrecisionApproach && (self.silent(now) || self.resumed.is_some_and(|since| at < since))
    }
    /// Degradation parameters in force.
    pub fn degradation(&self, used_for: Use, now: GpsTime) -> Option<&Degradation> {
        self.degradation.as_ref().filter(|r| timeout::DEGRADATION.alive(used_for, r.at, now)).map(|r| &r.value)
    }
    /// Whether a message 28 was ever received: from then on every satellite needs its own.
    pub const fn covariance_heard(&self) -> bool {
        self.covariance_heard
    }
    /// Service regions in force.
    pub fn regions(&self, used_for: Use, now: GpsTime) -> impl Iterator<Item = &ServiceRegions> {
        self.regions.iter().flatten().filter(move |r| timeout::REGIONS.alive(used_for, r.at, now)).map(|r| &r.value)
    }
    /// The sender's own orbit in force, with the end of its message.
    pub fn geo_navigation(&self, used_for: Use, now: GpsTime) -> Option<&GeoNavigation> {
        self.geo.as_ref().filter(|r| timeout::GEO_NAVIGATION.alive(used_for, r.at, now)).map(|r| &r.value)
    }
    /// The last almanac; it never grows too old.
    pub fn almanacs(&self) -> Option<&GeoAlmanacs> {
        self.almanacs.as_ref().map(|r| &r.value)
    }
    /// The last network time.
    pub fn network_time(&self) -> Option<&NetworkTime> {
        self.network_time.as_ref().map(|r| &r.value)
    }
    /// PRN code numbers of the mask in force.
    pub fn prns(&self, used_for: Use, now: GpsTime) -> &[u8] {
        let alive = |r: &&Received<PrnMask>| timeout::PRN_MASK.alive(used_for, r.at, now);
        self.active.and_then(|iodp| self.mask(iodp)).filter(alive).map_or(&[], |r| r.value.prns())
    }

    /// The parts of a satellite's correction in force.
    ///
    /// # Errors
    /// [`Correction`]: the first thing that lacks.
    pub fn satellite(&self, prn: u8, used_for: Use, now: GpsTime) -> Result<Satellite, Correction> {
        if !self.prns(used_for, now).contains(&prn) {
            return Err(Correction::NotInMask);
        }
        let slot = slot_of(prn).and_then(|i| self.slots.get(i)).ok_or(Correction::NotInMask)?;
        let alive = |o: timeout::TimeOut, at| o.alive(used_for, at, now);
        let (udrei, udre_applies, sent) = slot.udre.filter(|(_, _, at)| alive(timeout::UDRE, *at)).ok_or(Correction::NoUdre)?;
        if self.lost(used_for, sent, now) {
            return Err(Correction::MessageLoss);
        }
        let ageing = slot.ageing.filter(|r| alive(timeout::FAST_DEGRADATION, r.at)).map(|r| r.value);
        // Without message 7 the shortest time-out is the only safe one.
        let indicator = ageing.map_or(timeout::FAST.len() - 1, |(indicator, _)| usize::from(indicator));
        let (_, fast_out) = *timeout::FAST.get(indicator).ok_or(Correction::NoFast)?;
        let fast = slot.history.newest().filter(|f| alive(fast_out, f.received)).ok_or(Correction::NoFast)?;
        let long_term = slot.long_term.map(|l| l.filter(|r| alive(timeout::LONG_TERM, r.at)));
        if long_term.iter().all(Option::is_none) {
            return Err(Correction::NoLongTerm);
        }
        let young = |o: timeout::TimeOut, at| o.alive(Use::PrecisionApproach, at, now);
        let newest_long_term = long_term.iter().flatten().next().is_some_and(|r| young(timeout::LONG_TERM, r.at));
        Ok(Satellite {
            prn,
            udrei,
            udre_applies,
            fast,
            earlier: slot.history.earlier(fast_out.seconds(used_for)),
            ageing,
            long_term: long_term.map(|l| l.map(|r| (r.value, r.applies()))),
            covariance: slot.covariance.filter(|r| alive(timeout::COVARIANCE, r.at)).map(|r| r.value),
            aged: !(young(fast_out, fast.received) && newest_long_term),
        })
    }

    /// Grid points of the masks in force. While a new mask takes over, points of the old one come first and those of the new one after,
    /// so that the later value of a place counts; a point without a value in force replaces none.
    pub fn grid(&self, used_for: Use, now: GpsTime) -> impl Iterator<Item = GridValue> + '_ {
        let alive = move |r: &&Received<GridMask>| timeout::GRID_MASK.alive(used_for, r.at, now);
        let masks = self.grid_masks.iter().flat_map(|[newest, older]| [older.as_ref(), newest.as_ref()]).flatten().filter(alive);
        masks.flat_map(move |mask| {
            mask.value.points().iter().enumerate().filter_map(move |(i, number)| self.grid_value(&mask.value, i, *number, used_for, now))
        })
    }

    fn grid_value(&self, mask: &GridMask, index: usize, number: u8, used_for: Use, now: GpsTime) -> Option<GridValue> {
        let block = self.grid.get(usize::from(mask.band))?.get(index / BLOCK_POINTS)?.as_ref();
        let block = block.filter(|r| r.value.iodi == mask.iodi && timeout::GRID.alive(used_for, r.at, now));
        let in_force = block.and_then(|r| Some((r.value.points.get(index % BLOCK_POINTS)?, r.applies())));
        Some(GridValue { point: place(mask.band, number)?, in_force: in_force.map(|(delay, applies)| (*delay, applies)) })
    }

    pub(super) fn mask(&self, iodp: u8) -> Option<&Received<PrnMask>> {
        self.masks.iter().flatten().find(|r| r.value.iodp == iodp)
    }
}

/// Where a PRN code number is kept; none for numbers no service corrects.
pub(super) fn slot_of(prn: u8) -> Option<usize> {
    match prn {
        1..=61 => Some(usize::from(prn) - 1),
        120..=158 => Some(61 + usize::from(prn) - 120),
        _ => None,
    }
}

#[cfg(test)]
mod tests;
