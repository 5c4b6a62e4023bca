//! The three kinds of "no": a wrong argument, an unavailable result; our own mistakes are debug assertions.

use super::Risk;
use core::fmt;

/// An argument outside its domain: the caller's mistake.
#[derive(Debug, Clone, Copy, PartialEq)]
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

impl OutOfDomain {
    /// The confidence that was probably meant, where a risk was requested.
    pub fn confidence(&self) -> Option<Confidence> {
        let risk = self.domain == Risk::DOMAIN;
        (risk && self.value > Risk::MOST && self.value < 1.0).then_some(Confidence(self.value))
    }
}

impl fmt::Display for OutOfDomain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { argument, value, unit, domain } = self;
        write!(f, "{argument} = {value} [{unit}] is outside {domain}")?;
        self.confidence().map_or(Ok(()), |confidence| write!(f, ": {confidence}"))
    }
}

impl core::error::Error for OutOfDomain {}

/// A confidence where a risk was requested; it displays as the question whether its complement was meant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Confidence(f64);

impl fmt::Display for Confidence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("risk is 1 - confidence; did you mean ")?;
        // Six significant digits: what subtraction from one leaves of a double is noise beyond them.
        let (mut digits, mut exponent, mut place) = (1.0 - self.0, 0_i32, 1e5);
        while digits < 1.0 - 5e-7 {
            (digits, exponent) = (digits * 10.0, exponent + 1);
            if exponent <= MOST_DECIMALS {
                place *= 10.0;
            }
        }
        if exponent <= MOST_DECIMALS {
            return write!(f, "{}?", rounded((1.0 - self.0) * place) / place);
        }
        write!(f, "{}e-{exponent:02}?", rounded(digits * 1e5) / 1e5)
    }
}

/// Decimals up to which a number is written without an exponent.
const MOST_DECIMALS: i32 = 4;

/// The nearest whole number of one that is not negative and far below 2^63.
const fn rounded(x: f64) -> f64 {
    (x + 0.5) as u64 as f64
}

/// Why a number does not exist at this epoch. Data, not a failure: availability counts it.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Unavailable {
    /// The epoch lacks a field.
    #[error("{method} needs {field}, which this epoch lacks")]
    Missing {
        /// The caller.
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
