//! Real records of the FAA's cycle 2604 (work of the U.S. Government), and what damages them.
#![allow(clippy::unwrap_used)] // A test may stop at the first surprise, in its helpers too.

use super::*;
use navbound_path::legs::State;
use std::io::Read;

const FIXES: &str = "\
SUSAEAENRT   FUZZZ K20    C     N39514934W104151140                       E0079     NAR           FUZZZ                    285842403
";

/// Records of 132 characters from shorter ones: the rest is filled with blanks and a record number.
fn padded(line: &str) -> String {
    format!("{line:<123}000012604\n")
}

const LEGS: [&str; 5] = [
    "SUSAP KDENK2FH26-Z AFUZZZ 010FUZZZK2EA0E  B    IF                                             18000                 A FS",
    "SUSAP KDENK2FH26-Z AFUZZZ 020JPBAGK2PC0E    010TF                                 + 07300                           A FS",
    "SUSAP KDENK2FH26-Z AFUZZZ 030GRASPK2PC0EE   010TF                                 + 07000                           A FS",
    "SUSAP KDENK2FH26-Z H      020GRASPK2PC1E  F    IF                                 + 07000     18000       RW26  K2PGA FS",
    "SUSAP KDENK2FH26-Z H      030RW26 K2PG0GY M 031TF                                   05350             -300          A FS",
];

const PLACES: [&str; 3] = [
    "SUSAP KDENK2CJPBAG K20    W     N39500000W104250000",
    "SUSAP KDENK2CGRASP K20    W     N39495000W104270000",
    "SUSAP KDENK2GRW26    0120002626 N39493900W104340000",
];

fn text(lines: &[&str]) -> String {
    lines.iter().map(|l| padded(l)).collect::<String>() + FIXES
}

fn whole() -> String {
    text(&[&PLACES[..], &LEGS[..]].concat())
}

fn database(text: &str) -> Database {
    read(text.as_bytes()).unwrap()
}

fn only(database: &Database) -> PathOfProcedure {
    let procedure = &database.procedures()[0];
    let routes: Vec<&Route> = procedure.routes.iter().collect();
    database.path_of(procedure, &routes, true)
}

#[test]
fn a_whole_procedure_has_a_path_on_every_leg() {
    let database = database(&whole());
    assert_eq!((database.n_refused, database.counts.approaches), (0, 5));
    let states: Vec<State> = only(&database).path.legs().iter().map(|l| l.state).collect();
    assert_eq!(states, [State::Point, State::Full, State::Full, State::Full]);
}

#[test]
fn a_cut_line_is_refused_and_its_route_is_not_whole() {
    let cut = whole().replace(&padded(LEGS[1]), &format!("{}\n", &LEGS[1][..80]));
    let database = database(&cut);
    assert_eq!(database.n_refused, 1);
    assert_eq!((database.refused[0].line, database.refused[0].reason.as_str()), (5, "not 132 characters long"));
    assert_eq!(database.procedures()[0].routes[0].refused, [5]);
}

#[test]
fn a_line_cut_before_its_procedure_is_counted_as_one_of_nobody() {
    let cut = whole().replace(&padded(LEGS[1]), "SUSAP KDENK2\n");
    let database = database(&cut);
    assert_eq!((database.n_refused, database.n_unattributed), (1, 1));
}

#[test]
fn a_missing_fix_takes_its_leg_and_the_next() {
    let database = database(&text(&[&PLACES[1..], &LEGS[..]].concat()));
    let states: Vec<State> = only(&database).path.legs().iter().map(|l| l.state).collect();
    assert_eq!(states, [State::Point, State::NoFix, State::NoStart, State::Full]);
}

#[test]
fn a_missing_centre_is_a_state_of_the_leg() {
    let arc = LEGS[1].replace("010TF  ", "010RF  ").replace("0E    010", "0E   L010");
    let database = database(&text(&[&PLACES[..], &[LEGS[0], &arc]].concat()));
    assert_eq!(only(&database).path.legs()[1].state, State::NoCentre);
}

#[test]
fn a_sequence_that_turns_back_is_refused() {
    let again = LEGS[0];
    let database = database(&text(&[&PLACES[..], &LEGS[..3], &[again]].concat()));
    assert_eq!(database.refused[0].reason, "not above that of the leg before");
    assert_eq!(database.procedures()[0].routes[0].refused.len(), 1);
}

#[test]
fn two_procedures_whose_lines_are_mixed_keep_apart() {
    let other: Vec<String> = LEGS.iter().map(|l| l.replace("H26-Z", "H26-Y")).collect();
    let mixed: Vec<&str> = LEGS.iter().zip(&other).flat_map(|(a, b)| [*a, b.as_str()]).collect();
    let database = database(&text(&[&PLACES[..], &mixed].concat()));
    assert_eq!((database.procedures().len(), database.n_refused), (2, 0));
    assert!(database.procedures().iter().all(|p| p.routes.iter().map(|r| r.legs.len()).sum::<usize>() == 5));
}

#[test]
fn two_fixes_of_one_name_in_two_places_decide_nothing() {
    let moved = PLACES[0].replace("W104250000", "W104260000");
    let database = database(&text(&[&PLACES[..], &[&moved], &LEGS[..]].concat()));
    assert_eq!(database.n_refused, 1);
    assert_eq!(only(&database).path.legs()[1].state, State::AmbiguousFix);
}

