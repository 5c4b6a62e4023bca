//! Observations and navigation messages to positions, epoch by epoch on all cores.

use crate::parallel;
use crate::receivers::heard::{Heard, Judged, Listed, Tested};
use crate::receivers::phases::Compare;
use crate::receivers::ranges::{Records, Source, Tally, Unused, plans};
use crate::receivers::signals::Plan;
pub use crate::receivers::signals::Signals;
use crate::smoothing::{self, Form, Smoothed};
use navbound_core::bound::araim::ranging::Beyond;
use navbound_core::frame::{EcefPosition, ecef_from_geodetic};
use navbound_core::geometry::ionosphere::Ionosphere;
use navbound_core::quantity::{GpsTime, Reason, Unavailable};
use navbound_core::signal::smoothing::Smoothing;
use navbound_core::signal::{Constellation, SatelliteId};
use navbound_core::solution::constellations::{Constellations, Treatment};
use navbound_core::solution::declared::{Declarations, Doubt};
use navbound_core::solution::led_off::{Compared, Comparisons};
use navbound_core::solution::mixture::Mixture;
use navbound_core::solution::point::{self, Fix, Offsets, Range, Settings, Used};
use navbound_core::solution::rivals::Rival;
use navbound_formats::precise::Precise;
use navbound_formats::rinex::{Dated, Navigation, Observations};
use std::collections::BTreeMap;

/// Epochs in one task of the pool: about 0.5 ms of work. The first of them begins from nothing, each other from the position before it,
/// so results depend on this number (by less than 2 mm) and not on the number of threads.
const EPOCHS_PER_TASK: usize = 32;
const SYSTEMS: usize = Constellation::ALL.len();

/// Which model of the ionosphere.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Model {
    /// The best that the files have: the GPS message, else Galileo's, else climatology.
    Auto,
    /// The GPS message.
    Broadcast,
    /// NTCM-G by Galileo's message.
    Galileo,
    /// NTCM-G at the long-run mean of solar activity.
    Climatology,
    /// None.
    Uncorrected,
}

/// A message of the ionosphere describes days no further from it than this \[s\]: it is renewed once in six days at the least
/// (IS-GPS-200 20.3.3.5.2.5, standard; two days are ours).
const MESSAGE_LASTS_S: f64 = 2.0 * 86_400.0;

impl Model {
    /// The ionosphere at a time by the messages of a file; `None` where a message is requested by name and none is near.
    pub fn of(self, navigation: &Navigation, time: GpsTime) -> Option<Ionosphere> {
        let broadcast = || Dated::nearest(&navigation.ionosphere_gps, time, MESSAGE_LASTS_S).and_then(Ionosphere::broadcast);
        let galileo = || Dated::nearest(&navigation.ionosphere_galileo, time, MESSAGE_LASTS_S).and_then(Ionosphere::galileo);
        match self {
            Self::Auto => broadcast().or_else(galileo).or(Some(Ionosphere::Climatology)),
            Self::Broadcast => broadcast(),
            Self::Galileo => galileo(),
            Self::Climatology => Some(Ionosphere::Climatology),
            Self::Uncorrected => Some(Ionosphere::Uncorrected),
        }
    }
}

/// What to solve.
#[derive(Debug, Clone)]
pub struct Job {
    /// Constellations to use; GPS, Galileo and BeiDou can be.
    pub systems: Vec<Constellation>,
    /// Which pseudoranges.
    pub signals: Signals,
    /// Carrier smoothing of the pseudoranges, or none: its form and time constant.
    pub smoothing: Option<(Form, Smoothing)>,
    /// How.
    pub settings: Settings,
    /// Whether the ranges of each position are kept.
    pub keep_ranges: bool,
}

