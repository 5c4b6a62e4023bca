//! The readers on files of real receivers and data centres. Skipped, aloud, where the files are not at hand.
#![allow(clippy::print_stderr, reason = "a skipped test says so")]

use navbound_core::signal::{Constellation, Message};
use navbound_formats::packed::unpack;
use navbound_formats::rinex::{read_navigation, read_observations};
use std::path::PathBuf;

/// Bytes of a file below the data folder: `NAVBOUND_DATA`, or `shared/data` beside the repository.
fn file(name: &str) -> Option<Vec<u8>> {
    let folder = std::env::var_os("NAVBOUND_DATA")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"), PathBuf::from);
    let bytes = std::fs::read(folder.join(name)).ok();
    if bytes.is_none() {
        eprintln!("SKIPPED: {name} is not below {}", folder.display());
    }
    bytes
}

/// Counts of the catalogue (its own count of records, data/README.md) and of `grep -c '^G'` and so on.
#[test]
fn broadcast_of_a_station_day() {
    let Some(packed) = file("gnss/ESBC_2020_177/ESBC00DNK_R_20201770000_01D_MN.rnx.gz") else { return };
    let n = read_navigation(&unpack(&packed).unwrap()).unwrap();
    let count = |c| n.ephemerides.iter().filter(|e| e.satellite.constellation == c).count();
    assert_eq!((count(Constellation::Gps), count(Constellation::Galileo), count(Constellation::BeiDou)), (257, 1602, 357));
    assert_eq!((n.skipped["R FDMA"], n.skipped["J LNAV"], n.refused.len()), (510, 15, 0), "{:?}", n.refused.first());
    assert_eq!(n.geostationary.len(), 2130);
    assert_eq!(n.klobuchar_gps.unwrap().beta[3], -524_290.0);
}

#[test]
fn broadcast_of_version_4() {
    let Some(packed) = file("gnss/rinex4_2023_071/BRD400DLR_S_20230710000_01D_MN.rnx.gz") else { return };
    let n = read_navigation(&unpack(&packed).unwrap()).unwrap();
    let count = |m| n.ephemerides.iter().filter(|e| e.message == m).count();
    assert_eq!([Message::Lnav, Message::Inav, Message::Fnav, Message::D1, Message::D2].map(count), [428, 2943, 2897, 893, 168]);
    assert_eq!((n.geostationary.len(), n.refused.len()), (9072, 0), "{:?}", n.refused.first());
    assert_eq!((n.skipped["R FDMA"], n.skipped["C CNV2"], n.skipped["G CNAV"], n.skipped["STO C"]), (1240, 926, 334, 102));
    assert!(n.klobuchar_gps.is_some() && n.klobuchar_beidou.is_some());
}

#[test]
fn a_compact_day_of_every_system() {
    let Some(packed) = file("gnss/ESBC_2020_177/ESBC00DNK_R_20201770000_01D_30S_MO.crx.gz") else { return };
    let o = read_observations(&unpack(&packed).unwrap()).unwrap();
    assert_eq!((o.n_epochs(), o.n_refused), (2880, 0), "{:?}", o.refused.first());
    let last = o.time[2879].seconds_since(o.time[0]);
    assert_eq!(last, 2879.0 * 30.0);
    // First epoch: 43 satellites in the file, none of Japan; values from the text of the file itself.
    assert_eq!(o.satellites(0).len(), 43);
    assert_eq!(o.values(0)[0], 40_715_949.461);
    // Every GPS pseudorange is one: a satellite is 20 to 27 thousand kilometres away, the receiver clock below 1 ms.
    let column = o.column(Constellation::Gps, b"C1C").unwrap();
    let gps = (0..o.satellite.len()).filter(|k| o.satellite[*k].constellation == Constellation::Gps);
    let ranges: Vec<f64> = gps.map(|k| o.values(k)[column]).filter(|v| !v.is_nan()).collect();
    assert!(ranges.len() > 28_000);
    assert!(ranges.iter().all(|r| (19.5e6..27.5e6).contains(r)));
}

#[test]
fn plain_files_of_versions_2_and_3() {
    for (name, epochs) in [
        ("gnss/ARLM_2015_200/arlm200x.15o", 120),
        ("gnss/UPC3_2008_351_smoothing/UPC33510.08O_trunc", 25_025),
        ("gnss/taroz_static/rover.obs.gz", 301),
    ] {
        let Some(packed) = file(name) else { return };
        let o = read_observations(&unpack(&packed).unwrap()).unwrap();
        assert_eq!((o.n_epochs(), o.n_refused), (epochs, 0), "{name}: {:?}", o.refused.first());
    }
    for name in [
        "gnss/ARLM_2015_200/arlm2000.15n",
        "gnss/HK_TST_2019_118/hksc1180.19b",
        "gnss/HK_TST_2019_118/hksc1180.19n",
        "gnss/taroz_static/base.nav",
    ] {
        let Some(bytes) = file(name) else { return };
        let n = read_navigation(&bytes).unwrap();
        assert!(!n.ephemerides.is_empty());
        assert_eq!(n.refused.len(), 0, "{name}: {:?}", n.refused.first());
    }
}

/// Real files, changed at random places or cut: an answer every time, never a panic. The seed is fixed and printed by the failing file.
#[test]
fn damaged_real_files_bring_no_reader_down() {
    let mut state = 0x2020_0177_u64;
    let mut random = move |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below.max(1)
    };
    for name in [
        "gnss/ESBC_2020_177/ESBC00DNK_R_20201770000_01D_30S_MO.crx.gz",
        "gnss/ESBC_2020_177/ESBC00DNK_R_20201770000_01D_MN.rnx.gz",
        "gnss/rinex4_2023_071/BRD400DLR_S_20230710000_01D_MN.rnx.gz",
        "gnss/ARLM_2015_200/arlm200x.15o",
        "gnss/ARLM_2015_200/arlm2000.15n",
        "gnss/HK_TST_2019_118/COM3_190428_124409.obs",
        "gnss/HK_TST_2019_118/hksc1180.19b",
        "gnss/taroz_static/rover.obs.gz",
    ] {
        let Some(packed) = file(name) else { return };
        let plain = unpack(&packed).unwrap();
        for round in 0..40 {
            // The header and the first epochs: what decides how the rest is read, and quick.
            let mut bytes = plain[..plain.len().min(60_000)].to_vec();
            for _ in 0..=round % 8 {
                let at = random(bytes.len());
                bytes[at] = *b" -.0123456789>&GECRSJ\n\r\xff\0".get(random(24)).unwrap_or(&b'x');
            }
            bytes.truncate(if round % 3 == 0 { random(bytes.len()) } else { bytes.len() });
            let _ = read_observations(&bytes);
            let _ = read_navigation(&bytes);
            let mut cut = packed[..random(packed.len().min(100_000))].to_vec();
            if let Some(byte) = cut.last_mut() {
                *byte ^= 0x55;
            }
            let _ = unpack(&cut);
        }
    }
}
