//! Inertial navigation: mechanization and the filter.

use crate::error::input_error;
use nalgebra::{Matrix3, Vector3};
use navbound_assess::fusion::{self, Flight, Moment, Plan};
use navbound_assess::judged::{Checks, StandIn};
use navbound_core::frame::{Covariance, EcefPosition, Geodetic, LatLon};
use navbound_core::monitor::judgement::Source;
use navbound_core::monitor::separation::Separation;
use navbound_core::quantity::{GpsTime, Metres, OutOfDomain, Radians, Risk};
use navbound_core::signal::{
    Aiding, BaroHeight, Constellation, DmeRange, ImuIncrement, PositionFix, SatelliteId, SatelliteRange, TimedAiding, VorBearing,
};
use navbound_core::solution::ins::{
    Attitude, ClockModel, ErrorModel, Form, Further, ImuModel, Kind, NavState, Patience, Refusal, Resumption, SensorNoise, Settings,
    Solution, StartSigma, Stop, Wheels, coarse,
};
use numpy::{IntoPyArray, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

fn refused(e: OutOfDomain) -> PyErr {
    input_error(e, None)
}

fn vector(v: [f64; 3]) -> Vector3<f64> {
    Vector3::from(v)
}

/// Latitude, longitude, height; velocity north, east, down; roll, pitch, heading.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct Start {
    time_ns: i64,
    position: [f64; 3],
    velocity_ned_mps: [f64; 3],
    attitude_rad: [f64; 3],
}

impl Start {
    fn state(&self) -> PyResult<NavState> {
        let [roll, pitch, heading] = self.attitude_rad.map(Radians::new);
        let position = geodetic(&self.position).map_err(refused)?;
        let time = GpsTime::from_nanoseconds(self.time_ns);
        NavState::new(time, &position, vector(self.velocity_ned_mps), &Attitude { roll, pitch, heading }).map_err(refused)
    }
}

fn geodetic([lat, lon, h]: &[f64; 3]) -> Result<Geodetic, OutOfDomain> {
    Ok(Geodetic { point: LatLon::new(Radians::new(*lat), Radians::new(*lon))?, height: Metres::new(*h) })
}

/// Samples as columns; the interval of each is the time since the one before, or since the start.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct Imu<'py> {
    time_ns: PyReadonlyArray1<'py, i64>,
    interval_s: PyReadonlyArray1<'py, f64>,
    angle_rad: PyReadonlyArray2<'py, f64>,
    velocity_mps: PyReadonlyArray2<'py, f64>,
}

/// The columns as slices, all of one length.
struct Samples<'a> {
    time_ns: &'a [i64],
    interval_s: &'a [f64],
    angle: &'a [[f64; 3]],
    velocity: &'a [[f64; 3]],
}

impl Imu<'_> {
    fn samples(&self) -> PyResult<Samples<'_>> {
        Ok(Samples {
            time_ns: self.time_ns.as_slice()?,
            interval_s: self.interval_s.as_slice()?,
            angle: self.angle_rad.as_slice()?.as_chunks().0,
            velocity: self.velocity_mps.as_slice()?.as_chunks().0,
        })
    }
}

impl Samples<'_> {
    fn iter(&self) -> impl ExactSizeIterator<Item = ImuIncrement> + '_ {
        (0..self.time_ns.len()).map(|k| ImuIncrement {
            time: GpsTime::from_nanoseconds(self.time_ns[k]),
            interval_s: self.interval_s[k],
            angle_rad: vector(self.angle[k]),
            velocity_mps: vector(self.velocity[k]),
        })
    }
}

/// Pure inertial navigation: latitude, longitude, height, velocity north, east, down, roll, pitch, heading after each sample.
#[pyfunction]
fn ins_mechanize<'py>(py: Python<'py>, start: Start, imu: Imu<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let (state, samples) = (start.state()?, imu.samples()?);
    let states = py.detach(|| fusion::mechanize(state, samples.iter())).map_err(|(index, e)| input_error(e, Some(index)))?;
    let flat = states.iter().map(motion).collect::<Result<Vec<_>, _>>().map_err(refused)?;
    flat.concat().into_pyarray(py).reshape([states.len(), 9])
}

