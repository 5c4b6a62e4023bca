//! Whether the way that speeds say is travelled at last: what holds and slow lags take away from it is within every limit of its own.
//!
//! The rule of recordings, whose reader has the same numbers from here: over the straight minutes of a track that is fast, its positions may
//! lack five kilometres and a fiftieth of the way by its speeds.

use crate::codec::{Damaged, Reader, Writer};
use navbound_core::monitor::neighbours::east_north_m;

/// Slower aircraft turn more tightly than the legs of a way follow. Provenance: ours \[m/s\].
pub const FAST_MPS: f64 = 80.0;
/// Share of a way that lies between its ends where it is straight. Provenance: ours \[1\].
pub const STRAIGHT: f64 = 0.98;
/// What the way of the positions of a track may lack in all. Provenance: ours \[m\].
pub const LACK_M: f64 = 5000.0;
/// The share of the way by its speeds that it may lack more: a turn of three degrees a second shortens legs by one in a hundred. Provenance:
/// ours \[1\].
pub const LACK_SHARE: f64 = 0.02;
/// Length of a window \[ns\].
const WINDOW_NS: i64 = 60_000_000_000;
/// Longest step that a way goes on over \[ns\].
const LONGEST_NS: i64 = 10_000_000_000;

/// A place of a track that is believed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct At {
    pub(crate) time_ns: i64,
    pub(crate) lat_rad: f64,
    pub(crate) lon_rad: f64,
    pub(crate) speed_mps: f64,
}

impl At {
    fn apart_m(self, other: Self) -> f64 {
        let [east, north] = east_north_m([self.lat_rad, self.lon_rad], [other.lat_rad, other.lon_rad]);
        libm::hypot(east, north)
    }
}

/// The ways of one track.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Balance {
    /// Where the window began.
    begin: Option<At>,
    last: Option<At>,
    /// Of the window: by the positions, and by the speeds \[m\].
    of_window: [f64; 2],
    /// Of all windows that count.
    of_all: [f64; 2],
}

impl Balance {
    /// The next place; whether the positions are behind.
    pub(crate) fn see(&mut self, at: At) -> bool {
        let step_ns = self.last.map(|last| at.time_ns.saturating_sub(last.time_ns));
        if !at.speed_mps.is_finite() || step_ns.is_none_or(|step| step > LONGEST_NS) {
            let begin = Some(at).filter(|at| at.speed_mps.is_finite());
            (self.begin, self.last, self.of_window) = (begin, begin, [0.0; 2]);
            return self.behind();
        }
        let (Some(begin), Some(last), Some(step_ns @ 1..)) = (self.begin, self.last, step_ns) else { return self.behind() };
        self.of_window[0] += last.apart_m(at);
        self.of_window[1] += 0.5 * (last.speed_mps + at.speed_mps) * step_ns as f64 * 1e-9;
        self.last = Some(at);
        let length_ns = at.time_ns.saturating_sub(begin.time_ns);
        if length_ns >= WINDOW_NS {
            let [way_m, by_speed_m] = self.of_window;
            if by_speed_m >= FAST_MPS * length_ns as f64 * 1e-9 && begin.apart_m(at) >= STRAIGHT * way_m {
                self.of_all = [self.of_all[0] + way_m, self.of_all[1] + by_speed_m];
            }
            (self.begin, self.of_window) = (Some(at), [0.0; 2]);
        }
        self.behind()
    }

    /// Whether the positions are behind, by all that was seen.
    pub(crate) fn behind(&self) -> bool {
        let [way_m, by_speed_m] = self.of_all;
        by_speed_m - way_m > LACK_M + LACK_SHARE * by_speed_m
    }

    pub(crate) fn write(&self, to: &mut Writer) {
        for place in [self.begin, self.last] {
            to.option(place, |to, at| {
                to.i64(at.time_ns);
                [at.lat_rad, at.lon_rad, at.speed_mps].into_iter().for_each(|number| to.f64(number));
            });
        }
        self.of_window.into_iter().chain(self.of_all).for_each(|number| to.f64(number));
    }

    pub(crate) fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        let place =
            |from: &mut Reader<'_>| Ok(At { time_ns: from.i64()?, lat_rad: from.f64()?, lon_rad: from.f64()?, speed_mps: from.f64()? });
        let (begin, last) = (from.option(place)?, from.option(place)?);
        Ok(Self { begin, last, of_window: [from.f64()?, from.f64()?], of_all: [from.f64()?, from.f64()?] })
    }
}
