//! The share of measurements that a filter rejects, and the size of all innovations together.

use crate::monitor::judgement::{Gating, Tuning};
use crate::quantity::GpsTime;
use crate::solution::ins::{Block, Fusion, Innovations, Kind};
use crate::special::float::exp;

/// Time over which a share is taken \[s\]. Provenance: inferred.
const WINDOW: usize = 10;
/// Least time between two counts, a second but for jitter \[s\].
const STEP_S: f64 = 0.95;
/// Scalars from which the smaller share counts, and both shares. Provenance: inferred; a healthy filter rejects 2 of 21 000.
const MANY: u64 = 20;
const SHARE_OF_MANY: f64 = 0.2;
const SHARE_OF_FEW: f64 = 0.5;
/// Time over which innovations are averaged \[s\], the mean square from which the declared errors do not explain them, and below which they
/// do again. Provenance: inferred.
const TUNING_S: f64 = 60.0;
const FOREIGN: f64 = 3.0;
const DECLARED: f64 = 1.5;
/// Largest mean square of an instant that counts: a single instant has a culprit, whatever its size.
const INSTANT_MOST: f64 = 10.0;

/// Families of measurements that keep a position. A single station that is left out is a culprit with a name, a blocked altimeter another.
const FAMILIES: [&[Kind]; 3] = [&[Kind::Range], &[Kind::RangeRate], &[Kind::FixPosition, Kind::FixVelocity]];

/// Scalars used and rejected, of each family.
type Totals = [[u64; 2]; FAMILIES.len()];

/// Counts second by second.
#[derive(Debug, Clone, Copy)]
pub struct Shares {
    counted: Totals,
    window: [Totals; WINDOW],
    next: usize,
    since: Option<GpsTime>,
    stepped: Option<GpsTime>,
    excess: bool,
    mean: f64,
    weight: f64,
    last: Option<GpsTime>,
    foreign: bool,
}

impl Shares {
    /// Nothing counted yet.
    pub const fn new() -> Self {
        let none = [[0; 2]; FAMILIES.len()];
        Self {
            counted: none,
            window: [none; WINDOW],
            next: 0,
            since: None,
            stepped: None,
            excess: false,
            mean: 0.0,
            weight: 0.0,
            last: None,
            foreign: false,
        }
    }

    /// A second has passed.
    pub fn second(&mut self, now: GpsTime, filter: &Fusion) -> Gating {
        let of = |family: &[Kind], count: fn(&Innovations) -> u64| family.iter().map(|kind| count(filter.innovations(*kind))).sum();
        self.say(now, FAMILIES.map(|family| [of(family, |i| i.n_used), of(family, |i| i.n_gated)]))
    }

    /// The same of the scalars of each family that a filter has used and rejected since it started.
    fn say(&mut self, now: GpsTime, total: Totals) -> Gating {
        // Results may be more frequent: what was counted stands until the second is over.
        if self.stepped.is_none_or(|t| now.seconds_since(t) >= STEP_S) {
            self.stepped = Some(now);
            self.count(total);
        }
        if !self.excess {
            self.since = None;
            return Gating::Usual;
        }
        Gating::Excess { for_s: now.seconds_since(*self.since.get_or_insert(now)) }
    }

    fn count(&mut self, totals: Totals) {
        for (k, total) in totals.into_iter().enumerate() {
            // A filter that started anew counts from nothing.
            self.window[self.next][k] =
                [0, 1].map(|j| if total[j] >= self.counted[k][j] { total[j] - self.counted[k][j] } else { total[j] });
            self.counted[k] = total;
        }
        self.next = (self.next + 1) % WINDOW;
        self.excess = (0..FAMILIES.len()).any(|k| {
            let [used, gated] = [0, 1].map(|j| self.window.iter().map(|second| second[k][j]).sum::<u64>());
            let (all, gated) = (used + gated, gated as f64);
            let most = if all >= MANY { SHARE_OF_MANY } else { SHARE_OF_FEW };
            all > 0 && !(gated <= most * all as f64)
        });
    }

