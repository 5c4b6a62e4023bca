//! Covariance of a weighted least-squares position, from satellite geometry alone.
//!
//! Source: Fu, Zhang, Li 2014 (equal sigmas); with weights and one clock for each constellation it is the textbook normal equation.

use crate::frame::{Covariance, Enu};
use crate::geometry::LineOfSight;
use crate::quantity::{Metres, Unavailable};
use crate::signal::Constellation;
use crate::special::float::sqrt;
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

/// The largest condition number of H'WH that still gives a covariance.
pub const CONDITION_LIMIT: f64 = 1e12;

const CLOCKS: usize = Constellation::ALL.len();
const UNKNOWNS: usize = 3 + CLOCKS;

/// Dilutions of precision: standard deviations of the position for ranges of 1 m, one clock for each constellation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dilution {
    /// East.
    pub east: f64,
    /// North.
    pub north: f64,
    /// Horizontal, sqrt(east² + north²).
    pub horizontal: f64,
    /// Vertical.
    pub vertical: f64,
    /// Position, sqrt(horizontal² + vertical²).
    pub position: f64,
}

/// What one constellation contributes: its weight, and its weighted mean direction, which its clock absorbs.
#[derive(Debug, Clone, Copy, Default)]
struct Group {
    count: usize,
    weight: f64,
    mean: Vector3<f64>,
    residual: f64,
}

/// Covariance of the position.
///
/// ```text
/// row i of H = [-cos E sin A, -cos E cos A, -sin E, one 1 in the column of its constellation's clock]
/// V = ((H' W H)^-1) position block,    W = diag(1/sigma_i^2)
///   = (sum over constellations c and their satellites i of w_i (u_i - m_c)(u_i - m_c)')^-1,    m_c the weighted mean direction of c
/// ```
///
/// The second line is the first with the clocks eliminated: exactly the same matrix, from differences that lose no digits, of size
/// three whatever the number of constellations; it is inverted by its Cholesky factor.
///
/// # Errors
/// [`Unavailable::TooFewSatellites`] when unknowns (three and a clock for each constellation seen) outnumber satellites;
/// [`Unavailable::Singular`] when the condition number of H'WH, clocks included, is above [`CONDITION_LIMIT`].
pub fn covariance<'a>(sights: impl Iterator<Item = &'a LineOfSight> + Clone) -> Result<Covariance<Enu>, Unavailable> {
    Normal::new(sights.map(|s| row(s, 1.0 / (s.sigma.m() * s.sigma.m()))))?.covariance()
}

/// Dilutions of precision; every range counts the same, whatever its sigma.
///
/// # Errors
/// As [`covariance`].
pub fn dilution<'a>(sights: impl Iterator<Item = &'a LineOfSight> + Clone) -> Result<Dilution, Unavailable> {
    Ok(Dilution::of(&Normal::new(sights.map(|s| row(s, 1.0)))?.covariance()?))
}

/// Dilutions of precision with the clocks'.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Geometric {
    /// Of the position.
    pub dilution: Dilution,
    /// Geometric: position and every clock.
    pub geometric: f64,
}

/// Dilutions of precision from unit vectors, east-north-up, from the receiver to the satellites.
///
/// ```text
/// GDOP^2 = PDOP^2 + sum over constellations c of (1/n_c + m_c' P m_c)
/// ```
///
/// # Errors
/// As [`covariance`].
#[inline]
pub fn dilution_of_units(sights: impl Iterator<Item = (Vector3<f64>, Constellation)> + Clone) -> Result<Geometric, Unavailable> {
    let normal = Normal::new(sights.map(|(unit, c)| Row { unit, weight: 1.0, clock: c.index(), residual: 0.0 }))?;
    let covariance = normal.covariance()?;
    let dilution = Dilution::of(&covariance);
    let clocks = normal.clock_variances(covariance.matrix());
    Ok(Geometric { dilution, geometric: sqrt(dilution.position * dilution.position + clocks) })
}

