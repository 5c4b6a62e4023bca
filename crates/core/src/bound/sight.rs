//! What every algorithm of protection levels takes and gives: satellites in, levels out.

use super::faults::NoModes;
use crate::quantity::{Metres, OutOfDomain, Reason, Unavailable};
use crate::signal::Constellation;
use crate::solution::wls::WeightedSight;
use nalgebra::Vector3;

/// A satellite as an algorithm of protection levels sees it: where it is, what is promised of its range. An algorithm reads what it needs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sight {
    /// Unit vector from the receiver to the satellite, east-north-up.
    pub unit: Vector3<f64>,
    /// Whose clock.
    pub constellation: Constellation,
    /// Variance of the range for integrity; its inverse is the weight \[m²\].
    pub integrity_m2: f64,
    /// Variance of the range for accuracy and continuity \[m²\].
    pub accuracy_m2: f64,
    /// Variance of the range when one reference receiver on the ground is faulty \[m²\].
    pub receiver_faulty_m2: f64,
    /// Nominal bias for integrity.
    pub bias: Metres,
    /// Nominal bias for continuity.
    pub bias_continuity: Metres,
    /// Probability that it is in fault.
    pub p_sat: f64,
}

impl Sight {
    /// A range with one variance for all uses, no bias, and no prior of a fault.
    pub const fn plain(unit: Vector3<f64>, constellation: Constellation, variance_m2: f64) -> Self {
        Self {
            unit,
            constellation,
            integrity_m2: variance_m2,
            accuracy_m2: variance_m2,
            receiver_faulty_m2: variance_m2,
            bias: Metres::new(0.0),
            bias_continuity: Metres::new(0.0),
            p_sat: 0.0,
        }
    }

    /// A range corrected by a ground station, checked.
    ///
    /// # Errors
    /// [`OutOfDomain`] unless both sigmas are positive and finite, the one with a faulty reference receiver no smaller.
    pub fn corrected(
        unit: Vector3<f64>,
        constellation: Constellation,
        sigma: Metres,
        receiver_faulty: Metres,
    ) -> Result<Self, OutOfDomain> {
        if !(sigma.m() > 0.0 && sigma.m().is_finite()) {
            return Err(OutOfDomain { argument: "sigma_m", value: sigma.m(), unit: "m", domain: "(0, inf)" });
        }
        let faulty = receiver_faulty.m();
        if !(faulty >= sigma.m() && faulty.is_finite()) {
            return Err(OutOfDomain { argument: "sigma_h1_m", value: faulty, unit: "m", domain: "[sigma_m, inf)" });
        }
        Ok(Self { receiver_faulty_m2: faulty * faulty, ..Self::plain(unit, constellation, sigma.m() * sigma.m()) })
    }

    /// As least squares takes it, weighted for integrity.
    #[inline(always)]
    pub fn weighted(&self) -> WeightedSight {
        WeightedSight { unit: self.unit, weight: 1.0 / self.integrity_m2, constellation: self.constellation }
    }

    /// As least squares takes it, weighted for accuracy.
    #[inline(always)]
    pub fn weighted_for_accuracy(&self) -> WeightedSight {
        WeightedSight { unit: self.unit, weight: 1.0 / self.accuracy_m2, constellation: self.constellation }
    }
}

impl From<Sight> for WeightedSight {
    #[inline(always)]
    fn from(sight: Sight) -> Self {
        sight.weighted()
    }
}

/// Protection levels of one epoch, and what a family says beside them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Levels<D = ()> {
    /// Horizontal; infinite where a fault cannot be monitored.
    pub hpl: Metres,
    /// Vertical, likewise; none where the algorithm, or the use that is requested, has no vertical level.
    pub vpl: Option<Metres>,
    /// What the family says beside.
    pub detail: D,
}

impl<D> Levels<D> {
    /// Both levels.
    #[inline(always)]
    pub const fn of(hpl: Metres, vpl: Metres, detail: D) -> Self {
        Self { hpl, vpl: Some(vpl), detail }
    }

    /// The horizontal one alone.
    #[inline(always)]
    pub const fn horizontal(hpl: Metres, detail: D) -> Self {
        Self { hpl, vpl: None, detail }
    }

    /// Whether every level that there is bounds: none is infinite.
    #[inline(always)]
    pub fn finite(&self) -> bool {
        self.hpl.m().is_finite() && self.vpl.is_none_or(|vpl| vpl.m().is_finite())
    }

    /// The vertical level as tables hold it \[m\]: NaN where there is none.
    #[inline(always)]
    pub fn vpl_m(&self) -> f64 {
        self.vpl.map_or(f64::NAN, Metres::m)
    }
}

/// Why an epoch has no levels.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum NoLevels {
    /// The fault modes cannot be made.
    #[error(transparent)]
    Modes(#[from] NoModes),
    /// The geometry does not serve.
    #[error(transparent)]
    Geometry(#[from] Unavailable),
}

impl NoLevels {
    /// Its entry in the list of reasons.
    pub const fn reason(&self) -> Reason {
        match self {
            Self::Modes(why) => why.reason(),
            Self::Geometry(why) => why.reason_of_solution(),
        }
    }
}
