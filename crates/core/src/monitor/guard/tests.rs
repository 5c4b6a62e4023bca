//! The covariance of the difference against draws, the risk of its test, and the unit's plausibility.

use super::*;
use crate::bound::araim::single::Requirement;
use crate::frame::{EcefPosition, Geodetic, LatLon, ecef_from_geodetic, enu_from_ecef};
use crate::quantity::{Metres, Radians};
use crate::signal::{Aiding, Constellation, DmeRange, PositionFix, SatelliteRange};
use crate::solution::ins::{Attitude, ErrorModel, ImuModel, NavState, SensorNoise, Settings as FilterSettings, StartSigma};
use crate::solution::snapshot::{Snapshot, SnapshotVelocity};
use crate::solution::wls::horizontal_axes;
use nalgebra::Vector3;

/// Uniform, then normal, by a generator whose period is beyond any test.
struct Draw(u64);

impl Draw {
    fn uniform(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64 + 1e-17
    }
    fn normal(&mut self) -> f64 {
        (-2.0 * self.uniform().ln()).sqrt() * (core::f64::consts::TAU * self.uniform()).cos()
    }
}

/// A body at rest on a turning Earth; eight satellites that stand still, each with a slow error.
pub(super) struct World {
    draw: Draw,
    position: Geodetic,
    slow: [f64; 8],
    second: u32,
}

const SLOW_M: f64 = 3.0;
const WHITE_M: f64 = 1.0;
const TAU_S: f64 = 1000.0;

impl World {
    pub(super) fn new(seed: u64) -> Self {
        let point = LatLon::new(Radians::new(0.7), Radians::new(2.0)).unwrap();
        let mut draw = Draw(seed);
        let slow = core::array::from_fn(|_| SLOW_M * draw.normal());
        Self { draw, position: Geodetic { point, height: Metres::new(1000.0) }, slow, second: 0 }
    }

    pub(super) fn time(&self) -> GpsTime {
        GpsTime::default().plus_seconds(f64::from(self.second))
    }

    /// The filter starts wrong by its deviations.
    pub(super) fn filter(&mut self) -> Fusion {
        // The unit of this world is perfect, and the filter knows that.
        let perfect = SensorNoise { white: 1e-12, bias: 1e-12, bias_time_s: 3600.0 };
        let mut settings = FilterSettings::of(ImuModel { gyroscope: perfect, accelerometer: perfect });
        settings.errors = ErrorModel::Correlated;
        settings.reversion = false;
        let sigma = StartSigma { position: [Metres::new(5.0); 3], velocity_mps: 1e-6, attitude: [Radians::new(1e-9); 3] };
        let by = Vector3::from_fn(|_, _| 5.0 * self.draw.normal());
        let start = self.position.moved(&Displacement::<Enu>::from_vector(by)).unwrap();
        let level = Attitude { roll: Radians::new(0.0), pitch: Radians::new(0.0), heading: Radians::new(0.0) };
        Fusion::new(NavState::new(self.time(), &start, Vector3::zeros(), &level).unwrap(), &sigma, settings).unwrap()
    }

    /// A filter that believes in biases of this deviation of its accelerometers, started where its deviations put it.
    pub(super) fn filter_with(&mut self, bias_mps2: f64) -> Fusion {
        let perfect = SensorNoise { white: 1e-12, bias: 1e-12, bias_time_s: 3600.0 };
        let accelerometer = SensorNoise { white: 1e-4, bias: bias_mps2, bias_time_s: 3600.0 };
        let settings = FilterSettings::of(ImuModel { gyroscope: perfect, accelerometer });
        let sigma = StartSigma { position: [Metres::new(5.0); 3], velocity_mps: 0.5, attitude: [Radians::new(1e-9); 3] };
        let by = Vector3::from_fn(|_, _| 5.0 * self.draw.normal());
        let velocity = Vector3::from_fn(|_, _| 0.5 * self.draw.normal());
        let start = self.position.moved(&Displacement::<Enu>::from_vector(by)).unwrap();
        let level = Attitude { roll: Radians::new(0.0), pitch: Radians::new(0.0), heading: Radians::new(0.0) };
        Fusion::new(NavState::new(self.time(), &start, velocity, &level).unwrap(), &sigma, settings).unwrap()
    }

