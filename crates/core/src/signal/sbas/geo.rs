//! Messages 9 and 17: where the geostationary satellites are.
//!
//! | message | bits | field | unit, resolution |
//! |---|---|---|---|
//! | 9 | 22 to 34 | t_0 | 16 s of day |
//! | | 35 to 38 | URA index | |
//! | | 39 to 68, 69 to 98, 99 to 123 | x, y, z, signed | 0.08, 0.08, 0.4 m |
//! | | 124 to 140, 141 to 157, 158 to 175 | velocity, signed | 0.000625, 0.000625, 0.004 m/s |
//! | | 176 to 185, 186 to 195, 196 to 205 | acceleration, signed | 0.0000125, 0.0000125, 0.0000625 m/s² |
//! | | 206 to 217, 218 to 225 | a_Gf0, a_Gf1, signed | 2^-31 s, 2^-40 s/s |
//! | 17 | 14 to 80, 81 to 147, 148 to 214 | three almanacs of 67 bits | |
//! | | 215 to 225 | t_0 | 64 s of day |
//!
//! An almanac: data id (2), PRN (8), health (8), x, y (15 each, 2600 m), z (9, 26000 m), velocity (3, 3, 4; 10, 10, 60 m/s).

use super::bits::Block;

/// Almanacs in message 17.
pub(super) const ALMANACS: usize = 3;

/// Message 9: the ranging orbit of the satellite that sends it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GeoNavigation {
    /// Time of applicability, seconds of the GPS day.
    pub time_of_day_s: u32,
    /// User range accuracy index; 15 means do not range.
    pub ura_index: u8,
    /// ECEF \[m\].
    pub position_ecef_m: [f64; 3],
    /// ECEF \[m/s\].
    pub velocity_ecef_mps: [f64; 3],
    /// ECEF \[m/s²\].
    pub acceleration_ecef_mps2: [f64; 3],
    /// Clock offset \[s\].
    pub clock_s: f64,
    /// Clock drift \[s/s\].
    pub drift: f64,
}

/// One entry of message 17.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GeoAlmanac {
    /// PRN of the satellite.
    pub prn: u8,
    /// Health and status bits: 1 ranging off, 2 corrections off, 4 integrity off; the upper four name the provider.
    pub health: u8,
    /// ECEF \[m\].
    pub position_ecef_m: [f64; 3],
    /// ECEF \[m/s\].
    pub velocity_ecef_mps: [f64; 3],
}

/// Message 17.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GeoAlmanacs {
    /// Time of applicability, seconds of the GPS day.
    pub time_of_day_s: u32,
    /// Entries; PRN 0 marks an empty one.
    pub entries: [Option<GeoAlmanac>; ALMANACS],
}

impl GeoNavigation {
    pub(super) fn decode(block: &Block) -> Self {
        Self {
            time_of_day_s: block.unsigned(22, 13) * 16,
            ura_index: block.unsigned(35, 4) as u8,
            position_ecef_m: [block.scaled(39, 30, 0.08), block.scaled(69, 30, 0.08), block.scaled(99, 25, 0.4)],
            velocity_ecef_mps: [block.scaled(124, 17, 0.000_625), block.scaled(141, 17, 0.000_625), block.scaled(158, 18, 0.004)],
            acceleration_ecef_mps2: [
                block.scaled(176, 10, 0.000_012_5),
                block.scaled(186, 10, 0.000_012_5),
                block.scaled(196, 10, 0.000_062_5),
            ],
            clock_s: block.scaled(206, 12, 1.0 / (1_u64 << 31) as f64),
            drift: block.scaled(218, 8, 1.0 / (1_u64 << 40) as f64),
        }
    }
}

impl GeoAlmanacs {
    pub(super) fn decode(block: &Block) -> Self {
        Self { time_of_day_s: block.unsigned(215, 11) * 64, entries: core::array::from_fn(|i| almanac(block, 14 + 67 * i)) }
    }
}

fn almanac(block: &Block, first: usize) -> Option<GeoAlmanac> {
    let prn = block.unsigned(first + 2, 8) as u8;
    (prn > 0).then(|| GeoAlmanac {
        prn,
        health: block.unsigned(first + 10, 8) as u8,
        position_ecef_m: [
            block.scaled(first + 18, 15, 2600.0),
            block.scaled(first + 33, 15, 2600.0),
            block.scaled(first + 48, 9, 26_000.0),
        ],
        velocity_ecef_mps: [block.scaled(first + 57, 3, 10.0), block.scaled(first + 60, 3, 10.0), block.scaled(first + 63, 4, 60.0)],
    })
}
