//! Precise orbits: SP3, versions a to d.
//!
//! Source: B. Remondi, "Extending the National Geodetic Survey standard GPS orbit formats" (a), S. Hilla, "The extended standard
//! product 3 orbit format" (c, 2010; d, 2016); provenance: standard.

use crate::precise::{Precise, put};
use crate::refusal::{Refusal, Unreadable};
use crate::rinex::header::Lines;
use crate::rinex::number::{Field, columns, fixed, seconds_ns, text, whole};
use crate::time::{Calendar, Scale, from_calendar};
use nalgebra::Vector3;
use navbound_core::frame::EcefPosition;
use navbound_core::geometry::precise::{ClockNode, OrbitNode};
use navbound_core::quantity::GpsTime;
use navbound_core::signal::{Constellation, SatelliteId};

/// Clocks of this size \[µs\] and more mean "absent".
const NO_CLOCK_US: f64 = 999_999.0;
/// International atomic time is ahead of GPS time by this.
const ATOMIC_AHEAD_NS: i64 = 19_000_000_000;
/// Farther from the Earth's centre no satellite of a navigation system is \[m\].
const FARTHEST: f64 = 1.0e8;

/// Read an SP3 file, plain (see [`crate::packed::unpack`]).
///
/// Positions and clocks are kept, velocities and correlations counted. Values that the format marks absent (a position of zeros, a
/// clock of 999999.999999) are absent here too.
///
/// # Errors
/// [`Unreadable`] unless it begins with an SP3 header of version a, b, c or d in a known time system. A line that cannot be read is put
/// into `refused`, and the others stand.
pub fn read(bytes: &[u8]) -> Result<Precise, Unreadable> {
    let mut lines = Lines::new(bytes);
    let first = lines.next().ok_or_else(|| Unreadable::whole("the file is empty"))?;
    if !matches!(first, [b'#', b'a'..=b'd', b'P' | b'V', ..]) {
        let heading = text(first, 0, 60);
        return Err(Unreadable::at(1, format!("not an SP3 file: its first line is '{heading}', not '#', a version a to d, and P or V")));
    }
    let mut p = Precise::default();
    p.frames.insert(text(first, 46, 51));
    p.agencies.insert(text(first, 56, 60));
    let (mut clock, mut now) = (None, None);
    while let Some(line) = lines.next() {
        let number = lines.number;
        match line.first() {
            Some(b'%') if line.get(1) == Some(&b'c') && clock.is_none() => clock = Some(time_system(line, number)?),
            Some(b'*') => {
                now = epoch(line, clock.unwrap_or((Scale::Gps, 0)));
                if now.is_none() {
                    refuse(&mut p, number, "epoch", "not a date; its positions are left out", line);
                }
            }
            Some(b'P') => position(line, number, now, &mut p),
            Some(b'V') => p.skip("velocity"),
            Some(b'E') if line.starts_with(b"EOF") => break,
            Some(b'E') => p.skip("correlation"),
            Some(b'#' | b'+' | b'%' | b'/') | None => {}
            Some(_) => refuse(&mut p, number, "line", "not a line of SP3", line),
        }
    }
    p.sort();
    Ok(p)
}

fn refuse(p: &mut Precise, line: usize, field: &str, reason: &str, bytes: &[u8]) {
    p.refused.push(Refusal { line, field: field.to_owned(), reason: reason.to_owned(), text: text(bytes, 0, 80) });
}

/// Scale of the epochs, and what it is ahead of that; versions a and b write `ccc` and mean GPS time.
fn time_system(line: &[u8], number: usize) -> Result<(Scale, i64), Unreadable> {
    match text(line, 9, 12).as_str() {
        // The systems' own times agree with GPS time to some nanoseconds, and orbits move 4 m in a millisecond.
        "GPS" | "GAL" | "QZS" | "IRN" | "ccc" | "" => Ok((Scale::Gps, 0)),
        "UTC" | "GLO" => Ok((Scale::Utc, 0)),
        "BDT" => Ok((Scale::BeiDou, 0)),
        "TAI" => Ok((Scale::Gps, ATOMIC_AHEAD_NS)),
        other => {
            let reason = format!("time system '{other}' is not one of GPS, GAL, QZS, IRN, UTC, GLO, BDT, TAI");
            Err(Unreadable { line: Some(number), field: Some("time system".to_owned()), reason })
        }
    }
}

