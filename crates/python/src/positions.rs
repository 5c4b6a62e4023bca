//! Receivers' files and the positions solved from them.

use crate::error::{format_error, input_error, risk};
use crate::orbits::PreciseOrbits;
use crate::status;
use navbound_assess::positions::{Job, Model, Positions, Signals, azimuth_rad, elevation_rad, ground_speed_mps, positions, sigma_m};
use navbound_assess::receivers::heard::{Fate, Heard};
use navbound_assess::receivers::ranges::{Tally, Unused};
use navbound_assess::smoothing::Form;
use navbound_core::frame::{self, EcefPosition, Geodetic, LatLon};
use navbound_core::geometry::broadcast::mean_elements;
use navbound_core::geometry::ionosphere::{Ionosphere, MEAN_ACTIVITY_SFU};
use navbound_core::geometry::{Direction, ntcm};
use navbound_core::quantity::{GpsTime, Metres, OutOfDomain, Radians, Unavailable};
use navbound_core::signal::smoothing::Smoothing;
use navbound_core::signal::{Carrier, Constellation, Ephemeris, Klobuchar};
use navbound_core::solution::RangeError;
use navbound_core::solution::point::{Fix, Settings, Used};
use navbound_formats::Refusal;
use navbound_formats::packed::unpack;
use navbound_formats::receiver;
use navbound_formats::rinex::{self, Code};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::exceptions::{PyLookupError, PyValueError};
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

/// Positions of every epoch as columns of the epoch table, with counts of what was not used.
#[pyfunction]
#[pyo3(signature = (observations, navigation, systems, *, dual, ionosphere, mask_rad, false_alarm, most_excluded, range_factor, shared_factor, precise, smoothing_s, divergence_free, keep_ranges))]
#[expect(clippy::too_many_arguments, reason = "one setting each, named by the caller")]
fn solve_positions<'py>(
    py: Python<'py>,
    observations: &Observations,
    navigation: &Navigation,
    systems: &str,
    dual: bool,
    ionosphere: &str,
    mask_rad: f64,
    false_alarm: f64,
    most_excluded: usize,
    range_factor: f64,
    shared_factor: f64,
    precise: Option<&PreciseOrbits>,
    smoothing_s: Option<f64>,
    divergence_free: bool,
    keep_ranges: bool,
) -> PyResult<Bound<'py, PyDict>> {
    if let Some(window) = smoothing_s {
        within("smoothing_s", window, "s", "(0, 86400]", window > 0.0 && window <= 86_400.0)?;
    }
    within("mask_rad", mask_rad, "rad", "[0, pi/2)", (0.0..core::f64::consts::FRAC_PI_2).contains(&mask_rad))?;
    risk("false_alarm", false_alarm)?;
    within("range_factor", range_factor, "1", "(0, inf)", range_factor > 0.0 && range_factor.is_finite())?;
    within("shared_factor", shared_factor, "1", "[0, inf)", shared_factor >= 0.0 && shared_factor.is_finite())?;
    let errors = weights(precise).scaled(range_factor, shared_factor);
    let model = ionosphere_model(ionosphere, observations, navigation)?;
    let settings = Settings { mask: Radians::new(mask_rad), ionosphere: model, errors, false_alarm, most_excluded };
    let job = Job {
        systems: systems.bytes().filter_map(Constellation::from_letter).collect(),
        signals: if dual { Signals::Dual } else { Signals::Single },
        smoothing: smoothing_s.map(|window| (if divergence_free { Form::DivergenceFree } else { Form::Single }, Smoothing::over(window))),
        settings,
        keep_ranges,
    };
    let solved = py.detach(|| positions(&observations.0, &navigation.records, precise.map(PreciseOrbits::tables), &job));
    let d = table(py, &solved, errors.name)?;
    d.set_item("smoothed_share", solved.smoothed_share)?;
    d.set_item("n_compared", solved.n_compared)?;
    d.set_item("ionosphere", model_name(&model))?;
    d.set_item("ranges", if keep_ranges { Some(kept_ranges(py, &solved)?) } else { None })?;
    d.set_item("heard", if keep_ranges { Some(heard(py, &solved)?) } else { None })?;
    Ok(d)
}

