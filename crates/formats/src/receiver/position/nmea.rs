//! NMEA 0183: GGA with GST (or GBS) and the speed of RMC or VTG of the same time of day, dated by RMC or ZDA. Where no GGA comes, RMC states the
//! position, and neither its height, its satellites, its dilution nor its accuracy.
//!
//! What RMC, GLL, GNS, GSA and GBS of the same epoch say against the position takes it away, and so does the last DTM (see
//! [`super::datum`]). Of several accuracies the worst counts.
//!
//! Source: NMEA 0183 version 4 as receivers' manuals give it; standard. GGA has no date, and its height stands above the geoid.

use super::accuracy::{circle, covariance, expected_errors, of_no_share, worst};
use super::dating::{Dated, dated};
use super::datum::Datum;
use super::decoder::Step;
use super::epoch::{Message, all_of_kind, of_kind};
use super::sentence::{EARTH_M, Sentence, of_day, short_date, vtg_speed_mps};
use super::witnesses::Near;
use super::{Absent, Fields, Note, OfDay, Position, Reason, datum, no_better};
use crate::measured::{GGA_QUALITIES, GSA_DIMENSIONS, LEAST_SATELLITES, NMEA_MODES};
use navbound_core::quantity::KNOT_MPS;
use navbound_core::solution::plausible::DILUTION;

const DTM: u32 = name(*b"DTM");
const GGA: u32 = name(*b"GGA");
pub(super) const GST: u32 = name(*b"GST");
pub(super) const GBS: u32 = name(*b"GBS");
pub(super) const GLL: u32 = name(*b"GLL");
pub(super) const GNS: u32 = name(*b"GNS");
const GSA: u32 = name(*b"GSA");
/// Position of u-blox's own sentence, `PUBX,00`.
pub(super) const PUBX: u32 = name(*b"UBX");
/// Garmin's own sentence of its errors, `PGRME`.
const PGRME: u32 = name(*b"RME");
pub(super) const RMC: u32 = name(*b"RMC");
/// Texts and alarms that speak against positions.
const TXT: u32 = name(*b"TXT");
const VTG: u32 = name(*b"VTG");
const ZDA: u32 = name(*b"ZDA");

const OF_GGA: [(&str, &str); 4] =
    [("est_lat_rad", "GGA"), ("est_lon_rad", "GGA"), ("est_h_m", "GGA altitude + separation"), ("time", "GGA, dated by RMC or ZDA:utc")];
const OF_RMC: [(&str, &str); 3] = [("est_lat_rad", "RMC"), ("est_lon_rad", "RMC"), ("time", "RMC:utc")];
const FIELDS: Fields = &OF_GGA;
const FIELDS_AND_RMC: Fields = &with_speed_of("RMC");
const FIELDS_AND_VTG: Fields = &with_speed_of("VTG");
const RMC_ALONE: Fields = &OF_RMC;
const RMC_ALONE_AND_RMC: Fields = &alone_with_speed_of("RMC");
const RMC_ALONE_AND_VTG: Fields = &alone_with_speed_of("VTG");

const fn alone_with_speed_of(sentence: &'static str) -> [(&'static str, &'static str); 5] {
    let [lat, lon, time] = OF_RMC;
    [lat, lon, time, ("ground_speed_mps", sentence), ("ground_track_rad", sentence)]
}

const fn with_speed_of(sentence: &'static str) -> [(&'static str, &'static str); 6] {
    let [lat, lon, height, time] = OF_GGA;
    [lat, lon, height, time, ("ground_speed_mps", sentence), ("ground_track_rad", sentence)]
}

const fn name([a, b, c]: [u8; 3]) -> u32 {
    u32::from_be_bytes([0, a, b, c])
}

/// What sentences said that holds beyond their epoch.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Heard {
    /// The last date.
    pub dated: Option<Dated>,
    /// The last datum.
    pub datum: Datum,
    /// A GGA came: RMC states no positions of its own, neither at the epochs of GGA nor between them.
    pub gga: bool,
    /// The last position of a GGA.
    pub near: Option<Near>,
    /// What places of other times since then say against it.
    pub against: Option<String>,
    /// The worst accuracy of other times since then \[m\].
    pub loose_m: Option<f64>,
}

