//! What declared faults make of the measurements of the satellite receiver after it has made them.

use super::faults::{ReceiverFault, SensorFault};
use crate::trajectory::Motion;
use navbound_core::quantity::{GpsTime, Metres};
use navbound_core::signal::{Aiding, SatelliteRange, TimedAiding};
use std::collections::VecDeque;

/// Rows that one becomes where a receiver repeats itself.
const COPIES: usize = 20;

/// The faults of a receiver under way.
pub(crate) struct ReceiverFaults {
    faults: Vec<SensorFault>,
    /// Motions of the last samples, as many as the longest delay needs.
    past: VecDeque<(f64, Motion)>,
    longest_s: f64,
    /// What was delivered last.
    last: Vec<TimedAiding>,
}

impl ReceiverFaults {
    pub(crate) fn new(faults: &[SensorFault]) -> Self {
        let own = |f: &&SensorFault| {
            use SensorFault::{ReceiverDelay, ReceiverSigma, ReceiverTrouble};
            matches!(f, ReceiverTrouble { .. } | ReceiverDelay { .. } | ReceiverSigma { .. })
        };
        let longest_s = faults.iter().filter_map(|f| f.delay_s(f.window().start)).fold(0.0, f64::max);
        Self { faults: faults.iter().filter(own).cloned().collect(), past: VecDeque::new(), longest_s, last: Vec::new() }
    }

    /// The motion at a sample, kept for as long as a delay may ask for it.
    pub(crate) fn follow(&mut self, time_s: f64, motion: &Motion) {
        if self.longest_s > 0.0 {
            self.past.push_back((time_s, *motion));
            while self.past.len() > 1 && self.past[1].0 <= time_s - self.longest_s + 1e-9 {
                self.past.pop_front();
            }
        }
    }

    /// Time and motion of what the receiver measures now.
    pub(crate) fn measured(&self, time_s: f64, motion: &Motion) -> (f64, Motion) {
        let delay_s: f64 = self.faults.iter().filter_map(|f| f.delay_s(time_s)).sum();
        let then = self.past.iter().find(|(t, _)| *t >= time_s - delay_s - 1e-9).filter(|_| delay_s > 0.0);
        then.map_or((time_s, *motion), |(t, m)| (*t, *m))
    }

    /// What is delivered of a measurement that was tagged with its time.
    pub(crate) fn deliver(&mut self, time_s: f64, time: GpsTime, measured: &mut Vec<TimedAiding>) {
        if self.faults.is_empty() {
            return;
        }
        measured.iter_mut().for_each(|m| m.time = time);
        for fault in &self.faults {
            if let (SensorFault::ReceiverSigma { factor, .. }, Some(_)) = (fault, fault.since(time_s)) {
                ranges(measured).for_each(|m| declare(m, *factor));
            }
        }
        match self.faults.iter().find_map(|f| f.receiver(time_s)) {
            Some(ReceiverFault::Frozen) if !self.last.is_empty() => {
                measured.clone_from(&self.last);
                measured.iter_mut().for_each(|m| m.time = time);
            }
            Some(ReceiverFault::Repeated) => *measured = measured.iter().flat_map(|m| [*m; COPIES]).collect(),
            Some(ReceiverFault::OneName) => {
                let mut first = None;
                ranges(measured).for_each(|m| m.satellite = *first.get_or_insert(m.satellite));
            }
            Some(ReceiverFault::RatesReversed) => {
                ranges(measured).for_each(|m| m.rate_mps = m.rate_mps.map(|(rate, sigma)| (-rate, sigma)));
            }
            Some(ReceiverFault::Frozen) | None => {}
        }
        self.last.clone_from(measured);
    }
}

fn ranges(measured: &mut [TimedAiding]) -> impl Iterator<Item = &mut SatelliteRange> {
    measured.iter_mut().filter_map(|m| match &mut m.aiding {
        Aiding::Satellite(range) => Some(range),
        _ => None,
    })
}

fn declare(m: &mut SatelliteRange, factor: f64) {
    let times = |sigma: Metres| Metres::new(sigma.m() * factor);
    (m.sigma_white, m.sigma_correlated, m.sigma_first) = (times(m.sigma_white), times(m.sigma_correlated), times(m.sigma_first));
    m.rate_mps = m.rate_mps.map(|(rate, sigma)| (rate, sigma * factor));
}
