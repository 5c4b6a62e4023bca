//! The filter against a snapshot of the same ranges, before it has used them.
//!
//! ```text
//! D = Cov(e_s - e_f) = S + P + A P_br + P_rb A'       A: how the snapshot moves with each range, P_br: slow range errors with the position
//! D_v = S_v + P_vv                                    range rates are white: nothing in common before they are used
//! ```
//!
//! For a filter that is right its error is uncorrelated with everything measured so far, and so is what it believes of a slow error; what it
//! does not know of that error is in both. Before the update the form is exact and positive, also where the filter has used nothing for a
//! while; `S - P` after an update is wrong as soon as one range was left out. Provenance: derived here.

use super::covariance::{Row, WIDTH};
use super::filter::{Filter, Solution};
use super::fusion::Fusion;
use super::innovation::Kind;
use super::measure::Antenna;
use super::mode::Mode;
use super::settings::StartSigma;
use super::slots::Further;
use super::state::NavState;
use super::together::Together;
use crate::frame::{Covariance, Displacement, EcefPosition, Enu, enu_from_ecef};
use crate::quantity::{GpsTime, Metres, OutOfDomain, Radians};
use crate::signal::{Aiding, SatelliteRange, TimedAiding};
use crate::solution::snapshot::{RANGES_MOST, Ranges, Snapshot, SnapshotVelocity};
use crate::special::float::sqrt;
use nalgebra::{Matrix3, Vector3};

/// The antenna by the filter less the antenna by the snapshot, and what is expected of that.
#[derive(Debug, Clone, Copy)]
pub struct Difference {
    /// Position.
    pub position: Displacement<Enu>,
    /// Its covariance D.
    pub covariance: Covariance<Enu>,
    /// Velocity of the antenna by the filter, east, north, up \[m/s\],
    pub velocity_mps: Vector3<f64>,
    /// and its covariance alone \[m²/s²\].
    pub velocity_m2ps2: Matrix3<f64>,
}

/// Variance that frees the clock common to all ranges \[m²\]: a jump of any size is none of the position's.
const CLOCK_FREE_M2: f64 = 1e10;

/// North, east, down of an axis east, north, up.
const AXES_NED: [[f64; 3]; 3] = [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]];

impl Fusion {
    /// As [`Filter::against`], of the filter with satellites.
    pub fn against(&mut self, snapshot: &Snapshot) -> Option<Difference> {
        self.main.against(snapshot)
    }

    /// A velocity by range rates, whose changes are compared with those of the unit: late ones come later.
    pub fn heard_velocity(&mut self, time: GpsTime, v: &SnapshotVelocity) {
        let variance = v.covariance[(0, 0)].max(v.covariance[(1, 1)]);
        self.main.delay.velocity_heard(time, nalgebra::Vector2::new(v.enu_mps.y, v.enu_mps.x), variance);
    }

    /// As [`Filter::together`], of the filter with satellites.
    pub fn together(&mut self, time: GpsTime, ranges: &Ranges) -> Option<Together> {
        self.main.together(time, ranges)
    }

    /// The filter begins anew at a snapshot, its attitude by weight and course as after a hole; the one without satellites goes on.
    ///
    /// The position starts with five deviations of the snapshot's, not with one: the slow errors of the ranges that follow are those of the
    /// snapshot, and a filter that took its start for independent of them would count them twice. The velocity starts with two deviations.
    /// The unit is set where the antenna is, a lever arm wide: its direction is not known before the attitude is.
    ///
    /// # Errors
    /// As [`Filter::new`].
    pub fn restart_at(&mut self, snapshot: &Snapshot, velocity: &SnapshotVelocity) -> Result<(), OutOfDomain> {
        let state = self.main.state();
        let [e, n, u] = [0, 1, 2].map(|k| velocity.enu_mps[k]);
        let at = NavState::new(snapshot.time, &snapshot.position, Vector3::new(n, e, -u), &state.attitude())?;
        let variance = |k: usize| snapshot.covariance.matrix()[(k, k)];
        let arm = self.settings.lever_arm_m.norm();
        let position = [1, 0, 2].map(|k| Metres::new(5.0 * sqrt(variance(k)) + arm));
        let most = (0..3).map(|k| velocity.covariance[(k, k)]).fold(0.0, f64::max);
        let any = Radians::new(1.0);
        let sigma = StartSigma { position, velocity_mps: 2.0 * sqrt(most), attitude: [any; 3] };
        self.renew(at, &sigma)?;
        self.main.begin_after_gap();
        Ok(())
    }

    /// The filter without satellites begins anew where the main one is, knowing as much; not where the main one has no state of that time, or
    /// an attitude that is not settled.
    ///
    /// # Errors
    /// As [`Filter::new`].
    pub fn renew_beside(&mut self, now: GpsTime) -> Result<(), OutOfDomain> {
        if self.beside.is_none() || self.main.is_aligning() {
            return Ok(());
        }
        let Some(s) = self.main.solution(now) else { return Ok(()) };
        let (p, v, a) = (s.covariance.matrix(), &s.velocity_m2ps2, &s.attitude_rad2);
        let most = (0..3).map(|k| v[(k, k)]).fold(0.0, f64::max);
        let sigma = StartSigma {
            position: [p[(1, 1)], p[(0, 0)], p[(2, 2)]].map(|variance| Metres::new(sqrt(variance))),
            velocity_mps: sqrt(most),
            attitude: [0, 1, 2].map(|k| Radians::new(sqrt(a[(k, k)]))),
        };
        let settings = self.main.settings;
        self.beside = Some(Filter::new(s.state, &sigma, settings)?);
        self.nested = false;
        Ok(())
    }

