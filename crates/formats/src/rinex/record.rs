//! One navigation record: its lines to an ephemeris.

use super::super::layout as at;
use super::super::number::{Field, columns, fixed, seconds_ns, text, whole};
use super::nearest_week;
use crate::refusal::Refusal;
use crate::time::{Calendar, Scale, from_calendar};
use navbound_core::quantity::GpsTime;
use navbound_core::signal::{Constellation, Ephemeris, GeoEphemeris, Health, Message, SatelliteId};

/// BeiDou time is behind GPS time by this.
const BEIDOU_BEHIND_NS: i64 = 14_000_000_000;

/// The lines of one record.
pub(super) struct Block<'a> {
    number: usize,
    /// Columns before the numbers of a continuation line.
    indent: usize,
    pub(super) lines: Vec<&'a [u8]>,
}

impl<'a> Block<'a> {
    pub(super) fn new(number: usize, first: &'a [u8], indent: usize) -> Self {
        Self { number, indent, lines: vec![first] }
    }

    /// Line of its title.
    pub(super) const fn number(&self) -> usize {
        self.number
    }

    pub(super) fn first(&self) -> &'a [u8] {
        self.lines.first().copied().unwrap_or_default()
    }

    pub(super) fn refusal(&self, field: &str, reason: &str) -> Refusal {
        Refusal { line: self.number, field: field.to_owned(), reason: reason.to_owned(), text: text(self.first(), 0, 80) }
    }

    /// Numbers of the record: three on the first line, four on each that follows; blank is zero.
    pub(super) fn numbers<const N: usize>(&self) -> Result<[f64; N], Refusal> {
        let mut values = [0.0; N];
        for (k, value) in values.iter_mut().enumerate() {
            let (row, column) = if k < 3 { (0, k + 1) } else { ((k - 3) / 4 + 1, (k - 3) % 4) };
            let Some(line) = self.lines.get(row) else {
                return Err(self.refusal("record", "the record ends early"));
            };
            let from = self.indent + at::WIDTH * column;
            let field = fixed(line, from, from + at::WIDTH);
            *value = field.or_zero().ok_or_else(|| self.not_a_number(row, k, columns(line, from, from + at::WIDTH)))?;
        }
        Ok(values)
    }

    /// Whether nothing stands in one of the fields from the second line on.
    fn is_blank(&self, k: usize) -> bool {
        let (row, from) = ((k - 3) / 4 + 1, self.indent + at::WIDTH * ((k - 3) % 4));
        self.lines.get(row).is_none_or(|line| matches!(fixed(line, from, from + at::WIDTH), Field::Blank))
    }

    fn not_a_number(&self, row: usize, k: usize, field: &[u8]) -> Refusal {
        Refusal {
            line: self.number + row,
            field: format!("number {}", k + 1),
            reason: "not a number".to_owned(),
            text: String::from_utf8_lossy(field).into_owned(),
        }
    }

    fn satellite(&self, system: Option<Constellation>) -> Option<SatelliteId> {
        let first = self.first();
        let (constellation, number) = match system {
            Some(constellation) => (constellation, columns(first, 0, 2)),
            None => (Constellation::from_letter(*first.first()?)?, columns(first, 1, 3)),
        };
        let number = u8::try_from(whole(number)?).ok().filter(|n| constellation.numbers().contains(n))?;
        // Version 2 numbers augmentation satellites by PRN less 100 as well.
        Some(SatelliteId { constellation, number })
    }

    /// Time of the first line.
    pub(super) fn time(&self, scale: Scale) -> Option<GpsTime> {
        let line = self.first();
        let number = |from, to| whole(columns(line, from, to));
        let calendar = if self.indent == 3 {
            let year = number(3, 5)?;
            Calendar {
                // Two digits: 1980 to 2079.
                year: i32::try_from(if year < 80 { 2000 + year } else { 1900 + year }).ok()?,
                month: u8::try_from(number(6, 8)?).ok()?,
                day: u8::try_from(number(9, 11)?).ok()?,
                hour: u8::try_from(number(12, 14)?).ok()?,
                minute: u8::try_from(number(15, 17)?).ok()?,
                nanoseconds: seconds_ns(columns(line, 17, 22))?,
            }
        } else {
            Calendar {
                year: i32::try_from(number(4, 8)?).ok()?,
                month: u8::try_from(number(9, 11)?).ok()?,
                day: u8::try_from(number(12, 14)?).ok()?,
                hour: u8::try_from(number(15, 17)?).ok()?,
                minute: u8::try_from(number(18, 20)?).ok()?,
                nanoseconds: number(21, 23)?.checked_mul(1_000_000_000)?,
            }
        };
        // Some writers give second 60 at the full minute.
        if calendar.nanoseconds == 60_000_000_000 {
            let minute = from_calendar(Calendar { nanoseconds: 0, ..calendar }, scale)?;
            return Some(GpsTime::from_nanoseconds(minute.nanoseconds() + 60_000_000_000));
        }
        from_calendar(calendar, scale)
    }

    /// A Keplerian record; `message` as version 4 names it.
    pub(super) fn kepler(&self, system: Option<Constellation>, message: Option<&[u8]>) -> Result<Ephemeris, Refusal> {
        let satellite = self.satellite(system).ok_or_else(|| self.refusal("satellite", "not a satellite number"))?;
        let beidou = satellite.constellation == Constellation::BeiDou;
        let (scale, behind) = if beidou { (Scale::BeiDou, BEIDOU_BEHIND_NS) } else { (Scale::Gps, 0) };
        let clock_time = self.time(scale).ok_or_else(|| self.refusal("epoch", "not a date"))?;
        let v = self.numbers::<27>()?;
        // The last line is often cut by writers that leave out blanks.
        let [sent, last] = self.last_line()?;
        let orbit_time = nearest_week(v[at::ORBIT_TIME], clock_time, behind).ok_or_else(|| self.refusal("toe", "not a time of week"))?;
        let unnamed = || self.refusal("data sources", "neither the clock of I/NAV nor that of F/NAV");
        let message = kind(satellite, message, v[at::SOURCES]).ok_or_else(unnamed)?;
        if let Some((field, reason)) = orbit_refusal(v[at::SQRT_A], v[at::ECCENTRICITY]) {
            return Err(self.refusal(field, reason));
        }
        Ok(Ephemeris {
            satellite,
            message,
            clock_time,
            clock: [v[0], v[1], v[2]],
            orbit_time,
            sent: sent.and_then(|s| nearest_week(s, orbit_time, behind)),
            issue_orbit: small(v[at::ISSUE]),
            issue_clock: if beidou {
                small(last.unwrap_or(0.0))
            } else if message == Message::Lnav {
                small(v[at::DELAY_OR_ISSUE])
            } else {
                small(v[at::ISSUE])
            },
            sqrt_a: v[at::SQRT_A],
            eccentricity: v[at::ECCENTRICITY],
            inclination: [v[at::INCLINATION], v[at::INCLINATION_RATE]],
            node: [v[at::NODE], v[at::NODE_RATE]],
            perigee: v[at::PERIGEE],
            mean_anomaly: v[at::MEAN_ANOMALY],
            delta_n: v[at::DELTA_N],
            latitude_harmonics: [v[at::CUC], v[at::CUS]],
            radius_harmonics: [v[at::CRC], v[at::CRS]],
            inclination_harmonics: [v[at::CIC], v[at::CIS]],
            // What is not stated is no promise.
            accuracy_m: if self.is_blank(at::ACCURACY) { f64::NAN } else { v[at::ACCURACY] },
            health: Health {
                word: if self.is_blank(at::HEALTH) || v[at::HEALTH].fract() != 0.0 { u16::MAX } else { small(v[at::HEALTH]) },
            },
            group_delay_s: [v[at::DELAY], if message == Message::Lnav { 0.0 } else { v[at::DELAY_OR_ISSUE] }],
            fit_interval_s: fit_interval(message, last.unwrap_or(0.0)),
        })
    }

    /// Time of transmission and the number after it, where the record has them.
    fn last_line(&self) -> Result<[Option<f64>; 2], Refusal> {
        let line = self.lines.get(7).copied().unwrap_or_default();
        let mut values = [None; 2];
        for (k, value) in values.iter_mut().enumerate() {
            let from = self.indent + at::WIDTH * k;
            *value = match fixed(line, from, from + at::WIDTH) {
                Field::Number(v) => Some(v),
                Field::Blank => None,
                Field::Bad => return Err(self.not_a_number(7, at::SENT + k, columns(line, from, from + at::WIDTH))),
            };
        }
        Ok(values)
    }

    /// A geostationary record: kilometres in the file. `second`: satellite numbers of version 2.
    pub(super) fn geostationary(&self, second: bool) -> Result<GeoEphemeris, Refusal> {
        let system = second.then_some(Constellation::Sbas);
        let satellite = self.satellite(system).ok_or_else(|| self.refusal("satellite", "not a satellite number"))?;
        let time = self.time(Scale::Gps).ok_or_else(|| self.refusal("epoch", "not a date"))?;
        let v = self.numbers::<15>()?;
        let axes = |k: usize| [v[3 + k], v[7 + k], v[11 + k]].map(|km| km * 1e3);
        Ok(GeoEphemeris {
            satellite,
            time,
            clock: [v[0], v[1]],
            position_m: axes(0),
            velocity_mps: axes(1),
            acceleration_mps2: axes(2),
            accuracy_m: v[10],
            health: Health { word: small(v[6]) },
            issue: small(v[14]),
        })
    }
}

