//! The judge of one aircraft as bytes: its monitor, and whether a protection level is due.

use super::{Judge, Settings};
use crate::bound::IntegrityComparison;
use crate::monitor::rnp::Monitor;
use crate::quantity::encoding::BadBytes;

/// The monitor's bytes, with a checksum of their own, and a flag.
const BYTES: usize = Monitor::BYTES + 1;

impl Judge {
    /// Length of the state as bytes.
    pub const BYTES: usize = BYTES;

    /// The whole state beside the settings: a judge of the same settings that is read from it takes the same steps, to the bit.
    pub fn to_bytes(&self) -> [u8; BYTES] {
        let mut bytes = [u8::from(self.comparison.expects_levels()); BYTES];
        if let Some(of_monitor) = bytes.first_chunk_mut() {
            *of_monitor = self.monitor.to_bytes();
        }
        bytes
    }

    /// The judge of a state and of the settings that it had.
    ///
    /// # Errors
    /// [`BadBytes`] for what is no state, and for the state of a monitor that was set otherwise.
    pub fn from_bytes(settings: Settings, bytes: &[u8]) -> Result<Self, BadBytes> {
        let (expected, of_monitor) = bytes.split_last().ok_or(BadBytes::Length)?;
        let monitor = Monitor::from_bytes(of_monitor)?;
        if *monitor.settings() != settings.monitor {
            return Err(BadBytes::Value("settings"));
        }
        let comparison = match expected {
            0 if !settings.with_levels => IntegrityComparison::default(),
            1 => IntegrityComparison::with_levels(),
            _ => return Err(BadBytes::Value("level_expected")),
        };
        Ok(Self { settings, comparison, monitor })
    }
}
