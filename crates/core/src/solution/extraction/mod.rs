//! Error Extraction, the filter: positions and velocities in, the fast part of the position error out. Experimental.
//!
//! Source: Vassilev and Vassileva 2012, "EGNOS performance before and after applying an Error Extraction methodology", equations 2 to 4.
//! The start, the treatment of gaps and the gains of [`gain`] are ours; the paper is silent on them (`docs/methods/error-extraction.md`).

pub mod gain;

use crate::frame::{Displacement, Enu};
use crate::quantity::{GpsTime, OutOfDomain};
use crate::special::float::{exp, ln};
use nalgebra::Vector3;

/// Longest step, in nominal periods, that the filter carries its state over, unless declared otherwise.
pub const GAP_PERIODS: f64 = 3.0;

/// Position and velocity of one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// When.
    pub time: GpsTime,
    /// Where, from a fixed local origin.
    pub position: Displacement<Enu>,
    /// Velocity in the same axes \[m/s\]: Doppler or time-differenced phase of this instant, not a filter's output.
    pub velocity_mps: [f64; 3],
    /// Anything that changes when the set of satellites does; `None` where that is not known.
    pub satellites: Option<u64>,
}

/// How the filter works.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    rho: f64,
    period_s: f64,
    gap_most_s: f64,
    reset_on_new_satellites: bool,
}

impl Settings {
    /// A filter of pole `rho` at a nominal sample period.
    ///
    /// # Deviation from the source
    /// The paper admits `rho` = 1: velocity noise then makes a random walk without bound.
    ///
    /// # Errors
    /// [`OutOfDomain`] unless `0 < rho < 1`, `0 < period_s` and `period_s <= gap_most_s`, all finite.
    pub fn new(rho: f64, period_s: f64, gap_most_s: f64, reset_on_new_satellites: bool) -> Result<Self, OutOfDomain> {
        gain::check_rho(rho)?;
        gain::check_period(period_s)?;
        if !(gap_most_s >= period_s && gap_most_s.is_finite()) {
            return Err(OutOfDomain { argument: "gap_most_s", value: gap_most_s, unit: "s", domain: "[period_s, inf)" });
        }
        Ok(Self { rho, period_s, gap_most_s, reset_on_new_satellites })
    }

    /// `rho` for a step of another length.
    fn decay(&self, step_s: f64) -> f64 {
        if step_s == self.period_s { self.rho } else { exp(ln(self.rho) * step_s / self.period_s) }
    }
}

/// Why the filter began anew.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reset {
    /// The first sample.
    Start,
    /// A step longer than the longest gap.
    Gap,
    /// Other satellites, where the settings ask for a reset then.
    Satellites,
}

/// What the filter says of one sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extracted {
    /// u, the extracted error; the corrected position is the position minus this.
    pub error: Displacement<Enu>,
    /// Samples since the last reset.
    pub age: u32,
    /// Whether and why this sample began anew.
    pub reset: Option<Reset>,
    /// Whether the set of satellites is another than at the sample before.
    pub new_satellites: bool,
}

/// The filter and its state.
///
/// ```text
/// d(i) = y(i) - y(i-1) - dt/2 (v(i) + v(i-1))       ubar(i) = d(i) - d(i-1)      Vassilev 2012, eq. 2
/// w(i) = r w(i-1) + d(i)                                                          r = rho^(dt/T)
/// u(i) = r u(i-1) + w(i) - w(i-1)                   U(z) = Ubar(z) / (1 - rho/z)^2      eq. 3, as a cascade
/// ```
///
/// The cascade equals the difference equation at even sampling and takes uneven sampling as well.
///
/// # Start
/// u = w = 0 at the first sample, u = w = d at the second. Waiting for the first full second difference instead would leave the unknown
/// slope of the error in the state, where it grows to 18.6 times itself at rho = 0.98 before it is forgotten.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Filter {
    settings: Settings,
    last: Option<State>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct State {
    sample: Sample,
    w: Vector3<f64>,
    u: Vector3<f64>,
    age: u32,
}

