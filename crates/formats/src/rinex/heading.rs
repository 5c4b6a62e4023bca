//! Header of an observation file.

use super::header::{Lines, label, version};
use super::number::{Field, columns, decimal, text, whole};
use super::observation::{Code, Observations};
use crate::refusal::Unreadable;
use crate::time::Scale;
use navbound_core::signal::Constellation;

/// What the readers of the body need besides the table's own fields.
#[derive(Debug, Clone)]
pub(super) struct Heading {
    /// Scale of the epochs.
    pub(super) time: Scale,
    /// The constellation of satellites without a letter (version 2).
    pub(super) system: Constellation,
    /// Positions of codes whose values were multiplied by a factor, by constellation.
    pub(super) scale: [Vec<(usize, f64)>; Constellation::ALL.len()],
}

/// What is collected on the way.
#[derive(Default)]
struct Draft {
    /// Version 2: names of the types, valid for every system.
    second: Vec<[u8; 2]>,
    /// Version 3: the system whose codes continue.
    system: u8,
    /// The time system of the first epoch.
    time: Option<Scale>,
    factors: Vec<(u8, f64, Vec<Code>)>,
}

pub(super) fn read(lines: &mut Lines<'_>, first: &[u8], o: &mut Observations) -> Result<Heading, Unreadable> {
    let (version, kind, system) = version(first)?;
    if kind != b'O' {
        let reason = format!("file type '{}' is not an observation file (O)", char::from(kind));
        return Err(Unreadable { line: Some(lines.number), field: Some("RINEX VERSION / TYPE".to_owned()), reason });
    }
    o.version = version;
    let mut draft = Draft::default();
    loop {
        let line = lines.next().ok_or_else(|| Unreadable::whole("the header has no END OF HEADER"))?;
        if label(line) == b"END OF HEADER" {
            break;
        }
        take(line, o, &mut draft).map_err(|reason| Unreadable {
            line: Some(lines.number),
            field: Some(String::from_utf8_lossy(label(line)).into_owned()),
            reason,
        })?;
    }
    if version < 3.0 {
        for constellation in Constellation::ALL {
            o.codes[constellation.index()] = draft.second.iter().map(|name| translate(constellation, *name)).collect();
        }
    }
    if o.codes.iter().all(Vec::is_empty) {
        return Err(Unreadable::whole("the header names no observation codes of GPS, GLONASS, Galileo, BeiDou or SBAS"));
    }
    let default = match system {
        b'R' => Scale::Utc,
        b'C' => Scale::BeiDou,
        _ => Scale::Gps,
    };
    let scale = factors(&draft, o);
    let system = Constellation::from_letter(system).unwrap_or(Constellation::Gps);
    Ok(Heading { time: draft.time.unwrap_or(default), system, scale })
}

fn take(line: &[u8], o: &mut Observations, draft: &mut Draft) -> Result<(), String> {
    match label(line) {
        b"MARKER NAME" => o.marker = text(line, 0, 60),
        b"REC # / TYPE / VERS" => o.receiver = text(line, 20, 60),
        b"ANT # / TYPE" => o.antenna = text(line, 20, 40),
        b"APPROX POSITION XYZ" => o.approximate_m = Some(three(line)?).filter(|p| p.iter().any(|x| *x != 0.0)),
        b"ANTENNA: DELTA H/E/N" => o.antenna_delta_m = three(line)?,
        b"INTERVAL" => o.interval_s = decimal(columns(line, 0, 10)).or_zero().filter(|s| *s > 0.0),
        b"# / TYPES OF OBSERV" => {
            for name in columns(line, 6, 60).chunks(6).filter_map(|c| c.get(4..6)).filter(|n| !n.trim_ascii().is_empty()) {
                let [kind, band] = *name else { return Err(not_a_code(name)) };
                if ![kind, band].iter().all(u8::is_ascii_alphanumeric) {
                    return Err(not_a_code(name));
                }
                draft.second.push([kind, band]);
            }
        }
        b"SYS / # / OBS TYPES" => codes(line, o, draft)?,
        b"SYS / SCALE FACTOR" => factor(line, draft)?,
        b"TIME OF FIRST OBS" => draft.time = time_system(&text(line, 48, 51))?,
        _ => {}
    }
    Ok(())
}

fn three(line: &[u8]) -> Result<[f64; 3], String> {
    let mut values = [0.0; 3];
    for (k, value) in values.iter_mut().enumerate() {
        let field = columns(line, 14 * k, 14 * k + 14);
        *value = decimal(field).or_zero().ok_or_else(|| format!("'{}' is not a number", String::from_utf8_lossy(field)))?;
    }
    Ok(values)
}

