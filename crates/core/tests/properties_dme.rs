//! What DME positions must do: find the place the ranges were made at, keep the mirror out, state a covariance that the errors have.
#![allow(clippy::unwrap_used)] // A test may stop at the first surprise.

use navbound_core::frame::{Covariance, Enu, Geodetic, LatLon, ecef_from_geodetic};
use navbound_core::quantity::{GpsTime, Metres, Radians, Risk};
use navbound_core::solution::dme::{
    Admission, Altitude, Best, Figure, Horizon, NoFix, Pair, Place, Prior, Range, RangeModel, Selector, Sight, Station, Switching, Verdict,
    VorRange, all_in_view, best_pair, solve, solve_checked, vor_fix,
};
use proptest::prelude::*;

fn geodetic(lat_deg: f64, lon_deg: f64, h_m: f64) -> Geodetic {
    let point = LatLon::new(Radians::degrees(lat_deg), Radians::degrees(lon_deg)).unwrap();
    Geodetic { point, height: Metres::new(h_m) }
}

/// Kyiv-Boryspil, Yahotyn, Stebliv, Koshany, degrees and metres.
const STATIONS: [(f64, f64, f64); 4] =
    [(50.2857, 30.9010, 129.0), (50.2651, 31.7945, 137.0), (49.4052, 31.0768, 146.0), (50.9460, 30.9778, 146.0)];

fn range(station: (f64, f64, f64), truth: &Geodetic, error_m: f64) -> Range {
    let station = ecef_from_geodetic(&geodetic(station.0, station.1, station.2));
    let slant = ecef_from_geodetic(truth).minus(&station).vector().norm();
    let sigma = RangeModel::STANDARD.sigma(Metres::new(slant)).unwrap();
    Range { station, slant: Metres::new(slant + error_m), sigma }
}

fn off(a: &Geodetic, b: &Geodetic) -> f64 {
    ecef_from_geodetic(a).minus(&ecef_from_geodetic(b)).vector().norm()
}

fn exact(height: Metres) -> Altitude {
    Altitude { height, sigma: Metres::new(0.0) }
}

/// Ranges are differences of Earth radii (6.4e6 m, 1e-9 m in the last place); a thousandth of an inclusion angle magnifies that.
const ROUNDING_M: f64 = 1e-5;

