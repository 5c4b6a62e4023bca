//! The forms: what a solved position remembers, and what a master makes of two filters.

use super::*;
use crate::frame::gravity_mps2;
use crate::frame::{EcefPosition, Geodetic, LatLon, ecef_from_geodetic, enu_from_ecef};
use crate::quantity::{GpsTime, Metres, Radians};
use crate::signal::{Aiding, BaroHeight, Constellation, ImuIncrement, SatelliteId, SatelliteRange, TimedAiding};
use nalgebra::Vector3;

const HEIGHT_M: f64 = 100.0;

fn place() -> Geodetic {
    Geodetic { point: LatLon::new(Radians::new(0.7), Radians::new(2.0)).unwrap(), height: Metres::new(HEIGHT_M) }
}

fn at(second: u32) -> GpsTime {
    GpsTime::default().plus_seconds(second.into())
}

/// At rest: gravity and the Earth's turn, one sample a second.
fn resting(second: u32) -> ImuIncrement {
    let (sin, cos) = 0.7f64.sin_cos();
    let g = gravity_mps2(Radians::new(0.7), Metres::new(HEIGHT_M));
    ImuIncrement {
        time: at(second),
        interval_s: 1.0,
        angle_rad: Vector3::new(cos, 0.0, -sin) * 7.292_115e-5,
        velocity_mps: Vector3::new(0.0, 0.0, -g),
    }
}

fn fusion(form: Form, change: impl FnOnce(&mut Settings)) -> Fusion {
    begun(form, 0.0, &StartSigma::default(), change)
}

/// A start too far north by an angle.
fn begun(form: Form, north_rad: f64, sigma: &StartSigma, change: impl FnOnce(&mut Settings)) -> Fusion {
    let level = Attitude { roll: Radians::new(0.0), pitch: Radians::new(0.0), heading: Radians::new(0.0) };
    let point = LatLon::new(Radians::new(0.7 + north_rad), place().point.lon()).unwrap();
    let start = NavState::new(at(0), &Geodetic { point, ..place() }, Vector3::zeros(), &level).unwrap();
    let mut settings = Settings::of(ImuModel::NAVIGATION);
    settings.form = form;
    change(&mut settings);
    Fusion::new(start, sigma, settings).unwrap()
}

/// Eight satellites; ranges too long by 3 km of clock and by what is given.
fn sky(second: u32, errors: [f64; 8], slow: f64) -> Vec<TimedAiding> {
    let own = ecef_from_geodetic(&place());
    let to_ecef = enu_from_ecef(&place().point).transpose();
    let range = |k: u8| {
        let (azimuth, elevation) = (f64::from(k) * 0.8, 0.3 + 0.14 * f64::from(k));
        let unit = Vector3::new(azimuth.sin() * elevation.cos(), azimuth.cos() * elevation.cos(), elevation.sin());
        Aiding::Satellite(SatelliteRange {
            satellite: SatelliteId { constellation: Constellation::Gps, number: k + 1 },
            position: EcefPosition::from_vector(own.vector() + to_ecef * unit * 2.3e7),
            velocity_mps: Vector3::zeros(),
            // A receiver never says the same bits twice.
            range: Some(Metres::new(2.3e7 + 3000.0 + errors[usize::from(k)] + f64::from(second) * 1e-6)),
            sigma_white: Metres::new(1.0),
            sigma_correlated: Metres::new(slow),
            sigma_first: Metres::new(slow),
            correlation_time_s: 1800.0,
            rate_mps: None,
        })
    };
    (0..8).map(|k| TimedAiding { time: at(second), aiding: range(k) }).collect()
}

fn horizontal_variance(fusion: &mut Fusion) -> f64 {
    fusion.solution(fusion.time()).unwrap().covariance.horizontal().trace()
}

/// Ranges whose slow errors stay are no better after five minutes of them: the variance stays above that of the slow part, as in the
/// tight form. Taken for new each time it would fall to hundredths.
#[test]
fn a_solved_position_remembers_what_stays_in_its_ranges() {
    let run = |form: Form, errors: ErrorModel| {
        let mut fusion = fusion(form, |s| s.errors = errors);
        for second in 1..=300 {
            fusion.advance(&resting(second));
            assert_eq!(fusion.aid(&sky(second, [0.0; 8], 10.0)), 8);
        }
        horizontal_variance(&mut fusion)
    };
    let (tight, loose) = (run(Form::Tight, ErrorModel::Correlated), run(Form::Loose, ErrorModel::Correlated));
    // Two parts of the start's 100 m² each and the solved position's: the loose form is a little worse than the tight one, never better.
    assert!(loose >= 0.99 * tight && loose < 1.2 * tight, "{loose} {tight}");
    let white = run(Form::Loose, ErrorModel::White);
    assert!(white < 0.2 * loose, "{white} {loose}");
}

