//! Message 12: SBAS network time against UTC.
//!
//! | bits | field | unit, resolution |
//! |---|---|---|
//! | 14 to 37, 38 to 69 | A1, A0, signed | 2^-50 s/s, 2^-30 s |
//! | 70 to 77, 78 to 85 | t_0t, WN_t | 4096 s, weeks modulo 256 |
//! | 86 to 93 | leap seconds now, signed | 1 s |
//! | 94 to 101, 102 to 109 | WN_LSF, DN | weeks modulo 256, day |
//! | 110 to 117 | leap seconds to come, signed | 1 s |
//! | 118 to 120 | which UTC | |
//! | 121 to 140, 141 to 150 | GPS time of week, week modulo 1024 | 1 s |

use super::bits::Block;

/// Message 12.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NetworkTime {
    /// A1 \[s/s\].
    pub drift: f64,
    /// A0 \[s\].
    pub offset_s: f64,
    /// t_0t \[s of week\].
    pub reference_s: u32,
    /// WN_t, modulo 256.
    pub reference_week: u8,
    /// Leap seconds in force \[s\].
    pub leap_s: i8,
    /// WN_LSF, modulo 256.
    pub leap_week: u8,
    /// DN: day of that week.
    pub leap_day: u8,
    /// Leap seconds after that day \[s\].
    pub leap_after_s: i8,
    /// Which UTC.
    pub utc_standard: u8,
    /// GPS time of week \[s\].
    pub time_of_week_s: u32,
    /// GPS week, modulo 1024.
    pub week: u16,
}

impl NetworkTime {
    pub(super) fn decode(block: &Block) -> Self {
        Self {
            drift: block.scaled(14, 24, 1.0 / (1_u64 << 50) as f64),
            offset_s: block.scaled(38, 32, 1.0 / (1_u64 << 30) as f64),
            reference_s: block.unsigned(70, 8) * 4096,
            reference_week: block.unsigned(78, 8) as u8,
            leap_s: block.signed(86, 8) as i8,
            leap_week: block.unsigned(94, 8) as u8,
            leap_day: block.unsigned(102, 8) as u8,
            leap_after_s: block.signed(110, 8) as i8,
            utc_standard: block.unsigned(118, 3) as u8,
            time_of_week_s: block.unsigned(121, 20),
            week: block.unsigned(141, 10) as u16,
        }
    }
}
