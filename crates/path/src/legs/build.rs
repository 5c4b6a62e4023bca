//! Definitions to legs, each from where the one before ends.

use super::arc::{Residuals, about, through};
use super::{Definition, End, PathLeg, Shape, State};
use crate::earth::{direct, full_turn, inverse};
use crate::line::Line;
use crate::refusal::{At, AtIndex};
use core::f64::consts::PI;
use navbound_core::frame::LatLon;
use navbound_core::quantity::{Metres, OutOfDomain, Radians};

/// Straight legs shorter than this have no direction of their own \[m\].
const SHORTEST_M: f64 = 1e-3;

/// Where the next leg begins.
#[derive(Clone, Copy)]
struct Position {
    place: Option<LatLon>,
    along: f64,
}

/// A leg's geometry with its end.
struct Built {
    state: State,
    shape: Option<Shape>,
    length: f64,
    end: Option<LatLon>,
    residuals: Option<Residuals>,
}

pub(super) fn legs(definitions: &[Definition]) -> Result<Vec<PathLeg>, AtIndex> {
    let mut position = Position { place: None, along: 0.0 };
    let mut legs = Vec::with_capacity(definitions.len());
    for (index, definition) in definitions.iter().enumerate() {
        finite(definition).at(index)?;
        let built = one(definition, position.place).unwrap_or_else(|_| none(State::Impossible, fix_of(definition)));
        let length = if built.shape.is_some() { built.length } else { f64::NAN };
        let (begin, residuals) = (Metres::new(position.along), built.residuals);
        position.along = if jumps(&position, &built) { f64::NAN } else { after(&built, position.along) };
        position.place = built.end;
        legs.push(PathLeg { index, state: built.state, begin, length: Metres::new(length), residuals, shape: built.shape });
    }
    Ok(legs)
}

/// Whether a point lies elsewhere than where the leg before ended: the two routes do not join.
fn jumps(position: &Position, built: &Built) -> bool {
    match (built.state, position.place, built.end) {
        (State::Point, Some(before), Some(point)) => !(inverse(&before, &point).distance.m() < SHORTEST_M),
        (State::Point, None, Some(_)) => position.along.is_nan(),
        _ => false,
    }
}

/// Distance along the procedure at the end of a leg: a point leaves it, an open end loses it.
fn after(built: &Built, along: f64) -> f64 {
    match (&built.shape, built.state) {
        (Some(_), State::Holding) | (None, State::Point) => along,
        (Some(_), _) if built.length.is_finite() => along + built.length,
        _ => f64::NAN,
    }
}

fn one(definition: &Definition, before: Option<LatLon>) -> Result<Built, OutOfDomain> {
    match *definition {
        Definition::Point(fix) => Ok(none(State::Point, Some(fix))),
        Definition::Without(state) => Ok(none(state, None)),
        Definition::Track(to) | Definition::Direct(to) => match before {
            None => Ok(none(State::NoStart, Some(to))),
            Some(from) => straight(&from, &to, State::Full),
        },
        Definition::CourseTo(to, course, coded) => course_to(&to, course, coded, before),
        Definition::Circle { to, centre, right } => match before {
            None => Ok(none(State::NoStart, Some(to))),
            Some(from) => {
                let (arc, residuals) = through(&from, &to, &centre, right)?;
                Ok(arc_built(arc, residuals, to))
            }
        },
        Definition::DmeArc { to, navaid, radius, begin, right } => {
            let (arc, residuals) = about(&to, &navaid, radius, begin, right)?;
            Ok(arc_built(arc, residuals, to))
        }
        Definition::Course { from, course, end } => match from.or(before) {
            None => Ok(none(State::NoStart, None)),
            Some(start) => with_course(&start, course, end),
        },
        Definition::Hold { fix, course, length } => hold(&fix, course, length),
    }
}

fn none(state: State, end: Option<LatLon>) -> Built {
    Built { state, shape: None, length: f64::NAN, end, residuals: None }
}

fn arc_built(arc: crate::turn::Arc, residuals: Residuals, end: LatLon) -> Built {
    let length = arc.length().m();
    Built { state: State::Full, shape: Some(Shape::Arc(arc)), length, end: Some(end), residuals: Some(residuals) }
}

/// A fix that stands twice in a row joins two routes and is a point of the path, not a leg of length zero.
fn straight(from: &LatLon, to: &LatLon, state: State) -> Result<Built, OutOfDomain> {
    if inverse(from, to).distance.m() < SHORTEST_M {
        return Ok(none(State::Point, Some(*to)));
    }
    let line = Line::through(*from, *to)?;
    let length = line.length().m();
    Ok(Built { state, shape: Some(Shape::Straight(Box::new(line), Metres::new(0.0))), length, end: Some(*to), residuals: None })
}

