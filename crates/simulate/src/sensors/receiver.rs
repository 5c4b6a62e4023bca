//! The satellite receiver: code ranges, range rates and accumulated phases, each error with a stream of its own.
//!
//! ```text
//! range = |X_s(t - way) - X| + clock + system bias + ranging + F ionosphere + m troposphere + multipath(el) + noise
//! phase = the same, ionosphere negative, no multipath, its own noise, a constant
//! rate  = u . (V_s - V) + drift + noise
//! ```
//!
//! F, m and the multipath model are those of `ranging.rs`. The slow parts evolve whether the satellite is in view or not, so that what one
//! satellite draws depends on no other.

use super::clock::ReceiverClock;
use super::faults::{SensorFault, is_of};
use super::markov::Markov;
use super::settings::{Gnss, RangeMode, RangeParts};
use super::sky::{Satellite, Sent};
use crate::philox::{Sensor, Stream};
use crate::ranging;
use crate::trajectory::Motion;
use nalgebra::Vector3;
use navbound_core::frame::{Displacement, ecef_from_geodetic, enu_from_ecef};
use navbound_core::geometry::Observer;
use navbound_core::quantity::{GpsTime, Metres, OutOfDomain, Radians};
use navbound_core::signal::{Aiding, Constellation, PhaseRange, SatelliteId, SatelliteRange, TimedAiding};

/// Spread of the phase's constant; nobody may learn anything from it \[m\].
const AMBIGUITY_SIGMA_M: f64 = 1000.0;

/// A receiver under way.
pub(crate) struct Receiver<'a> {
    settings: &'a Gnss,
    faults: &'a [SensorFault],
    channels: Vec<Channel<'a>>,
    clock: ReceiverClock,
    troposphere: Markov,
    system_bias_m: [f64; Constellation::ALL.len()],
    begin: GpsTime,
    phases: Vec<PhaseRange>,
}

/// One satellite's errors.
struct Channel<'a> {
    satellite: &'a Satellite,
    code: Stream,
    rate: Stream,
    phase: Stream,
    slow: [Markov; 3],
    ambiguity_m: f64,
}

/// Slow parts of an error and their standard deviation.
#[derive(Clone, Copy)]
struct Slow {
    code_m: f64,
    phase_m: f64,
    sigma_m: f64,
    correlation_time_s: f64,
}

impl<'a> Receiver<'a> {
    pub(crate) fn new(
        settings: &'a Gnss,
        satellites: &'a [Satellite],
        faults: &'a [SensorFault],
        begin: GpsTime,
        seed: u64,
        flight: u64,
    ) -> Self {
        let p = &settings.parts;
        let times = [p.ranging_time_s, p.ionosphere_time_s, p.multipath_time_s, p.troposphere_time_s];
        let step = settings.interval_s;
        let channels = satellites.iter().map(|s| Channel::new(s, step, &times, seed, flight)).collect();
        let mut system_bias_m = [0.0; Constellation::ALL.len()];
        for system in &settings.constellations[1..] {
            let index = system.constellation().index();
            let mut stream = Stream::of_unit(seed, flight, Sensor::SystemBias, index as u64);
            system_bias_m[index] = settings.system_bias_sigma_m * stream.normal();
        }
        Self {
            settings,
            faults,
            channels,
            clock: ReceiverClock::new(settings, seed, flight),
            troposphere: Markov::new(Stream::new(seed, flight, Sensor::Troposphere), step, times[3]),
            system_bias_m,
            begin,
            phases: Vec::new(),
        }
    }

    /// Accumulated phases of the last measurement.
    pub(crate) fn phases(&self) -> &[PhaseRange] {
        &self.phases
    }

    /// Offset \[m\] and drift \[m/s\] of the clock at the last measurement.
    pub(crate) fn clock(&self) -> [f64; 2] {
        self.clock.now()
    }

