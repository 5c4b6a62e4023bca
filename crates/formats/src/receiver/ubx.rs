//! u-blox: RXM-RAWX and RXM-SFRBX (generations 8 and later), RXM-RAW and RXM-SFRB (before).
//!
//! Source: u-blox F9 HPG 1.50 and u-blox 6 interface descriptions; standard.

use super::bits::{f32_at, f64_at, u8_at, u16_at, u32_at};
use super::subframes::Subframes;
use super::table::{HALF_CYCLE, Measurement, Table};
use crate::time::from_week;
use navbound_core::quantity::GpsTime;
use navbound_core::signal::{Constellation, SatelliteId};

pub(super) const RAWX: [u8; 2] = [0x02, 0x15];
const SFRBX: [u8; 2] = [0x02, 0x13];
const RAW_OLD: [u8; 2] = [0x02, 0x10];
const SFRB_OLD: [u8; 2] = [0x02, 0x11];

/// Messages of measurements.
pub(super) const MEASUREMENTS: [[u8; 2]; 2] = [RAWX, RAW_OLD];
/// Messages that are read.
pub(super) const RAW: [[u8; 2]; 4] = [RAWX, SFRBX, RAW_OLD, SFRB_OLD];

/// A pseudorange beyond this is none \[m\]: three times the way to a geostationary satellite. Provenance: ours.
const FARTHEST_M: f64 = 1.2e8;

pub(super) fn take(kind: [u8; 2], payload: &[u8], table: &mut Table, subframes: &mut Subframes) {
    let whole = match kind {
        RAWX => rawx(payload, table),
        SFRBX => sfrbx(payload, table, subframes),
        RAW_OLD => raw(payload, table),
        SFRB_OLD => sfrb(payload, table, subframes),
        _ => Some(()),
    };
    if whole.is_none() {
        table.refuse("payload", "the message is shorter than it says");
    }
}

fn rawx(p: &[u8], table: &mut Table) -> Option<()> {
    let (tow_s, week, count) = (f64_at(p, 0)?, u16_at(p, 8)?, u8_at(p, 11)?);
    // Version 0 has no signal identifiers: one signal a satellite. What another version holds where is not known.
    let single = match u8_at(p, 13)? {
        0 => true,
        1 => false,
        version => {
            table.lose(&format!("version {version} of RXM-RAWX, of which 0 and 1 are read"));
            return Some(());
        }
    };
    let Some(time) = time(week, tow_s) else {
        table.refuse("rcvTow, week", "not a time: the receiver does not know it yet");
        return Some(());
    };
    let mut measurements = Vec::with_capacity(usize::from(count));
    for k in 0..usize::from(count) {
        let m = p.get(16 + 32 * k..48 + 32 * k)?;
        let (system, number) = (u8_at(m, 20)?, u8_at(m, 21)?);
        let signal = if single { 0 } else { u8_at(m, 22)? };
        match (satellite(system, number), signal_of(system, signal)) {
            (Some(satellite), Some(signal)) => measurements.extend(measurement(m, satellite, signal, table)),
            (Some(_), None) => table.skip(&format!("signal {signal} of system {system}")),
            (None, _) => table.skip(&skipped(system)),
        }
    }
    table.epoch(time, measurements);
    Some(())
}

fn measurement(m: &[u8], satellite: SatelliteId, signal: [u8; 2], table: &mut Table) -> Option<Measurement> {
    let (range_m, phase, doppler) = (f64_at(m, 0)?, f64_at(m, 8)?, f64::from(f32_at(m, 16)?));
    let (locked_ms, cn0, status) = (u32::from(u16_at(m, 24)?), u8_at(m, 26)?, u8_at(m, 30)?);
    let flag = |bit: u8| status >> bit & 1 == 1;
    let lost = table.lost(satellite, signal, locked_ms);
    let range_m = checked_range(flag(0).then_some(range_m), table);
    Some(Measurement {
        satellite,
        signal,
        range_m,
        phase_cycles: if flag(1) && phase.is_finite() && phase != 0.0 { phase } else { f64::NAN },
        doppler_hz: if doppler.is_finite() { doppler } else { f64::NAN },
        cn0_dbhz: if cn0 == 0 { f64::NAN } else { f64::from(cn0) },
        indicator: lost | if flag(2) { 0 } else { HALF_CYCLE },
    })
}

