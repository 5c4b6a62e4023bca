//! Velocity of a single point from Doppler.

use super::{MOST_RANGES, Solver};
use crate::frame::{Geodetic, enu_from_ecef};
use crate::geometry::broadcast::in_axes_of_reception;
use crate::signal::SPEED_OF_LIGHT_MPS;
use crate::solution::wls::{Normal, Row};
use nalgebra::{Matrix3, Vector3};

impl Solver<'_> {
    /// Velocity from Doppler: the same directions, one clock rate for all, weights of the ranges; robust.
    ///
    /// ```text
    /// rate = u . (v_satellite - v) + c (receiver clock rate)
    /// ```
    ///
    /// The covariance takes its scale from the residuals: no error model of Doppler is assumed.
    pub(super) fn velocity(&self, here: &Geodetic) -> Option<(Vector3<f64>, Matrix3<f64>)> {
        let turn = enu_from_ecef(&here.point);
        let mut rows = [(Row::default(), 0.0); MOST_RANGES];
        let mut n = 0;
        for (r, s) in self.ranges.iter().zip(self.seen.iter()).filter(|(r, s)| s.counts() && r.rate_mps.is_finite()) {
            let moving = in_axes_of_reception(&r.velocity_mps, r.corrected.m() / SPEED_OF_LIGHT_MPS);
            // Of a receiver at rest.
            let residual = r.rate_mps - s.row.unit.dot(&(turn * moving));
            rows[n] = (Row { unit: s.row.unit, weight: s.modelled.weight, clock: 0, residual }, s.modelled.weight);
            n += 1;
        }
        let rows = &mut rows[..n];
        let (mut v, mut clock, mut huber) = (Vector3::zeros(), 0.0, f64::INFINITY);
        for _ in 0..4 {
            weigh_down(rows, &v, clock, huber);
            let normal = Normal::new(rows.iter().map(|r| r.0)).ok()?;
            v = normal.step()?;
            clock = normal.clock(0, &v);
            let left = rows.iter().map(|(r, _)| left_over(r, &v, clock).abs());
            huber = 1.5 * left.sum::<f64>() / n as f64;
        }
        weigh_down(rows, &v, clock, huber);
        let squares: f64 = rows.iter().map(|(r, _)| r.weight * left_over(r, &v, clock) * left_over(r, &v, clock)).sum();
        let covariance = Normal::new(rows.iter().map(|r| r.0)).ok()?.covariance().ok()?;
        (n > 4).then(|| (v, covariance.matrix() * (squares / (n - 4) as f64)))
    }
}

/// What a velocity and a clock rate leave of a rate.
fn left_over(row: &Row, v: &Vector3<f64>, clock: f64) -> f64 {
    row.residual + row.unit.dot(v) - clock
}

/// Huber's weights of rates with their full weights beside them.
fn weigh_down(rows: &mut [(Row, f64)], v: &Vector3<f64>, clock: f64, huber: f64) {
    for (row, full) in rows {
        let size = left_over(row, v, clock).abs();
        row.weight = if size > huber { *full * huber / size } else { *full };
    }
}
