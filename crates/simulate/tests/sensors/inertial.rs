//! The inertial unit's errors have the statistics that its settings declare.

use super::common::{Rig, Sample, all, assert_unit_variance, perfect, rig};
use nalgebra::{Matrix3, Vector3};
use navbound_simulate::{Imu, SensorFault};

/// Errors of rate and force.
type Errors = Vec<[Vector3<f64>; 2]>;

/// What a unit adds to a perfect one, sample by sample, on flights from 0.
fn errors(imu: Imu, flights: u64, seconds: u64) -> Vec<Errors> {
    let truth = all(&with(perfect()), 0, seconds);
    let rig = with(imu);
    let difference = |(a, b): (&Sample, Sample)| {
        let (a, b) = (&a.step.imu, &b.step.imu);
        [(b.angle_rad - a.angle_rad) / a.interval_s, (b.velocity_mps - a.velocity_mps) / a.interval_s]
    };
    (0..flights).map(|n| truth.iter().zip(all(&rig, n, seconds)).map(difference).collect()).collect()
}

fn with(imu: Imu) -> Rig {
    rig(|s| {
        (s.imu, s.gnss, s.dme, s.vor, s.baro) = (imu, None, None, None, None);
    })
}

#[test]
fn white_noise_has_the_allan_variance_of_a_random_walk() {
    let imu = Imu { gyro_noise_radprts: 1e-4, accelerometer_noise_mpsprts: 1e-2, ..perfect() };
    let errors = &errors(imu, 1, 900)[0];
    // Allan variance of white noise of density N over averages of T: N^2 / T, at T of one sample and of ten.
    for (kind, density) in [(0, 1e-4), (1, 1e-2)] {
        for axis in 0..3 {
            for group in [1, 10] {
                let time = 0.1 * group as f64;
                let means: Vec<f64> = errors.chunks(group).map(|c| c.iter().map(|e| e[kind][axis]).sum::<f64>() / group as f64).collect();
                // Every second difference, so that they are independent.
                let differences = means.chunks_exact(2).map(|m| m[1] - m[0]);
                assert_unit_variance(differences.map(|d| d * d / (2.0 * density * density / time)), "Allan variance");
            }
        }
    }
}

#[test]
fn every_flight_turns_on_with_biases_of_its_own() {
    let imu = Imu { gyro_bias_radps: 1e-6, accelerometer_bias_mps2: 1e-3, ..perfect() };
    let flights = errors(imu, 60, 2);
    for (kind, sigma) in [(0, 1e-6), (1, 1e-3)] {
        let first = |axis: usize| flights.iter().map(move |f| f[0][kind][axis] / sigma);
        assert_unit_variance((0..3).flat_map(first).map(|x| x * x), "turn-on bias");
        // Constant over the flight; increments of 1e-2 m/s lose 1e-16 of it, over the interval and the bias 1e-11 of a rate.
        assert!(flights.iter().all(|f| f.iter().all(|e| (e[kind] - f[0][kind]).amax() < 1e-6 * sigma)));
    }
}

#[test]
fn the_in_run_bias_forgets_with_its_correlation_time() {
    let imu = Imu { gyro_in_run_radps: 1e-6, accelerometer_in_run_mps2: 1e-3, in_run_time_s: 20.0, ..perfect() };
    let flights = errors(imu, 60, 42);
    for (kind, sigma) in [(0, 1e-6), (1, 1e-3)] {
        let at = |second: usize| flights.iter().flat_map(move |f| (0..3).map(move |axis| f[10 * second][kind][axis] / sigma));
        assert_unit_variance(at(0).map(|x| x * x), "in-run bias at the begin");
        assert_unit_variance(at(40).map(|x| x * x), "in-run bias later");
        // x(20) - x(0) / e has variance 1 - 1/e^2 and nothing of x(0).
        let fresh: Vec<f64> = at(20).zip(at(0)).map(|(b, a)| (b - a * (-1.0_f64).exp()) / (1.0 - (-2.0_f64).exp()).sqrt()).collect();
        assert_unit_variance(fresh.iter().map(|x| x * x), "what is new after a correlation time");
        let shared = fresh.iter().zip(at(0)).map(|(x, a)| x * a).sum::<f64>() / fresh.len() as f64;
        assert!(shared.abs() < 4.0 / (fresh.len() as f64).sqrt(), "{shared}");
    }
}

/// The matrix that makes the errors of rates (0) or forces (1) of the motion, by least squares.
fn distortion(truth: &[Sample], errors: &[[Vector3<f64>; 2]], kind: usize) -> Matrix3<f64> {
    let (mut normal, mut right) = (Matrix3::zeros(), Matrix3::zeros());
    for (sample, error) in truth.iter().zip(errors) {
        let imu = &sample.step.imu;
        let felt = [imu.angle_rad, imu.velocity_mps][kind] / imu.interval_s;
        normal += felt * felt.transpose();
        right += error[kind] * felt.transpose();
    }
    right * normal.try_inverse().unwrap()
}

#[test]
fn scale_and_misalignment_follow_the_motion() {
    let imu =
        Imu { gyro_scale: 1e-3, accelerometer_scale: 2e-3, gyro_misalignment_rad: 3e-3, accelerometer_misalignment_rad: 4e-3, ..perfect() };
    // Up to the end of the second turn: every axis turns.
    let truth = all(&with(perfect()), 0, 700);
    let flights = errors(imu, 30, 700);
    for (kind, scale, misalignment) in [(0, 1e-3, 3e-3), (1, 2e-3, 4e-3)] {
        let distortions: Vec<_> = flights.iter().map(|e| distortion(&truth, e, kind)).collect();
        let diagonal = distortions.iter().flat_map(|d| (0..3).map(move |i| d[(i, i)] / scale));
        assert_unit_variance(diagonal.map(|x| x * x), "scale");
        let across = distortions.iter().flat_map(|d| [(0, 1), (0, 2), (1, 0), (1, 2), (2, 0), (2, 1)].map(|place| d[place] / misalignment));
        assert_unit_variance(across.map(|x| x * x), "misalignment");
    }
}

#[test]
fn a_bias_jump_comes_when_declared_and_stays() {
    let jump = |s: &mut navbound_simulate::Sensors| {
        (s.imu, s.gnss, s.dme, s.vor, s.baro) = (perfect(), None, None, None, None);
        s.faults = vec![SensorFault::ImuBiasJump { start_s: 100.25, gyro_radps: [1e-3, 0.0, 0.0], accelerometer_mps2: [0.0, -0.5, 0.0] }];
    };
    let (truth, jumped) = (all(&with(perfect()), 0, 300), all(&rig(jump), 0, 300));
    for (k, (a, b)) in truth.iter().zip(&jumped).enumerate() {
        // The sample whose interval begins after the jump is the first to feel it: 100.3 s.
        let felt: f64 = if k >= 1003 { 1.0 } else { 0.0 };
        let (a, b) = (&a.step.imu, &b.step.imu);
        assert!((b.angle_rad - a.angle_rad - felt * Vector3::new(1e-4, 0.0, 0.0)).amax() < 1e-15, "{k}");
        assert!((b.velocity_mps - a.velocity_mps + felt * Vector3::new(0.0, 0.05, 0.0)).amax() < 1e-14, "{k}");
    }
}
