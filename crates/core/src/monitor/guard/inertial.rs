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
        let beyond = (0..2).any(|k| !within(&now[k], self.envelope.most[k]));
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
        let yes = (0..2).any(|k| !now[k].iter().all(|x| x.abs() < SATURATED.0 * self.envelope.range[k]));
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
        dt <= 2.0 * CHANGE_S && !within(&(force - before), self.envelope.change_mps3 * dt)
    }
}

/// Whether no component is beyond a size; one that is no number is, which a largest component would pass over.
fn within(v: &Vector3<f64>, most: f64) -> bool {
    v.iter().all(|x| x.abs() <= most)
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP_S: f64 = 0.02;

    /// Number of the first sample that is doubted, counted from one; samples without a fault are noisy.
    fn first_doubt(
        envelope: Envelope,
        acceleration: Option<f64>,
        fault: impl Fn(i32, &mut Vector3<f64>, &mut Vector3<f64>),
    ) -> Option<i32> {
        let mut plausibility = Plausibility::new(envelope);
        (1..=200).find(|k| {
            let noise = f64::from(k * 7919 % 1009) * 1e-5;
            let (mut force, mut rate) = (Vector3::new(noise, -noise, 9.8 + noise), Vector3::new(noise, 2.0 * noise, -noise) * 1e-2);
            fault(*k, &mut force, &mut rate);
            let time = GpsTime::default().plus_seconds(f64::from(*k) * STEP_S);
            let sample = ImuIncrement { time, interval_s: STEP_S, velocity_mps: force * STEP_S, angle_rad: rate * STEP_S };
            !plausibility.holds(&sample, acceleration)
        })
    }

    const REPEATS: Envelope = Envelope { never_repeats: true, ..Envelope::NONE };

    #[test]
    fn a_healthy_unit_is_never_doubted() {
        let tight = Envelope { range: [20.0, 1.0], most: [12.0, 0.1], change_mps3: 1.0, never_repeats: true };
        assert_eq!(first_doubt(tight, Some(0.5), |_, _, _| ()), None);
        assert_eq!(
            first_doubt(Envelope::NONE, Some(0.0), |_, f, r| (*f, *r) = (Vector3::zeros(), Vector3::zeros())),
            None,
            "nothing is declared"
        );
    }

    #[test]
    fn samples_that_repeat_are_doubted_at_their_number() {
        let (force, rate) = (Vector3::new(0.1, 0.2, 9.7), Vector3::new(1e-3, 2e-3, 3e-3));
        // Rates alone 4, forces alone 12, both 4, zeros 3; begun at the tenth sample. What the unit has never exceeded is no stop: the
        // first samples are larger.
        let larger = |k: i32, f: &mut Vector3<f64>, r: &mut Vector3<f64>| {
            if k == 1 {
                (*f, *r) = (Vector3::repeat(30.0), Vector3::repeat(1.0))
            }
        };
        assert_eq!(
            first_doubt(REPEATS, None, |k, f, r| {
                larger(k, f, r);
                if k >= 10 {
                    *r = rate
                }
            }),
            Some(13)
        );
        assert_eq!(
            first_doubt(REPEATS, None, |k, f, r| {
                larger(k, f, r);
                if k >= 10 {
                    *f = force
                }
            }),
            Some(21)
        );
        assert_eq!(
            first_doubt(REPEATS, None, |k, f, r| {
                larger(k, f, r);
                if k >= 10 {
                    (*f, *r) = (force, rate)
                }
            }),
            Some(13)
        );
        let zeros = |k: i32, f: &mut Vector3<f64>, r: &mut Vector3<f64>| {
            larger(k, f, r);
            if k >= 10 {
                (*f, *r) = (Vector3::zeros(), Vector3::zeros())
            }
        };
        assert_eq!(first_doubt(REPEATS, None, zeros), Some(12));
        assert_eq!(first_doubt(Envelope { most: [50.0; 2], ..Envelope::NONE }, None, zeros), None, "samples of this unit may repeat");
        // A run that is broken begins anew: three equal rates, another, three equal ones.
        assert_eq!(
            first_doubt(REPEATS, None, |k, f, r| {
                larger(k, f, r);
                if k >= 10 && k % 4 != 0 {
                    *r = rate
                }
            }),
            None
        );
    }

    #[test]
    fn what_the_aircraft_cannot_do_and_what_is_no_number_is_doubted_at_once() {
        let most = Envelope { most: [12.0, 0.5], ..Envelope::NONE };
        for (force, rate, doubt) in
            [(12.0, 0.5, None), (12.001, 0.0, Some(30)), (9.8, 0.501, Some(30)), (f64::NAN, 0.0, Some(30)), (9.8, f64::NAN, Some(30))]
        {
            for sign in [1.0, -1.0] {
                let first = first_doubt(most, None, |k, f, r| {
                    if k == 30 {
                        (f.z, r.x) = (sign * force, sign * rate)
                    }
                });
                assert_eq!(first, doubt, "{force} {rate}");
            }
        }
    }

    #[test]
    fn a_range_is_met_twice_before_it_is_doubted() {
        let range = Envelope { range: [20.0, 1.0], ..Envelope::NONE };
        for (force, rate) in [(19.7, 0.0), (-19.7, 0.0), (9.8, 0.99), (9.8, -0.99)] {
            let at = |from: i32, to: i32| {
                first_doubt(range, None, |k, f, r| {
                    if k >= from && k <= to {
                        (f.z, r.y) = (force, rate)
                    }
                })
            };
            assert_eq!((at(30, 30), at(30, 31)), (None, Some(31)), "{force} {rate}");
        }
        // 98 % of the range is not reached.
        assert_eq!(first_doubt(range, None, |_, f, r| (f.z, r.y) = (19.5, 0.97)), None);
        assert_eq!(
            first_doubt(range, None, |k, f, _| if k == 30 || k == 32 {
                f.z = 19.9
            }),
            None
        );
    }

    #[test]
    fn a_largest_value_met_three_times_is_a_stop() {
        let clip = |most: i32| {
            first_doubt(REPEATS, None, move |k, f, _| {
                if k >= 30 && k < 30 + most {
                    f.y = -15.0
                }
            })
        };
        assert_eq!((clip(2), clip(3)), (None, Some(32)));
        // A larger one in between is a new stop, a smaller one begins anew.
        assert_eq!(
            first_doubt(REPEATS, None, |k, f, _| if (30..34).contains(&k) {
                f.y = [15.0, 15.0, 16.0, 16.0][(k - 30) as usize]
            }),
            None
        );
        assert_eq!(
            first_doubt(REPEATS, None, |k, f, _| if (30..34).contains(&k) {
                f.y = [15.0, 15.0, 14.0, 15.0][(k - 30) as usize]
            }),
            None
        );
        assert_eq!(
            first_doubt(REPEATS, None, |k, _, r| if (30..33).contains(&k) {
                r.x = 2.0
            }),
            Some(32)
        );
    }

    #[test]
    fn a_force_that_changes_faster_than_declared_is_doubted_over_a_tenth_of_a_second() {
        let change = Envelope { change_mps3: 10.0, ..Envelope::NONE };
        // The tenths end with the samples 1, 6, 11, 16: one metre per second squared is allowed from end to end.
        for (step, doubt) in [(0.9, None), (1.1, Some(16)), (-1.1, Some(16)), (f64::NAN, Some(12))] {
            let first = first_doubt(change, None, |k, f, _| {
                if k >= 12 {
                    f.x += step
                }
            });
            assert_eq!(first, doubt, "{step}");
        }
        let mut plausibility = Plausibility::new(change);
        let mut hear = |t: f64, force: f64| {
            let time = GpsTime::default().plus_seconds(t);
            let velocity_mps = Vector3::new(force, 0.0, 9.8) * STEP_S;
            plausibility.holds(&ImuIncrement { time, interval_s: STEP_S, velocity_mps, angle_rad: Vector3::zeros() }, None)
        };
        assert!(hear(0.0, 0.0) && hear(0.2, 1.9), "two metres in two tenths are allowed");
        assert!(!hear(0.4, 4.0), "2.1 are not");
        assert!(hear(0.65, 9.0), "a hole says nothing");
        assert!(hear(0.3, 0.0) && hear(0.4, 0.9) && !hear(0.5, 2.0), "times that run backwards begin anew");
    }

    #[test]
    fn a_weight_that_gravity_and_flight_do_not_give_is_doubted_where_the_satellites_are_steady() {
        let declared = Envelope { most: [1e3, 1e3], ..Envelope::NONE };
        let constant =
            |size: f64, acceleration: Option<f64>| first_doubt(declared, acceleration, |_, f, _| *f = Vector3::new(0.0, 0.6, 0.8) * size);
        // The mean of the first second is known with its fiftieth sample, or the next where the sum of fiftieths rounds below one.
        for size in [2.9, 29.5, 0.0] {
            assert!(matches!(constant(size, Some(2.9)), Some(50 | 51)), "{size}");
            assert_eq!((constant(size, Some(3.1)), constant(size, None)), (None, None));
        }
        assert_eq!((constant(2.95, Some(0.0)), constant(29.3, Some(0.0))), (None, None));
        // A mean over a second: forty times a second's twentieth of what is missing.
        let lost = first_doubt(declared, Some(0.0), |k, f, _| {
            if k > 100 {
                *f = Vector3::zeros()
            }
        })
        .unwrap();
        // (1 - 1 / 50)^n < 0.3 for n above 59.6.
        assert!((159..=162).contains(&lost), "{lost}");
    }

    #[test]
    fn an_envelope_without_room_is_refused_by_name() {
        assert!(Envelope::NONE.check().is_ok());
        for bad in [0.0, -1.0, f64::NAN] {
            let none = Envelope::NONE;
            for (envelope, argument) in [
                (Envelope { range: [bad, 1.0], ..none }, "force_range_mps2"),
                (Envelope { range: [1.0, bad], ..none }, "rate_range_radps"),
                (Envelope { most: [bad, 1.0], ..none }, "force_most_mps2"),
                (Envelope { most: [1.0, bad], ..none }, "rate_most_radps"),
                (Envelope { change_mps3: bad, ..none }, "force_change_mps3"),
            ] {
                assert_eq!(envelope.check().unwrap_err().argument, argument);
            }
        }
    }
}
