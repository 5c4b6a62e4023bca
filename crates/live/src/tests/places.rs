//! Places that nobody was at, heights, counts of satellites, and the count of what was not used.

use super::*;
use crate::decode::Format;
use navbound_formats::receiver::position::Kind;

/// Epochs of lines of one track that flies 64 m/s, which are judged alone and from a file.
fn from_file(lines: impl Iterator<Item = String>) -> (Vec<EpochOut>, Lane) {
    let base = settings();
    let judge = judge::Settings { method: Alerting::of("anp-circle").unwrap(), ..base.judge };
    let (mut lane, mut all) = (Lane::new(Settings { judge, ..base }).unwrap(), Vec::new());
    for text in lines {
        lane.step(&Input::Chunk { arrival: None, bytes: text.as_bytes() }, &mut all);
    }
    lane.step(&Input::End { arrival: None }, &mut all);
    (epochs_of(&all, "d"), lane)
}

fn flies(k: u32) -> f64 {
    0.5 + 1e-5 * f64::from(k)
}

const SPEED: &str = ",\"ground_speed_mps\":64.0";

#[test]
fn latitude_0_longitude_0_is_no_position_and_moves_nothing() {
    for zeros in [0..1, 0..4, 10..11, 10..14] {
        let of = |k: u32| {
            let place = if zeros.contains(&k) {
                ",\"est_lat_rad\":0.0,\"est_lon_rad\":0.0,\"sigma_m\":10.0".to_owned()
            } else {
                placed(flies(k), SPEED)
            };
            line("d", f64::from(k), &place)
        };
        let (epochs, _) = from_file((0..30).map(of));
        for (k, epoch) in (0..).zip(&epochs) {
            let expected = if zeros.contains(&k) { (Status::NotAvailable, Some(Reason::Reported)) } else { (Status::Ok, None) };
            assert_eq!((epoch.status, epoch.reason), expected, "{k} of {zeros:?}");
        }
    }
}

#[test]
fn two_heights_of_one_instant_contradict_each_other() {
    for (again_m, contradicts) in [(100.0, false), (150.0, false), (300.0, true), (4000.0, true)] {
        let second = |k: u32| placed(flies(k), SPEED).replace("\"est_h_m\":100.0", &format!("\"est_h_m\":{again_m}"));
        let twice = |k: u32| if k == 10 { line("d", 10.0, &second(k)) } else { String::new() };
        let (epochs, _) = from_file((0..50).map(|k| line("d", f64::from(k), &placed(flies(k), SPEED)) + &twice(k)));
        assert!(epochs[..10].iter().chain(&epochs[42..]).all(|e| e.status == Status::Ok), "{again_m}");
        assert_eq!(epochs[12..41].iter().all(|e| e.reason == Some(Reason::PositionNotSettled)), contradicts, "{again_m}");
        assert_eq!(epochs[11..41].iter().all(|e| e.alert == rnp::Alert::Unavailable), contradicts, "{again_m}");
    }
}

#[test]
fn a_position_that_stands_from_the_first_record_under_stamps_that_crawl_is_stale() {
    let of = |k: u32, speed: &str| {
        let text = placed(0.5, &format!("{speed},\"fte_m\":0.0"));
        format!("{{\"v\":1,\"track\":\"d\",\"time_ns\":{}{text}}}\n", T0_NS + i64::from(k) * 1_000_000)
    };
    for (speed, reason) in [("", None), (SPEED, Some(Reason::PositionHeld))] {
        let (epochs, _) = from_file((0..60).map(|k| of(k, speed)));
        assert_eq!(
            epochs.iter().map(|e| e.reason).collect::<Vec<_>>()[..4],
            [None, reason, reason, Some(Reason::PositionStale)],
            "{speed}"
        );
        assert!(epochs[3..].iter().all(|e| e.reason == Some(Reason::PositionStale)), "{speed}");
        assert!(epochs[4..].iter().all(|e| e.alert == rnp::Alert::Unavailable), "{speed}");
    }
}

