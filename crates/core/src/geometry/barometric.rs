//! Heights by pressure: what an altimeter indicates, how far that is from the true height, and the path that follows it.
//!
//! Pressure altitude is the height of the static pressure in the standard atmosphere; a transponder sends it, whatever setting the crew has
//! selected. An altimeter adds the offset of its setting. Where the air is colder than standard the true height is less than the indicated
//! one. Constants: ISO 2533, standard.

use crate::quantity::{Metres, OutOfDomain, Radians};
use crate::special::float::{cos, exp_m1, ln, ln_1p, sin, tan};
use core::f64::consts::FRAC_PI_2;

/// Temperature at sea level \[K\] and its fall with height \[K/m\] (standard).
pub const SEA_LEVEL_K: f64 = 288.15;
/// See [`SEA_LEVEL_K`].
pub const LAPSE_K_PER_M: f64 = 0.0065;
/// Pressure at sea level \[hPa\] (standard).
pub const SEA_LEVEL_HPA: f64 = 1013.25;
/// R L / g: the exponent of pressure in height \[1\] (standard).
const EXPONENT: f64 = 287.052_87 * LAPSE_K_PER_M / 9.806_65;
/// Settings of an altimeter \[hPa\]. Inches of mercury are below it. Provenance: ours.
const SETTINGS_HPA: (f64, f64) = (500.0, 1200.0);
/// Heights at which the temperature falls at the rate above, and deviations from it \[m, K\]. Provenance: standard; ours.
const HEIGHTS_M: (f64, f64) = (-2000.0, 11_000.0);
const DEVIATIONS_K: (f64, f64) = (-100.0, 60.0);
/// Radius of the Earth of the published vertical path: 20 890 537 ft (printed, FAA Order 8260.52).
pub const PATH_EARTH_M: f64 = 20_890_537.0 * 0.3048;

/// What an altimeter of a setting adds to the pressure altitude.
///
/// ```text
/// o(Q) = (T0 / L) ((Q / p0)^k - 1),   k = R L / g = 0.190263
/// ```
///
/// Source: ISO 2533; provenance: re-derived. It does not depend on the height.
///
/// # Errors
/// [`OutOfDomain`] for a setting outside \[500, 1200\] hPa.
pub fn setting_offset(setting_hpa: f64) -> Result<Metres, OutOfDomain> {
    if !(setting_hpa >= SETTINGS_HPA.0 && setting_hpa <= SETTINGS_HPA.1) {
        return Err(OutOfDomain { argument: "setting_hpa", value: setting_hpa, unit: "hPa", domain: "[500, 1200]" });
    }
    Ok(Metres::new(SEA_LEVEL_K / LAPSE_K_PER_M * exp_m1(EXPONENT * ln(setting_hpa / SEA_LEVEL_HPA))))
}

/// Air whose temperature differs from the standard atmosphere by the same everywhere, above a station.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Air {
    station: Metres,
    deviation_k: f64,
}

impl Air {
    /// By the deviation from the standard atmosphere.
    ///
    /// # Errors
    /// [`OutOfDomain`] for a station outside \[-2000, 11000\] m or a deviation outside \[-100, 60\] K.
    pub fn new(station: Metres, deviation_k: f64) -> Result<Self, OutOfDomain> {
        if !(station.m() >= HEIGHTS_M.0 && station.m() <= HEIGHTS_M.1) {
            return Err(OutOfDomain { argument: "station_m", value: station.m(), unit: "m", domain: "[-2000, 11000]" });
        }
        if !(deviation_k >= DEVIATIONS_K.0 && deviation_k <= DEVIATIONS_K.1) {
            return Err(OutOfDomain { argument: "deviation_k", value: deviation_k, unit: "K", domain: "[-100, 60]" });
        }
        Ok(Self { station, deviation_k })
    }

    /// By the temperature at the station \[K\].
    ///
    /// # Errors
    /// As [`Air::new`], naming the temperature.
    pub fn of_station(station: Metres, temperature_k: f64) -> Result<Self, OutOfDomain> {
        let standard = SEA_LEVEL_K - LAPSE_K_PER_M * station.m();
        Self::new(station, temperature_k - standard).map_err(|e| match e.argument {
            "deviation_k" => OutOfDomain {
                argument: "temperature_k",
                value: temperature_k,
                unit: "K",
                domain: "from 100 below to 60 above the standard temperature of the station",
            },
            _ => e,
        })
    }

