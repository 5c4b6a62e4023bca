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

/// A constant and a process declared as one process, its deviation and its correlation time: the variance is that of both, and it moves as the
/// process alone does.
///
/// ```text
/// sigma^2 = constant^2 + process^2        2 sigma^2 / tau = 2 process^2 / tau_process
/// ```
pub(crate) fn correlated_error(constant: f64, process: f64, time_s: f64) -> (f64, f64) {
    let sigma = constant.hypot(process);
    let slower = if process > 0.0 { (sigma / process) * (sigma / process) } else { f64::INFINITY };
    (sigma, (time_s * slower).min(CONSTANT_S))
}

/// A correlation time that is as good as none: thirty years \[s\].
const CONSTANT_S: f64 = 1e9;
