//! SBAS: message logs, decoded messages, protection levels.

use crate::error::{format_error, input_error};
use crate::fields::fields;
use crate::receiver_files::Navigation;
use crate::sbas_fields::fields;
use navbound_assess::sbas::{self, Answer, Feed, FromTerms, Mode, Request, Settings, TermsRefused};
use navbound_core::bound::sbas::model::Airborne;
use navbound_core::bound::sbas::terms::RangeTerms;
use navbound_core::frame::{Covariance, Enu, Geodetic, LatLon};
use navbound_core::quantity::{GpsTime, Metres, OutOfDomain, Radians};
use navbound_core::signal::sbas::timeout::Use;
use navbound_core::signal::sbas::{BLOCK_BYTES, Block, Obedience, decode};
use navbound_formats::sbas::{Preambles, Received, Tag, read};
use numpy::{IntoPyArray, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::collections::BTreeMap;

/// A log: time_ns of the end of each message, prn, data (n, 32), format, tag, refused lines as (line, field, reason, text).
#[pyfunction]
fn sbas_read<'py>(py: Python<'py>, content: &[u8], path: &str, tag: Option<&str>) -> PyResult<Bound<'py, PyDict>> {
    let tag = match tag {
        None => None,
        Some("end") => Some(Tag::End),
        Some("start") => Some(Tag::Start),
        Some(other) => return Err(PyValueError::new_err(other.to_owned())),
    };
    let log = py.detach(|| read(content, tag)).map_err(|e| format_error(path, &e))?;
    let n = log.messages.len();
    let data: Vec<u8> = log.messages.iter().flat_map(|m| *m.block.bytes()).collect();
    let d = PyDict::new(py);
    d.set_item("time_ns", log.messages.iter().map(|m| m.end.nanoseconds()).collect::<Vec<_>>().into_pyarray(py))?;
    d.set_item("prn", log.messages.iter().map(|m| m.prn).collect::<Vec<_>>().into_pyarray(py))?;
    d.set_item("data", data.into_pyarray(py).reshape([n, BLOCK_BYTES])?)?;
    d.set_item("format", log.format.name())?;
    d.set_item("tag", if log.tag == Tag::End { "end" } else { "start" })?;
    let late = |p: &Preambles| (p.prn, p.late_s());
    d.set_item("late_s", Preambles::of(&log.messages).iter().map(late).collect::<BTreeMap<_, _>>())?;
    d.set_item("refused", log.refused.into_iter().map(|r| (r.line, r.field, r.reason, r.text)).collect::<Vec<_>>())?;
    Ok(d)
}

/// Decoded messages, one dictionary each: the type and its fields.
#[pyfunction]
fn sbas_decode<'py>(py: Python<'py>, data: PyReadonlyArray2<'py, u8>) -> PyResult<Vec<(u8, Bound<'py, PyDict>)>> {
    let rows = blocks(&data)?;
    rows.iter().map(|block| Ok((block.message_type(), fields(py, &decode(block))?))).collect()
}

fn blocks(data: &PyReadonlyArray2<'_, u8>) -> PyResult<Vec<Block>> {
    let (rows, rest) = data.as_slice()?.as_chunks::<BLOCK_BYTES>();
    if !rest.is_empty() || data.as_array().ncols() != BLOCK_BYTES {
        let value = data.as_array().ncols() as f64;
        return Err(input_error(OutOfDomain { argument: "data", value, unit: "columns", domain: "32 columns" }, None));
    }
    let block = |(i, row): (usize, &[u8; BLOCK_BYTES])| {
        let wrong = OutOfDomain {
            argument: "data",
            value: f64::from(row[0]),
            unit: "first byte",
            domain: "blocks whose preamble and parity are right",
        };
        Block::new(*row).map_err(|_| input_error(wrong, Some(i)))
    };
    rows.iter().enumerate().map(block).collect()
}

/// A service as a user hears it, as it comes from Python.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Service<'py> {
    message_time_ns: PyReadonlyArray1<'py, i64>,
    data: PyReadonlyArray2<'py, u8>,
    pub navigation: Bound<'py, Navigation>,
    mode: String,
    mask_rad: f64,
    noise_m: f64,
    divergence_m: f64,
    test_signal: bool,
}

/// Times and places.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct Places<'py> {
    time_ns: PyReadonlyArray1<'py, i64>,
    lat_rad: PyReadonlyArray1<'py, f64>,
    lon_rad: PyReadonlyArray1<'py, f64>,
    h_m: PyReadonlyArray1<'py, f64>,
}