    /// What keeps the position of the main filter, the aligning included.
    pub fn mode_now(&mut self) -> Mode {
        self.main.watch_alignment();
        if self.main.is_aligning() { Mode::Aligning } else { self.mode() }
    }

    /// The filter without satellites, whatever the one with them says; `None` where there is none or it has no state of that time.
    pub fn without_satellites(&mut self, at: GpsTime) -> Option<Solution> {
        self.beside.as_mut()?.solution(at)
    }

    /// Where the antenna of a solution is.
    pub fn antenna_of(&self, solution: &Solution) -> Option<EcefPosition> {
        let antenna = Antenna::of(&solution.state, &self.settings.lever_arm_m, &Vector3::zeros(), 0.0).ok()?;
        Some(EcefPosition::from_vector(antenna.ecef))
    }

    /// A measurement that somebody else has judged and refuses: counted as gated.
    pub fn reject(&mut self, timed: &TimedAiding) {
        self.main.reject(Kind::of(&timed.aiding));
    }
}

impl Filter {
    fn reject(&mut self, kind: Kind) {
        self.innovations[kind.index()].n_gated += 1;
    }

    /// The filter less the snapshot, before the ranges of that instant are used; `None` where the filter has no state of that time.
    pub fn against(&mut self, snapshot: &Snapshot) -> Option<Difference> {
        let (antenna, _) = self.ready(snapshot.time).ok()?;
        let enu = enu_from_ecef(&snapshot.position.point);
        let position = enu * (antenna.ecef - snapshot.ecef.vector());
        let velocity = enu * (antenna.ned_from_ecef.transpose() * antenna.v);
        // A row along an axis is minus that axis times the error of the antenna.
        let along = AXES_NED.map(|axis| antenna.along_position(&Vector3::from(axis)));
        let moving = AXES_NED.map(|axis| antenna.along_velocity(&Vector3::from(axis)));
        let carried = along.map(|row| self.joint.times(&row));
        let moved = moving.map(|row| self.joint.times(&row));
        let mut d = *snapshot.covariance.matrix() + products(&along, &carried);
        for member in snapshot.members() {
            let Some(place) = self.slots.find(Further::Satellite(member.satellite)) else { continue };
            let shared = Vector3::from(carried.each_ref().map(|u| u[place]));
            d += member.response * shared.transpose() + shared * member.response.transpose();
        }
        let finite = d.iter().chain(position.iter()).chain(velocity.iter()).all(|x| x.is_finite());
        finite.then(|| Difference {
            position: Displacement::from_vector(position),
            covariance: Covariance::claim_symmetric(d),
            velocity_mps: velocity,
            velocity_m2ps2: products(&moving, &moved),
        })
    }

    /// The innovations of all ranges of an instant together, before any is judged alone; `None` where there is nothing to judge by.
    pub fn together(&mut self, time: GpsTime, ranges: &Ranges) -> Option<Together> {
        let (antenna, _) = self.ready(time).ok()?;
        let clock = self.slots.find(Further::Clock)?;
        let n = ranges.len();
        let mut sigma = [[0.0; RANGES_MOST]; RANGES_MOST];
        let (mut gamma, mut rows) = ([0.0; RANGES_MOST], [Row::empty(); RANGES_MOST]);
        for (k, m) in ranges.iter().enumerate() {
            let mut scalar = antenna.range(m, m.range?);
            scalar.innovation -= self.slots.value(clock);
            scalar.row = scalar.row.with(clock, 1.0);
            for what in [Further::InterSystem(m.satellite.constellation), Further::Satellite(m.satellite)] {
                let Some(place) = self.slots.find(what) else { continue };
                scalar.innovation -= self.slots.value(place);
                scalar.row = scalar.row.with(place, 1.0);
            }
            (gamma[k], rows[k]) = (scalar.innovation, scalar.row);
            let carried = self.joint.times(&scalar.row);
            for (j, other) in rows[..=k].iter().enumerate() {
                sigma[k][j] = other.of(&carried) + CLOCK_FREE_M2 + self.unknown(m, ranges, j);
            }
            sigma[k][k] += scalar.variance;
        }
        Together::of(sigma, gamma, n)
    }

    /// Variance that a range shares with range `j` of the instant through states that the filter does not have yet.
    fn unknown(&self, m: &SatelliteRange, ranges: &Ranges, j: usize) -> f64 {
        let Some(other) = ranges.iter().nth(j) else { return 0.0 };
        let mut variance = 0.0;
        let (of, with) = (m.satellite.constellation, other.satellite.constellation);
        let system = self.first_constellation != Some(of) && self.slots.find(Further::InterSystem(of)).is_none();
        if of == with && system {
            variance += self.settings.clock.inter_system_m * self.settings.clock.inter_system_m;
        }
        if m.satellite == other.satellite && self.slots.find(Further::Satellite(m.satellite)).is_none() {
            let slow = m.sigma_first.m().max(m.sigma_correlated.m());
            variance += slow * slow;
        }
        variance
    }
}

/// H P H' of three rows.
fn products(rows: &[Row; 3], carried: &[[f64; WIDTH]; 3]) -> Matrix3<f64> {
    let p = Matrix3::from_fn(|i, j| rows[i].of(&carried[j]));
    (p + p.transpose()) * 0.5
}

/// Whether a measurement is made of numbers that mean something.
pub fn is_sane(aiding: &Aiding) -> bool {
    super::sane::check(aiding).is_ok()
}

/// Ranges that a filter may judge: those of an instant that are made of numbers that mean something.
pub fn judgeable(together: &[TimedAiding]) -> Ranges {
    Ranges::of(together.iter().filter(|t| super::sane::check(&t.aiding).is_ok()).filter_map(|t| match &t.aiding {
        Aiding::Satellite(m) => Some(m),
        _ => None,
    }))
}
