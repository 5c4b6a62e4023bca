//! Observations and broadcast records to the text of RINEX 3.05.
//!
//! What is written carries no date of its own: the same records give the same bytes. Source: RINEX 3.05, tables A2, A3, A5, A6, A8; standard.

use super::layout as at;
use super::{Navigation, Observations};
use crate::time::{Calendar, to_calendar};
use navbound_core::quantity::{GpsTime, OutOfDomain};
use navbound_core::signal::{Constellation, Ephemeris, Message};
use std::fmt::Write;

const VERSION: &str = "     3.05";
const WEEK_NS: i64 = 604_800_000_000_000;
/// Codes on a header line.
const CODES_A_LINE: usize = 13;
/// Largest value of an observation that its columns hold \[m, cycles, Hz\].
const LARGEST_VALUE: f64 = 999_999_999.0;
/// Data sources of Galileo's messages: I/NAV of E1-B and E5b with their clock, F/NAV of E5a with its own.
const INAV_SOURCES: u16 = 0b10_0000_0101;
const FNAV_SOURCES: u16 = 0b01_0000_0010;

fn header(out: &mut String, content: &str, label: &str) {
    // Into a string nothing can fail.
    _ = writeln!(out, "{content:<60}{label:<20}");
}

fn calendar(time: GpsTime) -> Result<Calendar, OutOfDomain> {
    let refused = OutOfDomain { argument: "time_ns", value: time.nanoseconds() as f64, unit: "ns", domain: "1980 to 2100" };
    to_calendar(time).ok_or(refused)
}

/// An observation file. Values have three decimals, times seven of a second; GPS time throughout.
///
/// # Errors
/// [`OutOfDomain`] where there is no epoch, for a value that its columns do not hold, and for a time outside 1980 to 2100.
pub fn observation_file(o: &Observations, program: &str) -> Result<String, OutOfDomain> {
    let none = OutOfDomain { argument: "observations", value: 0.0, unit: "epochs", domain: "one epoch at least" };
    let mut out = String::new();
    observation_header(o, program, *o.time.first().ok_or(none)?, &mut out)?;
    for epoch in 0..o.n_epochs() {
        let seen = o.satellites(epoch);
        let c = calendar(o.time[epoch])?;
        let flag = u8::from(o.interrupted[epoch]);
        _ = writeln!(out, "> {}{}  {flag}{:3}", date(&c), seconds(&c), seen.len());
        for k in seen {
            _ = write!(out, "{}", o.satellite[k]);
            for v in o.value_range(k) {
                value(o.value[v], o.indicator[v], &mut out)?;
            }
            let kept = out.trim_end_matches(' ').len();
            out.truncate(kept);
            out.push('\n');
        }
    }
    Ok(out)
}

fn observation_header(o: &Observations, program: &str, first: GpsTime, out: &mut String) -> Result<(), OutOfDomain> {
    header(out, &format!("{VERSION}           OBSERVATION DATA    M: MIXED"), "RINEX VERSION / TYPE");
    header(out, &cut(program, 20), "PGM / RUN BY / DATE");
    header(out, &cut(&o.marker, 60), "MARKER NAME");
    header(out, "", "OBSERVER / AGENCY");
    header(out, &format!("{:20}{:40}", "", cut(&o.receiver, 20)), "REC # / TYPE / VERS");
    header(out, &format!("{:20}{}", "", cut(&o.antenna, 20)), "ANT # / TYPE");
    let triple = |p: [f64; 3]| p.map(|x| format!("{x:14.4}")).concat();
    header(out, &triple(o.approximate_m.unwrap_or_default()), "APPROX POSITION XYZ");
    header(out, &triple(o.antenna_delta_m), "ANTENNA: DELTA H/E/N");
    for constellation in Constellation::ALL {
        for (n, codes) in o.codes[constellation.index()].chunks(CODES_A_LINE).enumerate() {
            let lead = if n > 0 { String::new() } else { format!("{}  {:3}", constellation.letter(), o.n_codes(constellation)) };
            let names: String = codes.iter().map(|c| format!(" {}", String::from_utf8_lossy(c))).collect();
            header(out, &format!("{lead:6}{names}"), "SYS / # / OBS TYPES");
        }
    }
    if let Some(interval_s) = o.interval_s {
        header(out, &format!("{interval_s:10.3}"), "INTERVAL");
    }
    let c = calendar(first)?;
    let day = format!("{:6}{:6}{:6}{:6}{:6}", c.year, c.month, c.day, c.hour, c.minute);
    header(out, &format!("{day}{:13.7}     GPS", c.nanoseconds as f64 * 1e-9), "TIME OF FIRST OBS");
    header(out, "", "END OF HEADER");
    Ok(())
}

