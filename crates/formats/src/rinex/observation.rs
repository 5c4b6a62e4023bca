//! Observation files, plain and compact, to one table.

use super::header::{Lines, label};
use super::number::text;
use super::{compact, heading, plain};
use crate::order::most_rising;
use crate::refusal::{Refusal, Unreadable};
use navbound_core::quantity::{GpsTime, OutOfDomain};
use navbound_core::signal::{Constellation, SatelliteId};
use std::collections::BTreeMap;
use std::ops::Range;

/// Refusals kept in full; the others are counted.
const REFUSALS_KEPT: usize = 1000;
/// Largest pseudorange of a receiver \[m\]: light needs more than three seconds for it. Satellites are at most a seventh of a second away, and
/// no receiver's clock that measures is that wrong. Provenance: ours.
const LONGEST_RANGE_M: f64 = 1e9;
const BACKWARDS: &str = "the time runs backwards against the epochs around it";
const REPEATED: &str = "the epoch stands twice";
const CONTRADICTED: &str = "epochs of one time contradict each other";
const LISTED_TWICE: &str = "the satellite stands twice in the epoch; once is used";
const LISTED_AGAINST: &str = "the satellite stands twice in the epoch with other values; it is not used";
const SYSTEMS: usize = Constellation::ALL.len();

/// A code of RINEX 3: kind (C, L, D, S), band, attribute.
pub type Code = [u8; 3];

/// What a receiver recorded: epochs, in each the satellites seen, for each satellite one value a code of its constellation.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Observations {
    /// Version of the format.
    pub version: f64,
    /// Name of the station or vehicle.
    pub marker: String,
    /// Receiver and antenna as the header names them.
    pub receiver: String,
    /// Antenna type.
    pub antenna: String,
    /// Approximate position of the marker, Earth-fixed \[m\]; absent where the header has none or zeros.
    pub approximate_m: Option<[f64; 3]>,
    /// Antenna reference point from the marker: up, east, north \[m\].
    pub antenna_delta_m: [f64; 3],
    /// Nominal time between epochs \[s\], where the header says.
    pub interval_s: Option<f64>,
    /// Codes of each constellation, in the order of [`Constellation::ALL`]; version 2 names translated.
    pub codes: [Vec<Code>; SYSTEMS],
    /// Time of each epoch.
    pub time: Vec<GpsTime>,
    /// Power failure since the epoch before (flag 1).
    pub interrupted: Vec<bool>,
    /// Receiver clock offset already applied by the receiver \[s\], NaN where not given.
    pub clock_offset_s: Vec<f64>,
    /// Satellites, epoch after epoch.
    pub satellite: Vec<SatelliteId>,
    /// Values, satellite after satellite: pseudoranges \[m\], phases \[cycles\], Doppler \[Hz\], strengths as the file has them; NaN where absent.
    pub value: Vec<f64>,
    /// Loss-of-lock indicator (upper) and strength (lower four bits) of each value.
    pub indicator: Vec<u8>,
    /// Satellites of systems that are not read, and event records, counted by kind.
    pub skipped: BTreeMap<String, usize>,
    /// The first 1000 things that could not be read.
    pub refused: Vec<Refusal>,
    /// How many there were.
    pub n_refused: usize,
    /// Epochs among them: records of measurements whose time or satellites cannot be read, or that contradict another. Of compact files
    /// those are counted whose beginning was read, not those up to the next fresh start.
    pub n_lost_epochs: usize,
    /// One past the last satellite of each epoch.
    last_satellite: Vec<usize>,
    /// First value of each satellite.
    first_value: Vec<usize>,
    /// Line, or frame of a log, in which each epoch ends.
    line: Vec<usize>,
}

