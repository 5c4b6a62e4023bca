//! The two geodesic problems of WGS-84 in our units (C. F. F. Karney, "Algorithms for geodesics", J. Geod. 87, 2013; printed), as the
//! kept library solves them. Angles go through degrees, which costs about 3 nm.

use core::f64::consts::{PI, TAU};
use geographiclib_rs::{DirectGeodesic, Geodesic, InverseGeodesic};
use navbound_core::frame::LatLon;
use navbound_core::quantity::{Metres, OutOfDomain, Radians};

/// Mean radius, for first guesses that are iterated away \[m\].
pub(crate) const MEAN_RADIUS_M: f64 = 6_371_000.0;

/// The geodesic from one point to another.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Between {
    pub(crate) distance: Metres,
    /// Azimuth at the first point.
    pub(crate) departure: Radians,
}

pub(crate) fn inverse(from: &LatLon, to: &LatLon) -> Between {
    let (distance, departure, _, _): (f64, f64, f64, f64) = Geodesic::wgs84().inverse(
        from.lat().rad().to_degrees(),
        from.lon().rad().to_degrees(),
        to.lat().rad().to_degrees(),
        to.lon().rad().to_degrees(),
    );
    Between { distance: Metres::new(distance), departure: Radians::degrees(departure) }
}

/// The point at a distance, and the azimuth on arrival.
pub(crate) fn direct(from: &LatLon, azimuth: Radians, distance: Metres) -> Result<(LatLon, Radians), OutOfDomain> {
    let (lat, lon, arrival): (f64, f64, f64) =
        Geodesic::wgs84().direct(from.lat().rad().to_degrees(), from.lon().rad().to_degrees(), azimuth.rad().to_degrees(), distance.m());
    Ok((LatLon::new(Radians::degrees(lat), Radians::degrees(lon))?, Radians::degrees(arrival)))
}

/// The angle in (-pi, pi].
pub(crate) fn half_turn(angle_rad: f64) -> f64 {
    let a = angle_rad.rem_euclid(TAU);
    if a > PI { a - TAU } else { a }
}

/// The angle in \[0, 2 pi).
pub(crate) fn full_turn(angle_rad: f64) -> Radians {
    let a = angle_rad.rem_euclid(TAU);
    // A tiny negative angle rounds up to a whole turn.
    Radians::new(if a < TAU { a } else { 0.0 })
}
