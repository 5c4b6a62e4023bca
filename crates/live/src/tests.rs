use super::*;
use navbound_core::bound::Alerting;
use navbound_core::judge;
use navbound_core::monitor::{
    motion,
    rnp::{self, Chain},
};
use navbound_core::quantity::{GpsTime, Metres, Reason, Risk, Status};
use proptest::prelude::*;
use std::fmt::Write;
use std::sync::Arc;

mod directions;
mod places;

const T0_NS: i64 = 1_447_500_000_000_000_000;

fn settings() -> Settings {
    let chain =
        Chain { sample_period_s: 1.0, sensor_latency_s: 0.0, filter_s: 0.0, computing_s: 0.0, display_s: 0.0, time_to_alert_s: 10.0 };
    Settings {
        format: Format::Json,
        track: TrackId::new("receiver").unwrap(),
        statements: Arc::new(Statements::new(
            vec![
                (vec!["valid".into()], vec!["1".into(), "true".into()], None, None),
                (vec!["epu_m".into(), "hpl".into()], vec![], None, None),
                (vec!["hdop".into()], vec![], None, Some(30.0)),
                (vec!["nSats".into()], vec!["null".into()], Some(3.0), None),
                (vec!["spoofed".into(), "nav_fault".into()], vec!["0".into(), "false".into()], None, None),
            ],
            vec!["stopped".into()],
            (
                [
                    vec!["lat".into(), "latitude".into()],
                    vec!["lon".into(), "longitude".into()],
                    vec!["dest".into(), "airport".into()],
                    vec!["irs".into()],
                    vec!["geom".into(), "coordinates".into(), "position".into()],
                    vec!["counter".into()],
                    vec!["hemisphere".into(), "ns".into(), "ew".into()],
                    vec!["S".into()],
                    vec!["N".into()],
                    vec!["W".into()],
                    vec!["E".into()],
                ],
                [1852.0, 18_520.0],
            ),
        )),
        of_stated_fte: None,
        judge: judge::Settings {
            method: Alerting::of("tse-exact").unwrap(),
            accuracy: Risk::new(0.05).unwrap(),
            integrity: Risk::new(1e-5).unwrap(),
            states: None,
            monitor: rnp::Settings { chain, raise_delay_s: 3.0, clear_delay_s: 5.0, clear_ratio: 0.9, stale_after_s: 2.0 },
            with_levels: false,
        },
        motion: motion::Limits {
            max_speed_mps: 400.0,
            speed_factor: 1.25,
            speed_margin_mps: 25.0,
            latency_s: 10.0,
            fix_latency_s: 1.0,
            noise_m: 100.0,
            moving_mps: 15.0,
            stale_after_s: 2.0,
            settle_s: 30.0,
            period_s: 1.0,
        },
        assumed: None,
        rnp: Metres::new(555.6),
        path: None,
        table: crate::Table::default(),
        claims: crate::claims::tests::CLAIMS,
        lateness_ns: 1_000_000_000,
        ahead_ns: 2_000_000_000,
        retention_ns: 3_600_000_000_000,
        expiry_ns: Some(20_000_000_000),
        max_tracks: 50,
        digest: [7; 32],
    }
}

/// A record of a track, `seconds` after the begin.
fn line(track: &str, seconds: f64, rest: &str) -> String {
    format!("{{\"v\":1,\"track\":\"{track}\",\"time_ns\":{}{rest}}}\n", T0_NS + (seconds * 1e9) as i64)
}

fn good(track: &str, seconds: f64) -> String {
    line(track, seconds, ",\"fte_m\":20.0,\"sigma_m\":10.0")
}

fn at(seconds: f64) -> GpsTime {
    GpsTime::from_nanoseconds(T0_NS + (seconds * 1e9) as i64)
}

fn chunk(lane: &mut Lane, arrival_s: f64, text: &str) -> Vec<Output> {
    let mut out = Vec::new();
    lane.step(&Input::Chunk { arrival: Some(at(arrival_s)), bytes: text.as_bytes() }, &mut out);
    out
}

fn transitions(outputs: &[Output]) -> Vec<String> {
    outputs.iter().filter_map(|output| if let Output::Transition(t) = output { Some(t.key()) } else { None }).collect()
}

/// Three tracks for `seconds`; what else arrives at a second is put behind their records.
fn flown(lane: &mut Lane, seconds: u32, also: impl Fn(u32) -> String) -> Vec<Output> {
    let mut all = Vec::new();
    for k in 0..seconds {
        let mut text = String::new();
        for track in ["a", "b", "c"] {
            text += &good(track, f64::from(k));
        }
        text += &also(k);
        all.extend(chunk(lane, f64::from(k) + 0.1, &text));
    }
    all
}

fn of_track<'a>(outputs: &'a [Output], name: &str) -> Vec<&'a Output> {
    let named = |output: &&Output| match output {
        Output::Epoch(e) => e.track.name() == name,
        Output::Transition(t) => t.track.is_some_and(|track| track.name() == name),
    };
    outputs.iter().filter(named).collect()
}

#[test]
fn a_silence_is_raised_once_at_last_plus_stale_and_one_of_exactly_stale_is_none() {
    for (resumes_s, raised) in [(6.0, 1), (4.0, 0)] {
        let mut lane = Lane::new(settings()).unwrap();
        let all = flown(&mut lane, 15, |k| {
            let sends = f64::from(k) <= 2.0 || f64::from(k) >= resumes_s;
            if sends { good("d", f64::from(k)) } else { String::new() }
        });
        let keys = transitions(&all);
        let expected = format!("d/0/unavailable/{}/raised", at(4.0).nanoseconds());
        assert_eq!(keys.iter().filter(|key| **key == expected).count(), raised, "{keys:?}");
        assert_eq!(keys.len(), 2 * raised, "{keys:?}");
    }
}

