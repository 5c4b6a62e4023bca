//! The judge of one aircraft as bytes: what is read goes on as what was written, and nothing else is read.
#![allow(clippy::unwrap_used, reason = "a helper of tests may stop at the first surprise, too")]

use crate::common;
use navbound_core::frame::Covariance;
use navbound_core::judge::{Judge, Sample, Settings};
use navbound_core::quantity::encoding::{BadBytes, crc32c};
use navbound_core::quantity::{GpsTime, Metres, Radians, Status};
use proptest::prelude::*;

fn settings(method: &str, n_levels: usize, with_levels: bool) -> Settings {
    common::settings(method, &[0.1, 0.3, 1.0, 2.0][..n_levels], 3.0, with_levels)
}

fn maybe(value: impl Strategy<Value = f64> + 'static) -> impl Strategy<Value = Option<f64>> {
    prop_oneof![9 => value.prop_map(Some), 1 => Just(None)]
}

prop_compose! {
    /// An epoch and how much later than the one before it comes \[ms\].
    fn happening()(
        later_ms in prop_oneof![10 => Just(1000_i64), 1 => Just(0), 1 => Just(7000), 1 => Just(-1000), 1 => Just(-90_000)],
        status in prop_oneof![8 => Just(Status::Ok), 1 => Just(Status::Degraded), 1 => Just(Status::NotAvailable)],
        fte_m in maybe(-700.0..700.0_f64),
        variance_m2 in maybe(-10.0..40_000.0_f64),
        rnp_m in prop_oneof![8 => Just(555.6), 1 => Just(f64::NAN), 1 => Just(100.0)],
        hpl_m in prop_oneof![4 => Just(None), 1 => (0.0..900.0_f64).prop_map(Some)],
    ) -> (i64, Sample) {
        let covariance = variance_m2.map(|v| Covariance::from_upper([v, 0.0, 100.0, f64::NAN, f64::NAN, f64::NAN]));
        (later_ms, Sample {
            time: GpsTime::default(),
            status,
            course: Some(Radians::new(0.3)),
            path_angle: None,
            fte_m,
            fte_v_m: None,
            covariance,
            nse_en_m: Some([3.0, 4.0]),
            nse_u_m: None,
            rnp: Some(Metres::new(rnp_m)),
            hpl: hpl_m.map(Metres::new),
        })
    }
}

/// What a judge says of it, in text: NaN and the sign of a zero are seen.
fn happens(judge: &mut Judge, now_ms: &mut i64, (later_ms, sample): (i64, Sample)) -> String {
    *now_ms += later_ms;
    format!("{:?}", judge.step(&Sample { time: GpsTime::from_nanoseconds(*now_ms * 1_000_000), ..sample }))
}

proptest! {
    #[test]
    fn a_judge_that_was_read_is_the_one_that_was_written_and_takes_the_same_steps(
        method in prop_oneof![Just("tse-exact"), Just("anp-circle")],
        n_levels in 0..=4_usize,
        with_levels in any::<bool>(),
        happenings in prop::collection::vec(happening(), 0..60),
        cut in any::<prop::sample::Index>(),
    ) {
        let mut judge = Judge::new(settings(method, n_levels, with_levels)).unwrap();
        let mut now_ms = 1_000_000;
        let cut = cut.index(happenings.len() + 1);
        happenings[..cut].iter().for_each(|what| { happens(&mut judge, &mut now_ms, *what); });
        let bytes = judge.to_bytes();
        let mut again = Judge::from_bytes(&bytes).unwrap();
        prop_assert_eq!(bytes, again.to_bytes());
        prop_assert_eq!(format!("{judge:?}"), format!("{again:?}"));
        let mut same_ms = now_ms;
        for what in &happenings[cut..] {
            prop_assert_eq!(happens(&mut judge, &mut now_ms, *what), happens(&mut again, &mut same_ms, *what));
            prop_assert_eq!(judge.to_bytes(), again.to_bytes());
        }
    }

    /// Bytes that somebody has made up, with checksums that fit: refused, or a judge that is written as it was read.
    #[test]
    fn bytes_with_a_right_checksum_are_a_state_or_refused(changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4)) {
        let mut bytes = Judge::new(settings("tse-exact", 4, true)).unwrap().to_bytes();
        for (place, byte) in changes {
            bytes[place.index(Judge::BYTES - 4)] = byte;
        }
        let sealed = seal(bytes);
        if let Ok(judge) = Judge::from_bytes(&sealed) {
            prop_assert_eq!(judge.to_bytes(), sealed);
        }
    }
}

fn seal(mut bytes: [u8; Judge::BYTES]) -> [u8; Judge::BYTES] {
    let crc = crc32c(&bytes[..Judge::BYTES - 4]);
    bytes[Judge::BYTES - 4..].copy_from_slice(&crc.to_le_bytes());
    bytes
}

#[test]
fn every_damaged_bit_and_every_other_length_is_refused() {
    let bytes = Judge::new(settings("tse-exact", 4, false)).unwrap().to_bytes();
    for bit in 0..8 * bytes.len() {
        let mut damaged = bytes;
        damaged[bit / 8] ^= 1 << (bit % 8);
        assert_eq!(Judge::from_bytes(&damaged).err(), Some(BadBytes::Checksum), "bit {bit}");
    }
    for length in 0..bytes.len() {
        assert_eq!(Judge::from_bytes(&bytes[..length]).err(), Some(BadBytes::Length));
    }
}

#[test]
fn a_method_that_may_not_alert_another_version_and_a_damaged_monitor_are_refused_by_name() {
    let bytes = Judge::new(settings("tse-exact", 4, false)).unwrap().to_bytes();
    let with = |place: usize, new: &[u8]| {
        let mut changed = bytes;
        changed[place..place + new.len()].copy_from_slice(new);
        Judge::from_bytes(&seal(changed)).err()
    };
    assert_eq!(with(1, b"tse-ltem-as-printed"), Some(BadBytes::Value("method")));
    assert_eq!(with(0, &[2]), Some(BadBytes::Version(2)));
    assert_eq!(with(33, &2.0_f64.to_le_bytes()), Some(BadBytes::Value("risk_accuracy")));
    assert_eq!(with(49, &[13]), Some(BadBytes::Value("levels")));
    // A padding that is not zero: one state has one form.
    assert_eq!(with(30, &[1]), Some(BadBytes::Value("an absent field")));
    // The monitor has a checksum of its own.
    assert_eq!(with(200, &[bytes[200] ^ 1]), Some(BadBytes::Checksum));
}