/// Whether a sentence calls itself a GGA.
pub(super) fn is_gga(body: &[u8]) -> bool {
    body.get(2..6) == Some(b"GGA,")
}

/// Whether positions are those of RMC: the kind of message that holds them.
pub(super) const fn places(kind: u32, gga: bool) -> bool {
    kind == if gga { GGA } else { RMC }
}

/// `gga`: whether a GGA came.
pub(super) fn step(body: &[u8], record: u64, gga: bool) -> Step {
    let fields = Sentence(body);
    if body.starts_with(b"PUBX,00,") {
        let key = fields.get(2).and_then(of_day);
        return key.map_or(Step::Passed, |OfDay(key)| Step::Date { key, kind: PUBX, dated: None, kept: true });
    }
    if fields.get(0) == Some(b"PGRME") {
        return match of_no_share(&fields) {
            None => Step::Passed,
            Some(_) => Step::Beside { kind: PGRME, number: |pgrme| of_no_share(&Sentence(pgrme)).map_or(0.0, |errors| errors[0]) },
        };
    }
    if [b"TXT,", b"ALR,", b"ALF,"].into_iter().any(|name| body.get(2..6) == Some(name)) {
        return if speaks_against(&fields) { Step::Beside { kind: TXT, number: |_| 0.0 } } else { Step::Passed };
    }
    let address = fields.get(0).and_then(|address| address.get(2..)).and_then(|address| <[u8; 3]>::try_from(address).ok());
    let Some(kind) = address.map(name).filter(|kind| [DTM, GGA, GST, GBS, GLL, GNS, GSA, RMC, VTG, ZDA].contains(kind)) else {
        return Step::Passed;
    };
    if !body.is_ascii() {
        return Step::Malformed("a sentence holds bytes that are no text");
    }
    if kind == GSA {
        return if fields.number(2).is_some() { Step::Beside { kind, number: dimensions } } else { Step::Passed };
    }
    if kind == DTM {
        return datum::against(&fields).map_or(Step::Passed, Step::Datum);
    }
    if kind == VTG {
        return match vtg_speed_mps(&fields) {
            Ok(Some(_)) => Step::Beside { kind, number: |vtg| vtg_speed_mps(&Sentence(vtg)).ok().flatten().unwrap_or(0.0) },
            Ok(None) => Step::Passed,
            Err(reason) => Step::Malformed(reason),
        };
    }
    // A receiver without a fix leaves its fields empty.
    let written = fields.get(if kind == GLL { 5 } else { 1 }).filter(|time| !time.is_empty());
    let Some(OfDay(key)) = written.and_then(of_day) else {
        let stated = Own { kind, sentence: fields }.stated();
        let none = |reason, stated| Step::Whole(Box::new(Position::none(record, reason, stated)));
        return match written.map(String::from_utf8_lossy) {
            Some(time) if places(kind, gga) => none(Reason::TimeNotKnown, format!("time {time}, {stated}")),
            Some(_) => Step::Malformed("the time of day of a sentence is none"),
            None if places(kind, gga) => none(Reason::NoFix, stated),
            None => match kind {
                RMC if Sentence(body).get(2) == Some(b"A") => Step::Untimed { name: "RMC", at: 3 },
                GLL if Sentence(body).get(6).is_none_or(|status| status == b"A") => Step::Untimed { name: "GLL", at: 1 },
                GNS => Step::Untimed { name: "GNS", at: 2 },
                _ => Step::Passed,
            },
        };
    };
    match kind {
        GGA if !fields.sound(&GGA_NUMBERS) => Step::Malformed("a field of GGA is not a number"),
        RMC if fields.get(2) == Some(b"A") => {
            Step::Date { key, kind, dated: fields.get(9).and_then(short_date).and_then(|d| dated(d, key)), kept: true }
        }
        RMC | GLL => Step::Date { key, kind, dated: None, kept: true },
        ZDA => Step::Date { key, kind, dated: fields.long_date().and_then(|d| dated(d, key)), kept: false },
        GST if !fields.sizes(&[2, 3, 4, 6, 7, 8]) => Step::Malformed("a deviation of GST is no size"),
        GST if fields.number(3).is_some() && [6, 7].into_iter().any(|k| fields.number(k).is_none()) => {
            Step::Malformed("GST has an ellipse and no deviations along the axes")
        }
        GBS if !fields.sizes(&[2, 3, 4]) => Step::Malformed("an expected error of GBS is no size"),
        GST | GBS => Step::PartOfTalkers { key, kind },
        GNS => Step::Date { key, kind, dated: None, kept: true },
        _ => Step::PartOfEach { key, kind },
    }
}