proptest! {
    #[test]
    fn error_free_ranges_lead_back_to_the_truth(lat in 48.0..52.0f64, lon in 29.0..35.0f64, h in 3000.0..12000.0f64) {
        let truth = geodetic(lat, lon, h);
        let ranges = STATIONS.map(|s| range(s, &truth, 0.0));
        // Beginning far away as well: 100 km north-east.
        let prior = Prior { position: geodetic(lat + 0.7, lon + 0.9, h), within: Metres::new(200e3) };
        for (used, prior) in [(4, None), (4, Some(&prior)), (3, None)] {
            match solve(&ranges[..used], &exact(truth.height), prior) {
                Ok(fix) => {
                    prop_assert!(off(&fix.position, &truth) < ROUNDING_M, "{} m with {used}", off(&fix.position, &truth));
                    prop_assert!(fix.p_residual.unwrap() > 0.999);
                }
                // Where three of them lie nearly in one line their mirror may fit alike.
                Err(e) => prop_assert!(used == 3 && e == NoFix::Ambiguous, "{e} with {used}"),
            }
        }
    }

    #[test]
    fn two_ranges_find_the_side_of_the_prior(lat in 48.2..49.8f64, lon in 30.5..32.5f64) {
        let truth = geodetic(lat, lon, 9000.0);
        let (a, b) = (range(STATIONS[0], &truth, 0.0), range(STATIONS[1], &truth, 0.0));
        let prior = Prior { position: geodetic(lat - 0.05, lon + 0.05, 9000.0), within: Metres::new(20e3) };
        let fix = solve(&[a, b], &exact(truth.height), Some(&prior)).unwrap();
        prop_assert!(off(&fix.position, &truth) < ROUNDING_M);
        prop_assert_eq!(fix.p_residual, None);
    }

    /// A position moved with all its ranges moves alike; an error of one range moves it by the row of the gain, C H' R^-1.
    #[test]
    fn small_errors_act_as_the_covariance_says(lat in 49.6..50.1f64, lon in 31.2..31.6f64, error in -30.0..30.0f64, sigma_h in 0.0..200.0f64) {
        let truth = geodetic(lat, lon, 9000.0);
        let altitude = Altitude { height: truth.height, sigma: Metres::new(sigma_h) };
        let place = Place::new(truth).unwrap();
        let mut spread = nalgebra::Matrix3::zeros();
        let moved = |errors: [f64; 4], high: f64| {
            let ranges = [0, 1, 2, 3].map(|k| range(STATIONS[k], &truth, errors[k]));
            let up = Altitude { height: Metres::new(truth.height.m() + high), ..altitude };
            let fix = solve(&ranges, &up, None).unwrap();
            let axes = navbound_core::frame::enu_from_ecef(&truth.point);
            (axes * (ecef_from_geodetic(&truth).vector() - ecef_from_geodetic(&fix.position).vector()), fix)
        };
        let unit = if error.abs() < 1.0 { 1.0 } else { error };
        for k in 0..4 {
            let mut errors = [0.0; 4];
            errors[k] = unit;
            let sigma = range(STATIONS[k], &truth, 0.0).sigma.m();
            let nse = moved(errors, 0.0).0 * (sigma / unit);
            spread += nse * nse.transpose();
        }
        let nse = moved([0.0; 4], unit).0 * (sigma_h / unit);
        spread += nse * nse.transpose();
        let stated = moved([0.0; 4], 0.0).1.covariance;
        // 30 m at distances of 30 km and more turn the lines of sight by a thousandth, and every element by twice that.
        prop_assert!((spread - stated.matrix()).amax() <= 5e-3 * stated.matrix().amax(), "{spread} {}", stated.matrix());
        let sights = STATIONS.map(|s| Sight::between(&place, &Place::new(geodetic(s.0, s.1, s.2)).unwrap()).unwrap());
        let ahead = all_in_view(sights.iter(), &RangeModel::STANDARD, Metres::new(sigma_h)).unwrap().unwrap();
        // The sigmas are worked out from the same slant ranges: rounding only.
        prop_assert!((ahead.matrix() - stated.matrix()).amax() <= 1e-9 * stated.matrix().amax());
    }

    #[test]
    fn a_pair_alone_and_the_general_form_agree(lat in 48.5..49.8f64, lon in 30.5..33.0f64, sigma_h in 0.0..300.0f64) {
        let place = Place::new(geodetic(lat, lon, 10_000.0)).unwrap();
        let [a, b] = [0, 1].map(|k| {
            let (lat, lon, h) = STATIONS[k];
            Sight::between(&place, &Place::new(geodetic(lat, lon, h)).unwrap()).unwrap()
        });
        let pair = Pair::of([&a, &b], &RangeModel::STANDARD, &Admission::STANDARD, Metres::new(sigma_h)).unwrap();
        let both = all_in_view([&a, &b].into_iter(), &RangeModel::STANDARD, Metres::new(sigma_h)).unwrap().unwrap();
        let direct = pair.covariance.unwrap();
        // Normal equations square the condition number, at most 1e2 here.
        prop_assert!((direct - both.horizontal()).amax() <= 1e-10 * direct.amax());
    }

    #[test]
    fn a_bearing_and_a_range_lead_back(lat in 49.0..51.5f64, lon in 29.0..30.6f64, h in 2000.0..11000.0f64) {
        let (truth, station) = (geodetic(lat, lon, h), Place::new(geodetic(STATIONS[0].0, STATIONS[0].1, STATIONS[0].2)).unwrap());
        let seen = navbound_core::frame::enu_from_ecef(&station.geodetic().point)
            * (ecef_from_geodetic(&truth).vector() - station.ecef().vector());
        let measured = VorRange {
            slant: Metres::new(seen.norm()),
            sigma: Metres::new(180.0),
            bearing: Radians::new(seen.x.atan2(seen.y)),
            sigma_bearing: Radians::degrees(2.27),
        };
        let fix = vor_fix(&station, &measured, &Altitude { height: truth.height, sigma: Metres::new(50.0) }).unwrap();
        // The elevation settles to a micrometre of height, which a slope of 1 in 10 turns into ten of ground.
        prop_assert!(off(&fix.position, &truth) < 1e-3);
        let across = fix.lateral_sigma(Radians::new(measured.bearing.rad()));
        let ground = seen.xy().norm();
        // The radial turns by a degree and a half at 100 NM between station and aircraft.
        prop_assert!((across.m() / (ground * 2.27_f64.to_radians()) - 1.0).abs() < 0.01);
    }
}

#[test]
fn two_ranges_without_a_prior_have_two_answers_and_so_none() {
    let truth = geodetic(49.3, 31.3, 9000.0);
    let both = [range(STATIONS[0], &truth, 0.0), range(STATIONS[1], &truth, 0.0)];
    assert_eq!(solve(&both, &exact(truth.height), None), Err(NoFix::Ambiguous));
    // A prior that holds both sides does not choose either.
    let wide = Prior { position: geodetic(50.275, 31.35, 9000.0), within: Metres::new(400e3) };
    assert_eq!(solve(&both, &exact(truth.height), Some(&wide)), Err(NoFix::Ambiguous));
    // One that is on the other side finds the other side: the mirror is as good a solution.
    let north = Prior { position: geodetic(51.25, 31.3, 9000.0), within: Metres::new(30e3) };
    let mirror = solve(&both, &exact(truth.height), Some(&north)).unwrap();
    assert!(mirror.position.point.lat().rad() > 51.0_f64.to_radians());
    let elsewhere = Prior { position: geodetic(45.0, 31.3, 9000.0), within: Metres::new(30e3) };
    assert_eq!(solve(&both, &exact(truth.height), Some(&elsewhere)), Err(NoFix::FarFromPrior));
}

