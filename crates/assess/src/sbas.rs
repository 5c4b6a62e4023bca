//! SBAS protection levels of many epochs and users from a message log and navigation data.
//!
//! What a service offers at an instant is the same for everyone: it is found once an instant and used for every user. Instants are shared
//! out among the cores; each task replays the messages before its first one, so the result does not depend on their number.

pub mod positions;

use crate::parallel;
use core::ops::Range;
use navbound_core::bound::sbas::model::{Airborne, RangeError};
use navbound_core::bound::sbas::service::{Orbit, Service};
use navbound_core::bound::sbas::terms::{RangeSigmas, RangeTerms};
use navbound_core::bound::sbas::{self, Levels, NoLevel, Seen, Sky, User};
use navbound_core::frame::{Covariance, Enu, Geodetic};
use navbound_core::geometry::broadcast::Broadcast;
use navbound_core::quantity::{GpsTime, Metres, OutOfDomain, Radians, Unavailable};
use navbound_core::signal::sbas::timeout::{Use, WAY_NS};
use navbound_core::signal::sbas::{Correction, Ignored, Message, Obedience, Store, decode};
use navbound_core::signal::{Carrier, Constellation, Ephemeris, Klobuchar, SatelliteId};
use navbound_core::solution::wls::{self, WeightedSight};
use navbound_formats::rinex::Navigation;
use navbound_formats::sbas::Received;

/// Fewest users and epochs that a task gets: below, replaying the messages costs more than the second core saves.
const LEAST_TASK: usize = 256;

/// What is required of a service.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// Precision approach, and en route where that has no level.
    Best,
    /// One use only.
    Only(Use),
}

impl Mode {
    /// What is tried first, and what where that has no level.
    const fn uses(self) -> (Use, Option<Use>) {
        match self {
            Self::Best => (Use::PrecisionApproach, Some(Use::EnRoute)),
            Self::Only(one) => (one, None),
        }
    }
}

/// How the levels are computed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Which levels.
    pub mode: Mode,
    /// Lowest elevation of a satellite.
    pub mask: Radians,
    /// The receiver.
    pub airborne: Airborne,
    /// Whether a message 0 is obeyed.
    pub obedience: Obedience,
}

/// One user at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Request {
    /// When.
    pub time: GpsTime,
    /// Where.
    pub place: Geodetic,
}

/// The level of one request.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Answer {
    /// Horizontal level \[m\], NaN where there is none.
    pub hpl_m: f64,
    /// Vertical level \[m\], NaN where there is none.
    pub vpl_m: f64,
    /// Satellites in the solution; where there is no level, those that could be used.
    pub n_sv: usize,
    /// What the level is good for.
    pub used_for: Option<Use>,
    /// Why there is none.
    pub reason: Option<NoLevel>,
}

/// Messages of one satellite, decoded once, in the order of their ends.
#[derive(Debug, Clone)]
pub struct Feed(Vec<(GpsTime, Message)>);

impl Feed {
    /// From a log, sorted by time; messages of one second keep the order of the log.
    pub fn new(messages: &[Received]) -> Self {
        let mut feed: Vec<_> = messages.iter().map(|m| (m.end, decode(&m.block))).collect();
        feed.sort_by_key(|(end, _)| *end);
        Self(feed)
    }
}

/// PRN code numbers of GPS.
const GPS: std::ops::RangeInclusive<u8> = 1..=37;

/// The broadcast orbits of GPS by satellite, worked out once; those that describe no orbit or no healthy signal are left out.
#[derive(Debug, Clone)]
struct Orbits {
    of: Vec<Vec<Broadcast>>,
    /// Of the same data.
    klobuchar: Option<Klobuchar>,
}

