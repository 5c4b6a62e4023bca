//! Legs to geometry: fixes from the tables, courses to true north, routes joined.
//!
//! Fixes alone make the geometry of TF, DF and RF legs. A course serves only where the leg is defined by one (CF, CA, FA, FC, FD, FM, CD, CI,
//! CR, AF, holds). It is turned to true north by the variation of the recommended navaid's record, else by the airport's (order INFERRED).

use super::record::{FixName, Kind, Leg, Procedure, Route};
use super::{Course, Database, Extent};
use navbound_core::frame::LatLon;
use navbound_core::quantity::{Metres, Radians};
use navbound_path::legs::{Definition, End, ProcedurePath, State};

/// Which part of a procedure a leg belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// Departure or arrival.
    Terminal,
    /// Initial and intermediate approach, to the final approach fix.
    Approach,
    /// From the final approach fix to the missed approach point.
    Final,
    /// Missed approach.
    Missed,
}

impl Part {
    /// Stable id.
    pub const fn id(self) -> &'static str {
        match self {
            Self::Terminal => "terminal",
            Self::Approach => "approach",
            Self::Final => "final",
            Self::Missed => "missed",
        }
    }
}

/// One leg of a joined procedure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProcedureLeg {
    /// As coded.
    pub leg: Leg,
    /// Route type, column 20.
    pub route_type: u8,
    /// Transition that it belongs to; blank for the final part.
    pub transition: super::Text<5>,
    /// Part of the procedure.
    pub part: Part,
    /// Position of its fix, where the file has it.
    pub fix: Option<LatLon>,
}

/// The legs of some routes in the order flown, and their geometry.
#[derive(Debug, Clone, PartialEq)]
pub struct PathOfProcedure {
    /// Legs.
    pub legs: Vec<ProcedureLeg>,
    /// Their geometry, one leg each.
    pub path: ProcedurePath,
}

/// A fix that cannot be used, by the state of its leg.
type Place = Result<LatLon, State>;

impl Database {
    /// Joins routes of a procedure. An initial fix that repeats the last fix of the route before joins them and is no leg of its own.
    pub fn path_of(&self, procedure: &Procedure, routes: &[&Route], missed: bool) -> PathOfProcedure {
        let mut legs: Vec<ProcedureLeg> = Vec::new();
        for route in routes {
            let parts = parts(procedure.name.kind, route);
            for (leg, part) in route.legs.iter().zip(parts) {
                let joint = leg.terminator.as_str() == "IF" && legs.last().is_some_and(|last| last.leg.fix == leg.fix);
                if joint || (part == Part::Missed && !missed) {
                    continue;
                }
                let fix = self.place(procedure, &leg.fix, State::NoFix).ok();
                legs.push(ProcedureLeg { leg: *leg, route_type: route.route_type, transition: route.transition, part, fix });
            }
        }
        let definitions: Vec<Definition> = legs.iter().map(|l| self.definition(procedure, &l.leg)).collect();
        // A definition with a number that is not finite cannot come from digits; it would be a leg without geometry.
        let path =
            ProcedurePath::new(&definitions).or_else(|_| ProcedurePath::new(&vec![Definition::Without(State::Impossible); legs.len()]));
        PathOfProcedure { path: path.unwrap_or_default(), legs }
    }

    fn place(&self, procedure: &Procedure, name: &FixName, missing: State) -> Place {
        let fix = self.fix(procedure.name.airport, name).ok_or(missing)?;
        let far_rad = far_rad(procedure.name.kind);
        let far = self.airport(procedure.name.airport.as_str()).is_some_and(|a| !(angle_rad(&a.place, &fix.place) <= far_rad));
        match (fix.ambiguous, far) {
            (true, _) => Err(State::AmbiguousFix),
            (_, true) => Err(State::Impossible),
            _ => Ok(fix.place),
        }
    }

    fn definition(&self, procedure: &Procedure, leg: &Leg) -> Definition {
        self.defined(procedure, leg).unwrap_or_else(Definition::Without)
    }

