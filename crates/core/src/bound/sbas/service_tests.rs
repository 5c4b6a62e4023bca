use super::*;
use crate::signal::sbas::{LongTermRates, Region};

/// Across both midnights, and on a day far from the first: the nearest day is meant.
#[test]
fn a_time_of_day_is_that_of_the_nearest_day() {
    // A nanosecond: the time of day is made of nanoseconds.
    let close = |time_of_day_s: u32, day: f64, second: f64, expected: f64| {
        let rates = Some(LongTermRates { velocity_ecef_mps: [0.0; 3], drift: 0.0, time_of_day_s });
        let long_term = LongTerm { position: 1, iodp: 0, iode: 0, position_ecef_m: [0.0; 3], clock_s: 0.0, rates };
        let since = since_time_of_day(&long_term, GpsTime::default().plus_seconds(86_400.0 * day + second));
        assert!((since - expected).abs() < 1e-9, "{time_of_day_s} {day} {second}: {since}");
    };
    for day in [0.0, 1.0, 16_000.0] {
        close(3600, day, 3700.0, 100.0);
        close(3600, day, 3500.0, -100.0);
        close(86_000, day + 1.0, 100.0, 500.0);
        close(100, day, 86_000.0, -500.0);
        close(0, day, 43_000.0, 43_000.0);
        close(43_000, day, 0.0, -43_000.0);
    }
    let without = LongTerm { position: 1, iodp: 0, iode: 0, position_ecef_m: [0.0; 3], clock_s: 0.0, rates: None };
    assert_eq!(since_time_of_day(&without, GpsTime::default().plus_seconds(100.0)), 0.0);
}

const NONE: Degradation = Degradation {
    rrc_m: 0.0,
    ltc_lsb_m: 0.0,
    ltc_v1_mps: 0.0,
    ltc_v1_s: 0.0,
    ltc_v0_m: 0.0,
    ltc_v0_s: 0.0,
    geo_lsb_m: 0.0,
    geo_v_mps: 0.0,
    geo_s: 0.0,
    er_m: 0.0,
    iono_step_m: 0.0,
    iono_s: 0.0,
    iono_ramp_mps: 0.0,
    rss_udre: false,
    rss_iono: false,
    covariance: 0.0,
};

/// The plain way for one satellite: back along its velocity by the way's time, turned with the Earth meanwhile.
#[test]
fn a_line_of_sight_is_that_to_where_the_signal_left() {
    let positions = [[15.6e6, 7.5e6, 20.1e6], [2.0e6, -22.0e6, 14.0e6]];
    let velocities = [[-900.0, 2800.0, -1400.0], [2100.0, 1900.0, 1300.0]];
    let mut orbits = Orbits { count: 2, ..Orbits::default() };
    for (i, (p, v)) in positions.iter().zip(&velocities).enumerate() {
        for axis in 0..3 {
            orbits.position[axis][i] = p[axis];
            orbits.velocity[axis][i] = v[axis];
        }
    }
    let place = [4.2e6, 0.17e6, 4.78e6];
    let unit = orbits.towards(&[1, 0], &Vector3::new(place[0], place[1], place[2]));
    for (l, i) in [1, 0].into_iter().enumerate() {
        let straight: f64 = (0..3).map(|k| f64::powi(positions[i][k] - place[k], 2)).sum();
        let way_s = straight.sqrt() / 299_792_458.0;
        let [x, y, z]: [f64; 3] = core::array::from_fn(|k| positions[i][k] - velocities[i][k] * way_s);
        let turned = 7.292_115e-5 * way_s;
        let sent = [x * turned.cos() + y * turned.sin(), y * turned.cos() - x * turned.sin(), z];
        let line: [f64; 3] = core::array::from_fn(|k| sent[k] - place[k]);
        let length = line.iter().map(|c| c * c).sum::<f64>().sqrt();
        for k in 0..3 {
            // The satellite moves some 250 m on the way of 22 000 km, 1e-5 of it; the limit is a millimetre.
            assert!((unit[k][l] - line[k] / length).abs() < 4e-11, "satellite {i}, axis {k}");
        }
    }
}

