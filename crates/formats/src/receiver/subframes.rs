//! Subframes, pages and messages as they come, kept until they are whole.

use super::bits::Bits;
use super::{inav, lnav};
use crate::rinex::{Dated, Navigation};
use crate::sbas::Received;
use navbound_core::quantity::GpsTime;
use navbound_core::signal::sbas::{BLOCK_BYTES, Block};
use navbound_core::signal::{Ephemeris, Klobuchar, SatelliteId};
use std::collections::BTreeMap;

/// Why a subframe is not used.
pub(super) type Reason = &'static str;

/// What a satellite has sent of the record it repeats.
#[derive(Default)]
pub(super) struct Subframes {
    gps: BTreeMap<SatelliteId, lnav::Parts>,
    galileo: BTreeMap<SatelliteId, inav::Parts>,
    navigation: Navigation,
    messages: Vec<Received>,
}

impl Subframes {
    /// Ten words of a GPS subframe with their parity, right-aligned; `near`: time to within half a week.
    pub(super) fn gps(&mut self, satellite: SatelliteId, words: &[u32; 10], near: GpsTime) -> Result<(), Reason> {
        if !lnav::parity_is_right(words) {
            return Err("a word's parity is wrong");
        }
        self.gps_without_parity(satellite, &words.map(|w| w >> 6), near)
    }
    /// One message each time it changes; those that no satellite sends are counted alone.
    fn ionosphere(&mut self, message: Klobuchar, end: GpsTime) {
        if message.implausible().is_some() && !message.is_empty() {
            return self.navigation.skip("GPS ionosphere messages that no sun makes".to_owned());
        }
        self.navigation.klobuchar_gps.get_or_insert(message);
        let messages = &mut self.navigation.ionosphere_gps;
        if messages.last().is_none_or(|d| d.message != message) {
            messages.push(Dated { time: Some(end), message });
        }
    }
    /// Ten words of 24 bits.
    pub(super) fn gps_without_parity(&mut self, satellite: SatelliteId, words: &[u32; 10], near: GpsTime) -> Result<(), Reason> {
        let subframe = lnav::Subframe::new(words, near)?;
        if let Some((klobuchar, leap_seconds)) = subframe.ionosphere() {
            self.ionosphere(klobuchar, subframe.end);
            self.navigation.leap_seconds.get_or_insert(leap_seconds);
        }
        let ephemeris = self.gps.entry(satellite).or_default().take(satellite, &subframe);
        keep(&mut self.navigation.ephemerides, ephemeris)
    }
    /// The two pages of a Galileo I/NAV word; the odd one begins at bit `odd`.
    pub(super) fn galileo(&mut self, satellite: SatelliteId, pages: &[u8; 32], odd: usize, near: GpsTime) -> Result<(), Reason> {
        let Some(word) = inav::word(pages, odd)? else { return Ok(()) };
        let ephemeris = self.galileo.entry(satellite).or_default().take(satellite, &word, near);
        keep(&mut self.navigation.ephemerides, ephemeris)
    }
    /// 250 bits of an SBAS message that ended at the second nearest to `near`.
    pub(super) fn sbas(&mut self, satellite: SatelliteId, bytes: [u8; BLOCK_BYTES], near: GpsTime) -> Result<(), Reason> {
        const SECOND_NS: i64 = 1_000_000_000;
        let block = Block::new(bytes).map_err(|_| "preamble or parity of an SBAS message is wrong")?;
        let end = near.nanoseconds().checked_add(SECOND_NS / 2).ok_or("no time")?.div_euclid(SECOND_NS) * SECOND_NS;
        self.messages.push(Received { end: GpsTime::from_nanoseconds(end), prn: 100 + satellite.number, block });
        Ok(())
    }
    pub(super) fn finish(mut self) -> (Navigation, Vec<Received>) {
        self.navigation.sort();
        (self.navigation, self.messages)
    }
}

/// A record once, not at every repetition.
fn keep(records: &mut Vec<Ephemeris>, ephemeris: Option<Result<Ephemeris, Reason>>) -> Result<(), Reason> {
    let Some(ephemeris) = ephemeris.transpose()? else { return Ok(()) };
    let same = |e: &Ephemeris| Ephemeris { sent: ephemeris.sent, ..*e } == ephemeris;
    // Repetitions stand near the end: every satellite adds one record in two hours.
    if !records.iter().rev().any(same) {
        records.push(ephemeris);
    }
    Ok(())
}

/// Keplerian elements that an orbit can have, by the limits of the readers of files.
pub(super) fn plausible(e: Ephemeris) -> Result<Ephemeris, Reason> {
    match crate::rinex::navigation::orbit_refusal(e.sqrt_a, e.eccentricity) {
        None => Ok(e),
        Some((_, reason)) => Err(reason),
    }
}

/// Unsigned fields at once.
pub(super) fn small(bits: &Bits<'_>, first: usize, n: usize) -> u16 {
    bits.unsigned(first, n) as u16
}
