//! Contradictions in the published data, each with the line that holds it.
//!
//! An RF leg is over-determined: its geometry comes from fixes alone and every other number is a check. Limits (ours, from cycle 2604): half
//! a unit of the rounded radius is 9.26 m, a length is rounded to 0.1 NM, courses agree within 0.16 degrees at 95 %.

use super::geometry::Part;
use super::record::{Kind, Leg, LevelOfService, Procedure, Route};
use super::requirement::{TERMINAL_MOST_M, published, too_large};
use super::{Course, Database, Extent, Text, geometry};
use core::f64::consts::{PI, TAU};
use navbound_path::legs::State;

const CENTRE_MOVED_M: f64 = 5.0;
const UNEVEN_M: f64 = 5.0;
const RADIUS_M: f64 = 10.0;
const COURSE_RAD: f64 = 2.0 * PI / 180.0;
const LENGTH_M: f64 = 185.2;
/// An RNP this many times another is a slip of the exponent (INFERRED) \[1\].
const SLIP: f64 = 5.0;
/// Path point and runway record agree within 1 m at 99.7 % of 4,225 thresholds, and within 8.1 m at all but one (INFERRED) \[m\].
const HEIGHT_M: f64 = 10.0;

/// What contradicts what.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Contradiction {
    /// The fixes of an arc are not equally far from its published centre.
    Centre,
    /// The coded radius is not that of the fixes.
    Radius,
    /// A coded course is not that of the arc.
    Course,
    /// The coded length is not that of the arc.
    Length,
    /// The RNP grows on the final part of the approach.
    RnpGrows,
    /// The RNP grows inside a transition.
    RnpGrowsEarly,
    /// The field of the last leg of the final approach differs from every line of minima by a factor of five or more.
    RnpAndLevel,
    /// The RNP of a leg is larger than that of any specification of such a procedure.
    RnpTooLarge,
    /// The last leg of the final approach has no RNP, the procedure has lines of minima.
    RnpMissing,
    /// The path point's height above mean sea level is not that of the runway record.
    Height,
    /// A fix, centre or navaid that a leg needs is not in the file, or has two positions there.
    Unresolved,
    /// A line of the route was refused: it is not whole.
    NotWhole,
    /// The file's record numbers leave records out.
    Missing,
}

impl Contradiction {
    /// All of them.
    pub const ALL: [Self; 13] = [
        Self::Centre,
        Self::Radius,
        Self::Course,
        Self::Length,
        Self::RnpGrows,
        Self::RnpGrowsEarly,
        Self::RnpAndLevel,
        Self::RnpTooLarge,
        Self::RnpMissing,
        Self::Height,
        Self::Unresolved,
        Self::NotWhole,
        Self::Missing,
    ];
    /// Whether it is a remark: unusual or not whole, while no two records contradict each other.
    pub const fn is_remark(self) -> bool {
        matches!(self, Self::RnpGrowsEarly | Self::Unresolved | Self::NotWhole)
    }
    /// Stable id.
    pub const fn id(self) -> &'static str {
        match self {
            Self::Centre => "centre",
            Self::Radius => "radius",
            Self::Course => "course",
            Self::Length => "length",
            Self::RnpGrows => "rnp_grows",
            Self::RnpGrowsEarly => "rnp_grows_early",
            Self::RnpAndLevel => "rnp_and_level",
            Self::RnpTooLarge => "rnp_too_large",
            Self::RnpMissing => "rnp_missing",
            Self::Height => "height",
            Self::Unresolved => "unresolved",
            Self::NotWhole => "not_whole",
            Self::Missing => "missing",
        }
    }
}

/// One contradiction.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// Line in the file.
    pub line: usize,
    /// Airport.
    pub airport: Text<4>,
    /// Procedure.
    pub procedure: Text<6>,
    /// Transition; blank for the final part.
    pub transition: Text<5>,
    /// Sequence number of the leg, where one is at fault.
    pub sequence: Option<i32>,
    /// What contradicts what.
    pub kind: Contradiction,
    /// What the file has \[m\] or \[rad\].
    pub published: f64,
    /// What the other records or the fixes have, in the same unit.
    pub expected: f64,
}

/// Where a finding belongs.
#[derive(Clone, Copy)]
struct At<'a> {
    procedure: &'a Procedure,
    transition: Text<5>,
}

impl At<'_> {
    fn finding(self, line: usize, sequence: Option<i32>, kind: Contradiction, published: f64, expected: f64) -> Finding {
        let name = &self.procedure.name;
        Finding { line, airport: name.airport, procedure: name.ident, transition: self.transition, sequence, kind, published, expected }
    }
}

impl Database {
    /// All contradictions, in the order of the file's procedures; those of path points last.
    pub fn contradictions(&self) -> Vec<Finding> {
        let mut findings = Vec::new();
        for procedure in self.procedures() {
            for route in &procedure.routes {
                let at = At { procedure, transition: route.transition };
                findings.extend(route.refused.iter().map(|l| at.finding(*l, None, Contradiction::NotWhole, f64::NAN, f64::NAN)));
                let inside = route.gaps.iter().filter(|g| g.inside);
                findings.extend(inside.map(|g| at.finding(g.line, None, Contradiction::Missing, 0.0, f64::from(g.n_missing))));
                self.geometry(at, route, &mut findings);
                requirements(at, route, &mut findings);
            }
        }
        self.heights(&mut findings);
        findings
    }