    fn defined(&self, procedure: &Procedure, leg: &Leg) -> Result<Definition, State> {
        let fix = || self.place(procedure, &leg.fix, State::NoFix);
        let navaid = || self.place(procedure, &leg.navaid, State::NoNavaid);
        let course = || self.true_course(procedure, leg, leg.course.ok_or(State::NotCoded)?);
        let miles = match leg.extent {
            Some(Extent::Metres(m)) => Some(Metres::new(m)),
            _ => None,
        };
        Ok(match leg.terminator.as_str() {
            "IF" => Definition::Point(fix()?),
            "TF" => Definition::Track(fix()?),
            "DF" => Definition::Direct(fix()?),
            "CF" => Definition::CourseTo(fix()?, course()?, miles),
            "RF" => Definition::Circle { to: fix()?, centre: self.place(procedure, &leg.centre, State::NoCentre)?, right: right(leg)? },
            "AF" => Definition::DmeArc {
                to: fix()?,
                navaid: navaid()?,
                radius: Metres::new(leg.rho_m.ok_or(State::NotCoded)?),
                // The boundary radial stands in the columns of the course; theta is the radial of the fix.
                begin: course()?,
                right: right(leg)?,
            },
            "CA" | "CI" => Definition::Course { from: None, course: course()?, end: End::Open },
            "CD" => Definition::Course { from: None, course: course()?, end: End::AtDistance(navaid()?, miles.ok_or(State::NotCoded)?) },
            "CR" => Definition::Course { from: None, course: course()?, end: End::OnRadial(navaid()?, self.radial(procedure, leg)?) },
            "FA" | "FM" => Definition::Course { from: Some(fix()?), course: course()?, end: End::Open },
            "FC" => Definition::Course { from: Some(fix()?), course: course()?, end: miles.map_or(End::Open, End::After) },
            "FD" => {
                let end = End::AtDistance(navaid()?, miles.ok_or(State::NotCoded)?);
                Definition::Course { from: Some(fix()?), course: course()?, end }
            }
            "HA" | "HF" | "HM" => Definition::Hold { fix: fix()?, course: course()?, length: miles },
            _ => Definition::Without(State::NoPath),
        })
    }

    fn radial(&self, procedure: &Procedure, leg: &Leg) -> Result<Radians, State> {
        let rad = leg.theta_rad.ok_or(State::NotCoded)?;
        self.true_course(procedure, leg, Course { rad, true_north: false })
    }

    /// A course from true north.
    pub(super) fn true_course(&self, procedure: &Procedure, leg: &Leg, course: Course) -> Result<Radians, State> {
        let variation = if course.true_north { Some(0.0) } else { self.variation_rad(procedure, leg) };
        variation.map(|v| Radians::new(course.rad + v)).ok_or(State::NoVariation)
    }

    fn variation_rad(&self, procedure: &Procedure, leg: &Leg) -> Option<f64> {
        let navaid = self.fix(procedure.name.airport, &leg.navaid).and_then(|n| n.variation_rad);
        navaid.or_else(|| self.airport(procedure.name.airport.as_str()).and_then(|a| a.variation_rad))
    }
}

/// Distance from the airport beyond which a fix belongs to no such procedure: 100 NM and 500 NM (INFERRED: the farthest of 386 published ones are 33 NM
/// and 272 NM away) \[rad\].
fn far_rad(kind: Kind) -> f64 {
    (if kind == Kind::Approach { 100.0_f64 } else { 500.0 } / 60.0).to_radians()
}

/// Angle between two places at the centre of a sphere \[rad\].
fn angle_rad(a: &LatLon, b: &LatLon) -> f64 {
    let [[north, east], [to_north, to_east]] = [a, b].map(|p| [p.lat().rad(), p.lon().rad()]);
    let [up, aside] = [to_north - north, to_east - east].map(|d| (0.5 * d).sin().powi(2));
    2.0 * (up + north.cos() * to_north.cos() * aside).sqrt().min(1.0).asin()
}

fn right(leg: &Leg) -> Result<bool, State> {
    match leg.turn {
        b'R' => Ok(true),
        b'L' => Ok(false),
        _ => Err(State::NotCoded),
    }
}

/// The part of each leg of a route. The leg that ends at the final approach fix still belongs to the approach.
pub(super) fn parts(kind: Kind, route: &Route) -> Vec<Part> {
    if kind != Kind::Approach {
        return vec![Part::Terminal; route.legs.len()];
    }
    let (mut after_fix, mut missed) = (false, false);
    let mut parts = Vec::with_capacity(route.legs.len());
    for leg in &route.legs {
        missed |= leg.begins_missed();
        parts.push(if missed {
            Part::Missed
        } else if after_fix || leg.role() == b'M' {
            Part::Final
        } else {
            Part::Approach
        });
        after_fix |= leg.role() == b'F';
        missed |= leg.role() == b'M';
    }
    parts
}
