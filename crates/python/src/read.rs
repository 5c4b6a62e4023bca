//! Readers, and what recorded positions are checked for.

use crate::error::{format_error, input_error};
use navbound_assess::error::navigation_errors;
use navbound_assess::plausible::{Finding, Limits, Report, SPEEDS_BESIDE, Survey, Track};
use navbound_core::monitor::balance::{At, Balance};
use navbound_core::monitor::drift::{self, Sums};
use navbound_core::monitor::neighbours::{self, Apart, Place};
use navbound_core::monitor::no_speed;
use navbound_core::monitor::way::TURNING_MPS2;
use navbound_core::quantity::{GpsTime, OutOfDomain};
use navbound_formats::packed::{Limit, unpack_within};
use navbound_formats::{measured, place, rtklib, time};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use std::borrow::Cow;

/// Columns of an RTKLIB solution file, and the rows not used as (line, field, reason, text).
#[pyfunction]
fn read_rtklib<'py>(py: Python<'py>, text: &str, path: &str) -> PyResult<Bound<'py, PyDict>> {
    let s = py.detach(|| rtklib::read(text)).map_err(|e| format_error(path, &e))?;
    let d = PyDict::new(py);
    let time_ns: Vec<i64> = s.time.iter().map(|t| t.nanoseconds()).collect();
    let line: Vec<i64> = s.line.iter().map(|l| i64::try_from(*l).unwrap_or(i64::MAX)).collect();
    d.set_item("line", line.into_pyarray(py))?;
    d.set_item("time_ns", time_ns.into_pyarray(py))?;
    d.set_item("est_lat_rad", s.lat_rad.into_pyarray(py))?;
    d.set_item("est_lon_rad", s.lon_rad.into_pyarray(py))?;
    d.set_item("est_h_m", s.h_m.into_pyarray(py))?;
    d.set_item("cov_m2", rows(py, &s.cov_m2)?)?;
    d.set_item("states_quality", s.states_quality)?;
    d.set_item("quality", s.quality.into_pyarray(py))?;
    d.set_item("n_sv", s.n_sv.into_pyarray(py))?;
    d.set_item("ground_speed_mps", s.ground_speed_mps.into_pyarray(py))?;
    d.set_item("hpl_m", s.hpl_m.into_pyarray(py))?;
    d.set_item("vpl_m", s.vpl_m.into_pyarray(py))?;
    d.set_item("n_rows", s.n_rows)?;
    let refused: Vec<_> = s.refused.into_iter().map(|r| (r.line, r.field, r.reason, r.text)).collect();
    d.set_item("refused", refused)?;
    Ok(d)
}

/// The plain bytes of a packed file, at most so many in all and per packed byte; None of one that is plain.
#[pyfunction]
fn unpack<'py>(py: Python<'py>, content: &[u8], path: &str, total: u64, ratio: u64) -> PyResult<Option<Bound<'py, PyBytes>>> {
    match py.detach(|| unpack_within(content, Limit { total, ratio })).map_err(|e| format_error(path, &e))? {
        Cow::Borrowed(_) => Ok(None),
        Cow::Owned(plain) => Ok(Some(PyBytes::new(py, &plain))),
    }
}

/// GPS time [ns] of Unix times [ns].
#[pyfunction]
fn gps_from_unix_ns<'py>(py: Python<'py>, unix_ns: PyReadonlyArray1<'py, i64>) -> PyResult<Bound<'py, PyArray1<i64>>> {
    let times: Vec<i64> = unix_ns.as_slice()?.iter().map(|t| time::from_unix(*t).nanoseconds()).collect();
    Ok(times.into_pyarray(py))
}

type TimesAndWhether<'py> = (Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<bool>>);

/// GPS time [ns] of the leap second that follows each Unix time [ns], and whether there is one; 0 where there is none.
#[pyfunction]
fn gps_of_leap_second_ns<'py>(py: Python<'py>, unix_ns: PyReadonlyArray1<'py, i64>) -> PyResult<TimesAndWhether<'py>> {
    let leap: Vec<_> = unix_ns.as_slice()?.iter().map(|t| time::leap_second_after(*t)).collect();
    let times: Vec<i64> = leap.iter().map(|t| t.map_or(0, GpsTime::nanoseconds)).collect();
    let exists: Vec<bool> = leap.iter().map(Option::is_some).collect();
    Ok((times.into_pyarray(py), exists.into_pyarray(py)))
}

