//! The covariance under millions of updates, and against the plain formulas.
#![allow(clippy::unwrap_used)] // A test may stop at the first surprise, in its helpers too.

use super::covariance::{BASE, Fade, Joint, Row, StepNoise, WIDTH};
use super::dynamics::{LINE, NAV, Transition};
use nalgebra::SMatrix;

/// States of the tests: navigation and nine further.
const FURTHER: usize = 9;
const N: usize = NAV + FURTHER;
type Dense = SMatrix<f64, N, N>;

/// Uniform in (-1, 1): a multiplicative generator of Lehmer, its modulus 2^31 - 1.
struct Draw(u64);
impl Draw {
    fn next(&mut self) -> f64 {
        self.0 = self.0 * 48_271 % 2_147_483_647;
        self.0 as f64 / 1_073_741_823.5 - 1.0
    }
}

/// Place in the joint matrix of a state of the tests.
fn place(k: usize) -> usize {
    if k < NAV { k } else { BASE + k - NAV }
}

fn dense(joint: &Joint) -> Dense {
    Dense::from_fn(|i, j| joint.get(place(i), place(j)))
}

fn filled(variances: &[f64; NAV], further: f64) -> Joint {
    let mut joint = Joint::new(variances);
    joint.resize(FURTHER);
    (0..FURTHER).for_each(|k| joint.reset(BASE + k, further));
    joint
}

fn random_transition(draw: &mut Draw, size: f64) -> Transition {
    let mut t = [[0.0; LINE]; NAV];
    for (k, row) in t.iter_mut().enumerate() {
        for (i, x) in row[..9].iter_mut().enumerate() {
            // The structure of the error dynamics: gyroscopes do not reach position, accelerometers not the attitude.
            let absent = (i < 3 && (9..12).contains(&k)) || (i >= 6 && k >= 12);
            *x = if absent { 0.0 } else { size * draw.next() };
        }
        if k < 9 {
            row[k] += 1.0;
        }
    }
    t
}

fn noise(scale: f64) -> StepNoise {
    let bias = |factor| Fade { factor, variance: scale * 0.1 };
    StepNoise { velocity: scale, angle: 0.5 * scale, gyroscope: bias(0.999), accelerometer: bias(0.998) }
}

/// Phi P Phi' with all matrices written out, and the noise half before and half after, over steps between which further states wait.
#[test]
fn steps_are_the_dense_product() {
    let mut draw = Draw(11);
    let mut joint = filled(&core::array::from_fn(|k| 1.0 + k as f64), 4.0);
    // Something shared between all states first.
    for _ in 0..20 {
        let row = (0..6).fold(Row::empty(), |row, _| row.with(place(((draw.next() + 1.0) * 0.5 * N as f64) as usize), draw.next()));
        joint.update(&row, 0.0, 0.5, &mut [0.0; WIDTH]);
    }
    let mut expected = dense(&joint);
    let fades: [Fade; FURTHER] = core::array::from_fn(|k| Fade { factor: 1.0 - 0.01 * k as f64, variance: 0.02 * k as f64 });
    let q = noise(0.01);
    for _ in 0..7 {
        let t = random_transition(&mut draw, 0.1);
        joint.propagate(&t, &q);
        let phi = Dense::from_fn(|i, k| match (i, k) {
            (0..9, 0..NAV) => t[k][i],
            (9..12, _) if i == k => q.gyroscope.factor,
            (12..NAV, _) if i == k => q.accelerometer.factor,
            _ => f64::from(u8::from(i == k)),
        });
        let half = Dense::from_fn(|i, j| match i {
            _ if i != j => 0.0,
            3..6 => 0.5 * q.velocity,
            6..9 => 0.5 * q.angle,
            9..12 => 0.5 * q.gyroscope.variance,
            12..NAV => 0.5 * q.accelerometer.variance,
            _ => 0.0,
        });
        expected = phi * (expected + half) * phi.transpose() + half;
    }
    joint.settle(&fades);
    let fade = Dense::from_fn(|i, j| {
        if i != j {
            0.0
        } else if i < NAV {
            1.0
        } else {
            fades[i - NAV].factor
        }
    });
    let added = Dense::from_fn(|i, j| if i == j && i >= NAV { fades[i - NAV].variance } else { 0.0 });
    expected = fade * expected * fade + added;
    // Some hundred roundings of numbers up to the largest element.
    assert!((dense(&joint) - expected).amax() < 1e-13 * expected.amax(), "{:e}", (dense(&joint) - expected).amax());
}

