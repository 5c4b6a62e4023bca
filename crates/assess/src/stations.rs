//! When stations doubt the filter and not themselves, and what takes that back.

use navbound_core::quantity::GpsTime;

/// Stations left out at once until the filter and not the stations is doubted: two that are wrong independently are rarer than one inertial
/// unit. Provenance: ours.
pub(crate) const LEAST: u64 = 2;
/// For how long they must be \[s\]. A good one is left out by chance for half a minute every two hours or so. Provenance: ours.
pub(crate) const AFTER_S: f64 = 30.0;

/// Stations that are left out against the filter.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Doubting {
    since: Option<GpsTime>,
}

impl Doubting {
    /// What was heard until a time, from `over_s` before it on: stations that agree, stations that are left out, and whether satellites keep the position.
    ///
    /// Once the filter is doubted only as many stations that agree, or satellites, take that back. Silence does not, nor does the last station
    /// in range: a filter that was led off is as far off when it hears no more.
    pub(crate) fn hear(&mut self, now: GpsTime, over_s: f64, [agree, left_out]: [u64; 2], satellites: bool) {
        if left_out >= LEAST {
            self.since.get_or_insert(now.plus_seconds(-over_s));
        } else if !self.doubts(now) || agree >= LEAST || (satellites && agree + left_out > 0) {
            self.since = None;
        }
    }

    /// Whether they doubt the filter.
    pub(crate) fn doubts(&self, now: GpsTime) -> bool {
        self.since.is_some_and(|since| now.seconds_since(since) >= AFTER_S)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn second(k: i64) -> GpsTime {
        GpsTime::from_nanoseconds(1_000_000_000 * k)
    }

    fn doubted() -> Doubting {
        let mut stations = Doubting::default();
        (0..=30).for_each(|k| stations.hear(second(k), 0.0, [0, 2], false));
        stations
    }

    #[test]
    fn two_stations_left_out_for_half_a_minute_doubt_the_filter() {
        assert!(!doubted().doubts(second(29)));
        assert!(doubted().doubts(second(30)));
        let mut stations = Doubting::default();
        (0..=60).for_each(|k| stations.hear(second(k), 0.0, [3, 1], false));
        assert!(!stations.doubts(second(60)));
    }

    #[test]
    fn neither_silence_nor_the_last_station_takes_a_doubt_back() {
        for (agree, left_out) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let mut stations = doubted();
            (31..600).for_each(|k| stations.hear(second(k), 0.0, [agree, left_out], false));
            assert!(stations.doubts(second(600)), "{agree} agree, {left_out} left out");
        }
    }

    #[test]
    fn stations_that_agree_and_satellites_take_it_back() {
        for (agree, left_out, satellites) in [(2, 0, false), (3, 1, false), (1, 0, true)] {
            let mut stations = doubted();
            stations.hear(second(31), 0.0, [agree, left_out], satellites);
            assert!(!stations.doubts(second(31)));
        }
    }

    #[test]
    fn before_they_doubt_one_hearing_clears_them() {
        let mut stations = Doubting::default();
        (0..=20).for_each(|k| stations.hear(second(k), 0.0, [0, 2], false));
        stations.hear(second(21), 0.0, [1, 0], false);
        (22..=40).for_each(|k| stations.hear(second(k), 0.0, [0, 2], false));
        assert!(!stations.doubts(second(40)));
    }
}