/// Words of texts and alarms of a receiver whose positions are none, and words that take them back. Provenance: ours.
const ALARMS: [&str; 16] = [
    "SPOOF",
    "JAMM",
    "POSITION LOST",
    "LOST POSITION",
    "NO POSITION",
    "POS LOST",
    "GPS LOST",
    "GNSS LOST",
    "POSITION INVALID",
    "INVALID POSITION",
    "NO FIX",
    "RAIM FAIL",
    "RAIM UNSAFE",
    "DEAD RECKON",
    "INTERFERENCE",
    "SIGNAL LOST",
];
const TAKEN_BACK: [&str; 12] =
    ["NO SPOOF", "NO JAMM", "NO INTERF", "NOT ", "OFF", "NONE", "CLEARED", "ENABLED", "DETECTION ON", "ANTI", "STATE=", "MONITOR"];

/// The words of a text, or of an alarm.
fn alarm(text: &Sentence<'_>) -> String {
    String::from_utf8_lossy(text.0).into_owned()
}

/// Whether a text, or an alarm that is raised, speaks against positions.
fn speaks_against(text: &Sentence<'_>) -> bool {
    let is_raised = match text.0.get(2..5) {
        Some(b"ALR") => text.get(3) == Some(b"A"),
        // Rectified, or normal.
        Some(b"ALF") => !matches!(text.get(7), Some(b"U" | b"N")),
        _ => true,
    };
    let words = alarm(text).to_uppercase();
    let any = |list: &[&str]| list.iter().any(|word| words.contains(word));
    is_raised && any(&ALARMS) && !any(&TAKEN_BACK)
}

/// Dimensions of the fix of a GSA sentence: a receiver of several systems writes one sentence each, and the system that has no satellite says 1.
fn dimensions(gsa: &[u8]) -> f64 {
    Sentence(gsa).number(2).unwrap_or(0.0)
}

/// Quality, satellites, HDOP, altitude, separation; latitude and longitude.
const GGA_NUMBERS: [usize; 7] = [2, 4, 6, 7, 8, 9, 11];

/// The sentence that states the position: GGA, or RMC.
struct Own<'a> {
    kind: u32,
    sentence: Sentence<'a>,
}

impl<'a> Own<'a> {
    fn of(message: &'a Message) -> Self {
        Self { kind: message.kind, sentence: Sentence(&message.body) }
    }

    /// Where the latitude stands; the longitude stands two fields behind it.
    const fn at(&self) -> usize {
        if self.kind == GGA { 2 } else { 3 }
    }

    /// A number that GGA alone states.
    fn number(&self, at: usize) -> Option<f64> {
        if self.kind == GGA { self.sentence.number(at) } else { None }
    }

    fn measured(&self) -> bool {
        if self.kind == GGA {
            return self.number(6).is_some_and(|quality| GGA_QUALITIES.iter().any(|each| f64::from(*each) == quality));
        }
        let mode = self.sentence.get(12).unwrap_or_default();
        self.sentence.get(2) == Some(b"A") && matches!(mode, [] | [_]) && mode.iter().all(|letter| NMEA_MODES.contains(letter))
    }