/// A linear problem at once: prior and all measurements in one normal equation, solved by its inverse.
#[test]
fn updates_one_by_one_are_the_batch_least_squares() {
    let mut draw = Draw(5);
    let mut joint = filled(&[2.0; NAV], 2.0);
    let mut x = [0.0; WIDTH];
    let mut information = Dense::from_diagonal_element(0.5);
    let mut right = SMatrix::<f64, N, 1>::zeros();
    for _ in 0..60 {
        let (mut row, mut h) = (Row::empty(), SMatrix::<f64, N, 1>::zeros());
        for _ in 0..5 {
            let (k, value) = ((((draw.next() + 1.0) * 0.5) * N as f64) as usize, draw.next());
            row = row.with(place(k), value);
            h[k] += value;
        }
        let (z, r) = (draw.next(), 0.3);
        joint.update(&row, z, r, &mut x);
        information += h * h.transpose() / r;
        right += h * (z / r);
    }
    let expected = information.try_inverse().unwrap();
    let best = expected * right;
    // Condition number of the normal matrix below 1e3: thirteen digits stay.
    assert!((dense(&joint) - expected).amax() < 1e-12);
    assert!((0..N).all(|k| (x[place(k)] - best[k]).abs() < 1e-12));
}

/// Precise updates among rough ones (deviations from 1 m to 1 mm against a start of 1 km, a ratio of variances of 1e12; doubles hold 1e16)
/// with little noise between: Cholesky's factor exists all along, and the matrix is symmetric to the bit.
fn stays_positive(n: usize, rounds: usize) {
    let mut draw = Draw(2026);
    let mut joint = filled(&[1e6; NAV], 1e6);
    joint.resize(n - NAV);
    let q = noise(1e-10);
    let fades = [Fade { factor: 0.999, variance: 1e-8 }; FURTHER];
    let mut x = [0.0; WIDTH];
    for round in 0..rounds {
        for _ in 0..100 {
            let row = (0..4).fold(Row::empty(), |row, _| row.with(place((((draw.next() + 1.0) * 0.5) * n as f64) as usize), draw.next()));
            let sigma = 10f64.powf(1.5 * draw.next() - 1.5);
            joint.update(&row, 0.0, sigma * sigma, &mut x);
        }
        joint.propagate(&random_transition(&mut draw, 0.01), &q);
        joint.settle(&fades[..n - NAV]);
        if round % 100 == 0 {
            // States out of use count as ones of their own, so that one size of matrix serves.
            let p = dense(&joint);
            let p = Dense::from_fn(|i, j| if i < n && j < n { p[(i, j)] } else { f64::from(u8::from(i == j)) });
            assert_eq!(p, p.transpose());
            // Scaled to correlations first, as its entries may differ by twenty powers of ten.
            let d = p.map_diagonal(|v| 1.0 / v.sqrt());
            assert!(d.iter().all(|v| v.is_finite()), "round {round}");
            assert!(Dense::from_fn(|i, j| p[(i, j)] * d[i] * d[j]).cholesky().is_some(), "round {round}");
        }
    }
}

#[test]
fn the_covariance_stays_positive_under_two_million_updates() {
    stays_positive(NAV, 20_000);
}

#[test]
fn the_covariance_stays_positive_with_further_states() {
    stays_positive(N, 500);
}