/// NaN for a range that is absent, and for one that cannot be, which is refused.
fn checked_range(range_m: Option<f64>, table: &mut Table) -> f64 {
    match range_m {
        Some(r) if r > 0.0 && r < FARTHEST_M => r,
        Some(_) => {
            table.refuse("prMes", "a valid pseudorange outside (0, 1.2e8) m");
            f64::NAN
        }
        None => f64::NAN,
    }
}

fn sfrbx(p: &[u8], table: &mut Table, subframes: &mut Subframes) -> Option<()> {
    let (system, number, signal, count) = (u8_at(p, 0)?, u8_at(p, 1)?, u8_at(p, 2)?, usize::from(u8_at(p, 4)?));
    let words: Vec<u32> = (0..count).map(|k| u32_at(p, 8 + 4 * k)).collect::<Option<_>>()?;
    let Some(satellite) = satellite(system, number) else {
        table.skip(&format!("subframes of {}", letter(system)));
        return Some(());
    };
    let Some(near) = table.time() else {
        table.skip("subframes before the first epoch");
        return Some(());
    };
    // Signal 0 also where generation 8 has no such field; Galileo's E1-B and E5b carry the same message.
    let taken = match (satellite.constellation, signal, words.as_slice()) {
        (Constellation::Gps, 0, [w0, w1, w2, w3, w4, w5, w6, w7, w8, w9]) => {
            subframes.gps(satellite, &[*w0, *w1, *w2, *w3, *w4, *w5, *w6, *w7, *w8, *w9], near)
        }
        (Constellation::Galileo, 0 | 1 | 5, [w0, w1, w2, w3, w4, w5, w6, w7]) => {
            let bytes = bytes(&[*w0, *w1, *w2, *w3, *w4, *w5, *w6, *w7]);
            // The odd page begins with the fifth word.
            subframes.galileo(satellite, &bytes, 128, near)
        }
        (Constellation::Sbas, 0, [w0, w1, w2, w3, w4, w5, w6, w7, ..]) => {
            subframes.sbas(satellite, bytes(&[*w0, *w1, *w2, *w3, *w4, *w5, *w6, *w7]), near)
        }
        (constellation, signal, _) => {
            table.skip(&format!("subframes of {}, signal {signal}", constellation.letter()));
            Ok(())
        }
    };
    if let Err(reason) = taken {
        table.refuse("subframe", reason);
    }
    Some(())
}

fn raw(p: &[u8], table: &mut Table) -> Option<()> {
    let (tow_ms, week, count) = (u32_at(p, 0)?, u16_at(p, 4)?, u8_at(p, 6)?);
    let Some(time) = time(week, f64::from(tow_ms) / 1e3) else {
        table.refuse("iTOW, week", "not a time: the receiver does not know it yet");
        return Some(());
    };
    let mut messages = Vec::new();
    for k in 0..usize::from(count) {
        let m = p.get(8 + 24 * k..32 + 24 * k)?;
        let (phase, range_m, doppler, number) = (f64_at(m, 0)?, f64_at(m, 8)?, f64::from(f32_at(m, 16)?), u8_at(m, 20)?);
        let (quality, cn0, lock) = (u8_at(m, 21)? as i8, u8_at(m, 22)?, u8_at(m, 23)?);
        let Some(satellite) = satellite_by_prn(number) else {
            table.skip("satellites of other systems");
            continue;
        };
        // Quality 4 and above: code locked; 6 and above: carrier locked.
        let range_m = checked_range((quality >= 4 && range_m != 0.0).then_some(range_m), table);
        messages.push(Measurement {
            satellite,
            signal: *b"1C",
            range_m,
            phase_cycles: if quality >= 6 && phase.is_finite() && phase != 0.0 { phase } else { f64::NAN },
            doppler_hz: if doppler.is_finite() { doppler } else { f64::NAN },
            cn0_dbhz: if cn0 == 0 { f64::NAN } else { f64::from(cn0) },
            indicator: (lock & 0b11) << 4,
        });
    }
    table.epoch(time, messages);
    Some(())
}

