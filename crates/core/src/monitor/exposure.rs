//! What a risk per epoch means over an hour, for an error that remembers.

use crate::quantity::{OutOfDomain, Risk};
use crate::special::float::{exp_m1, ln_1p, sqrt};
use crate::special::normal::{density, tail};

const HOUR_S: f64 = 3600.0;
/// -zeta(1/2) / sqrt(2 pi): mean overshoot of a random walk over a level, in steps (Chernoff 1965; Siegmund 1979).
const OVERSHOOT: f64 = 0.582_597_157_939_010_6;
/// Fewest samples in a correlation time for which the shifted crossing rate is used. Against the exact transition kernel it is 0.89 of
/// the true risk at 5 samples, 0.98 at 10 and never below it from 20 on (docs/methods/rnp-monitor.md); fewer count as independent epochs.
const SAMPLES_FOR_CROSSINGS: f64 = 20.0;

/// A lateral error that forgets with time constant `correlation_time` and is looked at every `sample_period`.
///
/// ```text
/// rate(u)   = 2 u phi(u) / tau                      crossings of a Gauss-Markov process, both sides
/// u'        = u + 0.5826 sqrt(2 dt / tau)           sampled every dt it overshoots before it is seen
/// per epoch = 2 Q(u)
/// per hour  = 1 - (1 - per epoch) exp(-3600 s rate(u'))     inside at the start, and no crossing after it
/// ```
///
/// # Valid
/// Centred Gaussian error of one variance. With fewer than 20 samples in a correlation time the shift is not small and the rate falls
/// below the true risk (to 0.46 of it at one); there the risk of independent epochs is used, which no Gaussian dependence exceeds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HourlyExposure {
    correlation_time_s: f64,
    sample_period_s: f64,
}

impl HourlyExposure {
    /// An exposure; a sample period of zero means continuous monitoring.
    ///
    /// # Errors
    /// [`OutOfDomain`] unless the correlation time is in (0, inf) s and the sample period in [0, 3600] s.
    pub fn new(correlation_time_s: f64, sample_period_s: f64) -> Result<Self, OutOfDomain> {
        if !(correlation_time_s > 0.0 && correlation_time_s.is_finite()) {
            return Err(OutOfDomain { argument: "tau_s", value: correlation_time_s, unit: "s", domain: "(0, inf)" });
        }
        if !(0.0..=HOUR_S).contains(&sample_period_s) {
            return Err(OutOfDomain { argument: "sample_period_s", value: sample_period_s, unit: "s", domain: "[0, 3600]" });
        }
        Ok(Self { correlation_time_s, sample_period_s })
    }

    /// Risk to be outside at least once in an hour when each epoch is outside with `per_epoch`. 1 where it rounds to 1.
    pub fn per_hour(&self, per_epoch: Risk) -> f64 {
        self.hourly_at(crate::special::two_sided_factor(per_epoch.q()))
    }

    /// Risk per epoch whose hour carries `per_hour`: what the bounds must be evaluated at.
    ///
    /// # Errors
    /// [`OutOfDomain`] when no level above one sigma carries it: a risk per hour so large is no tail.
    pub fn per_epoch(&self, per_hour: Risk) -> Result<Risk, OutOfDomain> {
        let (mut low, mut high) = (1.0, 38.0);
        if !(self.hourly_at(low) >= per_hour.q() && self.hourly_at(high) <= per_hour.q()) {
            return Err(OutOfDomain {
                argument: "risk_per_hour",
                value: per_hour.q(),
                unit: "1",
                domain: "the risks of levels between 1 and 38 sigma",
            });
        }
        // The hourly risk falls with the level above one sigma; 60 halvings of 37 reach the last digit.
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if self.hourly_at(middle) > per_hour.q() { low = middle } else { high = middle }
        }
        Risk::new(2.0 * tail(high))
    }

    fn hourly_at(&self, level: f64) -> f64 {
        let (tau, dt) = (self.correlation_time_s, self.sample_period_s);
        let shifted = level + OVERSHOOT * sqrt(2.0 * dt / tau);
        let ln_inside = ln_1p(-2.0 * tail(level));
        let crossings = -exp_m1(ln_inside - HOUR_S * 2.0 * shifted * density(shifted) / tau);
        if dt == 0.0 {
            return crossings;
        }
        // 1 - (1 - q)^N, the risk of N independent epochs; by Sidak's inequality no Gaussian dependence exceeds it.
        let independent = -exp_m1(HOUR_S / dt * ln_inside);
        if tau >= SAMPLES_FOR_CROSSINGS * dt { crossings.min(independent) } else { independent }
    }
}
