//! Displacements and covariances with their frame in the type.

use crate::quantity::{Metres, OutOfDomain, Radians};
use crate::special::float::{sin_cos, sqrt};
use core::marker::PhantomData;
use nalgebra::{Matrix2, Matrix3, Vector3};

/// A Cartesian frame.
pub trait Frame: Copy + core::fmt::Debug {}

/// Earth-centred, Earth-fixed (WGS-84 axes).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ecef;
/// East, north, up at the estimated position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Enu;
/// Along track, cross track (positive right), up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Track;
impl Frame for Ecef {}
impl Frame for Enu {}
impl Frame for Track {}

/// A difference of two positions \[m\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Displacement<F: Frame> {
    components: Vector3<f64>,
    frame: PhantomData<F>,
}

/// A covariance of position \[m²\], symmetric by construction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Covariance<F: Frame> {
    matrix: Matrix3<f64>,
    frame: PhantomData<F>,
}

impl<F: Frame> Displacement<F> {
    /// From components in the frame's order.
    pub fn new(first: Metres, second: Metres, third: Metres) -> Self {
        Self::from_vector(Vector3::new(first.m(), second.m(), third.m()))
    }
    /// From a vector in metres.
    pub fn from_vector(components: Vector3<f64>) -> Self {
        Self { components, frame: PhantomData }
    }
    /// The components \[m\].
    pub fn vector(&self) -> &Vector3<f64> {
        &self.components
    }
}

impl Displacement<Enu> {
    /// The same displacement along and across a course.
    pub fn to_track(&self, course: Radians) -> Displacement<Track> {
        Displacement::from_vector(track_from_enu(course) * self.components)
    }
}

impl<F: Frame> Covariance<F> {
    /// From the six numbers of the upper triangle, in the frame's order \[m²\].
    pub fn from_upper([xx, xy, yy, xz, yz, zz]: [f64; 6]) -> Self {
        Self::claim_symmetric(Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz))
    }
    /// The caller claims that the matrix is symmetric; the upper triangle counts.
    pub fn claim_symmetric(matrix: Matrix3<f64>) -> Self {
        Self { matrix, frame: PhantomData }
    }
    /// From nine numbers, row after row, that must be a covariance \[m²\].
    ///
    /// # Errors
    /// As [`Covariance::new`].
    pub fn from_rows(rows: [f64; 9]) -> Result<Self, OutOfDomain> {
        Self::new(Matrix3::from_row_slice(&rows))
    }
    /// From a matrix that must be a covariance.
    ///
    /// # Errors
    /// [`OutOfDomain`] unless finite, symmetric to 1e-9 of its largest element, with no variance below zero.
    pub fn new(matrix: Matrix3<f64>) -> Result<Self, OutOfDomain> {
        let scale = matrix.amax();
        let skew = (matrix - matrix.transpose()).amax();
        // Element by element: the largest of them need not notice a NaN.
        if !(matrix.iter().all(|v| v.is_finite()) && skew <= 1e-9 * scale) {
            return Err(OutOfDomain { argument: "covariance", value: skew, unit: "m²", domain: "symmetric and finite" });
        }
        let least = matrix.diagonal().min();
        if !(least >= 0.0) {
            return Err(OutOfDomain { argument: "covariance", value: least, unit: "m²", domain: "[0, inf) on the diagonal" });
        }
        Ok(Self::claim_symmetric(0.5 * (matrix + matrix.transpose())))
    }
    /// The matrix \[m²\].
    pub fn matrix(&self) -> &Matrix3<f64> {
        &self.matrix
    }
    /// The variance of the component along a vector `u` (u'Vu) \[m²\].
    pub fn variance_along(&self, u: &Vector3<f64>) -> f64 {
        u.dot(&(self.matrix * u))
    }
}

/// How far a correlation may be beyond one: what four decimals of a standard deviation of a millimetre leave. Provenance: ours \[1\].
const ROUNDED: f64 = 0.1;

/// A variance below it counts as zero: no position of a vehicle is measured to a tenth of a millimetre, so that one who writes less has
/// written a zero with a guard, or another unit \[m²\]. Provenance: ours.
pub const LEAST_VARIANCE_M2: f64 = 1e-8;

/// Whether a variance is none of a measured position. One further below zero is no variance, which is another fault \[m²\].
pub fn counts_as_zero(variance_m2: f64) -> bool {
    variance_m2.abs() < LEAST_VARIANCE_M2
}

impl Covariance<Enu> {
    /// Whether the vertical can belong to the horizontal: its correlations are within one, and the three are possible together. True where
    /// a number of the vertical is not known: the horizontal then stands for itself.
    pub fn vertical_belongs(&self) -> bool {
        let m = &self.matrix;
        let (ee, en, nn, eu, nu, uu) = (m[(0, 0)], m[(0, 1)], m[(1, 1)], m[(0, 2)], m[(1, 2)], m[(2, 2)]);
        if !(eu.is_finite() && nu.is_finite() && uu.is_finite() && ee > 0.0 && nn > 0.0) {
            return true;
        }
        if !(uu > 0.0) {
            return uu == 0.0 && eu == 0.0 && nu == 0.0;
        }
        let (east, north, up) = (sqrt(ee), sqrt(nn), sqrt(uu));
        let (a, b, c) = (en / east / north, eu / east / up, nu / north / up);
        let determinant = 1.0 + 2.0 * a * b * c - a * a - b * b - c * c;
        // The negation of "outside", so that a NaN of overflow is on the bad side.
        b.abs() <= 1.0 + ROUNDED && c.abs() <= 1.0 + ROUNDED && determinant >= -3.0 * ROUNDED
    }
    /// The east-north block \[m²\].
    pub fn horizontal(&self) -> Matrix2<f64> {
        self.matrix.fixed_view::<2, 2>(0, 0).into_owned()
    }
    /// The same covariance along and across a course.
    pub fn to_track(&self, course: Radians) -> Covariance<Track> {
        let r = track_from_enu(course);
        Covariance::claim_symmetric(r * self.matrix * r.transpose())
    }
}

/// Rows along (sin, cos, 0), cross to the right (cos, -sin, 0), up.
fn track_from_enu(course: Radians) -> Matrix3<f64> {
    let (s, c) = sin_cos(course.rad());
    Matrix3::new(s, c, 0.0, c, -s, 0.0, 0.0, 0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Fu 2014's convention: along (sin, cos), across (cos, -sin), positive right of track.
    #[test]
    fn east_is_right_of_a_northbound_track_and_behind_a_westbound_one() {
        let east = Displacement::<Enu>::new(Metres::new(1.0), Metres::new(0.0), Metres::new(0.0));
        let north_bound = east.to_track(Radians::new(0.0));
        assert!((north_bound.vector() - Vector3::new(0.0, 1.0, 0.0)).amax() <= 1e-15);
        let west_bound = east.to_track(Radians::degrees(270.0));
        assert!((west_bound.vector() - Vector3::new(-1.0, 0.0, 0.0)).amax() <= 1e-15);
    }

    #[test]
    fn a_covariance_turns_into_the_track_frame() {
        // sigma 3 m east, 1 m north, correlated: on a course of 90 degrees along is east and right is south.
        let c = Covariance::<Enu>::from_upper([9.0, 2.0, 1.0, 0.5, -0.25, 4.0]).to_track(Radians::degrees(90.0));
        let expected = Matrix3::new(9.0, -2.0, 0.5, -2.0, 1.0, 0.25, 0.5, 0.25, 4.0);
        assert!((c.matrix() - expected).amax() <= 1e-14);
    }
}
