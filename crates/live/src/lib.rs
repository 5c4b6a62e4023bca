//! The same bounds and the same monitor on data that are still arriving: one state machine, from a journal in to a journal out.
//!
//! ```text
//! bytes of a source -> journal in -> Lane::step -> outputs -> journal out
//! ```
//!
//! [`Lane`] has no clock, no file and no thread: time comes in with the inputs, so a lane that reads its journal again gives the same outputs
//! in every bit. What a lane does with an input, in this order: decode, guard the time, look the track up, drop duplicates, put the records of
//! a track in order, judge them by [`navbound_core::judge::Judge`], find silences by the event time of the lane.
//! docs/methods/live.md says what an alert means.

mod assumed;
mod claims;
mod codec;
mod counters;
mod decode;
mod feed;
mod guard;
mod input;
pub mod journal;
mod judging;
mod lane;
mod order;
mod output;
mod position;
mod settings;
mod snapshot;
mod split;
mod track;
mod zones;

pub use assumed::Assumed;
pub use claims::{CATEGORIES, Claim, Claims};
pub use codec::Damaged;
pub use counters::{Counters, Refused};
pub use decode::{Format, PlaceWords, StatementRow, Statements};
pub use input::Input;
pub use lane::Lane;
pub use output::{EpochOut, Kind, NUMBERS, Output, Transition, Turn};
pub use position::{Position, Shown, TrackId};
pub use settings::{Course, Settings};
pub use snapshot::SnapshotRefused;
pub use split::Splitter;
pub use zones::{Assigned, Table, Zone};

#[cfg(test)]
mod tests;
