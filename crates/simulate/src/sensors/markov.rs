//! First-order Gauss-Markov numbers of unit variance, exact over a step.

use crate::philox::Stream;

/// ```text
/// x' = r x + sqrt(1 - r^2) n      r = exp(-step / tau)
/// ```
#[derive(Debug, Clone)]
pub(crate) struct Markov {
    stream: Stream,
    keep: f64,
    fresh: f64,
    now: f64,
}

impl Markov {
    /// In its stationary state at the begin.
    pub(crate) fn new(mut stream: Stream, step_s: f64, correlation_time_s: f64) -> Self {
        let keep = (-step_s / correlation_time_s).exp();
        let now = stream.normal();
        Self { stream, keep, fresh: (1.0 - keep * keep).sqrt(), now }
    }

    pub(crate) fn now(&self) -> f64 {
        self.now
    }

    pub(crate) fn step(&mut self) {
        self.now = self.keep * self.now + self.fresh * self.stream.normal();
    }
}