    /// The innovations of an instant, used or not, of a filter that the snapshot does not contradict.
    pub fn innovations(&mut self, now: GpsTime, block: &Block) {
        let keep = self.last.map_or(0.0, |t| exp(-now.seconds_since(t) / TUNING_S));
        self.last = Some(now);
        let square = block.square / block.freedom as f64;
        // A square that is no number is the largest.
        self.mean = keep * self.mean + if square <= INSTANT_MOST { square } else { INSTANT_MOST };
        self.weight = keep * self.weight + 1.0;
    }

    /// What they say. Before half a window has been heard the declared errors stand.
    pub fn tuning(&mut self) -> Tuning {
        let mean = self.mean / self.weight;
        let most = if self.foreign { DECLARED } else { FOREIGN };
        self.foreign = self.weight >= 0.5 * WINDOW as f64 && !(mean <= most);
        if self.foreign { Tuning::Foreign } else { Tuning::AsDeclared }
    }
}

impl Default for Shares {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(second: f64) -> GpsTime {
        GpsTime::default().plus_seconds(second)
    }

    /// What is said after each of these mean squares, a second apart.
    fn tunings(squares: &[f64]) -> Vec<Tuning> {
        let mut shares = Shares::new();
        let hear = |(k, s): (usize, &f64)| {
            shares.innovations(at(k as f64), &Block { square: 4.0 * s, freedom: 4 });
            shares.tuning()
        };
        squares.iter().enumerate().map(hear).collect()
    }

    #[test]
    fn the_declared_errors_stand_until_five_instants_say_otherwise() {
        assert!(matches!(Shares::new().tuning(), Tuning::AsDeclared));
        for square in [3.1, 50.0, f64::NAN, f64::INFINITY] {
            let shares = tunings(&[square; 20]);
            // The weight of five seconds of a mean over sixty is 4.84: the sixth passes five.
            assert!(shares[..5].iter().all(|t| matches!(t, Tuning::AsDeclared)), "{square}");
            assert!(shares[5..].iter().all(|t| matches!(t, Tuning::Foreign)), "{square}");
        }
        assert!(tunings(&[2.9; 300]).iter().all(|t| matches!(t, Tuning::AsDeclared)));
    }

    #[test]
    fn a_foreign_filter_is_so_until_the_mean_falls_below_half() {
        // The mean of n squares of 8 and m of 1 with weights exp(-age / 60 s), summed as they are.
        let squares: Vec<f64> = (0..400).map(|k| if k < 60 { 8.0 } else { 1.0 }).collect();
        let mean = |now: usize| {
            let weighted = |f: &dyn Fn(usize) -> f64| (0..=now).map(|k| f(k) * (-((now - k) as f64) / 60.0).exp()).sum::<f64>();
            weighted(&|k| squares[k]) / weighted(&|_| 1.0)
        };
        for (k, t) in tunings(&squares).iter().enumerate().skip(6) {
            assert_eq!(matches!(t, Tuning::Foreign), mean(k) > 1.5, "{k}");
        }
        // One instant counts no more than ten.
        assert!(tunings(&[&[1.0; 30][..], &[1e9], &[1.0; 30]].concat()).iter().all(|t| matches!(t, Tuning::AsDeclared)));
    }

