//! The formats of files: one list of what is recognised, what it holds, and what is refused by name.
//!
//! A file is of the first format of [`FORMATS`] that recognises it. Most are recognised by their content; a few have no sign of their own and are
//! recognised by the end of their name.

mod foreign;
mod signs;

/// A file: its content, unpacked, and its name in small letters without the ending of its packing.
#[derive(Debug, Clone, Copy)]
pub struct File<'a> {
    /// Content.
    pub content: &'a [u8],
    /// Name.
    pub name: &'a str,
}

/// What a file may hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Holds {
    /// Positions, or rows beside them.
    Positions,
    /// Measurements.
    Observations,
    /// Orbits and clocks as they are broadcast.
    Navigation,
    /// SBAS messages.
    Messages,
    /// Precise orbits.
    Orbits,
    /// Precise clocks.
    Clocks,
    /// Almanacs.
    Almanac,
    /// A packed file.
    Packed,
    /// Nothing that is read.
    Nothing,
}

impl Holds {
    /// The id of tables.
    pub const fn id(self) -> &'static str {
        match self {
            Self::Positions => "positions",
            Self::Observations => "observations",
            Self::Navigation => "navigation",
            Self::Messages => "messages",
            Self::Orbits => "orbits",
            Self::Clocks => "clocks",
            Self::Almanac => "almanac",
            Self::Packed => "packed",
            Self::Nothing => "nothing",
        }
    }
}