#[test]
fn a_silence_is_reported_while_it_lasts_and_by_heartbeats_alone() {
    let mut lane = Lane::new(settings()).unwrap();
    flown(&mut lane, 3, |_| String::new());
    let mut out = Vec::new();
    for k in 3..10 {
        lane.step(&Input::Heartbeat { arrival: at(f64::from(k) + 0.1) }, &mut out);
        let reported = transitions(&out);
        // Last record at 2 s, stale after 2 s, lateness 1 s: due at 5 s.
        assert_eq!(reported.iter().filter(|key| key.contains("unavailable")).count(), if k >= 5 { 3 } else { 0 }, "{k} {reported:?}");
    }
    assert!(transitions(&out).iter().any(|key| key.starts_with("feed:source/0/quiet/")));
}

#[test]
fn records_within_the_lateness_are_put_in_order() {
    let mut clean = Lane::new(settings()).unwrap();
    let mut mixed = Lane::new(settings()).unwrap();
    let (mut a, mut b) = (Vec::new(), Vec::new());
    for k in 0..20 {
        let t = f64::from(k);
        a.extend(chunk(&mut clean, t + 0.1, &(good("a", t) + &good("a", t + 0.4))));
        b.extend(chunk(&mut mixed, t + 0.1, &(good("a", t + 0.4) + &good("a", t) + &good("a", t))));
    }
    let judged = |outputs: &[Output]| {
        let times = outputs
            .iter()
            .filter_map(|o| if let Output::Epoch(e) = o { Some((e.time, e.alert, e.numbers.map(f64::to_bits))) } else { None });
        times.collect::<Vec<_>>()
    };
    let (a, b) = (judged(&a), judged(&b));
    let n = a.len().min(b.len());
    assert!(n > 30);
    let first = a.iter().zip(&b).position(|(a, b)| a != b);
    assert!(first.is_none(), "record {first:?}");
    assert_eq!((mixed.counters().n_reordered, mixed.monitor_counters().n_late), (20, 0));
    assert!(mixed.counters().n_duplicate > 0);
}

#[test]
fn a_time_stamp_an_hour_ahead_moves_nobody_else() {
    let mut clean = Lane::new(settings()).unwrap();
    let mut wrong = Lane::new(settings()).unwrap();
    let expected = flown(&mut clean, 60, |k| good("d", f64::from(k)));
    for offset_s in [3600.0, -3599.0] {
        let mut lane = wrong.clone();
        let all = flown(&mut lane, 60, |k| good("d", f64::from(k) + if (10..40).contains(&k) { offset_s } else { 0.0 }));
        for name in ["a", "b", "c"] {
            assert_eq!(format!("{:?}", of_track(&all, name)), format!("{:?}", of_track(&expected, name)), "{offset_s} {name}");
        }
        let keys: Vec<_> = transitions(&all).into_iter().filter(|key| key.starts_with("d/")).collect();
        assert!(keys.iter().any(|key| key.contains("unavailable") && key.ends_with("raised")), "{keys:?}");
        let mut unique = keys.clone();
        unique.sort();
        unique.dedup();
        assert_eq!(unique.len(), keys.len(), "{keys:?}");
        let unavailable_at = |second: f64| {
            let epochs = all.iter().filter_map(|o| if let Output::Epoch(e) = o { (e.track.name() == "d").then_some(*e) } else { None });
            epochs.into_iter().find(|e| e.time == at(second)).map(|e| e.alert)
        };
        // Right stamps come again from 40 s on.
        assert_eq!(unavailable_at(45.0), Some(rnp::Alert::Normal), "{offset_s} {keys:?}");
    }
    wrong.fault = None;
}

#[test]
fn a_clock_that_stays_wrong_is_an_alert_of_the_source() {
    let mut lane = Lane::new(settings()).unwrap();
    flown(&mut lane, 3, |_| String::new());
    let mut keys = Vec::new();
    for k in 3..20 {
        keys.extend(transitions(&chunk(&mut lane, f64::from(k), &good("a", f64::from(k) + 5000.0))));
    }
    assert!(keys.iter().any(|key| key.starts_with("feed:source/0/clock/")), "{keys:?}");
    assert_eq!(lane.counters().refused[Refused::FromTheFuture as usize], 17);
}

#[test]
fn no_number_is_passed_over() {
    let whole = ["fte_m\":20.0", "sigma_m\":10.0", "rnp_m\":555.6"];
    for place in 0..whole.len() {
        let mut fields: Vec<String> = whole.iter().map(|field| format!("\"{field}")).collect();
        let name = whole[place].split('"').next().unwrap();
        for value in ["null", "-1.0", "1e999"] {
            fields[place] = format!("\"{name}\":{value}");
            let rest = format!(",{}", fields.join(","));
            let mut lane = Lane::new(settings()).unwrap();
            let usual = format!(",\"{}", whole.join(",\""));
            let all = flown(&mut lane, 30, |k| line("d", f64::from(k), if k == 10 { &rest } else { &usual }));
            let keys: Vec<_> = transitions(&all).into_iter().filter(|key| key.starts_with("d/")).collect();
            let refused: u64 = lane.counters().refused.iter().sum();
            // A deviation to the left is a number; a number beyond all doubles leaves the track without a position.
            let passes = name == "fte_m" && value == "-1.0";
            let reported = keys.iter().any(|key| key.contains("/warning/") || key.contains("/unavailable/")) && refused == 0;
            assert_eq!(reported, !passes, "{name} {value}: {keys:?}, {refused} refused");
            assert!(value != "null" || lane.monitor_counters().n_nan == 1, "{name} {value}");
        }
    }
}