/// Standard deviations along the axes of the horizontal ellipse, the larger first.
///
/// ```text
/// lambda = (a + c)/2 +- hypot((a - c)/2, b)    of [[a, b], [b, c]]
/// ```
pub fn horizontal_axes(covariance: &Covariance<Enu>) -> (Metres, Metres) {
    let v = covariance.horizontal();
    let (a, b, c) = (v[(0, 0)], v[(0, 1)], v[(1, 1)]);
    let larger = 0.5 * (a + c) + crate::special::float::hypot(0.5 * (a - c), b);
    // The product of both is the determinant, which keeps the digits of a thin ellipse.
    let smaller = if larger > 0.0 { (a * c - b * b) / larger } else { 0.0 };
    (Metres::new(sqrt(larger)), Metres::new(sqrt(if smaller > 0.0 { smaller } else { 0.0 })))
}

/// A satellite in the solution, from a caller with many epochs who has the direction as a vector and the sigma as a weight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WeightedSight {
    /// Unit vector from the receiver to the satellite, east-north-up.
    pub unit: Vector3<f64>,
    /// 1 / sigma² \[1/m²\].
    pub weight: f64,
    /// Whose clock.
    pub constellation: Constellation,
}

/// Covariance of the position, as [`covariance`].
///
/// # Errors
/// As [`covariance`].
pub fn covariance_of_weighted(sights: impl Iterator<Item = WeightedSight> + Clone) -> Result<Covariance<Enu>, Unavailable> {
    Normal::new(sights.map(weighted_row))?.covariance()
}

/// Covariance, and how far the position moves for one metre in each range: the rows s_i = (H'WH)^-1 H' w_i of the solution.
///
/// # Errors
/// As [`covariance`].
pub fn responses_of_weighted(
    sights: impl Iterator<Item = WeightedSight> + Clone,
) -> Result<(Covariance<Enu>, impl Iterator<Item = Vector3<f64>> + Clone), Unavailable> {
    responses_of_rows(sights.map(weighted_row))
}

/// How far the position moves for one metre in each range, as [`responses_of_weighted`].
///
/// # Errors
/// As [`covariance`].
pub fn responses<'a>(
    sights: impl Iterator<Item = &'a LineOfSight> + Clone,
) -> Result<impl Iterator<Item = Vector3<f64>> + Clone, Unavailable> {
    Ok(responses_of_rows(sights.map(|s| row(s, 1.0 / (s.sigma.m() * s.sigma.m()))))?.1)
}

fn responses_of_rows(
    rows: impl Iterator<Item = Row> + Clone,
) -> Result<(Covariance<Enu>, impl Iterator<Item = Vector3<f64>> + Clone), Unavailable> {
    let normal = Normal::new(rows.clone())?;
    let covariance = normal.covariance()?;
    let v = *covariance.matrix();
    Ok((covariance, rows.map(move |row| normal.response(&v, &row))))
}

pub(crate) fn weighted_row(s: WeightedSight) -> Row {
    Row { unit: s.unit, weight: s.weight, clock: s.constellation.index(), residual: 0.0 }
}

/// One range of the normal equation.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Row {
    /// From the receiver to the satellite, east-north-up.
    pub(crate) unit: Vector3<f64>,
    /// 1 / variance.
    pub(crate) weight: f64,
    /// Which clock.
    pub(crate) clock: usize,
    /// Measured less computed range \[m\]; what the clock makes of it is common to its rows.
    pub(crate) residual: f64,
}

/// The normal equation with its clocks eliminated.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Normal {
    groups: [Group; CLOCKS],
    information: Matrix3<f64>,
    /// Right side: -sum w (u - m_c)(r - r_c).
    side: Vector3<f64>,
}

