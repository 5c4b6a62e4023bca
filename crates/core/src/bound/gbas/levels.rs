//! Protection levels without a fault and with one faulty reference receiver: equation 5.

use super::bias::Ordering;
use super::snapshot::{Form, Snapshot};
use crate::bound::{Algorithm, NoLevels, Protection, Ranges, Sight};
use crate::frame::{Covariance, Enu};
use crate::quantity::{Metres, OutOfDomain, Risk};
use crate::spec::surface::ErrorBudget;
use crate::special::float::{hypot, sqrt};
use crate::special::{one_sided_factor, two_sided_factor};
use nalgebra::Vector3;

/// Multipliers of the two hypotheses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Factors {
    /// K_ffmd: nothing is faulty.
    pub fault_free: f64,
    /// K_md: one reference receiver is.
    pub missed: f64,
}

/// How multipliers follow from an integrity risk (RTCA DO-245A; standard, checked on the published category I values).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FactorRule {
    /// Share of the risk for both hypotheses together.
    pub share: f64,
    /// Coordinates it is split among.
    pub axes: u8,
    /// Reference receivers M.
    pub receivers: u8,
    /// Probability that one of them is faulty.
    pub receiver_fault: f64,
}

impl Factors {
    /// By the rule.
    ///
    /// ```text
    /// p = share risk / (axes (M + 1))       K_ffmd = Q^-1(p / 2)       K_md = Q^-1(p M / P(receiver fault))
    /// ```
    ///
    /// # Errors
    /// [`OutOfDomain`] for a share outside (0, 1\], no axis, fewer than two receivers, or a budget that needs no monitoring of
    /// receivers or cannot be met: `p M / P` must be inside (0, 0.5).
    pub fn new(integrity: Risk, rule: &FactorRule) -> Result<Self, OutOfDomain> {
        if !(rule.share > 0.0 && rule.share <= 1.0) {
            return Err(OutOfDomain { argument: "share", value: rule.share, unit: "1", domain: "(0, 1]" });
        }
        if rule.axes < 1 {
            return Err(OutOfDomain { argument: "axes", value: f64::from(rule.axes), unit: "1", domain: "[1, inf)" });
        }
        if rule.receivers < 2 {
            return Err(OutOfDomain { argument: "receivers", value: f64::from(rule.receivers), unit: "1", domain: "[2, inf)" });
        }
        let m = f64::from(rule.receivers);
        let p = rule.share * integrity.q() / (f64::from(rule.axes) * (m + 1.0));
        let missed = p * m / rule.receiver_fault;
        if !(missed > 0.0 && missed < 0.5) {
            let domain = "(0, 0.5) as missed detection of a faulty receiver: no such budget can be met";
            return Err(OutOfDomain { argument: "receiver_fault", value: missed, unit: "1", domain });
        }
        Ok(Self { fault_free: two_sided_factor(p), missed: one_sided_factor(missed) })
    }
}

/// The horizontal level, the larger of both hypotheses.
pub type Levels = crate::bound::Levels<Detail>;

/// Levels of both hypotheses and the parts they are made of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Detail {
    /// Nothing is faulty.
    pub fault_free: Metres,
    /// The worst reference receiver is faulty.
    pub receiver_faulty: Metres,
    /// Deviation behind the first.
    pub deviation: Metres,
    /// Effect of the nominal biases in both.
    pub bias: Metres,
}

/// What the levels are worked out with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Multipliers.
    pub factors: Factors,
    /// Deviation of a covariance.
    pub form: Form,
    /// Bound of the bias.
    pub ordering: Ordering,
    /// Largest nominal bias of a range.
    pub bias: Metres,
}