/// Unix time [ns] of GPS times [ns].
#[pyfunction]
fn unix_from_gps_ns<'py>(py: Python<'py>, time_ns: PyReadonlyArray1<'py, i64>) -> PyResult<Bound<'py, PyArray1<i64>>> {
    let times: Vec<i64> = time_ns.as_slice()?.iter().map(|t| time::to_unix(GpsTime::from_nanoseconds(*t))).collect();
    Ok(times.into_pyarray(py))
}

/// GPS time [ns] of GPS weeks (since 1980) and times of week [ns].
#[pyfunction]
fn gps_from_week_ns<'py>(
    py: Python<'py>,
    week: PyReadonlyArray1<'py, i64>,
    time_of_week_ns: PyReadonlyArray1<'py, i64>,
) -> PyResult<Bound<'py, PyArray1<i64>>> {
    let pairs = week.as_slice()?.iter().zip(time_of_week_ns.as_slice()?);
    let beyond = |week: i64| OutOfDomain { argument: "week", value: week as f64, unit: "week", domain: "64 bits of nanoseconds" };
    let times: Result<Vec<i64>, PyErr> = pairs
        .enumerate()
        .map(|(i, (w, tow))| time::from_week(*w, *tow).map(|t| t.nanoseconds()).ok_or_else(|| input_error(beyond(*w), Some(i))))
        .collect();
    Ok(times?.into_pyarray(py))
}

/// Positions as the text of an RTKLIB solution file; covariances as [ee, en, nn, eu, nu, uu].
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "one array a column")]
fn write_rtklib<'py>(
    py: Python<'py>,
    program: &str,
    time_ns: PyReadonlyArray1<'py, i64>,
    lat_rad: PyReadonlyArray1<'py, f64>,
    lon_rad: PyReadonlyArray1<'py, f64>,
    h_m: PyReadonlyArray1<'py, f64>,
    cov_m2: PyReadonlyArray2<'py, f64>,
    n_sv: PyReadonlyArray1<'py, u32>,
    quality: u8,
) -> PyResult<String> {
    let time = time_ns.as_slice()?.iter().map(|t| GpsTime::from_nanoseconds(*t)).collect();
    let n = time_ns.as_slice()?.len();
    let solutions = rtklib::Solutions {
        time,
        lat_rad: lat_rad.as_slice()?.to_vec(),
        lon_rad: lon_rad.as_slice()?.to_vec(),
        h_m: h_m.as_slice()?.to_vec(),
        cov_m2: cov_m2.as_slice()?.as_chunks::<6>().0.to_vec(),
        n_sv: n_sv.as_slice()?.to_vec(),
        quality: vec![quality; n],
        ..rtklib::Solutions::default()
    };
    py.detach(|| rtklib::write(&solutions, program)).map_err(|(index, e)| input_error(e, Some(index)))
}

/// Navigation error (n, 3) [m], true minus estimated, east, north, up, of positions (n, 3): latitude, longitude [rad], height [m].
#[pyfunction]
fn navigation_error<'py>(
    py: Python<'py>,
    estimate: PyReadonlyArray2<'py, f64>,
    truth: PyReadonlyArray2<'py, f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let (estimate, truth) = (triples(&estimate)?, triples(&truth)?);
    let errors = py.detach(|| navigation_errors(estimate, truth)).map_err(|(index, e)| input_error(e, Some(index)))?;
    rows(py, &errors)
}

pub fn limits_of(limits: &Bound<'_, PyDict>) -> PyResult<Limits> {
    let limit = |name: &'static str| -> PyResult<f64> {
        let value: f64 = limits.as_any().get_item(name)?.extract()?;
        if !(value >= 0.0) {
            return Err(input_error(OutOfDomain { argument: name, value, unit: "SI", domain: "[0, inf]" }, None));
        }
        Ok(value)
    };
    Ok(Limits {
        max_speed_mps: limit("max_speed_mps")?,
        speed_factor: limit("speed_factor")?,
        speed_margin_mps: limit("speed_margin_mps")?,
        latency_s: limit("latency_s")?,
        fix_latency_s: limit("fix_latency_s")?,
        noise_m: limit("noise_m")?,
        moving_mps: limit("moving_mps")?,
        stale_after_s: limit("stale_after_s")?,
        settle_s: limit("settle_s")?,
        // A recording declares no period; its own is judged by its times.
        period_s: 0.0,
    })
}

