//! Whole flights through the navigation filter: inertial samples and measurements in the order of their times.

use crate::judged::{Checks, Judged, StandIn};
use nalgebra::Matrix3;
use navbound_core::monitor::judgement::Decision;
use navbound_core::quantity::{GpsTime, OutOfDomain};
use navbound_core::signal::{ImuIncrement, TimedAiding};
use navbound_core::solution::ins::{
    Advance, Beside, Fusion, Kind, NavState, Samples, Settings, Solution, StartSigma, Stop, Strapdown, Wheels,
};

/// How a flight is run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plan {
    /// Time between results \[s\]; 0 is one at every sample.
    pub output_period_s: f64,
    /// Least time between two uses of the same kind of measurement \[s\]; 0 uses all.
    pub update_period_s: f64,
    /// An assumption about the vehicle and how often it is used \[s\]; not for aircraft.
    pub wheels: Option<(Wheels, f64)>,
}

/// The filter at an instant.
#[derive(Debug, Clone, Copy)]
pub struct Moment {
    /// When.
    pub time: GpsTime,
    /// What it says; `None` where its state was not moved to this time: after a stop, in a hole, while samples are refused.
    pub solution: Option<Solution>,
    /// The filter without satellites, where one runs.
    pub beside: Option<Beside>,
    /// States in the filter.
    pub n_states: usize,
    /// What may be done with the position, and why it is no more.
    pub decision: Decision,
    /// The position that is given in place of the filter's.
    pub stand_in: Option<StandIn>,
}

/// A flight that was run.
#[derive(Debug, Clone)]
pub struct Flight {
    /// Results in the order of time.
    pub moments: Vec<Moment>,
    /// What became of the samples.
    pub samples: Samples,
    /// Why the filter stopped, if it did, and when.
    pub stopped: Option<(GpsTime, Stop)>,
    /// Holes that were too long to be bridged: the first sample after each, and the time since the state before it \[s\].
    pub holes: Vec<(GpsTime, f64)>,
    /// The filter at the end: innovations and further states.
    pub filter: Box<Fusion>,
    /// First sample left out because of its numbers.
    pub refused: Option<(GpsTime, OutOfDomain)>,
}

/// Run a flight.
///
/// `aiding` is in the order of time; what comes before the start is passed over, what comes after the last sample is not reached.
///
/// # Errors
/// [`OutOfDomain`] for settings or a start that are none, or measurements whose times go backwards.
pub fn run(
    start: NavState,
    sigma: &StartSigma,
    settings: Settings,
    plan: &Plan,
    checks: Checks,
    imu: impl Iterator<Item = ImuIncrement>,
    aiding: &[TimedAiding],
) -> Result<Flight, OutOfDomain> {
    if let Some(k) = aiding.windows(2).position(|w| w[1].time < w[0].time) {
        let value = aiding[k + 1].time.nanoseconds() as f64;
        return Err(OutOfDomain { argument: "aiding time_ns", value, unit: "ns", domain: "times that do not go backwards" });
    }
    if let Some((wheels, _)) = &plan.wheels {
        wheels.check()?;
    }
    let filter = Box::new(Fusion::new(start, sigma, settings)?);
    let mut driver = Driver::new(filter, *plan);
    let mut judged = Judged::new(&settings, checks)?;
    let mut moments = Vec::new();
    let mut next = aiding.partition_point(|a| a.time < start.time);
    for sample in imu {
        let outcome = driver.sample(&sample);
        let now = judged.sample(&sample, &outcome);
        let until = next + aiding[next..].iter().take_while(|a| a.time <= now).count();
        judged.aid(&mut driver, now, &aiding[next..until])?;
        next = until;
        if let Some(time) = driver.output_is_due(now) {
            moments.push(moment(&mut driver, &mut judged, time)?);
        }
    }
    let samples = *driver.filter.samples();
    // A filter that was started anew listens for its attitude first; no sample is missing then.
    let holes = driver.holes.into_iter().filter(|(_, since_s)| *since_s > settings.gap_most_s).collect();
    Ok(Flight { moments, samples, stopped: driver.stopped, holes, filter: driver.filter, refused: driver.refused })
}

fn moment(driver: &mut Driver, judged: &mut Judged, time: GpsTime) -> Result<Moment, OutOfDomain> {
    let (mut solution, beside) = (driver.filter.solution(time), driver.filter.beside(time));
    let (decision, stand_in) = judged.decide(driver, time, &mut solution, beside.as_ref())?;
    Ok(Moment { time, solution, beside, n_states: driver.filter.n_states(), decision, stand_in })
}

