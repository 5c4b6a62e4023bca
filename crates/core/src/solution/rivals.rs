//! Two constellations that fit themselves and give two positions: nothing of one receiver's ranges says which of them is right.
//!
//! Exclusion goes by numbers: the constellation with fewer satellites is left out, whether it is the one that is wrong or not. Nor are two that
//! agree against a third evidence: who leads off one of them leads off both.
//!
//! ```text
//! rivals:  d' (V + W)^-1 d > chi-square quantile of 3 unknowns at 1e-3,   d between the positions, V and W their covariances
//! ```
//!
//! Provenance: ours. A constellation that is wrong as a whole is a fault mode of ARAIM (prior 1e-4, milestone 3 report), so that none may be
//! ruled out by numbers alone.

use super::point::{CONFIRMED, Fix};
use crate::frame::{ecef_from_geodetic, enu_from_ecef};
use crate::quantity::GpsTime;
use crate::special::gamma::chi_square_tail;
use nalgebra::{Matrix3, Vector3};

/// Risk that two right positions are taken for rivals \[1\].
const RISK: f64 = 1e-3;
/// Satellites with which a constellation supports another's position: one for its clock and two that check it.
const SUPPORTING: u32 = 3;
/// A contradiction that no later epoch resolves counts for this long \[s\].
const MEMORY_S: f64 = 3600.0;

impl Fix {
    /// Whether two constellations that agree carry it.
    pub fn is_supported(&self) -> bool {
        let supporting = self.used.iter().filter(|numbers| numbers.count_ones() >= SUPPORTING).count();
        self.consistent && self.spare >= CONFIRMED && supporting >= 2
    }

    /// Where other ranges of the same epoch put the receiver by themselves, from this position, east, north, up \[m\]; none where they do not fit
    /// themselves, or say the same.
    pub fn rival(&self, other: &Self) -> Option<Vector3<f64>> {
        let fits_itself = other.consistent || other.redundancy == 0;
        if !fits_itself {
            return None;
        }
        let turn = enu_from_ecef(&self.position.point);
        let way = turn * (ecef_from_geodetic(&other.position).vector() - ecef_from_geodetic(&self.position).vector());
        // The axes of both differ by the angle between the places, 1e-3 in six kilometres: far less than a covariance is known to.
        let both = self.covariance.matrix() + other.covariance.matrix();
        let squared = way.dot(&(both.try_inverse()? * way));
        (chi_square_tail(3.0, squared) < RISK).then_some(way)
    }
}

/// A contradiction between constellations that no epoch has resolved yet. No heap.
#[derive(Debug, Clone, Copy, Default)]
pub struct Rivalry {
    open: Option<(GpsTime, Vector3<f64>)>,
}

impl Rivalry {
    /// Take the next position in time with its rival. Where one is or is not resolved: the covariance that reaches it.
    pub fn judge(&mut self, time: GpsTime, fix: &Fix, rival: Option<Vector3<f64>>) -> Option<Matrix3<f64>> {
        let lasts = |since: &GpsTime| (0.0..=MEMORY_S).contains(&time.seconds_since(*since));
        self.open = match rival {
            Some(way) => Some((time, way)),
            // Constellations that agree again have settled it.
            None => self.open.filter(|(since, _)| lasts(since) && !fix.is_supported()),
        };
        self.open.map(|(_, way)| way * way.transpose())
    }
}

#[cfg(test)]
#[path = "rivals_tests.rs"]
mod tests;
