//! The length of a Gaussian vector of up to three dimensions with any covariance and any mean: probability, density, radius.
//!
//! One law for the circle, the sphere and the line: an error of fewer dimensions has dead axes. Contour inversion ([`contour`]) is the
//! fastest; a contour through the saddle point ([`saddle`]) keeps its digits in the tails and takes any mean; slices ([`strip`]) are slow
//! and judge both. [`Rule`] says which one runs.
//! Numbers here carry no unit: what goes in as metres comes out as metres.

mod contour;
mod guard;
mod lanes;
#[expect(clippy::approx_constant, reason = "a node of a table that happens to be pi/4")]
mod nodes;
mod principal;
mod saddle;
mod search;
pub(crate) mod strip;

pub use guard::Rule;
pub use lanes::CentredRadius;
pub use principal::principal_axes;

use super::float::{hypot, sqrt};
use super::normal::{one_sided_factor, two_sided_factor};
use nodes::Node;
use search::Point;

/// A variance below this share of the largest is a dead axis: it moves the radius by less than rounding does.
const DEAD: f64 = 1e-24;

/// The contours know a probability to 1.4e-14; a side below this would have fewer than ten digits of its own.
const SADDLE_BELOW: f64 = 2e-5;

/// The law of |e| at one radius.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AtRadius {
    /// Probability of a shorter error.
    pub inside: f64,
    /// Probability of a longer error, with its own digits.
    pub outside: f64,
    /// Probability per unit of length.
    pub density: f64,
}

/// The law of |e| for e = N(mean, V), given along the principal axes of V.
#[derive(Debug, Clone, Copy)]
pub struct RadiusLaw {
    variances: [f64; 3],
    means: [f64; 3],
    sigmas: [f64; 3],
    live: usize,
    /// Length of the mean along dead axes: a constant share of the radius.
    dead: f64,
    rule: Rule,
}

impl RadiusLaw {
    /// From variances, largest first and none below zero, and the mean along the same axes.
    pub fn new(variances: [f64; 3], means: [f64; 3]) -> Self {
        debug_assert!(variances[0] >= variances[1] && variances[1] >= variances[2] && variances[2] >= 0.0);
        let live = variances.iter().filter(|v| **v > 0.0 && **v >= DEAD * variances[0]).count();
        let dead = means[live..].iter().fold(0.0, |length, m| hypot(length, *m));
        let mut law = Self { variances: [0.0; 3], means: [0.0; 3], sigmas: [0.0; 3], live, dead, rule: Rule::Talbot14 };
        let mut delta_squared = 0.0;
        for j in 0..live {
            law.variances[j] = variances[j];
            law.means[j] = means[j];
            law.sigmas[j] = sqrt(variances[j]);
            let delta = means[j] / law.sigmas[j];
            delta_squared += delta * delta;
        }
        law.rule = Rule::of(delta_squared);
        law
    }

    /// How moderate probabilities of this law are evaluated; small sides always take the saddle point.
    pub fn rule(&self) -> Rule {
        self.rule
    }

    /// Probability of a shorter and of a longer error, and density, at a radius that is not negative, by the guarded rule.
    pub fn at(&self, radius: f64) -> AtRadius {
        self.beyond_dead(radius, |reach| {
            if self.live > 1
                && let Some(nodes) = self.rule.nodes()
            {
                let Point { at, .. } = self.by_contour(nodes, reach);
                if at.inside >= SADDLE_BELOW && at.outside >= SADDLE_BELOW {
                    return at;
                }
            }
            self.by_saddle(reach).at
        })
    }

    /// The same by the slow positive sums alone, which judge the contours.
    pub fn at_by_strip(&self, radius: f64) -> AtRadius {
        self.beyond_dead(radius, |reach| self.by_strip(reach))
    }

    /// The law at a radius from the law of the live axes alone.
    fn beyond_dead(&self, radius: f64, live: impl Fn(f64) -> AtRadius) -> AtRadius {
        if self.live == 0 {
            let inside = if radius >= self.dead { 1.0 } else { 0.0 };
            return AtRadius { inside, outside: 1.0 - inside, density: 0.0 };
        }
        let square = (radius - self.dead) * (radius + self.dead);
        if !(square > 0.0) {
            return AtRadius { inside: 0.0, outside: 1.0, density: 0.0 };
        }
        let reach = sqrt(square);
        let at = live(reach);
        AtRadius { density: at.density * (radius / reach), ..at }
    }

