#![allow(clippy::print_stderr)] // A test that is skipped says so.
use super::*;
use crate::receiver;
use proptest::prelude::*;
use std::fs;
use std::path::{Path, PathBuf};

/// Frames and damage as text, so that they outlive the bytes.
fn named(result: &Result<Frame<'_>, Damage>) -> String {
    match result {
        Ok(frame) => format!("{frame:?}"),
        Err(damage) => damage.reason.to_owned(),
    }
}

fn cut_by(protocol: Protocol, bytes: &[u8], mut next: impl FnMut() -> usize) -> Vec<String> {
    let (mut framer, mut seen, mut at) = (Framer::new(protocol), Vec::new(), 0);
    while at < bytes.len() {
        let end = (at + next().max(1)).min(bytes.len());
        framer.push(&bytes[at..end], &mut |item| seen.push(named(&item)));
        assert!(framer.rest().0.len() <= LONGEST_FRAME, "{} bytes are kept", framer.rest().0.len());
        at = end;
    }
    framer.flush(&mut |item| seen.push(named(&item)));
    assert!(framer.rest().0.is_empty());
    seen
}

/// The same by the search of whole bytes, without a framer.
fn at_once(bytes: &[u8]) -> Vec<String> {
    let (mut seen, mut at) = (Vec::new(), 0);
    while at < bytes.len() {
        match look(&bytes[at..], Among::Receivers, true) {
            Look::Nothing | Look::NeedMore => at += 1,
            Look::Frame { length, frame } => {
                seen.push(named(&Ok(frame)));
                at += length;
            }
            Look::Damaged(damage) => {
                seen.push(damage.reason.to_owned());
                at += 2;
            }
        }
    }
    seen
}

/// A small linear generator: pieces of 1 to 2000 bytes, short ones often.
fn pieces(seed: u64) -> impl FnMut() -> usize {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let draw = (state >> 33) as usize;
        if draw.is_multiple_of(3) { 1 + draw / 3 % 7 } else { 1 + draw / 3 % 2000 }
    }
}

fn logs() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/rxlogs");
    let Ok(folders) = fs::read_dir(&folder) else {
        eprintln!("SKIPPED ALOUD: no receiver logs at {}", folder.display());
        return Vec::new();
    };
    let files = folders.flatten().flat_map(|f| fs::read_dir(f.path()).into_iter().flatten().flatten().map(|e| e.path()));
    files.filter(|path| path.extension().is_some_and(|e| e == "log" || e == "ubx" || e == "gps")).collect()
}

/// Cuttings of a log: `NAVBOUND_CUTTINGS` for more of them.
fn n_cuttings() -> u64 {
    std::env::var("NAVBOUND_CUTTINGS").ok().and_then(|text| text.parse().ok()).unwrap_or(6)
}

/// A log with a bit turned in every thousandth byte.
fn damaged(bytes: &[u8]) -> Vec<u8> {
    bytes.iter().enumerate().map(|(k, byte)| if k % 1000 == 500 { byte ^ 1 } else { *byte }).collect()
}

#[test]
fn chunks_of_every_log_give_the_frames_of_the_whole() {
    let (mut n_frames, mut n_damaged) = (0, 0);
    for log in logs() {
        let whole = fs::read(&log).unwrap();
        for bytes in [damaged(&whole), whole] {
            let expected = at_once(&bytes);
            n_frames += expected.len();
            n_damaged += expected.iter().filter(|text| text.contains("checksum") || text.contains("CRC")).count();
            for seed in 0..n_cuttings() {
                assert_eq!(cut_by(Protocol::Receiver, &bytes, pieces(seed)), expected, "{} cut by {seed}", log.display());
            }
        }
    }
    assert!(logs().is_empty() || (n_frames > 10_000 && n_damaged > 100), "{n_frames} frames, {n_damaged} damaged");
    eprintln!("{n_frames} frames, of which {n_damaged} damaged");
}

#[test]
fn the_reader_of_files_counts_the_frames_of_the_stream() {
    for log in logs() {
        let bytes = fs::read(&log).unwrap();
        let Ok(read) = receiver::read(&bytes) else { continue };
        let by_file = read.observations.refused.iter().filter(|refusal| refusal.field == "frame").count();
        let seen = cut_by(Protocol::Receiver, &bytes, || 100);
        let by_stream = seen.iter().filter(|text| text.contains("UBX frame") || text.contains("SBF block")).count();
        assert_eq!(by_stream, by_file, "{}", log.display());
    }
}

