//! A recorded flight under the judge: what stands beside the filter, and the status of each result.

use crate::fusion::Driver;
use crate::stations::Doubting;
use navbound_core::bound::araim::single::Requirement;
use navbound_core::frame::{Covariance, Enu, Geodetic};
use navbound_core::monitor::guard::{Envelope, Guard, Settings as GuardSettings};
use navbound_core::monitor::judgement::{Decision, Source, Witnesses, decide};
use navbound_core::monitor::separation;
use navbound_core::quantity::{GpsTime, OutOfDomain};
use navbound_core::signal::{Aiding, ImuIncrement, TimedAiding};
use navbound_core::solution::ins::{Advance, Beside, Kind, Mode, Settings, Solution};
use navbound_core::solution::snapshot::SnapshotVelocity;

/// What stands beside a filter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Checks {
    /// Whether the measurements of each instant are solved by themselves and test the filter. A filter that nothing tests is never `ok`.
    pub guarded: bool,
    /// Standard deviation of the age of ranges \[s\]: its share of a level is three of them times the speed.
    pub range_age_sigma_s: f64,
    /// The same of solved positions.
    pub fix_age_sigma_s: f64,
}

impl Default for Checks {
    /// A receiver whose ranges carry its own time; positions over a serial line. Provenance: inferred.
    fn default() -> Self {
        Self { guarded: true, range_age_sigma_s: 1e-3, fix_age_sigma_s: 0.1 }
    }
}

/// A position that stands in for the filter's.
#[derive(Debug, Clone, Copy)]
pub struct StandIn {
    /// Where the antenna is.
    pub position: Geodetic,
    /// Covariance of that.
    pub covariance: Covariance<Enu>,
    /// Where it goes.
    pub velocity: Option<SnapshotVelocity>,
}

/// Time for which the unit must be plausible before a filter is started anew at a snapshot \[s\]. Provenance: inferred.
const RESTART_AFTER_S: f64 = 5.0;

/// What stands beside the filter of a recorded flight.
pub(crate) struct Judged {
    guard: Box<Guard>,
    verdict: separation::Verdict,
    checks: Checks,
    due: Option<GpsTime>,
    heard: u64,
    stations: Doubting,
}

impl Judged {
    pub(crate) fn new(settings: &Settings, checks: Checks) -> Result<Self, OutOfDomain> {
        if !(checks.fix_age_sigma_s >= 0.0 && checks.fix_age_sigma_s.is_finite()) {
            let domain = "[0, inf)";
            return Err(OutOfDomain { argument: "fix_age_sigma_s", value: checks.fix_age_sigma_s, unit: "s", domain });
        }
        let guard = GuardSettings {
            // A recording says nothing of the range of its unit and the envelope of its vehicle.
            envelope: Envelope::NONE,
            requirement: Requirement::RAIM,
            age_sigma_s: checks.range_age_sigma_s,
            gap_most_s: settings.gap_most_s,
            age_most_s: settings.age_most_s,
            restart_after_s: RESTART_AFTER_S,
        };
        let verdict = separation::Verdict::new(settings.separation);
        Ok(Self { guard: Box::new(Guard::new(guard)?), verdict, checks, due: None, heard: 0, stations: Doubting::default() })
    }

    /// A sample and what the filter made of it; the time that it was due. A hole moves that time, a time tag that goes back does not, but for
    /// two samples in the wrong order.
    pub(crate) fn sample(&mut self, sample: &ImuIncrement, outcome: &Advance) -> GpsTime {
        let interval_s = if sample.interval_s > 0.0 && sample.interval_s < 1.0 { sample.interval_s } else { 0.0 };
        let next = self.due.map_or(sample.time, |d| d.plus_seconds(interval_s));
        let accepted = matches!(outcome, Advance::Done | Advance::Bridged { .. } | Advance::AfterGap { .. });
        let near = sample.time.seconds_since(next).abs() <= if accepted { 1.5 } else { 0.5 } * interval_s;
        let due = if near || sample.time > next { sample.time } else { next };
        self.due = Some(due);
        self.guard.sample(due, Some((sample, outcome)));
        due
    }

