//! All innovations of an instant together, and what they are without some of them.
//!
//! ```text
//! Q = gamma' M gamma,  M = (H P H' + V)^-1,  u = M gamma
//! without k:  Q - u_k^2 / M_kk,   u - M e_k u_k / M_kk,   M - M e_k e_k' M / M_kk
//! ```
//!
//! One inverse serves every set with some left out: the lines of a set are those of the inverse of its own matrix. Provenance: standard (Schur
//! complement).

use crate::solution::snapshot::RANGES_MOST;
use crate::special::float::sqrt;

/// Their weighted square is chi-square with as many degrees of freedom as there are ranges less one, the common clock being free.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Block {
    /// The weighted square.
    pub square: f64,
    /// Ranges less one.
    pub freedom: usize,
}

/// The innovations of an instant with their joint weights.
#[derive(Debug, Clone)]
pub struct Together {
    n: usize,
    kept: [bool; RANGES_MOST],
    inverse: [[f64; RANGES_MOST]; RANGES_MOST],
    weighted: [f64; RANGES_MOST],
    square: f64,
}

impl Together {
    /// Of a covariance, whose lower half is read, and innovations; `None` where it is not positive.
    pub fn of(mut covariance: [[f64; RANGES_MOST]; RANGES_MOST], innovation: [f64; RANGES_MOST], n: usize) -> Option<Self> {
        let inverse = inverted(&mut covariance, n)?;
        let mut weighted = [0.0; RANGES_MOST];
        for (w, row) in weighted.iter_mut().zip(&inverse[..n]) {
            *w = dot(&row[..n], &innovation[..n]);
        }
        let square = dot(&weighted[..n], &innovation[..n]);
        let kept = core::array::from_fn(|k| k < n);
        square.is_finite().then_some(Self { n, kept, inverse, weighted, square })
    }

    /// The weighted square; `None` where fewer than two are left.
    pub fn block(&self) -> Option<Block> {
        let freedom = self.kept[..self.n].iter().filter(|k| **k).count().checked_sub(1).filter(|f| *f > 0)?;
        Some(Block { square: self.square, freedom })
    }

    /// Whose absence makes the square smallest; the place of a range in the order in which they came.
    pub fn most_at_fault(&self) -> Option<usize> {
        let share = |k: &usize| self.weighted[*k] * self.weighted[*k] / self.inverse[*k][*k];
        (0..self.n).filter(|k| self.kept[*k]).max_by(|a, b| share(a).total_cmp(&share(b)))
    }

