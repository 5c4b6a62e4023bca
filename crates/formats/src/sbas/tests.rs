use super::*;
use navbound_core::signal::sbas::BLOCK_BYTES;
use proptest::prelude::*;
use std::io::Write;

/// MSAS, 2025-02-15 (cssrlib-data, MIT).
const EMS: &str = "137 25 02 15 17 00 01 3 C60DFFF8001FFDFFC005FFFFFDFFFFFFFFC001FFDFFEE3BABA3AEA7BAFA32580\n";
const SBS: &str = "2353 579601 137  3 : C60DFFF8001FFDFFC005FFFFFDFFFFFFFFC001FFDFFEE3BABA3AEA7B80\n";
const RINEX_B: &str = "     2.10           B: GEO-DATA         S: SBAS             RINEX VERSION / TYPE\n\
                                                            END OF HEADER\n\
137 25 02 15 17 00  1.1 L1 32   SBA   3\n\
C6 0D FF F8 00 1F FD FF C0 05 FF FF FD FF FF FF FF C0\n\
01 FF DF FE E3 BA BA 3A EA 7B AF A3 25 80\n";

/// Week 2353, second of week 579601.
const END: GpsTime = GpsTime::from_nanoseconds((2353 * 604_800 + 579_601) * 1_000_000_000);

#[test]
fn three_formats_give_the_same_message() {
    let ems = read(EMS.as_bytes(), None).unwrap();
    let sbs = read(SBS.as_bytes(), None).unwrap();
    let rinex = read(RINEX_B.as_bytes(), Some(Tag::End)).unwrap();
    assert_eq!((ems.format, sbs.format, rinex.format), (Format::Ems, Format::Rtklib, Format::RinexB));
    for log in [&ems, &sbs, &rinex] {
        assert!(log.refused.is_empty(), "{:?}", log.refused);
        assert_eq!((log.messages[0].end, log.messages[0].prn, log.messages[0].block.message_type()), (END, 137, 3));
    }
    assert_eq!(ems.messages, sbs.messages);
    assert_eq!(ems.messages, rinex.messages);
}

#[test]
fn a_tag_at_the_start_is_one_second_before_the_end() {
    let log = read(EMS.as_bytes(), Some(Tag::Start)).unwrap();
    assert_eq!(log.messages[0].end.nanoseconds() - END.nanoseconds(), 1_000_000_000);
    assert!(read(RINEX_B.as_bytes(), None).unwrap_err().reason.contains("start or the end"));
}

#[test]
fn damaged_lines_are_counted_with_their_reason() {
    let flipped = EMS.replace("FFF8", "FFF9");
    let odd = EMS.replace(" 3 C6", " 4 C6");
    let month = EMS.replace("25 02", "25 13");
    let short = EMS.replace("2580", "25");
    let log = read(format!("{EMS}{flipped}{odd}{month}{short}\n").as_bytes(), None).unwrap();
    assert_eq!(log.messages.len(), 1);
    let refused: Vec<_> = log.refused.iter().map(|r| (r.line, r.field.as_str())).collect();
    assert_eq!(refused, [(2, "message"), (3, "type"), (4, "date"), (5, "message")]);
    assert!(log.refused[0].reason.contains("parity"), "{}", log.refused[0].reason);
}

#[test]
fn preambles_tell_the_second_that_a_tag_means() {
    // Preambles in turn from a second that six divides; each message ends one second after it began.
    let message = |s: i64, shift: i64| {
        let mut bytes = [0_u8; BLOCK_BYTES];
        bytes[0] = [0x53, 0x9a, 0xc6][(s % 3) as usize];
        Received { end: GpsTime::from_nanoseconds((s + 1 + shift) * 1_000_000_000), prn: 137, block: Block::with_parity(bytes).unwrap() }
    };
    for (shift, late) in [(0, 0), (1, 1), (-1, -1)] {
        let log: Vec<_> = (600..660).map(|s| message(s, shift)).collect();
        assert_eq!(Preambles::of(&log)[0].late_s(), Some(late));
    }
    let mixed: Vec<_> = (600..660).map(|s| message(s, s / 6 % 2)).collect();
    assert_eq!(Preambles::of(&mixed)[0].late_s(), None);
    assert_eq!(Preambles::of(&[message(600, 1)])[0].late_s(), None, "one message proves nothing");
    // The recorded line above is tagged one second late.
    let recorded = read(EMS.as_bytes(), None).unwrap();
    assert_eq!(Preambles::of(&recorded.messages)[0].count, [0, 1, 0]);
}

#[test]
fn gzip_is_unpacked_and_what_is_no_log_is_refused() {
    let mut gz = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    gz.write_all(EMS.as_bytes()).unwrap();
    assert_eq!(read(&gz.finish().unwrap(), None).unwrap().messages.len(), 1);
    for text in ["", "\n\n", "time,hpl\n1,2\n"] {
        assert!(read(text.as_bytes(), None).is_err(), "{text:?}");
    }
}

proptest! {
    // Whatever the bytes, an answer; no line of the file is lost.
    #[test]
    fn any_bytes_are_read_or_refused(bytes in proptest::collection::vec(any::<u8>(), 0..400), at in 0..95_usize, cut in 0..95_usize) {
        let _ = read(&bytes, Some(Tag::End));
        let mut line = EMS.as_bytes().to_vec();
        let n = at % line.len();
        line[n] = bytes.first().copied().unwrap_or(0);
        line.truncate(cut);
        let text = [EMS.as_bytes(), &line].concat();
        let log = read(&text, None).unwrap();
        let lines = String::from_utf8_lossy(&text).lines().filter(|l| !l.trim().is_empty() && !l.trim().starts_with(['#', '*', '%'])).count();
        prop_assert_eq!(log.messages.len() + log.refused.len(), lines);
    }
}

#[test]
fn a_message_whose_time_runs_backwards_is_refused_and_the_others_stand() {
    let at = |s: u32| EMS.replace("17 00 01", &format!("17 00 {s:02}"));
    for wrong in [59, 2] {
        let text: String = [10, 11, wrong, 12, 13].map(at).concat();
        let log = read(text.as_bytes(), None).unwrap();
        assert_eq!(log.messages.len(), 4);
        assert_eq!((log.refused[0].line, log.refused[0].field.as_str()), (3, "time"));
    }
    assert!(read([at(10), at(10)].concat().as_bytes(), None).unwrap().refused.is_empty(), "two receivers hear one message");
}
