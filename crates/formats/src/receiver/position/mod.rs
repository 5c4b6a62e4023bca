//! Positions that a receiver reports: messages of one epoch to one record.
//!
//! [`Decoder`] takes frames one at a time and gives a [`Position`] when its epoch is complete; a stream and the reader of files ([`log::read`])
//! use the same. Which words of a receiver mean a measured position stands in [`crate::measured`].

mod accuracy;
mod dating;
mod datum;
mod decoder;
mod epoch;
pub mod log;
mod nmea;
mod novatel;
mod sbf;
mod sentence;
pub mod sign;
mod ubx;
mod witnesses;

pub use dating::Dated;
pub use datum::Datum;
pub use decoder::{Decoder, Item, Malformed};
pub use epoch::{Ends, MOST_MESSAGES, Message, State};
pub use nmea::Heard;
pub use witnesses::Near;

use crate::stream::Family;
use core::f64::consts::{FRAC_PI_2, TAU};
use navbound_core::quantity::GpsTime;
use navbound_core::solution::plausible::DILUTION;

/// A receiver's format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// u-blox: NAV-PVT with NAV-COV, NAV-DOP, NAV-PL and NAV-TIMEGPS of the same epoch.
    Ubx,
    /// Septentrio: PVTGeodetic or PVTCartesian with their covariance and DOP.
    Sbf,
    /// NovAtel: BESTPOS, binary or ASCII.
    Novatel,
    /// NMEA 0183: GGA with GST or GBS, dated by RMC or ZDA; RMC where no GGA comes.
    Nmea,
}

impl Kind {
    /// All, in the order in which a mixed log is read: covariances first.
    pub const ALL: [Self; 4] = [Self::Ubx, Self::Sbf, Self::Novatel, Self::Nmea];

    /// The id of commands and tables.
    pub const fn id(self) -> &'static str {
        match self {
            Self::Ubx => "ubx",
            Self::Sbf => "sbf",
            Self::Novatel => "novatel",
            Self::Nmea => "nmea",
        }
    }

    /// The kind of an id.
    pub fn of(id: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.id() == id)
    }

    /// Messages that hold its positions.
    pub const fn positions(self) -> &'static str {
        match self {
            Self::Ubx => "NAV-PVT",
            Self::Sbf => "PVTGeodetic or PVTCartesian",
            Self::Novatel => "BESTPOS",
            Self::Nmea => "GGA, or RMC where no GGA comes",
        }
    }

    /// Whether what begins with these bytes calls itself a message of a position, be it whole or not; `gga`: whether the log has a GGA.
    fn stands_at(self, bytes: &[u8], gga: bool) -> bool {
        match self {
            Self::Ubx => bytes.get(2..4) == Some(&[0x01, 0x07]),
            Self::Sbf => bytes.get(4..6).is_some_and(|id| [4006, 4007].contains(&(u16::from_le_bytes([id[0], id[1]]) & 0x1fff))),
            Self::Novatel => bytes.starts_with(b"#BESTPOSA") || bytes.get(4..6) == Some(&[42, 0]),
            Self::Nmea => bytes.get(3..6) == Some(if gga { b"GGA" } else { b"RMC" }),
        }
    }

    const fn family(self) -> Family {
        match self {
            Self::Ubx => Family::Ubx,
            Self::Sbf => Family::Sbf,
            Self::Novatel => Family::Novatel,
            Self::Nmea => Family::Nmea,
        }
    }
}

/// Why an epoch holds no position.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reason {
    /// The receiver does not know the time yet.
    TimeNotKnown,
    /// Date, time or leap seconds are not marked valid.
    TimeNotValid,
    /// Not a three-dimensional fix.
    NoFix3d,
    /// The receiver marks the position invalid.
    MarkedInvalid,
    /// Nothing was measured, by quality, mode or type.
    NotMeasured,
    /// Nothing was measured, by the quality of a sentence.
    NoFix,
    /// Another statement of the same epoch says that there is no such position.
    Contradicted,
    /// The message of the position itself counts fewer satellites than determine one. A log keeps its row, which is not
    /// used, as live.
    FewSatellites,
    /// The satellites hardly determine the position, by its own dilution.
    Dilution,
    /// Second 60 on a day that had none.
    NoSuchLeapSecond,
    /// Nowhere on Earth, or at no time.
    OutsideDomain,
}

