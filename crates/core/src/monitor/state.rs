//! The RNP-state classifier of Ostroumov and Kuzmenko: which navigation specification does a navigation error still support?
//!
//! States A_1 .. A_n are the levels from the tightest, A_n+1 is "out of RNP". A state owns the errors up to its boundary B_k, and a normal
//! density placed so that neighbouring densities cross at the boundary. Class numbers count from zero here and in Python; the
//! epoch table's `p_state_<i>` counts from one, as the source does.

use crate::quantity::{Metres, OutOfDomain, Risk};
use crate::special::float::{exp, ln, ln_1p, sqrt};
use crate::special::gamma::{chi_square_head, chi_square_tail};
use crate::special::normal::{FRAC_1_SQRT_2PI, tail, two_sided_factor};

pub use super::state_order::is_ordered;

/// The most levels a classifier can hold; the state machine has no heap.
pub const MAX_LEVELS: usize = 12;
/// The most states: one more than levels.
pub const MAX_STATES: usize = MAX_LEVELS + 1;
/// A number for every state; those beyond [`StateTable::n_states`] mean nothing.
pub type PerState = [f64; MAX_STATES];

/// Navigation error that is left of a total system error of 95 % after the flight technical error of 95 % \[m\].
///
/// ```text
/// NSE = sqrt(TSE^2 - FTE^2)        Ostroumov and Kuzmenko 2018; independent zero-mean Gaussian parts, no path definition error
/// ```
///
/// # Errors
/// [`OutOfDomain`] unless `0 <= fte <= tse`, both finite.
pub fn nse_boundary(tse: Metres, fte: Metres) -> Result<Metres, OutOfDomain> {
    let (t, f) = (tse.m(), fte.m());
    if !(t >= 0.0 && t.is_finite()) {
        return Err(OutOfDomain { argument: "tse_m", value: t, unit: "m", domain: "[0, inf)" });
    }
    if !(f >= 0.0 && f <= t) {
        return Err(OutOfDomain { argument: "fte_m", value: f, unit: "m", domain: "[0, tse_m]: fte exceeds tse otherwise" });
    }
    Ok(Metres::new(sqrt((t - f) * (t + f))))
}

/// Boundaries, means and standard deviations of the states.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StateTable {
    n_levels: u8,
    boundary: [f64; MAX_LEVELS],
    mean: PerState,
    sigma: PerState,
    /// Logarithm of each density at its mean.
    ln_peak: PerState,
}

impl StateTable {
    /// The table of RNP levels and their flight technical errors (95 % both), tightest first.
    ///
    /// # Errors
    /// [`OutOfDomain`] where a level leaves no room for navigation error, and from [`StateTable::new`].
    pub fn of_levels(levels: &[Metres], fte: &[Metres]) -> Result<Self, OutOfDomain> {
        let mut boundaries = [Metres::default(); MAX_LEVELS];
        if !(levels.len() == fte.len() && levels.len() <= MAX_LEVELS) {
            return Err(OutOfDomain { argument: "levels", value: levels.len() as f64, unit: "1", domain: "1 to 12, one fte each" });
        }
        for k in 0..levels.len() {
            boundaries[k] = nse_boundary(levels[k], fte[k])?;
        }
        Self::new(&boundaries[..levels.len()])
    }