    fn stated(&self) -> String {
        let text = |at: usize| String::from_utf8_lossy(self.sentence.get(at).unwrap_or_default());
        match self.kind {
            GGA => format!("quality {}, latitude {}", text(6), text(2)),
            _ => format!("status {}, mode {}, latitude {}", text(2), text(12), text(3)),
        }
    }
}

/// The position of a time of day; a date is still lacking.
pub(super) fn position(messages: &[Message], heard: &Heard) -> Option<Position> {
    let sentence = |kind| of_kind(messages, kind).map(|message| Sentence(&message.body));
    let kind = if heard.gga { GGA } else { RMC };
    // Of several talkers' GGA one that measures is enough.
    let measured = || all_of_kind(messages, GGA).find(|message| Own::of(message).measured());
    let Some(message) = measured().or_else(|| of_kind(messages, kind)) else { return without_gga(messages) };
    let (record, own) = (message.record, Own::of(message));
    let (lat_rad, lon_rad) = (own.sentence.angle(own.at(), [b"N", b"S"]), own.sentence.angle(own.at() + 2, [b"E", b"W"]));
    let (altitude, separation) = (own.number(9), own.number(11));
    let all = |kind| all_of_kind(messages, kind).map(|message| Sentence(&message.body));
    let of_gst = worst(all(GST).filter_map(|gst| covariance(&gst)));
    let of_gbs = worst(all(GBS).filter_map(|gbs| expected_errors(&gbs)));
    let of_pubx = sentence(PUBX).and_then(|pubx| circle(&pubx));
    let of_pgrme = sentence(PGRME).and_then(|pgrme| of_no_share(&pgrme));
    let expected = worst([of_gbs, of_pubx, of_pgrme].into_iter().flatten());
    let enlarged = of_gst.map(|own| no_better(own, expected));
    let biased = || all(GBS).find_map(|gbs| biased_range(&gbs));
    let against = contradiction(&own, messages, heard.datum.of_epoch.as_deref()).or_else(biased).or_else(|| heard.against.clone());
    let of_rmc = sentence(RMC).and_then(|rmc| rmc.number(7)).filter(|knots| *knots >= 0.0).map(|knots| knots * KNOT_MPS);
    let speed_mps = of_rmc.or_else(|| sentence(VTG).and_then(|vtg| vtg_speed_mps(&vtg).ok()?));
    let course = sentence(RMC).and_then(|rmc| rmc.number(8)).or_else(|| sentence(VTG).and_then(|vtg| vtg.number(1)));
    let track_rad = course.filter(|degrees| (0.0..=360.0).contains(degrees)).map(f64::to_radians);
    let usable = own.measured() && lat_rad.is_some() && lon_rad.is_some();
    let absent = |reason: Reason| move |stated: String| Absent { reason, stated };
    let few = || own.number(7).filter(|count| *count < f64::from(LEAST_SATELLITES)).map(|count| format!("{count} satellites"));
    let notes = [of_gbs.map(|_| Note::ExpectedErrors), of_pubx.map(|_| Note::CircularCovariance), of_pgrme.map(|_| Note::ErrorOfNoShare)];
    let of_others = || notes.into_iter().flatten().next();
    let substitute = if of_gst.is_some() { None } else { of_others() };
    let without_separation = (altitude.is_some() && separation.is_none()).then_some(Note::NoSeparation);
    let worse = enlarged.is_some_and(|(_, worse)| worse).then_some(Note::WorseExpectedErrors);
    Some(Position {
        record,
        of_day: of_day(own.sentence.get(1)?),
        lat_rad,
        lon_rad,
        h_m: altitude.zip(separation).map(|(altitude, separation)| altitude + separation),
        covariance_m2: enlarged.map(|(covariance, _)| covariance).or(expected),
        ground_speed_mps: speed_mps,
        ground_track_rad: track_rad,
        n_sv: own.number(7).map(|count| count as u32),
        hdop: own.number(8),
        absent: if usable {
            against.map(absent(Reason::Contradicted)).or_else(|| few().map(absent(Reason::FewSatellites)))
        } else {
            Some(absent(Reason::NoFix)(own.stated()))
        },
        fields: match (heard.gga, speed_mps, of_rmc) {
            (true, None, _) => FIELDS,
            (true, _, Some(_)) => FIELDS_AND_RMC,
            (true, ..) => FIELDS_AND_VTG,
            (false, None, _) => RMC_ALONE,
            (false, _, Some(_)) => RMC_ALONE_AND_RMC,
            (false, ..) => RMC_ALONE_AND_VTG,
        },
        unread_accuracy_m: heard.loose_m,
        covariance_from: [(of_gst, "GST"), (of_gbs, "GBS"), (of_pubx, "PUBX,00 hAcc, vAcc"), (of_pgrme, "PGRME HPE, VPE")]
            .into_iter()
            .find_map(|(stated, from)| stated.map(|_| from)),
        notes: [if heard.gga { without_separation } else { Some(Note::OfRmc) }, worse.or(substitute)],
        ..Position::default()
    })
}

