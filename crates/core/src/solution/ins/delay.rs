//! Whether positions are of the time that their tags say: their accelerations against those of the inertial unit.
//!
//! A position that is late lies behind by speed times delay, and a filter that uses such positions from the begin lies behind as they do:
//! nothing contradicts anything until the velocity changes. Then the positions turn later than the unit does:
//!
//! ```text
//! a_p = (p(t) - 2 p(t - h) + p(t - 2 h)) / h^2          of positions one second apart
//! a_u(tau) = the same of the unit's integrated acceleration at t - tau
//! S(tau) = sum of |a_p - a_u(tau)|^2 / s^2,   s^2 = 6 sigma^2 / h^4 + model^2         forgotten over two minutes
//! ```
//!
//! Where velocities come, by Doppler, the same with their first difference, which is far less noisy.
//!
//! An offset, a drift or a slow error of either drops out of the second difference, so the filter's own state is not used but for the axes.
//! The delay is where S is least; it counts where S at no delay is larger by far more than chance makes it. Provenance: ours.

use crate::quantity::GpsTime;
use crate::special::float::exp;
use nalgebra::{Vector2, Vector3};

/// Steps of time and of the delays that are tried \[s\].
const STEP_S: f64 = 0.1;
/// Smallest and largest delay, in steps: positions may be ahead of a unit whose own samples are late.
const AHEAD: usize = 15;
const BEHIND: usize = 30;
const LAGS: usize = AHEAD + BEHIND + 1;
/// Motions kept: three positions and all delays.
const KEPT: usize = 128;
/// Least and largest distance of the positions \[s\], and by how much two distances may differ.
const APART_S: [f64; 2] = [0.95, 2.5];
const EVEN_S: f64 = 0.02;
/// What tilt, vibration and curved axes leave of an acceleration \[m/s²\].
const MODEL_MPS2: f64 = 0.1;
/// Time over which the past is forgotten \[s\].
const MEMORY_S: f64 = 120.0;
/// Excess of S at which a delay counts: as unlikely as 1e-9 even if only every third position is new (chi-square of one degree, 37, times
/// three, where each position is in three differences), and at which it is no longer doubted.
const EXCESS: f64 = 110.0;
const CLEAR: f64 = 30.0;
/// Smallest delay that counts \[s\], and differences in a row that must show it.
const LEAST_S: f64 = 0.15;
const IN_A_ROW: u32 = 3;

/// The motion of the unit and the last positions.
#[derive(Debug, Clone)]
pub(super) struct Delay {
    /// Integrated acceleration: velocity and position on local axes, free of any correction.
    velocity: Vector2<f64>,
    position: Vector2<f64>,
    path: [[Vector2<f64>; 2]; KEPT],
    n: usize,
    /// Of the newest of the path.
    newest: Option<GpsTime>,
    heard: [Option<Heard>; 3],
    velocity_heard: Option<(GpsTime, Vector2<f64>, f64)>,
    pending: [Option<Difference>; 8],
    sums: [f64; LAGS],
    weight: f64,
    in_a_row: u32,
    late: bool,
}

#[derive(Debug, Clone, Copy)]
struct Heard {
    time: GpsTime,
    ecef: Vector3<f64>,
    variance: f64,
}

/// A second difference of three positions or a first one of two velocities, of the last of them.
#[derive(Debug, Clone, Copy)]
struct Difference {
    of_velocity: bool,
    time: GpsTime,
    apart_s: f64,
    acceleration: Vector2<f64>,
    variance: f64,
}

impl Delay {
    pub(super) const fn new() -> Self {
        let zero = Vector2::new(0.0, 0.0);
        Self {
            velocity: zero,
            position: zero,
            path: [[zero; 2]; KEPT],
            n: 0,
            newest: None,
            heard: [None; 3],
            velocity_heard: None,
            pending: [None; 8],
            sums: [0.0; LAGS],
            weight: 0.0,
            in_a_row: 0,
            late: false,
        }
    }

    /// Whether the positions are of another time than their tags say.
    pub(super) const fn is_late(&self) -> bool {
        self.late
    }

    /// By how much, tag minus time of the position \[s\], where the motion shows it.
    pub(super) fn estimate_s(&self) -> Option<f64> {
        (self.excess() >= EXCESS || self.late).then(|| self.least())
    }

    /// Nothing is known of the motion over a hole.
    pub(super) fn forget_motion(&mut self) {
        (self.n, self.newest, self.pending) = (0, None, [None; 8]);
    }

