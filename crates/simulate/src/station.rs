//! What a receiver that stands measures: ranges, phases, Doppler and strengths, and the broadcast records that they go with.
//!
//! The records define the orbits: a satellite is where its record says, so that a reader of both files is wrong by what is added to the
//! ranges and by nothing else.

use crate::philox::{Sensor, Stream};
use crate::sensors::{Markov, Satellite};
use core::f64::consts::PI;
use navbound_core::frame::{Geodetic, ecef_from_geodetic};
use navbound_core::geometry::atmosphere::{ionosphere_factor, klobuchar, saastamoinen};
use navbound_core::geometry::broadcast::{Broadcast, EARTH_RATE, gravitation_m3ps2};
use navbound_core::geometry::{Direction, Elements, Observer, Slot};
use navbound_core::quantity::{GpsTime, OutOfDomain, Radians};
use navbound_core::signal::{Carrier, Constellation, Ephemeris, Health, Klobuchar, Message, SPEED_OF_LIGHT_MPS, SatelliteId, nearest};

/// Time between broadcast records \[s\], and their reference time after the full period.
const RENEWAL_S: i64 = 7200;
const WEEK_NS: i64 = 604_800_000_000_000;
/// Precession of the node of a medium orbit \[rad/s\]: what GPS satellites broadcast. Typical; ours.
const NODE_RATE: f64 = -8.0e-9;
/// Correlation times: signal in space, ionosphere, troposphere, multipath \[s\]. Ours.
const TIMES_S: [f64; 4] = [3600.0, 1800.0, 3600.0, 60.0];
/// Deviations: signal in space \[m\], shares of the modelled ionosphere and troposphere \[1\]. Ours.
const SIGNAL_IN_SPACE_M: f64 = 0.6;
const IONOSPHERE_SHARE: f64 = 0.25;
const TROPOSPHERE_SHARE: f64 = 0.03;
/// White noise of code \[m\], phase \[m\] and Doppler \[Hz\]. Ours.
const CODE_NOISE_M: f64 = 0.25;
const PHASE_NOISE_M: f64 = 0.002;
const DOPPLER_NOISE_HZ: f64 = 0.05;
/// The receiver's clock: offset \[m\] and rate \[m/s\]. Ours.
const CLOCK_M: f64 = 3000.0;
const CLOCK_MPS: f64 = 0.4;

/// The ionosphere that the satellites broadcast: the example of a quiet afternoon of the GPS service.
pub const IONOSPHERE: Klobuchar =
    Klobuchar { alpha: [1.118e-8, 1.490e-8, -5.960e-8, -1.192e-7], beta: [9.011e4, 1.638e4, -1.966e5, -6.554e4] };

/// An error of one satellite's ranges for a while.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WrongRange {
    /// Whose.
    pub satellite: SatelliteId,
    /// From and until \[s\] after the first epoch.
    pub during_s: [f64; 2],
    /// At once \[m\], and growing \[m/s\].
    pub step_m: f64,
    /// See `step_m`.
    pub ramp_mps: f64,
}

/// A receiver that stands, and what happens to it.
#[derive(Debug, Clone, PartialEq)]
pub struct RawStation {
    /// Its antenna.
    pub place: Geodetic,
    /// First epoch.
    pub begin: GpsTime,
    /// Between epochs \[s\].
    pub step_s: f64,
    /// How many.
    pub n_epochs: usize,
    /// Every random number follows from it.
    pub seed: u64,
    /// Below, nothing is received.
    pub mask: Radians,
    /// From and until \[s\] after the first epoch: nothing is received.
    pub outages_s: Vec<[f64; 2]>,
    /// Satellites that range wrongly.
    pub wrong: Vec<WrongRange>,
}

/// One signal as measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// Pseudorange \[m\].
    pub range_m: f64,
    /// Carrier phase \[cycles\].
    pub phase_cycles: f64,
    /// Doppler, positive for a satellite that comes nearer \[Hz\].
    pub doppler_hz: f64,
    /// Carrier to noise density \[dB-Hz\].
    pub cn0_dbhz: f64,
    /// The count of cycles begins anew.
    pub lost: bool,
}

/// One satellite at one epoch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Heard {
    /// Which.
    pub satellite: SatelliteId,
    /// On its [`carriers`].
    pub signals: [Measured; 2],
}

