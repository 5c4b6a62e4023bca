//! NTCM-G: vertical electron content of the ionosphere in closed form, driven by solar activity.
//!
//! Source: European Commission, *NTCM-G Ionospheric Model Description*, issue 1.0 (2022), equations 2 to 34; Jakowski, Hoque, Mayer 2011.
//! Provenance: printed (formulas and test values read through the JRC's and D. Duchet's public transcriptions of the document).

use super::Direction;
use super::seasonal::day_of_year;
use crate::frame::Geodetic;
use crate::quantity::{GpsTime, Metres};
use crate::signal::Carrier;
use crate::special::float::{asin, cos, exp, sin, sin_cos, sqrt};
use core::f64::consts::PI;

/// Table 1: k1 to k10.
const K: [f64; 10] = [0.92519, 0.16951, 0.00443, 0.06626, 0.00899, 0.21289, -0.15414, -0.38439, 1.14023, 1.20556];
/// Table 1: k11 \[TECU\] and k12 \[TECU/sfu\].
const ACTIVITY: [f64; 2] = [1.41808, 0.13985];
/// Crests of the equatorial anomaly: magnetic latitude and half width \[deg\].
const CRESTS: [(f64, f64); 2] = [(16.0, 12.0), (-10.0, 13.0)];
/// Geomagnetic north pole \[deg\].
const POLE: (f64, f64) = (79.74, -71.78);
/// Earth and shell \[km\].
const EARTH: f64 = 6371.0;
const SHELL: f64 = EARTH + 450.0;
const HOUR_NS: f64 = 3_600e9;
const DAY_NS: i64 = 86_400_000_000_000;

/// Effective ionisation level from Galileo's three coefficients \[sfu\] (equation 2). `None` where all are zero, which a satellite sends
/// that has none, or where they give no number.
///
/// ```text
/// Az = sqrt(a0^2 + 1633.33 a1^2 + 4802000 a2^2 + 3266.67 a0 a2)      the root mean square of a0 + a1 mu + a2 mu^2 over modified dip mu
/// ```
pub fn ionisation_level([a0, a1, a2]: [f64; 3]) -> Option<f64> {
    let square = a0 * a0 + 1633.33 * a1 * a1 + 4_802_000.0 * a2 * a2 + 3266.67 * a0 * a2;
    (square > 0.0 && square < 1e8).then(|| sqrt(square))
}

/// Relative change of all delays for a change of the ionisation level \[1/sfu\]: k12 / (k11 + k12 Az).
pub(crate) fn sensitivity(level_sfu: f64) -> f64 {
    ACTIVITY[1] / (ACTIVITY[0] + ACTIVITY[1] * level_sfu)
}

/// Delay on L1 by the model at an effective ionisation level \[sfu\].
pub fn delay(level_sfu: f64, receiver: &Geodetic, direction: &Direction, time: GpsTime) -> Metres {
    let unit = direction.unit();
    Metres::new(Ntcm::new(level_sfu, time).slant(receiver, direction.elevation().rad(), (unit.x, unit.y)) * metres_per_tecu())
}

/// Delay on L1 of one TECU \[m\] (equation 1).
pub(crate) fn metres_per_tecu() -> f64 {
    40.3e16 / (Carrier::L1.frequency_hz() * Carrier::L1.frequency_hz())
}

/// The model at one instant: what does not depend on the place, worked out once.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Ntcm {
    /// F2 F5, season and activity \[TECU\].
    scale: f64,
    /// Declination of the sun \[rad\], and its sine.
    sun: (f64, f64),
    /// Hours of the day in universal time.
    hours: f64,
}

impl Ntcm {
    /// At an effective ionisation level \[sfu\] and an instant.
    ///
    /// # Deviation from the source
    /// GPS time stands for universal time: leap seconds turn the sun by less than 0.1 degrees.
    pub(crate) fn new(level_sfu: f64, time: GpsTime) -> Self {
        let day = day_of_year(time);
        let year = 2.0 * PI / 365.25;
        // F2: annual and semi-annual variation (equations 8 to 10).
        let season = 1.0 + K[5] * cos(year * (day - 18.0)) + K[6] * cos(2.0 * year * (day - 6.0));
        // Equation 28.
        let declination = (23.44 * sin((0.9856 * (day - 80.7)).to_radians())).to_radians();
        let hours = time.nanoseconds().rem_euclid(DAY_NS) as f64 / HOUR_NS;
        Self { scale: season * (ACTIVITY[0] + ACTIVITY[1] * level_sfu), sun: (declination, sin(declination)), hours }
    }

    /// Vertical electron content above a place \[TECU\]: F1 F2 F3 F4 F5 (equation 3).
    pub(crate) fn vertical(&self, lat: f64, lon: f64) -> f64 {
        let local = self.hours + lon.to_degrees() / 15.0;
        let (sd, cd) = sin_cos(2.0 * PI * local / 12.0);
        let (st, ct) = sin_cos(2.0 * PI * local / 8.0);
        let zenith = cos(lat - self.sun.0);
        // F1: height of the sun, local time and its harmonics (equations 4 to 7, 29, 30).
        let wave = K[0] * cos(2.0 * PI * (local - 14.0) / 24.0) + K[1] * cd + K[2] * sd + K[3] * ct + K[4] * st;
        let daily = zenith + 0.4 + (zenith - 2.0 * lat * self.sun.1 / PI) * wave;
        // F3 and F4: the Earth's magnetic field and the crests beside its equator (equations 11 to 14).
        let magnetic = magnetic_latitude(lat, lon);
        let crest = |(centre, width): (f64, f64)| {
            let off = (magnetic.to_degrees() - centre) / width;
            exp(-0.5 * off * off)
        };
        let field = (1.0 + K[7] * cos(magnetic)) * (1.0 + K[8] * crest(CRESTS[0]) + K[9] * crest(CRESTS[1]));
        daily * field * self.scale
    }

    /// Along a line of sight from a receiver, by elevation and the unit vector, east-north-up \[TECU\] (equations 24 to 27 and 32 to 34).
    pub(crate) fn slant(&self, here: &Geodetic, elevation: f64, (east, north): (f64, f64)) -> f64 {
        const RATIO: f64 = EARTH / SHELL;
        let (sin_el, cos_el) = sin_cos(elevation);
        let k = RATIO * cos_el;
        // sin psi / cos E, so that a satellite overhead divides by nothing.
        let root = sqrt(1.0 - k * k);
        let over = root - sin_el * RATIO;
        let cos_psi = sin_el * root + cos_el * k;
        let (sin_lat, cos_lat) = sin_cos(here.point.lat().rad());
        let lat = asin((sin_lat * cos_psi + cos_lat * over * north).clamp(-1.0, 1.0));
        let lon = here.point.lon().rad() + asin((over * east / cos(lat)).clamp(-1.0, 1.0));
        let bent = RATIO * sin(0.9782 * (PI / 2.0 - elevation));
        self.vertical(lat, lon) / sqrt(1.0 - bent * bent)
    }
}

/// Latitude against the dipole \[rad\] (equation 31).
pub(crate) fn magnetic_latitude(lat: f64, lon: f64) -> f64 {
    let (sin_pole, cos_pole) = sin_cos(POLE.0.to_radians());
    let (sin_lat, cos_lat) = sin_cos(lat);
    asin((sin_lat * sin_pole + cos_lat * cos_pole * cos(lon - POLE.1.to_radians())).clamp(-1.0, 1.0))
}

#[cfg(test)]
#[path = "ntcm_tests.rs"]
mod tests;