    pub(super) fn ranges(&mut self) -> Vec<TimedAiding> {
        let here = ecef_from_geodetic(&self.position);
        let enu = enu_from_ecef(&self.position.point);
        let keep = (-1.0 / TAU_S).exp();
        (0..8u8)
            .map(|k| {
                let (az, el) = (f64::from(k) * 0.9, 0.3 + 0.15 * f64::from(k));
                let unit = Vector3::new(el.cos() * az.sin(), el.cos() * az.cos(), el.sin());
                let slow = &mut self.slow[usize::from(k)];
                *slow = keep * *slow + (1.0 - keep * keep).sqrt() * SLOW_M * self.draw.normal();
                let range = 2.2e7 + *slow + WHITE_M * self.draw.normal() + 40.0;
                TimedAiding {
                    time: GpsTime::default().plus_seconds(f64::from(self.second)),
                    aiding: Aiding::Satellite(SatelliteRange {
                        satellite: SatelliteId { constellation: Constellation::Gps, number: k + 1 },
                        position: EcefPosition::from_vector(here.vector() + enu.transpose() * unit * 2.2e7),
                        velocity_mps: Vector3::zeros(),
                        range: Some(Metres::new(range)),
                        sigma_white: Metres::new(WHITE_M),
                        sigma_correlated: Metres::new(SLOW_M),
                        sigma_first: Metres::new(SLOW_M),
                        correlation_time_s: TAU_S,
                        rate_mps: None,
                    }),
                }
            })
            .collect()
    }

    /// A second passes; what a unit at rest delivers.
    pub(super) fn sample(&mut self) -> ImuIncrement {
        self.second += 1;
        let lat = self.position.point.lat();
        let rate = crate::frame::earth_rate_ned(lat.rad().sin(), lat.rad().cos());
        let g = crate::frame::gravity_mps2(lat, self.position.height);
        ImuIncrement { time: self.time(), interval_s: 1.0, angle_rad: rate, velocity_mps: Vector3::new(0.0, 0.0, -g) }
    }
}

/// The normalised square of the difference without inflation, after some instants of use and some without.
fn squares(used: u32, unused: u32) -> Vec<f64> {
    (0..600_u32)
        .map(|run| {
            let mut world = World::new(0x9e37_79b9_7f4a_7c15 ^ (u64::from(run) << 20) ^ 0x1234_5678);
            (0..10).for_each(|_| {
                world.draw.uniform();
            });
            let mut filter = world.filter();
            for k in 0..used + unused {
                filter.advance(&world.sample());
                let ranges = world.ranges();
                if k < used {
                    filter.aid(&ranges);
                }
            }
            filter.advance(&world.sample());
            let ranges = world.ranges();
            let snapshot = Solver::default().position(world.time(), &judgeable(&ranges)).unwrap();
            let d = filter.against(&snapshot).unwrap();
            super::super::consistency::normalised_square(&d.position, &d.covariance).unwrap()
        })
        .collect()
}

/// 600 draws of chi-square with three degrees of freedom: the mean is 3 ± 0.1, four deviations either way. `S + P` without what both share
/// would give 2.2 where the ranges are used, `S - P` has no root where they are not.
#[test]
fn the_covariance_of_the_difference_is_that_of_draws_with_ranges_used_and_unused() {
    for (used, unused) in [(15, 0), (5, 30)] {
        let all = squares(used, unused);
        let mean = all.iter().sum::<f64>() / all.len() as f64;
        assert!((mean - 3.0).abs() < 0.4, "{used} {unused}: {mean}");
    }
}

/// Biases, starts and positions drawn as they are declared: the variance of an estimate is the share that is explained. 300 draws of three axes:
/// the mean square is 1 ± 0.05, four deviations either way; without the form, over the declared variance, it is a tenth to a half of that.
#[test]
fn an_estimated_bias_varies_by_what_the_measurements_explain() {
    const BIAS_MPS2: f64 = 0.02;
    let (mut sum, mut over_declared) = (0.0, 0.0);
    for run in 0..300_u64 {
        let mut world = World::new(0x9e37_79b9_7f4a_7c15 ^ (run << 20) ^ 0x1234_5678);
        let mut filter = world.filter_with(BIAS_MPS2);
        let bias = Vector3::from_fn(|_, _| BIAS_MPS2 * world.draw.normal());
        for _ in 0..20 {
            let sample = world.sample();
            filter.advance(&ImuIncrement { velocity_mps: sample.velocity_mps + bias, ..sample });
            let noise = Vector3::from_fn(|_, _| 3.0 * world.draw.normal());
            let position = world.position.moved(&Displacement::<Enu>::from_vector(noise)).unwrap();
            let covariance = Covariance::claim_symmetric(nalgebra::Matrix3::identity() * 9.0);
            let fix = PositionFix { position, covariance, velocity_ned_mps: None, level_m: None };
            filter.aid(&[TimedAiding { time: world.time(), aiding: Aiding::Fix(fix) }]);
        }
        for b in &filter.bias_estimates()[3..] {
            sum += b.of_declared * b.of_declared / b.explained / 900.0;
            over_declared += b.of_declared * b.of_declared / 900.0;
        }
    }
    assert!((sum - 1.0).abs() < 0.19 && over_declared < 0.6, "{sum} {over_declared}");
}

