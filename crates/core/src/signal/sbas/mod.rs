//! SBAS L1 messages: what a geostationary satellite says about others' ranges, and what of it is in force.
//!
//! One file a message family, each headed by its field table: bits as sent from 0, the preamble included. [`decode`] turns a block into a
//! [`Message`]; a [`Store`] keeps what is in force, with its issues of data and its time-outs.

mod bits;
mod clock;
mod degradation;
mod fast;
mod geo;
pub mod grid;
mod hear;
mod history;
mod iono;
mod long_term;
mod mask;
mod region;
mod store;
pub mod timeout;

pub use bits::{BLOCK_BITS, BLOCK_BYTES, Block, crc24q};
pub use clock::NetworkTime;
pub use degradation::{Degradation, FastDegradation};
pub use fast::{Fast, IODF_ALERT, Integrity, UDREI_DO_NOT_USE, UDREI_NOT_MONITORED};
pub use geo::{GeoAlmanac, GeoAlmanacs, GeoNavigation};
pub use hear::Ignored;
pub use history::FastCorrection;
pub use iono::{BAND_MOST, BANDS, GIVEI_NOT_MONITORED, GridDelay, GridDelays, GridMask};
pub use long_term::{LongTerm, LongTermHalf, LongTermRates};
pub use mask::{MASK_MOST, PRN_MOST, PrnMask};
pub use region::{ClockEphemerisCovariance, Covariances, Region, ServiceRegions};
pub use store::{Correction, GridValue, Obedience, Satellite, Store};

/// Field layout, resolutions, issues of data and time-outs: provenance *standard*.
pub const SOURCE: &str = "RTCA DO-229D, appendix A (standard; checked on recorded messages, not against a copy of the document)";

/// A block that is not a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Malformed {
    /// None of the three preambles.
    #[error("preamble {preamble:#04x} is none of 0x53, 0x9a, 0xc6")]
    Preamble {
        /// The first eight bits.
        preamble: u8,
    },
    /// Damaged on the way.
    #[error("parity {stated:#08x} does not fit the data, which give {computed:#08x}")]
    Parity {
        /// The last 24 bits.
        stated: u32,
        /// CRC-24Q of the others.
        computed: u32,
    },
}

/// A decoded message.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "no heap in core; messages are handled one at a time")]
pub enum Message {
    /// 0: do not use this satellite for safety applications. Some providers put the content of message 2 into it.
    DoNotUse(Option<Fast>),
    /// 1.
    PrnMask(PrnMask),
    /// 2 to 5.
    Fast(Fast),
    /// 6.
    Integrity(Integrity),
    /// 7.
    FastDegradation(FastDegradation),
    /// 9.
    GeoNavigation(GeoNavigation),
    /// 10.
    Degradation(Degradation),
    /// 12.
    NetworkTime(NetworkTime),
    /// 17.
    GeoAlmanacs(GeoAlmanacs),
    /// 18.
    GridMask(GridMask),
    /// 24.
    Mixed(Fast, LongTermHalf),
    /// 25.
    LongTerm([LongTermHalf; 2]),
    /// 26.
    GridDelays(GridDelays),
    /// 27.
    ServiceRegions(ServiceRegions),
    /// 28.
    Covariances(Covariances),
    /// 62: internal test, nothing for a user.
    InternalTest,
    /// 63: null, nothing for a user.
    Null,
    /// A type this decoder does not know (or a field outside its range): counted, never guessed.
    Unknown(u8),
}

/// The message in a block.
pub fn decode(block: &Block) -> Message {
    let kind = block.message_type();
    match kind {
        0 => {
            let empty = (14..226).all(|bit| !block.bit(bit));
            Message::DoNotUse((!empty).then(|| Fast::decode(block, 0)))
        }
        1 => Message::PrnMask(PrnMask::decode(block)),
        2..=5 => Message::Fast(Fast::decode(block, kind - 2)),
        6 => Message::Integrity(Integrity::decode(block)),
        7 => Message::FastDegradation(FastDegradation::decode(block)),
        9 => Message::GeoNavigation(GeoNavigation::decode(block)),
        10 => Message::Degradation(Degradation::decode(block)),
        12 => Message::NetworkTime(NetworkTime::decode(block)),
        17 => Message::GeoAlmanacs(GeoAlmanacs::decode(block)),
        18 => GridMask::decode(block).map_or(Message::Unknown(kind), Message::GridMask),
        24 => Message::Mixed(Fast::decode_mixed(block), long_term::decode_half(block, 120)),
        25 => Message::LongTerm([14, 120].map(|first| long_term::decode_half(block, first))),
        26 => GridDelays::decode(block).map_or(Message::Unknown(kind), Message::GridDelays),
        27 => Message::ServiceRegions(ServiceRegions::decode(block)),
        28 => Message::Covariances(Covariances::decode(block)),
        62 => Message::InternalTest,
        63 => Message::Null,
        other => Message::Unknown(other),
    }
}
