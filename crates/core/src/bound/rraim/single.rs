//! One fault at a time while coasting: equation 16.

use super::coast::{Coast, Travel};
use crate::bound::gbas::MOST_SATELLITES;
use crate::bound::gbas::bias::Ordering;
use crate::bound::gbas::levels::{Factors, accuracy, receiver_shift};
use crate::bound::gbas::snapshot::{Form, Snapshot};
use crate::bound::{Protection, Provenance};
use crate::frame::{Covariance, Enu};
use crate::quantity::{Metres, OutOfDomain, Risk, Unavailable};
use crate::special::one_sided_factor;
use nalgebra::Vector3;

/// What the levels are.
pub const PROTECTION: Protection = Protection {
    id: "rraim-single",
    title: "RRAIM, one fault while coasting",
    function: "navbound.rraim.protection_levels",
    source: super::SOURCE,
    provenance: Provenance::ReDerived,
    covers: "one satellite fault that begins while coasting, on top of what GBAS covers at the fix",
    assumes: "errors of the carrier phase differenced in time are within the model; multipliers and priors that the paper does not give are inferred",
    integrity: true,
};

/// The fix that is carried on.
#[derive(Debug, Clone, Copy)]
pub struct Fix<'a> {
    /// Its solution: how biases became position.
    pub snapshot: &'a Snapshot,
    /// Its covariance P', the snapshot's own or an inertial system's.
    pub covariance: Covariance<Enu>,
    /// P' when one reference receiver is faulty.
    pub receiver_faulty: Covariance<Enu>,
}

impl<'a> Fix<'a> {
    /// Of the snapshot alone.
    pub fn of(snapshot: &'a Snapshot) -> Self {
        Self { snapshot, covariance: *snapshot.covariance(), receiver_faulty: *snapshot.receiver_faulty() }
    }

    /// With an inertial system: P' given; with a faulty receiver larger by the ratio of the snapshot's two variances (inferred).
    pub fn aided(snapshot: &'a Snapshot, covariance: Covariance<Enu>, form: Form) -> Self {
        let ratio = form.deviation(snapshot.receiver_faulty()).m() / form.deviation(snapshot.covariance()).m();
        let receiver_faulty = Covariance::claim_symmetric(covariance.matrix() * (ratio * ratio));
        Self { snapshot, covariance, receiver_faulty }
    }

    /// Metres of position for a metre of bias in every range, after a travel: M S.
    pub fn bias_gain(&self, travel: &Travel, ordering: Ordering) -> f64 {
        let m = &travel.carried;
        ordering.gain(self.snapshot.responses().iter().map(|s| {
            let moved: Vector3<f64> = m * s;
            [moved.x, moved.y]
        }))
    }
}

/// Multipliers and bounds of the single-fault level.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// k_FF and k_md: the rule of [`Factors`] (k_FF inferred).
    pub factors: Factors,
    /// Continuity risk: k_FA = Q^-1(CR / 2N) (inferred).
    pub continuity: Risk,
    /// Risk allotted to faults that begin while coasting: k_FC = Q^-1(PHMI / sum p) (inferred).
    pub allotted: Risk,
    /// Deviation of a covariance.
    pub form: Form,
    /// Bound of the bias.
    pub ordering: Ordering,
    /// Whether the threshold makes room for the biases' part in the separation; the paper's does not.
    pub biased_threshold: bool,
}

/// One satellite taken away.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Without {
    /// Deviation of the position.
    pub deviation: Metres,
    /// Deviation of its separation from the solution with all.
    pub separation: Metres,
    /// Metres for a metre of bias.
    pub gain: f64,
    /// Metres of separation for a metre of bias.
    pub separation_gain: f64,
}

/// Everything that does not depend on the size of the bias.
#[derive(Debug, Clone)]
pub struct SingleFault {
    travel: Travel,
    covariance: Covariance<Enu>,
    major: Metres,
    deviation: Metres,
    receiver_faulty: Metres,
    gain: f64,
    count: usize,
    without: [Without; MOST_SATELLITES],
}

