//! The state of the RNP monitor as bytes: what is read goes on as what was written, and nothing else is read.
#![allow(clippy::unwrap_used, reason = "a helper of tests may stop at the first surprise, too")]

use navbound_core::bound::Alerting;
use navbound_core::monitor::rnp::{Alert, Chain, Monitor, Observation, Settings};
use navbound_core::quantity::encoding::{BadBytes, crc32c};
use navbound_core::quantity::{GpsTime, Metres};
use proptest::prelude::*;

const RNP_M: f64 = 500.0;

/// One thing that happens to a monitor.
#[derive(Debug, Clone, Copy)]
enum Happening {
    /// An epoch, this much later than the one before \[ms\], with bounds as shares of their limits.
    Epoch { later_ms: i64, accuracy: f64, integrity: f64, rnp_m: f64, usable: bool },
    /// The arrival clock, this much later than the last epoch \[ms\].
    Tick { later_ms: i64 },
}

fn settings(raise_delay_s: f64, clear_delay_s: f64, time_to_alert_s: f64) -> Settings {
    let chain = Chain { sample_period_s: 1.0, sensor_latency_s: 0.1, filter_s: 0.0, computing_s: 0.05, display_s: 0.2, time_to_alert_s };
    Settings { chain, raise_delay_s, clear_delay_s, clear_ratio: 0.95, stale_after_s: 2.0 }
}

fn share() -> impl Strategy<Value = f64> {
    prop_oneof![4 => Just(0.5), 2 => Just(0.97), 3 => Just(1.3), 1 => Just(f64::NAN), 1 => Just(f64::INFINITY), 1 => Just(-1.0)]
}

fn happening() -> impl Strategy<Value = Happening> {
    let later = prop_oneof![10 => Just(1000_i64), 1 => Just(0), 1 => Just(1), 1 => Just(7000), 1 => Just(-1000), 1 => Just(-90_000)];
    let rnp = prop_oneof![8 => Just(RNP_M), 1 => Just(RNP_M / 2.0), 1 => Just(f64::NAN)];
    let epoch = (later, share(), share(), rnp, prop::bool::weighted(0.9))
        .prop_map(|(later_ms, accuracy, integrity, rnp_m, usable)| Happening::Epoch { later_ms, accuracy, integrity, rnp_m, usable });
    prop_oneof![12 => epoch, 1 => (-1000_i64..5000).prop_map(|later_ms| Happening::Tick { later_ms })]
}

/// What a monitor says of it, in text: NaN and the sign of a zero are seen.
fn happens(monitor: &mut Monitor, now_ms: &mut i64, what: Happening) -> String {
    let time = |ms: i64| GpsTime::from_nanoseconds(ms * 1_000_000);
    match what {
        Happening::Tick { later_ms } => format!("{:?}", monitor.tick(time(*now_ms + later_ms))),
        Happening::Epoch { later_ms, accuracy, integrity, rnp_m, usable } => {
            *now_ms += later_ms;
            let bound = |length_m| Alerting::of("tse-exact").unwrap().claim_evaluated(Metres::new(length_m));
            let (accuracy, integrity) = (bound(accuracy * RNP_M), bound(2.0 * integrity * RNP_M));
            format!("{:?}", monitor.step(&Observation { time: time(*now_ms), accuracy, integrity, rnp: Metres::new(rnp_m), usable }))
        }
    }
}

proptest! {
    #[test]
    fn a_monitor_that_was_read_is_the_one_that_was_written_and_takes_the_same_steps(
        raise_s in prop_oneof![Just(0.0), Just(3.0)],
        clear_s in prop_oneof![Just(0.0), Just(10.0)],
        alert_s in prop_oneof![Just(f64::INFINITY), Just(10.0)],
        happenings in prop::collection::vec(happening(), 0..120),
        cut in any::<prop::sample::Index>(),
    ) {
        let mut monitor = Monitor::new(settings(raise_s, clear_s, alert_s)).unwrap();
        let mut now_ms = 1_000_000;
        let cut = cut.index(happenings.len() + 1);
        happenings[..cut].iter().for_each(|what| { happens(&mut monitor, &mut now_ms, *what); });
        let bytes = monitor.to_bytes();
        let mut again = Monitor::from_bytes(&bytes).unwrap();
        prop_assert_eq!(bytes, again.to_bytes());
        prop_assert_eq!(format!("{monitor:?}"), format!("{again:?}"));
        let mut same_ms = now_ms;
        for what in &happenings[cut..] {
            prop_assert_eq!(happens(&mut monitor, &mut now_ms, *what), happens(&mut again, &mut same_ms, *what));
            prop_assert_eq!(monitor.to_bytes(), again.to_bytes());
        }
    }

    /// Bytes that somebody has made up, with a checksum that fits: refused, or a monitor that is written as it was read.
    #[test]
    fn bytes_with_a_right_checksum_are_a_state_or_refused(changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4)) {
        let mut bytes = some_state().to_bytes();
        for (place, byte) in changes {
            bytes[place.index(Monitor::BYTES - 4)] = byte;
        }
        let sealed = seal(bytes);
        if let Ok(monitor) = Monitor::from_bytes(&sealed) {
            prop_assert_eq!(monitor.to_bytes(), sealed);
            prop_assert!(monitor.settings().checked().is_ok());
        }
    }
}

