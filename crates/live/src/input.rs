//! What comes into a lane, in the order of arrival.

use crate::codec::{Damaged, Reader, Writer};
use crate::journal::VERSION;
use navbound_core::quantity::GpsTime;

/// One input. Its arrival is GPS time on the host that wrote the journal; `None` where nobody knows when the bytes arrived, as in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Input<'a> {
    /// Bytes of the source, before decoding.
    Chunk {
        /// When they arrived.
        arrival: Option<GpsTime>,
        /// The bytes.
        bytes: &'a [u8],
    },
    /// The reader is alive; it says so once a second, also when the source is silent.
    Heartbeat {
        /// When.
        arrival: GpsTime,
    },
    /// The connection to the source was lost, or is back.
    Link {
        /// When.
        arrival: GpsTime,
        /// Whether it is there.
        up: bool,
    },
    /// The journal is closed in order: what waits is judged.
    End {
        /// When, where that is known.
        arrival: Option<GpsTime>,
    },
}

impl<'a> Input<'a> {
    /// The payload of its journal frame.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut to = Writer::default();
        to.u8(VERSION);
        let optional = |to: &mut Writer, arrival: Option<GpsTime>| to.option(arrival, |to, time| to.i64(time.nanoseconds()));
        match *self {
            Self::Chunk { arrival, bytes } => {
                to.u8(0);
                optional(&mut to, arrival);
                to.bytes(bytes);
            }
            Self::Heartbeat { arrival } => {
                to.u8(1);
                to.i64(arrival.nanoseconds());
            }
            Self::Link { arrival, up } => {
                to.u8(2);
                to.i64(arrival.nanoseconds());
                to.flag(up);
            }
            Self::End { arrival } => {
                to.u8(3);
                optional(&mut to, arrival);
            }
        }
        to.0
    }

    /// The input of a payload.
    ///
    /// # Errors
    /// [`Damaged`] for another version and for what is no input.
    pub fn from_bytes(payload: &'a [u8]) -> Result<Self, Damaged> {
        let mut from = Reader(payload);
        if from.u8()? != VERSION {
            return Err(Damaged("another version of the journal"));
        }
        let time = |from: &mut Reader<'a>| from.i64().map(GpsTime::from_nanoseconds);
        let input = match from.u8()? {
            0 => Self::Chunk { arrival: from.option(time)?, bytes: from.bytes()? },
            1 => Self::Heartbeat { arrival: time(&mut from)? },
            2 => Self::Link { arrival: time(&mut from)?, up: from.flag()? },
            3 => Self::End { arrival: from.option(time)? },
            _ => return Err(Damaged("an input of no known kind")),
        };
        from.finish()?;
        Ok(input)
    }
}
