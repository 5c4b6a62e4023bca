//! Navigation files: broadcast orbits, clocks, ionosphere.

use super::header::{Lines, label, version};
use super::number::{columns, decimal, text, whole};
use crate::refusal::{Refusal, Unreadable};
use crate::time::Scale;
use navbound_core::quantity::GpsTime;
use navbound_core::signal::{Constellation, Ephemeris, GeoEphemeris, Klobuchar};
use std::collections::BTreeMap;

#[path = "record.rs"]
mod record;
use record::Block;
pub(crate) use record::{fit_interval, orbit_refusal};

/// Everything of navigation files that navbound uses, and what it left.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Navigation {
    /// Keplerian records, sorted by satellite, message and reference time; exact repetitions once.
    pub ephemerides: Vec<Ephemeris>,
    /// Geostationary records, sorted by satellite and time.
    pub geostationary: Vec<GeoEphemeris>,
    /// Single-frequency ionosphere of GPS; the first the file gives.
    pub klobuchar_gps: Option<Klobuchar>,
    /// Of BeiDou.
    pub klobuchar_beidou: Option<Klobuchar>,
    /// Every single-frequency ionosphere that a file gives for its time: GPS.
    pub ionosphere_gps: Vec<Dated<Klobuchar>>,
    /// Galileo: coefficients of the effective ionisation level \[sfu, sfu/deg, sfu/deg²\].
    pub ionosphere_galileo: Vec<Dated<[f64; 3]>>,
    /// GPS time minus UTC \[s\], where the file says.
    pub leap_seconds: Option<i64>,
    /// Well-formed records of kinds that navbound does not use, by kind ("R FDMA", "G CNAV"), counted.
    pub skipped: BTreeMap<String, usize>,
    /// Records that could not be read.
    pub refused: Vec<Refusal>,
}

/// A message with its time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dated<T> {
    /// When it was sent; of a header, which does not say, the middle of the orbits beneath it. `None` where nothing says.
    pub time: Option<GpsTime>,
    /// What it says.
    pub message: T,
}

impl<T: Copy> Dated<T> {
    /// The message nearest to an instant, among those within `most_s` \[s\] of it. One that nothing dates is as far as may be.
    pub fn nearest(all: &[Self], to: GpsTime, most_s: f64) -> Option<T> {
        let distance = |d: &Self| d.time.map_or(most_s, |t| t.seconds_since(to).abs());
        let near = all.iter().filter(|d| distance(d) <= most_s);
        near.min_by(|a, b| distance(a).total_cmp(&distance(b))).map(|d| d.message)
    }
}

impl Navigation {
    /// Records of one satellite, sorted by message and reference time.
    pub fn of(&self, satellite: navbound_core::signal::SatelliteId) -> &[Ephemeris] {
        let from = self.ephemerides.partition_point(|e| e.satellite < satellite);
        let to = self.ephemerides.partition_point(|e| e.satellite <= satellite);
        &self.ephemerides[from..to]
    }

    /// These records and those of another file.
    pub fn merge(&mut self, other: Self) {
        self.ephemerides.extend(other.ephemerides);
        self.geostationary.extend(other.geostationary);
        self.klobuchar_gps = self.klobuchar_gps.or(other.klobuchar_gps);
        self.klobuchar_beidou = self.klobuchar_beidou.or(other.klobuchar_beidou);
        self.ionosphere_gps.extend(other.ionosphere_gps);
        self.ionosphere_galileo.extend(other.ionosphere_galileo);
        self.leap_seconds = self.leap_seconds.or(other.leap_seconds);
        for (kind, n) in other.skipped {
            *self.skipped.entry(kind).or_default() += n;
        }
        self.refused.extend(other.refused);
        self.sort();
    }

