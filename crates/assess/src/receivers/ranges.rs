//! Pseudoranges and broadcast records to ranges, and the reasons of those that cannot be used.

use super::signals::{Measured, Plan, Signals};
use crate::positions::earlier;
use crate::smoothing::Smoothed;
use navbound_core::bound::araim::ranging::Beyond;
use navbound_core::geometry::atmosphere::ionosphere_factor;
use navbound_core::geometry::broadcast::{Broadcast, SatelliteState, clock_polynomial};
use navbound_core::quantity::{GpsTime, Metres};
use navbound_core::signal::{Carrier, Constellation, Ephemeris, Message, SPEED_OF_LIGHT_MPS, SatelliteId, nearest};
use navbound_core::solution::RangeError;
use navbound_core::solution::point::Range;
use navbound_formats::precise::{Precise, Tables};
use navbound_formats::rinex::{Navigation, Observations};

const SYSTEMS: usize = Constellation::ALL.len();
/// Satellite numbers of a constellation.
const NUMBERS: usize = 100;
const MESSAGES: [Message; 5] = [Message::Lnav, Message::Inav, Message::Fnav, Message::D1, Message::D2];
/// Epochs that the choice of signals looks at, at most: a day every six minutes.
const EPOCHS_LOOKED_AT: usize = 256;

/// Why a satellite of the requested constellations is not in a solution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unused {
    /// The first frequency has no pseudorange.
    NoFirstRange,
    /// The second frequency of the pair has none.
    NoSecondRange,
    /// No record of this satellite.
    NoRecord,
    /// Records of it, of messages without a clock for these signals alone.
    NoMessage,
    /// Records of the right message, none near enough.
    RecordTooOld,
    /// The satellite says so.
    Unhealthy,
    /// The satellite predicts no accuracy.
    NoAccuracy,
    /// The elements are those of no orbit.
    NoOrbit,
    /// Neither orbit nor clock in the tables.
    NotTabulated,
    /// Too low.
    BelowMask,
    /// Its constellation contradicts itself or the others.
    ConstellationLeftOut,
}

impl Unused {
    /// All of them.
    pub const ALL: [Self; 11] = [
        Self::NoFirstRange,
        Self::NoSecondRange,
        Self::NoRecord,
        Self::NoMessage,
        Self::RecordTooOld,
        Self::Unhealthy,
        Self::NoAccuracy,
        Self::NoOrbit,
        Self::NotTabulated,
        Self::BelowMask,
        Self::ConstellationLeftOut,
    ];

    /// The name in tables.
    pub const fn id(self) -> &'static str {
        match self {
            Self::NoFirstRange => "no_first_range",
            Self::NoSecondRange => "no_second_range",
            Self::NoRecord => "no_record",
            Self::NoMessage => "no_message",
            Self::RecordTooOld => "record_too_old",
            Self::Unhealthy => "unhealthy",
            Self::NoAccuracy => "no_accuracy",
            Self::NoOrbit => "no_orbit",
            Self::NotTabulated => "not_tabulated",
            Self::BelowMask => "below_mask",
            Self::ConstellationLeftOut => "constellation_left_out",
        }
    }

    /// The words for a reader.
    pub const fn words(self) -> &'static str {
        match self {
            Self::NoFirstRange => "no pseudorange on the first frequency",
            Self::NoSecondRange => "no pseudorange on the second frequency of the pair",
            Self::NoRecord => "no broadcast record of the satellite",
            Self::NoMessage => "broadcast records only of messages without a clock for these signals",
            Self::RecordTooOld => "no broadcast record of the message whose fit interval covers the epoch",
            Self::Unhealthy => "the satellite declares itself unhealthy",
            Self::NoAccuracy => "the satellite predicts no accuracy",
            Self::NoOrbit => "the broadcast record describes no orbit",
            Self::NotTabulated => "no precise orbit or clock around this time",
            Self::BelowMask => "below the elevation mask",
            Self::ConstellationLeftOut => "its constellation was left out: it contradicts itself or the others",
        }
    }
}

/// What became of the satellites, counted by epoch.
#[derive(Debug, Clone)]
pub struct Tally {
    unused: [usize; Unused::ALL.len()],
    used: Vec<u32>,
    /// Satellites without a range since they were last taken, where they are listed.
    listed: Option<Vec<(SatelliteId, Unused)>>,
}

