//! What an epoch's position is declared as: its covariance, and whether and why it is doubted. The one place that decides.
//!
//! ```text
//! ok       = the residuals agree with the weights, no memory of contradiction, either three ranges to spare with nothing excluded
//!            or one to spare and trace P <= 2 trace V, no two constellations give two positions, and the declared 95 % circle is within
//!            0.1 NM
//! declared = V;   with other readings P, widened to reach each that is not negligible, and to hold its uncertainty where the position is ok;
//!            with the memory P + f V; with the way d to another constellation's position, or to that without what led the codes off, + d d'
//! ```
//!
//! V is the covariance of the position itself, P that over all readings of its ranges ([`Mixture`]), f the variance factor of
//! [`Surroundings`]. Provenance: ours.

use super::Surroundings;
use super::mixture::{Mixture, OBSTRUCTED};
use super::plausible::Movement;
use super::point::{CONFIRMED, Fix};
use super::rivals::{Rival, Rivalry};
use super::wls::horizontal_axes;
use crate::frame::Covariance;
use crate::quantity::{GpsTime, Reason, Risk, Unavailable};
use crate::special::float::exp;
use crate::special::radius::RadiusLaw;
use nalgebra::Vector3;

/// What is known of the surroundings fades with this \[s\].
const MEMORY_S: f64 = 60.0;
/// Other readings may widen the covariance to this many times its trace in an epoch without doubt.
const WIDER: f64 = 2.0;
/// Widest 95 % circle of a position without doubt \[m\]: 0.1 NM, the smallest accuracy that an RNP procedure names, and the estimated
/// position uncertainty of NACp 7 (standard). A wider circle is true and of little use: readings of the ranges that nothing contradicts
/// reach so far.
pub const WIDEST_CIRCLE_M: f64 = 185.2;
/// Ratio of the weights of obstructed and open surroundings that a range without a fault gives: (1 - 0.3) / (1 - 0.001).
const FAULTLESS: f64 = 0.7 / 0.999;

/// Why a position is not simply believed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Doubt {
    /// Its residuals contradict the weights.
    ResidualsContradict,
    /// Those of the last minute do.
    RecentResidualsContradict,
    /// As many ranges as unknowns.
    NoRedundancy,
    /// The ranges to spare belong to constellations that check nothing but their own clock.
    ClockUnchecked,
    /// An exclusion, and another reading of the ranges that fits as well.
    ExclusionUnconfirmed,
    /// Nothing excluded, and another reading of the ranges that fits as well.
    ReadingUnconfirmed,
    /// Two constellations give two positions.
    ConstellationsContradict,
    /// A circle too wide to be of use.
    WideCircle,
    /// The codes moved together as their phases did not.
    CodesLedOff,
    /// Single frequencies, and no message describes the ionosphere.
    IonosphereUndescribed,
    /// A height that no receiver has.
    ImplausibleHeight,
    /// A geometry that hardly determines the position.
    ImplausibleDilution,
    /// Farther from the last position than a receiver moves.
    ImplausibleJump,
}

impl Doubt {
    /// All of them.
    pub const ALL: [Self; 13] = [
        Self::ResidualsContradict,
        Self::RecentResidualsContradict,
        Self::NoRedundancy,
        Self::ClockUnchecked,
        Self::ExclusionUnconfirmed,
        Self::ReadingUnconfirmed,
        Self::ConstellationsContradict,
        Self::WideCircle,
        Self::CodesLedOff,
        Self::IonosphereUndescribed,
        Self::ImplausibleHeight,
        Self::ImplausibleDilution,
        Self::ImplausibleJump,
    ];