fn cut(text: &str, columns: usize) -> String {
    text.chars().map(|c| if c.is_ascii_graphic() || c == ' ' { c } else { '?' }).take(columns).collect()
}

/// `2024 01 31 23 59`
fn date(c: &Calendar) -> String {
    format!("{:04} {:02} {:02} {:02} {:02}", c.year, c.month, c.day, c.hour, c.minute)
}

/// Seven decimals of a second, rounded down as an epoch cannot be in the next minute.
fn seconds(c: &Calendar) -> String {
    format!("{:3}.{:07}", c.nanoseconds / 1_000_000_000, c.nanoseconds % 1_000_000_000 / 100)
}

fn value(value: f64, indicator: u8, out: &mut String) -> Result<(), OutOfDomain> {
    let (width, decimals) = (at::VALUE_WIDTH, at::VALUE_DECIMALS);
    if value.is_nan() {
        _ = write!(out, "{:1$}", "", width + 2);
        return Ok(());
    }
    if !(value.abs() <= LARGEST_VALUE) {
        return Err(OutOfDomain { argument: "value", value, unit: "m, cycles, Hz", domain: "[-999999999, 999999999]" });
    }
    let digit = |n: u8| if n == 0 { ' ' } else { char::from(b'0' + n.min(9)) };
    _ = write!(out, "{value:width$.decimals$}{}{}", digit(indicator >> 4), digit(indicator & 0xf));
    Ok(())
}

/// A navigation file of GPS LNAV, Galileo I/NAV and F/NAV records, in the order of their clocks' times.
///
/// # Errors
/// [`OutOfDomain`] where there is no record, for a record of another message, a number that is not finite, and a time outside 1980 to 2100.
pub fn navigation_file(n: &Navigation, program: &str) -> Result<String, OutOfDomain> {
    if n.ephemerides.is_empty() {
        return Err(OutOfDomain { argument: "navigation", value: 0.0, unit: "records", domain: "one record at least" });
    }
    let mut out = String::new();
    header(&mut out, &format!("{VERSION}           N: GNSS NAV DATA    M: MIXED"), "RINEX VERSION / TYPE");
    header(&mut out, &cut(program, 20), "PGM / RUN BY / DATE");
    if let Some(k) = &n.klobuchar_gps {
        for (name, values) in [("GPSA", k.alpha), ("GPSB", k.beta)] {
            header(&mut out, &format!("{name} {}", values.map(|v| fortran(v, 12, 4)).concat()), "IONOSPHERIC CORR");
        }
    }
    if let Some(leap) = n.leap_seconds {
        header(&mut out, &format!("{leap:6}"), "LEAP SECONDS");
    }
    header(&mut out, "", "END OF HEADER");
    let mut records: Vec<&Ephemeris> = n.ephemerides.iter().collect();
    records.sort_by_key(|e| (e.clock_time, e.satellite, e.message, e.orbit_time));
    for e in records {
        record(e, &mut out)?;
    }
    Ok(out)
}

