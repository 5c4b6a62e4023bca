//! Legs joined by fly-by turns.

use crate::line::Line;
use crate::refusal::{At, AtIndex};
use crate::turn::{Arc, Turn, anticipation, between, track_change};
use crate::{Foot, Place};
use navbound_core::frame::LatLon;
use navbound_core::quantity::{Metres, OutOfDomain, Radians};

/// A foot this far away is doubted, and the whole route searched: no aircraft follows a leg from there \[m\].
const STRAY_M: f64 = 10_000.0;

/// Geodesic legs between waypoints, with a fly-by turn at each waypoint between.
#[derive(Debug, Clone, PartialEq)]
pub struct Route {
    pieces: Vec<Piece>,
    /// Where the waypoints lie along the route; a flown-by waypoint counts at the middle of its turn.
    waypoints: Vec<Metres>,
    length: Metres,
}

#[derive(Debug, Clone, PartialEq)]
struct Piece {
    /// Distance along the route where it begins.
    start: Metres,
    length: Metres,
    leg: usize,
    shape: Shape,
}

#[derive(Debug, Clone, PartialEq)]
enum Shape {
    /// Part of a leg; the route enters it this far from the leg's first waypoint.
    Straight(Box<Line>, Metres),
    Turn(Arc),
}

impl Route {
    /// A route through waypoints with a turn radius at each; radius 0 is a corner. The first and the last radius have no turn to
    /// belong to and are not used.
    ///
    /// # Errors
    /// [`AtIndex`] with the waypoint: fewer than two points, two points in one place, a radius that is negative or not finite, or a turn
    /// so wide that it meets the next one on a leg.
    pub fn new(points: &[LatLon], radii: &[Metres]) -> Result<Self, AtIndex> {
        if !(points.len() >= 2 && points.len() == radii.len()) {
            let error = OutOfDomain { argument: "waypoints", value: points.len() as f64, unit: "1", domain: "two or more, a radius each" };
            return Err(AtIndex { index: radii.len().min(points.len()), error });
        }
        let lines = legs(points)?;
        let turns = turns(&lines, radii)?;
        Ok(join(&lines, &turns))
    }

    /// Track change at each waypoint between the first and the last, positive right.
    ///
    /// # Errors
    /// As [`Route::new`] for the points.
    pub fn track_changes(points: &[LatLon]) -> Result<Vec<Radians>, AtIndex> {
        let lines = legs(points)?;
        lines.windows(2).enumerate().map(|(i, pair)| track_change(&pair[0], &pair[1]).at(i + 1)).collect()
    }

    /// Length flown from the first waypoint to the last.
    pub fn length(&self) -> Metres {
        self.length
    }

    /// Where each waypoint lies along the route: the middle of its turn where it is flown by.
    pub fn waypoints_along(&self) -> &[Metres] {
        &self.waypoints
    }

    /// The path at a distance along it; before the begin and after the end the first and the last leg go on.
    ///
    /// # Errors
    /// [`OutOfDomain`] for a distance that is not finite.
    pub fn at(&self, along: Metres) -> Result<Place, OutOfDomain> {
        let piece = &self.pieces[self.piece_at(along)];
        let inside = Metres::new(along.m() - piece.start.m());
        let place = match &piece.shape {
            Shape::Straight(line, from) => line.at(Metres::new(from.m() + inside.m()))?,
            Shape::Turn(arc) => arc.at(inside)?,
        };
        Ok(Place { leg: piece.leg + place.leg, ..place })
    }

    /// Curvature of the path at a distance along it, positive in a right turn \[1/m\]: what guidance needs many times a second.
    pub fn curvature_per_m(&self, along: Metres) -> f64 {
        match &self.pieces[self.piece_at(along)].shape {
            Shape::Straight(..) => 0.0,
            Shape::Turn(arc) => arc.curvature_per_m(),
        }
    }

    /// The foot of a position.
    ///
    /// `near` is where along the route the position was last; the foot is sought from there, leg by leg. Without it, or when the foot
    /// found so is more than 10 km away (after a long gap), every piece is tried and the nearest taken, which is ambiguous where the
    /// route comes near itself.
    ///
    /// # Errors
    /// [`OutOfDomain`] for a `near` that is not finite, or a position further than 5000 km from the route.
    pub fn project(&self, position: &LatLon, near: Option<Metres>) -> Result<Foot, OutOfDomain> {
        match near {
            Some(near) if !near.m().is_finite() => {
                Err(OutOfDomain { argument: "near_along_m", value: near.m(), unit: "m", domain: "finite distances" })
            }
            Some(near) => {
                let foot = self.walk(position, near)?;
                if foot.cross.m().abs() <= STRAY_M { Ok(foot) } else { self.nearest(position) }
            }
            None => self.nearest(position),
        }
    }

    fn piece_at(&self, along: Metres) -> usize {
        self.pieces.partition_point(|p| p.start.m() <= along.m()).saturating_sub(1)
    }