    /// The table of boundaries of navigation error.
    ///
    /// ```text
    /// sigma_1 = B_1 / 3      sigma_k = (B_k - B_{k-1}) / 6      sigma_{n+1} = sigma_n
    /// w_1 = 3      v_{i+1} = sqrt(w_i^2 - 2 ln(sigma_{i+1} / sigma_i))      w_{i+1} = 6 - v_{i+1}
    /// mu_1 = 0     mu_{i+1} = B_i + sigma_{i+1} v_{i+1}                      mu_{n+1} = 2 B_n - mu_n
    /// ```
    ///
    /// # Deviation from the source
    /// The printed recursion has two wrong signs: its radicand is negative for the standard levels, and with only the inner sign
    /// repaired mu_2 falls on the wrong side of B_1. This form makes neighbouring densities cross at every boundary, as intended.
    ///
    /// # Errors
    /// [`OutOfDomain`] unless there are 1 to 12 boundaries, positive, finite, strictly increasing, and no step so wide that the
    /// densities cannot cross at the boundary (B_2 / B_1 above 1 + 2 e^4.5 = 181).
    pub fn new(boundaries: &[Metres]) -> Result<Self, OutOfDomain> {
        let n = boundaries.len();
        if !(1..=MAX_LEVELS).contains(&n) {
            return Err(OutOfDomain { argument: "levels", value: n as f64, unit: "1", domain: "1 to 12 levels" });
        }
        let per_state = [0.0; MAX_STATES];
        // At most twelve levels, so their number fits.
        let mut table = Self { n_levels: n as u8, boundary: [0.0; MAX_LEVELS], mean: per_state, sigma: per_state, ln_peak: per_state };
        let mut below = 0.0;
        for k in 0..n {
            let b = boundaries[k].m();
            if !(b > below && b.is_finite()) {
                let domain = "positive, finite and strictly increasing boundaries";
                return Err(OutOfDomain { argument: "boundary_m", value: b, unit: "m", domain });
            }
            table.boundary[k] = b;
            table.sigma[k] = (b - below) / if k == 0 { 3.0 } else { 6.0 };
            below = b;
        }
        table.sigma[n] = table.sigma[n - 1];
        for k in 0..=n {
            table.ln_peak[k] = ln(FRAC_1_SQRT_2PI / table.sigma[k]);
        }
        table.place_means()?;
        Ok(table)
    }

    fn place_means(&mut self) -> Result<(), OutOfDomain> {
        let n = self.n_levels();
        let mut w = 3.0;
        for i in 0..n - 1 {
            let radicand = w * w - 2.0 * ln(self.sigma[i + 1] / self.sigma[i]);
            let v = if radicand >= 0.0 { sqrt(radicand) } else { f64::NAN };
            w = 6.0 - v;
            if !(w > 0.0) {
                let domain = "steps for which the recursion is defined: densities must be able to cross at the boundary before";
                return Err(OutOfDomain { argument: "boundary_m", value: self.boundary[i + 1], unit: "m", domain });
            }
            self.mean[i + 1] = self.boundary[i] + self.sigma[i + 1] * v;
        }
        self.mean[n] = 2.0 * self.boundary[n - 1] - self.mean[n - 1];
        Ok(())
    }

    /// How many levels.
    pub fn n_levels(&self) -> usize {
        usize::from(self.n_levels)
    }
    /// How many states: one more.
    pub fn n_states(&self) -> usize {
        self.n_levels() + 1
    }
    /// The boundaries of navigation error \[m\].
    pub fn boundary_m(&self) -> &[f64] {
        &self.boundary[..self.n_levels()]
    }
    /// The means of the states' densities \[m\].
    pub fn mean_m(&self) -> &[f64] {
        &self.mean[..=self.n_levels()]
    }
    /// The standard deviations of the states' densities \[m\].
    pub fn sigma_m(&self) -> &[f64] {
        &self.sigma[..=self.n_levels()]
    }
    /// Density of the state at its boundary, where its neighbour's is the same \[1/m\].
    pub fn density_at_boundary(&self, k: usize) -> f64 {
        exp(self.ln_likelihood(k, self.boundary[k]))
    }

    /// The threshold rule: the first state whose boundary the error does not exceed. NaN is out of RNP.
    pub fn threshold_class(&self, nse: Metres) -> usize {
        let x = nse.m();
        let within = |b: &f64| x.abs() <= *b;
        self.boundary_m().iter().position(within).unwrap_or(self.n_levels())
    }

    /// ln N(x; mu_k, sigma_k).
    pub(super) fn ln_likelihood(&self, k: usize, x: f64) -> f64 {
        let z = (x - self.mean[k]) / self.sigma[k];
        -0.5 * z * z + self.ln_peak[k]
    }

    /// ln q_k(x) as published: the unguarded densities. An exhibit: a narrow last state loses far outside (docs/methods/rnp-state.md).
    pub fn ln_posterior_as_printed(&self, nse: Metres, prior: &PerState) -> PerState {
        self.normalised(|k| ln(prior[k]) + self.ln_likelihood(k, nse.m().abs()))
    }

    /// ln q_k(x) with the last state's density held at its peak beyond its mean, so that "out of RNP" never becomes less likely outwards.
    pub fn ln_posterior(&self, nse: Metres, prior: &PerState) -> PerState {
        self.normalised(|k| ln(prior[k]) + self.ln_guarded(k, nse.m().abs()))
    }

