//! Places of the numbers of a Keplerian record, counted from the first of its first line: one table for the reader and the writer.
//!
//! Source: RINEX 3.05, tables A6 (GPS) and A8 (Galileo); standard.

/// Bias; drift and its rate follow. The issue of the orbit comes after them.
pub(super) const ISSUE: usize = 3;
pub(super) const CRS: usize = 4;
pub(super) const DELTA_N: usize = 5;
pub(super) const MEAN_ANOMALY: usize = 6;
pub(super) const CUC: usize = 7;
pub(super) const ECCENTRICITY: usize = 8;
pub(super) const CUS: usize = 9;
pub(super) const SQRT_A: usize = 10;
/// Reference time within its week \[s\].
pub(super) const ORBIT_TIME: usize = 11;
pub(super) const CIC: usize = 12;
pub(super) const NODE: usize = 13;
pub(super) const CIS: usize = 14;
pub(super) const INCLINATION: usize = 15;
pub(super) const CRC: usize = 16;
pub(super) const PERIGEE: usize = 17;
pub(super) const NODE_RATE: usize = 18;
pub(super) const INCLINATION_RATE: usize = 19;
/// Codes on L2 (GPS), data sources (Galileo).
pub(super) const SOURCES: usize = 20;
pub(super) const WEEK: usize = 21;
pub(super) const ACCURACY: usize = 23;
pub(super) const HEALTH: usize = 24;
/// TGD, or BGD of E5a.
pub(super) const DELAY: usize = 25;
/// Issue of the clock (GPS), or BGD of E5b.
pub(super) const DELAY_OR_ISSUE: usize = 26;
/// Time of transmission within its week \[s\].
pub(super) const SENT: usize = 27;
/// Fit interval (GPS) \[h\].
pub(super) const FIT: usize = 28;
/// All of them.
pub(super) const NUMBERS: usize = 29;

/// Columns of a number, and its decimals.
pub(super) const WIDTH: usize = 19;
pub(super) const DECIMALS: usize = 12;
/// Columns of an observation without its two indicators, and its decimals.
pub(super) const VALUE_WIDTH: usize = 14;
pub(super) const VALUE_DECIMALS: usize = 3;
