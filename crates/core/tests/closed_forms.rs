//! Functions of the bounds against forms that are worked out here by another way: closed forms, plain sums, Simpson's rule, every sign.
#![allow(clippy::unwrap_used)] // A test may stop at the first surprise, in its helpers too.

use nalgebra::{Matrix3, SymmetricEigen, Vector3};
use navbound_core::bound::anp::{accept, box_factor, cylinder_scale, intercept};
use navbound_core::bound::ee::{Both, bias};
use navbound_core::bound::faults::FaultModes;
use navbound_core::bound::gbas::bias::Ordering;
use navbound_core::bound::gbas::detection::Hazard;
use navbound_core::bound::gbas::noise::{Coloured, Form};
use navbound_core::bound::gbas::range::carrier_sigma;
use navbound_core::bound::sbas::Seen;
use navbound_core::bound::sbas::ionosphere::Vertical;
use navbound_core::bound::sbas::model::{Corrected, Elevation, RangeError, broadcast_ionosphere_m2, troposphere_m2};
use navbound_core::bound::tse::{
    Component, Deviation, PathDeviations, box_risk, deviations, farthest, ln_exceedance_risk, mixture, rf_fte, sigma_budget,
};
use navbound_core::frame::{Covariance, Displacement, Enu};
use navbound_core::monitor::consistency::{integral_transform, normalised_square, normalised_square_horizontal};
use navbound_core::monitor::rnp::Counters;
use navbound_core::quantity::{Metres, Radians, Risk};
use navbound_core::signal::Constellation;
use navbound_core::spec::gbas::{CARRIER_DUAL, CARRIER_SINGLE, MONITOR_D};
use navbound_core::special::{chi, two_sided_factor};
use proptest::prelude::*;

/// A standard normal between two numbers, good to 1e-13 where they are 20 apart.
fn inside_interval(low: f64, high: f64) -> f64 {
    simpson(low.max(-9.0), high.min(9.0), 8000, density)
}

fn density(z: f64) -> f64 {
    (-0.5 * z * z).exp() / (2.0 * core::f64::consts::PI).sqrt()
}

fn simpson(a: f64, b: f64, n: u32, f: impl Fn(f64) -> f64) -> f64 {
    if b <= a {
        return 0.0;
    }
    let h = (b - a) / f64::from(n);
    let inner: f64 = (1..n).map(|k| if k % 2 == 1 { 4.0 } else { 2.0 } * f(a + h * f64::from(k))).sum();
    (f(a) + inner + f(b)) * h / 3.0
}

/// Inside of the cube |z_i| <= k of three correlated standard normals: over z_1 and z_2 given z_1, with z_3 given both.
fn inside_cube([r12, r13, r23]: [f64; 3], k: f64) -> f64 {
    let s2 = (1.0 - r12 * r12).sqrt();
    let l32 = (r23 - r12 * r13) / s2;
    let s3 = (1.0 - r13 * r13 - l32 * l32).sqrt();
    simpson(-k, k, 200, |z1| {
        density(z1)
            * simpson((-k - r12 * z1) / s2, (k - r12 * z1) / s2, 200, |z2| {
                let mean = r13 * z1 + l32 * z2;
                density(z2) * simpson(((-k - mean) / s3).max(-9.0), ((k - mean) / s3).min(9.0), 100, density)
            })
    })
}

fn risk(q: f64) -> Risk {
    Risk::new(q).unwrap()
}

fn close(a: f64, b: f64, relative: f64) {
    assert!((a - b).abs() <= relative * b.abs().max(1e-300), "{a} {b}");
}

/// Symmetric matrices of any sign: eigenvalues of either sign along turned axes.
fn symmetric() -> impl Strategy<Value = Matrix3<f64>> {
    let turn = prop::array::uniform3(-3.0..3.0_f64);
    (prop::array::uniform3(-1.0..1.0_f64), turn, -2.0..6.0_f64).prop_map(|(values, turn, scale)| {
        let a = nalgebra::Rotation3::from_scaled_axis(Vector3::from(turn));
        let v = a.matrix() * Matrix3::from_diagonal(&Vector3::from(values)) * a.matrix().transpose() * 10_f64.powf(scale);
        0.5 * (v + v.transpose())
    })
}

