//! Can the recorded positions have been flown? Held and jumping positions, before any bound is believed.
//!
//! A position report does not show whether it is true: a decoder or a receiver repeats the last position when none arrives, and a falsified
//! receiver jumps. Both leave a track that no bound of the navigation error covers, so they are found here, first.

mod repeats;

use navbound_core::frame::EcefPosition;
use navbound_core::monitor::ahead::Ahead;
use navbound_core::monitor::motion::{Between, LastSpeed, repeated, sea_level, within};
use navbound_core::monitor::standing::Gone;
use navbound_core::monitor::way::Way;
use navbound_core::quantity::{GpsTime, OutOfDomain};

pub use navbound_core::monitor::motion::{Finding, Limits, Report};

use repeats::Repeats;

/// Finding, age of the position \[s\] and distance from the position before it \[m\] (straight line at sea level).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Judged {
    /// What was found.
    pub finding: Finding,
    /// Since when the position stands \[s\].
    pub age_s: f64,
    /// Distance from the last different position \[m\].
    pub step_m: f64,
    /// Speed of a step that is faster than the aircraft's own, the noise taken off \[m/s\]; 0 for every other.
    pub too_fast_mps: f64,
    /// The reported speed is beyond what those beside it allow, and was not used.
    pub speed_doubted: bool,
}

/// Judge the reports of one track, in the order of time.
///
/// A position is a jump when it lies further from the last different position than
/// `(factor * reported speed + margin) * (time between them + latency) + noise`, with the larger of the two reported speeds, or the stated
/// fastest speed where neither is reported. Where the recording says when both positions were valid, that is the time between them, and the
/// latency is that of such times; elsewhere a position that is reachable only with more latency than makes a held one stale is late. The same
/// holds from the first position of each minute, with the fastest speed reported since. A track that reports no speed is judged by its own:
/// the fastest speed is then that of 95 % of its steps, with factor and margin, and a step that needs any latency is a jump: nothing in it tells
/// an old position from a wrong one.
/// The time runs from the last *different* position: after 87 s without news an aircraft may
/// be 20 km further on, and is not jumping. A reported speed above `factor * m + margin`, m being the median of the speeds reported
/// around it, and by 1 m/s2 over the time to the nearest of them, is not believed, and m counts in its place.
///
/// An unchanged position is held, and stale in time, where the aircraft says that it moves. Where it says nothing of its speed, a position
/// whose bits repeat for longer than the stale time is stale: measurements have noise, and nobody vouches that the aircraft stands. So is one
/// that comes back to the bits of one of the last two different positions, and every one of a track that never leaves its first while its reports come
/// faster than a receiver computes: by time stamps that crawl nothing would ever be old. A speed that fell faster than an aircraft brakes is no speed, and
/// the time in which the aircraft said that it stood is no time to fly in; noise of decimetres on such a hold changes nothing. Where the aircraft says that it moves, a position that makes good
/// less than half the way by its reported speed, the noise taken off, is stale, too: noise on a held position is no flight. One that makes good
/// more than that way over 20 s to two minutes is ahead ([`Ahead`]).
///
/// Provenance: ours.
///
/// # Errors
/// [`OutOfDomain`] with the index of the first position that is no place on the Earth.
pub fn judge(reports: &[Report], limits: &Limits) -> Result<Vec<Judged>, (usize, OutOfDomain)> {
    let mut survey = Survey::default();
    survey.see(reports)?;
    Track::new(survey, limits).judge(reports, &[])
}

/// What must be known of all reports of a track before the first is judged: whether it reports a speed, and the speeds of its own steps.
#[derive(Debug, Clone, Default)]
pub struct Survey {
    reports_speed: bool,
    steps_mps: Vec<f64>,
    from: Option<(GpsTime, EcefPosition)>,
    stand: Stand,
}

