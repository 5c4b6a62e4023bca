//! What the innovations say of the filter: how large, and whether each knows of the one before.

use super::covariance::FURTHER;
use super::slots::Further;
use crate::quantity::GpsTime;
use crate::special::float::{exp, sqrt};

/// Time after which an innovation weighs a third in [`Innovations::memory`] \[s\]. Provenance: ours.
pub const MEMORY_S: f64 = 60.0;
/// Pairs, as they weigh, from which [`Innovations::memory`] is near enough to normal: products of normal numbers have a kurtosis of 9, so
/// the risk beyond five deviations is twice the normal one. Provenance: ours.
pub const PAIRS_LEAST: f64 = 100.0;

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
    /// Largest since it was last taken, of all that were examined, over the gate.
    largest: f64,
    sum_square: f64,
    n_pairs: u64,
    sum_product: f64,
    sum_pair_square: f64,
    lately: Lately,
}

/// Products of an innovation and the one before it, forgotten over [`MEMORY_S`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Lately {
    sum: f64,
    /// Its variance if each product has 1, as those of white innovations have.
    variance: f64,
    time: Option<GpsTime>,
}

impl Lately {
    fn add(&mut self, product: f64, time: GpsTime) {
        if self.time != Some(time) {
            let keep = self.time.map_or(0.0, |t| exp(-time.seconds_since(t) / MEMORY_S));
            self.sum *= keep;
            self.variance *= keep * keep;
            self.time = Some(time);
        }
        self.sum += product;
        self.variance += 1.0;
    }
}

impl Innovations {
    /// An innovation has come to the gate: its size over the gate's.
    pub(super) fn examined(&mut self, over_gate: f64) {
        // A size that is no number is beyond every gate.
        self.largest = if over_gate.is_nan() { f64::INFINITY } else { self.largest.max(over_gate) };
    }

    /// The largest innovation since this was last called, over its gate: above 1 it was thrown away; `None` where none was examined.
    pub const fn take_largest(&mut self) -> Option<f64> {
        let largest = core::mem::replace(&mut self.largest, 0.0);
        if largest > 0.0 { Some(largest) } else { None }
    }

    pub(super) fn used(&mut self, normalised: f64, before: Option<f64>, time: GpsTime) {
        self.n_used += 1;
        self.sum_square += normalised * normalised;
        if let Some(before) = before {
            self.n_pairs += 1;
            self.sum_product += normalised * before;
            self.lately.add(normalised * before, time);
            self.sum_pair_square += 0.5 * (normalised * normalised + before * before);
        }
    }

    /// Three components that were judged together; the correlation is that of one of them.
    pub(super) fn used_three(&mut self, square: f64, normalised: f64, before: Option<f64>, time: GpsTime) {
        self.used(normalised, before, time);
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

    /// What the innovations of the last minute or so remember, in standard deviations: standard normal for a filter that is right, NaN
    /// while there are fewer than [`PAIRS_LEAST`] pairs or none has come for [`MEMORY_S`].
    ///
    /// ```text
    /// m = sum_k g^(age of k) n_k n_(k-1) / sqrt(sum_k g^(2 age of k)),    g^age = exp(-age / MEMORY_S)
    /// ```
    pub fn memory(&self, now: GpsTime) -> f64 {
        let fresh = self.lately.time.is_some_and(|t| now.seconds_since(t) <= MEMORY_S);
        if !(fresh && self.lately.variance >= PAIRS_LEAST) {
            return f64::NAN;
        }
        self.lately.sum / sqrt(self.lately.variance)
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Ten sources a second, each innovation `share` of the one before and the rest new: the memory after five minutes, and its largest.
    fn memory_of(share: f64) -> (f64, f64) {
        let mut state = 0x2545_f491_4f6c_dd1d_u64;
        let mut uniform = || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1u64 << 53) as f64 + 1e-17
        };
        let mut normal = || (-2.0 * uniform().ln()).sqrt() * (core::f64::consts::TAU * uniform()).cos();
        let (mut sums, mut last, mut most) = (Innovations::default(), [None; 10], 0.0f64);
        let mut memory = f64::NAN;
        for second in 0..300 {
            let time = GpsTime::default().plus_seconds(f64::from(second));
            for before in &mut last {
                let new = share * before.unwrap_or(0.0) + (1.0 - share * share).sqrt() * normal();
                sums.used(new, before.replace(new), time);
            }
            memory = sums.memory(time);
            most = most.max(memory.abs());
        }
        (memory, most)
    }

    /// White: five deviations either way. A share of 0.3 among 10 * 60 / 2 pairs that weigh: 0.3 sqrt of their sum over that of their squares,
    /// 0.3 * 600 / sqrt(300) = 10.4 ± 1.2.
    #[test]
    fn correlated_innovations_are_detected_within_a_minute() {
        let (_, most) = memory_of(0.0);
        assert!(most < 5.0, "{most}");
        let (memory, _) = memory_of(0.3);
        assert!((memory - 10.4).abs() < 4.0, "{memory}");
    }

    #[test]
    fn few_pairs_or_old_ones_say_nothing() {
        let mut sums = Innovations::default();
        let time = GpsTime::default();
        (0..99).for_each(|_| sums.used(1.0, Some(1.0), time));
        assert!(sums.memory(time).is_nan());
        sums.used(1.0, Some(1.0), time);
        assert!((sums.memory(time) - 10.0).abs() < 1e-12);
        assert!(sums.memory(time.plus_seconds(61.0)).is_nan());
    }
}