impl Orbits {
    fn new(navigation: &Navigation) -> Self {
        let satellite = |number| SatelliteId { constellation: Constellation::Gps, number };
        let healthy = |e: &&Ephemeris| e.healthy(Carrier::L1);
        let all = |prn| navigation.of(satellite(prn)).iter().filter(healthy).filter_map(|e| Broadcast::new(e).ok()).collect();
        Self { of: GPS.map(all).collect(), klobuchar: navigation.klobuchar_gps }
    }
    /// The record of this issue nearest in time.
    fn record(&self, prn: u8, iode: u8, now: GpsTime) -> Option<&Broadcast> {
        let fits = |b: &&Broadcast| b.record().issue_orbit == u16::from(iode) && b.record().covers(now);
        let gap = |b: &&Broadcast| b.record().orbit_time.seconds_since(now).abs();
        let own = self.of.get(usize::from(prn.checked_sub(*GPS.start())?))?;
        own.iter().filter(fits).min_by(|a, b| gap(a).total_cmp(&gap(b)))
    }
    /// Where it is now.
    fn at(&self, prn: u8, iode: u8, now: GpsTime) -> Option<Orbit> {
        let state = self.record(prn, iode, now)?.state(now);
        Some(Orbit { position_ecef_m: *state.position.vector(), velocity_ecef_mps: state.velocity_mps })
    }
}

/// A receiver that has heard everything up to an instant.
struct Listener<'a> {
    feed: &'a [(GpsTime, Message)],
    heard: usize,
    store: Box<Store>,
    approach: Box<Service>,
    en_route: Box<Service>,
    /// Messages that changed nothing.
    ignored: Vec<(GpsTime, Ignored)>,
}

impl<'a> Listener<'a> {
    fn new(feed: &'a Feed, obedience: Obedience, klobuchar: Option<Klobuchar>) -> Self {
        Self {
            feed: &feed.0,
            heard: 0,
            store: Box::new(Store::new(obedience)),
            approach: Box::new(Service::new(Use::PrecisionApproach, klobuchar)),
            en_route: Box::new(Service::new(Use::EnRoute, klobuchar)),
            ignored: Vec::new(),
        }
    }
    fn listen(&mut self, now: GpsTime) {
        while let Some((end, message)) = self.feed.get(self.heard)
            && end.nanoseconds() + WAY_NS <= now.nanoseconds()
        {
            if let Err(why) = self.store.receive(*end, message) {
                self.ignored.push((*end, why));
            }
            self.heard += 1;
        }
    }
    /// As last refreshed.
    fn last(&self, used_for: Use) -> &Service {
        match used_for {
            Use::PrecisionApproach => &self.approach,
            Use::EnRoute => &self.en_route,
        }
    }
    fn service(&mut self, used_for: Use, now: GpsTime, orbits: &Orbits) -> &Service {
        let service = match used_for {
            Use::PrecisionApproach => &mut self.approach,
            Use::EnRoute => &mut self.en_route,
        };
        service.refresh(&self.store, now, |prn, iode| orbits.at(prn, iode, now));
        service
    }
}

/// Levels of every request, in their order; requests sorted by time are fastest.
///
/// # Errors
/// [`OutOfDomain`] with the index of a request that no receiver could make.
pub fn levels(
    feed: &Feed,
    navigation: &Navigation,
    requests: &[Request],
    settings: &Settings,
) -> Result<Vec<Answer>, (usize, OutOfDomain)> {
    each(feed, navigation, requests, settings, |answer, _| answer)
}

/// The satellites of every solution, none where there is no level.
///
/// # Errors
/// As [`levels`].
pub fn satellites(
    feed: &Feed,
    navigation: &Navigation,
    requests: &[Request],
    settings: &Settings,
) -> Result<Vec<Vec<Seen>>, (usize, OutOfDomain)> {
    let keep = |answer: Answer, sky: &Sky| if answer.used_for.is_some() { sky.satellites().copied().collect() } else { Vec::new() };
    each(feed, navigation, requests, settings, keep)
}

