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
    /// Seconds from `earlier` to here, negative when it is later.
    pub const fn seconds_since(self, earlier: Self) -> f64 {
        (self.0 - earlier.0) as f64 * 1e-9
    }
}
