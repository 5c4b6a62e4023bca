//! Bodies of plain observation files.

use super::header::Lines;
use super::heading::{Heading, satellite};
use super::number::{Field, columns, decimal, seconds_ns, whole};
use super::observation::Observations;
use super::value::{indicators, observation};
use crate::refusal::Unreadable;
use crate::time::{Calendar, Scale, from_calendar};
use navbound_core::quantity::GpsTime;
use navbound_core::signal::SatelliteId;

/// First line of an epoch.
#[derive(Debug, Clone, Copy)]
pub(super) struct Head {
    pub(super) time: Option<GpsTime>,
    pub(super) flag: u8,
    /// Satellites, or lines of an event.
    pub(super) count: usize,
    pub(super) clock_offset_s: f64,
}

impl Head {
    /// Observations follow (flag 0 and 1), not an event record.
    pub(super) fn observes(&self) -> bool {
        self.flag <= 1
    }

    /// The line of version 2: ` yy mm dd hh mm ss.sssssss  f nnn`.
    pub(super) fn second(line: &[u8], scale: Scale) -> Result<Self, &'static str> {
        let year = whole(columns(line, 1, 3)).map(|y| if y < 80 { 2000 + y } else { 1900 + y });
        let clock = decimal(columns(line, 68, 80));
        Self::assemble(line, year, [4, 7, 10, 13], (15, 26), (28, 29, 32), clock, scale)
    }

    /// The line of version 3: `> yyyy mm dd hh mm ss.sssssss  f nnn`.
    pub(super) fn third(line: &[u8], scale: Scale) -> Result<Self, &'static str> {
        Self::assemble(line, whole(columns(line, 2, 6)), [7, 10, 13, 16], (18, 29), (31, 32, 35), decimal(columns(line, 41, 56)), scale)
    }

    fn assemble(
        line: &[u8],
        year: Option<i64>,
        starts: [usize; 4],
        seconds: (usize, usize),
        (flag, from, to): (usize, usize, usize),
        clock: Field,
        scale: Scale,
    ) -> Result<Self, &'static str> {
        let small = |k: usize| whole(columns(line, starts[k], starts[k] + 2)).and_then(|v| u8::try_from(v).ok());
        let calendar = || {
            Some(Calendar {
                year: i32::try_from(year?).ok()?,
                month: small(0)?,
                day: small(1)?,
                hour: small(2)?,
                minute: small(3)?,
                nanoseconds: seconds_ns(columns(line, seconds.0, seconds.1))?,
            })
        };
        let time = calendar().and_then(|c| from_calendar(c, scale));
        let flag = match columns(line, flag, flag + 1) {
            [] | [b' '] => 0,
            [digit @ b'0'..=b'6'] => digit - b'0',
            _ => return Err("epoch flag is not 0 to 6"),
        };
        if time.is_none() && flag <= 1 {
            return Err("epoch is not a date");
        }
        let count = whole(columns(line, from, to)).and_then(|n| usize::try_from(n).ok()).ok_or("number of satellites is not a number")?;
        let clock_offset_s = if let Field::Number(v) = clock { v } else { f64::NAN };
        Ok(Self { time, flag, count, clock_offset_s })
    }
}

/// Lines of an event, or satellites of a cycle-slip record: counted. Codes that change in the middle of a file are reported.
pub(super) fn event(lines: &mut Lines<'_>, head: &Head, n_lines: usize, o: &mut Observations) {
    o.skip(&format!("event {}", head.flag), 1);
    for _ in 0..n_lines {
        let Some(line) = lines.next() else { return };
        let label = super::header::label(line);
        if matches!(label, b"SYS / # / OBS TYPES" | b"# / TYPES OF OBSERV" | b"SYS / SCALE FACTOR") {
            o.refuse(lines.number, "event", "codes changed in the middle of a file are not followed; split the file here", line);
        }
    }
}

/// Body of version 3 and 4.
pub(super) fn third(mut lines: Lines<'_>, heading: &Heading, o: &mut Observations) {
    let mut next = lines.next();
    // Whether the epoch that the next line could belong to is refused already.
    let mut refused = false;
    while let Some(line) = next {
        if line.first() != Some(&b'>') {
            if !line.trim_ascii().is_empty() {
                let reason = "an epoch line, which begins with '>', was expected";
                if refused {
                    o.refuse(lines.number, "epoch", reason, line)
                } else {
                    o.lose(lines.number, reason, line)
                }
                refused = true;
            }
            next = lines.next();
            continue;
        }
        refused = false;
        match Head::third(line, heading.time) {
            Err(reason) => {
                o.lose(lines.number, reason, line);
                refused = true;
                next = lines.next();
            }
            Ok(head) if !head.observes() => {
                event(&mut lines, &head, head.count, o);
                next = lines.next();
            }
            Ok(head) => next = epoch(&mut lines, &head, heading, o),
        }
    }
}

