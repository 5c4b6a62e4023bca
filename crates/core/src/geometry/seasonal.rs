//! Tropospheric delay overhead by latitude and day of the year: what users of an SBAS service apply.
//!
//! Source: RTCA DO-229D A.4.2.4 (Collins 1999, UNB3); provenance: standard. Table and constants as the open engines have them (RTKLIB, gLAB);
//! we hold no copy of the document.

use crate::frame::Geodetic;
use crate::quantity::GpsTime;
use crate::special::float::{cos, exp, ln};
use core::f64::consts::PI;

/// Pressure \[hPa\], temperature \[K\], water vapour pressure \[hPa\], lapse rates of temperature \[K/m\] and of water vapour \[1\].
type Weather = [f64; 5];

/// Mean of the year at 15, 30, 45, 60 and 75 degrees of latitude.
const MEAN: [Weather; 5] = [
    [1013.25, 299.65, 26.31, 6.30e-3, 2.77],
    [1017.25, 294.15, 21.79, 6.05e-3, 3.15],
    [1015.75, 283.15, 11.66, 5.58e-3, 2.57],
    [1011.75, 272.15, 6.78, 5.39e-3, 1.81],
    [1013.00, 263.65, 4.11, 4.53e-3, 1.55],
];
/// Amplitude of the year.
const SEASON: [Weather; 5] = [
    [0.0; 5],
    [-3.75, 7.00, 8.85, 0.25e-3, 0.33],
    [-2.25, 11.00, 7.24, 0.32e-3, 0.46],
    [-1.75, 15.00, 5.36, 0.81e-3, 0.74],
    [-0.50, 14.50, 3.39, 0.62e-3, 0.30],
];
/// Day of the year on which it is coldest, north and south of the equator.
const COLDEST: [f64; 2] = [28.0, 211.0];
/// \[K/hPa\], \[K²/hPa\].
const REFRACTIVITY: [f64; 2] = [77.604, 382_000.0];
/// Gas constant of dry air \[J/(kg K)\].
const DRY_AIR: f64 = 287.054;
/// Gravity at the air's centre of mass and at the surface \[m/s²\].
const GRAVITY: [f64; 2] = [9.784, 9.80665];
/// The air is gone above this \[m\]; the law itself ends where the temperature would be zero.
const HIGHEST_M: f64 = 40_000.0;
const DAY_NS: i64 = 86_400_000_000_000;

/// Zenith delay \[m\], dry and wet together; to be mapped by `mapping_of`.
///
/// ```text
/// X = mean(lat) - season(lat) cos(2 pi (day - coldest) / 365.25)     X of pressure P, temperature T, vapour e, rates beta, lambda
/// dry = 1e-6 k1 R P / g_m                                times (1 - beta h / T)^(g / (R beta))
/// wet = 1e-6 k2 R e / ((g_m (lambda + 1) - beta R) T)    times (1 - beta h / T)^((lambda + 1) g / (R beta) - 1)
/// ```
///
/// # Deviation from the source
/// The height above the ellipsoid stands for that above sea level: up to 100 m, 3 cm of delay.
///
/// # Valid
/// Heights up to 40 km, above which the delay is zero; below the ellipsoid as at -1 km at the lowest. Years 1980 to 2099.
pub(crate) fn seasonal_zenith_delay(place: &Geodetic, time: GpsTime) -> f64 {
    let height = place.height.m();
    if !(height < HIGHEST_M) {
        return 0.0;
    }
    let height = height.max(-1000.0);
    let [pressure, temperature, vapour, lapse, vapour_lapse] = weather(place.point.lat().rad(), day_of_year(time));
    let [k1, k2] = REFRACTIVITY;
    let [g_mean, g] = GRAVITY;
    let thinner = ln((1.0 - lapse * height / temperature).max(1e-3));
    let power = g / (DRY_AIR * lapse);
    let dry = 1e-6 * k1 * DRY_AIR * pressure / g_mean * exp(power * thinner);
    let wet = 1e-6 * k2 * DRY_AIR * vapour / ((g_mean * (vapour_lapse + 1.0) - lapse * DRY_AIR) * temperature);
    dry + wet * exp(((vapour_lapse + 1.0) * power - 1.0) * thinner)
}