/// A track that never leaves its first position.
#[derive(Debug, Clone, Copy, Default)]
struct Stand {
    first: Option<Report>,
    last: Option<GpsTime>,
    n: u32,
    moved: bool,
}

/// Least reports, and least time between them \[s\], of a receiver: none computes two hundred positions in a second. Provenance: ours.
const STAND: (u32, f64) = (10, 0.005);

impl Stand {
    fn see(&mut self, report: &Report) {
        let first = self.first.get_or_insert(*report);
        self.moved |= report.lat_rad != first.lat_rad || report.lon_rad != first.lon_rad;
        self.last = Some(report.time);
        self.n = self.n.saturating_add(1);
    }

    /// Whether its reports come faster than any receiver's: nothing shows that their clock goes on, or that anything is measured.
    fn crawls(&self) -> bool {
        let Some((first, last)) = self.first.zip(self.last).filter(|_| !self.moved && self.n >= STAND.0) else { return false };
        last.seconds_since(first.time) < STAND.1 * f64::from(self.n - 1)
    }
}

impl Survey {
    /// Of a track that reports a speed somewhere: nothing else must be known.
    #[must_use]
    pub fn of_reported_speed() -> Self {
        Self { reports_speed: true, ..Self::default() }
    }

    /// See the next reports.
    ///
    /// # Errors
    /// As [`judge`].
    pub fn see(&mut self, reports: &[Report]) -> Result<(), (usize, OutOfDomain)> {
        self.reports_speed |= !reports.iter().all(|r| r.speed_mps.is_nan());
        if self.reports_speed {
            self.steps_mps = Vec::new();
            return Ok(());
        }
        for (index, report) in reports.iter().enumerate() {
            let here = sea_level(report).map_err(|refusal| (index, refusal))?;
            self.stand.see(report);
            let Some((time, before)) = self.from else {
                self.from = Some((report.time, here));
                continue;
            };
            let elapsed = report.time.seconds_since(time);
            if elapsed >= 1.0 {
                self.steps_mps.push(here.minus(&before).vector().norm() / elapsed);
                self.from = Some((report.time, here));
            } else if elapsed < 0.0 {
                self.from = Some((report.time, here));
            }
        }
        Ok(())
    }

    /// The fastest speed of a track that reports none \[m/s\]: of its own steps of a second or more, the noise taken off, and never above
    /// the limit.
    fn own_speed(mut self, limits: &Limits) -> f64 {
        if self.steps_mps.len() < OWN_STEPS {
            return limits.max_speed_mps;
        }
        self.steps_mps.sort_unstable_by(f64::total_cmp);
        let own = self.steps_mps[((self.steps_mps.len() - 1) as f64 * OWN_SHARE) as usize];
        (limits.speed_factor * own + limits.speed_margin_mps).min(limits.max_speed_mps)
    }
}

/// The judge of one track, which takes its reports in pieces of any length.
#[derive(Debug, Clone)]
pub struct Track {
    limits: Limits,
    silent: bool,
    /// It never says that it moves and never does, under time stamps that crawl.
    frozen: bool,
    last: Option<(Report, EcefPosition)>,
    jumped: Option<GpsTime>,
    window: Option<Window>,
    way: Way,
    ahead: Ahead,
    repeats: Repeats,
    gone: Gone,
    speed: LastSpeed,
    /// Times and speeds of the reports before; NaN where none was reported.
    before: [Spoken; SPEEDS_BESIDE],
}

/// Reports to either side whose speeds a reported speed is compared with. Provenance: ours: four wild ones in a row do not carry their median.
pub const SPEEDS_BESIDE: usize = 4;
/// When a report was made, and its speed \[m/s\].
pub type Spoken = (GpsTime, f64);
/// What an aircraft changes its speed by on its way from one report to the next, in sparse reports \[m/s2\]. Provenance: ours.
const CHANGE_MPS2: f64 = 1.0;

