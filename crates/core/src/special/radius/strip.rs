//! The strip rule: the Gaussian sliced across its thinnest axis, positive terms only, so that small sides keep their digits.
//!
//! ```text
//! outside_d(R) = P(|y| > R) + int phi(y) outside_(d-1)(h) dy      y = R sin t,  h = R cos t
//! inside_d(R)  =              int phi(y) inside_(d-1)(h) dy       density_d(R) = int phi(y) R density_(d-1)(h) dt
//! ```

use super::AtRadius;
use crate::special::float::{asin, ln, sin_cos, sqrt};
use crate::special::normal::{density, tail};
use crate::special::quadrature::integrate;

/// Scaled distance squared over two at which an integrand is dropped: exp(-40) is 4e-18 of its peak.
const DROPPED: f64 = 40.0;
/// Room for the edge of the ball, where an integrand may rise by a power of the distance while its Gaussian factor already falls.
const EDGE: f64 = 20.0;
/// Longest panel of 32 nodes, in standard deviations.
const PANEL: f64 = 7.0;

/// Probabilities and density at a radius; standard deviations largest first, all positive, one a dimension.
pub(super) fn at(sigma: &[f64], mean: &[f64], radius: f64) -> AtRadius {
    match (sigma, mean) {
        ([s], [m]) => line(*s, *m, radius),
        ([wider @ .., s], [others @ .., m]) => slice(*s, *m, radius, |h| at(wider, others, h)),
        _ => AtRadius { inside: 1.0, outside: 0.0, density: 0.0 },
    }
}

/// One dimension: the folded normal.
pub(crate) fn line(sigma: f64, mean: f64, radius: f64) -> AtRadius {
    let (near, far) = ((radius - mean.abs()) / sigma, (radius + mean.abs()) / sigma);
    AtRadius { inside: between(-near, far), outside: tail(near) + tail(far), density: (density(near) + density(far)) / sigma }
}

/// P(lo < Z < hi) of a standard normal without cancellation: narrow intervals by quadrature, wide ones from the nearer tails.
pub(crate) fn between(lo: f64, hi: f64) -> f64 {
    if hi - lo < 1.0 {
        let [p] = integrate(lo, hi, 1, |x| [density(x)]);
        return p;
    }
    if lo > 0.0 {
        tail(lo) - tail(hi)
    } else if hi < 0.0 {
        tail(-hi) - tail(-lo)
    } else {
        1.0 - (tail(-lo) + tail(hi))
    }
}

fn slice(sigma: f64, mean: f64, radius: f64, inner: impl Fn(f64) -> AtRadius) -> AtRadius {
    if !(radius > 0.0) {
        return AtRadius { inside: 0.0, outside: 1.0, density: 0.0 };
    }
    let (lo, hi) = window(sigma, mean, radius, &inner);
    let (from, to) = (asin(lo / radius), asin(hi / radius));
    let panels = (radius * (to - from) / (PANEL * sigma)).clamp(1.0, 63.0) as usize + 1;
    let [inside, outside, density_sum] = integrate(from, to, panels, |t| {
        let (sin, cos) = sin_cos(t);
        let weight = density((radius * sin - mean) / sigma) * radius / sigma;
        let at = inner(radius * cos);
        [weight * cos * at.inside, weight * cos * at.outside, weight * at.density]
    });
    let beyond = line(sigma, mean, radius).outside;
    AtRadius { inside, outside: beyond + outside, density: density_sum }
}

/// Where the integrands matter: around the point of the ball nearest to the mean, as far as the Gaussian factor stays above
/// exp(-40) of it, plus what the inner factor may gain on the way.
fn window(sigma: f64, mean: f64, radius: f64, inner: &impl Fn(f64) -> AtRadius) -> (f64, f64) {
    let nearest = mean.clamp(-radius, radius);
    let (here, widest) = (inner(sqrt((radius - nearest) * (radius + nearest))), inner(radius));
    let gain = |best: f64, here: f64| if here > 0.0 && best > here { ln(best / here) } else { 0.0 };
    let allowance = DROPPED + EDGE + gain(1.0, here.outside).max(gain(widest.inside, here.inside));
    let reach = sigma * sqrt(((nearest - mean) / sigma) * ((nearest - mean) / sigma) + 2.0 * allowance);
    ((mean - reach).max(-radius), (mean + reach).min(radius))
}
