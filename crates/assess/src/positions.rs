//! Observations and navigation messages to positions, epoch by epoch on all cores.

use navbound_core::frame::{Covariance, ecef_from_geodetic};
use navbound_core::geometry::atmosphere::ionosphere_factor;
use navbound_core::geometry::broadcast::{Broadcast, SatelliteState, clock_polynomial};
use navbound_core::quantity::{GpsTime, Metres, Reason, Unavailable};
use navbound_core::signal::smoothing::Smoothing;
use navbound_core::signal::{Carrier, Constellation, Ephemeris, Message, SPEED_OF_LIGHT_MPS, SatelliteId, nearest};
use navbound_core::solution::Surroundings;
use navbound_core::solution::point::{self, Fix, Range, Settings, Used};
use navbound_formats::precise::{Precise, Tables};
use navbound_formats::rinex::{Navigation, Observations};
use rayon::prelude::*;
use std::collections::BTreeMap;

use crate::smoothing::{self, Form, Smoothed};

/// Epochs in one task of the pool: about 0.5 ms of work. The first of them begins from nothing, each other from the position before it,
/// so results depend on this number (by less than 2 mm) and not on the number of threads.
const EPOCHS_PER_TASK: usize = 32;
const SYSTEMS: usize = Constellation::ALL.len();

/// Which pseudoranges make a range.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Signals {
    /// One: L1, E1, B1I.
    Single,
    /// The ionosphere-free pair: L1 and L2, E1 and E5a, B1I and B3I.
    Dual,
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
    /// One outcome an epoch. Where surroundings contradict the weights the covariance is widened by what that says.
    pub fixes: Vec<Result<Fix, Unavailable>>,
    /// Whether they do, by epoch.
    pub contradicted: Vec<bool>,
    /// The ranges of each position, where they are kept; weights and shared errors widened as the covariance is.
    pub ranges: Vec<Vec<(SatelliteId, Used)>>,
    /// Satellite-epochs of the wanted constellations that were not used, by reason.
    pub unused: BTreeMap<&'static str, usize>,
    /// Pseudoranges that were used, by constellation: codes in order of preference that the file has.
    pub codes: BTreeMap<char, Vec<String>>,
    /// Share of the pseudoranges that the carrier smoothed, those at the beginning of an arc left out; `None` without smoothing.
    pub smoothed_share: Option<f64>,
}

impl Positions {
    /// Why an epoch's position is not simply there; `None` for one that is.
    pub fn reason(&self, epoch: usize) -> Option<Reason> {
        match self.fixes.get(epoch)? {
            Err(why) => Some(why.reason_of_solution()),
            Ok(fix) if fix.redundancy > 0 && !fix.consistent => Some(Reason::ResidualsContradict),
            Ok(_) if self.contradicted.get(epoch).is_some_and(|c| *c) => Some(Reason::RecentResidualsContradict),
            Ok(fix) if fix.redundancy == 0 => Some(Reason::NoRedundancy),
            Ok(_) => None,
        }
    }
}

/// One frequency of a constellation: columns of the observation table.
#[derive(Debug, Clone, Default)]
struct Band {
    carrier: Option<Carrier>,
    /// Pseudorange, Doppler, strength; pseudoranges by preference.
    columns: Vec<(usize, Option<usize>, Option<usize>)>,
}

/// What a constellation contributes.
#[derive(Debug, Clone, Default)]
struct Plan {
    bands: Vec<Band>,
    /// Messages by preference.
    messages: &'static [Message],
}

/// Broadcast records of every satellite and message, found without a search, with their orbits.
struct Records<'a> {
    navigation: &'a Navigation,
    /// Of each record; `None` where it describes no orbit.
    orbits: Vec<Option<Broadcast>>,
    ranges: Vec<std::ops::Range<usize>>,
    /// Orbits and clocks to use instead of the records' own.
    precise: Option<Tables<'a>>,
}

