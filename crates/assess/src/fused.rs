//! Flights that navigate by their sensors: sensors to filter to epochs, on all cores.
//!
//! The loop through the guidance is closed in two passes. The sensors ride along a first path, the filter's error follows; then the
//! aircraft is flown again, its guidance seeing that error second by second, and the epochs are of this second flight. The error is carried
//! over unchanged: it comes from ranges, clocks and biases, and a path some tens of metres beside the first has the same of all of them. A
//! test flies the sensors along the second path and compares.

use crate::consistency::{attitude, wrong_start};
use crate::error::navigation_error;
use crate::flights::{Flights, numbered};
use crate::fusion::{Driver, Plan};
use crate::stations::Doubting;
use nalgebra::Vector3;
use navbound_core::bound::anp::circle;
use navbound_core::monitor::guard::{Admitted, Guard, Tally};
use navbound_core::monitor::judgement::{Source, Witnesses, decide};
use navbound_core::monitor::separation;
use navbound_core::quantity::{GpsTime, OutOfDomain, Risk, Unavailable};
use navbound_core::signal::{Aiding, TimedAiding};
use navbound_core::solution::ins::{Fusion, Innovations, Kind, Mode, NavState, Samples, Solution};
use navbound_simulate::{
    Doubt, ERROR_FREE, FlownEpoch, Inside, Motion, Navigated, Navigator, SensedFlight, Sensing, Step, Trajectory, fly_by,
};

/// Flights, and what their filters say of themselves.
#[derive(Debug, Clone)]
pub struct Fused {
    /// The epochs.
    pub flights: Flights,
    /// Of each filter: one a flight, and one more for every new start.
    pub verdicts: Vec<Verdict>,
}

/// What a filter says of itself at its end.
#[derive(Debug, Clone)]
pub struct Verdict {
    /// By kind of measurement, in the order of [`Kind::ALL`].
    pub innovations: [Innovations; Kind::ALL.len()],
    /// What became of the inertial samples.
    pub samples: Samples,
    /// How often the receiver's clock has jumped.
    pub clock_jumps: u32,
    /// Filter against snapshot, over the whole flight; of the last filter only.
    pub tally: Tally,
}

impl Fused {
    /// Flights `first .. first + count`, each a function of scenario, seed and its number, whatever the threads.
    ///
    /// # Errors
    /// [`OutOfDomain`] for a scenario without a filter, or as [`Sensing::flight`].
    pub fn fly(sensing: &Sensing, seed: u64, first: u64, count: u64) -> Result<Self, OutOfDomain> {
        let flown = numbered(first, count, |number| flight(sensing, seed, number))?;
        let (epochs, verdicts): (_, Vec<_>) = flown.into_iter().unzip();
        Ok(Self { flights: Flights::of(epochs, first), verdicts: verdicts.concat() })
    }

    /// The flight whose sensors have no errors: its covariances are those to expect, from the same filter on the same schedule of
    /// measurements.
    ///
    /// # Errors
    /// As [`Fused::fly`].
    pub fn error_free(sensing: &Sensing) -> Result<Self, OutOfDomain> {
        let (epochs, verdicts) = flight(sensing, 0, ERROR_FREE)?;
        Ok(Self { flights: Flights::of(vec![epochs], 0), verdicts })
    }
}

fn flight(sensing: &Sensing, seed: u64, number: u64) -> Result<(Vec<FlownEpoch>, Vec<Verdict>), OutOfDomain> {
    let trajectory = sensing.trajectory(seed, number)?;
    let (navigated, verdicts) = navigate(sensing, &trajectory, seed, number)?;
    Ok((fly_by(sensing.outlook(), seed, number, &navigated, sensing.sensors().path)?, verdicts))
}

/// The sensors of a flight along a path, and the filter on them: what it says at each second of the outlook.
///
/// # Errors
/// As [`Fused::fly`].
pub fn navigate(sensing: &Sensing, path: &Trajectory, seed: u64, number: u64) -> Result<(Vec<Navigated>, Vec<Verdict>), OutOfDomain> {
    let Some(navigator) = sensing.navigator() else {
        return Err(OutOfDomain { argument: "filter", value: 0.0, unit: "tables", domain: "a scenario with a [filter] part" });
    };
    let mut sensed = sensing.flight(path, seed, number)?;
    let mut watch = Watch::start(&sensed, navigator, sensing, &navigator.start_normals(seed, number))?;
    let mut navigated = Vec::with_capacity(sensing.outlook().seconds());
    navigated.push(watch.say(sensing, 0, sensed.begin(), sensed.now())?);
    let rate = u64::from(sensing.sensors().rate_hz);
    let mut index = 0;
    while navigated.len() < sensing.outlook().seconds()
        && let Some(step) = sensed.advance()?
    {
        index += 1;
        // Whole nanoseconds: the rate divides a second.
        let due = GpsTime::from_nanoseconds(sensed.begin().nanoseconds() + (index * (1_000_000_000 / rate)) as i64);
        watch.take(&sensed, &step, due);
        if index % rate == 0 {
            navigated.push(watch.say(sensing, navigated.len(), due, &step.truth)?);
            watch.reconsider(due);
        }
    }
    watch.close();
    Ok((navigated, watch.verdicts))
}

