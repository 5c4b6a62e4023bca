use super::super::{Block, decode};
use super::*;
use crate::signal::sbas::{Ignored, Message, timeout};

/// Bits of a message under construction.
struct Draft([u8; 32]);

impl Draft {
    fn new(kind: u32) -> Self {
        Self([0; 32]).set(0, 8, 0x53).set(8, 6, kind)
    }
    fn set(mut self, first: usize, bits: usize, value: u32) -> Self {
        for i in 0..bits {
            let bit = first + i;
            let mask = 0x80_u8 >> (bit % 8);
            if value >> (bits - 1 - i) & 1 == 1 { self.0[bit / 8] |= mask } else { self.0[bit / 8] &= !mask }
        }
        self
    }
    fn message(self) -> Message {
        decode(&Block::with_parity(self.0).unwrap())
    }
}

fn second(s: i64) -> GpsTime {
    GpsTime::from_nanoseconds(s * 1_000_000_000)
}

/// PRN 1 and 3 in the mask.
fn mask(iodp: u32) -> Message {
    Draft::new(1).set(14, 1, 1).set(16, 1, 1).set(224, 2, iodp).message()
}

fn fast(iodf: u32, iodp: u32, raw: u32, udrei: u32) -> Message {
    Draft::new(2).set(14, 2, iodf).set(16, 2, iodp).set(18, 12, raw).set(174, 4, udrei).set(178, 4, udrei).message()
}

fn long_term(iodp: u32, iode: u32) -> Message {
    Draft::new(25).set(15, 6, 1).set(21, 8, iode).set(117, 2, iodp).message()
}

/// A store in which PRN 1 is served from second 3 on.
fn served() -> Store {
    let mut store = Store::new(Obedience::Obey);
    store.receive(second(1), &mask(2)).unwrap();
    store.receive(second(2), &long_term(2, 77)).unwrap();
    store.receive(second(3), &fast(0, 2, 8, 5)).unwrap();
    store
}

#[test]
fn a_satellite_is_served_by_its_own_parts() {
    let s = served().satellite(1, Use::PrecisionApproach, second(4)).unwrap();
    assert_eq!((s.udrei, s.fast.correction_m, s.udre_applies), (5, 1.0, second(2)));
    assert_eq!(s.long_term[0].unwrap().0.iode, 77);
    assert_eq!(served().satellite(2, Use::PrecisionApproach, second(4)), Err(Correction::NotInMask));
    assert_eq!(served().satellite(3, Use::PrecisionApproach, second(4)), Err(Correction::NoLongTerm));
}

#[test]
fn parts_grow_too_old_at_the_standards_ages() {
    for (used_for, last) in [(Use::PrecisionApproach, 15), (Use::EnRoute, 21)] {
        let store = heard_until(last);
        assert!(store.satellite(1, used_for, second(last)).is_ok());
        assert_eq!(store.satellite(1, used_for, second(last + 1)), Err(Correction::NoUdre));
    }
    let mut kept = served();
    for at in 4..700 {
        kept.receive(second(at), &if at % 6 == 0 { fast(0, 2, 8, 5) } else { Message::Null }).unwrap();
    }
    assert_eq!(kept.satellite(1, Use::PrecisionApproach, second(699)), Err(Correction::NotInMask), "the mask is 600 s old");
}

/// A store that serves PRN 1 and hears a message of no content each second from 4 to `last`.
fn heard_until(last: i64) -> Store {
    let mut store = served();
    for at in 4..=last {
        store.receive(second(at), &Message::Null).unwrap();
    }
    store
}

#[test]
fn four_seconds_without_a_message_end_the_indicators_of_an_approach_only() {
    let (store, after) = (heard_until(5), |ns: i64| GpsTime::from_nanoseconds(5_000_000_000 + ns));
    for (now, lost) in [(after(4_119_999_999), false), (after(4_120_000_000), true)] {
        let expected = if lost { Err(Correction::MessageLoss) } else { Ok(5) };
        assert_eq!(store.satellite(1, Use::PrecisionApproach, now).map(|s| s.udrei), expected);
        assert_eq!(store.silent(now), lost);
        assert_eq!(store.satellite(1, Use::EnRoute, now).map(|s| s.udrei), Ok(5));
    }
}

#[test]
fn three_lost_messages_change_nothing_and_after_four_each_satellite_waits_for_an_indicator_of_its_own() {
    for (next, lost) in [(9, false), (10, true)] {
        let mut store = heard_until(5);
        // Any message ends the silence, an unknown one too; the old indicators stay lost.
        assert_eq!(store.receive(second(next), &Message::Unknown(33)), Err(Ignored::Unknown(33)));
        let expected = if lost { Err(Correction::MessageLoss) } else { Ok(5) };
        assert_eq!(store.satellite(1, Use::PrecisionApproach, second(next + 1)).map(|s| s.udrei), expected);
        assert_eq!(store.satellite(1, Use::EnRoute, second(next + 1)).map(|s| s.udrei), Ok(5));
        assert!(!store.silent(second(next + 1)));
        store.receive(second(next + 1), &fast(1, 2, 8, 6)).unwrap();
        assert_eq!(store.satellite(1, Use::PrecisionApproach, second(next + 2)).map(|s| s.udrei), Ok(6));
    }
}

#[test]
fn message_6_revives_a_correction_that_it_names() {
    let six = |iodf: u32| Draft::new(6).set(14, 2, iodf).set(22, 4, 7).message();
    let mut store = heard_until(5);
    store.receive(second(10), &six(1)).unwrap();
    assert_eq!(store.satellite(1, Use::PrecisionApproach, second(11)), Err(Correction::MessageLoss), "of another issue");
    store.receive(second(11), &six(0)).unwrap();
    assert_eq!(store.satellite(1, Use::PrecisionApproach, second(12)).map(|s| s.udrei), Ok(7));
}

