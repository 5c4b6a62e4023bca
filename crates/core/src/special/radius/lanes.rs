//! Radius of a zero-mean error at one fixed risk, several covariances abreast.
//!
//! A fixed number of steps and no data-dependent branch, so that the compiler can use vector registers; one lane and eight give
//! the same bits because every operation is elementwise.

use super::contour::{Invariants, centred_sums};
use super::nodes::{Node, TALBOT_8, TALBOT_14};
use super::wilson_hilferty_root;
#[cfg(test)]
use crate::special::float::ln;
use crate::special::float::sqrt;
use crate::special::normal::one_sided_factor;

/// Everything that depends on the risk alone, prepared once.
#[derive(Debug, Clone, Copy)]
pub struct CentredRadius {
    risk: f64,
    z: f64,
    steps: usize,
}

/// The largest risk with a small enough Wilson-Hilferty error for a fixed number of steps.
const LARGEST: f64 = 0.5;
/// Below this risk the absolute rounding noise of the contour costs more than 1e-9 of the radius.
pub(super) const SMALLEST: f64 = 1e-6;

impl CentredRadius {
    /// Prepared for one risk, or `None` where the strip rule or a safeguarded search is needed instead: outside [1e-6, 0.5].
    pub fn new(risk: f64) -> Option<Self> {
        if !(SMALLEST..=LARGEST).contains(&risk) {
            return None;
        }
        Some(Self { risk, z: one_sided_factor(risk), steps: if risk >= 1e-3 { 1 } else { 2 } })
    }

    /// Radii of covariances given as upper triangles \[xx, xy, yy, xz, yz, zz\], one covariance a lane; the unit is that of sigma.
    ///
    /// The caller has checked that each is a covariance. A point (zero trace) has radius zero.
    #[inline(always)]
    pub fn radii<const L: usize>(&self, upper: &[[f64; L]; 6]) -> [f64; L] {
        let (trace, v) = invariants(upper);
        let mut x = [0.0; L];
        for l in 0..L {
            // Wilson-Hilferty: v = 2 sum lambda^2 / T^2, and sum lambda^2 = T^2 - 2 (sum of the minors).
            let ninth = (2.0 - 4.0 * v.minors[l]) / 9.0;
            let root = wilson_hilferty_root(self.z, ninth);
            x[l] = root * root * root;
        }
        self.step(&TALBOT_8, &mut x, &v);
        for _ in 0..self.steps {
            self.step(&TALBOT_14, &mut x, &v);
        }
        let mut radius = [0.0; L];
        for l in 0..L {
            radius[l] = sqrt(x[l] * trace[l]);
        }
        radius
    }

    /// Halley's step on g(x) = ln(outside(x) / risk): g' = -h, g'' = -p'/outside - h^2 with h = p/outside.
    #[inline(always)]
    fn step<const L: usize>(&self, nodes: &[Node], x: &mut [f64; L], v: &Invariants<L>) {
        let [inside, density, slope] = centred_sums(nodes, x, v);
        for l in 0..L {
            let outside = 1.0 - inside[l];
            let g = ln_near_one(outside / self.risk);
            let h = density[l] / outside;
            let curvature = slope[l] / outside + h * h;
            x[l] += x[l] * (2.0 * g * h / (2.0 * h * h + g * curvature));
        }
    }
}

/// Trace, and the invariants of the covariance divided by its trace.
#[inline(always)]
pub(super) fn invariants<const L: usize>(upper: &[[f64; L]; 6]) -> ([f64; L], Invariants<L>) {
    let mut trace = [0.0; L];
    let mut v = Invariants { minors: [0.0; L], determinant: [0.0; L] };
    for l in 0..L {
        trace[l] = upper[0][l] + upper[2][l] + upper[5][l];
        let scale = 1.0 / if trace[l] > 0.0 { trace[l] } else { 1.0 };
        let (a, b, c) = (upper[0][l] * scale, upper[1][l] * scale, upper[2][l] * scale);
        let (d, e, f) = (upper[3][l] * scale, upper[4][l] * scale, upper[5][l] * scale);
        v.minors[l] = (a * c - b * b) + (a * f - d * d) + (c * f - e * e);
        v.determinant[l] = a * (c * f - e * e) - b * (b * f - e * d) + d * (b * e - c * d);
    }
    (trace, v)
}

/// ln t, exact to rounding near one and good to 1e-4 from 1/4 to 4: 2 atanh((t-1)/(t+1)) by its series. The last step is always taken
/// near one; a coarse logarithm earlier only moves the next start.
#[inline(always)]
fn ln_near_one(t: f64) -> f64 {
    let s = (t - 1.0) / (t + 1.0);
    let s2 = s * s;
    let series = 1.0 / 15.0;
    let series = series * s2 + 1.0 / 13.0;
    let series = series * s2 + 1.0 / 11.0;
    let series = series * s2 + 1.0 / 9.0;
    let series = series * s2 + 1.0 / 7.0;
    let series = series * s2 + 1.0 / 5.0;
    let series = series * s2 + 1.0 / 3.0;
    2.0 * (s + s * s2 * series)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_short_logarithm_is_exact_where_the_last_step_uses_it() {
        for k in -50..=50 {
            let t = 1.0 + 1e-3 * f64::from(k);
            assert!((ln_near_one(t) - ln(t)).abs() <= 2.0 * f64::EPSILON * ln(t).abs().max(1e-3), "{t}");
        }
        for t in [0.25, 0.5, 2.0, 4.0] {
            assert!((ln_near_one(t) - ln(t)).abs() <= 1e-4, "{t}");
        }
    }
}
