//! What must be true of every actual navigation performance, whatever its numbers.

use nalgebra::{Matrix3, Rotation3, Vector3};
use navbound_core::bound::anp::{circle, directional, ellipsoid, flat, intercept, radius_law, radius_m, sphere, support};
use navbound_core::frame::{Covariance, Displacement, Enu};
use navbound_core::quantity::{Metres, Radians, Risk};
use navbound_core::special::radius::{CentredRadius, RadiusLaw, Rule};
use navbound_core::special::{chi, two_sided_factor};
use proptest::prelude::*;

const NAMES: [&str; 2] = ["covariance", "mean"];

fn upper(v: &Matrix3<f64>) -> [f64; 6] {
    [v[(0, 0)], v[(0, 1)], v[(1, 1)], v[(0, 2)], v[(1, 2)], v[(2, 2)]]
}

/// V = A diag(sigma^2) A' and a mean of `delta` standard deviations along the same axes.
fn error(sigma: Vector3<f64>, turn: Vector3<f64>, delta: Vector3<f64>) -> (Matrix3<f64>, Vector3<f64>) {
    let a = Rotation3::from_scaled_axis(turn);
    let v = a.matrix() * Matrix3::from_diagonal(&sigma.component_mul(&sigma)) * a.matrix().transpose();
    (0.5 * (v + v.transpose()), a * sigma.component_mul(&delta))
}

/// Ratios down to 1/300, any scale between a millimetre and 100 km.
fn sigmas() -> impl Strategy<Value = Vector3<f64>> {
    (-3.0..5.0_f64, 0.003..1.0_f64, 0.003..1.0_f64).prop_map(|(e, r, s)| Vector3::new(1.0, r, s) * 10_f64.powf(e))
}

fn vectors(limit: f64) -> impl Strategy<Value = Vector3<f64>> {
    prop::array::uniform3(-limit..limit).prop_map(Vector3::from)
}

/// Risks from 1e-5 to 0.9, evenly in the logarithm.
fn risks() -> impl Strategy<Value = f64> {
    (-11.5..-0.106_f64).prop_map(f64::exp)
}

/// Risks that a bound takes: up to one half.
fn tails() -> impl Strategy<Value = f64> {
    (-11.5..-0.694_f64).prop_map(f64::exp)
}

