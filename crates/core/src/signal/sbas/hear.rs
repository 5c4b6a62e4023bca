//! How a message changes what is in force.

use super::fast::{FAST_MOST, Fast, IODF_ALERT, Integrity, UDREI_NOT_MONITORED};
use super::history::{FastCorrection, History};
use super::iono::{GridDelays, GridMask};
use super::long_term::LongTermHalf;
use super::mask::PrnMask;
use super::region::{Covariances, ServiceRegions};
use super::store::{Obedience, REGION_MESSAGES, Received, Slot, Store, slot_of};
use super::{FastDegradation, Message, timeout};
use crate::quantity::GpsTime;

/// Why a message changed nothing. Counted, never an error.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Ignored {
    /// Message 0 came less than a minute ago.
    #[error("the satellite said \"do not use\" less than a minute ago")]
    DoNotUse,
    /// No PRN mask of its issue is held.
    #[error("no PRN mask of this issue was received")]
    NoPrnMask,
    /// A type that is not known.
    #[error("unknown message type {0}")]
    Unknown(u8),
}

impl Store {
    /// Take a message that ended at `at`.
    ///
    /// # Errors
    /// [`Ignored`] when it changed nothing, which happens after every start and every change of a mask.
    pub fn receive(&mut self, at: GpsTime, message: &Message) -> Result<(), Ignored> {
        self.end_silence(at);
        if let Message::DoNotUse(content) = message {
            return self.do_not_use(at, content.as_ref());
        }
        if self.stopped(at) {
            return Err(Ignored::DoNotUse);
        }
        match message {
            Message::PrnMask(mask) => self.prn_mask(at, mask),
            Message::Fast(fast) => self.fast(at, fast)?,
            Message::Integrity(integrity) => self.integrity(at, integrity)?,
            Message::FastDegradation(ageing) => self.ageing(at, ageing)?,
            Message::GeoNavigation(geo) => self.geo = Some(Received { value: *geo, at }),
            Message::Degradation(value) => self.degradation = Some(Received { value: *value, at }),
            Message::NetworkTime(value) => self.network_time = Some(Received { value: *value, at }),
            Message::GeoAlmanacs(value) => self.almanacs = Some(Received { value: *value, at }),
            Message::GridMask(mask) => self.grid_mask(at, mask),
            Message::Mixed(fast, half) => {
                self.fast(at, fast)?;
                self.long_term(at, half)?;
            }
            Message::LongTerm(halves) => halves.iter().try_for_each(|half| self.long_term(at, half))?,
            Message::GridDelays(delays) => self.grid_delays(at, delays),
            Message::ServiceRegions(regions) => self.service_regions(at, regions),
            Message::Covariances(covariances) => self.covariances(at, covariances)?,
            Message::Unknown(kind) => return Err(Ignored::Unknown(*kind)),
            Message::DoNotUse(_) | Message::InternalTest | Message::Null => {}
        }
        Ok(())
    }

    /// Whatever a message says, it ends a silence.
    fn end_silence(&mut self, at: GpsTime) {
        let gap = self.heard.map(|before| at.nanoseconds().saturating_sub(before.nanoseconds()));
        if gap.is_some_and(|ns| ns > timeout::SILENCE_NS) {
            self.resumed = Some(at);
        }
        self.heard = self.heard.max(Some(at));
    }

    fn do_not_use(&mut self, at: GpsTime, content: Option<&Fast>) -> Result<(), Ignored> {
        match self.obedience {
            Obedience::Obey => {
                *self = Self { stopped: Some(at), heard: self.heard, resumed: self.resumed, ..Self::new(Obedience::Obey) };
                Ok(())
            }
            Obedience::UseTestSignal => content.map_or(Ok(()), |fast| self.fast(at, fast)),
        }
    }

    fn prn_mask(&mut self, at: GpsTime, mask: &PrnMask) {
        let [newest, older] = &mut self.masks;
        if newest.is_some_and(|r| r.value.iodp != mask.iodp) {
            *older = *newest;
        }
        *newest = Some(Received { value: *mask, at });
    }

    /// The mask that a message of this issue means, which is in force from now on.
    fn activate(&mut self, iodp: u8) -> Result<PrnMask, Ignored> {
        let mask = self.mask(iodp).ok_or(Ignored::NoPrnMask)?.value;
        self.active = Some(iodp);
        Ok(mask)
    }

