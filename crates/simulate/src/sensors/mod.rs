//! What the aircraft's sensors deliver on a flight: inertial increments and the measurements that aid a filter.
//!
//! A flight is walked sample by sample and holds nothing of what has passed, so that many flights fit into memory:
//!
//! ```text
//! let sensing = Sensing::new(scenario, None)?;
//! let trajectory = sensing.trajectory(seed, number)?;
//! let mut flight = sensing.flight(&trajectory, seed, number)?;
//! while let Some(step) = flight.advance()? { propagate(&step.imu); for aid in flight.aiding() { update(aid) } }
//! ```
//!
//! Every sensor, satellite, station and axis draws from a stream of its own, so leaving one out changes no other.

mod altimeter;
mod clock;
mod faults;
mod inertial;
mod markov;
mod receiver;
mod receiver_faults;
mod settings;
mod sky;
mod stations;
mod unit_faults;

pub(crate) use clock::ReceiverClock;
pub(crate) use markov::{Markov, correlated_error};
pub(crate) use sky::Satellite;

pub use faults::{ReceiverFault, SensorFault, Trouble};
pub use settings::{Baro, Coverage, Dme, Envelope, Gnss, Imu, PathFlown, RangeMode, RangeParts, Sensors, Station, StationKind, Vor};

use crate::flight::fly;
use crate::navigator::Navigator;
use crate::outlook::Outlook;
use crate::plan::Refused;
use crate::scenario::{Scenario, System, kept};
use crate::trajectory::{Motion, Trajectory};
use altimeter::Altimeter;
use inertial::{InertialUnit, TrueIncrements};
use navbound_core::geometry::Elements;
use navbound_core::quantity::{GpsTime, OutOfDomain};
use navbound_core::signal::{Ephemeris, ImuIncrement, PhaseRange, SatelliteId, TimedAiding};
use receiver::Receiver;
use receiver_faults::ReceiverFaults;
use stations::{Bearings, Interrogator};
use unit_faults::UnitFaults;

/// A scenario's sensors, ready for any flight.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensing {
    outlook: Outlook,
    sensors: Sensors,
    satellites: Vec<Satellite>,
}

/// One sample of the inertial unit, and the truth at its end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// What the inertial unit delivers.
    pub imu: ImuIncrement,
    /// Whether it does: a declared fault may silence it.
    pub delivered: bool,
    /// The true motion at the end of the sample.
    pub truth: Motion,
}

impl Sensing {
    /// From a scenario with sensors, its satellites nominal or from broadcast records.
    ///
    /// # Errors
    /// As [`Outlook::new`]; [`OutOfDomain`] for a scenario without sensors or records that do not cover the flight.
    pub fn new(scenario: Scenario, broadcast: Option<&[Ephemeris]>) -> Result<Self, Refused> {
        Self::of(scenario, |scenario, systems| sky::satellites(scenario, systems, broadcast))
    }

    /// From a scenario with sensors and the satellites of an almanac, their elements at the begin of the flight. Those of constellations
    /// that the receiver does not use are left out.
    ///
    /// # Errors
    /// As [`Outlook::new`]; [`OutOfDomain`] for a scenario without sensors, elements that are no orbit, or no satellite that is used.
    pub fn with_orbits(scenario: Scenario, orbits: &[(SatelliteId, Elements)]) -> Result<Self, Refused> {
        Self::of(scenario, |_, systems| sky::of_elements(orbits, systems))
    }

    fn of(
        scenario: Scenario,
        satellites: impl FnOnce(&Scenario, &[System]) -> Result<Vec<Satellite>, OutOfDomain>,
    ) -> Result<Self, Refused> {
        let Some(sensors) = scenario.sensors.clone() else {
            let domain = "a scenario with a [sensors] part";
            return Err(OutOfDomain { argument: "sensors", value: 0.0, unit: "tables", domain }.into());
        };
        let outlook = Outlook::new(scenario)?;
        let satellites = match &sensors.gnss {
            Some(gnss) => satellites(&outlook.scenario, &gnss.constellations)?,
            None => Vec::new(),
        };
        if let Some(fault) = sensors.faults.iter().find(|f| f.satellite().is_some_and(|id| satellites.iter().all(|s| s.id != id))) {
            let domain = "names of satellites of the receiver's constellations";
            let number = fault.satellite().map_or(f64::NAN, |id| f64::from(id.number));
            return Err(OutOfDomain { argument: "satellite", value: number, unit: "number", domain }.into());
        }
        Ok(Self { outlook, sensors, satellites })
    }

