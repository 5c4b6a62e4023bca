//! RTKLIB solution files: one place written four ways, what is refused, and any bytes at all.

#![allow(clippy::unwrap_used)] // A test may stop at the first surprise, its helpers too.

use navbound_formats::rtklib::{Solutions, read};
use proptest::prelude::*;

const DEGREES: &str = "\
% program   : RTKLIB
%  GPST                  latitude(deg) longitude(deg)  height(m)   Q  ns   sdn(m)   sde(m)   sdu(m)  sdne(m)  sdeu(m)  sdun(m) age(s)  ratio
2023/07/11 06:04:30.000   35.165361090  136.881408660    41.3910   5  20   3.0000   4.0000   7.0000   1.5000  -1.2000   0.8000   0.00    0.0
";

/// GPS week 2270, 194670 s.
const TIME_NS: i64 = 2270 * 604_800_000_000_000 + 194_670_000_000_000;

/// The place and covariance of `DEGREES` in the other forms, by pyproj 3.7.2 (EPSG:4979 to EPSG:4978) and rotations written there.
const OTHERS: [&str; 4] = [
    "%  UTC  latitude(d'\")  longitude(d'\")  height(m)  Q ns sdn(m) sde(m) sdu(m) sdne(m) sdeu(m) sdun(m) age(s) ratio
2023/07/11 06:04:12.000  35 09 55.299924  136 52 53.071176  41.3910  5 20 3.0 4.0 7.0 1.5 -1.2 0.8 0.00 0.0
",
    "%  GPST x-ecef(m) y-ecef(m) z-ecef(m) Q ns sdx(m) sdy(m) sdz(m) sdxy(m) sdyz(m) sdzx(m) age(s) ratio
2270 194670.000 -3810228.5819 3567868.5467 3652903.3004 5 20 4.87078472 5.23494100 4.78234764 -3.11548619 3.50464923 -3.82028545 0.00 0.0
",
    "% ref pos   : 35.1  136.9   50.0
%  JST e-baseline(m) n-baseline(m) u-baseline(m) Q ns sde(m) sdn(m) sdu(m) sden(m) sdnu(m) sdue(m) age(s) ratio
2023/07/11 15:04:12.000 -1693.7590 7251.5595 -12.9699 5 20 4.00020086 3.00011225 6.99983711 1.49895554 0.82855029 -1.20465667 0.00 0.0
",
    "%  GPST,latitude(deg),longitude(deg),height(m),Q,ns,sdn(m),sde(m),sdu(m),sdne(m),sdeu(m),sdun(m),age(s),ratio
2023/07/11 06:04:30.000,35.165361090,136.881408660,41.3910,5,20,3.0000,4.0000,7.0000,1.5000,-1.2000,0.8000,0.00,0.0
",
];

fn one(text: &str) -> Solutions {
    let s = read(text).unwrap();
    assert_eq!((s.n_rows, s.line.len(), s.refused.len()), (1, 1, 0), "{:?}", s.refused);
    s
}

/// Found by fuzzing: a header cut short promised fewer columns than a position needs.
#[test]
fn a_header_that_names_part_of_a_position_is_refused() {
    for cut in ["%  GPST latitude(deg) longituheight(l\n,05,,23.000,00.,00.0\n", "%  GPST x-ecef(m)\n2270 1.0 1.0\n"] {
        let e = read(cut).unwrap_err();
        assert!(e.line == Some(1) && e.reason.contains("the columns after"), "{e:?}");
    }
}

#[test]
fn a_row_of_degrees_is_read_as_it_stands() {
    let s = one(DEGREES);
    assert_eq!((s.line[0], s.time[0].nanoseconds(), s.quality[0], s.n_sv[0]), (3, TIME_NS, 5, 20));
    // One unit in the last place of an angle in radians.
    assert!((s.lat_rad[0].to_degrees() - 35.165_361_09).abs() < 1e-14 * 90.0);
    assert!((s.lon_rad[0].to_degrees() - 136.881_408_66).abs() < 1e-14 * 180.0);
    assert!((s.h_m[0] - 41.391).abs() < 1e-12);
    // East first, and the sign of a covariance is the sign of its root.
    let expected = [16.0, 2.25, 9.0, -1.44, 0.64, 49.0];
    for (variance, expected) in s.cov_m2[0].iter().zip(expected) {
        assert!((variance - expected).abs() < 1e-12, "{:?}", s.cov_m2[0]);
    }
    assert!(s.ground_speed_mps[0].is_nan());
}

#[test]
fn protection_levels_are_read_where_the_file_has_them() {
    let text = "\
%  GPST                  latitude(deg) longitude(deg)  height(m)   Q  ns   sdn(m)   sde(m)   sdu(m)  sdne(m)  sdeu(m)  sdun(m) hpl (m) vpl (m)
2006/12/27 00:04:30.000   35.311789409 -120.661114248   130.5055   3   4  11.2136  19.9097  33.6717  14.3341  25.7826  18.5806 135.11  179.5
";
    let s = one(text);
    assert_eq!((s.hpl_m[0], s.vpl_m[0], s.n_sv[0]), (135.11, 179.5, 4));
    assert!(one(DEGREES).hpl_m[0].is_nan());
    let refused = read(&text.replace("179.5", "-1.0")).unwrap().refused;
    assert_eq!((refused[0].field.as_str(), refused[0].text.as_str()), ("vpl (m)", "-1.0"));
}

