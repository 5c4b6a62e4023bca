//! Continuity by the sliding window, from the lengths of available runs alone; intervals of shares and of counts.

use navbound_core::special::gamma::chi_square_factor;
use navbound_core::special::normal::two_sided_factor;

/// Runs of availability in a stretch of the grid.
///
/// ```text
/// at risk = number of available epochs with an epoch that is not available among the next W
///         = sum over runs of available epochs that end before the data do of min(W, length)
/// ```
///
/// A run that touches an end of the stretch is kept open, so that neighbours merge exactly.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Continuity {
    n: u64,
    head: u64,
    tail: u64,
    inner_events: u64,
    inner_at_risk: u64,
}

impl Continuity {
    /// `n` more epochs, all available or none.
    pub fn push(&mut self, available: bool, n: u64, window: u64) {
        let next = if available { Self { n, head: n, tail: n, ..Self::default() } } else { Self { n, ..Self::default() } };
        *self = self.merged(&next, window);
    }

    /// This stretch, then the next.
    pub fn merged(&self, next: &Self, window: u64) -> Self {
        if self.n == 0 || next.n == 0 {
            return if self.n == 0 { *next } else { *self };
        }
        let (whole, next_whole) = (self.head == self.n, next.head == next.n);
        let joined = self.tail + next.head;
        let inside = !whole && !next_whole && joined > 0;
        Self {
            n: self.n + next.n,
            head: if whole { joined } else { self.head },
            tail: if next_whole { joined } else { next.tail },
            inner_events: self.inner_events + next.inner_events + u64::from(inside),
            inner_at_risk: self.inner_at_risk + next.inner_at_risk + if inside { joined.min(window) } else { 0 },
        }
    }

    fn head_ended(&self) -> bool {
        0 < self.head && self.head < self.n
    }

    /// Times the service was available and then was not.
    pub fn events(&self) -> u64 {
        self.inner_events + u64::from(self.head_ended())
    }

    /// Available epochs with an epoch that is not available in the window after them.
    pub fn at_risk(&self, window: u64) -> u64 {
        self.inner_at_risk + if self.head_ended() { self.head.min(window) } else { 0 }
    }
}

/// Wilson interval of a share, for a sample worth `n` independent ones; NaN unless `0 <= share <= 1` and `n > 0`.
///
/// ```text
/// (p + z^2/2n +- z sqrt(p (1 - p)/n + z^2/4n^2)) / (1 + z^2/n)        Wilson 1927
/// ```
pub fn wilson_limits(share: f64, n: f64, risk: f64) -> (f64, f64) {
    if !((0.0..=1.0).contains(&share) && n > 0.0) {
        return (f64::NAN, f64::NAN);
    }
    let z2 = two_sided_factor(risk).powi(2);
    let centre = share + z2 / (2.0 * n);
    let half = (z2 * (share * (1.0 - share) / n + z2 / (4.0 * n * n))).sqrt();
    let scale = 1.0 + z2 / n;
    // The formula's own limits at the ends, which rounding misses by a digit.
    let low = if share == 0.0 { 0.0 } else { (centre - half) / scale };
    let high = if share == 1.0 { 1.0 } else { (centre + half) / scale };
    (low, high)
}

/// Exact interval of the expectation of a Poisson count.
///
/// ```text
/// low = chi2(risk/2; 2k) / 2,   high = chi2(1 - risk/2; 2k + 2) / 2        Garwood 1936
/// ```
pub fn poisson_limits(count: u64, risk: f64) -> (f64, f64) {
    let k = count as f64;
    let low = if count == 0 { 0.0 } else { 0.5 * chi_square_factor(2.0 * k, 1.0 - 0.5 * risk) };
    (low, 0.5 * chi_square_factor(2.0 * k + 2.0, 0.5 * risk))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(pattern: &str, window: u64) -> Continuity {
        let mut continuity = Continuity::default();
        pattern.chars().for_each(|c| continuity.push(c == 'X', 1, window));
        continuity
    }

    #[test]
    fn the_published_pattern_has_thirteen_of_eighteen() {
        let pattern = "OOOXXXXXXXXOOOOXXXXXOOOOOOXXXOOOXX";
        assert_eq!(pattern.matches('X').count(), 18);
        assert_eq!(of(pattern, 5).at_risk(5), 13);
        assert_eq!(of(pattern, 5).events(), 3);
    }

    /// Against the definition, epoch by epoch, for every cut of every pattern of ten.
    #[test]
    fn every_cut_of_every_pattern_gives_the_definition() {
        for bits in 0_u32..1 << 10 {
            let pattern: String = (0..10).map(|i| if bits >> i & 1 == 1 { 'X' } else { 'O' }).collect();
            let x: Vec<bool> = pattern.chars().map(|c| c == 'X').collect();
            let events = (1..10).filter(|&i| x[i - 1] && !x[i]).count() as u64;
            let at_risk = (0..10).filter(|&i| x[i] && x[i + 1..].iter().take(3).any(|a| !a)).count() as u64;
            for cut in 0..=10 {
                let both = of(&pattern[..cut], 3).merged(&of(&pattern[cut..], 3), 3);
                assert_eq!((both.events(), both.at_risk(3)), (events, at_risk), "{pattern} cut at {cut}");
            }
        }
    }

    /// Wilson for 81 of 263, and Poisson for 0 and 10: Newcombe 1998, table I; Garwood's table.
    #[test]
    fn intervals_are_those_of_published_tables() {
        let (low, high) = wilson_limits(81.0 / 263.0, 263.0, 0.05);
        assert!((low - 0.2553).abs() < 5e-5 && (high - 0.3662).abs() < 5e-5, "{low} {high}");
        let (low, high) = poisson_limits(0, 0.05);
        assert!(low == 0.0 && (high - 3.6889).abs() < 5e-5, "{high}");
        let (low, high) = poisson_limits(10, 0.05);
        assert!((low - 4.7954).abs() < 5e-5 && (high - 18.3904).abs() < 5e-5, "{low} {high}");
    }
}