    /// The radius that the error exceeds with risk q, `0 < q < 1`.
    pub fn radius(&self, q: f64) -> f64 {
        debug_assert!(q > 0.0 && q < 1.0);
        let reach = match self.live {
            0 => 0.0,
            1 if self.means[0] == 0.0 => self.sigmas[0] * two_sided_factor(q),
            _ => self.reach(q),
        };
        hypot(self.dead, reach)
    }

    fn reach(&self, q: f64) -> f64 {
        let longest = self.longest(q);
        let start = self.wilson_hilferty(q);
        let contour = if self.live > 1 { self.rule.nodes() } else { None };
        match contour {
            Some(nodes) if (lanes::SMALLEST..=1.0 - lanes::SMALLEST).contains(&q) => {
                search::radius(q, start, longest, |h| self.by_contour(nodes, h))
            }
            _ => search::radius(q, start, longest, |h| self.by_saddle(h)),
        }
    }

    /// P(|e| > |mean| + t) is at most P(sigma_1 chi > t), and chi in space is at most 1.5 longer than in the plane.
    fn longest(&self, q: f64) -> f64 {
        let mean = hypot(hypot(self.means[0], self.means[1]), self.means[2]);
        mean + self.sigmas[0] * (sqrt(-2.0 * super::float::ln(q)) + 1.5)
    }

    fn wilson_hilferty(&self, q: f64) -> f64 {
        wilson_hilferty(&self.variances, &self.means, one_sided_factor(q))
    }

    /// By the saddle point; one axis alone has a closed form, and lengths beyond all use are sliced.
    fn by_saddle(&self, reach: f64) -> Point {
        let saddle =
            saddle::Saddle { largest: self.variances[0], variances: &self.variances[..self.live], means: &self.means[..self.live] };
        let point = if self.live > 1 { saddle.at(reach) } else { None };
        point.unwrap_or_else(|| Point { at: self.by_strip(reach), slope: None })
    }

    fn by_strip(&self, reach: f64) -> AtRadius {
        strip::at(&self.sigmas[..self.live], &self.means[..self.live], reach)
    }

    fn by_contour(&self, nodes: &[Node], reach: f64) -> Point {
        let trace = self.variances[0] + self.variances[1] + self.variances[2];
        let x = reach * reach / trace;
        let variances = self.variances.map(|v| v / trace);
        let [inside, density, slope] = if self.rule == Rule::Talbot14 {
            let [v1, v2, v3] = variances;
            let v = contour::Invariants { minors: [v1 * v2 + v1 * v3 + v2 * v3], determinant: [v1 * v2 * v3] };
            contour::centred_sums(nodes, &[x], &v).map(|[sum]| sum)
        } else {
            contour::offset_sums(nodes, x, &variances, &self.means.map(|m| m * m / trace))
        };
        let square = reach * reach;
        Point {
            at: AtRadius { inside, outside: 1.0 - inside, density: 2.0 * density / reach },
            slope: Some((2.0 * density + 4.0 * slope) / square),
        }
    }
}

/// Wilson and Hilferty's radius: the cube root of |e|^2 taken as normal with the first two moments of |e|^2.
///
/// ```text
/// T = sum(lambda + m^2)   v = 2 sum(lambda^2 + 2 lambda m^2)/T^2   R = sqrt(T) (z sqrt(v/9) + 1 - v/9)^(3/2)
/// ```
pub(crate) fn wilson_hilferty(variances: &[f64; 3], means: &[f64; 3], z: f64) -> f64 {
    let (mut total, mut spread) = (0.0, 0.0);
    for (variance, mean) in variances.iter().zip(means) {
        total += variance + mean * mean;
        spread += variance * variance + 2.0 * variance * mean * mean;
    }
    if total == 0.0 {
        return 0.0;
    }
    let root = wilson_hilferty_root(z, 2.0 * spread / (total * total) / 9.0);
    sqrt(total * root * root * root)
}

/// The bracket of Wilson and Hilferty's formula, which ends at zero.
#[inline(always)]
fn wilson_hilferty_root(z: f64, ninth: f64) -> f64 {
    let root = z * sqrt(ninth) + 1.0 - ninth;
    if root > 0.0 { root } else { 0.0 }
}
