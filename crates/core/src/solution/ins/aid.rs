//! Measurements come to the filter: judged first, then used.

use super::covariance::Row;
use super::dynamics::{R, V};
use super::entry::Refusal;
use super::filter::Filter;
use super::innovation::Kind;
use super::measure::{Antenna, Scalar, body_velocity};
use super::settings::{ErrorModel, positive};
use super::slots::{Further, Process};
use super::state::finite;
use super::stations::{Look, Standing};
use crate::frame::ecef_from_geodetic;
use crate::quantity::{GpsTime, Metres, OutOfDomain};
use crate::signal::{Aiding, BaroHeight, DmeRange, PositionFix, SatelliteRange, TimedAiding, VorBearing};
use crate::special::float::hypot;
use nalgebra::{Matrix3, Vector3};

/// What became of a measurement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Aided {
    /// Used; the squared normalised innovation, and of how many components.
    Used {
        /// Sum over the components.
        square: f64,
        /// Components.
        dimension: usize,
    },
    /// Thrown away by the gate.
    Gated {
        /// As for [`Aided::Used`].
        square: f64,
    },
    /// Not of the time of the last sample, or too old for it.
    Late {
        /// Last sample minus measurement \[s\].
        age_s: f64,
    },
    /// A number that is none, or outside its domain.
    Refused(OutOfDomain),
    /// The same measurement again.
    Repeated,
    /// Another measurement of the same source and instant.
    SameName,
    /// All places for further states are taken.
    NoPlace,
    /// The ranges of the instant determine no position (the loose form).
    NoPosition,
    /// The filter has stopped.
    Stopped,
}

/// The vehicle rolls where its wheels point: no velocity to the side or upwards at a point of the body. Not for aircraft: an assumption of
/// the user's, declared with its own standard deviation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wheels {
    /// That point, seen from the inertial unit, body axes \[m\].
    pub arm_m: Vector3<f64>,
    /// Standard deviation of both components \[m/s\].
    pub sigma_mps: f64,
    /// Standard deviation of the angles between the body axes and the wheels \[rad\], estimated as two constants.
    pub mount_rad: f64,
}

impl Wheels {
    /// # Errors
    /// [`OutOfDomain`] for a lever arm that is not finite or a deviation that is not positive.
    pub fn check(&self) -> Result<(), OutOfDomain> {
        self.arm_m.iter().try_for_each(|x| finite("wheels_arm_m", *x, "m"))?;
        positive("wheels_sigma_mps", self.sigma_mps, "m/s")?;
        positive("wheels_mount_rad", self.mount_rad, "rad")
    }
}

/// Deviations by which the speed may be less than estimated where the vehicle is said to move.
const KNOWN_SIGMAS: f64 = 3.0;

impl Aided {
    /// Why it was not used, where no gate was examined.
    pub const fn refusal(&self) -> Option<Refusal> {
        match self {
            Self::Used { .. } | Self::Gated { .. } => None,
            Self::Late { .. } => Some(Refusal::Late),
            Self::Refused(_) => Some(Refusal::OutOfRange),
            Self::Repeated => Some(Refusal::Repeated),
            Self::SameName => Some(Refusal::SameName),
            Self::NoPlace => Some(Refusal::NoPlace),
            Self::NoPosition => Some(Refusal::NoPosition),
            Self::Stopped => Some(Refusal::Stopped),
        }
    }

    /// What the entry has said of a measurement that it did not let in.
    const fn of(why: Refusal) -> Self {
        match why {
            Refusal::SameName => Self::SameName,
            Refusal::Late => Self::Late { age_s: f64::NAN },
            _ => Self::Repeated,
        }
    }
}

impl Filter {
    /// One measurement, at the time of the last sample or up to `age_most_s` before it.
    pub fn aid(&mut self, timed: &TimedAiding) -> Aided {
        let kind = Kind::of(&timed.aiding);
        let outcome = self.judge(timed);
        if let Some(why) = outcome.refusal() {
            self.innovations[kind.index()].n_refused += 1;
            self.entry.count(why);
        }
        outcome
    }

