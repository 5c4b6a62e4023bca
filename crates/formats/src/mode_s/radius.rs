//! The radius that contains a position, by the type code of its message.
//!
//! Source: rows of ICAO Doc 9871 (part B, table of NIC), DO-260B table 2-69 and ED-102B table N-16, as the specification of surveillance
//! quotes them from texts that agree; standard. Two well-known decoders hold wrong rows, so the table is ours.

use navbound_core::quantity::Metres;

const NM_M: f64 = Metres::nautical_miles(1.0).m();

/// Bits that tell rows of one type code apart; `None` while the message that holds it was not heard.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Supplements {
    /// Supplement A, of the operational status.
    pub a: Option<bool>,
    /// Supplement B, of the position itself.
    pub b: Option<bool>,
}

/// What a type code states.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Containment {
    /// Navigation integrity category; of version 0 that of uncertainty.
    pub category: u8,
    /// Radius that holds the position but for the risk of the integrity level; `None`: unbounded \[m\].
    pub radius_m: Option<f64>,
}

const UNBOUNDED: Containment = Containment { category: 0, radius_m: None };

const fn within(category: u8, radius_m: f64) -> Containment {
    Containment { category, radius_m: Some(radius_m) }
}

/// Of a position in the air, by its type code, the version of the aircraft and its supplements. Where a supplement is not known, or the
/// combination stands in no table, the largest radius of the rows that may be meant.
pub fn containment(code: u8, version: u8, supplements: Supplements) -> Containment {
    let Supplements { a, b } = supplements;
    match (code, version) {
        (9 | 20, 0) => within(9, 7.5),
        (9 | 20, _) => within(11, 7.5),
        (10 | 21, 0) => within(8, 25.0),
        (10 | 21, _) => within(10, 25.0),
        (11, 0) => within(7, 0.1 * NM_M),
        (11, 1) if a == Some(true) => within(9, 75.0),
        (11, 2..) if (a, b) == (Some(true), Some(true)) => within(9, 75.0),
        (11, _) => within(8, 0.1 * NM_M),
        (12, 0) => within(6, 0.2 * NM_M),
        (12, _) => within(7, 0.2 * NM_M),
        (13, 0) => within(5, 0.5 * NM_M),
        (13, 2..) if (a, b) == (Some(false), Some(true)) => within(6, 0.3 * NM_M),
        (13, _) if a == Some(false) => within(6, 0.5 * NM_M),
        (13, _) => within(6, 0.6 * NM_M),
        (14, 0) => within(4, NM_M),
        (14, _) => within(5, NM_M),
        (15, 0) => within(3, 2.0 * NM_M),
        (15, _) => within(4, 2.0 * NM_M),
        (16, 0) => within(2, 10.0 * NM_M),
        (16, 1) if a == Some(true) => within(3, 4.0 * NM_M),
        (16, 2..) if (a, b) == (Some(true), Some(true)) => within(3, 4.0 * NM_M),
        (16, _) => within(2, 8.0 * NM_M),
        (17, _) => within(1, 20.0 * NM_M),
        _ => UNBOUNDED,
    }
}
