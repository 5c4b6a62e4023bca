use super::*;
use proptest::prelude::*;

/// The cases of `oracle/mixture_dense.py`.
fn case(n: usize, faults: &[(usize, f64)]) -> Vec<Observed> {
    let one = |k: usize| {
        let (azimuth, elevation) = ((37.0 + 137.5 * k as f64).to_radians(), (15.0 + (53.0 * k as f64) % 70.0).to_radians());
        let unit = Vector3::new(elevation.cos() * azimuth.sin(), elevation.cos() * azimuth.cos(), elevation.sin());
        let two = n > 6 && k % 2 == 1;
        let fault: f64 = faults.iter().filter(|f| f.0 == k).map(|f| f.1).sum();
        let mut common_m = [0.0; COMMON];
        common_m[0] = 0.4 / elevation.sin();
        common_m[1] = 0.3 * unit.x / elevation.sin();
        Observed {
            unit,
            clock: if two { 2 } else { 0 },
            sigma_m: 0.8 + 0.1 * (k % 4) as f64,
            residual_m: 0.5 * (1.7 * k as f64).cos() + fault + if two { 100.0 } else { 0.0 },
            common_m,
        }
    };
    (0..n).map(one).collect()
}

/// Faults, evidence of obstruction, upper triangle of the covariance at a probability of obstruction of 0.25, farthest horizontal reading.
type Dense = (usize, &'static [(usize, f64)], f64, [f64; 6], f64);

// Printed by `python oracle/mixture_dense.py`, to the digits that it prints.
const DENSE: [Dense; 4] = [
    (
        6,
        &[],
        1.507379247345e-01,
        [1.436790851e+00, -2.742903977e-01, 1.169199819e+00, -1.086022769e-02, 2.851677518e-01, 5.768015183e+00],
        2.323152586,
    ),
    (
        6,
        &[(2, 30.0)],
        6.758839700665e+01,
        [5.501227150e+01, -8.585601874e+00, 5.298906565e+01, 2.640270214e+01, 2.430746094e+01, 1.663428900e+02],
        149.851498606,
    ),
    (
        8,
        &[(1, 12.0), (4, 12.0)],
        3.334184273390e+04,
        [1.245590927e+01, 9.500219191e+00, 1.002585876e+02, 1.195224589e+01, -3.456369771e+01, 9.903858047e+01],
        233.639559960,
    ),
    (
        12,
        &[(3, -500.0), (8, 25.0)],
        2.622251988627e+03,
        [8.567204753e-01, 7.229156924e-02, 4.895209145e-01, -1.443423404e-01, -5.562947717e-02, 7.018148811e+00],
        0.217114433,
    ),
];

#[test]
fn every_reading_weighs_what_a_dense_solution_of_it_does() {
    for (n, faults, evidence, upper, farthest) in DENSE {
        let mixture = Mixture::new(&case(n, faults)).unwrap();
        assert!((mixture.evidence() / evidence - 1.0).abs() < 1e-9, "{n} {faults:?}: {}", mixture.evidence());
        let p = mixture.covariance(0.25, &Matrix3::zeros()).moments;
        let own = [p[(0, 0)], p[(0, 1)], p[(1, 1)], p[(0, 2)], p[(1, 2)], p[(2, 2)]];
        // Ten printed digits of the largest element.
        let scale = upper.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        assert!(own.iter().zip(upper).all(|(a, b)| (a - b).abs() < 1e-8 * scale), "{n} {faults:?}: {own:?}");
        assert!((mixture.farthest[0] - farthest).abs() < 1e-6, "{n} {faults:?}: {}", mixture.farthest[0]);
    }
}

#[test]
fn a_fault_of_one_of_five_ranges_reaches_the_position_that_it_was() {
    // One spare range sees the fault and cannot say where it is: the covariance holds the step of the position, whatever the range.
    for k in 0..5 {
        let clean = Mixture::new(&case(5, &[])).unwrap();
        let mut ranges = case(5, &[(k, 100.0)]);
        let base = Base::new(&ranges).unwrap();
        let moved = base.position;
        for r in &mut ranges {
            r.residual_m += r.unit.dot(&moved);
        }
        let mixture = Mixture::new(&ranges).unwrap();
        let Declared { moments: p, holding: wide, .. } = mixture.covariance(OBSTRUCTED, &Matrix3::identity());
        let error = Base::new(&case(5, &[])).unwrap().position - moved;
        let normalised = error.dot(&(wide.try_inverse().unwrap() * error));
        // The 1e-5 quantile of chi-square with three degrees of freedom is 25.9 (tables).
        assert!(normalised < 25.9, "{k}: {normalised}");
        assert!(p.trace() > 4.0 * clean.covariance(OBSTRUCTED, &Matrix3::identity()).moments.trace(), "{k}");
    }
}

#[test]
fn ranges_that_are_no_numbers_or_too_few_make_no_mixture() {
    let mut ranges = case(7, &[]);
    ranges[3].residual_m = f64::NAN;
    assert_eq!(Mixture::new(&ranges), None);
    assert_eq!(Mixture::new(&case(3, &[])), None);
    assert_eq!(Mixture::new(&[]), None);
}

#[test]
fn gross_faults_neither_overflow_nor_vanish() {
    let mixture = Mixture::new(&case(9, &[(0, 3e5), (5, -2e7)])).unwrap();
    let Declared { moments: p, holding: wide, .. } = mixture.covariance(OBSTRUCTED, &Matrix3::identity());
    assert!(p.iter().chain(wide.iter()).all(|v| v.is_finite()) && p.cholesky().is_some());
}

proptest! {
    /// The order of the ranges, the receiver's clocks and the place that residuals count from carry no information.
    #[test]
    fn the_mixture_ignores_order_and_clocks(n in 5_usize..10, fault in -60.0..60.0_f64, which in 0_usize..5, clock in -1e4..1e4_f64) {
        let ranges = case(n, &[(which, fault)]);
        let mut other: Vec<Observed> = ranges.iter().rev().copied().collect();
        for r in &mut other {
            r.residual_m += clock * (1 + r.clock) as f64;
        }
        let of = |ranges: &[Observed]| Mixture::new(ranges).unwrap().covariance(0.1, &Matrix3::zeros()).moments;
        let (a, b) = (of(&ranges), of(&other));
        // Clocks of 1e4 m take five of sixteen digits.
        prop_assert!((a - b).norm() < 1e-7 * a.norm(), "{a} {b}");
    }

    /// Neither the least covariance nor a reading far away can make it smaller.
    #[test]
    fn the_covariance_is_never_below_the_least(n in 5_usize..12, fault in -200.0..200.0_f64, p in 0.0..1.0_f64) {
        let mixture = Mixture::new(&case(n, &[(1, fault)])).unwrap();
        let least = Matrix3::identity() * 2.0;
        let Declared { moments, reaching, holding } = mixture.covariance(p, &least);
        prop_assert!(moments.trace() >= 6.0 - 1e-12 && reaching.trace() >= moments.trace() * (1.0 - 1e-12));
        prop_assert!(holding.trace() >= reaching.trace() * (1.0 - 1e-12));
        prop_assert!(moments.cholesky().is_some() && holding.cholesky().is_some());
    }
}