    /// Deviation from the standard atmosphere \[K\].
    pub const fn deviation_k(&self) -> f64 {
        self.deviation_k
    }

    /// The standard temperature at the station \[K\].
    fn standard_k(&self) -> f64 {
        SEA_LEVEL_K - LAPSE_K_PER_M * self.station.m()
    }

    fn check(&self, argument: &'static str, height: Metres) -> Result<(), OutOfDomain> {
        let above = self.station.m() + height.m();
        if !(above >= HEIGHTS_M.0 && above <= HEIGHTS_M.1) {
            let domain = "station and height together in [-2000, 11000]";
            return Err(OutOfDomain { argument, value: height.m(), unit: "m", domain });
        }
        Ok(())
    }

    /// The true height above the station of an aircraft that indicates this height above it.
    ///
    /// ```text
    /// h = X + (dT / L) ln[(T0 - L Hs) / (T0 - L (Hs + X))]
    /// ```
    ///
    /// The hypsometric equation; provenance: re-derived. Inversions, another fall of temperature with height and humidity are not in it.
    ///
    /// # Errors
    /// [`OutOfDomain`] where the height is outside \[-2000, 11000\] m.
    pub fn true_height(&self, indicated: Metres) -> Result<Metres, OutOfDomain> {
        self.check("indicated_m", indicated)?;
        Ok(Metres::new(self.forward(indicated.m())))
    }

    fn forward(&self, x: f64) -> f64 {
        x - self.deviation_k / LAPSE_K_PER_M * ln_1p(-LAPSE_K_PER_M * x / self.standard_k())
    }

    /// The indicated height above the station at which the true height is this one: the inverse of [`Air::true_height`].
    ///
    /// # Errors
    /// As [`Air::true_height`], for the height requested or for the one that it takes.
    pub fn indicated_height(&self, true_height: Metres) -> Result<Metres, OutOfDomain> {
        self.check("true_m", true_height)?;
        let h = true_height.m();
        let mut x = h;
        // The slope is between 0.5 and 1.3 and hardly changes: six steps reach the last bit.
        for _ in 0..20 {
            let slope = 1.0 + self.deviation_k / (self.standard_k() - LAPSE_K_PER_M * x);
            let step = (self.forward(x) - h) / slope;
            x -= step;
            if !(step.abs() > 1e-13 * h.abs()) {
                break;
            }
        }
        self.check("true_m", Metres::new(x)).map(|()| Metres::new(x))
    }

    /// What is added to a height above the station so that the true height is not below it, by the formula of ICAO Doc 8168.
    ///
    /// ```text
    /// h (15 - t0) / (273 + t0 - 0.5 L (h + Hs))     t0: temperature of the station at sea level [Celsius]
    /// ```
    ///
    /// Provenance: standard, clause not read; within 4 % of the exact law up to stations at 2800 m. Its published table is this formula.
    ///
    /// # Errors
    /// [`OutOfDomain`] where the height is outside \[-2000, 11000\] m.
    pub fn correction_doc8168(&self, height: Metres) -> Result<Metres, OutOfDomain> {
        self.check("height_m", height)?;
        let (h, above) = (height.m(), height.m() + self.station.m());
        let sea_level_c = 15.0 + self.deviation_k;
        Ok(Metres::new(h * (15.0 - sea_level_c) / (273.0 + sea_level_c - 0.5 * LAPSE_K_PER_M * above)))
    }
}

fn checked_angle(angle: Radians) -> Result<(), OutOfDomain> {
    if !(angle.rad() > 0.0 && angle.rad() < FRAC_PI_2) {
        return Err(OutOfDomain { argument: "angle_rad", value: angle.rad(), unit: "rad", domain: "(0, pi/2)" });
    }
    Ok(())
}

