//! Position, velocity and clock of a satellite from what it broadcasts.
//!
//! Source: IS-GPS-200 20.3.3.3.3.1 and table 20-IV, with velocities by differentiation (table 30-II); Galileo OS SIS ICD 5.1.1;
//! BDS-SIS-ICD-B1I 5.2.4.12; RTCA DO-229 A.4.4.11 for geostationary augmentation; provenance: standard.

use super::orbit::eccentric_anomaly;
use crate::frame::EcefPosition;
use crate::quantity::{GpsTime, Unavailable};
use crate::signal::{Constellation, Ephemeris, GeoEphemeris, Message, SPEED_OF_LIGHT_MPS};
use crate::special::float::{atan2, sin_cos, sqrt};
use nalgebra::{Matrix3, Vector3};

/// Gravitational constant of GPS \[m³/s²\].
const MU_GPS: f64 = 3.986_005e14;
/// Of Galileo and BeiDou.
const MU_OTHERS: f64 = 3.986_004_418e14;
/// Earth's rate of rotation: GPS and Galileo \[rad/s\].
const EARTH_RATE: f64 = 7.292_115_146_7e-5;
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

/// State at a GPS time from a Keplerian record.
///
/// # Valid
/// Any time; the caller decides with [`Ephemeris::covers`] whether the record is fresh enough.
///
/// # Errors
/// [`Unavailable::Invalid`] for elements that describe no orbit.
pub fn state(e: &Ephemeris, time: GpsTime) -> Result<SatelliteState, Unavailable> {
    check(e)?;
    let beidou = e.satellite.constellation == Constellation::BeiDou;
    let mu = if e.satellite.constellation == Constellation::Gps { MU_GPS } else { MU_OTHERS };
    let earth_rate = if beidou { EARTH_RATE_BEIDOU } else { EARTH_RATE };
    let t = time.seconds_since(e.orbit_time);
    let a = e.sqrt_a * e.sqrt_a;
    let n = sqrt(mu / (a * a * a)) + e.delta_n;
    let plane = in_plane(e, e.mean_anomaly + n * t, n, a, t);
    // Node in Earth-fixed axes at the reference time (right ascension counts from the start of the week).
    let week_start = if beidou { BEIDOU_BEHIND_NS } else { 0 };
    let time_of_week = ((e.orbit_time.nanoseconds() - week_start).rem_euclid(WEEK_NS)) as f64 * 1e-9;
    let geostationary = e.message == Message::D2;
    let node_rate = if geostationary { e.node[1] } else { e.node[1] - earth_rate };
    let node = e.node[0] + node_rate * t - earth_rate * time_of_week;
    let (position, velocity) = plane.to_earth(node, node_rate);
    let (position, velocity) = if geostationary { from_tilted(&position, &velocity, earth_rate, t) } else { (position, velocity) };
    let (clock_s, clock_drift) = clock(e, time, &plane, mu, a);
    Ok(SatelliteState { position: EcefPosition::from_vector(position), velocity_mps: velocity, clock_s, clock_drift })
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

/// Radius and argument of latitude, inclination, with rates.
struct InPlane {
    radius: [f64; 2],
    latitude: [f64; 2],
    inclination: [f64; 2],
    sin_anomaly: f64,
    cos_anomaly: f64,
    anomaly_rate: f64,
}

fn in_plane(e: &Ephemeris, mean_anomaly: f64, n: f64, a: f64, t: f64) -> InPlane {
    let ecc = e.eccentricity;
    let (s, c) = sin_cos(eccentric_anomaly(mean_anomaly, ecc));
    let scale = 1.0 - ecc * c;
    let anomaly_rate = n / scale;
    let root = sqrt(1.0 - ecc * ecc);
    let phi = e.perigee + atan2(root * s, c - ecc);
    let phi_rate = root * anomaly_rate / scale;
    let (s2, c2) = sin_cos(2.0 * phi);
    // A harmonic pair [cosine, sine]: its value and its rate.
    let harmonic = |[hc, hs]: [f64; 2]| [hc * c2 + hs * s2, 2.0 * phi_rate * (hs * c2 - hc * s2)];
    let [du, dr, di] = [e.latitude_harmonics, e.radius_harmonics, e.inclination_harmonics].map(harmonic);
    InPlane {
        radius: [a * scale + dr[0], a * ecc * s * anomaly_rate + dr[1]],
        latitude: [phi + du[0], phi_rate + du[1]],
        inclination: [e.inclination[0] + e.inclination[1] * t + di[0], e.inclination[1] + di[1]],
        sin_anomaly: s,
        cos_anomaly: c,
        anomaly_rate,
    }
}

impl InPlane {
    /// Position and velocity in axes in which the node stands at `node` and moves at `node_rate`.
    fn to_earth(&self, node: f64, node_rate: f64) -> (Vector3<f64>, Vector3<f64>) {
        let [r, r_rate] = self.radius;
        let (su, cu) = sin_cos(self.latitude[0]);
        let (x, y) = (r * cu, r * su);
        let (x_rate, y_rate) = (r_rate * cu - y * self.latitude[1], r_rate * su + x * self.latitude[1]);
        let (si, ci) = sin_cos(self.inclination[0]);
        let (sn, cn) = sin_cos(node);
        let position = Vector3::new(x * cn - y * ci * sn, x * sn + y * ci * cn, y * si);
        let across = y_rate * ci - y * si * self.inclination[1];
        let velocity = Vector3::new(
            x_rate * cn - across * sn - position.y * node_rate,
            x_rate * sn + across * cn + position.x * node_rate,
            y_rate * si + y * ci * self.inclination[1],
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

/// Clock with the relativity of the eccentric orbit: -2 sqrt(mu a) e sin E / c².
fn clock(e: &Ephemeris, time: GpsTime, plane: &InPlane, mu: f64, a: f64) -> (f64, f64) {
    let f = -2.0 * sqrt(mu * a) * e.eccentricity / (SPEED_OF_LIGHT_MPS * SPEED_OF_LIGHT_MPS);
    let t = time.seconds_since(e.clock_time);
    let drift = e.clock[1] + 2.0 * e.clock[2] * t;
    (clock_polynomial(e, time) + f * plane.sin_anomaly, drift + f * plane.cos_anomaly * plane.anomaly_rate)
}