    /// The unit has changed the velocity by this much, north and east \[m/s\], up to a time.
    pub(super) fn moved(&mut self, time: GpsTime, change: Vector2<f64>, dt: f64) {
        if self.heard[0].is_none() && self.velocity_heard.is_none() {
            return;
        }
        let before = [self.position, self.velocity];
        self.position += self.velocity * dt + 0.5 * dt * change;
        self.velocity += change;
        let Some(mut newest) = self.newest else {
            (self.newest, self.path[0], self.n) = (Some(time), [self.position, self.velocity], 1);
            return;
        };
        // A sample longer than what is kept leaves nothing to compare with.
        if !(dt > 0.0 && time.seconds_since(newest) < STEP_S * (KEPT / 2) as f64) {
            self.forget_motion();
            return;
        }
        while time.seconds_since(newest) >= STEP_S {
            newest = newest.plus_seconds(STEP_S);
            let share = (1.0 - time.seconds_since(newest) / dt).clamp(0.0, 1.0);
            let now = [self.position, self.velocity];
            self.path[self.n % KEPT] = core::array::from_fn(|k| before[k] + (now[k] - before[k]) * share);
            self.n += 1;
        }
        self.newest = Some(newest);
        for k in 0..self.pending.len() {
            let ripe = self.pending[k].filter(|d| newest.seconds_since(d.time) >= STEP_S * (AHEAD + 1) as f64);
            if let Some(difference) = ripe {
                self.pending[k] = None;
                self.compare(&difference);
            }
        }
    }

    /// A position of a time tag, Earth-centred \[m\], the variance of a horizontal component \[m²\], and the directions of north and east.
    pub(super) fn heard(&mut self, time: GpsTime, ecef: Vector3<f64>, variance: f64, axes: [Vector3<f64>; 2]) {
        if self.heard[2].is_some_and(|last| time.seconds_since(last.time) < APART_S[0]) {
            return;
        }
        self.heard = [self.heard[1], self.heard[2], Some(Heard { time, ecef, variance })];
        if self.heard[0].is_none() {
            self.heard[0] = self.heard[1].or(self.heard[2]);
        }
        let [Some(a), Some(b), Some(c)] = self.heard else { return };
        let (first, apart_s) = (b.time.seconds_since(a.time), c.time.seconds_since(b.time));
        if !(apart_s <= APART_S[1] && (first - apart_s).abs() <= EVEN_S) {
            return;
        }
        let bend = c.ecef - 2.0 * b.ecef + a.ecef;
        let square = apart_s * apart_s;
        let acceleration = Vector2::new(axes[0].dot(&bend), axes[1].dot(&bend)) / square;
        let variance = (a.variance + 4.0 * b.variance + c.variance) / (square * square) + MODEL_MPS2 * MODEL_MPS2;
        self.wait(Difference { of_velocity: false, time, apart_s, acceleration, variance });
    }

    /// A velocity of a time tag, north and east \[m/s\], and the variance of a component \[m²/s²\].
    pub(super) fn velocity_heard(&mut self, time: GpsTime, velocity: Vector2<f64>, variance: f64) {
        let Some((before, last, of_last)) = self.velocity_heard else {
            self.velocity_heard = Some((time, velocity, variance));
            return;
        };
        let apart_s = time.seconds_since(before);
        if !(apart_s >= APART_S[0]) {
            return;
        }
        self.velocity_heard = Some((time, velocity, variance));
        if apart_s <= APART_S[1] {
            let variance = (variance + of_last) / (apart_s * apart_s) + MODEL_MPS2 * MODEL_MPS2;
            self.wait(Difference { of_velocity: true, time, apart_s, acceleration: (velocity - last) / apart_s, variance });
        }
    }

    fn wait(&mut self, difference: Difference) {
        if let Some(place) = self.pending.iter_mut().find(|p| p.is_none()) {
            *place = Some(difference);
        }
    }

