//! Errors of one range: equations 18 and 19, and 20 for phase differenced in time.

use crate::quantity::{Metres, OutOfDomain, Radians};
use crate::spec::gbas::{AirborneCurve, CarrierModel, ErrorModel, GroundCurve};
use crate::special::float::{cos, exp, sin, sqrt};
use core::f64::consts::FRAC_PI_2;

/// Earth's radius of the obliquity factor, and height of the ionospheric shell (standard) \[m\].
const EARTH_RADIUS_M: f64 = 6_378_136.3;
const SHELL_HEIGHT_M: f64 = 350_000.0;

/// Parts of the standard deviation of a smoothed, corrected pseudorange.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RangeError {
    /// Ground multipath and noise.
    pub ground: Metres,
    /// Airborne multipath and noise.
    pub airborne: Metres,
    /// Troposphere.
    pub troposphere: Metres,
    /// Ionosphere; 0 for ionosphere-free code.
    pub ionosphere: Metres,
    receivers: f64,
}

impl RangeError {
    /// Of a satellite at an elevation.
    ///
    /// ```text
    /// sigma_gnd = f_g sqrt((a0 + a1 exp(-E/th0))^2 / M + a2^2)       sigma_air = f_a (a + b exp(-E/th))
    /// ```
    ///
    /// # Errors
    /// [`OutOfDomain`] for an elevation outside (0, pi/2\].
    pub fn new(model: &ErrorModel, elevation: Radians) -> Result<Self, OutOfDomain> {
        let el = upright(elevation)?;
        let curve = if el > model.split.rad() { &model.ground[1] } else { &model.ground[0] };
        Ok(Self {
            ground: Metres::new(model.ground_factor * ground(curve, model.receivers, el)),
            airborne: Metres::new(model.airborne_factor * airborne(&model.airborne, el)),
            troposphere: Metres::new(troposphere(model)),
            ionosphere: Metres::new(ionosphere(model)),
            receivers: f64::from(model.receivers),
        })
    }

    /// Everything.
    pub fn sigma(&self) -> Metres {
        self.with_ground(1.0)
    }

    /// Everything when one reference receiver is faulty: the ground's variance is that of the M - 1 others.
    pub fn sigma_one_receiver_faulty(&self) -> Metres {
        self.with_ground(self.receivers / (self.receivers - 1.0))
    }

    fn with_ground(&self, factor: f64) -> Metres {
        let [g, a, t, i] = [self.ground, self.airborne, self.troposphere, self.ionosphere].map(|s| s.m() * s.m());
        Metres::new(sqrt(factor * g + a + t + i))
    }
}

fn upright(elevation: Radians) -> Result<f64, OutOfDomain> {
    let el = elevation.rad();
    if !(el > 0.0 && el <= FRAC_PI_2) {
        return Err(OutOfDomain { argument: "el_rad", value: el, unit: "rad", domain: "(0, pi/2]" });
    }
    Ok(el)
}

fn ground(curve: &GroundCurve, receivers: u8, el: f64) -> f64 {
    let one = curve.a0.m() + curve.a1.m() * exp(-el / curve.theta0.rad());
    sqrt(one * one / f64::from(receivers) + curve.a2.m() * curve.a2.m())
}

fn airborne(curve: &AirborneCurve, el: f64) -> f64 {
    curve.a.m() + curve.b.m() * exp(-el / curve.theta.rad())
}

/// `s_N h0 1e-6 / sqrt(0.002 + sin^2 E) (1 - exp(-dh/h0))`, E the model's.
fn troposphere(model: &ErrorModel) -> f64 {
    let s = sin(model.atmosphere_elevation.rad());
    let h0 = model.scale_height.m();
    model.refractivity * h0 * 1e-6 / sqrt(0.002 + s * s) * (1.0 - exp(-model.height_difference.m() / h0))
}

/// `Fpp s_vig (x + 2 tau v)`, E the model's.
fn ionosphere(model: &ErrorModel) -> f64 {
    model
        .ionosphere
        .map_or(0.0, |i| obliquity(model.atmosphere_elevation.rad()) * i.gradient * (i.distance.m() + 2.0 * i.smoothing_s * i.speed_mps))
}

