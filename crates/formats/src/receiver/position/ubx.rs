//! u-blox: NAV-PVT with NAV-COV, NAV-DOP, NAV-PL and NAV-TIMEGPS of the same time of week.
//!
//! Source: u-blox F9 HPG interface description (UBX protocol); standard. Positions are WGS-84, variances north-east-down in m².

use super::decoder::Step;
use super::epoch::{Message, of_kind};
use super::{Absent, Fields, Note, Position, Reason, no_better};
use crate::measured::LEAST_SATELLITES;
use crate::receiver::bits::{f32_at, i16_at, i32_at, u8_at, u16_at, u32_at};
use crate::time::{Calendar, Scale, from_calendar, from_week};
use navbound_core::quantity::GpsTime;

const DOP: u32 = 0x0104;
const PVT: u32 = 0x0107;
const TIME_GPS: u32 = 0x0120;
const COV: u32 = 0x0136;
const END: u32 = 0x0161;
const PL: u32 = 0x0162;
/// 3-D, and 3-D with dead reckoning.
const FIXES: [u8; 2] = [ALONE, 4];
/// 3-D by satellites alone.
const ALONE: u8 = 3;
/// Frame of NAV-PL: semi-major and semi-minor axis of the horizontal ellipse, and vertical.
const ELLIPSE: u8 = 3;

const FIELDS: Fields =
    &[("est_lat_rad", "NAV-PVT lat"), ("est_lon_rad", "NAV-PVT lon"), ("est_h_m", "NAV-PVT height"), ("time", "NAV-TIMEGPS or NAV-PVT")];

pub(super) fn step([class, id]: [u8; 2], payload: &[u8]) -> Step {
    let kind = u32::from(u16::from_be_bytes([class, id]));
    let (shortest, short) = match kind {
        DOP => (18, "NAV-DOP is shorter than its definition"),
        PVT => (84, "NAV-PVT is shorter than its definition"),
        TIME_GPS => (16, "NAV-TIMEGPS is shorter than its definition"),
        COV => (64, "NAV-COV is shorter than its definition"),
        PL => (52, "NAV-PL is shorter than its definition"),
        END => (4, "NAV-EOE is shorter than its definition"),
        _ => return Step::Passed,
    };
    // NAV-PL keeps its time of week behind twelve other bytes.
    let itow_ms = u32_at(payload, if kind == PL { 12 } else { 0 });
    match itow_ms.map(i64::from) {
        Some(key) if payload.len() >= shortest && kind == END => Step::End { key, kind },
        Some(key) if payload.len() >= shortest => Step::Part { key, kind },
        _ => Step::Malformed(short),
    }
}

/// One navigation epoch.
pub(super) fn position(messages: &[Message]) -> Option<Position> {
    let body = |kind| of_kind(messages, kind).map(|message| message.body.as_slice());
    let (record, pvt) = of_kind(messages, PVT).map(|message| (message.record, message.body.as_slice()))?;
    let time = body(TIME_GPS).and_then(gps_time).or_else(|| utc(pvt));
    let levels = body(PL).and_then(levels);
    let accuracies = of_accuracies(pvt);
    let exact = body(COV).and_then(covariance).map(|exact| no_better(exact, accuracies));
    // Divided, a number of decimals is the nearest double to what the message says.
    let degrees = |at: usize, parts: f64| i32_at(pvt, at).map(|value| (f64::from(value) / parts).to_radians());
    let metres = |at: usize| i32_at(pvt, at).map(|mm| f64::from(mm) * 1e-3);
    let dop = |at: usize| body(DOP).and_then(|dop| u16_at(dop, at)).map(|value| f64::from(value) / 100.0);
    Some(Position {
        record,
        time,
        lat_rad: degrees(28, 1e7),
        lon_rad: degrees(24, 1e7),
        h_m: metres(32),
        covariance_m2: exact.map(|(covariance, _)| covariance).or(accuracies),
        ground_speed_mps: metres(60),
        ground_track_rad: degrees(64, 1e5),
        vertical_rate_mps: metres(56).map(|down| -down),
        n_sv: u8_at(pvt, 23).map(u32::from),
        hdop: dop(12),
        vdop: dop(10),
        pdop: u16_at(pvt, 76).map(|value| f64::from(value) / 100.0),
        hpl_m: levels.map(|(hpl, _, _)| hpl),
        vpl_m: levels.map(|(_, vpl, _)| vpl),
        absent: absent(pvt, time),
        fields: FIELDS,
        covariance_from: Some(if exact.is_some() { "NAV-COV" } else { "NAV-PVT hAcc, vAcc" }),
        levels_from: if levels.is_some() { &[("hpl_m", "NAV-PL"), ("vpl_m", "NAV-PL")] } else { &[] },
        notes: [
            match exact {
                None => Some(Note::CircularCovariance),
                Some((_, enlarged)) => enlarged.then_some(Note::WorseAccuracy),
            },
            levels.map(|(_, _, note)| note),
        ],
        ..Position::default()
    })
}