proptest! {
    /// A matrix is a covariance where no eigenvalue is negative; nothing else decides, and one that is taken comes back as it was.
    #[test]
    fn a_covariance_is_what_has_no_negative_eigenvalue(v in symmetric()) {
        let values = SymmetricEigen::new(v).eigenvalues;
        // Between these, rounding of the two ways decides.
        prop_assume!(values.min().abs() > 1e-9 * values.max().abs());
        let upper = [v[(0, 0)], v[(0, 1)], v[(1, 1)], v[(0, 2)], v[(1, 2)], v[(2, 2)]];
        let taken = accept(upper, "covariance");
        if values.min() > 0.0 {
            prop_assert_eq!(taken, Ok(upper));
        } else {
            prop_assert!(taken.is_err());
        }
    }

    #[test]
    fn a_normalised_square_is_that_of_the_inverse(v in symmetric(), e in prop::array::uniform3(-9.0..9.0_f64)) {
        let v = v * v;
        let values = SymmetricEigen::new(v).eigenvalues;
        prop_assume!(values.min() > 1e-6 * values.max());
        let e = Vector3::from(e);
        let (error, covariance) = (Displacement::<Enu>::from_vector(e), Covariance::<Enu>::claim_symmetric(v));
        let inverse = e.dot(&(v.try_inverse().unwrap() * e));
        // The condition of 1e6 and sixteen digits.
        let square = normalised_square(&error, &covariance).unwrap();
        prop_assert!((square - inverse).abs() <= 1e-8 * inverse, "{} {}", square, inverse);
        let plane = v.fixed_view::<2, 2>(0, 0).into_owned();
        let inverse = e.xy().dot(&(plane.try_inverse().unwrap() * e.xy()));
        let square = normalised_square_horizontal(&error, &covariance).unwrap();
        prop_assert!((square - inverse).abs() <= 1e-8 * inverse, "{} {}", square, inverse);
    }

    /// Where a unit vector pierces k sigma of an ellipsoid: k / sqrt(u' V^-1 u).
    #[test]
    fn the_ellipsoid_is_pierced_where_the_inverse_says(v in symmetric(), u in prop::array::uniform3(-1.0..1.0_f64)) {
        let v = v * v;
        let values = SymmetricEigen::new(v).eigenvalues;
        prop_assume!(values.min() > 1e-6 * values.max() && Vector3::from(u).norm() > 0.1);
        let u = Vector3::from(u).normalize();
        let length = intercept(&Covariance::claim_symmetric(v), &u, risk(0.05)).unwrap().unwrap().m();
        // 2.795483482915108: the root of the 95 % quantile of chi-square with three degrees of freedom, 7.814727903251179 (tables).
        let expected = 7.814_727_903_251_179_f64.sqrt() / u.dot(&(v.try_inverse().unwrap() * u)).sqrt();
        prop_assert!((length - expected).abs() <= 1e-8 * expected, "{} {}", length, expected);
    }

    /// Every combination of signs of up to eight rows, some of them in line with each other.
    #[test]
    fn the_largest_effect_of_biases_is_that_of_every_sign(rows in prop::collection::vec((-3..=3_i32, -3..=3_i32), 1..=8)) {
        let vectors: Vec<[f64; 2]> = rows.iter().map(|(e, n)| [f64::from(*e), f64::from(*n)]).collect();
        let largest = (0..1_u32 << vectors.len())
            .map(|signs| {
                let sum = vectors.iter().enumerate().fold([0.0; 2], |s, (i, v)| {
                    let sign = if signs >> i & 1 == 1 { 1.0 } else { -1.0 };
                    [s[0] + sign * v[0], s[1] + sign * v[1]]
                });
                f64::hypot(sum[0], sum[1])
            })
            .fold(0.0, f64::max);
        let both = bias::exact(vectors.iter().map(|v| Vector3::new(v[0], v[1], -0.5)), Metres::new(1.0)).unwrap();
        // Sums of whole numbers, and one root.
        prop_assert!((both.horizontal.m() - largest).abs() < 1e-12 * largest.max(1.0));
        prop_assert!((Ordering::Exact.gain(vectors.iter().copied()) - largest).abs() < 1e-12 * largest.max(1.0));
        let (east, north) = vectors.iter().fold((0.0, 0.0), |s, v| (s.0 + v[0].abs(), s.1 + v[1].abs()));
        prop_assert!((Ordering::Rss.gain(vectors.iter().copied()) - f64::hypot(east, north)).abs() < 1e-12 * largest.max(1.0));
        let sum: f64 = vectors.iter().map(|v| f64::hypot(v[0], v[1])).sum();
        prop_assert!((Ordering::Sum.gain(vectors.iter().copied()) - sum).abs() < 1e-12 * sum.max(1.0));
    }

    /// The farthest point of an ellipse from the origin, against a walk round it.
    #[test]
    fn the_farthest_point_of_an_ellipse_is_that_of_a_walk(x in -5.0..5.0_f64, y in -5.0..5.0_f64, a in 0.0..4.0_f64, b in 0.0..4.0_f64) {
        let walk = (0..40_000)
            .map(|k| core::f64::consts::TAU * f64::from(k) / 40_000.0)
            .map(|t| f64::hypot(x + a * t.cos(), y + b * t.sin()))
            .fold(0.0, f64::max);
        let distance = farthest(Metres::new(x), Metres::new(y), Metres::new(a), Metres::new(b)).m();
        // Half a step of the walk is 8e-5: it falls short by at most its square times the radius of curvature's share.
        prop_assert!(distance >= walk - 1e-12 && distance <= walk + 1e-7 * (1.0 + walk), "{} {}", distance, walk);
    }
}