    fn compare(&mut self, d: &Difference) {
        let mut squares = [0.0; LAGS];
        for (k, square) in squares.iter_mut().enumerate() {
            let at = d.time.plus_seconds(-lag_s(k));
            let [c, b, a] = [0.0, 1.0, 2.0].map(|n| self.at(at.plus_seconds(-n * d.apart_s)));
            let of_unit = match (a, b, c, d.of_velocity) {
                (_, Some(b), Some(c), true) => (c[1] - b[1]) / d.apart_s,
                (Some(a), Some(b), Some(c), false) => (c[0] - 2.0 * b[0] + a[0]) / (d.apart_s * d.apart_s),
                _ => return,
            };
            *square = (d.acceleration - of_unit).norm_squared() / d.variance;
        }
        let keep = exp(-d.apart_s / MEMORY_S);
        for (sum, square) in self.sums.iter_mut().zip(squares) {
            *sum = keep * *sum + square;
        }
        self.weight = keep * self.weight + 2.0;
        let excess = self.excess();
        let shown = excess >= EXCESS && self.least().abs() >= LEAST_S;
        self.in_a_row = if shown { self.in_a_row + 1 } else { 0 };
        self.late = self.in_a_row >= IN_A_ROW || (self.late && excess >= CLEAR);
    }

    /// How much larger S is at no delay than at its least, in units of what stays there.
    fn excess(&self) -> f64 {
        let least = self.sums.iter().copied().fold(f64::INFINITY, f64::min);
        let scale = if self.weight > 0.0 { (least / self.weight).max(1.0) } else { 1.0 };
        (self.sums[AHEAD] - least) / scale
    }

    fn least(&self) -> f64 {
        (0..LAGS).min_by(|a, b| self.sums[*a].total_cmp(&self.sums[*b])).map_or(0.0, lag_s)
    }

    fn at(&self, time: GpsTime) -> Option<[Vector2<f64>; 2]> {
        let back = self.newest?.seconds_since(time) / STEP_S;
        let oldest = self.n.min(KEPT) as f64 - 1.0;
        if !(back >= 0.0 && back < oldest) {
            return None;
        }
        let whole = libm::floor(back);
        let share = back - whole;
        let place = |steps: usize| self.path[(self.n - 1 - steps) % KEPT];
        let k = whole as usize;
        Some(core::array::from_fn(|j| place(k)[j] * (1.0 - share) + place(k + 1)[j] * share))
    }
}

fn lag_s(k: usize) -> f64 {
    (k as f64 - AHEAD as f64) * STEP_S
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A circle at 10 m/s with 4 m/s², positions with a delay and an error of half a metre: what is stated after so many seconds. By the
    /// formula a second of delay adds (2 * 4 sin 0.2)^2 / 1.5 = 1.7 a position, 200 over the memory; of 2 m/s² at 20 m/s it would be 3.
    fn circled(delay_s: f64, seconds: usize, turning: bool) -> (bool, Option<f64>) {
        let (speed, rate) = (10.0, if turning { 0.4 } else { 0.0 });
        let velocity = |t: f64| Vector2::new((rate * t).cos(), (rate * t).sin()) * speed;
        let place =
            |t: f64| if turning { Vector2::new((rate * t).sin(), 1.0 - (rate * t).cos()) * (speed / rate) } else { velocity(0.0) * t };
        let (mut delay, begin, mut state) = (Delay::new(), GpsTime::default(), 0x2545_f491_4f6c_dd1d_u64);
        let mut noise = || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            ((state >> 11) as f64 / (1u64 << 53) as f64 - 0.5) * 12f64.sqrt() * 0.5
        };
        for k in 1..=seconds * 50 {
            let t = k as f64 * 0.02;
            delay.moved(begin.plus_seconds(t), velocity(t) - velocity(t - 0.02), 0.02);
            if k % 50 == 0 {
                let p = place(t - delay_s) + Vector2::new(noise(), noise());
                let ecef = Vector3::new(6.4e6, p.y, p.x);
                delay.heard(begin.plus_seconds(t), ecef, 0.25, [Vector3::z(), Vector3::y()]);
            }
        }
        (delay.is_late(), delay.estimate_s())
    }

    #[test]
    fn late_positions_are_detected_in_a_turn_and_their_delay_with_them() {
        for delay_s in [1.0, 2.0, -1.0] {
            let (late, estimate) = circled(delay_s, 180, true);
            assert!(late, "{delay_s}");
            assert!((estimate.unwrap() - delay_s).abs() <= 0.35, "{delay_s}: {estimate:?}");
        }
    }

    #[test]
    fn positions_in_time_are_not_and_without_a_turn_nothing_shows() {
        assert_eq!(circled(0.0, 600, true), (false, None));
        assert_eq!(circled(2.0, 600, false), (false, None));
    }
}
