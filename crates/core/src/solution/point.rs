//! Single-point position: robust weighted least squares on pseudoranges of one epoch, residual test and exclusion.
//!
//! Source: IS-GPS-200 20.3.3.4 and the textbook normal equation (with its clocks eliminated, see [`super::wls`]); robust start by Huber's
//! weights (Huber 1964); test of the residuals by chi-square and exclusion of the largest (Parkinson and Axelrad 1988); provenance: ours,
//! of standard parts.

use super::common::{InSolution, Left};
use super::mixture::Mixture;
use super::plausible;
use super::wls::{Dilution, Normal, Row};
use crate::frame::{Covariance, EcefPosition, enu_from_ecef, geodetic_from_ecef};
use crate::geometry::broadcast::in_axes_of_reception;
use crate::quantity::{GpsTime, Metres, Unavailable};
use crate::signal::{Constellation, SPEED_OF_LIGHT_MPS};
use crate::special::float::sqrt;
use crate::special::gamma::chi_square_tail;
use nalgebra::{Matrix3, Vector3};

#[path = "point_model.rs"]
mod model;
#[path = "point_offsets.rs"]
mod offsets;
#[path = "point_readings.rs"]
mod readings;
#[path = "point_records.rs"]
mod records;
#[path = "point_residuals.rs"]
mod residuals;
#[path = "point_velocity.rs"]
mod velocity;
use model::{Modelled, Place};
use offsets::Clock;
pub use offsets::{Offset, Offsets};
pub(in crate::solution) use readings::CONFIRMED;
pub use records::{Fix, Range, Settings, Used};
pub use residuals::{Sighted, sighted};

/// Most ranges of one epoch; receivers list fewer than 60 satellites.
pub const MOST_RANGES: usize = 96;
/// Excluded satellites that a position names; more are counted.
pub const EXCLUDED_NAMED: usize = 8;
const ROUNDS: usize = 12;
/// A step below this is the last \[m\]: ranges are straight over it, to 1 m² / 2 / 2e7 m = 3e-8 m, and the Earth's turn during the way, which
/// a step changes too, to 6e-6 of it.
const STRAIGHT: f64 = 1.0;
/// This far from where delays were computed they are computed anew \[m\]; nearer they are wrong by less than 3e-4 of it, and the height,
/// which the troposphere moves by five times as much, by 1.5 mm.
const DELAYS_MOVE: f64 = 1.0;
const SINGULAR: Unavailable = Unavailable::Singular { condition: f64::INFINITY, limit: super::wls::CONDITION_LIMIT };
/// Residuals beyond this many standard deviations count less in the robust rounds; Huber's choice costs 5 % of efficiency.
const HUBER: f64 = 1.345;

/// Where a range stands, seen from the last position.
#[derive(Debug, Clone, Copy, Default)]
struct Seen {
    row: Row,
    modelled: Modelled,
    excluded: bool,
}

impl Seen {
    const fn counts(&self) -> bool {
        self.weighs() && !self.excluded
    }
    /// Above the mask, whether or not it was excluded.
    const fn weighs(&self) -> bool {
        self.modelled.weight > 0.0
    }
}

/// The position of one epoch, from nothing but its ranges.
///
/// # Errors
/// [`Unavailable`]: too few satellites above the mask, a singular geometry, a position off the Earth's neighbourhood (ranges that are
/// no ranges), or more ranges than [`MOST_RANGES`].
pub fn solve(ranges: &[Range], time: GpsTime, settings: &Settings) -> Result<Fix, Unavailable> {
    solve_near(ranges, time, settings, None)
}

/// The same, looked for first at a position that may be near, such as the last one. The result is that of [`solve`], but for the 1.5 mm
/// that delays computed up to a metre away may move it: where residuals do not agree with the weights from there, the
/// epoch begins from nothing.
///
/// # Errors
/// As [`solve`].
pub fn solve_near(ranges: &[Range], time: GpsTime, settings: &Settings, near: Option<&EcefPosition>) -> Result<Fix, Unavailable> {
    settled(ranges, time, settings, near, &Offsets::default(), |epoch| epoch.fix())?
}

