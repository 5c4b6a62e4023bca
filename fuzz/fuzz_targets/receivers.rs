//! Raw logs: no panic, the table is whole, orbits are orbits. Checksums are made right, so that what stands behind them is reached.
#![no_main]

use libfuzzer_sys::fuzz_target;
use navbound_core::geometry::broadcast::state;
use navbound_core::signal::sbas::crc24q;
use navbound_formats::receiver::{is_raw, read};
use navbound_fuzz::within_budget;

const UBX: [[u8; 2]; 4] = [[0x02, 0x15], [0x02, 0x13], [0x02, 0x10], [0x02, 0x11]];
const SBF: [u16; 4] = [4027, 4020, 4017, 4023];

fuzz_target!(|bytes: &[u8]| {
    let Some((form, rest)) = bytes.split_first() else { return };
    let log = if *form == b'r' { rest.to_vec() } else { frames(rest) };
    let found = within_budget(&log, read);
    assert_eq!(found.is_ok(), is_raw(&log));
    let Ok(r) = found else { return };
    let o = &r.observations;
    for epoch in 0..o.n_epochs() {
        for k in o.satellites(epoch) {
            assert_eq!(o.values(k).len(), o.codes[o.satellite[k].constellation.index()].len());
        }
    }
    for e in &r.navigation.ephemerides {
        assert!(state(e, e.orbit_time).is_ok());
    }
});

/// Records of a kind, a length and a payload as frames.
fn frames(mut rest: &[u8]) -> Vec<u8> {
    let mut log = Vec::new();
    while let [kind, low, high, tail @ ..] = rest {
        let length = usize::from(u16::from_le_bytes([*low, *high & 0x0f])).min(tail.len());
        let (payload, next) = tail.split_at(length);
        rest = next;
        let index = usize::from(*kind % 4);
        if kind & 4 == 0 { ubx(UBX[index], payload, &mut log) } else { sbf(SBF[index], payload, &mut log) }
    }
    log
}

fn ubx(kind: [u8; 2], payload: &[u8], log: &mut Vec<u8>) {
    let mut payload = payload.to_vec();
    if kind == UBX[1] && payload.first() == Some(&2) {
        galileo(payload.get_mut(8..40), 128);
    }
    let mut body = kind.to_vec();
    body.extend((payload.len() as u16).to_le_bytes());
    body.extend(payload);
    let sum = body.iter().fold((0_u8, 0_u8), |(a, b), byte| (a.wrapping_add(*byte), b.wrapping_add(a.wrapping_add(*byte))));
    log.extend([0xb5, 0x62]);
    log.extend(body);
    log.extend([sum.0, sum.1]);
}

fn sbf(block: u16, payload: &[u8], log: &mut Vec<u8>) {
    let mut payload = payload.to_vec();
    payload.resize(payload.len().next_multiple_of(4), 0);
    if block == SBF[3] {
        galileo(payload.get_mut(12..44), 114);
    }
    let mut body = block.to_le_bytes().to_vec();
    body.extend((payload.len() as u16 + 8).to_le_bytes());
    body.extend(payload);
    let crc = body
        .iter()
        .fold(0_u16, |crc, byte| (0..8).fold(crc ^ u16::from(*byte) << 8, |c, _| if c & 0x8000 == 0 { c << 1 } else { c << 1 ^ 0x1021 }));
    log.extend(b"$@");
    log.extend(crc.to_le_bytes());
    log.extend(body);
}

/// Make eight little-endian words the two pages of a word: even, odd, its check sum right.
fn galileo(words: Option<&mut [u8]>, odd: usize) {
    let Some(words) = words else { return };
    let swap = |bytes: &mut [u8]| bytes.chunks_exact_mut(4).for_each(<[u8]>::reverse);
    swap(words);
    let mut set = |bit: usize, value: bool| {
        let mask = 0x80 >> (bit % 8);
        words[bit / 8] = if value { words[bit / 8] | mask } else { words[bit / 8] & !mask };
    };
    for (bit, value) in [(0, false), (1, false), (odd, true), (odd + 1, false)] {
        set(bit, value);
    }
    let bit = |words: &[u8], k: usize| words[k / 8] >> (7 - k % 8) & 1;
    let mut covered = [0_u8; 25];
    for (k, from) in (0..114).chain(odd..odd + 82).enumerate() {
        covered[k / 8] |= bit(words, from) << (7 - k % 8);
    }
    let crc = crc24q(&covered, 196);
    for k in 0..24 {
        let (at, value) = (odd + 82 + k, crc >> (23 - k) & 1 == 1);
        let mask = 0x80 >> (at % 8);
        words[at / 8] = if value { words[at / 8] | mask } else { words[at / 8] & !mask };
    }
    swap(words);
}
