//! The ground stations as a witness between two readings: the satellites are right and the inertial unit is wrong, or the other way round.
//!
//! The same ranges to DME are compared with the snapshot and with the filter without satellites. The unit is convicted only where the stations
//! agree with the one and rule out the other; a spoofer leads the snapshot away from them.
//!
//! ```text
//! Q = sum_i m_i^2 / v_i,   v_i = bias^2 + f white^2 + n u_i' P u_i         m_i: mean residual of station i of n
//! ```
//!
//! A snapshot alone is tested in the same way against the stations, ranges and bearings: they agree with it, or doubt it, or contradict it.
//!
//! `n u' P u` bounds what the position's own error makes of all residuals together: M <= n diag(M) for a covariance M of n numbers.
//! Provenance: ours.

use crate::frame::{ecef_from_geodetic, enu_from_ecef};
use crate::monitor::judgement::Testimony;
use crate::quantity::GpsTime;
use crate::signal::{DmeRange, VorBearing};
use crate::special::float::{atan2, hypot};
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
/// Marks the bearing of a station that measures ranges as well.
const BEARING: u16 = 0x8000;
/// Chance from which a witness agrees. Provenance: inferred.
pub const AGREE: f64 = 1e-3;
/// Chance below which it rules out. Provenance: inferred.
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
struct Record<const N: usize> {
    station: u16,
    time: GpsTime,
    n: u32,
    /// Mean residual of each reading, and the variance that the position makes of it.
    mean: [f64; N],
    position: [f64; N],
    white: f64,
    bias: f64,
}

/// The stations of a flight, as witnesses of N readings of the same instants.
#[derive(Debug, Clone, Copy, Default)]
pub struct Stations<const N: usize> {
    record: [Option<Record<N>>; STATIONS],
}

impl<const N: usize> Stations<N> {
    /// A range to a station, with the antenna by each reading.
    pub fn hear(&mut self, time: GpsTime, m: &DmeRange, readings: &[Reading; N]) {
        let of = core::array::from_fn(|k| {
            let line = m.position.vector() - readings[k].ecef;
            let distance = line.norm();
            let unit = line / distance;
            (m.slant.m() - distance, unit.dot(&(readings[k].covariance * unit)))
        });
        self.note(time, m.station, [m.sigma_white.m(), m.sigma_bias.m()], of);
    }

    /// A bearing from a station, likewise.
    pub fn hear_bearing(&mut self, time: GpsTime, m: &VorBearing, readings: &[Reading; N]) {
        let turn = enu_from_ecef(&m.position.point);
        let of = core::array::from_fn(|k| {
            let line = turn * (readings[k].ecef - ecef_from_geodetic(&m.position).vector());
            let distance = hypot(line.x, line.y);
            let apart = m.bearing.rad() - atan2(line.x, line.y);
            let across = Vector3::new(line.y, -line.x, 0.0) / distance;
            let variance = across.dot(&(turn * readings[k].covariance * turn.transpose() * across));
            (wrapped(apart), variance / (distance * distance))
        });
        self.note(time, m.station | BEARING, [m.sigma_white.rad(), m.sigma_bias.rad()], of);
    }

    /// Residual and variance of the position along it, of each reading.
    fn note(&mut self, time: GpsTime, station: u16, [white, bias]: [f64; 2], of: [(f64, f64); N]) {
        let place = self.place(station);
        let fresh = Record { station, time, n: 0, mean: [0.0; N], position: [0.0; N], white: white * white, bias: bias * bias };
        let known = self.record[place].filter(|r| r.station == station && time.seconds_since(r.time) <= SILENT_S);
        let mut record = Record { time, ..known.unwrap_or(fresh) };
        record.n = record.n.saturating_add(1);
        let weight = (1.0 / f64::from(record.n)).max(WEIGHT);
        for (k, (residual, variance)) in of.into_iter().enumerate() {
            record.mean[k] += weight * (residual - record.mean[k]);
            record.position[k] = variance;
        }
        self.record[place] = Some(record);
    }

    /// The station's place, or that of the one unheard for longest.
    fn place(&self, station: u16) -> usize {
        let known = self.record.iter().position(|r| r.is_some_and(|r| r.station == station));
        let oldest = || (0..STATIONS).min_by_key(|k| self.record[*k].map(|r| r.time)).unwrap_or(0);
        known.unwrap_or_else(oldest)
    }

    /// The chance of residuals as large as these where a reading is right, of at least so many stations.
    fn chance(&self, now: GpsTime, k: usize, least: usize) -> Option<f64> {
        let heard = || self.record.iter().flatten().filter(|r| r.n >= HEARD_LEAST && now.seconds_since(r.time) <= SILENT_S);
        let n = heard().count();
        let square = |r: &Record<N>| {
            let left = (1.0 / f64::from(r.n)).max(LEFT);
            r.mean[k] * r.mean[k] / (r.bias + r.white * left + n as f64 * r.position[k])
        };
        (n >= least).then(|| chi_square_tail(n as f64, heard().map(square).sum()))
    }
}

