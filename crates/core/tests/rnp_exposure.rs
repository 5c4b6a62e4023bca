//! What a risk per epoch means over an hour, and the table of specifications.

use navbound_core::monitor::exposure::HourlyExposure;
use navbound_core::quantity::{Metres, Risk};
use navbound_core::spec::{Phase, SPECIFICATIONS, specification};
use navbound_core::special::tail;

/// Section 9.4 of the specification, continuous monitoring: correlation time \[s\], risk in an hour of a risk of 1e-5 per epoch, and risk
/// per epoch for 1e-5 in an hour. Two digits are printed, so half a unit of the second is allowed: 2.5 % of 2.1, 1.6 % of 3.2.
#[test]
fn a_risk_per_epoch_is_not_a_risk_per_hour() {
    let table = [(1.0, 0.52, 6.4e-11), (10.0, 7.1e-2, 7.1e-10), (60.0, 1.2e-2, 4.7e-9), (360.0, 2.1e-3, 3.2e-8), (3600.0, 2.1e-4, 3.6e-7)];
    for (tau, hourly, epoch) in table {
        let exposure = HourlyExposure::new(tau, 0.0).unwrap();
        let risk = exposure.per_hour(Risk::INTEGRITY);
        assert!((risk / hourly - 1.0).abs() <= 0.025, "tau {tau}: {risk}");
        let risk = exposure.per_epoch(Risk::new(1e-5).unwrap()).unwrap();
        assert!((risk.q() / epoch - 1.0).abs() <= 0.016, "tau {tau}: {}", risk.q());
        // The level is found to an ulp, and u^2 of about 40 multiplies it.
        let back = exposure.per_hour(risk);
        assert!((back / 1e-5 - 1.0).abs() <= 1e-12, "tau {tau}: {back}");
    }
}

/// Correlation time \[s\], level \[sigma\], risk in an hour sampled every second, by the transition kernel (`oracle/exposure.py`).
const EXACT_PER_HOUR: [(f64, f64, f64); 21] = [
    (1.0, 3.5, 8.0896e-01),
    (1.0, 4.417173413469022, 3.5296e-02),
    (1.0, 5.5, 1.3670e-04),
    (5.0, 3.5, 6.9876e-01),
    (5.0, 4.417173413469022, 2.9643e-02),
    (5.0, 5.5, 1.2588e-04),
    (10.0, 3.5, 5.7420e-01),
    (10.0, 4.417173413469022, 2.2941e-02),
    (10.0, 5.5, 1.0499e-04),
    (19.0, 3.5, 4.3405e-01),
    (19.0, 4.417173413469022, 1.6323e-02),
    (19.0, 5.5, 7.9507e-05),
    (20.0, 3.5, 4.2272e-01),
    (20.0, 4.417173413469022, 1.5826e-02),
    (20.0, 5.5, 7.7434e-05),
    (60.0, 3.5, 2.1103e-01),
    (60.0, 4.417173413469022, 7.3684e-03),
    (60.0, 5.5, 3.8930e-05),
    (360.0, 3.5, 4.8077e-02),
    (360.0, 4.417173413469022, 1.6215e-03),
    (360.0, 5.5, 9.1299e-06),
];

/// The crossing rate is an asymptote: 0.98 is what it misses at its worst in the table, 2.3 what independence costs just below 20 samples
/// a correlation time.
#[test]
fn the_risk_of_an_hour_is_never_short_of_the_exact_one() {
    for (tau, u, exact) in EXACT_PER_HOUR {
        let hourly = HourlyExposure::new(tau, 1.0).unwrap().per_hour(Risk::new(2.0 * tail(u)).unwrap());
        assert!(hourly >= 0.98 * exact && hourly <= 2.3 * exact, "tau {tau}, level {u}: {hourly} for {exact}");
    }
}

#[test]
fn exposures_outside_their_domain_are_refused() {
    for (tau, dt, argument) in
        [(0.0, 1.0, "tau_s"), (f64::NAN, 1.0, "tau_s"), (60.0, -1.0, "sample_period_s"), (60.0, f64::NAN, "sample_period_s")]
    {
        assert_eq!(HourlyExposure::new(tau, dt).unwrap_err().argument, argument);
    }
    assert_eq!(HourlyExposure::new(1e9, 0.0).unwrap().per_epoch(Risk::new(0.5).unwrap()).unwrap_err().argument, "risk_per_hour");
}

#[test]
fn every_row_of_the_table_has_its_source_and_a_sound_range() {
    for s in SPECIFICATIONS {
        assert!(s.accuracy_least.m() > 0.0 && s.accuracy_least <= s.accuracy_most, "{} {}", s.name, s.phase.word());
        assert!(!s.source.is_empty());
        let same = SPECIFICATIONS.iter().filter(|o| o.name == s.name && o.phase == s.phase).count();
        assert_eq!(same, 1, "{} {} twice", s.name, s.phase.word());
        assert_eq!(s.monitored, !s.name.starts_with("RNAV"));
    }
    let cell = specification("RNP AR APCH", Phase::Final).unwrap();
    assert_eq!((cell.accuracy_least, cell.accuracy_most), (Metres::nautical_miles(0.1), Metres::nautical_miles(0.3)));
    assert_eq!(cell.containment(Metres::new(100.0)), Some(Metres::new(200.0)));
    assert!(specification("RNP APCH", Phase::Departure).is_none());
}
