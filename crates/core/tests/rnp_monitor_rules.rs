//! The rules of the RNP monitor, judged from the whole history of a sequence, against its state machine step by step.
//!
//! The judge below keeps no state from epoch to epoch. For each epoch it looks back over all records and asks, rule by rule, what must be
//! in force. Times are whole seconds and the wait to raise is counted in tenths, so nothing is rounded.
#![allow(clippy::unwrap_used, reason = "a helper of tests may stop at the first surprise, too")]

use navbound_core::bound::Alerting;
use navbound_core::monitor::rnp::{Alert, Chain, Monitor, Observation, Settings};
use navbound_core::quantity::{GpsTime, Metres};

const RNP_M: f64 = 500.0;
const STALE_S: i64 = 2;
const CLEAR_S: i64 = 10;
/// Three seconds in tenths; ten seconds inside empty them again.
const FULL: i64 = 30;

/// One record: bounds as shares of their limits at `RNP_M`, and whether RNP is halved.
#[derive(Debug, Clone, Copy)]
struct Record {
    time_s: i64,
    accuracy: f64,
    integrity: f64,
    usable: bool,
    halved: bool,
}

impl Record {
    fn rnp_m(&self) -> f64 {
        if self.halved { RNP_M / 2.0 } else { RNP_M }
    }

    /// The bound as a share of the limit in force.
    fn share(&self, caution: bool) -> f64 {
        (if caution { self.accuracy } else { self.integrity }) * RNP_M / self.rnp_m()
    }

    fn inside(&self, caution: bool) -> bool {
        self.usable && self.share(caution) <= 1.0
    }

    fn calm(&self, caution: bool) -> bool {
        self.usable && self.share(caution) <= 0.95
    }
}

/// What became of the records up to the last one.
struct Judge<'a> {
    records: &'a [Record],
    /// Records that counted, and those at which a new clock began to count.
    counted: Vec<usize>,
    set_back: Vec<usize>,
    /// The alert after each record before the last.
    before: &'a [Alert],
}

impl<'a> Judge<'a> {
    fn new(records: &'a [Record], before: &'a [Alert]) -> Self {
        let (mut counted, mut set_back) = (Vec::new(), Vec::new());
        for (k, record) in records.iter().enumerate() {
            let Some(&last) = counted.last() else {
                counted.push(k);
                continue;
            };
            let late = |r: &&Record| r.time_s < records[last].time_s;
            let earliest = records[last + 1..=k].iter().filter(late).map(|r| r.time_s).min();
            if record.time_s > records[last].time_s {
                counted.push(k);
            } else if late(&record) && earliest.is_some_and(|first| record.time_s - first > STALE_S) {
                counted.push(k);
                set_back.push(k);
            }
        }
        Self { records, counted, set_back, before }
    }

    fn last(&self) -> usize {
        self.records.len() - 1
    }

    /// Counted records up to record `k`.
    fn upto(&self, k: usize) -> &[usize] {
        &self.counted[..self.counted.partition_point(|c| *c <= k)]
    }

    /// Seconds since the counted record before counted record `k`, by the clock that counts at `k`.
    fn since_before(&self, k: usize) -> Option<i64> {
        let before = *self.upto(k).iter().rev().nth(1)?;
        let late = self.records[before + 1..=k].iter().map(|r| r.time_s).filter(|t| *t < self.records[before].time_s);
        let from = if self.set_back.contains(&k) { late.min().unwrap() } else { self.records[before].time_s };
        Some(self.records[k].time_s - from)
    }

    /// Whether monitoring is lost after record `k`: no usable epoch there, one of the same time that is not usable, dropped for longer than
    /// permitted, or lost before and only dropped since.
    fn lost_after(&self, k: usize) -> bool {
        let newest = *self.upto(k).last().unwrap();
        let dropped = (k - newest) as i64;
        let denied = self.records[newest + 1..=k].iter().any(|r| r.time_s == self.records[newest].time_s && !r.usable);
        !self.records[newest].usable || self.set_back.contains(&newest) || denied || dropped > STALE_S
    }

