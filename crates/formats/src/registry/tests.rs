use super::*;

fn id(content: &[u8], name: &str) -> &'static str {
    recognise(FORMATS, &File { content, name }).unwrap().id
}

#[test]
fn ids_are_unique_and_the_last_format_takes_everything() {
    for (k, format) in FORMATS.iter().enumerate() {
        assert!(FORMATS[..k].iter().all(|other| other.id != format.id), "{}", format.id);
        assert!(!format.title.is_empty() && !format.sign.is_empty() && !format.holds.is_empty(), "{}", format.id);
        assert_eq!(format.holds == [Holds::Nothing], format.instead.is_some() && format.holds != [Holds::Packed], "{}", format.id);
    }
    assert_eq!(id(b"", ""), "csv");
}

#[test]
fn signs_name_their_format() {
    let rinex = |kind: &str| format!("     3.04           {kind:<40}RINEX VERSION / TYPE\n").into_bytes();
    let sentence = b"$GPGGA,000000.00,,,,,0,,,,,,,,*7A\r\n".as_slice();
    let banner = [b"{\"class\":\"VERSION\"}\r\n".as_slice(), sentence].concat();
    let cases: Vec<(Vec<u8>, &str, &str)> = vec![
        (b"\x1f\x8b\x08".to_vec(), "", "gzip"),
        (b"BZh9".to_vec(), "", "bzip2"),
        (b"PAR1".to_vec(), "", "parquet"),
        (b"ULog\x01\x12\x35\x01".to_vec(), "", "ulog"),
        (rinex("OBSERVATION DATA"), "", "rinex-observations"),
        (rinex("NAVIGATION DATA"), "", "rinex-navigation"),
        (rinex("B"), "", "rinex-messages"),
        (rinex("C"), "", "rinex-clocks"),
        (b"\xb5\x62\x01\x07\x5c\x00".to_vec(), "", "ubx"),
        (b"$@\0\0\xa7\x4f\x60\0".to_vec(), "", "sbf"),
        (b"#BESTPOSA,COM1,0".to_vec(), "", "novatel"),
        (sentence.to_vec(), "", "nmea"),
        (banner, "", "nmea"),
        (b"\xef\xbb\xbf [{\"a\": 1}]".to_vec(), "", "json"),
        (b"{\"a\": 1,\n \"b\": 2}".to_vec(), "", "json"),
        (b"% program : RTKPOST\n".to_vec(), "", "rtklib"),
        (b"#cP2020  6 25".to_vec(), "", "sp3"),
        (b"120 25 02 15 17 00 00 2 53".to_vec(), "day.ems", "ems"),
        (b"******** Week 377 almanac for PRN-01 ********\nID: 01\n".to_vec(), "alm.txt", "almanac"),
        (b"******** almost ********\n".to_vec(), "alm.txt", "csv"),
        (b"time,lat,lon\n1,2,3\n".to_vec(), "day.csv", "csv"),
        (b"\x10\x41abc\x10\x03\x10\x42a\x10\x10\x10\x03\x10\x43a\x10\x03".to_vec(), "", "tsip"),
        (b"\x10\x41abc\x10\x03\x10\x42a\x10\x10\x10\x03\x10\x43a\x10\x04".to_vec(), "", "csv"),
        // Size 2 and a sum that makes the whole 0 modulo 256.
        (b"\x10\x33\x02ab\x08\x10\x03".repeat(3), "", "garmin"),
        (b"\x10\x33\x02ab\x09\x10\x03".repeat(3), "", "tsip"),
        // The query of versions in Trimble's second form.
        (b"\x10\x90\x00\x00\x02\x00\x92\x10\x03".repeat(3), "", "tsip"),
        (b"\xba\xce\x04\x00\x01\x03\x01\x00\x00\x00\x05\x00\x01\x03".repeat(3), "", "casic"),
        (b"\xa0\xa1\x00\x02\xe5\x01\xe4\r\n".repeat(3), "", "skytraq"),
        (b"\xa0\xa1\x00\x02\xe5\x01\xe5\r\n".repeat(3), "", "csv"),
        (b"$BIN\x01\x00\x02\x00\xff\x02\x01\x01\r\n".repeat(3), "", "hemisphere"),
        (b"JP003RLO\r\n~~005\x01\x02\x03\x04\x05PV002ab\n".to_vec(), "", "javad"),
        (b"# Raw,utcTimeMillis,TimeNanos\nRaw,1,2\n".to_vec(), "gnss_log.txt", "gnss-logger"),
        (b"Fix,GPS,52.1,0.1,86,1,3.5,0,1741096809398\n".to_vec(), "", "gnss-logger"),
        (b"AXCS001\r\nHFDTE150722\r\nB1101355206343N00006198WA0058700558\r\n".to_vec(), "", "igc"),
        (b"AXCS001\r\nHFPLTPILOT\r\n".to_vec(), "", "csv"),
        (b"<?xml version=\"1.0\"?>\n<gpx version=\"1.1\"><trk/></gpx>".to_vec(), "", "gpx"),
        (b"<?xml version=\"1.0\"?>\n<kml><Document/></kml>".to_vec(), "", "kml"),
        // Their first bytes alone, in the middle of other data, make no log of a receiver.
        (b"\x00\x01$@\x00\x00\x00\x4f\x60\x00\xb5\x62\x01\x07\x5c\x00".to_vec(), "", "csv"),
        (b"\xa0\xa2\x00\x02\x01\x02\x00\x03\xb0\xb3".to_vec(), "", "sirf"),
        (b"\xa0\xa2\x00\x02\x01\x02\x00\x04\xb0\xb3".to_vec(), "", "csv"),
    ];
    for (content, name, expected) in cases {
        assert_eq!(id(&content, name), expected, "{:?}", String::from_utf8_lossy(&content));
    }
}

/// One entry makes a format known; those behind it stay what they are.
#[test]
fn a_toy_format_is_one_entry() {
    let toy = read("toy", "Toy", POSITIONS, "#TOY", |file| file.content.starts_with(b"#TOY,"));
    let formats: Vec<Format> = std::iter::once(toy).chain(FORMATS.iter().copied()).collect();
    let of = |content: &[u8]| recognise(&formats, &File { content, name: "" }).unwrap().id;
    assert_eq!((of(b"#TOY,1,2"), of(b"PAR1")), ("toy", "parquet"));
}

proptest::proptest! {
    /// Any bytes behind any sign, cut anywhere, are of some format.
    #[test]
    fn no_bytes_are_too_strange(parts in proptest::collection::vec((0_usize..12, proptest::collection::vec(proptest::num::u8::ANY, 0..40)), 0..12), cut in 0_usize..8) {
        let signs: [&[u8]; 12] =
            [b"\xb5\x62\x01\x07", b"$@", b"\x10", b"\x10\x03", b"\xba\xce", b"\xa0\xa1", b"$BIN", b"JP0FF", b"~~005", b"\xd3\x00", b"\xa0\xa2", b"Fix,GPS,"];
        let content: Vec<u8> = parts.iter().flat_map(|(sign, junk)| [signs[*sign], junk.as_slice()].concat()).collect();
        let content = content.get(..content.len().saturating_sub(cut)).unwrap_or_default();
        proptest::prop_assert!(!id(content, "log").is_empty());
    }
}