fn record(e: &Ephemeris, out: &mut String) -> Result<(), OutOfDomain> {
    let numbers = numbers(e)?;
    if let Some(value) = numbers.iter().find(|v| !(v.abs() < 1e99)) {
        return Err(OutOfDomain { argument: "ephemeris", value: *value, unit: "1", domain: "finite numbers" });
    }
    let c = calendar(e.clock_time)?;
    _ = write!(out, "{} {} {:02}", e.satellite, date(&c), c.nanoseconds / 1_000_000_000);
    for (k, number) in numbers.iter().enumerate() {
        if k >= 3 && (k - 3) % 4 == 0 {
            out.push_str("\n    ");
        }
        out.push_str(&fortran(*number, at::WIDTH, at::DECIMALS));
    }
    out.push('\n');
    Ok(())
}

/// The numbers of a record in their places.
fn numbers(e: &Ephemeris) -> Result<[f64; at::NUMBERS], OutOfDomain> {
    let within_week = |t: GpsTime| t.nanoseconds().rem_euclid(WEEK_NS) as f64 * 1e-9;
    let (sources, last, fit_h) = match e.message {
        Message::Lnav => (0, f64::from(e.issue_clock), e.fit_interval_s / 3600.0),
        Message::Inav => (INAV_SOURCES, e.group_delay_s[1], 0.0),
        Message::Fnav => (FNAV_SOURCES, e.group_delay_s[1], 0.0),
        _ => {
            let value = f64::from(e.satellite.number);
            return Err(OutOfDomain { argument: "message", value, unit: "BeiDou", domain: "LNAV, I/NAV and F/NAV, which are written" });
        }
    };
    let mut v = [0.0; at::NUMBERS];
    v[..3].copy_from_slice(&e.clock);
    for (place, number) in [
        (at::ISSUE, f64::from(e.issue_orbit)),
        (at::CRS, e.radius_harmonics[1]),
        (at::DELTA_N, e.delta_n),
        (at::MEAN_ANOMALY, e.mean_anomaly),
        (at::CUC, e.latitude_harmonics[0]),
        (at::ECCENTRICITY, e.eccentricity),
        (at::CUS, e.latitude_harmonics[1]),
        (at::SQRT_A, e.sqrt_a),
        (at::ORBIT_TIME, within_week(e.orbit_time)),
        (at::CIC, e.inclination_harmonics[0]),
        (at::NODE, e.node[0]),
        (at::CIS, e.inclination_harmonics[1]),
        (at::INCLINATION, e.inclination[0]),
        (at::CRC, e.radius_harmonics[0]),
        (at::PERIGEE, e.perigee),
        (at::NODE_RATE, e.node[1]),
        (at::INCLINATION_RATE, e.inclination[1]),
        (at::SOURCES, f64::from(sources)),
        (at::WEEK, e.orbit_time.nanoseconds().div_euclid(WEEK_NS) as f64),
        (at::ACCURACY, e.accuracy_m),
        (at::HEALTH, f64::from(e.health.word)),
        (at::DELAY, e.group_delay_s[0]),
        (at::DELAY_OR_ISSUE, last),
        // The standard's word for a time of transmission that is not known.
        (at::SENT, e.sent.map_or(0.9999e9, within_week)),
        (at::FIT, fit_h),
    ] {
        v[place] = number;
    }
    Ok(v)
}

/// A number as Fortran's D format writes it with one digit before the point.
fn fortran(value: f64, width: usize, decimals: usize) -> String {
    let plain = format!("{value:.decimals$e}");
    let (mantissa, exponent) = plain.split_once('e').unwrap_or((&plain, "0"));
    let (sign, digits) = exponent.strip_prefix('-').map_or(('+', exponent), |digits| ('-', digits));
    format!("{:>width$}", format!("{mantissa}D{sign}{digits:0>2}"))
}

#[cfg(test)]
#[path = "write_tests.rs"]
mod tests;