/// 64 m/s over 20 s are 1280 m, of which a position must make good half, less 100 m: noise of a metre is no flight.
#[test]
fn a_position_that_stands_with_noise_while_its_aircraft_moves_is_stale() {
    let noise = |k: u32| 2e-7 * (f64::from(k * 7 % 11) / 5.0 - 1.0) + 1e-12 * f64::from(k);
    let stands = |k: u32| line("d", f64::from(k), &placed(0.5 + noise(k), SPEED));
    let (epochs, _) = from_file((0..100).map(stands));
    assert!(epochs[..20].iter().all(|e| e.reason.is_none()), "{:?}", epochs[..20].iter().map(|e| e.reason).collect::<Vec<_>>());
    assert!(epochs[20..].iter().all(|e| e.reason == Some(Reason::PositionStale)));
    assert!(epochs[20..].iter().all(|e| e.alert == rnp::Alert::Unavailable));
    // A speed that is empty now and then changes nothing.
    let blank = |k: u32| if k % 15 == 7 { stands(k).replace(SPEED, "") } else { stands(k) };
    assert!(from_file((0..100).map(blank)).0[25..].iter().all(|e| e.reason == Some(Reason::PositionStale)));
    // The same noise on a flight, and on an aircraft that says that it stands.
    for (of, speed) in [(1.0, SPEED), (0.0, ",\"ground_speed_mps\":0.0")] {
        let (epochs, _) = from_file((0..100).map(|k| line("d", f64::from(k), &placed(0.5 + of * 1e-5 * f64::from(k) + noise(k), speed))));
        assert!(epochs.iter().all(|e| e.reason.is_none()), "{of}");
    }
}

/// The plane alone is judged, but a variance below zero says that the covariance is none.
#[test]
fn a_vertical_variance_below_zero_is_no_covariance() {
    let of = |uu: f64| {
        let axes = format!("{SPEED},\"cov_ee_m2\":9.0,\"cov_en_m2\":0.0,\"cov_nn_m2\":9.0,\"cov_uu_m2\":{uu}");
        let text = |k: u32| line("d", f64::from(k), &placed(flies(k), &axes).replace(",\"sigma_m\":10.0", ""));
        from_file((0..20).map(text)).0
    };
    assert!(of(16.0).iter().all(|e| e.status == Status::Ok));
    assert!(of(-9.0).iter().all(|e| (e.status, e.reason) == (Status::InvalidInput, Some(Reason::NotACovariance))));
}

#[test]
fn fewer_satellites_than_determine_a_position_are_degraded_whatever_the_source_says() {
    for (n_sv, few) in [("0", true), ("3", true), ("4", false), ("9", false), ("null", false)] {
        for status in ["", ",\"status\":\"ok\""] {
            let (epochs, _) = from_file((0..9).map(|k| line("d", f64::from(k), &placed(flies(k), &format!(",\"n_sv\":{n_sv}{status}")))));
            let expected = if few { (Status::Degraded, Some(Reason::FewSatellites)) } else { (Status::Ok, None) };
            assert!(epochs.iter().all(|e| (e.status, e.reason) == expected), "{n_sv}");
        }
    }
    // What its source says is worse stays.
    let (epochs, _) = from_file((0..3).map(|k| line("d", f64::from(k), &placed(flies(k), ",\"n_sv\":0,\"status\":\"not_available\""))));
    assert!(epochs.iter().all(|e| (e.status, e.reason) == (Status::NotAvailable, Some(Reason::Reported))));
}

#[test]
fn positions_that_were_not_used_are_counted_by_their_reason() {
    let of = |k: u32| match k {
        5..8 => line("d", f64::from(k), ",\"est_lat_rad\":0.0,\"est_lon_rad\":0.0,\"sigma_m\":10.0"),
        10 => line("d", f64::from(k), &placed(flies(k), "").replace(",\"sigma_m\":10.0", "")),
        _ => line("d", f64::from(k), &placed(flies(k), SPEED)),
    };
    let (epochs, lane) = from_file((0..30).map(of));
    let counted = |lane: &Lane| lane.counters().named().into_iter().filter(|(name, _)| name.starts_with("unusable_")).collect::<Vec<_>>();
    let expected = [("unusable_no_covariance", 1), ("unusable_reported", 3)].map(|(name, n)| (name.to_owned(), n));
    assert_eq!(counted(&lane), expected);
    assert_eq!(epochs.iter().filter(|e| !e.status.usable()).count(), 4);
    let restored = Lane::restore(lane.settings.clone(), &lane.snapshot(0, 0)).unwrap().0;
    assert_eq!(counted(&restored), expected);
}

