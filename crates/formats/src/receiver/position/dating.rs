//! Dates of sentences, and times of day near them.

use super::sentence::SECOND_NS;
use super::{Absent, OfDay, Position, Reason};
use crate::time::{Calendar, Scale, from_calendar, from_unix, to_calendar, to_unix};
use navbound_core::quantity::GpsTime;

const HALF_DAY_NS: i64 = 43_200 * SECOND_NS;
/// A clock of a receiver without a fix that is this far from that of its first fix was not set. Provenance: ours \[s\].
const UNSET_S: f64 = 600.0;
/// Minutes of a time of day count 61 seconds.
const MINUTE_NS: i64 = 61 * SECOND_NS;

/// A date, and the time of day that it was written with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Dated {
    /// Year.
    pub year: i32,
    /// Month, 1 to 12.
    pub month: u8,
    /// Day of the month, from 1.
    pub day: u8,
    /// Time of day.
    pub of_day: OfDay,
}

pub(super) fn dated((year, month, day): (i32, u8, u8), of_day_ns: i64) -> Option<Dated> {
    let noon = Calendar { year, month, day, hour: 12, minute: 0, nanoseconds: 0 };
    from_calendar(noon, Scale::Utc).map(|_| Dated { year, month, day, of_day: OfDay(of_day_ns) })
}

impl Position {
    /// A receiver that has had no fix yet counts from midnight, or from when it was switched off: where such a time is far from that of the
    /// first date behind it, nobody knows it.
    pub(super) fn forget_time_before(&mut self, record: u64, dated: Dated) {
        let without = self.record < record && self.absent.as_ref().is_some_and(|absent| absent.reason == Reason::NoFix);
        let Some(time) = self.time.filter(|_| without) else { return };
        let apart_s = gps_time(dated, dated.of_day.0).map_or(0.0, |of_date| of_date.seconds_since(time).abs());
        if apart_s > UNSET_S {
            self.time = None;
        }
    }

    /// Make a time of a time of day near a dated one; midnight may lie between them.
    pub(super) fn date(&mut self, dated: Dated) {
        let Some(OfDay(of_day_ns)) = self.of_day else { return };
        self.time = gps_time(dated, of_day_ns);
        if self.time.is_none() && self.absent.is_none() {
            let (minutes, second_s) = (of_day_ns / MINUTE_NS, (of_day_ns.rem_euclid(MINUTE_NS)) as f64 * 1e-9);
            let reason = if second_s >= 60.0 { Reason::NoSuchLeapSecond } else { Reason::OutsideDomain };
            let stated = format!("{:02}{:02}{second_s:05.2}", minutes / 60, minutes % 60);
            self.absent = Some(Absent { reason, stated });
        }
    }
}

fn gps_time(Dated { year, month, day, of_day: OfDay(dated_ns) }: Dated, of_day_ns: i64) -> Option<GpsTime> {
    let minutes = of_day_ns.div_euclid(MINUTE_NS);
    let nanoseconds = of_day_ns.rem_euclid(MINUTE_NS);
    let clock = Calendar { year, month, day, hour: (minutes / 60) as u8, minute: (minutes % 60) as u8, nanoseconds };
    let apart = (minutes - dated_ns.div_euclid(MINUTE_NS)) * 60 * SECOND_NS;
    let days = i64::from(apart < -HALF_DAY_NS) - i64::from(apart > HALF_DAY_NS);
    if days == 0 {
        return from_calendar(clock, Scale::Utc);
    }
    let noon = Calendar { hour: 12, minute: 0, nanoseconds: 0, ..clock };
    let date = to_calendar(from_unix(to_unix(from_calendar(noon, Scale::Utc)?) + days * 2 * HALF_DAY_NS))?;
    from_calendar(Calendar { year: date.year, month: date.month, day: date.day, ..clock }, Scale::Utc)
}
