//! What the operations of satellite navigation ask of protection levels, accuracy, integrity and continuity.

use crate::quantity::{Metres, Provenance, Risk};

/// An exposure a risk is stated for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Per {
    /// One approach.
    Approach,
    /// Fifteen seconds.
    FifteenSeconds,
    /// An hour of flight.
    Hour,
}

impl Per {
    /// The words of tables.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Approach => "approach",
            Self::FifteenSeconds => "15 s",
            Self::Hour => "hour",
        }
    }
}

/// A level of service: limits, and the risks it allows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ServiceLevel {
    /// Name, as users choose it.
    pub id: &'static str,
    /// The operation.
    pub title: &'static str,
    /// Horizontal alert limit.
    pub hal: Metres,
    /// Vertical alert limit, where the operation has one.
    pub val: Option<Metres>,
    /// Horizontal accuracy, 95 %.
    pub accuracy_h: Metres,
    /// Vertical accuracy, 95 %.
    pub accuracy_v: Option<Metres>,
    /// Time to alert \[s\].
    pub time_to_alert_s: f64,
    /// Integrity risk and its exposure.
    pub integrity: (Risk, Per),
    /// Largest continuity risk the operation allows, and its exposure.
    pub continuity: (Risk, Per),
    /// Document of the alert limits.
    pub limits_source: &'static str,
    /// How we hold them.
    pub limits: Provenance,
    /// Document of everything else.
    pub rest_source: &'static str,
    /// How we hold it.
    pub rest: Provenance,
}

const LIMITS: &str = "ICAO Annex 10 volume I, table 3.7.2.4-1 note 2 (pages of 23/11/06, reproduced at aero.cn 2010/0718/10768_58); the same in ICAO Doc 9849, 5th edition, table 2-1 (as the claims of SBAS Lab quote it), and but for oceanic in Satellite Navigation 1 (2020), doi 10.1186/s43020-020-00010-2, table 1";
/// LPV-200 is younger than the pages of 2006: the newer edition gives category I a range from 35 m.
const LPV_200: &str = "ICAO Doc 9849, 5th edition, table 2-1 and 4.3.3.3 (as the claims of SBAS Lab quote it); Satellite Navigation 1 (2020), doi 10.1186/s43020-020-00010-2, table 1; FAA, WAAS and LAAS program status (GPS.gov)";
const REST: &str = "accuracy, integrity, continuity: Satellite Navigation 1 (2020), doi 10.1186/s43020-020-00010-2, table 1; time to alert: ICAO Doc 9849, 5th edition, table 2-1 (as the claims of SBAS Lab quote it); one public text each";
const PAPER: &str = "Vassilev and Vassileva 2012; not a value of the standard";

const fn en_route(id: &'static str, title: &'static str, hal_m: f64, accuracy_m: f64, time_to_alert_s: f64) -> ServiceLevel {
    ServiceLevel {
        id,
        title,
        hal: Metres::new(hal_m),
        val: None,
        accuracy_h: Metres::new(accuracy_m),
        accuracy_v: None,
        time_to_alert_s,
        integrity: (Risk::HOUR_INTEGRITY, Per::Hour),
        continuity: (Risk::HOUR_CONTINUITY, Per::Hour),
        limits_source: LIMITS,
        limits: Provenance::Standard,
        rest_source: REST,
        rest: Provenance::Inferred,
    }
}

const fn approach(id: &'static str, title: &'static str, val_m: f64, accuracy_v_m: f64, time_to_alert_s: f64) -> ServiceLevel {
    ServiceLevel {
        id,
        title,
        hal: Metres::new(40.0),
        val: Some(Metres::new(val_m)),
        accuracy_h: Metres::new(16.0),
        accuracy_v: Some(Metres::new(accuracy_v_m)),
        time_to_alert_s,
        integrity: (Risk::APPROACH_INTEGRITY, Per::Approach),
        continuity: (Risk::APPROACH_CONTINUITY, Per::FifteenSeconds),
        limits_source: LIMITS,
        limits: Provenance::Standard,
        rest_source: REST,
        rest: Provenance::Inferred,
    }
}

/// The table, loosest first. Of the ranges that the standard gives for category I, the strict ends.
pub const SERVICE_LEVELS: &[ServiceLevel] = &[
    en_route("oceanic", "en route, oceanic", 7400.0, 3700.0, 300.0),
    en_route("en-route", "en route, continental", 3700.0, 3700.0, 300.0),
    en_route("terminal", "terminal area", 1850.0, 740.0, 15.0),
    en_route("NPA", "non-precision approach", 556.0, 220.0, 10.0),
    approach("APV-I", "approach with vertical guidance I", 50.0, 20.0, 10.0),
    ServiceLevel { limits_source: LPV_200, ..approach("LPV-200", "localizer performance with vertical guidance, 200 ft", 35.0, 4.0, 6.0) },
    approach("APV-II", "approach with vertical guidance II", 20.0, 8.0, 6.0),
    approach("CAT-I", "category I, strict end of VAL 15 to 10 m", 10.0, 4.0, 6.0),
    ServiceLevel {
        limits_source: PAPER,
        limits: Provenance::Printed,
        ..approach("CAT-I-12", "category I with the VAL of a paper, 12 m", 12.0, 4.0, 6.0)
    },
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_limits_tighten_down_the_table() {
        for (i, level) in SERVICE_LEVELS.iter().enumerate() {
            assert!(SERVICE_LEVELS[..i].iter().all(|l| l.id != level.id));
            assert!(SERVICE_LEVELS[..i].iter().all(|l| l.hal.m() >= level.hal.m()));
            assert_eq!(level.val.is_some(), level.accuracy_v.is_some());
        }
    }
}
