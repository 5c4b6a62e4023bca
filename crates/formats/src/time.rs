//! Other time scales to GPS time: the one place that knows leap seconds.

use hifitime::{Duration, Epoch, TimeScale};
use navbound_core::quantity::GpsTime;

/// Nanoseconds of one GPS week.
const WEEK_NS: i64 = 604_800_000_000_000;
/// Japan standard time, which RTKLIB writes on request, is UTC plus nine hours.
const JST_OFFSET_NS: i64 = 9 * 3_600 * 1_000_000_000;

/// BeiDou time began at 2006-01-01 00:00:00 UTC, when GPS time led UTC by 14 s, and has no leap seconds either.
const BEIDOU_BEHIND_NS: i64 = 14 * 1_000_000_000;

/// The scale a calendar date is written in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// GPS time.
    Gps,
    /// Coordinated universal time.
    Utc,
    /// Japan standard time.
    Jst,
    /// BeiDou time, 14 s behind GPS time.
    BeiDou,
}

/// A calendar date and time of day.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Calendar {
    /// Year, e.g. 2023.
    pub year: i32,
    /// Month, 1 to 12.
    pub month: u8,
    /// Day of the month, from 1.
    pub day: u8,
    /// Hour, 0 to 23.
    pub hour: u8,
    /// Minute, 0 to 59.
    pub minute: u8,
    /// Nanoseconds within the minute (a leap second has 60e9 and more).
    pub nanoseconds: i64,
}

/// GPS time of a Unix time \[ns\] (UTC since 1970-01-01, leap seconds not counted).
pub fn from_unix(ns: i64) -> GpsTime {
    gps(Epoch::from_unix_duration(Duration::from_truncated_nanoseconds(ns)))
}

/// Unix time \[ns\] of a GPS time.
pub fn to_unix(time: GpsTime) -> i64 {
    let epoch = Epoch::from_gpst_duration(Duration::from_truncated_nanoseconds(time.nanoseconds()));
    truncated(epoch.to_unix_duration())
}

/// GPS time of a GPS week number (since 1980, not modulo 1024) and time of week \[ns\].
pub fn from_week(week: i64, time_of_week_ns: i64) -> Option<GpsTime> {
    week.checked_mul(WEEK_NS)?.checked_add(time_of_week_ns).map(GpsTime::from_nanoseconds)
}

/// GPS time of a calendar date in `scale`; `None` where there is no such date.
pub fn from_calendar(c: Calendar, scale: Scale) -> Option<GpsTime> {
    // Only UTC, and what is a fixed time ahead of it, has leap seconds.
    let (hifitime_scale, minute_ns) = match scale {
        Scale::Gps | Scale::BeiDou => (TimeScale::GPST, 60_000_000_000),
        Scale::Utc | Scale::Jst => (TimeScale::UTC, 61_000_000_000),
    };
    let clock = c.hour < 24 && c.minute < 60 && (0..minute_ns).contains(&c.nanoseconds);
    if !((1980..=2100).contains(&c.year) && clock) {
        return None;
    }
    let minute = Epoch::maybe_from_gregorian(c.year, c.month, c.day, c.hour, c.minute, 0, 0, hifitime_scale).ok()?;
    let unix = truncated(minute.to_unix_duration());
    match scale {
        Scale::Gps => Some(plus(gps(minute), c.nanoseconds)),
        Scale::BeiDou => Some(plus(gps(minute), c.nanoseconds + BEIDOU_BEHIND_NS)),
        Scale::Utc => within_minute(unix, c.nanoseconds),
        // The leap second comes at 09:00 there: what counts is the minute of UTC.
        Scale::Jst => within_minute(unix - JST_OFFSET_NS, c.nanoseconds),
    }
}

/// The instant `ns` after the start of a minute of UTC; its sixty-first second exists only where a leap second was inserted.
fn within_minute(unix_ns: i64, ns: i64) -> Option<GpsTime> {
    const LAST_NS: i64 = 59_000_000_000;
    if ns < LAST_NS + 1_000_000_000 {
        Some(plus(from_unix(unix_ns), ns))
    } else {
        leap_second_after(unix_ns + LAST_NS).map(|t| plus(t, ns - LAST_NS - 1_000_000_000))
    }
}

fn plus(time: GpsTime, ns: i64) -> GpsTime {
    GpsTime::from_nanoseconds(time.nanoseconds() + ns)
}

/// GPS time of the second that Unix time does not count, `ns` after the second before it: 23:59:60 is one second after 23:59:59. `None`
/// where no leap second follows the one given.
pub fn leap_second_after(unix_ns: i64) -> Option<GpsTime> {
    const SECOND_NS: i64 = 1_000_000_000;
    let whole = unix_ns.div_euclid(SECOND_NS) * SECOND_NS;
    let step = from_unix(whole.checked_add(SECOND_NS)?).nanoseconds() - from_unix(whole).nanoseconds();
    (step > SECOND_NS).then(|| plus(from_unix(unix_ns), SECOND_NS))
}

/// Calendar date of a GPS time, in GPS time; `None` outside 1980 to 2100.
pub fn to_calendar(time: GpsTime) -> Option<Calendar> {
    let epoch = Epoch::from_gpst_duration(Duration::from_truncated_nanoseconds(time.nanoseconds()));
    let (year, month, day, hour, minute, second, nanoseconds) = epoch.to_gregorian(TimeScale::GPST);
    let nanoseconds = i64::from(second) * 1_000_000_000 + i64::from(nanoseconds);
    (1980..=2100).contains(&year).then_some(Calendar { year, month, day, hour, minute, nanoseconds })
}

