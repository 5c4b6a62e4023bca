use super::*;
use navbound_core::geometry::broadcast;
use navbound_core::signal::{Carrier, Message, SatelliteId, nearest};
use proptest::prelude::*;

const HEADER: &str = "     3.02           N: GNSS NAV DATA    M: MIXED            RINEX VERSION / TYPE
GPSA   9.3132D-09  1.4901D-08 -5.9605D-08 -1.1921D-07       IONOSPHERIC CORR
GPSB   8.8064D+04  4.9152D+04 -1.3107D+05 -3.2768D+05       IONOSPHERIC CORR
    18    18  1929     7                                    LEAP SECONDS
                                                            END OF HEADER
";
const G01: &str = "G01 2019 04 27 12 00 00-3.328546881676D-06-8.526512829121D-12 0.000000000000D+00
     1.100000000000D+02-4.709375000000D+01 4.164458999867D-09 2.214944693794D+00
    -2.458691596985D-06 8.707020082511D-03 4.800036549568D-06 5.153657373428D+03
     5.616000000000D+05-9.685754776001D-08-2.355786246810D+00-8.568167686462D-08
     9.752761803733D-01 2.955312500000D+02 6.931059621197D-01-8.031048714940D-09
     1.025042689617D-10 1.000000000000D+00 2.050000000000D+03 0.000000000000D+00
     2.000000000000D+00 0.000000000000D+00 5.587935447693D-09 1.100000000000D+02
     5.543400000000D+05
";
const C01: &str = "C01 2019 04 27 23 00 00 5.142397712916D-04 4.822720001130D-11 0.000000000000D+00
     1.000000000000D+00 3.683125000000D+02-2.525105236018D-09-2.795258832287D+00
     1.201452687383D-05 2.179638249800D-04-4.153698682785D-07 6.493313154221D+03
     6.012000000000D+05-9.546056389809D-08 2.896024146824D+00 1.001171767712D-07
     1.099186642221D-01 1.714062500000D+01 2.199281951138D+00 3.538718873486D-09
    -9.214669305369D-11                    6.940000000000D+02
     2.000000000000D+00 0.000000000000D+00 1.420000028673D-08-1.039999997232D-08
     6.012004000000D+05 0.000000000000D+00
";

fn read(text: &str) -> Navigation {
    read_navigation(text.as_bytes()).unwrap()
}

#[test]
fn a_gps_record_arrives_whole() {
    let n = read(&format!("{HEADER}{G01}"));
    let [e] = n.ephemerides[..] else { panic!("one record expected, {} found", n.ephemerides.len()) };
    // 2019-04-27 12:00:00 is week 2050 and 561600 s, both written in the record.
    assert_eq!(e.orbit_time.nanoseconds(), (2050 * 604_800 + 561_600) * 1_000_000_000);
    assert_eq!(e.clock_time, e.orbit_time);
    assert_eq!(e.sent.unwrap().nanoseconds(), (2050 * 604_800 + 554_340) * 1_000_000_000);
    assert_eq!((e.issue_orbit, e.issue_clock, e.health.word, e.accuracy_m), (110, 110, 0, 2.0));
    assert_eq!(e.group_delay(Carrier::L1), Some(5.587935447693e-9));
    assert_eq!(e.clock, [-3.328546881676e-6, -8.526512829121e-12, 0.0]);
    assert_eq!(n.klobuchar_gps.unwrap().beta, [88064.0, 49152.0, -131_070.0, -327_680.0]);
    assert_eq!((n.leap_seconds, n.refused.len()), (Some(18), 0));
}

