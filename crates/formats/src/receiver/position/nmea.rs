//! NMEA 0183: GGA with GST (or GBS) and the speed of RMC of the same time of day, dated by RMC or ZDA.
//!
//! Source: NMEA 0183 version 4 as receivers' manuals give it; standard. GGA has no date, and its height stands above the geoid.

use super::decoder::Step;
use super::epoch::{Message, of_kind};
use super::{Absent, Fields, Note, OfDay, Position, Reason, uncorrelated};
use crate::measured::GGA_QUALITIES;
use crate::time::{Calendar, Scale, from_calendar, from_unix, to_calendar, to_unix};
use navbound_core::quantity::GpsTime;

const SECOND_NS: i64 = 1_000_000_000;
const HALF_DAY_NS: i64 = 43_200 * SECOND_NS;
/// Minutes of a time of day count 61 seconds.
const MINUTE_NS: i64 = 61 * SECOND_NS;

const GGA: u32 = name(*b"GGA");
const GST: u32 = name(*b"GST");
const GBS: u32 = name(*b"GBS");
const RMC: u32 = name(*b"RMC");
const ZDA: u32 = name(*b"ZDA");

const FIELDS: Fields =
    &[("est_lat_rad", "GGA"), ("est_lon_rad", "GGA"), ("est_h_m", "GGA altitude + separation"), ("time", "GGA, dated by RMC or ZDA:utc")];
const FIELDS_AND_SPEED: Fields = &[
    ("est_lat_rad", "GGA"),
    ("est_lon_rad", "GGA"),
    ("est_h_m", "GGA altitude + separation"),
    ("time", "GGA, dated by RMC or ZDA:utc"),
    ("ground_speed_mps", "RMC"),
    ("ground_track_rad", "RMC"),
];
/// Metres per second in a knot.
const KNOT_MPS: f64 = 1852.0 / 3600.0;

const fn name([a, b, c]: [u8; 3]) -> u32 {
    u32::from_be_bytes([0, a, b, c])
}

/// A date, and the time of day that it was written with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Dated {
    /// Year.
    pub year: i32,
    /// Month, 1 to 12.
    pub month: u8,
    /// Day of the month, from 1.
    pub day: u8,
    /// Time of day.
    pub of_day: OfDay,
}

pub(super) fn step(body: &[u8], record: u64) -> Step {
    let fields = Sentence(body);
    let address = fields.get(0).and_then(|address| address.get(2..)).and_then(|address| <[u8; 3]>::try_from(address).ok());
    let Some(kind) = address.map(name).filter(|kind| [GGA, GST, GBS, RMC, ZDA].contains(kind)) else { return Step::Passed };
    // A receiver without a fix leaves its fields empty.
    let Some(OfDay(key)) = fields.get(1).and_then(of_day) else {
        return if kind == GGA { Step::Whole(Box::new(Position::none(record, Reason::NoFix, fields.stated()))) } else { Step::Passed };
    };
    match kind {
        GGA if !fields.sound(&GGA_NUMBERS) => Step::Malformed("a field of GGA is not a number"),
        RMC if fields.get(2) == Some(b"A") => {
            Step::Date { key, kind, dated: fields.get(9).and_then(short_date).and_then(|d| dated(d, key)), kept: true }
        }
        RMC => Step::Date { key, kind, dated: None, kept: false },
        ZDA => Step::Date { key, kind, dated: fields.long_date().and_then(|d| dated(d, key)), kept: false },
        _ => Step::Part { key, kind },
    }
}

/// Quality, satellites, HDOP, altitude, separation; latitude and longitude.
const GGA_NUMBERS: [usize; 7] = [2, 4, 6, 7, 8, 9, 11];

fn dated((year, month, day): (i32, u8, u8), of_day_ns: i64) -> Option<Dated> {
    let noon = Calendar { year, month, day, hour: 12, minute: 0, nanoseconds: 0 };
    from_calendar(noon, Scale::Utc).map(|_| Dated { year, month, day, of_day: OfDay(of_day_ns) })
}

