//! How errors of an inertial navigator grow: the phi-angle model in north, east, down.
//!
//! States 0 to 14: position (metres north, east, down), velocity, misalignment phi, gyroscope biases, accelerometer biases. Position,
//! velocity: estimate minus truth; `C_estimated = (1 - [phi x]) C`; biases: what is left of them, truth minus estimate.

use super::strapdown::{Local, Step};
use nalgebra::{Matrix3, Vector3};

/// Position, velocity and attitude.
pub(super) const MOTION: usize = 9;
/// With the biases.
pub(super) const NAV: usize = 15;
/// Blocks of the state.
pub(super) const R: usize = 0;
pub(super) const V: usize = 3;
pub(super) const PHI: usize = 6;
pub(super) const BG: usize = 9;
pub(super) const BA: usize = 12;
/// Columns of a row, padded to whole vectors.
pub(super) const LINE: usize = 12;

/// The motion rows of the transition, transposed: `t[k][i]` is what state k adds to motion state i.
pub(super) type Transition = [[f64; LINE]; NAV];

/// Transition over a step.
///
/// ```text
/// dr' = F_rr dr + dv                                F_rr: a longitude's metres shrink with latitude, all grow with height
/// dv' = f x phi + C b_a - (2 w_ie + w_en) x dv - (2 dw_ie + dw_en) x v + (0, 0, 2 g/R) dr_D
/// phi' = dw_in - w_in x phi - C b_g                 dw_in = dw_ie(dr_N) + dw_en(dv, dr)
/// Phi = 1 + F dt, and of F^2 dt^2 / 2 what the specific force and the biases make:
///       r <- phi: dt/2 [F x],  r <- b_a: dt^2/2 C,  v <- b_g: -dt/2 [F x] C,   F = f dt
/// ```
///
/// There is no -g/R on horizontal position: it belongs to the psi-angle form, and both together count Schuler twice. The rest of
/// F² dt²/2 holds products of rates, below (1.5e-4 dt)², and is left out. Provenance: re-derived as the derivative of
/// the mechanization, which a test compares with differences of the mechanization itself.
pub(super) fn transition(step: &Step) -> Transition {
    let (dt, f, c) = (step.dt, step.force_dt.cross_matrix(), &step.c);
    let rates = rates(&step.earth);
    let mut t = [[0.0; LINE]; NAV];
    put(&mut t, R, R, &(Matrix3::identity() + rates.rr * dt));
    put(&mut t, R, V, &Matrix3::from_diagonal_element(dt));
    put(&mut t, R, PHI, &(f * (0.5 * dt)));
    put(&mut t, R, BA, &(c * (0.5 * dt * dt)));
    put(&mut t, V, R, &(rates.vr * dt));
    put(&mut t, V, V, &(Matrix3::identity() + rates.vv * dt));
    put(&mut t, V, PHI, &f);
    put(&mut t, V, BG, &(f * c * (-0.5 * dt)));
    put(&mut t, V, BA, &(c * dt));
    put(&mut t, PHI, R, &(rates.phi_r * dt));
    put(&mut t, PHI, V, &(rates.phi_v * dt));
    put(&mut t, PHI, PHI, &(Matrix3::identity() - (step.earth.earth + step.earth.transport).cross_matrix() * dt));
    put(&mut t, PHI, BG, &(c * -dt));
    t
}

/// What the Earth adds to F: block by block, row then column.
struct Rates {
    rr: Matrix3<f64>,
    vr: Matrix3<f64>,
    vv: Matrix3<f64>,
    phi_r: Matrix3<f64>,
    phi_v: Matrix3<f64>,
}

