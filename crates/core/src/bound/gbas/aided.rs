//! Covariance of the fix that an inertial system and GBAS-corrected ranges make together (equations 3 and 4).
//!
//! The axes are east-north-up at the airport, which is the Earth-fixed form turned once: every matrix of equation 3 turns with it.
//! The attitude is level and the aircraft neither turns nor accelerates, which leaves its heading unobserved, as on a straight taxiway.

use super::MOST_SATELLITES;
use super::noise::Coloured;
use crate::frame::{Covariance, Enu};
use crate::quantity::{Metres, OutOfDomain, Radians};
use crate::signal::{Constellation, SPEED_OF_LIGHT_MPS};
use crate::spec::gbas::Inertial;
use crate::special::float::sin_cos;
use core::f64::consts::PI;
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

const EARTH_RATE_RADPS: f64 = 7.292_115e-5;
const GRAVITY_MPS2: f64 = 9.806_65;
const EARTH_RADIUS_M: f64 = 6_371_000.0;

/// Position, velocity, attitude, accelerometer and gyro biases, clock and its rate, offsets of other constellations' clocks.
const BASE: usize = 17 + Constellation::ALL.len();
const STATES: usize = BASE + MOST_SATELLITES;
const VELOCITY: usize = 3;
const ATTITUDE: usize = 6;
const ACCELEROMETER: usize = 9;
const GYRO: usize = 12;
const CLOCK: usize = 15;
const RATE: usize = 16;
const OFFSETS: usize = 17;

/// Standard deviations before the first range: none that a range of metres would not replace at once.
const START_POSITION_M: f64 = 100.0;
const START_VELOCITY_MPS: f64 = 10.0;
const START_ATTITUDE_RAD: f64 = 0.02;
const START_CLOCK_M: f64 = 1e4;
const START_RATE_MPS: f64 = 10.0;

/// A satellite of the filter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tracked {
    /// Unit vector from the aircraft to the satellite, east-north-up.
    pub unit: Vector3<f64>,
    /// Whose clock.
    pub constellation: Constellation,
    /// Smoothed multipath of ground and aircraft together.
    pub multipath: Coloured,
    /// Troposphere and ionosphere: new at every measurement.
    pub white: Metres,
}

/// The filter's covariance. About 38 kB, no heap: made once and kept.
#[derive(Debug, Clone)]
pub struct Aided {
    satellites: [Option<Tracked>; MOST_SATELLITES],
    count: usize,
    first: Constellation,
    inertial: Inertial,
    step_s: f64,
    transition: SMatrix<f64, BASE, BASE>,
    driven: SMatrix<f64, BASE, BASE>,
    covariance: [[f64; STATES]; STATES],
}

impl Aided {
    /// Before the first range, at a latitude, for satellites that stand still.
    ///
    /// # Errors
    /// [`OutOfDomain`] for no satellite, more than [`MOST_SATELLITES`], or a step that is not positive and at most 1 s.
    pub fn new(satellites: &[Tracked], latitude: Radians, inertial: &Inertial, step_s: f64) -> Result<Self, OutOfDomain> {
        let value = satellites.len() as f64;
        let Some(first) = satellites.first().filter(|_| satellites.len() <= MOST_SATELLITES) else {
            return Err(OutOfDomain { argument: "n_sv", value, unit: "1", domain: "[1, 48]" });
        };
        if !(step_s > 0.0 && step_s <= 1.0) {
            return Err(OutOfDomain { argument: "step_s", value: step_s, unit: "s", domain: "(0, 1]" });
        }
        let mut kept = [None; MOST_SATELLITES];
        for (slot, s) in kept.iter_mut().zip(satellites) {
            *slot = Some(*s);
        }
        let (transition, driven) = discrete(latitude, inertial, step_s);
        let covariance = start(satellites, first.constellation, inertial);
        let (count, first) = (satellites.len(), first.constellation);
        Ok(Self { satellites: kept, count, first, inertial: *inertial, step_s, transition, driven, covariance })
    }

    /// Covariance of the position.
    pub fn position(&self) -> Covariance<Enu> {
        Covariance::claim_symmetric(Matrix3::from_fn(|i, j| 0.5 * (self.covariance[i][j] + self.covariance[j][i])))
    }