#[test]
fn an_unfinished_frame_is_kept_and_is_damage_only_at_the_end() {
    let frame = [0xb5, 0x62, 0x05, 0x01, 2, 0, 0x06, 0x01, 0x0f, 0x38];
    for end in 1..frame.len() {
        let (mut framer, mut seen) = (Framer::new(Protocol::Receiver), Vec::new());
        framer.push(&frame[..end], &mut |item| seen.push(named(&item)));
        assert!(seen.is_empty(), "{end} bytes");
        framer.push(&frame[end..], &mut |item| seen.push(named(&item)));
        assert_eq!(seen.len(), 1, "{end} bytes");
        assert!(seen[0].contains("Ubx"), "{seen:?}");
        let mut cut = Framer::new(Protocol::Receiver);
        let mut damage = Vec::new();
        cut.push(&frame[..end], &mut |_| ());
        cut.flush(&mut |item| damage.push(named(&item)));
        assert_eq!(damage.len(), usize::from(end >= 6), "{end} bytes");
    }
}

#[test]
fn a_length_that_never_fills_is_abandoned() {
    // SBF may state 65,535 bytes; a false sync must not hold up more than the longest frame.
    let mut bytes = b"$@\0\0\xa7\x0f\xfc\xff".to_vec();
    bytes.extend(b"$GPZDA,001924.00,13,04,2019,00,00*64\r\n");
    let mut seen = Vec::new();
    Framer::new(Protocol::Receiver).push(&bytes, &mut |item| seen.push(named(&item)));
    assert_eq!(seen.len(), 1, "{seen:?}");
}

#[test]
fn lines_may_end_anyhow_and_a_long_one_is_refused_once() {
    let long = [b"x".repeat(40_000), b"\n{\"b\":2}\n".to_vec()].concat();
    let text = [b"{\"a\":1}\r\n\n".to_vec(), long, b"last".to_vec()].concat();
    for seed in 0..50 {
        let seen = cut_by(Protocol::Lines, &text, pieces(seed));
        assert_eq!(seen.len(), 4, "{seen:?}");
        assert_eq!(seen[1], "a line longer than 16384 bytes");
        assert!(seen[3].contains("108, 97, 115, 116"));
    }
}

/// CRC-32 bit by bit, by the manual's own program.
fn slow_crc32(bytes: &[u8]) -> u32 {
    bytes
        .iter()
        .fold(0, |crc, byte| (0..8).fold(crc ^ u32::from(*byte), |c: u32, _| if c & 1 == 1 { c >> 1 ^ 0xEDB8_8320 } else { c >> 1 }))
}

fn novatel_binary(body: &[u8]) -> Vec<u8> {
    let mut frame = vec![0; 28];
    frame[..6].copy_from_slice(&[0xaa, 0x44, 0x12, 28, 42, 0]);
    frame[8] = body.len() as u8;
    frame.extend(body);
    let crc = slow_crc32(&frame);
    frame.extend(crc.to_le_bytes());
    frame
}

fn novatel_text(body: &str) -> Vec<u8> {
    format!("#{body}*{:08x}\r\n", slow_crc32(body.as_bytes())).into_bytes()
}

#[test]
fn novatel_logs_are_frames_and_a_turned_bit_is_damage() {
    for whole in [novatel_binary(b"some body"), novatel_text("BESTPOSA,COM1,0;SOL_COMPUTED,1.0")] {
        assert!(at_once(&whole)[0].contains("Novatel"), "{:?}", at_once(&whole));
        let mut damaged = whole.clone();
        damaged[15] ^= 1;
        assert_eq!(at_once(&damaged).len(), 1);
        assert!(at_once(&damaged)[0].contains("CRC"));
    }
}

#[test]
fn a_sentence_that_breaks_off_is_damage_and_two_capitals_are_not() {
    let seen = |bytes: &[u8]| at_once(bytes);
    assert_eq!(seen(b"$GPGGA,1,2\r\n"), ["a sentence breaks off before its checksum"]);
    assert_eq!(seen(b"$GPGGA,1\x80,2*00\r\n"), ["the checksum of a sentence is wrong"]);
    // A text in another alphabet is a sentence where its checksum is right.
    assert!(seen(b"$GNTXT,\x80*FD\r\n")[0].contains("Nmea"));
    assert!(seen(b"$AB\x80\x01 $GP\r\n").is_empty());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 500, ..ProptestConfig::default() })]

    #[test]
    fn chunks_of_hostile_bytes_give_the_frames_of_the_whole(
        parts in prop::collection::vec(prop_oneof![
            Just(vec![0xb5, 0x62]), Just(b"$@".to_vec()), Just(b"$GPGGA,".to_vec()), Just(b"*00".to_vec()), Just(b"\n".to_vec()),
            Just(vec![0xb5, 0x62, 0x05, 0x01, 2, 0, 0x06, 0x01, 0x0f, 0x38]),
            Just(b"$GPZDA,001924.00,13,04,2019,00,00*64\r\n".to_vec()),
            Just(vec![0xaa, 0x44]), Just(vec![0xaa, 0x44, 0x12, 0x1c, 0x2a, 0, 0, 0, 4, 0]), Just(novatel_binary(b"body")),
            Just(b"#BESTPOSA,".to_vec()), Just(novatel_text("BESTPOSA,COM1;x")), Just(b"*0123abcd".to_vec()),
            prop::collection::vec(any::<u8>(), 0..40),
        ], 0..30),
        seed: u64,
    ) {
        let bytes = parts.concat();
        prop_assert_eq!(cut_by(Protocol::Receiver, &bytes, pieces(seed)), at_once(&bytes));
        prop_assert_eq!(cut_by(Protocol::Lines, &bytes, pieces(seed)), cut_by(Protocol::Lines, &bytes, || usize::MAX / 2));
    }
}

