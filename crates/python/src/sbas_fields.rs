//! The fields of a decoded SBAS message as a dictionary; names carry their units.

use crate::fields::fields;
use navbound_core::signal::sbas::{Fast, GeoAlmanac, LongTerm, LongTermHalf, Message, Region};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// A dictionary from pairs.
macro_rules! dict {
    ($py:expr, $($name:literal: $value:expr),* $(,)?) => {{
        let d = PyDict::new($py);
        $(d.set_item($name, $value)?;)*
        d
    }};
}

/// Fields of a message; empty for one that tells a user nothing.
pub fn fields<'py>(py: Python<'py>, message: &Message) -> PyResult<Bound<'py, PyDict>> {
    Ok(match message {
        Message::DoNotUse(content) => dict!(py, "do_not_use": true, "content": content.as_ref().map(|f| fast(py, f)).transpose()?),
        Message::PrnMask(m) => dict!(py, "iodp": m.iodp, "prn": m.prns().iter().map(|p| i64::from(*p)).collect::<Vec<_>>()),
        Message::Fast(f) => fast(py, f)?,
        Message::Integrity(i) => dict!(py, "iodf": i.iodf.map(i64::from), "udrei": i.udrei.map(i64::from)),
        Message::FastDegradation(f) => dict!(py, "latency_s": f.latency_s, "iodp": f.iodp, "indicator": f.indicator.map(i64::from)),
        Message::GeoNavigation(g) => dict!(py,
            "time_of_day_s": g.time_of_day_s, "ura_index": g.ura_index, "position_ecef_m": g.position_ecef_m,
            "velocity_ecef_mps": g.velocity_ecef_mps, "acceleration_ecef_mps2": g.acceleration_ecef_mps2,
            "clock_s": g.clock_s, "drift": g.drift),
        Message::Degradation(d) => dict!(py,
            "rrc_m": d.rrc_m, "ltc_lsb_m": d.ltc_lsb_m, "ltc_v1_mps": d.ltc_v1_mps, "ltc_v1_s": d.ltc_v1_s,
            "ltc_v0_m": d.ltc_v0_m, "ltc_v0_s": d.ltc_v0_s, "geo_lsb_m": d.geo_lsb_m, "geo_v_mps": d.geo_v_mps, "geo_s": d.geo_s,
            "er_m": d.er_m, "iono_step_m": d.iono_step_m, "iono_s": d.iono_s, "iono_ramp_mps": d.iono_ramp_mps,
            "rss_udre": d.rss_udre, "rss_iono": d.rss_iono, "covariance": d.covariance),
        Message::NetworkTime(t) => dict!(py,
            "drift": t.drift, "offset_s": t.offset_s, "reference_s": t.reference_s, "reference_week": t.reference_week,
            "leap_s": t.leap_s, "leap_week": t.leap_week, "leap_day": t.leap_day, "leap_after_s": t.leap_after_s,
            "utc_standard": t.utc_standard, "time_of_week_s": t.time_of_week_s, "week": t.week),
        Message::GeoAlmanacs(a) => {
            let entries: PyResult<Vec<_>> = a.entries.iter().flatten().map(|e| almanac(py, e)).collect();
            dict!(py, "time_of_day_s": a.time_of_day_s, "entries": entries?)
        }
        Message::GridMask(m) => dict!(py,
            "bands": m.bands, "band": m.band, "iodi": m.iodi, "point": m.points().iter().map(|p| i64::from(*p)).collect::<Vec<_>>()),
        Message::Mixed(f, half) => {
            let d = fast(py, f)?;
            d.set_item("long_term", long_term(py, &[*half])?)?;
            d
        }
        Message::LongTerm(halves) => dict!(py, "long_term": long_term(py, halves)?),
        Message::GridDelays(g) => dict!(py,
            "band": g.band, "block": g.block, "iodi": g.iodi,
            "delay_m": g.points.map(|p| p.delay_m), "givei": g.points.map(|p| i64::from(p.givei))),
        Message::ServiceRegions(s) => {
            let regions: PyResult<Vec<_>> = s.regions.iter().flatten().map(|r| region(py, r)).collect();
            dict!(py,
                "iods": s.iods, "messages": s.messages, "number": s.number, "priority": s.priority,
                "delta_udre_inside": s.inside, "delta_udre_outside": s.outside, "regions": regions?)
        }
        Message::Covariances(c) => {
            let satellites: PyResult<Vec<_>> = c
                .satellites
                .iter()
                .flatten()
                .map(|s| Ok(dict!(py, "position": s.position, "scale": s.scale, "factor": s.factor)))
                .collect();
            dict!(py, "iodp": c.iodp, "satellites": satellites?)
        }
        Message::InternalTest | Message::Null | Message::Unknown(_) => PyDict::new(py),
    })
}

fn fast<'py>(py: Python<'py>, f: &Fast) -> PyResult<Bound<'py, PyDict>> {
    let (position, rest): (Vec<_>, Vec<_>) = f.satellites().map(|(p, m, u)| (p, (m, i64::from(u)))).unzip();
    let (correction_m, udrei): (Vec<_>, Vec<_>) = rest.into_iter().unzip();
    Ok(dict!(py, "iodf": f.iodf, "iodp": f.iodp, "position": position, "correction_m": correction_m, "udrei": udrei))
}

fn long_term<'py>(py: Python<'py>, halves: &[LongTermHalf]) -> PyResult<Vec<Bound<'py, PyDict>>> {
    halves.iter().flatten().flatten().map(|l| one_long_term(py, l)).collect()
}

fn one_long_term<'py>(py: Python<'py>, l: &LongTerm) -> PyResult<Bound<'py, PyDict>> {
    let d = dict!(py,
        "position": l.position, "iodp": l.iodp, "iode": l.iode, "position_ecef_m": l.position_ecef_m, "clock_s": l.clock_s);
    if let Some(r) = &l.rates {
        fields!(d, r: velocity_ecef_mps, drift, time_of_day_s);
    }
    Ok(d)
}

fn almanac<'py>(py: Python<'py>, e: &GeoAlmanac) -> PyResult<Bound<'py, PyDict>> {
    Ok(dict!(py,
        "prn": e.prn, "health": e.health, "position_ecef_m": e.position_ecef_m, "velocity_ecef_mps": e.velocity_ecef_mps))
}

fn region<'py>(py: Python<'py>, r: &Region) -> PyResult<Bound<'py, PyDict>> {
    Ok(dict!(py, "first_deg": r.first_deg, "second_deg": r.second_deg, "rectangle": r.rectangle))
}