    /// Seconds of moving and measuring.
    pub fn run(&mut self, seconds: f64) {
        let steps = (seconds / self.step_s) as usize;
        for _ in 0..steps {
            self.measure();
            self.wait();
        }
        self.measure();
    }

    /// One step without a measurement.
    fn wait(&mut self) {
        let states = BASE + self.count;
        let base = SMatrix::<f64, BASE, BASE>::from_fn(|i, j| self.covariance[i][j]);
        let moved = self.transition * base * self.transition.transpose() + self.driven;
        // Rounding must not make the two halves drift apart.
        let moved = 0.5 * (moved + moved.transpose());
        for i in 0..BASE {
            self.covariance[i][..BASE].copy_from_slice(moved.row(i).transpose().as_slice());
        }
        let mut kept = [0.0; MOST_SATELLITES];
        for (k, satellite) in self.satellites.iter().flatten().enumerate() {
            kept[k] = satellite.multipath.kept(self.step_s);
            let cross = SVector::<f64, BASE>::from_fn(|i, _| self.covariance[i][BASE + k]);
            let cross = self.transition * cross * kept[k];
            for i in 0..BASE {
                self.covariance[i][BASE + k] = cross[i];
                self.covariance[BASE + k][i] = cross[i];
            }
        }
        for i in BASE..states {
            for j in BASE..states {
                self.covariance[i][j] *= kept[i - BASE] * kept[j - BASE];
            }
        }
        for (k, satellite) in self.satellites.iter().flatten().enumerate() {
            self.covariance[BASE + k][BASE + k] += satellite.multipath.added_m2(self.step_s);
        }
    }

    /// Range and range rate of every satellite, one number at a time.
    fn measure(&mut self) {
        for k in 0..self.count {
            let Some(s) = self.satellites[k] else { continue };
            let mut range = [(0, -s.unit.x), (1, -s.unit.y), (2, -s.unit.z), (CLOCK, 1.0), (BASE + k, 1.0), (0, 0.0)];
            if s.constellation != self.first {
                range[5] = (OFFSETS + s.constellation.index(), 1.0);
            }
            let noise = self.inertial.receiver_noise.m();
            self.update(&range, s.white.m() * s.white.m() + noise * noise);
            let v = VELOCITY;
            let rate = [(v, -s.unit.x), (v + 1, -s.unit.y), (v + 2, -s.unit.z), (RATE, 1.0)];
            self.update(&rate, self.inertial.doppler_mps * self.inertial.doppler_mps);
        }
    }

    /// A measurement that is the sum of `factor * state` and noise.
    fn update(&mut self, row: &[(usize, f64)], noise_m2: f64) {
        let states = BASE + self.count;
        let mut seen = [0.0; STATES];
        for &(state, factor) in row {
            for (sum, p) in seen[..states].iter_mut().zip(&self.covariance[state]) {
                *sum += factor * p;
            }
        }
        let variance = noise_m2 + row.iter().map(|&(state, factor)| factor * seen[state]).sum::<f64>();
        for i in 0..states {
            let gain = seen[i] / variance;
            for (p, s) in self.covariance[i][..states].iter_mut().zip(&seen) {
                *p -= gain * s;
            }
        }
    }
}

fn start(satellites: &[Tracked], first: Constellation, inertial: &Inertial) -> [[f64; STATES]; STATES] {
    let mut covariance = [[0.0; STATES]; STATES];
    for axis in 0..3 {
        for (state, sigma) in [
            (axis, START_POSITION_M),
            (VELOCITY + axis, START_VELOCITY_MPS),
            (ATTITUDE + axis, START_ATTITUDE_RAD),
            (ACCELEROMETER + axis, inertial.accelerometer_bias_mps2),
            (GYRO + axis, inertial.gyro_bias_radps),
        ] {
            covariance[state][state] = sigma * sigma;
        }
    }
    covariance[CLOCK][CLOCK] = START_CLOCK_M * START_CLOCK_M;
    covariance[RATE][RATE] = START_RATE_MPS * START_RATE_MPS;
    for (k, s) in satellites.iter().enumerate() {
        covariance[BASE + k][BASE + k] = s.multipath.initial_m2();
        if s.constellation != first {
            let offset = OFFSETS + s.constellation.index();
            covariance[offset][offset] = START_CLOCK_M * START_CLOCK_M;
        }
    }
    covariance
}

