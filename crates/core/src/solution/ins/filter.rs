//! The filter: inertial samples carry the state, measurements correct it, nothing brings it down.

use super::after_gap::AfterGap;
use super::covariance::{BASE, Fade, Joint, Row, StepNoise, WIDTH};
use super::delay::Delay;
use super::dynamics::{BA, BG, NAV, PHI, R, V, transition};
use super::entry::{Entry, Refusal};
use super::innovation::{Innovations, Kind, Memory};
use super::jump::Instant;
use super::measure::Scalar;
use super::mode::{Mode, Modes};
use super::settings::{Settings, StartSigma, positive};
use super::slots::{Further, Slots};
use super::state::{NavState, turn, wrapped};
use super::stations::Stations;
use super::strapdown::{Local, Step, Strapdown, check};
use crate::frame::{Covariance, Enu};
use crate::quantity::{GpsTime, OutOfDomain};
use crate::signal::{Constellation, ImuIncrement};
use crate::special::chi::chi_factor;
use crate::special::float::sqrt;
use nalgebra::{Matrix3, Quaternion, Vector3};

/// Largest difference between the time of a state and the time for which a position is requested \[s\]: the rounding of time tags. At 250 m/s
/// half a millisecond is 0.13 m. Provenance: ours.
pub const STATE_AGE_MOST_S: f64 = 5e-4;

/// What became of an inertial sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Advance {
    /// Taken.
    Done,
    /// Taken; the hole before it was bridged by holding its rates, and the covariance knows.
    Bridged {
        /// Length of the hole \[s\].
        gap_s: f64,
    },
    /// Heard, not integrated: what turned in a hole before it is not known.
    AfterGap {
        /// Time since the state that the filter holds \[s\].
        since_s: f64,
    },
    /// Left out: not after the last one.
    Late,
    /// Left out: a number that is none, or outside its domain. The next good sample finds a hole.
    Refused(OutOfDomain),
    /// The filter has stopped, now or earlier: it needs a new start.
    Stopped(Stop),
}

/// Why a filter stopped.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stop {
    /// Too near a pole, or nowhere on the Earth.
    Place(OutOfDomain),
    /// A variance that is not positive.
    Covariance,
}

/// Counters of the inertial samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Samples {
    /// Taken.
    pub n_done: u64,
    /// Holes bridged.
    pub n_bridged: u64,
    /// Not after the last one.
    pub n_late: u64,
    /// Outside their domain.
    pub n_refused: u64,
    /// Heard only, after a hole too long to be bridged.
    pub n_after_gap: u64,
    /// After the stop.
    pub n_stopped: u64,
}

/// What the filter says at an instant.
#[derive(Debug, Clone, Copy)]
pub struct Solution {
    /// Position, velocity, attitude.
    pub state: NavState,
    /// Covariance of the position error.
    pub covariance: Covariance<Enu>,
    /// Variance matrix of the velocity error, north, east, down \[m²/s²\].
    pub velocity_m2ps2: Matrix3<f64>,
    /// Variance matrix of the misalignment about north, east, down \[rad²\].
    pub attitude_rad2: Matrix3<f64>,
    /// Biases of the gyroscopes \[rad/s\] and accelerometers \[m/s²\].
    pub biases: [Vector3<f64>; 2],
    /// Their standard deviations.
    pub sigma_biases: [Vector3<f64>; 2],
    /// What keeps the position.
    pub mode: Mode,
}

impl Solution {
    /// Whether position, velocity and their variances are numbers that can be right.
    pub fn is_sound(&self) -> bool {
        let NavState { lat, lon, h, v, .. } = &self.state;
        let numbers = [*lat, *lon, *h, v.x, v.y, v.z];
        let variance = |k: usize| [self.covariance.matrix()[(k, k)], self.velocity_m2ps2[(k, k)]];
        numbers.iter().all(|x| x.is_finite()) && (0..3).flat_map(variance).all(|v| v > 0.0 && v.is_finite())
    }
}

/// Samples that wait for a common step of the covariance.
#[derive(Debug, Clone, Copy)]
struct Waiting {
    n: u32,
    step: Step,
}