impl Default for Tally {
    fn default() -> Self {
        Self { unused: [0; Unused::ALL.len()], used: vec![0; SYSTEMS * NUMBERS * MESSAGES.len()], listed: None }
    }
}

impl Tally {
    /// One that lists the satellites without a range.
    pub(crate) fn listing(list: bool) -> Self {
        Self { listed: list.then(Vec::new), ..Self::default() }
    }
    /// Those listed since this was last called.
    pub(crate) fn take_listed(&mut self) -> Vec<(SatelliteId, Unused)> {
        self.listed.as_mut().map(core::mem::take).unwrap_or_default()
    }
    /// Count satellites that are not used.
    pub fn leave(&mut self, why: Unused, n: usize) {
        self.unused[why as usize] += n;
    }
    /// Those of another.
    pub(crate) fn add(&mut self, other: &Self) {
        self.unused.iter_mut().zip(other.unused).for_each(|(sum, n)| *sum += n);
        self.used.iter_mut().zip(&other.used).for_each(|(sum, n)| *sum += n);
    }
    /// Satellite-epochs that were not used, by reason; only those that occurred.
    pub fn unused(&self) -> impl Iterator<Item = (Unused, usize)> + '_ {
        Unused::ALL.into_iter().zip(self.unused).filter(|(_, n)| *n > 0)
    }
    /// Ranges that went into solutions, by satellite and message, those below the mask among them.
    pub fn used(&self) -> impl Iterator<Item = (SatelliteId, Message, usize)> + '_ {
        Constellation::ALL.into_iter().flat_map(move |constellation| {
            (0..NUMBERS as u8).flat_map(move |number| {
                let satellite = SatelliteId { constellation, number };
                MESSAGES.into_iter().map(move |m| (satellite, m, self.used[slot(satellite, m)] as usize)).filter(|(.., n)| *n > 0)
            })
        })
    }
}

fn slot(satellite: SatelliteId, message: Message) -> usize {
    (satellite.constellation.index() * NUMBERS + usize::from(satellite.number) % NUMBERS) * MESSAGES.len() + message as usize
}

/// Broadcast records of every satellite and message, found without a search, with their orbits.
pub(crate) struct Records<'a> {
    navigation: &'a Navigation,
    /// Of each record; `None` where it describes no orbit.
    orbits: Vec<Option<Broadcast>>,
    ranges: Vec<std::ops::Range<usize>>,
    /// Orbits and clocks to use instead of the records' own.
    precise: Option<Tables<'a>>,
}

