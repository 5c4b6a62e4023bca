//! Ranges and bearings from stations on the ground.
//!
//! Usable is a station within the radio horizon, `4.12 (sqrt(h) + sqrt(h_station))` km with heights in metres (standard, from general
//! knowledge), and inside the coverage that the scenario states.

use super::faults::SensorFault;
use super::settings::{Coverage, Dme, Sensors, Station, Vor};
use crate::philox::{Sensor, Stream};
use crate::trajectory::Motion;
use navbound_core::frame::{EcefPosition, Geodetic, LatLon, ecef_from_geodetic};
use navbound_core::geometry::{Direction, Observer};
use navbound_core::quantity::{GpsTime, Metres, OutOfDomain, Radians};
use navbound_core::signal::{Aiding, DmeRange, TimedAiding, VorBearing};

/// Radio horizon over the root of the height \[m/√m\].
const HORIZON: f64 = 4120.0;

/// A station's place, worked out once.
struct Site<'a> {
    index: u16,
    name: &'a str,
    position: Geodetic,
    ecef: EcefPosition,
    observer: Observer,
    bias: f64,
    noise: Stream,
}

/// The aircraft as a station sees it.
struct Sight {
    slant_m: f64,
    direction: Direction,
}

impl<'a> Site<'a> {
    fn new(index: usize, station: &'a Station, mut bias: Stream, bias_sigma: f64, noise: Stream) -> Result<Self, OutOfDomain> {
        let point = LatLon::new(Radians::new(station.lat_rad), Radians::new(station.lon_rad))?;
        let position = Geodetic { point, height: Metres::new(station.height_m) };
        let (ecef, observer) = (ecef_from_geodetic(&position), Observer::new(&position));
        Ok(Self { index: index as u16, name: &station.name, position, ecef, observer, bias: bias_sigma * bias.normal(), noise })
    }

    fn sight(&self, aircraft: &EcefPosition) -> Result<Sight, OutOfDomain> {
        Ok(Sight { slant_m: aircraft.minus(&self.ecef).vector().norm(), direction: self.observer.direction(aircraft)? })
    }

    fn serves(&self, sight: &Sight, coverage: &Coverage, height_m: f64) -> bool {
        let horizon = HORIZON * (height_m.max(0.0).sqrt() + self.position.height.m().max(0.0).sqrt());
        sight.slant_m <= horizon
            && sight.slant_m >= coverage.range_least_m
            && sight.slant_m <= coverage.range_most_m
            && sight.direction.elevation().rad() <= coverage.elevation_most_rad
    }
}

/// The interrogator.
pub(crate) struct Interrogator<'a> {
    settings: &'a Dme,
    faults: &'a [SensorFault],
    sites: Vec<Site<'a>>,
}

impl<'a> Interrogator<'a> {
    pub(crate) fn new(settings: &'a Dme, sensors: &'a Sensors, seed: u64, flight: u64) -> Result<Self, OutOfDomain> {
        let site = |(i, s): (usize, &'a Station)| {
            let stream = |sensor| Stream::of_unit(seed, flight, sensor, i as u64);
            Site::new(i, s, stream(Sensor::DmeBias), settings.bias_sigma_m, stream(Sensor::DmeNoise))
        };
        let sites: Result<_, _> = sensors.stations.iter().enumerate().filter(|(_, s)| s.kind.ranges()).map(site).collect();
        Ok(Self { settings, faults: &sensors.faults, sites: sites? })
    }

    pub(crate) fn measure(&mut self, time_s: f64, time: GpsTime, motion: &Motion, out: &mut Vec<TimedAiding>) -> Result<(), OutOfDomain> {
        let aircraft = ecef_from_geodetic(&motion.position);
        for site in &mut self.sites {
            let white = site.noise.normal();
            let sight = site.sight(&aircraft)?;
            let out_of_service = self.faults.iter().any(|f| f.silences_station(site.name, time_s));
            if out_of_service || !site.serves(&sight, &self.settings.coverage, motion.position.height.m()) {
                continue;
            }
            let sigma = self.settings.noise_least_m.max(self.settings.noise_share * sight.slant_m);
            let wrong = |f: &SensorFault| match f {
                SensorFault::DmeBias { station, bias_m, .. } if station == site.name && f.since(time_s).is_some() => *bias_m,
                _ => 0.0,
            };
            let fault_m: f64 = self.faults.iter().map(wrong).sum();
            let multiple = |f: &SensorFault| match f {
                SensorFault::DmeBiases { factor, .. } => f.since(time_s).map(|_| *factor),
                _ => None,
            };
            let bias = site.bias * self.faults.iter().find_map(multiple).unwrap_or(1.0);
            let range = DmeRange {
                station: site.index,
                position: site.ecef,
                slant: Metres::new(sight.slant_m + bias + sigma * white + fault_m),
                sigma_white: Metres::new(sigma),
                sigma_bias: Metres::new(self.settings.bias_sigma_m),
            };
            out.push(TimedAiding { time, aiding: Aiding::Dme(range) });
        }
        Ok(())
    }
}

/// The receiver of bearings.
pub(crate) struct Bearings<'a> {
    settings: &'a Vor,
    faults: &'a [SensorFault],
    sites: Vec<Site<'a>>,
}

impl<'a> Bearings<'a> {
    pub(crate) fn new(settings: &'a Vor, sensors: &'a Sensors, seed: u64, flight: u64) -> Result<Self, OutOfDomain> {
        let site = |(i, s): (usize, &'a Station)| {
            let stream = |sensor| Stream::of_unit(seed, flight, sensor, i as u64);
            Site::new(i, s, stream(Sensor::VorBias), settings.bias_sigma_rad, stream(Sensor::VorNoise))
        };
        let sites: Result<_, _> = sensors.stations.iter().enumerate().filter(|(_, s)| s.kind.bears()).map(site).collect();
        Ok(Self { settings, faults: &sensors.faults, sites: sites? })
    }

    pub(crate) fn measure(&mut self, time_s: f64, time: GpsTime, motion: &Motion, out: &mut Vec<TimedAiding>) -> Result<(), OutOfDomain> {
        let aircraft = ecef_from_geodetic(&motion.position);
        for site in &mut self.sites {
            let white = site.noise.normal();
            let sight = site.sight(&aircraft)?;
            let out_of_service = self.faults.iter().any(|f| f.silences_station(site.name, time_s));
            if out_of_service || !site.serves(&sight, &self.settings.coverage, motion.position.height.m()) {
                continue;
            }
            let angle = sight.direction.azimuth().rad() + site.bias + self.settings.noise_sigma_rad * white;
            let bearing = VorBearing {
                station: site.index,
                position: site.position,
                bearing: Radians::new(angle.rem_euclid(core::f64::consts::TAU)),
                sigma_white: Radians::new(self.settings.noise_sigma_rad),
                sigma_bias: Radians::new(self.settings.bias_sigma_rad),
            };
            out.push(TimedAiding { time, aiding: Aiding::Vor(bearing) });
        }
        Ok(())
    }
}
