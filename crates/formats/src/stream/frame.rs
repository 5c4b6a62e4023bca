//! What a stream is cut into.

/// One frame, its checksum verified where it has one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Frame<'a> {
    /// UBX: class and identifier.
    Ubx {
        /// Class and identifier.
        kind: [u8; 2],
        /// What is between length and checksum.
        payload: &'a [u8],
    },
    /// SBF: block number without its revision.
    Sbf {
        /// Block number.
        block: u16,
        /// From the time of week on.
        body: &'a [u8],
    },
    /// NMEA 0183: what is between `$` and `*`.
    Nmea(&'a [u8]),
    /// A line without its end.
    Line(&'a [u8]),
}

/// What began as a frame and is none.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Damage {
    /// Why.
    pub reason: &'static str,
    /// Bytes of it that are known \[B\].
    pub length: usize,
}
