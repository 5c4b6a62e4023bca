//! Observations and navigation messages to positions, epoch by epoch on all cores.

use navbound_core::frame::{EcefPosition, ecef_from_geodetic};
use navbound_core::geometry::atmosphere::ionosphere_factor;
use navbound_core::geometry::broadcast::{Broadcast, SatelliteState, clock_polynomial};
use navbound_core::geometry::ionosphere::Ionosphere;
use navbound_core::quantity::{GpsTime, Metres, Unavailable};
use navbound_core::signal::smoothing::Smoothing;
use navbound_core::signal::{Carrier, Constellation, Ephemeris, Message, SPEED_OF_LIGHT_MPS, SatelliteId, nearest};
use navbound_core::solution::constellations::{Constellations, Treatment};
use navbound_core::solution::declared::{Declarations, Doubt};
use navbound_core::solution::mixture::Mixture;
use navbound_core::solution::point::{self, Fix, Offsets, Range, Settings, Used};
use navbound_formats::precise::{Precise, Tables};
use navbound_formats::rinex::{Dated, Navigation, Observations};
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
    /// The ionosphere at a time by the messages of a file; `None` where a message is wanted by name and none is near.
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
    /// Satellite-epochs of the wanted constellations that were not used, by reason.
    pub unused: BTreeMap<&'static str, usize>,
    /// Pseudoranges that were used, by constellation: codes in order of preference that the file has.
    pub codes: BTreeMap<char, Vec<String>>,
    /// Share of the pseudoranges that the carrier smoothed, those at the beginning of an arc left out; `None` without smoothing.
    pub smoothed_share: Option<f64>,
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
    let source = Source { observations, smoothed: smoothed.as_ref(), records: &records, plans: &plans, job };
    let epochs: Vec<usize> = (0..observations.n_epochs()).collect();
    let task = |epochs: &[usize]| {
        let (mut ranges, mut last, mut unused) = (Vec::new(), None, [0_usize; REASONS.len()]);
        let solve = |epoch: &usize| {
            source.collect(*epoch, &mut ranges, &mut unused);
            let solved = source.solve(*epoch, &ranges, last.as_ref(), &Offsets::default());
            last = solved.fix.as_ref().ok().map(|f: &Fix| ecef_from_geodetic(&f.position)).or(last);
            solved
        };
        (epochs.iter().map(solve).collect::<Vec<_>>(), unused)
    };
    let outcomes: Vec<_> = epochs.par_chunks(EPOCHS_PER_TASK).map(task).collect();
    let smoothed_share = smoothed.as_ref().map(Smoothed::share);
    let undescribed = job.signals == Signals::Single && !job.settings.ionosphere.is_described();
    let mut found = Positions { codes: codes(&plans, observations), smoothed_share, undescribed, ..Positions::default() };
    let mut solved = Vec::with_capacity(epochs.len());
    for (part, unused) in outcomes {
        solved.extend(part);
        for (reason, n) in REASONS.iter().zip(unused).filter(|(_, n)| *n > 0) {
            *found.unused.entry(reason).or_default() += n;
        }
    }
    let left_out = source.treat(&mut solved);
    if left_out > 0 {
        found.unused.insert(LEFT_OUT, left_out);
    }
    declare(&observations.time, solved, job.keep_ranges, &mut found);
    found
}

/// Satellites of constellations that were left out whole.
const LEFT_OUT: &str = "its constellation left out: it contradicts itself or the others";

/// What came of one epoch's ranges by themselves.
struct Solved {
    fix: Result<Fix, Unavailable>,
    /// Its other readings, where the position cannot stand alone.
    mixture: Option<Box<Mixture>>,
    kept: Vec<(SatelliteId, Used)>,
}

impl Solved {
    /// Whether offsets of clocks from the past are of use.
    fn few(&self) -> bool {
        self.fix.as_ref().map_or(true, |f| f.spare < FEW)
    }
}

/// All that an epoch is solved from.
#[derive(Clone, Copy)]
struct Source<'a> {
    observations: &'a Observations,
    smoothed: Option<&'a Smoothed>,
    records: &'a Records<'a>,
    plans: &'a [Option<Plan>; SYSTEMS],
    job: &'a Job,
}

