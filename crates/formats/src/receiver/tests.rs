use super::*;
use crate::stream::crc16;
use navbound_core::quantity::GpsTime;
use navbound_core::signal::{Constellation, SatelliteId};
use proptest::prelude::*;

const WEEK_NS: i64 = 604_800_000_000_000;

fn ubx(id: u8, payload: &[u8]) -> Vec<u8> {
    let mut body = vec![0x02, id];
    body.extend((payload.len() as u16).to_le_bytes());
    body.extend(payload);
    let (mut a, mut b) = (0_u8, 0_u8);
    for byte in &body {
        a = a.wrapping_add(*byte);
        b = b.wrapping_add(a);
    }
    [&[0xb5, 0x62], body.as_slice(), &[a, b]].concat()
}

fn sbf(block: u16, body: &[u8]) -> Vec<u8> {
    let mut checked = block.to_le_bytes().to_vec();
    checked.extend((body.len() as u16 + 8).to_le_bytes());
    checked.extend(body);
    [b"$@", crc16(&checked).to_le_bytes().as_slice(), &checked].concat()
}

/// RXM-RAWX of week 2361; each measurement: system, satellite, signal, pseudorange, time of lock, status.
fn rawx(tow_s: f64, measurements: &[(u8, u8, u8, f64, u16, u8)]) -> Vec<u8> {
    let mut p = tow_s.to_le_bytes().to_vec();
    p.extend(2361_u16.to_le_bytes());
    p.extend([18, measurements.len() as u8, 1, 1, 0, 0]);
    for (system, satellite, signal, range, lock, status) in measurements {
        p.extend(range.to_le_bytes());
        p.extend((range / 0.19).to_le_bytes());
        p.extend((-1234.5_f32).to_le_bytes());
        p.extend([*system, *satellite, *signal, 7]);
        p.extend(lock.to_le_bytes());
        p.extend([45, 2, 1, 3, *status, 0]);
    }
    ubx(0x15, &p)
}

fn sfrbx(system: u8, satellite: u8, signal: u8, words: &[u32]) -> Vec<u8> {
    let mut p = vec![system, satellite, signal, 0, words.len() as u8, 0, 2, 0];
    p.extend(words.iter().flat_map(|w| w.to_le_bytes()));
    ubx(0x13, &p)
}

fn gps(number: u8) -> SatelliteId {
    SatelliteId { constellation: Constellation::Gps, number }
}

/// MSAS, PRN 137, 2025-02-15 17:00:01 (cssrlib-data, MIT).
const MSAS: [u32; 8] = [0xC60D_FFF8, 0x001F_FDFF, 0xC005_FFFF, 0xFDFF_FFFF, 0xFFC0_01FF, 0xDFFE_E3BA, 0xBA3A_EA7B, 0xAFA3_2580];

/// Versions 0 and 1 are those of the interface descriptions; 0 has one signal a satellite.
#[test]
fn a_version_of_measurements_that_is_not_known_is_refused_and_counted() {
    let of_version = |version: u8, tow_s: f64| {
        let mut p = rawx(tow_s, &[(0, 5, 3, 2.2e7, 1, 7)])[6..].to_vec();
        p.truncate(p.len() - 2);
        p[13] = version;
        ubx(0x15, &p)
    };
    let r = read(&[of_version(2, 1.0), of_version(1, 2.0), of_version(9, 3.0), of_version(0, 4.0)].concat()).unwrap().observations;
    assert_eq!(r.n_epochs(), 2);
    let reasons: Vec<&str> = r.refused.iter().map(|refusal| refusal.reason.as_str()).collect();
    let sentence = |version: u8| format!("version {version} of RXM-RAWX, of which 0 and 1 are read");
    assert!(reasons.len() == 2 && reasons[0].contains(&sentence(2)) && reasons[1].contains(&sentence(9)), "{reasons:?}");
    // The second signal of GPS in version 1; the only one in version 0.
    assert_eq!(r.codes[Constellation::Gps.index()].iter().filter(|code| code[0] == b'C').count(), 2);
}

