//! Regions with corners: the rectangle of a tunnel, the cylinder, the box; forward (risk) and back (size).

use super::accept::{accept, accepted_axes};
use super::radial::flat;
use crate::quantity::{OutOfDomain, Risk};
use crate::special::float::{ln, sqrt, within};
use crate::special::normal::{density, two_sided_factor};
use crate::special::quadrature::integrate_broken;
use crate::special::radius::strip::line;
use crate::special::radius::{AtRadius, RadiusLaw};

/// Both sides of a region, each with its own digits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sides {
    /// Probability that the error is inside.
    pub inside: f64,
    /// Probability that it is outside.
    pub outside: f64,
}

/// Deviations from the mean beyond which the normal density is dropped: what is lost is 1e-44 of probability.
const REACH: f64 = 14.0;
/// Longest panel of 32 nodes, in standard deviations.
const PANEL: f64 = 6.0;
/// Deviations over which a conditional probability goes from one to nothing.
const EDGE: f64 = 9.0;
/// A region is searched until the logarithm of its risk is this close; a digit more than the probabilities carry.
const CLOSE: f64 = 1e-13;

/// Names of a shaped region's arguments, to blame the right one.
const NAMES: [&str; 2] = ["covariance", "mean"];

/// Probability of |c| <= `half_sizes[0]` and |v| <= `half_sizes[1]` for a covariance \[cc, cv, vv\] \[m²\] and a mean \[m\].
///
/// ```text
/// integral over v of phi(v) P(|c| <= a given v)     c given v: mean m_c + (cv/vv)(v - m_v), variance cc - cv^2/vv
/// ```
///
/// with breaks where the conditional mean crosses +-a.
///
/// # Errors
/// [`OutOfDomain`]: a covariance that is none, a mean that is not finite, a half size that is not positive.
pub fn rectangle(covariance: [f64; 3], mean: [f64; 2], half_sizes: [f64; 2]) -> Result<Sides, OutOfDomain> {
    check([("half_cross_m", half_sizes[0]), ("half_up_m", half_sizes[1])], &mean)?;
    let [cc, cv, vv] = covariance;
    // As it came: what is accepted may be turned to its principal axes, which the sides of a rectangle do notice.
    accept([cc, cv, vv, 0.0, 0.0, 0.0], NAMES[0])?;
    Ok(rectangle_sides(covariance, mean, half_sizes))
}

fn rectangle_sides([cc, cv, vv]: [f64; 3], [mc, mv]: [f64; 2], [a, b]: [f64; 2]) -> Sides {
    if !(vv > 0.0) {
        return both(interval(0.0, mv, b), interval(sqrt(cc.max(0.0)), mc, a));
    }
    let (slope, sigma) = (cv / vv, sqrt(vv));
    let rest = sqrt((cc - cv * slope).max(0.0));
    let mut breaks = [f64::NAN; 6];
    for (i, edge) in [-a, a].into_iter().enumerate() {
        for (j, shift) in [-EDGE, 0.0, EDGE].into_iter().enumerate() {
            breaks[3 * i + j] = mv + (edge - mc + shift * rest) / slope;
        }
    }
    let (lo, hi) = ((-b).max(mv - REACH * sigma), b.min(mv + REACH * sigma));
    let [inside, outside] = integrate_broken(lo, hi, breaks, PANEL * sigma, |v| {
        let weight = density((v - mv) / sigma) / sigma;
        let c = interval(rest, mc + slope * (v - mv), a);
        [weight * c.inside, weight * c.outside]
    });
    Sides { inside, outside: outside + line(sigma, mv, b).outside }
}

/// Both sides of |x| <= half for a normal x, which may be fixed.
fn interval(sigma: f64, mean: f64, half: f64) -> Sides {
    if sigma > 0.0 {
        let AtRadius { inside, outside, .. } = line(sigma, mean, half);
        return Sides { inside, outside };
    }
    let inside = if mean.abs() <= half { 1.0 } else { 0.0 };
    Sides { inside, outside: 1.0 - inside }
}

/// Two independent conditions at once.
fn both(first: Sides, second: Sides) -> Sides {
    Sides { inside: first.inside * second.inside, outside: first.outside + first.inside * second.outside }
}

