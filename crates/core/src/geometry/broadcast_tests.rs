use super::*;
use crate::signal::{Health, SatelliteId};
use crate::special::float::cos;
use proptest::prelude::*;

fn record(constellation: Constellation, message: Message, eccentricity: f64) -> Ephemeris {
    let time = GpsTime::from_nanoseconds(1_277_078_400_000_000_000);
    Ephemeris {
        satellite: SatelliteId { constellation, number: 7 },
        message,
        clock_time: time,
        clock: [1e-4, 2e-12, 0.0],
        orbit_time: time,
        sent: None,
        issue_orbit: 1,
        issue_clock: 1,
        sqrt_a: 5153.7,
        eccentricity,
        inclination: [0.96, 3e-10],
        node: [-2.1, -8e-9],
        perigee: 0.7,
        mean_anomaly: 1.9,
        delta_n: 4.5e-9,
        latitude_harmonics: [-5e-6, 8e-6],
        radius_harmonics: [230.0, -95.0],
        inclination_harmonics: [1e-7, -6e-8],
        accuracy_m: 2.0,
        health: Health { word: 0 },
        group_delay_s: [0.0; 2],
        fit_interval_s: 14_400.0,
    }
}

/// The user algorithm of IS-GPS-200 table 20-IV, angle by angle, with Kepler's equation by plain iteration.
fn by_the_table(e: &Ephemeris, t: f64) -> Vector3<f64> {
    let a = e.sqrt_a * e.sqrt_a;
    let n = sqrt(MU_GPS / (a * a * a)) + e.delta_n;
    let mean = e.mean_anomaly + n * t;
    let mut anomaly = mean;
    for _ in 0..200 {
        anomaly = mean + e.eccentricity * anomaly.sin();
    }
    let ecc = e.eccentricity;
    let phi = e.perigee + (sqrt(1.0 - ecc * ecc) * anomaly.sin()).atan2(anomaly.cos() - ecc);
    let with = |[hc, hs]: [f64; 2]| hc * (2.0 * phi).cos() + hs * (2.0 * phi).sin();
    let u = phi + with(e.latitude_harmonics);
    let r = a * (1.0 - ecc * anomaly.cos()) + with(e.radius_harmonics);
    let i = e.inclination[0] + e.inclination[1] * t + with(e.inclination_harmonics);
    let week_s = (e.orbit_time.nanoseconds() / 1_000_000_000 % 604_800) as f64;
    let node = e.node[0] + (e.node[1] - EARTH_RATE) * t - EARTH_RATE * week_s;
    let (x, y) = (r * u.cos(), r * u.sin());
    Vector3::new(x * node.cos() - y * i.cos() * node.sin(), x * node.sin() + y * i.cos() * node.cos(), y * i.sin())
}

fn after(e: &Ephemeris, t: f64) -> GpsTime {
    GpsTime::from_nanoseconds(e.orbit_time.nanoseconds() + (t * 1e9) as i64)
}

proptest! {
    // The node since the start of the week is up to 44 rad, whose last digit is 7e-15: 2e-7 m at this radius; the rest is below.
    #[test]
    fn the_orbit_is_that_of_the_table(ecc in 0.0..0.5f64, t in -7200..7200_i32, anomaly in -4.0..4.0f64) {
        let e = Ephemeris { mean_anomaly: anomaly, ..record(Constellation::Gps, Message::Lnav, ecc) };
        let position = *state(&e, after(&e, f64::from(t))).unwrap().position.vector();
        prop_assert!((position - by_the_table(&e, f64::from(t))).norm() < 3e-7, "{}", (position - by_the_table(&e, f64::from(t))).norm());
    }

    // Central difference over 2 s: the third derivative of the orbit, 4 km/s * (1.5e-4)^2 per s, leaves 1e-4 / 6 m/s, more at the perigee.
    #[test]
    fn velocity_and_drift_are_the_rates(ecc in 0.0..0.1f64, t in -7200..7200_i32) {
        for (constellation, message) in [(Constellation::Gps, Message::Lnav), (Constellation::BeiDou, Message::D2)] {
            let orbit = Broadcast::new(&record(constellation, message, ecc)).unwrap();
            let at = |dt| orbit.state(after(orbit.record(), f64::from(t) + dt));
            let (before, now, later) = (at(-1.0), at(0.0), at(1.0));
            let rate = (later.position.vector() - before.position.vector()) / 2.0;
            prop_assert!((rate - now.velocity_mps).norm() < 2e-4, "{}", (rate - now.velocity_mps).norm());
            prop_assert!(((later.clock_s - before.clock_s) / 2.0 - now.clock_drift).abs() < 1e-15);
        }
    }

    #[test]
    fn a_turned_angle_is_the_sum(angle in -7.0..7.0f64, d in -0.2..0.2f64) {
        let (s, c) = turned(sin_cos(angle), d);
        // Two products and a sum of numbers below one.
        prop_assert!((s - crate::special::float::sin(angle + d)).abs() < 2e-15 && (c - cos(angle + d)).abs() < 2e-15);
    }
}

#[test]
fn elements_that_are_no_orbit_are_refused() {
    let good = record(Constellation::Gps, Message::Lnav, 0.01);
    for bad in [
        Ephemeris { sqrt_a: 0.0, ..good },
        Ephemeris { sqrt_a: f64::NAN, ..good },
        Ephemeris { eccentricity: 0.95, ..good },
        Ephemeris { eccentricity: f64::NAN, ..good },
    ] {
        assert!(matches!(state(&bad, bad.orbit_time), Err(Unavailable::Invalid { .. })));
    }
}

#[test]
fn the_kepler_orbit_of_a_record_stays_near_it_for_half_a_day() {
    for constellation in [Constellation::Gps, Constellation::Galileo] {
        let message = if constellation == Constellation::Gps { Message::Lnav } else { Message::Inav };
        let e = record(constellation, message, 0.012);
        let orbit = crate::geometry::Orbit::new(mean_elements(&e)).unwrap();
        for hour in [-12.0, -1.0, 0.0, 1.0, 6.0, 12.0] {
            let broadcast = state(&e, e.orbit_time.plus_seconds(3600.0 * hour)).unwrap().position;
            let apart = orbit.position(3600.0 * hour).minus(&broadcast).vector().norm();
            // Harmonics: 8e-6 rad of 26560 km; then 4.5e-9 rad/s of mean motion and 3e-10 rad/s of tilt over the time.
            assert!(apart < 500.0 + 0.14 * 3600.0 * f64::abs(hour), "{hour} h: {apart} m");
        }
    }
}
