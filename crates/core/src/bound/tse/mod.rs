//! Total system error across and above the path.
//!
//! The flight technical error is known at each epoch, the navigation system error is normal; so the error across the path is normal
//! with a known mean, and its bound is the quantile of a folded normal law in one dimension. Everything else here is either a quicker
//! bound of the same thing (LTEM, CTEM, SQSM) or the same law with one assumption more or less.

mod ellipse;
mod extended;
mod lateral;
mod printed;
mod vertical;

pub use ellipse::{Horizontal, ctem, ctem_at, ctem_foot, ctem_foot_at, farthest, sqsm, sqsm_at};
pub use extended::{Component, MAX_DEGREES_OF_FREEDOM, RandomFte, mixture, paired_overbound, rf_fte, rssm, student_t};
pub use lateral::{
    Deviation, Gradient, Lateral, axes, exact, exact_at, exact_prepared, exceedance_risk, fte_budget, gradient, ln_exceedance_risk, ltem,
    ltem_at, project, sigma_budget,
};
pub use printed::{RotatedFrame, factor_as_printed, ltem_as_printed, slope, slope_as_printed};
pub use vertical::{Box, PathDeviations, box_limits, box_risk, deviations};

use super::{Bounded, Method, Promises, Provenance};
use crate::frame::{Displacement, Enu};
use crate::quantity::Unavailable;
use crate::solution::Epoch;

/// Promises of a sound method that feeds alerts.
const SOUND: Promises =
    Promises { scales_with_length: true, ignores_north: true, monotone_in_risk: true, conservative: true, may_alert: true };
/// What all lateral methods assume.
const ASSUMES: &str = "the navigation error is normal with the stated covariance, given the estimate; the flight technical error is known";

/// The methods of this family.
pub const METHODS: &[Method] = &[
    Method {
        id: "tse-exact",
        title: "TSE, exact",
        source: "Fu, Zhang, Li 2014, eq. 7 and 11, reduced to one dimension",
        provenance: Provenance::ReDerived,
        bounds: Bounded::LateralTse,
        assumes: ASSUMES,
        promises: SOUND,
        bound: |epoch, risk| Ok(exact(Lateral::of("tse-exact", epoch)?.deviation, risk)),
    },
    Method {
        id: "tse-ltem",
        title: "TSE, line tangent to the ellipse (LTEM)",
        source: "Fu, Zhang, Li 2014, eq. 37 and 39, with the factor in full",
        provenance: Provenance::ReDerived,
        bounds: Bounded::LateralTse,
        assumes: ASSUMES,
        promises: SOUND,
        bound: |epoch, risk| Ok(ltem(Lateral::of("tse-ltem", epoch)?.deviation, risk)),
    },
    Method {
        id: "tse-ctem",
        title: "TSE, circle tangent to the ellipse (CTEM)",
        source: "Fu, Zhang, Li 2014, eq. 22 to 32, solved by a shifted secular equation",
        provenance: Provenance::ReDerived,
        bounds: Bounded::LateralTse,
        assumes: "as tse-exact; the offset along the track counts as well, so the bound grows with it",
        promises: SOUND,
        bound: |epoch, risk| {
            // The course must be there although the circle does not use it: without a path there is no lateral error.
            epoch.course_for("tse-ctem")?;
            Ok(ctem(&offset_of("tse-ctem", epoch)?, &horizontal_of("tse-ctem", epoch)?, risk)?)
        },
    },
    Method {
        id: "tse-ctem-foot",
        title: "TSE, circle tangent to the ellipse, from the closest point of the path",
        source: "Fu, Zhang, Li 2014, eq. 22 to 32, offset across the path only",
        provenance: Provenance::Ours,
        bounds: Bounded::LateralTse,
        assumes: ASSUMES,
        promises: SOUND,
        bound: |epoch, risk| {
            let lateral = Lateral::of("tse-ctem-foot", epoch)?;
            let course = epoch.course_for("tse-ctem-foot")?;
            Ok(ctem_foot(lateral.deviation.fte(), course, &horizontal_of("tse-ctem-foot", epoch)?, risk)?)
        },
    },
    Method {
        id: "tse-sqsm",
        title: "TSE, scalar sum with the largest deviation (SQSM)",
        source: "Fu, Zhang, Li 2014, eq. 20, with the factor in full",
        provenance: Provenance::Printed,
        bounds: Bounded::LateralTse,
        assumes: ASSUMES,
        promises: SOUND,
        bound: |epoch, risk| {
            let lateral = Lateral::of("tse-sqsm", epoch)?;
            Ok(sqsm(lateral.deviation.fte(), &horizontal_of("tse-sqsm", epoch)?, risk)?)
        },
    },
    Method {
        id: "tse-vertical",
        title: "TSE above the path, exact",
        source: "navbound, docs/methods/tse.md: the exact method on the normal of the path",
        provenance: Provenance::Ours,
        bounds: Bounded::VerticalTse,
        assumes: "the navigation error is normal with the stated covariance; its horizontal part acts through the path angle",
        promises: SOUND,
        bound: |epoch, risk| {
            let course = epoch.course_for("tse-vertical")?;
            let angle = epoch.path_angle.ok_or(Unavailable::Missing { method: "tse-vertical", field: "path_angle" })?;
            let covariance = epoch.covariance_for("tse-vertical")?;
            Ok(exact(deviations(&offset_of("tse-vertical", epoch)?, covariance, course, angle)?.vertical, risk))
        },
    },
    Method {
        id: "tse-ltem-as-printed",
        title: "LTEM as printed: an exhibit, not a bound",
        source: "Fu, Zhang, Li 2014, eq. 39 with slope cot(phi) and factors 1.96 and 4.41, misprints included",
        provenance: Provenance::Printed,
        bounds: Bounded::LateralTse,
        assumes: "a path due north, an estimate on the left of it, and that 4.41 is 4.4172",
        promises: Promises { ignores_north: false, monotone_in_risk: false, conservative: false, may_alert: false, ..SOUND },
        bound: |epoch, risk| {
            epoch.course_for("tse-ltem-as-printed")?;
            Ok(ltem_as_printed(&offset_of("tse-ltem-as-printed", epoch)?, &horizontal_of("tse-ltem-as-printed", epoch)?, risk)?)
        },
    },
];

/// Estimated position minus expected point, moved by the known mean of the navigation error where there is one.
fn offset_of(method: &'static str, epoch: &Epoch) -> Result<Displacement<Enu>, Unavailable> {
    let offset = epoch.offset_for(method)?;
    Ok(epoch.mean.as_ref().map_or(*offset, |mean| Displacement::from_vector(offset.vector() + mean.vector())))
}

fn horizontal_of(method: &'static str, epoch: &Epoch) -> Result<Horizontal, Unavailable> {
    Ok(Horizontal::new(epoch.covariance_for(method)?)?)
}

impl Lateral {
    /// The lateral situation of an epoch.
    fn of(method: &'static str, epoch: &Epoch) -> Result<Self, Unavailable> {
        let course = epoch.course_for(method)?;
        let covariance = epoch.covariance_for(method)?;
        Ok(project(&offset_of(method, epoch)?, covariance, course)?)
    }
}