/// Read an observation file, plain text or compact (see [`crate::packed::unpack`] for packed ones).
///
/// # Errors
/// [`Unreadable`] unless the header is that of an observation file of version 2, 3 or 4, plain or compact 1.0 or 3.x, and names the codes.
/// Epochs and values that cannot be read are put into `refused`, and the others stand.
pub fn read_observations(bytes: &[u8]) -> Result<Observations, Unreadable> {
    let mut lines = Lines::new(bytes);
    let first = lines.next().ok_or_else(|| Unreadable::whole("the file is empty"))?;
    let mut o = Observations::default();
    if label(first) == b"CRINEX VERS   / TYPE" {
        // The second line of a compact file names its writer.
        _ = lines.next();
        let head = lines.next().ok_or_else(|| Unreadable::at(2, "the file ends in its header"))?;
        let scale = heading::read(&mut lines, head, &mut o)?;
        let kind = match super::number::text(first, 0, 3).as_str() {
            "1.0" if o.version < 3.0 => compact::Kind::First,
            "3.0" | "3.1" if o.version >= 3.0 => compact::Kind::Third,
            other => return Err(Unreadable::at(1, format!("compact version '{other}' does not go with RINEX version {}", o.version))),
        };
        o.reserve(bytes.len() / 6);
        compact::read(lines, kind, &scale, &mut o);
        o.finish(&scale);
    } else {
        let scale = heading::read(&mut lines, first, &mut o)?;
        o.reserve(bytes.len() / 16);
        if o.version < 3.0 {
            plain::second(lines, &scale, &mut o)?
        } else {
            plain::third(lines, &scale, &mut o)
        }
        o.finish(&scale);
    }
    Ok(o)
}

impl Observations {
    /// Number of epochs.
    pub fn n_epochs(&self) -> usize {
        self.time.len()
    }
    /// Satellites of an epoch: positions in [`Observations::satellite`].
    pub fn satellites(&self, epoch: usize) -> Range<usize> {
        let first = if epoch == 0 { 0 } else { self.last_satellite[epoch - 1] };
        first..self.last_satellite[epoch]
    }
    /// Values of a satellite, in the order of its constellation's codes.
    pub fn values(&self, satellite: usize) -> &[f64] {
        &self.value[self.value_range(satellite)]
    }
    /// Positions of a satellite's values in [`Observations::value`].
    pub fn value_range(&self, satellite: usize) -> Range<usize> {
        let first = self.first_value[satellite];
        first..self.first_value.get(satellite + 1).copied().unwrap_or(self.value.len())
    }
    /// Position of a code among those of a constellation.
    pub fn column(&self, constellation: Constellation, code: &Code) -> Option<usize> {
        self.codes[constellation.index()].iter().position(|c| c == code)
    }

    /// Add an epoch: satellites with a value and an indicator for each of their codes.
    ///
    /// # Errors
    /// [`OutOfDomain`] unless every satellite has as many values as its constellation has codes, and the time is later than the last.
    pub fn add_epoch(&mut self, time: GpsTime, seen: &[(SatelliteId, Vec<(f64, u8)>)]) -> Result<(), OutOfDomain> {
        for (satellite, values) in seen {
            let codes = self.n_codes(satellite.constellation);
            if values.len() != codes {
                let domain = "as many as the constellation has codes";
                return Err(OutOfDomain { argument: "values", value: values.len() as f64, unit: "1", domain });
            }
        }
        if self.time.last().is_some_and(|last| *last >= time) {
            let (value, domain) = (time.nanoseconds() as f64, "later than the epoch before");
            return Err(OutOfDomain { argument: "time_ns", value, unit: "ns", domain });
        }
        for (satellite, values) in seen {
            self.begin_satellite(*satellite);
            for (value, indicator) in values {
                self.push(*value, *indicator);
            }
        }
        self.end_epoch(time, false, f64::NAN, self.time.len() + 1);
        Ok(())
    }