/// 3 km of clock and a start 640 m too far north, known to 1 km: the first position puts it right.
#[test]
fn the_first_solved_position_is_the_true_one() {
    let wide = StartSigma { position: [Metres::new(1e3); 3], ..StartSigma::default() };
    let mut fusion = begun(Form::Loose, 1e-4, &wide, |_| ());
    fusion.advance(&resting(1));
    assert_eq!(fusion.aid(&sky(1, [0.0; 8], 0.0)), 8);
    let own = ecef_from_geodetic(&fusion.solution(fusion.time()).unwrap().state.position().unwrap());
    let left = own.minus(&ecef_from_geodetic(&place())).vector().norm();
    // The correction follows the Earth's curve and the position its tangent, (640 m)² / 2 / 6400 km = 32 mm; 1 m² against 1 km² leaves 1 mm.
    assert!(left < 0.04, "{left}");
}

/// One range wrong by 200 m among eight of 1 m: residuals of more than a hundred deviations, all thrown away.
#[test]
fn ranges_that_contradict_each_other_make_no_position() {
    let mut fusion = fusion(Form::Loose, |_| ());
    fusion.advance(&resting(1));
    assert_eq!(fusion.aid(&sky(1, [0.0, 0.0, 200.0, 0.0, 0.0, 0.0, 0.0, 0.0], 1.0)), 0);
    assert_eq!(fusion.innovations(Kind::Range).n_gated, 8);
    // Three satellites determine no position.
    assert_eq!(fusion.aid(&sky(1, [0.0; 8], 1.0)[..3]), 0);
    assert_eq!(fusion.innovations(Kind::Range).n_refused, 3);
}

/// Before any measurement both filters of the federation start with twice the variance, and together they know the start as it is.
#[test]
fn the_master_knows_as_much_as_the_start_and_both_filters_half_of_it() {
    let mut fusion = fusion(Form::Federated, |_| ());
    let whole = horizontal_variance(&mut fusion);
    let half = fusion.beside(fusion.time()).unwrap().solution.covariance.horizontal().trace();
    assert!((whole - 200.0).abs() < 1e-9 && (half - 400.0).abs() < 1e-9, "{whole} {half}");
}

/// Height by the altimeter in one filter, by satellites in the other: information adds.
///
/// ```text
/// 1/V = 1/V1 + 1/V2,   x = V (x1/V1 + x2/V2)         the vertical channel hardly knows of the others
/// ```
#[test]
fn the_master_adds_information() {
    let mut fusion = fusion(Form::Federated, |_| ());
    fusion.advance(&resting(1));
    let height = BaroHeight {
        height: Metres::new(HEIGHT_M + 6.0),
        sigma_white: Metres::new(3.0),
        sigma_bias: Metres::new(0.0),
        correlation_time_s: 100.0,
    };
    assert_eq!(fusion.aid(&[TimedAiding { time: at(1), aiding: Aiding::Baro(height) }]), 1);
    assert_eq!(fusion.innovations(Kind::Baro).n_used, 1);
    let second = fusion.beside(fusion.time()).unwrap().solution;
    let master = fusion.solution(fusion.time()).unwrap();
    let start = 2.0 * 15.0 * 15.0;
    // 450 m² and a millionth of growth against 9 m²: 0.01 m² covers what a second of the inertial unit adds.
    let alone = 1.0 / (1.0 / start + 1.0 / 9.0);
    assert!((second.covariance.matrix()[(2, 2)] - alone).abs() < 0.01);
    let together = 1.0 / (1.0 / start + 1.0 / alone);
    assert!((master.covariance.matrix()[(2, 2)] - together).abs() < 0.01, "{}", master.covariance.matrix()[(2, 2)]);
    let risen = master.state.position().unwrap().height.m() - HEIGHT_M;
    assert!((risen - together * 6.0 / 9.0).abs() < 0.01, "{risen}");
}

/// What it claims grows, and the difference has the covariance that the satellites took away.
#[test]
fn the_filter_beside_the_main_one_has_no_satellites() {
    let mut fusion = fusion(Form::Tight, |s| s.reversion = true);
    for second in 1..=30 {
        fusion.advance(&resting(second));
        fusion.aid(&sky(second, [0.0; 8], 0.0));
    }
    let beside = fusion.beside(fusion.time()).unwrap();
    let (with, without) = (fusion.solution(fusion.time()).unwrap().covariance, beside.solution.covariance);
    assert!(with.horizontal().trace() < 0.1 * without.horizontal().trace());
    let difference = beside.covariance.horizontal().trace();
    assert!((difference - (without.horizontal() - with.horizontal()).trace()).abs() < 1e-9);
    // After a new start the main filter does not know what the other knows.
    let here = *fusion.state();
    fusion.renew(here, &StartSigma::default()).unwrap();
    let after = fusion.beside(fusion.time()).unwrap().covariance.horizontal().trace();
    assert!((after - (without.horizontal().trace() + 200.0)).abs() < 1e-6, "{after}");
}