    /// Measurements in the order of time.
    pub(crate) fn aid(&mut self, driver: &mut Driver, now: GpsTime, aiding: &[TimedAiding]) -> Result<(), OutOfDomain> {
        if !self.checks.guarded {
            driver.aid(aiding);
            return Ok(());
        }
        for together in aiding.chunk_by(|a, b| a.time == b.time && Kind::of(&a.aiding) == Kind::of(&b.aiding)) {
            match together[0].aiding {
                Aiding::Satellite(ref m) if m.range.is_some() => self.ranges(driver, now, together)?,
                Aiding::Fix(_) => self.fixes(driver, now, together)?,
                _ => {
                    self.guard.hear(&mut driver.filter, together);
                    driver.aid(together);
                }
            }
        }
        Ok(())
    }

    fn ranges(&mut self, driver: &mut Driver, now: GpsTime, together: &[TimedAiding]) -> Result<(), OutOfDomain> {
        let admitted = self.guard.admit(&mut driver.filter, now, together);
        if admitted.usable {
            let is_excluded = |t: &TimedAiding| matches!(&t.aiding, Aiding::Satellite(m) if admitted.excluded.contains(&Some(m.satellite)));
            let (out, kept): (Vec<_>, Vec<_>) = together.iter().copied().partition(is_excluded);
            out.iter().for_each(|t| driver.filter.reject(t));
            driver.aid(&kept);
            self.guard.note_level(&mut driver.filter, now);
        }
        self.guard.restart(&mut driver.filter, together[0].time).map(|_| ())
    }

    fn fixes(&mut self, driver: &mut Driver, now: GpsTime, together: &[TimedAiding]) -> Result<(), OutOfDomain> {
        for timed in together {
            // Repeats are the filter's to count.
            if !self.guard.admit_fix(&mut driver.filter, now, timed, self.checks.fix_age_sigma_s) {
                driver.filter.reject(timed);
                self.guard.restart_at_fix(&mut driver.filter, timed.time)?;
                continue;
            }
            driver.aid(core::slice::from_ref(timed));
            self.guard.note_level(&mut driver.filter, now);
            self.guard.restart_at_fix(&mut driver.filter, timed.time)?;
        }
        Ok(())
    }

    /// The status of a result, and the position that is given in place of the filter's where that is so. The covariance of either is then the
    /// one to state.
    pub(crate) fn decide(
        &mut self,
        driver: &mut Driver,
        time: GpsTime,
        solution: &mut Option<Solution>,
        beside: Option<&Beside>,
    ) -> Result<(Decision, Option<StandIn>), OutOfDomain> {
        if let Some(b) = beside {
            self.verdict.judge(time, &b.difference, &b.covariance, &b.solution.covariance)?;
        }
        let used = [Kind::Dme, Kind::Vor].map(|kind| driver.filter.innovations(kind).n_used).iter().sum::<u64>();
        let agree = used.saturating_sub(self.heard);
        self.heard = used;
        let left_out = driver.filter.stations_left_out().count() as u64;
        self.stations.hear(time, 0.0, [agree, left_out], driver.filter.mode() == Mode::Gnss);
        let witnesses = Witnesses {
            filters_disagree: beside.map(|_| self.verdict.disagree()),
            stations_contradict: Some(self.stations.doubts(time)),
            ..Witnesses::NONE
        };
        let facts = self.guard.facts(&mut driver.filter, time, solution.as_ref(), witnesses);
        let decision = decide(&facts);
        let mut stand_in = self.guard.looked().filter(|_| decision.source == Source::Snapshot).map(|l| {
            let (position, covariance) = (l.snapshot.position, l.snapshot.covariance);
            StandIn { position, covariance, velocity: l.velocity }
        });
        let filtered = solution.as_mut().map(|s| &mut s.covariance).filter(|_| decision.source == Source::Filter);
        if let Some(covariance) = stand_in.as_mut().map(|s| &mut s.covariance).or(filtered) {
            *covariance = self.guard.stated(&decision, covariance)?;
        }
        Ok((decision, stand_in))
    }
}
