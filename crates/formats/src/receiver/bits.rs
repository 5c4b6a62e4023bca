//! Fields of whole bytes, little endian, and of bits, first bit highest.

/// Bytes at a place of a frame; `None` beyond its end.
pub(super) fn array<const N: usize>(bytes: &[u8], at: usize) -> Option<[u8; N]> {
    bytes.get(at..)?.first_chunk().copied()
}

pub(super) fn u8_at(bytes: &[u8], at: usize) -> Option<u8> {
    bytes.get(at).copied()
}

pub(super) fn u16_at(bytes: &[u8], at: usize) -> Option<u16> {
    array(bytes, at).map(u16::from_le_bytes)
}

pub(super) fn i16_at(bytes: &[u8], at: usize) -> Option<i16> {
    array(bytes, at).map(i16::from_le_bytes)
}

pub(super) fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    array(bytes, at).map(u32::from_le_bytes)
}

pub(super) fn i32_at(bytes: &[u8], at: usize) -> Option<i32> {
    array(bytes, at).map(i32::from_le_bytes)
}

pub(super) fn f32_at(bytes: &[u8], at: usize) -> Option<f32> {
    array(bytes, at).map(f32::from_le_bytes)
}

pub(super) fn f64_at(bytes: &[u8], at: usize) -> Option<f64> {
    array(bytes, at).map(f64::from_le_bytes)
}

/// A navigation message as it is sent, first bit first; bits beyond the end read as zero.
pub(super) struct Bits<'a>(pub(super) &'a [u8]);

impl Bits<'_> {
    /// An unsigned field of up to 32 bits.
    pub(super) fn unsigned(&self, first: usize, bits: usize) -> u32 {
        (first..first + bits).fold(0, |value, bit| value << 1 | u32::from(self.bit(bit)))
    }
    /// A two's-complement field of up to 32 bits.
    pub(super) fn signed(&self, first: usize, bits: usize) -> i32 {
        ((self.unsigned(first, bits) << (32 - bits)) as i32) >> (32 - bits)
    }
    /// A two's-complement field in units of 2^`exponent`.
    pub(super) fn scaled(&self, first: usize, bits: usize, exponent: i32) -> f64 {
        f64::from(self.signed(first, bits)) * f64::powi(2.0, exponent)
    }
    /// An unsigned field in units of 2^`exponent`.
    pub(super) fn scaled_unsigned(&self, first: usize, bits: usize, exponent: i32) -> f64 {
        f64::from(self.unsigned(first, bits)) * f64::powi(2.0, exponent)
    }
    fn bit(&self, index: usize) -> bool {
        self.0.get(index / 8).is_some_and(|byte| byte >> (7 - index % 8) & 1 == 1)
    }
}

/// Append `bits` of `from`, beginning with its bit `first`, to a message that is `len` bits long.
pub(super) fn append(to: &mut [u8], len: usize, from: &[u8], first: usize, bits: usize) {
    let source = Bits(from);
    for k in 0..bits {
        if let Some(byte) = to.get_mut((len + k) / 8) {
            *byte |= u8::from(source.bit(first + k)) << (7 - (len + k) % 8);
        }
    }
}