fn checked_finite(argument: &'static str, value: f64) -> Result<(), OutOfDomain> {
    if value.is_finite() { Ok(()) } else { Err(OutOfDomain { argument, value, unit: "m", domain: "(-inf, inf)" }) }
}

/// A path down to a crossing altitude, at a constant angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VerticalPath {
    crossing: Metres,
    angle: Radians,
}

impl VerticalPath {
    /// By the altitude where it ends (elevation of the threshold and crossing height together) and its angle, positive for a descent.
    ///
    /// # Errors
    /// [`OutOfDomain`] for an angle outside (0, pi/2) or an altitude that is not finite.
    pub fn new(crossing: Metres, angle: Radians) -> Result<Self, OutOfDomain> {
        checked_angle(angle)?;
        checked_finite("crossing_m", crossing.m())?;
        Ok(Self { crossing, angle })
    }

    /// Altitude of a barometric path at a distance along the ground before its end: a constant slope over the curved Earth.
    ///
    /// ```text
    /// H(s) = (r + H0) exp(s tan a / r) - r,   r = 20 890 537 ft
    /// ```
    ///
    /// Source: the inverse of D in FAA Order 8260.52 (printed).
    ///
    /// # Errors
    /// [`OutOfDomain`] for a distance that is not finite.
    pub fn barometric_altitude(&self, distance: Metres) -> Result<Metres, OutOfDomain> {
        checked_finite("distance_m", distance.m())?;
        let h0 = self.crossing.m();
        Ok(Metres::new(h0 + (PATH_EARTH_M + h0) * exp_m1(distance.m() * tan(self.angle.rad()) / PATH_EARTH_M)))
    }

    /// Distance before the end at which the barometric path has this altitude.
    ///
    /// ```text
    /// D = (r / tan a) ln((r + H) / (r + H0))
    /// ```
    ///
    /// Source: FAA Order 8260.52, p. 1-3 (printed).
    ///
    /// # Errors
    /// [`OutOfDomain`] for an altitude that is not finite or at the centre of the Earth.
    pub fn barometric_distance(&self, altitude: Metres) -> Result<Metres, OutOfDomain> {
        let h = altitude.m();
        if !(h > -PATH_EARTH_M && h.is_finite()) {
            return Err(OutOfDomain { argument: "altitude_m", value: h, unit: "m", domain: "(-6.37e6, inf)" });
        }
        let h0 = self.crossing.m();
        Ok(Metres::new(PATH_EARTH_M / tan(self.angle.rad()) * ln_1p((h - h0) / (PATH_EARTH_M + h0))))
    }