#[test]
fn a_limit_that_a_track_stated_is_not_replaced_by_the_settings() {
    let (stated, without) = (",\"fte_m\":20.0,\"sigma_m\":100.0,\"rnp_m\":100.0", ",\"fte_m\":20.0,\"sigma_m\":100.0");
    let mut lane = Lane::new(settings()).unwrap();
    let all = flown(&mut lane, 30, |k| line("d", f64::from(k), if k < 10 { stated } else { without }));
    let alerts: Vec<_> = epochs_of(&all, "d").iter().map(|e| e.alert).collect();
    assert!(alerts.len() == 30 && alerts[10..].iter().all(|a| *a == rnp::Alert::Warning), "{alerts:?}");
    // Where none was stated it is that of the settings.
    let all = flown(&mut Lane::new(settings()).unwrap(), 30, |k| line("d", f64::from(k), without));
    assert!(epochs_of(&all, "d").iter().all(|e| e.alert == rnp::Alert::Normal));
}

#[test]
fn a_record_without_a_covariance_or_that_is_reported_unusable_is_not_monitored() {
    for (rest, reason) in
        [(",\"fte_m\":20.0", "no_covariance"), (",\"fte_m\":20.0,\"sigma_m\":10.0,\"status\":\"not_available\"", "reported")]
    {
        let mut lane = Lane::new(settings()).unwrap();
        let all = flown(&mut lane, 10, |k| line("d", f64::from(k), rest));
        let epochs: Vec<_> =
            all.iter().filter_map(|o| if let Output::Epoch(e) = o { (e.track.name() == "d").then_some(e) } else { None }).collect();
        assert!(epochs.len() > 5 && epochs.iter().all(|e| e.alert == rnp::Alert::Unavailable && e.reason.unwrap().id() == reason));
    }
}

#[test]
fn tracks_beyond_the_cap_are_refused_and_all_are_forgotten_after_silence() {
    let mut lane = Lane::new(settings()).unwrap();
    let mut keys = Vec::new();
    for k in 0..3 {
        let mut text = String::new();
        for track in 0..60 {
            text += &good(&format!("t{track:02}"), f64::from(k));
        }
        keys.extend(transitions(&chunk(&mut lane, f64::from(k) + 0.1, &text)));
    }
    assert_eq!((lane.n_tracks(), lane.counters().refused[Refused::FleetFull as usize]), (50, 30));
    assert_eq!(keys.iter().filter(|key| key.starts_with("feed:source/0/fleet_full/")).count(), 1);
    let mut out = Vec::new();
    (3..40).for_each(|k| lane.step(&Input::Heartbeat { arrival: at(f64::from(k)) }, &mut out));
    let reported = transitions(&out);
    assert_eq!((lane.n_tracks(), lane.counters().n_expired), (0, 50));
    assert_eq!(reported.iter().filter(|key| key.ends_with("/unavailable/expired")).count(), 0, "{reported:?}");
    assert_eq!(reported.iter().filter(|key| key.contains("/unavailable/") && key.ends_with("expired")).count(), 50);
    assert!(reported.iter().any(|key| key.starts_with("feed:source/0/fleet_full/") && key.ends_with("cleared")));
    // A track that comes back is another incarnation.
    let back: Vec<_> = (50..56)
        .flat_map(|k| transitions(&chunk(&mut lane, f64::from(k), &line("t00", f64::from(k), ",\"fte_m\":9e3,\"sigma_m\":1.0"))))
        .collect();
    assert!(back.iter().any(|key| key.starts_with("t00/1/warning/")), "{back:?}");
}

#[test]
fn a_fault_of_ours_in_one_record_makes_that_track_unavailable_and_nothing_else() {
    let mut clean = Lane::new(settings()).unwrap();
    let expected = flown(&mut clean, 20, |k| good("d", f64::from(k)));
    let mut lane = Lane::new(settings()).unwrap();
    lane.fault = TrackId::new("d");
    let all = flown(&mut lane, 20, |k| good("d", f64::from(k)));
    for name in ["a", "b", "c"] {
        assert_eq!(format!("{:?}", of_track(&all, name)), format!("{:?}", of_track(&expected, name)));
    }
    assert!(lane.counters().n_internal > 10);
    let keys: Vec<_> = transitions(&all).into_iter().filter(|key| key.starts_with("d/")).collect();
    assert_eq!(keys.len(), 1, "{keys:?}");
    assert!(keys[0].contains("/unavailable/"));
}

#[test]
fn malformed_lines_are_counted_and_the_next_good_one_is_taken() {
    let mut lane = Lane::new(settings()).unwrap();
    let deep = format!("{}{}", "[".repeat(500), "]".repeat(500));
    let long = format!("{{\"v\":1,\"track\":\"{}\",\"time_ns\":1}}", "x".repeat(33));
    let bad = [
        "",
        "{",
        "null",
        "[]",
        "{}",
        "{\"v\":1}",
        "{\"v\":2,\"track\":\"a\",\"time_ns\":1}",
        "{\"v\":1,\"track\":\"\",\"time_ns\":1}",
        "{\"v\":1,\"track\":\"a/b\",\"time_ns\":1}",
        "{\"v\":1,\"track\":\"a\",\"time_ns\":1.5}",
        "{\"v\":1,\"track\":\"a\",\"time_ns\":-1}",
        "{\"v\":1,\"track\":\"a\",\"time_ns\":1,\"sigma_m\":\"x\"}",
        "{\"v\":1,\"track\":\"a\",\"time_ns\":1,\"sigma_m\":NaN}",
        "{\"v\":1,\"track\":\"a\",\"track\":\"b\",\"time_ns\":1}",
        "{\"v\":1,\"track\":\"<img onerror>\",\"time_ns\":1}",
        &deep,
        &long,
    ];
    let mut text = String::new();
    for each in bad {
        writeln!(text, "{each}").unwrap();
    }
    chunk(&mut lane, 0.1, &(text + &good("a", 0.0)));
    assert_eq!(lane.counters().refused.iter().sum::<u64>(), bad.len() as u64 - 1, "an empty line is nothing: {:?}", lane.counters());
    assert_eq!((lane.counters().n_records, lane.n_tracks()), (1, 1));
}

