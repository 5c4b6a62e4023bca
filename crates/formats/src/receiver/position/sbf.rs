//! Septentrio: PVTGeodetic or PVTCartesian with PosCovGeodetic or PosCovCartesian and DOP of the same epoch.
//!
//! Source: Septentrio SBF reference guide; standard. Times are GPS weeks, not rolled over, and milliseconds.

use super::decoder::Step;
use super::epoch::{Message, of_kind};
use super::{Absent, Fields, Note, Position, Reason};
use crate::measured::SBF_MODES;
use crate::receiver::bits::{f32_at, f64_at, u8_at, u16_at, u32_at};
use crate::time::from_week;
use core::f64::consts::{FRAC_PI_2, TAU};
use nalgebra::Matrix3;
use navbound_core::frame::{Covariance, Ecef, EcefPosition, LatLon, geodetic_from_ecef};
use navbound_core::quantity::Radians;

const DOP: u32 = 4001;
const PVT_CARTESIAN: u32 = 4006;
const PVT_GEODETIC: u32 = 4007;
const COV_CARTESIAN: u32 = 5905;
const COV_GEODETIC: u32 = 5906;
/// Value that means "do not use".
const ABSENT: f64 = -2e10;
const UNKNOWN_TOW: u32 = u32::MAX;
const UNKNOWN_WEEK: u16 = u16::MAX;
/// WGS-84 and what is equal to it, and the datum of the corrections.
const WGS84_LIKE: [u8; 2] = [0, 255];
/// From the Earth's centre \[m\]: nearer, latitude has no meaning; farther, no receiver is. Provenance: ours.
const DEEPEST_M: f64 = 5e4;
const HIGHEST_M: f64 = 1e9;

const GEODETIC_FIELDS: Fields =
    &[("est_lat_rad", "PVTGeodetic"), ("est_lon_rad", "PVTGeodetic"), ("est_h_m", "PVTGeodetic"), ("time", "WNc, TOW:gps")];
const CARTESIAN_FIELDS: Fields =
    &[("est_lat_rad", "PVTCartesian"), ("est_lon_rad", "PVTCartesian"), ("est_h_m", "PVTCartesian"), ("time", "WNc, TOW:gps")];

pub(super) fn step(block: u16, body: &[u8]) -> Step {
    let kind = u32::from(block);
    let (shortest, short) = match kind {
        DOP => (24, "DOP is shorter than its definition"),
        PVT_CARTESIAN => (67, "PVTCartesian is shorter than its definition"),
        PVT_GEODETIC => (67, "PVTGeodetic is shorter than its definition"),
        COV_CARTESIAN => (48, "PosCovCartesian is shorter than its definition"),
        COV_GEODETIC => (48, "PosCovGeodetic is shorter than its definition"),
        _ => return Step::Passed,
    };
    match u32_at(body, 0).zip(u16_at(body, 4)) {
        Some((tow_ms, week)) if body.len() >= shortest => Step::Part { key: i64::from(week) << 32 | i64::from(tow_ms), kind },
        _ => Step::Malformed(short),
    }
}

/// One epoch. Of the two forms of a block the geodetic one is used: it needs no conversion.
pub(super) fn position(messages: &[Message]) -> Option<Position> {
    let geodetic = of_kind(messages, PVT_GEODETIC);
    let pvt = geodetic.or_else(|| of_kind(messages, PVT_CARTESIAN))?;
    let (record, pvt) = (pvt.record, pvt.body.as_slice());
    let (tow_ms, week) = (u32_at(pvt, 0)?, u16_at(pvt, 4)?);
    let place = if geodetic.is_some() { place(pvt) } else { place_of_axes(pvt) };
    if let Some(reason) = absent(pvt, place.is_some(), week == UNKNOWN_WEEK || tow_ms == UNKNOWN_TOW) {
        let stated = format!("mode {}, error {}", u8_at(pvt, 6)? & 0x0f, u8_at(pvt, 7)?);
        let time = if reason == Reason::TimeNotKnown { None } else { from_week(i64::from(week), i64::from(tow_ms) * 1_000_000) };
        return Some(Position { record, time, absent: Some(Absent { reason, stated }), ..Position::default() });
    }
    let place = place?;
    let datum = u8_at(pvt, 65)?;
    let velocity = if geodetic.is_some() { velocity(pvt) } else { None };
    let (covariance_m2, covariance_from) = covariance(messages, place).unzip();
    let dop = of_kind(messages, DOP).map(|dop| dop.body.as_slice());
    let ratio = |at: usize| dop.and_then(|dop| u16_at(dop, at)).filter(|value| *value > 0).map(|value| f64::from(value) / 100.0);
    let levels = dop.and_then(|dop| stated(dop, [16, 20]));
    Some(Position {
        record,
        time: from_week(i64::from(week), i64::from(tow_ms) * 1_000_000),
        lat_rad: Some(place[0]),
        lon_rad: Some(place[1]),
        h_m: Some(place[2]),
        covariance_m2,
        ground_speed_mps: velocity.map(|[n, e, _]| libm::hypot(n, e)),
        ground_track_rad: geodetic.and_then(|_| stated(pvt, [48])).map(|[course_deg]| course_deg.to_radians()),
        vertical_rate_mps: velocity.map(|[_, _, u]| u),
        n_sv: u8_at(pvt, 66).map(u32::from),
        hdop: ratio(12),
        vdop: ratio(14),
        hpl_m: levels.map(|[hpl, _]| hpl),
        vpl_m: levels.map(|[_, vpl]| vpl),
        fields: if geodetic.is_some() { GEODETIC_FIELDS } else { CARTESIAN_FIELDS },
        covariance_from,
        levels_from: if levels.is_some() { &[("hpl_m", "DOP HPL"), ("vpl_m", "DOP VPL")] } else { &[] },
        notes: [(!WGS84_LIKE.contains(&datum)).then_some(Note::Datum(datum)), None],
        ..Position::default()
    })
}

