//! Clock files: satellite clocks at 5 min to 5 s.
//!
//! Source: J. Ray and W. Gurtner, "RINEX extensions to handle clock information" 2.00, 3.00, and 3.04 (IGS); provenance: standard.

use super::header::{Lines, label};
use super::heading::satellite;
use super::number::{Field, columns, fixed, seconds_ns, text, whole};
use crate::precise::{Precise, put};
use crate::refusal::{Refusal, Unreadable};
use crate::time::{Calendar, Scale, from_calendar};
use navbound_core::geometry::precise::ClockNode;
use navbound_core::quantity::GpsTime;
use navbound_core::signal::Constellation;

/// Read a clock file, plain (see [`crate::packed::unpack`]). Satellite clocks (`AS`) are kept, those of stations counted.
///
/// # Errors
/// [`Unreadable`] unless it begins with the header of a RINEX clock file in a known time system. A record that cannot be read is put
/// into `refused`, and the others stand.
pub fn read_clocks(bytes: &[u8]) -> Result<Precise, Unreadable> {
    let mut lines = Lines::new(bytes);
    let first = lines.next().ok_or_else(|| Unreadable::whole("the file is empty"))?;
    // Version 3.04 widened the header: its label stands five columns farther right.
    let wide = columns(first, 65, 85).trim_ascii() == b"RINEX VERSION / TYPE";
    let is_clock = (wide || label(first) == b"RINEX VERSION / TYPE") && columns(first, 20, 22).contains(&b'C');
    if !is_clock {
        return Err(Unreadable::at(1, format!("not a RINEX clock file: its first line is '{}'", text(first, 0, 80))));
    }
    let mut p = Precise::default();
    let scale = header(&mut lines, wide, &mut p)?;
    while let Some(line) = lines.next() {
        match columns(line, 0, 3) {
            b"AS " => match record(line, scale) {
                Ok(Some((satellite, node))) => {
                    if !put(p.clocks.entry(satellite).or_default(), node, |n| n.time) {
                        refuse(&mut p, lines.number, ("clock", "a second and other clock of one instant; neither is taken"), line);
                    }
                }
                Ok(None) => p.skip("J or I clock"),
                Err(why) => refuse(&mut p, lines.number, why, line),
            },
            kind @ (b"AR " | b"CR " | b"DR " | b"MS ") => p.skip(&text(kind, 0, 2)),
            // A continuation line of more than two values begins with blanks.
            _ => {}
        }
    }
    p.sort();
    Ok(p)
}

fn refuse(p: &mut Precise, number: usize, (field, reason): (&str, &str), line: &[u8]) {
    p.refused.push(Refusal { line: number, field: field.to_owned(), reason: reason.to_owned(), text: text(line, 0, 80) });
}

fn header(lines: &mut Lines<'_>, wide: bool, p: &mut Precise) -> Result<Scale, Unreadable> {
    let mut scale = Scale::Gps;
    while let Some(line) = lines.next() {
        let label = if wide { columns(line, 65, 85).trim_ascii() } else { label(line) };
        match label {
            b"END OF HEADER" => return Ok(scale),
            b"ANALYSIS CENTER" => _ = p.agencies.insert(text(line, 0, 3)),
            b"TIME SYSTEM ID" => {
                scale = match text(line, 3, 6).as_str() {
                    "GPS" | "GAL" | "QZS" | "IRN" | "" => Scale::Gps,
                    "UTC" | "GLO" => Scale::Utc,
                    "BDT" | "BDS" => Scale::BeiDou,
                    other => {
                        let reason = format!("time system '{other}' is not one of GPS, GAL, QZS, IRN, UTC, GLO, BDT");
                        return Err(Unreadable { line: Some(lines.number), field: Some("TIME SYSTEM ID".to_owned()), reason });
                    }
                }
            }
            _ => {}
        }
    }
    Err(Unreadable::whole("the header has no END OF HEADER"))
}

type Row = Option<(navbound_core::signal::SatelliteId, ClockNode)>;

