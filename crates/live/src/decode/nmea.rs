//! NMEA 0183: GGA with GST of the same time of day, dated by the last RMC or ZDA that came.
//!
//! Source: NMEA 0183 version 4 as receivers' manuals give it; standard. GGA has no date, and its height stands above the geoid.
//!
//! An epoch is complete at the sentence that was the last of the epoch before it, or when the time of day changes.

use super::Decoded;
use crate::codec::{Damaged, Reader, Writer};
use crate::counters::Refused;
use crate::position::{Position, TrackId};
use navbound_core::quantity::{GpsTime, Reason, Status};
use navbound_formats::measured::GGA_QUALITIES;
use navbound_formats::time::{Calendar, Scale, from_calendar};

const SECOND_NS: i64 = 1_000_000_000;
const HALF_DAY_NS: i64 = 43_200 * SECOND_NS;

/// Sentences of one time of day.
#[derive(Debug, Clone, Default)]
pub(super) struct Epochs {
    of_day_ns: Option<i64>,
    gga: Option<Vec<u8>>,
    gst: Option<Vec<u8>>,
    /// Year, month, day and time of day of the last dated sentence.
    dated: Option<(i32, u8, u8, i64)>,
    newest: [u8; 3],
    last: [u8; 3],
}

impl Epochs {
    /// What is between `$` and `*`.
    pub(super) fn take(&mut self, body: &[u8], track: TrackId, out: &mut Vec<Decoded>) {
        let fields = Fields(body);
        let Some(kind) = fields.get(0).and_then(|name| name.get(2..)).and_then(|name| <[u8; 3]>::try_from(name).ok()) else { return };
        if ![b"GGA", b"GST", b"RMC", b"ZDA"].contains(&&kind) {
            return;
        }
        let Some(of_day_ns) = fields.get(1).and_then(of_day) else {
            out.push(Err(Refused::Undated));
            return;
        };
        if self.of_day_ns != Some(of_day_ns) {
            out.extend(self.finish(track));
            (self.of_day_ns, self.last) = (Some(of_day_ns), self.newest);
        }
        match &kind {
            b"GGA" => self.gga = Some(body.to_vec()),
            b"GST" => self.gst = Some(body.to_vec()),
            b"RMC" if fields.get(2) == Some(b"A") => self.date(fields.get(9).and_then(short_date), of_day_ns),
            b"ZDA" => self.date(fields.long_date(), of_day_ns),
            _ => {}
        }
        self.newest = kind;
        if kind == self.last {
            out.extend(self.finish(track));
        }
    }

    fn date(&mut self, date: Option<(i32, u8, u8)>, of_day_ns: i64) {
        if let Some((year, month, day)) = date {
            self.dated = Some((year, month, day, of_day_ns));
        }
    }

    /// The epoch as it is.
    pub(super) fn finish(&mut self, track: TrackId) -> Option<Decoded> {
        let (gga, gst) = (self.gga.take(), self.gst.take());
        let (gga, of_day_ns) = (gga?, self.of_day_ns?);
        let Some(time) = self.dated.and_then(|dated| gps_time(dated, of_day_ns)) else { return Some(Err(Refused::Undated)) };
        let gga = Fields(&gga);
        let angle = |at: usize, sign: usize, negative: u8| {
            let degrees = degrees(gga.get(at)?)?;
            Some(if gga.get(sign)? == [negative] { -degrees } else { degrees }.to_radians())
        };
        let (lat_rad, lon_rad) = (angle(2, 3, b'S'), angle(4, 5, b'W'));
        let measured = gga.number(6).is_some_and(|quality| GGA_QUALITIES.iter().any(|each| f64::from(*each) == quality));
        let sound = measured && lat_rad.is_some() && lon_rad.is_some();
        let position = Position {
            lat_rad,
            lon_rad,
            h_m: gga.number(9).zip(gga.number(11)).map(|(altitude, separation)| altitude + separation),
            covariance_m2: gst.and_then(|gst| covariance(&Fields(&gst))),
            status: if sound { Status::Ok } else { Status::NotAvailable },
            reason: (!sound).then_some(Reason::Reported),
            ..Position::new(track, time)
        };
        Some(Ok(position))
    }

    pub(super) fn write(&self, to: &mut Writer) {
        to.option(self.of_day_ns, Writer::i64);
        to.option(self.gga.as_deref(), Writer::bytes);
        to.option(self.gst.as_deref(), Writer::bytes);
        to.option(self.dated, |to, (year, month, day, of_day_ns)| {
            to.i64(i64::from(year));
            to.u8(month);
            to.u8(day);
            to.i64(of_day_ns);
        });
        [self.newest, self.last].as_flattened().iter().for_each(|byte| to.u8(*byte));
    }

    pub(super) fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        let of_day_ns = from.option(Reader::i64)?;
        let (gga, gst) = (from.option(|from| from.bytes().map(<[u8]>::to_vec))?, from.option(|from| from.bytes().map(<[u8]>::to_vec))?);
        let dated = from.option(|from| Ok((from.i64()? as i32, from.u8()?, from.u8()?, from.i64()?)))?;
        let mut three = || Ok([from.u8()?, from.u8()?, from.u8()?]);
        Ok(Self { of_day_ns, gga, gst, dated, newest: three()?, last: three()? })
    }
}

