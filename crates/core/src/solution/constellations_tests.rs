use super::*;
use crate::solution::surroundings::tests::fix;

fn at(seconds: i64) -> GpsTime {
    GpsTime::from_nanoseconds(seconds * 1_000_000_000)
}

fn of(constellation: Constellation, number: u8) -> SatelliteId {
    SatelliteId { constellation, number }
}

const GALILEO: usize = 2;

fn galileo(number: u8) -> SatelliteId {
    assert_eq!(Constellation::from_index(GALILEO), Some(Constellation::Galileo));
    of(Constellation::Galileo, number)
}

/// Eight satellites of GPS and four of Galileo, whose clocks differ by `offset`.
fn two(offset: f64, excluded: &[SatelliteId]) -> Fix {
    let mut clock_m = [f64::NAN; CLOCKS];
    (clock_m[REFERENCE], clock_m[GALILEO]) = (1000.0, 1000.0 + offset);
    let mut used = [0; CLOCKS];
    (used[REFERENCE], used[GALILEO]) = (0b1_1111_1110, 0b1_1110);
    Fix { clock_m, used, spare: 7, offset_variance_m2: [0.25; CLOCKS], ..fix(1.0, excluded) }
}

fn followed(minutes: i64, offset: f64) -> Constellations {
    let mut c = Constellations::default();
    for t in 0..=2 * minutes {
        assert!(!c.follow(at(30 * t), Some(&two(offset, &[]))).leaves_out());
    }
    c
}

#[test]
fn the_size_of_an_offset_says_nothing_and_its_change_does() {
    for offset in [0.0, 440.0, -2340.0] {
        let mut c = followed(20, offset);
        // sqrt(0.3^2 + 0.2^2 / 20 + 0.25) m, five of them: 2.95 m.
        assert!(!c.follow(at(1230), Some(&two(offset + 2.8, &[]))).leaves_out(), "{offset}");
        let treatment = c.follow(at(1260), Some(&two(offset + 5.0, &[])));
        assert!(treatment.without[GALILEO] && !treatment.without[REFERENCE], "{offset}");
        // The jump did not become the offset's state.
        assert!(c.follow(at(1290), Some(&two(offset + 5.0, &[]))).without[GALILEO], "{offset}");
        assert!(!c.follow(at(1320), Some(&two(offset, &[]))).leaves_out(), "{offset}");
    }
}

#[test]
fn nothing_is_predicted_from_less_than_ten_minutes_or_across_an_hour() {
    assert_eq!(followed(9, 3.0).follow(at(600), None).offsets.of[GALILEO], None);
    let mut c = followed(20, 3.0);
    let prior = c.follow(at(1200 + 600), None).offsets.of[GALILEO].unwrap();
    assert!((prior.offset_m - 3.0).abs() < 1e-12);
    // sqrt(0.3^2 + 0.2^2) m.
    assert!((prior.sigma_m - 0.130_f64.sqrt()).abs() < 1e-12);
    assert_eq!(c.follow(at(1200 + 3601), None).offsets.of[GALILEO], None);
}

#[test]
fn a_receiver_clock_that_was_set_forgets_the_offsets() {
    let mut c = followed(20, 3.0);
    let mut set = two(3.0, &[]);
    for clock in &mut set.clock_m {
        *clock += 299_792.458;
    }
    assert_eq!(c.follow(at(1230), Some(&set)).offsets.of[GALILEO], None);
}

#[test]
fn a_constellation_most_of_whose_satellites_are_excluded_is_left_out_until_a_minute_later() {
    let mut c = Constellations::default();
    assert!(!c.follow(at(0), Some(&two(0.0, &[galileo(1)]))).leaves_out());
    assert!(!c.follow(at(10), Some(&two(0.0, &[galileo(2)]))).leaves_out());
    // Three of four.
    assert!(c.follow(at(20), Some(&two(0.0, &[galileo(3)]))).without[GALILEO]);
    assert!(c.follow(at(60), Some(&two(0.0, &[]))).without[GALILEO]);
    assert!(!c.follow(at(61), Some(&two(0.0, &[]))).leaves_out());
}

#[test]
fn where_every_constellation_contradicts_itself_none_is_left_out() {
    let mut c = Constellations::default();
    let wrong: Vec<SatelliteId> = (1..=5).map(|n| of(Constellation::Gps, n)).chain((1..=3).map(galileo)).collect();
    assert!(!c.follow(at(0), Some(&two(0.0, &wrong))).leaves_out());
}
