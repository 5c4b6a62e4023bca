//! What ground monitors may miss: equations 7 to 10.

use crate::quantity::{Metres, OutOfDomain, Risk};
use crate::spec::gbas::MonitorCurve;
use crate::special::float::{exp, exp_m1, ln, ln_1p, sqrt};
use crate::special::tail;

/// Probability that one of the satellites is faulty while the monitors with memory do not yet show it (equation 9).
///
/// ```text
/// P = 1 - product over satellites of (1 - r tau / 3600)
/// ```
///
/// `groups` holds how many satellites have which rate \[1/h\].
///
/// # Errors
/// [`OutOfDomain`] for rates or times whose product is outside \[0, 1).
pub fn fault_probability(groups: impl IntoIterator<Item = (f64, f64)>, tau_s: f64) -> Result<f64, OutOfDomain> {
    let mut log = 0.0;
    for (satellites, per_hour) in groups {
        let one = per_hour * tau_s / 3600.0;
        if !(0.0..1.0).contains(&one) {
            return Err(OutOfDomain { argument: "rate_per_hour", value: per_hour, unit: "1/h", domain: "[0, 3600 / tau_s)" });
        }
        log += satellites * ln_1p(-one);
    }
    Ok(-exp_m1(log))
}

/// Missed detection of a range error by the ground monitors; of an error that is no number nothing is known, not even the curve's floor.
pub fn missed_by_monitor(curve: &MonitorCurve, error: Metres) -> f64 {
    let e = error.m().abs() / curve.stretch;
    if e.is_nan() {
        f64::NAN
    } else if e < curve.start.m() {
        1.0
    } else if e <= curve.end.m() {
        exp((curve.slope_per_m * e + curve.offset) * core::f64::consts::LN_10)
    } else {
        curve.floor
    }
}

/// The case of a fault that began before the fix was last used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hazard {
    /// Total system containment.
    pub containment: Metres,
    /// Standard deviation of the total system error.
    pub sigma: Metres,
    /// Horizontal effect of nominal biases.
    pub bias: Metres,
    /// Metres of position for a metre of range error.
    pub projection: f64,
    /// Risk allotted to this hypothesis.
    pub allotted: f64,
    /// Probability of the fault.
    pub fault: f64,
}

impl Hazard {
    /// Checked.
    ///
    /// # Errors
    /// [`OutOfDomain`] naming the first number outside its domain.
    pub fn new(containment: Metres, sigma: Metres, bias: Metres, projection: f64, allotted: Risk, fault: f64) -> Result<Self, OutOfDomain> {
        for (argument, value, unit) in
            [("containment_m", containment.m(), "m"), ("sigma_tse_m", sigma.m(), "m"), ("projection", projection, "1")]
        {
            if !(value > 0.0 && value.is_finite()) {
                return Err(OutOfDomain { argument, value, unit, domain: "(0, inf)" });
            }
        }
        if !(bias.m() >= 0.0 && bias.m().is_finite()) {
            return Err(OutOfDomain { argument: "bias_hor_m", value: bias.m(), unit: "m", domain: "[0, inf)" });
        }
        if !(fault > 0.0 && fault < 1.0) {
            return Err(OutOfDomain { argument: "p_fault", value: fault, unit: "1", domain: "(0, 1)" });
        }
        Ok(Self { containment, sigma, bias, projection, allotted: allotted.q(), fault })
    }

    /// Probability that the total system error leaves the containment with a range error E (equation 8).
    pub fn exceedance(&self, error: Metres) -> f64 {
        let moved = self.projection * error.m().abs() + self.bias.m();
        tail((self.containment.m() - moved) / self.sigma.m()) + tail((self.containment.m() + moved) / self.sigma.m())
    }

    /// Largest missed detection that keeps the risk (equations 7 and 10); NaN for an error that is no number.
    pub fn limit(&self, error: Metres) -> f64 {
        let most = self.allotted / (self.fault * self.exceedance(error));
        // `min` would turn a NaN into the largest limit of all.
        if most > 1.0 { 1.0 } else { most }
    }

