//! Past fast corrections of one satellite, from which its range rate is taken.

use super::fast::IODF_ALERT;
use crate::quantity::GpsTime;

/// One fast correction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FastCorrection {
    /// Range correction \[m\].
    pub correction_m: f64,
    /// Issue, 3 in an alert.
    pub iodf: u8,
    /// Time of applicability: the first bit of its message.
    pub applies: GpsTime,
    /// End of its message.
    pub received: GpsTime,
}

/// Enough for half of the longest time-out (60 s) at one update every 6 s.
const LENGTH: usize = 12;

/// Newest first.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct History([Option<FastCorrection>; LENGTH]);

impl History {
    pub(super) fn push(&mut self, correction: FastCorrection) {
        self.0.rotate_right(1);
        self.0[0] = Some(correction);
    }
    pub(super) fn newest(&self) -> Option<FastCorrection> {
        self.0[0]
    }
    /// The correction that the newest one's rate is taken from (DO-229D A.4.4.3; standard): the one before, or, in an alert, the one
    /// whose distance is nearest to half of the time-out.
    pub(super) fn earlier(&self, time_out_s: u32) -> Option<FastCorrection> {
        let newest = self.newest()?;
        let before = || self.0.iter().skip(1).flatten().copied();
        let last = before().next()?;
        if newest.iodf != IODF_ALERT && last.iodf != IODF_ALERT {
            return Some(last);
        }
        let miss = |f: &FastCorrection| (newest.applies.seconds_since(f.applies) - 0.5 * f64::from(time_out_s)).abs();
        before().min_by(|a, b| miss(a).total_cmp(&miss(b)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn correction(at_s: i64, iodf: u8) -> FastCorrection {
        let applies = GpsTime::from_nanoseconds(at_s * 1_000_000_000);
        FastCorrection { correction_m: at_s as f64, iodf, applies, received: applies }
    }

    #[test]
    fn a_rate_comes_from_the_last_two_corrections_and_in_an_alert_from_half_the_time_out() {
        let mut history = History::default();
        for (i, at) in (0..60).step_by(6).enumerate() {
            history.push(correction(at, (i % 3) as u8));
        }
        assert_eq!(history.earlier(30).unwrap().correction_m, 48.0);
        history.push(correction(58, IODF_ALERT));
        assert_eq!(history.earlier(30).unwrap().correction_m, 42.0);
        assert!(History::default().earlier(30).is_none());
    }
}
