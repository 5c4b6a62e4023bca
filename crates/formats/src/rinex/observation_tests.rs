use super::*;
use proptest::prelude::*;

const V3: &str = "     3.03           OBSERVATION DATA    M: Mixed            RINEX VERSION / TYPE
rover                                                       MARKER NAME
 -2419215.8865  5385498.5603  2405403.6314                  APPROX POSITION XYZ
        0.2160        0.0000        0.0000                  ANTENNA: DELTA H/E/N
G    4 C1C L1C D1C S1C                                      SYS / # / OBS TYPES
C    4 C2I L2I D2I S2I                                      SYS / # / OBS TYPES
J    4 C1C L1C D1C S1C                                      SYS / # / OBS TYPES
  2019     4    28    12    44   33.9970000     GPS         TIME OF FIRST OBS
                                                            END OF HEADER
> 2019  4 28 12 44 33.9970000  0  4
G 2  21600712.022   113512506.8763        445.146          27.000
C11  22238239.302                3      -1212.376          20.000
J02  38239239.302                3      -1212.376          20.000
G19  19761890.586                3          0.000           0.000
> 2019  4 28 12 44 34.9970000  1  1
G 2  21600627.834                3        445.563          26.000
";

const V2: &str = "     2.11           OBSERVATION DATA    G                   RINEX VERSION / TYPE
     6    C1    L1    L2    P1    P2    D1                  # / TYPES OF OBSERV
  2008    12    16     9    43    1.0000000     GPS         TIME OF FIRST OBS
                                                            END OF HEADER
 08 12 16 09 43 01.0000000  0  2G03 12                              -0.123456789
  24824133.4974    -547186.60258   -422587.18056  24824132.9234   24824139.1204
       -12.345
  20000000.000           0.000

  08 12 16
";

fn read(text: &str) -> Observations {
    read_observations(text.as_bytes()).unwrap()
}

fn gps(number: u8) -> SatelliteId {
    SatelliteId { constellation: Constellation::Gps, number }
}

#[test]
fn a_name_of_version_2_that_is_none_is_refused() {
    let error = read_observations(V2.replace("P2    D1", "P2    D-").as_bytes()).unwrap_err().reason;
    assert!(error.contains("'D-' is not the name of an observation"), "{error}");
}

#[test]
fn a_version_3_file_becomes_a_table() {
    let o = read(V3);
    // 2019-04-28 is the first day of GPS week 2051; the file counts in GPS time, and so do we: no leap seconds.
    let first = (2051 * 604_800 + 12 * 3600 + 44 * 60 + 33) * 1_000_000_000 + 997_000_000;
    assert_eq!(o.time.iter().map(|t| t.nanoseconds()).collect::<Vec<_>>(), [first, first + 1_000_000_000]);
    assert_eq!(o.interrupted, [false, true]);
    assert_eq!((o.satellites(0), o.satellites(1)), (0..3, 3..4));
    assert_eq!(o.satellite[0], gps(2));
    assert_eq!(o.values(0), [21_600_712.022, 113_512_506.876, 445.146, 27.0]);
    assert_eq!(o.indicator[1], 0x30);
    assert!(o.values(1)[1].is_nan());
    // A strength of zero is none; a Doppler of zero is one.
    assert!(o.values(2)[3].is_nan() && o.values(2)[2] == 0.0);
    assert_eq!(o.skipped["satellites of J"], 1);
    assert_eq!((o.n_refused, o.antenna_delta_m[0], o.marker.as_str()), (0, 0.216, "rover"));
    assert_eq!(o.column(Constellation::BeiDou, b"D2I"), Some(2));
}

#[test]
fn a_known_reader_is_eighteen_seconds_wrong_and_we_are_not() {
    // gnss_lib_py 1.1.0 takes RINEX epochs as UTC and adds 18 s. 2019-04-28 12:44:33.997 GPS is 2051 weeks and 45873.997 s.
    let t = read(V3).time[0].nanoseconds();
    assert_eq!(t % (604_800 * 1_000_000_000), 45_873_997_000_000);
}

#[test]
fn the_time_system_of_the_header_is_obeyed() {
    let seconds = |system: &str| read(&V3.replace("     GPS  ", &format!("     {system}  "))).time[0].nanoseconds() / 1_000_000_000;
    assert_eq!(seconds("GLO") - seconds("GPS"), 18);
    assert_eq!(seconds("BDT") - seconds("GPS"), 14);
    assert_eq!(seconds("GAL"), seconds("GPS"));
    assert!(read_observations(V3.replace("     GPS  ", "     XYZ  ").as_bytes()).unwrap_err().reason.contains("XYZ"));
}

