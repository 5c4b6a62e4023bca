//! The loose form: the ranges of an instant are solved to a position and a velocity, and these aid the filter.
//!
//! What stays in the ranges stays in the position, so that taking each position for new would make the covariance far too small. Its errors
//! are `b = L z` with three states z of variance 1 and `L L'` the covariance of the slow part. From one instant to the next z moves as the
//! satellites' own errors do, seen through both solutions:
//!
//! ```text
//! d = sum_i s_i r_i                        s_i: how far the position moves for a metre in range i (wls)
//! B = sum_i s_i s_i' c_i^2 = L L'          R = sum_i s_i s_i' w_i^2          c_i, w_i: slow and white deviation of range i
//! C = sum_i s_i s_i(before)' c^2 exp(-dt/tau_i)    over satellites in both, c the smaller deviation
//! z <- A z + noise of 1 - A A',   A = L^-1 C L(before)^-T
//! ```
//!
//! A satellite that rises or sets moves the position by its own error and nothing else remembers it. Exact for two neighbouring instants
//! ([B, C; C', B(before)] is their joint covariance); that three numbers stand for as many errors as there are satellites makes it an
//! approximation over longer times, which costs accuracy and shows in the consistency figures of docs/methods/ins.md. Provenance: ours.

use super::aid::Aided;
use super::filter::Filter;
use super::innovation::Kind;
use super::measure::Antenna;
use super::settings::ErrorModel;
use super::slots::{Further, Process};
use crate::quantity::GpsTime;
use crate::signal::{Aiding, SatelliteId, SatelliteRange, TimedAiding};
use crate::solution::wls::{Normal, Row};
use crate::special::float::exp;
use crate::special::gamma::chi_square_tail;
use nalgebra::{Matrix3, Vector3};

/// Most satellites of a solved position; those of four constellations in view are fewer.
const MOST: usize = 64;
/// Rounds of the position: the second leaves (10 km)² / 2e7 m squared over the same, a micrometre.
const ROUNDS: usize = 4;
/// A step below this is the last \[m\]: ranges are straight over it to 1e-13 m.
const STEP_M: f64 = 1e-3;
/// Share of the slow variance added along every axis, so that it has a root where a satellite alone has slow errors.
const FLOOR: f64 = 1e-9;

/// A satellite in a solved position.
#[derive(Debug, Clone, Copy)]
struct CommonBias {
    satellite: SatelliteId,
    response: Vector3<f64>,
    variance: f64,
    tau_s: f64,
}

/// The last solved position: what the next one has in common with it.
#[derive(Debug, Clone)]
pub(super) struct Receiver {
    biases: [Option<CommonBias>; MOST],
    /// When, and the root L of its slow covariance.
    last: Option<(GpsTime, Matrix3<f64>)>,
}

/// A solved position: step from where the antenna was believed, white and slow covariance, local axes north, east, down.
struct Solved {
    step: Vector3<f64>,
    white: Matrix3<f64>,
    slow: Matrix3<f64>,
}

/// Rows of one instant, of the ranges or of their rates. Any local axes serve the normal equation; here they are north, east, down.
#[derive(Clone, Copy)]
struct Rows {
    n: usize,
    row: [Row; MOST],
}

impl Rows {
    fn of(rows: impl Iterator<Item = Row>) -> Self {
        let mut all = Self { n: 0, row: [Row::default(); MOST] };
        for (place, row) in all.row.iter_mut().zip(rows) {
            *place = row;
            all.n += 1;
        }
        all
    }
    fn iter(&self) -> impl Iterator<Item = Row> + Clone + '_ {
        self.row[..self.n].iter().copied()
    }
}

impl Receiver {
    pub(super) const fn new() -> Self {
        Self { biases: [None; MOST], last: None }
    }

    /// Correlation of the slow part now with that of the last position, as far as satellites are in both.
    fn common(&self, now: &[Option<CommonBias>], dt: f64) -> Matrix3<f64> {
        let mut c = Matrix3::zeros();
        for a in now.iter().flatten() {
            let before = self.biases.iter().flatten().find(|b| b.satellite == a.satellite);
            if let Some(b) = before {
                c += a.response * b.response.transpose() * (a.variance.min(b.variance) * exp(-dt / a.tau_s));
            }
        }
        c
    }

