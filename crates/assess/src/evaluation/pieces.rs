//! The same evaluations of epochs that come in pieces, in order: what is kept is one number an epoch, and the bits are those of the whole.

use super::consistency::{Consistency, Errors, Pit, Refused, nees_of, pit_of};
use super::correlation::{effective_size_about_zero, effective_size_of_series};
use super::refutation::{MOST_SQUARE, Magnitude, magnitude_of};
use super::{BoundScore, BoundSums, require_bounds, same_length, track_length};
use navbound_core::quantity::{OutOfDomain, Risk};

/// One number an epoch, by track. Epochs of a track come in order, those of different tracks in any.
#[derive(Debug, Clone, Default)]
pub struct Series(Vec<Vec<f64>>);

impl Series {
    fn add(&mut self, track: u32, value: f64) {
        let of = track as usize;
        if self.0.len() <= of {
            self.0.resize_with(of + 1, Vec::new);
        }
        self.0[of].push(value);
    }

    /// The next numbers with their tracks; NaN is no epoch.
    ///
    /// # Errors
    /// [`OutOfDomain`] for a track column of another length.
    pub fn see(&mut self, values: &[f64], track: &[u32]) -> Result<(), Refused> {
        track_length(track, values.len())?;
        for (row, value) in values.iter().enumerate().filter(|(_, value)| !value.is_nan()) {
            self.add(track.get(row).copied().unwrap_or(0), *value);
        }
        Ok(())
    }

    /// The series of tracks with an epoch; what was seen is given away.
    fn take(&mut self) -> Vec<Vec<f64>> {
        let mut series = std::mem::take(&mut self.0);
        series.retain(|s| !s.is_empty());
        series
    }

    /// Epochs that the mean is worth, of what was seen, which is given away: see [`super::effective_size`].
    pub fn effective_size(&mut self, about_zero: bool) -> f64 {
        let series = self.take();
        if about_zero { effective_size_about_zero(series) } else { effective_size_of_series(series) }
    }
}

/// [`super::bound`] of pieces, but for the median.
#[derive(Debug, Clone, Default)]
pub struct Bounds {
    sums: BoundSums,
    errors: Series,
}

impl Bounds {
    /// The next epochs.
    ///
    /// # Errors
    /// As [`super::bound`].
    pub fn see(&mut self, error_m: &[f64], bound_m: &[f64], track: &[u32]) -> Result<(), Refused> {
        same_length("bound_m", bound_m.len(), error_m.len())?;
        track_length(track, error_m.len())?;
        require_bounds(bound_m)?;
        for (row, (error, bound)) in error_m.iter().zip(bound_m).enumerate() {
            self.sums.add(*error, *bound);
            if !(error.is_nan() || bound.is_nan()) {
                self.errors.add(track.get(row).copied().unwrap_or(0), *error);
            }
        }
        Ok(())
    }

    /// How the bound did, with NaN for its median; what was seen is given away.
    pub fn score(&mut self, risk: Risk) -> BoundScore {
        let sums = std::mem::take(&mut self.sums);
        sums.score(risk, self.errors.effective_size(false), f64::NAN)
    }
}

/// Normalised squares of pieces.
#[derive(Debug, Clone, Default)]
pub struct Squares {
    squares: Series,
    n_unusable: usize,
    dimension: usize,
}

impl Squares {
    /// The next epochs, all of one dimension.
    ///
    /// # Errors
    /// As [`super::nees`].
    pub fn see(&mut self, errors: &Errors<'_>) -> Result<(), Refused> {
        errors.check()?;
        self.dimension = errors.dimension;
        let squares = errors.squares();
        self.n_unusable += squares.iter().filter(|s| s.is_nan()).count();
        self.squares.see(&squares, errors.track)
    }

    /// [`super::nees`] of what was seen, which is given away.
    pub fn nees(&mut self) -> Consistency {
        nees_of(self.squares.take(), std::mem::take(&mut self.n_unusable), self.dimension)
    }

    /// [`super::pit`] of what was seen, which is given away.
    ///
    /// # Errors
    /// [`OutOfDomain`] unless there are 2 to 1000 bins.
    pub fn pit(&mut self, n_bins: usize) -> Result<Pit, Refused> {
        pit_of(self.squares.take(), self.dimension, n_bins)
    }
}

/// [`super::magnitude`] of pieces, of which one axis at a time is kept.
#[derive(Debug, Clone, Default)]
pub struct Sizes {
    axis: usize,
    scaled: Series,
    n: usize,
    sum: f64,
}

impl Sizes {
    /// Of which axis the effective size is requested.
    ///
    /// # Errors
    /// [`OutOfDomain`] for another axis than 0 (east) and 1 (north).
    pub fn new(axis: usize) -> Result<Self, Refused> {
        if axis > 1 {
            return Err((None, OutOfDomain { argument: "axis", value: axis as f64, unit: "1", domain: "{0, 1}" }));
        }
        Ok(Self { axis, ..Self::default() })
    }