    pub(super) fn n_codes(&self, constellation: Constellation) -> usize {
        self.codes[constellation.index()].len()
    }
    pub(crate) fn begin_satellite(&mut self, satellite: SatelliteId) {
        self.satellite.push(satellite);
        self.first_value.push(self.value.len());
    }
    pub(crate) fn push(&mut self, value: f64, indicator: u8) {
        self.value.push(value);
        self.indicator.push(indicator);
    }
    pub(crate) fn end_epoch(&mut self, time: GpsTime, interrupted: bool, clock_offset_s: f64, line: usize) {
        self.time.push(time);
        self.line.push(line);
        self.interrupted.push(interrupted);
        self.clock_offset_s.push(clock_offset_s);
        self.last_satellite.push(self.satellite.len());
    }
    /// Forget the last epoch that ended: what follows shows that its lines were not its own.
    pub(super) fn take_back_epoch(&mut self) {
        self.time.pop();
        self.line.pop();
        self.interrupted.pop();
        self.clock_offset_s.pop();
        self.last_satellite.pop();
        self.abandon_epoch();
    }
    /// Forget the satellites of an epoch that did not end.
    pub(super) fn abandon_epoch(&mut self) {
        let keep = self.last_satellite.last().copied().unwrap_or(0);
        let values = self.first_value.get(keep).copied().unwrap_or(self.value.len());
        self.satellite.truncate(keep);
        self.first_value.truncate(keep);
        self.value.truncate(values);
        self.indicator.truncate(values);
    }
    pub(crate) fn skip(&mut self, kind: &str, n: usize) {
        *self.skipped.entry(kind.to_owned()).or_default() += n;
    }
    pub(crate) fn refuse(&mut self, line: usize, field: &str, reason: &str, bytes: &[u8]) {
        self.n_refused += 1;
        if self.refused.len() < REFUSALS_KEPT {
            let text = text(bytes, 0, 80);
            self.refused.push(Refusal { line, field: field.to_owned(), reason: reason.to_owned(), text });
        }
    }
    /// Refuse a whole epoch.
    pub(crate) fn lose(&mut self, line: usize, reason: &str, bytes: &[u8]) {
        self.n_lost_epochs += 1;
        self.refuse(line, "epoch", reason, bytes);
    }
    fn reserve(&mut self, values: usize) {
        self.value.reserve(values);
        self.indicator.reserve(values);
    }

    /// Drop what no receiver measures: epochs out of the order of time, a satellite that stands twice in one, pseudoranges that are none.
    /// Each is counted in `refused`.
    pub(crate) fn believe(&mut self) {
        self.drop_backward_epochs();
        self.drop_repeated_satellites();
        let mut epoch = 0;
        for k in 0..self.satellite.len() {
            while self.last_satellite.get(epoch).is_some_and(|last| *last <= k) {
                epoch += 1;
            }
            let line = self.line.get(epoch).copied().unwrap_or(0);
            let (system, first) = (self.satellite[k].constellation.index(), self.first_value[k]);
            for c in 0..self.value_range(k).len().min(self.codes[system].len()) {
                let (code, value) = (self.codes[system][c], self.value[first + c]);
                if code[0] == b'C' && value.abs() > LONGEST_RANGE_M {
                    let name = String::from_utf8_lossy(&code).into_owned();
                    self.refuse(line, &name, "no pseudorange of a receiver: beyond 1e9 m", format!("{value:.3}").as_bytes());
                    self.value[first + c] = f64::NAN;
                }
            }
        }
    }

    /// Keep the most epochs whose times increase: one that runs ahead is at fault itself, not all those after it.
    fn drop_backward_epochs(&mut self) {
        if self.time.is_sorted_by(|a, b| a < b) {
            return;
        }
        let mut wrong = vec![Some(BACKWARDS); self.time.len()];
        let in_order = most_rising(&self.time, false);
        for alike in in_order.chunk_by(|a, b| self.time[*a] == self.time[*b]) {
            let contradicted = alike.iter().any(|k| !self.repeats(alike[0], *k));
            alike.iter().for_each(|k| wrong[*k] = Some(if contradicted { CONTRADICTED } else { REPEATED }));
            if !contradicted {
                wrong[alike[0]] = None;
            }
        }
        for (epoch, reason) in wrong.iter().enumerate() {
            if let Some(reason) = reason {
                // One that repeats another is not lost.
                self.n_lost_epochs += usize::from(*reason != REPEATED);
                self.refuse(self.line[epoch], "epoch", reason, format!("epoch {}", epoch + 1).as_bytes());
            }
        }
        self.keep(|epoch| wrong[epoch].is_none(), |_| true);
    }