#[test]
fn the_integral_transform_is_the_head_of_chi_square() {
    for x in [0.1_f64, 1.0, 5.991_464_547_107_979, 20.0] {
        close(integral_transform(x, 2), 1.0 - (-0.5 * x).exp(), 1e-13);
    }
    // 95 % quantiles of the tables.
    for (dimension, quantile) in [(1, 3.841_458_820_694_124), (2, 5.991_464_547_107_979), (3, 7.814_727_903_251_179)] {
        close(integral_transform(quantile, dimension), 0.95, 1e-13);
    }
}

#[test]
fn alerts_an_hour_are_cautions_and_warnings_by_the_time_watched() {
    let counted = Counters { n_cautions: 2, n_warnings: 1, n_unavailable: 5, watched_s: 1800.0, ..Counters::default() };
    assert_eq!(counted.alerts_per_hour(), 6.0);
}

#[test]
fn the_factor_of_a_box_is_that_of_its_probability() {
    // Independent: (1 - 2Q(k))^3 and, of a flat error, (1 - 2Q(k))^2.
    for (uu, n) in [(0.25, 3), (0.0, 2)] {
        let k = box_factor([4.0, 0.0, 9.0, 0.0, 0.0, uu], risk(0.05)).unwrap();
        close(inside_interval(-k, k).powi(n), 0.95, 1e-12);
    }
    // One error along three axes: one interval.
    let one = box_factor([4.0, 6.0, 9.0, 1.0, 1.5, 0.25], risk(0.05)).unwrap();
    close(one, two_sided_factor(0.05), 1e-9);
    for r in [[0.5, 0.0, 0.0], [-0.5, 0.3, 0.2], [0.8, -0.4, -0.6], [0.1, 0.7, -0.5]] {
        for q in [0.2, 1e-3] {
            let sigma = [2.0, 3.0, 0.5];
            let upper = [4.0, r[0] * sigma[0] * sigma[1], 9.0, r[1] * sigma[0] * sigma[2], r[2] * sigma[1] * sigma[2], 0.25];
            let k = box_factor(upper, risk(q)).unwrap();
            // Simpson's rule with a hundred panels of a fifth of a deviation is good to 1e-7 of the whole.
            assert!((1.0 - inside_cube(r, k) - q).abs() < 3e-7, "{r:?} {q} {k}: {}", 1.0 - inside_cube(r, k) - q);
        }
    }
    assert_eq!(box_factor([0.0, 0.0, 9.0, 0.0, 0.0, 1.0], risk(0.05)).unwrap_err().argument, "covariance");
}