/// One format.
#[derive(Debug, Clone, Copy)]
pub struct Format {
    /// Id of commands and tables.
    pub id: &'static str,
    /// Name.
    pub title: &'static str,
    /// What it holds.
    pub holds: &'static [Holds],
    /// How it is recognised.
    pub sign: &'static str,
    /// Whether a file is of this format.
    pub recognises: fn(&File<'_>) -> bool,
    /// What to do instead, where it is recognised and not read.
    pub instead: Option<&'static str>,
}

const RECEIVER: &[Holds] = &[Holds::Positions, Holds::Observations, Holds::Navigation, Holds::Messages];
const POSITIONS: &[Holds] = &[Holds::Positions];
const UNPACK: Option<&str> = Some("unpack it, or pack it by gzip or zip");

const fn read(
    id: &'static str,
    title: &'static str,
    holds: &'static [Holds],
    sign: &'static str,
    recognises: fn(&File<'_>) -> bool,
) -> Format {
    Format { id, title, holds, sign, recognises, instead: None }
}

const fn refused(
    id: &'static str,
    title: &'static str,
    sign: &'static str,
    recognises: fn(&File<'_>) -> bool,
    instead: &'static str,
) -> Format {
    Format { id, title, holds: &[Holds::Nothing], sign, recognises, instead: Some(instead) }
}

const MAKE_TABLE: &str = "make a table of it: UTC time, latitude and longitude in degrees, height, and the accuracy where it states one";

/// Every format, in the order in which they are tried.
pub const FORMATS: &[Format] = &[
    read("gzip", "gzip", &[Holds::Packed], "1F 8B", |f| f.content.starts_with(b"\x1f\x8b")),
    read("compress", "Unix compress", &[Holds::Packed], "1F 9D", |f| f.content.starts_with(b"\x1f\x9d")),
    read("zip", "zip archive of one file", &[Holds::Packed], "PK and the number of a header", signs::zip),
    Format { instead: UNPACK, ..read("bzip2", "bzip2", &[Holds::Packed], "BZh", |f| f.content.starts_with(b"BZh")) },
    Format { instead: UNPACK, ..read("xz", "xz", &[Holds::Packed], "FD 7zXZ", |f| f.content.starts_with(b"\xfd7zXZ")) },
    read("parquet", "Parquet", POSITIONS, "PAR1", |f| f.content.starts_with(b"PAR1")),
    refused("ulog", "ULog of an autopilot", "ULog and its version", foreign::ulog, "export the positions with their UTC time as a table"),
    refused(
        "dataflash",
        "DataFlash log of an ArduPilot autopilot",
        "A3 95 80, the description of the descriptions",
        |f| f.content.starts_with(b"\xa3\x95\x80"),
        "export the positions (GPS, POS) with their UTC time as a table",
    ),
    refused(
        "git-lfs",
        "pointer of Git LFS to a file",
        "version https://git-lfs",
        |f| f.content.starts_with(b"version https://git-lfs"),
        "get the file itself: git lfs pull",
    ),
    refused("ais", "log of ship reports (AIS)", "lines that begin with !AIVDM or !AIVDO", foreign::ais, MAKE_TABLE),
    read("rinex-observations", "RINEX observations", &[Holds::Observations], "first line, type O, or compact RINEX", signs::observations),
    read("rinex-messages", "RINEX-B messages", &[Holds::Messages], "first line, type B or H", signs::messages),
    read("rinex-clocks", "RINEX clocks", &[Holds::Clocks], "first line, type C", signs::clocks),
    read("rinex-navigation", "RINEX navigation", &[Holds::Navigation], "first line, another type", signs::navigation),
    read("ubx", "u-blox UBX log", RECEIVER, "B5 62, class and identifier of a message", signs::ubx),
    read("sbf", "Septentrio SBF log", RECEIVER, "$@ and the number of a block", signs::sbf),
    read("novatel", "NovAtel log", POSITIONS, "AA 44 12, or # and the name of a log", signs::novatel),
    read("nmea", "NMEA 0183 log", POSITIONS, "$, five capitals, fields, a checksum", signs::nmea),
    read("json", "JSON", POSITIONS, "{ or [", signs::json),
    read("rtklib", "RTKLIB solutions", POSITIONS, "%", signs::rtklib),
    read("sp3", "SP3", &[Holds::Orbits], "#, version, P or V, year", signs::sp3),
    refused(
        "rtcm3",
        "stream of RTCM 3 messages",
        "three frames one behind the other: D3, length, CRC-24Q",
        foreign::rtcm3,
        "convert it to RINEX observations and navigation data",
    ),
    refused(
        "gnss-logger",
        "text log of an Android telephone's measurements (GnssLogger)",
        "lines that begin with Raw or Fix, or the comments that describe them",
        foreign::gnss_logger,
        "log NMEA beside it and take that file, convert the measurements to RINEX, or make a table of its Fix lines",
    ),
    refused("igc", "flight log of a glider (IGC)", "A and a maker, and a line HFDTE", foreign::igc, MAKE_TABLE),
    refused("gpx", "GPX", "<gpx", foreign::gpx, MAKE_TABLE),
    refused("kml", "KML", "<kml", foreign::kml, MAKE_TABLE),
    refused(
        "beast",
        "messages of Mode S in frames of Beast",
        "three frames one behind the other: 1A, kind, counter, message, 1A twice within",
        foreign::beast,
        HEAR,
    ),
    refused("avr", "messages of Mode S in hexadecimal digits", "three lines one behind the other: * or @, digits, ;", foreign::avr, HEAR),
    refused("sirf", "log of a SiRF receiver", "three frames one behind the other: A0 A2, length, sum, B0 B3", foreign::sirf, CONVERT),
    refused("casic", "log in CASIC binary", "three frames one behind the other: BA CE, length, sum", foreign::casic, CONVERT),
    refused(
        "skytraq",
        "log of a SkyTraq receiver",
        "three frames one behind the other: A0 A1, length, sum, 0D 0A",
        foreign::skytraq,
        CONVERT,
    ),
    refused("javad", "log of a Javad or Topcon receiver", "three messages one behind the other, from JP or ~~ on", foreign::javad, CONVERT),
    refused(
        "hemisphere",
        "log of a Hemisphere receiver",
        "three blocks one behind the other: $BIN, length, sum, 0D 0A",
        foreign::hemisphere,
        CONVERT,
    ),
    refused(
        "garmin",
        "log of a Garmin receiver",
        "three packets one behind the other: 10, identifier, size, sum, 10 03",
        foreign::garmin,
        "convert it to NMEA or a table",
    ),
    refused("tsip", "log in Trimble's TSIP", "three packets one behind the other: 10, identifier, 10 03", foreign::tsip, CONVERT),
    read("ems", "EMS or RTKLIB messages", &[Holds::Messages], "the name ends with .ems or .sbs", |f| signs::named(f, &[".ems", ".sbs"])),
    read(
        "almanac",
        "YUMA or SEM almanac",
        &[Holds::Almanac],
        "the name ends with .alm or .al3, or asterisks and the word almanac in the first line",
        |f| signs::yuma(f) || signs::named(f, &[".alm", ".al3"]),
    ),
    read("csv", "text table", POSITIONS, "anything else", |_| true),
];

/// Their messages have no date.
const HEAR: &str = "let navbound live hear the receiver, or decode it to a table with the times of the messages";
const CONVERT: &str = "convert it to NMEA or RINEX";

/// The first of `formats` that recognises a file.
pub fn recognise<'a>(formats: &'a [Format], file: &File<'_>) -> Option<&'a Format> {
    formats.iter().find(|format| (format.recognises)(file))
}

#[cfg(test)]
mod tests;