impl Reason {
    /// The id of tables.
    pub const fn id(self) -> &'static str {
        match self {
            Self::TimeNotKnown => "time_not_known",
            Self::TimeNotValid => "time_not_valid",
            Self::NoFix3d => "no_3d_fix",
            Self::MarkedInvalid => "marked_invalid",
            Self::NotMeasured => "no_position",
            Self::NoFix => "no_fix",
            Self::Contradicted => "contradicted",
            Self::FewSatellites => "few_satellites",
            Self::Dilution => "implausible_dilution",
            Self::NoSuchLeapSecond => "no_such_leap_second",
            Self::OutsideDomain => "outside_domain",
        }
    }

    /// Whether a sound receiver never writes it.
    pub const fn damaged(self) -> bool {
        matches!(self, Self::NoSuchLeapSecond | Self::OutsideDomain)
    }
}

/// Why there is no position, with the fields that say so.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Absent {
    /// Why.
    pub reason: Reason,
    /// Fields and their values.
    pub stated: String,
}

impl Absent {
    /// Whether it takes the position away; few satellites do not, for some receivers always count none.
    fn takes_away(&self) -> bool {
        self.reason != Reason::FewSatellites
    }
}

/// A doubt that a person should settle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Note {
    /// The covariance is circular, of NAV-PVT's accuracies.
    CircularCovariance,
    /// The expected errors of GBS stand for standard deviations.
    ExpectedErrors,
    /// The error of PGRME, which states no share, stands for the standard deviation of each axis.
    ErrorOfNoShare,
    /// Standard deviations without correlations.
    Uncorrelated,
    /// A stated accuracy worse than the covariance beside it; the covariance was enlarged to it.
    WorseAccuracy,
    /// The expected errors of GBS are worse than GST beside them; the covariance was enlarged to them.
    WorseExpectedErrors,
    /// A datum that is not WGS-84.
    Datum(u8),
    /// The misleading-information risk of protection levels, coefficient and power of ten an hour.
    RiskOfLevels(u8, i8),
    /// An altitude without the separation of the geoid.
    NoSeparation,
    /// Positions of RMC, which states nothing of how good they are.
    OfRmc,
}

impl Note {
    /// The id of tables, and its numbers.
    pub const fn id(self) -> (&'static str, [i32; 2]) {
        match self {
            Self::CircularCovariance => ("circular_covariance", [0, 0]),
            Self::ExpectedErrors => ("expected_errors", [0, 0]),
            Self::ErrorOfNoShare => ("error_of_no_share", [0, 0]),
            Self::Uncorrelated => ("uncorrelated", [0, 0]),
            Self::WorseAccuracy => ("worse_accuracy", [0, 0]),
            Self::WorseExpectedErrors => ("worse_expected_errors", [0, 0]),
            Self::Datum(datum) => ("datum", [datum as i32, 0]),
            Self::RiskOfLevels(coefficient, exponent) => ("risk_of_levels", [coefficient as i32, exponent as i32]),
            Self::NoSeparation => ("no_separation", [0, 0]),
            Self::OfRmc => ("of_rmc", [0, 0]),
        }
    }

    /// Whether what it doubts is only a substitute.
    const fn of_substitute(self) -> bool {
        matches!(self, Self::CircularCovariance | Self::ExpectedErrors | Self::ErrorOfNoShare)
    }
}

/// Quantities and the message fields that they were read from.
pub type Fields = &'static [(&'static str, &'static str)];

/// One epoch: what its messages state. What they do not state is `None`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Position {
    /// Number of the message that holds the position.
    pub record: u64,
    /// Time of applicability.
    pub time: Option<GpsTime>,
    /// Time of day of a sentence, until a date makes it a time.
    pub of_day: Option<OfDay>,
    /// Latitude \[rad\].
    pub lat_rad: Option<f64>,
    /// Longitude \[rad\].
    pub lon_rad: Option<f64>,
    /// Height above the ellipsoid \[m\].
    pub h_m: Option<f64>,
    /// Covariance ee, en, nn, eu, nu, uu \[m²\].
    pub covariance_m2: Option<[f64; 6]>,
    /// Speed over ground \[m/s\].
    pub ground_speed_mps: Option<f64>,
    /// Track over ground from true north \[rad\].
    pub ground_track_rad: Option<f64>,
    /// Vertical rate, up \[m/s\].
    pub vertical_rate_mps: Option<f64>,
    /// Satellites of the solution.
    pub n_sv: Option<u32>,
    /// Horizontal dilution of precision.
    pub hdop: Option<f64>,
    /// Vertical dilution of precision.
    pub vdop: Option<f64>,
    /// Dilution of precision of the position.
    pub pdop: Option<f64>,
    /// Horizontal protection level \[m\].
    pub hpl_m: Option<f64>,
    /// Vertical protection level \[m\].
    pub vpl_m: Option<f64>,
    /// Why this is no position.
    pub absent: Option<Absent>,
    /// What position and time were read from.
    pub fields: Fields,
    /// What the covariance was read from.
    pub covariance_from: Option<&'static str>,
    /// Accuracy that sentences of another time state \[m\].
    pub unread_accuracy_m: Option<f64>,
    /// What the protection levels were read from.
    pub levels_from: Fields,
    /// Doubts.
    pub notes: [Option<Note>; 2],
}