fn absent(pvt: &[u8], time: Option<GpsTime>) -> Option<Absent> {
    let (valid, fix, flags, satellites) = (u8_at(pvt, 11)?, u8_at(pvt, 20)?, u8_at(pvt, 21)?, u32::from(u8_at(pvt, 23)?));
    let reason = if time.is_none() {
        Reason::TimeNotValid
    } else if !FIXES.contains(&fix) || flags & 1 == 0 {
        Reason::NoFix3d
    } else if u8_at(pvt, 78)? & 1 == 1 {
        Reason::MarkedInvalid
    } else if fix == ALONE && satellites < LEAST_SATELLITES {
        Reason::Contradicted
    } else {
        return None;
    };
    let valid_time = valid >> 1 & 1;
    Some(Absent { reason, stated: format!("fixType {fix}, gnssFixOk {}, validTime {valid_time}, numSV {satellites}", flags & 1) })
}

/// GPS time of NAV-TIMEGPS, where week and time of week are both valid.
fn gps_time(message: &[u8]) -> Option<GpsTime> {
    let (itow_ms, ftow_ns, week) = (u32_at(message, 0)?, i32_at(message, 4)?, i16_at(message, 8)?);
    if u8_at(message, 11)? & 0b11 != 0b11 || week <= 0 {
        return None;
    }
    from_week(i64::from(week), i64::from(itow_ms) * 1_000_000 + i64::from(ftow_ns))
}

/// UTC of NAV-PVT, where date, time and leap seconds are known.
fn utc(pvt: &[u8]) -> Option<GpsTime> {
    if u8_at(pvt, 11)? & 0b111 != 0b111 {
        return None;
    }
    let whole = Calendar {
        year: i32::from(u16_at(pvt, 4)?),
        month: u8_at(pvt, 6)?,
        day: u8_at(pvt, 7)?,
        hour: u8_at(pvt, 8)?,
        minute: u8_at(pvt, 9)?,
        nanoseconds: i64::from(u8_at(pvt, 10)?) * 1_000_000_000,
    };
    // The fraction may be negative.
    let nano = i64::from(i32_at(pvt, 16)?);
    from_calendar(whole, Scale::Utc).map(|time| GpsTime::from_nanoseconds(time.nanoseconds() + nano))
}

/// NAV-COV is north-east-down.
fn covariance(message: &[u8]) -> Option<[f64; 6]> {
    if u8_at(message, 5)? == 0 {
        return None;
    }
    let term = |at: usize| f32_at(message, at).map(f64::from);
    let [nn, ne, nd, ee, ed, dd] = [term(16)?, term(20)?, term(24)?, term(28)?, term(32)?, term(36)?];
    Some([ee, ne, nn, -ed, -nd, dd])
}

/// A circle: hAcc is the root of both horizontal variances together.
fn of_accuracies(pvt: &[u8]) -> Option<[f64; 6]> {
    let variance = |at: usize| u32_at(pvt, at).map(|mm| (f64::from(mm) * 1e-3) * (f64::from(mm) * 1e-3));
    let (h, v) = (variance(40)? / 2.0, variance(44)?);
    Some([h, 0.0, h, 0.0, 0.0, v])
}

/// Horizontal and vertical level where they are valid: along the axes of an ellipse the larger is horizontal, along others their root sum.
fn levels(message: &[u8]) -> Option<(f64, f64, Note)> {
    if u8_at(message, 3)? & 1 == 0 {
        return None;
    }
    let metres = |at: usize| u32_at(message, at).map(|mm| f64::from(mm) * 1e-3);
    let (one, two, three) = (metres(16)?, metres(20)?, metres(24)?);
    let horizontal = if u8_at(message, 4)? == ELLIPSE { one.max(two) } else { libm::hypot(one, two) };
    Some((horizontal, three, Note::RiskOfLevels(u8_at(message, 1)?, u8_at(message, 2)? as i8)))
}
