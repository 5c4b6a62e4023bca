//! How many independent epochs a correlated series is worth.

/// Lags summed at each time scale before the next, twice as coarse, takes over.
const LAGS: usize = 64;

/// Series of a column, one a track, epochs that `keep` rejects left out. Without tracks, one series.
pub(super) fn by_track(track: &[u32], n: usize, keep: impl Fn(usize) -> bool, value: impl Fn(usize) -> f64) -> Vec<Vec<f64>> {
    let n_tracks = track.iter().max().map_or(1, |t| *t as usize + 1);
    let mut series = vec![Vec::new(); n_tracks];
    for row in (0..n).filter(|row| keep(*row)) {
        let of = track.get(row).map_or(0, |t| *t as usize);
        series[of].push(value(row));
    }
    series.retain(|s| !s.is_empty());
    series
}

/// Effective sample size of the mean over series of one process, one series a track.
///
/// ```text
/// n_effective = n / (1 + 2 sum rho_k)      rho pooled over the tracks, about the common mean, in [1, n]
/// ```
///
/// The sum ends where two neighbouring correlations together are not positive (Geyer 1992). Lags beyond 64 are summed on means of 2, 4,
/// 8, ... epochs, so that a day of slow error costs no more than a minute of noise. About the common mean: a bias that differs from
/// track to track is correlation, and one that never changes leaves a track worth one epoch.
///
/// Of the error itself, not of its exceedances: for a Gaussian error no function of an epoch is more correlated than the epoch
/// (Gebelein 1941), so the size is never too large for a coverage, and it does not depend on how few exceedances there were.
pub fn effective_size(series: &[Vec<f64>]) -> f64 {
    effective_size_of_series(series.to_vec())
}

/// The same of series that are given away: nothing is copied.
pub(super) fn effective_size_of_series(mut series: Vec<Vec<f64>>) -> f64 {
    let n: usize = series.iter().map(Vec::len).sum();
    let mean = series.iter().flatten().sum::<f64>() / n as f64;
    series.iter_mut().flatten().for_each(|x| *x -= mean);
    size_of(series)
}

/// The same for series whose mean is known to be zero, as that of an error against a covariance that claims no bias.
///
/// A bias that stays for a whole track is then correlation and leaves the track worth one epoch, also where there is one track alone;
/// about its own mean such a track would be worth all its epochs.
pub fn effective_size_about_zero(series: Vec<Vec<f64>>) -> f64 {
    size_of(series)
}

/// Of series whose mean was taken away.
fn size_of(mut centred: Vec<Vec<f64>>) -> f64 {
    let n: usize = centred.iter().map(Vec::len).sum();
    if n == 0 {
        return 0.0;
    }
    let size = n as f64;
    let variance = covariance(&centred, 0) / size;
    if !(variance > 0.0) {
        return centred.len() as f64;
    }
    let mut sum: f64 = -0.5;
    let mut block = 1.0;
    let mut first = 0;
    loop {
        for lag in (first..LAGS).step_by(2) {
            let near = covariance(&centred, lag);
            let pair = near + covariance(&centred, lag + 1);
            if !(pair > 0.0) {
                return (size / (2.0 * sum).max(1.0)).max(1.0);
            }
            // The nodes of this scale begin a quarter of a block before those of the finer one end.
            let overlap = if lag == first && first > 0 { 0.25 * near } else { 0.0 };
            sum += block * block * (pair - overlap) / (size * variance);
        }
        centred = centred.iter().map(|s| s.chunks_exact(2).map(|p| 0.5 * (p[0] + p[1])).collect()).collect();
        block *= 2.0;
        first = LAGS / 2;
    }
}