/// The horizontal level, the largest of the three hypotheses.
pub type Levels = crate::bound::Levels<Detail>;

/// Levels of the three hypotheses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Detail {
    /// H0: nothing is faulty.
    pub fault_free: Metres,
    /// H1: a reference receiver was faulty at the fix.
    pub receiver_faulty: Metres,
    /// H2c: a satellite becomes faulty while coasting.
    pub satellite_faulty: Metres,
}

impl SingleFault {
    /// Of a fix carried on.
    ///
    /// # Errors
    /// [`Unavailable`] where the geometry does not determine the position, with any one satellite away: its fault could not be seen.
    pub fn new(fix: &Fix<'_>, coast: &Coast, form: Form, ordering: Ordering) -> Result<Self, Unavailable> {
        let all = coast.all()?;
        let covariance = all.covariance(&fix.covariance);
        let mut without = [Without::default(); MOST_SATELLITES];
        for (i, slot) in without.iter_mut().enumerate().take(coast.len()) {
            let less = coast.without(1 << i)?;
            let apart = Travel { carried: less.carried - all.carried, added: less.added };
            *slot = Without {
                deviation: form.deviation(&less.covariance(&fix.covariance)),
                separation: form.deviation(&less.separation(&all, &fix.covariance)),
                gain: fix.bias_gain(&less, ordering),
                separation_gain: fix.bias_gain(&apart, ordering),
            };
        }
        Ok(Self {
            travel: all,
            covariance,
            major: Form::Major.deviation(&covariance),
            deviation: form.deviation(&covariance),
            receiver_faulty: form.deviation(&all.covariance(&fix.receiver_faulty)),
            gain: fix.bias_gain(&all, ordering),
            count: coast.len(),
            without,
        })
    }

    /// How the error travels.
    pub const fn travel(&self) -> &Travel {
        &self.travel
    }
    /// Covariance now.
    pub const fn covariance(&self) -> &Covariance<Enu> {
        &self.covariance
    }
    /// Its largest horizontal deviation.
    pub const fn major(&self) -> Metres {
        self.major
    }
    /// Metres for a metre of bias.
    pub const fn gain(&self) -> f64 {
        self.gain
    }
    /// Each satellite away.
    pub fn without(&self) -> &[Without] {
        &self.without[..self.count]
    }
    /// Accuracy, 95 %.
    pub fn accuracy(&self, bias: Metres) -> Metres {
        accuracy(self.major, Metres::new(self.gain * bias.m()))
    }
    /// Horizontal effect of one reference receiver's B-values after the travel: |M S B|.
    pub fn receiver_shift(&self, fix: &Fix<'_>, b_values: impl Iterator<Item = Metres>) -> Metres {
        let moved = fix.snapshot.responses().iter().map(|s| self.travel.carried * s);
        let mut shifted = [Vector3::zeros(); MOST_SATELLITES];
        for (slot, s) in shifted.iter_mut().zip(moved) {
            *slot = s;
        }
        receiver_shift(shifted.iter().zip(b_values))
    }

    /// Levels for a size of the bias.
    ///
    /// ```text
    /// H0   k_FF d(P_t) + g b
    /// H1   |M S B| + k_md d(P_t,H1) + g b
    /// H2c  max_i [ k_FA d(P_ss,i) + k_FC d(P_t,i) + g_i b ]
    /// ```
    pub fn levels(&self, bias: Metres, receiver_shift: Metres, multipliers: &Multipliers, biased_threshold: bool) -> Levels {
        let b = bias.m();
        let fault_free = multipliers.factors.fault_free * self.deviation.m() + self.gain * b;
        let receiver_faulty = receiver_shift.m() + multipliers.factors.missed * self.receiver_faulty.m() + self.gain * b;
        let one = |w: &Without| {
            let threshold = multipliers.threshold(w, bias, biased_threshold);
            threshold.m() + multipliers.fault * w.deviation.m() + w.gain * b
        };
        let satellite_faulty = self.without().iter().map(one).fold(0.0, f64::max);
        let detail = Detail {
            fault_free: Metres::new(fault_free),
            receiver_faulty: Metres::new(receiver_faulty),
            satellite_faulty: Metres::new(satellite_faulty),
        };
        Levels::horizontal(Metres::new(fault_free.max(receiver_faulty).max(satellite_faulty)), detail)
    }
}