fn motion(state: &NavState) -> Result<[f64; 9], OutOfDomain> {
    let (p, v, a) = (state.position()?, state.velocity_ned_mps(), state.attitude());
    let (lat, lon, h) = (p.point.lat().rad(), p.point.lon().rad(), p.height.m());
    Ok([lat, lon, h, v.x, v.y, v.z, a.roll.rad(), a.pitch.rad(), a.heading.rad()])
}

/// Tables of measurements, one a kind: times and numbers row after row.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct Tables<'py> {
    /// Time, constellation letter and number; position, velocity, range, white, slow, its time, rate and its deviation (NaN: none).
    satellites: (PyReadonlyArray1<'py, i64>, Vec<(char, u8)>, PyReadonlyArray2<'py, f64>),
    /// Time, station; position, slant, white, bias.
    dme: (PyReadonlyArray1<'py, i64>, Vec<u16>, PyReadonlyArray2<'py, f64>),
    /// Time, station; latitude, longitude, height, bearing, white, bias.
    vor: (PyReadonlyArray1<'py, i64>, Vec<u16>, PyReadonlyArray2<'py, f64>),
    /// Time; height, white, bias, its time.
    baro: (PyReadonlyArray1<'py, i64>, PyReadonlyArray2<'py, f64>),
    /// Time; latitude, longitude, height, nine of the covariance, velocity (NaN: none), nine of its covariance, levels (NaN: none).
    fixes: (PyReadonlyArray1<'py, i64>, PyReadonlyArray2<'py, f64>),
}

fn timed(time_ns: i64, aiding: Aiding) -> TimedAiding {
    TimedAiding { time: GpsTime::from_nanoseconds(time_ns), aiding }
}

fn satellite(letter: char, number: u8, row: &[f64; 13]) -> PyResult<Aiding> {
    let [x, y, z, vx, vy, vz, range, white, slow, first, tau, rate, sigma] = *row;
    let constellation = u8::try_from(letter).ok().and_then(Constellation::from_letter);
    let Some(constellation) = constellation else {
        let code = f64::from(u32::from(letter));
        return Err(refused(OutOfDomain { argument: "satellite", value: code, unit: "letter code", domain: "G, R, E, C, S" }));
    };
    Ok(Aiding::Satellite(SatelliteRange {
        satellite: SatelliteId { constellation, number },
        position: EcefPosition::from_vector(Vector3::new(x, y, z)),
        velocity_mps: Vector3::new(vx, vy, vz),
        range: (!range.is_nan()).then_some(Metres::new(range)),
        sigma_white: Metres::new(white),
        sigma_correlated: Metres::new(slow),
        sigma_first: Metres::new(first),
        correlation_time_s: tau,
        rate_mps: (!rate.is_nan()).then_some((rate, sigma)),
    }))
}

fn dme(station: u16, [x, y, z, slant, white, bias]: &[f64; 6]) -> Aiding {
    Aiding::Dme(DmeRange {
        station,
        position: EcefPosition::from_vector(Vector3::new(*x, *y, *z)),
        slant: Metres::new(*slant),
        sigma_white: Metres::new(*white),
        sigma_bias: Metres::new(*bias),
    })
}

fn vor(station: u16, [lat, lon, h, bearing, white, bias]: &[f64; 6]) -> Result<Aiding, OutOfDomain> {
    Ok(Aiding::Vor(VorBearing {
        station,
        position: geodetic(&[*lat, *lon, *h])?,
        bearing: Radians::new(*bearing),
        sigma_white: Radians::new(*white),
        sigma_bias: Radians::new(*bias),
    }))
}

