//! Carriers of the signals.
//!
//! Source: RINEX 4.00, tables 4 to 14 (carrier frequencies); provenance: standard.

use super::Constellation;

/// Speed of light in vacuum, exact by definition \[m/s\].
pub const SPEED_OF_LIGHT_MPS: f64 = 299_792_458.0;

/// A carrier frequency.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Carrier {
    /// GPS L1, Galileo E1, SBAS L1, BeiDou B1C: 1575.42 MHz.
    L1,
    /// GPS L2: 1227.60 MHz.
    L2,
    /// GPS L5, Galileo E5a, BeiDou B2a, SBAS L5: 1176.45 MHz.
    L5,
    /// BeiDou B1I: 1561.098 MHz.
    B1I,
    /// Galileo E5b, BeiDou B2I: 1207.14 MHz.
    E5b,
    /// BeiDou B3I: 1268.52 MHz.
    B3I,
    /// Galileo E6: 1278.75 MHz.
    E6,
}

impl Carrier {
    /// Frequency \[Hz\].
    pub const fn frequency_hz(self) -> f64 {
        match self {
            Self::L1 => 1_575.42e6,
            Self::L2 => 1_227.60e6,
            Self::L5 => 1_176.45e6,
            Self::B1I => 1_561.098e6,
            Self::E5b => 1_207.14e6,
            Self::B3I => 1_268.52e6,
            Self::E6 => 1_278.75e6,
        }
    }
    /// Wavelength \[m\].
    pub const fn wavelength_m(self) -> f64 {
        SPEED_OF_LIGHT_MPS / self.frequency_hz()
    }
    /// The carrier of a RINEX band digit; `None` for bands without an entry here and for GLONASS, whose satellites differ.
    pub const fn from_band(constellation: Constellation, band: u8) -> Option<Self> {
        match (constellation, band) {
            (Constellation::Gps | Constellation::Galileo | Constellation::Sbas | Constellation::BeiDou, b'1') => Some(Self::L1),
            (Constellation::Gps, b'2') => Some(Self::L2),
            (Constellation::BeiDou, b'2') => Some(Self::B1I),
            (Constellation::Gps | Constellation::Galileo | Constellation::Sbas | Constellation::BeiDou, b'5') => Some(Self::L5),
            (Constellation::BeiDou, b'6') => Some(Self::B3I),
            (Constellation::Galileo, b'6') => Some(Self::E6),
            (Constellation::Galileo | Constellation::BeiDou, b'7') => Some(Self::E5b),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frequencies_are_the_documented_multiples_of_10_23_mhz() {
        // Interface documents: L1 154, L2 120, L5 115, B1I 152.6, E5b 118, B3I 124, E6 125 times 10.23 MHz.
        let multiples = [
            (Carrier::L1, 154.0),
            (Carrier::L2, 120.0),
            (Carrier::L5, 115.0),
            (Carrier::B1I, 152.6),
            (Carrier::E5b, 118.0),
            (Carrier::B3I, 124.0),
            (Carrier::E6, 125.0),
        ];
        for (carrier, multiple) in multiples {
            assert!((carrier.frequency_hz() - multiple * 10.23e6).abs() < 1e-3, "{carrier:?}");
        }
    }
}
