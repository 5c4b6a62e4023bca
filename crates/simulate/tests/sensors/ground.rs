//! DME, VOR and the altimeter.

use super::common::{Rig, Sample, all, assert_unit_variance, fly, rig};
use navbound_core::frame::{LatLon, ecef_from_geodetic, enu_from_ecef};
use navbound_core::quantity::Radians;
use navbound_core::signal::{Aiding, BaroHeight, DmeRange, VorBearing};
use navbound_path::Line;
use navbound_simulate::{Baro, SensorFault, Sensors};

fn ground(change: impl FnOnce(&mut Sensors)) -> Rig {
    rig(|s| {
        s.gnss = None;
        change(s);
    })
}

fn dme(sample: &Sample) -> Vec<&DmeRange> {
    sample.of(|a| if let Aiding::Dme(d) = a { Some(d) } else { None })
}
fn vor(sample: &Sample) -> Vec<&VorBearing> {
    sample.of(|a| if let Aiding::Vor(v) = a { Some(v) } else { None })
}
fn baro(sample: &Sample) -> &BaroHeight {
    sample.of(|a| if let Aiding::Baro(b) = a { Some(b) } else { None })[0]
}

fn slant(sample: &Sample, range: &DmeRange) -> f64 {
    ecef_from_geodetic(&sample.step.truth.position).minus(&range.position).vector().norm()
}

#[test]
fn a_station_has_one_bias_a_flight_and_new_noise_every_second() {
    let rig = ground(|s| s.dme.as_mut().unwrap().noise_least_m = 10.0);
    let mut biases = Vec::new();
    for number in 0..40 {
        let flown = fly(&rig, number, 200);
        for station in [0, 1] {
            let errors: Vec<(f64, f64)> = flown
                .iter()
                .flat_map(|s| dme(s).into_iter().filter(|d| d.station == station).map(|d| (d.slant.m() - slant(s, d), d.sigma_white.m())))
                .collect();
            let n = errors.len() as f64;
            assert!(n > 80.0, "{n}");
            let bias = errors.iter().map(|e| e.0).sum::<f64>() / n;
            biases.push(bias);
            let spread = errors.iter().map(|e| ((e.0 - bias) / e.1).powi(2)).sum::<f64>() / (n - 1.0);
            // Five standard errors: 80 of them are looked at.
            assert!((spread - 1.0).abs() < 5.0 * (2.0 / n).sqrt(), "{spread} of {n}");
        }
    }
    // The mean keeps 10 m / sqrt(80) of the noise, 0.02 % of the bias' variance of 92.6^2.
    assert_unit_variance(biases.iter().map(|b| (b / 92.6).powi(2)), "bias of a station");
}

#[test]
fn stations_serve_where_they_may() {
    let rig = ground(|s| s.dme.as_mut().unwrap().coverage.range_most_m = 30_000.0);
    let stations = rig.sensing.sensors().stations.clone();
    let (mut served, mut silent) = (0, 0);
    for sample in fly(&rig, 0, 900) {
        let p = &sample.step.truth.position;
        for (index, station) in stations.iter().enumerate().take(2) {
            let point = LatLon::new(Radians::new(station.lat_rad), Radians::new(station.lon_rad)).unwrap();
            let at = navbound_core::frame::Geodetic { point, height: navbound_core::quantity::Metres::new(station.height_m) };
            let enu = enu_from_ecef(&point) * ecef_from_geodetic(p).minus(&ecef_from_geodetic(&at)).vector();
            let (range, elevation) = (enu.norm(), (enu.z / enu.norm()).asin());
            let horizon = 4120.0 * (p.height.m().sqrt() + station.height_m.sqrt());
            let expected = range <= horizon && (5556.0..=30_000.0).contains(&range) && elevation <= 0.698;
            assert_eq!(dme(&sample).iter().any(|d| usize::from(d.station) == index), expected);
            if expected { served += 1 } else { silent += 1 }
        }
        // The third station has no DME.
        assert!(dme(&sample).iter().all(|d| d.station < 2));
    }
    assert!(served > 100 && silent > 100, "{served} {silent}");
}

#[test]
fn a_dme_fault_comes_when_declared_to_the_station_named() {
    let fault = SensorFault::DmeBias { start_s: 50.0, duration_s: 50.0, station: "Q".into(), bias_m: 500.0 };
    let (good, bad) = (ground(|_| ()), ground(|s| s.faults = vec![fault]));
    for (a, b) in fly(&good, 0, 150).iter().zip(fly(&bad, 0, 150)) {
        let active = (50.0..100.0).contains(&a.since());
        for (p, q) in dme(a).iter().zip(dme(&b)) {
            let expected = if active && p.station == 1 { 500.0 } else { 0.0 };
            assert!((q.slant.m() - p.slant.m() - expected).abs() < 1e-9);
        }
    }
}

#[test]
fn bearings_count_from_the_station_clockwise_from_north() {
    let rig = ground(|s| {
        let vor = s.vor.as_mut().unwrap();
        (vor.bias_sigma_rad, vor.noise_sigma_rad) = (0.0, 1e-12);
    });
    let mut seen = 0;
    for sample in fly(&rig, 0, 600) {
        for bearing in vor(&sample) {
            assert_ne!(bearing.station, 1, "the second station has no VOR");
            let line = Line::through(bearing.position.point, sample.step.truth.position.point).unwrap();
            let expected = line.at(navbound_core::quantity::Metres::new(0.0)).unwrap().course.rad();
            // Geodesic and normal section, and the aircraft's height, differ by some 1e-6 rad below 100 km.
            let difference = bearing.bearing.rad() - expected;
            assert!((difference - std::f64::consts::TAU * (difference / std::f64::consts::TAU).round()).abs() < 1e-5, "{difference}");
            seen += 1;
        }
    }
    assert!(seen > 200, "{seen}");
}