    /// One measurement is one: a satellite that stands twice in an epoch is used once where both are alike, and not at all where they differ.
    fn drop_repeated_satellites(&mut self) {
        let twice: Vec<usize> = (0..self.time.len()).filter(|epoch| self.stands_twice(*epoch)).collect();
        if twice.is_empty() {
            return;
        }
        let mut wrong = vec![false; self.satellite.len()];
        for epoch in twice {
            let all = self.satellites(epoch);
            for k in all.clone() {
                let alike: Vec<usize> = all.clone().filter(|other| self.satellite[*other] == self.satellite[k]).collect();
                let bits = |of: usize| self.values(of).iter().map(|v| v.to_bits());
                let differ = alike.iter().any(|other| !bits(*other).eq(bits(k)));
                wrong[k] = alike.len() > 1 && (differ || alike[0] != k);
                if wrong[k] {
                    let SatelliteId { constellation, number } = self.satellite[k];
                    let name = format!("{}{number:02}", constellation.letter());
                    self.refuse(self.line[epoch], "satellite", if differ { LISTED_AGAINST } else { LISTED_TWICE }, name.as_bytes());
                }
            }
        }
        self.keep(|_| true, |satellite| !wrong[satellite]);
    }

    fn stands_twice(&self, epoch: usize) -> bool {
        let mut seen = [[0_u64; 4]; SYSTEMS];
        self.satellite[self.satellites(epoch)].iter().any(|s| {
            let word = &mut seen[s.constellation.index()][usize::from(s.number) / 64];
            let bit = 1 << (s.number % 64);
            let before = *word & bit != 0;
            *word |= bit;
            before
        })
    }

    /// Keep some epochs, and of these some satellites.
    fn keep(&mut self, of_epochs: impl Fn(usize) -> bool, of_satellites: impl Fn(usize) -> bool) {
        let mut o = Self::default();
        for epoch in (0..self.time.len()).filter(|epoch| of_epochs(*epoch)) {
            for k in self.satellites(epoch).filter(|k| of_satellites(*k)) {
                o.begin_satellite(self.satellite[k]);
                for v in self.value_range(k) {
                    o.push(self.value[v], self.indicator[v]);
                }
            }
            o.end_epoch(self.time[epoch], self.interrupted[epoch], self.clock_offset_s[epoch], self.line[epoch]);
        }
        (self.time, self.line, self.interrupted, self.clock_offset_s) = (o.time, o.line, o.interrupted, o.clock_offset_s);
        (self.satellite, self.value, self.indicator) = (o.satellite, o.value, o.indicator);
        (self.last_satellite, self.first_value) = (o.last_satellite, o.first_value);
    }

    /// Whether two epochs hold the same satellites with the same values.
    fn repeats(&self, one: usize, other: usize) -> bool {
        let satellites = |epoch| self.satellite[self.satellites(epoch)].iter();
        let values = |epoch| self.satellites(epoch).flat_map(|k| self.values(k)).map(|v| v.to_bits());
        one == other || (satellites(one).eq(satellites(other)) && values(one).eq(values(other)))
    }

    /// Zero stands for "absent" among ranges, phases and strengths; scale factors of the header are taken out.
    fn finish(&mut self, heading: &heading::Heading) {
        let zero_is_absent: [Vec<bool>; SYSTEMS] = std::array::from_fn(|i| self.codes[i].iter().map(|c| c[0] != b'D').collect());
        let scaled = heading.scale.iter().any(|s| !s.is_empty());
        for (k, satellite) in self.satellite.iter().enumerate() {
            let to = self.first_value.get(k + 1).copied().unwrap_or(self.value.len());
            let values = &mut self.value[self.first_value[k]..to];
            let system = satellite.constellation.index();
            for (value, zero_is_absent) in values.iter_mut().zip(&zero_is_absent[system]) {
                if *value == 0.0 && *zero_is_absent {
                    *value = f64::NAN;
                }
            }
            if scaled {
                for (code, factor) in &heading.scale[system] {
                    values[*code] /= factor;
                }
            }
        }
        self.believe();
    }
}

#[cfg(test)]
#[path = "observation_tests.rs"]
mod tests;