fn each<T: Send>(
    feed: &Feed,
    navigation: &Navigation,
    requests: &[Request],
    settings: &Settings,
    keep: impl Fn(Answer, &Sky) -> T + Sync,
) -> Result<Vec<T>, (usize, OutOfDomain)> {
    let mut order: Vec<usize> = (0..requests.len()).collect();
    order.sort_by_key(|i| requests[*i].time);
    let size = requests.len().div_ceil(parallel::threads()).max(LEAST_TASK);
    let orbits = Orbits::new(navigation);
    let work = |part: Range<usize>| {
        let part = &order[part];
        let mut task = Task {
            listener: Listener::new(feed, settings.obedience, orbits.klobuchar),
            orbits: &orbits,
            settings,
            users: Vec::new(),
            sky: Sky::default(),
        };
        let mut kept = Vec::with_capacity(part.len());
        for instant in part.chunk_by(|a, b| requests[*a].time == requests[*b].time) {
            task.instant(requests, instant, |i, answer, sky| kept.push((i, keep(answer, sky))))?;
        }
        Ok(kept)
    };
    let parts: Result<Vec<Vec<(usize, T)>>, _> = parallel::parts(order.len(), size, work).into_iter().collect();
    let mut kept: Vec<(usize, T)> = parts?.into_iter().flatten().collect();
    kept.sort_by_key(|(i, _)| *i);
    Ok(kept.into_iter().map(|(_, t)| t).collect())
}

/// One core's share of the requests, in the order of time.
struct Task<'a> {
    listener: Listener<'a>,
    orbits: &'a Orbits,
    settings: &'a Settings,
    /// Users of the last instant: those who stay are not computed again.
    users: Vec<User>,
    sky: Sky,
}

impl Task<'_> {
    /// Everyone at one instant; who has no level in the first use is served again by the second.
    fn instant(
        &mut self,
        requests: &[Request],
        instant: &[usize],
        mut keep: impl FnMut(usize, Answer, &Sky),
    ) -> Result<(), (usize, OutOfDomain)> {
        let Some(now) = instant.first().map(|i| requests[*i].time) else { return Ok(()) };
        self.listener.listen(now);
        self.place(requests, instant)?;
        let (first, second) = self.settings.mode.uses();
        let mut without: Vec<usize> = Vec::new();
        let service = self.listener.service(first, now, self.orbits);
        for (k, (i, user)) in instant.iter().zip(&self.users).enumerate() {
            let result = sbas::at(service, user, &mut self.sky);
            if result.is_err() && second.is_some() {
                without.push(k);
            } else {
                keep(*i, answer(result, &self.sky), &self.sky);
            }
        }
        let Some(second) = second.filter(|_| !without.is_empty()) else { return Ok(()) };
        let service = self.listener.service(second, now, self.orbits);
        for k in without {
            let result = sbas::at(service, &self.users[k], &mut self.sky);
            keep(instant[k], answer(result, &self.sky), &self.sky);
        }
        Ok(())
    }

    fn place(&mut self, requests: &[Request], instant: &[usize]) -> Result<(), (usize, OutOfDomain)> {
        for (k, i) in instant.iter().enumerate() {
            let place = &requests[*i].place;
            if self.users.get(k).is_some_and(|user| user.place() == place) {
                continue;
            }
            let user = User::new(place, self.settings.mask, self.settings.airborne).map_err(|e| (*i, e))?;
            match self.users.get_mut(k) {
                Some(kept) => *kept = user,
                None => self.users.push(user),
            }
        }
        Ok(())
    }
}

fn answer(result: Result<Levels, NoLevel>, sky: &Sky) -> Answer {
    match result {
        Ok(levels) => {
            let (vpl_m, used_for) = match levels.vpl {
                Some(vpl) => (vpl.m(), Use::PrecisionApproach),
                None => (f64::NAN, Use::EnRoute),
            };
            Answer { hpl_m: levels.hpl.m(), vpl_m, n_sv: sky.len(), used_for: Some(used_for), reason: None }
        }
        Err(reason) => {
            let n_sv = match reason {
                NoLevel::Geometry(_) | NoLevel::MessageLoss => sky.len(),
                NoLevel::DoNotUse | NoLevel::NoMask => 0,
            };
            Answer { hpl_m: f64::NAN, vpl_m: f64::NAN, n_sv, used_for: None, reason: Some(reason) }
        }
    }
}