/// Version 3: a header does not say when, the orbits beneath it do. Version 4 dates each message; the nearest serves, within the time requested.
#[test]
fn messages_of_the_ionosphere_are_dated() {
    let galileo = "GAL    2.8250e+01  7.8125e-03  1.0071e-02  0.0000E+00       IONOSPHERIC CORR    \n";
    let (first, rest) = HEADER.split_once('\n').unwrap();
    let n = read(&format!("{first}\n{galileo}{rest}{G01}"));
    let at = n.ephemerides[0].orbit_time;
    assert_eq!(n.ionosphere_galileo, [Dated { time: Some(at), message: [28.25, 0.007_812_5, 0.010_071] }]);
    assert_eq!(n.ionosphere_gps.iter().map(|d| (d.time, d.message.beta[0])).collect::<Vec<_>>(), [(Some(at), 88_064.0)]);
    assert!(Dated::nearest(&n.ionosphere_gps, at.plus_seconds(86_400.0), 172_800.0).is_some());
    assert!(Dated::nearest(&n.ionosphere_gps, at.plus_seconds(-200_000.0), 172_800.0).is_none());

    let fourth = "     4.00           NAVIGATION DATA     M (MIXED)           RINEX VERSION / TYPE
                                                            END OF HEADER
> ION G12 LNAV
    2023 03 12 00 08 54 3.259629011154e-08 7.450580596924e-09-1.788139343262e-07
     0.000000000000e+00 1.351680000000e+05 0.000000000000e+00-2.621440000000e+05
     1.310720000000e+05
> ION G21 LNAV
    2023 03 12 23 41 24 2.887099981308e-08 7.450580596924e-09-1.192092895508e-07
     0.000000000000e+00 1.331200000000e+05 0.000000000000e+00-2.621440000000e+05
     1.310720000000e+05
> ION E02 IFNV
    2023 03 12 00 11 25 1.607500000000e+02 3.710937500000e-01 9.063720703125e-03
     0.000000000000e+00
";
    let n = read(fourth);
    // 2023-03-12 is the first day of week 2253.
    let evening = GpsTime::from_nanoseconds((2253 * 604_800 + 20 * 3600) * 1_000_000_000);
    let alpha = |time| Dated::nearest(&n.ionosphere_gps, time, 172_800.0).map(|k| k.alpha[0]);
    assert_eq!(alpha(evening), Some(2.887_099_981_308e-8));
    assert_eq!(alpha(evening.plus_seconds(-18.0 * 3600.0)), Some(3.259_629_011_154e-8));
    assert_eq!(alpha(evening.plus_seconds(4.0 * 86_400.0)), None);
    assert_eq!(n.ionosphere_galileo[0].message, [160.75, 0.371_093_75, 9.063_720_703_125e-3]);
    assert_eq!((n.klobuchar_gps.map(|k| k.alpha[0]), n.refused.len()), (Some(3.259_629_011_154e-8), 0));
}

#[test]
fn beidou_records_run_on_beidou_time() {
    let n = read(&format!("{HEADER}{C01}"));
    let e = n.ephemerides[0];
    // Week 694 of BeiDou time and 601200 s; week 0 of BeiDou began 1356 weeks and 14 s after that of GPS.
    assert_eq!(e.orbit_time.nanoseconds(), ((1356 + 694) * 604_800 + 601_200 + 14) * 1_000_000_000);
    assert_eq!(e.message, Message::D2);
    assert_eq!(e.group_delay(Carrier::B1I), Some(1.420000028673e-8));
}

#[test]
fn a_geostationary_beidou_satellite_stands_where_it_is_known_to_stand() {
    let n = read(&format!("{HEADER}{C01}"));
    let e = n.ephemerides[0];
    // BeiDou C01 (GEO-8) is kept at 140.0 deg E; box of a geostationary satellite some tenths of a degree, inclination below 2.5 deg.
    for minutes in [-60, 0, 60] {
        let t = GpsTime::from_nanoseconds(e.orbit_time.nanoseconds() + minutes * 60_000_000_000);
        let s = broadcast::state(&e, t).unwrap();
        let p = s.position.vector();
        assert!((p.y.atan2(p.x).to_degrees() - 140.0).abs() < 0.5, "{p:?}");
        assert!((p.norm() - 42_164e3).abs() < 60e3 && p.z.abs() < 2.5e6, "{p:?}");
        assert!(s.velocity_mps.norm() < 200.0, "{:?}", s.velocity_mps);
    }
}

/// Velocity against the change of position: the central difference over 2 s errs by a jerk of 2e-5 m/s³ times h²/6, 1e-5 m/s.
#[test]
fn velocity_is_the_change_of_position_and_drift_that_of_the_clock() {
    let n = read(&format!("{HEADER}{G01}{C01}"));
    assert_eq!(n.ephemerides.len(), 2);
    for e in &n.ephemerides {
        for offset_s in [-5400, 10, 3600] {
            let at = |s: i64| {
                broadcast::state(e, GpsTime::from_nanoseconds(e.orbit_time.nanoseconds() + (offset_s + s) * 1_000_000_000)).unwrap()
            };
            let (before, now, after) = (at(-1), at(0), at(1));
            let difference = 0.5 * (after.position.vector() - before.position.vector());
            assert!((difference - now.velocity_mps).norm() < 2e-5, "{} {:?}", e.satellite, difference - now.velocity_mps);
            assert!((0.5 * (after.clock_s - before.clock_s) - now.clock_drift).abs() < 1e-16);
        }
    }
}

