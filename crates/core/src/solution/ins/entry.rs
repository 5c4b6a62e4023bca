//! What comes twice, or under the name of another: a measurement counts once.
//!
//! ```text
//! time not after the last of its source by a millisecond      the same values: a repeat; others: two sources under one name
//! the same values at a later time                             a repeat: of a satellite always, of a solved position within 1.5 periods,
//!                                                             and for as long as the vehicle is known to move
//! ```
//!
//! A range grows or shrinks by hundreds of metres a second and is never the same to the bit twice. A solved position may be, at rest and
//! written with few decimals. Ranges to stations, bearings and heights are quantised by their instruments: only their time is compared.
//! Provenance: ours.

use super::innovation::Kind;
use crate::quantity::GpsTime;
use crate::signal::{Aiding, TimedAiding};

/// Why a measurement was not used before any gate looked at it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Refusal {
    /// The same measurement again.
    Repeated,
    /// Another measurement of the same source and instant: several sources under one name.
    SameName,
    /// A number that is none, or that no sensor delivers.
    OutOfRange,
    /// Not of the time of the inertial samples.
    Late,
    /// All places for further states are taken.
    NoPlace,
    /// The ranges of the instant determine no position (the loose form).
    NoPosition,
    /// The filter has stopped.
    Stopped,
}

impl Refusal {
    /// Every reason, in the order of [`Refusal::index`].
    pub const ALL: [Self; 7] =
        [Self::Repeated, Self::SameName, Self::OutOfRange, Self::Late, Self::NoPlace, Self::NoPosition, Self::Stopped];

    /// Position in [`Refusal::ALL`].
    pub const fn index(self) -> usize {
        self as usize
    }
    /// The id of tables.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Repeated => "repeated",
            Self::SameName => "same_name",
            Self::OutOfRange => "out_of_range",
            Self::Late => "late",
            Self::NoPlace => "no_place",
            Self::NoPosition => "no_position",
            Self::Stopped => "stopped",
        }
    }
}

/// Sources that are remembered; the one heard first makes room for another.
const SOURCES: usize = 96;
/// Time tags of one instant may differ by rounding \[s\].
const INSTANT_S: f64 = 1e-3;
/// Periods within which the same position is a repeat: the next one is due after one.
const PERIODS: f64 = 1.5;
/// Period of solved positions before two have come \[s\].
const USUAL_PERIOD_S: f64 = 1.0;
/// Speed over the ground at which two positions in a row differ, whatever their decimals \[m/s\].
const MOVING_MPS: f64 = 5.0;

/// The last measurement of a source.
#[derive(Debug, Clone, Copy)]
struct Heard {
    source: u64,
    time: GpsTime,
    values: [u64; 3],
    /// When these values came first, and how long after the values before them.
    fresh: GpsTime,
    period_s: f64,
}

/// The memory of what has come, and what was not let in.
#[derive(Debug, Clone)]
pub(super) struct Entry {
    heard: [Option<Heard>; SOURCES],
    n: usize,
    counts: [u64; Refusal::ALL.len()],
}

impl Entry {
    pub(super) const fn new() -> Self {
        Self { heard: [None; SOURCES], n: 0, counts: [0; Refusal::ALL.len()] }
    }

    /// The same memory, for a filter that begins anew and counts for itself.
    pub(super) fn uncounted(&self) -> Self {
        Self { counts: [0; Refusal::ALL.len()], ..self.clone() }
    }

    pub(super) fn count(&mut self, why: Refusal) {
        self.counts[why.index()] += 1;
    }

    pub(super) const fn counts(&self) -> &[u64; Refusal::ALL.len()] {
        &self.counts
    }

    /// Whether a measurement is new. `speed_mps` is the least that the vehicle moves over the ground with, as far as is known.
    pub(super) fn admit(&mut self, timed: &TimedAiding, speed_mps: f64) -> Result<(), Refusal> {
        let (source, values) = identity(&timed.aiding);
        let place = self.place(source);
        let Some(heard) = &mut self.heard[place] else {
            let (time, period_s) = (timed.time, USUAL_PERIOD_S);
            self.heard[place] = Some(Heard { source, time, values, fresh: time, period_s });
            return Ok(());
        };
        let (same, since_s) = (heard.values == values, timed.time.seconds_since(heard.time));
        if !(since_s > INSTANT_S) {
            return Err(match same {
                true => Refusal::Repeated,
                false if since_s >= -INSTANT_S => Refusal::SameName,
                false => Refusal::Late,
            });
        }
        let fresh_s = timed.time.seconds_since(heard.fresh);
        let repeated = match timed.aiding {
            Aiding::Satellite(_) => same,
            Aiding::Fix(_) => same && (fresh_s <= PERIODS * heard.period_s || speed_mps > MOVING_MPS),
            Aiding::Dme(_) | Aiding::Vor(_) | Aiding::Baro(_) => false,
        };
        if repeated {
            return Err(Refusal::Repeated);
        }
        heard.time = timed.time;
        if !same {
            (heard.period_s, heard.fresh, heard.values) = (fresh_s, timed.time, values);
        }
        Ok(())
    }

