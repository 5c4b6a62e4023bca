//! The judge of one aircraft as bytes, so that a process that was stopped goes on where it was.
//!
//! Settings are written with the state, as the monitor does it: a judge that is read decides as the one that was written.

use super::{Judge, Settings};
use crate::bound::{Alerting, IntegrityComparison};
use crate::monitor::rnp::Monitor;
use crate::monitor::state::{MAX_LEVELS, StateTable};
use crate::quantity::encoding::{BadBytes, Decoder, Encoder};
use crate::quantity::{Metres, Risk};

/// Version of the layout below. A change of the layout or of what a field means is another version.
const VERSION: u8 = 1;
/// Room for the id of a method, zero-padded.
const ID: usize = 32;
/// Version; method; two risks; number of levels and their boundaries; both flags of levels; the monitor; checksum.
const BYTES: usize = 1 + ID + 2 * 8 + 1 + MAX_LEVELS * 8 + 2 + Monitor::BYTES + 4;

fn write_states<const N: usize>(states: Option<&StateTable>, to: &mut Encoder<N>) {
    let boundaries = states.map_or(&[][..], StateTable::boundary_m);
    // At most twelve, so the number fits.
    to.raw(&[boundaries.len() as u8]);
    boundaries.iter().chain(&[0.0; MAX_LEVELS]).take(MAX_LEVELS).for_each(|boundary_m| to.f64(*boundary_m));
}

fn read_states(from: &mut Decoder<'_>) -> Result<Option<StateTable>, BadBytes> {
    let [n] = from.raw()?;
    let mut boundaries = [Metres::default(); MAX_LEVELS];
    for boundary in &mut boundaries {
        *boundary = from.metres()?;
    }
    let Some(levels) = boundaries.get(..usize::from(n)) else { return Err(BadBytes::Value("levels")) };
    if levels.is_empty() {
        return Ok(None);
    }
    StateTable::new(levels).map(Some).map_err(|refused| BadBytes::Value(refused.argument))
}

fn read_method(from: &mut Decoder<'_>) -> Result<Alerting, BadBytes> {
    let id: [u8; ID] = from.raw()?;
    let end = id.iter().position(|byte| *byte == 0).unwrap_or(ID);
    let id = core::str::from_utf8(&id[..end]).ok();
    id.and_then(|id| Alerting::of(id).ok()).ok_or(BadBytes::Value("method"))
}

fn read_risk(from: &mut Decoder<'_>, field: &'static str) -> Result<Risk, BadBytes> {
    Risk::new(from.f64()?).map_err(|_| BadBytes::Value(field))
}

impl Judge {
    /// Length of the state as bytes.
    pub const BYTES: usize = BYTES;

    /// The whole state, settings included: a judge that is read from it takes the same steps, to the bit.
    pub fn to_bytes(&self) -> [u8; BYTES] {
        let mut to = Encoder::new(VERSION);
        let mut id = [0; ID];
        for (slot, byte) in id.iter_mut().zip(self.settings.method.method().id.bytes()) {
            *slot = byte;
        }
        to.raw(&id);
        to.f64(self.settings.accuracy.q());
        to.f64(self.settings.integrity.q());
        write_states(self.settings.states.as_ref(), &mut to);
        to.flag(self.settings.with_levels);
        to.flag(self.comparison.level_expected());
        to.raw(&self.monitor.to_bytes());
        to.finish()
    }

    /// The judge of a state.
    ///
    /// # Errors
    /// [`BadBytes`] for another length or version, a wrong checksum, a method that may not feed an alert, and values that a judge cannot
    /// have.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, BadBytes> {
        let mut from = Decoder::new(bytes, BYTES, VERSION)?;
        let (method, accuracy, integrity) =
            (read_method(&mut from)?, read_risk(&mut from, "risk_accuracy")?, read_risk(&mut from, "risk_integrity")?);
        let states = read_states(&mut from)?;
        let (with_levels, level_expected) = (from.flag("with_levels")?, from.flag("level_expected")?);
        let monitor = Monitor::from_bytes(&from.raw::<{ Monitor::BYTES }>()?)?;
        from.finish()?;
        if with_levels && !level_expected {
            return Err(BadBytes::Value("level_expected"));
        }
        let settings = Settings { method, accuracy, integrity, states, monitor: *monitor.settings(), with_levels };
        let comparison = if level_expected { IntegrityComparison::with_levels() } else { IntegrityComparison::default() };
        let judge = Self { settings, comparison, monitor };
        // One state has one form: what is padded is zero.
        if judge.to_bytes() != *bytes {
            return Err(BadBytes::Value("an absent field"));
        }
        Ok(judge)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_id_of_every_method_that_may_alert_has_room() {
        let longest = Alerting::all().map(|m| m.method().id.len()).max();
        assert!(longest.is_some_and(|n| n > 0 && n <= ID), "{longest:?}");
    }
}
