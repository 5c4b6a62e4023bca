//! u-blox: NAV-PVT with NAV-COV and NAV-TIMEGPS of the same epoch.
//!
//! Source: u-blox F9 HPG interface description (UBX protocol); standard. The rules are those of the reader of files.
//!
//! An epoch is complete at NAV-EOE, at the message that was the last of the epoch before it, or when a message of the next one comes.

use super::Decoded;
use crate::codec::{Damaged, Reader, Writer};
use crate::counters::Refused;
use crate::position::{Position, TrackId};
use navbound_core::quantity::{GpsTime, Reason, Status};
use navbound_formats::time::{Calendar, Scale, from_calendar, from_week};

const PVT: [u8; 2] = [0x01, 0x07];
const TIME_GPS: [u8; 2] = [0x01, 0x20];
const COV: [u8; 2] = [0x01, 0x36];
const END: [u8; 2] = [0x01, 0x61];
/// 3-D, and 3-D with dead reckoning.
const FIXES: [u8; 2] = [3, 4];

/// Messages of one time of week.
#[derive(Debug, Clone, Default)]
pub(super) struct Epochs {
    itow_ms: Option<u32>,
    pvt: Option<Vec<u8>>,
    time: Option<Vec<u8>>,
    cov: Option<Vec<u8>>,
    /// The newest message of this epoch, and the last of the one before.
    newest: [u8; 2],
    last: [u8; 2],
}

impl Epochs {
    pub(super) fn take(&mut self, kind: [u8; 2], payload: &[u8], track: TrackId, out: &mut Vec<Decoded>) {
        if ![PVT, TIME_GPS, COV, END].contains(&kind) {
            return;
        }
        let shortest = match kind {
            PVT => 84,
            TIME_GPS => 16,
            COV => 64,
            _ => 4,
        };
        let (Some(itow_ms), true) = (u32_at(payload, 0), payload.len() >= shortest) else {
            out.push(Err(Refused::ShortMessage));
            return;
        };
        if self.itow_ms != Some(itow_ms) {
            out.extend(self.finish(track));
            (self.itow_ms, self.last) = (Some(itow_ms), self.newest);
        }
        match kind {
            PVT => self.pvt = Some(payload.to_vec()),
            TIME_GPS => self.time = Some(payload.to_vec()),
            COV => self.cov = Some(payload.to_vec()),
            _ => {}
        }
        self.newest = kind;
        if kind == END || kind == self.last {
            out.extend(self.finish(track));
        }
    }

    /// The epoch as it is.
    pub(super) fn finish(&mut self, track: TrackId) -> Option<Decoded> {
        let (pvt, time, cov) = (self.pvt.take(), self.time.take(), self.cov.take());
        position(&pvt?, time.as_deref(), cov.as_deref(), track)
    }

    pub(super) fn write(&self, to: &mut Writer) {
        to.option(self.itow_ms, Writer::u32);
        for message in [&self.pvt, &self.time, &self.cov] {
            to.option(message.as_deref(), Writer::bytes);
        }
        [self.newest, self.last].as_flattened().iter().for_each(|byte| to.u8(*byte));
    }

    pub(super) fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        let itow_ms = from.option(Reader::u32)?;
        let mut message = || from.option(|from| from.bytes().map(<[u8]>::to_vec));
        let (pvt, time, cov) = (message()?, message()?, message()?);
        let [newest, last] = [[from.u8()?, from.u8()?], [from.u8()?, from.u8()?]];
        Ok(Self { itow_ms, pvt, time, cov, newest, last })
    }
}

fn position(pvt: &[u8], time: Option<&[u8]>, cov: Option<&[u8]>, track: TrackId) -> Option<Decoded> {
    let Some(time) = time.and_then(gps_time).or_else(|| utc(pvt)) else { return Some(Err(Refused::Undated)) };
    // Divided, a number of tenths is the nearest double to what the message says.
    let degrees = |at: usize| i32_at(pvt, at).map(|value| (f64::from(value) / 1e7).to_radians());
    let (fix, flags, invalid) = (*pvt.get(20)?, *pvt.get(21)?, pvt.get(78)? & 1 == 1);
    let sound = FIXES.contains(&fix) && flags & 1 == 1 && !invalid;
    let position = Position {
        lat_rad: degrees(28),
        lon_rad: degrees(24),
        h_m: i32_at(pvt, 32).map(|mm| f64::from(mm) * 1e-3),
        covariance_m2: cov.and_then(covariance).or_else(|| of_accuracies(pvt)),
        status: if sound { Status::Ok } else { Status::NotAvailable },
        reason: (!sound).then_some(Reason::Reported),
        ..Position::new(track, time)
    };
    Some(Ok(position))
}

/// GPS time of NAV-TIMEGPS, where week and time of week are both valid.
fn gps_time(message: &[u8]) -> Option<GpsTime> {
    let (itow_ms, ftow_ns, week) = (u32_at(message, 0)?, i32_at(message, 4)?, i16::from_le_bytes(*message.get(8..)?.first_chunk()?));
    if message.get(11)? & 0b11 != 0b11 || week <= 0 {
        return None;
    }
    from_week(i64::from(week), i64::from(itow_ms) * 1_000_000 + i64::from(ftow_ns))
}

/// UTC of NAV-PVT, where date, time and leap seconds are known.
fn utc(pvt: &[u8]) -> Option<GpsTime> {
    if pvt.get(11)? & 0b111 != 0b111 {
        return None;
    }
    let whole = Calendar {
        year: i32::from(u16::from_le_bytes(*pvt.get(4..)?.first_chunk()?)),
        month: *pvt.get(6)?,
        day: *pvt.get(7)?,
        hour: *pvt.get(8)?,
        minute: *pvt.get(9)?,
        nanoseconds: i64::from(*pvt.get(10)?) * 1_000_000_000,
    };
    // The fraction may be negative.
    let nano = i64::from(i32_at(pvt, 16)?);
    from_calendar(whole, Scale::Utc).map(|time| GpsTime::from_nanoseconds(time.nanoseconds() + nano))
}

/// NAV-COV is north-east-down.
fn covariance(message: &[u8]) -> Option<[f64; 6]> {
    if *message.get(5)? == 0 {
        return None;
    }
    let term = |at: usize| message.get(at..)?.first_chunk().map(|bytes| f64::from(f32::from_le_bytes(*bytes)));
    let [nn, ne, nd, ee, ed, dd] = [term(16)?, term(20)?, term(24)?, term(28)?, term(32)?, term(36)?];
    Some([ee, ne, nn, -ed, -nd, dd])
}

/// A circle: hAcc is the root of both horizontal variances together.
fn of_accuracies(pvt: &[u8]) -> Option<[f64; 6]> {
    let variance = |at: usize| u32_at(pvt, at).map(|mm| (f64::from(mm) * 1e-3) * (f64::from(mm) * 1e-3));
    let (h, v) = (variance(40)? / 2.0, variance(44)?);
    Some([h, 0.0, h, 0.0, 0.0, v])
}

fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    bytes.get(at..)?.first_chunk().map(|bytes| u32::from_le_bytes(*bytes))
}

fn i32_at(bytes: &[u8], at: usize) -> Option<i32> {
    bytes.get(at..)?.first_chunk().map(|bytes| i32::from_le_bytes(*bytes))
}
