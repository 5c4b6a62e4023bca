//! The arc of a fly-by turn, tangent to the leg before and the leg after the waypoint.
//!
//! The arc is a circle of the turn's radius about a point of the ellipsoid that has this distance from both legs. In the plane the turn
//! begins R tan(|d|/2) before the waypoint and is R |d| long; the ellipsoid moves this by R^3 / 6a^2, 3 mm at 8.5 km, so the plane is the
//! first guess of an iteration that leaves no gap.

use crate::earth::{MEAN_RADIUS_M, direct, full_turn, half_turn, inverse};
use crate::line::Line;
use crate::{Foot, Place};
use core::f64::consts::FRAC_PI_2;
use navbound_core::frame::LatLon;
use navbound_core::quantity::{Metres, OutOfDomain, Radians};

/// Track changes below this need no arc \[rad\]: it would be shorter than a tenth of a millimetre at 1000 km radius.
const STRAIGHT_RAD: f64 = 1e-7;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Arc {
    pub(crate) centre: LatLon,
    pub(crate) radius: Metres,
    /// Azimuth from the centre to the begin of the arc.
    pub(crate) start: Radians,
    /// Turned angle, positive.
    pub(crate) angle: Radians,
    /// +1 right, -1 left.
    pub(crate) sense: f64,
}

/// A turn joined to its legs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Turn {
    pub(crate) arc: Arc,
    /// Where it begins on the leg before, from that leg's first point.
    pub(crate) begin: Metres,
    /// Where it ends on the leg after, likewise.
    pub(crate) end: Metres,
}

/// Track change at a waypoint, positive right, in (-pi, pi].
pub(crate) fn track_change(before: &Line, after: &Line) -> Result<Radians, OutOfDomain> {
    let (arrive, depart) = (before.at(before.length())?, after.at(Metres::new(0.0))?);
    Ok(Radians::new(half_turn(depart.course.rad() - arrive.course.rad())))
}

/// Distance before the waypoint at which a turn begins, in the plane.
pub(crate) fn anticipation(radius: Metres, change: Radians) -> Metres {
    if change.rad().abs() < STRAIGHT_RAD {
        return Metres::new(0.0);
    }
    Metres::new(radius.m() * (0.5 * change.rad().abs()).tan())
}

/// The turn between two legs; `None` where there is nothing to turn.
pub(crate) fn between(before: &Line, after: &Line, radius: Metres) -> Result<Option<Turn>, OutOfDomain> {
    let change = track_change(before, after)?.rad();
    if radius.m() == 0.0 || change.abs() < STRAIGHT_RAD {
        return Ok(None);
    }
    let (sense, r) = (change.signum(), radius.m());
    let mut ahead = anticipation(radius, Radians::new(change)).m();
    let mut best = centre_and_foot(before, after, ahead, sense, r)?;
    for _ in 0..6 {
        // In the plane the centre's distance from the leg after grows by sin|d| per metre of anticipation.
        ahead += (r - sense * best.1.cross.m()) / change.abs().sin();
        best = centre_and_foot(before, after, ahead, sense, r)?;
    }
    let (centre, foot) = best;
    let begin = Metres::new(before.length().m() - ahead);
    let first = inverse(&centre, &before.at(begin)?.point).departure.rad();
    let last = inverse(&centre, &foot.point).departure.rad();
    let angle = Radians::new((sense * (last - first)).rem_euclid(core::f64::consts::TAU));
    let arc = Arc { centre, radius, start: Radians::new(first), angle, sense };
    Ok(Some(Turn { arc, begin, end: foot.along }))
}

fn centre_and_foot(before: &Line, after: &Line, ahead: f64, sense: f64, r: f64) -> Result<(LatLon, Foot), OutOfDomain> {
    let begin = before.at(Metres::new(before.length().m() - ahead))?;
    let (centre, _) = direct(&begin.point, Radians::new(begin.course.rad() + sense * FRAC_PI_2), Metres::new(r))?;
    Ok((centre, after.project_near(&centre, Metres::new(ahead))?))
}

impl Arc {
    /// Circumference over 2 pi: a circle on a sphere is shorter than in the plane.
    fn reduced_radius_m(&self) -> f64 {
        MEAN_RADIUS_M * (self.radius.m() / MEAN_RADIUS_M).sin()
    }

    pub(crate) fn length(&self) -> Metres {
        Metres::new(self.reduced_radius_m() * self.angle.rad())
    }

    pub(crate) fn curvature_per_m(&self) -> f64 {
        self.sense / self.radius.m()
    }

    pub(crate) fn at(&self, along: Metres) -> Result<Place, OutOfDomain> {
        let turned = along.m() / self.reduced_radius_m();
        self.place(self.start.rad() + self.sense * turned, turned)
    }

    /// The foot of a position; before the begin of the arc `along` is negative.
    pub(crate) fn project(&self, position: &LatLon) -> Result<Foot, OutOfDomain> {
        let between = inverse(&self.centre, position);
        let azimuth = between.departure.rad();
        // Measured from the middle of the arc, so that before the begin and after the end are distinguished on both sides.
        let middle = 0.5 * self.angle.rad();
        let turned = middle + half_turn(self.sense * (azimuth - self.start.rad()) - middle);
        let place = self.place(azimuth, turned)?;
        let cross = self.sense * (self.radius.m() - between.distance.m());
        let along = Metres::new(turned * self.reduced_radius_m());
        Ok(Foot { along, cross: Metres::new(cross), course: place.course, point: place.point, leg: place.leg })
    }

    /// The point of the circle in a direction from the centre; `leg` is 0 before the middle of the turn and 1 after it.
    fn place(&self, azimuth_rad: f64, turned_rad: f64) -> Result<Place, OutOfDomain> {
        let (point, outward) = direct(&self.centre, Radians::new(azimuth_rad), self.radius)?;
        let course = full_turn(outward.rad() + self.sense * FRAC_PI_2);
        Ok(Place { point, course, curvature_per_m: self.curvature_per_m(), leg: usize::from(turned_rad >= 0.5 * self.angle.rad()) })
    }
}