/// The limits are those of the law: 42.2 and 38.0 are printed in the method's description to three digits.
#[test]
fn the_limits_are_those_of_chi_square_at_the_risk() {
    let [two, one] = [2.0, 1.0].map(|dof| chi_square_factor(dof, TEST_RISK));
    assert!((two - 42.2).abs() < 0.05 && (one - 38.0).abs() < 0.05, "{two} {one}");
    // Two degrees of freedom in closed form.
    assert!((two + 2.0 * TEST_RISK.ln()).abs() < 1e-9);
}

fn envelope() -> Envelope {
    Envelope { range: [98.0, 7.0], most: [34.3, 1.05], change_mps3: 50.0, never_repeats: true }
}

fn sample(k: i64, force: Vector3<f64>, rate: Vector3<f64>) -> ImuIncrement {
    ImuIncrement { time: GpsTime::from_nanoseconds(k * 10_000_000), interval_s: 0.01, angle_rad: rate * 0.01, velocity_mps: force * 0.01 }
}

/// Samples until the first that cannot be right, of a unit that is healthy for a second and then does what is given.
fn seen_after(fault: impl Fn(i64, Vector3<f64>, Vector3<f64>) -> (Vector3<f64>, Vector3<f64>)) -> Option<i64> {
    let mut unit = Plausibility::new(envelope());
    let mut draw = Draw(0xdead_beef_cafe);
    let mut noise = move |size: f64| Vector3::from_fn(|_, _| size * draw.normal());
    for k in 0..400 {
        let (force, rate) = (Vector3::new(0.0, 0.0, -9.8) + noise(0.01), noise(1e-4));
        let (force, rate) = if k >= 100 { fault(k, force, rate) } else { (force, rate) };
        if !unit.holds(&sample(k, force, rate), Some(0.1)) {
            return Some(k - 100);
        }
    }
    None
}

#[test]
fn a_unit_is_doubted_for_what_it_delivers_and_a_healthy_one_is_not() {
    assert_eq!(seen_after(|_, f, w| (f, w)), None);
    assert_eq!(seen_after(|_, f, w| (f + Vector3::new(2.0, 0.0, 0.0), w)), None, "two metres a second squared are flown");
    assert_eq!(seen_after(|_, f, w| (f + Vector3::new(49.0, 0.0, 0.0), w)), Some(0));
    assert_eq!(seen_after(|_, f, w| (f, w + Vector3::new(0.0, 1.1, 0.0))), Some(0));
    let still = Vector3::new(1e-5, 2e-5, 3e-5);
    assert_eq!(seen_after(|_, f, _| (f, still)), Some(3), "four samples of the same gyroscopes");
    assert_eq!(seen_after(|_, _, w| (Vector3::new(0.1, 0.0, -9.8), w)), Some(2), "clipped at the largest of the flight, or frozen");
    assert_eq!(seen_after(|_, _, _| (Vector3::zeros(), Vector3::zeros())).map(|k| k <= 10), Some(true));
    assert!(seen_after(|_, f, w| (Vector3::new(f.x, f.y, f.z.max(-2.0)), w)).is_some(), "a fifth of the weight");
    assert_eq!(seen_after(|_, f, w| (f * f64::NAN, w)), Some(0));
}

pub(super) const SETTINGS: Settings = Settings {
    envelope: Envelope::NONE,
    requirement: Requirement::RAIM,
    age_sigma_s: 0.1,
    gap_most_s: 0.5,
    age_most_s: 2.0,
    restart_after_s: 5.0,
};

