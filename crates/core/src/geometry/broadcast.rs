//! Position, velocity and clock of a satellite from what it broadcasts.
//!
//! Source: IS-GPS-200 20.3.3.3.3.1 and table 20-IV, with velocities by differentiation (table 30-II); Galileo OS SIS ICD 5.1.1;
//! BDS-SIS-ICD-B1I 5.2.4.12; RTCA DO-229 A.4.4.11 for geostationary augmentation; provenance: standard.

use super::orbit::{Elements, eccentric_anomaly};
use crate::frame::EcefPosition;
use crate::quantity::{GpsTime, Metres, Radians, Unavailable};
use crate::signal::{Constellation, Ephemeris, GeoEphemeris, Message, SPEED_OF_LIGHT_MPS};
use crate::special::float::{sin_cos, sqrt};
use nalgebra::{Matrix3, Vector3};

/// Gravitational constant of GPS \[m³/s²\].
const MU_GPS: f64 = 3.986_005e14;
/// Of Galileo and BeiDou.
const MU_OTHERS: f64 = 3.986_004_418e14;
/// Earth's rate of rotation: GPS and Galileo \[rad/s\].
pub const EARTH_RATE: f64 = 7.292_115_146_7e-5;
/// BeiDou (CGCS2000).
const EARTH_RATE_BEIDOU: f64 = 7.292_115_0e-5;
/// Tilt of the frame in which BeiDou's geostationary orbits are fitted: -5 degrees.
const BEIDOU_TILT: f64 = -5.0 * core::f64::consts::PI / 180.0;
const WEEK_NS: i64 = 604_800_000_000_000;
/// BeiDou time is behind GPS time by this, and so is its week \[ns\].
const BEIDOU_BEHIND_NS: i64 = 14_000_000_000;

/// A satellite at an instant, Earth-fixed axes of that instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SatelliteState {
    /// Antenna (or mass centre, by the message's definition).
    pub position: EcefPosition,
    /// Velocity in the turning axes \[m/s\].
    pub velocity_mps: Vector3<f64>,
    /// Satellite clock minus system time, relativity of the eccentric orbit included, group delay not \[s\].
    pub clock_s: f64,
    /// Its rate \[s/s\].
    pub clock_drift: f64,
}

/// A Keplerian record that describes an orbit, with what does not change in time worked out once.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Broadcast {
    record: Ephemeris,
    semi_major: f64,
    /// Mean motion, corrected \[rad/s\].
    mean_motion: f64,
    /// sqrt(1 - e²).
    root: f64,
    /// Sine and cosine of perigee and of the inclination at the reference time.
    perigee: (f64, f64),
    inclination: (f64, f64),
    /// Node in Earth-fixed axes at the reference time (sine, cosine), and its rate there \[rad/s\].
    node: (f64, f64),
    node_rate: f64,
    earth_rate: f64,
    /// Factor of e sin E in the clock: -2 sqrt(mu a) e / c² \[s\].
    relativity: f64,
}

/// Gravitational constant of the Earth in a constellation's interface document \[m³/s²\].
pub const fn gravitation_m3ps2(constellation: Constellation) -> f64 {
    if matches!(constellation, Constellation::Gps) { MU_GPS } else { MU_OTHERS }
}

/// State at a GPS time from a Keplerian record; for many times make the [`Broadcast`] once.
///
/// # Errors
/// As [`Broadcast::new`].
pub fn state(e: &Ephemeris, time: GpsTime) -> Result<SatelliteState, Unavailable> {
    Ok(Broadcast::new(e)?.state(time))
}

/// The Kepler orbit of a record at its reference time, without harmonics and without the correction of its mean motion: for the geometry of
/// a day, where a record serves for hours. It is some kilometres off after half a day, 0.02 degrees in the sky.
pub fn mean_elements(e: &Ephemeris) -> Elements {
    let time_of_week_s = e.orbit_time.nanoseconds().rem_euclid(WEEK_NS) as f64 * 1e-9;
    Elements {
        semi_major: Metres::new(e.sqrt_a * e.sqrt_a),
        eccentricity: e.eccentricity,
        inclination: Radians::new(e.inclination[0]),
        node: Elements::node_from_week_start(Radians::new(e.node[0]), time_of_week_s),
        node_rate_radps: e.node[1],
        perigee: Radians::new(e.perigee),
        mean_anomaly: Radians::new(e.mean_anomaly),
    }
}