fn fix(row: &[f64; 26]) -> Result<Aiding, OutOfDomain> {
    let part = |first: usize| [row[first], row[first + 1], row[first + 2]];
    let nine = |first: usize| core::array::from_fn(|k| row[first + k]);
    let velocity = part(12);
    let velocity_ned_mps = match velocity.iter().any(|v| v.is_nan()) {
        true => None,
        false => Some((vector(velocity), Matrix3::from_row_slice(&nine(15)))),
    };
    let level_m = Some([row[24], row[25]]).filter(|levels| levels.iter().all(|l| *l >= 0.0 && l.is_finite()));
    let covariance = Covariance::from_rows(nine(3))?;
    Ok(Aiding::Fix(PositionFix { position: geodetic(&part(0))?, covariance, velocity_ned_mps, level_m }))
}

impl Tables<'_> {
    /// All in the order of time; of one instant in the order satellites, fixes, DME, VOR, barometer.
    ///
    /// A row that is no measurement at all is left out and counted: it must not cost the others.
    fn aiding(&self) -> PyResult<(Vec<TimedAiding>, u64)> {
        let mut unreadable = 0;
        let mut all = Vec::new();
        let (time, id, rows) = &self.satellites;
        for ((t, (letter, number)), row) in time.as_slice()?.iter().zip(id).zip(rows.as_slice()?.as_chunks().0) {
            all.push(timed(*t, satellite(*letter, *number, row)?));
        }
        for (t, row) in self.fixes.0.as_slice()?.iter().zip(self.fixes.1.as_slice()?.as_chunks().0) {
            match fix(row) {
                Ok(aiding) => all.push(timed(*t, aiding)),
                Err(_) => unreadable += 1,
            }
        }
        let (time, station, rows) = &self.dme;
        for ((t, station), row) in time.as_slice()?.iter().zip(station).zip(rows.as_slice()?.as_chunks().0) {
            all.push(timed(*t, dme(*station, row)));
        }
        let (time, station, rows) = &self.vor;
        for ((t, station), row) in time.as_slice()?.iter().zip(station).zip(rows.as_slice()?.as_chunks().0) {
            match vor(*station, row) {
                Ok(aiding) => all.push(timed(*t, aiding)),
                Err(_) => unreadable += 1,
            }
        }
        for (t, [height, white, bias, tau]) in self.baro.0.as_slice()?.iter().zip(self.baro.1.as_slice()?.as_chunks().0) {
            let m = BaroHeight {
                height: Metres::new(*height),
                sigma_white: Metres::new(*white),
                sigma_bias: Metres::new(*bias),
                correlation_time_s: *tau,
            };
            all.push(timed(*t, Aiding::Baro(m)));
        }
        all.sort_by_key(|a| a.time);
        Ok((all, unreadable))
    }
}

/// Everything declared to the filter.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Declared {
    /// White, bias, its time: gyroscopes, accelerometers.
    gyroscope: [f64; 3],
    accelerometer: [f64; 3],
    /// Bias, drift, frequency, walk, inter-system.
    clock: [f64; 5],
    white: bool,
    /// Its place in [`Form::ALL`].
    form: usize,
    reversion: bool,
    separation_risk: f64,
    lever_arm_m: [f64; 3],
    gate_risk: f64,
    samples_per_step: u32,
    /// Longest gap, acceleration and rate it hides.
    gap: [f64; 3],
    age_most_s: f64,
    guarded: bool,
    /// Deviations of the age of ranges and of solved positions.
    age_sigma_s: [f64; 2],
    set_after_s: f64,
    /// Lose, gain.
    patience_s: [f64; 2],
    position_sigma_m: [f64; 3],
    velocity_sigma_mps: f64,
    attitude_sigma_rad: [f64; 3],
    /// Results and updates.
    period_s: [f64; 2],
    /// Lever arm (3), deviation, mounting, period.
    wheels: Option<[f64; 6]>,
}

fn unknown_form(form: usize) -> OutOfDomain {
    OutOfDomain { argument: "form", value: form as f64, unit: "1", domain: "{0, 1, 2}" }
}

