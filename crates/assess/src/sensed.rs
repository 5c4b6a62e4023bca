//! One sensed flight as columns: truth, inertial samples, and a table for each kind of measurement.

use navbound_core::quantity::{GpsTime, Metres, OutOfDomain};
use navbound_core::signal::{Aiding, PhaseRange, SatelliteId, TimedAiding};
use navbound_simulate::{Imu, Motion, SensedFlight, Sensing, Step, Trajectory};

/// Names of the columns of the truth.
pub const TRUTH: [&str; 15] = [
    "truth_lat_rad",
    "truth_lon_rad",
    "truth_h_m",
    "vel_n_mps",
    "vel_e_mps",
    "vel_d_mps",
    "roll_rad",
    "pitch_rad",
    "heading_rad",
    "force_x_mps2",
    "force_y_mps2",
    "force_z_mps2",
    "rate_x_radps",
    "rate_y_radps",
    "rate_z_radps",
];
/// Of the inertial samples.
pub const IMU: [&str; 7] =
    ["interval_s", "angle_x_rad", "angle_y_rad", "angle_z_rad", "velocity_x_mps", "velocity_y_mps", "velocity_z_mps"];
/// Of the satellites' ranges.
pub const SATELLITES: [&str; 14] = [
    "sv_x_m",
    "sv_y_m",
    "sv_z_m",
    "sv_vx_mps",
    "sv_vy_mps",
    "sv_vz_mps",
    "range_m",
    "sigma_white_m",
    "sigma_correlated_m",
    "correlation_time_s",
    "range_rate_mps",
    "sigma_rate_mps",
    "phase_m",
    "sigma_phase_m",
];
/// Of the ranges to DME.
pub const DME: [&str; 6] = ["station_x_m", "station_y_m", "station_z_m", "slant_m", "sigma_white_m", "sigma_bias_m"];
/// Of the bearings from VOR.
pub const VOR: [&str; 6] = ["station_lat_rad", "station_lon_rad", "station_h_m", "bearing_rad", "sigma_white_rad", "sigma_bias_rad"];
/// Of the altimeter.
pub const BARO: [&str; 4] = ["baro_h_m", "sigma_white_m", "sigma_bias_m", "correlation_time_s"];
/// Of the receiver's clock, true.
pub const CLOCK: [&str; 2] = ["clock_m", "drift_mps"];

/// Columns of numbers and the GPS time of their rows \[ns\].
#[derive(Debug, Clone, PartialEq)]
pub struct Table<const N: usize> {
    /// Times.
    pub time_ns: Vec<i64>,
    /// Columns in the order of their names.
    pub columns: [Vec<f64>; N],
}

impl<const N: usize> Table<N> {
    fn with_room(rows: usize) -> Self {
        Self { time_ns: Vec::with_capacity(rows), columns: core::array::from_fn(|_| Vec::with_capacity(rows)) }
    }

    fn push(&mut self, time_ns: i64, row: [f64; N]) {
        self.time_ns.push(time_ns);
        for (column, value) in self.columns.iter_mut().zip(row) {
            column.push(value);
        }
    }
}

/// A flight.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensed {
    /// The true motion, from the begin.
    pub truth: Table<15>,
    /// Inertial samples; the time is that of the end of the interval.
    pub imu: Table<7>,
    /// Ranges to satellites,
    pub satellites: Table<14>,
    /// and which.
    pub satellite: Vec<SatelliteId>,
    /// Ranges to DME,
    pub dme: Table<6>,
    /// and the station's place in the scenario.
    pub dme_station: Vec<u16>,
    /// Bearings from VOR,
    pub vor: Table<6>,
    /// and the station's place in the scenario.
    pub vor_station: Vec<u16>,
    /// Heights of the altimeter.
    pub baro: Table<4>,
    /// The receiver's clock at its measurements.
    pub clock: Table<2>,
}

impl Sensed {
    /// A flight; truth is kept at every `truth_every`-th sample.
    ///
    /// # Errors
    /// As [`Sensing::trajectory`] and [`Sensing::flight`]; [`OutOfDomain`] for a truth at no sample.
    pub fn fly(sensing: &Sensing, seed: u64, number: u64, truth_every: u64) -> Result<Self, OutOfDomain> {
        let trajectory = sensing.trajectory(seed, number)?;
        Self::of(sensing.flight(&trajectory, seed, number)?, truth_every)
    }

    /// An inertial unit alone, on wheels along positions at whole seconds; truth is kept at every `truth_every`-th sample.
    ///
    /// # Errors
    /// As [`Trajectory::on_wheels`] and [`SensedFlight::inertial`].
    pub fn roll(
        begin: GpsTime,
        positions: &[[f64; 3]],
        (imu, rate_hz): (&Imu, u32),
        (seed, number): (u64, u64),
        truth_every: u64,
    ) -> Result<Self, OutOfDomain> {
        let trajectory = Trajectory::on_wheels(positions)?;
        Self::of(SensedFlight::inertial(&trajectory, begin, (imu, rate_hz), (seed, number))?, truth_every)
    }