    /// Why measurements were not used.
    pub(super) fn count(&mut self, outcome: &Aided, n: usize) {
        if let Some(why) = outcome.refusal() {
            (0..n).for_each(|_| self.entry.count(why));
        }
    }

    /// A measurement made of sound numbers that was not heard before.
    pub(super) fn admit(&mut self, timed: &TimedAiding) -> Result<(), Aided> {
        super::sane::check(&timed.aiding).map_err(Aided::Refused)?;
        let v = self.state().velocity_ned_mps();
        let sigma = crate::special::float::sqrt(self.joint.get(V, V) + self.joint.get(V + 1, V + 1));
        let speed_mps = hypot(v.x, v.y) - KNOWN_SIGMAS * sigma;
        self.entry.admit(timed, speed_mps).map_err(Aided::of)
    }

    /// Last sample heard minus a time \[s\], where a measurement of that time may be used.
    pub(super) fn age_of(&self, time: GpsTime) -> Option<f64> {
        let age_s = self.heard().seconds_since(time);
        // A nanosecond ahead is rounding of the clock; a sample ahead belongs to the next sample.
        (age_s >= -1e-9 && age_s <= self.settings.age_most_s).then_some(age_s)
    }

    /// Everything brought to the last sample, and the antenna and the age \[s\] of a measurement of this time; or why none can be used.
    pub(super) fn ready(&mut self, time: GpsTime) -> Result<(Antenna, f64), Aided> {
        if self.stopped.is_some() {
            return Err(Aided::Stopped);
        }
        let Some(age_s) = self.age_of(time) else {
            return Err(Aided::Late { age_s: self.heard().seconds_since(time) });
        };
        self.drift().map_err(Aided::Refused)?;
        self.settle();
        Antenna::of(self.state(), &self.settings.lever_arm_m, &self.rate, age_s).map(|a| (a, age_s)).map_err(Aided::Refused)
    }

    fn judge(&mut self, timed: &TimedAiding) -> Aided {
        let (antenna, age_s) = match self.ready(timed.time) {
            Ok(innovation) => innovation,
            Err(outcome) => return outcome,
        };
        if let Err(outcome) = self.admit(timed) {
            return outcome;
        }
        let used = match &timed.aiding {
            Aiding::Satellite(m) => self.satellite(&antenna, m, timed.time),
            Aiding::Dme(m) => self.dme(&antenna, m),
            Aiding::Vor(m) => self.vor(&antenna, m),
            Aiding::Baro(m) => self.baro(&antenna, m, age_s),
            Aiding::Fix(m) => {
                let [north, east] = [0, 1].map(|k| antenna.ned_from_ecef.row(k).transpose());
                let (variance, place) = (m.covariance.matrix(), *ecef_from_geodetic(&m.position).vector());
                match &m.velocity_ned_mps {
                    Some((v, r)) => self.delay.velocity_heard(timed.time, v.xy(), r[(0, 0)].max(r[(1, 1)])),
                    None => self.delay.heard(timed.time, place, variance[(0, 0)].max(variance[(1, 1)]), [north, east]),
                }
                self.fix(&antenna, m)
            }
        };
        if matches!(used, Aided::Used { .. }) {
            self.note(&timed.aiding);
            self.modes.tick(self.time());
        }
        used
    }

    fn note(&mut self, aiding: &Aiding) {
        let time = self.time();
        match aiding {
            // A rate holds no position: the mode knows ranges only.
            Aiding::Satellite(m) if m.range.is_none() => {}
            Aiding::Satellite(m) => {
                let id = m.satellite.constellation.index() as u64 * 256 + u64::from(m.satellite.number);
                self.modes.satellite(id, time);
            }
            Aiding::Dme(m) => self.modes.dme(m.station, time),
            Aiding::Vor(m) => self.modes.vor(m.station, time),
            Aiding::Fix(_) => self.modes.fix(time),
            Aiding::Baro(_) => {}
        }
    }

