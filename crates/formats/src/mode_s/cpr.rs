//! Compact position reports in the air: half of a position, made whole by the other half.
//! Source: ICAO Doc 9871, C.2.6, as the specification of surveillance restates it; standard.

use core::f64::consts::{PI, TAU};

/// Zones of latitude between the equator and a pole, of the even format.
const ZONES: f64 = 15.0;
/// Values of a coordinate.
const STEPS: f64 = 131_072.0;

/// An encoded position.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cpr {
    /// Of the odd format.
    pub odd: bool,
    /// Latitude within its zone, 17 bits.
    pub lat: u32,
    /// Longitude within its zone, 17 bits.
    pub lon: u32,
}

/// A position of two halves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fix {
    /// Latitude \[deg\].
    pub lat_deg: f64,
    /// Longitude, from -180 to 180 \[deg\].
    pub lon_deg: f64,
}

impl Cpr {
    fn parts(self) -> (f64, f64) {
        (f64::from(self.lat) / STEPS, f64::from(self.lon) / STEPS)
    }

    /// Degrees of a zone of latitude.
    fn zone_lat_deg(odd: bool) -> f64 {
        360.0 / (4.0 * ZONES - f64::from(u8::from(odd)))
    }

    /// The position of `self`, with the last report of the other format; `None` where the two are of one format, or lie in different zones of
    /// longitude.
    pub fn with(self, other: Self) -> Option<Fix> {
        let (even, odd) = match (self.odd, other.odd) {
            (false, true) => (self, other),
            (true, false) => (other, self),
            _ => return None,
        };
        let ((even_lat, even_lon), (odd_lat, odd_lon)) = (even.parts(), odd.parts());
        let zone = libm::floor(59.0 * even_lat - 60.0 * odd_lat + 0.5);
        let lat_of = |odd: bool, n: f64, part: f64| {
            let lat_deg = Self::zone_lat_deg(odd) * (modulo(zone, n) + part);
            if lat_deg >= 270.0 { lat_deg - 360.0 } else { lat_deg }
        };
        let (lat_even_deg, lat_odd_deg) = (lat_of(false, 60.0, even_lat), lat_of(true, 59.0, odd_lat));
        let n = n_zones(lat_even_deg);
        if n != n_zones(lat_odd_deg) || lat_even_deg.abs() > 90.0 || lat_odd_deg.abs() > 90.0 {
            return None;
        }
        let n = f64::from(n);
        let (lat_deg, own_lon) = if self.odd { (lat_odd_deg, odd_lon) } else { (lat_even_deg, even_lon) };
        let zone = libm::floor(even_lon * (n - 1.0) - odd_lon * n + 0.5);
        let own_n = (n - f64::from(u8::from(self.odd))).max(1.0);
        let lon_deg = 360.0 / own_n * (modulo(zone, own_n) + own_lon);
        Some(Fix { lat_deg, lon_deg: if lon_deg >= 180.0 { lon_deg - 360.0 } else { lon_deg } })
    }
}

fn modulo(a: f64, n: f64) -> f64 {
    a - n * libm::floor(a / n)
}

/// Number of zones of longitude at a latitude.
fn n_zones(lat_deg: f64) -> u32 {
    let lat_deg = lat_deg.abs();
    if lat_deg >= 87.0 {
        return if lat_deg > 87.0 { 1 } else { 2 };
    }
    let cosine = libm::cos(lat_deg.to_radians());
    let a = 1.0 - (1.0 - libm::cos(PI / (2.0 * ZONES))) / (cosine * cosine);
    // At the equator the argument is one cosine of itself: 59 zones and a rounding.
    libm::floor(TAU / libm::acos(a)).clamp(1.0, 59.0) as u32
}
