//! Batches of RAIM: the bits of one epoch at a time, satellites that are not used left out, columns kept apart.
#![allow(clippy::unwrap_used)] // A test may stop at the first surprise, in its helpers too.

use nalgebra::Vector3;
use navbound_assess::outlook::Outcome;
use navbound_assess::raim::{Sights, levels, monitored};
use navbound_core::bound::raim::{Monitor, Requirement};
use navbound_core::bound::{Levels, Sight};
use navbound_core::signal::Constellation;

const SATELLITES: usize = 12;
const EPOCHS: usize = 700;

fn uniform(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 11) as f64 / (1_u64 << 53) as f64
}

/// Seeded skies; every seventh satellite is not used.
fn columns() -> (Vec<f64>, Vec<f64>, Vec<Constellation>) {
    let mut state = 41_u64;
    let (mut unit, mut sigma) = (Vec::new(), Vec::new());
    for k in 0..EPOCHS * SATELLITES {
        let (azimuth, up) = (std::f64::consts::TAU * uniform(&mut state), 0.1 + 0.89 * uniform(&mut state));
        let level = (1.0 - up * up).sqrt();
        unit.extend(if k % 7 == 3 { [f64::NAN; 3] } else { [level * azimuth.sin(), level * azimuth.cos(), up] });
        sigma.push(0.8 + uniform(&mut state));
    }
    (unit, sigma, (0..SATELLITES).map(|i| if i < 8 { Constellation::Gps } else { Constellation::Galileo }).collect())
}

#[test]
fn a_batch_is_its_epochs_one_by_one_and_names_the_column_of_the_excluded() {
    let (unit, sigma, systems) = columns();
    let sights = Sights { unit_enu: &unit, sigma_m: &sigma, constellation: &systems };
    let rows = levels(&sights, &Requirement::RAIM).unwrap();
    // A fault of 500 m in the first column that is used.
    let mut residual_m = vec![0.0; EPOCHS * SATELLITES];
    let first = |row: usize| (0..SATELLITES).find(|c| !unit[3 * (row * SATELLITES + c)].is_nan()).unwrap();
    (0..EPOCHS).for_each(|row| residual_m[row * SATELLITES + first(row)] = 500.0);
    let tested = monitored(&sights, &residual_m, &Requirement::RAIM).unwrap();
    let mut monitor = Monitor::new(&Requirement::RAIM);
    let mut excluded = 0;
    for row in 0..EPOCHS {
        let used = (row * SATELLITES..(row + 1) * SATELLITES).filter(|i| !unit[3 * i].is_nan());
        let one: Vec<_> = used
            .map(|i| {
                let unit = Vector3::new(unit[3 * i], unit[3 * i + 1], unit[3 * i + 2]);
                Sight::plain(unit, systems[i % SATELLITES], sigma[i] * sigma[i])
            })
            .collect();
        let detection = monitor.levels(&one).unwrap();
        let beside = (detection.detail, monitor.after_exclusion(&detection));
        assert_eq!(rows[row].levels, Some(Levels { hpl: detection.hpl, vpl: detection.vpl, detail: beside }));
        assert_eq!((rows[row].n_sv, rows[row].outcome), (one.len(), Outcome::Ok));
        assert_eq!(tested[row].before, rows[row]);
        if let Some(column) = tested[row].excluded {
            assert_eq!(column, first(row));
            excluded += 1;
        }
    }
    assert!(excluded > EPOCHS * 9 / 10, "only {excluded} of {EPOCHS} faults of 500 m were excluded");
}

#[test]
fn the_first_bad_number_is_reported_with_its_epoch() {
    let (unit, mut sigma, systems) = columns();
    sigma[300 * SATELLITES + 2] = -1.0;
    let sights = Sights { unit_enu: &unit, sigma_m: &sigma, constellation: &systems };
    let refused = levels(&sights, &Requirement::RAIM).err().unwrap();
    assert_eq!((refused.index, refused.error.argument), (300, "sigma_m"));
}
