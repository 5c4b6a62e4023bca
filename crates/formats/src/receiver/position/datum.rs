//! The datum of a receiver's positions: a DTM sentence of NMEA 0183 holds until the next one.
//!
//! Source: NMEA 0183 version 4 as receivers' manuals give it; standard. Some receivers write DTM at each epoch, others once at their start.

use super::sentence::{EARTH_M, Sentence};

/// Names of WGS-84, and of PZ-90, which is within metres of it. Others are none, as a position in them is further off than receivers err: WGS-72 is
/// turned by 0.554 seconds of arc, 17 m at the equator, SGS-85 by as much, and one that a user defined may be any. Provenance: standard (codes of
/// NMEA 0183, as receivers' manuals give them; the turn of WGS-72 by NIMA TR8350.2).
const NEAR: [&[u8]; 4] = [b"W84", b"WGS84", b"WGS-84", b"P90"];

/// Offset up to which a datum is WGS-84: telephones state that of PZ-90, 5 cm. Provenance: ours \[m\].
const OFFSET_M: f64 = 1.0;

/// What the last DTM sentence said against positions: that they are in another datum than WGS-84.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Datum {
    /// What was said against the positions of the unfinished epoch, of several statements the first: DTM has no time, so one between two epochs
    /// may be of either, and one that takes it back counts from the next epoch on.
    pub of_epoch: Option<String>,
    /// What the last one said.
    pub newest: Option<String>,
    /// Its talker: what another one says of its own positions takes nothing back.
    pub talker: [u8; 2],
}

impl Datum {
    pub(super) fn hear(&mut self, talker: [u8; 2], against: Option<String>) {
        if against.is_none() && self.newest.is_some() && talker != self.talker {
            return;
        }
        self.talker = talker;
        self.of_epoch = self.of_epoch.take().or_else(|| against.clone());
        self.newest = against;
    }

    /// An epoch is finished.
    pub(super) fn next_epoch(&mut self) {
        self.of_epoch.clone_from(&self.newest);
    }
}

/// What a DTM sentence says against positions, or nothing where they are in WGS-84; `None` where it names no datum and no offset.
pub(super) fn against(dtm: &Sentence<'_>) -> Option<Option<String>> {
    let text = |at: usize| dtm.get(at).filter(|text| !text.is_empty());
    let name = text(1);
    let named = || name.map_or_else(|| "that has no name".into(), String::from_utf8_lossy);
    if let Some(offset) = [3, 5].into_iter().filter(|at| dtm.number(*at).is_none()).find_map(text) {
        return Some(Some(format!("DTM datum {}, offset {}", named(), String::from_utf8_lossy(offset))));
    }
    let minutes = |at: usize| dtm.number(at).unwrap_or(0.0);
    let offset_m = EARTH_M * libm::hypot(minutes(3), minutes(5)).to_radians() / 60.0;
    let near = name.is_none_or(|name| NEAR.contains(&name));
    if name.is_none() && offset_m == 0.0 {
        return None;
    }
    let shown = if offset_m > OFFSET_M { format!(", {offset_m:.0} m away") } else { String::new() };
    let known = near && offset_m <= OFFSET_M;
    Some((!known).then(|| format!("DTM datum {}{shown}", named())))
}
