use super::*;
use proptest::prelude::*;

/// Every grid point of the world, the value a plane in latitude and longitude; polar rows as bands 9 and 10 have them.
fn world(value: impl Fn(f64, f64) -> f64) -> Grid {
    let mut grid = Grid::default();
    for band in 0..11 {
        for number in 1..=201 {
            if let Some(p) = crate::signal::sbas::grid::place(band, number) {
                let v = value(f64::from(p.lat_deg), f64::from(p.lon_deg));
                grid.0[p.cell().unwrap()] = Point::Value(v, 2.0 * v);
            }
        }
    }
    grid
}

fn at(lat_deg: f64, lon_deg: f64) -> Pierce {
    Pierce { lat_deg, lon_deg }
}

fn set(grid: &mut Grid, lat_deg: i16, lon_deg: i16, point: Point) {
    grid.0[GridPoint { lat_deg, lon_deg }.cell().unwrap()] = point;
}

#[test]
fn a_constant_grid_is_that_constant_everywhere() {
    let grid = world(|_, _| 3.0);
    for lat in -90..=90 {
        for lon in -180..=180 {
            let v = grid.vertical(at(f64::from(lat) * 0.999, f64::from(lon) * 0.999));
            assert!((v.unwrap().delay_m - 3.0).abs() < 1e-12, "{lat} {lon} {v:?}");
            assert!((v.unwrap().variance_m2 - 6.0).abs() < 1e-12);
        }
    }
}

#[test]
fn one_silent_corner_leaves_a_triangle_and_two_leave_nothing() {
    let plane = |lat: f64, lon: f64| 10.0 + 0.1 * lat + 0.01 * lon;
    let mut grid = world(plane);
    set(&mut grid, 40, 140, Point::NotMonitored);
    // The plane is met on the other side of the diagonal; on the corner's side there is nothing.
    let far = at(36.0, 138.0);
    assert!((grid.vertical(far).unwrap().delay_m - plane(far.lat_deg, far.lon_deg)).abs() < 1e-12);
    assert_eq!(grid.vertical(at(39.5, 139.5)), None);
    set(&mut grid, 35, 135, Point::NotMonitored);
    assert_eq!(grid.vertical(at(36.0, 138.0)), None);
}

#[test]
fn a_forbidden_corner_forbids_the_cell() {
    let mut grid = world(|_, _| 1.0);
    set(&mut grid, 40, 140, Point::DoNotUse);
    assert_eq!(grid.vertical(at(36.0, 136.0)), None);
    assert!(grid.vertical(at(34.0, 136.0)).is_some());
}

#[test]
fn a_corner_that_is_not_in_the_mask_leaves_a_triangle_then_the_large_cell() {
    let plane = |lat: f64, lon: f64| 10.0 + 0.1 * lat + 0.01 * lon;
    let mut grid = world(plane);
    set(&mut grid, 40, 140, Point::Absent);
    for (lat, lon) in [(36.0, 136.0), (39.5, 139.5)] {
        let v = grid.vertical(at(lat, lon)).unwrap();
        assert!((v.delay_m - plane(lat, lon)).abs() < 1e-12, "{lat} {lon}");
    }
}

#[test]
fn a_mask_point_without_data_inside_a_full_large_cell_gives_no_ionosphere() {
    // All corners of the cell of ten degrees have values; the mask alone chooses the cell of five.
    let mut grid = world(|_, _| 3.0);
    for (lat, lon) in [(35, 135), (35, 140)] {
        set(&mut grid, lat, lon, Point::NotMonitored);
    }
    let inside = at(33.0, 137.0);
    assert_eq!(grid.vertical(inside), None);
    set(&mut grid, 35, 135, Point::Absent);
    set(&mut grid, 35, 140, Point::Absent);
    assert_eq!(grid.vertical(inside).unwrap().delay_m, 3.0, "outside the mask they leave the large cell");
    // A single silent point on its own side.
    set(&mut grid, 35, 135, Point::NotMonitored);
    set(&mut grid, 35, 140, Point::Value(3.0, 6.0));
    assert_eq!(grid.vertical(at(34.5, 135.5)), None);
}