    /// Leaves one out.
    pub fn leave_out(&mut self, k: usize) {
        if !self.kept.get(k).is_some_and(|kept| *kept) {
            return;
        }
        let (line, own, u) = (self.inverse[k], self.inverse[k][k], self.weighted[k]);
        self.kept[k] = false;
        self.square -= u * u / own;
        for i in 0..self.n {
            self.weighted[i] -= line[i] * u / own;
            for j in 0..self.n {
                self.inverse[i][j] -= line[i] * line[j] / own;
            }
        }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// The inverse of a symmetric matrix, whose lower half is read and becomes its factor; `None` where it is not positive.
fn inverted(l: &mut [[f64; RANGES_MOST]; RANGES_MOST], n: usize) -> Option<[[f64; RANGES_MOST]; RANGES_MOST]> {
    for i in 0..n {
        for j in 0..i {
            let known = dot(&l[i][..j], &l[j][..j]);
            l[i][j] = (l[i][j] - known) / l[j][j];
        }
        let left = l[i][i] - dot(&l[i][..i], &l[i][..i]);
        if !(left > 0.0) {
            return None;
        }
        l[i][i] = sqrt(left);
    }
    // Columns of the factor's inverse as rows, then their products.
    let mut column = [[0.0; RANGES_MOST]; RANGES_MOST];
    for k in 0..n {
        column[k][k] = 1.0 / l[k][k];
        for i in k + 1..n {
            column[k][i] = -dot(&l[i][k..i], &column[k][k..i]) / l[i][i];
        }
    }
    let mut inverse = [[0.0; RANGES_MOST]; RANGES_MOST];
    for i in 0..n {
        for j in 0..=i {
            inverse[i][j] = dot(&column[i][i..n], &column[j][i..n]);
            inverse[j][i] = inverse[i][j];
        }
    }
    Some(inverse)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ranges that share a clock of 100 m and have 2 to 4 m of their own.
    fn covariance(i: usize, j: usize) -> f64 {
        let shared = 1e4 + 0.5 * ((i * j) as f64).cos().abs();
        shared + if i == j { 4.0 + (i % 3) as f64 * 6.0 } else { 0.0 }
    }

    fn together(innovation: &[f64]) -> Together {
        let n = innovation.len();
        let sigma = core::array::from_fn(|i| core::array::from_fn(|j| if i < n && j <= i { covariance(i, j) } else { 0.0 }));
        let gamma = core::array::from_fn(|k| innovation.get(k).copied().unwrap_or(0.0));
        Together::of(sigma, gamma, n).unwrap()
    }

    /// gamma' V^-1 gamma by elimination.
    fn square(mut v: Vec<Vec<f64>>, gamma: &[f64]) -> f64 {
        let n = gamma.len();
        let mut x = gamma.to_vec();
        for i in 0..n {
            for k in i + 1..n {
                let factor = v[k][i] / v[i][i];
                (i..n).for_each(|j| v[k][j] -= factor * v[i][j]);
                x[k] -= factor * x[i];
            }
        }
        for i in (0..n).rev() {
            let known: f64 = (i + 1..n).map(|j| v[i][j] * x[j]).sum();
            x[i] = (x[i] - known) / v[i][i];
        }
        dot(&x, gamma)
    }

    #[test]
    fn the_square_of_what_is_left_is_that_of_its_own_covariance() {
        let gamma = [0.5, -1.0, 12.0, 2.0, -0.3, 1.0, -9.0, 0.0, 1.5].map(|x| 50.0 + x);
        let mut all = together(&gamma);
        let mut left: Vec<usize> = (0..gamma.len()).collect();
        for out in [2, 6, 0] {
            all.leave_out(out);
            left.retain(|k| *k != out);
            let part = left.iter().map(|i| left.iter().map(|j| covariance(*i, *j)).collect()).collect();
            let rest: Vec<f64> = left.iter().map(|k| gamma[*k]).collect();
            let (block, expected) = (all.block().unwrap(), square(part, &rest));
            assert!((block.square / expected - 1.0).abs() < 1e-9, "{} {expected}", block.square);
            assert_eq!(block.freedom, left.len() - 1);
        }
        let before = all.block();
        all.leave_out(2);
        assert_eq!(all.block(), before, "nothing is left out twice");
    }

    #[test]
    fn the_one_most_at_fault_is_the_one_that_was_moved() {
        for moved in 0..8 {
            let gamma: Vec<f64> = (0..8_u8).map(|i| if usize::from(i) == moved { 90.0 } else { 50.0 + 0.1 * f64::from(i) }).collect();
            assert_eq!(together(&gamma).most_at_fault(), Some(moved));
        }
    }

    #[test]
    fn a_covariance_that_is_none_gives_nothing_and_one_range_alone_has_no_square() {
        let zero = [[0.0; RANGES_MOST]; RANGES_MOST];
        assert!(Together::of(zero, [1.0; RANGES_MOST], 3).is_none());
        assert!(together(&[3.0]).block().is_none());
        let mut unknown = zero;
        (unknown[0][0], unknown[1][0], unknown[1][1]) = (4.0, f64::NAN, 4.0);
        assert!(Together::of(unknown, [1.0; RANGES_MOST], 2).is_none());
    }
}
