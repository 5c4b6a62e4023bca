//! The ground stations as a witness between two readings: the satellites are right and the inertial unit is wrong, or the other way round.
//!
//! The same ranges to DME are compared with the snapshot and with the filter without satellites. The unit is convicted only where the stations
//! agree with the one and rule out the other; a spoofer leads the snapshot away from them.
//!
//! ```text
//! Q = sum_i m_i^2 / v_i,   v_i = bias^2 + f white^2 + n u_i' P u_i         m_i: mean residual of station i of n
//! ```
//!
//! `n u' P u` bounds what the position's own error makes of all residuals together: M <= n diag(M) for a covariance M of n numbers.
//! Provenance: ours.

use crate::quantity::GpsTime;
use crate::signal::DmeRange;
use crate::special::gamma::chi_square_tail;
use nalgebra::{Matrix3, Vector3};

/// Stations that are remembered.
const STATIONS: usize = 16;
/// Weight of a new residual in a mean, once there are many, and the share of the white variance that is left in it.
const WEIGHT: f64 = 0.1;
const LEFT: f64 = WEIGHT / (2.0 - WEIGHT);
/// Residuals behind a mean at least, the time without one after which it begins anew \[s\], and stations at least.
const HEARD_LEAST: u32 = 10;
const SILENT_S: f64 = 5.0;
const STATIONS_LEAST: usize = 2;
/// Chance from which the stations agree, and below which they rule out. Provenance: inferred.
const AGREE: f64 = 1e-3;
const RULE_OUT: f64 = 1e-7;

/// A place where the antenna may be, and its covariance, Earth-centred.
#[derive(Debug, Clone, Copy)]
pub struct Reading {
    /// \[m\]
    pub ecef: Vector3<f64>,
    /// \[m²\]
    pub covariance: Matrix3<f64>,
}

#[derive(Debug, Clone, Copy)]
struct Record {
    station: u16,
    time: GpsTime,
    n: u32,
    /// Mean residual of both readings, and the variance that the position makes of it.
    mean: [f64; 2],
    position: [f64; 2],
    white: f64,
    bias: f64,
}

/// The stations of a flight.
#[derive(Debug, Clone, Copy, Default)]
pub struct Stations {
    record: [Option<Record>; STATIONS],
}

impl Stations {
    /// A range to a station, with the antenna by the snapshot and by the filter without satellites.
    pub fn hear(&mut self, time: GpsTime, m: &DmeRange, readings: &[Reading; 2]) {
        let place = self.place(m.station);
        let fresh = Record {
            station: m.station,
            time,
            n: 0,
            mean: [0.0; 2],
            position: [0.0; 2],
            white: m.sigma_white.m() * m.sigma_white.m(),
            bias: m.sigma_bias.m() * m.sigma_bias.m(),
        };
        let known = self.record[place].filter(|r| r.station == m.station && time.seconds_since(r.time) <= SILENT_S);
        let mut record = Record { time, ..known.unwrap_or(fresh) };
        record.n = record.n.saturating_add(1);
        let weight = (1.0 / f64::from(record.n)).max(WEIGHT);
        for (k, reading) in readings.iter().enumerate() {
            let line = m.position.vector() - reading.ecef;
            let distance = line.norm();
            let unit = line / distance;
            record.mean[k] += weight * (m.slant.m() - distance - record.mean[k]);
            record.position[k] = unit.dot(&(reading.covariance * unit));
        }
        self.record[place] = Some(record);
    }

    /// The station's place, or that of the one unheard for longest.
    fn place(&self, station: u16) -> usize {
        let known = self.record.iter().position(|r| r.is_some_and(|r| r.station == station));
        let oldest = || (0..STATIONS).min_by_key(|k| self.record[*k].map(|r| r.time)).unwrap_or(0);
        known.unwrap_or_else(oldest)
    }

    /// Whether the stations agree with the first reading and rule out the second.
    pub fn rule_out_the_second(&self, now: GpsTime) -> bool {
        let heard = || self.record.iter().flatten().filter(|r| r.n >= HEARD_LEAST && now.seconds_since(r.time) <= SILENT_S);
        let n = heard().count();
        if n < STATIONS_LEAST {
            return false;
        }
        let chance = |k: usize| {
            let square = |r: &Record| {
                let left = (1.0 / f64::from(r.n)).max(LEFT);
                r.mean[k] * r.mean[k] / (r.bias + r.white * left + n as f64 * r.position[k])
            };
            chi_square_tail(n as f64, heard().map(square).sum())
        };
        chance(0) >= AGREE && chance(1) < RULE_OUT
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::EcefPosition;
    use crate::quantity::Metres;

    fn reading(x: f64, sigma: f64) -> Reading {
        Reading { ecef: Vector3::new(x, 0.0, 0.0), covariance: Matrix3::identity() * (sigma * sigma) }
    }

    /// Three stations around a true antenna at the origin, thirty seconds, without noise.
    fn heard(snapshot: Reading, other: Reading) -> Stations {
        let mut stations = Stations::default();
        for second in 0..30 {
            let time = GpsTime::default().plus_seconds(f64::from(second));
            for (station, (x, y)) in [(1, (1e5, 0.0)), (2, (-6e4, 8e4)), (3, (0.0, -9e4))] {
                let position = EcefPosition::from_vector(Vector3::new(x, y, 0.0));
                let slant = Metres::new(f64::hypot(x, y));
                let m = DmeRange { station, position, slant, sigma_white: Metres::new(160.0), sigma_bias: Metres::new(93.0) };
                stations.hear(time, &m, &[snapshot, other]);
            }
        }
        stations
    }

    #[test]
    fn the_reading_that_the_stations_contradict_is_ruled_out_and_only_that() {
        let now = GpsTime::default().plus_seconds(29.0);
        assert!(heard(reading(1.0, 2.0), reading(800.0, 5.0)).rule_out_the_second(now));
        // The satellites are the ones that are wrong: a spoofer.
        assert!(!heard(reading(800.0, 2.0), reading(1.0, 5.0)).rule_out_the_second(now));
        // Both are: no witness for either.
        assert!(!heard(reading(800.0, 2.0), reading(900.0, 5.0)).rule_out_the_second(now));
        // Too near for the stations, or too uncertain to be ruled out.
        assert!(!heard(reading(1.0, 2.0), reading(200.0, 5.0)).rule_out_the_second(now));
        assert!(!heard(reading(1.0, 2.0), reading(800.0, 400.0)).rule_out_the_second(now));
        assert!(!heard(reading(1.0, 2.0), reading(f64::NAN, 5.0)).rule_out_the_second(now));
        // Heard too long ago.
        assert!(!heard(reading(1.0, 2.0), reading(800.0, 5.0)).rule_out_the_second(now.plus_seconds(6.0)));
    }
}