fn sfrb(p: &[u8], table: &mut Table, subframes: &mut Subframes) -> Option<()> {
    let number = u8_at(p, 1)?;
    let mut words = [0; 10];
    for (k, word) in words.iter_mut().enumerate() {
        *word = u32_at(p, 2 + 4 * k)?;
    }
    let (Some(satellite), Some(near)) = (satellite_by_prn(number), table.time()) else {
        table.skip(if table.time().is_none() { "subframes before the first epoch" } else { "subframes of other systems" });
        return Some(());
    };
    let taken = match satellite.constellation {
        Constellation::Gps => subframes.gps_without_parity(satellite, &words, near),
        _ => {
            // 250 bits: seven words, and 26 bits right-aligned in the eighth.
            let [w0, w1, w2, w3, w4, w5, w6, w7, ..] = words;
            subframes.sbas(satellite, bytes(&[w0, w1, w2, w3, w4, w5, w6, w7 << 6]), near)
        }
    };
    if let Err(reason) = taken {
        table.refuse("subframe", reason);
    }
    Some(())
}

/// Words of 32 bits as bytes, first bit first.
fn bytes(words: &[u32; 8]) -> [u8; 32] {
    let mut bytes = [0; 32];
    for (four, word) in bytes.as_chunks_mut::<4>().0.iter_mut().zip(words) {
        *four = word.to_be_bytes();
    }
    bytes
}

fn time(week: u16, tow_s: f64) -> Option<GpsTime> {
    // A week of zero is the receiver's before it has decoded one.
    if !(week > 0 && (0.0..604_801.0).contains(&tow_s)) {
        return None;
    }
    from_week(i64::from(week), (tow_s * 1e9).round() as i64)
}

pub(super) fn satellite(system: u8, number: u8) -> Option<SatelliteId> {
    let (constellation, numbers, less) = match system {
        0 => (Constellation::Gps, 1..=32, 0),
        1 => (Constellation::Sbas, 120..=158, 100),
        2 => (Constellation::Galileo, 1..=36, 0),
        3 => (Constellation::BeiDou, 1..=63, 0),
        // 255: heard, number not known.
        6 => (Constellation::Glonass, 1..=32, 0),
        _ => return None,
    };
    numbers.contains(&number).then(|| SatelliteId { constellation, number: number - less })
}

fn satellite_by_prn(number: u8) -> Option<SatelliteId> {
    satellite(if number <= 32 { 0 } else { 1 }, number)
}

/// Band and attribute of a signal.
pub(super) fn signal_of(system: u8, signal: u8) -> Option<[u8; 2]> {
    let name = match (system, signal) {
        (0 | 1 | 2 | 6, 0) => b"1C",
        (0, 3) => b"2L",
        (0, 4) => b"2S",
        (0, 6) => b"5I",
        (0, 7) => b"5Q",
        (2, 1) => b"1B",
        (2, 3) => b"5I",
        (2, 4) => b"5Q",
        (2, 5) => b"7I",
        (2, 6) => b"7Q",
        (2, 8) => b"6B",
        (2, 9) => b"6C",
        (3, 0 | 1) => b"2I",
        (3, 2 | 3) => b"7I",
        (3, 4 | 10) => b"6I",
        (3, 5) => b"1P",
        (3, 6) => b"1D",
        (3, 7) => b"5P",
        (3, 8) => b"5D",
        (6, 2) => b"2C",
        _ => return None,
    };
    Some(*name)
}

fn letter(system: u8) -> char {
    match system {
        0 => 'G',
        1 => 'S',
        2 => 'E',
        3 => 'C',
        5 => 'J',
        6 => 'R',
        7 => 'I',
        _ => '?',
    }
}

fn skipped(system: u8) -> String {
    match system {
        5 | 7 => format!("satellites of {}", letter(system)),
        _ => format!("satellites of {} without a number", letter(system)),
    }
}
