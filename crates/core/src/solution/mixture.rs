//! A position that several readings of its ranges explain: covariance over the subsets of ranges that may be faulty.
//!
//! ```text
//! y = T theta + e,   T = [-u, one 1 for the clock, common columns scaled by their sigma],   theta = position, clocks (flat), common (unit prior)
//! reading (S, s): ranges of S have variance sigma^2 + s^2, s one of SIZES with equal weight
//! ln w = |S| ln q + (n - |S|) ln(1 - q) + 1/2 u'u - ln det(L) - |S| ln s,     L L' = Q_SS + 1/s^2,   u = L^-1 z_S
//! Q = W - W T N^-1 T'W,   z = Q y,   N = T'WT + diag(0, 0, 1)
//! x_S = x_0 - m'u,   P_S = P_0 + m'm,   m = L^-1 A_S',   A = position rows of N^-1 T'W
//! ```
//!
//! The first line of w is the marginal likelihood of the reading against that of no fault, by the matrix determinant lemma: a subset costs one row of a
//! Cholesky factor, nothing is removed, and no subset is singular. Provenance: re-derived (mixture of variance-inflated ranges, Box and
//! Tiao 1968); priors and sizes are ours, set on one drive (`docs/methods/gnss-exclusion.md`).

use super::point::MOST_RANGES;
use crate::frame::Covariance;
use crate::signal::Constellation;
use crate::special::float::{exp, hypot, ln, sqrt};
use core::f64::consts::LN_2;
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

const CLOCKS: usize = Constellation::ALL.len();
/// Columns of errors that ranges have in common: four of the atmosphere, one for the offset of each constellation's clock.
pub const COMMON: usize = 4 + CLOCKS;
const STATES: usize = 3 + CLOCKS + COMMON;
/// Standard deviations of a fault \[m\], each as likely.
const SIZES: [f64; 4] = [8.0, 40.0, 200.0, 1000.0];
/// Probability that a range is faulty, in the open and between obstacles.
const FAULTY: [f64; 2] = [1e-3, 0.3];
/// Probability that the receiver is between obstacles where nothing is known.
pub const OBSTRUCTED: f64 = 0.02;
/// The smallest risk that a position's circle is meant for.
const TAIL: f64 = 1e-5;
/// Readings below this weight are left out of that circle. Two decades below the risk: the probability of a fault is known to an order of
/// magnitude, and two faults count it twice.
const NEGLIGIBLE: f64 = 1e-7;
/// Standard deviations of a reading that the circle holds at least.
const LEAST_DEVIATES: f64 = 2.0;
/// Square of the standard normal deviate that `TAIL` exceeds on two sides: 4.417².
const TAIL_DEVIATE_SQUARED: f64 = 19.511;
const DEEPEST: usize = 6;

/// One range, linearised at the position whose covariance is requested.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Observed {
    /// From the receiver to the satellite, east-north-up.
    pub unit: Vector3<f64>,
    /// Which clock.
    pub clock: usize,
    /// Standard deviation of its own errors \[m\].
    pub sigma_m: f64,
    /// Measured less computed range, a clock's part in it \[m\].
    pub residual_m: f64,
    /// Standard deviations, with their signs, of the errors in common \[m\].
    pub common_m: [f64; COMMON],
}

/// All readings of an epoch together, by whether its surroundings are open or obstructed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mixture {
    states: [Moments; 2],
    /// How far readings that are not negligible are from the position, horizontal and vertical \[m\].
    farthest: [f64; 2],
    /// The same with their uncertainty: beyond it each leaves a risk of 1e-5 at most.
    reach: [f64; 2],
}

/// Covariances that a mixture gives about the position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Declared {
    /// Of the mixture: its first two moments.
    pub moments: Matrix3<f64>,
    /// Widened until the circle and the interval of risk 1e-5 reach where each reading puts the receiver, negligible ones apart.
    pub reaching: Matrix3<f64>,
    /// Widened until they hold what each reading leaves possible at that risk.
    pub holding: Matrix3<f64>,
}

/// Sums over readings with their weights.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Moments {
    weight: f64,
    within: Matrix3<f64>,
    between: Matrix3<f64>,
}

impl Moments {
    fn scale(&mut self, factor: f64) {
        self.weight *= factor;
        self.within *= factor;
        self.between *= factor;
    }
    fn add(&mut self, weight: f64, at: &Point) {
        self.weight += weight;
        self.within += at.covariance * weight;
        self.between += at.displacement * (at.displacement.transpose() * weight);
    }
}