/// The four multipliers of equation 16.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Multipliers {
    /// k_FF, k_md.
    pub factors: Factors,
    /// k_FA.
    pub false_alarm: f64,
    /// k_FC.
    pub fault: f64,
}

impl Multipliers {
    /// Separation above which the satellite is held to be faulty: k_FA d(P_ss,i), with room for the biases' part if requested.
    pub fn threshold(&self, without: &Without, bias: Metres, biased: bool) -> Metres {
        let room = if biased { bias.m() } else { 0.0 };
        Metres::new(self.false_alarm * without.separation.m() + without.separation_gain * room)
    }

    /// For a number of satellites and the sum of their fault probabilities.
    ///
    /// ```text
    /// k_FA = Q^-1(CR / 2N)        k_FC = Q^-1(PHMI_H2c / sum p_i), 0 where faults are rarer than the risk
    /// ```
    ///
    /// # Errors
    /// [`OutOfDomain`] for a sum of probabilities that is negative or not finite, or no satellite.
    pub fn new(settings: &Settings, satellites: usize, faults: f64) -> Result<Self, OutOfDomain> {
        if satellites == 0 {
            return Err(OutOfDomain { argument: "n_sv", value: 0.0, unit: "1", domain: "[1, 48]" });
        }
        if !(faults >= 0.0 && faults.is_finite()) {
            return Err(OutOfDomain { argument: "p_sat", value: faults, unit: "1", domain: "[0, inf)" });
        }
        let share = settings.allotted.q() / faults;
        Ok(Self {
            factors: settings.factors,
            false_alarm: one_sided_factor(settings.continuity.q() / (2.0 * satellites as f64)),
            fault: if share < 0.5 { one_sided_factor(share) } else { 0.0 },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bound::Sight;
    use crate::geometry::Direction;
    use crate::quantity::Radians;
    use crate::signal::Constellation;
    use nalgebra::Matrix3;

    /// A covariance from elsewhere is larger with a faulty receiver as the fix is: by the ratio of its two deviations.
    #[test]
    fn an_aided_fix_keeps_the_ratio_of_its_deviations() {
        let range = |az: f64, el: f64, faulty: f64| {
            let unit = Direction::new(Radians::degrees(az), Radians::degrees(el)).unwrap().unit();
            Sight::corrected(unit, Constellation::Gps, Metres::new(1.0), Metres::new(faulty)).unwrap()
        };
        let ranges =
            [range(10.0, 70.0, 1.2), range(100.0, 30.0, 1.9), range(190.0, 20.0, 1.4), range(280.0, 50.0, 2.5), range(330.0, 12.0, 1.1)];
        let snapshot = Snapshot::new(&ranges).unwrap();
        let own = Covariance::<Enu>::claim_symmetric(Matrix3::new(4.0, 1.0, 0.0, 1.0, 2.0, 0.0, 0.0, 0.0, 9.0));
        for form in [Form::Major, Form::Norm] {
            let fix = Fix::aided(&snapshot, own, form);
            let wider = form.deviation(snapshot.receiver_faulty()).m() / form.deviation(snapshot.covariance()).m();
            let ratio = form.deviation(&fix.receiver_faulty).m() / form.deviation(&fix.covariance).m();
            assert!(wider > 1.1 && (ratio / wider - 1.0).abs() < 1e-12, "{ratio} {wider}");
            assert_eq!(fix.covariance, own);
        }
    }
}
