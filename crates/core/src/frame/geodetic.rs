//! Geodetic position on the WGS-84 ellipsoid, its Cartesian form, and the local axes there.
//!
//! Source: WGS-84 (NGA.STND.0036), defining parameters and closed form geodetic to Cartesian; provenance: standard.

use super::{Covariance, Displacement, Ecef, Enu};
use crate::quantity::{Metres, OutOfDomain, Radians};
use crate::special::float::{atan2, cos, hypot, sin_cos, sqrt};
use core::f64::consts::{FRAC_PI_2, TAU};
use nalgebra::{Matrix3, Vector3};

/// Semi-major axis of WGS-84 \[m\].
pub const SEMI_MAJOR: Metres = Metres::new(A);
/// First eccentricity squared of WGS-84, from its flattening 1/298.257223563.
pub const ECCENTRICITY_SQUARED: f64 = F * (2.0 - F);

const A: f64 = 6_378_137.0;
const F: f64 = 1.0 / 298.257_223_563;

/// A point of the ellipsoid's surface: latitude and longitude, WGS-84.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LatLon {
    lat: Radians,
    lon: Radians,
}

/// A position: a point of the ellipsoid and the height above it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Geodetic {
    /// Foot on the ellipsoid.
    pub point: LatLon,
    /// Height above the ellipsoid.
    pub height: Metres,
}

/// A position in Earth-centred axes \[m\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EcefPosition(Vector3<f64>);

/// Radii of curvature of the ellipsoid at a latitude.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Radii {
    /// In the meridian (R_M).
    pub meridian: Metres,
    /// In the prime vertical (R_N).
    pub prime_vertical: Metres,
}

impl LatLon {
    /// A point from its angles.
    ///
    /// # Errors
    /// [`OutOfDomain`] unless the latitude is in \[-pi/2, pi/2\] and the longitude in \[-2 pi, 2 pi\].
    pub fn new(lat: Radians, lon: Radians) -> Result<Self, OutOfDomain> {
        if !(lat.rad().abs() <= FRAC_PI_2) {
            return Err(OutOfDomain { argument: "lat_rad", value: lat.rad(), unit: "rad", domain: "[-pi/2, pi/2]" });
        }
        if !(lon.rad().abs() <= TAU) {
            return Err(OutOfDomain { argument: "lon_rad", value: lon.rad(), unit: "rad", domain: "[-2 pi, 2 pi]" });
        }
        Ok(Self { lat, lon })
    }
    /// Latitude.
    pub const fn lat(&self) -> Radians {
        self.lat
    }
    /// Longitude.
    pub const fn lon(&self) -> Radians {
        self.lon
    }
}

impl EcefPosition {
    /// From a vector in metres.
    pub const fn from_vector(metres: Vector3<f64>) -> Self {
        Self(metres)
    }
    /// The components \[m\].
    pub const fn vector(&self) -> &Vector3<f64> {
        &self.0
    }
    /// This position minus another.
    pub fn minus(&self, other: &Self) -> Displacement<Ecef> {
        Displacement::from_vector(self.0 - other.0)
    }
}

/// Radii of curvature.
///
/// ```text
/// R_N = a / sqrt(1 - e2 sin^2 lat)      R_M = a (1 - e2) / (1 - e2 sin^2 lat)^1.5
/// ```
pub fn radii(lat: Radians) -> Radii {
    let (s, _) = sin_cos(lat.rad());
    let w2 = 1.0 - ECCENTRICITY_SQUARED * s * s;
    let w = sqrt(w2);
    Radii { meridian: Metres::new(A * (1.0 - ECCENTRICITY_SQUARED) / (w2 * w)), prime_vertical: Metres::new(A / w) }
}

/// The Cartesian form of a geodetic position.
pub fn ecef_from_geodetic(position: &Geodetic) -> EcefPosition {
    let (slat, clat) = sin_cos(position.point.lat.rad());
    let (slon, clon) = sin_cos(position.point.lon.rad());
    let n = radii(position.point.lat).prime_vertical.m();
    let h = position.height.m();
    EcefPosition(Vector3::new((n + h) * clat * clon, (n + h) * clat * slon, (n * (1.0 - ECCENTRICITY_SQUARED) + h) * slat))
}