/// Where a reading puts the receiver, from the position, and how surely.
#[derive(Debug, Clone, Copy)]
struct Point {
    displacement: Vector3<f64>,
    covariance: Matrix3<f64>,
}

impl Mixture {
    /// From the ranges of an epoch, those that were excluded among them. `None` where they determine no position, or where a number is
    /// none.
    pub fn new(observed: &[Observed]) -> Option<Self> {
        let base = Base::new(observed)?;
        let mut sum = Sum::new(observed.len());
        sum.add(0.0, 1.0, 0, SIZES.len() as f64, &base.point());
        for size in SIZES {
            base.extend(size, &Node::new(base.point()), 0, &mut sum);
        }
        sum.mixture()
    }

    /// Ratio of the weights of obstructed and open surroundings that the ranges themselves give; the prior has no part in it.
    pub fn evidence(&self) -> f64 {
        self.states[1].weight / self.states[0].weight
    }

    /// Covariances about the position.
    ///
    /// ```text
    /// P       = sum w P_S + sum w (x_S - x)(x_S - x)'
    /// reach_S = |x_S - x| + z sigma_S,   w exp(-z^2 / 2) = 1e-5, z at least 2
    /// ```
    ///
    /// `obstructed` is the posterior probability of obstructed surroundings. `least` is the covariance of the position without any doubt
    /// about its ranges; it takes the place of the first sum where its trace is larger.
    pub fn covariance(&self, obstructed: f64, least: &Matrix3<f64>) -> Declared {
        let share = |state: &Moments, p: f64| if p > 0.0 { p / state.weight } else { 0.0 };
        let shares = [share(&self.states[0], 1.0 - obstructed), share(&self.states[1], obstructed)];
        let within = self.states[0].within * shares[0] + self.states[1].within * shares[1];
        let between = self.states[0].between * shares[0] + self.states[1].between * shares[1];
        let whole = between + if within.trace() >= least.trace() { within } else { *least };
        let variances = [larger_horizontal(&whole), whole[(2, 2)]];
        let widened = |distances: &[f64; 2]| {
            let factor = |k: usize| sqrt((distances[k] * distances[k] / (TAIL_DEVIATE_SQUARED * variances[k])).max(1.0));
            let stretch = Matrix3::from_diagonal(&Vector3::new(factor(0), factor(0), factor(1)));
            stretch * whole * stretch
        };
        Declared { moments: whole, reaching: widened(&self.farthest), holding: widened(&self.reach) }
    }
}

/// Variance along the larger axis of the horizontal ellipse.
fn larger_horizontal(covariance: &Matrix3<f64>) -> f64 {
    let major = super::wls::horizontal_axes(&Covariance::claim_symmetric(*covariance)).0.m();
    major * major
}

/// Largest subset of faulty ranges among `n`; with more ranges fewer at once, so that the work stays bounded.
const fn deepest(n: usize) -> usize {
    let spare = n.saturating_sub(3);
    let most = match n {
        0..=9 => DEEPEST,
        10..=18 => 3,
        _ => 2,
    };
    if spare < most { spare } else { most }
}

/// The epoch without faults: what every subset needs of each range.
struct Base {
    n: usize,
    position: Vector3<f64>,
    covariance: Matrix3<f64>,
    root_weight: [f64; MOST_RANGES],
    /// L^-1 t sqrt(w), N = L L'.
    whitened: [SVector<f64, STATES>; MOST_RANGES],
    /// z = Q y.
    score: [f64; MOST_RANGES],
    /// How far the position moves for a metre in the range.
    response: [Vector3<f64>; MOST_RANGES],
}

