//! What stands beside a filter: the snapshot with its own test, the comparison of both, the plausibility of the inertial unit, and the facts
//! that [`super::judgement::decide`] takes. No heap.
//!
//! In the order of an instant: [`Guard::sample`] with every inertial sample, [`Guard::admit`] with the ranges before the filter has them,
//! [`Guard::restart`] where one is due, [`Guard::facts`] at an epoch. Provenance: ours; methods in docs/methods/fused-integrity.md.

mod biases;
mod contradiction;
mod course;
mod fixes;
mod height;
mod inertial;
mod level;
mod look;
mod motion;
mod records;
mod shares;
mod stations;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod times_tests;
mod witnesses;

pub use contradiction::{AGREED_S, Contradiction, Tests};
pub use inertial::{Envelope, Plausibility};
use records::Widths;
pub use records::{Admitted, EXCLUDED_MOST, Looked, Settings, Tally};
pub use shares::Shares;
pub use stations::{AGREE, Reading, Stations, testimony};

use super::consistency::normalised_square_horizontal;
use super::judgement::{Agreement, Biases, Facts, FilterFacts, Inertial, RangesAgree, SnapshotFacts, Testimony, Witnesses};
use crate::bound::raim;
use crate::frame::{Covariance, Displacement, Enu};
use crate::quantity::{GpsTime, OutOfDomain};
use crate::signal::{ImuIncrement, SatelliteId, TimedAiding};
use crate::solution::ins::{Advance, Block, Difference, Fusion, Mode, Solution, judgeable};
use crate::solution::snapshot::{Ranges, SnapshotVelocity, Solver};
use crate::special::gamma::{chi_square_factor, chi_square_tail};
use course::Course;
use height::Height;
use level::apart;

/// Risk of a false contradiction of one test at one instant: 1e-5 an hour over four tests and 3600 seconds. Provenance: re-derived, of the
/// false alarm rate of en route to non-precision approach.
pub const TEST_RISK: f64 = 1e-5 / 4.0 / 3600.0;
/// Risk that the innovations of an instant fail together by chance. Provenance: inferred.
pub const BLOCK_RISK: f64 = 1e-6;
/// Factor on the covariance of the difference, and the share of the snapshot's that is added to it: several correlation times stand as one
/// process, and what filter and snapshot have in common cancels but for that. Provenance: ours, calibrated in docs/methods/fused-integrity.md.
pub const DIFFERENCE_INFLATION: f64 = 1.6;
/// See [`DIFFERENCE_INFLATION`].
pub const DIFFERENCE_FLOOR: f64 = 0.05;
/// Samples on end whose times contradict the clock of the epochs, and the time without one after which the clock is right again \[s\].
/// Provenance: inferred.
const CLOCK: (u32, f64) = (2, 60.0);
/// Time for which a clock may be wrong before the unit is out \[s\]. Provenance: inferred.
const CLOCK_MOST_S: f64 = 10.0;
/// Instants of ranges on end with times outside the declared latency. Provenance: inferred.
const LATE_MOST: u32 = 3;

/// Everything beside a filter.
#[derive(Debug, Clone)]
pub struct Guard {
    settings: Settings,
    solver: Solver,
    raim: raim::Monitor,
    rates: raim::Monitor,
    limit: [f64; 4],
    /// Square of an estimated bias up to which it is one of the declared unit.
    bias_limit: f64,
    /// Squares up to which both are said to be back together.
    usual: [f64; 4],
    plausibility: Plausibility,
    contradiction: Contradiction,
    shares: Shares,
    looked: Option<Looked>,
    stations: Stations<2>,
    /// Stations against the snapshot alone, and what they and the altimeter have last said of it.
    alone: Stations<1>,
    testimony: [Testimony; 2],
    height: Height,
    /// The way of the satellites by their own rates.
    course: Option<Course>,
    tally: Tally,
    last: Ranges,
    /// Of the last instant at which nothing was contradicted.
    undisputed: Option<Widths>,
    tests: Option<(GpsTime, Tests)>,
    /// The last accepted sample, and whether samples came since.
    accepted: Option<GpsTime>,
    begin: Option<GpsTime>,
    refused_since: bool,
    off_clock: u32,
    clock_wrong: Option<(GpsTime, GpsTime)>,
    late: u32,
    acceleration_mps2: Option<f64>,
    level: Option<(GpsTime, [f64; 2], [f64; 2])>,
}