    /// What all flights share besides the sensors.
    pub fn outlook(&self) -> &Outlook {
        &self.outlook
    }

    /// The filter on board, if there is one.
    pub fn navigator(&self) -> Option<Navigator> {
        self.outlook.scenario.filter
    }

    /// The settings.
    pub fn sensors(&self) -> &Sensors {
        &self.sensors
    }

    /// The path of a flight.
    ///
    /// # Errors
    /// As [`Trajectory::planned`].
    pub fn trajectory(&self, seed: u64, number: u64) -> Result<Trajectory, OutOfDomain> {
        match self.sensors.path {
            PathFlown::Planned => Trajectory::planned(&self.outlook),
            PathFlown::Flown => Trajectory::flown(&self.outlook, &fly(&self.outlook, seed, number)?),
        }
    }

    /// The sensors on a flight along a path, at its begin.
    ///
    /// # Errors
    /// [`OutOfDomain`] for a station off the Earth.
    pub fn flight<'a>(&'a self, trajectory: &'a Trajectory, seed: u64, number: u64) -> Result<SensedFlight<'a>, OutOfDomain> {
        let (s, rate_hz) = (&self.sensors, self.sensors.rate_hz);
        let rate = f64::from(rate_hz);
        let begin = GpsTime::from_nanoseconds(self.outlook.scenario.start_ns);
        let bare = SensedFlight::bare(trajectory, begin, (&s.imu, rate_hz), &s.faults, (seed, number))?;
        let departure_m = bare.now().position.height.m();
        let every = |interval_s: f64| (interval_s * rate).round() as u64;
        let dme = s.dme.as_ref().map(|d| Interrogator::new(d, s, seed, number).map(|i| (every(d.interval_s), i))).transpose()?;
        let vor = s.vor.as_ref().map(|v| Bearings::new(v, s, seed, number).map(|b| (every(v.interval_s), b))).transpose()?;
        let receiver = |g| Receiver::new(g, &self.satellites, &s.faults, begin, seed, number);
        Ok(SensedFlight {
            gnss: s.gnss.as_ref().map(|g| (every(g.interval_s), receiver(g))),
            dme,
            vor,
            baro: s.baro.as_ref().map(|b| (every(b.interval_s), Altimeter::new(b, &s.faults, departure_m, 1.0 / rate, seed, number))),
            ..bare
        })
    }
}

