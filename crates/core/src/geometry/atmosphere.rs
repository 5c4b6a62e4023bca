//! What the atmosphere adds to a pseudorange.

use super::Direction;
use crate::frame::Geodetic;
use crate::quantity::{GpsTime, Metres};
use crate::signal::{Carrier, Klobuchar, SPEED_OF_LIGHT_MPS};
use crate::special::float::{cos, exp, ln, sin, sin_cos, sqrt};
use core::f64::consts::PI;

const NANOSECONDS_PER_DAY: i64 = 86_400_000_000_000;

/// Ionospheric delay on L1 by the broadcast single-frequency model.
///
/// Source: IS-GPS-200 20.3.3.5.2.5 and figure 20-4; provenance: standard. Angles there are in semicircles. On another carrier the delay is
/// `(f1 / f)^2` times this.
///
/// # Valid
/// The model removes about half of the delay's root mean square.
pub fn klobuchar(model: &Klobuchar, receiver: &Geodetic, direction: &Direction, time: GpsTime) -> Metres {
    klobuchar_towards(model, receiver, direction.elevation().rad(), sin_cos(direction.azimuth().rad()), time)
}

/// The same from the elevation \[rad\] and the azimuth's sine and cosine, which a line of sight has without the angle.
pub(crate) fn klobuchar_towards(model: &Klobuchar, receiver: &Geodetic, elevation_rad: f64, azimuth: (f64, f64), time: GpsTime) -> Metres {
    klobuchar_and_latitude(model, receiver, elevation_rad, azimuth, time).0
}

/// With the geomagnetic latitude of the point where the signal pierces the model's shell \[rad\].
pub(crate) fn klobuchar_and_latitude(
    model: &Klobuchar,
    receiver: &Geodetic,
    elevation_rad: f64,
    (sin_az, cos_az): (f64, f64),
    time: GpsTime,
) -> (Metres, f64) {
    let elevation = elevation_rad / PI;
    let angle = 0.0137 / (elevation + 0.11) - 0.022;
    let lat = (receiver.point.lat().rad() / PI + angle * cos_az).clamp(-0.416, 0.416);
    let lon = receiver.point.lon().rad() / PI + angle * sin_az / cos(lat * PI);
    let magnetic = lat + 0.064 * cos((lon - 1.617) * PI);
    // Whole nanoseconds wrap around without rounding.
    let local = ((43_200e9 * lon) as i64).wrapping_add(time.nanoseconds()).rem_euclid(NANOSECONDS_PER_DAY) as f64 * 1e-9;
    let polynomial = |c: &[f64; 4]| c[0] + magnetic * (c[1] + magnetic * (c[2] + magnetic * c[3]));
    let amplitude = polynomial(&model.alpha).max(0.0);
    let period = polynomial(&model.beta).max(72_000.0);
    let x = 2.0 * PI * (local - 50_400.0) / period;
    let cosine = if x.abs() < 1.57 { amplitude * (1.0 - x * x / 2.0 + x * x * x * x / 24.0) } else { 0.0 };
    let gap = 0.53 - elevation;
    let slant = 1.0 + 16.0 * gap * gap * gap;
    (Metres::new(slant * (5e-9 + cosine) * SPEED_OF_LIGHT_MPS), magnetic * PI)
}

/// How much larger the ionospheric delay is on a carrier than on L1.
pub fn ionosphere_factor(carrier: Carrier) -> f64 {
    let ratio = Carrier::L1.frequency_hz() / carrier.frequency_hz();
    ratio * ratio
}

/// Tropospheric delay: Saastamoinen's zenith delays in the standard atmosphere, mapped to the elevation.
///
/// ```text
/// p = 1013.25 (1 - 2.2557e-5 h)^5.2568    T = 288.15 - 0.0065 h    e = 0.5 * 6.108 exp((17.15 T - 4684) / (T - 38.45))
/// dry = 0.0022768 p / (1 - 0.00266 cos 2 lat - 0.00028e-3 h)       Saastamoinen 1972
/// wet = 0.002277 (1255 / T + 0.05) e
/// m(E) = 1.001 / sqrt(0.002001 + sin^2 E)                          RTCA DO-229 A.4.2.4 (Black and Eisner 1984)
/// ```
///
/// The relative humidity is 50 %, the ICAO standard atmosphere has none: ours.
///
/// # Valid
/// Heights -1 to 40 km (above, the air is gone and the delay zero); elevations above 4 degrees.
pub fn saastamoinen(receiver: &Geodetic, direction: &Direction) -> Metres {
    Metres::new(zenith_delay(receiver) * troposphere_mapping(direction))
}

