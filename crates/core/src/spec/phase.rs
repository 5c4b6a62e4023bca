//! Phases of flight, and how soon the crew must know.

use crate::quantity::Provenance;

/// A phase of flight: a column of the table of navigation specifications.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// En route, oceanic or remote.
    EnRouteOceanic,
    /// En route, continental.
    EnRouteContinental,
    /// Arrival.
    Arrival,
    /// Initial approach.
    Initial,
    /// Intermediate approach.
    Intermediate,
    /// Final approach.
    Final,
    /// Missed approach.
    Missed,
    /// Departure.
    Departure,
}

/// Every phase, in the order of a flight.
pub const PHASES: [Phase; 8] = [
    Phase::EnRouteOceanic,
    Phase::EnRouteContinental,
    Phase::Arrival,
    Phase::Initial,
    Phase::Intermediate,
    Phase::Final,
    Phase::Missed,
    Phase::Departure,
];

/// How long the crew may be left without a warning, and where that comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimeToAlert {
    /// The operation the standard names.
    pub operation: &'static str,
    /// Seconds from the fault to the crew.
    pub seconds: f64,
    /// Document.
    pub source: &'static str,
    /// How we hold the number for this phase.
    pub provenance: Provenance,
}

const SOURCE: &str = "ICAO Doc 9849, 5th edition, table 2-1 (as the claims of SBAS Lab quote it); one public text";

impl Phase {
    /// The word of tables and configuration.
    pub const fn word(self) -> &'static str {
        match self {
            Self::EnRouteOceanic => "en_route_oceanic",
            Self::EnRouteContinental => "en_route_continental",
            Self::Arrival => "arrival",
            Self::Initial => "initial",
            Self::Intermediate => "intermediate",
            Self::Final => "final",
            Self::Missed => "missed",
            Self::Departure => "departure",
        }
    }

    /// The default time to alert. The source names en route, terminal, initial approach, non-precision approach and departure; which
    /// of them an intermediate, final or missed approach without vertical guidance belongs to is our reading, marked as such.
    pub const fn time_to_alert(self) -> TimeToAlert {
        let (operation, seconds, provenance) = match self {
            Self::EnRouteOceanic | Self::EnRouteContinental => ("en route", 300.0, Provenance::Inferred),
            Self::Arrival => ("terminal", 15.0, Provenance::Inferred),
            Self::Initial => ("initial approach", 10.0, Provenance::Inferred),
            Self::Departure => ("departure", 10.0, Provenance::Inferred),
            Self::Intermediate | Self::Final | Self::Missed => ("non-precision approach", 10.0, Provenance::Inferred),
        };
        TimeToAlert { operation, seconds, source: SOURCE, provenance }
    }
}
