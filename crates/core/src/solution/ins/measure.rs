//! What each measurement says of the states: its prediction and its row.

use super::covariance::Row;
use super::dynamics::{PHI, R, V};
use super::state::NavState;
use crate::frame::{EcefPosition, Geodetic, ecef_from_geodetic, enu_from_ecef};
use crate::quantity::{Metres, OutOfDomain};
use crate::signal::{DmeRange, SatelliteRange, VorBearing};
use crate::special::float::{atan2, hypot, sqrt};
use core::f64::consts::{PI, TAU};
use nalgebra::{Matrix3, Vector3};

/// The antenna as the filter believes it, at the time of a measurement.
#[derive(Debug, Clone, Copy)]
pub(super) struct Antenna {
    /// Earth-centred \[m\].
    pub(super) ecef: Vector3<f64>,
    pub(super) ned_from_ecef: Matrix3<f64>,
    /// Velocity of the antenna, local axes.
    pub(super) v: Vector3<f64>,
    /// From the inertial unit to the antenna, and what the turning of the body adds to its velocity, local axes.
    arm: Vector3<f64>,
    swing: Vector3<f64>,
}

/// A scalar measurement: innovation, row, variance of its white part.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scalar {
    pub(super) innovation: f64,
    pub(super) row: Row,
    pub(super) variance: f64,
}

impl Antenna {
    /// `age_s` ago: the velocity carries it back, which leaves half an acceleration times the square of the age.
    pub(super) fn of(state: &NavState, arm_m: &Vector3<f64>, rate_radps: &Vector3<f64>, age_s: f64) -> Result<Self, OutOfDomain> {
        let position = state.position()?;
        let enu = enu_from_ecef(&position.point);
        let ned_from_ecef = Matrix3::from_rows(&[enu.row(1).into_owned(), enu.row(0).into_owned(), -enu.row(2).into_owned()]);
        let c = state.ned_from_body();
        let (arm, swing) = (c * arm_m, c * rate_radps.cross(arm_m));
        let v = state.v + swing;
        let ecef = ecef_from_geodetic(&position).vector() + ned_from_ecef.transpose() * (arm - v * age_s);
        Ok(Self { ecef, ned_from_ecef, v, arm, swing })
    }

    /// With the velocity as another measurement of the same instant has left it.
    pub(super) fn moving(&self, state: &NavState) -> Self {
        Self { v: state.v + self.swing, ..*self }
    }

    /// Row of a quantity whose gradient by position is `g`: the estimate is wrong by dr + arm x phi.
    fn position_row(&self, g: &Vector3<f64>) -> Row {
        Row::empty().with_block(R, &-g).with_block(PHI, &-g.cross(&self.arm))
    }

    /// The same by velocity.
    fn velocity_row(&self, g: &Vector3<f64>) -> Row {
        Row::empty().with_block(V, &-g).with_block(PHI, &-g.cross(&self.swing))
    }

    /// Along a solved position's axis.
    pub(super) fn along_position(&self, axis: &Vector3<f64>) -> Row {
        self.position_row(axis)
    }

    /// Along a solved velocity's axis.
    pub(super) fn along_velocity(&self, axis: &Vector3<f64>) -> Row {
        self.velocity_row(axis)
    }

    /// A solved position minus this antenna, local axes north, east, down.
    pub(super) fn difference(&self, fix: &Geodetic) -> Vector3<f64> {
        self.ned_from_ecef * (ecef_from_geodetic(fix).vector() - self.ecef)
    }

    /// The same antenna beside where it is believed, local axes \[m\].
    pub(super) fn moved(&self, by: &Vector3<f64>) -> Self {
        Self { ecef: self.ecef + self.ned_from_ecef.transpose() * by, ..*self }
    }

    /// Unit vector from the antenna to a place, local axes, and the distance.
    pub(super) fn towards(&self, place: &EcefPosition) -> (Vector3<f64>, f64) {
        let d = self.ned_from_ecef * (place.vector() - self.ecef);
        let distance = d.norm();
        (d / distance, distance)
    }

