//! Message 25 and the second half of 24: slow corrections of broadcast orbits and clocks.
//!
//! One half of 106 bits, its first bit called 0:
//!
//! | velocity code | bits | field | unit, resolution |
//! |---|---|---|---|
//! | both | 0 | velocity code | |
//! | 0 | 1 to 6, 52 to 57 | position in the mask, 0 for none | |
//! | | 7 to 14 | IODE of the navigation data corrected | |
//! | | 15 to 23, 24 to 32, 33 to 41 | dx, dy, dz, signed | 0.125 m |
//! | | 42 to 51 | da_f0, signed | 2^-31 s |
//! | | 103, 104 | IODP | |
//! | 1 | 1 to 6, 7 to 14 | position in the mask, IODE | |
//! | | 15 to 25, 26 to 36, 37 to 47 | dx, dy, dz, signed | 0.125 m |
//! | | 48 to 58 | da_f0, signed | 2^-31 s |
//! | | 59 to 66, 67 to 74, 75 to 82 | rates of dx, dy, dz, signed | 2^-11 m/s |
//! | | 83 to 90 | da_f1, signed | 2^-39 s/s |
//! | | 91 to 103 | time of applicability | 16 s of day |
//! | | 104, 105 | IODP | |

use super::bits::Block;

const POSITION_M: f64 = 0.125;
const CLOCK_S: f64 = 1.0 / (1_u64 << 31) as f64;
const VELOCITY_MPS: f64 = 1.0 / (1_u64 << 11) as f64;
const DRIFT: f64 = 1.0 / (1_u64 << 39) as f64;
/// Resolution of a time of applicability \[s of day\].
const TIME_S: u32 = 16;

/// The correction of one satellite's navigation data.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LongTerm {
    /// Position in the mask, from 1.
    pub position: u8,
    /// Issue of the mask meant.
    pub iodp: u8,
    /// Issue of the navigation data corrected.
    pub iode: u8,
    /// Correction of the satellite's position, ECEF \[m\].
    pub position_ecef_m: [f64; 3],
    /// Correction of its clock \[s\].
    pub clock_s: f64,
    /// Rates, where the message has them (velocity code 1).
    pub rates: Option<LongTermRates>,
}

/// Rates of a long-term correction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LongTermRates {
    /// ECEF \[m/s\].
    pub velocity_ecef_mps: [f64; 3],
    /// Clock \[s/s\].
    pub drift: f64,
    /// Time of applicability, seconds of the GPS day.
    pub time_of_day_s: u32,
}

/// One half of message 25, or the second half of 24: up to two satellites.
pub type LongTermHalf = [Option<LongTerm>; 2];

pub(super) fn decode_half(block: &Block, first: usize) -> LongTermHalf {
    if block.bit(first) {
        return [with_rates(block, first), None];
    }
    let iodp = block.unsigned(first + 103, 2) as u8;
    [1, 52].map(|offset| without_rates(block, first + offset, iodp))
}

fn without_rates(block: &Block, first: usize, iodp: u8) -> Option<LongTerm> {
    let position = block.unsigned(first, 6) as u8;
    (position > 0).then(|| LongTerm {
        position,
        iodp,
        iode: block.unsigned(first + 6, 8) as u8,
        position_ecef_m: core::array::from_fn(|i| block.scaled(first + 14 + 9 * i, 9, POSITION_M)),
        clock_s: block.scaled(first + 41, 10, CLOCK_S),
        rates: None,
    })
}

fn with_rates(block: &Block, first: usize) -> Option<LongTerm> {
    let position = block.unsigned(first + 1, 6) as u8;
    (position > 0).then(|| LongTerm {
        position,
        iodp: block.unsigned(first + 104, 2) as u8,
        iode: block.unsigned(first + 7, 8) as u8,
        position_ecef_m: core::array::from_fn(|i| block.scaled(first + 15 + 11 * i, 11, POSITION_M)),
        clock_s: block.scaled(first + 48, 11, CLOCK_S),
        rates: Some(LongTermRates {
            velocity_ecef_mps: core::array::from_fn(|i| block.scaled(first + 59 + 8 * i, 8, VELOCITY_MPS)),
            drift: block.scaled(first + 83, 8, DRIFT),
            time_of_day_s: block.unsigned(first + 91, 13) * TIME_S,
        }),
    })
}