impl<'a> Records<'a> {
    fn new(navigation: &'a Navigation, precise: Option<&'a Precise>) -> Self {
        let mut ranges = vec![0..0; SYSTEMS * 100 * 5];
        for (k, e) in navigation.ephemerides.iter().enumerate() {
            if let Some(range) = ranges.get_mut(Self::slot(e.satellite, e.message)) {
                *range = if range.end == 0 { k..k + 1 } else { range.start..k + 1 };
            }
        }
        let orbits = navigation.ephemerides.iter().map(|e| Broadcast::new(e).ok()).collect();
        Self { navigation, orbits, ranges, precise: precise.map(Precise::tables) }
    }
    fn slot(satellite: SatelliteId, message: Message) -> usize {
        (satellite.constellation.index() * 100 + usize::from(satellite.number)) * 5 + message as usize
    }
    /// Where the satellite was and what its clock showed when the signal left.
    fn state(&self, satellite: SatelliteId, orbit: Option<&Broadcast>, sent: GpsTime) -> Result<SatelliteState, Unused> {
        match &self.precise {
            None => Ok(orbit.ok_or(Unused::NoOrbit)?.state(sent)),
            Some(tables) => tables.state(satellite, sent).map_err(|_| Unused::NotTabulated),
        }
    }
    /// Group delay against the clock in use \[s\]: broadcast clocks are those of the message, tabulated ones those of an ionosphere-free
    /// pair of codes, by convention of the IGS.
    fn group_delay(&self, e: &Ephemeris, carrier: Carrier) -> Option<f64> {
        let own = e.group_delay(carrier)?;
        if self.precise.is_none() {
            return Some(own);
        }
        let pair = clock_pair(e.satellite.constellation);
        let delays = [e.group_delay(pair[0])?, e.group_delay(pair[1])?];
        let factors = ionosphere_free(pair);
        Some(own - factors[0] * delays[0] - factors[1] * delays[1])
    }
    /// The record and its orbit.
    fn nearest(&self, satellite: SatelliteId, messages: &[Message], time: GpsTime) -> Option<(&'a Ephemeris, Option<&Broadcast>)> {
        messages.iter().find_map(|m| {
            let range = self.ranges.get(Self::slot(satellite, *m))?.clone();
            let k = range.start + nearest(&self.navigation.ephemerides[range], time)?;
            Some((&self.navigation.ephemerides[k], self.orbits[k].as_ref()))
        })
    }
}

/// Positions of every epoch, with broadcast orbits and clocks or `precise` ones; health and group delays are always those broadcast.
pub fn positions(observations: &Observations, navigation: &Navigation, precise: Option<&Precise>, job: &Job) -> Positions {
    let plans = plans(observations, precise.is_some(), job);
    let records = Records::new(navigation, precise);
    let smoothed = job.smoothing.map(|(form, how)| {
        let codes = plans.each_ref().map(|plan| plan.iter().flat_map(|p| &p.bands).flat_map(|b| b.columns.iter().map(|c| c.0)).collect());
        smoothing::smooth(observations, &codes, form, &how)
    });
    let epochs: Vec<usize> = (0..observations.n_epochs()).collect();
    let task = |epochs: &[usize]| {
        let (mut ranges, mut last, mut unused) = (Vec::new(), None, [0_usize; REASONS.len()]);
        let (mut fixes, mut kept) = (Vec::with_capacity(epochs.len()), Vec::new());
        for epoch in epochs {
            collect(observations, smoothed.as_ref(), &records, &plans, *epoch, &mut ranges, &mut unused);
            let time = observations.time[*epoch];
            let fix = if job.keep_ranges {
                let mut used = Vec::with_capacity(ranges.len());
                let tell = |u: Used| used.push((ranges[u.index].satellite, u));
                let fix = point::solve_telling(&ranges, time, &job.settings, last.as_ref(), tell);
                kept.push(used);
                fix
            } else {
                point::solve_near(&ranges, time, &job.settings, last.as_ref())
            };
            last = fix.as_ref().ok().map(|f: &Fix| ecef_from_geodetic(&f.position)).or(last);
            fixes.push(fix);
        }
        (fixes, kept, unused)
    };
    let outcomes: Vec<_> = epochs.par_chunks(EPOCHS_PER_TASK).map(task).collect();
    let smoothed_share = smoothed.as_ref().map(Smoothed::share);
    let mut found = Positions { codes: codes(&plans, observations), smoothed_share, ..Positions::default() };
    for (fixes, kept, unused) in outcomes {
        found.fixes.extend(fixes);
        found.ranges.extend(kept);
        for (reason, n) in REASONS.iter().zip(unused).filter(|(_, n)| *n > 0) {
            *found.unused.entry(reason).or_default() += n;
        }
    }
    // The ranges are widened by all that their position was: by its own residuals, and by its surroundings.
    let own: Vec<f64> = found.fixes.iter().map(|f| f.as_ref().map_or(1.0, |f| f.inflation)).collect();
    found.contradicted = widen(&observations.time, &mut found.fixes);
    for ((used, fix), own) in found.ranges.iter_mut().zip(&found.fixes).zip(own) {
        let whole = fix.as_ref().map_or(1.0, |f| f.inflation);
        for (_, u) in used {
            u.weight /= whole;
            u.shared_m *= (whole / own).sqrt();
        }
    }
    found
}

