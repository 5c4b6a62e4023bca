//! Galileo I/NAV: words 1 to 5 to an orbit.
//!
//! Source: Galileo OS SIS ICD 2.1, sections 4.3 and 5.1; standard.

use super::bits::{Bits, append};
use super::subframes::{Reason, plausible, small};
use crate::rinex::navigation::{fit_interval, nearest_week};
use core::f64::consts::PI;
use navbound_core::quantity::GpsTime;
use navbound_core::signal::sbas::crc24q;
use navbound_core::signal::{Ephemeris, Health, Message, SatelliteId};

/// Bits that the checksum covers: the even page without its tail, and 82 of the odd one; four zeros in front fill the byte.
const COVERED: usize = 114 + 82;

/// The 128 bits of a word from its two pages, the odd one beginning at bit `odd`; `None` for an alert page.
pub(super) fn word(pages: &[u8; 32], odd: usize) -> Result<Option<[u8; 16]>, Reason> {
    let bits = Bits(pages);
    if bits.unsigned(0, 1) != 0 || bits.unsigned(odd, 1) != 1 {
        return Err("not an even and an odd page of Galileo");
    }
    if bits.unsigned(1, 1) == 1 || bits.unsigned(odd + 1, 1) == 1 {
        return Ok(None);
    }
    let mut covered = [0; COVERED.div_ceil(8)];
    append(&mut covered, 0, pages, 0, 114);
    append(&mut covered, 114, pages, odd, 82);
    if crc24q(&covered, COVERED) != bits.unsigned(odd + 82, 24) {
        return Err("the CRC of a Galileo page is wrong");
    }
    let mut word = [0; 16];
    append(&mut word, 0, pages, 2, 112);
    append(&mut word, 112, pages, odd + 2, 16);
    Ok(Some(word))
}

/// Words 1 to 5 of one satellite.
#[derive(Default)]
pub(super) struct Parts([Option<[u8; 16]>; 5]);

impl Parts {
    /// The orbit, where this word completes one of one issue.
    pub(super) fn take(&mut self, satellite: SatelliteId, word: &[u8; 16], near: GpsTime) -> Option<Result<Ephemeris, Reason>> {
        let number = Bits(word).unsigned(0, 6) as usize;
        let slot = self.0.get_mut(number.checked_sub(1)?)?;
        *slot = Some(*word);
        let [Some(one), Some(two), Some(three), Some(four), Some(five)] = &self.0 else { return None };
        let words = [one, two, three, four, five].map(|w| Bits(w));
        let issue = words[0].unsigned(6, 10);
        let whole = words[1..4].iter().all(|w| w.unsigned(6, 10) == issue);
        whole.then(|| ephemeris(satellite, &words, near))
    }
}

fn ephemeris(satellite: SatelliteId, words: &[Bits<'_>; 5], near: GpsTime) -> Result<Ephemeris, Reason> {
    let [one, two, three, four, five] = words;
    if four.unsigned(16, 6) != u32::from(satellite.number) {
        return Err("word 4 of a Galileo satellite names another");
    }
    let time = |w: &Bits<'_>, at| nearest_week(f64::from(w.unsigned(at, 14)) * 60.0, near, 0).ok_or("a reference time beyond the week");
    let issue = small(one, 6, 10);
    plausible(Ephemeris {
        satellite,
        message: Message::Inav,
        clock_time: time(four, 54)?,
        clock: [four.scaled(68, 31, -34), four.scaled(99, 21, -46), four.scaled(120, 6, -59)],
        orbit_time: time(one, 16)?,
        sent: Some(near),
        issue_orbit: issue,
        issue_clock: issue,
        sqrt_a: one.scaled_unsigned(94, 32, -19),
        eccentricity: one.scaled_unsigned(62, 32, -33),
        inclination: [two.scaled(48, 32, -31) * PI, two.scaled(112, 14, -43) * PI],
        node: [two.scaled(16, 32, -31) * PI, three.scaled(16, 24, -43) * PI],
        perigee: two.scaled(80, 32, -31) * PI,
        mean_anomaly: one.scaled(30, 32, -31) * PI,
        delta_n: three.scaled(40, 16, -43) * PI,
        latitude_harmonics: [three.scaled(56, 16, -29), three.scaled(72, 16, -29)],
        radius_harmonics: [three.scaled(88, 16, -5), three.scaled(104, 16, -5)],
        inclination_harmonics: [four.scaled(22, 16, -29), four.scaled(38, 16, -29)],
        accuracy_m: accuracy_m(three.unsigned(120, 8)),
        health: Health { word: health(five) },
        group_delay_s: [five.scaled(47, 10, -32), five.scaled(57, 10, -32)],
        fit_interval_s: fit_interval(Message::Inav, 0.0),
    })
}

/// Validity and health of word 5 in the places of RINEX: E1-B in bits 0 to 2, E5b in 6 to 8.
fn health(five: &Bits<'_>) -> u16 {
    let (e5b, e1b) = (small(five, 67, 2), small(five, 69, 2));
    let (e5b_data, e1b_data) = (small(five, 71, 1), small(five, 72, 1));
    e1b_data | e1b << 1 | e5b_data << 6 | e5b << 7
}

/// SISA of an index \[m\]; negative for "no accuracy prediction".
fn accuracy_m(index: u32) -> f64 {
    let n = f64::from(index);
    match index {
        0..=49 => 0.01 * n,
        50..=74 => 0.5 + 0.02 * (n - 50.0),
        75..=99 => 1.0 + 0.04 * (n - 75.0),
        100..=125 => 2.0 + 0.16 * (n - 100.0),
        _ => -1.0,
    }
}
