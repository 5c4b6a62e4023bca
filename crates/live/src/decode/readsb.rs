//! ADS-B states as readsb writes them, one JSON object a position: whose, where, and what the aircraft itself claims of its accuracy (NACp)
//! and integrity (NIC, SIL). docs/methods/live.md says what becomes of a claim.

use super::Decoded;
use super::keys::Keys;
use super::statements::{self, Statements};
use crate::claims::{Claim, Claims};
use crate::counters::Refused;
use crate::position::{Position, Shown, TrackId};
use navbound_core::monitor::no_speed::stated_mps;
use navbound_core::quantity::{KNOT_MPS, Metres, Reason, Status};
use navbound_formats::time;
use serde::Deserialize;
use std::borrow::Cow;

const NS_PER_S: f64 = 1e9;
/// Negative age up to which rounding explains it \[s\], as in recordings. Provenance: ours.
const OLDEST_AHEAD_S: f64 = 2.0;
/// Unix times that can be nanoseconds of GPS time \[s\]: 1980-01-06 and the end of 64 bits.
const UNIX_S: (f64, f64) = (315_964_800.0, 9.0e9);

/// Keys of readsb; the others are passed over.
#[derive(Deserialize)]
struct Line<'a> {
    /// Unix time of the object \[s\].
    now: f64,
    #[serde(borrow)]
    hex: Cow<'a, str>,
    /// How the position came: `adsb_icao`, `mlat`, `tisb_icao`.
    #[serde(rename = "type", default, borrow)]
    kind: Option<Cow<'a, str>>,
    /// Age of the position \[s\].
    #[serde(default)]
    seen_pos: Option<f64>,
    /// Time since the last message of the aircraft, and no position is newer \[s\].
    #[serde(default)]
    seen: Option<f64>,
    #[serde(default)]
    lat: Option<f64>,
    #[serde(default)]
    lon: Option<f64>,
    #[serde(default)]
    alt_geom: Option<f64>,
    #[serde(default)]
    gs: Option<f64>,
    /// Track over the ground from true north \[deg\].
    #[serde(default)]
    track: Option<f64>,
    #[serde(default)]
    nic: Option<u8>,
    /// Radius of containment, 0 where there is none \[m\].
    #[serde(default)]
    rc: Option<f64>,
    #[serde(default)]
    nac_p: Option<u8>,
    #[serde(default)]
    sil: Option<u8>,
    /// Names of values that multilateration gave.
    #[serde(default)]
    mlat: Vec<String>,
    /// Names of values that a ground station sent.
    #[serde(default)]
    tisb: Vec<String>,
}

/// Keys that say nothing against a position, or of which something is read: of the others what tables hear of them is heard. `alert` is the
/// transponder's. Provenance: standard, from knowledge of the format (the README of readsb's JSON).
const KEYS: [&str; 65] = [
    "now",
    "hex",
    "type",
    "seen_pos",
    "seen",
    "lat",
    "lon",
    "alt_geom",
    "gs",
    "nic",
    "rc",
    "nac_p",
    "sil",
    "mlat",
    "tisb",
    "flight",
    "r",
    "t",
    "desc",
    "ownOp",
    "year",
    "dbFlags",
    "category",
    "squawk",
    "emergency",
    "alert",
    "spi",
    "alt_baro",
    "baro_rate",
    "geom_rate",
    "ias",
    "tas",
    "mach",
    "track",
    "track_rate",
    "calc_track",
    "roll",
    "mag_heading",
    "true_heading",
    "nav_qnh",
    "nav_altitude_mcp",
    "nav_altitude_fms",
    "nav_heading",
    "nav_modes",
    "wd",
    "ws",
    "oat",
    "tat",
    "version",
    "nic_baro",
    "nic_a",
    "nic_c",
    "nac_v",
    "sil_type",
    "gva",
    "messages",
    "rssi",
    "lastPosition",
    "rr_lat",
    "rr_lon",
    "dst",
    "dir",
    "acas_ra",
    "gpsOkLat",
    "gpsOkLon",
];

/// Whose a line is, and nothing else of it.
#[derive(Deserialize)]
struct Named<'a> {
    #[serde(borrow)]
    hex: Cow<'a, str>,
}

/// The track of a line; `None` where it names none.
pub(super) fn track(line: &[u8]) -> Option<TrackId> {
    let named: Named<'_> = serde_json::from_slice(line).ok()?;
    address(&named.hex)
}

/// Six hexadecimal digits in lower case, behind `~` where the address is none of the International Civil Aviation Organization's.
fn address(hex: &str) -> Option<TrackId> {
    let digits = hex.strip_prefix('~').unwrap_or(hex);
    let known = digits.len() == 6 && digits.bytes().all(|b| b.is_ascii_hexdigit());
    TrackId::new(&hex.to_ascii_lowercase()).filter(|_| known)
}

