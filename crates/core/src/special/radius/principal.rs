//! Principal axes of a symmetric 3x3 matrix.

use crate::special::float::sqrt;

/// Eigenvalues, largest first, and eigenvectors as the columns of `axes[row][column]`.
///
/// Cyclic Jacobi rotations: on a positive matrix they keep the relative accuracy of the small eigenvalues, which the usual
/// tridiagonal methods lose. Two axes of exactly zero covariance stay as they are, so a diagonal matrix costs nothing.
pub fn principal_axes(matrix: &[[f64; 3]; 3]) -> ([f64; 3], [[f64; 3]; 3]) {
    let mut v = *matrix;
    let mut axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    // Convergence is quadratic: five sweeps have always been enough, the rest is a guard.
    for _ in 0..16 {
        let mut rotated = false;
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            rotated |= rotate(&mut v, &mut axes, p, q);
        }
        if !rotated {
            break;
        }
    }
    let mut order = [0, 1, 2];
    order.sort_unstable_by(|i, j| v[*j][*j].total_cmp(&v[*i][*i]));
    (order.map(|i| v[i][i]), axes.map(|row| order.map(|i| row[i])))
}

/// Annuls one off-diagonal element; false when it is already negligible against its own two variances.
fn rotate(v: &mut [[f64; 3]; 3], axes: &mut [[f64; 3]; 3], p: usize, q: usize) -> bool {
    let off = v[p][q];
    if off == 0.0 || off.abs() <= 1e-17 * sqrt((v[p][p] * v[q][q]).abs()) {
        return false;
    }
    let theta = (v[q][q] - v[p][p]) / (2.0 * off);
    let t = theta.signum() / (theta.abs() + sqrt(1.0 + theta * theta));
    let c = 1.0 / sqrt(1.0 + t * t);
    let s = t * c;
    v[p][p] -= t * off;
    v[q][q] += t * off;
    v[p][q] = 0.0;
    v[q][p] = 0.0;
    let r = 3 - p - q;
    let (vp, vq) = (v[r][p], v[r][q]);
    v[r][p] = c * vp - s * vq;
    v[r][q] = s * vp + c * vq;
    v[p][r] = v[r][p];
    v[q][r] = v[r][q];
    for row in axes {
        let (ap, aq) = (row[p], row[q]);
        row[p] = c * ap - s * aq;
        row[q] = s * ap + c * aq;
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_axes_put_the_matrix_together_again() {
        let v = [[4.0, -5.0, 3.2], [-5.0, 9.0, 7.0], [3.2, 7.0, 64.0]];
        let (l, a) = principal_axes(&v);
        assert!(l[0] >= l[1] && l[1] >= l[2]);
        for i in 0..3 {
            for j in 0..3 {
                let back: f64 = (0..3).map(|k| a[i][k] * l[k] * a[j][k]).sum();
                let unit: f64 = (0..3).map(|k| a[k][i] * a[k][j]).sum();
                // A dozen rotations of numbers up to 64.
                assert!((back - v[i][j]).abs() < 64.0 * 8.0 * f64::EPSILON, "{i}{j}: {back}");
                assert!((unit - f64::from(u8::from(i == j))).abs() < 8.0 * f64::EPSILON);
            }
        }
    }

    #[test]
    fn small_eigenvalues_keep_their_digits() {
        // diag(1, 1e-8) turned by (3/5, 4/5): exact in rationals; the determinant of the rounded matrix fixes what may be required.
        let (l, s) = ([1.0, 1e-8], [0.6, 0.8]);
        let v = [
            [s[0] * s[0] * l[0] + s[1] * s[1] * l[1], s[0] * s[1] * (l[0] - l[1]), 0.0],
            [s[0] * s[1] * (l[0] - l[1]), s[1] * s[1] * l[0] + s[0] * s[0] * l[1], 0.0],
            [0.0, 0.0, 1e-20],
        ];
        let (axes, _) = principal_axes(&v);
        assert!((axes[0] - 1.0).abs() < 4.0 * f64::EPSILON);
        assert!((axes[1] / 1e-8 - 1.0).abs() < 1e8 * 4.0 * f64::EPSILON);
        assert_eq!(axes[2], 1e-20);
    }
}
