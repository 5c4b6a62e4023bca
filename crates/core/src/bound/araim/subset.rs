//! Solutions without some satellites, by closed-form downdates of the solution with all.
//!
//! ```text
//! P    = (sum w_j d_j d_j')^-1,  s_j = -w_j P d_j          d_j = u_j - m_c, clocks eliminated (see solution::wls)
//! Pi   = W - W H S,  Pi_ij = w_i (delta_ij - q_i[j]),      q_i[j] = [c_i = c_j] w_j / W_c - s_j . d_i
//! S_(J)   = S - S_J Pi_JJ^-1 Pi_J,:                        columns J become exactly zero
//! var_(J) = P_aa + S_J Pi_JJ^-1 S_J'
//! ```
//!
//! A fault of a whole constellation takes one new P of size three; satellites on top of it are downdates of that. Derivation:
//! Woodbury's identity on the normal equation (standard).

use super::modes::MOST_SATELLITES;
use crate::bound::Sight;
use crate::quantity::Unavailable;
use crate::signal::Constellation;
use crate::solution::wls::CONDITION_LIMIT;
use nalgebra::{Matrix3, Vector3};

pub(super) const LANES: usize = 8;
pub(super) const GROUPS: usize = MOST_SATELLITES / LANES;
const CLOCKS: usize = Constellation::ALL.len();
/// Below this share of its weight a satellite's residual is determined by the others not at all: without it there is no solution.
const ESSENTIAL: f64 = 1e-9;
/// Most satellites that fail one by one at a time.
pub(super) const MOST_TOGETHER: usize = 4;

/// Eight satellites abreast; places beyond the last have no weight.
#[derive(Debug, Clone, Copy)]
pub(super) struct Group {
    pub(super) centred: [[f64; LANES]; 3],
    pub(super) weight: [f64; LANES],
    pub(super) clock: [f64; LANES],
    index: [f64; LANES],
    pub(super) accuracy: [f64; LANES],
    pub(super) bias: [f64; LANES],
    pub(super) bias_continuity: [f64; LANES],
    residual: [f64; LANES],
}

const EMPTY: Group = Group {
    centred: [[0.0; LANES]; 3],
    weight: [0.0; LANES],
    clock: [-1.0; LANES],
    index: [-1.0; LANES],
    accuracy: [0.0; LANES],
    bias: [0.0; LANES],
    bias_continuity: [0.0; LANES],
    residual: [0.0; LANES],
};

/// How the position moves with each range, eight abreast.
type Gains = [[[f64; LANES]; 3]; GROUPS];

/// A solution with every satellite of some constellations.
#[derive(Debug, Clone, Copy)]
pub(super) struct Solution {
    pub(super) variance: [f64; 3],
    pub(super) gains: Gains,
}

pub(super) const NO_SOLUTION: Solution = Solution { variance: [0.0; 3], gains: [[[0.0; LANES]; 3]; GROUPS] };

/// What a threshold and a level need of a subset, by axis.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Sums {
    /// Of the position, for integrity \[m²\].
    pub(super) variance: [f64; 3],
    /// Of its separation from the position with all satellites, for accuracy \[m²\].
    pub(super) separation: [f64; 3],
    /// Largest effect of the nominal biases on the position \[m\].
    pub(super) bias: [f64; 3],
    /// Of those for continuity on the separation \[m\].
    pub(super) bias_continuity: [f64; 3],
    /// The separation itself, by the residuals at hand \[m\].
    pub(super) moved: [f64; 3],
}

/// The satellites of one solution, and what each constellation contributes.
#[derive(Debug, Clone)]
pub(super) struct Satellites {
    pub(super) groups: [Group; GROUPS],
    pub(super) count: usize,
    information: [Matrix3<f64>; CLOCKS],
    pub(super) weight: [f64; CLOCKS],
    pub(super) members: [u64; CLOCKS],
    /// Whether there are residuals, and biases for continuity: sums of zeros are not worked out.
    tested: bool,
    continuity: bool,
}

impl Default for Satellites {
    fn default() -> Self {
        let (information, weight, members) = ([Matrix3::zeros(); CLOCKS], [0.0; CLOCKS], [0; CLOCKS]);
        Self { groups: [EMPTY; GROUPS], count: 0, information, weight, members, tested: false, continuity: false }
    }
}

