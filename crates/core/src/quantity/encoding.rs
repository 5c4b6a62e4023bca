//! State as bytes: little-endian, field by field, a version first and CRC-32C last.
//!
//! ```text
//! byte 0        version
//! then          the fields of the state, in the order in which it writes them
//! last four     CRC-32C (Castagnoli, reflected 0x82F63B78) of all bytes before
//! ```
//!
//! The bytes do not depend on the processor nor on how a compiler lays out a record. A time that is absent is a zero byte and eight zero
//! bytes, so the length is fixed. Provenance: ours; the checksum is standard (RFC 3720, appendix B.4).

use super::{GpsTime, Metres};
use core::fmt;

/// Why bytes are no state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BadBytes {
    /// Another number of bytes than the state takes.
    Length,
    /// Of a version that this program does not read.
    Version(u8),
    /// The checksum does not fit.
    Checksum,
    /// A field with a value that the state cannot have.
    Value(&'static str),
}

impl fmt::Display for BadBytes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Length => f.write_str("the number of bytes is not that of the state"),
            Self::Version(version) => write!(f, "version {version} of the state is not one that is read here"),
            Self::Checksum => f.write_str("the checksum does not fit: the bytes are damaged"),
            Self::Value(field) => write!(f, "{field} has a value that it cannot have"),
        }
    }
}

impl core::error::Error for BadBytes {}

/// Bytes of the checksum.
const CHECKSUM: usize = 4;

/// CRC-32C of bytes.
pub fn crc32c(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |crc, byte| crc >> 8 ^ TABLE[(crc as u8 ^ byte) as usize])
}

/// What each last byte of a remainder adds to it.
const TABLE: [u32; 256] = {
    const REFLECTED: u32 = 0x82F6_3B78;
    let mut table = [0; 256];
    let mut k = 0;
    while k < 256 {
        let (mut crc, mut bit) = (k as u32, 0);
        while bit < 8 {
            crc = if crc & 1 == 1 { crc >> 1 ^ REFLECTED } else { crc >> 1 };
            bit += 1;
        }
        table[k] = crc;
        k += 1;
    }
    table
};

/// Writes a state into `N` bytes. What goes beyond them is dropped and makes the bytes unreadable, never a panic.
#[derive(Debug, Clone)]
pub struct Encoder<const N: usize> {
    bytes: [u8; N],
    at: usize,
}

impl<const N: usize> Encoder<N> {
    /// A state of a version.
    pub fn new(version: u8) -> Self {
        let mut encoder = Self { bytes: [0; N], at: 0 };
        encoder.raw(&[version]);
        encoder
    }

    /// Bytes as they are.
    pub fn raw(&mut self, bytes: &[u8]) {
        let end = self.at.saturating_add(bytes.len());
        if let Some(slot) = self.bytes.get_mut(self.at..end) {
            slot.copy_from_slice(bytes);
        }
        self.at = end;
    }

    /// A flag: 0 or 1.
    pub fn flag(&mut self, value: bool) {
        self.raw(&[u8::from(value)]);
    }

    /// A small count.
    pub fn u32(&mut self, value: u32) {
        self.raw(&value.to_le_bytes());
    }

    /// A count.
    pub fn u64(&mut self, value: u64) {
        self.raw(&value.to_le_bytes());
    }

    /// A number, to its last bit.
    pub fn f64(&mut self, value: f64) {
        self.raw(&value.to_bits().to_le_bytes());
    }

    /// A length.
    pub fn metres(&mut self, value: Metres) {
        self.f64(value.m());
    }

    /// A time.
    pub fn time(&mut self, value: GpsTime) {
        self.raw(&value.nanoseconds().to_le_bytes());
    }

    /// A time that may be absent.
    pub fn time_or_none(&mut self, value: Option<GpsTime>) {
        self.flag(value.is_some());
        self.time(value.unwrap_or_default());
    }

    /// All bytes, with the checksum in the last four.
    pub fn finish(mut self) -> [u8; N] {
        let complete = self.at.saturating_add(CHECKSUM) == N;
        let crc = crc32c(self.bytes.get(..self.at).unwrap_or(&[]));
        // A state that does not fill its bytes is a fault of ours; its checksum is made wrong, so that nobody reads it.
        self.raw(&if complete { crc } else { !crc }.to_le_bytes());
        self.bytes
    }
}

/// Reads a state.
#[derive(Debug, Clone)]
pub struct Decoder<'a> {
    left: &'a [u8],
}

impl<'a> Decoder<'a> {
    /// The fields of a state of `length` bytes and this version.
    ///
    /// # Errors
    /// [`BadBytes`] for another length, a wrong checksum and, only then, another version.
    pub fn new(bytes: &'a [u8], length: usize, version: u8) -> Result<Self, BadBytes> {
        let (content, crc) = bytes.split_last_chunk::<CHECKSUM>().filter(|_| bytes.len() == length).ok_or(BadBytes::Length)?;
        if crc32c(content) != u32::from_le_bytes(*crc) {
            return Err(BadBytes::Checksum);
        }
        let (first, left) = content.split_first().ok_or(BadBytes::Length)?;
        if *first != version {
            return Err(BadBytes::Version(*first));
        }
        Ok(Self { left })
    }

