//! Where the ionospheric grid points are (RTCA DO-229, table of bands; standard).
//!
//! Bands 0 to 8 are columns of one longitude, from south to north, 5 degrees apart. Most columns hold 55S to 55N; every second one adds 65
//! and 75 on both sides, and one in four of those a point at 85. Bands 9 and 10 are rows of one latitude, from west to east.

use super::iono::BANDS;

/// A grid point: latitude and longitude \[deg\], longitude in \[-180, 180).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GridPoint {
    /// Latitude \[deg\].
    pub lat_deg: i16,
    /// Longitude \[deg\].
    pub lon_deg: i16,
}

/// Cells of a world grid of 5 degrees, from 85S to 85N.
pub const WORLD_CELLS: usize = ROWS * COLUMNS;
const ROWS: usize = 35;
/// Cells of a row, from 180W.
pub const COLUMNS: usize = 72;

impl GridPoint {
    /// Its cell in a world grid of 5 degrees; none off that grid. Longitudes wrap.
    pub const fn cell(self) -> Option<usize> {
        match self.row_and_column() {
            Some((row, column)) => Some(row * COLUMNS + column),
            None => None,
        }
    }

    /// Cells of four points around a rectangle, this one in the south-west: north-east, north-west, south-west, south-east; none where
    /// one of them is off the grid.
    pub const fn cells_to(self, north_east: Self) -> Option<[usize; 4]> {
        match (self.row_and_column(), north_east.row_and_column()) {
            (Some((south, west)), Some((north, east))) => {
                let (south, north) = (south * COLUMNS, north * COLUMNS);
                Some([north + east, north + west, south + west, south + east])
            }
            _ => None,
        }
    }

    const fn row_and_column(self) -> Option<(usize, usize)> {
        if self.lat_deg < -85 || self.lat_deg > 85 || self.lat_deg % 5 != 0 || self.lon_deg % 5 != 0 {
            return None;
        }
        Some(((self.lat_deg + 85) as usize / 5, (self.lon_deg + 180).rem_euclid(360) as usize / 5))
    }
}

/// Rows of the polar bands: latitude, first longitude, step and points.
const POLAR: [[(i16, i16, i16, u8); 5]; 2] = [
    [(60, -180, 5, 72), (65, -180, 10, 36), (70, -180, 10, 36), (75, -180, 10, 36), (85, -180, 30, 12)],
    [(-60, -180, 5, 72), (-65, -180, 10, 36), (-70, -180, 10, 36), (-75, -180, 10, 36), (-85, -170, 30, 12)],
];

/// The place of a point: band 0 to 10, number in the band from 1. None where the band has no such point.
pub fn place(band: u8, number: u8) -> Option<GridPoint> {
    let number = number.checked_sub(1)?;
    match band {
        0..=8 => column_point(band, number),
        9 | 10 => row_point(POLAR.get(usize::from(band) - 9)?, number),
        _ => None,
    }
}

fn column_point(band: u8, mut number: u8) -> Option<GridPoint> {
    debug_assert!(usize::from(band) < BANDS);
    for k in 0..8 {
        let lon_deg = -180 + 40 * i16::from(band) + 5 * k;
        let count = column_count(lon_deg);
        if number < count {
            return Some(GridPoint { lat_deg: column_latitude(lon_deg, number)?, lon_deg });
        }
        number -= count;
    }
    None
}

/// The points at 85 degrees: north at 180W, 90W, 0, 90E, south at 140W, 50W, 40E, 130E.
const fn cap(lon_deg: i16) -> (bool, bool) {
    ((lon_deg + 180) % 90 == 0, (lon_deg + 140).rem_euclid(90) == 0)
}

const fn column_count(lon_deg: i16) -> u8 {
    match (lon_deg % 10 == 0, cap(lon_deg)) {
        (false, _) => 23,
        (true, (false, false)) => 27,
        (true, _) => 28,
    }
}

fn column_latitude(lon_deg: i16, number: u8) -> Option<i16> {
    let (north, south) = cap(lon_deg);
    let long = lon_deg % 10 == 0;
    let sparse = |hemisphere: i16, cap: bool| [(85, cap), (75, long), (65, long)].map(|(lat, there)| there.then_some(hemisphere * lat));
    let below = sparse(-1, south).into_iter().flatten();
    let middle = (-11..=11).map(|i| 5 * i);
    let [a, b, c] = sparse(1, north);
    below.chain(middle).chain([c, b, a].into_iter().flatten()).nth(usize::from(number))
}

fn row_point(rows: &[(i16, i16, i16, u8)], mut number: u8) -> Option<GridPoint> {
    for &(lat_deg, first, step, count) in rows {
        if number < count {
            return Some(GridPoint { lat_deg, lon_deg: first + step * i16::from(number) });
        }
        number -= count;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(band: u8, number: u8) -> Option<(i16, i16)> {
        place(band, number).map(|p| (p.lat_deg, p.lon_deg))
    }

    /// Corners of the standard's table.
    #[test]
    fn points_are_where_the_table_has_them() {
        for (band, number, lat, lon) in [
            (0, 1, -75, -180),
            (0, 28, 85, -180),
            (0, 29, -55, -175),
            (0, 201, 55, -145),
            (1, 1, -85, -140),
            (1, 28, 75, -140),
            (4, 101, -75, 0),
            (4, 128, 85, 0),
            (7, 151, -85, 130),
            (8, 1, -75, 140),
            (8, 200, 55, 175),
            (9, 1, 60, -180),
            (9, 73, 65, -180),
            (9, 181, 85, -180),
            (9, 192, 85, 150),
            (10, 181, -85, -170),
            (10, 192, -85, 160),
        ] {
            assert_eq!(at(band, number), Some((lat, lon)), "band {band}, point {number}");
        }
    }

    #[test]
    fn bands_hold_as_many_points_as_the_standard_says() {
        for band in 0..BANDS as u8 {
            let count = (1..=u8::MAX).filter(|n| place(band, *n).is_some()).count();
            assert_eq!(
                count,
                if band < 8 {
                    201
                } else if band == 8 {
                    200
                } else {
                    192
                },
                "band {band}"
            );
        }
        assert_eq!((place(11, 1), place(0, 0)), (None, None));
    }

    #[test]
    fn every_point_has_its_own_cell_and_longitudes_wrap() {
        let mut cells: std::vec::Vec<usize> = (0..9).flat_map(|b| (1..=201).filter_map(move |n| place(b, n)?.cell())).collect();
        let n = cells.len();
        cells.sort_unstable();
        cells.dedup();
        assert_eq!((n, cells.len()), (8 * 201 + 200, 8 * 201 + 200));
        assert_eq!(GridPoint { lat_deg: 0, lon_deg: 180 }.cell(), GridPoint { lat_deg: 0, lon_deg: -180 }.cell());
        assert_eq!(GridPoint { lat_deg: 3, lon_deg: 0 }.cell(), None);
    }
}
