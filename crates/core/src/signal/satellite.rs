//! Which satellite, from which constellation.

use core::fmt;

/// A satellite navigation system. Receivers solve one clock unknown for each that is used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Constellation {
    /// Global Positioning System.
    Gps,
    /// GLONASS.
    Glonass,
    /// Galileo.
    Galileo,
    /// BeiDou.
    BeiDou,
    /// Satellite-based augmentation: the geostationary satellites that carry it. Number n stands for PRN 100 + n, as in RINEX.
    Sbas,
}

impl Constellation {
    /// Every constellation, in the order of [`Constellation::index`].
    pub const ALL: [Self; 5] = [Self::Gps, Self::Glonass, Self::Galileo, Self::BeiDou, Self::Sbas];

    /// Position in [`Constellation::ALL`].
    pub const fn index(self) -> usize {
        match self {
            Self::Gps => 0,
            Self::Glonass => 1,
            Self::Galileo => 2,
            Self::BeiDou => 3,
            Self::Sbas => 4,
        }
    }
    /// The constellation at a position of [`Constellation::ALL`].
    pub const fn from_index(index: usize) -> Option<Self> {
        match index {
            0 => Some(Self::Gps),
            1 => Some(Self::Glonass),
            2 => Some(Self::Galileo),
            3 => Some(Self::BeiDou),
            4 => Some(Self::Sbas),
            _ => None,
        }
    }
    /// Numbers that its satellites can have: what its interface document and RINEX leave room for (standard).
    pub const fn numbers(self) -> core::ops::RangeInclusive<u8> {
        match self {
            Self::Gps | Self::BeiDou => 1..=63,
            Self::Glonass => 1..=32,
            Self::Galileo => 1..=36,
            Self::Sbas => 20..=58,
        }
    }
    /// The constellation of a letter of RINEX 3.
    pub const fn from_letter(letter: u8) -> Option<Self> {
        match letter {
            b'G' => Some(Self::Gps),
            b'R' => Some(Self::Glonass),
            b'E' => Some(Self::Galileo),
            b'C' => Some(Self::BeiDou),
            b'S' => Some(Self::Sbas),
            _ => None,
        }
    }
    /// The letter of RINEX 3 (standard).
    pub const fn letter(self) -> char {
        match self {
            Self::Gps => 'G',
            Self::Glonass => 'R',
            Self::Galileo => 'E',
            Self::BeiDou => 'C',
            Self::Sbas => 'S',
        }
    }
}

/// A satellite: its constellation and its number there.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SatelliteId {
    /// Its system.
    pub constellation: Constellation,
    /// Its number in the system, from 1.
    pub number: u8,
}

impl fmt::Display for SatelliteId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{:02}", self.constellation.letter(), self.number)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_constellation_is_where_its_index_says() {
        for (i, c) in Constellation::ALL.into_iter().enumerate() {
            assert_eq!((c.index(), Constellation::from_index(i)), (i, Some(c)));
            assert_eq!(Constellation::from_letter(c.letter() as u8), Some(c));
        }
        assert_eq!(Constellation::from_index(5), None);
    }

    #[test]
    fn satellites_are_written_as_in_rinex() {
        assert_eq!(SatelliteId { constellation: Constellation::BeiDou, number: 5 }.to_string(), "C05");
    }
}