    /// The smallest limit over monitor's missed detection, as decades, over all range errors: not negative where the monitor suffices.
    ///
    /// Below the curve's start it can only be worst at the start, beyond its end where the exceedance is certain; between, where the
    /// curve falls, by a scan of 64 steps and a golden section.
    pub fn margin_decades(&self, curve: &MonitorCurve) -> f64 {
        let (start, end) = (curve.start.m() * curve.stretch, curve.end.m() * curve.stretch);
        let fallen = |e: f64| {
            let ratio = self.allotted / (self.fault * self.exceedance(Metres::new(e)) * missed_by_monitor(curve, Metres::new(e)));
            ln(ratio.max(f64::MIN_POSITIVE))
        };
        let step = (end - start) / STEPS;
        let (mut worst, mut at) = (f64::INFINITY, start);
        for k in 0..=(STEPS as u32) {
            let e = start + step * f64::from(k);
            let value = fallen(e);
            if value < worst {
                (worst, at) = (value, e);
            }
        }
        worst = worst.min(golden(&fallen, (at - step).max(start), (at + step).min(end)));
        let below = ln(self.allotted / (self.fault * self.exceedance(Metres::new(start))));
        let beyond = ln(self.allotted / (self.fault * curve.floor));
        worst.min(below).min(beyond) / core::f64::consts::LN_10
    }

    /// Whether the monitor suffices.
    pub fn met_by(&self, curve: &MonitorCurve) -> bool {
        self.margin_decades(curve) >= 0.0
    }
}

/// Steps of the scan.
const STEPS: f64 = 64.0;