fn weather(lat_rad: f64, day: f64) -> Weather {
    let coldest = COLDEST[usize::from(lat_rad < 0.0)];
    let phase = cos(2.0 * PI * (day - coldest) / 365.25);
    // Between the rows of the table, outside them as at its ends.
    let row = (lat_rad.abs().to_degrees() / 15.0 - 1.0).clamp(0.0, 4.0);
    let below = if row >= 4.0 { 3 } else { row as usize };
    let share = row - below as f64;
    core::array::from_fn(|i| {
        let between = |table: &[Weather; 5]| (1.0 - share) * table[below][i] + share * table[below + 1][i];
        between(&MEAN) - between(&SEASON) * phase
    })
}

/// Day of the year, from 1. GPS time began on the 6th of January of a leap year, and every fourth year until 2100 is one.
pub(super) fn day_of_year(time: GpsTime) -> f64 {
    let days = time.nanoseconds().div_euclid(DAY_NS) + 5;
    let in_cycle = days.rem_euclid(1461);
    let day = if in_cycle < 366 { in_cycle } else { (in_cycle - 366) % 365 };
    day as f64 + 1.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::LatLon;
    use crate::quantity::{Metres, Radians};

    fn at(lat_deg: f64, h: f64) -> Geodetic {
        Geodetic { point: LatLon::new(Radians::degrees(lat_deg), Radians::new(0.0)).unwrap(), height: Metres::new(h) }
    }
    fn day(days: i64) -> GpsTime {
        GpsTime::from_nanoseconds(days * DAY_NS)
    }

    #[test]
    fn days_are_those_of_the_calendar() {
        // 1980-01-06, 1980-12-31 (leap year), 1981-01-01, 2012-10-25 (leap year), 2025-02-15: days since the epoch by the calendar.
        for (days, want) in [(0, 6.0), (360, 366.0), (361, 1.0), (11_981, 299.0), (16_477, 46.0)] {
            assert_eq!(day_of_year(day(days)), want, "{days}");
        }
    }

    /// Sea level at 45 degrees in the middle of spring is the table's own row: dry 77.604e-6 * 287.054 * 1015.75 / 9.784 = 2.31274 m and
    /// wet 0.382 * 287.054 * 11.66 / ((9.784 * 3.57 - 5.58e-3 * 287.054) * 283.15) = 0.13549 m, worked by hand to five digits.
    #[test]
    fn the_tables_own_row_at_sea_level() {
        // Day 119.3125 is a quarter of a year after day 28; the nearest whole day leaves 0.3 of a day, 1 mm of the season's 7 hPa and 11 K.
        let spring = GpsTime::from_nanoseconds((119 - 6) * DAY_NS);
        assert!((seasonal_zenith_delay(&at(45.0, 0.0), spring) - (2.31274 + 0.13549)).abs() < 1e-3);
    }

    #[test]
    fn summer_is_wetter_than_winter_on_both_sides_of_the_equator() {
        let (january, july) = (day(22), day(205));
        assert!(seasonal_zenith_delay(&at(45.0, 0.0), july) > seasonal_zenith_delay(&at(45.0, 0.0), january) + 0.1);
        assert!(seasonal_zenith_delay(&at(-45.0, 0.0), january) > seasonal_zenith_delay(&at(-45.0, 0.0), july) + 0.1);
        // Within 15 degrees of the equator there are no seasons.
        assert_eq!(seasonal_zenith_delay(&at(10.0, 0.0), july), seasonal_zenith_delay(&at(10.0, 0.0), january));
    }

    #[test]
    fn a_quarter_of_the_air_is_above_eleven_kilometres_and_none_above_forty() {
        let (sea, high) = (seasonal_zenith_delay(&at(45.0, 0.0), day(0)), seasonal_zenith_delay(&at(45.0, 11_000.0), day(0)));
        assert!((0.2..0.25).contains(&(high / sea)), "{}", high / sea);
        assert_eq!(seasonal_zenith_delay(&at(45.0, 40_000.0), day(0)), 0.0);
        assert!(seasonal_zenith_delay(&at(90.0, 39_999.0), day(0)).is_finite());
    }
}