/// Satellites of an epoch; gives the line after it.
fn epoch<'a>(lines: &mut Lines<'a>, head: &Head, heading: &Heading, o: &mut Observations) -> Option<&'a [u8]> {
    for done in 0..head.count {
        let line = lines.next();
        let Some(line) = line.filter(|l| l.first() != Some(&b'>')) else {
            let reason = format!("the epoch has {done} of {} satellites; it was left out", head.count);
            o.lose(lines.number, &reason, line.unwrap_or_default());
            o.abandon_epoch();
            return line;
        };
        match satellite(columns(line, 0, 3), heading.system) {
            Ok(satellite) => {
                o.begin_satellite(satellite);
                fields(columns(line, 3, usize::MAX), o.n_codes(satellite.constellation), lines.number, o);
            }
            Err(letter) => unread(letter, line, lines.number, o),
        }
    }
    if let Some(time) = head.time {
        o.end_epoch(time, head.flag == 1, head.clock_offset_s, lines.number);
    }
    lines.next()
}

pub(super) fn unread(letter: u8, line: &[u8], number: usize, o: &mut Observations) {
    if letter == b'?' {
        o.refuse(number, "satellite", "not a satellite of a known system", line);
    } else {
        o.skip(&format!("satellites of {}", char::from(letter)), 1);
    }
}

/// `n` observations of sixteen columns; what the line lacks is absent.
fn fields(mut rest: &[u8], n: usize, number: usize, o: &mut Observations) {
    for k in 0..n {
        let Some((field, tail)) = rest.split_first_chunk::<16>() else {
            // The last of a line whose indicators, or all of it, were cut off: what is missing is blank.
            let mut whole = [b' '; 16];
            whole[..rest.len()].copy_from_slice(rest);
            // A number within whose columns the line ends has lost its last digits.
            if rest.len() < 14 && !rest.trim_ascii().is_empty() {
                o.refuse(number, &format!("observation {}", k + 1), "the line ends within the number", rest);
                whole = [b' '; 16];
            }
            self::field(&whole, k, number, o);
            rest = &[];
            continue;
        };
        rest = tail;
        self::field(field, k, number, o);
    }
    if !rest.trim_ascii().is_empty() {
        o.refuse(number, "observation", "more values than the header names codes", rest);
    }
}

/// One observation with its indicators.
#[inline(always)]
fn field(field: &[u8; 16], k: usize, number: usize, o: &mut Observations) {
    if let Some((text, [lock, strength])) = field.split_first_chunk::<14>()
        && let (Some(value), Some(indicator)) = (observation(text), indicators(*lock, *strength))
    {
        o.push(value, indicator);
    } else {
        o.refuse(number, &format!("observation {}", k + 1), "not a number with its indicators", field);
        o.push(f64::NAN, 0);
    }
}

/// Body of version 2. It has no mark where an epoch begins: a line that is not understood ends the reading.
pub(super) fn second(mut lines: Lines<'_>, heading: &Heading, o: &mut Observations) -> Result<(), Unreadable> {
    // Codes are the same for every system in version 2.
    let n_codes = o.codes[0].len();
    let n_lines = n_codes.div_ceil(5);
    let mut satellites: Vec<Result<SatelliteId, u8>> = Vec::new();
    while let Some(line) = lines.next() {
        if line.trim_ascii().is_empty() {
            continue;
        }
        let unreadable = |number, reason: &str| Unreadable {
            line: Some(number),
            field: Some("epoch".to_owned()),
            reason: format!("{reason}: '{}'", super::number::text(line, 0, 80)),
        };
        let head = Head::second(line, heading.time).map_err(|reason| unreadable(lines.number, reason))?;
        if !head.observes() && head.flag != 6 {
            event(&mut lines, &head, head.count, o);
            continue;
        }
        if head.count > 999 {
            return Err(unreadable(lines.number, "more than 999 satellites"));
        }
        satellites.clear();
        let mut list = line;
        for k in 0..head.count {
            if k > 0 && k % 12 == 0 {
                list = lines.next().unwrap_or_default();
            }
            let from = 32 + 3 * (k % 12);
            satellites.push(satellite(columns(list, from, from + 3), heading.system));
        }
        if head.flag == 6 {
            event(&mut lines, &head, head.count * n_lines, o);
        } else {
            second_epoch(&mut lines, &head, &satellites, n_codes, o);
        }
    }
    Ok(())
}

fn second_epoch(lines: &mut Lines<'_>, head: &Head, satellites: &[Result<SatelliteId, u8>], n_codes: usize, o: &mut Observations) {
    for each in satellites {
        match each {
            Ok(satellite) => o.begin_satellite(*satellite),
            Err(letter) => unread(*letter, b"", lines.number, o),
        }
        for first in (0..n_codes).step_by(5) {
            let Some(line) = lines.next() else {
                o.lose(lines.number, "the file ends within an epoch, which was left out", b"");
                o.abandon_epoch();
                return;
            };
            if each.is_ok() {
                fields(line, (n_codes - first).min(5), lines.number, o);
            }
        }
    }
    if let Some(time) = head.time {
        o.end_epoch(time, head.flag == 1, head.clock_offset_s, lines.number);
    }
}
