//! Whether the inertial unit can be right, by what it delivers alone.

use crate::quantity::{GpsTime, OutOfDomain};
use crate::signal::ImuIncrement;
use nalgebra::Vector3;

/// What the maker of a unit and of a vehicle declare. Infinite where nothing is declared: that rule is then off.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Envelope {
    /// Measuring range of an accelerometer \[m/s²\] and of a gyroscope \[rad/s\].
    pub range: [f64; 2],
    /// Largest specific force \[m/s²\] and rate \[rad/s\] of the vehicle along an axis.
    pub most: [f64; 2],
    /// Largest change of the specific force over a tenth of a second \[m/s³\].
    pub change_mps3: f64,
    /// Whether a healthy unit never repeats its last numbers to the bit: it has noise above its resolution.
    pub never_repeats: bool,
}

impl Envelope {
    /// Nothing is declared: only numbers that are none are refused, by the filter.
    pub const NONE: Self = Self { range: [f64::INFINITY; 2], most: [f64::INFINITY; 2], change_mps3: f64::INFINITY, never_repeats: false };

    /// # Errors
    /// [`OutOfDomain`] for a limit that is not positive.
    pub fn check(&self) -> Result<(), OutOfDomain> {
        let [force, rate] = self.range;
        for (argument, value, unit) in [
            ("force_range_mps2", force, "m/s²"),
            ("rate_range_radps", rate, "rad/s"),
            ("force_most_mps2", self.most[0], "m/s²"),
            ("rate_most_radps", self.most[1], "rad/s"),
            ("force_change_mps3", self.change_mps3, "m/s³"),
        ] {
            if !(value > 0.0) {
                return Err(OutOfDomain { argument, value, unit, domain: "(0, inf]" });
            }
        }
        Ok(())
    }
}

/// Share of the declared range from which a sample is saturated, and samples on end. Provenance: inferred.
const SATURATED: (f64, u32) = (0.98, 2);
/// Samples on end that repeat the same bits: gyroscopes, accelerometers, all, and zeros of all. Provenance: the longest healthy repeats of two
/// recorded units are 2, 6, 2 and 0 samples.
const REPEATS_MOST: [u32; 4] = [4, 12, 4, 3];
/// Samples on end at exactly the largest number of the flight along an axis. Provenance: inferred.
const CLIPPED: u32 = 3;
/// Time over which a change of the force is taken \[s\].
const CHANGE_S: f64 = 0.1;
/// Mean force over a second that a vehicle without acceleration has \[m/s²\], and the acceleration by snapshots below which it is one
/// \[m/s²\]. Provenance: inferred.
const WEIGHT: (f64, f64) = (0.3 * 9.8, 3.0 * 9.8);
const STEADY_MPS2: f64 = 3.0;

/// What is remembered of the samples.
#[derive(Debug, Clone)]
pub struct Plausibility {
    envelope: Envelope,
    last: [Vector3<f64>; 2],
    repeats: [u32; 4],
    saturated: u32,
    /// Largest magnitude of the flight along each axis, and samples on end at it: accelerometers, gyroscopes.
    extreme: [[f64; 3]; 2],
    clipped: [[u32; 3]; 2],
    changed: Option<(GpsTime, Vector3<f64>)>,
    /// Mean force over a second, by samples.
    force: Vector3<f64>,
    heard_s: f64,
}

impl Plausibility {
    /// Nothing heard yet.
    pub fn new(envelope: Envelope) -> Self {
        Self {
            envelope,
            last: [Vector3::repeat(f64::NAN); 2],
            repeats: [0; 4],
            saturated: 0,
            extreme: [[0.0; 3]; 2],
            clipped: [[0; 3]; 2],
            changed: None,
            force: Vector3::zeros(),
            heard_s: 0.0,
        }
    }

    /// Whether a sample can be right, of an aircraft whose acceleration by snapshots is known or not \[m/s²\].
    pub fn holds(&mut self, sample: &ImuIncrement, acceleration_mps2: Option<f64>) -> bool {
        let dt = sample.interval_s;
        let now = [sample.velocity_mps / dt, sample.angle_rad / dt];
        let frozen = self.repeats(&[sample.velocity_mps, sample.angle_rad]);
        let beyond = (0..2).any(|k| !(now[k].amax() <= self.envelope.most[k]));
        let saturated = self.saturates(&now);
        let clipped = self.clips(&[sample.velocity_mps, sample.angle_rad]);
        let changed = self.changes(sample.time, &now[0]);
        self.heard_s += dt;
        self.force += (dt / self.heard_s.min(1.0)).min(1.0) * (now[0] - self.force);
        let weight = self.force.norm();
        let steady = self.heard_s >= 1.0 && acceleration_mps2.is_some_and(|a| a < STEADY_MPS2);
        let weightless = self.envelope != Envelope::NONE && steady && !(weight >= WEIGHT.0 && weight <= WEIGHT.1);
        !(frozen || beyond || saturated || clipped || changed || weightless)
    }

    fn repeats(&mut self, now: &[Vector3<f64>; 2]) -> bool {
        let [force, rate] = [0, 1].map(|k| now[k] == self.last[k]);
        let zero = now.iter().all(|v| v.iter().all(|x| *x == 0.0));
        for (count, yes) in self.repeats.iter_mut().zip([rate, force, rate && force, zero]) {
            *count = if yes { *count + 1 } else { 0 };
        }
        self.last = *now;
        // The first sample of a run repeats nothing; of zeros it is one already.
        let runs = [self.repeats[0] + 1, self.repeats[1] + 1, self.repeats[2] + 1, self.repeats[3]];
        self.envelope.never_repeats && runs.iter().zip(REPEATS_MOST).any(|(n, most)| *n >= most)
    }

    fn saturates(&mut self, now: &[Vector3<f64>; 2]) -> bool {
        let yes = (0..2).any(|k| !(now[k].amax() < SATURATED.0 * self.envelope.range[k]));
        self.saturated = if yes { self.saturated + 1 } else { 0 };
        self.saturated >= SATURATED.1
    }

    fn clips(&mut self, now: &[Vector3<f64>; 2]) -> bool {
        let mut clipped = false;
        for k in 0..2 {
            for axis in 0..3 {
                let size = now[k][axis].abs();
                let (most, count) = (&mut self.extreme[k][axis], &mut self.clipped[k][axis]);
                *count = if size > *most {
                    1
                } else if size == *most {
                    *count + 1
                } else {
                    0
                };
                *most = most.max(size);
                clipped |= *count >= CLIPPED && size > 0.0;
            }
        }
        clipped && self.envelope.never_repeats
    }

    fn changes(&mut self, time: GpsTime, force: &Vector3<f64>) -> bool {
        let Some((since, before)) = self.changed else {
            self.changed = Some((time, *force));
            return false;
        };
        let dt = time.seconds_since(since);
        if !(dt >= CHANGE_S - 1e-6) {
            // Times that run backwards begin anew.
            if dt < 0.0 {
                self.changed = Some((time, *force));
            }
            return false;
        }
        self.changed = Some((time, *force));
        // Over a hole a change says nothing.
        dt <= 2.0 * CHANGE_S && !((force - before).amax() <= self.envelope.change_mps3 * dt)
    }
}
