//! The flown path as a curve smooth enough for inertial sensors: quintic B-splines in latitude, longitude and height over time.
//!
//! Ours. Position is four times continuously differentiable, so specific force and rates of turn follow by analysis, and a strapdown run
//! without sensor errors closes. Between two knots the curve is one quintic polynomial: the blend at arc ends, at changes of speed and at
//! changes of the rate of climb. With knots every 4 s a bank of 20 degrees builds up in some six seconds.
//!
//! ```text
//! control = p - (p[-1] - 2 p + p[+1]) / 4        a steady turn then keeps its radius: the spline's second moment is half a spacing squared
//! ```
//!
//! The height has no steady curvature and takes its points as they are, so that the blend never dips below the runway.
//! The attitude is that of coordinated flight without drift and without angle of attack: yaw and pitch along the velocity, and
//! `tan(bank) = V * turn rate / g`.

use crate::flight::FlownEpoch;
use crate::outlook::Outlook;
use crate::plan::GRAVITY;
use core::f64::consts::{PI, TAU};
use nalgebra::{Matrix3, Vector3};
use navbound_core::frame::{ECCENTRICITY_SQUARED, Geodetic, LatLon, SEMI_MAJOR, earth_rate_ned, gravity_of};
use navbound_core::quantity::{Metres, OutOfDomain, Radians};

/// Time between knots of a flight \[s\].
const SPACING_S: f64 = 4.0;
/// Time between knots of a way on wheels, whose turns last some seconds \[s\].
const WHEELS_SPACING_S: f64 = 1.0;
/// Control points before the begin, and after the end.
const MARGIN: usize = 3;
/// Fewest positions of a way on wheels.
const WHEELS_LEAST: usize = 10;
/// Beyond this latitude longitudes change too fast for a spline in them \[rad\]: 89 degrees.
const LATITUDE_MOST_RAD: f64 = 89.0 * PI / 180.0;
/// Below this speed over the ground a course has no meaning \[m/s\].
const SPEED_LEAST_MPS: f64 = 1e-3;

/// Powers of u in the six basis functions of a uniform quintic B-spline, times 120.
const BASIS: [[f64; 6]; 6] = [
    [1.0, -5.0, 10.0, -10.0, 5.0, -1.0],
    [26.0, -50.0, 20.0, 20.0, -20.0, 5.0],
    [66.0, 0.0, -60.0, 0.0, 30.0, -10.0],
    [26.0, 50.0, 20.0, -20.0, -20.0, 10.0],
    [1.0, 5.0, 10.0, 10.0, 5.0, -5.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
];

/// The true motion of the aircraft at an instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// Where the sensors are; every sensor sits in one place.
    pub position: Geodetic,
    /// Velocity over the ground north, east, down \[m/s\].
    pub velocity_ned_mps: Vector3<f64>,
    /// Rotation from body axes (forward, right, down) to north, east, down.
    pub ned_from_body: Matrix3<f64>,
    /// Specific force, body axes \[m/s²\].
    pub force_mps2: Vector3<f64>,
    /// Angular rate against inertial space, body axes \[rad/s\].
    pub rate_radps: Vector3<f64>,
}

impl Motion {
    /// Roll, pitch and yaw \[rad\]; yaw clockwise from true north in (-pi, pi].
    pub fn roll_pitch_yaw_rad(&self) -> [f64; 3] {
        let c = &self.ned_from_body;
        [c[(2, 1)].atan2(c[(2, 2)]), (-c[(2, 0)]).clamp(-1.0, 1.0).asin(), c[(1, 0)].atan2(c[(0, 0)])]
    }
}

/// A flown path.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory {
    /// Control points of latitude, longitude \[rad\] and height \[m\], the first `MARGIN` spacings before the begin.
    controls: [Vec<f64>; 3],
    duration_s: f64,
    spacing_s: f64,
    /// Whether it banks into its turns.
    banks: bool,
}

impl Trajectory {
    /// Along the plan, without technical error but for the blends: some metres where the curvature changes.
    ///
    /// # Errors
    /// [`OutOfDomain`] for a path within one degree of a pole or an aircraft that does not move.
    pub fn planned(outlook: &Outlook) -> Result<Self, OutOfDomain> {
        let plan = &outlook.plan;
        // Before the begin the aircraft stands still.
        Self::through(outlook.scenario.duration_s, SPACING_S, |time_s| {
            let demand = plan.profile.at(time_s.max(0.0));
            let point = plan.route.at(Metres::new(demand.along_m))?.point;
            Ok([point.lat().rad(), point.lon().rad(), demand.height_m])
        })
    }

