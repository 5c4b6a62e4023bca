//! What the sub-phases of surface movement ask, rebuilt.
//!
//! The table that states it did not reach us: almost every number here is inferred, so each carries its mark, and nothing prints one
//! without it. Source of what is known: Song, Milner and No 2024, NAVIGATION 71(4), navi.673.

use super::gbas::Mark;
use crate::quantity::{Metres, Provenance, Risk};

/// One sub-phase between runway and stand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SubPhase {
    /// Name, as users choose it.
    pub id: &'static str,
    /// In words.
    pub title: &'static str,
    /// Total system containment.
    pub containment: Metres,
    /// Horizontal alert limit.
    pub hal: Metres,
    /// Integrity risk of the sub-phase.
    pub integrity: Risk,
    /// Continuity risk of the sub-phase.
    pub continuity: Risk,
    /// Largest speed \[m/s\].
    pub speed_mps: f64,
    /// How long it lasts \[s\].
    pub exposure_s: f64,
    /// How its numbers are held.
    pub marks: &'static [Mark],
}

/// How the integrity risk of a sub-phase is shared out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Allocation {
    /// H0 and H1 together.
    pub no_fault_and_receiver: f64,
    /// H2 before coasting: all of it for a fault the ground monitors meet (H2a).
    pub ground: f64,
    /// H2a while coasting.
    pub coasting_ground: f64,
    /// H2c: a fault that begins while coasting.
    pub coasting_fault: f64,
    /// Share of [`Self::coasting_fault`] below which faults together need no monitoring.
    pub unmonitored: f64,
    /// Probability that one of the reference receivers is faulty in an exposure.
    pub receiver_fault: f64,
    /// Equal coordinates among which the share is split.
    pub axes: u8,
    /// How its numbers are held.
    pub marks: &'static [Mark],
}

/// What the navigation system may use of the containment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorBudget {
    /// Risk that the total system error leaves the containment.
    pub containment_risk: Risk,
    /// Standard deviation of the flight technical error.
    pub sigma_fte: Metres,
    /// Standard deviation of the path definition error.
    pub sigma_pde: Metres,
    /// How its numbers are held.
    pub marks: &'static [Mark],
}

/// Rates of satellite and constellation faults.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FaultRates {
    /// Name of the case.
    pub id: &'static str,
    /// GPS satellite \[1/h\].
    pub gps_per_hour: f64,
    /// Galileo satellite \[1/h\].
    pub galileo_per_hour: f64,
    /// All of Galileo at once \[1/h\]; used only with GPS beside it.
    pub galileo_wide_per_hour: f64,
    /// All of GPS at once \[1/h\]; used only with Galileo beside it.
    pub gps_wide_per_hour: f64,
    /// Time a fault may act before a monitor with memory shows it \[s\].
    pub decorrelation_s: f64,
    /// Satellites over all constellations.
    pub satellites: u8,
    /// How its numbers are held.
    pub marks: &'static [Mark],
}

const fn mark(name: &'static str, provenance: Provenance, why: &'static str) -> Mark {
    Mark { name, provenance, why }
}

const INTEGRITY: Mark =
    mark("integrity", Provenance::Inferred, "1.25e-9 from K_ffmd 6.54 and K_md 4.06, which agree; equal in all sub-phases by ours");
const CONTINUITY: Mark = mark("continuity", Provenance::Inferred, "1e4 times the integrity risk: equal split, 1e-4 of pilot credit");
const PACE: Mark = mark("speed", Provenance::Ours, "speed and exposure could not be established");
const HAL: Mark = mark("hal", Provenance::Inferred, "equal to the containment");
const STRONG: &[Mark] = &[
    mark("containment", Provenance::Inferred, "4.5 m, the code F clearance of Annex 14; it reproduces claims C01, C02, C08 and C11"),
    HAL,
    INTEGRITY,
    CONTINUITY,
    PACE,
];
const WEAK: &[Mark] = &[mark("containment", Provenance::Inferred, "weak: fitted to claims C09 and C10"), HAL, INTEGRITY, CONTINUITY, PACE];

/// 1.25e-9 and 1.25e-5 are inside (0, 1); the constants of [`Risk`] are the only ones that exist without a check.
const INTEGRITY_RISK: Risk = Risk::SURFACE_INTEGRITY;
const CONTINUITY_RISK: Risk = Risk::SURFACE_CONTINUITY;

