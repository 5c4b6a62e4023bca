//! RAIM, the simple case: one satellite may be wrong at a time, and no prior is known.

use super::modes::{self, NoModes};
use super::{Detail, Levels, Monitor, checked};
use crate::bound::{NoLevels, Protection, Sight};
use crate::quantity::{Metres, OutOfDomain, Provenance, Risk, Unavailable};
use crate::special::float::sqrt;
use crate::special::one_sided_factor;

/// What a receiver's own monitoring must meet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Requirement {
    /// Name, as users choose it.
    pub id: &'static str,
    /// Where the numbers come from.
    pub source: &'static str,
    /// How we hold them.
    pub provenance: Provenance,
    /// Risk of a false alarm of one test of all separations.
    pub false_alarm: Risk,
    /// Risk that a fault as large as the level is missed.
    pub missed_detection: Risk,
    /// Risk that the error exceeds the level without a fault.
    pub fault_free: Risk,
}

impl Requirement {
    /// En route to non-precision approach: false alarm 3.33e-7 an independent sample (1e-5 an hour of 30), missed detection 0.001.
    pub const RAIM: Self = Self {
        id: "raim",
        source: "RTCA DO-229 2.1.2.2.2 and DO-316: false alarm 3.33e-7, missed detection 1e-3 (inferred: the text was not read); fault-free 1e-7 (inferred)",
        provenance: Provenance::Inferred,
        false_alarm: Risk::constant(3.33e-7),
        missed_detection: Risk::constant(1e-3),
        fault_free: Risk::constant(1e-7),
    };
}

/// Document of the form; provenance *standard*.
pub const SOURCE: &str = "Brown and McBurney 1988, maximum solution separation, sigmas of the separations and of the subsets (standard)";

/// What the levels are.
pub const PROTECTION: Protection = Protection {
    id: "raim-separation",
    title: "RAIM by solution separation",
    function: "navbound.araim.protection_levels",
    source: SOURCE,
    provenance: Provenance::Standard,
    covers: "one satellite of any size of fault",
    assumes: "errors of ranges without a fault are normal, independent and no larger than their sigmas",
    integrity: true,
};

impl Monitor {
    /// Levels of detection by solution separation, one fault at a time.
    ///
    /// ```text
    /// HPL = max( K_ff d_0, max_i [ K_FA d_ss,i + K_MD d_i ] )      d = sqrt(sigma_e^2 + sigma_n^2), never below the largest horizontal sigma
    /// VPL likewise with sigma_u                                     K_FA = Q^-1(P_FA / (2 N)), K_MD = Q^-1(P_MD), K_ff = Q^-1(P_ff / 2)
    /// ```
    ///
    /// Infinite where a satellite cannot be done without: its fault cannot be detected.
    ///
    /// # Errors
    /// [`NoLevels`].
    #[inline(always)]
    pub fn single_levels(&mut self, sights: &[Sight], requirement: &Requirement) -> Result<Levels, NoLevels> {
        let modes = modes::single(sights)?;
        checked(sights)?;
        let (monitored, _) = self.every.separate(sights, &[], &modes)?;
        let faults = sights.len().max(1) as f64;
        let k_ff = one_sided_factor(0.5 * requirement.fault_free.q());
        let k_fa = one_sided_factor(0.5 * requirement.false_alarm.q() / faults);
        let k_md = one_sided_factor(requirement.missed_detection.q());
        let (mut east_north, mut axes, mut up, mut threshold_u) = (0.0_f64, [0.0_f64; 2], 0.0_f64, 0.0_f64);
        for (k, outcome) in self.every.outcome[..modes.len()].iter().enumerate() {
            let Some(sums) = outcome else {
                (east_north, axes, up) = (f64::INFINITY, [f64::INFINITY; 2], f64::INFINITY);
                break;
            };
            let level = |separation: f64, variance: f64| {
                if k == 0 { k_ff * sqrt(variance) } else { k_fa * sqrt(separation) + k_md * sqrt(variance) }
            };
            let (s, v) = (&sums.separation, &sums.variance);
            east_north = east_north.max(level(s[0] + s[1], v[0] + v[1]));
            axes = [0, 1].map(|a| axes[a].max(level(s[a], v[a])));
            up = up.max(level(s[2], v[2]));
            threshold_u = threshold_u.max(k_fa * sqrt(s[2]));
        }
        let detail = Detail {
            axes: axes.map(Metres::new),
            emt: Metres::new(threshold_u),
            sigma_accuracy: self.every.sigma_accuracy(),
            n_modes: modes.len(),
            n_monitored: monitored,
            p_unmonitored: 0.0,
        };
        Ok(Levels::of(Metres::new(east_north), Metres::new(up), detail))
    }

    /// The same where the faulty satellite must be found too: the largest level after any one exclusion.
    ///
    /// # Errors
    /// [`NoLevels`].
    pub fn single_levels_after_exclusion(&mut self, sights: &[Sight], requirement: &Requirement) -> Result<Levels, NoLevels> {
        let mut worst = self.single_levels(sights, requirement)?;
        let mut rest = super::exclusion::Rest::default();
        for i in 0..sights.len() {
            let (left, _) = rest.without(sights, &[], 1 << i);
            let after = match self.single_levels(left, requirement) {
                Ok(after) => Some(after),
                Err(NoLevels::Geometry(Unavailable::Invalid { field, value, unit, domain })) => {
                    return Err(NoLevels::Modes(NoModes::OutOfDomain(OutOfDomain { argument: field, value, unit, domain })));
                }
                Err(_) => None,
            };
            worst.widen(after.as_ref());
        }
        Ok(worst)
    }
}
