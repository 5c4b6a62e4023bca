//! What stands beside a filter: the snapshot with its own test, the comparison of both, the plausibility of the inertial unit, and the facts
//! that [`super::judgement::decide`] takes. No heap.
//!
//! In the order of an instant: [`Guard::sample`] with every inertial sample, [`Guard::admit`] with the ranges before the filter has them,
//! [`Guard::restart`] where one is due, [`Guard::facts`] at an epoch. Provenance: ours; methods in docs/methods/fused-integrity.md.

mod contradiction;
mod course;
mod fixes;
mod inertial;
mod shares;
mod stations;
#[cfg(test)]
mod tests;

pub use contradiction::{AGREED_S, Contradiction, Tests};
pub use inertial::{Envelope, Plausibility};
pub use shares::Shares;
pub use stations::{Reading, Stations, testimony};

use super::consistency::normalised_square_horizontal;
use course::Course;

use super::judgement::{
    Agreement, CarriedFacts, Decision, Facts, FilterFacts, Inertial, RangesAgree, Reason, SnapshotFacts, Source, Testimony, Witnesses,
};
use crate::bound::araim::exclusion::Decision as Exclusion;
use crate::bound::araim::single::Requirement;
use crate::bound::raim;
use crate::frame::{Covariance, Displacement, EcefPosition, Enu, ecef_from_geodetic, enu_from_ecef};
use crate::quantity::{GpsTime, OutOfDomain, Risk, Unavailable};
use crate::signal::{Aiding, BaroHeight, ImuIncrement, SatelliteId, SatelliteRange, TimedAiding};
use crate::solution::ins::{Advance, Block, Difference, Fusion, Mode, Solution, judgeable};
use crate::solution::snapshot::{RANGES_MOST, Ranges, Snapshot, SnapshotVelocity, Solver, rate_sights, velocity};
use crate::solution::wls::{WeightedSight, horizontal_axes};
use crate::special::chi::chi_factor;
use crate::special::float::{hypot, sqrt};
use crate::special::gamma::{chi_square_factor, chi_square_tail};

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
/// Inertial faults that the growth covers where no envelope is declared \[m/s²\], \[rad/s\]. Provenance: inferred.
const UNSEEN: [f64; 2] = [0.01, 1e-5];
/// \[m/s²\]
const GRAVITY: f64 = 9.8;
/// Samples on end whose times contradict the clock of the epochs, and the time without one after which the clock is right again \[s\].
/// Provenance: inferred.
const CLOCK: (u32, f64) = (2, 60.0);
/// Time for which a clock may be wrong before the unit is out \[s\]. Provenance: inferred.
const CLOCK_MOST_S: f64 = 10.0;
/// Instants of ranges on end with times outside the declared latency. Provenance: inferred.
const LATE_MOST: u32 = 3;

/// How a guard is set.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Of the inertial unit and the vehicle.
    pub envelope: Envelope,
    /// Of the snapshot's test and level.
    pub requirement: Requirement,
    /// Standard deviation of the age of the satellite data \[s\]: its share of the level is three of them times the speed.
    pub age_sigma_s: f64,
    /// Hole in the inertial samples from which the unit is missing \[s\].
    pub gap_most_s: f64,
    /// Oldest measurement that is used \[s\].
    pub age_most_s: f64,
    /// Time for which the unit must be plausible and the contradiction last before the filter is started anew \[s\].
    pub restart_after_s: f64,
}

/// The ranges of an instant, judged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Admitted {
    /// Whether the filter may use them.
    pub usable: bool,
    /// Those that it may not use.
    pub excluded: [Option<SatelliteId>; EXCLUDED_MOST],
}

/// Satellites that are left out of an instant at most.
pub const EXCLUDED_MOST: usize = 4;

impl Admitted {
    /// Whether a satellite is left out.
    pub fn excludes(&self, satellite: SatelliteId) -> bool {
        self.excluded.contains(&Some(satellite))
    }
}