/// Closed-loop error-state filter.
#[derive(Debug, Clone)]
pub struct Filter {
    pub(super) settings: Settings,
    pub(super) strapdown: Strapdown,
    pub(super) joint: Joint,
    pub(super) slots: Slots,
    pub(super) modes: Modes,
    pub(super) innovations: [Innovations; Kind::ALL.len()],
    pub(super) memory: Memory,
    pub(super) entry: Entry,
    pub(super) delay: Delay,
    /// Whose time the clock is in.
    pub(super) first_constellation: Option<Constellation>,
    pub(super) biases: [Vector3<f64>; 2],
    /// Rate over the Earth, body axes, for lever arms \[rad/s\].
    pub(super) rate: Vector3<f64>,
    waiting: Option<Waiting>,
    samples: Samples,
    pub(super) stopped: Option<Stop>,
    pub(super) after_gap: Option<AfterGap>,
    pub(super) aligning: bool,
    pub(super) stations: Stations,
    pub(super) instant: Instant,
    pub(super) n_clock_jumps: u32,
    /// Squared gates of one and of three components.
    pub(super) gates: [f64; 2],
}

impl Filter {
    /// Begin.
    ///
    /// # Errors
    /// [`OutOfDomain`] for a setting or a standard deviation that is none.
    pub fn new(start: NavState, sigma: &StartSigma, settings: Settings) -> Result<Self, OutOfDomain> {
        settings.check()?;
        let mut variances = [0.0; NAV];
        positive("velocity_sigma_mps", sigma.velocity_mps, "m/s")?;
        for k in 0..3 {
            positive("position_sigma_m", sigma.position[k].m(), "m")?;
            positive("attitude_sigma_rad", sigma.attitude[k].rad(), "rad")?;
            variances[R + k] = sigma.position[k].m() * sigma.position[k].m();
            variances[V + k] = sigma.velocity_mps * sigma.velocity_mps;
            variances[PHI + k] = sigma.attitude[k].rad() * sigma.attitude[k].rad();
            variances[BG + k] = settings.imu.gyroscope.bias * settings.imu.gyroscope.bias;
            variances[BA + k] = settings.imu.accelerometer.bias * settings.imu.accelerometer.bias;
        }
        let (one, three) = (chi_factor(1, settings.gate.q())?, chi_factor(3, settings.gate.q())?);
        Ok(Self {
            settings,
            strapdown: Strapdown::new(start),
            joint: Joint::new(&variances),
            slots: Slots::new(start.time),
            modes: Modes::new(settings.patience),
            innovations: [Innovations::default(); Kind::ALL.len()],
            memory: Memory::new(),
            entry: Entry::new(),
            delay: Delay::new(),
            first_constellation: None,
            biases: [Vector3::zeros(); 2],
            rate: Vector3::zeros(),
            waiting: None,
            samples: Samples::default(),
            stopped: None,
            after_gap: None,
            aligning: false,
            stations: Stations::new(),
            instant: Instant::default(),
            n_clock_jumps: 0,
            gates: [one * one, three * three],
        })
    }

