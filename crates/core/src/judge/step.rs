//! One epoch, one step: errors, bounds, risks, state and alert of one aircraft. A table is a loop over it, a stream is a loop over it.
//!
//! ```text
//! evaluate   what an epoch says by itself: errors along the axes of the path, bounds at both risks, status, risk beyond RNP, state
//! follow     what the epochs before it make of that: the integrity comparison and the monitor
//! step       both
//! ```
//!
//! `evaluate` keeps nothing, so a table may evaluate its rows in any order; `follow` takes them in the order in which they came.

use super::{Errors, Known};
use crate::bound::tse::{Deviation, axes, exceedance_risk};
use crate::bound::{AlertBound, Alerting, Bound, IntegrityComparison, Method};
use crate::frame::{Covariance, Displacement, Enu, counts_as_zero};
use crate::monitor::rnp;
use crate::monitor::state::{PerState, StateTable};
use crate::quantity::{GpsTime, Metres, OutOfDomain, Radians, Reason, Risk, Status, Unavailable};
use crate::solution::Epoch;

/// How epochs are judged.
#[derive(Debug, Clone, Copy)]
pub struct Settings {
    /// The method whose bound is compared with RNP.
    pub method: Alerting,
    /// Risk of the bound that is compared with RNP.
    pub accuracy: Risk,
    /// Risk of the bound that is compared with twice RNP.
    pub integrity: Risk,
    /// Levels of the state classifier; `None` where nothing is classified.
    pub states: Option<StateTable>,
    /// The monitor.
    pub monitor: rnp::Settings,
    /// Whether every epoch that is `ok` should have a protection level. Without it levels are expected from the first one on.
    pub with_levels: bool,
}

/// One epoch as its source gives it; what is not known is `None`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Time of applicability.
    pub time: GpsTime,
    /// Whether its position may be used.
    pub status: Status,
    /// Course of the path.
    pub course: Option<Radians>,
    /// Angle of the path, positive upwards.
    pub path_angle: Option<Radians>,
    /// Flight technical error, positive right of the path \[m\].
    pub fte_m: Option<f64>,
    /// The same above the path \[m\].
    pub fte_v_m: Option<f64>,
    /// Covariance of the navigation error; a variance that is not known is NaN.
    pub covariance: Option<Covariance<Enu>>,
    /// Navigation error east and north, where the truth is known \[m\].
    pub nse_en_m: Option<[f64; 2]>,
    /// The same upwards \[m\].
    pub nse_u_m: Option<f64>,
    /// RNP value in force.
    pub rnp: Option<Metres>,
    /// Horizontal protection level.
    pub hpl: Option<Metres>,
}

impl Sample {
    /// The epoch that methods bound. The expected point is the foot of the perpendicular, so the offset has no part along the path.
    pub fn epoch(&self) -> Epoch {
        let offset = self.fte_m.zip(self.course.and_then(|course| axes(course).ok())).map(|(fte, (_, n))| {
            Displacement::<Enu>::new(Metres::new(fte * n.x), Metres::new(fte * n.y), Metres::new(self.fte_v_m.unwrap_or(0.0)))
        });
        Epoch {
            time: Some(self.time),
            course: self.course,
            path_angle: self.path_angle,
            offset,
            covariance: self.covariance,
            mean: None,
            rnp: self.rnp,
        }
    }

    /// Whether its covariance is zero along an axis: a position without an error is none, so that it bounds nothing.
    pub fn has_zero_covariance(&self) -> bool {
        self.covariance.is_some_and(|covariance| (0..3).any(|axis| counts_as_zero(covariance.matrix()[(axis, axis)])))
    }

    /// Its errors along the axes of the path.
    pub fn errors(&self) -> Errors {
        Errors::of(&Known {
            nse_en_m: self.nse_en_m,
            nse_u_m: self.nse_u_m,
            fte_m: self.fte_m,
            fte_v_m: self.fte_v_m,
            course: self.course,
            path_angle: self.path_angle,
            covariance: self.covariance,
        })
    }
}

/// What an epoch says by itself.
#[derive(Debug, Clone, Copy)]
pub struct Evaluated {
    /// Errors along the axes of the path.
    pub errors: Errors,
    /// Bound at the accuracy risk, or why there is none; `None` where the status does not permit judging.
    pub accuracy: Option<Result<AlertBound, Unavailable>>,
    /// Bound at the integrity risk, in the same way.
    pub integrity: Option<Result<AlertBound, Unavailable>>,
    /// Whether the epoch can be judged: its own status, or that of the reason why there is no bound at the accuracy risk.
    pub status: Status,
    /// Its source calls it `ok` with a covariance that is zero along an axis.
    pub zero_covariance: bool,
    /// Risk that the total system error is beyond RNP, and beyond twice RNP \[1\].
    pub exceedance: Option<[f64; 2]>,
    /// Probability of each state \[1\].
    pub state_probability: Option<PerState>,
    /// The tightest level that the error is beyond with at most the accuracy risk; the number of levels stands for none of them.
    pub tightest_level: Option<u8>,
}

/// What the epochs until now make of one.
#[derive(Debug, Clone, Copy)]
pub struct Judged {
    /// What it says by itself.
    pub evaluated: Evaluated,
    /// What was compared with twice RNP \[m\]; NaN where nothing can be.
    pub integrity_compared: Metres,
    /// The alert, and what began and ended.
    pub step: rnp::Step,
}

