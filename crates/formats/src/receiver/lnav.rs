//! GPS LNAV: subframes 1 to 3 to an orbit, page 18 of subframe 4 to the ionosphere.
//!
//! Source: IS-GPS-200, section 20.3.3 and tables 20-I, 20-III, 20-X, 20-XIV (parity); standard.

use super::bits::{Bits, append};
use super::subframes::{Reason, plausible, small};
use crate::rinex::navigation::{fit_interval, nearest_week};
use core::f64::consts::PI;
use navbound_core::quantity::GpsTime;
use navbound_core::signal::{Ephemeris, Health, Klobuchar, Message, SatelliteId};

/// Data bits of ten words.
const BYTES: usize = 30;
/// Bits 29 and 30 of the word before, and the 24 data bits, that each parity bit sums: bit 31 is D29*, bit 30 D30*, then d1 first.
const PARITY: [u32; 6] = [0xBB1F_3480, 0x5D8F_9A40, 0xAEC7_CD00, 0x5763_E680, 0x6BB1_F340, 0x8B7A_89C0];

/// Whether all words have the parity of the data they show. u-blox hands words on turned by D30* as a whole, parity included; of the bits
/// before, a parity bit then sums D29* + D30* or nothing.
pub(super) fn parity_is_right(words: &[u32; 10]) -> bool {
    let (mut d29, mut d30) = (0, 0);
    words.iter().all(|word| {
        let summed = (d29 ^ d30) << 31 | (word >> 6 & 0x00ff_ffff) << 6;
        let parity = PARITY.iter().fold(0, |p, mask| p << 1 | ((summed & mask).count_ones() & 1));
        (d29, d30) = ((word >> 1 & 1) ^ d30, (word & 1) ^ d30);
        parity == word & 0x3f
    })
}

/// A subframe and when it ended.
pub(super) struct Subframe {
    number: u32,
    pub(super) end: GpsTime,
    data: [u8; BYTES],
}

impl Subframe {
    /// From ten words of 24 bits.
    pub(super) fn new(words: &[u32; 10], near: GpsTime) -> Result<Self, Reason> {
        let mut data = [0; BYTES];
        for (k, word) in words.iter().enumerate() {
            append(&mut data, 24 * k, &word.to_be_bytes(), 8, 24);
        }
        let bits = Bits(&data);
        if bits.unsigned(0, 8) != 0x8b {
            return Err("a GPS subframe without its preamble");
        }
        let number = bits.unsigned(43, 3);
        let count = bits.unsigned(24, 17);
        if !(1..=5).contains(&number) || count >= 100_800 {
            return Err("a GPS subframe without a number or a time");
        }
        let end = nearest_week(f64::from(count) * 6.0, near, 0).ok_or("no time of week")?;
        Ok(Self { number, end, data })
    }

    /// Coefficients and leap seconds of page 18.
    pub(super) fn ionosphere(&self) -> Option<(Klobuchar, i64)> {
        let b = Bits(&self.data);
        // Page 18 carries satellite identity 56.
        if self.number != 4 || b.unsigned(50, 6) != 56 {
            return None;
        }
        let alpha = [(56, -30), (64, -27), (72, -24), (80, -24)].map(|(at, e)| b.scaled(at, 8, e));
        let beta = [(88, 11), (96, 14), (104, 16), (112, 16)].map(|(at, e)| b.scaled(at, 8, e));
        Some((Klobuchar { alpha, beta }, i64::from(b.signed(192, 8))))
    }
}

/// Subframes 1 to 3 of one satellite.
#[derive(Default)]
pub(super) struct Parts([Option<[u8; BYTES]>; 3]);

impl Parts {
    /// The orbit, where this subframe completes one of one issue.
    pub(super) fn take(&mut self, satellite: SatelliteId, subframe: &Subframe) -> Option<Result<Ephemeris, Reason>> {
        let slot = self.0.get_mut(subframe.number as usize - 1)?;
        *slot = Some(subframe.data);
        let [Some(one), Some(two), Some(three)] = &self.0 else { return None };
        let (one, two, three) = (Bits(one), Bits(two), Bits(three));
        let issue = two.unsigned(48, 8);
        // The lower eight bits of the clock's issue are the orbit's.
        if issue != three.unsigned(216, 8) || issue != one.unsigned(168, 8) {
            return None;
        }
        Some(ephemeris(satellite, &one, &two, &three, subframe.end))
    }
}

fn ephemeris(satellite: SatelliteId, one: &Bits<'_>, two: &Bits<'_>, three: &Bits<'_>, sent: GpsTime) -> Result<Ephemeris, Reason> {
    let time = |b: &Bits<'_>, at| nearest_week(b.scaled_unsigned(at, 16, 4), sent, 0).ok_or("a reference time beyond the week");
    plausible(Ephemeris {
        satellite,
        message: Message::Lnav,
        clock_time: time(one, 176)?,
        clock: [one.scaled(216, 22, -31), one.scaled(200, 16, -43), one.scaled(192, 8, -55)],
        orbit_time: time(two, 216)?,
        sent: Some(sent),
        issue_orbit: small(two, 48, 8),
        issue_clock: small(one, 70, 2) << 8 | small(one, 168, 8),
        sqrt_a: two.scaled_unsigned(184, 32, -19),
        eccentricity: two.scaled_unsigned(136, 32, -33),
        inclination: [three.scaled(112, 32, -31) * PI, three.scaled(224, 14, -43) * PI],
        node: [three.scaled(64, 32, -31) * PI, three.scaled(192, 24, -43) * PI],
        perigee: three.scaled(160, 32, -31) * PI,
        mean_anomaly: two.scaled(88, 32, -31) * PI,
        delta_n: two.scaled(72, 16, -43) * PI,
        latitude_harmonics: [two.scaled(120, 16, -29), two.scaled(168, 16, -29)],
        radius_harmonics: [three.scaled(144, 16, -5), two.scaled(56, 16, -5)],
        inclination_harmonics: [three.scaled(48, 16, -29), three.scaled(96, 16, -29)],
        accuracy_m: accuracy_m(one.unsigned(60, 4)),
        health: Health { word: small(one, 64, 6) },
        group_delay_s: [one.scaled(160, 8, -31), 0.0],
        fit_interval_s: fit_interval(Message::Lnav, f64::from(two.unsigned(232, 1))),
    })
}

/// Nominal accuracy of an index, as RINEX files give it: 2^(1+n/2) to one decimal up to 6, 2^(n-2) from 7, 8192 for "at own risk".
fn accuracy_m(index: u32) -> f64 {
    let n = f64::from(index);
    if index <= 6 { (f64::powf(2.0, 1.0 + n / 2.0) * 10.0).round() / 10.0 } else { f64::powf(2.0, n - 2.0) }
}