    /// Its entry in the list of reasons.
    pub const fn reason(self) -> Reason {
        match self {
            Self::ResidualsContradict => Reason::ResidualsContradict,
            Self::RecentResidualsContradict => Reason::RecentResidualsContradict,
            Self::NoRedundancy => Reason::NoRedundancy,
            Self::ClockUnchecked => Reason::ClockUnchecked,
            Self::ExclusionUnconfirmed => Reason::ExclusionUnconfirmed,
            Self::ReadingUnconfirmed => Reason::ReadingUnconfirmed,
            Self::ConstellationsContradict => Reason::ConstellationsContradict,
            Self::WideCircle => Reason::WideCircle,
            Self::CodesLedOff => Reason::CodesLedOff,
            Self::IonosphereUndescribed => Reason::IonosphereUndescribed,
            Self::ImplausibleHeight => Reason::ImplausibleHeight,
            Self::ImplausibleDilution => Reason::ImplausibleDilution,
            Self::ImplausibleJump => Reason::ImplausibleJump,
        }
    }

    /// Whether there is no position at all.
    pub const fn refuses(self) -> bool {
        matches!(self, Self::ImplausibleHeight | Self::ImplausibleDilution | Self::ImplausibleJump)
    }

    /// Whether the ranges contradict each other or there is no position.
    const fn contradicts(self) -> bool {
        self.refuses() || matches!(self, Self::ResidualsContradict | Self::RecentResidualsContradict | Self::ConstellationsContradict)
    }

    /// The refusal of a solved position, where this is one.
    pub fn refusal(self, fix: &Fix) -> Option<Unavailable> {
        let invalid = |field, value, unit, domain| Some(Unavailable::Invalid { field, value, unit, domain });
        match self {
            Self::ImplausibleHeight => invalid("est_h_m", fix.position.height.m(), "m", "[-1000, 100000]"),
            Self::ImplausibleDilution => invalid("pdop", fix.dilution.position, "1", "(0, 30]"),
            Self::ImplausibleJump => invalid("speed_mps", f64::INFINITY, "m/s", "[0, 600]"),
            _ => None,
        }
    }

    /// The doubt behind a refusal of the solution, where it is one of these.
    pub fn of(why: &Unavailable) -> Option<Self> {
        match why {
            Unavailable::Invalid { field: "est_h_m", .. } => Some(Self::ImplausibleHeight),
            Unavailable::Invalid { field: "pdop", .. } => Some(Self::ImplausibleDilution),
            Unavailable::Invalid { field: "speed_mps", .. } => Some(Self::ImplausibleJump),
            _ => None,
        }
    }
}

/// What is declared of one receiver, epoch after epoch in time. No heap.
#[derive(Debug, Clone)]
pub struct Declarations {
    surroundings: Surroundings,
    movement: Movement,
    rivalry: Rivalry,
    /// Posterior probability that the surroundings are obstructed, and when.
    obstructed: f64,
    last: Option<GpsTime>,
}

impl Default for Declarations {
    fn default() -> Self {
        Self {
            surroundings: Surroundings::default(),
            movement: Movement::default(),
            rivalry: Rivalry::default(),
            obstructed: OBSTRUCTED,
            last: None,
        }
    }
}

impl Declarations {
    /// Take the next position in time, with the other readings of its ranges where it cannot stand alone, and the way to where a constellation
    /// that was left out puts the receiver. The position's covariance becomes the declared one; what it is doubted for is returned.
    pub fn declare(&mut self, time: GpsTime, fix: &mut Fix, mixture: Option<&Mixture>, rival: Option<Rival>) -> Option<Doubt> {
        let reaching = self.rivalry.judge(time, fix, rival);
        let factor = self.surroundings.judge(time, fix);
        let own = *fix.covariance.matrix();
        if let Some(factor) = factor.filter(|f| *f > fix.inflation) {
            fix.covariance = Covariance::claim_symmetric(own * (factor / fix.inflation));
            fix.inflation = factor;
        }
        let obstructed = self.obstructed(time, fix, mixture);
        let mut confirmed = fix.stands_alone();
        if let Some(mixture) = mixture {
            let declared = mixture.covariance(obstructed, &own);
            confirmed = declared.moments.trace() <= WIDER * own.trace();
            let memory = if factor.is_some() { *fix.covariance.matrix() } else { nalgebra::Matrix3::zeros() };
            let readings = if doubt(fix, factor.is_some(), confirmed).is_none() { declared.holding } else { declared.reaching };
            fix.covariance = Covariance::claim_symmetric(readings + memory);
        }
        let velocity = fix.velocity.map(|(v, _)| v);
        if !self.movement.possible(time, &fix.position, velocity, fix.covariance.matrix()) {
            return Some(Doubt::ImplausibleJump);
        }
        let doubt = doubt(fix, factor.is_some(), confirmed);
        if let Some(reaching) = reaching {
            fix.covariance = Covariance::claim_symmetric(fix.covariance.matrix() + reaching);
            return Some(Doubt::ConstellationsContradict);
        }
        doubt.or_else(|| too_wide(fix).then_some(Doubt::WideCircle))
    }