/// A filter under way, what stands beside it, and what is counted.
struct Watch {
    driver: Driver,
    guard: Box<Guard>,
    /// Whether the filter with satellites and the one without agree.
    verdict: separation::Verdict,
    /// Satellites used last.
    n_sv: u32,
    n_gated: u64,
    /// Measurements of stations until now, used and not; whether they doubt the filter.
    heard: [u64; 2],
    stations: Doubting,
    /// The disagreement of both filters began while satellites kept the position.
    led_astray: bool,
    last_error: Vector3<f64>,
    verdicts: Vec<Verdict>,
}

/// Results are taken by the second, and every measurement is used.
const PLAN: Plan = Plan { output_period_s: 1.0, update_period_s: 0.0, wheels: None };

impl Watch {
    fn start(sensed: &SensedFlight<'_>, navigator: Navigator, sensing: &Sensing, normals: &[f64; 9]) -> Result<Self, OutOfDomain> {
        let (now, sigma) = (sensed.now(), navigator.start_sigma());
        let truth = NavState::new(sensed.begin(), &now.position, now.velocity_ned_mps, &attitude(now))?;
        let settings = navigator.settings(sensing.sensors())?;
        let filter = Fusion::new(wrong_start(truth, normals, &sigma)?, &sigma, settings)?;
        Ok(Self {
            driver: Driver::new(Box::new(filter), PLAN),
            guard: Box::new(Guard::new(navigator.guard(sensing.sensors(), &settings))?),
            verdict: separation::Verdict::new(settings.separation),
            n_sv: 0,
            n_gated: 0,
            heard: [0; 2],
            stations: Doubting::default(),
            led_astray: false,
            last_error: Vector3::zeros(),
            verdicts: Vec::new(),
        })
    }

    fn take(&mut self, sensed: &SensedFlight<'_>, step: &Step, due: GpsTime) {
        if step.delivered {
            let outcome = self.driver.sample(&step.imu);
            self.guard.sample(due, Some((&step.imu, &outcome)));
        } else {
            self.guard.sample(due, None);
        }
        if sensed.received() {
            self.n_sv = 0;
        }
        let satellites = sensed.aiding().iter().take_while(|a| matches!(a.aiding, Aiding::Satellite(_))).count();
        let (satellites, others) = sensed.aiding().split_at(satellites);
        for together in satellites.chunk_by(|a, b| a.time == b.time) {
            let admitted = self.guard.admit(&mut self.driver.filter, due, together);
            if admitted.usable {
                self.aid_admitted(together, &admitted);
            }
        }
        self.guard.hear(&mut self.driver.filter, others);
        self.driver.aid(others);
    }

    /// The ranges of an instant without those that the others contradict.
    fn aid_admitted(&mut self, together: &[TimedAiding], admitted: &Admitted) {
        let is_excluded = |t: &TimedAiding| matches!(&t.aiding, Aiding::Satellite(m) if admitted.excludes(m.satellite));
        let (out, kept): (Vec<_>, Vec<_>) = together.iter().copied().partition(is_excluded);
        out.iter().for_each(|t| self.driver.filter.reject(t));
        let [_, used] = self.driver.aid(&kept);
        self.n_sv += used as u32;
    }

    /// A second has passed: a filter that contradicts the satellites starts anew at the snapshot, where that is due.
    fn reconsider(&mut self, now: GpsTime) {
        let before = self.verdict_now();
        // Where no filter can start, as beside a pole, none does.
        if self.guard.restart(&mut self.driver.filter, now).unwrap_or(false) {
            self.verdicts.push(before);
            self.n_gated = gated(&self.driver.filter);
        }
    }