#[test]
fn a_line_of_a_gigabyte_takes_no_memory() {
    let (head, rest) = (whole(), text(&PLACES[..1]));
    let endless = std::io::repeat(b'X').take(1 << 30);
    let source = std::io::Cursor::new(head.clone()).chain(endless).chain(std::io::Cursor::new(format!("\n{rest}")));
    let mut lines = lines::Lines::new(std::io::BufReader::with_capacity(STEP, source));
    let (mut longest, mut kept, mut n) = (0, 0, 0);
    while let Some(line) = lines.next().unwrap() {
        (longest, kept, n) = (longest.max(line.length), kept.max(line.text.len()), n + 1);
    }
    assert_eq!((longest, n), (1 << 30, head.lines().count() + 1 + rest.lines().count()));
    assert!(kept <= 160);
}

#[test]
fn a_file_of_something_else_is_no_database() {
    assert!(read(&b"name,lat\nA,1\n"[..]).is_err());
    assert!(read(&b""[..]).is_err());
}

#[test]
fn a_packed_file_reads_as_the_plain_one() {
    use std::io::Write;
    let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    packer.write_all(whole().as_bytes()).unwrap();
    let packed = read(packer.finish().unwrap().as_slice()).unwrap();
    assert_eq!(packed.procedures(), database(&whole()).procedures());
}

#[test]
fn a_wrong_digit_names_its_field() {
    for (from, to, field) in [("031TF", "0A1TF", "RNP"), ("-300 ", "-3x0 ", "vertical angle"), ("030RW26", "0x0RW26", "sequence number")] {
        let database = database(&whole().replace(from, to));
        assert_eq!(database.refused[0].field, field);
    }
    let database = database(&whole().replace("N39500000W", "N39600000W"));
    assert_eq!(database.refused[0].field, "latitude");
}

proptest::proptest! {
    #[test]
    fn any_bytes_read_without_a_panic(bytes in proptest::collection::vec(proptest::prelude::any::<u8>(), 0..2000)) {
        let _ = read(bytes.as_slice());
    }

    #[test]
    fn any_damage_to_a_procedure_leaves_refusals_or_states(at in 0_usize..1500, byte in 32_u8..127) {
        let mut bytes = whole().into_bytes();
        if at < bytes.len() {
            bytes[at] = byte;
        }
        let database = read(bytes.as_slice()).unwrap();
        let _ = database.contradictions();
        for procedure in database.procedures() {
            let routes: Vec<&Route> = procedure.routes.iter().collect();
            for leg in database.path_of(procedure, &routes, true).path.legs() {
                proptest::prop_assert!(!leg.has_path() || leg.length.m() >= 0.0);
            }
        }
    }
}

/// The procedure with record numbers from `first` in steps of `step`, without the lines `without` of its five.
fn numbered(first: usize, step: usize, without: &[usize]) -> String {
    let legs = LEGS.iter().enumerate().filter(|(k, _)| !without.contains(k));
    let legs: String = legs.map(|(k, l)| format!("{l:<123}{:05}2604\n", (first - 1 + step * k) % 99_999 + 1)).collect();
    PLACES.iter().map(|l| padded(l)).collect::<String>() + &legs + FIXES
}

fn gaps(text: &str) -> Vec<Vec<Gap>> {
    database(text).procedures()[0].routes.iter().map(|r| r.gaps.clone()).collect()
}

#[test]
fn a_leg_line_that_is_lost_is_known_by_the_record_numbers() {
    let none = Vec::<Gap>::new();
    assert_eq!(gaps(&numbered(68_001, 1, &[])), [none.clone(), none.clone()]);
    assert_eq!(gaps(&numbered(68_001, 1, &[1])), [vec![Gap { line: 5, n_missing: 1, inside: true }], none.clone()]);
    // After 99,999 the national file begins again with 1.
    assert_eq!(gaps(&numbered(99_998, 1, &[])), [none.clone(), none.clone()]);
    assert_eq!(gaps(&numbered(99_998, 1, &[1])), [vec![Gap { line: 5, n_missing: 1, inside: true }], none.clone()]);
    // Between two routes nobody knows whose the line was.
    assert_eq!(gaps(&numbered(68_001, 1, &[2])), [none.clone(), vec![Gap { line: 6, n_missing: 1, inside: false }]]);
    let contradictions = database(&numbered(68_001, 1, &[1])).contradictions();
    assert!(contradictions.iter().any(|f| (f.line, f.kind, f.expected) == (5, Contradiction::Missing, 1.0)));
}

#[test]
fn record_numbers_that_number_something_else_say_nothing_of_lost_lines() {
    let none = Vec::<Gap>::new();
    assert_eq!(gaps(&numbered(7, 0, &[1])), [none.clone(), none.clone()]);
    assert_eq!(gaps(&numbered(10, 10, &[])), [none.clone(), none]);
}

#[test]
fn a_refused_line_is_not_counted_as_a_missing_one_too() {
    let text = numbered(68_001, 1, &[]).replace("020JPBAG", "0x0JPBAG");
    let database = database(&text);
    assert_eq!((database.n_refused, database.procedures()[0].routes[0].gaps.len()), (1, 0));
}
