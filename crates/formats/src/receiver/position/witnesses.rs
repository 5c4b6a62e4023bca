//! Sentences of another time than any GGA: what they say against the positions near them.

use super::epoch::{Message, all_of_kind};
use super::nmea::{GBS, GLL, GNS, GST, ONE_PLACE_M, RMC, apart_m, place};
use super::sentence::{SECOND_NS, Sentence, of_day};
use super::{OfDay, accuracy};
use navbound_core::quantity::KNOT_MPS;

/// The last position of a GGA.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Near {
    /// Latitude and longitude \[rad\].
    pub place: (f64, f64),
    /// When.
    pub of_day: OfDay,
}

/// Sentences further apart are compared with nothing. Provenance: ours \[s\].
const NEAR_S: f64 = 2.0;
/// Speed that a vehicle may have of which none is stated, and what is added to one that is. Provenance: ours \[m/s, 1, m/s\].
const FASTEST_MPS: f64 = 350.0;
const SHARE: f64 = 1.25;
const SLACK_MPS: f64 = 20.0;

/// What places without a GGA say against the last one before them.
pub(super) fn against(messages: &[Message], near: &Near) -> Option<String> {
    // Name, time, place.
    [("RMC", RMC, 1, 3), ("GLL", GLL, 5, 1), ("GNS", GNS, 1, 2)].into_iter().find_map(|(name, kind, time, at)| {
        all_of_kind(messages, kind).find_map(|message| {
            let sentence = Sentence(&message.body);
            let apart_s = apart_s(of_day(sentence.get(time)?)?, near.of_day);
            let speed = (kind == RMC).then(|| sentence.number(7)).flatten().map(|knots| SHARE * knots * KNOT_MPS + SLACK_MPS);
            let room_m = ONE_PLACE_M + sentence.resolution_m(at) + apart_s * speed.unwrap_or(FASTEST_MPS);
            let apart_m = apart_m(near.place, place(&sentence, at)?);
            let beyond = apart_s <= NEAR_S && apart_m > room_m;
            beyond.then(|| format!("position of {name} {apart_m:.0} m away, {apart_s:.2} s apart"))
        })
    })
}

/// The horizontal size of the worst accuracy beside which no position stands \[m\].
pub(super) fn loose_m(messages: &[Message]) -> Option<f64> {
    let all = |kind| all_of_kind(messages, kind).map(|message| Sentence(&message.body));
    let of = all(GST).filter_map(|gst| accuracy::covariance(&gst)).chain(all(GBS).filter_map(|gbs| accuracy::expected_errors(&gbs)));
    of.map(|[ee, _, nn, ..]| libm::sqrt(ee + nn)).reduce(f64::max)
}

/// Time between two times of day, the shorter way around the day \[s\].
fn apart_s(one: OfDay, other: OfDay) -> f64 {
    // A minute counts 61 seconds.
    let seconds = |OfDay(ns): OfDay| {
        let minute_ns = 61 * SECOND_NS;
        60.0 * ns.div_euclid(minute_ns) as f64 + ns.rem_euclid(minute_ns) as f64 * 1e-9
    };
    libm::fabs(libm::remainder(seconds(one) - seconds(other), 86_400.0))
}