/// What each constellation of a job contributes.
fn plans(observations: &Observations, precise: bool, job: &Job) -> [Option<Plan>; SYSTEMS] {
    std::array::from_fn(|i| {
        let constellation = Constellation::from_index(i).filter(|c| job.systems.contains(c))?;
        Some(Plan::new(constellation, job.signals, precise, observations)).filter(|p| p.bands.iter().all(|b| !b.columns.is_empty()))
    })
}

/// What `each` makes of every epoch's ranges: broadcast orbits, pseudoranges as measured. `desk` makes what a task keeps from one epoch to
/// the next; results must not depend on it.
pub fn each_epoch<D, T: Send>(
    observations: &Observations,
    navigation: &Navigation,
    job: &Job,
    desk: impl Fn() -> D + Sync + Send,
    each: impl Fn(&mut D, GpsTime, &[Range]) -> T + Sync + Send,
) -> Vec<T> {
    let (plans, records) = (plans(observations, false, job), Records::new(navigation, None));
    let task = |(desk, ranges, unused): &mut (D, Vec<Range>, [usize; REASONS.len()]), epoch: usize| {
        collect(observations, None, &records, &plans, epoch, ranges, unused);
        each(desk, observations.time[epoch], ranges)
    };
    (0..observations.n_epochs()).into_par_iter().map_init(|| (desk(), Vec::new(), [0; REASONS.len()]), task).collect()
}

/// Covariances by the surroundings of each epoch's past minute, which are followed through the file in its order.
fn widen(times: &[GpsTime], fixes: &mut [Result<Fix, Unavailable>]) -> Vec<bool> {
    let mut surroundings = Surroundings::default();
    let follow = |(time, fix): (&GpsTime, &mut Result<Fix, Unavailable>)| {
        let Ok(fix) = fix else { return false };
        let Some(factor) = surroundings.judge(*time, fix) else { return false };
        if factor > fix.inflation {
            fix.covariance = Covariance::claim_symmetric(fix.covariance.matrix() * (factor / fix.inflation));
            fix.inflation = factor;
        }
        true
    };
    times.iter().zip(fixes).map(follow).collect()
}

/// Why a satellite in the file is not in the solution, before geometry is looked at.
const REASONS: [&str; 6] = [
    "no pseudorange",
    "no broadcast record fresh enough",
    "unhealthy",
    "accuracy not predicted",
    "record describes no orbit",
    "no precise orbit or clock around this time",
];

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Unused {
    NoRange,
    NoRecord,
    Unhealthy,
    Unpredicted,
    NoOrbit,
    NotTabulated,
}

