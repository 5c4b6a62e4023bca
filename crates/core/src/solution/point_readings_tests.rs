//! Few ranges: exclusions that nothing confirms, and clocks that are known from each other.

use super::*;
use crate::solution::declared::{Declarations, Doubt};

fn readings(ranges: &[Range], offsets: &Offsets) -> (Fix, Option<Mixture>) {
    solve_readings(ranges, GpsTime::default(), &settings(), None, offsets, |_| ()).unwrap()
}

/// Between high buildings: six ranges, one of them reflected. After its exclusion one is to spare, and the test passes whatever was
/// excluded.
#[test]
fn an_exclusion_that_one_spare_range_cannot_confirm_is_degraded_and_holds_the_error() {
    let mut wrong = 0;
    for (k, from) in (0..6).flat_map(|k| (0..3).map(move |from| (k, from))) {
        for fault in [12.0, 18.0, 40.0, 150.0] {
            let mut ranges: Vec<Range> = full_sky().into_iter().skip(from).take(6).collect();
            for (j, range) in ranges.iter_mut().enumerate() {
                // Noise of up to 1.5 m, less than two standard deviations of any range.
                let noise = 1.5 * (5.0 * j as f64 + fault).sin();
                range.corrected = Metres::new(range.corrected.m() + noise + if j == k { fault } else { 0.0 });
            }
            let (mut fix, mixture) = readings(&ranges, &Offsets::default());
            let error = error(&fix);
            wrong += usize::from(fix.consistent && fix.n_excluded == 1 && fix.excluded[0] != Some(ranges[k].satellite));
            let doubt = Declarations::default().declare(GpsTime::default(), &mut fix, mixture.as_ref(), None);
            let normalised = error.dot(&(fix.covariance.matrix().try_inverse().unwrap() * error));
            // The 1e-5 quantile of chi-square with three degrees of freedom is 25.9 (tables).
            assert!(normalised < 25.9, "{k} {fault}: {error:?} {normalised}");
            if fix.n_excluded == 1 && fix.consistent {
                assert_eq!(doubt, Some(Doubt::ExclusionUnconfirmed), "{k} {fault}");
            }
        }
    }
    // The case is there: wrong exclusions after which the residuals agree.
    assert!(wrong > 0);
}

#[test]
fn a_full_sky_that_agrees_has_one_reading() {
    let (fix, mixture) = readings(&full_sky(), &Offsets::default());
    assert_eq!(mixture, None);
    assert_eq!((fix.spare, fix.redundancy), (fix.n_used - 4, fix.n_used - 4));
}

/// Four to spare check two faults badly: they can agree by chance. The more are to spare, the smaller the risk of the residuals must be for it.
#[test]
fn ranges_that_agree_are_read_in_every_way_while_few_are_to_spare() {
    for (n, read) in [(7, true), (8, true), (9, false)] {
        let ranges: Vec<Range> = full_sky().into_iter().take(n).collect();
        let (fix, mixture) = readings(&ranges, &Offsets::default());
        assert_eq!((fix.spare, fix.consistent), (n - 4, true));
        assert_eq!(mixture.is_some(), read, "{n}: risk {}", fix.residual_risk);
    }
}

/// The last `n` ranges counted as Galileo's, whose clock stands `offset` from that of GPS.
fn two_systems(n: usize, offset: f64) -> Vec<Range> {
    let mut ranges = full_sky();
    let from = ranges.len() - n;
    for range in &mut ranges[from..] {
        range.satellite.constellation = Constellation::Galileo;
        range.corrected = Metres::new(range.corrected.m() + offset);
    }
    ranges
}

#[test]
fn ranges_of_a_constellation_that_check_only_its_clock_are_not_to_spare() {
    for (n, spare) in [(1, -5), (2, -6), (3, -5)] {
        let ranges = two_systems(n, 440.0);
        let (fix, _) = readings(&ranges, &Offsets::default());
        // GPS alone has four unknowns; three of Galileo give two spare ranges more.
        let expected = ranges.len().checked_add_signed(spare).unwrap();
        assert_eq!(fix.spare, expected, "{n}");
        assert_eq!(fix.redundancy, ranges.len() - 5);
        assert!((fix.clock_m[2] - fix.clock_m[0] - 440.0).abs() < 0.03);
    }
}

#[test]
fn a_known_offset_takes_the_place_of_a_clock_and_its_error_is_declared() {
    let known = |offset_m, sigma_m| Some(Offset { offset_m, sigma_m });
    let offsets = |sigma| Offsets { of: [known(0.0, 0.0), None, known(440.0, sigma), None, None] };
    // Three of GPS and two of Galileo: five unknowns with two clocks, four with one.
    let all = two_systems(2, 440.0);
    let some: Vec<Range> = all[..2].iter().chain(&all[all.len() - 2..]).copied().collect();
    assert!(solve(&some, GpsTime::default(), &settings()).is_err());
    let traces: Vec<f64> = [0.3, 3.0]
        .into_iter()
        .map(|sigma| {
            let (fix, _) = solve_readings(&some, GpsTime::default(), &settings(), None, &offsets(sigma), |_| ()).unwrap();
            assert!(error(&fix).norm() < 0.1, "{:?}", error(&fix));
            assert!((fix.clock_m[2] - fix.clock_m[0] - 440.0).abs() < 1e-9);
            fix.covariance.matrix().trace()
        })
        .collect();
    assert!(traces[1] > 2.0 * traces[0], "{traces:?}");
}