/// A time of day \[ns\] in which every minute counts 61 seconds, so that a leap second has a place of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OfDay(pub i64);

/// Limits of every reader of positions \[m\]. Provenance: ours.
const LOWEST_M: f64 = -20_000.0;
const HIGHEST_M: f64 = 1e8;
/// GPS time that no log can hold: 2106 and later.
const LATEST_NS: i64 = 4_000_000_000_000_000_000;

impl Position {
    fn none(record: u64, reason: Reason, stated: String) -> Self {
        Self { record, absent: Some(Absent { reason, stated }), ..Self::default() }
    }

    /// Whether it is a sentence's, and no date has made a time of its time of day.
    const fn awaits_date(&self) -> bool {
        self.time.is_none() && self.of_day.is_some()
    }

    /// Whether nothing takes the position away.
    fn stands(&self) -> bool {
        !self.absent.as_ref().is_some_and(Absent::takes_away)
    }

    /// The position, or none where it lies nowhere or at no time, as whole messages with wrong contents give it.
    fn checked(mut self) -> Self {
        let on_earth = self.lat_rad.is_some_and(|lat| lat.abs() <= FRAC_PI_2) && self.lon_rad.is_some_and(|lon| lon.abs() <= TAU);
        // A receiver that has no position yet writes zeros; no track stands on that point to the last bit.
        let on_earth = on_earth && (self.lat_rad, self.lon_rad) != (Some(0.0), Some(0.0));
        let height = self.h_m.is_none_or(|h| h > LOWEST_M && h < HIGHEST_M);
        // A week beyond every time gives none.
        let dated = self.time.map_or(self.of_day.is_some(), |time| (0..LATEST_NS).contains(&time.nanoseconds()));
        if self.stands() && !(on_earth && height && dated) {
            let time_ns = self.time.map(GpsTime::nanoseconds);
            let stated = format!("lat_rad {:?}, lon_rad {:?}, h_m {:?}, time_ns {time_ns:?}", self.lat_rad, self.lon_rad, self.h_m);
            self.absent = Some(Absent { reason: Reason::OutsideDomain, stated });
        }
        if !dated {
            self.time = None;
        }
        // Receivers write 99.99 where they know none.
        let dilution = [self.pdop, self.hdop, self.vdop].into_iter().flatten().fold(0.0, f64::max);
        if self.stands() && dilution > DILUTION {
            self.absent = Some(Absent { reason: Reason::Dilution, stated: format!("dilution {dilution}") });
        }
        self
    }
}

/// Covariance of standard deviations whose correlations are not known \[m²\].
fn uncorrelated(east_m: f64, north_m: f64, up_m: f64) -> [f64; 6] {
    [east_m * east_m, 0.0, north_m * north_m, 0.0, 0.0, up_m * up_m]
}

/// Ratio of variances up to which two statements of one epoch say the same: a tenth of the deviation. Provenance: ours \[1\].
const SAME: f64 = 1.21;

/// A covariance, enlarged where another statement of the same epoch is worse, and whether it was.
fn no_better(own: [f64; 6], beside: Option<[f64; 6]>) -> ([f64; 6], bool) {
    let [ee, en, nn, eu, nu, uu] = own;
    let Some([east, _, north, _, _, up]) = beside else { return (own, false) };
    let factor = |stated: f64, own: f64| if own > 0.0 && stated > SAME * own { stated / own } else { 1.0 };
    let (h, v) = (factor(east + north, ee + nn), factor(up, uu));
    let both = libm::sqrt(h * v);
    ([ee * h, en * h, nn * h, eu * both, nu * both, uu * v], h > 1.0 || v > 1.0)
}

#[cfg(test)]
mod tests;
