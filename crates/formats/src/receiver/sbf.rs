//! Septentrio: MeasEpoch, GEORawL1, GPSRawCA, GALRawINAV.
//!
//! Source: Septentrio SBF reference guide (mosaic-X5 4.14), blocks 4027, 4020, 4017 and 4023; standard.

use super::bits::{i32_at, u8_at, u16_at, u32_at};
use super::subframes::Subframes;
use super::table::{HALF_CYCLE, Measurement, Table};
use crate::time::from_week;
use navbound_core::quantity::GpsTime;
use navbound_core::signal::{Carrier, Constellation, SPEED_OF_LIGHT_MPS, SatelliteId};

const MEAS_EPOCH: u16 = 4027;
const GPS_RAW_CA: u16 = 4017;
const GEO_RAW_L1: u16 = 4020;
const GAL_RAW_INAV: u16 = 4023;

/// Blocks that are read.
/// Those of measurements.
pub(super) const MEASUREMENTS: [u16; 1] = [MEAS_EPOCH];
pub(super) const RAW: [u16; 4] = [MEAS_EPOCH, GPS_RAW_CA, GEO_RAW_L1, GAL_RAW_INAV];

/// Bytes of a block before its own fields: time of week and week; its body begins here.
const BODY: usize = 6;
/// Values that mean "do not use".
const UNKNOWN_TOW: u32 = 0xFFFF_FFFF;
const UNKNOWN_WEEK: u16 = 0xFFFF;
/// Measurements with this flag of an epoch are scrambled.
const SCRAMBLED: u8 = 0x80;
/// GLONASS frequency numbers are sent with this added.
const GLONASS_CHANNEL: i32 = 8;

pub(super) fn take(block: u16, body: &[u8], table: &mut Table, subframes: &mut Subframes) {
    if !RAW.contains(&block) {
        return;
    }
    let Some((tow_ms, week)) = u32_at(body, 0).zip(u16_at(body, 4)) else {
        table.refuse("block", "the block is shorter than its header");
        return;
    };
    let time = if tow_ms == UNKNOWN_TOW || week == UNKNOWN_WEEK { None } else { from_week(i64::from(week), i64::from(tow_ms) * 1_000_000) };
    let Some(time) = time else {
        table.refuse("TOW, WNc", "not a time: the receiver does not know it yet");
        return;
    };
    let whole = if block == MEAS_EPOCH { epoch(body, time, table) } else { navigation(block, body, time, table, subframes) };
    if whole.is_none() {
        table.refuse("block", "the block is shorter than it says");
    }
}

fn epoch(body: &[u8], time: GpsTime, table: &mut Table) -> Option<()> {
    let (count, first_bytes, second_bytes) = (u8_at(body, BODY)?, usize::from(u8_at(body, BODY + 1)?), usize::from(u8_at(body, BODY + 2)?));
    if u8_at(body, BODY + 3)? & SCRAMBLED != 0 {
        table.refuse("CommonFlags", "the measurements are scrambled");
        return Some(());
    }
    let (mut at, mut measurements) = (BODY + 6, Vec::new());
    for _ in 0..count {
        let first = body.get(at..at + first_bytes)?;
        at += first_bytes;
        let master = Master::new(first)?;
        measurements.extend(master.as_ref().and_then(|m| m.measurement(table)));
        if master.is_none() {
            table.skip("satellites or signals of other systems");
        }
        for _ in 0..u8_at(first, 19)? {
            let second = body.get(at..at + second_bytes)?;
            at += second_bytes;
            if let Some(master) = &master {
                match master.slave(second, table)? {
                    Some(slave) => measurements.push(slave),
                    None => table.skip("signals without a place in RINEX"),
                }
            }
        }
    }
    table.epoch(time, measurements);
    Some(())
}

/// First signal of a satellite, on which the others are based.
struct Master {
    satellite: SatelliteId,
    signal: Signal,
    range_m: f64,
    phase_cycles: f64,
    doppler_hz: f64,
    cn0_dbhz: f64,
    locked_ms: u32,
    half_cycle: bool,
    channel: i32,
}