/// The model by its name, at the middle of the observations.
fn ionosphere_model(name: &str, observations: &Observations, navigation: &Navigation) -> PyResult<Ionosphere> {
    let model = match name {
        "auto" => Model::Auto,
        "broadcast" => Model::Broadcast,
        "galileo" => Model::Galileo,
        "climatology" => Model::Climatology,
        "none" => Model::Uncorrected,
        _ => return Err(PyValueError::new_err(format!("ionosphere: {name}"))),
    };
    let middle = observations.0.time.get(observations.0.n_epochs() / 2).copied().unwrap_or_default();
    let none = || PyLookupError::new_err(format!("no message of the ionosphere: {name}"));
    model.of(&navigation.records, middle).ok_or_else(none)
}

/// Name of a model, and the solar activity that it counts on \[sfu\].
fn model_name(model: &Ionosphere) -> (&'static str, f64) {
    match model {
        Ionosphere::Broadcast { .. } => ("broadcast", f64::NAN),
        Ionosphere::Ntcm { level_sfu } => ("galileo", *level_sfu),
        Ionosphere::Climatology => ("climatology", MEAN_ACTIVITY_SFU),
        Ionosphere::Uncorrected => ("none", MEAN_ACTIVITY_SFU),
    }
}

/// The ranges of every position, one row each: index of the epoch, and what the range was.
fn kept_ranges<'py>(py: Python<'py>, solved: &Positions) -> PyResult<Bound<'py, PyDict>> {
    let rows: Vec<_> = solved.ranges.iter().enumerate().flat_map(|(i, used)| used.iter().map(move |u| (i as i64, u))).collect();
    let d = PyDict::new(py);
    d.set_item("epoch", rows.iter().map(|(i, _)| *i).collect::<Vec<_>>().into_pyarray(py))?;
    d.set_item("sv", rows.iter().map(|(_, (satellite, _))| satellite.to_string()).collect::<Vec<_>>())?;
    let column = |f: fn(&Used) -> f64| rows.iter().map(|(_, (_, used))| f(used)).collect::<Vec<_>>().into_pyarray(py);
    d.set_item("az_rad", column(azimuth_rad))?;
    d.set_item("el_rad", column(elevation_rad))?;
    d.set_item("sigma_m", column(sigma_m))?;
    d.set_item("residual_m", column(|u| u.residual.m()))?;
    d.set_item("shared_1_m", column(|u| u.shared_m.x))?;
    d.set_item("shared_2_m", column(|u| u.shared_m.y))?;
    d.set_item("shared_3_m", column(|u| u.shared_m.z))?;
    d.set_item("shared_4_m", column(|u| u.shared_m.w))?;
    Ok(d)
}

/// Every satellite that was heard, one row an epoch: index of the epoch, direction, strength, what became of it.
fn heard<'py>(py: Python<'py>, solved: &Positions) -> PyResult<Bound<'py, PyDict>> {
    let rows: Vec<_> = solved.heard.iter().enumerate().flat_map(|(i, each)| each.iter().map(move |h| (i as i64, h))).collect();
    let d = PyDict::new(py);
    d.set_item("epoch", rows.iter().map(|(i, _)| *i).collect::<Vec<_>>().into_pyarray(py))?;
    d.set_item("sv", rows.iter().map(|(_, h)| h.satellite.to_string()).collect::<Vec<_>>())?;
    let column = |f: fn(&Heard) -> f64| rows.iter().map(|(_, h)| f(h)).collect::<Vec<_>>().into_pyarray(py);
    d.set_item("az_rad", column(|h| h.direction.map_or(f64::NAN, |d| d.azimuth().rad())))?;
    d.set_item("el_rad", column(|h| h.direction.map_or(f64::NAN, |d| d.elevation().rad())))?;
    d.set_item("cn0_dbhz", column(|h| h.cn0_dbhz))?;
    d.set_item("fate", rows.iter().map(|(_, h)| h.fate.id()).collect::<Vec<_>>())?;
    Ok(d)
}