impl Source<'_> {
    fn collect(&self, epoch: usize, ranges: &mut Vec<Range>, unused: &mut [usize; REASONS.len()]) {
        collect(self.observations, self.smoothed, self.records, self.plans, epoch, ranges, unused);
    }

    fn solve(&self, epoch: usize, ranges: &[Range], near: Option<&EcefPosition>, offsets: &Offsets) -> Solved {
        let mut kept = Vec::new();
        let keep = |u: Used| {
            if self.job.keep_ranges {
                kept.push((ranges[u.index].satellite, u));
            }
        };
        let solved = point::solve_readings(ranges, self.observations.time[epoch], &self.job.settings, near, offsets, keep);
        match solved {
            Ok((fix, mixture)) => Solved { fix: Ok(fix), mixture: mixture.map(Box::new), kept },
            Err(why) => Solved { fix: Err(why), mixture: None, kept },
        }
    }

    /// Solve again the epochs with a constellation that does not fit, without it, and those with few ranges to spare, with the offsets of
    /// clocks that the past predicts. Constellations are followed through the file in its order; the solutions are independent.
    fn treat(&self, solved: &mut [Solved]) -> usize {
        let mut constellations = Constellations::default();
        let follow = |(epoch, s): (usize, &Solved)| (epoch, constellations.follow(self.observations.time[epoch], s.fix.as_ref().ok()));
        let treatments: Vec<(usize, Treatment)> = solved
            .iter()
            .enumerate()
            .map(follow)
            .filter(|(epoch, t)| t.leaves_out() || t.offsets.several() && solved[*epoch].few())
            .collect();
        let again = |(epoch, treatment): &(usize, Treatment)| self.again(*epoch, treatment, &solved[*epoch]);
        let treated: Vec<Option<(usize, Solved)>> = treatments.par_iter().map(again).collect();
        let mut left_out = 0;
        for ((epoch, _), treated) in treatments.iter().zip(treated) {
            if let Some((n, better)) = treated {
                left_out += n;
                solved[*epoch] = better;
            }
        }
        left_out
    }

    /// An epoch with its constellations treated, and how many satellites that left out; none where that leaves no position that its ranges
    /// check, or where nothing is left out and nothing is predicted of what the epoch holds.
    fn again(&self, epoch: usize, treatment: &Treatment, before: &Solved) -> Option<(usize, Solved)> {
        let (mut ranges, mut unused) = (Vec::new(), [0; REASONS.len()]);
        self.collect(epoch, &mut ranges, &mut unused);
        let all = ranges.len();
        ranges.retain(|r| !treatment.without[r.satellite.constellation.index()]);
        let near = before.fix.as_ref().ok().map(|f| ecef_from_geodetic(&f.position));
        let without = (ranges.len() < all).then(|| self.solve(epoch, &ranges, near.as_ref(), &Offsets::default()));
        let tied = without.as_ref().unwrap_or(before).few() && treatment.offsets.tie(&ranges);
        let solved = if tied { self.solve(epoch, &ranges, near.as_ref(), &treatment.offsets) } else { without? };
        let checked = solved.fix.as_ref().is_ok_and(|f| f.spare >= 1);
        (checked || before.fix.is_err()).then_some((all - ranges.len(), solved))
    }
}

/// With fewer ranges to spare the offsets of clocks are taken from the past.
const FEW: usize = 3;

/// Statuses and covariances, which the receiver's past has a part in, through the file in its order.
fn declare(times: &[GpsTime], solved: Vec<Solved>, keep: bool, found: &mut Positions) {
    let mut declarations = Declarations::default();
    for (time, Solved { fix, mixture, mut kept }) in times.iter().zip(solved) {
        let own = fix.as_ref().map_or(1.0, |f| f.inflation);
        let (fix, doubt) = match fix {
            Ok(mut fix) => {
                let doubt = declarations.declare(*time, &mut fix, mixture.as_deref());
                let doubt = doubt.or(found.undescribed.then_some(Doubt::IonosphereUndescribed));
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
        if keep {
            found.ranges.push(if fix.is_ok() { kept } else { Vec::new() });
        }
        found.fixes.push(fix);
        found.doubts.push(doubt);
    }
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
