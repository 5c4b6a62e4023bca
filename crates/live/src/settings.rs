//! How a lane is set.

use crate::assumed::Assumed;
use crate::claims::Claims;
use crate::decode::{Format, Statements};
use crate::position::TrackId;
use crate::zones::Table;
use navbound_core::bound::Alerting;
use navbound_core::frame::LatLon;
use navbound_core::judge;
use navbound_core::monitor::motion;
use navbound_core::quantity::{Metres, OutOfDomain};
use navbound_path::{Foot, Line, Route};
use std::sync::Arc;

/// Where the aircraft should be.
#[derive(Debug, Clone)]
pub enum Course {
    /// An infinite geodesic.
    Line(Box<Line>),
    /// Legs and turns.
    Route(Box<Route>),
}

impl Course {
    /// The foot of a position, sought from the foot before it.
    ///
    /// # Errors
    /// [`OutOfDomain`] for a position that no path is near.
    pub fn project(&self, position: &LatLon, near: Option<Metres>) -> Result<Foot, OutOfDomain> {
        match self {
            Self::Line(line) => line.project(position),
            Self::Route(route) => route.project(position, near),
        }
    }
}

/// Settings of a lane.
#[derive(Debug, Clone)]
pub struct Settings {
    /// What the source sends.
    pub format: Format,
    /// Whose positions those of a receiver are.
    pub track: TrackId,
    /// How lines of JSON speak against their positions under keys that are none of the contract.
    pub statements: Arc<Statements>,
    /// Method, risks and monitor of every track.
    pub judge: judge::Settings,
    /// The method of a track from its first record on that states a flight technical error; `None`: that of all.
    pub of_stated_fte: Option<Alerting>,
    /// What an aircraft can do, by which the motion of positions is judged.
    pub motion: motion::Limits,
    /// The accuracy of positions that state none; `None`: they have none.
    pub assumed: Option<Assumed>,
    /// RNP value in force where a record states none.
    pub rnp: Metres,
    /// The path; without one the flight technical error is the record's own.
    pub path: Option<Course>,
    /// RNP and paths by area and by track.
    pub table: Table,
    /// What the categories of ADS-B stand for.
    pub claims: Claims,
    /// Allowed lateness: how long the order of a track is waited for \[ns\].
    pub lateness_ns: i64,
    /// How much later than its arrival a record may be \[ns\].
    pub ahead_ns: i64,
    /// How much earlier than its arrival a record may be \[ns\].
    pub retention_ns: i64,
    /// Silence after which a track is forgotten \[ns\]; `None`: never.
    pub expiry_ns: Option<i64>,
    /// Most tracks that are watched.
    pub max_tracks: usize,
    /// Digest of what the settings were made from: a snapshot belongs to it.
    pub digest: [u8; 32],
}

impl Settings {
    /// Where a track should be: its own path, else that of all.
    pub(crate) fn path_of(&self, id: TrackId) -> Option<&Course> {
        self.table.path(id).or(self.path.as_ref())
    }
}