/// The position of a time of day; a date is still lacking.
pub(super) fn position(messages: &[Message]) -> Option<Position> {
    let sentence = |kind| of_kind(messages, kind).map(|message| Sentence(&message.body));
    let (record, gga) = (of_kind(messages, GGA)?.record, sentence(GGA)?);
    let (lat_rad, lon_rad) = (gga.angle(2, [b"N", b"S"]), gga.angle(4, [b"E", b"W"]));
    let measured = gga.number(6).is_some_and(|quality| GGA_QUALITIES.iter().any(|each| f64::from(*each) == quality));
    let (altitude, separation) = (gga.number(9), gga.number(11));
    let of_gst = sentence(GST).and_then(|gst| covariance(&gst));
    let of_gbs = if of_gst.is_some() { None } else { sentence(GBS).and_then(|gbs| expected_errors(&gbs)) };
    // Only the sentence of the same time, and one that says it is valid, is kept.
    let speed_mps = sentence(RMC).and_then(|rmc| rmc.number(7)).filter(|knots| *knots >= 0.0).map(|knots| knots * KNOT_MPS);
    let track_rad = sentence(RMC).and_then(|rmc| rmc.number(8)).filter(|degrees| (0.0..=360.0).contains(degrees)).map(f64::to_radians);
    let usable = measured && lat_rad.is_some() && lon_rad.is_some();
    Some(Position {
        record,
        of_day: of_day(gga.get(1)?),
        lat_rad,
        lon_rad,
        h_m: altitude.zip(separation).map(|(altitude, separation)| altitude + separation),
        covariance_m2: of_gst.or(of_gbs),
        ground_speed_mps: speed_mps,
        ground_track_rad: track_rad,
        n_sv: gga.number(7).map(|count| count as u32),
        hdop: gga.number(8),
        absent: (!usable).then(|| Absent { reason: Reason::NoFix, stated: gga.stated() }),
        fields: if speed_mps.is_some() { FIELDS_AND_SPEED } else { FIELDS },
        covariance_from: if of_gst.is_some() { Some("GST") } else { of_gbs.map(|_| "GBS") },
        notes: [(altitude.is_some() && separation.is_none()).then_some(Note::NoSeparation), of_gbs.map(|_| Note::ExpectedErrors)],
        ..Position::default()
    })
}

/// Number of the accuracy beside which no position stands.
pub(super) fn accuracy_alone(messages: &[Message]) -> Option<u64> {
    messages.iter().find(|message| [GST, GBS].contains(&message.kind)).map(|message| message.record)
}

impl Position {
    /// Make a time of a time of day near a dated one; midnight may lie between them.
    pub(super) fn date(&mut self, dated: Dated) {
        let Some(OfDay(of_day_ns)) = self.of_day else { return };
        self.time = gps_time(dated, of_day_ns);
        if self.time.is_none() && self.absent.is_none() {
            let (minutes, second_s) = (of_day_ns / MINUTE_NS, (of_day_ns.rem_euclid(MINUTE_NS)) as f64 * 1e-9);
            let reason = if second_s >= 60.0 { Reason::NoSuchLeapSecond } else { Reason::OutsideDomain };
            let stated = format!("{:02}{:02}{second_s:05.2}", minutes / 60, minutes % 60);
            self.absent = Some(Absent { reason, stated });
        }
    }
}

fn gps_time(Dated { year, month, day, of_day: OfDay(dated_ns) }: Dated, of_day_ns: i64) -> Option<GpsTime> {
    let minutes = of_day_ns.div_euclid(MINUTE_NS);
    let nanoseconds = of_day_ns.rem_euclid(MINUTE_NS);
    let clock = Calendar { year, month, day, hour: (minutes / 60) as u8, minute: (minutes % 60) as u8, nanoseconds };
    let apart = (minutes - dated_ns.div_euclid(MINUTE_NS)) * 60 * SECOND_NS;
    let days = i64::from(apart < -HALF_DAY_NS) - i64::from(apart > HALF_DAY_NS);
    if days == 0 {
        return from_calendar(clock, Scale::Utc);
    }
    let noon = Calendar { hour: 12, minute: 0, nanoseconds: 0, ..clock };
    let date = to_calendar(from_unix(to_unix(from_calendar(noon, Scale::Utc)?) + days * 2 * HALF_DAY_NS))?;
    from_calendar(Calendar { year: date.year, month: date.month, day: date.day, ..clock }, Scale::Utc)
}