#[test]
fn an_empty_grid_and_a_place_off_the_earth_give_nothing() {
    assert_eq!(Grid::default().vertical(at(35.0, 135.0)), None);
    assert_eq!(world(|_, _| 1.0).vertical(at(f64::NAN, 0.0)), None);
}

#[test]
fn the_first_choice_is_what_choosing_finds() {
    let mut grid = world(|lat, lon| 10.0 + 0.1 * lat + 0.01 * lon);
    for (lat, lon, point) in [(40, 140, Point::NotMonitored), (35, 10, Point::DoNotUse), (0, -180, Point::Absent)] {
        set(&mut grid, lat, lon, point);
    }
    let mut whole = 0;
    for lat in -600..=600 {
        for lon in -360..=360 {
            let at = at(f64::from(lat) * 0.1, f64::from(lon) * 0.5);
            if let Some(delay) = grid.whole(at) {
                whole += 1;
                // A few roundings of values up to 20 apart.
                assert!((delay.delay_m - grid.selected(at).unwrap().delay_m).abs() < 1e-12, "{at:?}");
            }
        }
    }
    assert!(whole > 850_000 && whole < 1201 * 721);
}

/// Any value at every point, by its place.
fn rough(lat_deg: f64, lon_deg: f64) -> f64 {
    5.0 + (0.7 * lat_deg + 0.31 * lon_deg).sin() + 2.0 * (0.13 * lon_deg - 0.2 * lat_deg).cos()
}

fn wrapped(lon_deg: f64) -> f64 {
    (lon_deg + 180.0).rem_euclid(360.0) - 180.0
}

/// A.4.4.10.3 in words: along the row at 85 degrees to the meridians of the row at 75, then the four points.
fn between_75_and_85(lat_deg: f64, lon_deg: f64) -> f64 {
    let sign = lat_deg.signum();
    let first = if sign > 0.0 { -180.0 } else { -170.0 };
    let row_85 = |lon: f64| {
        let west = first + 30.0 * ((lon - first) / 30.0).floor();
        let x = (lon - west) / 30.0;
        rough(85.0 * sign, wrapped(west)) * (1.0 - x) + rough(85.0 * sign, wrapped(west + 30.0)) * x
    };
    let west = 10.0 * (lon_deg / 10.0).floor();
    let (x, y) = ((lon_deg - west) / 10.0, (lat_deg.abs() - 75.0) / 10.0);
    let row_75 = |lon: f64| rough(75.0 * sign, wrapped(lon));
    (1.0 - y) * ((1.0 - x) * row_75(west) + x * row_75(west + 10.0)) + y * ((1.0 - x) * row_85(west) + x * row_85(west + 10.0))
}

/// A.4.4.10.3 beyond 85 degrees: y = (|latitude| - 85) / 10, x = (longitude - west) / 90 (1 - 2 y) + y.
fn around_the_pole(lat_deg: f64, lon_deg: f64) -> f64 {
    let sign = lat_deg.signum();
    let first = if sign > 0.0 { -180.0 } else { -140.0 };
    let west = first + 90.0 * ((lon_deg - first) / 90.0).floor();
    let y = (lat_deg.abs() - 85.0) / 10.0;
    let x = (lon_deg - west) / 90.0 * (1.0 - 2.0 * y) + y;
    let corner = |turn: f64| rough(85.0 * sign, wrapped(west + turn));
    (1.0 - x) * (1.0 - y) * corner(0.0) + x * (1.0 - y) * corner(90.0) + x * y * corner(180.0) + (1.0 - x) * y * corner(270.0)
}

