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
    /// NovAtel, binary: the header from its sync on, and the body.
    NovatelBinary {
        /// Header.
        head: &'a [u8],
        /// Body.
        body: &'a [u8],
    },
    /// NovAtel, ASCII: what is between `#` and `*`.
    NovatelText(&'a [u8]),
    /// Message of a receiver of Mode S.
    Beast(Beast),
    /// A line without its end.
    Line(&'a [u8]),
}

/// A message of Mode S as a receiver heard it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Beast {
    /// The receiver's counter, which is no time.
    pub counter: [u8; 6],
    /// The message and zeros.
    pub message: [u8; 14],
    /// Bytes of the message.
    pub length: usize,
}

impl Beast {
    /// The message.
    pub fn message(&self) -> &[u8] {
        self.message.get(..self.length).unwrap_or_default()
    }
}

/// Whose frames they are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Family {
    /// u-blox.
    Ubx,
    /// Septentrio.
    Sbf,
    /// NMEA 0183.
    Nmea,
    /// NovAtel.
    Novatel,
    /// Receivers of Mode S.
    Beast,
    /// Lines of text.
    Lines,
}

impl Frame<'_> {
    /// Whose frame it is.
    pub const fn family(&self) -> Family {
        match self {
            Self::Ubx { .. } => Family::Ubx,
            Self::Sbf { .. } => Family::Sbf,
            Self::Nmea(_) => Family::Nmea,
            Self::NovatelBinary { .. } | Self::NovatelText(_) => Family::Novatel,
            Self::Beast(_) => Family::Beast,
            Self::Line(_) => Family::Lines,
        }
    }
}

/// What began as a frame and is none.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Damage {
    /// Whose frame it would be.
    pub family: Family,
    /// Why.
    pub reason: &'static str,
    /// Bytes of it that are known \[B\].
    pub length: usize,
}
