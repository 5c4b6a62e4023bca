//! What the RNP monitor saw and did, in numbers.

use crate::quantity::encoding::BadBytes;

/// What happened so far.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Counters {
    /// Epochs judged.
    pub n_accepted: u64,
    /// Epochs dropped with the time of the one before.
    pub n_duplicate: u64,
    /// Epochs dropped as earlier than the one before.
    pub n_late: u64,
    /// Times the clock was seen to be set back.
    pub n_clock_set_back: u64,
    /// Silences longer than the permitted one.
    pub n_gaps: u64,
    /// Judged epochs without a usable bound.
    pub n_unusable: u64,
    /// Usable epochs with a bound that is not a number or an RNP value outside (0, inf).
    pub n_nan: u64,
    /// Exceedances that ended before the crew was alerted.
    pub n_withdrawn: u64,
    /// Cautions raised.
    pub n_cautions: u64,
    /// Warnings raised.
    pub n_warnings: u64,
    /// Losses of monitoring.
    pub n_unavailable: u64,
    /// Time under watch, gaps left out \[s\].
    pub watched_s: f64,
}

impl Counters {
    /// Numbers of a state: eleven counts and a time.
    pub const WORDS: usize = 12;

    /// The counts, and the bits of the time behind them.
    pub fn words(&self) -> [u64; Self::WORDS] {
        let Self {
            n_accepted,
            n_duplicate,
            n_late,
            n_clock_set_back,
            n_gaps,
            n_unusable,
            n_nan,
            n_withdrawn,
            n_cautions,
            n_warnings,
            n_unavailable,
            watched_s,
        } = *self;
        let time = watched_s.to_bits();
        [
            n_accepted,
            n_duplicate,
            n_late,
            n_clock_set_back,
            n_gaps,
            n_unusable,
            n_nan,
            n_withdrawn,
            n_cautions,
            n_warnings,
            n_unavailable,
            time,
        ]
    }

    /// The counters of [`Self::words`].
    ///
    /// # Errors
    /// A time that is negative or not finite.
    pub fn from_words(words: [u64; Self::WORDS]) -> Result<Self, BadBytes> {
        let [
            n_accepted,
            n_duplicate,
            n_late,
            n_clock_set_back,
            n_gaps,
            n_unusable,
            n_nan,
            n_withdrawn,
            n_cautions,
            n_warnings,
            n_unavailable,
            time,
        ] = words;
        let watched_s = f64::from_bits(time);
        if !(watched_s >= 0.0 && watched_s.is_finite()) {
            return Err(BadBytes::Value("watched_s"));
        }
        Ok(Self {
            n_accepted,
            n_duplicate,
            n_late,
            n_clock_set_back,
            n_gaps,
            n_unusable,
            n_nan,
            n_withdrawn,
            n_cautions,
            n_warnings,
            n_unavailable,
            watched_s,
        })
    }

    /// Cautions and warnings per hour under watch: under nominal conditions the rate of false alerts, the other side of integrity.
    /// NaN when nothing was watched.
    pub fn alerts_per_hour(&self) -> f64 {
        (self.n_cautions + self.n_warnings) as f64 / self.watched_s * 3600.0
    }

    /// Both together, e.g. of two tracks.
    pub fn merged(&self, other: &Self) -> Self {
        Self {
            n_accepted: self.n_accepted + other.n_accepted,
            n_duplicate: self.n_duplicate + other.n_duplicate,
            n_late: self.n_late + other.n_late,
            n_clock_set_back: self.n_clock_set_back + other.n_clock_set_back,
            n_gaps: self.n_gaps + other.n_gaps,
            n_unusable: self.n_unusable + other.n_unusable,
            n_nan: self.n_nan + other.n_nan,
            n_withdrawn: self.n_withdrawn + other.n_withdrawn,
            n_cautions: self.n_cautions + other.n_cautions,
            n_warnings: self.n_warnings + other.n_warnings,
            n_unavailable: self.n_unavailable + other.n_unavailable,
            watched_s: self.watched_s + other.watched_s,
        }
    }
}
