//! Lines of sight.

use crate::frame::{EcefPosition, Geodetic, ecef_from_geodetic, enu_from_ecef};
use crate::quantity::{Metres, OutOfDomain, Radians};
use crate::signal::Constellation;
use crate::special::float::{atan2, hypot, sin_cos};
use core::f64::consts::{FRAC_PI_2, TAU};
use nalgebra::{Matrix3, Vector3};

/// Where a satellite stands in the local sky.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Direction {
    azimuth: Radians,
    elevation: Radians,
}

/// A satellite in the solution: where it stands, how good its range is, whose clock it runs on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineOfSight {
    /// Where it stands.
    pub direction: Direction,
    /// Standard deviation of its range.
    pub sigma: Metres,
    /// Whose clock.
    pub constellation: Constellation,
}

impl Direction {
    /// A direction from its angles.
    ///
    /// # Errors
    /// [`OutOfDomain`] for an azimuth that is not finite or an elevation outside \[-pi/2, pi/2\].
    pub fn new(azimuth: Radians, elevation: Radians) -> Result<Self, OutOfDomain> {
        if !azimuth.rad().is_finite() {
            return Err(OutOfDomain { argument: "az_rad", value: azimuth.rad(), unit: "rad", domain: "finite angles" });
        }
        if !(elevation.rad().abs() <= FRAC_PI_2) {
            return Err(OutOfDomain { argument: "el_rad", value: elevation.rad(), unit: "rad", domain: "[-pi/2, pi/2]" });
        }
        Ok(Self { azimuth, elevation })
    }
    /// Azimuth, clockwise from true north.
    pub const fn azimuth(&self) -> Radians {
        self.azimuth
    }
    /// Elevation above the horizon of the ellipsoid.
    pub const fn elevation(&self) -> Radians {
        self.elevation
    }
    /// Unit vector from the receiver to the satellite, east-north-up.
    pub fn unit(&self) -> Vector3<f64> {
        let (sa, ca) = sin_cos(self.azimuth.rad());
        let (se, ce) = sin_cos(self.elevation.rad());
        Vector3::new(ce * sa, ce * ca, se)
    }
}

impl LineOfSight {
    /// A satellite whose range has a positive, finite standard deviation.
    ///
    /// # Errors
    /// [`OutOfDomain`] otherwise.
    pub fn new(direction: Direction, sigma: Metres, constellation: Constellation) -> Result<Self, OutOfDomain> {
        if !(sigma.m() > 0.0 && sigma.m().is_finite()) {
            return Err(OutOfDomain { argument: "sigma_m", value: sigma.m(), unit: "m", domain: "(0, inf)" });
        }
        Ok(Self { direction, sigma, constellation })
    }
}

/// A receiver's place and local axes, worked out once for all satellites.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Observer {
    origin: EcefPosition,
    enu_from_ecef: Matrix3<f64>,
}

impl Observer {
    /// At a position.
    pub fn new(position: &Geodetic) -> Self {
        Self { origin: ecef_from_geodetic(position), enu_from_ecef: enu_from_ecef(&position.point) }
    }

    /// Where a satellite stands. Both positions are of one instant: the 0.07 s of the signal's way move a satellite by 270 m, a change of
    /// 1e-5 rad that no bound notices.
    ///
    /// # Errors
    /// [`OutOfDomain`] for positions that are not finite.
    pub fn direction(&self, satellite: &EcefPosition) -> Result<Direction, OutOfDomain> {
        let enu = self.enu_from_ecef * satellite.minus(&self.origin).vector();
        let azimuth = atan2(enu.x, enu.y);
        let azimuth = if azimuth < 0.0 { azimuth + TAU } else { azimuth };
        Direction::new(Radians::new(azimuth), Radians::new(atan2(enu.z, hypot(enu.x, enu.y))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::LatLon;

    fn receiver() -> Geodetic {
        Geodetic { point: LatLon::new(Radians::degrees(40.0), Radians::degrees(116.0)).unwrap(), height: Metres::new(9000.0) }
    }

    #[test]
    fn a_satellite_due_east_and_one_overhead_stand_there() {
        let r = receiver();
        for (along, azimuth, elevation) in [
            (Vector3::new(2e7, 0.0, 0.0), 90.0, 0.0),
            (Vector3::new(0.0, -2e7, 2e7), 180.0, 45.0),
            (Vector3::new(0.0, 0.0, 2e7), 0.0, 90.0),
        ] {
            let c = enu_from_ecef(&r.point).transpose();
            let satellite = EcefPosition::from_vector(ecef_from_geodetic(&r).vector() + c * along);
            let d = Observer::new(&r).direction(&satellite).unwrap();
            assert!((d.elevation().rad().to_degrees() - elevation).abs() < 1e-9);
            assert!(elevation == 90.0 || (d.azimuth().rad().to_degrees() - azimuth).abs() < 1e-9);
            assert!((d.unit() - along.normalize()).norm() < 1e-9);
        }
    }

    #[test]
    fn a_range_without_a_sigma_is_refused() {
        let d = Direction::new(Radians::new(1.0), Radians::new(1.0)).unwrap();
        for sigma in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(LineOfSight::new(d, Metres::new(sigma), Constellation::Gps).is_err());
        }
        assert!(Direction::new(Radians::new(f64::NAN), Radians::new(0.0)).is_err());
        assert!(Direction::new(Radians::new(0.0), Radians::new(1.6)).is_err());
    }
}