/// The geodetic form of a Cartesian position: Bowring's iteration on the reduced latitude.
///
/// # Valid
/// From 50 km off the Earth's centre outwards; the latitude settles to the last digits in at most six rounds for every height above
/// -5000 km.
///
/// # Errors
/// [`OutOfDomain`] for a position within 50 km of the Earth's centre, where "up" has no meaning, or one that is not finite.
pub fn geodetic_from_ecef(position: &EcefPosition) -> Result<Geodetic, OutOfDomain> {
    let v = position.0;
    let r = v.norm();
    if !(r >= 5.0e4 && r.is_finite()) {
        return Err(OutOfDomain { argument: "position", value: r, unit: "m", domain: "[5e4, inf) from the Earth's centre" });
    }
    let b = A * (1.0 - F);
    let p = hypot(v.x, v.y);
    let second = ECCENTRICITY_SQUARED / (1.0 - ECCENTRICITY_SQUARED);
    let mut reduced = atan2(v.z * A, p * b);
    let mut lat = 0.0;
    let (mut s, mut c) = (0.0, 0.0);
    for _ in 0..6 {
        let (sr, cr) = sin_cos(reduced);
        let before = lat;
        lat = atan2(v.z + second * b * sr * sr * sr, p - ECCENTRICITY_SQUARED * A * cr * cr * cr);
        (s, c) = sin_cos(lat);
        // Each round gains three digits or more: the next would not move the last one.
        if (lat - before).abs() < 1e-13 {
            break;
        }
        reduced = atan2((1.0 - F) * s, c);
    }
    let w = sqrt(1.0 - ECCENTRICITY_SQUARED * s * s);
    // p cos + z sin - a w: the height without the division by a cosine that fails at the poles.
    let height = p * c + v.z * s - A * w;
    let point = LatLon { lat: Radians::new(lat), lon: Radians::new(atan2(v.y, v.x)) };
    Ok(Geodetic { point, height: Metres::new(height) })
}

/// Rotation from Earth-centred to local axes: rows east, north, up.
pub fn enu_from_ecef(at: &LatLon) -> Matrix3<f64> {
    let (slat, clat) = sin_cos(at.lat.rad());
    let (slon, clon) = sin_cos(at.lon.rad());
    Matrix3::new(-slon, clon, 0.0, -slat * clon, -slat * slon, clat, clat * clon, clat * slon, slat)
}

impl Displacement<Ecef> {
    /// The same displacement in local axes at a point.
    pub fn to_enu(&self, at: &LatLon) -> Displacement<Enu> {
        Displacement::from_vector(enu_from_ecef(at) * self.vector())
    }
}

impl Covariance<Ecef> {
    /// The same covariance in local axes at a point: C V C'.
    pub fn to_enu(&self, at: &LatLon) -> Covariance<Enu> {
        let c = enu_from_ecef(at);
        Covariance::claim_symmetric(c * self.matrix() * c.transpose())
    }
}