impl<'a> Records<'a> {
    pub(crate) fn new(navigation: &'a Navigation, precise: Option<&'a Precise>) -> Self {
        let mut ranges = vec![0..0; SYSTEMS * NUMBERS * MESSAGES.len()];
        for (k, e) in navigation.ephemerides.iter().enumerate() {
            let range = &mut ranges[slot(e.satellite, e.message)];
            *range = if range.end == 0 { k..k + 1 } else { range.start..k + 1 };
        }
        let orbits = navigation.ephemerides.iter().map(|e| Broadcast::new(e).ok()).collect();
        Self { navigation, orbits, ranges, precise: precise.map(Precise::tables) }
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

    fn of(&self, satellite: SatelliteId, message: Message) -> std::ops::Range<usize> {
        self.ranges[slot(satellite, message)].clone()
    }

    /// The place of the record nearest in time, of the first message that has one which covers it; and the message's place.
    fn nearest(&self, satellite: SatelliteId, messages: &[Message], time: GpsTime) -> Result<(usize, usize), Unused> {
        let of = |m: &Message| {
            let range = self.of(satellite, *m);
            Some(range.start + nearest(&self.navigation.ephemerides[range], time)?)
        };
        let any = |messages: &[Message]| messages.iter().any(|m| !self.of(satellite, *m).is_empty());
        let why = || if any(messages) { Unused::RecordTooOld } else { Unused::NoMessage };
        let near = messages.iter().enumerate().find_map(|(place, m)| Some((of(m)?, place)));
        near.ok_or_else(|| if any(&MESSAGES) { why() } else { Unused::NoRecord })
    }
}

/// What each constellation contributes: `None` for those that are not requested or cannot be used.
///
/// Where several choices of signals are observed, that with the most satellite-epochs that have both pseudoranges and a record; one whose
/// records have its own clock counts a tenth more. Equal ones by preference.
pub(crate) fn plans(
    observations: &Observations,
    records: &Records<'_>,
    systems: &[Constellation],
    signals: Signals,
) -> [Option<Plan>; SYSTEMS] {
    std::array::from_fn(|i| {
        let constellation = Constellation::from_index(i).filter(|c| systems.contains(c))?;
        let mut plans = Plan::all(constellation, signals, observations);
        let observed = plans.iter().filter(|p| p.is_observed()).count();
        if observed > 1 {
            plans.retain(Plan::is_observed);
            // Of equals the last is the largest: preference backwards.
            plans.reverse();
            return plans.into_iter().max_by_key(|plan| served(plan, constellation, observations, records));
        }
        let place = plans.iter().position(Plan::is_observed).unwrap_or(0);
        plans.into_iter().nth(place)
    })
}

/// How often a choice of signals serves: ten for a satellite-epoch, eleven where the record has the clock of the very signals.
fn served(plan: &Plan, constellation: Constellation, observations: &Observations, records: &Records<'_>) -> usize {
    let each = observations.n_epochs().div_ceil(EPOCHS_LOOKED_AT).max(1);
    let epochs = (0..observations.n_epochs()).step_by(each);
    let satellites = epochs.flat_map(|epoch| observations.satellites(epoch).map(move |k| (observations.time[epoch], k)));
    let score = |(time, k): (GpsTime, usize)| {
        let (satellite, values) = (observations.satellite[k], observations.values(k));
        if satellite.constellation != constellation || plan.bands.iter().any(|band| band.measured(values).is_none()) {
            return 0;
        }
        let own = |place: usize| if place < plan.choice.own_clock { 11 } else { 10 };
        records.nearest(satellite, plan.choice.messages, time).map_or(0, |(_, place)| own(place))
    };
    satellites.map(score).sum()
}

/// A satellite's pseudoranges at an epoch.
#[derive(Clone, Copy)]
pub(crate) struct Received<'a> {
    satellite: SatelliteId,
    /// As they are used.
    values: &'a [f64],
    /// Variance of the code noise that smoothing left of each; nothing was smoothed where there is none.
    noise_share: Option<&'a [f32]>,
    time: GpsTime,
}

impl Plan {
    /// A satellite's range, what it has beyond a smoothed one, and the message.
    fn range(&self, received: Received<'_>, records: &Records<'_>) -> Result<(Range, Beyond, Message), Unused> {
        let Received { satellite, values, time, .. } = received;
        let nothing = Measured { carrier: Carrier::L1, pseudorange: f64::NAN, column: 0 };
        let mut pair = [nothing; 2];
        for ((slot, band), why) in pair.iter_mut().zip(&self.bands).zip([Unused::NoFirstRange, Unused::NoSecondRange]) {
            *slot = band.measured(values).ok_or(why)?;
        }
        let measured = &pair[..self.bands.len().min(2)];
        let (first, band) = measured.first().zip(self.bands.first()).ok_or(Unused::NoFirstRange)?;
        let (record, _) = records.nearest(satellite, self.choice.messages, time)?;
        let (e, orbit) = (&records.navigation.ephemerides[record], records.orbits[record].as_ref());
        if !measured.iter().all(|m| e.healthy(m.carrier)) {
            return Err(Unused::Unhealthy);
        }
        if !e.predicts_accuracy() {
            return Err(Unused::NoAccuracy);
        }
        let sent = earlier(time, first.pseudorange / SPEED_OF_LIGHT_MPS);
        let sent = earlier(sent, clock_polynomial(e, sent));
        let state = records.state(satellite, orbit, sent)?;
        let (factors, ionosphere) = combination(measured);
        let mut corrected = SPEED_OF_LIGHT_MPS * state.clock_s;
        for (factor, m) in factors.iter().zip(measured) {
            let delay = records.group_delay(e, m.carrier).ok_or(Unused::NoMessage)?;
            corrected += factor * (m.pseudorange - SPEED_OF_LIGHT_MPS * delay);
        }
        let (doppler, cn0_dbhz) = band.tracking(values);
        let range = Range {
            satellite,
            corrected: Metres::new(corrected),
            position: state.position,
            velocity_mps: state.velocity_mps,
            rate_mps: SPEED_OF_LIGHT_MPS * state.clock_drift - doppler * first.carrier.wavelength_m(),
            cn0_dbhz,
            ionosphere_factor: ionosphere,
            noise_factor: factors.iter().map(|f| f * f).sum::<f64>().sqrt(),
            // What the satellite says of its own orbit says nothing of a tabulated one.
            ure_factor: if records.precise.is_some() { 1.0 } else { (e.accuracy_m / nominal_accuracy(satellite.constellation)).max(1.0) },
        };
        let left = |m: &Measured| received.noise_share.and_then(|s| s.get(m.column)).map_or(1.0, |s| f64::from(*s));
        let noise_factor = (factors.iter().zip(measured).map(|(f, m)| f * f * left(m)).sum::<f64>() * weakness(cn0_dbhz)).sqrt();
        let beyond = Beyond { noise_factor, code_bias: self.code_bias(satellite.constellation, first.column, factors[0]) };
        Ok((range, beyond, e.message))
    }

