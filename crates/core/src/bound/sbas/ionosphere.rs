//! The ionospheric grid at the point where a signal pierces the shell.

use super::model::{EARTH_M, SHELL_M, aged_grid_m2, give_variance_m2};
use crate::quantity::GpsTime;
use crate::signal::sbas::grid::{COLUMNS as WORLD_COLUMNS, GridPoint, WORLD_CELLS};
use crate::signal::sbas::{GridDelay, Store, timeout::Use};
use crate::special::angles::atan2;
use crate::special::float::sqrt;
use nalgebra::Vector3;

/// A grid point as a user finds it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
enum Point {
    /// Not in the mask.
    #[default]
    Absent,
    /// In the mask, not monitored or too old.
    NotMonitored,
    /// In the mask, forbidden.
    DoNotUse,
    /// Delay \[m\] and variance \[m²\], degradation included.
    Value(f64, f64),
}

/// Vertical delay and its variance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vertical {
    /// On L1 \[m\].
    pub delay_m: f64,
    /// \[m²\].
    pub variance_m2: f64,
}

/// The grid in force at one instant, on a world of 5-degree cells.
#[derive(Debug, Clone)]
pub struct Grid([Point; WORLD_CELLS]);

/// Where a signal pierces the shell \[deg\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pierce {
    /// Latitude.
    pub lat_deg: f64,
    /// Longitude, \[-180, 180\].
    pub lon_deg: f64,
}

/// Corners of a cell: north-east, north-west, south-west, south-east.
type Corners = [Point; 4];

impl Pierce {
    /// From unit vectors in Earth-centred axes: up at the user, and from the user to the satellite.
    ///
    /// ```text
    /// k = Re cos E / (Re + h_I),   psi = pi/2 - E - asin k
    /// direction = cos psi up + sin psi horizontal,   sin psi = cos(E + asin k)
    /// ```
    ///
    /// The standard's spherical triangle, with vectors instead of angles: no case is special, at the poles either. Several satellites
    /// abreast, their unit vectors and the sine and cosine of their elevation.
    #[inline(always)]
    pub fn abreast<const L: usize>(up: &Vector3<f64>, unit: &[[f64; L]; 3], sin_el: &[f64; L], cos_el: &[f64; L]) -> [Self; L] {
        const RATIO: f64 = EARTH_M / (EARTH_M + SHELL_M);
        let (mut x, mut y, mut z, mut level) = ([0.0; L], [0.0; L], [0.0; L], [0.0; L]);
        for l in 0..L {
            let k = RATIO * cos_el[l];
            let root = sqrt(1.0 - k * k);
            let cos_psi = sin_el[l] * root + cos_el[l] * k;
            // sin psi / cos E, so that a satellite overhead divides by nothing.
            let sin_psi_over = root - sin_el[l] * RATIO;
            let along_up = cos_psi - sin_psi_over * sin_el[l];
            x[l] = along_up * up.x + sin_psi_over * unit[0][l];
            y[l] = along_up * up.y + sin_psi_over * unit[1][l];
            z[l] = along_up * up.z + sin_psi_over * unit[2][l];
            level[l] = sqrt(x[l] * x[l] + y[l] * y[l]);
        }
        let (lat, lon) = (atan2(&z, &level), atan2(&y, &x));
        core::array::from_fn(|l| Self { lat_deg: lat[l].to_degrees(), lon_deg: lon[l].to_degrees() })
    }
}

impl Default for Grid {
    fn default() -> Self {
        Self([Point::Absent; WORLD_CELLS])
    }
}

impl Grid {
    /// Take what is in force now.
    pub fn refresh(&mut self, store: &Store, used_for: Use, now: GpsTime) {
        self.0.fill(Point::Absent);
        let degradation = store.degradation(used_for, now);
        for node in store.grid(used_for, now) {
            let Some(cell) = node.point.cell().and_then(|i| self.0.get_mut(i)) else { continue };
            *cell = match node.in_force {
                None if *cell == Point::Absent => Point::NotMonitored,
                None => continue,
                Some((GridDelay { delay_m: None, .. }, _)) => Point::DoNotUse,
                Some((GridDelay { delay_m: Some(delay_m), givei }, applies)) => match give_variance_m2(givei) {
                    None => Point::NotMonitored,
                    Some(give_m2) => Point::Value(delay_m, aged_grid_m2(give_m2, now.seconds_since(applies), degradation)),
                },
            };
        }
    }