impl Track {
    /// Of a track of which every report was seen.
    #[must_use]
    pub fn new(survey: Survey, limits: &Limits) -> Self {
        let silent = !survey.reports_speed;
        let frozen = silent && limits.moving_mps.is_finite() && survey.stand.crawls();
        let limits = if silent { Limits { max_speed_mps: survey.own_speed(limits), ..*limits } } else { *limits };
        Self {
            limits,
            silent,
            frozen,
            last: None,
            jumped: None,
            window: None,
            way: Way::default(),
            ahead: Ahead::default(),
            repeats: Repeats::default(),
            gone: Gone::default(),
            speed: LastSpeed::default(),
            before: [(GpsTime::default(), f64::NAN); SPEEDS_BESIDE],
        }
    }

    /// Judge the next reports; `after` are those of the [`SPEEDS_BESIDE`] reports after them, as far as there are any.
    ///
    /// # Errors
    /// As [`judge`], with the index among these.
    pub fn judge(&mut self, reports: &[Report], after: &[Spoken]) -> Result<Vec<Judged>, (usize, OutOfDomain)> {
        let mut judged = Vec::with_capacity(reports.len());
        for (index, reported) in reports.iter().enumerate() {
            let later = reports[index + 1..].iter().map(|r| (r.time, r.speed_mps)).chain(after.iter().copied());
            let (usual_mps, nearest_s) = self.usual_speed(reported, later.take(SPEEDS_BESIDE));
            let most_mps = self.limits.speed_factor * usual_mps + self.limits.speed_margin_mps + CHANGE_MPS2 * nearest_s;
            let doubted = reported.speed_mps > most_mps;
            let believed = if doubted { Report { speed_mps: usual_mps, ..*reported } } else { *reported };
            let report = &self.speed.standing_in(&believed, &self.limits);
            judged.push(self.step(report, doubted).map_err(|refusal| (index, refusal))?);
            self.before.rotate_left(1);
            self.before[SPEEDS_BESIDE - 1] = (reported.time, reported.speed_mps);
        }
        Ok(judged)
    }

    /// The median of the speeds reported around a report \[m/s\], and the time to the nearest of them \[s\]; NaN where it reports none.
    fn usual_speed(&self, own: &Report, later: impl Iterator<Item = Spoken>) -> (f64, f64) {
        if own.speed_mps.is_nan() {
            return (f64::NAN, f64::NAN);
        }
        let beside: Vec<Spoken> = self.before.iter().copied().chain(later).filter(|(_, speed_mps)| !speed_mps.is_nan()).collect();
        let nearest_s = beside.iter().map(|(time, _)| own.time.seconds_since(*time).abs()).fold(f64::INFINITY, f64::min);
        let mut speeds: Vec<f64> = beside.iter().map(|(_, speed_mps)| *speed_mps).chain([own.speed_mps]).collect();
        speeds.sort_unstable_by(f64::total_cmp);
        // Of an even number the lower: of two that contradict each other the smaller reach.
        (speeds[(speeds.len() - 1) / 2], nearest_s)
    }