impl Declared {
    pub fn settings(&self) -> PyResult<Settings> {
        let noise = |[white, bias, bias_time_s]: [f64; 3]| SensorNoise { white, bias, bias_time_s };
        let [bias_m, drift_mps, frequency_m2ps, walk_m2ps3, inter_system_m] = self.clock;
        Ok(Settings {
            imu: ImuModel { gyroscope: noise(self.gyroscope), accelerometer: noise(self.accelerometer) },
            clock: ClockModel { bias_m, drift_mps, frequency_m2ps, walk_m2ps3, inter_system_m },
            errors: if self.white { ErrorModel::White } else { ErrorModel::Correlated },
            form: *Form::ALL.get(self.form).ok_or_else(|| refused(unknown_form(self.form)))?,
            reversion: self.reversion,
            separation: Risk::new(self.separation_risk).map_err(|e| refused(OutOfDomain { argument: "separation_risk", ..e }))?,
            lever_arm_m: vector(self.lever_arm_m),
            gate: Risk::new(self.gate_risk).map_err(|e| refused(OutOfDomain { argument: "gate_risk", ..e }))?,
            samples_per_step: self.samples_per_step,
            gap_most_s: self.gap[0],
            gap_acceleration_mps2: self.gap[1],
            gap_rate_radps: self.gap[2],
            age_most_s: self.age_most_s,
            set_after_s: self.set_after_s,
            patience: Patience { lose_s: self.patience_s[0], gain_s: self.patience_s[1] },
            resumption: Resumption::USUAL,
        })
    }

    pub fn sigma(&self) -> StartSigma {
        StartSigma {
            position: self.position_sigma_m.map(Metres::new),
            velocity_mps: self.velocity_sigma_mps,
            attitude: self.attitude_sigma_rad.map(Radians::new),
        }
    }

    pub fn plan(&self) -> Plan {
        let wheels =
            |[x, y, z, sigma_mps, mount_rad, period_s]: [f64; 6]| (Wheels { arm_m: Vector3::new(x, y, z), sigma_mps, mount_rad }, period_s);
        Plan { output_period_s: self.period_s[0], update_period_s: self.period_s[1], wheels: self.wheels.map(wheels) }
    }
}

/// Numbers of a solution: motion, covariance (ee en nn eu nu uu), deviations of velocity and attitude, biases.
const WIDTH: usize = 27;

fn numbers(solution: &Option<Solution>) -> [f64; WIDTH] {
    let mut row = [f64::NAN; WIDTH];
    let Some(s) = solution else { return row };
    let Ok(motion) = motion(&s.state) else { return row };
    let c = s.covariance.matrix();
    row[..9].copy_from_slice(&motion);
    row[9..15].copy_from_slice(&[c[(0, 0)], c[(0, 1)], c[(1, 1)], c[(0, 2)], c[(1, 2)], c[(2, 2)]]);
    row[15..18].copy_from_slice(&fusion::deviations(&s.velocity_m2ps2));
    row[18..21].copy_from_slice(&fusion::deviations(&s.attitude_rad2));
    for k in 0..3 {
        row[21 + k] = s.biases[0][k];
        row[24 + k] = s.biases[1][k];
    }
    row
}

/// What is given: the filter's solution, or the position that stands in for it, which has no attitude and no biases; NaN for none.
fn row_of(moment: &Moment) -> [f64; WIDTH] {
    match (moment.decision.source, &moment.stand_in) {
        (Source::Filter, _) => numbers(&moment.solution),
        (Source::Snapshot, Some(position)) => standing_in(position),
        _ => [f64::NAN; WIDTH],
    }
}

fn standing_in(s: &StandIn) -> [f64; WIDTH] {
    let mut row = [f64::NAN; WIDTH];
    row[..3].copy_from_slice(&[s.position.point.lat().rad(), s.position.point.lon().rad(), s.position.height.m()]);
    let c = s.covariance.matrix();
    row[9..15].copy_from_slice(&[c[(0, 0)], c[(0, 1)], c[(1, 1)], c[(0, 2)], c[(1, 2)], c[(2, 2)]]);
    if let Some(v) = &s.velocity {
        row[3..6].copy_from_slice(&[v.enu_mps.y, v.enu_mps.x, -v.enu_mps.z]);
        let [east, north, up] = fusion::deviations(&v.covariance);
        row[15..18].copy_from_slice(&[north, east, up]);
    }
    row
}

