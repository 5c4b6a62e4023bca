//! What sensors outside the inertial unit deliver to a navigation filter: one measurement each, with its own error budget.
//!
//! A budget has a part that is new at every measurement (white) and a part that stays (correlated); a filter that takes the second for the
//! first is wrong about its own error.

use crate::frame::{Covariance, EcefPosition, Enu, Geodetic};
use crate::quantity::{GpsTime, Metres, Radians};
use crate::signal::SatelliteId;
use nalgebra::Vector3;

/// Code range to a satellite, corrected for everything that is known: satellite clock, modelled ionosphere and troposphere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SatelliteRange {
    /// Which satellite.
    pub satellite: SatelliteId,
    /// Where it was at transmission, in the Earth-fixed axes of reception.
    pub position: EcefPosition,
    /// Its velocity, likewise \[m/s\].
    pub velocity_mps: Vector3<f64>,
    /// Geometric range + receiver clock + inter-system bias + error; none where only its rate is known, as from carrier phase.
    pub range: Option<Metres>,
    /// Standard deviation of the white part.
    pub sigma_white: Metres,
    /// Standard deviation of the part that is correlated in time (first-order Gauss-Markov).
    pub sigma_correlated: Metres,
    /// Standard deviation that part has when the satellite is first seen: the one above for a stationary process.
    pub sigma_first: Metres,
    /// Correlation time of that part \[s\].
    pub correlation_time_s: f64,
    /// Range rate from Doppler, corrected for the satellite's clock drift \[m/s\], and its standard deviation \[m/s\].
    pub rate_mps: Option<(f64, f64)>,
}

/// Slant range to a DME station.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DmeRange {
    /// Index of the station in the table of the flight.
    pub station: u16,
    /// Where its antenna is.
    pub position: EcefPosition,
    /// Measured slant range.
    pub slant: Metres,
    /// Standard deviation of the white part.
    pub sigma_white: Metres,
    /// Standard deviation of the station's bias, constant over the flight.
    pub sigma_bias: Metres,
}

/// Bearing of the aircraft from a VOR station.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VorBearing {
    /// Index of the station in the table of the flight.
    pub station: u16,
    /// Where its antenna is.
    pub position: Geodetic,
    /// From the station to the aircraft, clockwise from true north.
    pub bearing: Radians,
    /// Standard deviation of the white part.
    pub sigma_white: Radians,
    /// Standard deviation of the station's bias, constant over the flight.
    pub sigma_bias: Radians,
}

/// Height from a barometric altimeter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BaroHeight {
    /// Height above the ellipsoid as pressure and setting say it.
    pub height: Metres,
    /// Standard deviation of the white part.
    pub sigma_white: Metres,
    /// Standard deviation of the slow bias (first-order Gauss-Markov).
    pub sigma_bias: Metres,
    /// Correlation time of the bias \[s\].
    pub correlation_time_s: f64,
}

/// A position, and perhaps a velocity, that another receiver has solved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PositionFix {
    /// Where the antenna is said to be.
    pub position: Geodetic,
    /// Covariance of that.
    pub covariance: Covariance<Enu>,
    /// Velocity north, east, down \[m/s\], and its variance matrix \[m²/s²\].
    pub velocity_ned_mps: Option<(Vector3<f64>, nalgebra::Matrix3<f64>)>,
    /// Protection levels, horizontal and vertical \[m\], where its receiver brings them: a covariance bounds no fault.
    pub level_m: Option<[f64; 2]>,
}

/// Accumulated carrier phase of a satellite, corrected as its code range is. It aids no filter here; differences over time do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PhaseRange {
    /// Which satellite.
    pub satellite: SatelliteId,
    /// As the code range, with the ionosphere's error of the other sign and a constant that nobody knows.
    pub range: Metres,
    /// Standard deviation of the white part.
    pub sigma_white: Metres,
}

/// One measurement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Aiding {
    /// Range (and range rate) to a satellite.
    Satellite(SatelliteRange),
    /// Slant range to a DME.
    Dme(DmeRange),
    /// Bearing from a VOR.
    Vor(VorBearing),
    /// Barometric height.
    Baro(BaroHeight),
    /// A solved position.
    Fix(PositionFix),
}

/// A measurement and when it holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimedAiding {
    /// Time of validity.
    pub time: GpsTime,
    /// What was measured.
    pub aiding: Aiding,
}