#[test]
fn what_cannot_be_solved_says_why() {
    let truth = geodetic(49.3, 31.3, 9000.0);
    let a = range(STATIONS[0], &truth, 0.0);
    let prior = Prior { position: truth, within: Metres::new(50e3) };
    assert_eq!(solve(&[a], &exact(truth.height), Some(&prior)), Err(NoFix::TooFewRanges));
    let short = Range { slant: Metres::new(10e3), ..a };
    let other = Range { slant: Metres::new(10e3), ..range(STATIONS[2], &truth, 0.0) };
    assert_eq!(solve(&[short, other], &exact(truth.height), Some(&prior)), Err(NoFix::Apart));
    for bad in [f64::NAN, -1.0, 0.0, f64::INFINITY] {
        let wrong = Range { slant: Metres::new(bad), ..a };
        assert!(matches!(solve(&[a, wrong, a], &exact(truth.height), None), Err(NoFix::Invalid(e)) if e.argument == "slant_m"));
    }
    // Everything on one meridian: nothing is known across it.
    let between = geodetic(49.6, 31.0, 9000.0);
    let (south, north) = ((49.0, 31.0, 100.0), (50.0, 31.0, 150.0));
    let level = [range(south, &between, 0.0), range(north, &between, 0.0), range(north, &between, 0.0)];
    let here = Prior { position: between, within: Metres::new(50e3) };
    assert_eq!(solve(&level, &exact(between.height), Some(&here)), Err(NoFix::Singular));
}

#[test]
fn a_wrong_range_shows_in_the_residuals() {
    let truth = geodetic(49.9, 31.4, 9000.0);
    let clean = STATIONS.map(|s| range(s, &truth, 0.0));
    let mut wrong = clean;
    // Ten deviations.
    wrong[2].slant = Metres::new(wrong[2].slant.m() + 1826.0);
    let p = |ranges: &[Range]| solve(ranges, &exact(truth.height), None).unwrap().p_residual.unwrap();
    assert!(p(&clean) > 0.999);
    assert!(p(&wrong) < 1e-6, "{}", p(&wrong));
}

#[test]
fn the_wrong_range_of_four_is_named_and_three_do_not_tell() {
    let truth = geodetic(50.1, 31.3, 9000.0);
    let clean = STATIONS.map(|s| range(s, &truth, 0.0));
    let risk = Risk::new(1e-3).unwrap();
    // What is left of four may not tell the position from its mirror by itself.
    let near = Prior { position: truth, within: Metres::new(50e3) };
    let checked = |ranges: &mut [Range]| solve_checked(ranges, &exact(truth.height), Some(&near), risk).unwrap();
    assert_eq!(checked(&mut clean.clone()).verdict, Verdict::Consistent);
    for wrong in 0..4 {
        let mut ranges = clean;
        ranges[wrong].slant = Metres::new(ranges[wrong].slant.m() + 15.0 * 182.6);
        let original = ranges;
        let outcome = checked(&mut ranges);
        assert_eq!((outcome.verdict, outcome.fix.used), (Verdict::Excluded(wrong), 3));
        assert_eq!(ranges, original, "the list comes back in its order");
        // Error-free ranges are left: a micrometre on the ground, magnified by the geometry.
        assert!((outcome.fix.position.point.lat().rad() - truth.point.lat().rad()).abs() < 1e-11);
        let mut three: Vec<Range> = (0..4).filter(|k| *k != (wrong + 1) % 4).map(|k| original[k]).collect();
        assert_eq!(checked(&mut three).verdict, Verdict::TooFew);
    }
    let mut two = clean;
    for (k, error) in [(0, 3000.0), (2, -2500.0)] {
        two[k].slant = Metres::new(two[k].slant.m() + error);
    }
    // Two at a time are seen and may be laid at the door of a third.
    assert_ne!(checked(&mut two).verdict, Verdict::Consistent);
}

fn best(stations: [usize; 2], figure: f64) -> Best {
    let sight = |e: f64, n: f64| Sight { slant: Metres::new(5e4), elevation: Radians::new(0.1), unit: nalgebra::Vector3::new(e, n, 0.0) };
    let pair = Pair::of([&sight(1.0, 0.0), &sight(0.0, 1.0)], &RangeModel::STANDARD, &Admission::STANDARD, Metres::new(0.0)).unwrap();
    Best { stations, pair, figure: Metres::new(figure) }
}