    fn obstructed(&mut self, time: GpsTime, fix: &Fix, mixture: Option<&Mixture>) -> f64 {
        let passed = self.last.map_or(f64::INFINITY, |last| time.seconds_since(last));
        self.last = Some(time);
        // A clock that was set back begins anew.
        let fading = if passed >= 0.0 { exp(-passed / MEMORY_S) } else { 0.0 };
        let prior = OBSTRUCTED + (self.obstructed - OBSTRUCTED) * fading;
        let faultless = || (0..fix.n_used).fold(1.0, |product, _| product * FAULTLESS);
        let evidence = mixture.map_or_else(faultless, Mixture::evidence);
        // The open state keeps a share, so that no evidence is for ever.
        let odds = (prior / (1.0 - prior) * evidence).min(1e12);
        self.obstructed = odds / (1.0 + odds);
        self.obstructed
    }
}

impl Fix {
    /// What it is doubted for where the codes lead it off by `way` \[m\]: its covariance reaches the place without. Ranges that contradict each
    /// other say nothing together, and their doubt stays.
    pub fn led_off(&mut self, way: &Vector3<f64>, doubt: Option<Doubt>) -> Option<Doubt> {
        if doubt.is_some_and(Doubt::contradicts) {
            return doubt;
        }
        self.covariance = Covariance::claim_symmetric(self.covariance.matrix() + way * way.transpose());
        Some(Doubt::CodesLedOff)
    }

    /// The residual test passed with nothing excluded, and three ranges to spare say that it could have failed.
    fn stands_alone(&self) -> bool {
        self.consistent && self.n_excluded == 0 && self.spare >= CONFIRMED
    }
}

fn doubt(fix: &Fix, contradicted: bool, confirmed: bool) -> Option<Doubt> {
    if fix.redundancy > 0 && !fix.consistent {
        Some(Doubt::ResidualsContradict)
    } else if contradicted {
        Some(Doubt::RecentResidualsContradict)
    } else if fix.redundancy == 0 {
        Some(Doubt::NoRedundancy)
    } else if fix.spare == 0 {
        Some(Doubt::ClockUnchecked)
    } else if confirmed {
        None
    } else if fix.n_excluded > 0 {
        Some(Doubt::ExclusionUnconfirmed)
    } else {
        Some(Doubt::ReadingUnconfirmed)
    }
}

/// Whether the declared circle is too wide to be of use: the risk beyond its widest radius is above that of accuracy. One that cannot be
/// computed is.
fn too_wide(fix: &Fix) -> bool {
    let (larger, smaller) = horizontal_axes(&fix.covariance);
    let (larger, smaller) = (larger.m(), smaller.m().min(larger.m()));
    let variances = [larger * larger, smaller * smaller, 0.0];
    if !variances.iter().all(|v| v.is_finite()) {
        return true;
    }
    !(RadiusLaw::new(variances, [0.0; 3]).at(WIDEST_CIRCLE_M).outside <= Risk::ACCURACY.q())
}

#[cfg(test)]
#[path = "declared_tests.rs"]
mod tests;
