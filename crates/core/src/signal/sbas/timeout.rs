//! How long data may be used (RTCA DO-229D, table of data broadcast intervals and time-outs; provenance *standard*, stated from knowledge
//! of the table, confirmed by recorded messages only where `docs/methods/sbas.md` says so).

use crate::quantity::GpsTime;

/// What the data are used for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Use {
    /// LNAV/VNAV, LP, LPV approaches.
    PrecisionApproach,
    /// En route, terminal, non-precision approach.
    EnRoute,
}

/// Seconds before data are too old: (precision approach, en route).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TimeOut(pub u32, pub u32);

impl TimeOut {
    /// Seconds in one use.
    pub const fn seconds(self, used_for: Use) -> u32 {
        match used_for {
            Use::PrecisionApproach => self.0,
            Use::EnRoute => self.1,
        }
    }
    /// Whether data whose message ended at `received` are still good.
    pub fn alive(self, used_for: Use, received: GpsTime, now: GpsTime) -> bool {
        within(received, now, self.seconds(used_for))
    }
}

/// Whether `now` is not later than so many seconds after `received`.
pub(super) fn within(received: GpsTime, now: GpsTime, seconds: u32) -> bool {
    let age = now.nanoseconds().saturating_sub(received.nanoseconds());
    age >= 0 && age <= i64::from(seconds) * 1_000_000_000
}

/// PRN mask, message 1.
pub const PRN_MASK: TimeOut = TimeOut(600, 600);
/// UDRE indicators, messages 2 to 6 and 24.
pub const UDRE: TimeOut = TimeOut(12, 18);
/// Long-term corrections, messages 24 and 25.
pub const LONG_TERM: TimeOut = TimeOut(240, 360);
/// Orbit of the geostationary satellite, message 9.
pub const GEO_NAVIGATION: TimeOut = TimeOut(240, 360);
/// Fast-correction degradation, message 7.
pub const FAST_DEGRADATION: TimeOut = TimeOut(240, 360);
/// Degradation parameters, message 10.
pub const DEGRADATION: TimeOut = TimeOut(240, 360);
/// Grid masks, message 18.
pub const GRID_MASK: TimeOut = TimeOut(1200, 1200);
/// Grid delays, message 26.
pub const GRID: TimeOut = TimeOut(600, 600);
/// Service regions, message 27.
pub const REGIONS: TimeOut = TimeOut(86_400, 86_400);
/// Clock-ephemeris covariance, message 28.
pub const COVARIANCE: TimeOut = TimeOut(240, 360);
/// A message can be used this long after its end: the signal's way from the geostationary satellite \[ns\].
pub const WAY_NS: i64 = 120_000_000;
/// Without any valid message for this long every UDRE indicator is too old for LNAV/VNAV, LP and LPV \[ns\] (DO-229D 2.1.1.4.9;
/// standard, as a public program's source quotes it). En route nothing follows from silence alone.
pub const SILENCE_NS: i64 = 4_000_000_000;
/// A satellite that sent message 0 is left alone this long \[s\].
pub const DO_NOT_USE_S: u32 = 60;
/// A range rate is dropped this many of its own intervals after the correction it starts from.
pub const RANGE_RATE_INTERVALS: f64 = 8.0;

/// Degradation factor \[m/s²\] and time-out of fast corrections by the indicator of message 7.
pub const FAST: [(f64, TimeOut); 16] = [
    (0.000_00, TimeOut(120, 180)),
    (0.000_05, TimeOut(120, 180)),
    (0.000_09, TimeOut(102, 153)),
    (0.000_12, TimeOut(90, 135)),
    (0.000_15, TimeOut(90, 135)),
    (0.000_20, TimeOut(78, 117)),
    (0.000_30, TimeOut(66, 99)),
    (0.000_45, TimeOut(54, 81)),
    (0.000_60, TimeOut(42, 63)),
    (0.000_90, TimeOut(30, 45)),
    (0.001_50, TimeOut(30, 45)),
    (0.002_10, TimeOut(18, 27)),
    (0.002_70, TimeOut(18, 27)),
    (0.003_30, TimeOut(18, 27)),
    (0.004_60, TimeOut(12, 18)),
    (0.005_80, TimeOut(12, 18)),
];
