//! Which times a record may have.

use crate::counters::Refused;
use crate::settings::Settings;
use navbound_core::quantity::GpsTime;

/// Whether a record's time is possible for its arrival. Where no arrival is known, every time is.
///
/// # Errors
/// Why not: later than its arrival, or older than records are kept.
pub(crate) fn admit(settings: &Settings, time: GpsTime, arrival: Option<GpsTime>) -> Result<(), Refused> {
    let Some(arrival) = arrival else { return Ok(()) };
    let ahead_ns = time.nanoseconds().saturating_sub(arrival.nanoseconds());
    if ahead_ns > settings.ahead_ns {
        return Err(Refused::FromTheFuture);
    }
    if ahead_ns < -settings.retention_ns {
        return Err(Refused::TooOld);
    }
    Ok(())
}
