//! The protection level of several hypotheses that share one risk: the root of a sum of normal tails.
//!
//! Used for each axis by the methods of solution separation (advanced RAIM, relative RAIM).

use crate::quantity::{Metres, OutOfDomain, Risk};
use crate::special::abreast::tails;
use crate::special::float::{ln, sqrt};

/// Where the equation comes from; provenance *standard*.
pub const SOURCE: &str = "Blanch et al. 2015, baseline advanced RAIM user algorithm, protection level equation (standard)";

/// Hypotheses that are worked out at once.
pub(crate) const LANES: usize = 8;
const GROUPS: usize = 64;
/// Most hypotheses of one equation.
pub const MOST_TERMS: usize = LANES * GROUPS;
/// Relative distance of the sum from the risk below which one more step of third order leaves nothing that counts: its cube, 1e-12, of the
/// distance over which the sum falls to a third, which is below the smallest sigma.
const NEAR: f64 = 1e-4;
/// A hypothesis of this weight or more is the fault-free one or as likely.
const HEAVY: f64 = 0.5;
/// A bisection from a bracket of 1e4 m to 1e-9 m takes 43; steps of Halley take three.
const MOST_STEPS: usize = 60;
/// A bracket narrower than this part of the level holds a jump of the sum; its upper end is the level.
const NARROW: f64 = 1e-12;

/// Several hypotheses abreast.
#[derive(Debug, Clone, Copy)]
struct Group {
    weight: [f64; LANES],
    shift: [f64; LANES],
    inverse_sigma: [f64; LANES],
}

const EMPTY: Group = Group { weight: [0.0; LANES], shift: [0.0; LANES], inverse_sigma: [0.0; LANES] };

/// The equation of one axis, made once and filled again for every epoch, since it is large.
///
/// ```text
/// sum_k w_k Qm((x - t_k) / s_k) = risk         Qm(z) = Q(z) for z >= 0, 1 below
/// ```
///
/// w_k is how often hypothesis k is true (2 for the fault-free one, whose error has two tails), t_k what the level must hold before any noise
/// (threshold and bias), s_k the sigma of the noise.
#[derive(Debug, Clone)]
pub struct LevelEquation {
    groups: [Group; GROUPS],
    count: usize,
}

/// Why a hypothesis does not enter an equation, or an equation has no level.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum NoLevel {
    /// A number outside its domain.
    #[error(transparent)]
    OutOfDomain(#[from] OutOfDomain),
    /// More hypotheses than there is room for.
    #[error("an equation holds at most {MOST_TERMS} hypotheses")]
    TooMany,
}

impl Default for LevelEquation {
    fn default() -> Self {
        Self { groups: [EMPTY; GROUPS], count: 0 }
    }
}

impl LevelEquation {
    /// Forget every hypothesis.
    #[inline(always)]
    pub const fn clear(&mut self) {
        self.count = 0;
    }

    /// How many hypotheses there are.
    pub const fn len(&self) -> usize {
        self.count
    }

    /// None.
    pub const fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// One more hypothesis: how often it is true \[1\], what the level must hold beforehand, sigma of the noise.
    ///
    /// # Errors
    /// [`NoLevel::OutOfDomain`] for a weight or shift that is negative or not finite, or a sigma that is not positive and finite;
    /// [`NoLevel::TooMany`] after [`MOST_TERMS`].
    #[inline(always)]
    pub fn push(&mut self, weight: f64, shift: Metres, sigma: Metres) -> Result<(), NoLevel> {
        let (t, s) = (shift.m(), sigma.m());
        if !(weight >= 0.0 && t >= 0.0 && s > 0.0 && weight < f64::INFINITY && t < f64::INFINITY && s < f64::INFINITY) {
            return Err(refusal(weight, t, s));
        }
        let lane = self.count % LANES;
        let Some(group) = self.groups.get_mut(self.count / LANES) else {
            return Err(NoLevel::TooMany);
        };
        if lane == 0 {
            *group = EMPTY;
        }
        group.weight[lane] = weight;
        group.shift[lane] = t;
        group.inverse_sigma[lane] = 1.0 / s;
        self.count += 1;
        Ok(())
    }

