//! Vertical error budget of RNP AR, and the requirement on the aircraft.

use crate::quantity::{Metres, OutOfDomain, Provenance, Radians};
use crate::special::float::{sin, sqrt, tan};
use core::f64::consts::FRAC_PI_2;

const FT: f64 = 0.3048;
/// Three standard deviations along track of a circular error whose 95 % radius is one: 3 / sqrt(-2 ln 0.05), as printed (re-derived).
const ALONG_TRACK: f64 = 1.225;
/// Turns three standard deviations into four (re-derived): a risk of 3.2e-5 on one side.
const THREE_TO_FOUR: f64 = 4.0 / 3.0;
/// Resolution of a published angle (printed).
const ANGLE_STEP: Radians = Radians::degrees(0.01);

/// Constants of one text: feet and metres are not the same surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Constants {
    /// What a caller chooses.
    pub id: &'static str,
    /// Where the numbers come from.
    pub source: &'static str,
    /// How we hold them.
    pub provenance: Provenance,
    /// A nautical mile as the requirement on the aircraft writes it; the budget's is exact.
    pub nautical_mile: Metres,
    /// Body geometry in straight flight.
    pub body_geometry: Metres,
    /// Precision of a waypoint along track.
    pub waypoint: Metres,
    /// Vertical flight technical error.
    pub fte: Metres,
    /// Altimetry system error by the altitude H: quadratic \[1/m\], linear \[1\] and constant \[m\] coefficient.
    pub altimetry: [f64; 3],
    /// Altimeter setting as it is transmitted.
    pub atis: Metres,
}

/// FAA Order 8260.52.
pub const FEET: Constants = Constants {
    id: "feet",
    source: "FAA Order 8260.52 (2005), appendix 1, last page, with its worked example",
    provenance: Provenance::Printed,
    nautical_mile: Metres::new(6076.115 * FT),
    body_geometry: Metres::new(25.0 * FT),
    waypoint: Metres::new(60.0 * FT),
    fte: Metres::new(75.0 * FT),
    altimetry: [-8.8e-8 / FT, 6.5e-3, 50.0 * FT],
    atis: Metres::new(20.0 * FT),
};

/// ICAO Doc 9905; its text was not read.
pub const METRES: Constants = Constants {
    id: "metres",
    source: "ICAO Doc 9905; the text was not read",
    provenance: Provenance::Inferred,
    nautical_mile: Metres::nautical_miles(1.0),
    body_geometry: Metres::new(7.6),
    waypoint: Metres::new(18.0),
    fte: Metres::new(23.0),
    altimetry: [-2.887e-7, 6.5e-3, 15.0],
    atis: Metres::new(6.0),
};

impl Constants {
    /// Altimetry system error at an altitude above the sea.
    fn altimetry_at(&self, altitude: Metres) -> f64 {
        let h = altitude.m();
        (self.altimetry[0] * h + self.altimetry[1]) * h + self.altimetry[2]
    }
}

/// Where on an approach.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Approach {
    /// RNP of the leg.
    pub rnp: Metres,
    /// Vertical path angle, positive for a descent.
    pub angle: Radians,
    /// Altitude above the sea.
    pub altitude: Metres,
    /// Elevation of the landing threshold.
    pub threshold: Metres,
}

/// Altitudes above the sea at which the altimetry term is defined \[m\]. Provenance: ours.
const ALTITUDES_M: (f64, f64) = (-2000.0, 11_000.0);

impl Approach {
    fn check(&self) -> Result<(), OutOfDomain> {
        let refuse = |argument, value, unit, domain| Err(OutOfDomain { argument, value, unit, domain });
        let within = |h: f64| h >= ALTITUDES_M.0 && h <= ALTITUDES_M.1;
        if !(self.rnp.m() >= 0.0 && self.rnp.m().is_finite()) {
            return refuse("rnp_m", self.rnp.m(), "m", "[0, inf)");
        }
        if !(self.angle.rad() > ANGLE_STEP.rad() && self.angle.rad() < FRAC_PI_2) {
            return refuse("angle_rad", self.angle.rad(), "rad", "(1.7e-4, pi/2)");
        }
        if !within(self.threshold.m()) {
            return refuse("threshold_m", self.threshold.m(), "m", "[-2000, 11000]");
        }
        if !(within(self.altitude.m()) && self.altitude >= self.threshold) {
            return refuse("altitude_m", self.altitude.m(), "m", "from the threshold to 11000");
        }
        Ok(())
    }
}

/// Every term of the budget, and their sum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Budget {
    /// Actual navigation performance along track, by the slope.
    pub anpe: Metres,
    /// Waypoint precision.
    pub wpr: Metres,
    /// Flight technical error.
    pub fte: Metres,
    /// Altimetry system error.
    pub ase: Metres,
    /// Vertical angle error.
    pub vae: Metres,
    /// Transmitted setting.
    pub atis: Metres,
    /// Root of the sum of the squares of the six: three standard deviations.
    pub root_sum_square: Metres,
    /// The budget.
    pub total: Metres,
}

