//! One row to one position.

use super::header::{Form, Layout, fields};
use crate::time::{Calendar, from_calendar, from_week};
use nalgebra::{Matrix3, Vector3};
use navbound_core::frame::{Covariance, Ecef, EcefPosition, Enu, Geodetic, LatLon, ecef_from_geodetic, enu_from_ecef, geodetic_from_ecef};
use navbound_core::quantity::{GpsTime, Metres, Radians};

/// One position. NaN and zero as in [`super::Solutions`].
pub(super) struct Row {
    pub(super) time: GpsTime,
    pub(super) lat: f64,
    pub(super) lon: f64,
    pub(super) h: f64,
    pub(super) covariance: [f64; 6],
    pub(super) quality: u8,
    pub(super) n_sv: u32,
    pub(super) ground_speed: f64,
    pub(super) levels: [f64; 2],
}

/// What is wrong with a row.
pub(super) struct Fault<'a> {
    pub(super) field: &'static str,
    pub(super) reason: &'static str,
    pub(super) text: &'a str,
}

pub(super) fn parse<'a>(content: &'a str, layout: &Layout) -> Result<Row, Fault<'a>> {
    let f: Vec<&str> = fields(content).collect();
    if f.len() != layout.n_fields {
        return Err(Fault { field: "row", reason: "the number of fields differs from the header", text: content });
    }
    let time = time(f[0], f[1], layout).ok_or(Fault { field: "time", reason: "not a time", text: content })?;
    let root = roots(&f, layout)?;
    let fault = |reason| Fault { field: "position", reason, text: content };
    let (position, covariance) = place(&f, layout, &root)?.ok_or(fault("outside the Earth's neighbourhood"))?;
    if !(position.height.m() > -20_000.0 && position.height.m() < 1e8) {
        return Err(fault("height outside (-20 km, 100 000 km)"));
    }
    let velocity = match layout.velocity {
        Some([n, e]) => number(f[n], "vn(m/s)")?.hypot(number(f[e], "ve(m/s)")?),
        None => f64::NAN,
    };
    let levels = match layout.levels {
        Some([h, v]) => [level(f[h], "hpl (m)")?, level(f[v], "vpl (m)")?],
        None => [f64::NAN; 2],
    };
    Ok(Row {
        time,
        lat: position.point.lat().rad(),
        lon: position.point.lon().rad(),
        h: position.height.m(),
        covariance,
        quality: layout.quality.map_or(Ok(0), |i| count(f[i], "Q"))?.try_into().unwrap_or(u8::MAX),
        n_sv: layout.n_sv.map_or(Ok(0), |i| count(f[i], "ns"))?,
        ground_speed: velocity,
        levels,
    })
}

/// `2023/07/11 06:04:30.000` or week and time of week `2270 194670.000`.
fn time(first: &str, second: &str, layout: &Layout) -> Option<GpsTime> {
    if !first.contains('/') {
        return from_week(first.parse().ok()?, decimal_ns(second, 604_800)?);
    }
    let mut date = first.split('/');
    let mut clock = second.split(':');
    let calendar = Calendar {
        year: date.next()?.parse().ok()?,
        month: date.next()?.parse().ok()?,
        day: date.next()?.parse().ok()?,
        hour: clock.next()?.parse().ok()?,
        minute: clock.next()?.parse().ok()?,
        nanoseconds: decimal_ns(clock.next()?, 61)?,
    };
    if date.next().is_some() || clock.next().is_some() { None } else { from_calendar(calendar, layout.scale) }
}

/// Seconds with a fraction, below `limit_s`, as whole nanoseconds without passing through a float.
fn decimal_ns(text: &str, limit_s: i64) -> Option<i64> {
    let (whole, fraction) = text.split_once('.').unwrap_or((text, ""));
    if !(whole.bytes().chain(fraction.bytes()).all(|b| b.is_ascii_digit()) && fraction.len() <= 9) {
        return None;
    }
    let seconds: i64 = whole.parse().ok()?;
    let scale = 10_i64.pow(9 - u32::try_from(fraction.len()).ok()?);
    let part: i64 = if fraction.is_empty() { 0 } else { fraction.parse().ok()? };
    (seconds < limit_s).then(|| seconds * 1_000_000_000 + part * scale)
}

fn number<'a>(text: &'a str, field: &'static str) -> Result<f64, Fault<'a>> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => Err(Fault { field, reason: "not a finite number", text }),
        Err(_) => Err(Fault { field, reason: "not a number", text }),
    }
}

fn level<'a>(text: &'a str, field: &'static str) -> Result<f64, Fault<'a>> {
    let value = number(text, field)?;
    if value > 0.0 { Ok(value) } else { Err(Fault { field, reason: "not above zero", text }) }
}

fn count<'a>(text: &'a str, field: &'static str) -> Result<u32, Fault<'a>> {
    // Programs that write every column as a float write a count as `1.0000000`.
    let (whole, fraction) = text.split_once('.').unwrap_or((text, ""));
    let none = fraction.bytes().all(|b| b == b'0');
    if none { whole.parse().ok() } else { None }.ok_or(Fault { field, reason: "not a count", text })
}