#[test]
fn measurements_become_a_table() {
    let first = rawx(456_000.998, &[(0, 5, 0, 2.2e7, 64_000, 7), (0, 5, 3, 2.2e7 + 5.0, 500, 3), (2, 11, 0, 2.5e7, 0, 5)]);
    let second = rawx(456_001.998, &[(0, 5, 0, 2.21e7, 63_000, 7), (5, 1, 0, 4e7, 1, 7), (0, 6, 0, f64::NAN, 1, 1)]);
    let r = read(&[b"$GNGGA,noise*00\r\n", first.as_slice(), b"\xb5", &second].concat()).unwrap();
    let o = &r.observations;
    // 0.998 s has no exact double, but a nearest nanosecond.
    assert_eq!(o.time[0].nanoseconds(), 2361 * WEEK_NS + 456_000_998_000_000);
    assert_eq!(o.codes[0], [*b"C1C", *b"L1C", *b"D1C", *b"S1C", *b"C2L", *b"L2L", *b"D2L", *b"S2L"]);
    assert_eq!((o.satellites(0), o.satellites(1)), (0..2, 2..4));
    assert_eq!(o.values(0)[..4], [2.2e7, 2.2e7 / 0.19, -1234.5, 45.0]);
    assert_eq!(o.values(0)[4], 2.2e7 + 5.0);
    // Half a cycle not resolved on L2; no time of lock and no phase for Galileo; a shorter time of lock at the second epoch.
    let galileo = o.value_range(1).start;
    assert_eq!((o.indicator[1], o.indicator[5], o.indicator[galileo + 1]), (0, 0x20, 0x10));
    assert!(o.value[galileo + 1].is_nan() && o.value[galileo] == 2.5e7);
    assert_eq!(o.indicator[o.value_range(2).start + 1], 0x10);
    assert_eq!((o.satellite[3], o.skipped["satellites of J"]), (gps(6), 1));
    assert_eq!((o.n_refused, o.refused[0].field.as_str()), (1, "prMes"));
}

#[test]
fn a_damaged_frame_is_refused_with_its_place_and_the_next_is_read() {
    let mut damaged = rawx(1.0, &[(0, 5, 0, 2.2e7, 1, 7)]);
    damaged[20] ^= 1;
    let whole = rawx(2.0, &[(0, 5, 0, 2.2e7, 1, 7)]);
    let short = ubx(0x15, &whole[6..40]);
    let r = read(&[damaged.as_slice(), &whole, &short].concat()).unwrap().observations;
    assert_eq!((r.n_epochs(), r.n_refused), (1, 2));
    assert_eq!((r.refused[0].line, r.refused[0].text.as_str()), (1, "at byte 0"));
    assert!(r.refused[0].reason.contains("checksum") && r.refused[1].reason.contains("shorter"), "{:?}", r.refused);
    assert!(!is_raw(b"\xb5\x62 no frame") && read(b"G01 text").is_err());
    assert!(read_observations(&sfrbx(1, 137, 0, &MSAS)).unwrap_err().reason.contains("without measurements"));
}

#[test]
fn sbas_messages_are_dated_by_the_measurements_before_them() {
    let log = [sfrbx(1, 137, 0, &MSAS), rawx(579_600.998, &[]), sfrbx(1, 137, 0, &MSAS)].concat();
    let r = read(&log).unwrap();
    assert_eq!(r.messages.len(), 1);
    assert_eq!((r.messages[0].prn, r.messages[0].end), (137, GpsTime::from_nanoseconds(2361 * WEEK_NS + 579_601_000_000_000)));
    assert_eq!((r.messages[0].block.message_type(), r.observations.skipped["subframes before the first epoch"]), (3, 1));
    let mut wrong = MSAS;
    wrong[3] ^= 4;
    let r = read(&[rawx(1.0, &[]), sfrbx(1, 137, 0, &wrong)].concat()).unwrap();
    assert_eq!((r.messages.len(), r.observations.n_refused), (0, 1));
    // The same bits in a block of another maker, with the second in which they came.
    let mut body = [579_601_000_u32.to_le_bytes().as_slice(), &2361_u16.to_le_bytes(), &[137, 1, 0, 0, 0, 0]].concat();
    body.extend(MSAS.iter().flat_map(|w| w.to_le_bytes()));
    let again = read(&sbf(4020, &body)).unwrap();
    assert_eq!(again.messages[0].block.bytes()[..4], [0xC6, 0x0D, 0xFF, 0xF8]);
    assert_eq!(again.messages[0].end, GpsTime::from_nanoseconds(2361 * WEEK_NS + 579_601_000_000_000));
    assert_eq!(read(&sbf(4020, &[&body[..7], &[0], &body[8..]].concat())).unwrap().observations.refused[0].field, "CRCPassed");
}