/// What came of a day, or an hour.
#[derive(Debug, Clone, Default)]
pub struct Positions {
    /// One outcome an epoch, with the covariance that is declared; what cannot be a position is none.
    pub fixes: Vec<Result<Fix, Unavailable>>,
    /// What each position is doubted for, or refused for.
    pub doubts: Vec<Option<Doubt>>,
    /// Single frequencies were used and no message describes the ionosphere.
    pub undescribed: bool,
    /// The ranges of each position, where they are kept; weights and shared errors widened as the covariance is.
    pub ranges: Vec<Vec<(SatelliteId, Used)>>,
    /// Every satellite that was heard at each epoch, where ranges are kept.
    pub heard: Vec<Vec<Heard>>,
    /// Satellite-epochs of the requested constellations that were used, and that were not.
    pub tally: Tally,
    /// Signals of each constellation.
    pub signals: BTreeMap<char, &'static str>,
    /// Pseudoranges that were used, by constellation: codes in order of preference that the file has.
    pub codes: BTreeMap<char, Vec<String>>,
    /// Share of the pseudoranges that the carrier smoothed, those at the beginning of an arc left out; `None` without smoothing.
    pub smoothed_share: Option<f64>,
    /// What was made of codes against their phases.
    pub comparisons: Comparisons,
}

impl Positions {
    /// Why an epoch's position is not simply there; `None` for one that is.
    pub fn reason(&self, epoch: usize) -> Option<Reason> {
        match (self.doubts.get(epoch).copied().flatten(), self.fixes.get(epoch)?) {
            (Some(doubt), _) => Some(doubt.reason()),
            (None, Err(why)) => Some(why.reason_of_solution()),
            (None, Ok(_)) => None,
        }
    }
}

/// Positions of every epoch, with broadcast orbits and clocks or `precise` ones; health and group delays are always those broadcast.
pub fn positions(observations: &Observations, navigation: &Navigation, precise: Option<&Precise>, job: &Job) -> Positions {
    let records = Records::new(navigation, precise);
    let plans = plans(observations, &records, &job.systems, job.signals);
    let smoothed = smoothed(observations, &plans, job);
    let source = Source { observations, smoothed: smoothed.as_ref(), records: &records, plans: &plans };
    let solver = Solver { source: &source, job };
    let task = |epochs: core::ops::Range<usize>| {
        let (mut ranges, mut beyond, mut last, mut tally) = (Vec::new(), Vec::new(), None, Tally::listing(job.keep_ranges));
        let solve = |epoch: usize| {
            source.collect(epoch, &mut ranges, &mut beyond, &mut tally);
            let mut solved = solver.solve(epoch, &ranges, last.as_ref(), &Offsets::default());
            solved.listed = job.keep_ranges.then(|| Listed { ranges: ranges.clone(), unused: tally.take_listed() });
            let n_low = solved.fix.as_ref().map_or(0, |f| ranges.len().saturating_sub(f.n_used + f.n_excluded));
            tally.leave(Unused::BelowMask, n_low);
            last = solved.fix.as_ref().ok().map(|f: &Fix| ecef_from_geodetic(&f.position)).or(last);
            solved
        };
        (epochs.map(solve).collect::<Vec<_>>(), tally)
    };
    let outcomes = parallel::parts(observations.n_epochs(), EPOCHS_PER_TASK, task);
    let smoothed_share = smoothed.as_ref().map(Smoothed::share);
    let undescribed = job.signals == Signals::Single && !job.settings.ionosphere.is_described();
    let (codes, signals) = (codes(&plans, observations), names(&plans));
    let mut solution = Positions { codes, signals, smoothed_share, undescribed, ..Positions::default() };
    let mut solved = Vec::with_capacity(observations.n_epochs());
    for (part, tally) in outcomes {
        solved.extend(part);
        solution.tally.add(&tally);
    }
    solution.tally.leave(Unused::ConstellationLeftOut, solver.treat(&mut solved));
    declare(&source, solved, job, &mut solution);
    solution
}

/// What came of one epoch's ranges by themselves.
struct Solved {
    fix: Result<Fix, Unavailable>,
    /// Its other readings, where the position cannot stand alone.
    mixture: Option<Box<Mixture>>,
    /// The way to where a constellation that was left out puts the receiver \[m\].
    rival: Option<Rival>,
    kept: Vec<(SatelliteId, Used)>,
    /// Its satellites, to compare their codes with their phases.
    compared: Vec<Compared>,
    /// What was heard, where it is kept.
    listed: Option<Listed>,
}

impl Solved {
    /// Whether offsets of clocks from the past are of use.
    fn few(&self) -> bool {
        self.fix.as_ref().map_or(true, |f| f.spare < FEW)
    }
}

