//! NovAtel OEM4 and later: BESTPOS, binary (BESTPOSB) or ASCII (BESTPOSA). Each is an epoch of its own.
//!
//! Source: NovAtel OEM7 commands and logs reference manual; standard. Times are GPS weeks, not rolled over, and milliseconds; heights are above
//! the geoid with its undulation beside them; the receiver states standard deviations and no correlations.

use super::decoder::Step;
use super::{Fields, Note, Position, Reason, uncorrelated};
use crate::measured::NOVATEL_TYPES;
use crate::receiver::bits::{f32_at, f64_at, i32_at, u8_at, u16_at, u32_at};
use crate::time::from_week;

const BESTPOS: u16 = 42;
/// Time status "unknown" of a binary header.
const TIME_UNKNOWN: u8 = 20;
/// Bit 7 of the type marks an answer to a command, bits 5 and 6 another form.
const OTHER_FORM: u8 = 0xe0;
/// Bytes of the body up to the satellites used.
const SHORTEST: usize = 66;

const FIELDS: Fields = &[("est_lat_rad", "BESTPOS"), ("est_lon_rad", "BESTPOS"), ("est_h_m", "BESTPOS"), ("time", "header:gps")];

/// What a message states.
struct Stated {
    measured: bool,
    time_known: bool,
    week: i64,
    of_week_ms: f64,
    /// Latitude, longitude \[deg\], height, undulation, standard deviations north, east, up \[m\].
    numbers: [f64; 7],
    n_sv: u32,
    status: String,
}

pub(super) fn binary(head: &[u8], body: &[u8], record: u64) -> Step {
    if u16_at(head, 4) != Some(BESTPOS) || u8_at(head, 6).is_none_or(|kind| kind & OTHER_FORM != 0) {
        return Step::Passed;
    }
    let read = if body.len() >= SHORTEST { of_binary(head, body) } else { None };
    read.map_or(Step::Malformed("BESTPOS is shorter than its definition"), |stated| Step::Whole(Box::new(position(stated, record))))
}

fn of_binary(head: &[u8], body: &[u8]) -> Option<Stated> {
    let (solution, kind, time_status) = (u32_at(body, 0)?, u32_at(body, 4)?, u8_at(head, 13)?);
    let single = |at: usize| f32_at(body, at).map(f64::from);
    let doubles = [f64_at(body, 8)?, f64_at(body, 16)?, f64_at(body, 24)?];
    Some(Stated {
        measured: solution == 0 && NOVATEL_TYPES.iter().any(|(number, _)| u32::from(*number) == kind),
        time_known: time_status > TIME_UNKNOWN,
        week: i64::from(u16_at(head, 14)?),
        of_week_ms: f64::from(i32_at(head, 16)?),
        numbers: [doubles[0], doubles[1], doubles[2], single(32)?, single(40)?, single(44)?, single(48)?],
        n_sv: u32::from(u8_at(body, 65)?),
        status: format!("solution status {solution}, position type {kind}, time status {time_status}"),
    })
}

pub(super) fn text(body: &[u8], record: u64) -> Step {
    if !body.starts_with(b"BESTPOSA,") {
        return Step::Passed;
    }
    of_text(body).map_or(Step::Malformed("a field of BESTPOSA is not a number, or is missing"), |stated| {
        Step::Whole(Box::new(position(stated, record)))
    })
}

fn of_text(body: &[u8]) -> Option<Stated> {
    let (head, body) = core::str::from_utf8(body).ok()?.split_once(';')?;
    let (head, body) = (head.split(',').collect::<Vec<_>>(), body.split(',').collect::<Vec<_>>());
    let number = |at: usize| body.get(at)?.trim().parse::<f64>().ok();
    let (solution, kind, time_status) = (*body.first()?, *body.get(1)?, *head.get(4)?);
    Some(Stated {
        measured: solution == "SOL_COMPUTED" && NOVATEL_TYPES.iter().any(|(_, word)| *word == kind),
        time_known: time_status != "UNKNOWN",
        week: head.get(5)?.trim().parse().ok()?,
        of_week_ms: head.get(6)?.trim().parse::<f64>().ok()? * 1e3,
        numbers: [number(2)?, number(3)?, number(4)?, number(5)?, number(7)?, number(8)?, number(9)?],
        n_sv: body.get(14)?.trim().parse().ok()?,
        status: format!("solution status {solution}, position type {kind}, time status {time_status}"),
    })
}

fn position(stated: Stated, record: u64) -> Position {
    let known = stated.time_known && stated.of_week_ms.is_finite();
    let time = known.then(|| from_week(stated.week, (stated.of_week_ms * 1e6).round() as i64)).flatten();
    if time.is_none() || !stated.measured || !stated.numbers.iter().all(|number| number.is_finite()) {
        let reason = if time.is_none() { Reason::TimeNotKnown } else { Reason::NotMeasured };
        return Position { time, ..Position::none(record, reason, stated.status) };
    }
    let [lat_deg, lon_deg, height, undulation, north, east, up] = stated.numbers;
    Position {
        record,
        time,
        lat_rad: Some(lat_deg.to_radians()),
        lon_rad: Some(lon_deg.to_radians()),
        h_m: Some(height + undulation),
        covariance_m2: Some(uncorrelated(east, north, up)),
        n_sv: Some(stated.n_sv),
        fields: FIELDS,
        covariance_from: Some("BESTPOS"),
        notes: [Some(Note::Uncorrelated), None],
        ..Position::default()
    }
}