fn radius(v: &Matrix3<f64>, mean: &Vector3<f64>, q: f64) -> f64 {
    radius_m(upper(v), (*mean).into(), q, NAMES).unwrap_or(f64::NAN)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, ..ProptestConfig::default() })]

    #[test]
    fn turning_the_axes_changes_no_sphere(s in sigmas(), a in vectors(3.0), b in vectors(3.0), d in vectors(3.0), q in risks()) {
        let ((v, m), (w, n)) = (error(s, a, d), error(s, b, d));
        let (one, other) = (radius(&v, &m, q), radius(&w, &n, q));
        // Rounding of V moves a small variance by 1e-16 of the largest; the radius keeps its 1e-9 through the tail's noise.
        prop_assert!((one / other - 1.0).abs() < 1e-9, "{one} {other}");
    }

    #[test]
    fn radii_scale_with_length(s in sigmas(), a in vectors(3.0), d in vectors(3.0), q in risks(), scale in 0.01..100.0_f64) {
        let (v, m) = error(s, a, d);
        let (one, scaled) = (radius(&v, &m, q), radius(&(v * scale * scale), &(m * scale), q));
        prop_assert!((scaled / (scale * one) - 1.0).abs() < 1e-9);
    }

    #[test]
    fn a_smaller_risk_has_a_larger_radius(s in sigmas(), a in vectors(3.0), d in vectors(3.0), q in risks(), less in 0.5..0.99_f64) {
        let (v, m) = error(s, a, d);
        prop_assert!(radius(&v, &m, q * less) > radius(&v, &m, q));
    }

    #[test]
    fn more_covariance_has_a_larger_radius(s in sigmas(), a in vectors(3.0), extra in vectors(0.3), q in risks()) {
        let (v, zero) = error(s, a, Vector3::zeros());
        let push = extra * s[0];
        prop_assert!(radius(&(v + push * push.transpose()), &zero, q) >= radius(&v, &zero, q) * (1.0 - 1e-9));
    }

    #[test]
    fn the_risk_at_the_radius_is_the_risk(s in sigmas(), a in vectors(3.0), d in vectors(5.0), q in risks()) {
        let (v, m) = error(s, a, d);
        let law = radius_law(upper(&v), m.into(), NAMES).unwrap();
        let at = law.at(law.radius(q));
        // The radius is good to 1e-9 and a tail moves by about R^2 times that.
        prop_assert!((at.outside / q - 1.0).abs() < 1e-7 && (at.inside - (1.0 - q)).abs() < 1e-9 * (1.0 - q) + 1e-13, "{at:?} {q}");
    }

    #[test]
    fn the_prepared_radius_is_the_safeguarded_one(s in sigmas(), a in vectors(3.0), q in risks()) {
        let (v, _) = error(s, a, Vector3::zeros());
        if let Some(prepared) = CentredRadius::new(q) {
            let [fast] = prepared.radii(&upper(&v).map(|x| [x]));
            let slow = radius_law(upper(&v), [0.0; 3], NAMES).unwrap().radius(q);
            prop_assert!((fast / slow - 1.0).abs() < 2e-10, "{fast} {slow}");
            let lanes: [f64; 8] = prepared.radii(&upper(&v).map(|x| [x; 8]));
            prop_assert!(lanes.iter().all(|r| r.to_bits() == fast.to_bits()));
        }
    }

    #[test]
    fn the_ellipsoid_reaches_further_than_the_direction_alone(s in sigmas(), a in vectors(3.0), u in vectors(1.0), q in tails()) {
        prop_assume!(u.norm() > 0.1);
        let (v, _) = error(s, a, Vector3::zeros());
        let (v, u, q) = (Covariance::<Enu>::claim_symmetric(v), u.normalize(), Risk::new(q).unwrap());
        let alone = directional(&v, &u, None, q).unwrap();
        let reach = support(&v, &u, q).unwrap().m();
        prop_assert!(alone.half_width.m() < reach);
        prop_assert!((alone.half_width.m() / (two_sided_factor(q.q()) * alone.sigma.m()) - 1.0).abs() < 1e-14);
        if let Some(pierced) = intercept(&v, &u, q).unwrap() {
            prop_assert!(pierced.m() <= reach * (1.0 + 1e-12));
        }
    }

    #[test]
    fn a_course_turns_with_its_covariance(s in sigmas(), a in vectors(3.0), course in -7.0..7.0_f64, q in tails()) {
        let (v, _) = error(s, a, Vector3::zeros());
        let v = Covariance::<Enu>::claim_symmetric(v);
        let (cross, q) = (Vector3::new(course.cos(), -course.sin(), 0.0), Risk::new(q).unwrap());
        let sigma = v.to_track(Radians::new(course)).matrix()[(1, 1)].sqrt();
        let along = directional(&v, &cross, None, q).unwrap().sigma.m();
        // The thin direction of an ellipse of ratio 300 loses five digits to cancellation.
        prop_assert!((along / sigma - 1.0).abs() < 1e-10, "{along} {sigma}");
    }
}

/// The fast rule against the positive sums, with and without a mean; nested sums are slow, so most cases are in the plane.
#[test]
fn contour_and_strip_agree() {
    let mut state: u64 = 20_220_703;
    let mut uniform = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    for case in 0..3000 {
        let mut sigma = [1.0, uniform(), if case % 50 == 0 { uniform().powi(3) } else { 0.0 }];
        sigma.sort_unstable_by(|a, b| b.total_cmp(a));
        let reach = [0.0, 3.0, 5.0][case % 3];
        let mean = sigma.map(|s| s * reach * (2.0 * uniform() - 1.0));
        let law = RadiusLaw::new(sigma.map(|s| s * s), mean);
        for radius in [0.7, 1.5, 2.8, 4.0] {
            let (contour, strip) = (law.at(radius), law.at_by_strip(radius));
            assert!((contour.outside - strip.outside).abs() < 3e-14, "{case}: {sigma:?} {mean:?} {radius} {contour:?} {strip:?}");
            assert!((contour.density - strip.density).abs() < 3e-13 * (1.0 + strip.density), "{case}: {contour:?} {strip:?}");
        }
    }
}

