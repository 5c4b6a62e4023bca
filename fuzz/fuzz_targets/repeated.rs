//! Every reader takes time in proportion to its input: a beginning and many repetitions of a piece.
//!
//! A small input that takes quadratic time is quick all the same; a hundred kilobytes of it are not.
#![no_main]

use libfuzzer_sys::fuzz_target;
use navbound_formats::registry::{FORMATS, File, recognise};
use navbound_formats::{almanac, packed, receiver, rinex, rtklib, sbas, sp3};
use navbound_fuzz::within_budget;

/// Length of what is read. [B]
const LENGTH: usize = 100_000;

fuzz_target!(|input: (u8, Vec<u8>, Vec<u8>)| {
    let (kind, mut bytes, piece) = input;
    if piece.is_empty() || bytes.len() > LENGTH {
        return;
    }
    bytes.extend(piece.iter().cycle().take((LENGTH - bytes.len()) / piece.len() * piece.len()));
    within_budget(&bytes, |bytes| match kind % 11 {
        0 => drop(rinex::read_observations(bytes)),
        1 => drop(rinex::read_navigation(bytes)),
        2 => drop(rinex::read_clocks(bytes)),
        3 => drop(sp3::read(bytes)),
        4 => drop(almanac::read(bytes)),
        5 => drop(sbas::read(bytes, None)),
        6 => drop(receiver::read(bytes)),
        7 => drop(packed::unpack(bytes).map(|_| ())),
        8 => drop(rtklib::read(&String::from_utf8_lossy(bytes))),
        9 => receiver::position::Kind::ALL.into_iter().for_each(|kind| drop(receiver::position::log::read(bytes, kind))),
        _ => drop(recognise(FORMATS, &File { content: bytes, name: "" })),
    });
});
