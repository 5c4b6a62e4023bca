//! Receivers' files: observations and navigation records.

use crate::error::{format_error, input_error};
use navbound_core::geometry::broadcast::mean_elements;
use navbound_core::quantity::{GpsTime, Radians};
use navbound_core::signal::{Carrier, Constellation, Ephemeris, Klobuchar};
use navbound_formats::Refusal;
use navbound_formats::packed::unpack;
use navbound_formats::receiver;
use navbound_formats::rinex::{self, Code};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::collections::BTreeMap;

/// One observation file, read.
#[pyclass(frozen, module = "navbound._core")]
pub struct Observations(pub rinex::Observations);

/// Names, seven elements a row, ages.
type Kepler<'py> = (Vec<String>, Bound<'py, PyArray2<f64>>, Vec<f64>);

/// Navigation files, read and merged.
#[pyclass(frozen, module = "navbound._core")]
pub struct Navigation {
    pub records: rinex::Navigation,
    /// Refused records with their file.
    pub refused: Vec<(String, Refusal)>,
}

impl Navigation {
    /// Keplerian records of all files.
    pub fn ephemerides(&self) -> &[navbound_core::signal::Ephemeris] {
        &self.records.ephemerides
    }
}

type Refused = Vec<(usize, String, String, String)>;

fn code_name(code: &Code) -> String {
    String::from_utf8_lossy(code).into_owned()
}

#[pymethods]
impl Observations {
    /// Read from the bytes of a file, plain or gzip; `path` for messages.
    #[new]
    fn new(py: Python<'_>, content: &[u8], path: &str) -> PyResult<Self> {
        let read = || receiver::read_observations(&unpack(content)?);
        Ok(Self(py.detach(read).map_err(|e| format_error(path, &e))?))
    }
    #[getter]
    fn version(&self) -> f64 {
        self.0.version
    }
    #[getter]
    fn marker(&self) -> &str {
        &self.0.marker
    }
    #[getter]
    fn receiver(&self) -> &str {
        &self.0.receiver
    }
    #[getter]
    fn antenna(&self) -> &str {
        &self.0.antenna
    }
    #[getter]
    fn approximate_m(&self) -> Option<[f64; 3]> {
        self.0.approximate_m
    }
    #[getter]
    fn antenna_delta_m(&self) -> [f64; 3] {
        self.0.antenna_delta_m
    }
    #[getter]
    fn interval_s(&self) -> Option<f64> {
        self.0.interval_s
    }
    #[getter]
    fn n_epochs(&self) -> usize {
        self.0.n_epochs()
    }
    #[getter]
    fn n_refused(&self) -> usize {
        self.0.n_refused
    }
    #[getter]
    fn n_lost_epochs(&self) -> usize {
        self.0.n_lost_epochs
    }
    #[getter]
    fn skipped(&self) -> BTreeMap<String, usize> {
        self.0.skipped.clone()
    }
    #[getter]
    fn refused(&self) -> Refused {
        self.0.refused.iter().map(|r| (r.line, r.field.clone(), r.reason.clone(), r.text.clone())).collect()
    }
    #[getter]
    fn codes(&self) -> BTreeMap<char, Vec<String>> {
        let named = |c: Constellation| (c.letter(), self.0.codes[c.index()].iter().map(code_name).collect());
        Constellation::ALL.into_iter().filter(|c| !self.0.codes[c.index()].is_empty()).map(named).collect()
    }
    #[getter]
    fn time_ns<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        self.0.time.iter().map(|t| t.nanoseconds()).collect::<Vec<_>>().into_pyarray(py)
    }
    /// Every value of one code: epoch, satellite, value, loss of lock, strength; None where the file lacks the code.
    fn column<'py>(&self, py: Python<'py>, system: char, code: &str) -> PyResult<Option<Bound<'py, PyDict>>> {
        let code_of_system = u8::try_from(system).ok().and_then(Constellation::from_letter).zip(Code::try_from(code.as_bytes()).ok());
        let Some((constellation, column)) = code_of_system.and_then(|(c, code)| Some((c, self.0.column(c, &code)?))) else {
            return Ok(None);
        };
        let (mut time, mut satellite, mut value, mut lock, mut strength) = (Vec::new(), Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for epoch in 0..self.0.n_epochs() {
            for k in self.0.satellites(epoch).filter(|k| self.0.satellite[*k].constellation == constellation) {
                let at = self.0.value_range(k).start + column;
                if !self.0.value[at].is_nan() {
                    time.push(self.0.time[epoch].nanoseconds());
                    satellite.push(self.0.satellite[k].to_string());
                    value.push(self.0.value[at]);
                    lock.push(self.0.indicator[at] >> 4);
                    strength.push(self.0.indicator[at] & 0xf);
                }
            }
        }
        let d = PyDict::new(py);
        d.set_item("time_ns", time.into_pyarray(py))?;
        d.set_item("satellite", satellite)?;
        d.set_item("value", value.into_pyarray(py))?;
        d.set_item("loss_of_lock", lock.into_pyarray(py))?;
        d.set_item("strength", strength.into_pyarray(py))?;
        Ok(Some(d))
    }
}

