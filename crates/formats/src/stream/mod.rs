//! Frames out of bytes that are still arriving: UBX, SBF, NovAtel, NMEA sentences, Beast and lines.
//!
//! [`Framer`] takes bytes in pieces of any size. A frame whose end has not arrived is *need more* and not damage; it becomes damage when the
//! stream falls silent or ends ([`Framer::flush`]). **Chunk law**: any cutting of the bytes gives the same frames in the same order, and the
//! same damage, as all of them at once; the readers of files use the same search.

pub mod beast;
mod check;
mod frame;
mod framer;
mod lines;
mod nmea;
mod novatel;
mod sbf;
mod search;
pub(crate) mod ubx;

#[cfg(test)]
pub(crate) use check::crc16;
pub use frame::{Beast, Damage, Family, Frame};
pub use framer::{BadRest, Framer, Protocol};
pub use search::{Among, Frames, Place};
pub(crate) use search::{Look, look};

/// Longest frame that is kept until its end arrives \[B\]. A length field above it is no length; the longest UBX frame that is believed has
/// 8200 bytes. Provenance: ours.
pub const LONGEST_FRAME: usize = 16 * 1024;

#[cfg(test)]
mod tests;