#[test]
fn corrections_of_another_mask_change_nothing_and_a_new_mask_takes_over_when_used() {
    let mut store = served();
    assert_eq!(store.receive(second(4), &fast(1, 3, 80, 0)), Err(Ignored::NoPrnMask));
    assert_eq!(store.satellite(1, Use::PrecisionApproach, second(5)).unwrap().udrei, 5);
    // PRN 1 alone in the new mask: until a message uses it the old one holds.
    let new = Draft::new(1).set(14, 1, 1).set(224, 2, 3).message();
    store.receive(second(5), &new).unwrap();
    assert_eq!(store.prns(Use::PrecisionApproach, second(6)), [1, 3]);
    store.receive(second(6), &fast(1, 3, 80, 4)).unwrap();
    assert_eq!(store.prns(Use::PrecisionApproach, second(7)), [1]);
}

#[test]
fn message_6_counts_for_the_corrections_it_names_and_in_an_alert_for_all() {
    let six = |iodf: u32, udrei: u32| Draft::new(6).set(14, 2, iodf).set(22, 4, udrei).message();
    let mut store = served();
    store.receive(second(4), &six(1, 12)).unwrap();
    assert_eq!(store.satellite(1, Use::EnRoute, second(5)).unwrap().udrei, 5, "of another issue");
    store.receive(second(5), &six(0, 9)).unwrap();
    let named = store.satellite(1, Use::EnRoute, second(6)).unwrap();
    assert_eq!((named.udrei, named.udre_applies), (9, second(2)), "age counts from the corrections it belongs to");
    store.receive(second(6), &six(3, 15)).unwrap();
    let alert = store.satellite(1, Use::EnRoute, second(7)).unwrap();
    assert_eq!((alert.udrei, alert.udre_applies), (15, second(5)));
}

#[test]
fn a_rate_never_spans_a_time_without_monitoring() {
    let mut store = served();
    store.receive(second(7), &fast(1, 2, 16, 5)).unwrap();
    assert_eq!(store.satellite(1, Use::PrecisionApproach, second(8)).unwrap().earlier.unwrap().correction_m, 1.0);
    store.receive(second(15), &fast(2, 2, 0x7FF, 14)).unwrap();
    store.receive(second(21), &fast(0, 2, 16, 5)).unwrap();
    assert_eq!(store.satellite(1, Use::PrecisionApproach, second(22)).unwrap().earlier, None);
}

#[test]
fn message_0_forgets_everything_and_nothing_is_heard_for_a_minute() {
    let mut store = served();
    store.receive(second(4), &Draft::new(0).message()).unwrap();
    assert!(store.stopped(second(5)) && store.stopped(second(64)) && !store.stopped(second(65)));
    assert_eq!(store.satellite(1, Use::EnRoute, second(5)), Err(Correction::NotInMask));
    assert_eq!(store.receive(second(60), &mask(2)), Err(Ignored::DoNotUse));
    assert_eq!(store.receive(second(65), &mask(2)), Ok(()));
    let mut test = Store::new(Obedience::UseTestSignal);
    test.receive(second(1), &mask(2)).unwrap();
    // A message 0 with the content of message 2.
    let content = Draft::new(0).set(16, 2, 2).set(18, 12, 8).set(174, 4, 5).message();
    test.receive(second(2), &content).unwrap();
    test.receive(second(3), &long_term(2, 77)).unwrap();
    assert_eq!(test.satellite(1, Use::EnRoute, second(4)).unwrap().fast.correction_m, 1.0);
}

#[test]
fn grid_delays_wait_for_the_mask_of_their_issue() {
    let mut store = Store::new(Obedience::Obey);
    // Band 4, first point of the block: 4 m, indicator 3.
    let delays = |iodi: u32| Draft::new(26).set(14, 4, 4).set(22, 9, 32).set(31, 4, 3).set(217, 2, iodi).message();
    let points = |iodi: u32, number: usize| Draft::new(18).set(14, 4, 1).set(18, 4, 4).set(22, 2, iodi).set(23 + number, 1, 1).message();
    store.receive(second(1), &delays(1)).unwrap();
    assert_eq!(store.grid(Use::EnRoute, second(2)).count(), 0);
    store.receive(second(2), &points(0, 1)).unwrap();
    assert!(store.grid(Use::EnRoute, second(3)).all(|g| g.in_force.is_none()), "of another issue");
    store.receive(second(3), &points(1, 2)).unwrap();
    let in_force: std::vec::Vec<_> = store.grid(Use::EnRoute, second(4)).filter_map(|g| Some((g.point, g.in_force?))).collect();
    assert_eq!(in_force.len(), 1);
    let (point, (delay, applies)) = in_force[0];
    assert_eq!((point.lat_deg, point.lon_deg, delay.delay_m, delay.givei, applies), (-65, -20, Some(4.0), 3, second(0)));
    assert_eq!(store.grid(Use::EnRoute, second(602)).filter(|g| g.in_force.is_some()).count(), 0, "600 s after the end");
}

#[test]
fn time_outs_of_fast_corrections_shrink_as_they_degrade_faster() {
    for pair in timeout::FAST.windows(2) {
        let ([slow, fast], [long, short]) = ([pair[0].0, pair[1].0], [pair[0].1, pair[1].1]);
        assert!(slow < fast && long.0 >= short.0 && long.1 >= short.1 && long.0 < long.1);
    }
}