/// The geodesic that arrives at a fix with a course, from the foot of the place where the leg before ends.
fn course_to(to: &LatLon, course: Radians, coded: Option<Metres>, before: Option<LatLon>) -> Result<Built, OutOfDomain> {
    let arriving = Line::from_azimuth(*to, course)?;
    let behind = match before {
        Some(from) => Some(-arriving.project(&from)?.along.m()).filter(|b| *b >= SHORTEST_M),
        None => None,
    };
    let Some(length) = behind.or(coded.map(Metres::m)).filter(|l| *l >= SHORTEST_M) else {
        return Ok(none(State::NoStart, Some(*to)));
    };
    let start = arriving.at(Metres::new(-length))?.point;
    straight(&start, to, State::InferredStart)
}

fn with_course(start: &LatLon, course: Radians, end: End) -> Result<Built, OutOfDomain> {
    let line = Line::from_azimuth(*start, course)?;
    let length = match end {
        End::Open => None,
        End::After(distance) => Some(distance.m()),
        End::AtDistance(dme, distance) => first_zero(&line, |p| Ok(inverse(&dme, p).distance.m() - distance.m()))?,
        End::OnRadial(navaid, bearing) => {
            let radial = Line::from_azimuth(navaid, bearing)?;
            first_zero(&line, |p| Ok(radial.project(p)?.cross.m()))?
        }
    };
    let (state, reached) = match length {
        Some(length) => (State::Full, Some(line.at(Metres::new(length))?.point)),
        None => (State::OpenEnd, None),
    };
    let shape = Some(Shape::Straight(Box::new(line), Metres::new(0.0)));
    Ok(Built { state, shape, length: length.unwrap_or(f64::INFINITY), end: reached, residuals: None })
}

/// Where along the line, ahead of its begin, a distance first becomes zero; None within 200 km: no leg is longer.
fn first_zero(line: &Line, distance: impl Fn(&LatLon) -> Result<f64, OutOfDomain>) -> Result<Option<f64>, OutOfDomain> {
    const STEP_M: f64 = 1000.0;
    let at = |s: f64| distance(&line.at(Metres::new(s))?.point);
    let mut low = at(0.0)?;
    for k in 0..200 {
        let (mut a, mut b) = (f64::from(k) * STEP_M, f64::from(k + 1) * STEP_M);
        let high = at(b)?;
        if (low > 0.0) == (high > 0.0) {
            low = high;
            continue;
        }
        for _ in 0..50 {
            let middle = 0.5 * (a + b);
            if (at(middle)? > 0.0) == (low > 0.0) { a = middle } else { b = middle }
        }
        return Ok(Some(0.5 * (a + b)));
    }
    Ok(None)
}

/// The inbound leg of a hold; without a coded distance its begin is open, and the leg lies before its fix.
fn hold(fix: &LatLon, course: Radians, length: Option<Metres>) -> Result<Built, OutOfDomain> {
    let length = length.map_or(f64::INFINITY, Metres::m);
    let (start, from) = if length.is_finite() {
        (direct(fix, Radians::new(course.rad() + PI), Metres::new(length))?, 0.0)
    } else {
        ((*fix, Radians::new(course.rad() + PI)), 0.0)
    };
    // The azimuth on arrival points away from the fix.
    let line = Line::from_azimuth(start.0, full_turn(start.1.rad() + PI))?;
    let shape = Some(Shape::Straight(Box::new(line), Metres::new(from)));
    Ok(Built { state: State::Holding, shape, length: if length.is_finite() { length } else { 0.0 }, end: Some(*fix), residuals: None })
}

fn fix_of(definition: &Definition) -> Option<LatLon> {
    match *definition {
        Definition::Point(p) | Definition::Track(p) | Definition::Direct(p) | Definition::CourseTo(p, ..) => Some(p),
        Definition::Circle { to, .. } | Definition::DmeArc { to, .. } => Some(to),
        Definition::Hold { fix, .. } => Some(fix),
        Definition::Course { .. } | Definition::Without(_) => None,
    }
}

fn finite(definition: &Definition) -> Result<(), OutOfDomain> {
    let check = |argument, unit, value: f64| {
        if value.is_finite() { Ok(()) } else { Err(OutOfDomain { argument, value, unit, domain: "finite numbers" }) }
    };
    match *definition {
        Definition::CourseTo(_, course, length) | Definition::Hold { course, length, .. } => {
            check("course_rad", "rad", course.rad())?;
            check("length_m", "m", length.map_or(0.0, Metres::m))
        }
        Definition::DmeArc { radius, begin, .. } => {
            check("radius_m", "m", radius.m())?;
            check("begin_rad", "rad", begin.rad())
        }
        Definition::Course { course, end, .. } => {
            check("course_rad", "rad", course.rad())?;
            match end {
                End::Open => Ok(()),
                End::After(d) | End::AtDistance(_, d) => check("length_m", "m", d.m()),
                End::OnRadial(_, bearing) => check("bearing_rad", "rad", bearing.rad()),
            }
        }
        _ => Ok(()),
    }
}