/// Field and reason, where the root of the semi-major axis \[sqrt(m)\] or the eccentricity is that of no satellite's orbit.
pub(crate) fn orbit_refusal(sqrt_a: f64, eccentricity: f64) -> Option<(&'static str, &'static str)> {
    if !(2450.0..=31_622.0).contains(&sqrt_a) {
        return Some(("sqrt(A)", "outside [2450, 31622] sqrt(m)"));
    }
    (!(0.0..=0.9).contains(&eccentricity)).then_some(("eccentricity", "outside [0, 0.9]"))
}

/// The message a record came from; `None` where the record does not say. Version 3 has no name: Galileo's data sources tell, BeiDou's
/// follow from the satellite, since D2 is what the geostationary ones send.
fn kind(satellite: SatelliteId, message: Option<&[u8]>, sources: f64) -> Option<Message> {
    Some(match (satellite.constellation, message) {
        (_, Some(b"INAV")) => Message::Inav,
        (_, Some(b"FNAV")) => Message::Fnav,
        (_, Some(b"D1")) => Message::D1,
        (_, Some(b"D2")) => Message::D2,
        (Constellation::Galileo, _) => galileo(small(sources))?,
        (Constellation::BeiDou, _) if matches!(satellite.number, 1..=5 | 59..=63) => Message::D2,
        (Constellation::BeiDou, _) => Message::D1,
        _ => Message::Lnav,
    })
}