    /// Delay and variance at a pierce point; none where the grid does not serve it.
    ///
    /// Cells are tried in the standard's order (A.4.4.10.2): four points of the small cell, three of it around the pierce point, four of
    /// the large cell, three of it. A chosen cell with a forbidden point gives nothing; with one point that is not monitored it serves the
    /// triangle of the others.
    #[inline(always)]
    pub fn vertical(&self, at: Pierce) -> Option<Vertical> {
        self.whole(at).or_else(|| self.selected(at))
    }

    /// The first choice of all: a small cell below 60 degrees whose four points have values.
    #[inline(always)]
    fn whole(&self, at: Pierce) -> Option<Vertical> {
        if !(at.lat_deg.abs() <= 60.0 && at.lon_deg.abs() <= 180.0) {
            return None;
        }
        // Both sums are positive, so that cutting off is rounding down.
        let (row, column) = (((at.lat_deg + 85.0) / 5.0) as usize, ((at.lon_deg + 180.0) / 5.0) as usize % WORLD_COLUMNS);
        let (south, west) = (row * WORLD_COLUMNS, column);
        let east = if column + 1 < WORLD_COLUMNS { column + 1 } else { 0 };
        let cells = [south + WORLD_COLUMNS + east, south + WORLD_COLUMNS + west, south + west, south + east];
        let y = (at.lat_deg + 85.0) / 5.0 - row as f64;
        let turned = (at.lon_deg + 180.0) / 5.0;
        let x = turned - (turned as usize) as f64;
        let corners = cells.map(|cell| self.0.get(cell).copied().unwrap_or_default());
        if corners.iter().all(|c| matches!(c, Point::Value(..))) { weighted(&corners, &four(x, y)) } else { None }
    }

    #[inline(never)]
    fn selected(&self, at: Pierce) -> Option<Vertical> {
        if !(at.lat_deg.abs() <= 90.0 && at.lon_deg.abs() <= 180.0) {
            return None;
        }
        let latitude = at.lat_deg.abs();
        if latitude > 85.0 {
            return self.cap(at);
        }
        // The row at 75 degrees has no cell of its own size towards the pole.
        if latitude >= 75.0 {
            return self.high(at);
        }
        let small_width = if latitude > 60.0 { 10 } else { 5 };
        if let Some(answer) = self.cells(at, 5, small_width, &[0], &[0]) {
            return answer;
        }
        let west = if latitude > 60.0 { &[0][..] } else { &[0, 5][..] };
        self.cells(at, 10, 10, &[0, 5], west).flatten()
    }

    /// The first cell that the mask has, among those whose corner stands at these offsets from multiples of its size. Outer none: no
    /// such cell; inner none: a cell, but nothing for this point.
    fn cells(&self, at: Pierce, height: i16, width: i16, south: &[i16], west: &[i16]) -> Option<Option<Vertical>> {
        let anchors =
            || south.iter().flat_map(move |s| west.iter().map(move |w| (below(at.lat_deg, height, *s), below(at.lon_deg, width, *w))));
        let place = |(s, w): (i16, i16)| {
            let (x, y) = ((at.lon_deg - f64::from(w)) / f64::from(width), (at.lat_deg - f64::from(s)) / f64::from(height));
            (self.corners(s, w, height, width), x, y)
        };
        for anchor in anchors() {
            let (corners, x, y) = place(anchor);
            if corners.iter().all(|c| *c != Point::Absent) {
                return Some(interpolate(&corners, x, y));
            }
        }
        for anchor in anchors() {
            let (corners, x, y) = place(anchor);
            let mut absent = (0..4).filter(|i| corners[*i] == Point::Absent);
            if let (Some(missing), None) = (absent.next(), absent.next())
                && let Some(weights) = triangle(missing, x, y)
            {
                return Some(weighted(&corners, &weights));
            }
        }
        None
    }

    fn corners(&self, south: i16, west: i16, height: i16, width: i16) -> Corners {
        let from = GridPoint { lat_deg: south, lon_deg: west };
        let to = GridPoint { lat_deg: south + height, lon_deg: west + width };
        match from.cells_to(to) {
            Some(cells) => cells.map(|i| self.0.get(i).copied().unwrap_or_default()),
            // A cell over the edge of the grid has some of its points.
            None => [(height, width), (height, 0), (0, 0), (0, width)].map(|(north, east)| self.point(south + north, west + east)),
        }
    }

    fn point(&self, lat_deg: i16, lon_deg: i16) -> Point {
        GridPoint { lat_deg, lon_deg }.cell().and_then(|i| self.0.get(i)).copied().unwrap_or_default()
    }

