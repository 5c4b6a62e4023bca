//! A position and a velocity from the ranges and range rates of one instant alone.
//!
//! It shares the ranges with a filter and nothing else: no inertial sample, no past, no tuning, not even the place at which the filter
//! linearises. It starts at its own last position, or at the centre of the Earth, and goes on until it stands still.
//!
//! ```text
//! A = (G' W G)^-1 G' W,   W = diag(1 / (white^2 + slow^2))          rows: minus the unit vector, one clock a constellation
//! S = A (B + V) A'        = (G' W G)^-1, the error model of the filter
//! ```
//!
//! Source: weighted least squares; provenance: standard.

use super::wls::{Normal, Row, WeightedSight};
use crate::frame::{Covariance, EcefPosition, Enu, Geodetic, ecef_from_geodetic, enu_from_ecef, geodetic_from_ecef};
use crate::quantity::{GpsTime, Unavailable};
use crate::signal::{Constellation, SatelliteId, SatelliteRange};
use nalgebra::{Matrix3, Vector3};

/// Most ranges of one instant.
pub const RANGES_MOST: usize = 64;
/// A step below this is the last \[m\]: ranges are straight over it to 1e-13 m.
const STEP_M: f64 = 1e-3;
/// Rounds at most; from the centre of the Earth it takes six.
const ROUNDS: usize = 15;
/// Heights above the ellipsoid of a vehicle in the air or on the ground \[m\]. Provenance: ours.
const HEIGHTS_M: (f64, f64) = (-1_000.0, 100_000.0);

/// Ranges of one instant with what they weigh; the rates beside them.
#[derive(Debug, Clone)]
pub struct Ranges {
    n: usize,
    range: [Option<SatelliteRange>; RANGES_MOST],
}

impl Ranges {
    /// Those that have a range; more than [`RANGES_MOST`] are left out from the end.
    pub fn of<'a>(ranges: impl Iterator<Item = &'a SatelliteRange>) -> Self {
        let mut all = Self { n: 0, range: [None; RANGES_MOST] };
        for (place, m) in all.range.iter_mut().zip(ranges.filter(|m| m.range.is_some())) {
            *place = Some(*m);
            all.n += 1;
        }
        all
    }

    /// Without one of them.
    #[must_use]
    pub fn without(&self, satellite: SatelliteId) -> Self {
        Self::of(self.iter().filter(|m| m.satellite != satellite))
    }

    /// In the order in which they came.
    pub fn iter(&self) -> impl Iterator<Item = &SatelliteRange> + Clone + '_ {
        self.range[..self.n].iter().flatten()
    }

    /// How many.
    pub const fn len(&self) -> usize {
        self.n
    }

    /// Whether there are none.
    pub const fn is_empty(&self) -> bool {
        self.n == 0
    }
}

/// A satellite's part in a snapshot.
#[derive(Debug, Clone, Copy)]
pub struct Member {
    /// Which satellite.
    pub satellite: SatelliteId,
    /// Direction and weight, as integrity monitoring takes them.
    pub sight: WeightedSight,
    /// Measured less computed range at the position, clocks in it \[m\].
    pub residual_m: f64,
    /// How far the position moves for a metre in the range, east, north, up.
    pub response: Vector3<f64>,
}

/// A position of one instant.
#[derive(Debug, Clone)]
pub struct Snapshot {
    /// When.
    pub time: GpsTime,
    /// Of the antenna.
    pub position: Geodetic,
    /// The same, Earth-centred.
    pub ecef: EcefPosition,
    /// Covariance by the error model of the filter.
    pub covariance: Covariance<Enu>,
    n: usize,
    member: [Option<Member>; RANGES_MOST],
}

impl Snapshot {
    /// A position that somebody else has solved: no satellite of it is known.
    pub fn solved(time: GpsTime, position: Geodetic, covariance: Covariance<Enu>) -> Self {
        Self { time, position, ecef: ecef_from_geodetic(&position), covariance, n: 0, member: [None; RANGES_MOST] }
    }

    /// Satellites in the position.
    pub fn members(&self) -> impl Iterator<Item = &Member> + '_ {
        self.member[..self.n].iter().flatten()
    }
}

/// A velocity of one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SnapshotVelocity {
    /// East, north, up \[m/s\].
    pub enu_mps: Vector3<f64>,
    /// Its covariance \[m²/s²\].
    pub covariance: Matrix3<f64>,
}

/// Solves one instant after the other.
#[derive(Debug, Clone, Copy, Default)]
pub struct Solver {
    last: Option<Vector3<f64>>,
}

