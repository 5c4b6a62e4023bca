//! Clocks of constellations that are known from each other: one clock for all of them, their offsets taken out.

use super::{CLOCKS, Range};

/// An offset of a constellation's clock, and its standard deviation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Offset {
    /// Against a reference that all offsets have in common \[m\].
    pub offset_m: f64,
    /// Standard deviation \[m\].
    pub sigma_m: f64,
}

/// Offsets by constellation; one without an offset keeps a clock of its own.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Offsets {
    /// By constellation's index.
    pub of: [Option<Offset>; CLOCKS],
}

/// A constellation's clock as an epoch solves it.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Clock {
    /// Which unknown.
    pub(super) index: usize,
    /// Its reading against that unknown, and how surely that is known \[m\].
    pub(super) offset_m: f64,
    pub(super) sigma_m: f64,
}

impl Clock {
    /// Whether a constellation's ranges determine a clock themselves.
    pub(super) const fn own(&self, constellation: usize) -> bool {
        self.index == constellation
    }
}

impl Offsets {
    /// Whether more than one clock is known.
    pub fn several(&self) -> bool {
        self.of.iter().flatten().count() > 1
    }

    /// Whether any clock of these ranges is known from another's.
    pub fn tie(&self, ranges: &[Range]) -> bool {
        self.clocks(ranges)
            .iter()
            .enumerate()
            .any(|(c, clock)| !clock.own(c) && ranges.iter().any(|r| r.satellite.constellation.index() == c))
    }

    /// Clocks for an epoch's ranges: constellations with known offsets share that of the first of them.
    pub(super) fn clocks(&self, ranges: &[Range]) -> [Clock; CLOCKS] {
        let present = |c: usize| ranges.iter().any(|r| r.satellite.constellation.index() == c);
        let first = (0..CLOCKS).find_map(|c| self.of[c].filter(|_| present(c)).map(|offset| (c, offset)));
        core::array::from_fn(|c| match (first, self.of[c]) {
            (Some((index, first)), Some(own)) if c != index => {
                let sigma_m = crate::special::float::hypot(own.sigma_m, first.sigma_m);
                Clock { index, offset_m: own.offset_m - first.offset_m, sigma_m }
            }
            _ => Clock { index: c, offset_m: 0.0, sigma_m: 0.0 },
        })
    }
}
