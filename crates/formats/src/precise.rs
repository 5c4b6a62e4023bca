//! What orbit and clock files of analysis centres hold, merged.

use crate::refusal::Refusal;
use navbound_core::geometry::broadcast::SatelliteState;
use navbound_core::geometry::precise::{ClockNode, OrbitNode, state};
use navbound_core::quantity::{GpsTime, Unavailable};
use navbound_core::signal::{Constellation, SatelliteId};
use std::collections::{BTreeMap, BTreeSet};

/// Tabulated orbits and clocks of satellites' mass centres; times sorted, each instant once.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Precise {
    /// Positions from orbit files.
    pub orbits: BTreeMap<SatelliteId, Vec<OrbitNode>>,
    /// Clocks beside them.
    pub orbit_clocks: BTreeMap<SatelliteId, Vec<ClockNode>>,
    /// Clocks from clock files, denser; where there are any, [`Precise::orbit_clocks`] are not used.
    pub clocks: BTreeMap<SatelliteId, Vec<ClockNode>>,
    /// Reference frames as the orbit files name them.
    pub frames: BTreeSet<String>,
    /// Analysis centres as the files name them.
    pub agencies: BTreeSet<String>,
    /// Lines of kinds that are not used, by kind, counted.
    pub skipped: BTreeMap<String, usize>,
    /// Lines that could not be read.
    pub refused: Vec<Refusal>,
}

impl Precise {
    /// These tables and those of another file. Where both hold an instant (the midnight between two days) the first one's value stands.
    pub fn merge(&mut self, other: Self) {
        for (satellite, nodes) in other.orbits {
            self.orbits.entry(satellite).or_default().extend(nodes);
        }
        for (mine, theirs) in [(&mut self.orbit_clocks, other.orbit_clocks), (&mut self.clocks, other.clocks)] {
            for (satellite, nodes) in theirs {
                mine.entry(satellite).or_default().extend(nodes);
            }
        }
        self.frames.extend(other.frames);
        self.agencies.extend(other.agencies);
        for (kind, n) in other.skipped {
            *self.skipped.entry(kind).or_default() += n;
        }
        self.refused.extend(other.refused);
        self.sort();
    }

    pub(crate) fn sort(&mut self) {
        for nodes in self.orbits.values_mut() {
            nodes.sort_by_key(|n| n.time);
            nodes.dedup_by_key(|n| n.time);
        }
        for nodes in self.orbit_clocks.values_mut().chain(self.clocks.values_mut()) {
            nodes.sort_by_key(|n| n.time);
            nodes.dedup_by_key(|n| n.time);
        }
    }

    pub(crate) fn skip(&mut self, kind: &str) {
        *self.skipped.entry(kind.to_owned()).or_default() += 1;
    }

    /// The clock tables that count: the dense ones where there are any.
    pub fn clock_tables(&self) -> &BTreeMap<SatelliteId, Vec<ClockNode>> {
        if self.clocks.is_empty() { &self.orbit_clocks } else { &self.clocks }
    }

    /// Usual step of the clock tables \[s\]: the median over all; `None` without two records of one satellite.
    pub fn clock_step_s(&self) -> Option<f64> {
        let tables = self.clock_tables().values();
        let mut steps: Vec<i64> = tables.flat_map(|t| t.windows(2).map(|w| w[1].time.nanoseconds() - w[0].time.nanoseconds())).collect();
        let middle = steps.len() / 2;
        (!steps.is_empty()).then(|| *steps.select_nth_unstable(middle).1 as f64 * 1e-9)
    }

    /// The tables of every satellite, found without a search.
    pub fn tables(&self) -> Tables<'_> {
        let mut of = vec![(&[][..], &[][..]); Constellation::ALL.len() * usize::from(u8::MAX)];
        let clocks = self.clock_tables();
        for (satellite, orbit) in &self.orbits {
            of[slot(*satellite)] = (orbit.as_slice(), clocks.get(satellite).map_or(&[][..], Vec::as_slice));
        }
        // One lost record is not bridged: half a step beyond the usual one is the limit.
        Tables { of, longest_clock_gap_s: 1.5 * self.clock_step_s().unwrap_or(0.0) }
    }
}

fn slot(satellite: SatelliteId) -> usize {
    satellite.constellation.index() * usize::from(u8::MAX) + usize::from(satellite.number.saturating_sub(1))
}

/// Orbit and clock tables by satellite.
pub struct Tables<'a> {
    of: Vec<(&'a [OrbitNode], &'a [ClockNode])>,
    longest_clock_gap_s: f64,
}

impl Tables<'_> {
    /// Mass centre and clock of a satellite.
    ///
    /// # Errors
    /// [`Unavailable`] as [`state`], and for a satellite without tables.
    pub fn state(&self, satellite: SatelliteId, time: GpsTime) -> Result<SatelliteState, Unavailable> {
        let (orbit, clock) = self.of[slot(satellite)];
        state(orbit, clock, self.longest_clock_gap_s, time)
    }
}

/// Add a record of a file; false where the last one of the same instant is another. Nothing tells which of two is right: that one goes too.
pub(crate) fn put<N: PartialEq>(nodes: &mut Vec<N>, node: N, time: impl Fn(&N) -> GpsTime) -> bool {
    match nodes.last() {
        Some(last) if time(last) == time(&node) => {
            let same = *last == node;
            if !same {
                nodes.pop();
            }
            same
        }
        _ => {
            nodes.push(node);
            true
        }
    }
}
