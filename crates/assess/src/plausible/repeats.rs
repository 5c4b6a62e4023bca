//! Is the position new?

use navbound_core::quantity::GpsTime;

use super::Report;

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