    /// Code range: grows against the line of sight. The further states stand in the innovation and the row of the caller.
    pub(super) fn range(&self, m: &SatelliteRange, measured: Metres) -> Scalar {
        let (u, distance) = self.towards(&m.position);
        let variance = m.sigma_white.m() * m.sigma_white.m();
        Scalar { innovation: measured.m() - distance, row: self.position_row(&-u), variance }
    }

    /// Range rate: the change of the line of sight with position, 2e-4 m/s a metre, is left out.
    pub(super) fn range_rate(&self, m: &SatelliteRange, rate_mps: f64, sigma_mps: f64) -> Scalar {
        let (u, _) = self.towards(&m.position);
        let predicted = u.dot(&(self.ned_from_ecef * m.velocity_mps - self.v));
        Scalar { innovation: rate_mps - predicted, row: self.velocity_row(&-u), variance: sigma_mps * sigma_mps }
    }

    /// Root mean square \[m\] of what a straight line leaves of a slant range where the position is known by the variances `p`: across the
    /// line of sight the ranges bend.
    ///
    /// ```text
    /// e' B e / 2,  B = (1 - u u') / distance        mean tr(B p) / 2, variance tr(B p B p) / 2
    /// ```
    pub(super) fn bend(&self, m: &DmeRange, p: &Matrix3<f64>) -> f64 {
        let (u, distance) = self.towards(&m.position);
        let bent = (Matrix3::identity() - u * u.transpose()) / distance * p;
        let mean = 0.5 * bent.trace();
        sqrt(mean * mean + 0.5 * (bent * bent).trace())
    }

    /// Slant range to a station.
    pub(super) fn slant(&self, m: &DmeRange) -> Scalar {
        let (u, distance) = self.towards(&m.position);
        let variance = m.sigma_white.m() * m.sigma_white.m();
        Scalar { innovation: m.slant.m() - distance, row: self.position_row(&-u), variance }
    }

    /// Bearing from a station, clockwise from its north.
    ///
    /// ```text
    /// bearing = atan2(e, n) of the aircraft in the station's axes,   d bearing = (n de - e dn) / (e^2 + n^2)
    /// ```
    ///
    /// # Errors
    /// [`OutOfDomain`] straight above it, where there is none.
    pub(super) fn bearing(&self, m: &VorBearing) -> Result<Scalar, OutOfDomain> {
        let enu_from_ecef = enu_from_ecef(&m.position.point);
        let d = enu_from_ecef * (self.ecef - ecef_from_geodetic(&m.position).vector());
        let square = d.x * d.x + d.y * d.y;
        if !(square > OVERHEAD_M * OVERHEAD_M) {
            let value = hypot(d.x, d.y);
            return Err(OutOfDomain { argument: "vor_distance", value, unit: "m", domain: "[100, inf) over the ground" });
        }
        let at_station = Vector3::new(d.y, -d.x, 0.0) / square;
        let g = self.ned_from_ecef * (enu_from_ecef.transpose() * at_station);
        let innovation = turned(m.bearing.rad() - atan2(d.x, d.y));
        Ok(Scalar { innovation, row: self.position_row(&g), variance: m.sigma_white.rad() * m.sigma_white.rad() })
    }
}

/// Nearer to a VOR than this a metre is more than half a degree, and the bearing no longer linear \[m\].
const OVERHEAD_M: f64 = 100.0;

/// An angle difference in \[-pi, pi).
fn turned(angle: f64) -> f64 {
    let turns = (angle + PI) / TAU;
    angle - TAU * libm::floor(turns)
}

/// Velocity of the body along its axis `j` at a point off the inertial unit, and what it says of the states.
///
/// ```text
/// v_b = C' v + w x arm,     error of its estimate: c_j . (dv + phi x v),  c_j column j of C
/// ```
pub(super) fn body_velocity(state: &NavState, arm_m: &Vector3<f64>, rate_radps: &Vector3<f64>, j: usize) -> (f64, Row) {
    let c = state.ned_from_body();
    let axis = c.column(j).into_owned();
    let velocity = axis.dot(&state.v) + rate_radps.cross(arm_m)[j];
    (velocity, Row::empty().with_block(V, &-axis).with_block(PHI, &-state.v.cross(&axis)))
}
