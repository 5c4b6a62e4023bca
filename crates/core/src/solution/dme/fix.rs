//! Position from DME slant ranges at a known altitude: Gauss-Newton over the Earth, the mirror position rejected.

use super::Place;
use super::intersection::meet;
use super::normal::{Normal, Solved};
use crate::frame::{Covariance, EcefPosition, Enu, Geodetic, ecef_from_geodetic, geodetic_from_ecef};
use crate::quantity::{Metres, OutOfDomain, Radians, Reason};
use crate::special::float::{cos, ln, sin, sqrt};
use crate::special::gamma::chi_square_tail;
use nalgebra::Vector3;

/// A measured slant range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Where the station's antenna is.
    pub station: EcefPosition,
    /// Measured distance.
    pub slant: Metres,
    /// Its standard deviation.
    pub sigma: Metres,
}

/// The altitude that is taken as known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Altitude {
    /// Height above the ellipsoid.
    pub height: Metres,
    /// Standard deviation of that; all ranges share its error.
    pub sigma: Metres,
}

/// What is known of the position beforehand. It tells the position from its mirror and adds nothing to the solution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prior {
    /// About there.
    pub position: Geodetic,
    /// And certainly not farther away than this.
    pub within: Metres,
}

/// A position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fix {
    /// Where; the height is the one given.
    pub position: Geodetic,
    /// Covariance of the navigation error.
    pub covariance: Covariance<Enu>,
    /// Measurements used.
    pub used: usize,
    /// Weighted sum of squared residuals.
    pub chi_square: f64,
    /// Risk of residuals as large, if the errors are as the weights say; `None` without redundancy.
    pub p_residual: Option<f64>,
}

impl Fix {
    /// Root of the horizontal trace: the distance root mean square.
    pub fn drms(&self) -> Metres {
        Metres::new(sqrt(self.covariance.horizontal().trace()))
    }
    /// Standard deviation across a course.
    pub fn lateral_sigma(&self, course: Radians) -> Metres {
        Metres::new(sqrt(self.covariance.variance_along(&Vector3::new(cos(course.rad()), -sin(course.rad()), 0.0))))
    }
}

/// Why there is no position.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NoFix {
    /// Fewer than two ranges.
    #[error("{}", Reason::TooFewRanges.words())]
    TooFewRanges,
    /// The stations and the aircraft lie in one line.
    #[error("{}", Reason::StationsInLine.words())]
    Singular,
    /// The ranges do not meet at the altitude.
    #[error("{}", Reason::RangesApart.words())]
    Apart,
    /// The position and its mirror fit alike.
    #[error("{}", Reason::Ambiguous.words())]
    Ambiguous,
    /// No solution near the prior.
    #[error("{}", Reason::FarFromPrior.words())]
    FarFromPrior,
    /// The iteration did not settle.
    #[error("{}", Reason::NotConverged.words())]
    NotSettled,
    /// Overhead of a VOR.
    #[error("{}", Reason::OverheadVor.words())]
    Overhead,
    /// A number outside its domain.
    #[error(transparent)]
    Invalid(#[from] OutOfDomain),
}

impl NoFix {
    /// Its entry in the list of reasons.
    pub const fn reason(&self) -> Reason {
        match self {
            Self::TooFewRanges => Reason::TooFewRanges,
            Self::Singular => Reason::StationsInLine,
            Self::Apart => Reason::RangesApart,
            Self::Ambiguous => Reason::Ambiguous,
            Self::FarFromPrior => Reason::FarFromPrior,
            Self::NotSettled => Reason::NotConverged,
            Self::Overhead => Reason::OverheadVor,
            Self::Invalid(_) => Reason::InvalidNumber,
        }
    }
}

/// A step below this ends the iteration (metres of equal ranges at right angles; a weak geometry magnifies rounding likewise).
const SETTLED_M: f64 = 1e-6;
const STEPS_MOST: usize = 20;
/// The mirror is rejected where the position is this much likelier, both being as likely beforehand. Ours.
const MIRROR_ODDS: f64 = 1e5;

/// Position from slant ranges, all weighted, with the altitude error common to them.
///
/// ```text
/// row_i = (e, n) of the unit vector from station to aircraft,  w_i its up component
/// C     = (H' R^-1 H)^-1      R = diag(sigma_i^2) + sigma_h^2 w w'
/// ```
///
/// Two ranges have two solutions: `prior` chooses, and without one there is none. Three or more begin at the prior; without one, or where
/// that leads astray, at both meetings of the pair that meets best, of which the residuals choose.
///
/// # Errors
/// [`NoFix`], also for a range, a deviation or an altitude that is not a number of its kind.
pub fn solve(ranges: &[Range], altitude: &Altitude, prior: Option<&Prior>) -> Result<Fix, NoFix> {
    check(ranges, altitude)?;
    match (ranges, prior) {
        ([] | [_], _) => Err(NoFix::TooFewRanges),
        ([_, _], None) => Err(NoFix::Ambiguous),
        ([a, b], Some(prior)) => {
            let meeting = meet(a, b, altitude.height).ok_or(NoFix::Apart)?;
            near(meeting.places.map(|p| settle(ranges, altitude, &p)), prior)
        }
        (_, Some(prior)) => {
            let start = ecef_from_geodetic(&prior.position);
            let allowed = |fix: &Fix| distance(fix, &start) <= prior.within.m();
            // From far off the iteration may end beside a station or at the mirror; the meetings are then the better beginning.
            let fits = |fix: &Fix| fix.p_residual.is_some_and(|p| p * MIRROR_ODDS >= 1.0);
            match settle(ranges, altitude, &start) {
                Ok(direct) if allowed(&direct) && fits(&direct) => Ok(direct),
                direct => likelier(ranges, altitude, allowed).map_err(|e| direct.err().unwrap_or(e)),
            }
        }
        (_, None) => likelier(ranges, altitude, |_| true),
    }
}

