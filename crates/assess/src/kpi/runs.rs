//! Maximal runs of consecutive epochs with a condition, as something that merges.

use super::epoch::{Cause, Epoch, State};

/// One run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// First slot.
    pub first_slot: i64,
    /// Last slot.
    pub last_slot: i64,
    /// Epochs.
    pub n: u64,
    /// Largest horizontal error, vertical error, horizontal and vertical level in it; NaN where none is known \[m\].
    pub peak_m: [f64; 4],
    /// Why it began; none where the condition is not a lack.
    pub cause: Option<Cause>,
    /// Of the epoch before, where there is one.
    pub before: Option<State>,
    /// Of the first epoch, where there is one.
    pub onset: Option<State>,
}

impl Stretch {
    /// One epoch.
    pub fn of(epoch: &Epoch, cause: Option<Cause>, before: Option<State>) -> Self {
        let (slot, peak_m) = (epoch.slot, epoch.size_m);
        Self { first_slot: slot, last_slot: slot, n: 1, peak_m, cause, before, onset: Some(epoch.state) }
    }

    /// Absent epochs.
    pub fn absent(first_slot: i64, n: u64, before: Option<State>) -> Self {
        let last_slot = first_slot.saturating_add_unsigned(n).saturating_sub(1);
        Self { first_slot, last_slot, n, peak_m: [f64::NAN; 4], cause: Some(Cause::Missing), before, onset: None }
    }

    fn then(self, next: &Self) -> Self {
        let mut peak_m = self.peak_m;
        for (peak, other) in peak_m.iter_mut().zip(next.peak_m) {
            // The maximum of a number and a NaN is the number.
            *peak = peak.max(other);
        }
        Self { last_slot: next.last_slot, n: self.n + next.n, peak_m, ..self }
    }
}

/// The runs of a stretch of the grid. Those that touch an end stay open, so that neighbours merge exactly.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Runs {
    n: u64,
    /// The run that touches the beginning; it covers everything when it has `n` epochs.
    head: Option<Stretch>,
    /// The run that touches the end and not the beginning.
    tail: Option<Stretch>,
    closed: Vec<Stretch>,
}

impl Runs {
    fn whole(&self) -> bool {
        self.head.is_some_and(|h| h.n == self.n)
    }

    /// More epochs with the condition.
    pub fn push(&mut self, run: Stretch) {
        if let Some(tail) = self.tail.take() {
            self.tail = Some(tail.then(&run));
        } else if self.n == 0 {
            self.head = Some(run);
        } else if self.whole() {
            self.head = self.head.map(|h| h.then(&run));
        } else {
            self.tail = Some(run);
        }
        self.n += run.n;
    }

    /// `n` more epochs without it.
    pub fn pause(&mut self, n: u64) {
        self.closed.extend(self.tail.take());
        self.n += n;
    }

    /// The next stretch of the grid; `before` is this one's last state.
    pub fn append(&mut self, mut next: Self, before: Option<State>) {
        if next.n == 0 {
            return;
        }
        if self.n == 0 {
            *self = next;
            return;
        }
        let (whole, next_whole) = (self.whole(), next.whole());
        let open = if whole { self.head.take() } else { self.tail.take() };
        let joined = match (open, next.head.take()) {
            (Some(run), Some(rest)) => Some(run.then(&rest)),
            (Some(run), None) => Some(run),
            (None, Some(run)) => Some(Stretch { before: run.before.or(before), ..run }),
            (None, None) => None,
        };
        // Whether the joined run still touches an end of both together.
        if whole {
            self.head = joined;
        } else if next_whole {
            self.tail = joined;
        } else {
            self.closed.extend(joined);
        }
        self.closed.append(&mut next.closed);
        self.tail = next.tail.or(self.tail);
        self.n += next.n;
    }

    /// Runs that ended, taken out; the one that touches the beginning is not among them.
    pub fn drain(&mut self) -> Vec<Stretch> {
        std::mem::take(&mut self.closed)
    }

    /// What is left at the end of the data, in order: with each run, whether the data ended first.
    pub fn finish(mut self) -> Vec<(Stretch, bool)> {
        let whole = self.whole();
        let head = self.head.map(|h| (h, whole));
        head.into_iter().chain(self.drain().into_iter().map(|run| (run, false))).chain(self.tail.map(|run| (run, true))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(bits: u32, from: i64, to: i64) -> Runs {
        let mut runs = Runs::default();
        for slot in from..to {
            let state = State { n_sv: slot as i32, mode: 0, reason: 0 };
            let epoch = Epoch { slot, size_m: [slot as f64; 4], state };
            let before = (slot > from).then_some(State { n_sv: slot as i32 - 1, ..state });
            if bits >> slot & 1 == 1 { runs.push(Stretch::of(&epoch, None, before)) } else { runs.pause(1) }
        }
        runs
    }

    #[test]
    fn every_cut_of_every_pattern_gives_the_maximal_runs() {
        for bits in 0_u32..1 << 9 {
            let mut expected = Vec::new();
            let set = |i: i64| (0..9).contains(&i) && bits >> i & 1 == 1;
            for first in (0..9).filter(|&i| set(i) && !set(i - 1)) {
                let last = (first..9).take_while(|&i| set(i)).last().unwrap();
                expected.push((first, last, last == 8, (first > 0).then(|| first as i32 - 1)));
            }
            for cut in 0..=9 {
                let mut runs = of(bits, 0, cut);
                let before = (cut > 0).then(|| State { n_sv: cut as i32 - 1, mode: 0, reason: 0 });
                runs.append(of(bits, cut, 9), before);
                let maximal: Vec<_> = runs.finish();
                let short: Vec<_> = maximal.iter().map(|(s, open)| (s.first_slot, s.last_slot, *open, s.before.map(|b| b.n_sv))).collect();
                assert_eq!(short, expected, "{bits:09b} cut at {cut}");
                assert!(maximal.iter().all(|(s, _)| s.n as i64 == s.last_slot - s.first_slot + 1 && s.peak_m[0] == s.last_slot as f64));
            }
        }
    }
}