/// Fields by the block's description, values chosen here.
#[test]
fn septentrio_measurements_are_put_together_from_their_parts() {
    let mut body = [456_000_000_u32.to_le_bytes().as_slice(), &2361_u16.to_le_bytes(), &[2, 20, 12, 0, 0, 0]].concat();
    // Satellite 5, L1 C/A: code 5 * 2^32 + 1000 mm, Doppler -1234.5 Hz, carrier -65536 + 500 thousandths, 30 + 10 dB-Hz.
    body.extend([1, 0, 5, 5]);
    body.extend(1000_u32.to_le_bytes());
    body.extend((-12_345_000_i32).to_le_bytes());
    body.extend(500_u16.to_le_bytes());
    body.extend([0xff, 120, 10, 0, 0b100, 1]);
    // L2C: 2^16 + 200 mm less, carrier 250 thousandths more, Doppler 3 * 6.5536 + 0.001 Hz more.
    body.extend([3, 5, 100, 0b0001_1111, 0, 0]);
    body.extend([(65_336_u16).to_le_bytes(), 250_u16.to_le_bytes(), 10_u16.to_le_bytes()].concat());
    // A satellite of Japan.
    body.extend([2, 6, 183, 0]);
    body.extend([0; 16]);
    let r = read(&sbf(4027, &body)).unwrap().observations;
    assert_eq!((r.n_epochs(), r.n_refused, r.satellite[0]), (1, 0, gps(5)), "{:?}", r.refused);
    let range = 5.0 * 4_294_967.296 + 1.0;
    let [l1, l2] = [1575.42e6_f64, 1227.6e6].map(|f| f / 299_792_458.0);
    let expected = [
        range,
        range * l1 - 65.036,
        -1234.5,
        40.0,
        range - 0.2,
        (range - 0.2) * l2 + 0.25,
        -1234.5 * 1227.6 / 1575.42 + 19.6608 + 0.001,
        35.0,
    ];
    for (value, part) in r.values(0).iter().zip(expected) {
        // Doubles of 1e8 cycles: 1.5e-8 each, a few operations.
        assert!((value - part).abs() < 1e-7, "{value} {part}");
    }
    assert_eq!((r.indicator[1], r.skipped["satellites or signals of other systems"]), (0x20, 1));
}

/// Every word's parity by the equations of IS-GPS-200, table 20-XIV, as indices of the data bits; turned by D30* as u-blox hands words on.
fn with_parity(data: &[u32; 10]) -> [u32; 10] {
    const BITS: [&[u32]; 6] = [
        &[1, 2, 3, 5, 6, 10, 11, 12, 13, 14, 17, 18, 20, 23],
        &[2, 3, 4, 6, 7, 11, 12, 13, 14, 15, 18, 19, 21, 24],
        &[1, 3, 4, 5, 7, 8, 12, 13, 14, 15, 16, 19, 20, 22],
        &[2, 4, 5, 6, 8, 9, 13, 14, 15, 16, 17, 20, 21, 23],
        &[1, 3, 5, 6, 7, 9, 10, 14, 15, 16, 17, 18, 21, 22, 24],
        &[3, 5, 6, 8, 9, 10, 11, 13, 15, 19, 22, 23, 24],
    ];
    // Which of D29* and D30* each sums.
    const BEFORE: [bool; 6] = [true, false, true, false, false, true];
    let (mut d29, mut d30) = (0, 0);
    data.map(|word| {
        let bit = |k: &u32| word >> (24 - k) & 1;
        let sent = BITS
            .iter()
            .zip(BEFORE)
            .fold(0, |p, (bits, first)| p << 1 | (bits.iter().map(bit).sum::<u32>() + if first { d29 } else { d30 }) & 1);
        let handed = word << 6 | sent ^ (if d30 == 1 { 0x3f } else { 0 });
        (d29, d30) = (sent >> 1 & 1, sent & 1);
        handed
    })
}

