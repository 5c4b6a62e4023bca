//! Every method of the list keeps its promises, whatever its family.
#![allow(clippy::unwrap_used, clippy::panic)] // A test may stop at the first surprise, in its helpers too.

use nalgebra::{Matrix3, Vector3};
use navbound_core::bound::{Bounded, Method, methods};
use navbound_core::frame::{Covariance, Displacement, Enu};
use navbound_core::quantity::{GpsTime, Metres, Radians, Risk, Unavailable};
use navbound_core::solution::Epoch;

/// The ladder of risks. The two of the specifications are among them, since an exhibit may know no other.
const RISKS: [f64; 7] = [0.4, 0.05, 1e-3, 1e-5, 1e-7, 1e-9, 1e-11];
/// What a change of units or axes may move a bound by: the accuracy that the least exact methods promise (radii of a circle or sphere,
/// found by quadrature). Any wrong formula moves it by far more.
const ROUNDING: f64 = 1e-9;

fn rotation(angle: f64) -> Matrix3<f64> {
    let (s, c) = angle.sin_cos();
    // A bearing grows by `angle`: turned clockwise from north.
    Matrix3::new(c, s, 0.0, -s, c, 0.0, 0.0, 0.0, 1.0)
}

/// A complete epoch.
fn epoch(course: f64, path_angle: f64, offset: [f64; 3], factor: Matrix3<f64>) -> Epoch {
    Epoch {
        time: Some(GpsTime::from_nanoseconds(1)),
        course: Some(Radians::new(course)),
        path_angle: Some(Radians::new(path_angle)),
        offset: Some(Displacement::from_vector(Vector3::from(offset))),
        covariance: Some(Covariance::claim_symmetric(factor * factor.transpose())),
        mean: None,
        rnp: Some(Metres::nautical_miles(0.3)),
    }
}

/// Epochs of all kinds: centred, beside the path on either side, far along it, thin ellipses, circles.
fn epochs() -> Vec<Epoch> {
    let round = Matrix3::from_diagonal(&Vector3::new(8.0, 8.0, 12.0));
    let usual = Matrix3::new(6.0, 0.0, 0.0, 2.5, 9.0, 0.0, -1.0, 3.0, 14.0);
    let thin = Matrix3::new(40.0, 0.0, 0.0, 39.0, 0.5, 0.0, 2.0, 0.1, 60.0);
    let offsets = [[0.0, 0.0, 0.0], [3.0, -4.0, 2.0], [-25.0, 6.0, -9.0], [150.0, 90.0, 30.0], [0.0, 0.3, 0.0]];
    let mut all = Vec::new();
    for (k, factor) in [round, usual, thin].into_iter().enumerate() {
        for (j, offset) in offsets.into_iter().enumerate() {
            let course = (0.4 + 1.3 * (k * offsets.len() + j) as f64).rem_euclid(std::f64::consts::TAU);
            all.push(epoch(course, -0.05 * (j as f64 - 1.0), offset, factor));
        }
    }
    let mut moved = all[1];
    moved.mean = Some(Displacement::from_vector(Vector3::new(1.5, -2.0, 0.5)));
    all.push(moved);
    all
}

fn turned(e: &Epoch, angle: f64) -> Epoch {
    let r = rotation(angle);
    Epoch {
        course: e.course.map(|c| Radians::new((c.rad() + angle).rem_euclid(std::f64::consts::TAU))),
        offset: e.offset.map(|d| Displacement::from_vector(r * d.vector())),
        mean: e.mean.map(|d| Displacement::from_vector(r * d.vector())),
        covariance: e.covariance.map(|c| Covariance::claim_symmetric(r * c.matrix() * r.transpose())),
        ..*e
    }
}

fn scaled(e: &Epoch, factor: f64) -> Epoch {
    let stretch = |d: Displacement<Enu>| Displacement::from_vector(d.vector() * factor);
    Epoch {
        offset: e.offset.map(stretch),
        mean: e.mean.map(stretch),
        covariance: e.covariance.map(|c| Covariance::claim_symmetric(c.matrix() * (factor * factor))),
        rnp: e.rnp.map(|r| Metres::new(r.m() * factor)),
        ..*e
    }
}

/// The bound, or `None` where the method knows no such risk (an exhibit that holds printed factors only) or no mean (a fit).
fn bound(method: &Method, e: &Epoch, q: f64) -> Option<f64> {
    match (method.bound)(e, Risk::new(q).unwrap()) {
        Ok(b) => {
            assert!(b.m().is_finite(), "{}: {b:?}", method.id);
            Some(b.m())
        }
        Err(Unavailable::Invalid { field: "risk" | "mean", .. }) => None,
        Err(other) => panic!("{} refuses a complete epoch: {other}", method.id),
    }
}

/// Calls `check` for every method, epoch and risk with the bound there; fails unless there were many.
fn for_all(check: impl Fn(&Method, &Epoch, f64, f64)) {
    let mut checked = 0;
    for method in methods() {
        let before = checked;
        for e in epochs() {
            for q in RISKS {
                if let Some(b) = bound(method, &e, q) {
                    check(method, &e, q, b);
                    checked += 1;
                }
            }
        }
        assert!(checked > before, "{} gave no bound at all", method.id);
    }
    assert!(checked > 100, "only {checked} bounds: the loop is broken");
}

