//! What a service allows, and what it states about its satellites: configurations, each with where its numbers come from.

use crate::quantity::{Metres, OutOfDomain, Provenance, Risk};
use crate::signal::Constellation;

/// Risks a service may take, and how they are split.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Service {
    /// Name, as users choose it.
    pub id: &'static str,
    /// Where the numbers come from.
    pub source: &'static str,
    /// How we hold them.
    pub provenance: Provenance,
    /// Integrity risk of the vertical and of the horizontal level; half of the latter for each axis.
    pub integrity_v: Risk,
    /// See above.
    pub integrity_h: Risk,
    /// Risk of a false alarm in the vertical and in the horizontal.
    pub false_alarm_v: Risk,
    /// See above.
    pub false_alarm_h: Risk,
    /// Fault modes together below this risk need not be monitored; what they have counts against the integrity risk.
    pub unmonitored: Risk,
    /// Modes at least this likely enter the effective monitor threshold.
    pub effective_monitor: Risk,
    /// A set of satellites of one constellation less likely than this share of the fault of the whole is counted with the whole \[1\].
    pub consolidation: f64,
    /// Largest effective monitor threshold, where the service has one.
    pub effective_monitor_limit: Option<Metres>,
}

const REFERENCE: &str = "Working Group C, ARAIM airborne algorithm description v3.0, as run by MAAST for ARAIM 2";
const HORIZONTAL: &str = "horizontal settings of MAAST for ARAIM 2's cross-check; risks of RNP 0.1 to 0.3 inferred from 1e-7 an hour";

impl Service {
    /// Vertical guidance to 200 ft: 9.8e-8 of 1e-7 to the vertical.
    pub const LPV_200: Self = Self {
        id: "lpv-200",
        source: REFERENCE,
        provenance: Provenance::Standard,
        integrity_v: Risk::constant(9.8e-8),
        integrity_h: Risk::constant(2e-9),
        false_alarm_v: Risk::constant(3.9e-6),
        false_alarm_h: Risk::constant(9e-8),
        unmonitored: Risk::constant(8e-8),
        effective_monitor: Risk::constant(1e-5),
        consolidation: 0.01,
        effective_monitor_limit: Some(Metres::new(15.0)),
    };

    /// Horizontal guidance, RNP 0.1 to 0.3: 9.9e-8 of 1e-7 to the horizontal.
    pub const HORIZONTAL: Self = Self {
        id: "horizontal",
        source: HORIZONTAL,
        provenance: Provenance::Inferred,
        integrity_v: Risk::constant(1e-9),
        integrity_h: Risk::constant(9.9e-8),
        false_alarm_v: Risk::constant(1e-9),
        false_alarm_h: Risk::constant(5e-7),
        unmonitored: Risk::constant(9e-8),
        effective_monitor: Risk::constant(1e-5),
        consolidation: 0.01,
        effective_monitor_limit: None,
    };

    /// The shipped ones.
    pub const ALL: [Self; 2] = [Self::LPV_200, Self::HORIZONTAL];

    /// Integrity risk of both directions together.
    pub fn integrity(&self) -> f64 {
        self.integrity_v.q() + self.integrity_h.q()
    }

    /// A service whose budgets can be met.
    ///
    /// # Errors
    /// [`OutOfDomain`] when what need not be monitored is the whole integrity risk or more, or the share of consolidation is outside [0, 1).
    pub fn checked(self) -> Result<Self, OutOfDomain> {
        if !(self.unmonitored.q() < self.integrity()) {
            let domain = "(0, integrity_v + integrity_h): nothing would be left for the levels";
            return Err(OutOfDomain { argument: "unmonitored", value: self.unmonitored.q(), unit: "1", domain });
        }
        if !(0.0..1.0).contains(&self.consolidation) {
            return Err(OutOfDomain { argument: "consolidation", value: self.consolidation, unit: "1", domain: "[0, 1)" });
        }
        Ok(self)
    }
}