/// Fields of a sentence, the address first.
struct Sentence<'a>(&'a [u8]);

impl<'a> Sentence<'a> {
    fn get(&self, at: usize) -> Option<&'a [u8]> {
        self.0.split(|byte| *byte == b',').nth(at)
    }

    fn number(&self, at: usize) -> Option<f64> {
        number(self.get(at)?)
    }

    /// Whether each of these is empty, absent or a number.
    fn sound(&self, which: &[usize]) -> bool {
        which.iter().all(|at| self.get(*at).is_none_or(|text| text.is_empty() || number(text).is_some()))
    }

    /// `ddmm.mmmm` or `dddmm.mmmm` with its hemisphere, positive and negative, in the next field.
    fn angle(&self, at: usize, [positive, negative]: [&[u8]; 2]) -> Option<f64> {
        let angle = degrees(self.get(at)?)?.to_radians();
        let hemisphere = self.get(at + 1)?;
        if hemisphere == positive { Some(angle) } else { (hemisphere == negative).then_some(-angle) }
    }

    fn long_date(&self) -> Option<(i32, u8, u8)> {
        let whole = |at: usize| core::str::from_utf8(self.get(at)?).ok()?.parse::<u16>().ok();
        Some((i32::from(whole(4)?), u8::try_from(whole(3)?).ok()?, u8::try_from(whole(2)?).ok()?))
    }

    fn stated(&self) -> String {
        let text = |at: usize| String::from_utf8_lossy(self.get(at).unwrap_or_default());
        format!("quality {}, latitude {}", text(6), text(2))
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

/// `hhmmss.sss`; a leap second has second 60.
fn of_day(text: &[u8]) -> Option<OfDay> {
    let (hour, minute, second) = (two(text, 0)?, two(text, 2)?, two(text, 4)?);
    let fraction = match text.get(6..)? {
        [] => 0,
        [b'.', digits @ ..] if digits.iter().all(u8::is_ascii_digit) => {
            (0..9).fold(0, |ns, k| 10 * ns + i64::from(digits.get(k).map_or(0, |digit| digit - b'0')))
        }
        _ => return None,
    };
    let clock = hour < 24 && minute < 60 && second <= 60;
    clock.then_some(OfDay(((i64::from(hour) * 60 + i64::from(minute)) * 61 + i64::from(second)) * SECOND_NS + fraction))
}

fn degrees(text: &[u8]) -> Option<f64> {
    let value = number(text).filter(|value| *value >= 0.0)?;
    let whole = libm::trunc(value / 100.0);
    let minutes = value - 100.0 * whole;
    (minutes < 60.0).then_some(whole + minutes / 60.0)
}

/// From GST: deviations along the axes, and the turn of the ellipse. Its axes are scaled to the deviations: the standard calls them standard
/// deviations, some makers write 95 % axes.
fn covariance(gst: &Sentence<'_>) -> Option<[f64; 6]> {
    let [lat, lon, alt] = [gst.number(6)?, gst.number(7)?, gst.number(8)?];
    let [ee, _, nn, _, _, uu] = uncorrelated(lon, lat, alt);
    let en = gst.number(3).zip(gst.number(4)).zip(gst.number(5)).map_or(0.0, |((major, minor), orient)| {
        let (sum, turn) = (major * major + minor * minor, orient.to_radians());
        if sum > 0.0 { (ee + nn) * (major * major - minor * minor) / sum * libm::sin(turn) * libm::cos(turn) } else { 0.0 }
    });
    Some([ee, en, nn, 0.0, 0.0, uu])
}

/// From GBS: expected errors of latitude, longitude, altitude.
fn expected_errors(gbs: &Sentence<'_>) -> Option<[f64; 6]> {
    Some(uncorrelated(gbs.number(3)?, gbs.number(2)?, gbs.number(4)?))
}