impl Broadcast {
    /// From a record.
    ///
    /// # Errors
    /// [`Unavailable::Invalid`] for elements that describe no orbit.
    pub fn new(e: &Ephemeris) -> Result<Self, Unavailable> {
        check(e)?;
        let beidou = e.satellite.constellation == Constellation::BeiDou;
        let mu = gravitation_m3ps2(e.satellite.constellation);
        let earth_rate = if beidou { EARTH_RATE_BEIDOU } else { EARTH_RATE };
        let a = e.sqrt_a * e.sqrt_a;
        // Right ascension counts from the start of the week.
        let week_start = if beidou { BEIDOU_BEHIND_NS } else { 0 };
        let time_of_week = ((e.orbit_time.nanoseconds() - week_start).rem_euclid(WEEK_NS)) as f64 * 1e-9;
        Ok(Self {
            record: *e,
            semi_major: a,
            mean_motion: sqrt(mu / (a * a * a)) + e.delta_n,
            root: sqrt(1.0 - e.eccentricity * e.eccentricity),
            perigee: sin_cos(e.perigee),
            inclination: sin_cos(e.inclination[0]),
            node: sin_cos(e.node[0] - earth_rate * time_of_week),
            node_rate: if e.message == Message::D2 { e.node[1] } else { e.node[1] - earth_rate },
            earth_rate,
            relativity: -2.0 * sqrt(mu * a) * e.eccentricity / (SPEED_OF_LIGHT_MPS * SPEED_OF_LIGHT_MPS),
        })
    }

    /// The record.
    pub const fn record(&self) -> &Ephemeris {
        &self.record
    }

    /// State at a GPS time.
    ///
    /// # Valid
    /// Any time; the caller decides with [`Ephemeris::covers`] whether the record is fresh enough.
    pub fn state(&self, time: GpsTime) -> SatelliteState {
        let t = time.seconds_since(self.record.orbit_time);
        let plane = self.in_plane(t);
        let (position, velocity) = plane.to_earth(turned(self.node, self.node_rate * t), self.node_rate);
        let geostationary = self.record.message == Message::D2;
        let (position, velocity) = if geostationary { from_tilted(&position, &velocity, self.earth_rate, t) } else { (position, velocity) };
        let t = time.seconds_since(self.record.clock_time);
        SatelliteState {
            position: EcefPosition::from_vector(position),
            velocity_mps: velocity,
            clock_s: clock_polynomial(&self.record, time) + self.relativity * plane.anomaly.0,
            clock_drift: self.record.clock[1] + 2.0 * self.record.clock[2] * t + self.relativity * plane.anomaly.1 * plane.anomaly_rate,
        }
    }

    /// In the plane, `t` seconds after the reference time of the orbit.
    fn in_plane(&self, t: f64) -> InPlane {
        let (e, ecc) = (&self.record, self.record.eccentricity);
        let (s, c) = eccentric_direction(e.mean_anomaly + self.mean_motion * t, ecc);
        let scale = 1.0 - ecc * c;
        let anomaly_rate = self.mean_motion / scale;
        // True anomaly and perigee by the addition theorem: no angle is needed.
        let (sv, cv) = (self.root * s / scale, (c - ecc) / scale);
        let (sw, cw) = self.perigee;
        let (sp, cp) = (sw * cv + cw * sv, cw * cv - sw * sv);
        let phi_rate = self.root * anomaly_rate / scale;
        let (s2, c2) = (2.0 * sp * cp, cp * cp - sp * sp);
        // A harmonic pair [cosine, sine]: its value and its rate.
        let harmonic = |[hc, hs]: [f64; 2]| [hc * c2 + hs * s2, 2.0 * phi_rate * (hs * c2 - hc * s2)];
        let [du, dr, di] = [e.latitude_harmonics, e.radius_harmonics, e.inclination_harmonics].map(harmonic);
        InPlane {
            radius: [self.semi_major * scale + dr[0], self.semi_major * ecc * s * anomaly_rate + dr[1]],
            latitude: turned((sp, cp), du[0]),
            latitude_rate: phi_rate + du[1],
            inclination: turned(self.inclination, e.inclination[1] * t + di[0]),
            inclination_rate: e.inclination[1] + di[1],
            anomaly: (s, c),
            anomaly_rate,
        }
    }
}

/// Sine and cosine of an angle increased by `d`. Small `d` need a few products only.
fn turned((s, c): (f64, f64), d: f64) -> (f64, f64) {
    // Up to here the next terms of both series are below 1e-18.
    let (sd, cd) = if d.abs() <= 0.05 { small_sin_cos(d) } else { sin_cos(d) };
    (s * cd + c * sd, c * cd - s * sd)
}

fn small_sin_cos(d: f64) -> (f64, f64) {
    let q = d * d;
    let s = d * (1.0 - q * (1.0 / 6.0 - q * (1.0 / 120.0 - q * (1.0 / 5040.0 - q / 362_880.0))));
    let c = 1.0 - q * (0.5 - q * (1.0 / 24.0 - q * (1.0 / 720.0 - q / 40_320.0)));
    (s, c)
}