/// What may become of a satellite beside not being used: ids with their words.
#[pyfunction]
fn satellite_fates() -> Vec<(&'static str, &'static str)> {
    Fate::OWN.into_iter().map(|fate| (fate.id(), fate.words())).collect()
}

const fn weights(precise: Option<&PreciseOrbits>) -> RangeError {
    if precise.is_some() { RangeError::PRECISE } else { RangeError::CALIBRATED }
}

fn within(argument: &'static str, value: f64, unit: &'static str, domain: &'static str, good: bool) -> PyResult<()> {
    if good { Ok(()) } else { Err(input_error(OutOfDomain { argument, value, unit, domain }, None)) }
}

/// One number of a position.
type Number = fn(&Fix) -> f64;

fn table<'py>(py: Python<'py>, solved: &Positions, weights: &str) -> PyResult<Bound<'py, PyDict>> {
    let d = PyDict::new(py);
    let columns: [(&str, Number); 16] = [
        ("est_lat_rad", |f| f.position.point.lat().rad()),
        ("est_lon_rad", |f| f.position.point.lon().rad()),
        ("est_h_m", |f| f.position.height.m()),
        ("cov_ee_m2", |f| f.covariance.matrix()[(0, 0)]),
        ("cov_en_m2", |f| f.covariance.matrix()[(0, 1)]),
        ("cov_nn_m2", |f| f.covariance.matrix()[(1, 1)]),
        ("cov_eu_m2", |f| f.covariance.matrix()[(0, 2)]),
        ("cov_nu_m2", |f| f.covariance.matrix()[(1, 2)]),
        ("cov_uu_m2", |f| f.covariance.matrix()[(2, 2)]),
        ("hdop", |f| f.dilution.horizontal),
        ("vdop", |f| f.dilution.vertical),
        ("vel_e_mps", |f| velocity(f, 0)),
        ("vel_n_mps", |f| velocity(f, 1)),
        ("vel_u_mps", |f| velocity(f, 2)),
        ("ground_speed_mps", ground_speed_mps),
        ("p_residual", |f| f.residual_risk),
    ];
    for (name, value) in columns {
        let values: Vec<f64> = solved.fixes.iter().map(|f| f.as_ref().map_or(f64::NAN, value)).collect();
        d.set_item(name, values.into_pyarray(py))?;
    }
    let count = |value: fn(&Fix) -> usize| solved.fixes.iter().map(|f| f.as_ref().map_or(0, |f| value(f) as i64)).collect::<Vec<_>>();
    d.set_item("n_sv", count(|f| f.n_used).into_pyarray(py))?;
    d.set_item("n_excluded", count(|f| f.n_excluded).into_pyarray(py))?;
    d.set_item("n_redundant", count(|f| f.redundancy).into_pyarray(py))?;
    let words = |(i, f): (usize, &Result<Fix, Unavailable>)| match (f, solved.doubts.get(i)) {
        (Err(why), None | Some(None)) => why.to_string(),
        _ => solved.reason(i).map_or_else(String::new, |r| r.words().to_owned()),
    };
    let reasons: Vec<_> = (0..solved.fixes.len()).map(|i| solved.reason(i)).collect();
    d.set_item("status", reasons.iter().map(|r| status::of(*r)).collect::<Vec<_>>())?;
    d.set_item("reason_id", reasons.iter().map(|r| status::id(*r)).collect::<Vec<_>>())?;
    d.set_item("reason", solved.fixes.iter().enumerate().map(words).collect::<Vec<_>>())?;
    satellites(&d, &solved.tally, &solved.signals)?;
    d.set_item("codes", solved.codes.clone())?;
    d.set_item("weights", weights)?;
    Ok(d)
}

