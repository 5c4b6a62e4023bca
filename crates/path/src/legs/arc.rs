//! The circle of an RF leg from its fixes alone.
//!
//! Start, end, centre, radius, two courses, a length and a direction are published, and any three decide (ours: which three). Fixes are good
//! to 0.3 m, the radius is rounded to 0.01 NM. The arc therefore passes through both fixes, and its centre is the published one moved as
//! little as possible until it is equally far from both.

use crate::earth::{direct, full_turn, half_turn, inverse};
use crate::turn::Arc;
use core::f64::consts::{PI, TAU};
use navbound_core::frame::LatLon;
use navbound_core::quantity::{Metres, OutOfDomain, Radians};

/// The centre is settled when both distances agree to this \[m\]: a hundredth of what the inverse problem resolves.
const SETTLED_M: f64 = 1e-8;
/// Directions from the centre to both fixes closer than this decide no centre \[1\].
const LEAST_GRADIENT: f64 = 1e-6;

/// How far the published numbers of an arc are from its geometry.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Residuals {
    /// Distance of the first fix from the published centre.
    pub start_to_centre: Metres,
    /// Distance of the second fix from it.
    pub end_to_centre: Metres,
    /// How far the centre was moved.
    pub centre_moved: Metres,
    /// Course of the arc at its begin, in \[0, 2 pi).
    pub course_begin: Radians,
    /// Course at its end.
    pub course_end: Radians,
}

/// The arc from one fix to the next about a published centre.
///
/// # Errors
/// [`OutOfDomain`] for fixes that define no circle: both in one place, or seen from the centre in one direction.
pub(super) fn through(start: &LatLon, end: &LatLon, published: &LatLon, right: bool) -> Result<(Arc, Residuals), OutOfDomain> {
    let sense = if right { 1.0 } else { -1.0 };
    let centre = equally_far(start, end, published)?;
    let (first, last) = (inverse(&centre, start), inverse(&centre, end));
    let angle = (sense * (last.departure.rad() - first.departure.rad())).rem_euclid(TAU);
    let radius = Metres::new(0.5 * (first.distance.m() + last.distance.m()));
    if !(radius.m() >= 1.0 && angle > 0.0) {
        return Err(no_circle(radius.m()));
    }
    let arc = Arc { centre, radius, start: first.departure, angle: Radians::new(angle), sense };
    let residuals = Residuals {
        start_to_centre: inverse(published, start).distance,
        end_to_centre: inverse(published, end).distance,
        centre_moved: inverse(published, &centre).distance,
        course_begin: arc.at(Metres::new(0.0))?.course,
        course_end: arc.at(arc.length())?.course,
    };
    Ok((arc, residuals))
}

/// Newton on d(C, start) - d(C, end) along its gradient.
fn equally_far(start: &LatLon, end: &LatLon, published: &LatLon) -> Result<LatLon, OutOfDomain> {
    let mut centre = *published;
    for _ in 0..12 {
        let (s, e) = (inverse(&centre, start), inverse(&centre, end));
        let uneven = s.distance.m() - e.distance.m();
        if uneven.abs() <= SETTLED_M {
            break;
        }
        // A distance shrinks towards its point, so the gradient is the direction to the end less that to the start.
        let (sin_s, cos_s) = s.departure.rad().sin_cos();
        let (sin_e, cos_e) = e.departure.rad().sin_cos();
        let (east, north) = (sin_e - sin_s, cos_e - cos_s);
        let squared = east * east + north * north;
        if !(squared >= LEAST_GRADIENT * LEAST_GRADIENT) {
            return Err(no_circle(squared.sqrt()));
        }
        let step = -uneven / squared;
        let azimuth = (step * east).atan2(step * north);
        (centre, _) = direct(&centre, Radians::new(azimuth), Metres::new((step * squared.sqrt()).abs()))?;
    }
    Ok(centre)
}

/// The arc about a navaid at a coded distance, from a bearing to the bearing of a fix.
///
/// # Errors
/// [`OutOfDomain`] for a radius that is not positive or an arc without an angle.
pub(super) fn about(to: &LatLon, navaid: &LatLon, radius: Metres, begin: Radians, right: bool) -> Result<(Arc, Residuals), OutOfDomain> {
    let sense = if right { 1.0 } else { -1.0 };
    let last = inverse(navaid, to);
    let angle = (sense * (last.departure.rad() - begin.rad())).rem_euclid(TAU);
    // An arc of nearly a whole turn is one whose begin lies just behind its end.
    if !(radius.m() >= 1.0 && radius.m().is_finite() && angle > 0.0 && angle < 2.0 * PI - 0.1) {
        return Err(no_circle(radius.m()));
    }
    let arc = Arc { centre: *navaid, radius, start: Radians::new(half_turn(begin.rad())), angle: Radians::new(angle), sense };
    let residuals = Residuals {
        start_to_centre: radius,
        end_to_centre: last.distance,
        centre_moved: Metres::new(0.0),
        course_begin: full_turn(arc.at(Metres::new(0.0))?.course.rad()),
        course_end: full_turn(arc.at(arc.length())?.course.rad()),
    };
    Ok((arc, residuals))
}

fn no_circle(value: f64) -> OutOfDomain {
    OutOfDomain { argument: "arc", value, unit: "m", domain: "fixes, centre and radius of a circle" }
}
