//! GPS time, the one time scale inside.

/// An instant of GPS time: integer nanoseconds since 1980-01-06 00:00:00. No leap seconds; conversions live in `formats`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct GpsTime(i64);

impl GpsTime {
    /// Nanoseconds since the GPS epoch.
    pub const fn from_nanoseconds(ns: i64) -> Self {
        Self(ns)
    }
    /// Nanoseconds since the GPS epoch.
    pub const fn nanoseconds(self) -> i64 {
        self.0
    }
    /// The instant `seconds` later, to the nanosecond; beyond the representable times it stays at their end.
    pub const fn plus_seconds(self, seconds: f64) -> Self {
        Self(self.0.saturating_add((seconds * 1e9) as i64))
    }
    /// Seconds from `earlier` to here, negative when it is later. The division rounds once, so a difference of 7 900 000 000 ns is the
    /// number 7.9 and may be compared with a configured 7.9.
    pub const fn seconds_since(self, earlier: Self) -> f64 {
        self.0.saturating_sub(earlier.0) as f64 / 1e9
    }
}