#[test]
fn a_better_pair_waits_and_a_lost_one_goes_at_once() {
    let at = |s: f64| GpsTime::from_nanoseconds(0).plus_seconds(s);
    let mut selector = Selector::new(Switching::USUAL).unwrap();
    let look = |figure: f64| move |pair: [usize; 2]| Some(best(pair, figure));
    assert_eq!(selector.step(at(0.0), Some(best([0, 1], 100.0)), look(100.0)).unwrap().stations, [0, 1]);
    // 4 % better never suffices; 6 % does after ten seconds without interruption.
    assert_eq!(selector.step(at(20.0), Some(best([0, 2], 96.0)), look(100.0)).unwrap().stations, [0, 1]);
    assert_eq!(selector.step(at(21.0), Some(best([0, 2], 94.0)), look(100.0)).unwrap().stations, [0, 1]);
    assert_eq!(selector.step(at(26.0), Some(best([0, 2], 96.0)), look(100.0)).unwrap().stations, [0, 1]);
    assert_eq!(selector.step(at(27.0), Some(best([0, 2], 94.0)), look(100.0)).unwrap().stations, [0, 1]);
    assert_eq!(selector.step(at(36.9), Some(best([1, 2], 94.0)), look(100.0)).unwrap().stations, [0, 1]);
    assert_eq!(selector.step(at(37.0), Some(best([1, 2], 94.0)), look(100.0)).unwrap().stations, [1, 2]);
    // The pair in use is gone: no waiting. And nothing is nothing.
    assert_eq!(selector.step(at(38.0), Some(best([0, 2], 300.0)), |_| None).unwrap().stations, [0, 2]);
    assert_eq!(selector.step(at(39.0), None, |_| None), None);
    assert!(Selector::new(Switching { share: f64::NAN, hold_s: 10.0 }).is_err());
    assert!(Selector::new(Switching { share: 0.05, hold_s: -1.0 }).is_err());
}

#[test]
fn the_optimal_pair_is_admissible_and_the_first_of_equals() {
    let place = Place::new(geodetic(49.6, 31.4, 9000.0)).unwrap();
    let sights = STATIONS.map(|s| Sight::between(&place, &Place::new(geodetic(s.0, s.1, s.2)).unwrap()));
    let best = |sights: &[Option<Sight>], figure| {
        best_pair(sights, figure, &RangeModel::STANDARD, &Admission::STANDARD, Metres::new(0.0)).unwrap()
    };
    let optimal = best(&sights, Figure::Drms).unwrap();
    assert!(optimal.pair.admissible);
    assert_eq!(best(&[sights[0], sights[2], sights[0], sights[2]], Figure::Drms).unwrap().stations, [0, 1]);
    assert_eq!(best(&[sights[0], None, None, None], Figure::Drms), None);
    // Across a course the best may be another pair, never a worse one.
    let course = Radians::degrees(70.0);
    let across = best(&sights, Figure::Across(course)).unwrap();
    assert!(across.figure <= optimal.pair.lateral_sigma(course).unwrap());
}

#[test]
fn a_station_serves_within_its_volume_and_above_the_horizon() {
    let station = |service_nm: f64| Station {
        place: Place::new(geodetic(50.0, 31.0, 100.0)).unwrap(),
        service: Metres::nautical_miles(service_nm),
        bearing: false,
    };
    let usable = |station: Station, lat: f64, h: f64| {
        station.usable(&Place::new(geodetic(lat, 31.0, h)).unwrap(), &Admission::STANDARD, &Horizon::STANDARD).is_some()
    };
    // One degree of latitude is 60 NM.
    assert!(usable(station(130.0), 51.0, 9000.0));
    assert!(!usable(station(40.0), 51.0, 9000.0));
    // 1.2287 NM times the root of the feet: 60 NM are seen from 727 m above the station, 2385 feet.
    assert!(usable(station(130.0), 51.0, 100.0 + 740.0));
    assert!(!usable(station(130.0), 51.0, 100.0 + 715.0));
    assert!(!usable(station(130.0), 50.0, 9000.0), "straight above");
    assert!(!usable(station(130.0), 51.0, 0.0), "below the ground of the station");
}

#[test]
fn places_without_a_height_are_refused() {
    assert!(Place::new(geodetic(50.0, 31.0, f64::NAN)).is_err());
    let covariance: Option<Covariance<Enu>> = all_in_view([].iter(), &RangeModel::STANDARD, Metres::new(0.0)).unwrap();
    assert_eq!(covariance, None);
    assert!(all_in_view([].iter(), &RangeModel::STANDARD, Metres::new(f64::NAN)).is_err());
}
