//! The receiver's clock: offset and drift, driven by two white noises.
//!
//! ```text
//! [b, d]' = [[1, s], [0, 1]] [b, d] + w      cov(w) = [[Sb s + Sd s^3/3, Sd s^2/2], [Sd s^2/2, Sd s]]
//! ```
//!
//! Two-state model of Brown and Hwang; provenance: standard. Exact over an interval.

use super::settings::Gnss;
use crate::philox::{Sensor, Stream};

/// A clock under way; offset \[m\] and drift \[m/s\].
pub(crate) struct ReceiverClock {
    stream: Stream,
    offset_m: f64,
    drift_mps: f64,
    step_s: f64,
    /// Cholesky factor of the noise over an interval.
    factor: [f64; 3],
}

impl ReceiverClock {
    pub(crate) fn new(settings: &Gnss, seed: u64, flight: u64) -> Self {
        let mut stream = Stream::new(seed, flight, Sensor::ReceiverClock);
        let (offset_m, drift_mps) = (settings.clock_sigma_m * stream.normal(), settings.drift_sigma_mps * stream.normal());
        Self::from([offset_m, drift_mps], stream, settings.interval_s, [settings.clock_density_m2ps, settings.drift_density_m2ps3])
    }

    /// From an offset and a drift on, with the densities of their noises.
    pub(crate) fn from([offset_m, drift_mps]: [f64; 2], stream: Stream, s: f64, [b, d]: [f64; 2]) -> Self {
        let first = (b * s + d * s * s * s / 3.0).sqrt();
        let cross = if first > 0.0 { 0.5 * d * s * s / first } else { 0.0 };
        let second = (d * s - cross * cross).max(0.0).sqrt();
        Self { stream, offset_m, drift_mps, step_s: s, factor: [first, cross, second] }
    }

    pub(crate) fn now(&self) -> [f64; 2] {
        [self.offset_m, self.drift_mps]
    }

    pub(crate) fn step(&mut self) {
        let (x, y) = (self.stream.normal(), self.stream.normal());
        let [first, cross, second] = self.factor;
        self.offset_m += self.drift_mps * self.step_s + first * x;
        self.drift_mps += cross * x + second * y;
    }
}