    /// Range, then its rate; a clock is known from the first range on.
    fn satellite(&mut self, antenna: &Antenna, m: &SatelliteRange, time: GpsTime) -> Aided {
        let ranged = m.range.map(|range| self.range(antenna, m, range, time));
        if let Some(Aided::NoPlace | Aided::Refused(_)) = ranged {
            return ranged.unwrap_or(Aided::NoPlace);
        }
        let Some((rate, sigma)) = m.rate_mps else { return ranged.unwrap_or(Aided::NoPlace) };
        let Some(drift) = self.slots.find(Further::ClockDrift) else { return Aided::NoPlace };
        // The range may have moved the velocity, much so where both are tied: after a hole.
        let mut scalar = antenna.moving(self.state()).range_rate(m, rate, sigma);
        self.attach(&mut scalar, drift);
        let rated = self.use_one((Kind::RangeRate, Further::Satellite(m.satellite)), &scalar, None);
        ranged.unwrap_or(rated)
    }

    fn range(&mut self, antenna: &Antenna, m: &SatelliteRange, measured: Metres, time: GpsTime) -> Aided {
        let mut range = antenna.range(m, measured);
        let (clock, joint) = (self.settings.clock, &mut self.joint);
        let Some([bias, _]) = self.slots.ensure_clock(joint, &clock, range.innovation) else { return Aided::NoPlace };
        if let Some(jump) = self.instant.at(time) {
            self.n_clock_jumps += 1;
            let value = self.slots.value(bias) + jump;
            self.slots.set_anew(joint, bias, value, clock.bias_m);
        }
        let mut more = [None; 2];
        let first = *self.first_constellation.get_or_insert(m.satellite.constellation);
        if first != m.satellite.constellation {
            let bias = Process::constant(clock.inter_system_m);
            let what = Further::InterSystem(m.satellite.constellation);
            let Some(slot) = self.slots.ensure(joint, what, bias, 0.0) else { return Aided::NoPlace };
            more[0] = Some(slot);
        }
        let slow = Process { sigma: m.sigma_correlated.m(), first: m.sigma_first.m(), tau_s: m.correlation_time_s };
        match self.own_state(Further::Satellite(m.satellite), slow, &mut range.variance) {
            Ok(slot) => more[1] = slot,
            Err(outcome) => return outcome,
        }
        for place in [Some(bias), more[0], more[1]].into_iter().flatten() {
            self.attach(&mut range, place);
        }
        let outcome = self.use_one((Kind::Range, Further::Satellite(m.satellite)), &range, more[1]);
        match outcome {
            Aided::Used { .. } => self.instant.used(),
            _ => self.instant.gated(range.innovation, self.variance(&range.row, range.variance)),
        }
        outcome
    }

    fn dme(&mut self, antenna: &Antenna, m: &DmeRange) -> Aided {
        let p = Matrix3::from_fn(|i, j| self.joint.get(R + i, R + j));
        // The bend stays as long as the error across the line of sight does: it belongs to the station's bias, not to what is new.
        let slow = Process::constant(hypot(m.sigma_bias.m(), antenna.bend(m, &p)));
        self.with_own_state(Kind::Dme, antenna.slant(m), Further::Dme(m.station), slow)
    }

    fn vor(&mut self, antenna: &Antenna, m: &VorBearing) -> Aided {
        let scalar = match antenna.bearing(m) {
            Ok(scalar) => scalar,
            Err(refusal) => return Aided::Refused(refusal),
        };
        let slow = Process::constant(m.sigma_bias.rad());
        self.with_own_state(Kind::Vor, scalar, Further::Vor(m.station), slow)
    }

    fn baro(&mut self, antenna: &Antenna, m: &BaroHeight, age_s: f64) -> Aided {
        let predicted = self.state().h + antenna.v.z * age_s;
        let row = Row::empty().with(R + 2, 1.0);
        let variance = m.sigma_white.m() * m.sigma_white.m();
        let scalar = Scalar { innovation: m.height.m() - predicted, row, variance };
        let slow = Process::stationary(m.sigma_bias.m(), m.correlation_time_s);
        self.with_own_state(Kind::Baro, scalar, Further::Baro, slow)
    }

