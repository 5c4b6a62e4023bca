//! What became of every satellite that a receiver heard, for those who look at the sky.

use super::ranges::Unused;
use nalgebra::Vector3;
use navbound_core::frame::Geodetic;
use navbound_core::geometry::{Direction, Observer};
use navbound_core::quantity::Radians;
use navbound_core::signal::SatelliteId;
use navbound_core::solution::consistency::Consistency;
use navbound_core::solution::led_off::Compared;
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

impl Heard {
    /// One that is not to be used.
    fn unused((satellite, why): &(SatelliteId, Unused)) -> Self {
        Self { satellite: *satellite, direction: None, cn0_dbhz: f64::NAN, fate: Fate::Unused(*why) }
    }
}

/// A satellite at an epoch that a monitor judged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tested {
    /// What became of it.
    pub heard: Heard,
    /// Measured less computed range at the monitor's position, with the clocks of all satellites' position; NaN for one below the mask \[m\].
    pub residual_m: f64,
    /// Standard deviation of the range for accuracy; NaN likewise \[m\].
    pub sigma_m: f64,
}

/// Residuals of all satellites above the mask at an epoch, before any is excluded.
#[derive(Debug, Clone)]
pub struct Residuals {
    /// The satellites, to compare their codes with their phases, too.
    pub compared: Vec<Compared>,
    /// The residual of each \[m\].
    pub residuals_m: Vec<f64>,
    /// All against the error model for accuracy, where there are enough.
    pub consistency: Option<Consistency>,
}

impl Residuals {
    /// A satellite with its residual \[m\].
    fn of(&self, satellite: SatelliteId) -> Option<(&Compared, f64)> {
        self.compared.iter().zip(self.residuals_m.iter().copied()).find(|(c, _)| c.satellite == satellite)
    }
}

/// What a monitor made of an epoch's satellites.
#[derive(Debug, Clone, Copy)]
pub struct Judged<'a> {
    /// The position.
    pub position: &'a Geodetic,
    /// Residuals where all satellites put the receiver.
    pub residuals: &'a Residuals,
    /// From there to the position: east, north, up \[m\].
    pub step_m: [f64; 3],
    /// Those that were excluded.
    pub excluded: &'a [SatelliteId],
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
    /// What became of each with a monitor; `None` where there is no position.
    pub(crate) fn tested(&self, judged: Option<&Judged<'_>>) -> Vec<Tested> {
        let here = judged.map(|j| Observer::new(j.position));
        let one = |r: &Range| {
            let direction = here.and_then(|h| h.direction(&r.position).ok());
            let (fate, [residual_m, sigma_m]) = match judged {
                None => (Fate::NoPosition, [f64::NAN; 2]),
                Some(j) => match j.residuals.of(r.satellite) {
                    None => (Fate::Unused(Unused::BelowMask), [f64::NAN; 2]),
                    Some((c, residual_m)) => {
                        let fate = if j.excluded.contains(&r.satellite) { Fate::Excluded } else { Fate::Used };
                        // The computed range is shorter by what the step points to the satellite.
                        (fate, [residual_m + c.unit.dot(&Vector3::from(j.step_m)), 1.0 / c.weight.sqrt()])
                    }
                },
            };
            Tested { heard: Heard { satellite: r.satellite, direction, cn0_dbhz: r.cn0_dbhz, fate }, residual_m, sigma_m }
        };
        let without = self.unused.iter().map(|left| Tested { heard: Heard::unused(left), residual_m: f64::NAN, sigma_m: f64::NAN });
        self.ranges.iter().map(one).chain(without).collect()
    }

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
        self.ranges.iter().map(one).chain(self.unused.iter().map(Heard::unused)).collect()
    }
}
