//! The 250-bit block of an SBAS L1 message: framing, parity, and fields by their first bit.

use super::{Malformed, SOURCE};

/// Bits of a message, parity included.
pub const BLOCK_BITS: usize = 250;
/// Bytes that hold them; the last six bits are zero.
pub const BLOCK_BYTES: usize = 32;

/// The three 8-bit preambles, sent in turn (standard).
const PREAMBLES: [u8; 3] = [0x53, 0x9A, 0xC6];
/// Bits covered by the parity.
const DATA_BITS: usize = 226;
/// Generator of CRC-24Q (standard).
const CRC24Q: u32 = 0x0186_4CFB;

/// A message block whose preamble and parity are right.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Block([u8; BLOCK_BYTES]);

impl Block {
    /// A block from its bytes, first bit first; bits after the 250th are ignored.
    ///
    /// # Errors
    /// [`Malformed`] for a preamble that is none of the three, or a parity that does not fit.
    pub fn new(bytes: [u8; BLOCK_BYTES]) -> Result<Self, Malformed> {
        let block = Self(bytes);
        let [preamble, ..] = bytes;
        if !PREAMBLES.contains(&preamble) {
            return Err(Malformed::Preamble { preamble });
        }
        let (stated, computed) = (block.unsigned(DATA_BITS, 24), crc24q(&bytes, DATA_BITS));
        if stated != computed {
            return Err(Malformed::Parity { stated, computed });
        }
        Ok(block)
    }
    /// A block built from data bits, with its parity set: what a transmitter does.
    pub fn with_parity(mut bytes: [u8; BLOCK_BYTES]) -> Result<Self, Malformed> {
        let parity = crc24q(&bytes, DATA_BITS);
        for bit in 0..24 {
            let (byte, mask) = ((DATA_BITS + bit) / 8, 0x80_u8 >> ((DATA_BITS + bit) % 8));
            if let Some(b) = bytes.get_mut(byte) {
                *b = if parity >> (23 - bit) & 1 == 1 { *b | mask } else { *b & !mask };
            }
        }
        if let Some(last) = bytes.last_mut() {
            *last &= 0xC0;
        }
        Self::new(bytes)
    }
    /// The bytes, first bit first.
    pub const fn bytes(&self) -> &[u8; BLOCK_BYTES] {
        &self.0
    }
    /// Message type, 0 to 63.
    pub fn message_type(&self) -> u8 {
        self.unsigned(8, 6) as u8
    }
    /// An unsigned field of up to 32 bits.
    pub(super) fn unsigned(&self, first: usize, bits: usize) -> u32 {
        debug_assert!(bits <= 32 && first + bits <= BLOCK_BITS, "{SOURCE}: field {first}+{bits} leaves the block");
        (first..first + bits).fold(0, |value, bit| value << 1 | u32::from(self.bit(bit)))
    }
    /// A two's-complement field of up to 32 bits.
    pub(super) fn signed(&self, first: usize, bits: usize) -> i32 {
        let shift = 32 - bits;
        ((self.unsigned(first, bits) << shift) as i32) >> shift
    }
    /// A two's-complement field times its resolution.
    pub(super) fn scaled(&self, first: usize, bits: usize, resolution: f64) -> f64 {
        f64::from(self.signed(first, bits)) * resolution
    }
    /// An unsigned field times its resolution.
    pub(super) fn scaled_unsigned(&self, first: usize, bits: usize, resolution: f64) -> f64 {
        f64::from(self.unsigned(first, bits)) * resolution
    }
    /// One bit.
    pub(super) fn bit(&self, index: usize) -> bool {
        self.0.get(index / 8).is_some_and(|byte| byte >> (7 - index % 8) & 1 == 1)
    }
}

/// CRC-24Q of the first `n_bits` bits: parity of SBAS messages (226 bits) and of Galileo's I/NAV pages (196).
pub fn crc24q(bytes: &[u8], n_bits: usize) -> u32 {
    let mut crc = 0_u32;
    // Leading zeros, which fill up the first byte, do not change a CRC that starts at zero: bits are taken as they come.
    for bit in 0..n_bits {
        let data = bytes.get(bit / 8).map_or(0, |byte| byte >> (7 - bit % 8) & 1);
        let top = crc >> 23 & 1 ^ u32::from(data);
        crc = crc << 1 & 0x00FF_FFFF;
        if top == 1 {
            crc ^= CRC24Q & 0x00FF_FFFF;
        }
    }
    crc
}

#[cfg(test)]
mod tests {
    use super::*;

    /// MSAS, PRN 137, 2025-02-15 17:00:01 (cssrlib-data, MIT).
    const REAL: [u8; 32] = [
        0xC6, 0x0D, 0xFF, 0xF8, 0x00, 0x1F, 0xFD, 0xFF, 0xC0, 0x05, 0xFF, 0xFF, 0xFD, 0xFF, 0xFF, 0xFF, 0xFF, 0xC0, 0x01, 0xFF, 0xDF, 0xFE,
        0xE3, 0xBA, 0xBA, 0x3A, 0xEA, 0x7B, 0xAF, 0xA3, 0x25, 0x80,
    ];

    #[test]
    fn a_real_block_is_accepted_and_any_single_flipped_bit_is_not() {
        assert_eq!(Block::new(REAL).unwrap().message_type(), 3);
        for bit in 0..BLOCK_BITS {
            let mut damaged = REAL;
            damaged[bit / 8] ^= 0x80 >> (bit % 8);
            assert!(Block::new(damaged).is_err(), "bit {bit}");
        }
    }

    #[test]
    fn a_transmitter_computes_the_parity_that_was_received() {
        let mut bare = REAL;
        bare[28] &= 0xC0;
        bare[29..].fill(0);
        assert_eq!(Block::with_parity(bare).unwrap().bytes(), &REAL);
    }

    #[test]
    fn signed_fields_are_twos_complement() {
        // The first correction of the block above: bits 18 to 29 are 1111 1111 1110 = -2.
        let block = Block::new(REAL).unwrap();
        assert_eq!((block.unsigned(18, 12), block.signed(18, 12)), (0xFFE, -2));
        assert_eq!(block.scaled(18, 12, 0.125), -0.25);
    }
}