/// A caution that is in force since the fifth second, with a tick after it.
fn some_state() -> Monitor {
    let mut monitor = Monitor::new(settings(3.0, 10.0, 10.0)).unwrap();
    let mut now_ms = 1_000_000;
    for accuracy in [0.5, 1.2, 1.3, 1.25, 1.4, 0.9] {
        happens(&mut monitor, &mut now_ms, Happening::Epoch { later_ms: 1000, accuracy, integrity: 0.5, rnp_m: RNP_M, usable: true });
    }
    happens(&mut monitor, &mut now_ms, Happening::Tick { later_ms: 500 });
    assert_eq!(monitor.alert(), Alert::Caution);
    monitor
}

fn seal(mut bytes: [u8; Monitor::BYTES]) -> [u8; Monitor::BYTES] {
    let crc = crc32c(&bytes[..Monitor::BYTES - 4]);
    bytes[Monitor::BYTES - 4..].copy_from_slice(&crc.to_le_bytes());
    bytes
}

#[test]
fn every_damaged_bit_and_every_other_length_is_refused() {
    let bytes = some_state().to_bytes();
    for bit in 0..8 * bytes.len() {
        let mut damaged = bytes;
        damaged[bit / 8] ^= 1 << (bit % 8);
        assert_eq!(Monitor::from_bytes(&damaged).err(), Some(BadBytes::Checksum), "bit {bit}");
    }
    for length in 0..bytes.len() {
        assert_eq!(Monitor::from_bytes(&bytes[..length]).err(), Some(BadBytes::Length));
    }
    let longer: Vec<u8> = bytes.iter().copied().chain([0]).collect();
    assert_eq!(Monitor::from_bytes(&longer).err(), Some(BadBytes::Length));
}

#[test]
fn another_version_and_settings_that_cannot_be_are_refused_by_name() {
    let mut newer = some_state().to_bytes();
    newer[0] = 2;
    assert_eq!(Monitor::from_bytes(&seal(newer)).err(), Some(BadBytes::Version(2)));
    // The settings begin with the sample period.
    let mut without_period = some_state().to_bytes();
    without_period[1..9].copy_from_slice(&0.0_f64.to_le_bytes());
    assert_eq!(Monitor::from_bytes(&seal(without_period)).err(), Some(BadBytes::Value("sample_period_s")));
}

/// Bytes of each version that was ever written: they are read, or refused by their version.
#[test]
fn the_state_of_version_1_is_still_read() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../vectors/snapshots/rnp-monitor-1.hex");
    let text: String = std::fs::read_to_string(path).unwrap().split_whitespace().collect();
    let bytes: Vec<u8> = (0..text.len()).step_by(2).map(|k| u8::from_str_radix(&text[k..k + 2], 16).unwrap()).collect();
    let monitor = Monitor::from_bytes(&bytes).unwrap();
    assert_eq!(format!("{monitor:?}"), format!("{:?}", some_state()));
    let caution = monitor.open_events().next().unwrap();
    // By hand: outside from the second epoch (1002 s), full after three seconds, peak 1.4 RNP.
    assert_eq!((caution.onset.nanoseconds(), caution.annunciation.nanoseconds()), (1_002_000_000_000, 1_005_000_000_000));
    assert_eq!((caution.peak.m(), caution.min_margin.m()), (1.4 * RNP_M, RNP_M - 1.4 * RNP_M));
}

/// `NAVBOUND_WRITE=1 cargo test -p navbound-core --test all write_the_state` writes the file of the version of today.
#[test]
fn write_the_state_of_today() {
    if std::env::var_os("NAVBOUND_WRITE").is_none() {
        return;
    }
    let bytes = some_state().to_bytes();
    let lines: Vec<String> = bytes.chunks(32).map(|line| line.iter().map(|b| format!("{b:02x}")).collect()).collect();
    let name = format!("../../vectors/snapshots/rnp-monitor-{}.hex", bytes[0]);
    std::fs::write(std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(name), lines.join("\n") + "\n").unwrap();
}