#[test]
fn the_factor_of_a_cylinder_is_that_of_its_probability() {
    for q in [0.3, 0.05, 1e-5] {
        let s = cylinder_scale([4.0, 0.0, 4.0, 0.0, 0.0, 9.0], [0.0; 3], 5.0, 4.0, risk(q)).unwrap();
        let within = -(-0.5 * (s * 5.0 / 2.0).powi(2)).exp_m1() * inside_interval(-s * 4.0 / 3.0, s * 4.0 / 3.0);
        assert!((1.0 - within - q).abs() < 1e-12, "{q}: {s} {within}");
    }
    // Without a vertical error and with a wide half height only the circle counts, and the other way round.
    let circle = cylinder_scale([4.0, 0.0, 4.0, 0.0, 0.0, 0.0], [0.0; 3], 5.0, 4.0, risk(0.05)).unwrap();
    close(circle, 2.0 * chi::chi_factor(2, 0.05).unwrap() / 5.0, 1e-9);
    let height = cylinder_scale([0.0, 0.0, 0.0, 0.0, 0.0, 9.0], [0.0; 3], 5.0, 4.0, risk(0.05)).unwrap();
    close(height, 3.0 * two_sided_factor(0.05) / 4.0, 1e-9);
}

#[test]
fn a_satellite_alone_in_its_constellation_is_the_constellation() {
    let satellites = [(Constellation::Gps, 1e-5), (Constellation::Galileo, 3e-5), (Constellation::Gps, 2e-5)];
    let modes = FaultModes::single(&satellites).unwrap();
    let listed: Vec<_> = modes.iter().map(|m| (m.satellites, m.constellations, m.p)).collect();
    let galileo = 1 << Constellation::Galileo.index();
    assert_eq!(listed, [(0, 0, 1.0), (1, 0, 1e-5), (2, galileo, 3e-5), (4, 0, 2e-5)]);
    assert_eq!((modes.len(), modes.left()), (4, 0.0));
}

#[test]
fn the_parts_of_an_extracted_error_add_up() {
    let rows = |e: f64, n: f64, u: f64| bias::exact([Vector3::new(e, n, u)].into_iter(), Metres::new(1.0)).unwrap();
    let sum = rows(3.0, 4.0, 1.0).plus(rows(0.6, 0.8, 0.25));
    close(sum.horizontal.m(), 6.0, 1e-15);
    close(sum.vertical.m(), 1.25, 1e-15);
    assert_eq!(Both::default().plus(sum), sum);
}

#[test]
fn a_coasted_phase_has_the_errors_of_equation_20() {
    let (speed, time, el) = (70.0_f64, 60.0_f64, 30.0_f64.to_radians());
    let mapping = 1.001 / (0.002_001_f64 + el.sin() * el.sin()).sqrt();
    let squares = 2.0 * 0.02_f64.powi(2) + (mapping * 1e-6 * speed * time).powi(2) + (0.3e-3 * time).powi(2);
    let dual = carrier_sigma(&CARRIER_DUAL, Radians::new(el), speed, time).unwrap().m();
    close(dual, squares.sqrt(), 1e-12);
    // A shell at 350 km over an Earth of 6378.1363 km (standard).
    let ratio = 6_378_136.3 * el.cos() / (6_378_136.3 + 350_000.0);
    let slant = 1.0 / (1.0 - ratio * ratio).sqrt() * CARRIER_SINGLE.ionosphere_gradient.unwrap() * speed * time;
    let single = carrier_sigma(&CARRIER_SINGLE, Radians::new(el), speed, time).unwrap().m();
    close(single, (squares + slant * slant).sqrt(), 1e-12);
}