#[test]
fn a_range_rate_degrades_by_what_was_missed_or_by_the_alert() {
    let d = Degradation { rrc_m: 0.3, ..NONE };
    let rate = RangeRate { mps: 0.1, age_s: 5.0, interval_s: 12.0, factor_mps2: 0.002, time_out_s: 60.0, consecutive: false, alert: false };
    let close = |rate: RangeRate, expected: f64| assert!((rate.degradation_m(&d) - expected).abs() < 1e-12, "{expected}");
    // One was missed: (a I / 4 + B / dt) t.
    close(RangeRate { ..rate }, (0.002 * 60.0 / 4.0 + 0.3 / 12.0) * 5.0);
    close(RangeRate { consecutive: true, ..rate }, 0.0);
    // An alert 12 s after, off half of the time-out by 18 s; none where it is at half.
    close(RangeRate { alert: true, ..rate }, (0.002 * 18.0 / 2.0 + 0.3 / 12.0) * 5.0);
    close(RangeRate { alert: true, interval_s: 50.0, ..rate }, (0.002 * 20.0 / 2.0 + 0.3 / 50.0) * 5.0);
    close(RangeRate { alert: true, interval_s: 30.0, ..rate }, 0.0);
    close(RangeRate { interval_s: 0.0, ..rate }, 0.0);
}

#[test]
fn a_long_term_correction_degrades_outside_its_interval() {
    let d = Degradation { ltc_lsb_m: 0.05, ltc_v1_mps: 0.001, ltc_v1_s: 120.0, ltc_v0_m: 0.2, ltc_v0_s: 100.0, ..NONE };
    let rates = Some(LongTermRates { velocity_ecef_mps: [0.0; 3], drift: 0.0, time_of_day_s: 3600 });
    let of = |rates: Option<LongTermRates>, second: f64| {
        let long_term = LongTerm { position: 1, iodp: 0, iode: 0, position_ecef_m: [0.0; 3], clock_s: 0.0, rates };
        long_term_degradation_m(&long_term, GpsTime::default().plus_seconds(3000.0), GpsTime::default().plus_seconds(second), &d)
    };
    for (second, expected) in [(3601.0, 0.0), (3719.0, 0.0), (3720.0, 0.05), (3820.0, 0.15), (3600.0, 0.05), (3500.0, 0.15)] {
        assert!((of(rates, second) - expected).abs() < 1e-9, "{second}: {}", of(rates, second));
    }
    // Without rates: a step each hundred seconds since it was sent.
    for (second, steps) in [(3050.0, 0.0), (3150.0, 1.0), (3950.0, 9.0)] {
        assert!((of(None, second) - 0.2 * steps).abs() < 1e-12, "{second}");
    }
}

/// Of regions that overlap the highest priority counts, of equals the smaller factor, in whatever order they stand.
#[test]
fn the_factor_of_overlapping_regions_is_that_of_the_highest_priority_and_then_the_smaller() {
    let of = |sets: [(u8, f64); 3]| {
        let mut service = Service::new(Use::EnRoute, None);
        for (slot, (priority, inside)) in service.regions.iter_mut().zip(sets) {
            let region = Region { first_deg: [40, 0], second_deg: [60, 20], rectangle: true };
            let regions = core::array::from_fn(|k| (k == 0).then_some(region));
            *slot = Some(ServiceRegions { iods: 0, messages: 3, number: 1, priority, inside, outside: 10.0, regions });
        }
        service.region_factor(50.0, 10.0)
    };
    assert_eq!(of([(1, 3.0), (1, 2.0), (0, 1.0)]), 2.0);
    assert_eq!(of([(1, 2.0), (1, 3.0), (0, 1.0)]), 2.0);
    assert_eq!(of([(0, 1.0), (1, 2.0), (2, 5.0)]), 5.0);
    assert_eq!(of([(2, 5.0), (0, 1.0), (1, 2.0)]), 5.0);
}