impl Base {
    fn new(observed: &[Observed]) -> Option<Self> {
        let n = observed.len();
        let clocks = (0..CLOCKS).filter(|c| observed.iter().any(|o| o.clock == *c)).count();
        if n > MOST_RANGES || n < 3 + clocks || clocks == 0 {
            return None;
        }
        let mut information = SMatrix::<f64, STATES, STATES>::zeros();
        let mut side = SVector::<f64, STATES>::zeros();
        for o in observed {
            let (t, w) = (o.row(), 1.0 / (o.sigma_m * o.sigma_m));
            information.ger(w, &t, &t, 1.0);
            side += t * (w * o.residual_m);
        }
        for k in 0..STATES {
            // Unit prior of what is common; a clock that no range has stands by itself.
            if k >= 3 + CLOCKS || information[(k, k)] == 0.0 {
                information[(k, k)] += 1.0;
            }
        }
        let factor = information.cholesky()?;
        let solution = factor.solve(&side);
        let lower = factor.l();
        let mut base = Self {
            n,
            position: solution.fixed_rows::<3>(0).into_owned(),
            covariance: factor.inverse().fixed_view::<3, 3>(0, 0).into_owned(),
            root_weight: [0.0; MOST_RANGES],
            whitened: [SVector::zeros(); MOST_RANGES],
            score: [0.0; MOST_RANGES],
            response: [Vector3::zeros(); MOST_RANGES],
        };
        for (k, o) in observed.iter().enumerate() {
            let (t, root) = (o.row(), 1.0 / o.sigma_m);
            base.root_weight[k] = root;
            base.whitened[k] = lower.solve_lower_triangular(&(t * root))?;
            base.score[k] = (o.residual_m - t.dot(&solution)) * root * root;
            base.response[k] = factor.solve(&t).fixed_rows::<3>(0) * (root * root);
        }
        let finite = base.position.iter().chain(base.covariance.iter()).chain(&base.score[..n]).all(|v| v.is_finite());
        finite.then_some(base)
    }

    fn point(&self) -> Point {
        Point { displacement: self.position, covariance: self.covariance }
    }

    /// Element of Q.
    fn coupling(&self, i: usize, j: usize) -> f64 {
        let own = if i == j { 1.0 } else { 0.0 };
        self.root_weight[i] * self.root_weight[j] * (own - self.whitened[i].dot(&self.whitened[j]))
    }

    /// Every subset that adds ranges from `first` on to those of `node`.
    fn extend(&self, size: f64, node: &Node, first: usize, sum: &mut Sum) {
        if node.depth >= deepest(self.n) {
            return;
        }
        for k in first..self.n {
            let Some(next) = node.with(self, k, size) else { continue };
            sum.add(next.exponent, next.determinant, next.depth, 1.0, &next.point);
            self.extend(size, &next, k + 1, sum);
        }
    }
}

/// A subset of faulty ranges with its rows of the factor.
#[derive(Clone)]
struct Node {
    depth: usize,
    ranges: [usize; DEEPEST],
    lower: [[f64; DEEPEST]; DEEPEST],
    u: [f64; DEEPEST],
    m: [Vector3<f64>; DEEPEST],
    /// 1/2 u'u.
    exponent: f64,
    /// sqrt(det(1 + s^2 Q_SS)).
    determinant: f64,
    point: Point,
}

impl Node {
    fn new(point: Point) -> Self {
        let (lower, m) = ([[0.0; DEEPEST]; DEEPEST], [Vector3::zeros(); DEEPEST]);
        Self { depth: 0, ranges: [0; DEEPEST], lower, u: [0.0; DEEPEST], m, exponent: 0.0, determinant: 1.0, point }
    }

    /// The subset with one range more; `None` where rounding leaves no positive pivot.
    fn with(&self, base: &Base, range: usize, size: f64) -> Option<Self> {
        let (mut next, d) = (self.clone(), self.depth);
        let (mut u, mut m) = (base.score[range], base.response[range]);
        let mut pivot = base.coupling(range, range) + 1.0 / (size * size);
        for i in 0..d {
            let mut element = base.coupling(range, self.ranges[i]);
            for j in 0..i {
                element -= next.lower[d][j] * self.lower[i][j];
            }
            element /= self.lower[i][i];
            next.lower[d][i] = element;
            pivot -= element * element;
            u -= element * self.u[i];
            m -= self.m[i] * element;
        }
        if !(pivot > 0.0) {
            return None;
        }
        let root = sqrt(pivot);
        (next.ranges[d], next.lower[d][d], next.u[d], next.m[d]) = (range, root, u / root, m / root);
        next.depth += 1;
        next.exponent += 0.5 * next.u[d] * next.u[d];
        next.determinant *= root * size;
        next.point.displacement -= next.m[d] * next.u[d];
        next.point.covariance += next.m[d] * next.m[d].transpose();
        Some(next)
    }
}

/// Octaves of weight below the largest that the tail is kept in: down to 5e-20 of it.
const OCTAVES: usize = 64;

/// Sums over readings while they come. Weights count against 2^`top`, the most seen, so that none overflows.
struct Sum {
    top: f64,
    states: [Moments; 2],
    /// Prior weight of the reading without faults, by state.
    faultless: [f64; 2],
    /// Readings by octave of their weight where nothing is known of the surroundings.
    tail: [Far; OCTAVES],
}