/// All that an epoch is solved from.
#[derive(Clone, Copy)]
struct Solver<'a> {
    source: &'a Source<'a>,
    job: &'a Job,
}

impl Solver<'_> {
    fn solve(&self, epoch: usize, ranges: &[Range], near: Option<&EcefPosition>, offsets: &Offsets) -> Solved {
        let (mut kept, mut compared) = (Vec::new(), Vec::with_capacity(ranges.len()));
        let keep = |u: Used| {
            compared.push(Compared { satellite: ranges[u.index].satellite, unit: u.unit, weight: u.weight });
            if self.job.keep_ranges {
                kept.push((ranges[u.index].satellite, u));
            }
        };
        let solved = point::solve_readings(ranges, self.source.observations.time[epoch], &self.job.settings, near, offsets, keep);
        let (fix, mixture) = solved.map_or_else(|why| (Err(why), None), |(fix, mixture)| (Ok(fix), mixture.map(Box::new)));
        Solved { fix, mixture, rival: None, kept, compared, listed: None }
    }

    /// Solve again the epochs with a constellation that does not fit, without it, and those with few ranges to spare, with the offsets of
    /// clocks that the past predicts. Constellations are followed through the file in its order; the solutions are independent.
    fn treat(&self, solved: &mut [Solved]) -> usize {
        let mut constellations = Constellations::default();
        let follow =
            |(epoch, s): (usize, &Solved)| (epoch, constellations.follow(self.source.observations.time[epoch], s.fix.as_ref().ok()));
        let treatments: Vec<(usize, Treatment)> = solved
            .iter()
            .enumerate()
            .map(follow)
            .filter(|(epoch, t)| t.leaves_out() || t.offsets.several() && solved[*epoch].few())
            .collect();
        let again = |k: usize| {
            let (epoch, treatment) = &treatments[k];
            self.again(*epoch, treatment, &solved[*epoch])
        };
        let treated: Vec<Option<(usize, Solved)>> = parallel::map(treatments.len(), EPOCHS_PER_TASK, again);
        let mut left_out = 0;
        for ((epoch, _), treated) in treatments.iter().zip(treated) {
            if let Some((n, better)) = treated {
                left_out += n;
                solved[*epoch] = Solved { listed: solved[*epoch].listed.take(), ..better };
            }
        }
        left_out
    }

    /// An epoch with its constellations treated, and how many satellites that left out; none where that leaves no position that its ranges
    /// check, or where nothing is left out and nothing is predicted of what the epoch holds.
    fn again(&self, epoch: usize, treatment: &Treatment, before: &Solved) -> Option<(usize, Solved)> {
        let mut ranges = Vec::new();
        // What cannot be used was counted before.
        self.source.collect(epoch, &mut ranges, &mut Vec::new(), &mut Tally::default());
        let all = ranges.len();
        let (left_out, ranges): (Vec<Range>, Vec<Range>) =
            ranges.into_iter().partition(|r| treatment.without[r.satellite.constellation.index()]);
        let near = before.fix.as_ref().ok().map(|f| ecef_from_geodetic(&f.position));
        let without = (ranges.len() < all).then(|| self.solve(epoch, &ranges, near.as_ref(), &Offsets::default()));
        let tied = without.as_ref().unwrap_or(before).few() && treatment.offsets.tie(&ranges);
        let mut solved = if tied { self.solve(epoch, &ranges, near.as_ref(), &treatment.offsets) } else { without? };
        solved.rival = solved.fix.as_ref().ok().and_then(|fix| self.rival(epoch, fix, &left_out));
        let checked = solved.fix.as_ref().is_ok_and(|f| f.spare >= 1);
        (checked || before.fix.is_err()).then_some((all - ranges.len(), solved))
    }

    /// The way to where the constellations that were left out put the receiver, each by itself; the longest.
    fn rival(&self, epoch: usize, fix: &Fix, left_out: &[Range]) -> Option<Rival> {
        let way = |c: Constellation| {
            let own: Vec<Range> = left_out.iter().filter(|r| r.satellite.constellation == c).copied().collect();
            fix.rival(&self.solve(epoch, &own, None, &Offsets::default()).fix.ok()?).map(|way| (c, way))
        };
        Constellation::ALL.into_iter().filter_map(way).max_by(|(_, a), (_, b)| a.norm().total_cmp(&b.norm()))
    }
}

