//! Messages 2 to 5 (and the first half of 24): fast corrections; message 6: integrity.
//!
//! | message | bits | field | unit, resolution |
//! |---|---|---|---|
//! | 2 to 5 | 14, 15 | IODF | issue, 3 in an alert |
//! | | 16, 17 | IODP | |
//! | | 18 to 173 | 13 corrections of 12 bits, signed | 0.125 m |
//! | | 174 to 225 | 13 UDRE indicators of 4 bits | |
//! | 24 | 14 to 85 | 6 corrections of 12 bits, signed | 0.125 m |
//! | | 86 to 109 | 6 UDRE indicators of 4 bits | |
//! | | 110, 111 | IODP | |
//! | | 112, 113 | which of messages 2 to 5 it stands for | from 0 |
//! | | 114, 115 | IODF | |
//! | 6 | 14 to 21 | IODF of messages 2 to 5, 2 bits each | |
//! | | 22 to 225 | 51 UDRE indicators of 4 bits | |

use super::bits::Block;
use super::mask::MASK_MOST;

/// Corrections in one of messages 2 to 5.
pub(super) const FAST_MOST: usize = 13;
/// Corrections in message 24.
const MIXED_FAST: usize = 6;
/// Resolution of a fast correction \[m\].
const FAST_M: f64 = 0.125;
/// Issue of data that announces an alert.
pub const IODF_ALERT: u8 = 3;
/// UDRE indicator: satellite not monitored.
pub const UDREI_NOT_MONITORED: u8 = 14;
/// UDRE indicator: do not use the satellite.
pub const UDREI_DO_NOT_USE: u8 = 15;

/// Fast corrections of consecutive satellites of the mask.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fast {
    /// Issue of this block, 3 in an alert.
    pub iodf: u8,
    /// Issue of the mask meant.
    pub iodp: u8,
    /// Which of messages 2 to 5, from 0.
    pub block: u8,
    /// How many of the arrays count: 13, or 6 in message 24.
    pub count: usize,
    /// Range corrections \[m\].
    pub correction_m: [f64; FAST_MOST],
    /// UDRE indicators, 0 to 15.
    pub udrei: [u8; FAST_MOST],
}

impl Fast {
    /// Messages 2 to 5, and a message 0 that carries the content of 2.
    pub(super) fn decode(block: &Block, index: u8) -> Self {
        Self {
            iodf: block.unsigned(14, 2) as u8,
            iodp: block.unsigned(16, 2) as u8,
            block: index,
            count: FAST_MOST,
            correction_m: core::array::from_fn(|i| block.scaled(18 + 12 * i, 12, FAST_M)),
            udrei: core::array::from_fn(|i| block.unsigned(174 + 4 * i, 4) as u8),
        }
    }
    /// The first half of message 24.
    pub(super) fn decode_mixed(block: &Block) -> Self {
        Self {
            iodf: block.unsigned(114, 2) as u8,
            iodp: block.unsigned(110, 2) as u8,
            block: block.unsigned(112, 2) as u8,
            count: MIXED_FAST,
            correction_m: core::array::from_fn(|i| if i < MIXED_FAST { block.scaled(14 + 12 * i, 12, FAST_M) } else { 0.0 }),
            udrei: core::array::from_fn(|i| if i < MIXED_FAST { block.unsigned(86 + 4 * i, 4) as u8 } else { UDREI_NOT_MONITORED }),
        }
    }
    /// Position in the mask (from 1), correction and indicator of each satellite.
    pub fn satellites(&self) -> impl Iterator<Item = (usize, f64, u8)> + '_ {
        let first = usize::from(self.block) * FAST_MOST + 1;
        self.correction_m.iter().zip(&self.udrei).take(self.count).enumerate().map(move |(i, (m, u))| (first + i, *m, *u))
    }
}

/// UDRE indicators of every satellite of the mask.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Integrity {
    /// Issues of fast correction blocks 2 to 5 that the indicators belong to, 3 for any.
    pub iodf: [u8; 4],
    /// Indicators by position in the mask.
    pub udrei: [u8; MASK_MOST],
}

impl Integrity {
    pub(super) fn decode(block: &Block) -> Self {
        Self {
            iodf: core::array::from_fn(|i| block.unsigned(14 + 2 * i, 2) as u8),
            udrei: core::array::from_fn(|i| block.unsigned(22 + 4 * i, 4) as u8),
        }
    }
}
