//! What the total system error must satisfy whatever the numbers.
#![allow(clippy::unwrap_used, clippy::panic)] // A test may stop at the first surprise, in its helpers too.

use nalgebra::{Matrix3, Vector3};
use navbound_core::bound::tse::{self, Component, Deviation, Horizontal, PathDeviations, RandomFte, RotatedFrame};
use navbound_core::frame::{Covariance, Displacement, Enu};
use navbound_core::quantity::{Metres, Radians, Risk};
use navbound_core::special::{PreparedQuantile, one_sided_factor, tail, two_sided_factor};
use proptest::prelude::*;

/// Risks evenly on a logarithmic scale from 1e-9 to 1/2.
fn risks() -> impl Strategy<Value = f64> {
    (1e-9_f64.ln()..0.5_f64.ln()).prop_map(f64::exp)
}

/// Ratios of error to deviation over twelve decades, zero among them.
fn ratios() -> impl Strategy<Value = f64> {
    prop_oneof![Just(0.0), 0.0..8.0, (-14.0..14.0_f64).prop_map(f64::exp)]
}

fn deviation(fte: f64, sigma: f64) -> Deviation {
    Deviation::new(Metres::new(fte), Metres::new(sigma)).unwrap()
}

fn exact(fte: f64, sigma: f64, q: f64) -> f64 {
    tse::exact(deviation(fte, sigma), Risk::new(q).unwrap()).m()
}

/// True risk at a bound.
fn risk_at(bound: f64, fte: f64, sigma: f64) -> f64 {
    tail((bound - fte) / sigma) + tail((bound + fte) / sigma)
}