    /// Through the true positions of a flight, technical error and gusts included; what is faster than the knots is smoothed.
    ///
    /// # Errors
    /// As [`Trajectory::planned`]; [`OutOfDomain`] for a flight of less than two epochs.
    pub fn flown(outlook: &Outlook, epochs: &[FlownEpoch]) -> Result<Self, OutOfDomain> {
        if epochs.len() < 2 {
            return Err(OutOfDomain { argument: "epochs", value: epochs.len() as f64, unit: "items", domain: "two or more" });
        }
        let last = (epochs.len() - 1) as f64;
        let at = |second: f64| epochs[second as usize].truth;
        Self::through(outlook.scenario.duration_s, SPACING_S, |time_s| {
            let time_s = time_s.max(0.0);
            // Beyond the last epoch, less than a second before the end, the flight goes straight on.
            let (second, over) = if time_s > last { (last, time_s - last) } else { (time_s.floor(), time_s - time_s.floor()) };
            let (from, to) = if second < last { (at(second), at(second + 1.0)) } else { (at(last - 1.0), at(last)) };
            let begin = if second < last { from } else { to };
            Ok(core::array::from_fn(|i| begin[i] + over * nearest_turn(to[i] - from[i], i)))
        })
    }

    /// On wheels through positions (latitude, longitude \[rad\], height \[m\]) at whole seconds: it turns without bank. It comes and goes
    /// straight on.
    ///
    /// # Errors
    /// [`OutOfDomain`] for fewer than ten positions or one that is not finite; as [`Trajectory::planned`].
    pub fn on_wheels(positions: &[[f64; 3]]) -> Result<Self, OutOfDomain> {
        let n = positions.len();
        if n < WHEELS_LEAST {
            return Err(OutOfDomain { argument: "position", value: n as f64, unit: "seconds", domain: "ten or more" });
        }
        if let Some(bad) = positions.iter().flatten().find(|x| !x.is_finite()) {
            return Err(OutOfDomain { argument: "position", value: *bad, unit: "rad or m", domain: "finite numbers" });
        }
        let last = n - 1;
        let trajectory = Self::through(last as f64, WHEELS_SPACING_S, |time_s| {
            let k = time_s.round().clamp(-(last as f64), last as f64) as i64;
            let at = |k: i64| positions[k.unsigned_abs() as usize];
            let (first, ahead) = (at(0), at(k));
            Ok(if k >= 0 { ahead } else { core::array::from_fn(|i| first[i] - nearest_turn(ahead[i] - first[i], i)) })
        })?;
        Ok(Self { banks: false, ..trajectory })
    }

    /// From positions (latitude, longitude \[rad\], height \[m\]) as a function of time up to the duration. After the end the aircraft goes
    /// straight on.
    fn through(duration_s: f64, spacing_s: f64, position: impl Fn(f64) -> Result<[f64; 3], OutOfDomain>) -> Result<Self, OutOfDomain> {
        let pieces = (duration_s / spacing_s).ceil() as usize;
        let (first, last) = (position(0.0)?, position(duration_s)?);
        let count = pieces + 1 + 2 * (MARGIN + 1);
        let mut points: [Vec<f64>; 3] = core::array::from_fn(|_| Vec::with_capacity(count));
        for k in 0..count {
            let time = (k as f64 - (MARGIN + 1) as f64) * spacing_s;
            let p = if time > duration_s {
                let back = position(2.0 * duration_s - time)?;
                core::array::from_fn(|i| last[i] + nearest_turn(last[i] - back[i], i))
            } else {
                position(time)?
            };
            for i in 0..3 {
                let before = points[i].last().copied().unwrap_or(first[i]);
                points[i].push(before + nearest_turn(p[i] - before, i));
            }
        }
        let kept = |p: &Vec<f64>| (1..count - 1).map(|k| p[k]).collect();
        let sharpened = |p: &Vec<f64>| (1..count - 1).map(|k| p[k] - 0.25 * (p[k - 1] - 2.0 * p[k] + p[k + 1])).collect();
        let controls = [sharpened(&points[0]), sharpened(&points[1]), kept(&points[2])];
        let trajectory = Self { controls, duration_s, spacing_s, banks: true };
        trajectory.check(pieces)?;
        Ok(trajectory)
    }