#[test]
fn version_2_names_are_translated_and_lines_joined() {
    let o = read(&V2.replace("  08 12 16\n", ""));
    assert_eq!(o.codes[Constellation::Gps.index()], [*b"C1C", *b"L1C", *b"L2W", *b"C1W", *b"C2W", *b"D1C"]);
    assert_eq!((o.satellite[0], o.satellite[1]), (gps(3), gps(12)));
    assert_eq!(o.values(0), [24_824_133.497, -547_186.602, -422_587.180, 24_824_132.923, 24_824_139.120, -12.345]);
    assert_eq!(o.indicator[..3], [0x40, 0x58, 0x56]);
    assert_eq!(o.clock_offset_s, [-0.123456789]);
    assert!(o.values(1)[1].is_nan());
    // 2008-12-16, the second day of week 1510.
    assert_eq!(o.time[0].nanoseconds(), (1510 * 604_800 + 2 * 86_400 + 9 * 3600 + 43 * 60 + 1) * 1_000_000_000);
}

#[test]
fn errors_name_line_field_and_text() {
    let e = read_observations(V2.as_bytes()).unwrap_err();
    assert_eq!((e.line, e.field.as_deref()), (Some(10), Some("epoch")));
    assert!(e.reason.contains("08 12 16"), "{}", e.reason);
    let o = read(&V3.replace("22238239.302", "22238x39.302"));
    assert_eq!((o.n_refused, o.refused[0].line, o.refused[0].field.as_str()), (1, 12, "observation 1"));
    assert!(o.refused[0].text.contains("22238x39.302"));
    assert!(o.values(1)[0].is_nan() && o.values(1)[2] == -1212.376);
}

#[test]
fn an_epoch_cut_short_is_left_out_and_reported() {
    let cut = V3.replace("C11  22238239.302                3      -1212.376          20.000\n", "");
    let o = read(&cut);
    assert_eq!((o.n_epochs(), o.n_refused, o.n_lost_epochs, o.satellite.len()), (1, 1, 1, 1));
    assert!(o.refused[0].reason.contains("3 of 4"), "{}", o.refused[0].reason);
    let ends = V2.lines().take(7).fold(String::new(), |s, l| s + l + "\n");
    assert_eq!(read(&ends).n_refused, 1);
}

#[test]
fn an_epoch_whose_line_cannot_be_read_is_lost_once_whatever_follows_it() {
    let n = read(V3).n_epochs();
    let no_date = read(&V3.replacen("> 2019", "> 2O19", 1));
    assert_eq!((no_date.n_epochs(), no_date.n_lost_epochs), (n - 1, 1));
    assert!(no_date.n_refused > 1, "its satellites are refused beside it");
    let no_mark = read(&V3.replacen("> 2019", "? 2019", 1));
    assert_eq!((no_mark.n_epochs(), no_mark.n_lost_epochs), (n - 1, 1));
    assert_eq!(read(V3).n_lost_epochs, 0);
}

#[test]
fn a_scale_factor_is_taken_out() {
    let line = "G   10   1 D1C                                              SYS / SCALE FACTOR\n";
    let o = read(&V3.replace("  2019     4    28", &format!("{line}  2019     4    28")));
    assert!((o.values(0)[2] - 44.5146).abs() < 1e-12);
    assert_eq!(o.values(0)[0], 21_600_712.022);
}

const COMPACT: &str = "3.0                 COMPACT RINEX FORMAT                    CRINEX VERS   / TYPE
RNX2CRX ver.4.0.8                       06-Jul-22 13:22     CRINEX PROG / DATE
     3.03           OBSERVATION DATA    M: Mixed            RINEX VERSION / TYPE
G    2 C1C L1C                                              SYS / # / OBS TYPES
  2019     4    28    12    44   33.0000000     GPS         TIME OF FIRST OBS
                                                            END OF HEADER
> 2019 04 28 12 44 33.0000000  0  2      G02G19

3&21600712022 3&113512506876  & 3
3&19761890586   &
                    4

-84188 1000 1
12
                    5             1         &&&

100000 -20
";

/// First order 21600712022 - 84188; second: first difference -84188 + 100000.
#[test]
fn a_compact_file_becomes_the_same_table() {
    let o = read(COMPACT);
    assert_eq!(o.n_epochs(), 3, "{:?}", o.refused);
    let ranges: Vec<f64> = (0..3).map(|k| o.values(o.satellites(k).start)[0]).collect();
    assert_eq!(ranges, [21_600_712.022, 21_600_627.834, 21_600_643.646]);
    let phases: Vec<f64> = (0..3).map(|k| o.values(o.satellites(k).start)[1]).collect();
    assert_eq!(phases, [113_512_506.876, 113_512_507.876, 113_512_508.856]);
    assert_eq!(o.values(3)[0], 19_761_890.598);
    assert_eq!((o.indicator[1], o.indicator[4], o.indicator[5]), (3, 0x10, 3));
    assert_eq!((o.satellites(2).len(), o.n_refused), (1, 0));
}