impl Satellites {
    /// Take up the satellites of an epoch. The caller has checked their number and their numbers.
    #[inline(always)]
    pub(super) fn fill(&mut self, sights: &[Sight]) {
        let mut mean = [Vector3::zeros(); CLOCKS];
        (self.count, self.weight, self.members) = (sights.len().min(MOST_SATELLITES), [0.0; CLOCKS], [0; CLOCKS]);
        for (i, s) in sights.iter().enumerate() {
            let (c, w) = (s.constellation.index(), 1.0 / s.integrity_m2);
            self.members[c] |= 1 << i;
            self.weight[c] += w;
            mean[c] += w * s.unit;
        }
        for c in 0..CLOCKS {
            mean[c] /= if self.weight[c] > 0.0 { self.weight[c] } else { 1.0 };
        }
        self.information = [Matrix3::zeros(); CLOCKS];
        self.continuity = sights.iter().any(|s| s.bias_continuity.m() != 0.0);
        for (g, (group, sights)) in self.groups.iter_mut().zip(sights.chunks(LANES)).enumerate() {
            *group = EMPTY;
            for (l, s) in sights.iter().enumerate() {
                let (c, w) = (s.constellation.index(), 1.0 / s.integrity_m2);
                let d = s.unit - mean[c];
                self.information[c] += (w * d) * d.transpose();
                for a in 0..3 {
                    group.centred[a][l] = d[a];
                }
                (group.weight[l], group.clock[l], group.index[l]) = (w, c as f64, (g * LANES + l) as f64);
                (group.accuracy[l], group.bias[l], group.bias_continuity[l]) = (s.accuracy_m2, s.bias.m(), s.bias_continuity.m());
            }
        }
    }

    /// Measured less computed ranges at the place where the lines of sight are those of `fill`; what a clock explains does not matter \[m\].
    #[inline(always)]
    pub(super) fn measured(&mut self, residuals_m: &[f64]) {
        self.tested = !residuals_m.is_empty();
        for (group, residuals) in self.groups.iter_mut().zip(residuals_m.chunks(LANES)) {
            group.residual[..residuals.len()].copy_from_slice(residuals);
        }
    }

    /// Where the solution stands from that place \[m\].
    pub(super) fn step(&self, solution: &Solution) -> [f64; 3] {
        let mut sums = [[0.0; LANES]; 3];
        for (group, gains) in self.filled().iter().zip(&solution.gains) {
            for a in 0..3 {
                for l in 0..LANES {
                    sums[a][l] += gains[a][l] * group.residual[l];
                }
            }
        }
        sums.map(total)
    }

    #[inline(always)]
    pub(super) fn filled(&self) -> &[Group] {
        &self.groups[..self.count.div_ceil(LANES).min(GROUPS)]
    }

    /// Every satellite of some constellations.
    #[inline(always)]
    pub(super) fn of_constellations(&self, which: u8) -> u64 {
        (0..CLOCKS).filter(|c| which >> c & 1 == 1).fold(0, |m, c| m | self.members[c])
    }

    /// Unknowns that satellites outside some constellations must determine, at least four; and how many satellites there are.
    #[inline(always)]
    pub(super) fn need_and_have(&self, without: u8) -> (usize, usize) {
        let (mut clocks, mut have) = (0, 0);
        for c in (0..CLOCKS).filter(|c| without >> c & 1 == 0 && self.members[*c] != 0) {
            (clocks, have) = (clocks + 1, have + self.members[c].count_ones() as usize);
        }
        ((3 + clocks).max(4), have)
    }

    /// Of the position, from every constellation but some.
    #[inline(always)]
    pub(super) fn information(&self, without: u8) -> Matrix3<f64> {
        let kept = (0..CLOCKS).filter(|c| without >> c & 1 == 0);
        kept.fold(Matrix3::zeros(), |sum, c| sum + self.information[c])
    }