/// An epoch: its time by the receiver, the receiver's clock minus GPS time \[m\], and what is heard.
#[derive(Debug, Clone, PartialEq)]
pub struct RawEpoch {
    /// Of the receiver, corrected by nothing.
    pub time: GpsTime,
    /// Clock.
    pub clock_m: f64,
    /// Satellites by constellation and number.
    pub heard: Vec<Heard>,
}

/// The two carriers that are measured of a constellation: those that its message's clock serves.
pub const fn carriers(constellation: Constellation) -> [Carrier; 2] {
    [Carrier::L1, if matches!(constellation, Constellation::Gps) { Carrier::L2 } else { Carrier::L5 }]
}

/// Broadcast records of nominal satellites that cover a time: I/NAV for Galileo, LNAV for GPS.
///
/// Elements stand in the units of the message, so that a record written with its digits is the same record.
pub fn broadcast(slots: &[Slot], begin: GpsTime, duration_s: f64, seed: u64) -> Vec<Ephemeris> {
    let period = RENEWAL_S * 1_000_000_000;
    let first = begin.nanoseconds().div_euclid(period) * period;
    let last = begin.plus_seconds(duration_s).nanoseconds();
    let mut records = Vec::new();
    for slot in slots {
        let own = Own::new(slot, begin, seed);
        records.extend((0..).map(|k| first + k * period).take_while(|t| *t <= last + period / 2).map(|t| own.record(t)));
    }
    records
}

/// What a satellite keeps from record to record.
struct Own {
    satellite: SatelliteId,
    elements: Elements,
    reference: GpsTime,
    mean_motion: f64,
    delta_n: f64,
    clock: [f64; 2],
    /// Of latitude and radius: cosine, sine.
    harmonics: [f64; 4],
}

fn quantised(value: f64, exponent: i32) -> f64 {
    let unit = 2.0_f64.powi(exponent);
    (value / unit).round() * unit
}

/// An angle within half a turn, in the message's units of a semicircle.
fn angle(value: f64) -> f64 {
    let semicircles = value / PI;
    quantised(semicircles - 2.0 * (semicircles / 2.0).round(), -31) * PI
}

impl Own {
    fn new(slot: &Slot, reference: GpsTime, seed: u64) -> Self {
        let unit = u64::from(slot.satellite.number) + 1000 * slot.satellite.constellation.index() as u64;
        let mut drawn = Stream::of_unit(seed, 0, Sensor::SystemBias, unit);
        let mut elements = slot.elements;
        elements.eccentricity = quantised(0.002 + 0.003 * drawn.normal().abs().min(3.0), -33);
        elements.perigee = Radians::new(angle(drawn.normal()));
        elements.mean_anomaly = Radians::new(slot.elements.mean_anomaly.rad() - elements.perigee.rad());
        let root = quantised(slot.elements.semi_major.m().sqrt(), -19);
        let mean_motion = (gravitation_m3ps2(slot.satellite.constellation) / root.powi(6)).sqrt();
        Self {
            satellite: slot.satellite,
            elements,
            reference,
            mean_motion,
            delta_n: quantised(4.5e-9 / PI, -43) * PI,
            clock: [quantised(2e-4 * drawn.normal(), -31), quantised(3e-12 * drawn.normal(), -43)],
            harmonics: [-1e-6, 5e-6, 250.0, -20.0].map(|size: f64| size * (1.0 + 0.2 * drawn.normal())),
        }
    }