/// With fewer ranges to spare the offsets of clocks are taken from the past.
const FEW: usize = 3;

/// Statuses and covariances, which the receiver's past has a part in, through the file in its order.
fn declare(source: &Source<'_>, solved: Vec<Solved>, job: &Job, out: &mut Positions) {
    let mut declarations = Declarations::default();
    let mut phases = Compare::new(source);
    for (epoch, Solved { fix, mixture, rival, mut kept, compared, listed }) in solved.into_iter().enumerate() {
        let time = source.observations.time[epoch];
        let led = phases.next(epoch, fix.is_ok().then_some(&compared[..]));
        let own = fix.as_ref().map_or(1.0, |f| f.inflation);
        let (fix, doubt) = match fix {
            Ok(mut fix) => {
                let doubt = declarations.declare(time, &mut fix, mixture.as_deref(), rival);
                let doubt = led.map_or(doubt, |way| fix.led_off(&way, doubt));
                let doubt = doubt.or(out.undescribed.then_some(Doubt::IonosphereUndescribed));
                (doubt.and_then(|d| d.refusal(&fix)).map_or(Ok(fix), Err), doubt)
            }
            Err(why) => (Err(why), Doubt::of(&why)),
        };
        // The ranges are widened by all that their position was: by its own residuals, and by its surroundings.
        let whole = fix.as_ref().map_or(1.0, |f| f.inflation);
        for (_, u) in &mut kept {
            u.weight /= whole;
            u.shared_m *= (whole / own).sqrt();
        }
        if let Some(listed) = listed {
            let kept = if fix.is_ok() { kept } else { Vec::new() };
            let used: Vec<SatelliteId> = kept.iter().map(|(satellite, _)| *satellite).collect();
            out.heard.push(listed.fates(fix.as_ref().ok(), &used, job.settings.mask));
            out.ranges.push(kept);
        }
        out.fixes.push(fix);
        out.doubts.push(doubt);
    }
    out.comparisons = phases.comparisons();
}

/// What a monitor made of a receiver's epochs.
#[derive(Debug, Clone)]
pub struct Watch<T> {
    /// One an epoch.
    pub epochs: Vec<T>,
    /// Satellite-epochs that were used, and that were not.
    pub tally: Tally,
    /// Signals of each constellation.
    pub signals: BTreeMap<char, &'static str>,
    /// Share of the pseudoranges that the carrier smoothed; `None` without smoothing.
    pub smoothed_share: Option<f64>,
    /// What was made of codes against their phases.
    pub comparisons: Comparisons,
    /// Every satellite that was heard at each epoch, where ranges are kept.
    pub heard: Vec<Vec<Tested>>,
    /// Epochs whose codes moved together as their phases did not.
    led_off: Vec<bool>,
}

impl<T> Watch<T> {
    /// Why each epoch's position, or its level, is not simply there, by what the monitor says by itself. Codes that are led off together agree
    /// with each other, and no level covers them.
    pub fn reasons(&self, own: impl Fn(&T) -> Option<Reason>) -> Vec<Option<Reason>> {
        let of = |(epoch, led): (&T, &bool)| {
            let own = own(epoch);
            if *led && own.is_none_or(|r| r.status().usable()) { Some(Reason::CodesLedOff) } else { own }
        };
        self.epochs.iter().zip(&self.led_off).map(of).collect()
    }
}

