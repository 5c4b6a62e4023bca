//! Aircraft as a receiver of Mode S hears them: halves of positions made whole, with what the aircraft last claimed of them.
//!
//! The counter of a receiver is no time, so a position applies at the arrival of its message. An aircraft is believed where two pairs of
//! halves agree, and anew where a position is farther from the last one than its speed allows: a pair whose halves are of different places
//! leads hundreds of kilometres astray. docs/methods/live.md says what becomes of a claim.

use super::Decoded;
use crate::claims::{Claim, Claims};
use crate::codec::{Damaged, Reader, Writer};
use crate::counters::Refused;
use crate::position::{Position, Shown, TrackId};
use navbound_core::monitor::neighbours::east_north_m;
use navbound_core::quantity::GpsTime;
use navbound_formats::mode_s::{self, Categories, Content, Cpr, Fix, Sender, Squitter, Supplements, WrongParity, containment};
use std::collections::BTreeMap;

/// Most time between the halves of a position \[ns\]; standard.
const HALVES_NS: i64 = 10_000_000_000;
/// Age from which a claim is not known any more, and a position is not the last one \[ns\]. Provenance: ours.
const KNOWN_NS: i64 = 60_000_000_000;
/// Age from which a speed or a difference of heights says nothing of a position \[ns\]. Provenance: ours.
const MOTION_NS: i64 = 5_000_000_000;
/// What an aircraft moves between two positions \[m/s\]: 1.5 times its speed and 50 m/s, or 400 m/s where it states none; the specification.
const FACTOR: f64 = 1.5;
const MORE_MPS: f64 = 50.0;
const UNKNOWN_MPS: f64 = 400.0;
/// Time by which arrivals of one second of an aircraft may differ \[s\]. Provenance: ours.
const ARRIVAL_S: f64 = 1.0;
/// Aircraft whose last messages are kept. Provenance: ours.
const MOST_AIRCRAFT: usize = 50_000;
/// Receivers mark so what multilateration computed: a counter that begins with these bytes; readsb.
const COMPUTED: [u8; 5] = [0xff, 0x00, 0x4d, 0x4c, 0x41];

/// Something that was heard, and when \[ns\].
type Heard<T> = Option<(T, i64)>;

/// How well the place of an aircraft is known.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Placed {
    fix: Fix,
    at_ns: i64,
    /// Two pairs of halves agree.
    confirmed: bool,
}

#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Aircraft {
    heard_ns: i64,
    version: u8,
    supplement_a: Heard<bool>,
    categories: Heard<Categories>,
    ground_speed_mps: Heard<f64>,
    ground_track_rad: Heard<f64>,
    geometric_less_pressure_m: Heard<f64>,
    /// The last half of the even and of the odd format.
    halves: [Heard<Cpr>; 2],
    placed: Option<Placed>,
}

/// What was heard no longer ago than `most_ns`.
fn recent<T: Copy>(heard: Heard<T>, now_ns: i64, most_ns: i64) -> Option<T> {
    heard.filter(|(_, at_ns)| now_ns.saturating_sub(*at_ns) <= most_ns).map(|(value, _)| value)
}

/// All aircraft that a receiver hears, by address; the eighth digit tells those of other addresses apart.
#[derive(Debug, Clone, Default)]
pub(crate) struct Sky {
    aircraft: BTreeMap<u32, Aircraft>,
    /// When the silent ones were last forgotten \[ns\].
    swept_ns: i64,
}

impl Sky {
    /// One squitter, which arrived at `arrival`; nothing where it holds no position.
    fn take(&mut self, squitter: &Squitter, arrival: Option<GpsTime>, claims: &Claims) -> Option<Decoded> {
        let of_position = matches!(squitter.content, Content::Airborne { .. });
        if squitter.sender == Sender::Ground {
            return of_position.then_some(Err(Refused::OfOthers));
        }
        // Without an arrival nothing has a time.
        let Some(now) = arrival else { return of_position.then_some(Err(Refused::Undated)) };
        let (now_ns, key) = (now.nanoseconds(), squitter.address | u32::from(squitter.sender == Sender::OwnOtherAddress) << 24);
        if !self.has_room(key, now_ns) {
            return of_position.then_some(Err(Refused::FleetFull));
        }
        let aircraft = self.aircraft.entry(key).or_default();
        aircraft.heard_ns = now_ns;
        match squitter.content {
            Content::Airborne { code, supplement_b, pressure_altitude_m, cpr } => Some(aircraft.place(cpr, now_ns).and_then(|fix| {
                let track = name(squitter).ok_or(Refused::TrackName)?;
                let difference_m = recent(aircraft.geometric_less_pressure_m, now_ns, MOTION_NS);
                let known = Position {
                    lat_rad: Some(fix.lat_deg.to_radians()),
                    lon_rad: Some(fix.lon_deg.to_radians()),
                    h_m: pressure_altitude_m.zip(difference_m).map(|(altitude, difference)| altitude + difference),
                    ground_speed_mps: recent(aircraft.ground_speed_mps, now_ns, MOTION_NS),
                    ground_track_rad: recent(aircraft.ground_track_rad, now_ns, MOTION_NS),
                    ..Position::new(track, now)
                };
                Ok(aircraft.claimed(known, code, supplement_b, claims))
            })),
            // On the surface only a place nearby tells where; a source without a position has none.
            Content::Surface | Content::Without => Some(Err(Refused::NoPosition)),
            Content::Velocity { ground_speed_mps, ground_track_rad, geometric_less_pressure_m } => {
                aircraft.ground_track_rad = ground_track_rad.map(|track| (track, now_ns));
                aircraft.ground_speed_mps = ground_speed_mps.map(|speed| (speed, now_ns));
                aircraft.geometric_less_pressure_m = geometric_less_pressure_m.map(|difference| (difference, now_ns));
                None
            }
            Content::Target(categories) => {
                aircraft.categories = Some((categories, now_ns));
                None
            }
            Content::Operational { version, supplement_a, categories } => {
                aircraft.version = version;
                aircraft.supplement_a = Some((supplement_a, now_ns));
                aircraft.categories = categories.map(|categories| (categories, now_ns));
                None
            }
            Content::Other => None,
        }
    }