    fn geometry(&self, at: At<'_>, route: &Route, findings: &mut Vec<Finding>) {
        let built = self.path_of(at.procedure, &[route], true);
        let mut before: Option<&Leg> = None;
        for (coded, leg) in built.legs.iter().zip(built.path.legs()) {
            let coded = &coded.leg;
            let before = before.replace(coded);
            let mut add = |kind, published, expected| {
                findings.push(at.finding(coded.line, Some(coded.sequence), kind, published, expected));
            };
            if matches!(leg.state, State::NoFix | State::NoCentre | State::NoNavaid | State::AmbiguousFix | State::Impossible) {
                add(Contradiction::Unresolved, f64::NAN, f64::NAN);
            }
            let Some(residuals) = leg.residuals.filter(|_| coded.terminator.as_str() == "RF") else { continue };
            let (start, end) = (residuals.start_to_centre.m(), residuals.end_to_centre.m());
            if residuals.centre_moved.m() > CENTRE_MOVED_M || (start - end).abs() > UNEVEN_M {
                add(Contradiction::Centre, start, end);
            }
            if let Some(published) = coded.radius_m {
                let further = if (published - start).abs() > (published - end).abs() { start } else { end };
                if (published - further).abs() > RADIUS_M {
                    add(Contradiction::Radius, published, further);
                }
            }
            if let Some(Extent::Metres(published)) = coded.extent
                && (published - leg.length.m()).abs() > LENGTH_M
            {
                add(Contradiction::Length, published, leg.length.m());
            }
            // The outbound course of the arc before, repeated, is its slip and not a second one.
            let repeated = before.is_some_and(|b| b.terminator == coded.terminator && b.course.map(|c| c.rad) == coded.theta_rad);
            let begin = coded.theta_rad.filter(|_| !repeated).map(|rad| Course { rad, true_north: false });
            for (course, expected) in [(begin, residuals.course_begin.rad()), (coded.course, residuals.course_end.rad())] {
                let Some(published) = course.and_then(|c| self.true_course(at.procedure, coded, c).ok()).map(|c| c.rad()) else { continue };
                if ((published - expected + PI).rem_euclid(TAU) - PI).abs() > COURSE_RAD {
                    add(Contradiction::Course, published.rem_euclid(TAU), expected);
                }
            }
        }
    }

    fn heights(&self, findings: &mut Vec<Finding>) {
        for point in self.path_points() {
            let runway = self.runway(point.airport, point.runway).and_then(|r| r.elevation_m);
            let (Some(published), Some(expected)) = (point.orthometric_height_m, runway) else { continue };
            if (published - expected).abs() > HEIGHT_M {
                findings.push(Finding {
                    line: point.continuation_line.unwrap_or(point.line),
                    airport: point.airport,
                    procedure: point.approach,
                    transition: Text::new(""),
                    sequence: None,
                    kind: Contradiction::Height,
                    published,
                    expected,
                });
            }
        }
    }
}

/// RNP along the way in, and that of the last leg against the lines of minima; of procedures that code one.
fn requirements(at: At<'_>, route: &Route, findings: &mut Vec<Finding>) {
    for (leg, rnp_m) in route.legs.iter().filter_map(|l| Some((l, l.rnp_m.filter(|m| too_large(*m))?))) {
        findings.push(at.finding(leg.line, Some(leg.sequence), Contradiction::RnpTooLarge, rnp_m, TERMINAL_MOST_M));
    }
    if at.procedure.name.kind != Kind::Approach {
        return;
    }
    let levels = &at.procedure.levels;
    let mut before = f64::INFINITY;
    for (leg, part) in route.legs.iter().zip(geometry::parts(Kind::Approach, route)) {
        if part == Part::Missed {
            break;
        }
        let mut add = |line, kind, published, expected| findings.push(at.finding(line, Some(leg.sequence), kind, published, expected));
        if let Some(rnp_m) = leg.rnp_m {
            if rnp_m > before {
                let kind = if at.transition.is_blank() { Contradiction::RnpGrows } else { Contradiction::RnpGrowsEarly };
                add(leg.line, kind, rnp_m, before);
            }
            before = rnp_m;
        }
        if leg.role() != b'M' || levels.is_empty() {
            continue;
        }
        match leg.rnp_m {
            None => add(leg.line, Contradiction::RnpMissing, f64::NAN, levels[0].rnp_m),
            Some(rnp_m) if !published(rnp_m, levels) => {
                if let Some(level) = levels.iter().find(|l| slipped(rnp_m, l, levels)) {
                    // The larger of the two is the one that would call a flight inside.
                    let line = if level.rnp_m > rnp_m { level.line } else { leg.line };
                    add(line, Contradiction::RnpAndLevel, rnp_m, level.rnp_m);
                }
            }
            Some(_) => {}
        }
    }
}

fn slipped(rnp_m: f64, level: &LevelOfService, levels: &[LevelOfService]) -> bool {
    let ratio = |l: &LevelOfService| (l.rnp_m / rnp_m).max(rnp_m / l.rnp_m);
    ratio(level) >= SLIP && levels.iter().all(|l| ratio(l) >= SLIP)
}