    /// Altitude of a straight ray (ILS, LPV, GLS) at the same distance along the ground: above the barometric path by about s²/2r.
    ///
    /// ```text
    /// H(s) = (r + H0) cos a / cos(a + s / r) - r
    /// ```
    ///
    /// Provenance: re-derived.
    ///
    /// # Errors
    /// [`OutOfDomain`] for a distance at which the ray has left the Earth.
    pub fn straight_altitude(&self, distance: Metres) -> Result<Metres, OutOfDomain> {
        let (a, turned) = (self.angle.rad(), self.angle.rad() + distance.m() / PATH_EARTH_M);
        if !(turned > -FRAC_PI_2 && turned < FRAC_PI_2) {
            return Err(OutOfDomain {
                argument: "distance_m",
                value: distance.m(),
                unit: "m",
                domain: "distances where the ray is above the horizon",
            });
        }
        // cos a / cos b - 1 = 2 sin((b + a)/2) sin((b - a)/2) / cos b, without the difference of two near one.
        let grown = 2.0 * sin(0.5 * (turned + a)) * sin(0.5 * (turned - a)) / cos(turned);
        let h0 = self.crossing.m();
        Ok(Metres::new(h0 + (PATH_EARTH_M + h0) * grown))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn m(value: f64) -> Metres {
        Metres::new(value)
    }

    /// dh = (T / T_isa) dX, summed by Simpson's rule: the law without its closed form.
    #[test]
    fn the_true_height_is_the_sum_of_layers() {
        for (station, deviation, indicated) in [(0.0, -30.0, 1500.0), (1600.0, 20.0, 3000.0), (2800.0, -50.0, 600.0)] {
            let air = Air::new(m(station), deviation).unwrap();
            let ratio = |x: f64| {
                let standard = 288.15 - 0.0065 * (station + x);
                (standard + deviation) / standard
            };
            let n = 1000;
            let step = indicated / f64::from(n);
            let inner: f64 = (1..n).map(|k| if k % 2 == 1 { 4.0 } else { 2.0 } * ratio(step * f64::from(k))).sum();
            let expected = step / 3.0 * (ratio(0.0) + inner + ratio(indicated));
            let height = air.true_height(m(indicated)).unwrap().m();
            assert!((height - expected).abs() < 1e-10 * expected, "{height} {expected}");
            let back = air.indicated_height(m(height)).unwrap().m();
            assert!((back - indicated).abs() < 1e-11 * indicated, "{back} {indicated}");
        }
    }

    #[test]
    fn standard_air_changes_nothing_and_cold_air_brings_the_aircraft_down() {
        let station = m(500.0);
        assert_eq!(Air::new(station, 0.0).unwrap().true_height(m(900.0)).unwrap(), m(900.0));
        assert!(Air::new(station, -30.0).unwrap().true_height(m(900.0)).unwrap() < m(900.0));
        assert!(Air::new(station, -30.0).unwrap().correction_doc8168(m(900.0)).unwrap() > m(0.0));
        let by_temperature = Air::of_station(station, 288.15 - 0.0065 * 500.0 - 30.0).unwrap();
        assert!((by_temperature.deviation_k() + 30.0).abs() < 1e-12);
    }

    /// A ray leaves the curved path by s²/2r, and by a share s tan a / r more: three tenths of a percent at 10 NM.
    #[test]
    fn a_ray_is_above_the_path_that_follows_the_curve() {
        let path = VerticalPath::new(m(15.0), Radians::degrees(3.0)).unwrap();
        for miles in [10.0, 5.0] {
            let s = Metres::nautical_miles(miles);
            let apart = path.straight_altitude(s).unwrap().m() - path.barometric_altitude(s).unwrap().m();
            let expected = s.m() * s.m() / (2.0 * PATH_EARTH_M);
            assert!((apart / expected - 1.0).abs() < 0.004, "{miles}: {apart} {expected}");
        }
        let s = path.barometric_distance(m(1000.0)).unwrap();
        assert!((path.barometric_altitude(s).unwrap().m() - 1000.0).abs() < 1e-9);
        assert!(path.straight_altitude(m(0.0)).unwrap() == m(15.0) && path.barometric_altitude(m(0.0)).unwrap() == m(15.0));
    }

    #[test]
    fn numbers_that_are_none_are_refused() {
        for hpa in [f64::NAN, 29.92, 499.9, 1200.1, f64::INFINITY] {
            assert_eq!(setting_offset(hpa).unwrap_err().argument, "setting_hpa");
        }
        assert_eq!(Air::new(m(f64::NAN), 0.0).unwrap_err().argument, "station_m");
        assert_eq!(Air::new(m(0.0), -101.0).unwrap_err().argument, "deviation_k");
        assert_eq!(Air::of_station(m(0.0), 15.0).unwrap_err().argument, "temperature_k");
        let air = Air::new(m(0.0), -20.0).unwrap();
        assert_eq!(air.true_height(m(11_001.0)).unwrap_err().argument, "indicated_m");
        assert_eq!(air.indicated_height(m(f64::INFINITY)).unwrap_err().argument, "true_m");
        assert_eq!(air.correction_doc8168(m(f64::NAN)).unwrap_err().argument, "height_m");
        assert_eq!(VerticalPath::new(m(0.0), Radians::new(0.0)).unwrap_err().argument, "angle_rad");
        let path = VerticalPath::new(m(0.0), Radians::degrees(3.0)).unwrap();
        assert_eq!(path.barometric_altitude(m(f64::NAN)).unwrap_err().argument, "distance_m");
        assert_eq!(path.barometric_distance(m(-7e6)).unwrap_err().argument, "altitude_m");
        assert_eq!(path.straight_altitude(m(2e7)).unwrap_err().argument, "distance_m");
    }
}