/// Levels of a solution.
///
/// ```text
/// HPL_H0 = K_ffmd d(P') + b        HPL_H1 = max_j |B_j| + K_md d(P'_H1) + b        b = gain * bias
/// ```
///
/// `aided` is the covariance P' with an inertial system; without one it is the solution's own. With one there is no sigma of a range left
/// to enlarge: P'_H1 is P' times the ratio of the solution's two variances (inferred). `receiver_shift` is the largest horizontal effect
/// of one receiver's B-values, see [`receiver_shift`].
pub fn levels(snapshot: &Snapshot, aided: Option<&Covariance<Enu>>, receiver_shift: Metres, settings: &Settings) -> Levels {
    let form = settings.form;
    let own = form.deviation(snapshot.covariance());
    let deviation = aided.map_or(own, |p| form.deviation(p));
    let faulty = form.deviation(snapshot.receiver_faulty()).m() / own.m() * deviation.m();
    let bias = snapshot.bias_gain(settings.ordering) * settings.bias.m();
    let fault_free = settings.factors.fault_free * deviation.m() + bias;
    let receiver_faulty = receiver_shift.m() + settings.factors.missed * faulty + bias;
    let detail =
        Detail { fault_free: Metres::new(fault_free), receiver_faulty: Metres::new(receiver_faulty), deviation, bias: Metres::new(bias) };
    Levels::horizontal(Metres::new(fault_free.max(receiver_faulty)), detail)
}

/// GBAS of one snapshot: no inertial system, no B-values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gbas {
    settings: Settings,
}

impl Algorithm for Gbas {
    const PROTECTION: Protection = super::PROTECTION;
    const RANGES: Ranges = Ranges::Service;
    const COLUMNS: &'static [&'static str] = &["hpl_h0_m", "hpl_h1_m", "sigma_m", "bias_hor_m"];
    type Settings = Settings;
    type Detail = Detail;

    /// Category I with four reference receivers, no bias.
    fn usual() -> Settings {
        // RTCA DO-245A, M = 4, as printed; `factors_meet_the_published_ones` works them out.
        let factors = Factors { fault_free: 5.847, missed: 2.878 };
        Settings { factors, form: Form::Major, ordering: Ordering::Exact, bias: Metres::new(0.0) }
    }

    fn new(settings: &Settings) -> Self {
        Self { settings: *settings }
    }

    fn levels(&mut self, sights: &[Sight]) -> Result<Levels, NoLevels> {
        Ok(levels(&Snapshot::new(sights)?, None, Metres::new(0.0), &self.settings))
    }

    fn number(detail: &Detail, column: usize) -> f64 {
        let numbers = [detail.fault_free, detail.receiver_faulty, detail.deviation, detail.bias].map(Metres::m);
        numbers.get(column).copied().unwrap_or(f64::NAN)
    }
}

/// Horizontal effect of one reference receiver's B-values: |sum of s_i B_i|.
pub fn receiver_shift<'a>(responses: impl Iterator<Item = (&'a Vector3<f64>, Metres)>) -> Metres {
    let shift = responses.fold(Vector3::zeros(), |sum: Vector3<f64>, (s, b)| sum + s * b.m());
    Metres::new(hypot(shift.x, shift.y))
}

/// The accuracy (95 %) that a containment leaves to navigation.
///
/// ```text
/// sigma_TSE = TSC / K(risk)        NSE95 = 1.96 sqrt(sigma_TSE^2 - sigma_FTE^2 - sigma_PDE^2)
/// ```
///
/// # Errors
/// [`OutOfDomain`] where flight technical and path definition error alone leave the containment too often: no such budget can be met.
pub fn accuracy_limit(containment: Metres, budget: &ErrorBudget) -> Result<Metres, OutOfDomain> {
    let sigma = containment.m() / two_sided_factor(budget.containment_risk.q());
    let [fte, pde] = [budget.sigma_fte.m(), budget.sigma_pde.m()];
    let left = sigma * sigma - fte * fte - pde * pde;
    if !(containment.m() > 0.0 && left > 0.0 && left.is_finite()) {
        let domain = "containments that the flight technical and path definition errors leave room in";
        return Err(OutOfDomain { argument: "containment_m", value: containment.m(), unit: "m", domain });
    }
    Ok(Metres::new(two_sided_factor(Risk::ACCURACY.q()) * sqrt(left)))
}

