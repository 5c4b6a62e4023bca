//! Does the position go the way that the reported speed says, and is it new?

use std::collections::VecDeque;

use navbound_core::frame::EcefPosition;
use navbound_core::quantity::GpsTime;

use super::{Limits, Report, WINDOW_S};

/// Share of the way by the reported speed that a position must make good, over [`WAY_LATENCIES`]: one of the two latencies may be lost to a
/// position that is late. Provenance: ours.
const WAY_SHARE: f64 = 0.5;
/// Shortest time over which the way is judged, in latencies. Provenance: ours.
const WAY_LATENCIES: f64 = 2.0;
/// Shortest reported way that is judged, in noises. Provenance: ours: half of it less one noise is one noise, so that a stand is seen.
const WAY_NOISES: f64 = 4.0;
/// Shortest time between two places of the way \[s\], so that noise at a high rate does not add up to a flight.
const PLACE_S: f64 = 1.0;

/// A place on the way, with what was flown up to it.
#[derive(Debug, Clone, Copy)]
struct Place {
    time: GpsTime,
    at: EcefPosition,
    speed_mps: f64,
    /// Sum of the distances between the places \[m\].
    moved_m: f64,
    /// The same by the reported speeds \[m\].
    reported_m: f64,
}

/// The way since the aircraft says that it moves. Lengths, not displacements: a turn goes as far as a straight flight.
#[derive(Debug, Clone, Default)]
pub(super) struct Way {
    places: VecDeque<Place>,
}

impl Way {
    /// For how long the positions up to this one have fallen behind the reported speed \[s\].
    pub(super) fn is_behind(&mut self, report: &Report, here: &EcefPosition, limits: &Limits) -> Option<f64> {
        if !(report.speed_mps > limits.moving_mps) {
            self.places.clear();
            return None;
        }
        let mut place = Place { time: report.time, at: *here, speed_mps: report.speed_mps, moved_m: 0.0, reported_m: 0.0 };
        let Some(last) = self.places.back().copied() else {
            self.places.push_back(place);
            return None;
        };
        let elapsed_s = report.time.seconds_since(last.time);
        if !(0.0..=WINDOW_S).contains(&elapsed_s) {
            // The straight line over a long silence is not the way.
            self.places.clear();
            self.places.push_back(place);
            return None;
        }
        place.moved_m = last.moved_m + here.minus(&last.at).vector().norm();
        place.reported_m = last.reported_m + elapsed_s * last.speed_mps.min(report.speed_mps);
        if elapsed_s >= PLACE_S {
            self.places.push_back(place);
        }
        self.judge(&place, limits)
    }

    /// From the latest place that lies far enough back; those before it are no longer needed.
    fn judge(&mut self, here: &Place, limits: &Limits) -> Option<f64> {
        let far = |from: &Place| {
            let elapsed_s = here.time.seconds_since(from.time);
            here.reported_m - from.reported_m >= WAY_NOISES * limits.noise_m && elapsed_s >= WAY_LATENCIES * limits.latency_s
        };
        while self.places.get(1).is_some_and(far) {
            self.places.pop_front();
        }
        let from = self.places.front().copied().filter(far)?;
        let behind = here.moved_m - from.moved_m < WAY_SHARE * (here.reported_m - from.reported_m) - limits.noise_m;
        behind.then(|| here.time.seconds_since(from.time))
    }
}

/// Different positions that are remembered. Provenance: ours.
const REMEMBERED: usize = 2;

/// The last different positions, by their bits, and when each was first seen.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Repeats {
    seen: [Option<(f64, f64, GpsTime)>; REMEMBERED],
}

impl Repeats {
    /// Since when this position is known.
    pub(super) fn since(&mut self, report: &Report) -> GpsTime {
        let known = self.seen.iter().flatten().find(|(lat, lon, _)| *lat == report.lat_rad && *lon == report.lon_rad);
        if let Some((_, _, since)) = known {
            return *since;
        }
        self.seen.rotate_left(1);
        self.seen[REMEMBERED - 1] = Some((report.lat_rad, report.lon_rad, report.time));
        report.time
    }
}