pub(super) fn position(bytes: &[u8], claims: &Claims, statements: &Statements, keys: &mut Keys) -> Decoded {
    let line: Line<'_> = serde_json::from_slice(bytes).map_err(|_| Refused::NotAPosition)?;
    let track = address(&line.hex).ok_or(Refused::TrackName)?;
    // A line without a position says something else of the aircraft: its silence is found by its missing positions.
    let (Some(lat_deg), Some(lon_deg)) = (line.lat, line.lon) else { return Err(Refused::NoPosition) };
    // A position of the future is of another clock, which must not be that of its lane.
    // f64::max prefers a number to a NaN.
    let [of_position_s, of_aircraft_s] = [line.seen_pos, line.seen].map(|age_s| age_s.unwrap_or(f64::NAN));
    let oldest_s = of_position_s.max(of_aircraft_s);
    let age_s = if oldest_s.is_nan() { 0.0 } else { oldest_s };
    let of_the_future = of_position_s < -OLDEST_AHEAD_S || of_aircraft_s < -OLDEST_AHEAD_S;
    let unix_s = if of_the_future { line.now } else { line.now - age_s };
    if !(UNIX_S.0..UNIX_S.1).contains(&unix_s) {
        return Err(Refused::Undated);
    }
    let time = time::from_unix((unix_s * 1e3).round() as i64 * (NS_PER_S / 1e3) as i64);
    let listed = |name: &str| line.mlat.iter().chain(&line.tisb).any(|each| each == name);
    // What others gave is no claim of the aircraft.
    let [nic, nac_p, sil] =
        [("nic", line.nic), ("nac_p", line.nac_p), ("sil", line.sil)].map(|(name, value)| value.filter(|_| !listed(name)));
    let rc = line.rc.filter(|_| !listed("rc"));
    let claim = Claim { nic, nac_p, sil };
    let known = Position {
        lat_rad: Some(lat_deg.to_radians()),
        lon_rad: Some(lon_deg.to_radians()),
        h_m: line.alt_geom.map(|feet| Metres::feet(feet).m()),
        age_s: if of_the_future { 0.0 } else { age_s.max(0.0) },
        ground_speed_mps: line.gs.and_then(|knots| stated_mps(knots, KNOT_MPS)),
        ground_track_rad: line.track.filter(|_| !listed("track")).map(f64::to_radians),
        shown: Shown { claim, ..Shown::default() },
        ..Position::new(track, time)
    };
    // A position that others computed or repeat is none that the aircraft claims anything of.
    if listed("lat") || listed("lon") || !line.kind.as_deref().is_some_and(|kind| kind.starts_with("adsb_")) {
        return Ok(known.without(Reason::ForeignPosition));
    }
    if of_the_future {
        return Ok(known.without(Reason::Reported));
    }
    // Keys that nothing reads are many, and those of readsb.
    let mut beside = Keys::default();
    if statements::heard(bytes, &KEYS, known.lat_rad.zip(known.lon_rad), statements, &mut beside) {
        beside.against.0.keys().for_each(|name| keys.against.count(name));
        return Ok(Position { status: Status::InvalidInput, reason: Some(Reason::Reported), ..known });
    }
    Ok(known.bounded(claims.bounds_beside(claim, rc)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::claims::tests::CLAIMS;

    const WHOLE: &str = r#"{"now":1731000000.500,"hex":"4CA123","type":"adsb_icao","flight":"<b>X</b>","seen_pos":0.250,"lat":48.5,"lon":2.25,"alt_geom":10000,"gs":360.0,"nic":8,"nac_p":9,"sil":3,"version":2}"#;

    fn stated(line: &str) -> Decoded {
        let lost = (vec!["gps_ok_before".into()], vec!["null".into()], None, None);
        let statements = Statements::new(vec![lost], Vec::new(), (Default::default(), [1852.0, 18_520.0]));
        position(line.as_bytes(), &CLAIMS, &statements, &mut Keys::default())
    }

    #[test]
    fn a_claim_becomes_a_circle_and_a_level() {
        let position = stated(WHOLE).unwrap();
        assert_eq!((position.track.name(), position.reason, position.hpl_m), ("4ca123", None, Some(185.2)));
        // 1731000000.25 s of Unix time is 1415035200.25 s behind the begin of GPS time, and 18 leap seconds came since.
        assert_eq!(position.time.nanoseconds(), 1_415_035_218_250_000_000);
        let [ee, en, nn, ..] = position.covariance_m2.unwrap();
        assert!((ee - 144.0).abs() < 1e-12 && en == 0.0 && nn == ee, "the deviation of the table, squared");
        assert!((position.ground_speed_mps.unwrap() - 185.2).abs() < 1e-12 && (position.h_m.unwrap() - 3048.0).abs() < 1e-9);
    }

    #[test]
    fn what_is_not_claimed_is_not_assumed() {
        let reason = |from: &str, to: &str| stated(&WHOLE.replace(from, to)).map(|position| position.reason);
        assert_eq!(reason(r#""nac_p":9,"#, ""), Ok(Some(Reason::NoAccuracyCategory)));
        assert_eq!(reason(r#""nac_p":9"#, r#""nac_p":0"#), Ok(Some(Reason::NoAccuracyCategory)));
        assert_eq!(reason(r#""nic":8"#, r#""nic":0"#), Ok(Some(Reason::NoIntegrityClaim)));
        assert_eq!(reason(r#""sil":3"#, r#""sil":1"#), Ok(Some(Reason::NoIntegrityClaim)));
        assert_eq!(reason(r#","sil":3"#, ""), Ok(Some(Reason::NoIntegrityClaim)));
        assert_eq!(reason("adsb_icao", "mlat"), Ok(Some(Reason::ForeignPosition)));
        for of_others in [r#""mlat":["gs","lat","lon"],"#, r#""tisb":["lon"],"#] {
            assert_eq!(reason(r#""lat":48.5,"#, &format!(r#""lat":48.5,{of_others}"#)), Ok(Some(Reason::ForeignPosition)));
        }
        assert_eq!(reason(r#""lat":48.5,"#, r#""lat":48.5,"mlat":["gs","track"],"tisb":[],"#), Ok(None));
        // An accuracy that others gave is none that the aircraft claims.
        let of_others = stated(&WHOLE.replace(r#""nic":8"#, r#""mlat":["nac_p"],"tisb":["nic"],"nic":8"#)).unwrap();
        assert_eq!((of_others.covariance_m2, of_others.hpl_m), (None, None));
        assert_eq!(reason(r#""type":"adsb_icao","#, ""), Ok(Some(Reason::ForeignPosition)));
        assert_eq!(reason(r#""lat":48.5,"#, ""), Err(Refused::NoPosition));
        assert_eq!(reason("4CA123", "<b>"), Err(Refused::TrackName));
        assert_eq!(reason("1731000000.500", "17"), Err(Refused::Undated));
        assert_eq!(reason(r#""seen_pos":0.250"#, r#""seen_pos":-30"#), Ok(Some(Reason::Reported)));
        let ahead = stated(&WHOLE.replace(r#""seen_pos":0.250"#, r#""seen_pos":-30"#)).unwrap();
        assert_eq!(ahead.time.nanoseconds(), 1_415_035_218_500_000_000, "the time of the line");
        assert_eq!(reason(r#""nic":8"#, r#""nic":-8"#), Err(Refused::NotAPosition));
        assert_eq!(reason(r#""nic":8"#, r#""nic":200"#), Ok(Some(Reason::NoIntegrityClaim)));
    }

    #[test]
    fn the_older_of_two_ages_is_that_of_the_position() {
        for (ages, age_s) in [
            (r#""seen_pos":0.250"#, 0.25),
            (r#""seen_pos":0.250,"seen":0.1"#, 0.25),
            (r#""seen_pos":0.250,"seen":40.0"#, 40.0),
            (r#""seen":40.0"#, 40.0),
            (r#""seen_pos":-0.5"#, 0.0),
        ] {
            assert_eq!(stated(&WHOLE.replace(r#""seen_pos":0.250"#, ages)).unwrap().age_s, age_s, "{ages}");
        }
        let position = stated(&WHOLE.replace(r#""seen_pos":0.250"#, r#""seen":40.5"#)).unwrap();
        assert_eq!(position.time.nanoseconds(), 1_415_035_178_000_000_000, "40.5 s before the line");
        let ahead = stated(&WHOLE.replace(r#""seen_pos":0.250"#, r#""seen_pos":-30,"seen":1"#)).unwrap();
        assert_eq!(ahead.reason, Some(Reason::Reported));
    }

    #[test]
    fn a_radius_counts_before_its_category_and_none_is_no_claim() {
        let level = |rc: &str| {
            let position = stated(&WHOLE.replace(r#""nic":8"#, rc)).unwrap();
            position.hpl_m.ok_or(position.reason)
        };
        let none = Err(Some(Reason::NoIntegrityClaim));
        assert_eq!([level(r#""nic":8,"rc":900"#), level(r#""rc":900"#)], [Ok(900.0); 2]);
        assert_eq!([level(r#""nic":8,"rc":0"#), level(r#""nic":0,"rc":900"#), level(r#""nic":8,"rc":-1"#)], [none; 3]);
    }

    #[test]
    fn what_a_line_says_against_its_position_is_heard() {
        let reason = |more: &str| stated(&WHOLE.replace(r#""lat":48.5,"#, &format!(r#""lat":48.5,{more}"#))).unwrap().reason;
        assert_eq!(reason(r#""gpsOkBefore":1731000000.0,"#), Some(Reason::Reported));
        assert_eq!(reason(r#""alert":1,"spi":1,"nav_modes":["lnav","tcas"],"emergency":"none","#), None);
    }

    #[test]
    fn numbers_that_are_no_speed_are_not_stated() {
        for knots in ["1023.0", "-1.0", "-5.0", "2000.0"] {
            assert_eq!(stated(&WHOLE.replace("360.0", knots)).unwrap().ground_speed_mps, None, "{knots}");
        }
    }
}