#[test]
fn a_difference_without_a_start_is_refused_not_guessed() {
    let o = read(&COMPACT.replace("3&19761890586   &", "               "));
    assert_eq!(o.n_refused, 1);
    assert!(o.values(3)[0].is_nan());
    // Damage of the epoch line loses what follows until a fresh start, and the epoch before it: a line too many there looks the same.
    let o = read(&COMPACT.replace("                    4\n", "                    x\n"));
    assert_eq!((o.n_epochs(), o.n_refused), (0, 3));
    assert_eq!(o.refused.iter().filter(|r| r.reason.contains("fresh start")).count(), 2, "{:?}", o.refused);
}

proptest! {
    #[test]
    fn no_bytes_bring_the_reader_down(which in 0_usize..3, at in 0_usize..1200, byte in any::<u8>(), cut in 0_usize..1200, tail in proptest::collection::vec(any::<u8>(), 0..300)) {
        let file = [V3, V2, COMPACT][which].as_bytes();
        let mut changed = file.to_vec();
        let at = at % changed.len();
        changed[at] = byte;
        let _ = read_observations(&changed);
        let _ = read_observations(&file[..cut.min(file.len())]);
        let _ = read_observations(&[file, &tail].concat());
    }
}

/// Epochs of one satellite at seconds of a minute.
fn seconds(of: &[u32]) -> String {
    let header = V3.split_inclusive("END OF HEADER\n").next().unwrap_or_default().to_owned();
    of.iter().fold(header, |text, s| {
        text + &format!("> 2019  4 28 12 44 {s:2}.0000000  0  1\nG02  21600712.022   113512506.8763        445.146          27.000\n")
    })
}

#[test]
fn an_epoch_out_of_the_order_of_time_is_refused_alone_with_its_line() {
    for (of, reason) in [(&[10, 11, 55, 12, 13][..], "backwards"), (&[10, 11, 2, 12, 13], "backwards"), (&[10, 11, 11, 12], "twice")] {
        let o = read(&seconds(of));
        assert_eq!((o.n_epochs(), o.n_refused), (of.len() - 1, 1), "{of:?}");
        assert!(o.time.is_sorted_by(|a, b| a < b));
        // Nine lines of header, two an epoch.
        assert_eq!(o.refused[0].line, 9 + 2 * 3, "{:?}", o.refused);
        assert!(o.refused[0].reason.contains(reason), "{:?}", o.refused);
        assert_eq!(o.satellites(o.n_epochs() - 1).len(), 1);
    }
    let other = seconds(&[10, 11, 11, 12]).replacen("21600712.022", "21600999.022", 2).replacen("21600999.022", "21600712.022", 1);
    let o = read(&other);
    assert_eq!((o.n_epochs(), o.n_refused), (2, 2), "which of the two is right, nobody knows");
    assert!(o.refused.iter().all(|r| r.reason.contains("contradict")));
}

#[test]
fn a_range_that_no_receiver_measures_and_a_number_that_no_satellite_has_are_refused() {
    let o = read(&V3.replace("  21600712.022   ", "9999999999.999   ").replace("G19", "G99"));
    assert!(o.values(0)[0].is_nan() && o.values(0)[1] == 113_512_506.876, "the phase stays");
    let refused: Vec<_> = o.refused.iter().map(|r| (r.field.as_str(), r.line)).collect();
    assert!(refused.contains(&("satellite", 14)) && refused.iter().any(|(field, _)| *field == "C1C"), "{refused:?}");
    assert_eq!((o.n_refused, o.satellites(0).len()), (2, 2));
}

#[test]
fn a_satellite_that_stands_twice_in_an_epoch_is_one_measurement_or_none() {
    let g02 = "G 2  21600712.022   113512506.8763        445.146          27.000\n";
    let g19 = "G19  19761890.586                3          0.000           0.000\n";
    // Once more as it stands, and once more with another range.
    let twice =
        V3.replace("33.9970000  0  4", "33.9970000  0  6").replace(g19, &format!("{g19}{g02}{}", g19.replace("890.586", "920.586")));
    let (once, o) = (read(V3), read(&twice));
    assert_eq!(o.satellite, once.satellite.iter().copied().filter(|s| *s != gps(19)).collect::<Vec<_>>());
    assert_eq!(o.values(0), once.values(0));
    assert_eq!((o.satellites(0), o.satellites(1)), (0..2, 2..3));
    let reasons: Vec<(&str, &str)> = o.refused.iter().map(|r| (r.text.as_str(), r.reason.as_str())).collect();
    let mut expected = [("G19", LISTED_AGAINST), ("G02", LISTED_TWICE), ("G19", LISTED_AGAINST)];
    expected.sort_unstable();
    let mut reasons = reasons;
    reasons.sort_unstable();
    assert_eq!(reasons, expected);
}