    /// Eight hypotheses at once, after a multiple of eight: weights, shifts \[m\], sigmas \[m\], which the caller has made such that they are
    /// in their domains; those without weight do not count.
    ///
    /// # Errors
    /// [`NoLevel::TooMany`] after [`MOST_TERMS`].
    #[inline(always)]
    pub(crate) fn push_abreast(&mut self, weight: &[f64; LANES], shift: &[f64; LANES], sigma: &[f64; LANES]) -> Result<(), NoLevel> {
        debug_assert!(self.count.is_multiple_of(LANES));
        let group = self.groups.get_mut(self.count / LANES).ok_or(NoLevel::TooMany)?;
        *group = Group { weight: *weight, shift: *shift, inverse_sigma: [0.0; LANES] };
        for l in 0..LANES {
            group.inverse_sigma[l] = 1.0 / sigma[l];
        }
        self.count += LANES;
        Ok(())
    }

    /// The level: the least x >= 0 at which the sum is no larger than the risk, to 1e-9 m or 1e-12 of it, whichever is more.
    ///
    /// A bracket stands between the largest shift of a hypothesis that alone outweighs the risk and the place where no hypothesis
    /// can take more than its share (from Q(z) <= exp(-z²/2)/2); inside it Halley's steps on the logarithm of the sum, from about where the
    /// worst hypothesis alone would meet the risk, and bisection where a step leaves it.
    #[inline(always)]
    pub fn level(&self, risk: Risk) -> Metres {
        let q = risk.q();
        let Bracket { mut low, mut high, start: mut x } = self.bracket(q);
        for step in 0..MOST_STEPS {
            let sum = self.sum(x);
            if sum.value > q {
                low = x;
            } else {
                high = x;
            }
            let g = ln(sum.value / q);
            let slope = sum.slope / sum.value;
            let next = x - 2.0 * g * slope / (2.0 * slope * slope - g * (sum.curvature / sum.value - slope * slope));
            // Steps of third order end within a few; a jump of the sum, which they may circle, is met by bisection.
            let inside = next >= low && next <= high && step < MOST_STEPS / 4;
            x = if inside { next } else { 0.5 * (low + high) };
            if inside && g.abs() < NEAR {
                return Metres::new(x);
            }
            if high - low <= NARROW * high {
                break;
            }
        }
        Metres::new(high)
    }

    /// Risk that the error exceeds a level: the left side of the equation.
    #[inline(always)]
    pub fn risk_beyond(&self, level: Metres) -> f64 {
        self.sum(level.m()).value
    }

    #[inline(always)]
    fn filled(&self) -> &[Group] {
        &self.groups[..self.count.div_ceil(LANES).min(GROUPS)]
    }

    /// Where the level lies for certain.
    #[inline(always)]
    fn bracket(&self, risk: f64) -> Bracket {
        // The fault-free hypothesis and faults differ in weight by many decades: each kind is given half of the risk.
        let (mut heavy, mut light, mut heaviest) = ([0.0; LANES], [0.0; LANES], [0.0_f64; LANES]);
        for group in self.filled() {
            for l in 0..LANES {
                let w = group.weight[l];
                heavy[l] += if w >= HEAVY { w } else { 0.0 };
                light[l] += if w >= HEAVY { 0.0 } else { w };
                heaviest[l] = if w < HEAVY && w > heaviest[l] { w } else { heaviest[l] };
            }
        }
        let reach = |weights: &[f64; LANES]| {
            let w: f64 = weights.iter().sum();
            if w > risk { sqrt(2.0 * ln(w / risk)) } else { 0.0 }
        };
        if heavy.iter().chain(&light).sum::<f64>() <= risk {
            return Bracket { low: 0.0, high: 0.0, start: 0.0 };
        }
        let about = (quantile_about(heavy.iter().sum::<f64>() / risk), quantile_about(largest(heaviest) / risk));
        let (heavy, light) = (reach(&heavy), reach(&light));
        let [mut low, mut high, mut start] = [[0.0_f64; LANES]; 3];
        for group in self.filled() {
            for l in 0..LANES {
                let (w, t) = (group.weight[l], group.shift[l]);
                let (factor, nearer) = if w >= HEAVY { (heavy, about.0) } else { (light, about.1) };
                let sigma = 1.0 / group.inverse_sigma[l];
                let end = if w > 0.0 { t + factor * sigma } else { 0.0 };
                let alone = if w > 0.0 { t + nearer * sigma } else { 0.0 };
                let begin = if w > risk { t } else { 0.0 };
                low[l] = if begin > low[l] { begin } else { low[l] };
                high[l] = if end > high[l] { end } else { high[l] };
                start[l] = if alone > start[l] { alone } else { start[l] };
            }
        }
        let (low, high) = (largest(low), largest(high));
        Bracket { low, high, start: largest(start).max(low).min(high) }
    }