fn mode(solution: &Option<Solution>) -> &'static str {
    solution.as_ref().map_or("stopped", |s| s.mode.word())
}

fn stop_words(stop: &Stop) -> String {
    match stop {
        Stop::Place(e) => e.to_string(),
        Stop::Covariance => "a variance is not positive".to_owned(),
    }
}

fn further_word(further: Further) -> String {
    match further {
        Further::Clock => "clock_m".to_owned(),
        Further::ClockDrift => "clock_drift_mps".to_owned(),
        Further::InterSystem(c) => format!("inter_system_{}_m", c.letter()),
        Further::Baro => "baro_m".to_owned(),
        Further::Dme(k) => format!("dme_{k}_m"),
        Further::Vor(k) => format!("vor_{k}_rad"),
        Further::Satellite(id) => format!("satellite_{id}_m"),
        Further::SolvedPosition(k) => format!("solved_position_{k}"),
        Further::MountHeading => "mount_heading_rad".to_owned(),
        Further::MountPitch => "mount_pitch_rad".to_owned(),
    }
}

/// A whole flight through the filter.
#[pyfunction]
fn ins_fuse<'py>(py: Python<'py>, start: Start, imu: Imu<'py>, tables: Tables<'py>, declared: Declared) -> PyResult<Bound<'py, PyDict>> {
    let (state, samples, (aiding, unreadable)) = (start.state()?, imu.samples()?, tables.aiding()?);
    let (settings, sigma, plan) = (declared.settings()?, declared.sigma(), declared.plan());
    let [range_age_sigma_s, fix_age_sigma_s] = declared.age_sigma_s;
    let checks = Checks { guarded: declared.guarded, range_age_sigma_s, fix_age_sigma_s };
    let flight = py.detach(|| fusion::run(state, &sigma, settings, &plan, checks, samples.iter(), &aiding)).map_err(refused)?;
    let d = flight_dict(py, &flight)?;
    let mut refusals = flight.filter.refusals();
    refusals[Refusal::OutOfRange.index()] += unreadable;
    d.set_item("refusals", Refusal::ALL.iter().map(|why| (why.word(), refusals[why.index()])).collect::<Vec<_>>())?;
    d.set_item("fix_delay_s", flight.filter.fix_delay_s())?;
    d.set_item("innovations", innovations(py, &flight)?)?;
    d.set_item("reversion", reversion(py, &flight, settings.separation)?)?;
    Ok(d)
}

/// The filter without satellites at each moment, in the columns of the main one, its modes, and the horizontal distance between both with its
/// limit; `None` where none runs.
#[allow(clippy::type_complexity)] // Three tables of one row a moment.
fn reversion<'py>(
    py: Python<'py>,
    flight: &Flight,
    risk: Risk,
) -> PyResult<Option<(Bound<'py, PyArray2<f64>>, Vec<&'static str>, Bound<'py, PyArray2<f64>>)>> {
    if flight.moments.iter().all(|m| m.beside.is_none()) {
        return Ok(None);
    }
    let n = flight.moments.len();
    let solutions: Vec<_> = flight.moments.iter().map(|m| m.beside.map(|b| b.solution)).collect();
    let apart = |m: &Moment| -> Result<[f64; 2], OutOfDomain> {
        let Some(b) = &m.beside else { return Ok([f64::NAN; 2]) };
        let separation = Separation::of(&b.difference, &b.covariance, &b.solution.covariance, risk)?;
        Ok(separation.map_or([f64::NAN; 2], |s| [s.distance.m(), s.limit.m()]))
    };
    let separations = flight.moments.iter().map(apart).collect::<Result<Vec<_>, _>>().map_err(refused)?;
    let rows = solutions.iter().flat_map(numbers).collect::<Vec<_>>().into_pyarray(py).reshape([n, WIDTH])?;
    let separations = separations.concat().into_pyarray(py).reshape([n, 2])?;
    Ok(Some((rows, solutions.iter().map(mode).collect(), separations)))
}