    /// The next measurement, one interval after the last.
    pub(crate) fn measure(&mut self, time_s: f64, motion: &Motion, out: &mut Vec<TimedAiding>) -> Result<(), OutOfDomain> {
        self.clock.step();
        self.troposphere.step();
        self.phases.clear();
        let seen = Seen::new(motion, self.faults, time_s)?;
        let silent = self.faults.iter().any(|f| matches!(f, SensorFault::Interference { .. }) && f.since(time_s).is_some());
        let instant = Instant {
            settings: self.settings,
            faults: self.faults,
            begin: self.begin,
            time_s,
            clock: self.clock.now(),
            troposphere: self.troposphere.now(),
            system_bias_m: &self.system_bias_m,
        };
        for channel in &mut self.channels {
            let noise = channel.step();
            let out_of_service = self.faults.iter().any(|f| f.silences(channel.satellite.id, time_s));
            let heard = if silent || out_of_service { None } else { instant.heard(channel, &seen, noise)? };
            if let Some((range, phase)) = heard {
                out.push(TimedAiding { time: self.begin.plus_seconds(time_s), aiding: Aiding::Satellite(range) });
                self.phases.push(phase);
            }
        }
        Ok(())
    }
}

/// What all satellites share at a measurement.
struct Instant<'a> {
    settings: &'a Gnss,
    faults: &'a [SensorFault],
    begin: GpsTime,
    time_s: f64,
    clock: [f64; 2],
    troposphere: f64,
    system_bias_m: &'a [f64; Constellation::ALL.len()],
}

impl Instant<'_> {
    /// What is measured of a satellite; `None` below the mask or without a record.
    fn heard(&self, channel: &Channel<'_>, seen: &Seen, noise: [f64; 3]) -> Result<Option<(SatelliteRange, PhaseRange)>, OutOfDomain> {
        let (id, s) = (channel.satellite.id, self.settings);
        if !channel.satellite.rises(self.begin, self.time_s, &seen.receiver) {
            return Ok(None);
        }
        let Some(sent) = channel.satellite.sent(self.begin, self.time_s, &seen.receiver) else { return Ok(None) };
        let elevation = seen.observer.direction(&sent.position)?.elevation();
        if !(elevation.rad() >= s.mask_rad) {
            return Ok(None);
        }
        let (white_m, slow) = errors(s, channel, self.troposphere, elevation);
        let bias_m = self.system_bias_m[id.constellation.index()];
        let [fault_m, fault_mps] = faulty(self.faults, id, self.time_s);
        let common = sent.range_m + self.clock[0] + bias_m + fault_m;
        let range = SatelliteRange {
            satellite: id,
            position: sent.position,
            velocity_mps: sent.velocity_mps,
            range: Some(Metres::new(common + slow.code_m + white_m * noise[0])),
            sigma_white: Metres::new(white_m),
            sigma_correlated: Metres::new(slow.sigma_m),
            sigma_first: Metres::new(slow.sigma_m),
            correlation_time_s: slow.correlation_time_s,
            rate_mps: Some((seen.rate(&sent) + self.clock[1] + fault_mps + s.rate_sigma_mps * noise[1], s.rate_sigma_mps)),
        };
        let phase_m = common + slow.phase_m + channel.ambiguity_m + s.phase_sigma_m * noise[2];
        let phase = PhaseRange { satellite: id, range: Metres::new(phase_m), sigma_white: Metres::new(s.phase_sigma_m) };
        Ok(Some((range, phase)))
    }
}

impl<'a> Channel<'a> {
    fn new(satellite: &'a Satellite, step_s: f64, times: &[f64; 4], seed: u64, flight: u64) -> Self {
        let unit = 256 * satellite.id.constellation.index() as u64 + u64::from(satellite.id.number);
        let stream = |sensor| Stream::of_unit(seed, flight, sensor, unit);
        let slow = [(Sensor::SignalInSpace, 0), (Sensor::Ionosphere, 1), (Sensor::Multipath, 2)];
        let mut phase = stream(Sensor::PhaseNoise);
        let ambiguity_m = AMBIGUITY_SIGMA_M * phase.normal();
        Self {
            satellite,
            code: stream(Sensor::CodeNoise),
            rate: stream(Sensor::DopplerNoise),
            phase,
            slow: slow.map(|(sensor, i)| Markov::new(stream(sensor), step_s, times[i])),
            ambiguity_m,
        }
    }

    /// Code, rate and phase noise of the next measurement, of unit variance.
    fn step(&mut self) -> [f64; 3] {
        self.slow.iter_mut().for_each(Markov::step);
        [self.code.normal(), self.rate.normal(), self.phase.normal()]
    }
}