    /// The solution without some constellations.
    ///
    /// # Errors
    /// [`Unavailable::TooFewSatellites`], [`Unavailable::Singular`].
    #[inline(always)]
    pub(super) fn solve(&self, without: u8, into: &mut Solution) -> Result<(), Unavailable> {
        let (need, have) = self.need_and_have(without);
        if have < need {
            return Err(Unavailable::TooFewSatellites { need, have });
        }
        let information = self.information(without);
        let singular = |condition| Unavailable::Singular { condition, limit: CONDITION_LIMIT };
        let p = information.cholesky().ok_or(singular(f64::INFINITY))?.inverse();
        // Never below the condition number of the position's part.
        let condition = information.trace() * p.trace();
        if !(condition <= CONDITION_LIMIT) {
            return Err(singular(condition));
        }
        into.variance = [p[(0, 0)], p[(1, 1)], p[(2, 2)]];
        for (group, gains) in self.filled().iter().zip(&mut into.gains) {
            let mut weight = group.weight;
            for c in (0..CLOCKS).filter(|c| without >> c & 1 == 1) {
                for l in 0..LANES {
                    weight[l] = if group.clock[l] == c as f64 { 0.0 } else { weight[l] };
                }
            }
            for a in 0..3 {
                for l in 0..LANES {
                    let d = [group.centred[0][l], group.centred[1][l], group.centred[2][l]];
                    gains[a][l] = -weight[l] * (p[(a, 0)] * d[0] + p[(a, 1)] * d[1] + p[(a, 2)] * d[2]);
                }
            }
        }
        Ok(())
    }

    /// What a solution without the satellites `out` needs of it: `base` is the solution with them, `all` that with every satellite.
    /// `None` where the rest does not determine the position.
    #[inline(always)]
    pub(super) fn without<const K: usize>(&self, all: &Solution, base: &Solution, out: [usize; K]) -> Option<Sums> {
        let removed = Removed::new(self, base, out, ESSENTIAL)?;
        let [mut bias, mut bias_continuity, mut separation, mut moved] = [[[0.0; LANES]; 3]; 4];
        // Each small loop runs over lanes alone, so that it becomes a few vector instructions.
        for ((group, all), gains) in self.filled().iter().zip(&all.gains).zip(&base.gains) {
            let mut kept = *gains;
            for k in 0..K {
                let q = removed.shares(k, group, gains);
                for a in 0..3 {
                    for l in 0..LANES {
                        kept[a][l] += removed.factor[k][a] * q[l];
                    }
                }
            }
            for k in 0..K {
                for a in 0..3 {
                    for l in 0..LANES {
                        kept[a][l] = if group.index[l] == removed.index[k] { 0.0 } else { kept[a][l] };
                    }
                }
            }
            for a in 0..3 {
                for l in 0..LANES {
                    let by = kept[a][l] - all[a][l];
                    bias[a][l] += kept[a][l].abs() * group.bias[l];
                    separation[a][l] += by * by * group.accuracy[l];
                }
            }
            if self.continuity || self.tested {
                for a in 0..3 {
                    for l in 0..LANES {
                        let by = kept[a][l] - all[a][l];
                        bias_continuity[a][l] += by.abs() * group.bias_continuity[l];
                        moved[a][l] += by * group.residual[l];
                    }
                }
            }
        }
        let variance = [0, 1, 2].map(|a| base.variance[a] + removed.added[a]);
        Some(Sums {
            variance,
            separation: separation.map(total),
            bias: bias.map(total),
            bias_continuity: bias_continuity.map(total),
            moved: moved.map(total),
        })
    }

    /// Variance of the position for accuracy, by axis \[m²\].
    #[inline(always)]
    pub(super) fn accuracy_m2(&self, solution: &Solution) -> [f64; 3] {
        let mut sums = [[0.0; LANES]; 3];
        for (group, gains) in self.filled().iter().zip(&solution.gains) {
            for a in 0..3 {
                for l in 0..LANES {
                    sums[a][l] += gains[a][l] * gains[a][l] * group.accuracy[l];
                }
            }
        }
        sums.map(total)
    }
}

/// The sum of lanes, by halves, so that vector registers can do it.
#[inline(always)]
fn total(x: [f64; LANES]) -> f64 {
    let half = [x[0] + x[4], x[1] + x[5], x[2] + x[6], x[3] + x[7]];
    (half[0] + half[2]) + (half[1] + half[3])
}

