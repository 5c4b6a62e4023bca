//! The satellite receiver.

use super::common::{Rig, Sample, assert_unit_variance, fly, rig};
use nalgebra::{Rotation3, Vector3};
use navbound_core::frame::{ecef_from_geodetic, enu_from_ecef};
use navbound_core::geometry::{GALILEO, GPS, Orbit};
use navbound_core::signal::{Aiding, Constellation, SPEED_OF_LIGHT_MPS, SatelliteRange};
use navbound_simulate::{Gnss, RangeMode, SensorFault};

/// A receiver without what the test does not look at: no system biases, no slow parts.
fn plain(gnss: &mut Gnss) {
    gnss.system_bias_sigma_m = 0.0;
    gnss.parts.ranging_sigma_m = 0.0;
    gnss.parts.ionosphere_sigma_m = 0.0;
    gnss.parts.troposphere_sigma_m = 0.0;
    gnss.parts.multipath_share = 0.0;
}

fn receiver(change: impl FnOnce(&mut Gnss)) -> Rig {
    faulty(change, vec![])
}

fn faulty(change: impl FnOnce(&mut Gnss), faults: Vec<SensorFault>) -> Rig {
    rig(|s| {
        (s.dme, s.vor, s.baro, s.faults) = (None, None, None, faults);
        change(s.gnss.as_mut().unwrap());
    })
}

fn ranges(sample: &Sample) -> Vec<&SatelliteRange> {
    sample.of(|a| if let Aiding::Satellite(s) = a { Some(s) } else { None })
}

fn receiver_position(sample: &Sample) -> Vector3<f64> {
    *ecef_from_geodetic(&sample.step.truth.position).vector()
}

/// Range less geometry and clock \[m\].
fn residual(sample: &Sample, range: &SatelliteRange) -> f64 {
    range.range.unwrap().m() - (range.position.vector() - receiver_position(sample)).norm() - sample.clock.unwrap()[0]
}

#[test]
fn seed_mode_is_white_and_as_large_as_declared() {
    let flown = fly(
        &receiver(|g| {
            g.system_bias_sigma_m = 0.0;
            g.mode = RangeMode::Seed;
        }),
        0,
        300,
    );
    let all: Vec<f64> = flown.iter().flat_map(|s| ranges(s).into_iter().map(|r| residual(s, r) / 10.5)).collect();
    assert_unit_variance(all.iter().map(|x| x * x), "seed mode");
    let first = ranges(&flown[0])[0].satellite;
    let one: Vec<f64> =
        flown.iter().flat_map(|s| ranges(s).into_iter().filter(|r| r.satellite == first).map(|r| residual(s, r) / 10.5)).collect();
    assert_eq!(one.len(), 300);
    let lag = one.windows(2).map(|w| w[0] * w[1]).sum::<f64>() / 299.0;
    assert!(lag.abs() < 4.0 / 299.0_f64.sqrt(), "{lag}");
    assert!(flown.iter().all(|s| ranges(s).iter().all(|r| r.sigma_correlated.m() == 0.0 && r.sigma_white.m() == 10.5)));
}

#[test]
fn real_mode_is_as_large_as_each_record_says() {
    let rig = receiver(|g| g.system_bias_sigma_m = 0.0);
    let squares = (0..60).flat_map(|n| {
        let flown = fly(&rig, n, 1);
        let normal = |r: &&SatelliteRange| {
            let x = residual(&flown[0], r);
            x * x / (r.sigma_white.m().powi(2) + r.sigma_correlated.m().powi(2))
        };
        ranges(&flown[0]).iter().map(normal).collect::<Vec<_>>()
    });
    // The troposphere is shared, a hundredth of the variance.
    assert_unit_variance(squares, "real mode");
}

#[test]
fn the_slow_part_forgets_with_its_correlation_time() {
    let slow = |g: &mut Gnss| {
        plain(g);
        (g.parts.noise_sigma_m, g.parts.ranging_sigma_m, g.parts.ranging_time_s) = (1e-9, 1.0, 30.0);
    };
    let rig = receiver(slow);
    let (mut now, mut fresh, mut shared) = (Vec::new(), Vec::new(), 0.0);
    for number in 0..30 {
        let flown = fly(&rig, number, 31);
        let later = ranges(&flown[30]);
        for a in ranges(&flown[0]) {
            let Some(b) = later.iter().find(|b| b.satellite == a.satellite) else { continue };
            let (x, y) = (residual(&flown[0], a), residual(&flown[30], b));
            assert_eq!(a.correlation_time_s, 30.0);
            let new = (y - x * (-1.0_f64).exp()) / (1.0 - (-2.0_f64).exp()).sqrt();
            now.push(x * x);
            fresh.push(new * new);
            shared += new * x;
        }
    }
    let n = now.len() as f64;
    assert!((shared / n).abs() < 4.0 / n.sqrt(), "{shared} of {n}");
    assert_unit_variance(now, "slow part");
    assert_unit_variance(fresh, "what is new after a correlation time");
}

