//! Which leg is active, for positions in the order flown.
//!
//! The nearest leg is wrong where a procedure comes near itself. The first leg is therefore the nearest whose course agrees with the track;
//! from there the legs are walked forwards. An aircraft counts as established before anything is judged, so that vectors to the final
//! approach are no exceedance. The numbers of [`Limits`] are INFERRED.

use super::{LegFoot, PathLeg, ProcedurePath, State};
use crate::earth::{MEAN_RADIUS_M, half_turn};
use crate::refusal::{At, AtIndex};
use core::f64::consts::FRAC_PI_2;
use navbound_core::frame::LatLon;
use navbound_core::quantity::{Metres, OutOfDomain, Radians};

/// Standard gravity \[m/s²\] (standard: CGPM 1901).
const GRAVITY_MPS2: f64 = 9.806_65;
const NAUTICAL_MILE_M: f64 = Metres::nautical_miles(1.0).m();
/// Track changes below this need no turn \[rad\].
const STRAIGHT_RAD: f64 = 1e-7;

/// What following goes by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Standard deviation of positions along the track \[m\].
    pub sigma_along_m: f64,
    /// After so long without a position the leg is sought again \[s\].
    pub gap_s: f64,
    /// The next leg must be nearer for so long \[s\].
    pub nearer_s: f64,
    /// So long within RNP and near the course is established \[s\].
    pub established_s: f64,
    /// How near the course \[rad\].
    pub established_rad: f64,
    /// Bank of a nominal fly-by turn \[rad\].
    pub bank_rad: f64,
}

impl Default for Limits {
    /// INFERRED: 10 m of a broadcast position; 30 s, 3 s, 10 s and 30 degrees; 18 degrees, the design bank of RNP AR criteria.
    fn default() -> Self {
        Self {
            sigma_along_m: 10.0,
            gap_s: 30.0,
            nearer_s: 3.0,
            established_s: 10.0,
            established_rad: 30.0_f64.to_radians(),
            bank_rad: 18.0_f64.to_radians(),
        }
    }
}

/// What a deviation is worth at one position.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tracked {
    /// On a leg and established.
    Ok,
    /// In the turn between two straight legs, where no single path is defined.
    Transition,
    /// Beside the inbound leg of a hold.
    Holding,
    /// Before the begin or beyond the end of the path.
    Outside,
    /// Near a leg, not yet established.
    NotEstablished,
    /// Further than 2 RNP and 1 NM from every leg.
    OffPath,
    /// No position.
    Missing,
}

impl Tracked {
    /// All of them, in the order of their numbers.
    pub const ALL: [Self; 7] =
        [Self::Ok, Self::Transition, Self::Holding, Self::Outside, Self::NotEstablished, Self::OffPath, Self::Missing];
    /// Stable id.
    pub const fn id(self) -> &'static str {
        match self {
            Self::Ok => "ok",
            Self::Transition => "transition",
            Self::Holding => "holding",
            Self::Outside => "outside",
            Self::NotEstablished => "not_established",
            Self::OffPath => "off_path",
            Self::Missing => "missing",
        }
    }
}

/// One position followed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Followed {
    /// Foot on the active leg; None off path.
    pub foot: Option<LegFoot>,
    /// What its deviation is worth.
    pub status: Tracked,
}

/// One position with its time and motion.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Fix {
    time_s: f64,
    place: LatLon,
    track_rad: f64,
    speed_mps: f64,
}

/// A flight along a procedure, position by position.
#[derive(Debug, Clone)]
pub struct Follow<'a> {
    path: &'a ProcedurePath,
    rnp_m: &'a [f64],
    limits: Limits,
    /// Track change at the end of each leg that a fly-by turn joins to the next \[rad\].
    changes: Vec<Option<f64>>,
    active: Option<Active>,
    last: Option<(f64, LatLon)>,
    aligned_since: Option<f64>,
    established: bool,
}

#[derive(Debug, Clone, Copy)]
struct Active {
    leg: usize,
    /// Furthest foot on it.
    furthest_m: f64,
    /// Since when the next leg has been nearer.
    nearer_since: Option<f64>,
}