/// The contour through the saddle point against the positive sums: means of up to 40 deviations along any axis, thin axes, and sides down to
/// 1e-60, each to a share of itself.
#[test]
fn saddle_point_and_strip_agree() {
    let mut state: u64 = 20_260_726;
    let mut uniform = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let mut seen = 0;
    for case in 0..1500 {
        let spread = [0.5, 2.0, 5.0][case % 3];
        let mut sigma = [1.0, 10.0_f64.powf(-spread * uniform()), if case % 75 == 0 { 10.0_f64.powf(-spread * uniform()) } else { 0.0 }];
        sigma.sort_unstable_by(|a, b| b.total_cmp(a));
        let reach = [0.0, 8.0, 40.0][case / 3 % 3];
        let mean = sigma.map(|s| if uniform() < 0.3 { 0.0 } else { s * reach * (2.0 * uniform() - 1.0) });
        let law = RadiusLaw::new(sigma.map(|s| s * s), mean);
        let length = mean.iter().map(|m| m * m).sum::<f64>().sqrt();
        for away in [-6.0, -1.0, 0.0, 2.0, 5.0, 12.0] {
            let radius = length + away * (0.2 + uniform());
            if radius < 1e-3 {
                continue;
            }
            let (contour, strip) = (law.at(radius), law.at_by_strip(radius));
            let (a, b) = if strip.inside < strip.outside { (contour.inside, strip.inside) } else { (contour.outside, strip.outside) };
            // Where the fixed contours run they know a probability to 3e-14; a side is never below 2e-5 there.
            let allowed = 3e-10 * b + 3e-14 * f64::from(u8::from(law.rule() != Rule::Saddle && b > 1e-5));
            assert!((a - b).abs() <= allowed || b < 1e-60, "{case}: {sigma:?} {mean:?} {radius} {contour:?} {strip:?}");
            assert!((contour.density / strip.density - 1.0).abs() < 1e-7 || !(1e-60..=1e-5).contains(&b), "{case}: {contour:?} {strip:?}");
            seen += usize::from(law.rule() == Rule::Saddle || b < 1e-5);
        }
    }
    assert!(seen > 2000, "{seen}");
}

/// Between the two sides of each limit of the guard the radius must not jump.
#[test]
fn the_radius_is_continuous_across_every_guard() {
    let sigma = [3.0, 1.0, 0.4];
    let limits =
        [(0.0_f64, Rule::Talbot14, Rule::Parabola20), (20.0, Rule::Parabola20, Rule::Parabola24), (50.0, Rule::Parabola24, Rule::Saddle)];
    for (squared, below, above) in limits {
        for (q, axis) in [0.9, 0.5, 0.05, 1e-3, 1e-5].into_iter().flat_map(|q| [0, 1, 2].map(|axis| (q, axis))) {
            let law = |delta: f64| {
                let mut mean = [0.0; 3];
                mean[axis] = delta * sigma[axis];
                RadiusLaw::new(sigma.map(|s| s * s), mean)
            };
            let delta = squared.sqrt();
            let (inner, outer) = (law(delta * (1.0 - 1e-12)), law(if delta > 0.0 { delta * (1.0 + 1e-12) } else { 1e-9 }));
            assert_eq!((inner.rule(), outer.rule()), (below, above));
            let (inner, outer) = (inner.radius(q), outer.radius(q));
            assert!((inner / outer - 1.0).abs() < 1e-9, "delta^2 = {squared}, risk {q}, axis {axis}: {inner} {outer}");
        }
    }
    for edge in [1e-6, 0.5, 1.0 - 1e-6] {
        for mean in [[0.0; 3], [1.0, 2.0, -0.5]] {
            let law = RadiusLaw::new(sigma.map(|s| s * s), mean);
            let (inner, outer) = (law.radius(edge * (1.0 - 1e-11)), law.radius(edge * (1.0 + 1e-11)));
            // Near probability one a relative 1e-11 of the risk is 1e-5 of the inside, a third of that of the radius.
            let moved = if edge > 0.9 { 4e-5 } else { 1e-9 };
            assert!((inner / outer - 1.0).abs() < moved, "risk {edge}: {inner} {outer}");
        }
    }
}

#[test]
fn fewer_dimensions_are_limits_of_more() {
    for q in [0.9, 0.5, 0.05, 1e-3, 1e-5, 1e-8, 1e-12] {
        let r = |v: [f64; 3]| RadiusLaw::new(v, [0.0; 3]).radius(q);
        let line = two_sided_factor(q);
        let (plane, space) = (chi::chi_factor(2, q).unwrap(), chi::chi_factor(3, q).unwrap());
        let limits = [
            ([1.0, 0.0, 0.0], line),
            ([1.0, 1e-25, 1e-30], line),
            ([1.0, 1e-20, 0.0], line),
            ([1.0, 1.0, 0.0], plane),
            ([1.0, 1.0, 1e-20], plane),
            ([1.0, 1.0, 1.0], space),
        ];
        for (variances, exact) in limits {
            assert!((r(variances) / exact - 1.0).abs() < 1e-9, "risk {q}: {variances:?} {} {exact}", r(variances));
        }
    }
}