impl Service<'_> {
    /// Its messages and how they are used.
    pub fn heard(&self) -> PyResult<(Feed, Settings)> {
        let ends = self.message_time_ns.as_slice()?;
        // The levels use one satellite's messages; who sent them no longer matters.
        let received = |(block, end): (Block, &i64)| Received { end: GpsTime::from_nanoseconds(*end), prn: 0, block };
        let messages: Vec<_> = blocks(&self.data)?.into_iter().zip(ends).map(received).collect();
        let mode = match self.mode.as_str() {
            "pa" => Mode::Only(Use::PrecisionApproach),
            "npa" => Mode::Only(Use::EnRoute),
            _ => Mode::Best,
        };
        let airborne = Airborne::new(self.noise_m, self.divergence_m).map_err(|e| input_error(e, None))?;
        let obedience = if self.test_signal { Obedience::UseTestSignal } else { Obedience::Obey };
        Ok((Feed::new(&messages), Settings { mode, mask: Radians::new(self.mask_rad), airborne, obedience }))
    }
}

impl Places<'_> {
    fn requests(&self) -> PyResult<Vec<Request>> {
        let places = self.lat_rad.as_slice()?.iter().zip(self.lon_rad.as_slice()?).zip(self.h_m.as_slice()?);
        self.time_ns.as_slice()?.iter().zip(places).enumerate().map(|(i, (t, place))| request(i, *t, place)).collect()
    }
}

fn request(index: usize, time_ns: i64, ((lat, lon), h): ((&f64, &f64), &f64)) -> PyResult<Request> {
    let point = LatLon::new(Radians::new(*lat), Radians::new(*lon)).map_err(|e| input_error(e, Some(index)))?;
    Ok(Request { time: GpsTime::from_nanoseconds(time_ns), place: Geodetic { point, height: Metres::new(*h) } })
}

/// Levels: hpl_m, vpl_m, n_sv, mode (0 none, 1 precision approach, 2 en route), reason (0 or 1 + index of reasons), reasons.
#[pyfunction]
fn sbas_levels<'py>(py: Python<'py>, service: Service<'py>, places: Places<'py>) -> PyResult<Bound<'py, PyDict>> {
    let ((feed, settings), requests) = (service.heard()?, places.requests()?);
    let records = &service.navigation.get().records;
    let answers = py.detach(|| sbas::levels(&feed, records, &requests, &settings)).map_err(|(index, e)| input_error(e, Some(index)))?;
    let d = answers_columns(py, &answers)?;
    d.set_item("ignored", ignored(py, &feed, &settings))?;
    Ok(d)
}

/// PRNs whose UDRE indicator is in force at instants in the order of time: in precision approach, and en route.
#[pyfunction]
fn sbas_indicators<'py>(
    py: Python<'py>,
    message_time_ns: PyReadonlyArray1<'py, i64>,
    data: PyReadonlyArray2<'py, u8>,
    time_ns: PyReadonlyArray1<'py, i64>,
) -> PyResult<[Vec<Vec<u8>>; 2]> {
    let ends = message_time_ns.as_slice()?;
    let received = |(block, end): (Block, &i64)| Received { end: GpsTime::from_nanoseconds(*end), prn: 0, block };
    let feed = Feed::new(&blocks(&data)?.into_iter().zip(ends).map(received).collect::<Vec<_>>());
    let at: Vec<GpsTime> = time_ns.as_slice()?.iter().map(|t| GpsTime::from_nanoseconds(*t)).collect();
    let of = |used_for| sbas::indicators(&feed, used_for, Obedience::Obey, &at);
    Ok(py.detach(|| [Use::PrecisionApproach, Use::EnRoute].map(of)))
}

/// Messages that changed nothing: time, why.
pub fn ignored(py: Python<'_>, feed: &Feed, settings: &Settings) -> Vec<(i64, String)> {
    let dropped = py.detach(|| sbas::ignored(feed, settings.obedience));
    dropped.into_iter().map(|(t, why)| (t.nanoseconds(), why.to_string())).collect()
}

/// What a level is good for: 0 none, 1 precision approach, 2 en route.
pub const fn mode_code(used_for: Option<Use>) -> u8 {
    match used_for {
        None => 0,
        Some(Use::PrecisionApproach) => 1,
        Some(Use::EnRoute) => 2,
    }
}

