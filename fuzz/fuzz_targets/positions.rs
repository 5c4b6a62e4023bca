//! Logs of positions: no panic, every position is sound, and a log in pieces has as many as the whole. Checksums are made right, so that what
//! stands behind them is reached.
#![no_main]

use core::f64::consts::FRAC_PI_2;
use libfuzzer_sys::fuzz_target;
use navbound_formats::receiver::position::{Decoder, Ends, Heard, Item, Kind, Reason, State, log};
use navbound_formats::registry::{FORMATS, File, recognise};
use navbound_formats::stream::{Framer, Protocol};
use navbound_fuzz::within_budget;

const UBX: [u16; 6] = [0x0107, 0x0104, 0x0120, 0x0136, 0x0161, 0x0162];
const SBF: [u16; 5] = [4001, 4006, 4007, 5905, 5906];

fuzz_target!(|bytes: &[u8]| {
    let Some((form, rest)) = bytes.split_first() else { return };
    let log = if form & 0x80 == 0 { rest.to_vec() } else { frames(rest) };
    assert!(within_budget(&log, |content| recognise(FORMATS, &File { content, name: "" }).is_some()));
    for kind in Kind::ALL {
        let whole = within_budget(&log, |bytes| log::read(bytes, kind));
        assert!(whole.n_outside <= log.len());
        for p in &whole.positions {
            // A position of few satellites stays one, with its status.
            assert!(p.absent.as_ref().is_none_or(|absent| absent.reason == Reason::FewSatellites));
            assert!(p.time.is_some() && p.lat_rad.is_some_and(|lat| lat.abs() <= FRAC_PI_2));
        }
        // A damaged message of a position is a row without a time, and no position of the decoder. A receiver that went on without a position
        // before or behind all epochs is a row at that end, which only the whole log knows.
        let without_time = whole.absent.iter().filter(|time| time.is_none()).count();
        let beyond = 2 * usize::from(whole.left_out.iter().any(|each| each.reason == "no_fix"));
        let positions = in_pieces(&log, kind, 1 + usize::from(form & 0x7f));
        assert!(positions <= whole.n_rows, "{kind:?}: {positions} {}", whole.n_rows);
        assert!(positions + without_time + beyond >= whole.n_rows, "{kind:?}: {positions} {without_time} {beyond} {}", whole.n_rows);
    }
});

/// Positions of a log that arrives so many bytes at a time, to a decoder that knows what a reader of the whole knows: one GGA anywhere, and
/// RMC states no positions.
fn in_pieces(log: &[u8], kind: Kind, length: usize) -> usize {
    let gga = log.windows(7).any(|sign| matches!(sign, [b'$', b'A'..=b'Z', b'A'..=b'Z', name @ ..] if name == b"GGA,"));
    let heard = Heard { gga, ..Heard::default() };
    let mut decoder = Decoder::with_state(kind, Ends::WithNext, State::default(), heard);
    let (mut framer, mut items) = (Framer::new(Protocol::Receiver), Vec::new());
    for piece in log.chunks(length) {
        framer.push(piece, &mut |found| drop(found.map(|frame| decoder.take(&frame, 0, &mut items))));
    }
    framer.flush(&mut |found| drop(found.map(|frame| decoder.take(&frame, 0, &mut items))));
    decoder.finish(&mut items);
    items.iter().filter(|item| matches!(item, Item::Position(_))).count()
}

/// Records of a kind, a length and a content as messages with right checksums.
fn frames(mut rest: &[u8]) -> Vec<u8> {
    let mut log = Vec::new();
    while let [kind, low, high, tail @ ..] = rest {
        let length = usize::from(u16::from_le_bytes([*low, *high & 0x03])).min(tail.len());
        let (content, next) = tail.split_at(length);
        rest = next;
        let index = usize::from(kind >> 2);
        match kind & 3 {
            0 => ubx(UBX[index % UBX.len()], content, &mut log),
            1 => sbf(SBF[index % SBF.len()], content, &mut log),
            2 => nmea(content, &mut log),
            _ => novatel(index & 1 == 0, content, &mut log),
        }
    }
    log
}

fn ubx(kind: u16, payload: &[u8], log: &mut Vec<u8>) {
    let body = [&kind.to_be_bytes(), &(payload.len() as u16).to_le_bytes(), payload].concat();
    let sum = body.iter().fold((0_u8, 0_u8), |(a, b), byte| (a.wrapping_add(*byte), b.wrapping_add(a.wrapping_add(*byte))));
    log.extend([b"\xb5\x62".as_slice(), &body, &[sum.0, sum.1]].concat());
}

fn sbf(block: u16, content: &[u8], log: &mut Vec<u8>) {
    let mut content = content.to_vec();
    content.resize(content.len().next_multiple_of(4), 0);
    let body = [&block.to_le_bytes(), &(content.len() as u16 + 8).to_le_bytes(), content.as_slice()].concat();
    let crc = body
        .iter()
        .fold(0_u16, |crc, byte| (0..8).fold(crc ^ u16::from(*byte) << 8, |c, _| if c & 0x8000 == 0 { c << 1 } else { c << 1 ^ 0x1021 }));
    log.extend([b"$@".as_slice(), &crc.to_le_bytes(), &body].concat());
}

fn nmea(content: &[u8], log: &mut Vec<u8>) {
    let body: Vec<u8> = content.iter().copied().filter(|byte| matches!(byte, 0x20..=0x29 | 0x2b..=0x7e)).collect();
    let sum = body.iter().fold(0_u8, |sum, byte| sum ^ byte);
    log.extend([b"$".as_slice(), &body, format!("*{sum:02X}\r\n").as_bytes()].concat());
}

fn novatel(binary: bool, content: &[u8], log: &mut Vec<u8>) {
    let crc32 = |bytes: &[u8]| {
        bytes
            .iter()
            .fold(0_u32, |crc, byte| (0..8).fold(crc ^ u32::from(*byte), |c, _| if c & 1 == 0 { c >> 1 } else { c >> 1 ^ 0xEDB8_8320 }))
    };
    if binary {
        let mut head = content.iter().copied().chain([0; 28]).take(28).collect::<Vec<_>>();
        let body = content.get(28..).unwrap_or_default();
        head[..6].copy_from_slice(&[0xaa, 0x44, 0x12, 28, 42, 0]);
        head[8..10].copy_from_slice(&(body.len() as u16).to_le_bytes());
        let checked = [&head, body].concat();
        log.extend([checked.as_slice(), &crc32(&checked).to_le_bytes()].concat());
    } else {
        let body: Vec<u8> = content.iter().copied().filter(|byte| !matches!(byte, b'#' | b'*' | b'\r' | b'\n')).collect();
        let body = [b"BESTPOSA,".as_slice(), &body].concat();
        log.extend([b"#".as_slice(), &body, format!("*{:08x}\r\n", crc32(&body)).as_bytes()].concat());
    }
}
