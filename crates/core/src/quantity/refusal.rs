//! The three kinds of "no": a wrong argument, an unavailable result; our own mistakes are debug assertions.

/// An argument outside its domain: the caller's mistake.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("{argument} = {value} [{unit}] is outside {domain}")]
pub struct OutOfDomain {
    /// The argument's public name.
    pub argument: &'static str,
    /// The value found.
    pub value: f64,
    /// Its unit.
    pub unit: &'static str,
    /// What is allowed.
    pub domain: &'static str,
}

/// Why a number does not exist at this epoch. Data, not a failure: availability counts it.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Unavailable {
    /// The epoch lacks a field.
    #[error("{method} needs {field}, which this epoch lacks")]
    Missing {
        /// Who asked.
        method: &'static str,
        /// For what.
        field: &'static str,
    },
    /// Too few satellites for the unknowns.
    #[error("{need} satellites are needed, {have} are usable")]
    TooFewSatellites {
        /// Unknowns to solve for.
        need: usize,
        /// Satellites at hand.
        have: usize,
    },
    /// The geometry does not determine the position.
    #[error("the geometry is singular: condition number {condition:e} is above {limit:e}")]
    Singular {
        /// Condition number of the normal matrix.
        condition: f64,
        /// The largest accepted.
        limit: f64,
    },
    /// A number of the epoch is outside its domain (a negative variance, a NaN).
    #[error("{field} = {value} [{unit}] is outside {domain}")]
    Invalid {
        /// The field's public name.
        field: &'static str,
        /// The value found.
        value: f64,
        /// Its unit.
        unit: &'static str,
        /// What is allowed.
        domain: &'static str,
    },
}

impl From<OutOfDomain> for Unavailable {
    fn from(e: OutOfDomain) -> Self {
        Self::Invalid { field: e.argument, value: e.value, unit: e.unit, domain: e.domain }
    }
}