/// A journal with everything in it.
fn journal() -> Vec<Vec<u8>> {
    let mut inputs = Vec::new();
    for k in 0..40 {
        let t = f64::from(k);
        let mut text = good("a", t) + &good("b", t + 0.3);
        if k % 7 != 3 {
            let fte_m = if (8..16).contains(&k) { 600 } else { 0 };
            text += &line("c", t, &format!(",\"fte_m\":{fte_m},\"sigma_m\":10.0"));
        }
        if !(10..16).contains(&k) {
            text += &good("d", t);
        }
        let (head, tail) = text.split_at(text.len() / 3);
        inputs.push(Input::Chunk { arrival: Some(at(t + 0.1)), bytes: head.as_bytes() }.to_bytes());
        inputs.push(Input::Chunk { arrival: Some(at(t + 0.2)), bytes: tail.as_bytes() }.to_bytes());
        inputs.push(Input::Heartbeat { arrival: at(t + 0.5) }.to_bytes());
    }
    inputs.push(Input::End { arrival: None }.to_bytes());
    inputs
}

fn judged(lane: &mut Lane, inputs: &[Vec<u8>]) -> Vec<u8> {
    let (mut out, mut bytes) = (Vec::new(), Vec::new());
    inputs.iter().for_each(|input| lane.step(&Input::from_bytes(input).unwrap(), &mut out));
    out.iter().for_each(|output| output.append(&mut bytes));
    bytes
}

#[test]
fn a_lane_that_is_restored_anywhere_goes_on_in_every_bit() {
    let inputs = journal();
    let expected = judged(&mut Lane::new(settings()).unwrap(), &inputs);
    assert!(transitions(&Output::all(&expected).unwrap()).len() == 4);
    for cut in 0..inputs.len() {
        let mut first = Lane::new(settings()).unwrap();
        let mut bytes = judged(&mut first, &inputs[..cut]);
        let snapshot = first.snapshot(cut as u64, 5);
        let (mut second, position, written) = Lane::restore(settings(), &snapshot).unwrap();
        assert_eq!((position, written), (cut as u64, 5));
        assert_eq!(second.snapshot(position, written), snapshot);
        bytes.extend(judged(&mut second, &inputs[cut..]));
        assert!(bytes == expected, "cut at input {cut}");
    }
}

#[test]
fn a_damaged_snapshot_is_refused() {
    let mut lane = Lane::new(settings()).unwrap();
    judged(&mut lane, &journal()[..60]);
    let snapshot = lane.snapshot(60, 0);
    for place in 0..snapshot.len() {
        let mut damaged = snapshot.clone();
        damaged[place] ^= 0x10;
        assert_eq!(Lane::restore(settings(), &damaged).err(), Some(SnapshotRefused::Checksum), "byte {place}");
        assert!(Lane::restore(settings(), &snapshot[..place]).is_err(), "cut at {place}");
    }
    let other = Settings { digest: [8; 32], ..settings() };
    assert_eq!(Lane::restore(other, &snapshot).err(), Some(SnapshotRefused::Settings));
}

#[test]
fn a_torn_frame_is_distinct_from_a_damaged_one() {
    let frame = journal::frame(b"payload");
    assert_eq!(journal::next(&frame), journal::Next::Payload(b"payload", frame.len()));
    for end in 0..frame.len() {
        assert_eq!(journal::next(&frame[..end]), journal::Next::Torn, "{end}");
        let mut damaged = frame.clone();
        damaged[end] ^= 1;
        assert!(!matches!(journal::next(&damaged), journal::Next::Payload(..)), "{end}");
    }
}

proptest! {
    #[test]
    fn any_bytes_are_taken_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..2000), format in 0..5_usize) {
        let format = Format::of(["json", "ubx", "sbf", "novatel", "nmea"][format]).unwrap();
        let mut lane = Lane::new(Settings { format, ..settings() }).unwrap();
        let mut out = Vec::new();
        lane.step(&Input::Chunk { arrival: Some(at(0.0)), bytes: &bytes }, &mut out);
        lane.step(&Input::End { arrival: None }, &mut out);
        let _ = Input::from_bytes(&bytes);
        let _ = Output::all(&bytes);
        let with_crc = [bytes.as_slice(), &navbound_core::quantity::encoding::crc32c(&bytes).to_le_bytes()].concat();
        prop_assert!(Lane::restore(settings(), &with_crc).is_err());
    }
}

/// The largest variance of a direction counts where nobody says which direction is across: 300 m to the north, 1 m to the east.
#[test]
fn a_deviation_without_a_course_takes_the_largest_error_of_any_direction() {
    let after = |more: &str| {
        let mut lane = Lane::new(settings()).unwrap();
        let one = |k: f64| line("t", k, &format!(",\"fte_m\":10.0,\"cov_ee_m2\":1.0,\"cov_en_m2\":0.0,\"cov_nn_m2\":90000.0{more}"));
        let outputs: Vec<Output> = [0.0, 1.0, 2.0, 3.0].into_iter().flat_map(|k| chunk(&mut lane, k, &one(k))).collect();
        let first = outputs.iter().find_map(|output| if let Output::Epoch(e) = output { Some((e.status, e.numbers[0])) } else { None });
        first.unwrap()
    };
    // Northwards the eastern error is across; eastwards, and where nobody knows, the northern one is.
    assert!(after(",\"course_rad\":0.0").1 < 13.0);
    let east = after(",\"course_rad\":1.5707963267948966").1;
    assert!((after("").1 - east).abs() < 1e-6 * east && east > 400.0, "{east}");
    assert!(!after(",\"course_rad\":1e300").0.usable());
}

fn epochs_of(outputs: &[Output], name: &str) -> Vec<EpochOut> {
    let of = |o: &Output| if let Output::Epoch(e) = o { (e.track.name() == name).then_some(*e) } else { None };
    outputs.iter().filter_map(of).collect()
}

fn number(epoch: &EpochOut, name: &str) -> f64 {
    epoch.numbers[NUMBERS.iter().position(|each| *each == name).unwrap()]
}

