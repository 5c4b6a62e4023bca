//! Sums and extremes of a quantity, and of the three quantities of an axis.

/// Safety indices above this and up to 1 are potentially misleading.
const POTENTIAL: f64 = 0.75;

/// Count, sums and maximum of a quantity that is not negative.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Moments {
    /// Values.
    pub n: u64,
    sum: f64,
    sum_of_squares: f64,
    /// The largest, 0 where there is none.
    pub max: f64,
    /// Slot of the first largest.
    pub max_slot: i64,
}

impl Moments {
    /// One more value; NaN is none.
    pub fn add(&mut self, value: f64, slot: i64) {
        if !value.is_nan() {
            let one = Self { n: 1, sum: value, sum_of_squares: value * value, max: value, max_slot: slot };
            *self = self.merged(&one);
        }
    }

    /// Both, the earlier first.
    pub fn merged(&self, next: &Self) -> Self {
        let ahead = next.n > 0 && (self.n == 0 || next.max > self.max);
        Self {
            n: self.n + next.n,
            sum: self.sum + next.sum,
            sum_of_squares: self.sum_of_squares + next.sum_of_squares,
            max: if ahead { next.max } else { self.max },
            max_slot: if ahead { next.max_slot } else { self.max_slot },
        }
    }

    /// Mean; NaN of none.
    pub fn mean(&self) -> f64 {
        self.sum / self.n as f64
    }

    /// Root of the mean square; NaN of none.
    pub fn rms(&self) -> f64 {
        (self.sum_of_squares / self.n as f64).sqrt()
    }

    /// Variance; NaN of none.
    pub fn variance(&self) -> f64 {
        (self.sum_of_squares / self.n as f64 - self.mean().powi(2)).max(0.0)
    }
}

/// Error, protection level and their ratio in one axis.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Axis {
    /// Error \[m\].
    pub error: Moments,
    /// Protection level \[m\].
    pub level: Moments,
    /// Safety index, error over level.
    pub index: Moments,
    /// Epochs with 0.75 < index <= 1.
    pub n_potential: u64,
    /// Epochs with an error beyond the level.
    pub n_mi: u64,
}

impl Axis {
    /// One more epoch; NaN is none.
    pub fn add(&mut self, error_m: f64, level_m: f64, slot: i64) {
        self.error.add(error_m, slot);
        self.level.add(level_m, slot);
        let index = error_m / level_m;
        self.index.add(index, slot);
        self.n_potential += u64::from(index > POTENTIAL && error_m <= level_m);
        self.n_mi += u64::from(error_m > level_m);
    }

    /// Both, the earlier first.
    pub fn merged(&self, next: &Self) -> Self {
        Self {
            error: self.error.merged(&next.error),
            level: self.level.merged(&next.level),
            index: self.index.merged(&next.index),
            n_potential: self.n_potential + next.n_potential,
            n_mi: self.n_mi + next.n_mi,
        }
    }
}
