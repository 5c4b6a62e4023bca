use super::*;
use crate::frame::{Geodetic, LatLon};
use crate::geometry::ionosphere::Ionosphere;
use crate::quantity::{GpsTime, Metres, Radians};
use crate::signal::Klobuchar;
use nalgebra::SMatrix;
use proptest::prelude::*;

fn towards(az_deg: f64, el_deg: f64) -> Vector3<f64> {
    let (az, el) = (az_deg.to_radians(), el_deg.to_radians());
    Vector3::new(az.sin() * el.cos(), az.cos() * el.cos(), el.sin())
}

fn over(lat_deg: f64, ionosphere: Ionosphere) -> Overhead {
    let here = Geodetic { point: LatLon::new(Radians::degrees(lat_deg), Radians::degrees(7.0)).unwrap(), height: Metres::new(0.0) };
    ionosphere.over(&here, GpsTime::from_nanoseconds(15_075 * 86_400_000_000_000).plus_seconds(13.5 * 3600.0))
}

fn broadcast() -> Ionosphere {
    Ionosphere::broadcast(Klobuchar { alpha: [1e-8, 0.0, 0.0, 0.0], beta: [9e4, 0.0, 0.0, 0.0] }).unwrap()
}

/// psi and F by the standard's angles. 1e-12 Mm: the difference of angles loses what the other form keeps.
#[test]
fn the_pierce_point_is_that_of_the_standards_angles() {
    for el_deg in [5.0, 10.0, 30.0, 60.0, 89.0, 89.999] {
        let ratio = 6378.1363 / 6728.1363;
        let el = f64::to_radians(el_deg);
        let psi = core::f64::consts::FRAC_PI_2 - el - (ratio * el.cos()).asin();
        let (obliquity, [east, north]) = pierce(&towards(30.0, el_deg));
        assert!((obliquity - (1.0 - (ratio * el.cos()).powi(2)).sqrt().recip()).abs() < 1e-12);
        assert!((east - 6.728_136_3 * psi * 0.5).abs() < 1e-12, "{el_deg}");
        assert!((north - 6.728_136_3 * psi * 0.75f64.sqrt()).abs() < 1e-12, "{el_deg}");
    }
    assert_eq!(pierce(&Vector3::z()).1, [0.0, 0.0]);
}

#[test]
fn the_sizes_follow_the_message() {
    let errors = CommonErrors::CALIBRATED;
    let at = over(60.0, broadcast());
    let sizes = errors.sizes(&at);
    let (i, a) = (at.vertical_m, 2.997_924_58);
    assert!((sizes.sigma.x - (0.25 * i).hypot(0.10 * a)).abs() < 1e-12);
    assert!((sizes.sigma.y - (0.20 * i).hypot(0.08 * a)).abs() < 1e-12);
    assert_eq!((sizes.sigma.y, sizes.sigma.w), (sizes.sigma.z, 0.10));
    assert!((sizes.uneven_m - 0.3 * sizes.sigma.x).abs() < 1e-12);
    // Beside the magnetic equator the crests stand north or south.
    let south = over(10.0, broadcast());
    assert!((errors.sizes(&south).sigma.z - 1.75 * (0.20 * south.vertical_m).hypot(0.08 * a)).abs() < 1e-12);
}

/// What a plane through the zenith leaves of a curved ionosphere grows by the square of the distance.
#[test]
fn what_is_left_to_a_satellite_grows_by_the_square_of_its_distance() {
    let south = over(10.0, broadcast());
    let sizes = CommonErrors::CALIBRATED.sizes(&south);
    assert_eq!(sizes.left_m([0.0, 0.0]), sizes.uneven_m);
    let curved = |d: f64| sizes.left_m([0.6 * d, 0.8 * d]).powi(2) - sizes.uneven_m.powi(2);
    assert!((curved(1.0).sqrt() - 0.25 * sizes.sigma.z).abs() < 1e-12);
    assert!((curved(1.4) / curved(0.7) - 16.0).abs() < 1e-9);
}

#[test]
fn the_less_is_known_of_the_ionosphere_the_larger_its_error() {
    let size = |ionosphere| CommonErrors::CALIBRATED.sizes(&over(45.0, ionosphere)).sigma;
    let (level, climate, nothing) =
        (size(Ionosphere::galileo([130.0, 0.0, 0.0]).unwrap()), size(Ionosphere::Climatology), size(Ionosphere::Uncorrected));
    assert!(climate.x > level.x && nothing.x > climate.x && climate.y > level.y && climate.z > level.z);
    // A sun one standard deviation above the mean: I grows by 70 k12 / (k11 + 130 k12) of it, A to 200 sfu.
    let mean = over(45.0, Ionosphere::Climatology).vertical_m;
    let spread = mean * 70.0 * 0.13985 / (1.41808 + 130.0 * 0.13985);
    let activity = 0.04 * 200.0;
    let expected = [0.25 * (mean + spread), 0.10 * activity, 0.5, spread];
    assert!((climate.x - expected.iter().map(|p| p * p).sum::<f64>().sqrt()).abs() < 1e-9);
    assert!((climate.y - (0.20 * (mean + spread)).hypot(0.08 * activity)).abs() < 1e-9);
    // No correction: the whole of the delay is error.
    assert!(nothing.x >= over(45.0, Ionosphere::Uncorrected).vertical_m);
    let doubled = CommonErrors { factor: 2.0, ..CommonErrors::CALIBRATED }.sizes(&over(45.0, Ionosphere::Climatology));
    assert_eq!(doubled.sigma, 2.0 * climate);
    // What single satellites keep is no common error.
    assert_eq!(doubled.uneven_m, CommonErrors::CALIBRATED.sizes(&over(45.0, Ionosphere::Climatology)).uneven_m);
}

