//! Carrier smoothing of a real receiver's seven hours against the output of an independent program. Skipped, aloud, without the files.
#![allow(clippy::unwrap_used, clippy::print_stderr, reason = "a test may stop at the first surprise, and a skipped one says so")]

use navbound_assess::smoothing::{Form, smooth};
use navbound_core::quantity::Metres;
use navbound_core::signal::smoothing::{Smoothing, divergence_free};
use navbound_core::signal::{Carrier, Constellation};
use navbound_formats::rinex::{Observations, read_observations};
use std::path::PathBuf;

fn file(name: &str) -> Option<Vec<u8>> {
    let folder = std::env::var_os("NAVBOUND_DATA")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"), PathBuf::from);
    let bytes = std::fs::read(folder.join("gnss/UPC3_2008_351_smoothing").join(name)).ok();
    if bytes.is_none() {
        eprintln!("SKIPPED: {name} is not below {}", folder.display());
    }
    bytes
}

/// Epochs before the satellite sinks and its phases begin to fail; there the programs' rules for slips differ.
const UNBROKEN: usize = 24_800;

/// The second column of the reference: smoothed C1 less the divergence-free phase, less a constant.
fn reference(name: &str) -> Option<Vec<f64>> {
    let text = String::from_utf8(file(name)?).unwrap();
    Some(text.lines().map(|l| l.split_whitespace().nth(1).unwrap().parse().unwrap()).collect())
}

/// Differences to the reference less their mean, and the difference of the two phases less its own.
fn differences(o: &Observations, form: Form, reference: &[f64]) -> Vec<(f64, f64)> {
    let gps = Constellation::Gps;
    let column = |code: &[u8; 3]| o.column(gps, code).unwrap();
    let mut codes: [Vec<usize>; Constellation::ALL.len()] = Default::default();
    codes[gps.index()] = vec![column(b"C1C")];
    let smoothed = smooth(o, &codes, form, &Smoothing::over(60.0));
    let (c1, l1, l2) = (column(b"C1C"), column(b"L1C"), column(b"L2W"));
    let at = |k: usize| {
        let metres = |column: usize, carrier: Carrier| Metres::new(o.values(k)[column] * carrier.wavelength_m());
        let (one, two) = (metres(l1, Carrier::L1), metres(l2, Carrier::L2));
        let phase = divergence_free((Carrier::L1, one), (Carrier::L2, two));
        (smoothed.values(o, k)[c1] - phase.m() - reference[k], one.m() - two.m())
    };
    let pairs: Vec<(f64, f64)> = (0..UNBROKEN).map(at).collect();
    let mean = |f: fn(&(f64, f64)) -> f64| pairs.iter().map(f).sum::<f64>() / pairs.len() as f64;
    let (apart, ionosphere) = (mean(|p| p.0), mean(|p| p.1));
    pairs.iter().map(|p| (p.0 - apart, p.1 - ionosphere)).collect()
}

/// Largest difference, the factor with which it follows the ionosphere, and the largest without that part.
fn judged(pairs: &[(f64, f64)]) -> (f64, f64, f64) {
    let factor = pairs.iter().map(|p| p.0 * p.1).sum::<f64>() / pairs.iter().map(|p| p.1 * p.1).sum::<f64>();
    let largest = |f: &dyn Fn(&(f64, f64)) -> f64| pairs.iter().map(|p| f(p).abs()).fold(0.0, f64::max);
    (largest(&|p| p.0), factor, largest(&|p| p.0 - factor * p.1))
}

#[test]
fn sixty_seconds_of_smoothing_agree_with_the_independent_program() {
    let (Some(bytes), Some(hatch), Some(free)) = (file("UPC33510.08O_trunc"), reference("upc3.C1S_60"), reference("upc3.C1DFreeS_60"))
    else {
        return;
    };
    let o = read_observations(&bytes).unwrap();
    assert_eq!((o.n_epochs(), hatch.len(), free.len()), (25_025, 25_025, 25_025));
    for (form, reference, name) in [(Form::Single, &hatch, "Hatch"), (Form::DivergenceFree, &free, "divergence-free")] {
        let (largest, factor, rest) = judged(&differences(&o, form, reference));
        eprintln!("{name}: largest difference {largest:.5} m, {factor:.2e} of the phases' difference, {rest:.5} m without that");
        // The phases carry 1e-3 cycle, which the combination multiplies by about 4: a millimetre. The reference's factor of the two
        // phases, 2 / (f1^2/f2^2 - 1) = 3.0915, is another in its fourth digit (inferred from the differences): 2 mm more.
        assert!(largest < 3.5e-3 && factor.abs() < 2e-3, "{name}: largest {largest} m, factor {factor}");
        assert!(rest < 0.6e-3, "{name}: {rest} m");
    }
    // And the two forms differ by more than that, or the comparison would say nothing.
    assert!(judged(&differences(&o, Form::Single, &free)).2 > 0.01);
}