/// 64 m/s by its word; led by 60 m/s more from 60 s on. From the place of 48 s, 60 (t - 60) > (3.2 + 3) (t - 48) + 640 + 100 first at 76 s; that of
/// 56 s is judged from 76 s on.
#[test]
fn a_position_that_is_led_ahead_of_its_speed_is_not_believed() {
    let place = |k: u32| 0.5 + (64.0 * f64::from(k) + 60.0 * f64::from(k.saturating_sub(60))) / 6.37e6;
    let lines = (0..200).map(|k| line("d", f64::from(k), &placed(place(k), SPEED)));
    let (epochs, lane) = from_file(lines.clone());
    let first = epochs.iter().position(|e| e.reason == Some(Reason::PositionAhead)).unwrap();
    assert_eq!(first, 76);
    assert!(epochs[..first].iter().all(|e| e.reason.is_none()));
    assert!(epochs[first..].iter().all(|e| (e.status, e.reason) == (Status::InvalidInput, Some(Reason::PositionAhead))));
    assert_eq!(epochs[199].alert, rnp::Alert::Unavailable);
    // A lane that goes on from its snapshot says the same.
    let base = lane.settings.clone();
    let (mut begun, mut all) = (Lane::new(base.clone()).unwrap(), Vec::new());
    for (k, text) in lines.enumerate() {
        if k == 70 {
            begun = Lane::restore(base.clone(), &begun.snapshot(0, 0)).unwrap().0;
        }
        begun.step(&Input::Chunk { arrival: None, bytes: text.as_bytes() }, &mut all);
    }
    begun.step(&Input::End { arrival: None }, &mut all);
    assert_eq!(epochs_of(&all, "d").iter().map(|e| e.reason).collect::<Vec<_>>(), epochs.iter().map(|e| e.reason).collect::<Vec<_>>());
}

/// Keys of lines under which another place of the vehicle stands; the position is 0.5 rad north, 0.1 rad east.
#[test]
fn a_line_with_another_place_of_the_vehicle_is_not_believed() {
    let lat_deg = 0.5_f64.to_degrees();
    let of = |more: &str| {
        let place = placed(0.5, &format!(",\"ground_speed_mps\":0.0,{more}"));
        from_file((0..2).map(|k| line("d", f64::from(k), &place))).0.first().map(|epoch| epoch.status)
    };
    for far in [
        format!("\"gps_lat\":{},\"gps_lon\":{}", lat_deg + 0.1, 0.1_f64.to_degrees()),
        "\"lat\":10,\"lon\":10".to_owned(),
        "\"position\":{\"lat_deg\":10,\"lon_deg\":10}".to_owned(),
        "\"EST_LAT_RAD\":0.6".to_owned(),
        "\"gpsLatitude\":\"10.5\"".to_owned(),
        "\"gps_lat\":\"48.05N\"".to_owned(),
        format!("\"gps_lat_e7\":{:.0}", (lat_deg + 0.1) * 1e7),
        format!("\"irs_lat\":{}", lat_deg + 0.3),
        "\"gps_lat_lon_0\":10.0,\"gps_lat_lon_1\":5.7".to_owned(),
        "\"fix\":{\"lat_lon[0]\":10.0,\"lat_lon[1]\":5.7}".to_owned(),
        "\"sensors\":[{\"lat\":10,\"lon\":10}]".to_owned(),
        "\"receivers\":[[{\"lat\":10,\"lon\":10}]]".to_owned(),
        "\"position\":[\"10.0\",\"5.7\"]".to_owned(),
        "\"ns\":\"S\"".to_owned(),
        // What is said beside a place that agrees is heard all the same.
        format!("\"gps\":\"{{\\\"lat\\\":{lat_deg},\\\"spoofed\\\":1}}\""),
        "\"payload\":\"[{\\\"spoofed\\\":1}]\"".to_owned(),
        "\"gps_lat\":[29.1]".to_owned(),
        "\"status_lat\":\"N\",\"spoofed\":\"yes\"".to_owned(),
        "\"gps_lat\":\"29.1° N\"".to_owned(),
        "\"gps_lat\":\"29° 6.0' N\"".to_owned(),
        "\"gps_lat\":\"N29.1\"".to_owned(),
        "\"gps_lat\":\"28.64S\"".to_owned(),
    ] {
        assert_eq!(of(&far), Some(Status::InvalidInput), "{far}");
    }
    for near in [
        format!("\"gps_lat\":{},\"gps_lon\":{}", lat_deg + 0.01, 0.1_f64.to_degrees() - 0.01),
        format!("\"gps_lat_e7\":{:.0}", lat_deg * 1e7),
        format!("\"gps_lat\":\"{lat_deg:.6} N\""),
        "\"gps_lat\":0.0,\"gps_lon\":0.0".to_owned(),
        "\"dest_lat\":10.0,\"airport_lon\":10.0".to_owned(),
        format!("\"irs_lat\":{}", lat_deg + 0.1),
        "\"latency_s\":0.2,\"flat\":5".to_owned(),
        format!("\"gps_lat_lon_0\":{lat_deg},\"gps_lat_lon_1\":{}", 0.1_f64.to_degrees()),
        format!("\"sensors\":[{{\"lat\":{lat_deg}}},{{\"temperature_0\":10,\"temperature_1\":5.7}}]"),
        format!("\"gps_lat\":\"{lat_deg:.6}° N\""),
        "\"gps_lat\":\"2838.87N\"".to_owned(),
        "\"gps\":{\"ns\":\"N\"}".to_owned(),
        "\"ns\":\"N\",\"ew\":\"E\",\"lat_dir\":\"N\"".to_owned(),
    ] {
        assert_eq!(of(&near), Some(Status::Ok), "{near}");
    }
}