impl Guard {
    /// Nothing seen yet.
    ///
    /// # Errors
    /// [`OutOfDomain`] for an envelope that is none or an age that is negative.
    pub fn new(settings: Settings) -> Result<Self, OutOfDomain> {
        settings.envelope.check()?;
        if !(settings.age_sigma_s >= 0.0 && settings.age_sigma_s.is_finite()) {
            return Err(OutOfDomain { argument: "age_sigma_s", value: settings.age_sigma_s, unit: "s", domain: "[0, inf)" });
        }
        let limits = |risk| [2.0, 2.0, 1.0, 1.0].map(|dof| chi_square_factor(dof, risk));
        let raim = raim::Monitor::new(&settings.requirement);
        Ok(Self {
            settings,
            solver: Solver::default(),
            rates: raim.clone(),
            raim,
            limit: limits(TEST_RISK),
            bias_limit: chi_square_factor(1.0, biases::RISK),
            usual: limits(AGREE),
            plausibility: Plausibility::new(settings.envelope),
            contradiction: Contradiction::default(),
            shares: Shares::new(),
            looked: None,
            stations: Stations::default(),
            alone: Stations::default(),
            testimony: [Testimony::Silent; 2],
            height: Height::default(),
            course: None,
            tally: Tally::default(),
            last: Ranges::of(core::iter::empty()),
            undisputed: None,
            tests: None,
            accepted: None,
            begin: None,
            refused_since: false,
            off_clock: 0,
            clock_wrong: None,
            late: 0,
            acceleration_mps2: None,
            level: None,
        })
    }

    /// The snapshot of the last instant that had one.
    pub const fn looked(&self) -> Option<&Looked> {
        self.looked.as_ref()
    }
    /// The tests of the last instant that had some.
    pub const fn tests(&self) -> Option<&(GpsTime, Tests)> {
        self.tests.as_ref()
    }

    /// Sums over the tests until now.
    pub const fn tally(&self) -> &Tally {
        &self.tally
    }

    /// An inertial sample that was due at this time: what came, if anything, and what the filter made of it.
    pub fn sample(&mut self, due: GpsTime, came: Option<(&ImuIncrement, &Advance)>) {
        self.begin.get_or_insert(due);
        let Some((sample, outcome)) = came else { return };
        let off = sample.time.seconds_since(due).abs() > 0.5 * sample.interval_s;
        self.off_clock = if off { self.off_clock + 1 } else { 0 };
        if self.off_clock >= CLOCK.0 {
            let first = self.clock_wrong.map_or(due, |(first, _)| first);
            if self.clock_wrong.is_none() {
                self.contradiction.note_fault(due);
            }
            self.clock_wrong = Some((first, due));
        } else if self.clock_wrong.is_some_and(|(_, last)| due.seconds_since(last) >= CLOCK.1) {
            self.clock_wrong = None;
        }
        match outcome {
            Advance::Done | Advance::Bridged { .. } | Advance::AfterGap { .. } => {
                (self.accepted, self.refused_since) = (Some(due), false);
                if !self.plausibility.holds(sample, self.acceleration_mps2) {
                    self.contradiction.convict(due);
                }
            }
            Advance::Refused(_) | Advance::Late => self.refused_since = true,
            Advance::Stopped(_) => {}
        }
    }

    /// Ranges of one instant, before the filter has them: may it use them? `now` is the time of the epoch clock.
    pub fn admit(&mut self, filter: &mut Fusion, now: GpsTime, together: &[TimedAiding]) -> Admitted {
        let all = Admitted { usable: true, excluded: [None; EXCLUDED_MOST] };
        let Some(time) = together.first().map(|t| t.time) else { return all };
        let age_s = now.seconds_since(time);
        let in_time = age_s <= self.settings.age_most_s && age_s >= -0.5;
        self.late = if in_time { 0 } else { self.late + 1 };
        self.hear_biases(filter, time);
        let mut ranges = self.fresh(&judgeable(together));
        let before = self.looked.take();
        let (mut looked, excluded) = match self.look(time, &mut ranges) {
            Ok(admitted) => admitted,
            Err(_) => return all,
        };
        self.note_acceleration(before.as_ref(), &looked);
        if let Some(velocity) = &looked.velocity {
            filter.heard_velocity(time, velocity);
        }
        let difference = filter.against(&looked.snapshot);
        let difference = difference.filter(|_| looked.ranges_agree == RangesAgree::Yes);
        let mut out = [None; EXCLUDED_MOST];
        out[0] = excluded;
        let block = block_without(filter, time, &mut ranges, &mut out);
        let settled = !matches!(filter.mode_now(), Mode::Aligning);
        let mut usable = looked.ranges_agree != RangesAgree::No;
        if let Some(d) = &difference {
            let before = self.contradiction.is_raised();
            let tests = self.compare(d, &looked, looked.velocity.as_ref(), settled);
            self.tally.n_raised += u64::from(!before && self.contradiction.is_raised());
            self.tally.add(&tests);
            self.tests = Some((time, tests));
            usable &= !tests.fail();
            // The clock of the unit was wrong lately: what the filter has made of its samples is no riddle.
            if tests.fail() && self.clock_wrong.is_some() {
                self.contradiction.convict(time);
            }
            if let Some(block) = &block {
                usable &= passes(block);
                if !tests.fail() {
                    self.shares.innovations(time, block);
                }
            }
        }
        self.follow(before.as_ref(), &mut looked, true);
        self.looked = Some(looked);
        Admitted { usable, excluded: out }
    }