/// The least value of a function with one minimum inside, to 1e-6 of the interval.
fn golden(f: &impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let share = 0.5 * (sqrt(5.0) - 1.0);
    let (mut a, mut b) = (high - share * (high - low), low + share * (high - low));
    let (mut fa, mut fb) = (f(a), f(b));
    for _ in 0..30 {
        if fa < fb {
            (high, b, fb) = (b, a, fa);
            a = high - share * (high - low);
            fa = f(a);
        } else {
            (low, a, fa) = (a, b, fb);
            b = low + share * (high - low);
            fb = f(b);
        }
    }
    fa.min(fb)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spec::gbas::{MONITOR_D, MONITOR_F};

    fn hazard(containment_m: f64) -> Hazard {
        let risk = Risk::new(0.375 * 1.25e-9).unwrap();
        Hazard::new(Metres::new(containment_m), Metres::new(0.4), Metres::new(0.0), 2.0, risk, 5e-6).unwrap()
    }

    /// Section 8, item 5: two printed values to four digits.
    #[test]
    fn fault_probabilities_meet_the_printed_ones() {
        let one = fault_probability([(18.0, 1e-5)], 100.0).unwrap();
        let mixed = fault_probability([(9.0, 1e-5), (9.0, 3e-5)], 100.0).unwrap();
        assert!((one - 5.000e-6).abs() < 5e-10 && (mixed - 1.000e-5).abs() < 5e-9, "{one} {mixed}");
        // To all digits by the other end: 18 satellites less 153 pairs and more 816 triples.
        let p: f64 = 1e-5 * 100.0 / 3600.0;
        assert!((one - (18.0 * p - 153.0 * p * p + 816.0 * p * p * p)).abs() < 1e-20, "{one:e}");
        assert!(fault_probability([(1.0, 40.0)], 100.0).is_err() && fault_probability([(1.0, f64::NAN)], 1.0).is_err());
    }

    #[test]
    fn the_curve_meets_its_printed_values() {
        let d = |e| missed_by_monitor(&MONITOR_D, Metres::new(e));
        assert_eq!(d(0.74), 1.0);
        assert!((d(2.0) - 6.31e-4).abs() < 5e-7);
        assert_eq!(d(3.0), 1e-5);
        assert_eq!(d(-2.0), d(2.0));
        assert_eq!(missed_by_monitor(&MONITOR_F, Metres::new(2.2 * 2.0)), d(2.0));
    }

    #[test]
    fn the_margin_is_the_least_of_a_dense_scan() {
        for containment in [3.0, 4.0, 4.4, 5.0, 8.0] {
            for curve in [&MONITOR_D, &MONITOR_F] {
                let h = hazard(containment);
                let scan = (0..200_000)
                    .map(|k| Metres::new(f64::from(k) * 1e-4))
                    .map(|e| (h.allotted / (h.fault * h.exceedance(e)) / missed_by_monitor(curve, e)).log10())
                    .fold(f64::INFINITY, f64::min);
                // Twenty metres in steps of a tenth of a millimetre; the steepest side changes by 40 decades a metre.
                assert!((h.margin_decades(curve) - scan).abs() < 5e-3, "{containment}: {} {scan}", h.margin_decades(curve));
            }
        }
    }

    #[test]
    fn a_larger_bias_never_helps() {
        let with = |bias_m: f64| Hazard { bias: Metres::new(bias_m), ..hazard(4.5) }.margin_decades(&MONITOR_D);
        assert!(with(0.0) > with(0.2) && with(0.2) > with(0.5));
    }

    #[test]
    fn numbers_outside_their_domain_are_named() {
        let risk = Risk::new(1e-9).unwrap();
        let (m, z) = (Metres::new(1.0), Metres::new(0.0));
        assert_eq!(Hazard::new(z, m, z, 1.0, risk, 0.1).unwrap_err().argument, "containment_m");
        assert_eq!(Hazard::new(m, Metres::new(f64::NAN), z, 1.0, risk, 0.1).unwrap_err().argument, "sigma_tse_m");
        assert_eq!(Hazard::new(m, m, Metres::new(-1.0), 1.0, risk, 0.1).unwrap_err().argument, "bias_hor_m");
        assert_eq!(Hazard::new(m, m, z, 0.0, risk, 0.1).unwrap_err().argument, "projection");
        assert_eq!(Hazard::new(m, m, z, 1.0, risk, 0.0).unwrap_err().argument, "p_fault");
    }

    #[test]
    fn an_exceedance_is_that_of_both_sides() {
        let h = Hazard { bias: Metres::new(0.3), ..hazard(2.0) };
        // 2 m of projection and 0.3 m of bias: tails at (2 - 1.1) / 0.4 and (2 + 1.1) / 0.4, as erfc has them.
        let expected = 0.012_224_472_655_044_696 + tail(7.75);
        assert!((h.exceedance(Metres::new(0.4)) - expected).abs() < 1e-15, "{}", h.exceedance(Metres::new(0.4)));
        assert_eq!(h.exceedance(Metres::new(-0.4)), h.exceedance(Metres::new(0.4)));
        // So wide an error that both sides count.
        let wide = Hazard { sigma: Metres::new(10.0), ..h };
        assert!((wide.exceedance(Metres::new(0.4)) - (tail(0.09) + tail(0.31))).abs() < 1e-15);
    }

    /// The scan alone is wrong by the square of half its step; the section is not.
    #[test]
    fn the_margin_is_the_least_of_a_fine_scan_about_the_worst() {
        for tenth in 30..=80 {
            let h = hazard(0.1 * f64::from(tenth));
            let at =
                |e: f64| (h.allotted / (h.fault * h.exceedance(Metres::new(e))) / missed_by_monitor(&MONITOR_D, Metres::new(e))).log10();
            let coarse = (0..20_000).map(|k| 1e-3 * f64::from(k)).min_by(|a, b| at(*a).total_cmp(&at(*b))).unwrap();
            let least = (-20_000..=20_000).map(|k| at(coarse + 1e-7 * f64::from(k))).fold(f64::INFINITY, f64::min);
            // Where the curve begins or ends the least is a corner, which the fine scan misses by at most 1e-7 m of forty decades a metre.
            assert!((h.margin_decades(&MONITOR_D) - least).abs() < 1e-5, "{tenth}: {} {least}", h.margin_decades(&MONITOR_D));
        }
    }
}
