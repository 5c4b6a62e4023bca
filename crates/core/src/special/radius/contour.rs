//! Contour inversion of the Laplace transform of the squared length of a Gaussian vector.
//!
//! ```text
//! Q = e'e     M(z) = E exp(-zQ) = det(I + 2zV)^(-1/2) exp(-sum_j m_j^2 z/(1 + 2 lambda_j z))
//! P(Q <= x) = sum Re[(w/c) M(c/x)]     p = (1/x) sum Re[w M]     p' = (1/x^2) sum Re[w c M]
//! ```
//!
//! All singularities of M lie on z <= 0, so the sums converge geometrically whatever the axis ratio. Without a mean M needs no
//! eigenvalues, only the invariants of V: det(I + 2zV) is a cubic in z. Lengths are scaled so that the trace of V is one.

use super::nodes::Node;
use crate::special::float::{exp, sin_cos, sqrt};

/// The determinant and the sum of the principal minors of a covariance of unit trace.
#[derive(Clone, Copy)]
pub(super) struct Invariants<const L: usize> {
    pub(super) minors: [f64; L],
    pub(super) determinant: [f64; L],
}

/// x^3 det(I + 2 V c/x) is a cubic p(x, c); this is 1/sqrt(p), continued along the contour from the positive axis.
///
/// The argument of p, summed over its three factors, runs from 0 to 3 pi, so a principal root may have the wrong sign. The roots
/// of p in x lie below the real axis, and so do those of dp/dx (Gauss-Lucas); dp/dx therefore lags p by less than pi, and the
/// root keeps its principal sign exactly where neither imaginary part is negative. The larger part of the root is computed and
/// the other divided by it: their difference would cancel where a variance is tiny.
#[inline(always)]
fn inverse_root(node: &Node, x: f64, minors: f64, determinant: f64) -> [f64; 2] {
    let (linear, square, cube) = (2.0 * x * x, 4.0 * minors * x, 8.0 * determinant);
    let re = x * x * x + linear * node.c[0] + square * node.c2[0] + cube * node.c3[0];
    let im = linear * node.c[1] + square * node.c2[1] + cube * node.c3[1];
    let slope_im = x * node.c[1] + minors * node.c2[1];
    let modulus = sqrt(re * re + im * im);
    let sum = modulus + re.abs();
    let scale = 0.5 / (sqrt(0.5 * sum) * modulus);
    let (large, small) = (sum * scale, im.abs() * scale);
    let (real, imaginary) = if re >= 0.0 { (large, small) } else { (small, large) };
    let keeps = im >= 0.0 && slope_im >= 0.0;
    let turns = im >= 0.0 && slope_im < 0.0;
    [if keeps { real } else { -real }, if turns { imaginary } else { -imaginary }]
}

/// The three sums without a mean, lane by lane: probability, x times density, x^2 times its derivative.
#[inline(always)]
pub(super) fn centred_sums<const L: usize>(nodes: &[Node], x: &[f64; L], v: &Invariants<L>) -> [[f64; L]; 3] {
    let mut sums = [[0.0; L]; 3];
    for node in nodes {
        for l in 0..L {
            let [re, im] = inverse_root(node, x[l], v.minors[l], v.determinant[l]);
            sums[0][l] += node.a[0] * re - node.a[1] * im;
            sums[1][l] += node.ac[0] * re - node.ac[1] * im;
            sums[2][l] += node.acc[0] * re - node.acc[1] * im;
        }
    }
    for l in 0..L {
        let factor = x[l] * sqrt(x[l]);
        for sum in &mut sums {
            sum[l] *= factor;
        }
    }
    sums
}

/// The same three sums with a mean: `variances` and `squared_means` along the principal axes.
pub(super) fn offset_sums(nodes: &[Node], x: f64, variances: &[f64; 3], squared_means: &[f64; 3]) -> [f64; 3] {
    let [v1, v2, v3] = *variances;
    let (minors, determinant) = (v1 * v2 + v1 * v3 + v2 * v3, v1 * v2 * v3);
    let mut sums = [0.0; 3];
    for node in nodes {
        let [re, im] = inverse_root(node, x, minors, determinant);
        let (mut exponent_re, mut exponent_im) = (0.0, 0.0);
        for (variance, squared_mean) in variances.iter().zip(squared_means) {
            // m^2 c/(x + 2 lambda c), by the conjugate of the denominator.
            let (below_re, below_im) = (x + 2.0 * variance * node.c[0], 2.0 * variance * node.c[1]);
            let share = squared_mean / (below_re * below_re + below_im * below_im);
            exponent_re -= share * (node.c[0] * below_re + node.c[1] * below_im);
            exponent_im -= share * (node.c[1] * below_re - node.c[0] * below_im);
        }
        let (sin, cos) = sin_cos(exponent_im);
        let size = exp(exponent_re);
        let (m_re, m_im) = (size * (re * cos - im * sin), size * (re * sin + im * cos));
        sums[0] += node.a[0] * m_re - node.a[1] * m_im;
        sums[1] += node.ac[0] * m_re - node.ac[1] * m_im;
        sums[2] += node.acc[0] * m_re - node.acc[1] * m_im;
    }
    let factor = x * sqrt(x);
    sums.map(|sum| sum * factor)
}
