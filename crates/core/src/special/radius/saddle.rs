//! The law of the squared length by its Laplace transform on a contour through the saddle point: small sides keep their digits, and every
//! mean costs the same.
//!
//! ```text
//! w = 1 + 2 lambda_1 z    w_j = 1 + r_j (w - 1)    r_j = lambda_j/lambda_1    n_j = m_j^2/lambda_1    k^2 = R^2/lambda_1
//! phi(w) = (w - 1)(k^2 - sum n_j/w_j)/2 - sum ln(w_j)/2                       M(z) exp(z R^2) = exp(phi)
//! P(|e| <= R) = (1/2 pi i) int exp(phi) dw/(w - 1)      to the right of w = 1; to its left the same integral is minus P(|e| > R)
//! ```
//!
//! The hyperbola `w = v + (A/sqrt 2)(1 - cosh u + i sinh u)` leaves its vertex v across the steepest way up and ends at 135 degrees, where no
//! factor of the integrand grows. The midpoint rule on it converges geometrically; the pole at w = 1 adds a known term to it, so that it may
//! lie anywhere. Nodes at most [`MOST_NODES`], steps to the saddle at most [`MOST_STEPS`]: the cost has a bound.

use super::AtRadius;
use super::search::Point;
use crate::special::float::{asin, exp, exp_m1, hypot, ln, sin_cos, sqrt, within};
use core::f64::consts::{FRAC_1_SQRT_2, PI};

/// Newton steps to the saddle point; three are usual, 23 were the most seen.
const MOST_STEPS: usize = 60;
/// The saddle needs to be known to this share of the width of the integrand there.
const NEAR: f64 = 0.05;
/// Least curvature of the exponent over u at the vertex: with less, the branch point at w = 0 is too near for the step.
const LEAST_CURVATURE: f64 = 12.0;
/// Moves of the vertex to the right until the curvature is reached; ten were the most seen.
const MOST_MOVES: usize = 40;
/// A in units of the vertex, so that the branch point w = 0 lies at u = i pi/4, as far as the pole's side goes: 1/(1 - 1/sqrt 2).
const OPENING: f64 = 3.414_213_562_373_095;
/// Step in standard deviations of the integrand, and the longest of all.
const STEP: f64 = 0.45;
const LONGEST_STEP: f64 = 0.125;
/// Above this curvature the integrand is over before its tails could tell the axes apart.
const NARROW: f64 = 400.0;
/// Half the step where an axis that is far from its mean and one that is not share the curvature: the worst error was 3e-8 without, 7e-12 with.
const MIXED_SHARE: f64 = 0.01;
const MIXED_STEP: f64 = 0.5;
/// Half the strip of u without a singularity, times two pi; and the digits required, as an exponent.
const STRIP: f64 = PI * PI / 2.0;
const DIGITS: f64 = 34.0;
/// Sides below exp(-20) are kept clear of the pole's term, whose size is one.
const SMALL: f64 = -20.0;
/// Where a term is less than 1e-18 of the first, the rest is left out; 72 nodes were the most seen.
const DROPPED: f64 = -42.0;
const MOST_NODES: usize = 96;

/// A law along its live axes, in units of the largest deviation.
#[derive(Debug, Clone, Copy)]
pub(super) struct Saddle<'a> {
    /// Variance of the longest axis.
    pub(super) largest: f64,
    pub(super) variances: &'a [f64],
    pub(super) means: &'a [f64],
}

/// First and second derivative of the exponent over w, and the part of the second that means have.
struct Slopes {
    first: f64,
    second: f64,
    of_means: f64,
}

type Complex = [f64; 2];

fn times(a: Complex, b: Complex) -> Complex {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
}

fn over(a: Complex, b: Complex) -> Complex {
    let square = b[0] * b[0] + b[1] * b[1];
    [(a[0] * b[0] + a[1] * b[1]) / square, (a[1] * b[0] - a[0] * b[1]) / square]
}

/// The principal root of a number above the real axis; the larger part is computed and the other divided by it.
fn root(a: Complex) -> Complex {
    let modulus = sqrt(a[0] * a[0] + a[1] * a[1]);
    let large = sqrt(0.5 * (modulus + a[0].abs()));
    let small = 0.5 * a[1] / large;
    if a[0] >= 0.0 { [large, small] } else { [small, large] }
}