    /// Whether record `k` is of the time of the counted record before it, or at most `STALE_S` earlier, with a bound outside, while monitoring
    /// stood.
    fn contradicts(&self, k: usize, caution: bool) -> bool {
        let newest = *self.upto(k).last().unwrap();
        let age_s = self.records[newest].time_s - self.records[k].time_s;
        let repeat = newest < k && (0..=STALE_S).contains(&age_s);
        repeat && self.records[k].usable && !self.lost_after(k) && !self.lost_before(k) && !self.records[k].inside(caution)
    }

    /// Whether monitoring was lost at some record since the newest counted one, up to dropped record `k`.
    fn lost_before(&self, k: usize) -> bool {
        let newest = *self.upto(k).last().unwrap();
        (newest..k).any(|j| self.lost_after(j))
    }

    /// Whether a repeat contradicted the counted record before counted record `k`.
    fn contradicted_before(&self, k: usize, caution: bool) -> bool {
        let before = self.upto(k).iter().rev().nth(1);
        before.is_some_and(|b| (b + 1..k).any(|j| self.contradicts(j, caution)))
    }

    /// Whether nothing was known of the bounds between counted record `k` and the one before it.
    fn unknown_before(&self, k: usize) -> bool {
        self.set_back.contains(&k) || self.since_before(k).is_some_and(|dt| dt > STALE_S) || k > 0 && self.lost_after(k - 1)
    }

    /// Tenths of a second that the wait gains on the way to counted record `k`.
    fn gain(&self, k: usize, caution: bool) -> i64 {
        let Some(dt) = self.since_before(k) else { return 0 };
        let before = *self.upto(k).iter().rev().nth(1).unwrap();
        if self.unknown_before(k) || !self.records[before].inside(caution) || self.contradicted_before(k, caution) {
            10 * dt
        } else {
            -3 * dt
        }
    }

    /// The wait at counted record `k`: the largest sum of gains from any start, capped by what a full wait would be since any moment in
    /// between. That is the closed form of a sum kept between 0 and full.
    fn wait(&self, k: usize, from: usize) -> i64 {
        let (mut sum, mut cap, mut most) = (0, FULL, 0);
        for &c in self.upto(k).iter().rev().take_while(|c| **c > from) {
            sum += self.gain(c, true);
            most = most.max(sum.min(cap));
            cap = cap.min(FULL + sum);
        }
        most
    }

    /// Whether the exceedance has lasted: the wait was full at a counted record since `from`, and not empty since.
    fn waited(&self, k: usize, from: usize) -> bool {
        let since = self.upto(k).iter().rev().take_while(|c| **c > from).map(|c| self.wait(*c, from));
        since.take_while(|level| *level > 0).any(|level| level == FULL)
    }

    /// Calm for `CLEAR_S` in one piece up to counted record `k`, seen at every counted record of it.
    fn calm_long_enough(&self, k: usize, caution: bool) -> bool {
        let mut calm_s = 0;
        for &c in self.upto(k).iter().rev() {
            if !self.records[c].calm(caution) || self.set_back.contains(&c) {
                return false;
            }
            if calm_s >= CLEAR_S {
                return true;
            }
            if self.unknown_before(c) || self.contradicted_before(c, caution) {
                return false;
            }
            calm_s += self.since_before(c).unwrap_or(0);
        }
        false
    }

    /// Where the alert now in force was raised; `None` when there is none. Every counted record is examined in order, each by the whole history.
    fn raised(&self, caution: bool) -> Option<usize> {
        let (mut raised, mut cleared) = (None, None);
        for k in 0..self.records.len() {
            if !self.counted.contains(&k) {
                if raised.is_none() && self.contradicts(k, caution) && self.deserved(k, caution, cleared) {
                    raised = Some(k);
                }
                continue;
            }
            if self.set_back.contains(&k) || !self.records[k].usable {
                continue;
            }
            match raised {
                Some(_) if self.calm_after(k, raised, caution) => (raised, cleared) = (None, Some(k)),
                None if !self.records[k].inside(caution) && self.deserved(k, caution, cleared) => raised = Some(k),
                _ => {}
            }
        }
        raised
    }