impl<'a> Follow<'a> {
    /// Follows a path whose legs have these RNP (NaN where unknown) and whose fixes are flown over or by.
    ///
    /// # Errors
    /// [`OutOfDomain`] unless there is one of each a leg.
    pub fn new(path: &'a ProcedurePath, rnp_m: &'a [f64], fly_over: &'a [bool], limits: Limits) -> Result<Self, OutOfDomain> {
        let n = path.legs().len();
        for (argument, length) in [("rnp_m", rnp_m.len()), ("fly_over", fly_over.len())] {
            if length != n {
                return Err(OutOfDomain { argument, value: length as f64, unit: "items", domain: "one item a leg" });
            }
        }
        let joints = path.legs().windows(2).zip(fly_over);
        let changes = joints.map(|(pair, over)| if *over { None } else { track_change(&pair[0], &pair[1]) }).collect();
        Ok(Self { path, rnp_m, limits, changes, active: None, last: None, aligned_since: None, established: false })
    }

    /// All positions of a flight; both angles NaN is a missing one. Once the flight is established, the positions of the interval that
    /// established it count too.
    ///
    /// # Errors
    /// [`AtIndex`] for the first that is not on the Earth, more than 5000 km away, or whose time does not rise.
    pub fn all(mut self, time_s: &[f64], lat_rad: &[f64], lon_rad: &[f64]) -> Result<Vec<Followed>, AtIndex> {
        let mut followed: Vec<Followed> = Vec::with_capacity(time_s.len());
        // Positions since the flight is near the path, with what they are worth once it is established.
        let mut waiting: Vec<(usize, Tracked)> = Vec::new();
        for (i, ((&t, &lat), &lon)) in time_s.iter().zip(lat_rad).zip(lon_rad).enumerate() {
            if lat.is_nan() && lon.is_nan() {
                followed.push(Followed { foot: None, status: Tracked::Missing });
                continue;
            }
            let place = LatLon::new(Radians::new(lat), Radians::new(lon)).at(i)?;
            // The first position has the track to the second.
            let ahead = || -> Option<(f64, LatLon)> {
                let (t1, lat1, lon1) = (*time_s.get(i + 1)?, *lat_rad.get(i + 1)?, *lon_rad.get(i + 1)?);
                Some((t1, LatLon::new(Radians::new(lat1), Radians::new(lon1)).ok()?))
            };
            let (step, then) = self.step(t, &place, if self.last.is_none() { ahead() } else { None }).at(i)?;
            followed.push(step);
            if self.aligned_since.is_none() {
                waiting.clear();
            } else if self.established {
                waiting.drain(..).for_each(|(k, status)| followed[k].status = status);
            } else {
                waiting.push((i, then));
            }
        }
        Ok(followed)
    }

    fn step(&mut self, time_s: f64, place: &LatLon, ahead: Option<(f64, LatLon)>) -> Result<(Followed, Tracked), OutOfDomain> {
        if !(time_s.is_finite() && self.last.is_none_or(|(t, _)| time_s > t)) {
            return Err(OutOfDomain { argument: "time_s", value: time_s, unit: "s", domain: "times that rise" });
        }
        if self.last.is_some_and(|(t, _)| time_s - t > self.limits.gap_s) {
            (self.active, self.aligned_since, self.established) = (None, None, false);
        }
        let (track_rad, speed_mps) = match (self.last, ahead) {
            (Some((t, from)), _) => motion(&from, place, time_s - t),
            (None, Some((t, to))) => motion(place, &to, t - time_s),
            (None, None) => (f64::NAN, f64::NAN),
        };
        self.last = Some((time_s, *place));
        let fix = Fix { time_s, place: *place, track_rad, speed_mps };
        let foot = match self.active {
            Some(active) => self.walk(&fix, active)?,
            None => self.seek(&fix)?,
        };
        self.judge(&fix, foot)
    }

    /// The nearest leg whose course agrees with the track.
    fn seek(&mut self, fix: &Fix) -> Result<Option<LegFoot>, OutOfDomain> {
        let mut best: Option<(f64, LegFoot)> = None;
        for leg in self.path.legs().iter().filter(|leg| leg.has_path()) {
            let foot = leg.project(&fix.place)?;
            let distance = foot.foot.cross.m().hypot(leg.beyond(foot.foot.along.m()));
            let agrees = !(half_turn(foot.foot.course.rad() - fix.track_rad).abs() >= FRAC_PI_2);
            if agrees && best.is_none_or(|(d, _)| distance < d) {
                best = Some((distance, foot));
            }
        }
        self.active = best.map(|(_, f)| Active { leg: f.foot.leg, furthest_m: f.foot.along.m(), nearer_since: None });
        Ok(best.map(|(_, foot)| foot))
    }

