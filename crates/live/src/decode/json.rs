//! One JSON object a line: the contract for other programs that produce positions. Known keys are strict; a statement of integrity
//! under another key is heard, and every other one is counted by name.

use super::Decoded;
use super::keys::Keys;
use super::statements::{self, Statements};
use crate::claims::Claim;
use crate::counters::Refused;
use crate::position::{Position, Shown, TrackId};
use navbound_core::monitor::no_speed::stated_mps;
use navbound_core::quantity::{GpsTime, Reason, Status};
use serde::{Deserialize, Deserializer};
use std::borrow::Cow;

/// Version of the contract.
const VERSION: u32 = 1;

/// Names as in docs/notation.md; `null` is a number that is stated as none.
#[derive(Deserialize)]
struct Line<'a> {
    v: u32,
    #[serde(borrow)]
    track: Cow<'a, str>,
    time_ns: i64,
    #[serde(default, borrow, deserialize_with = "word")]
    status: Option<Cow<'a, str>>,
    #[serde(default, deserialize_with = "number")]
    est_lat_rad: Option<f64>,
    #[serde(default, deserialize_with = "number")]
    est_lon_rad: Option<f64>,
    #[serde(default, deserialize_with = "number")]
    est_h_m: Option<f64>,
    #[serde(default, deserialize_with = "number")]
    fte_m: Option<f64>,
    #[serde(default, deserialize_with = "number")]
    course_rad: Option<f64>,
    #[serde(default, deserialize_with = "number")]
    ground_speed_mps: Option<f64>,
    #[serde(default, deserialize_with = "number")]
    ground_track_rad: Option<f64>,
    #[serde(default, deserialize_with = "number")]
    sigma_m: Option<f64>,
    #[serde(default, deserialize_with = "number")]
    cov_ee_m2: Option<f64>,
    #[serde(default, deserialize_with = "number")]
    cov_en_m2: Option<f64>,
    #[serde(default, deserialize_with = "number")]
    cov_nn_m2: Option<f64>,
    #[serde(default, deserialize_with = "number")]
    cov_eu_m2: Option<f64>,
    #[serde(default, deserialize_with = "number")]
    cov_nu_m2: Option<f64>,
    #[serde(default, deserialize_with = "number")]
    cov_uu_m2: Option<f64>,
    #[serde(default, deserialize_with = "number")]
    hpl_m: Option<f64>,
    #[serde(default, deserialize_with = "number")]
    rnp_m: Option<f64>,
    #[serde(default, deserialize_with = "number")]
    fte_v_m: Option<f64>,
    #[serde(default, deserialize_with = "number")]
    vpl_m: Option<f64>,
    #[serde(default, deserialize_with = "number")]
    hal_m: Option<f64>,
    #[serde(default, deserialize_with = "number")]
    val_m: Option<f64>,
    #[serde(default, deserialize_with = "number")]
    n_sv: Option<f64>,
    #[serde(default, borrow)]
    nav_mode: Option<Cow<'a, str>>,
}

/// The keys of [`Line`].
const KEYS: [&str; 26] = [
    "v",
    "track",
    "time_ns",
    "status",
    "est_lat_rad",
    "est_lon_rad",
    "est_h_m",
    "fte_m",
    "course_rad",
    "ground_speed_mps",
    "ground_track_rad",
    "sigma_m",
    "cov_ee_m2",
    "cov_en_m2",
    "cov_nn_m2",
    "cov_eu_m2",
    "cov_nu_m2",
    "cov_uu_m2",
    "hpl_m",
    "rnp_m",
    "fte_v_m",
    "vpl_m",
    "hal_m",
    "val_m",
    "n_sv",
    "nav_mode",
];

/// A word; `null` is one that says nothing good.
fn word<'de, D: Deserializer<'de>>(from: D) -> Result<Option<Cow<'de, str>>, D::Error> {
    Option::<Cow<'de, str>>::deserialize(from).map(|word| Some(word.unwrap_or_default()))
}

/// A number, NaN for `null`. A key that is absent does not come here.
fn number<'de, D: Deserializer<'de>>(from: D) -> Result<Option<f64>, D::Error> {
    Option::<f64>::deserialize(from).map(|value| Some(value.unwrap_or(f64::NAN)))
}

/// Of whom and of when a line is that holds no position.
#[derive(Deserialize)]
struct Named<'a> {
    v: u32,
    #[serde(borrow)]
    track: Cow<'a, str>,
    time_ns: i64,
}

/// The track of a line; `None` where it names none.
pub(super) fn track(line: &[u8]) -> Option<TrackId> {
    #[derive(Deserialize)]
    struct Whose<'a> {
        #[serde(borrow)]
        track: Cow<'a, str>,
    }
    let of = |line: &[u8]| serde_json::from_slice::<Whose<'_>>(line).ok().and_then(|whose| TrackId::new(&whose.track));
    of(line).or_else(|| of(&without_nan(line)))
}