fn gps(epoch: Epoch) -> GpsTime {
    GpsTime::from_nanoseconds(truncated(epoch.to_gpst_duration()))
}

/// Nanoseconds, saturating at the ends of the representable range (292 years either side).
fn truncated(duration: Duration) -> i64 {
    duration.truncated_nanoseconds()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// GPS minus UTC as the IERS bulletins C give it: the day a leap second took effect and the difference from then on.
    #[test]
    fn gps_time_leads_utc_by_the_leap_seconds_of_the_day() {
        for (unix_s, leap_s) in [
            (315_964_800_i64, 0_i64), // 1980-01-06
            (1_136_073_599, 13),      // 2005-12-31T23:59:59
            (1_136_073_600, 14),      // 2006-01-01
            (1_483_228_799, 17),      // 2016-12-31T23:59:59
            (1_483_228_800, 18),      // 2017-01-01
            (1_633_608_773, 18),      // 2021-10-07
        ] {
            let expected = (unix_s - 315_964_800 + leap_s) * 1_000_000_000;
            assert_eq!(from_unix(unix_s * 1_000_000_000).nanoseconds(), expected, "Unix time {unix_s} s");
        }
    }

    #[test]
    fn unix_time_comes_back() {
        for ns in [315_964_800_000_000_001_i64, 1_633_608_773_123_456_789] {
            assert_eq!(to_unix(from_unix(ns)), ns);
        }
    }

    /// Week and time of week of the shipped RTKLIB file: 2023-07-11 06:04:30 GPST is week 2270, 194670 s.
    #[test]
    fn calendar_week_and_utc_agree() {
        let c = Calendar { year: 2023, month: 7, day: 11, hour: 6, minute: 4, nanoseconds: 30_000_000_000 };
        let gps = from_calendar(c, Scale::Gps);
        assert_eq!(gps, from_week(2270, 194_670_000_000_000));
        let utc = Calendar { nanoseconds: 12_000_000_000, ..c };
        assert_eq!(from_calendar(utc, Scale::Utc), gps);
        assert_eq!(from_calendar(Calendar { hour: 15, ..utc }, Scale::Jst), gps);
    }

    /// BDS-SIS-ICD: BDT week 0 begins at 2006-01-01 00:00:00 UTC.
    #[test]
    fn beidou_time_begins_with_2006_in_utc() {
        let c = Calendar { year: 2006, month: 1, day: 1, hour: 0, minute: 0, nanoseconds: 0 };
        assert_eq!(from_calendar(c, Scale::BeiDou), from_calendar(c, Scale::Utc));
    }

    #[test]
    fn dates_of_gps_times_are_those_they_came_from() {
        let c = Calendar { year: 2016, month: 12, day: 31, hour: 23, minute: 59, nanoseconds: 59_000_000_001 };
        let time = from_calendar(c, Scale::Gps).unwrap();
        assert_eq!(to_calendar(time), Some(c));
        // GPS time knows no leap second: a second and a day later it is 2017-01-02.
        let next = to_calendar(time.plus_seconds(86_401.0)).unwrap();
        assert_eq!((next.year, next.month, next.day, next.nanoseconds), (2017, 1, 2, 1));
        assert_eq!(to_calendar(GpsTime::from_nanoseconds(i64::MAX)), None);
    }

    /// IERS bulletin C 52: 2016-12-31 had a second 23:59:60; 2021-12-31 had none.
    #[test]
    fn a_leap_second_is_an_instant_of_its_own_and_exists_only_where_there_was_one() {
        let c = Calendar { year: 2016, month: 12, day: 31, hour: 23, minute: 59, nanoseconds: 59_500_000_000 };
        let at = |c: Calendar| from_calendar(c, Scale::Utc).map(|t| t.nanoseconds());
        let before = at(c).unwrap();
        let leap = at(Calendar { nanoseconds: 60_500_000_000, ..c }).unwrap();
        let after = at(Calendar { year: 2017, month: 1, day: 1, hour: 0, minute: 0, nanoseconds: 500_000_000 }).unwrap();
        assert_eq!([leap - before, after - leap], [1_000_000_000; 2]);
        assert_eq!(at(Calendar { year: 2021, nanoseconds: 60_500_000_000, ..c }), None);
        let jst = Calendar { year: 2017, month: 1, day: 1, hour: 8, minute: 59, nanoseconds: 60_500_000_000 };
        assert_eq!(from_calendar(jst, Scale::Jst).map(|t| t.nanoseconds()), Some(leap));
        // Nine hours before midnight in Japan: still without the second that comes at nine.
        let early = Calendar { hour: 8, nanoseconds: 59_500_000_000, ..jst };
        assert_eq!(from_calendar(early, Scale::Jst).map(|t| t.nanoseconds()), Some(before));
        assert_eq!(leap_second_after(1_483_228_799_500_000_000).map(|t| t.nanoseconds()), Some(leap));
        assert_eq!(leap_second_after(1_483_228_798_500_000_000), None);
        assert_eq!(leap_second_after(1_483_228_800_500_000_000), None);
    }

    #[test]
    fn dates_that_do_not_exist_are_refused() {
        let good = Calendar { year: 2023, month: 2, day: 28, hour: 0, minute: 0, nanoseconds: 0 };
        assert!(from_calendar(good, Scale::Gps).is_some());
        for bad in [
            Calendar { day: 29, ..good },
            Calendar { month: 13, ..good },
            Calendar { hour: 24, ..good },
            Calendar { minute: 60, ..good },
            Calendar { year: 1970, ..good },
            Calendar { nanoseconds: 61_000_000_000, ..good },
        ] {
            assert_eq!(from_calendar(bad, Scale::Gps), None, "{bad:?}");
        }
    }
}
