//! Measurements epoch by epoch to the table of an observation file.

use crate::rinex::Observations;
use navbound_core::quantity::GpsTime;
use navbound_core::signal::{Constellation, SatelliteId};
use std::collections::{BTreeMap, BTreeSet};

/// Loss of lock since the last epoch, and half a cycle not resolved: indicator bits 0 and 1 of RINEX, in the upper four bits here.
pub(super) const LOST: u8 = 0x10;
pub(super) const HALF_CYCLE: u8 = 0x20;

/// One signal of one satellite; NaN where a value is absent.
#[derive(Debug, Clone, Copy)]
pub(super) struct Measurement {
    pub(super) satellite: SatelliteId,
    /// Band and attribute of RINEX 3.
    pub(super) signal: [u8; 2],
    pub(super) range_m: f64,
    pub(super) phase_cycles: f64,
    pub(super) doppler_hz: f64,
    pub(super) cn0_dbhz: f64,
    /// [`LOST`], [`HALF_CYCLE`].
    pub(super) indicator: u8,
}

/// What is collected of a log.
#[derive(Default)]
pub(super) struct Table {
    /// With the number of their frame.
    epochs: Vec<(GpsTime, Vec<Measurement>, usize)>,
    /// Time locked at the last epoch \[ms\], by satellite and signal.
    locked_ms: BTreeMap<(SatelliteId, [u8; 2]), u32>,
    /// Frame in hand: number and first byte.
    frame: (usize, usize),
    /// Refusals and what is skipped, from the beginning.
    notes: Observations,
}

impl Table {
    pub(super) fn begin_frame(&mut self, number: usize, at: usize) {
        self.frame = (number, at);
    }
    pub(super) fn refuse(&mut self, field: &str, reason: &str) {
        self.notes.refuse(self.frame.0, field, reason, format!("at byte {}", self.frame.1).as_bytes());
    }
    /// A frame of measurements that cannot be read.
    pub(super) fn lose(&mut self, reason: &str) {
        self.notes.lose(self.frame.0, reason, format!("at byte {}", self.frame.1).as_bytes());
    }
    pub(super) fn skip(&mut self, kind: &str) {
        self.notes.skip(kind, 1);
    }
    /// Bytes of the log that belong to no frame: of one whose first bytes are lost nothing else is left.
    pub(super) fn outside(&mut self, n_bytes: usize) {
        if n_bytes > 0 {
            self.notes.skip("bytes outside frames: text, other protocols, or damage", n_bytes);
        }
    }
    /// A shorter time of lock than at the epoch before, or none, means that the count of cycles began anew.
    pub(super) fn lost(&mut self, satellite: SatelliteId, signal: [u8; 2], locked_ms: u32) -> u8 {
        let before = self.locked_ms.insert((satellite, signal), locked_ms);
        if locked_ms == 0 || before.is_some_and(|b| locked_ms < b) { LOST } else { 0 }
    }
    pub(super) fn epoch(&mut self, time: GpsTime, measurements: Vec<Measurement>) {
        self.epochs.push((time, measurements, self.frame.0));
    }
    /// Time of the last epoch.
    pub(super) fn time(&self) -> Option<GpsTime> {
        self.epochs.last().map(|e| e.0)
    }

    pub(super) fn finish(self) -> Observations {
        let mut signals: [BTreeSet<[u8; 2]>; Constellation::ALL.len()] = Default::default();
        for m in self.epochs.iter().flat_map(|e| &e.1) {
            signals[m.satellite.constellation.index()].insert(m.signal);
        }
        let mut o = self.notes;
        for (codes, own) in o.codes.iter_mut().zip(&signals) {
            *codes = own.iter().flat_map(|[band, attribute]| b"CLDS".map(|kind| [kind, *band, *attribute])).collect();
        }
        for (time, measurements, frame) in &self.epochs {
            let mut satellites: Vec<SatelliteId> = measurements.iter().map(|m| m.satellite).collect();
            satellites.sort_unstable();
            satellites.dedup();
            for satellite in satellites {
                o.begin_satellite(satellite);
                for signal in &signals[satellite.constellation.index()] {
                    let own = measurements.iter().find(|m| m.satellite == satellite && m.signal == *signal);
                    let values = own.map_or([f64::NAN; 4], |m| [m.range_m, m.phase_cycles, m.doppler_hz, m.cn0_dbhz]);
                    for (k, value) in values.into_iter().enumerate() {
                        // Indicators belong to the phase.
                        o.push(value, if k == 1 { own.map_or(0, |m| m.indicator) } else { 0 });
                    }
                }
            }
            o.end_epoch(*time, false, f64::NAN, *frame);
        }
        o.believe();
        o
    }
}