/// Columns of reports: time, when the position was valid (the least number where nothing says so), latitude, longitude, speed.
type Reports<'py> = (
    PyReadonlyArray1<'py, i64>,
    PyReadonlyArray1<'py, i64>,
    PyReadonlyArray1<'py, f64>,
    PyReadonlyArray1<'py, f64>,
    PyReadonlyArray1<'py, f64>,
);

fn reports_of((time_ns, fixed_ns, lat_rad, lon_rad, speed): &Reports<'_>) -> PyResult<Vec<Report>> {
    let (t, lat, lon, speed) = (time_ns.as_slice()?, lat_rad.as_slice()?, lon_rad.as_slice()?, speed.as_slice()?);
    let rows = t.iter().zip(lat).zip(lon).zip(speed).zip(fixed_ns.as_slice()?);
    Ok(rows
        .map(|((((t, lat), lon), speed), fixed)| Report {
            time: GpsTime::from_nanoseconds(*t),
            fixed: (*fixed != i64::MIN).then(|| GpsTime::from_nanoseconds(*fixed)),
            lat_rad: *lat,
            lon_rad: *lon,
            speed_mps: *speed,
            // A recording's accuracy is judged elsewhere.
            variance_m2: f64::NAN,
            // Rows of one time are judged before.
            height: None,
        })
        .collect())
}

/// The judge of one track, which sees all its reports and then judges them, both in pieces of any length.
#[pyclass(module = "navbound._core")]
struct PlausibleTrack {
    limits: Limits,
    survey: Survey,
    track: Option<Track>,
}

#[pymethods]
impl PlausibleTrack {
    #[new]
    fn new(limits: &Bound<'_, PyDict>, reports_speed: bool) -> PyResult<Self> {
        let survey = if reports_speed { Survey::of_reported_speed() } else { Survey::default() };
        Ok(Self { limits: limits_of(limits)?, survey, track: None })
    }

    fn see(&mut self, reports: Reports<'_>) -> PyResult<()> {
        self.survey.see(&reports_of(&reports)?).map_err(|(index, e)| input_error(e, Some(index)))
    }

    /// Finding (0 plausible, 1 held, 2 stale, 3 jump, 4 unsettled, 5 late, 6 ahead), step [m], speed of a step that is too fast [m/s].
    /// Whether the reported speed was not believed. `after` are times \[ns\] and speeds of the reports after these, as many as [`SPEEDS_BESIDE`].
    fn judge<'py>(&mut self, py: Python<'py>, reports: Reports<'py>, after: Vec<(i64, f64)>) -> PyResult<Bound<'py, PyDict>> {
        let after: Vec<_> = after.into_iter().map(|(time_ns, speed_mps)| (GpsTime::from_nanoseconds(time_ns), speed_mps)).collect();
        let track = self.track.get_or_insert_with(|| Track::new(std::mem::take(&mut self.survey), &self.limits));
        let judged = track.judge(&reports_of(&reports)?, &after).map_err(|(index, e)| input_error(e, Some(index)))?;
        let code = |finding| match finding {
            Finding::Plausible => 0_u8,
            Finding::Repeated => 1,
            Finding::Stale => 2,
            Finding::Jump => 3,
            Finding::Unsettled => 4,
            Finding::Late => 5,
            Finding::Ahead => 6,
        };
        let d = PyDict::new(py);
        d.set_item("finding", judged.iter().map(|j| code(j.finding)).collect::<Vec<_>>().into_pyarray(py))?;
        d.set_item("step_m", judged.iter().map(|j| j.step_m).collect::<Vec<_>>().into_pyarray(py))?;
        d.set_item("too_fast_mps", judged.iter().map(|j| j.too_fast_mps).collect::<Vec<_>>().into_pyarray(py))?;
        d.set_item("speed_doubted", judged.iter().map(|j| j.speed_doubted).collect::<Vec<_>>().into_pyarray(py))?;
        Ok(d)
    }
}