#[test]
fn a_carried_level_grows_by_what_the_filter_lost_and_by_the_envelope_of_the_unit() {
    let mut world = World::new(3);
    let mut filter = world.filter();
    filter.advance(&world.sample());
    let time = world.time();
    let solution = filter.solution(time).unwrap();
    // What a second later a filter would state that has lost: three times the deviations.
    let lost = Solution { covariance: Covariance::claim_symmetric(*solution.covariance.matrix() * 9.0), ..solution };
    let sigma = [horizontal_axes(&solution.covariance).0.m(), solution.covariance.matrix()[(2, 2)].sqrt()];
    for (most, [force, rate]) in [([0.5, 1e-3], [0.5, 1e-3]), ([f64::INFINITY; 2], [0.01, 1e-5])] {
        let settings = Settings { envelope: Envelope { most, ..Envelope::NONE }, ..SETTINGS };
        let mut guard = Guard::new(settings).unwrap();
        assert!(guard.carry(time, None, Some(&solution)).is_none(), "no level has been");
        let facts = SnapshotFacts { time, ranges_agree: RangesAgree::Yes, level_m: Some([10.0, 20.0]), distance_m: Some([1.5, 2.5]) };
        let now = guard.carry(time, Some(&facts), Some(&solution)).unwrap();
        assert_eq!((now.age_s, now.level_m), (0.0, [11.5, 22.5]));
        for t in [1.0, 7.0] {
            let q = settings.requirement.fault_free.q();
            let factors = [crate::special::chi::chi_factor(2, q).unwrap(), crate::special::chi::chi_factor(1, q).unwrap()];
            let fault = force * t * t + 9.8 * rate * t * t * t / 3.0;
            let later = guard.carry(time.plus_seconds(t), None, Some(&lost)).unwrap();
            for k in 0..2 {
                let expected = [11.5, 22.5][k] + factors[k] * 2.0 * sigma[k] + fault;
                assert!((later.level_m[k] - expected).abs() < 1e-9 * expected, "{t} {k}: {} {expected}", later.level_m[k]);
            }
            assert_eq!(later.age_s, t);
        }
        // What the tests contradict, or what has no level, changes nothing.
        for facts in [SnapshotFacts { ranges_agree: RangesAgree::No, ..facts }, SnapshotFacts { level_m: None, ..facts }] {
            let again = guard.carry(time, Some(&facts), Some(&solution)).unwrap();
            assert_eq!(again.level_m, [11.5, 22.5]);
        }
    }
}

#[test]
fn the_satellites_own_acceleration_is_the_change_of_their_velocity() {
    let world = World::new(1);
    let looked = |second: f64, east_mps: f64| {
        let covariance = Covariance::<Enu>::claim_symmetric(nalgebra::Matrix3::identity());
        let snapshot = Snapshot::solved(GpsTime::default().plus_seconds(second), world.position, covariance);
        let velocity = SnapshotVelocity { enu_mps: Vector3::new(east_mps, 4.0, 0.0), covariance: nalgebra::Matrix3::identity() };
        Looked { snapshot, velocity: Some(velocity), ranges_agree: RangesAgree::Yes, level_m: [1.0; 2] }
    };
    let mut guard = Guard::new(SETTINGS).unwrap();
    guard.note_acceleration(Some(&looked(0.0, 100.0)), &looked(0.5, 103.0));
    assert_eq!(guard.acceleration_mps2, Some(6.0));
    guard.note_acceleration(Some(&looked(0.0, 100.0)), &looked(2.0, 103.0));
    assert_eq!(guard.acceleration_mps2, None, "too long apart");
    guard.note_acceleration(Some(&looked(0.0, 100.0)), &looked(1.5, 103.0));
    assert_eq!(guard.acceleration_mps2, Some(2.0));
    guard.note_acceleration(None, &looked(2.5, 103.0));
    assert_eq!(guard.acceleration_mps2, None);
}

/// A solved position east of the antenna of the world.
pub(super) fn fix(world: &World, east_m: f64, variance_m2: f64) -> TimedAiding {
    let position = world.position.moved(&Displacement::<Enu>::from_vector(Vector3::new(east_m, 0.0, 0.0))).unwrap();
    let covariance = Covariance::claim_symmetric(nalgebra::Matrix3::identity() * variance_m2);
    let fix = PositionFix { position, covariance, velocity_ned_mps: None, level_m: None };
    TimedAiding { time: world.time(), aiding: Aiding::Fix(fix) }
}

