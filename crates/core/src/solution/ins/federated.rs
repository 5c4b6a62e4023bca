//! The federated form: a filter for the satellites, one for the stations and the altimeter, and a master that joins them.
//!
//! Both filters live on the same inertial unit and the same start, so their errors are related. To each, start and unit are declared worse
//! than they are, its variances over its share b of the information; then the errors of both are bounded as if they were independent:
//!
//! ```text
//! [P P; P P]  <=  [P/b1 0; 0 P/b2],   b1 + b2 = 1         (start and process noise; as matrices)
//! x = x1 + K (x2 - x1),   K = P1 (P1 + P2)^-1,   V = P1 - K P1
//! ```
//!
//! The variant without reset: the master never writes back. So neither filter ever learns from the other's measurements, a false
//! measurement stays in its own filter, and the one without satellites is a witness against the other. The cost: V is an upper bound, not
//! the covariance, and a filter alone is worse than one with the true values. With a reset to V/b after each fusion V would be the optimum, and
//! whatever deceives one filter would be in both. Source: Carlson, federated square root filter, 1990 (the text was not read); provenance: inferred
//! formulas, equal shares ours.

use super::dynamics::{BA, BG, NAV, PHI, R, V};
use super::filter::{Filter, Solution};
use super::mode::Mode;
use super::settings::{SensorNoise, Settings, StartSigma};
use super::strapdown::Local;
use crate::frame::Covariance;
use crate::quantity::{Metres, Radians};
use crate::special::float::sqrt;
use nalgebra::{SMatrix, SVector, Vector3};

/// Share of the information of start and inertial unit that each of both filters is given.
const SHARE: f64 = 0.5;

type Joint = SMatrix<f64, NAV, NAV>;

/// What is declared to a filter of the federation of start and inertial unit: standard deviations over the root of its share.
pub(super) fn shared(sigma: &StartSigma, settings: &Settings) -> (StartSigma, Settings) {
    let wider = 1.0 / sqrt(SHARE);
    let noise = |n: &SensorNoise| SensorNoise { white: n.white * wider, bias: n.bias * wider, bias_time_s: n.bias_time_s };
    let mut shared_settings = *settings;
    shared_settings.imu.gyroscope = noise(&settings.imu.gyroscope);
    shared_settings.imu.accelerometer = noise(&settings.imu.accelerometer);
    shared_settings.gap_acceleration_mps2 *= wider;
    shared_settings.gap_rate_radps *= wider;
    shared_settings.resumption = settings.resumption.wider(wider);
    let start = StartSigma {
        position: sigma.position.map(|s| Metres::new(s.m() * wider)),
        velocity_mps: sigma.velocity_mps * wider,
        attitude: sigma.attitude.map(|s| Radians::new(s.rad() * wider)),
    };
    (start, shared_settings)
}

/// What both say together. The first alone where the sum of both covariances is not positive, which no filter that runs leaves behind.
pub(super) fn master(first: &mut Filter, second: &mut Filter) -> Solution {
    let (mut joined, other) = (first.latest(), second.latest());
    let (p1, p2) = (navigation(first), navigation(second));
    let Some(both) = (p1 + p2).cholesky() else { return joined };
    // Column by column (P1 + P2)^-1 P1 is K'.
    let gain = both.solve(&p1).transpose();
    // The errors of the first are to become e1 + K (e2 - e1).
    let x = -(gain * errors_between(&joined, &other));
    let part = |k: usize| Vector3::new(x[k], x[k + 1], x[k + 2]);
    joined.state.correct(&part(R), &part(V), &part(PHI));
    joined.biases[0] += part(BG);
    joined.biases[1] += part(BA);
    let p = p1 - gain * p1;
    let p = (p + p.transpose()) * 0.5;
    let block = |k: usize| p.fixed_view::<3, 3>(k, k).into_owned();
    let r = block(R);
    joined.covariance = Covariance::from_upper([r[(1, 1)], r[(0, 1)], r[(0, 0)], -r[(1, 2)], -r[(0, 2)], r[(2, 2)]]);
    joined.velocity_m2ps2 = block(V);
    joined.attitude_rad2 = block(PHI);
    joined.mode = if [joined.mode, other.mode].contains(&Mode::Aligning) { Mode::Aligning } else { joined.mode.max(other.mode) };
    joined
}

/// Covariance of the navigation states, brought up to the last sample by [`Filter::latest`].
fn navigation(filter: &Filter) -> Joint {
    Joint::from_fn(|i, j| filter.joint.get(i, j))
}

/// Errors of the second less those of the first, in the sense of the error states.
fn errors_between(first: &Solution, second: &Solution) -> SVector<f64, NAV> {
    let (a, b) = (&first.state, &second.state);
    let local = Local::at(a.lat, a.h, &a.v);
    let lon = super::state::wrapped(b.lon - a.lon);
    let r = Vector3::new((b.lat - a.lat) * local.north, lon * local.east * local.cos, a.h - b.h);
    let turned = b.ned_from_body() * a.ned_from_body().transpose();
    // C2 = (1 - [d x]) C1; the sine for the angle is off by its cube over six.
    let phi = 0.5 * Vector3::new(turned[(1, 2)] - turned[(2, 1)], turned[(2, 0)] - turned[(0, 2)], turned[(0, 1)] - turned[(1, 0)]);
    let (v, biases) = (b.v - a.v, [first.biases[0] - second.biases[0], first.biases[1] - second.biases[1]]);
    SVector::from_fn(|k, _| match k / 3 {
        0 => r[k - R],
        1 => v[k - V],
        2 => phi[k - PHI],
        3 => biases[0][k - BG],
        _ => biases[1][k - BA],
    })
}
