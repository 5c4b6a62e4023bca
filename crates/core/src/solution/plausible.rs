//! Whether a solved position can be one at all: height, dilution, and what a receiver can have moved since its last position.
//!
//! Ranges that agree with each other by chance, and four that nothing checks, converge anywhere. Provenance of every limit: see there.

use super::wls::Dilution;
use crate::frame::{EcefPosition, Geodetic, ecef_from_geodetic, enu_from_ecef};
use crate::quantity::{GpsTime, Unavailable};
use crate::special::float::sqrt;
use nalgebra::{Matrix3, Vector3};

/// Heights of a position above the ellipsoid \[m\]: from below the lowest land and mines that a signal reaches (Dead Sea shore -430 m) to
/// the edge of space (Kármán line, 100 km by the FAI), above which the models of the atmosphere do not hold. Ours.
pub const HEIGHT_M: (f64, f64) = (-1000.0, 100_000.0);
/// Largest position dilution: the default of RTKLIB's threshold of GDOP, 30 (manual 2.4.2, inferred for PDOP). Beyond it a metre in a range
/// is tens of metres in the position, and a plane no longer describes the ranges.
pub const DILUTION: f64 = 30.0;
/// Fastest receiver \[m/s\]: receivers that work above 600 m/s are export-controlled (MTCR annex 11.A.3; inferred).
pub const SPEED_MPS: f64 = 600.0;
/// Largest acceleration between two epochs \[m/s²\], of aerobatic aircraft. Ours.
const ACCELERATION_MPS2: f64 = 100.0;
/// Positions may differ by this many of their standard deviations besides.
const DEVIATIONS: f64 = 5.0;

/// # Errors
/// [`Unavailable::Invalid`] for a height that no receiver of these models has.
pub(super) fn height(position: &Geodetic) -> Result<(), Unavailable> {
    let value = position.height.m();
    if value >= HEIGHT_M.0 && value <= HEIGHT_M.1 {
        return Ok(());
    }
    Err(Unavailable::Invalid { field: "est_h_m", value, unit: "m", domain: "[-1000, 100000]" })
}

/// # Errors
/// [`Unavailable::Invalid`] for a geometry that hardly determines the position.
pub(super) fn dilution(dilution: &Dilution) -> Result<(), Unavailable> {
    if dilution.position <= DILUTION {
        return Ok(());
    }
    Err(Unavailable::Invalid { field: "pdop", value: dilution.position, unit: "1", domain: "(0, 30]" })
}

/// A position as the next is compared with.
#[derive(Debug, Clone, Copy)]
struct Place {
    time: GpsTime,
    at: EcefPosition,
    /// Earth-fixed \[m/s\], where Doppler gave one.
    velocity_mps: Option<Vector3<f64>>,
    sigma_m: f64,
}

/// A receiver's recent positions. No heap.
#[derive(Debug, Clone, Default)]
pub struct Movement {
    last: Option<Place>,
    /// A position that jumped: a second one there is believed, since the one before may have been the wrong one.
    jumped: Option<Place>,
}

impl Movement {
    /// Take the next position; whether the receiver can have come there.
    pub fn possible(
        &mut self,
        time: GpsTime,
        position: &Geodetic,
        velocity_enu_mps: Option<Vector3<f64>>,
        covariance: &Matrix3<f64>,
    ) -> bool {
        let velocity_mps = velocity_enu_mps.map(|v| enu_from_ecef(&position.point).transpose() * v);
        let here = Place { time, at: ecef_from_geodetic(position), velocity_mps, sigma_m: sqrt(covariance.trace()) };
        let reached = |from: &Option<Place>| from.as_ref().is_none_or(|from| here.reachable(from));
        if reached(&self.last) || (self.jumped.is_some() && reached(&self.jumped)) {
            (self.last, self.jumped) = (Some(here), None);
            return true;
        }
        self.jumped = Some(here);
        false
    }
}

impl Place {
    /// Within the fastest speed, or where Doppler of both says.
    fn reachable(&self, from: &Self) -> bool {
        let passed = self.time.seconds_since(from.time);
        // A clock that was set back begins anew.
        if !(passed >= 0.0) {
            return true;
        }
        let moved = self.at.vector() - from.at.vector();
        let slack = DEVIATIONS * (self.sigma_m + from.sigma_m);
        let by_doppler = self
            .velocity_mps
            .zip(from.velocity_mps)
            .is_some_and(|(a, b)| (moved - (a + b) * (0.5 * passed)).norm() <= slack + ACCELERATION_MPS2 * passed * passed);
        moved.norm() <= SPEED_MPS * passed + slack || by_doppler
    }
}

#[cfg(test)]
#[path = "plausible_tests.rs"]
mod tests;