const N: usize = 12;

/// Ranges of two clocks: residuals, weights, and columns.
fn ranges(draw: &[(f64, f64, f64, f64)], sizes: &Sizes) -> ([Row; N], [Vector4<f64>; N]) {
    let rows = core::array::from_fn(|i| {
        let (az, el, sigma, residual) = draw[i];
        Row { unit: towards(az, el), weight: 1.0 / (sigma * sigma), clock: 2 * (i % 2), residual }
    });
    let columns = core::array::from_fn(|i| {
        let (obliquity, place) = pierce(&rows[i].unit);
        sizes.column(obliquity, place, 1.0 / rows[i].unit.z)
    });
    (rows, columns)
}

fn left(normal: &Normal, rows: &[Row; N], columns: &[Vector4<f64>; N]) -> [Left; N] {
    let step = normal.step().unwrap();
    core::array::from_fn(|i| {
        let residual = rows[i].residual + rows[i].unit.dot(&step) - normal.clock(rows[i].clock, &step);
        Left { row: rows[i], common: columns[i], residual }
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(80))]
    // Against matrices of all ranges: V = S (W^-1 + B B') S', q = r' (Q R Q')^-1 r in the space of the residuals, and the statistic of the
    // remaining ranges without one. Both lose about condition * 1e-16; conditions are kept below 1e6.
    #[test]
    fn the_small_matrices_are_the_large_ones(draw in proptest::array::uniform12((0.0..360.0f64, 8.0..89.0f64, 0.5..5.0f64, -8.0..8.0f64))) {
        let sizes = CommonErrors::CALIBRATED.sizes(&over(20.0, broadcast()));
        let (rows, columns) = ranges(&draw, &sizes);
        let Ok(normal) = Normal::new(rows.iter().copied()) else { return Ok(()) };
        let h = SMatrix::<f64, N, 5>::from_fn(|i, j| if j < 3 { -rows[i].unit[j] } else { f64::from(u8::from(rows[i].clock == 2 * (j - 3))) });
        let b = SMatrix::<f64, N, 4>::from_fn(|i, j| columns[i][j]);
        let variance = SMatrix::<f64, N, N>::from_diagonal(&nalgebra::SVector::<f64, N>::from_fn(|i, _| 1.0 / rows[i].weight));
        let whole = variance + b * b.transpose();
        let w = variance.try_inverse().unwrap();
        let n = h.transpose() * w * h;
        let eigenvalues = n.symmetric_eigenvalues();
        prop_assume!(eigenvalues.max() < 1e6 * eigenvalues.min());
        let s = n.try_inverse().unwrap() * h.transpose() * w;
        let small = InSolution::new(&normal, left(&normal, &rows, &columns).into_iter()).unwrap();
        let v = s * whole * s.transpose();
        let ours = normal.covariance().unwrap().matrix() + small.covariance();
        prop_assert!((ours - v.fixed_view::<3, 3>(0, 0)).amax() < 1e-8 * v.amax());

        // r' A r with A = R^-1 - R^-1 H (H'R^-1 H)^-1 H' R^-1: the residuals with their full covariance.
        let dense = |keep: &dyn Fn(usize) -> bool| {
            let large = SMatrix::<f64, N, N>::from_fn(|i, j| if i == j && !keep(i) { 1e15 } else { whole[(i, j)] * f64::from(u8::from(keep(i) && keep(j))) });
            let inverse = large.try_inverse().unwrap();
            let k = (h.transpose() * inverse * h).try_inverse().unwrap();
            let a = inverse - inverse * h * k * h.transpose() * inverse;
            let r = nalgebra::SVector::<f64, N>::from_fn(|i, _| rows[i].residual);
            (r.transpose() * a * r)[0]
        };
        let q = dense(&|_| true);
        prop_assert!((small.statistic - q).abs() < 1e-9 * (1.0 + q) * eigenvalues.max().max(1.0), "{} {q}", small.statistic);
        let all = left(&normal, &rows, &columns);
        for (i, range) in all.iter().enumerate() {
            let fallen = q - dense(&|k| k != i);
            prop_assert!((small.fall(&normal, range) - fallen).abs() < 1e-6 * (1.0 + q), "{i}: {} {fallen}", small.fall(&normal, range));
        }
    }
}