impl Master {
    /// `None` for a block cut short; `Some(None)` for a satellite or signal that is not read.
    #[expect(clippy::option_option, reason = "cut short, or not read")]
    fn new(b: &[u8]) -> Option<Option<Self>> {
        let (kind, number, misc, low) = (u8_at(b, 1)?, u8_at(b, 2)?, u8_at(b, 3)?, u32_at(b, 4)?);
        let (doppler, carrier_low, carrier_high) = (i32_at(b, 8)?, u16_at(b, 12)?, u8_at(b, 14)? as i8);
        let (cn0, locked_s, info) = (u8_at(b, 15)?, u16_at(b, 16)?, u8_at(b, 18)?);
        u8_at(b, 19)?;
        let channel = i32::from(info >> 3) - GLONASS_CHANNEL;
        let Some((satellite, signal)) = satellite(number).zip(Signal::new(kind, info, channel)) else { return Some(None) };
        let high = misc & 0xf;
        let range_m = if high == 0 && low == 0 { f64::NAN } else { (f64::from(high) * 4_294_967_296.0 + f64::from(low)) * 1e-3 };
        Some(Some(Self {
            satellite,
            signal,
            range_m,
            phase_cycles: phase(range_m, carrier_high, carrier_low, &signal),
            doppler_hz: if doppler == i32::MIN { f64::NAN } else { f64::from(doppler) * 1e-4 },
            cn0_dbhz: signal.cn0(cn0),
            locked_ms: lock_ms(u32::from(locked_s), 65_535),
            half_cycle: info & 0b100 != 0,
            channel,
        }))
    }

    fn measurement(&self, table: &mut Table) -> Option<Measurement> {
        let lost = table.lost(self.satellite, self.signal.name, self.locked_ms);
        Some(Measurement {
            satellite: self.satellite,
            signal: self.signal.name,
            range_m: self.range_m,
            phase_cycles: self.phase_cycles,
            doppler_hz: self.doppler_hz,
            cn0_dbhz: self.cn0_dbhz,
            indicator: lost | if self.half_cycle { HALF_CYCLE } else { 0 },
        })
    }

    /// Another signal: range and Doppler as differences. `None` for a block cut short; `Some(None)` for a signal that is not read.
    #[expect(clippy::option_option, reason = "cut short, or not read")]
    fn slave(&self, b: &[u8], table: &mut Table) -> Option<Option<Measurement>> {
        let (kind, locked_s, cn0, high) = (u8_at(b, 0)?, u8_at(b, 1)?, u8_at(b, 2)?, u8_at(b, 3)?);
        let (carrier_high, info) = (u8_at(b, 4)? as i8, u8_at(b, 5)?);
        let (code_low, carrier_low, doppler_low) = (u16_at(b, 6)?, u16_at(b, 8)?, u16_at(b, 10)?);
        let Some(signal) = Signal::new(kind, info, self.channel) else { return Some(None) };
        // Three bits of code offset, five of Doppler offset, each with a sign.
        let code_high = i32::from((high << 5) as i8 >> 5);
        let doppler_high = i32::from(high as i8 >> 3);
        let offset = |high: i32, low: u16| f64::from(high * 65_536 + i32::from(low));
        let range_m = if code_high == -4 && code_low == 0 { f64::NAN } else { self.range_m + offset(code_high, code_low) * 1e-3 };
        let ratio = signal.frequency_hz / self.signal.frequency_hz;
        let doppler_hz = if doppler_high == -16 && doppler_low == 0 {
            f64::NAN
        } else {
            self.doppler_hz * ratio + offset(doppler_high, doppler_low) * 1e-4
        };
        let lost = table.lost(self.satellite, signal.name, lock_ms(u32::from(locked_s), 255));
        Some(Some(Measurement {
            satellite: self.satellite,
            signal: signal.name,
            range_m,
            phase_cycles: phase(range_m, carrier_high, carrier_low, &signal),
            doppler_hz,
            cn0_dbhz: signal.cn0(cn0),
            indicator: lost | if info & 0b100 != 0 { HALF_CYCLE } else { 0 },
        }))
    }
}

/// Time of lock; the largest value means "unknown". A receiver counts whole seconds, so none is less than one second, not a loss.
fn lock_ms(seconds: u32, unknown: u32) -> u32 {
    if seconds == unknown { u32::MAX } else { 1000 * seconds + 1 }
}

fn phase(range_m: f64, high: i8, low: u16, signal: &Signal) -> f64 {
    if high == i8::MIN && low == 0 {
        return f64::NAN;
    }
    range_m * signal.frequency_hz / SPEED_OF_LIGHT_MPS + f64::from(i32::from(high) * 65_536 + i32::from(low)) * 1e-3
}

#[derive(Clone, Copy)]
struct Signal {
    number: u8,
    name: [u8; 2],
    frequency_hz: f64,
}