    /// Date the messages of a header by the orbits beneath it.
    pub(crate) fn date_header(&mut self) {
        let mut times: Vec<GpsTime> = self.ephemerides.iter().map(|e| e.orbit_time).collect();
        times.sort_unstable();
        let middle = times.get(times.len() / 2).copied();
        for d in self.ionosphere_gps.iter_mut().filter(|d| d.time.is_none()) {
            d.time = middle;
        }
        for d in self.ionosphere_galileo.iter_mut().filter(|d| d.time.is_none()) {
            d.time = middle;
        }
    }

    pub(crate) fn sort(&mut self) {
        self.ephemerides.sort_by_key(|e| (e.satellite, e.message, e.orbit_time, e.clock_time, e.issue_orbit));
        self.ephemerides.dedup();
        self.geostationary.sort_by_key(|e| (e.satellite, e.time));
        self.geostationary.dedup();
    }

    pub(crate) fn skip(&mut self, kind: String) {
        *self.skipped.entry(kind).or_default() += 1;
    }
}

/// Read a navigation file, plain (see [`crate::packed::unpack`]).
///
/// # Errors
/// [`Unreadable`] unless it begins with the header of a RINEX navigation file of version 2, 3 or 4. A record that cannot be read is put
/// into `refused`, and the others stand.
pub fn read_navigation(bytes: &[u8]) -> Result<Navigation, Unreadable> {
    let mut lines = Lines::new(bytes);
    let first = lines.next().ok_or_else(|| Unreadable::whole("the file is empty"))?;
    let (version, kind, system) = version(first)?;
    let only = single_system(version, kind, system)?;
    let mut navigation = Navigation::default();
    header(&mut lines, &mut navigation)?;
    if version < 3.0 {
        blocks(lines, 3, |block| navigation.take_second(block, only));
    } else if version < 4.0 {
        blocks(lines, 4, |block| navigation.take_third(block, None));
    } else {
        fourth(lines, &mut navigation);
    }
    navigation.date_header();
    navigation.sort();
    Ok(navigation)
}

/// The constellation of a version 2 file; version 3 and 4 files name it in every record.
fn single_system(version: f64, kind: u8, system: u8) -> Result<Constellation, Unreadable> {
    match (version < 3.0, kind, system) {
        (_, b'N', b' ' | b'G') | (false, b'N', _) => Ok(Constellation::Gps),
        (true, b'G', _) => Ok(Constellation::Glonass),
        (true, b'H', _) => Ok(Constellation::Sbas),
        (true, b'N', b'E') => Ok(Constellation::Galileo),
        _ => {
            let reason = format!("file type '{}' is not a navigation file (N; in version 2 also G and H)", char::from(kind));
            Err(Unreadable { line: Some(1), field: Some("RINEX VERSION / TYPE".to_owned()), reason })
        }
    }
}

fn header(lines: &mut Lines<'_>, navigation: &mut Navigation) -> Result<(), Unreadable> {
    let (mut alpha, mut beta) = (BTreeMap::new(), BTreeMap::new());
    while let Some(line) = lines.next() {
        let number = lines.number;
        match label(line) {
            b"END OF HEADER" => {
                let whole = |name| alpha.get(name).zip(beta.get(name)).map(|(a, b)| Klobuchar { alpha: *a, beta: *b });
                for (system, name) in [(Constellation::Gps, &b"GPS"[..]), (Constellation::BeiDou, &b"BDS"[..])] {
                    if let Some(message) = whole(name) {
                        navigation.keep_ionosphere(system, Dated { time: None, message }, number);
                    }
                }
                return Ok(());
            }
            b"ION ALPHA" => _ = alpha.insert(&b"GPS"[..], four(line, 2, number)?),
            b"ION BETA" => _ = beta.insert(&b"GPS"[..], four(line, 2, number)?),
            b"IONOSPHERIC CORR" => match (columns(line, 0, 3), columns(line, 3, 4)) {
                (system @ (b"GPS" | b"BDS"), b"A") => _ = alpha.entry(system).or_insert(four(line, 5, number)?),
                (system @ (b"GPS" | b"BDS"), b"B") => _ = beta.entry(system).or_insert(four(line, 5, number)?),
                (b"GAL", _) => {
                    let [a0, a1, a2, _] = four(line, 5, number)?;
                    navigation.ionosphere_galileo.push(Dated { time: None, message: [a0, a1, a2] });
                }
                _ => navigation.skip(format!("{} ionosphere", text(line, 0, 4))),
            },
            b"LEAP SECONDS" => navigation.leap_seconds = whole(columns(line, 0, 6)),
            _ => {}
        }
    }
    Err(Unreadable::whole("the header has no END OF HEADER"))
}