fn epoch(line: &[u8], (scale, ahead_ns): (Scale, i64)) -> Option<GpsTime> {
    let small = |from, to| whole(columns(line, from, to)).and_then(|v| u8::try_from(v).ok());
    let calendar = Calendar {
        year: i32::try_from(whole(columns(line, 3, 7))?).ok()?,
        month: small(8, 10)?,
        day: small(11, 13)?,
        hour: small(14, 16)?,
        minute: small(17, 19)?,
        nanoseconds: seconds_ns(columns(line, 20, 31))?,
    };
    Some(GpsTime::from_nanoseconds(from_calendar(calendar, scale)?.nanoseconds() - ahead_ns))
}

/// `PG01 x y z clock`: kilometres and microseconds.
fn position(line: &[u8], number: usize, now: Option<GpsTime>, p: &mut Precise) {
    let Some(time) = now else { return p.skip("position without an epoch") };
    let Some(satellite) = satellite(columns(line, 1, 4)) else { return unknown(line, number, p) };
    let mut km = [0.0; 3];
    for (k, value) in km.iter_mut().enumerate() {
        match fixed(line, 4 + 14 * k, 18 + 14 * k) {
            Field::Number(v) => *value = v,
            _ => return refuse(p, number, "position", "not three numbers", line),
        }
    }
    if km != [0.0; 3] {
        let position = Vector3::from(km) * 1e3;
        if !(position.norm() < FARTHEST) {
            return refuse(p, number, "position", "farther than 100 000 km", line);
        }
        let node = OrbitNode { time, position: EcefPosition::from_vector(position) };
        if !put(p.orbits.entry(satellite).or_default(), node, |n| n.time) {
            // The clocks beside two positions are no better than these.
            p.orbit_clocks.entry(satellite).or_default().retain(|n| n.time != time);
            return refuse(p, number, "satellite", "a second and other position in one epoch; neither is taken", line);
        }
    }
    match fixed(line, 46, 60) {
        Field::Number(us) if us.abs() < NO_CLOCK_US => {
            let node = ClockNode { time, bias_s: us * 1e-6 };
            if !put(p.orbit_clocks.entry(satellite).or_default(), node, |n| n.time) {
                refuse(p, number, "clock", "a second and other clock in one epoch; neither is taken", line);
            }
        }
        Field::Bad => refuse(p, number, "clock", "not a number", line),
        _ => {}
    }
}

/// `G01`; version a leaves the letter out and means GPS.
fn satellite(field: &[u8]) -> Option<SatelliteId> {
    let letter = *field.first()?;
    let constellation = if letter == b' ' { Constellation::Gps } else { Constellation::from_letter(letter)? };
    let number = whole(columns(field, 1, 3)).and_then(|n| u8::try_from(n).ok()).filter(|n| constellation.numbers().contains(n))?;
    Some(SatelliteId { constellation, number })
}