/// A snapshot with what its own test says.
#[derive(Debug, Clone)]
pub struct Looked {
    /// The position.
    pub snapshot: Snapshot,
    /// The velocity, where the rates determine one and agree.
    pub velocity: Option<SnapshotVelocity>,
    /// Whether the ranges agree.
    pub ranges_agree: RangesAgree,
    /// Levels, horizontal and vertical \[m\].
    pub level_m: [f64; 2],
}

/// Sums over the tests of a flight.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Tally {
    /// Instants.
    pub n: u64,
    /// Sum and largest of each square, in the order of [`Tests::square`].
    pub sum: [f64; 4],
    /// See [`Tally::sum`].
    pub most: [f64; 4],
    /// Times that a contradiction was raised.
    pub n_raised: u64,
}

impl Tally {
    fn add(&mut self, tests: &Tests) {
        self.n += 1;
        for k in 0..4 {
            self.sum[k] += tests.square[k];
            self.most[k] = self.most[k].max(tests.square[k]);
        }
    }
}

/// Everything beside a filter.
#[derive(Debug, Clone)]
pub struct Guard {
    settings: Settings,
    solver: Solver,
    raim: raim::Monitor,
    rates: raim::Monitor,
    limit: [f64; 4],
    plausibility: Plausibility,
    contradiction: Contradiction,
    shares: Shares,
    looked: Option<Looked>,
    stations: Stations<2>,
    /// Stations against the snapshot alone, and what they and the altimeter have last said of it.
    alone: Stations<1>,
    testimony: [Testimony; 2],
    /// The way of the satellites by their own rates.
    course: Option<Course>,
    tally: Tally,
    last: Ranges,
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
        let [two, one] = [2.0, 1.0].map(|dof| chi_square_factor(dof, TEST_RISK));
        let raim = raim::Monitor::new(&settings.requirement);
        Ok(Self {
            settings,
            solver: Solver::default(),
            rates: raim.clone(),
            raim,
            limit: [two, two, one, one],
            plausibility: Plausibility::new(settings.envelope),
            contradiction: Contradiction::default(),
            shares: Shares::new(),
            looked: None,
            stations: Stations::default(),
            alone: Stations::default(),
            testimony: [Testimony::Silent; 2],
            course: None,
            tally: Tally::default(),
            last: Ranges::of(core::iter::empty()),
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
            Advance::Done | Advance::Bridged { .. } | Advance::Adrift { .. } => {
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
        let mut ranges = self.fresh(&judgeable(together));
        let before = self.looked.take();
        let (mut looked, excluded) = match self.look(time, &mut ranges) {
            Ok(found) => found,
            Err(_) => return all,
        };
        self.note_acceleration(before.as_ref(), &looked);
        if let Some(velocity) = &looked.velocity {
            filter.heard_velocity(time, velocity);
        }
        let difference = filter.against(&looked.snapshot);
        let tests = difference.filter(|_| looked.ranges_agree == RangesAgree::Yes).map(|d| self.test(&d, &looked));
        let mut out = [None; EXCLUDED_MOST];
        out[0] = excluded;
        let block = block_without(filter, time, &mut ranges, &mut out);
        let settled = !matches!(filter.mode_now(), Mode::Aligning);
        let mut usable = looked.ranges_agree != RangesAgree::No;
        if let Some(tests) = &tests {
            let before = self.contradiction.is_raised();
            self.contradiction.judge(time, tests, settled);
            self.tally.n_raised += u64::from(!before && self.contradiction.is_raised());
            self.tally.add(tests);
            self.tests = Some((time, *tests));
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
            self.contradiction.leave_open();
        }
        (0..2).for_each(|k| now.level_m[k] += apart_m[k]);
        if !measured {
            self.course = Some(Course::at(now));
        }
    }

    /// One range of each satellite, and none that is the last one again to the bit: a receiver that has stopped measures nothing.
    fn fresh(&mut self, ranges: &Ranges) -> Ranges {
        let before = core::mem::replace(&mut self.last, ranges.clone());
        let repeated =
            |m: &SatelliteRange| before.iter().any(|b| b.satellite == m.satellite && b.range == m.range && b.rate_mps == m.rate_mps);
        let mut named = [None; RANGES_MOST];
        let kept = ranges.iter().filter(|m| {
            let known = named.contains(&Some(m.satellite));
            if let (false, Some(place)) = (known, named.iter_mut().find(|n| n.is_none())) {
                *place = Some(m.satellite);
            }
            !known && !repeated(m)
        });
        let mut all = [None; RANGES_MOST];
        kept.zip(all.iter_mut()).for_each(|(m, place)| *place = Some(*m));
        Ranges::of(all.iter().flatten())
    }

    /// Stations and altimeter of one instant: witnesses of the snapshot of the same instant, alone and against the filter without satellites.
    pub fn hear(&mut self, filter: &mut Fusion, together: &[TimedAiding]) {
        let Some(time) = together.first().map(|t| t.time) else { return };
        let Some(looked) = self.looked.as_ref().filter(|l| l.snapshot.time == time && l.ranges_agree != RangesAgree::No) else { return };
        let ecef = enu_from_ecef(&looked.snapshot.position.point).transpose();
        let turned = |v: &Covariance<Enu>| ecef * v.matrix() * ecef.transpose();
        let snapshot = Reading { ecef: *looked.snapshot.ecef.vector(), covariance: turned(&looked.snapshot.covariance) };
        let beside = filter.without_satellites(time).filter(|_| looked.ranges_agree == RangesAgree::Yes);
        let other = beside.and_then(|b| Some(Reading { ecef: *filter.antenna_of(&b)?.vector(), covariance: turned(&b.covariance) }));
        let of_height = |m: &BaroHeight| {
            let apart = m.height.m() - looked.snapshot.position.height.m();
            let [white, bias] = [m.sigma_white.m(), m.sigma_bias.m()];
            chi_square_tail(1.0, apart * apart / (white * white + bias * bias + looked.snapshot.covariance.matrix()[(2, 2)]))
        };
        for timed in together.iter().filter(|t| t.time == time) {
            match &timed.aiding {
                Aiding::Dme(m) => {
                    self.alone.hear(time, m, &[snapshot]);
                    if let Some(other) = other {
                        self.stations.hear(time, m, &[snapshot, other]);
                    }
                }
                Aiding::Vor(m) => self.alone.hear_bearing(time, m, &[snapshot]),
                Aiding::Baro(m) => self.testimony[1] = self.testimony[1].then(testimony(of_height(m))),
                _ => {}
            }
        }
        self.testimony[0] = self.testimony[0].then(self.alone.testimony(time));
        if self.stations.rule_out_the_second(time) {
            self.contradiction.rule_out_the_unit();
        }
    }

    /// Position, test and level of the ranges; the one that is left out leaves the set.
    fn look(&mut self, time: GpsTime, ranges: &mut Ranges) -> Result<(Looked, Option<SatelliteId>), Unavailable> {
        let mut snapshot = self.solver.position(time, ranges)?;
        let (sights, residuals, n) = sights(&snapshot);
        let monitored = self.raim.monitored(&sights[..n], &residuals[..n])?;
        let (mut level_m, mut excluded) = ([monitored.levels.hpl.m(), monitored.levels.vpl.m()], None);
        let ranges_agree = match monitored.decision {
            Exclusion::Nothing if monitored.levels.redundancy > 0 => RangesAgree::Yes,
            Exclusion::Nothing => RangesAgree::Untestable,
            Exclusion::Excluded => {
                excluded = monitored.excluded.and_then(|k| snapshot.members().nth(k)).map(|m| m.satellite);
                RangesAgree::Yes
            }
            Exclusion::NotExcluded => RangesAgree::No,
        };
        if let Some(satellite) = excluded {
            *ranges = ranges.without(satellite);
            snapshot = self.solver.position(time, ranges)?;
        }
        let velocity = self.velocity(&snapshot, ranges);
        let speed = velocity.map_or(0.0, |v| hypot(v.enu_mps.x, v.enu_mps.y));
        level_m[0] += 3.0 * self.settings.age_sigma_s * speed;
        Ok((Looked { snapshot, velocity, ranges_agree, level_m }, excluded))
    }

    /// The velocity by rates that agree, one left out at most.
    fn velocity(&mut self, snapshot: &Snapshot, ranges: &Ranges) -> Option<SnapshotVelocity> {
        let (mut sights, mut residuals, _, mut n) = rate_sights(snapshot, ranges);
        let monitored = self.rates.monitored(&sights[..n], &residuals[..n]).ok()?;
        match (monitored.decision, monitored.excluded) {
            (Exclusion::Nothing, _) => {}
            (Exclusion::Excluded, Some(k)) => {
                sights.copy_within(k + 1..n, k);
                residuals.copy_within(k + 1..n, k);
                n -= 1;
            }
            _ => return None,
        }
        velocity(&sights[..n], &residuals[..n])
    }

    fn note_acceleration(&mut self, before: Option<&Looked>, now: &Looked) {
        let between = |b: &Looked| {
            let dt = now.snapshot.time.seconds_since(b.snapshot.time);
            let change = (now.velocity?.enu_mps - b.velocity?.enu_mps).norm();
            (dt > 0.0 && dt <= 1.5).then(|| change / dt)
        };
        self.acceleration_mps2 = before.and_then(between);
    }

    /// The squares of an instant against their limits.
    fn test(&self, d: &Difference, looked: &Looked) -> Tests {
        let s = looked.snapshot.covariance.matrix();
        let wide = Covariance::<Enu>::claim_symmetric(d.covariance.matrix() * DIFFERENCE_INFLATION + s * DIFFERENCE_FLOOR);
        let up = |value: f64, variance: f64| if variance > 0.0 { value * value / variance } else { f64::NAN };
        let horizontal = |d: &Displacement<Enu>, v: &Covariance<Enu>| normalised_square_horizontal(d, v).unwrap_or(f64::NAN);
        let mut square = [horizontal(&d.position, &wide), 0.0, up(d.position.vector().z, wide.matrix()[(2, 2)]), 0.0];
        if let Some(v) = &looked.velocity {
            let apart = Displacement::<Enu>::from_vector(d.velocity_mps - v.enu_mps);
            let both = Covariance::<Enu>::claim_symmetric(v.covariance + d.velocity_m2ps2);
            square[1] = horizontal(&apart, &both);
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
    pub fn facts(&mut self, filter: &mut Fusion, epoch: GpsTime, given: Option<&Solution>, witnesses: Witnesses) -> Facts {
        let given = given.filter(|s| s.is_sound());
        let of_filter = given.and_then(|s| {
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
            distance_m: given.and_then(|s| apart(&l.snapshot, &filter.antenna_of(s)?)),
        });
        let inertial = self.inertial(epoch);
        let alone = inertial != Inertial::Plausible && inertial != Inertial::Clock;
        if alone && !self.testimony.iter().all(|t| t.lets_stand()) {
            self.contradiction.leave_open();
        }
        let carried = self.carry(epoch, snapshot.as_ref(), given);
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
            witnesses: Some(Witnesses { stations: self.testimony[0], altimeter: self.testimony[1], ..witnesses }),
        }
    }

    /// The covariance to state of a position: its own, and more
    ///
    /// - where two readings contradict each other: so much that its 95 % bounds are the level. The distance of the other reading is no scatter:
    ///   where that one is right the error is as large all the time;
    /// - where nothing checks the filter any more: the last level at the risk of a fault-free level, for what the tests had left unseen by then
    ///   is still in the filter.
    ///
    /// # Errors
    /// As [`chi_factor`].
    pub fn stated(&self, decision: &Decision, own: &Covariance<Enu>) -> Result<Covariance<Enu>, OutOfDomain> {
        let unchecked = decision.source == Source::Filter && decision.reasons.has(Reason::SnapshotMissing);
        let (level, risk) = match (decision.disputed, decision.hpl_m.zip(decision.vpl_m), &self.level) {
            (true, Some((hpl, vpl)), _) => ([hpl, vpl], Risk::ACCURACY.q()),
            (false, _, Some((_, level, _))) if unchecked => (*level, self.settings.requirement.fault_free.q()),
            _ => return Ok(*own),
        };
        let [h, v] = [level[0] / chi_factor(2, risk)?, level[1] / chi_factor(1, risk)?];
        let wide = nalgebra::Matrix3::from_diagonal(&nalgebra::Vector3::new(h * h, h * h, v * v));
        Ok(Covariance::claim_symmetric(own.matrix() + wide))
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

    /// Distance to another solution and its own bound for the risk of a fault-free level.
    fn bound_of(&self, snapshot: &Snapshot, other: &Solution, antenna: &EcefPosition) -> Option<[f64; 2]> {
        let [h, v] = apart(snapshot, antenna)?;
        let q = self.settings.requirement.fault_free.q();
        let sigma_v = sqrt(other.covariance.matrix()[(2, 2)]);
        Some([h + chi_factor(2, q).ok()? * horizontal_axes(&other.covariance).0.m(), v + chi_factor(1, q).ok()? * sigma_v])
    }

    /// The levels of the last epoch that had a snapshot, with what the filter has lost since and what a fault of the unit within the declared
    /// envelope makes of it: sample and truth are each within the envelope. Without an envelope: the faults that the tests leave unseen.
    ///
    /// ```text
    /// HPL(t) = HPL(t0) + K (sigma(t) - sigma(t0)) + a t^2 + g w t^3 / 3
    /// ```
    fn carry(&mut self, epoch: GpsTime, snapshot: Option<&SnapshotFacts>, given: Option<&Solution>) -> Option<CarriedFacts> {
        let given = given?;
        let sigma = [horizontal_axes(&given.covariance).0.m(), sqrt(given.covariance.matrix()[(2, 2)])];
        let tested = snapshot.filter(|s| s.time == epoch && s.ranges_agree == RangesAgree::Yes);
        if let Some(([h, v], [dh, dv])) = tested.and_then(|s| s.level_m.zip(s.distance_m)) {
            self.level = Some((epoch, [h + dh, v + dv], sigma));
        }
        let (from, level, before) = self.level?;
        let t = epoch.seconds_since(from);
        let q = self.settings.requirement.fault_free.q();
        let factor = [chi_factor(2, q).ok()?, chi_factor(1, q).ok()?];
        let [force, rate] = core::array::from_fn(|k| {
            let most = self.settings.envelope.most[k];
            if most.is_finite() { most } else { UNSEEN[k] }
        });
        let fault = if t > 0.0 { force * t * t + GRAVITY * rate * t * t * t / 3.0 } else { 0.0 };
        let level_m = core::array::from_fn(|k| level[k] + factor[k] * (sigma[k] - before[k]).max(0.0) + fault);
        Some(CarriedFacts { age_s: t, level_m })
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

/// Directions, weights and residuals of a snapshot's ranges.
fn sights(snapshot: &Snapshot) -> ([WeightedSight; RANGES_MOST], [f64; RANGES_MOST], usize) {
    let none = WeightedSight { unit: nalgebra::Vector3::zeros(), weight: 0.0, constellation: crate::signal::Constellation::Gps };
    let (mut sights, mut residuals, mut n) = ([none; RANGES_MOST], [0.0; RANGES_MOST], 0);
    for member in snapshot.members() {
        (sights[n], residuals[n]) = (member.sight, member.residual_m);
        n += 1;
    }
    (sights, residuals, n)
}

/// Distance between a snapshot and another position of the antenna, horizontal and vertical \[m\].
fn apart(snapshot: &Snapshot, antenna: &EcefPosition) -> Option<[f64; 2]> {
    let d = antenna.minus(&ecef_from_geodetic(&snapshot.position)).to_enu(&snapshot.position.point);
    let found = [hypot(d.vector().x, d.vector().y), d.vector().z.abs()];
    found.iter().all(|x| x.is_finite()).then_some(found)
}