    /// Position, velocity and attitude now.
    pub const fn state(&self) -> &NavState {
        self.strapdown.state()
    }
    /// Counters of the inertial samples.
    pub const fn samples(&self) -> &Samples {
        &self.samples
    }
    /// Why it has stopped, if it has.
    pub const fn stopped(&self) -> Option<&Stop> {
        self.stopped.as_ref()
    }
    /// To take from the sums of the innovations of a kind.
    pub(super) const fn innovations_mut(&mut self, kind: Kind) -> &mut Innovations {
        &mut self.innovations[kind.index()]
    }
    /// Sums of the innovations of a kind.
    pub const fn innovations(&self, kind: Kind) -> &Innovations {
        &self.innovations[kind.index()]
    }
    /// Measurements that were not used before any gate, in the order of [`Refusal::ALL`].
    pub const fn refusals(&self) -> &[u64; Refusal::ALL.len()] {
        self.entry.counts()
    }
    /// Whether solved positions are of another time than their tags say.
    pub const fn fixes_are_late(&self) -> bool {
        self.delay.is_late()
    }
    /// By how much, tag minus time of the position \[s\], where the motion shows it.
    pub fn fix_delay_s(&self) -> Option<f64> {
        self.delay.estimate_s()
    }
    /// The further states and their values: lengths \[m\], rates \[m/s\], angles \[rad\].
    pub fn further(&self) -> impl Iterator<Item = (Further, f64)> + '_ {
        self.slots.iter()
    }
    /// Stations that are left out now because they contradict the others.
    pub fn stations_left_out(&self) -> impl Iterator<Item = Further> + '_ {
        self.stations.left_out()
    }
    /// How often the receiver's clock has jumped and was set anew.
    pub const fn clock_jumps(&self) -> u32 {
        self.n_clock_jumps
    }
    /// Number of states.
    pub const fn n_states(&self) -> usize {
        NAV + self.slots.len()
    }

    /// Everything of this time; `None` where the state was not moved to it, the filter has stopped, or a number of it is none: a state of
    /// another time is no answer to where the vehicle is.
    pub fn solution(&mut self, at: GpsTime) -> Option<Solution> {
        let now = self.is_current() && self.time().seconds_since(at).abs() <= STATE_AGE_MOST_S;
        if now { Some(self.latest()).filter(Solution::is_sound) } else { None }
    }

    /// Everything of the last sample, the covariance brought up to it.
    pub(super) fn latest(&mut self) -> Solution {
        self.catch_up();
        self.watch_alignment();
        let block = |first: usize| Matrix3::from_fn(|i, j| self.joint.get(first + i, first + j));
        let p = block(R);
        // North, east, down to east, north, up.
        let enu = [p[(1, 1)], p[(0, 1)], p[(0, 0)], -p[(1, 2)], -p[(0, 2)], p[(2, 2)]];
        Solution {
            state: *self.state(),
            covariance: Covariance::from_upper(enu),
            velocity_m2ps2: block(V),
            attitude_rad2: block(PHI),
            biases: self.biases,
            sigma_biases: [BG, BA].map(|first| Vector3::from_fn(|k, _| sqrt(self.joint.get(first + k, first + k)))),
            mode: if self.is_aligning() { Mode::Aligning } else { self.modes.mode() },
        }
    }

    /// One inertial sample further.
    pub fn advance(&mut self, sample: &ImuIncrement) -> Advance {
        let outcome = self.try_advance(sample);
        match outcome {
            Advance::Done => self.samples.n_done += 1,
            Advance::Bridged { .. } => {
                self.samples.n_done += 1;
                self.samples.n_bridged += 1;
            }
            Advance::AfterGap { .. } => self.samples.n_after_gap += 1,
            Advance::Late => self.samples.n_late += 1,
            Advance::Refused(_) => self.samples.n_refused += 1,
            Advance::Stopped(_) => self.samples.n_stopped += 1,
        }
        outcome
    }

    fn try_advance(&mut self, sample: &ImuIncrement) -> Advance {
        if let Some(stop) = self.stopped {
            return Advance::Stopped(stop);
        }
        if let Err(refusal) = check(sample) {
            return Advance::Refused(refusal);
        }
        if self.after_gap.is_some() {
            return self.listen(sample);
        }
        let since_s = sample.time.seconds_since(self.state().time);
        if !(since_s > 0.0) {
            return Advance::Late;
        }
        let gap_s = since_s - sample.interval_s;
        // Half a sample is jitter of the time tags; less than none is an interval that says more than the clock.
        if !(gap_s > 0.5 * sample.interval_s) {
            return self.taken(sample, Advance::Done);
        }
        if !(gap_s <= self.settings.gap_most_s) {
            return self.lose(sample);
        }
        self.bridge(sample, since_s, gap_s)
    }

    /// The rates of the sample are held over the hole, and what they may hide goes into the covariance.
    fn bridge(&mut self, sample: &ImuIncrement, since_s: f64, gap_s: f64) -> Advance {
        self.strapdown.forget();
        let stretch = since_s / sample.interval_s;
        let whole = ImuIncrement {
            time: sample.time,
            interval_s: since_s,
            angle_rad: sample.angle_rad * stretch,
            velocity_mps: sample.velocity_mps * stretch,
        };
        if check(&whole).is_err() {
            return self.lose(sample);
        }
        let outcome = self.taken(&whole, Advance::Bridged { gap_s });
        self.strapdown.forget();
        self.catch_up();
        let (a, w) = (self.settings.gap_acceleration_mps2 * gap_s, self.settings.gap_rate_radps * gap_s);
        for k in 0..3 {
            self.joint.add_variance(R + k, 0.25 * a * a * gap_s * gap_s);
            self.joint.add_variance(V + k, a * a);
            self.joint.add_variance(PHI + k, w * w);
        }
        outcome
    }

    fn stop(&mut self, why: Stop) -> Advance {
        self.stopped = Some(why);
        Advance::Stopped(why)
    }

    pub(super) fn taken(&mut self, sample: &ImuIncrement, outcome: Advance) -> Advance {
        let dt = sample.interval_s;
        let corrected = ImuIncrement {
            angle_rad: sample.angle_rad - self.biases[0] * dt,
            velocity_mps: sample.velocity_mps - self.biases[1] * dt,
            ..*sample
        };
        let before = *self.state().velocity_ned_mps();
        let step = match self.strapdown.step(&corrected) {
            Ok(step) => step,
            Err(refusal) => return self.stop(Stop::Place(refusal)),
        };
        let change = self.state().velocity_ned_mps() - before;
        self.delay.moved(sample.time, change.xy(), dt);
        self.rate = corrected.angle_rad / dt - step.c.transpose() * step.earth.earth;
        let waiting = match self.waiting {
            None => Waiting { n: 1, step },
            Some(w) => Waiting { n: w.n + 1, step: w.step.joined(&step) },
        };
        self.waiting = Some(waiting);
        if waiting.n >= self.settings.samples_per_step {
            self.catch_up();
        }
        self.modes.tick(sample.time);
        outcome
    }

    /// The covariance follows to the last sample.
    pub(super) fn catch_up(&mut self) {
        let Some(Waiting { step, .. }) = self.waiting.take() else { return };
        let (g, a) = (&self.settings.imu.gyroscope, &self.settings.imu.accelerometer);
        let noise = StepNoise {
            velocity: a.white * a.white * step.dt,
            angle: g.white * g.white * step.dt,
            gyroscope: Fade::gauss_markov(g.bias, g.bias_time_s, step.dt),
            accelerometer: Fade::gauss_markov(a.bias, a.bias_time_s, step.dt),
        };
        self.biases[0] *= noise.gyroscope.factor;
        self.biases[1] *= noise.accelerometer.factor;
        self.joint.propagate(&transition(&step), &noise);
    }

    /// Everything is brought to the last sample, ready for measurements.
    pub(super) fn settle(&mut self) {
        self.catch_up();
        let time = self.state().time;
        self.slots.settle(&mut self.joint, time, &self.settings.clock, self.settings.set_after_s);
    }

    /// Variance of an innovation.
    pub(super) fn variance(&self, row: &Row, r: f64) -> f64 {
        self.joint.variance(row) + r
    }

    /// Scalars of one measurement, their errors independent, one after the other; then the state takes the correction.
    ///
    /// # Errors
    /// [`OutOfDomain`] for a variance so small beside the filter's that the update would leave a state without one; what was used of the
    /// scalars before it stays used.
    pub(super) fn correct(&mut self, scalars: &[Scalar]) -> Result<(), OutOfDomain> {
        let mut x = [0.0; WIDTH];
        let unsound = scalars.iter().find(|m| !self.joint.update(&m.row, m.innovation, m.variance, &mut x));
        if !self.joint.is_sound(self.slots.len()) {
            self.stopped = Some(Stop::Covariance);
            return Ok(());
        }
        self.slots.correct(&x[BASE..]);
        let part = |first: usize| Vector3::new(x[first], x[first + 1], x[first + 2]);
        self.biases[0] += part(BG);
        self.biases[1] += part(BA);
        self.strapdown.state_mut().correct(&part(R), &part(V), &part(PHI));
        let domain = "one beside which the variances of the states can be computed";
        unsound.map_or(Ok(()), |m| Err(OutOfDomain { argument: "variance", value: m.variance, unit: "of the measurement", domain }))
    }

    /// Of when it speaks.
    pub fn time(&self) -> GpsTime {
        self.state().time
    }
}

impl NavState {
    /// The errors are taken away: `r - dr, v - dv, C = (1 + [phi x]) C_estimated`.
    pub(super) fn correct(&mut self, dr: &Vector3<f64>, dv: &Vector3<f64>, phi: &Vector3<f64>) {
        let local = Local::at(self.lat, self.h, &self.v);
        self.lat -= dr.x / local.north;
        self.lon = wrapped(self.lon - dr.y / (local.east * local.cos));
        self.h += dr.z;
        self.v -= dv;
        let q: Quaternion<f64> = turn(phi) * self.q;
        self.q = q;
        self.renormalize();
    }
}

impl Step {
    /// Two steps as one for the covariance: increments add up, the attitude is their mean, the Earth that of the later.
    fn joined(&self, next: &Self) -> Self {
        let dt = self.dt + next.dt;
        let c = (self.c * self.dt + next.c * next.dt) / dt;
        Self { dt, force_dt: self.force_dt + next.force_dt, c, earth: next.earth }
    }
}
