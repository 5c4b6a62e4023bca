//! What a filter has estimated of the biases of its unit, beside what the declared unit has.
//!
//! ```text
//! b ~ N(0, s^2), stationary;   Var(b^) = s^2 - P       b^ is uncorrelated with its own error b^ - b, whose variance is P
//! ```
//!
//! Provenance: derived; the orthogonality is that of every optimal estimate.

use super::dynamics::{BA, BG};
use super::filter::Filter;
use super::fusion::Fusion;

/// The estimate of a bias, in deviations of the declared bias.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BiasEstimate {
    /// b^ / s.
    pub of_declared: f64,
    /// `(s^2 - P) / s^2`: the share of the declared variance that the measurements have explained, which is the variance of `of_declared`.
    pub explained: f64,
}

impl Fusion {
    /// Gyroscopes x, y, z and accelerometers x, y, z of the filter with satellites, as far as its covariance has followed.
    pub fn bias_estimates(&self) -> [BiasEstimate; 6] {
        self.main.bias_estimates()
    }
}

impl Filter {
    fn bias_estimates(&self) -> [BiasEstimate; 6] {
        let declared = [self.settings.imu.gyroscope.bias, self.settings.imu.accelerometer.bias];
        core::array::from_fn(|n| {
            let (sensor, axis) = (n / 3, n % 3);
            let (state, s) = ([BG, BA][sensor] + axis, declared[sensor]);
            BiasEstimate { of_declared: self.biases[sensor][axis] / s, explained: 1.0 - self.joint.get(state, state) / (s * s) }
        })
    }
}