fn time_system(name: &str) -> Result<Option<Scale>, String> {
    match name {
        "" => Ok(None),
        // Galileo and QZSS time are GPS time to some nanoseconds, and RINEX weeks begin together.
        "GPS" | "GAL" | "QZS" => Ok(Some(Scale::Gps)),
        "GLO" | "UTC" => Ok(Some(Scale::Utc)),
        "BDT" | "BDS" => Ok(Some(Scale::BeiDou)),
        other => Err(format!("time system '{other}' is not one of GPS, GAL, QZS, GLO, UTC, BDT")),
    }
}

fn codes(line: &[u8], o: &mut Observations, draft: &mut Draft) -> Result<(), String> {
    if let Some(letter) = line.first().filter(|b| **b != b' ') {
        draft.system = *letter;
    }
    let Some(constellation) = Constellation::from_letter(draft.system) else { return Ok(()) };
    for name in columns(line, 6, 58).chunks(4) {
        if name.trim_ascii().is_empty() {
            continue;
        }
        // A name that is passed over would give its values to the next.
        let [b' ', kind, band, attribute] = *name else { return Err(not_a_code(name)) };
        // The attribute may be blank (RINEX 3.04, section 5.1; the channel number `X1` has none).
        if ![kind, band].iter().all(u8::is_ascii_alphanumeric) || !(attribute.is_ascii_alphanumeric() || attribute == b' ') {
            return Err(not_a_code(name));
        }
        // Version 3.02 alone called BeiDou's B1I band 1; before and after it is band 2 (RINEX 3.03, section 9.2).
        let b1i = o.version < 3.03 && constellation == Constellation::BeiDou && band == b'1';
        o.codes[constellation.index()].push([kind, if b1i { b'2' } else { band }, attribute]);
    }
    Ok(())
}

fn not_a_code(name: &[u8]) -> String {
    format!("'{}' is not the name of an observation", String::from_utf8_lossy(name.trim_ascii()))
}

fn factor(line: &[u8], draft: &mut Draft) -> Result<(), String> {
    let letter = line.first().copied().unwrap_or(b' ');
    let names = columns(line, 10, 58).chunks(4).filter_map(|c| c.get(1..4)).filter(|n| !n.trim_ascii().is_empty());
    let names = names.map(|n| [n[0], n[1], n[2]]);
    if letter == b' ' {
        if let Some(last) = draft.factors.last_mut() {
            last.2.extend(names);
        }
        return Ok(());
    }
    match decimal(columns(line, 2, 6)) {
        Field::Number(f) if f > 0.0 => draft.factors.push((letter, f, names.collect())),
        _ => return Err(format!("'{}' is not a scale factor", text(line, 2, 6))),
    }
    Ok(())
}

fn factors(draft: &Draft, o: &Observations) -> [Vec<(usize, f64)>; Constellation::ALL.len()] {
    let mut scale: [Vec<(usize, f64)>; Constellation::ALL.len()] = Default::default();
    for (letter, factor, names) in &draft.factors {
        let Some(constellation) = Constellation::from_letter(*letter) else { continue };
        let codes = o.codes[constellation.index()].iter().enumerate();
        // No names: every code of the system.
        let selected = codes.filter(|(_, c)| names.is_empty() || names.contains(c)).map(|(k, _)| (k, *factor));
        scale[constellation.index()].extend(selected);
    }
    scale
}

/// Version 2 names as codes of version 3. The attribute is what the name implies for GPS (C1 is the C/A code, P the encrypted P code,
/// C2 the civil code); other systems' names imply none, which version 3 writes as X.
fn translate(constellation: Constellation, [kind, band]: [u8; 2]) -> Code {
    let kind3 = if kind == b'P' { b'C' } else { kind };
    let attribute = match (constellation, kind, band) {
        (Constellation::Gps | Constellation::Glonass, b'P', _) | (Constellation::Gps, b'L' | b'D' | b'S', b'2') => {
            if constellation == Constellation::Gps { b'W' } else { b'P' }
        }
        (Constellation::Gps | Constellation::Glonass | Constellation::Sbas, _, b'1') | (Constellation::Glonass, _, b'2') => b'C',
        (Constellation::Sbas, _, b'5') => b'I',
        _ => b'X',
    };
    [kind3, band, attribute]
}

/// A satellite's letter and number; a letter that is not read is an error carrying it.
pub(super) fn satellite(field: &[u8], default: Constellation) -> Result<navbound_core::signal::SatelliteId, u8> {
    let letter = field.first().copied().unwrap_or(b'?');
    let constellation = if letter == b' ' { Some(default) } else { Constellation::from_letter(letter) };
    // Of a name of which the line holds two columns the last digit is lost.
    let number = whole(field.get(1..3).unwrap_or_default()).and_then(|n| u8::try_from(n).ok()).filter(|n| (1..=99).contains(n));
    match (constellation, number) {
        (Some(constellation), Some(number)) if constellation.numbers().contains(&number) => {
            Ok(navbound_core::signal::SatelliteId { constellation, number })
        }
        (None, Some(_)) if matches!(letter, b'J' | b'I') => Err(letter),
        _ => Err(b'?'),
    }
}