    /// What the filter says, against the truth.
    fn say(&mut self, sensing: &Sensing, second: usize, time: GpsTime, truth: &Motion) -> Result<Navigated, OutOfDomain> {
        let filter = &mut self.driver.filter;
        let n_gated = gated(filter);
        let new = (n_gated - self.n_gated) as u32;
        self.n_gated = n_gated;
        let heard = heard(filter);
        let [used, left_out] = [heard[0].saturating_sub(self.heard[0]), heard[1].saturating_sub(self.heard[1])];
        // Where nothing is heard what was last heard stands.
        if used + left_out > 0 {
            self.stations.hear(time, 1.0, [used, left_out], filter.mode() == Mode::Gnss);
        }
        self.heard = heard;
        let dop = if self.n_sv == 0 { [f64::NAN; 2] } else { sensing.outlook().dop(second) };
        let mut navigated = Navigated {
            error_enu_m: self.last_error,
            covariance: Err(Unavailable::Missing { method: "the navigation filter", field: "inertial samples up to it" }),
            n_sv: self.n_sv,
            dop,
            mode: None,
            n_gated: new,
            separation_m: None,
            memory: Some(filter.innovations(Kind::Range).memory(time)).filter(|memory| !memory.is_nan()),
            doubt: None,
            decision: None,
            inside: None,
        };
        let output = match filter.solution(time) {
            // Numbers that cannot be compared are those of no solution: the flight goes on and says so.
            Some(main) => self.output_of(time, main, &mut navigated).ok(),
            None => None,
        };
        navigated.mode = output.map(|s| s.mode);
        navigated.inside = Some(self.inside(output.as_ref()));
        let stations = output.is_some_and(|s| s.mode != Mode::Gnss) && self.stations.doubts(time);
        let witnesses = Witnesses {
            filters_disagree: Some(navigated.doubt == Some(Doubt::Filters)),
            stations_contradict: Some(stations),
            ..Witnesses::NONE
        };
        if stations && navigated.doubt.is_none() {
            navigated.doubt = Some(Doubt::Stations);
        }
        let facts = self.guard.facts(&mut self.driver.filter, time, output.as_ref(), witnesses);
        let decision = decide(&facts);
        let snapshot = self.guard.looked().map(|l| &l.snapshot);
        let position = match decision.source {
            Source::Filter => output.and_then(|s| Some((s.state.position().ok()?, s.covariance))),
            Source::Snapshot => snapshot.map(|s| (s.position, s.covariance)),
            Source::None => None,
        };
        if decision.source == Source::Snapshot {
            navigated.n_sv = snapshot.map_or(0, |s| s.members().count() as u32);
            navigated.dop = sensing.outlook().dop(second);
        }
        if let Some((position, covariance)) = position {
            self.last_error = *navigation_error(&position, &truth.position).vector();
            (navigated.error_enu_m, navigated.covariance) = (self.last_error, Ok(self.guard.stated(&decision, &covariance)?));
        }
        navigated.decision = Some(decision);
        Ok(navigated)
    }

    /// The solution that is given. While both filters disagree and the satellites keep the position, nobody knows which of them is right,
    /// and that is said. When the satellites are lost after that, what the main filter remembers of them is not believed either. Filters
    /// that fall out without satellites share the inertial unit and the stations: one of these is wrong, and neither filter is believed.
    fn output_of(&mut self, time: GpsTime, main: Solution, navigated: &mut Navigated) -> Result<Solution, OutOfDomain> {
        let filter = &mut self.driver.filter;
        let Some(beside) = filter.beside(time) else { return Ok(main) };
        let separation = self.verdict.judge(time, &beside.difference, &beside.covariance, &beside.solution.covariance)?;
        navigated.separation_m = separation.map(|s| [s.distance.m(), s.limit.m()]);
        if !self.verdict.disagree() {
            self.led_astray = false;
            return Ok(main);
        }
        let satellites = filter.mode() == Mode::Gnss;
        self.led_astray |= satellites;
        // Filters that fall out without satellites and still lie within what is said anyhow need no alarm: the longer these are lost the
        // smaller is what the two may differ by.
        let stated_radius = circle(&beside.solution.covariance, None, Risk::ACCURACY)?;
        let far = separation.is_some_and(|s| s.distance > stated_radius);
        if satellites || (!self.led_astray && far) {
            navigated.doubt = Some(Doubt::Filters);
        }
        Ok(if satellites { main } else { beside.solution })
    }

    /// What the filter says of the measurements of the last second, and of the inertial unit.
    fn inside(&mut self, output: Option<&Solution>) -> Inside {
        let mut largest = |kinds: &[Kind]| kinds.iter().filter_map(|k| self.driver.filter.take_largest(*k)).reduce(f64::max);
        Inside {
            innovations: [largest(&[Kind::Range]), largest(&[Kind::Dme, Kind::Vor]), largest(&[Kind::Baro])],
            biases: output.map(|s| s.biases),
            sigma_biases: output.map(|s| s.sigma_biases),
        }
    }

    /// What the filter says at its end.
    fn close(&mut self) {
        self.verdicts.push(Verdict { tally: *self.guard.tally(), ..self.verdict_now() });
    }

    fn verdict_now(&self) -> Verdict {
        let filter = &self.driver.filter;
        Verdict {
            innovations: Kind::ALL.map(|kind| *filter.innovations(kind)),
            samples: *filter.samples(),
            clock_jumps: filter.clock_jumps(),
            tally: Tally::default(),
        }
    }
}

/// Measurements of stations used, and gated or left out.
fn heard(filter: &Fusion) -> [u64; 2] {
    let of = [Kind::Dme, Kind::Vor].map(|kind| filter.innovations(kind));
    [of.iter().map(|i| i.n_used).sum(), of.iter().map(|i| i.n_gated).sum()]
}

fn gated(filter: &Fusion) -> u64 {
    Kind::ALL.iter().map(|kind| filter.innovations(*kind).n_gated).sum()
}

/// The code of a mode in a column: its place in this list; one more where there is none.
pub const MODES: [Mode; 5] = [Mode::Coasting, Mode::VorDme, Mode::DmeDme, Mode::Gnss, Mode::Aligning];
