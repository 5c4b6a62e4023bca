//! A station seen from the aircraft: distance, direction, and whether it serves there.

use super::{Admission, Horizon};
use crate::frame::{Displacement, EcefPosition, Enu, Geodetic, ecef_from_geodetic, enu_from_ecef};
use crate::quantity::{Metres, OutOfDomain, Radians};
use crate::special::float::{atan2, hypot};
use nalgebra::{Matrix3, Vector3};

/// A position with its local axes, worked out once for many lines of sight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    pub(super) geodetic: Geodetic,
    pub(super) ecef: EcefPosition,
    /// Rows east, north, up.
    pub(super) axes: Matrix3<f64>,
}

impl Place {
    /// The place of a position.
    ///
    /// # Errors
    /// [`OutOfDomain`] unless the height is finite.
    pub fn new(geodetic: Geodetic) -> Result<Self, OutOfDomain> {
        let h = geodetic.height.m();
        if !h.is_finite() {
            return Err(OutOfDomain { argument: "h_m", value: h, unit: "m", domain: "(-inf, inf)" });
        }
        Ok(Self { geodetic, ecef: ecef_from_geodetic(&geodetic), axes: enu_from_ecef(&geodetic.point) })
    }
    /// The position.
    pub fn geodetic(&self) -> &Geodetic {
        &self.geodetic
    }
    /// Bearing of another place seen from here, clockwise from true north.
    pub fn bearing_of(&self, other: &Self) -> Radians {
        let seen = self.axes * (other.ecef.vector() - self.ecef.vector());
        Radians::new(atan2(seen.x, seen.y))
    }
    /// Its Cartesian form.
    pub fn ecef(&self) -> &EcefPosition {
        &self.ecef
    }
}

/// A station of the network.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Station {
    /// Where its antenna is.
    pub place: Place,
    /// Largest slant range of its published service volume.
    pub service: Metres,
    /// Whether a VOR stands beside the DME.
    pub bearing: bool,
}

impl Station {
    /// The line of sight, where the station may be used: admitted, inside its service volume and above the horizon.
    pub fn usable(&self, aircraft: &Place, admission: &Admission, horizon: &Horizon) -> Option<Sight> {
        let above = Metres::new(aircraft.geodetic.height.m() - self.place.geodetic.height.m());
        let most = self.service.m().min(horizon.reach(above).m());
        // Most stations of a large table are far beyond: the comparison comes before the axes.
        if !((aircraft.ecef.vector() - self.place.ecef.vector()).norm_squared() <= most * most) {
            return None;
        }
        Sight::between(aircraft, &self.place).filter(|sight| admission.admits(sight))
    }
}

/// A station as the aircraft sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sight {
    /// Distance along the line of sight.
    pub slant: Metres,
    /// Elevation of the aircraft seen from the station.
    pub elevation: Radians,
    /// Unit vector from the station to the aircraft, east, north, up at the aircraft.
    pub unit: Vector3<f64>,
}

impl Sight {
    /// In flat coordinates that aircraft and station share.
    ///
    /// # Errors
    /// [`OutOfDomain`] unless all coordinates are finite and the station is not straight below.
    pub fn flat(aircraft: &Displacement<Enu>, station: &Displacement<Enu>) -> Result<Self, OutOfDomain> {
        let d = aircraft.vector() - station.vector();
        let ground = hypot(d.x, d.y);
        let slant = hypot(ground, d.z);
        if !(slant.is_finite() && ground > 0.0) {
            return Err(OutOfDomain { argument: "stations_enu_m", value: ground, unit: "m from the aircraft", domain: "(0, inf)" });
        }
        Ok(Self { slant: Metres::new(slant), elevation: Radians::new(atan2(d.z, ground)), unit: d / slant })
    }
    /// Over the Earth; `None` where both are in one place.
    pub fn between(aircraft: &Place, station: &Place) -> Option<Self> {
        let d = aircraft.ecef.vector() - station.ecef.vector();
        let slant = d.norm();
        let seen = station.axes * d;
        let elevation = Radians::new(atan2(seen.z, hypot(seen.x, seen.y)));
        (slant > 0.0).then(|| Self { slant: Metres::new(slant), elevation, unit: aircraft.axes * d / slant })
    }
    /// Share of the slant range that is level.
    pub(super) fn level(&self) -> f64 {
        hypot(self.unit.x, self.unit.y)
    }
}