/// `(1 - (Re cos E / (Re + h))^2)^-1/2`.
fn obliquity(el: f64) -> f64 {
    let c = EARTH_RADIUS_M * cos(el) / (EARTH_RADIUS_M + SHELL_HEIGHT_M);
    1.0 / sqrt(1.0 - c * c)
}

/// Standard deviation of phase differenced over a coasting time (equation 20).
///
/// ```text
/// sigma_d^2 = 2 sigma_phi^2 + (m(E) g v T)^2 + (a T)^2 + (Fpp(E) s_vig v T)^2      m(E) = 1.001 / sqrt(0.002001 + sin^2 E)
/// ```
///
/// # Errors
/// [`OutOfDomain`] for an elevation outside (0, pi/2\], a speed or time below zero or not finite.
pub fn carrier_sigma(model: &CarrierModel, elevation: Radians, speed_mps: f64, coasting_s: f64) -> Result<Metres, OutOfDomain> {
    let el = upright(elevation)?;
    for (argument, value, unit) in [("speed_mps", speed_mps, "m/s"), ("coasting_s", coasting_s, "s")] {
        if !(value >= 0.0 && value.is_finite()) {
            return Err(OutOfDomain { argument, value, unit, domain: "[0, inf)" });
        }
    }
    let moved = speed_mps * coasting_s;
    let troposphere = crate::geometry::atmosphere::mapping_of(sin(el)) * model.troposphere_gradient * moved;
    let clock = model.clock_mps * coasting_s;
    let ionosphere = model.ionosphere_gradient.map_or(0.0, |gradient| obliquity(el) * gradient * moved);
    let noise = model.noise.m();
    Ok(Metres::new(sqrt(2.0 * noise * noise + troposphere * troposphere + clock * clock + ionosphere * ionosphere)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spec::gbas::{CARRIER_DUAL, GAST_D, GAST_F};

    /// The table of the specification, section 2.1, printed to a millimetre.
    #[test]
    fn sigmas_meet_the_spot_values() {
        let table = [
            (GAST_D, [(5.0, 0.518), (15.0, 0.423), (30.0, 0.372), (60.0, 0.316), (90.0, 0.308)]),
            (GAST_F, [(5.0, 0.702), (15.0, 0.579), (30.0, 0.508), (60.0, 0.421), (90.0, 0.408)]),
        ];
        for (model, row) in table {
            for (el, sigma) in row {
                let computed = RangeError::new(&model, Radians::degrees(el)).unwrap().sigma().m();
                assert!((computed - sigma).abs() < 1e-3, "{} {el}: {computed}", model.id);
            }
        }
        let ionosphere = RangeError::new(&GAST_D, Radians::degrees(30.0)).unwrap().ionosphere.m();
        assert!((ionosphere - 0.116).abs() < 5e-4, "{ionosphere}");
    }

    #[test]
    fn an_elevation_that_is_none_is_refused() {
        for el in [0.0, -0.1, 1.6, f64::NAN] {
            assert_eq!(RangeError::new(&GAST_D, Radians::new(el)).unwrap_err().argument, "el_rad");
            assert!(carrier_sigma(&CARRIER_DUAL, Radians::new(el), 10.0, 60.0).is_err());
        }
        let up = Radians::new(1.0);
        assert_eq!(carrier_sigma(&CARRIER_DUAL, up, -1.0, 60.0).unwrap_err().argument, "speed_mps");
        assert_eq!(carrier_sigma(&CARRIER_DUAL, up, 1.0, f64::NAN).unwrap_err().argument, "coasting_s");
    }

    #[test]
    fn the_smallest_coasting_error_is_two_phases() {
        let sigma = carrier_sigma(&CARRIER_DUAL, Radians::new(1.0), 25.0, 0.0).unwrap().m();
        assert!((sigma - 0.02 * core::f64::consts::SQRT_2).abs() < 1e-16);
    }
}
