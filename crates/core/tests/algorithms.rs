//! Every algorithm of protection levels from satellites keeps the family's promises, and one more needs nothing but its own lines.
#![allow(clippy::unwrap_used, clippy::panic)] // A test may stop at the first surprise, in its helpers too.

use crate::common::sky::SKY;
use nalgebra::Vector3;
use navbound_core::bound::{ALGORITHMS, Algorithm, Levels, NoLevels, Protection, Provenance, Ranges, Sight, Task, with_algorithm};
use navbound_core::quantity::{Metres, Unavailable};
use navbound_core::signal::Constellation;

/// The sky turned by an angle, with all lengths times a factor.
fn sky(turned_deg: f64, factor: f64) -> Vec<Sight> {
    let sight = |&(az, el, sigma): &(f64, f64, f64)| {
        let (az, el) = (f64::to_radians(az + turned_deg), f64::to_radians(el));
        let unit = Vector3::new(el.cos() * az.sin(), el.cos() * az.cos(), el.sin());
        let sigma = sigma * factor;
        let plain = Sight::plain(unit, Constellation::Gps, sigma * sigma);
        Sight { receiver_faulty_m2: 1.5 * sigma * sigma, p_sat: 1e-5, ..plain }
    };
    SKY.iter().map(sight).collect()
}

/// Levels by the usual settings, and every number beside them.
struct Ask<'a>(&'a [Sight]);

impl Task for Ask<'_> {
    type Output = Result<(Levels, Vec<f64>), NoLevels>;
    fn with<A: Algorithm>(self) -> Self::Output {
        let Levels { hpl, vpl, detail } = A::new(&A::usual()).levels(self.0)?;
        Ok((Levels { hpl, vpl, detail: () }, (0..A::COLUMNS.len()).map(|k| A::number(&detail, k)).collect()))
    }
}

/// Ids of the algorithms that take satellites.
fn ids() -> Vec<&'static str> {
    let ids: Vec<_> = ALGORITHMS.iter().filter(|e| e.columns.is_some()).map(|e| e.protection.id).collect();
    assert!(ids.len() >= 5, "{ids:?}");
    ids
}

fn ask(id: &str, sights: &[Sight]) -> (Levels, Vec<f64>) {
    with_algorithm(id, Ask(sights)).unwrap().unwrap_or_else(|e| panic!("{id}: {e}"))
}

/// Rounding of a geometry of condition below 1e3, and of the roots of the level equation (1e-9 of a level).
const ROUNDING: f64 = 1e-8;

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= ROUNDING * b.abs()
}

#[test]
fn an_id_names_one_algorithm_and_those_without_satellites_none() {
    for (k, entry) in ALGORITHMS.iter().enumerate() {
        assert!(ALGORITHMS[..k].iter().all(|other| other.protection.id != entry.protection.id), "{}", entry.protection.id);
        assert_eq!(with_algorithm(entry.protection.id, Ask(&sky(0.0, 1.0))).is_some(), entry.columns.is_some());
    }
    assert!(with_algorithm("toy", Ask(&[])).is_none());
}

#[test]
fn a_good_sky_has_levels_and_every_column_a_number() {
    for id in ids() {
        let (levels, numbers) = ask(id, &sky(0.0, 1.0));
        assert!(levels.finite() && levels.hpl.m() > 1.0, "{id}: {levels:?}");
        assert!(numbers.iter().all(|x| x.is_finite()), "{id}: {numbers:?}");
    }
}

#[test]
fn levels_scale_with_the_sigmas() {
    for id in ids() {
        let ((one, _), (three, _)) = (ask(id, &sky(0.0, 1.0)), ask(id, &sky(0.0, 3.0)));
        assert!(close(three.hpl.m(), 3.0 * one.hpl.m()), "{id}");
        assert_eq!(one.vpl.is_some(), three.vpl.is_some());
        assert!(one.vpl.is_none() || close(three.vpl_m(), 3.0 * one.vpl_m()), "{id}");
    }
}

/// The horizontal level of ARAIM is made of two axes, so it turns with north by what the axes do; a quarter turn swaps them.
#[test]
fn levels_ignore_which_axis_is_north() {
    for id in ids() {
        let ((one, _), (turned, _)) = (ask(id, &sky(0.0, 1.0)), ask(id, &sky(90.0, 1.0)));
        assert!(close(turned.hpl.m(), one.hpl.m()) && (one.vpl.is_none() || close(turned.vpl_m(), one.vpl_m())), "{id}");
    }
}

#[test]
fn the_order_of_satellites_does_not_matter() {
    let mut reversed = sky(0.0, 1.0);
    reversed.reverse();
    for id in ids() {
        assert!(close(ask(id, &reversed).0.hpl.m(), ask(id, &sky(0.0, 1.0)).0.hpl.m()), "{id}");
    }
}

#[test]
fn three_satellites_are_too_few_for_each_and_none_are_too() {
    for id in ids() {
        for n in [0, 3] {
            let refused = with_algorithm(id, Ask(&sky(0.0, 1.0)[..n])).unwrap().unwrap_err();
            assert_eq!(refused, NoLevels::Geometry(Unavailable::TooFewSatellites { need: 4, have: n }), "{id}");
        }
    }
}

/// A level is the number of satellites in metres.
struct Toy;

impl Algorithm for Toy {
    const PROTECTION: Protection = Protection {
        id: "toy",
        title: "Toy level",
        function: "navbound.toy.protection_levels",
        source: "this test",
        provenance: Provenance::Ours,
        covers: "no fault",
        assumes: "nothing",
        integrity: false,
    };
    const RANGES: Ranges = Ranges::Receiver;
    const COLUMNS: &'static [&'static str] = &["n_gps"];
    type Settings = f64;
    type Detail = usize;
    fn usual() -> f64 {
        1.0
    }
    fn new(_: &f64) -> Self {
        Self
    }
    fn levels(&mut self, sights: &[Sight]) -> Result<Levels<usize>, NoLevels> {
        Ok(Levels::horizontal(Metres::new(sights.len() as f64), sights.len()))
    }
    fn number(n: &usize, _: usize) -> f64 {
        *n as f64
    }
}

#[test]
fn an_algorithm_of_ones_own_is_called_as_any_other() {
    let (levels, numbers) = Ask(&sky(0.0, 1.0)).with::<Toy>().unwrap();
    assert_eq!((levels.hpl.m(), levels.vpl, numbers), (9.0, None, vec![9.0]));
}
