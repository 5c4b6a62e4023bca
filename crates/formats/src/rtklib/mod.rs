//! RTKLIB solution files (`.pos`): positions with their covariance.
//!
//! Source: the program's own writer as its documentation describes it (RTKLIB 2.4.3 manual, appendix B.1 "positioning solution file"):
//! comment lines begin with `%`, the last one before the data names the columns. Covariances are written as signed roots: `sdne` is
//! `sign(c) sqrt(|c|)`.

mod header;
mod row;
mod write;

pub use header::{Form, Layout};
pub use write::write;

use crate::refusal::{Refusal, Unreadable};
use navbound_core::quantity::GpsTime;

/// The rows of a solution file, one array a column.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Solutions {
    /// Line of each row, from 1.
    pub line: Vec<usize>,
    /// Time of each position.
    pub time: Vec<GpsTime>,
    /// Latitude \[rad\].
    pub lat_rad: Vec<f64>,
    /// Longitude \[rad\].
    pub lon_rad: Vec<f64>,
    /// Height above the ellipsoid \[m\].
    pub h_m: Vec<f64>,
    /// Covariance, east-north-up, as `[ee, en, nn, eu, nu, uu]` \[m²\]; NaN where the file gives none.
    pub cov_m2: Vec<[f64; 6]>,
    /// RTKLIB's quality flag: 1 fix, 2 float, 3 SBAS, 4 differential, 5 single, 6 PPP; 0 where the file gives none.
    pub quality: Vec<u8>,
    /// Whether the file has a column of qualities.
    pub states_quality: bool,
    /// Satellites in the solution; 0 where the file gives none.
    pub n_sv: Vec<u32>,
    /// Speed over the ground \[m/s\]; NaN where the file gives none.
    pub ground_speed_mps: Vec<f64>,
    /// Horizontal protection level \[m\]; NaN where the file gives none.
    pub hpl_m: Vec<f64>,
    /// Vertical protection level \[m\]; NaN where the file gives none.
    pub vpl_m: Vec<f64>,
    /// Rows not used.
    pub refused: Vec<Refusal>,
    /// Rows in the file, used or not.
    pub n_rows: usize,
}

/// Read a whole solution file.
///
/// # Errors
/// [`Unreadable`] when no header names the columns, or names none that hold a time and a position.
pub fn read(text: &str) -> Result<Solutions, Unreadable> {
    let layout = header::layout(text)?;
    let mut solutions = Solutions { states_quality: layout.quality.is_some(), ..Solutions::default() };
    for (index, content) in text.lines().enumerate() {
        if content.trim().is_empty() || content.trim_start().starts_with('%') {
            continue;
        }
        solutions.n_rows += 1;
        match row::parse(content, &layout) {
            Ok(row) => solutions.push(index + 1, &row),
            Err(fault) => solutions.refused.push(Refusal {
                line: index + 1,
                field: fault.field.to_owned(),
                reason: fault.reason.to_owned(),
                text: fault.text.chars().take(80).collect(),
            }),
        }
    }
    Ok(solutions)
}

impl Solutions {
    fn push(&mut self, line: usize, row: &row::Row) {
        self.line.push(line);
        self.time.push(row.time);
        self.lat_rad.push(row.lat);
        self.lon_rad.push(row.lon);
        self.h_m.push(row.h);
        self.cov_m2.push(row.covariance);
        self.quality.push(row.quality);
        self.n_sv.push(row.n_sv);
        self.ground_speed_mps.push(row.ground_speed);
        self.hpl_m.push(row.levels[0]);
        self.vpl_m.push(row.levels[1]);
    }
}