    fn slot(&mut self, mask: &PrnMask, position: usize) -> Option<&mut Slot> {
        self.slots.get_mut(slot_of(mask.prn(position)?)?)
    }

    fn fast(&mut self, at: GpsTime, fast: &Fast) -> Result<(), Ignored> {
        let mask = self.activate(fast.iodp)?;
        let applies = Received { value: (), at }.applies();
        for (position, correction_m, udrei) in fast.satellites() {
            let Some(slot) = self.slot(&mask, position) else { continue };
            slot.udre = Some((udrei, applies, at));
            if udrei >= UDREI_NOT_MONITORED {
                // A correction that nobody watches is no number, nor is a rate across it.
                slot.history = History::default();
            } else {
                slot.history.push(FastCorrection { correction_m, iodf: fast.iodf, applies, received: at });
            }
        }
        Ok(())
    }

    /// Indicators of message 6 count for the corrections they name, or, in an alert, for whatever is held.
    fn integrity(&mut self, at: GpsTime, integrity: &Integrity) -> Result<(), Ignored> {
        let mask = self.activate(self.active.ok_or(Ignored::NoPrnMask)?)?;
        let sent = Received { value: (), at }.applies();
        for (i, udrei) in integrity.udrei.iter().enumerate() {
            let iodf = integrity.iodf.get(i / FAST_MOST).copied();
            let Some(slot) = self.slot(&mask, i + 1) else { continue };
            let Some(newest) = slot.history.newest() else { continue };
            if iodf == Some(IODF_ALERT) {
                slot.udre = Some((*udrei, sent, at));
            } else if iodf == Some(newest.iodf) {
                slot.udre = Some((*udrei, newest.applies, at));
            }
        }
        Ok(())
    }

    fn ageing(&mut self, at: GpsTime, ageing: &FastDegradation) -> Result<(), Ignored> {
        let mask = self.activate(ageing.iodp)?;
        for (i, indicator) in ageing.indicator.iter().enumerate() {
            if let Some(slot) = self.slot(&mask, i + 1) {
                slot.ageing = Some(Received { value: (*indicator, ageing.latency_s), at });
            }
        }
        Ok(())
    }

    fn long_term(&mut self, at: GpsTime, half: &LongTermHalf) -> Result<(), Ignored> {
        for value in half.iter().flatten() {
            let mask = self.activate(value.iodp)?;
            let Some(slot) = self.slot(&mask, usize::from(value.position)) else { continue };
            let [newest, older] = &mut slot.long_term;
            // The one before is kept: a user may not have the new navigation data yet.
            if newest.is_some_and(|r| r.value.iode != value.iode) {
                *older = *newest;
            }
            *newest = Some(Received { value: *value, at });
        }
        Ok(())
    }

    fn covariances(&mut self, at: GpsTime, covariances: &Covariances) -> Result<(), Ignored> {
        let mask = self.activate(covariances.iodp)?;
        self.covariance_heard = true;
        for value in covariances.satellites.iter().flatten() {
            if let Some(slot) = self.slot(&mask, usize::from(value.position)) {
                slot.covariance = Some(Received { value: *value, at });
            }
        }
        Ok(())
    }

    fn service_regions(&mut self, at: GpsTime, regions: &ServiceRegions) {
        if self.regions.iter().flatten().any(|r| r.value.iods != regions.iods) {
            self.regions = [None; REGION_MESSAGES];
        }
        if let Some(in_force) = self.regions.get_mut(usize::from(regions.number) - 1) {
            *in_force = Some(Received { value: *regions, at });
        }
    }

    fn grid_mask(&mut self, at: GpsTime, mask: &GridMask) {
        let Some([newest, older]) = self.grid_masks.get_mut(usize::from(mask.band)) else { return };
        if newest.is_some_and(|r| r.value.iodi != mask.iodi) {
            *older = *newest;
        }
        *newest = Some(Received { value: *mask, at });
    }

    fn grid_delays(&mut self, at: GpsTime, delays: &GridDelays) {
        let band = self.grid.get_mut(usize::from(delays.band));
        if let Some(block) = band.and_then(|blocks| blocks.get_mut(usize::from(delays.block))) {
            *block = Some(Received { value: *delays, at });
        }
    }
}