/// An epoch at which other sentences state that there is no fix, and no GGA came: the receiver has no position.
fn without_gga(messages: &[Message]) -> Option<Position> {
    let none = |(kind, name, time, status, mode): (u32, &str, usize, usize, usize)| {
        let message = of_kind(messages, kind)?;
        let sentence = Sentence(&message.body);
        let invalid = sentence.get(status) == Some(b"V".as_slice());
        let unmeasured = sentence.get(mode).is_some_and(|mode| !mode.is_empty() && !mode.iter().any(|letter| NMEA_MODES.contains(letter)));
        let stated = format!("{name} without a fix, and no GGA");
        (invalid || unmeasured)
            .then(|| Position { of_day: sentence.get(time).and_then(of_day), ..Position::none(message.record, Reason::NoFix, stated) })
    };
    [(RMC, "RMC", 1, 2, 12), (GLL, "GLL", 5, 6, 7), (GNS, "GNS", 1, ABSENT, 6)].into_iter().find_map(none)
}

/// The place that a sentence states.
pub(super) fn place(of: &Sentence<'_>, at: usize) -> Option<(f64, f64)> {
    of.angle(at, [b"N", b"S"]).zip(of.angle(at + 2, [b"E", b"W"]))
}

/// What the sentences of an epoch say against its position.
fn contradiction(own: &Own<'_>, messages: &[Message], other_datum: Option<&str>) -> Option<String> {
    let sentence = |kind| of_kind(messages, kind).map(|message| Sentence(&message.body));
    let own_place = place(&own.sentence, own.at());
    // Status, mode, position, navigational status.
    let beside = [
        ("RMC", RMC, Some(2), 12, 3, 13),
        ("GLL", GLL, Some(6), 7, 1, ABSENT),
        ("GNS", GNS, None, 6, 2, 13),
        ("PUBX", PUBX, None, ABSENT, 3, ABSENT),
        ("GGA", GGA, None, ABSENT, 2, ABSENT),
    ];
    // GNS has a letter for each constellation, of which one that is used is enough, and so has each of several GNS.
    let measured = |mode: &str| mode.bytes().any(|letter| NMEA_MODES.contains(&letter));
    let by_gns =
        all_of_kind(messages, GNS).any(|gns| Sentence(&gns.body).get(6).is_some_and(|mode| measured(&String::from_utf8_lossy(mode))));
    let mut each = beside
        .into_iter()
        .flat_map(|of| all_of_kind(messages, of.1).map(move |message| (of, message)))
        // Who has no fix may repeat an old place.
        .filter(|(_, message)| message.kind != GGA || Sentence(&message.body).number(6) != Some(0.0))
        .map(|(of, message)| (of, Sentence(&message.body)));
    let stated = each.find_map(|((name, _, status, mode, at, navigational), other)| {
        let text = |at: usize| other.get(at).filter(|text| !text.is_empty()).map(String::from_utf8_lossy);
        if let Some(status) = status.and_then(text).filter(|status| status != "A") {
            return Some(format!("{name} status {status}"));
        }
        if let Some(mode) = text(mode).filter(|mode| !(measured(mode) || (name == "GNS" && by_gns))) {
            return Some(format!("{name} mode {mode}"));
        }
        if let Some(status) = text(navigational).filter(|status| UNSAFE.contains(&status.as_ref())) {
            return Some(format!("{name} navigational status {status}"));
        }
        let apart_m = apart_m(own_place?, place(&other, at)?);
        let resolution_m = own.sentence.resolution_m(own.at()) + other.resolution_m(at);
        (apart_m > ONE_PLACE_M + resolution_m).then(|| format!("position of {name} {apart_m:.0} m away"))
    });
    let flat = || sentence(GSA).map(|gsa| dimensions(gsa.0)).filter(|dimensions| *dimensions < GSA_DIMENSIONS);
    let of_gns = || all_of_kind(messages, GNS).find_map(|gns| Sentence(&gns.body).number(8).filter(|dilution| *dilution > DILUTION));
    let wide = || sentence(GSA).and_then(|gsa| gsa.number(16)).filter(|dilution| *dilution > DILUTION);
    let own_word =
        || of_kind(messages, PUBX).and_then(|pubx| no_fix(&Sentence(&pubx.body)).map(|fix| String::from_utf8_lossy(fix).into_owned()));
    let further = stated.or_else(|| other_datum.map(str::to_owned));
    let further = further.or_else(|| sentence(TXT).map(|text| alarm(&text)));
    let further = further.or_else(|| flat().map(|fix| format!("GSA fix {fix}")));
    let further = further.or_else(|| of_gns().map(|hdop| format!("GNS HDOP {hdop}")));
    further.or_else(|| wide().map(|hdop| format!("GSA HDOP {hdop}"))).or_else(|| own_word().map(|fix| format!("PUBX fix {fix}")))
}