    /// How the three states move to a new root of the slow covariance: A and its noise. Nothing is carried over from nowhere.
    fn course(&self, root: &Matrix3<f64>, now: &[Option<CommonBias>], time: GpsTime) -> Option<(Matrix3<f64>, Matrix3<f64>)> {
        let a = match &self.last {
            None => Matrix3::zeros(),
            Some((before, last)) => {
                let common = self.common(now, time.seconds_since(*before));
                let half = root.solve_lower_triangular(&common)?;
                last.solve_lower_triangular(&half.transpose())?.transpose()
            }
        };
        Some((a, Matrix3::identity() - a * a.transpose()))
    }
}

impl Filter {
    /// Ranges of one instant to a position and a velocity, and these into the filter: how many satellites are in the position.
    pub(super) fn aid_loosely(&mut self, receiver: &mut Receiver, together: &[TimedAiding]) -> usize {
        let Some((time, first)) = together.iter().find_map(|t| range(t).map(|m| (t.time, *m))) else { return 0 };
        let (mut ranges, mut n) = ([first; MOST], 0);
        for timed in together {
            let Some(m) = range(timed) else { continue };
            let admitted = if n < MOST { self.admit(timed) } else { Err(Aided::NoPlace) };
            match admitted {
                Ok(()) => {
                    ranges[n] = *m;
                    n += 1;
                }
                Err(outcome) => {
                    self.innovations[Kind::Range.index()].n_refused += 1;
                    self.count(&outcome, 1);
                }
            }
        }
        match self.solve(receiver, time, &ranges[..n]) {
            Aided::Used { .. } => n,
            Aided::Gated { .. } => 0,
            outcome => {
                self.innovations[Kind::Range.index()].n_refused += n as u64;
                self.count(&outcome, n);
                0
            }
        }
    }

    fn solve(&mut self, receiver: &mut Receiver, time: GpsTime, ranges: &[SatelliteRange]) -> Aided {
        let antenna = match self.ready(time) {
            Ok((antenna, _)) => antenna,
            Err(outcome) => return outcome,
        };
        let mut biases = [None; MOST];
        let solved = match self.position(&antenna, ranges, &mut biases) {
            Ok(solved) => solved,
            Err(outcome) => {
                if matches!(outcome, Aided::Gated { .. }) {
                    self.innovations[Kind::Range.index()].n_gated += ranges.len() as u64;
                }
                return outcome;
            }
        };
        let outcome = self.use_position(receiver, &antenna, &solved, &biases);
        // The position may have moved the velocity, much so where both are tied: after a hole.
        if let Some((step, covariance)) = velocity(&antenna.moving(self.state()), ranges) {
            self.use_three(Kind::FixVelocity, &step, &covariance, |axis| antenna.along_velocity(axis));
        }
        if matches!(outcome, Aided::Used { .. }) {
            let now = self.time();
            self.modes.fix(now);
            self.modes.tick(now);
        }
        outcome
    }

