//! How long a condition must last before it is an alert, when it comes and goes.

use crate::quantity::encoding::{BadBytes, Decoder, Encoder};

/// Time outside, less a share of the time inside: full after `raise_delay_s` outside in one piece, empty again after `clear_delay_s`
/// inside. Once full it is over until it is empty.
///
/// ```text
/// level += dt                                    while the bound is not known to be inside, at most raise_delay_s
/// level -= dt raise_delay_s / clear_delay_s      while it is, at least 0
/// ```
///
/// One state and one step, so it keeps no history. A bound that is outside for more than raise / (raise + clear) of the time fills it
/// sooner or later; docs/methods/rnp-monitor.md has the times. In nanoseconds: sums of whole periods are then exact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Wait {
    level_ns: f64,
    full_ns: f64,
    /// What a nanosecond inside takes off; infinite where nothing waits for calm.
    drain: f64,
    over: bool,
}

impl Wait {
    pub(super) fn new(raise_delay_s: f64, clear_delay_s: f64) -> Self {
        let drain = if clear_delay_s > 0.0 { raise_delay_s / clear_delay_s } else { f64::INFINITY };
        let full_ns = raise_delay_s * 1e9;
        Self { level_ns: 0.0, full_ns, drain, over: full_ns == 0.0 }
    }

    /// `elapsed_ns` more than zero have passed.
    pub(super) fn pass(&mut self, elapsed_ns: f64, known_inside: bool) {
        self.level_ns =
            if known_inside { (self.level_ns - self.drain * elapsed_ns).max(0.0) } else { (self.level_ns + elapsed_ns).min(self.full_ns) };
        // Between full and empty it stays as it was: the exceedance that filled it has not been made up for.
        self.over = self.level_ns == self.full_ns || self.over && self.level_ns > 0.0;
    }

    /// Whether an epoch outside is an alert now.
    pub(super) fn is_over(&self) -> bool {
        self.over
    }

    /// Time outside that is left until it is over \[s\].
    pub(super) fn left_s(&self) -> f64 {
        if self.over { 0.0 } else { (self.full_ns - self.level_ns) * 1e-9 }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.level_ns == 0.0
    }

    pub(super) fn write<const N: usize>(&self, to: &mut Encoder<N>) {
        to.f64(self.level_ns);
        to.flag(self.over);
    }

    /// Into a wait as new, which has the times.
    pub(super) fn read(self, from: &mut Decoder<'_>) -> Result<Self, BadBytes> {
        let wait = Self { level_ns: from.f64()?, over: from.flag("wait")?, ..self };
        // A full one is over, an empty one is not, and one that is both because nothing is waited for is over.
        let right = if wait.level_ns == wait.full_ns { wait.over } else { wait.level_ns > 0.0 || !wait.over };
        if !(right && (0.0..=wait.full_ns).contains(&wait.level_ns)) {
            return Err(BadBytes::Value("wait"));
        }
        Ok(wait)
    }

    /// As new.
    pub(super) fn restart(&mut self) {
        self.level_ns = 0.0;
        self.over = self.full_ns == 0.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_a_wait_can_be_is_read() {
        let read = |level_ns: f64, over: bool, raise_delay_s: f64| {
            // A version, a number, a flag and a checksum.
            let mut to = Encoder::<14>::new(1);
            to.f64(level_ns);
            to.flag(over);
            Wait::new(raise_delay_s, 10.0).read(&mut Decoder::new(&to.finish(), 14, 1).unwrap()).is_ok()
        };
        // Of three seconds: empty is not over, full is, between both are.
        assert!(read(0.0, false, 3.0) && !read(0.0, true, 3.0));
        assert!(read(3e9, true, 3.0) && !read(3e9, false, 3.0));
        assert!(read(1e9, false, 3.0) && read(1e9, true, 3.0));
        for level_ns in [-1.0, 3e9 + 1.0, f64::NAN, f64::INFINITY] {
            assert!(!read(level_ns, false, 3.0) && !read(level_ns, true, 3.0), "{level_ns}");
        }
        // Of no time: over, always.
        assert!(read(0.0, true, 0.0) && !read(0.0, false, 0.0));
    }

    /// Every way to be in and out for ten seconds, counted in whole halves of a second: three seconds fill it, six empty it.
    #[test]
    fn a_wait_is_over_from_full_to_empty() {
        for pattern in 0..1_u32 << 10 {
            let mut wait = Wait::new(3.0, 6.0);
            let (mut halves, mut over) = (0_i32, false);
            for second in 0..10 {
                let inside = pattern >> second & 1 == 1;
                wait.pass(1e9, inside);
                halves = if inside { halves - 1 } else { halves + 2 }.clamp(0, 6);
                over = match halves {
                    6 => true,
                    0 => false,
                    _ => over,
                };
                let left_s = if over { 0.0 } else { 0.5 * f64::from(6 - halves) };
                assert_eq!((wait.is_over(), wait.is_empty(), wait.left_s()), (over, halves == 0, left_s), "{pattern:b} {second}");
            }
            wait.restart();
            assert_eq!((wait.is_over(), wait.is_empty(), wait.left_s()), (false, true, 3.0));
        }
    }

    /// Where nothing is waited for it is over, always; where calm is not waited for an instant inside empties it.
    #[test]
    fn a_wait_of_no_time_is_over_and_calm_of_no_time_empties() {
        let mut wait = Wait::new(0.0, 10.0);
        for inside in [true, false, true, true] {
            wait.pass(1e9, inside);
            assert!(wait.is_over() && wait.is_empty() && wait.left_s() == 0.0);
        }
        let mut wait = Wait::new(3.0, 0.0);
        wait.pass(3e9, false);
        assert!(wait.is_over());
        wait.pass(1.0, true);
        assert!(wait.is_empty() && !wait.is_over() && wait.left_s() == 3.0);
    }
}