#[test]
fn gps_subframes_make_an_orbit_once() {
    // Subframes at 12:00:06 and after of the day, issue 0x34 in all; e = 0x0D000000 2^-33, sqrt(A) = 0xA10D0000 2^-19, toe = toc = 16 * 4500 s.
    let how = |number: u32| (12_000 + number) << 7 | number << 2;
    let mut one = [0x8B_0000, how(1), 0, 0, 0, 0, 0xFF, 0x34_1194, 0x00_FFF0, 0x00_1000 << 2];
    one[2] = 313 << 14 | 1 << 12 | 2 << 8;
    let two = [0x8B_0000, how(2), 0x34_0000 | 0xFF80, 0x11_2233, 0x44_5566, 0x77_880D, 0, 0x00_05A1, 0x0D_0000, 0x11_9400];
    let three = [0x8B_0000, how(3), 0x00_1122, 0x33_4455, 0x66_7728, 0x00_0000, 0x10_0010, 0x20_3040, 0xFF_F000, 0x34_0010];
    let subframes = [one, two, three].map(|s| sfrbx(0, 7, 0, &with_parity(&s)));
    let epoch = rawx(72_000.0, &[]);
    let log = [epoch.as_slice(), &subframes.concat(), &subframes.concat()].concat();
    let r = read(&log).unwrap();
    assert_eq!(r.observations.n_refused, 0, "{:?}", r.observations.refused);
    let [e] = r.navigation.ephemerides[..] else { panic!("{:?}", r.navigation.ephemerides) };
    assert_eq!((e.satellite, e.issue_orbit, e.issue_clock), (gps(7), 0x34, 0x34));
    assert_eq!((e.orbit_time.nanoseconds() - 2361 * WEEK_NS, e.clock_time), (72_000_000_000_000, e.orbit_time));
    assert_eq!((e.sqrt_a, e.eccentricity), (f64::from(0xA10D_0000_u32) / 524_288.0, f64::from(0x0D00_0000) / 2_f64.powi(33)));
    // Index 2 is 4 m; TGD -1 in units of 2^-31 s; crs -128 / 32 m.
    assert_eq!((e.accuracy_m, e.group_delay_s[0], e.radius_harmonics[1]), (4.0, -1.0 / 2_f64.powi(31), -4.0));
    // A word whose data was changed has the wrong parity; the orbit lacks a part.
    let mut wrong = with_parity(&two);
    wrong[4] ^= 1 << 20;
    let log = [epoch, subframes[0].clone(), sfrbx(0, 7, 0, &wrong), subframes[2].clone()].concat();
    let r = read(&log).unwrap();
    assert_eq!((r.navigation.ephemerides.len(), r.observations.n_refused), (0, 1));
}

proptest! {
    #[test]
    fn no_bytes_bring_the_reader_down(at in 0_usize..300, byte in any::<u8>(), cut in 0_usize..300, tail in proptest::collection::vec(any::<u8>(), 0..200), id in 0x10_u8..0x16) {
        let log = [rawx(1.0, &[(0, 5, 0, 2.2e7, 1, 7), (6, 3, 2, 2e7, 1, 7)]), sfrbx(1, 137, 0, &MSAS), ubx(id, &tail), sbf(4027, &tail)].concat();
        let mut changed = log.clone();
        let n = changed.len();
        changed[at % n] = byte;
        let _ = read(&changed);
        let _ = read(&log[..cut.min(n)]);
        let _ = read(&[log.as_slice(), &tail].concat());
    }
}