fn answers_columns<'py>(py: Python<'py>, answers: &[Answer]) -> PyResult<Bound<'py, PyDict>> {
    let mut reasons: Vec<String> = Vec::new();
    let mut ids = Vec::new();
    let mut reason = Vec::with_capacity(answers.len());
    for answer in answers {
        reason.push(answer.reason.map_or(0, |why| {
            let words = why.to_string();
            let at = reasons.iter().position(|known| *known == words).unwrap_or_else(|| {
                reasons.push(words);
                ids.push(why.reason().id());
                reasons.len() - 1
            });
            u32::try_from(at + 1).unwrap_or(u32::MAX)
        }));
    }
    let mode = |a: &Answer| mode_code(a.used_for);
    let d = PyDict::new(py);
    d.set_item("hpl_m", answers.iter().map(|a| a.hpl_m).collect::<Vec<_>>().into_pyarray(py))?;
    d.set_item("vpl_m", answers.iter().map(|a| a.vpl_m).collect::<Vec<_>>().into_pyarray(py))?;
    d.set_item("n_sv", answers.iter().map(|a| a.n_sv as i64).collect::<Vec<_>>().into_pyarray(py))?;
    d.set_item("mode", answers.iter().map(mode).collect::<Vec<_>>().into_pyarray(py))?;
    d.set_item("reason", reason.into_pyarray(py))?;
    d.set_item("reason_ids", ids)?;
    d.set_item("reasons", reasons)?;
    Ok(d)
}

/// The satellites of every solution, one row each: index of the request, and the parts of its range's error.
#[pyfunction]
fn sbas_satellites<'py>(py: Python<'py>, service: Service<'py>, places: Places<'py>) -> PyResult<Bound<'py, PyDict>> {
    let ((feed, settings), requests) = (service.heard()?, places.requests()?);
    let records = &service.navigation.get().records;
    let skies = py.detach(|| sbas::satellites(&feed, records, &requests, &settings)).map_err(|(index, e)| input_error(e, Some(index)))?;
    let rows: Vec<_> = skies.iter().enumerate().flat_map(|(i, sky)| sky.iter().map(move |s| (i as i64, s))).collect();
    let d = PyDict::new(py);
    d.set_item("epoch", rows.iter().map(|(i, _)| *i).collect::<Vec<_>>().into_pyarray(py))?;
    d.set_item("prn", rows.iter().map(|(_, s)| i64::from(s.prn)).collect::<Vec<_>>().into_pyarray(py))?;
    d.set_item("iode", rows.iter().map(|(_, s)| i64::from(s.iode)).collect::<Vec<_>>().into_pyarray(py))?;
    let column = |f: fn(&navbound_core::bound::sbas::Seen) -> f64| rows.iter().map(|(_, s)| f(s)).collect::<Vec<_>>().into_pyarray(py);
    d.set_item("az_rad", column(|s| s.azimuth().rad()))?;
    d.set_item("el_rad", column(|s| s.elevation.rad()))?;
    d.set_item("delta_udre", column(|s| s.delta_udre))?;
    d.set_item("fast_correction_m", column(|s| s.fast_m))?;
    d.set_item("clock_correction_s", column(|s| s.clock_s))?;
    d.set_item("iono_vertical_m", column(|s| s.vertical.delay_m))?;
    d.set_item("from_grid", rows.iter().map(|(_, s)| s.from_grid).collect::<Vec<_>>().into_pyarray(py))?;
    d.set_item("sigma_flt_m", column(|s| sbas::sigmas_m(&s.error)[0]))?;
    d.set_item("sigma_uire_m", column(|s| sbas::sigmas_m(&s.error)[1]))?;
    d.set_item("sigma_tropo_m", column(|s| sbas::sigmas_m(&s.error)[2]))?;
    d.set_item("sigma_air_m", column(|s| sbas::sigmas_m(&s.error)[3]))?;
    d.set_item("sigma_m", column(|s| sbas::sigmas_m(&s.error)[4]))?;
    Ok(d)
}

/// HPL and VPL of covariances (n, 6) as ee, en, nn, eu, nu, uu, by the multipliers of precision approach; NaN where one is not a covariance.
#[pyfunction]
fn sbas_covariance_levels<'py>(py: Python<'py>, cov_m2: PyReadonlyArray2<'py, f64>) -> PyResult<Bound<'py, PyDict>> {
    let of = |&[ee, en, nn, eu, nu, uu]: &[f64; 6]| {
        Covariance::<Enu>::from_rows([ee, en, eu, en, nn, nu, eu, nu, uu]).ok().map(|c| sbas::of_covariance(&c))
    };
    let levels: Vec<_> = cov_m2.as_slice()?.as_chunks::<6>().0.iter().map(of).collect();
    let d = PyDict::new(py);
    for (axis, name) in ["hpl_m", "vpl_m"].into_iter().enumerate() {
        d.set_item(name, levels.iter().map(|l| l.map_or(f64::NAN, |l| l[axis])).collect::<Vec<_>>().into_pyarray(py))?;
    }
    Ok(d)
}