    fn check(&self, pieces: usize) -> Result<(), OutOfDomain> {
        for &lat in &self.controls[0] {
            if !(lat.abs() <= LATITUDE_MOST_RAD) {
                return Err(OutOfDomain {
                    argument: "lat_rad",
                    value: lat,
                    unit: "rad",
                    domain: "[-89, 89] degrees along a sensed flight",
                });
            }
        }
        for k in 0..pieces {
            let v = self.cursor().at(k as f64 * self.spacing_s)?.velocity_ned_mps;
            if !(v.x.hypot(v.y) >= SPEED_LEAST_MPS) {
                return Err(OutOfDomain { argument: "ground speed", value: v.x.hypot(v.y), unit: "m/s", domain: "[0.001, inf)" });
            }
        }
        Ok(())
    }

    /// How long it lasts \[s\].
    pub fn duration_s(&self) -> f64 {
        self.duration_s
    }

    /// Something that walks along it and works out each polynomial once.
    pub fn cursor(&self) -> Cursor<'_> {
        Cursor { trajectory: self, piece: Piece::of(self, 0) }
    }
}

/// A difference, of longitudes taken the short way.
fn nearest_turn(difference: f64, coordinate: usize) -> f64 {
    if coordinate == 1 { difference - TAU * (difference / TAU).round() } else { difference }
}

/// One polynomial of the spline.
#[derive(Debug, Clone, Copy)]
struct Piece {
    index: usize,
    /// The control point at its begin, from which the polynomials count: no digits are lost.
    base: [f64; 3],
    powers: [[f64; 6]; 3],
}

impl Piece {
    fn of(trajectory: &Trajectory, index: usize) -> Self {
        let mut powers = [[0.0; 6]; 3];
        let mut base = [0.0; 3];
        for i in 0..3 {
            let c = &trajectory.controls[i][index + MARGIN - 2..index + MARGIN + 4];
            base[i] = c[2];
            for (control, basis) in c.iter().zip(&BASIS) {
                for p in 0..6 {
                    powers[i][p] += (control - base[i]) * basis[p] / 120.0;
                }
            }
        }
        Self { index, base, powers }
    }

    /// A coordinate and its first three derivatives in time, `u` of a spacing after the begin; `rate` spacings a second.
    fn derivatives(&self, i: usize, u: f64, rate: f64) -> [f64; 4] {
        let p = &self.powers[i];
        let value = p[0] + u * (p[1] + u * (p[2] + u * (p[3] + u * (p[4] + u * p[5]))));
        let first = p[1] + u * (2.0 * p[2] + u * (3.0 * p[3] + u * (4.0 * p[4] + u * 5.0 * p[5])));
        let second = 2.0 * p[2] + u * (6.0 * p[3] + u * (12.0 * p[4] + u * 20.0 * p[5]));
        let third = 6.0 * p[3] + u * (24.0 * p[4] + u * 60.0 * p[5]);
        [self.base[i] + value, first * rate, second * rate * rate, third * rate * rate * rate]
    }
}

/// A place on a trajectory.
#[derive(Debug, Clone)]
pub struct Cursor<'a> {
    trajectory: &'a Trajectory,
    piece: Piece,
}

impl Cursor<'_> {
    /// The motion at a time after the begin \[s\]; a little before the begin and after the end the outermost polynomials go on.
    ///
    /// # Errors
    /// [`OutOfDomain`] for a time that is not finite.
    pub fn at(&mut self, time_s: f64) -> Result<Motion, OutOfDomain> {
        if !time_s.is_finite() {
            return Err(OutOfDomain { argument: "time_s", value: time_s, unit: "s", domain: "finite times" });
        }
        let last = self.trajectory.controls[0].len() - 2 * MARGIN - 2;
        let rate = 1.0 / self.trajectory.spacing_s;
        let index = ((time_s * rate).max(0.0) as usize).min(last);
        if index != self.piece.index {
            self.piece = Piece::of(self.trajectory, index);
        }
        let u = time_s * rate - index as f64;
        let [lat, lon, height] = [0, 1, 2].map(|i| self.piece.derivatives(i, u, rate));
        motion(lat, lon, height, self.trajectory.banks)
    }
}

/// Velocity north, east, down with its first two derivatives, and what else the inertial quantities need.
struct Velocity {
    v: Vector3<f64>,
    a: Vector3<f64>,
    j: Vector3<f64>,
}