    /// Satellites beside which nothing stands are heard against their own rates since something did.
    fn follow(&mut self, before: Option<&Looked>, now: &mut Looked, measured: bool) {
        let compared = self.tests.is_some_and(|(time, tests)| time == now.snapshot.time && !tests.fail());
        let trusted = compared && !self.contradiction.is_raised() && !self.contradiction.is_open();
        let Some(course) = self.course.filter(|_| !trusted) else {
            self.course = (now.ranges_agree != RangesAgree::No).then(|| Course::at(now));
            return;
        };
        // Where nothing leads here the next position begins anew.
        self.course = before.and_then(|b| course.led(b, now, measured));
        let Some(led) = self.course.filter(|_| now.ranges_agree != RangesAgree::No) else { return };
        let (apart_m, [h, v]) = led.apart(now);
        if !(h <= self.limit[0] && v <= self.limit[2]) {
            self.contradiction.leave_course();
        }
        (0..2).for_each(|k| now.level_m[k] += apart_m[k]);
        if !measured {
            self.course = Some(Course::at(now));
        }
    }

    /// The filter against the snapshot of an instant, and what follows for a contradiction.
    fn compare(&mut self, d: &Difference, looked: &Looked, velocity: Option<&SnapshotVelocity>, settled: bool) -> Tests {
        let widths = Widths::of(d, looked, velocity);
        let tests = self.test(d, velocity, &widths);
        let squares = self.undisputed.map(|before| self.test(d, velocity, &before).square);
        let back = squares.is_some_and(|s| s.iter().zip(&self.usual).all(|(square, most)| square <= most));
        self.contradiction.judge(looked.snapshot.time, &tests, settled, back);
        if !self.contradiction.is_raised() {
            self.undisputed = Some(widths);
        }
        tests
    }

    /// The squares of an instant against their limits.
    fn test(&self, d: &Difference, velocity: Option<&SnapshotVelocity>, widths: &Widths) -> Tests {
        let up = |value: f64, variance: f64| if variance > 0.0 { value * value / variance } else { f64::NAN };
        let horizontal = |d: &Displacement<Enu>, v: &Covariance<Enu>| normalised_square_horizontal(d, v).unwrap_or(f64::NAN);
        let position = &widths.position;
        let mut square = [horizontal(&d.position, position), 0.0, up(d.position.vector().z, position.matrix()[(2, 2)]), 0.0];
        if let (Some(v), Some(both)) = (velocity, &widths.velocity) {
            let apart = Displacement::<Enu>::from_vector(d.velocity_mps - v.enu_mps);
            square[1] = horizontal(&apart, both);
            square[3] = up(apart.vector().z, both.matrix()[(2, 2)]);
        }
        let exceeds = core::array::from_fn(|k| !(square[k] <= self.limit[k]));
        Tests { square, exceeds }
    }

    /// Starts the filter anew at the snapshot where that is due; whether it did.
    ///
    /// # Errors
    /// As [`Fusion::restart_at`].
    pub fn restart(&mut self, filter: &mut Fusion, now: GpsTime) -> Result<bool, OutOfDomain> {
        if self.contradiction.take_cleared() {
            // The unit led the filter without satellites astray as well, and nothing is in doubt any more.
            filter.renew_beside(now)?;
        }
        let lost = filter.stopped().is_some();
        if !(self.contradiction.start_is_due(now, self.settings.restart_after_s) || (lost && !self.contradiction.is_raised())) {
            return Ok(false);
        }
        let Some(looked) = self.looked.as_ref().filter(|l| l.ranges_agree == RangesAgree::Yes && l.snapshot.time == now) else {
            return Ok(false);
        };
        let Some(velocity) = &looked.velocity else { return Ok(false) };
        filter.restart_at(&looked.snapshot, velocity)?;
        self.contradiction.started(now);
        self.shares = Shares::new();
        Ok(true)
    }