    /// The sum and its derivatives by x.
    #[inline(always)]
    fn sum(&self, x: f64) -> Sum {
        let [mut value, mut slope, mut curvature] = [[0.0; LANES]; 3];
        for group in self.filled() {
            let mut z = [0.0; LANES];
            for l in 0..LANES {
                z[l] = (x - group.shift[l]) * group.inverse_sigma[l];
            }
            let (tail, density) = tails(&z);
            for l in 0..LANES {
                let (q, phi) = if z[l] >= 0.0 { (tail[l], density[l]) } else { (1.0, 0.0) };
                let rate = group.weight[l] * phi * group.inverse_sigma[l];
                value[l] += group.weight[l] * q;
                slope[l] -= rate;
                curvature[l] += rate * z[l] * group.inverse_sigma[l];
            }
        }
        Sum { value: value.iter().sum(), slope: slope.iter().sum(), curvature: curvature.iter().sum() }
    }
}

/// Where a level lies for certain, and about where.
struct Bracket {
    low: f64,
    high: f64,
    start: f64,
}

#[inline(always)]
fn largest(x: [f64; LANES]) -> f64 {
    x.into_iter().fold(0.0, f64::max)
}

/// z with Q(z) = 1 / ratio, to some hundredths for ratios above a hundred: Q(z) is about exp(-z²/2) / (z sqrt(2 pi)). For a start only.
#[inline(always)]
fn quantile_about(ratio: f64) -> f64 {
    if !(ratio > 2.0) {
        return 0.0;
    }
    let square = 2.0 * ln(ratio);
    sqrt((square - ln(core::f64::consts::TAU * square)).max(0.0))
}

struct Sum {
    value: f64,
    slope: f64,
    curvature: f64,
}