impl Sum {
    fn new(n: usize) -> Self {
        let faultless = FAULTY.map(|q| (0..n).fold(1.0, |none, _| none * (1.0 - q)));
        Self { top: 0.0, states: [Moments::default(); 2], faultless, tail: [Far::default(); OCTAVES] }
    }

    /// A reading: exponent and determinant of its likelihood, how many faults, how many sizes of faults it stands for.
    fn add(&mut self, exponent: f64, determinant: f64, faults: usize, sizes: f64, at: &Point) {
        let octaves = exponent / LN_2;
        if octaves > self.top {
            self.lift(octaves - self.top);
        }
        let likelihood = exp(exponent - self.top * LN_2) / determinant * sizes;
        let mut weights = self.faultless.map(|none| none * likelihood);
        for (weight, q) in weights.iter_mut().zip(FAULTY) {
            for _ in 0..faults {
                *weight *= q / (1.0 - q);
            }
        }
        for (state, weight) in self.states.iter_mut().zip(weights) {
            state.add(weight, at);
        }
        let (weight, sum) = (marginal(weights), marginal([self.states[0].weight, self.states[1].weight]));
        // The sum only grows: a reading that is negligible now is so in the end.
        if weight >= NEGLIGIBLE * sum {
            self.tail[octave(weight)].take(&Far::of(at));
        }
    }

    /// The largest weight grows by `octaves`, rounded up.
    fn lift(&mut self, octaves: f64) {
        let whole = (octaves as usize).saturating_add(1);
        self.top += whole as f64;
        for state in &mut self.states {
            state.scale(exp(-(whole as f64) * LN_2));
        }
        let mut lifted = [Far::default(); OCTAVES];
        for (k, far) in self.tail.iter().enumerate() {
            lifted[k.saturating_add(whole).min(OCTAVES - 1)].take(far);
        }
        self.tail = lifted;
    }

    fn mixture(self) -> Option<Mixture> {
        let sum = marginal([self.states[0].weight, self.states[1].weight]);
        // The last octave holds all that is lighter.
        let lightest = octave(NEGLIGIBLE * sum).min(OCTAVES - 2);
        let (mut farthest, mut reach) = ([0.0_f64; 2], [0.0_f64; 2]);
        for (k, far) in self.tail[..=lightest].iter().enumerate() {
            // The heaviest that the octave can hold, against the tail.
            let heavier = (exp(-(k as f64 - 1.0) * LN_2) / sum).min(1.0) / TAIL;
            let z = sqrt(2.0 * ln(heavier.max(1.0))).max(LEAST_DEVIATES);
            for axis in 0..2 {
                farthest[axis] = farthest[axis].max(far.distance[axis]);
                reach[axis] = reach[axis].max(far.distance[axis] + z * far.sigma[axis]);
            }
        }
        let usable = self.states.iter().all(|s| s.weight > 0.0 && s.weight.is_finite());
        usable.then_some(Mixture { states: self.states, farthest, reach })
    }
}

/// How far readings are, horizontal and vertical \[m\].
#[derive(Debug, Clone, Copy, Default)]
struct Far {
    distance: [f64; 2],
    sigma: [f64; 2],
}

impl Far {
    fn of(at: &Point) -> Self {
        let d = &at.displacement;
        let variances = [larger_horizontal(&at.covariance), at.covariance[(2, 2)]];
        Self { distance: [hypot(d.x, d.y), d.z.abs()], sigma: variances.map(sqrt) }
    }
    fn take(&mut self, other: &Self) {
        for axis in 0..2 {
            self.distance[axis] = self.distance[axis].max(other.distance[axis]);
            self.sigma[axis] = self.sigma[axis].max(other.sigma[axis]);
        }
    }
}

/// Weight where nothing is known of the surroundings, from those in either.
fn marginal(weights: [f64; 2]) -> f64 {
    (1.0 - OBSTRUCTED) * weights[0] + OBSTRUCTED * weights[1]
}

/// Which octave below one a weight is in, from its exponent bits.
const fn octave(weight: f64) -> usize {
    let below = 1023_usize.saturating_sub((weight.to_bits() >> 52) as usize & 0x7ff);
    if below < OCTAVES { below } else { OCTAVES - 1 }
}

impl Observed {
    fn row(&self) -> SVector<f64, STATES> {
        let mut t = SVector::zeros();
        for k in 0..3 {
            t[k] = -self.unit[k];
        }
        t[3 + self.clock] = 1.0;
        for (k, common) in self.common_m.iter().enumerate() {
            t[3 + CLOCKS + k] = *common;
        }
        t
    }
}

#[cfg(test)]
#[path = "mixture_tests.rs"]
mod tests;
