//! Coverage when whole tracks, not epochs, are the independent things.

use super::{INTERVAL_RISK, same_length};
use crate::parallel;
use navbound_core::quantity::OutOfDomain;

/// Replicates in one task of the pool.
const REPLICATES_PER_TASK: usize = 16;

/// 95 % interval of the coverage by resampling tracks with replacement (cluster bootstrap, percentile limits). The result depends on
/// the seed and the tracks' order alone: every draw is a function of seed, replicate and position.
///
/// # Errors
/// [`OutOfDomain`] for columns of unequal length, fewer than two tracks with a judged epoch, and replicates outside `[100, 100 000]`.
pub fn coverage_interval(
    error_m: &[f64],
    bound_m: &[f64],
    track: &[u32],
    n_replicates: usize,
    seed: u64,
) -> Result<(f64, f64), (Option<usize>, OutOfDomain)> {
    same_length("bound_m", bound_m.len(), error_m.len())?;
    same_length("track", track.len(), error_m.len())?;
    coverage_interval_of_counts(counts(error_m, bound_m, track), n_replicates, seed)
}

/// The same of judged epochs and those within, track by track.
///
/// # Errors
/// As [`coverage_interval`].
pub fn coverage_interval_of_counts(
    mut tracks: Vec<(u64, u64)>,
    n_replicates: usize,
    seed: u64,
) -> Result<(f64, f64), (Option<usize>, OutOfDomain)> {
    if !(100..=100_000).contains(&n_replicates) {
        let refusal = OutOfDomain { argument: "n_replicates", value: n_replicates as f64, unit: "1", domain: "[100, 100000]" };
        return Err((None, refusal));
    }
    tracks.retain(|(n, _)| *n > 0);
    if tracks.len() < 2 {
        return Err((None, OutOfDomain { argument: "track", value: tracks.len() as f64, unit: "tracks", domain: "[2, inf)" }));
    }
    let mut shares: Vec<f64> = parallel::map(n_replicates, REPLICATES_PER_TASK, |replicate| share(&tracks, seed, replicate as u64));
    shares.sort_unstable_by(f64::total_cmp);
    let at = |p: f64| shares[(p * (n_replicates - 1) as f64).round() as usize];
    Ok((at(0.5 * INTERVAL_RISK), at(1.0 - 0.5 * INTERVAL_RISK)))
}

/// Judged epochs and those within, track by track.
fn counts(error_m: &[f64], bound_m: &[f64], track: &[u32]) -> Vec<(u64, u64)> {
    let n_tracks = track.iter().max().map_or(0, |t| *t as usize + 1);
    let mut tracks = vec![(0, 0); n_tracks];
    for ((e, b), t) in error_m.iter().zip(bound_m).zip(track) {
        if !(e.is_nan() || b.is_nan()) {
            let (n, within) = &mut tracks[*t as usize];
            *n += 1;
            *within += u64::from(e.abs() <= *b);
        }
    }
    tracks
}

fn share(tracks: &[(u64, u64)], seed: u64, replicate: u64) -> f64 {
    let (mut all, mut within) = (0, 0);
    for draw in 0..tracks.len() as u64 {
        let (n, k) = tracks[pick(tracks.len() as u64, seed, replicate, draw)];
        all += n;
        within += k;
    }
    within as f64 / all as f64
}

/// An index below `n` from a counter; the high half of the product is uniform to n / 2^64.
fn pick(n: u64, seed: u64, replicate: u64, draw: u64) -> usize {
    let mixed = mix(mix(mix(seed) ^ replicate) ^ draw);
    ((u128::from(mixed) * u128::from(n)) >> 64) as usize
}

/// Finaliser of SplitMix64 (Steele, Lea and Flood 2014), a bijection that passes as random.
fn mix(counter: u64) -> u64 {
    let mut z = counter.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