impl Budget {
    /// The budget at a place of an approach.
    ///
    /// ```text
    /// VEB = bg - isad + 4/3 sqrt(anpe² + wpr² + fte² + ase² + vae² + atis²)
    /// anpe = 1.225 RNP tan a    wpr = w tan a    vae = (H - LTP)/tan a (tan a - tan(a - 0.01°))
    /// ```
    ///
    /// Source: FAA Order 8260.52, appendix 1 (printed); `anpe` re-derived from its example. `isad` is the effect of temperature, negative in
    /// cold air: true height less indicated height.
    ///
    /// # Errors
    /// [`OutOfDomain`] for a number outside its domain, named.
    pub fn new(constants: &Constants, at: &Approach, body_geometry: Metres, isad: Metres) -> Result<Self, OutOfDomain> {
        at.check()?;
        if !(body_geometry.m() >= 0.0 && body_geometry.m().is_finite()) {
            return Err(OutOfDomain { argument: "body_geometry_m", value: body_geometry.m(), unit: "m", domain: "[0, inf)" });
        }
        if !isad.m().is_finite() {
            return Err(OutOfDomain { argument: "isad_m", value: isad.m(), unit: "m", domain: "(-inf, inf)" });
        }
        let slope = tan(at.angle.rad());
        let anpe = ALONG_TRACK * at.rnp.m() * slope;
        let wpr = constants.waypoint.m() * slope;
        let ase = constants.altimetry_at(at.altitude);
        let lower = tan(at.angle.rad() - ANGLE_STEP.rad());
        let vae = (at.altitude.m() - at.threshold.m()) / slope * (slope - lower);
        let (fte, atis) = (constants.fte.m(), constants.atis.m());
        let root = sqrt(anpe * anpe + wpr * wpr + fte * fte + ase * ase + vae * vae + atis * atis);
        let m = Metres::new;
        Ok(Self {
            anpe: m(anpe),
            wpr: m(wpr),
            fte: m(fte),
            ase: m(ase),
            vae: m(vae),
            atis: m(atis),
            root_sum_square: m(root),
            total: m(body_geometry.m() - isad.m() + THREE_TO_FOUR * root),
        })
    }
}

/// Body geometry in a turn: semispan times the sine of the bank (printed, by the example of FAA Order 8260.52).
///
/// # Errors
/// [`OutOfDomain`] for a semispan below zero or a bank outside \[0, pi/2).
pub fn turn_geometry(semispan: Metres, bank: Radians) -> Result<Metres, OutOfDomain> {
    if !(semispan.m() >= 0.0 && semispan.m().is_finite()) {
        return Err(OutOfDomain { argument: "semispan_m", value: semispan.m(), unit: "m", domain: "[0, inf)" });
    }
    if !(bank.rad() >= 0.0 && bank.rad() < FRAC_PI_2) {
        return Err(OutOfDomain { argument: "bank_rad", value: bank.rad(), unit: "rad", domain: "[0, pi/2)" });
    }
    Ok(Metres::new(semispan.m() * sin(bank.rad())))
}