const fn sub_phase(
    id: &'static str,
    title: &'static str,
    limit_m: f64,
    (speed_mps, exposure_s): (f64, f64),
    marks: &'static [Mark],
) -> SubPhase {
    let limit = Metres::new(limit_m);
    SubPhase {
        id,
        title,
        containment: limit,
        hal: limit,
        integrity: INTEGRITY_RISK,
        continuity: CONTINUITY_RISK,
        speed_mps,
        exposure_s,
        marks,
    }
}

/// From the runway to the stand.
pub const SUB_PHASES: &[SubPhase] = &[
    sub_phase("RET", "rapid exit taxiway", 4.5, (25.0, 15.0), STRONG),
    sub_phase("NTW", "normal taxiway", 4.5, (10.0, 120.0), STRONG),
    sub_phase("ATW", "apron taxiway", 3.5, (8.0, 60.0), WEAK),
    sub_phase("TL", "taxi lane", 3.5, (5.0, 30.0), WEAK),
    sub_phase("SLL", "stand lead-in line", 2.5, (3.0, 30.0), WEAK),
];

/// The allocation tree.
pub const ALLOCATION: Allocation = Allocation {
    no_fault_and_receiver: 0.25,
    ground: 0.375,
    coasting_ground: 0.1875,
    coasting_fault: 0.1875,
    unmonitored: 0.1,
    receiver_fault: 1e-5,
    axes: 1,
    marks: &[
        mark(
            "no_fault_and_receiver",
            Provenance::Printed,
            "12.5 % to H0 and 12.5 % to H1; one axis and five equal hypotheses are inferred",
        ),
        mark("ground", Provenance::Printed, "37.5 % to H2; the 37.5 % left for the inertial branch are inferred"),
        mark("coasting", Provenance::Inferred, "H2 split equally between faults before and while coasting"),
        mark("unmonitored", Provenance::Ours, "a tenth of the share of faults while coasting; could not be established"),
        mark("receiver_fault", Provenance::Standard, "1e-5, confirmed by K_md = 4.06"),
    ],
};

/// The error budget behind the accuracy requirement.
pub const ERROR_BUDGET: ErrorBudget = ErrorBudget {
    containment_risk: Risk::SURFACE_CONTAINMENT,
    sigma_fte: Metres::new(0.15),
    sigma_pde: Metres::new(0.10),
    marks: &[
        mark("containment_risk", Provenance::Printed, "1e-6"),
        mark("sigma_fte", Provenance::Ours, "0.15 m and 0.10 m could not be established"),
    ],
};

const RATE_MARKS: &[Mark] = &[
    mark("rates", Provenance::Printed, "1e-5 /h for GPS, 3e-5 /h (case A) or 1e-5 /h (case B) for Galileo"),
    mark(
        "wide",
        Provenance::Standard,
        "1e-4 for Galileo, 1e-8 for GPS, beside another constellation only; that Galileo's is larger is printed",
    ),
    mark(
        "wide_per_hour",
        Provenance::Inferred,
        "these priors hold for the mean fault duration of an hour, so faults begin at that rate; reproduces all 120 cells of the specification",
    ),
    mark("satellites", Provenance::Printed, "18 over both constellations; half and half is inferred"),
    mark("decorrelation", Provenance::Printed, "100 s"),
];

/// Case A and case B.
pub const FAULT_RATES: &[FaultRates] = &[fault_rates("A", 3e-5), fault_rates("B", 1e-5)];

const fn fault_rates(id: &'static str, galileo_per_hour: f64) -> FaultRates {
    FaultRates {
        id,
        gps_per_hour: 1e-5,
        galileo_per_hour,
        galileo_wide_per_hour: 1e-4,
        gps_wide_per_hour: 1e-8,
        decorrelation_s: 100.0,
        satellites: 18,
        marks: RATE_MARKS,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_tighten_towards_the_stand_and_every_number_is_marked() {
        for pair in SUB_PHASES.windows(2) {
            assert!(pair[1].containment <= pair[0].containment && pair[1].speed_mps < pair[0].speed_mps);
        }
        for phase in SUB_PHASES {
            for name in ["containment", "hal", "integrity", "continuity", "speed"] {
                assert!(phase.marks.iter().any(|m| m.name == name), "{} {name}", phase.id);
            }
        }
    }

    #[test]
    fn the_shares_leave_the_inertial_branch_the_rest() {
        let a = ALLOCATION;
        assert_eq!(a.coasting_ground + a.coasting_fault, a.ground);
        assert_eq!(a.no_fault_and_receiver + 2.0 * a.ground, 1.0);
    }
}