/// Accuracy, 95 %: 1.96 deviations of the worst direction and the bias (the statistic is inferred).
pub fn accuracy(major: Metres, bias: Metres) -> Metres {
    Metres::new(two_sided_factor(Risk::ACCURACY.q()) * major.m() + bias.m())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spec::surface::ERROR_BUDGET;

    const RULE: FactorRule = FactorRule { share: 0.25, axes: 1, receivers: 4, receiver_fault: 1e-5 };

    /// The K table: the rapid exit taxiway (printed as 6.54 and 4.06) and the published category I values, to the printed digits.
    #[test]
    fn factors_meet_the_published_ones() {
        let surface = Factors::new(Risk::SURFACE_INTEGRITY, &RULE).unwrap();
        assert!((surface.fault_free - 6.5376).abs() < 1e-4 && (surface.missed - 4.0556).abs() < 1e-4, "{surface:?}");
        for (receivers, fault_free, missed) in [(2, 5.762, 2.935), (3, 5.81, 2.898), (4, 5.847, 2.878)] {
            let factors = Factors::new(Risk::APPROACH_INTEGRITY, &FactorRule { axes: 2, receivers, ..RULE }).unwrap();
            assert!((factors.fault_free - fault_free).abs() < 1e-3 && (factors.missed - missed).abs() < 1e-3, "{receivers}: {factors:?}");
        }
    }

    #[test]
    fn a_budget_that_cannot_be_met_is_refused() {
        for (rule, argument) in [
            (FactorRule { share: 0.0, ..RULE }, "share"),
            (FactorRule { share: f64::NAN, ..RULE }, "share"),
            (FactorRule { axes: 0, ..RULE }, "axes"),
            (FactorRule { receivers: 1, ..RULE }, "receivers"),
            (FactorRule { receiver_fault: 0.0, ..RULE }, "receiver_fault"),
            (FactorRule { receiver_fault: 1e-12, ..RULE }, "receiver_fault"),
            (FactorRule { receiver_fault: f64::NAN, ..RULE }, "receiver_fault"),
        ] {
            assert_eq!(Factors::new(Risk::SURFACE_INTEGRITY, &rule).unwrap_err().argument, argument);
        }
    }

    /// The rebuilt table 1 prints two decimals of each sub-phase's accuracy; 4.8916 there is the factor of 1e-6.
    #[test]
    fn accuracy_limits_meet_the_table() {
        for (containment, limit) in [(4.5, 1.77), (3.5, 1.36), (2.5, 0.94)] {
            let computed = accuracy_limit(Metres::new(containment), &ERROR_BUDGET).unwrap().m();
            assert!((computed - limit).abs() < 5e-3, "{containment}: {computed}");
        }
        assert!(accuracy_limit(Metres::new(0.5), &ERROR_BUDGET).is_err());
        assert!(accuracy_limit(Metres::new(f64::NAN), &ERROR_BUDGET).is_err());
    }

    #[test]
    fn accuracy_is_two_sided() {
        assert!((accuracy(Metres::new(1.0), Metres::new(0.5)).m() - 2.459_963_984_540_054).abs() < 1e-15);
    }

    /// |sum of s B| of both horizontal components; upwards counts for nothing.
    #[test]
    fn a_receivers_shift_is_the_length_of_the_sum_of_its_effects() {
        let rows = [(Vector3::new(0.5, -0.25, 9.0), 4.0), (Vector3::new(1.0, 0.5, -7.0), 1.0), (Vector3::new(0.0, 2.0, 1.0), -2.0)];
        let shift = receiver_shift(rows.iter().map(|(s, b)| (s, Metres::new(*b)))).m();
        // East 2 + 1, north -1 + 0.5 - 4.
        assert!((shift - f64::hypot(3.0, -4.5)).abs() < 1e-15, "{shift}");
    }
}