    fn place(&mut self, source: u64) -> usize {
        let known = self.heard.iter().position(|h| h.is_some_and(|h| h.source == source));
        known.unwrap_or_else(|| {
            let next = self.n % SOURCES;
            self.n += 1;
            self.heard[next] = None;
            next
        })
    }
}

/// Where a measurement comes from, and the bits of what it says.
fn identity(aiding: &Aiding) -> (u64, [u64; 3]) {
    let source = |number: u64| ((Kind::of(aiding).index() as u64) << 32) | number;
    let bits = |x: f64| x.to_bits();
    match aiding {
        Aiding::Satellite(m) => {
            let number = ((m.satellite.constellation.index() as u64) << 8) | u64::from(m.satellite.number);
            let rate = m.rate_mps.map_or(f64::NAN, |(rate, _)| rate);
            (source(number), [m.range.map_or(0, |r| bits(r.m())), bits(rate), 0])
        }
        Aiding::Dme(m) => (source(m.station.into()), [bits(m.slant.m()), 0, 0]),
        Aiding::Vor(m) => (source(m.station.into()), [bits(m.bearing.rad()), 0, 0]),
        Aiding::Baro(m) => (source(0), [bits(m.height.m()), 0, 0]),
        Aiding::Fix(m) => {
            let point = m.position.point;
            (source(0), [bits(point.lat().rad()), bits(point.lon().rad()), bits(m.position.height.m())])
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::{Covariance, Geodetic, LatLon};
    use crate::quantity::{Metres, Radians};
    use crate::signal::{BaroHeight, PositionFix};

    fn fix(at_s: f64, lat_rad: f64) -> TimedAiding {
        let point = LatLon::new(Radians::new(lat_rad), Radians::new(0.1)).unwrap();
        let position = Geodetic { point, height: Metres::new(100.0) };
        let covariance = Covariance::from_upper([1.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
        let aiding = Aiding::Fix(PositionFix { position, covariance, velocity_ned_mps: None, level_m: None });
        TimedAiding { time: GpsTime::default().plus_seconds(at_s), aiding }
    }

    fn baro(at_s: f64, height_m: f64) -> TimedAiding {
        let one = Metres::new(1.0);
        let m = BaroHeight { height: Metres::new(height_m), sigma_white: one, sigma_bias: one, correlation_time_s: 60.0 };
        TimedAiding { time: GpsTime::default().plus_seconds(at_s), aiding: Aiding::Baro(m) }
    }

    #[test]
    fn a_measurement_comes_in_once() {
        let mut entry = Entry::new();
        assert_eq!(entry.admit(&fix(0.0, 0.7), 0.0), Ok(()));
        assert_eq!(entry.admit(&fix(0.0, 0.7), 0.0), Err(Refusal::Repeated));
        assert_eq!(entry.admit(&fix(1e-9, 0.8), 0.0), Err(Refusal::SameName));
        assert_eq!(entry.admit(&fix(-0.5, 0.8), 0.0), Err(Refusal::Late));
        assert_eq!(entry.admit(&fix(1.0, 0.7), 0.0), Err(Refusal::Repeated), "another time tag makes nothing new of it");
    }

    #[test]
    fn a_position_that_stands_still_is_heard_again_and_one_that_should_move_is_not() {
        let mut entry = Entry::new();
        for (at, lat) in [(0.0, 0.7), (1.0, 0.8)] {
            assert_eq!(entry.admit(&fix(at, lat), 0.0), Ok(()));
        }
        assert_eq!(entry.admit(&fix(2.0, 0.8), 0.0), Err(Refusal::Repeated));
        assert_eq!(entry.admit(&fix(3.0, 0.8), 0.0), Ok(()));
        assert_eq!(entry.admit(&fix(9.0, 0.8), 6.0), Err(Refusal::Repeated), "frozen");
        assert_eq!(entry.admit(&fix(10.0, 0.9), 6.0), Ok(()));
    }

    #[test]
    fn an_instrument_in_steps_may_say_the_same_again() {
        let mut entry = Entry::new();
        assert_eq!(entry.admit(&baro(0.0, 300.0), 0.0), Ok(()));
        assert_eq!(entry.admit(&baro(1.0, 300.0), 0.0), Ok(()));
        assert_eq!(entry.admit(&baro(1.0, 300.0), 0.0), Err(Refusal::Repeated));
    }

    #[test]
    fn more_sources_than_places_are_heard_and_the_first_is_forgotten() {
        let mut entry = Entry::new();
        assert_eq!(entry.admit(&fix(0.0, 0.7), 0.0), Ok(()));
        (0..SOURCES).for_each(|k| {
            let source = entry.place(k as u64 + (1 << 40));
            entry.heard[source] = Some(Heard { source: k as u64 + (1 << 40), ..entry.heard[0].unwrap_or_else(none) });
        });
        assert_eq!(entry.admit(&fix(0.0, 0.7), 0.0), Ok(()));
    }

    fn none() -> Heard {
        let time = GpsTime::default();
        Heard { source: 0, time, values: [0; 3], fresh: time, period_s: 1.0 }
    }
}