    /// Whether there is room for an address: those that are silent make some, looked for once in a second.
    fn has_room(&mut self, key: u32, now_ns: i64) -> bool {
        if self.aircraft.len() >= MOST_AIRCRAFT && !self.aircraft.contains_key(&key) && now_ns.saturating_sub(self.swept_ns) > 1_000_000_000
        {
            self.aircraft.retain(|_, aircraft| now_ns.saturating_sub(aircraft.heard_ns) <= KNOWN_NS);
            self.swept_ns = now_ns;
        }
        self.aircraft.len() < MOST_AIRCRAFT || self.aircraft.contains_key(&key)
    }
}

/// Name of the track of a squitter: its address, behind `~` where it is another one.
fn name(squitter: &Squitter) -> Option<TrackId> {
    let other = if squitter.sender == Sender::OwnOtherAddress { "~" } else { "" };
    TrackId::new(&format!("{other}{:06x}", squitter.address))
}

/// Whether a counter marks what multilateration computed.
pub(super) fn computed(counter: [u8; 6]) -> bool {
    counter.starts_with(&COMPUTED)
}

/// A message as it was heard: a position, or why there is none; nothing of a message that holds no position.
pub(super) fn heard(sky: &mut Sky, message: Option<&[u8]>, arrival: Option<GpsTime>, claims: &Claims) -> Option<Decoded> {
    match mode_s::squitter(message?) {
        Ok(squitter) => sky.take(&squitter?, arrival, claims),
        Err(WrongParity) => Some(Err(Refused::DamagedFrame)),
    }
}

/// Whose a message is; `None` for one that holds nothing of a position's.
pub(super) fn track(squitter: &Squitter) -> Option<TrackId> {
    name(squitter).filter(|_| squitter.content != Content::Other)
}

impl Aircraft {
    /// The place of the aircraft by a new half, where one is known that may be believed.
    fn place(&mut self, half: Cpr, now_ns: i64) -> Result<Fix, Refused> {
        let (own, other) = (usize::from(half.odd), usize::from(!half.odd));
        self.halves[own] = Some((half, now_ns));
        let other = self.halves[other].filter(|(_, at_ns)| now_ns.saturating_sub(*at_ns) <= HALVES_NS).ok_or(Refused::HalfAPosition)?;
        let fix = half.with(other.0).ok_or(Refused::HalfAPosition)?;
        let last = self.placed.filter(|placed| now_ns.saturating_sub(placed.at_ns) <= KNOWN_NS);
        let Some(last) = last else {
            self.placed = Some(Placed { fix, at_ns: now_ns, confirmed: false });
            return Err(Refused::HalfAPosition);
        };
        let elapsed_s = now_ns.saturating_sub(last.at_ns).max(0) as f64 * 1e-9 + ARRIVAL_S;
        let speed_mps = recent(self.ground_speed_mps, now_ns, MOTION_NS).map_or(UNKNOWN_MPS, |speed| FACTOR * speed + MORE_MPS);
        // Not `>`: a step that is no number is none that fits.
        if !(step_m(last.fix, fix) <= speed_mps * elapsed_s) {
            // Either may be the wrong one. What follows is made of new halves alone.
            self.placed = None;
            self.halves = [None; 2];
            return Err(Refused::Contradicted);
        }
        // The first pair is confirmed by one that shares no half with it.
        if !last.confirmed && other.1 <= last.at_ns {
            return Err(Refused::HalfAPosition);
        }
        self.placed = Some(Placed { fix, at_ns: now_ns, confirmed: true });
        Ok(fix)
    }