/// Mapping of the zenith delay to an elevation.
pub fn troposphere_mapping(direction: &Direction) -> f64 {
    mapping_of(sin(direction.elevation().rad()))
}

/// The same from the elevation's sine.
pub(crate) fn mapping_of(sin_elevation: f64) -> f64 {
    1.001 / sqrt(0.002001 + sin_elevation * sin_elevation)
}

/// Tropospheric delay overhead \[m\]; a receiver evaluates it once for all satellites.
pub(crate) fn zenith_delay(receiver: &Geodetic) -> f64 {
    let h = receiver.height.m();
    if !(h < 40_000.0) {
        return 0.0;
    }
    let h = h.max(-1000.0);
    let pressure = 1013.25 * exp(5.2568 * ln(1.0 - 2.2557e-5 * h));
    let temperature = (288.15 - 0.0065 * h).max(216.65);
    let vapour = 0.5 * 6.108 * exp((17.15 * temperature - 4684.0) / (temperature - 38.45));
    let dry = 0.002_276_8 * pressure / (1.0 - 0.002_66 * cos(2.0 * receiver.point.lat().rad()) - 0.000_28e-3 * h);
    let wet = 0.002_277 * (1255.0 / temperature + 0.05) * vapour;
    // The standard atmosphere's vapour does not fall off by itself above the weather.
    dry + if h < 11_000.0 { wet } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::LatLon;
    use crate::quantity::Radians;

    fn at(lat_deg: f64, lon_deg: f64, h: f64) -> Geodetic {
        Geodetic { point: LatLon::new(Radians::degrees(lat_deg), Radians::degrees(lon_deg)).unwrap(), height: Metres::new(h) }
    }
    fn towards(azimuth_deg: f64, elevation_deg: f64) -> Direction {
        Direction::new(Radians::degrees(azimuth_deg), Radians::degrees(elevation_deg)).unwrap()
    }

    /// The worked example that circulates with the model: 40 N, 100 W, azimuth 210, elevation 20, 20:45:00 GPS time of day gives 23.784 m.
    /// Printed to the millimetre by its sources (GPS Toolbox, Rochester Institute of Technology); the constants have three digits.
    #[test]
    fn the_published_example_of_the_broadcast_ionosphere() {
        let model = Klobuchar { alpha: [3.82e-8, 1.49e-8, -1.79e-7, 0.0], beta: [1.43e5, 0.0, -3.28e5, 1.13e5] };
        let time = GpsTime::from_nanoseconds((20 * 3600 + 45 * 60) * 1_000_000_000);
        let delay = klobuchar(&model, &at(40.0, 260.0, 0.0), &towards(210.0, 20.0), time);
        assert!((delay.m() - 23.784).abs() < 2e-3, "{}", delay.m());
    }

    /// 2.3 m of dry air at sea level and some 0.1 m of vapour: the textbook figures; at 11 km a quarter of the pressure, 226 hPa.
    #[test]
    fn zenith_delays_of_the_standard_atmosphere() {
        let sea = saastamoinen(&at(45.0, 0.0, 0.0), &towards(0.0, 90.0)).m();
        assert!((2.35..2.45).contains(&sea), "{sea}");
        let high = saastamoinen(&at(45.0, 0.0, 11_000.0), &towards(0.0, 90.0)).m();
        assert!((high - 0.002_276_8 * 226.3).abs() < 0.01, "{high}");
        assert_eq!(saastamoinen(&at(45.0, 0.0, 50_000.0), &towards(0.0, 90.0)).m(), 0.0);
    }

    #[test]
    fn low_satellites_look_through_more_air() {
        assert!((troposphere_mapping(&towards(0.0, 90.0)) - 1.0).abs() < 1e-3);
        // Eleven degrees: about five atmospheres, 1/sin(11 deg) = 5.24 less the Earth's curvature.
        assert!((5.0..5.24).contains(&troposphere_mapping(&towards(0.0, 11.0))));
    }
}
