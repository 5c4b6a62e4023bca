//! Messages 18 and 26: the ionospheric grid.
//!
//! | message | bits | field | unit, resolution |
//! |---|---|---|---|
//! | 18 | 14 to 17 | bands of the service | |
//! | | 18 to 21 | band of this mask | |
//! | | 22, 23 | IODI | |
//! | | 24 to 224 | mask of 201 grid points | |
//! | 26 | 14 to 17, 18 to 21 | band, block of 15 points in its mask | |
//! | | 22 to 216 | 15 points: vertical delay (9), GIVE indicator (4) | 0.125 m |
//! | | 217, 218 | IODI | |

use super::bits::Block;

/// Bands of the grid: nine of 40 degrees of longitude and the two polar ones (standard).
pub const BANDS: usize = 11;
/// Most grid points in one band (standard).
pub const BAND_MOST: usize = 201;
/// Blocks of fifteen that a full band fills.
pub(super) const BLOCKS: usize = BAND_MOST.div_ceil(BLOCK_POINTS);
/// Grid points in one message 26.
pub(super) const BLOCK_POINTS: usize = 15;
/// GIVE indicator: not monitored.
pub const GIVEI_NOT_MONITORED: u8 = 15;

const DELAY_M: f64 = 0.125;
/// The delay that means: do not use this point.
const DELAY_DO_NOT_USE: u32 = 0x1FF;

/// Message 18: grid points of one band.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GridMask {
    /// Bands of the service.
    pub bands: u8,
    /// Band, 0 to 10.
    pub band: u8,
    /// Issue of the mask.
    pub iodi: u8,
    count: usize,
    points: [u8; BAND_MOST],
}

impl GridMask {
    /// None for a band that does not exist.
    pub(super) fn decode(block: &Block) -> Option<Self> {
        let band = block.unsigned(18, 4) as u8;
        if usize::from(band) >= BANDS {
            return None;
        }
        let mut mask =
            Self { bands: block.unsigned(14, 4) as u8, band, iodi: block.unsigned(22, 2) as u8, count: 0, points: [0; BAND_MOST] };
        let set = (1..=BAND_MOST as u8).filter(|bit| block.bit(23 + usize::from(*bit)));
        for (slot, bit) in mask.points.iter_mut().zip(set) {
            *slot = bit;
            mask.count += 1;
        }
        Some(mask)
    }
    /// Numbers of the points in the band, from 1, ascending.
    pub fn points(&self) -> &[u8] {
        self.points.get(..self.count).unwrap_or(&[])
    }
}

/// One grid point of message 26.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GridDelay {
    /// Vertical delay on L1 \[m\]; none where the point must not be used.
    pub delay_m: Option<f64>,
    /// GIVE indicator, 15 for not monitored.
    pub givei: u8,
}

/// Message 26: delays of consecutive points of a band's mask.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GridDelays {
    /// Band.
    pub band: u8,
    /// Which fifteen points of the mask, from 0.
    pub block: u8,
    /// Issue of the mask meant.
    pub iodi: u8,
    /// Points; those beyond the mask's end mean nothing.
    pub points: [GridDelay; BLOCK_POINTS],
}

impl GridDelays {
    /// None for a band or block that does not exist.
    pub(super) fn decode(block: &Block) -> Option<Self> {
        let band = block.unsigned(14, 4) as u8;
        let index = block.unsigned(18, 4) as usize;
        (usize::from(band) < BANDS && index < BLOCKS).then(|| Self {
            band,
            block: block.unsigned(18, 4) as u8,
            iodi: block.unsigned(217, 2) as u8,
            points: core::array::from_fn(|i| {
                let raw = block.unsigned(22 + 13 * i, 9);
                GridDelay {
                    delay_m: (raw != DELAY_DO_NOT_USE).then(|| f64::from(raw) * DELAY_M),
                    givei: block.unsigned(31 + 13 * i, 4) as u8,
                }
            }),
        })
    }
}