impl Plan {
    fn new(constellation: Constellation, signals: Signals, precise: bool, observations: &Observations) -> Self {
        // Attributes by preference: what most receivers track, then combined and encrypted forms.
        let (bands, messages): (&[(u8, &[u8])], &'static [Message]) = match (constellation, signals) {
            (Constellation::Gps, Signals::Single) => (&[(b'1', b"CWPXLSY")], &[Message::Lnav]),
            (Constellation::Gps, Signals::Dual) => (&[(b'1', b"CWPXLSY"), (b'2', b"WPLXSCY")], &[Message::Lnav]),
            // Tabulated clocks of Galileo are those of E1 and E5a, whose group delays are in F/NAV.
            (Constellation::Galileo, Signals::Single) if precise => (&[(b'1', b"CXBZA")], &[Message::Fnav]),
            (Constellation::Galileo, Signals::Single) => (&[(b'1', b"CXBZA")], &[Message::Inav, Message::Fnav]),
            (Constellation::Galileo, Signals::Dual) => (&[(b'1', b"CXBZA"), (b'5', b"QXI")], &[Message::Fnav]),
            (Constellation::BeiDou, Signals::Single) => (&[(b'2', b"IXQ")], &[Message::D1, Message::D2]),
            (Constellation::BeiDou, Signals::Dual) => (&[(b'2', b"IXQ"), (b'6', b"IXQ")], &[Message::D1, Message::D2]),
            _ => (&[], &[]),
        };
        let band = |(band, attributes): &(u8, &[u8])| {
            let column = |kind, attribute| observations.column(constellation, &[kind, *band, attribute]);
            let columns = attributes.iter().filter_map(|a| Some((column(b'C', *a)?, column(b'D', *a), column(b'S', *a)))).collect();
            Band { carrier: Carrier::from_band(constellation, *band), columns }
        };
        Self { bands: bands.iter().map(band).collect(), messages }
    }

    /// A satellite's range.
    fn range(&self, satellite: SatelliteId, values: &[f64], records: &Records<'_>, time: GpsTime) -> Result<Range, Unused> {
        let mut measured = [(Carrier::L1, f64::NAN, f64::NAN, f64::NAN); 2];
        for (slot, band) in measured.iter_mut().zip(&self.bands) {
            *slot = band.measured(values).ok_or(Unused::NoRange)?;
        }
        let measured = &measured[..self.bands.len().min(2)];
        let (first, pseudorange, doppler, cn0) = *measured.first().ok_or(Unused::NoRange)?;
        let (e, orbit) = records.nearest(satellite, self.messages, time).ok_or(Unused::NoRecord)?;
        if !measured.iter().all(|m| e.healthy(m.0)) {
            return Err(Unused::Unhealthy);
        }
        if !(e.accuracy_m >= 0.0) {
            return Err(Unused::Unpredicted);
        }
        let sent = earlier(time, pseudorange / SPEED_OF_LIGHT_MPS);
        let sent = earlier(sent, clock_polynomial(e, sent));
        let state = records.state(satellite, orbit, sent)?;
        let (factors, ionosphere) = combination(measured);
        let mut corrected = SPEED_OF_LIGHT_MPS * state.clock_s;
        for (factor, m) in factors.iter().zip(measured) {
            corrected += factor * (m.1 - SPEED_OF_LIGHT_MPS * records.group_delay(e, m.0).ok_or(Unused::NoRecord)?);
        }
        Ok(Range {
            satellite,
            corrected: Metres::new(corrected),
            position: state.position,
            velocity_mps: state.velocity_mps,
            rate_mps: SPEED_OF_LIGHT_MPS * state.clock_drift - doppler * first.wavelength_m(),
            cn0_dbhz: cn0,
            ionosphere_factor: ionosphere,
            noise_factor: factors.iter().map(|f| f * f).sum::<f64>().sqrt(),
            // What the satellite says of its own orbit says nothing of a tabulated one.
            ure_factor: if records.precise.is_some() { 1.0 } else { (e.accuracy_m / nominal_accuracy(satellite.constellation)).max(1.0) },
        })
    }
}