    fn of(mut flight: SensedFlight<'_>, truth_every: u64) -> Result<Self, OutOfDomain> {
        if truth_every == 0 {
            return Err(OutOfDomain { argument: "truth_every", value: 0.0, unit: "samples", domain: "[1, inf)" });
        }
        let mut sensed = Self::with_room(flight.samples(), truth_every);
        sensed.truth.push(flight.begin().nanoseconds(), truth_row(flight.now()));
        let mut index = 0;
        while let Some(step) = flight.advance()? {
            index += 1;
            sensed.sample(&step, index % truth_every == 0);
            sensed.aid(flight.aiding(), flight.phases());
            if let (Some(clock), true) = (flight.clock(), flight.received()) {
                sensed.clock.push(step.imu.time.nanoseconds(), clock);
            }
        }
        Ok(sensed)
    }

    fn with_room(samples: u64, truth_every: u64) -> Self {
        Self {
            truth: Table::with_room((samples / truth_every) as usize + 1),
            imu: Table::with_room(samples as usize),
            satellites: Table::with_room(0),
            satellite: Vec::new(),
            dme: Table::with_room(0),
            dme_station: Vec::new(),
            vor: Table::with_room(0),
            vor_station: Vec::new(),
            baro: Table::with_room(0),
            clock: Table::with_room(0),
        }
    }

    fn sample(&mut self, step: &Step, with_truth: bool) {
        let (time_ns, a, v) = (step.imu.time.nanoseconds(), &step.imu.angle_rad, &step.imu.velocity_mps);
        if step.delivered {
            self.imu.push(time_ns, [step.imu.interval_s, a.x, a.y, a.z, v.x, v.y, v.z]);
        }
        if with_truth {
            self.truth.push(time_ns, truth_row(&step.truth));
        }
    }

    fn aid(&mut self, aiding: &[TimedAiding], phases: &[PhaseRange]) {
        let mut phases = phases.iter();
        for timed in aiding {
            let time_ns = timed.time.nanoseconds();
            match &timed.aiding {
                Aiding::Satellite(s) => {
                    let (p, v) = (s.position.vector(), &s.velocity_mps);
                    let (rate, sigma_rate) = s.rate_mps.unwrap_or((f64::NAN, f64::NAN));
                    // A receiver delivers a phase with every range, in the same order.
                    let phase = phases.next().map_or([f64::NAN; 2], |p| [p.range.m(), p.sigma_white.m()]);
                    let [white, slow] = [s.sigma_white.m(), s.sigma_correlated.m()];
                    let tau = s.correlation_time_s;
                    let own = [
                        p.x,
                        p.y,
                        p.z,
                        v.x,
                        v.y,
                        v.z,
                        s.range.map_or(f64::NAN, Metres::m),
                        white,
                        slow,
                        tau,
                        rate,
                        sigma_rate,
                        phase[0],
                        phase[1],
                    ];
                    self.satellites.push(time_ns, own);
                    self.satellite.push(s.satellite);
                }
                Aiding::Dme(d) => {
                    let p = d.position.vector();
                    self.dme.push(time_ns, [p.x, p.y, p.z, d.slant.m(), d.sigma_white.m(), d.sigma_bias.m()]);
                    self.dme_station.push(d.station);
                }
                Aiding::Vor(b) => {
                    let (point, h) = (b.position.point, b.position.height.m());
                    let [white, bias] = [b.sigma_white.rad(), b.sigma_bias.rad()];
                    self.vor.push(time_ns, [point.lat().rad(), point.lon().rad(), h, b.bearing.rad(), white, bias]);
                    self.vor_station.push(b.station);
                }
                Aiding::Baro(b) => {
                    self.baro.push(time_ns, [b.height.m(), b.sigma_white.m(), b.sigma_bias.m(), b.correlation_time_s]);
                }
                // No simulated sensor delivers a solved position.
                Aiding::Fix(_) => {}
            }
        }
    }
}

fn truth_row(motion: &Motion) -> [f64; 15] {
    let (p, v) = (&motion.position, &motion.velocity_ned_mps);
    let [roll, pitch, heading] = motion.roll_pitch_yaw_rad();
    let (f, w) = (&motion.force_mps2, &motion.rate_radps);
    let place = [p.point.lat().rad(), p.point.lon().rad(), p.height.m()];
    [place[0], place[1], place[2], v.x, v.y, v.z, roll, pitch, heading, f.x, f.y, f.z, w.x, w.y, w.z]
}