struct Fields<'a>(&'a [u8]);

impl<'a> Fields<'a> {
    fn get(&self, at: usize) -> Option<&'a [u8]> {
        self.0.split(|byte| *byte == b',').nth(at)
    }

    fn number(&self, at: usize) -> Option<f64> {
        number(self.get(at)?)
    }

    fn long_date(&self) -> Option<(i32, u8, u8)> {
        let whole = |at: usize| core::str::from_utf8(self.get(at)?).ok()?.parse::<u16>().ok();
        Some((i32::from(whole(4)?), u8::try_from(whole(3)?).ok()?, u8::try_from(whole(2)?).ok()?))
    }
}

fn number(text: &[u8]) -> Option<f64> {
    let plain = text.iter().all(|byte| byte.is_ascii_digit() || matches!(byte, b'.' | b'-' | b'+'));
    core::str::from_utf8(text).ok().filter(|_| plain)?.parse().ok()
}

fn two(text: &[u8], at: usize) -> Option<u8> {
    match text.get(at..at + 2)? {
        [a, b] if a.is_ascii_digit() && b.is_ascii_digit() => Some(10 * (a - b'0') + (b - b'0')),
        _ => None,
    }
}

/// `ddmmyy`.
fn short_date(text: &[u8]) -> Option<(i32, u8, u8)> {
    let year = i32::from(two(text, 4)?);
    Some((if year >= 80 { 1900 + year } else { 2000 + year }, two(text, 2)?, two(text, 0)?))
}

/// `hhmmss.sss` to nanoseconds; a leap second has second 60.
fn of_day(text: &[u8]) -> Option<i64> {
    let (hour, minute, second) = (two(text, 0)?, two(text, 2)?, two(text, 4)?);
    let fraction = match text.get(6..)? {
        [] => 0,
        [b'.', digits @ ..] if digits.len() <= 9 && digits.iter().all(u8::is_ascii_digit) => {
            (0..9).fold(0, |ns, k| 10 * ns + i64::from(digits.get(k).map_or(0, |digit| digit - b'0')))
        }
        _ => return None,
    };
    let clock = hour < 24 && minute < 60 && second <= 60;
    clock.then_some(((i64::from(hour) * 60 + i64::from(minute)) * 61 + i64::from(second)) * SECOND_NS + fraction)
}

/// Time of a time of day near a dated one; midnight may lie between them. Minutes are counted with 61 seconds, so that a leap second has a
/// place of its own.
fn gps_time((year, month, day, dated_ns): (i32, u8, u8, i64), of_day_ns: i64) -> Option<GpsTime> {
    const MINUTE_NS: i64 = 61 * SECOND_NS;
    let minutes = of_day_ns.div_euclid(MINUTE_NS);
    let clock = Calendar {
        year,
        month,
        day,
        hour: (minutes / 60) as u8,
        minute: (minutes % 60) as u8,
        nanoseconds: of_day_ns.rem_euclid(MINUTE_NS),
    };
    let apart = (minutes - dated_ns.div_euclid(MINUTE_NS)) * 60 * SECOND_NS;
    let days = i64::from(apart < -HALF_DAY_NS) - i64::from(apart > HALF_DAY_NS);
    let time = from_calendar(clock, Scale::Utc)?;
    if days == 0 {
        return Some(time);
    }
    let noon = Calendar { hour: 12, minute: 0, nanoseconds: 0, ..clock };
    let of_other_day = navbound_formats::time::to_unix(from_calendar(noon, Scale::Utc)?) + days * 2 * HALF_DAY_NS;
    let date =
        navbound_formats::time::to_calendar(GpsTime::from_nanoseconds(navbound_formats::time::from_unix(of_other_day).nanoseconds()))?;
    from_calendar(Calendar { year: date.year, month: date.month, day: date.day, ..clock }, Scale::Utc)
}

/// `ddmm.mmmm` or `dddmm.mmmm`.
fn degrees(text: &[u8]) -> Option<f64> {
    let value = number(text).filter(|value| *value >= 0.0)?;
    let whole = libm::trunc(value / 100.0);
    let minutes = value - 100.0 * whole;
    (minutes < 60.0).then_some(whole + minutes / 60.0)
}

/// From GST: deviations along the axes, and the turn of the ellipse, whose axes are scaled to them as some makers write 95 % axes.
fn covariance(gst: &Fields<'_>) -> Option<[f64; 6]> {
    let [lat, lon, alt] = [gst.number(6)?, gst.number(7)?, gst.number(8)?];
    let (ee, nn) = (lon * lon, lat * lat);
    let en = gst.number(3).zip(gst.number(4)).zip(gst.number(5)).map_or(0.0, |((major, minor), orient)| {
        let (sum, turn) = (major * major + minor * minor, orient.to_radians());
        if sum > 0.0 { (ee + nn) * (major * major - minor * minor) / sum * libm::sin(turn) * libm::cos(turn) } else { 0.0 }
    });
    Some([ee, en, nn, 0.0, 0.0, alt * alt])
}
