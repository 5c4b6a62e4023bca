//! Almanacs of GPS: YUMA and SEM.
//!
//! Source: U.S. Coast Guard Navigation Center, "Definition of a YUMA almanac" and "Definition of a SEM almanac"; IS-GPS-200 20.3.3.5.2
//! (meaning of the elements); provenance: standard.

use crate::refusal::Unreadable;
use crate::rinex::header::Lines;
use crate::rinex::number::{Field, decimal, text, whole};
use navbound_core::geometry::Elements;
use navbound_core::quantity::{GpsTime, Metres, Radians};
use navbound_core::signal::{Constellation, SatelliteId};

/// Inclination that SEM counts from \[semicircles\].
const SEM_INCLINATION: f64 = 0.30;
const WEEK_S: f64 = 604_800.0;
/// Weeks in the ten bits that satellites send.
const ROLLOVER: i64 = 1024;
/// More satellites are no almanac of one system.
const MOST_SATELLITES: usize = 64;

/// One satellite of an almanac.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Entry {
    /// Which.
    pub satellite: SatelliteId,
    /// Health word, 0 good.
    pub health: u16,
    /// Week as the file has it: modulo 1024 in most.
    pub week: i64,
    /// Time of applicability in that week \[s\].
    pub time_of_week_s: f64,
    /// Elements at that time, the node counted from Greenwich as it stands then.
    pub elements: Elements,
    /// Clock \[s\], \[s/s\].
    pub clock: [f64; 2],
}

/// The reference instant of an almanac, the full week resolved.
///
/// A week below 1024 has rolled over an unknown number of times: the one nearest to `near` counts. Without `near` such a week has no
/// instant. A full week number stands for itself.
pub fn reference(week: i64, time_of_week_s: f64, near: Option<GpsTime>) -> Option<GpsTime> {
    const WEEK_NS: i64 = 604_800_000_000_000;
    let of_week = (time_of_week_s * 1e9) as i64;
    let full = match near {
        _ if week >= ROLLOVER => week,
        Some(near) => {
            let turns = (near.nanoseconds() - of_week) as f64 / WEEK_NS as f64 - week as f64;
            week + ROLLOVER * (turns / ROLLOVER as f64).round() as i64
        }
        None => return None,
    };
    crate::time::from_week(full, of_week)
}

/// Times of applicability of one almanac lie within this \[s\]: half a week, so that one on either side of a week's end is of one almanac
/// and a week number that is wrong by one is not. Provenance: ours.
const ONE_ALMANAC_S: f64 = WEEK_S / 2.0;

/// How much later an entry is than another, by the nearer way round where weeks roll over \[s\].
pub fn later_s(entry: &Entry, than: &Entry) -> f64 {
    let weeks = (entry.week - than.week + ROLLOVER / 2).rem_euclid(ROLLOVER) - ROLLOVER / 2;
    weeks as f64 * WEEK_S + entry.time_of_week_s - than.time_of_week_s
}

/// The entries of one almanac, and those of another week or time than most: a week that is wrong by one moves a satellite by thousands of
/// kilometres, and nothing tells it from an old entry.
pub fn of_one_time(entries: Vec<Entry>) -> (Vec<Entry>, Vec<Entry>) {
    let near = |one: &Entry| entries.iter().filter(|other| later_s(other, one).abs() <= ONE_ALMANAC_S).count();
    // Of two times that are as frequent the first.
    let usual = entries.iter().rev().max_by_key(|entry| near(entry)).copied();
    entries.into_iter().partition(|entry| usual.is_some_and(|usual| later_s(entry, &usual).abs() <= ONE_ALMANAC_S))
}

