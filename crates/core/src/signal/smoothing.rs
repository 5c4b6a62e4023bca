//! Pseudoranges smoothed by the carrier phase.
//!
//! Source: R. Hatch, "The synergism of GPS code and carrier measurements" (1982); divergence-free form: P. Hwang, G. McGraw, J. Bader,
//! "Enhanced differential GPS carrier-smoothed code processing using dual-frequency measurements" (1999); provenance: standard. Gaps and
//! slips: ours.

use super::Carrier;
use crate::quantity::{GpsTime, Metres};

/// How a channel is smoothed, and what ends an arc of unbroken phase.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Smoothing {
    /// Time constant \[s\].
    pub window_s: f64,
    /// A longer silence ends the arc \[s\].
    pub longest_gap_s: f64,
    /// Code and phase that differ from their mean by more than this end it: a slip, or a wrong code.
    pub slip: Metres,
}

impl Smoothing {
    /// With the limits that the documentation states: 60 s of silence at most, 10 m of jump between code and phase.
    pub const fn over(window_s: f64) -> Self {
        Self { window_s, longest_gap_s: 60.0, slip: Metres::new(10.0) }
    }
}

/// One code of one satellite on its way through time.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Channel {
    last: Option<Last>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Last {
    time: GpsTime,
    phase: f64,
    smoothed: f64,
    /// Codes of the arc so far.
    count: f64,
    /// Shortest step of the arc \[s\]: after a gap one code counts as one, however long the gap was.
    step_s: f64,
    /// Variance of the smoothed code against that of one code, for noise without memory.
    noise_share: f64,
}

impl Channel {
    /// The smoothed pseudorange.
    ///
    /// ```text
    /// R(k) = a P(k) + (1 - a) (R(k-1) + F(k) - F(k-1))      1 / a = min(n, window / step), at least 1
    /// ```
    ///
    /// | source | here                         | unit |
    /// |--------|------------------------------|------|
    /// | P, R   | `code`, the result           | m    |
    /// | F      | `phase`, of any ambiguity    | m    |
    /// | n      | codes of the arc so far      | 1    |
    /// | step   | shortest step of the arc     | s    |
    ///
    /// An arc begins with its first code, again after a gap, after `lost` (the receiver's loss of lock), where the phase is missing
    /// (not finite), and where code and phase part by more than the limit.
    pub fn smoothed(&mut self, how: &Smoothing, time: GpsTime, code: Metres, phase: Metres, lost: bool) -> Metres {
        let (code, phase) = (code.m(), phase.m());
        if !phase.is_finite() || !code.is_finite() {
            self.last = None;
            return Metres::new(code);
        }
        let carried = self.carried(how, time, phase, lost).filter(|(carried, ..)| (code - carried).abs() <= how.slip.m());
        let before = self.noise_share();
        let (smoothed, count, step_s, noise_share) = carried.map_or((code, 1.0, f64::INFINITY, 1.0), |(carried, count, step_s)| {
            let weight = 1.0 / count.min(how.window_s / step_s).max(1.0);
            let kept = 1.0 - weight;
            (weight * code + kept * carried, count, step_s, weight * weight + kept * kept * before)
        });
        self.last = Some(Last { time, phase, smoothed, count, step_s, noise_share });
        Metres::new(smoothed)
    }

    /// Variance of the last smoothed code against that of one code, for code noise without memory: 1 at the beginning of an arc.
    ///
    /// ```text
    /// v(k) = a^2 + (1 - a)^2 v(k-1)        a as in the filter; a / (2 - a) in the end
    /// ```
    pub fn noise_share(&self) -> f64 {
        self.last.map_or(1.0, |last| last.noise_share)
    }

    /// The last smoothed range carried on by the phase, codes of the arc with this one, and its shortest step; `None` where an arc must
    /// begin.
    fn carried(&self, how: &Smoothing, time: GpsTime, phase: f64, lost: bool) -> Option<(f64, f64, f64)> {
        let last = self.last.filter(|_| !lost)?;
        let step = time.seconds_since(last.time);
        let carried = last.smoothed + phase - last.phase;
        (step > 0.0 && step <= how.longest_gap_s).then(|| (carried, last.count + 1.0, last.step_s.min(step)))
    }
}

