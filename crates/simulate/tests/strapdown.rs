//! Without sensor errors a strapdown run over the increments comes back to the truth: position, velocity and attitude are of one motion,
//! and the increments are its integrals.
#![allow(clippy::unwrap_used)] // A test may stop at the first surprise, its helpers too.

use nalgebra::Vector3;
use navbound_core::frame::{earth_rate_ned, gravity_of, radii};
use navbound_core::quantity::Radians;
use navbound_core::signal::ImuIncrement;
use navbound_simulate::{Imu, Motion, PathFlown, Scenario, Sensing, Sensors};

/// Plain arrays: two hours at 200 Hz without an optimizer.
type V = [f64; 3];

fn cross(a: V, b: V) -> V {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
fn plus(a: V, b: V, k: f64) -> V {
    [a[0] + k * b[0], a[1] + k * b[1], a[2] + k * b[2]]
}
fn array(v: &Vector3<f64>) -> V {
    [v.x, v.y, v.z]
}

/// A quaternion from a rotation vector; angles of a sample are below 1e-2 rad, the next terms below 1e-17.
fn small_turn(r: V) -> [f64; 4] {
    let q = r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
    let s = 0.5 - q / 48.0 + q * q / 3840.0;
    [1.0 - q / 8.0 + q * q / 384.0, s * r[0], s * r[1], s * r[2]]
}
fn times(a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
    [
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    ]
}
/// v + 2 w (q x v) + 2 q x (q x v)
fn turned(q: [f64; 4], v: V) -> V {
    let u = [q[1], q[2], q[3]];
    let t = cross(u, v);
    plus(plus(v, t, 2.0 * q[0]), cross(u, t), 2.0)
}

/// An integrator of its own: two-sample coning and sculling, position by the trapezoid, Coriolis and gravity at the middle of the step.
struct Strapdown {
    lat: f64,
    lon: f64,
    height: f64,
    v: V,
    ned_from_body: [f64; 4],
    before: (V, V),
    v_before: V,
}

impl Strapdown {
    fn new(start: &Motion, before: (V, V)) -> Self {
        let rotation = nalgebra::Rotation3::from_matrix_unchecked(start.ned_from_body);
        let q = nalgebra::UnitQuaternion::from_rotation_matrix(&rotation);
        let v = array(&start.velocity_ned_mps);
        Self {
            lat: start.position.point.lat().rad(),
            lon: start.position.point.lon().rad(),
            height: start.position.height.m(),
            v,
            ned_from_body: [q.w, q.i, q.j, q.k],
            before,
            v_before: v,
        }
    }

    fn step(&mut self, imu: &ImuIncrement) {
        let h = imu.interval_s;
        let (angle, force) = (array(&imu.angle_rad), array(&imu.velocity_mps));
        // Velocity and place at the middle of the step, from the last two velocities.
        let v_mid = plus(self.v, plus(self.v, self.v_before, -1.0), 0.5);
        let r = radii(Radians::new(self.lat));
        let lat_mid = self.lat + 0.5 * h * 0.5 * (self.v[0] + v_mid[0]) / (r.meridian.m() + self.height);
        let height_mid = self.height - 0.25 * h * (self.v[2] + v_mid[2]);
        let (s, c) = lat_mid.sin_cos();
        let r = radii(Radians::new(lat_mid));
        let (rn, rm) = (r.prime_vertical.m() + height_mid, r.meridian.m() + height_mid);
        let earth = array(&earth_rate_ned(s, c));
        let transport = [v_mid[1] / rn, -v_mid[0] / rm, -v_mid[1] * s / (c * rn)];
        // Velocity.
        let mut body = plus(force, cross(angle, force), 0.5);
        // 1e-7 m/s² in a turn; the unstable height makes a hundred metres of it in two hours.
        body = plus(body, cross(angle, cross(angle, force)), 1.0 / 6.0);
        body = plus(body, cross(self.before.0, force), 1.0 / 12.0);
        body = plus(body, cross(self.before.1, angle), 1.0 / 12.0);
        let frame = plus(earth, transport, 1.0);
        let pushed = turned(self.ned_from_body, body);
        let pushed = plus(pushed, cross(frame, pushed), -0.5 * h);
        let coriolis = cross(plus(frame, earth, 1.0), v_mid);
        let mut v = plus(plus(self.v, pushed, 1.0), coriolis, -h);
        v[2] += gravity_of(s * s, height_mid) * h;
        // Position.
        let mean = plus(plus(self.v, v, 1.0), [0.0; 3], 0.0).map(|x| 0.5 * x);
        self.lat += mean[0] * h / rm;
        self.lon += mean[1] * h / (rn * c);
        self.height -= mean[2] * h;
        // Attitude.
        let coning = plus(angle, cross(self.before.0, angle), 1.0 / 12.0);
        let q = times(times(small_turn(frame.map(|w| -w * h)), self.ned_from_body), small_turn(coning));
        let norm = (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]).sqrt();
        self.ned_from_body = q.map(|x| x / norm);
        (self.v_before, self.v, self.before) = (self.v, v, (angle, force));
    }

    fn distances_m(&self, truth: &Motion) -> [f64; 3] {
        let p = &truth.position;
        let r = radii(p.point.lat());
        let north = (self.lat - p.point.lat().rad()) * (r.meridian.m() + p.height.m());
        let east = (self.lon - p.point.lon().rad()) * (r.prime_vertical.m() + p.height.m()) * p.point.lat().rad().cos();
        [north, east, self.height - p.height.m()]
    }
}

