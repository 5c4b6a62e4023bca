//! Kepler orbits seen from the turning Earth.
//!
//! Source: IS-GPS-200, 20.3.3.4.3 (user algorithm for ephemeris determination), without its harmonic corrections; provenance: standard.

use crate::frame::EcefPosition;
use crate::quantity::{Metres, OutOfDomain, Radians};
use crate::special::float::{atan2, sin, sin_cos, sqrt};
use nalgebra::Vector3;

/// Earth's gravitational constant, IS-GPS-200 table 20-IV \[m³/s²\].
const MU: f64 = 3.986_005e14;
/// Earth's rate of rotation, IS-GPS-200 table 20-IV \[rad/s\].
const EARTH_RATE: f64 = 7.292_115_146_7e-5;

/// Elements of an orbit at a reference instant, angles from the Earth's axes as they stand then.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Elements {
    /// Semi-major axis.
    pub semi_major: Metres,
    /// Eccentricity, 0 for a circle.
    pub eccentricity: f64,
    /// Inclination of the plane to the equator.
    pub inclination: Radians,
    /// Longitude of the ascending node at the reference instant (the right ascension counted from Greenwich).
    pub node: Radians,
    /// Rate of right ascension of the node \[rad/s\]; 0 for an orbit that keeps its plane among the stars.
    pub node_rate_radps: f64,
    /// Argument of perigee; 0 for a circle.
    pub perigee: Radians,
    /// Mean anomaly at the reference instant; for a circle without perigee the argument of latitude.
    pub mean_anomaly: Radians,
}

impl Elements {
    /// A circular orbit.
    pub const fn circular(semi_major: Metres, inclination: Radians, node: Radians, latitude_argument: Radians) -> Self {
        let perigee = Radians::new(0.0);
        Self { semi_major, eccentricity: 0.0, inclination, node, node_rate_radps: 0.0, perigee, mean_anomaly: latitude_argument }
    }
    /// Longitude of the node at a time of week, where its right ascension counts from Greenwich at the start of that week.
    pub fn node_from_week_start(right_ascension: Radians, time_of_week_s: f64) -> Radians {
        Radians::new(right_ascension.rad() - EARTH_RATE * time_of_week_s)
    }
    /// The same orbit with a later (or earlier) reference instant.
    ///
    /// # Errors
    /// [`OutOfDomain`] as [`Orbit::new`].
    pub fn moved(self, seconds: f64) -> Result<Self, OutOfDomain> {
        let orbit = Orbit::new(self)?;
        Ok(Self {
            node: Radians::new(self.node.rad() + (self.node_rate_radps - EARTH_RATE) * seconds),
            mean_anomaly: Radians::new(self.mean_anomaly.rad() + orbit.mean_motion * seconds),
            ..self
        })
    }
}

/// An orbit whose elements have been accepted, with what does not change in time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Orbit {
    elements: Elements,
    /// Mean motion \[rad/s\].
    mean_motion: f64,
    /// Sine and cosine of the inclination.
    tilt: (f64, f64),
}

impl Orbit {
    /// An orbit from its elements.
    ///
    /// # Errors
    /// [`OutOfDomain`] unless the semi-major axis is above 6e6 m, the eccentricity in \[0, 0.9\] and every angle finite.
    pub fn new(elements: Elements) -> Result<Self, OutOfDomain> {
        let (a, e) = (elements.semi_major.m(), elements.eccentricity);
        if !(a >= 6.0e6 && a.is_finite()) {
            return Err(OutOfDomain { argument: "semi_major_m", value: a, unit: "m", domain: "[6e6, inf)" });
        }
        // Kepler's equation is solved by Newton steps from a first guess that is safe up to here.
        if !(0.0..=0.9).contains(&e) {
            return Err(OutOfDomain { argument: "eccentricity", value: e, unit: "1", domain: "[0, 0.9]" });
        }
        let angles = [
            ("inclination_rad", elements.inclination),
            ("node_rad", elements.node),
            ("perigee_rad", elements.perigee),
            ("mean_anomaly_rad", elements.mean_anomaly),
            ("node_rate_radps", Radians::new(elements.node_rate_radps)),
        ];
        for (argument, angle) in angles {
            if !angle.rad().is_finite() {
                return Err(OutOfDomain { argument, value: angle.rad(), unit: "rad", domain: "finite angles" });
            }
        }
        Ok(Self { elements, mean_motion: sqrt(MU / (a * a * a)), tilt: sin_cos(elements.inclination.rad()) })
    }

