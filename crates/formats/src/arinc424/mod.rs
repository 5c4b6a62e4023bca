//! Navigation databases of ARINC 424: fixed columns, 132 characters a line, nine record kinds.
//!
//! Source: FAA Coded Instrument Flight Procedures, cycle 2604 (columns read from its records and compared with an independent reader);
//! ARINC 424-18 for the names of the fields; provenance: standard. Other supplements moved some columns: UNKNOWN.
//!
//! A line that is cut, too long or wrong in a field is refused with its number and the reason, and the route it belongs to is marked as
//! not whole. Record kinds that are not read are counted.

mod check;
mod field;
mod geometry;
mod insert;
mod lines;
mod record;
mod requirement;

pub use check::{Contradiction, Finding};
pub use field::{Course, Extent, Text};
pub use geometry::{Part, PathOfProcedure, ProcedureLeg};
pub use record::{Airport, Fix, FixName, Gap, Kind, Leg, LevelOfService, PathPoint, Procedure, ProcedureName, Route, Runway};
pub use requirement::{LegRequirement, Origin};

use crate::refusal::{Refusal, Unreadable};
use field::{Fault, Record};
use flate2::bufread::MultiGzDecoder;
use lines::{Line, Lines};
use std::collections::HashMap;
use std::io::{self, BufRead, BufReader};

/// Characters of a record \[1\].
pub const WIDTH: usize = 132;
/// Refused lines of which line and reason are kept; beyond, they are counted \[1\].
const KEPT_REFUSALS: usize = 10_000;
/// Header lines kept \[1\].
const KEPT_HEADER: usize = 20;
/// Size of one reading step \[bytes\].
const STEP: usize = 1 << 18;

/// The name of a fix with the scope that makes it unique: its airport or its region.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
struct FixKey {
    section: Text<2>,
    scope: Text<4>,
    ident: Text<5>,
}

/// A file's records.
#[derive(Debug, Clone, Default)]
pub struct Database {
    /// The first header lines.
    pub header: Vec<String>,
    /// Lines in the file.
    pub n_lines: usize,
    /// Records of each kind that is read, continuations included.
    pub counts: Counts,
    /// Refused lines with their reason, the first ten thousand.
    pub refused: Vec<Refusal>,
    /// Refused lines in all.
    pub n_refused: usize,
    /// Refused lines of procedures that name no route: some route is not whole, nobody knows which.
    pub n_unattributed: usize,
    airports: HashMap<Text<4>, Airport>,
    fixes: HashMap<FixKey, Fix>,
    runways: HashMap<(Text<4>, Text<5>), Runway>,
    procedures: Vec<Procedure>,
    by_name: HashMap<ProcedureName, usize>,
    path_points: Vec<PathPoint>,
    numbering: insert::Numbering,
}

/// Records by kind.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counts {
    /// P A.
    pub airports: usize,
    /// P C.
    pub terminal_waypoints: usize,
    /// P G.
    pub runways: usize,
    /// P D.
    pub sids: usize,
    /// P E.
    pub stars: usize,
    /// P F.
    pub approaches: usize,
    /// P P.
    pub path_points: usize,
    /// E A.
    pub enroute_waypoints: usize,
    /// D.
    pub vhf_navaids: usize,
    /// D B and P N.
    pub ndbs: usize,
    /// Records of kinds that are not read.
    pub others: usize,
}

/// Read a database, plain or packed by gzip, without keeping its text.
///
/// # Errors
/// [`Unreadable`] for a source that fails, a damaged packing, and a file without one record of ARINC 424.
pub fn read(source: impl BufRead) -> Result<Database, Unreadable> {
    let mut source = source;
    let packed = source.fill_buf().map_err(|e| failed(&e))?.starts_with(&[0x1f, 0x8b]);
    if packed { plain(BufReader::with_capacity(STEP, MultiGzDecoder::new(source))) } else { plain(source) }
}

