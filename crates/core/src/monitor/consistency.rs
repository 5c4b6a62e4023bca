//! May a covariance be believed? The error in its own units.

use crate::frame::{Covariance, Displacement, Frame};
use crate::special::float::sqrt;
use crate::special::gamma::chi_square_head;
use nalgebra::{Matrix2, SMatrix, SVector};

/// A direction whose variance is this share of its component's is rounding, not knowledge.
const SINGULAR: f64 = 1e-12;

/// e' V^-1 e: the normalised estimation error squared. Chi-square with three degrees of freedom for a consistent covariance. `None` when the
/// covariance is singular or anything is not a number.
pub fn normalised_square<F: Frame>(error: &Displacement<F>, covariance: &Covariance<F>) -> Option<f64> {
    square(*error.vector(), *covariance.matrix())
}

/// The same of the first two components: horizontal.
pub fn normalised_square_horizontal<F: Frame>(error: &Displacement<F>, covariance: &Covariance<F>) -> Option<f64> {
    let block: Matrix2<f64> = covariance.matrix().fixed_view::<2, 2>(0, 0).into_owned();
    square(error.vector().xy(), block)
}

/// Probability integral transform of a normalised square: uniform for a consistent covariance.
pub fn integral_transform(square: f64, dimension: usize) -> f64 {
    chi_square_head(dimension as f64, square)
}

/// |z|^2 with L z = e and V = L L', row by row.
fn square<const D: usize>(e: SVector<f64, D>, v: SMatrix<f64, D, D>) -> Option<f64> {
    let mut l = v;
    let mut z = e;
    for i in 0..D {
        for j in 0..i {
            let known: f64 = (0..j).map(|k| l[(i, k)] * l[(j, k)]).sum();
            l[(i, j)] = (v[(i, j)] - known) / l[(j, j)];
            z[i] -= l[(i, j)] * z[j];
        }
        let left = v[(i, i)] - (0..i).map(|k| l[(i, k)] * l[(i, k)]).sum::<f64>();
        if !(left > SINGULAR * v[(i, i)]) {
            return None;
        }
        l[(i, i)] = sqrt(left);
        z[i] /= l[(i, i)];
    }
    Some(z.norm_squared()).filter(|s| s.is_finite())
}
