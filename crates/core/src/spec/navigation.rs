//! Which lateral accuracy a navigation specification asks for in a phase of flight.

use super::Phase;
use crate::quantity::{Metres, Provenance, Risk};

/// One cell of the table: a specification in one phase.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Specification {
    /// The specification, e.g. `RNP APCH`.
    pub name: &'static str,
    /// The phase of flight.
    pub phase: Phase,
    /// Smallest lateral accuracy (95 %) that may be chosen; equal to the largest unless the specification gives a range.
    pub accuracy_least: Metres,
    /// Largest lateral accuracy that may be chosen.
    pub accuracy_most: Metres,
    /// Whether the specification asks for monitoring and alerting on board: RNP does, RNAV does not.
    pub monitored: bool,
    /// Document.
    pub source: &'static str,
    /// How we hold the row.
    pub provenance: Provenance,
}

impl Specification {
    /// Risk that goes with the accuracy.
    pub const ACCURACY_RISK: Risk = Risk::ACCURACY;
    /// Risk that goes with the containment limit.
    pub const CONTAINMENT_RISK: Risk = Risk::INTEGRITY;

    /// The containment limit for a chosen accuracy: twice it, where the specification is monitored.
    pub fn containment(&self, accuracy: Metres) -> Option<Metres> {
        self.monitored.then(|| Metres::new(2.0 * accuracy.m()))
    }
}

/// The cell of a specification and a phase; `None` where the table is empty.
pub fn specification(name: &str, phase: Phase) -> Option<&'static Specification> {
    SPECIFICATIONS.iter().find(|s| s.name == name && s.phase == phase)
}

const FU: &str = "Fu, Zhang and Li 2014, Table 1";
const OSTROUMOV: &str = "named by Ostroumov and Kuzmenko 2018; phases and values: ICAO Doc 9613, which was not read";
const PBN_MANUAL: &str = "ICAO Doc 9613, which was not read";

const fn printed(name: &'static str, phase: Phase, least_nm: f64, most_nm: f64) -> Specification {
    Specification { source: FU, provenance: Provenance::Printed, ..cell(name, phase, least_nm, most_nm, true) }
}
const fn rnp(name: &'static str, phase: Phase, least_nm: f64, most_nm: f64) -> Specification {
    cell(name, phase, least_nm, most_nm, true)
}
const fn named(name: &'static str, phase: Phase, nm: f64, monitored: bool) -> Specification {
    Specification { source: OSTROUMOV, ..cell(name, phase, nm, nm, monitored) }
}
const fn cell(name: &'static str, phase: Phase, least_nm: f64, most_nm: f64, monitored: bool) -> Specification {
    Specification {
        name,
        phase,
        accuracy_least: Metres::nautical_miles(least_nm),
        accuracy_most: Metres::nautical_miles(most_nm),
        monitored,
        source: PBN_MANUAL,
        provenance: Provenance::Inferred,
    }
}

/// The table, specification by specification.
pub const SPECIFICATIONS: &[Specification] = &[
    printed("RNP 4", Phase::EnRouteOceanic, 4.0, 4.0),
    printed("RNP 1", Phase::Arrival, 1.0, 1.0),
    printed("RNP 1", Phase::Initial, 1.0, 1.0),
    printed("RNP 1", Phase::Intermediate, 1.0, 1.0),
    printed("RNP 1", Phase::Missed, 1.0, 1.0),
    printed("RNP 1", Phase::Departure, 1.0, 1.0),
    printed("RNP APCH", Phase::Initial, 1.0, 1.0),
    printed("RNP APCH", Phase::Intermediate, 1.0, 1.0),
    printed("RNP APCH", Phase::Final, 0.3, 0.3),
    printed("RNP APCH", Phase::Missed, 1.0, 1.0),
    printed("RNP AR APCH", Phase::Initial, 0.1, 1.0),
    printed("RNP AR APCH", Phase::Intermediate, 0.1, 1.0),
    printed("RNP AR APCH", Phase::Final, 0.1, 0.3),
    printed("RNP AR APCH", Phase::Missed, 0.1, 1.0),
    named("RNAV 10", Phase::EnRouteOceanic, 10.0, false),
    named("RNAV 5", Phase::EnRouteContinental, 5.0, false),
    named("RNAV 5", Phase::Arrival, 5.0, false),
    named("RNAV 2", Phase::EnRouteContinental, 2.0, false),
    named("RNAV 2", Phase::Arrival, 2.0, false),
    named("RNAV 2", Phase::Departure, 2.0, false),
    named("RNAV 1", Phase::EnRouteContinental, 1.0, false),
    named("RNAV 1", Phase::Arrival, 1.0, false),
    named("RNAV 1", Phase::Initial, 1.0, false),
    named("RNAV 1", Phase::Intermediate, 1.0, false),
    named("RNAV 1", Phase::Missed, 1.0, false),
    named("RNAV 1", Phase::Departure, 1.0, false),
    named("RNP 2", Phase::EnRouteOceanic, 2.0, true),
    named("RNP 2", Phase::EnRouteContinental, 2.0, true),
    rnp("RNP 0.3", Phase::EnRouteContinental, 0.3, 0.3),
    rnp("RNP 0.3", Phase::Arrival, 0.3, 0.3),
    rnp("RNP 0.3", Phase::Initial, 0.3, 0.3),
    rnp("RNP 0.3", Phase::Intermediate, 0.3, 0.3),
    rnp("RNP 0.3", Phase::Missed, 0.3, 0.3),
    rnp("RNP 0.3", Phase::Departure, 0.3, 0.3),
    rnp("A-RNP", Phase::EnRouteOceanic, 2.0, 2.0),
    rnp("A-RNP", Phase::EnRouteContinental, 1.0, 2.0),
    rnp("A-RNP", Phase::Arrival, 0.3, 1.0),
    rnp("A-RNP", Phase::Initial, 0.3, 1.0),
    rnp("A-RNP", Phase::Intermediate, 0.3, 1.0),
    rnp("A-RNP", Phase::Final, 0.3, 0.3),
    rnp("A-RNP", Phase::Missed, 0.3, 1.0),
    rnp("A-RNP", Phase::Departure, 0.3, 1.0),
];