    /// What is known at an epoch, once a second; `given` is the filter's solution of that time.
    pub fn facts(&mut self, filter: &mut Fusion, epoch: GpsTime, output: Option<&Solution>, witnesses: Witnesses) -> Facts {
        let output = output.filter(|s| s.is_sound());
        let of_filter = output.and_then(|s| {
            let p = s.state.position().ok()?;
            let v = s.covariance.matrix();
            Some(FilterFacts {
                time: s.state.time,
                position: [p.point.lat().rad(), p.point.lon().rad(), p.height.m()],
                variance_m2: [0, 1, 2].map(|k| v[(k, k)]),
                mode: s.mode,
            })
        });
        let snapshot = self.looked.as_ref().map(|l| SnapshotFacts {
            time: l.snapshot.time,
            ranges_agree: l.ranges_agree,
            level_m: Some(l.level_m),
            distance_m: output.and_then(|s| apart(&l.snapshot, &filter.antenna_of(s)?)),
        });
        let inertial = self.inertial(epoch);
        let alone = inertial != Inertial::Plausible && inertial != Inertial::Clock;
        if alone && !self.testimony.iter().all(|t| t.lets_stand()) {
            self.contradiction.leave_open();
        }
        let carried = self.carry(epoch, snapshot.as_ref(), output);
        let gating = self.shares.second(epoch, filter);
        Facts {
            epoch,
            filter: of_filter,
            snapshot,
            carried,
            agreement: Some(self.agreement(filter, epoch)),
            inertial: Some(inertial),
            satellite_times_hold: Some(self.late < LATE_MOST && !filter.fixes_are_late()),
            gating: Some(gating),
            tuning: Some(self.shares.tuning()),
            biases: Some(if self.contradiction.is_biased() { Biases::Beyond } else { Biases::AsDeclared }),
            witnesses: Some(Witnesses { stations: self.testimony[0], altimeter: self.testimony[1], ..witnesses }),
        }
    }

    fn inertial(&self, epoch: GpsTime) -> Inertial {
        if self.clock_wrong.is_none() && self.contradiction.implausible_lately(epoch) {
            return Inertial::Implausible;
        }
        if self.contradiction.convicts_the_unit() {
            return Inertial::Fault;
        }
        if let Some((first, last)) = self.clock_wrong {
            let lasting = epoch.seconds_since(first) >= CLOCK_MOST_S && epoch.seconds_since(last) < 1.0;
            return if lasting { Inertial::Fault } else { Inertial::Clock };
        }
        let Some(since) = self.accepted.or(self.begin) else { return Inertial::Plausible };
        let for_s = epoch.seconds_since(since);
        match (for_s > self.settings.gap_most_s, self.refused_since) {
            (false, _) => Inertial::Plausible,
            (true, true) => Inertial::Refused { for_s },
            (true, false) => Inertial::Missing { for_s },
        }
    }

    /// Where both contradict each other the filter without satellites bounds the reading that the satellites are wrong.
    fn agreement(&self, filter: &mut Fusion, epoch: GpsTime) -> Agreement {
        let mut bound_m = || {
            let looked = self.looked.as_ref().filter(|l| l.snapshot.time == epoch);
            let beside = filter.without_satellites(epoch);
            looked.zip(beside).and_then(|(l, s)| self.bound_of(&l.snapshot, &s, &filter.antenna_of(&s)?)).unwrap_or([f64::INFINITY; 2])
        };
        if self.contradiction.was_before_the_unit() && self.contradiction.is_raised() {
            return Agreement::Unexplained { bound_m: bound_m() };
        }
        if self.contradiction.is_raised() {
            return Agreement::Contradicted { bound_m: bound_m() };
        }
        if self.contradiction.is_open() {
            return Agreement::Open { bound_m: bound_m() };
        }
        let compared = self.tests.is_some_and(|(time, _)| time == epoch);
        if compared { Agreement::Agrees } else { Agreement::NotCompared }
    }
}

fn passes(block: &Block) -> bool {
    chi_square_tail(block.freedom as f64, block.square) >= BLOCK_RISK
}

/// The innovations together, without the few satellites whose absence makes them pass: a filter sees a small fault before the snapshot does.
/// Where no few explain it nobody is left out, and the block fails.
fn block_without(filter: &mut Fusion, time: GpsTime, ranges: &mut Ranges, out: &mut [Option<SatelliteId>; EXCLUDED_MOST]) -> Option<Block> {
    let mut together = filter.together(time, ranges)?;
    let all = together.block()?;
    let (mut block, mut leaving) = (all, *out);
    while !passes(&block) {
        let Some(place) = leaving.iter_mut().find(|o| o.is_none()) else { return Some(all) };
        let Some(k) = together.most_at_fault() else { return Some(all) };
        *place = ranges.iter().nth(k).map(|m| m.satellite);
        together.leave_out(k);
        let Some(left) = together.block() else { return Some(all) };
        block = left;
    }
    *ranges = Ranges::of(ranges.iter().filter(|m| !leaving.contains(&Some(m.satellite))));
    *out = leaving;
    Some(block)
}
