//! The covariance of the filter: fifteen navigation states, then a changing number of further ones.
//!
//! How it stays positive: the time step is `Phi (P + Q/2) Phi' + Q/2`, mirrored from its lower half; the update is Joseph's form, written
//! for one scalar as a symmetric change of rank two, so that it is symmetric to the last bit and a rounding of the gain enters only by its
//! square. A test runs millions of updates and takes Cholesky's factor along the way.

use super::dynamics::{MOTION, NAV, PHI, R, Transition, V, decay};
use crate::special::widest::widest;
use nalgebra::{Matrix3, Vector3};

/// Columns of the navigation block, one of them empty: whole vectors.
pub(super) const BASE: usize = 16;
/// Most further states: clock and drift, four inter-system biases, barometer, two mounting angles, and 55 satellites and stations.
pub(super) const FURTHER: usize = 64;
pub(super) const WIDTH: usize = BASE + FURTHER;
/// Entries of a measurement row at most: position, velocity or attitude, and four further states.
const ENTRIES: usize = 13;

/// A row of the measurement matrix: few entries.
#[derive(Debug, Clone, Copy)]
pub(super) struct Row {
    n: usize,
    index: [usize; ENTRIES],
    value: [f64; ENTRIES],
}

impl Row {
    pub(super) const fn empty() -> Self {
        Self { n: 0, index: [0; ENTRIES], value: [0.0; ENTRIES] }
    }
    pub(super) fn with(mut self, index: usize, value: f64) -> Self {
        debug_assert!(self.n < ENTRIES && index < WIDTH);
        self.index[self.n] = index;
        self.value[self.n] = value;
        self.n += 1;
        self
    }
    pub(super) fn with_block(self, first: usize, values: &nalgebra::Vector3<f64>) -> Self {
        self.with(first, values.x).with(first + 1, values.y).with(first + 2, values.z)
    }
    #[inline(always)]
    fn entries(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.index[..self.n].iter().copied().zip(self.value[..self.n].iter().copied())
    }
    /// h x.
    pub(super) fn of(&self, x: &[f64; WIDTH]) -> f64 {
        self.entries().map(|(k, h)| h * x[k]).sum()
    }
}

/// What one state is noise-wise between two updates: factor and variance added.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fade {
    pub(super) factor: f64,
    pub(super) variance: f64,
}

impl Fade {
    /// First-order Gauss-Markov over a time; a constant where tau is infinite.
    pub(super) fn gauss_markov(sigma: f64, tau_s: f64, dt: f64) -> Self {
        let factor = decay(dt / tau_s);
        Self { factor, variance: sigma * sigma * (1.0 - factor * factor) }
    }
}

/// Noise of a time step.
#[derive(Debug, Clone, Copy)]
pub(super) struct StepNoise {
    /// Variance of a velocity and of an angle axis.
    pub(super) velocity: f64,
    pub(super) angle: f64,
    pub(super) gyroscope: Fade,
    pub(super) accelerometer: Fade,
}

/// Symmetric, navigation states first, further ones from [`BASE`].
#[derive(Debug, Clone)]
pub(super) struct Joint {
    p: [[f64; WIDTH]; WIDTH],
    /// Columns in use, a multiple of eight.
    used: usize,
    /// Motion and bias rows of the transitions since the further states were last brought up to date.
    pending: [[f64; BASE]; NAV],
}

impl Joint {
    pub(super) fn new(variances: &[f64; NAV]) -> Self {
        let mut p = [[0.0; WIDTH]; WIDTH];
        for (k, variance) in variances.iter().enumerate() {
            p[k][k] = *variance;
        }
        Self { p, used: BASE, pending: identity() }
    }

    pub(super) fn get(&self, i: usize, j: usize) -> f64 {
        self.p[i][j]
    }

    /// Further states in use.
    pub(super) fn resize(&mut self, further: usize) {
        self.used = BASE + further.div_ceil(8) * 8;
    }

    pub(super) fn add_variance(&mut self, i: usize, variance: f64) {
        self.p[i][i] += variance;
    }

    /// The state forgets what it shared with others.
    pub(super) fn reset(&mut self, i: usize, variance: f64) {
        for j in 0..WIDTH {
            self.p[i][j] = 0.0;
            self.p[j][i] = 0.0;
        }
        self.p[i][i] = variance;
    }

    /// State `from` takes the place of state `to`.
    pub(super) fn move_state(&mut self, from: usize, to: usize) {
        self.p[to] = self.p[from];
        for j in 0..WIDTH {
            self.p[j][to] = self.p[j][from];
        }
        self.p[to][to] = self.p[from][from];
        self.reset(from, 0.0);
    }

