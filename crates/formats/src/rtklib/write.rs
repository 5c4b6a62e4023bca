//! Positions to the text of a solution file, as the program itself writes it: degrees, GPS time, signed roots of the covariance.

use super::Solutions;
use crate::time::{Calendar, to_calendar};
use navbound_core::quantity::OutOfDomain;
use std::fmt::Write;

/// The columns, in the widths of the program.
const NAMES: &str = "%  GPST                  latitude(deg) longitude(deg)  height(m)   Q  ns   sdn(m)   sde(m)   sdu(m)  sdne(m)  sdeu(m)  sdun(m) age(s)  ratio";

/// A solution file of these rows; `line`, `refused` and `n_rows` are not looked at, and velocities are not written.
///
/// Angles carry nine decimals of a degree (0.1 mm), heights and roots four of a metre, times as many as they need and three at least.
///
/// # Errors
/// The row and what is wrong with it: a number that is not finite or outside its domain, a variance below zero, columns of unequal length.
pub fn write(s: &Solutions, program: &str) -> Result<String, (usize, OutOfDomain)> {
    let n = s.time.len();
    for (argument, len) in [
        ("est_lat_rad", s.lat_rad.len()),
        ("est_lon_rad", s.lon_rad.len()),
        ("est_h_m", s.h_m.len()),
        ("cov_m2", s.cov_m2.len()),
        ("quality", s.quality.len()),
        ("n_sv", s.n_sv.len()),
    ] {
        if len != n {
            return Err((0, OutOfDomain { argument, value: len as f64, unit: "rows", domain: "as many rows as times" }));
        }
    }
    let mut out = format!(
        "% program   : {program}\n% (lat/lon/height=WGS84/ellipsoidal,Q=1:fix,2:float,3:sbas,4:dgps,5:single,6:ppp,ns=# of satellites)\n{NAMES}\n"
    );
    for i in 0..n {
        row(s, i, &mut out).map_err(|e| (i, e))?;
    }
    Ok(out)
}

fn row(s: &Solutions, i: usize, out: &mut String) -> Result<(), OutOfDomain> {
    let inside =
        |argument, value: f64, unit, domain, good: bool| if good { Ok(value) } else { Err(OutOfDomain { argument, value, unit, domain }) };
    let (lat, lon, h) = (s.lat_rad[i], s.lon_rad[i], s.h_m[i]);
    inside("est_lat_rad", lat, "rad", "[-pi/2, pi/2]", lat.abs() <= core::f64::consts::FRAC_PI_2)?;
    inside("est_lon_rad", lon, "rad", "[-2 pi, 2 pi]", lon.abs() <= core::f64::consts::TAU)?;
    // The limits of the reader.
    inside("est_h_m", h, "m", "(-20 km, 100 000 km)", h > -20_000.0 && h < 1e8)?;
    let cov = s.cov_m2[i];
    let [ee, en, nn, eu, nu, uu] = cov;
    for value in [ee, nn, uu] {
        inside("covariance", value, "m²", "[0, inf) on the diagonal", value >= 0.0 && value.is_finite())?;
    }
    for value in cov {
        inside("covariance", value, "m²", "finite", value.is_finite())?;
    }
    let time = s.time[i];
    let nanoseconds = time.nanoseconds() as f64;
    let date = to_calendar(time).ok_or(OutOfDomain { argument: "time_ns", value: nanoseconds, unit: "ns", domain: "1980 to 2100" })?;
    let root = |c: f64| c.signum() * c.abs().sqrt();
    // Into a string nothing can fail.
    let _ = write!(out, "{} ", stamp(&date));
    let _ = write!(out, "{:14.9} {:14.9} {h:10.4} {:3} {:3}", lat.to_degrees(), lon.to_degrees(), s.quality[i], s.n_sv[i]);
    for c in [nn, ee, uu, en, eu, nu] {
        let _ = write!(out, " {:8.4}", root(c));
    }
    out.push_str("   0.00    0.0\n");
    Ok(())
}

/// `2023/07/11 06:04:30.000`, with more decimals where the time has them.
fn stamp(c: &Calendar) -> String {
    let (seconds, rest) = (c.nanoseconds / 1_000_000_000, c.nanoseconds % 1_000_000_000);
    let fraction = format!("{rest:09}");
    let kept = fraction.trim_end_matches('0').len().max(3);
    format!("{:04}/{:02}/{:02} {:02}:{:02}:{seconds:02}.{}", c.year, c.month, c.day, c.hour, c.minute, &fraction[..kept])
}