/// Sentences of NMEA of one time, as many as an epoch keeps of each kind and more: a snapshot among them is read again.
#[test]
fn a_snapshot_within_the_fullest_epoch_is_read_again() {
    let mut lane = Lane::new(Settings { format: Format::Receiver(Kind::Nmea), ..settings() }).unwrap();
    let place = "2838.87,N,00543.77,E";
    let bodies = [
        format!("GPGGA,120000.00,{place},1,08,1.0,100.0,M,47.0,M,,"),
        format!("GPRMC,120000.00,A,{place},36.0,0.0,221126,,,A"),
        format!("GPGLL,{place},120000.00,A,A"),
        format!("GPGNS,120000.00,{place},AA,08,1.0,100.0,45.0,,"),
        format!("PUBX,00,120000.00,{place},147.0,G3,2.1,3.0,0.0,0.0,0.0,,0.9,1.2,0.8,8,0,0"),
        "GPGST,120000.00,1.0,,,,2.0,3.0,4.0".to_owned(),
        "GPGBS,120000.00,1.0,1.0,1.0,,,,".to_owned(),
        "GPGSA,A,3,01,02,03,04,,,,,,,,,2.0,1.0,1.7".to_owned(),
        "GPVTG,0.0,T,,M,36.0,N,66.7,K,A".to_owned(),
    ];
    let mut all = Vec::new();
    for (kind, body) in bodies.iter().enumerate() {
        for _ in 0..if kind == 0 {
            1
        } else if (5..7).contains(&kind) {
            4
        } else {
            20
        } {
            let text = format!("${body}*{:02X}\r\n", body.bytes().fold(0, |sum, byte| sum ^ byte));
            lane.step(&Input::Chunk { arrival: None, bytes: text.as_bytes() }, &mut all);
            let snapshot = lane.snapshot(0, 0);
            lane = Lane::restore(lane.settings.clone(), &snapshot).unwrap().0;
            assert_eq!(lane.snapshot(0, 0), snapshot);
        }
    }
    lane.step(&Input::End { arrival: None }, &mut all);
    assert_eq!(all.iter().filter(|output| matches!(output, Output::Epoch(_))).count(), 1);
}

/// A position that stands for a second in 26 and goes on from there is within every limit of a moment, and is behind for ever.
#[test]
fn a_way_that_falls_behind_its_speeds_in_all_is_not_believed() {
    let flight = |holds: bool, n: u32| {
        let mut way_s = 0.0;
        let lines: Vec<String> = (0..n)
            .map(|k| {
                way_s += if holds && k % 26 == 25 { 0.0 } else { 1.0 };
                // 200 m/s over a sphere of 6,371 km to the north, along a meridian.
                line("d", f64::from(k), &placed(0.2 + 200.0 / 6_371_008.8 * way_s, ",\"ground_speed_mps\":200.0"))
            })
            .collect();
        from_file(lines.into_iter()).0
    };
    let late = flight(true, 3000);
    let stale = late.iter().position(|epoch| epoch.reason == Some(Reason::PositionStale)).expect("it is behind");
    // A hold lacks 200 m of 5200, a fiftieth is 104: the rest reaches 5 km after 52 holds.
    assert!((1300..1500).contains(&stale), "{stale}");
    assert!(late[stale..].iter().all(|epoch| !epoch.status.usable()), "and stays so where it is held besides");
    assert!(flight(false, 3000).iter().all(|epoch| epoch.status == Status::Ok));
}
