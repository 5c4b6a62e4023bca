//! The defined path of a published procedure: one leg a path terminator of ARINC 424 (ARINC 424-18, attachment 5; standard), each with the
//! geometry that its fixes and courses define, or the reason why it has none.
//!
//! A leg begins where the leg before it ends. Where that place is open (a leg that ends at an altitude, a heading), distances along the
//! procedure are NaN from there on; those along each leg stay.

mod arc;
mod build;
mod follow;

pub use arc::Residuals;
pub use follow::{Follow, Followed, Limits, Tracked};

use crate::line::Line;
use crate::turn::Arc;
use crate::{AtIndex, Foot, Place};
use navbound_core::frame::LatLon;
use navbound_core::quantity::{Metres, OutOfDomain, Radians};

/// What defines a leg; courses count from true north at the fix.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Definition {
    /// IF: a point.
    Point(LatLon),
    /// TF: geodesic from the fix before.
    Track(LatLon),
    /// DF: geodesic from where the leg before ends.
    Direct(LatLon),
    /// CF: geodesic that ends at the fix with this course there; the coded length serves where the leg before ends nowhere.
    CourseTo(LatLon, Radians, Option<Metres>),
    /// RF: the circle through the fix before and this one.
    Circle {
        /// Where it ends.
        to: LatLon,
        /// Published centre.
        centre: LatLon,
        /// Whether it turns right.
        right: bool,
    },
    /// AF: circle about a navaid.
    DmeArc {
        /// Fix where it ends.
        to: LatLon,
        /// The navaid.
        navaid: LatLon,
        /// Distance from it.
        radius: Metres,
        /// True bearing from the navaid at which it begins.
        begin: Radians,
        /// Whether it turns right.
        right: bool,
    },
    /// CA, FA, FC, FD, FM, CD, CI, CR: geodesic with this course from the fix, or from where the leg before ends.
    Course {
        /// Where it begins; None: where the leg before ends.
        from: Option<LatLon>,
        /// Course there.
        course: Radians,
        /// Where it ends.
        end: End,
    },
    /// HA, HF, HM: the inbound leg to the fix.
    Hold {
        /// The fix.
        fix: LatLon,
        /// Inbound course there.
        course: Radians,
        /// Length of the inbound leg, where it is coded as a distance.
        length: Option<Metres>,
    },
    /// No geometry, and why.
    Without(State),
}

/// Where a leg with a course ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum End {
    /// At an altitude, an intercept, or by hand: nobody knows where.
    Open,
    /// After this distance.
    After(Metres),
    /// At this distance from a DME.
    AtDistance(LatLon, Metres),
    /// On the radial of a navaid: the geodesic from it with this true bearing.
    OnRadial(LatLon, Radians),
}

/// What the deviation from a leg is worth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum State {
    /// Path, begin and end are defined.
    Full,
    /// The path is defined, its begin is inferred from the leg before or from the coded length.
    InferredStart,
    /// The path is defined, its end is not.
    OpenEnd,
    /// The inbound leg of a hold: what lies beside it is holding.
    Holding,
    /// A point, no path.
    Point,
    /// A heading or a procedure turn: the wind decides.
    NoPath,
    /// The leg before ends nowhere.
    NoStart,
    /// The fix is not in the file.
    NoFix,
    /// The centre is not in the file.
    NoCentre,
    /// The recommended navaid is not in the file.
    NoNavaid,
    /// The fix, centre or navaid has two positions in the file.
    AmbiguousFix,
    /// A magnetic course, and neither navaid nor airport has a variation.
    NoVariation,
    /// A coded course, distance or turn direction is missing.
    NotCoded,
    /// The fixes define no such geometry: two in one place, a centre no circle has.
    Impossible,
}

impl State {
    /// All of them.
    pub const ALL: [Self; 14] = [
        Self::Full,
        Self::InferredStart,
        Self::OpenEnd,
        Self::Holding,
        Self::Point,
        Self::NoPath,
        Self::NoStart,
        Self::NoFix,
        Self::NoCentre,
        Self::NoNavaid,
        Self::AmbiguousFix,
        Self::NoVariation,
        Self::NotCoded,
        Self::Impossible,
    ];
    /// Stable id.
    pub const fn id(self) -> &'static str {
        match self {
            Self::Full => "full",
            Self::InferredStart => "inferred_start",
            Self::OpenEnd => "open_end",
            Self::Holding => "holding",
            Self::Point => "point",
            Self::NoPath => "no_path",
            Self::NoStart => "no_start",
            Self::NoFix => "no_fix",
            Self::NoCentre => "no_centre",
            Self::NoNavaid => "no_navaid",
            Self::AmbiguousFix => "ambiguous_fix",
            Self::NoVariation => "no_variation",
            Self::NotCoded => "not_coded",
            Self::Impossible => "impossible",
        }
    }
}