/// The filter and what it needs to be driven in the order of time.
pub(crate) struct Driver {
    pub(crate) filter: Box<Fusion>,
    plan: Plan,
    used: [Option<GpsTime>; Kind::ALL.len()],
    rolled: Option<GpsTime>,
    due: GpsTime,
    stopped: Option<(GpsTime, Stop)>,
    holes: Vec<(GpsTime, f64)>,
    after_gap: bool,
    refused: Option<(GpsTime, OutOfDomain)>,
}

impl Driver {
    pub(crate) fn new(filter: Box<Fusion>, plan: Plan) -> Self {
        let due = filter.time().plus_seconds(plan.output_period_s);
        Self {
            filter,
            plan,
            used: [None; Kind::ALL.len()],
            rolled: None,
            due,
            stopped: None,
            holes: Vec::new(),
            after_gap: false,
            refused: None,
        }
    }

    pub(crate) fn sample(&mut self, sample: &ImuIncrement) -> Advance {
        let outcome = self.filter.advance(sample);
        if let (Advance::AfterGap { since_s }, false) = (outcome, self.after_gap) {
            self.holes.push((sample.time, since_s));
        }
        match outcome {
            Advance::AfterGap { .. } => self.after_gap = true,
            Advance::Done => self.after_gap = false,
            Advance::Refused(why) => {
                self.refused.get_or_insert((sample.time, why));
            }
            Advance::Stopped(why) => {
                self.stopped.get_or_insert((sample.time, why));
            }
            Advance::Bridged { .. } | Advance::Late => {}
        }
        if let Some((wheels, period_s)) = &self.plan.wheels
            && due(&mut self.rolled, sample.time, *period_s)
        {
            self.filter.roll(wheels);
        }
        outcome
    }

    /// Measurements in the order of time, as far as the plan wants them: satellites measured, and used of them.
    pub(crate) fn aid(&mut self, aiding: &[TimedAiding]) -> [usize; 2] {
        let mut satellites = [0; 2];
        // Measurements of one instant belong together.
        for together in aiding.chunk_by(|a, b| a.time == b.time && Kind::of(&a.aiding) == Kind::of(&b.aiding)) {
            let (kind, time) = (Kind::of(&together[0].aiding), together[0].time);
            let last = &mut self.used[kind.index()];
            if *last != Some(time) && !due(last, time, self.plan.update_period_s) {
                continue;
            }
            let judged = self.filter.judges(time);
            let used = self.filter.aid(together);
            // What comes in a hole of the inertial samples is not judged, and contradicts nothing.
            if kind == Kind::Range && judged {
                satellites[0] += together.len();
                satellites[1] += used;
            }
        }
        satellites
    }

    /// Whether a result is due, and of when.
    pub(crate) fn output_is_due(&mut self, time: GpsTime) -> Option<GpsTime> {
        if time < self.due {
            return None;
        }
        // At most one result a nanosecond; a hole is not filled with results that are late.
        let missed = (time.seconds_since(self.due) / self.plan.output_period_s.max(1e-9)).floor();
        self.due = self.due.plus_seconds((missed + 1.0) * self.plan.output_period_s).max(time.plus_seconds(1e-9));
        Some(time)
    }
}

/// Whether a period has passed since the last time, which this then is. A millisecond of jitter does not count.
fn due(last: &mut Option<GpsTime>, time: GpsTime, period_s: f64) -> bool {
    let yes = last.is_none_or(|t| time.seconds_since(t) >= period_s - 1e-3);
    if yes {
        *last = Some(time);
    }
    yes
}

/// Pure inertial navigation: the state after every sample.
///
/// # Errors
/// The index of the first sample that is refused, and why; also one whose time is not after the one before.
pub fn mechanize(start: NavState, imu: impl Iterator<Item = ImuIncrement>) -> Result<Vec<NavState>, (usize, OutOfDomain)> {
    let mut strapdown = Strapdown::new(start);
    let mut states = Vec::with_capacity(imu.size_hint().0);
    for (index, sample) in imu.enumerate() {
        if sample.time <= strapdown.state().time {
            let value = sample.time.nanoseconds() as f64;
            return Err((index, OutOfDomain { argument: "time_ns", value, unit: "ns", domain: "times that increase, after the start" }));
        }
        strapdown.advance(&sample).map_err(|refusal| (index, refusal))?;
        states.push(*strapdown.state());
    }
    Ok(states)
}

/// Standard deviations of the three components of a covariance.
pub fn deviations(covariance: &Matrix3<f64>) -> [f64; 3] {
    [0, 1, 2].map(|k| covariance[(k, k)].sqrt())
}