#[test]
fn one_place_written_four_ways_is_one_place() {
    let expected = one(DEGREES);
    for text in OTHERS {
        let s = one(text);
        assert_eq!(s.time[0].nanoseconds(), TIME_NS, "{text}");
        // 0.1 mm, the last digit of the Cartesian forms, is 1.6e-11 rad.
        assert!((s.lat_rad[0] - expected.lat_rad[0]).abs() < 3.2e-11, "{text}");
        assert!((s.lon_rad[0] - expected.lon_rad[0]).abs() < 3.2e-11, "{text}");
        assert!((s.h_m[0] - expected.h_m[0]).abs() < 2e-4, "{text}");
        // Roots of up to 7 m with eight decimals, through two rotations.
        for (variance, expected) in s.cov_m2[0].iter().zip(expected.cov_m2[0]) {
            assert!((variance - expected).abs() < 1e-6, "{text}: {:?}", s.cov_m2[0]);
        }
    }
}

#[test]
fn velocities_give_the_speed_over_the_ground() {
    let text = DEGREES.replace("ratio\n", "ratio vn(m/s) ve(m/s) vu(m/s)\n").replace("0.0\n", "0.0 3.0 -4.0 12.0\n");
    assert!((one(&text).ground_speed_mps[0] - 5.0).abs() < 1e-12);
}

/// Programs that write a table of floats give every count decimals.
#[test]
fn a_count_may_be_written_as_a_whole_float() {
    let text = DEGREES.replace("   5  20 ", "   5.0000000  20.0000000 ");
    let (s, whole) = (read(&text).unwrap(), read(DEGREES).unwrap());
    assert_eq!((s.refused.len(), s.quality, s.n_sv), (0, whole.quality, whole.n_sv));
}

#[test]
fn bad_rows_are_refused_one_by_one() {
    let good = DEGREES.lines().last().unwrap();
    for (bad, field, reason) in [
        (good.replace("35.165361090", "95.1"), "latitude(deg)", "outside [-90, 90]"),
        (good.replace("136.881408660", "400"), "longitude(deg)", "outside [-360, 360]"),
        (good.replace("41.3910", "nan"), "height(m)", "not a finite number"),
        (good.replace("41.3910", "9e9"), "position", "height outside"),
        (good.replace("41.3910", "high"), "height(m)", "not a number"),
        (good.replace("2023/07/11", "2023/02/30"), "time", "not a time"),
        (good.replace("06:04:30.000", "06:04"), "time", "not a time"),
        (good.replace("06:04:30.000", "06:04:-3.000"), "time", "not a time"),
        (good.replace("   3.0000", "  -3.0000"), "standard deviation", "below zero"),
        (good.replace("  20 ", "  2O "), "ns", "not a count"),
        (good.replace("  20 ", "  20.5 "), "ns", "not a count"),
        (good.replace("   0.00    0.0", ""), "row", "number of fields"),
    ] {
        let s = read(&format!("{DEGREES}{bad}\n")).unwrap();
        assert_eq!((s.n_rows, s.line.len(), s.refused.len()), (2, 1, 1), "{bad}");
        assert_eq!((s.refused[0].line, s.refused[0].field.as_str()), (4, field), "{bad}");
        assert!(s.refused[0].reason.contains(reason), "{bad}: {}", s.refused[0].reason);
    }
}

#[test]
fn a_file_that_names_no_columns_is_unreadable() {
    let data = DEGREES.lines().last().unwrap();
    assert!(read(data).unwrap_err().reason.contains("names the columns"));
    let strange = DEGREES.replace("latitude(deg)", "x(furlong)");
    assert_eq!(read(&strange).unwrap_err().line, Some(2));
    let homeless = OTHERS[2].lines().skip(1).collect::<Vec<_>>().join("\n");
    assert!(read(&homeless).unwrap_err().reason.contains("ref pos"));
}

#[test]
fn without_deviations_the_covariance_is_unknown_not_zero() {
    let text = "%  GPST latitude(deg) longitude(deg) height(m)\n2270 194670.000 35.1 136.8 41.3\n";
    let s = one(text);
    assert!(s.cov_m2[0].iter().all(|v| v.is_nan()));
    assert_eq!((s.quality[0], s.n_sv[0]), (0, 0));
}

proptest! {
    #[test]
    fn any_text_is_read_or_refused(text in "\\PC{0,400}") {
        let _ = read(&text);
    }

    #[test]
    fn any_rows_below_a_header_are_read_or_refused(which in 0..4usize, rows in proptest::collection::vec("[-0-9:/. ,naif]{0,160}", 0..8)) {
        let header: Vec<&str> = OTHERS[which].lines().filter(|l| l.starts_with('%')).collect();
        let text = format!("{}\n{}\n", header.join("\n"), rows.join("\n"));
        let s = read(&text).unwrap();
        prop_assert_eq!(s.n_rows, s.line.len() + s.refused.len());
        prop_assert!(s.lat_rad.iter().chain(&s.lon_rad).chain(&s.h_m).all(|v| v.is_finite()));
    }
}