/// Transition over a step and the covariance it adds: the exponential to third order, and the trapezoid of the driven noise.
fn discrete(latitude: Radians, inertial: &Inertial, step_s: f64) -> (SMatrix<f64, BASE, BASE>, SMatrix<f64, BASE, BASE>) {
    let f = dynamics(latitude) * step_s;
    let transition = SMatrix::identity() + f + f * f / 2.0 + f * f * f / 6.0;
    let mut power = SVector::<f64, BASE>::zeros();
    let (accelerometer, gyro) = (inertial.accelerometer_walk_mps_per_root_s, inertial.gyro_walk_rad_per_root_s);
    for axis in 0..3 {
        power[VELOCITY + axis] = accelerometer * accelerometer;
        power[ATTITUDE + axis] = gyro * gyro;
    }
    let light2 = SPEED_OF_LIGHT_MPS * SPEED_OF_LIGHT_MPS;
    power[CLOCK] = light2 * inertial.clock_h0_s / 2.0;
    power[RATE] = light2 * 2.0 * PI * PI * inertial.clock_h_minus_2_per_s;
    let q = SMatrix::<f64, BASE, BASE>::from_diagonal(&power);
    (transition, (q + transition * q * transition.transpose()) * (0.5 * step_s))
}

/// Equation 3: the matrix F of d/dt error = F error.
fn dynamics(latitude: Radians) -> SMatrix<f64, BASE, BASE> {
    let (s, c) = sin_cos(latitude.rad());
    let earth = cross(&Vector3::new(0.0, EARTH_RATE_RADPS * c, EARTH_RATE_RADPS * s));
    let force = cross(&Vector3::new(0.0, 0.0, GRAVITY_MPS2));
    let bend = GRAVITY_MPS2 / EARTH_RADIUS_M;
    let gradient = Matrix3::from_diagonal(&Vector3::new(-bend, -bend, 2.0 * bend));
    let mut f = SMatrix::<f64, BASE, BASE>::zeros();
    let mut put = |row: usize, column: usize, block: Matrix3<f64>| f.fixed_view_mut::<3, 3>(row, column).copy_from(&block);
    put(0, VELOCITY, Matrix3::identity());
    put(VELOCITY, 0, gradient);
    put(VELOCITY, VELOCITY, -2.0 * earth);
    put(VELOCITY, ATTITUDE, -force);
    put(VELOCITY, ACCELEROMETER, -Matrix3::identity());
    put(ATTITUDE, ATTITUDE, -earth);
    put(ATTITUDE, GYRO, -Matrix3::identity());
    f[(CLOCK, RATE)] = 1.0;
    f
}