/// Standard deviation of the white part \[m\], and the slow parts.
fn errors(settings: &Gnss, channel: &Channel<'_>, troposphere: f64, elevation: Radians) -> (f64, Slow) {
    match settings.mode {
        RangeMode::Seed => (settings.seed_sigma_m, Slow { code_m: 0.0, phase_m: 0.0, sigma_m: 0.0, correlation_time_s: 1.0 }),
        RangeMode::Real => (settings.parts.noise_sigma_m, slow(&settings.parts, channel, troposphere, elevation)),
    }
}

/// The parts as one: standard deviations add in squares, and the correlation time is their mean weighted with variance, which keeps the
/// integral of the covariance over time.
fn slow(parts: &RangeParts, channel: &Channel<'_>, troposphere: f64, elevation: Radians) -> Slow {
    let [ranging, ionosphere, multipath] = &channel.slow;
    let delay = [
        (parts.ranging_sigma_m, parts.ranging_time_s, ranging.now()),
        (ranging::ionosphere_m(parts.ionosphere_sigma_m, elevation), parts.ionosphere_time_s, ionosphere.now()),
        (ranging::troposphere_m(parts.troposphere_sigma_m, elevation), parts.troposphere_time_s, troposphere),
        (parts.multipath_share * ranging::multipath_m(elevation), parts.multipath_time_s, multipath.now()),
    ];
    let code_m = delay.iter().map(|(sigma, _, x)| sigma * x).sum();
    let variance: f64 = delay.iter().map(|(sigma, ..)| sigma * sigma).sum();
    let weighted: f64 = delay.iter().map(|(sigma, tau, _)| sigma * sigma * tau).sum();
    let [r, i, t, _] = delay.map(|(sigma, _, x)| sigma * x);
    let correlation_time_s = if variance > 0.0 { weighted / variance } else { 1.0 };
    Slow { code_m, phase_m: r - i + t, sigma_m: variance.sqrt(), correlation_time_s }
}

/// What faults add to a satellite's range \[m\] and range rate \[m/s\].
fn faulty(faults: &[SensorFault], id: SatelliteId, time_s: f64) -> [f64; 2] {
    let mut added = [0.0; 2];
    for fault in faults {
        let among = match fault {
            SensorFault::SatellitesStep { satellites, .. } | SensorFault::SatellitesRamp { satellites, .. } => {
                satellites.iter().any(|name| is_of(name, id))
            }
            _ => fault.satellite() == Some(id),
        };
        match (fault, fault.since(time_s).filter(|_| among)) {
            (SensorFault::SatelliteStep { step_m, .. } | SensorFault::SatellitesStep { step_m, .. }, Some(_)) => added[0] += step_m,
            (SensorFault::SatelliteRamp { rate_mps, .. } | SensorFault::SatellitesRamp { rate_mps, .. }, Some(since)) => {
                added[0] += rate_mps * since;
                added[1] += rate_mps;
            }
            _ => {}
        }
    }
    added
}

/// Where the antenna seems to be: a spoofer puts it elsewhere.
struct Seen {
    receiver: Vector3<f64>,
    velocity_mps: Vector3<f64>,
    observer: Observer,
}

impl Seen {
    fn new(motion: &Motion, faults: &[SensorFault], time_s: f64) -> Result<Self, OutOfDomain> {
        let v = motion.velocity_ned_mps;
        let ground = v.x.hypot(v.y);
        let (mut offset, mut drift) = (Vector3::zeros(), Vector3::zeros());
        for fault in faults {
            if let (SensorFault::Spoofing { right_mps, up_mps, rates, .. }, Some(since)) = (fault, fault.since(time_s)) {
                let pull = Vector3::new(right_mps * v.x / ground, -right_mps * v.y / ground, *up_mps);
                if *rates {
                    drift += pull;
                }
                offset += pull * since;
            }
        }
        let position = motion.position.moved(&Displacement::from_vector(offset))?;
        let ecef_from_enu = enu_from_ecef(&position.point).transpose();
        let velocity_mps = ecef_from_enu * (Vector3::new(v.y, v.x, -v.z) + drift);
        Ok(Self { receiver: *ecef_from_geodetic(&position).vector(), velocity_mps, observer: Observer::new(&position) })
    }

    fn rate(&self, sent: &Sent) -> f64 {
        let line = (sent.position.vector() - self.receiver) / sent.range_m;
        line.dot(&(sent.velocity_mps - self.velocity_mps))
    }
}
