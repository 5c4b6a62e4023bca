use super::super::{read_navigation, read_observations};
use super::*;
use navbound_core::signal::{Health, Klobuchar, SatelliteId};
use proptest::prelude::*;

/// 2024-03-01 00:00:00 of GPS time: week 2303, Friday.
const BEGIN_NS: i64 = 2303 * WEEK_NS + 5 * 86_400_000_000_000;

fn satellite(constellation: Constellation, number: u8) -> SatelliteId {
    SatelliteId { constellation, number }
}

#[test]
fn an_epoch_is_written_in_the_columns_of_the_standard() {
    let mut o = Observations::default();
    (o.marker, o.interval_s) = ("TEST".to_owned(), Some(30.0));
    o.codes[0] = vec![*b"C1C", *b"L1C"];
    let time = GpsTime::from_nanoseconds(BEGIN_NS + 30_500_000_000);
    o.add_epoch(time, &[(satellite(Constellation::Gps, 5), vec![(21_600_712.022_4, 0), (-113_512_506.876_4, 0x17)])]).unwrap();
    let text = observation_file(&o, "navbound").unwrap();
    // Columns counted by hand from RINEX 3.05, table A3: F14.3, I1, I1 for each observation.
    assert!(text.contains("\n> 2024 03 01 00 00 30.5000000  0  1\nG05  21600712.022  -113512506.87617\n"), "{text}");
    assert!(text.contains("G    2 C1C L1C                                              SYS / # / OBS TYPES \n"), "{text}");
    assert!(text.lines().take_while(|l| !l.contains("END OF HEADER")).all(|l| l.len() == 80));
}

#[test]
fn numbers_are_those_of_fortran() {
    for (value, text) in [(-1.5e-12, "-1.500000000000D-12"), (0.0, " 0.000000000000D+00"), (5153.5, " 5.153500000000D+03")] {
        assert_eq!(fortran(value, at::WIDTH, at::DECIMALS), text);
    }
}

#[test]
fn what_has_no_columns_is_refused() {
    let mut o = Observations::default();
    assert_eq!(observation_file(&o, "p").unwrap_err().argument, "observations");
    o.codes[0] = vec![*b"C1C"];
    let time = GpsTime::from_nanoseconds(BEGIN_NS);
    assert_eq!(o.add_epoch(time, &[(satellite(Constellation::Gps, 1), vec![])]).unwrap_err().argument, "values");
    o.add_epoch(time, &[(satellite(Constellation::Gps, 1), vec![(1e12, 0)])]).unwrap();
    assert_eq!(o.add_epoch(time, &[]).unwrap_err().argument, "time_ns");
    assert_eq!(observation_file(&o, "p").unwrap_err().argument, "value");
    assert_eq!(navigation_file(&Navigation::default(), "p").unwrap_err().argument, "navigation");
}

fn ephemeris(message: Message, number: u8, numbers: &[f64]) -> Ephemeris {
    let constellation = if message == Message::Lnav { Constellation::Gps } else { Constellation::Galileo };
    let x = |k: usize| numbers[k];
    let time = |s: f64| GpsTime::from_nanoseconds(BEGIN_NS + (s * 16.0).round() as i64 * 1_000_000_000);
    Ephemeris {
        satellite: satellite(constellation, number),
        message,
        clock_time: time(300.0 * x(0)),
        clock: [1e-4 * x(1), 1e-11 * x(2), 1e-19 * x(3)],
        orbit_time: time(300.0 * x(4)),
        sent: Some(time(300.0 * x(5))),
        issue_orbit: (1000.0 * x(6).abs()) as u16,
        // Galileo has one issue.
        issue_clock: (1000.0 * x(6).abs()) as u16,
        sqrt_a: 5300.0 + 100.0 * x(7),
        eccentricity: 0.02 * x(8).abs(),
        inclination: [x(9), 1e-10 * x(10)],
        node: [3.0 * x(11), 1e-9 * x(12)],
        perigee: 3.0 * x(13),
        mean_anomaly: 3.0 * x(14),
        delta_n: 1e-9 * x(15),
        latitude_harmonics: [1e-6 * x(16), 1e-6 * x(17)],
        radius_harmonics: [100.0 * x(18), 100.0 * x(19)],
        inclination_harmonics: [1e-7 * x(20), 1e-7 * x(21)],
        accuracy_m: 2.0,
        health: Health { word: 0 },
        group_delay_s: [1e-8 * x(22), if message == Message::Lnav { 0.0 } else { 1e-8 * x(23) }],
        fit_interval_s: if message == Message::Lnav { 4.0 * 3600.0 } else { 8.0 * 3600.0 },
    }
}