fn perfect() -> Imu {
    Imu {
        gyro_bias_radps: 0.0,
        gyro_in_run_radps: 0.0,
        gyro_noise_radprts: 0.0,
        gyro_scale: 0.0,
        gyro_misalignment_rad: 0.0,
        accelerometer_bias_mps2: 0.0,
        accelerometer_in_run_mps2: 0.0,
        accelerometer_noise_mpsprts: 0.0,
        accelerometer_scale: 0.0,
        accelerometer_misalignment_rad: 0.0,
        in_run_time_s: 3600.0,
    }
}

fn scenario(path: PathFlown) -> Scenario {
    let mut scenario: Scenario = serde_json::from_str(include_str!("beijing-shanghai.json")).unwrap();
    scenario.sensors = Some(Sensors {
        envelope: None,
        path,
        rate_hz: 200,
        imu: perfect(),
        gnss: None,
        dme: None,
        vor: None,
        baro: None,
        stations: vec![],
        faults: vec![],
    });
    scenario
}

/// Largest north, east and up distance on the way, and the distances at the end.
fn run(path: PathFlown, seconds: u64) -> ([f64; 3], [f64; 3]) {
    let sensing = Sensing::new(scenario(path), None).unwrap();
    let trajectory = sensing.trajectory(1, 0).unwrap();
    let mut flight = sensing.flight(&trajectory, 1, 0).unwrap();
    let start = *flight.now();
    let h = 0.005;
    // Before the begin the first polynomial goes on: increments there close the two-sample terms of the first step.
    let before = (array(&(start.rate_radps * h)), array(&(start.force_mps2 * h)));
    let mut ins = Strapdown::new(&start, before);
    let (mut worst, mut last) = ([0.0_f64; 3], [0.0; 3]);
    for _ in 0..(200 * seconds).min(flight.samples()) {
        let step = flight.advance().unwrap().unwrap();
        ins.step(&step.imu);
        last = ins.distances_m(&step.truth);
        for i in 0..3 {
            worst[i] = worst[i].max(last[i].abs());
        }
    }
    (worst, last)
}

#[test]
fn an_error_free_strapdown_run_closes_to_a_metre_in_two_hours() {
    let (worst, last) = run(PathFlown::Planned, 7081);
    assert!(worst.iter().all(|d| *d < 1.0), "{worst:?}, at the end {last:?}");
}

#[test]
fn so_it_does_along_a_flight_in_gusts() {
    // Half an hour: the unstable height has grown 23-fold.
    let (worst, last) = run(PathFlown::Flown, 1800);
    assert!(worst.iter().all(|d| *d < 0.01), "{worst:?}, at the end {last:?}");
}