    fn calm_after(&self, k: usize, raised: Option<usize>, caution: bool) -> bool {
        self.calm_long_enough(k, caution) && raised.is_some_and(|r| k > r)
    }

    /// Whether the epoch outside at `k` alerts.
    fn deserved(&self, k: usize, caution: bool, cleared: Option<usize>) -> bool {
        if !caution {
            return true;
        }
        // The wait of a cleared alert began anew; the wait of the first record, with it.
        let waited = self.waited(k, cleared.unwrap_or(0));
        let warning = Judge::new(&self.records[..=k], &self.before[..k]).raised(false).is_some();
        let from_normal = k > 0 && self.before[k - 1] == Alert::Normal && (!self.counted.contains(&k) || !self.unknown_before(k));
        waited || !warning && !from_normal
    }

    fn alert(&self) -> Alert {
        if self.lost_after(self.last()) || !self.counted.iter().any(|c| self.records[*c].usable && !self.set_back.contains(c)) {
            Alert::Unavailable
        } else if self.raised(false).is_some() {
            Alert::Warning
        } else if self.raised(true).is_some() {
            Alert::Caution
        } else {
            Alert::Normal
        }
    }
}

fn monitor() -> Monitor {
    let chain =
        Chain { sample_period_s: 1.0, sensor_latency_s: 0.0, filter_s: 0.0, computing_s: 0.0, display_s: 0.0, time_to_alert_s: 10.0 };
    let (clear_delay_s, stale_after_s) = (CLEAR_S as f64, STALE_S as f64);
    Monitor::new(Settings { chain, raise_delay_s: 3.0, clear_delay_s, clear_ratio: 0.95, stale_after_s }).unwrap()
}

fn observation(record: &Record) -> Observation {
    let exact = Alerting::of("tse-exact").unwrap();
    Observation {
        time: GpsTime::from_nanoseconds(record.time_s * 1_000_000_000),
        accuracy: exact.claim_evaluated(Metres::new(record.accuracy * RNP_M)),
        integrity: exact.claim_evaluated(Metres::new(record.integrity * 2.0 * RNP_M)),
        rnp: Metres::new(record.rnp_m()),
        usable: record.usable,
    }
}

/// A sequence on its way: the monitor after it and what it showed.
#[derive(Clone)]
struct Trial {
    monitor: Monitor,
    records: Vec<Record>,
    alerts: Vec<Alert>,
}

impl Trial {
    fn new(history: &[Record]) -> Self {
        let mut trial = Self { monitor: monitor(), records: Vec::new(), alerts: Vec::new() };
        for record in history {
            trial.step(*record);
        }
        trial
    }

    /// One more record, judged by both.
    fn step(&mut self, record: Record) -> Alert {
        let n_judged = self.monitor.counters().n_accepted;
        let step = self.monitor.step(&observation(&record));
        self.records.push(record);
        let expected = Judge::new(&self.records, &self.alerts).alert();
        assert_eq!(step.alert, expected, "last of {:#?}\nbefore it {:?}", self.records, self.alerts);
        // What no rule of detail may break: an epoch outside is never the first normal one.
        let outside = self.monitor.counters().n_accepted > n_judged && !(record.inside(true) && record.inside(false));
        assert!(!outside || step.alert != Alert::Normal || self.alerts.last() == Some(&Alert::Normal), "{:#?}", self.records);
        for event in step.ended.iter().flatten() {
            let ordered = event.onset <= event.annunciation && event.clear.is_some_and(|c| c >= event.annunciation);
            assert!(ordered, "{event:?} of {:#?}", self.records);
        }
        self.alerts.push(step.alert);
        step.alert
    }

    /// Every continuation by `depth` more records.
    fn all(&self, depth: usize, seen: &mut [u64; 4]) {
        for code in 0..KINDS.len() * STEPS_S.len() * 2 {
            let mut next = self.clone();
            let alert = next.step(decode(code, self.records.last().map_or(100, |r| r.time_s)));
            seen[alert as usize] += 1;
            if depth > 1 {
                next.all(depth - 1, seen);
            }
        }
    }
}