/// Satellite-epochs that were not used, by the id of the reason; ranges that were, by satellite and message; signals by constellation.
pub(crate) fn satellites(d: &Bound<'_, PyDict>, tally: &Tally, signals: &BTreeMap<char, &'static str>) -> PyResult<()> {
    let unused = PyDict::new(d.py());
    for (why, n) in tally.unused() {
        unused.set_item(why.id(), n)?;
    }
    d.set_item("unused", unused)?;
    let name = |letter: char| signals.get(&letter).copied().unwrap_or_default();
    let rows =
        tally.used().map(|(satellite, message, n)| (satellite.to_string(), name(satellite.constellation.letter()), message.name(), n));
    d.set_item("used", rows.collect::<Vec<_>>())
}

/// Why a satellite may not be used: ids with their words.
#[pyfunction]
fn unused_reasons() -> Vec<(&'static str, &'static str)> {
    Unused::ALL.into_iter().map(|why| (why.id(), why.words())).collect()
}

fn velocity(fix: &Fix, axis: usize) -> f64 {
    fix.velocity.map_or(f64::NAN, |(v, _)| v[axis])
}

/// Geodetic positions (n, 3) of Earth-fixed ones: latitude, longitude [rad], height [m]; NaN stays NaN.
#[pyfunction]
fn geodetic_from_ecef<'py>(py: Python<'py>, ecef_m: PyReadonlyArray2<'py, f64>) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let convert = |(index, row): (usize, &[f64; 3])| {
        if row.iter().any(|v| v.is_nan()) {
            return Ok([f64::NAN; 3]);
        }
        let position = frame::geodetic_from_ecef(&EcefPosition::from_vector((*row).into())).map_err(|e| input_error(e, Some(index)))?;
        Ok([position.point.lat().rad(), position.point.lon().rad(), position.height.m()])
    };
    let rows: PyResult<Vec<[f64; 3]>> = ecef_m.as_slice()?.as_chunks::<3>().0.iter().enumerate().map(convert).collect();
    let rows = rows?;
    rows.as_flattened().to_vec().into_pyarray(py).reshape([rows.len(), 3])
}

/// Earth-fixed position \[m\] of latitude, longitude \[rad\] and height above the ellipsoid \[m\].
#[pyfunction]
fn ecef_from_geodetic(lat_rad: f64, lon_rad: f64, h_m: f64) -> PyResult<[f64; 3]> {
    let point = LatLon::new(Radians::new(lat_rad), Radians::new(lon_rad)).map_err(|e| input_error(e, None))?;
    Ok((*frame::ecef_from_geodetic(&Geodetic { point, height: Metres::new(h_m) }).vector()).into())
}

/// Delay on L1 by NTCM-G \[m\]: effective ionisation level \[sfu\], receiver \[rad, rad, m\], azimuth and elevation \[rad\], GPS time \[ns\].
#[pyfunction]
fn ntcm_delay(level_sfu: f64, place: (f64, f64, f64), sight: (f64, f64), time_ns: i64) -> PyResult<f64> {
    let refuse = |e| input_error(e, None);
    let point = LatLon::new(Radians::new(place.0), Radians::new(place.1)).map_err(refuse)?;
    let direction = Direction::new(Radians::new(sight.0), Radians::new(sight.1)).map_err(refuse)?;
    let receiver = Geodetic { point, height: Metres::new(place.2) };
    Ok(ntcm::delay(level_sfu, &receiver, &direction, GpsTime::from_nanoseconds(time_ns)).m())
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_class::<Observations>()?;
    m.add_class::<Navigation>()?;
    m.add_function(wrap_pyfunction!(raw_log, m)?)?;
    m.add_function(wrap_pyfunction!(geodetic_from_ecef, m)?)?;
    m.add_function(wrap_pyfunction!(ecef_from_geodetic, m)?)?;
    m.add_function(wrap_pyfunction!(unused_reasons, m)?)?;
    m.add_function(wrap_pyfunction!(satellite_fates, m)?)?;
    m.add_function(wrap_pyfunction!(ntcm_delay, m)?)?;
    m.add_function(wrap_pyfunction!(solve_positions, m)?)
}
