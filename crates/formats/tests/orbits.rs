//! Orbits, clocks and almanacs of real analysis centres. Skipped, aloud, where the files are not at hand.
#![allow(clippy::unwrap_used, clippy::print_stderr, reason = "a test may stop at the first surprise, and a skipped one says so")]

use nalgebra::Vector3;
use navbound_core::geometry::broadcast;
use navbound_core::geometry::precise::{OrbitNode, state};
use navbound_core::quantity::GpsTime;
use navbound_core::signal::{Carrier, Constellation, SatelliteId, nearest};
use navbound_formats::packed::unpack;
use navbound_formats::precise::Precise;
use navbound_formats::rinex::{read_clocks, read_navigation};
use navbound_formats::{almanac, sp3};
use std::path::PathBuf;

/// Plain bytes of a file below the data folder: `NAVBOUND_DATA`, or `shared/data` beside the repository.
fn file(name: &str) -> Option<Vec<u8>> {
    let folder = std::env::var_os("NAVBOUND_DATA")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"), PathBuf::from);
    let bytes = std::fs::read(folder.join(name)).ok();
    if bytes.is_none() {
        eprintln!("SKIPPED: {name} is not below {}", folder.display());
    }
    bytes.map(|b| unpack(&b).unwrap().into_owned())
}

fn gps(number: u8) -> SatelliteId {
    SatelliteId { constellation: Constellation::Gps, number }
}

/// Counts by `grep -c '^P'` less lines of zeros, less those with a clock of nines, and by `grep -c '^AS'`.
#[test]
fn every_position_and_clock_arrives() {
    for (name, satellites, positions, clocks) in [
        ("gnss/ESBC_2020_177/GRG0MGXFIN_20201770000_01D_15M_ORB.SP3.gz", 75, 7200, 7200),
        ("gnss/igs_2010_182/igs15904.sp3", 32, 3072, 2935),
        ("gnss/ARLM_2015_200/test_input_sp3_nav_2015_200.sp3", 31, 8928, 8928),
        ("gnss/orbits_2019_010/igr20354.sp3", 32, 3034, 2871),
    ] {
        let Some(bytes) = file(name) else { return };
        let p = sp3::read(&bytes).unwrap();
        let count = |n: Vec<usize>| n.iter().sum::<usize>();
        let position =
            (p.orbits.len(), count(p.orbits.values().map(Vec::len).collect()), count(p.orbit_clocks.values().map(Vec::len).collect()));
        assert_eq!((position, p.refused.len()), ((satellites, positions, clocks), 0), "{name}: {:?}", p.refused.first());
    }
    for (name, clocks, step_s) in
        [("gnss/ESBC_2020_177/GRG0MGXFIN_20201770000_01D_30S_CLK.CLK.gz", 215_999, 30.0), ("gnss/igs_2010_182/igs15904.clk", 360, 300.0)]
    {
        let Some(bytes) = file(name) else { return };
        let p = read_clocks(&bytes).unwrap();
        let position: usize = p.clocks.values().map(Vec::len).sum();
        assert_eq!(p.refused.len(), 0, "{name}: {:?}", p.refused.first());
        assert_eq!((position, p.clock_step_s().map(f64::round)), (clocks, Some(step_s)), "{name}");
    }
}

/// The catalogue's own figure: nearest healthy record within two hours against the final orbit, PRN 1 left out.
#[test]
fn broadcast_orbits_differ_from_final_ones_as_an_independent_computation_says() {
    let names = ["gnss/igs_2010_182/brdc1820.10n", "gnss/igs_2010_182/igs15904.sp3"];
    let [Some(navigation), Some(orbits)] = names.map(file) else { return };
    let (navigation, orbits) = (read_navigation(&navigation).unwrap(), sp3::read(&orbits).unwrap());
    let mut differences = Vec::new();
    for (satellite, nodes) in orbits.orbits.iter().filter(|(s, _)| **s != gps(1)) {
        let healthy: Vec<_> = navigation.of(*satellite).iter().filter(|e| e.healthy(Carrier::L1)).copied().collect();
        for node in nodes {
            let Some(e) = nearest(&healthy, node.time).map(|k| &healthy[k]) else { continue };
            let s = broadcast::state(e, node.time).unwrap();
            differences.push(axes(&s.velocity_mps, node).map(|axis| axis.dot(&(s.position.vector() - node.position.vector()))));
        }
    }
    let n = differences.len() as f64;
    let rms = |k: usize| (differences.iter().map(|d| d[k] * d[k]).sum::<f64>() / n).sqrt();
    let mean = |k: usize| differences.iter().map(|d| d[k]).sum::<f64>() / n;
    let total = (rms(0).powi(2) + rms(1).powi(2) + rms(2).powi(2)).sqrt();
    // Which of two equally near records is taken differs: some tens of the 2880, by some decimetres each.
    assert!((2870.0..2890.0).contains(&n), "{n}");
    assert!((total - 1.866).abs() < 0.03, "3-D RMS {total} m");
    for (k, expected_rms, expected_mean) in [(0, 1.003, -0.747), (1, 1.484, -0.397), (2, 0.525, 0.037)] {
        assert!((rms(k) - expected_rms).abs() < 0.03, "axis {k}: RMS {}", rms(k));
        assert!((mean(k) - expected_mean).abs() < 0.03, "axis {k}: mean {}", mean(k));
    }
}

