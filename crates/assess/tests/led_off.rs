//! Codes of real recordings against their phases: healthy ones, and with every code led off. Skipped, aloud, without the files.
#![allow(clippy::unwrap_used, clippy::print_stderr, reason = "a test may stop at the first surprise, and a skipped one says so")]

use navbound_assess::positions::{Job, Model, Positions, Signals, positions};
use navbound_core::quantity::{Radians, Reason};
use navbound_core::signal::Constellation;
use navbound_core::solution::RangeError;
use navbound_core::solution::point::Settings;
use navbound_formats::packed::unpack;
use navbound_formats::rinex::{Navigation, Observations, read_navigation, read_observations};
use std::path::PathBuf;

fn bytes(name: &str) -> Option<Vec<u8>> {
    let folder = std::env::var_os("NAVBOUND_DATA")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"), PathBuf::from);
    let bytes = std::fs::read(folder.join(name)).ok().map(|b| unpack(&b).unwrap().into_owned());
    if bytes.is_none() {
        eprintln!("SKIPPED: {name} is not below {}", folder.display());
    }
    bytes
}

fn solved(observations: &Observations, navigation: &Navigation, signals: Signals) -> Positions {
    let middle = observations.time[observations.n_epochs() / 2];
    let ionosphere = Model::Auto.of(navigation, middle).unwrap();
    let (errors, false_alarm, most_excluded) = (RangeError::CALIBRATED, 1e-4, 6);
    let settings = Settings { mask: Radians::new(5.0_f64.to_radians()), ionosphere, errors, false_alarm, most_excluded };
    let systems = vec![Constellation::Gps, Constellation::Galileo, Constellation::BeiDou];
    positions(observations, navigation, None, &Job { systems, signals, smoothing: None, settings, keep_ranges: true })
}

fn n_led_off(positions: &Positions, from: usize) -> usize {
    (from..positions.fixes.len()).filter(|e| positions.reason(*e) == Some(Reason::CodesLedOff)).count()
}

/// Every code from an epoch on as it would be so far east, where the direction of its satellite is known.
fn lead(observations: &mut Observations, healthy: &Positions, from: usize, east_m: f64) {
    for epoch in from..observations.n_epochs() {
        for k in observations.satellites(epoch) {
            let satellite = observations.satellite[k];
            let Some((_, used)) = healthy.ranges[epoch].iter().find(|(s, _)| *s == satellite) else { continue };
            let at = observations.value_range(k).start;
            for (column, code) in observations.codes[satellite.constellation.index()].iter().enumerate() {
                if code[0] == b'C' {
                    observations.value[at + column] -= used.unit.x * east_m;
                }
            }
        }
    }
}

/// An hour of a station, an epoch every 30 s, seven to nine satellites of GPS.
#[test]
fn an_hour_is_named_where_its_codes_are_led_off_and_nowhere_else() {
    let Some(observations) = bytes("gnss/ARLM_2015_200/arlm200x.15o") else { return };
    let Some(navigation) = bytes("gnss/ARLM_2015_200/arlm2000.15n") else { return };
    let (mut observations, navigation) = (read_observations(&observations).unwrap(), read_navigation(&navigation).unwrap());
    let healthy = solved(&observations, &navigation, Signals::Single);
    assert_eq!((n_led_off(&healthy, 0), n_led_off(&solved(&observations, &navigation, Signals::Dual), 0)), (0, 0));
    let (n, from) = (healthy.fixes.len(), healthy.fixes.len() / 2);
    lead(&mut observations, &healthy, from, 100.0);
    let led = solved(&observations, &navigation, Signals::Single);
    assert_eq!((n_led_off(&led, 0), n_led_off(&led, from)), (n - from, n - from));
}
