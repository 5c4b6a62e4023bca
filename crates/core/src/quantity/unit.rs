//! Lengths, angles and risks.

use super::OutOfDomain;

/// Metres in one international nautical mile, exact by definition.
const METRES_PER_NAUTICAL_MILE: f64 = 1852.0;

/// Metres per second of a knot, exact by definition.
pub const KNOT_MPS: f64 = METRES_PER_NAUTICAL_MILE / 3600.0;

/// A length \[m\].
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd, Default)]
pub struct Metres(f64);

impl Metres {
    /// A length given in metres.
    pub const fn new(m: f64) -> Self {
        Self(m)
    }
    /// A length given in nautical miles (1 NM = 1852 m exactly).
    pub const fn nautical_miles(nm: f64) -> Self {
        Self(nm * METRES_PER_NAUTICAL_MILE)
    }
    /// A length given in feet (1 ft = 0.3048 m exactly).
    pub const fn feet(ft: f64) -> Self {
        Self(ft * 0.3048)
    }
    /// The number of metres.
    pub const fn m(self) -> f64 {
        self.0
    }
}

/// An angle \[rad\]. Courses are clockwise from true north; elevations and path angles are positive upwards.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd, Default)]
pub struct Radians(f64);

impl Radians {
    /// An angle given in radians.
    pub const fn new(rad: f64) -> Self {
        Self(rad)
    }
    /// An angle given in degrees.
    pub const fn degrees(deg: f64) -> Self {
        Self(deg.to_radians())
    }
    /// The number of radians.
    pub const fn rad(self) -> f64 {
        self.0
    }
    /// A course. Headings are written from minus half a turn to a whole one; a number beyond is mostly one of degrees.
    ///
    /// # Errors
    /// [`OutOfDomain`] beyond one turn, or not a number.
    pub fn course(self) -> Result<Self, OutOfDomain> {
        if self.0.abs() <= core::f64::consts::TAU {
            Ok(self)
        } else {
            Err(OutOfDomain { argument: "course_rad", value: self.0, unit: "rad", domain: "[-2 pi, 2 pi]; degrees?" })
        }
    }
}

/// An allowed risk q = 1 - P, at most one half: a bound that more errors leave than keep bounds nothing, and a number near one is a
/// confidence. A probability near one has lost its digits before it is stored: 1 - 1e-9 as a double carries a relative error of 1e-7 in
/// the risk. Probabilities that may come near one (of exceedance, of a missed detection at an error) are plain numbers, not risks.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct Risk(f64);

impl Risk {
    /// The 95 % accuracy level of every navigation specification.
    pub const ACCURACY: Self = Self(0.05);
    /// The 99.999 % containment level of RNP.
    pub const INTEGRITY: Self = Self(1e-5);
    /// The integrity risk of an approach with vertical guidance.
    pub const APPROACH_INTEGRITY: Self = Self(2e-7);
    /// The integrity risk of an hour from en route to non-precision approach.
    pub const HOUR_INTEGRITY: Self = Self(1e-7);
    /// The continuity risk of 15 s of an approach with vertical guidance.
    pub const APPROACH_CONTINUITY: Self = Self(8e-6);
    /// The largest continuity risk of an hour from en route to non-precision approach.
    pub const HOUR_CONTINUITY: Self = Self(1e-4);
    /// The integrity risk of a sub-phase of surface movement (inferred).
    pub const SURFACE_INTEGRITY: Self = Self(1.25e-9);
    /// The continuity risk of a sub-phase of surface movement (inferred).
    pub const SURFACE_CONTINUITY: Self = Self(1.25e-5);
    /// The risk that an aircraft on the ground leaves the containment of its sub-phase.
    pub const SURFACE_CONTAINMENT: Self = Self(1e-6);

    /// The risk that a navigation filter's gate throws away a good measurement.
    pub const FILTER_GATE: Self = Self(1e-4);
    /// The risk that two navigation filters that are right are said to disagree, at an instant.
    pub const SEPARATION: Self = Self(1e-7);

    /// The smallest risk: below it products of two tails leave the range of a double.
    pub const LEAST: f64 = 1e-300;
    /// The largest risk.
    pub const MOST: f64 = 0.5;
    /// Both as refusals say them.
    pub const DOMAIN: &str = "[1e-300, 0.5]";

    /// A risk inside its domain.
    ///
    /// # Errors
    /// [`OutOfDomain`] unless `1e-300 <= q <= 0.5`; for a number between 0.5 and 1 the refusal asks whether a confidence was meant.
    pub fn new(q: f64) -> Result<Self, OutOfDomain> {
        if !(Self::LEAST..=Self::MOST).contains(&q) {
            return Err(OutOfDomain { argument: "risk", value: q, unit: "1", domain: Self::DOMAIN });
        }
        Ok(Self(q))
    }
    /// A risk written in the source of this crate.
    pub(crate) const fn constant(q: f64) -> Self {
        debug_assert!(q >= Self::LEAST && q <= Self::MOST);
        Self(q)
    }
    /// The risk as a number.
    pub const fn q(self) -> f64 {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    extern crate std;
    use std::string::ToString;

    #[test]
    fn a_risk_is_at_most_one_half_and_not_below_the_range_of_its_products() {
        for q in [1e-300, 1e-5, 0.05, 0.5] {
            assert_eq!(Risk::new(q).map(Risk::q), Ok(q));
        }
        for q in [f64::NAN, f64::INFINITY, -0.1, 0.0, 5e-324, 9.9e-301, 0.500_000_1, 0.95, 1.0, 2.0] {
            assert!(Risk::new(q).is_err(), "{q}");
        }
    }

    #[test]
    fn a_confidence_in_the_place_of_a_risk_is_refused() {
        let words = |q: f64| Risk::new(q).unwrap_err().to_string();
        assert_eq!(words(0.99999), "risk = 0.99999 [1] is outside [1e-300, 0.5]: risk is 1 - confidence; did you mean 1e-05?");
        assert!(words(0.95).ends_with("did you mean 0.05?"), "{}", words(0.95));
        assert!(words(1.0 - 1e-7).ends_with("did you mean 1e-07?"), "{}", words(1.0 - 1e-7));
        assert_eq!(words(1.5), "risk = 1.5 [1] is outside [1e-300, 0.5]");
        assert_eq!(words(1.0), "risk = 1 [1] is outside [1e-300, 0.5]");
    }
}
