//! Where two slant ranges meet at a height: the two places that a solution may begin from, without a prior.

use super::Range;
use crate::frame::{EcefPosition, Geodetic, ecef_from_geodetic, enu_from_ecef, geodetic_from_ecef, radii};
use crate::quantity::Metres;
use crate::special::float::sqrt;

/// Both places, one on either side of the line between the stations.
#[derive(Debug, Clone, Copy)]
pub(super) struct Meeting {
    pub places: [EcefPosition; 2],
    /// About the sine of the angle at which the ranges meet.
    pub sine: f64,
}

/// Intersection of the two spheres about the stations and a third that osculates the ellipsoid between them, raised by the height; exact on
/// a sphere, within some hundred metres over an ellipsoid at 160 NM. `None` where the ranges do not meet.
///
/// ```text
/// x = (r1^2 - r2^2 + d^2) / 2d      y = (r1^2 - R^2 + i^2 + j^2 - 2 i x) / 2j      z^2 = r1^2 - x^2 - y^2
/// ```
pub(super) fn meet(a: &Range, b: &Range, height: Metres) -> Option<Meeting> {
    let (s1, s2) = (*a.station.vector(), *b.station.vector());
    let (r1, r2) = (a.slant.m(), b.slant.m());
    let middle = geodetic_from_ecef(&EcefPosition::from_vector(0.5 * (s1 + s2))).ok()?;
    let curvature = radii(middle.point.lat());
    let radius = sqrt(curvature.meridian.m() * curvature.prime_vertical.m());
    let foot = ecef_from_geodetic(&Geodetic { height: Metres::new(0.0), ..middle });
    let up = enu_from_ecef(&middle.point).row(2).transpose();
    let centre = foot.vector() - radius * up - s1;
    let raised = radius + height.m();
    let baseline = s2 - s1;
    let d = baseline.norm();
    let ex = baseline / d;
    let i = ex.dot(&centre);
    let across = centre - i * ex;
    let j = across.norm();
    let ey = across / j;
    let ez = ex.cross(&ey);
    let x = (r1 * r1 - r2 * r2 + d * d) / (2.0 * d);
    let y = (r1 * r1 - raised * raised + i * i + j * j - 2.0 * i * x) / (2.0 * j);
    let square = r1 * r1 - x * x - y * y;
    if !(square > 0.0) {
        return None;
    }
    let z = sqrt(square);
    let middle = s1 + x * ex + y * ey;
    Some(Meeting { places: [-z, z].map(|z| EcefPosition::from_vector(middle + z * ez)), sine: d * z / (r1 * r2) })
}