/// `AS G01  2020  6 25  0  0  0.000000  2   -0.884707516318E-03 ...`; `None` for a satellite of a system that is not read.
fn record(line: &[u8], scale: Scale) -> Result<Row, (&'static str, &'static str)> {
    // Version 3.04 writes names of nine characters, older ones of four: what follows moves by five columns.
    let shift = usize::from(columns(line, 8, 12).trim_ascii().is_empty()) * 5;
    let satellite = match satellite(columns(line, 3, 6), Constellation::Gps) {
        Ok(satellite) => satellite,
        Err(b'J' | b'I') => return Ok(None),
        Err(_) => return Err(("satellite", "not a satellite of a known system")),
    };
    let time = time(line.get(shift..).unwrap_or_default(), scale).ok_or(("epoch", "not a date"))?;
    match fixed(line, 40 + shift, 59 + shift) {
        Field::Number(bias_s) if bias_s.abs() < 1.0 => Ok(Some((satellite, ClockNode { time, bias_s }))),
        _ => Err(("clock bias", "not a number of seconds below 1")),
    }
}

fn time(line: &[u8], scale: Scale) -> Option<GpsTime> {
    let small = |from, to| whole(columns(line, from, to)).and_then(|v| u8::try_from(v).ok());
    let calendar = Calendar {
        year: i32::try_from(whole(columns(line, 8, 12))?).ok()?,
        month: small(13, 15)?,
        day: small(16, 18)?,
        hour: small(19, 21)?,
        minute: small(22, 24)?,
        nanoseconds: seconds_ns(columns(line, 24, 34))?,
    };
    from_calendar(calendar, scale)
}

#[cfg(test)]
mod tests {
    use super::*;
    use navbound_core::signal::SatelliteId;
    use proptest::prelude::*;

    const HEAD: &str = "     3.00           C                                       RINEX VERSION / TYPE
   GPS                                                      TIME SYSTEM ID
                                                            END OF HEADER
";
    const BODY: &str = "AR GPST 2010 07 01 00 00  0.000000  2   -2.214541847585e-09  0.000000000000e+00
AS G02  2010 07 01 00 05  0.000000  2    2.691095123456e-04  1.0e-11
AS J02  2010 07 01 00 05  0.000000  2    2.691095123456e-04  1.0e-11
";

    #[test]
    fn satellite_clocks_arrive_and_others_are_counted() {
        let p = read_clocks(format!("{HEAD}{BODY}").as_bytes()).unwrap();
        let g02 = SatelliteId { constellation: Constellation::Gps, number: 2 };
        // 2010-07-01 is day 4 of week 1590 (header of igs15904.sp3).
        let time = GpsTime::from_nanoseconds((1590 * 604_800 + 345_600 + 300) * 1_000_000_000);
        assert_eq!(p.clocks[&g02], [ClockNode { time, bias_s: 2.691095123456e-4 }]);
        assert_eq!((p.skipped["AR"], p.skipped["J or I clock"], p.refused.len()), (1, 1, 0));
    }

    #[test]
    fn version_3_04_stands_five_columns_farther_right() {
        let head = "3.04                 C                                           RINEX VERSION / TYPE
                                                                 END OF HEADER
";
        let body = "AS G02       2010 07 01 00 05  0.000000  2    2.691095123456e-04  1.0e-11\n";
        let (old, new) = (read_clocks(format!("{HEAD}{BODY}").as_bytes()), read_clocks(format!("{head}{body}").as_bytes()));
        assert_eq!(old.unwrap().clocks, new.unwrap().clocks);
    }

    #[test]
    fn damage_is_listed_and_other_files_are_refused() {
        let p = read_clocks(format!("{HEAD}{}", BODY.replace("2.691095123456e-04", "2.69109x123456e-04")).as_bytes()).unwrap();
        assert_eq!((p.refused.len(), p.refused[0].line, p.refused[0].field.as_str()), (1, 5, "clock bias"));
        assert!(read_clocks(HEAD.replace("   GPS", "   XYZ").as_bytes()).unwrap_err().reason.contains("XYZ"));
        assert!(read_clocks(&HEAD.as_bytes()[..90]).unwrap_err().reason.contains("END OF HEADER"));
        assert!(read_clocks(b"#cP2020").is_err() && read_clocks(b"").is_err());
    }

    proptest! {
        #[test]
        fn any_bytes_get_an_answer(tail in proptest::collection::vec(any::<u8>(), 0..400)) {
            let _ = read_clocks(&[HEAD.as_bytes(), &tail].concat());
            let _ = read_clocks(&tail);
        }
    }
}
