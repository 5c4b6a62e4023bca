//! The ICAO performance indicators of a series of errors and protection levels: accuracy, integrity, availability, continuity.
//!
//! One pass, and memory that depends on the number of levels, not on the number of epochs: a [`tally::Tally`] holds what a stretch of
//! epochs adds up to, and two that follow each other merge into the tally of both, whatever the cut. Percentiles are exact: they are
//! selected digit by digit in further passes ([`select::Selector`]). Definitions: docs/methods/kpi.md.

mod campaign;
mod continuity;
mod epoch;
mod runs;
mod select;
mod series;
mod spread;
mod stanford;
pub mod subsets;
mod tally;

pub use campaign::{Campaign, Event, Kind, Outcome, Totals};
pub use continuity::{Continuity, poisson_limits, wilson_limits};
pub use epoch::{Cause, Columns, Demand, Epoch, Grid, Refused, Settings, State};
pub use runs::Stretch;
pub use select::{PERMILLE, QUANTITIES, Selector};
pub use series::{Bucket, Series};
pub use spread::{Axis, Moments};
pub use stanford::{Histogram, Regions};
pub use tally::{Day, LevelTally, Tally};