/// Sine and cosine of the eccentric anomaly: Newton on its difference d from the mean anomaly, d = e sin(M + d).
fn eccentric_direction(mean: f64, e: f64) -> (f64, f64) {
    // |d| <= e / (1 - e): of nearly circular orbits small enough for the short series.
    if e > 0.047 {
        return sin_cos(eccentric_anomaly(mean, e));
    }
    let at_mean = sin_cos(mean);
    let (mut d, mut direction) = (0.0, at_mean);
    for _ in 0..4 {
        let (s, c) = direction;
        let step = (e * s - d) / (1.0 - e * c);
        d += step;
        direction = turned(at_mean, d);
        // The next step is below e step² / 2.
        if step.abs() < 1e-8 {
            break;
        }
    }
    direction
}

/// State at a GPS time of a geostationary augmentation satellite: a Taylor series about its reference time.
pub fn geo_state(e: &GeoEphemeris, time: GpsTime) -> SatelliteState {
    let t = time.seconds_since(e.time);
    let [p, v, a] = [e.position_m, e.velocity_mps, e.acceleration_mps2].map(Vector3::from);
    SatelliteState {
        position: EcefPosition::from_vector(p + v * t + a * (0.5 * t * t)),
        velocity_mps: v + a * t,
        clock_s: e.clock[0] + e.clock[1] * t,
        clock_drift: e.clock[1],
    }
}

/// Satellite clock without relativity; enough to find the time of transmission (relativity moves it by less than 0.1 µs, 0.3 mm of orbit).
pub fn clock_polynomial(e: &Ephemeris, time: GpsTime) -> f64 {
    let t = time.seconds_since(e.clock_time);
    e.clock[0] + (e.clock[1] + e.clock[2] * t) * t
}

/// Turn of Earth-fixed axes during the signal's way: the position in the axes of reception.
///
/// ```text
/// p(reception) = R3(earth rate * way / c) p(transmission)
/// ```
pub fn in_axes_of_reception(position: &Vector3<f64>, way_s: f64) -> Vector3<f64> {
    // The angle is below 1e-5 rad: its sine and cosine to second order are exact in double precision.
    let angle = EARTH_RATE * way_s;
    let c = 1.0 - 0.5 * angle * angle;
    Vector3::new(c * position.x + angle * position.y, c * position.y - angle * position.x, position.z)
}

fn check(e: &Ephemeris) -> Result<(), Unavailable> {
    let a = e.sqrt_a * e.sqrt_a;
    if !(6.0e6..=1.0e9).contains(&a) {
        return Err(Unavailable::Invalid { field: "sqrt_a", value: e.sqrt_a, unit: "sqrt(m)", domain: "[2450, 31622]" });
    }
    if !(0.0..=0.9).contains(&e.eccentricity) {
        return Err(Unavailable::Invalid { field: "eccentricity", value: e.eccentricity, unit: "1", domain: "[0, 0.9]" });
    }
    Ok(())
}

/// Radius and argument of latitude, inclination, with rates; angles as sine and cosine.
struct InPlane {
    radius: [f64; 2],
    latitude: (f64, f64),
    latitude_rate: f64,
    inclination: (f64, f64),
    inclination_rate: f64,
    /// Eccentric anomaly.
    anomaly: (f64, f64),
    anomaly_rate: f64,
}

impl InPlane {
    /// Position and velocity in axes in which the node stands at `node` (sine, cosine) and moves at `node_rate`.
    fn to_earth(&self, (sn, cn): (f64, f64), node_rate: f64) -> (Vector3<f64>, Vector3<f64>) {
        let [r, r_rate] = self.radius;
        let (su, cu) = self.latitude;
        let (x, y) = (r * cu, r * su);
        let (x_rate, y_rate) = (r_rate * cu - y * self.latitude_rate, r_rate * su + x * self.latitude_rate);
        let (si, ci) = self.inclination;
        let position = Vector3::new(x * cn - y * ci * sn, x * sn + y * ci * cn, y * si);
        let across = y_rate * ci - y * si * self.inclination_rate;
        let velocity = Vector3::new(
            x_rate * cn - across * sn - position.y * node_rate,
            x_rate * sn + across * cn + position.x * node_rate,
            y_rate * si + y * ci * self.inclination_rate,
        );
        (position, velocity)
    }
}

/// BeiDou geostationary: from the tilted inertial-like axes to Earth-fixed, Rz(earth rate * t) Rx(-5 deg).
fn from_tilted(position: &Vector3<f64>, velocity: &Vector3<f64>, earth_rate: f64, t: f64) -> (Vector3<f64>, Vector3<f64>) {
    let (sx, cx) = sin_cos(BEIDOU_TILT);
    let (sz, cz) = sin_cos(earth_rate * t);
    let tilt = Matrix3::new(1.0, 0.0, 0.0, 0.0, cx, sx, 0.0, -sx, cx);
    let turn = Matrix3::new(cz, sz, 0.0, -sz, cz, 0.0, 0.0, 0.0, 1.0);
    let p = turn * tilt * position;
    let v = turn * tilt * velocity + earth_rate * Vector3::new(p.y, -p.x, 0.0);
    (p, v)
}

#[cfg(test)]
#[path = "broadcast_tests.rs"]
mod tests;