type Element = (&'static str, fn(&Ephemeris) -> f64);

/// Numbers of a Keplerian record by column.
const ELEMENTS: [Element; 22] = [
    ("accuracy_m", |e| e.accuracy_m),
    ("clock_s", |e| e.clock[0]),
    ("clock_drift", |e| e.clock[1]),
    ("clock_drift_rate_per_s", |e| e.clock[2]),
    ("sqrt_a", |e| e.sqrt_a),
    ("eccentricity", |e| e.eccentricity),
    ("inclination_rad", |e| e.inclination[0]),
    ("inclination_rate_radps", |e| e.inclination[1]),
    ("node_rad", |e| e.node[0]),
    ("node_rate_radps", |e| e.node[1]),
    ("perigee_rad", |e| e.perigee),
    ("mean_anomaly_rad", |e| e.mean_anomaly),
    ("delta_n_radps", |e| e.delta_n),
    ("cuc_rad", |e| e.latitude_harmonics[0]),
    ("cus_rad", |e| e.latitude_harmonics[1]),
    ("crc_m", |e| e.radius_harmonics[0]),
    ("crs_m", |e| e.radius_harmonics[1]),
    ("cic_rad", |e| e.inclination_harmonics[0]),
    ("cis_rad", |e| e.inclination_harmonics[1]),
    ("group_delay_first_s", |e| e.group_delay_s[0]),
    ("group_delay_second_s", |e| e.group_delay_s[1]),
    ("fit_interval_s", |e| e.fit_interval_s),
];

/// What a raw log holds: epochs of measurements, orbits from subframes, SBAS messages; None for any other file.
#[pyfunction]
fn raw_log(py: Python<'_>, content: &[u8], path: &str) -> PyResult<Option<(usize, usize, usize)>> {
    let count = || {
        let plain = unpack(content)?;
        if !receiver::is_raw(&plain) {
            return Ok(None);
        }
        let r = receiver::read(&plain)?;
        Ok(Some((r.observations.n_epochs(), r.navigation.ephemerides.len(), r.messages.len())))
    };
    py.detach(count).map_err(|e| format_error(path, &e))
}

#[pymethods]
impl Navigation {
    /// Read from the bytes of files, plain or gzip, each with its path for messages.
    #[new]
    fn new(py: Python<'_>, files: Vec<(Vec<u8>, String)>) -> PyResult<Self> {
        let (mut records, mut refused) = (rinex::Navigation::default(), Vec::new());
        for (content, path) in files {
            let read = || receiver::read_navigation(&unpack(&content)?);
            let mut file = py.detach(read).map_err(|e| format_error(&path, &e))?;
            refused.extend(file.refused.drain(..).map(|r| (path.clone(), r)));
            records.merge(file);
        }
        Ok(Self { records, refused })
    }
    #[getter]
    fn n_ephemerides(&self) -> usize {
        self.records.ephemerides.len()
    }
    #[getter]
    fn n_geostationary(&self) -> usize {
        self.records.geostationary.len()
    }
    #[getter]
    fn leap_seconds(&self) -> Option<i64> {
        self.records.leap_seconds
    }
    #[getter]
    fn skipped(&self) -> BTreeMap<String, usize> {
        self.records.skipped.clone()
    }
    #[getter]
    fn refused(&self) -> Vec<(String, usize, String, String, String)> {
        let row = |(path, r): &(String, Refusal)| (path.clone(), r.line, r.field.clone(), r.reason.clone(), r.text.clone());
        self.refused.iter().map(row).collect()
    }
    /// The same without the Keplerian records of some satellites.
    fn without(&self, satellites: Vec<String>) -> Self {
        let mut records = self.records.clone();
        records.ephemerides.retain(|e| !satellites.contains(&e.satellite.to_string()));
        Self { records, refused: self.refused.clone() }
    }
    /// Broadcast ionosphere of "G" or "C": alpha, beta.
    fn klobuchar(&self, system: char) -> Option<([f64; 4], [f64; 4])> {
        let model = if system == 'C' { self.records.klobuchar_beidou } else { self.records.klobuchar_gps };
        model.map(|k: Klobuchar| (k.alpha, k.beta))
    }
    /// Kepler orbits of a constellation at an instant, from each satellite's nearest record: names, seven elements a row, ages [s]. One whose
    /// nearest record promises nothing is left out, unless those are requested too.
    fn orbits<'py>(&self, py: Python<'py>, system: usize, time_ns: i64, unpromised: bool) -> PyResult<Kepler<'py>> {
        let time = GpsTime::from_nanoseconds(time_ns);
        let age = |e: &Ephemeris| time.seconds_since(e.orbit_time);
        let mut nearest: BTreeMap<String, &Ephemeris> = BTreeMap::new();
        let of_system = |e: &&Ephemeris| e.satellite.constellation.index() == system;
        for e in self.records.ephemerides.iter().filter(of_system) {
            let slot = nearest.entry(e.satellite.to_string()).or_insert(e);
            if age(e).abs() < age(slot).abs() {
                *slot = e;
            }
        }
        nearest.retain(|_, e| unpromised || e.is_promised());
        let (mut rows, mut ages) = (Vec::with_capacity(7 * nearest.len()), Vec::with_capacity(nearest.len()));
        for e in nearest.values() {
            let el = mean_elements(e).moved(age(e)).map_err(|e| input_error(e, None))?;
            let [i, node, perigee, anomaly] = [el.inclination, el.node, el.perigee, el.mean_anomaly].map(Radians::rad);
            rows.extend([el.semi_major.m(), el.eccentricity, i, node, perigee, anomaly, el.node_rate_radps]);
            ages.push(age(e));
        }
        let n = nearest.len();
        Ok((nearest.into_keys().collect(), rows.into_pyarray(py).reshape([n, 7])?, ages))
    }
    /// Keplerian records: satellite, message, reference times, issue, health, accuracy, clock, elements, group delays.
    fn records<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let e = &self.records.ephemerides;
        let d = PyDict::new(py);
        d.set_item("satellite", e.iter().map(|e| e.satellite.to_string()).collect::<Vec<_>>())?;
        d.set_item("message", e.iter().map(|e| e.message.name()).collect::<Vec<_>>())?;
        d.set_item("orbit_time_ns", e.iter().map(|e| e.orbit_time.nanoseconds()).collect::<Vec<_>>().into_pyarray(py))?;
        d.set_item("clock_time_ns", e.iter().map(|e| e.clock_time.nanoseconds()).collect::<Vec<_>>().into_pyarray(py))?;
        d.set_item("issue", e.iter().map(|e| i64::from(e.issue_orbit)).collect::<Vec<_>>().into_pyarray(py))?;
        d.set_item("health", e.iter().map(|e| i64::from(e.health.word)).collect::<Vec<_>>().into_pyarray(py))?;
        d.set_item("is_healthy", e.iter().map(|e| e.healthy(Carrier::L1)).collect::<Vec<_>>().into_pyarray(py))?;
        d.set_item("is_promised", e.iter().map(Ephemeris::is_promised).collect::<Vec<_>>().into_pyarray(py))?;
        for (name, value) in ELEMENTS {
            d.set_item(name, e.iter().map(value).collect::<Vec<_>>().into_pyarray(py))?;
        }
        Ok(d)
    }
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_class::<Observations>()?;
    m.add_class::<Navigation>()?;
    m.add_function(wrap_pyfunction!(raw_log, m)?)
}
