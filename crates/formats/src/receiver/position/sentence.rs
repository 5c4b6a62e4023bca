//! Fields of a sentence of NMEA 0183.
//!
//! Source: NMEA 0183 version 4 as receivers' manuals give it; standard.

use super::OfDay;
use crate::measured::NMEA_MODES;
use navbound_core::quantity::KNOT_MPS;

pub(super) const SECOND_NS: i64 = 1_000_000_000;
/// Provenance: derived, WGS-84's mean radius rounded upwards; for a distance that decides at tens of metres \[m\].
pub(super) const EARTH_M: f64 = 6.372e6;

/// Fields of a sentence, the address first.
pub(super) struct Sentence<'a>(pub(super) &'a [u8]);

impl<'a> Sentence<'a> {
    pub(super) fn get(&self, at: usize) -> Option<&'a [u8]> {
        self.0.split(|byte| *byte == b',').nth(at)
    }

    pub(super) fn number(&self, at: usize) -> Option<f64> {
        number(self.get(at)?)
    }

    /// Whether each of these is empty, absent or a number.
    pub(super) fn sound(&self, which: &[usize]) -> bool {
        which.iter().all(|at| self.get(*at).is_none_or(|text| text.is_empty() || number(text).is_some()))
    }

    /// `ddmm.mmmm` or `dddmm.mmmm` with its hemisphere, positive and negative, in the next field.
    pub(super) fn angle(&self, at: usize, [positive, negative]: [&[u8]; 2]) -> Option<f64> {
        let angle = degrees(self.get(at)?)?.to_radians();
        let hemisphere = self.get(at + 1)?;
        if hemisphere == positive { Some(angle) } else { (hemisphere == negative).then_some(-angle) }
    }

    /// Whether each of these is empty, absent or a number that is not negative.
    pub(super) fn sizes(&self, which: &[usize]) -> bool {
        which.iter().all(|at| self.get(*at).is_none_or(|text| text.is_empty() || number(text).is_some_and(|size| size >= 0.0)))
    }

    /// Length of one unit of the last digit of the angle in minutes.
    pub(super) fn resolution_m(&self, at: usize) -> f64 {
        let decimals = self.get(at).and_then(|text| text.iter().position(|byte| *byte == b'.').map(|point| text.len() - point - 1));
        EARTH_M * (1.0 / 60.0_f64).to_radians() * libm::pow(10.0, -(decimals.unwrap_or(0) as f64))
    }

    pub(super) fn long_date(&self) -> Option<(i32, u8, u8)> {
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
pub(super) fn short_date(text: &[u8]) -> Option<(i32, u8, u8)> {
    let year = i32::from(two(text, 4)?);
    Some((if year >= 80 { 1900 + year } else { 2000 + year }, two(text, 2)?, two(text, 0)?))
}

/// `hhmmss.sss`; a leap second has second 60.
pub(super) fn of_day(text: &[u8]) -> Option<OfDay> {
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

/// Speed of a VTG sentence, whose mode says that it was measured or estimated where it has one. Its numbers have the letter of their unit behind them; the
/// old form has four numbers and no letter: true and magnetic track, knots, kilometres an hour.
pub(super) fn vtg_speed_mps(vtg: &Sentence<'_>) -> Result<Option<f64>, &'static str> {
    let old = vtg.get(5).is_none() && vtg.get(2) != Some(b"T");
    let [knots, kmh] = if old { [3, 4] } else { [5, 7] }.map(|at| vtg.number(at));
    let [knots_mps, kmh_mps] = [knots.map(|knots| knots * KNOT_MPS), kmh.map(|kmh| kmh / 3.6)];
    let lettered = |(at, unit): (usize, &[u8])| vtg.get(at).is_none_or(<[u8]>::is_empty) || vtg.get(at + 1) == Some(unit);
    let units: [(usize, &[u8]); 4] = [(1, b"T"), (3, b"M"), (5, b"N"), (7, b"K")];
    // Without a unit both speeds together say what they are.
    let one =
        || knots_mps.zip(kmh_mps).is_none_or(|(one, other)| (one - other).abs() <= SAME_SPEED * one.abs().max(other.abs()) + SLOW_MPS);
    if !(vtg.sound(if old { &[1, 2, 3, 4] } else { &[1, 3, 5, 7] }) && if old { one() } else { units.into_iter().all(lettered) }) {
        return Err("VTG is in no form that is read");
    }
    // A speed that is estimated speaks of the positions beside it all the same.
    let measured = vtg.get(9).is_none_or(|mode| mode.iter().all(|letter| NMEA_MODES.contains(letter) || *letter == b'E'));
    Ok(knots_mps.or(kmh_mps).filter(|speed_mps| measured && *speed_mps >= 0.0))
}

/// Two speeds of one sentence are one within this share and so much more, as they are rounded apart. Provenance: ours \[1, m/s\].
const SAME_SPEED: f64 = 0.02;
const SLOW_MPS: f64 = 0.5;