#[test]
fn coloured_noise_begins_and_is_driven_as_its_bound_says() {
    let of = |form: Form| Coloured::new(Metres::new(3.0), [10.0, 40.0], form).unwrap();
    // Of a variance of 9 m^2 and a quarter between the time constants: 2 / (1 + 1/4) to begin with, four times the noise to drive it.
    close(of(Form::Bound).initial_m2(), 9.0 * 1.6, 1e-15);
    close(of(Form::Paper).initial_m2(), 9.0, 1e-15);
    let gone = 1.0 - (-2.0 * 20.0 / 40.0_f64).exp();
    close(of(Form::Bound).added_m2(20.0), 36.0 * gone, 1e-15);
    close(of(Form::Paper).added_m2(20.0), 9.0 * gone, 1e-15);
}

#[test]
fn the_troposphere_is_that_of_the_zenith_times_the_square_of_its_mapping() {
    let at = |degrees: f64| {
        let rad = degrees.to_radians();
        troposphere_m2(&Elevation { rad, sin: rad.sin(), decay: 0.0 })
    };
    // Twelve centimetres and a mapping that is one at the zenith to a part in a million.
    close(at(90.0), 0.0144, 1e-6);
    close(at(30.0), 0.0144 * 1.001 * 1.001 / 0.252_001, 1e-12);
    let at_one = 0.0144 * 1.001 * 1.001 / (0.002_001 + 1.0_f64.to_radians().sin().powi(2));
    close(at(1.0), at_one * (1.0 + 0.015 * 9.0_f64).powi(2), 1e-12);
}

#[test]
fn a_monitor_suffices_where_its_margin_is_none_below_zero() {
    let of = |containment: f64| {
        let hazard = Hazard::new(Metres::new(containment), Metres::new(0.4), Metres::new(0.0), 2.0, risk(0.375 * 1.25e-9), 5e-6).unwrap();
        (hazard.margin_decades(&MONITOR_D), hazard.met_by(&MONITOR_D))
    };
    let (narrow, wide) = (of(3.0), of(8.0));
    assert!(narrow.0 < 0.0 && !narrow.1, "{narrow:?}");
    assert!(wide.0 > 0.0 && wide.1, "{wide:?}");
}

#[test]
fn the_broadcast_ionosphere_is_the_larger_of_a_fifth_and_the_latitude() {
    let at = |slant: f64, latitude: f64| broadcast_ionosphere_m2(slant, 2.25, latitude.to_radians());
    // 9 m to 20, 4.5 m to 55, 6 m beyond; an obliquity of 1.5.
    for (latitude, vertical) in [(0.0, 9.0), (-19.9, 9.0), (20.1, 4.5), (-54.9, 4.5), (55.1, 6.0), (90.0, 6.0)] {
        close(at(0.0, latitude), 2.25 * vertical * vertical, 1e-15);
        close(at(100.0, latitude), 400.0, 1e-15);
    }
    close(at(45.0, 40.0), 81.0, 1e-15);
}

#[test]
fn a_leg_to_a_fix_bends_away_from_its_tangent() {
    let m = Metres::new;
    // |fte| + (sigma^2 + along^2) / 2R.
    close(rf_fte(m(-30.0), m(40.0), m(30.0), m(5000.0)).unwrap().m(), 30.25, 1e-15);
    for radius in [0.0, -1.0, f64::INFINITY, f64::NAN] {
        assert_eq!(rf_fte(m(0.0), m(0.0), m(0.0), m(radius)).unwrap_err().argument, "radius_m");
    }
}