/// What an integrity support message states about one constellation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Support {
    /// Standard deviation of orbit and clock for integrity (URA, SISA).
    pub sigma_ura: Metres,
    /// The same for accuracy and continuity (URE, SISE).
    pub sigma_ure: Metres,
    /// Nominal bias for integrity.
    pub bias: Metres,
    /// Nominal bias for continuity.
    pub bias_continuity: Metres,
    /// Probability that one satellite is faulty at an instant.
    pub p_sat: f64,
    /// Probability that more than one is, from one cause.
    pub p_const: f64,
}

impl Support {
    /// # Errors
    /// [`OutOfDomain`] for a sigma that is not positive, a bias that is negative, or a prior outside (0, 1).
    pub fn checked(self) -> Result<Self, OutOfDomain> {
        let lengths = [("sigma_ura_m", self.sigma_ura, false), ("sigma_ure_m", self.sigma_ure, false)];
        let biases = [("bias_m", self.bias, true), ("bias_continuity_m", self.bias_continuity, true)];
        for (argument, length, zero) in lengths.into_iter().chain(biases) {
            let (value, domain) = (length.m(), if zero { "[0, inf)" } else { "(0, inf)" });
            if !((value > 0.0 || (zero && value == 0.0)) && value.is_finite()) {
                return Err(OutOfDomain { argument, value, unit: "m", domain });
            }
        }
        for (argument, value) in [("p_sat", self.p_sat), ("p_const", self.p_const)] {
            if !(value > 0.0 && value < 1.0) {
                return Err(OutOfDomain { argument, value, unit: "1", domain: "(0, 1)" });
            }
        }
        Ok(self)
    }
}

/// Support of every constellation, in the order of [`Constellation::index`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SupportMessage {
    /// Name for run records.
    pub id: &'static str,
    /// Where the numbers come from.
    pub source: &'static str,
    /// How we hold them.
    pub provenance: Provenance,
    /// By constellation.
    pub support: [Support; Constellation::ALL.len()],
}

impl SupportMessage {
    /// No message is broadcast yet: the values of the open Stanford simulator's study, GPS 1e-8 and others 1e-4 for the constellation.
    pub const STUDY: Self = {
        let other = Support {
            sigma_ura: Metres::new(1.0),
            sigma_ure: Metres::new(0.66),
            bias: Metres::new(0.75),
            bias_continuity: Metres::new(0.0),
            p_sat: 1e-5,
            p_const: 1e-4,
        };
        let gps = Support { p_const: 1e-8, ..other };
        Self {
            id: "study",
            source: "values of MAAST for ARAIM 2's shipped study; no integrity support message is broadcast",
            provenance: Provenance::Inferred,
            support: [gps, other, other, other, other],
        }
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shipped_configurations_can_be_met() {
        for service in Service::ALL {
            assert!(service.checked().is_ok(), "{}", service.id);
            // The whole is the 1e-7 of an approach or an hour.
            assert!((service.integrity() - 1e-7).abs() < 1e-22);
        }
        assert!(SupportMessage::STUDY.support.iter().all(|s| s.checked().is_ok()));
    }

    #[test]
    fn budgets_that_cannot_be_met_and_priors_that_are_none_are_refused() {
        let spent = Service { unmonitored: Service::LPV_200.integrity_v, integrity_h: Risk::constant(1e-15), ..Service::LPV_200 };
        assert_eq!(Service { unmonitored: Risk::ACCURACY, ..spent }.checked().unwrap_err().argument, "unmonitored");
        assert_eq!(Service { consolidation: f64::NAN, ..spent }.checked().unwrap_err().argument, "consolidation");
        let good = SupportMessage::STUDY.support[0];
        for (bad, argument) in [
            (Support { p_sat: 0.0, ..good }, "p_sat"),
            (Support { p_const: 1.0, ..good }, "p_const"),
            (Support { sigma_ura: Metres::new(f64::NAN), ..good }, "sigma_ura_m"),
            (Support { bias: Metres::new(-0.1), ..good }, "bias_m"),
        ] {
            assert_eq!(bad.checked().unwrap_err().argument, argument);
        }
    }
}