    fn record(&self, orbit_ns: i64) -> Ephemeris {
        let orbit_time = GpsTime::from_nanoseconds(orbit_ns);
        let later = orbit_time.seconds_since(self.reference);
        let gps = self.satellite.constellation == Constellation::Gps;
        let node_rate = quantised(NODE_RATE / PI, -43) * PI;
        let within_week = orbit_ns.rem_euclid(WEEK_NS) as f64 * 1e-9;
        // The record counts the node from Greenwich at the start of the week.
        let node = self.elements.node.rad() + (node_rate - EARTH_RATE) * later + EARTH_RATE * within_week;
        let issue = (orbit_ns / (RENEWAL_S * 1_000_000_000) % 240) as u16;
        Ephemeris {
            satellite: self.satellite,
            message: if gps { Message::Lnav } else { Message::Inav },
            clock_time: orbit_time,
            clock: [quantised(self.clock[0] + self.clock[1] * later, -31), self.clock[1], 0.0],
            orbit_time,
            sent: Some(GpsTime::from_nanoseconds(orbit_ns - RENEWAL_S * 1_000_000_000)),
            issue_orbit: issue,
            issue_clock: issue,
            sqrt_a: quantised(self.elements.semi_major.m().sqrt(), -19),
            eccentricity: self.elements.eccentricity,
            inclination: [angle(self.elements.inclination.rad()), 0.0],
            node: [angle(node), node_rate],
            perigee: self.elements.perigee.rad(),
            mean_anomaly: angle(self.elements.mean_anomaly.rad() + (self.mean_motion + self.delta_n) * later),
            delta_n: self.delta_n,
            latitude_harmonics: [quantised(self.harmonics[0], -29), quantised(self.harmonics[1], -29)],
            radius_harmonics: [quantised(self.harmonics[2], -5), quantised(self.harmonics[3], -5)],
            inclination_harmonics: [0.0, 0.0],
            accuracy_m: if gps { 2.0 } else { 3.12 },
            health: Health { word: 0 },
            group_delay_s: [0.0, 0.0],
            fit_interval_s: if gps { 14_400.0 } else { 28_800.0 },
        }
    }
}

/// Errors that a satellite keeps for a while, and its count of cycles.
struct Channel {
    signal_in_space: Markov,
    ionosphere: Markov,
    multipath: [Markov; 2],
    code: Stream,
    phase: Stream,
    doppler: Stream,
    cycles: [f64; 2],
    heard: bool,
}

impl Channel {
    fn new(station: &RawStation, satellite: SatelliteId) -> Self {
        let unit = u64::from(satellite.number) + 1000 * satellite.constellation.index() as u64;
        let stream = |sensor| Stream::of_unit(station.seed, 0, sensor, unit);
        let second = |sensor| Stream::of_unit(station.seed, 1, sensor, unit);
        let markov = |stream, k: usize| Markov::new(stream, station.step_s, TIMES_S[k]);
        let mut code = stream(Sensor::CodeNoise);
        // Whole cycles, as a receiver begins to count somewhere.
        let cycles = [(1e5 * code.normal()).round(), (1e5 * code.normal()).round()];
        Self {
            signal_in_space: markov(stream(Sensor::SignalInSpace), 0),
            ionosphere: markov(stream(Sensor::Ionosphere), 1),
            multipath: [markov(stream(Sensor::Multipath), 3), markov(second(Sensor::Multipath), 3)],
            code,
            phase: stream(Sensor::PhaseNoise),
            doppler: stream(Sensor::DopplerNoise),
            cycles,
            heard: false,
        }
    }

    fn step(&mut self) {
        self.signal_in_space.step();
        self.ionosphere.step();
        self.multipath.iter_mut().for_each(Markov::step);
    }
}

/// Deviation of multipath by elevation \[m\]: RTCA DO-229, J.2.4, of airborne antennas; standard.
fn multipath_m(elevation: f64) -> f64 {
    0.13 + 0.53 * (-elevation.to_degrees() / 10.0).exp()
}

/// What a station hears of satellites with these records, epoch after epoch.
///
/// # Errors
/// [`OutOfDomain`] for a step that is not positive, and for directions of places that are none.
pub fn hear(station: &RawStation, records: &[Ephemeris]) -> Result<Vec<RawEpoch>, OutOfDomain> {
    if !(station.step_s > 0.0 && station.step_s.is_finite()) {
        return Err(OutOfDomain { argument: "step_s", value: station.step_s, unit: "s", domain: "(0, inf)" });
    }
    let satellites = Satellite::of_records(records);
    let mut sky: Vec<(Satellite, Vec<Ephemeris>, Channel)> = satellites
        .into_iter()
        .map(|s| {
            let own: Vec<Ephemeris> = records.iter().filter(|r| r.satellite == s.id).copied().collect();
            let channel = Channel::new(station, s.id);
            (s, own, channel)
        })
        .collect();
    let mut air = Markov::new(Stream::new(station.seed, 0, Sensor::Troposphere), station.step_s, TIMES_S[2]);
    let mut epochs = Vec::new();
    for k in 0..station.n_epochs {
        let epoch = one(station, k as f64 * station.step_s, air.now(), &mut sky)?;
        epochs.extend((!epoch.heard.is_empty()).then_some(epoch));
        air.step();
        sky.iter_mut().for_each(|(_, _, channel)| channel.step());
    }
    Ok(epochs)
}