/// The difference of two phases of one satellite, which only the ionosphere changes: a jump is a slip.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PhasePair {
    last: Option<(GpsTime, f64)>,
}

/// Least jump between two phases that is a slip \[m\]: a cycle of L1 less one of L2 is 54 mm.
const PAIR_JUMP: f64 = 0.05;
/// Rate that the ionosphere may give the difference \[m/s\]: above what storms have shown at L1 less L2.
const PAIR_RATE: f64 = 0.005;

impl PhasePair {
    /// Whether the difference first minus second has jumped since the last time; not at the first time, nor after a missing one.
    pub fn slipped(&mut self, time: GpsTime, difference: Metres) -> bool {
        let last = self.last.take();
        if !difference.m().is_finite() {
            return false;
        }
        self.last = Some((time, difference.m()));
        last.is_some_and(|(then, before)| !((difference.m() - before).abs() <= PAIR_JUMP + PAIR_RATE * time.seconds_since(then).abs()))
    }
}

/// Phase that runs as the code on `first` does, ionosphere included: nothing of it stays in the smoothed code however long the window.
///
/// ```text
/// F = F1 + 2 (F1 - F2) / (f1^2 / f2^2 - 1)
/// ```
pub fn divergence_free(first: (Carrier, Metres), second: (Carrier, Metres)) -> Metres {
    let ratio = first.0.frequency_hz() / second.0.frequency_hz();
    Metres::new(first.1.m() + 2.0 * (first.1.m() - second.1.m()) / (ratio * ratio - 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    const HOW: Smoothing = Smoothing::over(60.0);

    fn at(seconds: f64) -> GpsTime {
        GpsTime::default().plus_seconds(seconds)
    }

    /// Noise without memory that adds to nothing over an even number of samples.
    fn noise(k: usize) -> f64 {
        if k.is_multiple_of(2) { 1.0 } else { -1.0 }
    }

    #[test]
    fn inside_the_window_it_is_the_plain_mean_of_code_less_phase() {
        let mut channel = Channel::default();
        let mut sum = 0.0;
        for k in 0..60 {
            let range = 2.0e7 + 300.0 * k as f64;
            let smoothed = channel.smoothed(&HOW, at(k as f64), Metres::new(range + noise(k * k / 7)), Metres::new(range - 5.0e6), false);
            sum += noise(k * k / 7);
            // Twenty additions of numbers near 2e7 lose some 1e-8.
            assert!((smoothed.m() - range - sum / (k + 1) as f64).abs() < 1e-6, "epoch {k}");
        }
    }

    #[test]
    fn beyond_the_window_old_codes_fade_by_the_time_constant() {
        let mut channel = Channel::default();
        let mut last = 0.0;
        // One metre of code error in the first epoch counts 1/60 when the window is full, and e^-1 of that one window later.
        for k in 0..=120 {
            let code = if k == 0 { 1.0 } else { 0.0 };
            last = channel.smoothed(&HOW, at(k as f64), Metres::new(code), Metres::new(0.0), false).m();
        }
        assert!((last - (59.0_f64 / 60.0).powi(61) / 60.0).abs() < 1e-9, "{last}");
    }

    #[test]
    fn the_step_of_the_receiver_does_not_change_the_window() {
        let variance = |step: f64| {
            let (mut channel, mut squares, n) = (Channel::default(), 0.0, 4000);
            let mut state = 1_u64;
            for k in 0..n {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                let code = (state >> 40) as f64 / f64::from(1 << 24) - 0.5;
                let smoothed = channel.smoothed(&HOW, at(step * k as f64), Metres::new(code), Metres::new(0.0), false).m();
                squares += if k > 1000 { smoothed * smoothed } else { 0.0 };
            }
            squares / f64::from(n - 1001)
        };
        // White noise of variance 1/12 through a first-order filter of weight a leaves a / (2 - a) of it: a is 1/60 and 10/60.
        for (step, weight) in [(1.0, 1.0 / 60.0), (10.0, 10.0 / 60.0)] {
            let expected = weight / (2.0 - weight) / 12.0;
            // 3000 samples of 60 (6) epochs of memory: 50 (500) independent ones, a relative spread of sqrt(2/50) or less.
            assert!((variance(step) / expected - 1.0).abs() < 0.6, "{} {expected}", variance(step));
        }
    }

    #[test]
    fn the_share_of_noise_that_is_left_is_that_of_the_filter() {
        let mut channel = Channel::default();
        assert_eq!(channel.noise_share(), 1.0);
        for k in 0..2000 {
            channel.smoothed(&HOW, at(f64::from(k)), Metres::new(0.0), Metres::new(0.0), false);
            // Inside the window it is a plain mean of k + 1 codes.
            assert!(k >= 60 || (channel.noise_share() * f64::from(k + 1) - 1.0).abs() < 1e-12, "{k}");
        }
        // The steady state of a first-order filter of weight 1/60: a / (2 - a).
        assert!((channel.noise_share() * (2.0 * 60.0 - 1.0) - 1.0).abs() < 1e-9);
        channel.smoothed(&HOW, at(2000.0), Metres::new(0.0), Metres::new(0.0), true);
        assert_eq!(channel.noise_share(), 1.0);
    }

    #[test]
    fn arcs_begin_anew_after_loss_of_lock_gap_missing_phase_and_slip() {
        let started = || {
            let mut channel = Channel::default();
            for k in 0..30 {
                channel.smoothed(&HOW, at(f64::from(k)), Metres::new(0.0), Metres::new(0.0), false);
            }
            channel
        };
        let next =
            |time: f64, code: f64, phase: f64, lost| started().smoothed(&HOW, at(time), Metres::new(code), Metres::new(phase), lost).m();
        assert!(next(30.0, 4.0, 0.0, false) < 0.2);
        assert_eq!(next(30.0, 4.0, 0.0, true), 4.0);
        assert_eq!(next(89.1, 4.0, 0.0, false), 4.0);
        assert!(next(89.0, 4.0, 0.0, false) < 4.0);
        assert_eq!(next(30.0, 4.0, f64::NAN, false), 4.0);
        assert_eq!(next(30.0, 4.0, -6.1, false), 4.0);
        // A step back in time is no step.
        assert_eq!(next(20.0, 4.0, 0.0, false), 4.0);
        assert!(next(30.0, f64::NAN, 0.0, false).is_nan());
    }

    #[test]
    fn a_slip_of_one_cycle_on_either_phase_is_seen() {
        for slip in [Carrier::L1.wavelength_m(), -Carrier::L2.wavelength_m(), Carrier::L1.wavelength_m() - Carrier::L2.wavelength_m()] {
            let mut pair = PhasePair::default();
            assert!(!pair.slipped(at(0.0), Metres::new(3.0)));
            assert!(!pair.slipped(at(1.0), Metres::new(3.01)));
            assert!(pair.slipped(at(1.1), Metres::new(3.01 + slip)));
            assert!(!pair.slipped(at(2.0), Metres::new(f64::NAN)));
            assert!(!pair.slipped(at(3.0), Metres::new(9.0)));
        }
    }

    #[test]
    fn the_divergence_free_phase_carries_the_delay_of_the_code() {
        // A delay I on L1 lengthens the code by I, shortens the phase by I, and by (f1/f2)^2 I on L2.
        let delay = 7.0;
        let ratio = Carrier::L1.frequency_hz() / Carrier::L2.frequency_hz();
        let (first, second) = (Metres::new(-delay), Metres::new(-delay * ratio * ratio));
        assert!((divergence_free((Carrier::L1, first), (Carrier::L2, second)).m() - delay).abs() < 1e-12);
    }
}