fn flight_dict<'py>(py: Python<'py>, flight: &Flight) -> PyResult<Bound<'py, PyDict>> {
    let d = PyDict::new(py);
    let moments = &flight.moments;
    d.set_item("time_ns", moments.iter().map(|m| m.time.nanoseconds()).collect::<Vec<_>>().into_pyarray(py))?;
    let rows = moments.iter().flat_map(row_of).collect::<Vec<_>>().into_pyarray(py);
    d.set_item("rows", rows.reshape([moments.len(), WIDTH])?)?;
    d.set_item("mode", moments.iter().map(|m| mode(&m.solution)).collect::<Vec<_>>())?;
    let decisions = || moments.iter().map(|m| &m.decision);
    d.set_item("status", decisions().map(|d| d.status.word()).collect::<Vec<_>>())?;
    d.set_item("source", decisions().map(|d| d.source.word()).collect::<Vec<_>>())?;
    d.set_item("reasons", decisions().map(|d| d.reasons.iter().map(|r| r.id()).collect::<Vec<_>>()).collect::<Vec<_>>())?;
    d.set_item("hpl_m", decisions().map(|d| d.hpl_m.unwrap_or(f64::NAN)).collect::<Vec<_>>().into_pyarray(py))?;
    d.set_item("vpl_m", decisions().map(|d| d.vpl_m.unwrap_or(f64::NAN)).collect::<Vec<_>>().into_pyarray(py))?;
    d.set_item("n_states", moments.iter().map(|m| m.n_states as i64).collect::<Vec<_>>().into_pyarray(py))?;
    let s = &flight.samples;
    d.set_item("samples", [s.n_done, s.n_bridged, s.n_after_gap, s.n_late, s.n_refused, s.n_stopped])?;
    d.set_item("stopped", flight.stopped.as_ref().map(|(t, why)| (t.nanoseconds(), stop_words(why))))?;
    d.set_item("holes", flight.holes.iter().map(|(t, since_s)| (t.nanoseconds(), *since_s)).collect::<Vec<_>>())?;
    d.set_item("clock_jumps", flight.filter.clock_jumps())?;
    d.set_item("left_out", flight.filter.stations_left_out().map(further_word).collect::<Vec<_>>())?;
    d.set_item("refused", flight.refused.as_ref().map(|(t, why)| (t.nanoseconds(), why.to_string())))?;
    d.set_item("further", flight.filter.further().map(|(what, value)| (further_word(what), value)).collect::<Vec<_>>())?;
    Ok(d)
}

/// Of each kind: used, gated, refused, mean square, lag-one correlation, pairs behind it.
fn innovations<'py>(py: Python<'py>, flight: &Flight) -> PyResult<Bound<'py, PyDict>> {
    let d = PyDict::new(py);
    for kind in Kind::ALL {
        let i = flight.filter.innovations(kind);
        d.set_item(kind.word(), (i.n_used, i.n_gated, i.n_refused, i.mean_square(), i.lag_one(), i.n_pairs()))?;
    }
    Ok(d)
}

/// Roll, pitch and heading of a body that stood and then moved.
#[pyfunction]
fn ins_coarse(force_mps2: [f64; 3], velocity_ned_mps: [f64; 3]) -> PyResult<[f64; 3]> {
    let a = coarse(&vector(force_mps2), &vector(velocity_ned_mps)).map_err(refused)?;
    Ok([a.roll.rad(), a.pitch.rad(), a.heading.rad()])
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(ins_mechanize, m)?)?;
    m.add_function(wrap_pyfunction!(ins_fuse, m)?)?;
    m.add_function(wrap_pyfunction!(ins_coarse, m)?)
}