const IN: f64 = 0.8;
const BAND: f64 = 0.98;
const OUT: f64 = 1.2;
/// Inside at RNP, outside at half of it, unlike `FAR_IN`.
const FAR_IN: f64 = 0.3;

/// Accuracy, integrity, usable.
const KINDS: [(f64, f64, bool); 7] = [
    (IN, FAR_IN, true),
    (BAND, BAND, true),
    (OUT, FAR_IN, true),
    (FAR_IN, OUT, true),
    (OUT, OUT, true),
    (f64::NAN, f64::NAN, true),
    (f64::NAN, f64::NAN, false),
];
/// No time, one period, longer than the permitted silence, backwards beyond it and within it.
const STEPS_S: [i64; 5] = [0, 1, 5, -4, -1];

/// Number `code` as a record after `time_s`.
fn decode(code: usize, time_s: i64) -> Record {
    let (accuracy, integrity, usable) = KINDS[code % 7];
    let step_s = STEPS_S[code / 7 % STEPS_S.len()];
    Record { time_s: time_s + step_s, accuracy, integrity, usable, halved: code / (7 * STEPS_S.len()) % 2 == 1 }
}

fn steady(n: usize, kind: usize) -> Vec<Record> {
    let (accuracy, integrity, usable) = KINDS[kind];
    (0..n as i64).map(|time_s| Record { time_s, accuracy, integrity, usable, halved: false }).collect()
}

/// Histories to start from: none, normal, waiting, in caution, warned and calm for nine seconds, lost, dropped twice.
fn histories() -> Vec<Vec<Record>> {
    let join = |parts: &[(usize, usize)]| {
        let mut all: Vec<Record> = parts.iter().flat_map(|(n, kind)| steady(*n, *kind)).collect();
        (0..).zip(&mut all).for_each(|(second, record)| record.time_s = second);
        all
    };
    let mut dropped = join(&[(2, 0)]);
    dropped.extend([dropped[1], dropped[1]]);
    vec![
        vec![],
        join(&[(1, 0)]),
        join(&[(1, 0), (3, 2)]),
        join(&[(1, 0), (5, 2)]),
        join(&[(1, 0), (1, 3), (10, 0)]),
        join(&[(1, 0), (2, 6)]),
        dropped,
    ]
}

/// Every short sequence after every second history: each half is one core's.
fn every_short_sequence_after(first: usize) {
    let mut seen = [0; 4];
    for history in histories().into_iter().skip(first).step_by(2) {
        Trial::new(&history).all(3, &mut seen);
    }
    assert!(seen.iter().all(|n| *n > 10_000), "each alert was met: {seen:?}");
}

#[test]
fn every_short_sequence_is_judged_as_the_rules_say_after_histories_of_even_place() {
    every_short_sequence_after(0);
}

#[test]
fn every_short_sequence_is_judged_as_the_rules_say_after_histories_of_odd_place() {
    every_short_sequence_after(1);
}

/// A sequence of pseudo-random numbers (splitmix64), the same on every machine.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) as usize >> 1
    }
}

#[test]
fn long_random_sequences_are_judged_as_the_rules_say() {
    let mut seen = [0; 4];
    for seed in 0..400 {
        let mut numbers = Numbers(seed);
        let mut trial = Trial::new(&[]);
        // Mostly one period and a run of one kind; the stranger steps and changes are as frequent as the seed says.
        let (strange, restless) = (numbers.next() % 30 + 1, numbers.next() % 60 + 5);
        let mut code = 7;
        for _ in 0..120 {
            if numbers.next() % 100 < restless {
                code = numbers.next() % 7 + 7 + if numbers.next().is_multiple_of(5) { 35 } else { 0 };
            }
            let step = if numbers.next() % 100 < strange { numbers.next() % STEPS_S.len() } else { 1 };
            let time_s = trial.records.last().map_or(0, |r| r.time_s);
            let alert = trial.step(decode(code % 7 + 7 * step + 35 * (code / 35), time_s));
            seen[alert as usize] += 1;
        }
    }
    assert!(seen.iter().all(|n| *n > 1_000), "each alert was met: {seen:?}");
}
