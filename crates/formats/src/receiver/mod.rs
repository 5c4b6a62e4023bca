//! Raw logs of receivers: measurements, navigation subframes and augmentation messages, to the records that RINEX and message logs give.
//!
//! u-blox RXM-RAWX, RXM-SFRBX and the older RXM-RAW, RXM-SFRB; Septentrio MeasEpoch, GEORawL1, GPSRawCA, GALRawINAV. Other frames between
//! them are passed over. A log has no lines: a refusal's `line` is the number of the frame, and its text says at which byte it begins.

mod bits;
mod frames;
mod inav;
mod lnav;
pub mod position;
mod sbf;
mod subframes;
mod table;
mod ubx;
mod write;

use crate::refusal::Unreadable;
use crate::rinex::{Navigation, Observations};
use crate::sbas::Received;
use frames::{Frame, Frames, measures};
use subframes::Subframes;
use table::Table;
pub use write::rawx_log;

/// What a log of raw data holds. Any part may be empty.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Recording {
    /// Measurements, as an observation file gives them; what could not be read of the log stands in its `refused` and `skipped`.
    pub observations: Observations,
    /// Orbits and clocks assembled from subframes: GPS LNAV, Galileo I/NAV; Klobuchar of GPS.
    pub navigation: Navigation,
    /// SBAS L1 messages.
    pub messages: Vec<Received>,
}

/// Whether the bytes are a log with raw data: a whole frame of one of the kinds that are read stands in them.
pub fn is_raw(bytes: &[u8]) -> bool {
    Frames::new(bytes).any(|item| item.frame.is_ok_and(|f| f.is_raw()))
}

/// Read a log, plain (see [`crate::packed::unpack`]).
///
/// # Errors
/// [`Unreadable`] unless a frame with raw data stands in it. Damaged frames and values are put into `observations.refused`, and the others
/// stand.
pub fn read(bytes: &[u8]) -> Result<Recording, Unreadable> {
    let (mut table, mut subframes, mut n_raw) = (Table::default(), Subframes::default(), 0_usize);
    let mut outside = bytes.len();
    for item in Frames::new(bytes) {
        table.begin_frame(item.number, item.at);
        outside -= item.length;
        match item.frame {
            Ok(frame) => {
                n_raw += usize::from(frame.is_raw());
                match frame {
                    Frame::Ubx { kind, payload } => ubx::take(kind, payload, &mut table, &mut subframes),
                    Frame::Sbf { block, body } => sbf::take(block, body, &mut table, &mut subframes),
                }
            }
            Err(reason) if measures(bytes, item.at) => table.lose(reason),
            Err(reason) => table.refuse("frame", reason),
        }
    }
    if n_raw == 0 {
        return Err(Unreadable::whole(
            "no frame with raw data: RXM-RAWX, RXM-SFRBX, RXM-RAW, RXM-SFRB, MeasEpoch, GEORawL1, GPSRawCA or GALRawINAV",
        ));
    }
    table.outside(outside);
    let (navigation, messages) = subframes.finish();
    Ok(Recording { observations: table.finish(), navigation, messages })
}

/// Measurements of an observation file or of a raw log, distinguished by their content.
///
/// # Errors
/// [`Unreadable`] as [`crate::rinex::read_observations`] and [`read`], and for a log without one epoch.
pub fn read_observations(bytes: &[u8]) -> Result<Observations, Unreadable> {
    if !is_log(bytes) {
        return crate::rinex::read_observations(bytes);
    }
    let observations = read(bytes)?.observations;
    if observations.n_epochs() == 0 {
        return Err(Unreadable::whole("a log without measurements: no RXM-RAWX, RXM-RAW or MeasEpoch that is dated"));
    }
    Ok(observations)
}

/// Orbits and clocks of a navigation file or of the subframes in a raw log, distinguished by their content.
///
/// # Errors
/// [`Unreadable`] as [`crate::rinex::read_navigation`] and [`read`].
pub fn read_navigation(bytes: &[u8]) -> Result<Navigation, Unreadable> {
    if is_log(bytes) { Ok(read(bytes)?.navigation) } else { crate::rinex::read_navigation(bytes) }
}

/// A raw log; the first line of a RINEX file says that it is one.
fn is_log(bytes: &[u8]) -> bool {
    let first = bytes.get(..bytes.len().min(80)).unwrap_or_default();
    memchr::memmem::find(first, b"RINEX VERS").is_none() && is_raw(bytes)
}

#[cfg(test)]
mod tests;
