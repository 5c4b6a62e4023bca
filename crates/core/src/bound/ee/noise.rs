//! The noise part: a weighted sum of the latest extracted errors, and the multiplier that a risk asks for.

use super::Both;
use crate::quantity::{OutOfDomain, Risk};
use crate::solution::extraction::Extracted;
use crate::special::float::{exp, exp_m1, ln, ln_1p, sqrt};

/// Longest window; its samples are held without a heap.
pub const MOST_SAMPLES: usize = 1024;

/// How the horizontal error is made from its components.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HorizontalBeta {
    /// `beta sqrt(u_E^2 + u_N^2)`, as in the vertical.
    Outside,
    /// `sqrt(beta (u_E^2 + u_N^2))`, equation 6 as printed: the factor is sqrt(beta).
    Printed,
}

/// Which multiplier.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// `S k`: what equation 5 must mean, since k belongs to the sum.
    CfarSum,
    /// `S k / M`, equation 5 as printed: exceeded by most errors.
    AsPrinted,
}

/// Length and weight of the window.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shape {
    samples: usize,
    weight: f64,
}

impl Shape {
    /// A window of `samples`, whose older half counts `weight` and whose newer half `2 - weight`.
    ///
    /// # Errors
    /// [`OutOfDomain`] unless `samples` is even, 2 to [`MOST_SAMPLES`], and `0 <= weight <= 1`.
    pub fn new(samples: usize, weight: f64) -> Result<Self, OutOfDomain> {
        if !((2..=MOST_SAMPLES).contains(&samples) && samples.is_multiple_of(2)) {
            return Err(OutOfDomain { argument: "window", value: samples as f64, unit: "samples", domain: "even numbers from 2 to 1024" });
        }
        if !(0.0..=1.0).contains(&weight) {
            return Err(OutOfDomain { argument: "weight", value: weight, unit: "1", domain: "[0, 1]" });
        }
        Ok(Self { samples, weight })
    }

    /// Number of samples M.
    pub const fn samples(&self) -> usize {
        self.samples
    }

    fn half(&self) -> f64 {
        self.samples as f64 / 2.0
    }

    /// The multiplier of the sum for exponential errors of equal weight: `k = P^(-1/M) - 1`.
    pub fn factor(&self, risk: Risk) -> f64 {
        exp_m1(-ln(risk.q()) / self.samples as f64)
    }

    /// The multiplier that carries the risk with these weights: the root of `prod (1 + k w_i)^-1 = P`.
    ///
    /// ```text
    /// (1 + k w)(1 + k (2 - w)) = P^(-2/M)
    /// ```
    pub fn weighted_factor(&self, risk: Risk) -> f64 {
        let excess = exp_m1(-2.0 * ln(risk.q()) / self.samples as f64);
        let product = self.weight * (2.0 - self.weight);
        excess / (1.0 + sqrt(1.0 + product * excess))
    }

    /// Risk that an independent exponential error outside the window exceeds `factor` times the sum.
    pub fn risk_outside(&self, factor: f64) -> f64 {
        exp(-self.half() * (ln_1p(factor * self.weight) + ln_1p(factor * (2.0 - self.weight))))
    }

    /// The same for the newest error of the window itself, as the paper has it: it raises its own bound.
    pub fn risk_inside(&self, factor: f64) -> f64 {
        let newer = 2.0 - self.weight;
        let left = 1.0 - factor * newer;
        if !(left > 0.0) {
            return 0.0;
        }
        let k = factor / left;
        exp(-self.half() * ln_1p(k * self.weight) - (self.half() - 1.0) * ln_1p(k * newer))
    }

    /// Multiplier of the sum in a form.
    fn multiplier(&self, form: Form, risk: Risk) -> f64 {
        match form {
            Form::CfarSum => self.factor(risk),
            Form::AsPrinted => self.factor(risk) / self.samples as f64,
        }
    }
}

/// How the noise part is made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// The window.
    pub shape: Shape,
    beta: f64,
    /// How the horizontal error is made.
    pub horizontal_beta: HorizontalBeta,
    /// Which multiplier.
    pub form: Form,
    /// Stated risk, horizontal.
    pub risk_h: Risk,
    /// Stated risk, vertical.
    pub risk_v: Risk,
}

