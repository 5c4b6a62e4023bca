//! Which words of a receiver say that a position was measured.
//!
//! A receiver also writes positions that nothing measured: a place that an operator typed in, one carried forward without satellites, one of a
//! simulator. They stand where a measured one does, often with a small standard deviation. Only what is listed here is a position; what is
//! not known is none.

/// Quality of an NMEA GGA sentence: GNSS, differential, precise service, fixed and float carrier phase, satellite-based augmentation as
/// NovAtel writes it. Not 0 (none), 6 (dead reckoning), 7 (typed in), 8 (simulator). Provenance: standard (NMEA 0183 version 4, as receivers'
/// manuals give it).
pub const GGA_QUALITIES: &[u8] = &[1, 2, 3, 4, 5, 9];

/// Mode of an NMEA RMC or GLL sentence: autonomous, differential, precise, fixed and float carrier phase. Not N (not valid), E (dead
/// reckoning), M (typed in), S (simulator). Provenance: standard (NMEA 0183 version 4, as receivers' manuals give it).
pub const NMEA_MODES: &[u8] = b"ADPRF";

/// Dimensions of a fix in NMEA GSA below which a position has a height that nothing measured. Provenance: standard, as above \[1\].
pub const GSA_DIMENSIONS: f64 = 3.0;

/// Fewest satellites of a position that satellites alone give: two or less leave a line or a surface, whatever else is held fixed.
/// Provenance: derived \[1\].
pub const LEAST_SATELLITES: u32 = 3;

/// Fewest satellites that determine a position with its height and the clock; with three something else stands in. Provenance: derived \[1\].
pub const DETERMINING_SATELLITES: u32 = 4;

/// Quality of an RTKLIB solution: fixed, float, SBAS, differential, single, precise. Not 0 (none), 7 (dead reckoning). Provenance: standard
/// (RTKLIB manual, section B.1).
pub const RTKLIB_QUALITIES: &[u8] = &[1, 2, 3, 4, 5, 6];

/// Type in the mode of a Septentrio position: stand-alone, differential, fixed and float carrier phase, augmented, the two against a moving
/// base, precise. Not 0 (none), 3 (fixed location, typed in). Provenance: standard (SBF reference guide, PVTGeodetic).
pub const SBF_MODES: &[u8] = &[1, 2, 4, 5, 6, 7, 8, 10];

/// Position type of NovAtel's BESTPOS, as a number and as a word. Not NONE, FIXEDPOS and FIXEDHEIGHT (typed in), DOPPLER_VELOCITY,
/// PROPAGATED (carried forward), WARNING and OUT_OF_BOUNDS (the receiver's own alert). Provenance: standard (OEM7 commands and logs
/// reference manual, table of position types).
pub const NOVATEL_TYPES: &[(u8, &str)] = &[
    (16, "SINGLE"),
    (17, "PSRDIFF"),
    (18, "WAAS"),
    (20, "OMNISTAR"),
    (32, "L1_FLOAT"),
    (33, "IONOFREE_FLOAT"),
    (34, "NARROW_FLOAT"),
    (48, "L1_INT"),
    (49, "WIDE_INT"),
    (50, "NARROW_INT"),
    (51, "RTK_DIRECT_INS"),
    (52, "INS_SBAS"),
    (53, "INS_PSRSP"),
    (54, "INS_PSRDIFF"),
    (55, "INS_RTKFLOAT"),
    (56, "INS_RTKFIXED"),
    (64, "OMNISTAR_HP"),
    (65, "OMNISTAR_XP"),
    (68, "PPP_CONVERGING"),
    (69, "PPP"),
    (70, "OPERATIONAL"),
    (73, "INS_PPP_CONVERGING"),
    (74, "INS_PPP"),
    (77, "PPP_BASIC_CONVERGING"),
    (78, "PPP_BASIC"),
    (79, "INS_PPP_BASIC_CONVERGING"),
    (80, "INS_PPP_BASIC"),
];