/// Probability of a horizontal error within `radius` and |u| <= `half_height`; `upper` is the triangle \[ee, en, nn, eu, nu, uu\] \[m²\].
///
/// The disc's law is integrated over u, with the mean and covariance that the horizontal error has given u.
///
/// # Errors
/// As [`rectangle`].
pub fn cylinder(upper: [f64; 6], mean: [f64; 3], radius: f64, half_height: f64) -> Result<Sides, OutOfDomain> {
    check([("radius_m", radius), ("half_height_m", half_height)], &mean)?;
    let [ee, en, nn, eu, nu, uu] = accept(upper, NAMES[0]).map(|_| upper)?;
    if !(uu > 0.0) {
        let disc = disc_of([ee, en, nn])?.at([mean[0], mean[1]], radius);
        return Ok(both(interval(0.0, mean[2], half_height), disc));
    }
    let slope = [eu / uu, nu / uu];
    let disc = disc_of([ee - eu * slope[0], en - eu * slope[1], nn - nu * slope[1]])?;
    let sigma = sqrt(uu);
    let mut breaks = [f64::NAN; 10];
    for (i, shift) in [0.0, -EDGE, EDGE].into_iter().enumerate() {
        for (j, spread) in disc.sigmas.into_iter().enumerate() {
            if i > 0 || j > 0 {
                let k = (2 * i + j - 1) * 2;
                [breaks[k], breaks[k + 1]] = crossings([mean[0], mean[1]], slope, radius + shift * spread);
            }
        }
    }
    let (lo, hi) = ((-half_height).max(mean[2] - REACH * sigma), half_height.min(mean[2] + REACH * sigma));
    let breaks = breaks.map(|t| mean[2] + t);
    let [inside, outside] = integrate_broken(lo, hi, breaks, PANEL * sigma, |u| {
        let (weight, t) = (density((u - mean[2]) / sigma) / sigma, u - mean[2]);
        let at = disc.at([mean[0] + slope[0] * t, mean[1] + slope[1] * t], radius);
        [weight * at.inside, weight * at.outside]
    });
    Ok(Sides { inside, outside: outside + line(sigma, mean[2], half_height).outside })
}

/// Where |m + g t| = r: the two roots t, NaN where there are none.
fn crossings(m: [f64; 2], g: [f64; 2], r: f64) -> [f64; 2] {
    let square = g[0] * g[0] + g[1] * g[1];
    let middle = -(m[0] * g[0] + m[1] * g[1]) / square;
    let miss = (m[0] * g[1] - m[1] * g[0]) / sqrt(square);
    let reach = sqrt((r - miss) * (r + miss) / square);
    if r > 0.0 { [middle - reach, middle + reach] } else { [f64::NAN; 2] }
}

/// A disc's law for one covariance and many means.
struct Disc {
    variances: [f64; 3],
    sigmas: [f64; 2],
    axes: [[f64; 3]; 3],
}

fn disc_of([ee, en, nn]: [f64; 3]) -> Result<Disc, OutOfDomain> {
    // A conditional variance may be rounding: what is left of a perfectly correlated error.
    let (ee, nn) = (ee.max(0.0), nn.max(0.0));
    let en = within(en, -sqrt(ee * nn), sqrt(ee * nn));
    let (variances, axes) = accepted_axes(flat([ee, en, nn, 0.0, 0.0, 0.0]), NAMES[0])?;
    Ok(Disc { variances, sigmas: [sqrt(variances[0]), sqrt(variances[1])], axes })
}

impl Disc {
    fn at(&self, mean: [f64; 2], radius: f64) -> Sides {
        let along = |j: usize| self.axes[0][j] * mean[0] + self.axes[1][j] * mean[1];
        let AtRadius { inside, outside, .. } = RadiusLaw::new(self.variances, [along(0), along(1), along(2)]).at(radius);
        Sides { inside, outside }
    }
}

/// Factor by which both half sizes of a rectangle are stretched until the error leaves it with this risk.
///
/// # Errors
/// As [`rectangle`].
pub fn rectangle_scale(covariance: [f64; 3], mean: [f64; 2], half_sizes: [f64; 2], risk: Risk) -> Result<f64, OutOfDomain> {
    rectangle(covariance, mean, half_sizes)?;
    let [cc, cv, vv] = covariance;
    let side =
        |variance: f64, mean: f64, size: f64, q: f64| RadiusLaw::new([variance.max(0.0), 0.0, 0.0], [mean, 0.0, 0.0]).radius(q) / size;
    let at = |q: f64| side(cc, mean[0], half_sizes[0], q).max(side(vv, mean[1], half_sizes[1], q));
    // One side alone is left with at most the whole risk; two sides with half of it each are enough.
    let bracket = (at(risk.q()), at(0.5 * risk.q()));
    Ok(scale(risk, bracket, |s| rectangle_sides([cc, cv, vv], mean, half_sizes.map(|h| s * h)).outside))
}

/// Factor by which the radius and the half height of a cylinder are stretched until the error leaves it with this risk.
///
/// # Errors
/// As [`cylinder`].
pub fn cylinder_scale(upper: [f64; 6], mean: [f64; 3], radius: f64, half_height: f64, risk: Risk) -> Result<f64, OutOfDomain> {
    cylinder(upper, mean, radius, half_height)?;
    let disc = super::radius_law(flat(upper), [mean[0], mean[1], 0.0], NAMES)?;
    let height = RadiusLaw::new([upper[5].max(0.0), 0.0, 0.0], [mean[2], 0.0, 0.0]);
    let at = |q: f64| (disc.radius(q) / radius).max(height.radius(q) / half_height);
    let bracket = (at(risk.q()), at(0.5 * risk.q()));
    Ok(scale(risk, bracket, |s| cylinder(upper, mean, s * radius, s * half_height).map_or(f64::NAN, |sides| sides.outside)))
}

