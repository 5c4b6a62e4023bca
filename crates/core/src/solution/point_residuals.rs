//! Ranges as a given position sees them: lines of sight and residuals, for monitors that solve again in many ways.

use super::{Modelled, Place, Range, Settings, way};
use crate::frame::Geodetic;
use crate::frame::{EcefPosition, ecef_from_geodetic, enu_from_ecef};
use crate::quantity::{GpsTime, Metres};
use nalgebra::Vector3;

/// A range seen from a position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sighted {
    /// Which of the ranges.
    pub index: usize,
    /// Unit vector from the position to the satellite, east-north-up.
    pub unit: Vector3<f64>,
    /// Measured less computed range, the receiver's clock in it.
    pub residual: Metres,
}

/// Every range above the mask as a position sees it, with the atmosphere of the settings; their weights and tests have no part in it.
pub fn sighted<'a>(ranges: &'a [Range], time: GpsTime, settings: &'a Settings, here: &Geodetic) -> impl Iterator<Item = Sighted> + 'a {
    let at: EcefPosition = ecef_from_geodetic(here);
    let turn = enu_from_ecef(&here.point);
    let place = Place::new(here, time, settings);
    ranges.iter().enumerate().filter_map(move |(index, range)| {
        let (length, unit) = way(&range.position, at.vector());
        let unit = turn * unit;
        let Modelled { delay, weight, .. } = settings.model(range, &unit, &place);
        let residual = range.corrected.m() - length - delay;
        (weight > 0.0).then_some(Sighted { index, unit, residual: Metres::new(residual) })
    })
}