impl Filter {
    /// A filter that has seen nothing.
    pub const fn new(settings: Settings) -> Self {
        Self { settings, last: None }
    }

    /// The next sample.
    ///
    /// # Errors
    /// [`OutOfDomain`] for a time that is not after the last one, or a position or velocity that is not finite; the state is unchanged.
    pub fn step(&mut self, sample: &Sample) -> Result<Extracted, OutOfDomain> {
        check_finite("position_enu_m", "m", sample.position.vector())?;
        check_finite("velocity_enu_mps", "m/s", &Vector3::from(sample.velocity_mps))?;
        let Some(last) = self.last else { return Ok(self.begin(sample, Reset::Start, false)) };
        let step_s = sample.time.seconds_since(last.sample.time);
        if !(step_s > 0.0) {
            let value = sample.time.nanoseconds() as f64;
            return Err(OutOfDomain { argument: "time_ns", value, unit: "ns", domain: "times that increase" });
        }
        let new_satellites = sample.satellites != last.sample.satellites;
        if step_s > self.settings.gap_most_s {
            return Ok(self.begin(sample, Reset::Gap, new_satellites));
        }
        if new_satellites && self.settings.reset_on_new_satellites {
            return Ok(self.begin(sample, Reset::Satellites, true));
        }
        let r = self.settings.decay(step_s);
        let moved = sample.position.vector() - last.sample.position.vector();
        let mean_velocity = (Vector3::from(sample.velocity_mps) + Vector3::from(last.sample.velocity_mps)) * 0.5;
        let d = moved - mean_velocity * step_s;
        let w = last.w * r + d;
        let u = last.u * r + w - last.w;
        let age = last.age.saturating_add(1);
        self.last = Some(State { sample: *sample, w, u, age });
        Ok(Extracted { error: Displacement::from_vector(u), age, reset: None, new_satellites })
    }

    fn begin(&mut self, sample: &Sample, why: Reset, new_satellites: bool) -> Extracted {
        let zero = Vector3::zeros();
        self.last = Some(State { sample: *sample, w: zero, u: zero, age: 0 });
        Extracted { error: Displacement::from_vector(zero), age: 0, reset: Some(why), new_satellites }
    }
}