/// Levels from terms; a row of `terms` holds the 24 numbers of one range in the order of `RangeTerms`.
#[pyfunction]
fn sbas_from_terms<'py>(py: Python<'py>, terms: PyReadonlyArray2<'py, f64>) -> PyResult<Bound<'py, PyDict>> {
    let (rows, rest) = terms.as_slice()?.as_chunks::<TERMS>();
    if !rest.is_empty() {
        return Err(PyValueError::new_err(format!("{} columns, not {TERMS}", terms.as_array().ncols())));
    }
    let terms: PyResult<Vec<_>> = rows.iter().enumerate().map(|(i, row)| range_terms(i, row)).collect();
    let levels = sbas::from_terms(&terms?).map_err(|refused| match refused {
        TermsRefused::Term(index, e) => input_error(e, Some(index)),
        TermsRefused::Geometry(why) => PyValueError::new_err(why.to_string()),
    })?;
    terms_columns(py, &levels)
}

const TERMS: usize = 24;

fn range_terms(index: usize, row: &[f64; TERMS]) -> PyResult<RangeTerms> {
    let [
        az,
        el,
        udrei,
        delta_udre,
        a,
        age,
        latency,
        rrc,
        ltc,
        er,
        rss_udre,
        x,
        y,
        g1,
        g2,
        g3,
        g4,
        step,
        interval,
        ramp,
        grid_age,
        rss_iono,
        noise,
        divergence,
    ] = *row;
    let indicator = |argument, value: f64| {
        let whole = value as u8;
        if f64::from(whole) == value {
            Ok(whole)
        } else {
            Err(input_error(OutOfDomain { argument, value, unit: "1", domain: "whole numbers 0 to 15" }, Some(index)))
        }
    };
    Ok(RangeTerms {
        azimuth: Radians::new(az),
        elevation: Radians::new(el),
        udrei: indicator("udrei", udrei)?,
        delta_udre,
        fast: [a, age, latency],
        degradation_m: [rrc, ltc, er],
        rss_udre: rss_udre != 0.0,
        cell: [x, y],
        givei: [indicator("givei", g1)?, indicator("givei", g2)?, indicator("givei", g3)?, indicator("givei", g4)?],
        grid: [step, interval, ramp, grid_age],
        rss_iono: rss_iono != 0.0,
        airborne: Airborne::new(noise, divergence).map_err(|e| input_error(e, Some(index)))?,
    })
}

fn terms_columns<'py>(py: Python<'py>, levels: &FromTerms) -> PyResult<Bound<'py, PyDict>> {
    let column =
        |f: fn(&navbound_core::bound::sbas::terms::RangeSigmas) -> f64| levels.ranges.iter().map(f).collect::<Vec<_>>().into_pyarray(py);
    let d = PyDict::new(py);
    d.set_item("e_fc_m", column(|r| r.fast_degradation_m))?;
    d.set_item("e_iono_m", column(|r| r.grid_degradation_m))?;
    d.set_item("sigma_flt_m", column(|r| sbas::sigmas_m(&r.error)[0]))?;
    d.set_item("sigma_uive_m", column(|r| r.vertical_m))?;
    d.set_item("obliquity", column(|r| r.obliquity))?;
    d.set_item("sigma_uire_m", column(|r| sbas::sigmas_m(&r.error)[1]))?;
    d.set_item("sigma_tropo_m", column(|r| sbas::sigmas_m(&r.error)[2]))?;
    d.set_item("sigma_air_m", column(|r| sbas::sigmas_m(&r.error)[3]))?;
    d.set_item("sigma_m", column(|r| sbas::sigmas_m(&r.error)[4]))?;
    let v = levels.covariance.matrix();
    d.set_item("cov_ee_m2", v[(0, 0)])?;
    d.set_item("cov_en_m2", v[(0, 1)])?;
    d.set_item("cov_nn_m2", v[(1, 1)])?;
    d.set_item("cov_uu_m2", v[(2, 2)])?;
    d.set_item("d_major_m", levels.d_major.m())?;
    fields!(d, levels: hdop, vdop);
    d.set_item("hpl_pa_m", levels.approach.hpl.m())?;
    d.set_item("hpl_npa_m", levels.en_route.hpl.m())?;
    d.set_item("vpl_m", levels.approach.vpl.map_or(f64::NAN, Metres::m))?;
    Ok(d)
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(sbas_read, m)?)?;
    m.add_function(wrap_pyfunction!(sbas_decode, m)?)?;
    m.add_function(wrap_pyfunction!(sbas_indicators, m)?)?;
    m.add_function(wrap_pyfunction!(sbas_levels, m)?)?;
    m.add_function(wrap_pyfunction!(sbas_satellites, m)?)?;
    m.add_function(wrap_pyfunction!(sbas_covariance_levels, m)?)?;
    m.add_function(wrap_pyfunction!(sbas_from_terms, m)?)
}
