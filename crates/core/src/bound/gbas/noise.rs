//! Smoothed multipath as first-order noise whose time constant is known only to lie between two ends.

use crate::quantity::{Metres, OutOfDomain};
use crate::special::float::exp;

/// How a filter models it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// Stationary noise of the longest time constant, as the paper's words have it. Nothing shows that it bounds when the true one is shorter.
    Paper,
    /// Langel, Garcia Crespillo and Joerger 2021 (standard): driven as by the shortest time constant, decaying as by the longest, and
    /// begun with `2 / (1 + shortest/longest)` of the variance. Bounds every time constant between.
    Bound,
}

/// A model of such noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coloured {
    sigma: Metres,
    shortest_s: f64,
    longest_s: f64,
    form: Form,
}

impl Coloured {
    /// Checked.
    ///
    /// # Errors
    /// [`OutOfDomain`] unless the deviation is positive and `0 < shortest <= longest`, all finite.
    pub fn new(sigma: Metres, [shortest_s, longest_s]: [f64; 2], form: Form) -> Result<Self, OutOfDomain> {
        if !(sigma.m() > 0.0 && sigma.m().is_finite()) {
            return Err(OutOfDomain { argument: "sigma_m", value: sigma.m(), unit: "m", domain: "(0, inf)" });
        }
        if !(shortest_s > 0.0 && shortest_s <= longest_s && longest_s.is_finite()) {
            return Err(OutOfDomain { argument: "shortest_s", value: shortest_s, unit: "s", domain: "(0, longest_s]" });
        }
        Ok(Self { sigma, shortest_s, longest_s, form })
    }

    /// What is left of a value after a step.
    pub fn kept(&self, step_s: f64) -> f64 {
        exp(-step_s / self.longest_s)
    }

    /// Variance that a step adds: `PSD longest / 2 (1 - kept^2)` \[m²\].
    pub fn added_m2(&self, step_s: f64) -> f64 {
        let kept = self.kept(step_s);
        let power = self.sigma.m() * self.sigma.m();
        // PSD is 2 sigma^2 over the time constant that drives.
        let stationary = match self.form {
            Form::Paper => power,
            Form::Bound => power * self.longest_s / self.shortest_s,
        };
        stationary * (1.0 - kept * kept)
    }

    /// Variance to begin with \[m²\].
    pub fn initial_m2(&self) -> f64 {
        let power = self.sigma.m() * self.sigma.m();
        match self.form {
            Form::Paper => power,
            Form::Bound => 2.0 * power / (1.0 + self.shortest_s / self.longest_s),
        }
    }
}