#[test]
fn the_budget_of_sigma_uses_up_the_risk() {
    for (limit, fte, q) in [(100.0, 0.0, 0.05), (100.0, 30.0, 1e-5), (100.0, 99.0, 0.01), (100.0, -60.0, 0.5)] {
        let sigma = sigma_budget(Metres::new(limit), Metres::new(fte), risk(q)).unwrap().unwrap().m();
        let inside = inside_interval((-limit - fte) / sigma, (limit - fte) / sigma);
        assert!((1.0 - inside - q).abs() < 1e-12, "{limit} {fte} {q}: {sigma}");
    }
    assert_eq!(sigma_budget(Metres::new(10.0), Metres::new(10.0), risk(0.05)).unwrap().unwrap().m(), 0.0);
    assert!(sigma_budget(Metres::new(10.0), Metres::new(11.0), risk(0.05)).unwrap().is_none());
}

#[test]
fn a_mixture_of_errors_is_bounded_where_their_risks_together_are_the_risk() {
    let part =
        |weight: f64, fte: f64, sigma: f64| Component { weight, deviation: Deviation::new(Metres::new(fte), Metres::new(sigma)).unwrap() };
    let cases: [&[Component]; 4] = [
        &[part(0.7, 0.0, 10.0), part(0.3, 20.0, 30.0)],
        &[part(0.5, -5.0, 4.0), part(0.25, 5.0, 8.0), part(0.25, 0.0, 16.0)],
        // One without a spread: it counts whole below its place and not at all beyond.
        &[part(0.9, 0.0, 10.0), part(0.1, 12.0, 0.0)],
        &[part(0.0, 90.0, 0.0), part(1.0, 3.0, 5.0)],
    ];
    for (k, parts) in cases.into_iter().enumerate() {
        for q in [0.3, 0.05, 1e-4] {
            let bound = mixture(parts, risk(q)).unwrap().m();
            let outside = |bound: f64| {
                let one = |c: &Component| {
                    let (fte, sigma) = (c.deviation.fte().m(), c.deviation.sigma().m());
                    let beyond = if sigma > 0.0 {
                        1.0 - inside_interval((-bound - fte) / sigma, (bound - fte) / sigma)
                    } else {
                        f64::from(u8::from(fte.abs() > bound))
                    };
                    c.weight * beyond
                };
                parts.iter().map(one).sum::<f64>()
            };
            let met = (outside(bound) - q).abs() < 1e-11;
            let jumps = outside(bound * (1.0 - 1e-9)) >= q && outside(bound * (1.0 + 1e-9)) <= q;
            assert!(met || jumps, "{k} {q}: {} at {bound}", outside(bound));
        }
    }
}

/// Of a range without its degradation 8 m stand beside the deviation of the UDRE, whatever the factor.
#[test]
fn an_unknown_degradation_is_eight_metres_more() {
    let corrected = |degradation_m, rss| Corrected { udre_m: 0.5, degradation_m, rss };
    close(corrected(None, false).variance_m2(2.0), 81.0, 1e-15);
    close(corrected(None, true).variance_m2(4.0), 100.0, 1e-15);
    close(corrected(Some([0.1, 0.2, 0.3, 0.4]), false).variance_m2(2.0), 4.0, 1e-15);
    close(corrected(Some([0.1, 0.2, 0.3, 0.4]), true).variance_m2(2.0), 1.3, 1e-15);
}

/// Covariances whose smallest eigenvalue is a hair above and below zero, in every plane: the pair of axes decides as all three together do.
#[test]
fn a_covariance_is_one_where_its_smallest_eigenvalue_is_none_below_zero() {
    let tangent = (Radians::new(0.7), Radians::new(0.1));
    for (i, j) in [(0, 1), (0, 2), (1, 2)] {
        for correlation in [-0.5, 0.3, 0.9, 1.1, 1.5] {
            let sigma = [3.0, 5.0, 7.0];
            let mut m = Matrix3::from_diagonal(&Vector3::from(sigma.map(|s| s * s)));
            m[(i, j)] = correlation * sigma[i] * sigma[j];
            m[(j, i)] = m[(i, j)];
            let least = SymmetricEigen::new(m).eigenvalues.min();
            let offset = Displacement::<Enu>::from_vector(Vector3::zeros());
            let made = deviations(&offset, &Covariance::claim_symmetric(m), tangent.0, tangent.1);
            assert_eq!(made.is_ok(), least >= 0.0, "{i} {j} {correlation} {least}");
        }
    }
}