impl Saddle<'_> {
    /// Each axis: its share of the largest variance and its squared mean in units of that.
    fn axes(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.variances.iter().zip(self.means).map(|(v, m)| (v / self.largest, m * m / self.largest))
    }

    /// Probabilities, density and its slope at a radius; `None` where squares of lengths would leave the range of doubles, and for sides
    /// below some 1e-60 that need more nodes than there are.
    pub(super) fn at(&self, reach: f64) -> Option<Point> {
        let squared = reach * reach / self.largest;
        let mean = self.means.iter().fold(0.0, |length, m| hypot(length, *m));
        if !((1e-60..1e60).contains(&squared) && mean * mean < 1e24 * self.largest) {
            return None;
        }
        // k^2 - sum n_j, without the cancellation of the two.
        let gap = (reach - mean) * ((reach + mean) / self.largest);
        let (vertex, curvature, of_means) = self.vertex(squared, gap);
        let shift = vertex - 1.0;
        let opening = OPENING * FRAC_1_SQRT_2 * vertex;
        // phi at the vertex, its slope there, and what the means add to the square of a step.
        let (mut weighted, mut slope, mut far, mut roots) = (0.0, gap, 0.0, 1.0);
        for (r, n) in self.axes() {
            let w = 1.0 + r * shift;
            roots *= w;
            weighted += n * r / w;
            slope += shift * n * r * (2.0 + r * shift) / (w * w);
            far += 0.5 * n * r / (w * w * (w + r * opening));
        }
        let slope = 0.5 * slope;
        let height = 0.5 * shift * (gap + shift * weighted);
        let mut step = (STEP / sqrt(curvature)).min(LONGEST_STEP);
        if curvature < NARROW {
            // How far the integrand rises to the right, as far as the strip goes.
            let rise = opening * (slope + far * opening);
            step = step.min(STRIP / (DIGITS + rise.max(0.0)));
            if of_means > MIXED_SHARE * curvature {
                step *= MIXED_STEP;
            }
        }
        let pole = pole_at(vertex);
        let size = height - 0.5 * ln(roots);
        if size < SMALL {
            // What the rule makes of the pole is exp(-2 pi p/h) of that: less than the digits of the side that is required.
            step = step.min(2.0 * PI * pole.abs() / (DIGITS - size));
        }
        let sums = self.sums(shift, slope, opening, step)?;
        let scale = exp(height) * step / PI;
        let [side, density, derivative] = sums.map(|sum| sum * scale);
        let at = if pole >= 0.0 {
            let outside = 1.0 / (1.0 + exp(2.0 * PI * pole / step)) - side;
            AtRadius { inside: 1.0 - outside, outside, density: 0.0 }
        } else {
            let inside = side + 1.0 / (1.0 + exp(-2.0 * PI * pole / step));
            AtRadius { inside, outside: 1.0 - inside, density: 0.0 }
        };
        let at = AtRadius { density: reach * density / self.largest, ..at };
        // No number passes for a probability that is none.
        (at.inside >= 0.0 && at.outside >= 0.0).then_some(Point { at, slope: Some((density + squared * derivative) / self.largest) })
    }

    fn slopes(&self, gap: f64, w: f64) -> Slopes {
        let shift = w - 1.0;
        let (mut first, mut of_means, mut of_roots) = (gap, 0.0, 0.0);
        for (r, n) in self.axes() {
            let w = 1.0 + r * shift;
            first += shift * n * r * (2.0 + r * shift) / (w * w) - r / w;
            of_means += n * r / (w * w * w);
            of_roots += 0.5 * r * r / (w * w);
        }
        Slopes { first: 0.5 * first, second: of_means + of_roots, of_means }
    }

    /// Where the contour crosses the real axis: the saddle point, or to its right where the branch point is near; with the curvature of the
    /// exponent over u, and the part of it that means have.
    fn vertex(&self, squared: f64, gap: f64) -> (f64, f64, f64) {
        let (mut roots, mut means) = (0.0, 0.0);
        for (r, n) in self.axes() {
            roots += r;
            means += n;
        }
        let mut w = (0.5 * roots + sqrt(0.25 * roots * roots + squared * means)) / squared;
        let (mut low, mut high) = (0.0, f64::INFINITY);
        for _ in 0..MOST_STEPS {
            let Slopes { first, second, .. } = self.slopes(gap, w);
            if first < 0.0 {
                low = w;
            } else {
                high = w;
            }
            let step = first / (second * w);
            let next = w * exp(-within(step, -1.5, 1.5));
            let next = if next > low && next < high {
                next
            } else if high < f64::INFINITY {
                0.5 * (low + high)
            } else {
                2.0 * w
            };
            let near = (next - w).abs() * sqrt(second) < NEAR;
            w = next;
            if near {
                break;
            }
        }
        let curved = |w: f64| {
            let (slopes, a) = (self.slopes(gap, w), OPENING * w);
            (0.5 * a * a * slopes.second + FRAC_1_SQRT_2 * a * slopes.first, 0.5 * a * a * slopes.of_means)
        };
        let (mut curvature, mut of_means) = curved(w);
        for _ in 0..MOST_MOVES {
            if curvature >= 0.99 * LEAST_CURVATURE {
                break;
            }
            w *= if curvature > 0.0 { within(LEAST_CURVATURE / curvature, 1.1, 4.0) } else { 2.0 };
            (curvature, of_means) = curved(w);
        }
        (w, curvature, of_means)
    }

    /// Sums over the nodes of the upper half: exp(phi - phi(v)) over w - 1, alone, and times w - 1. `None` where the nodes do not suffice.
    fn sums(&self, shift: f64, slope: f64, opening: f64, step: f64) -> Option<[f64; 3]> {
        let mut sums = [0.0; 3];
        for k in 0..MOST_NODES {
            let half = exp_m1(0.5 * step * (k as f64 + 0.5));
            // sinh of half of u, exact where u is small.
            let s = 0.5 * (half + half / (1.0 + half));
            let (less, sinh) = (2.0 * s * s, 2.0 * s * sqrt(1.0 + s * s));
            let way = [-opening * less, opening * sinh];
            let speed = [-opening * sinh, opening * (1.0 + less)];
            let square = times(way, way);
            let (mut exponent, mut roots) = ([slope * way[0], slope * way[1]], [1.0, 0.0]);
            for (r, n) in self.axes() {
                let vertex = 1.0 + r * shift;
                let w = [vertex + r * way[0], r * way[1]];
                roots = times(roots, root(w));
                if n > 0.0 {
                    let [re, im] = over(square, w);
                    let weight = 0.5 * n * r / (vertex * vertex);
                    exponent[0] += weight * re;
                    exponent[1] += weight * im;
                }
            }
            if exponent[0] < DROPPED {
                return Some(sums);
            }
            let (sin, cos) = sin_cos(exponent[1]);
            let size = exp(exponent[0]);
            let term = over(times([size * cos, size * sin], speed), roots);
            let from_pole = [shift + way[0], way[1]];
            sums[0] += over(term, from_pole)[1];
            sums[1] += term[1];
            sums[2] += times(term, from_pole)[1];
        }
        None
    }
}

/// Where the pole w = 1 lies on the imaginary axis of u, counted from the vertex away from the branch point:
///
/// ```text
/// v + (A/sqrt 2)(1 - cos p + sin p) = 1        sin^2(p/2 + pi/8) = (1 - 1/sqrt 2)/(2 v)
/// ```
///
/// Infinite where the axis does not reach it.
fn pole_at(vertex: f64) -> f64 {
    let near = (1.0 - vertex) / ((OPENING * FRAC_1_SQRT_2) * vertex);
    if near.abs() > 0.1 {
        let square = (0.5 - 0.5 * FRAC_1_SQRT_2) / vertex;
        return if square < 1.0 { 2.0 * asin(sqrt(square)) - 0.25 * PI } else { f64::INFINITY };
    }
    // Near the vertex the place is needed to a share of itself.
    let mut p = near;
    for _ in 0..6 {
        let (half_sin, half_cos) = sin_cos(0.5 * p);
        let (sin, cos) = (2.0 * half_sin * half_cos, 1.0 - 2.0 * half_sin * half_sin);
        p -= (2.0 * half_sin * half_sin + sin - near) / (sin + cos);
    }
    p
}