fn unknown(line: &[u8], number: usize, p: &mut Precise) {
    match line.get(1) {
        Some(letter @ (b'J' | b'I' | b'L')) => p.skip(&format!("{} position", char::from(*letter))),
        _ => refuse(p, number, "satellite", "not a satellite of a known system", line),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const HEAD: &str = "#cP2020  6 25  0  0  0.00000000      96 TRACK IGb14 FIT GRGS
## 2111 345600.00000000   900.00000000 59025 0.0000000000000
%c M  cc GPS ccc cccc cccc cccc cccc ccccc ccccc ccccc ccccc
";
    const BODY: &str = "*  2020  6 25  0 15  0.00000000
PE01 -11562.163582  14053.114306  23345.128269   -884.707516
PG02      0.000000      0.000000      0.000000 999999.999999
PG03  11459.480933 -14087.476822 -23374.096011 999999.999999
PJ01  11459.480933 -14087.476822 -23374.096011 999999.999999
VG03      0.000000      0.000000      0.000000 999999.999999
EOF
";

    fn read_text(text: &str) -> Precise {
        read(text.as_bytes()).unwrap()
    }

    #[test]
    fn positions_and_clocks_arrive_in_metres_and_seconds_of_gps_time() {
        let p = read_text(&format!("{HEAD}{BODY}"));
        let e01 = SatelliteId { constellation: Constellation::Galileo, number: 1 };
        let node = p.orbits[&e01][0];
        // Week and time of week stand in the header: 2111, 345600 s, and a quarter of an hour later.
        assert_eq!(node.time.nanoseconds(), (2111 * 604_800 + 345_600 + 900) * 1_000_000_000);
        assert!((node.position.vector() - Vector3::new(-11_562_163.582, 14_053_114.306, 23_345_128.269)).norm() < 1e-6);
        assert!((p.orbit_clocks[&e01][0].bias_s + 884.707516e-6).abs() < 1e-18);
        // Zeros and nines are absent: G02 has neither position nor clock, G03 no clock.
        assert_eq!((p.orbits.len(), p.orbit_clocks.len(), p.refused.len()), (2, 1, 0));
        assert_eq!((p.skipped["velocity"], p.skipped["J position"]), (1, 1));
        assert_eq!((p.frames.contains("IGb14"), p.agencies.contains("GRGS")), (true, true));
    }

    #[test]
    fn version_a_has_no_letter_and_counts_in_gps_time() {
        let head = HEAD.replace("#cP", "#aP").replace("M  cc GPS", "cc cc ccc");
        let p =
            read_text(&format!("{head}*  2020  6 25  0  0  0.00000000\nP  7  18829.174521  13507.523267 -13215.249720     -2.670218\n"));
        let g07 = SatelliteId { constellation: Constellation::Gps, number: 7 };
        assert_eq!(p.orbits[&g07][0].time.nanoseconds(), (2111 * 604_800 + 345_600) * 1_000_000_000);
    }

    #[test]
    fn other_time_systems_become_gps_time() {
        let start = |system: &str| read_text(&format!("{}{BODY}", HEAD.replace("GPS", system))).orbits.values().next().unwrap()[0].time;
        // In 2020 GPS time led UTC by 18 s (IERS bulletin C 52); TAI leads GPS time by 19 s and BDT is 14 s behind it (their definitions).
        assert_eq!(start("UTC").seconds_since(start("GPS")), 18.0);
        assert_eq!(start("BDT").seconds_since(start("GPS")), 14.0);
        assert_eq!(start("TAI").seconds_since(start("GPS")), -19.0);
        assert!(read(format!("{}{BODY}", HEAD.replace("GPS", "XYZ")).as_bytes()).unwrap_err().reason.contains("XYZ"));
    }

    #[test]
    fn what_cannot_be_read_is_listed_and_the_rest_stands() {
        let broken = BODY.replace("14053.114306", "14x53.114306").replace("PG03  11459.480933", "PG03 911459480933");
        let p = read_text(&format!("{HEAD}{broken}"));
        assert_eq!(p.refused.len(), 2, "{:?}", p.refused);
        assert_eq!((p.refused[0].line, p.refused[0].field.as_str()), (5, "position"));
        assert!(p.orbits.is_empty());
        assert_eq!(read_text(&format!("{HEAD}{}", BODY.replace("2020  6 25", "2020 13 25"))).orbits.len(), 0);
        for bad in ["", "# nothing", "*  2020", "     3.05           O"] {
            assert!(read(bad.as_bytes()).is_err(), "{bad}");
        }
    }

    proptest! {
        #[test]
        fn any_bytes_get_an_answer(tail in proptest::collection::vec(any::<u8>(), 0..400)) {
            let _ = read(&[HEAD.as_bytes(), &tail].concat());
            let _ = read(&tail);
        }
    }
}