/// Of what is left of a sentence and the next one behind it the checksum of the next is right for both once in 256: every byte is tried.
#[test]
fn a_sentence_that_was_cut_does_not_swallow_the_next_one() {
    let next = b"GPGGA,132821.80,4134.5,N,09345.0,W,2,09,1.0,278.8,M,-31.4,M,,";
    let sum = next.iter().fold(0_u8, |sum, byte| sum ^ byte);
    for byte in 0..=255_u8 {
        let left = [b"$GPRMC,132821.70,A,", [byte].as_slice(), b"\0\0\0"].concat();
        let log = [left.as_slice(), b"$", next, format!("*{sum:02X}\r\n").as_bytes()].concat();
        let seen = at_once(&log);
        assert_eq!(seen.last(), Some(&format!("{:?}", Frame::Nmea(next))), "{byte}");
        assert!(seen[0].contains("breaks off") || seen[0].contains("checksum"), "{byte}: {seen:?}");
        assert_eq!(cut_by(Protocol::Receiver, &log, || 1), seen, "{byte}");
        // Its begin is lost too: what is left of both is no sentence, whatever the checksum.
        let log = [left.as_slice(), next, format!("*{sum:02X}\r\n").as_bytes()].concat();
        let seen = at_once(&log);
        assert!(!seen.is_empty() && seen.iter().all(|each| !each.contains("Nmea(")), "{byte}: {seen:?}");
    }
}

/// Messages of three lengths, whose bytes are escapes now and then.
fn beast_stream() -> Vec<u8> {
    let mut bytes = vec![0x1a, 0x1a, 0x33, 7];
    for k in 0..300_u32 {
        let length = [2, 7, 14][k as usize % 3];
        let mut message = [0; 14];
        message[..length]
            .iter_mut()
            .enumerate()
            .for_each(|(i, byte)| *byte = if (k as usize + i).is_multiple_of(5) { 0x1a } else { k as u8 });
        bytes.extend(beast::frame(&Beast { counter: [0x1a, 0, 0, 1, k as u8, 0x1a], message, length }));
        match k % 50 {
            // An identity of a receiver, a frame that was cut, an unknown kind, and bytes of nothing.
            10 => bytes.extend([0x1a, 0xe3, 1, 2, 3, 4, 5, 6, 7, 8]),
            20 => bytes.extend([0x1a, b'3', 1, 2, 3]),
            30 => bytes.extend(beast::DAMAGED),
            40 => bytes.extend([1, 2, 3]),
            _ => {}
        }
    }
    bytes
}

#[test]
fn chunks_of_beast_give_the_frames_of_the_whole() {
    let bytes = beast_stream();
    let whole = cut_by(Protocol::Beast, &bytes, || usize::MAX / 2);
    let damaged = whole.iter().filter(|text| !text.starts_with("Beast")).count();
    assert_eq!((whole.len(), damaged), (312, 12), "six frames that were cut, and six of no kind");
    for seed in 0..20 {
        assert_eq!(cut_by(Protocol::Beast, &bytes, pieces(seed)), whole, "cut by {seed}");
    }
    assert_eq!(cut_by(Protocol::Beast, &bytes, || 1), whole);
    // A frame whose end never comes is damage, once.
    assert_eq!(cut_by(Protocol::Beast, &[0x1a, b'3', 1, 2], || 1), ["the stream ends within a Beast frame"]);
}

proptest! {
    #[test]
    fn any_bytes_are_cut_the_same_however_they_arrive(bytes in proptest::collection::vec(prop_oneof![Just(0x1a_u8), Just(b'3'), any::<u8>()], 0..400), seed in 0_u64..1000) {
        prop_assert_eq!(cut_by(Protocol::Beast, &bytes, pieces(seed)), cut_by(Protocol::Beast, &bytes, || usize::MAX / 2));
    }
}