impl Band {
    /// Carrier, pseudorange, Doppler, strength of the first pseudorange that is there.
    fn measured(&self, values: &[f64]) -> Option<(Carrier, f64, f64, f64)> {
        let at = |column: Option<usize>| column.and_then(|c| values.get(c)).copied().unwrap_or(f64::NAN);
        let carrier = self.carrier?;
        self.columns.iter().map(|(c, d, s)| (carrier, at(Some(*c)), at(*d), at(*s))).find(|m| m.1 > 0.0)
    }
}

/// Factors of the pseudoranges in a range, and its ionospheric delay against that on L1.
///
/// ```text
/// one: 1;    two: f1^2 / (f1^2 - f2^2) and -f2^2 / (f1^2 - f2^2), free of the ionosphere to first order
/// ```
fn combination(measured: &[(Carrier, f64, f64, f64)]) -> ([f64; 2], f64) {
    match measured {
        [(first, ..), (second, ..)] => (ionosphere_free([*first, *second]), 0.0),
        [(only, ..)] => ([1.0, 0.0], ionosphere_factor(*only)),
        _ => ([0.0; 2], 0.0),
    }
}

/// Factors of a pair's pseudoranges that cancel the ionosphere to first order.
fn ionosphere_free(pair: [Carrier; 2]) -> [f64; 2] {
    let [f1, f2] = pair.map(|c| c.frequency_hz() * c.frequency_hz());
    [f1 / (f1 - f2), -f2 / (f1 - f2)]
}

/// Carriers of the codes that clocks of the IGS and its analysis centres refer to (standard: IGS conventions of the products).
const fn clock_pair(constellation: Constellation) -> [Carrier; 2] {
    match constellation {
        Constellation::Galileo => [Carrier::L1, Carrier::L5],
        Constellation::BeiDou => [Carrier::B1I, Carrier::B3I],
        _ => [Carrier::L1, Carrier::L2],
    }
}

/// The accuracy a healthy satellite of the constellation usually states \[m\]: URA index 0 is up to 2.4 m, Galileo's SISA 3.12 m.
const fn nominal_accuracy(constellation: Constellation) -> f64 {
    match constellation {
        Constellation::Galileo => 3.12,
        _ => 2.4,
    }
}

pub(crate) fn earlier(time: GpsTime, seconds: f64) -> GpsTime {
    GpsTime::from_nanoseconds(time.nanoseconds().saturating_sub((seconds * 1e9) as i64))
}

fn collect(
    observations: &Observations,
    smoothed: Option<&Smoothed>,
    records: &Records<'_>,
    plans: &[Option<Plan>; SYSTEMS],
    epoch: usize,
    ranges: &mut Vec<Range>,
    unused: &mut [usize; REASONS.len()],
) {
    ranges.clear();
    for k in observations.satellites(epoch) {
        let satellite = observations.satellite[k];
        let Some(plan) = &plans[satellite.constellation.index()] else { continue };
        match plan.range(
            satellite,
            smoothed.map_or_else(|| observations.values(k), |s| s.values(observations, k)),
            records,
            observations.time[epoch],
        ) {
            Ok(range) => ranges.push(range),
            Err(reason) => unused[reason as usize] += 1,
        }
    }
}

fn codes(plans: &[Option<Plan>; SYSTEMS], observations: &Observations) -> BTreeMap<char, Vec<String>> {
    let name = |c: Constellation, k: usize| String::from_utf8_lossy(&observations.codes[c.index()][k]).into_owned();
    let all = Constellation::ALL.into_iter().filter_map(|c| Some((c, plans[c.index()].as_ref()?)));
    all.map(|(c, plan)| (c.letter(), plan.bands.iter().flat_map(|b| b.columns.iter().map(move |(k, ..)| name(c, *k))).collect())).collect()
}