/// Radial, along and across the orbit, by the velocity among the stars.
fn axes(velocity: &Vector3<f64>, node: &OrbitNode) -> [Vector3<f64>; 3] {
    const EARTH_RATE: f64 = 7.292_115e-5;
    let p = node.position.vector();
    let inertial = velocity + EARTH_RATE * Vector3::new(-p.y, p.x, 0.0);
    let radial = p.normalize();
    let across = p.cross(&inertial).normalize();
    [radial, across.cross(&radial), across]
}

/// A 5-minute table thinned to 15 minutes: the nodes left out are known, and come back.
#[test]
fn a_thinned_orbit_gives_back_the_nodes_left_out() {
    let Some(bytes) = file("gnss/ARLM_2015_200/test_input_sp3_nav_2015_200.sp3") else { return };
    let p = sp3::read(&bytes).unwrap();
    let (mut inside, mut n) = (0.0_f64, 0);
    for (satellite, nodes) in &p.orbits {
        let thinned: Vec<OrbitNode> = nodes.iter().step_by(3).copied().collect();
        // Five intervals from the ends the polynomial is centred.
        for node in &nodes[15..nodes.len() - 18] {
            let node_state = state(&thinned, &p.orbit_clocks[satellite], 300.0, node.time).unwrap();
            inside = inside.max(node_state.position.minus(&node.position).vector().norm());
            n += 1;
        }
    }
    assert!(n > 7000);
    // The files round to a millimetre an axis; the polynomial adds some millimetres.
    assert!(inside < 0.015, "{inside} m");
}

/// Midnight lies inside a table of two days and at the end of each single one.
#[test]
fn two_days_join_at_midnight() {
    let names =
        ["gnss/ESBC_2020_177/GRG0MGXFIN_20201760000_01D_15M_ORB.SP3.gz", "gnss/ESBC_2020_177/GRG0MGXFIN_20201770000_01D_15M_ORB.SP3.gz"];
    let [Some(first), Some(second)] = names.map(file) else { return };
    let mut both = sp3::read(&first).unwrap();
    let single = sp3::read(&second).unwrap();
    both.merge(single.clone());
    let midnight = GpsTime::from_nanoseconds((2111 * 604_800 + 345_600) * 1_000_000_000);
    let at = |p: &Precise, seconds: f64| p.tables().state(gps(5), midnight.plus_seconds(seconds));
    // The day before ends at 23:45: the quarter of an hour to midnight exists only in the joined table.
    assert!(at(&single, -450.0).is_err() && at(&both, -450.0).is_ok());
    let apart = at(&both, 450.0).unwrap().position.minus(&at(&single, 450.0).unwrap().position).vector().norm();
    // The end of a single table: some centimetres, and a few more between two days' solutions.
    assert!(apart < 0.5 && apart > 0.0, "{apart} m");
    assert!(at(&both, 86_400.0).is_err());
}

#[test]
fn real_almanacs_are_read_and_agree_with_a_broadcast_constellation() {
    for (name, n, week) in
        [("gnss/almanacs/20160331.alm", 31, 866), ("gnss/almanacs/yuma377.txt", 30, 377), ("gnss/almanacs/current.al3", 31, 862)]
    {
        let Some(bytes) = file(name) else { return };
        let entries = almanac::read(&bytes).unwrap();
        assert_eq!((entries.len(), entries[0].week), (n, week), "{name}");
        for e in entries {
            // GPS: 26 560 km, a new one on its way to its slot 1 % off; 55 degrees within its drift (G11, launched in 1999, the farthest).
            assert!((e.elements.semi_major.m() - 26_560e3).abs() < 300e3, "{name} {}", e.satellite);
            assert!((e.elements.inclination.rad().to_degrees() - 55.0).abs() < 5.0, "{name} {}", e.satellite);
        }
    }
}

/// Real files, changed at random places or cut: an answer every time, never a panic. The seed is fixed.
#[test]
fn damaged_real_files_bring_no_reader_down() {
    let mut seed = 0x2010_0182_u64;
    let mut random = move |below: usize| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as usize % below.max(1)
    };
    for name in
        ["gnss/igs_2010_182/igs15904.sp3", "gnss/igs_2010_182/igs15904.clk", "gnss/almanacs/current.al3", "gnss/almanacs/yuma377.txt"]
    {
        let Some(whole) = file(name) else { return };
        for round in 0..60 {
            let mut bytes = whole[..whole.len().min(60_000)].to_vec();
            for _ in 0..=round % 8 {
                let at = random(bytes.len());
                bytes[at] = *b" -.0123456789*PVEG#%+:\n\r\xff\0".get(random(26)).unwrap_or(&b'x');
            }
            bytes.truncate(if round % 3 == 0 { random(bytes.len()) } else { bytes.len() });
            let _ = sp3::read(&bytes);
            let _ = read_clocks(&bytes);
            let _ = almanac::read(&bytes);
        }
    }
}