#[test]
fn the_wait_to_the_caution_is_counted_down_in_time_outside_and_is_none_otherwise() {
    let mut lane = Lane::new(settings()).unwrap();
    // Outside RNP (555.6 m) and inside twice RNP from 10 to 19 s.
    let all = flown(&mut lane, 40, |k| {
        let fte_m = if (10..20).contains(&k) { 600.0 } else { 20.0 };
        line("d", f64::from(k), &format!(",\"fte_m\":{fte_m},\"sigma_m\":10.0,\"rnp_m\":555.6"))
    });
    let left: Vec<_> = epochs_of(&all, "d").iter().map(|e| number(e, "caution_in_s")).collect();
    assert_eq!(left[10..13], [3.0, 2.0, 1.0]);
    assert!(left.iter().enumerate().all(|(k, left)| left.is_nan() || (10..13).contains(&k)), "{left:?}");
    assert_eq!(epochs_of(&all, "d")[13].alert, rnp::Alert::Caution);
}

#[test]
fn what_is_shown_beside_the_judgement_goes_through_as_it_came() {
    let mut lane = Lane::new(settings()).unwrap();
    let rest = ",\"fte_m\":20.0,\"course_rad\":0.0,\"cov_ee_m2\":9.0,\"cov_en_m2\":0.0,\"cov_nn_m2\":16.0,\"cov_eu_m2\":0.0,\"cov_nu_m2\":0.0,\"cov_uu_m2\":25.0";
    let shown = ",\"fte_v_m\":-3.5,\"vpl_m\":20.5,\"hal_m\":40.0,\"val_m\":35.0,\"n_sv\":9,\"nav_mode\":\"gnss\"";
    let all = flown(&mut lane, 3, |k| line("d", f64::from(k), &format!("{rest}{}", if k == 1 { shown } else { "" })));
    let epochs = epochs_of(&all, "d");
    let names = ["fte_v_m", "vpl_m", "hal_m", "val_m", "n_sv"];
    assert_eq!(names.map(|name| number(&epochs[1], name)), [-3.5, 20.5, 40.0, 35.0, 9.0]);
    assert_eq!(epochs[1].nav_mode.map(|mode| mode.name().to_owned()).as_deref(), Some("gnss"));
    // What is not stated is not kept from the record before.
    assert!(names.iter().all(|name| number(&epochs[2], name).is_nan()) && epochs[2].nav_mode.is_none());
    // Two-sided normal quantile at 0.05, of 3 m across a northern course and of 5 m upwards.
    let quantile = 1.959_963_984_540_054;
    assert!((number(&epochs[1], "anp_cross_m") - 3.0 * quantile).abs() < 1e-9);
    assert!((number(&epochs[1], "anp_vertical_m") - 5.0 * quantile).abs() < 1e-9);
    assert_eq!(["cov_ee_m2", "cov_en_m2", "cov_nn_m2"].map(|name| number(&epochs[1], name)), [9.0, 0.0, 16.0]);
    let mut bytes = Vec::new();
    all.iter().for_each(|output| output.append(&mut bytes));
    assert_eq!(format!("{:?}", Output::all(&bytes).unwrap()), format!("{all:?}"));
}

#[test]
fn a_mode_that_no_word_can_have_costs_no_position() {
    let mut lane = Lane::new(settings()).unwrap();
    let all = flown(&mut lane, 3, |k| line("d", f64::from(k), ",\"fte_m\":20.0,\"sigma_m\":10.0,\"nav_mode\":\"<img onerror>\""));
    assert_eq!(epochs_of(&all, "d").len(), 3);
    assert!(epochs_of(&all, "d").iter().all(|e| e.nav_mode.is_none() && e.alert == rnp::Alert::Normal));
}

/// A deviation counts from the record on that states one; a track that states none any more is not judged without it.
#[test]
fn a_track_that_states_its_deviation_is_judged_by_its_total_error() {
    let navigation_alone = || {
        let base = settings();
        let judge = judge::Settings { method: Alerting::of("anp-circle").unwrap(), ..base.judge };
        Settings { judge, of_stated_fte: Some(base.judge.method), ..base }
    };
    // A hundred times RNP aside at a navigation error of 10 m.
    let aside = |k: u32| format!(",\"fte_m\":{},\"course_rad\":0.0,\"sigma_m\":10.0", if k < 10 { 20 } else { 55_560 });
    let mut lane = Lane::new(navigation_alone()).unwrap();
    let all = flown(&mut lane, 30, |k| line("d", f64::from(k), &aside(k)));
    let warned = all.iter().find_map(|o| if let Output::Transition(t) = o { Some((t.kind, t.event)) } else { None });
    assert_eq!(warned, Some((Kind::Warning, at(10.0))));
    // The same judge as the one that is set to the total error, to the bit.
    let mut total = Lane::new(settings()).unwrap();
    assert_eq!(format!("{all:?}"), format!("{:?}", flown(&mut total, 30, |k| line("d", f64::from(k), &aside(k)))));
    // A track without a deviation keeps the navigation error, and one that stops to state it has no bound.
    let mut lane = Lane::new(navigation_alone()).unwrap();
    let alone = |k: u32| placed(0.5 + 1e-5 * f64::from(k), "");
    let stops = |k: u32| line("f", f64::from(k), &if k < 3 { aside(0) } else { alone(k) });
    let all = flown(&mut lane, 6, |k| line("e", f64::from(k), &alone(k)) + &stops(k));
    assert!(epochs_of(&all, "e").iter().all(|e| e.status.usable() && number(e, "accuracy_bound_m") < 30.0));
    assert_eq!(epochs_of(&all, "f").iter().map(|e| e.status.usable()).collect::<Vec<_>>(), [true, true, true, false, false, false]);
    // It is kept in a snapshot.
    let (mut lane, ..) = Lane::restore(navigation_alone(), &lane.snapshot(0, 0)).unwrap();
    let after = flown(&mut lane, 1, |_| line("f", 6.0, &alone(6)));
    assert!(epochs_of(&after, "f").iter().all(|e| !e.status.usable()));
}