/// Sum of products of values `lag` apart, over all tracks.
fn covariance(series: &[Vec<f64>], lag: usize) -> f64 {
    series.iter().filter(|s| s.len() > lag).map(|s| s.iter().zip(&s[lag..]).map(|(a, b)| a * b).sum::<f64>()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A Gauss-Markov series from a 64-bit linear congruential generator and the sum of twelve uniforms.
    fn gauss_markov(n: usize, phi: f64, mut seed: u64) -> Vec<f64> {
        let mut uniform = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1_u64 << 53) as f64
        };
        let mut normal = || (0..12).map(|_| uniform()).sum::<f64>() - 6.0;
        let mut x = normal();
        let fresh = (1.0 - phi * phi).sqrt();
        (0..n)
            .map(|_| {
                x = phi * x + fresh * normal();
                x
            })
            .collect()
    }

    /// (1 - phi) / (1 + phi) of the epochs. Four standard errors of the sum of M correlations, 4 sqrt(2 (2M + 1) / n) (Madras and Sokal
    /// 1988), with five correlation times summed.
    #[test]
    fn a_gauss_markov_series_is_worth_its_known_share() {
        let n = 200_000;
        for phi in [0.0, 0.5, 0.9, 0.99_f64] {
            let share = effective_size(&[gauss_markov(n as usize, phi, 20_261_121)]) / f64::from(n);
            let known = (1.0 - phi) / (1.0 + phi);
            let tolerance = 4.0 * (2.0 * (10.0 / (1.0 - phi) + 1.0) / f64::from(n)).sqrt();
            assert!((share / known - 1.0).abs() <= tolerance, "phi {phi}: {share} for {known} within {tolerance}");
        }
    }

    #[test]
    fn tracks_are_pooled() {
        let tracks: Vec<_> = (0..40).map(|t| gauss_markov(5000, 0.9, 77 + t)).collect();
        let share = effective_size(&tracks) / 200_000.0;
        // As above: 4 sqrt(2 * 101 / 200 000).
        assert!((share * 19.0 - 1.0).abs() <= 0.13, "{share}");
    }

    #[test]
    fn a_bias_of_each_track_leaves_a_track_worth_one_epoch() {
        let biases = gauss_markov(400, 0.0, 5);
        for length in [50, 100, 1000, 5000] {
            let tracks: Vec<_> = biases.iter().map(|b| vec![*b; length]).collect();
            let size = effective_size(&tracks);
            // The sum over a box of L lags is exact: 1 + 2 sum (1 - k/L) = L, so one epoch a track; changes of scale cost 1 %.
            assert!((size / 400.0 - 1.0).abs() <= 0.01, "{length}: {size}");
        }
        assert_eq!(effective_size(&[vec![3.0; 50], vec![3.0; 20]]), 2.0);
    }

    #[test]
    fn about_zero_a_bias_is_correlation_in_a_single_track_too() {
        let noise = gauss_markov(5000, 0.0, 9);
        let biased: Vec<_> = noise.iter().map(|x| 3.0 + 0.3 * x).collect();
        assert!(effective_size(std::slice::from_ref(&biased)) > 2500.0);
        // The bias has 1 / 1.01 of the square: the size is 1.01 where the noise adds nothing, and the changes of scale cost 1 %.
        let size = effective_size_about_zero(vec![biased]);
        assert!((1.0..1.1).contains(&size), "{size}");
        let size = effective_size_about_zero(vec![noise]);
        assert!(size > 2500.0, "{size}");
    }

    #[test]
    fn it_is_between_one_and_the_count() {
        assert_eq!(effective_size(&[]), 0.0);
        assert_eq!(effective_size(&[vec![1.0]]), 1.0);
        let alternating = (0..1000).map(|i| if i % 2 == 0 { 1.0 } else { -1.0 }).collect::<Vec<_>>();
        assert_eq!(effective_size(&[alternating]), 1000.0);
        let trend = (0..1000).map(f64::from).collect::<Vec<_>>();
        let size = effective_size(&[trend]);
        assert!((1.0..10.0).contains(&size), "{size}");
    }
}