    /// What is said of each second by all that was used and rejected in the ten seconds until then, each family by itself.
    #[test]
    fn an_excess_is_a_share_of_the_last_ten_seconds() {
        let mut state = 9_u64;
        let mut draw = |most: u64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) % most
        };
        let (mut shares, mut total, mut history) = (Shares::new(), [[0_u64; 2]; 3], Vec::new());
        let (mut began, mut excesses) = (None, 0);
        for second in 0..4000_u32 {
            // Busy and quiet times, and now and then a filter that starts anew.
            let busy = [1, 2, 6][second as usize / 37 % 3];
            let gated = [1, 3, 1, 2][second as usize / 23 % 4];
            if second % 501 == 500 {
                total = [[0; 2]; 3];
            }
            let passed: [[u64; 2]; 3] = core::array::from_fn(|_| [draw(busy), draw(gated)]);
            for k in 0..3 {
                (0..2).for_each(|j| total[k][j] += passed[k][j]);
            }
            // A filter that starts anew and soon has as many again as before is not seen; here it never has.
            history.push(passed);
            let last = &history[history.len().saturating_sub(10)..];
            let excess = (0..3).any(|k| {
                let [used, gated] = [0, 1].map(|j| last.iter().map(|passed| passed[k][j]).sum::<u64>());
                // A fifth of twenty and more, half of fewer.
                if used + gated >= 20 { 5 * gated > used + gated } else { 2 * gated > used + gated }
            });
            began = excess.then(|| began.unwrap_or(second));
            let reported = shares.say(at(f64::from(second)), total);
            let expected = began.map_or(Gating::Usual, |s| Gating::Excess { for_s: f64::from(second - s) });
            assert_eq!(reported, expected, "{second}");
            excesses += u32::from(excess);
        }
        assert!((400..3600).contains(&excesses), "{excesses}");
    }

    /// Nineteen and twenty scalars, and shares of exactly a half and a fifth.
    #[test]
    fn a_share_that_is_just_reached_is_no_excess() {
        let reported = |used: u64, gated: u64| {
            let alone: [Gating; 3] = core::array::from_fn(|k| {
                let mut total = [[0; 2]; 3];
                total[k] = [used, gated];
                Shares::new().say(at(0.0), total)
            });
            assert!(alone.iter().all(|g| *g == alone[0]), "each family counts alike");
            alone[0] != Gating::Usual
        };
        assert!(!reported(0, 0) && !reported(16, 4) && reported(15, 5) && !reported(80, 20) && reported(79, 21));
        assert!(!reported(9, 9) && !reported(10, 9) && reported(9, 10) && !reported(15, 4) && !reported(1, 1) && reported(0, 1));
    }

    /// Results may come faster than the seconds: what was counted stands until 0.95 s have passed.
    #[test]
    fn a_second_is_counted_once() {
        let mut shares = Shares::new();
        let only_gated = |n: u64| [[0, n], [0; 2], [0; 2]];
        assert_eq!(shares.say(at(0.0), only_gated(0)), Gating::Usual);
        assert_eq!(shares.say(at(0.94), only_gated(5)), Gating::Usual);
        assert_eq!(shares.say(at(0.95), only_gated(5)), Gating::Excess { for_s: 0.0 });
        assert_eq!(shares.say(at(1.8), only_gated(5)), Gating::Excess { for_s: 0.85 });
    }

    /// One instant of exactly ten, and what is above it or no number, count as ten; a mean of exactly three or one and a half is no more.
    #[test]
    fn a_mean_that_is_just_reached_is_as_declared() {
        let mut shares = Shares::new();
        for k in 0..20 {
            // Instants of one time forget nothing: the mean is a plain one.
            shares.innovations(at(0.0), &Block { square: [12.0, 0.0][k % 2], freedom: 2 });
        }
        assert!(shares.tuning() == Tuning::AsDeclared, "the mean of six and nothing is three");
        shares.innovations(at(0.0), &Block { square: 12.0, freedom: 2 });
        assert!(shares.tuning() == Tuning::Foreign, "six more are more than three in the mean");
        for _ in 0..21 {
            shares.innovations(at(0.0), &Block { square: 0.0, freedom: 2 });
        }
        assert!(shares.tuning() == Tuning::Foreign, "66 of 42 are more than one and a half");
        shares.innovations(at(0.0), &Block { square: 0.0, freedom: 2 });
        shares.innovations(at(0.0), &Block { square: 0.0, freedom: 2 });
        assert!(shares.tuning() == Tuning::AsDeclared, "66 of 44 are one and a half");
        // Four instants say nothing, five do.
        for (n, foreign) in [(4, false), (5, true)] {
            let mut shares = Shares::new();
            (0..n).for_each(|_| shares.innovations(at(0.0), &Block { square: 16.0, freedom: 2 }));
            assert_eq!(shares.tuning() == Tuning::Foreign, foreign, "{n}");
        }
    }
}
