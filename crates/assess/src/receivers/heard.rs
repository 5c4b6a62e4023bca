//! What became of every satellite that a receiver heard, for those who look at the sky.

use super::ranges::Unused;
use navbound_core::geometry::{Direction, Observer};
use navbound_core::quantity::Radians;
use navbound_core::signal::SatelliteId;
use navbound_core::solution::point::{Fix, Range};

/// What became of a satellite at an epoch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fate {
    /// In the position.
    Used,
    /// Left out because the ranges contradicted each other.
    Excluded,
    /// It could be used, and there is no position.
    NoPosition,
    /// Not to be used.
    Unused(Unused),
}

impl Fate {
    /// Those that are no [`Unused`].
    pub const OWN: [Self; 3] = [Self::Used, Self::Excluded, Self::NoPosition];

    /// The name in tables.
    pub const fn id(self) -> &'static str {
        match self {
            Self::Used => "used",
            Self::Excluded => "excluded",
            Self::NoPosition => "no_position",
            Self::Unused(why) => why.id(),
        }
    }

    /// The words for a reader.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Used => "used",
            Self::Excluded => "excluded by the residual test: its range contradicts the others",
            Self::NoPosition => "could be used, but no position was found",
            Self::Unused(why) => why.words(),
        }
    }
}

/// A satellite that was heard at an epoch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Heard {
    /// Which.
    pub satellite: SatelliteId,
    /// Where it stands; `None` without an orbit or a position.
    pub direction: Option<Direction>,
    /// Carrier to noise density \[dB Hz\]; NaN where the receiver does not say.
    pub cn0_dbhz: f64,
    /// What became of it.
    pub fate: Fate,
}

/// What was heard at one epoch, before anybody knows what became of it.
#[derive(Debug, Clone, Default)]
pub(crate) struct Listed {
    /// Satellites with a range.
    pub(crate) ranges: Vec<Range>,
    /// Those without one, and why.
    pub(crate) unused: Vec<(SatelliteId, Unused)>,
}

impl Listed {
    /// What became of each, where these satellites are in the position.
    pub(crate) fn fates(&self, fix: Option<&Fix>, used: &[SatelliteId], mask: Radians) -> Vec<Heard> {
        let here = fix.map(|f| Observer::new(&f.position));
        let has = |r: &Range| used.iter().any(|s| s.constellation == r.satellite.constellation);
        let one = |r: &Range| {
            let direction = here.and_then(|h| h.direction(&r.position).ok());
            let fate = match direction {
                _ if used.contains(&r.satellite) => Fate::Used,
                None => Fate::NoPosition,
                Some(d) if d.elevation() < mask => Fate::Unused(Unused::BelowMask),
                // Of a constellation that was left out no satellite is used.
                Some(_) if !has(r) => Fate::Unused(Unused::ConstellationLeftOut),
                Some(_) => Fate::Excluded,
            };
            Heard { satellite: r.satellite, direction, cn0_dbhz: r.cn0_dbhz, fate }
        };
        let without = |(satellite, why): &(SatelliteId, Unused)| Heard {
            satellite: *satellite,
            direction: None,
            cn0_dbhz: f64::NAN,
            fate: Fate::Unused(*why),
        };
        self.ranges.iter().map(one).chain(self.unused.iter().map(without)).collect()
    }
}