    /// Between 75 and 85 degrees: the points at 85 stand 30 degrees apart (or 90) and are interpolated to the longitudes of those at 75.
    fn high(&self, at: Pierce) -> Option<Vertical> {
        let sign = if at.lat_deg < 0.0 { -1 } else { 1 };
        let west = below(at.lon_deg, 10, 0);
        let upper = [west + 10, west].map(|lon| self.at_85(sign, lon));
        let [ne, nw] = upper;
        let (near_w, near_e) = (self.point(sign * 75, west), self.point(sign * 75, west + 10));
        let (x, y) = ((at.lon_deg - f64::from(west)) / 10.0, (at.lat_deg.abs() - 75.0) / 10.0);
        weighted(&[ne, nw, near_w, near_e], &four(x, y))
    }

    /// The grid at 85 degrees and any longitude.
    fn at_85(&self, sign: i16, lon_deg: i16) -> Point {
        let first = if sign > 0 { -180 } else { -170 };
        let cap = if sign > 0 { -180 } else { -140 };
        for (origin, step) in [(first, 30), (cap, 90)] {
            let west = lon_deg - (lon_deg - origin).rem_euclid(step);
            let ends = [self.point(sign * 85, west), self.point(sign * 85, west + step)];
            if ends.iter().all(|p| *p != Point::Absent) {
                let x = f64::from(lon_deg - west) / f64::from(step);
                let [w, e] = ends;
                return weighted(&[e, w, w, w], &[x, 1.0 - x, 0.0, 0.0])
                    .map_or(Point::NotMonitored, |v| Point::Value(v.delay_m, v.variance_m2));
            }
        }
        Point::Absent
    }

    /// Beyond 85 degrees: the four points at 85 that stand 90 degrees apart.
    fn cap(&self, at: Pierce) -> Option<Vertical> {
        let (sign, origin) = if at.lat_deg < 0.0 { (-1, -140) } else { (1, -180) };
        let west = origin + 90 * below((at.lon_deg - f64::from(origin)) / 90.0, 1, 0);
        let y = (at.lat_deg.abs() - 85.0) / 10.0;
        let x = (at.lon_deg - f64::from(west)) / 90.0 * (1.0 - 2.0 * y) + y;
        // Around the pole: nearest two to the west and east of the pierce point, then the two opposite.
        let [sw, se, ne, nw] = [0, 90, 180, 270].map(|east| self.point(sign * 85, west + east));
        weighted(&[ne, nw, sw, se], &four(x, y))
    }
}

/// The largest of `offset` + k `size` that is not above a number.
fn below(value: f64, size: i16, offset: i16) -> i16 {
    let scaled = (value - f64::from(offset)) / f64::from(size);
    let whole = scaled as i16;
    let floor = if f64::from(whole) > scaled { whole - 1 } else { whole };
    floor * size + offset
}

/// Weights of four corners.
pub(super) fn four(x: f64, y: f64) -> [f64; 4] {
    [x * y, (1.0 - x) * y, (1.0 - x) * (1.0 - y), x * (1.0 - y)]
}

/// Weights of three corners, one missing; none outside their triangle.
fn triangle(missing: usize, x: f64, y: f64) -> Option<[f64; 4]> {
    let (u, v) = (1.0 - x, 1.0 - y);
    let weights = match missing {
        0 => [0.0, y, 1.0 - x - y, x],
        1 => [y, 0.0, u, 1.0 - u - y],
        2 => [1.0 - u - v, u, 0.0, v],
        _ => [x, 1.0 - x - v, v, 0.0],
    };
    weights.iter().all(|w| *w >= 0.0).then_some(weights)
}

fn interpolate(corners: &Corners, x: f64, y: f64) -> Option<Vertical> {
    let mut silent = (0..4).filter(|i| corners[*i] == Point::NotMonitored);
    match (silent.next(), silent.next()) {
        (None, _) => weighted(corners, &four(x, y)),
        (Some(missing), None) if !corners.contains(&Point::DoNotUse) => weighted(corners, &triangle(missing, x, y)?),
        _ => None,
    }
}

/// Weighted sum; none when a corner that counts has no value, or any is forbidden.
#[inline(always)]
fn weighted(corners: &Corners, weights: &[f64; 4]) -> Option<Vertical> {
    let mut sum = Vertical { delay_m: 0.0, variance_m2: 0.0 };
    for (corner, w) in corners.iter().zip(weights) {
        match corner {
            Point::Value(delay_m, variance_m2) => {
                sum.delay_m += w * delay_m;
                sum.variance_m2 += w * variance_m2;
            }
            Point::DoNotUse => return None,
            Point::NotMonitored | Point::Absent if *w != 0.0 => return None,
            Point::NotMonitored | Point::Absent => {}
        }
    }
    Some(sum)
}

#[cfg(test)]
#[path = "ionosphere_tests.rs"]
mod tests;
