//! What the innovations say of the filter: how large, and whether each knows of the one before.

use super::covariance::FURTHER;
use super::slots::Further;

/// A kind of measurement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Range to a satellite.
    Range,
    /// Range rate to a satellite.
    RangeRate,
    /// Slant range to a DME.
    Dme,
    /// Bearing from a VOR.
    Vor,
    /// Barometric height.
    Baro,
    /// Solved position.
    FixPosition,
    /// Solved velocity.
    FixVelocity,
    /// No velocity across the wheels.
    Wheels,
}

impl Kind {
    /// Every kind, in the order of [`Kind::index`].
    pub const ALL: [Self; 8] =
        [Self::Range, Self::RangeRate, Self::Dme, Self::Vor, Self::Baro, Self::FixPosition, Self::FixVelocity, Self::Wheels];

    /// Position in [`Kind::ALL`].
    pub const fn index(self) -> usize {
        self as usize
    }
    /// The word of tables.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Range => "range",
            Self::RangeRate => "range_rate",
            Self::Dme => "dme",
            Self::Vor => "vor",
            Self::Baro => "baro",
            Self::FixPosition => "fix_position",
            Self::FixVelocity => "fix_velocity",
            Self::Wheels => "wheels",
        }
    }
}

/// Sums over the measurements of one kind.
///
/// Normalised innovations of a filter that is right about itself have mean square 1 and no memory. A mean square near 1 does not prove
/// much: a filter that takes slow errors for white follows them, and its innovations stay small.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Innovations {
    /// Scalars used.
    pub n_used: u64,
    /// Scalars thrown away by the gate.
    pub n_gated: u64,
    /// Measurements refused before the gate: not finite, too old, without a place for their state.
    pub n_refused: u64,
    sum_square: f64,
    n_pairs: u64,
    sum_product: f64,
    sum_pair_square: f64,
}

impl Innovations {
    pub(super) fn used(&mut self, normalised: f64, before: Option<f64>) {
        self.n_used += 1;
        self.sum_square += normalised * normalised;
        if let Some(before) = before {
            self.n_pairs += 1;
            self.sum_product += normalised * before;
            self.sum_pair_square += 0.5 * (normalised * normalised + before * before);
        }
    }

    /// Three components that were judged together; the correlation is that of one of them.
    pub(super) fn used_three(&mut self, square: f64, normalised: f64, before: Option<f64>) {
        self.used(normalised, before);
        self.n_used += 2;
        self.sum_square += square - normalised * normalised;
    }

    /// Mean of the squared normalised innovations (NIS); NaN without any.
    pub fn mean_square(&self) -> f64 {
        self.sum_square / self.n_used as f64
    }

    /// Correlation of an innovation with the one before it of the same source; NaN without a pair. White ones stay within 2/sqrt(n).
    pub fn lag_one(&self) -> f64 {
        self.sum_product / self.sum_pair_square
    }

    /// Pairs behind [`Innovations::lag_one`].
    pub const fn n_pairs(&self) -> u64 {
        self.n_pairs
    }
}

/// The last normalised innovation of each source.
#[derive(Debug, Clone)]
pub(super) struct Memory {
    n: usize,
    last: [Option<(Kind, Further, f64)>; FURTHER],
}

impl Memory {
    pub(super) const fn new() -> Self {
        Self { n: 0, last: [None; FURTHER] }
    }

    /// The value before, which this one replaces; with all places taken the source first come is forgotten.
    pub(super) fn replace(&mut self, kind: Kind, source: Further, normalised: f64) -> Option<f64> {
        let same = |e: &Option<(Kind, Further, f64)>| e.is_some_and(|(k, s, _)| k == kind && s == source);
        let place = self.last.iter().position(same).unwrap_or_else(|| {
            let next = self.n % FURTHER;
            self.n += 1;
            self.last[next] = None;
            next
        });
        self.last[place].replace((kind, source, normalised)).map(|(_, _, before)| before)
    }
}
