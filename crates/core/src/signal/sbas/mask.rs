//! Message 1: which satellites the corrections are for.
//!
//! | bits | field | meaning |
//! |---|---|---|
//! | 14 to 223 | mask | bit of PRN code number 1 to 210 |
//! | 224, 225 | IODP | issue of this mask |

use super::bits::Block;

/// Most satellites a mask may name (standard).
pub const MASK_MOST: usize = 51;
/// Highest PRN code number of the mask: 1 to 37 GPS, 38 to 61 GLONASS, 120 to 158 SBAS (standard).
pub const PRN_MOST: usize = 210;

/// Satellites in the order in which corrections are sent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PrnMask {
    /// Issue of data, 0 to 3.
    pub iodp: u8,
    count: usize,
    prns: [u8; MASK_MOST],
}

impl PrnMask {
    pub(super) fn decode(block: &Block) -> Self {
        let mut mask = Self { iodp: block.unsigned(224, 2) as u8, count: 0, prns: [0; MASK_MOST] };
        let named = (1..=PRN_MOST as u8).filter(|prn| block.bit(13 + usize::from(*prn)));
        for (slot, prn) in mask.prns.iter_mut().zip(named) {
            *slot = prn;
            mask.count += 1;
        }
        mask
    }
    /// PRN code numbers, ascending.
    pub fn prns(&self) -> &[u8] {
        self.prns.get(..self.count).unwrap_or(&[])
    }
    /// PRN code number at a position from 1, as the messages count.
    pub fn prn(&self, position: usize) -> Option<u8> {
        self.prns().get(position.checked_sub(1)?).copied()
    }
}