/// The same with the offsets of constellations' clocks that are known, each range of the solution for `each`, and the other readings of the
/// ranges where the position cannot stand alone.
///
/// # Errors
/// As [`solve`].
pub fn solve_readings(
    ranges: &[Range],
    time: GpsTime,
    settings: &Settings,
    near: Option<&EcefPosition>,
    offsets: &Offsets,
    each: impl FnMut(Used),
) -> Result<(Fix, Option<Mixture>), Unavailable> {
    settled(ranges, time, settings, near, offsets, |epoch| {
        let fix = epoch.fix()?;
        epoch.used().for_each(each);
        Ok((fix, epoch.mixture(&fix)))
    })?
}

/// What `then` makes of the epoch once its position stands still.
fn settled<T>(
    ranges: &[Range],
    time: GpsTime,
    settings: &Settings,
    near: Option<&EcefPosition>,
    offsets: &Offsets,
    then: impl FnOnce(&Solver<'_>) -> T,
) -> Result<T, Unavailable> {
    if ranges.len() > MOST_RANGES {
        let (value, unit, domain) = (ranges.len() as f64, "1", "[0, 96]");
        return Err(Unavailable::Invalid { field: "ranges", value, unit, domain });
    }
    let mut seen = [Seen::default(); MOST_RANGES];
    let seen = &mut seen[..ranges.len()];
    let clock_of = offsets.clocks(ranges);
    if let Some(near) = near {
        let mut epoch = Solver::new(ranges, seen, time, settings, clock_of, *near.vector());
        if epoch.settle(false) == Ok(true) && epoch.judged().consistent {
            return Ok(then(&epoch));
        }
        seen.fill(Seen::default());
    }
    let mut epoch = Solver::new(ranges, seen, time, settings, clock_of, start(ranges, &clock_of)?);
    epoch.settle(true)?;
    epoch.settle(false)?;
    epoch.exclude()?;
    Ok(then(&epoch))
}

const CLOCKS: usize = Constellation::ALL.len();

struct Solver<'a> {
    ranges: &'a [Range],
    seen: &'a mut [Seen],
    time: GpsTime,
    settings: &'a Settings,
    at: Vector3<f64>,
    /// Where delays and weights were computed; the Earth's centre before they are.
    modelled_at: Vector3<f64>,
    /// Which clock each constellation has.
    clock_of: [Clock; CLOCKS],
    clocks: [f64; CLOCKS],
    /// The equation of the last step.
    normal: Normal,
    /// Statistic and redundancy before anything was excluded.
    before: Option<(f64, usize)>,
    /// What the residuals of the last step say; `None` until they are examined.
    judged: Option<Judgement>,
}

/// Whether residuals agree with the weights.
#[derive(Debug, Clone, Copy)]
struct Judgement {
    statistic: f64,
    redundancy: usize,
    /// Risk of a larger statistic; NaN without redundancy.
    risk: f64,
    consistent: bool,
    /// The common errors in the solution; `None` where it is singular.
    common: Option<InSolution>,
}

/// A first position from nothing: equal weights, no atmosphere, from the Earth's centre. A few rounds bring it within kilometres,
/// gross errors in the ranges apart.
fn start(ranges: &[Range], clock_of: &[Clock; CLOCKS]) -> Result<Vector3<f64>, Unavailable> {
    start_from(ranges.iter().map(|r| {
        let clock = &clock_of[r.satellite.constellation.index()];
        (&r.position, Metres::new(r.corrected.m() - clock.offset_m), clock.index)
    }))
}

/// The same from satellites' positions, ranges with the satellite's clock taken out, and whose time they count in.
pub(crate) fn start_from<'a>(ranges: impl Iterator<Item = (&'a EcefPosition, Metres, usize)> + Clone) -> Result<Vector3<f64>, Unavailable> {
    let mut at = Vector3::zeros();
    for _ in 0..ROUNDS {
        let rows = ranges.clone().map(|(satellite, corrected, clock)| {
            let (way, unit) = way(satellite, &at);
            Row { unit, weight: 1.0, clock, residual: corrected.m() - way }
        });
        let normal = Normal::new(rows)?;
        let step = normal.step().ok_or(SINGULAR)?;
        at += step;
        if step.norm() < 1e3 {
            break;
        }
    }
    Ok(at)
}