/// What `each` makes of every epoch's ranges, with what each range has beyond a smoothed one; it counts what it leaves. `desk` makes what a
/// task keeps from one epoch to the next; results must not depend on it. `judged` is what became of the satellites, where there is a position.
pub fn each_epoch<D, T: Send>(
    observations: &Observations,
    navigation: &Navigation,
    job: &Job,
    desk: impl Fn() -> D + Sync + Send,
    each: impl Fn(&mut D, GpsTime, (&[Range], &[Beyond]), &mut Tally) -> T + Sync + Send,
    judged: impl for<'a> Fn(&'a T) -> Option<Judged<'a>> + Sync + Send,
) -> Watch<T> {
    let records = Records::new(navigation, None);
    let plans = plans(observations, &records, &job.systems, job.signals);
    let smoothed = smoothed(observations, &plans, job);
    let source = Source { observations, smoothed: smoothed.as_ref(), records: &records, plans: &plans };
    let task = |epochs: core::ops::Range<usize>| {
        let (mut desk, mut ranges, mut beyond, mut tally) = (desk(), Vec::new(), Vec::new(), Tally::listing(job.keep_ranges));
        let one = |epoch: usize| {
            source.collect(epoch, &mut ranges, &mut beyond, &mut tally);
            let watched = each(&mut desk, observations.time[epoch], (&ranges, &beyond), &mut tally);
            let listed = job.keep_ranges.then(|| Listed { ranges: ranges.clone(), unused: tally.take_listed() });
            let heard = listed.map(|listed| listed.tested(judged(&watched).as_ref()));
            (watched, heard)
        };
        let results: Vec<(T, Option<Vec<Tested>>)> = epochs.map(one).collect();
        (results, tally)
    };
    let outcomes = parallel::parts(observations.n_epochs(), EPOCHS_PER_TASK, task);
    let smoothed_share = smoothed.as_ref().map(Smoothed::share);
    let (signals, tally, led_off) = (names(&plans), Tally::default(), Vec::new());
    let mut watch = Watch {
        epochs: Vec::with_capacity(observations.n_epochs()),
        tally,
        signals,
        smoothed_share,
        comparisons: Comparisons::default(),
        heard: Vec::new(),
        led_off,
    };
    for (results, tally) in outcomes {
        for (watched, heard) in results {
            watch.epochs.push(watched);
            watch.heard.extend(heard);
        }
        watch.tally.add(&tally);
    }
    let mut phases = Compare::new(&source);
    watch.led_off = watch
        .epochs
        .iter()
        .enumerate()
        .map(|(epoch, one)| phases.next(epoch, judged(one).map(|j| j.residuals.compared.as_slice())).is_some())
        .collect();
    watch.comparisons = phases.comparisons();
    watch
}

/// The pseudoranges that the plans use, smoothed as the job says.
fn smoothed(observations: &Observations, plans: &[Option<Plan>; SYSTEMS], job: &Job) -> Option<Smoothed> {
    let (form, how) = job.smoothing?;
    let codes = plans.each_ref().map(|plan| plan.iter().flat_map(Plan::codes).collect());
    Some(smoothing::smooth(observations, &codes, form, &how))
}

/// Signals of each constellation.
fn names(plans: &[Option<Plan>; SYSTEMS]) -> BTreeMap<char, &'static str> {
    Constellation::ALL.into_iter().filter_map(|c| Some((c.letter(), plans[c.index()].as_ref()?.choice.name))).collect()
}

pub(crate) fn earlier(time: GpsTime, seconds: f64) -> GpsTime {
    GpsTime::from_nanoseconds(time.nanoseconds().saturating_sub((seconds * 1e9) as i64))
}

fn codes(plans: &[Option<Plan>; SYSTEMS], observations: &Observations) -> BTreeMap<char, Vec<String>> {
    let name = |c: Constellation, k: usize| String::from_utf8_lossy(&observations.codes[c.index()][k]).into_owned();
    let all = Constellation::ALL.into_iter().filter_map(|c| Some((c, plans[c.index()].as_ref()?)));
    all.map(|(c, plan)| (c.letter(), plan.codes().map(|k| name(c, k)).collect())).collect()
}

/// Azimuth of a range's satellite, clockwise from true north, \[-pi, pi\] \[rad\].
pub fn azimuth_rad(used: &Used) -> f64 {
    used.unit.x.atan2(used.unit.y)
}

/// Its elevation \[rad\].
pub fn elevation_rad(used: &Used) -> f64 {
    used.unit.z.clamp(-1.0, 1.0).asin()
}

/// Standard deviation of the range \[m\].
pub fn sigma_m(used: &Used) -> f64 {
    1.0 / used.weight.sqrt()
}

/// Speed over the ground; NaN without a velocity \[m/s\].
pub fn ground_speed_mps(fix: &Fix) -> f64 {
    fix.velocity.map_or(f64::NAN, |(v, _)| v[0].hypot(v[1]))
}