    /// One step in time of the navigation states; what further states share with them waits for [`Joint::settle`].
    pub(super) fn propagate(&mut self, t: &Transition, noise: &StepNoise) {
        widest(
            #[inline(always)]
            || self.step(t, noise),
        );
    }

    #[inline(always)]
    fn step(&mut self, t: &Transition, noise: &StepNoise) {
        self.half_noise(noise);
        let carried = carry(t, &self.p);
        for i in 0..MOTION {
            let line = times_transposed(&carried[i], t);
            self.p[i][..MOTION].copy_from_slice(&line[..MOTION]);
        }
        let fade = [noise.gyroscope.factor, noise.accelerometer.factor];
        for i in 0..MOTION {
            for j in 0..i {
                self.p[j][i] = self.p[i][j];
            }
            for b in MOTION..NAV {
                self.p[i][b] = carried[i][b] * fade[(b - MOTION) / 3];
                self.p[b][i] = self.p[i][b];
            }
        }
        for a in MOTION..NAV {
            for b in MOTION..NAV {
                self.p[a][b] *= fade[(a - MOTION) / 3] * fade[(b - MOTION) / 3];
            }
        }
        self.half_noise(noise);
        if self.used > BASE {
            self.remember(t, fade);
        }
    }

    fn half_noise(&mut self, noise: &StepNoise) {
        for k in 0..3 {
            self.p[3 + k][3 + k] += 0.5 * noise.velocity;
            self.p[6 + k][6 + k] += 0.5 * noise.angle;
            self.p[9 + k][9 + k] += 0.5 * noise.gyroscope.variance;
            self.p[12 + k][12 + k] += 0.5 * noise.accelerometer.variance;
        }
    }

    #[inline(always)]
    fn remember(&mut self, t: &Transition, fade: [f64; 2]) {
        let carried = carry(t, &self.pending);
        self.pending[..MOTION].copy_from_slice(&carried);
        for b in MOTION..NAV {
            for x in &mut self.pending[b] {
                *x *= fade[(b - MOTION) / 3];
            }
        }
    }

    /// Bring the further states up to date: their own change, given one by one, and the transitions kept since the last time. Exact: one
    /// acts on the rows and the other on the columns, so that the order does not matter.
    pub(super) fn settle(&mut self, fades: &[Fade]) {
        widest(
            #[inline(always)]
            || self.settled(fades),
        );
    }

    #[inline(always)]
    fn settled(&mut self, fades: &[Fade]) {
        let n = fades.len();
        for c in BASE..BASE + n {
            let before: [f64; NAV] = core::array::from_fn(|k| self.p[k][c]);
            for i in 0..NAV {
                let sum: f64 = (0..NAV).map(|k| self.pending[i][k] * before[k]).sum();
                self.p[i][c] = sum * fades[c - BASE].factor;
                self.p[c][i] = self.p[i][c];
            }
        }
        for (i, a) in fades.iter().enumerate() {
            for (j, b) in fades.iter().enumerate() {
                self.p[BASE + i][BASE + j] *= a.factor * b.factor;
            }
            self.p[BASE + i][BASE + i] += a.variance;
        }
        self.pending = identity();
    }

    /// State `i` grows by `dt` times state `rate`, with the noise of both (a clock and its drift).
    pub(super) fn integrate(&mut self, i: usize, rate: usize, dt: f64, noise: [f64; 3]) {
        for j in 0..self.used {
            self.p[i][j] += dt * self.p[rate][j];
        }
        for j in 0..self.used {
            self.p[j][i] += dt * self.p[j][rate];
        }
        self.p[i][i] += noise[0];
        self.p[i][rate] += noise[1];
        self.p[rate][i] += noise[1];
        self.p[rate][rate] += noise[2];
    }

    /// Three further states become a mixture of themselves with noise added; see [`super::slots::Slots::mix`].
    pub(super) fn mix(&mut self, places: [usize; 3], a: &Matrix3<f64>, q: &Matrix3<f64>) {
        for j in 0..self.used {
            let line = a * Vector3::from(places.map(|place| self.p[place][j]));
            places.into_iter().zip(line.iter()).for_each(|(place, x)| self.p[place][j] = *x);
        }
        for j in 0..self.used {
            let line = a * Vector3::from(places.map(|place| self.p[j][place]));
            places.into_iter().zip(line.iter()).for_each(|(place, x)| self.p[j][place] = *x);
        }
        for (i, a) in places.into_iter().enumerate() {
            for (j, b) in places.into_iter().enumerate().take(i + 1) {
                // Mirrored, so that the matrix stays symmetric to the last bit.
                self.p[a][b] += q[(i, j)];
                self.p[b][a] = self.p[a][b];
            }
        }
    }

