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
use crate::signal::Constellation;
use crate::special::gamma::chi_square_tail;
use nalgebra::{Matrix3, Vector3};

/// Risk that two right positions are taken for rivals \[1\].
const RISK: f64 = 1e-3;
/// Satellites with which a constellation supports another's position: one for its clock and two that check it.
const SUPPORTING: u32 = 3;
/// Ranges beyond the unknowns from which on what is left after exclusions agrees by more than chance.
const TESTED: usize = 2;
/// A contradiction that no later epoch resolves counts for this long \[s\].
const MEMORY_S: f64 = 3600.0;

impl Fix {
    /// Whether a constellation and another one carry it, and enough ranges check them.
    fn is_carried_by(&self, constellation: Constellation) -> bool {
        let carries = |c: usize| self.used[c].count_ones() >= SUPPORTING;
        let own = constellation.index();
        let another = (0..self.used.len()).any(|c| c != own && carries(c));
        self.consistent && self.spare >= CONFIRMED && carries(own) && another
    }

    /// Where other ranges of the same epoch put the receiver by themselves, from this position, east, north, up \[m\]; none where they do not fit
    /// themselves, or say the same.
    pub fn rival(&self, other: &Self) -> Option<Vector3<f64>> {
        // Ranges of which some were excluded until the others agreed by chance do not fit themselves.
        let tested = other.n_excluded == 0 || other.redundancy >= TESTED;
        let fits_itself = tested && (other.consistent || other.redundancy == 0);
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

/// The constellation that contradicts a position, and the way to where it puts the receiver, east, north, up \[m\].
pub type Rival = (Constellation, Vector3<f64>);

/// A contradiction between constellations that no epoch has resolved yet. No heap.
#[derive(Debug, Clone, Copy, Default)]
pub struct Rivalry {
    open: Option<(GpsTime, Rival)>,
}

impl Rivalry {
    /// Take the next position in time with its rival. Where one is or is not resolved: the covariance that reaches it.
    pub fn judge(&mut self, time: GpsTime, fix: &Fix, rival: Option<Rival>) -> Option<Matrix3<f64>> {
        let lasts = |since: &GpsTime| (0.0..=MEMORY_S).contains(&time.seconds_since(*since));
        self.open = match rival {
            Some(rival) => Some((time, rival)),
            // Only the constellation itself settles it, where it agrees with another again.
            None => self.open.filter(|(since, (constellation, _))| lasts(since) && !fix.is_carried_by(*constellation)),
        };
        self.open.map(|(_, (_, way))| way * way.transpose())
    }
}

#[cfg(test)]
#[path = "rivals_tests.rs"]
mod tests;