/// A logger writes zero for an accuracy that it does not have.
#[test]
fn a_variance_of_zero_in_any_axis_is_not_believed() {
    for zero in 0..3 {
        let of = |axis: usize| if axis == zero { 0.0 } else { 25.0 };
        let rest = format!(
            ",\"fte_m\":20.0,\"course_rad\":0.0,\"cov_ee_m2\":{},\"cov_en_m2\":0.0,\"cov_nn_m2\":{},\"cov_eu_m2\":0.0,\"cov_nu_m2\":0.0,\"cov_uu_m2\":{}",
            of(0),
            of(1),
            of(2)
        );
        let all = flown(&mut Lane::new(settings()).unwrap(), 3, |k| line("d", f64::from(k), &rest));
        let epochs = epochs_of(&all, "d");
        // In the plane nothing bounds the error, and nothing is normal.
        let (status, alert) =
            if zero < 2 { (Status::NotAvailable, rnp::Alert::Unavailable) } else { (Status::Degraded, rnp::Alert::Normal) };
        assert!(epochs.iter().all(|e| (e.status, e.alert) == (status, alert)), "{zero}: {:?}", epochs[0]);
    }
}

#[test]
fn a_level_of_nothing_and_a_status_of_nothing_are_not_normal() {
    let after_good = |rest: &str| {
        let rest = format!(",\"fte_m\":5.0,\"course_rad\":0.0,\"sigma_m\":3.0{rest}");
        let all = flown(&mut Lane::new(settings()).unwrap(), 12, |k| line("d", f64::from(k), &rest));
        epochs_of(&all, "d").last().map(|e| e.alert)
    };
    assert_eq!(after_good(",\"hpl_m\":20.0,\"status\":\"ok\""), Some(rnp::Alert::Normal));
    assert_ne!(after_good(",\"hpl_m\":0.0"), Some(rnp::Alert::Normal));
    assert_eq!(after_good(",\"status\":null"), Some(rnp::Alert::Unavailable));
}

/// A line that says of whom and of when it is, and no position that can be read, leaves its track without one at that time.
#[test]
fn a_line_that_is_refused_for_its_numbers_is_a_loss_of_its_track() {
    let bad = [
        ",\"fte_m\":NaN,\"sigma_m\":10.0",
        ",\"fte_m\":20.0,\"sigma_m\":-Infinity",
        ",\"fte_m\":20.0,\"sigma_m\":\"ten\"",
        ",\"fte_m\":20.0,\"sigma_m\":10.0,\"status\":\"OK\"",
        ",\"fte_m\":[20.0],\"sigma_m\":10.0",
    ];
    for rest in bad {
        let mut lane = Lane::new(settings()).unwrap();
        let stated = |k: u32| line("d", f64::from(k), if (10..20).contains(&k) { rest } else { ",\"fte_m\":20.0,\"sigma_m\":10.0" });
        let all = flown(&mut lane, 30, stated);
        let of = epochs_of(&all, "d");
        // What is stated as none is within no limit (warning); what cannot be read is not there (unavailable).
        assert!(of[10..20].iter().all(|e| e.alert != rnp::Alert::Normal), "{rest}");
        assert!(of[..10].iter().chain(&of[28..]).all(|e| e.alert == rnp::Alert::Normal), "{rest}");
        let raised = all.iter().any(|o| matches!(o, Output::Transition(t) if t.track == TrackId::new("d") && t.event == at(10.0)));
        assert!(raised, "{rest}");
        assert!(lane.counters().refused.iter().all(|n| *n == 0));
    }
    // A word in a text is a word.
    assert_eq!(
        TrackId::new("NaN"),
        epochs_of(&flown(&mut Lane::new(settings()).unwrap(), 3, |k| good("NaN", f64::from(k))), "NaN").first().map(|e| e.track)
    );
}

/// A file has no arrivals: what it could not be read of is an alert at its end, in pieces of any size.
#[test]
fn a_file_that_is_damaged_by_a_tenth_says_so_at_its_end() {
    let text = |one_in: u32| {
        (0..60).fold(String::new(), |all, k| all + &good("d", f64::from(k)) + if k % one_in == 0 { "{ damaged\n" } else { "" })
    };
    for (one_in, garbled) in [(5, true), (30, false)] {
        let outputs = [1, 7, 100_000].map(|size| {
            let (mut lane, mut out) = (Lane::new(settings()).unwrap(), Vec::new());
            for bytes in text(one_in).as_bytes().chunks(size) {
                lane.step(&Input::Chunk { arrival: None, bytes }, &mut out);
            }
            lane.step(&Input::End { arrival: None }, &mut out);
            format!("{out:?}")
        });
        assert_eq!((outputs[0].contains("Garbled"), &outputs[0], &outputs[0]), (garbled, &outputs[1], &outputs[2]));
    }
}

/// A position and its accuracy, and what else is stated.
fn placed(lat_rad: f64, more: &str) -> String {
    format!(",\"est_lat_rad\":{lat_rad},\"est_lon_rad\":0.1,\"est_h_m\":100.0,\"sigma_m\":10.0{more}")
}