/// What switches a part on, and its standard deviation \[m\] at an elevation \[rad\].
type Model = (fn(&mut Gnss), fn(f64) -> f64);

#[test]
fn parts_grow_towards_the_horizon_as_their_models_say() {
    // Ratios of the standard deviations at the lowest and the highest satellite, from the formulas of the DO-229 family by hand.
    let elevation = |s: &Sample, r: &SatelliteRange| {
        let line = enu_from_ecef(&s.step.truth.position.point) * (r.position.vector() - receiver_position(s));
        (line.z / line.norm()).asin()
    };
    let models: [Model; 3] = [
        (|g| g.parts.ionosphere_sigma_m = 2.0, |el| 2.0 / (1.0 - (6_378_136.3 * el.cos() / 6_728_136.3).powi(2)).sqrt()),
        (|g| g.parts.troposphere_sigma_m = 0.12, |el| 0.12 * 1.001 / (0.002_001 + el.sin().powi(2)).sqrt()),
        (|g| g.parts.multipath_share = 1.0, |el| 0.13 + 0.53 * (-el.to_degrees() / 10.0).exp()),
    ];
    for (change, sigma) in models {
        let flown = fly(
            &receiver(|g| {
                plain(g);
                change(g);
            }),
            0,
            1,
        );
        for r in ranges(&flown[0]) {
            let expected = sigma(elevation(&flown[0], r));
            assert!((r.sigma_correlated.m() / expected - 1.0).abs() < 1e-9, "{} {expected}", r.sigma_correlated.m());
        }
    }
}

#[test]
fn a_signal_left_its_satellite_when_it_had_to() {
    let rig = receiver(plain);
    let flown = fly(&rig, 0, 1);
    let begin = 1_343_347_200.0;
    let mut looked_at = 0;
    for r in ranges(&flown[0]) {
        let slots = match r.satellite.constellation {
            Constellation::Gps => &GPS[..],
            Constellation::Galileo => &GALILEO[..],
            _ => continue,
        };
        let slot = &slots[usize::from(r.satellite.number) - 1];
        let way = (r.position.vector() - receiver_position(&flown[0])).norm() / SPEED_OF_LIGHT_MPS;
        let orbit = Orbit::new(slot.elements.moved(begin).unwrap()).unwrap();
        // The Earth turns on while the signal is under way: Earth-fixed axes of reception lie further east.
        let turned = Rotation3::from_axis_angle(&Vector3::z_axis(), -7.292_115_146_7e-5 * way);
        let expected = turned * orbit.position(1.0 - way).vector();
        // A micrometre is left of the iteration; 1e-9 rad of Earth rate over 0.08 s and 3e7 m would be seen.
        assert!((r.position.vector() - expected).norm() < 1e-4);
        let later = turned * orbit.position(2.0 - way).vector();
        let earlier = turned * orbit.position(-way).vector();
        // A central difference over 2 s: (n dt)^2 / 6 of 4 km/s is 2e-5 m/s.
        assert!((r.velocity_mps - 0.5 * (later - earlier)).norm() < 1e-3);
        looked_at += 1;
    }
    assert!(looked_at > 8, "{looked_at}");
}

#[test]
fn range_rates_and_phases_are_as_good_as_declared() {
    let flown = fly(&receiver(plain), 0, 200);
    let (mut rates, mut steps) = (Vec::new(), Vec::new());
    for pair in flown.windows(2) {
        let (a, b) = (&pair[0], &pair[1]);
        for (r, p) in ranges(b).iter().zip(&b.phases) {
            assert_eq!(r.satellite, p.satellite);
            let line = r.position.vector() - receiver_position(b);
            let v = &b.step.truth.velocity_ned_mps;
            let own = enu_from_ecef(&b.step.truth.position.point).transpose() * Vector3::new(v.y, v.x, -v.z);
            let (rate, sigma) = r.rate_mps.unwrap();
            rates.push(((rate - line.normalize().dot(&(r.velocity_mps - own)) - b.clock.unwrap()[1]) / sigma).powi(2));
            let before = a.phases.iter().zip(ranges(a)).find(|(q, _)| q.satellite == p.satellite);
            if let Some((q, s)) = before {
                let geometry = line.norm() - (s.position.vector() - receiver_position(a)).norm();
                let clock = b.clock.unwrap()[0] - a.clock.unwrap()[0];
                steps.push((p.range.m() - q.range.m() - geometry - clock) / (2.0_f64.sqrt() * p.sigma_white.m()));
            }
        }
    }
    assert_unit_variance(rates, "range rates");
    // Differences that share a phase are not independent: every second epoch's share would halve the number; the variance stays.
    let mean = steps.iter().map(|x| x * x).sum::<f64>() / steps.len() as f64;
    assert!((mean - 1.0).abs() < 4.0 * (2.0 / (0.5 * steps.len() as f64)).sqrt(), "{mean}");
}