    /// Position in Earth-fixed axes, seconds after the reference instant.
    ///
    /// ```text
    /// M = M0 + sqrt(mu / a^3) t      E - e sin E = M      node = node0 + (node rate - Earth rate) t
    /// ```
    pub fn position(&self, seconds: f64) -> EcefPosition {
        EcefPosition::from_vector(self.state(seconds).0)
    }

    /// Position and velocity in the turning Earth-fixed axes, seconds after the reference instant \[m, m/s\].
    ///
    /// ```text
    /// u' = n (a/r)^2 sqrt(1 - e^2)      r' = a e n sin v / sqrt(1 - e^2)
    /// ```
    pub fn state(&self, seconds: f64) -> (Vector3<f64>, Vector3<f64>) {
        let (el, e) = (&self.elements, self.elements.eccentricity);
        let node_rate = el.node_rate_radps - EARTH_RATE;
        let (radius, latitude_argument) = self.in_plane(el.mean_anomaly.rad() + self.mean_motion * seconds);
        let (su, cu) = sin_cos(latitude_argument);
        let (sn, cn) = sin_cos(el.node.rad() + node_rate * seconds);
        let (si, ci) = self.tilt;
        let outward = Vector3::new(cu * cn - su * ci * sn, cu * sn + su * ci * cn, su * si);
        let ahead = Vector3::new(-su * cn - cu * ci * sn, -su * sn + cu * ci * cn, cu * si);
        let (a, root) = (el.semi_major.m(), sqrt(1.0 - e * e));
        let turn_rate = self.mean_motion * (a / radius) * (a / radius) * root;
        let radius_rate = if e == 0.0 { 0.0 } else { a * e * self.mean_motion * sin(latitude_argument - el.perigee.rad()) / root };
        let position = radius * outward;
        let turning = node_rate * Vector3::new(-position.y, position.x, 0.0);
        (position, radius_rate * outward + radius * turn_rate * ahead + turning)
    }

    /// Radius and argument of latitude for a mean anomaly.
    fn in_plane(&self, mean_anomaly: f64) -> (f64, f64) {
        let (a, e, perigee) = (self.elements.semi_major.m(), self.elements.eccentricity, self.elements.perigee.rad());
        if e == 0.0 {
            return (a, perigee + mean_anomaly);
        }
        let anomaly = eccentric_anomaly(mean_anomaly, e);
        let (s, c) = sin_cos(anomaly);
        (a * (1.0 - e * c), perigee + atan2(sqrt(1.0 - e * e) * s, c - e))
    }
}