    /// ln q_k(lateral, longitudinal) as published (determinant corrected): both means at mu_k. Misclassifies off the diagonal; an exhibit.
    pub fn ln_paper_bivariate(&self, lateral: Metres, longitudinal: Metres, prior: &PerState) -> PerState {
        let (a, b) = (lateral.m().abs(), longitudinal.m().abs());
        self.normalised(|k| ln(prior[k]) + self.ln_likelihood(k, a) + self.ln_likelihood(k, b))
    }

    /// Probabilities of the joint state of a lateral and a longitudinal error: the worse of the two, each judged by itself.
    ///
    /// ```text
    /// C(k) = C_lateral(k) C_longitudinal(k)      q(k) = C(k) - C(k-1) = q_lat(k) C_long(k) + C_lat(k-1) q_long(k)
    /// ```
    pub fn joint(&self, lateral: Metres, longitudinal: Metres, prior: &PerState) -> PerState {
        let a = self.ln_posterior(lateral, prior);
        let b = self.ln_posterior(longitudinal, prior);
        let mut joint = [0.0; MAX_STATES];
        let (mut below_a, mut upto_b) = (0.0, 0.0);
        for k in 0..self.n_states() {
            let (qa, qb) = (exp(a[k]), exp(b[k]));
            upto_b += qb;
            // The difference of products as a sum of positive terms: small probabilities keep their digits.
            joint[k] = qa * upto_b + below_a * qb;
            below_a += qa;
        }
        joint
    }

    /// The state after an epoch, remembering the one before: predict with the stay probability, then update with the guarded density.
    ///
    /// # Errors
    /// [`OutOfDomain`] unless `0 <= stay <= 1`.
    pub fn remember(&self, before: &PerState, stay: f64, nse: Metres) -> Result<PerState, OutOfDomain> {
        if !(0.0..=1.0).contains(&stay) {
            return Err(OutOfDomain { argument: "stay", value: stay, unit: "1", domain: "[0, 1]" });
        }
        let n = self.n_states();
        let leave = (1.0 - stay) / (n - 1) as f64;
        let total: f64 = before[..n].iter().sum();
        let mut predicted = [0.0; MAX_STATES];
        for k in 0..n {
            predicted[k] = stay * before[k] + leave * (total - before[k]);
        }
        let mut after = self.ln_posterior(nse, &predicted);
        after[..n].iter_mut().for_each(|x| *x = exp(*x));
        Ok(after)
    }

    /// Equal priors.
    pub fn uniform(&self) -> PerState {
        [1.0 / self.n_states() as f64; MAX_STATES]
    }

    /// Priors of the states, checked.
    ///
    /// # Errors
    /// [`OutOfDomain`] unless there is one for each state, none is negative and their sum is 1 within 1e-9.
    pub fn prior(&self, prior: &[f64]) -> Result<PerState, OutOfDomain> {
        let n = self.n_states();
        if prior.len() != n {
            return Err(OutOfDomain { argument: "prior", value: prior.len() as f64, unit: "1", domain: "one number a state" });
        }
        let mut all = [0.0; MAX_STATES];
        for (slot, p) in all.iter_mut().zip(prior) {
            if !(*p >= 0.0) {
                return Err(OutOfDomain { argument: "prior", value: *p, unit: "1", domain: "[0, 1]" });
            }
            *slot = *p;
        }
        let sum: f64 = prior.iter().sum();
        if !((sum - 1.0).abs() <= 1e-9) {
            return Err(OutOfDomain { argument: "prior", value: sum, unit: "1", domain: "numbers whose sum is 1" });
        }
        Ok(all)
    }

    /// Probabilities of the states from the law of the error itself, normal with mean `offset` and deviation `sigma`.
    ///
    /// ```text
    /// P(A_k) = r(B_{k-1}) - r(B_k)      r(B) = Q((B - eta)/s) + Q((B + eta)/s), r(B_0) = 1
    /// ```
    ///
    /// # Errors
    /// [`OutOfDomain`] unless the offset is finite and `0 < sigma < inf`.
    pub fn of_error(&self, offset: Metres, sigma: Metres) -> Result<PerState, OutOfDomain> {
        let (eta, s) = (offset.m(), sigma.m());
        if !eta.is_finite() {
            return Err(OutOfDomain { argument: "offset_m", value: eta, unit: "m", domain: "(-inf, inf)" });
        }
        if !(s > 0.0 && s.is_finite()) {
            return Err(OutOfDomain { argument: "sigma_m", value: s, unit: "m", domain: "(0, inf)" });
        }
        let away = eta.abs();
        // Both as tails, so that neither loses its digits where it is small.
        let inside = |b: f64| tail((away - b) / s) - tail((away + b) / s);
        Ok(self.slices(inside, |b| tail((b - away) / s) + tail((b + away) / s)))
    }