/// Length of the signal's way and direction from receiver to satellite, Earth-fixed axes of reception.
pub(crate) fn way(satellite: &EcefPosition, at: &Vector3<f64>) -> (f64, Vector3<f64>) {
    let straight = (satellite.vector() - at).norm();
    let line = in_axes_of_reception(satellite.vector(), straight / SPEED_OF_LIGHT_MPS) - at;
    let length = line.norm();
    (length, line / length)
}

impl<'a> Solver<'a> {
    fn new(
        ranges: &'a [Range],
        seen: &'a mut [Seen],
        time: GpsTime,
        settings: &'a Settings,
        clock_of: [Clock; CLOCKS],
        at: Vector3<f64>,
    ) -> Self {
        let (modelled_at, normal) = (Vector3::zeros(), Normal::default());
        Self { ranges, seen, time, settings, at, modelled_at, clock_of, clocks: [0.0; CLOCKS], normal, before: None, judged: None }
    }

    /// Rounds of least squares until the position stands still, which is reported; robust rounds weigh large residuals down.
    fn settle(&mut self, robust: bool) -> Result<bool, Unavailable> {
        self.judged = None;
        for round in 0..ROUNDS {
            // The first robust round has no residuals to judge by yet.
            let turn = self.look(robust && round > 0)?;
            self.normal = Normal::new(self.rows())?;
            let step = self.normal.step().ok_or(SINGULAR)?;
            self.at += turn.transpose() * step;
            self.clocks = core::array::from_fn(|c| self.normal.clock(c, &step));
            for seen in self.seen.iter_mut() {
                // The way shortens by the step towards the satellite.
                seen.row.residual += seen.row.unit.dot(&step);
            }
            let enough = if robust { round > 1 && step.norm() < 0.1 } else { step.norm() < STRAIGHT };
            if enough {
                return Ok(true);
            }
        }
        Ok(false)
    }

