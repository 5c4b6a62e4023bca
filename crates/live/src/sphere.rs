//! Distances on a sphere, good to half of a percent: for what decides at kilometres.

/// Its radius, the mean of the ellipsoid's axes \[m\].
pub(crate) const EARTH_M: f64 = 6_371_008.8;

/// Latitude and longitude \[rad\].
pub(crate) type LatLon = (f64, f64);

/// Distance of two places \[m\].
pub(crate) fn apart_m((lat_a, lon_a): LatLon, (lat_b, lon_b): LatLon) -> f64 {
    let half = |x: f64| libm::sin(0.5 * x) * libm::sin(0.5 * x);
    let h = half(lat_b - lat_a) + libm::cos(lat_a) * libm::cos(lat_b) * half(lon_b - lon_a);
    2.0 * EARTH_M * libm::asin(libm::sqrt(h.clamp(0.0, 1.0)))
}