/// Four coefficients of twelve columns.
fn four(line: &[u8], from: usize, number: usize) -> Result<[f64; 4], Unreadable> {
    let mut values = [0.0; 4];
    for (k, value) in values.iter_mut().enumerate() {
        let field = columns(line, from + 12 * k, from + 12 * k + 12);
        *value = decimal(field).or_zero().ok_or_else(|| Unreadable {
            line: Some(number),
            field: Some(String::from_utf8_lossy(label(line)).into_owned()),
            reason: format!("'{}' is not a number", String::from_utf8_lossy(field)),
        })?;
    }
    Ok(values)
}

/// Records of version 2 and 3: a line with something in its first columns, and those after it that are blank there.
fn blocks<'a>(mut lines: Lines<'a>, indent: usize, mut take: impl FnMut(&Block<'a>)) {
    let mut block: Option<Block<'a>> = None;
    while let Some(line) = lines.next() {
        if columns(line, 0, indent).trim_ascii().is_empty() {
            if let Some(b) = &mut block {
                b.lines.push(line);
            }
        } else if let Some(whole) = block.replace(Block::new(lines.number, line, indent)) {
            take(&whole);
        }
    }
    if let Some(whole) = block {
        take(&whole);
    }
}

/// Records of version 4: each behind a line `> KIND SATELLITE MESSAGE`.
fn fourth(lines: Lines<'_>, navigation: &mut Navigation) {
    let mut title: Option<(usize, &[u8])> = None;
    let mut block: Option<Block<'_>> = None;
    let mut lines = lines;
    loop {
        let line = lines.next();
        if line.is_none_or(|l| l.starts_with(b">")) {
            if let (Some((number, title)), Some(block)) = (title, &block) {
                navigation.take_fourth(title, number, block);
            }
            block = None;
            title = line.map(|l| (lines.number, l));
        }
        match (line, &mut block) {
            (None, _) => return,
            (Some(l), _) if l.starts_with(b">") => {}
            (Some(l), Some(b)) => b.lines.push(l),
            (Some(l), slot @ None) => *slot = Some(Block::new(lines.number, l, 4)),
        }
    }
}

impl Navigation {
    fn take_second(&mut self, block: &Block<'_>, system: Constellation) {
        match system {
            Constellation::Glonass => self.skip("R FDMA".to_owned()),
            Constellation::Sbas => self.keep(block.geostationary(true)),
            _ => self.keep_kepler(block.kepler(Some(system), None)),
        }
    }

    fn take_third(&mut self, block: &Block<'_>, message: Option<&[u8]>) {
        match block.first().first() {
            Some(b'G' | b'E' | b'C') => self.keep_kepler(block.kepler(None, message)),
            Some(b'S') => self.keep(block.geostationary(false)),
            Some(b'R') => self.skip("R FDMA".to_owned()),
            Some(letter @ (b'J' | b'I')) => self.skip(format!("{} LNAV", char::from(*letter))),
            _ => self.refused.push(block.refusal("satellite", "not a satellite of a known system")),
        }
    }