    /// P h'.
    pub(super) fn times(&self, h: &Row) -> [f64; WIDTH] {
        widest(
            #[inline(always)]
            || self.product(h),
        )
    }

    /// h P h'.
    pub(super) fn variance(&self, h: &Row) -> f64 {
        h.entries().map(|(j, value)| value * h.entries().map(|(k, value)| value * self.p[k][j]).sum::<f64>()).sum()
    }

    #[inline(always)]
    fn product(&self, h: &Row) -> [f64; WIDTH] {
        let mut u = [0.0; WIDTH];
        for (k, value) in h.entries() {
            for j in 0..self.used {
                u[j] += value * self.p[k][j];
            }
        }
        u
    }

    /// One scalar measurement: `x` grows by the gain times what is left of the innovation.
    ///
    /// ```text
    /// u = P h',  s = h u + r,  K = u / s
    /// P <- (1 - K h) P (1 - K h)' + K r K'  =  P - (K t' + t K'),   t = u - s K / 2      for any K
    /// ```
    pub(super) fn update(&mut self, h: &Row, innovation: f64, r: f64, x: &mut [f64; WIDTH]) -> bool {
        widest(
            #[inline(always)]
            || self.updated(h, innovation, r, x),
        )
    }

    #[inline(always)]
    fn updated(&mut self, h: &Row, innovation: f64, r: f64, x: &mut [f64; WIDTH]) -> bool {
        let u = self.product(h);
        let s = h.of(&u) + r;
        let n = self.used;
        let (mut gain, mut t) = ([0.0; WIDTH], [0.0; WIDTH]);
        for j in 0..n {
            gain[j] = u[j] / s;
            t[j] = u[j] - 0.5 * s * gain[j];
        }
        // What rounding may take from a variance is not left of it: nothing is changed.
        let sound = |k: usize| self.p[k][k] - u[k] * gain[k] > 8.0 * f64::EPSILON * self.p[k][k];
        if !(s < f64::INFINITY && innovation.is_finite() && (0..n).all(|k| self.p[k][k] == 0.0 || sound(k))) {
            return false;
        }
        let left = innovation - h.of(x);
        for j in 0..n {
            x[j] += gain[j] * left;
        }
        for i in 0..n {
            let (a, b) = (gain[i], t[i]);
            let row = &mut self.p[i];
            for j in 0..n {
                row[j] -= a * t[j] + b * gain[j];
            }
        }
        true
    }

    /// Whether every variance is positive and finite: with a symmetric matrix the first sign of trouble.
    pub(super) fn is_sound(&self, further: usize) -> bool {
        (0..NAV).chain(BASE..BASE + further).all(|k| self.p[k][k] > 0.0 && self.p[k][k].is_finite())
    }
}

fn identity() -> [[f64; BASE]; NAV] {
    core::array::from_fn(|i| core::array::from_fn(|j| f64::from(u8::from(i == j))))
}

/// States that reach position, velocity and misalignment.
const TO_R: [usize; 12] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 13, 14];
const TO_V: [usize; 15] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14];
const TO_PHI: [usize; 12] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11];

/// Phi m, motion rows, the columns of the navigation states.
#[inline(always)]
fn carry<const W: usize, const H: usize>(t: &Transition, m: &[[f64; W]; H]) -> [[f64; BASE]; MOTION] {
    let mut carried = [[0.0; BASE]; MOTION];
    for k in 0..3 {
        carried[R + k] = line(t, R + k, &TO_R, m);
        carried[V + k] = line(t, V + k, &TO_V, m);
        carried[PHI + k] = line(t, PHI + k, &TO_PHI, m);
    }
    carried
}

#[inline(always)]
fn line<const N: usize, const W: usize, const H: usize>(t: &Transition, i: usize, from: &[usize; N], m: &[[f64; W]; H]) -> [f64; BASE] {
    let mut sum = [0.0; BASE];
    for &k in from {
        let f = t[k][i];
        for c in 0..BASE {
            sum[c] += f * m[k][c];
        }
    }
    sum
}

/// A row times Phi', motion columns.
#[inline(always)]
fn times_transposed(row: &[f64; BASE], t: &Transition) -> [f64; super::dynamics::LINE] {
    let mut sum = [0.0; super::dynamics::LINE];
    for k in 0..NAV {
        for j in 0..super::dynamics::LINE {
            sum[j] += row[k] * t[k][j];
        }
    }
    sum
}
