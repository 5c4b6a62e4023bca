//! The strip rule: the Gaussian sliced across its thinnest axis, positive terms only, so that small sides keep their digits.
//!
//! ```text
//! outside_d(R) = P(|y| > R) + int phi(y) outside_(d-1)(h) dy      y = R cos t,  h = R sin t
//! inside_d(R)  =              int phi(y) inside_(d-1)(h) dy       density_d(R) = int phi(y) R density_(d-1)(h) dt
//! ```

use super::AtRadius;
use crate::special::float::{acos, ln, sin_cos, sqrt, within};
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
    let outside = tail(near) + tail(far);
    let inside = if outside < 0.5 { 1.0 - outside } else { between(-near, far) };
    AtRadius { inside, outside, density: (density(near) + density(far)) / sigma }
}

/// P(lo < Z < hi) of a standard normal with its own digits, hi not below -lo: from the tails, or by the density's even derivatives
/// where the tails would cancel. The first term left out is below 2e-16 there.
fn between(lo: f64, hi: f64) -> f64 {
    let (middle, half) = (0.5 * (lo + hi), 0.5 * (hi - lo));
    if half * (1.0 + middle) >= 0.03 {
        return if lo > 0.0 { tail(lo) - tail(hi) } else { 1.0 - (tail(-lo) + tail(hi)) };
    }
    let (m2, h2) = (middle * middle, half * half);
    let second = m2 - 1.0;
    let fourth = (m2 - 6.0) * m2 + 3.0;
    let sixth = ((m2 - 15.0) * m2 + 45.0) * m2 - 15.0;
    2.0 * half * density(middle) * (1.0 + h2 * (second / 6.0 + h2 * (fourth / 120.0 + h2 * sixth / 5040.0)))
}

fn slice(sigma: f64, mean: f64, radius: f64, inner: impl Fn(f64) -> AtRadius) -> AtRadius {
    if !(radius > 0.0) {
        return AtRadius { inside: 0.0, outside: 1.0, density: 0.0 };
    }
    // The ball has no left and right.
    let mean = mean.abs();
    let (lo, hi) = window(sigma, mean, radius, &inner);
    let panels = |length: f64| (length / PANEL).clamp(1.0, 63.0) as usize + 1;
    let [inside, outside, density_sum] = if radius - hi.max(-lo) >= 0.5 * (hi - lo) {
        // Far from the poles y itself is the variable, counted from the mean so that a thin axis loses no digits.
        let (from, to) = ((lo - mean) / sigma, (hi - mean) / sigma);
        integrate(from, to, panels(to - from), |z| {
            let (y, weight) = (mean + sigma * z, density(z));
            let h = sqrt((radius - y) * (radius + y));
            let at = inner(h);
            [weight * at.inside, weight * at.outside, weight * at.density * (radius / h)]
        })
    } else {
        // y = R cos t keeps the integrand smooth at the poles; the distance from the mean is counted from the near pole.
        let (from, to) = (acos(hi / radius), acos(lo / radius));
        integrate(from, to, panels(radius * (to - from) / sigma), |t| {
            let (sin_half, cos_half) = sin_cos(0.5 * t);
            let weight = density(((radius - mean) - 2.0 * radius * sin_half * sin_half) / sigma) * radius / sigma;
            let sin = 2.0 * sin_half * cos_half;
            let at = inner(radius * sin);
            [weight * sin * at.inside, weight * sin * at.outside, weight * at.density]
        })
    };
    let beyond = line(sigma, mean, radius).outside;
    AtRadius { inside, outside: beyond + outside, density: density_sum }
}

/// Where the integrands matter: around the point of the ball nearest to the mean, as far as the Gaussian factor stays above
/// exp(-40) of it, plus what the inner factor may gain on the way.
fn window(sigma: f64, mean: f64, radius: f64, inner: &impl Fn(f64) -> AtRadius) -> (f64, f64) {
    let nearest = within(mean, -radius, radius);
    let (here, widest) = (inner(sqrt((radius - nearest) * (radius + nearest))), inner(radius));
    let gain = |best: f64, here: f64| if here > 0.0 && best > here { ln(best / here) } else { 0.0 };
    let allowance = DROPPED + EDGE + gain(1.0, here.outside).max(gain(widest.inside, here.inside));
    let reach = sigma * sqrt(((nearest - mean) / sigma) * ((nearest - mean) / sigma) + 2.0 * allowance);
    ((mean - reach).max(-radius), (mean + reach).min(radius))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interval_keeps_its_digits_on_both_sides_of_the_seam() {
        for middle in [0.0, 0.3, 1.0, 4.0, 12.0, 30.0] {
            for share in [1e-3, 0.5, 0.99, 1.01, 2.0] {
                let half = 0.03 * share / (1.0 + middle);
                let [exact] = integrate(middle - half, middle + half, 1, |x| [density(x)]);
                // Beyond the seam the tails cancel to a thirtieth of themselves, each with the rounding of its argument squared.
                let allowed = if share < 1.0 { 2e-15 } else { 2e-14 } * (1.0 + middle * middle);
                let inside = between(middle - half, middle + half);
                assert!((inside / exact - 1.0).abs() < allowed, "{middle} {half}: {inside} {exact}");
            }
        }
    }

    #[test]
    fn both_sides_add_up_to_one() {
        let cases: [(&[f64], &[f64]); 4] = [
            (&[1.0, 0.3], &[0.0, 0.0]),
            (&[2.0, 1e-3], &[1.0, 4.0]),
            (&[3.0, 2.0, 1.0], &[0.5, -1.0, 2.0]),
            (&[1.0, 1.0, 1e-6], &[0.0, 0.0, 3.0]),
        ];
        for (sigma, mean) in cases {
            for radius in [0.5, 1.0, 3.5, 5.0, 9.0] {
                let sides = at(sigma, mean, radius);
                // Two sums of 4000 positive terms.
                assert!((sides.inside + sides.outside - 1.0).abs() < 2e-13, "{sigma:?} {mean:?} {radius}: {sides:?}");
            }
        }
    }
}
