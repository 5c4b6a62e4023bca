//! What is compared with twice RNP: the larger of a method's bound and what faults leave.

use super::{AlertBound, Bounded};
use crate::quantity::Metres;

/// The comparison for integrity of one aircraft, epoch by epoch.
///
/// ```text
/// total system error across the path     max(bound, |FTE| + HPL)
/// navigation error in the horizontal     max(bound, HPL)
/// any other error                        bound
/// ```
///
/// The bound is fault-free: it holds while the covariance describes the error. The horizontal protection level covers the faults of its
/// own algorithm and bounds the navigation error in every horizontal direction, so also across the path.
///
/// # A level that is missing
/// Where levels are expected, an epoch without one has no integrity bound: NaN, which is within no limit. Otherwise the loss of a level
/// would make the comparison better than it was. Levels are expected from the first epoch that has one; a caller who knows that the
/// source computes levels says so before. None is due at an epoch that is degraded: its status says that nothing vouches for it beyond its
/// covariance, as on DME alone after satellites are lost, and the bound by the covariance is what there is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct IntegrityComparison {
    level_expected: bool,
}

impl IntegrityComparison {
    /// A comparison whose every epoch should have a level.
    pub const fn with_levels() -> Self {
        Self { level_expected: true }
    }

    /// The source states levels, so every epoch from now on should have one: also one whose level is not a number.
    pub const fn expect_levels(&mut self) {
        self.level_expected = true;
    }

    /// Whether an epoch should have a level.
    pub const fn level_expected(&self) -> bool {
        self.level_expected
    }

    /// The integrity bound of one epoch. `fte` and `level` are NaN where they are not known; a level that is negative is not known. `due`:
    /// the epoch is one that should have a level, where its track has any.
    pub fn bound(&mut self, bound: AlertBound, fte: Metres, level: Metres, due: bool) -> AlertBound {
        let level_m = level.m();
        self.level_expected |= !level_m.is_nan();
        if !self.level_expected || (level_m.is_nan() && !due) {
            return bound;
        }
        let with_faults_m = match bound.method().bounds {
            Bounded::LateralTse => fte.m().abs() + level_m,
            Bounded::HorizontalNse | Bounded::CrossNse | Bounded::AlongNse | Bounded::EastNse | Bounded::NorthNse => level_m,
            Bounded::VerticalTse | Bounded::VerticalNse | Bounded::SpatialNse => return bound,
        };
        bound.with_length(Metres::new(larger_m(bound.length().m(), with_faults_m, level_m)))
    }
}

/// The larger of two lengths; NaN when either is, or when the level is no length. `f64::max` would pass over a NaN.
fn larger_m(bound_m: f64, with_faults_m: f64, level_m: f64) -> f64 {
    if !(level_m >= 0.0) || bound_m.is_nan() || with_faults_m.is_nan() {
        return f64::NAN;
    }
    bound_m.max(with_faults_m)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bound::Alerting;

    const UNKNOWN: Metres = Metres::new(f64::NAN);

    fn alert_bound(id: &str, length_m: f64) -> AlertBound {
        Alerting::of(id).unwrap().claim_evaluated(Metres::new(length_m))
    }

    /// Length of the comparison of one epoch, levels expected.
    fn compared_m(id: &str, bound_m: f64, fte_m: f64, level_m: f64) -> f64 {
        let mut comparison = IntegrityComparison::with_levels();
        comparison.bound(alert_bound(id, bound_m), Metres::new(fte_m), Metres::new(level_m), true).length().m()
    }

    #[test]
    fn the_larger_of_bound_and_deviation_with_level_is_compared() {
        assert_eq!(compared_m("tse-exact", 50.0, -30.0, 40.0), 70.0);
        assert_eq!(compared_m("tse-exact", 80.0, 30.0, 40.0), 80.0);
        assert_eq!(compared_m("tse-exact", 80.0, 0.0, f64::INFINITY), f64::INFINITY);
    }

    #[test]
    fn without_a_path_the_level_alone_is_compared() {
        assert_eq!(compared_m("anp-circle", 50.0, f64::NAN, 60.0), 60.0);
        assert_eq!(compared_m("tse-vertical", 50.0, 5.0, 60.0), 50.0, "a horizontal level says nothing of height");
    }

    #[test]
    fn what_is_not_known_is_no_bound() {
        for (bound_m, fte_m, level_m) in [(f64::NAN, 1.0, 2.0), (1.0, f64::NAN, 2.0), (1.0, 1.0, f64::NAN), (1.0, 1.0, -2.0)] {
            assert!(compared_m("tse-exact", bound_m, fte_m, level_m).is_nan(), "{bound_m} {fte_m} {level_m}");
        }
    }

    #[test]
    fn a_level_that_goes_missing_never_makes_the_comparison_better() {
        let mut comparison = IntegrityComparison::default();
        let mut at = |level: Metres| comparison.bound(alert_bound("tse-exact", 50.0), Metres::new(10.0), level, true).length().m();
        assert_eq!(at(UNKNOWN), 50.0, "no level so far");
        assert_eq!(at(Metres::new(900.0)), 910.0);
        assert!(at(UNKNOWN).is_nan());
    }

    #[test]
    fn a_source_that_states_levels_owes_one_from_the_first_epoch_on() {
        let mut comparison = IntegrityComparison::default();
        comparison.expect_levels();
        assert!(comparison.bound(alert_bound("tse-exact", 50.0), Metres::new(10.0), UNKNOWN, true).length().m().is_nan());
    }

    #[test]
    fn none_is_due_where_the_status_says_that_nothing_vouches_for_the_epoch() {
        let mut comparison = IntegrityComparison::with_levels();
        let mut at =
            |level_m: f64| comparison.bound(alert_bound("tse-exact", 50.0), Metres::new(10.0), Metres::new(level_m), false).length().m();
        assert_eq!((at(f64::NAN), at(900.0)), (50.0, 910.0));
    }
}