/// What 99.7 % of an aircraft's vertical errors have to be below, standard air.
///
/// ```text
/// sqrt[(1.225 RNP tan a)² + (w tan a)² + fte² + ase²]
/// ```
///
/// Source: FAA AC 90-101A, the same as EASA AMC 20-26; provenance: standard, the text was not read. It is the budget's root without angle
/// and setting.
///
/// # Errors
/// [`OutOfDomain`] for a number outside its domain; level flight (an angle of zero) is allowed here.
pub fn requirement(constants: &Constants, rnp: Metres, angle: Radians, altitude: Metres) -> Result<Metres, OutOfDomain> {
    if !(angle.rad() >= 0.0 && angle.rad() < FRAC_PI_2) {
        return Err(OutOfDomain { argument: "angle_rad", value: angle.rad(), unit: "rad", domain: "[0, pi/2)" });
    }
    // Of an angle that the budget accepts: the angle is checked above.
    Approach { rnp, angle: Radians::new(0.05), altitude, threshold: Metres::new(ALTITUDES_M.0) }.check()?;
    let slope = tan(angle.rad());
    let along = ALONG_TRACK * (rnp.m() / Metres::nautical_miles(1.0).m()) * constants.nautical_mile.m() * slope;
    let terms = [along, constants.waypoint.m() * slope, constants.fte.m(), constants.altimetry_at(altitude)];
    Ok(Metres::new(sqrt(terms.iter().map(|t| t * t).sum())))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ft(feet: f64) -> Metres {
        Metres::new(feet * FT)
    }

    /// FAA Order 8260.52: RNP 0.14, 3 degrees, 4500 ft, threshold 1200 ft, semispan 68 ft at 18 degrees, isad as printed.
    #[test]
    fn the_printed_example_is_met_to_its_digits() {
        let at = Approach { rnp: Metres::nautical_miles(0.14), angle: Radians::degrees(3.0), altitude: ft(4500.0), threshold: ft(1200.0) };
        let bg = turn_geometry(ft(68.0), Radians::degrees(18.0)).unwrap();
        let b = Budget::new(&FEET, &at, bg, ft(-174.5432)).unwrap();
        let printed =
            [(b.anpe, 54.6117), (b.wpr, 3.1445), (b.fte, 75.0), (b.ase, 77.468), (b.vae, 11.02), (b.atis, 20.0), (b.total, 359.6163)];
        for (term, feet) in printed {
            // Half of the last printed digit.
            assert!((term.m() / FT - feet).abs() <= 5.01e-5, "{} {feet}", term.m() / FT);
        }
    }

    #[test]
    fn the_two_texts_are_within_a_percent_and_not_the_same() {
        let at = Approach { rnp: Metres::nautical_miles(0.3), angle: Radians::degrees(3.0), altitude: ft(3000.0), threshold: ft(500.0) };
        let [feet, metres] = [FEET, METRES].map(|c| Budget::new(&c, &at, c.body_geometry, Metres::new(0.0)).unwrap().total.m());
        assert!(feet != metres && (feet / metres - 1.0).abs() < 0.01, "{feet} {metres}");
    }

    #[test]
    fn the_requirement_is_the_root_without_angle_and_setting() {
        let at = Approach { rnp: Metres::nautical_miles(0.3), angle: Radians::degrees(3.5), altitude: ft(3000.0), threshold: ft(500.0) };
        let b = Budget::new(&FEET, &at, ft(25.0), ft(0.0)).unwrap();
        let expected = (b.root_sum_square.m().powi(2) - b.vae.m().powi(2) - b.atis.m().powi(2)).sqrt();
        let limit = requirement(&FEET, at.rnp, at.angle, at.altitude).unwrap().m();
        // A nautical mile of 6076.115 ft is short by 8e-8.
        assert!((limit - expected).abs() < 1e-7 * expected);
        assert!(requirement(&FEET, at.rnp, Radians::new(0.0), at.altitude).unwrap().m() < limit);
    }

    #[test]
    fn numbers_outside_their_domain_are_named() {
        let at = Approach { rnp: ft(600.0), angle: Radians::degrees(3.0), altitude: ft(3000.0), threshold: ft(500.0) };
        let named = |at: &Approach| Budget::new(&FEET, at, ft(25.0), ft(0.0)).unwrap_err().argument;
        assert_eq!(named(&Approach { rnp: Metres::new(f64::NAN), ..at }), "rnp_m");
        assert_eq!(named(&Approach { rnp: Metres::new(-1.0), ..at }), "rnp_m");
        assert_eq!(named(&Approach { angle: Radians::degrees(0.009), ..at }), "angle_rad");
        assert_eq!(named(&Approach { angle: Radians::new(2.0), ..at }), "angle_rad");
        // A path of no angle to the last digit, and one straight down.
        assert_eq!(named(&Approach { angle: ANGLE_STEP, ..at }), "angle_rad");
        assert_eq!(named(&Approach { angle: Radians::new(FRAC_PI_2), ..at }), "angle_rad");
        assert_eq!(named(&Approach { threshold: Metres::new(-2001.0), ..at }), "threshold_m");
        let lowest = Approach { threshold: Metres::new(-2000.0), altitude: Metres::new(11_000.0), ..at };
        assert!(Budget::new(&FEET, &lowest, ft(25.0), ft(0.0)).is_ok());
        assert_eq!(named(&Approach { altitude: ft(499.0), ..at }), "altitude_m");
        assert_eq!(named(&Approach { altitude: Metres::new(f64::INFINITY), ..at }), "altitude_m");
        assert_eq!(Budget::new(&FEET, &at, ft(-1.0), ft(0.0)).unwrap_err().argument, "body_geometry_m");
        assert_eq!(Budget::new(&FEET, &at, ft(25.0), ft(f64::NAN)).unwrap_err().argument, "isad_m");
        assert_eq!(turn_geometry(ft(-1.0), Radians::new(0.1)).unwrap_err().argument, "semispan_m");
        assert_eq!(turn_geometry(ft(60.0), Radians::new(-0.1)).unwrap_err().argument, "bank_rad");
        assert_eq!(requirement(&FEET, at.rnp, Radians::new(-0.1), at.altitude).unwrap_err().argument, "angle_rad");
        assert_eq!(requirement(&FEET, at.rnp, at.angle, Metres::new(2e4)).unwrap_err().argument, "altitude_m");
    }
}
