use super::*;
use navbound_core::frame::LatLon;
use navbound_core::geometry::{GALILEO, GPS};
use navbound_core::quantity::Metres;

/// 2026-03-01 00:00 of GPS time, a Sunday: the first instant of week 2408.
const BEGIN: GpsTime = GpsTime::from_nanoseconds(2408 * WEEK_NS);

fn station() -> RawStation {
    let point = LatLon::new(Radians::degrees(48.99), Radians::degrees(2.57)).unwrap();
    RawStation {
        place: Geodetic { point, height: Metres::new(120.0) },
        begin: BEGIN,
        step_s: 30.0,
        n_epochs: 240,
        seed: 7,
        mask: Radians::degrees(5.0),
        outages_s: vec![[1200.0, 1500.0]],
        wrong: vec![],
    }
}

fn records() -> Vec<Ephemeris> {
    let slots: Vec<Slot> = GPS.into_iter().chain(GALILEO).collect();
    broadcast(&slots, BEGIN, 7200.0, 7)
}

#[test]
fn consecutive_records_of_a_satellite_say_the_same_orbit() {
    for own in records().chunk_by(|a, b| a.satellite == b.satellite) {
        assert!(own.len() >= 2);
        let middle = own[0].orbit_time.plus_seconds(3600.0);
        let [a, b] = [&own[0], &own[1]].map(|r| Broadcast::new(r).unwrap().state(middle));
        // Five angles with units of 2^-31 semicircles, half a unit each of 29,600 km: 22 mm an angle and record.
        assert!((a.position.vector() - b.position.vector()).norm() < 0.25, "{}", own[0].satellite);
        // Half of 2^-31 s, the unit of the clock: 0.07 m; half of 2^-43 over an hour is less than a tenth of that.
        assert!((a.clock_s - b.clock_s).abs() < 0.55 * 2.0_f64.powi(-31) * 2.0);
    }
}

#[test]
fn nothing_is_heard_during_an_outage_and_locks_are_new_after_it() {
    let station = station();
    let epochs = hear(&station, &records()).unwrap();
    assert_eq!(epochs.len(), 240 - 10);
    let since = |e: &RawEpoch| e.time.seconds_since(BEGIN);
    assert!(epochs.iter().all(|e| !(1200.0..1500.0).contains(&since(e))));
    let after = epochs.iter().find(|e| since(e) == 1500.0).unwrap();
    assert!(after.heard.len() >= 8 && after.heard.iter().all(|h| h.signals.iter().all(|s| s.lost)));
}

#[test]
fn a_fault_is_in_the_ranges_of_its_satellite_and_nowhere_else() {
    let (quiet, records) = (station(), records());
    let epochs = hear(&quiet, &records).unwrap();
    let satellite = epochs[100].heard[0].satellite;
    let wrong = WrongRange { satellite, during_s: [600.0, 900.0], step_m: 5.0, ramp_mps: 0.1 };
    let faulty = hear(&RawStation { wrong: vec![wrong], ..quiet }, &records).unwrap();
    for (a, b) in epochs.iter().zip(&faulty) {
        let since = a.time.seconds_since(BEGIN);
        for (a, b) in a.heard.iter().zip(&b.heard) {
            let expected = if a.satellite == satellite && (600.0..900.0).contains(&since) { 5.0 + 0.1 * (since - 600.0) } else { 0.0 };
            for k in 0..2 {
                // Two numbers of 4e7 m are subtracted: their last places.
                assert!((b.signals[k].range_m - a.signals[k].range_m - expected).abs() < 1e-7);
            }
        }
    }
}

#[test]
fn doppler_is_the_rate_of_the_phase() {
    let epochs = hear(&RawStation { step_s: 1.0, n_epochs: 60, outages_s: vec![], ..station() }, &records()).unwrap();
    for pair in epochs.windows(2) {
        for (a, b) in pair[0].heard.iter().zip(&pair[1].heard).filter(|(a, b)| a.satellite == b.satellite) {
            let counted = b.signals[0].phase_cycles - a.signals[0].phase_cycles;
            let mean = 0.5 * (a.signals[0].doppler_hz + b.signals[0].doppler_hz);
            // Noise of Doppler 0.05 Hz and of phase 0.015 cycles; signal in space and delays that wander by centimetres a second. A wrong sign
            // or a lost Earth rotation would be hundreds of cycles.
            assert!((counted + mean).abs() < 1.0, "{} {counted} {mean}", a.satellite);
        }
    }
}

#[test]
fn the_two_ranges_differ_by_the_ionosphere_alone() {
    let epochs = hear(&station(), &records()).unwrap();
    let differences: Vec<f64> = epochs.iter().flat_map(|e| &e.heard).map(|h| h.signals[1].range_m - h.signals[0].range_m).collect();
    let mean = differences.iter().sum::<f64>() / differences.len() as f64;
    // 0.65 (L2) or 0.79 (L5) times a delay of 1.5 m overhead at night, two to three times that at low elevations.
    assert!((1.0..4.0).contains(&mean), "{mean}");
}

#[test]
fn a_step_of_nothing_is_refused() {
    assert_eq!(hear(&RawStation { step_s: 0.0, ..station() }, &records()).unwrap_err().argument, "step_s");
}
