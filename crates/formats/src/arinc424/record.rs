//! What the nine record kinds hold, in SI units. Names follow ARINC 424.

use super::field::{Course, Extent, Text};
use navbound_core::frame::LatLon;

/// A fix as a leg names it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct FixName {
    /// Identifier.
    pub ident: Text<5>,
    /// ICAO region.
    pub region: Text<2>,
    /// Section and subsection: which table.
    pub section: Text<2>,
}

/// An airport.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Airport {
    /// Line in the file.
    pub line: usize,
    /// Its reference point.
    pub place: LatLon,
    /// Magnetic variation, positive east \[rad\].
    pub variation_rad: Option<f64>,
    /// Elevation \[m\].
    pub elevation_m: Option<f64>,
}

/// A waypoint, runway threshold or navaid: something that a leg may name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fix {
    /// Line in the file.
    pub line: usize,
    /// Where; that of the DME where a navaid has no other.
    pub place: LatLon,
    /// Magnetic variation or station declination, positive east \[rad\].
    pub variation_rad: Option<f64>,
    /// Whether another record of the same name has another position: the name decides nothing.
    pub ambiguous: bool,
}

/// What a runway record adds to its threshold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Runway {
    /// Line in the file.
    pub line: usize,
    /// Length \[m\].
    pub length_m: Option<f64>,
    /// Bearing.
    pub bearing: Option<Course>,
    /// Threshold above the ellipsoid \[m\].
    pub ellipsoid_height_m: Option<f64>,
    /// Threshold above mean sea level \[m\].
    pub elevation_m: Option<f64>,
    /// Displacement of the threshold \[m\].
    pub displaced_m: Option<f64>,
    /// Height of the path above the threshold \[m\].
    pub crossing_height_m: Option<f64>,
}

/// Which table a procedure is in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Kind {
    /// Departure, P D.
    Sid,
    /// Arrival, P E.
    Star,
    /// Approach, P F.
    Approach,
}

impl Kind {
    /// The word for it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Sid => "sid",
            Self::Star => "star",
            Self::Approach => "approach",
        }
    }
}

/// A procedure of an airport.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ProcedureName {
    /// Airport.
    pub airport: Text<4>,
    /// Which table.
    pub kind: Kind,
    /// Identifier, such as `H26-Z`.
    pub ident: Text<6>,
}

/// One route of a procedure: a transition, or the final part with the missed approach.
#[derive(Debug, Clone, PartialEq)]
pub struct Route {
    /// Route type, column 20.
    pub route_type: u8,
    /// Transition; blank for the final part.
    pub transition: Text<5>,
    /// Legs in the order of the file.
    pub legs: Vec<Leg>,
    /// Lines of this route that were refused: it is not whole.
    pub refused: Vec<usize>,
    /// Where the file's record numbers leave records out.
    pub gaps: Vec<Gap>,
}

/// Records that the file's record numbers (columns 124 to 128) leave out between two records of one procedure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Gap {
    /// Line of the record after them.
    pub line: usize,
    /// How many.
    pub n_missing: u32,
    /// Whether the record before them is of the same route, which is then not whole. Between two routes the missing records may be a route.
    pub inside: bool,
}

/// A line of minima: level of service `A` with its RNP.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LevelOfService {
    /// Line in the file.
    pub line: usize,
    /// RNP \[m\].
    pub rnp_m: f64,
}

/// A procedure with its routes.
#[derive(Debug, Clone, PartialEq)]
pub struct Procedure {
    /// Which.
    pub name: ProcedureName,
    /// Line of its first record.
    pub line: usize,
    /// Routes in the order of the file.
    pub routes: Vec<Route>,
    /// Lines of minima, in the order of the file.
    pub levels: Vec<LevelOfService>,
}

/// One leg.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Leg {
    /// Line in the file.
    pub line: usize,
    /// Sequence number.
    pub sequence: i32,
    /// Fix at which it ends or from which it goes; blank where it has none.
    pub fix: FixName,
    /// Waypoint description code, four characters.
    pub description: Text<4>,
    /// `L`, `R` or blank.
    pub turn: u8,
    /// RNP \[m\].
    pub rnp_m: Option<f64>,
    /// Path terminator; blank in a record that has none.
    pub terminator: Text<2>,
    /// Recommended navaid.
    pub navaid: FixName,
    /// Radius of an RF leg \[m\].
    pub radius_m: Option<f64>,
    /// Bearing from the navaid; the inbound course of an RF leg \[rad\].
    pub theta_rad: Option<f64>,
    /// Distance from the navaid \[m\].
    pub rho_m: Option<f64>,
    /// Course; the outbound course of an RF leg, the boundary radial of an AF leg.
    pub course: Option<Course>,
    /// Course as written.
    pub course_text: Text<4>,
    /// Distance or time.
    pub extent: Option<Extent>,
    /// Distance or time as written.
    pub extent_text: Text<4>,
    /// Altitude description.
    pub altitude_description: u8,
    /// Altitudes as written.
    pub altitude_text: [Text<5>; 2],
    /// Altitudes \[m\]; a flight level is one of pressure.
    pub altitude_m: [Option<f64>; 2],
    /// Transition altitude as written.
    pub transition_altitude_text: Text<5>,
    /// Speed limit \[kt\].
    pub speed_kt: Option<f64>,
    /// `-` at or below, `+` at or above, blank at.
    pub speed_description: u8,
    /// Vertical angle, negative down \[rad\].
    pub vertical_angle_rad: Option<f64>,
    /// Centre of an RF leg, or the fix of the sector altitude.
    pub centre: FixName,
    /// Route qualifiers, columns 119 and 120.
    pub qualifiers: Text<2>,
}

impl Leg {
    /// Whether the aircraft must pass over the fix.
    pub fn fly_over(&self) -> bool {
        matches!(self.description.as_str().as_bytes().get(1), Some(b'Y' | b'B'))
    }
    /// Whether the missed approach begins with it.
    pub fn begins_missed(&self) -> bool {
        self.description.as_str().as_bytes().get(2) == Some(&b'M')
    }
    /// Role of the fix, the last character of the description: `F` final approach fix, `M` missed approach point.
    pub fn role(&self) -> u8 {
        self.description.as_str().as_bytes().get(3).copied().unwrap_or(b' ')
    }
}

/// The path point of an approach with vertical guidance from a satellite-based augmentation system.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathPoint {
    /// Line of the primary record.
    pub line: usize,
    /// Airport.
    pub airport: Text<4>,
    /// Approach.
    pub approach: Text<6>,
    /// Runway, such as `RW08`.
    pub runway: Text<5>,
    /// Landing threshold point.
    pub threshold: LatLon,
    /// Its height above the ellipsoid \[m\].
    pub ellipsoid_height_m: Option<f64>,
    /// Its height above mean sea level, of the continuation record \[m\].
    pub orthometric_height_m: Option<f64>,
    /// Line of the continuation record.
    pub continuation_line: Option<usize>,
    /// Flight path alignment point.
    pub alignment: Option<LatLon>,
    /// Glide path angle \[rad\].
    pub glide_angle_rad: Option<f64>,
    /// Course width at the threshold \[m\].
    pub course_width_m: Option<f64>,
    /// Horizontal and vertical alert limit \[m\].
    pub alert_limits_m: [Option<f64>; 2],
}