impl Signal {
    /// `kind`: number of the signal in bits 0 to 4, or 31 and the rest in bits 3 to 7 of `info`.
    fn new(kind: u8, info: u8, channel: i32) -> Option<Self> {
        let number = match kind & 0x1f {
            31 => 32 + (info >> 3),
            number => number,
        };
        let (constellation, name) = name(number)?;
        let own = |base: f64, step: f64| (base + step * f64::from(channel)) * 1e6;
        let frequency_hz = match (constellation, name[0]) {
            (Constellation::Glonass, b'1') => own(1602.0, 0.5625),
            (Constellation::Glonass, b'2') => own(1246.0, 0.4375),
            (Constellation::Glonass, _) => 1_202.025e6,
            (Constellation::Galileo, b'8') => 1_191.795e6,
            (constellation, band) => Carrier::from_band(constellation, band)?.frequency_hz(),
        };
        Some(Self { number, name: *name, frequency_hz })
    }
    fn cn0(self, value: u8) -> f64 {
        // The two codes that are encrypted are weak: their scale begins at zero.
        let base = if matches!(self.number, 1 | 2) { 0.0 } else { 10.0 };
        if value == 255 { f64::NAN } else { 0.25 * f64::from(value) + base }
    }
}

fn name(number: u8) -> Option<(Constellation, &'static [u8; 2])> {
    use Constellation::{BeiDou, Galileo, Glonass, Gps, Sbas};
    Some(match number {
        0 => (Gps, b"1C"),
        1 => (Gps, b"1W"),
        2 => (Gps, b"2W"),
        3 => (Gps, b"2L"),
        4 => (Gps, b"5Q"),
        5 => (Gps, b"1L"),
        8 => (Glonass, b"1C"),
        9 => (Glonass, b"1P"),
        10 => (Glonass, b"2P"),
        11 => (Glonass, b"2C"),
        12 => (Glonass, b"3X"),
        13 => (BeiDou, b"1P"),
        14 => (BeiDou, b"5P"),
        17 => (Galileo, b"1C"),
        19 => (Galileo, b"6C"),
        20 => (Galileo, b"5Q"),
        21 => (Galileo, b"7Q"),
        22 => (Galileo, b"8Q"),
        24 => (Sbas, b"1C"),
        25 => (Sbas, b"5I"),
        28 => (BeiDou, b"2I"),
        29 => (BeiDou, b"7I"),
        30 => (BeiDou, b"6I"),
        34 => (BeiDou, b"7D"),
        _ => return None,
    })
}

fn satellite(number: u8) -> Option<SatelliteId> {
    let (constellation, less) = match number {
        1..=37 => (Constellation::Gps, 0),
        38..=61 => (Constellation::Glonass, 37),
        63..=68 => (Constellation::Glonass, 38),
        71..=106 => (Constellation::Galileo, 70),
        120..=140 => (Constellation::Sbas, 100),
        141..=180 => (Constellation::BeiDou, 140),
        // PRN 141 to 158, of which RINEX drops the hundred.
        198..=215 => (Constellation::Sbas, 157),
        223..=245 => (Constellation::BeiDou, 182),
        _ => return None,
    };
    Some(SatelliteId { constellation, number: number - less })
}

/// Bits of a message as received; its block is dated when the last of them came.
fn navigation(block: u16, body: &[u8], time: GpsTime, table: &mut Table, subframes: &mut Subframes) -> Option<()> {
    let (number, right) = (u8_at(body, BODY)?, u8_at(body, BODY + 1)?);
    let bits = body.get(BODY + 6..)?;
    let word = |k: usize| u32_at(bits, 4 * k);
    let Some(satellite) = satellite(number) else {
        table.skip("subframes of other systems");
        return Some(());
    };
    if right == 0 {
        table.refuse("CRCPassed", "the receiver found the message wrong");
        return Some(());
    }
    let taken = if block == GPS_RAW_CA {
        let mut words = [0; 10];
        for (k, each) in words.iter_mut().enumerate() {
            *each = word(k)? >> 6;
        }
        // The receiver has checked the parity and says so.
        subframes.gps_without_parity(satellite, &words, time)
    } else {
        let mut bytes = [0; 32];
        for (k, four) in bytes.as_chunks_mut::<4>().0.iter_mut().enumerate() {
            *four = word(k)?.to_be_bytes();
        }
        // Without the tail of the even page, its odd one begins with the 115th bit.
        if block == GAL_RAW_INAV { subframes.galileo(satellite, &bytes, 114, time) } else { subframes.sbas(satellite, bytes, time) }
    };
    if let Err(reason) = taken {
        table.refuse("NAVBits", reason);
    }
    Some(())
}