#[test]
fn rough_values_near_the_poles_are_those_of_the_standards_words() {
    let grid = world(rough);
    for step in 0..=3590 {
        let lon = -179.5 + 0.1 * f64::from(step);
        for (k, sign) in [(0, 1.0), (1, -1.0), (2, 1.0), (3, -1.0), (7, 1.0), (9, -1.0)] {
            let lat = sign * (75.3 + f64::from(k));
            let vertical = grid.vertical(at(lat, lon)).unwrap();
            let expected = between_75_and_85(lat, lon);
            // A few roundings of values below ten.
            assert!((vertical.delay_m - expected).abs() < 1e-12 && (vertical.variance_m2 - 2.0 * expected).abs() < 1e-11, "{lat} {lon}");
            let lat = sign * (85.1 + 0.5 * f64::from(k));
            let vertical = grid.vertical(at(lat, lon)).unwrap();
            assert!((vertical.delay_m - around_the_pole(lat, lon)).abs() < 1e-12, "{lat} {lon}");
        }
    }
}

/// At a limit of two bands both say the row of the grid that stands there, and at 85 degrees it is that of the band below: its points stand
/// thirty degrees apart, those of the cap ninety.
#[test]
fn at_the_limits_of_the_bands_the_row_of_the_grid_serves() {
    let grid = world(rough);
    for step in 0..=3590 {
        let lon = -179.5 + 0.1 * f64::from(step);
        for (row, apart) in [(60.0, 5.0), (75.0, 10.0), (85.0, 30.0)] {
            for lat in [row, -row] {
                let expected = if row == 85.0 {
                    between_75_and_85(lat, lon)
                } else {
                    let west = apart * (lon / apart).floor();
                    let x = (lon - west) / apart;
                    (1.0 - x) * rough(lat, wrapped(west)) + x * rough(lat, wrapped(west + apart))
                };
                let vertical = grid.vertical(at(lat, lon)).map(|v| v.delay_m);
                assert!(vertical.is_some_and(|v| (v - expected).abs() < 1e-12), "{lat} {lon}: {vertical:?} {expected}");
            }
        }
    }
}

#[test]
fn a_silent_or_forbidden_point_near_the_poles_gives_nothing_beside_it() {
    for point in [Point::NotMonitored, Point::DoNotUse, Point::Absent] {
        let mut grid = world(|_, _| 3.0);
        set(&mut grid, 75, 20, point);
        set(&mut grid, -85, 40, point);
        for (lat, lon) in [(80.0, 15.0), (80.0, 25.0), (-80.0, 35.0), (-80.0, 45.0), (-87.0, 45.0), (-87.0, 10.0)] {
            assert_eq!(grid.vertical(at(lat, lon)), None, "{point:?} {lat} {lon}");
        }
        for (lat, lon) in [(80.0, 31.0), (80.0, 9.0), (-80.0, 75.0), (86.0, 15.0)] {
            assert!(grid.vertical(at(lat, lon)).is_some(), "{point:?} {lat} {lon}");
        }
    }
}

/// Weights of a triangle's corners are those at which the three places add up to the point: three equations, solved as they are.
#[test]
fn a_triangle_serves_what_lies_inside_it_and_nothing_else() {
    let places = [[1.0, 1.0], [0.0, 1.0], [0.0, 0.0], [1.0, 0.0]];
    for missing in 0..4 {
        for i in 0..=40 {
            for j in 0..=40 {
                // Off the diagonals, where rounding would decide.
                let (x, y) = ((f64::from(i) + 0.013) / 41.0, (f64::from(j) + 0.007) / 41.0);
                let kept: Vec<usize> = (0..4).filter(|k| *k != missing).collect();
                let m = nalgebra::Matrix3::from_fn(|r, c| if r < 2 { places[kept[c]][r] } else { 1.0 });
                let w = m.lu().solve(&Vector3::new(x, y, 1.0)).unwrap();
                match triangle(missing, x, y) {
                    Some(vertical) => {
                        assert!(w.iter().all(|w| *w >= -1e-12), "{missing} {x} {y}");
                        assert_eq!(vertical[missing], 0.0);
                        kept.iter().zip(w.iter()).for_each(|(k, w)| assert!((vertical[*k] - w).abs() < 1e-14));
                    }
                    None => assert!(w.iter().any(|w| *w < 0.0), "{missing} {x} {y}"),
                }
            }
        }
    }
}