    fn fix(&mut self, antenna: &Antenna, m: &PositionFix) -> Aided {
        let enu = m.covariance.matrix();
        let ned = |i: usize| [1, 0, 2][i];
        let sign = |i: usize| if i == 2 { -1.0 } else { 1.0 };
        let r = Matrix3::from_fn(|i, j| sign(i) * sign(j) * enu[(ned(i), ned(j))]);
        let outcome = self.use_three(Kind::FixPosition, &antenna.difference(&m.position), &r, |axis| antenna.along_position(axis));
        if let Some((velocity, r)) = &m.velocity_ned_mps {
            let antenna = antenna.moving(self.state());
            self.use_three(Kind::FixVelocity, &(velocity - antenna.v), r, |axis| antenna.along_velocity(axis));
        }
        outcome
    }

    /// Sideways and upwards velocity are what the mounting makes of the forward one; what became of the second of both.
    pub fn roll(&mut self, wheels: &Wheels) -> Aided {
        if self.stopped.is_some() {
            return Aided::Stopped;
        }
        if let Some(after_gap) = &self.after_gap {
            return Aided::Late { age_s: self.time().seconds_since(after_gap.heard) };
        }
        if let Err(refusal) = wheels.check() {
            return Aided::Refused(refusal);
        }
        self.settle();
        let mount = Process::constant(wheels.mount_rad);
        let mut outcome = Aided::NoPlace;
        for (j, what) in [(1, Further::MountHeading), (2, Further::MountPitch)] {
            let Some(place) = self.slots.ensure(&mut self.joint, what, mount, 0.0) else { return Aided::NoPlace };
            let (forward, _) = body_velocity(self.state(), &wheels.arm_m, &self.rate, 0);
            let (velocity, row) = body_velocity(self.state(), &wheels.arm_m, &self.rate, j);
            let innovation = self.slots.value(place) * forward - velocity;
            let variance = wheels.sigma_mps * wheels.sigma_mps;
            let scalar = Scalar { innovation, row: row.with(place, -forward), variance };
            outcome = self.use_one((Kind::Wheels, what), &scalar, Some(place));
        }
        outcome
    }

    /// A state of its own for what stays, or everything into the white part, as the error model has it.
    fn own_state(&mut self, what: Further, slow: Process, variance: &mut f64) -> Result<Option<usize>, Aided> {
        if self.settings.errors == ErrorModel::White || !(slow.sigma > 0.0) {
            *variance += slow.sigma * slow.sigma;
            return Ok(None);
        }
        self.slots.ensure(&mut self.joint, what, slow, 0.0).map(Some).ok_or(Aided::NoPlace)
    }

    fn with_own_state(&mut self, kind: Kind, mut scalar: Scalar, what: Further, slow: Process) -> Aided {
        match self.own_state(what, slow, &mut scalar.variance) {
            Err(outcome) => outcome,
            Ok(place) => {
                if let Some(place) = place {
                    self.attach(&mut scalar, place);
                    if let Some(outcome) = self.watch((kind, what), &scalar, place, slow) {
                        return outcome;
                    }
                }
                self.use_one((kind, what), &scalar, place)
            }
        }
    }

    /// A station's measurement that may not be used, because the station contradicts the filter; its bias is then forgotten.
    fn watch(&mut self, (kind, what): (Kind, Further), scalar: &Scalar, place: usize, slow: Process) -> Option<Aided> {
        if !matches!(kind, Kind::Dme | Kind::Vor) {
            return None;
        }
        let states = self.variance(&scalar.row, 0.0);
        let look = Look { innovation: scalar.innovation, white: scalar.variance, states };
        let standing = self.stations.judge(what, &look, self.gates[0]);
        if standing == Standing::Good {
            return None;
        }
        if standing == Standing::LeftOut {
            self.slots.set_anew(&mut self.joint, place, 0.0, slow.sigma);
        }
        let square = look.innovation * look.innovation / (look.white + look.states);
        self.innovations[kind.index()].n_gated += 1;
        self.innovations[kind.index()].examined(crate::special::float::sqrt(square / self.gates[0]));
        Some(Aided::Gated { square })
    }