    /// The next epochs, of two components.
    ///
    /// # Errors
    /// As [`super::magnitude`].
    pub fn see(&mut self, errors: &Errors<'_>) -> Result<(), Refused> {
        errors.check_horizontal()?;
        for (row, square) in errors.squares().into_iter().enumerate().filter(|(_, square)| !square.is_nan()) {
            self.n += 1;
            self.sum += square.min(MOST_SQUARE);
            self.scaled.add(errors.track.get(row).copied().unwrap_or(0), errors.component(row, self.axis));
        }
        Ok(())
    }

    /// Magnitude of what was seen, which is given away; its effective size is that of the one axis.
    pub fn magnitude(&mut self) -> Magnitude {
        magnitude_of(std::mem::take(&mut self.n), std::mem::take(&mut self.sum), self.scaled.effective_size(true))
    }
}

#[cfg(test)]
mod tests {
    use super::super::{bound, effective_size_of, magnitude, nees, pit};
    use super::*;

    /// Errors, bounds and tracks of 900 epochs from a linear congruential generator, some of them missing.
    fn epochs() -> (Vec<f64>, Vec<f64>, Vec<u32>) {
        let mut seed = 20_261_126_u64;
        let mut uniform = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1_u64 << 53) as f64
        };
        let mut slow = 0.0;
        let errors = (0..900).map(|k| {
            slow = 0.9 * slow + uniform() - 0.4;
            if k % 17 == 3 { f64::NAN } else { slow }
        });
        let errors = errors.collect();
        let bounds = (0..900).map(|k| if k % 23 == 5 { f64::NAN } else { 1.0 + uniform() }).collect();
        (errors, bounds, (0..900).map(|k| if k < 250 { 0 } else { 1 + k / 300 }).collect())
    }

    #[test]
    fn pieces_of_any_length_give_the_bits_of_the_whole() {
        let (errors, bounds, tracks) = epochs();
        let risk = Risk::new(0.05).unwrap();
        let whole = bound(&errors, &bounds, risk, &tracks).unwrap();
        let plane: Vec<f64> = errors.iter().flat_map(|e| [*e, 0.5 - e]).collect();
        let covariance: Vec<f64> = bounds.iter().flat_map(|b| [*b, 0.1, 0.1, 2.0 * b]).collect();
        let of = |from: usize, to: usize| Errors {
            dimension: 2,
            error_m: &plane[2 * from..2 * to],
            covariance_m2: &covariance[4 * from..4 * to],
            track: &tracks[from..to],
        };
        let (all_nees, all_pit, all_size) = (nees(&of(0, 900)).unwrap(), pit(&of(0, 900), 20).unwrap(), magnitude(&of(0, 900)).unwrap());
        for length in [1, 7, 300, 900] {
            let (mut scores, mut series, mut squares, mut again) =
                (Bounds::default(), Series::default(), Squares::default(), Squares::default());
            let mut sizes = [Sizes::new(0).unwrap(), Sizes::new(1).unwrap()];
            for from in (0..900).step_by(length) {
                let to = (from + length).min(900);
                scores.see(&errors[from..to], &bounds[from..to], &tracks[from..to]).unwrap();
                series.see(&errors[from..to], &tracks[from..to]).unwrap();
                squares.see(&of(from, to)).unwrap();
                again.see(&of(from, to)).unwrap();
                sizes.iter_mut().for_each(|axis| axis.see(&of(from, to)).unwrap());
            }
            let score = scores.score(risk);
            assert_eq!(BoundScore { median_m: whole.median_m, ..score }, whole);
            assert!(score.n > 700 && score.n_outside > 0 && score.n_without_bound > 0);
            assert_eq!(series.effective_size(true), effective_size_of(&errors, &tracks, true).unwrap());
            assert_eq!(squares.nees(), all_nees);
            assert_eq!(again.pit(20).unwrap(), all_pit);
            let [east, north] = sizes.map(|mut axis| axis.magnitude());
            assert_eq!(Magnitude { n_effective: east.n_effective.min(north.n_effective), ..east }, all_size);
        }
    }

    #[test]
    fn what_cannot_be_is_refused() {
        assert!(Sizes::new(2).is_err());
        assert!(Bounds::default().see(&[1.0], &[-1.0], &[]).is_err());
        assert!(Bounds::default().see(&[1.0], &[1.0, 2.0], &[]).is_err());
        assert!(Series::default().see(&[1.0], &[0, 0]).is_err());
        assert!(Squares::default().pit(1).is_err());
        let upright = Errors { dimension: 3, error_m: &[1.0; 3], covariance_m2: &[1.0; 9], track: &[] };
        assert!(Sizes::new(0).unwrap().see(&upright).is_err());
    }
}