/// Of the record at 10 s and of those after it: reasons, each once in its order. 1e-5 rad a second are 64 m/s.
fn doubts(limits: motion::Limits, of: impl Fn(u32) -> String) -> (Vec<&'static str>, Vec<rnp::Alert>) {
    let base = settings();
    let judge = judge::Settings { method: Alerting::of("anp-circle").unwrap(), ..base.judge };
    let mut lane = Lane::new(Settings { judge, motion: limits, ..base }).unwrap();
    let mut all = flown(&mut lane, 30, |k| line("d", f64::from(k), &of(k)));
    // The lane that is written down on the way goes on alike.
    let mut restored = Lane::restore(lane.settings.clone(), &lane.snapshot(0, 0)).unwrap().0;
    let next = |lane: &mut Lane| chunk(lane, 30.1, &line("d", 30.0, &of(30)));
    assert_eq!(format!("{:?}", next(&mut lane.clone())), format!("{:?}", next(&mut restored)));
    all.extend(next(&mut lane));
    let epochs = epochs_of(&all, "d");
    let mut reasons: Vec<_> = epochs.iter().filter_map(|e| e.reason.map(Reason::id)).collect();
    reasons.dedup();
    (reasons, epochs.iter().map(|e| e.alert).collect())
}

#[test]
fn a_position_that_stays_while_its_aircraft_moves_is_not_believed() {
    let limits = settings().motion;
    let flies = |k: u32| 0.5 + 1e-5 * f64::from(k);
    let frozen = |k: u32| flies(k.min(10));
    let fast = ",\"ground_speed_mps\":64.0";
    assert_eq!(doubts(limits, |k| placed(flies(k), fast)).0, [""; 0]);
    let (reasons, alerts) = doubts(limits, |k| placed(frozen(k), fast));
    assert_eq!(reasons, ["position_held", "position_stale"]);
    assert!(alerts[..13].iter().all(|a| *a == rnp::Alert::Normal) && alerts[14..].iter().all(|a| *a == rnp::Alert::Unavailable));
    // Nobody says that it stands; somebody says it; the receiver is known to stand.
    assert_eq!(doubts(limits, |k| placed(frozen(k), "")).0, ["position_stale"]);
    assert_eq!(doubts(limits, |_| placed(frozen(0), ",\"ground_speed_mps\":0.0")).0, [""; 0]);
    // Of an aircraft that flew one second before it is no word.
    let stops = |k: u32| placed(frozen(k), if k < 10 { fast } else { ",\"ground_speed_mps\":0.0" });
    assert_eq!(doubts(limits, stops).0, ["position_stale"]);
    assert_eq!(doubts(motion::Limits { moving_mps: f64::INFINITY, ..limits }, |k| placed(frozen(k), "")).0, [""; 0]);
}

#[test]
fn a_position_that_jumps_farther_than_its_aircraft_flies_is_not_believed() {
    // 64 km to the side.
    let spoofed = |k: u32| 0.5 + 1e-5 * f64::from(k) + if k >= 10 { 0.01 } else { 0.0 };
    for speed in [",\"ground_speed_mps\":64.0", ""] {
        let (reasons, alerts) = doubts(settings().motion, |k| placed(spoofed(k), speed));
        assert_eq!(reasons, ["position_jump", "position_not_settled"]);
        assert!(alerts[10..].iter().all(|a| *a == rnp::Alert::Unavailable), "{alerts:?}");
    }
}

/// A receiver that flies 70 m/s north, every second record so many metres beside.
#[test]
fn positions_that_alternate_are_not_believed() {
    let of = |k: u32, aside_m: f64| {
        let (lat, lon) = (0.8 + 70.0 * f64::from(k) / 6.371e6, if k.is_multiple_of(2) { 0.1 } else { 0.1 + aside_m / 4.44e6 });
        line(
            "a",
            f64::from(k),
            &format!(
                ",\"est_lat_rad\":{lat},\"est_lon_rad\":{lon},\"sigma_m\":3.0,\"fte_m\":0.0,\"course_rad\":0.0,\"ground_speed_mps\":70.0"
            ),
        )
    };
    for (aside_m, expected) in
        [(0.0, [None; 4]), (420.0, [None, None, Some(Reason::NeighboursContradict), Some(Reason::NeighboursContradict)])]
    {
        let mut lane = Lane::new(settings()).unwrap();
        let mut all = Vec::new();
        for k in 0..8 {
            all.extend(chunk(&mut lane, f64::from(k) + 0.1, &of(k, aside_m)));
        }
        let reasons: Vec<_> = epochs_of(&all, "a").iter().map(|e| e.reason).collect();
        assert_eq!(reasons[..4], expected, "{aside_m}");
    }
}

/// Records that come so late that monitoring may have been silent meanwhile, though their own times go on.
#[test]
fn data_that_are_not_of_now_are_not_monitored() {
    for (late_s, normal) in [(2.5, true), (3.1, false), (18.0, false), (3000.0, false)] {
        let mut lane = Lane::new(settings()).unwrap();
        let mut all = Vec::new();
        for k in 0..40 {
            let now = late_s + 0.5 * f64::from(k);
            all.extend(chunk(&mut lane, now, &good("a", 0.5 * f64::from(k))));
            lane.step(&Input::Heartbeat { arrival: at(now + 0.3) }, &mut all);
        }
        let epochs = epochs_of(&all, "a");
        assert!(epochs.len() >= 36, "{late_s}");
        assert!(epochs.iter().all(|e| (e.alert == rnp::Alert::Normal) == normal), "{late_s}");
        assert!(epochs.iter().all(|e| (e.reason == Some(Reason::RecordOld)) != normal), "{late_s}");
        // Raised once, and never taken back; a track that is forgotten meanwhile begins anew.
        let turns = all.iter().filter(|output| matches!(output, Output::Transition(t) if t.turn == Turn::Cleared)).count();
        assert_eq!(turns, 0, "{late_s}");
        assert!(late_s > 20.0 || transitions(&all).len() == usize::from(!normal), "{late_s}");
    }
}