/// Satellites that leave a solution.
pub(super) struct Removed<const K: usize> {
    index: [f64; K],
    clock: [f64; K],
    /// 1 / (weight of its constellation).
    per_clock: [f64; K],
    direction: [[f64; 3]; K],
    /// w_k (S_J Pi_JJ^-1)_k by axis.
    pub(super) factor: [[f64; 3]; K],
    /// S_J Pi_JJ^-1 S_J' by axis.
    pub(super) added: [f64; 3],
}

impl<const K: usize> Removed<K> {
    /// `None` where the rest determines the position with less than `least` of a satellite's weight.
    #[inline(always)]
    pub(super) fn new(satellites: &Satellites, base: &Solution, out: [usize; K], least: f64) -> Option<Self> {
        let none = [0.0; K];
        let mut r = Self { index: none, clock: none, per_clock: none, direction: [[0.0; 3]; K], factor: [[0.0; 3]; K], added: [0.0; 3] };
        let (mut weight, mut gains, mut pi) = ([0.0; K], [[0.0; 3]; K], [[0.0; K]; K]);
        for k in 0..K {
            let (group, l) = (satellites.groups.get(out[k] / LANES)?, out[k] % LANES);
            r.index[k] = out[k] as f64;
            r.clock[k] = group.clock[l];
            r.per_clock[k] = 1.0 / satellites.weight.get(group.clock[l] as usize)?;
            weight[k] = group.weight[l];
            for a in 0..3 {
                r.direction[k][a] = group.centred[a][l];
                gains[k][a] = base.gains[out[k] / LANES][a][l];
            }
        }
        for k in 0..K {
            for j in 0..K {
                let (group, l) = (&satellites.groups[out[j] / LANES], out[j] % LANES);
                let q = r.share(k, group, l) - r.across(k, &gains[j]);
                pi[k][j] = weight[k] * (f64::from(u8::from(k == j)) - q);
            }
        }
        let solved = solve_small(pi, gains, &weight.map(|w| least * w))?;
        for k in 0..K {
            for a in 0..3 {
                r.factor[k][a] = weight[k] * solved[k][a];
                r.added[a] += solved[k][a] * gains[k][a];
            }
        }
        Some(r)
    }

    /// What satellite `l` of a group weighs in the clock of removed satellite `k`.
    #[inline(always)]
    fn share(&self, k: usize, group: &Group, l: usize) -> f64 {
        if group.clock[l] == self.clock[k] { group.weight[l] * self.per_clock[k] } else { 0.0 }
    }

    /// q of every satellite of a group.
    #[inline(always)]
    pub(super) fn shares(&self, k: usize, group: &Group, gains: &[[f64; LANES]; 3]) -> [f64; LANES] {
        let mut q = [0.0; LANES];
        for l in 0..LANES {
            q[l] = self.share(k, group, l) - self.across(k, &[gains[0][l], gains[1][l], gains[2][l]]);
        }
        q
    }

    #[inline(always)]
    fn across(&self, k: usize, s: &[f64; 3]) -> f64 {
        s[0] * self.direction[k][0] + s[1] * self.direction[k][1] + s[2] * self.direction[k][2]
    }
}

/// The solution of a symmetric positive system by its L D L' factors; `None` where a pivot is below the least.
#[inline(always)]
fn solve_small<const K: usize>(mut m: [[f64; K]; K], mut x: [[f64; 3]; K], least: &[f64; K]) -> Option<[[f64; 3]; K]> {
    for k in 0..K {
        if !(m[k][k] >= least[k]) {
            return None;
        }
        for j in k + 1..K {
            let factor = m[j][k] / m[k][k];
            for i in k..K {
                m[j][i] -= factor * m[k][i];
            }
            for a in 0..3 {
                x[j][a] -= factor * x[k][a];
            }
        }
    }
    for k in (0..K).rev() {
        for a in 0..3 {
            let later: f64 = (k + 1..K).map(|j| m[k][j] * x[j][a]).sum();
            x[k][a] = (x[k][a] - later) / m[k][k];
        }
    }
    Some(x)
}