pub(super) fn position(line: &[u8], statements: &Statements, keys: &mut Keys) -> Decoded {
    if let Ok(parsed) = serde_json::from_slice(line) {
        return stated(&parsed, line, statements, keys);
    }
    // Programs write numbers that are none in ways that JSON has not.
    let plain = without_nan(line);
    if let Ok(parsed) = serde_json::from_slice(&plain) {
        return stated(&parsed, &plain, statements, keys);
    }
    // A line that says of whom and of when it is, and no position: that track has none at that time.
    let named: Named<'_> = serde_json::from_slice(&plain).map_err(|_| Refused::NotAPosition)?;
    let (status, reason) = (Status::InvalidInput, Some(Reason::InvalidNumber));
    Ok(Position { status, reason, ..empty(named.v, &named.track, named.time_ns)? })
}

/// A line, and what it says against itself under other keys.
fn stated(parsed: &Line<'_>, line: &[u8], statements: &Statements, keys: &mut Keys) -> Decoded {
    let position = whole(parsed)?;
    let against = statements::heard(line, &KEYS, position.lat_rad.zip(position.lon_rad), statements, keys);
    let stopped = parsed.nav_mode.as_deref().is_some_and(|mode| statements.stopped(mode));
    if stopped {
        keys.against.count("nav_mode");
    }
    let status = if against { Status::InvalidInput } else { Status::NotAvailable };
    let refused = (against || stopped) && position.status.usable();
    Ok(if refused { Position { status, reason: Some(Reason::Reported), ..position } } else { position })
}

fn empty(version: u32, track: &str, time_ns: i64) -> Decoded {
    if version != VERSION {
        return Err(Refused::Version);
    }
    let track = TrackId::new(track).ok_or(Refused::TrackName)?;
    if time_ns < 0 {
        return Err(Refused::Undated);
    }
    Ok(Position::new(track, GpsTime::from_nanoseconds(time_ns)))
}

/// The line with `null` in the place of `NaN`, `Infinity` and `-Infinity` outside texts.
fn without_nan(line: &[u8]) -> Vec<u8> {
    const WORDS: [&[u8]; 6] = [b"NaN", b"nan", b"-Infinity", b"Infinity", b"-inf", b"inf"];
    let (mut plain, mut rest, mut in_text) = (Vec::with_capacity(line.len()), line, false);
    while let [first, behind @ ..] = rest {
        if let Some(word) = WORDS.iter().find(|word| !in_text && rest.starts_with(word)) {
            plain.extend_from_slice(b"null");
            rest = &rest[word.len()..];
            continue;
        }
        plain.push(*first);
        rest = behind;
        match (first, behind) {
            (b'\\', [escaped, behind @ ..]) if in_text => {
                plain.push(*escaped);
                rest = behind;
            }
            (b'"', _) => in_text = !in_text,
            _ => {}
        }
    }
    plain
}

fn whole(line: &Line<'_>) -> Decoded {
    let stated = line.status.as_deref().unwrap_or("ok");
    // A word of no list is nobody's `ok`.
    let status = Status::from_id(stated).unwrap_or(Status::NotAvailable);
    let position = Position {
        status,
        reason: (!status.usable()).then_some(Reason::Reported),
        lat_rad: line.place(line.est_lat_rad),
        lon_rad: line.place(line.est_lon_rad),
        h_m: line.est_h_m,
        fte_m: line.fte_m,
        course_rad: line.course_rad,
        ground_speed_mps: line.ground_speed_mps.and_then(|written| stated_mps(written, 1.0)),
        ground_track_rad: line.ground_track_rad,
        covariance_m2: line.covariance(),
        // A level of nothing bounds nothing.
        hpl_m: line.hpl_m.map(|level| if level > 0.0 { level } else { f64::NAN }),
        rnp_m: line.rnp_m,
        shown: Shown {
            fte_v_m: line.fte_v_m,
            vpl_m: line.vpl_m,
            hal_m: line.hal_m,
            val_m: line.val_m,
            n_sv: line.n_sv,
            nav_mode: line.nav_mode.as_deref().and_then(TrackId::new),
            claim: Claim::default(),
        },
        ..empty(line.v, &line.track, line.time_ns)?
    };
    Ok(position)
}

impl Line<'_> {
    /// A coordinate. Where the deviation from the path is not stated either, one that is absent is one that is not known.
    fn place(&self, coordinate: Option<f64>) -> Option<f64> {
        coordinate.or_else(|| self.fte_m.is_none().then_some(f64::NAN))
    }

    /// The covariance, or that of one standard deviation in every direction; where both are stated, no variance is below the deviation's.
    /// Terms that are absent beside others are not known.
    fn covariance(&self) -> Option<[f64; 6]> {
        let terms = [self.cov_ee_m2, self.cov_en_m2, self.cov_nn_m2, self.cov_eu_m2, self.cov_nu_m2, self.cov_uu_m2];
        // A square would make a negative deviation look like a good one.
        let variance = self.sigma_m.map(|sigma| if sigma >= 0.0 { sigma * sigma } else { f64::NAN });
        if !terms.iter().any(Option::is_some) {
            return variance.map(|variance| [variance, 0.0, variance, 0.0, 0.0, variance]);
        }
        let [ee, en, nn, eu, nu, uu] = terms.map(|term| term.unwrap_or(f64::NAN));
        // What is below zero or no number is no variance, whatever stands beside it, and is judged as it is.
        let least = |term: f64| match variance {
            Some(least) if term >= 0.0 && !(least <= term) => least + 0.0 * term,
            _ => term,
        };
        Some([least(ee), en, least(nn), eu, nu, least(uu)])
    }
}