/// A lateral situation: offset, covariance, course.
fn situations() -> impl Strategy<Value = (Displacement<Enu>, Covariance<Enu>, f64)> {
    let part = || -30.0..30.0_f64;
    (part(), part(), 0.01..40.0_f64, 0.01..40.0_f64, 0.0..6.3_f64, 0.0..core::f64::consts::TAU).prop_map(|(e, n, a, b, axis, course)| {
        let (s, c) = axis.sin_cos();
        let turn = Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0);
        let variances = Matrix3::from_diagonal(&Vector3::new(a * a, b * b, 1.0));
        (Displacement::from_vector(Vector3::new(e, n, 0.0)), Covariance::claim_symmetric(turn * variances * turn.transpose()), course)
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn the_risk_at_the_bound_is_the_risk_requested(m in ratios(), sigma in 1e-3..1e3_f64, q in risks()) {
        let bound = exact(m * sigma, sigma, q);
        let u = (bound - m * sigma) / sigma;
        // The bound is rounded by half an ulp, (m + u) eps / 2 deviations; the logarithm of a tail falls by at most u + 0.8 a deviation
        // (Mills' ratio, largest excess over u at u = 0). 1e-12 is the contract near the path.
        let allowed = 1e-15 * (4.0 + 2.0 * (u + 0.8) * (u + 2.0 * m));
        prop_assert!((risk_at(bound, m * sigma, sigma) / q - 1.0).abs() <= allowed);
        prop_assert!(allowed <= 1e-12 || m > 5.0);
    }

    #[test]
    fn the_excess_lies_between_the_two_factors(m in ratios(), q in risks()) {
        let u = exact(m, 1.0, q) - m;
        // m is added and taken away again.
        let slack = 4e-16 * (m + 7.0);
        prop_assert!(u >= one_sided_factor(q) - slack && u <= two_sided_factor(q) + slack);
    }

    #[test]
    fn the_prepared_table_gives_the_same_bound(m in ratios(), q in risks(), sigma in 1e-3..1e3_f64) {
        let table = PreparedQuantile::new(Risk::new(q).unwrap());
        let (prepared, solved) = (tse::exact_prepared(deviation(m * sigma, sigma), &table).m(), exact(m * sigma, sigma, q));
        prop_assert!((prepared / solved - 1.0).abs() <= 1e-12);
    }

    #[test]
    fn lengths_scale_and_sides_do_not_matter(m in ratios(), q in risks(), c in 1e-4..1e4_f64) {
        let bound = exact(m, 1.0, q);
        prop_assert!((exact(c * m, c, q) / (c * bound) - 1.0).abs() <= 4e-15);
        prop_assert_eq!(exact(-m, 1.0, q), bound);
    }

    #[test]
    fn more_error_more_deviation_less_risk_give_a_larger_bound(m in 0.0..20.0_f64, q in risks(), more in 1.001..3.0_f64) {
        let bound = exact(m, 1.0, q);
        prop_assert!(exact(m * more, 1.0, q) >= bound);
        prop_assert!(exact(m, more, q) > bound);
        prop_assert!(exact(m, 1.0, q / more) > bound);
    }

    #[test]
    fn far_from_the_path_one_tail_is_left(m in 10.0..1e6_f64, q in risks()) {
        let bound = m + one_sided_factor(q);
        prop_assert!((exact(m, 1.0, q) / bound - 1.0).abs() <= 4e-16);
    }

    /// Section 2.6 of the theory: order of the bounds, and what the quicker ones may cost.
    #[test]
    fn the_bounds_keep_their_order((p, cov, course) in situations(), q in risks()) {
        let risk = Risk::new(q).unwrap();
        let lateral = tse::project(&p, &cov, Radians::new(course)).unwrap();
        let ellipse = Horizontal::new(&cov).unwrap();
        let fte = lateral.deviation.fte();
        let exact = tse::exact(lateral.deviation, risk).m();
        let ltem = tse::ltem(lateral.deviation, risk).m();
        let sqsm = tse::sqsm(fte, &ellipse, risk).unwrap().m();
        let ctem = tse::ctem(&p, &ellipse, risk).unwrap().m();
        let foot = tse::ctem_foot(fte, Radians::new(course), &ellipse, risk).unwrap().m();
        let slack = 1.0 + 1e-13;
        prop_assert!(exact <= ltem * slack);
        prop_assert!(ltem <= ctem * slack && ltem <= foot * slack && ltem <= sqsm * slack);
        prop_assert!(foot <= sqsm * slack);
        // LTEM costs less than K - z deviations and at most half of the risk.
        let (sigma, k, z) = (lateral.deviation.sigma().m(), two_sided_factor(q), one_sided_factor(q));
        prop_assert!(ltem - exact <= (k - z) * sigma + 1e-12 * ltem);
        prop_assert!(risk_at(ltem, fte.m(), sigma) >= 0.5 * q * (1.0 - 1e-9));
        // The coverage of SQSM exceeds that of CTEM by no more than that of LTEM exceeds the stated one.
        let beyond = |bound: f64| risk_at(bound, fte.m(), sigma);
        prop_assert!(beyond(foot) - beyond(sqsm) <= q - beyond(ltem) + 1e-12 * q);
    }

    #[test]
    fn reversing_the_course_turns_the_sign_and_nothing_else((p, cov, course) in situations(), q in risks()) {
        let ahead = tse::project(&p, &cov, Radians::new(course)).unwrap();
        let back = tse::project(&p, &cov, Radians::new(course - core::f64::consts::PI)).unwrap();
        prop_assert!((ahead.deviation.fte().m() + back.deviation.fte().m()).abs() <= 1e-13 * p.vector().norm());
        let risk = Risk::new(q).unwrap();
        let (a, b) = (tse::exact(ahead.deviation, risk).m(), tse::exact(back.deviation, risk).m());
        prop_assert!((a / b - 1.0).abs() <= 1e-12);
    }

    /// The paper's frame and the direct projection are the same situation.
    #[test]
    fn slope_and_projection_agree((p, cov, course) in situations()) {
        let ellipse = Horizontal::new(&cov).unwrap();
        let lateral = tse::project(&p, &cov, Radians::new(course)).unwrap();
        let angle = ellipse.angle().rad();
        let (x, y) = (angle.cos() * p.vector().x + angle.sin() * p.vector().y, angle.cos() * p.vector().y - angle.sin() * p.vector().x);
        let k = tse::slope(&ellipse, Radians::new(course));
        let frame = RotatedFrame::new(k, Metres::new(x), Metres::new(y), ellipse.major(), ellipse.minor()).unwrap();
        let size = p.vector().norm() + ellipse.major().m();
        prop_assert!((frame.deviation().fte().m().abs() - lateral.deviation.fte().m().abs()).abs() <= 1e-12 * size);
        prop_assert!((frame.deviation().sigma().m() - lateral.deviation.sigma().m()).abs() <= 1e-9 * size);
    }

    /// No point of the ellipse is farther than CTEM says, and one is as far.
    #[test]
    fn ctem_is_the_farthest_point(x in -20.0..20.0_f64, y in -20.0..20.0_f64, a in 0.0..30.0_f64, b in 0.0..30.0_f64) {
        let farthest = tse::farthest(Metres::new(x), Metres::new(y), Metres::new(a), Metres::new(b)).m();
        let distance = |t: f64| (x + a * t.cos()).hypot(y + b * t.sin());
        let seen = (0..2000).map(|i| distance(core::f64::consts::TAU * f64::from(i) / 2000.0)).fold(0.0, f64::max);
        prop_assert!(seen <= farthest * (1.0 + 1e-14));
        // Between samples the distance grows by less than half a step squared times the size: (pi/2000)^2 / 2 * 100 m.
        prop_assert!(farthest - seen <= 1.3e-4);
    }

    #[test]
    fn budgets_lead_back_to_the_limit(limit in 1.0..2000.0_f64, sigma in 0.1..300.0_f64, share in 0.0..0.999_f64, q in risks()) {
        let risk = Risk::new(q).unwrap();
        match tse::fte_budget(Metres::new(limit), Metres::new(sigma), risk).unwrap() {
            Some(fte) => prop_assert!((exact(fte.m(), sigma, q) / limit - 1.0).abs() <= 1e-12),
            None => prop_assert!(exact(0.0, sigma, q) > limit * (1.0 - 1e-15)),
        }
        let most = tse::sigma_budget(Metres::new(limit), Metres::new(share * limit), risk).unwrap().unwrap();
        prop_assert!((exact(share * limit, most.m(), q) / limit - 1.0).abs() <= 1e-12);
        prop_assert!(tse::sigma_budget(Metres::new(limit), Metres::new(limit * 1.01), risk).unwrap().is_none());
    }

    #[test]
    fn the_gradient_is_the_slope_of_the_bound(fte in -20.0..20.0_f64, sigma in 0.5..20.0_f64, q in risks()) {
        let g = tse::gradient(deviation(fte, sigma), Risk::new(q).unwrap());
        let h = 1e-5 * sigma;
        let by_fte = (exact(fte + h, sigma, q) - exact(fte - h, sigma, q)) / (2.0 * h);
        let by_sigma = (exact(fte, sigma + h, q) - exact(fte, sigma - h, q)) / (2.0 * h);
        // Two-sided differences: h^2 times a third derivative of at most a few 100, and rounding 1e-15 * 100 / 1e-5.
        prop_assert!((g.by_fte - by_fte).abs() <= 1e-7 && (g.by_sigma - by_sigma).abs() <= 1e-7, "{:?} {} {}", g, by_fte, by_sigma);
    }

    #[test]
    fn one_component_or_equal_ones_are_no_mixture(fte in -20.0..20.0_f64, sigma in 0.1..20.0_f64, w in 0.0..1.0_f64, q in risks()) {
        let risk = Risk::new(q).unwrap();
        let parts = [Component { weight: w, deviation: deviation(fte, sigma) }, Component { weight: 1.0 - w, deviation: deviation(-fte, sigma) }];
        let mixed = tse::mixture(&parts, risk).unwrap().m();
        prop_assert!((mixed / exact(fte, sigma, q) - 1.0).abs() <= 1e-13);
    }

    #[test]
    fn a_mixture_meets_its_risk(a in 0.1..20.0_f64, b in 0.1..200.0_f64, w in 1e-6..1.0_f64, fte in -30.0..30.0_f64, q in risks()) {
        let parts = [Component { weight: w, deviation: deviation(fte, a) }, Component { weight: 1.0 - w, deviation: deviation(0.0, b) }];
        let bound = tse::mixture(&parts, Risk::new(q).unwrap()).unwrap().m();
        let risk = w * risk_at(bound, fte, a) + (1.0 - w) * risk_at(bound, 0.0, b);
        // At most 6 deviations wide, at most 300 deviations away: 6 * 306 ulps of the bound.
        prop_assert!((risk / q - 1.0).abs() <= 4e-13, "{:e}", risk / q - 1.0);
    }

    /// Heavier tails never give a smaller bound at the risks of navigation, and many degrees of freedom give the normal one.
    #[test]
    fn student_bounds_are_wider_and_become_normal(fte in 0.0..30.0_f64, nu in 1.0..100.0_f64, q in risks()) {
        prop_assume!(q < 0.1);
        let risk = Risk::new(q).unwrap();
        let normal = exact(fte, 5.0, q);
        prop_assert!(tse::student_t(deviation(fte, 5.0), nu, risk).unwrap().m() > normal);
        let many = tse::student_t(deviation(fte, 5.0), 1e6, risk).unwrap().m();
        // The first correction of a quantile is (u^3 + u) / (4 nu), at u = 6.2 below 7e-5 deviations.
        prop_assert!(many - normal < 5.0 * 7e-5 && many > normal);
    }

    #[test]
    fn a_box_is_left_with_no_more_than_its_risk(fl in -20.0..20.0_f64, fv in -20.0..20.0_f64, sl in 0.5..20.0_f64, sv in 0.5..20.0_f64,
                                              rho in -1.0..=1.0_f64, share in 0.05..0.95_f64, q in risks()) {
        let errors = PathDeviations { lateral: deviation(fl, sl), vertical: deviation(fv, sv), correlation: rho };
        let b = tse::box_limits(&errors, Risk::new(q).unwrap(), share).unwrap();
        prop_assert!(b.risk <= q * (1.0 + 1e-11));
        prop_assert!(b.risk >= b.risk_lateral.max(b.risk_vertical));
        // Independent errors leave the box with the product of their chances to stay.
        let free = tse::box_risk(&PathDeviations { correlation: 0.0, ..errors }, b.limit, b.limit_v).unwrap();
        let product = free.risk_lateral + free.risk_vertical - free.risk_lateral * free.risk_vertical;
        prop_assert!((free.risk / product - 1.0).abs() <= 1e-12);
    }

    #[test]
    fn a_random_error_adds_its_variance(mean in -50.0..50.0_f64, f in 0.0..50.0_f64, n in 0.1..50.0_f64, rho in -1.0..=1.0_f64, q in risks()) {
        let parts = |correlation| RandomFte {
            mean_fte: Metres::new(mean),
            sigma_fte: Metres::new(f),
            sigma_nse: Metres::new(n),
            sigma_pde: Metres::new(0.0),
            correlation,
        };
        let sigma = |r: f64| parts(r).total().unwrap().sigma().m();
        prop_assert!((sigma(0.0) / f.hypot(n) - 1.0).abs() <= 1e-14);
        prop_assert!((sigma(1.0) / (f + n) - 1.0).abs() <= 1e-14);
        // Full opposition cancels; the subtraction costs digits of the larger.
        prop_assert!((sigma(-1.0) - (f - n).abs()).abs() <= 1e-6 * (f + n));
        prop_assert!((sigma(rho) - sigma(1.0)) <= 1e-12);
        prop_assert!(parts(1.01).total().is_err());
        prop_assert!(tse::rssm(&parts(rho), Risk::new(q).unwrap()).unwrap().m() <= exact(mean, sigma(rho), q) * (1.0 + 1e-12));
    }
}

#[test]
fn without_deviation_the_error_is_the_bound() {
    for fte in [0.0, 3.0, -7.5] {
        assert_eq!(exact(fte, 0.0, 0.05), fte.abs());
        assert_eq!(tse::student_t(deviation(fte, 0.0), 3.0, Risk::ACCURACY).unwrap().m(), fte.abs());
        assert_eq!(tse::exceedance_risk(deviation(fte, 0.0), Metres::new(3.0)).unwrap(), if fte.abs() > 3.0 { 1.0 } else { 0.0 });
    }
}

/// What the misprints cost, number by number (docs/methods/tse.md, errata).
#[test]
fn the_misprints_are_exhibited() {
    let covariance = |a: f64, b: f64, c: f64| Covariance::claim_symmetric(Matrix3::new(a, b, 0.0, b, c, 0.0, 0.0, 0.0, 1.0));
    // E2: 4.41 leaves 1.0337e-5.
    let k = tse::factor_as_printed(Risk::INTEGRITY).unwrap();
    assert!((2.0 * tail(k) / 1.033_706e-5 - 1.0).abs() < 1e-6);
    assert!(tse::factor_as_printed(Risk::new(1e-7).unwrap()).is_err());
    // E3: the printed slope is right for a due-north path alone; at 13.3 degrees it gives 7.74597 m for 7.56790 m.
    let ellipse = Horizontal::new(&covariance(60.0, 12.0, 110.0)).unwrap();
    let sigma = |k: f64| {
        let zero = Metres::new(0.0);
        RotatedFrame::new(k, zero, zero, ellipse.major(), ellipse.minor()).unwrap().deviation().sigma().m()
    };
    assert!((sigma(tse::slope_as_printed(&ellipse)) - 7.745_97).abs() < 5e-6);
    assert!((sigma(tse::slope(&ellipse, Radians::degrees(13.3))) - 7.567_90).abs() < 5e-6);
    // E13: a bound of -5.49 m where 8.652 m is right (k = 1, (0, 10), a = 2, b = 1, in units of the ellipse).
    let unit = 1.0 / two_sided_factor(0.05);
    let frame = RotatedFrame::new(1.0, Metres::new(0.0), Metres::new(10.0), Metres::new(2.0 * unit), Metres::new(unit)).unwrap();
    let (fte, half_width) = (frame.deviation().fte().m(), 1.96 * frame.deviation().sigma().m());
    assert!((half_width - fte + 5.49).abs() < 5e-3);
    assert!((tse::ltem(frame.deviation(), Risk::ACCURACY).m() - 8.652).abs() < 5e-4);
    // The same through the printed formula: a path due north, the estimate to the left of it, circles of 5 m.
    let left = Displacement::from_vector(Vector3::new(-10.0, 0.0, 0.0));
    let right = Displacement::from_vector(Vector3::new(10.0, 0.0, 0.0));
    let ellipse = Horizontal::new(&covariance(25.0, 0.0, 36.0)).unwrap();
    let printed = [left, right].map(|p| tse::ltem_as_printed(&p, &ellipse, Risk::ACCURACY).unwrap().m());
    assert!((printed[0] - printed[1]).abs() > 19.0 && printed[0].min(printed[1]) < 0.0, "{printed:?}");
}