/// Read a file, see [`read`].
///
/// # Errors
/// As there, and for a file that cannot be opened.
pub fn read_file(path: &std::path::Path) -> Result<Database, Unreadable> {
    let file = std::fs::File::open(path).map_err(|e| failed(&e))?;
    read(BufReader::with_capacity(STEP, file))
}

fn failed(e: &io::Error) -> Unreadable {
    Unreadable::whole(format!("the file cannot be read: {e}"))
}

fn plain(source: impl BufRead) -> Result<Database, Unreadable> {
    let (mut lines, mut database) = (Lines::new(source), Database::default());
    let mut known = 0_usize;
    while let Some(line) = lines.next().map_err(|e| failed(&e))? {
        database.n_lines = line.number;
        known += usize::from(database.take(&line));
    }
    if known == 0 {
        return Err(Unreadable::whole("no record of ARINC 424: lines of 132 characters that begin with S or T"));
    }
    database.settle_numbering();
    Ok(database)
}

impl Database {
    /// Takes one line; whether it is a record.
    fn take(&mut self, line: &Line<'_>) -> bool {
        if line.length == 0 {
            return false;
        }
        if line.text.starts_with(b"HDR") {
            if self.header.len() < KEPT_HEADER {
                self.header.push(String::from_utf8_lossy(line.text).trim_end().to_owned());
            }
            return false;
        }
        let record = Record(line.text);
        let fault = |reason| Fault { field: "record", reason, text: shown(line.text) };
        let result = if line.length != WIDTH {
            Err(fault("not 132 characters long"))
        } else if !line.text.is_ascii() || line.text.iter().any(u8::is_ascii_control) {
            Err(fault("characters that are not printable ASCII"))
        } else if !matches!(line.text[0], b'S' | b'T') {
            Err(fault("neither a header nor a standard (S) nor a tailored (T) record"))
        } else {
            self.insert(line.number, record)
        };
        match result {
            Ok(()) => self.number(line.number, record),
            Err(_) => self.numbering.forget(),
        }
        result.map_err(|fault| self.refuse(line.number, record, fault)).is_ok()
    }

    fn refuse(&mut self, number: usize, record: Record<'_>, fault: Fault) {
        self.n_refused += 1;
        self.mark_route(number, record);
        if self.refused.len() < KEPT_REFUSALS {
            self.refused.push(Refusal { line: number, field: fault.field.to_owned(), reason: fault.reason.to_owned(), text: fault.text });
        }
    }

    /// Procedures in the order of the file.
    pub fn procedures(&self) -> &[Procedure] {
        &self.procedures
    }
    /// One procedure.
    pub fn procedure(&self, name: &ProcedureName) -> Option<&Procedure> {
        self.by_name.get(name).and_then(|i| self.procedures.get(*i))
    }
    /// One airport.
    pub fn airport(&self, ident: &str) -> Option<&Airport> {
        self.airports.get(&Text::new(ident))
    }
    /// Runway of an airport, such as `RW08`.
    pub fn runway(&self, airport: Text<4>, ident: Text<5>) -> Option<&Runway> {
        self.runways.get(&(airport, ident))
    }
    /// Path points in the order of the file.
    pub fn path_points(&self) -> &[PathPoint] {
        &self.path_points
    }

    /// The fix that a leg of a procedure at an airport names; None where the file has none.
    pub fn fix(&self, airport: Text<4>, name: &FixName) -> Option<Fix> {
        if name.section.as_str() == "PA" {
            let a = self.airports.get(&Text::new(name.ident.as_str()))?;
            return Some(Fix { line: a.line, place: a.place, variation_rad: a.variation_rad, ambiguous: false });
        }
        self.fixes.get(&FixKey::new(airport, name)).copied()
    }
}

impl FixKey {
    fn new(airport: Text<4>, name: &FixName) -> Self {
        let terminal = name.section.as_str().starts_with('P');
        Self { section: name.section, scope: if terminal { airport } else { Text::new(name.region.as_str()) }, ident: name.ident }
    }
}

fn shown(text: &[u8]) -> String {
    String::from_utf8_lossy(&text[..text.len().min(60)]).into_owned()
}

#[cfg(test)]
mod tests;