/// Of every three successive positions of one track how far the middle one stands from the line between the others [m], and the risk of as much by
/// the covariances; NaN where they are not of one track, or time does not go on.
#[pyfunction]
fn neighbours_apart<'py>(
    py: Python<'py>,
    track: PyReadonlyArray1<'py, i64>,
    time_ns: PyReadonlyArray1<'py, i64>,
    lat_rad: PyReadonlyArray1<'py, f64>,
    lon_rad: PyReadonlyArray1<'py, f64>,
    variance_m2: PyReadonlyArray1<'py, f64>,
    stale_after_s: f64,
) -> PyResult<Columns<'py>> {
    let (track, time_ns) = (track.as_slice()?, time_ns.as_slice()?);
    let (lat_rad, lon_rad, variance_m2) = (lat_rad.as_slice()?, lon_rad.as_slice()?, variance_m2.as_slice()?);
    let place = |k: usize| Place {
        time: GpsTime::from_nanoseconds(time_ns[k]),
        lat_rad: lat_rad[k],
        lon_rad: lon_rad[k],
        variance_m2: variance_m2[k],
    };
    let (away_m, risk) = (2..track.len())
        .map(|k| {
            let of_one = track[k - 2] == track[k];
            let apart = Apart::of([&place(k - 2), &place(k - 1), &place(k)], stale_after_s).filter(|_| of_one);
            apart.map_or((f64::NAN, f64::NAN), |apart| (apart.away_m, apart.risk()))
        })
        .unzip::<_, _, Vec<_>, Vec<_>>();
    Ok((away_m.into_pyarray(py), risk.into_pyarray(py)))
}

type Columns<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>);

fn triples<'a>(array: &'a PyReadonlyArray2<'_, f64>) -> PyResult<&'a [[f64; 3]]> {
    let (rows, rest) = array.as_slice()?.as_chunks::<3>();
    if !rest.is_empty() || array.as_array().ncols() != 3 {
        let value = array.as_array().ncols() as f64;
        return Err(input_error(OutOfDomain { argument: "positions", value, unit: "columns", domain: "3 columns" }, None));
    }
    Ok(rows)
}

/// The ways of tracks, of the positions and by their speeds, for as long as a recording lasts.
#[pyclass(module = "navbound._core")]
#[derive(Default)]
struct TrackBalance(Balance);

#[pymethods]
impl TrackBalance {
    #[new]
    fn new() -> Self {
        Self::default()
    }

    /// The next rows of the track, in the order of time; NaN where no speed is stated.
    fn see(
        &mut self,
        time_ns: PyReadonlyArray1<'_, i64>,
        lat_rad: PyReadonlyArray1<'_, f64>,
        lon_rad: PyReadonlyArray1<'_, f64>,
        speed_mps: PyReadonlyArray1<'_, f64>,
    ) -> PyResult<()> {
        let rows = time_ns.as_slice()?.iter().zip(lat_rad.as_slice()?).zip(lon_rad.as_slice()?).zip(speed_mps.as_slice()?);
        for (((time_ns, lat_rad), lon_rad), speed_mps) in rows {
            self.0.see(At { time_ns: *time_ns, lat_rad: *lat_rad, lon_rad: *lon_rad, speed_mps: *speed_mps });
        }
        Ok(())
    }

    /// By how much the positions are behind where that is more than they may be, and the way by the speeds [m].
    fn behind_m(&self) -> Option<(f64, f64)> {
        self.0.behind_m().map(|lack_m| (lack_m, self.0.ways_m[1]))
    }
}

/// How far a track drifts aside of where its reported courses lead, by straight minutes of a recording.
#[pyclass(module = "navbound._core")]
#[derive(Default)]
struct TrackDrift(Sums);

#[pymethods]
impl TrackDrift {
    #[new]
    fn new() -> Self {
        Self::default()
    }

    /// Courses of the track; NaN is none.
    fn see_courses(&mut self, track_rad: PyReadonlyArray1<'_, f64>) -> PyResult<()> {
        track_rad.as_slice()?.iter().for_each(|course| self.0.course(*course));
        Ok(())
    }

