//! Batches of ARAIM levels: the bits of one epoch at a time, whatever the instructions and the threads.
#![allow(clippy::unwrap_used)] // A test may stop at the first surprise, in its helpers too.

use nalgebra::Vector3;
use navbound_assess::araim::{Rule, Sights, levels};
use navbound_assess::outlook::Outcome;
use navbound_core::bound::Sight;
use navbound_core::bound::araim::service::Service;
use navbound_core::bound::araim::{Levels, Monitor};
use navbound_core::quantity::Metres;
use navbound_core::signal::Constellation;

const SATELLITES: usize = 20;
const P_CONST: [f64; 5] = [1e-8, 1e-4, 1e-4, 1e-4, 1e-4];

struct Columns {
    unit: Vec<f64>,
    sigma: Vec<f64>,
    ones: Vec<f64>,
    p_sat: Vec<f64>,
    systems: Vec<Constellation>,
}

/// Seeded skies; every seventh satellite is not used, `spread` makes the priors of satellites differ.
fn columns(epochs: usize, spread: f64) -> Columns {
    let mut state = 99_u64;
    let mut uniform = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let (mut unit, mut sigma, mut p_sat) = (Vec::new(), Vec::new(), Vec::new());
    for k in 0..epochs * SATELLITES {
        let (azimuth, up) = (std::f64::consts::TAU * uniform(), 0.1 + 0.89 * uniform());
        let level = (1.0 - up * up).sqrt();
        let line = [level * azimuth.sin(), level * azimuth.cos(), up];
        unit.extend(if k % 7 == 3 { [f64::NAN; 3] } else { line });
        sigma.push(0.8 + uniform());
        p_sat.push(1e-5 * (1.0 + spread * uniform()));
    }
    let systems = (0..SATELLITES).map(|i| if i < 10 { Constellation::Gps } else { Constellation::Galileo }).collect();
    Columns { unit, sigma, ones: vec![1.0; epochs * SATELLITES], p_sat, systems }
}

fn alone(c: &Columns, epoch: usize) -> (usize, Levels) {
    let sight = |i: usize| Sight {
        unit: Vector3::new(c.unit[3 * i], c.unit[3 * i + 1], c.unit[3 * i + 2]),
        constellation: c.systems[i % SATELLITES],
        integrity_m2: c.sigma[i] * c.sigma[i],
        accuracy_m2: 1.0,
        receiver_faulty_m2: 1.0,
        bias: Metres::new(1.0),
        bias_continuity: Metres::new(1.0),
        p_sat: c.p_sat[i],
    };
    let sights: Vec<_> = (epoch * SATELLITES..(epoch + 1) * SATELLITES).filter(|i| !c.unit[3 * i].is_nan()).map(sight).collect();
    let modes = Service::LPV_200.modes(&sights, &P_CONST).unwrap();
    (sights.len(), Monitor::default().levels(&sights, &modes, &Service::LPV_200).unwrap())
}

#[test]
fn a_batch_has_the_bits_of_single_epochs_with_priors_alike_or_not() {
    for spread in [0.0, 3.0] {
        let c = columns(300, spread);
        let sights = Sights {
            unit_enu: &c.unit,
            sigma_int_m: &c.sigma,
            sigma_acc_m: &c.ones,
            bias_m: &c.ones,
            bias_continuity_m: &c.ones,
            p_sat: &c.p_sat,
            constellation: &c.systems,
            p_const: P_CONST,
        };
        let rows = levels(&sights, &Rule::Araim(Service::LPV_200), false).unwrap();
        assert_eq!(rows.len(), 300);
        for (epoch, row) in rows.iter().enumerate() {
            let (n_sv, single) = alone(&c, epoch);
            assert_eq!((row.n_sv, row.outcome), (n_sv, Outcome::Ok));
            let batch = row.levels.unwrap();
            assert_eq!(batch.vpl_m().to_bits(), single.vpl_m().to_bits(), "epoch {epoch}");
            assert_eq!(batch.hpl.m().to_bits(), single.hpl.m().to_bits(), "epoch {epoch}");
            assert_eq!(batch.detail.p_unmonitored.to_bits(), single.detail.p_unmonitored.to_bits(), "epoch {epoch}");
        }
    }
}