#[cold]
fn refusal(weight: f64, shift: f64, sigma: f64) -> NoLevel {
    let not_negative = |x: f64| (0.0..f64::INFINITY).contains(&x);
    let (argument, value, unit, domain) = if !not_negative(weight) {
        ("weight", weight, "1", "[0, inf)")
    } else if !not_negative(shift) {
        ("shift_m", shift, "m", "[0, inf)")
    } else {
        ("sigma_m", sigma, "m", "(0, inf)")
    };
    NoLevel::OutOfDomain(OutOfDomain { argument, value, unit, domain })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::special::normal::{one_sided_factor, tail};

    fn equation(terms: &[(f64, f64, f64)]) -> LevelEquation {
        let mut equation = LevelEquation::default();
        for (w, t, s) in terms {
            equation.push(*w, Metres::new(*t), Metres::new(*s)).unwrap();
        }
        equation
    }

    fn level(terms: &[(f64, f64, f64)], q: f64) -> f64 {
        equation(terms).level(Risk::new(q).unwrap()).m()
    }

    /// The sum, term by term with the exact tail.
    fn sum(terms: &[(f64, f64, f64)], x: f64) -> f64 {
        terms.iter().map(|(w, t, s)| w * if x >= *t { tail((x - t) / s) } else { 1.0 }).sum()
    }

    #[test]
    fn one_hypothesis_is_a_quantile() {
        for (w, t, s, q) in [(2.0, 0.0, 1.3, 1e-7), (2.0, 3.0, 0.2, 0.05), (1e-5, 4.0, 2.0, 1e-9), (1.0, 1.0, 1.0, 1e-12)] {
            let exact = t + s * one_sided_factor(q / w);
            // The polynomial's 1e-13 in the risk, divided by the hazard of at least one, and rounding of the level.
            assert!((level(&[(w, t, s)], q) - exact).abs() <= 1e-12 * exact, "{w} {t} {s} {q}");
        }
    }

    #[test]
    fn the_sum_at_the_level_is_the_risk() {
        let mut state = 12_345_u64;
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        for case in 0..300 {
            let mut terms = vec![(2.0, 2.0 * uniform(), 0.5 + 2.0 * uniform())];
            for _ in 0..case % 60 {
                terms.push((10.0_f64.powf(-9.0 + 6.0 * uniform()), 15.0 * uniform(), 0.5 + 4.0 * uniform()));
            }
            let q = 10.0_f64.powf(-9.0 + 4.0 * uniform());
            let x = level(&terms, q);
            // Either the sum is the risk there (a level wrong by 1e-9 m moves it by 1e-9 times a hazard below 20 / 0.5 m), or it jumps past it.
            let met = (sum(&terms, x) / q - 1.0).abs() <= 4e-8;
            let jumps = sum(&terms, x + 1e-9) <= q && sum(&terms, x - 1e-9) >= q;
            assert!(met || jumps, "case {case}: {} at {x}", sum(&terms, x) / q);
        }
    }

    #[test]
    fn a_jump_past_the_risk_is_the_level() {
        // Below 7 m the second hypothesis counts whole, above at most half: the risk lies between.
        let x = level(&[(2.0, 0.0, 0.5), (1e-7, 7.0, 1.0)], 0.7e-7);
        assert!((x - 7.0).abs() <= 1e-11, "{x}");
    }

    #[test]
    fn nothing_to_bound_has_level_zero() {
        assert_eq!(level(&[], 1e-7), 0.0);
        assert_eq!(level(&[(1e-9, 5.0, 1.0)], 1e-7), 0.0);
    }

    #[test]
    fn what_is_no_hypothesis_is_refused_by_name() {
        let mut equation = LevelEquation::default();
        for (w, t, s, argument) in [(-1.0, 0.0, 1.0, "weight"), (1.0, f64::NAN, 1.0, "shift_m"), (1.0, 0.0, 0.0, "sigma_m")] {
            match equation.push(w, Metres::new(t), Metres::new(s)) {
                Err(NoLevel::OutOfDomain(e)) => assert_eq!(e.argument, argument),
                other => panic!("{other:?}"),
            }
        }
        for _ in 0..MOST_TERMS {
            equation.push(1e-9, Metres::new(1.0), Metres::new(1.0)).unwrap();
        }
        assert_eq!(equation.push(1e-9, Metres::new(1.0), Metres::new(1.0)), Err(NoLevel::TooMany));
        equation.clear();
        assert!(equation.is_empty() && equation.level(Risk::APPROACH_INTEGRITY).m() == 0.0);
    }

    /// Every level against bisection of the plain sum, with hypotheses far out that are too light to count and such that just do.
    #[test]
    fn a_level_is_where_bisection_of_the_sum_ends() {
        let mut state = 99_u64;
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        for case in 0..400 {
            let q = 10.0_f64.powf(-9.0 + 8.0 * uniform());
            let mut terms = vec![(2.0, 2.0 * uniform(), 0.1 + 3.0 * uniform())];
            for _ in 0..case % 17 {
                // Weights from a thousandth of the risk to a thousand times it, wherever they are.
                terms.push((q * 10.0_f64.powf(-3.0 + 6.0 * uniform()), 60.0 * uniform(), 0.05 + 4.0 * uniform()));
            }
            let (mut low, mut high) = (0.0, 1e3);
            for _ in 0..200 {
                let middle = 0.5 * (low + high);
                if sum(&terms, middle) > q { low = middle } else { high = middle }
            }
            let x = level(&terms, q);
            assert!((x - high).abs() <= 2e-9_f64.max(2e-12 * high), "case {case}: {x} {high}");
        }
    }
}