/// Read an almanac, YUMA or SEM, recognised by its content; plain (see [`crate::packed::unpack`]).
///
/// # Errors
/// [`Unreadable`] with line and field: an almanac is short, and one with a damaged satellite is not used at all.
pub fn read(bytes: &[u8]) -> Result<Vec<Entry>, Unreadable> {
    let mut lines: Vec<(usize, &[u8])> = Vec::new();
    let mut all = Lines::new(bytes);
    while let Some(line) = all.next() {
        if !line.trim_ascii().is_empty() {
            lines.push((all.number, line));
        }
    }
    let first = lines.first().ok_or_else(|| Unreadable::whole("the file is empty"))?;
    let mut entries = if first.1.contains(&b'*') || first.1.trim_ascii_start().starts_with(b"ID") { yuma(&lines)? } else { sem(&lines)? };
    entries.sort_by_key(|e| e.satellite);
    if let Some(twice) = entries.windows(2).find(|w| w[0].satellite == w[1].satellite) {
        return Err(Unreadable::whole(format!("{} stands twice in the almanac", twice[0].satellite)));
    }
    if entries.is_empty() {
        return Err(Unreadable::whole("no satellite in the almanac"));
    }
    Ok(entries)
}

/// Numbers of a satellite in the units of IS-GPS-200 with angles in radians.
struct Numbers {
    prn: i64,
    health: i64,
    week: i64,
    time_of_week_s: f64,
    eccentricity: f64,
    inclination: f64,
    node_rate: f64,
    sqrt_a: f64,
    node: f64,
    perigee: f64,
    mean_anomaly: f64,
    clock: [f64; 2],
}

fn entry(n: &Numbers, line: usize) -> Result<Entry, Unreadable> {
    let refuse = |field: &str, value: f64, domain: &str| {
        Err(Unreadable { line: Some(line), field: Some(field.to_owned()), reason: format!("{value} is outside {domain}") })
    };
    if !(1..=63).contains(&n.prn) {
        return refuse("PRN", n.prn as f64, "[1, 63]");
    }
    if !(0..=10_000).contains(&n.week) {
        return refuse("week", n.week as f64, "[0, 10000]");
    }
    if !((0.0..WEEK_S).contains(&n.time_of_week_s)) {
        return refuse("time of applicability", n.time_of_week_s, "[0, 604800) s");
    }
    if !((0.0..=0.9).contains(&n.eccentricity)) {
        return refuse("eccentricity", n.eccentricity, "[0, 0.9]");
    }
    if !(2450.0..=31_622.0).contains(&n.sqrt_a) {
        return refuse("sqrt(A)", n.sqrt_a, "[2450, 31622] sqrt(m)");
    }
    for (field, angle) in
        [("inclination", n.inclination), ("node", n.node), ("argument of perigee", n.perigee), ("mean anomaly", n.mean_anomaly)]
    {
        // A turn and what rounding adds.
        if !(angle.abs() <= 6.3) {
            return refuse(field, angle, "[-6.3, 6.3] rad");
        }
    }
    if !(n.node_rate.abs() <= 1e-6) {
        return refuse("rate of right ascension", n.node_rate, "[-1e-6, 1e-6] rad/s");
    }
    Ok(Entry {
        // The checks above bound it.
        satellite: SatelliteId { constellation: Constellation::Gps, number: n.prn as u8 },
        health: u16::try_from(n.health).unwrap_or(u16::MAX),
        week: n.week,
        time_of_week_s: n.time_of_week_s,
        elements: Elements {
            semi_major: Metres::new(n.sqrt_a * n.sqrt_a),
            eccentricity: n.eccentricity,
            inclination: Radians::new(n.inclination),
            node: Elements::node_from_week_start(Radians::new(n.node), n.time_of_week_s),
            node_rate_radps: n.node_rate,
            perigee: Radians::new(n.perigee),
            mean_anomaly: Radians::new(n.mean_anomaly),
        },
        clock: n.clock,
    })
}