/// ```text
/// v_n = (M + h) lat'      v_e = (N + h) cos(lat) lon'      v_d = -h'      d(N cos lat)/dlat = -M sin lat
/// ```
fn velocity(sine: f64, cosine: f64, lat: &[f64; 4], lon: &[f64; 4], height: &[f64; 4]) -> Velocity {
    const Q: f64 = ECCENTRICITY_SQUARED;
    let w2 = 1.0 - Q * sine * sine;
    let n = SEMI_MAJOR.m() / w2.sqrt();
    let m = n * (1.0 - Q) / w2;
    let m1 = 3.0 * Q * sine * cosine * m / w2;
    let m2 = 3.0 * Q * m * ((cosine * cosine - sine * sine) / w2 + 5.0 * Q * sine * sine * cosine * cosine / (w2 * w2));
    let (a0, a1) = (m + height[0], m1 * lat[1] + height[1]);
    let a2 = m2 * lat[1] * lat[1] + m1 * lat[2] + height[2];
    let (b0, b1) = ((n + height[0]) * cosine, height[1] * cosine - a0 * sine * lat[1]);
    let b2 = height[2] * cosine - height[1] * sine * lat[1] - a1 * sine * lat[1] - a0 * (cosine * lat[1] * lat[1] + sine * lat[2]);
    Velocity {
        v: Vector3::new(a0 * lat[1], b0 * lon[1], -height[1]),
        a: Vector3::new(a0 * lat[2] + a1 * lat[1], b0 * lon[2] + b1 * lon[1], -height[2]),
        j: Vector3::new(a0 * lat[3] + 2.0 * a1 * lat[2] + a2 * lat[1], b0 * lon[3] + 2.0 * b1 * lon[2] + b2 * lon[1], -height[3]),
    }
}

/// ```text
/// f_n  = v' + (2 w_ie + w_en) x v - g            w_en = (lon' cos lat, -lat', -lon' sin lat)
/// w_ib = w_nb + C_bn' (w_ie + w_en)              tan(roll) = side / g,  side = V yaw', or no roll
/// ```
fn motion(lat: [f64; 4], lon: [f64; 4], height: [f64; 4], banks: bool) -> Result<Motion, OutOfDomain> {
    let (sine, cosine) = lat[0].sin_cos();
    let Velocity { v, a, j } = velocity(sine, cosine, &lat, &lon, &height);
    let earth = earth_rate_ned(sine, cosine);
    let transport = Vector3::new(lon[1] * cosine, -lat[1], -lon[1] * sine);
    let gravity = Vector3::new(0.0, 0.0, gravity_of(sine * sine, height[0]));
    let force = a + (2.0 * earth + transport).cross(&v) - gravity;
    let (ned_from_body, turning) = attitude(&v, &a, &j, banks);
    let body_from_ned = ned_from_body.transpose();
    let longitude = if lon[0].abs() <= PI { lon[0] } else { nearest_turn(lon[0], 1) };
    Ok(Motion {
        position: Geodetic { point: LatLon::new(Radians::new(lat[0]), Radians::new(longitude))?, height: Metres::new(height[0]) },
        velocity_ned_mps: v,
        ned_from_body,
        force_mps2: body_from_ned * force,
        rate_radps: turning + body_from_ned * (earth + transport),
    })
}

/// Rotation from body to local axes, and the rate of the body against them in body axes.
fn attitude(v: &Vector3<f64>, a: &Vector3<f64>, j: &Vector3<f64>, banks: bool) -> (Matrix3<f64>, Vector3<f64>) {
    let ground2 = v.x * v.x + v.y * v.y;
    let ground = ground2.sqrt();
    let speed2 = ground2 + v.z * v.z;
    let ground_rate = (v.x * a.x + v.y * a.y) / ground;
    let side = (v.x * a.y - v.y * a.x) / ground;
    let side_rate = (v.x * j.y - v.y * j.x) / ground - side * ground_rate / ground;
    let yaw_rate = side / ground;
    let pitch_rate = (v.z * ground_rate - ground * a.z) / speed2;
    let (lean, lean_rate) = if banks { (side, side_rate) } else { (0.0, 0.0) };
    let lift2 = GRAVITY * GRAVITY + lean * lean;
    let roll_rate = lean_rate * GRAVITY / lift2;
    let (sy, cy) = (v.y / ground, v.x / ground);
    let (sp, cp) = (-v.z / speed2.sqrt(), ground / speed2.sqrt());
    let (sr, cr) = (lean / lift2.sqrt(), GRAVITY / lift2.sqrt());
    let rotation = Matrix3::new(
        cp * cy,
        sr * sp * cy - cr * sy,
        cr * sp * cy + sr * sy,
        cp * sy,
        sr * sp * sy + cr * cy,
        cr * sp * sy - sr * cy,
        -sp,
        sr * cp,
        cr * cp,
    );
    let turning = Vector3::new(roll_rate - yaw_rate * sp, pitch_rate * cr + yaw_rate * cp * sr, yaw_rate * cp * cr - pitch_rate * sr);
    (rotation, turning)
}