#[test]
fn weeks_are_resolved_without_their_number() {
    let near = GpsTime::from_nanoseconds(2111 * 604_800_000_000_000 + 10_000_000_000);
    let before = nearest_week(604_790.0, near, 0).unwrap();
    assert_eq!(near.seconds_since(before), 20.0);
    assert_eq!(nearest_week(30.0, near, 0).unwrap().seconds_since(near), 20.0);
    assert_eq!(nearest_week(0.9999e9, near, 0), None);
}

#[test]
fn damaged_records_are_refused_with_their_line_and_the_others_stand() {
    let broken = G01.replace("5.153657373428D+03", "5.153657x73428D+03");
    let n = read(&format!("{HEADER}{broken}{C01}"));
    assert_eq!(n.ephemerides.len(), 1);
    assert_eq!(n.refused.len(), 1);
    // Record begins in line 6, the root of the axis stands two lines further on.
    assert_eq!((n.refused[0].line, n.refused[0].text.trim()), (8, "5.153657x73428D+03"));
    let cut: String = G01.lines().take(4).fold(String::new(), |s, l| s + l + "\n");
    let n = read(&format!("{HEADER}{cut}{C01}"));
    assert_eq!((n.ephemerides.len(), n.refused.len()), (1, 1));
    assert!(n.refused[0].reason.contains("ends early"));
}

#[test]
fn files_that_are_not_navigation_files_are_refused_by_name() {
    for (text, words) in [
        ("", "empty"),
        ("hello\n", "RINEX VERSION / TYPE"),
        ("     3.02           OBSERVATION DATA    M                   RINEX VERSION / TYPE\n", "'O'"),
        ("     9.00           N                   M                   RINEX VERSION / TYPE\n", "9.00"),
        ("     3.02           N                   M                   RINEX VERSION / TYPE\n", "END OF HEADER"),
    ] {
        let e = read_navigation(text.as_bytes()).unwrap_err();
        assert!(e.reason.contains(words), "{text:?}: {}", e.reason);
    }
}

#[test]
fn the_nearest_fresh_record_is_selected() {
    let later = G01.replace("2019 04 27 12 00 00", "2019 04 27 14 00 00").replace("5.616000000000D+05", "5.688000000000D+05");
    let n = read(&format!("{HEADER}{G01}{later}"));
    let records = n.of(SatelliteId { constellation: Constellation::Gps, number: 1 });
    let noon = records[0].orbit_time.nanoseconds();
    let at = |minutes: i64| {
        nearest(records, GpsTime::from_nanoseconds(noon + minutes * 60_000_000_000)).map(|k| records[k].orbit_time.nanoseconds())
    };
    assert_eq!(at(59), Some(noon));
    assert_eq!(at(60), Some(noon));
    assert_eq!(at(61), Some(noon + 7_200_000_000_000));
    assert_eq!(at(-121), None);
    assert_eq!(at(241), None);
}

proptest! {
    // Any bytes after a header, and any change of a good file: an answer, never a panic.
    #[test]
    fn no_bytes_bring_the_reader_down(tail in proptest::collection::vec(any::<u8>(), 0..600), at in 0_usize..700, byte in any::<u8>(), cut in 0_usize..1600) {
        let mut file = format!("{HEADER}{G01}{C01}").into_bytes();
        let at = at % file.len();
        file[at] = byte;
        let _ = read_navigation(&file);
        let _ = read_navigation(&file[..cut.min(file.len())]);
        let _ = read_navigation(&[HEADER.as_bytes(), &tail].concat());
        let _ = read_navigation(&[HEADER.replace("3.02", "4.00").as_bytes(), b"> EPH G01 LNAV\n", &tail].concat());
    }
}

#[test]
fn a_number_that_no_satellite_has_is_refused() {
    for (name, stands) in [("G01", true), ("G63", true), ("G64", false), ("G99", false), ("G00", false)] {
        let n = read(&format!("{HEADER}{}", G01.replace("G01", name)));
        assert_eq!((n.ephemerides.len(), n.refused.len()), (usize::from(stands), usize::from(!stands)), "{name}");
    }
}