    /// The next minutes, in the order of time: how far the positions went to the right, the way by the speeds, the length and the noise.
    fn see_minutes(
        &mut self,
        aside_m: PyReadonlyArray1<'_, f64>,
        way_m: PyReadonlyArray1<'_, f64>,
        length_s: PyReadonlyArray1<'_, f64>,
        noise_m: PyReadonlyArray1<'_, f64>,
    ) -> PyResult<()> {
        let minutes = aside_m.as_slice()?.iter().zip(way_m.as_slice()?).zip(length_s.as_slice()?).zip(noise_m.as_slice()?);
        minutes.for_each(|(((aside_m, way_m), length_s), noise_m)| self.0.minute(*aside_m, *way_m, *length_s, *noise_m));
        Ok(())
    }

    /// The worst drift that is more than positions may have: beyond that, aside and the way [m], in so many minutes.
    fn drifted(&self) -> Option<(f64, f64, f64, u32)> {
        self.0.drifted().map(|worst| (worst.over_m, worst.aside_m, worst.way_m, worst.n))
    }
}

/// Which numbers are no speed over the ground, in a unit [m/s].
#[pyfunction]
fn no_speeds<'py>(py: Python<'py>, written: PyReadonlyArray1<'py, f64>, unit_mps: f64) -> PyResult<Bound<'py, PyArray1<bool>>> {
    let none: Vec<bool> = written.as_slice()?.iter().map(|each| no_speed::is_no_speed(*each, unit_mps)).collect();
    Ok(none.into_pyarray(py))
}

/// Places as they are written: two numbers [deg], whether the first is the latitude, and whether the form says that it is a place.
type PlaceRow = Option<([f64; 2], bool, bool)>;

/// The places that texts are; those of geohashes where a name says so.
#[pyfunction]
fn places_of(texts: Vec<Option<String>>, geohash: bool) -> Vec<PlaceRow> {
    let written = |text: &String| if geohash { place::of_geohash(text) } else { place::of_text(text) };
    let of = |text: &String| written(text).map(|written| (written.deg, written.ordered, written.by_itself));
    texts.iter().map(|text| text.as_ref().and_then(of)).collect()
}

fn rows<'py, const N: usize>(py: Python<'py>, rows: &[[f64; N]]) -> PyResult<Bound<'py, PyArray2<f64>>> {
    use numpy::PyArrayMethods;
    rows.as_flattened().to_vec().into_pyarray(py).reshape([rows.len(), N])
}

/// A list of numbers: of bytes Python would make a text of bytes.
fn numbers(bytes: &[u8]) -> Vec<u32> {
    bytes.iter().map(|byte| u32::from(*byte)).collect()
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(unpack, m)?)?;
    m.add_function(wrap_pyfunction!(read_rtklib, m)?)?;
    m.add_function(wrap_pyfunction!(write_rtklib, m)?)?;
    m.add_function(wrap_pyfunction!(gps_from_unix_ns, m)?)?;
    m.add_function(wrap_pyfunction!(gps_of_leap_second_ns, m)?)?;
    m.add_function(wrap_pyfunction!(gps_from_week_ns, m)?)?;
    m.add_function(wrap_pyfunction!(unix_from_gps_ns, m)?)?;
    m.add_function(wrap_pyfunction!(navigation_error, m)?)?;
    m.add("SPEEDS_BESIDE", SPEEDS_BESIDE)?;
    m.add("TURNING_MPS2", TURNING_MPS2)?;
    m.add("GGA_QUALITIES", numbers(measured::GGA_QUALITIES))?;
    m.add_function(wrap_pyfunction!(neighbours_apart, m)?)?;
    m.add("NEIGHBOUR_RISK", neighbours::RISK)?;
    m.add("DETERMINING_SATELLITES", measured::DETERMINING_SATELLITES)?;
    m.add("MOST_DILUTION", navbound_core::solution::plausible::DILUTION)?;
    m.add("RTKLIB_QUALITIES", numbers(measured::RTKLIB_QUALITIES))?;
    m.add("FASTEST_MPS", no_speed::FASTEST_MPS)?;
    m.add("NO_SPEED_BELOW_ANY", no_speed::BELOW_ANY)?;
    m.add_function(wrap_pyfunction!(no_speeds, m)?)?;
    m.add_function(wrap_pyfunction!(places_of, m)?)?;
    m.add_class::<TrackBalance>()?;
    m.add_class::<TrackDrift>()?;
    m.add("DRIFT_STRAIGHT", drift::STRAIGHT)?;
    m.add("DRIFT_DEVIATIONS", drift::DEVIATIONS)?;
    m.add_class::<PlausibleTrack>()
}