    /// The tightest level that an error is beyond with at most a risk, as an index; the number of levels where there is none.
    pub fn tightest(&self, probability: &PerState, risk: Risk) -> u8 {
        let mut within = 0.0;
        let mut place = 0;
        for share in &probability[..self.n_levels()] {
            within += share;
            if 1.0 - within <= risk.q() {
                return place;
            }
            place += 1;
        }
        place
    }

    /// Probabilities of the states from `n` residuals of known zero mean whose squares sum to `sum_of_squares`: where the 95 % navigation
    /// error lies, given what was seen.
    ///
    /// ```text
    /// P(95 % NSE <= B) = Q_chi2(n)(S K^2 / B^2)        Jeffreys prior of the variance; K = 1.96
    /// ```
    ///
    /// # Errors
    /// [`OutOfDomain`] unless `n >= 1` and the sum is finite and not negative.
    pub fn of_residuals(&self, sum_of_squares_m2: f64, n: f64) -> Result<PerState, OutOfDomain> {
        if !(n >= 1.0 && n.is_finite()) {
            return Err(OutOfDomain { argument: "n", value: n, unit: "1", domain: "[1, inf)" });
        }
        if !(sum_of_squares_m2 >= 0.0 && sum_of_squares_m2.is_finite()) {
            return Err(OutOfDomain { argument: "sum_of_squares_m2", value: sum_of_squares_m2, unit: "m²", domain: "[0, inf)" });
        }
        let k = two_sided_factor(Risk::ACCURACY.q());
        let scaled = sum_of_squares_m2 * k * k;
        let ratio = |b: f64| scaled / (b * b);
        Ok(self.slices(|b| chi_square_tail(n, ratio(b)), |b| chi_square_head(n, ratio(b))))
    }

    /// What lies between neighbouring boundaries: differences of the tail or of the head, whichever is small and has the digits.
    fn slices(&self, inside: impl Fn(f64) -> f64, outside: impl Fn(f64) -> f64) -> PerState {
        let mut share = [0.0; MAX_STATES];
        let (mut inside_below, mut outside_below) = (0.0, 1.0);
        for k in 0..self.n_levels() {
            let (i, o) = (inside(self.boundary[k]), outside(self.boundary[k]));
            share[k] = if i < 0.5 { i - inside_below } else { outside_below - o };
            (inside_below, outside_below) = (i, o);
        }
        share[self.n_levels()] = outside_below;
        share
    }

    fn ln_guarded(&self, k: usize, x: f64) -> f64 {
        // NaN must stay NaN: `min` would turn it into the mean.
        let outwards = k == self.n_levels() && x > self.mean[k];
        self.ln_likelihood(k, if outwards { self.mean[k] } else { x })
    }

    fn normalised(&self, ln_weight: impl Fn(usize) -> f64) -> PerState {
        let mut out = [0.0; MAX_STATES];
        let n = self.n_states();
        let mut top = 0;
        for k in 0..n {
            out[k] = ln_weight(k);
            if out[k] > out[top] {
                top = k;
            }
        }
        // ln(1 + rest) keeps the digits of a posterior within 1e-16 of certainty.
        let peak = out[top];
        let rest: f64 = (0..n).filter(|k| *k != top).map(|k| exp(out[k] - peak)).sum();
        let correction = ln_1p(rest);
        out[..n].iter_mut().for_each(|x| *x = (*x - peak) - correction);
        out
    }
}

/// The state with the largest weight; the threshold rule decides a tie, and NaN is out of RNP.
pub fn decide(table: &StateTable, weights: &PerState, nse: Metres) -> usize {
    let n = table.n_states();
    if weights[..n].iter().any(|w| w.is_nan()) {
        return table.n_levels();
    }
    let most = weights[..n].iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let threshold = table.threshold_class(nse);
    if weights[threshold] == most {
        return threshold;
    }
    weights[..n].iter().position(|w| *w == most).unwrap_or(threshold)
}
