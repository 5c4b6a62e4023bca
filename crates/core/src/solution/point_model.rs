//! What the models of the atmosphere and of errors say of a range, seen from a place.

use super::{Range, Settings};
use crate::frame::Geodetic;
use crate::geometry::atmosphere::{mapping_of, zenith_delay};
use crate::geometry::ionosphere::Overhead;
use crate::quantity::GpsTime;
use crate::solution::common::{Sizes, pierce};
use crate::solution::range_error::RangeConditions;
use crate::special::float::sin;
use nalgebra::{Vector3, Vector4};

/// What the error model says of a range.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Modelled {
    /// Atmospheric delay.
    pub(super) delay: f64,
    /// 1 / variance; 0 below the mask.
    pub(super) weight: f64,
    /// What each error that all ranges have in common does to it, one standard deviation each.
    pub(super) common: Vector4<f64>,
}

/// Where the receiver is thought to be, with what all ranges share there.
pub(super) struct Place {
    zenith: f64,
    sin_mask: f64,
    over: Overhead,
    sizes: Sizes,
}

impl Place {
    pub(super) fn new(here: &Geodetic, time: GpsTime, settings: &Settings) -> Self {
        let over = settings.ionosphere.over(here, time);
        let sizes = settings.errors.common.sizes(&over);
        Self { zenith: zenith_delay(here), sin_mask: sin(settings.mask.rad()), over, sizes }
    }
}

impl Settings {
    /// Delay, weight and common errors of a range seen along a unit vector; weight 0 below the mask.
    pub(super) fn model(&self, range: &Range, unit: &Vector3<f64>, at: &Place) -> Modelled {
        let sin_elevation = unit.z;
        if !(sin_elevation >= at.sin_mask) {
            return Modelled::default();
        }
        // An ionosphere-free pair asks no model.
        let ionosphere = if range.ionosphere_factor > 0.0 { at.over.delay(unit) * range.ionosphere_factor } else { 0.0 };
        let mapping = mapping_of(sin_elevation);
        let (obliquity, pierced) = pierce(unit);
        let slant = range.ionosphere_factor * obliquity;
        let conditions = RangeConditions {
            constellation: range.satellite.constellation.index(),
            sin_elevation,
            ionosphere_m: ionosphere,
            ionosphere_mapping: slant,
            uneven_m: at.sizes.left_m(pierced),
            troposphere_mapping: mapping,
            cn0_dbhz: range.cn0_dbhz,
            noise_factor: range.noise_factor,
            ure_factor: range.ure_factor,
        };
        Modelled {
            delay: ionosphere + at.zenith * mapping,
            weight: 1.0 / self.errors.variance(&conditions),
            common: at.sizes.column(slant, pierced, mapping),
        }
    }
}
