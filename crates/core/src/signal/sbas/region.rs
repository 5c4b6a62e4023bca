//! Messages 27 and 28: where, and for which satellite, the UDRE must be enlarged.
//!
//! | message | bits | field | unit, resolution |
//! |---|---|---|---|
//! | 27 | 14 to 16 | IODS | |
//! | | 17 to 19, 20 to 22 | messages of this issue, number of this one | less one |
//! | | 23 to 25 | regions in this message | |
//! | | 26, 27 | priority | |
//! | | 28 to 31, 32 to 35 | dUDRE indicators inside and outside | |
//! | | 36 on | 35 bits a region: latitude and longitude of two corners (8, 9, 8, 9 bits, signed), shape (1) | 1 deg |
//! | 28 | 14, 15 | IODP | |
//! | | 16 to 120, 121 to 225 | two satellites of 105 bits | |
//!
//! A satellite of 28: position in the mask (6), scale exponent (3), E11 E22 E33 E44 (9 each), E12 E13 E14 E23 E24 E34 (10 each, signed).

use super::bits::Block;

/// Most regions in one message 27.
pub(super) const REGIONS_MOST: usize = 5;

/// A region of the service area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Region {
    /// First corner: latitude, longitude \[deg\], as sent.
    pub first_deg: [i16; 2],
    /// Opposite corner.
    pub second_deg: [i16; 2],
    /// A rectangle; otherwise the triangle below.
    pub rectangle: bool,
}

/// Message 27.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ServiceRegions {
    /// Issue of the set of messages.
    pub iods: u8,
    /// Messages of the set.
    pub messages: u8,
    /// Number of this one, from 1.
    pub number: u8,
    /// Higher wins where regions overlap.
    pub priority: u8,
    /// Factor of the UDRE inside.
    pub inside: f64,
    /// Factor of the UDRE outside every region.
    pub outside: f64,
    /// Regions.
    pub regions: [Option<Region>; REGIONS_MOST],
}

/// One satellite of message 28.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClockEphemerisCovariance {
    /// Position in the mask, from 1.
    pub position: u8,
    /// SF = 2^(exponent - 5).
    pub scale: f64,
    /// R = E SF, the upper triangular factor of C = R'R, row by row: R11 R12 R13 R14 R22 R23 R24 R33 R34 R44.
    pub factor: [f64; 10],
}

/// Message 28.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Covariances {
    /// Issue of the mask meant.
    pub iodp: u8,
    /// Satellites.
    pub satellites: [Option<ClockEphemerisCovariance>; 2],
}

/// Factors of the UDRE by indicator of message 27 (standard).
const FACTORS: [f64; 16] = [1.0, 1.1, 1.25, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 20.0, 30.0, 40.0, 50.0, 100.0];

impl ServiceRegions {
    pub(super) fn decode(block: &Block) -> Self {
        let factor = |first| FACTORS.get(block.unsigned(first, 4) as usize).copied().unwrap_or(f64::NAN);
        let count = block.unsigned(23, 3) as usize;
        Self {
            iods: block.unsigned(14, 3) as u8,
            messages: block.unsigned(17, 3) as u8 + 1,
            number: block.unsigned(20, 3) as u8 + 1,
            priority: block.unsigned(26, 2) as u8,
            inside: factor(28),
            outside: factor(32),
            regions: core::array::from_fn(|i| (i < count).then(|| region(block, 36 + 35 * i))),
        }
    }
}

fn region(block: &Block, first: usize) -> Region {
    let signed = |offset, bits| block.signed(first + offset, bits) as i16;
    Region { first_deg: [signed(0, 8), signed(8, 9)], second_deg: [signed(17, 8), signed(25, 9)], rectangle: block.bit(first + 34) }
}

impl Region {
    /// Whether a point lies inside. A rectangle spans both corners; a triangle has corners 1, 2 and (latitude of 1, longitude of 2)
    /// (standard; longitudes from corner 1 eastwards to corner 2, across the date line where need be).
    pub fn contains(&self, lat_deg: f64, lon_deg: f64) -> bool {
        let [lat1, lon1] = self.first_deg.map(f64::from);
        let [lat2, lon2] = self.second_deg.map(f64::from);
        let (south, north) = if lat1 <= lat2 { (lat1, lat2) } else { (lat2, lat1) };
        let turn = |lon: f64| {
            let east = (lon - lon1) % 360.0;
            if east < 0.0 { east + 360.0 } else { east }
        };
        let (width, east) = (turn(lon2), turn(lon_deg));
        if !(lat_deg >= south && lat_deg <= north && east <= width) {
            return false;
        }
        // Inside the rectangle; the triangle is the half at the corner (lat1, lon2).
        let climb = if lat2 == lat1 { 0.0 } else { (lat_deg - lat1) / (lat2 - lat1) };
        self.rectangle || width == 0.0 || climb <= east / width
    }
}

impl Covariances {
    pub(super) fn decode(block: &Block) -> Self {
        Self { iodp: block.unsigned(14, 2) as u8, satellites: [16, 121].map(|first| satellite(block, first)) }
    }
}

fn satellite(block: &Block, first: usize) -> Option<ClockEphemerisCovariance> {
    let position = block.unsigned(first, 6) as u8;
    let scale = f64::from(1_u32 << block.unsigned(first + 6, 3)) / 32.0;
    let diagonal = |i: usize| block.scaled_unsigned(first + 9 + 9 * i, 9, scale);
    let above = |i: usize| block.scaled(first + 45 + 10 * i, 10, scale);
    (position > 0).then(|| ClockEphemerisCovariance {
        position,
        scale,
        factor: [diagonal(0), above(0), above(1), above(2), diagonal(1), above(3), above(4), diagonal(2), above(5), diagonal(3)],
    })
}

impl ClockEphemerisCovariance {
    /// sqrt(I' C I) for a line of sight I = (unit vector from user to satellite in ECEF, 1).
    pub fn along(&self, unit_ecef: &nalgebra::Vector3<f64>) -> f64 {
        let [r11, r12, r13, r14, r22, r23, r24, r33, r34, r44] = self.factor;
        let (x, y, z) = (unit_ecef.x, unit_ecef.y, unit_ecef.z);
        let a = r11 * x + r12 * y + r13 * z + r14;
        let b = r22 * y + r23 * z + r24;
        let c = r33 * z + r34;
        crate::special::float::sqrt(a * a + b * b + c * c + r44 * r44)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regions_span_their_corners_also_across_the_date_line() {
        let rectangle = Region { first_deg: [20, 170], second_deg: [50, -170], rectangle: true };
        for (lat, lon, inside) in [(30.0, 175.0, true), (30.0, -175.0, true), (30.0, 0.0, false), (51.0, 175.0, false), (20.0, 170.0, true)]
        {
            assert_eq!(rectangle.contains(lat, lon), inside, "{lat} {lon}");
        }
    }

    #[test]
    fn a_triangle_is_the_half_at_the_latitude_of_its_first_corner() {
        let triangle = Region { first_deg: [0, 0], second_deg: [10, 10], rectangle: false };
        assert!(triangle.contains(1.0, 9.0) && !triangle.contains(9.0, 1.0));
        let falling = Region { first_deg: [10, 0], second_deg: [0, 10], rectangle: false };
        assert!(falling.contains(9.0, 9.0) && !falling.contains(1.0, 1.0));
    }
}