/// Without a deviation the risk is 0 or 1, and its logarithm minus infinity or 0.
#[test]
fn the_logarithm_of_a_risk_without_a_deviation_is_that_of_zero_or_one() {
    let of = |fte: f64| ln_exceedance_risk(Deviation::new(Metres::new(fte), Metres::new(0.0)).unwrap(), Metres::new(10.0)).unwrap();
    assert_eq!([of(9.0), of(-10.0)], [f64::NEG_INFINITY; 2]);
    assert_eq!([of(11.0), of(-10.1)], [0.0; 2]);
}

/// The residuals of a line in both their signs: (0, 0), (1, 3), (2, 0), (3, 1), by hand: slope 0, intercept 1, squares 1 + 4 + 1 + 0.
#[test]
fn what_is_left_of_a_line_is_the_sum_of_its_squares() {
    let line = navbound_core::monitor::altimeter::setting_line([(0.0, 0.0), (1.0, 3.0), (2.0, 0.0), (3.0, 1.0)].into_iter()).unwrap();
    assert!(line.slope.abs() < 1e-15);
    close(line.intercept.m(), 1.0, 1e-15);
    close(line.residual_sigma.m(), 3.0_f64.sqrt(), 1e-15);
    // With a slope: (0, 1), (1, 2), (2, 6), (3, 7): slope 2.2, intercept 0.7, residuals 0.3, -0.9, 0.9, -0.3.
    let line = navbound_core::monitor::altimeter::setting_line([(0.0, 1.0), (1.0, 2.0), (2.0, 6.0), (3.0, 7.0)].into_iter()).unwrap();
    close(line.slope, 2.2, 1e-14);
    close(line.residual_sigma.m(), 0.9_f64.sqrt(), 1e-13);
}

/// Each of the two walls must be a distance: neither a negative nor an infinite one is.
#[test]
fn walls_of_a_box_are_finite_and_not_negative() {
    let of = |v: f64| Deviation::new(Metres::new(v), Metres::new(5.0)).unwrap();
    let errors = PathDeviations { lateral: of(1.0), vertical: of(2.0), correlation: 0.0 };
    let refused = |l: f64, v: f64| box_risk(&errors, Metres::new(l), Metres::new(v)).err().map(|e| e.argument);
    for bad in [-1.0, f64::INFINITY, f64::NAN, f64::NEG_INFINITY] {
        assert_eq!(refused(bad, 10.0), Some("limit_m"), "{bad}");
        assert_eq!(refused(10.0, bad), Some("limit_v_m"), "{bad}");
    }
    assert_eq!(refused(0.0, 10.0), None);
}

/// A shell of 350 km seen at 30 degrees, worked out with the sine of the angle at the shell: F = 1 / cos(asin(R cos(el) / (R + h))).
#[test]
fn the_slant_ionosphere_is_the_vertical_one_times_the_obliquity() {
    let error = RangeError { corrected_m2: 1.0, ionosphere_m2: 1.0, troposphere_m2: 1.0, airborne_m2: 1.0 };
    for elevation_deg in [5.0_f64, 30.0, 90.0] {
        let el = elevation_deg.to_radians();
        let seen = Seen {
            prn: 1,
            iode: 0,
            unit_enu: Vector3::new(0.6 * el.cos(), 0.8 * el.cos(), el.sin()),
            elevation: Radians::new(el),
            delta_udre: 1.0,
            fast_m: 0.0,
            clock_s: 0.0,
            vertical: Vertical { delay_m: 4.0, variance_m2: 1.0 },
            from_grid: true,
            error,
        };
        let at_shell = (6_378_136.3 * el.cos() / (6_378_136.3 + 350_000.0)).asin();
        close(seen.slant_ionosphere_m(), 4.0 / at_shell.cos(), 1e-12);
    }
}
