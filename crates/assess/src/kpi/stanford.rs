//! The Stanford diagram: exact counts in its regions, and the histogram that is drawn.

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

/// Epochs of one axis in the five regions of a limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Regions {
    /// Level below the limit, error within the level.
    pub nominal: u64,
    /// Level below the limit, error beyond the level and within the limit.
    pub misleading: u64,
    /// Level below the limit, error beyond the limit.
    pub hazardous: u64,
    /// Level at or above the limit, error within the level.
    pub unavailable: u64,
    /// Level at or above the limit, error beyond the level.
    pub unavailable_misleading: u64,
}

impl Regions {
    /// One more point; NaN is none.
    pub fn add(&mut self, error_m: f64, level_m: f64, limit_m: f64) {
        if error_m.is_nan() || level_m.is_nan() {
            return;
        }
        let region = match (level_m < limit_m, error_m <= level_m) {
            (true, true) => &mut self.nominal,
            (true, false) if error_m > limit_m => &mut self.hazardous,
            (true, false) => &mut self.misleading,
            (false, true) => &mut self.unavailable,
            (false, false) => &mut self.unavailable_misleading,
        };
        *region += 1;
    }

    /// Both.
    pub fn merged(&self, other: &Self) -> Self {
        Self {
            nominal: self.nominal + other.nominal,
            misleading: self.misleading + other.misleading,
            hazardous: self.hazardous + other.hazardous,
            unavailable: self.unavailable + other.unavailable,
            unavailable_misleading: self.unavailable_misleading + other.unavailable_misleading,
        }
    }

    /// All points.
    pub fn n(&self) -> u64 {
        self.nominal + self.misleading + self.hazardous + self.unavailable + self.unavailable_misleading
    }
}

/// Points by bin of error and of level; only bins that hold any.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Histogram {
    counts: HashMap<(u32, u32), u64, BuildHasherDefault<BinHasher>>,
}

/// Two bins to a word, mixed by a multiplication: bins come from measurements, not from an adversary, and there are many millions.
#[derive(Debug, Clone, Copy, Default)]
struct BinHasher(u64);

impl Hasher for BinHasher {
    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|b| self.write_u32(u32::from(*b)));
    }
    fn write_u32(&mut self, bin: u32) {
        // 2^64 over the golden ratio, odd: Knuth's multiplicative hashing.
        self.0 = (self.0.rotate_left(32) ^ u64::from(bin)).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    }
    fn finish(&self) -> u64 {
        self.0
    }
}

impl Histogram {
    /// One more point; NaN is none. What lies beyond the last bin is counted in one more.
    pub fn add(&mut self, error_m: f64, level_m: f64, bin_m: f64, n_bins: u32) {
        if error_m.is_nan() || level_m.is_nan() {
            return;
        }
        // The conversion of a float saturates, so beyond is beyond.
        let bin = |value: f64| ((value / bin_m) as u32).min(n_bins);
        *self.counts.entry((bin(error_m), bin(level_m))).or_default() += 1;
    }

    /// Both.
    pub fn absorb(&mut self, other: Self) {
        for (bin, count) in other.counts {
            *self.counts.entry(bin).or_default() += count;
        }
    }

    /// Bin of error, bin of level, points; in the order of bins.
    pub fn rows(&self) -> Vec<(u32, u32, u64)> {
        let mut rows: Vec<_> = self.counts.iter().map(|(&(error, level), &count)| (error, level, count)).collect();
        rows.sort_unstable();
        rows
    }
}