fn rates(e: &Local) -> Rates {
    let (v, tan) = (&e.v, e.sin / e.cos);
    let (m, n) = (1.0 / e.north, 1.0 / e.east);
    let rr = Matrix3::new(-v.z * m, 0.0, v.x * m, v.y * tan * m, -v.z * n - tan * v.x * m, v.y * n, 0.0, 0.0, 0.0);
    // Turning of the axes for a velocity, for a metre north and for a metre down.
    let by_velocity = Matrix3::new(0.0, n, 0.0, -m, 0.0, 0.0, 0.0, -tan * n, 0.0);
    let earth_by_north = Vector3::new(e.earth.z * m, 0.0, -e.earth.x * m);
    let transport_by_north = Vector3::new(0.0, 0.0, -v.y * m * n / (e.cos * e.cos));
    let by_down = Vector3::new(v.y * n * n, -v.x * m * m, -v.y * tan * n * n);
    let zero = Vector3::zeros();
    let mut vr = Matrix3::from_columns(&[v.cross(&(2.0 * earth_by_north + transport_by_north)), zero, v.cross(&by_down)]);
    vr[(2, 2)] += 2.0 * e.gravity * m;
    let vv = v.cross_matrix() * by_velocity - (2.0 * e.earth + e.transport).cross_matrix();
    let phi_r = Matrix3::from_columns(&[earth_by_north + transport_by_north, zero, by_down]);
    Rates { rr, vr, vv, phi_r, phi_v: by_velocity }
}

/// Block `m` of the rows from `row` and the states from `column`, transposed in place.
fn put(t: &mut Transition, row: usize, column: usize, m: &Matrix3<f64>) {
    for i in 0..3 {
        for k in 0..3 {
            t[column + k][row + i] = m[(i, k)];
        }
    }
}