    /// A position with the bounds that the aircraft claims for it, or why it claims none.
    fn claimed(&self, known: Position, code: u8, supplement_b: bool, claims: &Claims) -> Position {
        let now_ns = known.time.nanoseconds();
        // Of an aircraft whose version was not heard nothing is known to be coded as it is read here.
        let categories = recent(self.categories, now_ns, KNOWN_NS).filter(|_| self.version > 0);
        let supplements = Supplements { a: recent(self.supplement_a, now_ns, KNOWN_NS), b: (self.version >= 2).then_some(supplement_b) };
        let contained = containment(code, self.version, supplements);
        let claim = Claim {
            nic: (self.version > 0).then_some(contained.category),
            nac_p: categories.map(|categories| categories.nac_p),
            sil: categories.map(|categories| categories.sil),
        };
        let known = Position { shown: Shown { claim, ..Shown::default() }, ..known };
        known.bounded(claims.bounds_within(claim, contained.radius_m))
    }
}

/// Distance of two places; that of far ones is not exact, and far all the same \[m\].
fn step_m(a: Fix, b: Fix) -> f64 {
    let [east, north] = east_north_m(radians(a), radians(b));
    libm::hypot(east, north)
}

fn radians(fix: Fix) -> [f64; 2] {
    [fix.lat_deg.to_radians(), fix.lon_deg.to_radians()]
}

/// Of several positions of an aircraft that arrived at once, only the last is known to be of then.
pub(super) fn keep_the_last(decoded: &mut [Decoded]) {
    let mut seen = std::collections::BTreeSet::new();
    for each in decoded.iter_mut().rev() {
        if let Ok(position) = each
            && !seen.insert(position.track)
        {
            *each = Err(Refused::Superseded);
        }
    }
}

fn write_heard<T>(to: &mut Writer, heard: Heard<T>, write: impl FnOnce(&mut Writer, T)) {
    to.option(heard, |to, (value, at_ns)| {
        write(to, value);
        to.i64(at_ns);
    });
}

fn read_heard<'a, T>(from: &mut Reader<'a>, read: impl FnOnce(&mut Reader<'a>) -> Result<T, Damaged>) -> Result<Heard<T>, Damaged> {
    from.option(|from| Ok((read(from)?, from.i64()?)))
}

impl Sky {
    pub(super) fn write(&self, to: &mut Writer) {
        to.i64(self.swept_ns);
        to.u32(self.aircraft.len() as u32);
        for (key, aircraft) in &self.aircraft {
            to.u32(*key);
            aircraft.write(to);
        }
    }

    pub(super) fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        let (swept_ns, n) = (from.i64()?, from.u32()? as usize);
        if n > MOST_AIRCRAFT {
            return Err(Damaged("more aircraft than are kept"));
        }
        let aircraft = (0..n).map(|_| Ok((from.u32()?, Aircraft::read(from)?))).collect::<Result<_, Damaged>>()?;
        Ok(Self { aircraft, swept_ns })
    }
}

impl Aircraft {
    fn write(&self, to: &mut Writer) {
        to.i64(self.heard_ns);
        to.u8(self.version);
        write_heard(to, self.supplement_a, Writer::flag);
        write_heard(to, self.categories, |to, categories| {
            to.u8(categories.nac_p);
            to.u8(categories.sil);
        });
        write_heard(to, self.ground_speed_mps, Writer::f64);
        write_heard(to, self.ground_track_rad, Writer::f64);
        write_heard(to, self.geometric_less_pressure_m, Writer::f64);
        for half in self.halves {
            write_heard(to, half, |to, cpr| {
                to.flag(cpr.odd);
                to.u32(cpr.lat);
                to.u32(cpr.lon);
            });
        }
        to.option(self.placed, |to, placed| {
            to.f64(placed.fix.lat_deg);
            to.f64(placed.fix.lon_deg);
            to.i64(placed.at_ns);
            to.flag(placed.confirmed);
        });
    }

    fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        let (heard_ns, version) = (from.i64()?, from.u8()?);
        let supplement_a = read_heard(from, Reader::flag)?;
        let categories = read_heard(from, |from| Ok(Categories { nac_p: from.u8()?, sil: from.u8()? }))?;
        let mut number = || read_heard(from, Reader::f64);
        let (ground_speed_mps, ground_track_rad, geometric_less_pressure_m) = (number()?, number()?, number()?);
        let mut half = || read_heard(from, |from| Ok(Cpr { odd: from.flag()?, lat: from.u32()?, lon: from.u32()? }));
        let halves = [half()?, half()?];
        let placed = from.option(|from| {
            let fix = Fix { lat_deg: from.f64()?, lon_deg: from.f64()? };
            Ok(Placed { fix, at_ns: from.i64()?, confirmed: from.flag()? })
        })?;
        Ok(Self {
            heard_ns,
            version,
            supplement_a,
            categories,
            ground_speed_mps,
            ground_track_rad,
            geometric_less_pressure_m,
            halves,
            placed,
        })
    }
}

#[cfg(test)]
#[path = "squitters_tests.rs"]
mod tests;