fn absent(pvt: &[u8], placed: bool, undated: bool) -> Option<Reason> {
    let measured = u8_at(pvt, 6).is_some_and(|mode| SBF_MODES.contains(&(mode & 0x0f))) && u8_at(pvt, 7) == Some(0);
    if undated { Some(Reason::TimeNotKnown) } else { (!(measured && placed)).then_some(Reason::NotMeasured) }
}

/// Values that are all stated.
fn stated<const N: usize>(body: &[u8], at: [usize; N]) -> Option<[f64; N]> {
    let values = at.map(|at| f32_at(body, at).map_or(f64::NAN, f64::from));
    values.iter().all(|value| *value > ABSENT).then_some(values)
}

/// North, east, up \[m/s\].
fn velocity(pvt: &[u8]) -> Option<[f64; 3]> {
    stated(pvt, [36, 40, 44])
}

/// Latitude, longitude \[rad\], height \[m\].
fn place(pvt: &[u8]) -> Option<[f64; 3]> {
    let [lat, lon, h] = [f64_at(pvt, 8)?, f64_at(pvt, 16)?, f64_at(pvt, 24)?];
    (lat.abs() <= FRAC_PI_2 && lon.abs() <= TAU && h.is_finite() && h > ABSENT).then_some([lat, lon, h])
}

fn place_of_axes(pvt: &[u8]) -> Option<[f64; 3]> {
    let axes = [f64_at(pvt, 8)?, f64_at(pvt, 16)?, f64_at(pvt, 24)?];
    let far = axes.iter().map(|axis| axis * axis).sum::<f64>();
    if !(axes.iter().all(|axis| *axis > ABSENT) && (DEEPEST_M * DEEPEST_M..HIGHEST_M * HIGHEST_M).contains(&far)) {
        return None;
    }
    let at = geodetic_from_ecef(&EcefPosition::from_vector(axes.into())).ok()?;
    Some([at.point.lat().rad(), at.point.lon().rad(), at.height.m()])
}

/// Covariance ee, en, nn, eu, nu, uu \[m²\] and the block it comes from.
fn covariance(messages: &[Message], [lat, lon, _]: [f64; 3]) -> Option<([f64; 6], &'static str)> {
    let sound = |kind| of_kind(messages, kind).map(|message| message.body.as_slice()).filter(|cov| u8_at(cov, 7) == Some(0));
    if of_kind(messages, COV_GEODETIC).is_some() {
        // The block's order: latitude, longitude, height, clock; latitude with longitude, height, clock; longitude with height.
        let [nn, ee, uu, en, nu, eu] = stated(sound(COV_GEODETIC)?, [8, 12, 16, 24, 28, 36])?;
        return Some(([ee, en, nn, eu, nu, uu], "PosCovGeodetic"));
    }
    let [xx, yy, zz, xy, xz, yz] = stated(sound(COV_CARTESIAN)?, [8, 12, 16, 24, 28, 36])?;
    let point = LatLon::new(Radians::new(lat), Radians::new(lon)).ok()?;
    let m = *Covariance::<Ecef>::claim_symmetric(Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)).to_enu(&point).matrix();
    Some(([m.m11, m.m12, m.m22, m.m13, m.m23, m.m33], "PosCovCartesian"))
}