impl Geodetic {
    /// The position reached by a small displacement (below about 10 km: second-order terms are left out).
    ///
    /// ```text
    /// dlat = n / (R_M + h)      dlon = e / ((R_N + h) cos lat)      dh = u
    /// ```
    ///
    /// # Errors
    /// [`OutOfDomain`] where the step leaves the latitudes, which happens beside a pole only.
    pub fn moved(&self, by: &Displacement<Enu>) -> Result<Self, OutOfDomain> {
        let d = by.vector();
        let radii = radii(self.point.lat);
        let h = self.height.m();
        let lat = self.point.lat.rad() + d.y / (radii.meridian.m() + h);
        let lon = self.point.lon.rad() + d.x / ((radii.prime_vertical.m() + h) * cos(self.point.lat.rad()));
        Ok(Self { point: LatLon::new(Radians::new(lat), Radians::new(lon))?, height: Metres::new(h + d.z) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn geodetic(lat_deg: f64, lon_deg: f64, height_m: f64) -> Geodetic {
        let point = LatLon::new(Radians::degrees(lat_deg), Radians::degrees(lon_deg)).unwrap();
        Geodetic { point, height: Metres::new(height_m) }
    }

    #[test]
    fn equator_and_pole_lie_on_the_axes_of_the_ellipsoid() {
        let x = ecef_from_geodetic(&geodetic(0.0, 0.0, 100.0));
        assert!((x.vector() - Vector3::new(6_378_237.0, 0.0, 0.0)).norm() < 1e-9);
        // Polar semi-axis 6356752.314245 m, WGS-84's derived value to the micrometre.
        let z = ecef_from_geodetic(&geodetic(90.0, 0.0, 0.0));
        assert!((z.vector() - Vector3::new(0.0, 0.0, 6_356_752.314_245)).norm() < 1e-6);
    }

    #[test]
    fn radii_at_the_pole_and_the_equator_are_the_closed_forms() {
        let (e, p) = (radii(Radians::new(0.0)), radii(Radians::degrees(90.0)));
        let b = 6_356_752.314_245_179;
        assert!((e.meridian.m() - b * b / A).abs() < 1e-6);
        assert!((e.prime_vertical.m() - A).abs() < 1e-9);
        assert!((p.meridian.m() - A * A / b).abs() < 1e-6);
        assert!((p.prime_vertical.m() - A * A / b).abs() < 1e-6);
    }

    #[test]
    fn east_points_east_north_points_north_up_points_up() {
        let here = geodetic(40.0, 116.0, 0.0);
        let origin = ecef_from_geodetic(&here);
        for (there, axis) in [(geodetic(40.0, 116.0001, 0.0), 0), (geodetic(40.0001, 116.0, 0.0), 1), (geodetic(40.0, 116.0, 10.0), 2)] {
            let d = ecef_from_geodetic(&there).minus(&origin).to_enu(&here.point);
            let unit = d.vector() / d.vector().norm();
            assert!(unit[axis] > 1.0 - 1e-9, "{unit:?}");
        }
    }

    #[test]
    fn places_off_the_earth_are_refused() {
        for (lat, lon) in [(1.6, 0.0), (f64::NAN, 0.0), (0.0, 7.0), (0.0, f64::INFINITY)] {
            assert!(LatLon::new(Radians::new(lat), Radians::new(lon)).is_err());
        }
        assert!(geodetic_from_ecef(&EcefPosition::from_vector(Vector3::zeros())).is_err());
        assert!(geodetic_from_ecef(&EcefPosition::from_vector(Vector3::new(f64::NAN, 7e6, 0.0))).is_err());
    }

    proptest! {
        // One nanometre is a few units in the last place of an Earth radius; the loss in two conversions stays below four.
        #[test]
        fn geodetic_to_cartesian_and_back(lat in -90.0..=90.0f64, lon in -180.0..=180.0f64, h in -1.0e4..4.0e7f64) {
            let x = ecef_from_geodetic(&geodetic(lat, lon, h));
            let back = ecef_from_geodetic(&geodetic_from_ecef(&x).unwrap());
            prop_assert!((back.vector() - x.vector()).norm() < 3e-8, "{} m", (back.vector() - x.vector()).norm());
            prop_assert!((geodetic_from_ecef(&x).unwrap().height.m() - h).abs() < 3e-8);
        }

        // Second-order terms of a step d: d^2 tan(lat) / 2R, 8 mm for 100 m at 85 degrees.
        #[test]
        fn a_small_step_goes_where_it_says(lat in -85.0..85.0f64, e in -100.0..100.0f64, n in -100.0..100.0f64, u in -100.0..100.0f64) {
            let here = geodetic(lat, 10.0, 9000.0);
            let by = Displacement::from_vector(Vector3::new(e, n, u));
            let there = here.moved(&by).unwrap();
            let moved = ecef_from_geodetic(&there).minus(&ecef_from_geodetic(&here)).to_enu(&here.point);
            prop_assert!((moved.vector() - by.vector()).norm() < 0.03);
        }
    }
}