/// Galileo's message by the data sources of RINEX 3: bits 8 and 9 say whose the clock is (E5a,E1 or E5b,E1), which is what matters; where
/// neither or both are set, bits 0 to 2 say where the record was received (I/NAV on E1, F/NAV on E5a, I/NAV on E5b).
const fn galileo(sources: u16) -> Option<Message> {
    match (sources >> 8 & 0b11, sources & 0b111) {
        (0b01, _) | (0b00 | 0b11, 0b010) => Some(Message::Fnav),
        (0b10, _) | (0b00 | 0b11, 0b001 | 0b100 | 0b101) => Some(Message::Inav),
        _ => None,
    }
}

/// Seconds around the reference time in which the record may be used. GPS states it (hours, or a flag in older files); the others do
/// not, and get the times of their services: Galileo 4 h after, BeiDou 1 h renewal with one missed.
pub(crate) fn fit_interval(message: Message, stated: f64) -> f64 {
    let hours = match message {
        Message::Lnav if stated > 1.0 && stated <= 26.0 => stated,
        Message::Lnav if stated == 1.0 => 6.0,
        Message::Lnav => 4.0,
        Message::Inav | Message::Fnav => 8.0,
        Message::D1 | Message::D2 => 4.0,
    };
    hours * 3600.0
}

/// A count written as a float; what does not fit becomes the largest, which no healthy word is.
fn small(value: f64) -> u16 {
    if value >= 0.0 && value <= f64::from(u16::MAX) { value as u16 } else { u16::MAX }
}
