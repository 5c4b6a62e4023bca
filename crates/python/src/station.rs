//! A receiver that stands: its measurements and records, and any observations and records as text and bytes of their formats.

use crate::error::input_error;
use crate::orbits::satellite_id;
use crate::receiver_files::{Navigation, Observations};
use navbound_core::frame::{Geodetic, LatLon};
use navbound_core::geometry::{GALILEO, GPS, Slot};
use navbound_core::quantity::{GpsTime, Metres, OutOfDomain, Radians};
use navbound_core::signal::Constellation;
use navbound_formats::{receiver, rinex};
use navbound_simulate::{Heard, IONOSPHERE, RawStation, WrongRange, broadcast, hear};
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

/// GPS time minus UTC since 2017 \[s\]; IERS bulletin C 52.
const LEAP_SECONDS: i64 = 18;

/// A satellite, from and until \[s\], step \[m\], ramp \[m/s\].
type Wrong = (String, [f64; 2], f64, f64);

#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct Settings {
    lat_rad: f64,
    lon_rad: f64,
    h_m: f64,
    begin_ns: i64,
    step_s: f64,
    n_epochs: usize,
    seed: u64,
    mask_rad: f64,
    outages_s: Vec<[f64; 2]>,
    wrong: Vec<Wrong>,
    galileo: bool,
}

fn refused(e: OutOfDomain) -> PyErr {
    input_error(e, None)
}

impl Settings {
    fn station(&self) -> PyResult<RawStation> {
        let point = LatLon::new(Radians::new(self.lat_rad), Radians::new(self.lon_rad)).map_err(refused)?;
        let mut wrong = Vec::new();
        for (name, during_s, step_m, ramp_mps) in &self.wrong {
            let none = || OutOfDomain { argument: "satellite", value: f64::NAN, unit: "", domain: "a name such as G05" };
            let satellite = satellite_id(name).ok_or_else(|| refused(none()))?;
            wrong.push(WrongRange { satellite, during_s: *during_s, step_m: *step_m, ramp_mps: *ramp_mps });
        }
        Ok(RawStation {
            place: Geodetic { point, height: Metres::new(self.h_m) },
            begin: GpsTime::from_nanoseconds(self.begin_ns),
            step_s: self.step_s,
            n_epochs: self.n_epochs,
            seed: self.seed,
            mask: Radians::new(self.mask_rad),
            outages_s: self.outages_s.clone(),
            wrong,
        })
    }
}

/// Codes of a constellation: L1 C/A and L2C, E1 and E5a, in the order in which [`values`] gives them.
fn codes(second: [u8; 2]) -> Vec<rinex::Code> {
    [*b"1C", second].iter().flat_map(|[band, attribute]| b"CLDS".map(|kind| [kind, *band, *attribute])).collect()
}

fn values(heard: &Heard) -> Vec<(f64, u8)> {
    let four = heard.signals.iter().map(|s| [(s.range_m, 0), (s.phase_cycles, u8::from(s.lost) << 4), (s.doppler_hz, 0), (s.cn0_dbhz, 0)]);
    four.flatten().collect()
}

/// Measurements of a station, the records beside them, and the clock of each epoch \[m\].
type Simulated<'py> = (Observations, Navigation, Bound<'py, PyArray1<f64>>);

#[pyfunction]
fn simulate_station<'py>(py: Python<'py>, settings: Settings, name: &str) -> PyResult<Simulated<'py>> {
    let station = settings.station()?;
    let mut slots: Vec<Slot> = GPS.to_vec();
    slots.extend(settings.galileo.then_some(GALILEO).into_iter().flatten());
    let records = broadcast(&slots, station.begin, station.step_s * station.n_epochs as f64, station.seed);
    let epochs = py.detach(|| hear(&station, &records)).map_err(refused)?;
    let mut o = rinex::Observations::default();
    (o.version, o.marker, o.interval_s) = (3.05, name.to_owned(), Some(station.step_s));
    let ecef = navbound_core::frame::ecef_from_geodetic(&station.place);
    o.approximate_m = Some((*ecef.vector()).into());
    o.codes[Constellation::Gps.index()] = codes(*b"2L");
    if settings.galileo {
        o.codes[Constellation::Galileo.index()] = codes(*b"5Q");
    }
    for epoch in &epochs {
        let seen: Vec<_> = epoch.heard.iter().map(|h| (h.satellite, values(h))).collect();
        o.add_epoch(epoch.time, &seen).map_err(refused)?;
    }
    let navigation = rinex::Navigation {
        ephemerides: records,
        klobuchar_gps: Some(IONOSPHERE),
        leap_seconds: Some(LEAP_SECONDS),
        ..rinex::Navigation::default()
    };
    let clock_m: Vec<f64> = epochs.iter().map(|e| e.clock_m).collect();
    Ok((Observations(o), Navigation { records: navigation, refused: Vec::new() }, clock_m.into_pyarray(py)))
}

/// Observations as the text of RINEX 3.05.
#[pyfunction]
fn write_observations(py: Python<'_>, observations: &Observations, program: &str) -> PyResult<String> {
    py.detach(|| rinex::observation_file(&observations.0, program)).map_err(refused)
}

/// Broadcast records as the text of RINEX 3.05.
#[pyfunction]
fn write_navigation(py: Python<'_>, navigation: &Navigation, program: &str) -> PyResult<String> {
    py.detach(|| rinex::navigation_file(&navigation.records, program)).map_err(refused)
}

/// Observations as u-blox RXM-RAWX frames, and how many signals u-blox has no name for.
#[pyfunction]
fn write_rawx<'py>(py: Python<'py>, observations: &Observations) -> PyResult<(Bound<'py, PyBytes>, usize)> {
    let leap = i8::try_from(LEAP_SECONDS).unwrap_or(i8::MAX);
    let (log, left_out) = py.detach(|| receiver::rawx_log(&observations.0, leap)).map_err(refused)?;
    Ok((PyBytes::new(py, &log), left_out))
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(simulate_station, m)?)?;
    m.add_function(wrap_pyfunction!(write_observations, m)?)?;
    m.add_function(wrap_pyfunction!(write_navigation, m)?)?;
    m.add_function(wrap_pyfunction!(write_rawx, m)?)
}