/// Factor k of the box |e_i| <= k sigma_i that a zero-mean error leaves with this risk: 2.387738 at 5 % for three uncorrelated axes.
/// A flat error (no vertical variance) has a two-sided box.
///
/// # Errors
/// [`OutOfDomain`]: a covariance that is none; a variance of zero (horizontally), since a box has no factor there.
pub fn box_factor(upper: [f64; 6], risk: Risk) -> Result<f64, OutOfDomain> {
    accept(upper, NAMES[0])?;
    let [ee, en, nn, eu, nu, uu] = upper;
    let least = ee.min(nn);
    if !(least > 0.0) {
        return Err(OutOfDomain { argument: NAMES[0], value: least, unit: "m²", domain: "(0, inf) for the variances of a box" });
    }
    let correlation = |v: f64, a: f64, b: f64| if b > 0.0 { (v / sqrt(a * b)).clamp(-1.0, 1.0) } else { 0.0 };
    let rho = [correlation(en, ee, nn), correlation(eu, ee, uu), correlation(nu, nn, uu)];
    let axes = if uu > 0.0 { 3.0 } else { 2.0 };
    let bracket = (two_sided_factor(risk.q()), two_sided_factor(risk.q() / axes));
    Ok(scale(
        risk,
        bracket,
        |k| {
            if uu > 0.0 { cube_outside(rho, k) } else { rectangle_sides([1.0, rho[0], 1.0], [0.0; 2], [k; 2]).outside }
        },
    ))
}

/// Outside of the cube |z_i| <= k for standard normals with correlations \[12, 13, 23\]: the rectangle given z_3, over z_3.
fn cube_outside([r12, r13, r23]: [f64; 3], k: f64) -> f64 {
    let rest = [1.0 - r13 * r13, r12 - r13 * r23, 1.0 - r23 * r23].map(|v| if v.abs() < 4.0 * f64::EPSILON { 0.0 } else { v });
    let mut breaks = [f64::NAN; 12];
    for (i, (slope, variance)) in [(r13, rest[0]), (r23, rest[2])].into_iter().enumerate() {
        for (j, edge) in [-k, k].into_iter().enumerate() {
            for (n, shift) in [-EDGE, 0.0, EDGE].into_iter().enumerate() {
                breaks[6 * i + 3 * j + n] = (edge + shift * sqrt(variance)) / slope;
            }
        }
    }
    let [outside] = integrate_broken(-k, k, breaks, PANEL, |z| [density(z) * rectangle_sides(rest, [r13 * z, r23 * z], [k; 2]).outside]);
    outside + line(1.0, 0.0, k).outside
}

/// The factor at which a decreasing risk meets its value: false position with Anderson and Bjorck's correction on the logarithm.
fn scale(risk: Risk, (mut lo, mut hi): (f64, f64), outside: impl Fn(f64) -> f64) -> f64 {
    let excess = |s: f64| ln(outside(s) / risk.q()).clamp(-1e3, 1e3);
    let (mut g_lo, mut g_hi) = (excess(lo), excess(hi));
    // The bracket is exact on paper; rounding may put the root a hair outside.
    if !(g_lo > 0.0) {
        return lo;
    }
    if !(g_hi < 0.0) {
        return hi;
    }
    let mut last = 0.0;
    for _ in 0..80 {
        let s = (lo * g_hi - hi * g_lo) / (g_hi - g_lo);
        let s = if s > lo && s < hi { s } else { 0.5 * (lo + hi) };
        let g = excess(s);
        if g.abs() <= CLOSE || !(hi - lo > 4.0 * f64::EPSILON * hi) {
            return s;
        }
        // The end that stays twice is weakened, or it would stay for ever.
        let weaken = |replaced: f64| {
            let share = 1.0 - g / replaced;
            if g * last <= 0.0 {
                1.0
            } else if share > 0.0 {
                share
            } else {
                0.5
            }
        };
        if g > 0.0 {
            g_hi *= weaken(g_lo);
            (lo, g_lo) = (s, g);
        } else {
            g_lo *= weaken(g_hi);
            (hi, g_hi) = (s, g);
        }
        last = g;
    }
    0.5 * (lo + hi)
}

fn check(sizes: [(&'static str, f64); 2], mean: &[f64]) -> Result<(), OutOfDomain> {
    for (argument, value) in sizes {
        if !(value > 0.0 && value < 1e140) {
            return Err(OutOfDomain { argument, value, unit: "m", domain: "(0, 1e140)" });
        }
    }
    if let Some(bad) = mean.iter().find(|m| !(m.abs() < 1e140)) {
        return Err(OutOfDomain { argument: NAMES[1], value: *bad, unit: "m", domain: "(-1e140, 1e140)" });
    }
    Ok(())
}
