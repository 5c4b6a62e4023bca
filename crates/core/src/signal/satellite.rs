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
}

impl Constellation {
    /// Every constellation, in the order of [`Constellation::index`].
    pub const ALL: [Self; 4] = [Self::Gps, Self::Glonass, Self::Galileo, Self::BeiDou];

    /// Position in [`Constellation::ALL`].
    pub const fn index(self) -> usize {
        match self {
            Self::Gps => 0,
            Self::Glonass => 1,
            Self::Galileo => 2,
            Self::BeiDou => 3,
        }
    }
    /// The constellation at a position of [`Constellation::ALL`].
    pub const fn from_index(index: usize) -> Option<Self> {
        match index {
            0 => Some(Self::Gps),
            1 => Some(Self::Glonass),
            2 => Some(Self::Galileo),
            3 => Some(Self::BeiDou),
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
        }
        assert_eq!(Constellation::from_index(4), None);
    }

    #[test]
    fn satellites_are_written_as_in_rinex() {
        assert_eq!(SatelliteId { constellation: Constellation::BeiDou, number: 5 }.to_string(), "C05");
    }
}