    fn step(&mut self, report: &Report, speed_doubted: bool) -> Result<Judged, OutOfDomain> {
        let limits = &self.limits;
        let here = sea_level(report)?;
        let behind = self.way.is_behind(report, limits)?;
        let repeated_since = self.repeats.since(report);
        let Some((fix, from)) = self.last else {
            self.last = Some((*report, here));
            self.window = Some(Window::begin(report, here));
            self.ahead.is_ahead(report, &here, false, limits);
            self.gone.step(report, false, limits);
            let finding = report.with_age(if self.frozen { Finding::Stale } else { Finding::Plausible }, limits);
            return Ok(Judged { finding, age_s: report.age_s(), step_m: 0.0, too_fast_mps: 0.0, speed_doubted });
        };
        let elapsed = report.time.seconds_since(fix.time);
        let unchanged = report.lat_rad == fix.lat_rad && report.lon_rad == fix.lon_rad;
        let step_m = here.minus(&from).vector().norm();
        let mut too_fast_mps = 0.0;
        let stood_s = self.gone.stood_s;
        self.gone.step(report, unchanged, limits);
        let (mut finding, mut age_s) =
            if unchanged { (repeated(report, fix.time, &self.gone, limits), elapsed) } else { (Finding::Plausible, 0.0) };
        if !unchanged {
            let flown = self.window.as_mut().is_none_or(|w| w.reaches(report, &here, limits));
            let between = Between::new(&fix, report, stood_s, limits);
            let latency_s = if self.silent && !between.dated { 0.0 } else { between.latency_s };
            if !(step_m <= between.reach_m(latency_s, limits)) || !flown {
                finding = Finding::Jump;
                self.jumped = Some(report.time);
            } else if !between.dated && !(step_m <= between.reach_m(limits.stale_after_s, limits)) {
                finding = Finding::Late;
            }
            if step_m > between.reach_m(between.stood_s, limits) && between.elapsed_s > 0.0 {
                too_fast_mps = (step_m - limits.noise_m) / between.elapsed_s;
            }
            // What comes after a jump is judged from there.
            if finding == Finding::Jump || self.window.is_none_or(|w| !within(report.time, w.first.time, WINDOW_S)) {
                self.window = Some(Window::begin(report, here));
            }
            self.last = Some((*report, here));
        }
        let stands_s = self.gone.stands_falsely(report, limits);
        let ahead = self.ahead.is_ahead(report, &here, unchanged, limits);
        let returned = repeated(report, repeated_since, &Gone::default(), limits) == Finding::Stale && report.speed_mps.is_nan();
        let stands = behind.or(stands_s).is_some() || returned || self.frozen;
        finding = finding.with_way(stands, ahead);
        if finding == Finding::Jump {
            self.ahead = Ahead::default();
        } else if stands {
            age_s = age_s.max(behind.or(stands_s).unwrap_or_else(|| report.time.seconds_since(repeated_since)));
        }
        (finding, age_s) = (report.with_age(finding, limits), age_s.max(report.age_s()));
        let settling = self.jumped.is_some_and(|t| within(report.time, t, limits.settle_s));
        Ok(Judged { finding: finding.settling(settling), age_s, step_m, too_fast_mps, speed_doubted })
    }
}

/// Share of the steps of a track that reports no speed whose speed is its own. Provenance: ours: one that jumps at more of its steps than one in
/// twenty is late at each of them.
const OWN_SHARE: f64 = 0.95;
/// Steps from which a track has a speed of its own. Provenance: ours.
const OWN_STEPS: usize = 20;

/// For how long positions are judged from one position on \[s\]. Provenance: ours; several latencies, so that one of them is a small part.
const WINDOW_S: f64 = 60.0;

/// The positions of the last minute or less. From step to step each position may be as old as the latency; over a window only once, or many
/// small steps in hardly any time would be as good as a flight.
#[derive(Debug, Clone, Copy)]
struct Window {
    first: Report,
    from: EcefPosition,
    /// Largest speed reported since; NaN as soon as a position has none.
    fastest_mps: f64,
}

impl Window {
    fn begin(first: &Report, from: EcefPosition) -> Self {
        Self { first: *first, from, fastest_mps: first.speed_mps }
    }

    /// Whether the position may have been flown to since the window began.
    fn reaches(&mut self, to: &Report, here: &EcefPosition, limits: &Limits) -> bool {
        self.fastest_mps = if self.fastest_mps.is_nan() || to.speed_mps.is_nan() { f64::NAN } else { self.fastest_mps.max(to.speed_mps) };
        let fastest = Report { speed_mps: self.fastest_mps, ..*to };
        let first = Report { speed_mps: self.fastest_mps, ..self.first };
        let between = Between::new(&first, &fastest, 0.0, limits);
        here.minus(&self.from).vector().norm() <= between.reach_m(between.latency_s, limits)
    }
}