    /// Bytes as they are.
    ///
    /// # Errors
    /// [`BadBytes`] at the end of the bytes.
    pub fn raw<const M: usize>(&mut self) -> Result<[u8; M], BadBytes> {
        let (first, left) = self.left.split_first_chunk::<M>().ok_or(BadBytes::Length)?;
        self.left = left;
        Ok(*first)
    }

    /// A flag.
    ///
    /// # Errors
    /// [`BadBytes`] at the end of the bytes and for a byte that is neither 0 nor 1.
    pub fn flag(&mut self, field: &'static str) -> Result<bool, BadBytes> {
        match self.raw::<1>()? {
            [0] => Ok(false),
            [1] => Ok(true),
            _ => Err(BadBytes::Value(field)),
        }
    }

    /// A small count.
    ///
    /// # Errors
    /// [`BadBytes`] at the end of the bytes.
    pub fn u32(&mut self) -> Result<u32, BadBytes> {
        self.raw().map(u32::from_le_bytes)
    }

    /// A count.
    ///
    /// # Errors
    /// [`BadBytes`] at the end of the bytes.
    pub fn u64(&mut self) -> Result<u64, BadBytes> {
        self.raw().map(u64::from_le_bytes)
    }

    /// A number.
    ///
    /// # Errors
    /// [`BadBytes`] at the end of the bytes.
    pub fn f64(&mut self) -> Result<f64, BadBytes> {
        self.raw().map(|bytes| f64::from_bits(u64::from_le_bytes(bytes)))
    }

    /// A length.
    ///
    /// # Errors
    /// [`BadBytes`] at the end of the bytes.
    pub fn metres(&mut self) -> Result<Metres, BadBytes> {
        self.f64().map(Metres::new)
    }

    /// A time.
    ///
    /// # Errors
    /// [`BadBytes`] at the end of the bytes.
    pub fn time(&mut self) -> Result<GpsTime, BadBytes> {
        self.raw().map(|bytes| GpsTime::from_nanoseconds(i64::from_le_bytes(bytes)))
    }

    /// A time that may be absent.
    ///
    /// # Errors
    /// [`BadBytes`] at the end of the bytes and for a wrong flag.
    pub fn time_or_none(&mut self, field: &'static str) -> Result<Option<GpsTime>, BadBytes> {
        let present = self.flag(field)?;
        let time = self.time()?;
        Ok(present.then_some(time))
    }

    /// That nothing is left.
    ///
    /// # Errors
    /// [`BadBytes::Length`] otherwise.
    pub fn finish(self) -> Result<(), BadBytes> {
        if self.left.is_empty() { Ok(()) } else { Err(BadBytes::Length) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_checksum_is_that_of_the_standard() {
        // RFC 3720, appendix B.4: 32 bytes of zeros, of ones, rising and falling; and the check value of the catalogue of CRCs.
        let mut rising = [0; 32];
        (0..).zip(rising.iter_mut()).for_each(|(k, byte)| *byte = k);
        let mut falling = rising;
        falling.reverse();
        let expected = [([0; 32], 0x8A91_36AA), ([0xFF; 32], 0x62A8_AB43), (rising, 0x46DD_794E), (falling, 0x113F_DB5C)];
        for (bytes, crc) in expected {
            assert_eq!(crc32c(&bytes), crc);
        }
        assert_eq!(crc32c(b"123456789"), 0xE306_9283);
    }

    #[test]
    fn fields_stand_in_their_order_little_endian() {
        let mut encoder = Encoder::<27>::new(7);
        encoder.u32(0x0102_0304);
        encoder.flag(true);
        encoder.time_or_none(None);
        encoder.f64(1.0);
        let bytes = encoder.finish();
        assert_eq!(bytes[..6], [7, 4, 3, 2, 1, 1]);
        assert_eq!(bytes[6..15], [0; 9]);
        assert_eq!(bytes[15..23], [0, 0, 0, 0, 0, 0, 0xF0, 0x3F]);
        assert_eq!(bytes[23..], crc32c(&bytes[..23]).to_le_bytes());
    }

    #[test]
    fn a_state_that_does_not_fill_its_bytes_cannot_be_read() {
        let short = Encoder::<16>::new(1).finish();
        let mut long = Encoder::<8>::new(1);
        long.u64(3);
        for bytes in [short.as_slice(), long.finish().as_slice()] {
            assert_eq!(Decoder::new(bytes, bytes.len(), 1).err(), Some(BadBytes::Checksum));
        }
    }
}