#[test]
fn identifiers_are_unique_and_make_column_names() {
    let ids: Vec<_> = methods().map(|m| m.id).collect();
    assert!(!ids.is_empty());
    for (k, id) in ids.iter().enumerate() {
        assert!(!ids[..k].contains(id), "{id} twice");
        assert!(id.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-'), "{id}");
        assert!(navbound_core::bound::method(id).is_some());
    }
    for m in methods() {
        assert!(!m.title.is_empty() && !m.source.is_empty() && !m.assumes.is_empty(), "{}", m.id);
        assert!(!(m.id.ends_with("as-printed") && m.promises.may_alert), "{}: an exhibit may not alert", m.id);
    }
}

#[test]
fn twice_the_lengths_give_twice_the_bound() {
    for_all(|method, e, q, b| {
        for factor in [2.0, 0.125, 1852.0] {
            let other = bound(method, &scaled(e, factor), q).unwrap() / factor;
            let same = (other - b).abs() <= ROUNDING * b.abs();
            assert!(same || !method.promises.scales_with_length, "{} at {q}: {b} becomes {other}", method.id);
        }
    });
}

#[test]
fn bounds_ignore_where_north_is() {
    for_all(|method, e, q, b| {
        for angle in [0.3, 1.7, 4.0] {
            let other = bound(method, &turned(e, angle), q).unwrap();
            let same = (other - b).abs() <= ROUNDING * b.abs();
            assert!(same || !method.promises.ignores_north, "{} at {q}: {b} becomes {other}", method.id);
        }
    });
}

/// A promise that is not made should be broken somewhere, or the method hides a property that it has.
#[test]
fn a_method_that_minds_north_really_does() {
    for method in methods().filter(|m| !m.promises.ignores_north) {
        let moves = epochs().iter().any(|e| match (bound(method, e, 0.05), bound(method, &turned(e, 0.7), 0.05)) {
            (Some(a), Some(b)) => (a - b).abs() > 1e-6 * a.abs(),
            _ => false,
        });
        // East and north errors do mind it by their meaning.
        assert!(moves, "{} says it minds north, but does not", method.id);
    }
}

#[test]
fn a_smaller_risk_never_gives_a_smaller_bound() {
    let mut pairs = 0;
    for method in methods().filter(|m| m.promises.monotone_in_risk) {
        for e in epochs() {
            let ladder: Vec<_> = RISKS.iter().filter_map(|q| bound(method, &e, *q)).collect();
            for pair in ladder.windows(2) {
                assert!(pair[1] >= pair[0] * (1.0 - ROUNDING), "{}: {ladder:?}", method.id);
                pairs += 1;
            }
        }
    }
    assert!(pairs > 100);
}

/// The deviation of the error along a line in space, and its mean.
fn line(e: &Epoch, bounds: Bounded) -> Option<(f64, f64)> {
    let (s, c) = e.course.unwrap().rad().sin_cos();
    let g = e.path_angle.unwrap().rad().tan();
    let cross = Vector3::new(c, -s, 0.0);
    let along = Vector3::new(s, c, 0.0);
    let up = Vector3::new(0.0, 0.0, 1.0);
    let (u, with_offset) = match bounds {
        Bounded::LateralTse => (cross, true),
        Bounded::VerticalTse => (up - along * g, true),
        Bounded::CrossNse => (cross, false),
        Bounded::AlongNse => (along, false),
        Bounded::VerticalNse => (up, false),
        Bounded::EastNse => (Vector3::new(1.0, 0.0, 0.0), false),
        Bounded::NorthNse => (Vector3::new(0.0, 1.0, 0.0), false),
        Bounded::HorizontalNse | Bounded::SpatialNse => return None,
    };
    let mut mean = e.mean.map_or(0.0, |m| u.dot(m.vector()));
    if with_offset {
        mean += u.dot(e.offset.unwrap().vector());
    }
    Some((mean, e.covariance.unwrap().variance_along(&u).sqrt()))
}

/// Where the bounded error is one number, its true risk at the bound is known: both tails of a normal law.
#[test]
fn the_true_risk_never_exceeds_the_stated_one() {
    let tail = |x: f64| navbound_core::special::tail(x);
    let mut checked = 0;
    for method in methods().filter(|m| m.promises.conservative) {
        for e in epochs() {
            let Some((mean, sigma)) = line(&e, method.bounds) else { continue };
            for q in RISKS {
                let Some(b) = bound(method, &e, q) else { continue };
                let risk = tail((b - mean) / sigma) + tail((b + mean) / sigma);
                // An ulp of the bound moves a tail of u deviations by about u (|mean| / sigma + u) ulps.
                let u = (b - mean.abs()) / sigma;
                let allowed = 1.0 + 1e-14 * (2.0 + u.abs() * (u.abs() + mean.abs() / sigma));
                assert!(risk <= q * allowed, "{} at {q}: true risk {risk}", method.id);
                checked += 1;
            }
        }
    }
    assert!(checked > 100);
}

#[test]
fn a_missing_field_is_named() {
    for method in methods() {
        let refusal = (method.bound)(&Epoch::default(), Risk::ACCURACY);
        assert!(matches!(refusal, Err(Unavailable::Missing { method: id, .. }) if id == method.id), "{}: {refusal:?}", method.id);
        // One field at a time: absent, a method either says so or does not need it.
        for (name, without) in [
            ("course", Epoch { course: None, ..epochs()[1] }),
            ("path_angle", Epoch { path_angle: None, ..epochs()[1] }),
            ("offset", Epoch { offset: None, ..epochs()[1] }),
            ("covariance", Epoch { covariance: None, ..epochs()[1] }),
        ] {
            match (method.bound)(&without, Risk::ACCURACY) {
                Ok(b) => assert_eq!(Some(b.m()), bound(method, &epochs()[1], 0.05), "{} uses {name} silently", method.id),
                Err(Unavailable::Missing { field, .. }) => assert_eq!(field, name, "{}", method.id),
                Err(other) => panic!("{} without {name}: {other}", method.id),
            }
        }
    }
}

/// NaN in a field a method uses is a refusal; in one it does not use, nothing. Never a number made from it.
#[test]
fn a_nan_is_never_a_number() {
    let good = epochs()[1];
    let nan = f64::NAN;
    let with_nan = |i: usize, j: usize| {
        let mut m = *good.covariance.unwrap().matrix();
        (m[(i, j)], m[(j, i)]) = (nan, nan);
        Epoch { covariance: Some(Covariance::claim_symmetric(m)), ..good }
    };
    let offset = |k: usize| {
        let mut d = *good.offset.unwrap().vector();
        d[k] = nan;
        Epoch { offset: Some(Displacement::from_vector(d)), ..good }
    };
    let cases = [
        Epoch { course: Some(Radians::new(nan)), ..good },
        Epoch { path_angle: Some(Radians::new(nan)), ..good },
        offset(0),
        offset(1),
        offset(2),
        with_nan(0, 0),
        with_nan(0, 1),
        with_nan(1, 1),
        with_nan(1, 2),
        with_nan(2, 2),
    ];
    for method in methods() {
        let mut refused = 0;
        for e in &cases {
            match (method.bound)(e, Risk::ACCURACY) {
                Ok(b) => assert_eq!(Some(b.m()), bound(method, &good, 0.05), "{}", method.id),
                Err(Unavailable::Invalid { .. }) => refused += 1,
                Err(other) => panic!("{}: {other}", method.id),
            }
        }
        assert!(refused > 0, "{} refuses no NaN", method.id);
    }
}

#[test]
fn an_impossible_covariance_is_refused() {
    for method in methods() {
        for m in [
            Matrix3::from_diagonal(&Vector3::new(-1.0, -1.0, -1.0)),
            Matrix3::new(1.0, 2.0, 2.0, 2.0, 1.0, 2.0, 2.0, 2.0, 1.0),
            Matrix3::from_diagonal(&Vector3::new(f64::INFINITY, f64::INFINITY, f64::INFINITY)),
        ] {
            let e = Epoch { covariance: Some(Covariance::claim_symmetric(m)), ..epochs()[1] };
            // A bound of one axis may find nothing wrong with the variance of that axis alone.
            let refused = matches!((method.bound)(&e, Risk::ACCURACY), Err(Unavailable::Invalid { .. }));
            let one_axis = matches!(method.bounds, Bounded::VerticalNse | Bounded::EastNse | Bounded::NorthNse) && m[(0, 0)] == 1.0;
            assert!(refused || one_axis, "{} accepts {m}", method.id);
        }
    }
}

/// The fits of a centred error refuse a mean that is none of zero, in any component, and say so; a mean of zero is no mean.
#[test]
fn a_fit_without_a_mean_refuses_one() {
    let mut e = epochs()[1];
    let ids = ["anp-circle-fit", "anp-circle-geodesy", "anp-circle-fit-as-printed", "anp-sphere-grubbs-as-printed"];
    let fits: Vec<_> = methods().filter(|m| ids.contains(&m.id)).collect();
    assert_eq!(fits.len(), ids.len());
    for method in fits {
        e.mean = None;
        let without = (method.bound)(&e, Risk::ACCURACY).unwrap();
        e.mean = Some(Displacement::from_vector(Vector3::zeros()));
        assert_eq!((method.bound)(&e, Risk::ACCURACY), Ok(without), "{}", method.id);
        for k in 0..3 {
            let mut mean = Vector3::zeros();
            mean[k] = 0.5;
            e.mean = Some(Displacement::from_vector(mean));
            let refused = (method.bound)(&e, Risk::ACCURACY).unwrap_err();
            assert!(matches!(refused, Unavailable::Invalid { field: "mean", value: 0.5, .. }), "{} {k}: {refused:?}", method.id);
        }
    }
}