/// Blocks of thirteen lines `name: value` behind a line of asterisks.
fn yuma(lines: &[(usize, &[u8])]) -> Result<Vec<Entry>, Unreadable> {
    const FIELDS: [&str; 13] = [
        "id",
        "health",
        "eccentricity",
        "time of applicability",
        "orbital inclination",
        "rate of right ascen",
        "sqrt(a)",
        "right ascen at week",
        "argument of perigee",
        "mean anom",
        "af0",
        "af1",
        "week",
    ];
    let rows: Vec<_> = lines.iter().filter(|(_, l)| !l.contains(&b'*')).collect();
    let mut entries = Vec::new();
    for block in rows.chunks(FIELDS.len()).take(MOST_SATELLITES) {
        let mut v = [0.0; FIELDS.len()];
        for (k, value) in v.iter_mut().enumerate() {
            let &&(number, line) = block.get(k).ok_or_else(|| Unreadable::whole("the last satellite of the almanac ends early"))?;
            let at = |reason: String| Unreadable { line: Some(number), field: Some(FIELDS[k].to_owned()), reason };
            let (name, field) = line.iter().position(|b| *b == b':').map_or((line, &[][..]), |p| (&line[..p], &line[p + 1..]));
            if !name.trim_ascii().to_ascii_lowercase().starts_with(FIELDS[k].as_bytes()) {
                return Err(at(format!("expected here, found '{}'", text(line, 0, 60))));
            }
            *value = match decimal(field) {
                Field::Number(v) => v,
                _ => return Err(at(format!("'{}' is not a number", text(field, 0, 40)))),
            };
        }
        let [prn, health, eccentricity, time_of_week_s, inclination, node_rate, sqrt_a, node, perigee, mean_anomaly, af0, af1, week] = v;
        let numbers = Numbers {
            prn: prn as i64,
            health: health as i64,
            week: week as i64,
            time_of_week_s,
            eccentricity,
            inclination,
            node_rate,
            sqrt_a,
            node,
            perigee,
            mean_anomaly,
            clock: [af0, af1],
        };
        entries.push(entry(&numbers, block[0].0)?);
    }
    Ok(entries)
}

/// A count and a title, week and time of applicability, then fourteen numbers a satellite; angles in semicircles.
fn sem(lines: &[(usize, &[u8])]) -> Result<Vec<Entry>, Unreadable> {
    let not_one = |number: usize, line: &[u8]| Unreadable::at(number, format!("neither a YUMA nor a SEM almanac: '{}'", text(line, 0, 60)));
    let words = |line: &'_ [u8]| line.split(u8::is_ascii_whitespace).filter(|w| !w.is_empty()).map(<[u8]>::to_vec).collect::<Vec<_>>();
    let (&(first, head), &(second, dates)) =
        lines.first().zip(lines.get(1)).ok_or_else(|| Unreadable::whole("the almanac ends in its header"))?;
    let count = words(head).first().and_then(|w| whole(w)).and_then(|n| usize::try_from(n).ok());
    let count = count.filter(|n| (1..=MOST_SATELLITES).contains(n)).ok_or_else(|| not_one(first, head))?;
    let dates_words = words(dates);
    let [week, time] = dates_words.as_slice() else { return Err(not_one(second, dates)) };
    let (week, Field::Number(time_of_week_s)) = (whole(week).ok_or_else(|| not_one(second, dates))?, decimal(time)) else {
        return Err(not_one(second, dates));
    };
    let mut rest = lines[2..].iter().flat_map(|(number, line)| words(line).into_iter().map(move |w| (*number, w)));
    (0..count)
        .map(|_| {
            let (mut v, mut line) = ([0.0; 14], second);
            for value in &mut v {
                let (number, word) =
                    rest.next().ok_or_else(|| Unreadable::whole(format!("the almanac announces {count} satellites and ends before")))?;
                line = number;
                *value = match decimal(&word) {
                    Field::Number(v) => v,
                    _ => return Err(Unreadable::at(number, format!("'{}' is not a number", text(&word, 0, 40)))),
                };
            }
            let [prn, _, _, eccentricity, inclination, node_rate, sqrt_a, node, perigee, mean_anomaly, af0, af1, health, _] = v;
            let rad = |semicircles: f64| semicircles * core::f64::consts::PI;
            let numbers = Numbers {
                prn: prn as i64,
                health: health as i64,
                week,
                time_of_week_s,
                eccentricity,
                inclination: rad(SEM_INCLINATION + inclination),
                node_rate: rad(node_rate),
                sqrt_a,
                node: rad(node),
                perigee: rad(perigee),
                mean_anomaly: rad(mean_anomaly),
                clock: [af0, af1],
            };
            entry(&numbers, line)
        })
        .collect()
}

#[cfg(test)]
#[path = "almanac_tests.rs"]
mod tests;