#[test]
fn bearings_are_as_good_as_declared() {
    let rig = ground(|s| s.vor.as_mut().unwrap().bias_sigma_rad = 0.0);
    let exact = ground(|s| {
        let vor = s.vor.as_mut().unwrap();
        (vor.bias_sigma_rad, vor.noise_sigma_rad) = (0.0, 1e-12);
    });
    let errors = fly(&rig, 0, 600).into_iter().zip(fly(&exact, 0, 600)).flat_map(|(a, b)| {
        let pairs: Vec<f64> = vor(&a).iter().zip(vor(&b)).map(|(x, y)| (x.bearing.rad() - y.bearing.rad()) / 0.008_727).collect();
        pairs
    });
    // A bearing near north may wrap; the stations lie where none does.
    assert_unit_variance(errors.map(|x| x * x), "bearings");
}

/// An altimeter without errors.
const EXACT: Baro = Baro {
    interval_s: 1.0,
    bias_sigma_m: 0.0,
    bias_time_s: 3600.0,
    temperature_sigma_k: 0.0,
    temperature_share: 0.004,
    noise_sigma_m: 1e-9,
    lag_s: 0.0,
};

fn altimeter(settings: Baro, faults: Vec<SensorFault>) -> Rig {
    ground(|s| {
        (s.dme, s.vor, s.faults) = (None, None, faults);
        s.baro = Some(settings);
    })
}

fn height(sample: &Sample) -> f64 {
    sample.step.truth.position.height.m()
}

#[test]
fn the_altimeter_lags_a_climb_by_its_time_constant() {
    let flown = fly(&altimeter(Baro { lag_s: 0.5, ..EXACT }, vec![]), 0, 150);
    for sample in &flown[80..90] {
        let climb = -sample.step.truth.velocity_ned_mps.z;
        let behind = height(sample) - baro(sample).height.m();
        // Sampled ten times a second the lag of a steady climb is tau less half a sample, 0.45 s; the climb is not quite steady.
        assert!(climb > 5.0 && (behind / climb - 0.45).abs() < 0.05, "{behind} at {climb}");
    }
    let exact = fly(&altimeter(EXACT, vec![]), 0, 150);
    assert!(exact.iter().all(|s| (baro(s).height.m() - height(s)).abs() < 1e-6));
}

#[test]
fn warm_air_stretches_heights_and_the_altimeter_admits_it() {
    let rig = altimeter(Baro { temperature_sigma_k: 5.0, ..EXACT }, vec![]);
    let mut scales = Vec::new();
    for number in 0..60 {
        let flown = fly(&rig, number, 300);
        let scale = |s: &Sample| (baro(s).height.m() - height(s)) / (height(s) - 30.0);
        let (a, b) = (&flown[150], &flown[290]);
        // The departure is that of the smoothed path, within a metre of 30 m: a thousandth of the climb.
        assert!((scale(a) - scale(b)).abs() < 2e-3 * scale(a).abs() + 1e-9, "{} {}", scale(a), scale(b));
        scales.push(scale(b) / 0.02);
        assert!((baro(b).sigma_bias.m() / (0.02 * (height(b) - 30.0)) - 1.0).abs() < 2e-3);
    }
    assert_unit_variance(scales.iter().map(|x| x * x), "temperature");
}

#[test]
fn bias_and_noise_of_the_altimeter_are_as_declared() {
    let slow = altimeter(Baro { bias_sigma_m: 30.0, bias_time_s: 50.0, ..EXACT }, vec![]);
    let flights: Vec<Vec<f64>> =
        (0..60).map(|n| fly(&slow, n, 51).iter().map(|s| (baro(s).height.m() - height(s)) / 30.0).collect()).collect();
    assert_unit_variance(flights.iter().map(|f| f[0] * f[0]), "bias");
    let fresh = flights.iter().map(|f| (f[50] - f[0] * (-1.0_f64).exp()) / (1.0 - (-2.0_f64).exp()).sqrt());
    assert_unit_variance(fresh.map(|x| x * x), "bias after a correlation time");
    let noisy = fly(&altimeter(Baro { noise_sigma_m: 5.0, ..EXACT }, vec![]), 0, 900);
    assert_unit_variance(noisy.iter().map(|s| ((baro(s).height.m() - height(s)) / 5.0).powi(2)), "noise");
}

#[test]
fn a_blocked_static_port_holds_its_height() {
    let fault = SensorFault::BaroBlockage { start_s: 60.0, duration_s: 30.0 };
    let rig = altimeter(EXACT, vec![fault]);
    let flown = fly(&rig, 0, 120);
    let frozen = height(&all(&rig, 0, 60)[598]);
    for sample in &flown {
        let t = sample.since();
        // The last sample before the fault, at 59.9 s, is the last that gets through.
        let expected = if (60.0..90.0).contains(&t) { frozen } else { height(sample) };
        assert!((baro(sample).height.m() - expected).abs() < 1e-6, "{t}");
    }
}