impl Solver {
    /// The position of an instant.
    ///
    /// # Errors
    /// [`Unavailable`]: too few satellites, a singular geometry, a position that is none (it does not stand still, or lies nowhere a vehicle
    /// is).
    pub fn position(&mut self, time: GpsTime, ranges: &Ranges) -> Result<Snapshot, Unavailable> {
        let from_last = self.last.and_then(|at| converge(at, ranges).ok());
        let at = match from_last {
            Some(at) => at,
            None => converge(Vector3::zeros(), ranges)?,
        };
        let ecef = EcefPosition::from_vector(at);
        let position = geodetic_from_ecef(&ecef)?;
        let h = position.height.m();
        if !(h >= HEIGHTS_M.0 && h <= HEIGHTS_M.1) {
            return Err(Unavailable::Invalid { field: "h_m", value: h, unit: "m", domain: "[-1000, 100000], the height of a vehicle" });
        }
        self.last = Some(at);
        let enu = enu_from_ecef(&position.point);
        let rows = rows(at, ranges).map(|row| Row { unit: enu * row.unit, ..row });
        let normal = Normal::new(rows.clone())?;
        let covariance = normal.covariance()?;
        let inverse = *covariance.matrix();
        let mut member = [None; RANGES_MOST];
        for ((place, row), m) in member.iter_mut().zip(rows).zip(ranges.iter()) {
            let sight = WeightedSight { unit: row.unit, weight: row.weight, constellation: m.satellite.constellation };
            let response = normal.response(&inverse, &row);
            *place = Some(Member { satellite: m.satellite, sight, residual_m: row.residual, response });
        }
        Ok(Snapshot { time, position, ecef, covariance, n: ranges.len(), member })
    }
}

/// Rows at a place, axes of the Earth.
fn rows(at: Vector3<f64>, ranges: &Ranges) -> impl Iterator<Item = Row> + Clone + '_ {
    ranges.iter().map(move |m| {
        let line = m.position.vector() - at;
        let distance = line.norm();
        let (white, slow) = (m.sigma_white.m(), m.sigma_correlated.m());
        // Only those with a range are kept.
        let measured = m.range.map_or(f64::NAN, |r| r.m());
        let clock = m.satellite.constellation.index();
        Row { unit: line / distance, weight: 1.0 / (white * white + slow * slow), clock, residual: measured - distance }
    })
}

fn converge(mut at: Vector3<f64>, ranges: &Ranges) -> Result<Vector3<f64>, Unavailable> {
    for _ in 0..ROUNDS {
        let normal = Normal::new(rows(at, ranges))?;
        let singular = Unavailable::Singular { condition: f64::INFINITY, limit: super::wls::CONDITION_LIMIT };
        let step = normal.step().ok_or(singular)?;
        at += step;
        if step.norm() < STEP_M {
            return Ok(at);
        }
    }
    Err(Unavailable::Invalid { field: "step_m", value: f64::NAN, unit: "m", domain: "ranges whose position stands still" })
}

/// A rate at a position: direction and weight, and measured rate less what the satellite's own motion makes of it \[m/s\].
pub fn rate_sights(
    snapshot: &Snapshot,
    ranges: &Ranges,
) -> ([WeightedSight; RANGES_MOST], [f64; RANGES_MOST], [usize; RANGES_MOST], usize) {
    let none = WeightedSight { unit: Vector3::zeros(), weight: 0.0, constellation: Constellation::Gps };
    let (mut sights, mut residuals, mut index, mut n) = ([none; RANGES_MOST], [0.0; RANGES_MOST], [0; RANGES_MOST], 0);
    let enu = enu_from_ecef(&snapshot.position.point);
    for (k, m) in ranges.iter().enumerate() {
        let Some((rate, sigma)) = m.rate_mps else { continue };
        let line = (m.position.vector() - snapshot.ecef.vector()).normalize();
        let usable = sigma > 0.0 && sigma.is_finite() && rate.is_finite();
        if !usable {
            continue;
        }
        // The drift is the receiver's: one for all constellations.
        sights[n] = WeightedSight { unit: enu * line, weight: 1.0 / (sigma * sigma), constellation: Constellation::Gps };
        residuals[n] = rate - line.dot(&m.velocity_mps);
        index[n] = k;
        n += 1;
    }
    (sights, residuals, index, n)
}

/// The velocity from rates, each with its direction and weight.
pub fn velocity(sights: &[WeightedSight], residuals_mps: &[f64]) -> Option<SnapshotVelocity> {
    let rows = sights.iter().zip(residuals_mps).map(|(s, r)| Row { unit: s.unit, weight: s.weight, clock: 0, residual: *r });
    let normal = Normal::new(rows).ok()?;
    Some(SnapshotVelocity { enu_mps: normal.step()?, covariance: *normal.covariance().ok()?.matrix() })
}