/// Newton on Kepler's equation; quadratic, so eight steps end at the last digits for e up to 0.9.
pub(super) fn eccentric_anomaly(mean: f64, e: f64) -> f64 {
    let (s, c) = sin_cos(mean);
    // The angle inside one turn, where the guess M + e sin M / (1 - sin(M + e) + sin M) is safe.
    let m = atan2(s, c);
    let mut x = m + e * sin(m) / (1.0 - sin(m + e) + sin(m));
    for _ in 0..8 {
        let (s, c) = sin_cos(x);
        let step = (x - e * s - m) / (1.0 - e * c);
        x -= step;
        // The next step would be its square.
        if step.abs() < 1e-9 {
            break;
        }
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn gps(e: f64) -> Orbit {
        let elements = Elements {
            eccentricity: e,
            ..Elements::circular(Metres::new(26_559_800.0), Radians::degrees(55.0), Radians::degrees(20.0), Radians::degrees(35.0))
        };
        Orbit::new(elements).unwrap()
    }

    #[test]
    fn a_geostationary_satellite_stands_still() {
        // mu / rate^2 cubed root: the radius whose period is a sidereal day.
        let a = libm::cbrt(MU / (EARTH_RATE * EARTH_RATE));
        let zero = Radians::new(0.0);
        let orbit = Orbit::new(Elements::circular(Metres::new(a), zero, Radians::degrees(110.5), zero)).unwrap();
        // A day of about 6.28 rad resolves some 1e-15 rad of 4.2e7 m; libm adds a few units.
        let moved = orbit.position(86_400.0).minus(&orbit.position(0.0));
        assert!(moved.vector().norm() < 1e-6);
        assert!((orbit.position(0.0).vector().y / orbit.position(0.0).vector().x - libm::tan(110.5_f64.to_radians())).abs() < 1e-12);
    }

    #[test]
    fn gps_repeats_its_ground_track_after_two_turns() {
        // The nominal axis gives a period of 43077.9 s, 4 s short of half a sidereal day: 14 km at 3.9 km/s in two turns less Earth's turn.
        let sidereal = core::f64::consts::TAU / EARTH_RATE;
        let moved = gps(0.0).position(sidereal).minus(&gps(0.0).position(0.0)).vector().norm();
        assert!(moved < 4.0e4, "{moved}");
        assert!(gps(0.0).position(0.5 * sidereal).minus(&gps(0.0).position(0.0)).vector().norm() > 1e7);
    }

    #[test]
    fn elements_that_are_no_orbit_are_refused() {
        let good = gps(0.0).elements;
        for bad in [
            Elements { semi_major: Metres::new(6.0e5), ..good },
            Elements { semi_major: Metres::new(f64::NAN), ..good },
            Elements { eccentricity: 1.0, ..good },
            Elements { eccentricity: f64::NAN, ..good },
            Elements { node: Radians::new(f64::INFINITY), ..good },
        ] {
            assert!(Orbit::new(bad).is_err());
        }
    }

    proptest! {
        // Against a central difference over 2 s, whose error is (n dt)^2 / 6 of 4 km/s = 2e-5 m/s for a circle; 0.7 of eccentricity has a
        // perigee 11 times as fast.
        #[test]
        fn velocity_is_the_change_of_position(e in 0.0..0.7f64, t in 0.0..86_400.0f64) {
            let orbit = gps(e);
            let (_, velocity) = orbit.state(t);
            let moved = (orbit.position(t + 1.0).vector() - orbit.position(t - 1.0).vector()) / 2.0;
            prop_assert!((velocity - moved).norm() < 5e-3, "{velocity} {moved}");
        }

        // Kepler's second law and the energy integral hold whatever the solver does; velocity by central difference over 0.2 s,
        // whose error is about (n dt)^2 / 6 = 1e-10 relative.
        #[test]
        fn the_energy_of_an_eccentric_orbit_is_that_of_its_axis(e in 0.0..0.7f64, t in 0.0..86_400.0f64) {
            let orbit = gps(e);
            let inertial = |t: f64| {
                let x = *orbit.position(t).vector();
                let (s, c) = (EARTH_RATE * t).sin_cos();
                Vector3::new(c * x.x - s * x.y, s * x.x + c * x.y, x.z)
            };
            let speed = (inertial(t + 0.1) - inertial(t - 0.1)).norm() / 0.2;
            let energy = 0.5 * speed * speed - MU / inertial(t).norm();
            let expected = -0.5 * MU / 26_559_800.0;
            prop_assert!((energy / expected - 1.0).abs() < 1e-5, "{energy} {expected}");
        }
    }
}