/// Messages that changed nothing when the whole feed is heard, with their reason.
pub fn ignored(feed: &Feed, obedience: Obedience) -> Vec<(GpsTime, Ignored)> {
    let mut listener = Listener::new(feed, obedience, None);
    listener.listen(GpsTime::from_nanoseconds(i64::MAX));
    listener.ignored
}

/// Satellites whose UDRE indicator is in force at instants in the order of time, whatever it says and whatever else is missing.
pub fn indicators(feed: &Feed, used_for: Use, obedience: Obedience, at: &[GpsTime]) -> Vec<Vec<u8>> {
    let mut listener = Listener::new(feed, obedience, None);
    let mut each = Vec::with_capacity(at.len());
    for now in at {
        listener.listen(*now);
        let store = &listener.store;
        let without = [Correction::NotInMask, Correction::MessageLoss, Correction::NoUdre];
        let lacks = |prn: u8| store.satellite(prn, used_for, *now).err().is_some_and(|why| without.contains(&why));
        each.push(store.prns(used_for, *now).iter().copied().filter(|prn| !lacks(*prn)).collect());
    }
    each
}

/// HPL and VPL \[m\] of a covariance by the multipliers of precision approach.
pub fn of_covariance(covariance: &Covariance<Enu>) -> [f64; 2] {
    let levels = sbas::levels(covariance, Use::PrecisionApproach);
    [levels.hpl.m(), levels.vpl.map_or(f64::NAN, Metres::m)]
}

/// One solution from terms.
#[derive(Debug, Clone)]
pub struct FromTerms {
    /// Each range.
    pub ranges: Vec<RangeSigmas>,
    /// Covariance of the position, weighted by the ranges.
    pub covariance: Covariance<Enu>,
    /// Horizontal dilution: every range counts the same.
    pub hdop: f64,
    /// Vertical dilution.
    pub vdop: f64,
    /// d_major.
    pub d_major: Metres,
    /// Precision approach.
    pub approach: Levels,
    /// En route.
    pub en_route: Levels,
}

/// Why terms give no level.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TermsRefused {
    /// A wrong term, with the index of its range.
    Term(usize, OutOfDomain),
    /// A geometry that does not serve.
    Geometry(Unavailable),
}

/// Levels of one solution whose terms are all given.
///
/// # Errors
/// [`TermsRefused`].
pub fn from_terms(terms: &[RangeTerms]) -> Result<FromTerms, TermsRefused> {
    let ranges: Result<Vec<_>, _> = terms.iter().enumerate().map(|(i, t)| t.sigmas().map_err(|e| TermsRefused::Term(i, e))).collect();
    let ranges = ranges?;
    let solve = |rows: &[WeightedSight]| wls::covariance_of_weighted(rows.iter().copied()).map_err(TermsRefused::Geometry);
    let rows: Vec<WeightedSight> = ranges.iter().map(|r| r.row).collect();
    let covariance = solve(&rows)?;
    let unweighted = solve(&rows.iter().map(|r| WeightedSight { weight: 1.0, ..*r }).collect::<Vec<_>>())?;
    let q = unweighted.matrix();
    let (hdop, vdop) = ((q[(0, 0)] + q[(1, 1)]).sqrt(), q[(2, 2)].sqrt());
    let (d_major, _) = wls::horizontal_axes(&covariance);
    let [approach, en_route] = [Use::PrecisionApproach, Use::EnRoute].map(|u| sbas::levels(&covariance, u));
    Ok(FromTerms { ranges, covariance, hdop, vdop, d_major, approach, en_route })
}

/// Standard deviations of a range's error: corrections, ionosphere, troposphere, receiver, and of all together \[m\].
pub fn sigmas_m(error: &RangeError) -> [f64; 5] {
    [error.corrected_m2, error.ionosphere_m2, error.troposphere_m2, error.airborne_m2, error.variance_m2()].map(f64::sqrt)
}
