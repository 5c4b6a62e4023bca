//! The RNP monitor as bytes, so that a process that was stopped goes on where it was.
//!
//! Settings are written with the state: a state belongs to its settings, and what was derived from them is derived again.

use super::clock::Clock;
use super::counters::Counters;
use super::latch::{Event, Kind, Latch};
use super::rnp::Monitor;
use super::settings::{Chain, Settings};
use crate::quantity::encoding::{BadBytes, Decoder, Encoder};

/// Version of the layout below. A change of the layout or of what a field means is another version.
const VERSION: u8 = 1;
/// Ten numbers of the settings; clock; two latches, the loss, the flag; counters; version and checksum.
const BYTES: usize = 1 + 10 * 8 + (3 * 9 + 4 + 8) + 2 * Latch::BYTES + Event::BYTES + 1 + Counters::WORDS * 8 + 4;

impl Settings {
    fn write<const N: usize>(&self, to: &mut Encoder<N>) {
        let c = &self.chain;
        let times = [c.sample_period_s, c.sensor_latency_s, c.filter_s, c.computing_s, c.display_s, c.time_to_alert_s];
        times.into_iter().chain([self.raise_delay_s, self.clear_delay_s, self.clear_ratio, self.stale_after_s]).for_each(|x| to.f64(x));
    }

    fn read(from: &mut Decoder<'_>) -> Result<Self, BadBytes> {
        let chain = Chain {
            sample_period_s: from.f64()?,
            sensor_latency_s: from.f64()?,
            filter_s: from.f64()?,
            computing_s: from.f64()?,
            display_s: from.f64()?,
            time_to_alert_s: from.f64()?,
        };
        let settings =
            Self { chain, raise_delay_s: from.f64()?, clear_delay_s: from.f64()?, clear_ratio: from.f64()?, stale_after_s: from.f64()? };
        settings.checked().map_err(|refused| BadBytes::Value(refused.argument))
    }
}

impl Counters {
    fn write<const N: usize>(&self, to: &mut Encoder<N>) {
        self.words().into_iter().for_each(|word| to.u64(word));
    }

    fn read(from: &mut Decoder<'_>) -> Result<Self, BadBytes> {
        let mut words = [0; Self::WORDS];
        for word in &mut words {
            *word = from.u64()?;
        }
        Self::from_words(words)
    }
}

impl Monitor {
    /// Length of the state as bytes.
    pub const BYTES: usize = BYTES;

    /// The whole state: a monitor that is read from it takes the same steps, to the bit.
    pub fn to_bytes(&self) -> [u8; BYTES] {
        let mut to = Encoder::new(VERSION);
        self.settings.write(&mut to);
        self.clock.write(&mut to);
        self.caution.write(&mut to);
        self.warning.write(&mut to);
        Event::write(self.loss.as_ref(), &mut to);
        to.flag(self.begun);
        self.counters.write(&mut to);
        to.finish()
    }

    /// The monitor of a state.
    ///
    /// # Errors
    /// [`BadBytes`] for another length or version, a wrong checksum, and values that a monitor cannot have.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, BadBytes> {
        let mut from = Decoder::new(bytes, BYTES, VERSION)?;
        let settings = Settings::read(&mut from)?;
        let new = Self::new(settings).map_err(|refused| BadBytes::Value(refused.argument))?;
        let monitor = Self {
            clock: Clock::read(&mut from, &settings)?,
            caution: new.caution.read(&mut from)?,
            warning: new.warning.read(&mut from)?,
            loss: Event::read(&mut from, Kind::Unavailable)?,
            begun: from.flag("begun")?,
            counters: Counters::read(&mut from)?,
            ..new
        };
        from.finish()?;
        // What was judged came at a time.
        if monitor.begun && monitor.clock.last().is_none() {
            return Err(BadBytes::Value("begun"));
        }
        // One state has one form: the fields of what is absent are those that are written.
        if monitor.to_bytes() != *bytes {
            return Err(BadBytes::Value("an absent field"));
        }
        Ok(monitor)
    }
}