/// The judge of one aircraft.
#[derive(Debug, Clone, Copy)]
pub struct Judge {
    pub(super) settings: Settings,
    pub(super) comparison: IntegrityComparison,
    pub(super) monitor: rnp::Monitor,
}

impl Settings {
    /// What an epoch says by itself.
    pub fn evaluate(&self, sample: &Sample) -> Evaluated {
        let errors = sample.errors();
        let epoch = sample.epoch();
        let bound = |risk| sample.status.usable().then(|| self.method.bound(&epoch, risk));
        let accuracy = bound(self.accuracy);
        let zero_covariance = sample.status == Status::Ok && sample.has_zero_covariance();
        let stated = if zero_covariance { Reason::ZeroCovariance.status() } else { sample.status };
        let status = unjudged(accuracy.as_ref()).map_or(stated, |why| why.reason().status());
        let deviation = sample.fte_m.zip(errors.sigma_cross_m).filter(|_| status.usable());
        let deviation = deviation.and_then(|(fte, sigma)| Deviation::new(Metres::new(fte), Metres::new(sigma)).ok());
        let probability = deviation.and_then(|d| self.states.as_ref()?.of_error(d.fte(), d.sigma()).ok());
        Evaluated {
            errors,
            accuracy,
            integrity: bound(self.integrity),
            status,
            zero_covariance,
            exceedance: deviation.zip(sample.rnp).and_then(|(d, rnp)| beyond(d, rnp)),
            state_probability: probability,
            tightest_level: probability.zip(self.states).map(|(p, states)| states.tightest(&p, self.accuracy)),
        }
    }

    /// Bounds of any other method at the accuracy risk and at the integrity risk, for comparison only; `None` where the status does not
    /// permit judging.
    pub fn beside(&self, method: &'static Method, sample: &Sample) -> Option<[Result<Bound, Unavailable>; 2]> {
        let epoch = sample.epoch();
        sample.status.usable().then(|| [self.accuracy, self.integrity].map(|risk| Bound::of(method, &epoch, risk)))
    }
}

impl Evaluated {
    /// Why the epoch has no bound at the accuracy risk although its source permits judging.
    pub fn unjudged(&self) -> Option<&Unavailable> {
        unjudged(self.accuracy.as_ref())
    }

    /// The same as an entry of the list of reasons.
    pub fn reason(&self) -> Option<Reason> {
        self.unjudged().map(Unavailable::reason).or(self.zero_covariance.then_some(Reason::ZeroCovariance))
    }
}

fn unjudged(accuracy: Option<&Result<AlertBound, Unavailable>>) -> Option<&Unavailable> {
    accuracy.and_then(|bound| bound.as_ref().err())
}

/// Risk beyond RNP and beyond twice RNP; `None` where RNP is no length.
fn beyond(deviation: Deviation, rnp: Metres) -> Option<[f64; 2]> {
    let risk = |factor: f64| exceedance_risk(deviation, Metres::new(factor * rnp.m())).ok();
    Some([risk(1.0)?, risk(2.0)?])
}

impl Judge {
    /// A judge that has seen nothing yet.
    ///
    /// # Errors
    /// [`OutOfDomain`] of the monitor's settings.
    pub fn new(settings: Settings) -> Result<Self, OutOfDomain> {
        let comparison = if settings.with_levels { IntegrityComparison::with_levels() } else { IntegrityComparison::default() };
        Ok(Self { settings, comparison, monitor: rnp::Monitor::new(settings.monitor)? })
    }

    /// How it judges.
    pub const fn settings(&self) -> &Settings {
        &self.settings
    }

    /// From now on the bound of another method is compared with RNP.
    pub const fn judge_by(&mut self, method: Alerting) {
        self.settings.method = method;
    }

    /// The monitor: alert in force, open events, counters.
    pub const fn monitor(&self) -> &rnp::Monitor {
        &self.monitor
    }

    /// One epoch.
    pub fn step(&mut self, sample: &Sample) -> Judged {
        self.follow(sample, self.settings.evaluate(sample))
    }

    /// One epoch that was evaluated by the same settings.
    pub fn follow(&mut self, sample: &Sample, evaluated: Evaluated) -> Judged {
        let unknown = || self.settings.method.claim_evaluated(Metres::new(f64::NAN));
        let or_unknown = |bound: Option<Result<AlertBound, Unavailable>>| bound.and_then(Result::ok).unwrap_or_else(unknown);
        let (accuracy, integrity) = (or_unknown(evaluated.accuracy), or_unknown(evaluated.integrity));
        let fte = Metres::new(sample.fte_m.unwrap_or(f64::NAN));
        if sample.hpl.is_some() {
            self.comparison.expect_levels();
        }
        let level = sample.hpl.unwrap_or(Metres::new(f64::NAN));
        let integrity = self.comparison.bound(integrity, fte, level, evaluated.status == Status::Ok);
        let step = self.monitor.step(&rnp::Observation {
            time: sample.time,
            accuracy,
            integrity,
            rnp: sample.rnp.unwrap_or(Metres::new(f64::NAN)),
            usable: evaluated.status.usable(),
        });
        Judged { evaluated, integrity_compared: integrity.length(), step }
    }

    /// Time passes without an epoch: see [`rnp::Monitor::tick`].
    pub fn tick(&mut self, now: GpsTime) -> rnp::Tick {
        self.monitor.tick(now)
    }
}