/// A source that says two things of one instant. 1e-5 rad a second are 64 m/s.
#[test]
fn two_statements_of_one_instant_that_contradict_each_other_are_an_alert_and_nothing_is_believed_until_it_settles() {
    let flies = |k: u32| 0.5 + 1e-5 * f64::from(k);
    let speed = ",\"ground_speed_mps\":64.0";
    let second = |more: &str, aside_m: f64| {
        let base = settings();
        let judge = judge::Settings { method: Alerting::of("anp-circle").unwrap(), ..base.judge };
        let mut lane = Lane::new(Settings { judge, ..base }).unwrap();
        let also = |k: u32| {
            if k == 10 { line("d", 10.0, &placed(flies(k) + aside_m / 6.371e6, &format!("{speed}{more}"))) } else { String::new() }
        };
        let all = flown(&mut lane, 50, |k| line("d", f64::from(k), &placed(flies(k), speed)) + &also(k));
        epochs_of(&all, "d")
    };
    // 10 m of standard deviation each: 2 m of rounding and 6.44 times 14.1 m are explained.
    for (more, aside_m, contradicts) in
        [("", 80.0, false), ("", 300.0, true), ("", 5e5, true), (",\"status\":\"not_available\"", 0.0, true)]
    {
        let epochs = second(more, aside_m);
        let settled = |e: &&EpochOut| e.time > at(40.0);
        assert_eq!(epochs[11].alert == rnp::Alert::Unavailable, contradicts, "{aside_m}");
        assert_eq!(epochs[12..].iter().any(|e| e.alert != rnp::Alert::Normal), contradicts, "{aside_m}");
        assert_eq!(epochs[12..41].iter().all(|e| e.status != Status::Ok), contradicts, "{aside_m}");
        assert!(epochs.iter().filter(settled).count() > 5 && epochs.iter().filter(settled).all(|e| e.alert == rnp::Alert::Normal));
    }
}

/// 70 m a record whose time stamps go on by less than a millisecond.
#[test]
fn positions_that_are_flown_faster_than_their_time_stamps_go_on_are_not_believed() {
    for (step_ns, speed) in [(1_000, ",\"ground_speed_mps\":70.0"), (1_000_000, ",\"ground_speed_mps\":70.0"), (1_000_000, "")] {
        let mut lane = Lane::new(settings()).unwrap();
        let mut all = Vec::new();
        for k in 0..90 {
            let of = placed(0.5 + 70.0 * f64::from(k) / 6.371e6, &format!("{speed},\"fte_m\":0.0"));
            let text = format!("{{\"v\":1,\"track\":\"d\",\"time_ns\":{}{of}}}\n", T0_NS / 1000 + i64::from(k) * step_ns);
            lane.step(&Input::Chunk { arrival: None, bytes: text.as_bytes() }, &mut all);
        }
        lane.step(&Input::End { arrival: None }, &mut all);
        let epochs = epochs_of(&all, "d");
        assert_eq!(epochs.len(), 90);
        assert!(epochs[18..].iter().all(|e| e.alert == rnp::Alert::Unavailable), "{step_ns}");
    }
}

/// What a line says under keys that are none of the contract: heard where it is a statement, otherwise counted by name.
#[test]
fn a_statement_under_another_key_is_heard_and_every_other_key_is_counted() {
    let deep = format!("\"a\":{}1{}", "[".repeat(200), "]".repeat(200));
    let against = [
        "\"valid\":false",
        "\"Valid\":0",
        "\"valid\":null",
        "\"valid\":[1,0]",
        "\"valid\":[]",
        "\"epu_m\":5.0",
        "\"HPL\":10.0",
        "\"hdop\":31",
        "\"hdop\":\"31\"",
        "\"n_sats\":2",
        "\"gps\":{\"valid\":false}",
        "\"a\":{\"b\":{\"valid\":false}}",
        "\"nav\":{\"fault\":true}",
        "\"a\":[{\"valid\":0}]",
        "\"flags\":[\"ok\",\"spoofed\"]",
        "\"flags\":\"OK|SPOOFED\"",
        "\"note\":\"NAV FAULT\"",
        // What cannot be read to its end.
        "\"n\":1e999",
        "\"n\":\"\\ud800\"",
        &deep,
    ];
    let fine = [
        "\"valid\":true",
        "\"valid\":1.0",
        "\"hdop\":1.5",
        "\"hdop\":\"1.5\"",
        "\"comment\":\"x\"",
        "\"nav_mode\":\"nav\"",
        "\"n_sats\":7",
        "\"n_sats\":null",
        "\"gps\":{\"valid\":true}",
        "\"flags\":[\"ok\"]",
        "\"spoofed\":[]",
        "\"what\":\"valid\"",
    ];
    for (keys, status) in
        [(&against[..], Status::InvalidInput), (&fine[..], Status::Ok), (&["\"nav_mode\":\"Stopped\""][..], Status::NotAvailable)]
    {
        for key in keys {
            let mut lane = Lane::new(settings()).unwrap();
            let mut all = chunk(&mut lane, 0.1, &line("d", 0.0, &format!(",\"fte_m\":20.0,\"sigma_m\":10.0,{key}")));
            lane.step(&Input::End { arrival: None }, &mut all);
            let epochs = epochs_of(&all, "d");
            assert_eq!(epochs[0].status, status, "{key}");
            assert_eq!(lane.passed_over().get("comment").copied(), key.contains("comment").then_some(1));
        }
    }
    let mut lane = Lane::new(settings()).unwrap();
    for k in 0..230 {
        chunk(&mut lane, 0.1, &line("d", 0.0, &format!(",\"key {k}\":1")));
    }
    let expected: u64 = lane.passed_over().values().sum();
    assert_eq!((lane.passed_over().len(), lane.passed_over()["(others)"], expected), (201, 30, 230));
    let restored = Lane::restore(settings(), &lane.snapshot(0, 0)).unwrap().0;
    assert_eq!(restored.passed_over(), lane.passed_over());
}

#[test]
fn the_mark_before_a_text_in_utf_8_costs_no_record() {
    let mut lane = Lane::new(settings()).unwrap();
    let mut all = chunk(&mut lane, 0.1, &format!("\u{feff}{}", good("d", 0.0)));
    lane.step(&Input::End { arrival: None }, &mut all);
    assert_eq!(epochs_of(&all, "d").len(), 1);
}