fn check(ranges: &[Range], altitude: &Altitude) -> Result<(), OutOfDomain> {
    let (h, sigma_h) = (altitude.height.m(), altitude.sigma.m());
    if !h.is_finite() {
        return Err(OutOfDomain { argument: "h_m", value: h, unit: "m", domain: "(-inf, inf)" });
    }
    if !(sigma_h >= 0.0 && sigma_h.is_finite()) {
        return Err(OutOfDomain { argument: "sigma_altitude_m", value: sigma_h, unit: "m", domain: "[0, inf)" });
    }
    for range in ranges {
        for (argument, value) in [("slant_m", range.slant.m()), ("sigma_m", range.sigma.m())] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(OutOfDomain { argument, value, unit: "m", domain: "(0, inf)" });
            }
        }
    }
    Ok(())
}

/// The one solution that the prior allows.
fn near(candidates: [Result<Fix, NoFix>; 2], prior: &Prior) -> Result<Fix, NoFix> {
    let from = ecef_from_geodetic(&prior.position);
    let allowed = |fix: &Fix| distance(fix, &from) <= prior.within.m();
    match candidates {
        [Ok(a), Ok(b)] if allowed(&a) && allowed(&b) => Err(NoFix::Ambiguous),
        [Ok(fix), _] if allowed(&fix) => Ok(fix),
        [_, Ok(fix)] if allowed(&fix) => Ok(fix),
        [Err(e), Err(_)] => Err(e),
        _ => Err(NoFix::FarFromPrior),
    }
}

/// Three or more ranges from both meetings of the pair that meets best: the allowed one, or the likelier of two.
fn likelier(ranges: &[Range], altitude: &Altitude, allowed: impl Fn(&Fix) -> bool) -> Result<Fix, NoFix> {
    let pairs = ranges.iter().enumerate().flat_map(|(i, a)| ranges[i + 1..].iter().map(move |b| (a, b)));
    let best = pairs.filter_map(|(a, b)| meet(a, b, altitude.height)).max_by(|a, b| a.sine.total_cmp(&b.sine)).ok_or(NoFix::Apart)?;
    let reached = |p| settle(ranges, altitude, &p).and_then(|fix| if allowed(&fix) { Ok(fix) } else { Err(NoFix::FarFromPrior) });
    match best.places.map(reached) {
        [Ok(a), Ok(b)] => {
            let (better, worse) = if a.chi_square <= b.chi_square { (a, b) } else { (b, a) };
            let one = distance(&better, &ecef_from_geodetic(&worse.position)) < 1.0;
            let clear = worse.chi_square - better.chi_square >= 2.0 * ln(MIRROR_ODDS);
            if one || clear { Ok(better) } else { Err(NoFix::Ambiguous) }
        }
        [Ok(fix), Err(_)] | [Err(_), Ok(fix)] => Ok(fix),
        [Err(e), Err(_)] => Err(e),
    }
}

fn distance(fix: &Fix, from: &EcefPosition) -> f64 {
    ecef_from_geodetic(&fix.position).minus(from).vector().norm()
}

/// Gauss-Newton from a start; positions move in Cartesian axes and return to the altitude, so that no step is too long for the map. A step
/// after which the residuals are larger is halved: near a station a straight line is a poor likeness of a range.
fn settle(ranges: &[Range], altitude: &Altitude, start: &EcefPosition) -> Result<Fix, NoFix> {
    let mut place = at_altitude(start, altitude)?;
    let mut solved = step(ranges, altitude, &place)?;
    let mut factor = 1.0;
    for _ in 0..STEPS_MOST {
        let move_by = place.axes.transpose() * Vector3::new(solved.step.x, solved.step.y, 0.0);
        if move_by.norm() * solved.sine <= SETTLED_M {
            return Ok(fix(&place, &solved, ranges.len()));
        }
        let next = at_altitude(&EcefPosition::from_vector(place.ecef.vector() + factor * move_by), altitude)?;
        let stepped = step(ranges, altitude, &next)?;
        // Within a metre it converges by itself, and sums of squares near zero are rounding.
        if stepped.chi_square > solved.chi_square && move_by.norm() > 1.0 {
            factor *= 0.5;
            continue;
        }
        (place, solved, factor) = (next, stepped, 1.0);
    }
    Err(NoFix::NotSettled)
}

fn at_altitude(position: &EcefPosition, altitude: &Altitude) -> Result<Place, OutOfDomain> {
    Place::new(Geodetic { height: altitude.height, ..geodetic_from_ecef(position)? })
}

fn step(ranges: &[Range], altitude: &Altitude, place: &Place) -> Result<Solved, NoFix> {
    let mut normal = Normal::new();
    for range in ranges {
        let d = place.axes * (place.ecef.vector() - range.station.vector());
        let slant = d.norm();
        normal.add(&(d / slant), range.slant.m() - slant, range.sigma.m());
    }
    normal.solve(altitude.sigma.m()).ok_or(NoFix::Singular)
}

fn fix(place: &Place, solved: &Solved, used: usize) -> Fix {
    let p_residual = (used > 2).then(|| chi_square_tail((used - 2) as f64, solved.chi_square.max(0.0)));
    Fix { position: place.geodetic, covariance: solved.covariance, used, chi_square: solved.chi_square, p_residual }
}
