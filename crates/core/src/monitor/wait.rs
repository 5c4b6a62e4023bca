//! How long a condition must last before it is an alert, when it comes and goes.

/// Time outside, less a share of the time inside: full after `raise_delay_s` outside in one piece, empty again after `clear_delay_s`
/// inside.
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
}

impl Wait {
    pub(super) fn new(raise_delay_s: f64, clear_delay_s: f64) -> Self {
        let drain = if clear_delay_s > 0.0 { raise_delay_s / clear_delay_s } else { f64::INFINITY };
        Self { level_ns: 0.0, full_ns: raise_delay_s * 1e9, drain }
    }

    /// `elapsed_ns` more than zero have passed.
    pub(super) fn pass(&mut self, elapsed_ns: f64, known_inside: bool) {
        self.level_ns =
            if known_inside { (self.level_ns - self.drain * elapsed_ns).max(0.0) } else { (self.level_ns + elapsed_ns).min(self.full_ns) };
    }

    pub(super) fn is_full(&self) -> bool {
        self.level_ns >= self.full_ns
    }

    pub(super) fn is_empty(&self) -> bool {
        self.level_ns == 0.0
    }

    pub(super) fn empty(&mut self) {
        self.level_ns = 0.0;
    }
}