    /// From piece to piece in the direction of the foot, until it lies inside one or the direction turns round at a corner.
    fn walk(&self, position: &LatLon, near: Metres) -> Result<Foot, OutOfDomain> {
        let mut index = self.piece_at(near);
        let mut foot = self.pieces[index].project(position, near)?;
        let mut came = 0;
        loop {
            let step = self.step(index, &foot);
            if step == 0 {
                return Ok(foot);
            }
            let next = if step > 0 { index + 1 } else { index - 1 };
            let other = self.pieces[next].project(position, foot.along)?;
            if came == -step {
                // Past the end of one piece and before the begin of the next: the outside of a corner.
                let corner = if step > 0 { self.pieces[next].start } else { self.pieces[index].start };
                let nearer = if overrun(&foot, corner) <= overrun(&other, corner) { foot } else { other };
                return Ok(Foot { along: corner, ..nearer });
            }
            (index, foot, came) = (next, other, step);
        }
    }

    /// +1 when the foot lies in a later piece, -1 in an earlier one, 0 here.
    fn step(&self, index: usize, foot: &Foot) -> i32 {
        let piece = &self.pieces[index];
        let inside = foot.along.m() - piece.start.m();
        // A joint is met to the micrometre on both sides.
        if inside < -1e-6 && index > 0 {
            -1
        } else if inside > piece.length.m() + 1e-6 && index + 1 < self.pieces.len() {
            1
        } else {
            0
        }
    }

    fn nearest(&self, position: &LatLon) -> Result<Foot, OutOfDomain> {
        let mut best: Option<(f64, Metres)> = None;
        for piece in &self.pieces {
            let foot = piece.project(position, piece.start)?;
            let inside = foot.along.m() - piece.start.m();
            let beyond = (inside - inside.clamp(0.0, piece.length.m())).abs();
            let distance = foot.cross.m().hypot(beyond);
            if best.is_none_or(|(d, _)| distance < d) {
                best = Some((distance, Metres::new(piece.start.m() + inside.clamp(0.0, piece.length.m()))));
            }
        }
        self.walk(position, best.map_or(Metres::new(0.0), |(_, along)| along))
    }
}

impl Piece {
    fn project(&self, position: &LatLon, near: Metres) -> Result<Foot, OutOfDomain> {
        let (foot, from) = match &self.shape {
            Shape::Straight(line, from) => (line.project_near(position, Metres::new(from.m() + near.m() - self.start.m()))?, from.m()),
            Shape::Turn(arc) => (arc.project(position)?, 0.0),
        };
        Ok(Foot { along: Metres::new(self.start.m() + foot.along.m() - from), leg: self.leg + foot.leg, ..foot })
    }
}

fn overrun(foot: &Foot, corner: Metres) -> f64 {
    (foot.along.m() - corner.m()).abs()
}

fn legs(points: &[LatLon]) -> Result<Vec<Line>, AtIndex> {
    points.windows(2).enumerate().map(|(i, pair)| Line::through(pair[0], pair[1]).at(i + 1)).collect()
}

fn turns(lines: &[Line], radii: &[Metres]) -> Result<Vec<Option<Turn>>, AtIndex> {
    let mut used_before = 0.0;
    let mut turns = Vec::new();
    for i in 1..lines.len() {
        let radius = radii[i];
        if !(radius.m() >= 0.0 && radius.m() <= 1e6) {
            return Err(AtIndex {
                index: i,
                error: OutOfDomain { argument: "radius_m", value: radius.m(), unit: "m", domain: "[0, 1e6]" },
            });
        }
        let ahead = anticipation(radius, track_change(&lines[i - 1], &lines[i]).at(i)?).m();
        if !(used_before + ahead <= lines[i - 1].length().m()) {
            return Err(too_wide(i, radius));
        }
        used_before = ahead;
        if i + 1 == lines.len() && !(ahead <= lines[i].length().m()) {
            return Err(too_wide(i, radius));
        }
        turns.push(between(&lines[i - 1], &lines[i], radius).at(i)?);
    }
    Ok(turns)
}

fn too_wide(index: usize, radius: Metres) -> AtIndex {
    let error = OutOfDomain { argument: "radius_m", value: radius.m(), unit: "m", domain: "radii whose turns fit on the legs beside them" };
    AtIndex { index, error }
}

fn join(lines: &[Line], turns: &[Option<Turn>]) -> Route {
    let (mut pieces, mut waypoints) = (Vec::new(), vec![Metres::new(0.0)]);
    let (mut along, mut from) = (0.0, 0.0);
    for (leg, line) in lines.iter().enumerate() {
        let turn = turns.get(leg).copied().flatten();
        let end = turn.map_or(line.length(), |t| t.begin).m();
        pieces.push(Piece {
            start: Metres::new(along),
            length: Metres::new(end - from),
            leg,
            shape: Shape::Straight(Box::new(*line), Metres::new(from)),
        });
        along += end - from;
        let arc = turn.map_or(0.0, |t| t.arc.length().m());
        waypoints.push(Metres::new(along + 0.5 * arc));
        if let Some(t) = turn {
            pieces.push(Piece { start: Metres::new(along), length: Metres::new(arc), leg, shape: Shape::Turn(t.arc) });
        }
        along += arc;
        from = turn.map_or(0.0, |t| t.end.m());
    }
    Route { pieces, waypoints, length: Metres::new(along) }
}