    /// The measurement holds a further state, added as it is.
    fn attach(&self, scalar: &mut Scalar, place: usize) {
        scalar.innovation -= self.slots.value(place);
        scalar.row = scalar.row.with(place, 1.0);
    }

    fn use_one(&mut self, (kind, source): (Kind, Further), scalar: &Scalar, place: Option<usize>) -> Aided {
        let s = self.variance(&scalar.row, scalar.variance);
        let normalised = scalar.innovation / crate::special::float::sqrt(s);
        let square = normalised * normalised;
        self.innovations[kind.index()].examined(crate::special::float::sqrt(square / self.gates[0]));
        if !(square <= self.gates[0]) {
            self.innovations[kind.index()].n_gated += 1;
            return Aided::Gated { square };
        }
        if let Some(place) = place {
            let time = self.time();
            self.slots.saw(place, time);
        }
        if let Err(refusal) = self.correct(core::slice::from_ref(scalar)) {
            return Aided::Refused(refusal);
        }
        let before = self.memory.replace(kind, source, normalised);
        let time = self.time();
        self.innovations[kind.index()].used(normalised, before, time);
        Aided::Used { square, dimension: 1 }
    }

    /// Three components with a common variance matrix: judged together, used along the axes in which they are independent.
    pub(super) fn use_three(
        &mut self,
        kind: Kind,
        innovation: &Vector3<f64>,
        r: &Matrix3<f64>,
        row: impl Fn(&Vector3<f64>) -> Row,
    ) -> Aided {
        let eigen = r.symmetric_eigen();
        if !(eigen.eigenvalues.min() > 0.0) {
            let value = eigen.eigenvalues.min();
            return Aided::Refused(OutOfDomain {
                argument: "covariance",
                value,
                unit: "m² or m²/s²",
                domain: "variances (0, inf) along every axis",
            });
        }
        let axis = |k: usize| eigen.eigenvectors.column(k).into_owned();
        let rows = [row(&axis(0)), row(&axis(1)), row(&axis(2))];
        let y = eigen.eigenvectors.transpose() * innovation;
        let carried = rows.map(|h| self.joint.times(&h));
        let s = Matrix3::from_fn(|i, j| rows[i].of(&carried[j])) + Matrix3::from_diagonal(&eigen.eigenvalues);
        let square = s.cholesky().map_or(f64::NAN, |c| y.dot(&c.solve(&y)));
        self.innovations[kind.index()].examined(crate::special::float::sqrt(square / self.gates[1]));
        if !(square <= self.gates[1]) {
            self.innovations[kind.index()].n_gated += 3;
            return Aided::Gated { square };
        }
        let scalar = |k: usize| Scalar { innovation: y[k], row: rows[k], variance: eigen.eigenvalues[k] };
        // The first axis of the caller, whatever the independent ones are called this time.
        let first = eigen.eigenvectors.row(0);
        let normalised = innovation.x / crate::special::float::sqrt((first * s * first.transpose())[(0, 0)]);
        if let Err(refusal) = self.correct(&[scalar(0), scalar(1), scalar(2)]) {
            return Aided::Refused(refusal);
        }
        // Solved positions and velocities have one source each.
        let before = self.memory.replace(kind, Further::Clock, normalised);
        let time = self.time();
        self.innovations[kind.index()].used_three(square, normalised, before, time);
        Aided::Used { square, dimension: 3 }
    }
}

impl Kind {
    /// Of a measurement: of a satellite its range, or its rate where it has none; of a solved position the position.
    pub const fn of(aiding: &Aiding) -> Self {
        match aiding {
            Aiding::Satellite(m) if m.range.is_none() => Self::RangeRate,
            Aiding::Satellite(_) => Self::Range,
            Aiding::Dme(_) => Self::Dme,
            Aiding::Vor(_) => Self::Vor,
            Aiding::Baro(_) => Self::Baro,
            Aiding::Fix(_) => Self::FixPosition,
        }
    }
}