#[test]
fn the_clock_walks_as_its_densities_say() {
    let receiver = receiver(plain);
    let walks = (0..4).flat_map(|n| {
        let clocks: Vec<[f64; 2]> = fly(&receiver, n, 300).iter().map(|s| s.clock.unwrap()).collect();
        clocks.windows(2).map(|w| [w[1][0] - w[0][0] - w[0][1], w[1][1] - w[0][1]]).collect::<Vec<_>>()
    });
    let walks: Vec<_> = walks.collect();
    assert_unit_variance(walks.iter().map(|w| w[0] * w[0] / (0.009 + 0.036 / 3.0)), "offset");
    assert_unit_variance(walks.iter().map(|w| w[1] * w[1] / 0.036), "drift");
    // Correlation of the two: Sd/2 over the root of their variances.
    let expected = 0.018 / ((0.009_f64 + 0.012) * 0.036).sqrt();
    let correlation = walks.iter().map(|w| w[0] * w[1]).sum::<f64>() / walks.len() as f64 / ((0.009_f64 + 0.012) * 0.036).sqrt();
    assert!((correlation - expected).abs() < 4.0 * ((1.0 + expected * expected) / walks.len() as f64).sqrt(), "{correlation} {expected}");
}

/// Samples with and without faults, side by side.
fn beside(faults: Vec<SensorFault>, seconds: u64) -> Vec<(Sample, Sample)> {
    fly(&receiver(plain), 0, seconds).into_iter().zip(fly(&faulty(plain, faults), 0, seconds)).collect()
}

#[test]
fn steps_and_ramps_come_when_declared_to_the_satellite_named() {
    let one = ranges(&fly(&receiver(plain), 0, 1)[0])[2].satellite;
    let faults = vec![
        SensorFault::SatelliteStep { start_s: 20.0, duration_s: 10.0, satellite: one.to_string(), step_m: 50.0 },
        SensorFault::SatelliteRamp { start_s: 40.0, duration_s: 10.0, satellite: one.to_string(), rate_mps: 2.0 },
    ];
    for (k, (a, b)) in beside(faults, 60).iter().enumerate() {
        let t = (k + 1) as f64;
        let expected = match t {
            20.0..30.0 => 50.0,
            40.0..50.0 => 2.0 * (t - 40.0),
            _ => 0.0,
        };
        for (r, s) in ranges(a).iter().zip(ranges(b)) {
            let own = if r.satellite == one { expected } else { 0.0 };
            // Ranges of 3e7 m lose 4e-9 m.
            assert!((s.range.unwrap().m() - r.range.unwrap().m() - own).abs() < 1e-7, "{t} {}", r.satellite);
            let drifts = if r.satellite == one && (40.0..50.0).contains(&t) { 2.0 } else { 0.0 };
            assert!((s.rate_mps.unwrap().0 - r.rate_mps.unwrap().0 - drifts).abs() < 1e-9);
        }
    }
}

#[test]
fn interference_takes_every_satellite_and_gives_them_back() {
    let rig = faulty(plain, vec![SensorFault::Interference { start_s: 20.0, duration_s: 10.0 }]);
    let times: Vec<f64> = fly(&rig, 0, 60).iter().map(Sample::since).collect();
    let expected: Vec<f64> = (1..=60).filter(|t| !(20..30).contains(t)).map(f64::from).collect();
    assert_eq!(times, expected);
}

#[test]
fn a_spoofer_draws_every_range_to_one_false_place() {
    let rig = faulty(plain, vec![SensorFault::Spoofing { start_s: 20.0, duration_s: 30.0, right_mps: 3.0, up_mps: -1.0, rates: true }]);
    for sample in fly(&rig, 0, 60) {
        let t = sample.since();
        let pulled = if (20.0..50.0).contains(&t) { t - 20.0 } else { 0.0 };
        let v = &sample.step.truth.velocity_ned_mps;
        let ground = v.x.hypot(v.y);
        let offset = pulled * Vector3::new(3.0 * v.x / ground, -3.0 * v.y / ground, -1.0);
        let place = receiver_position(&sample) + enu_from_ecef(&sample.step.truth.position.point).transpose() * offset;
        let squares = ranges(&sample).into_iter().map(|r| {
            let x = r.range.unwrap().m() - (r.position.vector() - place).norm() - sample.clock.unwrap()[0];
            x / r.sigma_white.m()
        });
        // Noise of unit variance is all that is left: 6 sigma once in 5e8, and 90 m are 180 of them.
        assert!(squares.map(f64::abs).fold(0.0, f64::max) < 6.0, "{t}");
    }
}