/// Sensors on a flight, each with the samples of the inertial unit between its measurements.
pub struct SensedFlight<'a> {
    unit_faults: UnitFaults,
    receiver_faults: ReceiverFaults,
    begin: GpsTime,
    interval_ns: i64,
    samples: u64,
    next: u64,
    truth: TrueIncrements<'a>,
    imu: InertialUnit,
    gnss: Option<(u64, Receiver<'a>)>,
    dme: Option<(u64, Interrogator<'a>)>,
    vor: Option<(u64, Bearings<'a>)>,
    baro: Option<(u64, Altimeter<'a>)>,
    aiding: Vec<TimedAiding>,
}

impl<'a> SensedFlight<'a> {
    /// An inertial unit alone on a path; `unit` is it and its samples a second, `draw` the seed and the number of the flight.
    ///
    /// # Errors
    /// [`OutOfDomain`] for errors or a rate outside their domains, a position that leaves the Earth's latitudes.
    pub fn inertial(
        trajectory: &'a Trajectory,
        begin: GpsTime,
        (imu, rate_hz): (&Imu, u32),
        (seed, number): (u64, u64),
    ) -> Result<Self, OutOfDomain> {
        kept(imu.rules(rate_hz))?;
        Self::bare(trajectory, begin, (imu, rate_hz), &[], (seed, number))
    }

    /// Without anything that measures against the ground.
    fn bare(
        trajectory: &'a Trajectory,
        begin: GpsTime,
        (imu, rate_hz): (&Imu, u32),
        faults: &'a [SensorFault],
        (seed, number): (u64, u64),
    ) -> Result<Self, OutOfDomain> {
        Ok(Self {
            unit_faults: UnitFaults::new(imu, faults, seed, number),
            receiver_faults: ReceiverFaults::new(faults),
            begin,
            interval_ns: 1_000_000_000 / i64::from(rate_hz),
            // A product of two written numbers may fall short of a whole one by its last digit.
            samples: (trajectory.duration_s() * f64::from(rate_hz) + 1e-6) as u64,
            next: 1,
            truth: TrueIncrements::new(trajectory, rate_hz)?,
            imu: InertialUnit::new(imu, rate_hz, faults, seed, number),
            gnss: None,
            dme: None,
            vor: None,
            baro: None,
            aiding: Vec::new(),
        })
    }
}

impl SensedFlight<'_> {
    /// Time of the begin.
    pub fn begin(&self) -> GpsTime {
        self.begin
    }

    /// The true motion at the begin of the next sample.
    pub fn now(&self) -> &Motion {
        self.truth.now()
    }

    /// Samples of the inertial unit in the whole flight.
    pub fn samples(&self) -> u64 {
        self.samples
    }

    /// The next sample; `None` after the last.
    ///
    /// # Errors
    /// [`OutOfDomain`] for a position that leaves the Earth's latitudes.
    pub fn advance(&mut self) -> Result<Option<Step>, OutOfDomain> {
        if self.next > self.samples {
            self.aiding.clear();
            return Ok(None);
        }
        let index = self.next;
        self.next += 1;
        let since_ns = index as i64 * self.interval_ns;
        let time = GpsTime::from_nanoseconds(self.begin.nanoseconds() + since_ns);
        let (angle, velocity, truth) = self.truth.step()?;
        let time_s = since_ns as f64 * 1e-9;
        let sample = self.imu.sample(index, time, &angle, &velocity);
        let delivered = self.unit_faults.delivered(index, time_s, sample);
        self.aid(index, time_s, time, &truth)?;
        Ok(Some(Step { imu: delivered.unwrap_or(sample), delivered: delivered.is_some(), truth }))
    }

    fn aid(&mut self, index: u64, time_s: f64, time: GpsTime, truth: &Motion) -> Result<(), OutOfDomain> {
        self.aiding.clear();
        self.receiver_faults.follow(time_s, truth);
        if let Some((every, receiver)) = &mut self.gnss
            && index.is_multiple_of(*every)
        {
            let (then_s, motion) = self.receiver_faults.measured(time_s, truth);
            receiver.measure(then_s, &motion, &mut self.aiding)?;
            self.receiver_faults.deliver(time_s, time, &mut self.aiding);
        }
        if let Some((every, dme)) = &mut self.dme
            && index.is_multiple_of(*every)
        {
            dme.measure(time_s, time, truth, &mut self.aiding)?;
        }
        if let Some((every, vor)) = &mut self.vor
            && index.is_multiple_of(*every)
        {
            vor.measure(time_s, time, truth, &mut self.aiding)?;
        }
        if let Some((every, baro)) = &mut self.baro {
            baro.follow(time_s, truth.position.height.m());
            if index.is_multiple_of(*every) {
                baro.measure(time_s, time, &mut self.aiding);
            }
        }
        Ok(())
    }

    /// Measurements that hold at the end of the last sample.
    pub fn aiding(&self) -> &[TimedAiding] {
        &self.aiding
    }

    /// Accumulated carrier phases of the last measurement of the satellite receiver.
    pub fn phases(&self) -> &[PhaseRange] {
        self.gnss.as_ref().map_or(&[], |(_, receiver)| receiver.phases())
    }

    /// Whether the satellite receiver measured at the end of the last sample, even if it heard nothing.
    pub fn received(&self) -> bool {
        self.gnss.as_ref().is_some_and(|(every, _)| self.next > 1 && (self.next - 1).is_multiple_of(*every))
    }

    /// True offset \[m\] and drift \[m/s\] of the satellite receiver's clock at its last measurement.
    pub fn clock(&self) -> Option<[f64; 2]> {
        self.gnss.as_ref().map(|(_, receiver)| receiver.clock())
    }
}
