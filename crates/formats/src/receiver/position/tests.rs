#![allow(clippy::print_stderr)] // A test that is skipped says so.
use super::*;
use crate::stream::{Among, Frame, Frames};
use proptest::prelude::*;
use std::fs;
use std::path::Path;

/// A log of each receiver, and the positions that another decoder counts in it (tests/test_read_receivers.py has the sources).
const LOGS: [(&str, Kind, usize); 5] = [
    ("gpsd/ublox-zed-f9r.log", Kind::Ubx, 30),
    ("pysbf2/sbfdata.log", Kind::Sbf, 58),
    ("pysbf2/pygpsdata_x5pvt.log", Kind::Sbf, 16),
    ("novatel/oemv_200911218.gps", Kind::Novatel, 46),
    ("gpsd/ublox-zed-f9p-nmea.log", Kind::Nmea, 29),
];

fn logs() -> impl Iterator<Item = (Vec<u8>, Kind, usize)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/rxlogs");
    if !folder.exists() {
        eprintln!("SKIPPED ALOUD: no receiver logs at {}", folder.display());
    }
    LOGS.into_iter().filter_map(move |(name, kind, n)| Some((fs::read(folder.join(name)).ok()?, kind, n)))
}

/// Items of a decoder that is written down and read again behind every frame, or never.
fn items(frames: &[Frame<'_>], kind: Kind, ends: Ends, restored: bool) -> Vec<Item> {
    let (mut decoder, mut out) = (Decoder::new(kind, ends), Vec::new());
    for frame in frames {
        decoder.take(frame, 0, &mut out);
        if restored {
            let (state, heard) = decoder.state();
            decoder = Decoder::with_state(kind, ends, state.clone(), heard.clone());
        }
    }
    decoder.finish(&mut out);
    out
}

fn positions(items: &[Item]) -> Vec<&Position> {
    items.iter().filter_map(|item| if let Item::Position(position) = item { Some(position.as_ref()) } else { None }).collect()
}

#[test]
fn a_kind_is_known_by_its_id() {
    for kind in Kind::ALL {
        assert_eq!(Kind::of(kind.id()), Some(kind));
    }
    assert_eq!(Kind::of("rtcm"), None);
}

#[test]
fn a_log_has_the_positions_that_another_decoder_counts() {
    for (bytes, kind, n) in logs() {
        let log = log::read(&bytes, kind);
        assert_eq!(log.positions.len(), n, "{kind:?}");
        assert_eq!(log.n_rows, n + log.absent.len(), "{kind:?}");
        assert!(log.positions.iter().all(|p| p.time.is_some() && p.absent.is_none()), "{kind:?}");
    }
}

#[test]
fn a_decoder_that_is_written_down_behind_every_frame_gives_the_same() {
    for (bytes, kind, n) in logs() {
        let frames: Vec<Frame<'_>> = Frames::new(&bytes, Among::Receivers).filter_map(|place| place.frame.ok()).collect();
        for ends in [Ends::WithLast, Ends::WithNext] {
            let whole = items(&frames, kind, ends, false);
            assert_eq!(items(&frames, kind, ends, true), whole, "{kind:?}");
            assert!(positions(&whole).len() >= n, "{kind:?}");
        }
    }
}

/// A live decoder ends an epoch by habit: after the first epochs it has learnt, and differs in nothing from the file's but the dates.
#[test]
fn a_stream_has_the_positions_of_the_file() {
    for (bytes, kind, n) in logs() {
        let frames: Vec<Frame<'_>> = Frames::new(&bytes, Among::Receivers).filter_map(|place| place.frame.ok()).collect();
        let live = items(&frames, kind, Ends::WithLast, false);
        let of_file = log::read(&bytes, kind).positions;
        let undated = |p: &Position| Position { record: 0, of_day: None, ..p.clone() };
        let of_file: Vec<Position> = of_file.iter().map(undated).collect();
        let same = positions(&live).into_iter().map(undated).filter(|position| of_file.contains(position)).count();
        assert!(same + 2 >= n, "{kind:?}: {same} of {n}");
    }
}

/// PVTGeodetic in a week whose nanoseconds exceed 64 bits.
#[test]
fn a_week_beyond_every_time_is_outside_its_domain() {
    for (week, usable) in [(2361_u16, true), (60_000, false)] {
        let mut body = vec![0; 68];
        body[4..6].copy_from_slice(&week.to_le_bytes());
        body[6] = 1;
        body[8..16].copy_from_slice(&0.5_f64.to_le_bytes());
        let mut out = Vec::new();
        let mut decoder = Decoder::new(Kind::Sbf, Ends::WithNext);
        decoder.take(&Frame::Sbf { block: 4007, body: &body }, 1, &mut out);
        decoder.finish(&mut out);
        let reasons: Vec<_> = positions(&out).iter().map(|p| p.absent.as_ref().map(|absent| absent.reason)).collect();
        assert_eq!(reasons, [(!usable).then_some(Reason::OutsideDomain)], "week {week}");
    }
}

/// Of PVTGeodetic; a receiver that stands states none.
#[test]
fn the_course_over_ground_is_that_of_its_field() {
    for (course_deg, expected) in [(90.0_f32, Some(90.0)), (-2e10, None)] {
        let mut body = vec![0; 68];
        body[4..6].copy_from_slice(&2361_u16.to_le_bytes());
        body[6] = 1;
        body[8..16].copy_from_slice(&0.5_f64.to_le_bytes());
        body[48..52].copy_from_slice(&course_deg.to_le_bytes());
        let mut out = Vec::new();
        let mut decoder = Decoder::new(Kind::Sbf, Ends::WithNext);
        decoder.take(&Frame::Sbf { block: 4007, body: &body }, 1, &mut out);
        decoder.finish(&mut out);
        assert_eq!(positions(&out).first().and_then(|p| p.ground_track_rad.map(f64::to_degrees)), expected);
    }
}

fn sentence(body: &str) -> Vec<u8> {
    let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("${body}*{sum:02X}\r\n").into_bytes()
}

fn read_sentences(bodies: &[&str]) -> log::Log {
    log::read(&bodies.iter().flat_map(|body| sentence(body)).collect::<Vec<_>>(), Kind::Nmea)
}

#[test]
fn an_angle_without_a_hemisphere_is_none() {
    let zda = "GPZDA,120000.00,22,11,2026,00,00";
    for (hemisphere, n) in [("N", 1), ("S", 1), ("", 0), ("E", 0)] {
        let log = read_sentences(&[zda, &format!("GPGGA,120000.00,4900.0,{hemisphere},00230.0,E,1,08,1.0,100.0,M,47.0,M,,")]);
        assert_eq!((log.positions.len(), log.n_rows), (n, 1), "{hemisphere}");
    }
}

#[test]
fn two_positions_of_one_time_are_two() {
    let gga = |minutes: &str| format!("GPGGA,120000.00,{minutes},N,00230.0,E,1,08,1.0,100.0,M,47.0,M,,");
    let log = read_sentences(&["GPZDA,120000.00,22,11,2026,00,00", &gga("4900.0"), &gga("4901.0")]);
    assert_eq!(log.positions.len(), 2);
}

/// A receiver of two systems writes GPGGA and GLGGA.
#[test]
fn the_positions_of_two_talkers_at_one_time_are_one() {
    let gga = |talker: &str, lat: &str, quality: u8| format!("{talker}GGA,120000.00,{lat},N,00230.0,E,{quality},08,1.0,100.0,M,47.0,M,,");
    for (ends, mut epochs) in [(Ends::WithNext, 0), (Ends::WithLast, 0)] {
        let mut decoder = Decoder::new(Kind::Nmea, ends);
        for second in 0..4 {
            for body in [ZDA, &gga("GP", "4900.0", 1), &gga("GL", "4900.0", 1), GST] {
                let mut out = Vec::new();
                decoder.take(&Frame::Nmea(body.replace("120000", &format!("12000{second}")).as_bytes()), 1, &mut out);
                assert!(positions(&out).iter().all(|p| p.covariance_m2.is_some() && p.absent.is_none()), "{out:?}");
                epochs += positions(&out).len();
            }
        }
        assert_eq!(epochs, if ends == Ends::WithNext { 3 } else { 4 });
    }
    for (first, second, says) in [
        (gga("GP", "4900.0", 1), gga("GL", "4901.2", 1), Some("position of GGA 2224 m away")),
        (gga("GP", "4900.0", 1), gga("GL", "4901.2", 0), None),
        (gga("GP", "4901.2", 0), gga("GL", "4900.0", 1), None),
        (gga("GP", "4900.0", 1), gga("GL", "4901.2", 8), Some("position of GGA 2224 m away")),
        (gga("GP", "4900.0", 1), gga("GL", "4900.0", 6), None),
        (gga("GP", "4900.0", 0), gga("GL", "4900.0", 0), Some("quality 0, latitude 4900.0")),
    ] {
        let stated = reasons(&[ZDA, &first, &second, GST]);
        assert_eq!(stated.first().map(|(_, words)| words.as_str()), says, "{first} {second}");
        assert!(stated.len() < 2);
    }
}

#[test]
fn the_error_that_garmin_states_stands_where_no_other_does_and_is_not_passed_over() {
    let of = |more: &[&str]| {
        let log = read_sentences(&[&[ZDA, GGA], more].concat());
        (log.positions[0].covariance_m2.map(|v| [v[0], v[2], v[5]]), log.positions[0].notes[1], log.left_out.len())
    };
    assert_eq!(of(&["PGRME,15.0,M,45.0,M,25.0,M"]), (Some([225.0, 225.0, 2025.0]), Some(Note::ErrorOfNoShare), 0));
    // The larger of several.
    assert_eq!(of(&["PGRME,15.0,M,45.0,M,25.0,M", "PGRME,900.0,M,45.0,M,25.0,M"]).0, Some([8.1e5, 8.1e5, 2025.0]));
    let (beside, note, _) = of(&[GST, "PGRME,900.0,M,45.0,M,25.0,M"]);
    assert!(beside.is_some_and(|v| v[0] + v[1] > 1.6e6) && note == Some(Note::WorseExpectedErrors), "{beside:?}");
    assert_eq!(of(&["PGRME,,M,,M,,M"]), (None, None, 0));
    assert_eq!(of(&["PGRME,15.0,F,45.0,F,25.0,F"]), (None, None, 0));
    assert_eq!(of(&["PGRME,15.0,,45.0,,25.0,"]).0, Some([225.0, 225.0, 2025.0]));
    assert_eq!(of(&["PGRME,,M,,M,900.0,M"]).0, Some([8.1e5, 8.1e5, 8.1e5]));
    // None is known.
    assert_eq!(of(&["PGRME,-1,M,-1,M,-1,M"]), (None, None, 0));
}

#[test]
fn a_time_of_day_that_is_none_is_reported() {
    let log = read_sentences(&[ZDA, GGA, GST, "GPGGA,120001.x,4900.0,N,00230.0,E,1,08,1.0,100.0,M,47.0,M,,", "GPRMC,120001.x,A,4900.0,N"]);
    let reasons: Vec<_> = log.left_out.iter().map(|l| (l.reason, l.example.as_str())).collect();
    let expected = ("time_not_known", "time 120001.x, quality 1, latitude 4900.0");
    assert_eq!(reasons, [expected, ("damaged_message", "the time of day of a sentence is none")]);
    assert_eq!((log.n_rows, log.absent.len()), (2, 1));
}

/// Two receivers in one log, whose clocks differ.
#[test]
fn a_place_of_another_time_far_away_takes_the_positions_behind_it() {
    let rmc = |lat: &str, knots: &str| format!("IIRMC,12000S.50,A,{lat},N,00230.0000,E,{knots},80.0,221126,,,A");
    let gll = |lat: &str| format!("IIGLL,{lat},N,00230.0000,E,12000S.30,A,A");
    let gns = |lat: &str| format!("IIGNS,12000S.99,{lat},N,00230.0000,E,AA,09,1.0,100.0,47.0,,,");
    for (other, n_against, says) in [
        (rmc("4901.2000", "1.0"), 3, "position of RMC 2224 m away, 0.50 s apart"),
        (rmc("4900.0700", "1.0"), 3, "position of RMC 130 m away, 0.50 s apart"),
        (rmc("4900.0700", "200.0"), 0, ""),
        (rmc("4900.0000", "1.0"), 0, ""),
        (gll("4900.4000"), 3, "position of GLL 741 m away, 0.30 s apart"),
        (gll("4900.2000"), 0, ""),
        (gll("4902.0000").replace("12000S.30", ""), 3, "position of GLL without a time 3707 m away"),
        ("IIGLL,4902.0000,N,00230.0000,E".to_owned(), 3, "position of GLL without a time 3707 m away"),
        (rmc("4902.0000", "1.0").replace("12000S.50", ""), 3, "position of RMC without a time 3707 m away"),
        (gll("4900.2000").replace("12000S.30", ""), 0, ""),
        (
            "PUBX,00,12000S.50,4910.0,N,00230.0,E,100.0,G3,5.0,8.0,0.1,0.0,0.0,,1.0,1.5,1.2,9,0,0".to_owned(),
            3,
            "position of PUBX 18535 m away, 0.50 s apart",
        ),
        ("PUBX,00,12000S.50,4900.0,N,00230.0,E,100.0,NF,5.0,8.0,0.1,0.0,0.0,,1.0,1.5,1.2,9,0,0".to_owned(), 3, "PUBX fix NF"),
        (gns("4910.0000"), 3, "position of GNS 18535 m away, 0.99 s apart"),
        (rmc("4901.2000", "1.0").replace(",A,4901", ",V,4901"), 0, ""),
    ] {
        for ends in [Ends::WithNext, Ends::WithLast] {
            let mut decoder = Decoder::new(Kind::Nmea, ends);
            let mut out = Vec::new();
            for second in 0..4 {
                for body in [ZDA, GGA, GST, &other] {
                    let body = body.replace("120000", &format!("12000{second}")).replace("12000S", &format!("12000{second}"));
                    decoder.take(&Frame::Nmea(body.as_bytes()), 1, &mut out);
                }
            }
            decoder.finish(&mut out);
            let stated: Vec<_> = positions(&out).iter().filter_map(|p| p.absent.as_ref()).collect();
            let against: Vec<_> = stated.iter().filter(|a| a.reason == Reason::Contradicted).map(|a| a.stated.as_str()).collect();
            // A stream knows the first position one epoch later.
            let late = usize::from(ends == Ends::WithLast && n_against > 0 && against.len() < n_against);
            assert_eq!(against, vec![says; n_against - late], "{other} {ends:?}");
        }
    }
    // A clock that is 18 s behind: a vehicle goes 6.7 km in that time.
    let behind = |lat: &str| rmc(lat, "1.0").replace("12000S.50", "115942.00");
    for (lat, n) in [("4910.0000", 1), ("4903.0000", 0)] {
        let stated = reasons(&[ZDA, GGA, GST, &behind(lat), &GGA.replace("120000", "120001")]);
        assert_eq!(stated.iter().filter(|(reason, _)| *reason == "contradicted").count(), n, "{stated:?}");
    }
    // A minute later nobody knows; at midnight a second is one.
    let of_a_minute = rmc("4901.2000", "1.0").replace("12000S.50", "120100.00");
    assert_eq!(reasons(&[ZDA, GGA, GST, &of_a_minute, &GGA.replace("120000", "120101")]), []);
    let at_midnight = [
        GGA.replace("120000.00", "235959.50"),
        rmc("4901.2", "1.0").replace("12000S.50", "000000.00"),
        GGA.replace("120000.00", "000000.50"),
    ];
    let stated = reasons(&[&ZDA.replace("120000", "235958"), &at_midnight[0], &at_midnight[1], &at_midnight[2]]);
    assert!(stated.iter().any(|(reason, words)| *reason == "contradicted" && words.contains("0.50 s apart")), "{stated:?}");
}

#[test]
fn an_accuracy_of_another_time_is_kept_beside_the_next_position() {
    let log = read_sentences(&[ZDA, GGA, "GPGST,120000.50,1.0,,,,3000.0,4000.0,5.0", &GGA.replace("120000", "120001")]);
    let stated: Vec<_> = log.positions.iter().map(|p| (p.covariance_m2, p.unread_accuracy_m)).collect();
    assert_eq!(stated, [(None, None), (None, Some(5000.0))]);
}

#[test]
fn a_text_an_alarm_and_the_dilution_of_gns_speak_against_a_position() {
    for (other, says) in [
        ("GNTXT,01,01,01,SPOOFING INDICATED", true),
        ("GNTXT,01,01,02,ANTSTATUS=OK", false),
        ("GNTXT,01,01,02,no spoofing indicated", false),
        ("GPALR,120000.00,001,A,V,GPS POSITION LOST", true),
        ("GPALR,120000.00,001,V,V,GPS POSITION LOST", false),
        ("GPALF,1,1,0,120000.00,A,W,V,,002,1,0,LOST POSITION", true),
        ("GPALF,1,1,0,120000.00,A,W,N,,002,1,0,LOST POSITION", false),
        ("GNTXT,01,01,01,Jamming detection enabled", false),
        ("GNTXT,01,01,01,anti-jamming active", false),
        ("GNTXT,01,01,01,POSITION INVALID", true),
        ("GNTXT,01,01,01,RAIM FAILURE", true),
        ("GNGNS,120000.00,4900.0000,N,00230.0000,E,AA,09,99.9,100.0,47.0,,,", true),
        ("GNGNS,120000.00,4900.0000,N,00230.0000,E,AA,09,0.9,100.0,47.0,,,", false),
    ] {
        assert_eq!(reasons(&[ZDA, GGA, other, GST]).len(), usize::from(says), "{other}");
    }
}

#[test]
fn bytes_that_are_no_text_make_no_sentence() {
    let rmc = b"GPRMC,120000.00,A,4900.0\xb0,N,00230.0,E,1.0,80.0,221126,,,A";
    let mut out = Vec::new();
    Decoder::new(Kind::Nmea, Ends::WithNext).take(&Frame::Nmea(rmc), 7, &mut out);
    assert!(matches!(out.as_slice(), [Item::Malformed(malformed)] if malformed.record == 7), "{out:?}");
}

#[test]
fn the_deviations_of_another_time_are_not_borrowed() {
    let gga = "GPGGA,120000.00,4900.0,N,00230.0,E,1,08,1.0,100.0,M,47.0,M,,";
    let zda = "GPZDA,120000.00,22,11,2026,00,00";
    let beside = read_sentences(&[zda, "GPGST,120000.00,1.0,,,,2.0,3.0,4.0", gga]);
    assert_eq!(beside.positions[0].covariance_m2, Some([9.0, 0.0, 4.0, 0.0, 0.0, 16.0]));
    let apart = read_sentences(&[zda, gga, "GPGST,120001.00,1.0,,,,2.0,3.0,4.0"]);
    assert_eq!(apart.positions[0].covariance_m2, None);
}

/// The order and the times of a Trimble receiver: the date is of three hundredths of a second after the position.
#[test]
fn a_date_between_a_position_and_its_accuracy_takes_nothing_from_it() {
    let second = |k: u32| {
        [
            format!("GPGGA,1405{k:02}.00,4846.84220217,N,00910.29559526,E,2,09,1.0,279.827,M,47.985,M,4.0,0123"),
            format!("GPZDA,1405{k:02}.03,03,11,2022,00,00"),
            format!("GPGST,1405{k:02}.00,0.510,0.800,0.588,0.0,0.799,0.590,1.331"),
        ]
    };
    let bodies: Vec<String> = (10..40).flat_map(second).collect();
    let log = read_sentences(&bodies.iter().map(String::as_str).collect::<Vec<_>>());
    assert_eq!((log.positions.len(), log.left_out.len()), (30, 0));
    for p in &log.positions {
        let variances = p.covariance_m2.unwrap();
        assert!((variances[0] - 0.590_f64.powi(2)).abs() < 1e-12 && (variances[2] - 0.799_f64.powi(2)).abs() < 1e-12);
    }
}

#[test]
fn an_accuracy_beside_no_position_is_counted() {
    let gga = "GPGGA,120000.00,4900.0,N,00230.0,E,1,08,1.0,100.0,M,47.0,M,,";
    let zda = "GPZDA,120000.00,22,11,2026,00,00";
    let log = read_sentences(&[zda, gga, "GPGST,120001.00,1.0,,,,2.0,3.0,4.0", "GPGST,120002.00,1.0,,,,2.0,3.0,4.0"]);
    let unpaired = log.left_out.iter().find(|each| each.reason == "accuracy_without_position").unwrap();
    assert_eq!((unpaired.count, unpaired.damaged, log.positions.len(), log.n_rows), (2, false, 1, 1));
}

#[test]
fn the_speed_is_that_of_a_valid_rmc_of_the_same_time() {
    let gga = |second: u32| format!("GPGGA,1200{second:02}.00,4900.0,N,00230.0,E,1,08,1.0,100.0,M,47.0,M,,");
    let rmc =
        |second: u32, state: &str, knots: &str| format!("GPRMC,1200{second:02}.00,{state},4900.0,N,00230.0,E,{knots},90.0,221126,,,A");
    let of = |bodies: &[String]| {
        let log = read_sentences(&bodies.iter().map(String::as_str).collect::<Vec<_>>());
        log.positions.iter().map(|p| p.ground_speed_mps).collect::<Vec<_>>()
    };
    // 36 knots are 18.52 m/s.
    for both in [[gga(1), rmc(1, "A", "36.0")], [rmc(1, "A", "36.0"), gga(1)]] {
        assert!(matches!(of(&both)[..], [Some(speed)] if (speed - 18.52).abs() < 1e-12));
    }
    assert_eq!(of(&[gga(1), rmc(1, "A", "")]), [None]);
    assert_eq!(of(&[gga(1), rmc(1, "A", "-5.0")]), [None]);
    assert_eq!(of(&[rmc(0, "A", "36.0"), gga(1)]), [None]);
    // Of two satellite systems: the second sentence of a time takes the position away from nobody.
    let gst = "GPGST,120001.00,1.0,,,,2.0,3.0,4.0".to_owned();
    let log = read_sentences(&[&gga(1), &rmc(1, "A", "36.0"), &rmc(1, "A", "37.0"), &gst].map(String::as_str));
    assert!(log.positions.len() == 1 && log.positions[0].covariance_m2.is_some());
}

const ZDA: &str = "GPZDA,120000.00,22,11,2026,00,00";
const GGA: &str = "GPGGA,120000.00,4900.0000,N,00230.0000,E,1,08,1.0,100.0,M,47.0,M,,";
const GST: &str = "GPGST,120000.00,1.0,,,,2.0,3.0,4.0";

/// What the sentences of one time say: reasons of those that are no position.
fn reasons(bodies: &[&str]) -> Vec<(&'static str, String)> {
    read_sentences(bodies).left_out.into_iter().map(|each| (each.reason, each.example)).collect()
}

#[test]
fn what_another_sentence_says_against_a_position_takes_it_away() {
    let rmc = |status: &str, mode: &str, minutes: &str| format!("GPRMC,120000.00,{status},{minutes},N,00230.0000,E,0.0,,221126,,,{mode},V");
    let gll = |status: &str, mode: &str| format!("GPGLL,4900.0000,N,00230.0000,E,120000.00,{status},{mode}");
    let gsa = |talker: &str, fix: u8| format!("{talker}GSA,A,{fix},01,02,03,04,,,,,,,,,2.0,1.0,1.7");
    let pubx =
        |fix: &str, minutes: &str| format!("PUBX,00,120000.00,{minutes},N,00230.0000,E,147.0,{fix},2.1,3.0,0.0,0.0,0.0,,0.9,1.2,0.8,8,0,0");
    for (other, says) in [
        (rmc("V", "N", "4900.0000"), "RMC status V"),
        (rmc("A", "S", "4900.0000"), "RMC mode S"),
        (rmc("A", "E", "4900.0000"), "RMC mode E"),
        (rmc("A", "M", "4900.0000"), "RMC mode M"),
        (rmc("A", "A", "4901.0000"), "position of RMC 1854 m away"),
        (gll("V", "A"), "GLL status V"),
        (gll("A", "N"), "GLL mode N"),
        (gsa("GP", 1), "GSA fix 1"),
        (gsa("GP", 2), "GSA fix 2"),
        (gsa("GP", 3).replace(",1.0,", ",99.9,"), "GSA HDOP 99.9"),
        (pubx("NF", "4900.0000"), "PUBX fix NF"),
        (pubx("DR", "4900.0000"), "PUBX fix DR"),
        (pubx("G3", "4901.0000"), "position of PUBX 1854 m away"),
        // 0.4 and 0.2 minutes of arc.
        ("GPDTM,TOY,,0.4,N,0.2,W,0.0,W84".to_owned(), "DTM datum TOY, 829 m away"),
        ("GPDTM,NAD,,,,,,,W84".to_owned(), "DTM datum NAD"),
        // A datum that a user defined may be any: its offsets are of the place, and are of no use elsewhere.
        ("GPDTM,999,,0.001,N,0.0,E,0.0,W84".to_owned(), "DTM datum 999, 2 m away"),
        ("GPDTM,NAD27,,0.0,N,0.0,E,0.0,W84".to_owned(), "DTM datum NAD27"),
        ("GPDTM,W84,,0.1,N,0.0,E,0.0,W84".to_owned(), "DTM datum W84, 185 m away"),
        ("GPDTM,,,0.1,N,,E,0.0,W84".to_owned(), "DTM datum that has no name, 185 m away"),
        ("GPDTM,W84,,0x1,N,0.0,E,0.0,W84".to_owned(), "DTM datum W84, offset 0x1"),
        // Turned by 0.554 seconds of arc: 17 m at the equator.
        ("GPDTM,W72,,,,,,,W84".to_owned(), "DTM datum W72"),
    ] {
        // Before the position, behind it, and behind its accuracy.
        for order in [[ZDA, &other, GGA, GST], [ZDA, GGA, &other, GST], [ZDA, GGA, GST, &other]] {
            if order[1].contains("GSA") {
                continue; // It has no time: before the first sentence of an epoch it is of the one before.
            }
            assert_eq!(reasons(&order), [("contradicted", says.to_owned())], "{order:?}");
        }
    }
    for other in [
        rmc("A", "A", "4900.0000"),
        rmc("A", "D", "4900.0000"),
        rmc("A", "", "4900.0000"),
        // 18.5 m, and as far as two decimals can be.
        rmc("A", "A", "4900.0100"),
        rmc("A", "R", "4900.02"),
        gll("A", "A"),
        gsa("GN", 3),
        pubx("D3", "4900.0000"),
        "GPDTM,W84,,0.0,N,0.0,E,0.0,W84".to_owned(),
        "GPDTM,P90,,,,,,,W84".to_owned(),
        // As the receivers of telephones write it, 5 cm off.
        "GNDTM,P90,,0000.000026,S,00000.000002,E,0.977,W84".to_owned(),
        // It says nothing.
        "GPDTM,,,,,,,,".to_owned(),
        // Satellites of the same maker, which are no position.
        "PUBX,03,11,23,-,,,45,010".to_owned(),
    ] {
        assert_eq!(reasons(&[ZDA, GGA, &other, GST]), [], "{other}");
    }
    // Each RMC, GLL and GNS of the epoch is heard, whose ever, in any order.
    let again = |talker: &str| rmc("A", "A", "4918.0000").replace("GPRMC", talker);
    for other in [again("GPRMC"), again("INRMC"), "GLGLL,4918.0000,N,00230.0000,E,120000.00,A,A".to_owned(), rmc("V", "N", "")] {
        for order in
            [[&rmc("A", "A", "4900.0000"), GGA, &gll("A", "A"), &other], [&rmc("A", "A", "4900.0000"), &gll("A", "A"), &other, GGA]]
        {
            assert_eq!(
                reasons(&[&[ZDA], &order[..], &[GST]].concat()).first().map(|(reason, _)| *reason),
                Some("contradicted"),
                "{order:?}"
            );
        }
    }
    // However many there are, they are of one epoch; of GNS one system that measures is enough.
    let many: Vec<String> =
        ["GP", "GN", "GL", "GA", "GB", "II", "IN", "EC", "GP"].map(|of| rmc("A", "A", "4900.0000").replacen("GP", of, 1)).to_vec();
    let bodies: Vec<&str> = [ZDA].into_iter().chain(many.iter().map(String::as_str)).chain([GGA, GST]).collect();
    assert_eq!((read_sentences(&bodies).n_rows, reasons(&bodies).len()), (1, 0));
    // More different ones than are kept are counted: none is passed over in silence.
    let moved: Vec<String> = (0..18).map(|k| rmc("A", "A", &format!("4900.00{k:02}"))).collect();
    let bodies: Vec<&str> = [ZDA].into_iter().chain(moved.iter().map(String::as_str)).chain([GGA, GST]).collect();
    assert_eq!(reasons(&bodies), [("damaged_message", "more different sentences of one kind than an epoch has".to_owned())]);
    assert_eq!(read_sentences(&bodies).left_out[0].count, 2);
    // A stream ends no epoch before its last sentence, however often it is repeated: an RMC that is far away ends it.
    for n in 1..20 {
        let mut bodies = vec![ZDA.to_owned()];
        for second in 0..6 {
            let of = |body: &str| body.replace("120000", &format!("12000{second}"));
            bodies.push(of(GGA));
            bodies.extend((0..n).map(|k| of(&rmc("A", "A", "4900.0000")).replacen("GP", ["GP", "GN", "II"][k % 3], 1)));
            bodies.push(of(&rmc("A", "A", "4918.0000")));
        }
        let frames: Vec<Frame<'_>> = bodies.iter().map(|body| Frame::Nmea(body.as_bytes())).collect();
        let stated = |p: &&Position| p.absent.as_ref().map(|absent| absent.reason);
        let all = items(&frames, Kind::Nmea, Ends::WithLast, false);
        let damaged = all.iter().filter(|item| matches!(item, Item::Malformed(_))).count();
        let expected = if n < 16 { (vec![Some(Reason::Contradicted); 6], 0) } else { (vec![None; 6], 6) };
        assert_eq!((positions(&all).iter().map(stated).collect::<Vec<_>>(), damaged), expected, "{n}");
    }
    let gns = |talker: &str, mode: &str| format!("{talker}GNS,120000.00,4900.0000,N,00230.0000,E,{mode},08,1.0,100.0,45.0,,");
    assert_eq!(reasons(&[ZDA, GGA, &gns("GP", "A"), &gns("GL", "N"), GST]), []);
    assert_eq!(reasons(&[ZDA, GGA, &gns("GP", "N"), &gns("GL", "N"), GST]), [("contradicted", "GNS mode N".to_owned())]);
    // The system without a satellite says that it has no fix.
    for systems in [[gsa("GP", 3), gsa("GL", 1)], [gsa("GL", 1), gsa("GP", 3)]] {
        assert_eq!(reasons(&[ZDA, GGA, &systems[0], &systems[1], GST]), []);
    }
    // A sentence of another time says nothing of this one: it is an epoch without a position.
    let later = read_sentences(&[ZDA, GGA, GST, &rmc("V", "N", "4900.0000").replace("120000", "120001")]);
    assert_eq!((later.positions.len(), later.absent.len(), later.left_out[0].reason), (1, 1, Reason::NoFix.id()));
    assert_eq!(later.left_out[0].example, "RMC without a fix, and no GGA");
    // Its own count of satellites takes no position away: some receivers always write 0. A log keeps it, a stream does not use it.
    let few = read_sentences(&[ZDA, &GGA.replace(",08,", ",00,"), GST]);
    assert_eq!((few.positions.len(), few.left_out.len(), few.absent.len()), (1, 0, 0));
    let stated = few.positions[0].absent.as_ref().map(|absent| (absent.reason, absent.stated.as_str()));
    assert_eq!((few.positions[0].n_sv, stated), (Some(0), Some((Reason::FewSatellites, "0 satellites"))));
    // What lies nowhere is no position, however few satellites it states, and so is what states that it has no geometry.
    let few = GGA.replace(",08,", ",00,");
    let field = |number: usize, value: &str| {
        let mut fields: Vec<&str> = few.split(',').collect();
        fields[number] = value;
        reasons(&[ZDA, &fields.join(","), GST]).into_iter().map(|(reason, _)| reason).collect::<Vec<_>>()
    };
    assert_eq!(field(2, "47150"), [Reason::OutsideDomain.id()]);
    assert_eq!(field(8, "99.99"), [Reason::Dilution.id()]);
    // What another sentence says counts before it.
    let both = reasons(&[ZDA, &GGA.replace(",08,", ",00,"), GST, &rmc("V", "N", "4900.0000")]);
    assert_eq!(both, [("contradicted", "RMC status V".to_owned())]);
}

#[test]
fn a_speed_that_rmc_does_not_state_is_that_of_vtg() {
    let rmc = |knots: &str, course: &str| format!("GPRMC,120000.00,A,4900.0000,N,00230.0000,E,{knots},{course},221126,,,A,V");
    let vtg = |text: &str| format!("GPVTG,{text}");
    let stated = |more: &[&str]| {
        let mut bodies = vec![ZDA, GGA];
        bodies.extend(more);
        bodies.push(GST);
        let log = read_sentences(&bodies);
        let position = &log.positions[0];
        (position.ground_speed_mps, position.ground_track_rad.map(f64::to_degrees), position.fields.last().map(|each| each.1))
    };
    let both = vtg("90.0,T,,M,100.0,N,185.2,K,A");
    // 100 knots are 185200 m an hour.
    let speed = 185_200.0 / 3600.0;
    for (more, expected) in [
        (vec![rmc("20.0", "10.0"), both.clone()], (Some(20.0 * 1852.0 / 3600.0), "RMC")),
        (vec![rmc("", ""), both.clone()], (Some(speed), "VTG")),
        (vec![both], (Some(speed), "VTG")),
        (vec![vtg("90.0,T,,M,,N,185.2,K")], (Some(speed), "VTG")),
        (vec![vtg("90.0,T,,M,100.0,N,185.2,K,N")], (None, "GGA, dated by RMC or ZDA:utc")),
        (vec![vtg(",T,,M,,N,,K,N")], (None, "GGA, dated by RMC or ZDA:utc")),
        (vec![vtg(",,,,,,,,,N")], (None, "GGA, dated by RMC or ZDA:utc")),
        // The form without letters.
        (vec![vtg("90.0,,100.0,185.2")], (Some(speed), "VTG")),
        (vec![vtg("90.0,92.0,100.0,")], (Some(speed), "VTG")),
        (vec![vtg("90.0,,,185.2")], (Some(speed), "VTG")),
        (vec![vtg(",,,")], (None, "GGA, dated by RMC or ZDA:utc")),
    ] {
        let (speed_mps, course, from) = stated(&more.iter().map(String::as_str).collect::<Vec<_>>());
        assert_eq!(from, Some(expected.1), "{more:?}");
        assert_eq!(speed_mps.is_some(), expected.0.is_some(), "{more:?}");
        assert!(speed_mps.zip(expected.0).is_none_or(|(mine, other)| (mine - other).abs() < 1e-9), "{more:?}");
        assert!(expected.1 != "VTG" || course.is_some_and(|course| (course - 90.0).abs() < 1e-9), "{more:?}");
    }
}

#[test]
fn a_speed_over_ground_in_a_form_that_is_not_read_is_counted() {
    for vtg in [
        "90.0,,100.0,360.0",       // Knots that are not the kilometres an hour.
        "90.0,,100.0,185.2,A",     // Neither form.
        "90.0,T,,M,100.0,K,,",     // Another unit.
        "90.0,T,,M,1o0.0,N,,K",    // No number.
        "90.0,T,,M,100.0,,185.2,", // No unit.
    ] {
        let log = read_sentences(&[ZDA, GGA, &format!("GPVTG,{vtg}"), GST]);
        let counted: Vec<_> = log.left_out.iter().map(|each| (each.reason, each.count)).collect();
        assert_eq!((counted, log.positions[0].ground_speed_mps), (vec![("damaged_message", 1)], None), "{vtg}");
    }
}

#[test]
fn the_worse_of_two_accuracies_of_one_epoch_counts() {
    let log = read_sentences(&[ZDA, GGA, GST, "GPGBS,120000.00,900.0,900.0,900.0,,,,"]);
    let [ee, _, nn, _, _, uu] = log.positions[0].covariance_m2.unwrap();
    assert!(ee >= 9e5 * 0.6 && nn >= 9e5 * 0.3 && (ee + nn) / (2.0 * 8.1e5) > 0.999 && (uu / 8.1e5 - 1.0).abs() < 1e-12);
    assert_eq!(log.notes, [Note::WorseExpectedErrors]);
    let log = read_sentences(&[ZDA, GGA, GST, "GPGBS,120000.00,1.0,1.0,1.0,,,,"]);
    assert_eq!((log.positions[0].covariance_m2, log.notes.as_slice()), (Some([9.0, 0.0, 4.0, 0.0, 0.0, 16.0]), &[][..]));
    // A deviation that is no size is damage, and is counted.
    for gst in ["GPGST,120000.00,1.0,,,,-2.0,3.0,4.0", "GPGST,120000.00,1.0,,,,x,3.0,4.0"] {
        let log = read_sentences(&[ZDA, GGA, gst]);
        assert_eq!((log.positions[0].covariance_m2, log.left_out.len()), (None, 1), "{gst}");
    }
}

#[test]
fn the_zeros_of_a_receiver_without_a_position_are_none() {
    let at = |lat: &str, lon: &str| reasons(&[ZDA, &GGA.replace("4900.0000", lat).replace("00230.0000", lon), GST]);
    assert_eq!(at("0000.0000", "00000.0000").first().map(|(reason, _)| *reason), Some("outside_domain"));
    assert_eq!(at("0000.0000", "00000.0001"), []);
}

proptest! {
    #[test]
    fn any_bytes_are_read_and_every_position_is_sound(bytes in prop::collection::vec(any::<u8>(), 0..400), kind in 0..4_usize) {
        let log = log::read(&bytes, Kind::ALL[kind]);
        prop_assert!(log.n_outside <= bytes.len());
        for p in &log.positions {
            prop_assert!(p.lat_rad.is_some_and(|lat| lat.abs() <= FRAC_PI_2) && p.time.is_some());
        }
    }
}

#[test]
fn a_dilution_that_hardly_determines_a_position_takes_it() {
    let of = |hdop: &str| reasons(&[ZDA, &GGA.replace(",08,1.0,", &format!(",08,{hdop},")), GST]);
    assert_eq!(of("30.0"), []);
    assert_eq!(of("99.99"), [("implausible_dilution", "dilution 99.99".to_owned())]);
}

/// NAV-PVT with a position dilution in hundredths and everything else in order.
#[test]
fn the_dilution_of_a_u_blox_position_counts() {
    for (pdop, taken) in [(150_u16, false), (3000, false), (9999, true)] {
        let mut pvt = vec![0; 92];
        pvt[4..6].copy_from_slice(&2026_u16.to_le_bytes());
        (pvt[6], pvt[7], pvt[11], pvt[20], pvt[21], pvt[23]) = (11, 22, 0b111, 3, 1, 9);
        pvt[24..28].copy_from_slice(&25_000_000_i32.to_le_bytes());
        pvt[28..32].copy_from_slice(&490_000_000_i32.to_le_bytes());
        pvt[40..44].copy_from_slice(&3000_u32.to_le_bytes());
        pvt[76..78].copy_from_slice(&pdop.to_le_bytes());
        let mut out = Vec::new();
        let mut decoder = Decoder::new(Kind::Ubx, Ends::WithNext);
        decoder.take(&Frame::Ubx { kind: [0x01, 0x07], payload: &pvt }, 1, &mut out);
        decoder.finish(&mut out);
        let reasons: Vec<_> = positions(&out).iter().map(|p| p.absent.as_ref().map(|absent| absent.reason)).collect();
        assert_eq!(reasons, [taken.then_some(Reason::Dilution)], "{pdop}");
    }
}

#[test]
fn what_several_talkers_say_of_an_accuracy_is_worth_its_worst() {
    let poor = "GPGST,120000.00,1.0,,,,2000.0,3000.0,4000.0";
    for order in [[ZDA, GGA, GST, poor], [ZDA, GGA, poor, GST]] {
        let log = read_sentences(&order);
        let [ee, _, nn, _, _, uu] = log.positions[0].covariance_m2.unwrap();
        assert!([(ee, 9e6), (nn, 4e6), (uu, 1.6e7)].iter().all(|(v, w)| (v / w - 1.0).abs() < 1e-9), "{ee} {nn} {uu}");
        assert_eq!(log.left_out, [], "{order:?}");
    }
    // An ellipse of 3 km beside deviations of metres.
    let log = read_sentences(&[ZDA, GGA, "GPGST,120000.00,1.0,3000.0,3000.0,0.0,2.0,3.0,4.0"]);
    assert_eq!(log.positions[0].covariance_m2.map(|v| [v[0], v[2], v[5]]), Some([9e6, 9e6, 16.0]));
    // One of 95 % is a scale.
    let log = read_sentences(&[ZDA, GGA, "GPGST,120000.00,1.0,7.3,4.9,90.0,2.0,3.0,4.0"]);
    let of = log.positions[0].covariance_m2.map(|v| v.map(f64::round));
    assert_eq!(of, Some([9.0, 0.0, 4.0, 0.0, 0.0, 16.0]));
}

#[test]
fn what_gns_gbs_and_a_navigational_status_say_against_a_position_takes_it() {
    let gns = |mode: &str, lat: &str, last: &str| format!("GNGNS,120000.00,{lat},N,00230.0000,E,{mode},09,1.0,100.0,47.0,,,{last}");
    let rmc = |last: &str| format!("GNRMC,120000.00,A,4900.0000,N,00230.0000,E,1.0,80.0,221126,,,A,{last}");
    let gbs = |failed: &str| format!("GNGBS,120000.00,3.0,3.0,5.0,{failed}");
    for (other, says) in [
        (gns("NN", "4900.0000", "S"), "GNS mode NN"),
        (gns("EE", "4900.0000", "S"), "GNS mode EE"),
        (gns("AA", "4901.2000", "S"), "position of GNS 2224 m away"),
        (gns("AA", "4900.0000", "U"), "GNS navigational status U"),
        (rmc("U"), "RMC navigational status U"),
        (rmc("C"), "RMC navigational status C"),
        (gbs("12,0.001,400.0,5.0"), "GBS: satellite 12 wrong by 400 m"),
        (gbs("12,0.001,-26.0,5.0"), "GBS: satellite 12 wrong by -26 m"),
    ] {
        for order in [[ZDA, &other, GGA, GST], [ZDA, GGA, GST, &other]] {
            assert_eq!(reasons(&order), [("contradicted", says.to_owned())], "{order:?}");
        }
    }
    for other in [
        gns("AN", "4900.0000", "S"),
        gns("NA", "4900.0000", "V"),
        gns("A", "4900.0000", ""),
        rmc("S"),
        rmc("V"),
        gbs("12,0.9,20.0,5.0"),
        gbs(",,,"),
    ] {
        assert_eq!(reasons(&[ZDA, GGA, &other, GST]), [], "{other}");
    }
}

#[test]
fn a_stream_waits_for_the_talkers_of_the_epoch_before() {
    let poor = "GPGST,120000.00,1.0,,,,2000.0,3000.0,4000.0";
    let mut decoder = Decoder::new(Kind::Nmea, Ends::WithLast);
    let mut variances = Vec::new();
    for second in 0..4 {
        for body in [ZDA, GGA, GST, poor] {
            let (mut out, body) = (Vec::new(), body.replace("120000", &format!("12000{second}")));
            decoder.take(&Frame::Nmea(body.as_bytes()), 1, &mut out);
            variances.extend(positions(&out).iter().map(|p| (second, p.covariance_m2.map(|v| v[0]))));
        }
    }
    // The first epoch ends with the next; from the second on at its own last sentence.
    assert!(variances.iter().all(|(_, v)| v.is_some_and(|v| (v / 9e6 - 1.0).abs() < 1e-9)), "{variances:?}");
    assert_eq!(variances.iter().map(|(second, _)| *second).collect::<Vec<_>>(), [1, 1, 2, 3]);
}

#[test]
fn a_fix_that_is_stated_behind_a_finished_epoch_counts_for_the_next() {
    let mut decoder = Decoder::new(Kind::Nmea, Ends::WithLast);
    let mut reasons = Vec::new();
    for second in 0..6 {
        let gsa = format!("GNGSA,A,{},01,02,03,04,05,06,07,,,,,,2.0,1.0,1.7", if second < 3 { 3 } else { 1 });
        for body in [ZDA, GGA, GST, &gsa] {
            let (mut out, body) = (Vec::new(), body.replace("120000", &format!("12000{second}")));
            decoder.take(&Frame::Nmea(body.as_bytes()), 1, &mut out);
            reasons.extend(positions(&out).iter().map(|p| p.absent.as_ref().map(|absent| absent.reason)));
        }
    }
    let contradicted = Some(Reason::Contradicted);
    assert_eq!(reasons, [None, None, None, None, contradicted, contradicted], "one epoch late, and none missed");
}

#[test]
fn the_accuracy_of_pubx_stands_where_no_other_does_and_is_not_passed_over() {
    let pubx = |h_m: f64| format!("PUBX,00,120000.00,4900.0000,N,00230.0000,E,147.0,G3,{h_m},3.0,0.0,0.0,0.0,,0.9,1.2,0.8,8,0,0");
    let alone = read_sentences(&[ZDA, GGA, &pubx(9000.0)]);
    let covariance = alone.positions[0].covariance_m2.unwrap();
    // hAcc is the root of both horizontal variances together.
    assert!((covariance[0] + covariance[2] - 81e6).abs() < 1e-3 && (covariance[5] - 9.0).abs() < 1e-9, "{covariance:?}");
    assert_eq!(alone.positions[0].covariance_from, Some("PUBX,00 hAcc, vAcc"));
    let beside = read_sentences(&[ZDA, GGA, GST, &pubx(9000.0)]);
    let covariance = beside.positions[0].covariance_m2.unwrap();
    assert!((covariance[0] + covariance[2] - 81e6).abs() < 1.0, "the worse of two statements: {covariance:?}");
    assert_eq!(beside.positions[0].covariance_from, Some("GST"));
}

#[test]
fn a_clock_that_was_not_set_before_the_first_fix_is_no_time() {
    let at = |of_day: &str, quality: &str| GGA.replace("120000.00", of_day).replace(",1,08,", &format!(",{quality},08,"));
    let unset = [at("000000.00", "0"), at("000001.00", "0")];
    let log = read_sentences(&[&unset[0], &unset[1], ZDA, GGA, GST]);
    assert_eq!((log.positions.len(), log.absent.as_slice()), (1, &[None, None][..]));
    // One that was set, and one behind the first date, have their times.
    let log = read_sentences(&[&at("115959.00", "0"), ZDA, GGA, GST, &at("120500.00", "0")]);
    assert_eq!(log.absent.iter().filter(|time| time.is_some()).count(), 2);
}

/// Reasons of twenty epochs, in each what `more` says at its second, before its position.
fn with_datums(more: &[(u32, &str)], ends: Ends, restored: bool) -> Vec<Option<String>> {
    let mut bodies = Vec::new();
    for second in 0..20 {
        bodies.extend(more.iter().filter(|(at, _)| *at == second).map(|(_, body)| (*body).to_owned()));
        bodies.extend([ZDA, GGA, GST].map(|body| body.replace("120000", &format!("1200{second:02}"))));
    }
    let frames: Vec<Frame<'_>> = bodies.iter().map(|body| Frame::Nmea(body.as_bytes())).collect();
    positions(&items(&frames, Kind::Nmea, ends, restored)).iter().map(|p| p.absent.as_ref().map(|absent| absent.stated.clone())).collect()
}

#[test]
fn a_datum_holds_until_the_next_one() {
    let (other, own) = ("GPDTM,NAD27,,0.0,N,0.0,E,0.0,W84", "GPDTM,W84,,0.0,N,0.0,E,0.0,W84");
    for (ends, restored) in [(Ends::WithNext, false), (Ends::WithLast, false), (Ends::WithLast, true)] {
        let against = |more: &[(u32, &str)]| with_datums(more, ends, restored).iter().map(Option::is_some).collect::<Vec<_>>();
        assert_eq!(against(&[(0, other)]), [true; 20], "{ends:?}");
        // What says nothing ends nothing. Before the sentence of the position it is also of the epoch that no message has ended yet.
        let spell = against(&[(5, other), (7, "GPDTM,,,,,,,,"), (10, own)]);
        assert!(spell[5..10].iter().all(|each| *each) && !spell[..4].iter().any(|each| *each), "{ends:?}: {spell:?}");
        // A stream has finished the epoch before at its last message: an all-clear between two epochs holds from the second on.
        let cleared = if ends == Ends::WithLast { 11 } else { 10 };
        assert!(!spell[cleared..].iter().any(|each| *each), "{ends:?}: {spell:?}");
    }
}

#[test]
fn positions_before_the_first_datum_of_a_file_are_in_it() {
    let second = |k: u32| GGA.replace("120000", &format!("1200{k:02}"));
    let gga: Vec<String> = (0..6).map(second).collect();
    let of = |dtm: &str, again: &str| {
        let log = read_sentences(&[ZDA, &gga[0], &gga[1], &gga[2], dtm, &gga[3], &gga[4], again, &gga[5]]);
        (log.positions.len(), log.absent.len(), log.n_rows)
    };
    let (other, own) = ("GPDTM,NAD27,,0.0,N,0.0,E,0.0,W84", "GPDTM,W84,,0.0,N,0.0,E,0.0,W84");
    assert_eq!(of(other, "GPTXT,01"), (0, 6, 6));
    assert_eq!(of(other, own), (1, 5, 6));
    // What came before another one was stated to be in WGS-84. It has no time, so that it may be of the position before it, too.
    assert_eq!(of(own, other), (4, 2, 6));
}

/// RMC of a second, with what follows its time.
fn rmc(second: u32, text: &str) -> String {
    format!("GPRMC,1200{second:02}.00,{text}")
}

const PLACED: &str = "A,4900.0000,N,00230.0000,E,36.0,90.0,221126,,,A";

#[test]
fn positions_of_rmc_stand_where_no_gga_does() {
    let bodies: Vec<String> = (0..6).map(|k| rmc(k, PLACED)).collect();
    let log = read_sentences(&bodies.iter().map(String::as_str).collect::<Vec<_>>());
    assert_eq!((log.positions.len(), log.n_rows, log.left_out.len()), (6, 6, 0));
    assert_eq!(log.notes, [Note::OfRmc]);
    for p in &log.positions {
        assert_eq!((p.h_m, p.covariance_m2, p.n_sv, p.hdop), (None, None, None, None), "nothing is invented");
        assert!(p.time.is_some() && p.ground_speed_mps.is_some_and(|speed| (speed - 18.52).abs() < 1e-9));
        assert!(p.fields.contains(&("est_lat_rad", "RMC")));
    }
    // An accuracy beside it counts, and its worst; another statement takes it away.
    let second = rmc(0, PLACED);
    assert_eq!(read_sentences(&[&second, GST]).positions[0].covariance_m2, Some([9.0, 0.0, 4.0, 0.0, 0.0, 16.0]));
    for (other, says) in [
        ("GPGSA,A,1,,,,,,,,,,,,,,,", "GSA fix 1"),
        ("GNGNS,120000.00,4900.0000,N,00230.0000,E,NN,00,,,,,,V", "GNS mode NN"),
        ("GPGLL,4900.0000,N,00230.0000,E,120000.00,V,N", "GLL status V"),
        ("GPDTM,NAD27,,,,,,,W84", "DTM datum NAD27"),
        // Of a second talker, or receiver.
        ("IIRMC,120000.00,A,4901.0000,N,00230.0000,E,36.0,90.0,221126,,,A", "position of RMC 1854 m away"),
        ("IIRMC,120000.00,V,,,,,,,,,,N", "RMC status V"),
    ] {
        assert_eq!(
            reasons(&[&second, other, &rmc(1, PLACED)]).first().map(|(reason, says)| (*reason, says.as_str())),
            Some(("contradicted", says))
        );
    }
    assert_eq!(read_sentences(&[&second, &second.replace("GPRMC", "IIRMC")]).n_rows, 1, "one epoch");
}

#[test]
fn an_rmc_without_a_measured_position_is_an_epoch_without_one() {
    for (text, usable) in [
        ("A,4900.0000,N,00230.0000,E,1.0,,221126,,", true),
        ("A,4900.0000,N,00230.0000,E,1.0,,221126,,,D", true),
        ("A,4900.0000,N,00230.0000,E,1.0,,221126,,,F,V", true),
        ("V,4900.0000,N,00230.0000,E,1.0,,221126,,,A", false),
        ("A,4900.0000,N,00230.0000,E,1.0,,221126,,,E", false),
        ("A,4900.0000,N,00230.0000,E,1.0,,221126,,,M", false),
        ("A,4900.0000,N,00230.0000,E,1.0,,221126,,,S", false),
        ("A,4900.0000,N,00230.0000,E,1.0,,221126,,,N", false),
        ("A,,,,,1.0,,221126,,,A", false),
        ("A,49x0.0000,N,00230.0000,E,1.0,,221126,,,A", false),
        (",4900.0000,N,00230.0000,E,1.0,,221126,,,A", false),
    ] {
        let log = read_sentences(&[&rmc(0, PLACED), &rmc(1, text), &rmc(2, PLACED)]);
        let absent = log.left_out.iter().map(|each| (each.reason, each.count)).collect::<Vec<_>>();
        assert_eq!((log.positions.len(), log.n_rows), (2 + usize::from(usable), 3), "{text}");
        assert_eq!(absent, if usable { vec![] } else { vec![("no_fix", 1)] }, "{text}");
    }
    // Before the first fix: neither time nor place.
    let log = read_sentences(&["GPRMC,,V,,,,,,,,,,N", "GPRMC,,V,,,,,,,,,,N", &rmc(2, PLACED)]);
    assert_eq!((log.positions.len(), log.n_rows, log.absent.as_slice()), (1, 3, &[None, None][..]));
    // No date, since there was never a fix: each is an epoch without a position, and nothing waits for a date.
    let log = read_sentences(&[&rmc(0, "V,,,,,,,,,,N"), &rmc(1, "V,,,,,,,,,,N")]);
    assert_eq!((log.undated, log.n_rows, log.absent.len()), (None, 2, 2));
    // A damaged sentence of the position was an epoch.
    let mut bytes = [rmc(0, PLACED), rmc(1, PLACED)].map(|body| sentence(&body)).concat();
    bytes[20] ^= 1;
    let log = log::read(&bytes, Kind::Nmea);
    assert_eq!((log.positions.len(), log.n_rows, log.absent.len()), (1, 2, 1));
}

#[test]
fn rmc_overrules_no_gga() {
    // Not at its epoch, whatever its order, and not between its epochs.
    let none = GGA.replace(",1,08,", ",0,00,");
    for order in [[rmc(0, PLACED), none.clone()], [none.clone(), rmc(0, PLACED)]] {
        let log = read_sentences(&[&order[0], &order[1], &rmc(1, PLACED), &rmc(2, PLACED)]);
        assert_eq!((log.positions.len(), log.n_rows, log.left_out[0].reason), (0, 1, "no_fix"));
    }
    // One without time or place, and a damaged one, are a GGA.
    for gga in [sentence("GPGGA,,,,,,0,00,,,M,,M,,"), b"$GPGGA,120000.00,4900.0000,N*00\r\n".to_vec()] {
        let bytes = [sentence(&rmc(0, PLACED)), gga, sentence(&rmc(1, PLACED))].concat();
        assert_eq!(log::read(&bytes, Kind::Nmea).positions.len(), 0);
    }
    // A stream has one position an epoch from the first on, in any order, wherever it begins.
    let order = [rmc(0, PLACED), GGA.to_owned(), "GPVTG,90.0,T,,M,36.0,N,,K,A".to_owned(), GST.to_owned()];
    for turn in 0..4 {
        for begin in 0..4 {
            let bodies: Vec<String> = (0..30_usize)
                .map(|at| at + begin)
                .map(|at| order[(at % 4 + turn) % 4].replace("120000", &format!("1200{:02}", at / 4)))
                .collect();
            let frames: Vec<Frame<'_>> = bodies.iter().map(|body| Frame::Nmea(body.as_bytes())).collect();
            let items = items(&frames, Kind::Nmea, Ends::WithLast, true);
            let times: Vec<_> = positions(&items).iter().map(|p| p.of_day.map(|OfDay(ns)| ns)).collect();
            assert!(times.windows(2).all(|pair| pair[0] < pair[1]), "{turn} {begin}");
            assert!(positions(&items).iter().all(|p| p.fields.contains(&("est_lat_rad", "GGA"))), "{turn} {begin}");
        }
    }
}

#[test]
fn a_stream_of_rmc_alone_has_the_positions_of_the_file() {
    let bodies: Vec<String> = (0..20).map(|k| rmc(k, if k == 7 { "V,,,,,,,221126,,,N" } else { PLACED })).collect();
    let frames: Vec<Frame<'_>> = bodies.iter().map(|body| Frame::Nmea(body.as_bytes())).collect();
    for (ends, restored) in [(Ends::WithNext, false), (Ends::WithLast, false), (Ends::WithLast, true)] {
        let items = items(&frames, Kind::Nmea, ends, restored);
        let absent: Vec<_> = positions(&items).iter().map(|p| p.absent.as_ref().map(|absent| absent.reason)).collect();
        let expected: Vec<_> = (0..20).map(|k| (k == 7).then_some(Reason::NoFix)).collect();
        assert_eq!(absent, expected, "{ends:?}");
    }
}