impl Normal {
    /// From rows.
    ///
    /// # Errors
    /// [`Unavailable::TooFewSatellites`].
    pub(crate) fn new(rows: impl Iterator<Item = Row> + Clone) -> Result<Self, Unavailable> {
        let groups = groups(rows.clone());
        let have = groups.iter().map(|g| g.count).sum();
        let need = 3 + groups.iter().filter(|g| g.count > 0).count();
        // Nothing in view still needs four.
        let need = if need > 3 { need } else { 4 };
        if have < need {
            return Err(Unavailable::TooFewSatellites { need, have });
        }
        // Upper triangle, and the right side.
        let ([mut xx, mut xy, mut xz, mut yy, mut yz, mut zz], mut side) = ([0.0; 6], Vector3::zeros());
        for row in rows {
            let group = &groups[row.clock];
            let d = row.unit - group.mean;
            let weighted = row.weight * d;
            xx += weighted.x * d.x;
            xy += weighted.x * d.y;
            xz += weighted.x * d.z;
            yy += weighted.y * d.y;
            yz += weighted.y * d.z;
            zz += weighted.z * d.z;
            side -= (row.residual - group.residual) * weighted;
        }
        Ok(Self { groups, information: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz), side })
    }

    /// Right sides of the rows for other residuals, as columns: -sum w (u - m_c) r. What is common to a clock's rows drops out.
    pub(crate) fn sides<const N: usize>(&self, rows: impl Iterator<Item = (Row, SVector<f64, N>)>) -> SMatrix<f64, 3, N> {
        let mut sides = SMatrix::zeros();
        for (row, residuals) in rows {
            sides -= (row.weight * (row.unit - self.groups[row.clock].mean)) * residuals.transpose();
        }
        sides
    }

    /// The least-squares step of the position; `None` where the geometry does not determine it at all.
    pub(crate) fn step(&self) -> Option<Vector3<f64>> {
        Some(self.information.cholesky()?.solve(&self.side))
    }

    /// How far the position moves for one metre in a row's range, by the inverse of the information.
    pub(crate) fn response(&self, inverse: &Matrix3<f64>, row: &Row) -> Vector3<f64> {
        inverse * (row.unit - self.groups[row.clock].mean) * -row.weight
    }

    /// A row's direction less the weighted mean of its clock's rows.
    pub(crate) fn centred(&self, row: &Row) -> Vector3<f64> {
        row.unit - self.groups[row.clock].mean
    }

    /// What a unit of weight counts in the mean of a clock's rows; 0 for a clock without rows.
    pub(crate) fn share(&self, clock: usize) -> f64 {
        let group = &self.groups[clock];
        if group.count > 0 { 1.0 / group.weight } else { 0.0 }
    }

    /// What a row's clock reads after a step: the weighted mean of residual and step along the line of sight.
    pub(crate) fn clock(&self, clock: usize, step: &Vector3<f64>) -> f64 {
        self.groups[clock].residual + self.groups[clock].mean.dot(step)
    }

    /// Inverse of the information, for [`Self::leverage`].
    pub(crate) fn inverse(&self) -> Option<Matrix3<f64>> {
        Some(self.information.cholesky()?.inverse())
    }

    /// How much of its own residual a row takes away by moving the solution, 0 to 1: w (1/W_c + d' N^-1 d).
    pub(crate) fn leverage(&self, inverse: &Matrix3<f64>, row: &Row) -> f64 {
        self.coupling(inverse, row, row)
    }

    /// How much of a metre of `cause` the least-squares solution puts into what `row` is computed to be: w ([one clock]/W_c + d' N^-1 d).
    pub(crate) fn coupling(&self, inverse: &Matrix3<f64>, row: &Row, cause: &Row) -> f64 {
        let (group, of_cause) = (&self.groups[row.clock], &self.groups[cause.clock]);
        let (d, d_cause) = (row.unit - group.mean, cause.unit - of_cause.mean);
        let shared = if row.clock == cause.clock { 1.0 / group.weight } else { 0.0 };
        cause.weight * (shared + d.dot(&(inverse * d_cause)))
    }

    /// Number of clocks solved for.
    pub(crate) fn clocks(&self) -> usize {
        self.groups.iter().filter(|g| g.count > 0).count()
    }

    /// Covariance of the position.
    ///
    /// # Errors
    /// [`Unavailable::Singular`].
    pub(crate) fn covariance(&self) -> Result<Covariance<Enu>, Unavailable> {
        let inverse = self.inverse();
        // Traces bound the condition from above at no cost; eigenvalues only where that bound does not settle it.
        if let Some(inverse) = inverse.filter(|inverse| self.condition_bound(inverse) <= CONDITION_LIMIT) {
            return Ok(Covariance::claim_symmetric(inverse));
        }
        let condition = condition(&self.information, &self.groups);
        let singular = Unavailable::Singular { condition, limit: CONDITION_LIMIT };
        if !(condition <= CONDITION_LIMIT) {
            return Err(singular);
        }
        inverse.map(Covariance::claim_symmetric).ok_or(singular)
    }

    /// trace(N) trace(N^-1) of the whole normal matrix N: never below its condition number. The clocks' diagonal of N^-1 is
    /// 1/w_c + m_c' P m_c with P the inverse of the eliminated form.
    fn condition_bound(&self, inverse: &Matrix3<f64>) -> f64 {
        let used = self.groups.iter().filter(|g| g.count > 0);
        let normal = self.information.trace() + used.map(|g| g.weight * (1.0 + g.mean.norm_squared())).sum::<f64>();
        normal * (inverse.trace() + self.clock_variances(inverse))
    }

    /// Variance of the difference of two clocks, from the covariance of the position; 0 where either has no ranges.
    ///
    /// ```text
    /// 1/W_a + 1/W_b + (m_a - m_b)' P (m_a - m_b)
    /// ```
    pub(crate) fn clock_difference_variance(&self, a: usize, b: usize, position: &Matrix3<f64>) -> f64 {
        let (first, second) = (&self.groups[a], &self.groups[b]);
        if a == b || first.count == 0 || second.count == 0 {
            return 0.0;
        }
        let d = first.mean - second.mean;
        1.0 / first.weight + 1.0 / second.weight + d.dot(&(position * d))
    }

    /// Variances of all clocks together, from the covariance of the position.
    fn clock_variances(&self, position: &Matrix3<f64>) -> f64 {
        let used = self.groups.iter().filter(|g| g.count > 0);
        used.map(|g| 1.0 / g.weight + g.mean.dot(&(position * g.mean))).sum()
    }
}