/// The fix of a `PUBX,00` that is none.
pub(super) fn no_fix<'a>(pubx: &Sentence<'a>) -> Option<&'a [u8]> {
    pubx.get(8).filter(|fix| NO_FIX.contains(fix))
}

/// Fixes of `PUBX,00` that are none, of dead reckoning, of the time alone, or in two dimensions.
const NO_FIX: [&[u8]; 5] = [b"NF", b"DR", b"TT", b"G2", b"D2"];

/// Navigational statuses of NMEA 0183 version 4.1 that speak against a position: caution and unsafe. `S` is safe, `V` says that none is given.
const UNSAFE: [&str; 2] = ["C", "U"];
/// No such field.
const ABSENT: usize = usize::MAX;
/// A bias of a range that is larger than so many of its own standard deviations is none by chance. Provenance: ours \[1\].
const BIAS: f64 = 5.0;

/// What a GBS sentence says of a satellite that has failed.
fn biased_range(gbs: &Sentence<'_>) -> Option<String> {
    let (satellite, bias_m, sigma_m) = (gbs.get(5).filter(|text| !text.is_empty())?, gbs.number(7)?, gbs.number(8).unwrap_or(0.0));
    let satellite = String::from_utf8_lossy(satellite);
    (bias_m.abs() > BIAS * sigma_m).then(|| format!("GBS: satellite {satellite} wrong by {bias_m} m"))
}

/// Distance within which two sentences of one time give one place: receivers smooth and extrapolate them differently. Provenance: ours \[m\].
pub(super) const ONE_PLACE_M: f64 = 30.0;

/// Distance of two near places.
pub(super) fn apart_m((lat, lon): (f64, f64), (other_lat, other_lon): (f64, f64)) -> f64 {
    let turn = core::f64::consts::TAU;
    let east = libm::remainder(other_lon - lon, turn) * libm::cos(lat);
    EARTH_M * libm::hypot(other_lat - lat, east)
}

/// Number of the accuracy beside which no position stands.
pub(super) fn accuracy_alone(messages: &[Message]) -> Option<u64> {
    messages.iter().find(|message| [GST, GBS].contains(&message.kind)).map(|message| message.record)
}