    fn rows(&self) -> impl Iterator<Item = Row> + Clone + '_ {
        self.seen.iter().filter(|s| s.counts()).map(|s| s.row)
    }

    /// Ranges against the present position; delays and weights anew where it has moved. Gives the local axes.
    fn look(&mut self, robust: bool) -> Result<Matrix3<f64>, Unavailable> {
        let here = geodetic_from_ecef(&EcefPosition::from_vector(self.at)).map_err(Unavailable::from)?;
        let turn = enu_from_ecef(&here.point);
        let moved = (self.at - self.modelled_at).norm() > DELAYS_MOVE;
        let place = moved.then(|| Place::new(&here, self.time, self.settings));
        if place.is_some() {
            self.modelled_at = self.at;
        }
        for (range, seen) in self.ranges.iter().zip(self.seen.iter_mut()) {
            let (way, unit) = way(&range.position, &self.at);
            let unit = turn * unit;
            if let Some(place) = &place {
                seen.modelled = self.settings.model(range, &unit, place);
            }
            let Clock { index: clock, offset_m, sigma_m } = self.clock_of[range.satellite.constellation.index()];
            let residual = range.corrected.m() - way - seen.modelled.delay - offset_m;
            let mut weight = seen.modelled.weight / (1.0 + sigma_m * sigma_m * seen.modelled.weight);
            if robust {
                let normalised = (residual - self.clocks[clock]).abs() * sqrt(weight);
                weight *= if normalised > HUBER { HUBER / normalised } else { 1.0 };
            }
            seen.row = Row { unit, weight, clock, residual };
        }
        Ok(turn)
    }

    /// The ranges of the solution with what it leaves of them.
    fn left(&self) -> impl Iterator<Item = Left> + Clone + '_ {
        self.seen.iter().filter(|s| s.counts()).map(|s| self.left_of(s))
    }

    fn left_of(&self, seen: &Seen) -> Left {
        Left { row: seen.row, common: seen.modelled.common, residual: seen.row.residual - self.clocks[seen.row.clock] }
    }

    fn judged(&mut self) -> Judgement {
        let judged = self.judged.unwrap_or_else(|| self.judge());
        self.judged = Some(judged);
        judged
    }

    fn judge(&self) -> Judgement {
        let common = InSolution::new(&self.normal, self.left());
        let plain = || self.left().map(|r| r.row.weight * r.residual * r.residual).sum();
        let statistic = common.as_ref().map_or_else(plain, |c| c.statistic);
        // The normal equation was refused unless there are as many ranges as unknowns.
        let redundancy = self.left().count().saturating_sub(3 + self.normal.clocks());
        let risk = if redundancy > 0 { chi_square_tail(redundancy as f64, statistic) } else { f64::NAN };
        Judgement { statistic, redundancy, risk, consistent: risk >= self.settings.false_alarm, common }
    }

    /// Exclude the worst range until the residuals agree with the weights or no more may go.
    fn exclude(&mut self) -> Result<(), Unavailable> {
        for _ in 0..self.settings.most_excluded {
            let judged = self.judged();
            // With one redundant range a fault is seen but not found.
            if judged.consistent || judged.redundancy < 2 {
                return Ok(());
            }
            let Some(worst) = judged.common.as_ref().and_then(|c| self.worst(c)) else { return Ok(()) };
            self.before = self.before.or(Some((judged.statistic, judged.redundancy)));
            self.seen[worst].excluded = true;
            self.settle(false)?;
        }
        Ok(())
    }

    /// The range without which the statistic falls most.
    fn worst(&self, common: &InSolution) -> Option<usize> {
        let fall = |k: usize| common.fall(&self.normal, &self.left_of(&self.seen[k]));
        (0..self.seen.len()).filter(|k| self.seen[*k].counts()).max_by(|a, b| fall(*a).total_cmp(&fall(*b)))
    }

    fn fix(&self) -> Result<Fix, Unavailable> {
        let judged = self.judged.unwrap_or_else(|| self.judge());
        let position = geodetic_from_ecef(&EcefPosition::from_vector(self.at)).map_err(Unavailable::from)?;
        plausible::height(&position)?;
        let covariance = self.normal.covariance()?;
        let common = judged.common.as_ref().ok_or(SINGULAR)?.covariance() + self.offset_covariance(covariance.matrix());
        // Residuals larger than the weights say: the weights are wrong by that much at least.
        let contradicted = !judged.consistent && judged.redundancy > 0;
        let inflation = if contradicted { (judged.statistic / judged.redundancy as f64).max(1.0) } else { 1.0 };
        // The condition was judged with the weights; it is not judged twice.
        let unit_weights = Normal::new(self.rows().map(|r| Row { weight: 1.0, ..r }))?.inverse().ok_or(SINGULAR)?;
        let dilution = Dilution::of(&Covariance::claim_symmetric(unit_weights));
        plausible::dilution(&dilution)?;
        let mut clock_m = [f64::NAN; CLOCKS];
        for (range, seen) in self.used_ranges() {
            let constellation = range.satellite.constellation.index();
            clock_m[constellation] = self.clocks[seen.row.clock] + self.clock_of[constellation].offset_m;
        }
        let mut excluded = [None; EXCLUDED_NAMED];
        let all = self.ranges.iter().zip(self.seen.iter()).filter(|(_, s)| s.excluded);
        for (slot, (range, _)) in excluded.iter_mut().zip(all) {
            *slot = Some(range.satellite);
        }
        Ok(Fix {
            position,
            covariance: Covariance::claim_symmetric(covariance.matrix() * inflation + common),
            dilution,
            clock_m,
            offset_variance_m2: self.offset_variances(covariance.matrix()),
            used: self.satellites(),
            spare: self.spare(),
            velocity: self.velocity(&position),
            n_used: self.seen.iter().filter(|s| s.counts()).count(),
            n_excluded: self.seen.iter().filter(|s| s.excluded).count(),
            excluded,
            before_exclusion: self.before.unwrap_or((judged.statistic, judged.redundancy)),
            inflation,
            residual_risk: judged.risk,
            redundancy: judged.redundancy,
            consistent: judged.consistent,
        })
    }

    fn used(&self) -> impl Iterator<Item = Used> + '_ {
        let of = |(index, s): (usize, &Seen)| Used {
            index,
            unit: s.row.unit,
            weight: s.modelled.weight,
            residual: Metres::new(s.row.residual),
            shared_m: s.modelled.common,
        };
        self.seen.iter().enumerate().filter(|(_, s)| s.counts()).map(of)
    }
}

#[cfg(test)]
#[path = "point_tests.rs"]
mod tests;