impl Settings {
    /// Settings with `beta`, the factor from sd(u) to sd(xi).
    ///
    /// # Errors
    /// [`OutOfDomain`] unless `beta` is positive and finite.
    pub fn new(
        shape: Shape,
        beta: f64,
        (horizontal_beta, form): (HorizontalBeta, Form),
        (risk_h, risk_v): (Risk, Risk),
    ) -> Result<Self, OutOfDomain> {
        if !(beta > 0.0 && beta.is_finite()) {
            return Err(OutOfDomain { argument: "beta", value: beta, unit: "1", domain: "(0, inf)" });
        }
        Ok(Self { shape, beta, horizontal_beta, form, risk_h, risk_v })
    }
}

/// What one sample gives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// E, the size of the error of this sample.
    pub size: Both,
    /// S, the weighted sum over the window; `None` until it is full.
    pub sum: Option<Both>,
    /// The noise part of the bound; `None` until the window is full.
    pub bound: Option<Both>,
}

/// The latest samples of one axis, in a ring.
#[derive(Debug, Clone, Copy)]
struct Ring {
    values: [f64; MOST_SAMPLES],
}

/// The noise part, sample by sample.
#[derive(Debug, Clone, Copy)]
pub struct Meter {
    settings: Settings,
    multipliers: [f64; 2],
    rings: [Ring; 2],
    /// Place of the next sample.
    next: usize,
    filled: usize,
}

impl Meter {
    /// A meter with an empty window.
    pub fn new(settings: Settings) -> Self {
        let multiplier = |risk| settings.shape.multiplier(settings.form, risk);
        Self {
            settings,
            multipliers: [multiplier(settings.risk_h), multiplier(settings.risk_v)],
            rings: [Ring { values: [0.0; MOST_SAMPLES] }; 2],
            next: 0,
            filled: 0,
        }
    }

    /// The next sample; one that began anew empties the window first.
    ///
    /// ```text
    /// E_V = beta |u_U|      E_H = beta sqrt(u_E^2 + u_N^2)                      Vassilev 2012, eq. 6
    /// S(n) = w sum of the older half + (2 - w) sum of the newer half            M samples that end at n
    /// noise = S k,          k = P^(-1/M) - 1                                     eq. 5 without its 1/M
    /// ```
    ///
    /// # Deviation from the source
    /// Equation 5 prints S k / M. k is the multiplier of the *sum* of M exponential errors (cell-averaging CFAR); divided by M the bound
    /// is 0.4 mean errors at P = 5e-8, and 67 to 89 % of errors exceed it. Equation 6 prints beta under the root, and outside it in the
    /// vertical.
    pub fn step(&mut self, extracted: &Extracted) -> Noise {
        if extracted.reset.is_some() {
            self.filled = 0;
        }
        let u = extracted.error.vector();
        let squares = u.x * u.x + u.y * u.y;
        let horizontal = match self.settings.horizontal_beta {
            HorizontalBeta::Outside => self.settings.beta * sqrt(squares),
            HorizontalBeta::Printed => sqrt(self.settings.beta * squares),
        };
        let vertical = self.settings.beta * if u.z < 0.0 { -u.z } else { u.z };
        let samples = self.settings.shape.samples;
        for (ring, value) in self.rings.iter_mut().zip([horizontal, vertical]) {
            ring.values[self.next] = value;
        }
        self.next = (self.next + 1) % samples;
        self.filled = samples.min(self.filled + 1);
        let size = Both::new(horizontal, vertical);
        if self.filled < samples {
            return Noise { size, sum: None, bound: None };
        }
        let [h, v] = [self.sum(0), self.sum(1)];
        let [k_h, k_v] = self.multipliers;
        Noise { size, sum: Some(Both::new(h, v)), bound: Some(Both::new(k_h * h, k_v * v)) }
    }