/// Numbers of a record as they are compared: thirteen digits are written, so half a unit of the thirteenth may be lost.
fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 0.5e-12 * a.abs().max(b.abs()) * 1.001
}

proptest! {
    // Three decimals are written: what comes back is the nearest of them, and every indicator.
    #[test]
    fn observations_come_back(
        rows in proptest::collection::vec((1_u8..33, -9e8..9e8_f64, 0_u8..8, 0_u8..10, any::<bool>()), 1..20),
        step_tenths_us in 1_i64..1_000_000_000,
    ) {
        let mut o = Observations::default();
        o.codes[0] = vec![*b"C1C", *b"L1C"];
        for (n, (number, value, lock, strength, absent)) in rows.iter().enumerate() {
            let time = GpsTime::from_nanoseconds(BEGIN_NS + n as i64 * step_tenths_us * 100);
            let phase = if *absent { (f64::NAN, 0) } else { (*value, lock << 4 | strength) };
            o.add_epoch(time, &[(satellite(Constellation::Gps, *number), vec![(value.abs(), 0), phase])]).unwrap();
        }
        let back = read_observations(observation_file(&o, "navbound").unwrap().as_bytes()).unwrap();
        prop_assert_eq!((back.n_refused, &back.time, &back.satellite, &back.indicator), (0, &o.time, &o.satellite, &o.indicator));
        for (a, b) in o.value.iter().zip(&back.value) {
            prop_assert!(a.is_nan() && b.is_nan() || (a - b).abs() <= 0.000_500_1, "{} {}", a, b);
        }
    }

    #[test]
    fn broadcast_records_come_back(
        which in 0_usize..3,
        number in 1_u8..33,
        numbers in proptest::collection::vec(-1.0..1.0_f64, 24),
    ) {
        let message = [Message::Lnav, Message::Inav, Message::Fnav][which];
        let e = ephemeris(message, number, &numbers);
        let klobuchar = Klobuchar { alpha: [1.1e-8, 1.49e-8, -5.96e-8, -1.192e-7], beta: [9.011e4, 1.638e4, -1.966e5, -6.554e4] };
        let n = Navigation { ephemerides: vec![e], klobuchar_gps: Some(klobuchar), leap_seconds: Some(18), ..Navigation::default() };
        let back = read_navigation(navigation_file(&n, "navbound").unwrap().as_bytes()).unwrap();
        prop_assert_eq!((back.refused.len(), back.ephemerides.len(), back.leap_seconds), (0, 1, Some(18)));
        // Coefficients of five digits are written as they are.
        prop_assert_eq!(back.klobuchar_gps, Some(klobuchar));
        let b = back.ephemerides[0];
        prop_assert_eq!(
            (b.satellite, b.message, b.clock_time, b.orbit_time, b.sent, b.issue_orbit, b.issue_clock, b.health, b.fit_interval_s),
            (e.satellite, e.message, e.clock_time, e.orbit_time, e.sent, e.issue_orbit, e.issue_clock, e.health, e.fit_interval_s)
        );
        let all = |e: &Ephemeris| {
            let mut v = vec![e.sqrt_a, e.eccentricity, e.perigee, e.mean_anomaly, e.delta_n, e.accuracy_m];
            v.extend(e.clock);
            for pair in [e.inclination, e.node, e.latitude_harmonics, e.radius_harmonics, e.inclination_harmonics, e.group_delay_s] {
                v.extend(pair);
            }
            v
        };
        for (a, b) in all(&e).into_iter().zip(all(&b)) {
            prop_assert!(close(a, b), "{} {}", a, b);
        }
    }
}
