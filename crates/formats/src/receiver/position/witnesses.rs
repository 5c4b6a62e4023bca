//! Sentences of another time than any GGA: what they say against the positions near them.

use super::epoch::{Message, all_of_kind};
use super::nmea::{GBS, GLL, GNS, GST, ONE_PLACE_M, PUBX, RMC, apart_m, no_fix, place};
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

/// Sentences further apart are compared with nothing, and of those further apart than the second the speed then says nothing. Provenance:
/// ours \[s\].
const NEAR_S: f64 = 30.0;
const SAME_SPEED_S: f64 = 2.0;
/// How old a place of another receiver may be. Provenance: ours \[s\].
const LATE_S: f64 = 1.0;
/// Speed that a vehicle may have of which none is stated, and what is added to one that is. Provenance: ours \[m/s, 1, m/s\].
const FASTEST_MPS: f64 = 350.0;
const SHARE: f64 = 1.25;
const SLACK_MPS: f64 = 20.0;

/// What places without a GGA say against the last one before them.
pub(super) fn against(messages: &[Message], near: &Near) -> Option<String> {
    // Name, time, place.
    [("RMC", RMC, 1, 3), ("GLL", GLL, 5, 1), ("GNS", GNS, 1, 2), ("PUBX", PUBX, 2, 3)].into_iter().find_map(|(name, kind, time, at)| {
        all_of_kind(messages, kind).find_map(|message| {
            let sentence = Sentence(&message.body);
            let apart_s = apart_s(of_day(sentence.get(time)?)?, near.of_day);
            let knots = (kind == RMC && apart_s <= SAME_SPEED_S).then(|| sentence.number(7)).flatten();
            let beyond_m = beyond_m(&sentence, at, near, apart_s, knots.map(|knots| SHARE * knots * KNOT_MPS + SLACK_MPS));
            let far = beyond_m.filter(|_| apart_s <= NEAR_S).map(|m| format!("position of {name} {m:.0} m away, {apart_s:.2} s apart"));
            far.or_else(|| Some(format!("PUBX fix {}", String::from_utf8_lossy(no_fix(&sentence).filter(|_| kind == PUBX)?))))
        })
    })
}

/// What a place of no stated time says against the last one before it.
pub(super) fn untimed(name: &str, sentence: &Sentence<'_>, at: usize, near: &Near) -> Option<String> {
    beyond_m(sentence, at, near, SAME_SPEED_S, None).map(|m| format!("position of {name} without a time {m:.0} m away"))
}

/// How far away a place is, where that is further than a vehicle goes in such a time; its speed is any that a vehicle has where none is stated.
fn beyond_m(sentence: &Sentence<'_>, at: usize, near: &Near, apart_s: f64, speed_mps: Option<f64>) -> Option<f64> {
    let room_m = ONE_PLACE_M + sentence.resolution_m(at) + (apart_s + LATE_S) * speed_mps.unwrap_or(FASTEST_MPS);
    Some(apart_m(near.place, place(sentence, at)?)).filter(|apart_m| *apart_m > room_m)
}

/// The horizontal size of the worst accuracy beside which no position stands \[m\].
pub(super) fn loose_m(messages: &[Message]) -> Option<f64> {
    let all = |kind| all_of_kind(messages, kind).map(|message| Sentence(&message.body));
    let of = all(GST).filter_map(|gst| accuracy::covariance(&gst)).chain(all(GBS).filter_map(|gbs| accuracy::expected_errors(&gbs)));
    let of = of.chain(all(PUBX).filter_map(|pubx| accuracy::circle(&pubx)));
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