    /// The window is a ring: the oldest sample stands where the next one will.
    fn sum(&self, axis: usize) -> f64 {
        let Shape { samples, weight } = self.settings.shape;
        let values = &self.rings[axis].values[..samples];
        let half = samples / 2;
        let newest_begins = (self.next + half) % samples;
        let (low, high) = if self.next < newest_begins { (self.next, newest_begins) } else { (newest_begins, self.next) };
        let inner: f64 = values[low..high].iter().sum();
        let outer: f64 = values[..low].iter().sum::<f64>() + values[high..].iter().sum::<f64>();
        let (older, newer) = if self.next < newest_begins { (inner, outer) } else { (outer, inner) };
        weight * older + (2.0 - weight) * newer
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Displacement;
    use crate::quantity::Metres;
    use crate::solution::extraction::Reset;

    fn settings(samples: usize, weight: f64) -> Settings {
        let risks = (Risk::new(1e-9).unwrap(), Risk::new(5e-8).unwrap());
        Settings::new(Shape::new(samples, weight).unwrap(), 1.5, (HorizontalBeta::Outside, Form::CfarSum), risks).unwrap()
    }

    fn extracted(up_m: f64, reset: Option<Reset>) -> Extracted {
        let error = Displacement::new(Metres::new(3.0 * up_m), Metres::new(4.0 * up_m), Metres::new(-up_m));
        Extracted { error, age: 0, reset, new_satellites: false }
    }

    /// Samples 1, 2, 3, ... so that every half is a sum anyone can write down; M = 4, at every turn of the ring.
    #[test]
    fn the_newer_half_counts_more_at_every_turn_of_the_ring() {
        let mut meter = Meter::new(settings(4, 0.25));
        for n in 1..20 {
            let x = f64::from(n);
            let noise = meter.step(&extracted(x, None));
            assert_eq!(noise.size, Both::new(1.5 * 5.0 * x, 1.5 * x));
            let Some(sum) = noise.sum else {
                assert!(n < 4);
                continue;
            };
            let expected = 0.25 * (x - 3.0 + x - 2.0) + 1.75 * (x - 1.0 + x);
            assert!((sum.vertical.m() - 1.5 * expected).abs() < 1e-12, "{n}");
            assert!((sum.horizontal.m() - 7.5 * expected).abs() < 1e-11, "{n}");
        }
    }

    #[test]
    fn a_reset_empties_the_window() {
        let mut meter = Meter::new(settings(4, 0.5));
        for _ in 0..9 {
            meter.step(&extracted(1.0, None));
        }
        assert!(meter.step(&extracted(1.0, Some(Reset::Gap))).sum.is_none());
        assert!(meter.step(&extracted(1.0, None)).sum.is_none());
        assert!(meter.step(&extracted(1.0, None)).sum.is_none());
        assert!(meter.step(&extracted(1.0, None)).sum.is_some());
    }

    #[test]
    fn with_equal_weights_both_factors_carry_the_risk() {
        let risk = Risk::new(5e-8).unwrap();
        let equal = Shape::new(50, 1.0).unwrap();
        assert!((equal.factor(risk) - equal.weighted_factor(risk)).abs() < 1e-15);
        for weight in [0.0, 0.25, 1.0] {
            let shape = Shape::new(50, weight).unwrap();
            assert!((shape.risk_outside(shape.weighted_factor(risk)) / risk.q() - 1.0).abs() < 1e-12);
        }
        // A factor so large that the newest sample alone keeps the sum above itself.
        assert_eq!(equal.risk_inside(1.0), 0.0);
    }

    #[test]
    fn odd_and_endless_windows_are_refused() {
        for (samples, weight, name) in
            [(49, 0.5, "window"), (0, 0.5, "window"), (1026, 0.5, "window"), (50, 1.1, "weight"), (50, f64::NAN, "weight")]
        {
            assert_eq!(Shape::new(samples, weight).unwrap_err().argument, name);
        }
        let s = settings(4, 0.5);
        let refused = Settings::new(s.shape, 0.0, (HorizontalBeta::Printed, Form::AsPrinted), (s.risk_h, s.risk_v));
        assert_eq!(refused.unwrap_err().argument, "beta");
    }
}