/// The deviation of the filter from a solved position is taken with 1.6 times its covariance and a twentieth of the position's, as the
/// description of the method says; the filter may use the position where no test fails.
#[test]
fn a_solved_position_is_used_where_it_agrees_with_the_filter() {
    for (east_m, usable) in [(0.0, true), (10.0, true), (400.0, false), (-4000.0, false)] {
        let mut world = World::new(5);
        let (mut filter, mut guard) = (world.filter(), Guard::new(SETTINGS).unwrap());
        filter.advance(&world.sample());
        let timed = fix(&world, east_m, 9.0);
        let Aiding::Fix(m) = &timed.aiding else { unreachable!() };
        let d = filter.against(&Snapshot::solved(world.time(), m.position, m.covariance)).unwrap();
        assert_eq!(guard.admit_fix(&mut filter, world.time(), &timed, 0.0), usable, "{east_m}");
        let (time, tests) = guard.tests().unwrap();
        assert_eq!(*time, world.time());
        let wide = d.covariance.matrix() * 1.6 + nalgebra::Matrix3::identity() * (0.05 * 9.0);
        let (v, x) = (wide.fixed_view::<2, 2>(0, 0).into_owned(), d.position.vector().xy());
        let expected = [x.dot(&(v.try_inverse().unwrap() * x)), d.position.vector().z.powi(2) / wide[(2, 2)]];
        for (square, expected) in [tests.square[0], tests.square[2]].into_iter().zip(expected) {
            assert!((square - expected).abs() < 1e-9 * expected, "{east_m}: {square} {expected}");
        }
        assert_eq!(tests.fail(), !usable);
    }
}

#[test]
fn what_is_no_number_is_no_witness_and_what_is_late_is_counted() {
    let mut world = World::new(5);
    let (mut filter, mut guard) = (world.filter(), Guard::new(SETTINGS).unwrap());
    filter.advance(&world.sample());
    // The filter refuses it itself; nothing is compared.
    assert!(guard.admit_fix(&mut filter, world.time(), &fix(&world, 0.0, f64::NAN), 0.0));
    assert!(guard.tests().is_none() && guard.looked().is_none());
    let late = world.time().plus_seconds(SETTINGS.age_most_s + 0.1);
    guard.admit_fix(&mut filter, late, &fix(&world, 0.0, 9.0), 0.0);
    assert_eq!(guard.late, 1);
    guard.admit_fix(&mut filter, world.time(), &fix(&world, 0.0, 9.0), 0.0);
    assert_eq!(guard.late, 0);
}

/// Where ranges agree, the stations hear the snapshot and the filter without satellites together; where they could not be tested, only the
/// snapshot.
#[test]
fn stations_are_witnesses_of_the_unit_only_where_the_ranges_agree() {
    for (ranges_agree, n) in [(RangesAgree::Yes, 1), (RangesAgree::Untestable, 0)] {
        let mut world = World::new(7);
        let perfect = SensorNoise { white: 1e-12, bias: 1e-12, bias_time_s: 3600.0 };
        let mut settings = FilterSettings::of(ImuModel { gyroscope: perfect, accelerometer: perfect });
        // With a filter without satellites beside.
        settings.reversion = true;
        let level = Attitude { roll: Radians::new(0.0), pitch: Radians::new(0.0), heading: Radians::new(0.0) };
        let sigma = StartSigma { position: [Metres::new(5.0); 3], velocity_mps: 0.01, attitude: [Radians::new(1e-9); 3] };
        let start = NavState::new(world.time(), &world.position, Vector3::zeros(), &level).unwrap();
        let mut filter = Fusion::new(start, &sigma, settings).unwrap();
        filter.advance(&world.sample());
        let covariance = Covariance::<Enu>::claim_symmetric(nalgebra::Matrix3::identity());
        let snapshot = Snapshot::solved(world.time(), world.position, covariance);
        let mut guard = Guard::new(SETTINGS).unwrap();
        guard.looked = Some(Looked { snapshot, velocity: None, ranges_agree, level_m: [10.0; 2] });
        let here = *ecef_from_geodetic(&world.position).vector();
        let station = EcefPosition::from_vector(here + Vector3::new(5e4, 0.0, 0.0));
        let m = DmeRange {
            station: 3,
            position: station,
            slant: Metres::new(5e4),
            sigma_white: Metres::new(100.0),
            sigma_bias: Metres::new(50.0),
        };
        guard.hear(&mut filter, &[TimedAiding { time: world.time(), aiding: Aiding::Dme(m) }]);
        assert_eq!((guard.alone.n_known(), guard.stations.n_known()), (1, n));
    }
}