fn check_finite(argument: &'static str, unit: &'static str, vector: &Vector3<f64>) -> Result<(), OutOfDomain> {
    match vector.iter().find(|v| !v.is_finite()) {
        Some(&value) => Err(OutOfDomain { argument, value, unit, domain: "finite numbers" }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::Metres;

    const SECOND_NS: i64 = 1_000_000_000;

    fn sample(i: i64, east_m: f64, velocity_mps: f64) -> Sample {
        let position = Displacement::new(Metres::new(east_m), Metres::default(), Metres::default());
        Sample { time: GpsTime::from_nanoseconds(i * SECOND_NS), position, velocity_mps: [velocity_mps, 0.0, 0.0], satellites: None }
    }

    fn filter(rho: f64) -> Filter {
        Filter::new(Settings::new(rho, 1.0, 3.0, false).unwrap())
    }

    /// A step of the error passes whole and then follows rho^k (1 - k (1 - rho)/rho).
    #[test]
    fn a_step_passes_whole_and_swings_back_as_derived() {
        let rho: f64 = 0.98;
        let mut filter = filter(rho);
        for i in 0..10 {
            filter.step(&sample(i, 0.0, 0.0)).unwrap();
        }
        for k in 0..400 {
            let u = filter.step(&sample(10 + k, 5.0, 0.0)).unwrap().error.vector()[0];
            let expected = 5.0 * rho.powi(k as i32) * (1.0 - k as f64 * (1.0 - rho) / rho);
            assert!((u - expected).abs() < 1e-12, "{k}: {u} {expected}");
        }
    }

    /// Motion with its velocity leaves nothing; an acceleration that is constant is integrated exactly by the trapezoid.
    #[test]
    fn true_motion_is_no_error() {
        let mut filter = filter(0.98);
        for i in 0..200 {
            let t = i as f64;
            let u = filter.step(&sample(i, 7.0 + 80.0 * t + 0.5 * t * t, 80.0 + t)).unwrap().error;
            assert!(u.vector()[0].abs() < 1e-9, "{u:?}");
        }
    }

    /// The slope of an error at the start is forgotten, not amplified.
    #[test]
    fn a_ramp_from_the_first_sample_is_forgotten() {
        let mut filter = filter(0.98);
        let mut worst: f64 = 0.0;
        for i in 0..2000 {
            let u = filter.step(&sample(i, 0.1 * i as f64, 0.0)).unwrap().error.vector()[0];
            // Closed form for the second sample equal to d: 0.1 (k+1) rho^k after k + 1 steps.
            worst = worst.max(u.abs());
            if i == 1999 {
                assert!(u.abs() < 1e-12, "{u}");
            }
        }
        // 0.1 * max over k of (k+1) 0.98^k = 0.1 * 50 * 0.98^49
        assert!((worst - 0.1 * 50.0 * 0.98_f64.powi(49)).abs() < 1e-12, "{worst}");
    }

    #[test]
    fn a_short_gap_is_carried_over_and_a_long_one_begins_anew() {
        let mut filter = filter(0.9);
        filter.step(&sample(0, 0.0, 0.0)).unwrap();
        let first = filter.step(&sample(1, 1.0, 0.0)).unwrap();
        assert_eq!(first.error.vector()[0], 1.0);
        // d = 0 over three seconds: w = u = 0.9^3, u = r u + w - w_last.
        let carried = filter.step(&sample(4, 1.0, 0.0)).unwrap();
        let r = 0.9_f64.powi(3);
        assert!((carried.error.vector()[0] - (r + r - 1.0)).abs() < 1e-15);
        assert_eq!((carried.age, carried.reset), (2, None));
        let anew = filter.step(&sample(8, 9.0, 0.0)).unwrap();
        assert_eq!((anew.error.vector()[0], anew.age, anew.reset), (0.0, 0, Some(Reset::Gap)));
    }

    #[test]
    fn new_satellites_are_seen_and_reset_only_where_requested() {
        for reset in [false, true] {
            let mut filter = Filter::new(Settings::new(0.98, 1.0, 3.0, reset).unwrap());
            filter.step(&Sample { satellites: Some(7), ..sample(0, 0.0, 0.0) }).unwrap();
            let next = filter.step(&Sample { satellites: Some(3), ..sample(1, 10.0, 0.0) }).unwrap();
            assert!(next.new_satellites);
            assert_eq!(next.reset, reset.then_some(Reset::Satellites));
            assert_eq!(next.error.vector()[0], if reset { 0.0 } else { 10.0 });
        }
    }

    #[test]
    fn wrong_samples_are_refused_by_name_and_change_nothing() {
        let mut filter = filter(0.98);
        filter.step(&sample(5, 0.0, 0.0)).unwrap();
        let before = filter;
        assert_eq!(filter.step(&sample(5, 0.0, 0.0)).unwrap_err().argument, "time_ns");
        assert_eq!(filter.step(&sample(6, f64::NAN, 0.0)).unwrap_err().argument, "position_enu_m");
        assert_eq!(filter.step(&sample(6, 0.0, f64::INFINITY)).unwrap_err().argument, "velocity_enu_mps");
        assert_eq!(filter, before);
        for (rho, period, gap, name) in
            [(1.0, 1.0, 3.0, "rho"), (f64::NAN, 1.0, 3.0, "rho"), (0.98, 0.0, 3.0, "period_s"), (0.98, 1.0, 0.5, "gap_most_s")]
        {
            assert_eq!(Settings::new(rho, period, gap, false).unwrap_err().argument, name);
        }
    }
}