/// Every pattern of one cell's corners, by the rule as it is written: forbidden, silent or absent points, and three that remain.
#[test]
fn every_pattern_of_a_cell_is_served_by_the_rule() {
    let corners = [(40, 140), (40, 135), (35, 135), (35, 140)];
    let values = [4.0, 7.0, 1.0, 2.0];
    for pattern in 0..81_usize {
        let kinds: Vec<usize> = (0..4).map(|k| pattern / 3_usize.pow(k) % 3).collect();
        let mut grid = Grid::default();
        for k in 0..4 {
            let point = [Point::Value(values[k], 2.0 * values[k]), Point::NotMonitored, Point::DoNotUse][kinds[k]];
            set(&mut grid, corners[k].0, corners[k].1, point);
        }
        for (x, y) in [(0.2, 0.3), (0.7, 0.9), (0.8, 0.1), (0.1, 0.6)] {
            let delay = grid.vertical(at(35.0 + 5.0 * y, 135.0 + 5.0 * x));
            let silent: Vec<usize> = (0..4).filter(|k| kinds[*k] == 1).collect();
            let weights = match silent.len() {
                _ if kinds.contains(&2) => None,
                0 => Some([x * y, (1.0 - x) * y, (1.0 - x) * (1.0 - y), x * (1.0 - y)]),
                1 => triangle(silent[0], x, y),
                _ => None,
            };
            let expected = weights.map(|w| (0..4).map(|k| w[k] * if kinds[k] == 0 { values[k] } else { 0.0 }).sum::<f64>());
            match (delay, expected) {
                (Some(f), Some(e)) => assert!((f.delay_m - e).abs() < 1e-12 && (f.variance_m2 - 2.0 * e).abs() < 1e-12, "{kinds:?}"),
                (f, e) => assert!(f.is_none() && e.is_none(), "{kinds:?} {x} {y}: {f:?} {e:?}"),
            }
        }
    }
}

proptest! {
    // Bilinear interpolation is exact on a plane; the sum of a few products loses some 1e-14 of 30. Up to the last cell before the date line,
    // where a plane in longitude jumps.
    #[test]
    fn a_plane_is_met_below_75_degrees(lat in -74.9..74.9f64, lon in -179.9..169.9f64) {
        let plane = |lat: f64, lon: f64| 30.0 + 0.2 * lat + 0.02 * lon;
        let v = world(plane).vertical(at(lat, lon)).unwrap();
        prop_assert!((v.delay_m - plane(lat, lon)).abs() < 1e-11, "{v:?}");
    }

    // Against the standard's spherical triangle with angles, below 70 degrees where it has no special case.
    #[test]
    fn the_pierce_point_is_that_of_the_spherical_triangle(lat in -70.0..70.0f64, lon in -179.0..179.0f64, az in 0.0..360.0f64, el in 1.0..89.9f64) {
        let (phi, lambda, a, e) = (lat.to_radians(), lon.to_radians(), az.to_radians(), el.to_radians());
        let psi = core::f64::consts::FRAC_PI_2 - e - (EARTH_M / (EARTH_M + SHELL_M) * e.cos()).asin();
        let want_lat = (phi.sin() * psi.cos() + phi.cos() * psi.sin() * a.cos()).asin();
        let want_lon = lambda + (psi.sin() * a.sin() / want_lat.cos()).asin();
        let up = Vector3::new(phi.cos() * lambda.cos(), phi.cos() * lambda.sin(), phi.sin());
        let east = Vector3::new(-lambda.sin(), lambda.cos(), 0.0);
        let north = up.cross(&east);
        let unit = e.cos() * (a.sin() * east + a.cos() * north) + e.sin() * up;
        let [pierce] = Pierce::abreast(&up, &[[unit.x], [unit.y], [unit.z]], &[e.sin()], &[e.cos()]);
        prop_assert!((pierce.lat_deg - want_lat.to_degrees()).abs() < 1e-9);
        let off = (pierce.lon_deg - want_lon.to_degrees()).rem_euclid(360.0);
        prop_assert!(off.min(360.0 - off) < 1e-8, "{off}");
    }
}