#[cfg(test)]
impl<const N: usize> Stations<N> {
    /// Stations with a record.
    pub(super) fn n_known(&self) -> usize {
        self.record.iter().flatten().count()
    }
}

impl Stations<2> {
    /// Whether the stations agree with the first reading and rule out the second.
    pub fn rule_out_the_second(&self, now: GpsTime) -> bool {
        let [first, second] = [0, 1].map(|k| self.chance(now, k, STATIONS_LEAST));
        first.is_some_and(|c| c >= AGREE) && second.is_some_and(|c| c < RULE_OUT)
    }
}

impl Stations<1> {
    /// What the stations say of the one reading. One station that is heard suffices to doubt.
    pub fn testimony(&self, now: GpsTime) -> Testimony {
        self.chance(now, 0, 1).map_or(Testimony::Silent, testimony)
    }
}

/// What a witness says by the chance of its residual. A chance that is no number agrees with nothing.
pub fn testimony(chance: f64) -> Testimony {
    if chance >= AGREE {
        Testimony::Agrees
    } else if chance >= RULE_OUT {
        Testimony::Doubts
    } else {
        Testimony::Contradicts
    }
}

/// An angle between minus and plus half a turn.
fn wrapped(angle: f64) -> f64 {
    use core::f64::consts::{PI, TAU};
    if angle > PI {
        angle - TAU
    } else if angle < -PI {
        angle + TAU
    } else {
        angle
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
    fn heard(snapshot: Reading, other: Reading) -> Stations<2> {
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

    /// One station, a constant residual: both tails of the normal law of its bias, what is left of its noise, and the reading's own.
    #[test]
    fn a_chance_is_that_of_the_residual_in_its_deviations() {
        for (x, sigma) in [(100.0, 5.0), (300.0, 5.0), (300.0, 200.0), (-250.0, 40.0)] {
            let mut stations = Stations::<1>::default();
            for second in 0..30 {
                let time = GpsTime::default().plus_seconds(f64::from(second));
                let position = EcefPosition::from_vector(Vector3::new(1e5, 0.0, 0.0));
                let m = DmeRange {
                    station: 1,
                    position,
                    slant: Metres::new(1e5),
                    sigma_white: Metres::new(160.0),
                    sigma_bias: Metres::new(93.0),
                };
                stations.hear(time, &m, &[reading(x, sigma)]);
                // Nine are too few to say anything.
                assert_eq!(stations.chance(time, 0, 1).is_some(), second >= 9, "{second}");
            }
            let now = GpsTime::default().plus_seconds(29.0);
            // A moving average of weight a tenth leaves 0.1 / 1.9 of the variance of the noise.
            let variance: f64 = 93.0 * 93.0 + 160.0 * 160.0 * 0.1 / 1.9 + sigma * sigma;
            let expected = 2.0 * crate::special::normal::tail(f64::abs(x) / variance.sqrt());
            let chance = stations.chance(now, 0, 1).unwrap();
            assert!((chance / expected - 1.0).abs() < 1e-9, "{x} {sigma}: {chance} {expected}");
            assert!(stations.chance(now, 0, 2).is_none());
        }
    }

    #[test]
    fn an_angle_is_wrapped_to_half_a_turn_either_way() {
        use core::f64::consts::{PI, TAU};
        for (angle, expected) in [(0.0, 0.0), (PI, PI), (-PI, -PI), (3.5, 3.5 - TAU), (-3.5, TAU - 3.5), (6.0, 6.0 - TAU)] {
            assert_eq!(wrapped(angle), expected);
        }
    }

    /// A bearing of one station, a constant residual: the variance is that across the line over the square of the distance, and both parts
    /// of the bearing's own. The reading's variances are unlike, so that every turn and every product shows.
    #[test]
    fn a_bearing_is_judged_by_the_variance_across_the_line() {
        use crate::frame::{Geodetic, LatLon};
        use crate::quantity::Radians;
        use crate::signal::VorBearing;
        let point = LatLon::new(Radians::new(0.7), Radians::new(2.0)).unwrap();
        let position = Geodetic { point, height: Metres::new(100.0) };
        let turn = enu_from_ecef(&point);
        let enu = Matrix3::new(900.0, -300.0, 40.0, -300.0, 2500.0, 70.0, 40.0, 70.0, 400.0);
        for (east, north, off_deg) in
            [(30_000.0, 40_000.0, 0.2), (-8000.0, 6000.0, -0.9), (5000.0, -12_000.0, 0.5), (-3000.0, -4000.0, 2.0)]
        {
            let place = ecef_from_geodetic(&position).vector() + turn.transpose() * Vector3::new(east, north, 700.0);
            let reading = Reading { ecef: place, covariance: turn.transpose() * enu * turn };
            let distance = f64::hypot(east, north);
            let off = f64::to_radians(off_deg);
            let m = VorBearing {
                station: 9,
                position,
                bearing: Radians::new(f64::atan2(east, north) + off),
                sigma_white: Radians::new(0.012),
                sigma_bias: Radians::new(0.004),
            };
            let mut stations = Stations::<1>::default();
            for second in 0..30 {
                stations.hear_bearing(GpsTime::default().plus_seconds(f64::from(second)), &m, &[reading]);
            }
            let across = (north * north * 900.0 + 2.0 * north * east * 300.0 + east * east * 2500.0) / (distance * distance);
            let variance = 0.004 * 0.004 + 0.012 * 0.012 * 0.1 / 1.9 + across / (distance * distance);
            let expected = 2.0 * crate::special::normal::tail(off.abs() / variance.sqrt());
            let chance = stations.chance(GpsTime::default().plus_seconds(29.0), 0, 1).unwrap();
            // Rounding of 6e6 m is 1e-9 m of kilometres.
            assert!((chance / expected - 1.0).abs() < 1e-6, "{east} {north}: {chance} {expected}");
        }
    }

    /// Everything that was heard, kept and summed as it is: each mean with its weights, each silence, and the chance of all together.
    #[test]
    fn means_and_silences_are_those_of_all_that_was_heard() {
        let mut state = 3_u64;
        let mut draw = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let (mut stations, mut history) = (Stations::<1>::default(), Vec::new());
        let (white, bias) = (3.0, 1.0);
        let mut reported = 0;
        for second in 0..600_u32 {
            let time = GpsTime::default().plus_seconds(f64::from(second));
            for station in 1..=4_u16 {
                // Each is silent for a while, of five seconds and of six.
                let silent = 4 + u32::from(station) / 2;
                if (second + 20 * u32::from(station)) % 60 >= silent {
                    let (residual, variance) = (4.0 * draw() - 1.0, 2.0 * draw());
                    stations.note(time, station, [white, bias], [(residual, variance)]);
                    history.push((station, second, residual, variance));
                }
            }
            let mut heard = Vec::new();
            for station in 1..=4_u16 {
                let own: Vec<_> = history.iter().filter(|h| h.0 == station).collect();
                // From the last silence of more than five seconds on.
                let from = (1..own.len()).rev().find(|k| own[*k].1 - own[k - 1].1 > 5).unwrap_or(0);
                let Some(run) = own.get(from..).filter(|run| run.len() >= 10 && second - run[run.len() - 1].1 <= 5) else { continue };
                // The first ten weigh alike; each later one takes a tenth of the whole.
                let first = run[..10].iter().map(|h| h.2).sum::<f64>() / 10.0;
                let later = run.len() - 10;
                let mean = run[10..].iter().enumerate().map(|(k, h)| 0.1 * 0.9_f64.powi((later - 1 - k) as i32) * h.2).sum::<f64>()
                    + 0.9_f64.powi(later as i32) * first;
                heard.push((run.len() as f64, mean, run[run.len() - 1].3));
            }
            let n = heard.len() as f64;
            let square: f64 = heard
                .iter()
                .map(|(of, mean, position)| mean * mean / (bias * bias + white * white * (1.0 / of).max(0.1 / 1.9) + n * position))
                .sum();
            let now = time;
            for least in 1..=5 {
                let chance = stations.chance(now, 0, least);
                assert_eq!(chance.is_some(), heard.len() >= least, "{second}");
                if let Some(chance) = chance {
                    let expected = chi_square_tail(n, square);
                    assert!((chance - expected).abs() < 1e-12, "{second}: {chance} {expected}");
                    reported += 1;
                }
            }
        }
        assert!(reported > 1500, "{reported}");
    }

    /// There is room for sixteen; the next one takes the place of the one unheard for longest.
    #[test]
    fn the_station_unheard_for_longest_is_forgotten() {
        let mut stations = Stations::<1>::default();
        let at = |second: u16| GpsTime::default().plus_seconds(f64::from(second));
        for station in 1..=16_u16 {
            stations.note(at(station), station, [1.0, 1.0], [(0.0, 1.0)]);
        }
        stations.note(at(17), 1, [1.0, 1.0], [(0.0, 1.0)]);
        stations.note(at(18), 40, [1.0, 1.0], [(0.0, 1.0)]);
        let mut known: Vec<_> = stations.record.iter().flatten().map(|r| r.station).collect();
        known.sort_unstable();
        assert_eq!(known, [1, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 40]);
    }

    #[test]
    fn a_chance_that_is_just_reached_is_the_better_word() {
        for (chance, reported) in [
            (1.0, Testimony::Agrees),
            (1e-3, Testimony::Agrees),
            (0.999e-3, Testimony::Doubts),
            (1e-7, Testimony::Doubts),
            (0.999e-7, Testimony::Contradicts),
            (0.0, Testimony::Contradicts),
            (f64::NAN, Testimony::Contradicts),
        ] {
            assert_eq!(testimony(chance), reported, "{chance}");
        }
    }
}
