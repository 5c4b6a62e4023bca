//! Models of the ionosphere that a single frequency can use, and what each states of the sky over a receiver.

use super::atmosphere::klobuchar_towards;
use super::ntcm::{self, Ntcm, ionisation_level};
use crate::frame::Geodetic;
use crate::quantity::GpsTime;
use crate::signal::Klobuchar;
use crate::special::float::asin;
use core::f64::consts::PI;
use nalgebra::Vector3;

/// Long-run mean of the solar radio flux and how far it strays from it \[sfu\]: F10.7 over the solar cycles since 1947. Inferred.
pub const MEAN_ACTIVITY_SFU: f64 = 130.0;
/// Standard deviation about [`MEAN_ACTIVITY_SFU`]. Inferred; widened until a day at 218 sfu was covered.
pub const SPREAD_ACTIVITY_SFU: f64 = 70.0;
/// Vertical delay that a unit of solar activity can reach over the Earth \[m/sfu\]. Inferred: messages of 47 sfu with 1.6 m, of 164 sfu with
/// 6.2 to 7.7 m.
const REACH_M_PER_SFU: f64 = 0.04;

/// What corrects the ionosphere of one frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Ionosphere {
    /// The GPS message; made by [`Ionosphere::broadcast`].
    Broadcast {
        /// The message.
        message: Klobuchar,
        /// The largest daily delay overhead that it states anywhere \[m\].
        activity_m: f64,
    },
    /// NTCM-G at the effective ionisation level of Galileo's message; made by [`Ionosphere::galileo`].
    Ntcm {
        /// \[sfu\]
        level_sfu: f64,
    },
    /// NTCM-G at the long-run mean of solar activity: nobody has stated what the activity is.
    Climatology,
    /// Nothing is corrected; what the climatology would correct is error.
    Uncorrected,
}

/// A model over one receiver at one instant.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Overhead {
    slant: Slant,
    here: Geodetic,
    time: GpsTime,
    /// Modelled vertical delay at the receiver, on L1 \[m\]; of the climatology where nothing is corrected.
    pub(crate) vertical_m: f64,
    /// What the message states of the sun \[m\].
    pub(crate) activity_m: f64,
    /// Geomagnetic latitude of the receiver \[rad\].
    pub(crate) magnetic_lat: f64,
    pub(crate) kind: Kind,
}

/// What the error of a model depends on beside its delay.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Broadcast,
    Ntcm,
    Climatology,
    Uncorrected,
}

#[derive(Debug, Clone, Copy)]
enum Slant {
    Broadcast(Klobuchar),
    Ntcm(Ntcm),
    Nothing,
}

impl Ionosphere {
    /// From the GPS message; `None` where no satellite can have sent it ([`Klobuchar::implausible`]), which is no model.
    pub fn broadcast(message: Klobuchar) -> Option<Self> {
        let activity_m = message.activity_m();
        message.implausible().is_none().then_some(Self::Broadcast { message, activity_m })
    }

    /// From Galileo's coefficients \[sfu, sfu/deg, sfu/deg²\]; `None` where they are all zero.
    pub fn galileo(coefficients: [f64; 3]) -> Option<Self> {
        ionisation_level(coefficients).map(|level_sfu| Self::Ntcm { level_sfu })
    }

    /// Whether a message describes the ionosphere of the day; without one a height can be wrong by metres.
    pub const fn is_described(&self) -> bool {
        matches!(self, Self::Broadcast { .. } | Self::Ntcm { .. })
    }

    /// The model over a receiver.
    pub(crate) fn over(&self, here: &Geodetic, time: GpsTime) -> Overhead {
        let (lat, lon) = (here.point.lat().rad(), here.point.lon().rad());
        let closed = |level_sfu: f64| {
            let model = Ntcm::new(level_sfu, time);
            (model, model.vertical(lat, lon) * ntcm::metres_per_tecu(), REACH_M_PER_SFU * level_sfu)
        };
        let (slant, vertical_m, activity_m, kind) = match *self {
            Self::Broadcast { message, activity_m } => {
                let overhead = klobuchar_towards(&message, here, PI / 2.0, (0.0, 1.0), time).m();
                (Slant::Broadcast(message), overhead, activity_m, Kind::Broadcast)
            }
            Self::Ntcm { level_sfu } => {
                let (model, vertical_m, activity_m) = closed(level_sfu);
                (Slant::Ntcm(model), vertical_m, activity_m, Kind::Ntcm)
            }
            Self::Climatology | Self::Uncorrected => {
                let (model, vertical_m, activity_m) = closed(MEAN_ACTIVITY_SFU);
                let uncorrected = matches!(self, Self::Uncorrected);
                let slant = if uncorrected { Slant::Nothing } else { Slant::Ntcm(model) };
                (slant, vertical_m, activity_m, if uncorrected { Kind::Uncorrected } else { Kind::Climatology })
            }
        };
        Overhead { slant, here: *here, time, vertical_m, activity_m, magnetic_lat: ntcm::magnetic_latitude(lat, lon), kind }
    }
}

impl Overhead {
    /// Delay on L1 along a line of sight, unit vector east-north-up \[m\].
    pub(crate) fn delay(&self, unit: &Vector3<f64>) -> f64 {
        let elevation = asin(unit.z.clamp(-1.0, 1.0));
        match &self.slant {
            Slant::Nothing => 0.0,
            Slant::Broadcast(message) => {
                let level = crate::special::float::sqrt(unit.x * unit.x + unit.y * unit.y);
                // Overhead every azimuth is as good.
                let azimuth = if level > 0.0 { (unit.x / level, unit.y / level) } else { (0.0, 1.0) };
                klobuchar_towards(message, &self.here, elevation, azimuth, self.time).m()
            }
            Slant::Ntcm(model) => model.slant(&self.here, elevation, (unit.x, unit.y)) * ntcm::metres_per_tecu(),
        }
    }
}

/// Radius of the Earth and height of the ionosphere's shell in the grid of SBAS \[m\]. Provenance: standard (DO-229 appendix A.4.4.10).
pub const EARTH_M: f64 = 6_378_136.3;
/// See [`EARTH_M`].
pub const SHELL_M: f64 = 350_000.0;

/// Square of the obliquity factor of the ionospheric shell, from the square of the elevation's cosine.
///
/// ```text
/// F_pp = (1 - (Re cos E / (Re + h_I))^2)^-1/2
/// ```
pub fn obliquity_squared(cos_el_squared: f64) -> f64 {
    let ratio = EARTH_M / (EARTH_M + SHELL_M);
    1.0 / (1.0 - ratio * ratio * cos_el_squared)
}

#[cfg(test)]
#[path = "ionosphere_tests.rs"]
mod tests;
