//! Messages 7 and 10: how fast corrections grow old.
//!
//! | message | bits | field | unit, resolution |
//! |---|---|---|---|
//! | 7 | 14 to 17 | system latency | 1 s |
//! | | 18, 19 | IODP | |
//! | | 22 to 225 | 51 degradation indicators of 4 bits | |
//! | 10 | 14 to 23 | B_rrc | 0.002 m |
//! | | 24 to 33, 34 to 43, 44 to 52 | C_ltc_lsb, C_ltc_v1, I_ltc_v1 | 0.002 m, 0.00005 m/s, 1 s |
//! | | 53 to 62, 63 to 71 | C_ltc_v0, I_ltc_v0 | 0.002 m, 1 s |
//! | | 72 to 81, 82 to 91, 92 to 100 | C_geo_lsb, C_geo_v, I_geo | 0.0005 m, 0.00005 m/s, 1 s |
//! | | 101 to 106 | C_er | 0.5 m |
//! | | 107 to 116, 117 to 125, 126 to 135 | C_iono_step, I_iono, C_iono_ramp | 0.001 m, 1 s, 0.000005 m/s |
//! | | 136, 137 | RSS_UDRE, RSS_iono | 1: root sum of squares |
//! | | 138 to 144 | C_covariance | 0.1 |

use super::bits::Block;
use super::mask::MASK_MOST;

/// Message 7.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FastDegradation {
    /// System latency \[s\].
    pub latency_s: u8,
    /// Issue of the mask meant.
    pub iodp: u8,
    /// Degradation indicators by position in the mask.
    pub indicator: [u8; MASK_MOST],
}

/// Message 10.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Degradation {
    /// B_rrc: round-off of range rates \[m\].
    pub rrc_m: f64,
    /// C_ltc_lsb: round-off of long-term corrections with rates \[m\].
    pub ltc_lsb_m: f64,
    /// C_ltc_v1 \[m/s\].
    pub ltc_v1_mps: f64,
    /// I_ltc_v1 \[s\].
    pub ltc_v1_s: f64,
    /// C_ltc_v0 \[m\].
    pub ltc_v0_m: f64,
    /// I_ltc_v0 \[s\].
    pub ltc_v0_s: f64,
    /// C_geo_lsb \[m\].
    pub geo_lsb_m: f64,
    /// C_geo_v \[m/s\].
    pub geo_v_mps: f64,
    /// I_geo \[s\].
    pub geo_s: f64,
    /// C_er: en route only, once a correction is too old for precision approach \[m\].
    pub er_m: f64,
    /// C_iono_step \[m\].
    pub iono_step_m: f64,
    /// I_iono \[s\].
    pub iono_s: f64,
    /// C_iono_ramp \[m/s\].
    pub iono_ramp_mps: f64,
    /// Range terms are added as squares.
    pub rss_udre: bool,
    /// Ionospheric terms are added as squares.
    pub rss_iono: bool,
    /// C_covariance of message 28.
    pub covariance: f64,
}

impl FastDegradation {
    pub(super) fn decode(block: &Block) -> Self {
        Self {
            latency_s: block.unsigned(14, 4) as u8,
            iodp: block.unsigned(18, 2) as u8,
            indicator: core::array::from_fn(|i| block.unsigned(22 + 4 * i, 4) as u8),
        }
    }
}

impl Degradation {
    pub(super) fn decode(block: &Block) -> Self {
        Self {
            rrc_m: block.scaled_unsigned(14, 10, 0.002),
            ltc_lsb_m: block.scaled_unsigned(24, 10, 0.002),
            ltc_v1_mps: block.scaled_unsigned(34, 10, 0.000_05),
            ltc_v1_s: block.scaled_unsigned(44, 9, 1.0),
            ltc_v0_m: block.scaled_unsigned(53, 10, 0.002),
            ltc_v0_s: block.scaled_unsigned(63, 9, 1.0),
            geo_lsb_m: block.scaled_unsigned(72, 10, 0.000_5),
            geo_v_mps: block.scaled_unsigned(82, 10, 0.000_05),
            geo_s: block.scaled_unsigned(92, 9, 1.0),
            er_m: block.scaled_unsigned(101, 6, 0.5),
            iono_step_m: block.scaled_unsigned(107, 10, 0.001),
            iono_s: block.scaled_unsigned(117, 9, 1.0),
            iono_ramp_mps: block.scaled_unsigned(126, 10, 0.000_005),
            rss_udre: block.bit(136),
            rss_iono: block.bit(137),
            covariance: block.scaled_unsigned(138, 7, 0.1),
        }
    }
}