/// The covariance of the file's own axes, from its signed roots.
fn roots<'a>(f: &[&'a str], layout: &Layout) -> Result<Option<Matrix3<f64>>, Fault<'a>> {
    const FIELD: &str = "standard deviation";
    let Some(columns) = layout.roots else { return Ok(None) };
    let mut c = [0.0; 6];
    for (slot, column) in c.iter_mut().zip(columns) {
        let root = number(f[column], FIELD)?;
        *slot = root * root.abs();
    }
    if !(c[..3].iter().all(|v| *v >= 0.0)) {
        return Err(Fault { field: FIELD, reason: "below zero", text: f[columns[0]] });
    }
    Ok(Some(Matrix3::new(c[0], c[3], c[5], c[3], c[1], c[4], c[5], c[4], c[2])))
}

/// The position, and its covariance in east-north-up axes there; `None` where the numbers name no place near the Earth.
fn place<'a>(f: &[&'a str], layout: &Layout, own: &Option<Matrix3<f64>>) -> Result<Option<(Geodetic, [f64; 6])>, Fault<'a>> {
    let at = layout.position;
    let three = |names: [&'static str; 3]| -> Result<[f64; 3], Fault<'a>> {
        Ok([number(f[at], names[0])?, number(f[at + 1], names[1])?, number(f[at + 2], names[2])?])
    };
    let (lat_deg, lon_deg, h) = match layout.form {
        Form::Ecef => {
            let [x, y, z] = three(["x-ecef(m)", "y-ecef(m)", "z-ecef(m)"])?;
            return Ok(cartesian(Vector3::new(x, y, z), own));
        }
        Form::Baseline([lat, lon, h]) => {
            let [e, n, u] = three(["e-baseline(m)", "n-baseline(m)", "u-baseline(m)"])?;
            return Ok(baseline(lat, lon, h, Vector3::new(e, n, u), own));
        }
        Form::Degrees => {
            let [lat, lon, h] = three(["latitude(deg)", "longitude(deg)", "height(m)"])?;
            (lat, lon, h)
        }
        Form::Sexagesimal => (
            sexagesimal(&f[at..at + 3], "latitude(d'\")")?,
            sexagesimal(&f[at + 3..at + 6], "longitude(d'\")")?,
            number(f[at + 6], "height(m)")?,
        ),
    };
    let point = angles(f, layout, lat_deg, lon_deg)?;
    // The file's order is north, east, up.
    let enu = own.map(|c| [c.m22, c.m12, c.m11, c.m23, c.m13, c.m33]);
    Ok(Some((Geodetic { point, height: Metres::new(h) }, enu.unwrap_or([f64::NAN; 6]))))
}

fn angles<'a>(f: &[&'a str], layout: &Layout, lat_deg: f64, lon_deg: f64) -> Result<LatLon, Fault<'a>> {
    let text = f[layout.position];
    if !(lat_deg.abs() <= 90.0) {
        return Err(Fault { field: "latitude(deg)", reason: "outside [-90, 90]", text });
    }
    if !(lon_deg.abs() <= 360.0) {
        return Err(Fault { field: "longitude(deg)", reason: "outside [-360, 360]", text });
    }
    LatLon::new(Radians::degrees(lat_deg), Radians::degrees(lon_deg)).map_err(|_| Fault {
        field: "position",
        reason: "not a place on the Earth",
        text,
    })
}

/// Degrees, minutes, seconds; the sign stands at the degrees, `-0` included.
fn sexagesimal<'a>(parts: &[&'a str], field: &'static str) -> Result<f64, Fault<'a>> {
    let (d, m, s) = (number(parts[0], field)?, number(parts[1], field)?, number(parts[2], field)?);
    if !((0.0..60.0).contains(&m) && (0.0..60.0).contains(&s)) {
        return Err(Fault { field, reason: "minutes or seconds outside [0, 60)", text: parts[1] });
    }
    let size = d.abs() + m / 60.0 + s / 3600.0;
    Ok(if d.is_sign_negative() { -size } else { size })
}

fn cartesian(x: Vector3<f64>, own: &Option<Matrix3<f64>>) -> Option<(Geodetic, [f64; 6])> {
    let position = geodetic_from_ecef(&EcefPosition::from_vector(x)).ok()?;
    let enu = own.map(|c| upper(&Covariance::<Ecef>::claim_symmetric(c).to_enu(&position.point)));
    Some((position, enu.unwrap_or([f64::NAN; 6])))
}

/// East, north, up in the base station's axes: through Earth-centred axes to the rover's own.
fn baseline(lat: f64, lon: f64, h: f64, enu: Vector3<f64>, own: &Option<Matrix3<f64>>) -> Option<(Geodetic, [f64; 6])> {
    let point = LatLon::new(Radians::new(lat), Radians::new(lon)).ok()?;
    let to_ecef = enu_from_ecef(&point).transpose();
    let base = ecef_from_geodetic(&Geodetic { point, height: Metres::new(h) });
    cartesian(base.vector() + to_ecef * enu, &own.map(|c| to_ecef * c * to_ecef.transpose()))
}

fn upper(c: &Covariance<Enu>) -> [f64; 6] {
    let m = c.matrix();
    [m.m11, m.m12, m.m22, m.m13, m.m23, m.m33]
}