    /// A constant that the broadcast clock does not cover: provenance *inferred*.
    fn code_bias(&self, constellation: Constellation, first: usize, factor: f64) -> Metres {
        let precise = self.bands.first().is_some_and(|band| band.precise_codes.contains(&first));
        Metres::new(match constellation {
            Constellation::Gps if !precise => factor * CIVIL_CODE_BIAS_M,
            Constellation::BeiDou if self.bands.len() > 1 => BEIDOU_PAIR_BIAS_M,
            _ => 0.0,
        })
    }
}

/// How much the variance of code noise grows where the signal is weak, as in the weights of positions; no allowance where the receiver
/// gives no strength.
fn weakness(cn0_dbhz: f64) -> f64 {
    let below_db = RangeError::CALIBRATED.reference_cn0_dbhz - cn0_dbhz;
    if below_db > 0.0 { 10.0_f64.powf(below_db / 10.0) } else { 1.0 }
}

/// C/A less P(Y) of the GPS satellites: root mean square of their published differential code biases, which lie within 0.7 m.
const CIVIL_CODE_BIAS_M: f64 = 0.4;
/// A receiver delays the pairs of second- and third-generation BeiDou satellites differently, and one clock takes up the mean: half of the
/// difference seen at one receiver (ESBC 2020-177).
const BEIDOU_PAIR_BIAS_M: f64 = 2.0;

/// Factors of the pseudoranges in a range, and its ionospheric delay against that on L1.
///
/// ```text
/// one: 1;    two: f1^2 / (f1^2 - f2^2) and -f2^2 / (f1^2 - f2^2), free of the ionosphere to first order
/// ```
pub(super) fn combination(measured: &[Measured]) -> ([f64; 2], f64) {
    match measured {
        [first, second] => (ionosphere_free([first.carrier, second.carrier]), 0.0),
        [only] => ([1.0, 0.0], ionosphere_factor(only.carrier)),
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

/// Where ranges come from.
pub(crate) struct Source<'a> {
    pub(crate) observations: &'a Observations,
    pub(crate) smoothed: Option<&'a Smoothed>,
    pub(crate) records: &'a Records<'a>,
    pub(crate) plans: &'a [Option<Plan>; SYSTEMS],
}

impl Source<'_> {
    /// The ranges of an epoch, what each has beyond a smoothed one; the others are counted.
    pub(crate) fn collect(&self, epoch: usize, ranges: &mut Vec<Range>, beyond: &mut Vec<Beyond>, tally: &mut Tally) {
        ranges.clear();
        beyond.clear();
        let (o, time) = (self.observations, self.observations.time[epoch]);
        for k in o.satellites(epoch) {
            let satellite = o.satellite[k];
            let Some(plan) = &self.plans[satellite.constellation.index()] else { continue };
            let values = self.smoothed.map_or_else(|| o.values(k), |s| s.values(o, k));
            let received = Received { satellite, values, noise_share: self.smoothed.map(|s| s.noise_shares(o, k)), time };
            match plan.range(received, self.records) {
                Ok((range, more, message)) => {
                    ranges.push(range);
                    beyond.push(more);
                    tally.used[slot(satellite, message)] += 1;
                }
                Err(why) => {
                    tally.leave(why, 1);
                    if let Some(listed) = &mut tally.listed {
                        listed.push((satellite, why));
                    }
                }
            }
        }
    }
}