    /// The position, its covariance in parts, and each satellite's share; refused where the geometry or the residuals say no.
    fn position(&self, antenna: &Antenna, ranges: &[SatelliteRange], biases: &mut [Option<CommonBias>; MOST]) -> Result<Solved, Aided> {
        let mut offset = Vector3::zeros();
        let mut rows = code_rows(antenna, ranges);
        let mut normal = Normal::new(rows.iter()).map_err(|_| Aided::NoPosition)?;
        let mut step = normal.step().ok_or(Aided::NoPosition)?;
        for _ in 1..ROUNDS {
            if !(step.norm() >= STEP_M) {
                break;
            }
            offset += step;
            rows = code_rows(&antenna.moved(&offset), ranges);
            normal = Normal::new(rows.iter()).map_err(|_| Aided::NoPosition)?;
            step = normal.step().ok_or(Aided::NoPosition)?;
        }
        let inverse = *normal.covariance().map_err(|_| Aided::NoPosition)?.matrix();
        let left = |row: &Row| row.residual + row.unit.dot(&step) - normal.clock(row.clock, &step);
        let square: f64 = rows.iter().map(|row| row.weight * left(&row) * left(&row)).sum();
        let redundancy = rows.n - 3 - normal.clocks();
        if redundancy > 0 && !(chi_square_tail(redundancy as f64, square) >= self.settings.gate.q()) {
            return Err(Aided::Gated { square });
        }
        let (mut white, mut slow) = (Matrix3::zeros(), Matrix3::zeros());
        for ((m, row), place) in ranges.iter().zip(rows.iter()).zip(biases) {
            let response = normal.response(&inverse, &row);
            let variance = m.sigma_correlated.m() * m.sigma_correlated.m();
            let outer = response * response.transpose();
            white += outer * (m.sigma_white.m() * m.sigma_white.m());
            slow += outer * variance;
            *place = Some(CommonBias { satellite: m.satellite, response, variance, tau_s: m.correlation_time_s });
        }
        Ok(Solved { step: offset + step, white, slow })
    }

    fn use_position(&mut self, receiver: &mut Receiver, antenna: &Antenna, solved: &Solved, biases: &[Option<CommonBias>; MOST]) -> Aided {
        let kind = Kind::FixPosition;
        if self.settings.errors == ErrorModel::White || !(solved.slow.trace() > 0.0) {
            return self.use_three(kind, &solved.step, &(solved.white + solved.slow), |axis| antenna.along_position(axis));
        }
        let floored = solved.slow + Matrix3::identity() * (FLOOR * solved.slow.trace());
        let time = self.time();
        let Some(root) = floored.cholesky().map(|c| c.l()) else { return Aided::NoPosition };
        let Some((a, q)) = receiver.course(&root, biases, time) else { return Aided::NoPosition };
        let mut places = [0; 3];
        for (k, place) in (0..).zip(&mut places) {
            let unit = Process::constant(1.0);
            let Some(slot) = self.slots.ensure(&mut self.joint, Further::SolvedPosition(k), unit, 0.0) else { return Aided::NoPlace };
            *place = slot;
        }
        self.slots.mix(&mut self.joint, places, &a, &q);
        *receiver = Receiver { biases: *biases, last: Some((time, root)) };
        let believed = Vector3::from(places.map(|place| self.slots.value(place)));
        let row = |axis: &Vector3<f64>| {
            let share = root.transpose() * axis;
            (0..3).fold(antenna.along_position(axis), |row, k| row.with(places[k], share[k]))
        };
        self.use_three(kind, &(solved.step - root * believed), &solved.white, row)
    }
}

fn range(timed: &TimedAiding) -> Option<&SatelliteRange> {
    match &timed.aiding {
        Aiding::Satellite(m) if m.range.is_some() => Some(m),
        _ => None,
    }
}

fn code_rows(antenna: &Antenna, ranges: &[SatelliteRange]) -> Rows {
    Rows::of(ranges.iter().filter_map(|m| {
        let (unit, distance) = antenna.towards(&m.position);
        let variance = m.sigma_white.m() * m.sigma_white.m() + m.sigma_correlated.m() * m.sigma_correlated.m();
        Some(Row { unit, weight: 1.0 / variance, clock: m.satellite.constellation.index(), residual: m.range?.m() - distance })
    }))
}

/// Step of the velocity and its covariance from the range rates, where they suffice.
fn velocity(antenna: &Antenna, ranges: &[SatelliteRange]) -> Option<(Vector3<f64>, Matrix3<f64>)> {
    let rows = Rows::of(ranges.iter().filter_map(|m| {
        let (rate, sigma) = m.rate_mps?;
        let (unit, _) = antenna.towards(&m.position);
        let residual = rate - unit.dot(&(antenna.ned_from_ecef * m.velocity_mps - antenna.v));
        Some(Row { unit, weight: 1.0 / (sigma * sigma), clock: m.satellite.constellation.index(), residual })
    }));
    let normal = Normal::new(rows.iter()).ok()?;
    Some((normal.step()?, *normal.covariance().ok()?.matrix()))
}