/// exp(-x) for the small steps of a slow process; four terms up to a hundredth leave 1e-12 of x.
pub(super) fn decay(x: f64) -> f64 {
    if x < 0.01 {
        return 1.0 - x * (1.0 - x * (0.5 - x * (1.0 / 6.0 - x / 24.0)));
    }
    crate::special::float::exp(-x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::{Geodetic, LatLon};
    use crate::quantity::{GpsTime, Metres, Radians};
    use crate::signal::ImuIncrement;
    use crate::solution::ins::state::{Attitude, NavState, turn};
    use crate::solution::ins::strapdown::Strapdown;

    const DT: f64 = 0.01;

    fn flight(lat: f64, velocity: Vector3<f64>) -> NavState {
        let point = LatLon::new(Radians::new(lat), Radians::new(2.0)).unwrap();
        let attitude = Attitude { roll: Radians::new(0.35), pitch: Radians::new(0.1), heading: Radians::new(2.2) };
        NavState::new(GpsTime::default(), &Geodetic { point, height: Metres::new(9000.0) }, velocity, &attitude).unwrap()
    }

    fn sample() -> ImuIncrement {
        ImuIncrement {
            time: GpsTime::default().plus_seconds(DT),
            interval_s: DT,
            angle_rad: Vector3::new(0.02, -0.01, 0.03) * DT,
            velocity_mps: Vector3::new(1.0, -0.5, -11.0) * DT,
        }
    }

    /// The state with one error, in the sense of the error states.
    fn disturbed(state: &NavState, sample: &ImuIncrement, k: usize, error: f64) -> (NavState, ImuIncrement) {
        let (mut s, mut u) = (*state, *sample);
        let local = Local::at(s.lat, s.h, &s.v);
        let unit = Vector3::from_fn(|i, _| if i == k % 3 { error } else { 0.0 });
        match k {
            0 => s.lat += error / local.north,
            1 => s.lon += error / (local.east * local.cos),
            2 => s.h -= error,
            3..6 => s.v += unit,
            6..9 => s.q = turn(&-unit) * s.q,
            9..12 => u.angle_rad += unit * DT,
            _ => u.velocity_mps += unit * DT,
        }
        (s, u)
    }

    /// Error of `b` against `a` after a step, position in the metres of the place where `a` is.
    fn difference(a: &NavState, b: &NavState) -> [f64; MOTION] {
        let local = Local::at(a.lat, a.h, &a.v);
        let v = b.v - a.v;
        // C_b = (1 - [phi x]) C_a.
        let turned = b.ned_from_body() * a.ned_from_body().transpose();
        let sine = 0.5 * Vector3::new(turned[(1, 2)] - turned[(2, 1)], turned[(2, 0)] - turned[(0, 2)], turned[(0, 1)] - turned[(1, 0)]);
        let phi = if sine.norm() > 0.0 { sine * (sine.norm().asin() / sine.norm()) } else { sine };
        [(b.lat - a.lat) * local.north, (b.lon - a.lon) * local.east * local.cos, a.h - b.h, v.x, v.y, v.z, phi[0], phi[1], phi[2]]
    }

    /// Column after column against central differences of the mechanization. What the transition leaves out is second order in the
    /// rates: F² dt²/2 beyond the kept parts, up to 3e-4 dt²/2 = 1.5e-8 for a position from a velocity (Coriolis), and up to f * 2e-4 dt²
    /// = 2e-7 for a velocity from an angle, with third differences of the angles (1e-6 of f dt); the change of the meridian radius with
    /// latitude (1e-2 e² v/R) is smaller.
    #[test]
    fn the_transition_is_the_derivative_of_the_mechanization() {
        for (lat, velocity) in [(0.7, Vector3::new(170.0, -120.0, 5.0)), (-1.2, Vector3::new(-30.0, 240.0, -12.0))] {
            let (state, sample) = (flight(lat, velocity), sample());
            let mut plain = Strapdown::new(state);
            let t = transition(&plain.step(&sample).unwrap());
            let error = [1000.0, 1000.0, 1000.0, 10.0, 10.0, 10.0, 1e-3, 1e-3, 1e-3, 1e-3, 1e-3, 1e-3, 0.1, 0.1, 0.1];
            for k in 0..NAV {
                let end = |e: f64| {
                    let (s, u) = disturbed(&state, &sample, k, e);
                    let mut run = Strapdown::new(s);
                    run.step(&u).unwrap();
                    difference(plain.state(), run.state())
                };
                let (up, down) = (end(error[k]), end(-error[k]));
                for i in 0..MOTION {
                    let difference = (up[i] - down[i]) / (2.0 * error[k]);
                    let allowed = if k >= 6 && i < 6 { 3e-6 } else { 2e-8 };
                    assert!((difference - t[k][i]).abs() < allowed, "state {k} to {i}: {difference:e} {:e}", t[k][i]);
                }
            }
        }
    }

    /// A north error of 1 km for a quarter of the Schuler period, undisturbed: the velocity must swing back by gravity through the
    /// misalignment, dr(t) stays (phi is an error against the true axes), and nothing grows as with -g/R added once more.
    #[test]
    fn gravity_pulls_a_tilt_at_schulers_rate_once() {
        let local = Local::at(0.0, 0.0, &Vector3::zeros());
        let step = Step { dt: 1.0, force_dt: Vector3::new(0.0, 0.0, -local.gravity), c: Matrix3::identity(), earth: local };
        let t = transition(&step);
        // Position, velocity and tilt about east from a velocity error of 1 m/s north; vertical channel and Earth rate stay out of it.
        let (mut r, mut v, mut phi) = (0.0, 1.0, 0.0);
        let schuler = (local.gravity / local.north).sqrt();
        let mut most = 0.0f64;
        for k in 1..5065 {
            let next = t[V][R] * v + r + t[PHI + 1][R] * phi;
            let dv = t[PHI + 1][V] * phi + t[R][V] * r;
            phi += t[V][PHI + 1] * v;
            v += dv;
            r = next;
            // The closed form v = cos(w t); Euler's steps of 1 s lag by w dt / 2 = 6e-4 and grow by w² t / 2 = 0.4 %.
            most = most.max((v - (schuler * f64::from(k)).cos()).abs());
        }
        assert!(most < 0.006, "{most}");
    }
}