#[test]
fn dead_axes_add_their_mean_to_the_square() {
    let law = RadiusLaw::new([4.0, 0.0, 0.0], [0.0, 3.0, 4.0]);
    let exact = (25.0 + (2.0 * two_sided_factor(0.05)).powi(2)).sqrt();
    assert!((law.radius(0.05) / exact - 1.0).abs() < 1e-15);
    assert_eq!(law.at(4.9).outside, 1.0);
    let point = RadiusLaw::new([0.0; 3], [0.0, 3.0, 4.0]);
    assert_eq!(point.radius(0.05), 5.0);
    assert_eq!((point.at(4.999).outside, point.at(5.0).outside), (1.0, 0.0));
}

#[test]
fn the_seeds_printed_numbers() {
    let risk = Risk::ACCURACY;
    // Algorithm 1, step 4: bisection of eq. 32 until |P - 0.95| < 1e-6 prints 2.79548.
    let inside = |w: f64| 1.0 - 2.0 * navbound_core::special::tail(w) - 2.0 * w * navbound_core::special::normal::density(w);
    let (mut lo, mut hi) = (0.0, 10.0);
    let mut w = 5.0;
    while (inside(w) - 0.95_f64).abs() >= 1e-6 {
        if inside(w) < 0.95 {
            lo = w
        } else {
            hi = w
        }
        w = 0.5 * (lo + hi);
    }
    // 1e-6 of probability is 8e-6 of w: the printed digits just meet the tolerance.
    assert!((w - 2.79548).abs() < 8e-6 + 5e-6, "{w}");
    assert!((chi::chi_factor(3, 0.05).unwrap() - 2.795_483_482_915_107).abs() < 1e-14);
    // Table 3 implies these sigmas (specification, section 5).
    let v = Covariance::<Enu>::from_upper([0.5912_f64.powi(2), 0.0, 0.81557_f64.powi(2), 0.0, 0.0, 1.25113_f64.powi(2)]);
    assert!((circle(&v, None, risk).unwrap().m() - 1.765_873).abs() < 5e-7);
    assert!((sphere(&v, None, risk).unwrap().m() - 2.719_765).abs() < 5e-7);
    assert!((ellipsoid(&v, risk).unwrap().factor - 2.79548).abs() < 5e-6);
}

#[test]
fn what_is_no_covariance_is_refused() {
    let identity = [1.0, 0.0, 1.0, 0.0, 0.0, 1.0];
    let bad = [
        [1.0, 2.0, 1.0, 0.0, 0.0, 1.0],
        [1.0, 0.0, 1.0, 0.0, 0.0, -1.0],
        [-1.0, 0.0, -1.0, 0.0, 0.0, -1.0],
        [1.0, f64::NAN, 1.0, 0.0, 0.0, 1.0],
        [f64::INFINITY, 0.0, 1.0, 0.0, 0.0, 1.0],
        [0.0, 1.0, 0.0, 0.0, 0.0, 0.0],
        // Two negative eigenvalues, whose product is positive.
        [1.0, 0.0, -0.1, 0.0, 0.0, -0.1],
    ];
    for (v, q) in bad.into_iter().flat_map(|v| [(v, 0.05), (v, 1e-9)]) {
        assert_eq!(radius_m(v, [0.0; 3], q, NAMES).unwrap_err().argument, "covariance", "{v:?}");
    }
    for mean in [f64::NAN, f64::INFINITY] {
        assert_eq!(radius_m(identity, [0.0, mean, 0.0], 0.05, NAMES).unwrap_err().argument, "mean");
    }
    let v = Covariance::<Enu>::from_upper(identity);
    let m = Displacement::<Enu>::new(Metres::new(f64::NAN), Metres::new(0.0), Metres::new(0.0));
    assert_eq!(directional(&v, &Vector3::x(), Some(&m), Risk::ACCURACY).unwrap_err().argument, "mean");
    assert_eq!(directional(&v, &Vector3::zeros(), None, Risk::ACCURACY).unwrap_err().argument, "direction");
    // Rounding below zero is not a refusal, and the circle ignores the vertical.
    let almost = radius_m([1.0, 0.0, -1e-11, 0.0, 0.0, 0.0], [0.0; 3], 0.05, NAMES).unwrap();
    assert!((almost / two_sided_factor(0.05) - 1.0).abs() < 1e-12);
    assert_eq!(flat([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]), [1.0, 2.0, 3.0, 0.0, 0.0, 0.0]);
}

#[test]
fn a_covariance_with_one_element_that_is_no_number_is_none() {
    for i in 0..3 {
        for j in 0..3 {
            for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                let mut v = Matrix3::<f64>::identity();
                (v[(i, j)], v[(j, i)]) = (bad, bad);
                assert!(Covariance::<Enu>::new(v).is_err(), "{i} {j} {bad}");
            }
        }
    }
}