    /// Forwards from the active leg.
    fn walk(&mut self, fix: &Fix, active: Active) -> Result<Option<LegFoot>, OutOfDomain> {
        let slack = 3.0 * self.limits.sigma_along_m;
        let legs = self.path.legs();
        let mut active = active;
        let mut foot = legs[active.leg].project_near(&fix.place, near(active.furthest_m))?;
        while let Some(next) = legs.iter().skip(active.leg + 1).find(|leg| leg.has_path()) {
            // Within the noise of its own leg no other is nearer.
            if side(&legs[active.leg], &foot) <= slack && inside(&legs[active.leg], &foot) {
                active.nearer_since = None;
                break;
            }
            let other = next.project(&fix.place)?;
            let passed = foot.foot.along.m() > legs[active.leg].length.m() + slack;
            let nearer = inside(next, &other) && side(next, &other) < side(&legs[active.leg], &foot);
            active.nearer_since = if nearer { active.nearer_since.or(Some(fix.time_s)) } else { None };
            let long_enough = active.nearer_since.is_some_and(|since| fix.time_s - since >= self.limits.nearer_s);
            // A point past the end whose foot lies inside the next leg belongs to it at once.
            let handed_over = foot.foot.along.m() > legs[active.leg].length.m() && inside(next, &other);
            if !(passed || long_enough || handed_over) {
                break;
            }
            (active, foot) = (Active { leg: next.index, furthest_m: f64::NEG_INFINITY, nearer_since: None }, other);
        }
        if foot.foot.along.m() < active.furthest_m - slack && foot.foot.along.m() < legs[active.leg].length.m() {
            return self.seek(fix);
        }
        active.furthest_m = active.furthest_m.max(foot.foot.along.m());
        self.active = Some(active);
        Ok(Some(foot))
    }

    /// The position's worth, and what it would be of an established flight.
    fn judge(&mut self, fix: &Fix, foot: Option<LegFoot>) -> Result<(Followed, Tracked), OutOfDomain> {
        let off = (Followed { foot: None, status: Tracked::OffPath }, Tracked::OffPath);
        let Some(foot) = foot else {
            self.lose();
            return Ok(off);
        };
        let leg = &self.path.legs()[foot.foot.leg];
        let rnp_m = self.rnp(foot.foot.leg);
        if side(leg, &foot) > 2.0 * rnp_m + NAUTICAL_MILE_M && self.far_from_all(fix)? {
            self.lose();
            return Ok(off);
        }
        let off_course = half_turn(fix.track_rad - foot.foot.course.rad()).abs();
        let aligned = foot.foot.cross.m().abs() < rnp_m && off_course < self.limits.established_rad;
        self.aligned_since = if aligned { self.aligned_since.or(Some(fix.time_s)) } else { None };
        self.established |= self.aligned_since.is_some_and(|since| fix.time_s - since >= self.limits.established_s);
        let then = self.status(fix, leg, &foot, off_course);
        Ok((Followed { foot: Some(foot), status: if self.established { then } else { Tracked::NotEstablished } }, then))
    }

    /// What the position of an established flight is worth.
    fn status(&self, fix: &Fix, leg: &PathLeg, foot: &LegFoot, off_course: f64) -> Tracked {
        let along = foot.foot.along.m();
        if leg.state == State::Holding && !(off_course < self.limits.established_rad && inside(leg, foot)) {
            Tracked::Holding
        } else if self.is_end(leg, along) {
            Tracked::Outside
        } else if self.turning(leg, along, fix.speed_mps) {
            Tracked::Transition
        } else {
            Tracked::Ok
        }
    }

    /// Before the begin of the first leg with a path, or beyond the end of the last.
    fn is_end(&self, leg: &PathLeg, along: f64) -> bool {
        let mut with_path = self.path.legs().iter().filter(|l| l.has_path());
        let first = with_path.next().is_some_and(|l| l.index == leg.index);
        let last = with_path.next_back().map_or(first, |l| l.index == leg.index);
        (first && along < 0.0) || (last && along > leg.length.m())
    }

