//! Satellites and where they are: nominal orbits, or what satellites broadcast.

use crate::scenario::{Scenario, System};
use nalgebra::Vector3;
use navbound_core::frame::EcefPosition;
use navbound_core::geometry::broadcast::{Broadcast, in_axes_of_reception};
use navbound_core::geometry::{Elements, Orbit};
use navbound_core::quantity::{GpsTime, OutOfDomain};
use navbound_core::signal::{Carrier, Constellation, Ephemeris, Message, SPEED_OF_LIGHT_MPS, SatelliteId, nearest};

/// A satellite with its orbit.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Satellite {
    pub(crate) id: SatelliteId,
    source: Source,
}

#[derive(Debug, Clone, PartialEq)]
enum Source {
    /// Seconds count from the begin of the flight.
    Nominal(Box<Orbit>),
    /// Records in the order of their reference times.
    Broadcast { records: Vec<Ephemeris>, orbits: Vec<Broadcast> },
}

/// A satellite as its signal was sent, in the Earth-fixed axes of reception.
pub(crate) struct Sent {
    pub(crate) position: EcefPosition,
    pub(crate) velocity_mps: Vector3<f64>,
    /// Length of the signal's way \[m\].
    pub(crate) range_m: f64,
}

/// A first guess of the signal's way that every medium orbit meets within a tenth \[s\].
const WAY_S: f64 = 0.08;

impl Satellite {
    /// At a time after the begin of the flight; `None` when no record covers it.
    fn state(&self, begin: GpsTime, time_s: f64) -> Option<(Vector3<f64>, Vector3<f64>)> {
        match &self.source {
            Source::Nominal(orbit) => Some(orbit.state(time_s)),
            Source::Broadcast { records, orbits } => {
                let time = begin.plus_seconds(time_s);
                let state = orbits[nearest(records, time)?].state(time);
                Some((*state.position.vector(), state.velocity_mps))
            }
        }
    }

    /// Satellites of records that stand in the order of satellite and reference time; those that describe no orbit are left out.
    pub(crate) fn of_records(records: &[Ephemeris]) -> Vec<Self> {
        let mut all = Vec::new();
        for own in records.chunk_by(|a, b| a.satellite == b.satellite) {
            let orbits: Result<Vec<Broadcast>, _> = own.iter().map(Broadcast::new).collect();
            all.extend(
                orbits.ok().map(|orbits| Self { id: own[0].satellite, source: Source::Broadcast { records: own.to_vec(), orbits } }),
            );
        }
        all
    }

    /// How a receiver at a position sees it; `None` when no record covers the time.
    pub(crate) fn sent(&self, begin: GpsTime, time_s: f64, receiver: &Vector3<f64>) -> Option<Sent> {
        let mut way_s = WAY_S;
        let mut seen = self.state(begin, time_s - way_s)?;
        // The way changes by some 1e-6 of itself in a round: two leave a micrometre.
        for _ in 0..2 {
            way_s = (in_axes_of_reception(&seen.0, way_s) - receiver).norm() / SPEED_OF_LIGHT_MPS;
            seen = self.state(begin, time_s - way_s)?;
        }
        let position = in_axes_of_reception(&seen.0, way_s);
        let velocity_mps = in_axes_of_reception(&seen.1, way_s);
        Some(Sent { range_m: (position - receiver).norm(), position: EcefPosition::from_vector(position), velocity_mps })
    }

    /// Whether it may stand above the horizon: a cheap look at the begin of the signal's way.
    pub(crate) fn rises(&self, begin: GpsTime, time_s: f64, receiver: &Vector3<f64>) -> bool {
        // The zenith of the ellipsoid leans 0.2 degrees away from the radius at most; three degrees are room enough for that and the way.
        self.state(begin, time_s).is_some_and(|(p, _)| {
            let line = p - receiver;
            line.dot(receiver) > -0.05 * line.norm() * receiver.norm()
        })
    }
}

/// The satellites of a scenario: nominal, or from broadcast records.
pub(crate) fn satellites(scenario: &Scenario, systems: &[System], broadcast: Option<&[Ephemeris]>) -> Result<Vec<Satellite>, OutOfDomain> {
    match broadcast {
        None => nominal(systems, scenario.start_ns as f64 * 1e-9),
        Some(records) => from_records(records, systems, scenario),
    }
}

fn nominal(systems: &[System], start_s: f64) -> Result<Vec<Satellite>, OutOfDomain> {
    let mut satellites = Vec::new();
    for slot in systems.iter().flat_map(|s| s.slots()) {
        let orbit = Orbit::new(slot.elements.moved(start_s)?)?;
        satellites.push(Satellite { id: slot.satellite, source: Source::Nominal(Box::new(orbit)) });
    }
    Ok(satellites)
}

/// Satellites of the constellations in use, by their elements at the begin of the flight.
pub(crate) fn of_elements(orbits: &[(SatelliteId, Elements)], systems: &[System]) -> Result<Vec<Satellite>, OutOfDomain> {
    let used = |id: SatelliteId| systems.iter().any(|s| s.constellation() == id.constellation);
    let mut satellites = Vec::new();
    for (id, elements) in orbits.iter().filter(|(id, _)| used(*id)) {
        satellites.push(Satellite { id: *id, source: Source::Nominal(Box::new(Orbit::new(*elements)?)) });
    }
    if satellites.is_empty() {
        let domain = "satellites of the receiver's constellations";
        return Err(OutOfDomain { argument: "orbits", value: orbits.len() as f64, unit: "satellites", domain });
    }
    Ok(satellites)
}

/// Healthy satellites with a record that covers some instant of the flight.
fn from_records(records: &[Ephemeris], systems: &[System], scenario: &Scenario) -> Result<Vec<Satellite>, OutOfDomain> {
    let requested: Vec<Constellation> = systems.iter().map(|s| s.constellation()).collect();
    let mut usable: Vec<Ephemeris> =
        records.iter().filter(|r| requested.contains(&r.satellite.constellation) && usable(r)).copied().collect();
    usable.sort_by_key(|r| (r.satellite, r.orbit_time));
    let (begin, end) = (GpsTime::from_nanoseconds(scenario.start_ns), scenario.duration_s);
    let covered = |id: SatelliteId| usable.iter().any(|r| r.satellite == id && (r.covers(begin) || r.covers(begin.plus_seconds(end))));
    let satellites: Vec<Satellite> = Satellite::of_records(&usable).into_iter().filter(|s| covered(s.id)).collect();
    if satellites.is_empty() {
        let domain = "records of healthy satellites that cover the flight";
        return Err(OutOfDomain { argument: "navigation", value: records.len() as f64, unit: "records", domain });
    }
    Ok(satellites)
}

fn usable(record: &Ephemeris) -> bool {
    let carrier = match record.message {
        Message::Lnav | Message::Inav => Carrier::L1,
        Message::D1 | Message::D2 => Carrier::B1I,
        // A second message of a satellite that another already describes.
        Message::Fnav => return false,
    };
    record.healthy(carrier)
}