fn one(station: &RawStation, since_s: f64, air: f64, sky: &mut [(Satellite, Vec<Ephemeris>, Channel)]) -> Result<RawEpoch, OutOfDomain> {
    let clock_m = CLOCK_M + CLOCK_MPS * since_s;
    // The receiver's clock is fast: it measures before its reading.
    let truly_s = since_s - clock_m / SPEED_OF_LIGHT_MPS;
    let silent = station.outages_s.iter().any(|[from, until]| since_s >= *from && since_s < *until);
    let (mut heard, observer) = (Vec::new(), Observer::new(&station.place));
    let receiver = *ecef_from_geodetic(&station.place).vector();
    for (satellite, records, channel) in sky.iter_mut() {
        let now = station.begin.plus_seconds(truly_s);
        let sent = satellite.sent(station.begin, truly_s, &receiver);
        let direction = sent.as_ref().map(|s| observer.direction(&s.position)).transpose()?;
        let above = direction.as_ref().is_some_and(|d| d.elevation().rad() >= station.mask.rad());
        let record = nearest(records, now).and_then(|n| Broadcast::new(&records[n]).ok());
        let (Some(sent), Some(direction), Some(record), true) = (sent, direction, record, above && !silent) else {
            channel.heard = false;
            continue;
        };
        let way_s = sent.range_m / SPEED_OF_LIGHT_MPS;
        let state = record.state(now.plus_seconds(-way_s));
        let line = (sent.position.vector() - receiver) / sent.range_m;
        let extra = fault(station, satellite.id, since_s) + SIGNAL_IN_SPACE_M * channel.signal_in_space.now();
        let sight = Sight {
            carriers: carriers(satellite.id.constellation),
            geometric_m: sent.range_m + clock_m - SPEED_OF_LIGHT_MPS * state.clock_s + extra + delay(station, &direction, air),
            ionosphere_m: klobuchar(&IONOSPHERE, &station.place, &direction, now).m() * (1.0 + IONOSPHERE_SHARE * channel.ionosphere.now()),
            rate_mps: line.dot(&sent.velocity_mps) + CLOCK_MPS - SPEED_OF_LIGHT_MPS * state.clock_drift,
            elevation: direction.elevation().rad(),
        };
        let signals = sight.signals(channel);
        heard.push(Heard { satellite: satellite.id, signals });
    }
    Ok(RawEpoch { time: station.begin.plus_seconds(since_s), clock_m, heard })
}

fn delay(station: &RawStation, direction: &Direction, air: f64) -> f64 {
    saastamoinen(&station.place, direction).m() * (1.0 + TROPOSPHERE_SHARE * air)
}

fn fault(station: &RawStation, satellite: SatelliteId, since_s: f64) -> f64 {
    let own = station.wrong.iter().filter(|w| w.satellite == satellite && since_s >= w.during_s[0] && since_s < w.during_s[1]);
    own.map(|w| w.step_m + w.ramp_mps * (since_s - w.during_s[0])).sum()
}

/// What both signals of a satellite share.
struct Sight {
    carriers: [Carrier; 2],
    geometric_m: f64,
    /// On L1.
    ionosphere_m: f64,
    rate_mps: f64,
    elevation: f64,
}

impl Sight {
    fn signals(&self, channel: &mut Channel) -> [Measured; 2] {
        let lost = !channel.heard;
        channel.heard = true;
        [0, 1].map(|k| {
            let carrier = self.carriers[k];
            let delay = self.ionosphere_m * ionosphere_factor(carrier);
            let wavelength = carrier.wavelength_m();
            let noise = CODE_NOISE_M * channel.code.normal() + multipath_m(self.elevation) * channel.multipath[k].now();
            Measured {
                range_m: self.geometric_m + delay + noise,
                phase_cycles: (self.geometric_m - delay + PHASE_NOISE_M * channel.phase.normal()) / wavelength + channel.cycles[k],
                doppler_hz: -self.rate_mps / wavelength + DOPPLER_NOISE_HZ * channel.doppler.normal(),
                // An antenna without gain at the horizon: 35 to 50 dB-Hz.
                cn0_dbhz: 35.0 + 15.0 * self.elevation.sin(),
                lost,
            }
        })
    }
}

#[cfg(test)]
#[path = "station_tests.rs"]
mod tests;