    /// Whether a position lies in the nominal turn at either end of a straight leg.
    fn turning(&self, leg: &PathLeg, along: f64, speed_mps: f64) -> bool {
        let before = leg.index.checked_sub(1).and_then(|i| self.anticipation(i, speed_mps));
        let after = self.anticipation(leg.index, speed_mps);
        let half = 0.5 * leg.length.m();
        before.is_some_and(|d| along < d.min(half)) || after.is_some_and(|d| along > leg.length.m() - d.min(half))
    }

    /// Distance before and behind the end of a leg in which a fly-by turn is flown: R tan(|d|/2) with R = V^2 / (g tan bank).
    fn anticipation(&self, leg: usize, speed_mps: f64) -> Option<f64> {
        let change = self.changes.get(leg).copied().flatten()?;
        let radius = speed_mps * speed_mps / (GRAVITY_MPS2 * self.limits.bank_rad.tan());
        Some(radius * (0.5 * change).tan())
    }

    fn lose(&mut self) {
        (self.active, self.aligned_since, self.established) = (None, None, false);
    }

    /// RNP of a leg for what is near it: where it is unknown, the least that is known, so that no leg widens another.
    fn rnp(&self, leg: usize) -> f64 {
        let own = self.rnp_m[leg];
        if own.is_finite() { own } else { self.rnp_m.iter().copied().filter(|r| r.is_finite()).fold(NAUTICAL_MILE_M, f64::min) }
    }

    fn far_from_all(&self, fix: &Fix) -> Result<bool, OutOfDomain> {
        for leg in self.path.legs().iter().filter(|leg| leg.has_path()) {
            let foot = leg.project(&fix.place)?;
            if !(side(leg, &foot) > 2.0 * self.rnp(leg.index) + NAUTICAL_MILE_M) {
                return Ok(false);
            }
        }
        Ok(true)
    }
}

/// Track change from one straight leg to the next; None where there is nothing to turn.
fn track_change(before: &PathLeg, after: &PathLeg) -> Option<f64> {
    let straight = before.radius().is_none() && after.radius().is_none() && before.length.m().is_finite();
    if !(straight && before.has_path() && after.has_path()) {
        return None;
    }
    let (arrive, depart) = (before.at(before.length).ok()?, after.at(Metres::new(0.0)).ok()?);
    let change = half_turn(depart.course.rad() - arrive.course.rad()).abs();
    (change > STRAIGHT_RAD).then_some(change)
}

fn near(along: f64) -> Option<f64> {
    along.is_finite().then_some(along)
}

fn inside(leg: &PathLeg, foot: &LegFoot) -> bool {
    leg.beyond(foot.foot.along.m()) == 0.0
}

/// Distance of a position from the leg's own extent.
fn side(leg: &PathLeg, foot: &LegFoot) -> f64 {
    foot.foot.cross.m().hypot(leg.beyond(foot.foot.along.m()))
}

/// Track and speed between two positions in the plane of their middle: what they are compared with is degrees wide.
fn motion(from: &LatLon, to: &LatLon, dt_s: f64) -> (f64, f64) {
    let north = to.lat().rad() - from.lat().rad();
    let east = half_turn(to.lon().rad() - from.lon().rad()) * (0.5 * (to.lat().rad() + from.lat().rad())).cos();
    (east.atan2(north), MEAN_RADIUS_M * east.hypot(north) / dt_s)
}

impl ProcedurePath {
    /// The nearest leg of a position by itself, without a time: its own extent counts, not its continuation.
    ///
    /// # Errors
    /// [`OutOfDomain`] for a position further than 5000 km from a leg, or a procedure without a path.
    pub fn nearest(&self, position: &LatLon) -> Result<LegFoot, OutOfDomain> {
        let mut best: Option<(f64, LegFoot)> = None;
        for leg in self.legs().iter().filter(|leg| leg.has_path()) {
            let foot = leg.project(position)?;
            let distance = side(leg, &foot);
            if best.is_none_or(|(d, _)| distance < d) {
                best = Some((distance, foot));
            }
        }
        best.map(|(_, foot)| foot).ok_or(OutOfDomain { argument: "procedure", value: 0.0, unit: "legs", domain: "legs with a path" })
    }
}
