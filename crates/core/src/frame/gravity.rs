//! Normal gravity and the turning of the Earth: what an accelerometer and a gyroscope feel without moving.
//!
//! Source: WGS-84 (NGA.STND.0036), normal gravity: Somigliana's closed form on the ellipsoid and the second-order term in height;
//! provenance: standard.

use super::{ECCENTRICITY_SQUARED, SEMI_MAJOR};
use crate::quantity::{Metres, Radians};
use crate::special::float::{sin, sqrt};
use nalgebra::Vector3;

/// Rate of rotation of the Earth, WGS-84 \[rad/s\].
pub const EARTH_RATE_RADPS: f64 = 7.292_115e-5;

/// Normal gravity at the equator \[m/s²\].
const AT_EQUATOR: f64 = 9.780_325_335_9;
/// Somigliana's constant, k = b g_pole / (a g_equator) - 1.
const SOMIGLIANA: f64 = 0.001_931_852_652_41;
const FLATTENING: f64 = 1.0 / 298.257_223_563;
/// Centrifugal share at the equator, m = rate² a² b / GM.
const CENTRIFUGAL: f64 = 0.003_449_786_506_84;

/// Gravity downwards, centrifugal part included \[m/s²\].
///
/// ```text
/// g0 = g_e (1 + k sin^2 lat) / sqrt(1 - e2 sin^2 lat)
/// g  = g0 (1 - 2 (1 + f + m - 2 f sin^2 lat) h / a + 3 (h / a)^2)
/// ```
///
/// # Valid
/// Heights up to some 20 km (1 µm/s² there). Gravity along the normal of the ellipsoid only: the deflection by height, 7e-5 m/s² northwards
/// at 9 km, is left out.
pub fn gravity_mps2(lat: Radians, height: Metres) -> f64 {
    let s = sin(lat.rad());
    gravity_of(s * s, height.m())
}

/// The same from the squared sine of the latitude, which a mechanization has at hand, and the height \[m\].
pub fn gravity_of(sine_squared: f64, height_m: f64) -> f64 {
    let on_ellipsoid = AT_EQUATOR * (1.0 + SOMIGLIANA * sine_squared) / sqrt(1.0 - ECCENTRICITY_SQUARED * sine_squared);
    let x = height_m / SEMI_MAJOR.m();
    on_ellipsoid * (1.0 - 2.0 * (1.0 + FLATTENING + CENTRIFUGAL - 2.0 * FLATTENING * sine_squared) * x + 3.0 * x * x)
}

/// Rate of the Earth against inertial space in local axes north, east, down \[rad/s\], from sine and cosine of the latitude.
pub fn earth_rate_ned(sin_lat: f64, cos_lat: f64) -> Vector3<f64> {
    Vector3::new(EARTH_RATE_RADPS * cos_lat, 0.0, -EARTH_RATE_RADPS * sin_lat)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(lat_deg: f64, height_m: f64) -> f64 {
        gravity_mps2(Radians::degrees(lat_deg), Metres::new(height_m))
    }

    /// WGS-84's derived values at the equator and the poles, printed to ten decimals; the constants carry as many.
    #[test]
    fn equator_and_pole_are_the_derived_values() {
        assert!((at(0.0, 0.0) - 9.780_325_335_9).abs() < 1e-10);
        assert!((at(90.0, 0.0) - 9.832_184_937_9).abs() < 2e-10);
        assert_eq!(at(90.0, 0.0), at(-90.0, 0.0));
    }

    /// Newton's attraction and the centrifugal force over the equator at 10 km: GM/r^2 with the oblateness J2, less rate^2 r. Higher
    /// harmonics of the normal field (J4 is a thousandth of J2) and third order in h/a are below 5e-6 m/s^2.
    #[test]
    fn height_takes_away_what_the_field_says() {
        let (gm, j2, a) = (3.986_004_418e14, 1.082_629_821e-3, 6_378_137.0);
        let field = |r: f64| gm / (r * r) * (1.0 + 1.5 * j2 * (a / r) * (a / r)) - EARTH_RATE_RADPS * EARTH_RATE_RADPS * r;
        let fall = field(a + 10_000.0) - field(a);
        assert!((at(0.0, 10_000.0) - at(0.0, 0.0) - fall).abs() < 5e-6, "{} {fall}", at(0.0, 10_000.0) - at(0.0, 0.0));
    }

    #[test]
    fn the_earth_turns_about_its_axis() {
        let (s, c) = Radians::degrees(40.0).rad().sin_cos();
        let rate = earth_rate_ned(s, c);
        assert!((rate.norm() - EARTH_RATE_RADPS).abs() < 1e-19);
        assert!(rate.x > 0.0 && rate.z < 0.0 && rate.y == 0.0);
    }
}