#[derive(Debug, Clone, PartialEq)]
enum Shape {
    /// From this far along the line.
    Straight(Box<Line>, Metres),
    Arc(Arc),
}

/// One leg of a procedure.
#[derive(Debug, Clone, PartialEq)]
pub struct PathLeg {
    /// Index of the definition it comes from.
    pub index: usize,
    /// What its deviation is worth.
    pub state: State,
    /// Distance along the procedure where it begins; NaN after an open end.
    pub begin: Metres,
    /// Length; infinite with an open end, NaN without a path.
    pub length: Metres,
    /// How far the published numbers are from the geometry, of an RF or AF leg.
    pub residuals: Option<Residuals>,
    shape: Option<Shape>,
}

/// The foot of a position on one leg.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LegFoot {
    /// The foot; `along` from the begin of the leg, `leg` the index of the leg.
    pub foot: Foot,
    /// Distance along the procedure.
    pub along: Metres,
}

impl PathLeg {
    /// Whether a position has a deviation from it.
    pub fn has_path(&self) -> bool {
        self.shape.is_some()
    }

    /// The foot of a position on the leg or its continuation.
    ///
    /// # Errors
    /// [`OutOfDomain`] for a leg without a path, and for a position further than 5000 km away.
    pub fn project(&self, position: &LatLon) -> Result<LegFoot, OutOfDomain> {
        self.project_near(position, None)
    }

    /// The same, from a known neighbourhood of the foot.
    pub(crate) fn project_near(&self, position: &LatLon, near: Option<f64>) -> Result<LegFoot, OutOfDomain> {
        let (foot, from) = match &self.shape {
            None => return Err(without(self.index)),
            Some(Shape::Straight(line, from)) => match near {
                Some(near) => (line.project_near(position, Metres::new(near + from.m()))?, from.m()),
                None => (line.project(position)?, from.m()),
            },
            Some(Shape::Arc(arc)) => (arc.project(position)?, 0.0),
        };
        let along = Metres::new(foot.along.m() - from);
        Ok(LegFoot { foot: Foot { along, leg: self.index, ..foot }, along: Metres::new(self.begin.m() + along.m()) })
    }

    /// The leg at a distance from its begin; beyond its ends it goes on.
    ///
    /// # Errors
    /// [`OutOfDomain`] for a leg without a path, and for a distance that is not finite.
    pub fn at(&self, along: Metres) -> Result<Place, OutOfDomain> {
        if !along.m().is_finite() {
            return Err(OutOfDomain { argument: "along_m", value: along.m(), unit: "m", domain: "finite distances" });
        }
        let place = match &self.shape {
            None => return Err(without(self.index)),
            Some(Shape::Straight(line, from)) => line.at(Metres::new(from.m() + along.m()))?,
            Some(Shape::Arc(arc)) => arc.at(along)?,
        };
        Ok(Place { leg: self.index, ..place })
    }

    /// Turned angle of an arc, positive right; 0 of a straight leg.
    pub fn turn(&self) -> Radians {
        match &self.shape {
            Some(Shape::Arc(arc)) => Radians::new(arc.sense * arc.angle.rad()),
            _ => Radians::new(0.0),
        }
    }

    /// Radius of an arc.
    pub fn radius(&self) -> Option<Metres> {
        match &self.shape {
            Some(Shape::Arc(arc)) => Some(arc.radius),
            _ => None,
        }
    }

    /// Distance of a foot from the leg's own extent: 0 inside.
    pub(crate) fn beyond(&self, along: f64) -> f64 {
        if along < 0.0 {
            -along
        } else if along > self.length.m() {
            along - self.length.m()
        } else {
            0.0
        }
    }
}

fn without(index: usize) -> OutOfDomain {
    OutOfDomain { argument: "leg", value: index as f64, unit: "1", domain: "legs with a path" }
}

/// The legs of a procedure in the order flown.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ProcedurePath {
    legs: Vec<PathLeg>,
}

impl ProcedurePath {
    /// The path that the definitions make, one leg each.
    ///
    /// # Errors
    /// [`AtIndex`] with the definition that has a number which is not finite.
    pub fn new(definitions: &[Definition]) -> Result<Self, AtIndex> {
        Ok(Self { legs: build::legs(definitions)? })
    }

    /// The legs, one a definition.
    pub fn legs(&self) -> &[PathLeg] {
        &self.legs
    }

    /// Length from the begin of the first leg to the end of the last; NaN or infinite where it is not defined throughout.
    pub fn length(&self) -> Metres {
        let last = self.legs.iter().rev().find(|leg| leg.has_path());
        last.map_or(Metres::new(f64::NAN), |leg| Metres::new(leg.begin.m() + leg.length.m()))
    }
}
