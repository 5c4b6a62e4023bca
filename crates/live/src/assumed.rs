//! The accuracy that a user states for a source that states none.

use crate::position::Position;
use navbound_core::frame::counts_as_zero;
use navbound_core::quantity::Metres;

/// Terms of a covariance: ee, en, nn, eu, nu, uu \[m²\].
type Terms = [f64; 6];

/// A standard deviation of each horizontal axis, stated by the user and not by the source.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Assumed(pub Metres);

/// What a source has stated of its accuracy itself.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Stated {
    /// The largest horizontal variance that it stated last \[m²\].
    pub(crate) largest_m2: Option<f64>,
    /// Whether a statement came since that no position took.
    pub(crate) lost: bool,
}

impl Assumed {
    /// The position with an accuracy that is no smaller than the one that is assumed, nor than what its source states, or stated last: an
    /// assumption completes a source and does not overrule a larger number of it. Nor one that was lost: it stands in for nothing then.
    #[must_use]
    pub(crate) fn completed(self, position: &Position, stated: &mut Stated) -> Position {
        let least_m2 = self.0.m() * self.0.m();
        let Some(terms) = position.covariance_m2 else {
            let variance_m2 = stated.largest_m2.map_or(least_m2, |stated| stated.max(least_m2));
            return Position { covariance_m2: (!stated.lost).then(|| circle(variance_m2)), ..*position };
        };
        // What is no covariance stays for the judge to refuse: the source contradicts itself, and nothing stands in for that.
        let Some([smallest, largest]) = horizontal(terms) else { return *position };
        *stated = Stated { largest_m2: Some(largest), lost: false };
        let covariance_m2 = if smallest >= least_m2 { terms } else { circle(largest.max(least_m2)) };
        Position { covariance_m2: Some(covariance_m2), ..*position }
    }
}

/// The same in every direction of the plane; nothing is known upwards.
pub(crate) fn circle(variance_m2: f64) -> Terms {
    [variance_m2, 0.0, variance_m2, f64::NAN, f64::NAN, f64::NAN]
}

/// The smallest and the largest horizontal variance of any direction; `None` where the terms are no covariance.
pub(crate) fn horizontal([ee, en, nn, .., uu]: Terms) -> Option<[f64; 2]> {
    let (middle, half) = (0.5 * (ee + nn), f64::hypot(0.5 * (ee - nn), en));
    let [smallest, largest] = [middle - half, middle + half];
    let vertical = uu.is_nan() || (uu > 0.0 && !counts_as_zero(uu));
    (largest.is_finite() && smallest >= 0.0 && [ee, nn].into_iter().all(|v| v > 0.0 && !counts_as_zero(v)) && vertical)
        .then_some([smallest, largest])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::position::TrackId;
    use navbound_core::quantity::GpsTime;

    fn completed(covariance_m2: Option<Terms>, stated: &mut Stated) -> Terms {
        let position = Position { covariance_m2, ..Position::new(TrackId::new("a").unwrap(), GpsTime::from_nanoseconds(0)) };
        Assumed(Metres::new(5.0)).completed(&position, stated).covariance_m2.unwrap_or([f64::NAN; 6])
    }

    fn plane(terms: Terms) -> [f64; 3] {
        let [ee, en, nn, ..] = terms;
        [ee, en, nn]
    }

    #[test]
    fn the_larger_of_what_is_assumed_and_what_is_stated_counts() {
        let mut stated = Stated::default();
        assert_eq!(plane(completed(None, &mut stated)), [25.0, 0.0, 25.0]);
        assert_eq!(plane(completed(Some(circle(1.0)), &mut stated)), [25.0, 0.0, 25.0]);
        let larger = [100.0, 20.0, 400.0, 0.0, 0.0, 900.0];
        assert_eq!(completed(Some(larger), &mut stated), larger);
        // A thin ellipse, longer than the circle and thinner: the circle around both.
        let [ee, en, nn] = plane(completed(Some([4.0, 0.0, 400.0, 0.0, 0.0, 900.0]), &mut stated));
        assert_eq!([ee, en, nn], [400.0, 0.0, 400.0]);
    }

    #[test]
    fn a_source_that_states_no_more_is_no_better_than_its_last_statement() {
        let mut stated = Stated::default();
        let _ = completed(Some(circle(10_000.0)), &mut stated);
        assert_eq!(plane(completed(None, &mut stated)), [10_000.0, 0.0, 10_000.0]);
        let _ = completed(Some(circle(1.0)), &mut stated);
        assert_eq!(plane(completed(None, &mut stated)), [25.0, 0.0, 25.0]);
    }

    #[test]
    fn nothing_stands_in_for_a_statement_that_no_position_took() {
        let mut stated = Stated { largest_m2: Some(1.0), lost: true };
        assert!(completed(None, &mut stated)[0].is_nan());
        assert_eq!(plane(completed(Some(circle(900.0)), &mut stated)), [900.0, 0.0, 900.0]);
        assert_eq!(plane(completed(None, &mut stated)), [900.0, 0.0, 900.0]);
    }

    #[test]
    fn what_is_no_covariance_is_left_to_be_refused() {
        for terms in [[f64::NAN; 6], circle(0.0), circle(-1.0), [1.0, 2.0, 1.0, 0.0, 0.0, 1.0], [900.0, 0.0, 900.0, 0.0, 0.0, -1.0]] {
            assert_eq!(completed(Some(terms), &mut Stated::default()).map(f64::to_bits), terms.map(f64::to_bits));
        }
    }
}