    fn take_fourth(&mut self, title: &[u8], number: usize, block: &Block<'_>) {
        let mut words = title.split(u8::is_ascii_whitespace).filter(|w| !w.is_empty()).skip(1);
        let (kind, satellite, message) = (words.next(), words.next(), words.next().unwrap_or(b"?"));
        let letter = satellite.and_then(|s| s.first()).copied().unwrap_or(b'?');
        match (kind, letter, message) {
            (Some(b"EPH"), b'G', b"LNAV") | (Some(b"EPH"), b'E', b"INAV" | b"FNAV") | (Some(b"EPH"), b'C', b"D1" | b"D2") => {
                self.take_third(block, Some(message));
            }
            (Some(b"EPH"), b'S', b"SBAS") => self.take_third(block, None),
            (Some(b"ION"), b'G', b"LNAV") => self.ionosphere(block, Constellation::Gps),
            (Some(b"ION"), b'C', b"D1D2") => self.ionosphere(block, Constellation::BeiDou),
            (Some(b"ION"), b'E', b"IFNV") => match block.numbers::<3>() {
                Ok(message) => self.ionosphere_galileo.push(Dated { time: block.time(Scale::Gps), message }),
                Err(refusal) => self.refused.push(refusal),
            },
            (Some(b"EPH"), _, _) => self.skip(format!("{} {}", char::from(letter), String::from_utf8_lossy(message))),
            (Some(kind @ (b"ION" | b"STO" | b"EOP")), _, _) => {
                self.skip(format!("{} {}", String::from_utf8_lossy(kind), char::from(letter)))
            }
            _ => self.refused.push(Refusal {
                line: number,
                field: "record type".to_owned(),
                reason: "not one of EPH, ION, STO, EOP".to_owned(),
                text: text(title, 0, 80),
            }),
        }
    }

    fn ionosphere(&mut self, block: &Block<'_>, system: Constellation) {
        let message = match block.numbers::<8>() {
            Ok(v) => Klobuchar { alpha: [v[0], v[1], v[2], v[3]], beta: [v[4], v[5], v[6], v[7]] },
            Err(refusal) => return self.refused.push(refusal),
        };
        self.keep_ionosphere(system, Dated { time: block.time(Scale::Gps), message }, block.number());
    }

    /// Keep a message; one that no satellite can have sent is refused, an empty one says nothing.
    fn keep_ionosphere(&mut self, system: Constellation, dated: Dated<Klobuchar>, line: usize) {
        let message = dated.message;
        if let Some(reason) = message.implausible().filter(|_| !message.is_empty()) {
            let field = format!("{} ionosphere", system.letter());
            let text = format!("alpha {:?}, beta {:?}", message.alpha, message.beta);
            return self.refused.push(Refusal { line, field, reason: reason.to_owned(), text });
        }
        if system == Constellation::Gps {
            self.ionosphere_gps.push(dated);
            self.klobuchar_gps.get_or_insert(message);
        } else {
            self.klobuchar_beidou.get_or_insert(message);
        }
    }

    fn keep_kepler(&mut self, parsed: Result<Ephemeris, Refusal>) {
        match parsed {
            Ok(ephemeris) => self.ephemerides.push(ephemeris),
            Err(refusal) => self.refused.push(refusal),
        }
    }

    fn keep(&mut self, parsed: Result<GeoEphemeris, Refusal>) {
        match parsed {
            Ok(ephemeris) => self.geostationary.push(ephemeris),
            Err(refusal) => self.refused.push(refusal),
        }
    }
}

/// The instant nearest to `near` that has this time of week \[s\] in a scale `behind_ns` behind GPS time: no week number needed, so none
/// can be wrong or rolled over.
pub(crate) fn nearest_week(time_of_week_s: f64, near: GpsTime, behind_ns: i64) -> Option<GpsTime> {
    const WEEK_NS: i64 = 604_800_000_000_000;
    // Times beyond two weeks mean "unknown" (0.9999e9 in the standard).
    if !(time_of_week_s.abs() <= 1_209_600.0) {
        return None;
    }
    let local = near.nanoseconds() - behind_ns;
    let offset = (time_of_week_s * 1e9).round() as i64 - local.rem_euclid(WEEK_NS);
    let offset = (offset + WEEK_NS / 2).rem_euclid(WEEK_NS) - WEEK_NS / 2;
    Some(GpsTime::from_nanoseconds(near.nanoseconds() + offset))
}

#[cfg(test)]
#[path = "navigation_tests.rs"]
mod tests;
