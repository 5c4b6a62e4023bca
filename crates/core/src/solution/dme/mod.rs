//! DME ranges: how good one is, what a pair determines, which pair is best, when to change it, and where the aircraft is; VOR/DME beside.

mod exclude;
mod fix;
mod intersection;
mod normal;
mod pair;
mod select;
mod sight;
mod vor;

pub use exclude::{Checked, Verdict, solve_checked};
pub use fix::{Altitude, Fix, NoFix, Prior, Range, solve};
pub use normal::all_in_view;
pub use pair::{Pair, icao_two_sigma};
pub use select::{Best, Figure, Selector, Switching, best_pair};
pub use sight::{Place, Sight, Station};
pub use vor::{VorDme, VorRange, vor_dme, vor_fix};

use crate::quantity::{Metres, OutOfDomain, Radians};
use crate::special::float::{hypot, sqrt};

/// Standard deviation of a DME range: the larger of a constant and a share of the distance in the air, and the signal in space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RangeModel {
    /// Least standard deviation of the airborne part.
    pub air_least: Metres,
    /// Its share of the distance.
    pub air_share: f64,
    /// Standard deviation of the signal in space.
    pub signal: Metres,
}

impl RangeModel {
    /// 0.085 NM or 0.125 % of the distance, and 0.05 NM: half of 0.17 NM or 0.25 % at 95 %. Inferred: values of public excerpts, the text was not read.
    pub const STANDARD: Self = Self { air_least: Metres::nautical_miles(0.085), air_share: 0.00125, signal: Metres::nautical_miles(0.05) };

    /// sqrt(max(air_least, air_share * slant)^2 + signal^2) \[m\].
    ///
    /// # Errors
    /// [`OutOfDomain`] unless the slant range is in \[0, inf).
    pub fn sigma(&self, slant: Metres) -> Result<Metres, OutOfDomain> {
        if !(slant.m() >= 0.0 && slant.m().is_finite()) {
            return Err(OutOfDomain { argument: "slant_m", value: slant.m(), unit: "m", domain: "[0, inf)" });
        }
        Ok(Metres::new(hypot(self.air_least.m().max(self.air_share * slant.m()), self.signal.m())))
    }
}

/// Which pairs may be used. Inferred: values of public excerpts, the text was not read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Admission {
    /// Least angle at the aircraft between the horizontal directions to both stations; its supplement is the largest.
    pub inclusion_least: Radians,
    /// Least slant range.
    pub slant_least: Metres,
    /// Largest slant range.
    pub slant_most: Metres,
    /// Largest elevation of the aircraft seen from a station.
    pub elevation_most: Radians,
}

impl Admission {
    /// 30 to 150 degrees, 3 to 160 NM, at most 40 degrees.
    pub const STANDARD: Self = Self {
        inclusion_least: Radians::degrees(30.0),
        slant_least: Metres::nautical_miles(3.0),
        slant_most: Metres::nautical_miles(160.0),
        elevation_most: Radians::degrees(40.0),
    };

    /// Whether one station may be used at all.
    pub fn admits(&self, sight: &Sight) -> bool {
        let (slant, elevation) = (sight.slant.m(), sight.elevation.rad());
        slant >= self.slant_least.m() && slant <= self.slant_most.m() && elevation <= self.elevation_most.rad()
    }
}

/// How far radio reaches over a smooth Earth without terrain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Horizon {
    /// Radius of the Earth whose straight rays bend as much as refracted ones.
    pub effective_radius: Metres,
}

impl Horizon {
    /// Four thirds of 6371 km: 1.23 NM times the root of the height in feet. inferred, the text was not read.
    pub const STANDARD: Self = Self { effective_radius: Metres::new(4.0 / 3.0 * 6_371_000.0) };

    /// sqrt(2 R h) of an aircraft `above` the station's ground; nothing is seen from below it \[m\].
    pub fn reach(&self, above: Metres) -> Metres {
        Metres::new(sqrt(2.0 * self.effective_radius.m() * above.m().max(0.0)))
    }
}