fn cross(v: &Vector3<f64>) -> Matrix3<f64> {
    v.cross_matrix()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bound::Sight;
    use crate::bound::gbas::noise::Form;
    use crate::bound::gbas::snapshot::Snapshot;
    use crate::geometry::Direction;
    use crate::spec::gbas::INERTIAL;

    fn sky(form: Form) -> Vec<Tracked> {
        let places = [(10.0, 70.0), (60.0, 25.0), (120.0, 40.0), (180.0, 15.0), (230.0, 55.0), (290.0, 20.0), (330.0, 35.0)];
        places
            .iter()
            .map(|&(az, el)| Tracked {
                unit: Direction::new(Radians::degrees(az), Radians::degrees(el)).unwrap().unit(),
                constellation: Constellation::Gps,
                multipath: Coloured::new(Metres::new(0.35), [26.0, 2315.0], form).unwrap(),
                white: Metres::new(0.116),
            })
            .collect()
    }

    fn ratio(form: Form) -> f64 {
        let satellites = sky(form);
        let mut filter = Aided::new(&satellites, Radians::degrees(41.3), &INERTIAL, 1.0).unwrap();
        filter.run(300.0);
        let sigma = Metres::new((0.35_f64 * 0.35 + 0.116 * 0.116).sqrt());
        let ranges: Vec<_> = satellites.iter().map(|s| Sight::corrected(s.unit, s.constellation, sigma, sigma).unwrap()).collect();
        let snapshot = Snapshot::new(&ranges).unwrap();
        let norm = crate::bound::gbas::snapshot::Form::Major;
        norm.deviation(&filter.position()).m() / norm.deviation(snapshot.covariance()).m()
    }

    /// Claim C04 and erratum E7: only the form that bounds nothing is below the snapshot.
    #[test]
    fn the_papers_form_gains_a_little_and_the_bound_costs_much() {
        let (paper, bound) = (ratio(Form::Paper), ratio(Form::Bound));
        assert!(paper > 0.8 && paper < 1.0, "{paper}");
        assert!(bound > 1.2, "{bound}");
    }

    /// With no memory at all and a useless inertial system the filter is the running mean of snapshots, so one measurement is the snapshot.
    #[test]
    fn the_first_measurement_is_the_snapshot() {
        let satellites = sky(Form::Paper);
        let mut filter = Aided::new(&satellites, Radians::degrees(41.3), &INERTIAL, 1.0).unwrap();
        filter.run(0.0);
        let noise = INERTIAL.receiver_noise.m();
        let sigma = Metres::new((0.35_f64 * 0.35 + 0.116 * 0.116 + noise * noise).sqrt());
        let ranges: Vec<_> = satellites.iter().map(|s| Sight::corrected(s.unit, s.constellation, sigma, sigma).unwrap()).collect();
        let snapshot = Snapshot::new(&ranges).unwrap();
        let difference = (filter.position().matrix() - snapshot.covariance().matrix()).amax();
        // The prior of 100 m counts (0.5/100)^2, and the updates cancel 1e8 m² of clock: 1e-8.
        assert!(difference < 1e-4 * snapshot.covariance().matrix().amax(), "{difference}");
    }

    /// Equation 3 in vectors: d/dt of position, velocity, attitude and clock of any error.
    #[test]
    fn the_matrix_of_the_dynamics_is_equation_3() {
        let (s, c) = 0.7_f64.sin_cos();
        let turning = Vector3::new(0.0, 7.292_115e-5 * c, 7.292_115e-5 * s);
        let (g, radius) = (9.806_65, 6_371_000.0);
        let x = SVector::<f64, BASE>::from_fn(|i, _| ((7 * i + 3) % 11) as f64 - 4.5);
        let part = |from: usize| x.fixed_rows::<3>(from).into_owned();
        let (p, v, attitude) = (part(0), part(3), part(6));
        let mut expected = SVector::<f64, BASE>::zeros();
        expected.fixed_rows_mut::<3>(0).copy_from(&v);
        let gravity = Vector3::new(-p.x, -p.y, 2.0 * p.z) * (g / radius);
        let force = Vector3::new(0.0, 0.0, g);
        expected.fixed_rows_mut::<3>(3).copy_from(&(gravity - 2.0 * turning.cross(&v) - force.cross(&attitude) - part(9)));
        expected.fixed_rows_mut::<3>(6).copy_from(&(-turning.cross(&attitude) - part(12)));
        expected[15] = x[16];
        // Sums of numbers below a hundred.
        assert!((dynamics(Radians::new(0.7)) * x - expected).amax() < 1e-13);
    }

    /// The transition is that of a million short steps, the driven noise the trapezoid of what drives it.
    #[test]
    fn a_step_is_many_short_ones() {
        for step_s in [1.0, 0.5] {
            let (transition, driven) = discrete(Radians::new(0.7), &INERTIAL, step_s);
            let mut many = SMatrix::<f64, BASE, BASE>::identity() + dynamics(Radians::new(0.7)) * (step_s / f64::from(1 << 20));
            (0..20).for_each(|_| many = many * many);
            // The fourth term, of which a turning Earth makes 2 w g / 24 = 6e-5 in a second, is left out; the short steps are 1e-5 away.
            assert!((transition - many).amax() < 7e-5, "{}", (transition - many).amax());
            let mut q = SMatrix::<f64, BASE, BASE>::zeros();
            let (force, rate) = (INERTIAL.accelerometer_walk_mps_per_root_s, INERTIAL.gyro_walk_rad_per_root_s);
            for k in 0..3 {
                (q[(3 + k, 3 + k)], q[(6 + k, 6 + k)]) = (force * force, rate * rate);
            }
            let light = 299_792_458.0_f64;
            q[(15, 15)] = 0.5 * INERTIAL.clock_h0_s * light * light;
            q[(16, 16)] = 2.0 * (core::f64::consts::PI * light).powi(2) * INERTIAL.clock_h_minus_2_per_s;
            let expected = (q + many * q * many.transpose()) * (0.5 * step_s);
            for (i, j) in (0..BASE).flat_map(|i| (0..BASE).map(move |j| (i, j))) {
                let scale = (expected[(i, i)] * expected[(j, j)]).sqrt();
                assert!((driven[(i, j)] - expected[(i, j)]).abs() <= 1e-4 * scale, "{i} {j}");
            }
        }
    }

    /// One instant of ranges and rates from what is known before it, all at once: the sum of the information, inverted as a whole.
    #[test]
    fn measurements_one_by_one_are_the_sum_of_their_information() {
        const N: usize = BASE + 7;
        let mut satellites = sky(Form::Bound);
        (4..7).for_each(|k| satellites[k].constellation = Constellation::Galileo);
        let mut filter = Aided::new(&satellites, Radians::degrees(41.3), &INERTIAL, 1.0).unwrap();
        let before = filter.covariance;
        // 100 m, 10 m/s, 0.02 rad, the biases of the unit, 1e4 m and 10 m/s of the clock, 1e4 m of the other clock.
        for (state, sigma) in [
            (0, 100.0),
            (4, 10.0),
            (8, 0.02),
            (9, INERTIAL.accelerometer_bias_mps2),
            (13, INERTIAL.gyro_bias_radps),
            (15, 1e4),
            (16, 10.0),
            (17 + Constellation::Galileo.index(), 1e4),
        ] {
            assert!((before[state][state] / (sigma * sigma) - 1.0).abs() < 1e-15, "{state}");
        }
        assert_eq!(before[17 + Constellation::Gps.index()][17 + Constellation::Gps.index()], 0.0);
        // In deviations of before; what has none has no part.
        let sigma = SVector::<f64, N>::from_fn(|i, _| before[i][i].sqrt());
        let mut information = SMatrix::<f64, N, N>::identity();
        let mut add = |row: SVector<f64, N>, variance: f64| {
            let row = row.component_mul(&sigma);
            information += row * row.transpose() / variance;
        };
        for (k, s) in satellites.iter().enumerate() {
            let (mut range, mut rate) = (SVector::<f64, N>::zeros(), SVector::<f64, N>::zeros());
            range.fixed_rows_mut::<3>(0).copy_from(&-s.unit);
            rate.fixed_rows_mut::<3>(3).copy_from(&-s.unit);
            (range[15], range[BASE + k], rate[16]) = (1.0, 1.0, 1.0);
            if k >= 4 {
                range[17 + Constellation::Galileo.index()] = 1.0;
            }
            add(range, s.white.m().powi(2) + INERTIAL.receiver_noise.m().powi(2));
            add(rate, INERTIAL.doppler_mps.powi(2));
        }
        let after = information.cholesky().unwrap().inverse();
        filter.measure();
        for i in 0..N {
            for j in 0..N {
                let scale = sigma[i] * sigma[j];
                let expected = after[(i, j)] * scale;
                // Clocks of 1e4 m against 0.1 m cost ten of sixteen digits.
                assert!((filter.covariance[i][j] - expected).abs() <= 1e-6 * scale, "{i} {j}: {} {expected}", filter.covariance[i][j]);
            }
        }
        for i in [0, 1, 2, 3, 4, 5, 16] {
            let expected = after[(i, i)] * sigma[i] * sigma[i];
            assert!((filter.covariance[i][i] / expected - 1.0).abs() < 1e-2, "{i}: {} {expected}", filter.covariance[i][i]);
        }
    }

    #[test]
    fn a_filter_without_satellites_is_refused() {
        assert_eq!(Aided::new(&[], Radians::new(0.7), &INERTIAL, 1.0).unwrap_err().argument, "n_sv");
        assert_eq!(Aided::new(&sky(Form::Bound), Radians::new(0.7), &INERTIAL, f64::NAN).unwrap_err().argument, "step_s");
    }
}
