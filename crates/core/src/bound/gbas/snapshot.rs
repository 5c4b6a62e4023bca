//! The weighted solution of one instant (equation 2), with what the levels ask of it.

use super::MOST_SATELLITES;
use super::bias::Ordering;
use crate::bound::Sight;
use crate::frame::{Covariance, Enu};
use crate::quantity::{Metres, Unavailable};
use crate::solution::wls::{horizontal_axes, responses_of_weighted};
use crate::special::float::sqrt;
use nalgebra::{Matrix3, Vector3};

/// One number of metres for a horizontal covariance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// Root of the larger eigenvalue.
    Major,
    /// Root of the trace: the literal sum of equation 5.
    Norm,
}

impl Form {
    /// Of a covariance.
    pub fn deviation(self, covariance: &Covariance<Enu>) -> Metres {
        match self {
            Self::Major => horizontal_axes(covariance).0,
            Self::Norm => Metres::new(sqrt(covariance.matrix()[(0, 0)] + covariance.matrix()[(1, 1)])),
        }
    }
}

/// A solution: S, its covariance, and the covariance when one reference receiver is faulty (same weights, larger errors).
#[derive(Debug, Clone)]
pub struct Snapshot {
    count: usize,
    response: [Vector3<f64>; MOST_SATELLITES],
    covariance: Covariance<Enu>,
    receiver_faulty: Covariance<Enu>,
}

impl Snapshot {
    /// From ranges.
    ///
    /// # Errors
    /// [`Unavailable::TooFewSatellites`], [`Unavailable::Singular`], [`Unavailable::Invalid`] for more than [`MOST_SATELLITES`].
    pub fn new(ranges: &[Sight]) -> Result<Self, Unavailable> {
        if ranges.len() > MOST_SATELLITES {
            let value = ranges.len() as f64;
            return Err(Unavailable::Invalid { field: "n_sv", value, unit: "1", domain: "[0, 48]" });
        }
        let (covariance, responses) = responses_of_weighted(ranges.iter().map(Sight::weighted))?;
        let mut response = [Vector3::zeros(); MOST_SATELLITES];
        let mut faulty = Matrix3::zeros();
        for ((slot, s), range) in response.iter_mut().zip(responses).zip(ranges) {
            *slot = s;
            faulty += range.receiver_faulty_m2 * s * s.transpose();
        }
        Ok(Self { count: ranges.len(), response, covariance, receiver_faulty: Covariance::claim_symmetric(faulty) })
    }

    /// Metres of position for a metre in each range.
    pub fn responses(&self) -> &[Vector3<f64>] {
        &self.response[..self.count]
    }
    /// Covariance P.
    pub const fn covariance(&self) -> &Covariance<Enu> {
        &self.covariance
    }
    /// Covariance when one reference receiver is faulty.
    pub const fn receiver_faulty(&self) -> &Covariance<Enu> {
        &self.receiver_faulty
    }
    /// Metres of horizontal position for a metre of bias in every range.
    pub fn bias_gain(&self, ordering: Ordering) -> f64 {
        ordering.gain(self.responses().iter().map(|s| [s.x, s.y]))
    }
    /// The largest horizontal effect of one range: a metre of fault gives this many of position.
    pub fn worst_projection(&self) -> f64 {
        sqrt(self.responses().iter().map(|s| s.x * s.x + s.y * s.y).fold(0.0, f64::max))
    }
}
