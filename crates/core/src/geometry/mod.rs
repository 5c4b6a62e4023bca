//! Where the signals came from: nominal orbits, lines of sight, dilution of precision.
