//! What an aircraft claims of its own position, and the bounds that a claim stands for.

use crate::assumed::circle;
use navbound_core::quantity::Reason;

/// Categories of a table: 0 to 11.
pub const CATEGORIES: usize = 12;

/// Categories as the aircraft states them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Claim {
    /// Navigation integrity category.
    pub nic: Option<u8>,
    /// Navigation accuracy category for position.
    pub nac_p: Option<u8>,
    /// Source integrity level.
    pub sil: Option<u8>,
}

/// What the categories stand for. The tables are the package's, which reads recordings by the same.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Claims {
    /// Standard deviation of an axis by NACp \[m\]; NaN where the category is none.
    pub sigma_m: [f64; CATEGORIES],
    /// Radius of containment by NIC \[m\]; NaN where it is unbounded.
    pub containment_m: [f64; CATEGORIES],
    /// Least SIL whose risk is no larger than the integrity risk: below it the radius bounds nothing.
    pub least_sil: u8,
}

/// Bounds of one position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Bounds {
    sigma_m: f64,
    pub(crate) containment_m: f64,
}

impl Bounds {
    pub(crate) fn covariance_m2(self) -> [f64; 6] {
        circle(self.sigma_m * self.sigma_m)
    }
}

/// The length of a category; `None` for one that has none.
fn of(table: &[f64; CATEGORIES], category: Option<u8>) -> Option<f64> {
    category.and_then(|category| table.get(usize::from(category)).copied()).filter(|length| length.is_finite())
}

impl Claims {
    /// The bounds of a claim.
    ///
    /// # Errors
    /// What is not claimed.
    pub(crate) fn bounds(&self, claim: Claim) -> Result<Bounds, Reason> {
        self.bounds_within(claim, of(&self.containment_m, claim.nic))
    }

    /// The bounds of a claim beside which a radius of containment stands \[m\]: by the rule of recordings it counts before the category, one
    /// of 0 is none, and beside a category that is none no radius is one.
    ///
    /// # Errors
    /// What is not claimed.
    pub(crate) fn bounds_beside(&self, claim: Claim, radius_m: Option<f64>) -> Result<Bounds, Reason> {
        let Some(radius_m) = radius_m else { return self.bounds(claim) };
        let contained = radius_m > 0.0 && radius_m.is_finite() && claim.nic != Some(0);
        self.bounds_within(claim, contained.then_some(radius_m))
    }

    /// The bounds of a claim whose radius of containment is known more closely than by its category \[m\].
    ///
    /// # Errors
    /// What is not claimed.
    pub(crate) fn bounds_within(&self, claim: Claim, radius_m: Option<f64>) -> Result<Bounds, Reason> {
        let sigma_m = of(&self.sigma_m, claim.nac_p).ok_or(Reason::NoAccuracyCategory)?;
        let sure = claim.sil.is_some_and(|sil| (self.least_sil..=3).contains(&sil));
        let containment_m = radius_m.filter(|_| sure).ok_or(Reason::NoIntegrityClaim)?;
        Ok(Bounds { sigma_m, containment_m })
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    const NONE: f64 = f64::NAN;
    /// Only what the tests use, in numbers of their own.
    pub(crate) const CLAIMS: Claims = Claims {
        sigma_m: [NONE, NONE, NONE, NONE, NONE, NONE, NONE, NONE, 40.0, 12.0, 4.0, 1.0],
        containment_m: [NONE, 37_040.0, NONE, NONE, NONE, NONE, 1111.2, 370.4, 185.2, 75.0, 25.0, 7.5],
        least_sil: 2,
    };

    #[test]
    fn a_level_beyond_three_is_no_level() {
        let claim = Claim { nic: Some(6), nac_p: Some(8), sil: Some(2) };
        assert_eq!(CLAIMS.bounds(claim).map(|bounds| bounds.containment_m), Ok(1111.2));
        assert_eq!(CLAIMS.bounds(Claim { sil: Some(4), ..claim }), Err(Reason::NoIntegrityClaim));
        assert_eq!(CLAIMS.bounds(Claim { nac_p: Some(12), ..claim }), Err(Reason::NoAccuracyCategory));
    }
}