impl Dilution {
    /// From the covariance of ranges of 1 m.
    pub(crate) fn of(q: &Covariance<Enu>) -> Self {
        let [e, n, v] = [0, 1, 2].map(|i| q.matrix()[(i, i)]);
        Self { east: sqrt(e), north: sqrt(n), horizontal: sqrt(e + n), vertical: sqrt(v), position: sqrt(e + n + v) }
    }
}

fn row(s: &LineOfSight, weight: f64) -> Row {
    Row { unit: s.direction.unit(), weight, clock: s.constellation.index(), residual: 0.0 }
}

fn groups(rows: impl Iterator<Item = Row>) -> [Group; CLOCKS] {
    let mut groups = [Group::default(); CLOCKS];
    for row in rows {
        let g = &mut groups[row.clock];
        g.count += 1;
        g.weight += row.weight;
        g.mean += row.weight * row.unit;
        g.residual += row.weight * row.residual;
    }
    for g in groups.iter_mut().filter(|g| g.count > 0) {
        g.mean /= g.weight;
        g.residual /= g.weight;
    }
    groups
}

/// Condition number of the whole normal matrix, rebuilt from the eliminated form. Unused clocks hold a diagonal element that is there
/// already, which lies between the extreme eigenvalues and so changes neither.
fn condition(information: &Matrix3<f64>, groups: &[Group; CLOCKS]) -> f64 {
    let mut normal = SMatrix::<f64, UNKNOWNS, UNKNOWNS>::zeros();
    let mut position = *information;
    for (i, g) in groups.iter().enumerate() {
        position += g.weight * g.mean * g.mean.transpose();
        let coupling = -g.weight * g.mean;
        normal.fixed_view_mut::<3, 1>(0, 3 + i).copy_from(&coupling);
        normal.fixed_view_mut::<1, 3>(3 + i, 0).copy_from(&coupling.transpose());
        normal[(3 + i, 3 + i)] = g.weight;
    }
    normal.fixed_view_mut::<3, 3>(0, 0).copy_from(&position);
    for (i, _) in groups.iter().enumerate().filter(|(_, g)| g.count == 0) {
        normal[(3 + i, 3 + i)] = position[(0, 0)];
    }
    let eigenvalues = normal.symmetric_eigenvalues();
    let (least, most) = (eigenvalues.min(), eigenvalues.max());
    if least > 0.0 { most / least } else { f64::INFINITY }
}

#[cfg(test)]
#[path = "wls_tests.rs"]
mod tests;
